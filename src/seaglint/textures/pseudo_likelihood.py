"""Maximum pseudo-likelihood of autobinomial fields: a concave function, maximised by Newton's steps, with sandwich standard errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit, gammaln, log_expit

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.textures.autobinomial import Autobinomial, Classes, IntArray, checked_field, pairs_inside, reach

MOST_STEPS: Final = 100  #: Largest number of Newton's steps.

#: Gain of a further Newton step in log pseudo-likelihood per pixel at which the iteration ends: the couplings then have ten digits.
DECREMENT: Final = 1e-18

CERTAIN: Final = 40.0  #: Logit beyond which a pixel is certain; couplings that make all pixels certain grow without limit.

#: Largest condition of the information matrix (of scaled sums); beyond, neighbours cannot be distinguished.
LARGEST_CONDITION: Final = 1e12


@dataclass(frozen=True)
class Optimum:
    """Maximum of a pseudo-likelihood or likelihood."""

    model: Autobinomial  #: Field at the maximum.
    #: Covariance of the parameters [(1 + classes, 1 + classes)], by the sandwich formula or from the inverse Fisher information with the
    #: error of the simulation; NaN where the picture is too small to determine it.
    covariance: FloatArray
    steps: int  #: Number of Newton's steps.
    converged: bool  #: Whether the maximum was reached.
    #: Remaining gap between the picture's sums and the samples', in standard deviations of a sample's; None for a pseudo-likelihood.
    distance: float | None = None


def neighbour_sums(field: IntArray, neighbours: Classes, *, periodic: bool) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return levels of pixels, and a matrix of 1 and the sum of each class of their neighbours [level].

    Returns
    -------
    levels : array, (rows, columns)
        All pixels of a torus, or those that have all their neighbours in the picture.
    sums : array, (rows, columns, 1 + classes)
        The regressors of the conditional law.
    """
    padded = np.asarray(field, dtype=np.float64)
    down, across = reach(neighbours)
    if periodic:
        padded = np.pad(padded, ((down, down), (across, across)), mode="wrap")
    rows, columns = padded.shape[0] - 2 * down, padded.shape[1] - 2 * across

    def moved(dy: int, dx: int) -> NDArray[np.float64]:
        return padded[down + dy : down + dy + rows, across + dx : across + dx + columns]

    sums = np.empty((rows, columns, 1 + len(neighbours)))
    sums[..., 0] = 1.0
    for k, one in enumerate(neighbours, 1):
        sums[..., k] = sum(moved(dy, dx) + moved(-dy, -dx) for dy, dx in one)
    return moved(0, 0), sums


def log_choices(levels: NDArray[Any], most: int) -> NDArray[np.float64]:
    """Logarithm of the binomial coefficient for given numbers of ``most`` [1]."""
    return np.asarray(gammaln(most + 1.0) - gammaln(levels + 1.0) - gammaln(most - levels + 1.0))


def conditional_log_likelihood(image: IntArray, model: Autobinomial, *, periodic: bool = False) -> float:
    """Return the log probability of a pixel given its neighbours, mean over a picture [nat]: the measure for pictures held out of the fit.

    ``mean_s [x log p + (M - x) log(1 - p) + log binom(M, x)]`` with M the largest grey level and ``p = expit(alpha + sum_k beta_k n_k)``.

    Parameters
    ----------
    image : array of int, (rows, columns)
        Grey levels.
    model : Autobinomial
        The field.
    periodic : bool
        Whether opposite edges are neighbours; else pixels without all their neighbours are left out.

    Returns
    -------
    float
        Mean log pseudo-likelihood per pixel [nat].

    Examples
    --------
    >>> fair = Autobinomial.of(2, 1, 0.0, (0.0,))
    >>> print(f"{conditional_log_likelihood(np.eye(8, dtype=int), fair):.6f}")  # log(1/2)
    -0.693147
    """
    levels, sums = neighbour_sums(checked_field(image, model), model.neighbours, periodic=periodic)
    logit = sums @ model.parameters
    # Accurate in both tails: log p = log_expit(eta), log (1 - p) = log_expit(-eta).
    each = levels * log_expit(logit) + (model.most - levels) * log_expit(-logit) + log_choices(levels, model.most)
    return float(each.mean())


