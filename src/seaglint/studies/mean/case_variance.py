"""Variance of glint in the pixels of a table of cases, from the waves of Elfouhaily's spectrum at each row's wind."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.air.protocol import slant_range
from seaglint.base.conventions import FloatArray, surface_range, view_zenith
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sunlight import visible_sun
from seaglint.radiance.lit_variance import WaveGlint
from seaglint.radiance.mean_radiance import SeaRadiance
from seaglint.scenario.records.sea_tables import Sea
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.studies.build.waves_and_slopes import elfouhaily
from seaglint.studies.mean.evaluate_cases import groups_of

SHORTEST_WAVE: Final = Sea().shortest_wave_m  #: Shortest wave that is geometry, as in a scenario [m].

_LIGHTS: Final = 2  #: Sun and Moon.


def wave_glint(speed: float) -> WaveGlint:
    """Return the waves of a wind at 10 m [m s⁻¹] as a scenario has them by default."""
    return WaveGlint(elfouhaily(speed, 0.0) if speed > 0.0 else None, SHORTEST_WAVE)


@dataclass(frozen=True, eq=False)
class MirroredCases:
    """Mirrored light of Sun and Moon in the rows of a table; make it with ``none`` and fill it with ``add``."""

    radiance: FloatArray  #: Mirrored light at the sensor [W m⁻² sr⁻¹, (2, rows)].
    cos_incidence: FloatArray  #: Cosine of its incidence [1, (2, rows)].
    sun_up: FloatArray  #: Cosine of the zenith angle of the light's visible part [1, (2, rows)].
    radius: FloatArray  #: Radius of the light's disc [rad, (2, rows)].

    @classmethod
    def none(cls, rows: int) -> MirroredCases:
        """Return cases without mirrored light."""
        return cls(*(np.zeros((_LIGHTS, rows)) for _ in range(4)))

    def add(self, rows: NDArray[np.intp], view: SeaView, mean: SeaRadiance) -> None:
        """Enter the mean radiance of some rows, which have one line of sight each."""
        first, second = view.lights
        of_first = mean if mean.moon is None else replace(mean, sun=mean.sun - mean.moon.sun)
        for i, (light, mirrored) in enumerate(((first, of_first), (second, mean.moon))):
            if light is not None and mirrored is not None:
                shown = mirrored.chance[:, 0] > 0.0
                self.radiance[i, rows] = np.where(shown, mirrored.sun[:, 0], 0.0)
                self.cos_incidence[i, rows] = np.where(shown, mirrored.cos_incidence[:, 0], 1.0)
                self.sun_up[i, rows] = math.cos(visible_sun(light.solar_zenith)[1])
                self.radius[i, rows] = light.disc.lit_radius

    def variance(self, looks: CaseLooks, wind: FloatArray, slopes: NDArray[np.str_], law: partial[SlopeStatistics]) -> FloatArray:
        """Variance of glint in a pixel of every row [W² m⁻⁴ sr⁻², (rows,)].

        Parameters
        ----------
        looks : CaseLooks
            Lines of sight of the rows.
        wind : ndarray
            Winds [m s⁻¹, (rows,)].
        slopes : ndarray
            Names of their slope models.
        law : callable
            Slope statistics of a name and a wind.

        Returns
        -------
        ndarray
            0 where no light is mirrored.
        """
        total = np.zeros(wind.shape)
        seen = (looks.zenith, looks.slant, looks.solid_angle)
        for i in range(_LIGHTS):
            lit = np.flatnonzero(self.radiance[i] > 0.0)
            for key, of_key in groups_of(zip(slopes[lit].tolist(), wind[lit].tolist(), self.radius[i, lit].tolist(), strict=True)):
                assert isinstance(key, tuple)  # one of those of the loop
                (kind, speed, radius), rows = key, lit[of_key]
                zenith, slant, solid = (values[rows] for values in seen)
                share = wave_glint(speed).relative_variance(
                    law(kind, speed), radius, self.cos_incidence[i, rows], zenith, self.sun_up[i, rows], slant, solid
                )
                total[rows] += self.radiance[i, rows] ** 2 * share
        return total


@dataclass(frozen=True, eq=False)
class CaseLooks:
    """Lines of sight of a table's rows, and their pixels."""

    zenith: FloatArray  #: Zenith angle of the direction from the sea to the sensor [rad].
    slant: FloatArray  #: Distance to the sea [m].
    solid_angle: FloatArray  #: Solid angle of a pixel [sr].

    @classmethod
    def of(cls, height: FloatArray, depression: FloatArray, ifov: FloatArray) -> CaseLooks:
        """Return the looks of heights [m], depressions and sides of square pixels [rad]."""
        parts = [(float(view_zenith(h, d)), float(slant_range(h, surface_range(h, d)))) for h, d in zip(height, depression, strict=True)]
        zenith, slant = np.array(parts).T
        return cls(zenith, slant, ifov**2)
