"""Fit of an autobinomial field to a picture of grey levels, with standard errors and the regime of the fit.

:func:`fit` starts from the maximum of the pseudo-likelihood. :func:`maximum_likelihood` continues by Monte Carlo to the parameters at which
samples have the picture's sums over pixels and pairs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.free_form import JsonObject
from seaglint.base.threads import single_threaded_algebra
from seaglint.textures import autobinomial_sampler as sampler
from seaglint.textures.autobinomial import Autobinomial, Classes, IntArray, checked_field, classes, pairs_inside, reach
from seaglint.textures.pseudo_likelihood import Optimum, climb, conditional_log_likelihood, neighbour_sums
from seaglint.textures.regime import Regime, regime

ROUNDS: Final = 60  #: Largest number of Newton's steps with sampled moments.

SWEEPS: Final = 150  #: Number of sweeps of a step; the first third of them is discarded.

CLOSE: Final = 4.0  #: Distance between picture and samples, in standard deviations of the sums, below which steps use more sweeps.

CLOSE_SWEEPS: Final = 600  #: Number of sweeps of a step near the maximum.

LAST_SWEEPS: Final = 1500  #: Number of sweeps for the likelihood around the last step.

LONGEST_STEP: Final = 10.0  #: Longest step, in standard deviations of the sums; sampled moments are not valid beyond.

#: Largest change of the mean field's slope at half the largest level in a step: near the transition moments change within some 0.1.
LARGEST_TURN: Final = 0.05

NEAR: Final = 0.5  #: Distance between picture and samples, in standard deviations of the sums, below which the last sweeps are drawn.

BATCHES: Final = 30  #: Number of parts of the last sweeps whose means give the error of the simulation.

FEWEST_WEIGHTS: Final = 0.1  #: Least effective share of the last sweeps after weighting; below, importance sampling is not reliable.


@dataclass
class _Chain:
    """Chain of samples with a model that changes from step to step, and its sums."""

    state: NDArray[np.int16]
    lattice: sampler.ColourPlan
    key: NDArray[np.int64]
    keep_histogram: bool
    done: int = 0

    def draws(self, model: Autobinomial, sweeps: int) -> FloatArray:
        """Return sums after each of several further sweeps; without the sum of levels where the histogram is fixed."""
        law = sampler.sampling_law(model)
        sums = np.empty((sweeps, 1 + len(model.beta)))
        for i in range(sweeps):
            if self.keep_histogram:
                sampler.exchange_kernel(self.state, law, self.lattice, self.key, self.done, 1)
            else:
                sampler.sweep(self.state, law, self.lattice, self.key, self.done, 1)
            sums[i] = sampler.sums_of(self.state, law, self.lattice)
            self.done += 1
        return sums[:, int(self.keep_histogram) :]


def maximum_likelihood(
    field: NDArray[np.int16], first: Autobinomial, seed: int, *, periodic: bool, keep_histogram: bool = False
) -> Optimum:
    """Maximise the likelihood from ``first``: Newton's steps with moments from sampled pictures, then importance sampling.

    Parameters
    ----------
    field : array of int16, (rows, columns)
        Grey levels.
    first : Autobinomial
        First parameters: the pseudo-likelihood's maximum.
    seed : int
        Seed of the simulation.
    periodic : bool
        Whether opposite edges are neighbours; else the likelihood is of the inner pixels given the pixels at the edge.
    keep_histogram : bool
        Take the likelihood of the picture given its histogram, and exchanges for sweeps: couplings at which exchange samples have the
        picture's mean products of neighbours. alpha is unchanged. Without periods the products inside the picture are scaled to the number
        of pairs of a torus.

    Returns
    -------
    Optimum
        Parameters at the maximum with their covariance.

    References
    ----------
    C. J. Geyer and E. A. Thompson, "Constrained Monte Carlo maximum likelihood for dependent data", J. R. Stat. Soc. B 54 (1992), 657-699.
    """
    # Without periods the pixels of the border are held: they serve as neighbours only.
    lattice = sampler.plan(first, field.shape, held_border=not (periodic or keep_histogram))
    purpose = "autobinomial-exchange-likelihood" if keep_histogram else "autobinomial-likelihood"
    chain = _Chain(field.copy(), lattice, sampler.words(seed, purpose), keep_histogram)
    observed = sampler.sums_of(field, sampler.sampling_law(first), lattice)[int(keep_histogram) :]
    if keep_histogram and not periodic:
        observed = field.size * inside_products(field, first.neighbours)
    model, fixed = first, first.parameters[: int(keep_histogram)]
    rounds, distance = 0, np.inf
    # The slope of the mean field changes by the couplings times these numbers of pairs.
    pairs = np.array([len(one) for one in first.neighbours])

    def moved(by: FloatArray) -> Autobinomial:
        return model.with_parameters(np.concatenate([fixed, model.parameters[int(keep_histogram) :] + by]))

    while rounds < ROUNDS:
        rounds += 1
        # Near the maximum the noise of the sampled sums would exceed the gap: more sweeps.
        sweeps = SWEEPS if distance > CLOSE else CLOSE_SWEEPS
        sampled = chain.draws(model, sweeps)[sweeps // 3 :]
        step, distance = newton(observed - sampled.mean(axis=0), np.atleast_2d(np.cov(sampled.T)))
        if distance < NEAR or not np.isfinite(distance):
            break
        # Steps are limited twice: by the range of validity of the sampled moments, and by the change of the mean field's slope.
        turn = 0.5 * model.most * float(np.abs(step[-len(pairs) :]) @ pairs)
        model = moved(step * min(1.0, LONGEST_STEP / distance, LARGEST_TURN / turn))
    size = 1 + len(first.beta)
    # Where the histogram is kept, alpha is no parameter: its row and column stay NaN.
    covariance = np.full((size, size), np.nan)
    if not distance < NEAR:
        return Optimum(model, covariance, rounds, False, float(distance))
    shift, inner, distance, even = _last(chain.draws(model, LAST_SWEEPS) - observed)
    covariance[int(keep_histogram) :, int(keep_histogram) :] = inner
    return Optimum(moved(shift), covariance, rounds, bool(distance < 1e-3 and even > FEWEST_WEIGHTS), distance)


def inside_products(field: NDArray[np.int16], neighbours: Classes) -> FloatArray:
    """Return the mean product of a pair of each class inside the picture, times the number of pairs of a pixel of a torus [level²].

    The mean is the whole picture's: pixels at the edge, which are in fewer pairs, may have another.
    """
    mean = float(field.mean())
    centred = field - mean
    products = np.zeros(len(neighbours))
    for k, one in enumerate(neighbours):
        for offset in one:
            first, second = pairs_inside(centred, offset)
            products[k] += float((first * second).mean()) + mean * mean
    return products


def newton(gap: FloatArray, covariance: FloatArray) -> tuple[FloatArray, float]:
    """Return the step that closes a gap between sums, and the gap in standard deviations of a sample's sums."""
    scale = np.sqrt(np.diag(covariance))
    if not (scale > 0.0).all():
        return np.zeros_like(gap), np.inf
    # The correlation matrix: sums of unit variance make its condition independent of the size of the picture.
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    if values[0] < 1e-10 * values[-1]:
        return np.zeros_like(gap), np.inf
    along = vectors.T @ (gap / scale)
    return (vectors @ (along / values)) / scale, float(np.sqrt((along**2 / values).sum()))


