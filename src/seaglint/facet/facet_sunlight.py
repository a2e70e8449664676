"""Sunlight of one piece of visible sea: a resolved slope with unresolved roughness on it.

A facet of resolved slope ``s0`` carries the Gaussian density ``q`` of the slopes that geometry does not resolve. Sunlight is a closed form,

    L_sun = rho(omega) E q(s* - s0) S (1 + Lambda_v) / (4 cos^4(beta) A+),

with ``A+``, both ``Lambda`` and the two-leg factor ``S`` taken about the facet's own tilt (``S (1 + Lambda_v)/A+`` is ``1/A+`` under a
high Sun). ``q`` is convolved with the solar disc (``seaglint.facet.solar_disc``).
Where the sensor is low the unresolved waves hide each other: ``q`` is weighted by the law of nested bands
(:mod:`seaglint.sea.shadowing.nested`) about the facet's tilt, with the bands and the shelter that brute force leaves to
facets of their share of the slope variance; with a low Sun, by the law of facets that are both visible and lit.

Averages over slope statistics are in ``seaglint.facet.legs``; each quadrature is the other's check.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.jit import kernel, njit
from seaglint.facet.roughness import Roughness, Sight
from seaglint.facet.solar_disc import DiscLine, broadened, disc_at, disc_edge, disc_of, mirror_factor, sharp
from seaglint.facet.sunlight import Sunlight
from seaglint.facet.thermal import between
from seaglint.sea.shadowing.facet_lean import lean_kernel
from seaglint.sea.shadowing.nested import HIGHEST, LOWEST, Shelter, counted_kernel, nested_exponent_kernel
from seaglint.sea.shadowing.seen_and_lit import lit_exponent_kernel
from seaglint.sea.shadowing.smith import quick_visible_area_kernel

NEGLIGIBLE_EXPONENT = 30.0  #: Exponent below which slope densities are taken as zero: exp(-30) of their peak, 1e-13 of the glint's.


class FacetTables(NamedTuple):
    """Band terms of the light of facets.

    ``thermal[u, chi, a, c, k]``: emission and reflected sky over the sine of the grazing angle, the view azimuth and the resolved slope
    towards the viewer and across; ``emitted`` the emission alone, without terms where it is not requested; ``axes[i] = (first node,
    1/step)``. ``sun[c, k]``: reflected sunlight over the cosine of incidence.
    """

    thermal: np.ndarray
    emitted: np.ndarray
    axes: np.ndarray
    sun: np.ndarray


class FacetOptics(NamedTuple):
    """Tables that ``facet_thermal`` and ``facet_sunlight`` read."""

    sunlight: Sunlight
    roughness: Roughness
    tables: FacetTables


class FacetLevels(NamedTuple):
    """Facets of every level of detail, in arrays.

    ``roughness[l] = (ee, en, nn, towards the Sun, shelter, gain of the Sun's leg, wind)``, the shelter of three numbers;
    ``nested[l]`` and ``coupling[l]`` its tables, unless all are Smith's and ``smith`` is set; ``lean[l]`` and ``gains[l]`` the tables of
    the lean, empty if no facets lean; ``thermal`` and ``emitted`` all tables one after another with ``shape[l] = (first, nu,
    nchi, na, nc)`` and ``axes[l]``; ``sun`` as in ``FacetTables``.
    """

    roughness: np.ndarray
    nested: np.ndarray
    coupling: np.ndarray
    smith: bool
    lean: np.ndarray
    gains: np.ndarray
    thermal: np.ndarray
    emitted: np.ndarray
    shape: np.ndarray
    axes: np.ndarray
    sun: np.ndarray


@njit
def level_optics(sunlight: Sunlight, levels: FacetLevels, level: int) -> FacetOptics:
    """Facets of one level."""
    first, nu, nx, na, nc = (
        levels.shape[level, 0],
        levels.shape[level, 1],
        levels.shape[level, 2],
        levels.shape[level, 3],
        levels.shape[level, 4],
    )
    end = first + nu * nx * na * nc
    thermal = levels.thermal[first:end].reshape((nu, nx, na, nc, levels.thermal.shape[1]))
    emitted = levels.emitted[first:end].reshape((nu, nx, na, nc, levels.emitted.shape[1]))
    nested, coupling = levels.nested[level, : 0 if levels.smith else levels.nested.shape[1]], levels.coupling[level]
    q = levels.roughness[level]
    tables = FacetTables(thermal, emitted, levels.axes[level], levels.sun)
    shelter, lean, gains = Shelter(q[4], q[5], q[6]), levels.lean[level], levels.gains[level]
    rough = Roughness(q[0], q[1], q[2], q[3], shelter, nested, coupling, lean, gains, q[7], q[8])
    return FacetOptics(sunlight, rough, tables)


@kernel
def sun_factor(
    sun: Sunlight,
    rough: Roughness,
    line: DiscLine,
    sight: Sight,
    grazing: tuple[float, float],
    slope: tuple[float, float],
    spread: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> tuple[float, float]:
    """Glint factor ``q S (1+Lambda_v)/(4 cos^4(beta) A+)`` [1/sr] and the cosine of incidence; ``grazing`` is its sine and cosine.

    ``spread``: covariance (ee, en, nn) of resolved slopes about ``slope`` (``seaglint.imaging.sweep.walk``), which ``q`` is averaged
    over.
    """
    vz, horizontal = grazing
    slope_east, slope_north = slope
    ve, vn = sight.east * horizontal, sight.north * horizontal
    mz = vz + sun.up
    if not sun.shining or mz <= 1e-9:
        return 0.0, 0.0
    cosine = math.sqrt(max(0.5 * (1.0 + ve * sun.east + vn * sun.north + vz * sun.up), 0.0))
    if rough.east_east + rough.north_north <= 0.0:
        return mirror_factor(sun, ve, vn, vz, slope_east, slope_north), cosine
    # slope that mirrors the Sun's centre, s* = -(v + l)_h/(v + l)_z
    per_mz = 1.0 / mz
    se, sn = -(ve + sun.east) * per_mz, -(vn + sun.north) * per_mz
    covariance = (0.0, 0.0, 0.0)
    if line.rows.shape[0] > 0:
        disc = disc_at(line, per_mz)
    else:
        disc, covariance = disc_of(sun, rough, mz, se, sn)
    de, dn = se + disc.east - slope_east, sn + disc.north - slope_north
    # test before the costly share: most facets of a sea are far from the slope that mirrors the Sun
    exponent = disc.ee * de * de + disc.en * de * dn + disc.nn * dn * dn
    if exponent > NEGLIGIBLE_EXPONENT:
        return 0.0, 0.0
    if spread[0] + spread[2] > 0.0:
        share, shift_e, shift_n = merged_share(sun, rough, sight, grazing, (se, sn), slope, spread)
        disc = broadened(disc, spread)
    else:
        share, shift_e, shift_n = facet_share(sun, rough, sight, grazing, (se, sn), slope)
    if share <= 0.0:
        return 0.0, 0.0
    de, dn = de - shift_e, dn - shift_n
    exponent = disc.ee * de * de + disc.en * de * dn + disc.nn * dn * dn
    if sharp(rough, covariance):
        exponent += disc_edge(covariance, rough, (de, dn))
    tan2 = se * se + sn * sn
    return math.exp(disc.peak - exponent) * (1.0 + tan2) * (1.0 + tan2) * share, cosine


@kernel
def facet_share(
    sun: Sunlight, rough: Roughness, sight: Sight, grazing: tuple[float, float], mirror: tuple[float, float], slope: tuple[float, float]
) -> tuple[float, float, float]:
    """Share ``seen_and_lit`` of a facet of a slope, for the slope ``mirror`` that mirrors the Sun, and its lean, east and north.

    ``grazing`` as in ``sun_factor``; the lean is the shift of the mean of the unresolved slopes that are visible and lit.
    """
    vz, horizontal = grazing
    tilt = sight.east * slope[0] + sight.north * slope[1]
    above = (vz - horizontal * tilt, sun.up - sun.east * slope[0] - sun.north * slope[1])
    deviation = (horizontal * sight.deviation, sun.t_up * rough.towards_sun)
    viewward = sight.east * mirror[0] + sight.north * mirror[1] - tilt
    sunward = sun.horizontal_east * (mirror[0] - slope[0]) + sun.horizontal_north * (mirror[1] - slope[1])
    mirroring = (viewward / max(sight.deviation, 1e-12), sunward / max(rough.towards_sun, 1e-12))
    share = seen_and_lit(rough, sight.passage, mirroring, above, deviation)
    if rough.lean.shape[0] == 0 or share <= 0.0:
        return share, 0.0, 0.0
    shift = sight.deviation * lean_kernel(mirroring[0], above[0] / max(deviation[0], 1e-12), sight.gain, rough.lean)
    east, north = shift * sight.north, -shift * sight.east
    if deviation[1] > 0.0:
        shift = rough.towards_sun * lean_kernel(mirroring[1], above[1] / deviation[1], rough.sun_gain, rough.lean)
        east, north = east + shift * sun.horizontal_north, north - shift * sun.horizontal_east
    return share, east, north


@kernel
def merged_share(
    sun: Sunlight,
    rough: Roughness,
    sight: Sight,
    grazing: tuple[float, float],
    mirror: tuple[float, float],
    slope: tuple[float, float],
    spread: tuple[float, float, float],
) -> tuple[float, float, float]:
    """Mean of ``facet_share`` over slopes of a covariance ``spread`` (ee, en, nn) about ``slope``, and the shift of their mean.

    The shift, east and north, adds the shift of the mean slope weighted with the share and the mean lean.

    ``<q h> = <h> q(s* - s - V g)``, with g the logarithmic gradient of the share h, to second order in the slopes. The share changes along
    the line of sight, where it is evaluated one deviation to either side; across the line of sight it hardly changes.
    """
    ve, vn = spread[0] * sight.east + spread[1] * sight.north, spread[1] * sight.east + spread[2] * sight.north
    step = math.sqrt(max(ve * sight.east + vn * sight.north, 1e-12))
    aside_e, aside_n = step * sight.east, step * sight.north
    low, low_e, low_n = facet_share(sun, rough, sight, grazing, mirror, (slope[0] - aside_e, slope[1] - aside_n))
    high, high_e, high_n = facet_share(sun, rough, sight, grazing, mirror, (slope[0] + aside_e, slope[1] + aside_n))
    both = low + high
    if both <= 0.0:
        return 0.0, 0.0, 0.0
    gradient, part = (high - low) / (both * step), high / both
    return 0.5 * both, gradient * ve + low_e + part * (high_e - low_e), gradient * vn + low_n + part * (high_n - low_n)


@kernel
def seen_and_lit(
    rough: Roughness, passage: float, mirroring: tuple[float, float], above: tuple[float, float], deviation: tuple[float, float]
) -> float:
    """Return the visible and lit share of a facet's mirroring slopes over its visible area, ``S (1 + Lambda_v)/A+``; 0 for hidden facets.

    ``mirroring``: slope that mirrors the Sun from the facet's tilt, towards the viewer and towards the Sun, in deviations. ``above``: mean
    over the facet's slopes of ``v_z - v_h.s`` for the directions to viewer and Sun, and ``deviation`` its spread. The law of
    ``seaglint.facet.legs.seen_and_lit_kernel`` is applied about the tilt.
    """
    view, sun = above
    area = quick_visible_area_kernel(view, deviation[0])
    shaded = deviation[1] >= 0.0
    # the disc may be partly above a facet whose horizon its centre is just below; geometry determines how much of it
    if area <= 0.0 or (shaded and sun <= -SOLAR_ANGULAR_RADIUS):
        return 0.0
    many = rough.nested.shape[0] > 0
    edge = view / max(deviation[0], 1e-12)
    seen = math.exp(nested_exponent_kernel(mirroring[0], edge, 1.0, rough.nested)) if many else 1.0
    # above 4.5 deviations Smith's Lambda, the visible area over the mean less one, is below 1e-6
    if not shaded or deviation[1] < 1e-9 or sun >= (HIGHEST if many else 4.5) * deviation[1]:
        return seen / area
    shelter = rough.shelter
    sun = max(counted_kernel(max(sun, 0.0) / deviation[1], shelter) * deviation[1], 1e-9)
    hidden = quick_visible_area_kernel(sun, deviation[1]) / sun - 1.0
    # below, 1/P is interpolated over the azimuth between legs on one side and opposite legs, as in Smith's law for two legs
    upright, lit, both = max(view, 0.0) / area, 1.0, seen
    if many:
        sun_edge = sun / deviation[1]
        lit = math.exp(nested_exponent_kernel(mirroring[1], sun_edge, 1.0, rough.nested))
        both = seen * lit
        if edge < HIGHEST:
            both *= math.exp(lit_exponent_kernel(0.5 * (mirroring[0] - mirroring[1]), edge, sun_edge, rough.coupling))
    both *= 1.0 + shelter.together / (max(edge, LOWEST) * max(sun / deviation[1], LOWEST))
    same = max(1.0 / max(seen, 1e-300), upright * (1.0 + hidden) / max(lit, 1e-300))
    opposite = max((1.0 + upright * hidden) / max(both, 1e-300), same)
    return 1.0 / (same + passage * (opposite - same)) / area


@kernel
def facet_sunlight(
    optics: FacetOptics,
    line: DiscLine,
    path: np.ndarray,
    at: tuple[int, float],
    sight: Sight,
    grazing: tuple[float, float],
    slope: tuple[float, float],
    spread: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> tuple[float, float]:
    """Mirrored sunlight of a facet, attenuated [W m-2 sr-1], and its glint factor [1/sr].

    ``line`` is ``disc_line`` of the line of sight, ``grazing`` the sine and cosine of the grazing angle; ``path`` and ``at`` as for
    ``facet_thermal``, ``spread`` for ``sun_factor``.
    """
    factor, cosine = sun_factor(optics.sunlight, optics.roughness, line, sight, grazing, slope, spread)
    if factor <= 0.0:
        return 0.0, 0.0
    table = optics.tables.sun
    i_path, f_path = at
    x = cosine * (table.shape[0] - 1)
    i = min(int(x), table.shape[0] - 2)
    f = x - i
    solar = 0.0
    for k in range(table.shape[1]):
        solar += between(path, i_path, f_path, k) * ((1.0 - f) * table[i, k] + f * table[i + 1, k])
    return solar * factor, factor
