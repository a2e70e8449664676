"""Expected time and room of an ensemble, from one frame of its first scene."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from seaglint.scenario.middle import middle_of
from seaglint.studies.prepare.kept import Kept
from seaglint.studies.sequence.render_sequence import prepare_sequence
from seaglint.studies.sequence.sensed import prepare_sensed

if TYPE_CHECKING:
    from seaglint.scenario.model import Scenario

MANY: Final = 16  #: Least number of scenes whose cost is worth the time of one frame.

_STRIP: Final = 16


@dataclass(frozen=True)
class ExpectedCost:
    """Expected time [s] and greatest room [bytes] of an ensemble's scenes, on this machine alone."""

    seconds: float
    size: int


def expected_cost(first: Scenario, second: Scenario, scenes: int) -> ExpectedCost:
    """Return what rendering some scenes costs, all frames taken as the first one of the first scene.

    A narrow strip compiles what is not compiled yet; then the scene is made ready and its first frame is drawn, by the clock. The second
    scene is made ready as all further ones are, with what it shares with the first. The room is that of pixels as they are kept, without
    compression.
    """
    columns, rows = first.sensor.pixels
    cached = Kept()
    _times(middle_of(first, rows, _STRIP), cached)
    ready, drawn = _times(first, cached)
    again = _ready(second, cached)[1]
    size = scenes * first.sensor.frames * rows * columns * (2 if first.sensor.senses else 4)
    return ExpectedCost(ready + (scenes - 1) * again + scenes * first.sensor.frames * drawn, size)


def _times(scenario: Scenario, cached: Kept) -> tuple[float, float]:
    """Times of making a scenario ready and of drawing its first frame [s]."""
    run, ready = _ready(scenario, cached)
    start = time.perf_counter()
    run.images(next(iter(run.layout.frames)))
    return ready, time.perf_counter() - start


def _ready(scenario: Scenario, cached: Kept) -> tuple[Any, float]:
    """Scenario made ready, and the time that it took [s]."""
    start = time.perf_counter()
    run = prepare_sensed(scenario, cached=cached) if scenario.sensor.senses else prepare_sequence(scenario, cached=cached)
    return run, time.perf_counter() - start
