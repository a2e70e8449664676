"""Drawing of bodies: each part is sampled on a separate grid and hidden by sea and bodies in front; solid angles of whole parts.

``Stage`` has a camera at an instant, ``Drawer`` draws bodies on it. ``solid_angles`` measures parts without a camera, inside
the picture or not.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numba
import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.camera.imager import Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.imaging.scene import Levels
from seaglint.imaging.wave_surface import Surface
from seaglint.objects.body import Body, GasPlume, PointSource
from seaglint.objects.combustion_gas import CHORDS, chord_shares
from seaglint.objects.drawing.crests import Crests, calm
from seaglint.objects.drawing.eye import FEWEST_CELLS, Grid, Lens, Stand, TangentPlane, grid_over, image_point, lens, project, stand
from seaglint.objects.drawing.launch_bodies import NOTHING, clear_to_point, part_planes, sampled_solid, sea_before, shadow_map
from seaglint.objects.drawing.light import Arriving, Corners, Counting, Surroundings
from seaglint.objects.drawing.prepared_bodies import DrawnPart, Mesh, Placed, parts_of, placed
from seaglint.objects.drawing.raster import LIFT, TURN_OF_COLUMNS, TURN_OF_ROWS, Faces, SunMap
from seaglint.objects.drawing.sample_sums import (
    ACROSS,
    COUNTED,
    DOWN,
    DRY,
    DRY_INSIDE,
    DRY_SEEN,
    PLANES,
    SUMS,
    WHOLE,
    BodySurroundings,
    SensorMesh,
    Window,
)
from seaglint.optics.blackbody import planck_wavenumber

#: Share of the light behind a plume that it absorbs along its chords (``chord_shares``).
Cover = Callable[[Mesh | GasPlume | PointSource], FloatArray]

CELLS: Final = 128  #: Number of samples along a side of a part: solid angles within some 0.2 %.

#: Number of cells along a side of a body's shadow map: for a body with at most ``_FEW`` samples along a side, and for a larger one.
SHADOW_CELLS: Final = (128, 256)

_FEW: Final = 192

_FACES_SUN: Final = 1e-3  #: Least reflectance of a surface for which its shadow map is computed.

_POLE: Final = math.radians(88.0)
_CACHED: Final = 4


def faces_of(kind: Mesh | GasPlume | PointSource, point: FloatArray, image: FloatArray, bend: float) -> Faces:
    """Return the faces of a part on a plane; without triangles for plumes and points."""
    if isinstance(kind, Mesh):
        return Faces(point, image, kind.corners, kind.ends, kind.sides, bend)
    none = np.zeros((0, 3), np.int32)
    return Faces(point, image, none, none[:, :2], none, bend)


def solid_angles(one: Placed, every: Iterable[Placed], cover: Cover) -> tuple[float, float]:
    """Return solid angles of a part without occlusion [sr], in all and above the waterline; for a plume times its absorption.

    Parameters
    ----------
    one : Placed
        The part.
    every : iterable of Placed
        Parts of all bodies; parts of the same body hide ``one`` above the waterline.
    cover : callable
        Absorbed share of the light behind a plume along its chords [1, (chords,)].
    """
    if one.radius == 0.0:
        return 0.0, 0.0
    plane = TangentPlane.to(one.place)
    point, ahead = _on_plane(one, plane)
    if not ahead.any():
        return 0.0, 0.0
    low, high = point[ahead, :2].min(axis=0), point[ahead, :2].max(axis=0)
    step = np.maximum(high - low, 1e-12) / CELLS
    # places of the samples as in raster.sample_place: a thin part is hit in proportion to its width
    i = np.arange(CELLS)
    x = low[0] + step[0] * (i[None] + np.mod(0.5 + TURN_OF_ROWS * i[:, None], 1.0))
    y = high[1] - step[1] * (i[:, None] + np.mod(0.5 + TURN_OF_COLUMNS * i[None], 1.0))
    own = [other for other in every if other is not one and other.part.body == one.part.body and other.radius > 0.0]
    direction = np.stack([x, y, np.ones_like(x)], axis=-1) @ plane.axes
    length = np.linalg.norm(direction, axis=-1)
    # an area of the tangent plane has a solid angle smaller by the cube of the length of its direction
    cell = length**-3 * step[0] * step[1]
    near = np.zeros_like(x)
    if isinstance(one.part.kind, Mesh):
        whole, samples = sampled_solid(_faces(one, plane, low, high[1], step), x, y, (float(step[0]), float(step[1])))
        near = np.where(samples.share > 0.0, samples.near, 0.0)
        share, middle = samples.share * cell, 1.0 / np.where(near > 0.0, near, np.inf)
        left = share
    else:
        for other in own:
            if isinstance(other.part.kind, Mesh):
                near = np.maximum(near, sampled_solid(_faces(other, plane, low, high[1], step), x, y, (1.0, 1.0))[1].near)
        share = _opacity(one, direction, np.inf, cover) * cell
        whole, middle = float(share.sum()), _middle(one.gas, direction)
        left = _opacity(one, direction, 1.0 / np.where(near > 0.0, near, 1e-300), cover) * cell
    for other in own:
        if other.gas.size:
            left = left * (1.0 - _opacity(other, direction, middle, cover))
    dry = middle * (direction @ one.water[:3]) > one.water[3]
    return whole, float(left[dry & (middle > 0.0)].sum())


def _on_plane(one: Placed, plane: TangentPlane) -> tuple[FloatArray, np.ndarray]:
    """Return tangents of a part's points and one over their depth, 0 behind the sensor, and flags of points in front of it."""
    in_axes = one.surface @ plane.axes.T
    ahead = in_axes[:, 2] > 1e-3 * np.sqrt((in_axes**2).sum(axis=1))
    depth = np.where(ahead, in_axes[:, 2], 1.0)
    return np.stack([in_axes[:, 0] / depth, in_axes[:, 1] / depth, np.where(ahead, 1.0 / depth, 0.0)], axis=1), ahead


