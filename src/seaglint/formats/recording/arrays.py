"""Arrays as recordings, readers of NumPy's and raw files, and several recordings of one size joined in order.

Axes are (rows, columns), (frames, rows, columns), or as the user states them. Raw frames are numbers after a header that is skipped; their
layout comes as options or from a TOML or JSON file beside the data (``clip.raw`` and ``clip.toml``) with the names of :class:`RawLayout`,
and with a table ``metadata`` of anything else, which is not read.
"""

from __future__ import annotations

import json
import math
import mmap
import tomllib
import zipfile
import zlib
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from itertools import accumulate
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError
from seaglint.base.free_form import Attributes, JsonObject
from seaglint.formats.recording.frame_axes import COLOUR_NAMES, MOST_COLOURS, RATE_NAMES, AxisOrder, Ordered, frame_rate_of, layout_of
from seaglint.formats.recording.stored_values import (
    CHANNELS,
    Decoded,
    Decoding,
    SeveralChannelsError,
    ValueFacts,
    colour_notes,
    full_scale,
    grey,
)


def joined(recordings: Sequence[Recording], source: str) -> Recording:
    """Return recordings one after the other; each note is listed once.

    Raises
    ------
    DataError
        Recordings that differ in size or units.
    """
    first = recordings[0]
    for other in recordings[1:]:
        if (other.rows, other.columns) != (first.rows, first.columns):
            raise DataError(
                f"{other.source}: is {other.rows} x {other.columns}, {first.source} is {first.rows} x {first.columns}; "
                "frames have one size: give one of them"
            )
        if other.units != first.units:
            units, others = first.units or "unknown units", other.units or "unknown units"
            raise DataError(f"{other.source}: is in {others}, {first.source} in {units}; give images of one unit")
    ends = list(accumulate(recording.frames for recording in recordings))

    def read(start: int, stop: int) -> NDArray[Any]:
        blocks, at = [], start
        # A block may begin in one recording and end in another.
        while at < stop:
            i = bisect_right(ends, at)
            begin = ends[i] - recordings[i].frames
            last = min(stop, ends[i])
            blocks.append(np.asarray(recordings[i].read_block(at - begin, last - begin)))
            at = last
        return np.concatenate(blocks) if len(blocks) > 1 else blocks[0]

    rates = {recording.frame_rate for recording in recordings}
    # Limits are compared in the numbers of the files: each recording may have another offset.
    limits = {None if r.saturation is None else r.saturation + r.offset for r in recordings}
    limit = limits.pop() if len(limits) == 1 else None
    blurs = {recording.blur_px for recording in recordings}
    notes = tuple(dict.fromkeys(note for recording in recordings for note in recording.notes))
    return replace(
        first,
        source=source,
        frames=ends[-1],
        read_block=read,
        frame_rate=rates.pop() if len(rates) == 1 else None,
        saturation=None if limit is None else limit - first.offset,
        notes=notes,
        blur_px=blurs.pop() if len(blurs) == 1 else None,
    )


RESOLVED: Final = 1000.0  #: Smallest spread of the values in steps of single precision; below it an offset is subtracted.


@dataclass(frozen=True)
class ArrayReading:
    """Properties of an array that the user states in place of its file."""

    variable: str | None = None  #: Name of the array in a file that holds several.
    channel: str | None = None  #: Channel: a colour, or a number from 1.
    axes: str | None = None  #: Order of the axes, letters of ``LETTERS``.
    missing: tuple[float, ...] = ()  #: Stored numbers that are missing values, besides those that the file states.

    def decoding(self, stated: Decoding, dtype: np.dtype[Any]) -> Decoding:
        """Return a file's decoding with the user's own missing values."""
        return stated.with_missing(self.missing, dtype)


@dataclass(frozen=True)
class ArrayFacts(ValueFacts):
    """Facts of a file about an array, beside its numbers; without a saturation the full scale of the number type holds."""

    names: tuple[str, ...] = ()  #: Names of the dimensions.
    channels: tuple[str, ...] = ()  #: Names of the channels.
    colours: bool = False  #: True where the file states that its channels are red, green and blue.
    order: str = "tyx"  #: Order of three axes without other information.
    blur_px: float | None = None  #: Blur of the images, 0 without a sensor; None where the file does not state it [px].


