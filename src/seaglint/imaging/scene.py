"""Prepared scenes: accuracy settings, levels of detail of the sea, and the interface that yields an image from a pose at a time."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray, depression_of_range, horizon_depression, horizon_range
from seaglint.base.errors import DomainError
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sunlight import visible_sun
from seaglint.imaging.camera.imager import Camera, Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.imaging.foam_surface import FoamSurface, even_foam, foam_surface
from seaglint.imaging.launch import surface_of
from seaglint.imaging.layers import Layers
from seaglint.imaging.wave_surface import LONGEST_STRIP, STRIP, Bounds, Surface, steepest_rise
from seaglint.sea.foam.foam_field import FoamField, FoamTiles
from seaglint.sea.foam.ship_foam import NO_SEGMENTS, FoamSegments
from seaglint.sea.wave_field import Detail, WaveField


@dataclass(frozen=True)
class Accuracy:
    """Accuracy settings of the renderer."""

    step: float | None = None  #: Largest step of the sweep at the finest level of detail [m]; from ``steps_per_wave`` where it is None.
    #: Steps of the sweep per shortest resolved wave, as many as its lattice has; twice as many move column means by less than 0.5 %.
    steps_per_wave: float = 4.0
    lines_per_column: int = 16  #: Most lines of sight in a column, a power of two; ``variance_error`` decides how many are used.
    #: Columns that an octave's longest waves must span to stay geometry, whatever their share of the variance; 0 keeps all waves at any
    #: range.
    shortest_wave_columns: float = 2.0
    #: Largest error of the variance of pixels, to first order in the slopes, from waves that a level of detail omits and from the distance
    #: of lines. With the default, deviations of pixels are within 5 % of the deviations in finer pictures averaged down, from 10 m to 3 km.
    variance_error: float = 0.02
    #: Slope variance among neighbouring pieces of sea in a third of a row, over the slope variance of their facets, up to which they are
    #: shaded as one; 0 shades each separately. Mean radiance moves by less than 0.1 %, the deviation of pixels by less than 1 %.
    merged_spread: float = 0.1
    crest: float = 1.25  #: Height above which no crest is expected, in significant heights: five standard deviations.
    #: Share of the sea in the shadow of resolved waves, by Smith's law, below which none is drawn: glint changes by less than 0.3 %.
    negligible_shadow: float = 1e-3
    steepest_rise: float = 3.0  #: Largest assumed rise of the sea along a shadow ray, in rms slopes: one place in 700 is steeper.
    #: Cells of the sweep across a pixel of a turned camera: waves of a pixel's size keep 96 % of their variance (two: 93 %, four: 97 %).
    oversampling: int = 3
    #: Elevation below which rays of a turned camera are walked one by one [rad]: they are cheap there, and columns of equal azimuth get
    #: narrow.
    walk_below: float = math.radians(-40.0)
    #: Ratio of the sensor heights for which the air is prepared: a moving sensor has transmittances of a height at most 2 % lower.
    height_step: float = 1.02

    def __post_init__(self) -> None:
        lines = self.lines_per_column
        if lines < 1 or lines & (lines - 1):
            raise DomainError(f"lines_per_column = {lines} is no power of two; give 1, 2, 4, 8 or 16")
        if self.oversampling < 1:
            raise DomainError(f"oversampling = {self.oversampling} is outside 1 and more; give a whole number from 1 on")


_ARCS = 2000  #: Number of ranges at which the beginning of levels is searched: to half a per cent.


#: Number of lines per length of a wave: with fewer lines the variance of pixels grows, as measured from 10 m to 3 km.
_LINES_PER_WAVE = 4.0

#: Largest angle between a line of sight and the middle of a view whose lines share averaged seas [rad]: at 20 degrees deviations of pixels
#: are up to 4 % larger than in the middle, at 40 degrees up to 7 %.
AVERAGED_ASIDE = math.radians(15.0)

#: Least ``variance_error`` with which lines read averaged seas: deviations of pixels are within 5 % of those of many lines.
AVERAGED_ERROR = 0.02

#: Width over which the sea is averaged, over the distance of lines. Below 1, as an average over the whole distance also removes groups of
#: waves, which change the mean of a pixel. Deviations of pixels agree with those of finer pictures averaged down, from 10 m to 3 km.
AVERAGED_WIDTH = 0.85

#: Largest share of a level's slope variance that an average removes; lines are closer where it removed more.
AVERAGED_SHARE = 0.12

#: Elevation below which that share falls with the Sun [rad], and the share's least value. Towards a low Sun only the steepest slopes glint,
#: and averages remove these first: with the Sun 5 degrees high a share of 0.12 darkens rows by 1.5 %, one of 0.06 by 0.7 %.
LOW_SUN, LEAST_SHARE = math.radians(15.0), 0.06

LAST_SHARE = 0.25  #: Share of a row that a sea must fill up to the horizon for its lines to split.

WIDTHS_PER_OCTAVE = 2  #: Number of widths over which the sea is averaged, for each doubling of the distance of lines.


class SceneFoam(NamedTuple):
    """Foam of an instant of a scene: on the tiles of its waves, or the same share everywhere."""

    share: float = 0.0  #: Share of a sea without resolved waves [1].
    field: FoamField | None = None  #: Breaking waves of a sea with resolved waves.
    tiles: FoamTiles | None = None  #: Their foam at the instant.
    ships: FoamSegments = NO_SEGMENTS  #: Foam of ships at the instant.

    def at(self, time: float, ships: FoamSegments = NO_SEGMENTS) -> SceneFoam:
        """Return the foam at a time [s], with the foam of ships."""
        return self._replace(tiles=None if self.field is None else self.field.shares(time), ships=ships)

    def reseeded(self, waves: WaveField | None, seed: int) -> SceneFoam:
        """Return the foam of another realisation of the same sea."""
        return self if self.field is None or waves is None else self._replace(field=self.field.reseeded(waves, seed), tiles=None)


CLEAR = SceneFoam()  #: A sea without foam.


def scene_foam(view: SeaView, breaking: FoamField | None) -> SceneFoam:
    """Return the foam of a scene: of breaking waves, or the mean share of the view everywhere; none for a view without foam."""
    if view.foam is None:
        return CLEAR
    return SceneFoam(view.foam.share) if breaking is None else SceneFoam(field=breaking)


@dataclass(frozen=True, eq=False)
class Levels:
    """Levels of detail of a scene, with the arcs from which on they are used."""

    detail: Detail
    begins: FloatArray  #: Arc from which on each level is used [m].
    steps: FloatArray  #: Largest step of each level [m].
    shortest: FloatArray  #: Shortest wave of each level [m].
    parts: FloatArray  #: Arcs at which every line of a column splits in two [m].
    numbers: tuple[int, ...] = (0,)  #: Number of each among all levels of detail of the sea.
    widths: tuple[float, ...] = (0.0,)  #: Width over which each level is averaged across the line of sight [m]; 0 where it is not.
    azimuth: float = 0.0  #: Azimuth of the lines of sight in the middle of the view [rad].

    @classmethod
    def calm(cls) -> Levels:
        """Return the levels of a sea without resolved waves."""
        return cls(Detail.calm(), np.zeros(1), np.zeros(1), np.full(1, np.inf), np.empty(0))

    @classmethod
    def of(
        cls,
        waves: WaveField,
        camera: Camera,
        accuracy: Accuracy,
        last: float,
        first: float = 0.0,
        finer: int = 1,
        share: float = AVERAGED_SHARE,
    ) -> Levels:
        """Return the levels that begin before the arc ``last`` [m]; of those that end before ``first``, the finest alone.

        ``finer``: columns that are drawn for each column of the camera; lines split in these. ``share``: largest share of a level's slope
        variance that an average removes (``averaged_share``).

        Raises
        ------
        DomainError
            Steps that do not suit the lattices.
        """
        # with 0 columns all waves stay geometry: one level
        every = Detail.of(waves, None if accuracy.shortest_wave_columns > 0.0 else 1)
        shortest = np.array([level.shortest_wave for level in every.levels])
        plan = partial(_averaged_plan, share=share) if averages(camera, accuracy) else _plan
        begins, chosen, widths, parts = plan(every, shortest, camera, accuracy, last, finer)
        ends = np.append(begins[1:], np.inf)
        used = (begins < last) & (ends > first)
        used[0] = True
        begins, chosen, widths = begins[used], chosen[used], widths[used]
        shortest = shortest[chosen]
        steps = shortest / accuracy.steps_per_wave if accuracy.step is None else shortest * (accuracy.step / shortest[0])
        numbers = tuple(int(n) for n in chosen)
        made = cls(every, begins, steps, shortest, parts, numbers, tuple(float(w) for w in widths), camera.azimuth)
        levels = replace(made, detail=made._chosen(every))
        cells = [levels.detail.parts[level.parts[-1]].tiles[0].spacing for level in levels.detail.levels]
        if np.any(steps * STRIP >= LONGEST_STRIP * np.array(cells)):
            raise DomainError(
                f"step = {steps[0]:g} m does not suit lattices of {cells[0]:g} m; allowed are less than {LONGEST_STRIP // STRIP} cells"
            )
        return levels

    def _chosen(self, every: Detail) -> Detail:
        return every.averaged(self.numbers, self.widths, self.azimuth)

    def reseeded(self, waves: WaveField) -> Levels:
        """Return these levels of another realisation of the same sea."""
        return replace(self, detail=self._chosen(Detail.of(waves)))

    @property
    def spacing(self) -> FloatArray:
        """Spacing of lattice points of every part [m]."""
        return np.array([part.tiles[0].spacing for part in self.detail.parts])

    def lattices(self, time: float) -> tuple[NDArray[np.float32], ...]:
        """Return heights [m] and slopes [1] of every part at a time [s]."""
        return self.detail.surfaces(time)

    def surface(self, lattices: tuple[NDArray[np.float32], ...], origin: tuple[float, float], foam: SceneFoam = CLEAR) -> Surface:
        """Return the sea of one instant, with the sensor above ``origin``, east and north [m], and its foam."""
        turn = np.array([part.tiles[0].rotation for part in self.detail.parts])
        wander = tuple(part.wander[0] for part in self.detail.parts if part.wander)
        return surface_of(
            lattices, self.spacing, turn, tuple(level.parts for level in self.detail.levels), origin, wander, self._foam(foam, origin)
        )

    def _foam(self, foam: SceneFoam, origin: tuple[float, float]) -> FoamSurface:
        """Return the foam of an instant; tiles are found among the parts of each level by their lengths."""
        if foam.field is None or foam.tiles is None:
            return even_foam(foam.share, origin, foam.ships)
        waves, parts = foam.field.waves, self.detail.parts
        length = [part.tiles[0].length for part in parts]
        rows = np.full((len(self.detail.levels), len(waves.tiles)), -1, np.int64)
        for i, level in enumerate(self.detail.levels):
            for j, p in enumerate(level.parts):
                rows[i, [tile.length for tile in waves.tiles].index(length[p])] = j
        return foam_surface(foam.tiles, waves.tiles, waves.wander, rows, origin, foam.ships)

    def bounds(self, lattices: tuple[NDArray[np.float32], ...]) -> Bounds:
        """Return the bounds of the sea that determine the steps of rays over the finest level."""
        parts = self.detail.levels[0].parts
        if not parts:
            return Bounds(0.0, 0.0, 1.0)
        crest = sum(float(lattices[p][..., 0].max()) for p in parts)
        spacing = self.spacing[list(parts)]
        return Bounds(crest, steepest_rise(tuple(lattices[p] for p in parts), spacing), float(spacing.min()))


def averages(camera: Camera, accuracy: Accuracy) -> bool:
    """Return True where one line of sight over an averaged sea may stand for many lines side by side."""
    narrow = 0.5 * camera.width <= AVERAGED_ASIDE
    return narrow and accuracy.shortest_wave_columns > 0.0 and accuracy.variance_error >= AVERAGED_ERROR


def averaged_share(solar_zenith: float) -> float:
    """Return the largest share of slope variance that an average removes under a Sun at a zenith angle [rad].

    >>> averaged_share(1.0) == averaged_share(1.7) == AVERAGED_SHARE
    True
    >>> round(averaged_share(math.radians(80.0)), 6)
    0.08
    """
    share, zenith = visible_sun(solar_zenith)
    if share == 0.0:
        return AVERAGED_SHARE
    return max(AVERAGED_SHARE * min((0.5 * math.pi - zenith) / LOW_SUN, 1.0), LEAST_SHARE)


class _PlannedPixels(NamedTuple):
    """Pixels on the mean sea at the arcs of a plan, and the shares of their variance (levels, arcs).

    A pixel averages waves that are shorter than its width or length, so that a band of slope variance ``m`` and length ``L`` adds
    ``m min(1, L/width) min(1, L/length)`` to the variance of pixels, to first order in the slopes. A level loses the variance of the bands
    that it omits.
    """

    arcs: FloatArray  #: Arcs from the sensor's foot [m].
    width: FloatArray  #: Width of a pixel [m].
    bands: FloatArray  #: Slope variance that each level adds to the next coarser one [1].
    waves: FloatArray  #: Length of the waves of each band [m].
    shown: FloatArray  #: Share of each band in the variance of pixels.
    lost: FloatArray  #: Share of the variance that each level loses.
    allowed: NDArray[np.bool_]  #: Whether the waves that a level omits span fewer columns than those that stay geometry anyway.

    @classmethod
    def of(cls, detail: Detail, shortest: FloatArray, camera: Camera, accuracy: Accuracy, last: float) -> _PlannedPixels:
        """Return the pixels of a camera up to the arc ``last`` [m]."""
        mss = np.array([sum(level.mss) for level in detail.levels])
        bands = np.append(mss[:-1] - mss[1:], mss[-1])[:, None]
        # a band's length: the geometric mean of its limits
        waves = np.append(np.sqrt(shortest[:-1] * shortest[1:]), 2.0 * shortest[-1])[:, None]
        far = max(last, camera.height)
        arcs = np.geomspace(1e-2 * min(camera.height, far), far, _ARCS)
        width, length = arcs * camera.column_step, camera.row_step * (arcs**2 + camera.height**2) / camera.height
        shown = bands * np.minimum(1.0, waves / width) * np.minimum(1.0, waves / length)
        shown /= shown.sum(axis=0)
        lost = np.concatenate([np.zeros((1, arcs.size)), np.cumsum(shown, axis=0)[:-1]])
        allowed = (width * accuracy.shortest_wave_columns >= shortest[:, None]) | (np.arange(shortest.size) == 0)[:, None]
        return cls(arcs, width, bands, waves, shown, lost, allowed)

    def gained(self, lines: int) -> FloatArray:
        """Return the share by which lines farther apart than waves overestimate the variance of pixels at each level."""
        again = self.shown * np.maximum(_LINES_PER_WAVE * self.width / (self.waves * lines) - 1.0, 0.0)
        return np.asarray(np.cumsum(again[::-1], axis=0)[::-1])


#: Arcs from which on each level is used [m], numbers of the levels, widths over which they are averaged [m], and the arcs at which lines
#: split in two [m].
_Plan = tuple[FloatArray, NDArray[np.int64], FloatArray, FloatArray]


def _splits(arcs: FloatArray, doublings: NDArray[np.int64]) -> FloatArray:
    """Return the arcs at which lines split in two [m]."""
    return np.array([float(arcs[np.argmax(doublings >= k)]) for k in range(1, int(doublings[-1]) + 1)])


def _plan(detail: Detail, shortest: FloatArray, camera: Camera, accuracy: Accuracy, last: float, finer: int) -> _Plan:
    """Return levels and lines at the least cost for the accuracy, without averages.

    Lines farther apart than ``L`` overestimate a band by the ratio of their distance to ``L``.
    """
    pixels = _PlannedPixels.of(detail, shortest, camera, accuracy, last)
    arcs, lost, most = pixels.arcs, pixels.lost, accuracy.variance_error
    best, chosen = np.full(arcs.size, np.inf), np.zeros((2, arcs.size), np.int64)
    for doublings in range(accuracy.lines_per_column.bit_length()):
        gained = pixels.gained(1 << doublings)
        for level in range(shortest.size):
            error, allowed = np.abs(gained[level] - lost[level]), pixels.allowed[level]
            good = allowed & (error <= most) & (lost[level] <= 3.0 * most)
            # where no level is good enough the one with the smallest error is used, always behind a good one
            cost = np.where(good, (1 << doublings) / shortest[level], np.where(allowed, 1e6 * (1.0 + error), np.inf))
            better = cost < best
            best[better], chosen[0, better], chosen[1, better] = cost[better], level, doublings
    # outwards, waves are only ever omitted and lines only ever split
    levels, lines = np.maximum.accumulate(chosen, axis=1)
    begins = np.array([0.0] + [float(arcs[np.argmax(levels >= k)]) if levels[-1] >= k else np.inf for k in range(1, shortest.size)])
    # the lines of a column are divided among the columns drawn for it, rounded up to a power of two
    return begins, np.arange(shortest.size), np.zeros(shortest.size), _splits(arcs, lines)[finer.bit_length() - 1 :]


def _averaged_plan(
    detail: Detail, shortest: FloatArray, camera: Camera, accuracy: Accuracy, last: float, finer: int, share: float
) -> _Plan:
    """Return levels of seas averaged across the line of sight, where one line would sample the waves of a column too coarsely.

    Lines split only where an average over their distance would remove more than ``share`` of a level's slopes: groups of waves change the
    mean of a pixel as well, and are lost with them. At the horizon, where crests from many kilometres fill a part of one row, they do not
    split.
    """
    pixels = _PlannedPixels.of(detail, shortest, camera, accuracy, last)
    arcs, most = pixels.arcs, accuracy.variance_error
    to_horizon = depression_of_range(camera.height, arcs) - horizon_depression(camera.height)
    visible = (arcs < horizon_range(camera.height)) & (to_horizon > LAST_SHARE * camera.row_step)
    good = pixels.allowed & (pixels.lost <= 3.0 * most)
    level = np.maximum.accumulate(np.max(np.where(good, np.arange(shortest.size)[:, None], 0), axis=0))
    coarse = np.maximum.accumulate(pixels.gained(finer)[level, np.arange(arcs.size)] > most)
    width, doublings = AVERAGED_WIDTH * pixels.width / finer, np.zeros(arcs.size, np.int64)
    for k in range(accuracy.lines_per_column.bit_length() - 1):
        removed = _removed(pixels, level, width / (1 << k))
        doublings[coarse & visible & (removed > share)] = k + 1
    doublings = np.maximum.accumulate(doublings)
    wanted = WIDTHS_PER_OCTAVE * np.log2(width / (1 << doublings))
    # the same widths for any view: numbers of a fixed series
    number = np.where(coarse, np.floor(wanted + 0.5), -np.inf)
    change = np.concatenate([[True], (np.diff(level) != 0) | (number[1:] != number[:-1])])
    begins = np.where(np.arange(arcs.size) > 0, arcs, 0.0)[change]
    return begins, level[change], np.exp2(number[change] / WIDTHS_PER_OCTAVE), _splits(arcs, doublings)


def _removed(pixels: _PlannedPixels, level: NDArray[np.int64], width: FloatArray) -> FloatArray:
    """Return the share of the slope variance of levels that averages over a width [m] remove, from waves of all directions."""
    sines = np.sin((np.arange(32) + 0.5) * (0.5 * np.pi / 32))[:, None]
    gone = np.array(
        [pixels.bands[k] * (1.0 - np.mean(np.sinc(sines * width / pixels.waves[k]) ** 2, axis=0)) for k in range(len(pixels.bands))]
    )
    removed, whole = (np.cumsum(each[::-1], axis=0)[::-1] for each in (gone, pixels.bands))
    return np.asarray(removed[level, np.arange(level.size)] / whole[level, 0])


class Instant(NamedTuple):
    """Sea of an instant under a sensor."""

    levels: Levels  #: Levels of detail.
    lattices: tuple[NDArray[np.float32], ...]  #: Heights [m] and slopes [1] of every part (``Levels.lattices``).
    surface: Surface  #: The lattices in the form that kernels read.


class Scene(Protocol):
    """Sea, air and Sun prepared for a camera; immutable."""

    @property
    def view(self) -> SeaView:
        """Sea, air and Sun, at the sensor's first height."""
        ...

    @property
    def layers(self) -> tuple[str, ...]:
        """Layers that images have beside ``radiance`` and ``glint_radiance``."""
        ...

    @property
    def pose(self) -> Pose:
        """Pose that the scene was prepared for, or the first pose of its track."""
        ...

    @property
    def waves(self) -> WaveField | None:
        """Part of the slopes that is geometry; None where no waves are resolved."""
        ...

    @property
    def report(self) -> Mapping[str, Any]:
        """Settings chosen during preparation, for the provenance."""
        ...

    def reseeded(self, seed: int) -> Self:
        """Return another realisation of the same sea, sparkles included, without preparing anything again."""
        ...

    @property
    def pixels(self) -> Imager:
        """The camera's pixels."""
        ...

    def seen_from(self, pose: Pose) -> SeaView:
        """Return the view of sea, air and Sun from a pose."""
        ...

    def sea(self, pose: Pose, time: float, ships: FoamSegments | None = NO_SEGMENTS) -> Instant:
        """Return the sea of an instant under a sensor, with the foam of ships; None: a sea without any foam, which takes less time."""
        ...

    def drawn(self, pose: Pose, time: float, sea: Instant | None = None) -> Layers:
        """Return the image of the scene; see :func:`image`."""
        ...

    def columns(self, pose: Pose, time: float, part: tuple[int, int], sea: Instant | None = None) -> Layers:
        """Return the image of the columns ``part = (first, end)`` alone."""
        ...

    def directions(self, pose: Pose) -> tuple[FloatArray, FloatArray]:
        """Return azimuth and elevation of pixel centres [rad]: of columns and rows of an upright camera, else of all pixels."""
        ...


