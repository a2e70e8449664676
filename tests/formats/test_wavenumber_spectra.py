"""Files of wavenumber spectra: every quantity and unit gives the same sea, and mistakes are refused in one line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from seaglint.base.errors import DataError
from seaglint.formats.waves.wavenumber_spectra import read_wavenumber_spectra

K = np.geomspace(5.0, 800.0, 12)
B = 0.008 * (K / 5.0) ** -0.3


def written(path: Path, columns: dict[str, object], comment: str = "# a sea\n") -> Path:
    """Write columns as CSV."""
    rows = zip(*(np.asarray(values).tolist() for values in columns.values()), strict=True)
    path.write_text(comment + ",".join(columns) + "\n" + "".join(",".join(f"{v!r}" for v in row) + "\n" for row in rows), encoding="utf-8")
    return path


def columns_of(quantity: str, cycles: bool) -> dict[str, object]:
    """Columns of the sea ``B(K)`` as one of the quantities; densities are per unit of the wavenumber."""
    density = {"saturation": B, "elevation_m3": B / K**3, "slope_m": B / K}[quantity]
    if cycles and quantity != "saturation":
        density = density * 2.0 * np.pi
    return {"wavenumber_cycles_m" if cycles else "wavenumber_rad_m": K / (2.0 * np.pi) if cycles else K, quantity: density}


@pytest.mark.parametrize("cycles", [False, True])
@pytest.mark.parametrize("quantity", ["saturation", "elevation_m3", "slope_m"])
@pytest.mark.parametrize("netcdf", [False, True])
def test_every_quantity_is_the_same_sea(tmp_path: Path, quantity: str, cycles: bool, netcdf: bool) -> None:
    """Saturation, height and slope spectra, per rad/m and per cycle/m, in CSV and NetCDF, are one table."""
    columns = columns_of(quantity, cycles)
    if netcdf:
        path = tmp_path / "sea.nc"
        xr.Dataset({name: ("wavenumber", values) for name, values in columns.items()}).to_netcdf(path)
    else:
        path = written(tmp_path / "sea.csv", columns)
    (row,) = read_wavenumber_spectra(path).rows
    np.testing.assert_allclose(row.wavenumber, K, rtol=1e-12)
    np.testing.assert_allclose(row.saturation, B, rtol=1e-12)
    assert row.wind is None


@pytest.mark.parametrize("quantity", ["elevation_m3", "slope_m"])
def test_variance_per_cycle_is_conserved(tmp_path: Path, quantity: str) -> None:
    """The integral of a density over cycles/m as written equals that of the spectrum read, of height and of slope."""
    k = np.linspace(0.8, 120.0, 4000)
    density = np.exp(-k / 20.0)
    (row,) = read_wavenumber_spectra(written(tmp_path / "sea.csv", {"wavenumber_cycles_m": k, quantity: density})).rows
    power = 3 if quantity == "elevation_m3" else 1
    # trapezoids on the same nodes: the two sums are equal to rounding
    assert np.trapezoid(row.saturation / row.wavenumber**power, row.wavenumber) == pytest.approx(np.trapezoid(density, k), rel=1e-12)


def test_rows_have_any_order_and_winds_are_sorted(tmp_path: Path) -> None:
    """Rows are sorted by wind and wavenumber, with their directions."""
    wind, k = (values.ravel() for values in np.meshgrid([8.0, 4.0], K, indexing="ij"))
    rng = np.random.default_rng(3)
    order = rng.permutation(k.size)
    columns = {"delta": wind / 20.0, "saturation": np.tile(B, 2) * wind, "wind_speed_m_s": wind, "wavenumber_rad_m": k}
    table = read_wavenumber_spectra(written(tmp_path / "sea.csv", {name: values[order] for name, values in columns.items()}))
    assert table.winds.tolist() == [4.0, 8.0]
    for row in table.rows:
        np.testing.assert_allclose(row.wavenumber, K)
        np.testing.assert_allclose(row.saturation, B * row.wind)
        np.testing.assert_allclose(row.delta, row.wind / 20.0)


def test_netcdf_over_wind_and_wavenumber(tmp_path: Path) -> None:
    """Variables over two dimensions, coordinates of either, are the same as a flat list."""
    path = tmp_path / "sea.nc"
    xr.Dataset(
        {"saturation": (("wind", "wavenumber"), np.outer([1.0, 2.0, 3.0], B)), "half_width_deg": ("wind", [30.0, 40.0, 50.0])},
        {"wind_speed_m_s": ("wind", [3.0, 6.0, 9.0]), "wavenumber_rad_m": ("wavenumber", K)},
    ).to_netcdf(path)
    table = read_wavenumber_spectra(path)
    assert table.winds.tolist() == [3.0, 6.0, 9.0]
    np.testing.assert_allclose(table.rows[2].saturation, 3.0 * B)
    assert table.rows[1].half_width is not None
    np.testing.assert_allclose(np.degrees(table.rows[1].half_width), 40.0)


K3 = [5.0, 50.0, 500.0]
B3 = [0.01, 0.01, 0.01]


@pytest.mark.parametrize(
    ("columns", "text"),
    [
        ({"wavenumber": K3, "saturation": B3}, "'wavenumber' has no unit .* wavenumber_rad_m .* or wavenumber_cycles_m"),
        ({"k": K3, "saturation": B3}, "'k' has no unit"),
        ({"Wavenumber_rad_m": K3, "saturation": B3}, "'Wavenumber_rad_m' is unknown; did you mean wavenumber_rad_m"),
        ({"frequency_hz": K3, "saturation": B3}, "no column of the wavenumber"),
        ({"wavenumber_rad_m": K3, "wavenumber_cycles_m": K3, "saturation": B3}, "give one of them"),
        ({"wavenumber_rad_m": K3, "saturation": B3, "slope_m": B3}, "saturation and slope_m; give one of them"),
        ({"wavenumber_rad_m": K3, "energy": B3}, "the columns of the spectrum, it has none"),
        ({"wavenumber_rad_m": [5.0, 5.0, 500.0], "saturation": B3}, "wavenumber_rad_m = 5 is there twice.*wind_speed_m_s"),
        ({"wavenumber_rad_m": K3, "saturation": [0.01, -0.01, 0.01]}, "line 4: saturation = -0.01 is outside .* 0 or more"),
        ({"wavenumber_rad_m": K3, "saturation": [0.01, float("nan"), 0.01]}, "line 4: saturation = nan"),
        ({"wavenumber_rad_m": [0.0, 5.0, 50.0], "saturation": B3}, "is no wave"),
        ({"wavenumber_rad_m": K3[:2], "saturation": B3[:2]}, "has 2 wavenumbers; give 3 or more"),
        ({"wavenumber_rad_m": K3, "saturation": [0.0, 0.0, 0.0]}, "0 everywhere"),
        ({"wavenumber_rad_m": K3, "saturation": B3, "delta": [0.1, 1.5, 0.1]}, "delta = 1.5 is outside"),
        ({"wavenumber_rad_m": K3, "saturation": B3, "delta": B3, "half_width_deg": [40.0] * 3}, "leave one out"),
        ({"wavenumber_rad_m": K3, "saturation": B3, "half_width_deg": [40.0, 179.0, 40.0]}, "half_width_deg = 179.0 is outside"),
        ({"wavenumber_rad_m": K3, "saturation": B3, "wind_speed_10m_m_s": [5.0] * 3}, "did you mean wind_speed_m_s"),
    ],
)
def test_mistakes_of_files_are_refused_in_one_line(tmp_path: Path, columns: dict[str, object], text: str) -> None:
    """Each error names the file and says what to do."""
    with pytest.raises(DataError, match=text) as error:
        read_wavenumber_spectra(written(tmp_path / "sea.csv", columns))
    assert "\n" not in str(error.value)
    assert "sea.csv" in str(error.value)


def test_empty_cells_are_refused(tmp_path: Path) -> None:
    """A cell without a value is no 0."""
    path = tmp_path / "sea.csv"
    path.write_text("wavenumber_rad_m,saturation\n5,0.01\n50,\n500,0.01\n")
    with pytest.raises(DataError, match="line 3: saturation = '' is not a number"):
        read_wavenumber_spectra(path)


def test_missing_values_of_netcdf_are_refused(tmp_path: Path) -> None:
    """NaN is no 0."""
    path = tmp_path / "sea.nc"
    xr.Dataset({"saturation": ("k", [0.01, np.nan, 0.01])}, {"wavenumber_rad_m": ("k", K3)}).to_netcdf(path)
    with pytest.raises(DataError, match=r"saturation is missing \(NaN\) at 1 of 3 places"):
        read_wavenumber_spectra(path)


def grid(
    path: Path, units: dict[str, str], *, quantity: str = "saturation", wavenumber: str = "wavenumber_rad_m", factor: float = 1.0
) -> Path:
    """Write a file over wind and wavenumber whose variables state units; values of ``quantity`` are multiplied by ``factor``."""
    values = columns_of(quantity, wavenumber == "wavenumber_cycles_m")
    data = xr.Dataset(
        {quantity: (("wind", "k"), factor * np.outer([1.0, 2.0], values[quantity]))},
        {"wind_speed_m_s": ("wind", [5.0, 10.0]), wavenumber: ("k", values[wavenumber])},
    )
    for name, unit in units.items():
        data[name].attrs["units"] = unit
    data.to_netcdf(path)
    return path


@pytest.mark.parametrize("unit", ["rad/m", "rad m-1", "rad m**-1", "radian/m", "radians per metre", "1/m", "m^-1", ""])
@pytest.mark.parametrize("quantity", ["saturation", "elevation_m3", "slope_m"])
def test_units_that_agree_with_the_name_are_the_same_sea(tmp_path: Path, unit: str, quantity: str) -> None:
    """Spellings of rad/m, and of the densities per rad/m."""
    plain = {"saturation": "1", "elevation_m3": "m3", "slope_m": "m"}[quantity]
    per = {"saturation": "dimensionless", "elevation_m3": "m^2/(rad/m)", "slope_m": "m rad-1"}[quantity]
    for density in (plain, per):
        table = read_wavenumber_spectra(grid(tmp_path / "a.nc", {"wavenumber_rad_m": unit, quantity: density}, quantity=quantity))
        np.testing.assert_allclose(table.rows[1].saturation, 2.0 * B, rtol=1e-12)
        np.testing.assert_allclose(table.rows[1].wavenumber, K, rtol=1e-12)


@pytest.mark.parametrize("unit", ["cpm", "cycles/m", "cycle m-1", "cycles per meter", "1/m"])
def test_units_of_cycles_agree_with_their_name(tmp_path: Path, unit: str) -> None:
    """Cycles a metre, with densities per cycle/m."""
    units = {"wavenumber_cycles_m": unit, "elevation_m3": "m2/cpm"}
    table = read_wavenumber_spectra(grid(tmp_path / "a.nc", units, quantity="elevation_m3", wavenumber="wavenumber_cycles_m"))
    np.testing.assert_allclose(table.rows[0].wavenumber, K, rtol=1e-12)
    np.testing.assert_allclose(table.rows[0].saturation, B, rtol=1e-12)


@pytest.mark.parametrize(("unit", "metre_a_second"), [("m/s", 1.0), ("m s-1", 1.0), ("knots", 1852.0 / 3600.0), ("km/h", 1.0 / 3.6)])
def test_winds_are_converted(tmp_path: Path, unit: str, metre_a_second: float) -> None:
    """Winds of 5 and 10 of a unit."""
    winds = read_wavenumber_spectra(grid(tmp_path / "a.nc", {"wind_speed_m_s": unit})).winds
    np.testing.assert_allclose(winds, [5.0 * metre_a_second, 10.0 * metre_a_second], rtol=1e-12)


@pytest.mark.parametrize("unit", ["%", "percent"])
def test_saturation_in_percent_is_converted(tmp_path: Path, unit: str) -> None:
    """A hundred times the number in per cent is the same sea."""
    (row, _) = read_wavenumber_spectra(grid(tmp_path / "a.nc", {"saturation": unit}, factor=100.0)).rows
    np.testing.assert_allclose(row.saturation, B, rtol=1e-12)


@pytest.mark.parametrize(
    ("units", "quantity", "wavenumber", "text"),
    [
        ({"wavenumber_rad_m": "cpm"}, "saturation", "wavenumber_rad_m", "in 'cpm', and rad/m is read; name it wavenumber_cycles_m"),
        ({"wavenumber_rad_m": "cycles m-1"}, "slope_m", "wavenumber_rad_m", "name it wavenumber_cycles_m"),
        ({"wavenumber_cycles_m": "rad/m"}, "slope_m", "wavenumber_cycles_m", "in 'rad/m', and cycle/m is read; name it wavenumber_rad_m"),
        ({"wavenumber_rad_m": "rad/cm"}, "saturation", "wavenumber_rad_m", "in 'rad/cm', and rad/m is read; convert it"),
        ({"wind_speed_m_s": "mph"}, "saturation", "wavenumber_rad_m", "in 'mph', and m/s, knots or km/h is read"),
        ({"saturation": "dB"}, "saturation", "wavenumber_rad_m", "in 'dB', and 1 or % is read"),
        ({"slope_m": "mm"}, "slope_m", "wavenumber_rad_m", "in 'mm', and m is read"),
        ({"elevation_m3": "mm3"}, "elevation_m3", "wavenumber_rad_m", "in 'mm3', and m3 is read"),
        ({"elevation_m3": "m2/cpm"}, "elevation_m3", "wavenumber_rad_m", "the wavenumber is wavenumber_rad_m, another unit"),
        ({"slope_m": "m/rad"}, "slope_m", "wavenumber_cycles_m", "the wavenumber is wavenumber_cycles_m, another unit"),
    ],
)
def test_units_that_are_not_read_are_refused_in_one_line(
    tmp_path: Path, units: dict[str, str], quantity: str, wavenumber: str, text: str
) -> None:
    """Contradictions and other units name the variable, what is read and what to do."""
    path = grid(tmp_path / "a.nc", units, quantity=quantity, wavenumber=wavenumber)
    with pytest.raises(DataError, match=text) as error:
        read_wavenumber_spectra(path)
    assert "\n" not in str(error.value)
    assert "convert" in str(error.value)


def test_a_further_dimension_is_named(tmp_path: Path) -> None:
    """Spectra over directions are no omnidirectional ones; a dimension of one value is nothing."""
    path = tmp_path / "sea.nc"
    values = xr.DataArray(np.outer(np.ones(4), B), dims=("direction", "k"))
    xr.Dataset({"saturation": values}, {"wavenumber_rad_m": ("k", K)}).to_netcdf(path)
    with pytest.raises(
        DataError, match=r"saturation has the dimension 'direction' of 4 values .* sum or average .* wind_speed_m_s along it"
    ):
        read_wavenumber_spectra(path)
    one = tmp_path / "one.nc"
    xr.Dataset({"saturation": values[:1]}, {"wavenumber_rad_m": ("k", K)}).to_netcdf(one)
    np.testing.assert_allclose(read_wavenumber_spectra(one).rows[0].saturation, B)


def test_missing_ends_of_a_grid_have_a_remedy(tmp_path: Path) -> None:
    """Winds with other wavenumbers are rows of CSV."""
    path = tmp_path / "sea.nc"
    values = np.outer([1.0, 2.0], B)
    values[0, -1] = np.nan
    data = {"saturation": (("wind", "k"), values)}
    xr.Dataset(data, {"wind_speed_m_s": ("wind", [5.0, 10.0]), "wavenumber_rad_m": ("k", K)}).to_netcdf(path)
    with pytest.raises(DataError, match="or give CSV with one row for each measured wavenumber of each wind_speed_m_s"):
        read_wavenumber_spectra(path)
    wind, k = np.repeat([5.0, 10.0], K.size), np.tile(K, 2)
    kept = np.isfinite(values.ravel())
    columns = {"wind_speed_m_s": wind[kept], "wavenumber_rad_m": k[kept], "saturation": values.ravel()[kept]}
    assert [row.wavenumber.size for row in read_wavenumber_spectra(written(tmp_path / "sea.csv", columns)).rows] == [K.size - 1, K.size]
