r"""Sparkles: fluctuation of the sunlight of a pixel about the mean of its facets, from cells smaller than the pixel.

The sea is a field of independent cells of length ``l`` (:mod:`seaglint.radiance.variance`). A cell mirrors the Sun with probability P; for
a detector of many cells the sum is nearly gamma distributed. So the light of a cell is a gamma deviate of mean 1 and variance ``1/P - 1``,
and the light of a pixel is the average over its visible cells. The relative variance of a pixel is

- of many cells

  .. math:: v = \frac{1/P - 1}{M}, \qquad M = \frac{\Omega r^2\cos\beta}{l^2\cos\omega}

- of part of one cell ``1/P - 1``,
- between these the variance of a box at a random place over square cells.

A visible cell is ``l`` across the line of sight and ``c l`` along it on the ground, ``c = cos(omega)/(cos(beta) cos(theta_v))`` with the
mean sea's zenith angle: a tilted mirror hides the water behind it. Pixels of up to ``MOST_CELLS`` cells in a direction are averages
over these cells, which they share with their neighbours. In larger pixels one cell of the size of the pixel, with the shape of their sum,
represents all. Cells lie on lattices fixed to the water's mean position, turned to the line of sight in ``SECTORS`` steps. In time a
cell has a constant value between the events of a Poisson process, so that its correlation is ``exp(-|t|/T_c)`` and any instant can be
evaluated alone. No state is stored: a factor is a function of (seed, place, time).

**From the waves.** With a ``ClusterTable`` the variance of a pixel is that of the waves that are no geometry
(``seaglint.sea.glitter.lit_share``), by the steepness of its facets against the mirroring slope, and so is the time. A pixel smaller
than these waves is the product of gamma fields on lattices of sides of powers of two, each with the variance that the waves have between
its side and the next, and of one more that gives the pixel its variance; ``seaglint.imaging.wave_sparkle`` makes the table. Steeper facets
have more variance, in squares of all sides: a pixel has the fields of the steepness at which facets would have its variance.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import horizon_depression, horizon_range, surface_range
from seaglint.base.jit import kernel, njit
from seaglint.base.keyed_random import cell_key, gamma_deviate, last_event
from seaglint.base.random import stream
from seaglint.facet.facet_sunlight import FacetOptics
from seaglint.facet.roughness import Roughness, Sight
from seaglint.facet.sunlight import Sunlight, sunlight_at
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.layers import SPREAD, SUN, TOTAL

#: Number of cells in one direction up to which a pixel is their average; beyond, pixels are independent.
#:
#: A box of 10 x 10 cells has 7 % less variance than independent ones; the pixel and the average of many each take half of that.
MOST_CELLS = 10.0

#: Half of the extra cells of a random box: over n cells in a row it has the variance of n + 1/3 independent ones (1/n - 1/(3 n^2)).
BORDER = 1.0 / 6.0

INDEPENDENT = 3.0  #: Number of cells in either direction from which on neighbouring pixels of a sensor's picture are independent.

COMPONENTS = 2  #: Number of independent parts of a pixel of many cells; it changes in steps of half its fluctuation.

SECTORS = 64  #: Number of lattice directions in a full circle; a pixel is then at most 2.8 deg from one.

FILLED = 0.7  #: Largest share of a standing cell in the pixel's width in either direction, so that neighbours do not share one.

STEEPNESS_STEP = 0.5  #: Step of the facets' steepness in a ``ClusterTable``, in their standard deviations [1].

FIELD_STEPS = 2  #: Number of these steps between fields of cells.

NO_FIELD = 1e-3  #: Share of a pixel's variance below which a field of cells is omitted [1].


class ClusterTable(NamedTuple):
    """Fluctuation of the mirrored Sun from the waves that are no geometry.

    By stretches of the sea in which the same waves are geometry. ``begins``: their first arcs [m, (n,)]. ``nodes[l] = (log of the first
    arc, nodes per log)``. ``area[l, node, way, u]``: log of the variance of a pixel's lit share times its area on the sea [m2], with its
    length along (way 0) and across (1) the wind, at a steepness ``u STEEPNESS_STEP`` of the facets. ``shares[l, u, j]``: variance of the
    cells of side ``2**(top - j)`` m, 0 where they are smaller than pixels, at a steepness ``u FIELD_STEPS STEEPNESS_STEP`` [1].
    ``times[l, j]``: their correlation time, and last the pixel's [s].
    ``reach``: length of waves over 2 pi of each level [m]. ``wind``: azimuth of the waves [rad]; ``disc``: a quarter of the squared radius
    of the Sun in slopes [1].
    """

    begins: np.ndarray
    nodes: np.ndarray
    area: np.ndarray
    shares: np.ndarray
    times: np.ndarray
    reach: np.ndarray
    top: int
    wind: float
    disc: float


#: Table of images whose sea has cells of one length.
NO_CLUSTERS = ClusterTable(
    np.empty(0), np.empty((0, 2)), np.empty((0, 0, 2, 0)), np.empty((0, 0, 0)), np.empty((0, 0)), np.empty(0), 0, 0.0, 0.0
)


class Sparkle(NamedTuple):
    """Sparkle parameters of an image.

    Two words of the seed, the cell's length [m] (0: no sparkles), the correlation time [s], and what replaces both where the waves decide.
    """

    seed_low: int
    seed_high: int
    cell: float
    correlation_time: float
    clusters: ClusterTable = NO_CLUSTERS


NO_SPARKLE = Sparkle(0, 0, 0.0, 1.0)  #: Parameters of images that hold the mean over the facets of a pixel.


class SparkleRows(NamedTuple):
    """Mean sea in each row of an image.

    ``range_m, along, reach``: arc from the sensor's foot to the row's middle, length of the row on the ground, distance from the axis
    through the sensor and the Earth's centre [m]. ``grazing``: sine of the mean grazing angle. ``column_step``: width of a pixel [rad].
    """

    range_m: np.ndarray
    along: np.ndarray
    reach: np.ndarray
    grazing: np.ndarray
    column_step: float


def sparkle_of(seed: int, cell: float, correlation_time: float) -> Sparkle:
    """Return the sparkle parameters of a sea from the length of its cells [m] and their correlation time [s].

    Examples
    --------
    >>> sparkle_of(1, 0.0026, 0.07).cell
    0.0026
    """
    low, high = stream(seed, "sparkle").integers(0, 2**32, size=2)
    return Sparkle(int(low), int(high), float(cell), float(correlation_time))


def sparkle_rows(camera: Camera) -> SparkleRows:
    """Return footprints of a camera's pixels on the mean sea; rows above its horizon show crests and have the footprint of the horizon."""
    horizon = horizon_depression(camera.height)
    far = horizon_range(camera.height)
    edges = camera.top - np.arange(camera.rows + 1) * camera.row_step

    def arc(elevation: np.ndarray) -> np.ndarray:
        arcs = np.asarray(surface_range(camera.height, np.clip(-elevation, horizon, 0.5 * np.pi)))
        return np.where((-elevation <= horizon) | ~np.isfinite(arcs), far, arcs)

    middle = arc(camera.elevations)
    upper, lower = arc(edges[:-1]), arc(edges[1:])
    psi = middle / EFFECTIVE_EARTH_RADIUS
    reach = EFFECTIVE_EARTH_RADIUS * np.sin(psi)
    slant = np.hypot(reach, camera.height + 2.0 * EFFECTIVE_EARTH_RADIUS * np.sin(0.5 * psi) ** 2)
    # rows above the horizon have no length on the ground, as they show crests: at least the length at normal incidence
    floor = slant * camera.row_step
    along = np.maximum(upper - lower, floor)
    return SparkleRows(middle, along, reach, np.clip(floor / along, 1e-6, 1.0), camera.column_step)


