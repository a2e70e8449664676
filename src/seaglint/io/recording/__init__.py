"""Image sequences that users have, opened as recordings to analyse: one file per family of formats."""

from seaglint.io.recording.open import open_recording
from seaglint.io.recording.raw import RawLayout

__all__ = ["RawLayout", "open_recording"]
