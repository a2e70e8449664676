"""Glint along a track in the weather of a forecast, against weather tables of the same conditions and closed forms."""

from __future__ import annotations

import math
from pathlib import Path

import forecast_files as made
import numpy as np
import pytest

import seaglint as sg
from seaglint.base.errors import DataError, SeaglintError
from seaglint.climate.weather_table import WeatherTable
from seaglint.scenario.load import parse_scenario
from seaglint.studies.likelihood.ship_track import along_track

WANTED = {"threshold_w_m2_sr": [0.5], "depression_deg": [1.5, 6.0], "azimuth_from_sun_deg": [-40, 40]}
AIR = {"atmosphere": {"source": "none"}, "sensor": {"height_m": 30.0}}


def scenario(**wanted):
    return parse_scenario({**AIR, "likelihood": WANTED | wanted})


def table(wind, wind_from, cover):
    columns = {"wind_speed_m_s": wind, "wind_from_deg": wind_from, "cloud_cover": cover}
    return WeatherTable({name: np.array(values, dtype=float) for name, values in columns.items()})


def forecast(path: Path, wind, wind_from, cover) -> Path:
    """The same weather everywhere and at all times, a member for each wind."""
    of = made.fields(members=len(wind))
    towards = np.radians(np.array(wind_from) + 180.0)
    u, v, n = (
        np.broadcast_to(np.array(x)[None, :, None, None], of.u.shape) for x in (wind * np.sin(towards), wind * np.cos(towards), cover)
    )
    of = of._replace(u=u, v=v, cover=n)
    return made.ecmwf(path, of if len(wind) > 1 else of._replace(u=u[:, 0], v=v[:, 0], cover=n[:, 0]))


@pytest.mark.parametrize("case", ["single-look", "trajectory"])
def test_constant_weather_is_a_table_of_one_row(tmp_path: Path, case: str) -> None:
    one = ([6.0], [230.0], [0.25])
    chances = along_track(
        scenario(case=case), made.way(tmp_path / "way.csv"), forecast=forecast(tmp_path / "f.nc", *one), samples=512, weather=table(*one)
    )
    assert 0.0 < max(chance.probability for chance in chances.way) < 1.0
    for chance in chances.way:
        assert chance.forecast_probability == pytest.approx(chance.probability, abs=1e-3)
        assert (chance.wind_speed_m_s, chance.wind_from_deg, chance.cloud_cover) == pytest.approx((6.0, 230.0, 0.25))
    (row,) = chances.results
    assert row.forecast_hours == pytest.approx(row.hours, rel=1e-3)
    assert row.forecast_mean_duration_hours == pytest.approx(row.mean_duration_hours, rel=1e-2)


def test_members_are_a_table_of_their_rows(tmp_path: Path) -> None:
    """Members in the order of their winds are drawn by the same numbers as the rows of a table."""
    rows = ([2.0, 4.0, 8.0, 13.0], [200.0, 230.0, 260.0, 290.0], [0.0, 0.25, 0.5, 0.75])
    chances = along_track(
        scenario(), made.way(tmp_path / "way.csv"), forecast=forecast(tmp_path / "f.nc", *rows), samples=1024, weather=table(*rows)
    )
    for chance in chances.way:
        assert chance.forecast_probability == pytest.approx(chance.probability, abs=1e-3)
        assert chance.cloud_cover == pytest.approx(0.375)
    assert any("4 members, each as likely" in note for note in chances.notes)


def test_the_direction_of_the_wind_matters(tmp_path: Path) -> None:
    """Winds along and across the look, at the same speed: slopes are wider along the wind."""
    chances = [
        along_track(
            scenario(azimuth_from_sun_deg=[10, 25]),
            made.way(tmp_path / f"{come}.csv", range(5, 10)),
            forecast=forecast(tmp_path / f"{come}.nc", [9.0], [come], [0.0]),
            samples=1024,
            weather=table([9.0], [math.nan], [0.0]),
        ).results[0]
        for come in (0.0, 45.0, 90.0, 135.0)
    ]
    hours = [row.forecast_hours for row in chances]
    assert max(hours) > 1.1 * min(hours)
    assert min(hours) < chances[0].hours < max(hours)


