"""A scenario becomes a stored sequence of calibrated images."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numba
import numpy as np
from numpy.typing import NDArray

from seaglint.conventions import FloatArray
from seaglint.errors import BackendError, DataError, DomainError
from seaglint.io.provenance import provenance
from seaglint.io.store import Layout, Progress, write_sequence
from seaglint.optics.band import apparent_temperature
from seaglint.pipeline import prepare
from seaglint.pipeline.memory import require_memory
from seaglint.render.platform import Track
from seaglint.render.renderer import Renderer
from seaglint.scenario.model import Scenario
from seaglint.sea.field import WaveField

if TYPE_CHECKING:
    from seaglint.render.view_renderer import ViewRenderer

NON_FINITE_SHARE = 1e-3
"""Share of a frame's pixels that may be without a number; more are an error."""


def render(
    scenario: Scenario,
    output: str | Path,
    *,
    frames: range | None = None,
    threads: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Render frames of a scenario into a Zarr store.

    Parameters
    ----------
    scenario : Scenario
        What to render; see :func:`seaglint.scenario.load.load_scenario`.
    output : path
        Store to make, customarily ``*.zarr``.
    frames : range, optional
        Frames wanted, counted from 0; all of the scenario's by default. A frame is the same alone as in its sequence.
    threads : int, optional
        Processor threads; all by default. The bytes do not depend on them.
    resume, overwrite : bool
        Go on with an unfinished store, or replace what is there.
    progress : callable, optional
        Called with (frames done, frames in all).

    Returns
    -------
    Path
        ``output``.

    Raises
    ------
    SeaglintError
        See :func:`seaglint.io.store.write_sequence` and :mod:`seaglint.pipeline.prepare`.
    """
    with thread_limit(threads):
        renderer, layout = renderer_and_layout(scenario, frames)
        rate, view = scenario.sensor.frame_rate_hz, renderer.view
        grid = view.atmosphere.wavenumber_cm
        derived = {
            "apparent_temperature": lambda image: apparent_temperature(image, view.band, grid),
        }

        def image(number: int) -> NDArray[np.float32]:
            total = renderer.radiances(number / rate).total
            bad = int(total.size - np.isfinite(total).sum())
            if bad > NON_FINITE_SHARE * total.size:
                raise DataError(
                    f"frame {number}: {bad} of {total.size} pixels are not finite, more than {100 * NON_FINITE_SHARE:g} %; "
                    "nothing of it is written. This is a fault of the program: please report the scenario"
                )
            return total

        return write_sequence(
            output,
            layout,
            image,
            derived={name: derived[name] for name in layout.variables if name in derived},
            resume=resume,
            overwrite=overwrite,
            progress=progress,
        )


def _require_step(scenario: Scenario, waves: WaveField | None) -> None:
    step = scenario.render.step_m
    if step is None or waves is None:
        return
    shortest = 2.0 * np.pi / waves.tiles[-1].k_max
    if not shortest / 200.0 <= step <= 0.5 * shortest:
        raise DomainError(
            f"render.step_m = {step:g} m does not suit waves down to {shortest:.3g} m: "
            f"give {shortest / 200.0:.2g} to {0.5 * shortest:.3g} m, or leave it out"
        )


def renderer_and_layout(scenario: Scenario, frames: range | None = None) -> tuple[Renderer | ViewRenderer, Layout]:
    """Everything that is made before the first frame; also the way to single frames in Python.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> small = parse_scenario({"sensor": {"pixels": [8, 4]}, "sea": {"resolve_waves": False}})
    >>> renderer, _ = renderer_and_layout(small)
    >>> renderer.radiances(0.0).total.shape
    (4, 8)
    """
    require_memory(scenario)
    sensor, track = scenario.sensor, prepare.track(scenario)
    numbers = frames if frames is not None else range(sensor.frames)
    options: dict[str, Any] = {
        "step": scenario.render.step_m,
        "most_lines": scenario.render.lines_per_column,
        "shortest_wave_columns": scenario.render.shortest_wave_columns,
        "sparkles": prepare.sparkles(scenario),
    }
    renderer: Renderer | ViewRenderer
    poses: dict[str, FloatArray] = {}
    if scenario.platform is None and sensor.projection == "equal-angle" and sensor.roll_deg == 0.0:
        view, camera = prepare.view(scenario), prepare.camera(scenario)
        sea = prepare.sea(scenario, view.slopes)
        renderer = Renderer(view, camera, sea.waves, **options)
        azimuth, elevation = camera.azimuths, camera.elevations
    else:
        from seaglint.render.view_renderer import ViewRenderer

        sea = prepare.sea(scenario, prepare.slopes(scenario))
        imager = prepare.imager(scenario)
        renderer = ViewRenderer(prepare.view_at(scenario), imager, track, sea.waves, **options)
        view = renderer.view
        azimuth, elevation = imager.centres(track.at(numbers[0] / sensor.frame_rate_hz if numbers else 0.0).attitude)
        poses = _poses(track, np.asarray(numbers) / sensor.frame_rate_hz) if track.moves else {}
    _require_step(scenario, sea.waves)
    layout = Layout(
        azimuth_deg=np.degrees(azimuth),
        elevation_deg=np.degrees(elevation),
        frames=numbers,
        frame_rate=sensor.frame_rate_hz,
        band=view.band,
        variables=("radiance", "apparent_temperature") if scenario.render.apparent_temperature else ("radiance",),
        poses=poses,
        turning=track.turns,
        attributes=provenance(
            "Infrared image sequence of the sea",
            scenario.model_dump_json(exclude_none=True),
            scenario.seed,
            **sea.report,
            **renderer.report,
            **({"platform_track": hashlib.sha256(track.time.tobytes() + track.values.tobytes()).hexdigest()} if track.moves else {}),
            solar_zenith_deg=math.degrees(view.solar_zenith),
            solar_azimuth_deg=math.degrees(view.solar_azimuth),
            atmosphere_table=prepare.atmosphere_provenance(view.atmosphere),
        ),
    )
    return renderer, layout


def _poses(track: Track, times: FloatArray) -> dict[str, FloatArray]:
    """Where the sensor is and how it is turned in every frame, by the names of the store's variables."""
    poses = [track.at(float(t)) for t in times]
    return {
        "sensor_east": np.array([p.east for p in poses]),
        "sensor_north": np.array([p.north for p in poses]),
        "sensor_height": np.array([p.height for p in poses]),
        "sensor_azimuth": np.degrees([p.attitude.azimuth for p in poses]),
        "sensor_elevation": np.degrees([p.attitude.elevation for p in poses]),
        "sensor_roll": np.degrees([p.attitude.roll for p in poses]),
    }


@contextmanager
def thread_limit(threads: int | None) -> Iterator[None]:
    """Run with a number of threads, and put the old one back.

    Raises
    ------
    BackendError
        More threads than Numba was started with.
    """
    if threads is None:
        yield
        return
    most = int(vars(numba.config)["NUMBA_NUM_THREADS"])  # set at run time, where type checkers do not see it
    if not 1 <= threads <= most:
        raise BackendError(
            f"threads = {threads}: allowed are 1 to {most} here; the environment variable NUMBA_NUM_THREADS raises the limit"
        )
    before = numba.get_num_threads()
    numba.set_num_threads(threads)
    try:
        yield
    finally:
        numba.set_num_threads(before)
