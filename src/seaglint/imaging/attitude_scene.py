"""Scene of a camera in any attitude, fixed or moving: the sweep's image resampled, and rays walked where the sweep does not serve.

A survey of all attitudes of the track (``AngleSurvey``) decides which directions are prepared. Each attitude has a plan: the pixels
that are resampled from the sweep and the pixels that are walked.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray, wrap_angle
from seaglint.base.errors import DomainError
from seaglint.facet.facet_tables import facet_slopes
from seaglint.facet.sea_view import SeaView
from seaglint.imaging import launch
from seaglint.imaging.camera.imager import (
    Attitude,
    Camera,
    Imager,
    Quads,
    Resampling,
    SweepGrid,
    cells_of,
    inside,
    pixel_elevations,
    pixel_pitch,
    quads,
)
from seaglint.imaging.camera.pose import Pose, Track
from seaglint.imaging.layers import COVERAGE, EMITTED, PATH, SKY, SUN, TOTAL, Layers, layers_of, planes_for, require_layers
from seaglint.imaging.rays import RayTables, ray_tables, rays_per_side
from seaglint.imaging.scene import CLEAR, Accuracy, Instant, Levels, require_columns, scene_foam
from seaglint.imaging.sparkle_settings import NO_SPARKLES, Sparkles
from seaglint.imaging.sun_in_sky import SunInSky, disc_in_pixels, sun_in_sky
from seaglint.imaging.upright_scene import SAME, SweptScene, beyond, require_above, require_dry
from seaglint.sea.foam.foam_field import FoamField
from seaglint.sea.foam.ship_foam import NO_SEGMENTS, FoamSegments
from seaglint.sea.wave_field import Detail, WaveField


@dataclass(frozen=True, eq=False)
class AngleSurvey:
    """Azimuth-elevation grid that serves all attitudes, and the directions of the pixels outside it, which are walked."""

    grid: Camera | None  #: The grid of the sweep; None where no pixel is swept.
    walk_from: float  #: Highest elevation of walked pixels [rad].
    walk_azimuths: tuple[float, float]  #: Least and greatest azimuth of walked pixels [rad].


def covers(prepared: AngleSurvey, requested: AngleSurvey) -> bool:
    """Return True if a prepared scene covers another camera."""
    one, other = prepared.grid, requested.grid
    if other is not None and (one is None or beyond(one, other) > SAME or other.row_step < one.row_step * (1.0 - SAME)):
        return False
    (left, right), (first, last) = prepared.walk_azimuths, requested.walk_azimuths
    if first == last:
        return True
    # azimuths are not wrapped: both ranges are compared in the same turn
    turn = 2.0 * np.pi * np.round((0.5 * (first + last) - 0.5 * (left + right)) / (2.0 * np.pi))
    around = right - left >= 2.0 * np.pi - SAME
    return requested.walk_from <= prepared.walk_from + SAME and (around or (left <= first - turn + SAME and last - turn <= right + SAME))


def corners_of(azimuth: FloatArray, swept: NDArray[np.bool_]) -> tuple[float, float]:
    """Return least and greatest azimuth of the corners of some pixels [rad]."""
    touched = np.zeros(azimuth.shape, bool)
    for rows in (slice(None, -1), slice(1, None)):
        for columns in (slice(None, -1), slice(1, None)):
            touched[rows, columns] |= swept
    return float(azimuth[touched].min()), float(azimuth[touched].max())


CACHED_HEIGHTS = 3  #: Number of prepared heights that are cached.

MOST_CACHED = (
    1 << 29
)  #: Size of resampling weights that are cached from frame to frame [bytes]; beyond it they are computed for every frame.

#: Cells of the sweep across a pixel of a picture that is drawn finer than the pixels that matter: four or more across those.
CELLS_OF_FINER = 2

NEAR_CIRCLE = np.radians(300.0)  #: Least range of azimuths for which the sweep's image covers the full circle [rad].


@dataclass(frozen=True, eq=False)
class _AttitudePlan:
    """Drawing plan of one attitude: pixels resampled from columns ``parts`` of the sweep's image, laid side by side, and pixels walked."""

    corner: FloatArray
    swept: NDArray[np.int64]
    parts: tuple[tuple[int, int], ...]
    quads: Quads | None
    cells: SweepGrid | None
    resampling: Resampling | None
    walked: NDArray[np.int64]
    samples: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class _Height:
    """Scene prepared for one sensor height: the sweep's, if any pixel is swept, and what rays need, prepared on first use.

    ``rays`` and ``sun`` do not depend on the seed: other realisations of the sea share them. ``moonlit`` has both of the Moon where it is
    a second light.
    """

    view: SeaView
    swept: SweptScene | None
    rays: Callable[[], RayTables]
    sun: Callable[[], SunInSky]
    moonlit: tuple[Callable[[], RayTables], Callable[[], SunInSky]] | None = None


