"""Transmittance and sunlight of one profile at many winds: gases are summed once, the wind's aerosol for each.

Transmittance is ``exp(-gases - aerosol)``, and only the aerosol knows the wind. For what needs no emission: likelihoods of sunlight.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.air.profile.air_profile import AirProfile
from seaglint.air.profile.air_sums import CUTS, AirSums, laid_lines
from seaglint.air.profile.band_numbers import Spectroscopy
from seaglint.air.profile.hazes import HazeWeather
from seaglint.air.protocol import require_solar_zenith, slant_range
from seaglint.base.conventions import FloatArray


@dataclass(frozen=True, eq=False)
class _LaidPaths:
    """Paths or rays laid end to end, and the optical depth of their gases.

    Heights of the cuts [m], lengths of the parts [m], first piece of each path, and depths [1, (paths, n)].
    """

    height: FloatArray
    length: FloatArray
    first: NDArray[np.intp]
    gases: FloatArray


@dataclass(frozen=True, eq=False)
class WindyAir:
    """Profile with the Navy's aerosol at any wind. Make it with :meth:`of`.

    Examples
    --------
    >>> from seaglint.air.profile.air_profile import model_profile
    >>> air = WindyAir.of(model_profile("tropical"), np.arange(2000.0, 2861.0, 5.0))
    >>> calm, storm = (air.at(wind).transmittance(20.0, [5000.0]).mean() for wind in (1.0, 18.0))
    >>> bool(storm < calm)
    True
    """

    sums: AirSums
    _paths: dict[tuple[float, ...], _LaidPaths] = field(default_factory=dict)

    @classmethod
    def of(cls, profile: AirProfile, wavenumber_cm: FloatArray, spectroscopy: Spectroscopy = "lblrtm") -> WindyAir:
        """Air of a profile on channels [cm-1, (n,)]."""
        return cls(AirSums(profile, HazeWeather(), wavenumber_cm, spectroscopy=spectroscopy))

    def at(self, wind: float) -> AirAtWind:
        """The air at a wind [m s-1], also that of the last 24 hours."""
        sums = self.sums
        haze = HazeWeather(wind=wind, wind_24h=wind)
        return AirAtWind(self, AirSums(sums.profile, haze, sums.laws.wavenumber_cm, spectroscopy=sums.spectroscopy))

    def paths(self, height: float, slant: FloatArray) -> _LaidPaths:
        """Paths from the sea to a height [m] of lengths [m, (paths,)]."""
        key = (height, *slant.tolist())
        if key not in self._paths:
            lines = [self.sums.cut_line(height, 0.0, float(s)) for s in slant]
            gases = np.array([self.sums.gas_depth(*self.sums.line_amounts(*line)) for line in lines])
            self._paths[key] = _LaidPaths(*laid_lines(lines), gases)
        return self._paths[key]

    def rays(self, zenith: FloatArray) -> _LaidPaths:
        """Rays from the sea at zenith angles [rad, (rays,)] to the Sun."""
        key = (0.0, *zenith.tolist())
        if key not in self._paths:
            rays = [self.sums.air.ray(0.0, float(z)) for z in zenith]
            lines = [(ray.between(CUTS), np.repeat(ray.length / CUTS, CUTS)) for ray in rays]
            gases = np.array([self.sums.gas_depth(*self.sums.ray_amounts(ray)) for ray in rays])
            self._paths[key] = _LaidPaths(*laid_lines(lines), gases)
        return self._paths[key]


@dataclass(frozen=True, eq=False)
class AirAtWind:
    """Transmittance and sunlight of :class:`WindyAir` at one wind."""

    air: WindyAir  #: What does not depend on the wind.
    sums: AirSums  #: The aerosol.
    _light: dict[tuple[float, ...], FloatArray] = field(default_factory=dict)

    @property
    def wavenumber_cm(self) -> FloatArray:
        """Channels [cm-1, (n,)]."""
        return self.sums.laws.wavenumber_cm

    def transmittance(self, height: float, range_m: ArrayLike) -> FloatArray:
        """Transmittance [1, (m, n)] of the paths from the sea at arcs [m, (m,)] to a height [m]."""
        return self._passed(self.air.paths(height, slant_range(height, np.atleast_1d(np.asarray(range_m, np.float64)))))

    def solar_irradiance(self, solar_zenith: ArrayLike) -> FloatArray:
        """Sunlight at the sea, normal to the beam, Sun at 1 au [W m-2 per cm-1, (m, n)]; 0 beyond a zenith angle of pi/2."""
        zenith = np.atleast_1d(require_solar_zenith(solar_zenith))
        key = tuple(zenith.tolist())
        if key not in self._light:
            up = zenith <= 0.5 * np.pi
            self._light[key] = np.zeros((zenith.size, self.wavenumber_cm.size))
            if up.any():
                self._light[key][up] = self.sums.laws.source * self._passed(self.air.rays(zenith[up]))
        return self._light[key]

    def _passed(self, paths: _LaidPaths) -> FloatArray:
        haze = np.add.reduceat(self.sums.haze_amounts(paths.height, paths.length), paths.first, axis=0)
        return np.asarray(np.exp(-paths.gases - self.sums.haze_depth(haze)))
