"""Shading of the samples of a body: their visibility, their radiance, and the sums in each pixel and row."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.jit import kernel, njit
from seaglint.imaging.sweep.walk import elevation
from seaglint.objects.drawing.crests import Crests, in_sight
from seaglint.objects.drawing.eye import Grid, Lens
from seaglint.objects.drawing.light import Arriving
from seaglint.objects.drawing.raster import Samples, SunMap, chord, in_semi_axes, lit

COVER: Final = 0  #: Plane of the share of a pixel that a body covers [1].

PATH: Final = 1  #: Plane of the radiance of the path times the share [W m-2 sr-1].
EMITTED: Final = 2  #: Plane of the body's emission times the share [W m-2 sr-1].
MIRRORED: Final = 3  #: Plane of the diffuse light that the body reflects, times the share [W m-2 sr-1].
SUN: Final = 4  #: Plane of the sunlight that the body reflects, times the share [W m-2 sr-1].

DISTANCE: Final = 5  #: Plane of the distance times the share [m].

COUNTED: Final = 6  #: Plane of the whole radiance times the share, each wavenumber weighted as the detector counts it [W m-2 sr-1].

PLANES: Final = 7  #: Number of planes.

WHOLE: Final = 0  #: Sum of the solid angle of all samples [sr].
SEEN: Final = 1  #: Sum of the solid angle of visible samples in the picture [sr].
ACROSS: Final = 2  #: Sum of the visible solid angle times column [sr pixels].
DOWN: Final = 3  #: Sum of the visible solid angle times row [sr pixels].

DRY: Final = 4  #: Sum of the solid angle above the waterline that no part of the same body hides [sr].
DRY_INSIDE: Final = 5  #: The part of ``DRY`` in the picture [sr].
DRY_SEEN: Final = 6  #: The part of ``DRY_INSIDE`` that nothing hides [sr].
SUMS: Final = 7  #: Number of sums.


class SensorMesh(NamedTuple):
    """Triangles of a body in the sensor's axes, with temperature and emissivity."""

    vertex: np.ndarray  #: Vertices [m, (n, 3)].
    corner: np.ndarray  #: Vertices of the triangles (m, 3).
    kelvin: np.ndarray  #: Index of the temperature of each vertex in ``seaglint.objects.drawing.light.Arriving.emitted`` (n,).
    emissivity: np.ndarray  #: Emissivity of each vertex [1, (n,)].


class BodySurroundings(NamedTuple):
    """Surroundings of a body: the sensor's height, the sea, other bodies and gases."""

    eye: float  #: Height of the sensor above the mean sea [m].
    crests: Crests  #: Sea in front of the body.
    others: np.ndarray  #: One over the depth of other solids at the samples [1/m, (rows, columns)]; 0 without a solid.
    gases: np.ndarray  #: Plumes in front, as in ``chord`` (gases, 13).
    covers: np.ndarray  #: Absorbed share along the chords of each plume (``seaglint.objects.drawing.light.Arriving.cover``).
    axes: np.ndarray  #: Axes of the tangent plane (3, 3).
    heading: tuple[float, float, float]  #: Azimuth of the body's centre [rad], with its sine and cosine.
    water: np.ndarray  #: Plane of the waterline (``seaglint.objects.drawing.eye.Stand.water``).
    own: np.ndarray  #: One over the depth of solids of the same body at the samples of its gas [1/m]; empty for a body without solids.
    own_gases: int  #: Number of plumes of the same body, the first in ``gases``.


class Window(NamedTuple):
    """Pixels to draw."""

    columns: tuple[int, int]  #: First and end column.
    rows: tuple[int, int]  #: First and end row.
    circle: int  #: Columns in a full circle, 0 for an image that is no full circle.
    frame: tuple[int, int, int, int]  #: First and end column and row of the picture; pixels beyond it are drawn for their blur alone.


@kernel
def _pixel(grid: Grid, window: Window, i: int, j: int) -> tuple[int, int, bool, bool]:
    """Return column and row of a cell's pixel, counted from the grid's first, and flags of pixels to draw and of pixels in the picture."""
    column, row = (grid.begin[0] + i) // grid.cells[0], (grid.begin[1] + j) // grid.cells[1]
    at = column % window.circle if window.circle > 0 else column
    drawn = window.columns[0] <= at < window.columns[1] and window.rows[0] <= row < window.rows[1]
    framed = drawn and window.frame[0] <= at < window.frame[1] and window.frame[2] <= row < window.frame[3]
    return column - grid.first[0], row - grid.first[1], drawn, framed


