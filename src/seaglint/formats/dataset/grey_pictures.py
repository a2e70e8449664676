"""Grey pictures of a data set in 8 or 16 bits, as PNG or TIFF, with the relations from a level to counts and radiance; masks as text.

The relations are stored as PNG text, or as JSON in a TIFF's ImageDescription. Masks are COCO's run lengths: columns first, from the upper
left corner, as numbers or as the text that pycocotools reads.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import BackendError, DataError
from seaglint.base.optional import optional
from seaglint.store.outputs import moved_when_whole

Bits = Literal[8, 16]

#: Strategy of deflate that seeks runs of one byte alone (zlib's ``Z_RLE``), as noise has no longer repetitions. A picture of 640 x 512
#: counts of 14 bits takes 12 ms and 47.3 % of its size, with all repetitions 76 ms and 46.2 %; in 8 bits 4 ms and 15.9 %, 12 ms and 16.4 %.
RUNS: Final = 3


@dataclass(frozen=True)
class PictureLevels:
    """Linear relation of one scene's levels, the same for all of its frames: ``value = offset + scale * level``."""

    bits: Bits  #: Bits of a level.
    scale: float  #: Step of a level, in the values that the levels were made of: counts, or radiance [W m-2 sr-1].
    offset: float  #: Value of level 0, in the same unit.
    radiance_scale: float  #: Radiance of a step [W m-2 sr-1].
    radiance_offset: float  #: Radiance of level 0 [W m-2 sr-1].
    counts: bool  #: True where the levels were made from a detector's counts.

    @classmethod
    def of_counts(cls, low: int, high: int, bits: Bits, line: tuple[float, float]) -> PictureLevels:
        """Return the levels of counts between ``low`` and ``high``, whose radiance is ``line[0] * count + line[1]``.

        In 16 bits levels are the counts themselves. In 8 bits the scene's least to greatest count fill the levels; steps are never finer
        than a count.

        >>> PictureLevels.of_counts(1000, 1100, 8, (2.0, 5.0)).radiance_offset
        2005.0
        """
        scale, offset = (1.0, 0.0) if bits == 16 else (max((high - low) / 255.0, 1.0), float(low))
        return cls(bits, scale, offset, line[0] * scale, line[0] * offset + line[1], True)

    @classmethod
    def of_radiance(cls, low: float, high: float, bits: Bits) -> PictureLevels:
        """Return the levels of radiance between ``low`` and ``high`` [W m-2 sr-1], which fill their range."""
        # A scene of one value would have steps of 0.
        scale = (high - low) / ((1 << bits) - 1) or 1.0
        return cls(bits, scale, low, scale, low, False)

    def of(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return the nearest levels of counts or radiance.

        Raises
        ------
        DataError
            A value that is no number or beyond the levels.
        """
        levels = np.rint((np.asarray(values, np.float64) - self.offset) / self.scale)
        if not (np.isfinite(levels).all() and levels.min() >= 0 and levels.max() < 1 << self.bits):
            raise DataError("the picture has values that are no numbers or beyond the scene's range; render the scene again")
        return levels.astype(np.uint8 if self.bits == 8 else np.uint16)

    @property
    def attributes(self) -> dict[str, float | int | str]:
        """Return the relations by their names in tables and pictures."""
        lines: dict[str, float | int | str] = {
            "bits": self.bits,
            "radiance_scale": self.radiance_scale,
            "radiance_offset": self.radiance_offset,
            "radiance_units": "W m-2 sr-1",
        }
        return {**lines, "count_scale": self.scale, "count_offset": self.offset} if self.counts else lines


ImageKind = Literal["png", "tiff"]


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
