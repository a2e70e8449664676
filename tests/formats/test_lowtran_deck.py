"""LOWTRAN7's cards as its fixed columns read them, soundings as profiles, and what of a sounding is refused."""

from typing import get_args

import numpy as np
import pytest

from seaglint.air.profile.air_profile import saturation_density
from seaglint.base.errors import DataError, DomainError
from seaglint.formats.lowtran.deck import HAZES, MODELS, MOST_LEVELS, Aerosol, LowtranAir, LowtranCase, ProfileLevel
from seaglint.scenario.records.atmosphere_table import LowtranAtmosphere
from seaglint.studies.build.profile_air import program_levels


def columns(line, width):
    return [line[i : i + width] for i in range(0, len(line), width)]


def fortran(field):
    """A number as format F10.3 or E10.3 reads it: without a point, the last three digits are decimals."""
    digits, _, power = field.strip().upper().partition("E")
    return (float(digits) if "." in digits else int(digits) * 1e-3) * 10.0 ** int(power or 0)


def test_cards_of_a_path_stand_in_their_columns():
    air = LowtranAir("us-standard-1976", Aerosol(visibility_km=12.5, air_mass=7, wind=8.25, wind_24h=5.5), 2000, 3335)
    card1, card2, card3, card4, card5 = LowtranCase(air, "path", 0.0023, 90.125).deck().splitlines()
    assert [int(c) for c in columns(card1[:15], 5)] == [6, 2, 1]  # MODEL, ITYPE, IEMSCT
    assert fortran(card1[65:73]) == 0.001  # TBOUND: the sea adds nothing
    assert [int(c) for c in columns(card2[:30], 5)] == [3, 0, 0, 7, 0, 0]  # IHAZE ... ICSTL
    assert [fortran(c) for c in columns(card2[30:60], 10)] == [12.5, 8.25, 5.5]  # VIS, WSS, WHH
    assert [fortran(c) for c in columns(card3[:30], 10)] == [0.0023, 0.0, 90.125]
    assert [fortran(c) for c in columns(card4[:30], 10)] == [2000.0, 3335.0, 5.0]
    assert int(card5) == 0


@pytest.mark.parametrize(("kind", "itype", "iemsct"), [("path", 2, 1), ("sky", 3, 1), ("sun", 3, 3)])
def test_kinds_of_case(kind, itype, iemsct):
    card = LowtranCase(LowtranAir("tropical", Aerosol(), 2000, 2500), kind, 0.0, 45.0).deck()
    assert (int(card[5:10]), int(card[10:15])) == (itype, iemsct)


@pytest.mark.parametrize(
    ("pressure", "temperature", "humidity"),
    [(1013.0, 294.0, 76.0), (1013.25, 294.25, 0.0), (2.5e-4, 210.0, 1e-5), (999.9999, 300.0, 100.0)],
)
def test_numbers_of_a_level_mean_what_they_are(pressure, temperature, humidity):
    card = ProfileLevel(12.3456, pressure, temperature, humidity).card(2)
    assert [fortran(c) for c in columns(card[:40], 10)] == pytest.approx([12.3456, pressure, temperature, humidity], rel=1e-6)
    assert card[60:] == "AAH" + 11 * "2"  # hPa, K, relative humidity; the other gases of model 2


def test_navy_aerosol_does_not_take_a_storm_for_20_metres_a_second():
    with pytest.raises(DomainError, match=r"wind = 25 m/s is above 20 m/s"):
        Aerosol(wind=25.0).card()
    assert Aerosol("rural-23km", wind=25.0).card()


def test_scenario_and_engine_know_the_same_names():
    fields = LowtranAtmosphere.model_fields
    assert set(get_args(fields["haze"].annotation)) == set(HAZES)
    assert set(get_args(fields["model"].annotation)) == set(MODELS)


HEAD = "height_m,pressure_hpa,temperature_k,relative_humidity_percent\n"


