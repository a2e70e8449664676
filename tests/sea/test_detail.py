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
