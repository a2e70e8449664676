"""Comparison of samples of a fitted field with its picture: usable, frozen or molten, with the remedy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.textures import autobinomial_sampler as sampler
from seaglint.textures.autobinomial import Autobinomial, Classes, pairs_inside

Name = Literal["usable", "frozen", "molten"]

CHECK_SWEEPS: Final = 300  #: Number of sweeps after which samples from opposite starts are compared.

CHECK_SIDE: Final = 128  #: Largest number of rows and columns of the samples.

APART: Final = 0.05  #: Difference of two samples' means, over the largest level, beyond which they depend on their starts.

DRIFT: Final = 0.15  #: Difference of samples' and picture's means, over the largest level, that counts as a transition to a phase.

EVEN: Final = 0.7  #: Ratio of standard deviations and of correlations below which, or above whose inverse, they do not match.

#: Standard deviation of samples, over that of pixels without neighbours, beyond which they form domains or stripes of two phases.
ORDERED: Final = 2.0

REMEDY: Final = (
    "fit with method 'monte-carlo-exchange' and keep the picture's histogram with the exchange sampler, or take fewer levels, "
    "a lower order, or the Gauss-Markov field"
)


@dataclass(frozen=True)
class Regime:
    """Properties of samples at the fitted parameters."""

    #: Frozen: samples end in a phase, near a constant or determined by their start. Molten: samples lose the picture's contrast or
    #: correlation, towards white noise.
    name: Name
    #: Slope of the mean field at the picture's mean, largest over all waves [1]: from 1 on its waves grow until levels run out.
    susceptibility: float
    phases: int  #: Stable uniform solutions of the mean field.
    memory: float  #: Difference of the means of samples begun at the lowest and at the highest level, over the largest level [1].
    sample_mean: float  #: Mean over the samples' pixels [level].
    data_mean: float  #: Mean over the picture's pixels [level].
    sample_std: float  #: Standard deviation over the samples' pixels [level].
    data_std: float  #: Standard deviation over the picture's pixels [level].
    sample_correlation: tuple[float, ...]  #: Correlation of the samples' pixels with each class of neighbours [1].
    data_correlation: tuple[float, ...]  #: Correlation of the picture's pixels with each class of neighbours [1].

    @property
    def text(self) -> str:
        """Finding and remedy, in a sentence."""
        return self.finding if self.name == "usable" else f"{self.finding}; {REMEDY}"

    @property
    def finding(self) -> str:
        """Finding, in a sentence."""
        spread = f"standard deviation {self.sample_std:.3g} levels in samples, {self.data_std:.3g} in the picture"
        tie = f"correlation with the nearest neighbours {self.sample_correlation[0]:.2f} and {self.data_correlation[0]:.2f}"
        if self.name == "usable":
            return f"samples keep the picture's contrast and correlation ({spread}; {tie})"
        if self.name == "frozen":
            fall = "wherever they begin"
            if self.memory > APART:
                fall = f"begun at the lowest and the highest level they stay {100.0 * self.memory:.0f} % of the range apart"
            means = f"mean {self.sample_mean:.3g} levels in samples, {self.data_mean:.3g} in the picture"
            return f"frozen: beyond the phase transition Gibbs sweeps end near a constant ({fall}; {means}; {spread})"
        return f"molten: Gibbs sweeps lose the texture ({spread}; {tie})"


def regime(field: NDArray[np.int16], model: Autobinomial, seed: int, sweeps: int = CHECK_SWEEPS) -> Regime:
    """Sample the field from the lowest level, the highest level and the picture, and compare the samples with the picture.

    Parameters
    ----------
    field : array of int16, (rows, columns)
        The picture.
    model : Autobinomial
        The fit.
    seed : int
        Seed of the samples.
    sweeps : int
        Gibbs sweeps of each sample.
    """
    rows, columns = (min(size, max(CHECK_SIDE, 4 * far + 1)) for size, far in zip(field.shape, model.reach, strict=True))
    starts = [np.full((rows, columns), level, dtype=np.int16) for level in (0, model.most)]
    # Samples begun at opposite levels differ at the end if the field has several phases.
    low, high = (sampler.sample(model, (rows, columns), sweeps, seed + i, start=start) for i, start in enumerate(starts))
    # The third sample begins with the picture: it shows whether sweeps keep the texture.
    own = sampler.sample(model, (rows, columns), sweeps, seed + 2, start=field[:rows, :columns])
    memory = abs(float(high.mean()) - float(low.mean())) / model.most
    data = correlations(field, model.neighbours)
    own_correlations = correlations(own, model.neighbours)
    shift = abs(float(own.mean()) - float(field.mean())) / model.most
    spread = float(own.std()) / float(field.std())
    name: Name = "usable"
    share = float(own.mean()) / model.most
    alone = float(np.sqrt(model.most * share * (1.0 - share)))  # of pixels without neighbours
    if memory > APART or shift > DRIFT or (spread > 1.0 / EVEN and float(own.std()) > ORDERED * alone):
        name = "frozen"
    elif not EVEN <= spread <= 1.0 / EVEN or (abs(data[0]) > 0.1 and not EVEN <= own_correlations[0] / data[0] <= 1.0 / EVEN):
        name = "molten"
    slope, phases = mean_field(model, float(field.mean()) / model.most)
    return Regime(
        name=name,
        susceptibility=slope,
        phases=phases,
        memory=memory,
        sample_mean=float(own.mean()),
        data_mean=float(field.mean()),
        sample_std=float(own.std()),
        data_std=float(field.std()),
        sample_correlation=tuple(map(float, own_correlations)),
        data_correlation=tuple(map(float, data)),
    )


def correlations(field: NDArray[np.int16], neighbours: Classes) -> FloatArray:
    """Return the correlation of pixels with each class of their neighbours, inside the picture [1]; 0 for a constant one."""
    centred = field - field.mean()
    variance = float((centred * centred).mean())
    result = np.zeros(len(neighbours))
    if variance == 0.0:
        return result
    for k, one in enumerate(neighbours):
        for offset in one:
            first, second = pairs_inside(centred, offset)
            result[k] += float((first * second).mean()) / variance / len(one)
    return result


def mean_field(model: Autobinomial, share: float | None = None, waves: int = 64) -> tuple[float, int]:
    """Slope of the mean field and number of its stable uniform solutions.

    Where every neighbour has the mean share m, ``m = logistic(alpha + B m)``. A small wave of wave number k on it returns from its
    neighbours multiplied by ``N m (1 - m) sum_pairs 2 beta cos(k d)``: from 1 on it grows. Exact in the limit of many levels (each pixel is
    then ``levels - 1`` spins with as many ties to each neighbour); with two levels order sets in later, at 1.76 for four neighbours.

    Parameters
    ----------
    model : Autobinomial
        The field.
    share : float, optional
        Mean over the largest level at which the slope is taken [1]; the stable solution nearest 1/2 by default.
    waves : int
        Steps of wave number from 0 to the highest.

    Returns
    -------
    slope : float
        Largest over all waves [1].
    phases : int
        Stable uniform solutions.
    """
    pull = 2.0 * model.most * sum(beta * len(one) for one, beta in zip(model.neighbours, model.beta, strict=True))
    m = np.linspace(0.0, 1.0, 20001)[1:-1]
    gap = 1.0 / (1.0 + np.exp(np.clip(-(model.alpha + pull * m), -700.0, 700.0))) - m
    # A solution is stable where the gap changes from positive to negative.
    falling = np.flatnonzero((gap[:-1] > 0.0) & (gap[1:] <= 0.0))
    if share is None:
        solutions = m[falling] if falling.size else m[[int(np.argmin(np.abs(gap)))]]
        share = float(solutions[int(np.argmin(np.abs(solutions - 0.5)))])
    k = np.linspace(0.0, np.pi, waves + 1)
    down, across = np.meshgrid(k, np.concatenate([-k[:0:-1], k]), indexing="ij")
    total = np.zeros_like(down)
    for one, beta in zip(model.neighbours, model.beta, strict=True):
        for dy, dx in one:
            total += 2.0 * beta * np.cos(dy * down + dx * across)
    return float(model.most * share * (1.0 - share) * total.max()), int(max(falling.size, 1))