def _last(differences: FloatArray) -> tuple[FloatArray, FloatArray, float, float]:
    """Maximise the likelihood relative to the sampled model's, by importance weights of the samples' sums for a shift.

    ``differences`` are the samples' sums less the picture's. Returns the shift, its covariance (with the error of the simulation), the
    remaining gap and the effective share of the samples.
    """
    shift = np.zeros(differences.shape[1])
    weights, distance = np.full(differences.shape[0], 1.0 / differences.shape[0]), np.inf
    for _ in range(20):
        step, distance = newton(-(weights @ differences), np.atleast_2d(np.cov(differences.T, aweights=weights)))
        if not np.isfinite(distance) or distance < 1e-6:
            break
        shift = shift + step
        logs = differences @ shift
        # The largest exponent is taken off, so that no weight overflows.
        weights = np.exp(logs - logs.max())
        weights /= weights.sum()
    # Effective share of weighted samples: 1 for equal weights.
    share = 1.0 / (differences.shape[0] * float((weights**2).sum()))
    inverse = np.linalg.pinv(np.atleast_2d(np.cov(differences.T, aweights=weights)), rcond=1e-14, hermitian=True)
    batches = np.array([batch.mean(axis=0) for batch in np.array_split(differences, BATCHES)])
    return shift, np.asarray(inverse + inverse @ np.atleast_2d(np.cov(batches.T) / BATCHES) @ inverse), float(distance), share


