"""Files of wave spectra: one family of formats per file, each with its own conventions of direction and units."""

from seaglint.files.waves.record_choice import WaveChoice
from seaglint.files.waves.wave_formats import FORMATS, WavesFromFile, read_waves

__all__ = ["FORMATS", "WaveChoice", "WavesFromFile", "read_waves"]
