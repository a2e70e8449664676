"""NetCDF of buoys: CDIP's and MHKiT's give the sea that was written, and attributes that change its meaning are honoured or refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import wave_files
import xarray as xr
from wave_files import FREQUENCY, FROM, LATITUDE, LONGITUDE, TIMES

from seaglint.base.errors import DataError, DomainError
from seaglint.formats.waves import WaveChoice, read_waves
from seaglint.sea.spectra.measured import MeasuredSpectrum

THEN = WaveChoice(str(TIMES[1]), LATITUDE, LONGITUDE)

Change = Callable[[xr.Dataset], xr.Dataset | None]


def direction_and_width(sea: MeasuredSpectrum) -> tuple[float, float]:
    """Mean direction waves come from and its circular width, by the energies [deg]."""
    mean = np.average(sea.first, weights=sea.energy * np.gradient(sea.frequency_hz))
    return float(np.degrees(np.angle(-mean)) % 360.0), float(np.degrees(np.sqrt(2.0 * (1.0 - abs(mean)))))


def require_the_sea(sea: MeasuredSpectrum, come_from: float = FROM) -> None:
    assert sea.significant_height() == pytest.approx(2.0, rel=0.01)
    direction, width = direction_and_width(sea)
    assert direction == pytest.approx(come_from, abs=0.5)
    assert width == pytest.approx(30.0, abs=0.3)
    to = np.exp(1j * np.radians(come_from + 180.0))
    assert np.degrees(np.angle(sea.first / to)) == pytest.approx(0.0, abs=0.5)  # in every band
    assert np.degrees(np.angle(sea.second / to**2)) == pytest.approx(0.0, abs=0.5)


def cdip(folder: Path, change: Change = lambda _: None) -> Path:
    """A CDIP file, changed; fill values are encoded as CDIP's are."""
    data = wave_files.cdip_dataset()
    data = data if (changed := change(data)) is None else changed
    data.to_netcdf(folder / "157p1_rt.nc", engine="h5netcdf")
    return folder / "157p1_rt.nc"


def opened(path: Path, change: Change, how: str = "h5netcdf") -> Path:
    """A file read as it is, changed, and written again."""
    with xr.open_dataset(path) as data:
        data = data.load()
    data = data if (changed := change(data)) is None else changed
    for variable in data.variables.values():
        variable.encoding = {}
    path.unlink()
    data.to_netcdf(path, engine=how)  # type: ignore[call-overload]
    return path


def attribute(name: str, key: str, value: str) -> Change:
    def change(data: xr.Dataset) -> None:
        data[name].attrs[key] = value

    return change


def scaled(names: tuple[str, ...], factor: float, units: str | None = None) -> Change:
    def change(data: xr.Dataset) -> None:
        for name in names:
            data[name][...] = data[name] * factor
            if units is not None:
                data[name].attrs["units"] = units

    return change


def flagged(first: int, second: int) -> Change:
    def change(data: xr.Dataset) -> None:
        data["waveFlagPrimary"][...] = np.array([first, second], "i1")

    return change


def test_a_station_of_cdip_has_its_place_and_name(tmp_path: Path) -> None:
    found = read_waves(cdip(tmp_path), THEN)
    require_the_sea(found.spectrum)
    assert found.report["time"] == "2024-03-01T03:00:00Z"
    assert (found.report["latitude_deg"], found.report["longitude_deg"]) == (LATITUDE, LONGITUDE)
    assert read_waves(cdip(tmp_path), WaveChoice(str(TIMES[1]), site="157p1")).report["time"] == found.report["time"]
    with pytest.raises(DomainError, match=r"'067p1' is not a site of .*allowed: 157p1"):
        read_waves(cdip(tmp_path), WaveChoice(str(TIMES[1]), site="067p1"))


MOMENTS = ("waveA1Value", "waveB1Value", "waveA2Value", "waveB2Value")


def only(*names: str) -> Change:
    return lambda data: data.drop_vars([*names])


