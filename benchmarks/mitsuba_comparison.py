"""The comparison with Mitsuba 3 in one run on the same processors; see :mod:`mitsuba_scene` for its terms.

The error of an image is its RMS difference from the same program's converged image over the mean, in rows more than three pixels under the
horizon. A Monte Carlo image is unbiased and two of them are independent, so its error is the RMS difference of two over the square root
of 2. The difference of the two programs' converged images is freed of the ray tracer's remaining noise in the same way, by two halves of
its rays: ``mean[(S - A) (S - B)]``.

Times are of a whole frame, warm, without file output: waves, geometry and image. The shortest of a few is told, for either program.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numba
import numpy as np

from mitsuba_scene import PIXELS, SUN_ZENITHS, compared_rows, renderer, rms_over_mean, scene
from mitsuba_sea import MitsubaSea, load_mitsuba
from seaglint.base.conventions import FloatArray
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.camera.imager import Camera
from seaglint.imaging.scene import image
from seaglint.imaging.upright_scene import SweptScene
from seaglint.sea.wave_field import WaveField

WANTED = 0.015
"""Error at which times are compared [1]."""

OURS = ((1.15, 1, 3.0), (1.0, 1, 3.0), (0.5, 1, 3.0), (0.3, 1, 3.0), (0.28, 1, 3.0), (0.2, 1, 3.0), (0.5, 1, 0.0))
"""Step [m], columns swept for one of the image, and the renderer's ``shortest_wave_columns`` (0: all waves at any range)."""

CONVERGED = (0.125, 4, 0.0)
"""Setting of the converged image: the finest step at which the sea is read at every sample.

With steps of less than a tenth of a cell heights are linear between readings a quarter of a metre apart, which takes off the tops of sharp
crests: a step of 1/16 m differs more from rays than one of 1/8 m (:data:`seaglint.imaging.wave_surface.READS_PER_CELL`).
"""

SUBDIVISION = 4
"""Parts of a cell's side in the converged image's mesh: the cell is a curved patch to the sweep, and two triangles see 0.5 % more."""

AZIMUTHS = (0.0, 3.0, 5.0, 7.0)
"""Azimuths off the Sun at which the ratio of the images is told, over half a degree to either side [deg]."""

FRAMES = 3
HALF_SAMPLES = 64
TIMED_SAMPLES = 16


@dataclass(frozen=True)
class Run:
    """One way to make the image: seconds of its parts and its error."""

    name: str
    update: float
    image: float
    error: float

    @property
    def frame(self) -> float:
        """Seconds of a frame."""
        return self.update + self.image


@dataclass(frozen=True)
class Comparison:
    """Results under one Sun."""

    sun_zenith: float
    ours: list[Run]
    theirs: list[Run]
    chosen: Run
    needed: list[Run]


@dataclass(frozen=True)
class Agreement:
    """Converged images of both programs under one Sun: sweep over Mitsuba in the mean, its standard error, RMS difference over the mean,
    and the ratio at azimuths off the Sun, both sides together (:data:`AZIMUTHS`).
    """

    sun_zenith: float
    mean_ratio: float
    mean_error: float
    rms: float
    by_azimuth: list[float]


def shortest(work: Callable[[int], object], times: int = FRAMES) -> float:
    """Shortest time of a few [s]."""
    seconds = []
    for i in range(times):
        start = time.perf_counter()
        work(i)
        seconds.append(time.perf_counter() - start)
    return min(seconds)


@dataclass(frozen=True)
class Sweep:
    """Our renderer with one setting of its accuracy, see :data:`OURS`."""

    view: SeaView
    camera: Camera
    waves: WaveField
    step: float
    across: int
    detail: float

    def prepared(self) -> SweptScene:
        """The renderer, compiled and with its tables made."""
        made = renderer(
            self.view, replace(self.camera, columns=self.camera.columns * self.across), self.waves, step=self.step, detail=self.detail
        )
        image(made, made.pose, 0.0)
        return made

    def image(self, made: SweptScene, time_s: float) -> FloatArray:
        """Reflected sunlight of the camera's own columns [W m-2 sr-1]."""
        fine = image(made, made.pose, time_s).glint_radiance
        return np.asarray(fine.reshape(self.camera.rows, self.camera.columns, self.across).mean(axis=2, dtype=np.float64))


