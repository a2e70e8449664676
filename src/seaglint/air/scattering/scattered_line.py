r"""Single scattering of sunlight into a line of sight, summed over LOWTRAN7's layers with LOWTRAN7's own transmittances.

.. math:: L(\nu) = E_0(\nu) \sum_c P_c(\Theta, \nu)\, J_c(\nu), \qquad
   J_c = \sum_j \tfrac{1}{2} (\tau^s_{j-1} - \tau^s_j)
   \left(\frac{w_{c,j-1} T_{j-1}}{\tau^s_{j-1}} + \frac{w_{c,j} T_j}{\tau^s_j}\right)

over the points j where the line crosses a level: ``tau^s`` is the transmittance of the line up to there by its scatterers alone, ``T_j``
the transmittance of the whole path Sun - point - sensor, ``w`` the share of kind c among the scatterers of its group, aerosols or
molecules. Azimuth enters through the Sun's zenith angle at each point alone.

Two quantities are smooth, unlike in LOWTRAN7, which omits refraction of sunlight below 0.1 deg and takes a point as dark if the Earth
hides the whole Sun without refraction: all sunlight is refracted, and the disc sets behind the point's horizon.

References
----------
LOWTRAN7's subroutines SSGEO and SSRAD; Kneizys, F. X., et al. (1988), Users Guide to LOWTRAN 7, AFGL-TR-88-0177.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from seaglint.air.scattering.gas_bands import DEEPEST
from seaglint.air.scattering.lowtran_ray import (
    AEROSOLS,
    MOLECULES,
    MOST_POINTS,
    WORK_ROWS,
    Laws,
    LevelCrossings,
    invariant_of,
    layer_of,
    sun_amounts,
    trace,
)
from seaglint.air.scattering.twilight import refined
from seaglint.air.sun_and_sky import visible_part_kernel
from seaglint.base.jit import njit

#: Scatterers: boundary layer at relative humidities of 0, 70, 80 and 99 %, troposphere, stratosphere, meteoric dust, molecules.
KINDS: Final = 8

HUMIDITIES: Final = (0.0, 70.0, 80.0, 99.0)  #: Relative humidities of the tabulated phase functions of the boundary layer [%].

_GRAZING: Final = 1e-7  #: Tolerance within which rays count as touching the sea [rad].

#: Largest number of iterations of a ray's direction, and the step at which they end [rad]: a thousandth of the light at most.
_STEPS, _SETTLED = 6, 1e-5


class SunwardTable(NamedTuple):
    """Amounts of absorbers from some heights to the Sun.

    ``coefficient[j, m, k]``: Chebyshev coefficients over the Sun's zenith angle, without refraction, between ``first`` and ``last`` [rad],
    of the amounts of the columns k times the cosine of that angle, at ``height[j]`` [km]. The whole disc is above the horizon there.
    """

    height: np.ndarray
    first: float
    last: float
    coefficient: np.ndarray


NO_SUNS: Final = SunwardTable(np.zeros(0), 0.0, 0.0, np.zeros((0, 1, 1)))  #: Table without heights: every amount is summed separately.


@njit
def optical_depths(laws: Laws, amount: np.ndarray, out: np.ndarray) -> None:
    """Optical depth [1, (n,)] of amounts [(columns,)]."""
    channels = out.size
    for i in range(channels):
        out[i] = 0.0
    for k in range(laws.linear.shape[0]):
        w = amount[k]
        if w != 0.0:  # the amount that counts as cold is below 0 in warm air
            for i in range(channels):
                out[i] += w * laws.linear[k, i]
    # the coefficients of all segments follow each other in one array; ``at`` is the first of segment s
    at = 0
    for s in range(laws.segments.shape[0]):
        column, first, end = laws.segments[s]
        w = amount[column]
        if w > 1e-20:
            saturated = w ** laws.power[s]
            band, coefficient = out[first:end], laws.coefficient[at : at + end - first]
            for i in range(band.size):
                band[i] += saturated * coefficient[i]
        at += end - first


@njit
def passed(depth: float) -> float:
    """Transmittance of an optical depth; 0 beyond ``DEEPEST``."""
    return math.exp(-depth) if depth < DEEPEST else 0.0


@njit
def horizon_zenith(laws: Laws, z: float) -> float:
    """Zenith angle [rad] of the refracted sea horizon from a height [km]."""
    return math.pi - math.asin(min(invariant_of(laws, 0.0, 1.0) / invariant_of(laws, z, 1.0), 1.0))


@njit
def apparent_zenith(laws: Laws, z: float, zenith: float, work: np.ndarray) -> float:
    """Apparent zenith angle [rad] of the Sun at a height [km], from the angle without refraction [rad].

    One step, as in LOWTRAN7: less by the bending of the ray with the angle without refraction; below the horizon by the bending of the
    horizon's ray.
    """
    grazing = horizon_zenith(laws, z) - _GRAZING
    return zenith - max(sun_amounts(laws, z, min(zenith, grazing), work, work[0, :0]), 0.0)


@njit
def _settled_zenith(laws: Laws, z: float, zenith: float, apparent: float, work: np.ndarray) -> float:
    """Apparent zenith angle of the Sun as ``apparent_zenith``, whose result ``apparent`` is iterated until the ray leads to the Sun."""
    grazing = horizon_zenith(laws, z) - _GRAZING
    before, off_before = 0.0, 0.0
    for n in range(_STEPS):
        off = zenith - max(sun_amounts(laws, z, min(apparent, grazing), work, work[0, :0]), 0.0) - apparent
        # secant: bending grows with the zenith angle, so that the difference falls by 1 to 3 per angle
        step = off if n == 0 or off == off_before else off * (before - apparent) / (off - off_before)
        step = min(max(step, -abs(off)), abs(off))
        before, off_before = apparent, off
        apparent += step
        if abs(step) < _SETTLED:
            break
    return apparent


@njit
def sun_seen(laws: Laws, z: float, zenith: float, work: np.ndarray, out: np.ndarray, settled: float = 0.0) -> float:
    """Share of the solar disc above the horizon at a point, and in ``out`` the amounts towards it; ``zenith`` without refraction [rad].

    ``settled``: weight of the iterated direction of the ray, beside the single step of ``apparent_zenith`` [1].
    """
    apparent = apparent_zenith(laws, z, zenith, work)
    horizon = horizon_zenith(laws, z)
    share = visible_part_kernel(horizon - apparent)[0]
    if settled > 0.0 and share > 0.0:  # the single step bends too much: what it leaves dark stays dark
        apparent += settled * (_settled_zenith(laws, z, zenith, apparent, work) - apparent)
        share = visible_part_kernel(horizon - apparent)[0]
    if share > 0.0 and sun_amounts(laws, z, min(apparent, horizon - _GRAZING), work, out) < 0.0:
        return 0.0
    return float(share)


@njit
def sun_by_table(
    laws: Laws, table: SunwardTable, j: int, z: float, zenith: float, settled: float, work: np.ndarray, out: np.ndarray
) -> float:
    """Compute ``sun_seen``, from the table where it has the j-th point's height and the Sun's zenith angle."""
    if j >= table.height.size or table.height[j] != z or zenith < table.first or zenith > table.last:
        return sun_seen(laws, z, zenith, work, out, settled)
    # Chebyshev polynomials by their recurrence, divided by the cosine with which the amounts were multiplied
    x = (2.0 * zenith - table.first - table.last) / (table.last - table.first)
    for k in range(out.size):
        out[k] = 0.0
    polynomial, following = 1.0 / math.cos(zenith), x / math.cos(zenith)
    for m in range(table.coefficient.shape[1]):
        for k in range(out.size):
            out[k] += polynomial * table.coefficient[j, m, k]
        polynomial, following = following, 2.0 * x * following - polynomial
    return 1.0


@njit
def fill_suns(laws: Laws, height: np.ndarray, zenith: np.ndarray, out: np.ndarray) -> None:
    """Compute amounts to the Sun times the cosine of its zenith angle, at heights [km] (heights, zeniths, columns).

    Zenith angles [rad] are without refraction.
    """
    work = np.zeros((WORK_ROWS, out.shape[2]))
    for j in range(height.size):
        for m in range(zenith.size):
            sun_seen(laws, height[j], zenith[m], work, out[j, m])
            for k in range(out.shape[2]):
                out[j, m, k] *= math.cos(zenith[m])


@njit
def line_points(laws: Laws, z: float, zenith: float) -> tuple[np.ndarray, np.ndarray]:
    """Heights [km] and arcs [rad] of the points of a line of sight from a height [km] at a zenith angle [rad]."""
    columns = laws.density.shape[0]
    line = _empty_line(columns)
    points = trace(laws, z, zenith, line, np.zeros((WORK_ROWS, columns)))
    return line.height[:points], line.arc[:points]


@njit
def local_zenith(zenith: float, azimuth: float, arc: float) -> float:
    """Zenith angle [rad] of the Sun at an arc towards an azimuth from it [rad]."""
    up = math.cos(zenith) * math.cos(arc) + math.sin(zenith) * math.sin(arc) * math.cos(azimuth)
    return math.acos(min(max(up, -1.0), 1.0))


@njit
def _kinds(laws: Laws, z: float, level: int, out: np.ndarray) -> None:
    """Shares of the kinds of aerosol at a point."""
    for c in range(out.size):
        out[c] = 0.0
    if z > laws.tops[0]:
        out[AEROSOLS + (0 if z <= laws.tops[1] else 1 if z <= laws.tops[2] else 2)] = 1.0
        return
    rh = laws.humidity[min(level, laws.humidity.size - 1)]
    upper = 1
    while upper < AEROSOLS - 1 and HUMIDITIES[upper] < rh:
        upper += 1
    share = (rh - HUMIDITIES[upper - 1]) / (HUMIDITIES[upper] - HUMIDITIES[upper - 1])
    out[upper - 1], out[upper] = 1.0 - share, share


@njit
def _add(out: np.ndarray, fall: np.ndarray, share: np.ndarray, seen: np.ndarray) -> None:
    """Add the trapezoid half of a point to the kinds of scatterers present there."""
    for c in range(KINDS - 1):
        if share[c] != 0.0:
            for i in range(fall.size):
                out[c, i] += share[c] * fall[i] * seen[i]


@njit
def _empty_line(columns: int) -> LevelCrossings:
    return LevelCrossings(
        np.zeros(MOST_POINTS),
        np.zeros(MOST_POINTS),
        np.zeros(MOST_POINTS),
        np.zeros(MOST_POINTS, np.int64),
        np.zeros((MOST_POINTS, columns)),
    )


@njit
def line_arc(laws: Laws, z: float, zenith: float) -> float:
    """Angle at the Earth's centre to the end of a line of sight from a height [km] at a zenith angle [rad]."""
    columns = laws.density.shape[0]
    line = _empty_line(columns)
    points = trace(laws, z, zenith, line, np.zeros((WORK_ROWS, columns)))
    return float(line.arc[points - 1])