class Heading(NamedTuple):
    """Lattice direction nearest to a line of sight: its number and its sine and cosine of azimuth."""

    sector: int
    sine: float
    cosine: float


@kernel
def heading(azimuth: float) -> Heading:
    """Return the ``Heading`` of a line that leaves the sensor at an azimuth [rad]."""
    turn = 2.0 * math.pi / SECTORS
    sector = math.floor(azimuth / turn + 0.5) % SECTORS
    return Heading(sector, math.sin(sector * turn), math.cos(sector * turn))


@kernel
def lattice_number(along_sight: Heading, doublings_along: int, doublings_across: int) -> int:
    """Return the first of four numbers of lattices with cells of these powers of two: each lattice has its own random numbers."""
    # offset to be positive
    return ((along_sight.sector * 256 + doublings_along + 128) * 256 + doublings_across + 128) * 4


@kernel
def cell_light(sparkle: Sparkle, i: int, j: int, lattice: int, shape: float, time: float) -> float:
    """Return the gamma deviate of mean 1 of a cell since its last change."""
    key = cell_key((sparkle.seed_low, sparkle.seed_high), i, j, lattice)
    return gamma_deviate(shape, (key[1], key[0]), last_event(key, time / sparkle.correlation_time))


@kernel
def average(
    sparkle: Sparkle, lattice: int, along: tuple[float, float, float], across: tuple[float, float, float], shape: float, time: float
) -> float:
    """Return the mean over a box of cells of one lattice, gamma deviates of mean 1.

    ``along`` and ``across``: ends of the box and side of the cells, in each direction.
    """
    # in a direction with one cell the share is 1, also for a box of no length
    first_i, last_i = math.floor(along[0] / along[2]), math.floor(along[1] / along[2])
    first_j, last_j = math.floor(across[0] / across[2]), math.floor(across[1] / across[2])
    total, whole = 0.0, 0.0
    for i in range(first_i, last_i + 1):
        wide = min(along[1], (i + 1) * along[2]) - max(along[0], i * along[2]) if last_i > first_i else 1.0
        for j in range(first_j, last_j + 1):
            share = min(across[1], (j + 1) * across[2]) - max(across[0], j * across[2]) if last_j > first_j else 1.0
            total += wide * share * cell_light(sparkle, i, j, lattice, shape, time)
            whole += wide * share
    return total / whole


