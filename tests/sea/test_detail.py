"""Levels of detail against the full sea, filtered by an FFT of its lattice."""

import numpy as np
import pytest

from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import Detail, WaveField


@pytest.fixture(scope="module")
def waves():
    spectrum = ElfouhailySpectrum(8.0, 0.7)
    return WaveField.create(spectrum, plan_tiles(spectrum, 1.0, 128), 5)


def test_a_halved_tile_is_the_tile_without_its_shortest_waves(waves):
    full, half = waves.only(1), waves.only(1).halved()
    tile, cut = full.tiles[0], half.tiles[0].k_max
    assert (half.tiles[0].n, half.tiles[0].length, cut) == (tile.n // 2, tile.length, 0.5 * tile.k_max)
    k = 2.0 * np.pi * np.fft.fftfreq(tile.n, tile.spacing)
    held = np.hypot(k[:, None], k[None, :]) < cut * (1.0 - 1e-9)
    whole, coarse = full.surfaces(3.7)[0], half.surfaces(3.7)[0]
    for component in range(3):
        filtered = np.fft.ifft2(np.fft.fft2(whole[..., component]) * held).real
        np.testing.assert_allclose(coarse[..., component], filtered[::2, ::2], atol=1e-5 * np.abs(whole[..., component]).max())


def test_levels_lose_waves_one_octave_after_another(waves):
    detail = Detail.of(waves)
    shortest = np.array([level.shortest_wave for level in detail.levels])
    assert shortest[0] == pytest.approx(2.0 * np.pi / waves.tiles[-1].k_max)
    assert np.all((shortest[1:] / shortest[:-1] > 1.5) & (shortest[1:] / shortest[:-1] < 3.1))
    slopes = np.array([level.mss for level in detail.levels])
    assert slopes[0] == pytest.approx(waves.resolved_mss(), rel=1e-12)
    assert np.all(np.diff(slopes, axis=0) < 0.0)


def test_parts_that_no_level_needs_are_left_out(waves):
    few = Detail.of(waves).first(2)
    assert len(few.levels) == 2
    assert {p for level in few.levels for p in level.parts} == set(range(len(few.parts)))
    assert len(Detail.of(waves, 1).parts) == len(waves.tiles)


@pytest.mark.parametrize("draw", range(4))
def test_an_averaged_sea_is_the_mean_over_a_width_across_the_look(draw):
    """Heights of the averaged field against the mean of the full field's plane waves along a line, for any width and azimuth."""
    random = np.random.default_rng(draw)
    spectrum = ElfouhailySpectrum(float(random.uniform(4.0, 12.0)), 0.7)
    field = WaveField.create(spectrum, plan_tiles(spectrum, 2.0, 128), draw).only(1)
    width, azimuth, time = float(random.uniform(0.5, 30.0)), float(random.uniform(-4.0, 4.0)), float(random.uniform(0.0, 50.0))
    places = random.uniform(-500.0, 500.0, (6, 2))
    order, weight = np.polynomial.legendre.leggauss(400)
    line = 0.5 * width * order[:, None] * np.array([np.cos(azimuth), -np.sin(azimuth)])

    def heights(waves, at):
        east, north, frequency, real, imaginary = waves.plane_waves()[0].T
        turn = np.exp(1j * (at[..., :1] * east + at[..., 1:] * north - frequency * time))
        return ((real + 1j * imaginary) * turn).sum(axis=-1).real

    along = np.array([np.average(heights(field, place + line), weights=weight) for place in places])
    averaged = field.averaged(width, azimuth)
    assert heights(averaged, places) == pytest.approx(along, abs=2e-5 * np.sqrt(field.height_variance))


def test_an_averaged_sea_has_the_statistics_of_its_waves(waves):
    """Slope variances and covariance about the wind, which an oblique look makes asymmetric, from the plane waves alone."""
    field = waves.only(1)
    seas = np.array([_slopes(field.reseeded(seed).averaged(20.0, 0.3)) for seed in range(40)])
    made = field.averaged(20.0, 0.3)
    error = seas.std(axis=0, ddof=1) / np.sqrt(len(seas))
    assert np.all(np.abs(seas.mean(axis=0) - [*made.resolved_mss(), made.resolved_covariance()]) < 4.0 * error)
    assert abs(made.resolved_covariance()) > 5.0 * error[2]
    assert field.resolved_covariance() == 0.0


def _slopes(field):
    """Slope variances along and across the wind, and their covariance, of the plane waves of one tile."""
    east, north, _, real, imaginary = field.plane_waves()[0].T
    s, c = np.sin(field.spectrum.wind_to_azimuth), np.cos(field.spectrum.wind_to_azimuth)
    power, along, across = 0.5 * (real**2 + imaginary**2), east * s + north * c, east * c - north * s
    return [float(np.sum(power * a * b)) for a, b in ((along, along), (across, across), (along, across))]


def test_averaged_levels_share_the_tiles_that_they_leave_alone(waves):
    """Long waves hardly change over half a metre: their tiles are the same in all levels; a width of 0 leaves a level as it is."""
    detail = Detail.of(waves)
    chosen = detail.averaged((0, 0, 1), (0.0, 0.5, 0.5), 0.3)
    assert [level.parts for level in chosen.levels] == [(0, 1, 2), (0, 1, 3), (0, 1, 4)]
    assert chosen.levels[0].mss == detail.levels[0].mss
    assert [level.shortest_wave for level in chosen.levels] == [detail.levels[n].shortest_wave for n in (0, 0, 1)]
    assert sum(chosen.levels[1].mss) < sum(detail.levels[0].mss)
    assert chosen.parts[0].surfaces(3.0)[0].tobytes() == detail.parts[0].surfaces(3.0)[0].tobytes()
