"""Radiance of the mirrored Sun for many looks at once, each with its weather, Sun, height and direction, and measures of it.

``seas`` tabulates slopes of the sea and their shadowing against the wind. ``looks`` evaluates the mean radiance of each look, or of
the brightest direction about it. The measures for a designer are the mean, mean plus deviations (``deviation``), pixels above a
threshold (``passes``) and hidden targets (``detected``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from scipy.special import gammaincc

from seaglint.air.protocol import slant_range
from seaglint.base.constants import EARTH_RADIUS, EFFECTIVE_EARTH_RADIUS, SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import in_threads, kernel, njit
from seaglint.climate.mirrored_sunlight import (
    MirroredLight,
    between_kernel,
    elevation_kernel,
    height_coordinate,
    light_of,
    place_even,
    place_in_pieces,
    sun_coordinate_kernel,
    view_range_kernel,
)
from seaglint.facet.foam import FoamCover
from seaglint.facet.glint import FacetDensity, SunDisc, aim_disc, chance_kernel, floored, place_kernel, sun_disc
from seaglint.facet.legs import Legs, Shadowing
from seaglint.facet.sea_view import sea_arc
from seaglint.facet.sunlight import STEADY, turn_kernel
from seaglint.radiance.lit_variance import WaveGlint, variance_by_wind
from seaglint.radiance.variance import patches_of_tilt, point_variance
from seaglint.sea.shadowing.nested import HIGHEST, between_bands, ratio_table
from seaglint.sea.shadowing.seen_and_lit import coupling_table
from seaglint.sea.shadowing.smith import projected_area, visible_area_kernel
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

SlopesAt = Callable[[float], SlopeStatistics]  #: Function that returns the slopes of the sea at a wind [m/s] that blows towards azimuth 0.

_STEP: Final = 0.2  #: Step of winds of the table [m/s]: slope variances are linear in the wind within 1e-4 of themselves over it.

#: Steps of the rms slope, which the law of hiding depends on; shares of facets are interpolated linearly between them, within 1e-3.
_DEVIATIONS: Final = 0.006

_AREA_WIND: Final = 2.0  #: Step of winds of the area ratios [m/s].
_EDGES: Final = 31  #: Number of elevations of the view of the area ratios.
_TURNS: Final = 19  #: Number of directions in a half circle of the area ratios.
_SUNS: Final = 12  #: Number of azimuths of the Sun in a half circle over which the number of bands is averaged.


class WindSlopes(NamedTuple):
    """Slopes against the wind, as kernels read them. Made by ``seas``."""

    first: float  #: Lowest wind [m/s].
    step: float  #: Step of the wind [m/s].
    #: Slope parameters of each wind [(winds, 10)].
    #:
    #: These are variances along and across the waves, series (c21, c03, c40, c22, c04), rms slope of one direction, azimuth of the waves
    #: from the wind's [rad], and the share of the sea that mirrors: what is not bubbles of foam.
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


def seas(
    slopes_at: SlopesAt, winds: tuple[float, float], shadowing: Shadowing, foam_at: Callable[[float], FoamCover] | None = None
) -> WindSlopes:
    """Tabulate slopes between two winds [m/s], and the foam of every wind; without ``foam_at`` the sea has none."""
    low, high = winds
    # Two nodes that differ, even for a single wind: interpolation needs an interval.
    nodes = np.linspace(low, max(high, low + 1e-6), max(int(np.ceil((high - low) / _STEP)) + 1, 2))
    statistics = [floored(slopes_at(float(min(wind, high)))) for wind in nodes]
    deviations = np.array([math.sqrt(0.5 * s.mss) for s in statistics])
    mirroring = [1.0 if foam_at is None else foam_at(float(min(wind, high))).mirroring for wind in nodes]
    table = np.array([[s.mss_up, s.mss_cross, *s.coefficients] for s in statistics])
    first, last = float(deviations.min()), float(deviations.max())
    steps = 1 if last == first else max(int(np.ceil((last - first) / _DEVIATIONS)) + 1, 2)
    grid = np.linspace(first, last, steps)
    bands = np.interp(grid, deviations, [_mean_bands(shadowing, s) for s in statistics])
    gaussian = all(s.is_gaussian for s in statistics)
    return WindSlopes(
        first=low,
        step=float(nodes[1] - nodes[0]),
        slopes=np.column_stack([table, deviations, [s.wind_to_azimuth for s in statistics], mirroring]),
        is_gaussian=gaussian,
        sun_leg=shadowing.sun,
        first_deviation=first,
        deviation_step=float(grid[1] - grid[0]) if steps > 1 else 1.0,
        ratio=np.stack([between_bands(ratio_table, float(b)) for b in bands]),
        coupling=np.stack([coupling_table(float(b), float(d)) for b, d in zip(bands, grid, strict=True)])
        if shadowing.sun
        else np.zeros((steps, 0, 0, 0)),
        lean=np.stack([replace(shadowing, bands=float(b)).leaning(statistics[0])[0] for b in bands]),
        gains=np.stack([shadowing.leaning(s)[1] for s in statistics]),
        area=np.zeros((0, 0, 0)) if gaussian else _areas(slopes_at, nodes, shadowing),
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


DUSK: Final = 0.3  #: Depression of the Sun from which it is above no horizon in view [rad].

_FAINT: Final = 1e-300  #: Radiance of a lit sea with negligible glint [W m-2 sr-1], so that it is above 0 wherever the Sun is up.

#: Quantities of a look, in the order of the kernel's array.
#:
#: These are index of the model atmosphere in the table, U10 [m/s], azimuth it blows to [rad], sensor's height [m], the Sun's direction
#: [rad] and ``1/d^2``, azimuth of the look and its depression [rad].
COLUMNS: Final = ("model", "wind", "wind_to", "height", "solar_zenith", "solar_azimuth", "irradiance_factor", "azimuth", "depression")


@dataclass(frozen=True)
class Search:
    """Directions about each look among which the brightest is used; by default the look alone."""

    depressions: int = 1  #: Number of depressions tried at first, even in the squeezed elevation.
    azimuths: int = 1  #: Number of azimuths tried at first, evenly spaced.
    refinements: int = 0  #: Halvings of the steps about the brightest.
    half_width: float = 0.0  #: Azimuths to each side [rad].


@dataclass(frozen=True, eq=False)
class Looks:
    """Results of looks [(n,) each]; 0 where no Sun is up or no sea in view, and the least number where glint is negligible."""

    radiance: FloatArray  #: Radiance of the mirrored Sun at the sensor [W m-2 sr-1].
    chance: FloatArray  #: Share of the viewed area that mirrors the Sun [1].
    cos_incidence: FloatArray
    elevation: FloatArray  #: Elevation of the viewer at the sea there [rad]; negative where the look misses the sea.
    sun_up: FloatArray  #: Sine of the elevation there of the visible part of the Sun [1].
    radius: FloatArray  #: Radius of the light's disc [rad].
    light_from_wind: FloatArray  #: Azimuth of the light from the direction in which waves travel [rad].


def looks(draws: FloatArray, light: MirroredLight, sea: WindSlopes, search: Search = Search()) -> Looks:
    """Mirrored Sun of each look, or of the brightest direction about it.

    Parameters
    ----------
    draws : ndarray
        Looks [(n, 9)], columns as in ``COLUMNS``. With several depressions the range of ``light`` is searched, whatever the column
        holds.
    light : MirroredLight
        Sunlight through the air.
    sea : WindSlopes
        Slopes.
    search : Search
        Directions.

    Notes
    -----
    Shares of facets agree with :func:`seaglint.facet.glint.glint` at the mean number of bands over azimuths of the Sun; winds beyond the
    tables count as the nearest.
    """
    rows, levels = np.ascontiguousarray(draws, dtype=np.float64), height_coordinate(draws[:, 3])
    out = np.zeros((rows.shape[0], 5))
    plan = _LookPlan(search.depressions, search.azimuths, search.refinements, search.half_width, *light.depression)
    disc = sun_disc(0.0, 0.0, STEADY)
    in_threads(lambda part: _fill(part, rows, levels, light, sea, plan, disc.rule, out), rows.shape[0])
    radius, aside = np.full(rows.shape[0], SOLAR_ANGULAR_RADIUS), rows[:, 5] - rows[:, 2]
    return Looks(*(np.ascontiguousarray(column) for column in (*out.T, radius, aside)))


class _LookPlan(NamedTuple):
    depressions: int
    azimuths: int
    refinements: int
    half_width: float
    low: float
    high: float


class Way(NamedTuple):
    """Position of a direction among the nodes of the light."""

    wind: int  #: First node of wind.
    height: int  #: First node of height.
    coarse: tuple[float, float]  #: Coordinates of wind and height among the nodes of the mean reflectance.
    across: float  #: Coordinate of the view, 0 to 1.
    weights: FloatArray  #: Weights of the cubics; those of view and Sun are filled later [(4, 4)].


class SeaState(NamedTuple):
    """Sea at one wind, equal for all directions."""

    density: FacetDensity
    wind: float  #: Wind in steps of the table.
    law: float  #: Coordinate of its rms slope among the tables of the law of hiding.
    sun_deviation: float
    series: float
    wave_azimuth: float
    mirroring: float  #: Share of the sea that mirrors [1].


@kernel
def _area_ratio(sea: WindSlopes, wind: float, edge: float, turn: float) -> float:
    """Ratio of the visible area to its value for Gaussian slopes.

    ``wind`` is in steps of the slopes, ``turn`` from the waves' direction [rad].
    """
    if sea.area.shape[0] == 0:
        return 1.0
    folded = abs((turn + math.pi) % (2.0 * math.pi) - math.pi)
    x = wind / max(sea.slopes.shape[0] - 1.0, 1.0) * (sea.area.shape[0] - 1)
    y = min(max(edge, 0.0), HIGHEST) / HIGHEST * (sea.area.shape[1] - 1)
    z = folded / math.pi * (sea.area.shape[2] - 1)
    i, j, k = min(int(x), sea.area.shape[0] - 2), min(int(y), sea.area.shape[1] - 2), min(int(z), sea.area.shape[2] - 2)
    # Linear in wind, elevation and direction.
    f, g, h = x - i, y - j, z - k
    total = 0.0
    for a in range(2):
        for b in range(2):
            both = sea.area[i + a, j + b, k] * (1.0 - h) + sea.area[i + a, j + b, k + 1] * h
            total += (f if a == 1 else 1.0 - f) * (g if b == 1 else 1.0 - g) * both
    return total


@njit
def sea_at(sea: WindSlopes, row: FloatArray, coefficients: FloatArray) -> SeaState:
    """Sea under the wind of a look; fills the coefficients of its series."""
    wind = min(max((row[1] - sea.first) / sea.step, 0.0), sea.slopes.shape[0] - 1.0)
    i = min(int(wind), sea.slopes.shape[0] - 2)
    f = wind - i
    low, high = sea.slopes[i], sea.slopes[i + 1]
    for k in range(5):
        coefficients[k] = (1.0 - f) * low[2 + k] + f * high[2 + k]
    up, cross = (1.0 - f) * low[0] + f * high[0], (1.0 - f) * low[1] + f * high[1]
    azimuth = row[2] + (1.0 - f) * low[8] + f * high[8]
    s, c, a, b = math.sin(azimuth), math.cos(azimuth), math.sqrt(up), math.sqrt(cross)
    density = FacetDensity(up, cross, a, b, 1.0 / (8.0 * math.pi * a * b), s, c, sea.is_gaussian, coefficients)
    turn = row[5] - azimuth
    deviation = math.sqrt(up * math.cos(turn) ** 2 + cross * math.sin(turn) ** 2)
    series = _area_ratio(sea, wind, 1.0 / max(math.tan(min(row[4], 0.5 * math.pi - SOLAR_ANGULAR_RADIUS)) * deviation, 1e-9), turn)
    law = ((1.0 - f) * low[7] + f * high[7] - sea.first_deviation) / sea.deviation_step
    return SeaState(density, wind, law, deviation, series, azimuth, low[9] + f * (high[9] - low[9]))


@njit
def direction(
    row: FloatArray,
    gamma: float,
    arc: float,
    azimuth: float,
    light: MirroredLight,
    sea: WindSlopes,
    state: SeaState,
    disc: SunDisc,
    place: Way,
) -> tuple[float, float, float, float]:
    """Radiance, chance, cosine of incidence and the sine of the Sun's elevation of one direction; fills weights of ``place``."""
    away = azimuth + math.pi
    view = (math.cos(gamma), math.sin(gamma), math.sin(away), math.cos(away))
    turn = turn_kernel(arc / EARTH_RADIUS)
    up = place_kernel((-view[2], -view[3]), turn, disc).middle[2]
    edge_area = -1.0
    if not sea.is_gaussian:
        beside = away - state.wave_azimuth
        deviation = math.sqrt(state.density.mss_up * math.cos(beside) ** 2 + state.density.mss_cross * math.sin(beside) ** 2)
        edge = view[1] / max(view[0] * deviation, 1e-12)
        edge_area = visible_area_kernel(view[1], view[0] * deviation) * _area_ratio(sea, state.wind, edge, beside)
    at = min(int(state.law), max(sea.ratio.shape[0] - 2, 0))
    more = state.law - at
    chance, cosine = 0.0, 0.0
    # Linear between the two tables of the law of hiding that bracket the rms slope; a table without weight is not evaluated.
    for k in range(2):
        share = more if k == 1 else 1.0 - more
        if share <= 0.0 or (k == 1 and chance == 0.0 and more < 1.0):
            continue
        legs = Legs(
            sea.sun_leg, 0.0, row[5], math.sin(row[5]), math.cos(row[5]), 0.0, state.sun_deviation, state.series,
            sea.ratio[at + k], sea.coupling[at + k], sea.lean[at + k], sea.gains[min(int(state.wind + 0.5), sea.gains.shape[0] - 1)],
            state.wave_azimuth,
        )  # fmt: skip
        part, cosine, _ = chance_kernel(view, away, turn, edge_area, state.density, disc, legs)
        chance += share * part
    if chance <= 0.0:
        return 0.0, 0.0, cosine, up
    chance *= state.mirroring
    weights, coarse, across = place.weights, place.coarse, place.across
    sun = sun_coordinate_kernel(up)
    v, s = place_even(across, light.values.shape[3], weights[2]), place_even(sun, light.values.shape[4], weights[3])
    inner = (coarse[0], coarse[1], across * (light.shapes.shape[3] - 1), sun * (light.shapes.shape[4] - 1))
    shown = light_of(light, int(row[0]), (place.wind, place.height, v, s), weights, cosine, inner)
    return row[6] * chance * shown, chance, cosine, up


