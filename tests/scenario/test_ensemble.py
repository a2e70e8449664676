"""Files of ensembles: laws by their distribution functions, and mistakes in one line."""

import math
import tomllib
from pathlib import Path

import pytest

from seaglint.base.errors import ScenarioError
from seaglint.scenario.ensemble_file import load_ensemble, parse_ensemble
from seaglint.scenario.records.ensemble_tables import Choice, LogUniform, Normal, Uniform
from seaglint.scenario.records.quantities import Quantity
from seaglint.scenario.text.toml_writing import document

SPEED = Quantity("m/s", ge=0, le=50)
KELVIN = Quantity("K", ge=0)
WHOLE = Quantity(ge=0, le=100, integer=True)


def test_a_quarter_of_the_draws_lies_below_the_first_quartile() -> None:
    assert Uniform(min=2, max=10).at(0.25, SPEED) == pytest.approx(4.0, rel=1e-15)
    assert LogUniform(min=1, max=16).at(0.25, SPEED) == pytest.approx(2.0, rel=1e-14)
    # tables of the normal law: 0.25 below -0.674490 standard deviations
    assert Normal(mean=5, standard_deviation=2).at(0.25, SPEED) == pytest.approx(5 - 2 * 0.6744897501960817, rel=1e-12)
    assert Choice(values=(3, 7), weights=(1, 3)).at(0.249, SPEED) == 3
    assert Choice(values=(3, 7), weights=(1, 3)).at(0.251, SPEED) == 7


def test_units_are_those_of_the_key() -> None:
    assert Uniform(min="0 kn", max="20 kn").at(0.5, SPEED) == pytest.approx(10 * 1852 / 3600, rel=1e-12)
    # a standard deviation is a difference: 2 degC are 2 K
    assert Normal(mean="15 degC", standard_deviation="2 degC").at(0.5, KELVIN) == pytest.approx(288.15, rel=1e-12)
    assert Normal(mean="15 degC", standard_deviation="2 degC").at(0.8413447460685429, KELVIN) == pytest.approx(290.15, rel=1e-9)
    assert Choice(values=("10 kn", "20 kn")).at(0.9, SPEED) == pytest.approx(20 * 1852 / 3600, rel=1e-12)


def test_a_normal_law_that_is_cut_off_keeps_its_shape_between_its_ends() -> None:
    half = Normal(mean=0, standard_deviation=1, min=0)
    # the median of the half-normal law is the upper quartile of the whole one
    assert half.at(0.5, None) == pytest.approx(0.6744897501960817, rel=1e-9)
    assert all(0.5 <= Normal(mean=0, standard_deviation=1, min=0.5, max=0.6).at(u, None) <= 0.6 for u in (0.0, 0.3, 0.999999))


def test_whole_numbers_have_both_ends_and_are_alike() -> None:
    law = Uniform(min=1, max=4)
    drawn = [law.at((i + 0.5) / 400, WHOLE) for i in range(400)]
    assert [drawn.count(n) for n in (1, 2, 3, 4)] == [100] * 4


@pytest.mark.parametrize(
    ("law", "text"),
    [
        (Uniform(min=5, max=2), "min = 5 is above max = 2"),
        (LogUniform(min=0, max=2), "min = 0 has no logarithm"),
        (Normal(mean=1, standard_deviation=0), "standard_deviation = 0 is not above 0"),
        (Uniform(min="5 K", max=9), "'5 K' has a unit of another kind"),
    ],
)
def test_laws_that_cannot_be_drawn(law: Uniform, text: str) -> None:
    with pytest.raises(ValueError, match=text.replace(".", r"\.")):
        law.at(0.5, SPEED)


HEAD = {"ensemble": {"scenes": 2}}


@pytest.mark.parametrize(
    ("raw", "text"),
    [
        ({}, "ensemble is missing"),
        ({"ensemble": {"scenes": 0}}, "ensemble.scenes = 0 is outside the allowed range: 1 to 1000000"),
        ({"ensemble": {"scenes": 2, "sampling": "sobel"}}, "ensemble.sampling = 'sobel'"),
        ({"ensemble": {"scenes": 2, "frame": 2}}, "ensemble.frame is an unknown key; did you mean frames?"),
        ({**HEAD, "vary": [{"law": "uniform", "min": 1, "max": 2}]}, "vary[0].key is missing"),
        ({**HEAD, "vary": [{"key": "wind.speed_m_s", "law": "uniforn", "min": 1, "max": 2}]}, "did you mean 'uniform'?"),
        ({**HEAD, "vary": [{"key": "wind.speed_m_s", "law": "uniform", "min": 1}]}, "vary[0].max is missing"),
        ({**HEAD, "vary": [{"key": "wind.speed_m_s", "min": 1}]}, "vary[0].law is missing; add one of uniform"),
        ({**HEAD, "vary": [{"key": "seed", "law": "choice", "values": [1, 2], "weights": [1]}]}, "1 numbers for 2 values"),
        (
            {**HEAD, "vary": [{"law": "weather"}, {"key": "wind.speed_m_s", "law": "uniform", "min": 1, "max": 2}]},
            "vary[1].key = 'wind.speed_m_s' has two laws",
        ),
        ({**HEAD, "base": {"preset": "glimt"}}, "base.preset = 'glimt' is not one of glint"),
        ({**HEAD, "base": {"wind": {"speed_m_s": 99}}}, "base: wind.speed_m_s = 99 is outside"),
        ({**HEAD, "base": 3}, "base = 3 must be the path of a scenario file"),
        ({**HEAD, "objects": [{"name": "a", "row": 3}]}, "objects ('a') has row and no column"),
        ({**HEAD, "objects": [{"name": "a", "column": 3}]}, "objects ('a') has column alone"),
        ({**HEAD, "objects": [{"name": "a", "column": 3, "row": 2, "range_m": 9, "height_m": 1}]}, "one too many"),
        ({**HEAD, "objects": [{"name": "a", "column": 3, "row": 2, "east_m": 9}]}, "has column and east_m"),
    ],
)
def test_mistakes_are_one_line(raw: dict, text: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        parse_ensemble(raw, name="e.toml")
    assert str(caught.value).startswith("e.toml: ")
    assert text in str(caught.value)
    assert "\n" not in str(caught.value)


def test_the_base_is_a_file_beside_the_ensemble_and_its_paths_are_absolute(tmp_path: Path) -> None:
    (tmp_path / "base").mkdir()
    (tmp_path / "base" / "r.csv").write_text("wavelength_um,response\n3.5,1\n5,1\n")
    (tmp_path / "base" / "s.toml").write_text('[band]\nresponse = "r.csv"\n')
    (tmp_path / "e.toml").write_text('base = "base/s.toml"\n[ensemble]\nscenes = 1\n')
    found = load_ensemble(tmp_path / "e.toml")
    assert found.base == {"band": {"response": str(tmp_path / "base" / "r.csv")}}
    with pytest.raises(ScenarioError, match=r"gone\.toml: cannot be read"):
        parse_ensemble({**HEAD, "base": "gone.toml"}, folder=tmp_path)


def test_text_of_tables_reads_back() -> None:
    tables = {
        "seed": 7,
        "time": {"utc": tomllib.loads("t = 2026-06-21T17:30:00Z")["t"]},
        "sensor": {"fov_deg": [16, 8.5], "optics": {"f_number": 2.0}},
        "objects": [{"name": 'a "b"\n\x7f', "shape": {"kind": "union", "parts": [{"kind": "box"}]}}, {"name": "é"}],
        "odd key": {"inf": math.inf, "on": True},
    }
    assert tomllib.loads(document(tables, "two\nlines")) == tables