@kernel
def standing(sparkle: Sparkle, lattice: int, place: tuple[float, float], sides: tuple[float, float], shape: float, time: float) -> float:
    """Return the mean of ``COMPONENTS`` gamma deviates of a pixel of many cells, on lattices of cells of about its size.

    ``place``, ``sides``: middle of the pixel and sides of the cells, along and across the line of sight [m].
    """
    total = 0.0
    for part in range(COMPONENTS):
        shift = part / COMPONENTS
        i, j = math.floor(place[0] / sides[0] + shift), math.floor(place[1] / sides[1] + shift)
        total += cell_light(sparkle, i, j, lattice + part, shape / COMPONENTS, time)
    return total / COMPONENTS


@kernel
def box(middle: float, length: float, side: float) -> tuple[float, float, float]:
    """Return the ends of a box and the side of the cells under it."""
    return middle - 0.5 * length, middle + 0.5 * length, side


@kernel
def power_below(x: float) -> tuple[int, float]:
    """Return the exponent of the largest power of two up to ``x``, and the power."""
    fraction, exponent = math.frexp(x)
    return exponent - 1, 0.5 * x / fraction


@kernel
def sparkle_factor(
    sparkle: Sparkle,
    place: tuple[float, float],
    along_sight: Heading,
    footprint: tuple[float, float],
    stretch: float,
    variance: float,
    time: float,
) -> float:
    """Return a factor of mean 1 for the mirrored Sun of a pixel [1].

    Parameters
    ----------
    sparkle : Sparkle
        The sea's parameters.
    place : tuple of float
        Middle of the footprint, east and north [m]: the water's mean position.
    along_sight : Heading
        Direction of the line of sight, from ``heading``.
    footprint : tuple of float
        Its length along the line of sight and its width [m], on the mean sea.
    stretch : float
        Length along the line of sight of a cell that is seen, over ``l`` [1].
    variance : float
        ``(1/P - 1)/M``, the relative variance if the pixel saw many cells [1].
    time : float
        Instant [s].

    Returns
    -------
    float
        Factor, 0 or more [1].
    """
    if not variance > 0.0:
        return 1.0
    x = place[0] * along_sight.sine + place[1] * along_sight.cosine
    y = place[0] * along_sight.cosine - place[1] * along_sight.sine
    length, width = footprint
    cell = sparkle.cell
    cells_along, cells_across = length / (cell * stretch), width / cell
    shape = 1.0 / (variance * cells_along * cells_across)  # of one cell; a direction of many cells changes it
    many_along, many_across = cells_along > MOST_CELLS, cells_across > MOST_CELLS
    doublings_across, side_across = 0, cell
    # sizes of cells in powers of two, so that neighbouring pixels of slowly changing footprints lie on one lattice
    if many_across:
        shape *= cells_across + BORDER
        doublings_across, power = power_below(FILLED * cells_across)
        side_across = cell * power
    if many_along:
        shape *= cells_along + BORDER
        doublings_along, power = power_below(FILLED * length / cell)
    else:
        doublings_along, power = power_below(stretch)
    lattice = lattice_number(along_sight, doublings_along, doublings_across)
    side_along = cell * power
    across = box(y, 0.0 if many_across else width, side_across)
    if many_along:
        along = box(x, 0.0, side_along)
        if not many_across:
            return average(sparkle, lattice, along, across, shape, time)
        return standing(sparkle, lattice, (x, y), (side_along, side_across), shape, time)
    # two lattices share the shape so that it is the cell's in a point and the integral over the cell is its area
    near = min(max(2.0 - stretch / power, 1e-6), 1.0)
    total = near * average(sparkle, lattice, box(x, length, side_along), across, near * shape, time)
    if near < 1.0:
        far = 1.0 - near
        total += far * average(sparkle, lattice + 256 * 256 * 256, box(x, length, 2.0 * side_along), across, far * shape, time)
    return total


