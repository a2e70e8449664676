"""Directional wavenumber spectra of the sea: one model per file, one interface."""

from seaglint.sea.spectra.binned import BinnedSpectrum
from seaglint.sea.spectra.combined import CalmSpectrum, CombinedSpectrum
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.spectra.jonswap import JonswapSpectrum
from seaglint.sea.spectra.measured import MeasuredSpectrum
from seaglint.sea.spectra.pierson_moskowitz import PiersonMoskowitzSpectrum

__all__ = [
    "BinnedSpectrum",
    "CalmSpectrum",
    "CombinedSpectrum",
    "DirectionalSpectrum",
    "ElfouhailySpectrum",
    "JonswapSpectrum",
    "MeasuredSpectrum",
    "PiersonMoskowitzSpectrum",
]
