"""Sums over samples of bodies and plumes, written out sample by sample with NumPy: places, what hides, what shades, light, pixels."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.objects.drawing.crests import STEEP, Crests, calm
from seaglint.objects.drawing.eye import Grid, Lens
from seaglint.objects.drawing.light import Arriving
from seaglint.objects.drawing.raster import Samples, SunMap, sun_map
from seaglint.objects.drawing.sample_sums import (
    ACROSS,
    COUNTED,
    COVER,
    DISTANCE,
    DOWN,
    DRY,
    DRY_INSIDE,
    DRY_SEEN,
    EMITTED,
    MIRRORED,
    PATH,
    PLANES,
    SEEN,
    SUMS,
    SUN,
    WHOLE,
    BodySurroundings,
    SensorMesh,
    Window,
    clear_to,
    shade_gas,
    shade_solid,
)

pytestmark = pytest.mark.kernel

EYE = 25.0


class Scene(NamedTuple):
    """Arguments of the shaders."""

    grid: Grid
    lens: Lens
    window: Window
    samples: Samples
    shape: SensorMesh
    scene: BodySurroundings
    light: Arriving
    shadow: SunMap
    plume: np.ndarray


def gas(rng: np.random.Generator, centre: np.ndarray, size: float, longest: float) -> np.ndarray:
    """Plume of semi-axes of some ``size`` [m], turned at random; shares of its chords are of ``longest`` [m] where that is above 0."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0] / (size * rng.uniform(0.5, 1.5, 3))[:, None]
    return np.concatenate([turn @ centre, turn.ravel(), [longest]])


def crested(rng: np.random.Generator, azimuth: float) -> Crests:
    """Rough sea along five lines about an azimuth."""
    tangent, height = rng.uniform(-0.05, 0.04, (5, 7)), rng.uniform(-40.0, 3.0, (5, 7))
    mean = calm(EYE)
    arcs = np.linspace(300.0, 2500.0, 7) + rng.uniform(-50.0, 50.0, 7)
    return Crests(azimuth - 0.3, 6.0, arcs, tangent, height, mean.horizon, (float(height.max()), float(tangent.max())))


