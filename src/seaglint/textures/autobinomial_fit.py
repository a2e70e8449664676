"""Maximum likelihood of autobinomial fields by Monte Carlo: parameters whose samples have the picture's sums over pixels and pairs.

Fit of an autobinomial field to a picture of grey levels, with standard errors and the regime of the fit.
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
from seaglint.textures import autobinomial_sampler as kernels
from seaglint.textures import autobinomial_sampler as sampler
from seaglint.textures.autobinomial import Autobinomial, Classes, IntArray, checked_field, classes, reach
from seaglint.textures.pseudo_likelihood import climb, conditional_log_likelihood, neighbour_sums
from seaglint.textures.regime import Regime, regime

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
        held = sampler.sampling_law(model)
        sums = np.empty((sweeps, 1 + len(model.beta)))
        for i in range(sweeps):
            if self.keep_histogram:
                kernels.exchange_kernel(self.state, held, self.lattice, self.key, self.done, 1)
            else:
                sampler.sweep(self.state, held, self.lattice, self.key, self.done, 1)
            sums[i] = sampler.sums_of(self.state, held, self.lattice)
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
    observed = sampler.sums_of(field, sampler.sampling_law(first), lattice)[int(keep_histogram) :]
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


Method = Literal["pseudo-likelihood", "monte-carlo", "monte-carlo-exchange"]

#: Least number of pixels with all their neighbours for each parameter; with fewer, standard errors are meaningless.
PIXELS_PER_PARAMETER: Final = 30


@dataclass(frozen=True)
class AutobinomialFit:
    """Fitted autobinomial field."""

    model: Autobinomial  #: The field.
    covariance: FloatArray  #: Covariance of :attr:`parameters`; NaN where the picture is too small to tell.
    log_pseudo_likelihood: float  #: Log pseudo-likelihood of the picture at the fit, mean per pixel [nat].
    pixels: int  #: Pixels that entered, each with all its neighbours.
    method: Method  #: Method of the fit.
    converged: bool  #: Whether the maximum was reached.
    steps: int  #: Newton's steps taken.
    regime: Regime | None  #: Regime of samples of the fit; None where it was not requested.
    #: Left between the picture's sums and those of samples, in standard deviations of a sample's; None of a pseudo-likelihood.
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

    Parameters
    ----------
    image : array of int, (rows, columns)
        Grey levels 0 to ``levels - 1`` (:class:`seaglint.textures.autobinomial_texture.GreyLevels` makes them of radiance).
    levels : int
        Grey levels of the field.
    order : int
        Neighbourhood: distances taken, from the shortest.
    isotropic : bool
        One coupling for each distance; else one for each symmetric pair of neighbours.
    method : {"pseudo-likelihood", "monte-carlo", "monte-carlo-exchange"}
        Maximum pseudo-likelihood; or from there maximum likelihood with sampled moments (seconds), whose Gibbs samples have the picture's
        mean and products of neighbours; or that given the histogram, whose exchange samples have them. The last has no alpha to find: it is
        kept from the pseudo-likelihood, and its variance is NaN.
    periodic : bool
        Whether opposite edges are neighbours, as in samples on a torus; else pixels at the edge only serve as neighbours.
    neighbours : tuple of tuple of (int, int), optional
        Classes of offsets in place of ``order`` and ``isotropic``.
    seed : int
        Seed of the simulations.
    start : array, (1 + classes,), optional
        Where the climb of the pseudo-likelihood begins; it ends in the same place.
    check : bool
        Whether to sample the fit and name its regime (under a second).

    Returns
    -------
    AutobinomialFit
        Parameters with covariance, log pseudo-likelihood and regime. Read :attr:`AutobinomialFit.notes`.

    Raises
    ------
    DomainError
        NaN, levels beyond the model's, a constant picture or one of two values, too few pixels for the order, no finite maximum.

    Notes
    -----
    Standard errors are those of the sandwich formula (pseudo-likelihood) or of the inverse Fisher information with the error of the
    simulation (Monte Carlo).

    Examples
    --------
    >>> from seaglint.textures.autobinomial_sampler import sample
    >>> known = Autobinomial.of(4, 1, -1.2, (0.2,))
    >>> found = fit(sample(known, (64, 64), 50, seed=1), 4, periodic=True, check=False)
    >>> bool((abs(found.parameters - known.parameters) < 3.0 * found.standard_errors).all())
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
    top = climb(pixels, regressors, model.most, ties, start, periodic=periodic)
    model, covariance = model.with_parameters(top.parameters), top.covariance
    converged, steps, distance = top.converged, top.steps, None
    if method != "pseudo-likelihood":
        ascent = maximum_likelihood(field, model, seed, periodic=periodic, keep_histogram=method == "monte-carlo-exchange")
        converged, steps, distance = ascent.converged, ascent.rounds, ascent.distance
        model, covariance = ascent.model, ascent.covariance
    return AutobinomialFit(
        model,
        covariance,
        conditional_log_likelihood(field, model, periodic=periodic),
        pixels.size,
        method,
        converged,
        steps,
        regime(field, model, seed) if check else None,
        distance,
    )


def refuse_flat(field: NDArray[np.int16], levels: int) -> None:
    """Refuse pictures of one value, and those of two values for a fit with more levels."""
    values = np.unique(field)
    if values.size == 1:
        raise DomainError(
            f"every pixel is {values[0]}: a constant picture has no texture to fit; choose a region that varies, or finer grey levels",
            name="image",
            value=int(values[0]),
        )
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
        raise DomainError(
            f"{rows} x {columns} pixels: {inner} of them have all their neighbours, {needed} are needed for {1 + len(model.neighbours)} "
            "parameters; take a larger region, a lower order or isotropic classes",
            name="image",
            value=inner,
            allowed=f"{needed} or more",
        )
