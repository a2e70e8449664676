"""Spectra on frequencies and directions: energy and moments kept, crossing seas kept apart, sectors, and what is refused."""

import numpy as np
import pytest

from seaglint.base.errors import DataError, DomainError
from seaglint.sea.dispersion import wavenumber
from seaglint.sea.spectra import BinnedSpectrum
from seaglint.sea.spectra.binned import of_bins, of_cosine
from seaglint.sea.spectra.directional import cosine_power, power_of_width, second_moment
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import WaveField

FREQUENCY = np.round(0.05 * 1.1 ** np.arange(24), 5)
ENERGY = FREQUENCY**-5.0 * np.exp(-1.25 * (0.1 / FREQUENCY) ** 4) * 2e-5
AZIMUTH = (np.arange(7200) + 0.5) * (2 * np.pi / 7200)
K = [float(wavenumber(2 * np.pi * f)) for f in (0.07, 0.1, 0.23, 0.4)] + [50.0]  # the last in the tail
WIND = np.radians(20.0)


def bins(step: float, centre: float = 1.0, width: float = np.radians(25.0)) -> BinnedSpectrum:
    azimuth = np.radians(np.arange(0.0, 360.0, step))
    share = cosine_power(azimuth - centre, power_of_width(width))
    return of_bins(FREQUENCY, azimuth, ENERGY[:, None] * share / (share.sum() * np.radians(step)), WIND)


SEAS = {"15 deg": bins(15.0), "3 deg": bins(3.0), "cosine": of_cosine(FREQUENCY, ENERGY, 1.0 + FREQUENCY, np.radians(25.0), WIND)}


@pytest.mark.parametrize("k", K)
@pytest.mark.parametrize("name", SEAS)
def test_distribution_is_positive_and_has_the_harmonics_of_the_integrals(name: str, k: float) -> None:
    sea = SEAS[name]
    spread = sea.spreading(k, AZIMUTH)
    assert np.all(spread >= 0.0)
    assert spread.mean() * 2 * np.pi == pytest.approx(1.0, abs=1e-5)
    assert np.mean(spread * np.cos(2 * (AZIMUTH - WIND))) * 2 * np.pi == pytest.approx(float(sea.second_harmonic(k)), abs=2e-4)
    assert np.mean(spread * np.sin(2 * (AZIMUTH - WIND))) * 2 * np.pi == pytest.approx(float(sea.cross_harmonic(k)), abs=2e-4)


@pytest.mark.parametrize(("step", "rel"), [(15.0, 0.004), (10.0, 0.002), (3.0, 0.0005)])
def test_directions_are_as_wide_as_they_were(step: float, rel: float) -> None:
    sea = bins(step)
    assert sea.energy == pytest.approx(ENERGY, rel=1e-9)
    width = np.sqrt(2 * (1 - np.abs(sea.first)))
    assert width == pytest.approx(np.full(FREQUENCY.size, np.radians(25.0)), rel=rel)
    assert np.angle(sea.first) == pytest.approx(np.full(FREQUENCY.size, 1.0), abs=1e-3)


def test_the_cosine_has_its_width_and_second_moment() -> None:
    power = float(power_of_width(np.radians(25.0)))
    share = cosine_power(AZIMUTH - 2.0, power)
    assert share.mean() * 2 * np.pi == pytest.approx(1.0, abs=1e-9)
    first = np.mean(share * np.exp(1j * (AZIMUTH - 2.0))) * 2 * np.pi
    assert np.sqrt(2 * (1 - first.real)) == pytest.approx(np.radians(25.0), rel=1e-9)
    assert np.mean(share * np.cos(2 * (AZIMUTH - 2.0))) * 2 * np.pi == pytest.approx(second_moment(power), abs=1e-9)
    with pytest.raises(DomainError, match=r"spreading = 85 deg is outside 1-80 deg"):
        power_of_width(np.radians(85.0))


def test_two_seas_at_one_frequency_stay_two() -> None:
    azimuth = np.radians(np.arange(0.0, 360.0, 10.0))
    share = sum(cosine_power(azimuth - centre, 60.0) for centre in np.radians([45.0, 135.0]))
    spread = of_bins(FREQUENCY, azimuth, ENERGY[:, None] * share).spreading(K[1], np.radians([45.0, 90.0, 135.0]))
    assert spread[0] == pytest.approx(spread[2], rel=1e-6)
    assert spread[1] < 0.02 * spread[0]


@pytest.mark.parametrize(("first", "step", "count"), [(330.0, 10.0, 12), (10.0, 10.0, 35), (100.0, 7.0, 20)])
def test_a_sector_has_nothing_outside(first: float, step: float, count: int) -> None:
    degrees = (first + step * np.arange(count)) % 360.0
    shuffled = np.random.default_rng(1).permutation(count)
    sea = of_bins(FREQUENCY, np.radians(degrees)[shuffled], np.tile(ENERGY[:, None] / (count * np.radians(step)), count))
    assert sea.energy == pytest.approx(ENERGY, rel=1e-9)
    spread = sea.spreading(K[1], AZIMUTH)
    assert spread.mean() * 2 * np.pi == pytest.approx(1.0, abs=1e-3)
    outside = (np.degrees(AZIMUTH) - first) % 360.0 > step * count
    assert np.max(spread[outside & ((np.degrees(AZIMUTH) - first) % 360.0 < 360.0 - step)], initial=0.0) < 1e-12
    assert sea.spreading(K[1], np.radians(first + 0.5 * step * count)) == pytest.approx(1.0 / np.radians(step * count), rel=0.05)


@pytest.mark.parametrize(
    ("degrees", "match"),
    [
        ([0.0, 10.0, 20.0, 40.0, 50.0, 60.0], "evenly spaced"),
        ([0.0, 90.0, 180.0, 270.0, 360.0], "evenly spaced, each once"),
        ([0.0, 120.0, 240.0], "needs 4 of them or more, not 3"),
    ],
)
def test_uneven_directions_are_refused(degrees: list[float], match: str) -> None:
    with pytest.raises(DataError, match=match):
        of_bins(FREQUENCY, np.radians(degrees), np.ones((FREQUENCY.size, len(degrees))))


@pytest.mark.parametrize(("value", "match"), [(np.nan, "finite"), (-1.0, "not negative")])
def test_impossible_densities_are_refused(value: float, match: str) -> None:
    density = np.ones((FREQUENCY.size, 24))
    density[3, 4] = value
    with pytest.raises(DataError, match=match):
        of_bins(FREQUENCY, np.radians(np.arange(0.0, 360.0, 15.0)), density)


def test_the_sea_has_the_height_and_slopes_of_its_spectrum() -> None:
    sea = SEAS["15 deg"]
    tiles = plan_tiles(sea, 0.5, 256)
    field = WaveField.create(sea, tiles, 0)
    assert field.significant_height == pytest.approx(sea.significant_height(), rel=0.01)
    assert field.resolved_mss() == pytest.approx(sea.mss(tiles[-1].k_max), rel=0.02)
