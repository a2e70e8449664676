"""Slope statistics that follow from a wave spectrum."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Final

import numpy as np

from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.tiles import resolve_limit

_LENGTHS: Final = 24
"""Number of wavelengths at which covariances are taken."""


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


def nested_in(slopes: SlopeStatistics, spectrum: DirectionalSpectrum) -> SlopeStatistics:
    """Return slopes with the covariances of a spectrum's longer waves.

    They are the ``nesting`` of :class:`~seaglint.sea.slopes.slope_statistics.SlopeStatistics`, up to where they reach 0.8 of the slopes'
    variances; shorter waves are taken to add evenly to what is left.

    Parameters
    ----------
    slopes : SlopeStatistics
        Slopes of all waves, by any law.
    spectrum : DirectionalSpectrum
        Waves of the same sea.

    Returns
    -------
    SlopeStatistics
        The same slopes; flat ones as they are.
    """
    limit = resolve_limit(spectrum, slopes)
    low = spectrum.wavenumber_range[0]
    if limit <= low:
        return slopes
    turn = spectrum.wind_to_azimuth - slopes.wind_to_azimuth
    c, s = float(np.cos(turn)), float(np.sin(turn))
    edges = np.geomspace(low, limit, _LENGTHS + 1)
    up = cross = both = 0.0
    nesting = [(float(low), up, cross, both)]
    for least, most in pairwise(edges):
        along, beside = spectrum.mss(float(most), float(least))
        mixed = spectrum.slope_covariance(float(most), float(least))
        up += along * c * c - 2.0 * mixed * c * s + beside * s * s
        cross += along * s * s + 2.0 * mixed * c * s + beside * c * c
        both += (along - beside) * c * s + mixed * (c * c - s * s)
        nesting.append((float(most), up, cross, both))
    return replace(slopes, nesting=tuple(nesting))
