"""Detector of a range: the best of a short list on the same frames, and where the horizon is."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import norm

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.random import stream
from seaglint.detection.detector_names import TRIED
from seaglint.detection.named_detectors import named_for
from seaglint.detection.spot import GaussianSpot
from seaglint.detection.trials import InjectedObjects
from seaglint.scenario.load import parse_scenario
from seaglint.store.detection_results import RangePoint, StudyParts
from seaglint.studies.detect import range_search
from seaglint.studies.detect.designer import LARGEST, SMALLEST, Design, contrast_margin
from seaglint.studies.detect.detection_requests import RangeRequest
from seaglint.studies.detect.injected import ObjectSignal
from seaglint.studies.detect.near_object import rows_to_horizon
from seaglint.studies.detect.performance import DetectionOptions
from seaglint.studies.detect.range_search import RangeScenes, detection_range, doubts, horizon_note, p_d_at
from seaglint.studies.detect.scene_frames import SceneFrames, sea_seed

SPOT, SIGMA, P_FA = GaussianSpot(0.8), 2.0, 1e-2
COLUMNS, ROWS = 96, 64


@dataclass(frozen=True)
class Swell:
    """White noise over slow waves along the rows, of another phase in each sea, in the place of rendered seas."""

    scenario: Any
    amplitude = 8.0
    model = None
    saturation = None
    size = (ROWS, COLUMNS)
    pixel_deg = (0.025, 0.025)

    @classmethod
    def of(cls, scenario: Any) -> Swell:
        return cls(scenario)

    @property
    def directions(self) -> tuple[np.ndarray, np.ndarray]:
        return np.linspace(-1.2, 1.2, COLUMNS), np.linspace(-2.2, -3.8, ROWS)

    def sea(self, number: int, length: int) -> np.ndarray:
        random = stream(sea_seed(self.scenario.seed, number), "test")
        phase = random.random((length, 1, 1))
        waves = self.amplitude * np.sin(2.0 * np.pi * (np.arange(COLUMNS) / 32.0 + phase))
        return np.asarray(20.0 + waves + SIGMA * random.standard_normal((length, *self.size)), np.float32)


class White(Swell):
    """The same without waves."""

    amplitude = 0.0


@pytest.fixture
def seas(request, monkeypatch) -> None:
    for module in (range_search, range_search):
        monkeypatch.setattr(module, "IndependentSeas", request.param)
    monkeypatch.setattr(range_search, "object_signal", _seen)


def _seen(scene: Any, name: str, calm: Any) -> ObjectSignal:
    at = math.hypot(scene.objects[0].east_m, scene.objects[0].north_m)
    return ObjectSignal(SPOT, 4e7 / at**2, ROWS / 2, COLUMNS / 2)


def _asked(detector: str | None) -> tuple[Any, RangeRequest]:
    sensor = {"pixels": [COLUMNS, ROWS], "fov_deg": [2.4, 1.6], "elevation_deg": -3.0}
    scenario = parse_scenario({"seed": 5, "sensor": sensor, "objects": [{"name": "boat", "preset": "small-boat", "north_m": 2000.0}]})
    judged: dict[str, Any] = {"threshold": 3.0, "injections": 150, "placement": "centre", "match_radius": 0.0, "seed": 2, "frames": 8}
    request = RangeRequest(source="", detector=detector, p_fa=P_FA, range_limits=(300.0, 40_000.0), precision=0.15, **judged)
    return scenario, request.of_objects(["boat"])


def _found(folder: Path, detector: str | None) -> Any:
    return detection_range(*_asked(detector), StudyParts.at(folder / "found", resume=False, overwrite=True))


@pytest.mark.parametrize("seas", [White], indirect=True)
def test_a_stated_detector_is_used_as_it_is(seas: None, tmp_path: Path) -> None:
    found = _found(tmp_path, "threshold")
    assert found.detector == "threshold"
    assert found.tried == []
    assert {point.detector for point in found.points} == {"threshold"}


@pytest.mark.parametrize("seas", [Swell], indirect=True)
def test_the_default_sees_as_far_as_the_best_where_a_matched_filter_does_not(seas: None, tmp_path: Path) -> None:
    """Waves of 8 W m-2 sr-1 and 32 px hide the object from weights that add up to 1, and not from those that add up to 0."""
    chosen = _found(tmp_path, None)
    assert chosen.detector != "matched"
    scenes = RangeScenes(StudyParts.at(tmp_path / "matched", resume=False, overwrite=True))
    nearer = p_d_at(*_asked("matched"), chosen.range_m / 1.3, None, scenes)
    assert nearer.p_d < 0.5
    assert {one.detector for one in chosen.tried} == set(TRIED)
    last = [one for one in chosen.tried if one.range_m == chosen.tried[-1].range_m]
    assert max(last, key=lambda one: one.contrast_margin or 0.0).detector == chosen.detector
    assert {point.detector for point in chosen.points} == {chosen.detector}
    assert chosen.as_dict()["tried"][0]["detector"] == TRIED[0]
    assert chosen.as_row()["detector"] == chosen.detector


@pytest.mark.parametrize("seas", [White], indirect=True)
def test_in_white_noise_the_range_stays_that_of_the_closed_form(seas: None, tmp_path: Path) -> None:
    signature = SPOT.stamps(np.zeros((1, 2)))[0]
    gain = float(np.sqrt((signature**2).sum()))
    exact = math.sqrt(4e7 * gain / SIGMA / (norm.isf(P_FA) + norm.isf(0.1)))
    found = _found(tmp_path, None)
    assert found.detector in ("matched", "matched-global")
    assert found.range_m == pytest.approx(exact, rel=0.12)


@pytest.mark.parametrize("times", [0.05, 0.7, 2.0, 80.0])
def test_a_margin_is_that_of_the_gaussian_law(times: float, tmp_path: Path) -> None:
    scenario = parse_scenario({"seed": 5})
    source = SceneFrames(White(scenario), tmp_path, 1)
    source.grow(12)
    signature = SPOT.stamps(np.zeros((1, 2)))[0]
    needed = SIGMA * (norm.isf(P_FA) + norm.isf(0.1)) / float(np.sqrt((signature**2).sum()))
    options = DetectionOptions(InjectedObjects(SPOT, (1.0,), 400, "centre", 0.0, seed=2), "matched", threshold=3.0, frame_rate=25.0)
    margin = contrast_margin(source, options, times * needed, Design(p_fa=P_FA))
    if times < SMALLEST:
        assert margin is None
    else:
        # 120 objects know a P_d of 0.9 to 0.027, which is 0.16 of the 3.6 standard deviations
        assert margin == pytest.approx(min(times, LARGEST), rel=0.12)


def test_detectors_of_the_list_share_single_frames() -> None:
    noise = np.random.default_rng(1).standard_normal((2, 64, 64)).astype(np.float32)
    assert {named_for(name, SPOT, lambda: noise).lead for name in TRIED} == {0}


class Rows:
    """Rows of given elevations [deg] before a sensor 20 m above the sea."""

    scenario = parse_scenario({"sensor": {"height_m": 20.0}})

    def __init__(self, elevation: np.ndarray) -> None:
        self.size, self.directions = (elevation.size, 8), (np.zeros(8), elevation)


@pytest.mark.parametrize("seed", range(20))
def test_rows_to_the_horizon_are_counted(seed: int) -> None:
    random = np.random.default_rng(seed)
    dip = math.degrees(math.sqrt(40.0 / EFFECTIVE_EARTH_RADIUS))
    under, row, extent = random.uniform(-70.0, 130.0), int(random.integers(0, 64)), int(random.integers(0, 4))
    elevation = -dip - 0.01 * (np.arange(64) - under)  # the horizon is at row `under`, between two rows
    found = rows_to_horizon(Rows(elevation), row, extent)
    first_sea = math.floor(under) + 1
    if first_sea <= 0 or first_sea >= 64:
        assert found is None
    elif max(row - extent, 0) >= first_sea:
        assert found == row - first_sea + 1
    elif min(row + extent, 63) < first_sea:
        assert found == -(first_sea - row)
    else:
        assert found == 0


@pytest.mark.parametrize(
    ("rows", "window", "background", "says"),
    [
        (0, 2, "horizon", "lies behind the object"),
        (9, 11, "horizon", "9 rows above the object, within the 11 rows"),
        (9, 2, "horizon", "beyond the 2 rows"),
        (-5, None, "horizon", "5 rows below the object, within whole frames"),
        (-30, 2, "sky", "the sky lies behind"),
        (30, 2, "sea", None),
        (None, 2, "sea", None),
    ],
)
def test_a_note_on_the_horizon_is_true(rows: int | None, window: int | None, background: str, says: str | None) -> None:
    point = RangePoint(5e3, 0.9, [0.8, 1.0], background=background, horizon_rows=rows, window_rows=window, detector="top-hat")
    note = horizon_note(point)
    assert (note is None) == (says is None)
    assert says is None or says in note
    assert ("behind" in (note or "")) == (rows == 0 or background == "sky")
    assert doubts([point], [5e3]) == ([] if note is None else [note])