def of_array(array: Any, source: str, how: ArrayReading, facts: ArrayFacts | None = None) -> Recording:
    """Return the frames of anything with ``shape``, ``dtype`` and slices.

    Raises
    ------
    DataError
        Numbers that are not real, a shape without an order of its axes, or several channels none of which is chosen.
    """
    facts = ArrayFacts() if facts is None else facts
    shape, stored = tuple(int(s) for s in array.shape), np.dtype(array.dtype)
    if stored.kind not in "uifb":
        raise DataError(f"{source}: holds {stored}, not real numbers; give radiances or counts")
    layout = layout_of(shape, source, how.axes, facts.names, facts.order)
    decoding = how.decoding(facts.decoding, stored)
    channels = layout.size(shape, "c")
    coloured, index = _channel(channels, how.channel, source, facts.channels)
    colours = facts.colours or bool(set(map(str.lower, facts.names)) & set(COLOUR_NAMES)) or how.channel is not None
    frames, rows, columns = (layout.size(shape, letter) for letter in "tyx")
    ordered = Ordered(array if decoding.plain else Decoded(array, decoding), layout, index)

    def read(start: int, stop: int) -> NDArray[Any]:
        try:
            block = ordered[start:stop]
        except (OSError, ValueError, RuntimeError) as error:
            raise DataError(f"{source}: frames {start}:{stop} cannot be read ({error}); the file is cut") from error
        block = _released(block)
        if coloured and not colours:
            _require_equal(block, source, layout, channels)
        return grey(block, source, how.channel) if coloured else block

    # A file whose channels differ is refused here, with its path, and not by the first block of an analysis.
    averaged: tuple[str, ...] = ()
    if coloured:  # channels that differ are refused when a file is opened, not in the middle of an analysis
        read(0, 1)
        averaged = colour_notes(ordered[0:1], how.channel)
    notes = (*averaged, *_order_note(shape, layout, facts), *facts.notes, *decoding.notes)
    if channels > 1 and index is not None:
        named = f" ({facts.channels[index]})" if facts.channels else ""
        notes = (*notes, f"channel {index + 1} of {channels}{named}")
    dtype = decoding.dtype(stored)
    saturation = _saturation(facts, decoding, stored)
    recording = Recording(source, frames, rows, columns, read, facts.frame_rate, facts.units, saturation, notes, blur_px=facts.blur_px)
    return resolved(recording) if dtype.itemsize > 2 and dtype != np.float32 else recording


def _channel(count: int, requested: str | None, source: str, names: tuple[str, ...]) -> tuple[bool, int | None]:
    """Return whether the channels are colours, to be made one, and the index of the chosen one."""
    if requested is not None and requested not in CHANNELS:
        index = int(requested) - 1
        if not 0 <= index < count:
            raise DataError(f"{source}: has {count} channel{'s' * (count != 1)}; channel = {requested} is none of them, give 1 to {count}")
        return False, index if count > 1 else None
    if count in (3, MOST_COLOURS):
        return True, None
    if count > 1:
        listed = f" ({', '.join(names)})" if names else ""
        raise SeveralChannelsError(f"{source}: has {count} channels{listed}; give channel = 1 to {count}")
    return False, None


def _require_equal(block: NDArray[Any], source: str, layout: AxisOrder, channels: int) -> None:
    """Refuse channels that are not known to be colours and differ: three bands are no grey picture."""
    colours = block[..., :3] if channels == MOST_COLOURS else block
    if not np.array_equal(colours, np.broadcast_to(colours[..., :1], colours.shape), equal_nan=colours.dtype.kind == "f"):
        last = " (or axes = 'yxt' if the last axis is time)" if layout.guessed and layout.letters == "yxc" else ""
        raise SeveralChannelsError(
            f"{source}: has {channels} channels that differ; give channel = 1 to {channels}, or {', '.join(CHANNELS)} of colours{last}"
        )


def _order_note(shape: tuple[int, ...], layout: AxisOrder, facts: ArrayFacts) -> tuple[str, ...]:
    """Return a note where the order is a guess that may be wrong, or not the one that rows and columns usually have."""
    frames, rows, columns = (layout.size(shape, letter) for letter in "tyx")
    size = f"shape {shape} taken as {frames} frame{'s' * (frames != 1)} of {rows} rows, {columns} columns"
    if layout.guessed and facts.order != "tyx" and frames > 1:
        return (f"{size}, the order of MATLAB; if time is the first axis there, give --axes tyx",)
    if layout.guessed and layout.letters == "tyx" and shape[2] < min(shape[0], shape[1]):
        return (f"{size}; if time is the last axis, give --axes yxt",)
    if layout.guessed and len(shape) > 3 and "1" in layout.letters:
        return (size,)
    return ()


def _saturation(facts: ArrayFacts, decoding: Decoding, stored: np.dtype[Any]) -> float | None:
    """Return full scale; numbers that a line makes values end at the largest value, which is no saturation."""
    if facts.saturation is not None:
        return facts.saturation
    kind = stored if decoding.unsigned is None else decoding.unsigned
    full = full_scale(kind) if kind.kind in "ui" and decoding.scale == 1.0 and decoding.offset == 0.0 else None
    return None if full is None or full in decoding.missing or decoding.high is not None else full