@njit
def line_amplitudes(laws: Laws, z: float, zenith: float, sun: tuple[float, float], out: np.ndarray) -> float:
    """Compute the amplitudes ``J_c`` of a line of sight into ``out`` [1, (KINDS, n)]; return the arc to its last point [rad].

    The line starts at a height [km] at a zenith angle [rad]. ``sun``: its azimuth from the line of sight and its zenith angle without
    refraction, both at the sensor [rad].
    """
    columns, channels = laws.density.shape[0], laws.linear.shape[1]
    work = np.zeros((WORK_ROWS, columns))
    line = _empty_line(columns)
    points = trace(laws, z, zenith, line, work)
    for c in range(KINDS):
        for i in range(channels):
            out[c, i] = 0.0
    whole = work[WORK_ROWS - 1]
    # Two rows each, the point before and this one, which change places.
    haze, molecules = np.ones((2, channels)), np.ones((2, channels))
    by_haze, by_molecules = np.zeros((2, channels)), np.zeros((2, channels))
    share = np.zeros((2, KINDS))
    depth, fall, settled = np.zeros(channels), np.zeros(channels), refined(sun[1])
    for j in range(points):
        this, previous = j % 2, 1 - j % 2
        up = sun_seen(laws, line.height[j], local_zenith(sun[1], sun[0], line.arc[j]), work, whole, settled)
        if up > 0.0:
            for k in range(columns):
                whole[k] += line.amount[j, k]
            optical_depths(laws, whole, depth)
        for i in range(channels):
            scattered = 0.0
            for k in range(AEROSOLS):
                scattered += laws.scattering[k, i] * line.amount[j, k]
            haze[this, i] = math.exp(-scattered)
            molecules[this, i] = math.exp(-laws.linear[MOLECULES, i] * line.amount[j, MOLECULES])
            light = up * passed(depth[i]) if up > 0.0 else 0.0
            by_haze[this, i] = light / haze[this, i] if haze[this, i] > 0.0 else 0.0
            by_molecules[this, i] = light / molecules[this, i] if molecules[this, i] > 0.0 else 0.0
        _kinds(laws, line.height[j], line.level[j], share[this])
        if j > 0:
            for i in range(channels):
                fall[i] = 0.5 * (haze[previous, i] - haze[this, i])
                out[KINDS - 1, i] += (
                    0.5 * (molecules[previous, i] - molecules[this, i]) * (by_molecules[previous, i] + by_molecules[this, i])
                )
            # trapezoid: half of the fall of transmittance for the point before, half for this one
            _add(out, fall, share[previous], by_haze[previous])
            _add(out, fall, share[this], by_haze[this])
    return float(line.arc[points - 1])


