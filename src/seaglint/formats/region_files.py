"""Files of regions of pictures: an image or a NumPy array of numbers, or JSON with names and rectangles."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.formats.recording import open_recording
from seaglint.store.outputs import read_text


def read_regions(path: str | Path) -> NDArray[Any] | dict[str, Any]:
    """Return what a file of regions holds.

    Parameters
    ----------
    path : path
        An image or ``.npy`` with a whole number for each pixel, or ``.json`` with one object of names and rectangles
        (``{"near": "120:256,:"}``).

    Returns
    -------
    ndarray or dict
        Numbers, shape (rows, columns), or rectangles by name.

    Raises
    ------
    DataError
        A file that cannot be read, several frames, names that are given twice, or another kind of JSON.
    """
    path = Path(path)
    if path.suffix.lower() == ".json":
        return _rectangles(path)
    return _image(path, "regions are")


def read_mask(path: str | Path) -> NDArray[np.bool_]:
    """Return a mask from an image or a NumPy file: true where it is not zero.

    Raises
    ------
    DataError
        A file that cannot be read, or several frames.
    """
    return np.asarray(np.nan_to_num(_image(Path(path), "a mask is")) != 0)


def _image(path: Path, what: str) -> NDArray[Any]:
    """Return the numbers of a single image."""
    opened = open_recording(path, channel=None)
    if opened.frames != 1:
        raise DataError(f"{path}: {what} one image, this has {opened.frames} frames")
    return np.asarray(opened.read_block(0, 1)[0])


def _rectangles(path: Path) -> dict[str, Any]:
    """Return the names and rectangles of a JSON file."""
    form = 'give an object of names and rectangles such as {"near": "120:256,:"}'

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        names = [name for name, _ in pairs]
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise DataError(f"{path}: the region {twice} is there twice; give each name once")
        return dict(pairs)

    try:
        table = json.loads(read_text(path, form), object_pairs_hook=once)
    except ValueError as error:
        raise DataError(f"{path}: is not JSON ({str(error).splitlines()[0]}); {form}") from error
    if not isinstance(table, dict) or not table:
        raise DataError(f"{path}: holds no object with names; {form}")
    for name, value in table.items():
        if not isinstance(value, str):
            raise DataError(f"{path}: the region {name} is {value!r:.40}; {form}")
    return table
