"""Facets that are both visible and lit, wave band by wave band: ratio tables of the joint law to the two legs taken alone.

The law is derived in :mod:`seaglint.sea.shadowing.nested`.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel, njit
from seaglint.base.table_cache import cached_table
from seaglint.sea.shadowing.nested import HIGHEST, REACH, nested_ratio_kernel, ratio_table

_ONE: Final = np.uint64(1)
_PAIR_NODES: Final = 31
_PAIR_TOP: Final = HIGHEST
#: Sizes of tables of two legs: square roots of the elevations of viewer and Sun in rms slopes, and position of the slope between both.
#:
#: Where both are low the law's logarithm has no bound; over the square root straight lines between nodes follow it within 1 %.
_PAIR_SHARES: Final = 33


@kernel
def _area_kernel(x: float) -> float:
    return float(0.5 * x * math.erfc(-x / math.sqrt(2.0)) + math.exp(-0.5 * x * x) / math.sqrt(2.0 * math.pi))


@kernel
def _onward(view: float, sun: float, width: float) -> float:
    """Visible and lit share of a band's facets per projected area, ``1/[(1 + Lambda_v + Lambda_s) (v_z - v_h . s_0)]``.

    About a tilt relative to which viewer and Sun are ``view`` and ``sun`` above the facet (cotangents of their zenith angles).
    """
    return float(1.0 / (width * _area_kernel(view / width) + view * (width * _area_kernel(sun / width) / sun - 1.0)))


@kernel
def _pair_elevation(node: int) -> float:
    """Elevation at a node in rms slopes, at least 1e-3, as no facet is visible at an elevation of 0."""
    return max(_PAIR_TOP * (node / (_PAIR_NODES - 1)) ** 2, 1e-3)


@njit
def _pair_ratios(view: float, sun: float, bands: int, x: FloatArray, w: FloatArray, slopes: FloatArray, out: FloatArray) -> None:
    """Logarithms of the joint density over Smith's at ``slopes``, for viewer and Sun ``view`` and ``sun`` rms slopes high, oppositely."""
    width = 1.0 / math.sqrt(bands)
    # slopes from the one that hides the Sun to the one that hides the viewer
    low, high = -min(sun, REACH), min(view, REACH)
    half = 0.5 * (high - low)
    n = x.size
    s, onward, seen, other = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    start = _onward(view, sun, width)
    scale = 1.0 / (width * math.sqrt(2.0 * math.pi))
    for i in range(n):
        s[i] = low + half * (1.0 + x[i])
        onward[i] = half * w[i] * (view - s[i]) * _onward(view - s[i], sun + s[i], width)
        seen[i] = start * scale * math.exp(-0.5 * (s[i] / width) ** 2)
    step = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            step[i, j] = scale * math.exp(-0.5 * ((s[i] - s[j]) / width) ** 2) * onward[j]
    for _ in range(bands - 2):
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += step[i, j] * seen[j]
            other[i] = total
        seen, other = other, seen
    # the same for one band is Smith's law for two legs, over which the ratio is taken
    base = math.log(_onward(view, sun, 1.0) / math.sqrt(2.0 * math.pi))
    for k in range(slopes.size):
        total = 0.0
        for j in range(n):
            total += scale * math.exp(-0.5 * ((slopes[k] - s[j]) / width) ** 2) * onward[j] * seen[j]
        out[k] = math.log(max(total, 1e-300)) - base + 0.5 * slopes[k] ** 2


@njit
def _fill_pairs(bands: int, x: FloatArray, w: FloatArray, alone: FloatArray, out: FloatArray) -> None:
    nodes, shares = out.shape[0], out.shape[2]
    slopes = np.empty(shares)
    for i in range(nodes):
        for j in range(nodes):
            view, sun = _pair_elevation(i), _pair_elevation(j)
            for k in range(shares):
                slopes[k] = (view + sun) * k / (shares - 1) - sun
            _pair_ratios(view, sun, bands, x, w, slopes, out[i, j])
            for k in range(shares):
                # the ratios of either leg alone are divided out; the Sun is opposite, so its slope has the other sign
                out[i, j, k] -= math.log(nested_ratio_kernel(slopes[k], view, 1.0, alone))
                out[i, j, k] -= math.log(nested_ratio_kernel(-slopes[k], sun, 1.0, alone))


@lru_cache(maxsize=8)
@cached_table
def _pair_table(bands: int) -> FloatArray:
    """Table of the coupling for a whole number of bands."""
    if bands == 1:
        return np.zeros((0, 0, 0))
    x, w = np.polynomial.legendre.leggauss(48 + 16 * math.isqrt(bands))
    out = np.empty((_PAIR_NODES, _PAIR_NODES, _PAIR_SHARES))
    _fill_pairs(bands, x, w, ratio_table(bands), out)
    return out


