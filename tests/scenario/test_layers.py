"""Layers beside the radiance: names of output variables, each once."""

from __future__ import annotations

import json
import tomllib

import pytest

from seaglint.base.errors import ScenarioError
from seaglint.base.schema import LAYERS, VARIABLES
from seaglint.scenario.keys import choices_at
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.scenario.text.template import json_schema, template
from seaglint.store.provenance import differences


def test_layers_are_variables_that_leave_the_program():
    assert set(LAYERS) < set(VARIABLES)
    assert len(set(LAYERS)) == len(LAYERS) == 10
    assert [VARIABLES[name].units for name in LAYERS] == 4 * ["W m-2 sr-1"] + ["m", *5 * ["1"]]


def test_none_by_default_and_all_in_the_order_given():
    assert parse_scenario({}).render.layers == ()
    backwards = LAYERS[::-1]
    scenario = parse_scenario({"render": {"layers": list(backwards)}, "sea": {"foam": {}}})
    assert scenario.render.layers == backwards
    assert Scenario.model_validate_json(scenario.model_dump_json(exclude_none=True)) == scenario


@pytest.mark.parametrize(
    ("layers", "words"),
    [
        (["range", "glint"], ["render.layers[1] = 'glint'", *LAYERS, "did you mean 'glint_radiance'?"]),
        (["rnage"], ["render.layers[0] = 'rnage'", "did you mean 'range'?"]),
        (["glint_std"], ["render.layers[0] = 'glint_std'", "is not one of 'path_radiance'"]),
        (["range", "coverage", "range"], ["render.layers = ['range', 'coverage', 'range']", "names 'range' 2 times", "once"]),
        ("range", ["render.layers = 'range'", "must be a list in brackets", *LAYERS]),
        ([3], ["render.layers[0] = 3", "is not one of"]),
    ],
)
def test_mistakes_are_one_line(layers, words):
    with pytest.raises(ScenarioError) as caught:
        parse_scenario({"render": {"layers": layers}})
    text = str(caught.value)
    assert "\n" not in text
    for word in words:
        assert word in text
    assert caught.value.mistakes[0].key.startswith("render.layers")


def test_a_number_for_a_list_of_tables_is_not_asked_for_a_pair():
    with pytest.raises(ScenarioError, match=r"platform\.keyframes = 3 must be a list in brackets$"):
        parse_scenario({"platform": {"keyframes": 3}})


def test_template_and_schema_describe_the_key():
    (line,) = (line for line in template().splitlines() if line.startswith("layers = "))
    assert tomllib.loads(line) == {"layers": []}
    for name in LAYERS:
        assert f'"{name}"' in line
    key = json_schema()["$defs"]["Render"]["properties"]["layers"]
    assert key["items"]["enum"] == list(LAYERS)
    assert key["default"] == []
    assert key["uniqueItems"] is True
    assert key["description"] in line


def test_choices_are_read_off_the_models():
    assert choices_at(("render", "layers", 0)) == LAYERS
    assert choices_at(("sensor", "projection")) == ("equal-angle", "pinhole")
    assert choices_at(("mean", "shadowing")) == ("nested", "both", "viewer")
    assert choices_at(("sensor", "height_m")) == choices_at(("nix",)) == ()


def test_other_layers_are_another_sequence():
    plain, layered = (parse_scenario({"render": {"layers": layers}}) for layers in ([], ["range"]))
    old, new = ({"scenario": json.dumps(json.loads(s.model_dump_json(exclude_none=True)))} for s in (plain, layered))
    assert differences(old, old) == []
    assert differences(old, new) == ["render.layers"]
