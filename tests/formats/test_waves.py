"""Wave files: every format gives the sea that was written into it, its directions the right way round, and says what is wrong."""

from __future__ import annotations

import gzip
import shutil
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
import wave_files
import xarray as xr
from wave_files import FROM, LATITUDE, LONGITUDE, TIMES

from seaglint.base.errors import DataError, DomainError
from seaglint.formats.waves import FORMATS, WaveChoice, read_waves
from seaglint.formats.waves.wave_records import distance_km
from seaglint.scenario.records.sea_tables import SpectrumFile
from seaglint.sea.dispersion import angular_frequency
from seaglint.sea.spectra.measured import MeasuredSpectrum

wavespectra = pytest.importorskip("wavespectra", reason="wavespectra, which reads wave files, is not installed")

THEN = WaveChoice(str(TIMES[1]), LATITUDE, LONGITUDE)


def mean_direction(sea: MeasuredSpectrum) -> float:
    """Where waves of the measured part come from on the average, off the distribution itself [deg]."""
    low, high = sea.wavenumber_range[0], sea.tail_wavenumber
    k = np.exp(np.linspace(np.log(low), np.log(high), 400, endpoint=False))[:, None]
    azimuth = (np.arange(720) + 0.5) * np.pi / 360
    moment = np.sum(k * sea.omnidirectional(k) * sea.spreading(k, azimuth) * np.exp(1j * azimuth))
    return float(np.degrees(np.angle(-moment)) % 360.0)


def ndbc_ascii(path: Path) -> xr.Dataset:
    return wavespectra.read_ndbc_ascii([str(path.with_suffix(s)) for s in (".data_spec", ".swdir", ".swdir2", ".swr1", ".swr2")])


# How each file is written, the format it is, and wavespectra's dataset of the sea at the second time (for historical NDBC files and
# Spotters wavespectra has no right answer: it takes hundredths for ones, and the wave heights' times for the spectra's; it turns WWM's
# directions and stretches an AWAC's frequencies).
FILES = {
    "ndbc": (wave_files.ndbc, "ndbc", ndbc_ascii),
    "ndbc historical": (wave_files.ndbc_historical, "ndbc", None),
    "ndbc netcdf": (wave_files.ndbc_netcdf, "ndbc", lambda p: wavespectra.read_ndbc(str(p))),
    "cdip": (wave_files.cdip, "cdip", None),
    "mhkit": (wave_files.mhkit, "mhkit", None),
    "spotter json": (wave_files.spotter_json, "spotter", None),
    "spotter csv": (wave_files.spotter_csv, "spotter", lambda p: wavespectra.read_spotter(str(p))),
    "swan": (wave_files.swan, "swan", lambda p: wavespectra.read_swan(str(p), as_site=True).isel(site=1)),
    "swan netcdf": (wave_files.swan_netcdf, "swan", lambda p: wavespectra.read_ncswan(str(p)).isel(site=1)),
    "ww3": (wave_files.ww3, "ww3", lambda p: wavespectra.read_ww3_station(str(p))),
    "ww3 netcdf": (wave_files.ww3_netcdf, "ww3", lambda p: wavespectra.read_ww3(str(p)).isel(site=1)),
    "era5": (wave_files.era5, "era5", lambda p: wavespectra.read_era5(str(p)).isel(lat=0, lon=1)),
    "triaxys": (wave_files.triaxys, "triaxys", lambda p: wavespectra.read_triaxys(str(p))),
    "obscape": (wave_files.obscape, "obscape", lambda p: wavespectra.read_obscape(str(p))),
    "awac": (wave_files.awac, "awac", None),
    "awac directions": (wave_files.awac_directions, "awac", None),
    "wwm": (wave_files.wwm, "wwm", None),
    "ww3 zarr": (wave_files.ww3_zarr, "ww3", lambda p: wavespectra.read_ww3(str(p), file_format="zarr").isel(site=1)),
    "packed zarr": (wave_files.packed, "wavespectra", None),
    "octopus": (wave_files.octopus, "octopus", lambda p: wavespectra.read_octopus(str(p))),
    "datawell": (wave_files.datawell, "datawell", lambda p: wavespectra.read_datawell(str(p))),
    "wavespectra": (wave_files.own, "wavespectra", lambda p: wavespectra.read_wavespectra(str(p)).isel(site=1)),
}