def climb(
    levels: NDArray[np.float64], sums: NDArray[np.float64], first: Autobinomial, start: FloatArray | None, *, periodic: bool
) -> Optimum:
    """Maximise the pseudo-likelihood.

    Parameters
    ----------
    levels, sums : array
        Arrays from ``neighbour_sums``.
    first : Autobinomial
        Field with the levels and classes of the sums; its parameters are not used.
    start : array, (1 + classes,), optional
        First parameters; independent pixels by default.
    periodic : bool
        Whether opposite edges are neighbours in the sums.

    Raises
    ------
    DomainError
        Neighbour sums that are proportional to each other, or a picture with infinite best couplings.

    Notes ----- The log pseudo-likelihood is concave (a binomial regression): halved Newton's steps reach its one maximum from any start.
    Scores of pixels that are no neighbours are uncorrelated, so that the middle of the sandwich is a sum over neighbours alone.

    References
    ----------
    J. Besag, "Statistical analysis of non-lattice data", The Statistician 24 (1975), 179-195; X. Guyon, "Random fields on a network"
    (1995), Sec. 5.3 (sandwich formula).
    """
    x, count, most = levels.ravel(), levels.size, first.most
    # Sums of mean 0 and variance 1 make the information well conditioned; the results are converted back at the end.
    centre, spread = sums.reshape(count, -1).mean(axis=0), sums.reshape(count, -1).std(axis=0)
    centre[0], spread[0] = 0.0, 1.0
    if (spread == 0.0).any():
        message = "the neighbours of every pixel have one sum: their coupling cannot be told from alpha; choose a region that varies"
        raise DomainError(message, name="image")
    z = (sums.reshape(count, -1) - centre) / spread
    share = x.mean() / most
    if start is None:
        theta = np.zeros(z.shape[1])
        # Without couplings the logit of the mean is the maximum.
        theta[0] = np.log(share / (1.0 - share))
    else:
        theta = np.asarray(start, dtype=np.float64) * spread
        theta[0] = start[0] + float(np.dot(start[1:], centre[1:]))

    def value(at: FloatArray) -> float:
        logit = z @ at
        return float((x * log_expit(logit) + (most - x) * log_expit(-logit)).mean())

    now = value(theta)
    steps, converged = 0, False
    while steps < MOST_STEPS:
        steps += 1
        chance = expit(z @ theta)
        gradient = z.T @ (x - most * chance) / count
        information = (z * (most * chance * (1.0 - chance))[:, None]).T @ z / count
        _refuse_twins(information)
        step = np.linalg.solve(information, gradient)
        gain = float(gradient @ step)
        if gain <= DECREMENT:
            converged = True
            break
        # The step is halved until it gains its share of the expected gain.
        length = 1.0
        while (then := value(theta + length * step)) < now + 1e-4 * length * gain and length > 1e-10:
            length *= 0.5
        if then <= now:  # rounding is all that is left
            converged = gain < 1e-12
            break
        theta, now = theta + length * step, then
        if np.median(np.abs(z @ theta)) > CERTAIN:
            break
    chance = expit(z @ theta)
    if not converged or (np.minimum(chance, 1.0 - chance) < 1e-6).mean() > 0.99:
        raise DomainError(
            "the pseudo-likelihood has no maximum: neighbours tell (nearly) every pixel of this picture, so the couplings grow for ever; "
            "take fewer levels or a lower order, or keep the picture's histogram and choose couplings by hand (exchange)",
            name="image",
        )
    scores = z.reshape(sums.shape) * (levels - most * chance.reshape(levels.shape))[..., None]
    information = (z * (most * chance * (1.0 - chance))[:, None]).T @ z
    bread = np.linalg.inv(information)
    scaled = bread @ score_covariance(scores, first.neighbours, periodic=periodic) @ bread
    back = np.diag(1.0 / spread)
    back[0, 1:] = -centre[1:] / spread[1:]
    covariance = back @ scaled @ back.T
    if np.linalg.eigvalsh(scaled)[0] <= 0.0:
        covariance = np.full_like(covariance, np.nan)
    return Optimum(first.with_parameters(back @ theta), covariance, steps, converged)


def score_covariance(scores: NDArray[np.float64], neighbours: Classes, *, periodic: bool) -> FloatArray:
    """Return the covariance of the sum of scores, from products of pixels with themselves and with their neighbours."""
    count = scores.shape[-1]
    flat = scores.reshape(-1, count)
    total = flat.T @ flat
    for dy, dx in (offset for one in neighbours for offset in one):
        if periodic:
            pairs = flat.T @ np.roll(scores, (-dy, -dx), axis=(0, 1)).reshape(-1, count)
        else:
            first, second = (pixels.reshape(-1, count) for pixels in pairs_inside(scores, (dy, dx)))
            pairs = first.T @ second
        total = total + pairs + pairs.T
    return total


def _refuse_twins(information: FloatArray) -> None:
    """Refuse classes of neighbours of which one is a function of another."""
    scale = np.sqrt(np.diag(information))
    if not scale.all() or np.linalg.cond(information / np.outer(scale, scale)) > LARGEST_CONDITION:
        raise DomainError(
            "sums over different classes of neighbours are proportional in this picture (stripes, a ramp, or pixels all but certain): take "
            "a lower order, isotropic classes, or fewer levels",
            name="image",
        )
