"""Fit of a Gauss-Markov field by maximum likelihood, and of its neighbourhood by an information criterion.

In the precisions ``theta = (1, b) / v`` a Gauss-Markov field is an exponential family: its log likelihood ``n/2 [mean log(lambda) - sum_k
c_k theta_k]``, ``lambda(w) = theta_0 - 2 sum_k theta_k cos(w . d_k)``, needs of the data only their covariances at the neighbours, is
concave, and has one optimum where the model has those covariances too (Dempster 1972). Newton's method finds it from anywhere; its matrices
are covariances of covariances, a transform of ``1/lambda²``.

A picture is no torus: pixels at its left border are no neighbours of pixels at its right one. Its covariances are sums over the pairs
inside, divided by their number (Guyon 1982), without the plain periodogram's error at the border; the grid of frequencies belongs to a
torus as large as the picture.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.textures.gauss_markov import GaussMarkov, Offset, canonical, half_weights, least_symbol

PER_PARAMETER: Final = 50  #: Least number of pixels for each parameter.

#: Largest number of steps of Newton's method; ten suffice unless the optimum lies on the border of the region, where there is none.
STEPS: Final = 60

LEAST: Final = 1e-5  #: Least value of 1 - 2 sum b cos of a fitted field.

SMALLEST_TORUS: Final = 16  #: Least side of the torus that represents an infinite plane, in times the largest offset.


@dataclass(frozen=True)
class Covariances:
    """Covariances of a field, the sufficient statistics of the likelihood."""

    values: FloatArray  #: Covariance by distance (frames, rows, columns), the variance in the middle [u², (2 reach + 1, ...)].
    mean: float  #: Mean of the field [u].
    shape: Offset  #: Shape of the field: rows, columns [px].
    periodic: bool  #: Whether the field is a torus.
    valid: int | None = None  #: Number of pixels with a value; all of the field by default.

    @property
    def reach(self) -> Offset:
        """Largest stored distance along each axis."""
        t, y, x = (n // 2 for n in self.values.shape)
        return t, y, x

    @property
    def pixels(self) -> int:
        """Number of pixels of the field that have a value."""
        return math.prod(self.shape) if self.valid is None else self.valid

    def at(self, offset: Offset) -> float:
        """Covariance at a distance [u²]."""
        t, y, x = (n + d for n, d in zip(self.reach, offset, strict=True))
        return float(self.values[t, y, x])

    def damped(self) -> Covariances:
        """Return the covariances times a triangle along each axis, with a spectrum without negative values, as a field has."""
        out = self.values.copy()
        for axis, reach in enumerate(self.reach):
            lags = np.abs(np.arange(-reach, reach + 1))
            taper = 1.0 - lags / (max(self.shape[axis], reach + 1) if self.periodic else max(self.shape[axis], 2 * reach + 1))
            out *= taper.reshape([-1 if i == axis else 1 for i in range(3)])
        spectrum = np.fft.fftn(np.fft.ifftshift(out)).real
        # A field has a positive spectrum; a millionth of the largest value bounds the precisions.
        spectrum = np.maximum(spectrum, 1e-6 * spectrum.max())
        return Covariances(np.fft.fftshift(np.fft.ifftn(spectrum).real), self.mean, self.shape, self.periodic, self.valid)


def covariances(field: ArrayLike, reach: Sequence[int], *, periodic: bool = False, mean: float | None = None) -> Covariances:
    """Covariances of a field at distances up to ``reach``.

    Parameters
    ----------
    field : array_like, shape (rows, columns) or (frames, rows, columns)
        [u]; NaN where a pixel does not count.
    reach : (int, int, int)
        Largest distance in frames, rows, columns.
    periodic : bool
        Whether the field is a torus. Else each distance's products are averaged over the pairs inside of which both have a value.
    mean : float, optional
        The field's where it is known [u]; its arithmetic one by default.

    Raises
    ------
    DataError
        Infinite values, missing ones on a torus, a field smaller than the reach, or a distance without pairs.
    """
    from scipy.fft import irfftn, next_fast_len, rfftn

    x = np.array(field, np.float64, ndmin=3)
    valid = np.isfinite(x)
    gaps = not valid.all()
    if gaps and (periodic or not valid.any() or np.isinf(x).any()):
        raise DataError("the field has values that are missing or infinite; choose a region without them")
    if any(n <= 2 * r for n, r in zip(x.shape, reach, strict=True)):
        raise DataError(f"a field of {' x '.join(map(str, x.shape))} is too small for distances up to {' x '.join(map(str, reach))}")
    level = float(x[valid].mean() if gaps else x.mean()) if mean is None else mean
    x -= level
    if gaps:
        x[~valid] = 0.0
    size = x.shape if periodic else tuple(next_fast_len(n + r, real=True) for n, r in zip(x.shape, reach, strict=True))
    power = rfftn(x, s=size)
    sums = irfftn((power * power.conj()).real, s=size)
    lags = [np.arange(-r, r + 1) for r in reach]
    pairs = math.prod(x.shape) * np.ones(1)
    if gaps:
        # The transform of the mask counts the pairs of which both pixels have a value.
        power = rfftn(valid.astype(np.float64), s=size)
        pairs = np.rint(irfftn((power * power.conj()).real, s=size)[np.ix_(*lags)])
        if not pairs.min() > 0.0:
            raise DataError(
                f"{np.count_nonzero(valid)} of {x.size} pixels have a value, and none of them are some distances up to "
                f"{' x '.join(map(str, reach))} apart; choose a region with fewer gaps"
            )
    elif not periodic:
        inside = [n - np.abs(lag) for n, lag in zip(x.shape, lags, strict=True)]
        pairs = inside[0][:, None, None] * inside[1][:, None] * inside[2]
    count = int(np.count_nonzero(valid)) if gaps else None
    return Covariances(sums[np.ix_(*lags)] / pairs, level, (x.shape[0], x.shape[1], x.shape[2]), periodic, count)


@dataclass(frozen=True)
class GaussMarkovFit:
    """Fitted Gauss-Markov field."""

    model: GaussMarkov  #: Field at the optimum.
    standard_errors: tuple[float, ...]  #: Standard errors of the coefficients [1], from the information of the likelihood.
    variance_error: float  #: Standard error of the conditional variance [u²].
    log_likelihood: float  #: At the optimum [1].
    pixels: int  #: Number of pixels of the data.
    steps: int  #: Number of steps of Newton's method.
    notes: tuple[str, ...] = ()  #: Notes for readers of results.

    @property
    def bic(self) -> float:
        """Schwarz's information criterion, ``-2 log L + parameters log(pixels)``; smaller is better."""
        return -2.0 * self.log_likelihood + (len(self.model.offsets) + 2) * math.log(self.pixels)


