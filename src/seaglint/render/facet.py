"""Radiance of one piece of visible sea: a resolved slope with unresolved roughness on it.

A facet of resolved slope ``s0`` carries the Gaussian density ``q`` of the slopes that geometry does not resolve. Sunlight is a closed form,

    L_sun = rho(omega) E q(s* - s0) S (1 + Lambda_v) / (4 cos^4(beta) A+),

with ``A+``, both ``Lambda`` and the two-leg factor ``S`` taken about the facet's own tilt (``S (1 + Lambda_v)/A+`` is ``1/A+`` under a
high Sun). ``q`` is convolved with the solar disc: its covariance, ``eps^2/4`` in every direction, is carried to slopes by the mirror's
Jacobian.
Where the sensor is low the unresolved waves hide each other: ``q`` is weighted by the law of nested bands (:mod:`seaglint.sea.nested`)
about the facet's tilt, with as many bands as the facets' share of the slope variance is worth; with a low Sun, by that of facets both
seen and lit.
Emission and reflected sky are averages over the same visible density, tabulated once per image and level of detail. Rays
reflected downwards meet the sea again and see a blackbody at its temperature.

Everything is kept per term of :class:`~seaglint.render.path_basis.PathBasis`, so that products with the path are integrated per wavenumber.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from numpy.typing import NDArray

from seaglint._jit import kernel, njit, njit_parallel
from seaglint.constants import SOLAR_ANGULAR_RADIUS
from seaglint.conventions import FloatArray
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import reflectance
from seaglint.optics.sea_water import WaterIndex
from seaglint.radiance.mean import SeaView
from seaglint.render.path_basis import PathBasis
from seaglint.sea.nested import (
    BANDS,
    HIGHEST,
    LIT_BANDS,
    between_bands,
    lit_exponent_kernel,
    lit_table,
    nested_exponent_kernel,
    ratio_table,
)
from seaglint.sea.shadowing import both_legs_kernel, leg_passage_kernel, quick_visible_area_kernel
from seaglint.sea.slopes import SlopeStatistics

INCIDENCE_NODES = 513
"""Nodes uniform in the cosine of incidence; linear interpolation of the reflectance is then within 2e-5."""

SKY_NODES = 129
"""Nodes uniform in the square root of the reflected ray's cosine, which crowd at the horizon, where the sky changes fast."""

ALONG_NODES, CROSS_NODES = 14, 5
"""Quadrature over the facet's slopes: Gauss-Legendre on both sides of the slope that mirrors the horizon, Gauss-Hermite across."""

NEGLIGIBLE_EXPONENT = 30.0
"""Slope densities below exp(-30) of their peak are taken as zero: 1e-13 of the glint's."""

DISC_ROWS = (17, 6)
"""Rows of a :class:`DiscLine`, with which the glint is within 1.5e-3, and their fields."""

SHARP_DISC = 0.1
"""Share of the Sun's image in the slope variance from which its sharp edge counts: below it the glint's peak moves by less than 0.4 %."""

FARTHEST_TURNED_AWAY = -3.0
"""Facets turned from the viewer by more than this many deviations of their roughness are treated as if by this many; they are not seen."""


class Sunlight(NamedTuple):
    """The Sun as kernels see it: the unit vector to it, the tangent ``t_*`` in its vertical plane and the horizontal one ``c_*``, the
    horizontal unit vector towards it, its centre's elevation, and the tangents of its limbs' elevations.
    """

    shining: bool
    azimuth: float
    east: float
    north: float
    up: float
    t_east: float
    t_north: float
    t_up: float
    c_east: float
    c_north: float
    horizontal_east: float
    horizontal_north: float
    elevation: float
    lower_tangent: float
    upper_tangent: float


class Roughness(NamedTuple):
    """Covariance of unresolved slopes towards east and north (zero means mirror facets), the deviation along the Sun's azimuth, and the
    tables of their nested shadowing, from the viewer and from viewer and Sun (:func:`seaglint.sea.nested.ratio_table`,
    :func:`seaglint.sea.nested.lit_table`; empty for Smith's).
    """

    east_east: float
    east_north: float
    north_north: float
    towards_sun: float
    nested: np.ndarray
    lit: np.ndarray


class FacetTables(NamedTuple):
    """Band terms of what facets send.

    ``thermal[u, chi, a, c, k]``: emission and reflected sky over the sine of the grazing angle, the view azimuth and the resolved slope
    towards the viewer and across; ``axes[i] = (first node, 1/step)``. ``sun[c, k]``: reflected sunlight over the cosine of incidence.
    """

    thermal: np.ndarray
    axes: np.ndarray
    sun: np.ndarray


