"""Synthesised seas: Parseval against the spectrum's integrals, a direct sum of sines, motion, reproducibility."""

import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.sea.dispersion import angular_frequency
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic, cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import flat
from seaglint.sea.spectra import CombinedSpectrum, ElfouhailySpectrum, JonswapSpectrum, MeasuredSpectrum, PiersonMoskowitzSpectrum
from seaglint.sea.tiles import Tile, longest_wave_number, plan_tiles, resolve_limit
from seaglint.sea.wave_field import WaveField, _cell_variance

WIND_TO = np.radians(60.0)
SEA = ElfouhailySpectrum(10.0, WIND_TO)
SHORTEST = 0.5
ENSEMBLE_TOLERANCE = 0.02  # what the project promises for heights and slope variances


def up_and_cross(surfaces, wind_to):
    """Slope variances along and across the wind, averaged over the lattices and summed over tiles."""
    up = cross = 0.0
    for surface in surfaces:
        east, north = surface[..., 1].astype(float), surface[..., 2].astype(float)
        up += np.mean((east * np.sin(wind_to) + north * np.cos(wind_to)) ** 2)
        cross += np.mean((east * np.cos(wind_to) - north * np.sin(wind_to)) ** 2)
    return up, cross


def variance(surfaces):
    return sum(np.mean(surface[..., 0].astype(float) ** 2) for surface in surfaces)


@pytest.mark.parametrize("n", [256, *(pytest.param(n, marks=pytest.mark.validation) for n in (512, 1024))])
@pytest.mark.parametrize("sea", [SEA, PiersonMoskowitzSpectrum(12.0, 4.0)])
def test_energy_on_the_lattice_is_that_of_the_spectrum(sea, n):
    """Ensemble values, which the realisations below are checked against; no trace of n."""
    tiles = plan_tiles(sea, SHORTEST, n)
    field = WaveField.create(sea, tiles, 1)
    top = tiles[-1].k_max
    assert field.significant_height == pytest.approx(4 * np.sqrt(sea.height_variance(top)), rel=2e-3)  # midpoint sums over cells
    assert field.resolved_mss() == pytest.approx(sea.mss(top), rel=3e-3)


@pytest.mark.parametrize(("n", "seeds"), [(256, 60), *(pytest.param(*p, marks=pytest.mark.validation) for p in ((512, 16), (1024, 5)))])
def test_realisations_have_the_variances_of_the_spectrum(n, seeds):
    tiles = plan_tiles(SEA, SHORTEST, n)
    field = WaveField.create(SEA, tiles, 0)
    results = []
    for seed in range(seeds):
        surfaces = field.reseeded(seed).surfaces(10.0 * seed)
        results.append((variance(surfaces), *up_and_cross(surfaces, WIND_TO)))
    mean = np.mean(results, axis=0)
    standard_error = np.std(results, axis=0, ddof=1) / np.sqrt(seeds) / mean
    # tests the test: were the ensemble too small, agreement within 2 % would say nothing
    assert np.all(standard_error < [0.025, 0.01, 0.01])
    assert 4 * np.sqrt(mean[0]) == pytest.approx(4 * np.sqrt(SEA.height_variance(tiles[-1].k_max)), rel=ENSEMBLE_TOLERANCE)
    assert mean[1:] == pytest.approx(SEA.mss(tiles[-1].k_max), rel=ENSEMBLE_TOLERANCE)


