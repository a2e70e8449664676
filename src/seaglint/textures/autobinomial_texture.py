"""Texture of an autobinomial field: grey levels of the field, and the values that they represent.

``GreyLevels`` converts radiance to grey levels and back. ``fit_texture`` fits a texture and chooses the sampler.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base import random
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject
from seaglint.textures.autobinomial import Autobinomial, check_levels
from seaglint.textures.autobinomial_fit import AutobinomialFit, Method
from seaglint.textures.autobinomial_fit import fit as fit_field
from seaglint.textures.autobinomial_sampler import exchange
from seaglint.textures.autobinomial_sampler import sample as gibbs
from seaglint.textures.pseudo_likelihood import conditional_log_likelihood
from seaglint.textures.regime import correlations

Spacing = Literal["even", "equal-share"]  #: Spacing of levels: equal widths between the extremes, or equal numbers of pixels.


@dataclass(frozen=True)
class GreyLevels:
    """Grey levels with the value that each represents.

    Examples
    --------
    >>> grey = GreyLevels.of([[0.0, 1.0], [2.0, 4.0]], 4)
    >>> grey.to_levels([0.4, 3.9]), grey.to_values([0, 3])
    (array([0, 3], dtype=int16), array([0., 4.]))
    """

    edges: FloatArray  #: Values between neighbouring levels, ascending [as the picture, (levels - 1,)].
    values: FloatArray  #: Mean of the picture's pixels in each level [as the picture, (levels,)].

    @property
    def levels(self) -> int:
        """Number of levels."""
        return int(self.values.size)

    @classmethod
    def of(cls, picture: ArrayLike, levels: int, spacing: Spacing = "even") -> GreyLevels:
        """Grey levels for a picture.

        Parameters
        ----------
        picture : array
            Any quantity; its pixels must differ and be finite.
        levels : int
            Grey levels.
        spacing : {"even", "equal-share"}
            Equal widths between the least and the largest value, or equal numbers of pixels (an even histogram, as Cross and Jain took).

        Raises
        ------
        DomainError
            NaN, a constant picture, or more levels than values.
        """
        check_levels(levels)
        values = np.asarray(picture, dtype=np.float64)
        bad = int((~np.isfinite(values)).sum())
        if bad:
            raise DomainError(
                f"{bad} of {values.size} pixels are NaN or infinite: choose a region without them, or fill them", name="picture"
            )
        low, high = float(values.min()), float(values.max())
        if low == high:
            raise DomainError(
                f"every pixel is {low:g}: a constant picture has no texture; choose a region that varies", name="picture", value=low
            )
        if spacing == "even":
            edges = np.linspace(low, high, levels + 1)[1:-1]
        else:
            edges = np.quantile(values, np.arange(1, levels) / levels)
            if np.unique(edges).size < levels - 1:
                raise DomainError(
                    f"levels = {levels}: too many pixels of this picture are equal for so many levels of equal share; "
                    "take fewer levels or spacing 'even'",
                    name="levels",
                    value=levels,
                )
        placed = np.searchsorted(edges, values.ravel(), side="right")
        counts = np.bincount(placed, minlength=levels)
        between = np.concatenate([[low], edges, [high]])
        centres = 0.5 * (between[1:] + between[:-1])
        # A level without pixels has no mean: the middle of its edges stands for it.
        means = np.bincount(placed, values.ravel(), minlength=levels) / np.maximum(counts, 1)
        return cls(edges, np.where(counts > 0, means, centres))

    def to_levels(self, picture: ArrayLike) -> NDArray[np.int16]:
        """Level of each pixel; values beyond the extremes are in the outermost levels."""
        return np.searchsorted(self.edges, np.asarray(picture, dtype=np.float64), side="right").astype(np.int16)

    def to_values(self, field: NDArray[Any] | ArrayLike) -> FloatArray:
        """Value that each pixel's level represents [as the picture]."""
        return self.values[np.asarray(field, dtype=np.int64)]


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

    field: Autobinomial  #: Field of the grey levels.
    grey: GreyLevels  #: Value that each level represents.
    #: Share of each level in the picture [1]: samples by exchange preserve it, so that no phase transition can freeze or melt them.
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
        counts[np.argsort(counts - shares * rows * columns)[: rows * columns - counts.sum()]] += 1
        # Exchanges keep the histogram: the start has it, in random order.
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
    def from_dict(cls, values: Mapping[str, Any]) -> AutobinomialTexture:
        """Read the output of ``to_dict``.

        Raises
        ------
        DataError
            Another kind of model, or one that is not whole.
        """
        model = Autobinomial.from_dict(dict(values))
        try:
            grey = GreyLevels(np.array(values["grey_edges"], float), np.array(values["grey_values"], float))
            histogram = tuple(map(float, values["histogram"]))
            sampler: Sampler = values["sampler"]
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

    texture: AutobinomialTexture  #: Texture with its sampler.
    #: Fit of the field. If the requested fit did not converge, it or the pseudo-likelihood's, whichever has exchange samples nearer to the
    #: picture.
    found: AutobinomialFit
    tried: Way  #: Requested method for the couplings.
    notes: tuple[str, ...] = ()  #: Reasons for the choice of couplings and sampler.


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
    Where that fit is frozen or molten, or the histogram is to be preserved, couplings maximise the likelihood given the histogram, and
    samples are drawn by exchanges. A Monte Carlo likelihood that does not converge is reported, with the distance of samples from the
    picture; samples are then drawn by exchanges at the last couplings or at the pseudo-likelihood's maximum, whichever gives the nearer
    correlations.

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
        Errors of the fit and of ``seaglint.textures.autobinomial_texture.GreyLevels``.
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
    # A permutation of the picture has its histogram and none of its correlations.
    start = random.stream(seed, "texture histogram").permutation(picture.ravel()).reshape(picture.shape)
    drawn = exchange(start, model, SWEEPS["exchange"], seed)
    return float(np.abs(correlations(drawn, model.neighbours) - correlations(picture, model.neighbours)).max())


def _histograms_apart(picture: NDArray[np.int16], model: Autobinomial, seed: int) -> float:
    """Largest distance between the distribution functions of levels in the picture and in a Gibbs sample [1]."""
    drawn = gibbs(model, (picture.shape[0], picture.shape[1]), SWEEPS["gibbs"], seed)
    counts = [np.bincount(x.ravel(), minlength=model.levels) / x.size for x in (drawn, picture)]
    return float(np.abs(np.cumsum(counts[0] - counts[1])).max())
