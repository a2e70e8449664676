"""Mirrored moonlight of many looks at once: tables of the air as for the Sun, at nodes of the phase, and the Moon of each draw.

The light of a phase is the Moon's spectrum over its band mean. It changes little with the phase, and the band mean of each draw is exact:
looks are interpolated linearly between nodes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.climate.glint_radiance import Looks, Search, WindSlopes, looks
from seaglint.climate.mirrored_sunlight import MirroredLight
from seaglint.facet.sea_view import lit_middle
from seaglint.optics.moonlight import MEAN_MOON_DISTANCE, MOON_RADIUS, moon_to_sun

#: Phases of the tables [rad].
PHASES: Final = np.radians([0.0, 25.0, 50.0, 75.0, 100.0, 130.0, 180.0])

_FINE: Final = np.linspace(0.0, np.pi, 181)  #: Phases at which the band mean is tabulated [rad].
_DISTANCES: Final = np.array([0.97, 1.0, 1.03])  #: Distances of the Sun at which it is tabulated [au].


class Moons(NamedTuple):
    """Moon of each draw [(n,)]."""

    zenith: FloatArray  #: Zenith angle of the disc's centre [rad].
    azimuth: FloatArray  #: Its azimuth [rad].
    phase: FloatArray  #: Phase angle [rad].
    distance_m: FloatArray  #: Distance from the place [m].
    bright_limb: FloatArray  #: Direction of the bright limb, from upwards towards increasing azimuth [rad].
    sun_distance_au: FloatArray  #: Distance from the Sun [au].


@dataclass(frozen=True, eq=False)
class MoonBand:
    """Moonlight over sunlight in one band, above the air. Make it with ``of``."""

    ratios: tuple[FloatArray, ...]  #: Ratio of moonlight to sunlight over its band mean at ``PHASES`` [1, (n,)].
    _logarithm: FloatArray  #: Logarithm of the band mean at ``_DISTANCES`` and ``_FINE``, Moon at its mean distance.

    @classmethod
    def of(cls, wavenumber_cm: FloatArray, sunlight: FloatArray) -> MoonBand:
        """Return the light in a band: samples [cm-1, (n,)] and sunlight above the air, weighted [W m-2, (n,)]."""
        share = sunlight / sunlight.sum()
        means = [
            [moon_to_sun(wavenumber_cm, phase, MEAN_MOON_DISTANCE, d) @ share for phase in _FINE.tolist()] for d in _DISTANCES.tolist()
        ]
        nodes = [moon_to_sun(wavenumber_cm, phase) for phase in PHASES.tolist()]
        return cls(tuple(node / (node @ share) for node in nodes), np.log(means))

    def mean(self, moons: Moons) -> FloatArray:
        """Return the band mean of moonlight over sunlight at 1 au for each Moon [1, (n,)]."""
        at = np.stack([np.interp(moons.phase, _FINE, row) for row in self._logarithm])
        x = np.clip((moons.sun_distance_au - _DISTANCES[0]) / (_DISTANCES[1] - _DISTANCES[0]), 0.0, 2.0)
        i = np.minimum(x.astype(np.int64), 1)
        every = np.arange(x.size)
        logarithm = at[i, every] + (x - i) * (at[i + 1, every] - at[i, every])
        # the solid angle is that of the radius asin(R / distance)
        solid = (np.arcsin(MOON_RADIUS / moons.distance_m) / math.asin(MOON_RADIUS / MEAN_MOON_DISTANCE)) ** 2
        return np.asarray(np.exp(logarithm) * solid)


def moonlit_looks(rows: FloatArray, moons: Moons, band: MoonBand, light: MirroredLight, sea: WindSlopes, search: Search) -> Looks:
    """Mirrored Moon of each look, as ``seaglint.climate.glint_radiance.looks``; chances are those of the lit part.

    Parameters
    ----------
    rows : ndarray
        Looks [(n, 9)] with the columns of ``seaglint.climate.glint_radiance.COLUMNS``, of which the Sun's are replaced.
    moons : Moons
        Moon of each.
    band : MoonBand
        Moonlight above the air.
    light : MirroredLight
        Tables with the ratios of ``band``.
    sea : WindSlopes
        Slopes.
    search : Search
        Directions.
    """
    radius = np.arcsin(MOON_RADIUS / moons.distance_m)
    own = np.array(rows, dtype=np.float64)
    own[:, 4], own[:, 5] = lit_middle(moons.zenith, moons.azimuth, radius, moons.phase, moons.bright_limb)
    own[:, 6] = band.mean(moons)
    node = np.clip(np.searchsorted(PHASES, moons.phase, side="right") - 1, 0, PHASES.size - 2)
    share = (moons.phase - PHASES[node]) / (PHASES[node + 1] - PHASES[node])
    own[:, 0] = PHASES.size * rows[:, 0] + node
    near = looks(own, light, sea, search)
    own[:, 0] += 1.0
    far = looks(own, light, sea, search)
    radiance = near.radiance + share * (far.radiance - near.radiance)
    lit = np.maximum(0.5 * (1.0 + np.cos(moons.phase)), 1e-4)
    chance = np.minimum(near.chance * lit * (radius / SOLAR_ANGULAR_RADIUS) ** 2, 1.0)
    return replace(near, radiance=radiance, chance=chance, radius=radius * np.sqrt(lit))


def brighter(sun: Looks, moon: Looks, *, searched: bool) -> tuple[Looks, NDArray[np.bool_]]:
    """Return the looks under both lights, and whether the Moon is the brighter one [(n,)].

    Radiances add up. Where directions are searched, the brightest direction is that of the brighter light, and so is the radiance.
    """
    by_moon = moon.radiance > sun.radiance
    both = Looks(*(np.where(by_moon, getattr(moon, name), getattr(sun, name)) for name in Looks.__dataclass_fields__))
    return (both if searched else replace(both, radiance=sun.radiance + moon.radiance)), by_moon
