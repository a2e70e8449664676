"""Stored sequences of counts of a scenario with a sensor: drawn finer, blurred, integrated, read out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.errors import DataError
from seaglint.base.threads import thread_limit
from seaglint.cluster import Workers
from seaglint.cluster.job import ATTEMPTS
from seaglint.imaging.attitude_scene import TurnedScene
from seaglint.imaging.layers import LEAST_SEEN, SPARKLE, Layers, share_of_glint
from seaglint.imaging.refraction import RefractedScene
from seaglint.imaging.scene import Scene
from seaglint.instrument.chain import Drawn
from seaglint.instrument.detector import PhotonPixels
from seaglint.instrument.figures_of_merit import blur_px
from seaglint.instrument.scan import ScanPattern
from seaglint.objects.drawing.truth import filled
from seaglint.optics.band import apparent_temperature
from seaglint.scenario.model import Scenario
from seaglint.scenario.presets import TABLES
from seaglint.store.layout import Layout, unpacked
from seaglint.store.sequence_store import Frame, check_output, write_sequence
from seaglint.store.writers import Share
from seaglint.studies.build.sensor_model import line_of_sight_rates, scan, sensor_attributes, sensor_model
from seaglint.studies.sequence import render_sequence as plain
from seaglint.studies.sequence.exposed_objects import ExposedObjects, ObjectLight
from seaglint.studies.sequence.memory import require_memory
from seaglint.studies.sequence.object_counts import count_numbers, counted_changes, response_arrays, response_masks
from seaglint.studies.sequence.out_of_view import report_out_of_view
from seaglint.studies.sequence.render_sequence import Sequence, prepare_sequence
from seaglint.studies.sequence.scene_objects import DrawnImage, motion_numbers
from seaglint.studies.sequence.sense import Rates, SensedFrames, require_electrons, signal_attributes
from seaglint.studies.sequence.sequence_work import SceneCache, spread_over

#: Instants at which a picture with a rolling shutter is drawn: rows take the nearest, at most a sixteenth of the readout apart.
ROLLING_PARTS: Final = 8


def render(
    scenario: Scenario,
    output: str | Path,
    *,
    frames: range | None = None,
    threads: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
    electrons: bool = False,
    radiance: bool = False,
    share: Share | None = None,
    workers: Workers | None = None,
) -> Path | str:
    """Render frames of a scenario: counts where it has a detector, else the radiance at the aperture.

    Parameters
    ----------
    scenario, output, frames, threads, resume, overwrite, progress, share, workers
        As ``seaglint.studies.sequence.render_sequence.render``.
    electrons, radiance : bool
        With a detector: write electrons, and the radiance at the aperture averaged over pixels, beside counts.

    Returns
    -------
    path
        ``output``.
    """
    require_electrons(scenario, electrons)
    if not scenario.sensor.senses:
        if electrons or radiance:
            raise DataError(
                "electrons and radiance need a detector, and the scenario has no [sensor.detector]; leave them out, or add one "
                "(radiance is written without them)"
            )
        return plain.render(
            scenario, output, frames=frames, threads=threads, resume=resume, overwrite=overwrite, progress=progress,
            share=share, workers=workers,
        )  # fmt: skip
    check_output(output, resume=resume, overwrite=overwrite, share=share)
    report_out_of_view(scenario, frames)
    with thread_limit(threads):
        settings = (scenario, frames, electrons, radiance)
        layout, images = prepared_frames(settings)
        spread = spread_over(workers, prepared_frames, settings)
        return write_sequence(
            output, layout, images, resume=resume, overwrite=overwrite, progress=progress, share=share, spread=spread, attempts=ATTEMPTS
        )


def prepared_frames(settings: tuple[Scenario, range | None, bool, bool]) -> tuple[Layout, Frame]:
    """Return layout and frames of a scenario with a detector: some or all frames, with electrons and radiance if requested."""
    scenario, frames, electrons, radiance = settings
    run = prepare_sensed(scenario, frames, electrons=electrons, radiance=radiance)
    return run.layout, run.images


@dataclass(frozen=True, eq=False)
class SensedSequence:
    """Preparation before the first frame; make it with ``prepare_sensed``."""

    fine: Sequence  #: The scene, drawn finer than the detector's pixels.
    sensed: SensedFrames  #: The sensor on it.
    scan: ScanPattern  #: Times at which columns and rows are taken.
    layout: Layout  #: Layout of the store.
    fine_scenario: Scenario  #: The scenario that is drawn: more pixels, and no sensor.

    def images(self, number: int) -> Mapping[str, NDArray[Any]]:
        """Return the stored arrays of a frame, by variable."""
        out = self.sensed.images(number, self.layout.variables)
        drawn: Any = self.sensed.fine
        if drawn.objects is not None:
            out |= self._truth(number, drawn)
        others = [name for name in self.layout.variables if name not in out]
        if not others:
            return out
        averaged = binned(drawn.drawn(number).layers, self.sensed.oversampling)
        for name in others:
            if name == "apparent_temperature":
                view = self.fine.scene.view
                out[name] = apparent_temperature(averaged["radiance"], view.band, view.atmosphere.wavenumber_cm)
            else:
                out[name] = averaged[name]
        return out

    def _truth(self, number: int, drawn: _FinePictures) -> Mapping[str, NDArray[Any]]:
        """Return the stored arrays of the objects of a frame, by variable of the group ``truth``."""
        objects = drawn.objects
        assert objects is not None
        light, sea = drawn.light(number), binned_image(drawn.drawn(number).sea, self.sensed.oversampling)
        scene = self.fine.scene_at(number / self.layout.frame_rate)
        attitude = self.fine.track.at(number / self.layout.frame_rate).attitude
        truth = objects.objects.truth(light.sights, sea, scene, (objects.imager, attitude))
        motion = motion_numbers(light.streaks, truth, blur_px(objects.model), mirage=isinstance(scene, RefractedScene))
        changes = counted_changes(light.each, self.sensed.seen(number), objects.model)
        around, touched = scene.pixels.goes_round, list(unpacked(truth["object_mask"], len(light.sights)))
        share = self.fine_scenario.render.mask_share
        masks = response_masks(changes, touched, filled(light.sights, sea.shape, around=around), share)
        return {**truth, **motion, **count_numbers(changes, objects.model), **response_arrays(masks, around=around)}


@dataclass(eq=False)
class _FinePictures:
    """Fine pictures of the sea by number, and the light of objects; the latest of both are cached.

    ``compose`` draws objects into the layers of the fine pictures too.
    """

    sequence: Sequence
    scan: ScanPattern
    oversampling: int
    objects: ExposedObjects | None
    rates: Rates
    compose: bool
    latest: tuple[int, DrawnImage] | None = field(default=None)
    lit: tuple[int, ObjectLight] | None = field(default=None)

    def __call__(self, number: int) -> NDArray[np.float32]:
        return self.drawn(number).sea

    def drawn(self, number: int) -> DrawnImage:
        if self.latest is None or self.latest[0] != number:
            time = number / self.sequence.layout.frame_rate
            self.latest = (number, drawn_in_time(self.sequence, self.scan, self.oversampling, time, compose=self.compose))
        return self.latest[1]

    def description(self, number: int) -> Drawn:
        return drawn_of(self.sequence.scene, self.drawn(number).layers)

    def light(self, number: int) -> ObjectLight:
        assert self.objects is not None
        if self.lit is None or self.lit[0] != number:
            time = number / self.sequence.layout.frame_rate
            self.lit = (number, self.objects.light(self.sequence.scene_at(time), time, self(number), self.rates(number)))
        return self.lit[1]

    def added(self, number: int) -> NDArray[np.float32] | None:
        return None if self.objects is None else self.light(number).added


def drawn_of(scene: Scene, layers: Layers) -> Drawn:
    """Return what a sensor must know about a fine picture of a scene."""
    return Drawn(layers[SPARKLE], scene.cells if isinstance(scene, TurnedScene) else 0.0)


def drawn_in_time(sequence: Sequence, pattern: ScanPattern, oversampling: int, time: float, *, compose: bool = True) -> DrawnImage:
    """Draw a fine picture with the sights of objects, each of its columns or rows at a separate instant.

    Parameters
    ----------
    sequence : Sequence
        The scene.
    pattern : ScanPattern
        Times at which columns and rows are taken.
    oversampling : int
        Fine pixels along a pixel of the detector, which share one instant.
    time : float
        Time of the frame [s].
    compose : bool
        Whether objects are drawn into it.
    """
    if pattern.instantaneous:
        return sequence.drawn(time, compose=compose)
    if pattern.kind == "staring":
        return _rolled(sequence, pattern, oversampling, time, compose)
    columns = sequence.layout.shape[2] // oversampling
    # Columns with equal delay are drawn together.
    delays = pattern.column_delays(columns)
    parts, begin = [], 0
    for end in range(1, columns + 1):
        if end < columns and delays[end] == delays[begin]:
            continue
        parts.append(sequence.drawn(time + float(delays[begin]), (begin * oversampling, end * oversampling), compose=compose))
        begin = end
    return DrawnImage.beside(parts)


def _rolled(sequence: Sequence, pattern: ScanPattern, oversampling: int, time: float, compose: bool) -> DrawnImage:
    rows = sequence.layout.shape[1] // oversampling
    delays = pattern.row_delays(rows)
    parts: list[DrawnImage] = []
    for block in np.array_split(np.arange(rows), min(ROLLING_PARTS, rows)):
        instant = time + float(delays[block].mean())
        parts.append(sequence.drawn(instant, compose=compose).rows(int(block[0]) * oversampling, (int(block[-1]) + 1) * oversampling))
    return DrawnImage.below(parts)


def binned_image(image: NDArray[np.floating[Any]], oversampling: int) -> NDArray[np.float64]:
    """Return means of an image over the detector's pixels."""
    rows, columns = image.shape[0] // oversampling, image.shape[1] // oversampling
    return np.asarray(image.reshape(rows, oversampling, columns, oversampling).mean(axis=(1, 3), dtype=np.float64))