Method = Literal["pseudo-likelihood", "monte-carlo", "monte-carlo-exchange"]

#: Least number of pixels with all their neighbours for each parameter; with fewer, standard errors are meaningless.
PIXELS_PER_PARAMETER: Final = 30


@dataclass(frozen=True)
class AutobinomialFit:
    """Fitted autobinomial field."""

    model: Autobinomial  #: The field.
    #: Covariance of ``parameters`` [(1 + classes, 1 + classes)]; NaN where the picture is too small to determine it.
    covariance: FloatArray
    log_pseudo_likelihood: float  #: Log pseudo-likelihood of the picture at the fit, mean per pixel [nat].
    pixels: int  #: Number of fitted pixels, each with all its neighbours.
    method: Method  #: Method of the fit.
    converged: bool  #: Whether the maximum was reached.
    steps: int  #: Newton's steps taken.
    regime: Regime | None  #: Regime of samples of the fit; None where it was not requested.
    #: Remaining gap between the picture's sums and the samples', in standard deviations of a sample's; None for a pseudo-likelihood.
    distance: float | None = None

    @property
    def parameters(self) -> FloatArray:
        """Alpha and the couplings, in this order [1]."""
        return self.model.parameters

    @property
    def standard_errors(self) -> FloatArray:
        """Standard error of each parameter [1]."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes for the user of the fit: problems and remedies."""
        messages = []
        if not self.converged:
            left = "" if self.distance is None else f" {self.distance:.3g} standard deviations from"
            messages.append(
                f"the Monte Carlo likelihood was not climbed to its top in {self.steps} steps (sums over pixels and pairs of samples stay"
                f"{left or ' away from'} the picture's): take the pseudo-likelihood's fit, fewer levels or a lower order"
            )
        if np.isnan(self.covariance).any() and self.method == "pseudo-likelihood":
            messages.append("the picture is too small for standard errors of so many neighbours: take a larger one or a lower order")
        if self.regime is not None and self.regime.name != "usable":
            messages.append(self.regime.text)
        return tuple(messages)

    def as_dict(self) -> JsonObject:
        """Return the fit as values for JSON."""
        return {
            "model": self.model.to_dict(),
            "method": self.method,
            "converged": self.converged,
            "steps": self.steps,
            "pixels": self.pixels,
            "log_pseudo_likelihood": self.log_pseudo_likelihood,
            "parameters": self.parameters.tolist(),
            "standard_errors": [None if np.isnan(error) else float(error) for error in self.standard_errors],
            "regime": None if self.regime is None else vars(self.regime) | {"text": self.regime.text},
            "notes": list(self.notes),
        }


