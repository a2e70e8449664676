"""Every line of a scenario that a message recommends works as it is typed."""

from __future__ import annotations

import tomllib

import pytest
from advice import Advice, recommended

from seaglint.base.errors import ScenarioError
from seaglint.scenario.ensemble_file import merged
from seaglint.scenario.keys import key_paths
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.records.object_tables import Object
from seaglint.studies.build.bodies import unchecked_bodies

ADVICE = sorted(set(recommended(frozenset(key_paths()), frozenset(Object.model_fields))))

SENSOR = {"optics": {"aperture_m": 0.05, "f_number": 2.0}, "detector": {"pitch_um": 15.0, "netd_k": 0.05}}
"""Sensor for keys that need one."""

TABLES = ({}, {"sensor": SENSOR})


@pytest.mark.parametrize("advice", ADVICE, ids=lambda advice: f"{advice.where} {advice.lines[:40]}")
def test_recommended_lines_are_a_scenario(advice):
    raw = tomllib.loads(advice.lines)
    for item in raw.get("objects", []):
        item.update({} if item.keys() & {"preset", "shape"} else {"preset": "small-boat"})
    errors = []
    for base in TABLES:
        try:
            scenario = parse_scenario(merged(base, raw))
        except ScenarioError as error:
            errors.append(error)
        else:
            unchecked_bodies(scenario)
            return
    # a kind may need keys beside it, which the message must name: then the recommended key is right
    key = advice.lines.split(" = ")[0]
    assert all(f"{mistake.key.rpartition('.')[0]}." in f"{key}." and "add it" in mistake.text for mistake in errors[-1].mistakes), errors[
        -1
    ]


def test_advice_is_found():
    lines = {advice.lines for advice in ADVICE}
    assert '[[objects]]\npreset = "small-boat"\nnorth_m = 2000' in lines
    assert "sea.slopes.extrapolate = true" in lines
    assert len(ADVICE) > 30


def test_a_wrong_recommendation_fails():
    with pytest.raises(AssertionError):
        test_recommended_lines_are_a_scenario(Advice("here", "sea.slopes.extrapolate = 3"))
    with pytest.raises((AssertionError, ScenarioError)):
        test_recommended_lines_are_a_scenario(Advice("here", '[[objects]]\npreset = "boat"'))


@pytest.mark.parametrize(
    ("items", "names"),
    [
        ([{"preset": "small-boat"}], ["small-boat"]),
        ([{"preset": "buoy"}, {"preset": "buoy"}, {"name": "buoy-2", "preset": "drone"}], ["buoy", "buoy-3", "buoy-2"]),
        ([{"shape": {"kind": "sphere", "radius_m": 1.0}}, {"shape": {"kind": "box", "size_m": [1, 1, 1]}}], ["sphere", "box"]),
    ],
)
def test_objects_without_a_name_get_one(items, names):
    assert [item.name for item in parse_scenario({"objects": items}).objects] == names
