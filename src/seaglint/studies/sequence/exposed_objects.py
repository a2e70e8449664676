"""Objects of a scenario on a detector's pixels during an exposure.

An ``ExposurePlan`` has the place, time and instants of each part of each object. ``ExposedObjects`` adds their light at these
places, blurred by the optics, over a sea that is also blurred by the platform's motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.reports import REPORTS
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.camera.imager import Imager
from seaglint.imaging.camera.pose import Pose, Track
from seaglint.imaging.refraction import RefractedScene
from seaglint.imaging.scene import Levels, Scene
from seaglint.imaging.wave_surface import Surface
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.local_light import (
    Backdrop,
    Boxes,
    Instants,
    LensShift,
    LocalLight,
    PictureWindow,
    add_window,
    behind,
    count_pixels,
    part_of,
    sum_of,
)
from seaglint.instrument.scan import ScanPattern
from seaglint.objects.drawing import sample_sums
from seaglint.objects.drawing.compose import BodyShare, BodySight, point_light, refracted_picture, sights
from seaglint.objects.drawing.draw import Drawer, DrawnBodies, PixelPatch, Stage, near
from seaglint.objects.drawing.eye import FEWEST_CELLS
from seaglint.objects.drawing.image_path import BEHIND, SHORT, ImagePath, Streak, View, finer, middle_of, place_in_image, stages
from seaglint.objects.drawing.light import Surroundings
from seaglint.objects.drawing.prepared_bodies import Placed
from seaglint.studies.sequence.scene_objects import SceneObjects

SEGMENT: Final = 0.25  #: Longest motion of an object between two pairs of instants [pixels].

MOST_INSTANTS: Final = 8192  #: Largest number of instants of an exposure: 1000 pixels of motion in the picture.

APART: Final = 0.25  #: Motion between two drawings of bodies that cross each other or the picture's edge [pixels].

MOST_MEETINGS: Final = 128  #: Largest number of these instants in an exposure.

CROSSINGS: Final = 64  #: Number of parts of a readout among which the one that passes a body is sought.

BOXES_ACROSS: Final = 24  #: Least number of boxes of light across an object.

LARGE: Final = 128.0  #: Size from which an object is drawn in pixels that just resolve the optics' cut-off [pixels].

IN_STEP: Final = 0.05  #: Motion of an object within which rows or columns of a picture count as of one instant [pixels].

#: Sums that are averaged over the instants of an exposure.
SUMMED: Final = [sample_sums.SEEN, sample_sums.DRY_INSIDE, sample_sums.DRY_SEEN]

#: Coverage of a pixel, relative to the largest, above which an object touches it: boxes of light reach a little beyond its outline.
TOUCHED: Final = 1e-3

_GAUSS: Final = 0.5 / math.sqrt(3.0)  #: Places of a pair of instants about the middle of its segment.

_NO_PIXELS: Final = np.zeros(0, np.int64)
_NO_LIGHT: Final = np.zeros((0, 0))
_NO_SHARE: Final = BodyShare(_NO_PIXELS, _NO_PIXELS, _NO_LIGHT, _NO_LIGHT, _NO_LIGHT, _NO_LIGHT)


@dataclass(frozen=True, eq=False)
class Drawing:
    """A part to draw: number, path, delay of its row or column, instants about that delay, and the instant of its drawing [s].

    ``image``: number of its image, of several in a mirage.
    """

    part: int
    path: ImagePath
    delay: float
    times: FloatArray
    weights: FloatArray
    drawn_at: float
    image: int = 0


@dataclass(frozen=True, eq=False)
class ExposurePlan:
    """Exposures of a camera over objects."""

    drawer: Drawer  #: The objects.
    view: View  #: Camera of the detector's pixels.
    model: SensorModel  #: The sensor.
    scan: ScanPattern  #: When rows and columns are taken.
    margin: int  #: Pixels beyond the picture from which blur comes into it.
    _seen_fast: set[str] = field(default_factory=set, repr=False)

    @property
    def _circle(self) -> bool:
        return self.view.imager.goes_round

    @cached_property
    def delays(self) -> tuple[FloatArray | None, FloatArray | None]:
        """Return the time of each row and of each column after the frame's [s]; None if all have one."""
        rows, columns = self.scan.row_delays(self.view.imager.rows), self.scan.column_delays(self.view.imager.columns)
        return (rows if rows.any() else None), (columns if columns.any() else None)

    def _delay(self, column: float, row: float) -> float:
        """Return the time after the frame's at which an image point is taken [s]."""
        down, across = self.delays
        if down is not None:
            return float(np.interp(row - 0.5, np.arange(down.size), down))
        if across is not None:
            return float(np.interp((column - 0.5) % across.size if self._circle else column - 0.5, np.arange(across.size), across))
        return 0.0

    @cached_property
    def _longest(self) -> float:
        """Return the time from the first to the last row or column [s]; 0 if all are taken at once."""
        return max((float(delays.max()) for delays in self.delays if delays is not None), default=0.0)

    def _met(self, place: Callable[[float], tuple[float, float]]) -> float:
        """Return the time after the frame's at which the readout passes an object with column and row ``place`` of that time [s].

        The first crossing between two rows or columns, refined by bisection; without a crossing, the time at which its first place is
        taken.
        """
        if self._longest == 0.0:
            return 0.0

        def ahead(delay: float) -> float:
            return self._delay(*place(delay)) - delay

        ends = np.linspace(0.0, self._longest, CROSSINGS + 1)
        signs = [ahead(float(delay)) for delay in ends]
        for k in range(CROSSINGS):
            if signs[k] >= 0.0 >= signs[k + 1]:
                low, high = float(ends[k]), float(ends[k + 1])
                # 40 halvings resolve a part of the readout to its last bits.
                for _ in range(40):
                    # `ahead` falls through zero where the readout meets the object.
                    half = 0.5 * (low + high)
                    low, high = (half, high) if ahead(half) > 0.0 else (low, half)
                return 0.5 * (low + high)
        return signs[0]

    def _meeting_and_path(self, part: int, time: float) -> tuple[float, ImagePath]:
        """Return the time after the frame's at which the readout passes a part [s], and its path about that time."""
        drawn = self.drawer.parts[part]
        motion = self.drawer.bodies[drawn.body].motion
        middle, about = middle_of(drawn), 0.5 * self.view.imager.columns
        first, last = self.view.known(motion)

        def place(delay: float) -> tuple[float, float]:
            return place_in_image(self.view, motion, middle, min(max(time + delay, first), last), about)

        delay = self._met(place)
        # The path must cover the exposure of every row or column that may see the part.
        spare = max(0.5 * self.model.exposure_time, SHORT) + self._longest
        times = (time + delay - spare, time + delay + spare)
        return delay, ImagePath.of(self.view, motion, middle, times, place(delay)[0])

    def drawings(self, time: float) -> list[Drawing]:
        """Return the parts to draw in a frame, each in one or several shapes."""
        exposure = self.model.exposure_time
        out, meetings_and_paths = [], [self._meeting_and_path(number, time) for number in range(len(self.drawer.parts))]
        meetings = self._meetings(time, meetings_and_paths)
        for number, (part, (delay, path)) in enumerate(zip(self.drawer.parts, meetings_and_paths, strict=True)):
            middle, count = time + delay, 1
            if exposure > 0.0:
                ends = (middle - 0.5 * exposure, middle + 0.5 * exposure)
                about = float(path.at(np.array([middle]))[0, 0])
                count = max(stages(self.view, self.drawer.bodies[part.body].motion, part, ends, about), meetings[number])
                self._report(path, ends, part.name)
            for stage in range(count):
                begin = (stage / count - 0.5) * exposure
                times, weights = self._times(path, middle, begin, begin + exposure / count)
                out.append(Drawing(number, path, delay, times, weights / count, middle + begin + 0.5 * exposure / count))
        return out

    def _report(self, path: ImagePath, ends: tuple[float, float], name: str) -> None:
        """Report once a body that crosses more than the picture in an exposure."""
        places = path.at(np.linspace(*ends, 257))
        length = float(np.hypot(*np.diff(places[:, places[0] > BEHIND], axis=1)).sum())
        widest = max(self.view.imager.columns, self.view.imager.rows)
        if length > widest and name not in self._seen_fast:
            self._seen_fast.add(name)
            text = "object '%s' crosses %.0f pixels in an exposure, more than the picture is wide (%d): its streak reaches across it"
            REPORTS.warning(text, name, length, widest)

    def _meetings(self, time: float, delays_and_paths: Sequence[tuple[float, ImagePath]]) -> list[int]:
        """Return the number of instants at which each part is drawn, since in its exposure it meets another body or the picture's edge.

        The bodies in front of it, and its part of the picture, change with time: it moves ``APART`` between two instants.
        """
        # Nine instants bound the motion during an exposure.
        half = 0.5 * self.model.exposure_time * np.linspace(-1.0, 1.0, 9)
        bodies = [part.body for part in self.drawer.parts]
        motions = [path.at(time + delay + half) for delay, path in delays_and_paths]
        sizes = [one.angle / self.model.ifov + 1.0 for one in self.drawer.placed(self.view.pose(time), time)[1]]
        boxes = [(motion.min(axis=1) - size, motion.max(axis=1) + size) for motion, size in zip(motions, sizes, strict=True)]
        edge = np.array([self.view.imager.columns, self.view.imager.rows], np.float64)
        out = []
        for n, body in enumerate(bodies):
            low, high = boxes[n]
            motion = 0.0
            # A panorama has no left and right edge.
            sides = slice(1, 2) if self._circle else slice(0, 2)
            if (((low < 0.0) & (high > 0.0)) | ((low < edge) & (high > edge)))[sides].any():
                motion = float(np.hypot(*np.ptp(motions[n], axis=1)))
            for k, other in enumerate(bodies):
                if other != body and (boxes[k][0] < high).all() and (boxes[k][1] > low).all():
                    motion = max(motion, float(np.hypot(*np.ptp(motions[n] - motions[k], axis=1))))
            out.append(min(max(math.ceil(motion / APART), 1), MOST_MEETINGS))
        return out

    def _times(self, path: ImagePath, middle: float, begin: float, end: float) -> tuple[FloatArray, FloatArray]:
        """Return instants about the middle of an exposure [s] and their weights: Gauss-Legendre pairs on short segments.

        The instants of a body that crosses more than the picture are in the picture.
        """
        if end <= begin:
            return np.zeros(1), np.ones(1)
        # A coarse path decides whether the part is in front of the camera, and how far it moves.
        coarse = np.linspace(begin, end, 65)
        places = path.at(middle + coarse)
        front = places[0] > BEHIND
        if not front.any():
            return np.zeros(0), np.zeros(0)
        places = places[:, front]
        length = float(np.hypot(*np.diff(places, axis=1)).sum())
        share = 1.0
        if not front.all():
            first, last = coarse[front][[0, -1]]
            share, begin, end = float(last - first) / (end - begin), float(first), float(last)
        if length > max(self.view.imager.columns, self.view.imager.rows):
            # A fast part is inside the picture for a short share of the exposure, which a fine search finds.
            dense = np.linspace(begin, end, 65537)
            column, row = path.at(middle + dense)
            spare = self.margin
            inside = (
                (column > -spare) & (column < self.view.imager.columns + spare) & (row > -spare) & (row < self.view.imager.rows + spare)
            )
            if not inside.any():
                return np.zeros(0), np.zeros(0)
            indices = np.flatnonzero(inside)
            # One step more at both ends, so that the entry into the picture is included.
            first, last = float(dense[max(indices[0] - 1, 0)]), float(dense[min(indices[-1] + 1, dense.size - 1)])
            part = (last - first) / (end - begin)
            share, begin, end, length = share * part, first, last, length * part
        if length < 1e-6:
            return np.array([0.5 * (begin + end)]), np.array([share])
        # Each segment has two instants.
        segments = min(max(math.ceil(length / SEGMENT), 1), MOST_INSTANTS // 2)
        edges = np.linspace(begin, end, segments + 1)
        centres, width = 0.5 * (edges[1:] + edges[:-1]), (end - begin) / segments
        times = (centres[:, None] + width * np.array([-_GAUSS, _GAUSS])).ravel()
        return times, np.full(times.size, share / times.size)

    def streaks(self, time: float, drawings: Sequence[Drawing]) -> tuple[Streak | None, ...]:
        """Return the streaks of the bodies during their exposures, by the middle of the first part of each; None behind the camera."""
        out: list[Streak | None] = [None] * len(self.drawer.bodies)
        half = 0.5 * self.model.exposure_time
        for drawing in drawings:
            body = self.drawer.parts[drawing.part].body
            if out[body] is None:
                out[body] = Streak.of(drawing.path, *[self._end(drawing, time, sign * half) for sign in (-1.0, 1.0)])
        return tuple(out)

    def _end(self, drawing: Drawing, time: float, half: float) -> float:
        """Return the time at which the row or column at the part begins or ends its exposure, ``half`` from its middle [s]."""

        def place(delay: float) -> tuple[float, float]:
            column, row = drawing.path.at(np.array([time + delay + half]))[:, 0]
            return float(column), float(row)

        return time + self._met(place) + half


@dataclass(frozen=True, eq=False)
class ObjectLight:
    """Objects of a frame: the change they make to the radiance on the pixels [W m-2 sr-1, (rows, columns)], alone and together.

    ``each`` holds for each object the first row and column of a window and the change in it; None out of the picture.
    """

    added: NDArray[np.float32]
    each: tuple[PictureWindow | None, ...]
    sights: tuple[BodySight, ...]
    streaks: tuple[Streak | None, ...]


@dataclass(frozen=True, eq=False)
class ExposedObjects:
    """Objects before a sensor. Make it with ``of``."""

    objects: SceneObjects
    track: Track
    imager: Imager
    model: SensorModel
    scan: ScanPattern
    fine: int  #: Pixels of the sea's picture along a side of a detector's pixel.
    detail: int  #: Pixels of large objects along a side of a detector's pixel.

    @classmethod
    def of(
        cls, objects: SceneObjects, scene: Scene, track: Track, model: SensorModel, scan: ScanPattern, fine: tuple[int, int]
    ) -> ExposedObjects:
        """Return objects of a scene; ``fine``: pixels along a side of a detector's pixel, of the sea's picture and of large objects."""
        pixels = scene.pixels
        imager = replace(pixels, columns=pixels.columns // fine[0], rows=pixels.rows // fine[0])
        return cls(objects, track, imager, model, scan, *fine)

    @cached_property
    def _local(self) -> LocalLight:
        model = self.model
        return LocalLight.of(model.blur, model.sampling(1), 1e-6 * model.photons.band.min_um)

    @cached_property
    def _view(self) -> View:
        return View(self.imager, self.track)

    @cached_property
    def _plan(self) -> ExposurePlan:
        return ExposurePlan(self.objects.drawer, self._view, self.model, self.scan, self._local.margin)

    @property
    def _circle(self) -> int:
        return self.imager.columns if self.imager.goes_round else 0

    def light(self, scene: Scene, time: float, sea: NDArray[np.float32], rates: tuple[float, float]) -> ObjectLight:
        """Return the light of the objects in a frame.

        Parameters
        ----------
        scene : Scene
            The scene of the frame's instant.
        time : float
            Middle of the exposure (of the first row or column) [s].
        sea : ndarray
            Image of the sea alone, in fine pixels [W m-2 sr-1, (rows, columns)].
        rates : (float, float)
            Movement of the line of sight by the platform, along and across rows [rad s-1].
        """
        pose = self.track.at(time)
        view = scene.seen_from(pose)
        surroundings = self.objects.drawer.light(view)
        backdrop = Backdrop(np.ascontiguousarray(sea), self.fine, self._circle, surroundings.sea_counted)
        # The movement of the line of sight in pixels per second.
        shift = (rates[0] / self.model.ifov, rates[1] / self.model.ifov)
        # Paths and instants come first, because they determine in which pixels each part is drawn.
        drawings = self._plan.drawings(time)
        patches = self._patches(scene, view, time, drawings, surroundings)
        added = np.zeros((self.imager.rows, self.imager.columns))
        windows: list[list[PictureWindow]] = [[] for _ in self.objects.drawer.bodies]
        sums: dict[tuple[int, int], list[tuple[Drawing, Boxes]]] = {}
        for drawing, patch, scale in patches:
            boxes = self._boxes(patch, scale, pose, backdrop, surroundings)
            body = patch.placed.part.body
            for rows, columns, instants in self._blocks(drawing, boxes, time, shift):
                for window in self._local.changes(boxes, instants, backdrop, self._bent, (columns, rows)):
                    part = part_of(window, rows, columns)
                    windows[body].append(part)
                    add_window(added, part, self._circle)
            sums.setdefault((drawing.part, drawing.image), []).append((drawing, boxes))
        shown = [(patch, scale, drawing) for drawing, patch, scale in patches]
        body_sights = self._sights(time, pose, shown, sums, (backdrop, shift), surroundings)
        each = tuple(sum_of(some, added.shape, self._circle) for some in windows)
        return ObjectLight(added.astype(np.float32), each, body_sights, self._plan.streaks(time, drawings))

    @cached_property
    def _bent(self) -> LensShift:
        share = self.model.optics.distortion
        columns, rows = self.imager.columns, self.imager.rows
        return LensShift(share, 0.5 * columns, 0.5 * rows, math.hypot(0.5 * columns, 0.5 * rows))

    def _patches(
        self, scene: Scene, view: SeaView, time: float, drawings: Sequence[Drawing], light: Surroundings
    ) -> list[tuple[Drawing, PixelPatch, float]]:
        """Return patches of the parts in view with the number of their pixels along the side of a detector's pixel."""
        if isinstance(scene, RefractedScene):
            return self._refracted(scene, time, drawings)
        drawer, chosen = self.objects.drawer, []
        moments: dict[float, tuple[Stage, tuple[Placed, ...]]] = {}
        # Parts with one delay share their waves.
        seas: dict[float, tuple[Levels, Surface] | None] = {}  # waves stand still in an exposure
        spare = self._local.margin
        for drawing in drawings:
            at = drawing.drawn_at
            if at not in moments:
                pose = self._view.pose(at)
                met = time + drawing.delay
                if met not in seas:
                    seas[met] = _waves(scene, self._view.pose(met), met)
                columns = (0, self.imager.columns) if self._circle else (-spare, self.imager.columns + spare)
                rows, frame = (-spare, self.imager.rows + spare), (0, self.imager.columns, 0, self.imager.rows)
                stage = Stage(self.imager, pose, view, seas[met], columns, rows, frame=frame)
                moments[at] = (stage, drawer.placed(pose, at)[1])
            stage, every = moments[at]
            one = every[drawing.part]
            if drawing.times.size and self._meets(drawing, time) and near(self._wide(stage, drawing, time), one):
                chosen.append((drawing, *self._own_stage(stage, one, drawing, time), one, every))
        drawn = drawer.patches([(stage, one) for _, stage, _, one, _ in chosen], [every for *_, every in chosen], light)
        return [(drawing, patch, float(scale)) for (drawing, _, scale, *_), patch in zip(chosen, drawn, strict=True) if patch is not None]

    def _meets(self, drawing: Drawing, time: float) -> bool:
        """Return true if the middle of a part is in front of the camera at all its instants."""
        return bool((drawing.path.at(time + drawing.delay + drawing.times)[0] > BEHIND).all())

    def _wide(self, stage: Stage, drawing: Drawing, time: float) -> Stage:
        """Return the stage with the pixels from which the part enters the picture during its exposure."""
        places = drawing.path.at(time + drawing.delay + drawing.times) - drawing.path.at(np.array([drawing.drawn_at]))
        low, high = np.floor(places.min(axis=1)).astype(int), np.ceil(places.max(axis=1)).astype(int)
        (left, right), (top, bottom) = stage.columns, stage.rows
        if not self._circle:
            left, right = left - max(int(high[0]), 0), right - min(int(low[0]), 0)
        return replace(stage, columns=(left, right), rows=(top - max(int(high[1]), 0), bottom - min(int(low[1]), 0)))

    def _own_stage(self, stage: Stage, one: Placed, drawing: Drawing, time: float) -> tuple[Stage, int]:
        """Return the stage of a part with pixels as fine as its size needs, and their number along the side of a detector's pixel."""
        wide = self._wide(stage, drawing, time)
        if one.radius == 0.0:
            return wide, 1
        size = wide.size_of(one)
        # Small bodies need the nodes of the blur; large ones pixels that resolve the optics' cut-off.
        scale = self._local.nodes if size < LARGE else self.detail
        while scale * size < BOXES_ACROSS:
            scale *= 2
        columns, rows = ((scale * a, scale * b) for a, b in (wide.columns, wide.rows))
        # Finer pixels need fewer samples each for the same number across the detector's pixel.
        cells = max(math.ceil(FEWEST_CELLS * self.detail / scale), 2)
        frame = (0, scale * self.imager.columns, 0, scale * self.imager.rows)
        return replace(wide, imager=finer(self.imager, scale), columns=columns, rows=rows, cells=cells, frame=frame), scale

    def _refracted(self, scene: RefractedScene, time: float, drawings: Sequence[Drawing]) -> list[tuple[Drawing, PixelPatch, float]]:
        """Return patches through air that bends lines of sight, in the fine pixels of the picture."""
        pose = self.track.at(time)
        stage = Stage(
            scene.pixels, pose, scene.seen_from(pose), _waves(scene, pose, time), (0, scene.pixels.columns), (0, scene.pixels.rows)
        )
        picture = refracted_picture(self.objects.drawer, stage, scene, time)
        parts = {id(part): number for number, part in enumerate(self.objects.drawer.parts)}
        # a part is drawn once through bent air, so its drawing takes all instants of the exposure
        whole: dict[int, Drawing] = {}
        for drawing in drawings:
            before = whole.get(drawing.part)
            whole[drawing.part] = replace(drawing if before is None else _together(before, drawing), drawn_at=time)
        numbered = ((replace(whole[parts[id(p.placed.part)]], image=n), p) for n, p in enumerate(picture.patches))
        return [(drawing, patch, float(self.fine)) for drawing, patch in numbered if drawing.times.size]

    def _boxes(self, patch: PixelPatch, scale: float, pose: Pose, backdrop: Backdrop, light: Surroundings) -> Boxes:
        """Return the light of a patch as boxes at places in the detector's picture."""
        if patch.clear > 0.0:
            column, row = float(patch.sums[sample_sums.ACROSS]) / scale, float(patch.sums[sample_sums.DOWN]) / scale
            # A point has no area, so its light is spread over the solid angle of one pixel.
            solid = float(self.imager.solid_angle(pose.attitude, column, row))
            counted, radiance = point_light(patch, solid, behind(backdrop, column, row), light)
            values = [np.array([v]) for v in (column, row, counted, radiance, 0.0)]
            return Boxes(values[0], values[1], values[2], values[3], values[4], 0.0)
        # A fine pixel is this part of a detector's pixel.
        area = 1.0 / scale**2
        cover = patch.planes[sample_sums.COVER] * area
        radiance = patch.planes[[sample_sums.PATH, sample_sums.EMITTED, sample_sums.MIRRORED, sample_sums.SUN]].sum(axis=0) * area
        counted = patch.counted * area
        lit = np.nonzero((cover > 0.0) | (radiance > 0.0))
        columns = patch.columns.astype(np.float64)
        if self._circle:  # columns continue across the seam of a panorama
            around = scale * self._circle
            columns = columns[0] + (columns - columns[0] + 0.5 * around) % around - 0.5 * around
        return Boxes(
            (columns[lit[1]] + 0.5) / scale, (patch.rows[lit[0]] + 0.5) / scale, counted[lit], radiance[lit], cover[lit], 1.0 / scale
        )  # fmt: skip

    def _instants(self, drawing: Drawing, middle: float, shift: tuple[float, float]) -> Instants:
        """Return shifts of a part and of the sea behind it at the instants of an exposure about ``middle`` [s]."""
        places = drawing.path.at(middle + drawing.times) - drawing.path.at(np.array([drawing.drawn_at]))
        return Instants(places[0], places[1], drawing.weights, shift[0] * drawing.times, shift[1] * drawing.times)

    def _blocks(
        self, drawing: Drawing, boxes: Boxes, time: float, shift: tuple[float, float]
    ) -> Iterator[tuple[tuple[int, int] | None, tuple[int, int] | None, Instants]]:
        """Yield rows and columns (first and end; None for all) with a separate instant each, and the part's instants there."""
        down, across = self._plan.delays
        own = self._instants(drawing, time + drawing.delay, shift)
        delays = down if down is not None else across
        if delays is None or boxes.column.size == 0 or drawing.times.size == 0:
            yield None, None, own
            return
        # Rows or columns follow one another in equal time steps.
        tick = abs(float(delays[1] - delays[0])) if delays.size > 1 else 0.0
        step = self._speed(drawing, time + drawing.delay) * tick
        places, moves = (boxes.row, own.down) if down is not None else (boxes.column, own.across)
        first = math.floor(float(places.min() + moves.min())) - self._local.margin
        end = math.ceil(float(places.max() + moves.max())) + self._local.margin
        if down is not None or not self._circle:
            first, end = max(first, 0), min(end, delays.size)
        if step * (end - first) < IN_STEP:
            yield None, None, own
            return
        # So many rows or columns share an instant, within which the part moves less than IN_STEP.
        chunk = max(int(IN_STEP / step), 1)
        for begin in range(first, end, chunk):
            stop = min(begin + chunk, end)
            delay = float(np.mean([delays[k % delays.size] for k in range(begin, stop)]))
            instants = self._instants(drawing, time + delay, shift)
            yield ((begin, stop), None, instants) if down is not None else (None, (begin, stop), instants)

    def _speed(self, drawing: Drawing, middle: float) -> float:
        """Return the speed of a part in the image [pixels s-1]."""
        step = max(0.5 * self.model.exposure_time, SHORT)
        pair = drawing.path.at(np.array([middle - step, middle + step]))
        return float(np.hypot(*(pair[:, 1] - pair[:, 0]))) / (2.0 * step)

    def _sights(
        self,
        time: float,
        pose: Pose,
        shown: Sequence[tuple[PixelPatch, float, Drawing]],
        drawn: Mapping[tuple[int, int], Sequence[tuple[Drawing, Boxes]]],
        behind_them: tuple[Backdrop, tuple[float, float]],
        light: Surroundings,
    ) -> tuple[BodySight, ...]:
        """Return the sights of the bodies in the detector's pixels, averaged over the exposure."""
        stands, every = self.objects.drawer.placed(pose, time)
        patches, shares = [], []
        for (part, image), parts in drawn.items():
            some = [one for one in shown if (one[2].part, one[2].image) == (part, image)]
            patches.append(self._averaged(some, time, behind_them[1]))
            shares.append(self._share(parts, time, pose, behind_them))
        own = {patch.placed.part: patch.placed for patch in patches}
        placed = tuple(own.get(one.part, one) for one in every)
        picture = DrawnBodies(self.objects.drawer.bodies, stands, tuple(patches), placed)
        return sights(picture, patches, shares, self._circle, light)

    def _averaged(self, some: Sequence[tuple[PixelPatch, float, Drawing]], time: float, shift: tuple[float, float]) -> PixelPatch:
        """Return the patch of a part with sums averaged over the instants of an exposure, in the detector's pixels, without pixels."""
        sums, line, places, total = np.zeros(sample_sums.SUMS), np.zeros(2), np.zeros(2), 0.0
        for patch, scale, drawing in some:
            instants, weight = self._instants(drawing, time + drawing.delay, shift), float(drawing.weights.sum())
            offset = np.array([instants.across @ instants.weight, instants.down @ instants.weight]) / weight
            own = patch.sums[[sample_sums.ACROSS, sample_sums.DOWN]] / scale
            sums[SUMMED] += weight * patch.sums[SUMMED]
            line += weight * patch.lines.sum(axis=1)
            if patch.placed.radius > 0.0:
                sums[[sample_sums.ACROSS, sample_sums.DOWN]] += weight * (own + patch.sums[sample_sums.SEEN] * offset)
            elif patch.clear > 0.0:
                # a point has its mean place in the picture; if it is never inside, the mean of all its places
                share = weight * (1.0 if patch.lines[1].any() else 1e-9)
                # The tiny weight counts only if the point is never inside the picture.
                places, total = places + share * (own + offset), total + share
        if total > 0.0:
            sums[[sample_sums.ACROSS, sample_sums.DOWN]] = places / total
        sums[[sample_sums.WHOLE, sample_sums.DRY]] = np.mean(
            [patch.sums[[sample_sums.WHOLE, sample_sums.DRY]] for patch, _, _ in some], axis=0
        )
        middle = some[len(some) // 2][0]
        clear = max(patch.clear for patch, _, _ in some)
        return replace(middle, rows=np.zeros(1, np.int64), sums=sums, lines=line[:, None], clear=clear)

    def _share(
        self, drawn: Sequence[tuple[Drawing, Boxes]], time: float, pose: Pose, behind_them: tuple[Backdrop, tuple[float, float]]
    ) -> BodyShare:
        """Return coverage and radiance of a part in the pixels of the picture, means over the exposure."""
        backdrop, shift = behind_them
        parts = [(block, boxes) for drawing, boxes in drawn if boxes.column.size for block in self._blocks(drawing, boxes, time, shift)]
        edges = np.array(
            [
                [some.min() + moves.min() - 0.5 * boxes.side, some.max() + moves.max() + 0.5 * boxes.side]
                for (_, _, i), boxes in parts
                if i.weight.size
                for some, moves in ((boxes.column, i.across), (boxes.row, i.down))
            ]
        ).reshape(-1, 2, 2)
        if edges.size == 0:
            return _NO_SHARE
        left, top = (math.floor(edges[:, k, 0].min()) for k in (0, 1))
        right, bottom = (math.floor(edges[:, k, 1].max()) + 1 for k in (0, 1))
        top, bottom = max(top, 0), min(bottom, self.imager.rows)
        left, right = (left, min(right, left + self._circle)) if self._circle else (max(left, 0), min(right, self.imager.columns))
        if top >= bottom or left >= right:
            return _NO_SHARE
        counted = np.zeros((3, bottom - top, right - left))
        for (rows, columns, instants), boxes in parts:
            (first, end), (begin, stop) = rows or (top, bottom), columns or (left, right)
            first, end, begin, stop = max(first, top), min(end, bottom), max(begin, left), min(stop, right)
            if first < end and begin < stop:
                count_pixels(counted[:, first - top : end - top, begin - left : stop - left], (begin, first), boxes, instants, backdrop)
        if not counted.any():  # a fast part passes between the instants of two columns or rows
            for drawing, boxes in drawn:
                count_pixels(counted, (left, top), boxes, self._instants(drawing, time + drawing.delay, shift), backdrop)
        rows_of, columns_of = np.arange(top, bottom), np.arange(left, right)
        pixel = np.broadcast_to(self.imager.solid_angle(pose.attitude, columns_of + 0.5, rows_of[:, None] + 0.5), counted.shape[1:])
        # The mean radiance of the covered part of each pixel.
        image = counted[2] / np.where(counted[0] > 0.0, counted[0], 1.0)
        columns_of = columns_of % self._circle if self._circle else columns_of
        return BodyShare(rows_of, columns_of, counted[0], counted[1], image, pixel, TOUCHED * float(counted[0].max()))


def _waves(scene: Scene, pose: Pose, time: float) -> tuple[Levels, Surface] | None:
    """Return the resolved waves of an instant before a sensor; None of a flat sea."""
    if scene.waves is None:
        return None
    sea = scene.sea(pose, time, None)
    return sea.levels, sea.surface


def _together(one: Drawing, other: Drawing) -> Drawing:
    """Return a part's drawing with the instants of another one of the same exposure."""
    return replace(one, times=np.concatenate([one.times, other.times]), weights=np.concatenate([one.weights, other.weights]))
