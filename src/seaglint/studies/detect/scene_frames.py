"""Frames of independent seas of one scenario, rendered and sensed on demand and stored on disk: a source for detection."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.random import stream
from seaglint.cluster import Job, Workers
from seaglint.cluster.job import record_of
from seaglint.detection.interface import Frames
from seaglint.detection.sources import Counting, PlainFrames
from seaglint.imaging.layers import Layers
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.detector import PhotonPixels
from seaglint.scenario.model import Scenario
from seaglint.store.detection_results import keep_sea, sea_path, whole_sea
from seaglint.studies.sequence.render_sequence import Sequence, prepare_sequence
from seaglint.studies.sequence.sense import SensedFrames
from seaglint.studies.sequence.sensed_sequence import SensedSequence, drawn_in_time, drawn_of, prepare_sensed
from seaglint.version import __version__


def bare(scenario: Scenario) -> Scenario:
    """Return the scenario without objects and without layers that are not used."""
    render = scenario.render.model_copy(update={"layers": (), "apparent_temperature": False})
    return scenario.model_copy(update={"objects": None, "render": render})


def frames_key(scenario: Scenario, length: int) -> str:
    """Return the short name of frames: a digest of everything on which they depend."""
    content = f"{__version__} {length} {bare(scenario).model_dump_json(exclude_none=True)}"
    return hashlib.sha256(content.encode()).hexdigest()[:16]


def sea_seed(seed: int, number: int) -> int:
    """Return the seed of an independent sea."""
    return int(stream(seed, "independent seas", number).integers(2**62))


def counting_of(model: SensorModel) -> Counting:
    """Return the counting by a sensor of the light of an object that is added to its frames, in radiance at the aperture."""
    line = model.readout
    shot = isinstance(model.detector, PhotonPixels) and model.noise.temporal
    return Counting(line.per_radiance if shot else None, line.radiance_scale)


@dataclass(frozen=True, eq=False)
class IndependentSeas:
    """Prepared scenario, from which independent seas are drawn; make it with ``of``."""

    scenario: Scenario  #: Scenario without objects.
    sequence: Sequence  #: Rendered scene; with a sensor drawn finer than its pixels.
    sensed: SensedSequence | None  #: Sensor on that scene; None where the scenario has none.
    _lit: list[Sequence] = field(default_factory=list, repr=False)

    @classmethod
    def of(cls, scenario: Scenario) -> IndependentSeas:
        """Prepare everything that no sea changes.

        Raises
        ------
        SeaglintError
            A scene that cannot be drawn.
        """
        scene = bare(scenario)
        if scene.sensor.senses:
            sensed = prepare_sensed(scene)
            return cls(scene, sensed.fine, sensed)
        return cls(scene, prepare_sequence(scene), None)

    @property
    def model(self) -> SensorModel | None:
        """Sensor; None where the frames are radiance at the aperture."""
        return None if self.sensed is None else self.sensed.sensed.model

    @property
    def directions(self) -> tuple[FloatArray, FloatArray]:
        """Azimuth and elevation of the pixels [deg]: of columns and rows, or of all pixels."""
        layout = (self.sensed or self.sequence).layout
        return layout.azimuth_deg, layout.elevation_deg

    @property
    def size(self) -> tuple[int, int]:
        """Rows and columns."""
        columns, rows = self.scenario.sensor.pixels
        return rows, columns

    @property
    def pixel_deg(self) -> tuple[float, float]:
        """Angle between rows, and between columns on the sky [deg]."""
        sensor = self.scenario.sensor
        (width, height), (columns, rows) = sensor.fov_deg, sensor.pixels
        across = width / columns
        if sensor.projection == "equal-angle":
            # Columns of equal azimuth come closer on the sky with the elevation.
            across *= math.cos(math.radians(sensor.elevation_deg))
        return height / rows, across

    @property
    def pixel_solid_angle(self) -> float:
        """Solid angle of a pixel in the middle of the picture [sr]."""
        down, across = (math.radians(v) for v in self.pixel_deg)
        return down * across

    @property
    def saturation(self) -> float | None:
        """Radiance that no pixel goes beyond [W m-2 sr-1]; None without a sensor."""
        if self.model is None:
            return None
        line = self.model.readout
        return float(line.radiance(min(float(line.counts(line.full_scale)), float(line.top_count))))

    def with_objects(self, scenario: Scenario) -> Sequence:
        """Return the rendered scene with the objects of a scenario that differs in nothing else; the light about them is computed once."""
        self._lit[:] = [(self._lit[0] if self._lit else self.sequence).with_sea_of(scenario)]
        return self._lit[0]

    def sea(self, number: int, length: int) -> Frames:
        """Return the frames of one sea, at the scenario's frame rate, shape (length, rows, columns) [W m-2 sr-1].

        Counts of a sensor are converted to the radiance at the aperture that would give them. The sensor and its fixed pattern are the
        same for all seas; its noise is not.
        """
        sequence = self.sequence.reseeded(sea_seed(self.scenario.seed, number))
        rate = sequence.layout.frame_rate
        if self.sensed is None:
            return np.stack([np.asarray(sequence.at(k / rate).radiance, np.float32) for k in range(length)])
        # Frames are numbered over all seas, so that each has its own noise.
        sensed, first = self.sensed, number * length
        model, n = sensed.sensed.model, sensed.sensed.oversampling

        @lru_cache(1)
        def layers(frame: int) -> Layers:
            return drawn_in_time(sequence, sensed.scan, n, (frame - first) / rate).layers

        frames = SensedFrames(
            model, lambda frame: layers(frame).radiance, n, first, lambda frame: sensed.sensed.rates(frame - first),
            drawn=lambda frame: drawn_of(sequence.scene, layers(frame)),
        )  # fmt: skip
        return np.stack([np.asarray(model.readout.radiance(frames.exposure(first + k).signal), np.float32) for k in range(length)])


@dataclass(eq=False)
class SceneFrames(PlainFrames):
    """Independent seas on disk as a ``seaglint.detection.sources.FrameSource``."""

    seas: IndependentSeas  #: Prepared scenario.
    folder: Path  #: Folder of the frames, a file for each sea.
    sequence_length: int = 1  #: Frames of each sea.
    count: int = 0  #: Number of seas so far.
    workers: Workers | None = None  #: Workers that render them; this process by default.

    @property
    def frames(self) -> int:
        """Number of frames."""
        return self.count * self.sequence_length

    @property
    def rows(self) -> int:
        """Rows of a frame [px]."""
        return self.seas.size[0]

    @property
    def columns(self) -> int:
        """Columns of a frame [px]."""
        return self.seas.size[1]

    @cached_property
    def saturation(self) -> float | None:
        """Value beyond which no pixel goes [W m-2 sr-1]."""
        return self.seas.saturation

    @cached_property
    def counting(self) -> Counting | None:
        """How the light of an injected object is counted; None without a sensor."""
        return None if self.seas.model is None else counting_of(self.seas.model)

    def grow(self, count: int, go_on: Callable[[int], bool] = lambda done: True) -> int:
        """Render seas up to a number ``count``, or until ``go_on`` returns False; stored seas are used unchanged.

        Returns
        -------
        int
            Number of seas.
        """
        shape = (self.sequence_length, self.rows, self.columns)
        if self.workers is not None and count - self.count > 1:
            self._render_shared(self.workers, count, go_on)
            while self.count < count and whole_sea(self.folder, self.count, shape):
                self.count += 1
            return self.count
        while self.count < count:
            if not whole_sea(self.folder, self.count, shape):
                # The first sea is always rendered: there is no result without one.
                if self.count and not go_on(self.count):
                    break
                keep_sea(self.folder, self.count, self.seas.sea(self.count, self.sequence_length))
            self.count += 1
        return self.count

    def _render_shared(self, workers: Workers, count: int, go_on: Callable[[int], bool]) -> None:
        """Let workers render the missing seas."""
        shape = (self.sequence_length, self.rows, self.columns)
        missing = [number for number in range(self.count, count) if not whole_sea(self.folder, number, shape)]
        available = count - len(missing)
        job = Job(sea_writer, (self.seas.scenario, self.folder.absolute(), self.sequence_length))
        with workers.map(job, missing) as outcomes:
            for outcome in outcomes:
                record_of(outcome)
                available += 1
                if available < count and not go_on(available):
                    return

    def read(self, start: int, stop: int) -> Frames:
        """Return frames ``start`` to ``stop`` (not included) as a copy [W m-2 sr-1]."""
        parts = []
        length = self.sequence_length
        for number in range(start // length, (stop - 1) // length + 1):
            try:
                sea: Any = np.load(sea_path(self.folder, number), mmap_mode="r")
            except (OSError, ValueError) as error:
                raise DataError(f"{sea_path(self.folder, number)}: frames that were kept cannot be read again: {error}") from error
            parts.append(np.array(sea[max(start - number * length, 0) : stop - number * length], np.float32))
        return np.concatenate(parts)


def sea_writer(settings: tuple[Scenario, Path, int]) -> Callable[[int], None]:
    """Return a function that renders a sea by its number into its file; ``settings`` are scenario, folder and frames of a sea."""
    scenario, folder, length = settings
    seas = IndependentSeas.of(scenario)

    def write(number: int) -> None:
        keep_sea(folder, number, seas.sea(number, length))

    return write