def filled_bands(data: xr.Dataset) -> None:
    """The lowest bands have no directions, which xarray writes as CDIP's fill value."""
    for name in (*MOMENTS, "waveMeanDirection", "waveSpread"):
        data[name][:, :4] = np.nan


def travelling(data: xr.Dataset) -> None:
    """All directions are those waves travel to, and the attribute says so."""
    data["waveMeanDirection"].attrs["standard_name"] = "sea_surface_wave_to_direction"


def deployed(data: xr.Dataset) -> None:
    data["metaDeployLatitude"], data["metaDeployLongitude"] = LATITUDE + 0.2, LONGITUDE


def adrift(data: xr.Dataset) -> xr.Dataset:
    """The place is that of the buoy's own positions, of times of their own."""
    return data.drop_vars(["metaStationLatitude", "metaStationLongitude"])


@pytest.mark.parametrize(
    ("change", "come_from"),
    [
        (filled_bands, FROM),
        (travelling, FROM - 180.0),
        (deployed, FROM),
        (adrift, FROM),
        (only("waveMeanDirection", "waveSpread", "waveHs", "waveBandwidth", "waveFlagPrimary"), FROM),
        (only(*MOMENTS), FROM),
        (lambda data: some_directions(data), FROM),
        (lambda data: data.transpose(), FROM),
        (lambda data: data.isel(waveFrequency=slice(None, None, -1)), FROM),
        (lambda data: data.isel(waveTime=slice(None, None, -1)), FROM),
        (attribute("waveEnergyDensity", "units", "m2/Hz"), FROM),
    ],
)
def test_layouts_of_cdip(change: Change, come_from: float, tmp_path: Path) -> None:
    require_the_sea(read_waves(cdip(tmp_path, change), THEN).spectrum, come_from)


def test_netcdf_3_without_units_and_fill_attributes(tmp_path: Path) -> None:
    """Seconds since 1970 and -999.99 are CDIP's by its documents."""

    def bare(data: xr.Dataset) -> xr.Dataset:
        data = data.drop_vars("metaStationName").assign_coords(waveTime=("waveTime", TIMES.astype("datetime64[s]").astype("i4")))
        for name in MOMENTS:
            data[name][:, :3] = -999.99
        return data

    path = cdip(tmp_path)
    found = read_waves(opened(path, bare, "scipy"), THEN)
    require_the_sea(found.spectrum)
    assert found.report["time"] == "2024-03-01T03:00:00Z"


