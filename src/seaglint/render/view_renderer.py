"""Frames through a camera in any attitude, standing or moving: the sweep's image resampled, and rays walked where it does not serve."""

from __future__ import annotations

import copy
import math
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from seaglint.conventions import FloatArray, wrap_angle
from seaglint.errors import DomainError
from seaglint.radiance.mean import SeaView
from seaglint.render.camera import Camera
from seaglint.render.direct import DirectWalk, Eye, lattices_of, rays_per_side, read
from seaglint.render.platform import Pose, Track
from seaglint.render.renderer import CREST, SHORTEST_WAVE_COLUMNS, SUBMERGED, Radiances, Renderer, facet_slopes, require_above
from seaglint.render.sparkle import Sparkles, sparkle_rows
from seaglint.render.sweep import sight_lines
from seaglint.render.view import (
    Attitude,
    Cells,
    Imager,
    Quads,
    Resampling,
    cells_of,
    inside,
    pixel_elevations,
    pixel_pitch,
    quads,
    resample_at_once,
)
from seaglint.sea.field import WaveField

SWEEP_LOWEST = np.radians(-40.0)
"""Elevation from which on downwards rays are walked: they are cheap there, and columns of equal azimuth get narrow."""

OVERSAMPLING = 3
"""Cells of the sweep across a pixel of the camera: waves of a pixel's size keep 96 % of their variance (two: 93 %, four: 97 %)."""

HEIGHT_STEP = 1.02
"""Ratio of the sensor heights for which the air is prepared."""

KEPT_HEIGHTS = 3
"""Heights prepared that are kept."""

MOST_KEPT = 1 << 29
"""Bytes of weights that are kept from frame to frame; beyond it they are computed for every frame."""

NEAR_CIRCLE = np.radians(300.0)
"""Range of azimuths from which the sweep's image goes all round."""


@dataclass(frozen=True, eq=False)
class _Plan:
    """What one attitude needs: pixels resampled from columns of the sweep's image (``eyes`` lie side by side), and pixels walked."""

    corner: FloatArray
    swept: NDArray[np.int64]
    eyes: tuple[Camera, ...]
    quads: Quads | None
    cells: Cells | None
    resampling: Resampling | None
    walked: NDArray[np.int64]
    samples: NDArray[np.int64]


