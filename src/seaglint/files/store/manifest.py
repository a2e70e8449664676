"""Manifest of a sequence: the frames that exist, and a checksum of each."""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import blake2b
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

DONE: Final = "frame_done"  #: Name of the array that marks the written frames.

CHECKSUM: Final = "frame_checksum"  #: Name of the array of the frames' checksums.

OVER: Final = "over"  #: Attribute of the checksums that names the arrays they cover, in order.


def frame_checksum(images: Iterable[NDArray[Any]]) -> int:
    """Return the first 64 bits of the BLAKE2b of a frame's arrays, little-endian, as they are read back.

    All numbers that are not one count as the same NaN, and -0 as 0: chunks that hold nothing else are not stored.

    >>> frame_checksum([np.float32([1.0, -0.0])]) == frame_checksum([np.float32([1.0, 0.0])])
    True
    """
    digest = blake2b(digest_size=8)
    for image in images:
        values = np.asarray(image)
        if values.dtype.kind == "f":
            values = np.where(np.isnan(values), values.dtype.type(np.nan), values) + values.dtype.type(0.0)
        digest.update(np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<")).tobytes())
    return int.from_bytes(digest.digest(), "little")


def listed(numbers: Iterable[int], most: int = 8) -> str:
    """Return numbers of frames as text, with runs abbreviated.

    >>> listed([0, 1, 2, 5, 7, 8]), listed(range(0, 40, 2))
    ('0-2, 5, 7-8', '0, 2, 4, 6, 8, 10, 12, 14 and 12 more')
    """
    runs: list[list[int]] = []
    for number in map(int, numbers):
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    text = ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs[:most])
    rest = sum(b - a + 1 for a, b in runs[most:])
    return f"{text} and {rest} more" if rest else text
