r"""Composition of bodies with the image of the sea by coverage, their shadows on the glint, and bodies through refracting air.

Pixels without a body keep their bytes.

**Shadows.** Facets mirror no Sun where a body is between the mean sea and the Sun. The shadow is the projection of the body on the mean
sea along the Sun's rays: a vertex :math:`p` moves to :math:`p - t s`, where the line to the Sun :math:`s` leaves the sphere,

.. math:: t = \frac{c}{q\cdot s + \sqrt{(q\cdot s)^2 - c}}, \qquad c = |q|^2 - R'^2, \qquad q = p + (0, 0, R' + h)

and a vertex under water moves to the surface above it. The covered share of a pixel is computed as for a body; the mirrored Sun of the
pixel is reduced by this share. The Sun is a point here, and waves do not bend the edge of the shadow.

**Refraction.** In air that bends the lines of sight a part is drawn with standard refraction, and its rows are shifted for the arc of its
middle. In a mirage some rows appear several times, upright and inverted. Rays that meet the sea decide which rows it hides; waves hide as
in the standard picture, for bodies nearer than ``WAVES_WITHIN`` of its horizon.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, horizon_range
from seaglint.imaging.camera.imager import Attitude, pixels_of
from seaglint.imaging.camera.pose import Pose
from seaglint.imaging.layers import LEAST_SEEN, SPARKLE, Layers, share_of_glint
from seaglint.imaging.refraction import RefractedScene
from seaglint.objects.body import PointSource
from seaglint.objects.drawing.draw import Drawer, DrawnBodies, PixelPatch, Stage, solid_angles
from seaglint.objects.drawing.eye import Stand, TangentPlane, grid_over
from seaglint.objects.drawing.launch_bodies import hit_cells
from seaglint.objects.drawing.light import Surroundings
from seaglint.objects.drawing.prepared_bodies import Mesh, Placed
from seaglint.objects.drawing.sample_sums import ACROSS, COVER, DISTANCE, DOWN, DRY, EMITTED, MIRRORED, PATH, SEEN, SUMS, SUN, WHOLE
from seaglint.optics.blackbody import planck_wavenumber

#: Least share of a body outside the picture: sums over windows of the picture and over the whole body differ by less.
LEAST_CUT: Final = 2e-3

LEAST_COVER: Final = 1e-12  #: Least share of a pixel that a visible body covers.

#: Planes of a body that enter each layer, added to the sea's plane times the share that the body leaves free.
_ADDED: Final = {
    "radiance": (PATH, EMITTED, MIRRORED, SUN),
    "path_radiance": (PATH,),
    "emitted_radiance": (EMITTED,),
    "sky_radiance": (MIRRORED,),
    "glint_radiance": (SUN,),
    "coverage": (),
    "foam_share": (),
}


@dataclass(frozen=True, eq=False)
class BodyShare:
    """Coverage and radiance of one body in some pixels; all arrays but the first two are (rows, columns)."""

    rows: NDArray[np.int64]  #: Rows of the pixels (rows,).
    columns: NDArray[np.int64]  #: Columns of the pixels (columns,).
    cover: FloatArray  #: Share of the pixel that the body covers [1].
    radiance: FloatArray  #: Radiance of the body times its coverage [W m-2 sr-1].
    image: FloatArray  #: Radiance of the sea's image in these pixels [W m-2 sr-1].
    pixel: FloatArray  #: Solid angle of the pixels [sr].
    least: float = LEAST_COVER  #: Coverage above which the body touches a pixel [1].


@dataclass(frozen=True, eq=False)
class BodySight:
    """One body in the image, summed over its parts."""

    name: str  #: Name of the body.
    distance: float  #: Distance to its origin [m].
    azimuth: float  #: Azimuth of its origin [rad].
    elevation: float  #: Elevation of its origin [rad].
    whole: float = 0.0  #: Solid angle in all, the part under water included [sr].
    seen: float = 0.0  #: Solid angle in view [sr].
    across: float = 0.0  #: Solid angle in view times column [sr pixels].
    down: float = 0.0  #: Solid angle in view times row [sr pixels].
    shares: tuple[BodyShare, ...] = field(default=())  #: Pixels of the body.
    dry: float = 0.0  #: Solid angle above the waterline, in the picture or not [sr]; for points their number.
    inside: float = 0.0  #: Solid angle above the waterline in the picture, hidden or not [sr].
    dry_seen: float = 0.0  #: Solid angle above the waterline in the picture and in view [sr].

    @property
    def truncated(self) -> float:
        """Share of the body above the waterline that is outside the picture [1]; NaN for a body under water."""
        if self.dry <= 0.0:
            return math.nan
        outside = 1.0 - self.inside / self.dry
        return min(outside, 1.0) if outside > LEAST_CUT else 0.0

    @property
    def occluded(self) -> float:
        """Hidden share of the body above the waterline and in the picture [1]; NaN for a body without such a part."""
        return min(max(1.0 - self.dry_seen / self.inside, 0.0), 1.0) if self.inside > 0.0 else math.nan


def composed(layers: Layers, stage: Stage, picture: DrawnBodies, light: Surroundings) -> tuple[Layers, tuple[BodySight, ...]]:
    """Return the image of the sea with bodies over it, and the sight of each body.

    Parameters
    ----------
    layers : Layers
        Image of the sea alone: the pixels that ``stage`` draws.
    stage : Stage
        Camera, pose and pixels.
    picture : DrawnBodies
        Contributions of the bodies to the image.
    light : Surroundings
        Light about bodies in the view.

    Returns
    -------
    Layers, tuple of BodySight
        Image, and the sight of every body.
    """
    if not picture.patches:
        return layers, sights(picture, [], [], stage.window.circle, light)
    sea = np.asarray(layers.radiance, np.float64)
    out = {name: layers[name].copy() for name in layers}
    pixel = _pixels(stage)
    shares = [_share(patch, stage, sea, pixel, light) for patch in picture.patches]
    for patch, share in zip(picture.patches, shares, strict=True):
        if share.cover.size == 0:
            continue
        where = np.ix_(share.rows - stage.rows[0], share.columns - stage.columns[0])
        for name, planes in _ADDED.items():
            if name not in out:
                continue
            own = patch.planes[list(planes)].sum(axis=0) if planes else np.zeros(share.cover.shape)
            # a point has no planes: its radiance goes where emission goes
            if patch.clear > 0.0 and EMITTED in planes:
                own = own + share.radiance
            sea_value = np.asarray(layers[name][where], np.float64)
            touched = (share.cover > LEAST_COVER) | (own != 0.0)
            # coverage of the unchanged sea is subtracted, so that the order of bodies does not matter
            new = np.asarray(out[name][where], np.float64) + own - share.cover * sea_value
            out[name][where] = np.where(touched, np.maximum(new, 0.0), out[name][where]).astype(np.float32)
    _distances(layers, stage, picture.patches, out)
    if {"slope", "glint_share"} & set(out):
        _derived(layers, stage, picture.patches, out)
    return Layers(out), sights(picture, list(picture.patches), shares, stage.window.circle, light)


def _pixels(stage: Stage) -> FloatArray:
    """Return the solid angles of the pixels to draw [sr, (rows, columns)]."""
    across, down = np.arange(*stage.columns) + 0.5, np.arange(*stage.rows)[:, None] + 0.5
    return stage.imager.solid_angle(stage.pose.attitude, across, down)


def _share(patch: PixelPatch, stage: Stage, sea: FloatArray, pixel: FloatArray, light: Surroundings) -> BodyShare:
    where = np.ix_(patch.rows - stage.rows[0], patch.columns - stage.columns[0])
    image, solid = sea[where], pixel[where]
    radiance = patch.planes[[PATH, EMITTED, MIRRORED, SUN]].sum(axis=0)
    if patch.clear > 0.0:
        radiance = radiance + point_light(patch, solid, float(image[0, 0]), light)[1]
    return BodyShare(patch.rows, patch.columns, patch.planes[COVER], radiance, image, solid)


def point_light(patch: PixelPatch, solid: FloatArray | float, behind: float, light: Surroundings) -> tuple[Any, Any]:
    """Return the radiance that a point adds to a pixel of a solid angle [sr] over a background, counted and as power [W m-2 sr-1]."""
    power, counted = point_intensity(patch, behind, light)
    share = patch.clear / (patch.placed.distance**2 * solid)
    return counted * share, power * share


def point_intensity(patch: PixelPatch, behind: float, light: Surroundings) -> tuple[float, float]:
    """Return the radiant intensity of a point above its background, before the path, as power and as counted behind the air [W sr-1].

    ``behind``: radiance of the image at the point [W m-2 sr-1]. An intensity without a temperature is counted as the spectrum for which the
    sensor's chain converts.
    """
    point = patch.placed.part.kind
    assert isinstance(point, PointSource)  # only points have no extent
    if point.intensity is not None:
        if point.temperature is None:
            return point.intensity, point.intensity
        return point.intensity, point.intensity * _counting(light, patch.air, _planck(light, point.temperature))
    assert point.temperature_difference is not None  # one of the two is given
    assert point.area is not None
    kelvin = light.kelvin(behind)
    kelvin = kelvin if math.isfinite(kelvin) else light.view.sea_temperature
    warmer = _planck(light, kelvin + point.temperature_difference) - _planck(light, kelvin)
    intensity = point.area * float(light.view.in_band.weights @ warmer)
    return intensity, intensity * _counting(light, patch.air, warmer)


def _counting(light: Surroundings, air: FloatArray, spectrum: FloatArray) -> float:
    """Return the ratio of counted to arriving light of a spectrum through the air [1]; 1 without light."""
    arrives = float(air @ spectrum)
    return float((air * light.counted) @ spectrum) / arrives if arrives != 0.0 else 1.0


def _planck(light: Surroundings, kelvin: float) -> FloatArray:
    return planck_wavenumber(light.view.in_band.wavenumber_cm, max(kelvin, 1.0))


def _distances(layers: Layers, stage: Stage, patches: Sequence[PixelPatch], out: dict[str, NDArray[np.float32]]) -> None:
    """Compute the mean distance over visible sea and bodies in each pixel [m] into ``out["range"]``."""
    if "range" not in out:
        return
    for patch in patches:
        where = np.ix_(patch.rows - stage.rows[0], patch.columns - stage.columns[0])
        sea_range = np.asarray(out["range"][where], np.float64)
        sea_share = np.asarray(layers["coverage"][where], np.float64) if "coverage" in layers else np.isfinite(sea_range).astype(np.float64)
        cover = patch.planes[COVER]
        share = np.where(np.isfinite(sea_range), sea_share * (1.0 - cover), 0.0)
        total = share + cover
        new = (share * np.nan_to_num(sea_range) + patch.planes[DISTANCE]) / np.maximum(total, LEAST_SEEN)
        out["range"][where] = np.where(cover > LEAST_COVER, new, sea_range).astype(np.float32)


def _derived(layers: Layers, stage: Stage, patches: Sequence[PixelPatch], out: dict[str, NDArray[np.float32]]) -> None:
    """Compute the layers derived from others into ``out``: share of glint with bodies; slope is NaN where bodies hide the sea."""
    left = np.ones(layers.radiance.shape)
    for patch in patches:
        where = np.ix_(patch.rows - stage.rows[0], patch.columns - stage.columns[0])
        touched = np.asarray(out["radiance"][where] != layers["radiance"][where])
        if "glint_share" in out:
            share = share_of_glint(out["glint_radiance"][where], out["radiance"][where])
            out["glint_share"][where] = np.where(touched, share, out["glint_share"][where])
        left[where] -= patch.planes[COVER]
    if "slope" in out:
        out["slope"][left <= LEAST_SEEN] = np.nan


def sights(
    picture: DrawnBodies, patches: list[PixelPatch], shares: list[BodyShare], circle: int, light: Surroundings
) -> tuple[BodySight, ...]:
    """Return the sight of each body, from the patches of its parts and their shares.

    Parameters
    ----------
    picture : DrawnBodies
        The bodies and their places.
    patches : list of PixelPatch
        Patches of the parts in view; sums and distances come from these alone.
    shares : list of BodyShare
        One for each patch.
    circle : int
        Columns of a full circle in the pixels of the sums, 0 for an image that is no full circle.
    light : Surroundings
        Light about bodies in the view.
    """
    out = []
    for number, (body, place) in enumerate(zip(picture.bodies, picture.stands, strict=True)):
        own = [(patch, share) for patch, share in zip(patches, shares, strict=True) if patch.placed.part.body == number]
        sums = sum((_in_first_turn(patch.sums, own[0][0].sums, circle) for patch, _ in own), np.zeros(SUMS))
        points = [patch for patch, _ in own if patch.clear > 0.0]
        drawn = {id(patch.placed): (float(patch.sums[WHOLE]), float(patch.sums[DRY])) for patch, _ in own}
        parts = [one for one in picture.placed if one.part.body == number]
        extended = [one for one in parts if one.radius > 0.0]
        # a part between two samples of its grid has no sum: its solid angle is measured separately
        angles = [
            pair if (pair := drawn.get(id(one), (0.0, 0.0)))[0] > 0.0 else solid_angles(one, parts, light.cover_of) for one in extended
        ]
        whole, dry = (float(sum(pair[k] for pair in angles)) for k in (0, 1))
        lines = sum((patch.lines.sum(axis=1) for patch, _ in own if patch.placed.radius > 0.0 or not extended), np.zeros(2))
        seen, across, down = float(sums[SEEN]), float(sums[ACROSS]), float(sums[DOWN])
        if points and seen == 0.0:  # points alone: their mean place, of no solid angle
            across, down = (float(np.mean([p.sums[k] for p in points])) for k in (ACROSS, DOWN))
        elif points:
            # points beside solids: the place is the centroid of the solids alone
            across, down = (float(sums[k] - sum(p.sums[k] for p in points)) for k in (ACROSS, DOWN))
        shares_of = tuple(share for _, share in own)
        above = dry if extended else float(len(parts))
        out.append(BodySight(body.name, *_direction(place), whole, seen, across, down, shares_of, above, *map(float, lines)))
    return tuple(out)


def _in_first_turn(sums: FloatArray, first: FloatArray, circle: int) -> FloatArray:
    """Return the sums of a part with its columns counted as in the first part; on a panorama they may differ by full circles."""
    if circle == 0 or sums[SEEN] == 0.0 or first[SEEN] == 0.0:
        return sums
    turns = round((sums[ACROSS] / sums[SEEN] - first[ACROSS] / first[SEEN]) / circle)
    out = sums.copy()
    out[ACROSS] -= turns * circle * sums[SEEN]
    return out


def _direction(place: Stand) -> tuple[float, float, float]:
    east, north, up = (float(x) for x in place.place)
    return math.sqrt(east * east + north * north + up * up), math.atan2(east, north), math.atan2(up, math.hypot(east, north))


def shadowed(layers: Layers, stage: Stage, placed: Sequence[Placed], light: Surroundings) -> Layers:
    """Return the image of the sea with the shadows of bodies on its glint.

    Parameters
    ----------
    layers : Layers
        Image of the sea alone: the pixels that ``stage`` draws.
    stage : Stage
        Camera, pose and pixels.
    placed : sequence of Placed
        Parts of all bodies; gas and points cast no shadow.
    light : Surroundings
        Light about bodies in the view.

    Returns
    -------
    Layers
        Pixels without shadow keep their bytes.
    """
    if not light.shines:
        return layers
    dark = np.zeros(layers.radiance.shape)
    for one in placed:
        if isinstance(one.part.kind, Mesh):
            _add(dark, stage, projected_on_sea(one, light.sun, stage.pose.height))
    touched = (dark > LEAST_COVER) & (layers.glint_radiance > 0.0)
    if not touched.any():
        return layers
    # shadows of several bodies may overlap
    share = np.minimum(dark, 1.0)
    if "coverage" in layers:  # only the sea is shadowed
        share = np.minimum(dark / np.maximum(layers["coverage"], LEAST_COVER), 1.0)
    lost = layers.glint_radiance * share
    out = {name: image.copy() for name, image in layers.items()}
    for name in ("radiance", "glint_radiance"):
        out[name][touched] = np.maximum(out[name] - lost, 0.0)[touched]
    if SPARKLE in out:
        out[SPARKLE][touched] *= (1.0 - share)[touched].astype(np.float32)
    if "glint_share" in out:
        out["glint_share"][touched] = share_of_glint(out["glint_radiance"], out["radiance"])[touched]
    return Layers(out)


def projected_on_sea(one: Placed, sun: FloatArray, eye: float) -> Placed | None:
    """Return a part projected on the mean sea along the Sun's rays; None where the rays pass over the sea."""
    p, radius = one.surface, EFFECTIVE_EARTH_RADIUS
    above = eye + p[:, 2]
    c = p[:, 0] ** 2 + p[:, 1] ** 2 + above * (2.0 * radius + above)
    along = p @ sun + (radius + eye) * sun[2]
    under = along**2 - c
    if np.any((under < 0.0) | (along <= 0.0)) or c.max() <= 0.0:
        return None
    way = np.maximum(c, 0.0) / (along + np.sqrt(under))
    # points under water are moved straight up
    level = np.hypot(p[:, 0], p[:, 1])
    surface = p - way[:, None] * sun
    sunken = c < 0.0
    surface[sunken, 2] = np.sqrt(radius**2 - level[sunken] ** 2) - radius - eye
    middle = 0.5 * (surface.min(axis=0) + surface.max(axis=0))
    return replace(one, surface=surface, place=middle, radius=float(np.sqrt(((surface - middle) ** 2).sum(axis=1).max())))


