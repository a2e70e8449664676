"""View of a sea by a sensor, and the sums over the band that every radiance of it needs."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.protocol import Atmosphere
from seaglint.air.scattering.scattered_tables import SampledLight, ScatteredLight, scattered_in
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS, SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray, horizon_range
from seaglint.base.errors import DomainError
from seaglint.facet.foam import FoamCover
from seaglint.facet.legs import NESTED, Shadowing
from seaglint.facet.sunlight import STEADY, SunTable, turn_at, visible_sun
from seaglint.optics.band import Band
from seaglint.optics.sea_water import WaterIndex
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

_CREST: Final = 20.0  #: Largest height of waves beyond the sea's horizon that may be in view [m].

#: Number of elevations of the Sun at which its light is tabulated: error below 2e-3 for a Sun 2 deg above the horizon, viewed from 10 km.
_SUN_NODES: Final = 257

#: Model of the sea without the Sun: facets that emit and mirror the sky, or a blackbody (Eqs. 6-7 of the source article).
Background = Literal["facets", "blackbody"]


@dataclass(frozen=True, eq=False)
class BandSum:
    """Quadrature of a band on an atmosphere's spectral samples. Make it with ``of``."""

    weights: FloatArray  #: Response times step [cm-1, (n,)].
    grid: slice  #: The samples used, of all of the atmosphere's.
    wavenumber_cm: FloatArray  #: Their wavenumbers [cm-1, (n,)].

    @classmethod
    def of(cls, band: Band, atmosphere: Atmosphere) -> BandSum:
        """Quadrature on the samples where the band responds.

        Raises
        ------
        DomainError
            For a band beyond the atmosphere's samples.
        """
        weights = band.weights(atmosphere.wavenumber_cm)
        used = np.flatnonzero(weights)
        grid = slice(int(used[0]), int(used[-1]) + 1)
        return cls(weights[grid], grid, atmosphere.wavenumber_cm[grid])

    def __call__(self, spectra: ArrayLike) -> FloatArray:
        """Band integral (...) [X] of spectra on all of the atmosphere's samples [X per cm-1, (..., samples)]."""
        return np.asarray(np.asarray(spectra)[..., self.grid] @ self.weights)


