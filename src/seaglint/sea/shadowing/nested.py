r"""Shadowing of a sea whose waves are nested: Smith's law applied band by band, longest waves first.

Smith's function takes heights and slopes for independent. On a sea of many scales visible facets lie on the visible flanks of
longer waves, so that visible slopes are steeper towards the viewer than Smith's. With the slope variance parted into N bands, and
:math:`p_0` the level sea,

.. math::

    p_n(s) = \int p_{n-1}(s_0)\, q(s - s_0)\, \frac{\max(0, v_z - v_h \cdot s)}{A_{n+}(s_0)}\, ds_0, \qquad
    A_{n+}(s_0) = \int q(s - s_0) \max(0, v_z - v_h \cdot s)\, ds

is the density of the slopes on the visible projected area; its integral stays 1. One band is Smith's (Saunders') law exactly.

Only the slope along the view decides whether a facet is hidden; across it the density is broadened as without hiding. With bands of equal
variance, the visible density over Smith's is therefore a function of two numbers, :math:`t = s/\sigma_1` and
:math:`\mu = \cot\theta_v/\sigma_1`, :math:`\sigma_1` the rms slope along the view: one small table per number of bands, for any sea.

In the limit of infinitely many bands the slope is a Brownian motion that never meets the slope viewed edge on, and the ratio becomes
:math:`(1 + \Lambda)(1 - e^{-2\mu(\mu - t)})`: at most :math:`1 + \Lambda`. Real waves are not infinitely far apart in scale: their number
of bands is fitted to brute force, ``bands_of``.

Facets that are both visible and lit have a law of the same kind, each band hiding facets from both legs
(``seaglint.sea.shadowing.seen_and_lit.coupling_table``). Over Smith's law
for two legs, a Sun opposite to the viewer has

.. math:: R(t) = R_v(t)\,R_s(-t)\,C(t), \qquad C = \frac{B}{R_v R_s}\Big|_{N_c\ bands}

with :math:`R_v` and :math:`R_s` the ratios of each leg alone and B the ratio of the joint law, of fewer bands the lower both legs are
(``seaglint.sea.shadowing.seen_and_lit.coupled_bands``). It is symmetric in viewer and Sun, and is
:math:`R_v` under a high Sun. With as many bands as each leg alone the joint law is many times too dark where few facets are left:
shadows of both legs fall on the same facets more often than bands that are independent allow.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import erf

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import kernel, njit
from seaglint.base.table_cache import cached_table
from seaglint.sea.shadowing.smith import projected_area, visible_area
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

#: Default number of bands of equal slope variance: about the number of winds above 7 m/s, 4.6 by ``bands_of``.
BANDS: Final = 5

#: Largest number of bands: at 64 the ratio is within 10 % of the limit of infinitely many, and the quadrature still resolves one band.
_MOST_BANDS: Final = 64

_ONE: Final = np.uint64(1)
_STEP: Final = 0.05
REACH: Final = 6.5  #: Largest slope that is integrated, in rms slopes.

HIGHEST: Final = 6.0  #: Elevation of the view, in rms slopes, above which nothing is hidden (1e-9 of the sea).

_ROWS: Final = round(HIGHEST / _STEP) + 4
_COLUMNS: Final = round(2.0 * REACH / _STEP) + 3
_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(200)


def _density(x: FloatArray) -> FloatArray:
    return np.asarray(np.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi))


def _area(x: FloatArray) -> FloatArray:
    """Visible area A+ over the rms slope, ``x Phi(x) + phi(x)``, for an edge x rms slopes away."""
    return np.asarray(0.5 * x * (1.0 + erf(x / math.sqrt(2.0))) + _density(x))


class _Quadrature(NamedTuple):
    """Quadrature over the slope of the longer waves: its nodes, the first band's visible density there and the factors of the next ones.

    ``projection`` is the projected area of the nodes, ``onward`` their weights over the visible area of one band about them, ``step[i, j]``
    the density of a band that leads from node j to node i, with ``onward``, and ``width`` the rms slope of one band.
    """

    slope: FloatArray
    seen: FloatArray
    projection: FloatArray
    onward: FloatArray
    step: FloatArray
    width: float


def _quadrature(mu: float, bands: int) -> _Quadrature:
    """Return the quadrature of a view ``mu`` rms slopes high."""
    # slopes above the one viewed edge on are hidden
    high = min(mu, REACH + 0.5)
    half = 0.5 * (high + REACH + 0.5)
    slope, weight = high - half * (1.0 - _GAUSS_X), half * _GAUSS_W
    width = 1.0 / math.sqrt(bands)
    projection = mu - slope
    # Areas of one band over its rms slope; the widths cancel against the width of the next factor but for the first.
    seen = _density(slope / width) * projection / (width * width * _area(np.asarray(mu / width)))
    onward = weight / (width * _area(projection / width))
    step = _density((slope[:, None] - slope) / width) / width * onward
    return _Quadrature(slope, seen, projection, onward, step, width)


def _log_ratio(t: FloatArray, mu: float, bands: int) -> FloatArray:
    """Logarithm of visible density over Smith's, by quadrature, at slopes ``t`` and one view ``mu`` (both in rms slopes)."""
    rule = _quadrature(mu, bands)
    seen = rule.seen
    for _ in range(bands - 2):
        seen = (rule.step @ seen) * rule.projection
    # the projected area of the last slope cancels against Smith's visible density, so that any slope has a ratio
    last = (_density((t[:, None] - rule.slope) / rule.width) / rule.width * rule.onward) @ seen
    # far beyond the edge, where no facet is visible, many narrow bands give 0
    return np.asarray(np.log(np.maximum(last * _area(np.asarray(mu)), 1e-300)) - np.log(_density(t)))