def test_transform_equals_a_direct_sum_of_travelling_waves():
    """Each wave written out as |a| cos(k.x - omega t + phase) in world coordinates, on a tiny tile."""
    tile = Tile(48.0, 16, 0.4, 0.0, 2 * np.pi * 4 / 48.0)
    field = WaveField.create(ElfouhailySpectrum(3.0, WIND_TO), [tile], 5)
    time = 7.3
    steps = np.arange(tile.n) * tile.spacing
    u, v = np.meshgrid(steps, steps)
    x, y = np.cos(0.4) * u - np.sin(0.4) * v, np.sin(0.4) * u + np.cos(0.4) * v
    height, east, north = np.zeros_like(x), np.zeros_like(x), np.zeros_like(x)
    lattice, amplitudes = field._lattices[0], field._amplitudes[0]
    own = np.ones(lattice.variance.shape, dtype=bool)
    own[lattice.variance.shape[1] :, 0] = False  # these rows repeat the upper half
    waves = 0
    for sign, amplitude in ((1.0, amplitudes.forward), (-1.0, amplitudes.backward)):
        for index in np.argwhere(own & (np.abs(amplitude) > 0.0)):
            j, i = index
            kx, ky, a = sign * lattice.k_east[j, i], sign * lattice.k_north[j, i], 2.0 * complex(amplitude[j, i])
            phase = kx * x + ky * y - angular_frequency(np.hypot(kx, ky)) * time + np.angle(a)
            height += abs(a) * np.cos(phase)
            east += -abs(a) * kx * np.sin(phase)
            north += -abs(a) * ky * np.sin(phase)
            waves += 1
    surface = field.surfaces(time)[0]
    assert waves > 20
    assert surface[..., 0] == pytest.approx(height, abs=1e-5)  # float32 of a sea of metres
    assert surface[..., 1] == pytest.approx(east, abs=1e-6)
    assert surface[..., 2] == pytest.approx(north, abs=1e-6)


def test_slopes_are_the_gradient_of_the_heights():
    tile = plan_tiles(SEA, SHORTEST, 256)[1]
    surface = WaveField.create(SEA, [tile], 3).surfaces(2.0)[0].astype(float)
    q = np.fft.fftfreq(tile.n, 1.0 / tile.n) * tile.step
    spectrum = np.fft.fft2(surface[..., 0])
    along_u = np.fft.ifft2(1j * q[None, :] * spectrum).real
    along_v = np.fft.ifft2(1j * q[:, None] * spectrum).real
    c, s = np.cos(tile.rotation), np.sin(tile.rotation)
    assert surface[..., 1] == pytest.approx(c * along_u - s * along_v, abs=1e-5)
    assert surface[..., 2] == pytest.approx(s * along_u + c * along_v, abs=1e-5)


@pytest.mark.parametrize("wind_to_deg", [60.0, *(pytest.param(w, marks=pytest.mark.validation) for w in (0.0, 245.0))])
def test_waves_travel_downwind(wind_to_deg):
    """-<dz/dt dz/dx> along the wind is the integral of omega k cos(phi) Psi; a standing sea gives 0, an upwind one the negative."""
    sea = ElfouhailySpectrum(8.0, np.radians(wind_to_deg))
    tiles = plan_tiles(sea, 2.0, 256, tiles=2)
    field, step = WaveField.create(sea, tiles, 0), 0.01
    along, across = 0.0, 0.0
    seeds = 12
    for seed in range(seeds):
        realisation = field.reseeded(seed)
        for before, now, after in zip(*(realisation.surfaces(t) for t in (5.0 - step, 5.0, 5.0 + step)), strict=True):
            rate = (after[..., 0].astype(float) - before[..., 0]) / (2 * step)
            s, c = np.sin(sea.wind_to_azimuth), np.cos(sea.wind_to_azimuth)
            along -= np.mean(rate * (now[..., 1] * s + now[..., 2] * c)) / seeds
            across -= np.mean(rate * (now[..., 1] * c - now[..., 2] * s)) / seeds
    angles = (np.arange(360) + 0.5) * (2 * np.pi / 360)

    def flux(k):
        directional = sea.spreading(k[..., None], angles) * np.cos(angles - sea.wind_to_azimuth)
        return angular_frequency(k) * k * sea.omnidirectional(k) * directional.sum(axis=-1) * (2 * np.pi / 360)

    expected = sea.integrate(flux, 0.0, tiles[-1].k_max)
    assert along == pytest.approx(expected, rel=0.05)  # 12 seeds: standard error 1-2 %
    assert abs(across) < 0.05 * expected