def scene(seed: int, *, plane: bool, waves: bool, circle: int, longest: float = 0.0) -> Scene:
    """Everything drawn at random, so that each rule is met by some samples."""
    rng = np.random.default_rng(seed)
    grid = Grid((3, 1), (3, 3), (8, 5), (25, 6), (21, 13))
    lens = Lens(np.eye(3), plane, (-0.31, 0.11), (0.21, -0.09), 0.11 * 0.09)
    columns = (1, 4) if circle else (3, 5)
    window = Window(columns, (1, 3), circle, (columns[0], columns[1] - 1, 1, 3))  # the last column is beyond the picture
    shape = (grid.size[1], grid.size[0])
    x, y = rng.uniform(-0.3, 0.3, shape), rng.uniform(-0.06, 0.03, shape)
    near = 1.0 / np.exp(rng.uniform(math.log(300.0), math.log(3000.0), shape))
    near[rng.random(shape) < 0.1] = 0.0
    far = rng.random(shape) < 0.1
    near[far], y[far] = 1.0 / 60_000.0, rng.uniform(-0.005, 0.005, far.sum())  # some of them behind the horizon
    triangle = ((np.arange(shape[1]) + grid.begin[0]) // 3 % 4 + np.zeros((shape[0], 1), np.int32)).astype(np.int32)
    samples = Samples(x, y, near, triangle, np.where(rng.random(shape) < 0.1, 0.0, rng.random(shape)))
    vertex = rng.normal(size=(7, 3)) * (600.0, 1000.0, 300.0)
    corner = np.array([[0, 1, 2], [2, 3, 4], [4, 5, 6], [6, 1, 3]], np.int32)
    mesh = SensorMesh(vertex, corner, rng.uniform(-0.2, 2.4, 7), np.array([0.3, 1.0, 0.6, 0.9, 0.5, 1.0, 0.2]))
    azimuth = 0.7
    s, c = math.sin(azimuth), math.cos(azimuth)
    axes = np.array([[c, -s, 0.0], [-0.02 * s, -0.02 * c, 1.0], [s, c, 0.02]])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    gases = np.array([gas(rng, 200.0 * axes[2] + 20.0 * axes[0], 60.0, 0.0), gas(rng, 900.0 * axes[2], 300.0, 900.0)])
    covers = np.sort(rng.uniform(0.0, 0.6, (2, 7)))
    covers[:, 0] = 0.0
    others = np.where(rng.random(shape) < 0.3, 1.0 / rng.uniform(300.0, 1500.0, shape), 0.0)
    sea = crested(rng, azimuth) if waves else calm(EYE)
    # the first gas and, for plumes, the depths of another solid are the body's own; the waterline cuts the samples
    normal = np.array([0.1, -0.05, 0.99])
    points = (np.stack([x, y, np.ones(shape)], axis=-1) / np.where(near > 0.0, near, np.inf)[..., None]) @ axes
    water = np.append(normal, np.median(points @ normal) + 0.01)
    own = np.where(rng.random(shape) < 0.3, 1.0 / rng.uniform(300.0, 1500.0, shape), 0.0)
    around = BodySurroundings(EYE, sea, others, gases, covers, axes, (azimuth, s, c), water, own, 1)
    corners = np.array([400.0, 1.0 / 1800.0, -30.0, 1.0 / 50.0])
    light = Arriving(corners, *(rng.random(size) for size in ((2, 4, 3), (2, 4, 13, 9), (2, 4), (2, 4), 3, 5)))
    sun = np.array([0.5, -0.3, 0.8]) / math.sqrt(0.98)
    across = np.linalg.svd(sun[None])[2][1:]
    shadow = SunMap(sun, across, np.array([-500.0, -300.0, 0.002, 0.003]), rng.uniform(-1000.0, 3000.0, (3, 4)), 300.0)
    return Scene(grid, lens, window, samples, mesh, around, light, shadow, gas(rng, 800.0 * axes[2], 200.0, longest))


def place(one: Scene, x: float, y: float, depth: float) -> tuple[np.ndarray, float, float]:
    """Point in the sensor's axes [m], its arc and its height: of a sphere's centre."""
    point = depth * (one.scene.axes.T @ (x, y, 1.0))
    level, over = math.hypot(point[0], point[1]), EFFECTIVE_EARTH_RADIUS + EYE + point[2]
    return point, EFFECTIVE_EARTH_RADIUS * math.atan2(level, over), math.hypot(level, over) - EFFECTIVE_EARTH_RADIUS


def clear(one: Scene, direction: np.ndarray, last: float) -> float:
    """Transmittance of the gases."""
    pairs = zip(one.scene.gases, one.scene.covers, strict=True)
    return math.prod(1.0 - along(share(plume, direction, last), cover) for plume, cover in pairs)


def along(part: float, table: np.ndarray) -> float:
    """Value for a share of the longest chord in a table that is even in its root."""
    return float(np.interp(math.sqrt(part), np.linspace(0.0, 1.0, table.size), table))


def share(plume: np.ndarray, direction: np.ndarray, last: float) -> float:
    """Share of the longest chord up to a distance, from where a line enters and leaves an ellipsoid."""
    along = plume[3:12].reshape(3, 3) @ direction
    roots = np.roots([along @ along, -2.0 * along @ plume[:3], plume[:3] @ plume[:3] - 1.0])
    if np.iscomplex(roots).any():
        return 0.0
    inside = np.clip(np.sort(roots.real), 0.0, last)
    longest = plume[12] if plume[12] > 0.0 else 2.0 / np.linalg.norm(along)
    return float((inside[1] - inside[0]) / longest)


chords = share


def visible(one: Scene, point: np.ndarray, arc: float, height: float) -> bool:
    """Whether the sea leaves a point in view."""
    sea, tangent = one.scene.crests, point[2] / math.hypot(point[0], point[1])
    if sea.tangent.size == 0:
        return height >= 0.0 and (arc <= sea.horizon[0] or tangent >= sea.horizon[1])
    lines = np.arange(len(sea.tangent))
    at = (np.clip((math.atan2(point[0], point[1]) - sea.azimuth) * sea.per_radian, 0, lines[-1]), np.clip(arc, sea.arc[0], sea.arc[-1]))
    low, before = (RegularGridInterpolator((lines, sea.arc), table)(at).item() for table in (sea.height, sea.tangent))
    return height >= low and (tangent < -STEEP or tangent >= before)


def solid_angle(one: Scene, i: int, j: int) -> float:
    """Solid angle of a cell, as the shaders have it: at the middle of the row, and at the cell's in a plane image."""
    column, row = (one.grid.begin[0] + i + 0.5) / one.grid.cells[0], (one.grid.begin[1] + j + 0.5) / one.grid.cells[1]
    a, b = one.lens.across[0] + one.lens.across[1] * column, one.lens.down[0] + one.lens.down[1] * row
    cell = one.lens.pixel / one.grid.cells[0] / one.grid.cells[1]
    return float(cell * (np.linalg.norm([a, b, 1.0]) ** -3 if one.lens.plane else math.cos(b)))


def pixel(one: Scene, i: int, j: int) -> tuple[int, int] | None:
    """Row and column of a cell in the planes, None outside the window."""
    column, row = math.floor((one.grid.begin[0] + i) / one.grid.cells[0]), math.floor((one.grid.begin[1] + j) / one.grid.cells[1])
    at = column % one.window.circle if one.window.circle else column
    if at not in range(*one.window.columns) or row not in range(*one.window.rows):
        return None
    return row - one.grid.first[1], column - one.grid.first[0]


def framed(one: Scene, where: tuple[int, int] | None) -> bool:
    """Whether a cell of the planes is in the picture."""
    if where is None:
        return False
    column = where[1] + one.grid.first[0]
    left, right, top, bottom = one.window.frame
    return (column % one.window.circle if one.window.circle else column) in range(left, right) and top <= where[0] + one.grid.first[
        1
    ] < bottom


def mixed(one: Scene, four: np.ndarray, arc: float, height: float) -> np.ndarray:
    """Values between the four corners of the body's range and height."""
    c = one.light.corner
    u, w = np.clip([(arc - c[0]) * c[1], (height - c[2]) * c[3]], 0.0, 1.0)
    return np.tensordot(np.outer([1.0 - w, w], [1.0 - u, u]).ravel(), four, axes=1)


def facet(one: Scene, t: int, at: tuple[np.ndarray, float, float], kind: int) -> tuple[float, float, float, float]:
    """Emissivity of a triangle at a point, its emission, reflected diffuse light and Sun, of white surfaces; as radiance (0) or counted."""
    a, b, c = one.shape.vertex[one.shape.corner[t]]
    g, h = np.linalg.lstsq(np.stack([b - a, c - a], axis=1), at[0] - a, rcond=None)[0]
    g = np.clip(g, 0.0, 1.0)
    h = np.clip(h, 0.0, 1.0 - g)
    share = np.array([1.0 - g - h, g, h])
    emissivity, kelvin = share @ one.shape.emissivity[one.shape.corner[t]], share @ one.shape.kelvin[one.shape.corner[t]]
    warm = np.interp(kelvin, range(3), mixed(one, one.light.emitted[kind], *at[1:]))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal)
    turn = abs(np.angle(complex(*normal[:2]) / complex(*one.shadow.sun[:2])))
    table = mixed(one, one.light.mirrored[kind], *at[1:])
    diffuse = RegularGridInterpolator((np.linspace(-1.0, 1.0, 13), np.linspace(0.0, math.pi, 9)), table)((normal[2], turn))[()]
    return emissivity, warm, float(diffuse), max(normal @ one.shadow.sun, 0.0) * mixed(one, one.light.sun[kind], *at[1:])


