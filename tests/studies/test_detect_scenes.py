"""Detection in scenes: independent seas, sweeps, stops, resuming, needed contrasts and ranges, on a stand-in for the renderer."""

from __future__ import annotations

import csv
import json
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.stats import norm
from stored_frames import StoredFrames

from seaglint.analysis import Recording
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.errors import DataError, DomainError, ScenarioError
from seaglint.base.random import stream
from seaglint.detection.background import Background, Windows, count_false_alarms
from seaglint.detection.design import WhiteFrames, as_threshold, contrast_for, gaussian_threshold, loss_db
from seaglint.detection.matched import Matched
from seaglint.detection.named_detectors import named_for
from seaglint.detection.rare_alarms import rare_tail
from seaglint.detection.scoring import interval_of_sequences
from seaglint.detection.sources import Counting, Rescaled, level_shift
from seaglint.detection.spatial import FilterThreshold
from seaglint.detection.spot import FineSpot, GaussianSpot
from seaglint.detection.trials import InjectedObjects, run_trials
from seaglint.imaging.wave_surface import course, height
from seaglint.scenario.changed_scenario import middle_of
from seaglint.scenario.load import parse_scenario
from seaglint.store.detection_results import DetectionCase, RangePoint, StudyParts
from seaglint.studies.detect import range_search
from seaglint.studies.detect import range_search as detect_range
from seaglint.studies.detect import rendered_seas as detect_scene
from seaglint.studies.detect.designer import threshold_or_count
from seaglint.studies.detect.detection_requests import DesignRequest, RangeRequest, SceneRequest
from seaglint.studies.detect.injected import ObjectSignal, Strength, fine_response, object_signal, point_shape, spot_of
from seaglint.studies.detect.near_object import NearRows, background_of
from seaglint.studies.detect.range_search import RangeScenes, detection_range, placed_at
from seaglint.studies.detect.rendered_seas import Clock, run_scene
from seaglint.studies.detect.scene_frames import IndependentSeas, SceneFrames, sea_seed
from seaglint.studies.detect.study import run_study
from seaglint.studies.detect.varied_cases import cases_of, parse_vary
from seaglint.studies.sequence.render_sequence import prepare_sequence

SIGMA = 2.0
SCENE = """seed = 5
[wind]
speed_m_s = 7.0
[sensor]
pixels = [48, 40]
fov_deg = [1.2, 1.0]
elevation_deg = -3.0
[[objects]]
name = "boat"
preset = "small-boat"
north_m = 2000
"""


@dataclass(frozen=True)
class WhiteSeas:
    """Frames of white noise, sigma 2 W m-2 sr-1 at 5 m/s and in proportion to the wind, in the place of rendered ones."""

    scenario: Any

    model = None
    saturation = None

    @classmethod
    def of(cls, scenario: Any) -> WhiteSeas:
        return cls(scenario)

    @property
    def size(self) -> tuple[int, int]:
        columns, rows = self.scenario.sensor.pixels
        return rows, columns

    @property
    def directions(self) -> tuple[np.ndarray, np.ndarray]:
        rows, columns = self.size
        return np.linspace(-0.6, 0.6, columns), np.linspace(-2.5, -3.5, rows)

    pixel_deg = (0.025, 0.025)
    pixel_solid_angle = math.radians(0.025) ** 2

    def sea(self, number: int, length: int) -> np.ndarray:
        noise = stream(sea_seed(self.scenario.seed, number), "test").standard_normal((length, *self.size))
        return np.asarray(20.0 + SIGMA / 5.0 * self.scenario.wind.speed_m_s * noise, np.float32)


@pytest.fixture(autouse=True)
def white(monkeypatch, request) -> None:
    if "validation" not in request.keywords:
        monkeypatch.setattr(detect_scene, "IndependentSeas", WhiteSeas)
        monkeypatch.setattr(detect_range, "IndependentSeas", WhiteSeas)
        monkeypatch.setattr(range_search, "IndependentSeas", WhiteSeas)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "scene.toml").write_text(SCENE)
    return tmp_path / "scene.toml"


JUDGED: dict[str, Any] = {"threshold": 3.0, "injections": 400, "placement": "centre", "match_radius": 0.0, "seed": 2}


def scene_request(**changes: Any) -> SceneRequest:
    kind = DesignRequest if "p_fa" in changes else SceneRequest
    return kind("scenario", object_sigma_px=0.8, **{"frames": 12, **JUDGED, **changes})


def range_request(**changes: Any) -> RangeRequest:
    shared = {"frames": 8, "detector": "threshold", "object": "boat", "range_limits": (500.0, 20_000.0), "p_fa": 1e-2}
    return RangeRequest("scenario", **{**shared, **JUDGED, **changes})


def parts_at(tmp_path: Path, **how: bool) -> StudyParts:
    return StudyParts.at(tmp_path / "found", **({"resume": False, "overwrite": True} | how))


def test_windows_stay_inside_their_sequence() -> None:
    place = Windows(frames=15, length=5, lead=3)
    assert (place.each, place.count) == (2, 6)
    assert [place.start(k) for k in range(6)] == [0, 1, 5, 6, 10, 11]
    # false alarms are counted with an empty frame between sequences
    assert [place.of_event(k) for k in (0, 1, 3, 4, 6)] == [0, 1, 2, 3, 4]