@kernel
def _row_solid_angle(lens: Lens, grid: Grid, j: int) -> float:
    """Return the solid angle of a cell in a row [sr], at its middle; for a plane image at the middle of the row."""
    cell = lens.pixel / (grid.cells[0] * grid.cells[1])
    if lens.plane:
        return float(cell)
    return float(cell * math.cos(lens.down[0] + lens.down[1] * (grid.begin[1] + j + 0.5) / grid.cells[1]))


@kernel
def _falling(lens: Lens, grid: Grid, j: int, i: int) -> float:
    """Return the ratio of a cell's solid angle to ``_row_solid_angle`` [1]; it decreases to the corners of a plane image."""
    if not lens.plane:
        return 1.0
    x = lens.across[0] + lens.across[1] * (grid.begin[0] + i + 0.5) / grid.cells[0]
    y = lens.down[0] + lens.down[1] * (grid.begin[1] + j + 0.5) / grid.cells[1]
    square = 1.0 + x * x + y * y
    return 1.0 / (square * math.sqrt(square))


@kernel
def place_of(x: float, y: float, depth: float, scene: BodySurroundings) -> tuple[float, float, float, float, float]:
    """Return the point of a sample in the sensor's axes [m] from its tangents and depth, its arc and its height above the mean sea [m]."""
    a = scene.axes
    east = depth * (x * a[0, 0] + y * a[1, 0] + a[2, 0])
    north = depth * (x * a[0, 1] + y * a[1, 1] + a[2, 1])
    up = depth * (x * a[0, 2] + y * a[1, 2] + a[2, 2])
    level = math.sqrt(east * east + north * north)
    over = EFFECTIVE_EARTH_RADIUS + scene.eye + up
    # sqrt(level^2 + over^2) - R' as a quotient: the difference of two radii would lose the digits of a height
    height = (level * level + (scene.eye + up) * (2.0 * EFFECTIVE_EARTH_RADIUS + scene.eye + up)) / (
        math.sqrt(level * level + over * over) + EFFECTIVE_EARTH_RADIUS
    )
    arc = EFFECTIVE_EARTH_RADIUS * (elevation(level / over) if over > level else math.atan2(level, over))
    return east, north, up, arc, height


@kernel
def _visible(scene: BodySurroundings, at: tuple[float, float, float, float, float]) -> bool:
    """Return True if the sea does not hide a point."""
    level = math.sqrt(at[0] * at[0] + at[1] * at[1])
    if at[4] > scene.crests.top[0] and at[2] > scene.crests.top[1] * level:
        return True
    azimuth, s, c = scene.heading
    turn = 0.0
    if scene.crests.tangent.shape[0] > 0:
        aside, ahead = at[0] * c - at[1] * s, at[0] * s + at[1] * c
        # the azimuth from the body's centre, by a fast series: only small angles occur
        turn = elevation(aside / ahead) if ahead > 0.0 else math.atan2(aside, ahead)
    return in_sight(scene.crests, azimuth + turn, at[3], at[4], at[2] / max(level, 1e-9))


@kernel
def _chord_node(share: float, count: int) -> tuple[int, float]:
    """Return the number of the tabulated chord below a share of the longest chord, and the fraction towards the next [1]."""
    # chords are even in the root of their share (``seaglint.objects.combustion_gas.chord_shares``)
    x = math.sqrt(share) * (count - 1)
    k = min(int(x), count - 2)
    return k, x - k


@kernel
def _clear(scene: BodySurroundings, direction: tuple[float, float, float], last: float, count: int) -> float:
    """Return the transmittance of the first ``count`` gases up to a distance [m] along a direction [1]."""
    through = 1.0
    for g in range(count):
        k, f = _chord_node(chord(scene.gases[g], direction, 0.0, last), scene.covers.shape[1])
        through *= 1.0 - (scene.covers[g, k] + f * (scene.covers[g, k + 1] - scene.covers[g, k]))
    return through


@kernel
def _dry(w: np.ndarray, at: tuple[float, float, float, float, float]) -> bool:
    """Return True if a point of a body is above the plane of its waterline."""
    return bool(w[0] * at[0] + w[1] * at[1] + w[2] * at[2] > w[3])


@njit
def clear_to(scene: BodySurroundings, distance: float) -> float:
    """Return the transmittance to a point at the centre of the plane through sea, bodies and gases, without the air [1]."""
    at = place_of(0.0, 0.0, distance, scene)
    if scene.others[0, 0] * distance > 1.0 or not _visible(scene, at):
        return 0.0
    return _clear(scene, (at[0] / distance, at[1] / distance, at[2] / distance), distance, scene.gases.shape[0])


