"""Reader of PNG and TIFF: one image, a file of many pages, or a folder of numbered files."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import accumulate
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import BackendError, DataError
from seaglint.base.optional import optional
from seaglint.files.recording.stored import full_scale, grey
from seaglint.files.recording.tiff_facts import TiffFacts

ENDINGS = (".png", ".tif", ".tiff")

_SIGNATURE = b"\x89PNG"
_CHANNELS: dict[int, tuple[int, ...]] = {0: (), 2: (3,), 3: (3,), 4: (2,), 6: (4,)}
"""Length of the last axis by the colour type of a PNG's header: grey, RGB, palette (made RGB), grey and alpha, RGB and alpha."""


def natural(path: Path) -> tuple[Any, ...]:
    """Return a sort key that puts frame 9 before frame 10.

    >>> [p.name for p in sorted([Path("f10.png"), Path("f9.png")], key=natural)]
    ['f9.png', 'f10.png']
    """
    return tuple((0, int(part), "") if part.isdigit() else (1, 0, part) for part in re.split(r"(\d+)", path.name))


@dataclass(frozen=True)
class _File:
    """One file: its number of frames, and their shape and type as stored."""

    path: Path
    pages: int
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    one_page: bool = False
    facts: TiffFacts = field(default_factory=TiffFacts)

    def read(self, start: int, stop: int) -> NDArray[Any]:
        """Return frames as stored, shape (stop - start, rows, columns[, channels])."""
        if self.path.suffix.lower() == ".png":
            return _decode_png(self.path)[np.newaxis]
        tifffile = optional("tifffile", f"{self.path}: TIFF")

        try:
            # ImageJ's large stacks are one page that a header calls many: mapped, and unmapped when the block is copied.
            stored = (
                tifffile.memmap(self.path, mode="r")[start:stop] if self.one_page else tifffile.imread(self.path, key=range(start, stop))
            )
        except Exception as error:
            remedy = "; the file is cut, or give uncompressed TIFF"
            raise DataError(f"{self.path}: pages {start}:{stop} cannot be decoded ({_first_line(error)}){remedy}") from error
        return np.asarray(stored).reshape(stop - start, *self.shape)


def open_images(paths: Sequence[Path], channel: str | None) -> Recording:
    """Open files in the given order; every page is a frame.

    Raises
    ------
    DataError
        A file that cannot be decoded, or files of different sizes or number types.
    """
    files = [_look(path) for path in paths]
    first = files[0]
    for other in files[1:]:
        if other.dtype != first.dtype:
            raise DataError(
                f"{other.path}: holds {other.dtype}, {first.path.name} {first.dtype}; counts of different types have no common scale: "
                "write them in one, or give a pattern for one kind"
            )
        if other.shape[:2] != first.shape[:2]:
            sizes = " x ".join(map(str, other.shape[:2])), " x ".join(map(str, first.shape[:2]))
            raise DataError(f"{other.path}: is {sizes[0]}, {first.path.name} is {sizes[1]}; give one size")
    ends = list(accumulate(file.pages for file in files))
    facts = first.facts if len(files) == 1 else TiffFacts()  # files of one sequence may differ in their lines, which have no common scale

    def read(start: int, stop: int) -> NDArray[Any]:
        block = np.empty((stop - start, *first.shape[:2]), dtype=np.float32)
        at = start
        while at < stop:
            i = bisect_right(ends, at)
            before = ends[i] - files[i].pages
            last = min(stop, ends[i])
            block[at - start : last - start] = facts.values(_grey(files[i].read(at - before, last - before), files[i].path, channel))
            at = last
        return block

    pages = "" if ends[-1] == len(paths) else f", {ends[-1]} pages"
    several = f"{first.path.parent} ({len(paths)} images {first.path.name} ... {paths[-1].name}{pages})"
    notes = (*_channel_note(first, channel), *_missing_numbers(paths))
    source = str(first.path) if len(paths) == 1 else several
    full = full_scale(first.dtype) if facts.plain else None  # counts of an export end at the largest value, which is no saturation
    return Recording(source, ends[-1], first.shape[0], first.shape[1], read, facts.frame_rate, facts.units, full, notes)


