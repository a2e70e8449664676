"""Bodies through air that bends the lines of sight: each is drawn with standard refraction, its rows shifted for its own distance.

A part is shifted as a whole for the arc of its middle. In a mirage rows of it are seen several times, upright and inverted. What the sea
hides is told by the rays; waves hide as in the standard picture, for bodies nearer than :data:`WAVES_WITHIN` of its horizon.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np
from scipy.sparse import csr_array

from seaglint.base.conventions import FloatArray, horizon_range
from seaglint.imaging.camera.imager import Attitude
from seaglint.imaging.camera.pose import Pose
from seaglint.imaging.refracted import RefractedScene, pixels_of
from seaglint.objects.drawing.draw import Drawer, DrawnBodies, PixelPatch, Stage
from seaglint.objects.drawing.sample_sums import ACROSS, COVER, DOWN, SEEN, WHOLE

MARGIN: Final = 0.015  #: Angle by which bodies are drawn beyond the rows of the sea [rad]: their rows are shifted by another amount.

WAVES_WITHIN: Final = 0.8  #: Share of the arc of the standard horizon within which waves hide bodies.


def refracted_picture(drawer: Drawer, stage: Stage, scene: RefractedScene, time: float) -> DrawnBodies:
    """Contributions of the bodies to a refracted image at a time [s]."""
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
        arc, waves = 0.5 * (near + far), near <= straight.sea_hides
        if patch.placed.radius == 0.0:
            elevation = standard.top - float(patch.sums[DOWN]) * standard.row_step
            shown, images = ([one for one in shift.images(arc, elevation, into_sea=how) if _inside(stage, one[0])] for how in (True, waves))
            if patch.clear > 0.0 and images:
                patches += [_image(patch, *one) for one in images]
            elif shown:  # in the picture, and hidden
                row = np.array([math.floor(shown[0][0])])
                patches.append(replace(patch, rows=row, lines=np.array([[1.0], [0.0]]), clear=0.0))
        else:
            mixed = shift.objects(arc, standard, into_sea=waves)
            unhidden = mixed[0] if waves else shift.objects(arc, standard, into_sea=True)[0]
            patches += _shifted(patch, mixed, unhidden, stage)
    return DrawnBodies(picture.bodies, picture.stands, tuple(patches), picture.placed)


def _inside(stage: Stage, row: float) -> bool:
    return stage.rows[0] <= math.floor(row) < stage.rows[1]


def _image(patch: PixelPatch, row: float, magnification: float) -> PixelPatch:
    """Image of a point source in a row [pixels], as much brighter as it is larger."""
    sums: FloatArray = patch.sums.copy()
    sums[DOWN] = row
    return replace(patch, rows=np.array([math.floor(row)]), sums=sums, clear=patch.clear * magnification)


def _shifted(patch: PixelPatch, mixed: tuple[csr_array, csr_array], unhidden: csr_array, stage: Stage) -> list[PixelPatch]:
    """Patch with its rows shifted; none where no ray comes near it. ``unhidden``: shares of rows where the sea hides nothing."""
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
    """Lines of a patch by the rows of the picture, each row of the standard picture shared out among its images in them [sr, (2, rows)]."""
    total = np.asarray(unhidden.sum(axis=0)).ravel()
    each = lines / np.where(total > 0.0, total, np.inf)
    out = np.stack([unhidden @ each[0], shares @ each[1]])
    met = np.flatnonzero(total)
    if met.size:
        # rows between images that no ray meets are in the picture, and hidden
        dark = np.arange(met[0], met[-1])[total[met[0] : met[-1]] == 0.0]
        for row in dark:
            out[0, unhidden[:, [met[met < row][-1]]].nonzero()[0][0]] += lines[0, row]
    return out
