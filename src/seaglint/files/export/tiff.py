"""TIFF: a page for each frame, uncompressed, which every reader opens; what is known stands as JSON in the first page's description."""

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

_SMALL: Final = (1 << 32) - (1 << 25)
"""Bytes that places of 32 bits reach, less the pages' own tables; larger files are BigTIFF."""


class Tiff(ExportFormat):
    """Stack of TIFF pages."""

    endings: ClassVar[tuple[str, ...]] = (".tif",)
    aliases: ClassVar[tuple[str, ...]] = (".tiff",)

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write a page for each frame."""
        _write(path, stack, numbers, frames)


def _write(path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
    tifffile = optional("tifffile", f"{path}: TIFF", "recordings")

    count, rows, columns = stack.shape
    text = json.dumps({**stack.metadata(), **numbers.attributes}, allow_nan=False)
    # A page takes its pixels and a table of some 300 bytes.
    big = count * (rows * columns * numbers.dtype.itemsize + 512) + len(text) > _SMALL
    with tifffile.TiffWriter(path, bigtiff=big) as file:
        for i, frame in enumerate(frames):
            file.write(
                frame, photometric="minisblack", metadata=None, contiguous=False, software=f"seaglint {__version__}",
                description=text if i == 0 else None,
            )  # fmt: skip
