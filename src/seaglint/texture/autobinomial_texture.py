"""A texture of an autobinomial field: grey levels by the field, and the values that they stand for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint import random
from seaglint.errors import DataError, DomainError
from seaglint.texture.autobinomial import Autobinomial
from seaglint.texture.autobinomial_sampler import exchange
from seaglint.texture.levels import GreyLevels
from seaglint.texture.pseudo_likelihood import conditional_log_likelihood

SWEEPS: Final = 200
"""Exchanges tried for each pixel of a sample."""


@dataclass(frozen=True)
class AutobinomialTexture:
    """Pixels are grey levels of an autobinomial field, with the values and the histogram of the picture it was fitted to.

    Attributes
    ----------
    field : Autobinomial
    grey : GreyLevels
        What each level stands for.
    histogram : tuple of float
        Share of each level in the picture [1]: samples by exchange keep it, so that no phase transition can freeze or melt them.
    """

    field: Autobinomial
    grey: GreyLevels
    histogram: tuple[float, ...]

    @property
    def reach(self) -> tuple[int, int, int]:
        """Farthest neighbour [frames, rows, columns]."""
        return (0, *self.field.reach)

    def sample(self, shape: Sequence[int], seed: int, sweeps: int = SWEEPS) -> NDArray[np.float32]:
        """Sample on a torus [u, (1, rows, columns)].

        Raises
        ------
        DomainError
            More than one frame, or a torus too small for the neighbourhood.
        """
        frames, rows, columns = shape
        if frames != 1:
            raise DomainError(f"frames = {frames}: an autobinomial field has no time; ask for one frame, or fit gauss-markov to a sequence")
        shares = np.array(self.histogram)
        counts = np.floor(shares * rows * columns).astype(int)
        # What rounding leaves goes to the levels that lost most.
        lost = np.argsort(counts - shares * rows * columns)
        counts[lost[: rows * columns - counts.sum()]] += 1
        start = np.repeat(np.arange(counts.size), counts).astype(np.int16)
        random.stream(seed, "texture histogram").shuffle(start)
        field = exchange(start.reshape(rows, columns), self.field, sweeps, seed)
        return np.asarray(self.grey.to_values(field), np.float32)[None]

    def pseudo_log_likelihood(self, data: ArrayLike) -> float:
        """Mean log probability of a pixel's level given its neighbours [per pixel]."""
        frames = np.array(data, np.float64, ndmin=3)
        return float(np.mean([conditional_log_likelihood(self.grey.to_levels(frame), self.field) for frame in frames]))

    def to_dict(self) -> dict[str, Any]:
        """What JSON holds of it."""
        return {
            **self.field.to_dict(),
            "grey_edges": self.grey.edges.tolist(),
            "grey_values": self.grey.values.tolist(),
            "histogram": list(self.histogram),
        }

    @classmethod
    def from_dict(cls, held: Mapping[str, Any]) -> AutobinomialTexture:
        """Read back what :meth:`to_dict` wrote.

        Raises
        ------
        DataError
            Another kind of model, or one that is not whole.
        """
        field = Autobinomial.from_dict(dict(held))
        try:
            grey = GreyLevels(np.array(held["grey_edges"], float), np.array(held["grey_values"], float))
            histogram = tuple(map(float, held["histogram"]))
        except (KeyError, TypeError, ValueError) as error:
            raise DataError(f"not a whole autobinomial texture ({error!r}): fit it anew") from error
        if not (grey.values.size == len(histogram) == field.levels and abs(sum(histogram) - 1.0) < 1e-6):
            raise DataError("not a whole autobinomial texture: levels, their values and their shares differ in number; fit it anew")
        return cls(field, grey, histogram)
