r"""Laws of wind and cloud within a month about their monthly means: Weibull's for the wind, a beta law in oktas for the cloud cover.

The wind follows

.. math:: P(U > u) = \exp\left[-(u/c)^k\right], \qquad c = \bar U / \Gamma(1 + 1/k)

with the mean :math:`\bar U` and a shape k. The cloud cover is reported in eighths (oktas): a beta law of the mean N and the sum s of its
parameters, :math:`B(N s, (1 - N) s)`, is counted in the nine classes of an observer, of which clear (below 1/16) and overcast (from 15/16)
are half as wide. They stay separate states with chances of their own: only an overcast sky hides the Sun from a whole trajectory.

Wind and cloud cover are joined by a Gaussian copula of correlation ``WIND_CLOUD``.

Shapes are estimates. Scatterometer winds have a ratio of mean to standard deviation, and with it a shape, that is small over the
extratropical oceans of the north (positive skewness), larger over the Southern Ocean (skewness near 0, as Weibull's at k = 3.6) and largest
in the trades (Monahan 2006); winds of single reports scatter more than those, which lowers k.

References
----------
E. G. Pavia and J. J. O'Brien, Weibull statistics of wind speed over the ocean, J. Climate Appl. Meteor. 25 (1986) 1324-1332.
A. H. Monahan, The probability distribution of sea surface wind speeds, part I, J. Climate 19 (2006) 497-520.
S. G. Warren, C. J. Hahn and J. London, Simultaneous occurrence of different cloud types, J. Climate Appl. Meteor. 24 (1985) 658-667.
L. W. Falls, The beta distribution: a statistical model for world cloud cover, J. Geophys. Res. 79 (1974) 1261-1264.
"""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import betainc, gamma, gammainc, ndtr, ndtri

from seaglint.base.conventions import FloatArray

#: Sum of the parameters of the beta law of cloud cover [1]; with it 5 % of all skies over the seas of the climatology are clear and 24 %
#: overcast. Clear skies are a quarter as frequent over the sea as over land (Warren, Hahn and London 1985). An estimate.
CLOUD_SUM: Final = 1.6

#: Correlation of the normal scores of wind and cloud cover within a month [1]: strong winds come with clouds. An estimate.
WIND_CLOUD: Final = 0.15

#: Shape of the Weibull law of the wind by latitude [deg, 1], of winds as steady as there on average.
_SHAPE_LATITUDES: Final = (-90.0, -40.0, -30.0, -15.0, -3.0, 3.0, 15.0, 30.0, 40.0, 90.0)
_SHAPES: Final = (2.5, 2.5, 2.3, 3.0, 2.6, 2.4, 3.0, 2.2, 2.1, 2.1)

_VARIABLE: Final = 2.1  #: Shape of variable winds.

#: Monthly means between which the winds of low latitudes turn from variable to steady [m/s]: there weak winds are no trades.
_STEADY: Final = (4.0, 7.0)

_EDGES: Final = np.concatenate([[0.0], (np.arange(8) + 0.5) / 8.0, [1.0]])  #: Edges of the nine classes of an observer.
_MEANS: Final = 512  #: Number of means at which the law of cloud is tabulated.


def wind_shape(latitude: ArrayLike, mean: ArrayLike) -> FloatArray:
    """Shape k of the Weibull law of the wind within a month [1].

    Parameters
    ----------
    latitude : array_like
        Latitude, north positive [deg].
    mean : array_like
        Mean of the month [m/s]; broadcast.

    Returns
    -------
    ndarray
        Shape, 2.1 to 3: an estimate, see the notes of this module.

    Examples
    --------
    >>> wind_shape([50.0, 15.0, 15.0], [10.0, 8.0, 4.0]).round(2).tolist()
    [2.1, 3.0, 2.1]
    """
    north = np.asarray(latitude, dtype=np.float64)
    steady = np.interp(north, _SHAPE_LATITUDES, _SHAPES)
    share = np.clip((np.asarray(mean, dtype=np.float64) - _STEADY[0]) / (_STEADY[1] - _STEADY[0]), 0.0, 1.0)
    return np.asarray(_VARIABLE + (steady - _VARIABLE) * share)


def wind_at(uniform: ArrayLike, mean: ArrayLike, shape: ArrayLike) -> FloatArray:
    """Wind of a Weibull law at uniform numbers, calms first [m/s].

    ``u = c (-ln(1 - x))^(1/k)`` with ``c = mean / Gamma(1 + 1/k)``.

    >>> float(wind_at(1.0 - np.exp(-1.0), 8.0, 2.0).round(3))
    9.027
    """
    k = np.asarray(shape, dtype=np.float64)
    scale = np.asarray(mean, dtype=np.float64) / gamma(1.0 + 1.0 / k)
    return np.asarray(scale * (-np.log1p(-np.asarray(uniform, dtype=np.float64))) ** (1.0 / k))


def cloud_shares(mean: ArrayLike) -> FloatArray:
    """Share of each of the nine oktas about a mean cover [(..., 9)], clear first; their mean is ``mean``.

    >>> cloud_shares(0.7).round(2).tolist()
    [0.02, 0.05, 0.06, 0.07, 0.09, 0.1, 0.13, 0.19, 0.28]
    """
    n = np.asarray(mean, dtype=np.float64)
    return np.diff(_cumulative(n), axis=-1)