@kernel
def piece_variance(sparkle: Sparkle, solar: float, chance: float, cos_incidence: float, up: float, across: float) -> float:
    """Return the variance of the mirrored Sun of one piece in a pixel of many cells, ``L^2 (1/P - 1)/M`` [W2 m-4 sr-2], to be averaged.

    ``chance`` is P of the facet, ``up`` the sum of the vertical components of the directions to the sensor and to the Sun,
    ``2 cos(omega) cos(beta)``, and ``across`` the pixel's area across the line of sight [m2]. Weighted by the share of the pixel that
    each piece fills and divided by the square of its mean sunlight, it is the ``variance`` of ``sparkle_factor``.
    """
    if chance <= 0.0 or chance >= 1.0:
        return 0.0
    patches = across * up / (2.0 * cos_incidence * cos_incidence * sparkle.cell * sparkle.cell)
    return solar * solar * (1.0 / chance - 1.0) / patches


@kernel
def cluster_level(table: ClusterTable, arc: float) -> int:
    """Return the number of the stretch of the sea at an arc from the sensor's foot [m]."""
    level = 0
    while level + 1 < table.begins.shape[0] and arc >= table.begins[level + 1]:
        level += 1
    return level


@kernel
def cluster_log_area(table: ClusterTable, level: int, arc: float, steepness: float, along: float) -> float:
    """Return the logarithm of the variance of a pixel's lit share times its area on the sea [m2].

    ``steepness``: distance of the mirroring slope from the facet's, in its deviations. ``along``: squared cosine of the angle between the
    line of sight and the wind.
    """
    area = table.area[level]
    x = min(max((math.log(arc) - table.nodes[level, 0]) * table.nodes[level, 1], 0.0), area.shape[0] - 1.0)
    i = min(int(x), area.shape[0] - 2)
    u = steepness / STEEPNESS_STEP
    j = min(int(u), area.shape[2] - 2)
    total = 0.0
    for way in range(2):
        near = area[i, way, j] + (u - j) * (area[i, way, j + 1] - area[i, way, j])
        far = area[i + 1, way, j] + (u - j) * (area[i + 1, way, j + 1] - area[i + 1, way, j])
        total += (along if way == 0 else 1.0 - along) * (near + (x - i) * (far - near))
    return total


@kernel
def cluster_fields(table: ClusterTable, level: int, arc: float, area: float, along: float) -> tuple[float, float]:
    """Return the place of a pixel among the steps of the fields, and its variance times its area on the sea there [m2].

    ``area``: variance times area of the pixel [m2], equal to what is returned within the steps of the table. Between two steps the place
    is linear in the variance, as the variances of fields are.
    """
    lower = 0.0
    for step in range(table.shares.shape[1]):
        upper = math.exp(cluster_log_area(table, level, arc, step * FIELD_STEPS * STEEPNESS_STEP, along))
        if area < upper:
            return (0.0, upper) if step == 0 else (step - 1 + (area - lower) / (upper - lower), area)
        lower = upper
    return table.shares.shape[1] - 1.0, lower


@kernel
def clustered_spread(
    table: ClusterTable,
    lit: FacetOptics,
    sight: Sight,
    slopes: tuple[float, float, float, float, float],
    half: tuple[float, float],
    arc: float,
) -> tuple[float, float]:
    """Return the variance of a pixel's lit share times its area on the sea [m2], and the facet's density at the mirroring slope [1].

    ``slopes``: resolved slope towards east and north, and the covariance about it (ee, en, nn). ``half``: mirroring slope, east and north.
    """
    rough: Roughness = lit.roughness
    ee, en, nn = rough.east_east + slopes[2] + table.disc, rough.east_north + slopes[3], rough.north_north + slopes[4] + table.disc
    east, north = half[0] - slopes[0], half[1] - slopes[1]
    area = ee * nn - en * en
    squared = max((nn * east * east - 2.0 * en * east * north + ee * north * north) / area, 0.0)
    along = sight.east * math.sin(table.wind) + sight.north * math.cos(table.wind)
    density = math.exp(-0.5 * squared) / (2.0 * math.pi * math.sqrt(area))
    return math.exp(cluster_log_area(table, cluster_level(table, arc), arc, math.sqrt(squared), along * along)), density


