"""Solid angles of whole parts of bodies, wherever they are in a picture, and of what is above their waterline."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.objects.body import GasPlume, PointSource
from seaglint.objects.drawing.eye import TangentPlane
from seaglint.objects.drawing.launch_bodies import sampled_solid
from seaglint.objects.drawing.parts import Mesh, Placed
from seaglint.objects.drawing.plume_spectra import chord_shares
from seaglint.objects.drawing.raster import Faces

CELLS: Final = 128  #: Samples along a side of a part: solid angles within some 0.2 %.


def faces_of(kind: Mesh | GasPlume | PointSource, point: FloatArray, image: FloatArray, bend: float) -> Faces:
    """Faces of a part on a plane; the points alone where it is no mesh."""
    if isinstance(kind, Mesh):
        return Faces(point, image, kind.corners, kind.ends, kind.sides, bend)
    none = np.zeros((0, 3), np.int32)
    return Faces(point, image, none, none[:, :2], none, bend)


#: Share of the light behind a plume that it absorbs along its chords (:func:`~seaglint.objects.drawing.plume_spectra.chord_shares`).
Cover = Callable[[Mesh | GasPlume | PointSource], FloatArray]


def solid_angles(one: Placed, every: Iterable[Placed], cover: Cover) -> tuple[float, float]:
    """Solid angles of a part without occlusion [sr]: in all, and above the waterline; of a plume those of its absorption.

    Parameters
    ----------
    one : Placed
        The part.
    every : iterable of Placed
        Parts of which those of the same body hide what is above the waterline.
    cover : callable
        What plumes absorb of the light behind them.
    """
    if one.radius == 0.0:
        return 0.0, 0.0
    plane = TangentPlane.to(one.place)
    point, ahead = _on_plane(one, plane)
    if not ahead.any():
        return 0.0, 0.0
    low, high = point[ahead, :2].min(axis=0), point[ahead, :2].max(axis=0)
    step = np.maximum(high - low, 1e-12) / CELLS
    i = np.arange(CELLS)
    x = low[0] + step[0] * (i[None] + np.mod(0.5 + 0.6180339887498949 * i[:, None], 1.0))
    y = high[1] - step[1] * (i[:, None] + np.mod(0.5 + 0.7548776662466927 * i[None], 1.0))
    own = [other for other in every if other is not one and other.part.body == one.part.body and other.radius > 0.0]
    direction = np.stack([x, y, np.ones_like(x)], axis=-1) @ plane.axes
    length = np.linalg.norm(direction, axis=-1)
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
    """Tangents of a part's points and one over their depth, 0 behind, and a flag for those ahead."""
    seen = one.surface @ plane.axes.T
    ahead = seen[:, 2] > 1e-3 * np.sqrt((seen**2).sum(axis=1))
    depth = np.where(ahead, seen[:, 2], 1.0)
    return np.stack([seen[:, 0] / depth, seen[:, 1] / depth, np.where(ahead, 1.0 / depth, 0.0)], axis=1), ahead


def _faces(one: Placed, plane: TangentPlane, low: FloatArray, top: float, step: FloatArray) -> Faces:
    """Faces of a part with the samples as pixels; rows count downwards."""
    point, _ = _on_plane(one, plane)
    image = np.stack([point[:, 0] - low[0], top - point[:, 1]], axis=1) / step
    return faces_of(one.part.kind, point, image, 1e-9)


def _opacity(plume: Placed, direction: FloatArray, last: FloatArray | float, cover: Cover) -> FloatArray:
    """Share of the light behind a plume that it absorbs along directions up to ``last`` times their length [1]."""
    gas = plume.gas
    along = direction @ gas[3:12].reshape(3, 3).T
    square, part = (along**2).sum(axis=-1), along @ gas[:3]
    half = np.sqrt(np.maximum(part**2 - square * (gas[:3] @ gas[:3] - 1.0), 0.0))
    first, end = np.maximum((part - half) / square, 0.0), np.minimum((part + half) / square, last)
    inside = np.maximum(end - first, 0.0)
    share = inside * np.linalg.norm(direction, axis=-1) / gas[12] if gas[12] > 0.0 else 0.5 * inside * np.sqrt(square)
    return np.asarray(np.interp(np.sqrt(np.minimum(share, 1.0)), np.sqrt(chord_shares()), cover(plume.part.kind)))


def _middle(gas: FloatArray, direction: FloatArray) -> FloatArray:
    """Multiple of directions at which they are nearest to a plume's middle, in units of its semi-axes."""
    along = direction @ gas[3:12].reshape(3, 3).T
    return np.asarray(along @ gas[:3] / (along**2).sum(axis=-1))