def _released(block: NDArray[Any]) -> NDArray[Any]:
    """Return a copy of a part of a memory-mapped file, whose pages are released: they count as the process's memory."""
    base: Any = block
    # NumPy arrays and memory views over a map are chained: the map is at the end of the chain.
    while base is not None and not isinstance(base, mmap.mmap):
        base = base.obj if isinstance(base, memoryview) else getattr(base, "base", None)
    if base is None:
        return block
    block = block.copy()
    if hasattr(mmap, "MADV_DONTNEED"):
        base.madvise(mmap.MADV_DONTNEED)
    return block


def resolved(recording: Recording) -> Recording:
    """Subtract the level of values whose spread single precision would round away; refuse values beyond its range."""
    first = np.asarray(recording.read_block(0, 1), np.float64)
    first = first[np.isfinite(first)]
    if not first.size:
        return recording
    largest = float(np.abs(first).max())
    if largest > 1e30 or 0.0 < largest < 1e-30:
        raise DataError(f"{recording.source}: values of {largest:.3g} are beyond single precision; scale them to 1e-30 to 1e30")
    # Single precision resolves about 1e-7 of a value: a small spread on a large level would be lost.
    level, spread = float(np.median(first)), float(first.std())
    if not 0.0 < spread < RESOLVED * float(np.finfo(np.float32).eps) * abs(level):
        return recording
    level = round(level, -math.floor(math.log10(spread)))  # a number that can be read
    saturation = None if recording.saturation is None else recording.saturation - level
    note = f"{level:.9g} taken off the values before they are rounded to single precision, and added to means and fits again"
    return replace(recording, offset=level, saturation=saturation).with_notes(note)


def open_numpy(path: Path, how: ArrayReading) -> Recording:
    """Open ``.npy``, memory-mapped, or one array of an ``.npz``, which is read as a whole."""
    try:
        loaded = np.load(path, mmap_mode="r" if path.suffix.lower() == ".npy" else None, allow_pickle=False)
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise DataError(f"{path}: cannot be read as NumPy ({error}); save plain numbers with numpy.save") from error
    if isinstance(loaded, np.ndarray):
        return of_array(loaded, str(path), how)
    sizes = {name: _npz_shape(path, name) for name in loaded.files}
    name = choose({name: shape for name, shape in sizes.items() if shape is None or len(shape) >= 2}, how.variable, path)
    try:
        array = loaded[name]
        rate = frame_rate_of({key: loaded[key] for key in RATE_NAMES if sizes.get(key) in ((), (1,))})
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise DataError(f"{path}: {name} cannot be read ({error}); the file is cut") from error
    return of_array(array, f"{path}:{name}", how, ArrayFacts(frame_rate=rate))


def _npz_shape(path: Path, name: str) -> tuple[int, ...] | None:
    """Return the shape of a member of an ``.npz`` from its header; None where it cannot be read."""
    try:
        with zipfile.ZipFile(path) as archive, archive.open(f"{name}.npy") as file:
            version = np.lib.format.read_magic(file)
            return tuple((np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0)(file)[0])
    except (KeyError, ValueError, OSError, EOFError, zipfile.BadZipFile, zlib.error):
        return None


def text_of(value: Any) -> str | None:
    """Return the text of an attribute; None for an empty one."""
    if isinstance(value, np.ndarray):
        value = value.ravel()[0] if value.size else None
    text = value.decode("utf-8", "replace") if isinstance(value, bytes) else value
    return str(text).strip(" \0") or None if text is not None else None


def choose(available: Attributes, requested: str | None, path: str | Path) -> str:
    """Return the requested name, or the only one.

    Raises
    ------
    DataError
        A name that is not there, or several and none requested.
    """
    names = ", ".join(available) or "none"
    if requested is not None:
        requested = requested.strip("/")
        if requested not in available:
            raise DataError(f"{path}: has no image variable '{requested}'; it has {names}")
        return requested
    if not available:
        raise DataError(f"{path}: no image variable (none); give a file with an array of rows and columns")
    if len(available) != 1:
        raise DataError(f"{path}: several image variables ({names}); give one as variable = {next(iter(available))}")
    return next(iter(available))


TYPES = ("uint8", "int8", "uint16", "int16", "uint32", "int32", "float32", "float64")


@dataclass(frozen=True)
class RawLayout:
    """Layout of a raw file."""

    rows: int  #: Rows of a frame.
    columns: int  #: Columns of a frame.
    dtype: str = "uint16"  #: uint8, int8, uint16, int16, uint32, int32, float32 or float64.
    byte_order: str = "little"  #: ``little`` or ``big``.
    offset: int = 0  #: Bytes before the first frame.
    frame_header: int = 0  #: Bytes before each frame.
    frame_rate: float | None = None  #: Frames per second [Hz].
    units: str | None = None  #: Units of the values.
    saturation: float | None = None  #: Value of full scale; a camera of 14 bits in 16 saturates at 16383.

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
