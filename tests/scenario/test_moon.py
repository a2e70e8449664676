"""The Moon of a scenario: given or from date and place, refused in one line, reported beside the Sun."""

from __future__ import annotations

import logging
import math

import numpy as np
import pytest

from seaglint.base.errors import ScenarioError
from seaglint.climate.moon_position import MoonEphemeris
from seaglint.optics.moonlight import MEAN_MOON_DISTANCE
from seaglint.scenario.ensemble_file import load_ensemble
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.moon import moon_position
from seaglint.scenario.sun import SUN_STEP_TIME
from seaglint.scenario.text.display import scenario_html
from seaglint.studies.file_contents import describe_scenario

NIGHT = {"time": {"utc": "2026-04-02T01:00:00Z"}, "place": {"latitude_deg": 36.8, "longitude_deg": -30.0}}
GIVEN = {"zenith_deg": 50.0, "azimuth_deg": 120.0, "phase_deg": 30.0}


def test_without_the_table_there_is_no_moon():
    assert moon_position(parse_scenario(NIGHT)) is None


def test_given_angles():
    moon = moon_position(parse_scenario({"sun": {"zenith_deg": 150, "azimuth_deg": 300}, "moon": GIVEN}))
    assert np.degrees([moon.zenith, moon.azimuth, moon.phase]) == pytest.approx([50.0, 120.0, 30.0])
    assert moon.distance_m == MEAN_MOON_DISTANCE
    assert moon.lit_share == pytest.approx(0.5 * (1.0 + math.sqrt(0.75)))
    # the Sun is at the nadir's other side: the lower side of the Moon is lit
    assert abs(math.degrees(moon.bright_limb)) == pytest.approx(180.0)
    near = moon_position(parse_scenario({"moon": GIVEN | {"distance_km": 360_000}}))
    assert near.radius / moon.radius == pytest.approx(384.4 / 360.0, rel=1e-4)


def test_date_and_place():
    moon = moon_position(parse_scenario({**NIGHT, "moon": {}}))
    time = 1775091600.0
    expected = MoonEphemeris.of_year(2026).at(time, 36.8, -30.0)
    got = (moon.zenith, moon.azimuth, moon.phase, moon.distance_m, moon.bright_limb, moon.sun_distance_au)
    assert got == pytest.approx([float(values[0]) for values in expected], rel=1e-7, abs=1e-7)
    assert math.degrees(moon.phase) < 5.0  # full Moon on 2026-04-02, 02:12 UTC


def test_it_moves_in_the_steps_of_the_sun():
    scenario = parse_scenario({**NIGHT, "moon": {}})
    first, later = moon_position(scenario), moon_position(scenario, 300)
    turn = 2.0 * math.pi * 300 * SUN_STEP_TIME / 89_428.0  # from one culmination to the next, 24.84 h
    across = math.acos(
        math.cos(first.zenith) * math.cos(later.zenith)
        + math.sin(first.zenith) * math.sin(later.zenith) * math.cos(first.azimuth - later.azimuth)
    )
    assert across == pytest.approx(turn, rel=0.02)  # its declination is -5 deg


INSTEAD = "Sun and Moon; or give [sun] instead, with zenith_deg, azimuth_deg and phase_deg in [moon]"


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        ({"moon": {}}, "moon has no angles and needs [time] and [place]"),
        ({"sun": {}, "moon": {}}, "moon has no angles and needs [time] and [place]"),
        ({"time": NIGHT["time"], "moon": {}}, f"place is missing: [time] needs [place] latitude_deg, longitude_deg to find {INSTEAD}"),
        ({"place": NIGHT["place"], "moon": {}}, f"time is missing: [place] needs [time] utc to find {INSTEAD}"),
        (
            {"moon": GIVEN, "mean": {"mode": "article"}},
            "mean.mode = 'article' has no Moon; leave out [moon], or set mean.mode = 'spectral'",
        ),
        ({"moon": {"zenith_deg": 50}}, "moon.azimuth_deg is missing, but zenith_deg is given; give zenith_deg, azimuth_deg and phase_deg"),
        ({**NIGHT, "moon": {"zenith_deg": 50, "azimuth_deg": 0}}, "moon.phase_deg is missing, but zenith_deg and azimuth_deg are given"),
        ({"moon": GIVEN | {"phase_deg": 400}}, "moon.phase_deg = 400 is outside the allowed range: 0 to 180 deg"),
        ({"moon": GIVEN | {"zenith_deg": -1}}, "moon.zenith_deg = -1 is outside the allowed range: 0 to 180 deg"),
        ({**NIGHT, "moon": {"distance_km": 380_000}}, "moon.distance_km = 380000 is given without angles"),
        ({"moon": GIVEN | {"distance_km": 100}}, "moon.distance_km = 100 is outside the allowed range: 340000 to 420000 km"),
        ({"moon": GIVEN | {"illumination": 0.5}}, "moon.illumination is an unknown key"),
    ],
)
def test_wrong_moons_are_refused_in_one_line(tables, message):
    with pytest.raises(ScenarioError) as caught:
        parse_scenario(tables)
    assert str(caught.value).startswith(f"scenario: {message}")
    assert "\n" not in str(caught.value)


