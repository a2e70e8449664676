"""Masks as COCO's run lengths: columns first, from the upper left corner, as numbers or as the text that pycocotools reads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError


def compressed(runs: Sequence[int]) -> str:
    """Return run lengths as text: differences to the length before the last, five bits a character, least first (COCO's ``rleToString``).

    >>> compressed([6, 1, 40, 4, 5, 4, 5, 4, 21])
    '61X13mN000`0'
    """
    out = []
    for i, run in enumerate(runs):
        rest, more = run - (runs[i - 2] if i > 2 else 0), True
        while more:
            bits = rest & 0x1F
            rest >>= 5
            more = rest != (-1 if bits & 0x10 else 0)
            out.append(chr(48 + (bits | 0x20 if more else bits)))
    return "".join(out)


def expanded(text: str) -> list[int]:
    """Return the run lengths of :func:`compressed` text.

    >>> expanded("61X13mN000`0")
    [6, 1, 40, 4, 5, 4, 5, 4, 21]
    """
    runs: list[int] = []
    place = 0
    while place < len(text):
        value, shift, more = 0, 0, True
        while more:
            bits = ord(text[place]) - 48
            value |= (bits & 0x1F) << shift
            more, shift, place = bool(bits & 0x20), shift + 5, place + 1
            if not more and bits & 0x10:
                value |= -1 << shift
        runs.append(value + (runs[-2] if len(runs) > 2 else 0))
    return runs


def decoded(text: str, shape: tuple[int, int]) -> NDArray[np.bool_]:
    """Return the mask of ``shape`` rows and columns.

    Raises
    ------
    DataError
        Text that is no mask of this shape.
    """
    rows, columns = shape
    try:
        runs = expanded(text)
    except (IndexError, TypeError) as error:
        raise DataError("its run lengths are cut") from error
    if min(runs, default=0) < 0 or sum(runs) != rows * columns:
        raise DataError(f"its run lengths are not those of {columns} x {rows} pixels")
    flat = np.repeat(np.arange(len(runs)) % 2 == 1, runs)
    return flat.reshape(columns, rows).T


def box_of(mask: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """Return first column and row of a mask that is not empty, and the columns and rows that it spans."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return int(columns[0]), int(rows[0]), int(np.ptp(columns)) + 1, int(np.ptp(rows)) + 1