def nested_chain(t: FloatArray, mu: float, bands: int) -> list[FloatArray]:
    """Mean slopes of the longest 1, 2, ... ``bands - 1`` bands together, of visible facets with the slopes ``t`` [1].

    Slopes along the view, and its elevation ``mu``, are in rms slopes; two or more bands.
    """
    rule = _quadrature(mu, bands)
    forward, seen = [rule.seen], rule.seen
    for _ in range(bands - 2):
        seen = (rule.step @ seen) * rule.projection
        forward.append(seen)
    # the facet's slope s fixed: backward densities of its last bands times forward densities of the first ones
    back = _density((t[:, None] - rule.slope) / rule.width) / rule.width * rule.onward
    out: list[FloatArray] = []
    for seen in reversed(forward):
        weight = back @ seen
        out.insert(
            0, np.where(weight > 1e-200, back @ (seen * rule.slope) / np.maximum(weight, 1e-200), (len(forward) - len(out)) / bands * t)
        )
        back = (back * rule.projection) @ rule.step
    return out


def bands_of(mss: float) -> float:
    """Number of bands of equal slope variance for a sea of total slope variance ``mss`` [1]: ``1.3 + 98 mss``, 4.6 at most.

    Fitted to brute force in the vertical plane of the Sun, on Gaussian seas with the shape of Elfouhaily's spectrum down to 1 cm and the
    slope variances of Cox and Munk: depressions of 0.5-10 deg, Suns 1-30 deg high. The visible and lit share agrees with brute force
    within 15 % at 2-7 m/s, at 3 and 12 m/s within 12 % above a tenth of Smith's law and 35 % below (``low_sun.csv``,
    ``docs/figures/hidden_facets.py``). Rougher seas carry more of their slopes in ripples, apart in scale from the waves.

    >>> round(bands_of(0.0286), 1)
    4.1
    """
    return min(1.3 + 98.0 * mss, 4.6)


def bands_of_breadth(breadth: float) -> float:
    """Number of bands [1] for waves of a breadth along the view: ``2.17 breadth - 0.4``, 1.3 to 4.6.

    The breadth is computed by ``seaglint.sea.shadowing.facet_lean.breadth``.

    Fitted to brute force in the vertical plane of the Sun, 0.5-10 deg down, Suns 2-20 deg high: isotropic and directional Elfouhaily seas
    of 2-12 m/s, and the seas of scenarios, whose ripples make up Cox and Munk's slopes.

    >>> round(bands_of_breadth(1.5), 2)
    2.85
    """
    return min(max(2.17 * breadth - 0.4, 1.3), 4.6)


def bands_of_facets(share: float, bands: float) -> float:
    """Number of bands for facets with a share of the slope variance, longer waves being geometry: ``N [1 - 1.02 (1 - share)^0.5]``.

    Geometry hides more than in proportion to its share of ``bands``, the longest waves most of all. Below 1 the facets hide less than by
    Smith's law: the waves on which they ride fall away from the viewer. At 0 they do not hide each other.

    Fitted in the vertical plane of the Sun: seas as for ``bands_of`` with waves down to 0.25-30 m as geometry and facets on them,
    against all waves as geometry. The visible and lit share in views of 0.5-7 deg, Suns 1-15 deg high, is within 5-25 % rms of brute force,
    the largest differences with both at 1 deg or below; within 20 % from 3 and 5 deg on (``docs/figures/hidden_facets.py``).

    >>> round(bands_of_facets(0.66, 4.8), 1)
    1.9
    """
    # below 2.6 bands, towards Smith's law at one band, the loss fades out: facets on a sea of Smith's law obey it too
    lost = 1.02 * min(max(bands - 1.0, 0.0) / 1.6, 1.0)
    return float(max(bands * (1.0 - lost * math.sqrt(1.0 - min(share, 1.0))), 0.0))


