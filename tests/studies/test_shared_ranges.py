"""Scenes that the ranges of one search share, and searches over workers: equal to each range alone, in one process."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import poisson

from seaglint.base.errors import DataError
from seaglint.cluster import LocalProcesses
from seaglint.detection.interface import detector_of
from seaglint.detection.sources import poisson_quantile
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.store.detection_results import DetectionRange, StudyParts
from seaglint.studies.detect import study
from seaglint.studies.detect.detection_requests import RangeRequest
from seaglint.studies.detect.range_search import LOOK_ROWS, RangeScenes, looking_near, p_d_at, placed_at
from seaglint.studies.detect.scene_frames import IndependentSeas
from seaglint.studies.detect.study import RangeUnit, ranges_of
from seaglint.studies.detect.varied_cases import StudyCase
from seaglint.studies.sequence.render_sequence import prepare_sequence

SENSOR: dict[str, Any] = {
    "height_m": 20.0,
    "azimuth_deg": 240.0,
    "elevation_deg": -1.0,
    "pixels": [40, 32],
    "optics": {"focal_length_m": 0.05, "f_number": 2.5},
    "detector": {"pitch_um": 30.0, "integration_time_s": 1e-3, "well_capacity_e": 7.2e6},
}
#: Few and coarse waves, so that a scene takes some hundredths of a second.
COARSE: dict[str, Any] = {"sea": {"shortest_wave_m": 4.0}, "render": {"lines_per_column": 2, "variance_error": 0.1, "tile_size": 128}}
BOAT: dict[str, Any] = {"name": "boat", "preset": "small-boat", "north_m": 2000.0}


def scene(**sensor: Any) -> Scenario:
    return parse_scenario({"seed": 3, "sensor": SENSOR | sensor, "objects": [BOAT], **COARSE})


def asked(**given: Any) -> RangeRequest:
    judged: dict[str, Any] = {"detector": "matched", "p_fa": 1e-2, "frames": 4, "injections": 40, "precision": 0.5}
    return RangeRequest(source="", **(judged | {"range_limits": (1500.0, 6000.0)} | given)).of_objects(["boat"])


def parts_at(folder: Path) -> StudyParts:
    return StudyParts.at(folder / "found", resume=True, overwrite=True)


@pytest.mark.parametrize("seed", range(20))
def test_the_object_stays_within_half_a_step_of_the_middle_row(seed: int) -> None:
    random = np.random.default_rng(seed)
    rows, height, at = int(random.integers(2, 600)), float(random.uniform(2.0, 2000.0)), float(10.0 ** random.uniform(2.5, 4.6))
    sensor = {"height_m": height, "pixels": [32, rows], "fov_deg": [0.64, 0.02 * rows]}
    placed = placed_at(parse_scenario({"sensor": sensor, "objects": [BOAT]}), "boat", at, None)
    near = looking_near(placed)
    pixel = placed.sensor.fov_deg[1] / rows
    off = abs(near.sensor.elevation_deg - placed.sensor.elevation_deg) / pixel
    assert off <= 0.5 * min(LOOK_ROWS, rows // 6) + 1e-9
    assert near.objects == placed.objects
    # the line of sight is one of a series that does not depend on the range
    step = min(LOOK_ROWS, rows // 6) * pixel
    if step:
        assert near.sensor.elevation_deg / step == pytest.approx(round(near.sensor.elevation_deg / step), abs=1e-6)


@pytest.mark.parametrize("projection", ["equal-angle", "pinhole"])
@pytest.mark.parametrize("item", [BOAT, {"name": "boat", "shape": {"kind": "point", "intensity_w_sr": 50.0}, "height_m": 0.4}])
def test_sights_without_the_sea_are_those_of_drawn_images(projection: str, item: dict[str, Any]) -> None:
    random = np.random.default_rng(7)
    objects = [item | {"name": "boat", "north_m": 3000.0}]
    sensor = {"pixels": [24, 20], "fov_deg": [0.6, 0.5], "elevation_deg": -0.2, "azimuth_deg": 0.0, "height_m": 8.0}
    made = {"seed": 3, "wind": {"speed_m_s": 12.0}, "sensor": sensor | {"projection": projection}, "objects": objects, **COARSE}
    sequence, hidden = prepare_sequence(parse_scenario(made)), 0
    for _ in range(6):
        sea, first = sequence.reseeded(int(random.integers(2**62))), int(random.integers(0, 8))
        columns = first, int(random.integers(first + 8, 25))
        (drawn,), (found,) = sea.drawn(0.0, columns).sights, sea.sights(0.0, columns)
        names = ("whole", "seen", "across", "down", "dry", "inside", "dry_seen")
        assert [getattr(found, name) for name in names] == [getattr(drawn, name) for name in names]
        assert [share.radiance.tolist() for share in found.shares] == [share.radiance.tolist() for share in drawn.shares]
        lit = any((share.radiance > 0.0).any() for share in found.shares)
        hidden += found.seen < 0.99 * found.whole if found.whole else not lit
    assert hidden  # waves hide some of it


def test_objects_of_another_scenario_have_the_light_of_a_new_one() -> None:
    """The light that is kept for other objects is what would be computed for them."""
    first, second = (placed_at(scene(), "boat", at, None) for at in (2000.0, 2600.0))
    second = second.model_copy(update={"sensor": first.sensor})
    seas = IndependentSeas.of(first)
    seas.with_objects(first).drawn(0.0)
    kept, new = seas.with_objects(second).drawn(0.0), IndependentSeas.of(second).with_objects(second).drawn(0.0)
    np.testing.assert_array_equal(kept.layers.radiance, new.layers.radiance)
    assert (kept.layers.radiance != kept.sea).any()


def test_a_range_is_the_same_alone_and_after_others(tmp_path: Path) -> None:
    request, scenario = asked(), scene()
    for name in ("alone", "after"):
        (tmp_path / name).mkdir()
    shared = RangeScenes(parts_at(tmp_path / "after"))
    for at in (1800.0, 6500.0, 5200.0):
        after = p_d_at(scenario, request, at, None, shared)
    alone = p_d_at(scenario, request, 5200.0, None, RangeScenes(parts_at(tmp_path / "alone")))
    assert json.dumps(after.as_dict()) == json.dumps(alone.as_dict())
    # ranges of one line of sight have one folder of frames
    assert len(list((tmp_path / "after").rglob("frames-*"))) == 2
    shared.forget_frames()
    assert not list((tmp_path / "after").rglob("frames-*"))


@pytest.mark.parametrize("bearings", [(30.0, 200.0), (30.0,)], ids=["searches", "seas of one search"])
def test_ranges_do_not_depend_on_the_workers(bearings: tuple[float, ...], tmp_path: Path) -> None:
    request, cases = asked(bearings=bearings), [StudyCase({}, scene(), {})]
    texts, lines, done = [], [], []
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
    alone = ranges_of(cases, request, parts_at(tmp_path / "one"), report=lines.append)
    with LocalProcesses(2, threads=1) as workers:
        heard: list[str] = []
        shared = ranges_of(
            cases, request, parts_at(tmp_path / "two"), report=heard.append, progress=lambda *at: done.append(at), workers=workers
        )
    texts = [json.dumps([one.as_dict() for one in found]) for found in (alone, shared)]
    assert texts[0] == texts[1]
    assert sorted(lines) == sorted(heard)
    assert done[-1] == (len(bearings), len(bearings))


def test_a_closure_searches_over_workers_as_alone(tmp_path: Path) -> None:
    """Two searches, whose units carry the detector to fresh processes."""
    gain = 2.0
    detector = detector_of(lambda frames: gain * frames)
    request, cases = asked(bearings=(30.0, 200.0), detector=detector), [StudyCase({}, scene(), {})]
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
    alone = ranges_of(cases, request, parts_at(tmp_path / "one"))
    with LocalProcesses(2, threads=1) as workers:
        shared = ranges_of(cases, request, parts_at(tmp_path / "two"), workers=workers)
    assert [one.as_dict() for one in alone] == [one.as_dict() for one in shared]
    assert [one.detector for one in shared] == ["lambda", "lambda"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"p_fa": 1e-9}, "a rate of 1e-09 per pixel has no threshold"),
        ({"detector": detector_of(lambda frames: frames[:, 1:])}, "detector lambda returned shape"),
    ],
    ids=["rate", "shape"],
)
def test_an_error_of_the_user_is_the_same_over_workers(changes: dict[str, Any], message: str, tmp_path: Path) -> None:
    request, cases = asked(bearings=(30.0, 200.0), **changes), [StudyCase({}, scene(), {})]
    lines = []
    with LocalProcesses(2, threads=1) as workers:
        for number, team in enumerate((None, workers)):
            (tmp_path / str(number)).mkdir()
            with pytest.raises(DataError, match=message) as error:
                ranges_of(cases, request, parts_at(tmp_path / str(number)), workers=team)
            lines.append(str(error.value))
    assert lines[0] == lines[1]
    assert "\n" not in lines[0]


def test_a_unit_is_a_few_words() -> None:
    assert repr(RangeUnit(1, StudyCase({}, scene(), {}), 90.0)) == "search 1, 90 deg from the Sun"


def test_finished_ranges_are_not_searched_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    request, cases = asked(bearings=(30.0, 200.0)), [StudyCase({"wind.speed_m_s": 5.0}, scene(), {})]
    searched: list[float] = []

    def found(scenario: Scenario, request: RangeRequest, parts: StudyParts, *, bearing_deg: float, **_: Any) -> DetectionRange:
        searched.append(bearing_deg)
        if bearing_deg > 100.0 and len(searched) == 2:
            raise KeyboardInterrupt
        return DetectionRange("boat", bearing_deg, 0.9, 3000.0, None, [2900.0, 3100.0], [])

    monkeypatch.setattr(study, "detection_range", found)
    with pytest.raises(KeyboardInterrupt):
        ranges_of(cases, request, parts_at(tmp_path))
    ranges = ranges_of(cases, request, parts_at(tmp_path))
    assert searched == [30.0, 200.0, 200.0]
    assert [one.bearing_deg for one in ranges] == [30.0, 200.0]
    assert {one.named for one in ranges} == {"wind.speed_m_s = 5.0"}
    assert DetectionRange.of(json.loads(json.dumps(ranges[0].as_dict()))) == ranges[0]


@pytest.mark.parametrize("most", [1e-6, 0.3, 3.0, 30.0, 99.9])
def test_poisson_quantiles_are_exact_below_a_hundred(most: float) -> None:
    random = np.random.default_rng(5)
    mean, share = random.uniform(0.0, most, 20_000), random.random(20_000)
    share[:2], share[2:4] = 0.0, 1.0 - 1e-15
    np.testing.assert_array_equal(poisson_quantile(mean, share), np.maximum(poisson.ppf(share, mean), 0.0))


@pytest.mark.validation
@pytest.mark.parametrize("range_m", [2500.0, 5000.0])
def test_a_line_of_sight_beside_the_object_changes_no_probability(range_m: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Object in the middle row against half a step beside it: other frames of the same law, whose P_d is within both intervals."""
    request, scenario = asked(frames=32, injections=400, p_fa=1e-3), scene(pixels=[64, 48])
    near = p_d_at(scenario, request, range_m, None, RangeScenes(parts_at(tmp_path)))
    monkeypatch.setattr("seaglint.studies.detect.range_search.looking_near", lambda placed: placed)
    exact = p_d_at(scenario, request, range_m, None, RangeScenes(parts_at(tmp_path)))
    assert near.p_d_interval is not None
    assert exact.p_d_interval is not None
    halves = [0.5 * (high - low) for low, high in (near.p_d_interval, exact.p_d_interval)]
    assert abs(near.p_d - exact.p_d) <= math.hypot(*halves)
