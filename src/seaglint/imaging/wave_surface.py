"""Cubic B-splines on periodic lattices: rows of their coefficients, and weights of the 16 points around a place.

What stands at the lattice points are coefficients, not heights: :meth:`seaglint.sea.wave_field.WaveField.coefficients` makes them.

Reading of the synthesised sea: splines on periodic lattices, at any level of detail, and bounds of its height.

A level of detail (:mod:`seaglint.sea.wave_field`) is a choice of lattices whose heights add up. A kernel that follows a horizontal line
makes a :func:`course` of it once: where it starts on every lattice of the level and how it moves over it.

Most samples of a grazing line are hidden. A line is read in strips, lattice by lattice, longest waves first, and a strip is left as soon as
the largest heights that the other lattices hold cannot bring it into view.

Shadows of waves under a low Sun: the share of the solar disc that a point of the resolved sea sees over the crests towards it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.air.sun_and_sky import visible_part_kernel
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel, njit
from seaglint.facet.sunlight import Sunlight
from seaglint.sea.tiles import Wander


@kernel
def lay_rows(lattice: np.ndarray, k: int, rows: np.ndarray) -> None:
    """Lay the numbers ``k`` of a periodic lattice (n, n, 1 or 2) out in rows of n + 3 points.

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
    """Weights of the four points around a place on a cubic B-spline, ``f`` cells beyond the second of them."""
    one, sixth = np.float32(1.0), np.float32(1.0 / 6.0)
    e = one - f
    first, last = e * e * e * sixth, f * f * f * sixth
    second = f * f * (np.float32(0.5) * f - one) + np.float32(2.0 / 3.0)
    return first, second, one - first - second - last, last


@kernel
def slope_weights(f: np.float32) -> tuple[np.float32, np.float32, np.float32, np.float32]:
    """Derivatives of the :func:`spline_weights` [1/cell]."""
    half = np.float32(0.5)
    e = np.float32(1.0) - f
    first, last = -half * e * e, half * f * f
    second = f * (np.float32(1.5) * f - np.float32(2.0))
    return first, second, -first - second - last, last


@kernel
def cell(size: int, u: float, v: float) -> tuple[int, np.float32, np.float32]:
    """Address of the cell of a lattice position, and the fractions (v, u) within it. The lattice ``size`` is a power of two."""
    lower_u, lower_v = math.floor(u), math.floor(v)
    return (int(lower_v) & (size - 1)) * (size + 3) + (int(lower_u) & (size - 1)), np.float32(v - lower_v), np.float32(u - lower_u)


@kernel
def spline_value(z: np.ndarray, at: np.uint64, row: np.uint64, f: np.float32, g: np.float32) -> np.float32:
    """Cubic B-spline ``f`` along u and ``g`` along v into a cell, whose first point of 16 is at ``at``, with ``row`` points a row."""
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
    """Derivatives along u and v [m/cell] of a cubic B-spline; arguments as of :func:`spline_value`."""
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


class Surface(NamedTuple):
    """Sea of one instant as kernels read it.

    ``lattice`` is all lattices one after another, row by row (:func:`seaglint.imaging.wave_surface.lay_rows`). ``part[i] = (address of the
    heights, points along a side, address of the spline, 1 where the heights are read from that spline and 0 where linearly)``; see
    :func:`point_height` and :func:`slopes`. ``grid[i] = (1/spacing, cos, sin of the lattice's turn, u, v under the sensor)``. ``level[l]``:
    parts of the level, -1 where there are no more; ``crest[l, j]``: largest height that its parts from ``j`` on add [m]. ``wander[i, w] =
    (u, v, east, north, phase)``: amplitude [cells], wave vector [cycles/m] and phase under the sensor [cycles] of the waves that make up a
    part's displacement (:mod:`seaglint.sea.tiles`); none where tiles lie still.
    """

    lattice: np.ndarray
    part: np.ndarray
    grid: np.ndarray
    level: np.ndarray
    crest: np.ndarray
    wander: np.ndarray


