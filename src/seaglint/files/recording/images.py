"""Pictures as recordings: one file or many in order; TIFF, and what Pillow reads."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError
from seaglint.files.recording import pillow_pictures
from seaglint.files.recording.decoding import in_type
from seaglint.files.recording.picture_file import PictureFile
from seaglint.files.recording.pillow_pictures import open_picture
from seaglint.files.recording.stored import grey
from seaglint.files.recording.tiff_pages import open_tiff

TIFF_ENDINGS = (".tif", ".tiff", ".btf", ".tf8")
ENDINGS = (*TIFF_ENDINGS, *pillow_pictures.ENDINGS)


def natural(path: Path) -> tuple[Any, ...]:
    """Return a sort key that puts frame 9 before frame 10.

    >>> [p.name for p in sorted([Path("f10.png"), Path("f9.png")], key=natural)]
    ['f9.png', 'f10.png']
    """
    return tuple((0, int(part), "") if part.isdigit() else (1, 0, part) for part in re.split(r"(\d+)", path.name))


def open_images(paths: Sequence[Path], channel: str | None, missing: tuple[float, ...] = ()) -> Recording:
    """Open files in the given order, each of one frame or several.

    Raises
    ------
    DataError
        A file that cannot be decoded, or files of different sizes, number types or units.
    """
    files = [_look(path, channel) for path in paths]
    if missing:
        files = [
            replace(f, decoding=replace(f.decoding, missing=tuple(dict.fromkeys((*f.decoding.missing, *in_type(missing, f.dtype))))))
            for f in files
        ]
    first = files[0]
    for other in files[1:]:
        _require_alike(first, other)
    ends = list(accumulate(file.frames for file in files))

    def read(start: int, stop: int) -> NDArray[Any]:
        block = np.empty((stop - start, first.rows, first.columns), dtype=np.float32)
        at = start
        while at < stop:
            i = bisect_right(ends, at)
            before = ends[i] - files[i].frames
            last = min(stop, ends[i])
            block[at - start : last - start] = _values(files[i], at - before, last - before, channel)
            at = last
        return block

    pages = "" if ends[-1] == len(paths) else f", {ends[-1]} pages"
    several = f"{first.path.parent} ({len(paths)} images {first.path.name} ... {paths[-1].name}{pages})"
    source = str(first.path) if len(paths) == 1 else several
    rates = {file.frame_rate for file in files}
    own = [*first.notes, *first.decoding.notes]
    if any(file.decoding != first.decoding for file in files):
        own = [*first.notes, "the files state different scales or missing values, and each is read by its own"]
    notes = (*_channel_note(first, channel), *own, *missing_numbers(paths))
    limits = {file.saturation for file in files}
    return Recording(
        source,
        ends[-1],
        first.rows,
        first.columns,
        read,
        rates.pop() if len(rates) == 1 else None,
        first.units,
        limits.pop() if len(limits) == 1 else None,
        notes,
    )


def _look(path: Path, channel: str | None) -> PictureFile:
    return open_tiff(path, channel) if path.suffix.lower() in TIFF_ENDINGS else open_picture(path)


def _require_alike(first: PictureFile, other: PictureFile) -> None:
    """Refuse files that are no frames of one sequence."""
    if other.dtype != first.dtype:
        raise DataError(
            f"{other.path}: holds {other.dtype}, {first.path.name} {first.dtype}; counts of different types have no common scale: "
            "write them in one, or give a pattern for one kind"
        )
    if (other.rows, other.columns) != (first.rows, first.columns):
        raise DataError(
            f"{other.path}: is {other.rows} x {other.columns}, {first.path.name} is {first.rows} x {first.columns}; give one size"
        )
    if other.units != first.units:
        units, others = first.units or "unknown units", other.units or "unknown units"
        raise DataError(f"{other.path}: is in {others}, {first.path.name} in {units}; give images of one unit")
    if (other.decoding.white is None) != (first.decoding.white is None):
        raise DataError(f"{other.path}: white is zero in one of it and {first.path.name} alone; write them alike")


def _values(file: PictureFile, start: int, stop: int, channel: str | None) -> NDArray[Any]:
    stored = file.read(start, stop)
    if stored.ndim == 3:
        return file.decoding.values(stored)
    return file.decoding.values(grey(stored, str(file.path), channel))


def _channel_note(file: PictureFile, channel: str | None) -> tuple[str, ...]:
    """Return a note on the channel; true colour is refused when a file is opened, not in the middle of an analysis."""
    if not file.colours:
        if channel is not None and channel.isdecimal() and channel != "1" and not any(n.startswith("channel ") for n in file.notes):
            raise DataError(f"{file.path}: has 1 channel; channel = {channel} is none of them, leave it out")
        return ()
    stored = file.read(0, 1)
    grey(stored, str(file.path), channel)
    opaque = np.iinfo(stored.dtype).max if stored.dtype.kind in "iu" else 1
    unseen = stored.shape[-1] in (2, 4) and bool(np.any(stored[..., -1] != opaque))
    alpha = ("alpha, which is not full everywhere, is ignored: values are the stored numbers",) if unseen else ()
    if channel is not None:
        return (f"colour image, channel {channel}", *alpha)
    averaged = stored.shape[-1] > 2 and np.ptp(stored[..., :3], axis=-1).any()
    return (*(("nearly equal colour channels, averaged",) if averaged else ()), *alpha)


def missing_numbers(paths: Sequence[Path]) -> tuple[str, ...]:
    """Return a note where the number that counts the files has gaps."""
    keys = [natural(path) for path in paths]
    if len(keys) < 3 or len({len(key) for key in keys}) > 1:
        return ()
    varying = [i for i, parts in enumerate(zip(*keys, strict=True)) if len(set(parts)) > 1]
    if len(varying) != 1 or not all(key[varying[0]][0] == 0 for key in keys):
        return ()
    numbers = np.array([key[varying[0]][1] for key in keys])
    steps = np.diff(numbers)
    step = int(steps.min())
    if step < 1 or (steps == step).all():
        return ()
    jumps = np.flatnonzero(steps > step)
    absent = int((steps[jumps] // step - 1).sum())
    where = ", ".join(f"{paths[i].name} to {paths[i + 1].name}" for i in jumps[:3]) + (", ..." if jumps.size > 3 else "")
    return (f"the files' numbers jump ({where}): some {absent} frames are missing, times across the gaps are not to be trusted",)
