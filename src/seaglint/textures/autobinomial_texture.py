"""Texture of an autobinomial field: grey levels of the field, and the values that they represent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base import random
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject
from seaglint.textures.autobinomial import Autobinomial
from seaglint.textures.autobinomial_fit import AutobinomialFit, Method
from seaglint.textures.autobinomial_fit import fit as fit_field
from seaglint.textures.autobinomial_sampler import exchange
from seaglint.textures.autobinomial_sampler import sample as gibbs
from seaglint.textures.pseudo_likelihood import conditional_log_likelihood
from seaglint.textures.quantisation import GreyLevels
from seaglint.textures.regime import correlations

Sampler = Literal["gibbs", "exchange"]

#: Method that fits the couplings; auto chooses by the regime of the pseudo-likelihood's fit.
Way = Literal["auto", "pseudo-likelihood", "monte-carlo", "monte-carlo-exchange"]

#: Number of sweeps of a sample: Gibbs sweeps as many as in the test of the regime; exchanges tried for each pixel.
SWEEPS: Final[Mapping[Sampler, int]] = {"gibbs": 300, "exchange": 200}


#: Distance of distribution functions beyond which Gibbs samples have another histogram: by chance 128 x 128 pixels differ by 0.01.
APART: Final = 0.03


@dataclass(frozen=True)
class AutobinomialTexture:
    """Texture of grey levels of an autobinomial field, with the values and the histogram of the fitted picture."""

    field: Autobinomial  #: Autobinomial.
    grey: GreyLevels  #: Value that each level represents.
    #: Share of each level in the picture [1]: samples by exchange keep it, so that no phase transition can freeze or melt them.
    histogram: tuple[float, ...]
    sampler: Sampler = "exchange"  #: Method that draws samples.

    @property
    def reach(self) -> tuple[int, int, int]:
        """Farthest neighbour [frames, rows, columns]."""
        return (0, *self.field.reach)

    def sample(self, shape: Sequence[int], seed: int, sweeps: int | None = None) -> NDArray[np.float32]:
        """Sample on a torus [u, (1, rows, columns)].

        Raises
        ------
        DomainError
            More than one frame, or a torus too small for the neighbourhood.
        """
        frames, rows, columns = shape
        if frames != 1:
            raise DomainError(f"frames = {frames}: an autobinomial field has no time; ask for one frame, or fit gauss-markov to a sequence")
        count = SWEEPS[self.sampler] if sweeps is None else sweeps
        if self.sampler == "gibbs":
            return self._values(gibbs(self.field, (rows, columns), count, seed))
        shares = np.array(self.histogram)
        counts = np.floor(shares * rows * columns).astype(int)
        # The remainder of rounding is given to the levels that lost most.
        lost = np.argsort(counts - shares * rows * columns)
        counts[lost[: rows * columns - counts.sum()]] += 1
        start = np.repeat(np.arange(counts.size), counts).astype(np.int16)
        random.stream(seed, "texture histogram").shuffle(start)
        return self._values(exchange(start.reshape(rows, columns), self.field, count, seed))

    def _values(self, levels: NDArray[np.int16]) -> NDArray[np.float32]:
        return np.asarray(self.grey.to_values(levels), np.float32)[None]

    def pseudo_log_likelihood(self, data: ArrayLike) -> float:
        """Mean log probability of a pixel's level given its neighbours [per pixel]."""
        frames = np.array(data, np.float64, ndmin=3)
        return float(np.mean([conditional_log_likelihood(self.grey.to_levels(frame), self.field) for frame in frames]))

    def to_dict(self) -> JsonObject:
        """Return the texture as values for JSON."""
        return {
            **self.field.to_dict(),
            "grey_edges": self.grey.edges.tolist(),
            "grey_values": self.grey.values.tolist(),
            "histogram": list(self.histogram),
            "sampler": self.sampler,
        }

    @classmethod
    def from_dict(cls, held: Mapping[str, Any]) -> AutobinomialTexture:
        """Read the output of :meth:`to_dict`.

        Raises
        ------
        DataError
            Another kind of model, or one that is not whole.
        """
        model = Autobinomial.from_dict(dict(held))
        try:
            grey = GreyLevels(np.array(held["grey_edges"], float), np.array(held["grey_values"], float))
            histogram = tuple(map(float, held["histogram"]))
            sampler: Sampler = held["sampler"]
        except (KeyError, TypeError, ValueError) as error:
            raise DataError(f"not a whole autobinomial texture ({error!r}): fit it anew") from error
        if not (grey.values.size == len(histogram) == model.levels and abs(sum(histogram) - 1.0) < 1e-6):
            raise DataError("not a whole autobinomial texture: levels, their values and their shares differ in number; fit it anew")
        if sampler not in get_args(Sampler):
            raise DataError(f"sampler = {sampler!r}; allowed are {' and '.join(get_args(Sampler))}")
        return cls(model, grey, histogram, sampler)