def test_a_single_crest_moves_at_its_phase_speed():
    sea = ElfouhailySpectrum(10.0, np.pi / 2)
    tile = plan_tiles(sea, SHORTEST, 256)[0]
    field = WaveField.create(sea, [tile], 2)
    dt = 0.05
    first, second = (np.fft.fft2(field.surfaces(t)[0][..., 0].astype(float)) for t in (0.0, dt))
    q = np.fft.fftfreq(tile.n, 1.0 / tile.n) * tile.step
    ku, kv = np.meshgrid(q, q)
    k_east = np.cos(tile.rotation) * ku - np.sin(tile.rotation) * kv
    # Waves to the east alone live where k_east > 0 well off the edge of the half plane; exp(-i omega t) turns them.
    k = np.hypot(ku, kv)
    strong = (k_east > 0.5 * k) & (np.abs(first) > 0.1 * np.abs(first).max())
    turned = -np.angle(second[strong] / first[strong]) / dt
    assert strong.sum() > 20
    assert turned == pytest.approx(angular_frequency(k[strong]), rel=1e-3)  # float32 coefficients


def test_bytes_depend_on_seed_and_time_alone():
    tiles = plan_tiles(SEA, SHORTEST, 256)
    one = WaveField.create(SEA, tiles, 11)
    expected = [s.tobytes() for s in one.surfaces(3.7, workers=1)]
    one.surfaces(99.0)
    assert [s.tobytes() for s in one.surfaces(3.7, workers=2)] == expected
    assert [s.tobytes() for s in WaveField.create(SEA, tiles, 11).surfaces(3.7)] == expected
    assert [s.tobytes() for s in WaveField.create(SEA, tiles, 12).reseeded(11).surfaces(3.7)] == expected
    assert [s.tobytes() for s in one.reseeded(12).surfaces(3.7)] != expected


def test_surfaces_are_interleaved_float32():
    surface = WaveField.create(SEA, plan_tiles(SEA, 5.0, 128), 0).surfaces(0.0)[0]
    assert surface.shape == (128, 128, 3)
    assert surface.dtype == np.float32
    assert surface.flags.c_contiguous


def test_tiles_of_one_sea_are_independent():
    tiles = plan_tiles(SEA, SHORTEST, 256)
    surfaces = WaveField.create(SEA, tiles, 0).surfaces(0.0)
    normal = [s[..., 0].ravel() / s[..., 0].std() for s in surfaces]
    assert abs(np.mean(normal[1] * normal[2])) < 0.1  # the same seed given to every tile would correlate their lattices


def test_tiles_cover_the_spectrum_once_and_do_not_line_up():
    tiles = plan_tiles(SEA, SHORTEST, 512)
    assert tiles[0].k_min == 0.0
    assert tiles[-1].k_max == pytest.approx(2 * np.pi / SHORTEST)
    assert [t.k_min for t in tiles[1:]] == [t.k_max for t in tiles[:-1]]
    assert tiles[0].length > 6.0 * 2 * np.pi / longest_wave_number(SEA)
    quarter = np.pi / 2
    for i, a in enumerate(tiles):
        for b in tiles[i + 1 :]:
            turn = (a.rotation - b.rotation) % quarter
            assert min(turn, quarter - turn) > np.radians(8.0)
            ratio = a.length / b.length
            assert abs(ratio - round(ratio)) > 0.02


def test_geometry_stops_where_the_slope_model_says():
    slopes = cox_munk_anisotropic(10.0, WIND_TO)
    limit = resolve_limit(SEA, slopes)
    shares = np.divide(SEA.mss(limit), (slopes.mss_up, slopes.mss_cross))
    assert max(shares) == pytest.approx(0.8, rel=1e-4)
    assert resolve_limit(SEA, flat()) == 0.0
    assert resolve_limit(PiersonMoskowitzSpectrum(3.0), cox_munk_isotropic(20.0), 1.0) == PiersonMoskowitzSpectrum(3.0).wavenumber_range[1]
    with pytest.raises(DomainError, match="fraction"):
        resolve_limit(SEA, slopes, 1.5)


