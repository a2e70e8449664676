"""Paths of bodies over the image during an exposure, for moving bodies and a camera that moves and turns."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from scipy.interpolate import BarycentricInterpolator

from seaglint.base.conventions import FloatArray
from seaglint.imaging.camera.imager import Imager
from seaglint.imaging.camera.pose import Pose, Track
from seaglint.objects.body import GasPlume, Motion, PointSource
from seaglint.objects.drawing.eye import image_point, lens, project, stand
from seaglint.objects.drawing.prepared_bodies import DrawnPart, Mesh

NEAR: Final = 2e-3  #: Largest error of the interpolation of a path [pixels].

BEHIND: Final = -1e5  #: Columns and rows below this mean places behind the camera [pixels].

MOST_NODES: Final = 65  #: Largest number of instants at which a path is evaluated.

SHORT: Final = 1e-3  #: Least time over which the speed of a body is evaluated, also for shorter exposures [s].

RIGID: Final = 0.05  #: Change of a body's shape in the image up to which it counts as rigid during an exposure [pixels].

NEARER: Final = 0.02  #: Relative change of a point's distance up to which it counts as one distance during an exposure.

MOST_STAGES: Final = 16  #: Largest number of shapes with which a body is drawn in an exposure.


@dataclass(frozen=True, eq=False)
class View:
    """Camera of a sequence: its pixels, and its pose as a function of time."""

    imager: Imager
    track: Track

    def pose(self, time: float) -> Pose:
        """Return the pose at a time [s], or at the nearest time of the track."""
        first, last = self.track.known
        return self.track.at(min(max(time, first), last))

    def known(self, motion: Motion) -> tuple[float, float]:
        """Return the first and last time at which the poses of both camera and body are known [s]."""
        camera, body = self.track.known, motion.known
        return max(camera[0], body[0]), min(camera[1], body[1])


@dataclass(frozen=True, eq=False)
class ImagePath:
    """Place of a part's middle in the image as a function of time; make it with ``of``."""

    _columns: Callable[[FloatArray], FloatArray]
    _rows: Callable[[FloatArray], FloatArray]
    _front: tuple[float, float] = (-math.inf, math.inf)  #: Times between which the part is in front of the camera [s].

    @classmethod
    def of(cls, view: View, motion: Motion, middle: FloatArray, times: tuple[float, float], about: float) -> ImagePath:
        """Evaluate the path and interpolate it.

        Parameters
        ----------
        view : View
            Camera.
        motion : Motion
            Motion of the body.
        middle : ndarray, (3,)
            Place in the body's axes [m].
        times : (float, float)
            First and last time [s]. The path before the first and after the last keyframe is extrapolated.
        about : float
            Column; of columns that differ by a full circle, the path has the nearest to it [pixels].
        """
        first, last = view.known(motion)
        length = times[1] - times[0]
        # the interval is moved within the known times, not cut, where possible
        begin = max(min(times[0], last - length), first)
        end = min(begin + length, last)
        if end <= begin:
            place = place_in_image(view, motion, middle, begin, about)
            return cls(lambda t: np.full(np.shape(t), place[0]), lambda t: np.full(np.shape(t), place[1]))
        front = (-math.inf, math.inf)
        sampled = np.linspace(begin, end, 33)
        ahead = np.array([place_in_image(view, motion, middle, float(t), about)[0] > BEHIND for t in sampled])
        if not ahead.all():  # only the path in front of the camera; if it is there several times, the longest piece
            runs = np.flatnonzero(np.diff(np.concatenate([[0], ahead.astype(int), [0]]))).reshape(-1, 2)
            if not runs.size:
                return cls(lambda t: np.full(np.shape(t), 10.0 * BEHIND), lambda t: np.full(np.shape(t), 10.0 * BEHIND))
            k = int(np.argmax(runs[:, 1] - runs[:, 0]))
            begin, end = float(sampled[runs[k, 0]]), float(sampled[runs[k, 1] - 1])
            front = (begin, max(end, begin + 1e-9))
            end = front[1]
        # nodes of a doubled number include the nodes before: the path is known when they agree with its polynomial
        count = 3
        nodes, places = _evaluated(view, motion, middle, (begin, end), count, about)
        while True:
            finer, finer_places = _evaluated(view, motion, middle, (begin, end), 2 * count - 1, about)
            guess = np.stack([_through(nodes, places[:, k])(finer) for k in (0, 1)], axis=1)
            count, nodes, places = 2 * count - 1, finer, finer_places
            if float(np.abs(guess - finer_places).max()) < NEAR or count >= MOST_NODES:
                return cls(_through(nodes, places[:, 0]), _through(nodes, places[:, 1]), front)

    def at(self, times: FloatArray) -> FloatArray:
        """Return columns and rows at times [pixels, (2, n)]; below ``BEHIND`` behind the camera."""
        places = np.stack([np.asarray(self._columns(times), np.float64), np.asarray(self._rows(times), np.float64)])
        places[:, (times < self._front[0]) | (times > self._front[1])] = 10.0 * BEHIND
        return places


def _through(nodes: FloatArray, values: FloatArray) -> Callable[[FloatArray], FloatArray]:
    """Return the polynomial through values at Chebyshev's extremal nodes.

    Its weights are given here (alternating, halved at the ends): the weights that SciPy computes depend in the last digit on a random order
    of the nodes.
    """
    weights = (-1.0) ** np.arange(nodes.size)
    weights[[0, -1]] *= 0.5
    interpolator: Callable[[FloatArray], FloatArray] = BarycentricInterpolator(nodes, values, wi=weights)
    return interpolator


