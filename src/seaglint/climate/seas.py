"""Slopes of the sea and their shadowing at any wind, tabulated for draws with winds of their own."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.facet.glint import floored
from seaglint.facet.legs import Shadowing
from seaglint.sea.shadowing.nested import HIGHEST, between_bands, ratio_table
from seaglint.sea.shadowing.seen_and_lit import coupling_table
from seaglint.sea.shadowing.smith import projected_area
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

SlopesAt = Callable[[float], SlopeStatistics]  #: Function that returns the slopes of the sea at a wind [m/s] that blows towards azimuth 0.

_STEP: Final = 0.2  #: Step of winds of the table [m/s]: slope variances are linear in the wind within 1e-4 of themselves over it.

#: Steps of the rms slope, which the law of hiding depends on; shares of facets are interpolated linearly between them, within 1e-3.
_DEVIATIONS: Final = 0.006

_AREA_WIND: Final = 2.0
_EDGES: Final = 31
_TURNS: Final = 19
_SUNS: Final = 12  #: Number of azimuths of the Sun in a half circle over which the number of bands is averaged.


class WindSlopes(NamedTuple):
    """Slopes against the wind, as kernels read them. Made by :func:`seas`."""

    first: float  #: Lowest wind, and step [m/s].
    step: float
    #: Slope parameters of each wind [(winds, 9)].
    #:
    #: These are variances along and across the waves, series (c21, c03, c40, c22, c04), rms slope of one direction, azimuth of the waves
    #: from the wind's [rad].
    slopes: FloatArray
    is_gaussian: bool
    sun_leg: bool
    first_deviation: float
    deviation_step: float
    ratio: FloatArray  #: Tables of the nested law [(rms slopes, rows, columns)]; empty ones for Smith's.
    coupling: FloatArray  #: Tables of facets seen and lit [(rms slopes, view, Sun, slope)].
    lean: FloatArray  #: Tables of the lean of facets [(rms slopes, views, slopes)].
    gains: FloatArray  #: Gains of the lean at each wind [(winds, azimuths)].
    area: FloatArray  #: Ratio of the visible area to that of Gaussian slopes [(winds, edges, turns)]; empty for those.


def seas(slopes_at: SlopesAt, winds: tuple[float, float], shadowing: Shadowing) -> WindSlopes:
    """Tabulate slopes between two winds [m/s]."""
    low, high = winds
    count = max(int(np.ceil((high - low) / _STEP)) + 1, 2)
    nodes = np.linspace(low, max(high, low + 1e-6), count)
    statistics = [floored(slopes_at(float(min(wind, high)))) for wind in nodes]
    deviations = np.array([math.sqrt(0.5 * s.mss) for s in statistics])
    table = np.array([[s.mss_up, s.mss_cross, *s.coefficients] for s in statistics])
    first, last = float(deviations.min()), float(deviations.max())
    steps = 1 if last == first else max(int(np.ceil((last - first) / _DEVIATIONS)) + 1, 2)
    grid = np.linspace(first, last, steps)
    bands = np.interp(grid, deviations, [_mean_bands(shadowing, s) for s in statistics])
    return WindSlopes(
        low,
        float(nodes[1] - nodes[0]),
        np.column_stack([table, deviations, [s.wind_to_azimuth for s in statistics]]),
        all(s.is_gaussian for s in statistics),
        shadowing.sun,
        first,
        float(grid[1] - grid[0]) if steps > 1 else 1.0,
        np.stack([between_bands(ratio_table, float(b)) for b in bands]),
        np.stack([coupling_table(float(b), float(d)) for b, d in zip(bands, grid, strict=True)])
        if shadowing.sun
        else np.zeros((steps, 0, 0, 0)),
        np.stack([replace(shadowing, bands=float(b)).leaning(statistics[0])[0] for b in bands]),
        np.stack([shadowing.leaning(s)[1] for s in statistics]),
        np.zeros((0, 0, 0)) if all(s.is_gaussian for s in statistics) else _areas(slopes_at, nodes, shadowing),
    )


def _mean_bands(shadowing: Shadowing, slopes: SlopeStatistics) -> float:
    """Number of bands of the law, the mean over azimuths of the Sun from the wind's."""
    turns = np.pi / _SUNS * np.arange(_SUNS)
    return float(np.mean([shadowing.settled(slopes, slopes.wind_to_azimuth + turn).law_bands(slopes) for turn in turns]))


def _areas(slopes_at: SlopesAt, nodes: FloatArray, shadowing: Shadowing) -> FloatArray:
    """Area ratios at every tenth wind, elevations of the view to 6 rms slopes, and half of the circle from the downwind direction."""
    edge = np.maximum(np.linspace(0.0, HIGHEST, _EDGES), 1e-9)
    turn = np.linspace(0.0, np.pi, _TURNS)
    out = []
    for wind in np.linspace(nodes[0], nodes[-1], max(int(np.ceil((nodes[-1] - nodes[0]) / _AREA_WIND)) + 1, 2)):
        slopes = floored(slopes_at(float(wind)))
        deviation = np.sqrt(slopes.mss_along(turn + slopes.wind_to_azimuth))
        zenith = np.arctan(1.0 / (edge[:, None] * deviation))
        area = replace(shadowing, bands=_mean_bands(shadowing, slopes)).area(zenith, turn + slopes.wind_to_azimuth + 0.0 * zenith, slopes)
        out.append(area / projected_area(zenith, deviation**2))
    return np.stack(out)
