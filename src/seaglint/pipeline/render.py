"""A scenario becomes a stored sequence of calibrated images."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numba
import numpy as np

from seaglint.errors import BackendError
from seaglint.io.provenance import provenance
from seaglint.io.store import Layout, Progress, write_sequence
from seaglint.optics.band import apparent_temperature
from seaglint.pipeline import prepare
from seaglint.render.renderer import Renderer
from seaglint.scenario.model import Scenario


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
        return write_sequence(
            output,
            layout,
            lambda number: renderer.radiances(number / rate).total,
            derived={name: derived[name] for name in layout.variables if name in derived},
            resume=resume,
            overwrite=overwrite,
            progress=progress,
        )


def renderer_and_layout(scenario: Scenario, frames: range | None = None) -> tuple[Renderer, Layout]:
    """Everything that is made before the first frame; also the way to single frames in Python.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> small = parse_scenario({"sensor": {"pixels": [8, 4]}, "sea": {"resolve_waves": False}})
    >>> renderer, _ = renderer_and_layout(small)
    >>> renderer.radiances(0.0).total.shape
    (4, 8)
    """
    view, camera = prepare.view(scenario), prepare.camera(scenario)
    sea = prepare.sea(scenario, view.slopes)
    renderer = Renderer(view, camera, sea.waves, step=scenario.render.step_m, most_lines=scenario.render.lines_per_column)
    layout = Layout(
        azimuth_deg=np.degrees(camera.azimuths),
        elevation_deg=np.degrees(camera.elevations),
        frames=frames if frames is not None else range(scenario.sensor.frames),
        frame_rate=scenario.sensor.frame_rate_hz,
        band=view.band,
        variables=("radiance", "apparent_temperature") if scenario.render.apparent_temperature else ("radiance",),
        attributes=provenance(
            "Infrared image sequence of the sea",
            scenario.model_dump_json(exclude_none=True),
            scenario.seed,
            **sea.report,
            **renderer.report,
            solar_zenith_deg=math.degrees(view.solar_zenith),
            solar_azimuth_deg=math.degrees(view.solar_azimuth),
            atmosphere_table=prepare.atmosphere_provenance(view.atmosphere),
        ),
    )
    return renderer, layout


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
