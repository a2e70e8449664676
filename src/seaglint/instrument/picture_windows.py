"""Parts of a picture: added to it, cut and joined, round its seam where it closes on itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray

#: First row and first column of a part of a picture, which may lie outside it, and values of its pixels (rows, columns).
PictureWindow = tuple[int, int, NDArray[np.float32]]


def add_window(picture: FloatArray, window: PictureWindow, circle: int) -> None:
    """Add a window to a picture (rows, columns); ``circle``: columns of a full circle, 0 where there is none."""
    row, column, values = window
    first, end = max(row, 0), min(row + values.shape[0], picture.shape[0])
    if first >= end:
        return
    inside = values[first - row : end - row]
    columns = column + np.arange(values.shape[1])
    if circle:
        for k in range(-(-columns.size // circle)):  # a window may be wider than the circle
            some = slice(k * circle, (k + 1) * circle)
            picture[first:end, columns[some] % circle] += inside[:, some]
        return
    keep = (columns >= 0) & (columns < picture.shape[1])
    picture[first:end, columns[keep]] += inside[:, keep]


def part_of(window: PictureWindow, rows: tuple[int, int] | None, columns: tuple[int, int] | None) -> PictureWindow:
    """Part of a window in some rows and columns (first and end; None for all)."""
    row, column, values = window
    if rows is not None:
        first, end = max(rows[0], row), min(rows[1], row + values.shape[0])
        values, row = values[max(first - row, 0) : max(end - row, 0)], first
    if columns is not None:
        first, end = max(columns[0], column), min(columns[1], column + values.shape[1])
        values, column = values[:, max(first - column, 0) : max(end - column, 0)], first
    return row, column, values


def sum_of(windows: list[PictureWindow], shape: tuple[int, ...], circle: int) -> PictureWindow | None:
    """Sum of windows in a picture of ``shape`` (rows, columns); None where none of them is in it."""
    if not windows:
        return None
    about = windows[0][1]
    moved = [(row, about + (column - about + circle // 2) % circle - circle // 2 if circle else column, v) for row, column, v in windows]
    top, left = max(min(row for row, _, _ in moved), 0), min(column for _, column, _ in moved)
    bottom = min(max(row + v.shape[0] for row, _, v in moved), shape[0])
    right = max(column + v.shape[1] for _, column, v in moved)
    if not circle:
        left, right = max(left, 0), min(right, shape[1])
    if top >= bottom or left >= right:
        return None
    whole = np.zeros((bottom - top, right - left))
    for row, column, values in moved:
        add_window(whole, (row - top, column - left, values), 0)
    return top, left, whole.astype(np.float32)