def agreement(
    sun_zenith: float,
    *,
    pixels: tuple[int, int] = PIXELS,
    accuracy: tuple[float, int, float] = CONVERGED,
    subdivision: int = SUBDIVISION,
    half_samples: int = HALF_SAMPLES,
    time: float = FRAMES / 25.0,
) -> Agreement:
    """Render the scene converged by both programs.

    ``accuracy``: step, columns swept for one and ``shortest_wave_columns`` of the sweep, as in :data:`OURS`; ``subdivision`` of the ray
    tracer's mesh; ``half_samples``: rays a pixel in each of its two images, a square.
    """
    view, camera, waves = scene(sun_zenith, pixels)
    rows = compared_rows(camera)
    sea = MitsubaSea(view, camera, waves, threads=numba.get_num_threads(), subdivision=subdivision)
    sea.update(time)
    a, b = (sea.render(half_samples, seed)[rows] for seed in (101, 202))
    del sea
    sweep = Sweep(view, camera, waves, *accuracy)
    ours = sweep.image(sweep.prepared(), time)[rows]
    theirs = 0.5 * (a + b)
    mean = float(theirs.mean())
    off = np.abs(np.degrees(np.arctan2(np.sin(camera.azimuths - view.solar_azimuth), np.cos(camera.azimuths - view.solar_azimuth))))
    near = [np.abs(off - azimuth) <= 0.5 for azimuth in AZIMUTHS]
    return Agreement(
        sun_zenith,
        float(ours.mean()) / mean,
        # two halves of stratified rays that know nothing of each other
        float(np.sqrt(np.mean((a - b) ** 2) / a.size)) / (2.0 * mean),
        math.sqrt(max(float(np.mean((ours - a) * (ours - b))), 0.0)) / mean,
        [float(ours[:, columns].mean() / theirs[:, columns].mean()) for columns in near],
    )


def compare(sun_zenith: float, log: Callable[[str], None] = print) -> Comparison:
    """Time both programs on the scene."""
    view, camera, waves = scene(sun_zenith)
    rows = compared_rows(camera)
    last = FRAMES / 25.0

    fine = Sweep(view, camera, waves, *CONVERGED)
    converged = fine.image(fine.prepared(), last)[rows]
    log(f"Sun {sun_zenith:g} deg: sweep converged")
    ours = []
    for step, across, detail in OURS:
        sweep = Sweep(view, camera, waves, step, across, detail)
        made = sweep.prepared()
        frame = shortest(lambda i, s=sweep, m=made: s.image(m, (i + 1) / 25.0))  # type: ignore[misc]
        surface = shortest(lambda i, m=made: m.surface((i + 1) / 25.0))  # type: ignore[misc]
        error = rms_over_mean(sweep.image(made, last)[rows], converged)
        ours.append(
            Run(f"sweep, step {step:g} m{'' if detail > 0.0 else ', all waves at any range'}", surface, max(frame - surface, 0.0), error)
        )
        log(f"  {ours[-1].name}: {frame:.3f} s, {100 * error:.2f} %")
    good = [run for run in ours if run.error <= WANTED]
    chosen = min(good or ours, key=lambda run: run.frame if good else run.error)

    theirs = MitsubaSea(view, camera, waves, threads=numba.get_num_threads())
    theirs.render(TIMED_SAMPLES)
    update = shortest(lambda i: theirs.update((i + 1) / 25.0))
    theirs.update(last)
    found, needed = [], []
    for stratified in (False, True):
        runs = list(_samples(theirs, rows, update, stratified))
        found += runs
        needed.append(_needed(runs, stratified))
        for run in [*runs, needed[-1]]:
            log(f"  {run.name}: {run.update:.2f} + {run.image:.2f} s, {100 * run.error:.2f} %")
    return Comparison(sun_zenith, ours, found, chosen, needed)


