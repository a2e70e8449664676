"""The command ``seaglint sweep``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.base.errors import DataError
from seaglint.cli.terminal.messages import files_read, log, show_logs
from seaglint.cli.terminal.options import Preview, refuse_preview
from seaglint.cli.terminal.progress import ProgressMode, patient_progress
from seaglint.cli.terminal.record_options import RunOptions, Without, takes_records
from seaglint.studies.study_requests import SweepRequest


@takes_records(order="scenario vary what at output preview keep_going most_cases workers dask dask_slurm threads overwrite show")
def sweep(
    scenario: Annotated[Path, typer.Argument(metavar="SCENARIO.toml", help="scenario file; 'seaglint init my.toml' writes one")],
    request: Annotated[SweepRequest, Without(("resume",))],
    run: Annotated[RunOptions, Without(("resume",))],
    output: Annotated[Path, typer.Option("-o", "--output", help="NetCDF file to write")],
    preview: Preview = False,
) -> None:
    """Compute one quantity over every combination of values of keys.

    The result has a dimension for each swept key, then the dimensions of the view angles or of the picture.
    """
    from seaglint.scenario.load import load_scenario
    from seaglint.scenario.text.option_texts import parse_vary
    from seaglint.store.netcdf import write_netcdf
    from seaglint.store.outputs import refuse_existing, require_ending

    show_logs(quiet=run.show is ProgressMode.NONE)
    require_ending(output, (".nc", ".nc4"), "a sweep is a NetCDF file")
    if not request.vary:
        raise DataError("--vary is missing; give values of at least one key, e.g. --vary wind.speed_m_s=1:20:1")
    vary, at = dict(parse_vary(request.vary)), dict(parse_vary(request.at, "at")) or None
    inputs, picture = files_read(scenario, load_scenario(scenario)), output.with_suffix(".png")
    refuse_existing(output, overwrite=run.overwrite, inputs=inputs)
    if preview:
        refuse_preview(picture, run.overwrite, inputs)
    from seaglint.store.writers import exclusive
    from seaglint.studies.sweep.run_sweep import sweep as compute

    with exclusive(output):
        with run.chosen() as workers, patient_progress(run.show, "cases") as report:
            dataset = compute(
                scenario,
                vary,
                what=request.what,
                at=at,
                workers=workers,
                threads=request.threads if workers is None else None,
                keep_going=request.keep_going,
                most_cases=request.most_cases,
                progress=report,
            )
        write_netcdf(dataset, output, overwrite=run.overwrite)
    failed = int(dataset.attrs.get("failed_cases", 0))
    if failed:
        log(f"{failed} cases failed and have no values (NaN): {dataset.attrs['failures']}")
    log(f"{output} written: {', '.join(f'{name} {size}' for name, size in dataset.sizes.items())}")
    if preview:
        from seaglint.plot.sweep_figure import write_sweep

        write_sweep(dataset, picture)
        log(f"{picture} written")