def test_seas_do_not_mix() -> None:
    frames = np.zeros((6, 32, 32), np.float32) + np.repeat([0.0, 100.0, 7.0], 2)[:, None, None].astype(np.float32)
    frames += np.random.default_rng(1).normal(size=frames.shape).astype(np.float32)
    source = StoredFrames(frames, sequence_length=2)
    background = Background(named_for("frame-difference", GaussianSpot(0.8), lambda: frames), source)
    # a difference across two seas would be about 100
    assert background.windows == 3
    assert np.nanmax(np.abs(background.statistic)) < 10.0
    count = count_false_alarms(background, background.threshold(2.5, "sigma"))
    assert count.alarms.empty_frames == 2


def test_interval_of_sequences_counts_what_they_share() -> None:
    # whole sequences of ten go together: the variance is ten times that of independent trials
    generator = np.random.default_rng(3)
    hits = 10.0 * (generator.random(4000) < 0.3)
    found = interval_of_sequences(hits, np.full(4000, 10.0), None, 0.95)
    assert found.inflation == pytest.approx(10.0, rel=0.1)
    # 0.3 ± 1.96 sqrt(0.21 / 4000)
    assert found.high - found.low == pytest.approx(2 * 1.96 * math.sqrt(0.21 / 4000), rel=0.1)


def test_fine_spot_is_what_pixels_integrate() -> None:
    steps, sigma, reach = 5, 0.5, 4
    u = np.arange(-reach * steps, reach * steps + 1) / steps
    profile = norm.cdf((u + 0.5) / sigma) - norm.cdf((u - 0.5) / sigma)
    spot, exact = FineSpot(np.outer(profile, profile), steps), GaussianSpot(sigma)
    offsets = np.array([[0.0, 0.0], [0.37, -0.21], [-0.5, 0.5]])
    centre = spot.half, exact.half
    near = [s.stamps(offsets)[:, c - 2 : c + 3, c - 2 : c + 3] for s, c in zip((spot, exact), centre, strict=True)]
    # cubic splines at a fifth of a pixel: 1e-3 of the peak
    np.testing.assert_allclose(near[0], near[1], atol=2e-3)
    assert spot.share == pytest.approx((norm.cdf(0.5 / sigma) - norm.cdf(-0.5 / sigma)) ** 2, rel=2e-3)


def test_response_of_a_drawn_picture_keeps_place_and_light() -> None:
    steps, size = 3, 9
    picture = np.zeros((size * steps, size * steps))
    picture[13, 13] = -18.0  # in the middle of pixel 4, a third of it along each side
    response = fine_response(picture, steps, lambda p: p.reshape(size, steps, size, steps).mean(axis=(1, 3)))
    shape, peak = spot_of(response, steps)
    assert peak == pytest.approx(-2.0)
    assert np.abs(response).sum() / steps**2 == pytest.approx(2.0)
    assert shape.stamps(np.zeros((1, 2))).sum() == pytest.approx(1.0, abs=0.05)


def test_contrast_needed_in_white_noise_is_the_q_functions() -> None:
    source = WhiteFrames(12, 128, 128, 5.0, SIGMA, seed=4, sequence_length=1)
    background = Background(FilterThreshold(), source)
    objects = InjectedObjects(GaussianSpot(0.8), (1.0,), 3000, "centre", 0.0, seed=1)
    found = contrast_for(background, source, objects, as_threshold(gaussian_threshold(1e-4)), 0.9)
    exact = SIGMA * (norm.isf(1e-4) + norm.isf(0.1))
    # 3000 objects: P_d 0.9 is known to 0.0055, a contrast to 0.0055 / phi(1.28) = 0.03 standard deviations; four of them
    assert found.contrast == pytest.approx(exact, abs=0.13 * SIGMA)
    assert found.low < exact < found.high
    assert loss_db(2.0 * exact, exact) == pytest.approx(6.0206)
    like = WhiteFrames.like(source, 9)
    assert (like.mean, like.sigma) == pytest.approx((5.0, SIGMA), rel=0.01)


def test_a_scene_of_white_noise_gives_the_q_functions(tmp_path: Path) -> None:
    scenario = parse_scenario({"wind": {"speed_m_s": 5.0}, "sensor": {"pixels": [48, 40]}})
    case = run_scene(scenario, scene_request(contrast=(8.0,), p_fa=1e-3), parts_at(tmp_path))
    result = case.result
    assert result["p_d_interval"][0] < norm.sf(3.0 - 8.0 / SIGMA) < result["p_d_interval"][1]
    assert result["p_fa"] == pytest.approx(norm.sf(3.0), rel=0.6)
    assert (result["stopped"], result["seas"], result["contrast_unit"]) == ("frames", 12, "W m-2 sr-1")
    # white noise against white noise: no loss, within what 400 objects tell (0.35 dB each)
    assert result["design"]["loss_db"] == pytest.approx(0.0, abs=1.2)
    assert result["design"]["contrast"] == pytest.approx(SIGMA * (norm.isf(1e-3) + norm.isf(0.1)), rel=0.1)
    # objects are spread over all seas
    assert result["injections"] == 400
    rate = result["false_alarms"]["pixels_per_frame"] * 25.0 / (0.025**2 * 48 * 40)
    assert result["false_alarms"]["pixels_per_deg2_s"] == pytest.approx(rate)
    assert sum(map(sum, case.map.pixels)) == 12 * 48 * 40
    assert len(case.chips.missed[0].pixels) == 25
    # what a file keeps is the whole of it
    held = DetectionCase({"wind.speed_m_s": 5.0}, {"seed": 0}, case)
    stored = json.loads(json.dumps(held.as_dict(), allow_nan=False))
    assert DetectionCase.of(stored) == held


