"""PNG and TIFF: one image, a file of many pages, or a folder of numbered files."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.errors import DataError
from seaglint.io.recording.base import Recording, full_scale, grey

ENDINGS = (".png", ".tif", ".tiff")


def natural(path: Path) -> tuple[Any, ...]:
    """Sort key that puts frame 9 before frame 10.

    >>> [p.name for p in sorted([Path("f10.png"), Path("f9.png")], key=natural)]
    ['f9.png', 'f10.png']
    """
    return tuple((0, int(part), "") if part.isdigit() else (1, 0, part) for part in re.split(r"(\d+)", path.name))


def open_images(paths: Sequence[Path], channel: str | None) -> Recording:
    """One multi-page TIFF, or single images as frames in the order given."""
    first = paths[0]
    if len(paths) == 1 and first.suffix.lower() != ".png":
        return _open_pages(first, channel)
    image = _load(first, channel)
    shape, dtype = image.shape, _stored_type(first)

    def read(start: int, stop: int) -> NDArray[Any]:
        block = np.empty((stop - start, *shape), dtype=np.float32)
        for i, path in enumerate(paths[start:stop]):
            frame = image if path == first else _load(path, channel)
            if frame.shape != shape:
                raise DataError(f"{path}: is {frame.shape[0]} x {frame.shape[1]}, {first.name} is {shape[0]} x {shape[1]}; give one size")
            block[i] = frame
        return block

    source = str(first) if len(paths) == 1 else f"{first.parent} ({len(paths)} images {first.name} ... {paths[-1].name})"
    return Recording(source, len(paths), shape[0], shape[1], read, saturation=full_scale(dtype), notes=_channel_note(first, channel))


def _stored_type(path: Path) -> np.dtype[Any]:
    return np.asarray(_decode(path)).dtype


def _channel_note(path: Path, channel: str | None) -> tuple[str, ...]:
    stored = _decode(path)
    if stored.ndim == 2:
        return ()
    if channel is not None:
        return (f"colour image, channel {channel}",)
    return ("nearly equal colour channels, averaged",) if stored.shape[-1] > 2 and np.ptp(stored[..., :3], axis=-1).any() else ()


def _decode(path: Path) -> NDArray[Any]:
    """Pixels as stored: (rows, columns) or (rows, columns, channels)."""
    try:
        if path.suffix.lower() == ".png":
            from PIL import Image

            with Image.open(path) as image:
                # A palette is a picture of colours, not numbers; 16-bit grey comes as 32-bit integers from some versions.
                stored = np.asarray(image.convert("RGB") if image.mode == "P" else image)
                return stored.astype(np.uint16) if image.mode.startswith("I") else stored
        import tifffile

        return np.asarray(tifffile.imread(path, key=0))
    except Exception as error:
        raise DataError(f"{path}: cannot be decoded ({_first_line(error)}); write it again as plain PNG or uncompressed TIFF") from error


def _load(path: Path, channel: str | None) -> NDArray[Any]:
    stored = _decode(path)
    if stored.dtype == np.bool_:
        stored = stored.astype(np.uint8)
    if stored.ndim == 3:
        stored = grey(stored, str(path), channel)
    if stored.ndim != 2:
        raise DataError(f"{path}: is an array of shape {stored.shape}, not an image; give grey or RGB(A) images")
    return stored


def _open_pages(path: Path, channel: str | None) -> Recording:
    """Every page a frame; ImageJ's large stacks are one page that a header calls many, and are mapped."""
    import tifffile

    try:
        with tifffile.TiffFile(path) as file:
            page = file.pages[0]
            shape, dtype = tuple(int(n) for n in page.shape), np.dtype(page.dtype)
            pages, stack = len(file.pages), tuple(int(n) for n in file.series[0].shape)
    except Exception as error:
        raise DataError(f"{path}: cannot be read as TIFF ({_first_line(error)}); write it again") from error
    one_page = pages == 1 and len(stack) > len(shape)
    frames = stack[0] if one_page else pages
    coloured = len(shape) == 3 and shape[-1] <= 4
    if len(shape) - coloured != 2 or (one_page and len(stack) != len(shape) + 1):
        raise DataError(f"{path}: holds pages of shape {shape} in a stack of {stack}; give pages of grey or RGB(A) images")

    def read(start: int, stop: int) -> NDArray[Any]:
        try:
            block = tifffile.memmap(path, mode="r")[start:stop] if one_page else tifffile.imread(path, key=range(start, stop))
        except Exception as error:
            raise DataError(f"{path}: pages {start}:{stop} cannot be decoded ({_first_line(error)}); the file is cut") from error
        block = np.asarray(block).reshape(stop - start, *shape)
        return grey(block, str(path), channel) if coloured else block

    return Recording(str(path), frames, shape[0], shape[1], read, saturation=full_scale(dtype))


def _first_line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]