@dataclass(frozen=True, eq=False)
class SeaView:
    """Sensor, sea, air, Sun and band of a view, without its directions."""

    atmosphere: Atmosphere  #: Transmittance, path radiance, Sun and sky.
    band: Band  #: Spectral response; inside the atmosphere's grid.
    water: WaterIndex  #: Refractive index of the sea.
    slopes: SlopeStatistics  #: Statistics of its slopes.
    sea_temperature: float  #: Temperature of the sea's skin [K].
    sensor_height: float  #: Height of the sensor [m].
    #: Zenith angle of the Sun's centre at the sea at the sensor's foot, apparent [rad]; below the horizon is valid. Elsewhere the direction
    #: is relative to the vertical there (``seaglint.facet.sunlight``).
    solar_zenith: float
    solar_azimuth: float = 0.0  #: Azimuth of the Sun's centre there, apparent [rad].
    sun_distance_factor: float = 1.0  #: ``1/d^2`` with d the distance of the Sun in au [1].
    #: Legs shadowed by waves, for the Sun's light, and how. The nested law also weighs the facets that emit and mirror the sky; waves
    #: never hide the sky of these facets, apart from the facets that mirror the sea.
    shadowing: Shadowing = NESTED
    background: Background = "facets"  #: Sea without the Sun, facets or a blackbody (``Background``).
    scattering: bool = True  #: Whether sunlight that the air scatters counts; it does not over a sea that is a blackbody.
    #: Mean share of foam, for means; images have the share of each place. It does not count over a sea that is a blackbody.
    foam: FoamCover | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite(self.sensor_height) and self.sensor_height > 0.0):
            raise DomainError(
                f"sensor_height = {self.sensor_height:g} m is not above the sea; give a height > 0 m",
                name="sensor_height",
                value=self.sensor_height,
                allowed="above 0 m",
            )
        if not (np.isfinite(self.sea_temperature) and self.sea_temperature > 0.0):
            raise DomainError(
                f"sea_temperature = {self.sea_temperature:g} K; give the temperature of the sea in kelvin, e.g. 288.15",
                name="sea_temperature",
                value=self.sea_temperature,
                allowed="above 0 K",
            )
        if not 0.0 <= self.solar_zenith <= np.pi:
            raise DomainError(
                f"solar_zenith = {self.solar_zenith:g} rad is outside 0..pi; above pi/2 the Sun is below the horizon",
                name="solar_zenith",
                value=self.solar_zenith,
                allowed=(0.0, np.pi),
            )

    @cached_property
    def hiding(self) -> Shadowing:
        """Shadowing with its number of bands."""
        return self.shadowing.settled(self.slopes, self.solar_azimuth)

    @cached_property
    def in_band(self) -> BandSum:
        """Sums over the band on the atmosphere's samples."""
        return BandSum.of(self.band, self.atmosphere)

    @cached_property
    def scattered(self) -> ScatteredLight | SampledLight:
        """Scattered sunlight towards the sensor and the sea, Sun at 1 au; dark where the air scatters none."""
        over = self.in_band
        atmosphere = self.atmosphere if self.scattering and self.background == "facets" else None
        return scattered_in(atmosphere, over.grid, over.weights, self.sensor_height, self.solar_zenith, self.farthest_turn)

    @property
    def farthest_turn(self) -> float:
        """Turn of the vertical between the sensor's foot and the farthest crest in view [rad]."""
        return float(turn_at(horizon_range(self.sensor_height) + horizon_range(_CREST)))

    @cached_property
    def glint_width(self) -> float:
        """Standard deviation of the glint over azimuth at the horizon, where it is narrowest [rad]; infinite without a Sun.

        A Sun of elevation e is mirrored there over azimuths of the slopes' deviation times ``sin e``, blurred by its disc.
        """
        if not self.irradiance.any():
            return float("inf")
        slopes = np.sqrt(min(self.slopes.mss_up, self.slopes.mss_cross))
        return float(np.hypot(slopes * max(np.cos(self.solar_zenith), 0.0), 0.5 * SOLAR_ANGULAR_RADIUS))

    @cached_property
    def irradiance(self) -> FloatArray:
        """Sunlight at the sensor's foot normal to the beam on the band's samples [W m-2 per cm-1, (n,)], of the whole disc.

        A disc cut by the horizon counts with the middle of its visible part. A Sun below the horizon at the foot that may be above it at a
        place in view counts as a Sun on the horizon. 0 for a Sun below the horizon of all places.
        """
        return np.asarray(self._irradiance(np.atleast_1d(self._sunlit_zenith))[0])

    @property
    def _sunlit_zenith(self) -> float:
        """Zenith angle of the Sun to which ``irradiance`` belongs [rad]."""
        share, zenith = visible_sun(self.solar_zenith)
        if share == 0.0 and zenith - self.farthest_turn < 0.5 * np.pi + SOLAR_ANGULAR_RADIUS:
            return 0.5 * np.pi - SOLAR_ANGULAR_RADIUS
        return zenith

    @cached_property
    def sun_table(self) -> SunTable:
        """Ratio of sunlight in the band at places in view to ``irradiance``, by the sine of the Sun's elevation there.

        If the atmosphere holds no sunlight for a zenith angle, the nearest zenith angle that it covers is used.
        """
        if not self.irradiance.any():
            return STEADY
        elevation = 0.5 * np.pi - self.solar_zenith
        ends = np.array([elevation - self.farthest_turn, elevation + self.farthest_turn + SOLAR_ANGULAR_RADIUS])
        first, last = np.sin(np.clip(ends, 0.0, 0.5 * np.pi))
        up = np.linspace(first, last, _SUN_NODES)
        zenith = np.arccos(np.minimum(up, 1.0))
        try:
            irradiance = self._irradiance(zenith)
        except DomainError as refused:
            if refused.name != "solar_zenith" or not isinstance(refused.allowed, tuple):
                raise
            irradiance = self._irradiance(np.clip(zenith, *refused.allowed))
        weights = self.in_band.weights
        return SunTable(float(first), (_SUN_NODES - 1) / float(last - first), (irradiance @ weights) / float(self.irradiance @ weights))

    def _irradiance(self, zenith: FloatArray) -> FloatArray:
        """Spectral irradiance for zenith angles of the Sun [W m-2 per cm-1, (angles, n)]."""
        return np.asarray(self.sun_distance_factor * self.atmosphere.solar_irradiance(zenith)[..., self.in_band.grid])


def sea_arc(height: float | FloatArray, gamma: FloatArray) -> FloatArray:
    """Arc along the sea to the point that views the sensor at elevation ``gamma`` [m]: ``R' (depression - gamma)``."""
    excess = height / EFFECTIVE_EARTH_RADIUS
    # by half angles: cos(depression) (1 + h/R') = cos(gamma) loses its digits near the horizontal
    depression = 2.0 * np.arcsin(np.sqrt(np.minimum((0.5 * excess + np.sin(0.5 * gamma) ** 2) / (1.0 + excess), 1.0)))
    return np.asarray(EFFECTIVE_EARTH_RADIUS * np.maximum(depression - gamma, 0.0))