@kernel
def _between(corner: np.ndarray, arc: float, height: float) -> tuple[float, float]:
    """Return the coordinates of a point between the corners of ``Arriving``, each in 0..1."""
    return (min(max((arc - corner[0]) * corner[1], 0.0), 1.0), min(max((height - corner[2]) * corner[3], 0.0), 1.0))


@kernel
def _mix(u: float, v: float, a: float, b: float, c: float, d: float) -> float:
    """Return the bilinear interpolation between four corners."""
    return float((1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * c + u * d))


@kernel
def _corners_mean(four: np.ndarray, kind: int, u: float, v: float) -> float:
    """Return the light of a kind (0 radiance, 1 counted) between the corners."""
    return _mix(u, v, four[kind, 0], four[kind, 1], four[kind, 2], four[kind, 3])


@kernel
def _glow(light: Arriving, kind: int, k: int, s: float, u: float, v: float) -> float:
    """Return the emission of a kind (0 radiance, 1 counted) between the corners, at the fraction ``s`` from value ``k`` to the next."""
    e = light.emitted
    glow = _mix(u, v, e[kind, 0, k], e[kind, 1, k], e[kind, 2, k], e[kind, 3, k])
    if s > 0.0:
        n = k + 1
        glow += s * (_mix(u, v, e[kind, 0, n], e[kind, 1, n], e[kind, 2, n], e[kind, 3, n]) - glow)
    return glow


