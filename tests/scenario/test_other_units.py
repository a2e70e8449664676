"""A number outside its range that would be right in another usual unit gets a question, which is right as typed."""

from __future__ import annotations

import logging
import math
import re

import numpy as np
import pytest
from pydantic_core import PydanticCustomError

from seaglint.base.errors import ScenarioError
from seaglint.scenario.keys import key_at, key_paths
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.records.quantities import MISTAKEN, Quantity, convert

QUANTITIES = sorted(
    {(path, quantity) for path in key_paths() for quantity in key_at(tuple(path.split("."))).quantities if quantity.unit in MISTAKEN},
    key=repr,
)


@pytest.mark.parametrize(
    ("tables", "question"),
    [
        ({"sea": {"temperature_k": 15}}, "15 degC"),
        ({"band": {"min_um": 3500, "max_um": 5}}, "3500 nm"),
        ({"wind": {"speed_m_s": 30}}, "30 kn"),
        ({"sensor": {"optics": {"aperture_m": 50, "f_number": 2}, "detector": {"pitch_um": 15}}}, "50 mm"),
        ({"sensor": {"fov_deg": [500, 8]}}, "500 mrad"),
        ({"atmosphere": {"source": "lowtran", "visibility_km": 23000}}, "23000 m"),
    ],
)
def test_question(tables, question):
    with pytest.raises(ScenarioError, match=re.escape(f'did you mean "{question}"?')):
        parse_scenario(tables)


@pytest.mark.parametrize("tables", [{"sea": {"temperature_k": 5000}}, {"sensor": {"height_m": -3}}, {"sea": {"temperature_k": "15 K"}}])
def test_no_question_where_no_unit_helps(tables):
    with pytest.raises(ScenarioError) as refused:
        parse_scenario(tables)
    assert "did you mean" not in str(refused.value)


@pytest.mark.parametrize(("path", "quantity"), QUANTITIES, ids=lambda value: value if isinstance(value, str) else "")
def test_what_is_asked_is_allowed(path, quantity):
    rng = np.random.default_rng(len(path))
    limit = min([most for most in (quantity.le, quantity.lt) if most is not None], default=math.inf)
    right = [value for value in 10.0 ** rng.uniform(-6, math.log10(min(limit, 1e9)), 40) if quantity.holds(value)]
    for unit, (least, most) in MISTAKEN[quantity.unit]:
        factor = convert(f"1 {unit}", quantity.unit) - (zero := convert(f"0 {unit}", quantity.unit))
        for value in right if least <= limit <= most else ():
            mistyped = float(f"{(value - zero) / factor:.3g}")  # the number that someone has who thinks in the other unit
            if quantity.holds(mistyped) or not quantity.holds(convert(f"{mistyped:g} {unit}", quantity.unit)):
                continue
            with pytest.raises(PydanticCustomError) as refused:
                quantity.parse(mistyped)
            question = re.search(r'did you mean "(.*?)"', refused.value.message())
            assert question is not None
            assert quantity.holds(quantity.parse(question[1]))


def test_range_is_told_before_the_question():
    with pytest.raises(PydanticCustomError, match=r"260 to 320 K; did you mean"):
        Quantity("K", ge=260, le=320).parse(math.pi)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("2026-06-21", "has no hour and no time zone and is taken as UTC, 2026-06-21T00:00:00Z"),
        ('"2026-06-21"', "has no hour and no time zone and is taken as UTC, 2026-06-21T00:00:00Z"),
        ("2026-06-21T12:30:00", "has no time zone and is taken as UTC, 2026-06-21T12:30:00Z"),
        ("2026-06-21T12:30:00Z", ""),
        ("2026-06-21T12:30:00+02:00", ""),
    ],
)
def test_dates_say_what_is_taken(given, said, tmp_path, caplog):
    file = tmp_path / "my.toml"
    file.write_text(f"[time]\nutc = {given}\n[place]\nlatitude_deg = 40\nlongitude_deg = 0\n")
    with caplog.at_level(logging.WARNING, "seaglint"):
        load_scenario(file)
    assert said in caplog.text
    assert bool(caplog.text) == bool(said)