def test_it_stops_at_the_stated_precision_or_the_time(tmp_path: Path) -> None:
    scenario = parse_scenario({"wind": {"speed_m_s": 5.0}, "sensor": {"pixels": [48, 40]}})
    many = scene_request(contrast=(6.0,), frames=64, precision=0.2)
    case = run_scene(scenario, many, parts_at(tmp_path))
    assert (case.stopped, case.result["seas"]) == ("precision", 8)
    assert "stated precision is reached" in case.result["notes"][-1]
    ticks = iter(range(10_000))
    case = run_scene(scenario, replace(many, precision=0.001), parts_at(tmp_path), clock=Clock(5.0, now=lambda: float(next(ticks))))
    assert case.stopped == "time budget"
    assert 1 <= case.result["seas"] < 8
    assert "--resume" in case.result["notes"][-1]


def test_dark_objects_are_found_as_bright_ones_are(tmp_path: Path) -> None:
    scenario = parse_scenario({"wind": {"speed_m_s": 5.0}, "sensor": {"pixels": [48, 40]}})
    found = run_scene(scenario, scene_request(contrast=(-10.0,)), parts_at(tmp_path)).result
    assert found["p_d"] == pytest.approx(norm.sf(3.0 - 5.0), abs=0.05)
    assert found["sweep"][0]["contrast_pixel"] == -10.0


def test_cases_of_a_scenario(path: Path, tmp_path: Path) -> None:
    found = cases_of(path, vary=["wind.speed_m_s=2,14 kn", "detector=matched,log", "objects.boat.north_m=500"])
    assert len(found) == 4
    assert found[2].scenario.wind.speed_m_s == pytest.approx(7.2022, abs=1e-3)
    assert found[3].study == {"detector": "log"}
    assert found[0].scenario.objects[0].north_m == 500.0
    (tmp_path / "cases.csv").write_text("wind.speed_m_s,sun.zenith_deg\n2,40\n5,\n")
    rows = cases_of(path, table=tmp_path / "cases.csv")
    assert [case.parameters for case in rows] == [{"wind.speed_m_s": 2, "sun.zenith_deg": 40}, {"wind.speed_m_s": 5}]
    for text, says in (("wind.speed_m_s=99", "wind.speed_m_s = 99"), ("wind.sped=2", "wind.sped"), ("objects.raft.north_m=1", "raft")):
        with pytest.raises(ScenarioError, match=says):
            cases_of(path, vary=[text])
    with pytest.raises(DataError, match="KEY=VALUE"):
        parse_vary(["wind.speed_m_s"])


def test_a_study_goes_on_where_it_was_and_loses_nothing(path: Path, tmp_path: Path, monkeypatch) -> None:
    cases = cases_of(path, vary=["wind.speed_m_s=4,8", "detector=threshold,nowhere:nothing"])
    drawn: list[int] = []
    whole = WhiteSeas.sea
    monkeypatch.setattr(WhiteSeas, "sea", lambda self, number, length: drawn.append(number) or whole(self, number, length))
    request = scene_request(contrast=(6.0,), frames=6)
    study = run_study(cases, request, parts_at(tmp_path))
    assert [case.error is not None for case in study.cases] == [False, True, False, True]
    assert "nowhere" in study.errors[0]
    assert study.unfinished
    first, before = study.rows(), len(drawn)
    assert [row["wind.speed_m_s"] for row in first] == [4, 4, 8, 8]
    assert first[0]["sensor.height_m"] == 30.0
    assert first[0]["p_d"] > first[2]["p_d"]
    again = run_study(cases, request, parts_at(tmp_path, resume=True, overwrite=False))
    assert again.rows() == first
    assert len(drawn) == before  # finished cases draw nothing anew
    late = run_study(cases[:3], replace(request, time_budget=0.0), parts_at(tmp_path))
    assert late.stopped is not None
    assert (len(late.cases), late.cases[0].stopped) == (1, "time budget")
    with pytest.raises(DataError, match="resume=True"):
        parts_at(tmp_path, overwrite=False)


def test_frames_of_a_sea_depend_on_its_number_alone(tmp_path: Path) -> None:
    seas = WhiteSeas.of(parse_scenario({"sensor": {"pixels": [16, 8]}}))
    (tmp_path / "a").mkdir()
    source = SceneFrames(seas, tmp_path / "a", 3)  # type: ignore[arg-type]
    assert source.grow(4, lambda done: done < 2) == 2
    assert source.grow(4) == 4
    np.testing.assert_array_equal(source.read(5, 8), np.concatenate([seas.sea(1, 3)[2:], seas.sea(2, 3)[:2]]))
    assert sea_seed(1, 0) != sea_seed(1, 1) != sea_seed(2, 1)


