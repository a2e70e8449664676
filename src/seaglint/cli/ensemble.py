"""The command ``seaglint ensemble``."""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seaglint.cli.terminal.messages import log
from seaglint.cli.terminal.progress import ProgressMode
from seaglint.cli.terminal.records import takes_records
from seaglint.cli.terminal.run_options import RunOptions
from seaglint.studies.ensemble.ensemble_requests import EnsembleRequest

if TYPE_CHECKING:
    from seaglint.scenario.ensemble_file import Ensemble


@takes_records(order="source output workers dask dask_slurm threads resume overwrite draw_only show")
def ensemble(
    source: Annotated[Path, typer.Argument(metavar="ENSEMBLE.toml", help="file with a base scenario and laws for its keys")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="folder for scenes and tables")],
    request: EnsembleRequest,
    run: RunOptions,
) -> None:
    """Draw scenes from laws of a scenario's keys and render each."""
    from seaglint.cli.terminal.logs import show_logs
    from seaglint.cli.terminal.progress import progress
    from seaglint.scenario.ensemble_file import load_ensemble
    from seaglint.studies.ensemble.ensemble_folder import Folder
    from seaglint.studies.ensemble.render_ensemble import render_ensemble

    show_logs(quiet=run.show is ProgressMode.NONE)
    loaded = load_ensemble(source)
    if not (request.resume or request.draw_only):
        Folder(output).check(resume=False, overwrite=request.overwrite)
        tell_cost(loaded, run)
    with run.chosen() as hands, progress(run.show, "scenes") as report:
        render_ensemble(
            loaded,
            output,
            workers=hands,
            threads=request.threads,
            resume=request.resume,
            overwrite=request.overwrite,
            draw_only=request.draw_only,
            progress=report,
        )
    count = loaded.ensemble.scenes
    drawn = f"drawn; render them with --resume, or one with: seaglint render {output}/scenes/0000.toml"
    outcome = drawn if request.draw_only else "rendered"
    log(f"{output}: {count} scene{'s' if count > 1 else ''} {outcome}; what was drawn is in {output / 'parameters.csv'}")


def tell_cost(loaded: Ensemble, run: RunOptions) -> None:
    """Say what many scenes will cost before they start; of few, and of a cluster's, nothing."""
    from seaglint.base.representation import duration, size_text
    from seaglint.studies.ensemble.expected_cost import MANY, expected_cost
    from seaglint.studies.ensemble.render_ensemble import scenes

    count = loaded.ensemble.scenes
    if count < MANY or run.show is ProgressMode.NONE or run.dask is not None or run.dask_slurm is not None:
        return
    first, second = (scene.scenario for scene in islice(scenes(loaded), 2))
    columns, rows = first.sensor.pixels
    cost = expected_cost(first, second, count)
    log(
        f"{count} scenes of {first.sensor.frames} x {columns} x {rows} pixels: about {duration(cost.seconds)} on this machine and at most "
        f"{size_text(cost.size)} of counts or radiance, judged by a frame of the first"
    )