def _faces(one: Placed, plane: TangentPlane, low: FloatArray, top: float, step: FloatArray) -> Faces:
    """Return the faces of a part with the samples as pixels; rows count downwards."""
    point, _ = _on_plane(one, plane)
    image = np.stack([point[:, 0] - low[0], top - point[:, 1]], axis=1) / step
    return faces_of(one.part.kind, point, image, 1e-9)


def _opacity(plume: Placed, direction: FloatArray, last: FloatArray | float, cover: Cover) -> FloatArray:
    """Return the share of the light behind a plume that it absorbs along directions up to ``last`` times their length [1]."""
    # ``seaglint.objects.drawing.raster.chord`` for arrays of directions that are no unit vectors
    gas = plume.gas
    along = direction @ gas[3:12].reshape(3, 3).T
    square, part = (along**2).sum(axis=-1), along @ gas[:3]
    half = np.sqrt(np.maximum(part**2 - square * (gas[:3] @ gas[:3] - 1.0), 0.0))
    first, end = np.maximum((part - half) / square, 0.0), np.minimum((part + half) / square, last)
    inside = np.maximum(end - first, 0.0)
    share = inside * np.linalg.norm(direction, axis=-1) / gas[12] if gas[12] > 0.0 else 0.5 * inside * np.sqrt(square)
    return np.asarray(np.interp(np.sqrt(np.minimum(share, 1.0)), np.sqrt(chord_shares()), cover(plume.part.kind)))


def _middle(gas: FloatArray, direction: FloatArray) -> FloatArray:
    """Return the multiple of directions at which they are nearest to a plume's middle, measured in its semi-axes."""
    along = direction @ gas[3:12].reshape(3, 3).T
    return np.asarray(along @ gas[:3] / (along**2).sum(axis=-1))


@dataclass(frozen=True, eq=False)
class PixelPatch:
    """Contribution of a part to some pixels."""

    placed: Placed  #: The part at its place.
    rows: np.ndarray  #: Rows of the pixels in the image (rows,).
    columns: np.ndarray  #: Columns of the pixels in the image (columns,).
    planes: FloatArray  #: ``PLANES`` of the pixels (planes, rows, columns).
    sums: FloatArray  #: ``SUMS``.
    #: Solid angle above the waterline in each row, in the picture and in view, ``sums[[DRY_INSIDE, DRY_SEEN]]`` [sr, (2, rows)]; 1 or 0 for
    #: a point.
    lines: FloatArray
    clear: float = 0.0  #: Transmittance of the path to a point in view [1]; 0 for other parts.
    #: Transmittance of the air to a point times the band's weights [cm-1, (n,)]; empty for other parts.
    air: FloatArray = field(default_factory=lambda: np.zeros(0))

    @property
    def counted(self) -> FloatArray:
        """Counted radiance times the share of the pixel, of a solid or a plume [W m-2 sr-1, (rows, columns)]."""
        return np.asarray(self.planes[COUNTED])


