"""AWAC telegrams, Obscape's CSV, WWM's NetCDF and Zarr stores: units, directions and dirt, each against a plain reading."""

from __future__ import annotations

import gzip
import math
import random
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import wave_files
import xarray as xr
from wave_files import FROM, LATITUDE, LONGITUDE, TIMES

from seaglint.base.errors import DataError, DomainError, ScenarioError, SeaglintError
from seaglint.formats.waves import FORMATS, WaveChoice, read_waves
from seaglint.formats.waves.wave_formats import Format
from seaglint.scenario.load import load_scenario
from seaglint.sea.spectra.measured import MeasuredSpectrum
from seaglint.studies.build.waves_and_slopes import waves as waves_of

pytest.importorskip("wavespectra", reason="wavespectra, which reads wave files, is not installed")

THEN = WaveChoice(str(TIMES[1]), LATITUDE, LONGITUDE)


def come_from(sea: MeasuredSpectrum) -> float:
    """Where the energy of all bands comes from on the average [deg]."""
    return float(np.degrees(np.angle(-np.sum(sea.first * sea.energy * np.gradient(sea.frequency_hz)))) % 360.0)


def replaced(path: Path, old: str, new: str, count: int = -1) -> Path:
    content = path.read_bytes()
    assert old.encode() in content
    path.write_bytes(content.replace(old.encode(), new.encode(), count))
    return path


def netcdf(data: xr.Dataset, folder: Path) -> Path:
    data.to_netcdf(folder / "wwm.nc", engine="h5netcdf")
    return folder / "wwm.nc"


# Readings by hand: the numbers of the file as its description has them, without a library and without the reader.
def test_energies_of_telegrams_are_those_of_the_file(tmp_path: Path) -> None:
    path = wave_files.awac(tmp_path)
    line = next(text for text in path.read_text().splitlines() if text.startswith("$PNORE,030124,0300"))
    cells = line.partition("*")[0].split(",")
    sea = read_waves(path, THEN).spectrum
    assert sea.energy == pytest.approx([float(cell) for cell in cells[7:]], abs=1e-12)
    assert sea.frequency_hz == pytest.approx([0.02 + 0.01 * n for n in range(98)], abs=1e-12)


@pytest.mark.parametrize("sentence", ["PNORF", "PNORWD"])
def test_moments_of_telegrams_are_those_of_their_cosine(sentence: str, tmp_path: Path) -> None:
    """Of every band: those without coefficients, at -9 and above the last one, have those of their neighbours."""
    sea = read_waves(wave_files.awac(tmp_path, sentence), THEN).spectrum
    power = 2.0 / np.radians(30.0) ** 2 - 1.0  # cos^2s of half the angle: r1 = s / (s + 1) = 1 - width^2 / 2
    towards = np.exp(1j * np.radians(FROM + 180.0))
    r1, r2 = power / (power + 1.0), power * (power - 1.0) / ((power + 1.0) * (power + 2.0))
    np.testing.assert_allclose(sea.first, np.full(98, r1 * towards), atol=2e-4)
    np.testing.assert_allclose(sea.second, np.full(98, r2 * towards**2), atol=2e-4)


def test_packed_telegrams(tmp_path: Path) -> None:
    path = wave_files.awac(tmp_path)
    packed = tmp_path / "waves.nmea.gz"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    assert read_waves(packed, THEN).report == {**read_waves(path, THEN).report, "file": packed.name}


@pytest.mark.parametrize("unit", [1.0, 1e-4], ids=["m2", "cm2"])
def test_the_unit_of_telegrams_follows_from_their_height(unit: float, tmp_path: Path) -> None:
    assert read_waves(wave_files.awac(tmp_path, unit=unit), THEN).spectrum.significant_height() == pytest.approx(2.0, rel=0.01)


