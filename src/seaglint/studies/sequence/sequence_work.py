"""Reuse of prepared scenes, and units of a sequence over workers.

A prepared scene serves scenarios that differ in seed and objects alone. Each worker prepares the scene itself and writes its frames
directly into the store.
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
    """A prepared scene, from which other scenes are derived."""

    def with_sea_of(self, scenario: Scenario) -> Self:
        """Return the scene with another scenario's seed and objects."""
        ...


Made = TypeVar("Made", bound=Shareable)


@dataclass(eq=False)
class SceneCache:
    """Cache of the latest prepared scene; memory does not grow with the number of scenes.

    Notes
    -----
    The bytes of a scene do not depend on the cached scene.
    """

    _latest: tuple[str, Any] | None = field(default=None, repr=False)

    def sequence(self, scenario: Scenario, settings: str, prepare: Callable[[], Made]) -> Made:
        """Return the scene of a scenario, derived from the latest one if only seed and objects differ.

        Parameters
        ----------
        scenario : Scenario
            Scenario to draw.
        settings : str
            Further settings that the preparation depends on.
        prepare : callable
            Function that prepares the scene.
        """
        if scenario.platform is not None and scenario.platform.floats:
            return prepare()  # its track depends on the sea
        key = settings + scenario.model_copy(update={"seed": 0, "objects": None}).model_dump_json()
        if self._latest is not None and self._latest[0] == key:
            latest: Made = self._latest[1]
            return latest.with_sea_of(scenario)
        self._latest = None  # two scenes would take twice the memory
        made = prepare()
        self._latest = (key, made)
        return made


#: Preparation before the first frame, from small settings; a function of a module, which workers import by its name.
Prepare = Callable[[Any], tuple[Layout, Frame]]


@dataclass(frozen=True)
class UnitJob:
    """Settings that a worker receives before its first unit."""

    task: UnitTask
    prepare: Prepare
    settings: Any


def start(job: UnitJob) -> Callable[[int], UnitRecord]:
    """Prepare in a worker and return the function that makes one unit."""
    require_version(job.task)  # before anything is computed
    layout, frame = job.prepare(job.settings)
    make = unit_maker(job.task, layout, frame)

    def unit(number: int) -> UnitRecord:
        with single_threaded_algebra():
            return make(number)

    return unit


def spread_over(workers: Workers | None, prepare: Prepare, settings: Any) -> Spread | None:
    """Return the function with which ``seaglint.store.sequence_store.write_sequence`` spreads units; None without workers."""
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
