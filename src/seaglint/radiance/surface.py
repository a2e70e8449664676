"""Spectra of a rough sea without the Sun: what it emits and which sky it mirrors, averaged over the facets a viewer sees."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from seaglint.atmosphere.base import Atmosphere
from seaglint.conventions import FloatArray
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import ReflectanceSeries
from seaglint.sea.emissivity import facet_nodes
from seaglint.sea.slopes import SlopeStatistics

_ZENITH_NODES: Final = 40
"""View zeniths at which the facets are summed; Chebyshev points with a spline between leave below 1e-5 of the radiance."""

_AZIMUTH_NODES: Final = 5
"""View azimuths from along to across the wind; even harmonics up to the eighth."""


@dataclass(frozen=True, eq=False)
class SeaLeaving:
    """Spectra that leave the sea towards the viewer, W m-2 sr-1 per cm-1, shape (..., n)."""

    emission: FloatArray
    sky: FloatArray


def sea_leaving(
    view_zenith: ArrayLike,
    view_azimuth: float,
    slopes: SlopeStatistics,
    reflectance: ReflectanceSeries,
    atmosphere: Atmosphere,
    sea_temperature: float,
    grid: slice = slice(None),
) -> SeaLeaving:
    r"""Emission and mirrored sky of the sea, facet by facet.

    .. math::

        L_{emission} = (1 - \sum_{sky} w_i \rho_i)\,B(T), \qquad L_{sky} = \sum_{sky} w_i \rho_i L_s(\theta_i)

    Both sums run over the facets whose mirrored ray comes from the sky; the others see the sea, taken as a blackbody. So in a closed
    cavity of the sea's own temperature the two add up to ``B(T)`` for any slopes.

    Parameters
    ----------
    view_zenith : array_like
        Zenith angle of the direction from the sea to the viewer [rad, (...)].
    view_azimuth : float
        Its azimuth [rad]; matters for directional slopes only.
    slopes, reflectance, atmosphere, sea_temperature
        The sea's slopes, the Fresnel reflectance of its water on ``atmosphere.wavenumber_cm[grid]``, what is above it, and its
        temperature [K].
    grid : slice
        Part of the atmosphere's spectral grid to work on.

    Returns
    -------
    SeaLeaving
        Spectra at the sea, shape (..., n).
    """
    nodes = facet_nodes(view_zenith, slopes, view_azimuth)
    blackbody = planck_wavenumber(atmosphere.wavenumber_cm[grid], sea_temperature)
    weight = np.where(nodes.meets_sea, 0.0, nodes.weight)
    shares = weight[..., None] * reflectance(nodes.cos_incidence)
    zenith = np.minimum(nodes.reflected_zenith, 0.5 * np.pi)
    sky = np.einsum("...in,...in->...n", shares, atmosphere.sky_radiance(zenith)[..., grid])
    return SeaLeaving((1.0 - shares.sum(axis=-2)) * blackbody, sky)


def sea_leaving_map(
    view_zenith: FloatArray,
    view_azimuth: FloatArray,
    slopes: SlopeStatistics,
    reflectance: ReflectanceSeries,
    atmosphere: Atmosphere,
    sea_temperature: float,
    grid: slice = slice(None),
) -> SeaLeaving:
    """The same on rows of view zenith and columns of azimuth: shape (rows, 1, n) for isotropic slopes, else (rows, columns, n).

    Many rows are interpolated: a cubic spline through Chebyshev points in view zenith, even harmonics of the angle to the wind in azimuth.
    """
    if slopes.is_isotropic:
        emission, sky = _rows(view_zenith, float(view_azimuth[0]), slopes, reflectance, atmosphere, sea_temperature, grid)
        return SeaLeaving(emission[:, None, :], sky[:, None, :])
    m = np.arange(_AZIMUTH_NODES)
    angles = 0.5 * np.pi * m / (_AZIMUTH_NODES - 1)
    harmonics = np.linalg.solve(np.cos(2.0 * np.outer(angles, m)), np.eye(_AZIMUTH_NODES))
    share = np.cos(2.0 * np.outer(view_azimuth - slopes.wind_to_azimuth, m)) @ harmonics
    parts = [
        _rows(view_zenith, slopes.wind_to_azimuth + float(angle), slopes, reflectance, atmosphere, sea_temperature, grid)
        for angle in angles
    ]
    emission, sky = (np.einsum("ca,arn->rcn", share, np.stack([part[i] for part in parts])) for i in (0, 1))
    return SeaLeaving(np.asarray(emission), np.asarray(sky))


def _rows(
    view_zenith: FloatArray,
    view_azimuth: float,
    slopes: SlopeStatistics,
    reflectance: ReflectanceSeries,
    atmosphere: Atmosphere,
    sea_temperature: float,
    grid: slice,
) -> tuple[FloatArray, FloatArray]:
    low, high = float(np.min(view_zenith)), float(np.max(view_zenith))
    if view_zenith.size <= _ZENITH_NODES or high - low < 1e-6:
        direct = sea_leaving(view_zenith, view_azimuth, slopes, reflectance, atmosphere, sea_temperature, grid)
        return direct.emission, direct.sky
    nodes = 0.5 * (low + high) - 0.5 * (high - low) * np.cos(np.pi * np.arange(_ZENITH_NODES) / (_ZENITH_NODES - 1))
    nodes[[0, -1]] = low, high
    table = sea_leaving(nodes, view_azimuth, slopes, reflectance, atmosphere, sea_temperature, grid)
    return tuple(np.asarray(CubicSpline(nodes, part, axis=0)(view_zenith)) for part in (table.emission, table.sky))  # type: ignore[return-value]