def test_a_spread_of_the_cover_frees_the_sun_of_an_overcast_sky(tmp_path: Path) -> None:
    # The mean of 1 - min(1 + s z, 1) with a normal z is s / sqrt(2 pi); every look with the Sun up exceeds 0.
    given = {"forecast": forecast(tmp_path / "f.nc", [5.0], [0.0], [1.0]), "weather": table([5.0], [math.nan], [0.5])}
    track = made.way(tmp_path / "way.csv", (11, 12, 13))
    wanted = scenario(threshold_w_m2_sr=[0.0])
    sure = along_track(wanted, track, **given)
    spread = along_track(wanted, track, **given, cover_spread=0.2, wind_spread=1.0)
    assert [chance.forecast_probability for chance in sure.way] == [0.0] * 3
    for chance in spread.way:
        assert chance.forecast_probability == pytest.approx(0.2 / math.sqrt(2.0 * math.pi), rel=0.02)
    assert [chance.probability for chance in spread.way] == [chance.probability for chance in sure.way]


def test_errors_of_wind_and_cover_are_independent(tmp_path: Path) -> None:
    """Above calms the chance is the mean over winds times the mean over covers."""
    given = {"forecast": forecast(tmp_path / "f.nc", [3.0], [0.0], [0.5]), "weather": table([5.0], [math.nan], [0.5])}
    track, wanted = made.way(tmp_path / "way.csv", (5, 6)), scenario(azimuth_from_sun_deg=[0, 0])
    one, other = (along_track(wanted, track, **given, wind_spread=1.5, cover_spread=spread, samples=8192).way for spread in (0.0, 0.3))
    for half, spread in zip(one, other, strict=True):
        assert half.forecast_probability > 0.0
        # Covers of 0.5 +- 0.3 that end at 0 and 1 keep their mean. 8192 Sobol points.
        assert spread.forecast_probability == pytest.approx(half.forecast_probability, rel=0.02)


def test_strong_winds_of_a_forecast_are_inside_the_tables(tmp_path: Path) -> None:
    """The table's winds end at 6 m/s, those of the forecast are 14 m/s: they are not taken as 6."""
    track = made.way(tmp_path / "way.csv", range(4, 10))
    ahead = forecast(tmp_path / "f.nc", [14.0], [230.0], [0.0])
    low = along_track(scenario(), track, forecast=ahead, samples=512, weather=table([4.0], [230.0], [0.0]))
    high = along_track(scenario(), track, forecast=ahead, samples=512, weather=table([14.0], [230.0], [0.0]))
    for one, other in zip(low.way, high.way, strict=True):
        assert one.forecast_probability == pytest.approx(other.probability, abs=4e-3)


def test_places_off_the_sea_of_the_climatology_are_told(tmp_path: Path) -> None:
    def along(*places: tuple[float, float]) -> list[str]:
        rows = [f"2026-06-21T{10 + i}:00:00Z,{north},{east}" for i, (north, east) in enumerate(places)]
        (tmp_path / "way.csv").write_text("\n".join(["time_utc,latitude_deg,longitude_deg", *rows]), encoding="utf-8")
        return along_track(scenario(), tmp_path / "way.csv", samples=256).notes

    notes = along((45.0, -30.0), (57.0, 10.0), (57.0, 10.5))
    assert any(note.startswith("no observations at row 2 of the track = [57, 10]: the weather is that of") for note in notes)
    assert any("(2 of 3 rows like it)" in note for note in notes)
    assert not any("of the track" in note for note in along((45.0, -30.0), (45.0, -31.0)))
    with pytest.raises(SeaglintError, match=r"row 2 of the track = \[50, 60\] is on land.*the nearest sea of the climatology is \["):
        along((45.0, -30.0), (50.0, 60.0))


def test_a_spread_of_python_is_checked(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"wind_spread = -1 is outside 0 to 50"):
        sg.likelihood({"likelihood": {}}, track=tmp_path / "w.csv", forecast=tmp_path / "f.nc", wind_spread=-1.0)
