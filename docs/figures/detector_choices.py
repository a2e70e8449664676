"""Print how far the detector that a range chooses sees, against the best of all, over five cameras, four lights, sea or horizon behind.

python docs/figures/detector_choices.py [FOLDER [CAMERA]]

Margins are kept in the folder, where one is given, and a second run goes on; a CAMERA is the beginning of its name.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from typing import Any, Final

from seaglint.base.errors import SeaglintError
from seaglint.detection.detector_names import NAMES, TRIED
from seaglint.scenario.load import parse_scenario
from seaglint.store.detection_results import StudyParts, TriedDetector
from seaglint.studies.detect.designer import SMALLEST, best_of
from seaglint.studies.detect.detection_requests import RangeRequest
from seaglint.studies.detect.range_search import ALIKE, RangeScenes, first_estimate, tried_at

LEFT_OUT: Final = ("track-before-detect", "integration", "frame-difference", "temporal-profile", "patch-image")
"""Detectors of several frames, whose seas cost eight times as much and more, and one of seconds a frame."""

SINGLE: Final = tuple(name for name in NAMES if name not in LEFT_OUT)
SLOPE: Final = 0.4
"""Power of the margin that a range follows: contrast falls at least with the 2.5th power of the range."""

SEAS, PIXELS, P_FA, LIMITS = 6, (96, 64), 1e-3, (200.0, 30e3)
PHOTON: Final = {"well_capacity_e": 2e7, "bit_depth": 16}
CAMERAS: Final[dict[str, tuple[tuple[float, float], float, float, float, dict[str, Any]]]] = {
    "InSb, 15 µm, 100 mm F/4": ((3.7, 4.8), 15.0, 0.1, 4.0, {"integration_time_s": 2e-3, "quantum_efficiency": 0.8, "read_noise_e": 600.0}),
    "MCT, 15 µm, 50 mm F/2": ((7.7, 9.3), 15.0, 0.05, 2.0, {"integration_time_s": 2e-4, "quantum_efficiency": 0.7, "read_noise_e": 1000.0}),
    "uncooled, 17 µm, 35 mm F/1.1": ((7.5, 13.5), 17.0, 0.035, 1.1, {"netd_k": 0.05}),
    "uncooled, 25 µm, 50 mm F/1.4": ((8.0, 12.0), 25.0, 0.05, 1.4, {"netd_k": 0.1}),
    "uncooled, 12 µm, 14 mm F/1.0": ((8.0, 14.0), 12.0, 0.014, 1.0, {"netd_k": 0.06}),
}
LIGHTS: Final = {"night": (120.0, 40.0), "day, aside": (60.0, 40.0), "edge of the glint": (75.0, 4.0), "middle of the glint": (75.0, 0.0)}
"""Zenith angle of the Sun, and azimuth of the line of sight from it [deg]."""

HEIGHTS: Final = {"sea": 100.0, "horizon": 5.0}
"""Height of the camera for what lies behind the boat [m]."""


def scenario(camera: str, light: str, behind: str) -> Any:
    """A boat of 2 x 6 m, 6 K warmer than the water, before one camera."""
    band, pitch, focal, f_number, figures = CAMERAS[camera]
    zenith, bearing = LIGHTS[light]
    thermal = {"kind": "thermal", "netd_f_number": f_number} if "netd_k" in figures else PHOTON
    sensor = {"height_m": HEIGHTS[behind], "azimuth_deg": 180.0 + bearing, "elevation_deg": -3.0, "pixels": list(PIXELS)}
    sensor |= {"optics": {"f_number": f_number, "focal_length_m": focal}, "detector": {"pitch_um": pitch, **thermal, **figures}}
    boat = {"name": "boat", "shape": {"kind": "box", "size_m": [2, 6, 1.5]}, "temperature_k": 294.15, "north_m": 2000.0, "draught_m": 0.5}
    around = {"sun": {"zenith_deg": zenith, "azimuth_deg": 180.0}, "wind": {"speed_m_s": 5.0, "from_deg": 230.0}, "sensor": sensor}
    coarse = {"sea": {"shortest_wave_m": 4.0}, "render": {"variance_error": 0.2, "lines_per_column": 2, "tile_size": 256}}
    return parse_scenario({"seed": 21, **around, **coarse, "band": {"min_um": band[0], "max_um": band[1]}, "objects": [boat]})


def margins(cell: tuple[str, str, str], parts: StudyParts) -> list[TriedDetector]:
    """Margins of all detectors on the same frames, near the range of the best."""
    scene = scenario(*cell)
    request = RangeRequest(
        source="scenario", object="boat", threshold=3.0, injections=40, seed=2, frames=SEAS, range_limits=LIMITS, p_fa=P_FA
    )
    scenes = RangeScenes(parts)
    at = first_estimate(scene, request, None, scenes)
    tried: list[TriedDetector] = []
    for _ in range(3):
        try:
            tried = tried_at(scene, request, at, None, scenes, SINGLE)
            margin = best_of(tried).contrast_margin or SMALLEST
        except SeaglintError as error:
            print(f"{cell} at {at:.0f} m: {error}", file=sys.stderr, flush=True)
            margin = SMALLEST
        if 1.0 / ALIKE <= margin <= ALIKE:
            break
        following = min(max(at * min(max(margin**SLOPE, 0.5), 2.0), LIMITS[0]), LIMITS[1])
        if following == at:
            return []  # beyond the limits
        at = following
    return tried


def main() -> None:
    """Print the table: range of the best, and shares of it that `matched` and the chosen detector reach."""
    cells = [(camera, light, behind) for light in LIGHTS for behind in HEIGHTS for camera in CAMERAS]
    if sys.argv[2:]:
        cells = [cell for cell in cells if cell[0].startswith(sys.argv[2])]
    with tempfile.TemporaryDirectory() as folder:
        kept = sys.argv[1] if sys.argv[1:] else None
        parts = StudyParts.at(Path(kept or folder) / "choices", resume=kept is not None, overwrite=kept is None)
        print("| camera | light | behind | range of the best [m] | best of all | chosen | its share | share of `matched` |")
        print("|---|---|---|---|---|---|---|---|")
        for cell in cells:
            began = time.monotonic()
            tried = margins(cell, parts)
            if not tried or best_of(tried).contrast_margin is None:
                print(f"| {' | '.join(cell)} | - | none | - | - | - |", flush=True)
                continue
            by_name = {one.detector: (one.contrast_margin or 0.0) for one in tried}
            best, chosen = best_of(tried), best_of([one for one in tried if one.detector in TRIED])
            top = best.contrast_margin or 0.0
            shares = [(by_name[name] / top) ** SLOPE for name in (chosen.detector, "matched")]
            place = f"{' | '.join(cell)} | {best.range_m * top**SLOPE:.0f}"
            print(f"| {place} | `{best.detector}` | `{chosen.detector}` | {shares[0]:.2f} | {shares[1]:.2f} |", flush=True)
            told = ", ".join(f"{name} {margin:.3g}" for name, margin in sorted(by_name.items(), key=lambda item: -item[1]))
            print(f"{cell}, {time.monotonic() - began:.0f} s, at {best.range_m:.0f} m: {told}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
