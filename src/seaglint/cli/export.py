"""``seaglint export-sea``: the sea of one instant for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.cli.messages import files_read, log, naming_file
from seaglint.errors import DataError

KINDS = (".ply", ".nc")


def export_sea(
    scenario: Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario file")],
    output: Annotated[Path, typer.Option("-o", "--output", help="file to write: .ply a triangle mesh, .nc NetCDF")],
    time: Annotated[float, typer.Option("--time", help="seconds from the start of the sequence")] = 0.0,
    extent: Annotated[
        tuple[float, float] | None,
        typer.Option("--extent", metavar="EAST NORTH", help="size of the patch in metres; 256 256, less where waves are very short"),
    ] = None,
    spacing: Annotated[
        float | None, typer.Option("--spacing", help="distance of its points in metres; a quarter of the shortest wave")
    ] = None,
    centre: Annotated[
        tuple[float, float],
        typer.Option("--centre", metavar="EAST NORTH", help="middle of the patch in metres from the sensor's foot"),
    ] = (0.0, 0.0),
    lattices: Annotated[bool, typer.Option("--lattices/--no-lattices", help="with the periodic tiles beside the patch (.nc)")] = True,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="replace what stands at the output")] = False,
) -> None:
    """Write heights, slopes and facet roughness of the sea at one time."""
    from seaglint.io.outputs import refuse_existing
    from seaglint.scenario.load import load_scenario

    kind = output.suffix.lower()
    if kind not in KINDS:
        raise DataError(f"{output}: is neither {' nor '.join(KINDS)}; the ending says what is written")
    loaded = load_scenario(scenario)
    refuse_existing(output, overwrite=overwrite, inputs=files_read(scenario, loaded))
    from seaglint.pipeline.export import export_sea as export

    with naming_file(scenario, loaded):
        sea = export(loaded, time, centre=centre, extent=extent, spacing=spacing)
    rows, columns = sea.patch.shape
    if kind == ".ply":
        from seaglint.io.ply import write_ply

        write_ply(output, *sea.patch.axes, sea.patch_surface, comments=sea.comments, overwrite=overwrite)
    else:
        from seaglint.io.netcdf import write_netcdf

        write_netcdf(sea.dataset(lattices=lattices), output, overwrite=overwrite)
    log(f"{output} written: {columns} x {rows} points every {sea.patch.spacing:.4g} m")
    finest = sea.tiles[-1].spacing
    if sea.patch.spacing > 2.0 * finest:
        log(f"{output}: points are {sea.patch.spacing:.4g} m apart, waves down to {4.0 * finest:.4g} m are sampled, not smoothed")