class Bounds(NamedTuple):
    """Bounds for the steps of rays: of the sea's height [m] and slope [1], and the finest spacing of its lattices [m]."""

    crest: float
    steepest: float
    spacing: float


class SurfaceLine(NamedTuple):
    """Horizontal line over the lattices of one level, straight between the knots at which the displacement of a part is known.

    ``start[j, m] + r step[j, m]``: position (u, v) [cells] at ``r`` metres, between the knots ``m`` and ``m + 1``; ``part[j]`` as in
    :class:`Surface`, and the last ``m``; ``knot[j] = (arc of the first knot [m], knots per metre)``; ``turn[j] = (cos, sin)`` of a part's
    turn over its spacing [1/m].
    """

    start: np.ndarray
    step: np.ndarray
    part: np.ndarray
    knot: np.ndarray
    turn: np.ndarray


class Strip(NamedTuple):
    """Buffers of up to :data:`STRIP` samples: their heights [m], and positions of those that are read.

    These are arcs from the strip's beginning and heights [m], fractions (v, u) of cells, and addresses of the cells in their lattice.
    """

    height: np.ndarray
    arc: np.ndarray
    read: np.ndarray
    fraction: tuple[np.ndarray, np.ndarray]
    cell: np.ndarray


@njit
def new_strip() -> Strip:
    """Empty strip."""
    fraction = (np.empty(STRIP, np.float32), np.empty(STRIP, np.float32))
    return Strip(
        np.empty(STRIP, np.float32), np.empty(STRIP, np.float32), np.empty(STRIP, np.float32), fraction, np.empty(STRIP, np.uint32)
    )


@kernel
def sine(cycles: float) -> float:
    """Sine of an angle in cycles, within 3e-7: a minimax polynomial times its zeros, which vectorises."""
    x = cycles - math.floor(cycles + 0.5)
    q = x * x
    return x * (1.0 - 4.0 * q) * (6.2831842 + q * (-16.2087243 + q * (16.7611333 + q * (-9.5276694 + q * 3.0445527))))


@kernel
def knots(surface: Surface, i: int, arcs: tuple[float, float]) -> tuple[int, float]:
    """Number of straight pieces of a line between two arcs [m] over a part, and pieces per metre; one where the part does not wander."""
    if surface.wander.shape[1] == 0 or arcs[1] <= arcs[0]:
        return 1, 0.0
    per_metre = KNOTS_PER_PERIOD * surface.grid[i, 0] / surface.part[i, 1]
    return int((arcs[1] - arcs[0]) * per_metre) + 1, per_metre


@kernel
def displace(surface: Surface, i: int, direction: tuple[float, float], arcs: tuple[float, float], at: np.ndarray) -> None:
    """Displacement of a part [cells] at the knots ``at[m]``, ``arcs = (first, distance of knots)`` [m], of a line under the sensor."""
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

    With one arc, twice, it is straight, and displaced all along as it is there.
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
        for m in range(pieces):
            bend_u, bend_v = (start[m + 1, 0] - start[m, 0]) * per_metre, (start[m + 1, 1] - start[m, 1]) * per_metre
            r = arcs[0] + m * between
            start[m, 0] += surface.grid[i, 3] - r * bend_u
            start[m, 1] += surface.grid[i, 4] - r * bend_v
            step[m, 0], step[m, 1] = step_u + bend_u, step_v + bend_v


@njit
def course(surface: Surface, level: int, east: float, north: float, arcs: tuple[float, float]) -> SurfaceLine:
    """Line from under the sensor along a horizontal unit vector; see :func:`lay_course`."""
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
    """Straight piece of a line over a level's part ``j``, ``r`` metres along; the first and the last continue beyond their ends."""
    return int(min(max(int((r - line.knot[j, 0]) * line.knot[j, 1]), 0), line.part[j, 4]))


@kernel
def position(line: SurfaceLine, j: int, r: float) -> tuple[float, float]:
    """Position (u, v) [cells] over a level's part ``j``, ``r`` metres along a line."""
    m = piece(line, j, r)
    return line.start[j, m, 0] + r * line.step[j, m, 0], line.start[j, m, 1] + r * line.step[j, m, 1]