class Shelter(NamedTuple):
    """Shelter that geometry gives to the facets on it; see ``shelter_of_facets``."""

    slack: float  #: Share of the square of a low Sun's elevation over a facet that does not count.
    least: float  #: Least elevation of the Sun that counts, in rms slopes of the facets.
    together: float  #: Excess of facets that are both visible and lit, times both elevations in rms slopes.


NO_SHELTER: Final = Shelter(0.0, 0.0, 0.0)  #: Shelter of facets that carry all slopes.

SLACK_ENDS: Final = 1.22  #: Elevation of the Sun in rms slopes of the facets at which half of ``Shelter.slack`` is left.

LOWEST: Final = 0.1  #: Elevation in rms slopes of facets below which ``Shelter.together`` grows no more.


def shelter_of_facets(share: float) -> Shelter:
    r"""Shelter of facets with a ``share`` of the slope variance, longer waves being geometry.

    Where geometry lights a facet that faces away the sea falls off towards the Sun, so that ripples hide less than by Smith's law about
    the facet's tilt; facets that face the Sun are hidden more, as other waves are in front of them. The elevation :math:`\mu` of the Sun
    over the facet counts as ``counted_kernel``, and the visible and lit share is :math:`1 + b/(\mu_v \mu_s)` times the share by the
    law, with :math:`a = 0.60\,u`, :math:`m = 0.215\,u`, :math:`u = (1 - share)^{1/4}` and :math:`b = 0.058\,(1 - share)^{1/2}`.

    Fitted as ``bands_of_facets`` is.
    """
    left = max(1.0 - share, 0.0)
    grown = left**0.25
    return Shelter(0.60 * grown, 0.215 * grown, 0.058 * math.sqrt(left))


@kernel
def counted_kernel(edge: float, shelter: Shelter) -> float:
    r"""Elevation of the Sun over a sheltered facet that counts for its hiding, :math:`\sqrt{\mu^2 [1 - a/(1 + (\mu/1.22)^2)] + m^2}`.

    ``edge`` is the elevation :math:`\mu` in rms slopes of the facets, 0 or more, and the shelter has ``a`` and ``m``.
    """
    square = edge * edge
    return math.sqrt(square * (1.0 - shelter.slack / (1.0 + square / (SLACK_ENDS * SLACK_ENDS))) + shelter.least * shelter.least)


@lru_cache(maxsize=8)
def ratio_table(bands: int = BANDS) -> FloatArray:
    """Table of logarithms for ``nested_ratio_kernel`` [(rows, columns)]; empty for one band.

    Raises
    ------
    DomainError
        For less than one band or more than 64.
    """
    if not 1 <= bands <= _MOST_BANDS:
        raise DomainError(
            f"nested_bands = {bands} is outside 1-{_MOST_BANDS}; give 2 to 8 (1 is Saunders' law)",
            name="nested_bands",
            value=bands,
            allowed=(1, _MOST_BANDS),
        )
    if bands == 1:
        return np.zeros((0, 0))
    return _ratios(bands)


@cached_table
def _ratios(bands: int) -> FloatArray:
    """Table for two or more bands, 0.1 s of processor time each; a scene needs four."""
    t = np.asarray(_STEP * (np.arange(_COLUMNS, dtype=np.float64) - 1.0) - REACH, dtype=np.float64)
    return np.stack([_log_ratio(t, _STEP * (row - 1.0), bands) for row in range(_ROWS)])


@lru_cache(maxsize=16)
def between_bands(table: Callable[[int], FloatArray], bands: float) -> FloatArray:
    """Table of logarithms [1] (``ratio_table``) for a non-integer number of bands; empty for one.

    Ratios are mixed, not their logarithms, so that visible densities still add up to 1.
    """
    whole = max(int(bands), 1)
    remainder = max(bands, 1.0) - whole
    if remainder == 0.0:
        return table(whole)
    high = table(whole + 1)
    low = table(whole) if whole > 1 else np.zeros_like(high)
    return np.asarray(np.logaddexp(low + math.log1p(-remainder), high + math.log(remainder)))