def write(tmp_path, text):
    path = tmp_path / "sounding.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_sounding_is_continued_down_to_the_sea_and_up_to_space(tmp_path):
    levels = program_levels(write(tmp_path, "# ship\n" + HEAD + "20,1010,290,80\n1000,900,284,60\n5000,541,258,20\n"))
    assert levels[0].height_km == 0.0
    assert levels[0].pressure_hpa == pytest.approx(1010.0 * np.exp(9.81 * 20.0 / (287.05 * 291.7)), rel=1e-5)  # hydrostatic, moist air
    assert (levels[1].temperature_k, levels[0].temperature_k) == (290.0, 290.0)
    heights = [level.height_km for level in levels]
    assert heights == sorted(set(heights))
    assert heights[3:5] == [5.0, 6.0]
    assert heights[-1] == 100.0
    assert levels[4].pressure_hpa is None  # the model's


def test_a_fine_sounding_is_thinned_where_it_says_least(tmp_path):
    z = np.linspace(0.0, 20_000.0, 401)
    t = np.where(z < 1500.0, 290.0 - 6.5e-3 * z, np.where(z < 1800.0, 280.25 + 0.02 * (z - 1500.0), 286.25 - 4e-3 * (z - 1800.0)))
    fall = np.concatenate([[0.0], np.cumsum(9.81 * 50.0 / (287.05 * 0.5 * (t[1:] + t[:-1])))])
    rows = "".join(f"{a},{p},{b},{70.0 if a < 1800.0 else 20.0}\n" for a, p, b in zip(z, 1013.0 * np.exp(-fall), t, strict=True))
    levels = program_levels(write(tmp_path, HEAD + rows))
    assert len(levels) <= MOST_LEVELS
    own = [level for level in levels if level.pressure_hpa is not None]
    kept = [1e3 * level.height_km for level in own]
    np.testing.assert_allclose(np.interp(z, kept, [level.temperature_k for level in own]), t, atol=0.3)  # one unit of THINNING
    assert {0.0, 1500.0, 1800.0, 20_000.0} <= set(kept)  # ends and the corners of the inversion


def test_dew_points_are_relative_humidities(tmp_path):
    dew = program_levels(write(tmp_path, "height_m;pressure_hpa;temperature_c;dewpoint_c\n0;1013;20;20\n1000;900;15;5\n"))
    assert dew[0].relative_humidity == pytest.approx(100.0)
    # Vapour pressures of water at 5 and 15 degC, WMO tables: 8.719 and 17.044 hPa; LOWTRAN7's formula is good to 1 %.
    assert dew[1].relative_humidity == pytest.approx(100.0 * 8.719 / 17.044, rel=0.01)
    assert dew[1].temperature_k == pytest.approx(288.15)


def test_saturation_density_is_the_tabulated_one():
    assert saturation_density(293.15) == pytest.approx(17.30, rel=0.01)  # g m-3 at 20 degC, Smithsonian tables


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "is empty"),
        (HEAD, "no rows"),
        ("height_m,pressure_hpa,temperature_k\n0,1013,290\n", "line 1: columns are .* missing: relative_humidity_percent"),
        ("height_m,temperature_k,dewpoint_k\n0,290,280\n", "line 1: .* missing: pressure_hpa"),
        (HEAD + "0,1013,290,80\n1000,900,abc,50\n", "line 3: temperature_k = 'abc' is not a number"),
        (HEAD + "0,1013,290,80\n1000,900,nan,50\n", "has 1 levels with pressure, temperature and humidity"),
        (HEAD + "0,1013,17,80\n1000,900,10,50\n", "are temperatures in Celsius"),
        (HEAD + "0,101300,290,80\n1000,90000,284,60\n", "are pressures in Pa"),
        (HEAD + "600,940,290,80\n1000,897,286,60\n", "the lowest level lies at 600 m"),
        (HEAD + "0,1013,290,80\n", "has 1 levels"),
        ("height_m,pressure_hpa,temperature_k,dewpoint_k\n0,1013,290,280\n1000,900,280,285\n", "dewpoint_k .* lies above temperature_k"),
    ],
)
def test_malformed_soundings_are_refused_in_one_line(tmp_path, text, told):
    with pytest.raises(DataError, match=told) as caught:
        program_levels(write(tmp_path, text))
    assert "\n" not in str(caught.value)
    assert "sounding.csv" in str(caught.value)


def test_a_missing_sounding_is_named(tmp_path):
    with pytest.raises(DataError, match=r"none\.csv: no such file"):
        program_levels(tmp_path / "none.csv")