def test_a_flagged_record_gives_way_to_the_nearest_good_one(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    choice = WaveChoice(str(TIMES[1]), time_tolerance=4.0 * 3600.0)
    found = read_waves(cdip(tmp_path, flagged(1, 4)), choice)
    assert found.spectrum.significant_height() == pytest.approx(1.0, rel=0.01)
    note = "the record of 2024-03-01T03:00:00Z is flagged bad (waveFlagPrimary): 2024-03-01T00:00:00Z is taken"
    assert found.report["note"] == note
    assert note in caplog.text
    with pytest.raises(DataError, match=r"without its 1 flagged record \(waveFlagPrimary\) has no record within 3600 s"):
        read_waves(cdip(tmp_path, flagged(1, 3)), THEN)
    with pytest.raises(DataError, match="holds no good record: all 2 are flagged missing, questionable"):
        read_waves(cdip(tmp_path, flagged(3, 9)), THEN)
    assert read_waves(cdip(tmp_path, flagged(1, 2)), THEN).report["note"] == "the record is flagged not_evaluated (waveFlagPrimary)"


def unknown_directions(data: xr.Dataset) -> None:
    for name in (*MOMENTS, "waveMeanDirection", "waveSpread"):
        data[name][...] = np.nan


@pytest.mark.parametrize("change", [unknown_directions, only(*MOMENTS, "waveMeanDirection", "waveSpread")])
def test_a_record_of_energy_alone_takes_the_directions_stated(change: Change, tmp_path: Path) -> None:
    path = cdip(tmp_path, change)
    require_the_sea(read_waves(path, WaveChoice(str(TIMES[1]), from_deg=310.0, spreading_deg=30.0)).spectrum, 310.0)
    with pytest.raises(DomainError, match="has no directions; give the azimuth the waves come from"):
        read_waves(path, THEN)


def some_directions(data: xr.Dataset) -> xr.Dataset:
    """Mean directions and spreads alone, and not in the lowest bands."""
    filled_bands(data)
    return data.drop_vars([*MOMENTS])


def half_the_directions(data: xr.Dataset) -> xr.Dataset:
    data["waveMeanDirection"][:, :15] = np.nan
    return data.drop_vars([*MOMENTS])


def peak_flagged(data: xr.Dataset) -> None:
    data["waveFrequencyFlagPrimary"][10:14] = 4


def edge_flagged(data: xr.Dataset) -> None:
    """The lowest band has an energy of nothing real."""
    data["waveFrequencyFlagPrimary"][0] = 4


def test_a_flagged_band_is_left_out(tmp_path: Path) -> None:
    sea = read_waves(cdip(tmp_path, edge_flagged), THEN).spectrum
    assert sea.frequency_hz.size == FREQUENCY.size - 1
    require_the_sea(sea)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (attribute("waveEnergyDensity", "units", "cm2/Hz"), r"waveEnergyDensity is in 'cm2/Hz', and m2/Hz is read; convert it"),
        (attribute("waveFrequency", "units", "rad/s"), r"waveFrequency is in 'rad/s', and Hz is read"),
        (attribute("waveMeanDirection", "units", "radian"), r"in 'radian', and degrees clockwise from true north are read"),
        (
            attribute("waveMeanDirection", "long_name", "direction from magnetic north"),
            r"relative to magnetic north, and true north is read",
        ),
        (scaled(("waveMeanDirection",), 0.5), r"atan2\(waveB1Value, waveA1Value\) and waveMeanDirection differ by 115 deg"),
        (scaled(("waveB1Value",), -1.0), r"differ by 100 deg \(5 allowed\); correct the one that is wrong"),
        (scaled(("waveSpread",), 1.5), r"waveA1Value, waveB1Value and waveSpread differ by 15 deg"),
        (scaled(MOMENTS, 100.0), r"moments reach 86\.\d, and 1 is the most; divide them by the energy density"),
        (scaled(("waveEnergyDensity",), 1e4), r"gives a height of 19\d\.\d\d m and waveHs is 2\.00 m"),
        (scaled(("waveBandwidth",), 4.0), r"waveBandwidth gives a height of .* and waveFrequency"),
        (half_the_directions, r"lacks directions for \d\d % of its energy \(10 % allowed\)"),
        (peak_flagged, r"bands with \d\d % of the energy are flagged"),
    ],
)
def test_what_changes_the_meaning_of_cdip_is_refused_in_one_line(change: Change, match: str, tmp_path: Path) -> None:
    with pytest.raises(DataError, match=match) as caught:
        read_waves(cdip(tmp_path, change), THEN)
    assert "\n" not in str(caught.value)


def nines(data: xr.Dataset) -> None:
    """MHKiT keeps 999 of NDBC's text, divided by 100 where it divides."""
    for name, value in (("swdir", 999.0), ("swdir2", 999.0), ("swr1", 9.99), ("swr2", 9.99)):
        data[name][:, :3] = value


def unknown(data: xr.Dataset) -> None:
    for name in ("swdir", "swdir2", "swr1", "swr2"):
        data[name][:, :3] = np.nan


LENGTHS = ("swr1", "swr2")