@njit
def _fill(
    part: tuple[int, int],
    draws: FloatArray,
    levels: FloatArray,
    light: MirroredLight,
    sea: WindSlopes,
    plan: _LookPlan,
    rule: FloatArray,
    out: FloatArray,
) -> None:
    points, coefficients, weights = np.empty((7, 4)), np.empty(5), np.zeros((4, 4))
    for n in range(part[0], part[1]):
        row = draws[n]
        # A negative elevation marks a look that misses the sea.
        out[n, 3] = -1.0
        if row[4] > 0.5 * math.pi + DUSK:
            continue
        aim_disc(points, row[4], row[5], SOLAR_ANGULAR_RADIUS)
        disc = SunDisc(points, rule, 0.0, 1.0, np.empty(0), SOLAR_ANGULAR_RADIUS)
        state = sea_at(sea, row, coefficients)
        wind = place_in_pieces(row[1], light.winds[int(row[0])], light.pieces[int(row[0])], weights[0])
        height = place_in_pieces(levels[n], light.heights, light.height_pieces, weights[1])
        coarse = between_kernel(row[1], light.coarse_winds[int(row[0])]), between_kernel(levels[n], light.coarse_heights)
        scale, first, last = view_range_kernel(row[3], plan.low, plan.high)
        start = view_range_kernel(row[3], light.lowest, plan.high)[1]
        grid = plan.depressions * plan.azimuths
        ways = (2 if plan.depressions > 1 else 0) + (2 if plan.azimuths > 1 else 0)
        best, aside = 0.0, 0.0
        step_u, step_a = 1.0 / max(plan.depressions - 1, 1), 2.0 * plan.half_width / max(plan.azimuths - 1, 1)
        for step in range(grid + ways * plan.refinements):
            u, a = best, aside
            if step < grid:
                u = (step // plan.azimuths) * step_u
                a = (step % plan.azimuths) * step_a - plan.half_width
            else:
                if out[n, 0] == 0.0:
                    break
                # Pattern search: each round tries both neighbours of the brightest direction at half of the last step.
                fine = 0.5 ** (1 + (step - grid) // ways)
                way = (step - grid) % ways
                if plan.depressions > 1 and way < 2:
                    u = min(max(best + (step_u * fine if way == 0 else -step_u * fine), 0.0), 1.0)
                else:
                    a = min(max(aside + (step_a * fine if way % 2 == 0 else -step_a * fine), -plan.half_width), plan.half_width)
            excess = row[3] / EFFECTIVE_EARTH_RADIUS
            if plan.depressions > 1:
                # Depressions are even in arsinh(elevation / scale), dense near the horizon.
                x = first + u * (last - first)
                gamma = min(scale * math.sinh(x), 0.5 * math.pi)
                half = math.sin(0.5 * gamma)
                depression = 2.0 * math.asin(min(math.sqrt((0.5 * excess + half * half) / (1.0 + excess)), 1.0))
            else:
                depression = row[8]
                gamma = elevation_kernel(row[3], depression)
                if gamma < 0.0:
                    break
                x = math.asinh(gamma / scale)
            arc = EFFECTIVE_EARTH_RADIUS * max(depression - gamma, 0.0)
            evaluated = direction(
                row, gamma, arc, row[7] + a, light, sea, state, disc, Way(wind, height, coarse, (x - start) / (last - start), weights)
            )
            bright = max(evaluated[0], _FAINT) if evaluated[3] > 0.0 else 0.0
            if bright > out[n, 0] or step == 0:
                best, aside = u, a
                out[n, 0], out[n, 1], out[n, 2], out[n, 3], out[n, 4] = bright, evaluated[1], evaluated[2], gamma, evaluated[3]


def wave_deviation(
    evaluated: Looks, height: FloatArray, solid_angle: float, wind: FloatArray, at: Callable[[float], tuple[WaveGlint, SlopeStatistics]]
) -> FloatArray:
    """Standard deviation of glint in a pixel of each look [W m-2 sr-1, (n,)], from the waves.

    Parameters
    ----------
    evaluated : Looks
        Results of the looks.
    height : ndarray
        Heights of the sensors [m, (n,)].
    solid_angle : float
        Solid angle of a pixel [sr].
    wind : ndarray
        Winds of the looks [m s⁻¹, (n,)].
    at : callable
        Waves and slopes of a wind [m s⁻¹], with waves that travel towards azimuth 0.
    """
    gamma = np.maximum(evaluated.elevation, 0.0)
    shown = (evaluated.radiance > 0.0) & (evaluated.chance > 0.0)
    out = np.zeros(gamma.shape)
    if shown.any():
        slant = slant_range(height, sea_arc(height, gamma))
        looks = [evaluated.cos_incidence, 0.5 * np.pi - gamma, evaluated.sun_up, slant, np.full(gamma.shape, solid_angle)]
        looks += [evaluated.chance, evaluated.light_from_wind]
        share = variance_by_wind(at, wind[shown], evaluated.radius[shown], tuple(np.asarray(look)[shown] for look in looks))
        out[shown] = evaluated.radiance[shown] * np.sqrt(share)
    return out


def deviation(evaluated: Looks, height: FloatArray, solid_angle: float, length: float) -> FloatArray:
    """Standard deviation of glint in a pixel of each look [W m-2 sr-1, (n,)], as :func:`seaglint.radiance.variance.glint_variance`.

    Parameters
    ----------
    evaluated : Looks
        Results of the looks.
    height : ndarray
        Heights of the sensors [m, (n,)].
    solid_angle : float
        Solid angle of a pixel [sr].
    length : float
        Side of a cell of glint [m].
    """
    gamma = np.maximum(evaluated.elevation, 0.0)
    slant = slant_range(height, sea_arc(height, gamma))
    tilt = np.maximum(np.sin(gamma) + evaluated.sun_up, 0.0)
    m = patches_of_tilt(evaluated.cos_incidence, tilt, slant, solid_angle, length)
    return np.asarray(np.sqrt(point_variance(evaluated.radiance, evaluated.chance) / np.maximum(m, 1.0)))


@dataclass(frozen=True, eq=False)
class DetectionCurve:
    """Probability of detection against contrast, linear between its points and constant beyond them."""

    contrast: FloatArray  #: Ascending, target less what is about it [W m-2 sr-1].
    pd: FloatArray  #: Chance of detection there [1].

    def __call__(self, contrast: FloatArray) -> FloatArray:
        """Probabilities at contrasts [1]."""
        return np.asarray(np.interp(contrast, self.contrast, self.pd))


def exceeds(radiance: FloatArray, threshold: float) -> FloatArray:
    """Return 1 where a radiance is above a threshold, else 0."""
    return (radiance > threshold).astype(np.float64)


def passes(mean: FloatArray, sigma: FloatArray, threshold: float) -> FloatArray:
    """Probability that glint in a pixel is above a threshold [1]: a gamma law of this mean and deviation [W m-2 sr-1].

    >>> import numpy as np
    >>> round(float(passes(np.array([1.0]), np.array([1.0]), 2.0)[0]), 4)
    0.1353
    """
    # Without a deviation the law is a step at the mean.
    spread = (sigma > 1e-6 * mean) & (mean > 0.0)
    shape = np.divide(mean, sigma, out=np.ones_like(mean), where=spread) ** 2
    scale = np.divide(mean, shape, out=np.ones_like(mean), where=spread)
    return np.asarray(np.where(spread, gammaincc(shape, threshold / scale), exceeds(mean, threshold)))


def detected(radiance: FloatArray, illuminated: FloatArray, curve: DetectionCurve, contrast: float) -> FloatArray:
    """Return the probability to detect a target [1] with a contrast of ``contrast`` to a sea without glint [W m-2 sr-1].

    Glint behind the target reduces the contrast by its radiance; where clouds hide the Sun, with the chance 1 - ``illuminated``, it does
    not.
    """
    free = curve(np.array([contrast]))[0]
    return np.asarray(free + illuminated * (curve(contrast - radiance) - free))


def exceeded_by(radiance: FloatArray, illuminated: FloatArray, shares: Sequence[float], weight: FloatArray | None = None) -> FloatArray:
    """Return the radiances that glint exceeds in given shares of all draws [W m-2 sr-1]: contrasts visible in the others.

    ``weight`` is the weight of each draw [(n,)]; equal weights without it.
    """
    # From the brightest down, the sum of the weights is the share of looks that exceed a radiance.
    order = np.argsort(radiance)[::-1]
    each = np.ones(radiance.size) if weight is None else weight
    at = np.searchsorted(np.cumsum((illuminated * each)[order]) / each.sum(), np.asarray(shares), side="left")
    return np.asarray(np.append(np.where(radiance[order] > 1e-200, radiance[order], 0.0), 0.0)[np.minimum(at, radiance.size)])