def _add(dark: FloatArray, stage: Stage, flat: Placed | None) -> None:
    """Add the share of each pixel that a part's shadow covers."""
    if flat is None:
        return
    plane = TangentPlane.to(flat.place)
    faces = stage.faces(flat, plane, flat)
    box = stage.box(faces)
    (left, right), (top, bottom), circle = stage.columns, stage.rows, stage.window.circle
    if box is None or not (box[2] < bottom and box[3] > top):
        return
    across = (box[0], box[1]) if circle else (max(box[0], float(left)), min(box[1], float(right)))
    if circle and across[1] - across[0] > circle:
        across = (0.0, float(circle))
    if not across[0] < across[1]:
        return
    grid = grid_over((*across, max(box[2], float(top)), min(box[3], float(bottom))))
    for some, hit in hit_cells(grid, stage.lens, plane.axes, faces):
        columns = (some.begin[0] + np.arange(some.size[0])) // some.cells[0]
        rows = (some.begin[1] + np.arange(some.size[1])) // some.cells[1]
        columns = columns % circle if circle else columns
        inner = np.ix_((rows >= top) & (rows < bottom), (columns >= left) & (columns < right))
        where = np.ix_(rows[inner[0].ravel()] - top, columns[inner[1].ravel()] - left)
        np.add.at(dark, where, hit[inner] / (some.cells[0] * some.cells[1]))


