"""Bound waves: the equations of motion to second order, sums over pairs, moments of drawn seas, crests, and records at one place."""

import numpy as np
import pytest
from scipy.stats import skew

from seaglint.base.constants import GRAVITY
from seaglint.base.errors import DomainError
from seaglint.scenario.load import parse_scenario
from seaglint.sea.second_order import bound_coefficients, bound_limit, bound_skewness, lattice_weights, pair_weights
from seaglint.sea.spectra import ElfouhailySpectrum, JonswapSpectrum, PiersonMoskowitzSpectrum
from seaglint.sea.tiles import SHORTEST_SPAN, Tile, longest_wave_number, plan_tiles
from seaglint.sea.wave_field import Detail, WaveField
from seaglint.sea.wave_record import WaveRecord
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.waves_and_slopes import slopes
from seaglint.studies.sequence.sea_export import export_sea

STORM = JonswapSpectrum(7.0, 11.0, 0.0, 3.3, np.radians(30.0))
SEAS = {
    "Pierson and Moskowitz": PiersonMoskowitzSpectrum(10.0),
    "Elfouhaily": ElfouhailySpectrum(10.0),
    "narrow": JonswapSpectrum(7.0, 11.0, 0.0, 3.3, np.radians(10.0)),
    "broad": JonswapSpectrum(7.0, 11.0, 0.0, 3.3, np.radians(45.0)),
}


def half_amplitudes(top: int, waves: dict[tuple[int, int], complex]) -> tuple[np.ndarray, np.ndarray]:
    """Forward and backward half amplitudes of waves by their lattice numbers (towards u, v)."""
    forward, backward = np.zeros((2, 2 * top + 1, top + 1), np.complex64)
    for (p, q), a in waves.items():
        if p < 0:
            backward[-q, -p] = 0.5 * a
        else:
            forward[q, p] = 0.5 * a
    return forward, backward