@kernel
def facet_spread(
    sparkle: Sparkle,
    lit: FacetOptics,
    sight: Sight,
    grazing: tuple[float, float],
    slopes: tuple[float, float, float, float, float],
    light: tuple[float, float],
    across: float,
    arc: float,
) -> float:
    """Return the variance ``piece_variance`` of a facet [W2 m-4 sr-2]; 0 without sparkles.

    ``light``: its sunlight, and ``sun_factor`` times the share of the Sun above the waves [1/sr]; multiplied by the solid angle of the Sun
    this is P. ``grazing``: sine and cosine of the grazing angle; ``slopes`` and ``arc`` as of ``clustered_spread``. From the waves the
    variance is the lit share's of the pixel, whose area on the sea is ``across`` over ``A+ = q/(4 cos^4(beta) factor)``, the sine of the
    angle at which the facet is seen.
    """
    solar, factor = light
    if sparkle.cell <= 0.0 or factor <= 0.0:
        return 0.0
    sun = lit.sunlight
    sine, cosine = grazing
    twice = 1.0 + cosine * (sight.east * sun.east + sight.north * sun.north) + sine * sun.up
    if sparkle.clusters.begins.shape[0] == 0:
        chance = factor * math.pi * sun.radius * sun.radius
        return piece_variance(sparkle, solar, chance, math.sqrt(max(0.5 * twice, 1e-12)), sine + sun.up, across)
    up = sine + sun.up
    half = (-(sight.east * cosine + sun.east) / up, -(sight.north * cosine + sun.north) / up)
    correlated, density = clustered_spread(sparkle.clusters, lit, sight, slopes, half, arc)
    # cos(beta) = up/(2 cos(omega)), and 4 cos^2(omega) = 2 twice
    cosine_tilt = up * up / max(2.0 * twice, 1e-12)
    seen = density / (4.0 * cosine_tilt * cosine_tilt * factor)
    return solar * solar * correlated * seen / across


@kernel
def kept_share(length: float, side: float) -> float:
    """Return the share of the variance of cells in a row that is left in a mean over a length, at a random place [1]."""
    ratio = length / side
    return 1.0 - ratio / 3.0 if ratio <= 1.0 else 1.0 / ratio - 1.0 / (3.0 * ratio * ratio)


@kernel
def clustered_factor(
    sparkle: Sparkle,
    place: tuple[float, float],
    along_sight: Heading,
    footprint: tuple[float, float],
    variance: float,
    tabulated: tuple[float, float],
    level: int,
    time: float,
) -> float:
    """Return a factor of mean 1 for the mirrored Sun of a pixel, of a relative variance [1]; arguments as of ``sparkle_factor``.

    ``tabulated``: the pixel's place among the steps of the fields, and its relative variance there: the same within the table's steps.
    Fields of cells larger than the pixel, which it shares with its neighbours, are multiplied; one of its own adds what is left of the
    variance: ``1 + v = prod_j (1 + v_j) (1 + v_own)``. Between two steps and beyond the table the product of the first fields, less 1, is
    linear in the variance.
    """
    if not variance > 0.0:
        return 1.0
    table = sparkle.clusters
    x = place[0] * along_sight.sine + place[1] * along_sight.cosine
    y = place[0] * along_sight.cosine - place[1] * along_sight.sine
    length, width = footprint
    last = table.shares.shape[2]
    ratio = variance / tabulated[1]
    lower = min(int(tabulated[0]), table.shares.shape[1] - 2)
    shares, upper = table.shares[level], tabulated[0] - lower
    factor, before, below, above = 1.0, 0.0, 1.0, 1.0
    for j in range(last):
        side = 2.0 ** (table.top - j)
        if side <= width:
            continue
        kept = kept_share(length, side) * kept_share(width, side)
        new_below, new_above = below * (1.0 + shares[lower, j] * kept), above * (1.0 + shares[lower + 1, j] * kept)
        after = ratio * ((1.0 - upper) * new_below + upper * new_above - 1.0)
        added = (1.0 + after) / (1.0 + before) - 1.0
        # no more than the pixel's own variance: a pixel seen at a grazing angle may have less than a square one
        if added <= NO_FIELD * variance or after > variance:
            continue
        share, before, below, above = added / kept, after, new_below, new_above
        clock = Sparkle(sparkle.seed_low, sparkle.seed_high, side, table.times[level, j])
        lattice = lattice_number(along_sight, table.top - j, table.top - j) + COMPONENTS
        if length > MOST_CELLS * side:
            # one cell as long as the pixel, with the shape of their sum
            side_along = 2.0 ** power_below(FILLED * length)[0]
            along, shape = box(x, 0.0, side_along), (length / side + BORDER) / share
        else:
            along, shape = box(x, length, side), 1.0 / share
        factor *= average(clock, lattice, along, box(y, width, side), shape, time)
    own = (1.0 + variance) / (1.0 + before) - 1.0
    if own <= 1e-9:
        return factor
    doublings_along, side_along = power_below(FILLED * length)
    doublings_across, side_across = power_below(FILLED * width)
    clock = Sparkle(sparkle.seed_low, sparkle.seed_high, 1.0, table.times[level, last])
    lattice = lattice_number(along_sight, doublings_along, doublings_across)
    return factor * standing(clock, lattice, (x, y), (side_along, side_across), 1.0 / own, time)


