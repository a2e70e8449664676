"""Layout of a sequence, known before its first frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.free_form import Attributes
from seaglint.base.schema import VARIABLES
from seaglint.files.provenance import band_attributes
from seaglint.files.store.stored_truth import Truth
from seaglint.optics.band import Band
from seaglint.version import __version__

FORMAT: Final = "seaglint-sequence-1"  #: Value of the attribute ``seaglint_format`` of seaglint's sequences.

UNFINISHED: Final = "unfinished"  #: Attribute of a sequence that is being written: the number of shares of its work.

MOST_UNITS: Final = 256  #: Largest number of shards of a sequence, unless they would exceed :data:`MOST_BYTES`.

MOST_BYTES: Final = 256_000_000  #: Largest size of the arrays of a shard before compression [bytes].


@dataclass(frozen=True)
class Layout:
    """Layout of a sequence, known before its first frame."""

    #: Azimuth of the pixel columns [deg, (nx,)], or of all pixels (ny, nx) where the image is no grid of azimuth and elevation.
    azimuth_deg: FloatArray
    elevation_deg: FloatArray  #: Elevation of the pixel rows, from the top [deg, (ny,)], or of all pixels (ny, nx).
    frames: range  #: Numbers of the frames, counted in the whole sequence.
    frame_rate: float  #: Frames per second [Hz].
    band: Band | None  #: Spectral response that the radiance is integrated over; None of textures.
    variables: tuple[str, ...] = ("radiance",)  #: Names of the per-frame variables.
    attributes: Mapping[str, Any] = field(default_factory=dict)  #: Attributes of provenance.
    #: Place and attitude of a moving sensor in every frame, by variable [(frames,)].
    poses: Mapping[str, FloatArray] = field(default_factory=dict)
    start: datetime | None = None  #: UTC of the first frame of the whole sequence, where a date is known.
    per_frame: tuple[str, ...] = ()  #: Names of the variables that have one number a frame, found with its images.
    details: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)  #: Further attributes of variables, by name.
    truth: Truth | None = None  #: Objects whose truth is written beside the images.
    turning: bool = False  #: Flag of a changing attitude: azimuth and elevation are then those of the first frame and not stored.
    frames_per_unit: int = 1  #: Number of frames in a shard, which one process writes at once.

    @property
    def shape(self) -> tuple[int, int, int]:
        """Return frames, rows, columns."""
        return len(self.frames), self.elevation_deg.shape[0], self.azimuth_deg.shape[-1]

    @property
    def frame_bytes(self) -> int:
        """Return the size of a frame's images before compression."""
        _, rows, columns = self.shape
        truth = 0 if self.truth is None else self.truth.bytes_per_pixel
        return rows * columns * (truth + sum(np.dtype(VARIABLES[name].dtype).itemsize for name in self.variables))

    def in_units(self, frames: int) -> Layout:
        """Return the layout in the shards of a whole sequence of ``frames``, which are the same for all of its parts.

        >>> from seaglint.files.store.layout import Layout
        >>> small = Layout(np.zeros(8), np.zeros(4), range(5), 25.0, None)
        >>> [small.in_units(frames).frames_per_unit for frames in (1, 256, 257, 10_000)]
        [1, 1, 2, 40]
        """
        most = max(MOST_BYTES // max(self.frame_bytes, 1), 1)
        return replace(self, frames_per_unit=max(min(-(-frames // MOST_UNITS), most), 1))

    @property
    def all_attributes(self) -> Attributes:
        """Return the global attributes: provenance without a date, so that equal frames are equal files, format and band."""
        return {
            **self.attributes,
            **({"history": f"written by seaglint {__version__}"} if "history" in self.attributes else {}),
            "seaglint_format": FORMAT,
            "frame_rate_hz": self.frame_rate,
            **band_attributes(self.band),
        }
