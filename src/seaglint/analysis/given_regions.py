"""Regions that a user gives: a number for each pixel, or rectangles and masks by name."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import Any, Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.clutter.correlation import BoolArray
from seaglint.textures.suitability import parse_region

MOST_REGIONS: Final = 50  #: Largest number of given regions.

RESERVED: Final = ("all", "glint", "background")  #: Names that given regions cannot have: of all pixels, and of the segmentation.

_FORMS: Final = "give whole numbers, 0 outside all regions, or names with rectangles such as 120:256,64:192"


def given_regions(given: Any, rows: int, columns: int) -> tuple[dict[str, BoolArray], list[str]]:
    """Return the masks of given regions by name, and notes on pixels that several of them have.

    Parameters
    ----------
    given : array_like or mapping
        Numbers (rows, columns): pixels of 0 are in no region, those of another number are the region of this name. Or names with
        rectangles ``ROWS,COLUMNS`` (``seaglint.textures.suitability.parse_region``) or masks (rows, columns).
    rows, columns : int
        Size of the frames [px].

    Returns
    -------
    masks : dict of str to ndarray of bool
        Masks, shape (rows, columns).
    notes : list of str
        A sentence for each pair of regions that overlap.

    Raises
    ------
    DataError
        Another size, numbers that are negative or not whole, no region, too many, or a name of ``RESERVED``.
    """
    masks = _named(given, rows, columns) if isinstance(given, Mapping) else _numbered(given, rows, columns)
    if len(masks) > MOST_REGIONS:
        raise DataError(f"regions: {len(masks)} of them; give at most {MOST_REGIONS}")
    if not any(mask.any() for mask in masks.values()):
        raise DataError(f"regions: no pixel is in any region; {_FORMS}")
    shared = {pair: int((masks[pair[0]] & masks[pair[1]]).sum()) for pair in combinations(masks, 2)}
    return masks, [
        f"regions {first} and {second} share {count} pixels, which are counted in both"
        for (first, second), count in shared.items()
        if count
    ]


def _numbered(given: Any, rows: int, columns: int) -> dict[str, BoolArray]:
    """Return the masks of an array of numbers."""
    numbers = np.asarray(given)
    _require_size("regions", numbers, rows, columns)
    if not (np.issubdtype(numbers.dtype, np.number) or numbers.dtype == np.bool_) or np.iscomplexobj(numbers):
        raise DataError(f"regions: values of type {numbers.dtype}; {_FORMS}")
    wrong = numbers[~(np.isfinite(numbers) & (numbers >= 0) & (numbers == np.floor(np.where(np.isfinite(numbers), numbers, 0))))]
    if wrong.size:
        raise DataError(f"regions: {wrong.size} values are negative or not whole, the first {wrong[0]:g}; {_FORMS}")
    levels = [int(level) for level in np.unique(numbers) if level > 0]
    if len(levels) > MOST_REGIONS:
        raise DataError(f"regions: {len(levels)} different numbers above 0; give at most {MOST_REGIONS} regions")
    return {str(level): numbers == level for level in levels}


def _named(given: Mapping[Any, Any], rows: int, columns: int) -> dict[str, BoolArray]:
    """Return the masks of rectangles and masks by name."""
    masks: dict[str, BoolArray] = {}
    for name, value in given.items():
        if not isinstance(name, str) or not name.strip() or len(name) > 40 or not name.isprintable():
            raise DataError(f"regions: the name {name!r}; give a text of 1 to 40 characters in one line")
        if name in RESERVED:
            raise DataError(f"regions: the name {name} is in use ({', '.join(RESERVED)}); give another one")
        if isinstance(value, str):
            try:
                place = parse_region(value, rows, columns)
            except DataError as error:
                raise DataError(f"regions, {name}: {error}") from None
            mask = np.zeros((rows, columns), np.bool_)
            mask[place.top : place.bottom, place.left : place.right] = True
        else:
            mask = np.asarray(value)
            _require_size(f"regions, {name}", mask, rows, columns)
            if not (np.issubdtype(mask.dtype, np.number) or mask.dtype == np.bool_):
                raise DataError(f"regions, {name}: {value!r:.40}; {_FORMS}")
            mask = np.nan_to_num(mask) != 0
        masks[name] = mask
    return masks


def _require_size(name: str, values: Any, rows: int, columns: int) -> None:
    """Refuse an array of another size than the frames."""
    if values.shape != (rows, columns):
        size = " x ".join(map(str, values.shape)) or "one value"
        raise DataError(f"{name}: {size}, the frames have {rows} x {columns} pixels (rows x columns); give one value for each pixel")
