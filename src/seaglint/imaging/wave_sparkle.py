r"""Tables of sparkles from the waves, by level of detail: variance of a pixel's lit share, fields larger than pixels, and times.

At a level the slopes that are no geometry are Gaussian short waves with the facets' variances and the spectrum's proportions
(``seaglint.sea.glitter.lit_share``). Pixels smaller than these waves share fields of independent cells of the sides a, 2a, 4a, ...,
which are multiplied. With cells of the variances ``o_j`` two places at a lag (x, y) have the mean product

.. math:: \prod_j [1 + o_j \Lambda(x/a_j) \Lambda(y/a_j)], \qquad \Lambda(t) = \max(0, 1 - |t|)

and a square the variance that follows. The ``o_j`` are fitted so that squares of all sides have the variance of the closed form; a pixel
has exactly that of its own size by a field of its own.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from seaglint.base.conventions import FloatArray, view_zenith_of_range, wrap_angle
from seaglint.facet.facet_tables import facet_slopes
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sunlight import visible_sun
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import Levels
from seaglint.imaging.sparkle import FIELD_STEPS, STEEPNESS_STEP, ClusterTable, sparkle_rows
from seaglint.radiance.lit_variance import WaveGlint
from seaglint.sea.glitter.lit_share import Clusters, disc_in_slopes
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

STEPS: Final = 13  #: Number of steps of the facets' steepness: up to 6 deviations.

FIELDS: Final = 5  #: Number of steps of the steepness at which fields of cells are fitted.

TYPICAL: Final = 1.0  #: Steepness of the facets for which times are computed, in deviations: their mean square near the mirrored Sun.

ARCS: Final = 9  #: Number of arcs of a level at which pixels are computed; logarithms are linear in between.

LEAST: Final = 1e-12  #: Least correlated area [m2].

SLIGHT: Final = 0.05  #: Share of a pixel's variance below which variances of squares count less in the fit of fields [1].

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)  #: Nodes of the lags in a square: variances are within a per cent.


class _Stretch(NamedTuple):
    """Arcs of a scene over which the same waves are geometry, and the fluctuation of the rest."""

    begin: float  #: First arc [m].
    clusters: Clusters


def cluster_table(glint: WaveGlint, view: SeaView, camera: Camera, levels: Levels) -> ClusterTable:
    """Return the table of a scene's levels of detail for its camera."""
    ground, stretches = sparkle_rows(camera), _stretches(glint, view.slopes, levels)
    nearest, farthest = max(float(ground.range_m.min()), 1.0), max(float(ground.range_m.max()), 1.1)

    def pixel(arc: float) -> tuple[float, float]:
        length, reach = (float(np.interp(arc, ground.range_m[::-1], column[::-1])) for column in (ground.along, ground.reach))
        return length, reach * camera.column_step

    reach = [1.0 / float(stretch.clusters.waves.wavenumber[0]) for stretch in stretches]
    widths = [pixel(max(stretch.begin, nearest))[1] for stretch in stretches]
    top = math.floor(math.log2(max(2.0 * math.pi * max(reach), 1e-3)))
    exponents = tuple(range(top, min(math.floor(math.log2(max(min(widths), 1e-4))), top) - 1, -1))
    rows = []
    for stretch, after, width in zip(stretches, [*(s.begin for s in stretches[1:]), farthest], widths, strict=True):
        first = min(max(stretch.begin, nearest), farthest)
        arcs = np.geomspace(first, max(min(after, farthest), 1.01 * first), ARCS)
        radius = _disc(view, camera, float(arcs[ARCS // 2]))
        made = _of_pixels(stretch.clusters, tuple(pixel(float(arc)) for arc in arcs), radius, exponents, width)
        rows.append((np.array([math.log(arcs[0]), (ARCS - 1) / math.log(arcs[-1] / arcs[0])]), *made))
    nodes, area, shares, times = (np.array([row[i] for row in rows]) for i in range(4))
    wind = stretches[0].clusters.waves.to_azimuth
    disc = 0.25 * _disc(view, camera, math.sqrt(nearest * farthest)) ** 2
    return ClusterTable(np.array([s.begin for s in stretches]), nodes, area, shares, times, np.array(reach), top, wind, disc)


def _stretches(glint: WaveGlint, slopes: SlopeStatistics, levels: Levels) -> list[_Stretch]:
    """Return the stretches of a scene, one for each length of the shortest wave that is geometry."""
    towards = slopes.wind_to_azimuth if glint.spectrum is None else glint.spectrum.wind_to_azimuth
    out: list[_Stretch] = []
    known = math.nan
    for begin, level in zip(levels.begins, levels.detail.levels, strict=True):
        if level.shortest_wave == known:
            # averages of a level change the variance of its facets by a few per cent, and the shape of their waves hardly
            continue
        known = level.shortest_wave
        facets = facet_slopes(slopes, level.mss, towards, level.covariance)
        out.append(_Stretch(float(begin), _clusters(glint, slopes, facets, 2.0 * math.pi / known if math.isfinite(known) else 0.0)))
    return out


@lru_cache(maxsize=64)
def _clusters(glint: WaveGlint, slopes: SlopeStatistics, facets: SlopeStatistics, cut: float) -> Clusters:
    """Short waves beyond a wavenumber [rad/m] with the variances of facets; longer waves are geometry."""
    waves = glint.short_waves(slopes, cut)
    axis = waves.to_azimuth
    return Clusters(waves.scaled(float(facets.mss_along(axis)), float(facets.mss_along(axis + 0.5 * math.pi))))


def _disc(view: SeaView, camera: Camera, arc: float) -> float:
    """Radius of the disc in slopes where the Sun is mirrored at an arc [m], at the azimuth of the view nearest to the Sun [1]."""
    half = 0.5 * camera.width
    aside = max(abs(float(wrap_angle(view.solar_azimuth - camera.azimuth))) - half, 0.0)
    theta = float(view_zenith_of_range(camera.height, np.array([arc]))[0])
    _, zenith = visible_sun(view.solar_zenith)
    sight, sun = (
        np.array([-math.sin(theta), 0.0, math.cos(theta)]),
        np.array([math.sin(zenith) * math.cos(aside), math.sin(zenith) * math.sin(aside), math.cos(zenith)]),
    )
    half_vector = sight + sun
    cosine = max(0.5 * float(np.linalg.norm(half_vector)), 1e-3)
    tilt = max(float(half_vector[2]) / (2.0 * cosine), 0.05)
    return float(disc_in_slopes(view.disc.lit_radius, tilt, cosine))


@lru_cache(maxsize=64)
def _of_pixels(
    clusters: Clusters, boxes: tuple[tuple[float, float], ...], radius: float, exponents: tuple[int, ...], width: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Logarithms of correlated areas (arcs, ways, steepness), variances of fields (steepness, sides), times of the fields and of pixels."""
    area = np.empty((len(boxes), 2, STEPS))
    for i, box in enumerate(boxes):
        for way, turn in enumerate((0.0, 0.5 * math.pi)):
            for u in range(STEPS):
                variance = clusters.variance(STEEPNESS_STEP * u, radius, box, turn)
                area[i, way, u] = math.log(max(variance * box[0] * box[1], LEAST))
    sides, longest = 2.0 ** np.array(exponents, np.float64), 2.0 * math.pi / float(clusters.waves.wavenumber[0])
    used = np.flatnonzero((sides <= longest) & (sides > width))
    shares, times = np.zeros((FIELDS, sides.size)), np.ones(sides.size + 1)
    if used.size:
        boxes_of = np.append(sides[used], width)
        for u in range(FIELDS):
            steepness = u * FIELD_STEPS * STEEPNESS_STEP
            targets = np.array([clusters.variance(steepness, radius, (side, side)) for side in boxes_of])
            shares[u, used] = fields(sides[used], width, targets)
        for j in used:
            times[j] = clusters.correlation_time(TYPICAL, radius, (float(sides[j]), float(sides[j])))
    times[-1] = clusters.correlation_time(TYPICAL, radius, boxes[len(boxes) // 2])
    return area, shares, times


def fields(sides: FloatArray, width: float, targets: FloatArray) -> FloatArray:
    """Variances of fields of cells of these sides whose product has stated variances in squares.

    Parameters
    ----------
    sides : ndarray
        Sides of the cells [m, (n,)].
    width : float
        Side of a pixel [m]; below it pixels have a field of their own.
    targets : ndarray
        Relative variance in squares of these sides, and of the pixel [1, (n + 1,)].

    Returns
    -------
    ndarray
        Variance of a cell of each field [1, (n,)].
    """
    boxes = np.append(sides, width)
    lag, weight = (NODES + 1.0) / 2.0, WEIGHTS / 2.0
    pairs = boxes[:, None] * lag
    kernel = np.outer(2.0 * (1.0 - lag) * weight, 2.0 * (1.0 - lag) * weight)
    # overlap of cells at the lags of each box, along one axis (boxes, fields, lags)
    overlap = np.clip(1.0 - pairs[:, None, :] / sides[:, None], 0.0, None)
    both = overlap[:, :, :, None] * overlap[:, :, None, :]

    def variances(shares: FloatArray) -> FloatArray:
        coarse = np.sum(kernel * np.prod(1.0 + shares[:, None, None] * both, axis=1), axis=(1, 2))
        # the pixel's own field has what is left of its variance, independent of its neighbours'
        own = max(1.0 + targets[-1] - coarse[-1], 0.0)
        return np.asarray(coarse - 1.0 + own * (width / boxes) ** 2)

    def misfit(logs: FloatArray) -> FloatArray:
        # squares larger than the waves have less variance than any field of independent cells: they count less
        return np.asarray((variances(np.exp(logs)) - targets) / (targets + SLIGHT * targets[-1]))

    start = np.log(np.clip((1.0 + targets[1:]) / (1.0 + targets[:-1]) - 1.0, 1e-4, 9.0))
    result = least_squares(misfit, start, bounds=(math.log(1e-6), math.log(100.0)), xtol=1e-3, ftol=1e-3, max_nfev=40)
    return np.asarray(np.exp(result.x))