@njit
def _log_mean(a: float, b: float, x: float) -> float:
    """Mean of a quantity that changes exponentially from ``a`` to ``b = a exp(x)``; their mean where one is 0."""
    if a <= 0.0 or b <= 0.0:
        return 0.5 * (a + b)
    return a * (1.0 + x * (0.5 + x / 6.0)) if abs(x) < 1e-3 else (b - a) / x


@njit
def line_sums(laws: Laws, line: LevelCrossings, points: int, sun: tuple[float, float], table: SunwardTable, out: np.ndarray) -> float:
    """Compute amplitudes as ``line_amplitudes``, of continuous air, along a traced line: ``J_c`` is the integral of ``beta_c T``.

    T is the band transmittance Sun - place - sensor, between points by its logarithmic mean; every region's aerosol scatters as its kind at
    its place.
    """
    columns, channels = laws.density.shape[0], laws.linear.shape[1]
    work = np.zeros((WORK_ROWS, columns))
    for c in range(KINDS):
        for i in range(channels):
            out[c, i] = 0.0
    whole = work[WORK_ROWS - 1]
    light, depth, share = np.zeros((2, channels)), np.zeros((2, channels)), np.zeros(AEROSOLS)
    seen, up_before, settled = np.zeros(channels), 0.0, refined(sun[1])
    for j in range(points):
        this, previous = j % 2, 1 - j % 2
        up = sun_by_table(laws, table, j, line.height[j], local_zenith(sun[1], sun[0], line.arc[j]), settled, work, whole)
        for i in range(channels):
            light[this, i] = 0.0
        if up > 0.0:
            for k in range(columns):
                whole[k] += line.amount[j, k]
            optical_depths(laws, whole, depth[this])
            for i in range(channels):
                light[this, i] = up * passed(depth[this, i])
        # a disc that sets along the line dims the light too
        growth = math.log(up / up_before) if up > 0.0 and up_before > 0.0 else 0.0
        up_before = up
        if j == 0:
            continue
        _humid_shares(laws, 0.5 * (line.height[j - 1] + line.height[j]), share)
        for i in range(channels):
            seen[i] = _log_mean(light[previous, i], light[this, i], depth[previous, i] - depth[this, i] + growth)
        for region in range(AEROSOLS):
            w = line.amount[j, region] - line.amount[j - 1, region]
            # regions that the piece does not touch
            if w <= 0.0:
                continue
            for c in range(AEROSOLS if region == 0 else 1):
                kind, part = (c, share[c] * w) if region == 0 else (AEROSOLS + region - 1, w)
                if part > 0.0:
                    for i in range(channels):
                        out[kind, i] += part * laws.scattering[region, i] * seen[i]
        w = line.amount[j, MOLECULES] - line.amount[j - 1, MOLECULES]
        for i in range(channels):
            out[KINDS - 1, i] += w * laws.linear[MOLECULES, i] * seen[i]
    return float(line.arc[points - 1])