def test_range_is_found_by_bisection(path: Path, tmp_path: Path, monkeypatch) -> None:
    scenario = cases_of(path)[0].scenario
    # a point whose contrast falls with the square of its range: P_d 0.9 at the contrast of the q functions
    monkeypatch.setattr(
        detect_range,
        "object_signal",
        lambda scene, name, calm: ObjectSignal(GaussianSpot(0.8), 2e7 / math.hypot(*_place(scene)) ** 2, 20.0, 24.0),
    )
    found = detection_range(scenario, range_request(), parts_at(tmp_path), bearing_deg=90.0)
    sigma = SIGMA / 5.0 * 7.0
    exact = math.sqrt(2e7 / (sigma * (norm.isf(1e-2) + norm.isf(0.1))))
    assert found.range_m == pytest.approx(exact, rel=0.06)
    low, high = found.range_interval_m
    assert high / low < 1.04
    moved = placed_at(scenario, "boat", 2000.0, 90.0)
    assert moved.sensor.azimuth_deg == pytest.approx(scenario.sun.azimuth_deg + 90.0)
    # 30 m above the sea, 2 km away, and the Earth's curvature
    assert moved.sensor.elevation_deg == pytest.approx(-math.degrees(30.0 / 2000.0), abs=0.05)
    with pytest.raises(DataError, match="raft"):
        placed_at(scenario, "raft", 2000.0, None)


@pytest.mark.parametrize("range_m", [2e3, 8e3, 20e3])
@pytest.mark.parametrize("height", [0.0, 12.0])
def test_the_camera_points_at_the_object_over_the_round_earth(path: Path, range_m: float, height: float) -> None:
    """Line of sight between two points of the effective Earth by vectors; at 20 km the sea lies 1.4 mrad below a plane's."""
    scenario = cases_of(path)[0].scenario
    boat = scenario.objects[0].model_copy(update={"height_m": height})
    sensor = placed_at(scenario.model_copy(update={"objects": (boat,)}), "boat", range_m, 90.0).sensor
    angle, eye, point = range_m / EFFECTIVE_EARTH_RADIUS, EFFECTIVE_EARTH_RADIUS + sensor.height_m, EFFECTIVE_EARTH_RADIUS + height
    elevation = math.degrees(math.atan2(point * math.cos(angle) - eye, point * math.sin(angle)))
    assert sensor.elevation_deg == pytest.approx(elevation, abs=1e-3)


@dataclass(frozen=True)
class WarmHorizon(WhiteSeas):
    """White noise over a sea that brightens towards a horizon 12 pixels above the object, and a sky brighter still."""

    @property
    def directions(self) -> tuple[np.ndarray, np.ndarray]:
        rows, columns = self.size
        dip = math.degrees(math.sqrt(2.0 * self.scenario.sensor.height_m / EFFECTIVE_EARTH_RADIUS))
        return np.linspace(-0.6, 0.6, columns), -dip - 0.025 * (np.arange(rows) - (rows / 2 - 12.5))

    def sea(self, number: int, length: int) -> np.ndarray:
        rows = self.size[0]
        under = np.arange(rows) - (rows / 2 - 12.5)
        level = np.where(under > 0.0, 60.0 / (1.0 + 0.2 * np.abs(under)), 90.0 + under)
        return super().sea(number, length) + np.asarray(level[:, np.newaxis], np.float32)


@pytest.mark.parametrize(
    ("columns", "blur_px", "amplitude", "extinction_m", "p_fa"),
    [
        (160, 0.8, 4e7, 1e9, 1e-2),
        (96, 0.6, 2e8, 8000.0, 1e-2),
        (128, 1.2, 1e9, 4000.0, 3e-3),
        (200, 1.0, 6e6, 1e9, 1e-3),
        (160, 1.5, -4e8, 5000.0, 1e-2),
    ],
)
def test_ranges_are_those_of_the_closed_form_under_a_warm_sky(
    tmp_path: Path, monkeypatch, columns: int, blur_px: float, amplitude: float, extinction_m: float, p_fa: float
) -> None:
    """Five cameras and objects: contrast A exp(-r/L) / r^2, P_d = Q(Q^-1(P_fa) - c h.s / (sigma |h|)), whatever the sky is like."""
    for module in (detect_range, range_search):
        monkeypatch.setattr(module, "IndependentSeas", WarmHorizon)
    spot = GaussianSpot(blur_px)

    def contrast(at: float) -> float:
        return amplitude * math.exp(-at / extinction_m) / at**2

    def seen(scene: Any, name: str, calm: Any) -> ObjectSignal:
        return ObjectSignal(spot, contrast(math.hypot(*_place(scene))), scene.sensor.pixels[1] / 2, columns / 2)

    monkeypatch.setattr(detect_range, "object_signal", seen)
    sensor = {"pixels": [columns, 96], "fov_deg": [0.025 * columns, 2.4], "elevation_deg": -3.0}
    boat = {"name": "boat", "preset": "small-boat", "north_m": 2000.0}
    scenario = parse_scenario({"seed": 5, "wind": {"speed_m_s": 5.0}, "sensor": sensor, "objects": [boat]})
    weights, signature = Matched(spot.stamps(np.zeros((1, 2)))[0]).weights, spot.stamps(np.zeros((1, 2)))[0]
    gain = float((weights * signature).sum() / np.sqrt((weights**2).sum()))
    exact = brentq(lambda r: abs(contrast(r)) * gain / SIGMA - norm.isf(p_fa) - norm.isf(0.1), 100.0, 1e5)
    request = range_request(detector="matched", frames=24, range_limits=(300.0, 40_000.0), p_fa=p_fa)
    found = detection_range(scenario, request, parts_at(tmp_path))
    print(f"closed form {exact:.0f} m, first estimate {found.first_estimate_m:.0f} m, found {found.range_m:.0f} m")
    assert found.range_m == pytest.approx(exact, rel=0.10)
    assert found.first_estimate_m == pytest.approx(exact, rel=0.15)
    assert {point.background for point in found.points} == {"sea" if blur_px < 1.5 else "horizon"}  # wide ones come near it
    assert not any("rises" in warning for warning in found.warnings)


