"""Files of wave spectra: one file per family of formats, each with its own conventions of direction and units."""

from seaglint.formats.waves.wave_formats import FORMATS, WavesFromFile, read_waves
from seaglint.formats.waves.wave_records import WaveChoice

__all__ = ["FORMATS", "WaveChoice", "WavesFromFile", "read_waves"]
