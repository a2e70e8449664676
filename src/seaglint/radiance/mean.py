r"""Mean radiance of the sea at the aperture (Eqs. 1-8 of the source article), integrated per wavenumber.

.. math:: L = L_{path} + \tau\,(\bar\epsilon B(T) + L_{sky} + L_{sun})
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from seaglint.atmosphere.base import Atmosphere
from seaglint.constants import SOLAR_ANGULAR_RADIUS
from seaglint.conventions import FloatArray, surface_range, view_zenith
from seaglint.errors import DomainError
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import ReflectanceSeries
from seaglint.optics.sea_water import WaterIndex
from seaglint.radiance.glint import Shadowing, glint, visible_sun
from seaglint.radiance.surface import SeaSurface
from seaglint.sea.slopes import SlopeStatistics

Background = Literal["facets", "blackbody"]
"""What the sea shows beside the Sun: facets that emit and mirror the sky, or a blackbody (Eqs. 6-7 of the source article)."""


@dataclass(frozen=True, eq=False)
class SeaView:
    """Everything but the directions: who looks at which sea through what.

    Attributes
    ----------
    atmosphere : Atmosphere
        Transmittance, path radiance, Sun and sky.
    band : Band
        Spectral response; inside the atmosphere's grid.
    water : WaterIndex
        Refractive index of the sea.
    slopes : SlopeStatistics
        Statistics of its slopes.
    sea_temperature : float
        Temperature of the sea's skin [K].
    sensor_height : float
        Height of the sensor [m].
    solar_zenith, solar_azimuth : float
        Direction from the sea to the Sun's centre, apparent [rad]; below the horizon is valid.
    sun_distance_factor : float
        ``1/d^2`` with d the distance of the Sun in au [1].
    shadowing : {"both", "viewer"}
        Legs shadowed by waves, for the Sun's light.
    background : {"facets", "blackbody"}
        See :data:`Background`.
    """

    atmosphere: Atmosphere
    band: Band
    water: WaterIndex
    slopes: SlopeStatistics
    sea_temperature: float
    sensor_height: float
    solar_zenith: float
    solar_azimuth: float = 0.0
    sun_distance_factor: float = 1.0
    shadowing: Shadowing = "both"
    background: Background = "facets"

    def __post_init__(self) -> None:
        if not (np.isfinite(self.sensor_height) and self.sensor_height > 0.0):
            raise DomainError(f"sensor_height = {self.sensor_height:g} m is not above the sea; give a height > 0 m")
        if not (np.isfinite(self.sea_temperature) and self.sea_temperature > 0.0):
            raise DomainError(f"sea_temperature = {self.sea_temperature:g} K; give the temperature of the sea in kelvin, e.g. 288.15")
        if not 0.0 <= self.solar_zenith <= np.pi:
            raise DomainError(f"solar_zenith = {self.solar_zenith:g} rad is outside 0..pi; above pi/2 the Sun is below the horizon")


@dataclass(frozen=True, eq=False)
class SeaRadiance:
    """Band radiance at the aperture by origin [W m-2 sr-1]; arrays broadcast to (rows, columns).

    Attributes
    ----------
    path : ndarray
        Thermal radiance of the air between sea and sensor; 0 above the horizon.
    emission : ndarray
        Emission of the sea, attenuated; 0 above the horizon.
    sky : ndarray
        Sky mirrored by the sea, attenuated; above the horizon the sky itself.
    sun : ndarray
        Sun mirrored by the sea, attenuated; the Sun itself is not drawn above the horizon.
    chance : ndarray
        Share of the viewed area that mirrors the Sun [1, (rows, columns)]; 0 without a Sun and above the horizon.
    cos_incidence : ndarray
        Cosine of the angle of incidence on the mirroring facets [1, (rows, columns)]; 0 in the same places.
    """

    path: FloatArray
    emission: FloatArray
    sky: FloatArray
    sun: FloatArray
    chance: FloatArray
    cos_incidence: FloatArray

    @property
    def total(self) -> FloatArray:
        """Sum of all [W m-2 sr-1, (rows, columns)]."""
        return np.asarray(self.path + self.emission + self.sky + self.sun)


def mean_radiance(view: SeaView, elevation: ArrayLike, azimuth: ArrayLike) -> SeaRadiance:
    r"""Mean radiance seen at elevations and azimuths.

    .. math::

        L_{sun} = \int R\,\tau\,\frac{\rho(\omega)\,E}{\pi\epsilon^2}\,P\;d\nu

    with P of :func:`seaglint.radiance.glint.glint`; for slopes much wider than the Sun's image this is Eq. 8.

    Parameters
    ----------
    view : SeaView
        Sensor, sea, air and Sun.
    elevation : array_like
        Elevations of the lines of sight [rad, (rows,)]; negative below the horizontal.
    azimuth : array_like
        Azimuths of the lines of sight, clockwise from north [rad, (columns,)].

    Returns
    -------
    SeaRadiance
        Components, each (rows, 1) or (rows, columns); ``.total`` is (rows, columns).

    Raises
    ------
    DomainError
        A band beyond the atmosphere's grid, or whatever atmosphere, water or slopes refuse.

    Notes
    -----
    Everything is integrated on the atmosphere's spectral samples; structure finer than these (20 cm-1 averages in LOWTRAN7) is not
    resolved, so correlations of absorption between sunlight and path inside them are missed. Rows above the sea horizon show the sky.

    References
    ----------
    Source article Eqs. 1-8 and Fig. 1.
    """
    rows = np.atleast_1d(np.asarray(elevation, dtype=np.float64))
    columns = np.atleast_1d(np.asarray(azimuth, dtype=np.float64))
    if rows.ndim != 1 or columns.ndim != 1 or rows.size == 0 or columns.size == 0:
        raise DomainError(f"elevation and azimuth must be lists of angles, not of shapes {rows.shape} and {columns.shape}")
    weights, grid = band_grid(view.band, view.atmosphere)
    theta = view_zenith(view.sensor_height, -rows)
    sea = np.isfinite(theta)
    path, emission, sky = (np.zeros((rows.size, 1 if view.slopes.is_isotropic else columns.size)) for _ in range(3))
    sun, chance, cos_incidence = (np.zeros((rows.size, columns.size)) for _ in range(3))
    if np.any(~sea):
        above = view.atmosphere.sky_radiance(0.5 * np.pi - rows[~sea], view.sensor_height)
        sky[~sea] = (above[..., grid] @ weights)[:, None]
    if np.any(sea):
        arc = surface_range(view.sensor_height, -rows[sea])
        seen = view.atmosphere.transmittance(view.sensor_height, arc)[..., grid] * weights
        path[sea] = (view.atmosphere.path_radiance(view.sensor_height, arc)[..., grid] @ weights)[:, None]
        emission[sea], sky[sea] = _background(view, theta[sea], columns, seen, grid)
        sun[sea], chance[sea], cos_incidence[sea] = _sun(view, theta[sea], columns, seen, grid)
    return SeaRadiance(path, emission, sky, sun, chance, cos_incidence)


def band_grid(band: Band, atmosphere: Atmosphere) -> tuple[FloatArray, slice]:
    """Quadrature weights [cm-1, (n,)] of the band, and the part of the atmosphere's grid they belong to."""
    weights = band.weights(atmosphere.wavenumber_cm)
    used = np.flatnonzero(weights)
    grid = slice(int(used[0]), int(used[-1]) + 1)
    return weights[grid], grid