def _place(scene: Any) -> tuple[float, float]:
    return scene.objects[0].east_m, scene.objects[0].north_m


def test_the_level_of_a_recording_is_in_a_fixed_threshold() -> None:
    frames = np.random.default_rng(1).normal(0.0, 1.0, (2, 32, 32)).astype(np.float32)
    source = StoredFrames(frames, saturation=8.0, offset=1000.0)
    assert level_shift(FilterThreshold(), source) == pytest.approx(1000.0)
    # the matched filter's weights keep no level, an average does
    assert level_shift(named_for("log", GaussianSpot(0.8), lambda: frames), source) == pytest.approx(0.0, abs=0.5)
    raised = Rescaled(source, level=1000.0)
    assert raised.saturation == 1008.0
    assert raised.read(0, 1).mean() == pytest.approx(1000.0, abs=0.2)
    turned = Rescaled(source, -1.0)
    assert turned.saturation is None
    np.testing.assert_array_equal(turned.read(0, 2), -frames)


def test_a_rescaled_source_counts_the_same_electrons() -> None:
    """Light of one unit of the source is ``factor`` units of the rescaled one: its electrons and its steps of the converter stay."""
    frames = np.random.default_rng(1).normal(0.0, 1.0, (2, 32, 32)).astype(np.float32)
    source = StoredFrames(frames, saturation=8.0, counting=Counting(50.0, 0.5))
    doubled = Rescaled(source, 2.0, 3.0)
    assert doubled.saturation == 19.0
    assert doubled.counting == Counting(25.0, 1.0)
    np.testing.assert_allclose(doubled.read(0, 2), 2.0 * frames + 3.0, rtol=1e-6)
    assert Rescaled(source, -2.0).counting == Counting(None, 1.0)
    assert Rescaled(StoredFrames(frames), 2.0, 3.0).saturation is None
    assert Rescaled(StoredFrames(frames)).counting is None


def test_a_rate_of_few_pixels_is_told_and_not_believed() -> None:
    # one bright line in each of two frames: no forty events for a tail, and 20 pixels above any threshold below it
    frames = np.random.default_rng(1).normal(0.0, 1.0, (2, 32, 32)).astype(np.float32)
    frames[:, 7, 4:14] += 100.0
    source = StoredFrames(frames)
    background = Background(FilterThreshold(), source)
    threshold = background.threshold(3.0, "sigma")
    count = count_false_alarms(background, threshold)
    tail = rare_tail(count.alarms.curve(), count.alarms.events(3.0))
    found = threshold_or_count(count, tail, 0.011)
    assert 20 <= found.p_fa * 2048 <= 22
    assert found.low < found.p_fa < found.high
    assert (found.how, found.believed) == ("counted", False)
    with pytest.raises(DataError, match="has no threshold"):
        threshold_or_count(count, tail, 1e-6)


def test_objects_of_some_rows_stay_there() -> None:
    source = WhiteFrames(6, 64, 64, 0.0, 1.0, sequence_length=1)
    background = Background(FilterThreshold(), source)
    objects = InjectedObjects(GaussianSpot(0.5), (5.0,), 200, match_radius=0.0, only_rows=(30, 33))
    found = run_trials(background, source, objects, background.threshold(3.0, "sigma"))
    assert set(found.scores[0].row.tolist()) == {30, 31, 32}
    assert len(set(found.scores[0].window.tolist())) == 6
    with pytest.raises(DomainError, match="hold no object"):
        run_trials(background, source, replace(objects, only_rows=(0, 1)), background.threshold(3.0, "sigma"))


