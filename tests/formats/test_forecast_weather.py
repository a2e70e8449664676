"""Forecasts of weather at the times and places of a track: layouts of several centres, interpolation by brute force, and bad files."""

from __future__ import annotations

import math
from pathlib import Path

import forecast_files as made
import numpy as np
import pytest
import xarray as xr

from seaglint.base.errors import DataError
from seaglint.climate.weather_selection import Selection
from seaglint.formats.weather.era5_weather import read_era5
from seaglint.formats.weather.forecast_weather import read_forecast

HOUR = 3600.0
START = np.datetime64("2026-06-20T00", "s").astype(np.int64) * 1.0


def track(hours, latitude, longitude):
    return START + HOUR * np.atleast_1d(np.float64(hours)), np.atleast_1d(np.float64(latitude)), np.atleast_1d(np.float64(longitude))


def by_hand(of: made.Fields, hour: float, latitude: float, longitude: float) -> tuple[float, float, float]:
    """Speed, direction and cover as means over the neighbours at two steps, each found by looking at every point of the grid."""
    sums = np.zeros(4)
    for t, moment in enumerate(of.time):
        share = max(1.0 - abs((moment - of.time[0]) / np.timedelta64(1, "h") - hour) / 6.0, 0.0)
        of_step, total = np.zeros(4), 0.0
        for y, lat in enumerate(of.latitude):
            for x, lon in enumerate(of.longitude):
                away = abs((lon - longitude + 180.0) % 360.0 - 180.0)
                weight = max(1.0 - abs(lat - latitude), 0.0) * max(1.0 - away, 0.0)
                u, v, n = of.u[t, y, x], of.v[t, y, x], of.cover[t, y, x]
                if weight and not math.isnan(n):
                    s = math.hypot(u, v)
                    of_step, total = of_step + weight * np.array([s, u / s, v / s, n]), total + weight
        sums += share * of_step / total
    speed, east, north, cover = sums
    return speed, math.degrees(math.atan2(-east, -north)) % 360.0, cover


@pytest.mark.parametrize(
    "longitude", [(358.0, 359.0, 0.0, 1.0), (178.0, 179.0, 180.0, 181.0), (-182.0, -181.0, -180.0, -179.0), tuple(range(360))]
)
def test_values_between_the_points_are_those_of_brute_force(tmp_path: Path, longitude: tuple[float, ...]) -> None:
    of = made.fields(longitude=longitude)
    of.cover[0, 0, 0] = np.nan
    rng = np.random.default_rng(2)
    hours, latitude = rng.uniform(0.0, 18.0, 40), rng.uniform(50.0, 52.0, 40)
    places = longitude[0] + rng.uniform(0.0, 3.0, 40) + rng.choice([0.0, 360.0, -360.0], 40)
    if len(longitude) == 360:
        places[:20] = rng.uniform(359.0, 360.0, 20)  # between the last column and the first
    hours[0], latitude[0], places[0] = 18.0, 52.0, longitude[-1]
    weather = read_forecast(made.ecmwf(tmp_path / "f.nc", of), *track(hours, latitude, places))
    expected = np.array([by_hand(of, *one) for one in zip(hours, latitude, places, strict=True)])
    np.testing.assert_allclose(weather.wind_speed_m_s[:, 0], expected[:, 0], rtol=1e-10)
    turn = (weather.wind_from_deg[:, 0] - expected[:, 1] + 180.0) % 360.0 - 180.0
    np.testing.assert_allclose(turn, 0.0, atol=1e-7)
    np.testing.assert_allclose(weather.cloud_cover[:, 0], expected[:, 2], atol=1e-12)


def test_a_place_on_the_western_line_but_for_rounding(tmp_path: Path) -> None:
    of = made.fields()
    weather = read_forecast(made.ecmwf(tmp_path / "f.nc", of), *track([0, 0], [51, 51], [358 - 1e-7, -2.0]))
    np.testing.assert_array_equal(weather.wind_speed_m_s[0], weather.wind_speed_m_s[1])


def test_a_turning_wind_keeps_its_speed(tmp_path: Path) -> None:
    of = made.fields(steps=2)
    of.u[0], of.v[0], of.u[1], of.v[1] = 10.0, 0.0, 0.0, 10.0
    weather = read_forecast(made.ecmwf(tmp_path / "f.nc", of), *track([0, 3, 6], [51] * 3, [0] * 3))
    np.testing.assert_allclose(weather.wind_speed_m_s[:, 0], 10.0)
    np.testing.assert_allclose(weather.wind_from_deg[:, 0], [270.0, 225.0, 180.0])