def _evaluated(
    view: View, motion: Motion, middle: FloatArray, times: tuple[float, float], count: int, about: float
) -> tuple[FloatArray, FloatArray]:
    """Return Chebyshev's extremal nodes between two times [s, (nodes,)], and the places at them [pixels, (nodes, 2)]."""
    nodes = 0.5 * (times[0] + times[1]) - 0.5 * (times[1] - times[0]) * np.cos(np.pi * np.arange(count) / (count - 1))
    return nodes, np.array([place_in_image(view, motion, middle, float(t), about) for t in nodes])


def place_in_image(view: View, motion: Motion, middle: FloatArray, time: float, about: float) -> tuple[float, float]:
    """Return column and row of a place of a body (in its axes) at a time [pixels]; far outside the image for a place behind the camera."""
    pose = view.pose(time)
    at = stand(motion.at(time), pose)
    column, row, seen = image_point(lens(view.imager, pose.attitude), tuple(at.place + at.turn @ middle), about)
    return (column, row) if seen else (10.0 * BEHIND, 10.0 * BEHIND)


def middle_of(part: DrawnPart) -> FloatArray:
    """Return the middle of a part in its body's axes [m, (3,)]."""
    if isinstance(part.kind, Mesh):
        return part.kind.middle
    return np.asarray(part.kind.centre, np.float64) if isinstance(part.kind, GasPlume) else np.zeros(3)


def stages(view: View, motion: Motion, part: DrawnPart, times: tuple[float, float], about: float) -> int:
    """Return the number of shapes with which a part is drawn between two times [s]: one for a part that only shifts in the image.

    The corners of the part are compared with corners that shift as its middle does. The number of shapes limits the difference to
    ``RIGID``, and for a point the change of its distance to ``NEARER``.
    """
    first, last = view.known(motion)
    if isinstance(part.kind, PointSource):
        ends = (min(max(time, first), last) for time in times)
        # a point has no shape: only its distance, and so its light, changes
        far = [float(np.linalg.norm(stand(motion.at(time), view.pose(time)).place)) for time in ends]
        return int(min(max(math.ceil(abs(far[1] - far[0]) / (NEARER * max(min(far), 1e-3))), 1), MOST_STAGES))
    if isinstance(part.kind, Mesh):
        low, high = part.kind.vertices.min(axis=0), part.kind.vertices.max(axis=0)
    else:
        centre, half = np.asarray(part.kind.centre), np.asarray(part.kind.semi_axes)
        low, high = centre - half, centre + half
    # the corners of the bounding box move at least as much as the body
    corners = np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])])
    points = np.concatenate([middle_of(part)[None], corners])
    shapes = []
    for time in (max(times[0], first), min(times[1], last)):
        pose = view.pose(time)
        at = stand(motion.at(min(max(time, first), last)), pose)
        surface = points @ at.turn.T + at.place
        _, image = project(surface, pose.attitude.axes, lens(view.imager, pose.attitude), about)
        shapes.append(image[1:] - image[0])
    change = float(np.abs(shapes[1] - shapes[0]).max())
    return int(min(max(math.ceil(change / (2.0 * RIGID)), 1), MOST_STAGES))


@dataclass(frozen=True, eq=False)
class Streak:
    """Path of a body in the image during an exposure."""

    middle: FloatArray  #: Mean column and row [pixels; pixel centres are whole numbers, (2,)].
    ends: FloatArray  #: First and last column and row [pixels, (2, 2)].
    length: float  #: Length of the path [pixels].
    velocity: FloatArray  #: Speed along columns and rows at the middle of the exposure [pixels s-1, (2,)].

    @classmethod
    def of(cls, path: ImagePath, begin: float, end: float) -> Streak | None:
        """Return the streak along a path from a time to another [s]; None where the body is behind the camera."""
        places = path.at(np.linspace(begin, end, 33))
        time, step = 0.5 * (begin + end), max(0.5 * (end - begin), SHORT)
        pair = path.at(np.array([time - step, time + step]))
        if not (places > BEHIND).all() or not (pair > BEHIND).all():
            return None
        # 33 places: the length of a curve, not of its chord
        length = float(np.hypot(*np.diff(places, axis=1)).sum())
        # image points count from the corner, labels from the centre of the first pixel
        return cls(places.mean(axis=1) - 0.5, places[:, [0, -1]].T - 0.5, length, (pair[:, 1] - pair[:, 0]) / (2.0 * step))


def path_about(view: View, motion: Motion, part: DrawnPart, time: float, spare: float) -> ImagePath:
    """Return the path of a part from ``spare`` [s] before a time to ``spare`` after it."""
    first, last = view.known(motion)
    middle = middle_of(part)
    about = place_in_image(view, motion, middle, min(max(time, first), last), 0.5 * view.imager.columns)[0]
    return ImagePath.of(view, motion, middle, (time - spare, time + spare), about)


def finer(imager: Imager, times: int) -> Imager:
    """Return the camera with each pixel divided into ``times`` x ``times``."""
    return replace(imager, columns=imager.columns * times, rows=imager.rows * times)