def test_command_writes_tidy_tables_pictures_and_a_report(path: Path, tmp_path: Path, capsys, monkeypatch) -> None:
    import sys

    from seaglint.cli.app import main

    def seaglint(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["seaglint", *map(str, arguments)])
        with pytest.raises(SystemExit) as left:
            main()
        printed = capsys.readouterr()
        return left.value.code if isinstance(left.value.code, int) else 0, printed.out, printed.err

    common = ("detect", path, "--objects", "gaussian", "--contrast", "4,8", "--threshold", "3", "--frames", "6", "--progress", "none")
    out = tmp_path / "found"
    code, text, _ = seaglint(*common, "--vary", "wind.speed_m_s=4,8", "--injections", "150", "-o", out, "--report", tmp_path / "r.html")
    assert code == 0
    assert "contrast 8 W m-2 sr-1: P_d" in text
    rows = list(csv.DictReader(Path(f"{out}.csv").read_text().splitlines()))
    assert [(row["wind.speed_m_s"], row["contrast"]) for row in rows] == [("4", "4.0"), ("4", "8.0"), ("8", "4.0"), ("8", "8.0")]
    assert float(rows[1]["p_d_low"]) <= float(rows[1]["p_d"]) <= float(rows[1]["p_d_high"])
    for name in ("found_roc.png", "found_map.png", "found_chips.png"):
        assert (tmp_path / name).read_bytes()[:4] == b"\x89PNG"
    report = (tmp_path / "r.html").read_text()
    assert "Against wind.speed_m_s" in report
    assert report.count("data:image/png") >= 7
    assert not (tmp_path / "found.parts").exists()
    for options, says in (
        (("--frame-rate", "25"), "a scenario says itself"),
        (("--resume",), "with -o RESULT"),
        (("--intensity", "5"), "give one of them"),
        (("--vary", "wind.speed_m_s=-3"), "wind.speed_m_s = -3"),
    ):
        code, _, error = seaglint(*common, *options)
        assert code == 2, options
        assert says in error
    assert seaglint(*common[:2], "--contrast", "0", "-o", tmp_path / "none")[0] == 2
    assert not (tmp_path / "none.parts").exists()
    np.save(tmp_path / "clip.npy", np.zeros((2, 32, 32), np.float32))
    assert "for scenarios" in seaglint("detect", tmp_path / "clip.npy", "--contrast", "4", "--design")[2]
    assert "do not vary" in seaglint("detect", tmp_path / "clip.npy")[2]


@pytest.mark.parametrize(
    ("command", "bare"),
    [
        ("scene", ("--objects", "gaussian", "--contrast", "4,8", "--vary", "wind.speed_m_s=4,8")),
        ("design", ("--design", "--objects", "gaussian", "--p-fa", "1e-2")),
        pytest.param(
            "range",
            ("--range", "--object", "boat", "--p-fa", "1e-2", "--bearings", "0,90", "--range-limits", "500:20000"),
            marks=pytest.mark.validation,
        ),
    ],
)
@pytest.mark.parametrize("form", [(), ("--json",)])
def test_both_spellings_of_a_command_print_the_same(
    command: str, bare: tuple[str, ...], form: tuple[str, ...], path: Path, capsys, monkeypatch
) -> None:
    import sys

    from seaglint.cli.app import main

    seen = ObjectSignal(GaussianSpot(0.8), 5.0, 20.0, 24.0)
    monkeypatch.setattr(
        detect_range, "object_signal", lambda scene, name, calm: replace(seen, contrast=2e7 / math.hypot(*_place(scene)) ** 2)
    )
    printed = []
    for words in (("detect", command, *(word for word in bare if word != f"--{command}")), ("detect", *bare)):
        common = ("--threshold", "3", "--frames", "6", "--injections", "100", "--progress", "none", *form)
        monkeypatch.setattr(sys, "argv", ["seaglint", *words, str(path), *common])
        with pytest.raises(SystemExit) as left:
            main()
        assert not left.value.code
        printed.append(capsys.readouterr().out)
    assert printed[0] == printed[1] != ""


def test_strength_in_watts_needs_a_range() -> None:
    with pytest.raises(DomainError, match="give range_m"):
        Strength((5.0,), "W/sr")
    with pytest.raises(DomainError, match="contrast = 0"):
        Strength((0.0,))


@pytest.mark.validation
def test_rendered_seas_are_independent_and_repeat(tmp_path: Path) -> None:
    tables = {
        "optics": {"focal_length_m": 0.05, "f_number": 4.0},
        "detector": {"pitch_um": 15.0, "integration_time_s": 1e-3, "well_capacity_e": 7e6},
    }
    scenario = parse_scenario({"sensor": {"pixels": [32, 24], "elevation_deg": -4.0, "height_m": 30.0, **tables}})
    seas = IndependentSeas.of(scenario)
    first, second = seas.sea(0, 2), seas.sea(1, 2)
    np.testing.assert_array_equal(first, IndependentSeas.of(scenario).sea(0, 2))
    spatial = [(frame - frame.mean(axis=1, keepdims=True)).ravel() for frame in (first[0], second[0], first[1])]
    # two seas have nothing in common, two frames of one 0.04 s apart have
    assert abs(np.corrcoef(spatial[0], spatial[1])[0, 1]) < 0.3
    assert np.corrcoef(spatial[0], spatial[2])[0, 1] > 0.5
    shape, share = point_shape(seas.model)
    # all the light of a point arrives, up to what is cut beyond the edge
    assert share * shape.stamps(np.array([[0.3, -0.2]])).sum() == pytest.approx(1.0, abs=0.06)
    watts = Strength((100.0,), "W/sr", 5000.0).at_aperture(seas, float(first.mean()))[0]
    vacuum = 100.0 / 5000.0**2 / seas.pixel_solid_angle
    assert 0.1 * vacuum < watts < vacuum
    kelvin = Strength((1.0, -1.0), "K").at_aperture(seas, float(first.mean()))
    assert 0.8 < -kelvin[0] / kelvin[1] < 1.3