@pytest.mark.parametrize("name", FILES)
def test_every_format_gives_its_sea(name: str, tmp_path: Path) -> None:
    write, kind, _ = FILES[name]
    found = read_waves(write(tmp_path), THEN)
    sea = found.spectrum
    assert found.report["format"] == kind
    assert mean_direction(sea) == pytest.approx(FROM, abs=1.0)  # turned round it would be 50
    assert sea.significant_height() == pytest.approx(2.0, rel=0.01)  # tail and all
    assert 2 * np.pi / angular_frequency(sea.peak_wavenumber) == pytest.approx(9.0, rel=0.06)  # the nearest band


@pytest.mark.parametrize("name", [name for name, (_, _, read) in FILES.items() if read is not None])
def test_integrals_are_those_of_wavespectra(name: str, tmp_path: Path) -> None:
    write, _, read = FILES[name]
    path = write(tmp_path)
    sea = read_waves(path, THEN).spectrum
    theirs = read(path)
    if "time" in theirs.dims:
        theirs = theirs.isel(time=-1)
    theirs = theirs.squeeze(drop=True)
    if name == "triaxys":
        theirs = theirs.isel(dir=slice(0, -1))  # 360 degrees is 0 degrees again
    spec = theirs.load().spec
    measured = 4 * np.sqrt(sea.height_variance(sea.tail_wavenumber))
    assert measured == pytest.approx(float(spec.hs(tail=False)), rel=0.01)
    assert mean_direction(sea) == pytest.approx(float(spec.dm()), rel=0.01)
    assert 2 * np.pi / angular_frequency(sea.peak_wavenumber) == pytest.approx(float(spec.tp(smooth=False)), rel=0.01)
    spread = np.degrees(np.sqrt(2 * (1 - np.abs(np.average(sea.first, weights=sea.energy * np.gradient(sea.frequency_hz))))))
    assert spread == pytest.approx(float(spec.dspr()), rel=0.01)


@pytest.mark.parametrize(
    ("write", "keys"),
    [
        (wave_files.swan, {"directions": "CDIR"}),
        (wave_files.swan_netcdf, {"convention": "cartesian"}),
        (wave_files.ww3_netcdf, {"standard_name": "sea_surface_wave_from_direction"}),
        (wave_files.era5, {"new": False}),
    ],
)
def test_other_conventions_of_the_same_format(write, keys, tmp_path: Path) -> None:
    sea = read_waves(write(tmp_path, **keys), THEN).spectrum
    assert mean_direction(sea) == pytest.approx(FROM, abs=1.0)
    assert sea.significant_height() == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize("name", ["ndbc", "cdip", "swan", "ww3 netcdf", "era5", "octopus", "spotter json"])
def test_the_nearest_time_and_place_are_told(name: str, tmp_path: Path) -> None:
    path = FILES[name][0](tmp_path)
    choice = WaveChoice("2024-03-01T00:20Z", LATITUDE + 0.1, LONGITUDE)
    found = read_waves(path, choice)
    assert found.spectrum.significant_height() == pytest.approx(1.0, rel=0.01)  # the first time
    assert found.report["time"] == "2024-03-01T00:00:00Z"
    assert found.report["seconds_from_time_wanted"] == -1200.0
    if name != "ndbc":  # text of a buoy does not say where it is
        assert found.report["km_from_place_wanted"] == pytest.approx(11.1, abs=0.1)
        with pytest.raises(DataError, match=r"no site within 5 km of 36\.7, -122\.4; nearest is .* 11 km away"):
            read_waves(path, WaveChoice(choice.time, LATITUDE + 0.1, LONGITUDE, distance_tolerance_km=5.0))
    with pytest.raises(DataError, match="no record within 600 s of 2024-03-01T00:20:00Z; it covers"):
        read_waves(path, WaveChoice(choice.time, LATITUDE, LONGITUDE, time_tolerance=600.0))


def test_a_spotters_spectra_have_their_own_times(tmp_path: Path) -> None:
    assert read_waves(wave_files.spotter_json(tmp_path), THEN).report["time"] == "2024-03-01T03:00:00Z"