def lit(one: Scene, point: np.ndarray) -> bool:
    """Whether the shadow map leaves a point in the Sun."""
    cell = (one.shadow.across @ point - one.shadow.first[:2]) * one.shadow.first[2:]
    rows, columns = one.shadow.nearest.shape
    i, j = (math.trunc(x) for x in cell)
    if not (0 <= i < columns and 0 <= j < rows):
        return True
    return bool(one.shadow.nearest[j, i] <= one.shadow.sun @ point + one.shadow.lift)


SCENES = [(1, True, False, 0), (2, False, True, 4), (3, True, True, 0), (4, False, False, 4)]


@pytest.mark.parametrize(("seed", "plane", "waves", "circle"), SCENES)
def test_a_solid_is_the_sum_over_its_samples(seed, plane, waves, circle):
    """A facet's light in a pixel's row is that of its first sample in view."""
    one = scene(seed, plane=plane, waves=waves, circle=circle)
    planes, sums = np.zeros((PLANES, 3, 3)), np.zeros((SUMS, 3))
    shade_solid(*one[:8], (planes, sums))
    expected, total = np.zeros((PLANES, 3, 3)), np.zeros((SUMS, 3))
    hidden = dark = 0
    seen_dry = {True: 0, False: 0}
    first: dict[tuple, list] = {}
    for j, i in np.ndindex(one.samples.near.shape):
        near, share = one.samples.near[j, i], one.samples.share[j, i]
        if near == 0.0 or share == 0.0:
            continue
        solid, line = solid_angle(one, i, j) * share, (one.grid.begin[1] + j) // 5 - one.grid.first[1]
        total[WHOLE, line] += solid
        at = place(one, one.samples.x[j, i], one.samples.y[j, i], 1.0 / near)
        where, distance = pixel(one, i, j), float(np.linalg.norm(at[0]))
        dry = at[0] @ one.scene.water[:3] > one.scene.water[3]
        bare = np.interp(math.sqrt(chords(one.scene.gases[0], at[0] / distance, distance)), np.linspace(0.0, 1.0, 7), one.scene.covers[0])
        left = dry * solid * (1.0 - float(bare))
        total[DRY, line] += left
        total[DRY_INSIDE, line] += left * framed(one, where)
        if where is None or one.scene.others[j, i] > near:
            continue
        if not visible(one, *at):
            hidden += 1
            continue
        through = clear(one, at[0] / distance, distance)
        t = one.samples.triangle[j, i]
        both = first.setdefault((j, *where, t), [(*facet(one, t, at, q), mixed(one, one.light.path[q], *at[1:])) for q in (0, 1)])
        emissivity, warm, diffuse, sun, path = both[0]
        shines = lit(one, at[0])
        dark += not shines
        part = share * through / 40.0
        entered = {COVER: 1.0, PATH: path, EMITTED: emissivity * warm, MIRRORED: (1.0 - emissivity) * diffuse, DISTANCE: distance}
        _, counted_warm, counted_diffuse, counted_sun, counted_path = both[1]
        counted = counted_path + emissivity * counted_warm + (1.0 - emissivity) * (counted_diffuse + shines * counted_sun)
        for name, value in (entered | {SUN: shines * (1.0 - emissivity) * sun, COUNTED: counted}).items():
            expected[name][where] += part * value
        if not framed(one, where):
            continue
        total[SEEN, line] += solid * through
        total[DRY_SEEN, line] += dry * solid * through
        seen_dry[bool(dry)] += 1
        total[ACROSS, line] += solid * through * (one.grid.begin[0] + i + 0.5) / 8.0
        total[DOWN, line] += solid * through * (one.grid.begin[1] + j + 0.5) / 5.0
    assert min(hidden, dark, *seen_dry.values()) > 3
    np.testing.assert_allclose(planes, expected, rtol=1e-8)
    np.testing.assert_allclose(sums, total, rtol=1e-10)