@pytest.mark.parametrize("layout", made.LAYOUTS)
def test_every_layout_gives_the_same_weather_to_the_last_bit(tmp_path: Path, layout: str) -> None:
    of = made.fields()
    way = track([0, 4, 18], [50.3, 51, 52], [-1.75, 0, 0.5])
    ours = read_forecast(made.ecmwf(tmp_path / "e.nc", of), *way)
    other = read_forecast(made.LAYOUTS[layout](tmp_path / "f.nc", of), *way)
    for name in ("wind_speed_m_s", "wind_from_deg", "cloud_cover"):
        assert getattr(ours, name).tobytes() == getattr(other, name).tobytes()
    # Weather tables are built of the same files.
    rows = read_era5(tmp_path / "f.nc", Selection())
    assert (rows.rows, rows.kind) == (48, "ERA5" if layout == "steps" else "weather grid")
    assert np.sort(rows.columns["cloud_cover"]).tolist() == np.sort(of.cover.ravel()).tolist()


@pytest.mark.parametrize("members", [0, 3])
def test_grib_of_gfs_has_its_wind_at_10_m_and_its_total_cover(tmp_path: Path, members: int) -> None:
    """Winds at 100 m and the cover of a level of pressure are beside them."""
    pytest.importorskip("cfgrib")
    of = made.fields(longitude=(0.0, 1.0, 2.0, 3.0), members=members)
    way = track([6, 12], [51, 52], [2, 3])
    weather = read_forecast(made.grib(tmp_path / "g.grib2", of, members), *way)
    expected = read_forecast(made.ecmwf(tmp_path / "e.nc", of), *way)
    assert weather.members == max(members, 1)
    np.testing.assert_allclose(weather.wind_speed_m_s, expected.wind_speed_m_s, atol=2e-6)
    np.testing.assert_allclose(weather.cloud_cover, expected.cloud_cover, atol=1e-7)


def test_members_stay_apart(tmp_path: Path) -> None:
    of = made.fields(members=3)
    weather = read_forecast(made.ecmwf(tmp_path / "f.nc", of), *track([6], [51], [359]))
    np.testing.assert_allclose(weather.wind_speed_m_s[0], np.hypot(of.u, of.v)[1, :, 1, 1])
    np.testing.assert_array_equal(weather.cloud_cover[0], of.cover[1, :, 1, 1])
    speed, come = weather.mean_wind()
    assert speed[0] == pytest.approx(np.hypot(of.u, of.v)[1, :, 1, 1].mean())
    assert come[0] == pytest.approx(math.degrees(math.atan2(-of.u[1, :, 1, 1].mean(), -of.v[1, :, 1, 1].mean())) % 360.0)


@pytest.mark.parametrize(("unit", "size"), [("kn", 3600.0 / 1852.0), ("km/h", 3.6), ("m/sec", 1.0)])
def test_units_are_those_of_the_tag(tmp_path: Path, unit: str, size: float) -> None:
    of = made.fields()
    eighths = of._replace(u=of.u * size, v=of.v * size, cover=8.0 * of.cover)
    way = track([6], [51], [359])
    ours = read_forecast(made.ecmwf(tmp_path / "e.nc", of), *way)
    other = read_forecast(made.ecmwf(tmp_path / "f.nc", eighths, u10=unit, v10=unit, tcc="okta"), *way)
    np.testing.assert_allclose(other.wind_speed_m_s, ours.wind_speed_m_s, rtol=1e-12)
    np.testing.assert_array_equal(other.cloud_cover, ours.cloud_cover)


@pytest.mark.parametrize(
    ("hours", "latitude", "longitude", "message"),
    [
        ([0, 21], 51, 0, r"f.nc: the forecast ends 2026-06-20T18:00Z, before row 2 of the track, 2026-06-20T21:00Z; bring a later"),
        ([-3, 0], 51, 0, r"f.nc: the forecast begins 2026-06-20T00:00Z, after row 1 of the track, 2026-06-19T21:00Z; bring an earlier"),
        (
            [0, 6],
            [51, 53],
            0,
            r"row 2 of the track, latitude 53, longitude 0, is outside the forecast, latitudes 50 to 52, longitudes -2 to 1",
        ),
        ([0, 6], 51, [0, 1.5], r"row 2 of the track, latitude 51, longitude 1.5, is outside"),
        ([0, 6], 51, [0, 180], r"row 2 of the track, latitude 51, longitude 180, is outside"),
    ],
)
def test_a_track_beyond_the_forecast_is_refused(tmp_path: Path, hours, latitude, longitude, message) -> None:
    time, lat, lon = np.broadcast_arrays(*track(hours, latitude, longitude))
    with pytest.raises(DataError, match=message) as told:
        read_forecast(made.ecmwf(tmp_path / "f.nc", made.fields()), time, lat, lon)
    assert "\n" not in str(told.value)


