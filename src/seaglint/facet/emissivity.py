"""Emissivity and reflectance of the rough sea: averages over the facets that a viewer sees.

With ``v`` the unit vector to the viewer, a facet of slope ``s`` takes the share

    w(s) ds = p(s) max(0, v_z - v_h . s) ds / A+

of the visible projected area (:func:`seaglint.sea.shadowing.smith.projected_area`). It mirrors the ray that arrives from
``r = 2 (n.v) n - v``; where ``r`` points below the horizontal the ray comes from the sea again. Slopes for which it does lie outside
a circle of the slope plane, so the quadrature is split on that circle and integrates smooth functions only. A Gram-Charlier density is its
Gaussian times a polynomial, taken at the nodes of the Gaussian's rule.

References
----------
Masuda, Takashima and Takayama 1988, Remote Sens. Environ. 24, 313 (average without the second reflection);
Wu and Smith 1997, Appl. Opt. 36, 2609 (with sea-to-sea reflection).

Facets of synthesised waves are in ``seaglint.facet.thermal``; each quadrature is the other's check.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.optics.fresnel import ReflectanceSeries
from seaglint.sea.shadowing.nested import nested_ratio
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

# Against a rule with six times the nodes in each direction the emissivity is within 5e-7, winds 0.5-20 m/s, zenith 0-90.5 deg,
# isotropic and directional: far below the errors of the slope models, and cheap.
_ACROSS: Final = 8
_UP: Final = 16
_DOWN: Final = 8
_CUT: Final = 5.5  # standard deviations; the tail beyond holds 4e-8


class RefractiveIndex(Protocol):
    """Interface of a table of the refractive index of water."""

    def index(self, wavenumber_cm: FloatArray) -> NDArray[np.complex128]:
        """Complex refractive index n + i k at the given wavenumbers [cm⁻¹]."""
        ...


@dataclass(frozen=True)
class FacetNodes:
    """Quadrature over the visible facets; all arrays have the shape of the view zenith plus one axis of nodes."""

    cos_incidence: FloatArray  #: Cosine of the angle between facet normal and viewer [1].
    reflected_zenith: FloatArray  #: Zenith angle of the direction the mirrored ray arrives from [rad].
    weight: FloatArray  #: Share of the visible projected area [1]; adds up to 1 over the nodes.
    meets_sea: NDArray[np.bool_]  #: Whether the mirrored ray comes from below the horizontal, from the sea.


def _frame_shape(slopes: SlopeStatistics, azimuth: float, along: FloatArray, across: FloatArray) -> FloatArray:
    """Ratio of the slope density to its Gaussian, for slopes along ``azimuth`` and 90 degrees clockwise of it."""
    turn = azimuth - slopes.wind_to_azimuth
    s, c = float(np.sin(turn)), float(np.cos(turn))
    downwind, cross = along * c - across * s, along * s + across * c
    return slopes.shape(cross / np.sqrt(slopes.mss_cross), -downwind / np.sqrt(slopes.mss_up))


def _frame_covariance(slopes: SlopeStatistics, azimuth: float) -> tuple[float, float, float]:
    """Slope covariance (along, along-across, across) for axes along ``azimuth`` and 90 degrees clockwise of it."""
    turn = azimuth - slopes.wind_to_azimuth
    s, c = float(np.sin(turn)), float(np.cos(turn))
    return (
        slopes.mss_up * c * c + slopes.mss_cross * s * s,
        (slopes.mss_cross - slopes.mss_up) * s * c,
        slopes.mss_up * s * s + slopes.mss_cross * c * c,
    )


def facet_nodes(view_zenith: ArrayLike, slopes: SlopeStatistics, view_azimuth: float = 0.0, nested_bands: float = 1.0) -> FacetNodes:
    """Nodes and weights of the average over visible facets.

    Parameters
    ----------
    view_zenith : array_like
        Zenith angle of the direction from the sea to the viewer [rad, any shape]; 0 to pi/2 and, for a sea with slopes, somewhat beyond.
    slopes : SlopeStatistics
        Slope statistics, Gaussian or not; a flat sea gives one mirror direction.
    view_azimuth : float
        Azimuth of the direction from the sea to the viewer [rad]; matters for a directional sea only.
    nested_bands : float
        Bands of nested shadowing (:mod:`seaglint.sea.shadowing.nested`), for views to the horizon; 1 is Smith's law. The ratio of
        Gaussian slopes with the same variances is used; the weights add up to 1 over any density.

    Returns
    -------
    FacetNodes
        192 nodes per view, 384 where the two sides of the view differ: a directional sea viewed obliquely to the wind, a skewed
        sea viewed from anywhere but up or down the wind.

    Raises
    ------
    DomainError
        For angles at which no facet is visible.
    """
    theta = np.asarray(view_zenith, dtype=np.float64)[..., None]
    if not np.all((theta >= 0.0) & (theta < np.pi)):
        raise DomainError(
            "view zenith must be finite and in [0, pi) rad; give the direction from the sea to the viewer",
            name="view_zenith",
            value=float(theta[~((theta >= 0.0) & (theta < np.pi))].ravel()[0]),
            allowed="0 to below pi rad",
        )
    cosine, sine = np.cos(theta), np.sin(theta)
    along_var, covariance, across_var = _frame_covariance(slopes, view_azimuth)
    if along_var <= 0.0:
        along, across, share = _slopes_across_only(cosine, across_var)
    else:
        even = slopes.is_gaussian or float(np.sin(view_azimuth - slopes.wind_to_azimuth)) == 0.0
        along, across, share = _slopes_both(cosine, sine, along_var, covariance, across_var, even=even)
        if not slopes.is_gaussian:
            share = share * _frame_shape(slopes, view_azimuth, along, across)
    projection = cosine - sine * along
    weight = share * np.maximum(projection, 0.0)
    if nested_bands > 1:
        weight = weight * nested_ratio(along, theta, along_var, nested_bands)
    area = weight.sum(axis=-1, keepdims=True)
    if np.any(area <= 1e-300):
        raise DomainError("no facet of this sea is visible from past its horizon; give a view zenith below 90 deg or a rougher sea")
    # square of the normal's upward component; the mirrored ray rises by r_z = 2 (n.v) n_z - v_z
    vertical = 1.0 / (1.0 + along * along + across * across)
    rise = 2.0 * projection * vertical - cosine
    reflected_zenith = np.arccos(np.clip(rise, -1.0, 1.0))
    return FacetNodes(
        cos_incidence=np.clip(projection * np.sqrt(vertical), 0.0, 1.0),
        reflected_zenith=reflected_zenith,
        weight=weight / area,
        meets_sea=reflected_zenith > 0.5 * np.pi,
    )


def _slopes_across_only(cosine: FloatArray, across_var: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Slopes and probabilities of a sea without slopes along the view (flat, or a crest line viewed end on)."""
    if across_var <= 0.0:
        zero = np.zeros_like(cosine)
        return zero, zero, np.ones_like(cosine)
    x, w = np.polynomial.legendre.leggauss(_UP)
    across = np.sqrt(across_var) * _CUT * x
    share = w * np.exp(-0.5 * (_CUT * x) ** 2)
    shape = (*cosine.shape[:-1], across.size)
    return np.zeros(shape), np.broadcast_to(across, shape), np.broadcast_to(share, shape)