def _series(view: SeaView, grid: slice) -> ReflectanceSeries:
    return ReflectanceSeries.of(view.water.index(view.atmosphere.wavenumber_cm[grid]))


def _background(view: SeaView, theta: FloatArray, columns: FloatArray, seen: FloatArray, grid: slice) -> tuple[FloatArray, FloatArray]:
    """Emission and mirrored sky behind the air [W m-2 sr-1, (rows, 1 or columns)]."""
    if view.background == "blackbody":
        blackbody = (seen @ planck_wavenumber(view.atmosphere.wavenumber_cm[grid], view.sea_temperature))[:, None]
        return blackbody, np.zeros_like(blackbody)
    surface = SeaSurface.create(view.atmosphere, view.water, view.sea_temperature, grid)
    leaving = surface.leaving_map(theta, columns + np.pi, view.slopes, seen)
    return leaving.emission, leaving.sky


def _sun(view: SeaView, theta: FloatArray, columns: FloatArray, seen: FloatArray, grid: slice) -> tuple[FloatArray, ...]:
    """Mirrored Sun behind the air [W m-2 sr-1], its chance [1] and the cosine of its incidence [1], each (rows, columns)."""
    share, zenith = visible_sun(view.solar_zenith)
    if share == 0.0:
        none = np.zeros((theta.size, columns.size))
        return none, none, none
    mirrored = glint(theta[:, None], columns + np.pi, view.solar_zenith, view.solar_azimuth, view.slopes, view.shadowing)
    irradiance = view.sun_distance_factor * view.atmosphere.solar_irradiance(zenith)[..., grid]
    series = _series(view, grid)
    # The spectral sum over each Chebyshev term is taken per row; the pixels then only need their angle of incidence.
    per_term = (seen * irradiance) @ series.coefficients.T / (np.pi * SOLAR_ANGULAR_RADIUS**2)
    mirrored_sun = mirrored.chance * np.einsum("rcj,rj->rc", series.basis(mirrored.cos_incidence), per_term)
    return mirrored_sun, mirrored.chance, mirrored.cos_incidence