MARGIN: Final = 0.015  #: Angle beyond the rows of the sea within which bodies are drawn [rad]: their rows are shifted by another amount.

WAVES_WITHIN: Final = 0.8  #: Share of the arc of the standard horizon within which waves hide bodies.


def refracted_picture(drawer: Drawer, stage: Stage, scene: RefractedScene, time: float) -> DrawnBodies:
    """Return the contributions of the bodies to a refracted image at a time [s]."""
    shift = scene.shift
    standard = shift.wider(MARGIN)
    attitude = Attitude(stage.pose.attitude.azimuth, standard.elevation)
    straight = replace(
        stage,
        imager=pixels_of(standard),
        pose=Pose(stage.pose.east, stage.pose.north, stage.pose.height, attitude),
        rows=(0, standard.rows),
        sea_hides=WAVES_WITHIN * horizon_range(stage.pose.height),
    )
    picture = drawer.picture(straight, time)
    patches: list[PixelPatch] = []
    for patch in picture.patches:
        near, far = patch.placed.span[0].arc
        # one shift for a whole part, of the arc of its middle
        arc, waves = 0.5 * (near + far), near <= straight.sea_hides
        if patch.placed.radius == 0.0:
            elevation = standard.top - float(patch.sums[DOWN]) * standard.row_step
            shown, images = (
                [one for one in shift.images(arc, elevation, into_sea=into_water) if _inside(stage, one[0])] for into_water in (True, waves)
            )
            if patch.clear > 0.0 and images:
                patches += [_image(patch, *one) for one in images]
            elif shown:  # in the picture, and hidden
                row = np.array([math.floor(shown[0][0])])
                patches.append(replace(patch, rows=row, lines=np.array([[1.0], [0.0]]), clear=0.0))
        else:
            mixed = shift.objects(arc, standard, into_sea=waves)
            # rays into the sea see all rows of the part: they show how much the sea hides
            unhidden = mixed[0] if waves else shift.objects(arc, standard, into_sea=True)[0]
            patches += _shifted(patch, mixed, unhidden, stage)
    return DrawnBodies(picture.bodies, picture.stands, tuple(patches), picture.placed)


