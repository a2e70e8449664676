r"""Share of the sea that mirrors a disc, and how it fluctuates in a box: pairs of points of Gaussian slopes.

A point mirrors the Sun where its slope lies in a small window about the mirroring slope ``s*``: the disc mapped to slopes, of the area
``pi w^2``, with ``w = eps/2`` near the nadir. Slopes of short waves differ from place to place, with the covariance ``R`` at a lag
(``seaglint.sea.glitter.short_waves``) and ``F`` at none; slopes of longer waves, of the covariance ``G``, are the same at both places.
Half the sum and the difference of the slopes at two places are independent, with the covariances ``(F + R)/2 + G`` and ``2 (F - R)``. With
the window's second moments added to both,

.. math:: P = \pi w^2 N(s^*; F + G + w^2/4), \qquad
    P_2 = (\pi w^2)^2 N(0; 2 (F - R) + w^2/2)\, N(s^*; (F + R)/2 + G + w^2/8)

N the density of a Gaussian of a covariance. ``P_2`` is P times the share of a narrow window that overlaps itself at a small lag, and P
squared at a large one. Without the disc it would grow as one over the lag squared, and its integral would have no end: the disc ends it
where slopes differ by w, over a tenth of a millimetre. The variance of the lit share of a box of sides a, b over its mean squared is

.. math:: v = \frac{1}{a b} \int \left(1 - \frac{|x|}{a}\right)\left(1 - \frac{|y|}{b}\right) \frac{P_2 - P_{2,\infty}}{P^2}\, dx\, dy

where the part linear in R, which alone is not small far away, is the variance of the mean slope of the box and is taken in the spectrum.

References
----------
Longuet-Higgins 1960, J. Opt. Soc. Am. 50, 838 (specular points); Cox and Munk 1954, J. Opt. Soc. Am. 44, 838 (the disc in slopes). The
variance of a share of pairs is the usual one of a stationary field (Papoulis 1965, Sec. 9-4).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.sea.glitter.short_waves import ShortWaves

SHORTEST_LAG: Final = 2e-6  #: Shortest lag of the integral [m]: glints are some 50 times as long.

FARTHEST: Final = 25.0  #: Longest lag times the least wavenumber of the short waves [1]; the rest beyond is below a per cent.

LAGS: Final = 110  #: Number of lags of the integral.

SECTORS: Final = 60  #: Number of directions over which the weight of a lag is averaged, for each of them.

TURNS: Final = 12  #: Number of their directions over half a circle.

SLOPE_TURNS: Final = 4  #: Number of directions of the mirroring slope over which variances of a stated steepness are averaged.

#: Times at which the correlation of a box is taken, in ``1/sqrt(g k)`` of the longest short waves [1].
_TIMES: Final = np.concatenate([[0.0], np.geomspace(0.005, 12.0, 18)])

_SMALL: Final = 1e-4  #: Share of the covariance with which the linear part is taken.

Covariance = tuple[float, float, float]  #: Along, mixed and across [1].

RIGID: Final = (0.0, 0.0, 0.0)  #: No longer waves.


def disc_in_slopes(radius: ArrayLike, tilt: ArrayLike, cos_incidence: ArrayLike) -> FloatArray:
    """Radius of the disc of equal area to which a disc in the sky is mapped in slopes, ``eps/(2 sqrt(cos^3(beta) cos(omega)))`` [1].

    Parameters
    ----------
    radius : array_like
        Angular radius in the sky, eps [rad].
    tilt : array_like
        Cosine of the tilt of the mirroring facet, cos(beta) [1].
    cos_incidence : array_like
        Cosine of the angle of incidence, cos(omega) [1]: the disc is larger where it is met at a grazing angle.
    """
    cosine = np.asarray(tilt, np.float64)
    return np.asarray(np.asarray(radius, np.float64) / (2.0 * np.sqrt(cosine**3 * np.asarray(cos_incidence, np.float64))))


def _half_circle(count: int) -> FloatArray:
    """Middles of equal sectors of half a circle [rad]."""
    return np.pi * (np.arange(count) + 0.5) / count


def _normal(slope: tuple[float, float], along: FloatArray, mixed: FloatArray, across: FloatArray) -> FloatArray:
    """Density of a Gaussian of a covariance at a slope [1]."""
    area = along * across - mixed * mixed
    exponent = (across * slope[0] ** 2 - 2.0 * mixed * slope[0] * slope[1] + along * slope[1] ** 2) / area
    return np.asarray(np.exp(-0.5 * exponent) / (2.0 * np.pi * np.sqrt(area)))


@dataclass(frozen=True)
class LitShare:
    """Share of the sea that mirrors a disc, by the covariances of its slopes along and across the wind."""

    short: Covariance  #: Slopes of short waves, which differ from place to place [1].
    longer: Covariance  #: Slopes of longer waves, the same at all places considered [1].
    slope: tuple[float, float]  #: Mirroring slope along and across the axis [1].
    radius: float  #: Radius of the disc in slopes, w [1].

    @property
    def density(self) -> float:
        """Density of slopes at the mirroring slope, averaged over the disc [1]."""
        w2 = self.radius**2
        total = [np.asarray(f + g) for f, g in zip(self.short, self.longer, strict=True)]
        return float(_normal(self.slope, total[0] + w2 / 4.0, total[1], total[2] + w2 / 4.0))

    @property
    def chance(self) -> float:
        """Share of the sea that mirrors the disc, P [1]."""
        return math.pi * self.radius**2 * self.density

    def pairs(self, covariance: FloatArray) -> FloatArray:
        """Chance that two places mirror the disc, over that of one squared, ``P_2/P^2`` [1]; ``covariance`` of ``short`` (..., 3)."""
        w2, (f, m, g), longer = self.radius**2, self.short, self.longer
        along, mixed, across = covariance[..., 0], covariance[..., 1], covariance[..., 2]
        apart = _normal((0.0, 0.0), 2.0 * (f - along) + w2 / 2.0, 2.0 * (m - mixed), 2.0 * (g - across) + w2 / 2.0)
        both = _normal(
            self.slope, 0.5 * (f + along) + longer[0] + w2 / 8.0, 0.5 * (m + mixed) + longer[1], 0.5 * (g + across) + longer[2] + w2 / 8.0
        )
        return np.asarray(apart * both / self.density**2)

    @cached_property
    def unrelated(self) -> float:
        """Value of ``pairs`` of places whose short waves are independent [1]: above 1 by the longer waves that they share."""
        return float(self.pairs(np.zeros(3)))

    @cached_property
    def linear(self) -> FloatArray:
        """Derivatives of ``pairs`` by the covariances along, mixed and across, at none [1, (3,)]."""
        scale = _SMALL * 0.5 * (self.short[0] + self.short[2])
        steps = scale * np.eye(3)
        return np.asarray((self.pairs(steps) - self.pairs(-steps)) / (2.0 * scale))


@dataclass(frozen=True, eq=False)
class Clusters:
    """Fluctuation of the share of the sea that mirrors a disc in boxes of the sea, from its short waves.

    Parameters
    ----------
    waves : ShortWaves
        Waves that are no geometry.
    longer : tuple of float
        Covariance of the slopes of longer waves, about the axis of ``waves`` [1].
    """

    waves: ShortWaves
    longer: Covariance = RIGID

    @cached_property
    def short(self) -> Covariance:
        """Covariance of the slopes of the short waves [1]."""
        up, cross = self.waves.variances
        return up, 0.0, cross

    @cached_property
    def lags(self) -> FloatArray:
        """Lags of the integral [m], even over their logarithm."""
        return np.geomspace(SHORTEST_LAG, FARTHEST / float(self.waves.wavenumber[0]), LAGS)

    @cached_property
    def turns(self) -> FloatArray:
        """Directions of the lags from the axis of the waves, over half a circle [rad]."""
        return _half_circle(TURNS)

    @cached_property
    def _still(self) -> FloatArray:
        return self.waves.covariance(self.lags, self.turns[:, None])

    @cached_property
    def _moving_lags(self) -> FloatArray:
        # a glint's own size moves away at once: longer lags decide the time
        return np.geomspace(1e-4, FARTHEST / float(self.waves.wavenumber[0]), LAGS // 3)

    @cached_property
    def times(self) -> FloatArray:
        """Times at which the correlation of boxes is taken [s]."""
        return _TIMES / float(np.sqrt(GRAVITY * self.waves.wavenumber[0]))

    @cached_property
    def _moving(self) -> FloatArray:
        return self.waves.moving_covariance(self._moving_lags, self._moving_turns, self.times)

    @cached_property
    def _moving_turns(self) -> FloatArray:
        return _half_circle(TURNS // 2)

    def lit(self, steepness: float, turn: float, radius: float) -> LitShare:
        """Return the lit share at a mirroring slope of a steepness, in deviations of all slopes, in a direction from the axis [rad]."""
        up, _, cross = (f + g for f, g in zip(self.short, self.longer, strict=True))
        slope = (steepness * math.sqrt(up) * math.cos(turn), steepness * math.sqrt(cross) * math.sin(turn))
        return LitShare(self.short, self.longer, slope, radius)

    def variance(self, steepness: float, radius: float, box: tuple[float, float], turn: float = 0.0) -> float:
        """Relative variance of the lit share of a box, averaged over the directions of the mirroring slope [1].

        Parameters
        ----------
        steepness : float
            Mirroring slope, in standard deviations of the slopes of all waves [1].
        radius : float
            Radius of the disc in slopes [1].
        box : tuple of float
            Length and width of the box on the sea [m].
        turn : float
            Direction of its length from the axis of the waves [rad].
        """
        return float(_box(_still_pairs(self, steepness, radius), box, turn, _still_means(self, box, turn))[0])

    def correlation(self, steepness: float, radius: float, box: tuple[float, float], turn: float = 0.0) -> FloatArray:
        """Correlation of the lit share of a box at ``times`` after the first [1]; arguments as of ``variance``."""
        total = _box(_moving_pairs(self, steepness, radius), box, turn, self.waves.mean_covariance(box, turn, self.times))
        return np.asarray(total / total[0])

    def correlation_time(self, steepness: float, radius: float, box: tuple[float, float], turn: float = 0.0) -> float:
        """Time after which the correlation of the lit share of a box is 1/e for the first time [s]; the last of ``times`` at most."""
        correlation, times = self.correlation(steepness, radius, box, turn), self.times
        below = np.flatnonzero(correlation < math.exp(-1.0))
        if below.size == 0:
            return float(times[-1])
        i = int(below[0])
        share = (correlation[i - 1] - math.exp(-1.0)) / (correlation[i - 1] - correlation[i])
        return float(times[i - 1] + share * (times[i] - times[i - 1]))

    def pairs(self, steepness: float, radius: float, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Excess of pairs at lags over independent ones and their linear part [1], and the factors of that part, means over slopes."""
        lit = [self.lit(steepness, math.pi * i / SLOPE_TURNS, radius) for i in range(SLOPE_TURNS)]
        excess = np.mean([one.pairs(covariance) - one.unrelated - covariance @ one.linear for one in lit], axis=0)
        return np.asarray(excess), np.asarray(np.mean([one.linear for one in lit], axis=0))


