"""Maximum likelihood of autobinomial fields by Monte Carlo: parameters whose samples have the picture's sums over pixels and pairs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.textures import autobinomial_kernels as kernels
from seaglint.textures import autobinomial_sampler as sampler
from seaglint.textures.autobinomial import Autobinomial
from seaglint.textures.neighbourhood import Classes

ROUNDS: Final = 60  #: Largest number of Newton's steps with sampled moments.

SWEEPS: Final = 150  #: Number of sweeps of a step; the first third of them is discarded.

CLOSE: Final = 4.0  #: Distance between picture and samples, in standard deviations of the sums, below which steps use more sweeps.

CLOSE_SWEEPS: Final = 600

LAST_SWEEPS: Final = 1500  #: Number of sweeps for the likelihood around the last step.

LONGEST_STEP: Final = 10.0  #: Longest step, in standard deviations of the sums; sampled moments are not valid beyond.

#: Largest change of the mean field's slope at half the largest level in a step: near the transition moments change within some 0.1.
LARGEST_TURN: Final = 0.05

NEAR: Final = 0.5  #: Distance between picture and samples, in standard deviations of the sums, below which the last sweeps are drawn.

BATCHES: Final = 30  #: Number of parts of the last sweeps whose means give the error of the simulation.

FEWEST_WEIGHTS: Final = 0.1  #: Least effective share of the last sweeps after weighting; below, importance sampling is not reliable.


@dataclass(frozen=True)
class Ascent:
    """Result of the maximisation."""

    model: Autobinomial  #: The field at the maximum.
    covariance: FloatArray  #: Covariance of the parameters: inverse Fisher information and the error of the simulation.
    rounds: int  #: Newton's steps taken.
    distance: float  #: Left between the picture's sums and those of samples, in standard deviations of a sample's.
    converged: bool  #: Whether picture and samples agree and the last weights are even enough.


@dataclass
class _Chain:
    """Chain of samples whose model changes on the way, and its sums."""

    state: NDArray[np.int16]
    lattice: kernels.ColourPlan
    key: NDArray[np.int64]
    keep_histogram: bool
    done: int = 0

    def draws(self, model: Autobinomial, sweeps: int) -> FloatArray:
        """Sums after each of several further sweeps; without the sum of levels where the histogram is fixed."""
        held = sampler.law(model)
        sums = np.empty((sweeps, 1 + len(model.beta)))
        for i in range(sweeps):
            if self.keep_histogram:
                kernels.exchange(self.state, held, self.lattice, self.key, self.done, 1)
            else:
                sampler.sweep(self.state, held, self.lattice, self.key, self.done, 1)
            sums[i] = sampler.sums(self.state, held, self.lattice)
            self.done += 1
        return sums[:, int(self.keep_histogram) :]


def maximum_likelihood(field: NDArray[np.int16], first: Autobinomial, seed: int, *, periodic: bool, keep_histogram: bool = False) -> Ascent:
    """Maximise the likelihood from ``first``: Newton's steps with moments from sampled pictures, then importance sampling.

    Parameters
    ----------
    field : array of int16, (rows, columns)
        Grey levels.
    first : Autobinomial
        Where to begin: the pseudo-likelihood's maximum.
    seed : int
        Seed of the simulation.
    periodic : bool
        Whether opposite edges are neighbours; else the likelihood is that of the inner pixels given those at the edge.
    keep_histogram : bool
        Take the likelihood of the picture given its histogram, and exchanges for sweeps: couplings whose exchange samples have the
        picture's mean products of neighbours. alpha stays. Without periods the products are those inside the picture, of as many pairs as a
        torus has.

    References
    ----------
    C. J. Geyer and E. A. Thompson, "Constrained Monte Carlo maximum likelihood for dependent data", J. R. Stat. Soc. B 54 (1992), 657-699.
    """
    lattice = sampler.plan(first, field.shape, held_border=not (periodic or keep_histogram))
    purpose = "autobinomial-exchange-likelihood" if keep_histogram else "autobinomial-likelihood"
    chain = _Chain(field.copy(), lattice, sampler.words(seed, purpose), keep_histogram)
    observed = sampler.sums(field, sampler.law(first), lattice)[int(keep_histogram) :]
    if keep_histogram and not periodic:
        observed = field.size * inside_products(field, first.neighbours)
    model, fixed = first, first.parameters[: int(keep_histogram)]
    rounds, distance = 0, np.inf
    pairs = np.array([len(one) for one in first.neighbours])

    def moved(by: FloatArray) -> Autobinomial:
        return model.with_parameters(np.concatenate([fixed, model.parameters[int(keep_histogram) :] + by]))

    while rounds < ROUNDS:
        rounds += 1
        sweeps = SWEEPS if distance > CLOSE else CLOSE_SWEEPS
        sampled = chain.draws(model, sweeps)[sweeps // 3 :]
        step, distance = newton(observed - sampled.mean(axis=0), np.atleast_2d(np.cov(sampled.T)))
        if distance < NEAR or not np.isfinite(distance):
            break
        turn = 0.5 * model.most * float(np.abs(step[-len(pairs) :]) @ pairs)
        model = moved(step * min(1.0, LONGEST_STEP / distance, LARGEST_TURN / turn))
    size = 1 + len(first.beta)
    covariance = np.full((size, size), np.nan)
    if not distance < NEAR:
        return Ascent(model, covariance, rounds, float(distance), False)
    shift, inner, distance, even = _last(chain.draws(model, LAST_SWEEPS) - observed)
    covariance[int(keep_histogram) :, int(keep_histogram) :] = inner
    return Ascent(moved(shift), covariance, rounds, distance, bool(distance < 1e-3 and even > FEWEST_WEIGHTS))


def inside_products(field: NDArray[np.int16], neighbours: Classes) -> FloatArray:
    """Mean product of a pair of each class inside the picture, times the number of pairs of a pixel of a torus [level²].

    The mean is the whole picture's: pixels at the edge, which are in fewer pairs, may have another.
    """
    mean = float(field.mean())
    held = field - mean
    rows, columns = held.shape
    products = np.zeros(len(neighbours))
    for k, one in enumerate(neighbours):
        for dy, dx in one:
            left, right = max(-dx, 0), max(dx, 0)
            products[k] += float((held[: rows - dy, left : columns - right] * held[dy:, right : columns - left]).mean()) + mean * mean
    return products


def newton(gap: FloatArray, covariance: FloatArray) -> tuple[FloatArray, float]:
    """Step that closes a gap between sums, and the gap in standard deviations of a sample's sums."""
    scale = np.sqrt(np.diag(covariance))
    if not (scale > 0.0).all():
        return np.zeros_like(gap), np.inf
    even = covariance / np.outer(scale, scale)
    values, vectors = np.linalg.eigh(even)
    if values[0] < 1e-10 * values[-1]:
        return np.zeros_like(gap), np.inf
    along = vectors.T @ (gap / scale)
    return (vectors @ (along / values)) / scale, float(np.sqrt((along**2 / values).sum()))


