r"""Lean of the facets that are seen, across the line of sight, where long waves run in other directions than short ones.

Hiding chooses slopes along the view, and those of long waves more than in proportion: facets that are seen sit on the visible flanks of
long waves. Where these run obliquely to the view their slopes along and across it go together, so that visible facets of a slope along the
view lean to one side. Heights along the line of sight tell of a wave by its wavenumber along that line alone: waves that cross it look
long. With :math:`x` the share of the slope variance along the view in the waves whose wavenumber along it is below a number, and
:math:`y(x)` the covariance of their slopes along and across it over that variance, the mean slope across the view is shifted by

.. math:: \delta = \sigma_1 \int \frac{dy}{dx}\, \frac{dE}{dx}\, dx, \qquad E = E_\frac{1}{2}\, \frac{h(x)}{h_\mathrm{max}},
          \quad h = x^{0.62} (1 - x)

with :math:`\sigma_1` the rms slope along the view, :math:`E(x)` the excess of the mean slope of the longer waves over their share of the
facet's slope, in rms slopes, and :math:`E_{1/2}` the excess at half of the variance by the law of nested bands
(:mod:`seaglint.sea.shadowing.nested`) times :data:`LEAN`. The shape is that of brute force over isotropic seas, the factor fits glint
under oblique wind (``tools/hidden_facets.py``). The lean is 0 in the vertical plane of waves that run along it.

Waves of one length are taken to have the directions :math:`1 + 2 a_2 \cos 2(\varphi - \varphi_0)` of their covariance, Elfouhaily's own.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel
from seaglint.base.kept_tables import kept
from seaglint.sea.shadowing.nested import HIGHEST, REACH, nested_chain
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

LEAN: Final = 0.93
"""Ratio of the excess at half of the variance by brute force to that of the law's bands."""

AZIMUTHS: Final = 36
"""Number of azimuths of a half circle at which gains are tabulated."""

_POWER: Final = 0.62
"""Power of x in the excess of the mean slope of the longer waves."""

_WAVENUMBERS: Final = 96
"""Number of wavenumbers along the view at which the share is taken."""

_STEP: Final = 0.1
_ROWS: Final = round(HIGHEST / _STEP) + 1
_COLUMNS: Final = round(2.0 * REACH / _STEP) + 1
_EDGE: Final = 0.02
"""Least distance, in rms slopes, from the slope that is seen edge on: facets beyond it are not seen."""


def _excess(bands: int, mu: float) -> FloatArray:
    """Excess of the mean slope of half the bands over the slopes of the table, for one view ``mu`` in rms slopes [1, (columns,)]."""
    slope = np.minimum(_STEP * np.arange(_COLUMNS) - REACH, mu - _EDGE)
    means = nested_chain(slope, max(mu, _EDGE), bands)  # of the slopes of the longest bands together
    return np.asarray(0.5 * (means[bands // 2 - 1] + means[(bands + 1) // 2 - 1] - slope))


@lru_cache(maxsize=8)
@kept
def _lean_table(bands: int) -> FloatArray:
    """Table for a whole number of bands [(views, slopes)]."""
    if bands == 1:
        return np.zeros((_ROWS, _COLUMNS))
    return np.stack([_excess(bands, _STEP * row) for row in range(_ROWS)])


@lru_cache(maxsize=16)
def lean_table(bands: float) -> FloatArray:
    """Table of the excess at half of the variance, for :func:`lean_kernel` [(views, slopes)]; of zeros for one band."""
    whole = max(int(bands), 1)
    more = max(bands, 1.0) - whole
    low = _lean_table(whole)
    return low if more == 0.0 else np.asarray((1.0 - more) * low + more * _lean_table(whole + 1))


@kernel
def lean_kernel(slope: float, edge: float, gain: float, table: FloatArray) -> float:
    """Shift of the mean slope across the view in rms slopes along it [1], towards the right of the direction to the viewer.

    ``slope`` along the view and ``edge``, the cotangent of the view zenith, are in rms slopes; ``gain`` is of :func:`lean_gains`.
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
    """Gains at azimuths of the direction to the viewer from the wind's [1, (:data:`AZIMUTHS`,)], over half a circle.

    The integral of the module over the waves of :meth:`~seaglint.sea.slopes.slope_statistics.SlopeStatistics.growth` for
    :math:`E_{1/2} = 1`, but for those that are geometry: the longest, which have the slope variance ``resolved`` [1].
    """
    growth = slopes.growth()
    length = growth[:, 1] + growth[:, 2]
    if resolved > 0.0:
        first = np.array([np.interp(resolved, length, part) for part in growth.T])
        growth = np.concatenate([first[None], growth[length > resolved]])
    up, cross, both = np.diff(growth[:, 1:], axis=0).T
    if not np.any(up + cross > 0.0):
        return np.zeros(AZIMUTHS)
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
    turn = 2.0 * np.pi / AZIMUTHS * np.arange(AZIMUTHS)
    together = np.outer(up - cross, np.cos(turn)) + np.outer(2.0 * both, np.sin(turn))
    apart = np.outer(2.0 * both, np.cos(turn)) - np.outer(up - cross, np.sin(turn))
    along, beside = (even @ (up + cross))[:, None] + 2.0 * second @ together, 2.0 * odd @ apart
    x = np.vstack([np.zeros(AZIMUTHS), np.clip(np.maximum.accumulate(along) / along[-1], 0.0, 1.0)])
    rise = np.diff(x, axis=0)
    steps = np.where(rise > 1e-12, np.diff(beside, axis=0, prepend=0.0) / along[-1] / np.maximum(rise, 1e-12), 0.0)
    highest = (_POWER / (1.0 + _POWER)) ** _POWER / (1.0 + _POWER)
    return np.asarray(np.sum(steps * np.diff(x**_POWER * (1.0 - x), axis=0), axis=0) * LEAN / highest)


@kernel
def gain_at(gains: FloatArray, turn: float) -> float:
    """Gain at an azimuth ``turn`` from the wind's [rad], linear between those of :func:`lean_gains`."""
    x = turn / math.pi * gains.shape[0]
    x -= math.floor(x / gains.shape[0]) * gains.shape[0]
    i = min(int(x), gains.shape[0] - 1)
    j, f = (i + 1) % gains.shape[0], x - i
    return float(gains[i] + f * (gains[j] - gains[i]))