@pytest.mark.parametrize(
    ("keep", "change", "come_from"),
    [
        (("units",), lambda _: None, FROM),
        ((), lambda _: None, FROM),
        (("units", "description"), nines, FROM),
        ((), unknown, FROM),
        ((), scaled(LENGTHS, 100.0), FROM),
        ((), scaled(LENGTHS, 100.0, "%"), FROM),
        ((), scaled(LENGTHS, 1.0, "1"), FROM),
        ((), lambda data: data.transpose(), FROM),
        ((), lambda data: data.isel(date=1), FROM),
        ((), attribute("swdir", "standard_name", "sea_surface_wave_to_direction"), FROM - 180.0),
        ((), attribute("swdir", "units", "degrees_true"), FROM),
    ],
)
@pytest.mark.parametrize("engine", ["h5netcdf", "scipy"])
def test_layouts_of_mhkit(keep: tuple[str, ...], change: Change, come_from: float, engine: str, tmp_path: Path) -> None:
    found = read_waves(opened(wave_files.mhkit(tmp_path, keep), change, engine), THEN)
    assert found.report["format"] == "mhkit"
    require_the_sea(found.spectrum, come_from)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (scaled(LENGTHS, 100.0), r"r1 or r2 above 1; .* divide by 100"),  # its description says nondimensional
        (scaled(LENGTHS, 100.0, "1"), r"r1 or r2 above 1"),
        (scaled(LENGTHS, 1.0, "%"), r"at most 0\.86\d*, and the file says hundredths; correct their unit to 1"),
        (scaled(LENGTHS, 1.0, "m"), r"swr1 and swr2 are in 'm'; 1 or % for both is read"),
        (attribute("swden", "units", "m^2/Hz/deg"), r"swden is in 'm\^2/Hz/deg', and m2/Hz is read"),
        (attribute("swdir", "units", "degrees magnetic"), r"swdir is relative to magnetic north"),
        (lambda data: data.assign_coords(date=[0, 10800]), r"its times \('date'\) have no units"),
    ],
)
def test_what_changes_the_meaning_of_mhkit_is_refused_in_one_line(change: Change, match: str, tmp_path: Path) -> None:
    with pytest.raises(DataError, match=match) as caught:
        read_waves(opened(wave_files.mhkit(tmp_path), change), THEN)
    assert "\n" not in str(caught.value)


def same_time(data: xr.Dataset) -> xr.Dataset:
    time = "waveTime" if "waveTime" in data.dims else "date"
    return data.assign_coords({time: (time, data[time].values[[1, 1]], data[time].attrs)})


def twice(data: xr.Dataset) -> xr.Dataset:
    time = "waveTime" if "waveTime" in data.dims else "date"
    return data.isel({time: [1, 1]})


@pytest.mark.parametrize("write", [wave_files.cdip, wave_files.mhkit])
def test_two_records_of_one_time(write: Callable[[Path], Path], tmp_path: Path) -> None:
    require_the_sea(read_waves(opened(write(tmp_path), twice), THEN).spectrum)
    with pytest.raises(DataError, match=r"2 records of 2024-03-01T03:00:00Z that differ \(numbers 1, 2\); remove all but one"):
        read_waves(opened(write(tmp_path), same_time), THEN)


@pytest.mark.parametrize(
    ("change", "come_from"),
    [
        (attribute("spectral_wave_density", "units", "(meter * meter)/Hz"), FROM),
        (attribute("mean_wave_dir", "units", "degrees_true"), FROM),
        (attribute("mean_wave_dir", "standard_name", "sea_surface_wave_to_direction"), FROM - 180.0),
    ],
)
def test_attributes_of_ndbc(change: Change, come_from: float, tmp_path: Path) -> None:
    require_the_sea(read_waves(opened(wave_files.ndbc_netcdf(tmp_path), change), THEN).spectrum, come_from)


@pytest.mark.parametrize("write", [wave_files.cdip, wave_files.mhkit])
def test_ndbcs_data_under_other_names_are_read_as_ndbc_too(write: Callable[[Path], Path], tmp_path: Path) -> None:
    require_the_sea(read_waves(write(tmp_path), THEN, format="ndbc").spectrum)
