r"""Lean of the facets that are seen, across the line of sight, where long waves run in other directions than short ones.

Hiding chooses slopes along the view, and those of long waves more than in proportion: facets that are seen sit on the visible flanks of
long waves. Where these run obliquely to the view their slopes along and across it go together, more closely than those of ripples do, so
that visible facets of a slope along the view lean to one side. With :math:`x` the share of the slope variance along the view in the waves
longer than a length, :math:`y(x)` the covariance of their slopes along and across it over that variance, and
:math:`g(x) = y(x) - x\,y(1)`,

.. math:: \delta = \sigma_1 \int \frac{dg}{dx}\, e(x)\, dx

is the shift of the mean slope across the view, ``e`` the excess of the mean slope of the waves at ``x`` over their share of the facet's
slope, in rms slopes :math:`\sigma_1`, by the law of nested bands (:mod:`seaglint.sea.shadowing.nested`). It is 0 in the vertical plane of
waves that run along it. ``g`` is taken as :math:`x(1 - x)[g_1 + g_2 (1 - 2x)]`.

The few bands of the law move the longest waves too little. :data:`LEAN` makes up for it: with it the glint beside the Sun's azimuth is
that of brute force (``tools/hidden_facets.py``).
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

LEAN: Final = 1.5
"""Ratio of the lean of facets by brute force to that of the law's bands."""

AZIMUTHS: Final = 36
"""Number of azimuths of a half circle at which gains are tabulated."""

_STEP: Final = 0.1
_ROWS: Final = round(HIGHEST / _STEP) + 1
_COLUMNS: Final = round(2.0 * REACH / _STEP) + 1
_EDGE: Final = 0.02
"""Least distance, in rms slopes, from the slope that is seen edge on: facets beyond it are not seen."""


def _shifts(bands: int, mu: float) -> FloatArray:
    """Shifts of both modes of ``g`` over the slopes of the table, for one view ``mu`` in rms slopes [1, (2, columns)]."""
    slope = np.minimum(_STEP * np.arange(_COLUMNS) - REACH, mu - _EDGE)
    means = np.stack(nested_chain(slope, max(mu, _EDGE), bands))  # of the slopes of the longest bands together
    excess = np.zeros((bands + 1, _COLUMNS))
    excess[1:-1] = means - np.arange(1, bands)[:, None] / bands * slope
    x = np.arange(bands + 1) / bands
    modes = np.stack([x * (1.0 - x), x * (1.0 - x) * (1.0 - 2.0 * x)])
    return np.asarray(LEAN * bands * np.diff(modes, axis=1) @ np.diff(excess, axis=0))


@lru_cache(maxsize=8)
@kept
def _lean_table(bands: int) -> FloatArray:
    """Table for a whole number of bands [(2, views, slopes)]."""
    if bands == 1:
        return np.zeros((2, _ROWS, _COLUMNS))
    return np.stack([_shifts(bands, _STEP * row) for row in range(_ROWS)], axis=1)


@lru_cache(maxsize=16)
def lean_table(bands: float) -> FloatArray:
    """Table for :func:`lean_kernel` [(2, views, slopes)]; of zeros for one band."""
    whole = max(int(bands), 1)
    more = max(bands, 1.0) - whole
    low = _lean_table(whole)
    return low if more == 0.0 else np.asarray((1.0 - more) * low + more * _lean_table(whole + 1))


@kernel
def lean_kernel(slope: float, edge: float, gains: tuple[float, float], table: FloatArray) -> float:
    """Shift of the mean slope across the view in rms slopes along it [1], towards the right of the direction to the viewer.

    ``slope`` along the view and ``edge``, the cotangent of the view zenith, are in rms slopes; ``gains`` are ``(g_1, g_2)``.
    """
    if table.shape[1] < 2 or edge >= HIGHEST:
        return 0.0
    x = (min(max(slope, -REACH), REACH) + REACH) / _STEP
    y = max(edge, 0.0) / _STEP
    i, j = min(int(y), table.shape[1] - 2), min(int(x), table.shape[2] - 2)
    f, g = y - i, x - j
    total = 0.0
    for k in range(2):
        low = table[k, i, j] + g * (table[k, i, j + 1] - table[k, i, j])
        high = table[k, i + 1, j] + g * (table[k, i + 1, j + 1] - table[k, i + 1, j])
        total += gains[k] * (low + f * (high - low))
    return total


def lean_gains(slopes: SlopeStatistics, resolved: float = 0.0) -> FloatArray:
    """Gains ``(g_1, g_2)`` at azimuths of the direction to the viewer from the wind's [1, (:data:`AZIMUTHS`, 2)], over half a circle.

    Projection of ``g`` on its two modes over the waves of :meth:`~seaglint.sea.slopes.slope_statistics.SlopeStatistics.growth`, but for
    those that are geometry: the longest, which have the slope variance ``resolved`` [1].
    """
    azimuth = np.pi / AZIMUTHS * np.arange(AZIMUTHS)
    c, s = np.cos(azimuth)[:, None], np.sin(azimuth)[:, None]
    growth = slopes.growth()
    if resolved > 0.0:
        length = growth[:, 0] + growth[:, 1]
        first = np.array([np.interp(resolved, length, part) for part in growth.T])
        growth = np.concatenate([first[None], growth[length > resolved]]) - first
    up, cross, both = growth.T
    along = np.maximum(up * c * c + 2.0 * both * c * s + cross * s * s, 0.0)
    beside = (cross - up) * c * s + both * (c * c - s * s)
    total = np.where(along[:, -1:] > 0.0, along[:, -1:], 1.0)
    x = along / total
    g = beside / total - x * beside[:, -1:] / total
    out = np.empty((AZIMUTHS, 2))
    for k, mode in enumerate((x * (1.0 - x), x * (1.0 - x) * (1.0 - 2.0 * x))):
        out[:, k] = np.trapezoid(g * mode, x, axis=1) / np.maximum(np.trapezoid(mode * mode, x, axis=1), 1e-12)
    return out


@kernel
def gains_at(gains: FloatArray, turn: float) -> tuple[float, float]:
    """Gains at an azimuth ``turn`` from the wind's [rad], linear between those of :func:`lean_gains`."""
    x = turn / math.pi * gains.shape[0]
    x -= math.floor(x / gains.shape[0]) * gains.shape[0]
    i = min(int(x), gains.shape[0] - 1)
    j, f = (i + 1) % gains.shape[0], x - i
    return gains[i, 0] + f * (gains[j, 0] - gains[i, 0]), gains[i, 1] + f * (gains[j, 1] - gains[i, 1])