class ViewRenderer:
    """Renders frames of one sea through a camera in any attitude on a track.

    Parameters
    ----------
    view_at : callable
        ``view_at(height)`` is the :class:`~seaglint.radiance.mean.SeaView` of a sensor height [m].
    imager : Imager
        The camera's pixels.
    track : Track
        Where the camera is and how it is turned.
    waves : WaveField, optional
        The part of the slopes that is geometry.
    step, most_lines, shortest_wave_columns, sparkles
        As of :class:`~seaglint.render.renderer.Renderer`.
    oversampling : int
        Cells of the sweep across a pixel.
    lowest : float
        Elevation from which on downwards rays are walked [rad].

    Notes
    -----
    The air is prepared at heights at most 2 % apart and taken from the next lower one; the geometry is that of each frame.
    """

    def __init__(
        self,
        view_at: Callable[[float], SeaView],
        imager: Imager,
        track: Track,
        waves: WaveField | None = None,
        *,
        step: float | None = None,
        most_lines: int = 2,
        shortest_wave_columns: float = SHORTEST_WAVE_COLUMNS,
        sparkles: Sparkles | None = None,
        oversampling: int = OVERSAMPLING,
        lowest: float = SWEEP_LOWEST,
    ) -> None:
        self.imager, self.track, self.waves = imager, track, waves
        self._view_at, self._lowest = view_at, lowest
        # as many lines in a pixel of the camera, whatever the cells
        self._options: dict[str, Any] = {
            "step": step,
            "most_lines": max(most_lines >> (oversampling.bit_length() - 1), 1),
            "shortest_wave_columns": shortest_wave_columns * oversampling,
            "sparkles": sparkles,
        }
        self._crest = CREST * waves.significant_height if waves is not None else 0.0
        if waves is not None and track.lowest < SUBMERGED * waves.significant_height:
            raise DomainError(
                f"sensor height = {track.lowest:g} m is within reach of the waves (significant height {waves.significant_height:.2f} m); "
                f"place it above {SUBMERGED * waves.significant_height:.2f} m or do not resolve waves (sea.resolve_waves = false)",
                name="sensor_height",
                value=track.lowest,
                allowed=f"above {SUBMERGED * waves.significant_height:.2f} m",
            )
        self.shortest_wave = 2.0 * np.pi / waves.tiles[-1].k_max if waves is not None else np.inf
        self._highest = math.radians(60.0) if track.lowest <= self._crest else 0.0
        attitudes = track.attitudes()
        self.camera, self._walk_from, self._walk_azimuths = self._survey(attitudes, oversampling)
        self._heights: OrderedDict[float, tuple[SeaView, Renderer | None, list[DirectWalk]]] = OrderedDict()
        self._still = None if track.turns else self._plan(attitudes[0])
        self.view = self._prepared(track.at(float(track.time[0])).height)[0]

    @property
    def report(self) -> dict[str, Any]:
        """Settings of the sweep and of the resampling, for the provenance."""
        found = next(reversed(self._heights.values()))[1]
        swept = found.report if found is not None else {}
        cells = [self.camera.columns, self.camera.rows] if self.camera is not None else []
        walked = self._still.walked.size if self._still is not None else None
        return {**swept, "sweep_cells": cells} | ({} if walked is None else {"pixels_walked": int(walked)})

    def _survey(self, attitudes: list[Attitude], oversampling: int) -> tuple[Camera | None, float, tuple[float, float]]:
        """The azimuth-elevation grid that serves all attitudes; the highest elevation and the azimuths of the pixels that it does not."""
        pitch = np.inf
        reach, azimuths, walked, walk_from = [], [], [], math.radians(-89.0)
        for attitude in attitudes:
            corner = self.imager.corners(attitude)
            least, median = pixel_pitch(corner)
            pitch = min(pitch, max(least, 0.5 * median))
            low, high = pixel_elevations(corner)
            swept = self._serves(low, high)
            azimuth = attitude.azimuth + wrap_angle(np.arctan2(corner[..., 0], corner[..., 1]) - attitude.azimuth)
            if swept.any():
                reach.append((float(low[swept].min()), float(high[swept].max())))
                azimuths.append(_corners_of(azimuth, swept))
            down = ~swept & (low < 0.0)
            if down.any():
                walk_from = max(walk_from, float(high[down].max()))
                walked.append(_corners_of(azimuth, down))
        walk_azimuths = (min(a[0] for a in walked) - 0.1, max(a[1] for a in walked) + 0.1) if walked else (0.0, 0.0)
        if walk_azimuths[1] - walk_azimuths[0] > np.pi:  # under the sensor there are all azimuths
            walk_azimuths = (-np.pi, np.pi)
        if not reach:
            return None, walk_from, walk_azimuths
        # a corner on the grid's own edge must not fall out by rounding
        margin = math.radians(0.5) if self.track.turns else 1e-9
        bottom, top = max(min(r[0] for r in reach), self._lowest) - margin, max(r[1] for r in reach) + margin
        row_step = pitch / oversampling
        rows = max(math.ceil((top - bottom) / row_step), 1)
        # a pixel is widest in azimuth where it is farthest from the horizontal; the finest wanted is nearest to it
        nearest = 0.0 if bottom <= 0.0 <= top else min(abs(bottom), abs(top))
        column_step = row_step / math.cos(nearest)
        left, right = min(a[0] for a in azimuths) - margin, max(a[1] for a in azimuths) + margin
        height = self.track.lowest
        if right - left >= NEAR_CIRCLE:
            columns = math.ceil(2.0 * np.pi / column_step)
            grid = Camera(height, 0.5 * (left + right), 0.5 * (top + bottom), 2.0 * np.pi, rows * row_step, columns, rows)
        else:
            columns = max(math.ceil((right - left) / column_step), 1)
            grid = Camera(height, 0.5 * (left + right), 0.5 * (top + bottom), columns * column_step, rows * row_step, columns, rows)
        return grid, walk_from + margin, walk_azimuths

    def _serves(self, low: FloatArray, high: FloatArray) -> NDArray[np.bool_]:
        """Whether the sweep serves pixels between two elevations [rad]: where it may see the sea, and not too steeply."""
        # a little above the horizontal, so that a pixel cut by it is one of the sweep's
        return np.asarray((low >= self._lowest) & (low < self._highest) & (high <= self._highest + math.radians(20.0)))

    def _plan(self, attitude: Attitude) -> _Plan:
        corner = self.imager.corners(attitude)
        swept = self._serves(*pixel_elevations(corner)).ravel()
        pixels = np.flatnonzero(swept)
        eyes: tuple[Camera, ...] = ()
        found, cells, resampling = None, None, None
        if self.camera is not None and pixels.size:
            grid = cells_of(self.camera)
            every = quads(corner, pixels, grid, attitude.azimuth)
            covered = inside(every, grid)
            swept[pixels[~covered]] = False
            pixels = pixels[covered]
            if pixels.size:
                found, cells, eyes = self._columns(every.some(covered), grid)
                if not self.track.turns and 8 * int(found.bound.sum()) <= MOST_KEPT:
                    resampling = Resampling.of(found, pixels, cells)
        walked = np.flatnonzero(~swept)
        samples = rays_per_side(corner, walked, self.track.highest, self.shortest_wave)
        return _Plan(corner, pixels, eyes, found, cells, resampling, walked, samples)

    def _columns(self, found: Quads, grid: Cells) -> tuple[Quads, Cells, tuple[Camera, ...]]:
        """The columns that quadrilaterals touch: these counted from the first of them, their cells, and the cameras that make them.

        Beyond the end of a grid that goes round its beginning follows.
        """
        assert self.camera is not None
        first, last = math.floor(found.column.min()), math.ceil(found.column.max())
        if grid.circle and last - first >= grid.columns:
            return found, grid, (self.camera,)
        if not grid.circle:
            first, last = max(first, 0), min(last, grid.columns)
        wide = last - first
        cells = grid._replace(middle=grid.middle + (0.5 * (first + last) - 0.5 * grid.columns) * grid.step, columns=wide, circle=False)
        begin = first % grid.columns
        there = min(wide, grid.columns - begin)
        parts = [(begin, there)] + ([(0, wide - there)] if wide > there else [])
        return found._replace(column=found.column - first), cells, tuple(_columns_of(self.camera, *part) for part in parts)

    def _node(self, height: float) -> float:
        """Height at which the air is prepared for a sensor height [m]: the next lower of a fixed series."""
        if self.track.highest == self.track.lowest:
            return height
        return max(HEIGHT_STEP ** math.floor(math.log(height) / math.log(HEIGHT_STEP) + 1e-9), self.track.lowest)

    def _prepared(self, height: float) -> tuple[SeaView, Renderer | None, list[DirectWalk]]:
        node = self._node(height)
        if node in self._heights:
            self._heights.move_to_end(node)
            return self._heights[node]
        view = self._view_at(node)
        renderer = None
        if self.camera is not None:
            renderer = Renderer(view, replace(self.camera, height=node), self.waves, **self._options)
        self._heights[node] = (view, renderer, [])
        while len(self._heights) > KEPT_HEIGHTS:
            self._heights.popitem(last=False)
        return self._heights[node]

    def _direct(self, height: float) -> DirectWalk:
        view, _, walks = self._prepared(height)
        if not walks:
            resolved = self.waves.resolved_mss() if self.waves is not None else (0.0, 0.0)
            wind = self.waves.spectrum.wind_to_azimuth if self.waves is not None else view.slopes.wind_to_azimuth
            facets = facet_slopes(view.slopes, resolved, wind)
            # steep rays: the facets' shadows on each other are few, Smith's law serves
            walks.append(DirectWalk.create(view, facets, resolved, self._crest, self._walk_from, self._walk_azimuths))
        return walks[0]

    def radiances(self, time: float) -> Radiances:
        """Render the instant ``time`` [s] from the start: a function of the scene, the track and the time alone.

        Raises
        ------
        DomainError
            If a crest stands above the sensor, or the track does not reach this time.
        """
        pose = self.track.at(time)
        plan = self._still if self._still is not None else self._plan(pose.attitude)
        out = np.zeros((2, self.imager.rows * self.imager.columns), np.float32)
        if plan.swept.size:
            self._sweep(plan, pose, time, out)
        if plan.walked.size:
            self._rays(plan, pose, time, out)
        total, sun = out.reshape(2, self.imager.rows, self.imager.columns)
        return Radiances(total, sun)

    def _sweep(self, plan: _Plan, pose: Pose, time: float, out: NDArray[np.float32]) -> None:
        renderer = self._prepared(pose.height)[1]
        assert renderer is not None
        parts = [swept_image(adapted(renderer, replace(eye, height=pose.height)), time, (pose.east, pose.north)) for eye in plan.eyes]
        images = np.stack([np.concatenate([getattr(part, name) for part in parts], axis=1) for name in ("total", "sun")])
        if plan.resampling is not None:
            plan.resampling(images, out)
        else:
            assert plan.quads is not None
            assert plan.cells is not None
            quad, most = plan.quads, int(plan.quads.bound.max())
            resample_at_once(quad.column, quad.sine, plan.cells, most, images.reshape(2, -1), plan.swept, out)

    def _rays(self, plan: _Plan, pose: Pose, time: float, out: NDArray[np.float32]) -> None:
        walk = self._direct(pose.height)
        tiles = self.waves.tiles if self.waves is not None else ()
        heights = self.waves.surfaces(time, workers=numba.get_num_threads()) if self.waves is not None else ()
        sea = lattices_of(heights, np.array([t.spacing for t in tiles]), np.array([t.rotation for t in tiles]))
        foot = np.zeros(1)
        read(sea, pose.east, pose.north, 0, foot)
        require_above(foot[0], pose.height, time)
        walk(sea, Eye(pose.east, pose.north, pose.height), plan.corner, plan.walked, plan.samples, out)


