"""Uncertainty of a rate whose occurrences come in clusters.

Occurrences are counted in cells (time segment x tile of the image). With residuals e = count - rate x pixels, the variance of the total is

    V = sum over lags l of w(l) sum over cells i of e_i e_(i+l),

an estimate of the spectral density of the residuals at frequency 0 with a flat-top lag window w = w_t w_y w_x: 1 up to a lag m, falling to
0 at 2 m, where m is, for each axis separately, the first lag from which on the residuals are uncorrelated. No shape of the correlation is
assumed. The expected rate of a cell is one of three:

- With many decorrelated times it is the tile's rate, so that a rate that varies over the image (a corridor) is no uncertainty.
- With few decorrelated times it is the region's rate: the variation over the tiles is part of the uncertainty.
- If the residuals of both stay correlated over the whole image, the rates of rows and columns (depression, distance from the corridor) are
  taken as given, expected = row rate x column rate / rate, and the note reports it.

Exceedances are few, and the lags at which they are correlated are not recognised along the axes: a pattern that drifts is uncorrelated with
itself at one place after a few frames, but not with the place to which it has moved. Where the sums of z and of z² - 1 of each cell are
known, w is therefore 1 at all lags at which one of them is correlated, and 0 elsewhere: their correlations are known from all pixels.

References
----------
Politis and Romano 1995, J. Time Ser. Anal. 16, 67 (flat-top windows); Politis and White 2004, Econometric Reviews 23, 53, with their
rule for m; Bartlett 1946, Suppl. J. R. Stat. Soc. 8, 27 (noise of correlations); Dean and Pagano 2015, Surv. Stat. Methodol. 3, 484 (the
score interval with an effective number); Korn and Graubard 1998, Surv. Methodol. 24, 193 (the exact interval with an effective number).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray

Reference = Literal["tiles", "region", "margins"]

#: Least number of independent times for comparing tiles with themselves.
#:
#: With fewer, subtracting the mean removes too much of the variance.
FEWEST_TIMES: Final = 12.0

FEWEST_DEGREES: Final = 4.0  #: Least number of degrees of freedom for stating a variance (a factor of two either way).

FEWEST_COUNTS: Final = 10  #: Least number of occurrences for estimating their clustering [1].

LOWER: Final = 0.8  #: Lower threshold from which clusters are estimated as well, over the threshold [1].

#: Note of an interval of fewer than ``FEWEST_COUNTS`` occurrences.
FEW: Final = f"fewer than {FEWEST_COUNTS} exceedances; the interval takes their clustering from a lower threshold"

#: Correlation of z above which exceedances are taken as correlated [1]; at 3 sigma it is a correlation of exceedances of some 1 %.
CORRELATED: Final = 0.1

#: Correlation of z from which on it counts in the noise of the other correlations [1].
#:
#: Smaller ones are largely noise themselves, whose sum over all lags would exceed every signal.
_STRONG: Final = 0.3

_ERRORS: Final = 3.0  #: Standard errors by which a correlation of z has to exceed 0.


@dataclass(frozen=True)
class ClusterVariance:
    """Variance of a rate over correlated cells."""

    variance: float | None  #: Variance of the rate [1]; None where it cannot be estimated, with the reason in ``note``.
    degrees: float  #: Degrees of freedom of that estimate [1].
    inflation: float  #: Variance over that of independent pixels, the design effect [1].
    note: str | None = None  #: Reason for the absence of a variance, or what the variance takes as given.


def _size(shape: tuple[int, ...]) -> list[int]:
    """Return twice each length or more, so that the circular products of the transform do not wrap around."""
    from scipy.fft import next_fast_len

    return [int(next_fast_len(2 * n - 1, real=True)) for n in shape]


def _power(e: FloatArray) -> FloatArray:
    """Return the squared modulus of the transform: the transform of the sums of products at every lag."""
    from scipy.fft import rfftn

    wave = rfftn(e, _size(e.shape))
    return np.asarray(wave.real**2 + wave.imag**2, np.float64)


def _products(e: FloatArray) -> FloatArray:
    """Return sums of products at every lag, lag 0 first and negative ones last, with lags of no pairs between them."""
    from scipy.fft import irfftn

    return np.asarray(irfftn(_power(e), _size(e.shape), overwrite_x=True), np.float64)


def _autocovariance(e: FloatArray) -> FloatArray:
    """Return sums of products at every lag, centred (zero lag in the middle), full range."""
    return np.asarray(_products(e)[np.ix_(*(np.arange(-(n - 1), n) for n in e.shape))], np.float64)


def _cutoff(covariance: FloatArray, cells: float) -> int | None:
    """Return the smallest m such that the correlations at the next lags are all noise; None without one within a quarter of the axis."""
    n = covariance.size
    if covariance[0] <= 0:
        return 0
    rho = covariance / covariance[0]
    # Bound and run of lags are those of Politis and White's rule; correlations below 1 % are taken as noise in any case.
    bound = max(2.0 * math.sqrt(math.log10(max(cells, 10.0)) / max(cells, 1.0)), 0.01)
    run = max(3, min(5, n // 8))
    for m in range(max(n // 4, 1) + 1):
        ahead = rho[m + 1 : m + 1 + run]
        if ahead.size and (np.abs(ahead) < bound).all():
            return m
    return None


def _window(m: int, n: int) -> FloatArray:
    """Return the flat-top window at lags -(n-1) ... n-1; it reaches one lag beyond the last correlated one, which costs little."""
    lag = np.abs(np.arange(-(n - 1), n))
    return np.asarray(np.clip(2.0 - lag / (m + 1), 0.0, 1.0) if m > 0 else (lag <= 1) * 1.0)


def _windows(products: FloatArray, occupied: FloatArray) -> tuple[list[FloatArray], list[float]]:
    """Return lag window and number of independent cells along each axis, from sums of products and numbers of pairs at all lags.

    The noise of a correlation depends on the number of independent pairs along the other axes. All times count as one at first; the windows
    of rows and columns are then determined again with the results of the first round.
    """
    sizes = [(n + 1) // 2 for n in products.shape]
    independent = [1.0, *(float(n) for n in sizes[1:])]
    windows = [np.ones(n) for n in products.shape]
    for axis in (1, 2, 0, 1, 2):
        n = sizes[axis]
        zero_lag = tuple(s - 1 for s in np.delete(sizes, axis))
        along = np.moveaxis(products, axis, 0)[n - 1 :, *zero_lag]
        pairs = np.maximum(np.round(np.moveaxis(occupied, axis, 0)[n - 1 :, *zero_lag]), 1.0)
        others = math.prod(independent[i] / sizes[i] for i in range(3) if i != axis)
        # Between all pairs and the independent ones: a window too short costs more coverage than one too long.
        m = _cutoff(along / pairs, float(pairs[0]) * others**0.4) if n > 3 else None
        # An axis that never decorrelates is summed over: its cells are one.
        windows[axis] = np.ones(2 * n - 1) if m is None else _window(m, n)
        independent[axis] = 1.0 if m is None else n / float(windows[axis].sum())
    return windows, independent


class CorrelatedLags:
    """Lags at which one of some fields is correlated, and variances of rates from the products at these lags.

    A correlation counts if it exceeds ``CORRELATED`` and three standard errors, by Bartlett sqrt(sum of squared correlations / pairs).
    The lags need not be neighbours of lag 0: a fast pattern passes over cells between two segments.

    Parameters
    ----------
    fields : sequence of ndarray, shape (segments, tile rows, tile columns)
        Sums of a quantity over the valid pixels of each cell: of z and of z² - 1 [1].
    pixels : ndarray of int
        Valid pixels of each cell, some of them above 0 [1].
    reach : float
        Farthest lags in space that count, over those that are correlated [1].
    """

    def __init__(self, fields: Sequence[FloatArray], pixels: NDArray[np.int64], reach: float = 1.0) -> None:
        from scipy.fft import rfftn

        self.pixels, self.number = pixels, int(pixels.sum())
        pairs = np.rint(_products((pixels > 0).astype(np.float64)))
        most = float(pairs[0, 0, 0])
        usable = pairs > 0.1 * most
        np.maximum(pairs, 1.0, out=pairs)
        #: Whether each lag is correlated; lag 0 is first, negative ones are last.
        self.inside = np.zeros(pairs.shape, np.bool_)
        for field in fields:
            square = _products(field - field.sum() / self.number * pixels)
            if not square[0, 0, 0] > 0.0:
                continue
            square /= pairs
            square /= square[0, 0, 0]
            # Correlations are compared by their squares.
            np.square(square, out=square)
            noise = _ERRORS**2 * float(square[(square > _STRONG**2) & (pairs > 0.25 * most)].sum()) / pairs
            self.inside |= square > np.maximum(noise, CORRELATED**2, out=noise)
        self.inside[0, 0, 0] = True
        if reach > 1.0:
            self.inside |= _stretched(self.inside, reach)
        self.inside &= usable
        # The sum of products at these lags is, by Parseval, a sum over the transform, of which the real one holds half.
        self._weight = rfftn(self.inside.astype(np.float64)).real / pairs.size
        self._weight[..., 1 : (pairs.shape[2] + 1) // 2] *= 2.0
        #: Degrees of freedom of a variance [1].
        self.degrees = most**2 / float(pairs[self.inside].sum()) - 1.0
        #: Share of the variance that the subtraction of the estimated rate removes [1].
        self.lost = self.products(pixels / self.number)

    def products(self, e: FloatArray) -> float:
        """Return the sum of the products of a quantity of the cells at these lags."""
        return float(np.vdot(self._weight, _power(e)))

    def variance(self, counts: NDArray[np.int64], shift: FloatArray | None) -> ClusterVariance | None:
        """Estimate the variance of counts.sum() / pixels.sum() about the region's rate.

        Parameters
        ----------
        counts, shift
            As in ``rate_variance``.

        Returns
        -------
        ClusterVariance, optional
            None where the record holds too few correlation times and lengths.
        """
        if self.lost >= 0.6 or self.degrees < FEWEST_DEGREES:
            return None
        rate = int(counts.sum()) / self.number
        e = counts - rate * self.pixels - (0.0 if shift is None else shift)
        return _stated(self.products(e) / (1.0 - self.lost) / self.number**2, rate, self.number, self.degrees)

    def alarm_variance(self, counts: Sequence[tuple[NDArray[np.int64], FloatArray | None]]) -> ClusterVariance | None:
        """Return the variance with the largest inflation of a rate at its threshold and at a lower one, ``LOWER`` times as high.

        The lower threshold has some ten times as many exceedances, so that their clusters are better known. In Gaussian clutter these are
        at least as large; the clusters of the threshold itself count where bright objects lie in noise.

        Parameters
        ----------
        counts : sequence of (ndarray of int, ndarray)
            Exceedances of each cell at the threshold and at the lower one, with the shift of ``rate_variance`` [1].

        Returns
        -------
        ClusterVariance, optional
            None where both thresholds have too few exceedances or the record holds too few correlation times and lengths.
        """
        known = [pair for pair in counts if FEWEST_COUNTS <= int(pair[0].sum()) <= self.number - FEWEST_COUNTS]
        usable = [variance for pair in known if (variance := self.variance(*pair)) is not None]
        return max(usable, key=lambda variance: variance.inflation, default=None)


def _stretched(inside: NDArray[np.bool_], reach: float) -> NDArray[np.bool_]:
    """Return lags in space within ``reach`` times the lags given, of all times; lag 0 first, negative ones last."""
    out = inside
    for axis in (1, 2):
        n = out.shape[axis]
        lag = np.fft.fftfreq(n, 1.0 / n)
        out = np.take(out, np.fix(np.abs(lag) / reach).astype(int) * np.sign(lag).astype(int), axis=axis)
    return out


def _stated(variance: float, rate: float, number: int, degrees: float, note: str | None = None) -> ClusterVariance:
    binomial = rate * (1.0 - rate) / number
    # A variance below independence occurs by chance, or for filters that push neighbours apart; it is accepted down to a quarter.
    variance = max(variance, 0.25 * binomial)
    return ClusterVariance(variance, degrees, variance / binomial, note)


def rate_variance(counts: NDArray[np.int64], pixels: NDArray[np.int64], shift: FloatArray | None = None) -> ClusterVariance:
    """Estimate the variance of counts.sum() / pixels.sum() with correlation between cells that are near in time or space.

    Parameters
    ----------
    counts, pixels : ndarray of int
        Occurrences and valid pixels in each cell, shape (segments, tile rows, tile columns) [1]; cells without pixels are 0 in both.
    shift : ndarray, optional
        Number of occurrences by which the cell moved the total through a threshold that was estimated from the same pixels [1].

    Returns
    -------
    ClusterVariance
        Variance of the rate; it needs a record that holds several correlation times or lengths.
    """
    total, number = int(counts.sum()), int(pixels.sum())
    if number == 0 or total == 0 or total == number:
        return ClusterVariance(None, 0.0, math.nan, "no exceedances" if number else "no valid pixels")
    rate = total / number
    share = pixels / number
    within_tiles = np.divide(counts.sum(0), pixels.sum(0), out=np.zeros(counts.shape[1:]), where=pixels.sum(0) > 0)
    plans: list[tuple[FloatArray, Reference]] = [(within_tiles, "tiles")] if counts.shape[0] >= FEWEST_TIMES else []
    plans += [(np.full(counts.shape[1:], rate), "region"), (_margins(counts, pixels, rate), "margins")]
    occupied = _autocovariance((pixels > 0).astype(np.float64))
    for expected, reference in plans:
        from_tiles = reference == "tiles"
        e = counts - expected * pixels - (0.0 if shift is None else shift)
        products = _autocovariance(e)
        windows, independent = _windows(products, occupied)
        # A frozen pattern has no residuals from its own mean, which is no evidence about another pattern.
        frozen = reference != "region" and float((e * e).sum()) < 0.3 * total * (1.0 - rate)
        if frozen or (from_tiles and independent[0] < FEWEST_TIMES):
            continue
        weight = windows[0][:, None, None] * windows[1][:, None] * windows[2]
        value = float((weight * products).sum())
        # Share of the variance that the subtraction of the estimated rate removed: the weight of each window in the pairs of cells.
        if reference == "region":
            lost = float((weight * _autocovariance(share)).sum())
        elif reference == "tiles":
            lost = 1.0 / independent[0]
        else:
            lost = (1.0 / independent[1] + 1.0 / independent[2]) / independent[0]
        pair_share = occupied / occupied[tuple(s // 2 for s in occupied.shape)]
        degrees = float(round((pixels > 0).sum()) / (weight**2 * pair_share).sum()) - (0.0 if from_tiles else 1.0)
        if lost >= 0.6 or degrees < FEWEST_DEGREES:
            continue
        note = "the interval leaves out how rates differ between rows and between columns" if reference == "margins" else None
        return _stated(value / (1.0 - lost) / number**2, rate, number, degrees, note)
    return ClusterVariance(None, 0.0, math.nan, "exceedances stay correlated over the whole region and record")


def _margins(counts: NDArray[np.int64], pixels: NDArray[np.int64], rate: float) -> FloatArray:
    """Return the rate of each tile as the product of its row's and its column's rate over the region's rate."""

    def along(axis: int) -> FloatArray:
        number = pixels.sum(axis=(0, axis))
        return np.asarray(np.divide(counts.sum(axis=(0, axis)), number, out=np.zeros(number.size), where=number > 0))

    return np.asarray(along(2)[:, None] * along(1)[None, :] / rate)