@kernel
def point_height(surface: Surface, line: SurfaceLine, j: int, u: float, v: float) -> float:
    """Height of a level's part ``j`` [m] at a position [cells]: a cubic B-spline of the 16 points around it, or linear between four."""
    place, g, f = cell(line.part[j, 1], u, v)
    z, row, at, one = surface.lattice, np.uint64(line.part[j, 1] + 3), np.uint64(place + line.part[j, 0]), np.uint64(1)
    if line.part[j, 3] != 0:
        return float(spline_value(z, at, row, f, g))
    low, high = z[at] + f * (z[at + one] - z[at]), z[at + row] + f * (z[at + row + one] - z[at + row])
    return float(low + g * (high - low))


@kernel
def height(surface: Surface, line: SurfaceLine, first: int, last: int, r: float) -> float:
    """Height of a level's parts ``first`` to ``last`` (not included) together [m], ``r`` metres along a line."""
    total = 0.0
    for j in range(first, last):
        u, v = position(line, j, r)
        total += point_height(surface, line, j, u, v)
    return total


@kernel
def slopes(surface: Surface, line: SurfaceLine, r: float) -> tuple[float, float]:
    """Slopes of a level towards east and north [1], ``r`` metres along a line."""
    east, north = 0.0, 0.0
    for j in range(line.part.shape[0]):
        u, v = position(line, j, r)
        at, g, f = cell(line.part[j, 1], u, v)
        along, across = gradient(surface.lattice, np.uint64(at + line.part[j, 2]), np.uint64(line.part[j, 1] + 3), f, g)
        east += line.turn[j, 0] * along - line.turn[j, 1] * across
        north += line.turn[j, 1] * along + line.turn[j, 0] * across
    return east, north


@kernel
def address(line: SurfaceLine, j: int, first: float, some: tuple[int, int], strip: Strip) -> int:
    """Fractions and cells over a level's part ``j`` of the readings ``some = (begin, end)`` of a strip, as far as the line is straight.

    ``first`` [m]: where ``strip.arc`` counts from. Returns the reading to go on with. Apart from the reading, in numbers of 32 bits, which
    the processor takes several at a time.
    """
    v, u = strip.fraction
    begin, end = some
    r = first + strip.arc[begin]
    m = piece(line, j, r)
    knot = line.knot[j, 0] + (m + 1) / line.knot[j, 1] - first if m < line.part[j, 4] else math.inf
    if strip.arc[end - 1] >= knot:
        # the readings before the next knot: a guess from their mean distance, put right
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
    # unsigned, as an address that could be negative is looked at once more
    room = np.uint64(begin)
    for n in range(end - begin):
        k = room + np.uint64(n)
        along = strip.arc[k]
        at_u, at_v = np.uint32(offset_u + np.int32(along * move_u)), np.uint32(offset_v + np.int32(along * move_v))
        u[k], v[k] = np.float32(np.int32(at_u & low)) * part, np.float32(np.int32(at_v & low)) * part
        strip.cell[k] = (np.uint32(y + np.uint32(at_v >> bits)) & last) * row + (np.uint32(x + np.uint32(at_u >> bits)) & last)
    return end


@kernel
def stride(line: SurfaceLine, j: int, span: tuple[float, float, float], count: int) -> int:
    """Binary logarithm of the distance, in samples, of readings of a level's part ``j``: 0 to 4.

    ``span``: length of the strip's ``count`` samples and of its first and last step [m]; a strip that is not full, or of uneven steps, is
    read at every sample.
    """
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
    """Add heights known at every ``2**bits``-th sample to the strip's, between them cubic; fast where ``bits`` is a constant.

    The parabolas through three readings, of which two are mixed (Catmull and Rom): exact to the third order in the readings' distance.
    """
    apart, half = 1 << bits, np.float32(0.5)
    part = np.float32(1.0 / apart)
    before, low, high = strip.read[0], strip.read[1], strip.read[2]
    for m in range(STRIP >> bits):
        beyond = strip.read[np.uint64(m + 3)]
        rise, there, step = half * (high - before), half * (beyond - low), high - low
        bend, twist = step + step + step - rise - rise - there, rise + there - step - step
        for k in range(apart):
            t = np.float32(k) * part
            strip.height[np.uint64(m * apart + k)] += low + t * (rise + t * (bend + t * twist))
        before, low, high = low, high, beyond