@dataclass(frozen=True, eq=False)
class DrawnBodies:
    """Contributions of all bodies to the image of an instant, and their positions."""

    bodies: tuple[Body, ...]
    stands: tuple[Stand, ...]
    patches: tuple[PixelPatch, ...]
    placed: tuple[Placed, ...]


@dataclass(frozen=True, eq=False)
class Stage:
    """Surroundings of the drawing: a camera's pixels at an instant, the sea in front of the bodies, and the light."""

    imager: Imager  #: The camera's pixels.
    pose: Pose  #: Place and attitude of the sensor.
    view: SeaView  #: Sea, air and Sun.
    sea: tuple[Levels, Surface] | None  #: The resolved waves of the instant; without them the sea is flat.
    columns: tuple[int, int]  #: First and end column of the pixels that are drawn.
    rows: tuple[int, int]  #: First and end row of the pixels that are drawn.
    sea_hides: float = math.inf  #: Arc beyond which the sea hides only the part of a body below the water [m].
    cells: int = FEWEST_CELLS  #: Least number of samples along the side of a pixel.
    frame: tuple[int, int, int, int] | None = None  #: First and end column and row of the picture, if pixels beyond it are drawn too.

    @cached_property
    def lens(self) -> Lens:
        """Conversion of the camera's image points to directions."""
        return lens(self.imager, self.pose.attitude)

    @cached_property
    def window(self) -> Window:
        """Pixels to draw."""
        circle = self.imager.columns if self.imager.goes_round else 0
        return Window(self.columns, self.rows, circle, self.frame or (*self.columns, *self.rows))

    def crests(self, one: Placed) -> Crests:
        """Return the sea in front of a part."""
        if one.span[0].arc[0] > self.sea_hides:
            return calm(self.pose.height)._replace(horizon=(math.inf, 0.0))
        if self.sea is None:
            return calm(self.pose.height)
        return sea_before(*self.sea, self.pose.height, one.span[0])

    def faces(self, one: Placed, plane: TangentPlane, about: Placed) -> Faces:
        """Return the triangles or points of a part on a plane and in the image, with columns next to the columns of part ``about``."""
        middle = float(image_point(self.lens, tuple(about.place), 0.5 * self.imager.columns)[0])
        point, image = project(one.surface, plane.axes, self.lens, middle)
        return faces_of(one.part.kind, point, image, self._bend(one))

    def size_of(self, one: Placed) -> float:
        """Return the longer side of a part in the image [pixels]; 1 for a part that is wholly behind the camera."""
        box = self.box(self.faces(one, TangentPlane.to(one.place), one))
        return 1.0 if box is None else max(box[1] - box[0], box[3] - box[2])

    def _bend(self, one: Placed) -> float:
        """Return the largest curvature of the sides of a part in the image, as a share of their size [1]."""
        if self.lens.plane:
            return 1e-9
        level = one.place @ self.lens.turn
        steepest = abs(math.atan2(level[2], math.hypot(level[0], level[1]))) + one.angle
        if steepest >= _POLE:
            return 1e3
        return 1e-9 + 2.0 * one.angle * (0.25 * math.tan(steepest) + 0.5 * one.angle)

    def box(self, faces: Faces) -> tuple[float, float, float, float] | None:
        """Return left, right, top and bottom of a part in the image [pixels]; None for a part that is wholly behind the camera."""
        in_front = faces.point[:, 2] > 0.0
        if not in_front.any():
            return None
        across, down = (faces.image[:, k] if in_front.all() else faces.image[in_front, k] for k in (0, 1))
        low, high = np.array([across.min(), down.min()]), np.array([across.max(), down.max()])
        if faces.bend >= 1.0:  # over the pole of the image's angles
            return 0.0, float(self.imager.columns), 0.0, float(self.imager.rows)
        margin = faces.bend * (high - low).max() + 1e-9
        return float(low[0] - margin), float(high[0] + margin), float(low[1] - margin), float(high[1] + margin)


