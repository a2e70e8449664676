"""Object of a scenario at a range along the line of sight."""

from __future__ import annotations

import math

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.errors import DataError
from seaglint.scenario.model import Scenario
from seaglint.scenario.sun import sun_position


def placed_at(scenario: Scenario, name: str, range_m: float, bearing_deg: float | None) -> Scenario:
    """The scenario with the object at a range along the line of sight, in the middle of the picture.

    Parameters
    ----------
    scenario : Scenario
        With a sensor that stands.
    name : str
        Of the object; it stays there, whatever its course.
    range_m : float
        Along the sea [m].
    bearing_deg : float, optional
        Of object and line of sight from the Sun's azimuth, clockwise [deg]; the sensor's own azimuth where nothing is said.

    Raises
    ------
    DataError
        No such object, or a sensor that moves.
    """
    if scenario.platform is not None:
        raise DataError("the range of detection is that of a sensor that stands; leave [platform] out")
    found = [item for item in scenario.objects or () if item.name == name]
    if not found:
        names = ", ".join(item.name for item in scenario.objects or ()) or "none"
        raise DataError(f"object '{name}' is not in the scenario; its [[objects]] are {names}")
    sensor = scenario.sensor
    azimuth = sensor.azimuth_deg
    if bearing_deg is not None:
        azimuth = (math.degrees(sun_position(scenario).azimuth) + bearing_deg) % 360.0
    towards = math.radians(azimuth)
    item = found[0]
    height = item.height_m if item.height_m is not None else 0.0
    drop = range_m**2 / (2.0 * EFFECTIVE_EARTH_RADIUS)
    elevation = math.degrees(math.atan2(height - sensor.height_m - drop, range_m))
    rest = {"track": None, "keyframes": None, "course_deg": None, "speed_m_s": None, "latitude_deg": None, "longitude_deg": None}
    heading = item.heading_deg if item.heading_deg is not None else item.course_deg
    place = {"east_m": range_m * math.sin(towards), "north_m": range_m * math.cos(towards), "heading_deg": heading}
    moved = item.model_copy(update={**rest, **place})
    looking = sensor.model_copy(update={"azimuth_deg": azimuth, "elevation_deg": elevation})
    return scenario.model_copy(update={"objects": (moved,), "sensor": looking})
