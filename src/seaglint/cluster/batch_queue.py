"""Dask workers of a batch queue: jobs submitted to SLURM, PBS and others by the settings in a file."""

from __future__ import annotations

import shutil
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Final

from seaglint.base.errors import BackendError, DataError, one_line
from seaglint.base.free_form import TomlTables
from seaglint.base.optional import optional
from seaglint.cluster.dask import DaskWorkers, Say, client_of, quiet, require_dask

#: Queues by the key ``kind``, with their class of dask-jobqueue.
KINDS: Final = {
    "slurm": "SLURMCluster",
    "pbs": "PBSCluster",
    "sge": "SGECluster",
    "lsf": "LSFCluster",
    "oar": "OARCluster",
    "moab": "MoabCluster",
    "htcondor": "HTCondorCluster",
}

TIMEOUT: Final = 600.0  #: Time within which the queue must give the first worker, where the file does not say [s].


def read_settings(path: Path) -> tuple[str, int, float, TomlTables]:
    """Read kind of queue, number of jobs, time-out [s], and the settings passed to dask-jobqueue.

    Raises
    ------
    DataError
        A file that cannot be read, or a value that cannot be used.
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}; give the file with the queue's settings") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise DataError(f"{path}: is no TOML file: {error}") from None
    kind, jobs, timeout = table.pop("kind", "slurm"), table.pop("jobs", 1), table.pop("timeout_s", TIMEOUT)
    if kind not in KINDS:
        raise DataError(f"{path}: kind = {kind!r}; allowed are {', '.join(KINDS)}")
    if isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1:
        raise DataError(f"{path}: jobs = {jobs!r}; give how many batch jobs to ask for, 1 or more")
    if isinstance(timeout, bool) or not isinstance(timeout, int | float) or timeout <= 0:
        raise DataError(f"{path}: timeout_s = {timeout!r}; give the seconds to wait for the first worker")
    return kind, jobs, float(timeout), table


@contextmanager
def queued(path: Path, say: Say = lambda line: None) -> Iterator[DaskWorkers]:
    """Provide workers of the batch queue that a file describes; their jobs end with the context.

    Raises
    ------
    DataError
        Settings that the queue's class refuses.
    BackendError
        No queue on this machine, or it gives no worker in time.
    """
    require_dask()
    kind, jobs, timeout, options = read_settings(path)
    dask_jobqueue = optional("dask_jobqueue", "a batch queue")
    made = getattr(dask_jobqueue, KINDS[kind])
    command = str(made.job_cls.submit_command).split()[0]
    if shutil.which(command) is None:
        raise BackendError(f"{path}: {command} is not on this machine; run this where jobs are submitted, or change kind = {kind!r}")
    with quiet():
        try:
            # Without Dask's dashboard at its usual port, which another run may have.
            cluster = made(**{"scheduler_options": {"dashboard_address": ":0"}, **options})
        except (TypeError, ValueError, RuntimeError, OSError) as error:
            raise DataError(f"{path}: {made.__name__} refuses these settings: {one_line(error)}") from error
        try:
            cluster.scale(jobs=jobs)
            workers = DaskWorkers(lambda: client_of(cluster, str(path)), say, timeout)
            try:
                _first(workers, path, jobs, timeout)
                yield workers
            finally:
                workers.close()
        finally:
            cluster.close(timeout=10)


def _first(workers: DaskWorkers, path: Path, jobs: int, timeout: float) -> None:
    try:
        workers.wait_for_one()
    except BackendError as error:
        if workers.seen:
            raise
        raise BackendError(
            f"{path}: the queue started none of {jobs} jobs within {timeout:g} s; it may be full: try again later, "
            "raise timeout_s, or ask for less"
        ) from error
