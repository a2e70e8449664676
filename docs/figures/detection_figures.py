"""Draw detection in rendered seas into docs/images and print the table of needed contrasts for docs/validation/detection.md.

python docs/figures/detection_figures.py [azimuth] [contrasts] [pictures] [ranges] [FOLDER]

Frames are kept in the folder, where one is given.
"""

from __future__ import annotations

import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from itertools import repeat
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from pictures import save
from seaglint.base.errors import SeaglintError
from seaglint.detection.design import by_windows
from seaglint.detection.injection import Batch, inject
from seaglint.detection.spot import GaussianSpot
from seaglint.detection.trials import InjectedObjects
from seaglint.plot.detection_report import draw_characteristic, draw_chips, draw_map, draw_ranges
from seaglint.scenario.load import parse_scenario
from seaglint.store.detection_results import DetectionRange, StudyParts
from seaglint.studies.detect.designer import Design, design, rate_threshold
from seaglint.studies.detect.detection_requests import RangeRequest, SceneRequest
from seaglint.studies.detect.injected import point_shape
from seaglint.studies.detect.performance import DetectionOptions, detect
from seaglint.studies.detect.range_search import detection_range
from seaglint.studies.detect.rendered_seas import lead_of, run_scene
from seaglint.studies.detect.scene_frames import IndependentSeas, SceneFrames, frames_key

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
SUN = 240.0
BASE: dict[str, Any] = {"seed": 11, "sun": {"zenith_deg": 70.0, "azimuth_deg": SUN}, "wind": {"speed_m_s": 5.0, "from_deg": 205.0}}
SENSOR: dict[str, Any] = {
    "optics": {"focal_length_m": 0.05, "f_number": 4.0},
    "detector": {"pitch_um": 15.0, "integration_time_s": 4e-4, "quantum_efficiency": 0.8, "well_capacity_e": 7e6, "read_noise_e": 600},
}
DETECTORS = ("threshold", "matched", "top-hat", "ca-cfar", "temporal-profile")
PIXEL_DEG = float(np.degrees(15e-6 / 0.05))
SEAS = 16
BUOY: dict[str, Any] = {
    "name": "buoy",
    "shape": {"kind": "cylinder", "radius_m": 0.4, "length_m": 1.0},
    "temperature_k": 300.0,
    "north_m": 2000.0,
    "height_m": 0.5,
}
WINDS = (3.0, 7.0)
BEARINGS = (0.0, 90.0, 180.0, 30.0, 15.0, 60.0, 135.0)
SINGLE = (640, 1)
"""Independent seas and frames of each, for detectors of one frame: 5.9 million pixels of 192 x 48."""
TEMPORAL = (32, 32)
"""The same where earlier frames are needed: sixteen windows in each sea, 4.7 million pixels."""


def scene(azimuth: float, pixels: tuple[int, int], pixel_deg: float, *, elevation: float, sensor: bool = False) -> Any:
    """A scenario that looks there, before or behind the sensor."""
    looks = {"height_m": 30.0, "azimuth_deg": azimuth, "elevation_deg": elevation, "pixels": list(pixels)}
    field = SENSOR if sensor else {"fov_deg": [n * pixel_deg for n in pixels]}
    return parse_scenario({**BASE, "sensor": {**looks, **field}})