@kernel
def sparkle_column(
    sparkle: Sparkle, rows: SparkleRows, sun: Sunlight, azimuth: float, origin: tuple[float, float], time: float, images: np.ndarray
) -> None:
    """Apply sparkles to the mirrored Sun of a column and its intervals, ``images`` (1 or more, channels, rows).

    The factor of a row is computed from the whole image ``images[0]`` and applied to all images. ``origin`` is the sensor's foot in the
    sea's coordinates, east and north [m]. The variance ``SPREAD`` is replaced by the light that sparkles add to pixels of many cells.
    """
    if sparkle.cell <= 0.0:
        return
    east, north = math.sin(azimuth), math.cos(azimuth)
    along_sight = heading(azimuth)
    for row in range(images.shape[2]):
        solar, variance = images[0, SUN, row], images[0, SPREAD, row]
        images[:, SPREAD, row] = 0.0
        if solar > 0.0 and variance > 0.0:
            sine = rows.grazing[row]
            cosine = math.sqrt(1.0 - sine * sine)
            there = sunlight_at(sun, east, north, rows.range_m[row])
            twice = 1.0 - cosine * (east * there.east + north * there.north) + sine * there.up
            # cos(omega)/cos(beta) over the sine of the grazing angle
            stretch = twice / ((sine + there.up) * sine)
            place = (origin[0] + rows.range_m[row] * east, origin[1] + rows.range_m[row] * north)
            footprint = (rows.along[row], rows.reach[row] * rows.column_step)
            relative = variance / (solar * solar)
            if sparkle.clusters.begins.shape[0] > 0:
                level = cluster_level(sparkle.clusters, rows.range_m[row])
                downwind = east * math.sin(sparkle.clusters.wind) + north * math.cos(sparkle.clusters.wind)
                area = footprint[0] * footprint[1]
                step, tabulated = cluster_fields(sparkle.clusters, level, rows.range_m[row], relative * area, downwind * downwind)
                factor = clustered_factor(sparkle, place, along_sight, footprint, relative, (step, tabulated / area), level, time)
                least = INDEPENDENT * sparkle.clusters.reach[level]
                many = footprint[0] > least and footprint[1] > least
            else:
                factor = sparkle_factor(sparkle, place, along_sight, footprint, stretch, relative, time)
                many = footprint[0] > INDEPENDENT * sparkle.cell * stretch and footprint[1] > INDEPENDENT * sparkle.cell
            for part in range(images.shape[0]):
                solar = images[part, SUN, row]
                images[part, TOTAL, row] += solar * (factor - 1.0)
                images[part, SUN, row] = solar * factor
                if many:
                    images[part, SPREAD, row] = solar * (factor - 1.0)


@njit
def sparkle_columns(
    sparkle: Sparkle,
    rows: SparkleRows,
    sun: Sunlight,
    azimuths: np.ndarray,
    origin: tuple[float, float],
    time: float,
    images: np.ndarray,
    part: tuple[int, int],
) -> None:
    """Apply ``sparkle_column`` to a part of the columns of ``images`` (columns, intervals, channels, rows)."""
    for column in range(part[0], part[1]):
        sparkle_column(sparkle, rows, sun, azimuths[column], origin, time, images[column])
