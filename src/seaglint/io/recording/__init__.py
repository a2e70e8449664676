"""Image sequences that users have, read block by block: one file per family of formats behind one record."""

from seaglint.io.recording.base import Recording
from seaglint.io.recording.open import open_recording
from seaglint.io.recording.raw import RawLayout

__all__ = ["RawLayout", "Recording", "open_recording"]
