"""Recording to analyse: size of a sequence, its time step and units, and blocks of frames."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.detection.sources import PlainFrames

FrameArray = NDArray[np.float32]


@dataclass(frozen=True)
class Recording(PlainFrames):
    """Sequence of images that is read on demand: from a file by ``seaglint.files.recording.open_recording``, or by a user's function."""

    source: str  #: Path and format, for reports.
    #: ``frames``, ``rows``, ``columns``: Size.
    frames: int
    rows: int
    columns: int
    #: ``(start, stop) -> array (stop - start, rows, columns)`` in the file's own numbers; used by :meth:`read`.
    read_block: Callable[[int, int], NDArray[Any]] = field(repr=False, compare=False)
    frame_rate: float | None = None  #: Frames per second [Hz], where the file tells it or the user did.
    units: str | None = None  #: Units of the values; None where neither file nor user say.
    #: Value at which the format or sensor saturates: full scale of integer formats, or what the user said; less ``offset``.
    saturation: float | None = None
    notes: tuple[str, ...] = ()  #: Notes for readers of results: lossy codec, channels averaged, frames missing.
    offset: float = 0.0  #: Level that :meth:`read` subtracts from the file's numbers, so that single precision resolves their spread.
    #: Blur of what made the frames beyond its pixels, a standard deviation [px]: 0 for radiance rendered without a sensor; None where it is
    #: not known.
    blur_px: float | None = None

    @property
    def blur(self) -> str:
        """Return what is known of the blur, in a sentence for readers of correlation times."""
        if self.blur_px is None:
            return "not known; correlation times and lengths are those of what made these frames, its blur included"
        if self.blur_px == 0.0:
            return "none (rendered without a sensor); correlation times of a real sensor are longer"
        return f"{self.blur_px:.2g} px (standard deviation, beyond the pixel itself), that of the sensor in the file"

    def read(self, start: int, stop: int) -> FrameArray:
        """Return frames ``start`` to ``stop`` (not included) as a float32 copy (k, rows, columns); NaN where there is no value.

        Raises
        ------
        DataError
            Frames the file does not have, or that cannot be decoded.
        """
        if not 0 <= start < stop <= self.frames:
            raise DataError(f"{self.source}: frames {start}:{stop} asked for, but it has 0:{self.frames}")
        stored = self.read_block(start, stop)
        if self.offset:
            stored = np.asarray(stored, np.float64) - self.offset
        with np.errstate(over="ignore"):
            block = np.ascontiguousarray(stored, dtype=np.float32)
        if not (block.flags.writeable and block.flags.owndata):
            block = block.copy()  # a file's map is read-only, and somebody's array is not ours to blank dead pixels in
        if block.shape != (stop - start, self.rows, self.columns):
            raise DataError(
                f"{self.source}: frames {start}:{stop} came as {block.shape}, expected {(stop - start, self.rows, self.columns)}; "
                "the file is cut or its frames differ in size"
            )
        return block

    def blocks(self, memory: float = 64e6) -> Iterator[FrameArray]:
        """Iterate over all frames in order, in blocks of about ``memory`` bytes."""
        step = max(int(memory / (4.0 * self.rows * self.columns)), 1)
        for start in range(0, self.frames, step):
            yield self.read(start, min(start + step, self.frames))

    def with_notes(self, *notes: str) -> Recording:
        """Return the recording with further notes."""
        return replace(self, notes=(*self.notes, *notes))
