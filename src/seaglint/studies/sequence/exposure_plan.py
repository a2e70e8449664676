"""Plan of an exposure: when and where each part of each object is drawn, and its instants."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.reports import REPORTS
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.scan import ScanPattern
from seaglint.objects.drawing.draw import Drawer
from seaglint.objects.drawing.image_path import BEHIND, SHORT, ImagePath, Streak, View, middle_of, place_in_image, stages

SEGMENT: Final = 0.25  #: Longest way of an object between two pairs of instants [pixels].

MOST_INSTANTS: Final = 8192  #: Largest number of instants of an exposure: 1000 pixels of way in the picture.

APART: Final = 0.25  #: Way between two instants at which bodies that cross each other or the picture's edge are drawn [pixels].

MOST_MEETINGS: Final = 128  #: Largest number of these instants in an exposure.

CROSSINGS: Final = 64  #: Number of parts of a readout among which the one that passes a body is sought.

_GAUSS: Final = 0.5 / math.sqrt(3.0)  #: Places of a pair of instants about the middle of its segment.


@dataclass(frozen=True, eq=False)
class Drawing:
    """A part to draw: its number, its path, the delay of its row or column, its instants about that, and the one it is drawn at [s].

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
        """Time of each row and of each column after the frame's [s]; None where all have one."""
        rows, columns = self.scan.row_delays(self.view.imager.rows), self.scan.column_delays(self.view.imager.columns)
        return (rows if rows.any() else None), (columns if columns.any() else None)

    def _delay(self, column: float, row: float) -> float:
        """Time after the frame's at which an image point is taken [s]."""
        down, across = self.delays
        if down is not None:
            return float(np.interp(row - 0.5, np.arange(down.size), down))
        if across is not None:
            return float(np.interp((column - 0.5) % across.size if self._circle else column - 0.5, np.arange(across.size), across))
        return 0.0

    @cached_property
    def _longest(self) -> float:
        """Time from the first to the last row or column [s]; 0 where all are taken at once."""
        return max((float(delays.max()) for delays in self.delays if delays is not None), default=0.0)

    def _met(self, place: Callable[[float], tuple[float, float]]) -> float:
        """Time after the frame's at which the readout passes something whose column and row are ``place`` of that time [s].

        The first crossing between two rows or columns, refined by bisection; where there is none, the time at which its first place is
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
                for _ in range(40):
                    half = 0.5 * (low + high)
                    low, high = (half, high) if ahead(half) > 0.0 else (low, half)
                return 0.5 * (low + high)
        return signs[0]

    def _found(self, part: int, time: float) -> tuple[float, ImagePath]:
        """Time after the frame's at which a part is met [s], and its path about that."""
        drawn = self.drawer.parts[part]
        motion = self.drawer.bodies[drawn.body].motion
        middle, about = middle_of(drawn), 0.5 * self.view.imager.columns
        first, last = self.view.known(motion)

        def place(delay: float) -> tuple[float, float]:
            return place_in_image(self.view, motion, middle, min(max(time + delay, first), last), about)

        delay = self._met(place)
        spare = max(0.5 * self.model.exposure_time, SHORT) + self._longest
        times = (time + delay - spare, time + delay + spare)
        return delay, ImagePath.of(self.view, motion, middle, times, place(delay)[0])

    def drawings(self, time: float) -> list[Drawing]:
        """Parts to draw in a frame, each in one or several shapes."""
        exposure = self.model.exposure_time
        out, found = [], [self._found(number, time) for number in range(len(self.drawer.parts))]
        meetings = self._meetings(time, found)
        for number, (part, (delay, path)) in enumerate(zip(self.drawer.parts, found, strict=True)):
            middle, count = time + delay, 1
            if exposure > 0.0:
                ends = (middle - 0.5 * exposure, middle + 0.5 * exposure)
                about = float(path.at(np.array([middle]))[0, 0])
                count = max(stages(self.view, self.drawer.bodies[part.body].motion, part, ends, about), meetings[number])
                self._report(path, ends, part.name)
            for stage in range(count):
                begin = (stage / count - 0.5) * exposure
                times, weights = self._times(path, middle, begin, begin + exposure / count)
                own = middle + begin + 0.5 * exposure / count
                out.append(Drawing(number, path, delay, times, weights / count, own))
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

    def _meetings(self, time: float, found: Sequence[tuple[float, ImagePath]]) -> list[int]:
        """Number of instants at which each part is drawn, since in its exposure it meets another body or the picture's edge.

        What then hides it, and what is in the picture, changes with time: between two instants by :data:`APART` of way.
        """
        half = 0.5 * self.model.exposure_time * np.linspace(-1.0, 1.0, 9)
        bodies = [part.body for part in self.drawer.parts]
        ways = [path.at(time + delay + half) for delay, path in found]
        sizes = [one.angle / self.model.ifov + 1.0 for one in self.drawer.placed(self.view.pose(time), time)[1]]
        boxes = [(way.min(axis=1) - size, way.max(axis=1) + size) for way, size in zip(ways, sizes, strict=True)]
        edge = np.array([self.view.imager.columns, self.view.imager.rows], np.float64)
        out = []
        for n, body in enumerate(bodies):
            low, high = boxes[n]
            way = 0.0
            sides = slice(1, 2) if self._circle else slice(0, 2)
            if (((low < 0.0) & (high > 0.0)) | ((low < edge) & (high > edge)))[sides].any():
                way = float(np.hypot(*np.ptp(ways[n], axis=1)))
            for k, other in enumerate(bodies):
                if other != body and (boxes[k][0] < high).all() and (boxes[k][1] > low).all():
                    way = max(way, float(np.hypot(*np.ptp(ways[n] - ways[k], axis=1))))
            out.append(min(max(math.ceil(way / APART), 1), MOST_MEETINGS))
        return out

    def _times(self, path: ImagePath, middle: float, begin: float, end: float) -> tuple[FloatArray, FloatArray]:
        """Instants about the middle of an exposure [s] and their weights: pairs of Gauss and Legendre on short segments.

        A body that crosses more than the picture has its instants where it is in it.
        """
        if end <= begin:
            return np.zeros(1), np.ones(1)
        coarse = np.linspace(begin, end, 65)
        places = path.at(middle + coarse)
        front = places[0] > BEHIND
        if not front.any():
            return np.zeros(0), np.zeros(0)
        places = places[:, front]
        ways = np.hypot(*np.diff(places, axis=1))
        length = float(ways.sum())
        share = 1.0
        if not front.all():
            first, last = coarse[front][[0, -1]]
            share, begin, end = float(last - first) / (end - begin), float(first), float(last)
        widest = max(self.view.imager.columns, self.view.imager.rows)
        if length > widest:
            dense = np.linspace(begin, end, 65537)
            column, row = path.at(middle + dense)
            spare = self.margin
            inside = (
                (column > -spare) & (column < self.view.imager.columns + spare) & (row > -spare) & (row < self.view.imager.rows + spare)
            )
            if not inside.any():
                return np.zeros(0), np.zeros(0)
            some = np.flatnonzero(inside)
            first, last = float(dense[max(some[0] - 1, 0)]), float(dense[min(some[-1] + 1, dense.size - 1)])
            part = (last - first) / (end - begin)
            share, begin, end, length = share * part, first, last, length * part
        if length < 1e-6:
            return np.array([0.5 * (begin + end)]), np.array([share])
        segments = min(max(math.ceil(length / SEGMENT), 1), MOST_INSTANTS // 2)
        edges = np.linspace(begin, end, segments + 1)
        centres, width = 0.5 * (edges[1:] + edges[:-1]), (end - begin) / segments
        times = (centres[:, None] + width * np.array([-_GAUSS, _GAUSS])).ravel()
        return times, np.full(times.size, share / times.size)

    def streaks(self, time: float, drawings: Sequence[Drawing]) -> tuple[Streak | None, ...]:
        """Ways of the bodies during their exposures, by the middle of the first part of each; None behind the camera."""
        out: list[Streak | None] = [None] * len(self.drawer.bodies)
        half = 0.5 * self.model.exposure_time
        for drawing in drawings:
            body = self.drawer.parts[drawing.part].body
            if out[body] is None:
                ends = [self._end(drawing, time, sign * half) for sign in (-1.0, 1.0)]
                out[body] = Streak.of(drawing.path, *ends)
        return tuple(out)

    def _end(self, drawing: Drawing, time: float, half: float) -> float:
        """Time at which the row or column that then sees the part begins or ends its exposure, ``half`` from its middle [s]."""

        def place(delay: float) -> tuple[float, float]:
            column, row = drawing.path.at(np.array([time + delay + half]))[:, 0]
            return float(column), float(row)

        return time + self._met(place) + half
