"""Objects out of view are named before the work: never one that a pixel could show, and the advice brings them into view."""

from __future__ import annotations

import logging
import math
import re
import tomllib

import numpy as np
import pytest

from seaglint.formats.object_labels import Labels, report_never_seen
from seaglint.objects.approach import reach_of
from seaglint.objects.drawing.eye import stand
from seaglint.scenario.ensemble_file import merged, parse_ensemble
from seaglint.scenario.load import parse_scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.bodies import unchecked_bodies
from seaglint.studies.ensemble import label_outlook
from seaglint.studies.ensemble.ensemble_dataset import DatasetOptions, EnsembleSource, ensemble_dataset
from seaglint.studies.ensemble.label_outlook import weak_labels
from seaglint.studies.ensemble.render_ensemble import draw
from seaglint.studies.sequence.out_of_view import lines_of, out_of_view, report_out_of_view
from seaglint.studies.sequence.render_sequence import render

BEHIND = {"objects": [{"preset": "small-boat", "north_m": 2000}]}
"""A boat in the north of a sensor that looks south."""


def least_angle(scenario, time: float) -> tuple[float, float]:
    """Angle between the object's middle and the nearest line of sight, and that under which a ball around it is seen [rad]."""
    (body,), pose = unchecked_bodies(scenario), scenario_physics.track(scenario).at(time)
    place = stand(body.motion.at(time), pose).place
    pixels = scenario_physics.imager(scenario)
    down, across = np.meshgrid(np.linspace(0.0, pixels.rows, 121), np.linspace(0.0, pixels.columns, 241), indexing="ij")
    cosine = pixels.directions(pose.attitude, across, down) @ (place / np.linalg.norm(place))
    return float(np.arccos(np.clip(cosine, -1.0, 1.0)).min()), math.asin(min(reach_of(body) / float(np.linalg.norm(place)), 1.0))


@pytest.mark.parametrize("projection", ["equal-angle", "pinhole"])
def test_all_of_what_is_named_is_outside_and_what_is_far_outside_is_named(projection):
    rng, named = np.random.default_rng(4), 0
    for _ in range(120):
        azimuth, arc = rng.uniform(0.0, 360.0), 10.0 ** rng.uniform(1.5, 4.0)
        item = {"name": "ball", "shape": {"kind": "sphere", "radius_m": float(rng.uniform(0.5, 12.0))}, "temperature_k": 290}
        item |= {"height_m": float(rng.uniform(20.0, 4000.0)), "east_m": float(arc), "north_m": float(rng.uniform(-arc, arc))}
        sensor = {"projection": projection, "azimuth_deg": azimuth, "roll_deg": float(rng.uniform(-180, 180)), "height_m": 30}
        sensor |= {"elevation_deg": float(rng.uniform(-40, 40)), "fov_deg": [40, 30], "pixels": [40, 30]}
        scenario = parse_scenario({"sensor": sensor, "objects": [item]})
        apart, size = least_angle(scenario, 0.0)
        unseen = out_of_view(scenario, np.zeros(1))
        if unseen:
            named += 1
            assert apart > size
        else:
            assert apart < 1.6 * size + 0.15  # a ball near the corner of a rectangle may be left without a word
    assert named > 60


@pytest.mark.parametrize(
    "sensor",
    [
        {},
        {"azimuth_deg": 170, "elevation_deg": -60},
        {"projection": "pinhole", "elevation_deg": 30},
        {"projection": "pinhole", "roll_deg": 30},
    ],
)
def test_the_advice_brings_it_into_view(sensor):
    scene = {**BEHIND, "sensor": sensor}
    scenario = parse_scenario(scene)
    (line,) = lines_of(scenario, out_of_view(scenario, np.zeros(1)))
    assert "2 km away" in line
    keys = re.findall(r"sensor\.\w+ = [-\d.]+", line)
    turned = parse_scenario(merged(scene, tomllib.loads("\n".join(keys))))
    assert out_of_view(turned, np.zeros(1)) == ()


def test_the_whole_way_counts():
    across = {"objects": [{"preset": "small-boat", "north_m": -1000, "east_m": 400, "course_deg": 270, "speed_m_s": 20}]}
    scenario = parse_scenario({**across, "sensor": {"frames": 1000}})
    assert out_of_view(scenario, np.arange(1000) / 25.0) == ()
    assert [one.name for one in out_of_view(scenario, np.arange(25) / 25.0)] == ["small-boat"]
    turning = parse_scenario(
        {
            **BEHIND,
            "sensor": {"frames": 1000},
            "platform": {"keyframes": [{"time_s": 0, "azimuth_deg": 180}, {"time_s": 40, "azimuth_deg": 1}]},
        }
    )
    assert out_of_view(turning, np.arange(1000) / 25.0) == ()
    assert len(out_of_view(turning, np.arange(500) / 25.0)) == 1


