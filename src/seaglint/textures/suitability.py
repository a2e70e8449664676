"""Check whether a picture can be the sample of a stationary texture, and search for a part that can."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.clutter.correlation import spatial_correlation, trend_surface

SMALLEST_SIDE: Final = 24  #: Least number of rows and columns for fitting a texture [px]: six times the farthest neighbour.

SHARES: Final = (0.75, 0.5, 0.375, 0.25)  #: Sides of the regions searched where the whole is not stationary, as shares of the picture's.

STEPS: Final = 5  #: Number of places of a region of one size along each side.

FEW: Final = 8  #: Number of frames in which slow changes are measured; those between them add little.

#: Limits of slow changes that are reported: share of the variance, and ratio of the largest to the smallest standard deviation.
REPORTED: Final = (0.1, 1.4)

#: Limits of slow changes beyond which a picture is refused: a fit's correlations then differ from the data's by more than 0.1.
REFUSED: Final = (0.5, 2.0)

TERMS: Final = 14  #: Number of coefficients without the constant of the surface for the slow change, of degree 4.

PARTS: Final = 3  #: Number of rows and columns of parts whose standard deviations are compared.

FULL_PART: Final = 0.5  #: Least share of the pixels of a part that have a value.

MOST_MISSING: Final = 0.5  #: Largest share of a region's values that may be missing or masked.

SAMPLED: Final = 64  #: Number of rows and columns in which slow changes are measured, evenly spread over the region.

#: Upper 95 % of chi-square with ``TERMS`` degrees of freedom over its mean, and of the range of 9 normal deviates.
BY_CHANCE: Final = (1.7, 4.4)

#: Largest allowance for chance; a region of a few correlation lengths resembles a slow change and is no texture either.
MOST_BY_CHANCE: Final = (0.2, 2.0)


@dataclass(frozen=True)
class PixelRegion:
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
        """Return the frames (..., rows, columns) inside the region."""
        return frames[..., self.top : self.bottom, self.left : self.right]


def parse_region(text: str, rows: int, columns: int) -> PixelRegion:
    """Region from ``ROWS,COLUMNS``, each FIRST:END in pixels; an end that is left out is the border.

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
        raise DataError(f"region = {text}: give rows and columns in pixels as FIRST:END,FIRST:END, e.g. 120:248,64:192") from None
    if not (0 <= top < bottom <= rows and 0 <= left < right <= columns):
        raise DataError(f"region = {text}: the picture has {rows} rows and {columns} columns; give FIRST below END within them")
    return PixelRegion(top, bottom, left, right)


def whole_region(frames: NDArray[np.floating]) -> PixelRegion | None:
    """Return the largest rectangle without a pixel that is NaN in any frame; None if there is none.

    Examples
    --------
    >>> image = np.zeros((1, 4, 5))
    >>> image[0, 1, 1] = np.nan
    >>> str(whole_region(image))
    '0:4,2:5'
    """
    clear = np.isfinite(frames).all(axis=0)
    if clear.all():
        return PixelRegion(0, clear.shape[0], 0, clear.shape[1])
    best: PixelRegion | None = None
    heights = np.zeros(clear.shape[1] + 1, np.int64)
    for row, line in enumerate(clear):
        heights[:-1] = np.where(line, heights[:-1] + 1, 0)
        # Columns of rising heights; a lower one closes the rectangles that end before it.
        rising: list[tuple[int, int]] = []
        for column, height in enumerate(heights.tolist()):
            first = column
            while rising and rising[-1][1] >= height:
                first, tall = rising.pop()
                if tall and (best is None or tall * (column - first) > best.pixels):
                    best = PixelRegion(row + 1 - tall, row + 1, first, column)
            rising.append((first, height))
    return best


