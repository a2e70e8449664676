"""Levels of detail of a scene: from which range on each is used, and the sea of one instant at all of them."""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from seaglint.conventions import FloatArray
from seaglint.errors import DomainError
from seaglint.render.accuracy import Accuracy
from seaglint.render.camera import Camera
from seaglint.render.surface import LONGEST_STRIP, STRIP, Bounds, Surface, steepest_rise, surface_of
from seaglint.sea.detail import Detail
from seaglint.sea.field import WaveField


@dataclass(frozen=True, eq=False)
class Levels:
    """Levels of detail of a scene: ``begins`` [m] is the arc from which on each is used, ``steps`` [m] its largest step, ``shortest`` [m]
    its shortest wave.
    """

    detail: Detail
    begins: FloatArray
    steps: FloatArray
    shortest: FloatArray

    @classmethod
    def calm(cls) -> Levels:
        """A sea without resolved waves."""
        return cls(Detail.calm(), np.zeros(1), np.zeros(1), np.full(1, np.inf))

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
        begins = np.zeros(shortest.size)
        if shortest.size > 1:
            begins[1:] = shortest[1:] / (columns * camera.column_step)
        used = max(int(np.count_nonzero(begins < last)), 1)
        detail, begins, shortest = detail.first(used), begins[:used], shortest[:used]
        steps = shortest / accuracy.steps_per_wave if step is None else shortest * (step / shortest[0])
        cells = [detail.parts[level.parts[-1]].tiles[0].spacing for level in detail.levels]
        if np.any(steps * STRIP >= LONGEST_STRIP * np.array(cells)):
            raise DomainError(
                f"step = {steps[0]:g} m does not suit lattices of {cells[0]:g} m; allowed are less than {LONGEST_STRIP // STRIP} cells"
            )
        return cls(detail, begins, steps, shortest)

    @property
    def spacing(self) -> FloatArray:
        """Distance of lattice points of every part [m]."""
        return np.array([part.tiles[0].spacing for part in self.detail.parts])

    def lattices(self, time: float) -> tuple[NDArray[np.float32], ...]:
        """Heights [m] and slopes [1] of every part at a time [s]."""
        return self.detail.surfaces(time, workers=numba.get_num_threads())

    def surface(self, lattices: tuple[NDArray[np.float32], ...], origin: tuple[float, float]) -> Surface:
        """The sea of one instant, with the sensor above ``origin``, east and north [m]."""
        turn = np.array([part.tiles[0].rotation for part in self.detail.parts])
        return surface_of(lattices, self.spacing, turn, tuple(level.parts for level in self.detail.levels), origin)

    def bounds(self, lattices: tuple[NDArray[np.float32], ...]) -> Bounds:
        """What rays over the finest level step by."""
        parts = self.detail.levels[0].parts
        if not parts:
            return Bounds(0.0, 0.0, 1.0)
        crest = sum(float(lattices[p][..., 0].max()) for p in parts)
        spacing = self.spacing[list(parts)]
        return Bounds(crest, steepest_rise(tuple(lattices[p] for p in parts), spacing), float(spacing.min()))
