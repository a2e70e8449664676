"""Frames written in the format of a file's ending, as the numbers of the run, single precision or counts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError
from seaglint.files.export import endings, format_of
from seaglint.files.export.encoding import Counts, Kind, NumberFormat, check_limits
from seaglint.files.export.plain import write_header
from seaglint.files.export.stack import Exported, Stack
from seaglint.files.outputs import moved_when_whole, refuse_existing
from seaglint.files.recording.raw import TYPES


def write_stack(
    stack: Stack,
    output: str | Path,
    *,
    dtype: Kind | None = None,
    limits: tuple[float, float] | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Exported:
    """Write images in the format of the output's ending, one frame in memory at a time.

    Parameters
    ----------
    stack : Stack
        The images.
    output : path
        File to write, with one of the endings of :func:`seaglint.files.export.endings`.
    dtype : {"uint16", "float32"}, optional
        Type of the numbers; that of the run by default. Counts of 16 bits stay as they are, other values become
        :class:`~seaglint.files.export.encoding.Counts`.
    limits : (float, float), optional
        Range of those counts; that of the values by default, for which all frames are read once more.
    overwrite : bool
        Replace what is there.
    progress : callable, optional
        ``progress(done, total)``.

    Raises
    ------
    DataError
        An ending, a type or a range that cannot be, an output that exists.
    BackendError
        A library that is not installed.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = Path(output)
    form = format_of(output.suffix.lower())
    if form is None:
        raise DataError(f"{output}: the ending says what is written; allowed are {', '.join(endings())}")
    if dtype is not None and dtype not in get_args(Kind):
        raise DataError(f"dtype = {dtype!r}; allowed are {', '.join(get_args(Kind))}")
    scaled = dtype == "uint16" and stack.dtype != np.uint16
    if limits is not None:
        limits = check_limits(limits)
        if not scaled:
            raise DataError(
                "`limits` are the ends of counts made of other values; give them with dtype = 'uint16' and values of another type"
            )
    if dtype is None and stack.dtype.name not in TYPES:
        raise DataError(f"{stack.variable} is {stack.dtype}, which not all formats hold; give dtype = 'float32' or 'uint16'")
    form.require()
    header = form.header_path(output)
    files = (output,) if header is None else (output, header)
    for file in files:
        refuse_existing(file, overwrite=overwrite)
    total = stack.shape[0]
    passes = 2 if scaled and limits is None else 1
    done = 0

    def images() -> Iterator[NDArray[Any]]:
        nonlocal done
        for position in range(total):
            yield stack[position]
            done += 1
            if progress is not None:
                progress(done, passes * total)

    if progress is not None:
        progress(0, passes * total)
    counts = Counts.over(*(limits or _range(images()))) if scaled else None
    numbers = form.stored(NumberFormat(np.dtype(dtype) if dtype is not None else stack.dtype, counts), stack)
    cut = 0

    def encoded() -> Iterator[NDArray[Any]]:
        nonlocal cut
        for image in images():
            cut += counts.beyond(image) if counts is not None else 0
            yield numbers.of(image)

    with ExitStack() as held:
        # The header gets its name last of all: what has one is whole.
        partials = [held.enter_context(moved_when_whole(file)) for file in reversed(files)][::-1]
        for partial in partials:
            partial.unlink(missing_ok=True)  # left by a process that was killed
        if len(partials) > 1:
            write_header(partials[1], stack, numbers)
        form.write(partials[0], stack, numbers, encoded())
    scale, offset = (None, None) if counts is None else (counts.scale, counts.offset)
    return Exported(files, stack.variable, stack.units, stack.shape, numbers.dtype.name, scale, offset, cut)


def _range(images: Iterable[NDArray[Any]]) -> tuple[float, float]:
    """Smallest and largest finite value; 0 and 0 where there is none."""
    low, high = np.inf, -np.inf
    for image in images:
        finite = image[np.isfinite(image)]
        if finite.size:
            low, high = min(low, float(finite.min())), max(high, float(finite.max()))
    return (low, high) if low <= high else (0.0, 0.0)