class ThermalLine(NamedTuple):
    """A thermal table (u, a, c, k) of one line of sight: its values and its sizes; the number of terms is a multiple of four."""

    values: np.ndarray
    sines: int
    along: int
    across: int
    terms: int


class FacetOptics(NamedTuple):
    """All that :func:`facet_thermal` and :func:`facet_sunlight` look up."""

    sunlight: Sunlight
    roughness: Roughness
    tables: FacetTables


class FacetLevels(NamedTuple):
    """The facets of every level of detail, in arrays.

    ``roughness[l] = (ee, en, nn, towards the Sun)``; ``nested[l]`` and ``lit[l]`` its tables, unless all are Smith's and ``smith`` is
    set; ``thermal`` all tables one after another with ``shape[l] = (first, nu, nchi, na, nc)`` and ``axes[l]``; ``sun`` as in
    :class:`FacetTables`.
    """

    roughness: np.ndarray
    nested: np.ndarray
    lit: np.ndarray
    smith: bool
    thermal: np.ndarray
    shape: np.ndarray
    axes: np.ndarray
    sun: np.ndarray


@njit
def level_optics(sunlight: Sunlight, levels: FacetLevels, level: int) -> FacetOptics:
    """The facets of one level."""
    first, nu, nx, na, nc = (
        levels.shape[level, 0],
        levels.shape[level, 1],
        levels.shape[level, 2],
        levels.shape[level, 3],
        levels.shape[level, 4],
    )
    thermal = levels.thermal[first : first + nu * nx * na * nc].reshape((nu, nx, na, nc, levels.thermal.shape[1]))
    nested, lit = levels.nested[level, : 0 if levels.smith else levels.nested.shape[1]], levels.lit[level]
    q = levels.roughness[level]
    return FacetOptics(sunlight, Roughness(q[0], q[1], q[2], q[3], nested, lit), FacetTables(thermal, levels.axes[level], levels.sun))


class Sight(NamedTuple):
    """A line of sight, seen from the sea: horizontal unit vector to the sensor, azimuth node of the tables, weight of the Sun's leg in the
    shadows of both (:func:`~seaglint.sea.shadowing.leg_passage_kernel`), and the deviation of unresolved slopes along it.
    """

    east: float
    north: float
    chi: float
    passage: float
    deviation: float


class Disc(NamedTuple):
    """The solar disc in the slopes that mirror it, with the facets' roughness on it, at one grazing angle.

    ``east, north``: its middle, from the slope that mirrors the Sun's centre; ``ee, en, nn``: halves of the inverse covariance of facet and
    disc together (``en`` twice); ``peak``: logarithm of a quarter of their density at the middle.
    """

    east: float
    north: float
    ee: float
    en: float
    nn: float
    peak: float


class DiscLine(NamedTuple):
    """The :class:`Disc` of a line of sight at even steps of ``1/(sin(grazing) + sin(Sun's elevation))``; ``rows[i]`` are its fields.

    Without rows it is not tabled: facets are so smooth that the shape of the disc counts, or it is for single rays.
    """

    rows: np.ndarray
    first: float
    per_step: float


@kernel
def along(roughness: Roughness, east: float, north: float) -> float:
    """Slope variance along a horizontal unit vector."""
    return roughness.east_east * east * east + 2.0 * roughness.east_north * east * north + roughness.north_north * north * north


@kernel
def line_of_sight(optics: FacetOptics, azimuth: float) -> Sight:
    """The :class:`Sight` of a line that leaves the sensor at an azimuth."""
    east, north = -math.sin(azimuth), -math.cos(azimuth)
    deviation = math.sqrt(max(along(optics.roughness, east, north), 0.0))
    return Sight(east, north, azimuth, leg_passage_kernel(azimuth + math.pi - optics.sunlight.azimuth), deviation)