def _latest(cached: OrderedDict[SeaView, Surroundings], view: SeaView, compute: Callable[[], Surroundings]) -> Surroundings:
    """Return the light of a view, computed unless it is among the latest."""
    if view not in cached:
        cached[view] = compute()
    cached.move_to_end(view)
    light = cached[view]
    while len(cached) > _CACHED:
        cached.popitem(last=False)
    return light


@dataclass(frozen=True, eq=False)
class Drawer:
    """Drawer of bodies from any pose at any time. Make it with ``of``."""

    bodies: tuple[Body, ...]
    _parts: tuple[DrawnPart, ...]
    counted: Counting | None = None
    _light: OrderedDict[SeaView, Surroundings] = field(default_factory=OrderedDict)
    _energy: OrderedDict[SeaView, Surroundings] = field(default_factory=OrderedDict)  # the same for a detector of energy

    @property
    def parts(self) -> tuple[DrawnPart, ...]:
        """Parts of all bodies."""
        return self._parts

    @classmethod
    def of(cls, bodies: tuple[Body, ...], counted: Counting | None = None) -> Drawer:
        """Prepare everything that does not change in time, for a detector that counts photons; without ``counted`` for one of energy."""
        return cls(bodies, parts_of(bodies), counted)

    def moved(self, bodies: tuple[Body, ...]) -> Drawer:
        """Return the drawer of these bodies at other places, with the light that is already computed."""
        return replace(self, bodies=bodies, _parts=parts_of(bodies))

    def counting(self, counted: Counting | None) -> Drawer:
        """Return the drawer before a detector that counts photons, or of energy (None), with the light that is already computed."""
        return replace(self, counted=counted, _light=OrderedDict())

    def light(self, view: SeaView) -> Surroundings:
        """Return the light about bodies in a view; the latest lights are cached."""
        energy = _latest(self._energy, view, lambda: Surroundings.of(view))
        return _latest(self._light, view, lambda: energy.counting(self.counted))

    def picture(self, stage: Stage, time: float) -> DrawnBodies:
        """Return the contributions of the bodies to the image at a time [s].

        Raises
        ------
        DomainError
            The sensor is inside a body, or a body is outside the range of the air.
        """
        stands, every = self.placed(stage.pose, time)
        selected = [(stage, one) for one in every if near(stage, one)]
        patches = self.patches(selected, [every] * len(selected), self.light(stage.view))
        return DrawnBodies(self.bodies, stands, tuple(patch for patch in patches if patch is not None), every)

    def placed(self, pose: Pose, time: float) -> tuple[tuple[Stand, ...], tuple[Placed, ...]]:
        """Return the places of the bodies, and of their parts, for a sensor at a pose at a time [s].

        Raises
        ------
        DomainError
            The sensor is inside a body.
        """
        stands = tuple(stand(body.motion.at(time), pose) for body in self.bodies)
        return stands, tuple(placed(part, stands[part.body], pose.height) for part in self._parts)

    def patches(
        self, selected: Sequence[tuple[Stage, Placed]], every: Sequence[tuple[Placed, ...]], light: Surroundings
    ) -> list[PixelPatch | None]:
        """Return the contribution of each selected part to the pixels of its stage, hidden by ``every`` part of its instant.

        Raises
        ------
        DomainError
            A body is outside the range of the air.
        """
        corners = [_corners(one) for _, one in selected]
        try:
            arriving = light.arriving(corners, [_source(one) for _, one in selected])
        except DomainError as error:
            raise DomainError(f"objects: {error}") from error

        covers = {id(one.part): sums.cover for (_, one), sums in zip(selected, arriving, strict=True) if one.gas.size}

        def draw(n: int) -> PixelPatch | None:
            return _drawn(*selected[n], every[n], arriving[n], (light, covers))

        with ThreadPoolExecutor(int(numba.get_num_threads())) as pool:
            # the first part alone: kernels that are not yet compiled are compiled in one thread
            first = [draw(0)] if selected else []
            return first + list(pool.map(draw, range(1, len(selected))))