def require_values(frames: ArrayLike, *, two: bool = False) -> None:
    """Refuse pictures to which no texture can be fitted.

    Parameters
    ----------
    frames : array_like, shape (frames, rows, columns)
        Frames of the region [u]; NaN where a pixel does not count.
    two : bool
        Whether two values are enough: for an autobinomial field of two levels.

    Raises
    ------
    DataError
        Too small, infinite values, more than half of them missing, all values equal, or only two of them.
    """
    x = np.asarray(frames)
    rows, columns = x.shape[-2:]
    if min(rows, columns) < SMALLEST_SIDE:
        raise DataError(
            f"{rows} x {columns} pixels are too few for a texture; choose a region of {SMALLEST_SIDE} x {SMALLEST_SIDE} or more"
        )
    missing = int(np.count_nonzero(np.isnan(x)))
    if missing == x.size:
        raise DataError("all pixels of the region are masked or missing: there is no texture to fit; choose another region or mask")
    if missing > MOST_MISSING * x.size:
        raise DataError(
            f"{100.0 * missing / x.size:.0f} % of the region is masked or missing, and a texture needs half of it; choose another region "
            "or mask"
        )
    if np.isinf(x).any():
        where = np.argwhere(np.isinf(x).any(axis=tuple(range(x.ndim - 2))))[0]
        raise DataError(f"values are infinite (the first in row {where[0]}, column {where[1]} of the region); mask them")
    # One frame suffices for a large recording, whose sorting would take seconds.
    few = np.unique(x[:1] if x.size > 10_000_000 else x)
    few = few[~np.isnan(few)][:3]
    if few.size == 1:
        raise DataError(f"all values are {few[0]:g}: there is no texture to fit; choose another region")
    if few.size == 2 and not two:
        raise DataError(
            f"there are two values only, {few[0]:g} and {few[1]:g} (a mask, or a saturated picture); give the picture itself, or fit "
            "an autobinomial field: model = 'autobinomial', levels = 2"
        )


@dataclass(frozen=True)
class Changes:
    """Slow changes of a picture from place to place, less the changes that correlated pixels have by chance.

    They are sizes of effects and not levels of a test: in a large picture the least change is significant, and every measured sea has one.
    """

    mean: float  #: Share of the variance in a surface of degree 4 through the mean [1].
    spread: float  #: Largest over smallest standard deviation of nine parts, less that surface [1].

    def beyond(self, limits: tuple[float, float]) -> bool:
        """True if one of the two is above its limit."""
        return self.mean > limits[0] or self.spread > limits[1]

    @property
    def text(self) -> str:
        """Slow changes in words."""
        messages = []
        if self.mean > REPORTED[0]:
            messages.append(f"mean changes slowly from place to place ({100.0 * self.mean:.0f} % of the variance)")
        if self.spread > REPORTED[1]:
            messages.append(f"variance differs from place to place (standard deviations of its parts by a factor of {self.spread:.2g})")
        return " and its ".join(messages)