class _Pairs(NamedTuple):
    """Lags [m, (n,)], their directions [rad, (m,)], excess (m, n, times) and factors of the linear part (3,) of ``Clusters.pairs``."""

    lags: FloatArray
    turns: FloatArray
    excess: FloatArray
    linear: FloatArray


@lru_cache(maxsize=256)
def _still_pairs(clusters: Clusters, steepness: float, radius: float) -> _Pairs:
    return _Pairs(clusters.lags, clusters.turns, *clusters.pairs(steepness, radius, clusters._still[:, :, None]))


@lru_cache(maxsize=64)
def _still_means(clusters: Clusters, box: tuple[float, float], turn: float) -> FloatArray:
    return clusters.waves.mean_covariance(box, turn, np.zeros(1))


@lru_cache(maxsize=16)
def _moving_pairs(clusters: Clusters, steepness: float, radius: float) -> _Pairs:
    return _Pairs(clusters._moving_lags, clusters._moving_turns, *clusters.pairs(steepness, radius, clusters._moving))


@lru_cache(maxsize=256)
def _weights(lags: tuple[float, float, int], turns: int, box: tuple[float, float], turn: float) -> FloatArray:
    """Weights of lags in a box, times the lag squared, means over the sector of each direction [m2, (turns, lags)]."""
    # a long pixel is a thin sector of its lags: the weight is averaged finely, pairs change slowly with direction
    angle = _half_circle(turns * SECTORS) - turn
    lag = np.geomspace(*lags)
    weight = np.clip(1.0 - np.abs(np.cos(angle))[:, None] * lag / box[0], 0.0, None)
    weight *= np.clip(1.0 - np.abs(np.sin(angle))[:, None] * lag / box[1], 0.0, None)
    return np.asarray(weight.reshape(turns, SECTORS, -1).mean(axis=1) * lag**2)


def _box(pairs: _Pairs, box: tuple[float, float], turn: float, means: FloatArray) -> FloatArray:
    """Relative variance of a box at times, from pairs and the covariances of its mean slopes (times, 3)."""
    weight = _weights((float(pairs.lags[0]), float(pairs.lags[-1]), pairs.lags.size), pairs.turns.size, box, turn)
    step = math.log(pairs.lags[1] / pairs.lags[0])
    inner = 2.0 * math.pi * step * np.sum(weight[:, :, None] * pairs.excess, axis=(0, 1)) / (pairs.turns.size * box[0] * box[1])
    return np.asarray(inner + means @ pairs.linear)