@pytest.mark.validation
def test_a_drawn_point_is_seen_as_its_shape_says() -> None:
    tables = {
        "optics": {"focal_length_m": 0.05, "f_number": 4.0},
        "detector": {"pitch_um": 15.0, "integration_time_s": 1e-3, "well_capacity_e": 7e6},
    }
    point = {"name": "point", "shape": {"kind": "point", "intensity_w_sr": 500.0}, "north_m": 4000.0, "height_m": 20.0}
    scenario = parse_scenario(
        {"sensor": {"pixels": [48, 40], "elevation_deg": -0.3, "azimuth_deg": 0.0, "height_m": 30.0, **tables}, "objects": [point]}
    )
    seen = object_signal(scenario, "point")
    seas = IndependentSeas.of(scenario)
    _, share = point_shape(seas.model)
    watts = Strength((500.0,), "W/sr", 4000.0, 20.0).at_aperture(seas, 1.0)[0]
    # the renderer's path, distance and pixel against the formula's; the fine pixel of the drawing smears by a few per cent
    assert seen.contrast == pytest.approx(share * watts, rel=0.08)


class HalfHidden(ObjectSignal):
    """An object that every second sea hides, and every fourth leaves half of."""

    def visible_shares(self, count: int, seas: Any) -> np.ndarray:
        return np.resize([0.0, 1.0, 0.0, 0.5], count)


def test_waves_before_an_object_count_in_its_detection(path: Path, tmp_path: Path, monkeypatch) -> None:
    scenario = cases_of(path)[0].scenario
    contrast = 12.0 * SIGMA / 5.0 * 7.0
    monkeypatch.setattr(detect_range, "object_signal", lambda scene, name, calm: HalfHidden(GaussianSpot(0.8), contrast, 20.0, 24.0))
    found = detect_range.p_d_at(scenario, range_request(), 1000.0, None, RangeScenes(parts_at(tmp_path)))
    # at twelve and six standard deviations all that is seen is found
    assert found.p_d == pytest.approx(0.5, abs=0.01)
    assert found.visible_share == pytest.approx(0.375)
    low, high = found.p_d_interval
    # eight seas say a half to 0.35 either way
    assert low == pytest.approx(0.15, abs=0.03)
    assert high == pytest.approx(0.85, abs=0.03)
    monkeypatch.setattr(HalfHidden, "visible_shares", lambda self, count, seas: np.zeros(count))
    gone = detect_range.p_d_at(scenario, range_request(), 1200.0, None, RangeScenes(parts_at(tmp_path)))
    assert gone.p_d == 0.0
    assert "hidden behind waves" in gone.note
    assert RangePoint.of(json.loads(json.dumps(found.as_dict()))) == found
    assert RangePoint.of(gone.as_dict()) == gone
    assert "believed" not in gone.as_dict()


@pytest.mark.validation
def test_seas_hide_a_post_as_lines_of_sight_over_the_same_seas_say() -> None:
    eye, far, seas = 8.0, 3000.0, 24
    post = {"name": "post", "shape": {"kind": "box", "size_m": [0.3, 0.3, 1]}, "temperature_k": 300, "height_m": 0.5, "north_m": far}
    sensor = {"pixels": [48, 40], "fov_deg": [1.4, 1.2], "elevation_deg": -0.2, "azimuth_deg": 0.0, "height_m": eye}
    scenario = parse_scenario({"seed": 3, "sensor": sensor, "wind": {"speed_m_s": 10.0}, "objects": [post]})
    shares = object_signal(scenario, "post").visible_shares(seas, IndependentSeas.of(scenario))
    sequence = prepare_sequence(scenario)
    arcs = np.arange(1800.0, far + 0.1, 0.4)
    drop = eye + arcs**2 / (2.0 * EFFECTIVE_EARTH_RADIUS)
    counted = []
    for number in range(seas):
        sea = sequence.reseeded(sea_seed(scenario.seed, number))
        surface = sea.scene.sea(sea.track.at(0.0), 0.0).surface
        line = course(surface, 0, 0.0, 1.0, (arcs[0], arcs[-1]))
        heights = np.array([height(surface, line, 0, line.part.shape[0], arc) for arc in arcs])
        highest = ((heights - drop) / arcs).max() * far + drop[-1]
        counted.append(max(1.0 - max(highest, heights[-1], 0.0), 0.0))
    # the post is 0.3 m wide, of which the line is the middle
    np.testing.assert_allclose(shares, counted, atol=0.05)
    assert shares.mean() == pytest.approx(np.mean(counted), abs=0.005)
    # 0.649 hidden and 0.077 m seen, over 6000 profiles of the whole spectrum along the line; three standard errors of the seas
    assert np.mean(shares < 1e-3) == pytest.approx(0.649, abs=3.0 * math.sqrt(0.25 / seas))
    assert shares.mean() == pytest.approx(0.077, abs=3.0 * 0.142 / math.sqrt(seas))


