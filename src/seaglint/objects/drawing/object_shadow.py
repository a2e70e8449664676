r"""Shadows of bodies on the glint: facets mirror no Sun where a body stands between the mean sea and the Sun.

The shadow is the body laid on the mean sea along the Sun's rays: a vertex :math:`p` goes to :math:`p - t s`, where the line to the
Sun :math:`s` leaves the sphere,

.. math:: t = \frac{c}{q\cdot s + \sqrt{(q\cdot s)^2 - c}}, \qquad c = |q|^2 - R'^2, \qquad q = p + (0, 0, R' + h)

and what is under water to the surface above it. Its share of a pixel is found as that of a body; the pixel's mirrored Sun is less by it.
The Sun is a point for this, and waves do not bend the shadow's edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.imaging.layers import Layers, share_of_glint
from seaglint.objects.drawing.compose import LEAST_COVER
from seaglint.objects.drawing.draw import Stage
from seaglint.objects.drawing.eye import TangentPlane, grid_over
from seaglint.objects.drawing.launch_bodies import hit_cells
from seaglint.objects.drawing.light import Surroundings
from seaglint.objects.drawing.parts import Mesh, Placed


def shadowed(layers: Layers, stage: Stage, placed: Sequence[Placed], light: Surroundings) -> Layers:
    """Return the image of the sea with the shadows of bodies on its glint.

    Parameters
    ----------
    layers : Layers
        Image of the sea alone: the pixels that ``stage`` draws.
    stage : Stage
        Camera, pose and pixels.
    placed : sequence of Placed
        Parts of all bodies; gas and points cast none.
    light : Surroundings
        The view's.

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
            _add(dark, stage, laid(one, light.sun, stage.pose.height))
    touched = (dark > LEAST_COVER) & (layers.glint_radiance > 0.0)
    if not touched.any():
        return layers
    share = np.minimum(dark, 1.0)
    if "coverage" in layers:  # only the sea is shadowed
        share = np.minimum(dark / np.maximum(layers["coverage"], LEAST_COVER), 1.0)
    lost = layers.glint_radiance * share
    out = {name: image.copy() for name, image in layers.items()}
    for name in ("radiance", "glint_radiance"):
        out[name][touched] = np.maximum(out[name] - lost, 0.0)[touched]
    if "glint_share" in out:
        out["glint_share"][touched] = share_of_glint(out["glint_radiance"], out["radiance"])[touched]
    return Layers(out)


def laid(one: Placed, sun: FloatArray, eye: float) -> Placed | None:
    """Part projected on the mean sea along the Sun's rays; None where the rays pass over the sea."""
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
