"""A sequence's units over workers: each prepares the scene itself and writes its frames straight into the store."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from seaglint.base.threads import single_threaded_algebra
from seaglint.cluster import Done, Job, Workers
from seaglint.files.store.filling import Spread, UnitTask, require_version, unit_maker
from seaglint.files.store.layout import Layout
from seaglint.files.store.shards import Frame, UnitFailure, UnitRecord

#: What is made before the first frame, from small settings; a function of a module, which workers find by its name.
Prepare = Callable[[Any], tuple[Layout, Frame]]


@dataclass(frozen=True)
class UnitJob:
    """Settings that a worker receives before its first unit."""

    task: UnitTask
    prepare: Prepare
    settings: Any


def start(job: UnitJob) -> Callable[[int], UnitRecord]:
    """Prepare in a worker; the function makes one unit."""
    require_version(job.task)  # before anything is computed
    layout, frame = job.prepare(job.settings)
    make = unit_maker(job.task, layout, frame)

    def unit(number: int) -> UnitRecord:
        with single_threaded_algebra():
            return make(number)

    return unit


def over(workers: Workers | None, prepare: Prepare, settings: Any) -> Spread | None:
    """How :func:`seaglint.files.store.store.write_sequence` has units made by workers; None where there are none."""
    if workers is None:
        return None

    @contextmanager
    def spread(task: UnitTask, units: Sequence[int]) -> Iterator[Iterator[UnitRecord | UnitFailure]]:
        with workers.map(Job(start, UnitJob(task, prepare, settings)), units) as outcomes:
            yield (
                outcome.record if isinstance(outcome, Done) else UnitFailure(outcome.unit, outcome.error, outcome.traceback)
                for outcome in outcomes
            )

    return spread