def azimuths(parts: StudyParts) -> None:
    """P_d and P_fa of one moving object from the open sea to the middle of the corridor."""
    columns, rows, pixel = 288, 72, 0.15
    scenario = scene(SUN + 0.5 * columns * pixel - 4.0, (columns, rows), pixel, elevation=-6.0)
    seas = IndependentSeas.of(scenario)
    azimuth, _ = seas.directions
    shape, contrast = GaussianSpot(0.7), 6.0
    figure = Figure(figsize=(9.0, 7.2), layout="constrained")
    grid = figure.add_gridspec(3, 3)
    upper, lower = figure.add_subplot(grid[0, :]), figure.add_subplot(grid[1, :])
    away = (azimuth - SUN + 180.0) % 360.0 - 180.0
    bins = np.arange(-3.0, away[-1], 3.0)
    where = np.digitize(away, bins) - 1
    source = None
    for name in ("top-hat", "matched-local", "ca-cfar", "temporal-profile", "track-before-detect"):
        injections = 600 if name == "track-before-detect" else 4000  # it is slow
        template = InjectedObjects(shape, (contrast,), injections, velocity=(0.0, 0.5), match_radius=1.0, seed=3)
        options = DetectionOptions(template, detector=name, threshold=3.0, frame_rate=25.0)
        length = lead_of(options.detector, options.time_limit, shape) + 1
        source = SceneFrames(seas, parts.frames(frames_key(scenario, length)), length)
        source.grow(SEAS)
        found = detect(source, options)
        at = rate_threshold(found, Design(p_fa=1e-3))
        scores = found.trials.scores[0]
        hits = scores.detected(at.sigma)
        which = where[scores.column]
        z = np.stack([found.judged.z(k, "sigma") for k in range(found.judged.windows)])
        known, over = np.isfinite(z).sum(axis=(0, 1)), (z > at.sigma).sum(axis=(0, 1))
        middle = bins[:-1] + 1.5
        rate = [hits[which == k].mean() if (which == k).sum() > 10 else np.nan for k in range(middle.size)]
        false = [over[where == k].sum() / max(known[where == k].sum(), 1) for k in range(middle.size)]
        told = " ".join(f"{r:.2f}" for r in rate)
        print(f"{name}: threshold {at.sigma:.2f}, P_d {by_windows(scores, at.sigma, 0.95).rate:.2f}; by azimuth {told}", flush=True)
        upper.plot(middle, rate, marker="o", markersize=3, label=name)
        lower.plot(middle, np.maximum(false, 1e-6), marker="o", markersize=3)
    upper.set(
        ylabel="P_d", ylim=(-0.02, 1.02), title=f"object of {contrast:g} W m⁻² sr⁻¹, half a pixel a frame; P_fa 1e-3 over the whole field"
    )
    upper.legend(fontsize=8, frameon=False, ncols=5)
    lower.set(ylabel="P_fa per pixel", yscale="log", xlabel="azimuth from the Sun [deg]")
    assert source is not None
    frame = source.read(0, 1)[0]
    for k, (title, angle) in enumerate((("middle of the corridor", 0.0), ("edge", 12.0), ("open sea", 30.0))):
        column = int(np.abs(away - angle).argmin())
        column = min(max(column, 20), columns - 21)
        image = frame.copy()
        inject(image[None], Batch(0, np.array([rows // 2]), np.array([column]), np.zeros((1, 2))), shape, contrast)
        axes = figure.add_subplot(grid[2, k])
        axes.imshow(image[:, column - 20 : column + 21], cmap="gray", interpolation="nearest")
        axes.set(xticks=[], yticks=[])
        axes.set_title(f"{title}: the object is in the middle", fontsize=8)
    save(figure, IMAGES / "detection_azimuth.png")


def needed(seas: IndependentSeas, name: str, parts: StudyParts) -> str:
    """A cell of the table: contrast for P_d 0.9 at 1e-6, loss against white noise, and whether the rate is to be believed."""
    # a still object is its own background to a temporal filter
    (count, length), still = (TEMPORAL, 1) if name == "temporal-profile" else (SINGLE, 0)
    shape, share = point_shape(seas.model)
    source = SceneFrames(seas, parts.frames(frames_key(seas.scenario, length)), length)
    source.grow(count)
    options = DetectionOptions(InjectedObjects(shape, (1.0,), 600, seed=5, duration=still), detector=name, threshold=3.5)
    try:
        found = detect(source, options)
        told = design(found, source, options, Design(p_fa=1e-6, injections=600))
    except SeaglintError as error:
        print(f"{name}: {error}", file=sys.stderr)
        return "none"
    low, high = told.p_fa_interval
    rate = f"{told.threshold_how} at {told.threshold_sigma:.2f} sigma, {told.p_fa:.2g} ({low:.2g} to {high:.2g})"
    loss = "" if told.loss_db is None else f" ({told.loss_db:+.1f} dB)"
    cell = f"{told.contrast / share:.3g}{loss}{'' if told.believed else ' ?'}"
    print(f"{name}: {cell}; {found.alarms.cells.pixels} pixels, {rate}, {told.note or ''}", file=sys.stderr, flush=True)
    return cell


def contrasts(parts: StudyParts) -> None:
    """Contrast for P_d 0.9 at 1e-6, corridor and open sea, before and behind the sensor."""
    columns = []
    for sensor in (False, True):
        for azimuth in (SUN, SUN + 60.0):
            seas = IndependentSeas.of(scene(azimuth, (192, 48), PIXEL_DEG, elevation=-2.5, sensor=sensor))
            columns.append([needed(seas, name, parts) for name in DETECTORS])
    print("| detector | corridor, aperture | open sea, aperture | corridor, sensor | open sea, sensor |")
    print("|---|---|---|---|---|")
    for name, *cells in zip(DETECTORS, *columns, strict=True):
        print(f"| `{name}` | {' | '.join(cells)} |")


def pictures(parts: StudyParts) -> None:
    """Characteristic, misses and false alarms of one detector in the corridor behind a sensor, and where false alarms are."""
    shared: dict[str, Any] = {"threshold": 3.0, "injections": 1000, "seed": 5}
    wanted = SceneRequest("scenario", detector="ca-cfar", contrast=(10.0, 15.0, 20.0, 30.0, 40.0), frames=3 * SEAS, **shared)
    case = run_scene(scene(SUN + 5.0, (96, 64), PIXEL_DEG, elevation=-2.5, sensor=True), wanted, parts)
    chips = draw_chips(case.chips, case.result["threshold_sigma"])
    assert chips is not None
    save(chips, IMAGES / "detection_chips.png")
    save(draw_characteristic(case.roc, case.rows, "W m⁻² sr⁻¹"), IMAGES / "detection_roc.png")
    wide = scene(SUN + 8.0, (160, 48), 0.15, elevation=-5.0)
    wanted = SceneRequest("scenario", detector="top-hat", frames=SEAS, **shared)
    save(draw_map(run_scene(wide, wanted, parts).map), IMAGES / "detection_map.png")


def range_of(wind: float, bearing: float, parts: StudyParts) -> DetectionRange:
    """Range of detection of the buoy in a wind [m/s] from the Sun, at a bearing from the Sun [deg]."""
    field = {"height_m": 30.0, "fov_deg": [96 * PIXEL_DEG, 32 * PIXEL_DEG], "pixels": [96, 32]}
    weather = {"sun": BASE["sun"], "wind": {"speed_m_s": wind, "from_deg": SUN}}
    scenario = parse_scenario({"seed": 11, **weather, "sensor": field, "objects": [BUOY]})
    request = RangeRequest(
        source="scenario",
        object="buoy",
        detector="top-hat",
        threshold=3.5,
        injections=150,
        seed=5,
        frames=12,
        range_limits=(1000.0, 30_000.0),
        p_d=0.5,
        p_fa=1e-3,
        precision=0.3,
    )
    found = detection_range(scenario, request, parts, bearing_deg=bearing)
    points = [f"{p.range_m:.0f} m {p.p_d:.2f} ({p.visible_share:.2f} seen)" for p in found.points]
    print(f"{wind:g} m/s, {bearing:g} deg: {found.range_m} {found.note or ''}; {', '.join(points)}", flush=True)
    return replace(found, parameters={"wind": f"{wind:g} m/s"})


def ranges(parts: StudyParts) -> None:
    """Range of detection of a buoy against wind and bearing from the Sun."""
    cases = [(wind, bearing) for wind in WINDS for bearing in BEARINGS]
    with ProcessPoolExecutor() as workers:
        halves = list(workers.map(range_of, *zip(*cases, strict=True), repeat(parts)))
    # the wind comes from the Sun and the buoy is round: one half of the circle is the mirror image of the other
    mirrored = [replace(one, bearing_deg=360.0 - one.bearing_deg) for one in halves if one.bearing_deg not in (None, 0.0, 180.0)]
    save(draw_ranges(halves + mirrored), IMAGES / "detection_range.png")


def main() -> None:
    """Make what is named, or all."""
    names = ("azimuth", "contrasts", "pictures", "ranges")
    wanted = [name for name in sys.argv[1:] if name in names] or names
    kept = [name for name in sys.argv[1:] if name not in names]
    with tempfile.TemporaryDirectory() as folder:
        parts = StudyParts.at(Path(kept[0] if kept else folder) / "figures", resume=bool(kept), overwrite=not kept)
        if "contrasts" in wanted:
            contrasts(parts)
        if "azimuth" in wanted:
            azimuths(parts)
        if "pictures" in wanted:
            pictures(parts)
        if "ranges" in wanted:
            ranges(parts)


if __name__ == "__main__":
    main()