@dataclass(frozen=True, eq=False)
class TurnedScene:
    """Scene prepared for a camera in any attitude on a track; make it with :meth:`prepare`.

    Notes
    -----
    The air is prepared at heights at most 2 % apart; a frame takes the air of the next lower height and the geometry of its exact height.
    Tables of the last heights are cached for the next frames; images do not depend on the cache.
    """

    imager: Imager  #: The camera's pixels.
    track: Track  #: Where the camera is and how it is turned.
    waves: WaveField | None  #: The part of the slopes that is geometry.
    accuracy: Accuracy  #: Accuracy settings of the drawing.
    layers: tuple[str, ...]  #: Layers beside ``radiance`` and ``glint_radiance``.
    sparkles: Sparkles  #: Glint below the pixel.
    _view_at: Callable[[float], SeaView]
    _survey: AngleSurvey
    _whole: Levels  #: Sea in full detail, for views that are walked alone.
    breaking: FoamField | None = None  #: Breaking waves, for views with foam.
    _finer: int = 1  #: Pixels along a side of the pixels that the accuracy settings refer to.
    _still: _AttitudePlan | None = None
    _heights: OrderedDict[float, _Height] = field(default_factory=OrderedDict)

    @classmethod
    def prepare(
        cls,
        view_at: Callable[[float], SeaView],
        imager: Imager,
        track: Track,
        waves: WaveField | None = None,
        *,
        accuracy: Accuracy | None = None,
        layers: Collection[str] = (),
        sparkles: Sparkles = NO_SPARKLES,
        finer: int = 1,
        breaking: FoamField | None = None,
    ) -> TurnedScene:
        """Prepare everything that does not depend on the instant.

        Parameters
        ----------
        view_at : callable
            ``view_at(height)`` is the ``SeaView`` of a sensor height [m].
        imager, track, waves, accuracy, layers, sparkles, breaking
            See the attributes.
        finer : int
            As of :meth:`seaglint.imaging.upright_scene.SweptScene.prepare`. The pixels of a finer picture consist of
            ``CELLS_OF_FINER`` cells of the sweep, if the accuracy settings have more.

        Raises
        ------
        DomainError
            As :meth:`seaglint.imaging.upright_scene.SweptScene.prepare`.
        """
        names, whole = require_layers(layers), Levels.calm()
        if waves is not None:
            require_dry(track.lowest, waves)
            whole = replace(whole, detail=Detail.of(waves, 1))
        nothing = AngleSurvey(None, 0.0, (0.0, 0.0))
        settings = accuracy or Accuracy()
        if finer > 1:
            settings = replace(settings, oversampling=min(settings.oversampling, CELLS_OF_FINER))
        empty = cls(imager, track, waves, settings, names, sparkles, view_at, nothing, whole, breaking, finer)
        return empty._for(imager)

    def _for(self, imager: Imager) -> TurnedScene:
        attitudes = self.track.attitudes()
        changed = replace(self, imager=imager, _heights=OrderedDict())
        surveyed = replace(changed, _survey=changed._surveyed(attitudes, self.accuracy.oversampling))
        return surveyed if self.track.turns else replace(surveyed, _still=surveyed._plan(attitudes[0]))

    @property
    def view(self) -> SeaView:
        """Sea, air and Sun at the sensor's first height."""
        return self._prepared(self.pose.height).view

    @property
    def pose(self) -> Pose:
        """Pose at the beginning of the track."""
        return self.track.at(float(self.track.time[0]))

    @property
    def cells(self) -> float:
        """Side of the sweep's cells from which pixels are averaged [rad]; 0 where pixels are walked."""
        grid, (first, last) = self._survey.grid, self._survey.walk_azimuths
        return 0.0 if grid is None or first != last else grid.row_step

    @property
    def report(self) -> Mapping[str, Any]:
        """Settings of the sweep and of the resampling, for the provenance of a file."""
        swept, grid = self._prepared(self.pose.height).swept, self._survey.grid
        cells = [grid.columns, grid.rows] if grid is not None else []
        walked = {} if self._still is None else {"pixels_walked": int(self._still.walked.size)}
        return {**(swept.report if swept is not None else {}), "sweep_cells": cells, **walked}

    def with_camera(self, imager: Imager) -> TurnedScene:
        """Return this scene through another camera on the same track, without new tables.

        Raises
        ------
        DomainError
            Pixels finer than those prepared, or a view beyond it.
        """
        surveyed, prepared = self._for(imager)._survey, self._survey
        if not covers(prepared, surveyed):
            raise DomainError(
                "the camera looks beyond the view that the scene was prepared for, or has finer pixels; stay inside it or prepare a scene "
                "for this camera"
            )
        other = replace(self, imager=imager, _still=None)
        return other if self.track.turns else replace(other, _still=other._plan(self.track.attitudes()[0]))

    def reseeded(self, seed: int) -> Self:
        """Return another realisation of the same sea, sparkles included, without preparing anything again."""
        waves = self.waves.reseeded(seed) if self.waves is not None else None
        whole = self._whole if waves is None else replace(self._whole, detail=Detail.of(waves, 1))
        heights = OrderedDict((at, replace(h, swept=h.swept and h.swept.reseeded(seed))) for at, h in self._heights.items())
        breaking = self.breaking if self.breaking is None or waves is None else self.breaking.reseeded(waves, seed)
        return replace(self, waves=waves, sparkles=self.sparkles.reseeded(seed), breaking=breaking, _whole=whole, _heights=heights)

    def _surveyed(self, attitudes: list[Attitude], oversampling: int) -> AngleSurvey:
        """Return the azimuth-elevation grid that serves all attitudes, and the directions of the pixels that are walked."""
        pitch = np.inf
        reach, azimuths, walked, walk_from = [], [], [], math.radians(-89.0)
        for attitude in attitudes:
            corner = self.imager.corners(attitude)
            least, median = pixel_pitch(corner)
            # a few very small pixels, as at the nadir of equal angles, must not decide the size of the grid
            pitch = min(pitch, max(least, 0.5 * median))
            low, high = pixel_elevations(corner)
            swept = self._serves(low, high)
            azimuth = attitude.azimuth + wrap_angle(np.arctan2(corner[..., 0], corner[..., 1]) - attitude.azimuth)
            if swept.any():
                reach.append((float(low[swept].min()), float(high[swept].max())))
                azimuths.append(corners_of(azimuth, swept))
            down = ~swept & (low < 0.0)
            if down.any():
                walk_from = max(walk_from, float(high[down].max()))
                walked.append(corners_of(azimuth, down))
        walk_azimuths = (min(a[0] for a in walked) - 0.1, max(a[1] for a in walked) + 0.1) if walked else (0.0, 0.0)
        if walk_azimuths[1] - walk_azimuths[0] > np.pi:  # under the sensor there are all azimuths
            walk_azimuths = (-np.pi, np.pi)
        if not reach:
            return AngleSurvey(None, walk_from, walk_azimuths)
        # a corner on the grid's own edge must not fall out by rounding
        margin = math.radians(0.5) if self.track.turns else 1e-9
        bottom, top = max(min(r[0] for r in reach), self.accuracy.walk_below) - margin, max(r[1] for r in reach) + margin
        row_step = pitch / oversampling
        rows = max(math.ceil((top - bottom) / row_step), 1)
        # a pixel is widest in azimuth where it is farthest from the horizontal; the finest required one is nearest to it
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
        return AngleSurvey(grid, walk_from + margin, walk_azimuths)

    @property
    def _crest(self) -> float:
        return self.accuracy.crest * self.waves.significant_height if self.waves is not None else 0.0

    @property
    def _shortest_wave(self) -> float:
        return 2.0 * np.pi / self.waves.tiles[-1].k_max if self.waves is not None else np.inf

    def _serves(self, low: FloatArray, high: FloatArray) -> NDArray[np.bool_]:
        """Return True if the sweep serves pixels between two elevations [rad]: at the sea or near the horizon, and not too steep."""
        # a little above the horizontal, so that a pixel cut by it is one of the sweep's
        highest = math.radians(60.0) if self.track.lowest <= self._crest else 0.0
        return np.asarray((low >= self.accuracy.walk_below) & (low < highest) & (high <= highest + math.radians(20.0)))

    def _plan(self, attitude: Attitude, part: tuple[int, int] | None = None) -> _AttitudePlan:
        first, end = part or (0, self.imager.columns)
        corner = self.imager.directions(attitude, np.arange(first, end + 1.0), np.arange(self.imager.rows + 1.0)[:, None])
        swept = self._serves(*pixel_elevations(corner)).ravel()
        pixels = np.flatnonzero(swept)
        parts: tuple[tuple[int, int], ...] = ()
        quadrilaterals, cells, resampling = None, None, None
        if self._survey.grid is not None and pixels.size:
            grid = cells_of(self._survey.grid)
            every = quads(corner, pixels, grid, attitude.azimuth)
            covered = inside(every, grid)
            swept[pixels[~covered]] = False
            pixels = pixels[covered]
            if pixels.size:
                quadrilaterals, cells, parts = self._columns(every.some(covered), grid)
                if part is None and not self.track.turns and 8 * int(quadrilaterals.bound.sum()) <= MOST_CACHED:
                    resampling = launch.weights_of(quadrilaterals, pixels, cells)
        walked = np.flatnonzero(~swept)
        samples = rays_per_side(corner, walked, self.track.highest, self._shortest_wave)
        return _AttitudePlan(corner, pixels, parts, quadrilaterals, cells, resampling, walked, samples)

    def _columns(self, quadrilaterals: Quads, grid: SweepGrid) -> tuple[Quads, SweepGrid, tuple[tuple[int, int], ...]]:
        """Return quadrilaterals counted from the first column that they touch, the cells of these columns, and their parts of the grid.

        A part is ``(first, end)`` in columns of the grid. Beyond the end of a full circle its beginning follows, so there may be two parts.
        """
        first, last = math.floor(quadrilaterals.column.min()), math.ceil(quadrilaterals.column.max())
        if grid.circle and last - first >= grid.columns:
            return quadrilaterals, grid, ((0, grid.columns),)
        if not grid.circle:
            first, last = max(first, 0), min(last, grid.columns)
        wide = last - first
        cells = grid._replace(middle=grid.middle + (0.5 * (first + last) - 0.5 * grid.columns) * grid.step, columns=wide, circle=False)
        begin = first % grid.columns
        before_end = min(wide, grid.columns - begin)
        parts = [(begin, begin + before_end)] + ([(0, wide - before_end)] if wide > before_end else [])
        return quadrilaterals._replace(column=quadrilaterals.column - first), cells, tuple(parts)

    def _node(self, eye: float) -> float:
        """Return the height at which the air is prepared for a sensor height [m]: the next lower of a fixed series."""
        if self.track.highest == self.track.lowest:
            return eye
        # powers of one ratio, whatever the track: a frame has the same air alone and in its sequence
        ratio = self.accuracy.height_step
        return max(ratio ** math.floor(math.log(eye) / math.log(ratio) + 1e-9), self.track.lowest)

    def _prepared(self, eye: float) -> _Height:
        at, grid = self._node(eye), self._survey.grid
        if at in self._heights:
            self._heights.move_to_end(at)
            return self._heights[at]
        view, swept = self._view_at(at), None
        if grid is not None:
            swept = SweptScene.prepare(
                view,
                replace(grid, height=at),
                self.waves,
                accuracy=self.accuracy,
                layers=self.layers,
                sparkles=self.sparkles,
                finer=self._finer * self.accuracy.oversampling,
                breaking=self.breaking,
            )
        first, second = view.lights
        moonlit = None if second is None else (cache(partial(self._rays, second)), cache(partial(sun_in_sky, second)))
        self._heights[at] = _Height(first, swept, cache(partial(self._rays, first)), cache(partial(sun_in_sky, first)), moonlit)
        while len(self._heights) > CACHED_HEIGHTS:
            self._heights.popitem(last=False)
        return self._heights[at]

    def _rays(self, view: SeaView) -> RayTables:
        waves, survey = self.waves, self._survey
        resolved = waves.resolved_mss() if waves is not None else (0.0, 0.0)
        towards = waves.spectrum.wind_to_azimuth if waves is not None else view.slopes.wind_to_azimuth
        return ray_tables(
            view,
            facet_slopes(view.slopes, resolved, towards, waves.resolved_covariance() if waves is not None else 0.0),
            resolved,
            self._crest,
            survey.walk_from,
            survey.walk_azimuths,
            emitted=bool({"emitted_radiance", "sky_radiance"} & set(self.layers)),
        )

    def _require_pose(self, pose: Pose) -> None:
        """Raise for heights and attitudes off the prepared track."""
        low, high = self.track.lowest, self.track.highest
        if not low * (1.0 - SAME) <= pose.height <= high * (1.0 + SAME) or not np.isfinite(pose.east + pose.north):
            raise DomainError(
                f"pose at {pose.height:g} m, {pose.east:g} m east, {pose.north:g} m north: this scene was prepared for {low:g} to {high:g} "
                "m; stay on its track or prepare a scene for another",
                name="sensor_height",
                value=pose.height,
                allowed=(low, high),
            )
        own = (pose.attitude.azimuth, pose.attitude.elevation, pose.attitude.roll)
        outside = 0.0
        for angle, (first, last) in zip(own, self.track.reach(), strict=True):
            middle = 0.5 * (first + last)
            outside = max(outside, abs(float(wrap_angle(angle - middle))) - 0.5 * (last - first))
        # turning tracks were surveyed with half a degree to spare
        if outside > (math.radians(0.5) if self.track.turns else SAME):
            raise DomainError(
                f"pose turned {np.degrees(outside):.4g} deg off the attitudes that this scene was prepared for; prepare one with a track "
                "that has it, or see with_camera for other cameras"
            )

    @property
    def pixels(self) -> Imager:
        """Pixels of the camera."""
        return self.imager

    def directions(self, pose: Pose) -> tuple[FloatArray, FloatArray]:
        """Return azimuth and elevation of all pixel centres [rad, (rows, columns)]."""
        return self.imager.centres(pose.attitude)

    def seen_from(self, pose: Pose) -> SeaView:
        """Return the view of sea, air and Sun from the height of a pose."""
        return self._prepared(pose.height).view

    def sea(self, pose: Pose, time: float, ships: FoamSegments | None = NO_SEGMENTS) -> Instant:
        """Return the sea of an instant under a sensor, with the foam of ships, or without any foam."""
        prepared = self._prepared(pose.height)
        levels = prepared.swept.levels if prepared.swept is not None else self._whole
        lattices = levels.lattices(time)
        foam = CLEAR if ships is None else scene_foam(prepared.view, self.breaking).at(time, ships)
        return Instant(levels, lattices, levels.surface(lattices, (pose.east, pose.north), foam))

    def drawn(self, pose: Pose, time: float, sea: Instant | None = None) -> Layers:
        """Return the image from a pose at a time [s]."""
        self._require_pose(pose)
        return self._drawn(pose, time, self._still if self._still is not None else self._plan(pose.attitude), sea)

    def columns(self, pose: Pose, time: float, part: tuple[int, int], sea: Instant | None = None) -> Layers:
        """Return the image of the columns ``part = (first, end)`` alone, equal to these columns of the whole image but for rounding.

        Raises
        ------
        DomainError
            Columns outside the image.
        """
        require_columns(part, self.imager.columns)
        self._require_pose(pose)
        return self._drawn(pose, time, self._plan(pose.attitude, part), sea)

    def _drawn(self, pose: Pose, time: float, plan: _AttitudePlan, sea: Instant | None) -> Layers:
        prepared, kinds = self._prepared(pose.height), planes_for(self.layers)
        levels, lattices, surface = sea or self.sea(pose, time)
        require_above(launch.foot_height(surface), pose.height, time)
        columns = plan.corner.shape[1] - 1
        out = np.zeros((kinds.size, self.imager.rows * columns), np.float32)
        if plan.swept.size and prepared.swept is not None:
            scene = prepared.swept.with_camera(replace(prepared.swept.camera, height=pose.height))
            upright = replace(scene.pose, east=pose.east, north=pose.north)
            _resample(plan, np.concatenate([scene.planes(upright, time, surface, part) for part in plan.parts], axis=2), out)
        if plan.walked.size:
            bounds = levels.bounds(lattices)

            def walked(rays: RayTables, sun: SunInSky) -> FloatArray:
                channels = launch.pixels_of_rays(rays, surface, bounds, pose.height, plan.corner, plan.walked, plan.samples)
                channels[:, TOTAL] += disc_in_pixels(sun, plan.corner, plan.walked) * (1.0 - channels[:, COVERAGE])
                return channels

            channels = walked(prepared.rays(), prepared.sun())
            if prepared.moonlit is not None:
                more = walked(prepared.moonlit[0](), prepared.moonlit[1]())
                channels[:, (TOTAL, SUN)] += more[:, (TOTAL, SUN)]
            sky = channels[:, TOTAL] - channels[:, SUN] - channels[:, EMITTED] - channels[:, PATH]
            for k, kind in enumerate(kinds):
                out[k, plan.walked] = sky if kind == SKY else channels[:, kind]
        return layers_of(out.reshape(-1, self.imager.rows, columns), kinds, self.layers)


def _resample(plan: _AttitudePlan, images: NDArray[np.float32], out: NDArray[np.float32]) -> None:
    """Resample images of the sweep's cells (planes, rows, columns) into the camera's pixels (planes, pixels)."""
    if plan.resampling is not None:
        launch.resample(plan.resampling, images, out)
        return
    assert plan.quads is not None  # where pixels are swept there are these
    assert plan.cells is not None
    launch.resample_once(plan.quads, plan.swept, plan.cells, images, out)