def image(scene: Scene, pose: Pose, time: float, sea: Instant | None = None) -> Layers:
    """Draw a scene.

    Parameters
    ----------
    scene : Scene
        Prepared scene.
    pose : Pose
        Place and attitude of the sensor.
    time : float
        Time from the start [s].
    sea : Instant, optional
        ``scene.sea(pose, time)``, if the caller has it already.

    Returns
    -------
    Layers
        Radiance at the aperture, the mirrored Sun in it [W m-2 sr-1, (rows, columns)] and the other layers of the scene; they depend on
        the arguments alone.

    Raises
    ------
    DomainError
        A pose that the scene was not prepared for, or a crest above the sensor.
    """
    if not np.isfinite(time):
        raise DomainError(f"time = {time:g} s is not finite; give seconds from the start")
    return scene.drawn(pose, time, sea)


def joined(parts: Sequence[Layers]) -> Layers:
    """Join images side by side, from the left."""
    return Layers({name: np.concatenate([part[name] for part in parts], axis=1) for name in parts[0]})


def require_columns(part: tuple[int, int], columns: int) -> None:
    """Raise for columns ``part = (first, end)`` outside the image.

    Raises
    ------
    DomainError
        Columns outside the image, with the allowed columns.
    """
    if not 0 <= part[0] < part[1] <= columns:
        raise DomainError(f"columns {part[0]} to {part[1]} of {columns}; give 0 <= first < end <= {columns}")
