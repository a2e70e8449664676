"""Convergence of Gibbs chains of a field: energy traces, effective sample size and R-hat (arviz-stats)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.optional import optional
from seaglint.textures import autobinomial_sampler as sampler
from seaglint.textures.autobinomial import Autobinomial

LARGEST_RHAT: Final = 1.01  #: R-hat below which chains count as mixed (Vehtari et al. 2021).


@dataclass(frozen=True)
class Mixing:
    """Traces of several chains, and their convergence diagnostics."""

    energy: FloatArray  #: Minus the exponent of the joint density, per pixel and without the count of choices [nat].
    sums: FloatArray  #: Mean level, and mean product with each class of neighbours, per pair [level, level²].
    rhat: FloatArray  #: Rank-normalised split R-hat of the energy and of each sum [1].
    effective: FloatArray  #: Effective sample sizes (bulk) of the same, all chains [1].

    @property
    def mixed(self) -> bool:
        """True if every R-hat is below :data:`LARGEST_RHAT`."""
        return bool((self.rhat < LARGEST_RHAT).all())


def mixing(model: Autobinomial, shape: tuple[int, int], seed: int, *, chains: int = 4, warm: int = 200, draws: int = 400) -> Mixing:
    """Run chains from distant starts (levels even over the range from low to high) and evaluate their convergence.

    Parameters
    ----------
    model : Autobinomial
        The field.
    shape : (int, int)
        Rows and columns, on a torus.
    seed : int
        Seed of the chains; each has its own stream.
    chains, warm, draws : int
        Chains, sweeps left out of each, and sweeps of which each is a draw.

    References
    ----------
    A. Vehtari et al., "Rank-normalization, folding, and localization: an improved R-hat", Bayesian Analysis 16 (2021), 667-718.
    """
    judge = optional("arviz_stats.base.array", "the judgement of chains").array_stats

    if chains < 2 or draws < 8:
        raise DomainError(f"chains = {chains}, draws = {draws}: R-hat compares 2 chains or more of 8 draws or more")
    law, lattice = sampler.law(model), sampler.plan(model, shape)
    traces = np.empty((chains, draws, 1 + len(model.beta)))
    for chain in range(chains):
        field = np.full(shape, round(model.most * chain / (chains - 1)), dtype=np.int16)
        key = sampler.words(seed, f"autobinomial-chain-{chain}")
        sampler.sweep(field, law, lattice, key, 0, warm)
        for draw in range(draws):
            sampler.sweep(field, law, lattice, key, warm + draw, 1)
            traces[chain, draw] = sampler.sums(field, law, lattice)
    energy = -(traces @ model.parameters) / (shape[0] * shape[1])
    pairs = np.array([1, *map(len, model.neighbours)]) * (shape[0] * shape[1])
    watched = np.concatenate([energy[..., None], traces], axis=-1)
    columns = [np.ascontiguousarray(watched[..., k]) for k in range(watched.shape[-1])]
    rhat = np.array([judge.rhat(column, chain_axis=0, draw_axis=1) for column in columns], dtype=np.float64)
    effective = np.array([judge.ess(column, chain_axis=0, draw_axis=1) for column in columns], dtype=np.float64)
    return Mixing(energy, traces / pairs, rhat, effective)