def test_too_few_points_for_the_sea_state_are_refused_with_the_length_needed():
    with pytest.raises(DomainError, match="needs"):
        plan_tiles(ElfouhailySpectrum(20.0), 0.1, 64, tiles=2)


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda: plan_tiles(SEA, 1e4, 256), "nothing is left"),
        (lambda: plan_tiles(SEA, -1.0, 256), "shortest wave"),
        (lambda: plan_tiles(SEA, 1.0, 256, tiles=0), "tiles"),
        (lambda: Tile(100.0, 30, 0.0, 0.0, 0.1), "multiple of 4"),
        (lambda: Tile(100.0, 32, 0.0, 0.0, 1.0), "samples"),
        (lambda: Tile(0.0, 32, 0.0, 0.0, 0.1), "length"),
        (lambda: Tile(100.0, 32, 0.0, 0.2, 0.1), "k_min"),
        (lambda: WaveField.create(SEA, [Tile(100.0, 64, 0.0, 0.0, 0.5)], 0), "too short"),
        (lambda: WaveField.create(SEA, [Tile(1000.0, 256, 0.0, 0.0, 0.4), Tile(900.0, 256, 0.3, 0.3, 0.44)], 0), "overlap"),
        (lambda: WaveField.create(SEA, plan_tiles(SEA, 5.0, 128), 0).surfaces(np.nan), "finite"),
    ],
)
def test_impossible_requests_are_refused(call, match):
    with pytest.raises(DomainError, match=match):
        call()


def midpoint_sums(spectrum, tile, p, q, order):
    """Integrals of the spectrum along k and along -k over lattice cells, point by point."""
    offsets = (np.arange(order) + 0.5) / order - 0.5
    c, s = np.cos(tile.rotation) * tile.step, np.sin(tile.rotation) * tile.step
    along, against = np.zeros(p.shape), np.zeros(p.shape)
    for du in offsets:
        for dv in offsets:
            east, north = c * (p + du) - s * (q + dv), s * (p + du) + c * (q + dv)
            k, azimuth = np.hypot(east, north), np.arctan2(east, north)
            inside = (k >= tile.k_min) & (k < tile.k_max) & (k > 0.0)
            safe = np.where(inside, k, tile.k_max)
            level = np.where(inside, spectrum.omnidirectional(safe) / safe, 0.0)
            along += level * spectrum.spreading(safe, azimuth)
            against += level * spectrum.spreading(safe, azimuth + np.pi)
    return along * (tile.step / order) ** 2, against * (tile.step / order) ** 2


@pytest.mark.parametrize("seed", range(6))
def test_cells_are_integrated_together_as_point_by_point(seed):
    """Equal bytes for models, swell, sums of both and a buoy's moments, over random tiles and cells."""
    rng = np.random.default_rng(seed)
    swell = JonswapSpectrum(2.0, 12.0, rng.uniform(0.0, 6.0), wind_to_azimuth=1.0)
    wind_sea = ElfouhailySpectrum(rng.uniform(2.0, 15.0), 1.0)
    f = np.geomspace(0.05, 0.5, 20)
    buoy = MeasuredSpectrum(f, f**-4 * np.exp(-((0.1 / f) ** 4)) * 1e-3, np.full(20, 0.6 + 0.2j), np.full(20, 0.3 + 0.1j), 1.0)
    sea = (wind_sea, PiersonMoskowitzSpectrum(12.0, 4.0), swell, CombinedSpectrum((swell, wind_sea)), buoy, wind_sea)[seed]
    tile = plan_tiles(sea, SHORTEST, 256)[rng.integers(3)]
    p, q = rng.integers(0, 64, 40).astype(float), rng.integers(-64, 64, 40).astype(float)
    for order in (2, 4, 12):
        found, wanted = _cell_variance(sea, tile, p, q, order), midpoint_sums(sea, tile, p, q, order)
        assert [one.tobytes() for one in found] == [one.tobytes() for one in wanted]
