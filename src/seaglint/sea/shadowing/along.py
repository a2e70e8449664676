r"""Waves as they show along a direction: by their wavenumber along it, whatever their own.

Heights along a line of sight tell of a wave by its wavenumber along that line alone, :math:`k |\cos(\varphi - \varphi_v)|`: waves that
cross it look long. Waves of one length are taken to have the directions :math:`1 + 2 a_2 \cos 2(\varphi - \varphi_0)` of the covariance
of their slopes, Elfouhaily's own; where they are narrower than these can be, :math:`a_2 > 1/2`, :math:`2 a_2 - 1` of them run in the one
direction :math:`\varphi_0`, the rest as for :math:`a_2 = 1/2`.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.sea.shadowing.nested import bands_of, bands_of_breadth
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

_WAVENUMBERS: Final = 96  #: Number of wavenumbers along a direction at which sums are taken.


class WavesAlong(NamedTuple):
    """Sums over the waves whose wavenumber along a direction is below a number, from none to all.

    The fields are these wavenumbers [rad/m, (n,)], and the variance of the slopes along the direction and their covariance with those to
    the right of it [1, (n, directions)].
    """

    wavenumber: FloatArray
    along: FloatArray
    beside: FloatArray


def waves_along(slopes: SlopeStatistics, turn: FloatArray, resolved: float = 0.0) -> WavesAlong:
    """Return the sums at azimuths counted from the wind's [rad].

    They are of the waves of :meth:`~seaglint.sea.slopes.slope_statistics.SlopeStatistics.growth`, but for the longest ones that have the
    slope variance ``resolved`` [1]. All are 0 where no waves are left.
    """
    growth = slopes.growth()
    length = growth[:, 1] + growth[:, 2]
    if resolved > 0.0:
        first = np.array([np.interp(resolved, length, part) for part in growth.T])
        growth = np.concatenate([first[None], growth[length > resolved]])
    if growth.shape[0] < 2:
        return WavesAlong(np.ones(1), np.zeros((1, turn.size)), np.zeros((1, turn.size)))
    up, cross, both = np.diff(growth[:, 1:], axis=0).T
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
    whole, angle = up + cross, 0.5 * np.arctan2(2.0 * both, up - cross)
    narrow = np.minimum(np.hypot(up - cross, 2.0 * both), whole)  # a2 times the variance
    straight = np.maximum(2.0 * narrow - whole, 0.0)
    round_, narrow = whole - straight, narrow - straight
    off = angle[:, None] - turn
    along = (even @ round_)[:, None] + 2.0 * second @ (narrow[:, None] * np.cos(2.0 * off))
    beside = 2.0 * odd @ (narrow[:, None] * np.sin(2.0 * off))
    if straight.any():
        reached = below[:, None, None] >= k[:, None] * np.abs(np.cos(off))
        along += np.einsum("nka,ka->na", reached, straight[:, None] * np.cos(off) ** 2)
        beside += np.einsum("nka,ka->na", reached, straight[:, None] * np.cos(off) * np.sin(off))
    return WavesAlong(below, np.maximum.accumulate(along), beside)


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

    By the :func:`breadth` of the waves where a spectrum is known; by the slope variance alone elsewhere. Both are the same, within 0.25,
    for isotropic seas of Elfouhaily's shape and Cox and Munk's slope variance from 2 to 7 m/s.
    """
    return bands_of_breadth(breadth(slopes, azimuth)) if slopes.nesting else bands_of(slopes.mss)
