"""Position and phase of the Moon in a scenario: as given, or from date and place."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import timedelta
from typing import Final

from seaglint.base.errors import ScenarioError
from seaglint.scenario.model import Scenario
from seaglint.scenario.sun import SUN_STEP_TIME, sun_position

ECLIPSED: Final = math.radians(1.5)  #: Phase angle below which the Moon may be in the Earth's shadow [rad].

_MISFIT: Final = 20.0  #: Least difference between a given phase angle and that of the given Sun that is reported [deg].


@dataclass(frozen=True)
class MoonPosition:
    """Direction, phase and distances of the Moon's centre, as seen from the place."""

    zenith: float  #: Zenith angle, refraction included where it comes from date and place [rad].
    azimuth: float  #: Azimuth, clockwise from north [rad].
    phase: float  #: Phase angle, the angle at the Moon between Sun and observer [rad]: 0 at full Moon, pi at new Moon.
    distance_m: float  #: Distance from the place [m].
    #: Direction in the sky from the Moon's centre to the Sun, from upwards towards increasing azimuth [rad]; None without a Sun's position.
    bright_limb: float | None
    sun_distance_au: float  #: Distance of the Moon from the Sun [au]; 1 where the Moon's angles are given.

    @property
    def radius(self) -> float:
        """Angular radius of the disc [rad]."""
        from seaglint.optics.moonlight import moon_radius

        return moon_radius(self.distance_m)

    @property
    def lit_share(self) -> float:
        """Lit share of the disc, ``(1 + cos phase) / 2`` [1]."""
        return 0.5 * (1.0 + math.cos(self.phase))


def moon_position(scenario: Scenario, step: int = 0) -> MoonPosition | None:
    """Return the Moon at the scenario's first frame, or at the beginning of a later step (``sun_step``); None without ``[moon]``.

    From date and place it is apparent and topocentric, by Meeus' series (``seaglint.climate.moon_position``), with the refraction of
    ``sun_position``. Over a sequence it stays for ``SUN_STEP_TIME`` at a time, as the Sun does.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> moon = {"zenith_deg": 60, "azimuth_deg": 90, "phase_deg": 90}
    >>> moon = moon_position(parse_scenario({"sun": {"zenith_deg": 120}, "moon": moon}))
    >>> round(moon.zenith, 4), round(moon.lit_share, 2), round(math.degrees(moon.radius), 3)
    (1.0472, 0.5, 0.259)
    """
    table = scenario.moon
    if table is None:
        return None
    # Imported here, because scenarios are read without NumPy.
    from seaglint.climate.moon_position import MoonEphemeris, bright_limb
    from seaglint.optics.moonlight import MEAN_MOON_DISTANCE

    if table.zenith_deg is not None and table.azimuth_deg is not None and table.phase_deg is not None:
        zenith, azimuth, phase = (math.radians(angle) for angle in (table.zenith_deg, table.azimuth_deg, table.phase_deg))
        distance = MEAN_MOON_DISTANCE if table.distance_km is None else 1000.0 * table.distance_km
        limb = None
        if scenario.sun is not None or (scenario.time is not None and scenario.place is not None):
            sun = sun_position(scenario, step)
            limb = float(bright_limb(zenith, azimuth, sun.zenith, sun.azimuth))
        return MoonPosition(zenith, azimuth, phase, distance, limb, 1.0)
    if scenario.time is None or scenario.place is None:  # fine with [likelihood] alone, whose time and place vary
        raise ScenarioError("one position of the Moon is needed here; give [time] and [place], or the angles of [moon]")
    seconds = (scenario.time.utc + timedelta(seconds=step * SUN_STEP_TIME)).timestamp()
    place = (scenario.place.latitude_deg, scenario.place.longitude_deg)
    moon = MoonEphemeris.between(seconds, seconds).at(seconds, *place)
    return MoonPosition(*(float(values[0]) for values in moon))


def phase_misfit(scenario: Scenario) -> str | None:
    """Return a sentence on a given phase angle that the given directions of Sun and Moon do not have; None where they fit.

    The Sun is so far away that the phase angle is 180 degrees less the angle between both in the sky.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> moon = {"zenith_deg": 60, "azimuth_deg": 90, "phase_deg": 0}
    >>> phase_misfit(parse_scenario({"sun": {"zenith_deg": 62, "azimuth_deg": 90}, "moon": moon}))
    'moon.phase_deg = 0, but Sun and Moon are 2 deg apart, where the phase angle is 178 deg; correct one of them unless it is intended'
    """
    sun, moon = scenario.sun, scenario.moon
    if sun is None or not sun.model_fields_set or moon is None:
        return None
    if moon.zenith_deg is None or moon.azimuth_deg is None or moon.phase_deg is None:
        return None
    low, high, aside = (math.radians(angle) for angle in (sun.zenith_deg, moon.zenith_deg, sun.azimuth_deg - moon.azimuth_deg))
    cosine = math.cos(low) * math.cos(high) + math.sin(low) * math.sin(high) * math.cos(aside)
    apart = math.degrees(math.acos(min(max(cosine, -1.0), 1.0)))
    if abs(180.0 - apart - moon.phase_deg) <= _MISFIT:
        return None
    return (
        f"moon.phase_deg = {moon.phase_deg:g}, but Sun and Moon are {apart:.0f} deg apart, where the phase angle is "
        f"{180.0 - apart:.0f} deg; correct one of them unless it is intended"
    )
