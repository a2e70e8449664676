"""Readers of image sequences as recordings to analyse: one file per family of formats."""

from seaglint.files.recording.open import open_recording
from seaglint.files.recording.raw import RawLayout

__all__ = ["RawLayout", "open_recording"]