def _cumulative(mean: FloatArray) -> FloatArray:
    """Cumulative shares at the edges of the classes [(..., 10)], linear between the means of a table."""
    i, f = _place(mean)
    table = _table()
    return np.asarray((1.0 - f)[..., None] * table[i] + f[..., None] * table[i + 1])


def _place(mean: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
    """Place of means among those of the table: the lower one, and the share of the next."""
    x = np.clip(mean, 0.0, 1.0) * (_MEANS - 1)
    i = np.minimum(x.astype(np.intp), _MEANS - 2)
    return i, x - i


@cache
def _table() -> FloatArray:
    """Cumulative shares [(means, 10)] of laws whose mean in oktas is exactly each mean."""
    # Counting in eighths moves the mean of a lopsided law: the parameter that gives the requested mean is looked up.
    parameter = np.linspace(0.0, 1.0, 4 * _MEANS + 1)[1:-1]
    cumulative = betainc(CLOUD_SUM * parameter[:, None], CLOUD_SUM * (1.0 - parameter[:, None]), _EDGES)
    counted = np.diff(cumulative, axis=1) @ (np.arange(9) / 8.0)
    ends = np.array([[0.0, *np.ones(9)], [*np.zeros(9), 1.0]])
    known, laws = np.concatenate([[0.0], counted, [1.0]]), np.concatenate([ends[:1], cumulative, ends[1:]])
    means = np.linspace(0.0, 1.0, _MEANS)
    return np.stack([np.interp(means, known, column) for column in laws.T], axis=1)


def cloud_at(uniform: ArrayLike, mean: ArrayLike) -> FloatArray:
    """Cloud cover at uniform numbers, clear first [1, in eighths].

    >>> cloud_at([0.01, 0.5, 0.99], 0.7).tolist()
    [0.0, 0.75, 1.0]
    """
    u, n = np.broadcast_arrays(np.asarray(uniform, dtype=np.float64), np.asarray(mean, dtype=np.float64))
    i, f = _place(n)
    oktas = np.zeros(u.shape)
    for edge in _table()[:, 1:9].T:
        oktas += u >= (1.0 - f) * edge[i] + f * edge[i + 1]
    return np.asarray(oktas / 8.0)


def joined(wind: ArrayLike, cloud: ArrayLike) -> FloatArray:
    """Uniform numbers of the cloud cover, from independent ones and those of the wind, joined by a Gaussian copula.

    ``Phi(r Phi^-1(wind) + sqrt(1 - r^2) Phi^-1(cloud))`` with r = ``WIND_CLOUD``.

    >>> joined([0.5, 0.99], [0.5, 0.5]).round(2).tolist()
    [0.5, 0.64]
    """
    one, other = (ndtri(np.clip(np.asarray(x, dtype=np.float64), 1e-15, 1.0 - 1e-15)) for x in (wind, cloud))
    return np.asarray(ndtr(WIND_CLOUD * one + np.sqrt(1.0 - WIND_CLOUD**2) * other))


#: Probabilities of the classes of wind speed of a table of rows, from calm to strong, finest among light winds [1].
WIND_CLASSES: Final = (0.01, 0.02, 0.03, 0.04, 0.10, 0.15, 0.20, 0.20, 0.15, 0.07, 0.03)

_INSIDE: Final = 4  #: Number of winds of a class at which its shares of cloud are evaluated.


def class_means(mean: ArrayLike, shape: ArrayLike) -> FloatArray:
    """Mean wind of each class of ``WIND_CLASSES`` of the Weibull law [m/s, (..., 11)].

    Up to a wind u the law has the share ``1 - exp(-x)``, ``x = (u / c)^k``, and of its mean the share ``P(1 + 1/k, x)``, the regularised
    incomplete gamma function.
    """
    k = np.asarray(shape, dtype=np.float64)[..., None]
    x = np.concatenate([-np.log1p(-np.concatenate([[0.0], np.cumsum(WIND_CLASSES)[:-1]])), [np.inf]])
    return np.asarray(np.asarray(mean, dtype=np.float64)[..., None] * np.diff(gammainc(1.0 + 1.0 / k, x), axis=-1) / np.array(WIND_CLASSES))


def joint_shares(mean: ArrayLike) -> FloatArray:
    """Share of each class of wind and each okta about a mean cover, by the copula of ``joined`` [(..., 11, 9), sums to 1].

    >>> joint_shares(0.7).sum(axis=0).round(2).tolist() == cloud_shares(0.7).round(2).tolist()
    True
    """
    ends = np.concatenate([[0.0], np.cumsum(WIND_CLASSES)])
    inside = ends[:-1, None] + np.diff(ends)[:, None] * (np.arange(_INSIDE) + 0.5) / _INSIDE
    # Of each class the mean of the chances given the wind.
    given = WIND_CLOUD * ndtri(inside)[..., None]
    score = ndtri(np.clip(_cumulative(np.asarray(mean, dtype=np.float64)), 0.0, 1.0))[..., None, None, :]
    below = ndtr((score - given) / np.sqrt(1.0 - WIND_CLOUD**2)).mean(axis=-2)
    return np.asarray(np.diff(below, axis=-1) * np.array(WIND_CLASSES)[:, None])
