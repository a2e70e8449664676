"""TIFF: a page for each frame, uncompressed, which every reader opens, calibrated as ImageJ reads it.

What else is known stands as JSON in ImageJ's Info.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

from seaglint.base.optional import optional
from seaglint.files.export.export_format import ExportFormat
from seaglint.version import __version__

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seaglint.files.export.encoding import NumberFormat
    from seaglint.files.export.stack import Stack

#: Bytes that places of 32 bits reach, less the pages' own tables; larger files are BigTIFF, which ImageJ does not read alone.
_SMALL: Final = (1 << 32) - (1 << 25)

#: Types of numbers that ImageJ has; files of others, and BigTIFF, hold the JSON as their description.
_IMAGEJ: Final = ("uint8", "uint16", "float32")


class Tiff(ExportFormat):
    """Stack of TIFF pages."""

    endings: ClassVar[tuple[str, ...]] = (".tif",)
    aliases: ClassVar[tuple[str, ...]] = (".tiff",)

    @classmethod
    def require(cls) -> None:
        """Refuse before the work where TIFF cannot be written.

        Raises
        ------
        BackendError
            tifffile is not installed.
        """
        optional("tifffile", "TIFF")

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write a page for each frame."""
        _write(path, stack, numbers, frames)


def _write(path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
    tifffile = optional("tifffile", "TIFF")

    count, rows, columns = stack.shape
    text = json.dumps({**stack.metadata(), **numbers.attributes}, allow_nan=False)
    # A page takes its pixels and a table of some 300 bytes.
    big = count * (rows * columns * numbers.dtype.itemsize + 512) + len(text) > _SMALL
    known = numbers.dtype in _IMAGEJ and not big
    about: dict[str, Any] = {"description": text, "metadata": None}
    if known:
        about = {"metadata": _calibration(stack, numbers, text), "resolution": _per_pixel(stack)}
    with tifffile.TiffWriter(path, bigtiff=big, imagej=known) as file:
        file.write(
            iter(frames), shape=stack.shape, dtype=numbers.dtype, photometric="minisblack", software=f"seaglint {__version__}", **about
        )


def _calibration(stack: Stack, numbers: NumberFormat, text: str) -> dict[str, Any]:
    """Properties that ImageJ reads: unit of length, interval of the frames [s], unit and straight line of the values."""
    values: dict[str, Any] = {"vunit": stack.units or "Gray Value"}
    if numbers.counts is not None:  # function 0 is a straight line from c0 with slope c1
        values = {"cf": 0, "c0": numbers.counts.offset, "c1": numbers.counts.scale, **values}
    rate = stack.frame_rate
    times = {} if rate is None else {"finterval": 1.0 / rate, "fps": rate}
    unit = "pixel" if _steps(stack) is None else "deg"
    return {"axes": "TYX", "unit": unit, **times, **values, "Info": text}


def _steps(stack: Stack) -> tuple[float, float] | None:
    """Angle between columns and between rows [deg] where they are even; None for other cameras."""
    axes = [stack.dataset.coords.get(name) for name in ("azimuth", "elevation")]
    if any(axis is None or axis.ndim != 1 or axis.size < 2 for axis in axes):
        return None
    across, down = (abs(float(axis[-1] - axis[0])) / (axis.size - 1) for axis in axes if axis is not None)
    return across, down


def _per_pixel(stack: Stack) -> tuple[float, float]:
    """Pixels per unit of length along columns and rows."""
    steps = _steps(stack)
    return (1.0, 1.0) if steps is None else (1.0 / steps[0], 1.0 / steps[1])