def heights(coefficients: np.ndarray, points: int) -> np.ndarray:
    """Heights [m, (points, points)] of coefficients in FFT order."""
    top = coefficients.shape[1] - 1
    whole = np.zeros((points, points // 2 + 1), np.complex128)
    whole[np.concatenate([np.arange(top + 1), np.arange(-top, 0)]), : top + 1] = coefficients
    return np.fft.irfft2(whole, (points, points), norm="forward")


@pytest.mark.parametrize(("p", "q"), [(3, 0), (0, 2), (2, -3), (-3, 1)])
def test_one_wave_has_stokes_s_harmonic(p, q):
    step, a = 0.05, 1.3 * np.exp(0.7j)
    k = step * np.hypot(p, q)
    angle = 2.0 * np.pi * np.arange(32) / 32
    psi = p * angle + q * angle[:, None] + 0.7
    z = heights(bound_coefficients(*half_amplitudes(4, {(p, q): a}), step), 32)
    # single precision of the transforms
    np.testing.assert_allclose(z, 0.5 * k * abs(a) ** 2 * np.cos(2.0 * psi), atol=1e-6)


def test_lattices_sum_over_pairs_in_any_direction():
    step = 0.1
    waves = {(3, 2): 0.6 + 0.2j, (4, -1): 0.4 - 0.4j, (-2, -1): 0.3j, (0, -3): 0.2 + 0.1j, (-3, -2): 0.5}
    angle = 2.0 * np.pi * np.arange(40) / 40
    expected = np.zeros((40, 40))
    for (p1, q1), a1 in waves.items():
        for (p2, q2), a2 in waves.items():
            k1, k2 = step * np.hypot(p1, q1), step * np.hypot(p2, q2)
            plus, minus = lattice_weights(k1, k2, step**2 * (p1 * p2 + q1 * q2) / (k1 * k2))
            one, two = (a * np.exp(1j * (p * angle + q * angle[:, None])) for (p, q), a in (((p1, q1), a1), ((p2, q2), a2)))
            expected += (plus * one * two + minus * one * np.conj(two)).real
    found = heights(bound_coefficients(*half_amplitudes(5, waves), step), 40)
    np.testing.assert_allclose(found, expected - expected.mean(), atol=1e-6 * np.abs(expected).max() * 10)
    assert abs(found.mean()) < 1e-7


@pytest.mark.parametrize("angle", [0.3, 1.0, 2.0, 3.0])
@pytest.mark.parametrize("ratio", [0.2, 0.7, 0.999])
def test_pairs_fulfil_the_conditions_at_the_surface(ratio, angle):
    """Kinematic and dynamic condition at second order, on deep water, solved for sum and difference wave."""
    k = np.array([[0.1, 0.0], [0.1 * ratio * np.cos(angle), 0.1 * ratio * np.sin(angle)]])
    size = np.hypot(*k.T)
    omega = np.sqrt(GRAVITY * size)
    grid = 2.0 * np.pi * np.arange(16) / 16
    psi = np.stack(np.meshgrid(grid, grid, indexing="ij"))
    cos, sin = np.cos(psi), np.sin(psi)
    # potential (omega/k) exp(k z) sin psi of unit waves: derivatives at z = 0
    along = np.einsum("i,ix,iab->xab", omega / size, k, cos)
    up, bend = np.einsum("i,iab->ab", omega, sin), np.einsum("i,iab->ab", omega * size, sin)
    falling = np.einsum("i,iab->ab", -(omega**2), cos)
    height, slope = cos.sum(axis=0), -np.einsum("ix,iab->xab", k, sin)
    kinematic = height * bend - (along * slope).sum(axis=0)
    dynamic = -0.5 * ((along**2).sum(axis=0) + up**2) - height * falling
    weights = pair_weights(*size, np.cos(angle))
    for sign, weight in zip((1.0, -1.0), weights, strict=True):
        phase = psi[0] + sign * psi[1]
        total, rate = float(np.hypot(*(k[0] + sign * k[1]))), omega[0] + sign * omega[1]
        right = [2.0 * np.mean(kinematic * np.sin(phase)), 2.0 * np.mean(dynamic * np.cos(phase))]
        amplitude = np.linalg.solve([[rate, -total], [GRAVITY, -rate]], right)[0]
        # an ordered pair has half of it
        assert float(weight) == pytest.approx(0.5 * amplitude, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("cosine", [1.0, -1.0])
def test_weights_of_lattices_are_exact_along_one_line(cosine):
    k = np.geomspace(0.01, 1.0, 7)
    for found, exact in zip(lattice_weights(k, 0.1234, cosine), pair_weights(k, 0.1234, cosine), strict=True):
        np.testing.assert_allclose(found, exact, atol=1e-9)


def test_weights_of_lattices_have_the_third_moment_of_pairs():
    """Measured: 0.9 % (Pierson and Moskowitz), 1.1 % (Elfouhaily), 1.1 % at 10 deg, 3.3 % at 45 deg."""
    for name, sea in SEAS.items():
        limit = bound_limit(sea)
        assert bound_skewness(sea, limit, exact=False) == pytest.approx(bound_skewness(sea, limit), rel=0.04 if name == "broad" else 0.015)


def test_skewness_of_one_direction_is_the_integral_of_the_lesser_wavenumber():
    """3 int int min(k, k') S S dk dk' = 3 int (energy above k)^2 dk."""
    sea = JonswapSpectrum(7.0, 11.0, 0.0, 3.3, np.radians(1.5))
    top = 20.0 * sea.peak_wavenumber
    k = np.geomspace(sea.wavenumber_range[0], top, 400)
    above = np.array([sea.height_variance(top, float(low)) for low in k])
    one_way = 3.0 * (np.trapezoid(above**2, k) + k[0] * above[0] ** 2) / sea.height_variance() ** 1.5
    # midpoints of 96 wavenumbers
    assert bound_skewness(sea, top) == pytest.approx(one_way, rel=0.01)


def field_of(sea, seed=0, n=128, shortest=None):
    """Second-order sea on its first tile."""
    limit = bound_limit(sea)
    tiles = plan_tiles(sea, 2.0 * np.pi / (3.0 * limit) if shortest is None else shortest, n, bound=limit)
    return WaveField.create(sea, tiles, seed, bound=limit)


@pytest.mark.validation
@pytest.mark.parametrize("name", SEAS)
def test_drawn_seas_have_the_skewness_of_pairs(name):
    """Mean of 60 seas of one tile; bound: three standard errors of the mean, some 4 % of the skewness, plus the lattice's weights."""
    sea = SEAS[name]
    field = field_of(sea)
    first = field.only(0)
    limit = min(field.bound[0], field.tiles[0].k_max)
    third, second, slope = [], [], []
    for seed in range(60):
        one = first.reseeded(seed)
        whole, free = (one.surfaces(37.0)[0].astype(np.float64), one.linear().surfaces(37.0)[0].astype(np.float64))
        # Gaussian heights have a third moment of 0 in the mean: as a control variate they halve the error
        third.append(np.mean(whole[..., 0] ** 3) - np.mean(free[..., 0] ** 3))
        second.append(np.mean(whole[..., 0] ** 2) / np.mean(free[..., 0] ** 2))
        slope.append(np.mean(whole[..., 1:] ** 2) / np.mean(free[..., 1:] ** 2))
        assert abs(whole[..., 0].mean()) < 1e-4
    found = np.array(third) / sea.height_variance() ** 1.5
    error = float(found.std(ddof=1) / np.sqrt(found.size))
    assert error < 0.06 * float(found.mean())
    assert abs(float(found.mean()) - bound_skewness(sea, limit, exact=False)) < 3.0 * error
    # measured: 0.3 to 0.5 % of the height variance, 2 to 3 % of the first tile's slope variance, 1.4 % at most of the geometry's
    assert 1.0 < float(np.mean(second)) < 1.01
    assert 1.0 < float(np.mean(slope)) < 1.04


@pytest.mark.parametrize("name", SEAS)
def test_slope_variance_of_the_geometry_changes_by_less_than_two_percent(name):
    field = field_of(SEAS[name], shortest=2.0, n=256)
    first = field.only(0)
    added = []
    for seed in range(4):
        one = first.reseeded(seed)
        added.append(np.mean(one.surfaces(0.0)[0][..., 1:] ** 2) - np.mean(one.linear().surfaces(0.0)[0][..., 1:] ** 2))
    assert 0.0 < 2.0 * float(np.mean(added)) < 0.02 * sum(field.resolved_mss())


@pytest.mark.validation
def test_crests_follow_tayfun_in_a_narrow_sea():
    """Exceedance of crests by Tayfun 1980 with the steepness of the skewness: counts within three standard deviations of theirs."""
    sea = JonswapSpectrum(5.0, 11.0, 0.0, 20.0, np.radians(1.5))
    limit = 2.5 * sea.peak_wavenumber
    steepness = bound_skewness(sea, limit) / 3.0
    crests, free = [], []
    for seed in range(12):
        record = WaveRecord.draw(sea, seed, 9216, 0.78125, hertz=(0.03, 0.4), bound=limit)
        for z, out in ((record.second_order, crests), (record.linear, free)):
            z = (z - z.mean()) / np.sqrt(sea.height_variance())
            starts = np.flatnonzero((z[:-1] < 0.0) & (z[1:] >= 0.0))
            out.extend(np.maximum.reduceat(z, starts))
    for level in (1.5, 2.0, 2.5, 3.0):
        gaussian = (np.sqrt(1.0 + 2.0 * steepness * level) - 1.0) / steepness
        expected = len(crests) * np.exp(-0.5 * gaussian**2)
        found = int(np.sum(np.array(crests) > level))
        # neighbouring waves of a narrow sea are of one group: counts scatter like those of a third as many
        assert abs(found - expected) < 3.0 * np.sqrt(3.0 * expected), (level, found, expected)
        assert found > int(np.sum(np.array(free) > level))


def test_a_linear_sea_is_the_second_order_one_without_its_bound_waves():
    field = field_of(STORM)
    plain = WaveField.create(STORM, field.tiles, 0)
    for one, other, whole in zip(field.linear().coefficients(5.0), plain.coefficients(5.0), field.coefficients(5.0), strict=True):
        np.testing.assert_array_equal(one, other)
        assert whole.shape == one.shape
    # only the longest tile has them
    assert [limit > 0.0 for limit in field.bound] == [True] + [False] * (len(field.tiles) - 1)
    assert field.resolved_mss() == plain.resolved_mss()
    np.testing.assert_array_equal(field.steepness(0, 1.0), plain.steepness(0, 1.0))


def test_a_sea_is_a_function_of_seed_and_time():
    field = field_of(STORM, seed=3)
    again = field_of(STORM, seed=1).reseeded(3)
    for one, other in zip(field.surfaces(11.0), again.surfaces(11.0), strict=True):
        np.testing.assert_array_equal(one, other)
    # a time between does not matter
    before = field.surfaces(11.0)[0]
    field.surfaces(12.0)
    np.testing.assert_array_equal(field.surfaces(11.0)[0], before)


def test_a_mean_over_a_width_is_the_mean_of_the_bound_waves_too():
    tile = Tile(1500.0, 256, 0.0, 0.0, 0.1)
    field = WaveField.create(STORM, (tile,), 2, bound=0.1)
    width = 60.0
    whole = field.surfaces(4.0)[0][..., 0].astype(np.float64)
    # towards azimuth 0, north, the line of the mean lies along east: columns
    wavenumber = np.fft.rfftfreq(tile.n, tile.spacing) * 2.0 * np.pi
    expected = np.fft.irfft(np.fft.rfft(whole, axis=1) * np.sinc(wavenumber * width / (2.0 * np.pi)), tile.n, axis=1)
    found = field.averaged(width, 0.0)
    assert np.std(expected - whole) > 0.05
    np.testing.assert_allclose(found.surfaces(4.0)[0][..., 0], expected, atol=1e-4)
    np.testing.assert_allclose(found.reseeded(9).surfaces(4.0)[0], field.reseeded(9).averaged(width, 0.0).surfaces(4.0)[0], atol=1e-5)


def test_each_level_of_detail_has_the_bound_waves_of_its_own_waves():
    field = field_of(STORM)
    detail = Detail.of(field)
    parts = [part for part in detail.parts if part.bound[0] > 0.0]
    assert len(parts) > 1
    skewness = []
    for part in parts:
        whole, free = part.surfaces(7.0)[0][..., 0].astype(np.float64), part.linear().surfaces(7.0)[0][..., 0].astype(np.float64)
        skewness.append(np.mean(whole**3) - np.mean(free**3))
        # two sums of transforms: single precision
        spectrum = np.abs(np.fft.rfft2(whole - free))
        n = part.tiles[0].n
        assert spectrum[n // 4 + 2 : n - n // 4 - 1].max() < 1e-4 * spectrum.max()
    assert all(value > 0.0 for value in skewness)
    assert skewness == sorted(skewness, reverse=True)


def test_tiles_make_room_for_bound_waves():
    limit = bound_limit(STORM)
    for n in (256, 512):
        linear, tiles = plan_tiles(STORM, 2.0, n), plan_tiles(STORM, 2.0, n, bound=limit)
        assert tiles[0].n == 2 * n
        assert tiles[-1].k_max == linear[-1].k_max
        assert tiles[0].k_max >= min(limit, linear[0].k_max) or tiles[0].length < 1.1 * SHORTEST_SPAN * 2 * np.pi / longest_wave_number(
            STORM
        )
    # a short range of waves is one tile, if enough of its longest waves fit
    assert len(plan_tiles(STORM, 2.0 * np.pi / (1.2 * limit), 128, bound=limit)) == 2
    assert len(plan_tiles(STORM, 2.0 * np.pi / (1.2 * limit), 512, bound=limit)) == 1


def test_records_have_the_skewness_of_pairs_and_a_buoy_has_less():
    limit = bound_limit(STORM)
    records = [WaveRecord.draw(STORM, seed, 4096, 0.78125, hertz=(1.0 / 30.0, 0.5), bound=limit) for seed in range(12)]
    free, fixed, moving, buoy = (
        np.array([skew(getattr(record, name)) for record in records]) for name in ("linear", "second_order", "moving", "buoy")
    )
    error = 3.0 * float(free.std(ddof=1)) / np.sqrt(len(records))
    expected = bound_skewness(STORM, limit)
    assert abs(float(np.mean(fixed - free)) - expected) < 0.15 * expected
    assert abs(float(free.mean())) < error
    # the set-up of groups replaces the harmonics, and a buoy does not record it
    assert float(np.mean(moving - free)) == pytest.approx(expected, rel=0.25)
    assert abs(float(np.mean(buoy - free))) < 0.35 * expected


def test_records_refuse_frequencies_that_they_do_not_sample():
    with pytest.raises(DomainError, match=r"give .* to 0\.64 Hz"):
        WaveRecord.draw(STORM, 0, 512, 1.0 / 1.28, hertz=(0.03, 0.7), bound=0.1)


def test_a_scenario_selects_bound_waves_and_reports_their_skewness():
    tables = {"render": {"tile_size": 128}, "sea": {"shortest_wave_m": 4.0}, "wind": {"speed_m_s": 10.0}}
    linear = parse_scenario(tables)
    second = parse_scenario({**tables, "sea": {**tables["sea"], "nonlinear": "second-order"}})
    assert linear.sea.nonlinear == "linear"
    reports = [scenario_physics.sea(scenario, slopes(scenario)).report for scenario in (linear, second)]
    assert "height_skewness" not in reports[0]
    assert 0.05 < reports[1]["height_skewness"] < reports[1]["height_skewness_of_all_bound_waves"] < 0.2
    exported = [export_sea(scenario, 2.0, extent=(800.0, 800.0), spacing=4.0).patch_surface[..., 0] for scenario in (linear, second)]
    assert skew(exported[1].ravel()) > 0.03