def test_times_and_places_that_are_drawn_need_none():
    scenario = parse_scenario({"place": NIGHT["place"], "moon": {}, "likelihood": {"weather": "north-atlantic"}})
    with pytest.raises(ScenarioError, match="one position of the Moon is needed"):
        moon_position(scenario)


@pytest.mark.parametrize(
    ("tables", "expected"),
    [
        ({**NIGHT, "moon": {}}, "Moon              zenith 46.68 deg, azimuth 160.14 deg, phase 3.3 deg (100 % lit), radius 0.256 deg"),
        ({"moon": GIVEN}, "Moon              zenith 50.00 deg, azimuth 120.00 deg, phase 30.0 deg (93 % lit), radius 0.259 deg"),
        ({"moon": GIVEN | {"zenith_deg": 91.0}}, "radius 0.259 deg; it is below the horizon: no moonlight"),
        (
            {"moon": GIVEN | {"zenith_deg": 91.0}, "sensor": {"height_m": 10_000.0}},
            "radius 0.259 deg; it is below the horizontal: only places towards it are lit",
        ),
        (
            {"time": {"utc": "2025-09-07T18:12:00Z"}, "place": {"latitude_deg": 0.0, "longitude_deg": 87.0}, "moon": {}},
            "note              the Moon may be in the Earth's shadow: eclipses are left out",
        ),
    ],
)
def test_facts_of_a_file_say_where_it_is(tmp_path, tables, expected):
    text = "\n".join(f"[{name}]\n" + "\n".join(f"{key} = {value}" for key, value in table.items()) for name, table in tables.items())
    (tmp_path / "night.toml").write_text(text, encoding="utf-8")
    lines = describe_scenario(tmp_path / "night.toml").lines
    assert any(line.strip().endswith(expected) for line in lines)
    assert any(line.strip().startswith("Sun ") for line in lines)


@pytest.mark.parametrize(("phase", "told"), [(0.0, True), (157.0, True), (160.0, False)])
def test_phases_that_the_sun_does_not_give_are_reported(tmp_path, caplog, monkeypatch, phase, told):
    monkeypatch.setattr(logging.getLogger("seaglint"), "propagate", True)
    angles = f"[sun]\nzenith_deg = 62\nazimuth_deg = 90\n[moon]\nzenith_deg = 60\nazimuth_deg = 90\nphase_deg = {phase}\n"
    (tmp_path / "beside.toml").write_text(angles, encoding="utf-8")
    load_scenario(tmp_path / "beside.toml")
    reported = {record.getMessage() for record in caplog.records}  # a record may arrive twice where other tests left handlers
    assert ["2 deg apart, where the phase angle is 178 deg" in text for text in reported] == [True] * told


def test_notebooks_show_it():
    assert "Moon: zenith angle 50.0°, azimuth 120.0°, phase angle 30.0°, 93 % lit" in scenario_html(parse_scenario({"moon": GIVEN}))
    assert "Moon" not in scenario_html(parse_scenario({}))


def test_its_keys_can_be_drawn(tmp_path):
    (tmp_path / "base.toml").write_text("[moon]\nzenith_deg = 40\nazimuth_deg = 100\nphase_deg = 10\n", encoding="utf-8")
    law = '[[vary]]\nkey = "moon.phase_deg"\nlaw = "uniform"\nmin = 0\nmax = 90\n'
    (tmp_path / "ensemble.toml").write_text(f'base = "base.toml"\n[ensemble]\nscenes = 2\n{law}', encoding="utf-8")
    assert load_ensemble(tmp_path / "ensemble.toml").vary[0].key == "moon.phase_deg"
