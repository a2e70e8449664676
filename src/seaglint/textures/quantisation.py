"""Grey levels of a picture: conversion of radiance to whole numbers and back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.textures.autobinomial import check_levels

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

    edges: FloatArray  #: Values between neighbouring levels, ascending [as the picture].
    values: FloatArray  #: Mean of the picture's pixels in each level [as the picture].

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
        held = np.asarray(picture, dtype=np.float64)
        bad = int((~np.isfinite(held)).sum())
        if bad:
            raise DomainError(
                f"{bad} of {held.size} pixels are NaN or infinite: choose a region without them, or fill them", name="picture"
            )
        low, high = float(held.min()), float(held.max())
        if low == high:
            raise DomainError(
                f"every pixel is {low:g}: a constant picture has no texture; choose a region that varies", name="picture", value=low
            )
        if spacing == "even":
            edges = np.linspace(low, high, levels + 1)[1:-1]
        else:
            edges = np.quantile(held, np.arange(1, levels) / levels)
            if np.unique(edges).size < levels - 1:
                raise DomainError(
                    f"levels = {levels}: too many pixels of this picture are equal for so many levels of equal share; "
                    "take fewer levels or spacing 'even'",
                    name="levels",
                    value=levels,
                )
        placed = np.searchsorted(edges, held.ravel(), side="right")
        counts = np.bincount(placed, minlength=levels)
        between = np.concatenate([[low], edges, [high]])
        middle = 0.5 * (between[1:] + between[:-1])
        means = np.bincount(placed, held.ravel(), minlength=levels) / np.maximum(counts, 1)
        return cls(edges, np.where(counts > 0, means, middle))

    def to_levels(self, picture: ArrayLike) -> NDArray[np.int16]:
        """Level of each pixel; values beyond the extremes are in the outermost levels."""
        return np.searchsorted(self.edges, np.asarray(picture, dtype=np.float64), side="right").astype(np.int16)

    def to_values(self, field: NDArray[Any] | ArrayLike) -> FloatArray:
        """Value that each pixel's level represents [as the picture]."""
        return self.values[np.asarray(field, dtype=np.int64)]
