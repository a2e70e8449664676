"""View of a sea by a sensor, and the sums over the band that every radiance of it needs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.protocol import Atmosphere
from seaglint.air.scattering.scattered_tables import SampledLight, ScatteredLight, scattered_in
from seaglint.air.unlit import UnlitAtmosphere
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


#: Temperature of a sea whose emission is 0 in any band [K]; Planck's law stays finite there.
_COLD: Final = 10.0


_THIN: Final = 1e-4  #: Least lit share of a disc of which glint is computed [1].


@dataclass(frozen=True)
class LightDisc:
    """Disc of a light in the sky: the Sun's, or the Moon's with its lit part.

    The lit part lies between the limb and the terminator, half an ellipse, and has one radiance. Glint is that of a disc with the same
    solid angle about the middle of the lit part: a rough sea does not show its shape.
    """

    radius: float  #: Angular radius [rad].
    #: Irradiance above the air over the Sun's at 1 au, of wavenumbers [cm-1, (n,)]; None for the Sun.
    ratio: Callable[[FloatArray], FloatArray] | None = None
    phase: float = 0.0  #: Angle between the directions from the disc's body to the Sun and to the viewer [rad]; 0 is a full disc.
    bright_limb: float = 0.0  #: Direction of the middle of the bright limb, from upwards clockwise as seen [rad].
    #: Zenith angle and azimuth of the disc's centre [rad] where they differ from the light's; None where they do not.
    centre: tuple[float, float] | None = None

    @property
    def lit(self) -> float:
        """Share of the disc that is lit [1].

        >>> LightDisc(4.5e-3, phase=0.5 * math.pi).lit
        0.5
        """
        # rounded: the cosine of a right angle is 6e-17
        return round(0.5 * (1.0 + math.cos(self.phase)), 15)

    @property
    def solid_angle(self) -> float:
        """Solid angle of the lit part [sr]."""
        return math.pi * self.radius**2 * self.lit

    @property
    def lit_radius(self) -> float:
        """Radius of a disc with the solid angle of the lit part, with which glint is computed [rad]."""
        return self.radius * math.sqrt(max(self.lit, _THIN))


LOWER_LIMB: Final = math.pi  #: Bright limb of a Moon without a Sun [rad]: the lower one, towards a Sun below the horizon.

SUN_DISC: Final = LightDisc(SOLAR_ANGULAR_RADIUS)  #: The Sun's disc.


@dataclass(frozen=True)
class Moonlight:
    """Moon over a sea, at the sensor's foot."""

    zenith: float  #: Zenith angle of the disc's centre, apparent [rad].
    azimuth: float  #: Azimuth of the disc's centre, clockwise from north [rad].
    disc: LightDisc  #: Radius, lit part and light.

    @property
    def middle(self) -> tuple[float, float]:
        """Zenith angle and azimuth of the middle of the lit part [rad]."""
        disc = self.disc
        zenith, azimuth = lit_middle(self.zenith, self.azimuth, disc.radius, disc.phase, disc.bright_limb)
        return float(zenith), float(azimuth)


def lit_middle(
    zenith: ArrayLike, azimuth: ArrayLike, radius: ArrayLike, phase: ArrayLike, bright_limb: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Zenith angle and azimuth of the middle of a disc's lit part, ``4 (1 - cos(phase)) / (3 pi)`` radii from its centre [rad].

    >>> zenith, azimuth = lit_middle(1.0, 0.5, 4.5e-3, 0.5 * math.pi, 0.0)
    >>> round(float(1.0 - zenith), 5), float(azimuth)
    (0.00191, 0.5)
    """
    shift = np.asarray(radius) * 4.0 / (3.0 * np.pi) * (1.0 - np.cos(phase))
    up, aside = shift * np.cos(bright_limb), shift * np.sin(bright_limb)
    sine, cosine = np.sin(zenith), np.cos(zenith)
    # the direction in the vertical plane of the centre: towards it, across to the right, and up
    towards, height = sine - up * cosine, cosine + up * sine
    return np.asarray(np.arctan2(np.hypot(towards, aside), height)), np.asarray(azimuth + np.arctan2(aside, towards))


def farthest_turn(height: float) -> float:
    """Turn of the vertical between the foot of a sensor at a height [m] and the farthest crest in view [rad].

    >>> round(math.degrees(farthest_turn(10_000.0)), 2)
    3.62
    """
    return float(turn_at(horizon_range(height) + horizon_range(_CREST)))


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
    disc: LightDisc = SUN_DISC  #: Disc of the light with the Sun's angles here: the Sun's, or the Moon's in a view of ``lights``.
    moon: Moonlight | None = None  #: The Moon beside the Sun; None without one.

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
    def lights(self) -> tuple[SeaView, SeaView | None]:
        """View with one light, and the second light's over a sea and air that emit nothing; None where one light is enough.

        The Sun is the first light and the Moon the second, whose mirrored light and disc are added to it. If the Sun gives no light, direct
        or scattered, to any place in view, the Moon is the only light; a Moon below the horizon of all places gives none.
        """
        if self.moon is None:
            return self, None
        sun = replace(self, moon=None)
        zenith, azimuth = self.moon.middle
        disc = replace(self.moon.disc, centre=(self.moon.zenith, self.moon.azimuth))
        moon = replace(sun, solar_zenith=zenith, solar_azimuth=azimuth, sun_distance_factor=1.0, scattering=False, disc=disc)
        try:
            up = moon.irradiance.any()
        except DomainError as refused:
            if refused.name != "solar_zenith":
                raise
            raise DomainError(f"the Moon: {refused}", name="moon.zenith_deg", value=refused.value, allowed=refused.allowed) from refused
        if not up:
            return sun, None
        if not sun.irradiance.any() and sun.scattered.is_dark:
            return moon, None
        return sun, replace(moon, atmosphere=UnlitAtmosphere(self.atmosphere), sea_temperature=_COLD)

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
        return farthest_turn(self.sensor_height)

    @cached_property
    def glint_width(self) -> float:
        """Standard deviation of the glint over azimuth at the horizon, where it is narrowest [rad]; infinite without a Sun.

        A Sun of elevation e is mirrored there over azimuths of the slopes' deviation times ``sin e``, blurred by its disc.
        """
        if not self.irradiance.any():
            return float("inf")
        slopes = np.sqrt(min(self.slopes.mss_up, self.slopes.mss_cross))
        return float(np.hypot(slopes * max(np.cos(self.solar_zenith), 0.0), 0.5 * self.disc.lit_radius))

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
        return self.above_air(self.atmosphere.solar_irradiance(zenith)[..., self.in_band.grid])

    def above_air(self, sunlight: FloatArray) -> FloatArray:
        """Return the light of this view's disc from sunlight at 1 au on the band's samples [(..., n)]."""
        light = self.sun_distance_factor * sunlight
        return np.asarray(light if self.disc.ratio is None else light * self.disc.ratio(self.in_band.wavenumber_cm))


def sea_arc(height: float | FloatArray, gamma: FloatArray) -> FloatArray:
    """Arc along the sea to the point that views the sensor at elevation ``gamma`` [m]: ``R' (depression - gamma)``."""
    excess = height / EFFECTIVE_EARTH_RADIUS
    # by half angles: cos(depression) (1 + h/R') = cos(gamma) loses its digits near the horizontal
    depression = 2.0 * np.arcsin(np.sqrt(np.minimum((0.5 * excess + np.sin(0.5 * gamma) ** 2) / (1.0 + excess), 1.0)))
    return np.asarray(EFFECTIVE_EARTH_RADIUS * np.maximum(depression - gamma, 0.0))