def _corners_of(azimuth: FloatArray, swept: NDArray[np.bool_]) -> tuple[float, float]:
    """Least and greatest azimuth of the corners of some pixels [rad]."""
    touched = np.zeros(azimuth.shape, bool)
    for rows in (slice(None, -1), slice(1, None)):
        for columns in (slice(None, -1), slice(1, None)):
            touched[rows, columns] |= swept
    return float(azimuth[touched].min()), float(azimuth[touched].max())


def _columns_of(camera: Camera, first: int, columns: int) -> Camera:
    """The camera with some of its columns only."""
    if columns == camera.columns:
        return camera
    left = camera.azimuth - 0.5 * camera.width + first * camera.column_step
    return replace(camera, azimuth=left + 0.5 * columns * camera.column_step, width=columns * camera.column_step, columns=columns)


def adapted(renderer: Renderer, eye: Camera) -> Renderer:
    """The renderer with some of its columns, from a height a little above its own: the geometry is the eye's, tables are shared."""
    if eye == renderer.camera:
        return renderer
    out = copy.copy(renderer)
    out.camera = eye
    out._sparkle_rows = sparkle_rows(eye)
    walk = out._walk
    if walk is not None and eye.height != renderer.camera.height:
        rise, fall = sight_lines(walk.range_m, eye.height)
        out._walk = walk._replace(rise=rise, fall=fall)
    return out


def swept_image(renderer: Renderer, time: float, origin: tuple[float, float]) -> Radiances:
    """The sweep's image with the sensor's foot at ``origin`` (east, north) [m]."""
    if origin == (0.0, 0.0):
        return renderer.radiances(time)
    return renderer.radiances(time, origin=origin)