@kernel
def add_heights(surface: Surface, line: SurfaceLine, j: int, range_m: np.ndarray, first: int, count: int, strip: Strip) -> None:
    """Add the heights of a level's part ``j`` at ``count`` samples of a line, those from ``range_m[first]`` on, to the strip's.

    As :func:`height`, to a ``SUBCELLS``-th of a cell, for strips of up to :data:`LONGEST_STRIP` cells; cubic between the samples that are
    read (:func:`stride`).
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
    # one reading before the strip and two beyond it, as steps go on there
    apart, inside = 1 << bits, STRIP >> bits
    strip.arc[0] = -head * apart
    for m in range(inside):
        strip.arc[np.uint64(m + 1)] = range_m[at + (np.uint64(m) << np.uint64(bits))] - begin
    strip.arc[inside + 1], strip.arc[inside + 2] = last + tail, last + tail * (1 + apart)
    read_heights(surface, line, j, begin, inside + 3, strip)
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
    """Heights of a level's part ``j`` at ``count`` arcs of ``strip.arc``, counted from ``first`` [m], into ``strip.read``."""
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
    """Bound of the slope [1] of a sea whose heights are read from lattices, ``spacing`` [m] apart, that add up.

    Neither a cubic B-spline nor a linear one is steeper than the steepest line between two neighbouring points.
    """
    rise = 0.0
    for lattice, d in zip(lattices, spacing, strict=True):
        z = lattice[..., 0]
        rise += math.hypot(*(float(np.abs(z - np.roll(z, 1, axis)).max()) / float(d) for axis in (0, 1)))
    return rise


def wander_rows(wander: tuple[Wander, ...], spacing: FloatArray, turn: FloatArray, origin: tuple[float, float]) -> FloatArray:
    """Rows :attr:`Surface.wander` for a sensor above ``origin`` [m]."""
    out = np.zeros((len(wander), max((w.phase.size for w in wander), default=0), 5))
    for rows, one, d, angle in zip(out, wander, spacing, turn, strict=False):
        row = rows[: one.phase.size]  # waves that a part lacks have no amplitude
        c, s = np.cos(angle), np.sin(angle)
        row[:, :2] = one.amplitude @ np.array([[c, -s], [s, c]]) / d
        row[:, 2:4] = one.wave_vector / (2.0 * np.pi)
        row[:, 4] = np.mod(row[:, 2:4] @ np.array(origin) + one.phase / (2.0 * np.pi), 1.0)
    return out


FARTHEST = 4000  #: Number of steps after which a Sun at the very horizon counts as visible.


@kernel
def sun_over_waves(
    surface: Surface, level: int, line: SurfaceLine, sunward: SurfaceLine, r: float, march: tuple[float, float], sun: Sunlight
) -> tuple[float, float]:
    """Share of the solar disc visible from the sea ``r`` metres along a line, over the waves of a level towards the Sun there.

    With it comes the height of that part's middle above the whole disc's [rad].

    The skyline is looked for in the Sun's own azimuth, in steps [m] of ``march[0]`` or as many as a sea that rises by ``march[1]`` at
    most allows, as far as the highest crest could reach over the lower limb; the round sea's drop over that distance is left out. Tiles are
    displaced on the whole way as where it begins.
    """
    step, rise = march
    tiles = line.part.shape[0]
    own = height(surface, line, 0, tiles, r)
    low = max(sun.lower_tangent, 1e-4)
    steps = min((surface.crest[level, 0] - own) / (low * step), float(FARTHEST))
    # most waves that shade a place are near it: the first step is taken in parts
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
