"""The manifest of a sequence: which frames are there, and a checksum of each."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from hashlib import blake2b
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from seaglint.io.shards import Shards

log = logging.getLogger(__name__)

DONE: Final = "frame_done"
"""Array that says which frames have been written."""

CHECKSUM: Final = "frame_checksum"
"""Array of the frames' checksums."""

OVER: Final = "over"
"""Attribute of the checksums that names the arrays they are over, in this order."""


def frame_checksum(images: Iterable[NDArray[Any]]) -> int:
    """First 64 bits of the BLAKE2b of a frame's arrays, little-endian, as they are read back.

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


def forget_damaged(shards: Shards, units: Iterable[int], numbers: NDArray[np.int64]) -> list[int]:
    """Take frames that cannot be read, or do not fit their checksums, off the manifest; ``numbers`` are those of all frames.

    Returns
    -------
    list of int
        Places of these frames in the sequence.
    """
    found: list[int] = []
    for unit in units:
        span = shards.span(unit)
        places = np.arange(span.start, span.stop)
        try:
            there = shards.done[span].astype(bool)
            if not there.any():
                continue
            block, sums = shards.read(span), shards.checksums[span]
        except Exception:  # codecs raise nearly anything for what is cut
            log.warning("seaglint: frames %s cannot be read; they are made again", listed(numbers[places]))
            shards.erase(unit)
            found += places.tolist()
            continue
        wrong = [i for i in np.flatnonzero(there) if frame_checksum(block[path][i] for path in block) != int(sums[i])]
        if wrong:
            log.warning("seaglint: frames %s do not fit their checksums; they are made again", listed(numbers[places[wrong]]))
            there[wrong] = False
            shards.done[span] = there.astype(np.uint8)
            found += places[wrong].tolist()
    return found


def listed(numbers: Iterable[int], most: int = 8) -> str:
    """Numbers of frames for people.

    >>> listed([0, 1, 2, 5, 7, 8]), listed(range(0, 40, 2))
    ('0-2, 5, 7-8', '0, 2, 4, 6, 8, 10, 12, 14 and 12 more')
    """
    runs: list[list[int]] = []
    for number in map(int, numbers):
        if runs and number == runs[-1][1] + 1:
            runs[-1][1] = number
        else:
            runs.append([number, number])
    told = ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs[:most])
    rest = sum(b - a + 1 for a, b in runs[most:])
    return f"{told} and {rest} more" if rest else told
