"""Whether a picture can be the sample of a stationary texture, and which part of it is where the whole is not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.clutter.correlation import spatial_correlation, trend_surface
from seaglint.clutter.stationarity import Stationarity, stationarity
from seaglint.errors import DataError

SMALLEST_SIDE: Final = 24
"""Rows and columns that a texture is fitted to at least [px]: six times the farthest neighbour."""

SHARES: Final = (0.75, 0.5, 0.375, 0.25)
"""Sides of the regions that are looked at where the whole is not stationary, as shares of the picture's."""

STEPS: Final = 5
"""Places of a region of one size along each side."""

PERMUTATIONS: Final = 199

FEW: Final = 8
"""Frames that the test of stationarity looks at; those between them hardly tell more."""


@dataclass(frozen=True)
class Region:
    """Rows and columns of a picture, the last ones not included."""

    top: int
    bottom: int
    left: int
    right: int

    def __str__(self) -> str:
        return f"{self.top}:{self.bottom},{self.left}:{self.right}"

    @property
    def pixels(self) -> int:
        """Number of pixels."""
        return (self.bottom - self.top) * (self.right - self.left)

    def of(self, frames: NDArray[np.floating]) -> NDArray[np.floating]:
        """The region of frames (..., rows, columns)."""
        return frames[..., self.top : self.bottom, self.left : self.right]


def parse_region(text: str, rows: int, columns: int) -> Region:
    """Region from ``ROWS,COLUMNS``, each FIRST:END in pixels, either end left out for the border.

    Raises
    ------
    DataError
        Text of another form, or a region outside the picture.

    Examples
    --------
    >>> str(parse_region("20:,:64", 100, 80))
    '20:100,0:64'
    """
    parts = text.split(",")
    try:
        if len(parts) != 2 or any(part.count(":") != 1 for part in parts):
            raise ValueError
        ends = [part.split(":") for part in parts]
        top, left = (int(first or 0) for first, _ in ends)
        bottom, right = (int(last) if last else size for (_, last), size in zip(ends, (rows, columns), strict=True))
    except ValueError:
        raise DataError(f"--region {text}: give rows and columns in pixels as FIRST:END,FIRST:END, e.g. 120:248,64:192") from None
    if not (0 <= top < bottom <= rows and 0 <= left < right <= columns):
        raise DataError(f"--region {text}: the picture has {rows} rows and {columns} columns; give FIRST below END within them")
    return Region(top, bottom, left, right)


def require_values(frames: ArrayLike) -> None:
    """Refuse pictures that no texture can be fitted to.

    Parameters
    ----------
    frames : array_like, shape (frames, rows, columns)
        Of the region [u].

    Raises
    ------
    DataError
        Too small, missing values, all values equal, or only two of them.
    """
    x = np.asarray(frames)
    rows, columns = x.shape[-2:]
    if min(rows, columns) < SMALLEST_SIDE:
        raise DataError(
            f"{rows} x {columns} pixels are too few for a texture; choose a region of {SMALLEST_SIDE} x {SMALLEST_SIDE} or more"
        )
    missing = int(x.size - np.count_nonzero(np.isfinite(x)))
    if missing:
        bad = ~np.isfinite(x).all(axis=tuple(range(x.ndim - 2)))
        where = np.argwhere(bad)[0]
        raise DataError(
            f"{missing} values are missing or infinite (the first in row {where[0]}, column {where[1]} of the region); "
            "choose a region without them"
        )
    few = np.unique(x[:1] if x.size > 10_000_000 else x)[:3]
    if few.size == 1:
        raise DataError(f"all values are {few[0]:g}: there is no texture to fit; choose another region")
    if few.size == 2:
        raise DataError(
            f"there are two values only, {few[0]:g} and {few[1]:g} (a mask, or a saturated picture); give the picture itself, or model "
            "autobinomial with 2 levels"
        )


def examine(frames: NDArray[np.floating], seed: int = 0) -> Stationarity:
    """Test of stationarity of a region, shape (frames, rows, columns), with the correlation lengths of its own."""
    some = frames[np.unique(np.linspace(0, len(frames) - 1, min(len(frames), FEW)).astype(int))]
    # A slow change of brightness must not pass for a correlation as long as the picture: blocks would be too large to see it.
    found = spatial_correlation(some, mean=trend_surface(some.mean(axis=0)))
    return stationarity(some, length_x=found.length_x, length_y=found.length_y, permutations=PERMUTATIONS, seed=seed)


def stationary_region(frames: NDArray[np.floating], seed: int = 0) -> Region | None:
    """Largest region that passes the test of stationarity, of a few sizes and places; None where there is none."""
    rows, columns = frames.shape[-2:]
    for share in SHARES:
        passed: list[tuple[float, Region]] = []
        for region in _places(rows, columns, share):
            found = examine(region.of(frames), seed)
            if found.stationary:
                passed.append((min(found.p_mean, found.p_variance), region))
        if passed:
            return max(passed, key=lambda pair: pair[0])[1]
    return None


def _places(rows: int, columns: int, share: float) -> Iterator[Region]:
    height, width = (max(int(share * n), SMALLEST_SIDE) for n in (rows, columns))
    if height > rows or width > columns:
        return
    for top in np.unique(np.linspace(0, rows - height, STEPS).astype(int)):
        for left in np.unique(np.linspace(0, columns - width, STEPS).astype(int)):
            yield Region(int(top), int(top) + height, int(left), int(left) + width)


def require_stationary(frames: NDArray[np.floating], seed: int = 0) -> tuple[str, ...]:
    """Refuse a picture whose mean or variance is not the same everywhere, and name the part to choose.

    Returns
    -------
    tuple of str
        Notes, where the test cannot decide.

    Raises
    ------
    DataError
        Not stationary.
    """
    found = examine(frames, seed)
    if found.stationary is None:
        return (f"whether the texture is stationary was not tested: {found.reason}",)
    if found.stationary:
        return ()
    what = " and ".join(f"{name} (p = {p:.2g})" for name, p in (("mean", found.p_mean), ("variance", found.p_variance)) if p <= 0.025)
    region = stationary_region(frames, seed)
    advice = f"choose --region {region}" if region is not None else "no part of it is either: choose a smaller --region"
    raise DataError(
        f"the picture is not stationary: its {what} differ from place to place, in blocks of {found.block[0]} x {found.block[1]} pixels; "
        f"{advice}, or --any-region to fit one texture all the same"
    )
