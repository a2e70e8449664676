"""One file of pictures: its frames as stored, and what the file says of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.files.recording.decoding import PLAIN, Decoding
from seaglint.files.recording.stored import SeveralChannelsError


@dataclass(frozen=True)
class PictureFile:
    """Frames of one file."""

    path: Path  #: The file.
    #: ``frames``, ``rows``, ``columns``: Size.
    frames: int
    rows: int
    columns: int
    dtype: np.dtype[Any]  #: Type of the stored numbers.
    #: ``(start, stop) -> stored numbers``, shape (stop - start, rows, columns), with a further axis of channels for colours.
    read: Callable[[int, int], NDArray[Any]]
    colours: int = 0  #: Length of the axis of colours, grey and alpha (2), RGB (3) or RGBA (4); 0 without that axis.
    frame_rate: float | None = None  #: [Hz].
    units: str | None = None  #: Units of the values.
    decoding: Decoding = PLAIN  #: Relation of stored numbers to values.
    saturation: float | None = None  #: Value of full scale.
    notes: tuple[str, ...] = ()  #: Sentences for the user.


def channel_index(count: int, requested: str | None, source: object) -> int:
    """Return the index of the requested channel of several.

    Raises
    ------
    SeveralChannelsError
        None requested.
    DataError
        One that is not there.
    """
    if requested is None:
        raise SeveralChannelsError(f"{source}: has {count} channels; give channel = 1 to {count}")
    if not requested.isdecimal() or not 1 <= int(requested) <= count:
        raise DataError(f"{source}: has {count} channels, and channel = {requested} is none of them; give channel = 1 to {count}")
    return int(requested) - 1


def first_line(error: BaseException) -> str:
    """Return the first line of an exception's text."""
    return (str(error).splitlines() or [type(error).__name__])[0]