def coupled_bands(view: FloatArray, sun: FloatArray, bands: float, deviation: float) -> FloatArray:
    r"""Number of bands of the coupling of both legs: :math:`1 + (N - 1) \min[0.72\, c\, (\mu_v \mu_s)^{0.27}, 0.55]`.

    With :math:`c = \min[(\sigma/0.14)^{1.44}, 1.6]`, N the ``bands`` of each leg, ``view`` and ``sun`` the elevations :math:`\mu` of viewer
    and Sun in rms slopes and ``deviation`` the rms slope :math:`\sigma` of the whole sea along one direction [1].

    The lower both are, the more often shadows of both fall on the same facets, as on a sea of one band. Fitted to
    brute force in the vertical plane of the Sun; see ``coupling_table``.
    """
    steep = min((deviation / 0.14) ** 1.44, 1.6)
    return np.asarray(1.0 + max(bands - 1.0, 0.0) * np.minimum(0.72 * steep * (view * sun) ** 0.27, 0.55))


@lru_cache(maxsize=16)
def coupling_table(bands: float, deviation: float) -> FloatArray:
    r"""Table for ``lit_exponent_kernel`` [(view, Sun, slope)]: visible and lit facets over the product of the two legs alone.

    .. math::

        p_n(s) = \int p_{n-1}(s_0)\, q(s - s_0)\, \frac{\max(0, v_z - v_h \cdot s)}{A_{n+}(s_0)}\,
        \frac{1 + \Lambda_v(s_0)}{1 + \Lambda_v(s_0) + \Lambda_s(s_0)}\, ds_0

    for a Sun opposite to the viewer: every band hides facets from both, by Smith's law for two legs about the tilt of the longer waves.
    The table holds the logarithm of the ratio of :math:`p_N` to Smith's law for two legs, over the product of the ratios of either leg
    alone, N being ``coupled_bands``; 1 band has an empty table. Between whole numbers logarithms are mixed.
    """
    if bands <= 1.0:
        return np.zeros((0, 0, 0))
    elevation = np.array([_pair_elevation(i) for i in range(_PAIR_NODES)])
    coupled = coupled_bands(elevation[:, None], elevation, bands, deviation)[..., None]
    out = np.zeros((_PAIR_NODES, _PAIR_NODES, _PAIR_SHARES))
    for whole in range(2, int(np.ceil(coupled.max())) + 1):
        out += np.maximum(1.0 - np.abs(coupled - whole), 0.0) * _pair_table(whole)
    return out


@kernel
def lit_exponent_kernel(slope: float, view: float, sun: float, table: FloatArray) -> float:
    """Logarithm from ``coupling_table``, interpolated linearly between its nodes.

    ``slope`` along the view, ``view`` and ``sun`` the elevations of viewer and Sun over the facet (cotangents of their zenith angles), all
    in rms slopes; both elevations at least 0, the Sun opposite to the viewer. 0 from the empty table of one band, and from
    the single zero that represents it in a stack.
    """
    if table.shape[0] < _PAIR_NODES:
        return 0.0
    a, b = min(max(view, 0.0), _PAIR_TOP), min(max(sun, 0.0), _PAIR_TOP)
    x, y = (_PAIR_NODES - 1) * math.sqrt(a / _PAIR_TOP), (_PAIR_NODES - 1) * math.sqrt(b / _PAIR_TOP)
    # position of the slope between the Sun's edge (0) and the viewer's (1)
    z = min(max((slope + b) / max(a + b, 2e-3), 0.0), 1.0) * (_PAIR_SHARES - 1)
    i, j = np.uint64(min(int(x), _PAIR_NODES - 2)), np.uint64(min(int(y), _PAIR_NODES - 2))
    k = np.uint64(min(int(z), _PAIR_SHARES - 2))
    i1, j1, k1 = np.uint64(i + _ONE), np.uint64(j + _ONE), np.uint64(k + _ONE)
    f, g, h = x - float(i), y - float(j), z - float(k)
    p = table[i, j, k] + h * (table[i, j, k1] - table[i, j, k])
    q = table[i, j1, k] + h * (table[i, j1, k1] - table[i, j1, k])
    r = table[i1, j, k] + h * (table[i1, j, k1] - table[i1, j, k])
    t = table[i1, j1, k] + h * (table[i1, j1, k1] - table[i1, j1, k])
    low, high = p + g * (q - p), r + g * (t - r)
    return float(low + f * (high - low))
