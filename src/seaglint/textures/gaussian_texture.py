"""Texture of a Gauss-Markov field: correlations by the field, values by a marginal transform, patches by a slow field."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.textures import gauss_markov_fit as estimation
from seaglint.textures.gauss_markov import GaussMarkov, canonical, pseudo_log_likelihood
from seaglint.textures.long_tails import find_modulation
from seaglint.textures.marginals import Marginal, Tails, fit_marginal
from seaglint.textures.synthesis import Modulation, latent

KIND: Final = "gauss-markov"

REACH: Final = (2, 4, 4)  #: Farthest candidate neighbours, in frames, rows and columns.

SPACE_IN_TIME: Final = 2  #: Farthest rows and columns of neighbours in other frames: waves move a pixel or two from one frame to the next.


@dataclass(frozen=True)
class GaussianTexture:
    """Texture ``marginal(x)`` of a Gauss-Markov field x of variance 1, made of white noise or of noise times a slow field."""

    field: GaussMarkov  #: Correlations of the Gaussian field; its variance on the plane is near 1.
    marginal: Marginal  #: Values of the pixels [u].
    modulation: Modulation | None = None  #: Slow field.

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
        return self.marginal.transform(latent(self.field, shape, seed, self.modulation))

    def pseudo_log_likelihood(self, data: ArrayLike) -> float:
        """Mean log density of a pixel given its neighbours [per pixel, of values in u]; the slow field is not used."""
        x = self.marginal.gaussian(data)
        return pseudo_log_likelihood(self.field, x) - float(np.mean(self.marginal.log_slope(x)))

    def to_dict(self) -> JsonObject:
        """Return the texture as values for JSON."""
        return {
            **self.field.to_dict(),
            "marginal": self.marginal.to_dict(),
            "modulation": None if self.modulation is None else self.modulation.to_dict(),
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
            return cls(
                GaussMarkov.from_dict(values), Marginal.from_dict(values["marginal"]), None if slow is None else Modulation.from_dict(slow)
            )
        except (KeyError, TypeError, IndexError) as error:
            raise DataError(f"not a whole Gauss-Markov texture ({error!r}): fit it anew") from error


@dataclass(frozen=True)
class TextureFit:
    """Fitted texture with the diagnostics of the fit."""

    texture: GaussianTexture  #: Field, marginal and slow field.
    field: estimation.GaussMarkovFit  #: Standard errors and criterion of the Gaussian field.
    correlation_error: float  #: Share of the variance that the expansion of the marginal transform leaves out [1].
    #: Log ratios of exceedances at 2.5, 3 and 3.5 standard deviations of the filtered picture, sample over data. Shape (3,).
    tail_misfit: FloatArray
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


def fit_texture(
    data: ArrayLike, tails: Tails = "gaussian", *, reach: Sequence[int] = REACH, product: bool | None = None, most: int = 16, seed: int = 0
) -> TextureFit:
    """Fit a texture to a picture or sequence that is not periodic.

    Parameters
    ----------
    data : array_like, shape (rows, columns) or (frames, rows, columns)
        [u]; NaN where a pixel does not count.
    tails : str
        Distribution of the pixels, one of ``seaglint.textures.marginals.TAILS``.
    reach : (int, int, int)
        Farthest neighbours tried [frames, rows, columns].
    product : bool, optional
        Whether a slow field may be added to meet the tails of the filtered picture; by default unless ``tails`` is gaussian.
    most : int
        Largest number of neighbour pairs.
    seed : int
        Seed of the samples for the search of the slow field.

    Raises
    ------
    DataError
        Infinite or equal values, too few pixels, covariances that no field has.
    """
    x = np.array(data, np.float64, ndmin=3)
    pool = neighbours(x.shape, reach)
    far = np.abs(np.array(pool)).max(axis=0)
    measured = estimation.covariances(x, [min(int(r), (n - 1) // 2) for r, n in zip(far, x.shape, strict=True)])
    # A small picture has no covariances at the farthest distances: neighbours there are no candidates.
    pool = tuple(d for d in pool if all(abs(p) <= r for p, r in zip(d, measured.reach, strict=True)))
    variance = measured.at((0, 0, 0))
    if not variance > 0.0:
        raise DataError("all values are equal: there is no texture to fit; choose another region")
    marginal = fit_marginal(x, tails)
    # The field is fitted to the correlations that it has before the transform to the values.
    field = estimation.choose(replace(measured, values=marginal.latent_correlation(measured.values / variance), mean=0.0), pool, most)
    notes = list(field.notes)
    slow, misfit = None, np.full(3, np.nan)
    if product or (product is None and tails != "gaussian"):
        slow, misfit = find_modulation(x, field.model, marginal, seed)
    if slow is not None:
        notes.append(
            f"{tails} values alone leave the filtered picture short of exceedances: fine structure is multiplied by a slow gamma field of "
            f"shape {slow.shape:.3g}"
        )
    return TextureFit(GaussianTexture(field.model, marginal, slow), field, marginal.truncation, misfit, tuple(notes))
