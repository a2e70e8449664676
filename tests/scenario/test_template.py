"""What ``init`` writes is a scenario; what ``schema`` prints describes it."""

from __future__ import annotations

import json
import re
import tomllib

import pytest

from seaglint.base.errors import DataError, ScenarioError
from seaglint.scenario.keys import key_paths, kinds_with, tags
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.text.template import PRESETS, json_schema, template, write_template


@pytest.mark.parametrize("name", PRESETS)
def test_the_written_file_is_the_preset(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = write_template(tmp_path / "my.toml", name)
    assert load_scenario(path) == parse_scenario(PRESETS[name].values, base=tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == {"my.toml", *PRESETS[name].files}


@pytest.mark.parametrize("name", PRESETS)
def test_presets_say_where_they_come_from(name):
    assert PRESETS[name].notes


def test_the_commented_keys_are_valid_too():
    # Whoever removes a comment sign must not meet an error, but for the Sun, which is given one way or the other.
    needed = "utc|latitude_deg|longitude_deg|step_m|keyframes|aperture_m|f_number|pitch_um"
    text = re.sub(rf"^# (\[|({needed}) =)", r"\1", template(), flags=re.MULTILINE)
    values = tomllib.loads(text)
    values.pop("sun")
    parse_scenario(values)


def test_every_key_of_the_default_kinds_is_in_the_template():
    text = template()
    other_kinds = {path for path in key_paths() if path.startswith("sea.spectrum.") and path != "sea.spectrum.kind"}
    other_kinds |= {"atmosphere.temperature_k", "atmosphere.extinction_per_km"}
    live = ("sounding", "haze", "visibility_km", "air_mass_character", "wind_24h_m_s", "path")
    other_kinds |= {f"atmosphere.{key}" for key in live}
    for path in set(key_paths()) - other_kinds:
        assert f"{path.rsplit('.', 1)[-1]} = " in text


def test_an_unknown_preset_and_an_existing_file(tmp_path):
    with pytest.raises(ScenarioError, match="glint, calm"):
        template("nix")
    path = write_template(tmp_path / "my.toml")
    with pytest.raises(DataError, match="overwrite=True"):
        write_template(path)
    write_template(path, "calm", overwrite=True)
    assert "calm" in path.read_text()


def test_the_schema_names_every_key_and_takes_text_with_units():
    schema = json_schema()
    text = json.dumps(schema)
    for path in key_paths():
        assert f'"{path.rsplit(".", 1)[-1]}"' in text
    height = schema["$defs"]["Sensor"]["properties"]["height_m"]
    assert [option["type"] for option in height["anyOf"]] == ["number", "string"]
    assert height["anyOf"][0]["exclusiveMinimum"] == 0
    assert schema["additionalProperties"] is False


def test_every_kind_of_a_union_is_named_by_the_key_that_chooses_it():
    assert tags(("atmosphere",)) == ("table", "lowtran", "lowtran-fortran", "file", "isothermal", "none")
    assert kinds_with(("atmosphere",), "refraction") == ("table", "lowtran")
    line = next(line for line in template("calm").splitlines() if line.startswith("source = "))
    assert line.endswith('"table" | "lowtran" | "lowtran-fortran" | "file" | "isothermal" | "none"')
