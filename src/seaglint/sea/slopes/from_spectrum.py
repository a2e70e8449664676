"""Slope statistics that follow from a wave spectrum."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Final

import numpy as np

from seaglint.sea.slopes.slope_statistics import SHORTEST, SlopeStatistics
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.tiles import resolve_limit

_LENGTHS: Final = 24
"""Number of wavelengths at which covariances are taken."""

_RIPPLES: Final = 12
"""Number of those of the ripples."""


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

    They are the ``nesting`` of :class:`~seaglint.sea.slopes.slope_statistics.SlopeStatistics`: of the spectrum up to where they reach 0.8
    of the slopes' variances, and below that length of ripples that make up the slopes, with the spectrum's shares of every length.

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
        nesting.append((float(most), float(up), float(cross), float(both)))
    edges = np.geomspace(limit, max(SHORTEST, 2.0 * limit), _RIPPLES + 1)
    shares = np.array([sum(spectrum.mss(float(most), float(least))) for least, most in pairwise(edges)])
    if shares.sum() <= 0.0:
        shares = np.ones(_RIPPLES)
    for k, x in zip(edges[1:], np.cumsum(shares) / shares.sum(), strict=True):
        rest = (up + x * (slopes.mss_up - up), cross + x * (slopes.mss_cross - cross), both * (1.0 - x))
        nesting.append((float(k), *(float(part) for part in rest)))
    return replace(slopes, nesting=tuple(nesting))
