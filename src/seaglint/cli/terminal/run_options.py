"""Options of where results go and of how work is run, as records that commands share."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from seaglint.base.parameters import Parameter
from seaglint.cli.terminal.progress import ProgressMode
from seaglint.cli.terminal.workers import chosen, done_here
from seaglint.studies.reading_requests import WorkRequest

if TYPE_CHECKING:
    from seaglint.cluster import Workers


@dataclass(frozen=True)
class ResultOptions:
    """Where results go: text or JSON on stdout, files beside each other, a report."""

    as_json: Annotated[bool, typer.Option("--json", help="print JSON", rich_help_panel="Results")] = False
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            metavar="RESULT",
            help="writes RESULT.json, RESULT.csv (or .parquet), and beside them characteristics (RESULT_roc.csv) and pictures",
            rich_help_panel="Results",
        ),
    ] = None
    report: Annotated[Path | None, typer.Option("--report", metavar="F.html", help="report with pictures", rich_help_panel="Results")] = (
        None
    )


@dataclass(frozen=True)
class RunOptions(WorkRequest):
    """How work is run: by whom, over what is there, and how its progress is shown."""

    dask: Annotated[
        str | None,
        typer.Option("--dask", metavar="tcp://HOST:PORT", help="scheduler of a Dask cluster that does the work", rich_help_panel="Run"),
    ] = None
    dask_slurm: Annotated[
        Path | None,
        typer.Option(
            "--dask-slurm",
            metavar="CLUSTER.toml",
            help="batch queue that workers are asked of, with the settings in this file",
            rich_help_panel="Run",
        ),
    ] = None
    resume: Annotated[bool, Parameter("go on with what is kept beside RESULT", "Run")] = False
    show: Annotated[
        ProgressMode,
        typer.Option("--progress", help="bar on a terminal, log lines elsewhere, or nothing", rich_help_panel="Run"),
    ] = ProgressMode.AUTO

    def chosen(self) -> AbstractContextManager[Workers | None]:
        """Return the workers asked for; see :func:`seaglint.cli.terminal.workers.chosen`."""
        return chosen(self.workers, self.dask, self.dask_slurm, threads=self.threads)

    def done_here(self, what: str) -> None:
        """Say that nobody shares a piece of work that cannot be parted."""
        done_here(self.workers, self.dask, self.dask_slurm, what)


ALONE = ("workers", "dask", "dask_slurm")  #: Fields of :class:`RunOptions` for work that several share.