@kernel
def sun_factor(
    sun: Sunlight, rough: Roughness, line: DiscLine, sight: Sight, grazing: tuple[float, float], slope: tuple[float, float]
) -> tuple[float, float]:
    """Glint factor ``q S (1+Lambda_v)/(4 cos^4(beta) A+)`` [1/sr] and the cosine of incidence; ``grazing`` is its sine and cosine."""
    vz, horizontal = grazing
    slope_east, slope_north = slope
    ve, vn = sight.east * horizontal, sight.north * horizontal
    mz = vz + sun.up
    if not sun.shining or mz <= 1e-9:
        return 0.0, 0.0
    cosine = math.sqrt(max(0.5 * (1.0 + ve * sun.east + vn * sun.north + vz * sun.up), 0.0))
    if rough.east_east + rough.north_north <= 0.0:
        return mirror_factor(sun, ve, vn, vz, slope_east, slope_north), cosine
    per_mz = 1.0 / mz
    se, sn = -(ve + sun.east) * per_mz, -(vn + sun.north) * per_mz
    covariance = (0.0, 0.0, 0.0)
    if line.rows.shape[0] > 0:
        disc = disc_at(line, per_mz)
    else:
        disc, covariance = disc_of(sun, rough, mz, se, sn)
    de, dn = se + disc.east - slope_east, sn + disc.north - slope_north
    exponent = disc.ee * de * de + disc.en * de * dn + disc.nn * dn * dn
    if exponent > NEGLIGIBLE_EXPONENT:
        return 0.0, 0.0
    if sharp(rough, covariance):
        exponent += disc_edge(covariance, rough, (de, dn))
    tan2 = se * se + sn * sn
    tilt = sight.east * slope_east + sight.north * slope_north
    above = (vz - horizontal * tilt, sun.up - sun.east * slope_east - sun.north * slope_north)
    deviation = (horizontal * sight.deviation, sun.t_up * rough.towards_sun)
    mirroring = sight.east * se + sight.north * sn - tilt
    shared, log_ratio = shadowed(rough, sight, mirroring / max(sight.deviation, 1e-12), above, deviation)
    if shared <= 0.0:
        return 0.0, 0.0
    return math.exp(disc.peak - exponent + log_ratio) * (1.0 + tan2) * (1.0 + tan2) / shared, cosine


@kernel
def shadowed(
    rough: Roughness, sight: Sight, mirroring: float, above: tuple[float, float], deviation: tuple[float, float]
) -> tuple[float, float]:
    """``A+/(S (1+Lambda_v))`` by Smith's law, 0 where nothing is seen and lit, and the logarithm by which nested bands exceed it.

    ``mirroring``: slope that mirrors the Sun from the facet's tilt, towards the viewer, in deviations. ``above``: mean over the facet's
    slopes of ``v_z - v_h.s`` for the directions to viewer and Sun, and ``deviation`` its spread.
    """
    view, sun = above
    area = quick_visible_area_kernel(view, deviation[0])
    if area <= 0.0 or sun <= 0.0:
        return 0.0, 0.0
    ratio = 0.0
    if rough.nested.shape[0] > 0:
        per_deviation = view / max(deviation[0], 1e-12)
        ratio = nested_exponent_kernel(mirroring, per_deviation, 1.0, rough.nested)
        if sun < HIGHEST * deviation[1] and rough.lit.shape[0] > 1:
            ratio += sight.passage * lit_exponent_kernel(mirroring, per_deviation, sun / deviation[1], rough.lit)
    # above 4.5 deviations Smith's Lambda, the visible area over the mean less one, is below 1e-6
    if sun >= 4.5 * deviation[1] or view <= 0.0:
        return area, ratio
    lambda_sun = quick_visible_area_kernel(sun, deviation[1]) / sun - 1.0
    lambda_view = area / view - 1.0
    return view / both_legs_kernel(lambda_view, lambda_sun, sight.passage), ratio


@kernel
def sharp(rough: Roughness, disc: tuple[float, float, float]) -> bool:
    """True where the disc's covariance of slopes is so large beside the facet's that its edge counts."""
    return disc[0] + disc[2] > SHARP_DISC / (1.0 - SHARP_DISC) * (rough.east_east + rough.north_north)


@kernel
def disc_of(sun: Sunlight, rough: Roughness, mz: float, se: float, sn: float) -> tuple[Disc, tuple[float, float, float]]:
    """The :class:`Disc` about a mirroring slope, and its own covariance of slopes (ee, en, nn); ``mz`` as in :func:`disc_in_slopes`."""
    disc_ee, disc_en, disc_nn, shift_e, shift_n = disc_in_slopes(sun, mz, se, sn)
    # the weight 1/cos^4(beta), growing as exp(4 s/(1+s^2) . ds) across the disc's image, moves its centre
    lean = 4.0 / (1.0 + se * se + sn * sn)
    east, north = shift_e + lean * (disc_ee * se + disc_en * sn), shift_n + lean * (disc_en * se + disc_nn * sn)
    ee, en, nn = disc_ee + rough.east_east, disc_en + rough.east_north, disc_nn + rough.north_north
    det = ee * nn - en * en
    peak = math.log(0.125 / (math.pi * math.sqrt(det)))
    return Disc(east, north, 0.5 * nn / det, -en / det, 0.5 * ee / det, peak), (disc_ee, disc_en, disc_nn)