def test_rows_near_the_object_are_those_of_its_background() -> None:
    """Sea far below the horizon, sky far above it, and both near it; a slope from row to row and a level are no clutter."""
    sensor = {"pixels": [32, 200], "fov_deg": [1.6, 10.0], "elevation_deg": 0.0, "azimuth_deg": 0.0, "height_m": 20.0}
    seas = IndependentSeas.of(parse_scenario({"sensor": sensor, "render": {"tile_size": 128}, "sea": {"shortest_wave_m": 4.0}}))
    horizon = 99.5 + math.degrees(math.sqrt(40.0 / EFFECTIVE_EARTH_RADIUS)) / 0.05
    for row, kind in ((20, "sky"), (95, "horizon"), (103, "horizon"), (150, "sea"), (199, "sea")):
        found, first, end = background_of(seas, row, 4)
        assert (found, first <= row < end) == (kind, True)
        assert kind != "sea" or first > horizon
        assert kind != "sky" or end < horizon
    slope = np.arange(200.0)[:, np.newaxis] * 5.0 + 300.0
    noise = np.random.default_rng(2).normal(0.0, 1.0, (3, 200, 32))
    whole = Recording("slope", 3, 200, 32, lambda start, stop: (slope + noise)[start:stop])
    near = NearRows(whole, 120, 170)
    frames = near.read(0, 3)
    assert (near.rows, near.columns, frames.shape) == (50, 32, (3, 50, 32))
    assert frames.std() == pytest.approx(noise.std(), rel=0.03)


def plane_elevations(sensor: dict[str, Any]) -> np.ndarray:
    """Elevations [deg] of the pixels of a plane image, its right side down by the roll, by vectors (forward, right, up)."""
    pitch, roll = math.radians(sensor["elevation_deg"]), math.radians(sensor["roll_deg"])
    (columns, rows), (width, height) = sensor["pixels"], sensor["fov_deg"]
    x = math.tan(math.radians(0.5 * width)) * (2.0 * (np.arange(columns) + 0.5) / columns - 1.0)
    y = math.tan(math.radians(0.5 * height)) * (1.0 - 2.0 * (np.arange(rows)[:, np.newaxis] + 0.5) / rows)
    right, up = np.array([0.0, 1.0, 0.0]), np.array([-math.sin(pitch), 0.0, math.cos(pitch)])
    across, along = math.cos(roll) * right - math.sin(roll) * up, math.cos(roll) * up + math.sin(roll) * right
    lines = np.array([math.cos(pitch), 0.0, math.sin(pitch)]) + x[..., np.newaxis] * across + y[..., np.newaxis] * along
    return np.degrees(np.arcsin(lines[..., 2] / np.linalg.norm(lines, axis=-1)))


@pytest.mark.parametrize("roll", [0.0, 25.0, -40.0, 180.0])
def test_rows_of_a_plane_or_rolled_image_are_sea_or_sky_where_all_their_pixels_are(roll: float) -> None:
    sensor = {"pixels": [60, 200], "fov_deg": [6.0, 20.0], "elevation_deg": 0.0, "azimuth_deg": 0.0, "height_m": 20.0}
    sensor |= {"projection": "pinhole", "roll_deg": roll}
    seas = IndependentSeas.of(parse_scenario({"sensor": sensor, "render": {"tile_size": 128}, "sea": {"shortest_wave_m": 4.0}}))
    over = plane_elevations(sensor) + math.degrees(math.sqrt(40.0 / EFFECTIVE_EARTH_RADIUS))
    # two pixels and four: the three rows that optics blur, and the pixels' size in the corners
    surely = {"sea": (over < -0.4).all(axis=1), "sky": (over > 0.4).all(axis=1)}
    perhaps = {"sea": (over < -0.2).all(axis=1), "sky": (over > 0.2).all(axis=1)}
    kinds = set()
    for row in range(200):
        kind, first, end = background_of(seas, row, 2)
        kinds.add(kind)
        around = slice(max(row - 24, 0), row + 25)
        for name in ("sea", "sky"):
            if surely[name][around].all():
                assert (kind, first, end) == (name, max(row - 24, 0), min(row + 25, 200))
        assert first <= row < end
        assert kind == "horizon" or perhaps[kind][first:end].all()
    assert kinds == {"sea", "sky", "horizon"}


@pytest.mark.parametrize("projection", ["equal-angle", "pinhole"])
@pytest.mark.parametrize("rows", [64, 65, 40])
def test_fewer_rows_keep_their_directions(projection: str, rows: int) -> None:
    sensor = {"pixels": [32, 200], "fov_deg": [3.2, 20.0], "elevation_deg": -3.0, "azimuth_deg": 0.0, "projection": projection}
    light = {"render": {"tile_size": 128}, "sea": {"shortest_wave_m": 4.0}}
    scenario = parse_scenario({"sensor": sensor | {"pixel_shape": "any"}, **light})
    fewer = middle_of(scenario, rows)
    count = fewer.sensor.pixels[1]
    first = (200 - count) // 2
    assert rows - 1 <= count <= rows
    for whole, part in zip(IndependentSeas.of(scenario).directions, IndependentSeas.of(fewer).directions, strict=True):
        expected = whole[first : first + count] if whole.shape[0] == 200 else whole
        np.testing.assert_allclose(part, expected, atol=1e-6)
    assert middle_of(scenario, 300) is scenario