def score_interval(count: int, pixels: int, inflation: float, degrees: float, level: float) -> tuple[float, float]:
    """Return Wilson's interval for a rate, with the effective number pixels / inflation and Student's t in place of the Gaussian.

    Returns
    -------
    low, high : float
        Bounds of the rate [1].
    """
    from scipy.stats import norm, t

    q = float(t.ppf(0.5 + level / 2, degrees)) if math.isfinite(degrees) else float(norm.ppf(0.5 + level / 2))
    n = pixels / inflation
    p = count / pixels
    centre = (p + q * q / (2 * n)) / (1 + q * q / n)
    half = q / (1 + q * q / n) * math.sqrt(p * (1 - p) / n + q * q / (4 * n * n))
    return max(centre - half, 0.0), min(centre + half, 1.0)


def student_widening(degrees: float, level: float) -> float:
    """Return the square of Student's quantile over the Gaussian one: the widening for a variance that is estimated itself [1].

    Parameters
    ----------
    degrees : float
        Degrees of freedom of the variance [1]; infinite where it is known.
    level : float
        Level of the interval [1].
    """
    from scipy.special import ndtri, stdtrit

    if not math.isfinite(degrees):
        return 1.0
    return float(stdtrit(degrees, 0.5 + 0.5 * level) / ndtri(0.5 + 0.5 * level)) ** 2


def effective_interval(count: int, pixels: int, inflation: float, degrees: float, level: float) -> tuple[float, float]:
    """Return the interval of a rate with the effective number of pixels and of occurrences.

    Both numbers are divided by the inflation and by the square of Student's t over the Gaussian quantile. The ends are quantiles of beta
    distributions: those of the exact interval for fewer than ``FEWEST_COUNTS`` occurrences, and Jeffreys' for more, as the exact interval
    of a few large clusters is too wide (it contains the rate in 97.8 % in place of 95 %).

    Returns
    -------
    low, high : float
        Bounds of the rate [1].
    """
    from scipy.special import betaincinv

    tail = 0.5 * (1.0 - level)
    wider = student_widening(degrees, level) * inflation
    k, n = count / wider, pixels / wider
    part = 0.0 if count < FEWEST_COUNTS else 0.5
    low = float(betaincinv(k + part, n - k + 1.0 - part, tail)) if count else 0.0
    high = float(betaincinv(k + 1.0 - part, n - k + part, 1.0 - tail)) if count < pixels else 1.0
    return low, high
