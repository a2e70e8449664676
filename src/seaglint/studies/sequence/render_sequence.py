"""Stored sequences of calibrated images of a scenario, and the preparation before the first frame."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, DomainError
from seaglint.base.kernel_plan import compile_ahead
from seaglint.base.threads import single_threaded_algebra, thread_limit
from seaglint.cluster import Workers
from seaglint.cluster.job import ATTEMPTS
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.attitude_scene import TurnedScene
from seaglint.imaging.camera.pose import Track, poses
from seaglint.imaging.layers import SPARKLE, Layers
from seaglint.imaging.refraction import RefractedScene, RowShift
from seaglint.imaging.scene import Scene, image
from seaglint.imaging.upright_scene import SweptScene
from seaglint.objects.drawing.compose import BodySight
from seaglint.objects.drawing.image_path import View
from seaglint.objects.drawing.light import Counting
from seaglint.optics.band import apparent_temperature
from seaglint.scenario.model import Scenario
from seaglint.scenario.sun import SunPosition, sun_position, sun_step
from seaglint.sea.foam.ship_foam import NO_SEGMENTS
from seaglint.sea.wave_field import WaveField
from seaglint.store.layout import Layout
from seaglint.store.provenance import provenance
from seaglint.store.sequence_store import Frame, check_output, write_sequence
from seaglint.store.writers import Share
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.scenario_physics import bending, require_standard_refraction
from seaglint.studies.build.waves_and_slopes import slopes
from seaglint.studies.sequence.memory import require_memory
from seaglint.studies.sequence.out_of_view import report_out_of_view
from seaglint.studies.sequence.scene_objects import DrawnImage, SceneObjects, bodies_of, motion_numbers
from seaglint.studies.sequence.sequence_work import SceneCache, spread_over

NON_FINITE_SHARE = 1e-3  #: Share of a frame's pixels that may be without a number; more are an error.


def render(
    scenario: Scenario,
    output: str | Path,
    *,
    frames: range | None = None,
    threads: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
    share: Share | None = None,
    workers: Workers | None = None,
) -> Path | str:
    """Render frames of a scenario into a Zarr store.

    Parameters
    ----------
    scenario : Scenario
        Scenario to render; see ``seaglint.scenario.load.load_scenario``.
    output : path
        Store to make, customarily ``*.zarr``.
    frames : range, optional
        Requested frames, counted from 0; all of the scenario's by default. A frame alone is equal to the frame in its sequence.
    threads : int, optional
        Processor threads; all by default. The bytes do not depend on them.
    resume, overwrite : bool
        Continue an unfinished store, or replace a store.
    progress : callable, optional
        Called with (frames done, frames in all).
    share : Share, optional
        Render the units of the share alone, into a store that other shares write too;
        ``seaglint.store.sequence_store.finish_sequence`` names it.
    workers : Workers, optional
        Workers that render; this process by default. The bytes do not depend on them.

    Returns
    -------
    path
        ``output``.

    Raises
    ------
    SeaglintError
        See ``seaglint.store.sequence_store.write_sequence`` and ``seaglint.studies.build.scenario_physics``.
    """
    check_output(output, resume=resume, overwrite=overwrite, share=share)
    report_out_of_view(scenario, frames)
    with thread_limit(threads):
        layout, images = prepared_frames((scenario, frames))
        spread = spread_over(workers, prepared_frames, (scenario, frames))
        return write_sequence(
            output, layout, images, resume=resume, overwrite=overwrite, progress=progress, share=share, spread=spread, attempts=ATTEMPTS
        )


def prepared_frames(settings: tuple[Scenario, range | None]) -> tuple[Layout, Frame]:
    """Return layout and frames of a scenario, of all frames by default."""
    run = prepare_sequence(*settings)
    return run.layout, run.images


class MovingSun:
    """Scenes of one sea under the moving Sun, prepared when a frame needs them; the latest is cached.

    A scene is a function of the requested time alone, so that any frame is equal in any part of its sequence. Waves and seed do not change
    after the start.
    """

    def __init__(self, scenario: Scenario, prepared: Callable[[SunPosition], Scene]) -> None:
        self._scenario, self._prepared = scenario, prepared
        self._latest: tuple[int, Scene] | None = None

    def scene(self, first: Scene, time: float) -> Scene:
        """Return the scene of a time from the start [s]; ``first`` is the scene of the start."""
        # Step 0 is the start, whose scene is prepared already.
        step = sun_step(self._scenario, time)
        if step == 0:
            return first
        latest = self._latest
        if latest is None or latest[0] != step:
            with single_threaded_algebra():  # as at the start: the bytes do not depend on threads
                latest = self._latest = (step, self._prepared(sun_position(self._scenario, step)))
        return latest[1]

    def reseeded(self, seed: int) -> MovingSun:
        """Return the scenes of another realisation of the sea."""
        return MovingSun(self._scenario, lambda sun: self._prepared(sun).reseeded(seed))


@dataclass(frozen=True, eq=False)
class Sequence:
    """Preparation before the first frame; make it with ``prepare_sequence``."""

    scene: Scene  #: Sea, air, Sun and camera, at the start.
    track: Track  #: Position and attitude of the sensor over time.
    layout: Layout  #: Layout of the store.
    sun: MovingSun | None = None  #: Scenes for later positions of the Sun; None if the Sun does not move.
    objects: SceneObjects | None = None  #: Objects in the scene.
    #: How a detector of photons counts the light of objects (:meth:`seaglint.instrument.photons.Photons.counted`).
    counted: Counting | None = None

    def at(self, time: float) -> Layers:
        """Return the image at a time from the start [s]."""
        return self.drawn(time).layers

    def drawn(self, time: float, columns: tuple[int, int] | None = None, *, compose: bool = True) -> DrawnImage:
        """Return the image at a time [s] with the sights of objects; of ``columns`` alone, first and end, if requested.

        Without ``compose`` objects are left out.
        """
        scene, pose = self.scene_at(time), self.track.at(time)
        if self.objects is None:
            layers = image(scene, pose, time) if columns is None else scene.columns(pose, time, columns)
            return DrawnImage(layers, layers.radiance, ())
        sea = scene.sea(pose, time, NO_SEGMENTS if scene.view.foam is None else self.objects.foam(time))
        layers = image(scene, pose, time, sea) if columns is None else scene.columns(pose, time, columns, sea)
        window = (columns or (0, scene.pixels.columns), (0, scene.pixels.rows))
        return self.objects.draw(scene, pose, time, (layers, sea), window, compose=compose)

    def sights(self, time: float, columns: tuple[int, int]) -> tuple[BodySight, ...]:
        """Return the sights of objects at a time [s] in ``columns``, first and end, over a dark sea, which is not drawn."""
        if self.objects is None:
            return ()
        scene, pose = self.scene_at(time), self.track.at(time)
        dark = np.zeros((scene.pixels.rows, columns[1] - columns[0]), np.float32)
        image = Layers({"radiance": dark, "glint_radiance": dark}), scene.sea(pose, time, None)
        return self.objects.draw(scene, pose, time, image, (columns, (0, scene.pixels.rows))).sights

    def scene_at(self, time: float) -> Scene:
        """Return the scene under the Sun of a time from the start [s]."""
        return self.scene if self.sun is None else self.sun.scene(self.scene, time)

    def reseeded(self, seed: int) -> Sequence:
        """Return another realisation of the same sea, without preparing anything again; the layout has the new seed."""
        layout = replace(self.layout, attributes={**self.layout.attributes, "seed": seed})
        sun = None if self.sun is None else self.sun.reseeded(seed)
        scene = self.scene.reseeded(seed)
        objects = None if self.objects is None else self.objects.over(scene.waves)
        return replace(self, scene=scene, layout=layout, sun=sun, objects=objects)

    def counting(self, counted: Counting | None) -> Sequence:
        """Return the sequence before a detector that counts photons, or of energy (None); the radiance of its images is the same."""
        return replace(self, counted=counted, objects=None if self.objects is None else self.objects.counting(counted))

    @single_threaded_algebra()
    def with_sea_of(self, scenario: Scenario) -> Sequence:
        """Return this sequence with the seed and the objects of another scenario, which differs in nothing else."""
        reseeded = replace(self, objects=None).reseeded(scenario.seed)
        others = SceneObjects.of if self.objects is None else self.objects.others
        objects = others(bodies_of(scenario), reseeded.scene.waves, shadows=scenario.render.object_shadows)
        objects = None if objects is None else objects.counting(self.counted)
        previous = reseeded.layout.attributes
        attributes = {**previous, **provenance(previous["title"], scenario.model_dump_json(exclude_none=True), scenario.seed)}
        layout = replace(reseeded.layout, truth=None if objects is None else objects.layout(), attributes=attributes)
        return replace(reseeded, objects=objects, layout=layout)

    def images(self, number: int) -> Mapping[str, NDArray[Any]]:
        """Return the stored arrays of a frame, by variable.

        Raises
        ------
        DataError
            Pixels without a number.
        """
        time = number / self.layout.frame_rate
        drawn = self.drawn(time)
        arrays: dict[str, NDArray[Any]] = dict(drawn.layers)
        radiance = drawn.layers.radiance
        # Single pixels without a number are accepted; many are a fault.
        bad = int(radiance.size - np.isfinite(radiance).sum())
        if bad > NON_FINITE_SHARE * radiance.size:
            raise DataError(
                f"frame {number}: {bad} of {radiance.size} pixels are not finite, more than {100 * NON_FINITE_SHARE:g} %; "
                "nothing of it is written. This is a fault of the program: please report the scenario"
            )
        if self.objects is not None:
            truth = self.objects.truth(drawn.sights, drawn.sea, self.scene_at(time), (self.scene.pixels, self.track.at(time).attitude))
            streaks = self.objects.streaks(View(self.scene.pixels, self.track), time)
            arrays |= {**truth, **motion_numbers(streaks, truth, mirage=isinstance(self.scene, RefractedScene))}
        if "apparent_temperature" in self.layout.variables:
            view = self.scene.view
            arrays["apparent_temperature"] = apparent_temperature(radiance, view.band, view.atmosphere.wavenumber_cm)
        return arrays


def _require_step(scenario: Scenario, waves: WaveField | None) -> None:
    step = scenario.render.step_m
    if step is None or waves is None:
        return
    shortest = 2.0 * np.pi / waves.tiles[-1].k_max
    # Coarser steps miss waves, finer ones take time without effect.
    if not shortest / 200.0 <= step <= 0.5 * shortest:
        raise DomainError(
            f"render.step_m = {step:g} m does not suit waves down to {shortest:.3g} m: "
            f"give {shortest / 200.0:.2g} to {0.5 * shortest:.3g} m, or leave it out"
        )


def prepare_sequence(
    scenario: Scenario,
    frames: range | None = None,
    *,
    scanned: bool = False,
    finer: int | None = None,
    fits: bool = False,
    cached: SceneCache | None = None,
) -> Sequence:
    """Prepare a sequence before its first frame, or for single frames in Python.

    ``scanned`` prepares columns with separate poses (``seaglint.studies.build.scenario_physics.gliding_camera``); ``finer`` is the
    number of pixels along a side of a detector's pixel, None without a detector; ``fits`` skips the check of the memory, which the caller
    made; ``cached`` holds the preparation that successive scenes share.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> tables = {"sensor": {"pixels": [8, 4]}, "sea": {"resolve_waves": False}}
    >>> small = parse_scenario(tables)
    >>> prepare_sequence(small).at(0.0).radiance.shape
    (4, 8)
    """
    if not fits:
        require_memory(scenario)
    if cached is None:
        return _prepared(scenario, frames, scanned, finer)
    return cached.sequence(scenario, f"{frames} {scanned} {finer}", lambda: _prepared(scenario, frames, scanned, finer))


@single_threaded_algebra()
def _prepared(scenario: Scenario, frames: range | None, scanned: bool, finer: int | None) -> Sequence:
    scenario_physics.require_drawable(scenario, slopes(scenario))
    compile_ahead("render")
    sensor = scenario.sensor
    numbers = frames if frames is not None else range(sensor.frames)
    accuracy, sparkles = scenario_physics.accuracy(scenario), scenario_physics.sparkles(scenario)
    layers, times = (*scenario.render.layers, *(() if finer is None else (SPARKLE,))), finer or 1
    camera = scenario_physics.gliding_camera(scenario) if scanned else scenario_physics.swept_camera(scenario)
    if camera is not None:
        first = scenario_physics.view(scenario)
        bent = bending(scenario, first)
        sea = scenario_physics.sea(scenario, first.slopes)
        track = scenario_physics.track(scenario)
        breaking = scenario_physics.breaking_waves(scenario, sea.waves)

        shift = None if bent is None else RowShift.of(bent, camera)
        grid = camera if shift is None else shift.standard

        def prepared(sun: SunPosition) -> Scene:
            view = scenario_physics.under(first, sun)
            scene = SweptScene.prepare(
                view, grid, sea.waves, accuracy=accuracy, layers=layers, sparkles=sparkles, finer=times, breaking=breaking
            )
            return scene if shift is None else RefractedScene(scene, shift)
    else:
        require_standard_refraction(scenario)
        sea = scenario_physics.sea(scenario, slopes(scenario))
        imager, at = scenario_physics.imager(scenario), scenario_physics.view_at(scenario)
        track = scenario_physics.track(scenario, sea.waves)
        breaking = scenario_physics.breaking_waves(scenario, sea.waves)

        def prepared(sun: SunPosition) -> Scene:
            def view(height: float) -> SeaView:
                return scenario_physics.under(at(height), sun)

            return TurnedScene.prepare(
                view, imager, track, sea.waves, accuracy=accuracy, layers=layers, sparkles=sparkles, finer=times, breaking=breaking
            )

    scene = prepared(sun_position(scenario))
    view = scene.view
    objects = SceneObjects.of(bodies_of(scenario), sea.waves, shadows=scenario.render.object_shadows)
    places = poses(track, np.asarray(numbers) / sensor.frame_rate_hz) if track.moves else {}
    # A turning sensor has directions in every frame; the layout holds those of the first.
    azimuth, elevation = scene.directions(track.at(numbers[0] / sensor.frame_rate_hz if numbers else 0.0))
    _require_step(scenario, sea.waves)
    derived = ("apparent_temperature",) if scenario.render.apparent_temperature else ()
    layout = Layout(
        azimuth_deg=np.degrees(azimuth),
        elevation_deg=np.degrees(elevation),
        frames=numbers,
        frame_rate=sensor.frame_rate_hz,
        band=view.band,
        variables=("radiance", *derived, *(name for name in scene.layers if name != SPARKLE)),
        poses=places,
        turning=track.turns,
        start=None if scenario.time is None else scenario.time.utc,
        truth=None if objects is None else objects.layout(),
        attributes=provenance(
            "Infrared image sequence of the sea",
            scenario.model_dump_json(exclude_none=True),
            scenario.seed,
            **sea.report,
            **scene.report,
            **({"platform_track": hashlib.sha256(track.time.tobytes() + track.values.tobytes()).hexdigest()} if track.moves else {}),
            solar_zenith_deg=math.degrees(view.solar_zenith),
            solar_azimuth_deg=math.degrees(view.solar_azimuth),
            atmosphere_table=scenario_physics.atmosphere_provenance(view.atmosphere),
        ),
    )
    layout = layout.in_units(sensor.frames)
    return Sequence(scene, track, layout, None if scenario.time is None else MovingSun(scenario, prepared), objects)