def test_obscape_against_a_plain_reading(tmp_path: Path) -> None:
    path = wave_files.obscape(tmp_path)
    table = np.loadtxt(path, delimiter=",", comments="#")
    found = read_waves(path, THEN)
    assert found.spectrum.energy == pytest.approx(table.sum(axis=1) * np.radians(3.0), rel=1e-6)
    assert come_from(found.spectrum) == pytest.approx(FROM, abs=0.5)
    assert (found.report["time"], found.report["latitude_deg"]) == ("2024-03-01T03:00:00Z", LATITUDE)  # not 4 h of Amsterdam
    shutil.rmtree(tmp_path)
    tmp_path.mkdir()
    degrees = read_waves(wave_files.obscape(tmp_path, unit="m2/Hz/deg"), THEN).spectrum
    assert degrees.energy == pytest.approx(found.spectrum.energy, rel=1e-3, abs=1e-3)  # six digits


def test_wwm_against_a_plain_reading(tmp_path: Path) -> None:
    data = wave_files.wwm_dataset()
    sea = read_waves(wave_files.wwm(tmp_path), THEN).spectrum
    action = data["AC"].values[1, :, :, 1]  # direction, frequency
    sigma = data["SPSIG"].values
    assert sea.frequency_hz == pytest.approx(sigma / (2 * np.pi), rel=1e-12)
    # E(f) df = N sigma dsigma dtheta, and dsigma = 2 pi df.
    assert sea.energy == pytest.approx(action.sum(axis=0) * sigma * 2 * np.pi * np.radians(10.0), rel=1e-9)
    # Group velocity by the model's own axes: x east, y north; waves from 230 deg travel to the north-east.
    east, north = (np.sum(action * part(data["SPDIR"].values)[:, None] * sigma) for part in (np.cos, np.sin))
    assert math.degrees(math.atan2(-east, -north)) % 360.0 == pytest.approx(FROM, abs=0.5)
    assert come_from(sea) == pytest.approx(FROM, abs=0.5)


def test_wwm_of_older_programs(tmp_path: Path) -> None:
    data = wave_files.wwm_dataset().rename({"SPSIG": "spsig", "SPDIR": "spdir", "nfreq": "msc", "ndir": "mdc"})
    found = read_waves(netcdf(data.drop_vars("HS"), tmp_path), THEN)
    assert found.report["format"] == "wwm"
    assert come_from(found.spectrum) == pytest.approx(FROM, abs=0.5)


STORES: dict[str, Callable[[Path], Path]] = {
    name: getattr(wave_files, name) for name in ("own", "ww3_netcdf", "swan_netcdf", "era5", "cdip", "ndbc_netcdf", "wwm")
}


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", STORES)
def test_stores_give_what_their_netcdf_gives(name: str, version: int, tmp_path: Path) -> None:
    store = wave_files.stored(STORES[name], tmp_path, version)
    (file,) = tmp_path.glob("*.nc")
    theirs, ours = read_waves(file, THEN), read_waves(store, THEN)
    assert {**ours.report, "file": file.name} == theirs.report
    assert np.array_equal(ours.spectrum.energy, theirs.spectrum.energy)
    assert np.array_equal(ours.spectrum.first, theirs.spectrum.first)


def test_a_scenario_takes_a_store(tmp_path: Path) -> None:
    wave_files.stored(wave_files.ww3_netcdf, tmp_path)
    text = f'[sea.spectrum]\nkind = "file"\npath = "waves.zarr"\ntime = {TIMES[1]}Z\nsite = "46042"\n'
    (tmp_path / "scene.toml").write_text(text.replace(".000000000", ""))
    waves = waves_of(load_scenario(tmp_path / "scene.toml"))
    assert waves.sources[0]["format"] == "ww3"
    (tmp_path / "scene.toml").write_text(text.replace(".000000000", "").replace("waves.zarr", "nothing.zarr"))
    with pytest.raises(ScenarioError, match="is not a file or the folder of a Zarr store that exists"):
        load_scenario(tmp_path / "scene.toml")


def awac_lines(folder: Path, change: Callable[[list[str]], list[str]]) -> Path:
    path = wave_files.awac(folder)
    path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")
    return path


def test_bad_telegrams_are_counted_by_kind(tmp_path: Path) -> None:
    def change(lines: list[str]) -> list[str]:
        cut, flipped = lines[3][:200], lines[4].replace("A1", "A2", 1)
        short = wave_files.nmea("PNORE", "030124", "060000", 3, "0.02", "0.01", 98, *["0.1"] * 97)
        odd = wave_files.nmea("PNORE", "039924", "060000", 3, "0.02", "0.01", 1, "0.1")
        return [cut, flipped, *lines, short, odd, "\x00\x7f binary"]

    found = read_waves(awac_lines(tmp_path, change), THEN)
    assert found.spectrum.significant_height() == pytest.approx(2.0, rel=0.01)
    assert found.report["note"] == (
        "left out: lines that are no whole sentence: 2, lines with a wrong checksum: 1, lines of $PNORE with another number of values: 1, "
        "lines of $PNORE with an impossible date or number: 1"
    )


