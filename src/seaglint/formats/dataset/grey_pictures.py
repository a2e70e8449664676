"""Grey pictures of a data set in 8 or 16 bits, as PNG or TIFF, with text; masks as text.

The relations from a level to counts and radiance are stored as PNG text, or as JSON in a TIFF's ImageDescription. Masks are COCO's run
lengths: columns first, from the upper left corner, as numbers or as the text that pycocotools reads.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import BackendError, DataError
from seaglint.base.optional import optional
from seaglint.store.outputs import moved_when_whole

#: Strategy of deflate that seeks runs of one byte alone (zlib's ``Z_RLE``), as noise has no longer repetitions. A picture of 640 x 512
#: counts of 14 bits takes 12 ms and 47.3 % of its size, with all repetitions 76 ms and 46.2 %; in 8 bits 4 ms and 15.9 %, 12 ms and 16.4 %.
RUNS: Final = 3


def write_picture(path: Path, levels: NDArray[Any], about: Mapping[str, Any]) -> None:
    """Write levels [uint8 or uint16, (rows, columns)]; equal levels and text are equal bytes.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    with moved_when_whole(path) as partial:
        if path.suffix == ".png":
            from PIL import Image
            from PIL.PngImagePlugin import PngInfo

            text = PngInfo()
            for name, value in about.items():
                text.add_text(name, repr(value) if isinstance(value, float) else str(value))
            Image.fromarray(levels).save(partial, format="PNG", pnginfo=text, compress_level=6, compress_type=RUNS)
        else:
            tifffile = optional("tifffile", f"{path}: TIFF")

            with tifffile.TiffWriter(partial) as file:
                # no date and no program: the same picture is the same file
                file.write(levels, photometric="minisblack", metadata=None, software="seaglint", description=json.dumps(dict(about)))


def read_picture(path: Path) -> NDArray[Any]:
    """Read the levels of a picture [(rows, columns)].

    Raises
    ------
    DataError
        It is not there, cannot be read, or is no grey picture.
    """
    try:
        if path.suffix == ".png":
            from PIL import Image

            with Image.open(path) as image:
                grey = image.mode in ("L", "I;16")
                levels = np.asarray(image)
        else:
            levels = optional("tifffile", f"{path}: TIFF").imread(path)
            grey = levels.ndim == 2
    except BackendError:
        raise
    except Exception as error:  # picture readers raise nearly anything
        raise DataError(f"{path}: cannot be read as a picture ({type(error).__name__}: {error})") from error
    if not grey:
        raise DataError(f"{path}: is no grey picture of 8 or 16 bits")
    return levels


def read_about(path: Path) -> dict[str, str]:
    """Read the text of a picture by name."""
    if path.suffix == ".png":
        from PIL import Image

        with Image.open(path) as image:
            image.load()
            return {str(name): str(value) for name, value in image.info.items()}
    tifffile = optional("tifffile", f"{path}: TIFF")

    with tifffile.TiffFile(path) as file:
        return {name: str(value) for name, value in json.loads(file.pages.first.description).items()}


def compressed(runs: Sequence[int]) -> str:
    """Return run lengths as text: differences to the length before the last, five bits a character, least first (COCO's ``rleToString``).

    >>> compressed([6, 1, 40, 4, 5, 4, 5, 4, 21])
    '61X13mN000`0'
    """
    out = []
    for i, run in enumerate(runs):
        # Runs alternate outside and inside: the one before the last is of the same kind, so that the difference is small.
        rest, more = run - (runs[i - 2] if i > 2 else 0), True
        while more:
            bits = rest & 0x1F
            rest >>= 5
            more = rest != (-1 if bits & 0x10 else 0)
            out.append(chr(48 + (bits | 0x20 if more else bits)))
    return "".join(out)


def expanded(text: str) -> list[int]:
    """Return the run lengths of ``compressed`` text.

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
                value |= -1 << shift  # the highest of the last five bits is the sign
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
    # Runs alternate, the first one outside the mask.
    return np.repeat(np.arange(len(runs)) % 2 == 1, runs).reshape(columns, rows).T


def box_of(mask: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """Return first column and row of a mask that is not empty, and the columns and rows that it spans."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return int(columns[0]), int(rows[0]), int(np.ptp(columns)) + 1, int(np.ptp(rows)) + 1
