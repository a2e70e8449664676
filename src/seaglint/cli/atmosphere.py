"""``seaglint atmosphere``: the air of a scenario as a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.cli.messages import files_read, log, naming_file

atmosphere = typer.Typer(help="The air of a scenario as a file.", no_args_is_help=True)


@atmosphere.callback()
def _atmosphere() -> None:
    pass


@atmosphere.command()
def export(
    scenario: Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario file")],
    output: Annotated[Path, typer.Option("-o", "--output", help="file to write: .nc NetCDF, .csv text")],
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace what stands at the output")] = False,
) -> None:
    """Write transmittance, radiance and sunlight for the scenario's sensor height and band: a start for an atmosphere file of your own."""
    from seaglint.io.atmosphere_file import require_kind, write_atmosphere
    from seaglint.io.outputs import refuse_existing
    from seaglint.scenario.load import load_scenario

    require_kind(output)
    loaded = load_scenario(scenario)
    refuse_existing(output, overwrite=overwrite, inputs=files_read(scenario, loaded))
    from seaglint.pipeline.air import export_air

    with naming_file(scenario, loaded):
        air = export_air(loaded)
    write_atmosphere(air, output, overwrite=overwrite)
    log(f'{output} written; in a scenario: [atmosphere] source = "file", path = "{output.name}"')