def test_sites_by_name(tmp_path: Path) -> None:
    path = wave_files.ww3_netcdf(tmp_path)
    found = read_waves(path, WaveChoice(str(TIMES[1]), site="46041"))
    assert (found.report["site"], found.report["longitude_deg"]) == ("46041", pytest.approx(LONGITUDE + 1))
    assert found.spectrum.significant_height() == pytest.approx(1.0, rel=0.01)
    with pytest.raises(DomainError, match=r"'46049' is not a site.*allowed: 46041, 46042"):
        read_waves(path, WaveChoice(str(TIMES[1]), site="46049"))
    with pytest.raises(DomainError, match=r"is missing.*2 sites \(46041, 46042\).*or latitude_deg and longitude_deg"):
        read_waves(path, WaveChoice(str(TIMES[1])))


def test_places_in_metres_and_runs_without_time(tmp_path: Path) -> None:
    path = wave_files.swan(tmp_path, locations="LOCATIONS", times=False)
    with pytest.raises(DomainError, match="2 sites"):
        read_waves(path, THEN)
    report = read_waves(path, WaveChoice(site="2")).report
    assert not {"time", "latitude_deg"} & report.keys()


@pytest.mark.parametrize("write", [wave_files.swan, wave_files.ndbc_historical])
def test_packed_text(write, tmp_path: Path) -> None:
    path = write(tmp_path)
    for file in list(tmp_path.iterdir()):
        with gzip.open(f"{file}.gz", "wb") as packed:
            packed.write(file.read_bytes())
        file.unlink()
    assert mean_direction(read_waves(Path(f"{path}.gz"), THEN).spectrum) == pytest.approx(FROM, abs=1.0)


@pytest.mark.parametrize("suffix", [".data_spec", ".swdir", ".swdir2", ".swr1", ".swr2"])
def test_any_of_the_five_files_stands_for_all(suffix: str, tmp_path: Path) -> None:
    path = wave_files.ndbc(tmp_path).with_suffix(suffix)
    assert read_waves(path, THEN).spectrum.significant_height() == pytest.approx(2.0, rel=0.01)


PLAIN = {"ndbc": lambda folder: shutil.copy(wave_files.ndbc(folder), folder / "alone.data_spec"), "triaxys": wave_files.triaxys_plain}


@pytest.mark.parametrize("name", PLAIN)
def test_energy_alone_takes_the_directions_stated(name: str, tmp_path: Path) -> None:
    path = Path(PLAIN[name](tmp_path))
    found = read_waves(path, WaveChoice(str(TIMES[1]), from_deg=310.0, spreading_deg=20.0))
    assert mean_direction(found.spectrum) == pytest.approx(310.0, abs=0.5)
    assert np.sqrt(2 * (1 - np.abs(found.spectrum.first))) == pytest.approx(np.radians(20.0), rel=2e-3)
    assert "stated" in found.report["directions"]
    with pytest.raises(DomainError, match=r"is missing: .* has no directions; give the azimuth the waves come from"):
        read_waves(path, THEN)
    with pytest.raises(DomainError, match="give the width"):
        read_waves(path, WaveChoice(str(TIMES[1]), from_deg=310.0))


def test_directions_are_not_stated_twice(tmp_path: Path) -> None:
    with pytest.raises(DomainError, match="directions of its own; leave it out") as caught:
        read_waves(wave_files.swan(tmp_path), WaveChoice(str(TIMES[1]), LATITUDE, LONGITUDE, from_deg=310.0))
    assert caught.value.name == "from_deg"


def replaced(path: Path, old: str, new: str) -> Path:
    path.write_text(path.read_text().replace(old, new))
    return path


def cut(path: Path, share: float = 0.5) -> Path:
    path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    return path


