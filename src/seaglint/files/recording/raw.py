"""Reader of raw frames: a header to skip, then numbers.

The layout comes as options or from a TOML or JSON file beside the data (``clip.raw`` and ``clip.toml``) with the names of
:class:`RawLayout`, and with a table ``metadata`` of anything else, which is not read.
"""

from __future__ import annotations

import json
import math
import tomllib
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.files.recording.stored import full_scale

TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")


@dataclass(frozen=True)
class RawLayout:
    """Layout of a raw file."""

    #: ``rows``, ``columns``: Size of a frame.
    rows: int
    columns: int
    dtype: str = "uint16"  #: uint8, int8, uint16, int16, uint32, int32, float32 or float64.
    byte_order: str = "little"  #: ``little`` or ``big``.
    offset: int = 0  #: Bytes before the first frame.
    frame_header: int = 0  #: Bytes before each frame.
    #: ``frame_rate``, ``units``, ``saturation``: As in :class:`~seaglint.analysis.Recording`; a camera of 14 bits in 16 saturates at 16383.
    frame_rate: float | None = None
    units: str | None = None
    saturation: float | None = None

    @classmethod
    def beside(cls, path: Path) -> RawLayout:
        """Read the layout from the TOML or JSON file beside the data."""
        for sidecar in (path.with_suffix(".toml"), path.with_suffix(".json"), Path(f"{path}.toml"), Path(f"{path}.json")):
            if sidecar.is_file():
                return cls.of(_parse(sidecar), str(sidecar))
        raise DataError(
            f"{path}: raw data need a layout; write {path.with_suffix('.toml').name} beside it with rows, columns, dtype "
            "(and byte_order, offset, frame_header, frame_rate, units, saturation where they matter)"
        )

    @classmethod
    def of(cls, table: JsonObject, source: str) -> RawLayout:
        """Check a table with the layout's names and return the layout."""
        known = {f.name for f in fields(cls)}
        table = {name: value for name, value in table.items() if name != "metadata"}
        unknown = sorted(set(table) - known)
        missing = [name for name in ("rows", "columns") if name not in table]
        if unknown or missing:
            what = f"does not know {', '.join(unknown)}" if unknown else f"lacks {', '.join(missing)}"
            raise DataError(f"{source}: {what}; a raw layout has {', '.join(sorted(known))}")
        layout = cls(**table)
        for name in ("rows", "columns", "offset", "frame_header"):
            value, least = getattr(layout, name), 1 if name in ("rows", "columns") else 0
            if isinstance(value, bool) or not isinstance(value, int) or value < least:
                raise DataError(f"{source}: {name} = {value!r}; give a whole number of {least} or more")
        for name in ("frame_rate", "saturation"):
            value = getattr(layout, name)
            known_number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
            if value is not None and not (known_number and value > 0):
                raise DataError(f"{source}: {name} = {value!r}; give a number above 0")
        if layout.units is not None and not isinstance(layout.units, str):
            raise DataError(f'{source}: units = {layout.units!r}; give text, e.g. "counts"')
        if layout.dtype not in TYPES:
            raise DataError(f"{source}: dtype = {layout.dtype!r}; allowed are {', '.join(TYPES)}")
        if layout.byte_order not in ("little", "big"):
            raise DataError(f"{source}: byte_order = {layout.byte_order!r}; allowed are little, big")
        return layout


def _parse(sidecar: Path) -> JsonObject:
    try:
        text = sidecar.read_text(encoding="utf-8")
        table = tomllib.loads(text) if sidecar.suffix == ".toml" else json.loads(text)
    except (OSError, ValueError) as error:
        raise DataError(f"{sidecar}: cannot be read as {sidecar.suffix[1:].upper()} ({error}); mend it") from error
    if not isinstance(table, dict):
        raise DataError(f"{sidecar}: holds no names; write rows = ..., columns = ..., dtype = ...")
    return table


def open_raw(path: Path, layout: RawLayout) -> Recording:
    """Open a raw file; data after the last whole frame are noted."""
    dtype = np.dtype(layout.dtype).newbyteorder("<" if layout.byte_order == "little" else ">")
    pixels = layout.rows * layout.columns
    stride = layout.frame_header + pixels * dtype.itemsize
    size = path.stat().st_size - layout.offset
    frames, rest = divmod(max(size, 0), stride)
    if frames == 0:
        raise DataError(
            f"{path}: holds {max(size, 0)} bytes after the header, less than one frame of {layout.rows} x {layout.columns} {layout.dtype} "
            f"({stride} bytes); check rows, columns, dtype and offset"
        )

    def read(start: int, stop: int) -> NDArray[Any]:
        # Read, not mapped: pages of a map count as the process's memory.
        block = np.fromfile(path, np.uint8, (stop - start) * stride, offset=layout.offset + start * stride)
        if block.size < (stop - start) * stride:
            raise DataError(f"{path}: ends before frame {stop}; the file is cut")
        pixels = np.ascontiguousarray(block.reshape(stop - start, stride)[:, layout.frame_header :])
        return pixels.view(dtype).reshape(stop - start, layout.rows, layout.columns)

    notes = (f"{rest} bytes follow the last whole frame; rows, columns, dtype or headers may be wrong",) if rest else ()
    saturation = layout.saturation if layout.saturation is not None else full_scale(np.dtype(layout.dtype))
    return Recording(f"{path} (raw)", frames, layout.rows, layout.columns, read, layout.frame_rate, layout.units, saturation, notes)