@dataclass(frozen=True)
class AutobinomialTextureFit:
    """Fitted texture with the diagnostics of the fit."""

    texture: AutobinomialTexture  #: AutobinomialTexture.
    #: The field's; where that asked for did not converge, the one whose exchange samples are nearer to the picture, it or the
    #: pseudo-likelihood's.
    found: AutobinomialFit
    tried: Way  #: Requested method for the couplings.
    notes: tuple[str, ...] = ()  #: tuple of str.


def fit_texture(
    image: ArrayLike,
    levels: int,
    order: int = 2,
    *,
    isotropic: bool = False,
    method: Way = "auto",
    keep_histogram: bool = False,
    seed: int = 0,
) -> AutobinomialTextureFit:
    """Fit a texture to a picture and choose the sampler that reproduces its contrast and correlation.

    With ``method`` auto a usable fit of the pseudo-likelihood is sampled by Gibbs sweeps, if they nearly have the picture's histogram.
    Where that fit is frozen or molten, or the histogram is to be kept, couplings are those of the likelihood given the histogram, and
    samples exchanges. A Monte Carlo likelihood that does not converge is reported, with the distance of samples from the picture; samples
    are then exchanges, at those couplings where it stopped or where the pseudo-likelihood has its top, whose correlations are nearer.

    Parameters
    ----------
    image : array_like, shape (rows, columns)
        [u], without missing values.
    levels, order, isotropic : int, int, bool
        Parameters of the field (:func:`seaglint.textures.autobinomial_fit.fit`).
    method : str
        auto, or one of the fits.
    keep_histogram : bool
        Draw samples with the picture's histogram, by exchange, whatever the regime.
    seed : int
        Seed of the simulations.

    Raises
    ------
    DataError, DomainError
        Errors of the fit and of :class:`seaglint.textures.quantisation.GreyLevels`.
    """
    grey = GreyLevels.of(image, levels)
    picture = grey.to_levels(image)

    @cache
    def fitted(by: Method) -> AutobinomialFit:
        return fit_field(picture, levels, order, isotropic=isotropic, method=by, seed=seed, check=by != "monte-carlo-exchange")

    pseudo = fitted("pseudo-likelihood")
    selected = pseudo if method == "auto" else fitted(method)
    notes: list[str] = []
    lost = selected.regime is not None and selected.regime.name != "usable"
    if selected.regime is not None and not lost and not keep_histogram:
        apart = _histograms_apart(picture, selected.model, seed)
        if apart > APART:
            keep_histogram = True
            notes.append(f"Gibbs sweeps at the {selected.method} fit have another histogram (distribution functions differ by {apart:.2g})")
    if method == "auto" and (lost or keep_histogram):
        if selected.regime is not None and lost:
            notes.append(f"Gibbs sweeps at the pseudo-likelihood's fit: {selected.regime.finding}")
        selected = fitted("monte-carlo-exchange")
    elif lost and selected.regime is not None:
        notes.append(f"Gibbs sweeps at this fit: {selected.regime.finding}")
    by_exchange = keep_histogram or lost or not selected.converged or selected.method == "monte-carlo-exchange"
    if not selected.converged:
        gaps = [_gap(picture, one.model, seed) for one in (selected, pseudo)]
        tried, selected = selected.method, (selected, pseudo)[int(np.argmin(gaps))]
        notes.append(
            f"the {tried} likelihood did not converge: the picture is none of this family. "
            f"Exchange samples where it stopped miss correlations with neighbours by {gaps[0]:.2g}, at the pseudo-likelihood's top by "
            f"{gaps[1]:.2g}; the nearer couplings are taken. Take fewer levels, another order or --model gauss-markov"
        )
    if by_exchange:
        notes.append(f"samples are drawn by exchange at the couplings of the {selected.method} fit: they have the picture's histogram")
    elif selected.regime is not None:
        notes.append(f"samples are drawn by Gibbs sweeps: {selected.regime.finding}")
    shares = np.bincount(picture.ravel(), minlength=levels) / picture.size
    texture = AutobinomialTexture(selected.model, grey, tuple(map(float, shares)), "exchange" if by_exchange else "gibbs")
    return AutobinomialTextureFit(texture, selected, method, tuple(notes))


def _gap(picture: NDArray[np.int16], model: Autobinomial, seed: int) -> float:
    """Largest difference between correlations with neighbours in the picture and in an exchange sample begun at a shuffled one [1]."""
    start = random.stream(seed, "texture histogram").permutation(picture.ravel()).reshape(picture.shape)
    drawn = exchange(start, model, SWEEPS["exchange"], seed)
    return float(np.abs(correlations(drawn, model.neighbours) - correlations(picture, model.neighbours)).max())


def _histograms_apart(picture: NDArray[np.int16], model: Autobinomial, seed: int) -> float:
    """Largest distance between the distribution functions of levels in the picture and in a Gibbs sample [1]."""
    drawn = gibbs(model, (picture.shape[0], picture.shape[1]), SWEEPS["gibbs"], seed)
    counts = [np.bincount(x.ravel(), minlength=model.levels) / x.size for x in (drawn, picture)]
    return float(np.abs(np.cumsum(counts[0] - counts[1])).max())
