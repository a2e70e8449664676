"""Directional wavenumber spectra of the sea: one model per file, one interface."""

from seaglint.sea.spectra.base import DirectionalSpectrum
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.spectra.measured import MeasuredSpectrum, read_ndbc
from seaglint.sea.spectra.pierson_moskowitz import PiersonMoskowitzSpectrum

__all__ = ["DirectionalSpectrum", "ElfouhailySpectrum", "MeasuredSpectrum", "PiersonMoskowitzSpectrum", "read_ndbc"]