def _slopes_both(
    cosine: FloatArray, sine: FloatArray, along_var: float, covariance: float, across_var: float, *, even: bool
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Slopes along and across the view azimuth and their unnormalised probabilities, split at the slope of horizontal mirrored rays.

    ``even``: the density of standardised slopes is the same on both sides of the view.
    """
    across, across_share = _across_rule(across_var, symmetric=even and covariance == 0.0)
    mean = covariance / across_var * across if across_var > 0.0 else np.zeros_like(across)
    sigma = np.sqrt(max(along_var - (covariance**2 / across_var if across_var > 0.0 else 0.0), 1e-12 * along_var))
    with np.errstate(divide="ignore"):
        horizon = cosine / sine  # slope of facets viewed edge on; infinite at nadir
    low = np.minimum(mean - _CUT * sigma, horizon - 2.0 * sigma)
    high = np.maximum(np.minimum(mean + _CUT * sigma, horizon), low)
    turn = np.clip(_turning_slope(cosine, sine, across), low, high)
    # steeper slopes mirror the sea: the integrand may jump at the turning slope, so each side has its own rule
    parts = []
    for order, start, stop in ((_UP, low, turn), (_DOWN, turn, high)):
        x, w = np.polynomial.legendre.leggauss(order)
        half = 0.5 * (stop - start)[..., None]
        along = start[..., None] + half * (1.0 + x)
        share = across_share[:, None] * half * w * np.exp(-0.5 * ((along - mean[:, None]) / sigma) ** 2)
        parts.append((along, np.broadcast_to(across[:, None], along.shape), share))
    stacked = [np.concatenate([p[i].reshape(*cosine.shape[:-1], -1) for p in parts], axis=-1) for i in range(3)]
    return stacked[0], stacked[1], stacked[2]


def _across_rule(across_var: float, *, symmetric: bool) -> tuple[FloatArray, FloatArray]:
    """Nodes of the slope across the view; one sign alone where both give the same result."""
    if across_var <= 0.0:
        return np.zeros(1), np.ones(1)
    order = 2 * _ACROSS
    x, w = np.polynomial.legendre.leggauss(order)
    if symmetric:
        x, w = x[_ACROSS:], w[_ACROSS:]
    return np.sqrt(across_var) * _CUT * x, w * np.exp(-0.5 * (_CUT * x) ** 2)


def _turning_slope(cosine: FloatArray, sine: FloatArray, across: FloatArray) -> FloatArray:
    """Slope along the view at which the mirrored ray is horizontal: ``(s + tan)^2 + t^2 = 1/cos^2``, stable beyond the horizon."""
    root = np.maximum(1.0 - (cosine * across) ** 2, 0.0)
    outside = (cosine * across) ** 2 >= 1.0
    inside = cosine * (1.0 - across**2) / np.where(outside, 1.0, sine + np.sqrt(root))
    # beyond the circle every mirrored ray turns down; past the horizon (cosine < 0) none does
    edge = np.where(outside, -np.inf, inside)
    return np.asarray(np.where(cosine <= 0.0, np.inf, edge))


def emissivity(
    view_zenith: ArrayLike,
    slopes: SlopeStatistics,
    water: RefractiveIndex,
    wavenumber_cm: ArrayLike,
    *,
    view_azimuth: float = 0.0,
    sea_to_sea: bool = True,
) -> FloatArray:
    """Emissivity of the rough sea, averaged over the visible facets.

    ``eps_bar = 1 - sum_i w_i rho(omega_i) [mirrored ray comes from the sky]``

    Parameters
    ----------
    view_zenith : array_like
        Zenith angle of the direction from the sea to the viewer [rad, any shape].
    slopes : SlopeStatistics
        Slope statistics, Gaussian or not.
    water : RefractiveIndex
        Complex refractive index of the water.
    wavenumber_cm : array_like
        Wavenumbers [cm⁻¹, (n,)].
    view_azimuth : float
        Azimuth of the direction to the viewer [rad].
    sea_to_sea : bool
        Count mirrored rays that come from the sea as seeing a blackbody at the temperature of the sea (so the sum of this and
        of the reflectance towards the sky is 1). Off: the facets' own emission only.

    Returns
    -------
    ndarray
        Emissivity [1], shape of ``view_zenith`` plus (n,).

    Notes
    -----
    Finite and smooth to the horizon. With the second reflection within 0.001 of Wu and Smith's table at 3.4-5 um.

    References
    ----------
    Wu and Smith 1997, Appl. Opt. 36, 2609.
    """
    nodes = facet_nodes(view_zenith, slopes, view_azimuth)
    weight = np.where(nodes.meets_sea, 0.0, nodes.weight) if sea_to_sea else nodes.weight
    series = ReflectanceSeries.of(water.index(np.atleast_1d(np.asarray(wavenumber_cm, dtype=np.float64))))
    # moments of the incidence first: the sum over facets is then taken once for all wavenumbers
    moments = np.einsum("...i,...ij->...j", weight, series.basis(nodes.cos_incidence))
    return np.asarray(1.0 - moments @ series.coefficients)
