"""Texture of a Gauss-Markov field: correlations by the field, long tails by a marginal transform, by its noise and by a slow scale."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.textures import gauss_markov_fit as estimation
from seaglint.textures.gauss_markov import GaussMarkov, Offset, canonical
from seaglint.textures.long_tails import Innovations, innovations
from seaglint.textures.marginals import EMPIRICAL, Marginal, Tails, fit_marginal
from seaglint.textures.synthesis import Modulation, latent

KIND: Final = "gauss-markov"

REACH: Final = (2, 4, 4)  #: Farthest candidate neighbours, in frames, rows and columns.

SPACE_IN_TIME: Final = 2  #: Farthest rows and columns of neighbours in other frames: waves move a pixel or two from one frame to the next.


PILOT: Final = 260_000  #: Number of pixels of a sample of a field with a slow scale, from which its distribution is known.

LawName = Tails | Literal["noise"]

#: Laws in words.
NAMES: Final[Mapping[LawName, str]] = {
    "gaussian": "Gaussian values",
    "gamma": "gamma values",
    "lognormal": "lognormal values",
    "k": "K values",
    "empirical": "empirical values",
    "noise": "empirical noise",
}


@dataclass(frozen=True)
class TextureLaw:
    """Source of the long tails of a texture."""

    #: Distribution of the pixels, or ``noise``: Gaussian pixels filtered from white noise of the distribution of the data's own noise.
    tails: LawName
    scaled: bool = False  #: Whether a slow scale multiplies the noise.

    @property
    def values(self) -> Tails:
        """Distribution of the pixels."""
        return "gaussian" if self.tails == "noise" else self.tails

    @property
    def name(self) -> str:
        """Law in words.

        Examples
        --------
        >>> TextureLaw("gamma").name, TextureLaw("noise", scaled=True).name
        ('gamma values', 'empirical noise times a slow scale')
        """
        return NAMES[self.tails] + (" times a slow scale" if self.scaled else "")


@dataclass(frozen=True)
class GaussianTexture:
    """Texture ``marginal(x)`` of a Gauss-Markov field x of variance 1, filtered from white noise or from noise times a slow field."""

    field: GaussMarkov  #: Correlations of the Gaussian field; its variance on the plane is near 1.
    marginal: Marginal  #: Values of the pixels [u].
    modulation: Modulation | None = None  #: Slow field.
    noise: Marginal | None = None  #: Distribution of the white noise, of mean 0 and variance 1; Gaussian where None.
    #: Transform that gives the values of a field with a slow scale, which is not Gaussian, the distribution ``marginal``; the same
    #: transform as of a Gaussian field where None.
    transform: Marginal | None = None

    @property
    def law(self) -> TextureLaw:
        """Law of the texture."""
        return TextureLaw("noise" if self.noise is not None else self.marginal.kind, scaled=self.modulation is not None)

    @property
    def reach(self) -> tuple[int, int, int]:
        """Farthest neighbour [frames, rows, columns]."""
        return self.field.reach

    def sample(self, shape: Sequence[int], seed: int) -> NDArray[np.float32]:
        """Sample on a torus [u, (frames, rows, columns)]: periodic along every axis, the same bytes for any number of threads.

        Raises
        ------
        DomainError
            A torus too small for the neighbourhood.
        """
        return (self.transform or self.marginal).transform(latent(self.field, shape, seed, self.modulation, self.noise))

    def to_dict(self) -> JsonObject:
        """Return the texture as values for JSON."""
        return {
            **self.field.to_dict(),
            "marginal": self.marginal.to_dict(),
            "modulation": None if self.modulation is None else self.modulation.to_dict(),
            "noise": None if self.noise is None else self.noise.to_dict(),
            "transform": None if self.transform is None else self.transform.to_dict(),
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> GaussianTexture:
        """Read the output of ``to_dict``.

        Raises
        ------
        DataError
            Another kind of model, or one that is not whole.
        """
        if values.get("kind") != KIND:
            raise DataError(f"kind = {values.get('kind')!r}: not a Gauss-Markov texture; fit one with model = 'gauss-markov'")
        try:
            slow = values.get("modulation")
            noise, transform = (None if one is None else Marginal.from_dict(one) for one in (values.get("noise"), values.get("transform")))
            return cls(
                GaussMarkov.from_dict(values),
                Marginal.from_dict(values["marginal"]),
                None if slow is None else Modulation.from_dict(slow),
                noise,
                transform,
            )
        except (KeyError, TypeError, IndexError) as error:
            raise DataError(f"not a whole Gauss-Markov texture ({error!r}): fit it anew") from error


@dataclass(frozen=True)
class TextureFit:
    """Fitted texture with the diagnostics of the fit."""

    texture: GaussianTexture  #: Field, values, noise and slow scale.
    field: estimation.GaussMarkovFit  #: Standard errors and criterion of the Gaussian field.
    correlation_error: float  #: Share of the variance that the expansion of the marginal transform leaves out [1].
    notes: tuple[str, ...] = ()  #: Remarks on the fit.


def neighbours(shape: Sequence[int], reach: Sequence[int] = REACH) -> tuple[tuple[int, int, int], ...]:
    """Candidate pairs for a field of that shape: all within ``reach``, in other frames no farther than ``SPACE_IN_TIME``.

    Frames are compared where there are eight of them or more.
    """
    time = min(reach[0], shape[0] // 4) if shape[0] >= 8 else 0
    in_frame = estimation.candidates((0, *reach[1:]))
    # Other frames have fewer candidates: waves move by a pixel or two from frame to frame.
    in_others = estimation.candidates((time, min(reach[1], SPACE_IN_TIME), min(reach[2], SPACE_IN_TIME)))
    return tuple(sorted({canonical(d) for d in (*in_frame, *(d for d in in_others if d[0] > 0))}))


def _pilot(model: GaussMarkov) -> tuple[int, int, int]:
    """Torus of a sample of ``PILOT`` pixels."""
    far = model.reach
    deep = 1 if far[0] == 0 else 8 * far[0] + 1
    side = int(math.sqrt(PILOT / deep))
    return deep, max(side, 2 * far[1] + 1), max(side, 2 * far[2] + 1)


def of_latent(marginal: Marginal, sample: NDArray[np.float32]) -> Marginal:
    """Return the transform that gives the values of a field that is not Gaussian a distribution.

    Parameters
    ----------
    marginal : Marginal
        Transform of a Gaussian field.
    sample : ndarray
        Values of the field [1].
    """
    from scipy.special import ndtri

    knots = np.linspace(-4.0, 4.0, EMPIRICAL)
    # Half a value beyond either end, so that no probability is 0 or 1.
    below = (np.searchsorted(np.sort(sample, axis=None), knots) + 0.5) / (sample.size + 1.0)
    values = np.maximum.accumulate((marginal(ndtri(below)) - marginal.loc) / marginal.scale)
    return Marginal("empirical", marginal.loc, marginal.scale, None, tuple(map(float, values)))


def fit_texture(
    data: ArrayLike, law: TextureLaw | None = None, *, reach: Sequence[int] = REACH, most: int = 16, offsets: Sequence[Offset] | None = None
) -> TextureFit:
    """Fit a texture of one law to a picture or sequence that is not periodic.

    Parameters
    ----------
    data : array_like, shape (rows, columns) or (frames, rows, columns)
        [u]; NaN where a pixel does not count.
    law : TextureLaw, optional
        Gaussian by default.
    reach : (int, int, int)
        Farthest neighbours tried [frames, rows, columns].
    most : int
        Largest number of neighbour pairs.
    offsets : sequence of (int, int, int), optional
        Neighbours (frames, rows, columns) where they are known; chosen by Schwarz's criterion otherwise.

    Raises
    ------
    DataError
        Values that are all equal, too few pixels, covariances that no field has.
    """
    return FieldsOf(data, reach=reach, most=most, offsets=offsets).fit(law or TextureLaw("gaussian"))


class FieldsOf:
    """Fits of several laws to the same data: a field is fitted once for each distribution of the pixels.

    Parameters and errors as of ``fit_texture``; ``coarse`` takes the smaller torus of the search for neighbours, in a fraction of the time.
    """

    def __init__(
        self,
        data: ArrayLike,
        *,
        reach: Sequence[int] = REACH,
        most: int = 16,
        offsets: Sequence[Offset] | None = None,
        coarse: bool = False,
    ) -> None:
        self._data = np.array(data, np.float64, ndmin=3)
        self._chosen = None if offsets is None else tuple(offsets)
        pool = neighbours(self._data.shape, reach) if self._chosen is None else self._chosen
        far = np.abs(np.array([*pool, (0, 0, 0)])).max(axis=0)
        self._measured = estimation.covariances(self._data, [min(int(r), (n - 1) // 2) for r, n in zip(far, self._data.shape, strict=True)])
        if not self._measured.at((0, 0, 0)) > 0.0:
            raise DataError("all values are equal: there is no texture to fit; choose another region")
        # A small picture has no covariances at the farthest distances: neighbours there are no candidates.
        self._pool = tuple(d for d in pool if all(abs(p) <= r for p, r in zip(d, self._measured.reach, strict=True)))
        self._most, self._largest = most, estimation.SEARCHED if coarse else estimation.LARGEST_TORUS
        self._fields: dict[Tails, tuple[Marginal, estimation.GaussMarkovFit]] = {}
        self._noises: dict[Tails, Innovations] = {}

    def fit(self, law: TextureLaw) -> TextureFit:
        """Fit one law."""
        kind = law.values
        if kind not in self._fields:
            self._fields[kind] = self._field(kind)
        marginal, field = self._fields[kind]
        noise, slow, transform = None, None, None
        if law.tails == "noise" or law.scaled:
            if kind not in self._noises:
                self._noises[kind] = innovations(marginal.gaussian(self._data), field.model)
            behind = self._noises[kind]
            slow = behind.modulation if law.scaled else None
            noise = behind.law(scaled=slow is not None) if law.tails == "noise" else None
            if slow is not None and kind == "empirical":
                transform = of_latent(marginal, latent(field.model, _pilot(field.model), 0, slow))
        return TextureFit(GaussianTexture(field.model, marginal, slow, noise, transform), field, marginal.truncation, field.notes)

    def _field(self, kind: Tails) -> tuple[Marginal, estimation.GaussMarkovFit]:
        marginal = fit_marginal(self._data[np.isfinite(self._data)], kind)
        # The field is fitted to the correlations that it has before the transform to the values.
        correlations = marginal.latent_correlation(self._measured.values / self._measured.at((0, 0, 0)))
        latents = replace(self._measured, values=correlations, mean=0.0)
        if self._chosen is None:
            return marginal, estimation.choose(latents, self._pool, self._most)
        try:
            return marginal, estimation.fit(latents, self._pool, largest=self._largest)
        except estimation.NoOptimumError:
            return marginal, estimation.fit(latents.damped(), self._pool, largest=self._largest)
