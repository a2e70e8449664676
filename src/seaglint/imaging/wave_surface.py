"""Resolved sea surface for kernels: heights and slopes from periodic lattices, bounds of the height, and shadows of waves.

Lattice points of a cubic B-spline hold its coefficients, not heights; :meth:`seaglint.sea.wave_field.WaveField.coefficients` computes them.

A level of detail (:mod:`seaglint.sea.wave_field`) is a choice of lattices whose heights add up. A kernel that follows a horizontal line
computes a ``course`` of it once: its start on every lattice of the level and its step over the lattice.

Most samples of a grazing line are hidden. A line is read in strips, lattice by lattice, longest waves first. A strip is left as soon as the
largest heights of the remaining lattices cannot bring it into view.

Under a low Sun crests shade the sea: a point is lit by the share of the solar disc above the skyline towards the Sun
(``sun_over_waves``).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.air.sun_and_sky import visible_part_kernel
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel, njit
from seaglint.base.sine import sine
from seaglint.facet.sunlight import Sunlight
from seaglint.imaging.foam_surface import NO_FOAM_SURFACE, FoamSurface, tile_share, with_holes
from seaglint.sea.foam.ship_foam import segments_share

STRIP = 64  #: Number of samples of a line that are read together.

SUBCELL_BITS = 16  #: Number of bits of positions within a cell: steps of ``2**-16`` of it, a fiftieth of a millimetre for cells of a metre.

SUBCELLS = 1 << SUBCELL_BITS

LONGEST_STRIP = 1 << 14  #: Largest number of cells along a strip, and of points a side of a lattice: with their parts they fill 31 bits.

WHOLE_TURNS = LONGEST_STRIP * SUBCELLS  #: Offset that keeps positions positive; a whole number of periods of any lattice.

#: Least number of lattice readings in a cell where samples lie closer.
#:
#: Heights are cubic between them: of the lattice's shortest waves, four cells long, 97 % of the variance remain in the worst case. Slopes
#: are read wherever they are needed.
READS_PER_CELL = 1.5

#: Largest ratio of a strip's last step to its first, or of its first to its last, at which heights are taken between readings.
EVEN_STEPS = 1.5

#: Number of knots of a line in a period of a wandering tile: between them its displacement is linear, within 0.03 % of the period.
KNOTS_PER_PERIOD = 12

FARTHEST = 4000  #: Number of steps after which a Sun at the very horizon counts as visible.


@kernel
def lay_rows(lattice: np.ndarray, k: int, rows: np.ndarray) -> None:
    """Copy the numbers ``k`` of a periodic lattice (n, n, 1 or 2) into rows of n + 3 points.

    With one more point before and two beyond along either axis the points around any cell lie at fixed distances from its address.
    """
    size = lattice.shape[0]
    for y in range(size + 3):
        source, at = (y - 1) & (size - 1), y * (size + 3)
        rows[at], rows[at + size + 1], rows[at + size + 2] = lattice[source, size - 1, k], lattice[source, 0, k], lattice[source, 1, k]
        for x in range(size):
            rows[at + 1 + x] = lattice[source, x, k]


@kernel
def spline_weights(f: np.float32) -> tuple[np.float32, np.float32, np.float32, np.float32]:
    """Return the weights of the four points around a place on a cubic B-spline, ``f`` cells beyond the second of them."""
    one, sixth = np.float32(1.0), np.float32(1.0 / 6.0)
    e = one - f
    first, last = e * e * e * sixth, f * f * f * sixth
    second = f * f * (np.float32(0.5) * f - one) + np.float32(2.0 / 3.0)
    return first, second, one - first - second - last, last


@kernel
def slope_weights(f: np.float32) -> tuple[np.float32, np.float32, np.float32, np.float32]:
    """Return the derivatives of the ``spline_weights`` [1/cell]."""
    half = np.float32(0.5)
    e = np.float32(1.0) - f
    first, last = -half * e * e, half * f * f
    second = f * (np.float32(1.5) * f - np.float32(2.0))
    return first, second, -first - second - last, last


@kernel
def cell(size: int, u: float, v: float) -> tuple[int, np.float32, np.float32]:
    """Return the address of the cell of a lattice position, and the fractions (v, u) within it. The lattice ``size`` is a power of two."""
    # the size is a power of two, so that a bit mask is the remainder, also of negative positions
    lower_u, lower_v = math.floor(u), math.floor(v)
    return (int(lower_v) & (size - 1)) * (size + 3) + (int(lower_u) & (size - 1)), np.float32(v - lower_v), np.float32(u - lower_u)


@kernel
def spline_value(z: np.ndarray, at: np.uint64, row: np.uint64, f: np.float32, g: np.float32) -> np.float32:
    """Return a cubic B-spline ``f`` along u and ``g`` along v into a cell; ``at``: its first of 16 points; ``row``: points in a row."""
    a0, a1, a2, a3 = spline_weights(f)
    b0, b1, b2, b3 = spline_weights(g)
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    total = b0 * (a0 * z[at] + a1 * z[at + one] + a2 * z[at + two] + a3 * z[at + three])
    at += row
    total += b1 * (a0 * z[at] + a1 * z[at + one] + a2 * z[at + two] + a3 * z[at + three])
    at += row
    total += b2 * (a0 * z[at] + a1 * z[at + one] + a2 * z[at + two] + a3 * z[at + three])
    at += row
    return np.float32(total + b3 * (a0 * z[at] + a1 * z[at + one] + a2 * z[at + two] + a3 * z[at + three]))


@kernel
def gradient(z: np.ndarray, at: np.uint64, row: np.uint64, f: np.float32, g: np.float32) -> tuple[np.float32, np.float32]:
    """Return the derivatives along u and v [m/cell] of a cubic B-spline; arguments as of ``spline_value``."""
    # four points along v at a time: each is read once for both derivatives
    a0, a1, a2, a3 = spline_weights(f)
    c0, c1, c2, c3 = slope_weights(f)
    b0, b1, b2, b3 = spline_weights(g)
    d0, d1, d2, d3 = slope_weights(g)
    i, j, k, m = at, at + row, at + row + row, at + row + row + row
    z0, z1, z2, z3 = z[i], z[j], z[k], z[m]
    along, across = c0 * (b0 * z0 + b1 * z1 + b2 * z2 + b3 * z3), a0 * (d0 * z0 + d1 * z1 + d2 * z2 + d3 * z3)
    one = np.uint64(1)
    i, j, k, m = i + one, j + one, k + one, m + one
    z0, z1, z2, z3 = z[i], z[j], z[k], z[m]
    along, across = along + c1 * (b0 * z0 + b1 * z1 + b2 * z2 + b3 * z3), across + a1 * (d0 * z0 + d1 * z1 + d2 * z2 + d3 * z3)
    i, j, k, m = i + one, j + one, k + one, m + one
    z0, z1, z2, z3 = z[i], z[j], z[k], z[m]
    along, across = along + c2 * (b0 * z0 + b1 * z1 + b2 * z2 + b3 * z3), across + a2 * (d0 * z0 + d1 * z1 + d2 * z2 + d3 * z3)
    i, j, k, m = i + one, j + one, k + one, m + one
    z0, z1, z2, z3 = z[i], z[j], z[k], z[m]
    return along + c3 * (b0 * z0 + b1 * z1 + b2 * z2 + b3 * z3), across + a3 * (d0 * z0 + d1 * z1 + d2 * z2 + d3 * z3)


class Surface(NamedTuple):
    """Sea of one instant as kernels read it.

    ``lattice`` is all lattices one after another, row by row (``seaglint.imaging.wave_surface.lay_rows``). ``part[i] = (address of the
    heights, points along a side, address of the spline, 1 where the heights are read from that spline and 0 where linearly)``; see
    ``point_height`` and ``slopes``. ``grid[i] = (1/spacing, cos, sin of the lattice's turn, u, v under the sensor)``. ``level[l]``:
    parts of the level, -1 where there are no more; ``crest[l, j]``: largest height that its parts from ``j`` on add [m]. ``wander[i, w] =
    (u, v, east, north, phase)``: amplitude [cells], wave vector [cycles/m] and phase under the sensor [cycles] of the waves that make up a
    part's displacement (``seaglint.sea.tiles``); none where tiles lie still. ``foam``: the foam on the tiles.
    """

    lattice: np.ndarray
    part: np.ndarray
    grid: np.ndarray
    level: np.ndarray
    crest: np.ndarray
    wander: np.ndarray
    foam: FoamSurface = NO_FOAM_SURFACE


class Bounds(NamedTuple):
    """Bounds for the steps of rays: of the sea's height [m] and slope [1], and the finest spacing of its lattices [m]."""

    crest: float
    steepest: float
    spacing: float


class SurfaceLine(NamedTuple):
    """Horizontal line over the lattices of one level, straight between the knots at which the displacement of a part is evaluated.

    ``start[j, m] + r step[j, m]``: position (u, v) [cells] at ``r`` metres, between the knots ``m`` and ``m + 1``; ``part[j]`` as in
    ``Surface``, and the last ``m``; ``knot[j] = (arc of the first knot [m], knots per metre)``; ``turn[j] = (cos, sin)`` of a part's
    turn over its spacing [1/m].
    """

    start: np.ndarray
    step: np.ndarray
    part: np.ndarray
    knot: np.ndarray
    turn: np.ndarray


class Strip(NamedTuple):
    """Buffers of up to ``STRIP`` samples: their heights [m], and positions of those that are read.

    These are arcs from the strip's beginning and heights [m], fractions (v, u) of cells, and addresses of the cells in their lattice.
    """

    height: np.ndarray
    arc: np.ndarray
    read: np.ndarray
    fraction: tuple[np.ndarray, np.ndarray]
    cell: np.ndarray


@njit
def new_strip() -> Strip:
    """Return an empty strip."""
    fraction = (np.empty(STRIP, np.float32), np.empty(STRIP, np.float32))
    return Strip(
        np.empty(STRIP, np.float32), np.empty(STRIP, np.float32), np.empty(STRIP, np.float32), fraction, np.empty(STRIP, np.uint32)
    )


@kernel
def knots(surface: Surface, i: int, arcs: tuple[float, float]) -> tuple[int, float]:
    """Return the number of straight pieces of a line between two arcs [m] over a part, and pieces per metre; 1 where the part is fixed."""
    if surface.wander.shape[1] == 0 or arcs[1] <= arcs[0]:
        return 1, 0.0
    per_metre = KNOTS_PER_PERIOD * surface.grid[i, 0] / surface.part[i, 1]
    return int((arcs[1] - arcs[0]) * per_metre) + 1, per_metre


@kernel
def displace(surface: Surface, i: int, direction: tuple[float, float], arcs: tuple[float, float], at: np.ndarray) -> None:
    """Compute the displacement of a part [cells] at the knots ``at[m]`` of a line; ``arcs = (first, distance of knots)`` [m]."""
    at[:] = 0.0
    for w in range(surface.wander.shape[1]):
        wave = surface.wander[i, w]
        along = wave[2] * direction[0] + wave[3] * direction[1]
        phase, turn, u, v = wave[4] + along * arcs[0], along * arcs[1], wave[0], wave[1]
        for m in range(at.shape[0]):
            height = sine(phase + m * turn)
            at[m, 0] += u * height
            at[m, 1] += v * height


@kernel
def lay_course(surface: Surface, level: int, direction: tuple[float, float], arcs: tuple[float, float], line: SurfaceLine) -> None:
    """Set ``line`` to the line from under the sensor along a horizontal unit vector (east, north), to be read between two arcs [m].

    Two equal arcs give a straight line with the displacement at that arc.
    """
    east, north = direction
    for j in range(line.part.shape[0]):
        i = surface.level[level, j]
        scale, c, s = surface.grid[i, 0], surface.grid[i, 1], surface.grid[i, 2]
        step_u, step_v = (c * east + s * north) * scale, (c * north - s * east) * scale
        for k in range(4):
            line.part[j, k] = surface.part[i, k]
        line.turn[j, 0], line.turn[j, 1] = c * scale, s * scale
        pieces, per_metre = knots(surface, i, arcs)
        line.part[j, 4] = pieces - 1
        line.knot[j, 0], line.knot[j, 1] = arcs[0], per_metre
        start, step = line.start[j], line.step[j]
        between = 1.0 / per_metre if per_metre > 0.0 else 0.0
        displace(surface, i, direction, (arcs[0], between), start[: pieces + 1])
        # each knot's displacement becomes the start, at r = 0, of the straight piece that begins there
        for m in range(pieces):
            bend_u, bend_v = (start[m + 1, 0] - start[m, 0]) * per_metre, (start[m + 1, 1] - start[m, 1]) * per_metre
            r = arcs[0] + m * between
            start[m, 0] += surface.grid[i, 3] - r * bend_u
            start[m, 1] += surface.grid[i, 4] - r * bend_v
            step[m, 0], step[m, 1] = step_u + bend_u, step_v + bend_v


@njit
def course(surface: Surface, level: int, east: float, north: float, arcs: tuple[float, float]) -> SurfaceLine:
    """Return the line from under the sensor along a horizontal unit vector; see ``lay_course``."""
    count, most = 0, 1
    while count < surface.level.shape[1] and surface.level[level, count] >= 0:
        most = max(most, knots(surface, surface.level[level, count], arcs)[0])
        count += 1
    positions = np.empty((2, count, most + 1, 2))
    line = SurfaceLine(positions[0], positions[1], np.empty((count, 5), np.int64), np.empty((count, 2)), np.empty((count, 2)))
    lay_course(surface, level, (east, north), arcs, line)
    return line


@kernel
def piece(line: SurfaceLine, j: int, r: float) -> int:
    """Return the straight piece of a line over a level's part ``j``, ``r`` metres along; first and last continue beyond their ends."""
    return int(min(max(int((r - line.knot[j, 0]) * line.knot[j, 1]), 0), line.part[j, 4]))


@kernel
def position(line: SurfaceLine, j: int, r: float) -> tuple[float, float]:
    """Return the position (u, v) [cells] over a level's part ``j``, ``r`` metres along a line."""
    m = piece(line, j, r)
    return line.start[j, m, 0] + r * line.step[j, m, 0], line.start[j, m, 1] + r * line.step[j, m, 1]


@kernel
def point_height(surface: Surface, line: SurfaceLine, j: int, u: float, v: float) -> float:
    """Return the height of a level's part ``j`` [m] at a position [cells]: a cubic B-spline of 16 points, or linear between four."""
    place, g, f = cell(line.part[j, 1], u, v)
    z, row, at, one = surface.lattice, np.uint64(line.part[j, 1] + 3), np.uint64(place + line.part[j, 0]), np.uint64(1)
    if line.part[j, 3] != 0:
        return float(spline_value(z, at, row, f, g))
    low, high = z[at] + f * (z[at + one] - z[at]), z[at + row] + f * (z[at + row + one] - z[at + row])
    return float(low + g * (high - low))


@kernel
def height(surface: Surface, line: SurfaceLine, first: int, last: int, r: float) -> float:
    """Return the summed height of a level's parts ``first`` to ``last`` (not included) [m], ``r`` metres along a line."""
    total = 0.0
    for j in range(first, last):
        u, v = position(line, j, r)
        total += point_height(surface, line, j, u, v)
    return total


@kernel
def slopes(surface: Surface, line: SurfaceLine, r: float) -> tuple[float, float]:
    """Return the slopes of a level towards east and north [1], ``r`` metres along a line."""
    east, north = 0.0, 0.0
    for j in range(line.part.shape[0]):
        u, v = position(line, j, r)
        at, g, f = cell(line.part[j, 1], u, v)
        along, across = gradient(surface.lattice, np.uint64(at + line.part[j, 2]), np.uint64(line.part[j, 1] + 3), f, g)
        east += line.turn[j, 0] * along - line.turn[j, 1] * across
        north += line.turn[j, 1] * along + line.turn[j, 0] * across
    return east, north


@kernel
def wandered(foam: FoamSurface, t: int, away: tuple[float, float], r: float) -> tuple[float, float]:
    """Return the place (u, v) [cells] on a tile, ``r`` metres from under the sensor along a horizontal unit vector (east, north)."""
    scale, c, s = foam.grid[t, 0], foam.grid[t, 1], foam.grid[t, 2]
    u = foam.grid[t, 3] + r * scale * (c * away[0] + s * away[1])
    v = foam.grid[t, 4] + r * scale * (c * away[1] - s * away[0])
    for w in range(foam.wander.shape[1]):
        height = sine(foam.wander[t, w, 4] + r * (foam.wander[t, w, 2] * away[0] + foam.wander[t, w, 3] * away[1]))
        u += foam.wander[t, w, 0] * height
        v += foam.wander[t, w, 1] * height
    return u, v


@kernel
def foam_share(surface: Surface, level: int, line: SurfaceLine, away: tuple[float, float], r: float, width: float) -> float:
    """Return the share of foam ``r`` metres along a line of a level, a mean over a ``width`` [m]; ``away``: the line's unit vector."""
    foam = surface.foam
    total = foam.even
    for t in range(foam.tile.shape[0]):
        j = foam.row[level, t]
        if j >= 0:
            u, v = position(line, j, r)
            ratio = float(foam.tile[t, 1]) / float(line.part[j, 1])
            u, v = u * ratio, v * ratio
        else:
            u, v = wandered(foam, t, away, r)
        total += tile_share(foam, t, u, v, width * foam.grid[t, 0])
    if foam.ships.segments.shape[0] > 0:
        total = max(total, segments_share(foam.ships, foam.origin[0] + r * away[0], foam.origin[1] + r * away[1]))
    return with_holes(foam, min(total, 1.0), away, r, width)


@kernel
def address(line: SurfaceLine, j: int, first: float, readings: tuple[int, int], strip: Strip) -> int:
    """Compute fractions and cells over a level's part ``j`` of a strip's ``readings = (begin, end)``, up to the line's next knot.

    ``first`` [m]: origin of ``strip.arc``. Returns the number of the next reading. The addresses are computed apart from the readings, in
    numbers of 32 bits, of which the processor takes several at a time.
    """
    v, u = strip.fraction
    begin, end = readings
    r = first + strip.arc[begin]
    m = piece(line, j, r)
    knot = line.knot[j, 0] + (m + 1) / line.knot[j, 1] - first if m < line.part[j, 4] else math.inf
    if strip.arc[end - 1] >= knot:
        # the readings before the next knot: estimated from their mean distance, then corrected
        span = max(float(strip.arc[end - 1] - strip.arc[begin]), 1e-9)
        end = begin + 1 + int(max(knot - strip.arc[begin], 0.0) / span * (end - 1 - begin))
        while end > begin + 1 and strip.arc[end - 1] >= knot:
            end -= 1
        while strip.arc[end] < knot:
            end += 1
    start_u, start_v = line.start[j, m, 0] + first * line.step[j, m, 0], line.start[j, m, 1] + first * line.step[j, m, 1]
    cell_u, cell_v = math.floor(start_u), math.floor(start_v)
    size = line.part[j, 1]
    x, y = np.uint32(int(cell_u) & (size - 1)), np.uint32(int(cell_v) & (size - 1))
    offset_u, offset_v = np.int32((start_u - cell_u) * SUBCELLS + WHOLE_TURNS), np.int32((start_v - cell_v) * SUBCELLS + WHOLE_TURNS)
    move_u, move_v = np.float32(line.step[j, m, 0] * SUBCELLS), np.float32(line.step[j, m, 1] * SUBCELLS)
    last, row, bits, low = np.uint32(size - 1), np.uint32(size + 3), np.uint32(SUBCELL_BITS), np.uint32(SUBCELLS - 1)
    part = np.float32(1.0 / SUBCELLS)
    # unsigned: Numba tests every signed address for a negative value
    origin = np.uint64(begin)
    for n in range(end - begin):
        k = origin + np.uint64(n)
        along = strip.arc[k]
        at_u, at_v = np.uint32(offset_u + np.int32(along * move_u)), np.uint32(offset_v + np.int32(along * move_v))
        u[k], v[k] = np.float32(np.int32(at_u & low)) * part, np.float32(np.int32(at_v & low)) * part
        strip.cell[k] = (np.uint32(y + np.uint32(at_v >> bits)) & last) * row + (np.uint32(x + np.uint32(at_u >> bits)) & last)
    return end


@kernel
def stride(line: SurfaceLine, j: int, span: tuple[float, float, float], count: int) -> int:
    """Return the binary logarithm of the distance, in samples, of readings of a level's part ``j``: 0 to 4.

    ``span``: length of the strip's ``count`` samples and of its first and last step [m]; a strip that is not full, or of uneven steps, is
    read at every sample.
    """
    # ``moved``: readings that the strip needs; with STRIP / 2**bits readings there must be at least as many
    u, v = line.step[j, 0, 0], line.step[j, 0, 1]
    moved = span[0] * math.sqrt(u * u + v * v) * READS_PER_CELL
    if count < STRIP or 2.0 * moved > STRIP or max(span[1], span[2]) > EVEN_STEPS * min(span[1], span[2]):
        return 0
    if 4.0 * moved > STRIP:
        return 1
    if 8.0 * moved > STRIP:
        return 2
    return 3 if 16.0 * moved > STRIP else 4


@kernel
def add_between(strip: Strip, bits: int) -> None:
    """Add heights of every ``2**bits``-th sample to the heights of the strip, cubic between them; fast where ``bits`` is a constant.

    Between two readings, the two parabolas through three readings are mixed (Catmull and Rom): exact to the third order in the distance of
    readings.
    """
    apart, half = 1 << bits, np.float32(0.5)
    part = np.float32(1.0 / apart)
    before, low, high = strip.read[0], strip.read[1], strip.read[2]
    for m in range(STRIP >> bits):
        beyond = strip.read[np.uint64(m + 3)]
        rise, next_rise, step = half * (high - before), half * (beyond - low), high - low
        bend, twist = step + step + step - rise - rise - next_rise, rise + next_rise - step - step
        for k in range(apart):
            t = np.float32(k) * part
            strip.height[np.uint64(m * apart + k)] += low + t * (rise + t * (bend + t * twist))
        before, low, high = low, high, beyond


@kernel
def add_heights(surface: Surface, line: SurfaceLine, j: int, range_m: np.ndarray, first: int, count: int, strip: Strip) -> None:
    """Add the heights of a level's part ``j`` at ``count`` samples of a line, from ``range_m[first]`` on, to the heights of the strip [m].

    Equal to ``height``, to a ``SUBCELLS``-th of a cell, for strips of up to ``LONGEST_STRIP`` cells; cubic between the samples that
    are read (``stride``).
    """
    at, begin = np.uint64(first), range_m[first]
    last = range_m[first + count - 1] - begin
    head, tail = 0.0, 0.0
    if count > 1:
        head, tail = range_m[first + 1] - begin, last - (range_m[first + count - 2] - begin)
    bits = stride(line, j, (last, head, tail), count)
    if bits == 0:
        for k in range(count):
            strip.arc[np.uint64(k)] = range_m[at + np.uint64(k)] - begin
        read_heights(surface, line, j, begin, count, strip)
        for k in range(count):
            strip.height[np.uint64(k)] += strip.read[np.uint64(k)]
        return
    # a cubic needs one reading before the strip and two beyond it: the first and the last step continue there
    apart, inside = 1 << bits, STRIP >> bits
    strip.arc[0] = -head * apart
    for m in range(inside):
        strip.arc[np.uint64(m + 1)] = range_m[at + (np.uint64(m) << np.uint64(bits))] - begin
    strip.arc[inside + 1], strip.arc[inside + 2] = last + tail, last + tail * (1 + apart)
    read_heights(surface, line, j, begin, inside + 3, strip)
    # constants in place of ``bits``: each call is compiled with a fixed length of its inner loop
    if bits == 1:
        add_between(strip, 1)
    elif bits == 2:
        add_between(strip, 2)
    elif bits == 3:
        add_between(strip, 3)
    else:
        add_between(strip, 4)


@kernel
def read_heights(surface: Surface, line: SurfaceLine, j: int, first: float, count: int, strip: Strip) -> None:
    """Read the heights of a level's part ``j`` at ``count`` arcs of ``strip.arc``, counted from ``first`` [m], into ``strip.read``."""
    v, u = strip.fraction
    done = 0
    while done < count:
        done = address(line, j, first, (done, count), strip)
    z, origin, row, one = surface.lattice, np.uint64(line.part[j, 0]), np.uint64(line.part[j, 1] + 3), np.uint64(1)
    if line.part[j, 3] == 0:
        for n in range(count):
            k = np.uint64(n)
            at = origin + np.uint64(strip.cell[k])
            a, b = z[at], z[at + one]
            c, d = z[at + row], z[at + row + one]
            near, far = a + u[k] * (b - a), c + u[k] * (d - c)
            strip.read[k] = near + v[k] * (far - near)
        return
    for n in range(count):
        k = np.uint64(n)
        strip.read[k] = spline_value(z, origin + np.uint64(strip.cell[k]), row, u[k], v[k])


def steepest_rise(lattices: tuple[NDArray[np.float32], ...], spacing: FloatArray) -> float:
    """Return a bound of the slope [1] of a sea from lattices of a ``spacing`` [m], whose heights add up.

    Neither a cubic B-spline nor a linear one is steeper than the steepest line between two neighbouring points.
    """
    rise = 0.0
    for lattice, d in zip(lattices, spacing, strict=True):
        z = lattice[..., 0]
        rise += math.hypot(*(float(np.abs(z - np.roll(z, 1, axis)).max()) / float(d) for axis in (0, 1)))
    return rise


@kernel
def sun_over_waves(
    surface: Surface, level: int, line: SurfaceLine, sunward: SurfaceLine, r: float, march: tuple[float, float], sun: Sunlight
) -> tuple[float, float]:
    """Return the share of the solar disc visible from the sea ``r`` metres along a line, over the waves of a level in front of the Sun.

    The second value is the height of the middle of the visible part above the middle of the disc [rad].

    The skyline is searched in the azimuth of the Sun, in steps of ``march[0]`` [m], or larger ones where a sea that rises by ``march[1]``
    at most cannot reach the ray before. The search ends where the highest crest would not reach above the lower limb; the drop of the
    round sea over that distance is neglected. Tiles have the displacement of the beginning all along.
    """
    step, rise = march
    tiles = line.part.shape[0]
    own = height(surface, line, 0, tiles, r)
    # the floor bounds the number of steps where the lower limb is at or below the horizontal
    low = max(sun.lower_tangent, 1e-4)
    steps = min((surface.crest[level, 0] - own) / (low * step), float(FARTHEST))
    # most waves that shade a place are near it: the first step is divided into 1/4, 1/2 and 1
    skyline, n = -1.0, 0.25
    while n <= steps:
        d, z = n * step, 0.0
        for j in range(tiles):
            u, v = position(line, j, r)
            u, v = u + d * sunward.step[j, 0, 0], v + d * sunward.step[j, 0, 1]
            z += point_height(surface, line, j, u, v)
        skyline = max(skyline, (z - own) / d)
        if skyline >= sun.upper_tangent:
            return 0.0, 0.0
        # the sea cannot rise to the ray before it has made up for the gap
        ray = max(low, skyline)
        n = max(2.0 * n if n < 1.0 else n + 1.0, math.floor(n + (own + d * ray - z) / (max(rise - ray, 1e-6) * step)))
    if skyline <= low:
        return 1.0, 0.0
    return visible_part_kernel(math.asin(sun.up) - math.atan(skyline))
