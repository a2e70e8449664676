"""Where the Sun stands in a scenario: as given, or from date and place."""

from __future__ import annotations

import math
from dataclasses import dataclass

from seaglint.scenario.model import Scenario


@dataclass(frozen=True)
class SunPosition:
    """Direction and distance of the Sun's centre."""

    zenith: float
    """Zenith angle, refraction included where it comes from date and place [rad]."""
    azimuth: float
    """Azimuth, clockwise from north [rad]."""
    distance_au: float
    """Distance from the Earth [au]; 1 where only angles are given."""

    @property
    def irradiance_factor(self) -> float:
        """Irradiance against that at 1 au, ``1/d^2``."""
        return self.distance_au**-2


def sun_position(scenario: Scenario) -> SunPosition:
    """Direction and distance of the Sun at the scenario's first frame.

    Date and place go through the NREL solar position algorithm (Reda and Andreas 2004) of pvlib, with its standard
    atmosphere for refraction: the sea mirrors the Sun from where it is seen. The position stays the same over a sequence.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> sun = sun_position(parse_scenario({"sun": {"zenith_deg": 60, "azimuth_deg": 90}}))
    >>> round(sun.zenith, 4), round(sun.azimuth, 4), sun.distance_au
    (1.0472, 1.5708, 1.0)
    """
    if scenario.sun is not None:
        return SunPosition(math.radians(scenario.sun.zenith_deg), math.radians(scenario.sun.azimuth_deg), 1.0)
    assert scenario.time is not None  # one of both is the model's own rule
    assert scenario.place is not None
    # pandas and pvlib take over a second to import: paid only by scenarios with date and place.
    import pandas as pd
    from pvlib import solarposition

    times = pd.DatetimeIndex([scenario.time.utc])
    found = solarposition.get_solarposition(times, scenario.place.latitude_deg, scenario.place.longitude_deg, method="nrel_numpy")
    distance = float(solarposition.nrel_earthsun_distance(times).iloc[0])
    return SunPosition(math.radians(float(found["apparent_zenith"].iloc[0])), math.radians(float(found["azimuth"].iloc[0])), distance)
