"""Middle of a scenario's picture: fewer rows and columns of the same angle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seaglint.scenario.model import Scenario


def middle_of(scenario: Scenario, rows: int, columns: int | None = None) -> Scenario:
    """Return the scenario with the middle of its picture alone, at most so many rows and columns; pixels keep their angles."""
    sensor = scenario.sensor
    sides = list(zip(sensor.pixels, sensor.fov_deg, (columns, rows), strict=True))
    kept = [_kept(side, angle, most, plane=sensor.projection == "pinhole") for side, angle, most in sides]
    if [side for side, _ in kept] == list(sensor.pixels):
        return scenario
    parts = {"pixels": (kept[0][0], kept[1][0]), "fov_deg": (kept[0][1], kept[1][1])}
    return scenario.model_copy(update={"sensor": sensor.model_copy(update=parts)})


def _kept(side: int, angle: float, most: int | None, *, plane: bool) -> tuple[int, float]:
    """Pixels that stay of a side, an even number less so that its middle stays where it is, and their angle [deg]."""
    if most is None or side <= most:
        return side, angle
    fewer = most - (side - most) % 2
    share = fewer / side
    return fewer, 2.0 * math.degrees(math.atan(share * math.tan(math.radians(0.5 * angle)))) if plane else angle * share
