"""Spectra of a radiometer in their units, and what is refused."""

import numpy as np
import pytest

from seaglint.base.errors import DataError
from seaglint.formats.tables.spectra import read_spectrum, spectrum_of_columns
from seaglint.optics.blackbody import planck_wavenumber

NU = np.array([900.0, 1000.0, 1100.0])
LIGHT = planck_wavenumber(NU, 290.0)

COLUMNS = {
    "radiance_w_m2_sr_cm": LIGHT,
    "radiance_mw_m2_sr_cm": 1e3 * LIGHT,
    "radiance_w_cm2_sr_cm": 1e-4 * LIGHT,
    "radiance_w_m2_sr_um": LIGHT * NU**2 / 1e4,
    "radiance_mw_m2_sr_um": LIGHT * NU**2 / 10.0,
    "radiance_w_cm2_sr_um": LIGHT * NU**2 / 1e8,
    "brightness_temperature_k": np.full(3, 290.0),
}


@pytest.mark.parametrize("unit", COLUMNS)
@pytest.mark.parametrize("place", ["wavenumber_cm", "wavelength_um"])
def test_every_unit_gives_the_same_light(tmp_path, unit: str, place: str) -> None:
    where = NU if place == "wavenumber_cm" else 1e4 / NU
    rows = "\n".join(f"{float(x)!r},{float(y)!r}" for x, y in zip(where, COLUMNS[unit], strict=True))
    (tmp_path / "sky.csv").write_text(f"{place},{unit}\n{rows}\n")
    for light in (read_spectrum(tmp_path / "sky.csv"), spectrum_of_columns({place: where, unit: COLUMNS[unit]})):
        np.testing.assert_allclose(light.wavenumber_cm, NU, rtol=1e-12)
        np.testing.assert_allclose(light.radiance, LIGHT, rtol=1e-12)
        assert light.unit == unit


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("# resolution_cm: 4\nwavenumber_cm,brightness_temperature_k\n900,280\n905,281\n910,282\n", 4.0),
        ("wavenumber_cm,brightness_temperature_k,resolution_cm\n900,280,6\n905,281,8\n910,282,6\n", 8.0),
        ("wavenumber_cm,brightness_temperature_k\n910,280\n905,281\n900,282\n", None),
    ],
    ids=["comment", "column", "none"],
)
def test_the_resolution_is_that_of_the_file(tmp_path, text: str, expected: float | None) -> None:
    (tmp_path / "sky.csv").write_text(text)
    assert read_spectrum(tmp_path / "sky.csv").resolution_cm == expected


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("wavenumber_cm,radiance\n900,1\n905,1\n910,1\n", "'radiance' names no unit that is known; name the column one of"),
        ("wavenumber_cm,counts\n900,1\n905,1\n910,1\n", "none is a radiance with its unit"),
        ("wavenumber_cm,radiance_w_m2_sr_cm\n900,1\n905,-1\n910,1\n", r"line 3: radiance_w_m2_sr_cm = -1 is outside"),
        ("wavenumber_cm,radiance_w_m2_sr_cm\n900,1\n905,nan\n910,1\n", r"line 3: radiance_w_m2_sr_cm = nan is outside"),
        ("wavenumber_cm,radiance_w_m2_sr_cm\n900,1\n905,\n910,1\n", r"line 3: radiance_w_m2_sr_cm = '' is not a number"),
        ("wavenumber_cm,radiance_w_m2_sr_cm\n900,1\n900,1\n910,1\n", "wavenumber_cm = 900 stands twice"),
        ("wavenumber_cm,radiance_w_m2_sr_cm\n900,1\n905,1\n", "has 2 samples; a spectrum needs at least 3"),
        ("nu,radiance_w_m2_sr_cm\n900,1\n905,1\n910,1\n", "none of wavenumber_cm, wavelength_um"),
        ("wavenumber_cm,radiance_w_m2_sr_cm,brightness_temperature_k\n900,1,280\n905,1,280\n910,1,280\n", "are both there"),
        ("# resolution: 0\nwavenumber_cm,radiance_w_m2_sr_cm\n900,1\n905,1\n910,1\n", "states no resolution above 0"),
    ],
)
def test_what_is_no_spectrum_is_refused_in_a_line(tmp_path, text: str, match: str) -> None:
    (tmp_path / "sky.csv").write_text(text)
    with pytest.raises(DataError, match=match) as refused:
        read_spectrum(tmp_path / "sky.csv")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("columns", "match"),
    [
        ({"wavelength_um": [8.0, 9.0, 10.0], "radiance_w_m2_sr_um": [1.0, -2.0, 1.0]}, "holds -2 at place 1"),
        ({"wavelength_um": [8.0, 9.0, 10.0], "radiance_w_m2_sr_um": [1.0, np.nan, 1.0]}, "holds nan at place 1"),
        ({"wavelength_um": [8.0, 9.0, 10.0], "radiance_w_m2_sr_um": [1.0, 2.0]}, "two lists of one length"),
        ({"radiance_w_m2_sr_um": [1.0, 2.0, 3.0]}, "give one of wavenumber_cm and wavelength_um"),
    ],
)
def test_columns_that_are_no_spectrum_are_refused(columns, match: str) -> None:
    with pytest.raises(DataError, match=match):
        spectrum_of_columns(columns)
