"""Where a scenario's air comes from: defaults of the live engine, what it refuses, files that count from the scenario's folder."""

import pytest

from seaglint.base.errors import ScenarioError
from seaglint.scenario.load import parse_scenario


def test_the_live_engine_by_default():
    air = parse_scenario({"atmosphere": {"source": "lowtran"}}).atmosphere
    assert (air.model, air.haze, air.air_mass_character) == ("midlatitude-summer", "navy-maritime", 3)
    assert (air.sounding, air.visibility_km, air.wind_24h_m_s) == (None, None, None)


def test_the_live_engine_goes_where_the_tables_end():
    found = parse_scenario({"atmosphere": {"source": "lowtran"}, "sensor": {"height_m": 0.5}, "band": {"min_um": 5.6, "max_um": 7.0}})
    assert found.sensor.height_m == 0.5


def test_units_of_the_file_are_taken():
    assert parse_scenario({"atmosphere": {"source": "lowtran", "visibility_km": "5000 m"}}).atmosphere.visibility_km == pytest.approx(5.0)


@pytest.mark.parametrize("kind", [{"source": "lowtran", "sounding": "air.csv"}, {"source": "file", "path": "air.csv"}])
def test_files_count_from_the_scenario(tmp_path, kind):
    with pytest.raises(ScenarioError, match=r"= 'air\.csv' is not a file that exists; a relative path counts from"):
        parse_scenario({"atmosphere": kind}, base=tmp_path)
    (tmp_path / "air.csv").write_text("")
    air = parse_scenario({"atmosphere": kind}, base=tmp_path).atmosphere
    assert (air.sounding if "sounding" in kind else air.path) == tmp_path / "air.csv"


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"wind": {"speed_m_s": 22.0}, "sea": {"slopes": {"extrapolate": True}}}, "wind.speed_m_s = 22 is above the range of the Navy"),
        ({"band": {"min_um": 13.0, "max_um": 20.0}}, "band.max_um = 20 is outside LOWTRAN7; allowed: 0.7 to 14.7 um, .* 'lowtran-fortran'"),
        (
            {"band": {"min_um": 20.0, "max_um": 30.0}, "atmosphere": {"source": "lowtran-fortran"}},
            "band.max_um = 30 is outside LOWTRAN7; allowed: 0.2 to 28 um",
        ),
        ({"sensor": {"height_m": 0.001}}, "sensor.height_m = 0.001 is too low for LOWTRAN7"),
        ({"atmosphere": {"haze": "none", "visibility_km": 5.0}}, "atmosphere.visibility_km = 5 goes with an aerosol"),
        ({"atmosphere": {"haze": "navy"}}, "atmosphere.haze = 'navy' is not one of .* did you mean 'navy-maritime'"),
        ({"atmosphere": {"air_mass_character": 11}}, "atmosphere.air_mass_character = 11"),
        ({"atmosphere": {"wind_24h_m_s": 25}}, "atmosphere.wind_24h_m_s = 25"),
        ({"atmosphere": {"model": "tropic"}}, "did you mean 'tropical'"),
        ({"atmosphere": {"path": "air.csv"}}, "atmosphere.path does not go with this source of atmosphere"),
    ],
)
def test_what_it_does_not_cover_is_refused(change, told):
    with pytest.raises(ScenarioError, match=told):
        parse_scenario(change | {"atmosphere": {"source": "lowtran"} | change.get("atmosphere", {})})


def test_another_haze_has_no_limit_of_wind():
    storm = {"wind": {"speed_m_s": 22.0}, "sea": {"slopes": {"extrapolate": True}}}
    assert parse_scenario(storm | {"atmosphere": {"source": "lowtran", "haze": "maritime-23km"}}).wind.speed_m_s == 22.0
