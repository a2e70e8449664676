"""Readers of image sequences as recordings to analyse: one file per family of formats."""

from seaglint.formats.recording.arrays import RawLayout
from seaglint.formats.recording.reader_choice import open_recording

__all__ = ["RawLayout", "open_recording"]