def near(stage: Stage, one: Placed) -> bool:
    """Return True if a part may be in the pixels to draw: its sphere meets the cone about them."""
    imager, attitude = stage.imager, stage.pose.attitude
    (left, right), (top, bottom) = stage.columns, stage.rows
    border = np.linspace(0.0, 1.0, 17)
    across = np.concatenate([left + (right - left) * border] * 2 + [np.full(17, float(left)), np.full(17, float(right))])
    down = np.concatenate([np.full(17, float(top)), np.full(17, float(bottom))] + [top + (bottom - top) * border] * 2)
    middle = imager.directions(attitude, 0.5 * (left + right), 0.5 * (top + bottom))
    cosine = float((imager.directions(attitude, across, down) @ middle).min())
    # 10 % of margin for the border between its points; a cone of more than 1.2 rad counts as all directions
    half = 1.1 * math.acos(min(max(cosine, -1.0), 1.0)) + 1e-6
    away = math.acos(min(max(float(one.place @ middle) / max(one.distance, 1e-9), -1.0), 1.0))
    return half > 1.2 or away <= half + one.angle


def _source(one: Placed) -> FloatArray | GasPlume:
    """Return the temperatures [K] of a solid's surface, the plume itself, or no temperatures for a point."""
    kind = one.part.kind
    if isinstance(kind, Mesh):
        return kind.temperatures
    return kind if isinstance(kind, GasPlume) else np.zeros(0)


def _corners(one: Placed) -> Corners:
    span, heights = one.span
    return Corners(span.arc, heights, one.azimuth, one.elevation)


def _overlapping(one: Placed, every: tuple[Placed, ...]) -> list[Placed]:
    """Return the parts that may hide a part: their spheres overlap in direction, and they are not wholly behind it."""
    out = []
    for other in every:
        if other is one or other.radius == 0.0 or other.distance - other.radius > one.distance + one.radius:
            continue
        cosine = float(one.place @ other.place) / max(one.distance * other.distance, 1e-9)
        if math.acos(min(max(cosine, -1.0), 1.0)) < one.angle + other.angle:
            out.append(other)
    return out


def _drawn(
    stage: Stage, one: Placed, every: tuple[Placed, ...], arriving: Arriving, around_bodies: tuple[Surroundings, dict[int, FloatArray]]
) -> PixelPatch | None:
    """Draw one part on a separate grid of samples, among plumes with covers by their identity; None for a part without contribution."""
    light, cover_by_part = around_bodies
    plane = TangentPlane.to(one.place)
    faces = stage.faces(one, plane, one)
    box = stage.box(faces)
    if box is None:
        return None
    inside = _clipped(box, stage.window)
    if inside is None:
        return None
    # parts of the same body come first: they hide samples, but do not count as occlusion of the body
    others = sorted(_overlapping(one, every), key=lambda other: other.part.body != one.part.body)
    plumes = [other for other in others if id(other.part) in cover_by_part]  # other plumes are outside the pixels to draw
    gases = np.array([other.gas for other in plumes]).reshape(-1, 13)
    covers = np.array([cover_by_part[id(other.part)] for other in plumes]).reshape(-1, CHORDS)
    solids = [stage.faces(other, plane, one) for other in others if isinstance(other.part.kind, Mesh)]
    own = sum(isinstance(other.part.kind, Mesh) and other.part.body == one.part.body for other in others)
    around = (stage.pose.height, stage.crests(one), NOTHING, gases, covers, plane.axes, one.heading, one.water, NOTHING)
    scene = BodySurroundings(*around, sum(other.part.body == one.part.body for other in plumes))
    if one.radius == 0.0:
        return _point(stage, one, (scene, solids), box, arriving)
    grid = grid_over(inside, stage.cells)
    shadow = _sun_map(one, light, SHADOW_CELLS[max(grid.size) > _FEW])
    planes, sums = part_planes(grid, (stage.lens, stage.window), (faces, solids, solids[:own]), _body(one), scene, arriving, shadow)
    total = sums.sum(axis=1)
    if inside != box:
        total[[WHOLE, DRY]] = solid_angles(one, every, light.cover_of)
    return _patch(stage, one, grid, planes, (total, sums))