@kernel
def disc_at(line: DiscLine, per_mz: float) -> Disc:
    """The :class:`Disc` between two rows of a line's table."""
    x = (per_mz - line.first) * line.per_step
    i = np.uint64(min(max(int(x), 0), line.rows.shape[0] - 2))
    f = x - float(i)
    a, b = line.rows[i], line.rows[np.uint64(i + np.uint64(1))]
    return Disc(
        a[0] + f * (b[0] - a[0]),
        a[1] + f * (b[1] - a[1]),
        a[2] + f * (b[2] - a[2]),
        a[3] + f * (b[3] - a[3]),
        a[4] + f * (b[4] - a[4]),
        a[5] + f * (b[5] - a[5]),
    )


@njit
def no_disc_line() -> DiscLine:
    """For single rays: without a table."""
    return DiscLine(np.empty((0, DISC_ROWS[1])), 0.0, 0.0)


@njit
def disc_line(optics: FacetOptics, sight: Sight, rows: np.ndarray) -> DiscLine:
    """Fill ``rows`` with the :class:`DiscLine` of a line of sight, over the grazing angles of its thermal table."""
    sun, rough, axes = optics.sunlight, optics.roughness, optics.tables.axes
    low, high = max(axes[0, 0], 0.0), min(axes[0, 0] + (optics.tables.thermal.shape[0] - 1) / axes[0, 1], 1.0)
    none = DiscLine(rows[:0], 0.0, 0.0)
    if not sun.shining or rough.east_east + rough.north_north <= 0.0 or low + sun.up < 1e-3:
        return none
    first, last = 1.0 / (high + sun.up), 1.0 / (low + sun.up)
    step = max((last - first) / (rows.shape[0] - 1), 1e-9)
    for i in range(rows.shape[0]):
        mz = 1.0 / (first + i * step)
        sine = min(max(mz - sun.up, 0.0), 1.0)
        horizontal = math.sqrt(1.0 - sine * sine)
        disc, covariance = disc_of(sun, rough, mz, -(sight.east * horizontal + sun.east) / mz, -(sight.north * horizontal + sun.north) / mz)
        if sharp(rough, covariance):
            return none
        rows[i, 0], rows[i, 1], rows[i, 2] = disc.east, disc.north, disc.ee
        rows[i, 3], rows[i, 4], rows[i, 5] = disc.en, disc.nn, disc.peak
    return DiscLine(rows, first, 1.0 / step)


@kernel
def facet_sunlight(
    optics: FacetOptics,
    line: DiscLine,
    path: np.ndarray,
    at: tuple[int, float],
    sight: Sight,
    grazing: tuple[float, float],
    slope: tuple[float, float],
) -> tuple[float, float]:
    """Mirrored sunlight of a facet, attenuated [W m-2 sr-1], and its glint factor [1/sr].

    ``line`` is :func:`disc_line` of the line of sight, ``grazing`` the sine and cosine of the grazing angle; ``path`` and ``at`` as for
    :func:`facet_thermal`.
    """
    factor, cosine = sun_factor(optics.sunlight, optics.roughness, line, sight, grazing, slope)
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


@kernel
def disc_in_slopes(sun: Sunlight, mz: float, se: float, sn: float) -> tuple[float, float, float, float, float]:
    """Covariance (ee, en, nn) and mean offset (e, n) of the slopes that mirror the points of the solar disc, about those of its centre.

    With ``s = -(v+l)_h/(v+l)_z`` and ``l`` moved by ``d`` on the sphere, to second order
    ``ds = -(d_h + s d_z)/m_z + (d_h + s d_z) d_z/m_z^2 + |d|^2 (l_h + s l_z)/(2 m_z)``; the disc has ``<d d> = eps^2/4`` in every
    direction.
    """
    scale = 0.25 * SOLAR_ANGULAR_RADIUS * SOLAR_ANGULAR_RADIUS / (mz * mz)
    along_e, along_n = sun.t_east + se * sun.t_up, sun.t_north + sn * sun.t_up
    ee = scale * (sun.c_east * sun.c_east + along_e * along_e)
    en = scale * (sun.c_east * sun.c_north + along_e * along_n)
    nn = scale * (sun.c_north * sun.c_north + along_n * along_n)
    shift_e = scale * (along_e * sun.t_up + mz * (sun.east + se * sun.up))
    shift_n = scale * (along_n * sun.t_up + mz * (sun.north + sn * sun.up))
    return ee, en, nn, shift_e, shift_n


