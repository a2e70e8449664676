"""A scenario keeps what was written, in the unit of its keys, and refuses the rest."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from seaglint.base.errors import ScenarioError
from seaglint.scenario.load import load_scenario, parse_scenario
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.quantities import CELSIUS, FACTORS, by_pint, convert
from seaglint.scenario.records.sensor_table import SQUARE_PIXEL_TOLERANCE

ROUNDING = 1e-12  # relative; unit conversions are one multiplication


def test_nothing_said_is_a_scenario_with_the_sun_in_view():
    scenario = parse_scenario({})
    assert scenario.sun is not None
    half = 0.5 * scenario.sensor.fov_deg[0]
    assert abs(scenario.sun.azimuth_deg - scenario.sensor.azimuth_deg) < half
    top = scenario.sensor.elevation_deg + 0.5 * scenario.sensor.fov_deg[1]
    assert 0.0 < top < 0.2 * scenario.sensor.fov_deg[1]  # the horizon is in the picture, near its top
    assert scenario.sensor.ifov_deg[0] == scenario.sensor.ifov_deg[1]


def test_a_scenario_cannot_change():
    with pytest.raises(ValidationError):
        parse_scenario({}).wind.speed_m_s = 3.0  # type: ignore[misc]


def test_json_gives_the_same_scenario_back():
    scenario = parse_scenario({"time": {"utc": "2026-06-21T17:30:00+02:00"}, "place": {"latitude_deg": 1, "longitude_deg": 2}})
    assert Scenario.model_validate_json(scenario.model_dump_json()) == scenario


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("12 kn", "m/s", 12 * 1852 / 3600),
        ("12 knots", "m/s", 12 * 1852 / 3600),
        ("30 ft", "m", 30 * 0.3048),
        ("-2 deg", "deg", -2.0),
        ("-2°", "deg", -2.0),
        ("0.1 rad", "deg", math.degrees(0.1)),
        ("15 degC", "K", 288.15),
        ("3 W/m2/sr", "W/m2/sr", 3.0),
        ("0.1 mW/cm2/sr", "W/m2/sr", 1.0),
        ("2 W m-2 sr-1", "W/m2/sr", 2.0),
        ("15 °C", "K", 288.15),
        ("59 degF", "K", 288.15),
        ("3500 nm", "um", 3.5),
        ("4 µm", "um", 4.0),
        ("0.1/km", "1/km", 0.1),
        ("1e-4 / m", "1/km", 0.1),
        ("40 ms", "s", 0.04),
    ],
)
def test_text_with_units(text, unit, value):
    assert convert(text, unit) == pytest.approx(value, rel=ROUNDING)


@pytest.mark.parametrize(
    ("written", "unit"), [*((written, unit) for unit in FACTORS for written in FACTORS[unit]), *((c, "K") for c in CELSIUS)]
)
def test_common_units_are_converted_as_pint_does_to_the_last_bit(written: str, unit: str) -> None:
    values = [*(0.1 * number for number in range(-400, 400, 7)), 1e-7, 12345.678]
    assert [convert(f"{value!r} {written}", unit) for value in values] == [by_pint(value, written, unit) for value in values]


@given(st.floats(2.0, 5000, allow_nan=False))
def test_number_and_text_in_the_keys_unit_agree(height):
    by_number = parse_scenario({"sensor": {"height_m": height}})
    by_text = parse_scenario({"sensor": {"height_m": f"{height!r} m"}})
    assert by_text.sensor.height_m == pytest.approx(by_number.sensor.height_m, rel=ROUNDING)


def test_units_inside_pairs():
    assert parse_scenario({"sensor": {"fov_deg": ["16 deg", "8 deg"]}}).sensor.fov_deg == pytest.approx((16.0, 8.0), rel=ROUNDING)


def test_a_table_of_several_kinds_may_leave_its_kind_out():
    scenario = parse_scenario({"atmosphere": {"model": "us-standard-1976"}, "sea": {"slopes": {"extrapolate": True}}})
    assert scenario.atmosphere.source == "table"
    assert scenario.sea.slopes.kind == "cox-munk-anisotropic"


def test_times_are_utc():
    place = {"latitude_deg": 0, "longitude_deg": 0}
    plain, zoned = (
        parse_scenario({"time": {"utc": text}, "place": place}) for text in ("2026-06-21T10:00:00", "2026-06-21T12:00:00+02:00")
    )
    assert plain == zoned


def test_relative_paths_count_from_the_scenario_file(tmp_path: Path, monkeypatch):
    folder = tmp_path / "scenes"
    folder.mkdir()
    (folder / "response.csv").write_text("wavelength_um,response\n3,0\n4,1\n5,0\n")
    (folder / "my.toml").write_text('[band]\nresponse = "response.csv"\n')
    monkeypatch.chdir(tmp_path)
    assert load_scenario("scenes/my.toml").band.response == Path("scenes/response.csv")


@pytest.mark.parametrize(
    ("fov", "pixels", "shape", "fits"),
    [
        ([16.0, 8.0], [512, 256], "square", True),
        ([16.0, 8.0 * (1 + 0.9 * SQUARE_PIXEL_TOLERANCE)], [512, 256], "square", True),
        ([16.0, 8.2], [512, 256], "square", False),
        ([16.0, 8.2], [512, 256], "auto", True),
        ([2.0, 60.0], [8, 120], "auto", True),
        ([360.0, 20.0], [1440, 160], "auto", True),
        ([8.0, 16.0], [512, 256], "auto", False),
        ([16.0, 8.0], [256, 512], "auto", False),
        ([16.0, 8.0], [512, 8], "auto", False),
        ([16.0, 8.0], [512, 8], "any", True),
        ([16.0, 8.0], [512, 90], "auto", True),
        ([16.0, 8.0], [512, 80], "auto", False),
    ],
)
def test_fields_of_view_that_disagree_with_the_pixels_are_refused(fov, pixels, shape, fits):
    values = {"sensor": {"fov_deg": fov, "pixels": pixels, "pixel_shape": shape, "elevation_deg": -30.0}}
    if fits:
        parse_scenario(values)
    else:
        with pytest.raises(ScenarioError, match=r"sensor\.pixels = \[\d+, \d+\] disagrees with sensor\.fov_deg"):
            parse_scenario(values)


@pytest.mark.parametrize(("fov", "pixels", "advice"), [([8.0, 16.0], [512, 256], [512, 1024]), ([90.0, 30.0], [64, 640], [64, 21])])
def test_the_pixels_advised_are_accepted(fov, pixels, advice):
    sensor = {"fov_deg": fov, "pixels": pixels, "elevation_deg": -30.0}
    with pytest.raises(ScenarioError) as caught:
        parse_scenario({"sensor": sensor})
    assert f"use pixels = {advice}," in str(caught.value)
    parse_scenario({"sensor": sensor | {"pixels": advice}})


@pytest.mark.parametrize(("height", "band"), [(2.0, (2.0, 5.5)), (10_000.0, (7.5, 14.0)), (30.0, (8.0, 12.0))])
def test_the_whole_air_table_is_allowed(height, band):
    parse_scenario({"sensor": {"height_m": height}, "band": {"min_um": band[0], "max_um": band[1]}})


def test_without_the_air_table_height_and_band_are_free():
    values = {"sensor": {"height_m": 0.5}, "band": {"min_um": 3.0, "max_um": 12.0}, "atmosphere": {"source": "none"}}
    assert parse_scenario(values).sensor.height_m == 0.5


@pytest.mark.parametrize("zenith", [0.0, 90.0, 95.0, 180.0])
def test_the_sun_may_be_anywhere(zenith):
    parse_scenario({"sun": {"zenith_deg": zenith}})


def test_wind_above_the_fit_when_asked_for():
    values = {"wind": {"speed_m_s": 25}, "sea": {"slopes": {"extrapolate": True}}, "atmosphere": {"source": "none"}}
    assert parse_scenario(values).wind.speed_m_s == 25.0