#: Largest torus of the search for a neighbourhood, without and with time; the data enter by their covariances, whatever their size.
SEARCHED: Final = ((1, 256, 256), (32, 64, 64))

#: Largest torus that represents an infinite plane; long waves with much of the variance need a fine grid of frequencies.
LARGEST_TORUS: Final = ((1, 512, 512), (64, 128, 128))

SEARCH: Final = 1e-9  #: Gain of log likelihood per pixel at which the steps of the search for a neighbourhood end: 1e-5 of the criterion.


class _Likelihood:
    """Log likelihood of precisions on the grid of a torus; gradients and information from its transforms."""

    def __init__(self, data: Covariances, offsets: Sequence[Offset], largest: tuple[Offset, Offset] = LARGEST_TORUS) -> None:
        from scipy.fft import next_fast_len

        self.data = data
        far = np.abs(np.array([*offsets, (0, 0, 0)])).max(axis=0)
        if data.periodic:
            self.shape = data.shape
        else:
            plane = largest[int(data.shape[0] > 1)]
            sides = [max(min(n, most), SMALLEST_TORUS * int(f)) if n > 1 else 1 for n, most, f in zip(data.shape, plane, far, strict=True)]
            self.shape = tuple(next_fast_len(n, real=True) for n in sides)  # type: ignore[assignment]
        self.offsets = tuple(offsets)

    def _moments(self) -> FloatArray:
        """Coefficients of the precisions in the log likelihood: twice the covariances, but once the variance, with the sign of lambda."""
        return np.array([self.data.at((0, 0, 0)), *(-2.0 * self.data.at(d) for d in self.offsets)])

    def spectrum(self, theta: FloatArray) -> FloatArray:
        """Spectrum lambda on the half grid of frequencies."""
        from scipy.fft import rfftn

        kernel = np.zeros(self.shape)
        kernel[0, 0, 0] = theta[0]
        for (t, y, x), value in zip(self.offsets, theta[1:], strict=True):
            kernel[t, y, x] -= value
            kernel[-t, -y, -x] -= value
        return np.asarray(rfftn(kernel).real)

    def value(self, theta: FloatArray, lam: FloatArray) -> float:
        """Log likelihood per pixel, without its constant; -inf outside the region."""
        if not float(lam.min()) > 0.0:
            return -math.inf
        mean_log = float((np.log(lam) * half_weights(self.shape[2])).sum()) / math.prod(self.shape)
        return 0.5 * (mean_log - float(self._moments() @ theta))

    def derivatives(self, lam: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Gradient and information per pixel."""
        from scipy.fft import irfftn

        inverse = 1.0 / lam
        covariance = irfftn(inverse, s=self.shape)
        squared = irfftn(inverse * inverse, s=self.shape)
        expected = np.array([covariance[0, 0, 0], *(-2.0 * covariance[d] for d in self.offsets)])
        return 0.5 * (expected - self._moments()), self.information(squared, self.offsets)

    def information(self, squared: FloatArray, offsets: Sequence[Offset]) -> FloatArray:
        """Information ``1/2 mean(c_j c_k / lambda²)``, c = 1 and -2 cos.

        It follows from the transform of 1/lambda² at sums and differences of offsets.
        """
        every = np.array([(0, 0, 0), *offsets])
        scale = np.where(np.arange(len(every)) == 0, 1.0, -2.0)
        both = _read(squared, every[:, None] + every) + _read(squared, every[:, None] - every)
        return np.asarray(0.25 * np.outer(scale, scale) * both)

    def row(self, squared: FloatArray, offsets: Sequence[Offset], joining: Offset) -> FloatArray:
        """Row of ``information`` for an added pair, its own entry last."""
        every = np.array([(0, 0, 0), *offsets, joining])
        scale = np.where(np.arange(len(every)) == 0, 1.0, -2.0)
        return np.asarray(-0.5 * scale * (_read(squared, every + np.array(joining)) + _read(squared, every - np.array(joining))))


def _read(values: FloatArray, offsets: NDArray[np.int64]) -> FloatArray:
    """Values on a torus at offsets (..., 3)."""
    t, y, x = np.moveaxis(offsets % np.array(values.shape), -1, 0)
    return np.asarray(values[t, y, x])


class NoOptimumError(DataError):
    """Error for covariances that no Gauss-Markov field of the neighbourhood has."""


def _maximise(likelihood: _Likelihood, start: FloatArray | None, tolerance: float = 1e-16) -> tuple[FloatArray, float, int]:
    """Precisions at the optimum, log likelihood per pixel, and steps, by Newton's method with halved steps inside the region."""
    theta = np.zeros(len(likelihood.offsets) + 1)
    theta[0] = 1.0 / likelihood.data.at((0, 0, 0))
    if start is not None:
        theta = start.copy()
    lam = likelihood.spectrum(theta)
    value = likelihood.value(theta, lam)
    for step in range(1, STEPS + 1):
        gradient, information = likelihood.derivatives(lam)
        direction = np.linalg.solve(information, gradient)
        decrement = float(gradient @ direction)
        if decrement < tolerance * max(1.0, abs(value)):
            return theta, value, step
        # Halve the step until it stays inside the region of positive spectra and gains its share of the expected gain.
        length = 1.0
        while True:
            tried = theta + length * direction
            at = likelihood.spectrum(tried)
            gained = likelihood.value(tried, at)
            if gained >= value + 1e-4 * length * decrement:
                break
            length *= 0.5
            if length < 1e-9:
                return theta, value, step  # rounding: no step is uphill any more
        theta, lam, value = tried, at, gained
        if lam.min() < 1e-9 * lam.max():
            break
    raise NoOptimumError(
        "no Gauss-Markov field of this neighbourhood has the covariances of the data (a trend, a pattern of lines, or too few pixels); "
        "choose a region without a trend or a smaller neighbourhood"
    )


def fit(
    data: ArrayLike | Covariances,
    offsets: Sequence[Sequence[int]],
    *,
    periodic: bool = False,
    start: Sequence[float] | None = None,
    largest: tuple[Offset, Offset] | None = None,
) -> GaussMarkovFit:
    """Fit a field of a given neighbourhood.

    Parameters
    ----------
    data : array_like, shape (rows, columns) or (frames, rows, columns), or Covariances
        [u].
    offsets : sequence of (int, int, int) or (int, int)
        Neighbours (frames, rows, columns) or (rows, columns), one of each pair.
    periodic : bool
        Whether the field is a torus; the likelihood is then exact. Of ``Covariances`` it is theirs.
    start : sequence of float, optional
        Coefficients to begin at, which the optimum does not depend on; 0 by default.
    largest : ((int, int, int), (int, int, int)), optional
        Largest torus that represents an infinite plane, without and with time; ``LARGEST_TORUS`` by default.

    Returns
    -------
    GaussMarkovFit
        The field with standard errors and its log likelihood.

    Raises
    ------
    DataError
        Values missing, too few pixels, covariances that no such field has.

    Examples
    --------
    >>> field = np.random.default_rng(1).normal(size=(64, 64))
    >>> result = fit(field, [(0, 1), (1, 0)], periodic=True)
    >>> bool(max(map(abs, result.model.coefficients)) < 3 * max(result.standard_errors))
    True
    """
    requested = tuple(canonical(d) for d in offsets)
    reach = np.abs(np.array([*requested, (0, 0, 0)])).max(axis=0)
    known = data if isinstance(data, Covariances) else covariances(data, [int(r) for r in reach], periodic=periodic)
    _require_pixels(known, len(requested))
    likelihood = _Likelihood(known, requested, largest or LARGEST_TORUS)
    theta = None if start is None else np.array([1.0, *start]) / known.at((0, 0, 0))
    if theta is not None and not np.isfinite(likelihood.value(theta, likelihood.spectrum(theta))):
        raise DomainError("start: 1 - 2 sum b cos(w d) is not above 0 for every wave; give weights that sum to less than 1/2")
    return _result(likelihood, *_maximise(likelihood, theta))


def _require_pixels(data: Covariances, count: int) -> None:
    if not data.at((0, 0, 0)) > 0.0:
        raise DataError("all values are equal: there is no texture to fit; choose another region")
    least = PER_PARAMETER * (count + 2)
    if data.pixels < least:
        raise DataError(
            f"{data.pixels} pixels are too few for {count} neighbour pairs: at least {least} are needed; "
            "choose a larger region or a smaller neighbourhood"
        )


def _result(likelihood: _Likelihood, theta: FloatArray, value: float, steps: int, notes: tuple[str, ...] = ()) -> GaussMarkovFit:
    data = likelihood.data
    _, information = likelihood.derivatives(likelihood.spectrum(theta))
    precision_covariance = np.linalg.inv(information) / data.pixels
    b = theta[1:] / theta[0]
    # b = theta_k / theta_0 and v = 1 / theta_0, by their derivatives.
    jacobian = np.concatenate([-b[:, None], np.eye(b.size)], axis=1) / theta[0]
    errors = np.sqrt(np.einsum("ij,jk,ik->i", jacobian, precision_covariance, jacobian))
    model = GaussMarkov(likelihood.offsets, tuple(map(float, b)), float(1.0 / theta[0]), data.mean)
    if not data.periodic:
        least = least_symbol(model, likelihood.shape)
        if least < LEAST:
            # A wave between the frequencies of the data's grid would have no finite variance.
            model = replace(model, coefficients=tuple(float(v) * (1.0 - LEAST) / (1.0 - least) for v in b))
            notes = (
                *notes,
                f"weights were scaled down by {100 * (LEAST - least) / (1.0 - least):.2g} % so that the model can be sampled at any size",
            )
    total = data.pixels * (value - 0.5 * math.log(2.0 * math.pi))
    return GaussMarkovFit(
        model, tuple(map(float, errors)), float(np.sqrt(precision_covariance[0, 0]) / theta[0] ** 2), total, data.pixels, steps, notes
    )


def candidates(reach: Sequence[int]) -> tuple[Offset, ...]:
    """All neighbours up to ``reach`` (frames, rows, columns) away, one of each pair.

    Examples
    --------
    >>> candidates((0, 1, 1))
    ((0, 0, 1), (0, 1, -1), (0, 1, 0), (0, 1, 1))
    """
    t, y, x = reach
    return tuple(d for d in ((i, j, k) for i in range(t + 1) for j in range(-y, y + 1) for k in range(-x, x + 1)) if d > (0, 0, 0))


def choose(data: Covariances, among: Sequence[Offset], most: int = 16) -> GaussMarkovFit:
    """Choose the neighbourhood by Schwarz's criterion, adding one pair after the other, and fit it.

    At each step the pair joins whose score test promises the largest gain; it stays if the criterion falls, and otherwise the search
    ends. At the end pairs that are no longer worth their parameter are removed.

    Parameters
    ----------
    data : Covariances
        With all distances of ``among``.
    among : sequence of (int, int, int)
        Pairs to choose from.
    most : int
        Largest number of pairs.

    Returns
    -------
    GaussMarkovFit
        The fit of the neighbourhood that is chosen.

    Raises
    ------
    DataError
        Too few pixels, or covariances that no field has, also damped.
    """
    _require_pixels(data, 1)
    pool = [canonical(d) for d in among]
    # Mean and variance are parameters too.
    most = min(most, data.pixels // PER_PARAMETER - 2)
    try:
        return _forward(data, pool, most)
    except NoOptimumError:
        selected = _forward(data.damped(), pool, most)
        return replace(selected, notes=(*selected.notes, "covariances at large distances were damped: as they are, no field has them"))


def _forward(data: Covariances, pool: list[Offset], most: int) -> GaussMarkovFit:
    chosen: list[Offset] = []
    # One torus for all neighbourhoods, so that their likelihoods can be compared.
    likelihood = _Likelihood(data, pool, SEARCHED)
    likelihood.offsets = ()
    theta, value, _ = _maximise(likelihood, None)
    # Half of the price of a parameter in Schwarz's criterion (BIC), per pixel, as the likelihood is.
    penalty = 0.5 * math.log(data.pixels) / data.pixels
    while len(chosen) < most and len(chosen) < len(pool):
        best = _most_promising(likelihood, theta, [d for d in pool if d not in chosen])
        likelihood.offsets = (*chosen, best)
        try:
            tried, gained, _ = _maximise(likelihood, np.append(theta, 0.0), SEARCH)
        except NoOptimumError:
            if len(chosen) >= 2:
                likelihood.offsets = tuple(chosen)
                break  # the present neighbourhood is used; the next pair has no optimum
            raise
        if gained - value < penalty:
            likelihood.offsets = tuple(chosen)
            break
        chosen.append(best)
        theta, value = tried, gained
    for d in list(chosen):
        rest = [other for other in chosen if other != d]
        likelihood.offsets = tuple(rest)
        lean, left, _ = _maximise(likelihood, np.delete(theta, 1 + chosen.index(d)), SEARCH)
        if value - left < penalty:
            chosen, theta, value = rest, lean, left
    likelihood.offsets = tuple(chosen)
    if not data.periodic:
        # Weights that a coarse grid allows may not belong to a field: begin a little inside.
        least = min(least_symbol(GaussMarkov(tuple(chosen), tuple(theta[1:] / theta[0]), 1.0), likelihood.shape), 0.0)
        theta[1:] *= (1.0 - LEAST) / (1.0 - least)
    fine = _Likelihood(data, pool)
    fine.offsets = tuple(chosen)
    return _result(fine, *_maximise(fine, theta))


def _most_promising(likelihood: _Likelihood, theta: FloatArray, pool: list[Offset]) -> Offset:
    """Pair with the largest score statistic, ``gradient² / information`` given the pairs already included."""
    from scipy.fft import irfftn

    lam = likelihood.spectrum(theta)
    covariance, squared = (irfftn(lam**power, s=likelihood.shape) for power in (-1.0, -2.0))
    count = len(likelihood.offsets) + 1
    own = likelihood.information(squared, likelihood.offsets)
    gains = []
    for d in pool:
        gradient = -(float(covariance[d]) - likelihood.data.at(d))
        row = likelihood.row(squared, likelihood.offsets, d)
        gains.append(gradient**2 / max(row[count] - row[:count] @ np.linalg.solve(own, row[:count]), 1e-12 * row[count]))
    return pool[int(np.argmax(gains))]