def _samples(sea: MitsubaSea, rows: slice, update: float, stratified: bool) -> Iterator[Run]:
    """The ray tracer with one number of samples, and for strata, whose error falls by a power found here, with two."""
    for samples in (TIMED_SAMPLES, 4 * TIMED_SAMPLES) if stratified else (TIMED_SAMPLES,):
        images: list[FloatArray] = []
        times = []
        for seed in range(2):
            start = time.perf_counter()
            images.append(sea.render(samples, seed, stratified=stratified)[rows])
            times.append(time.perf_counter() - start)
        seconds = min(times)
        error = rms_over_mean(images[0], images[1]) / math.sqrt(2.0)
        yield Run(f"Mitsuba, {samples} {'stratified' if stratified else 'independent'} samples", update, seconds, error)


def _needed(runs: list[Run], stratified: bool) -> Run:
    """Samples for the wanted error, by the power law of the error; time grows with them in proportion."""
    power = math.log(runs[0].error / runs[1].error) / math.log(4.0) if stratified else 0.5
    last = runs[-1]
    factor = (last.error / WANTED) ** (1.0 / max(power, 0.1))
    samples = TIMED_SAMPLES * (4 if stratified else 1) * factor
    return Run(
        f"Mitsuba, {samples:.0f} {'stratified' if stratified else 'independent'} samples (extrapolated)",
        last.update,
        last.image * factor,
        WANTED,
    )


def lines(log: Callable[[str], None] = print) -> list[str]:
    """Markdown of the comparison under both Suns."""
    load_mitsuba()  # what is missing is told before anything is timed
    results = [compare(zenith, log=log) for zenith in SUN_ZENITHS]
    out = [
        "One periodic 1024 m tile with a 1 m lattice, wind 10 m/s, sensor 30 m, 1024 x 512 pixels, no air; error: RMS over mean against "
        "the program's own converged image. Mitsuba draws no thermal radiation, the sweep does. The sweep has one line a column and, but "
        "for the last row under either Sun, leaves waves shorter than three columns to the facets (`shortest_wave_columns`).",
        "",
        "| Sun's zenith angle | program | waves and geometry | image | error |",
        "| --- | --- | --- | --- | --- |",
    ]
    for r in results:
        for run in [*r.ours, *r.theirs, *r.needed]:
            mark = " (compared)" if run is r.chosen else ""
            out.append(f"| {r.sun_zenith:g}° | {run.name}{mark} | {run.update:.2f} s | {run.image:.2f} s | {100 * run.error:.2f} % |")
    out += [
        "",
        f"| Sun's zenith angle | time of Mitsuba over ours at {100 * WANTED:g} %: independent, stratified samples |",
        "| --- | --- |",
    ]
    for r in results:
        ratio = ", ".join(f"{run.frame / r.chosen.frame:.0f}" for run in r.needed)
        miss = "" if r.chosen.error <= WANTED else f" (ours has {100 * r.chosen.error:.1f} %)"
        out.append(f"| {r.sun_zenith:g}° | {ratio}{miss} |")
    return out


def agreement_lines(log: Callable[[str], None] = print) -> list[str]:
    """Markdown of how far the converged images agree; nothing of it is a time."""
    off = ", ".join(f"{azimuth:g}°" for azimuth in AZIMUTHS)
    out = [
        f"Converged images: the sweep with steps of {CONVERGED[0]:g} m and {CONVERGED[1]} lines a column, Mitsuba with {2 * HALF_SAMPLES} "
        f"stratified samples and a mesh of {SUBDIVISION} parts a lattice cell's side.",
        "",
        f"| Sun's zenith angle | sweep / Mitsuba, mean | RMS difference | mean at azimuths of {off} off the Sun |",
        "| --- | --- | --- | --- |",
    ]
    for zenith in SUN_ZENITHS:
        r = agreement(zenith)
        columns = ", ".join(f"{ratio:.4f}" for ratio in r.by_azimuth)
        out.append(f"| {r.sun_zenith:g}° | {r.mean_ratio:.4f} ± {r.mean_error:.4f} | {100 * r.rms:.2f} % | {columns} |")
        log(out[-1])
    return out