@kernel
def disc_edge(disc: tuple[float, float, float], rough: Roughness, offset: tuple[float, float]) -> float:
    """What a disc's sharp edge adds to the exponent of the Gaussian that stands for its convolution with the facet's slopes.

    A uniform disc has the fourth cumulants ``-(E_ij E_kl + E_ik E_jl + E_il E_jk)/3`` with ``E`` its covariance (``disc``). The Edgeworth
    factor is ``1 - H/24`` with ``H = (u.Eu)^2 - 2 tr(E/C) u.Eu - 4 u.E/C.Eu + tr(E/C)^2 + 2 tr((E/C)^2)``, ``u = C^-1 offset`` and ``C``
    the covariance of disc and facet; it is taken as ``exp(-H/24)``, which stays positive in the tails.
    """
    ee, en, nn = disc
    both_ee, both_en, both_nn = ee + rough.east_east, en + rough.east_north, nn + rough.north_north
    det = both_ee * both_nn - both_en * both_en
    i_ee, i_en, i_nn = both_nn / det, -both_en / det, both_ee / det
    ue, un = i_ee * offset[0] + i_en * offset[1], i_en * offset[0] + i_nn * offset[1]
    we, wn = ee * ue + en * un, en * ue + nn * un
    # E/C, row by row
    a, b = ee * i_ee + en * i_en, ee * i_en + en * i_nn
    c, d = en * i_ee + nn * i_en, en * i_en + nn * i_nn
    trace = a + d
    once = ue * we + un * wn
    twice = we * (i_ee * we + i_en * wn) + wn * (i_en * we + i_nn * wn)
    return (once * once - 2.0 * trace * once - 4.0 * twice + trace * trace + 2.0 * (a * a + 2.0 * b * c + d * d)) / 24.0


@kernel
def mirror_factor(sun: Sunlight, ve: float, vn: float, vz: float, slope_east: float, slope_north: float) -> float:
    """``1/(pi eps^2)`` where a smooth facet mirrors a point of the solar disc to the viewer ``v``, else 0."""
    norm = 1.0 / math.sqrt(1.0 + slope_east * slope_east + slope_north * slope_north)
    ne, nn, nz = -slope_east * norm, -slope_north * norm, norm
    twice = 2.0 * (ve * ne + vn * nn + vz * nz)
    re, rn, rz = twice * ne - ve - sun.east, twice * nn - vn - sun.north, twice * nz - vz - sun.up
    if re * re + rn * rn + rz * rz > SOLAR_ANGULAR_RADIUS * SOLAR_ANGULAR_RADIUS:
        return 0.0
    return 1.0 / (math.pi * SOLAR_ANGULAR_RADIUS * SOLAR_ANGULAR_RADIUS)


@kernel
def node(axes: np.ndarray, axis: int, size: int, value: float) -> tuple[int, float]:
    """Lower node and fraction of a value on a uniform axis; values outside take the nearest cell's end."""
    x = (value - axes[axis, 0]) * axes[axis, 1]
    x = min(max(x, 0.0), size - 1.000001)
    lower = int(x)
    return lower, x - lower


@kernel
def facet_thermal(
    axes: np.ndarray,
    thermal: ThermalLine,
    path: np.ndarray,
    at: tuple[int, float],
    sight: Sight,
    sine: float,
    slope: tuple[float, float],
) -> float:
    """Emission and reflected sky of a facet, attenuated [W m-2 sr-1], at a sine of the grazing angle.

    ``thermal`` is :func:`thermal_along` the line of sight, ``axes`` its :attr:`FacetTables.axes`; ``path`` the path's coefficients, and
    ``at`` the row that counts and the fraction of the way to the next.
    """
    i_path, f_path = at
    slope_east, slope_north = slope
    iu, fu = node(axes, 0, thermal.sines, sine)
    ia, fa = node(axes, 2, thermal.along, slope_east * sight.east + slope_north * sight.north)
    ic, fc = node(axes, 3, thermal.across, slope_east * sight.north - slope_north * sight.east)
    row = thermal.across * thermal.terms
    first = (iu * thermal.along + ia) * row + ic * thermal.terms
    weights = ((1.0 - fu) * (1.0 - fa), (1.0 - fu) * fa, fu * (1.0 - fa), fu * fa)
    corner = (first, first + row, first + thermal.along * row, first + thermal.along * row + row)
    warm = 0.0
    for k in range(0, thermal.terms, 4):
        w, x, y, z = four_terms(thermal.values, corner, k, weights)
        w2, x2, y2, z2 = four_terms(thermal.values, corner, k + thermal.terms, weights)
        warm += between(path, i_path, f_path, k) * (w + fc * (w2 - w))
        warm += between(path, i_path, f_path, k + 1) * (x + fc * (x2 - x))
        warm += between(path, i_path, f_path, k + 2) * (y + fc * (y2 - y))
        warm += between(path, i_path, f_path, k + 3) * (z + fc * (z2 - z))
    return warm


