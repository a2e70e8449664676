"""Buoy spectra: directions, tail, and the sea made of them."""

import shutil
import sys

import numpy as np
import pytest
import wave_files

from seaglint.base.errors import BackendError, DataError, DomainError
from seaglint.formats.waves import WaveChoice, read_waves
from seaglint.formats.waves.ndbc_buoys import SUFFIXES as NDBC_SUFFIXES
from seaglint.scenario.text.template import DATA
from seaglint.sea.spectra import MeasuredSpectrum
from seaglint.sea.spectra.measured import possible_moments
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import WaveField

pytest.importorskip("wavespectra", reason="wavespectra, which reads measured spectra, is not installed")

BUOY = DATA / "41010.data_spec"
WIND_TO = np.radians(300.0)

# WVHT [m] in NDBC's summary (41010.spec) ten minutes before each spectrum
RECORDS = [("2020-06-08T03:50Z", 1.1), ("2020-06-05T12:50", 1.3), ("2020-06-02 05:50", 2.6)]


def read_ndbc(path, time, wind_to_azimuth=0.0, tolerance=3600.0):
    return read_waves(path, WaveChoice(time, time_tolerance=tolerance), wind_to_azimuth, format="ndbc").spectrum


@pytest.fixture
def buoy(tmp_path):
    """A copy of the buoy's files to spoil."""
    for suffix in NDBC_SUFFIXES:
        shutil.copy(BUOY.with_suffix(suffix), tmp_path)
    return tmp_path / "41010.data_spec"


def columns(file, row):
    """Numbers and frequencies of one line, by splitting text: no part of the reader under test."""
    words = file.read_text().splitlines()[row].split()[5:]
    if file.suffix == ".data_spec":
        words = words[1:]
    return np.array(words[0::2], dtype=float), np.array([w.strip("()") for w in words[1::2]], dtype=float)


@pytest.mark.parametrize(("time", "height"), RECORDS)
def test_height_is_that_of_the_buoy(time, height):
    assert read_ndbc(BUOY, time).significant_height() == pytest.approx(height, abs=0.15)  # WVHT has one decimal, another ten minutes


@pytest.mark.parametrize(("row", "time"), [(1, "2020-06-08T03:50"), (3, "2020-06-02T05:50")])
def test_measured_part_is_the_energy_in_the_file(row, time):
    energy, frequency = columns(BUOY, row)
    sea = read_ndbc(BUOY, time)
    assert sea.height_variance(sea.tail_wavenumber) == pytest.approx(
        np.trapezoid(energy, frequency), rel=2e-3
    )  # its end within the last band
    tail = sea.height_variance(np.inf, sea.tail_wavenumber)
    assert 0.0 < tail < 0.05 * sea.height_variance()


@pytest.mark.parametrize("n", [256, pytest.param(512, marks=pytest.mark.validation)])
@pytest.mark.parametrize(("time", "_"), RECORDS)
def test_the_sea_has_the_height_and_slopes_of_its_spectrum(time, _, n):
    sea = read_ndbc(BUOY, time, WIND_TO)
    tiles = plan_tiles(sea, 0.5, n)
    field = WaveField.create(sea, tiles, 0)
    assert field.significant_height == pytest.approx(sea.significant_height(), rel=0.03)  # promised; measured 0.1 %
    assert field.resolved_mss() == pytest.approx(sea.mss(tiles[-1].k_max), rel=0.02)


def test_realisations_have_the_height_of_the_buoy():
    sea = read_ndbc(BUOY, RECORDS[0][0])
    field = WaveField.create(sea, plan_tiles(sea, 1.0, 256), 0)
    variances = [sum(np.mean(s[..., 0].astype(float) ** 2) for s in field.reseeded(seed).surfaces(0.0)) for seed in range(40)]
    assert np.std(variances, ddof=1) / np.sqrt(40) < 0.03 * np.mean(variances)
    assert 4 * np.sqrt(np.mean(variances)) == pytest.approx(sea.significant_height(), rel=0.03)


def test_waves_travel_away_from_where_they_come_from():
    """Mean direction at the peak: swdir says from, the spectrum says to."""
    energy, frequency = columns(BUOY, 1)
    alpha, _ = columns(BUOY.with_suffix(".swdir"), 1)
    r1, _ = columns(BUOY.with_suffix(".swr1"), 1)
    peak = int(np.argmax(energy))
    sea = read_ndbc(BUOY, "2020-06-08T03:50")
    azimuth = (np.arange(720) + 0.5) * (2 * np.pi / 720)
    k = (2 * np.pi * frequency[peak]) ** 2 / 9.81  # gravity alone, enough at 6 s
    spread = sea.spreading(k, azimuth) * (2 * np.pi / 720)
    moment = (spread * np.exp(1j * azimuth)).sum()
    assert np.degrees(np.angle(moment * np.exp(-1j * np.radians(alpha[peak] + 180.0)))) == pytest.approx(0.0, abs=2.0)
    assert abs(moment) == pytest.approx(r1[peak], abs=0.02)  # neighbouring bands mix within a fraction of a band


@pytest.mark.parametrize("k", [0.05, 0.17, 0.5, 5.0])
def test_distribution_is_positive_and_has_the_stated_second_moment(k):
    sea = read_ndbc(BUOY, "2020-06-08T03:50", WIND_TO)
    azimuth = (np.arange(7200) + 0.5) * (2 * np.pi / 7200)
    spread = sea.spreading(k, azimuth)
    assert np.all(spread >= 0.0)
    assert spread.mean() * 2 * np.pi == pytest.approx(1.0, abs=1e-6)
    second = np.mean(spread * np.cos(2 * (azimuth - WIND_TO))) * 2 * np.pi
    assert second == pytest.approx(float(sea.second_harmonic(k)), abs=1e-6)


