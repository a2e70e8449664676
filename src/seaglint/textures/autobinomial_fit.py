"""Fit of an autobinomial field to a picture of grey levels, with standard errors and the regime of the fit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.free_form import JsonObject
from seaglint.base.threads import single_threaded_algebra
from seaglint.textures.autobinomial import Autobinomial, IntArray, checked_field
from seaglint.textures.monte_carlo import maximum_likelihood
from seaglint.textures.neighbourhood import Classes, classes, reach
from seaglint.textures.pseudo_likelihood import climb, conditional_log_likelihood, neighbour_sums
from seaglint.textures.regime import Regime, regime

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
        Grey levels 0 to ``levels - 1`` (:class:`seaglint.textures.quantisation.GreyLevels` makes them of radiance).
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