@single_threaded_algebra()
def fit(
    image: IntArray,
    levels: int,
    order: int = 1,
    *,
    isotropic: bool = True,
    method: Method = "pseudo-likelihood",
    periodic: bool = False,
    neighbours: Classes | None = None,
    seed: int = 0,
    start: FloatArray | None = None,
    check: bool = True,
) -> AutobinomialFit:
    """Fit the field to a picture.

    The maximum of the log pseudo-likelihood ``sum_s log P[x(s) | neighbours]`` (Besag 1975), or from there of a likelihood.

    Parameters
    ----------
    image : array of int, (rows, columns)
        Grey levels 0 to ``levels - 1`` (``seaglint.textures.autobinomial_texture.GreyLevels`` makes them of radiance).
    levels : int
        Grey levels of the field.
    order : int
        Neighbourhood: distances taken, from the shortest.
    isotropic : bool
        One coupling for each distance; else one for each symmetric pair of neighbours.
    method : {"pseudo-likelihood", "monte-carlo", "monte-carlo-exchange"}
        Maximum pseudo-likelihood; or from there maximum likelihood with sampled moments (seconds), at which Gibbs samples have the
        picture's mean and products of neighbours; or the likelihood given the histogram, at which exchange samples have them. The last one
        does not determine alpha, which is taken from the pseudo-likelihood with a variance of NaN.
    periodic : bool
        Whether opposite edges are neighbours, as in samples on a torus; else pixels at the edge only serve as neighbours.
    neighbours : tuple of tuple of (int, int), optional
        Classes of offsets in place of ``order`` and ``isotropic``.
    seed : int
        Seed of the simulations.
    start : array, (1 + classes,), optional
        First parameters of the pseudo-likelihood; the maximum does not depend on them.
    check : bool
        Whether to sample the fit and name its regime (under a second).

    Returns
    -------
    AutobinomialFit
        Parameters with covariance, log pseudo-likelihood and regime. Read ``AutobinomialFit.notes``.

    Raises
    ------
    DomainError
        NaN, levels beyond the model's, a constant picture or one of two values, too few pixels for the order, no finite maximum.

    Notes
    -----
    Standard errors follow from the sandwich formula (pseudo-likelihood) or from the inverse Fisher information with the error of the
    simulation (Monte Carlo).

    Examples
    --------
    >>> from seaglint.textures.autobinomial_sampler import sample
    >>> known = Autobinomial.of(4, 1, -1.2, (0.2,))
    >>> result = fit(sample(known, (64, 64), 50, seed=1), 4, periodic=True, check=False)
    >>> errors = abs(result.parameters - known.parameters)
    >>> bool((errors < 3.0 * result.standard_errors).all())
    True
    """
    if method not in get_args(Method):
        raise DomainError(f"method = {method!r}: allowed are {' and '.join(map(repr, get_args(Method)))}", name="method", value=method)
    ties = classes(order, isotropic) if neighbours is None else neighbours
    model = Autobinomial(levels, ties, 0.0, (0.0,) * len(ties))
    field = checked_field(image, model)
    refuse_flat(field, levels)
    _refuse_few(field, model, periodic=periodic)
    pixels, regressors = neighbour_sums(field, ties, periodic=periodic)
    optimum = climb(pixels, regressors, model, start, periodic=periodic)
    if method != "pseudo-likelihood":
        optimum = maximum_likelihood(field, optimum.model, seed, periodic=periodic, keep_histogram=method == "monte-carlo-exchange")
    return AutobinomialFit(
        model=optimum.model,
        covariance=optimum.covariance,
        log_pseudo_likelihood=conditional_log_likelihood(field, optimum.model, periodic=periodic),
        pixels=pixels.size,
        method=method,
        converged=optimum.converged,
        steps=optimum.steps,
        regime=regime(field, optimum.model, seed) if check else None,
        distance=optimum.distance,
    )


def refuse_flat(field: NDArray[np.int16], levels: int) -> None:
    """Refuse pictures of one value, and pictures of two values for a fit with more levels."""
    values = np.unique(field)
    if values.size == 1:
        message = f"every pixel is {values[0]}: a constant picture has no texture to fit; choose a region that varies, or finer grey levels"
        raise DomainError(message, name="image", value=int(values[0]))
    if values.size == 2 and levels > 2:
        raise DomainError(
            f"the picture has two values only ({values[0]} and {values[1]}) for levels = {levels}: set levels = 2 and give it as 0 and 1, "
            "or quantise the picture it was made from more finely",
            name="image",
            value=tuple(map(int, values)),
        )


def _refuse_few(field: NDArray[np.int16], model: Autobinomial, *, periodic: bool) -> None:
    (rows, columns), (down, across) = field.shape, reach(model.neighbours)
    inner = field.size if periodic else (rows - 2 * down) * (columns - 2 * across)
    needed = PIXELS_PER_PARAMETER * (1 + len(model.neighbours))
    if inner < needed:
        message = (
            f"{rows} x {columns} pixels: {inner} of them have all their neighbours, {needed} are needed for {1 + len(model.neighbours)} "
            "parameters; take a larger region, a lower order or isotropic classes"
        )
        raise DomainError(message, name="image", value=inner, allowed=f"{needed} or more")
