"""The table [sea.foam]: defaults, refusals in one line, laws as physics has them, and its use in ensembles and sweeps."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_args

import pytest

import seaglint as sg
from seaglint.base.errors import ScenarioError
from seaglint.base.limits import FOAM_WINDS
from seaglint.scenario.ensemble_file import parse_ensemble
from seaglint.scenario.load import parse_scenario
from seaglint.scenario.records.sea_tables import Foam
from seaglint.sea.foam.breaking_crests import FORMS
from seaglint.sea.foam.coverage_laws import coverage
from seaglint.studies.build.scenario_physics import breaking_crests, foam_coverage

AIRLESS = {"atmosphere": {"source": "none"}}


def _scenario(wind: float, foam: dict[str, Any] | None, **sea: Any) -> dict[str, Any]:
    table = {"slopes": {"extrapolate": True}, **sea} | ({} if foam is None else {"foam": foam})
    return {**AIRLESS, "wind": {"speed_m_s": wind}, "sea": table}


def test_a_sea_has_no_foam_unless_requested() -> None:
    scenario = parse_scenario({})
    assert scenario.sea.foam is None
    assert foam_coverage(scenario) == 0.0
    assert breaking_crests(scenario) is None
    assert "foam" not in scenario.model_dump_json(exclude_none=True)


def test_an_empty_table_has_the_default_law() -> None:
    scenario = parse_scenario(_scenario(10.0, {}))
    assert scenario.sea.foam == Foam(law="monahan-1980", extrapolate=False, crests="melville-matusov-2002")
    assert foam_coverage(scenario) == pytest.approx(2.95e-6 * 10.0**3.52, rel=1e-12)


def test_choices_are_those_of_physics() -> None:
    fields = Foam.model_fields
    assert get_args(fields["law"].annotation) == tuple(FOAM_WINDS)
    assert get_args(fields["crests"].annotation) == FORMS


@pytest.mark.parametrize("crests", FORMS)
@pytest.mark.parametrize("law", FOAM_WINDS)
def test_crests_have_the_coverage_of_the_law(law: str, crests: str) -> None:
    breaking = breaking_crests(parse_scenario(_scenario(12.0, {"law": law, "crests": crests})))
    assert breaking is not None
    assert breaking.form == crests
    assert breaking.coverage_between(0.0, 100.0) == pytest.approx(coverage(law, 12.0), rel=1e-12)


def test_calm_seas_have_no_crests() -> None:
    assert breaking_crests(parse_scenario(_scenario(0.0, {}))) is None
    assert breaking_crests(parse_scenario(_scenario(3.0, {"law": "callaghan-2008"}))) is None


@pytest.mark.parametrize("law", FOAM_WINDS)
def test_scenario_and_law_end_at_the_same_winds(law: str) -> None:
    low, high = FOAM_WINDS[law]
    for wind in (low, high):
        parse_scenario(_scenario(wind, {"law": law}))
    for wind, side in ((low - 0.5, "below"), (high + 0.5, "above")):
        if wind < 0.0:
            continue
        with pytest.raises(ScenarioError) as refused:
            parse_scenario(_scenario(wind, {"law": law}))
        assert str(refused.value).startswith(
            f"scenario: wind.speed_m_s = {wind:g} is {side} the winds of the foam law {law}; allowed: {low:g} to {high:g} m/s, "
            "or set another sea.foam.law or sea.foam.extrapolate = true"
        )
        assert refused.value.mistakes[0].allowed == (low, high)
        assert foam_coverage(parse_scenario(_scenario(wind, {"law": law, "extrapolate": True}))) > 0.0


@pytest.mark.parametrize(
    ("raw", "text"),
    [
        (
            _scenario(7.0, {}, slopes={"kind": "flat"}),
            "sea.foam is given for a mirror (sea.slopes.kind = 'flat'), whose waves cannot break; leave out one of them",
        ),
        (
            _scenario(7.0, {}) | {"mean": {"mode": "article"}},
            "mean.mode = 'article' has no foam; leave out [sea.foam], or set mean.mode = 'spectral'",
        ),
        (_scenario(7.0, {"law": "monahan-1971"}), "sea.foam.law = 'monahan-1971' is not one of 'monahan-1980', 'monahan-1980-robust'"),
        (_scenario(7.0, {"share": 0.1}), "sea.foam.share"),
        (_scenario(7.0, {"extrapolate": 1}), "sea.foam.extrapolate = 1"),
    ],
)
def test_refusals_have_one_line(raw: dict[str, Any], text: str) -> None:
    with pytest.raises(ScenarioError) as refused:
        parse_scenario(raw)
    assert text in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("sea", [{"resolve_waves": False}, {"spectrum": {"kind": "flat"}}], ids=["unresolved", "flat-spectrum"])
def test_seas_without_resolved_waves_may_have_foam(sea: dict[str, Any]) -> None:
    assert foam_coverage(parse_scenario(_scenario(10.0, {}, **sea))) > 0.0


def test_info_states_the_coverage(tmp_path: Path) -> None:
    file = tmp_path / "foam.toml"
    file.write_text("[wind]\nspeed_m_s = 10.0\n[sea.foam]\nlaw = 'callaghan-2008'\n")
    (line,) = [line for line in sg.info(file)["about"] if line.startswith("scene")]
    assert "sea at 288.15 K, 0.795 % foam (callaghan-2008); air" in line
    file.write_text("[wind]\nspeed_m_s = 10.0\n")
    assert not any("foam" in line for line in sg.info(file)["about"])


def test_ensembles_draw_the_law() -> None:
    vary = [{"key": "sea.foam.law", "law": "choice", "values": ["monahan-1980", "callaghan-2008"]}]
    parsed = parse_ensemble({"ensemble": {"scenes": 4}, "vary": vary})
    assert parsed.vary[0].key == "sea.foam.law"


def test_sweeps_vary_the_law() -> None:
    swept = sg.sweep(_scenario(10.0, None), {"sea.foam.law": list(FOAM_WINDS)}, what=lambda scene: 100.0 * foam_coverage(scene))
    assert swept["value"].values.tolist() == pytest.approx([100.0 * coverage(law, 10.0) for law in FOAM_WINDS], rel=1e-12)
