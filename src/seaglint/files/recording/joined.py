"""Several recordings of one size as one, in order."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError


def joined(recordings: Sequence[Recording], source: str) -> Recording:
    """Return recordings one after the other; notes that they share stand once.

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
        while at < stop:
            i = bisect_right(ends, at)
            begin = ends[i] - recordings[i].frames
            last = min(stop, ends[i])
            blocks.append(np.asarray(recordings[i].read_block(at - begin, last - begin)))
            at = last
        return np.concatenate(blocks) if len(blocks) > 1 else blocks[0]

    rates = {recording.frame_rate for recording in recordings}
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