@kernel
def _cubic(f: float, a: float, b: float, c: float, d: float) -> float:
    """Cubic interpolation between four even points, at the fraction ``f`` between the middle two."""
    return (
        -f * (f - 1.0) * (f - 2.0) / 6.0 * a
        + (f + 1.0) * (f - 1.0) * (f - 2.0) / 2.0 * b
        - (f + 1.0) * f * (f - 2.0) / 2.0 * c
        + (f + 1.0) * f * (f - 1.0) / 6.0 * d
    )


@kernel
def nested_ratio_kernel(slope: float, edge: float, deviation: float, table: FloatArray) -> float:
    """Ratio of the visible density of a nested sea to Smith's; see :func:`nested_ratio`.

    ``slope`` along the view, ``edge`` the cotangent of the view zenith, at least 0, ``deviation`` the rms slope along the view.
    """
    if table.size == 0 or edge >= HIGHEST * deviation:
        return 1.0
    # one row and column of the table lie before the first ones in use, so that the cubic has a point on each side
    column = (min(max(slope / deviation, -REACH), REACH) + REACH) / _STEP + 1.0
    row = max(edge, 0.0) / deviation / _STEP + 1.0
    i, j = min(int(row), table.shape[0] - 3), min(int(column), table.shape[1] - 3)
    f, g = row - i, column - j
    a = _cubic(g, table[i - 1, j - 1], table[i - 1, j], table[i - 1, j + 1], table[i - 1, j + 2])
    b = _cubic(g, table[i, j - 1], table[i, j], table[i, j + 1], table[i, j + 2])
    c = _cubic(g, table[i + 1, j - 1], table[i + 1, j], table[i + 1, j + 1], table[i + 1, j + 2])
    d = _cubic(g, table[i + 2, j - 1], table[i + 2, j], table[i + 2, j + 1], table[i + 2, j + 2])
    return math.exp(_cubic(f, a, b, c, d))


@kernel
def nested_exponent_kernel(slope: float, edge: float, deviation: float, table: FloatArray) -> float:
    """Logarithm of ``nested_ratio_kernel``, interpolated linearly: within 1e-3, for inner loops."""
    if table.shape[0] == 0 or edge >= HIGHEST * deviation:
        return 0.0
    column = (min(max(slope / deviation, -REACH), REACH) + REACH) / _STEP + 1.0
    row = max(edge, 0.0) / deviation / _STEP + 1.0
    # unsigned addresses spare the compiler's check for indices that count from the end
    i, j = np.uint64(min(int(row), table.shape[0] - 2)), np.uint64(min(int(column), table.shape[1] - 2))
    i1, j1 = np.uint64(i + _ONE), np.uint64(j + _ONE)
    f, g = row - float(i), column - float(j)
    low = table[i, j] + g * (table[i, j1] - table[i, j])
    high = table[i1, j] + g * (table[i1, j1] - table[i1, j])
    return float(low + f * (high - low))


@njit
def _map_ratio(slope: FloatArray, edge: FloatArray, deviation: FloatArray, table: FloatArray, out: FloatArray) -> None:
    for i in range(out.size):
        out[i] = nested_ratio_kernel(slope[i], edge[i], deviation[i], table)