def test_the_horizon_hides():
    far = parse_scenario({"objects": [{"preset": "small-boat", "north_m": -60000}]})
    (one,) = out_of_view(far, np.zeros(1))
    assert one.seen_to is not None
    assert one.seen_to == pytest.approx(3860.0 * (math.sqrt(30.0) + math.sqrt(5.46)), rel=0.01)  # sqrt(2 R' h) of sensor and lifted top
    assert "behind the horizon" in lines_of(far, (one,))[0]


def test_many_are_summed_up():
    scenario = parse_scenario({"objects": [{"preset": "buoy", "north_m": 1000 + 50 * n} for n in range(30)]})
    lines = lines_of(scenario, out_of_view(scenario, np.zeros(1)))
    assert len(lines) == 1
    assert lines[0].startswith("30 of 30 objects never enter the view: 'buoy' at azimuth 0 deg, 1 km away; ")


def test_render_and_labels_say_it(tmp_path, caplog):
    items = [*BEHIND["objects"], {"preset": "small-boat", "north_m": -600}]
    small = {"sensor": {"pixels": [16, 8], "frames": 1}, "sea": {"resolve_waves": False}, "atmosphere": {"source": "none"}}
    with caplog.at_level(logging.WARNING, "seaglint"):
        store = render(parse_scenario({**small, "objects": items}), tmp_path / "run.zarr")
        (said,) = [record.getMessage() for record in caplog.records if "enters the view" in record.getMessage()]
        assert said.startswith("object 'small-boat' never enters the view: azimuth 0 deg, 2 km away")
        labels = Labels.of(store)
        report_never_seen(labels)
    assert "no frame shows 1 of 2 objects: 'small-boat' is outside the picture (azimuth 0 deg, 2 km away" in caplog.text
    assert len(labels.never_seen()) == 1


def test_nothing_is_said_of_what_is_in_view(caplog):
    with caplog.at_level(logging.WARNING, "seaglint"):
        report_out_of_view(parse_scenario({"objects": [{"preset": "small-boat", "north_m": -600}]}))
        report_out_of_view(parse_scenario({}))
    assert caplog.text == ""


ENSEMBLE = {
    "ensemble": {"scenes": 3, "frames": 2, "seed": 5},
    "base": {
        "sensor": {
            "pixels": [32, 24],
            "elevation_deg": -0.5,
            "optics": {"aperture_m": 0.01, "f_number": 2.0},
            "detector": {"pitch_um": 15.0, "well_capacity_e": 1e6, "integration_time_s": 0.0005, "read_noise_e": 300},
        },
        "sea": {"resolve_waves": False},
        "atmosphere": {"source": "none"},
        "sun": {"azimuth_deg": 0},  # behind the sensor: pixels that the Sun's glint saturates would show no object
        "render": {"oversampling": 2},
    },
    "objects": [
        {
            "name": "spot",
            "count": 3,
            "shape": {"kind": "point", "intensity_w_sr": {"law": "log_uniform", "min": 0.002, "max": 2.0}},
            "height_m": 5,
            "column": {"law": "uniform", "min": 4, "max": 28},
            "range_m": {"law": "log_uniform", "min": 800, "max": 6000},
        }
    ],
}


def test_weak_labels_are_those_of_the_data_set(tmp_path, monkeypatch):
    ensemble = parse_ensemble(ENSEMBLE)
    monkeypatch.setattr(label_outlook, "SHARE", 2)  # the first frame of each scene
    estimate = weak_labels(draw(ensemble), patience=1000.0)
    assert estimate is not None
    assert estimate.frames == 3
    folder = ensemble_dataset(EnsembleSource(ensemble, "weak", None), tmp_path / "set", DatasetOptions.of("coco"))
    rows = [line.split(",") for line in (folder / "truth.csv").read_text().splitlines()]
    ratio, frame = rows[0].index("snr"), rows[0].index("frame")
    known = [(int(row[frame]), float(row[ratio])) for row in rows[1:] if row[ratio]]
    first = [value for number, value in known if number == 0]
    assert (estimate.weak, estimate.seen) == (sum(value < 1.0 for value in first), len(first))
    assert 0 < estimate.weak < estimate.seen  # else nothing is tested
    assert estimate.labels == pytest.approx(len(known), rel=0.1)
    weak = sum(value < 1.0 for _, value in known)
    assert abs(estimate.labels * estimate.weak / estimate.seen - weak) <= 0.4 * len(known)
    assert "estimate: some " in estimate.line