@pytest.mark.parametrize("longest", [0.0, 650.0])
@pytest.mark.parametrize(("seed", "plane", "waves", "circle"), SCENES)
def test_a_plume_is_the_sum_over_its_samples(seed, plane, waves, circle, longest):
    """It is seen where the line of sight is nearest to its middle, in units of its semi-axes."""
    one = scene(seed, plane=plane, waves=waves, circle=circle, longest=longest)
    one.samples.x[0, ::5] = 1e9  # beside the camera
    light = one.light
    planes, sums = np.zeros((PLANES, 3, 3)), np.zeros((SUMS, 3))
    shade_gas(*one[:4], one.plume, one.scene, light, (planes, sums))
    expected, total = np.zeros((PLANES, 3, 3)), np.zeros((SUMS, 3))
    for j, i in np.ndindex(one.samples.x.shape):
        x, y = one.samples.x[j, i], one.samples.y[j, i]
        if x > 1e6:
            continue
        slant = math.sqrt(x * x + y * y + 1.0)
        direction = one.scene.axes.T @ (x, y, 1.0) / slant
        solid, line = solid_angle(one, i, j), (one.grid.begin[1] + j) // 5 - one.grid.first[1]
        if whole := share(one.plume, direction, np.inf):
            total[WHOLE, line] += solid * along(whole, light.cover)
        last = slant / one.scene.others[j, i] if one.scene.others[j, i] else np.inf
        where, inside = pixel(one, i, j), share(one.plume, direction, last)
        per_metre = one.plume[3:12].reshape(3, 3) @ direction
        distance = float(np.linalg.lstsq(per_metre[:, None], one.plume[:3], rcond=None)[0][0])
        at = place(one, x, y, distance / slant)
        dry = distance > 0.0 and at[0] @ one.scene.water[:3] > one.scene.water[3]
        before = slant / one.scene.own[j, i] if one.scene.own[j, i] else np.inf
        bare = share(one.scene.gases[0], direction, distance) if distance > 0.0 else 0.0
        left = (
            solid * dry * bool(whole) * along(share(one.plume, direction, before), light.cover) * (1.0 - along(bare, one.scene.covers[0]))
        )
        total[DRY, line] += left
        total[DRY_INSIDE, line] += left * framed(one, where)
        if where is None or inside == 0.0 or not visible(one, *at):
            continue
        through = clear(one, direction, distance)
        cover = along(inside, light.cover) * through
        glow = [through * along(inside, mixed(one, light.emitted[q], *at[1:])) for q in (0, 1)]
        path = [cover * mixed(one, light.path[q], *at[1:]) for q in (0, 1)]
        for name, value in {COVER: cover, PATH: path[0], DISTANCE: cover * distance, EMITTED: glow[0], COUNTED: path[1] + glow[1]}.items():
            expected[name][where] += value / 40.0
        if not framed(one, where):
            continue
        total[SEEN, line] += solid * cover
        total[DRY_SEEN, line] += dry * solid * cover
        total[ACROSS, line] += solid * cover * (one.grid.begin[0] + i + 0.5) / 8.0
        total[DOWN, line] += solid * cover * (one.grid.begin[1] + j + 0.5) / 5.0
    assert (expected[COVER] > 0.0).sum() >= 4
    np.testing.assert_allclose(planes, expected, rtol=1e-8)
    np.testing.assert_allclose(sums, total, rtol=1e-10)


