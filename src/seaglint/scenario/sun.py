"""Position of the Sun in a scenario: as given, or from date and place."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import timedelta
from typing import Final

from seaglint.base.errors import ScenarioError
from seaglint.scenario.model import Scenario

SUN_STEP: Final = math.radians(0.05)  #: Angle that the Sun moves before a sequence takes its new position [rad]: a tenth of its diameter.

#: Shortest time in which the Sun moves by ``SUN_STEP`` [s], 11.97 s, from the Earth's rotation against the stars.
SUN_STEP_TIME: Final = 86_400.0 * SUN_STEP / math.radians(360.985647)


@dataclass(frozen=True)
class SunPosition:
    """Direction and distance of the Sun's centre."""

    zenith: float  #: Zenith angle, refraction included where it comes from date and place [rad].
    azimuth: float  #: Azimuth, clockwise from north [rad].
    distance_au: float  #: Distance from the Earth [au]; 1 where only angles are given.

    @property
    def irradiance_factor(self) -> float:
        """Return the irradiance over that at 1 au, ``1/d^2``."""
        return self.distance_au**-2


def sun_step(scenario: Scenario, time: float) -> int:
    """Return the index of the Sun's position at a time from the first frame [s]; 0 where angles are given.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> sun_step(parse_scenario({"time": {"utc": "2026-06-21T17:30:00Z"}, "place": {"latitude_deg": 40, "longitude_deg": 0}}), 60.0)
    5
    """
    # The step is a function of the time alone, so that a frame is equal in any part of its sequence.
    return 0 if scenario.sun is not None else math.floor(time / SUN_STEP_TIME)


def sun_position(scenario: Scenario, step: int = 0) -> SunPosition:
    """Return direction and distance of the Sun at the scenario's first frame, or at the beginning of a later step (``sun_step``).

    Date and place go through the NREL solar position algorithm (Reda and Andreas 2004) of pvlib. Refraction is that of its standard
    atmosphere (``seen_elevation``): the sea mirrors the Sun from where it is seen. Over a sequence it stays for ``SUN_STEP_TIME`` at a
    time.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> sun = sun_position(parse_scenario({"sun": {"zenith_deg": 60, "azimuth_deg": 90}}))
    >>> round(sun.zenith, 4), round(sun.azimuth, 4), sun.distance_au
    (1.0472, 1.5708, 1.0)
    """
    if scenario.sun is not None:
        return SunPosition(math.radians(scenario.sun.zenith_deg), math.radians(scenario.sun.azimuth_deg), 1.0)
    if scenario.time is None or scenario.place is None:  # fine with [likelihood] alone, whose time and place vary
        raise ScenarioError("one position of the Sun is needed here; give [time] and [place], or [sun], not only what [likelihood] needs")
    # pandas and pvlib take over a second to import: paid only by scenarios with date and place.
    import pandas as pd
    from pvlib import solarposition

    from seaglint.climate.ephemeris import seen_elevation

    times = pd.DatetimeIndex([scenario.time.utc + timedelta(seconds=step * SUN_STEP_TIME)])
    angles = solarposition.get_solarposition(times, scenario.place.latitude_deg, scenario.place.longitude_deg, method="nrel_numpy")
    distance = float(solarposition.nrel_earthsun_distance(times).iloc[0])
    zenith = 90.0 - float(seen_elevation(angles["elevation"].to_numpy())[0])
    return SunPosition(math.radians(zenith), math.radians(float(angles["azimuth"].iloc[0])), distance)