def _last(differences: FloatArray) -> tuple[FloatArray, FloatArray, float, float]:
    """Maximum of the likelihood relative to that of the sampled model, by importance weights of the samples' sums for a shift.

    Takes sums less those of the picture; returns the shift, its covariance (with the error of the simulation), the gap that is left and
    the share of the samples that count.
    """
    shift = np.zeros(differences.shape[1])
    weights, distance = np.full(differences.shape[0], 1.0 / differences.shape[0]), np.inf
    for _ in range(20):
        step, distance = newton(-(weights @ differences), np.atleast_2d(np.cov(differences.T, aweights=weights)))
        if not np.isfinite(distance) or distance < 1e-6:
            break
        shift = shift + step
        logs = differences @ shift
        weights = np.exp(logs - logs.max())
        weights /= weights.sum()
    share = 1.0 / (differences.shape[0] * float((weights**2).sum()))
    inverse = np.linalg.pinv(np.atleast_2d(np.cov(differences.T, aweights=weights)), rcond=1e-14, hermitian=True)
    batches = np.array([part.mean(axis=0) for part in np.array_split(differences, BATCHES)])
    simulation = inverse @ np.atleast_2d(np.cov(batches.T) / BATCHES) @ inverse
    return shift, np.asarray(inverse + simulation), float(distance), share
