"""The command ``seaglint ensemble``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seaglint.cli.terminal.messages import log
from seaglint.cli.terminal.options import Overwrite, ProgressOption
from seaglint.cli.terminal.progress import ProgressMode
from seaglint.cli.terminal.workers import DaskOption, DaskSlurmOption, WorkersOption


def ensemble(
    source: Annotated[Path, typer.Argument(metavar="ENSEMBLE.toml", help="file with a base scenario and laws for its keys")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="folder for scenes and tables")],
    workers: WorkersOption = None,
    dask: DaskOption = None,
    dask_slurm: DaskSlurmOption = None,
    threads: Annotated[
        int | None, typer.Option("--threads", min=1, help="processor threads of each process; all where nothing is said")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="render the scenes that are missing")] = False,
    overwrite: Overwrite = False,
    draw_only: Annotated[bool, typer.Option("--draw-only", help="write scenario files and tables, and render nothing")] = False,
    show: ProgressOption = ProgressMode.AUTO,
) -> None:
    """Draw scenes from laws of a scenario's keys and render each."""
    from seaglint.cli.terminal.logs import show_logs
    from seaglint.cli.terminal.progress import progress
    from seaglint.cli.terminal.workers import chosen
    from seaglint.scenario.ensemble_file import load_ensemble
    from seaglint.studies.ensemble.render_ensemble import render_ensemble

    show_logs(quiet=show is ProgressMode.NONE)
    loaded = load_ensemble(source)
    with chosen(workers, dask, dask_slurm, threads=threads) as hands, progress(show, "scenes") as report:
        render_ensemble(
            loaded,
            output,
            workers=hands,
            threads=threads,
            resume=resume,
            overwrite=overwrite,
            draw_only=draw_only,
            progress=report,
        )
    count = loaded.ensemble.scenes
    outcome = f"drawn; render them with --resume, or one with: seaglint render {output}/scenes/0000.toml" if draw_only else "rendered"
    log(f"{output}: {count} scene{'s' if count > 1 else ''} {outcome}; what was drawn is in {output / 'parameters.csv'}")
