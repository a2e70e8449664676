"""Levels of detail of a scene: the range from which each is used, and the sea of one instant at all of them."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.imaging.accuracy import Accuracy
from seaglint.imaging.camera.image_grid import Camera
from seaglint.imaging.launch import surface_of
from seaglint.imaging.wave_surface import LONGEST_STRIP, STRIP, Bounds, Surface, steepest_rise
from seaglint.sea.detail import Detail
from seaglint.sea.field import WaveField

_ARCS = 2000  #: Number of ranges at which the beginning of levels is searched: to half a per cent.


#: Number of lines that sample a wave, per its length: with fewer the variance of pixels grows, as seen from 10 m to 3 km.
_LINES_PER_WAVE = 4.0


@dataclass(frozen=True, eq=False)
class Levels:
    """Levels of detail of a scene, with the arcs from which on they are used.

    The fields are ``begins`` [m], the arc from which on each is used, ``steps`` [m], its largest step, and ``shortest`` [m], its shortest
    wave; at the arcs ``parts`` [m] every line of a column splits in two.
    """

    detail: Detail
    begins: FloatArray
    steps: FloatArray
    shortest: FloatArray
    parts: FloatArray

    @classmethod
    def calm(cls) -> Levels:
        """Levels of a sea without resolved waves."""
        return cls(Detail.calm(), np.zeros(1), np.zeros(1), np.full(1, np.inf), np.empty(0))

    @classmethod
    def of(cls, waves: WaveField, camera: Camera, accuracy: Accuracy, last: float) -> Levels:
        """Levels that begin before the arc ``last`` [m].

        Raises
        ------
        DomainError
            Steps that do not suit the lattices.
        """
        columns, step = accuracy.shortest_wave_columns, accuracy.step
        detail = Detail.of(waves, None if columns > 0.0 else 1)
        shortest = np.array([level.shortest_wave for level in detail.levels])
        begins, parts = _plan(detail, shortest, camera, accuracy, last)
        used = max(int(np.count_nonzero(begins < last)), 1)
        detail, begins, shortest = detail.first(used), begins[:used], shortest[:used]
        steps = shortest / accuracy.steps_per_wave if step is None else shortest * (step / shortest[0])
        cells = [detail.parts[level.parts[-1]].tiles[0].spacing for level in detail.levels]
        if np.any(steps * STRIP >= LONGEST_STRIP * np.array(cells)):
            raise DomainError(
                f"step = {steps[0]:g} m does not suit lattices of {cells[0]:g} m; allowed are less than {LONGEST_STRIP // STRIP} cells"
            )
        return cls(detail, begins, steps, shortest, parts)

    @property
    def spacing(self) -> FloatArray:
        """Spacing of lattice points of every part [m]."""
        return np.array([part.tiles[0].spacing for part in self.detail.parts])

    def lattices(self, time: float) -> tuple[NDArray[np.float32], ...]:
        """Heights [m] and slopes [1] of every part at a time [s]."""
        return self.detail.surfaces(time, workers=numba.get_num_threads())

    def surface(self, lattices: tuple[NDArray[np.float32], ...], origin: tuple[float, float]) -> Surface:
        """Sea of one instant, with the sensor above ``origin``, east and north [m]."""
        turn = np.array([part.tiles[0].rotation for part in self.detail.parts])
        wander = tuple(part.wander[0] for part in self.detail.parts if part.wander)
        return surface_of(lattices, self.spacing, turn, tuple(level.parts for level in self.detail.levels), origin, wander)

    def bounds(self, lattices: tuple[NDArray[np.float32], ...]) -> Bounds:
        """Bounds of the sea that determine the steps of rays over the finest level."""
        parts = self.detail.levels[0].parts
        if not parts:
            return Bounds(0.0, 0.0, 1.0)
        crest = sum(float(lattices[p][..., 0].max()) for p in parts)
        spacing = self.spacing[list(parts)]
        return Bounds(crest, steepest_rise(tuple(lattices[p] for p in parts), spacing), float(spacing.min()))


def _plan(detail: Detail, shortest: FloatArray, camera: Camera, accuracy: Accuracy, last: float) -> tuple[FloatArray, FloatArray]:
    """Arc from which on each level is used, and arcs at which lines split in two [m], at the least cost for a given variance of pixels.

    A pixel averages waves that are shorter than it is wide or long, so that a band of slope variance ``m`` and length ``L`` adds
    ``m min(1, L/width) min(1, L/length)`` to the variance of pixels, to first order in the slopes. A level loses the part of the bands that
    it leaves out; with lines farther apart than ``L`` a band counts as often as they are.
    """
    mss = np.array([sum(level.mss) for level in detail.levels])
    bands = np.append(mss[:-1] - mss[1:], mss[-1])[:, None]
    waves = np.append(np.sqrt(shortest[:-1] * shortest[1:]), 2.0 * shortest[-1])[:, None]
    far = max(last, camera.height)
    arcs = np.geomspace(1e-2 * min(camera.height, far), far, _ARCS)
    width, length = arcs * camera.column_step, camera.row_step * (arcs**2 + camera.height**2) / camera.height
    shown = bands * np.minimum(1.0, waves / width) * np.minimum(1.0, waves / length)
    shown /= shown.sum(axis=0)
    lost = np.concatenate([np.zeros((1, arcs.size)), np.cumsum(shown, axis=0)[:-1]])
    best, chosen = np.full(arcs.size, np.inf), np.zeros((2, arcs.size), np.int64)
    most = accuracy.variance_error
    for doublings in range(accuracy.lines_per_column.bit_length()):
        again = shown * np.maximum(_LINES_PER_WAVE * width / (waves * (1 << doublings)) - 1.0, 0.0)
        gained = np.cumsum(again[::-1], axis=0)[::-1]
        for level in range(shortest.size):
            error = np.abs(gained[level] - lost[level])
            allowed = (width * accuracy.shortest_wave_columns >= shortest[level]) | (level == 0)
            good = allowed & (error <= most) & (lost[level] <= 3.0 * most)
            # where no level is good enough the one with the smallest error is used, always behind a good one
            cost = np.where(good, (1 << doublings) / shortest[level], np.where(allowed, 1e6 * (1.0 + error), np.inf))
            better = cost < best
            best[better], chosen[0, better], chosen[1, better] = cost[better], level, doublings
    levels, lines = np.maximum.accumulate(chosen, axis=1)
    begins = np.array([0.0] + [float(arcs[np.argmax(levels >= k)]) if levels[-1] >= k else np.inf for k in range(1, shortest.size)])
    parts = np.array([float(arcs[np.argmax(lines >= k)]) for k in range(1, int(lines[-1]) + 1)])
    return begins, parts
