"""Slope statistics that follow from a wave spectrum."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.sea.slopes.slope_statistics import SHORTEST, SlopeStatistics
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.tiles import resolve_limit

_LENGTHS: Final = 24  #: Number of wavelengths at which covariances are taken.

_RIPPLES: Final = 13  #: Number of wavelengths of the ripples.

#: Width of ripples without a spectrum in the logarithm of the wavenumber: a first part, and one by the slope variance up to an end.
#:
#: Ripples that are even over this width have the breadth of Elfouhaily's seas, to which the number of bands by slope variance belongs.
_BREADTH: Final = (2.7, 156.0, 0.0337)


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


def nested_in(slopes: SlopeStatistics, spectrum: DirectionalSpectrum | None, calm: DirectionalSpectrum | None = None) -> SlopeStatistics:
    """Return slopes with the covariances of a spectrum's longer waves.

    They are the ``nesting`` of :class:`~seaglint.sea.slopes.slope_statistics.SlopeStatistics`: of the spectrum up to where they reach 0.8
    of the slopes' variances, and ripples that make up the slopes. These have the spectrum's shares of every shorter length as far as its
    shorter waves suffice; variance that no wave of the spectrum accounts for, as with swell alone, is even over the logarithm of the
    wavenumber, as broad as seas of these slopes are (``_BREADTH``).

    In light winds, where slopes are :attr:`~seaglint.sea.slopes.slope_statistics.SlopeStatistics.directed` in part, that part has these
    covariances and the rest has the covariances without the wind sea, so that the sea passes to a calm without a step.

    Parameters
    ----------
    slopes : SlopeStatistics
        Slopes of all waves, by any law.
    spectrum : DirectionalSpectrum, optional
        Waves of the same sea; None without waves.
    calm : DirectionalSpectrum, optional
        The waves among them that do not depend on the wind, a swell; None without such waves.

    Returns
    -------
    SlopeStatistics
        The same slopes; flat slopes are returned unchanged.
    """
    if min(slopes.mss_up, slopes.mss_cross) <= 0.0:
        return slopes
    directed = 1.0 if slopes.directed is None else slopes.directed
    grown = _grown(slopes, spectrum)
    if directed < 1.0:
        calm_grown = _grown(slopes, calm)
        k = np.unique(np.concatenate([grown[:, 0], calm_grown[:, 0]]))
        both = [
            np.stack([np.interp(np.log(k), np.log(table[:, 0]), column) for column in table.T[1:]], axis=1) for table in (grown, calm_grown)
        ]
        grown = np.column_stack([k, directed * both[0] + (1.0 - directed) * both[1]])
    return replace(slopes, nesting=tuple((float(k), float(up), float(cross), float(both)) for k, up, cross, both in grown))


def _grown(slopes: SlopeStatistics, spectrum: DirectionalSpectrum | None) -> FloatArray:
    """Wavenumbers [rad/m], and covariances of the slopes of all longer waves, up, cross and both [1, (n, 4)]."""
    width = _BREADTH[0] + _BREADTH[1] * min(slopes.mss, _BREADTH[2])
    if spectrum is None:
        share = np.linspace(0.0, 1.0, _LENGTHS)
        return np.column_stack([SHORTEST * np.exp(width * (share - 1.0)), np.outer(share, [slopes.mss_up, slopes.mss_cross, 0.0])])
    low, limit = spectrum.wavenumber_range[0], resolve_limit(spectrum, slopes)
    if slopes.directed is not None:
        # all waves of a vanishing wind sea are below the limit: without this, its residual variance would be in ripples above 1e4 rad/m
        limit = min(limit, SHORTEST)
    # covariances are turned from the spectrum's axes to the axes of the slopes
    turn = spectrum.wind_to_azimuth - slopes.wind_to_azimuth
    c, s = float(np.cos(turn)), float(np.sin(turn))
    top = max(SHORTEST, 2.0 * limit)
    first = min(low, top * float(np.exp(-width)))
    edges = np.concatenate(
        [
            np.geomspace(first, low, _LENGTHS)[:-1] if first < low else [],
            np.geomspace(low, limit, _LENGTHS),
            np.geomspace(limit, top, _RIPPLES)[1:],
        ]
    )
    grown, shorter = np.zeros((edges.size, 3)), np.zeros(edges.size)
    for i, (least, most) in enumerate(pairwise(edges), start=1):
        along, across = spectrum.mss(float(most), float(least))
        mixed = spectrum.slope_covariance(float(most), float(least))
        parts = (
            along * c * c - 2.0 * mixed * c * s + across * s * s,
            along * s * s + 2.0 * mixed * c * s + across * c * c,
            (along - across) * c * s + mixed * (c * c - s * s),
        )
        # waves above the limit only give the ripples their shape
        longer = most <= limit * (1.0 + 1e-9)
        grown[i] = grown[i - 1] + (parts if longer else 0.0)
        shorter[i] = shorter[i - 1] + (0.0 if longer else along + across)
    missing = np.array([slopes.mss_up, slopes.mss_cross, 0.0]) - grown[-1]
    supplied = min(float(shorter[-1]) / max(float(missing[0] + missing[1]), 1e-300), 1.0)
    even = np.clip(1.0 + np.log(edges / top) / width, 0.0, 1.0)
    grown += np.outer(supplied * shorter / max(float(shorter[-1]), 1e-300) + (1.0 - supplied) * even, missing)
    return np.column_stack([edges, grown])