def nested_ratio(slope_along: ArrayLike, view_zenith: ArrayLike, mss_along: ArrayLike, bands: float = BANDS) -> FloatArray:
    """Ratio of the visible slope density of a nested sea to the density by Smith's law.

    ``p_N(s) = ratio * p(s) max(0, v_z - v_h . s) / A+``

    Parameters
    ----------
    slope_along : array_like
        Slope along the view azimuth, positive where the sea rises towards the viewer [1]; visible facets have ``v_z > |v_h| s``.
    view_zenith : array_like
        Zenith angle of the direction to the viewer [rad], 0..pi/2.
    mss_along : array_like
        Slope variance along the view azimuth [1]; broadcast with the others.
    bands : float
        Bands of equal variance, whole or not; 1 gives 1 everywhere.

    Returns
    -------
    ndarray
        Ratio [1], broadcast shape; between 0 and 1 + Lambda. 1 for a flat sea.

    Raises
    ------
    DomainError
        View zeniths outside 0..pi/2, negative variances, bands outside 1-64.

    Notes
    -----
    For Gaussian slopes. Interpolated within 3e-4. Accuracy: ``bands_of``.

    Examples
    --------
    >>> import numpy as np
    >>> round(float(nested_ratio(-0.0788, np.radians(89.0), 0.0271)), 2)
    0.58
    """
    theta, variance = np.asarray(view_zenith, dtype=np.float64), np.asarray(mss_along, dtype=np.float64)
    if not np.all((theta >= 0.0) & (theta <= 0.5 * np.pi)):
        raise DomainError(
            "view_zenith must lie in 0..pi/2 rad: the direction from the sea to the sensor",
            name="view_zenith",
            value=float(theta[~((theta >= 0.0) & (theta <= 0.5 * np.pi))].ravel()[0]),
            allowed=(0.0, 0.5 * np.pi),
        )
    if np.any(variance < 0.0):
        raise DomainError(
            f"slope variance = {float(np.min(variance)):g} is below 0; give variances of at least 0",
            name="mss_along",
            value=float(np.min(variance)),
            allowed="0 or more",
        )
    with np.errstate(divide="ignore"):
        edge = np.cos(theta) / np.sin(theta)
    parts = np.broadcast_arrays(np.asarray(slope_along, dtype=np.float64), edge, np.sqrt(variance))
    slope, edge, deviation = (np.array(part, order="C").ravel() for part in parts)
    out = np.empty(slope.size)
    _map_ratio(slope, edge, deviation, between_bands(ratio_table, bands), out)
    return out.reshape(parts[0].shape)


@lru_cache(maxsize=16)
def _moments(bands: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Contributions of skewness and excess along the view to the visible area of a nested sea, over A+, against the edge in rms slopes."""
    ratio = np.exp(between_bands(ratio_table, bands)) - 1.0
    t: FloatArray = np.asarray(_STEP * (np.arange(_COLUMNS) - 1.0) - REACH, dtype=np.float64)
    edge: FloatArray = np.asarray(_STEP * (np.arange(_ROWS) - 1.0), dtype=np.float64)
    weight = ratio * np.maximum(edge[:, None] - t, 0.0) * _density(t) * _STEP / _area(edge)[:, None]
    # Hermite polynomials of the series: He3/6 for skewness, He4/24 for excess
    return edge, weight @ ((t**3 - 3.0 * t) / 6.0), weight @ ((t**4 - 6.0 * t * t + 3.0) / 24.0)


def nested_area(view_zenith: ArrayLike, view_azimuth: ArrayLike, slopes: SlopeStatistics, bands: float) -> FloatArray:
    r"""Area that normalises the visible density of a nested sea over any slope density, per unit area of sea.

    .. math:: A = \int p(s)\, R(s)\, \max(0, v_z - v_h \cdot s)\, ds

    with the ratio R of Gaussian slopes of the same variances (:func:`nested_ratio`): ``p R max(0, v_z - v_h . s)/A`` adds up to 1. For
    Gaussian slopes A is A+; for a Gram-Charlier density skewness and excess along the view add to it. Its negative part, set to 0
    in the density, counts without the ratio here: 1e-3 of the area at most.

    Parameters
    ----------
    view_zenith, view_azimuth : array_like
        Direction from the sea to the viewer [rad]; broadcast.
    slopes : SlopeStatistics
        Gaussian or not.
    bands : float
        Bands of the nested law; 1 gives :func:`seaglint.sea.shadowing.smith.visible_area`.

    Returns
    -------
    ndarray
        Area [1], broadcast shape.
    """
    area = visible_area(view_zenith, view_azimuth, slopes)
    if slopes.is_gaussian or bands <= 1.0:
        return area
    zenith, azimuth = np.asarray(view_zenith, dtype=np.float64), np.asarray(view_azimuth, dtype=np.float64)
    variance = slopes.mss_along(azimuth)
    turn = azimuth - slopes.wind_to_azimuth
    p, q2 = np.sqrt(slopes.mss_up / variance) * np.cos(turn), slopes.mss_cross / variance * np.sin(turn) ** 2
    c21, c03, c40, c22, c04 = slopes.coefficients
    skewness = p * (p * p * c03 + 3.0 * q2 * c21)
    excess = p**4 * c04 + 6.0 * p * p * q2 * c22 + q2 * q2 * c40
    with np.errstate(divide="ignore"):
        x = np.cos(zenith) / (np.sin(zenith) * np.sqrt(variance))
    edge, third, fourth = _moments(bands)
    correction = skewness * np.interp(x, edge, third, right=0.0) + excess * np.interp(x, edge, fourth, right=0.0)
    return np.asarray(area + projected_area(zenith, variance) * correction)
