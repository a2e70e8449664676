r"""Lean of visible facets across the line of sight, where long waves run in other directions than short ones.

**Waves along a direction.** Heights along a line of sight depend on a wave through its wavenumber along that line alone,
:math:`k |\cos(\varphi - \varphi_v)|`: waves that cross the line look long. Waves of one length are assumed to have the directional
distribution :math:`1 + 2 a_2 \cos 2(\varphi - \varphi_0)` of the covariance of their slopes, as in Elfouhaily's spectrum. Where they are
narrower than this form allows, :math:`a_2 > 1/2`, :math:`2 a_2 - 1` of them run in the one direction :math:`\varphi_0`, the rest as for
:math:`a_2 = 1/2`.

**Lean.** Hiding selects slopes along the view, and the slopes of long waves more than in proportion: visible facets lie on the visible
flanks of long waves. Where these run obliquely to the view, their slopes along and across it are correlated, so that visible facets of a
slope along the view lean to one side. With :math:`x` the share of the slope variance along the view in the waves whose wavenumber along it
is below a number (``waves_along``), and :math:`y(x)` the covariance of their slopes along and across it over that variance, the mean
slope across the view is shifted by

.. math:: \delta = \sigma_1 \int \frac{dy}{dx}\, \frac{dE}{dx}\, dx, \qquad E = E_\frac{1}{2}\, \frac{h(x)}{h_\mathrm{max}}

with :math:`h(x) = x^{0.62} (1 - x)`, :math:`\sigma_1` the rms slope along the view, :math:`E(x)` the excess of the mean slope of the
longer waves over their share of the facet's slope, in rms slopes, and :math:`E_{1/2}` the excess at half of the variance by the law of
nested bands (:mod:`seaglint.sea.shadowing.nested`) times ``LEAN``. The shape is fitted to brute force over isotropic seas, the factor
to glint under oblique wind (``docs/figures/hidden_facets.py``). The lean is 0 in the vertical plane of waves that run along it.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel
from seaglint.base.table_cache import cached_table
from seaglint.sea.shadowing.nested import HIGHEST, REACH, bands_of, bands_of_breadth, nested_chain
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

_WAVENUMBERS: Final = 96  #: Number of wavenumbers along a direction at which sums are taken.

LEAN: Final = 0.93  #: Ratio of the excess at half of the variance by brute force to the excess by the law's bands.

AZIMUTHS: Final = 36  #: Number of azimuths of a half circle at which gains are tabulated.

_POWER: Final = 0.62  #: Power of x in the excess of the mean slope of the longer waves.

_STEP: Final = 0.1
_ROWS: Final = round(HIGHEST / _STEP) + 1
_COLUMNS: Final = round(2.0 * REACH / _STEP) + 1
_EDGE: Final = 0.02  #: Least distance, in rms slopes, from the slope that is viewed edge on: facets beyond it are not visible.


class WavesAlong(NamedTuple):
    """Sums over the waves whose wavenumber along a direction is below a number, from none to all.

    The fields are these wavenumbers [rad/m, (n,)], and the variance of the slopes along the direction and their covariance with the slopes
    to the right of it [1, (n, directions)].
    """

    wavenumber: FloatArray
    along: FloatArray
    covariance: FloatArray


def waves_along(slopes: SlopeStatistics, turn: FloatArray, resolved: float = 0.0) -> WavesAlong:
    """Return the sums at azimuths counted from the wind's [rad].

    They include the waves of :meth:`~seaglint.sea.slopes.slope_statistics.SlopeStatistics.growth` except the longest ones, which have the
    slope variance ``resolved`` [1]. All are 0 if no waves are left.
    """
    growth = slopes.growth()
    length = growth[:, 1] + growth[:, 2]
    if resolved > 0.0:
        first = np.array([np.interp(resolved, length, column) for column in growth.T])
        growth = np.concatenate([first[None], growth[length > resolved]])
    if growth.shape[0] < 2:
        return WavesAlong(np.ones(1), np.zeros((1, turn.size)), np.zeros((1, turn.size)))
    up, cross, mixed = np.diff(growth[:, 1:], axis=0).T
    k = np.sqrt(growth[1:, 0] * growth[:-1, 0])
    # integrals over the directions of waves whose wavenumber along the view is below a number, of 1 and of both harmonics
    below = np.geomspace(1e-2 * k[0], k[-1], _WAVENUMBERS)
    least = np.arccos(np.minimum(below[:, None] / k, 1.0))
    span, twice, four = np.pi - 2.0 * least, np.sin(2.0 * least), np.sin(4.0 * least)
    even, second, odd = (
        (span - twice) / (2.0 * np.pi),
        (span - 2.0 * twice - 0.5 * four) / (4.0 * np.pi),
        (span + 0.5 * four) / (4.0 * np.pi),
    )
    whole, angle = up + cross, 0.5 * np.arctan2(2.0 * mixed, up - cross)
    narrow = np.minimum(np.hypot(up - cross, 2.0 * mixed), whole)  # a2 times the variance
    straight = np.maximum(2.0 * narrow - whole, 0.0)
    round_, narrow = whole - straight, narrow - straight
    off = angle[:, None] - turn
    along = (even @ round_)[:, None] + 2.0 * second @ (narrow[:, None] * np.cos(2.0 * off))
    covariance = 2.0 * odd @ (narrow[:, None] * np.sin(2.0 * off))
    if straight.any():
        # waves in one direction have one wavenumber along the view: they enter the sums as a step
        reached = below[:, None, None] >= k[:, None] * np.abs(np.cos(off))
        along += np.einsum("nka,ka->na", reached, straight[:, None] * np.cos(off) ** 2)
        covariance += np.einsum("nka,ka->na", reached, straight[:, None] * np.cos(off) * np.sin(off))
    return WavesAlong(below, np.maximum.accumulate(along), covariance)


@lru_cache(maxsize=1024)
def breadth(slopes: SlopeStatistics, azimuth: float) -> float:
    """Standard deviation of the logarithm of the wavenumber along an azimuth [rad], weighted with the variance of slopes along it [1].

    0 for flat slopes.
    """
    waves = waves_along(slopes, np.array([azimuth - slopes.wind_to_azimuth]))
    weight = np.diff(waves.along[:, 0], prepend=0.0)
    if weight.sum() <= 0.0:
        return 0.0
    log = np.log(waves.wavenumber)
    mean = np.average(log, weights=weight)
    return float(np.sqrt(np.average((log - mean) ** 2, weights=weight)))


def bands_along(slopes: SlopeStatistics, azimuth: float) -> float:
    """Number of bands of the nested law for views along an azimuth [rad], or against it [1].

    By the ``breadth`` of the waves if a spectrum is known; else by the slope variance alone. Both agree within 0.25
    for isotropic seas of Elfouhaily's shape and Cox and Munk's slope variance from 2 to 7 m/s.
    """
    return bands_of_breadth(breadth(slopes, azimuth)) if slopes.nesting else bands_of(slopes.mss)


def _excess(bands: int, mu: float) -> FloatArray:
    """Excess of the mean slope of half the bands over the slopes of the table, for one view ``mu`` in rms slopes [1, (columns,)]."""
    slope = np.minimum(_STEP * np.arange(_COLUMNS) - REACH, mu - _EDGE)
    means = nested_chain(slope, max(mu, _EDGE), bands)  # of the slopes of the longest bands together
    # for an odd number of bands the mean of the two numbers around half
    return np.asarray(0.5 * (means[bands // 2 - 1] + means[(bands + 1) // 2 - 1] - slope))


@lru_cache(maxsize=8)
@cached_table
def _lean_table(bands: int) -> FloatArray:
    """Table for a whole number of bands [(views, slopes)]."""
    if bands == 1:
        return np.zeros((_ROWS, _COLUMNS))
    return np.stack([_excess(bands, _STEP * row) for row in range(_ROWS)])


@lru_cache(maxsize=16)
def lean_table(bands: float) -> FloatArray:
    """Table of the excess at half of the variance, for ``lean_kernel`` [(views, slopes)]; of zeros for one band."""
    whole = max(int(bands), 1)
    remainder = max(bands, 1.0) - whole
    low = _lean_table(whole)
    return low if remainder == 0.0 else np.asarray((1.0 - remainder) * low + remainder * _lean_table(whole + 1))


@kernel
def lean_kernel(slope: float, edge: float, gain: float, table: FloatArray) -> float:
    """Shift of the mean slope across the view in rms slopes along it [1], towards the right of the direction to the viewer.

    ``slope`` along the view and ``edge``, the cotangent of the view zenith, are in rms slopes; ``gain`` is of ``lean_gains``.
    """
    if table.shape[0] < 2 or edge >= HIGHEST or gain == 0.0:
        return 0.0
    x = (min(max(slope, -REACH), REACH) + REACH) / _STEP
    y = max(edge, 0.0) / _STEP
    i, j = min(int(y), table.shape[0] - 2), min(int(x), table.shape[1] - 2)
    f, g = y - i, x - j
    low = table[i, j] + g * (table[i, j + 1] - table[i, j])
    high = table[i + 1, j] + g * (table[i + 1, j + 1] - table[i + 1, j])
    return gain * float(low + f * (high - low))


@lru_cache(maxsize=256)
def lean_gains(slopes: SlopeStatistics, resolved: float = 0.0) -> FloatArray:
    """Gains at azimuths of the direction to the viewer from the wind's [1, (``AZIMUTHS``,)], over half a circle.

    The integral of the module for :math:`E_{1/2} = 1`, over all waves except those that are geometry: the longest, which have the
    slope variance ``resolved`` [1].
    """
    waves = waves_along(slopes, np.linspace(0.0, np.pi, AZIMUTHS, endpoint=False), resolved)
    total = waves.along[-1]
    if not np.any(total > 0.0):
        return np.zeros(AZIMUTHS)
    x = np.vstack([np.zeros(AZIMUTHS), np.minimum(waves.along / total, 1.0)])
    rise = np.diff(x, axis=0)
    steps = np.where(rise > 1e-12, np.diff(waves.covariance, axis=0, prepend=0.0) / total / np.maximum(rise, 1e-12), 0.0)
    # maximum of h(x) = x^p (1 - x), at x = p/(1 + p)
    highest = (_POWER / (1.0 + _POWER)) ** _POWER / (1.0 + _POWER)
    return np.asarray(np.sum(steps * np.diff(x**_POWER * (1.0 - x), axis=0), axis=0) * LEAN / highest)


@kernel
def gain_at(gains: FloatArray, turn: float) -> float:
    """Gain at an azimuth ``turn`` from the wind's [rad], linear between the azimuths of ``lean_gains``."""
    x = turn / math.pi * gains.shape[0]
    # a direction and its opposite have one gain
    x -= math.floor(x / gains.shape[0]) * gains.shape[0]
    i = min(int(x), gains.shape[0] - 1)
    j, f = (i + 1) % gains.shape[0], x - i
    return float(gains[i] + f * (gains[j] - gains[i]))