def _inside(stage: Stage, row: float) -> bool:
    return stage.rows[0] <= math.floor(row) < stage.rows[1]


def _image(patch: PixelPatch, row: float, magnification: float) -> PixelPatch:
    """Return the image of a point source in a row [pixels]; its brightness grows with the magnification."""
    sums: FloatArray = patch.sums.copy()
    sums[DOWN] = row
    return replace(patch, rows=np.array([math.floor(row)]), sums=sums, clear=patch.clear * magnification)


def _shifted(patch: PixelPatch, mixed: tuple[csr_array, csr_array], unhidden: csr_array, stage: Stage) -> list[PixelPatch]:
    """Return a patch with its rows shifted; no patch if no ray comes near it. ``unhidden``: shares of rows without the sea in front."""
    shares, places, unhidden = (matrix[:, patch.rows] for matrix in (*mixed, unhidden))
    lines = _lines(patch.lines, shares, unhidden)
    rows = np.arange(*stage.rows)
    shares, places = shares[rows], places[rows]
    touched = np.flatnonzero((np.diff(shares.indptr) > 0) | (lines[0, rows] > 0.0))
    if touched.size == 0:
        return []
    shares, places, rows = shares[touched], places[touched], rows[touched]
    planes = np.stack([shares @ plane for plane in patch.planes])
    pixel = stage.imager.solid_angle(stage.pose.attitude, patch.columns + 0.5, rows[:, None] + 0.5)
    pixel = np.broadcast_to(pixel, planes[COVER].shape)
    sums = patch.sums.copy()
    sums[SEEN] = float((planes[COVER] * pixel).sum())
    sums[DOWN] = float(((places @ patch.planes[COVER]) * pixel).sum())
    sums[ACROSS] *= sums[SEEN] / patch.sums[SEEN] if patch.sums[SEEN] > 0.0 else 0.0
    sums[WHOLE] = max(float(sums[WHOLE]), float(sums[SEEN]))
    return [PixelPatch(patch.placed, rows, patch.columns, planes, sums, lines[:, rows])]


def _lines(lines: FloatArray, shares: csr_array, unhidden: csr_array) -> FloatArray:
    """Return the lines of a patch by rows of the picture: a row of the standard picture is divided among its images [sr, (2, rows)]."""
    total = np.asarray(unhidden.sum(axis=0)).ravel()
    per_share = lines / np.where(total > 0.0, total, np.inf)
    out = np.stack([unhidden @ per_share[0], shares @ per_share[1]])
    rows_met = np.flatnonzero(total)
    if rows_met.size:
        # rows that no ray meets, between rows that rays meet, are in the picture and hidden: they go to the image of the row above
        dark = np.arange(rows_met[0], rows_met[-1])[total[rows_met[0] : rows_met[-1]] == 0.0]
        for row in dark:
            out[0, unhidden[:, [rows_met[rows_met < row][-1]]].nonzero()[0][0]] += lines[0, row]
    return out
