"""Prepared scenes reused for scenarios that differ in seed and objects alone.

A sequence's units over workers: each prepares the scene itself and writes its frames straight into the store.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Protocol, Self, TypeVar

from seaglint.base.threads import single_threaded_algebra
from seaglint.cluster import Done, Job, Workers
from seaglint.scenario.model import Scenario
from seaglint.store.layout import Layout
from seaglint.store.missing_frames import Spread, UnitTask, require_version, unit_maker
from seaglint.store.shards import Frame, UnitFailure, UnitRecord


class Shareable(Protocol):
    """A scene made ready, from which others can be had."""

    def with_sea_of(self, scenario: Scenario) -> Self:
        """Return the scene with another scenario's seed and objects."""
        ...


Made = TypeVar("Made", bound=Shareable)


@dataclass(eq=False)
class Kept:
    """Cache of the latest prepared scene; memory does not grow with the number of scenes.

    Notes
    -----
    The bytes of a scene do not depend on what was kept.
    """

    _latest: tuple[str, Any] | None = field(default=None, repr=False)

    def sequence(self, scenario: Scenario, settings: str, prepare: Callable[[], Made]) -> Made:
        """The scene of a scenario, from the latest one where only seed and objects differ.

        Parameters
        ----------
        scenario : Scenario
            What is drawn.
        settings : str
            What else it depends on.
        prepare : callable
            Makes it from nothing.
        """
        if scenario.platform is not None and scenario.platform.floats:
            return prepare()  # its way depends on the sea
        key = settings + scenario.model_copy(update={"seed": 0, "objects": None}).model_dump_json()
        if self._latest is not None and self._latest[0] == key:
            latest: Made = self._latest[1]
            return latest.with_sea_of(scenario)
        self._latest = None  # two at a time would be twice the memory
        made = prepare()
        self._latest = (key, made)
        return made


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
    """How :func:`seaglint.store.sequence_store.write_sequence` has units made by workers; None where there are none."""
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
