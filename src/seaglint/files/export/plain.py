"""NumPy and raw: frames one after the other, little-endian, with a JSON header in a file beside them."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from seaglint.base.free_form import JsonObject
from seaglint.files.export.export_format import ExportFormat

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seaglint.files.export.encoding import NumberFormat
    from seaglint.files.export.stack import Stack


class Npy(ExportFormat):
    """Array (time, y, x) as ``numpy.save`` writes it."""

    endings: ClassVar[tuple[str, ...]] = (".npy",)

    @classmethod
    def header_path(cls, output: Path) -> Path:
        """Return ``X.npy.json`` of ``X.npy``.

        >>> Npy.header_path(Path("X.npy")).name
        'X.npy.json'
        """
        return output.with_name(output.name + ".json")

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write the array's header and the numbers."""
        _write(path, numbers, frames, stack.shape)


class Raw(ExportFormat):
    """The numbers and nothing else."""

    endings: ClassVar[tuple[str, ...]] = (".raw",)
    note: ClassVar[str] = "with a JSON header"

    @classmethod
    def header_path(cls, output: Path) -> Path:
        """Return ``X.json`` of ``X.raw``, where raw data are expected to have it.

        >>> Raw.header_path(Path("X.raw")).name
        'X.json'
        """
        return output.with_suffix(".json")

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write the numbers."""
        _write(path, numbers, frames, None)


def header(stack: Stack, numbers: NumberFormat) -> JsonObject:
    """Layout with the names of :class:`~seaglint.files.recording.RawLayout`, and the rest in ``metadata``."""
    _, rows, columns = stack.shape
    table = {
        "rows": rows,
        "columns": columns,
        "dtype": numbers.dtype.name,
        "byte_order": "little",
        "offset": 0,
        "frame_header": 0,
        "frame_rate": stack.frame_rate,
        "units": "count" if numbers.counts else stack.units or None,
        "metadata": {**stack.metadata(), **numbers.attributes},
    }
    return {name: value for name, value in table.items() if value is not None}


def write_header(path: Path, stack: Stack, numbers: NumberFormat) -> None:
    """Write the JSON header."""
    path.write_text(json.dumps(header(stack, numbers), indent=1, allow_nan=False) + "\n", encoding="utf-8")


def _write(path: Path, numbers: NumberFormat, frames: Iterable[NDArray[Any]], shape: tuple[int, ...] | None) -> None:
    little = numbers.dtype.newbyteorder("<")
    with path.open("wb") as file:
        if shape is not None:
            table = {"descr": np.lib.format.dtype_to_descr(little), "fortran_order": False, "shape": shape}
            np.lib.format.write_array_header_1_0(file, table)
        for frame in frames:
            file.write(frame.astype(little, copy=False).tobytes())