@kernel
def _reflect(light: Arriving, shadow: SunMap, at: tuple[float, float], normal: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return diffuse light reflected by a white facet, as radiance and counted, between the corners, and its cosine to the Sun (or 0)."""
    # the table is even in the cosine of the normal from the zenith and in its azimuth from the Sun
    m = light.mirrored
    x = (normal[2] + 1.0) * 0.5 * (m.shape[2] - 1)
    i = min(max(int(x), 0), m.shape[2] - 2)
    f = x - i
    sun = shadow.sun
    across = math.sqrt(sun[0] * sun[0] + sun[1] * sun[1])
    level = math.sqrt(normal[0] * normal[0] + normal[1] * normal[1])
    turn = 0.0
    if across > 1e-9 and level > 1e-9:
        turn = math.acos(min(max((normal[0] * sun[0] + normal[1] * sun[1]) / (across * level), -1.0), 1.0))
    y = turn / math.pi * (m.shape[3] - 1)
    k = min(int(y), m.shape[3] - 2)
    g = y - k
    total = counted = 0.0
    for p in range(4):
        weight = (at[0] if p % 2 else 1.0 - at[0]) * (at[1] if p >= 2 else 1.0 - at[1])
        for q in range(2):
            low = m[q, p, i, k] + g * (m[q, p, i, k + 1] - m[q, p, i, k])
            high = m[q, p, i + 1, k] + g * (m[q, p, i + 1, k + 1] - m[q, p, i + 1, k])
            part = weight * (low + f * (high - low))
            if q == 0:
                total += part
            else:
                counted += part
    return total, counted, max(normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2], 0.0)


@kernel
def _facet(
    shape: SensorMesh, light: Arriving, shadow: SunMap, t: int, at: tuple[float, float, float, float, float]
) -> tuple[float, float, float, float, float, float]:
    """Return the light of a triangle at a point [W m-2 sr-1]: path, emission, reflected diffuse light, reflected Sun; counted: all without
    the Sun, and the Sun. Shading of the Sun is not included.
    """
    sun, path, v = light.sun, light.path, shape.vertex
    most = light.emitted.shape[2] - 1
    a, b, c = shape.corner[t, 0], shape.corner[t, 1], shape.corner[t, 2]
    ux, uy, uz = v[b, 0] - v[a, 0], v[b, 1] - v[a, 1], v[b, 2] - v[a, 2]
    wx, wy, wz = v[c, 0] - v[a, 0], v[c, 1] - v[a, 1], v[c, 2] - v[a, 2]
    nx, ny, nz = uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx
    # the normal is not normalised: square of twice the triangle's area
    size = nx * nx + ny * ny + nz * nz
    px, py, pz = at[0] - v[a, 0], at[1] - v[a, 1], at[2] - v[a, 2]
    # shares of the corners b and c
    g = ((py * wz - pz * wy) * nx + (pz * wx - px * wz) * ny + (px * wy - py * wx) * nz) / size
    h = ((uy * pz - uz * py) * nx + (uz * px - ux * pz) * ny + (ux * py - uy * px) * nz) / size
    # samples outside the outline take the values at the border of the triangle
    g = min(max(g, 0.0), 1.0)
    h = min(max(h, 0.0), 1.0 - g)
    f = 1.0 - g - h
    emissivity = f * shape.emissivity[a] + g * shape.emissivity[b] + h * shape.emissivity[c]
    kelvin = min(max(f * shape.kelvin[a] + g * shape.kelvin[b] + h * shape.kelvin[c], 0.0), float(most))
    k = min(int(kelvin), max(most - 1, 0))
    s = kelvin - k
    u, w = _between(light.corner, at[3], at[4])
    warm, warm_counted = emissivity * _glow(light, 0, k, s, u, w), emissivity * _glow(light, 1, k, s, u, w)
    diffuse = diffuse_counted = direct = direct_counted = 0.0
    if emissivity < 1.0:
        length = 1.0 / math.sqrt(size)
        diffuse, diffuse_counted, cosine = _reflect(light, shadow, (u, w), (nx * length, ny * length, nz * length))
        diffuse *= 1.0 - emissivity
        diffuse_counted *= 1.0 - emissivity
        if cosine > 0.0 and sun[0, 0] > 0.0:
            cosine *= 1.0 - emissivity
            direct = cosine * _corners_mean(sun, 0, u, w)
            direct_counted = cosine * _corners_mean(sun, 1, u, w)
    steady = _corners_mean(path, 1, u, w) + warm_counted + diffuse_counted
    return _corners_mean(path, 0, u, w), warm, diffuse, direct, steady, direct_counted


@kernel
def _enter(
    planes: np.ndarray, row: int, column: int, facet: tuple[float, float, float, float, float, float], parts: tuple[float, float, float]
) -> None:
    """Add a facet's contribution to the planes of a pixel: its share, the lit share, and distance times share."""
    if parts[0] > 0.0:
        planes[COVER, row, column] += parts[0]
        planes[PATH, row, column] += parts[0] * facet[0]
        planes[EMITTED, row, column] += parts[0] * facet[1]
        planes[MIRRORED, row, column] += parts[0] * facet[2]
        planes[SUN, row, column] += parts[1] * facet[3]
        planes[DISTANCE, row, column] += parts[2]
        planes[COUNTED, row, column] += parts[0] * facet[4] + parts[1] * facet[5]


@njit
def shade_solid(
    grid: Grid,
    lens: Lens,
    window: Window,
    samples: Samples,
    shape: SensorMesh,
    scene: BodySurroundings,
    light: Arriving,
    shadow: SunMap,
    out: tuple[np.ndarray, np.ndarray],
) -> None:
    """Add the samples of solids to the planes ``out[0]`` (``PLANES``, rows, columns) of the grid's pixels, and to the sums ``out[1]``
    (``SUMS``, rows) of their rows.
    """
    planes, sums = out
    share = 1.0 / (grid.cells[0] * grid.cells[1])
    # of the present facet in a pixel of a row: its light, and sums over its samples: their number, the number of lit ones, their distances
    facet = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    for j in range(grid.size[1]):
        row_solid = _row_solid_angle(lens, grid, j)
        last, before, above = -1, -1, 0
        parts = sunlit = far = 0.0
        whole = seen = across = dry = inside = dry_seen = 0.0
        line = (grid.begin[1] + j) // grid.cells[1] - grid.first[1]
        for i in range(grid.size[0]):
            near, clear = samples.near[j, i], samples.share[j, i]
            if near <= 0.0 or clear <= 0.0:
                continue
            solid = row_solid * _falling(lens, grid, j, i) * clear
            whole += solid
            column, row, drawn, framed = _pixel(grid, window, i, j)
            at = place_of(samples.x[j, i], samples.y[j, i], 1.0 / near, scene)
            distance = math.sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2])
            direction = (at[0] / distance, at[1] / distance, at[2] / distance)
            above_water = _dry(scene.water, at)
            if above_water:
                left = solid * _clear(scene, direction, distance, scene.own_gases)
                dry += left
                if framed:
                    inside += left
            if not drawn or scene.others[j, i] > near or not _visible(scene, at):
                continue
            if scene.gases.shape[0] > 0:
                through = _clear(scene, direction, distance, scene.gases.shape[0])
                clear, solid = clear * through, solid * through
            t = samples.triangle[j, i]
            if t != last or column != before:
                _enter(planes, above, before, facet, (share * parts, share * sunlit, share * far))
                parts = sunlit = far = 0.0
                last, before, above = t, column, row
                # neighbouring samples of a pixel on one facet have the same radiance
                facet = _facet(shape, light, shadow, t, at)
            parts += clear
            far += clear * distance
            if facet[3] > 0.0 and lit(shadow, (at[0], at[1], at[2])):
                sunlit += clear
            if framed:
                seen += solid
                across += solid * (grid.begin[0] + i + 0.5)
                if above_water:
                    dry_seen += solid
        _enter(planes, above, before, facet, (share * parts, share * sunlit, share * far))
        sums[WHOLE, line] += whole
        sums[SEEN, line] += seen
        sums[ACROSS, line] += across / grid.cells[0]
        sums[DOWN, line] += seen * (grid.begin[1] + j + 0.5) / grid.cells[1]
        sums[DRY, line] += dry
        sums[DRY_INSIDE, line] += inside
        sums[DRY_SEEN, line] += dry_seen


