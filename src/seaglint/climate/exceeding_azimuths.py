"""Share of the azimuths at which a look exceeds thresholds, from the borders of that range: probabilities of glint without sampling noise.

With all other quantities given, glint decreases to both sides of the Sun. The borders where it passes a threshold are bracketed on a few
azimuths and refined by the Illinois rule in the logarithm of radiance, which is nearly a parabola there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS, SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import in_threads, njit
from seaglint.climate.glint_radiance import DUSK, SeaState, Way, WindSlopes, direction, sea_at
from seaglint.climate.mirrored_sunlight import (
    MirroredLight,
    between_kernel,
    elevation_kernel,
    height_coordinate,
    place_in_pieces,
    view_range_kernel,
)
from seaglint.facet.glint import SunDisc, aim_disc, sun_disc
from seaglint.facet.sunlight import STEADY

#: Azimuths to each side of the Sun between which at most one border is searched [rad].
_BESIDE: Final = np.radians([2.0, 5.0, 10.0, 18.0, 30.0, 50.0, 90.0, 180.0])

#: Logarithm of radiance below the least threshold beyond which the outer azimuths are skipped, as glint only decreases there.
_FAR: Final = 7.0

_CLOSE: Final = 2e-4  #: Logarithm of radiance to which borders are refined: a tenth of the accuracy of the tables of light.

_LEAST: Final = 1e-300  #: Radiance in place of 0, whose logarithm does not exist [W m-2 sr-1].
_TURNS: Final = 40  #: Largest number of steps of the rule.


class _AzimuthPlan(NamedTuple):
    nodes: FloatArray  #: Azimuths from the Sun, ascending [rad].
    start: int  #: Index of the brightest node.
    falls: bool  #: True if glint decreases to both sides of it: the range holds no second approach to the Sun.
    thresholds: FloatArray  #: Logarithms of the thresholds.
    depression: tuple[float, float]


class _Beam(NamedTuple):
    """Look without its azimuth."""

    elevation: float
    arc: float
    state: SeaState
    disc: SunDisc
    way: Way


def azimuth_shares(
    draws: FloatArray, light: MirroredLight, sea: WindSlopes, azimuths: tuple[float, float], thresholds: Sequence[float]
) -> FloatArray:
    """Share of a range of azimuths at which each look exceeds each threshold [1, (n, thresholds)].

    Parameters
    ----------
    draws : ndarray
        Looks [(n, 9)] as in ``seaglint.climate.glint_radiance.COLUMNS``; their azimuths are not used.
    light : MirroredLight
        Sunlight through the air.
    sea : WindSlopes
        Slopes.
    azimuths : (float, float)
        First and last azimuth from the Sun's [rad], ascending, 2 pi apart at most.
    thresholds : sequence of float
        Above 0 [W m-2 sr-1].
    """
    rows, levels = np.ascontiguousarray(draws, dtype=np.float64), height_coordinate(draws[:, 3])
    out = np.zeros((rows.shape[0], len(thresholds)))
    plan = _AzimuthPlan(*_nodes(*azimuths), np.log(np.asarray(thresholds, dtype=np.float64)), light.depression)
    rule = sun_disc(0.0, 0.0, STEADY).rule
    in_threads(lambda part: _fill(part, rows, levels, light, sea, plan, rule, out), rows.shape[0])
    return out


def _nodes(first: float, last: float) -> tuple[FloatArray, int, bool]:
    """Azimuths to evaluate, the index of the one next to the Sun, and True if glint decreases to both sides of it."""
    turn = 2.0 * math.pi
    if last - first >= turn - 1e-9:
        first, last = -math.pi, math.pi
    shift = turn * round(0.5 * (first + last) / turn)
    first, last = first - shift, last - shift
    around = np.concatenate([_BESIDE, [0.0], -_BESIDE])
    # The range may reach a turn beyond the Sun: its images get nodes too.
    every = np.concatenate([around - turn, around, around + turn, [first, last]])
    nodes = np.unique(every[(every >= first) & (every <= last)].round(12))
    return nodes, int(np.argmin(np.abs(nodes))), first >= -math.pi - 1e-9 and last <= math.pi + 1e-9


@njit
def _logarithm(row: FloatArray, azimuth: float, light: MirroredLight, sea: WindSlopes, beam: _Beam) -> float:
    """Logarithm of radiance at an azimuth from the Sun."""
    evaluated = direction(row, beam.elevation, beam.arc, row[5] + azimuth, light, sea, beam.state, beam.disc, beam.way)
    return math.log(max(evaluated[0], _LEAST))


@njit
def _border(
    row: FloatArray, ends: tuple[float, float], above: tuple[float, float], level: float, light: MirroredLight, sea: WindSlopes, beam: _Beam
) -> float:
    """Azimuth between two ends where glint passes a level; ``above``: logarithms less the level at the ends, of opposite signs."""
    a, b = ends
    # Far in the dark the logarithm falls steeply: without a limit it would move every secant to the other end.
    fa, fb = min(max(above[0], -8.0), 8.0), min(max(above[1], -8.0), 8.0)
    x = a
    for _ in range(_TURNS):
        x = b - fb * (b - a) / (fb - fa)
        f = _logarithm(row, x, light, sea, beam) - level
        if abs(f) < _CLOSE or abs(b - a) < 1e-7:
            break
        if (f > 0.0) != (fb > 0.0):
            a, fa = b, fb
        else:
            # Illinois: halve the value at the end that did not move, or the secant would approach from one side only.
            fa *= 0.5
        b, fb = x, min(max(f, -8.0), 8.0)
    return x


@njit
def _fill(
    part: tuple[int, int],
    draws: FloatArray,
    levels: FloatArray,
    light: MirroredLight,
    sea: WindSlopes,
    plan: _AzimuthPlan,
    rule: FloatArray,
    out: FloatArray,
) -> None:
    points, coefficients, weights = np.empty((7, 4)), np.empty(5), np.zeros((4, 4))
    nodes, least = plan.nodes, plan.thresholds.min()
    seen = np.empty(nodes.size)
    for n in range(part[0], part[1]):
        row = draws[n]
        gamma = elevation_kernel(row[3], row[8])
        if gamma < 0.0 or row[4] > 0.5 * math.pi + DUSK:
            continue
        aim_disc(points, row[4], row[5], SOLAR_ANGULAR_RADIUS)
        scale, _, last = view_range_kernel(row[3], plan.depression[0], plan.depression[1])
        start = view_range_kernel(row[3], light.lowest, plan.depression[1])[1]
        way = Way(
            place_in_pieces(row[1], light.winds[int(row[0])], light.pieces[int(row[0])], weights[0]),
            place_in_pieces(levels[n], light.heights, light.height_pieces, weights[1]),
            (between_kernel(row[1], light.coarse_winds[int(row[0])]), between_kernel(levels[n], light.coarse_heights)),
            (math.asinh(gamma / scale) - start) / (last - start),
            weights,
        )
        arc = EFFECTIVE_EARTH_RADIUS * max(row[8] - gamma, 0.0)
        beam = _Beam(gamma, arc, sea_at(sea, row, coefficients), SunDisc(points, rule, 0.0, 1.0, np.empty(0), SOLAR_ANGULAR_RADIUS), way)
        seen[:] = math.log(_LEAST)
        for i in range(plan.start, nodes.size):
            seen[i] = _logarithm(row, nodes[i], light, sea, beam)
            if plan.falls and seen[i] < least - _FAR:
                break
        if plan.falls and seen[plan.start] < least - _FAR:
            continue
        # From the brightest node outwards to the other side, until glint is negligible.
        for i in range(plan.start - 1, -1, -1):
            seen[i] = _logarithm(row, nodes[i], light, sea, beam)
            if plan.falls and seen[i] < least - _FAR:
                break
        for t in range(plan.thresholds.size):
            level, total = plan.thresholds[t], 0.0
            for i in range(nodes.size - 1):
                a, b = seen[i] - level, seen[i + 1] - level
                if a > 0.0 and b > 0.0:
                    total += nodes[i + 1] - nodes[i]
                elif (a > 0.0) != (b > 0.0):
                    border = _border(row, (nodes[i], nodes[i + 1]), (a, b), level, light, sea, beam)
                    total += border - nodes[i] if a > 0.0 else nodes[i + 1] - border
            out[n, t] = total / (nodes[nodes.size - 1] - nodes[0])