def _changed(path: Path, **changes: object) -> Path:
    """A good file with variables replaced, or removed where they are None."""
    data = xr.open_dataset(made.ecmwf(path.with_name("good.nc"), made.fields())).load()
    for name, change in changes.items():
        data = data.drop_vars(name) if change is None else change(data)
    data.to_netcdf(path, engine="h5netcdf")
    return path


def _unit(name: str, unit: str | None):
    def change(data: xr.Dataset) -> xr.Dataset:
        attributes = {} if unit is None else {"units": unit}
        return data.assign({name: data[name].drop_attrs().assign_attrs(attributes)})

    return change


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"tcc": None}, "has u10, v10 and no tcc; a forecast has wind components at 10 m and total cloud cover"),
        ({"tcc": _unit("tcc", None)}, "tcc has no attribute units; allowed are .*percent.*: convert it"),
        ({"u10": _unit("u10", "furlong/s")}, "u10 has the unknown unit 'furlong/s'; allowed are m s"),
        ({"tcc": lambda d: d.assign(tcc=(57.0 * d.tcc).assign_attrs(units="1"))}, "in the unit '1', a cover outside 0 to 1; correct its"),
        ({"tcc": lambda d: d.assign(tcc=d.tcc.where(d.latitude < 50.5))}, "has no wind or cloud cover around row 1 of the track"),
        ({"u10": lambda d: d.assign(u10=d.u10.where(False, 9999.0).assign_attrs(units="m/s"))}, "a wind of .* is outside 0 to 100 m/s"),
        ({"v10": lambda d: d.rename(valid_time="step").assign_coords(step=range(4))}, "no time that can be read"),
        ({"v10": lambda d: d.drop_vars(["latitude"])}, "a file of weather has time, latitude and longitude"),
        ({"v10": lambda d: d.rename(u10="a", v10="b", tcc="c")}, "has a, b, c; of a file of weather u10, v10, tcc"),
        ({"v10": lambda d: xr.concat([d, d], "expver").assign_coords(expver=[7, 8])}, r"has expver \[7, 8\]"),
        ({"v10": lambda d: xr.concat([d, d], "level")}, "has 2 entries of 'level'; select one of them"),
        (
            {"v10": lambda d: xr.concat([d.rename(valid_time="step").assign_coords(step=range(4), time=d.valid_time[0])] * 2, "time")},
            "has 2 forecasts of 4 steps each; select one of them, as in xarray: isel",
        ),
    ],
)  # fmt: skip
def test_a_file_that_cannot_be_used_is_refused_in_a_line(tmp_path: Path, changes, message) -> None:
    path = _changed(tmp_path / "f.nc", **changes)
    with pytest.raises(DataError, match=message) as told:
        read_forecast(path, *track([0], [52], [0]))
    assert str(told.value).startswith(f"{path}: ")
    assert "\n" not in str(told.value)


def test_an_ensemble_without_cloud_names_its_fields_alone(tmp_path: Path) -> None:
    path = made.ecmwf(tmp_path / "f.nc", made.fields(members=3), ("u10", "v10", "cover"))
    with pytest.raises(DataError, match="has u10, v10 and no tcc; a forecast has"):
        read_forecast(path, *track([0], [52], [0]))


def test_winds_at_other_heights_are_refused(tmp_path: Path) -> None:
    path = made.thredds(tmp_path / "t.nc", made.fields(), heights=(80.0, 100.0))
    with pytest.raises(DataError, match=r"u-component_of_wind_height_above_ground is at the height 80, 100 m; 10 m is needed"):
        read_forecast(path, *track([0], [52], [0]))


def test_a_plain_name_without_a_height_is_reported(tmp_path: Path) -> None:
    path = made.ecmwf(tmp_path / "f.nc", made.fields(), ("UGRD", "VGRD", "TCDC"))
    assert read_forecast(path, *track([0], [52], [0])).notes == (
        "UGRD states no height: taken as the wind at 10 m",
        "VGRD states no height: taken as the wind at 10 m",
    )


@pytest.mark.parametrize("length", [3, 100, 1500])
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_a_cut_file_is_refused_in_a_line(tmp_path: Path, length: int) -> None:
    path = made.wgrib2(tmp_path / "f.nc", made.fields())
    path.write_bytes(path.read_bytes()[:length])
    with pytest.raises(DataError, match=r"f.nc: .*(is it whole|cannot be read|no time|has )") as told:
        read_forecast(path, *track([0], [52], [0]))
    assert "\n" not in str(told.value)