def test_records_that_are_not_whole_or_flagged_are_left_out(tmp_path: Path) -> None:
    def change(lines: list[str]) -> list[str]:
        flagged = lines[2].rpartition(",")[0][1:].split(",")
        return [*lines[:2], wave_files.nmea(*flagged, "0020"), *lines[3:-1], lines[-1]]

    found = read_waves(awac_lines(tmp_path, change), WaveChoice())
    assert found.report["time"] == "2024-03-01T03:00:00Z"  # the only one left
    assert found.report["note"] == "left out: records with an error code: 1"


def test_telegrams_without_directions_need_them_stated(tmp_path: Path) -> None:
    path = wave_files.awac(tmp_path, "none")
    found = read_waves(path, WaveChoice(THEN.time, from_deg=310.0, spreading_deg=20.0))
    assert come_from(found.spectrum) == pytest.approx(310.0, abs=0.5)
    with pytest.raises(DomainError, match="has no directions"):
        read_waves(path, THEN)


def test_two_sentences_that_differ_leave_their_record_out(tmp_path: Path) -> None:
    def change(lines: list[str]) -> list[str]:
        once, again = (next(line for line in lines if line.startswith(f"$PNORE,030124,{hour}")) for hour in ("0000", "0300"))
        return [*lines, once, wave_files.nmea(*again[1:].partition("*")[0].split(",")[:-1], "0.5")]

    found = read_waves(awac_lines(tmp_path, change), WaveChoice())
    assert found.report["time"] == "2024-03-01T00:00:00Z"
    assert found.report["note"] == "left out: records with two sentences that differ: 1"


def test_the_direction_of_the_peak_is_that_of_its_own_band(tmp_path: Path) -> None:
    assert read_waves(turned(tmp_path, but=9), THEN).spectrum.first[9].imag == pytest.approx(0.66, abs=0.01)  # 0.11 Hz, of 9 s


def turned(folder: Path, but: int | None = None) -> Path:
    """Coefficients of the direction TO: against DirTp; all bands but one, where it is given."""

    def change(lines: list[str]) -> list[str]:
        out = []
        for line in lines:
            cells = line[1:].partition("*")[0].split(",")
            if cells[1] in ("A1", "B1"):
                turned = [n for n, cell in enumerate(cells) if n >= 8 and n - 8 != but and cell != "-9.0000"]
                cells = [f"{-float(cell):.4f}" if n in turned else cell for n, cell in enumerate(cells)]
            out.append(wave_files.nmea(*cells))
        return out

    return awac_lines(folder, change)


def resized(folder: Path, factor: float) -> Path:
    def change(lines: list[str]) -> list[str]:
        cells = [line[1:].partition("*")[0].split(",") for line in lines]
        return [wave_files.nmea(*[*c[:5], float(c[5]) * factor, *c[6:]] if c[0] == "PNORW" else c) for c in cells]

    return awac_lines(folder, change)