def test_a_point_is_as_clear_as_the_gas_before_it_unless_something_hides_it():
    one = scene(5, plane=True, waves=False, circle=0)
    ahead = one.scene._replace(others=np.full((1, 1), 1.0 / 700.0))
    point, *sea = place(one, 0.0, 0.0, 650.0)
    assert visible(one, point, *sea)
    assert clear_to(ahead, 650.0) == pytest.approx(clear(one, point / 650.0, 650.0), rel=1e-12)
    assert 0.0 < clear_to(ahead, 650.0) < 0.9
    assert clear_to(ahead, 710.0) == 0.0
    assert clear_to(ahead._replace(axes=-ahead.axes), 2000.0) == 0.0  # under the sea


def test_a_shadow_map_holds_the_nearest_surface_that_faces_away():
    """Triangles by their plane and the signs of three areas, at the middle of every cell."""
    rng = np.random.default_rng(6)
    vertex, corner = rng.normal(size=(30, 3)), rng.permutation(30).reshape(10, 3).astype(np.int32)
    sun = np.array([0.48, 0.6, 0.64])
    across = np.linalg.svd(sun[None])[2][1:]
    found = sun_map(vertex, corner, (sun, across), 40, 0.25)
    flat = vertex @ across.T
    low, size = flat.min(axis=0), np.ptp(flat, axis=0)
    np.testing.assert_allclose(found.first, [*low, *40.0 / size], rtol=1e-12)
    i, j = np.meshgrid(np.arange(40) + 0.5, np.arange(40) + 0.5)
    middle = low + np.stack([i, j], axis=-1) / 40.0 * size
    nearest = np.full((40, 40), -np.inf)
    for three in corner:
        a, b, c = flat[three]
        areas = np.stack([np.cross(p - middle, q - middle) for p, q in ((b, c), (c, a), (a, b))])
        if np.cross(b - a, c - a) < 0.0:
            along = np.tensordot(vertex[three] @ sun, areas, axes=1) / np.cross(b - a, c - a)
            nearest = np.where((areas <= 0.0).all(axis=0), np.maximum(nearest, along), nearest)
    assert 0.2 < np.isfinite(nearest).mean() < 0.95
    np.testing.assert_allclose(found.nearest, nearest, rtol=1e-9, atol=1e-12)
    assert found.lift == 0.25
    assert np.array_equal(found.sun, sun)
