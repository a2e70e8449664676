"""The command ``seaglint mean``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.cli.terminal.messages import files_read, log, naming_file, show_logs
from seaglint.cli.terminal.options import LateProgressOption, Preview, PreviewScale, ScaleOption, refuse_preview
from seaglint.cli.terminal.program import only_numpy
from seaglint.cli.terminal.progress import ProgressMode, patient_progress
from seaglint.cli.terminal.record_options import takes_records
from seaglint.studies.study_requests import MeanRequest


@takes_records(order="scenario output overwrite sea_draws preview scale")
def mean(
    request: MeanRequest,
    output: Annotated[Path, typer.Option("-o", "--output", help="NetCDF file to write")],
    preview: Preview = False,
    scale: ScaleOption = PreviewScale.AUTO,
    show: LateProgressOption = ProgressMode.AUTO,
) -> None:
    """Map mean radiance and apparent temperature over the view."""
    from seaglint.scenario.load import load_scenario
    from seaglint.store.netcdf import write_netcdf
    from seaglint.store.outputs import refuse_existing, require_ending

    show_logs()
    sequence = ", and 'seaglint render' makes sequences, in .zarr" if output.suffix.lower() == ".zarr" else ""
    require_ending(output, (".nc", ".nc4"), f"a mean map is a NetCDF file{sequence}")
    loaded = load_scenario(request.scenario)
    picture, inputs = output.with_suffix(".png"), files_read(request.scenario, loaded)
    refuse_existing(output, overwrite=request.overwrite, inputs=inputs)
    if preview:
        refuse_preview(picture, request.overwrite, inputs)
    from seaglint.base.kernel_plan import start_helpers

    start_helpers("mean")  # before the other imports, which take seconds: the helpers compile meanwhile
    only_numpy()
    from seaglint.studies.mean.mean_map import mean as mean_map

    with naming_file(request.scenario, loaded), patient_progress(show, "map") as report:
        dataset = mean_map(loaded, report, sea_draws=request.sea_draws)
    if "air_note" in dataset.attrs:
        log(dataset.attrs["air_note"])
    if request.sea_draws is not None:
        from seaglint.studies.mean.mean_map import brightest_lines

        for line in brightest_lines(dataset):
            log(line)
    write_netcdf(dataset, output, overwrite=request.overwrite)
    log(f"{output} written")
    if preview:
        from seaglint.plot.preview import write_picture

        write_picture(dataset, picture, scale.value)
        log(f"{picture} written")
