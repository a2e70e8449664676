"""Maximum likelihood of autobinomial fields by Monte Carlo: parameters whose samples have the picture's sums over pixels and pairs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.conventions import FloatArray
from seaglint.texture import autobinomial_sampler as sampler
from seaglint.texture.autobinomial import Autobinomial

ROUNDS: Final = 40
"""Newton's steps with sampled moments before the climb is given up."""

SWEEPS: Final = 150
"""Sweeps of a step; the first third of them is left out."""

LAST_SWEEPS: Final = 1500
"""Sweeps from which the likelihood around the last step is computed."""

LONGEST_STEP: Final = 4.0
"""Longest step, in standard deviations of the sums: sampled moments tell little beyond."""

NEAR: Final = 0.5
"""Distance between picture and samples, in standard deviations of the sums, from which the last sweeps are drawn."""

FEWEST_WEIGHTS: Final = 0.1
"""Share of the last sweeps that must count after weighting: below, the importance sampling is not to be trusted."""


@dataclass(frozen=True)
class Ascent:
    """Where the climb ended.

    Attributes
    ----------
    model : Autobinomial
        The field at the maximum.
    covariance : array, (1 + classes, 1 + classes)
        Of the parameters: inverse Fisher information and the error of the simulation.
    rounds : int
        Newton's steps taken.
    distance : float
        Left between the picture's sums and those of samples, in standard deviations of a sample's.
    converged : bool
        Whether picture and samples agree and the last weights are even enough.
    """

    model: Autobinomial
    covariance: FloatArray
    rounds: int
    distance: float
    converged: bool


def maximum_likelihood(field: NDArray[np.int16], first: Autobinomial, seed: int, *, periodic: bool) -> Ascent:
    """Climb the likelihood from ``first``: Newton's steps with moments from Gibbs sweeps, then importance sampling.

    Parameters
    ----------
    field : array of int16, (rows, columns)
        Grey levels.
    first : Autobinomial
        Where to begin: the pseudo-likelihood's maximum.
    seed : int
        Of the simulation.
    periodic : bool
        Whether opposite edges are neighbours; else the likelihood is that of the inner pixels given those at the edge.

    References
    ----------
    C. J. Geyer and E. A. Thompson, "Constrained Monte Carlo maximum likelihood for dependent data", J. R. Stat. Soc. B 54 (1992), 657-699.
    """
    lattice = sampler.plan(first, field.shape, held_border=not periodic)
    key = sampler.word(seed, "autobinomial-likelihood")
    wanted = sampler.sums(field, sampler.law(first), lattice)
    state, model, done = field.copy(), first, 0
    rounds, distance = 0, np.inf

    def draws(sweeps: int) -> FloatArray:
        nonlocal done
        held = sampler.law(model)
        found = np.empty((sweeps, wanted.size))
        for i in range(sweeps):
            sampler.sweep(state, held, lattice, key, done, 1)
            found[i] = sampler.sums(state, held, lattice)
            done += 1
        return found

    while rounds < ROUNDS:
        rounds += 1
        found = draws(SWEEPS)[SWEEPS // 3 :]
        step, distance = newton(wanted - found.mean(axis=0), np.cov(found.T))
        if distance < NEAR or not np.isfinite(distance):
            break
        model = model.with_parameters(model.parameters + step * min(1.0, LONGEST_STEP / distance))
    if not distance < NEAR:
        return Ascent(model, np.full((wanted.size, wanted.size), np.nan), rounds, float(distance), False)
    found = draws(LAST_SWEEPS)
    return _last(found - wanted, model, rounds)


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


def _last(found: FloatArray, model: Autobinomial, rounds: int) -> Ascent:
    """Maximum of the likelihood relative to ``model``'s: samples weighted by what their sums gain from a shift of the parameters."""
    shift = np.zeros(found.shape[1])
    even = np.ones(found.shape[0]) / found.shape[0]
    weights, distance = even, np.inf
    for _ in range(20):
        logs = found @ shift
        weights = np.exp(logs - logs.max())
        weights /= weights.sum()
        mean = weights @ found
        step, distance = newton(-mean, np.cov(found.T, aweights=weights))
        if not np.isfinite(distance) or distance < 1e-6:
            break
        shift = shift + step
    share = 1.0 / (found.shape[0] * float((weights**2).sum()))
    information = np.cov(found.T, aweights=weights)
    inverse = np.linalg.pinv(information, hermitian=True, rcond=1e-14)
    batches = np.array([part.mean(axis=0) for part in np.array_split(found, 30)])
    simulation = inverse @ (np.cov(batches.T) / len(batches)) @ inverse
    converged = bool(distance < 1e-3 and share > FEWEST_WEIGHTS)
    return Ascent(model.with_parameters(model.parameters + shift), np.asarray(inverse + simulation), rounds, float(distance), converged)