def examine(frames: NDArray[np.floating]) -> Changes:
    """Measure the slow changes of a region, shape (frames, rows, columns)."""
    some = np.asarray(frames[np.unique(np.linspace(0, len(frames) - 1, min(len(frames), FEW)).astype(int))], np.float64)
    # Slow changes need no more than some evenly spread rows and columns.
    some = some[:, :: max(some.shape[1] // SAMPLED, 1), :: max(some.shape[2] // SAMPLED, 1)]
    if np.isnan(some).any():
        return _examine_with_gaps(some)
    variance = float(some.var())
    if not variance > 0.0:
        return Changes(0.0, 1.0)
    surface = trend_surface(some.mean(axis=0))
    near = spatial_correlation(some, mean=surface)
    # Number of pixels per independent value.
    area = float(np.nan_to_num(max(near.scale_x, 1.0) * max(near.scale_y, 1.0), nan=np.inf))
    left = some - surface
    share = float(surface.var()) / variance - min(TERMS * BY_CHANCE[0] * area / surface.size, MOST_BY_CHANCE[0])
    deviations = [float(part.std()) for part in _parts(left)]
    kurtosis = float((left**4).mean()) / float((left**2).mean()) ** 2
    return _changes(share, deviations, kurtosis, area / surface.size)


def _parts(left: FloatArray) -> list[FloatArray]:
    return [part for rows in np.array_split(left, PARTS, axis=1) for part in np.array_split(rows, PARTS, axis=2)]


def _examine_with_gaps(some: FloatArray) -> Changes:
    """Measure the slow changes over the pixels that are not NaN; parts with few of them are left out."""
    exist = np.isfinite(some)
    pixels = np.asarray(exist.any(axis=0))
    count = int(np.count_nonzero(pixels))
    variance = float(some[exist].var()) if count else 0.0
    if not variance > 0.0:
        return Changes(0.0, 1.0)
    mean = np.where(exist, some, 0.0).sum(axis=0) / np.maximum(exist.sum(axis=0), 1)
    surface = trend_surface(mean, pixels)
    near = spatial_correlation(some, mean=surface)
    area = float(np.nan_to_num(max(near.scale_x, 1.0) * max(near.scale_y, 1.0), nan=np.inf))
    left = some - surface
    share = float(surface[pixels].var()) / variance - min(TERMS * BY_CHANCE[0] * area / count, MOST_BY_CHANCE[0])
    # A part of which half is missing has a standard deviation by chance.
    whole = [part[np.isfinite(part)] for part in _parts(left) if np.isfinite(part).mean() >= FULL_PART]
    rest = left[exist]
    kurtosis = float((rest**4).mean()) / float((rest**2).mean()) ** 2
    return _changes(share, [float(part.std()) for part in whole], kurtosis, area / count)


def _changes(share: float, deviations: list[float], kurtosis: float, part: float) -> Changes:
    """Return changes from the share of the surface, the parts' deviations, and the share of the pixels of one independent value."""
    if not deviations:
        return Changes(max(share, 0.0), 1.0)
    if not min(deviations) > 0.0:
        return Changes(max(share, 0.0), math.inf)
    # The scatter of a standard deviation follows from the kurtosis and the number of independent values of a part.
    scatter = math.sqrt(max(kurtosis - 1.0, 0.0) * PARTS**2 * part / 4.0)
    return Changes(max(share, 0.0), max(max(deviations) / min(deviations) / min(math.exp(BY_CHANCE[1] * scatter), MOST_BY_CHANCE[1]), 1.0))


def even_region(frames: NDArray[np.floating]) -> PixelRegion | None:
    """Largest region without reportable slow changes, of a few sizes and places; None without one."""
    rows, columns = frames.shape[-2:]
    for share in SHARES:
        passed = [
            (changes.mean / REPORTED[0] + changes.spread / REPORTED[1], region)
            for region in _places(rows, columns, share)
            if not (changes := examine(region.of(frames))).beyond(REPORTED)
        ]
        if passed:
            return min(passed, key=lambda pair: pair[0])[1]
    return None


def _places(rows: int, columns: int, share: float) -> Iterator[PixelRegion]:
    height, width = (max(int(share * n), SMALLEST_SIDE) for n in (rows, columns))
    if height > rows or width > columns:
        return
    for top in np.unique(np.linspace(0, rows - height, STEPS).astype(int)):
        for left in np.unique(np.linspace(0, columns - width, STEPS).astype(int)):
            yield PixelRegion(int(top), int(top) + height, int(left), int(left) + width)


def require_stationary(frames: NDArray[np.floating], within: PixelRegion | None = None, *, detrended: bool = False) -> tuple[str, ...]:
    """Refuse a picture whose mean or variance changes grossly across it (a horizon, a shore), and suggest a part to choose.

    Parameters
    ----------
    frames : ndarray, shape (frames, rows, columns)
        Frames of the region [u].
    within : PixelRegion, optional
        The region in the picture, so that the part is named in rows and columns of the picture; the frames by default.
    detrended : bool
        Whether slow changes were removed already.

    Returns
    -------
    tuple of str
        Notes on smaller changes, with the part that has none.

    Raises
    ------
    DataError
        Not stationary.
    """
    changes = examine(frames)
    if not changes.beyond(REPORTED):
        return ()
    even = even_region(frames)
    if even is not None and within is not None:
        even = PixelRegion(within.top + even.top, within.top + even.bottom, within.left + even.left, within.left + even.right)
    if not changes.beyond(REFUSED):
        advice = "no part of it is even" if even is None else f"--region {even} is even"
        return (f"the picture's {changes.text}; {advice}" + ("" if detrended else ", and --detrend takes such changes off"),)
    advice = "no part of it is even: choose a smaller region" if even is None else f"choose region = '{even}'"
    raise DataError(
        f"the picture is not stationary: its {changes.text}; {advice}, "
        + ("" if detrended else "take slow changes off with detrend=True, ")
        + "or fit one texture all the same with any_region=True"
    )