SPOILED = {
    "no such file": (lambda d: d / "nix.spec", "does not exist; give the file of a wave spectrum"),
    "a picture": (
        lambda d: (d / "a.png").write_bytes(b"\x89PNG\r\n") and d / "a.png",
        "no file of wave spectra that is recognised; allowed",
    ),
    "GRIB": (lambda d: (d / "a.grib").write_bytes(b"GRIB\x00\x00") and d / "a.grib", "GRIB is not read: convert it to NetCDF"),
    "land": (lambda d: wave_files.era5(d), "no spectrum there"),
    "mean directions of a TRIAXYS": (
        lambda d: replaced(wave_files.triaxys_plain(d), "NON-DIRECTIONAL SPECTRUM", "MEAN DIRECTION"),
        "TYPE = MEAN DIRECTION is not read; allowed",
    ),
    "local time": (lambda d: replaced(wave_files.triaxys(d), "(UTC)", "(PDT)"), "time is in 'PDT', and UTC is read"),
    "a SWAN file of energies alone": (lambda d: replaced(wave_files.swan(d), "NDIR", "XDIR"), "one-dimensional spectra"),
    "two points": (lambda d: replaced(wave_files.ww3(d), "    36     1 '", "    36     2 '"), "has 2 points, and files of one are read"),
    "a name without time": (lambda d: wave_files.datawell(d).rename(d / "buoy.spt"), "name does not tell place and time"),
    "a cut Octopus": (lambda d: cut(wave_files.octopus(d)), "cannot be read as an Octopus file"),
    "a cut SWAN": (lambda d: cut(wave_files.swan(d), 0.98), "cannot be read|must be finite"),
    "a cut NetCDF": (lambda d: cut(wave_files.own(d)), "cannot be read as NetCDF"),
    "a cut JSON": (lambda d: cut(wave_files.spotter_json(d)), "Spotter|recognised"),
    "negative energy": (lambda d: replaced(wave_files.datawell(d), "1.000000E+00", "-1.00000E+00"), "negative"),
}


@pytest.mark.parametrize("name", SPOILED)
def test_files_that_cannot_be_used_are_told_in_one_line(name: str, tmp_path: Path) -> None:
    make, match = SPOILED[name]
    choice = WaveChoice(str(TIMES[1]), LATITUDE, LONGITUDE - 0.5) if name == "land" else THEN
    with pytest.raises(DataError, match=match) as caught:
        read_waves(make(tmp_path), choice)
    assert "\n" not in str(caught.value)


def test_energies_in_joules(tmp_path: Path) -> None:
    """SWAN writes energy (J/m2/Hz/degr) when asked to: 1025 kg/m3 times 9.81 m/s2 as much."""
    path = replaced(wave_files.swan(tmp_path), "m2/Hz/degr      ", "J/m2/Hz/degr    ")
    height = read_waves(path, THEN).spectrum.significant_height()
    assert height == pytest.approx(2.0 / np.sqrt(1025.0 * 9.81), rel=0.01)


def test_a_format_that_is_told_is_believed(tmp_path: Path) -> None:
    path = wave_files.triaxys(tmp_path)
    with pytest.raises(DataError, match="cannot be read as an Octopus file"):
        read_waves(path, THEN, format="octopus")
    odd = path.rename(tmp_path / "odd")
    assert read_waves(odd, THEN, format="triaxys").report["format"] == "triaxys"


def test_the_scenario_knows_the_formats_that_are_read() -> None:
    annotation = SpectrumFile.model_fields["format"].annotation
    assert annotation.__args__ == ("auto", *FORMATS)


def test_distances() -> None:
    assert distance_km(0.0, 0.0, np.array([0.0, 90.0]), np.array([180.0, 0.0])) == pytest.approx([20015.1, 10007.5], abs=0.1)


def test_a_buoys_files_are_read_without_a_warning(recwarn: pytest.WarningsRecorder) -> None:
    """Those of libraries about their own libraries are nothing that who has a buoy's file can mend."""
    read_waves(Path(str(files("seaglint.scenario") / "data" / "41010.data_spec")), WaveChoice("2020-06-08T03:50Z"))
    assert [str(warning.message) for warning in recwarn] == []


@pytest.mark.parametrize("row", ["2020-06-08T03:50Z", "2020-06-02T05:50Z"])
def test_a_real_buoy_is_recognised(row: str, data_dir: Path) -> None:
    choice = WaveChoice(row, time_tolerance=900.0)
    by_name = read_waves(data_dir / "waves" / "41010.swr1", choice)
    assert by_name.report["format"] == "ndbc"
    assert np.array_equal(by_name.spectrum.energy, read_waves(data_dir / "waves" / "41010", choice).spectrum.energy)