SPOILED: dict[str, tuple[Callable[[Path], Path], str]] = {
    "a folder": (lambda d: d, "is a folder and no Zarr store"),
    "an empty store": (lambda d: xr.Dataset().to_zarr(d / "a.zarr") and d / "a.zarr", "no file of wave spectra that is recognised"),
    "a store without its metadata": (
        lambda d: (wave_files.stored(wave_files.own, d) / "efth" / "zarr.json").unlink() or d / "waves.zarr",
        "no file of wave spectra that is recognised",
    ),
    "a broken store": (
        lambda d: (wave_files.stored(wave_files.own, d) / "zarr.json").write_text("{") and d / "waves.zarr",
        "cannot be read as a Zarr store",
    ),
    "dirt alone": (
        lambda d: awac_lines(d, lambda lines: [line[:50] for line in lines]),
        r"14 of 15 lines are no telegrams: 14 lines that are no whole",
    ),
    "one line of telegrams": (lambda d: awac_lines(d, lambda lines: lines[:1]), "has no whole record of waves"),
    "coefficients turned round": (turned, "waves of the peak come from 50 deg by its spectrum and from 230 deg by"),
    "a height of another unit": (lambda d: resized(d, 3.0), r"give a height of 2\.00 m in m2/Hz and 0\.02 m in cm2/Hz, and \$PNORW has"),
    "magnetic north": (lambda d: wave_files.obscape(d, directions="Magnetic North"), "'Magnetic North' is not read; allowed: True North"),
    "another unit": (lambda d: wave_files.obscape(d, unit="dB"), r"'Variance-density \[dB\]' is not read; allowed: Variance-density"),
    "no unit": (lambda d: replaced(wave_files.obscape(d), "# Variance", "# Energy"), "'no unit' is not read"),
    "no timestamp": (lambda d: replaced(wave_files.obscape(d), "# Timestamp", "# Stamp"), "no line '# Timestamp = ...'"),
    "a row less": (
        lambda d: replaced(wave_files.obscape(d), "# Rows [Hz] = ", "# Rows [Hz] = 0.03,"),
        "has 36 rows and 37 frequencies in its header",
    ),
    "a column less": (lambda d: replaced(wave_files.obscape(d), "... 357", "... 354"), "line 16: has 120 columns and the header 119"),
    "a cell of text": (lambda d: replaced(wave_files.obscape(d), "\n0.0", "\nx.0", 1), "line 16: is no list of numbers"),
    "directions in degrees": (
        lambda d: netcdf(wave_files.wwm_dataset().assign(SPDIR=("ndir", np.arange(5.0, 360.0, 10.0))), d),
        "SPDIR reaches 355, and radians are read",
    ),
    "energy for action": (
        lambda d: netcdf(wave_files.wwm_dataset().assign(AC=wave_files.wwm_dataset()["AC"] * 2 * np.pi), d),
        r"AC gives a height of 5\.\d+ m and HS is 2\.00 m",
    ),
    "cut WWM": (lambda d: cut(wave_files.wwm(d)), "cannot be read as NetCDF"),
    "cut zip": (lambda d: cut(wave_files.packed(d)), "no file of wave spectra that is recognised"),
}


def cut(path: Path) -> Path:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    return path


@pytest.mark.parametrize("name", SPOILED)
def test_files_that_cannot_be_used_are_told_in_one_line(name: str, tmp_path: Path) -> None:
    make, match = SPOILED[name]
    with pytest.raises(DataError, match=match) as caught:
        read_waves(make(tmp_path), THEN)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("name", "match"), [("nix", "does not exist; give the file"), ("", "is a folder and no Zarr store")])
@pytest.mark.parametrize("kind", [kind for kind in FORMATS if kind != "ndbc"])
def test_a_stated_format_of_nothing(kind: Format, name: str, match: str, tmp_path: Path) -> None:
    with pytest.raises(DataError, match=match):
        read_waves(tmp_path / name, THEN, format=kind)


def test_a_record_whose_chunk_is_missing_is_refused(tmp_path: Path) -> None:
    store = wave_files.stored(wave_files.own, tmp_path)
    shutil.rmtree(store / "efth" / "c")
    with pytest.raises(DataError, match="must be finite"):
        read_waves(store, THEN)


def test_damaged_stores(tmp_path: Path) -> None:
    """One file of the store changed: a spectrum, or one line."""
    whole = wave_files.stored(wave_files.own, tmp_path)
    files = sorted(path.relative_to(whole) for path in whole.rglob("*") if path.is_file())
    for number in range(60):
        rnd, copy = random.Random(number), tmp_path / "copy.zarr"
        shutil.copytree(whole, copy)
        file = copy / rnd.choice(files)
        content = bytearray(file.read_bytes())
        content[rnd.randrange(len(content))] = rnd.randrange(256)
        file.write_bytes(content[: rnd.choice((len(content), len(content) // 2))])
        told = ""
        try:
            assert math.isfinite(read_waves(copy, THEN).spectrum.significant_height())
        except SeaglintError as error:
            told = str(error)
        assert "\n" not in told
        shutil.rmtree(copy)
