"""Files of wave spectra: one family of formats per file, each with its own conventions of direction and units."""

from seaglint.io.waves.choice import WaveChoice
from seaglint.io.waves.read import FORMATS, Waves, read_waves

__all__ = ["FORMATS", "WaveChoice", "Waves", "read_waves"]