@njit
def _humid_shares(laws: Laws, z: float, out: np.ndarray) -> None:
    """Shares of the boundary layer's kinds at a height [km], by the humidity there."""
    i = layer_of(laws, z)
    fraction = min(max((z - laws.height[i]) / (laws.height[i + 1] - laws.height[i]), 0.0), 1.0)
    humidity = laws.humidity[i] + fraction * (laws.humidity[i + 1] - laws.humidity[i])  # NumPy's interp takes more than a second to compile
    rh = min(max(humidity, HUMIDITIES[0]), HUMIDITIES[AEROSOLS - 1])
    for c in range(AEROSOLS):
        out[c] = 0.0
    upper = 1
    while upper < AEROSOLS - 1 and HUMIDITIES[upper] < rh:
        upper += 1
    share = (rh - HUMIDITIES[upper - 1]) / (HUMIDITIES[upper] - HUMIDITIES[upper - 1])
    out[upper - 1], out[upper] = 1.0 - share, share


@njit
def many_amplitudes(
    laws: Laws, z: float, lines: np.ndarray, part: tuple[int, int], table: SunwardTable, out: np.ndarray, arc: np.ndarray
) -> None:
    """Amplitudes by ``line_amplitudes`` or ``line_sums`` of part of the lines from one height.

    ``lines`` [rad, (lines, 3)]: zenith, azimuth, solar zenith. Lines that follow each other at one zenith angle are traced once.
    """
    columns = laws.density.shape[0]
    line, work, points = _empty_line(columns), np.zeros((WORK_ROWS, columns)), 0
    for i in range(part[0], part[1]):
        if laws.finest > 0.0:
            if points == 0 or lines[i, 0] != lines[i - 1, 0]:
                points = trace(laws, z, lines[i, 0], line, work)
            arc[i] = line_sums(laws, line, points, (lines[i, 1], lines[i, 2]), table, out[i])
        else:
            arc[i] = line_amplitudes(laws, z, lines[i, 0], (lines[i, 1], lines[i, 2]), out[i])