def binned(layers: Layers, oversampling: int) -> dict[str, NDArray[np.float32]]:
    """Return means of layers over the detector's pixels; ranges and slopes over the visible sea."""

    def mean(image: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
        return binned_image(image, oversampling)

    over_sea = {"range", "slope"} & set(layers)
    out = {name: mean(layers[name]).astype(np.float32) for name in layers if name not in over_sea and name != SPARKLE}
    for name in over_sea:
        visible = np.isfinite(layers[name])
        # Distances are averaged over the sea only, weighted with its share of each fine pixel.
        share = layers["coverage"] if "coverage" in layers else visible.astype(np.float32)
        weight = mean(np.where(visible, share, 0.0))
        total = mean(np.where(visible, share * np.nan_to_num(layers[name]), 0.0))
        out[name] = np.where(weight > LEAST_SEEN, total / np.maximum(weight, LEAST_SEEN), np.nan).astype(np.float32)
    if "glint_share" in out:
        out["glint_share"] = share_of_glint(out["glint_radiance"], out["radiance"])
    return out


def prepare_sensed(
    scenario: Scenario, frames: range | None = None, *, electrons: bool = False, radiance: bool = False, cached: SceneCache | None = None
) -> SensedSequence:
    """Prepare the scene, drawn finer, and its sensor, also for single frames in Python. ``cached`` holds the preparation that scenes share.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> tables = {"optics": {"aperture_m": 0.02, "f_number": 2.0}, "detector": {"pitch_um": 15.0}}
    >>> small = parse_scenario({"sensor": {"pixels": [8, 4], **tables}, "sea": {"resolve_waves": False}})
    >>> signal = prepare_sensed(small).images(0)["signal"]
    >>> signal.shape, signal.dtype
    ((4, 8), dtype('uint16'))
    """
    model = sensor_model(scenario)
    n = scenario.render.oversampling or model.oversampling
    require_memory(scenario, n, model)
    sensor, pattern = scenario.sensor, scan(scenario)
    columns, rows = sensor.pixels
    # The drawn scenario has no sensor tables; the detector is applied to its pictures.
    finer = sensor.model_copy(update={**dict.fromkeys(TABLES), "pixels": (columns * n, rows * n)})
    settings = scenario.render.model_copy(update={"apparent_temperature": False})
    scanned = pattern.kind != "staring" and pattern.period > 0.0
    fine = scenario.model_copy(update={"sensor": finer, "render": settings})
    sequence = prepare_sequence(fine, frames, scanned=scanned, finer=n, fits=True, cached=cached)
    if isinstance(model.detector, PhotonPixels):
        sequence = sequence.counting(model.photons.counted)
    _require_track(sequence, pattern, sensor.pixels)

    def rates(number: int) -> tuple[float, float]:
        return line_of_sight_rates(sequence.track, number / sequence.layout.frame_rate, model.exposure_time, sensor.projection)

    derived = ("apparent_temperature",) if scenario.render.apparent_temperature else ()
    objects = None
    if sequence.objects is not None:
        detail = scenario.render.oversampling or model.finest
        objects = ExposedObjects.of(sequence.objects, sequence.scene, sequence.track, model, pattern, (n, detail))
    # Objects are composed into the fine picture only if a written layer needs it; counts add them separately.
    drawn = _FinePictures(sequence, pattern, n, objects, rates, bool(radiance or derived or scenario.render.layers))
    sensed = SensedFrames(model, drawn, n, rates=rates, added=drawn.added, drawn=drawn.description)
    fine_layout = sequence.layout
    layout = replace(
        fine_layout,
        azimuth_deg=_coarse(fine_layout.azimuth_deg, n),
        elevation_deg=_coarse(fine_layout.elevation_deg, n),
        variables=(
            "signal",
            *(("electrons",) if electrons else ()),
            *(("radiance",) if radiance else ()),
            *derived,
            *scenario.render.layers,
        ),
        per_frame=("saturated_share",),
        details={"signal": signal_attributes(model)},
        truth=None if fine_layout.truth is None else replace(fine_layout.truth, mask_share=scenario.render.mask_share),
        attributes={
            **fine_layout.attributes,
            "title": "Infrared image sequence of a detector looking at the sea",
            "scenario": scenario.model_dump_json(exclude_none=True),
            **sensor_attributes(model, n),
            "scan": pattern.kind,
            "scan_period_s": pattern.period,
        },
    )
    return SensedSequence(sequence, sensed, pattern, layout.in_units(sensor.frames), fine)


def _require_track(sequence: Sequence, pattern: ScanPattern, pixels: tuple[int, int]) -> None:
    """Refuse keyframes that end before the last frame's last column or row."""
    layout = sequence.layout
    if layout.frames:
        columns, rows = pixels
        delay = float(max(pattern.column_delays(columns).max(), pattern.row_delays(rows).max()))
        sequence.track.at(layout.frames[-1] / layout.frame_rate + delay)


def _coarse(angles: FloatArray, n: int) -> FloatArray:
    """Return directions of the detector's pixels: means over the fine pixels, of columns or rows, or of all pixels."""
    return np.asarray(angles.reshape(-1, n).mean(axis=1)) if angles.ndim == 1 else binned_image(angles, n)