def _missing_numbers(paths: Sequence[Path]) -> tuple[str, ...]:
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


def _channel_note(file: _File, channel: str | None) -> tuple[str, ...]:
    if len(file.shape) == 2:
        return ()
    stored = file.read(0, 1)
    _grey(stored, file.path, channel)  # true colour is refused when a file is opened, not in the middle of an analysis
    if channel is not None:
        return (f"colour image, channel {channel}",)
    return ("nearly equal colour channels, averaged",) if stored.shape[-1] > 2 and np.ptp(stored[..., :3], axis=-1).any() else ()


def _grey(stored: NDArray[Any], path: Path, channel: str | None) -> NDArray[Any]:
    return grey(stored, str(path), channel) if stored.ndim == 4 else stored


def _look(path: Path) -> _File:
    """Return pages, shape and type of a file, from its headers where possible."""
    if path.suffix.lower() != ".png":
        return _look_tiff(path)
    try:
        with path.open("rb") as file:
            header = file.read(26)
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({_first_line(error)})") from error
    if header[:4] == _SIGNATURE and len(header) == 26 and header[25] in _CHANNELS:
        columns, rows = int.from_bytes(header[16:20], "big"), int.from_bytes(header[20:24], "big")
        return _File(path, 1, (rows, columns, *_CHANNELS[header[25]]), np.dtype(np.uint16 if header[24] == 16 else np.uint8))
    stored = _decode_png(path)
    return _File(path, 1, stored.shape, stored.dtype)


def _decode_png(path: Path) -> NDArray[Any]:
    """Return pixels as stored: (rows, columns) or (rows, columns, channels)."""
    try:
        with path.open("rb") as file:
            header = file.read(26)
        if header[:4] == _SIGNATURE and header[24] == 16 and header[25] != 0:
            return _decode_deep_png(path)
        from PIL import Image

        with Image.open(path) as image:
            # A palette is a picture of colours, not numbers; 16-bit grey comes as 32-bit integers from some versions.
            stored = np.asarray(image.convert("RGB") if image.mode == "P" else image)
            stored = stored.astype(np.uint16) if image.mode.startswith("I") else stored
            return stored.astype(np.uint8) if stored.dtype == np.bool_ else stored
    except BackendError:
        raise
    except Exception as error:
        raise DataError(f"{path}: cannot be decoded ({_first_line(error)}); write it again as plain PNG or uncompressed TIFF") from error


def _decode_deep_png(path: Path) -> NDArray[Any]:
    """Return colours or grey and alpha of 16 bits each, which Pillow reduces to 8."""
    png = optional("png", f"{path}: colour of 16 bits")
    with path.open("rb") as file:
        columns, rows, lines, facts = png.Reader(file=file).read()
        stored = np.array([np.asarray(line, np.uint16) for line in lines])
    return stored.reshape(rows, columns, facts["planes"])


def _look_tiff(path: Path) -> _File:
    tifffile = optional("tifffile", f"{path}: TIFF")

    try:
        with tifffile.TiffFile(path) as file:
            page = file.pages[0]
            shape, dtype = tuple(int(n) for n in page.shape), np.dtype(page.dtype)
            pages, stack, facts = len(file.pages), tuple(int(n) for n in file.series[0].shape), TiffFacts.of(file)
    except Exception as error:
        raise DataError(f"{path}: cannot be read as TIFF ({_first_line(error)}); write it again") from error
    one_page = pages == 1 and len(stack) > len(shape)
    coloured = len(shape) == 3 and shape[-1] <= 4
    if len(shape) - coloured != 2 or (one_page and len(stack) != len(shape) + 1):
        raise DataError(f"{path}: holds pages of shape {shape} in a stack of {stack}; give pages of grey or RGB(A) images")
    return _File(path, stack[0] if one_page else pages, shape, dtype, one_page, facts)


def _first_line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]
