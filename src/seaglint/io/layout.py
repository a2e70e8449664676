"""What a sequence holds, known before its first frame."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any, Final

from seaglint.conventions import FloatArray
from seaglint.io.provenance import band_attributes
from seaglint.io.truth import Truth
from seaglint.optics.band import Band

FORMAT: Final = "seaglint-sequence-1"
"""What the attribute ``seaglint_format`` of our sequences says."""


@dataclass(frozen=True)
class Layout:
    """What a sequence holds, known before its first frame."""

    azimuth_deg: FloatArray
    """Azimuth of the pixel columns [deg, (nx,)], or of all pixels (ny, nx) where the image is no grid of azimuth and elevation."""
    elevation_deg: FloatArray
    """Elevation of the pixel rows, from the top [deg, (ny,)], or of all pixels (ny, nx)."""
    frames: range
    """Numbers of the frames, counted in the whole sequence."""
    frame_rate: float
    """Frames per second [Hz]."""
    band: Band | None
    """Spectral response that the radiance is integrated over; None of textures."""
    variables: tuple[str, ...] = ("radiance",)
    """Names of the per-frame variables."""
    attributes: Mapping[str, Any] = field(default_factory=dict)
    """Provenance."""
    poses: Mapping[str, FloatArray] = field(default_factory=dict)
    """Place and attitude of a moving sensor in every frame, by variable [(frames,)]."""
    start: datetime | None = None
    """UTC of the first frame of the whole sequence, where a date is known."""
    per_frame: tuple[str, ...] = ()
    """Names of the variables that have one number a frame, found with its images."""
    details: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """Further attributes of variables, by name."""
    truth: Truth | None = None
    """Objects whose truth is written beside the images."""
    turning: bool = False
    """Whether the attitude changes: azimuth and elevation are then those of the first frame and not stored."""

    @property
    def shape(self) -> tuple[int, int, int]:
        """Frames, rows, columns."""
        return len(self.frames), self.elevation_deg.shape[0], self.azimuth_deg.shape[-1]

    @property
    def all_attributes(self) -> dict[str, Any]:
        """Global attributes: provenance, format and band."""
        return {
            **self.attributes,
            "seaglint_format": FORMAT,
            "frame_rate_hz": self.frame_rate,
            **band_attributes(self.band),
        }