@njit
def shade_gas(
    grid: Grid,
    lens: Lens,
    window: Window,
    samples: Samples,
    plume: np.ndarray,
    scene: BodySurroundings,
    light: Arriving,
    out: tuple[np.ndarray, np.ndarray],
) -> None:
    """Add the samples of a plume (``chord``) to planes and sums; arguments as of ``shade_solid``.

    The coverage of a sample is the share of the light behind it that the plume absorbs, a mean over the band.
    """
    planes, sums = out
    share = 1.0 / (grid.cells[0] * grid.cells[1])
    covers, path = light.cover, light.path
    for j in range(grid.size[1]):
        row_solid = _row_solid_angle(lens, grid, j)
        for i in range(grid.size[0]):
            x, y = samples.x[j, i], samples.y[j, i]
            if abs(x) > 1e6:
                continue
            at = place_of(x, y, 1.0, scene)
            slant = math.sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2])
            direction = (at[0] / slant, at[1] / slant, at[2] / slant)
            whole = chord(plume, direction, 0.0, math.inf)
            if whole <= 0.0:
                continue
            solid = row_solid * _falling(lens, grid, j, i)
            k, f = _chord_node(whole, covers.size)
            line = (grid.begin[1] + j) // grid.cells[1] - grid.first[1]
            sums[WHOLE, line] += solid * (covers[k] + f * (covers[k + 1] - covers[k]))
            column, row, drawn, framed = _pixel(grid, window, i, j)
            # the place of a sample of gas is the middle of its chord
            ux, uy, uz = in_semi_axes(plume, direction)
            distance = (plume[0] * ux + plume[1] * uy + plume[2] * uz) / (ux * ux + uy * uy + uz * uz)
            if distance <= 0.0:
                continue
            at = place_of(x, y, distance / slant, scene)
            above_water = _dry(scene.water, at)
            if above_water:
                last = slant / scene.own[j, i] if scene.own.shape[0] > 0 and scene.own[j, i] > 0.0 else math.inf
                k, f = _chord_node(chord(plume, direction, 0.0, last), covers.size)
                left = solid * (covers[k] + f * (covers[k + 1] - covers[k])) * _clear(scene, direction, distance, scene.own_gases)
                sums[DRY, line] += left
                if framed:
                    sums[DRY_INSIDE, line] += left
            if not drawn:
                continue
            last = slant / scene.others[j, i] if scene.others[j, i] > 0.0 else math.inf
            inside = chord(plume, direction, 0.0, last)
            if inside <= 0.0 or not _visible(scene, at):
                continue
            through = _clear(scene, direction, distance, scene.gases.shape[0])
            k, f = _chord_node(inside, covers.size)
            cover = through * (covers[k] + f * (covers[k + 1] - covers[k]))
            u, w = _between(light.corner, at[3], at[4])
            part = share * cover
            planes[COVER, row, column] += part
            planes[PATH, row, column] += part * _corners_mean(path, 0, u, w)
            planes[EMITTED, row, column] += share * through * _glow(light, 0, k, f, u, w)
            planes[COUNTED, row, column] += part * _corners_mean(path, 1, u, w) + share * through * _glow(light, 1, k, f, u, w)
            planes[DISTANCE, row, column] += part * distance
            if framed:
                sums[SEEN, line] += solid * cover
                sums[ACROSS, line] += solid * cover * (grid.begin[0] + i + 0.5) / grid.cells[0]
                sums[DOWN, line] += solid * cover * (grid.begin[1] + j + 0.5) / grid.cells[1]
                if above_water:
                    sums[DRY_SEEN, line] += solid * cover
