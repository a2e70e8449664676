"""The commands ``seaglint init`` and ``seaglint schema``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.cli.terminal.messages import log, print_json
from seaglint.cli.terminal.options import Overwrite


def _list_presets(requested: bool) -> None:
    if requested:
        from seaglint.scenario.presets import PRESETS

        for name, preset in PRESETS.items():
            typer.echo(f"{name:16} {preset.title}")
        raise typer.Exit


def init(
    output: Annotated[Path, typer.Argument(metavar="OUTPUT.toml", help="file to write")],
    preset: Annotated[str, typer.Option("--preset", help="scene to begin with")] = "glint",
    camera: Annotated[
        str | None,
        typer.Option(
            "--camera", metavar="KEY=VALUE,...", help="camera of a data sheet's numbers, as in the example, or a TOML file of the same"
        ),
    ] = None,
    overwrite: Overwrite = False,
    presets: Annotated[bool, typer.Option("--presets", callback=_list_presets, is_eager=True, help="list the presets and leave")] = False,
) -> None:
    """Write a commented scenario file."""
    from seaglint.scenario.camera import assumed_values, read_camera
    from seaglint.scenario.load import load_scenario
    from seaglint.scenario.text.template import PRESETS, write_template
    from seaglint.store.outputs import refuse_existing, require_ending

    require_ending(output, (".toml",), "a scenario is a TOML file")
    refuse_existing(output, overwrite=overwrite)
    chosen = None if camera is None else read_camera(camera)
    write_template(output, preset, camera=chosen, overwrite=overwrite)
    if PRESETS[preset].files:
        log(f"beside it: {', '.join(PRESETS[preset].files)}")
    if chosen is not None:
        for line in chosen.assumed:
            log(f"camera: {line}")
        log(f"not given, and so assumed (correct it in {output}):")
        for line in assumed_values(load_scenario(output), chosen):
            log(f"  {line}")
    log(f"{output} written; next: seaglint render {output} -o {output.with_suffix('.zarr')} --frames 0:1 --preview")
    if chosen is not None:
        log(f"what the camera does: seaglint sensor {output}")


def schema() -> None:
    """JSON Schema of scenario files."""
    from seaglint.scenario.text.template import json_schema

    print_json(json_schema())