def _clipped(box: tuple[float, float, float, float], window: Window) -> tuple[float, float, float, float] | None:
    """Return the part of a box inside the window; for a panorama all columns, so that a body across its seam stays whole."""
    left, right, top, bottom = box
    if window.circle == 0:
        left, right = max(left, float(window.columns[0])), min(right, float(window.columns[1]))
    elif right - left > window.circle:
        left, right = 0.0, float(window.circle)
    top, bottom = max(top, float(window.rows[0])), min(bottom, float(window.rows[1]))
    return (left, right, top, bottom) if left < right and top < bottom else None


def _body(one: Placed) -> SensorMesh | FloatArray:
    """Return the solid or gas of a part in the form that kernels read."""
    kind = one.part.kind
    return SensorMesh(one.surface, kind.corners, kind.code, kind.emissivity) if isinstance(kind, Mesh) else one.gas


def _patch(stage: Stage, one: Placed, grid: Grid, planes: FloatArray, sums: tuple[FloatArray, FloatArray]) -> PixelPatch | None:
    """Return the patch of the pixels to draw, from the pixels of the grid; ``sums``: of all samples, and of each row."""
    rows, columns = grid.first[1] + np.arange(grid.pixels[1]), grid.first[0] + np.arange(grid.pixels[0])
    if stage.window.circle:
        columns = columns % stage.window.circle
    inside_rows = (rows >= stage.rows[0]) & (rows < stage.rows[1])
    inside_columns = (columns >= stage.columns[0]) & (columns < stage.columns[1])
    return PixelPatch(
        one,
        rows[inside_rows],
        columns[inside_columns],
        planes[:, inside_rows][:, :, inside_columns],
        sums[0],
        sums[1][[DRY_INSIDE, DRY_SEEN]][:, inside_rows],
    )


def _point(
    stage: Stage, one: Placed, around: tuple[BodySurroundings, list[Faces]], box: tuple[float, float, float, float], arriving: Arriving
) -> PixelPatch | None:
    """Draw a point source: its visibility and the transmittance of its path; None for a point outside the pixels to draw."""
    scene, solids = around
    kind = one.part.kind
    assert isinstance(kind, PointSource)  # only points have no extent
    column, row = 0.5 * (box[0] + box[1]), 0.5 * (box[2] + box[3])
    band = stage.view.in_band
    spectrum = np.ones(band.weights.size) if kind.temperature is None else planck_wavenumber(band.wavenumber_cm, kind.temperature)
    through = float(arriving.clear @ spectrum / (band.weights @ spectrum))
    clear = clear_to_point(scene, solids, one.distance) * through
    at = math.floor(column) % stage.window.circle if stage.window.circle else math.floor(column)
    if not (stage.columns[0] <= at < stage.columns[1] and stage.rows[0] <= math.floor(row) < stage.rows[1]):
        return None
    sums = np.zeros(SUMS)
    sums[[ACROSS, DOWN]] = column, row
    left, right, top, bottom = stage.window.frame
    framed = left <= at < right and top <= row < bottom
    lines = np.array([[float(framed)], [float(framed and clear > 0.0)]])
    pixel = np.array([math.floor(row)]), np.array([at])
    return PixelPatch(one, *pixel, np.zeros((PLANES, 1, 1)), sums, lines, clear, arriving.clear)


def _sun_map(one: Placed, light: Surroundings, cells: int) -> SunMap:
    """Return the shadow map of a body on itself; without cells for a body that reflects no sunlight."""
    sun = light.sun
    kind = one.part.kind
    none = SunMap(sun, np.zeros((2, 3)), np.zeros(4), np.zeros((0, 0)), 0.0)
    if not isinstance(kind, Mesh) or not light.shines or float(kind.emissivity.min()) > 1.0 - _FACES_SUN:
        return none
    right = np.array([sun[1], -sun[0], 0.0])
    right = right / np.linalg.norm(right) if np.linalg.norm(right) > 1e-9 else np.array([1.0, 0.0, 0.0])
    across = np.stack([right, np.cross(sun, right)])
    return shadow_map(one.surface, kind.corners, (sun, across), cells, LIFT * one.radius)