def test_the_tail_falls_as_phillips():
    sea = read_ndbc(BUOY, "2020-06-08T03:50")
    k = np.array([2.0, 20.0, 200.0])
    saturation = sea.omnidirectional(k) * k**3
    assert saturation == pytest.approx(np.full(3, saturation[0]))
    assert 1e-4 < saturation[0] < 1e-2  # Phillips' constant over two is 4e-3 in a strong wind
    assert sea.omnidirectional(400.0) == 0.0


def test_noisy_moments_are_brought_back_to_possible_ones():
    first, second = possible_moments(np.array([0.9, 1.0, 0.3j, 0.0]), np.array([-0.5, 1.0, -0.09, 0.2]))
    assert np.all(np.abs(second - first**2) < 1.0 - np.abs(first) ** 2)
    assert second[2:] == pytest.approx([-0.09, 0.2])  # those were possible


def test_name_without_ending_and_offset_times():
    a = read_ndbc(BUOY.with_suffix(""), "2020-06-08T03:30Z")
    b = read_ndbc(str(BUOY), np.datetime64("2020-06-08T03:50"))
    c = read_ndbc(BUOY, "2020-06-08T05:50+02:00")
    assert np.array_equal(a.energy, b.energy)
    assert np.array_equal(c.energy, b.energy)


def rewrite(file, change):
    file.write_text("\n".join(change(file.read_text().splitlines())) + "\n")


def without_directions(lines):
    return [lines[0], *(" ".join("999.00" if w == "0.82" or w.startswith("0.7") else w for w in line.split()) for line in lines[1:])]


@pytest.mark.parametrize(
    ("spoil", "time", "match"),
    [
        (lambda p: None, "2020-06-12T00:00", "no record within"),
        (lambda p: None, "yesterday", "ISO"),
        (lambda p: p.with_suffix(".swr2").unlink(), "2020-06-08T03:50", "swr2 does not exist"),
        (lambda p: p.write_text(""), "2020-06-08T03:50", "cannot be read"),
        (lambda p: p.write_bytes(bytes(range(256)) * 2), "2020-06-08T03:50", "cannot be read"),
        (lambda p: p.write_text(p.read_text()[:-300]), "2020-06-02T05:50", "missing energy|cannot be read"),
        (lambda p: rewrite(p, lambda x: [s.replace("0.218", "999.000") for s in x]), "2020-06-08T03:50", "missing energy"),
        (lambda p: rewrite(p.with_suffix(".swdir"), lambda x: [x[0], *x[2:]]), "2020-06-08T03:50", "no record of"),
        (lambda p: rewrite(p.with_suffix(".swr1"), without_directions), "2020-06-08T03:50", "lacks directions"),
        (
            lambda p: rewrite(p.with_suffix(".swr1"), lambda x: [s.replace(" 0.82", " 82.0") for s in x]),
            "2020-06-08T03:50",
            "divide by 100",
        ),
    ],
)
def test_spoiled_files_are_refused_in_one_line(buoy, spoil, time, match):
    spoil(buoy)
    with pytest.raises(DataError, match=match):
        read_ndbc(buoy, time)


def test_without_wavespectra_the_remedy_is_named(monkeypatch, tmp_path):
    path = wave_files.swan(tmp_path)
    monkeypatch.setitem(sys.modules, "wavespectra", None)
    with pytest.raises(BackendError, match=r"pip install 'wavespectra>=4\.3'"):
        read_waves(path, WaveChoice(str(wave_files.TIMES[1]), site="2"))


@pytest.mark.parametrize(
    ("energy", "match"), [([0.0, 0.0, 0.0], "zero everywhere"), ([0.0, np.nan, 1.0], "NaN"), ([0.0, -1.0, 1.0], "negative")]
)
def test_impossible_energies_are_refused(energy, match):
    zero = np.zeros(3, dtype=complex)
    with pytest.raises(DataError, match=match):
        MeasuredSpectrum(np.array([0.1, 0.2, 0.3]), np.array(energy), zero, zero)


@pytest.mark.parametrize("every", [27, pytest.param(9, marks=pytest.mark.validation)])
def test_a_week_of_the_buoy_agrees_with_its_summary(every, data_dir):
    path = data_dir / "waves" / "41010"
    rows = [line.split() for line in path.with_suffix(".spec").read_text().splitlines() if not line.startswith("#")]
    worst = 0.0
    for year, month, day, hour, minute, height, *_ in rows[::every]:
        try:
            sea = read_ndbc(path, f"{year}-{month}-{day}T{hour}:{minute}", tolerance=900.0)
        except DataError as error:
            assert "no record within" in str(error)  # noqa: PT017 - the summary has hours that the spectra lack
            continue
        worst = max(worst, abs(sea.significant_height() - float(height)))
    assert worst < 0.15


@pytest.mark.parametrize("site", ["41010", "1", None])
def test_a_buoy_has_the_name_of_its_station(site):
    found = read_waves(BUOY, WaveChoice(RECORDS[0][0], site=site)).spectrum
    assert found.significant_height() == pytest.approx(RECORDS[0][1], abs=0.15)


@pytest.mark.parametrize("site", ["41009", "2", "0", "-1"])
def test_another_station_is_refused(site):
    with pytest.raises(DomainError, match=f"'{site}' is not a site of .*allowed: 41010"):
        read_waves(BUOY, WaveChoice(RECORDS[0][0], site=site))
