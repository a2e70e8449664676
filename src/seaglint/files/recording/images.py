"""Pictures as recordings: one file or many in order; TIFF, and what Pillow reads."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError
from seaglint.files.recording import pillow_pictures
from seaglint.files.recording.arrays import resolved
from seaglint.files.recording.joined import joined
from seaglint.files.recording.picture_file import PictureFile
from seaglint.files.recording.pillow_pictures import open_picture
from seaglint.files.recording.stored import colour_notes, grey
from seaglint.files.recording.tiff_pages import open_tiff

TIFF_ENDINGS = (".tif", ".tiff", ".btf", ".tf8")
ENDINGS = (*TIFF_ENDINGS, *pillow_pictures.ENDINGS)


def natural(path: Path) -> tuple[Any, ...]:
    """Return a sort key that puts frame 9 before frame 10, and small letters beside capitals.

    >>> [p.name for p in sorted([Path("f10.png"), Path("f9.png")], key=natural)]
    ['f9.png', 'f10.png']
    """
    return tuple((0, int(part), "") if part.isdigit() else (1, 0, part) for part in re.split(r"(\d+)", path.name.casefold()))


def open_images(paths: Sequence[Path], channel: str | None, missing: tuple[float, ...] = ()) -> Recording:
    """Open files in the given order, each of one frame or several.

    Raises
    ------
    DataError
        A file that cannot be decoded, or files of different sizes, number types or units.
    """
    files = [_look(path, channel) for path in paths]
    files = [replace(file, decoding=file.decoding.with_missing(missing, file.dtype)) for file in files]
    first = files[0]
    for other in files[1:]:
        _require_alike(first, other)
    pages = sum(file.frames for file in files)
    counted = "" if pages == len(paths) else f", {pages} pages"
    several = f"{first.path.parent} ({len(paths)} images {first.path.name} ... {paths[-1].name}{counted})"
    own = [*first.notes, *first.decoding.notes]
    if any(file.decoding != first.decoding for file in files):
        own = [*first.notes, "the files state different scales or missing values, and each is read by its own"]
    whole = joined([_recording(file, channel) for file in files], str(first.path) if len(paths) == 1 else several)
    whole = replace(whole, notes=(*_channel_note(first, channel), *own, *missing_numbers(paths)))
    decoded = first.decoding.dtype(first.dtype)
    return resolved(whole) if decoded.itemsize > 2 and decoded != np.float32 else whole


def _recording(file: PictureFile, channel: str | None) -> Recording:
    """Return the frames of one file, with one value a pixel."""

    def read(start: int, stop: int) -> NDArray[Any]:
        stored = file.read(start, stop)
        return file.decoding.values(stored if stored.ndim == 3 else grey(stored, str(file.path), channel))

    return Recording(str(file.path), file.frames, file.rows, file.columns, read, file.frame_rate, file.units, file.saturation, offset=0.0)


def _look(path: Path, channel: str | None) -> PictureFile:
    return open_tiff(path, channel) if path.suffix.lower() in TIFF_ENDINGS else open_picture(path)


def _require_alike(first: PictureFile, other: PictureFile) -> None:
    """Refuse files whose numbers have no common scale; size and units are compared where they are joined."""
    if other.dtype != first.dtype:
        raise DataError(
            f"{other.path}: holds {other.dtype}, {first.path.name} {first.dtype}; counts of different types have no common scale: "
            "write them in one, or give a pattern for one kind"
        )
    if (other.decoding.white is None) != (first.decoding.white is None):
        raise DataError(f"{other.path}: white is zero in one of it and {first.path.name} alone; write them alike")


def _channel_note(file: PictureFile, channel: str | None) -> tuple[str, ...]:
    """Return a note on the channel; true colour is refused when a file is opened, not in the middle of an analysis."""
    if not file.colours:
        if channel is not None and channel.isdecimal() and channel != "1" and not any(n.startswith("channel ") for n in file.notes):
            raise DataError(f"{file.path}: has 1 channel; channel = {channel} is none of them, leave it out")
        return ()
    stored = file.read(0, 1)
    grey(stored, str(file.path), channel)
    return colour_notes(stored, channel)


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
    what = "1 frame is" if absent == 1 else f"{absent} frames are"
    return (f"the files' numbers jump ({where}): {what} missing, times across the gaps are not to be trusted",)
