"""Gauss-Markov fields: Gaussian conditional autoregressions on a torus, in space or in space and time (Besag 1974; Rue and Held 2005).

Given all others, a pixel is Gaussian about a weighted sum of its neighbours::

    E[x(s) | rest] = mean + sum_k b_k (x(s + d_k) + x(s - d_k) - 2 mean)
    Var[x(s) | rest] = v

with offsets d = (frames, rows, columns). On a torus the covariance is diagonal in the Fourier basis, with the spectral density
``S(w) = v / (1 - 2 sum_k b_k cos(w . d_k))``, which has to be above 0: likelihood and samples are exact, at the cost of a transform.
A pair of neighbours is symmetric in a stationary field (d and -d are one), but an offset (1, dy, dx) need not have the weight of
(1, -dy, -dx): such fields are not separable, and texture travels.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject

KIND: Final = "gauss-markov"

# Frames, rows, columns from a pixel to a neighbour.
Offset = tuple[int, int, int]

FLAT: Final = 1e-12  #: Least value of 1 - 2 sum b cos at which a field has a variance; below it one wave takes all of it.


MOST_VALLEYS: Final = 200  #: Largest number of minima of a symbol that are refined.


def canonical(offset: Sequence[int]) -> Offset:
    """Representative of d and -d: the one that comes first in time, then downwards, then to the right.

    Examples
    --------
    >>> canonical((0, -1, 2))
    (0, 1, -2)
    """
    t, y, x = (0, *offset) if len(offset) == 2 else offset
    d = (int(t), int(y), int(x))
    if d == (0, 0, 0):
        raise DomainError("offset (0, 0, 0) is the pixel itself; give offsets of its neighbours")
    return d if d > (0, 0, 0) else (-d[0], -d[1], -d[2])


@dataclass(frozen=True)
class GaussMarkov:
    """Gauss-Markov field on a torus.

    Raises
    ------
    DomainError
        Offsets twice, as many coefficients as there are no offsets, a variance that is not above 0.
    """

    offsets: tuple[Offset, ...]  #: Neighbours (frames, rows, columns), one of each pair.
    coefficients: tuple[float, ...]  #: Weight of both of each pair [1].
    variance: float  #: Conditional variance of a pixel given all others [u²].
    mean: float = 0.0  #: Mean of the field [u].

    def __post_init__(self) -> None:
        offsets = tuple(canonical(d) for d in self.offsets)
        if len(set(offsets)) != len(offsets):
            raise DomainError(f"offsets {list(self.offsets)} hold a neighbour twice (d and -d are one pair); give each once")
        if len(offsets) != len(self.coefficients):
            raise DomainError(f"{len(offsets)} offsets and {len(self.coefficients)} coefficients; give one coefficient for each offset")
        if not (math.isfinite(self.variance) and self.variance > 0.0 and np.isfinite(self.coefficients).all() and math.isfinite(self.mean)):
            raise DomainError(f"variance = {self.variance:g}; give finite coefficients and a conditional variance above 0")
        object.__setattr__(self, "offsets", offsets)
        object.__setattr__(self, "coefficients", tuple(float(b) for b in self.coefficients))

    @property
    def reach(self) -> Offset:
        """Largest offset along each axis [frames, rows, columns]."""
        sides = np.abs(np.array(self.offsets, int).reshape(-1, 3)).max(axis=0, initial=0)
        return int(sides[0]), int(sides[1]), int(sides[2])

    def to_dict(self) -> JsonObject:
        """Return the field as values for JSON."""
        return {
            "kind": KIND,
            "offsets": [list(d) for d in self.offsets],
            "coefficients": list(self.coefficients),
            "variance": self.variance,
            "mean": self.mean,
        }

    @classmethod
    def from_dict(cls, table: Mapping[str, Any]) -> GaussMarkov:
        """Read the output of :meth:`to_dict`."""
        offsets = tuple(canonical(d) for d in table["offsets"])
        return cls(offsets, tuple(map(float, table["coefficients"])), float(table["variance"]), float(table["mean"]))


def require_torus(model: GaussMarkov, shape: Sequence[int]) -> Offset:
    """Shape (frames, rows, columns) of a torus, refused where the neighbourhood does not fit on it.

    Raises
    ------
    DomainError
        A side on which a neighbour to one side is also one to the other.
    """
    sides = (1, *shape) if len(shape) == 2 else tuple(shape)
    # On a shorter side d and -d would be the same neighbour, counted twice.
    least = [2 * reach + 1 for reach in model.reach]
    if len(sides) != 3 or any(side < need for side, need in zip(sides, least, strict=True)):
        raise DomainError(
            f"a torus of {' x '.join(map(str, sides))} (frames x rows x columns) is too small for neighbours up to "
            f"{' x '.join(map(str, model.reach))} away; give at least {' x '.join(map(str, least))}"
        )
    return int(sides[0]), int(sides[1]), int(sides[2])


def symbol(model: GaussMarkov, shape: Sequence[int]) -> FloatArray:
    """Symbol ``1 - 2 sum_k b_k cos(w . d_k)`` at the frequencies of a torus [1, (frames, rows, columns // 2 + 1)], as of ``rfftn``.

    Raises
    ------
    DomainError
        A torus that is too small, or one with a wave without a finite variance.
    """
    result = 1.0 - 2.0 * _cosines(model.offsets, model.coefficients, require_torus(model, shape))
    least = float(result.min())
    if least < FLAT:
        raise DomainError(
            f"the weights leave 1 - 2 sum b cos = {least:.2g} for a wave of this torus, and a field needs more than 0; "
            "take weights that sum to less than 1/2, or another size"
        )
    return result


def _cosines(offsets: Sequence[Offset], weights: Sequence[float], shape: Offset) -> FloatArray:
    """Sum ``sum_k weights_k cos(w . d_k)`` on the half spectrum, by products of phases along the axes, as offsets are few."""
    frequencies = [2.0 * np.pi * np.fft.fftfreq(n) for n in shape[:2]] + [2.0 * np.pi * np.fft.rfftfreq(shape[2])]
    out = np.zeros((shape[0], shape[1], shape[2] // 2 + 1))
    for (t, y, x), weight in zip(offsets, weights, strict=True):
        slow = (t * frequencies[0])[:, None] + (y * frequencies[1])[None, :]
        fast = x * frequencies[2]
        # cos(a + c) = cos a cos c - sin a sin c: no cosine of every frequency.
        out += (weight * np.cos(slow))[:, :, None] * np.cos(fast)
        out -= (weight * np.sin(slow))[:, :, None] * np.sin(fast)
    return out


def least_symbol(model: GaussMarkov, grid: Sequence[int]) -> float:
    """Smallest symbol ``1 - 2 sum_k b_k cos(w . d_k)`` over all frequencies [1]: above 0 a field of any size exists.

    Parameters
    ----------
    model : GaussMarkov
    grid : (int, int, int)
        Torus from whose lowest frequencies the minimum is searched downhill.
    """
    from scipy.ndimage import minimum_filter
    from scipy.optimize import minimize

    if not model.offsets:
        return 1.0
    offsets, weights = np.array(model.offsets, float), np.array(model.coefficients)
    # Finer than the grid, which does not resolve troughs that run obliquely between its points.
    finer = 4 if model.reach[0] == 0 else 2
    sides = [finer * max(n, 2 * r + 1) if r else 1 for n, r in zip(grid, model.reach, strict=True)]
    values = 1.0 - 2.0 * _cosines(model.offsets, model.coefficients, (sides[0], sides[1], sides[2]))
    # Every valley of the grid that can be the deepest between its points: curvature times half a step squared lower than it looks.
    steps = 2.0 * np.pi / np.array(sides)
    deeper = float(np.abs(weights) @ ((np.abs(offsets) @ (0.5 * steps)) ** 2))
    valleys = np.flatnonzero((values <= minimum_filter(values, 3, mode="nearest")) & (values < values.min() + deeper))
    lowest = valleys[np.argsort(values.ravel()[valleys])][:MOST_VALLEYS]

    def value(w: FloatArray) -> tuple[float, FloatArray]:
        phase = offsets @ w
        return float(1.0 - 2.0 * weights @ np.cos(phase)), 2.0 * (weights * np.sin(phase)) @ offsets

    places = 2.0 * np.pi * np.array(np.unravel_index(lowest, values.shape)).T / np.array(sides)
    # Near the valley: a long first step would leave it for another.
    minima = (minimize(value, w, jac=True, method="L-BFGS-B", bounds=list(zip(w - 3 * steps, w + 3 * steps, strict=True))) for w in places)
    return min(float(result.fun) for result in minima)


def spectral_density(model: GaussMarkov, shape: Sequence[int]) -> FloatArray:
    """Variance of the waves of a torus, ``v / symbol`` [u², (frames, rows, columns // 2 + 1)]; the mean is a pixel's."""
    return model.variance / symbol(model, shape)


def covariance(model: GaussMarkov, shape: Sequence[int]) -> FloatArray:
    """Covariance of two pixels of a torus by their distance [u², (frames, rows, columns)], the variance at (0, 0, 0)."""
    from scipy.fft import irfftn

    sides = require_torus(model, shape)
    return np.asarray(irfftn(spectral_density(model, sides), s=sides))


def half_weights(columns: int) -> FloatArray:
    """Multiplicity of each column of a half spectrum in the whole one: two but for frequency 0 and Nyquist's."""
    # A real field has conjugate amplitudes at opposite frequencies: the half spectrum stands for both.
    weights = np.full(columns // 2 + 1, 2.0)
    weights[0] = 1.0
    if columns % 2 == 0:
        weights[-1] = 1.0
    return weights


def log_likelihood(model: GaussMarkov, field: ArrayLike) -> float:
    """Exact log likelihood of a field on its own torus [1].

    ``-n/2 log(2 pi v) + 1/2 sum_w log(symbol) - 1/(2 v) sum_w symbol |X(w)|²/n``

    Parameters
    ----------
    model : GaussMarkov
    field : array_like, shape (rows, columns) or (frames, rows, columns)
        Periodic along every axis [u]; for pictures cut from a larger sea see :mod:`seaglint.textures.gauss_markov_fit`.

    Returns
    -------
    float
        Log likelihood [nat].

    Raises
    ------
    DataError, DomainError
        Values that are missing; a torus too small for the model.
    """
    from scipy.fft import rfftn

    x = np.array(field, np.float64, ndmin=3)
    if not np.isfinite(x).all():
        raise DataError("the field has values that are missing or infinite; a torus needs all of them")
    sides = require_torus(model, x.shape)
    power = np.abs(rfftn(x - model.mean)) ** 2 / x.size
    weight = half_weights(sides[2])
    values = symbol(model, sides)
    total = float((weight * (np.log(values) - values * power / model.variance)).sum())
    return 0.5 * (total - x.size * math.log(2.0 * math.pi * model.variance))


def conditional(model: GaussMarkov, field: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the expected value of each pixel given its neighbours, where all of them lie in the picture, and its actual value [u].

    Parameters
    ----------
    model : GaussMarkov
    field : array_like, shape (rows, columns) or (frames, rows, columns)
        Not periodic [u].

    Returns
    -------
    expected, actual : ndarray, shape (frames - 2 t, rows - 2 y, columns - 2 x)
        For a reach (t, y, x).

    Raises
    ------
    DomainError
        A picture smaller than the neighbourhood.
    """
    x = np.array(field, np.float64, ndmin=3)
    require_torus(model, x.shape)
    reach = model.reach

    def moved(d: Offset) -> FloatArray:
        return x[tuple(slice(r + step, n - r + step) for r, step, n in zip(reach, d, x.shape, strict=True))]

    actual = moved((0, 0, 0))
    expected = np.full(actual.shape, model.mean)
    for d, b in zip(model.offsets, model.coefficients, strict=True):
        expected += b * (moved(d) + moved((-d[0], -d[1], -d[2])) - 2.0 * model.mean)
    return expected, actual


def pseudo_log_likelihood(model: GaussMarkov, field: ArrayLike) -> float:
    """Mean log density of a pixel given its neighbours (Besag 1975) [per pixel]; arguments as in ``conditional``."""
    expected, actual = conditional(model, field)
    return float(-0.5 * math.log(2.0 * math.pi * model.variance) - 0.5 * np.mean((actual - expected) ** 2) / model.variance)