@kernel
def between(rows: np.ndarray, i: int, f: float, k: int) -> float:
    """An entry between row ``i`` and, where ``f`` is not 0, the next one."""
    if f == 0.0:
        return float(rows[i, k])
    return float(rows[i, k] + f * (rows[i + 1, k] - rows[i, k]))


@kernel
def one_term(values: np.ndarray, corner: tuple[int, int, int, int], k: int, weights: tuple[float, float, float, float]) -> float:
    """One term of a thermal table between four corners."""
    # addresses are never negative: spared the compiler's care for those that count from the end
    a, b, c, d = np.uint64(corner[0] + k), np.uint64(corner[1] + k), np.uint64(corner[2] + k), np.uint64(corner[3] + k)
    return float(weights[0] * values[a] + weights[1] * values[b] + weights[2] * values[c] + weights[3] * values[d])


@kernel
def four_terms(
    values: np.ndarray, corner: tuple[int, int, int, int], k: int, weights: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    """Four terms that lie together, which the processor takes at once."""
    return (
        one_term(values, corner, k, weights),
        one_term(values, corner, k + 1, weights),
        one_term(values, corner, k + 2, weights),
        one_term(values, corner, k + 3, weights),
    )


@njit
def thermal_line(table: np.ndarray) -> ThermalLine:
    """A table (u, a, c, k) that belongs to one azimuth."""
    return ThermalLine(table.reshape(table.size), table.shape[0], table.shape[1], table.shape[2], table.shape[3])


@njit
def thermal_along(tables: FacetTables, sight: Sight) -> ThermalLine:
    """The thermal table of one line of sight: interpolated to its azimuth once, as all its facets share it."""
    ix, fx = node(tables.axes, 1, tables.thermal.shape[1], sight.chi)
    nu, _, na, nc, terms = tables.thermal.shape
    # C order makes the two azimuths' parts of a row of the table plain stretches of memory
    size, share = na * nc * terms, np.float32(fx)
    flat, out = tables.thermal.reshape(tables.thermal.size), np.empty(nu * size, np.float32)
    for u in range(nu):
        first = (u * tables.thermal.shape[1] + ix) * size
        for i in range(size):
            near, far = flat[first + i], flat[first + size + i]
            out[u * size + i] = near + share * (far - near)
    return ThermalLine(out, nu, na, nc, terms)


class ThermalSources(NamedTuple):
    """Band terms of the light that a smooth facet sends: ``emitted[c, k]``, ``sky[c, m, k]``, ``black[k]``."""

    emitted: np.ndarray
    sky: np.ndarray
    black: np.ndarray


class SlopeQuadrature(NamedTuple):
    """Gauss-Legendre nodes along the view and Gauss-Hermite nodes across it, each with weights."""

    along: np.ndarray
    along_weight: np.ndarray
    cross: np.ndarray
    cross_weight: np.ndarray


@kernel
def add_mirror(sources: ThermalSources, sine: float, a: float, c: float, weight: float, out: np.ndarray) -> None:
    """Add to ``out[k]`` what a smooth facet of slope ``a`` towards the viewer and ``c`` across sends to a viewer at ``sine``."""
    cosine = math.sqrt(max(1.0 - sine * sine, 0.0))
    nz = 1.0 / math.sqrt(1.0 + a * a + c * c)
    cos_incidence = min(max((sine - cosine * a) * nz, 0.0), 1.0)
    up = 2.0 * cos_incidence * nz - sine
    if up <= 0.0:
        for k in range(out.shape[0]):
            out[k] += weight * sources.black[k]
        return
    x = cos_incidence * (sources.sky.shape[0] - 1)
    i = min(int(x), sources.sky.shape[0] - 2)
    f = x - i
    y = math.sqrt(min(up, 1.0)) * (sources.sky.shape[1] - 1)
    j = min(int(y), sources.sky.shape[1] - 2)
    g = y - j
    for k in range(out.shape[0]):
        emitted = (1.0 - f) * sources.emitted[i, k] + f * sources.emitted[i + 1, k]
        near = (1.0 - g) * sources.sky[i, j, k] + g * sources.sky[i, j + 1, k]
        far = (1.0 - g) * sources.sky[i + 1, j, k] + g * sources.sky[i + 1, j + 1, k]
        out[k] += weight * (emitted + (1.0 - f) * near + f * far)


@kernel
def mean_facet(
    sources: ThermalSources,
    q: SlopeQuadrature,
    rough: Roughness,
    sight: tuple[float, float],
    sine: float,
    slope: tuple[float, float],
    out: np.ndarray,
) -> None:
    """Average of :func:`add_mirror` over the visible slopes of a facet, into ``out[k]``; the weights are normalised to 1.

    ``sight`` is the horizontal unit vector to the viewer, ``slope`` the facet's towards the viewer and across.
    """
    east, north = sight
    cosine = math.sqrt(max(1.0 - sine * sine, 0.0))
    variance = along(rough, east, north)
    tangent = sine / max(cosine, 1e-12)
    sigma = math.sqrt(variance)
    out[:] = 0.0
    if sigma <= 0.0:
        add_mirror(sources, sine, slope[0], slope[1], 1.0, out)
        return
    a0, c0 = min(slope[0], tangent - FARTHEST_TURNED_AWAY * sigma), slope[1]
    across_e, across_n = north, -east
    mixed = (
        rough.east_east * east * across_e + rough.east_north * (east * across_n + north * across_e) + rough.north_north * north * across_n
    )
    across = along(rough, across_e, across_n)
    lean = mixed / across if across > 0.0 else 0.0
    spread = math.sqrt(max(variance - lean * mixed, 1e-3 * variance))
    total = 0.0
    for j in range(q.cross.shape[0]):
        c = c0 + math.sqrt(across) * q.cross[j]
        centre = a0 + lean * (c - c0)
        low, high = centre - 5.0 * spread, min(centre + 5.0 * spread, tangent)
        # steeper than this the facet mirrors the sea, not the sky: the integrand may jump there
        turn = (math.sqrt(max(cosine * cosine + sine * sine * (1.0 - c * c), 0.0)) - cosine) / max(sine, 1e-9)
        turn = min(max(turn, low), high)
        for part in range(2):
            start, end = (low, turn) if part == 0 else (turn, high)
            for i in range(q.along.shape[0]):
                a = start + 0.5 * (end - start) * (1.0 + q.along[i])
                z = (a - centre) / spread
                # proportional to the visible density of slopes; constants cancel in the normalisation
                w = q.along_weight[i] * (end - start) * math.exp(-0.5 * z * z) * max(sine - cosine * a, 0.0) * q.cross_weight[j]
                if w > 0.0:
                    if rough.nested.shape[0] > 0:
                        w *= math.exp(nested_exponent_kernel(a - a0, tangent - a0, sigma, rough.nested))
                    add_mirror(sources, sine, a, c, w, out)
                    total += w
    for k in range(out.shape[0]):
        out[k] /= total


@njit_parallel
def fill_thermal(sources: ThermalSources, quadrature: SlopeQuadrature, rough: Roughness, axes: np.ndarray, out: np.ndarray) -> None:
    """Tabulate :func:`mean_facet` over grazing angle, view azimuth and resolved slope."""
    nu, nx, na, nc, _ = out.shape
    for row in numba.prange(nu * nx * na):
        u, x, a = row // (nx * na), (row // na) % nx, row % na
        sine = min(axes[0, 0] + u / axes[0, 1], 1.0)
        chi = axes[1, 0] + x / axes[1, 1]
        sight = (-math.sin(chi), -math.cos(chi))
        buffer = np.zeros(out.shape[4])
        for c in range(nc):
            slope = (axes[2, 0] + a / axes[2, 1], axes[3, 0] + c / axes[3, 1])
            mean_facet(sources, quadrature, rough, sight, sine, slope, buffer)
            out[u, x, a, c, :] = buffer


def _axis(low: float, high: float, step: float) -> tuple[float, float, int]:
    """First node, 1/step and number of nodes of a uniform axis that covers [low, high] with steps of at most ``step``."""
    if high - low < 1e-9:
        return low - 5e-4, 1e3, 2
    size = max(int(np.ceil((high - low) / step)), 1) + 1
    return low, (size - 1) / (high - low), size


def thermal_axes(
    roughness: SlopeStatistics, resolved: tuple[float, float], sines: tuple[float, float], azimuths: tuple[float, float]
) -> tuple[FloatArray, tuple[int, int, int, int]]:
    """Axes of the thermal table, (4, 2) first nodes and inverse steps [1, rad, 1, 1], and the numbers of nodes.

    Steps follow the roughness: the average changes over about one deviation of the facet's slopes. Slopes span 5.5 deviations of the
    resolved waves.
    """
    sigma = max(float(np.sqrt(0.5 * roughness.mss)), 0.02)
    reach = 5.5 * float(np.sqrt(max(resolved)))
    isotropic = abs(roughness.mss_up - roughness.mss_cross) < 1e-3 * max(roughness.mss, 1e-12)
    middle = 0.5 * (azimuths[0] + azimuths[1])
    span = (middle, middle) if isotropic else azimuths
    parts = (
        _axis(sines[0], sines[1], min(0.15 * sigma, 0.015)),
        _axis(span[0], span[1], np.radians(8.0)),
        _axis(-reach, reach, 0.25 * sigma),
        _axis(-reach, reach, 0.7 * sigma),
    )
    return np.array([p[:2] for p in parts]), (parts[0][2], parts[1][2], parts[2][2], parts[3][2])


def band_reflectance(basis: PathBasis, water: WaterIndex) -> FloatArray:
    """Reflectance [1] over the nodes in the cosine of incidence and the basis' wavenumbers."""
    incidence = np.linspace(0.0, 1.0, INCIDENCE_NODES)
    # The outermost samples can lie just outside the water's table where the band ends on its edge: hold the index there.
    nu = np.clip(basis.wavenumber_cm, 1e4 / water.wavelength_um[-1], 1e4 / water.wavelength_um[0])
    return reflectance(incidence[:, None], water.index(nu)[None, :])


def thermal_sources(basis: PathBasis, view: SeaView) -> ThermalSources:
    """Band terms of emission, reflected sky and a blackbody at the sea's temperature."""
    rho = band_reflectance(basis, view.water)
    black = planck_wavenumber(basis.wavenumber_cm, view.sea_temperature)
    zenith = np.arccos(np.linspace(0.0, 1.0, SKY_NODES) ** 2)
    sky = view.atmosphere.sky_radiance(zenith)[:, basis.grid]
    weighted = basis.phi * basis.weights
    reflected = np.stack([(rho * w) @ sky.T for w in weighted], axis=-1)
    return ThermalSources(basis.project((1.0 - rho) * black), np.ascontiguousarray(reflected), basis.project(black))


def sunlight(zenith: float, azimuth: float, shining: bool) -> Sunlight:
    """The Sun's direction, the tangents to it, in its vertical plane and horizontal, and its limbs."""
    sz, cz, sa, ca = np.sin(zenith), np.cos(zenith), np.sin(azimuth), np.cos(azimuth)
    elevation = 0.5 * np.pi - zenith
    limbs = np.tan(np.clip(elevation + np.array([-1.0, 1.0]) * SOLAR_ANGULAR_RADIUS, -1.5, 0.5 * np.pi - 1e-6))
    values = (azimuth, sz * sa, sz * ca, cz, -cz * sa, -cz * ca, sz, ca, -sa, sa, ca, elevation, *limbs)
    return Sunlight(shining, *(float(v) for v in values))


def roughness_of(slopes: SlopeStatistics, solar_azimuth: float, bands: float, *, sun_too: bool = True) -> Roughness:
    """Facet slopes as kernels take them, with nested shadowing in so many bands (1: Smith's), of the Sun's leg too or not.

    Between whole numbers of bands the logarithms of the laws are interpolated, so that facets change evenly with their share of the slopes.
    """
    towards = float(np.sqrt(slopes.mss_along(solar_azimuth)))
    nested, lit = between_bands(ratio_table, bands), between_bands(lit_table, bands * LIT_BANDS / BANDS if sun_too else 1.0)
    return Roughness(*slopes.covariance(), towards, nested.astype(np.float32), lit.astype(np.float32))


def thermal_table(
    sources: ThermalSources, rough: Roughness, axes: FloatArray, shape: tuple[int, int, int, int], terms: int
) -> NDArray[np.float32]:
    """Band terms of the emission and reflected sky of facets [W m-2 sr-1]: ``shape`` of :func:`thermal_axes`, and ``terms``."""
    nodes, weights = np.polynomial.legendre.leggauss(ALONG_NODES)
    cross, cross_weights = hermegauss(CROSS_NODES)
    quadrature = SlopeQuadrature(nodes, weights, cross, cross_weights / cross_weights.sum())
    thermal = np.empty((*shape, terms), dtype=np.float32)
    fill_thermal(sources, quadrature, rough, axes, thermal)
    return thermal


def sun_terms(basis: PathBasis, irradiance: FloatArray, water: WaterIndex) -> FloatArray:
    """Band terms of reflectance times solar irradiance over the cosine of incidence, (incidence nodes, k) [W m-2].

    ``irradiance`` [W m-2 (cm-1)-1] is given on the basis' wavenumbers.
    """
    return basis.project(band_reflectance(basis, water) * irradiance)
