"""Workers that options ask for: processes on this machine, or a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seaglint.cluster import Workers


def done_here(workers: int | None, dask: str | None, dask_slurm: Path | None, what: str) -> None:
    """Say that nobody shares a piece of work that cannot be parted."""
    from seaglint.cli.terminal.messages import log

    if workers is not None or dask is not None or dask_slurm is not None:
        log(f"{what} in one piece, by this process alone")


@contextmanager
def chosen(workers: int | None, dask: str | None, dask_slurm: Path | None, *, threads: int | None = None) -> Iterator[Workers | None]:
    """Whoever was asked for; None where the work is this process's own. ``threads`` is for each local process.

    Raises
    ------
    DataError
        More than one was asked for, or threads of Dask workers.
    SeaglintError
        What :mod:`seaglint.cluster.dask` refuses.
    """
    from seaglint.base.errors import DataError

    given = [name for name, value in (("--workers", workers), ("--dask", dask), ("--dask-slurm", dask_slurm)) if value is not None]
    if len(given) > 1:
        raise DataError(f"{' and '.join(given)}: work is shared out in one way; give one of them")
    if threads is not None and (dask is not None or dask_slurm is not None):
        raise DataError(f"--threads {threads}: is of this machine, and Dask's workers have their own; start them with --nthreads {threads}")
    if workers is not None:
        from seaglint.cluster.local import LocalProcesses

        with LocalProcesses(workers, threads=threads) as processes:
            yield processes
    elif dask is not None:
        from seaglint.cli.terminal.messages import log
        from seaglint.cluster.dask import connected

        with connected(dask, log) as cluster:
            yield cluster
    elif dask_slurm is not None:
        from seaglint.cli.terminal.messages import log
        from seaglint.cluster.batch_queue import queued

        with queued(dask_slurm, log) as cluster:
            yield cluster
    else:
        yield None
