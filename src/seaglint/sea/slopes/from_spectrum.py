"""Slope statistics that follow from a wave spectrum."""

from __future__ import annotations

from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.directional import DirectionalSpectrum


def spectrum_slopes(spectrum: DirectionalSpectrum) -> SlopeStatistics:
    """Gaussian slopes with the variances of all waves of a spectrum.

    ``mss_up, mss_cross = int k^2 S(k) [1 +- a2(k)]/2 dk`` over the spectrum's whole range of wavenumbers.

    Parameters
    ----------
    spectrum : DirectionalSpectrum
        Any wave spectrum.

    Returns
    -------
    SlopeStatistics
        Upwind and crosswind variances about the spectrum's own wind direction.

    Notes
    -----
    As good as the spectrum's short waves, which carry most of the slope. At 10 m/s Elfouhaily's has 0.062, Cox and Munk's fit 0.055.
    Spectra with a tail ``k^-3`` (Pierson and Moskowitz, buoys) gain a slope variance per octave up to where they are cut off,
    370 rad/m here.

    Examples
    --------
    >>> from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
    >>> round(spectrum_slopes(ElfouhailySpectrum(10.0, 0.0)).mss, 3)
    0.062
    """
    up, cross = spectrum.mss()
    return SlopeStatistics(up, cross, spectrum.wind_to_azimuth)
