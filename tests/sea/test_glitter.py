"""Covariance of short waves, lit share of boxes, and specular points: closed forms against sums, drawn patches and counting."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from seaglint.sea.dispersion import angular_frequency
from seaglint.sea.glitter.lit_share import Clusters, LitShare, disc_in_slopes
from seaglint.sea.glitter.short_waves import ShortWaves
from seaglint.sea.glitter.specular_points import curvature_moments, mean_determinant, specular_points
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic
from seaglint.sea.spectra import ElfouhailySpectrum, JonswapSpectrum

SUN = 2.3e-3  #: Radius of the Sun's disc in slopes near the nadir [1].


def drawn_slopes(spectrum, band, n, step, rng, times=(0.0,)):
    """Slopes towards east and north of a patch of n x n points, waves of a band alone, at times; an own synthesis."""
    q = 2.0 * np.pi * np.fft.fftfreq(n, step)
    east, north = np.meshgrid(q, q, indexing="ij")
    k = np.hypot(east, north)
    energy = np.where((k >= band[0]) & (k < band[1]), spectrum.density(east, north), 0.0)
    amplitude = np.sqrt(energy) * 2.0 * np.pi / (n * step) * (rng.standard_normal((n, n)) + 1j * rng.standard_normal((n, n)))
    turn = angular_frequency(np.where(k > 0.0, k, 1.0))
    for time in times:
        heights = amplitude * np.exp(-1j * turn * time) * n * n
        yield np.fft.ifft2(1j * east * heights).real, np.fft.ifft2(1j * north * heights).real


def blocks(values, size):
    n = values.shape[0] // size
    return values[: n * size, : n * size].reshape(n, size, n, size).mean((1, 3))


@pytest.mark.parametrize("wind", [3.0, 7.0, 15.0])
@pytest.mark.parametrize("swell", [False, True])
def test_variances_are_the_spectrums(wind: float, swell: bool) -> None:
    spectrum = JonswapSpectrum(1.0, 6.0, 0.8, wind_to_azimuth=0.2) if swell else ElfouhailySpectrum(wind, 0.2)
    waves = ShortWaves.of_spectrum(spectrum, 0.0)
    both, covariance = spectrum.mss(), spectrum.slope_covariance()
    assert sum(waves.variances) == pytest.approx(sum(both), rel=1e-6)
    # about its principal axis a sea has the largest variance, and no covariance
    radius = math.hypot(0.5 * (both[0] - both[1]), covariance)
    assert waves.variances[0] == pytest.approx(0.5 * sum(both) + radius, rel=1e-6)
    if not swell:
        assert waves.to_azimuth == 0.2


@pytest.mark.parametrize("direction", [0.0, 0.4, 1.3, 2.9])
@pytest.mark.parametrize("distance", [0.0, 0.003, 0.05, 0.4])
def test_covariance_is_the_integral_over_the_spectrum(distance: float, direction: float) -> None:
    """Bessel functions against the sum over wavenumbers and directions of the spectrum itself."""
    spectrum, band = ElfouhailySpectrum(8.0), (20.0, 900.0)
    waves = ShortWaves.of_spectrum(spectrum, *band)
    k = np.exp(np.linspace(*np.log(band), 4001))
    k = np.sqrt(k[1:] * k[:-1])[:, None]
    angle = 2.0 * np.pi * (np.arange(720) + 0.5) / 720
    energy = (
        k**4 * math.log(band[1] / band[0]) / k.size * spectrum.omnidirectional(k) / k * spectrum.spreading(k, angle) * 2.0 * np.pi / 720
    )
    wave = energy * np.cos(k * distance * np.cos(angle - direction))
    expected = [np.sum(wave * part) for part in (np.cos(angle) ** 2, np.cos(angle) * np.sin(angle), np.sin(angle) ** 2)]
    # bands of a tenth of a decade are means over their width: a per cent of the variance where many turn
    np.testing.assert_allclose(waves.covariance(distance, direction), expected, atol=0.01 * sum(waves.variances))


def test_both_ways_to_the_covariance_agree_at_one_time() -> None:
    waves = ShortWaves.of_spectrum(ElfouhailySpectrum(8.0), 10.0)
    distance, direction = np.array([1e-4, 0.01, 0.1, 0.5]), np.array([0.0, 0.7, 2.0])
    moving = waves.moving_covariance(distance, direction, np.zeros(1))[:, :, 0]
    np.testing.assert_allclose(moving, waves.covariance(distance, direction[:, None]), atol=0.01 * sum(waves.variances))


def test_waves_travel_downwind() -> None:
    """At a later time the same slopes are found where the waves have gone."""
    waves = ShortWaves.of_spectrum(ElfouhailySpectrum(8.0), 20.0, 30.0)
    speed = float(np.mean(waves.frequency / waves.wavenumber))
    times, ahead = np.array([0.1]), np.array([0.1 * speed])
    down, up = (waves.moving_covariance(ahead, np.array([turn]), times)[0, 0, 0, 0] for turn in (0.0, math.pi))
    assert down > 0.7 * waves.variances[0]
    assert up < 0.3 * waves.variances[0]


@pytest.mark.parametrize("box", [(0.1, 0.1), (0.5, 0.05), (3.0, 1.0)])
def test_mean_slope_of_a_box(box: tuple[float, float]) -> None:
    """The covariance of a box is the mean of covariances over all pairs of its points."""
    waves = ShortWaves.of_spectrum(ElfouhailySpectrum(8.0), 8.0, 60.0)
    x, y = ((np.arange(-200, 200) + 0.5) / 200 * side for side in box)
    weight = np.outer(1.0 - np.abs(x) / box[0], 1.0 - np.abs(y) / box[1]) / 40_000
    lags = waves.covariance(np.hypot(x[:, None], y), np.arctan2(y, x[:, None]))
    expected = np.sum(weight[:, :, None] * lags, axis=(0, 1))
    # the box of many waves keeps a thousandth of their variance, and bands are as wide as above
    np.testing.assert_allclose(waves.mean_covariance(box, 0.0, np.zeros(1))[0], expected, atol=2e-3 * sum(waves.variances))


@pytest.mark.parametrize("radius", [1e-5, SUN, 0.03])
@pytest.mark.parametrize("slope", [(0.0, 0.0), (0.1, -0.05)])
@pytest.mark.parametrize("longer", [(0.0, 0.0, 0.0), (0.004, 0.001, 0.002)])
def test_limits_of_pairs(radius: float, slope: tuple[float, float], longer: tuple[float, float, float]) -> None:
    lit = LitShare((0.01, 0.0, 0.006), longer, slope, radius)
    same = float(lit.pairs(np.array(lit.short)))
    # a place and itself: the chance of one, within what a disc as wide as half of the slopes takes from their density
    assert same * lit.chance == pytest.approx(1.0, rel=1e-3 if radius < 0.01 else 0.2)
    if not any(longer):
        assert lit.unrelated == pytest.approx(1.0, rel=1e-9)
    else:
        assert lit.unrelated > 1.0


@pytest.mark.parametrize(("view", "sun", "azimuth"), [(0.0, 0.0, 0.0), (0.3, 0.9, 2.0), (1.4, 1.2, 2.8), (1.5, 1.3, 3.14)])
def test_disc_in_slopes_has_the_area_of_its_image(view: float, sun: float, azimuth: float) -> None:
    """Slopes that mirror the rim of a disc in the sky: the area of their polygon."""
    radius, turn = 4.65e-3, np.linspace(0.0, 2.0 * np.pi, 721)
    sight = np.array([np.sin(view), 0.0, np.cos(view)])
    middle = np.array([np.sin(sun) * np.cos(azimuth), np.sin(sun) * np.sin(azimuth), np.cos(sun)])
    aside = np.cross(middle, [0.3, 0.5, -0.8])
    aside /= np.linalg.norm(aside)
    rim = middle * np.cos(radius) + np.sin(radius) * (np.cos(turn)[:, None] * aside + np.sin(turn)[:, None] * np.cross(middle, aside))
    normal = rim + sight
    x, y = -normal[:, 0] / normal[:, 2], -normal[:, 1] / normal[:, 2]
    area = 0.5 * abs(float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1])))
    half = middle + sight
    cosine = 0.5 * float(np.linalg.norm(half))
    # 1e-4 by the finite disc, some per cent where the mirror is tilted by a small vertical component
    assert math.pi * float(disc_in_slopes(radius, half[2] / (2.0 * cosine), cosine)) ** 2 == pytest.approx(area, rel=0.02)


def test_chance_is_the_integral_over_the_disc() -> None:
    slopes = cox_munk_anisotropic(7.0, 0.0)
    lit = LitShare((slopes.mss_up, 0.0, slopes.mss_cross), (0.0, 0.0, 0.0), (0.12, 0.05), 0.02)
    r, a = (np.arange(100) + 0.5) / 100 * 0.02, 2.0 * np.pi * (np.arange(64) + 0.5) / 64
    along, across = 0.12 + r[:, None] * np.cos(a), 0.05 + r[:, None] * np.sin(a)
    expected = np.sum(slopes.density(across, along) * r[:, None]) * 0.02 / 100 * 2.0 * np.pi / 64
    assert lit.chance == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("steepness", [0.0, 1.0, 2.5])
@pytest.mark.parametrize("side", [0.003, 0.03, 0.3, 3.0])
def test_linear_part_does_not_matter(steepness: float, side: float) -> None:
    """Taking the linear part in the spectrum changes nothing where the integral over lags can do without."""
    clusters = Clusters(ShortWaves.of_spectrum(ElfouhailySpectrum(7.0), 12.0))
    lit = clusters.lit(steepness, 0.3, SUN)
    lags, turns = np.geomspace(2e-6, 2.0 * side, 6000), np.pi * (np.arange(24) + 0.5) / 24
    pairs = lit.pairs(clusters.waves.covariance(lags, turns[:, None])) - lit.unrelated
    box = [np.clip(1.0 - np.abs(lags * f(turns)[:, None]) / side, 0.0, None) for f in (np.cos, np.sin)]
    direct = 2.0 * np.pi * math.log(lags[1] / lags[0]) * np.mean(np.sum(pairs * box[0] * box[1] * lags**2, axis=1)) / side**2
    excess = lit.pairs(clusters.waves.covariance(clusters.lags, clusters.turns[:, None])) - lit.unrelated
    assert excess.shape == (clusters.turns.size, clusters.lags.size)
    mean = np.mean([_one(clusters, steepness, math.pi * i / 4, side, SUN) for i in range(4)])
    # one weight for each direction of the lags, or its mean over their sector
    assert clusters.variance(steepness, SUN, (side, side)) == pytest.approx(mean, rel=5e-3)
    assert _one(clusters, steepness, 0.3, side, SUN) == pytest.approx(direct, rel=0.03, abs=1e-4)


@pytest.mark.parametrize("box", [(10.0, 0.1), (100.0, 0.1), (0.1, 10.0), (3.0, 0.01)])
@pytest.mark.parametrize("steepness", [0.0, 2.0])
def test_long_pixels(box: tuple[float, float], steepness: float) -> None:
    """A pixel at a grazing angle is a hundred times as long as wide: directions that are dense along its length."""
    clusters = Clusters(ShortWaves.of_spectrum(ElfouhailySpectrum(7.0), 3.0))
    lags, turns = clusters.lags, np.pi * (np.arange(2880) + 0.5) / 2880
    excess, linear = clusters.pairs(steepness, SUN, clusters.waves.covariance(lags, turns[:, None]))
    weight = [np.clip(1.0 - np.abs(lags * f(turns)[:, None]) / side, 0.0, None) for f, side in zip((np.cos, np.sin), box, strict=True)]
    inner = 2.0 * np.pi * math.log(lags[1] / lags[0]) * np.sum(weight[0] * weight[1] * lags**2 * excess) / (turns.size * box[0] * box[1])
    expected = float(inner + clusters.waves.mean_covariance(box, 0.0, np.zeros(1))[0] @ linear)
    assert clusters.variance(steepness, SUN, box) == pytest.approx(expected, rel=0.02)


def _one(clusters: Clusters, steepness: float, turn: float, side: float, radius: float) -> float:
    """Variance for one direction of the mirroring slope, by the linear part."""
    lit = clusters.lit(steepness, turn, radius)
    covariance = clusters.waves.covariance(clusters.lags, clusters.turns[:, None])
    excess = lit.pairs(covariance) - lit.unrelated - covariance @ lit.linear
    weight = [np.clip(1.0 - np.abs(clusters.lags * f(clusters.turns)[:, None]) / side, 0.0, None) for f in (np.cos, np.sin)]
    step = math.log(clusters.lags[1] / clusters.lags[0])
    inner = 2.0 * np.pi * step * np.sum(weight[0] * weight[1] * clusters.lags**2 * excess) / (clusters.turns.size * side**2)
    return float(inner + clusters.waves.mean_covariance((side, side), 0.0, np.zeros(1))[0] @ lit.linear)


@pytest.mark.validation
@pytest.mark.parametrize("wind", [4.0, 10.0])
def test_variance_of_boxes_on_drawn_patches(wind: float) -> None:
    """Counting lit points of patches on a 1 mm lattice: the closed form summed over the lattice's own lags, within 10 %."""
    spectrum, band, n, step = ElfouhailySpectrum(wind, 0.5 * np.pi), (30.0, 1500.0), 1024, 1e-3
    clusters, rng = Clusters(ShortWaves.of_spectrum(spectrum, *band)), np.random.default_rng(3)
    cases = {(u, radius): clusters.lit(u, 0.6, radius) for u in (0.0, 1.0, 2.0) for radius in (SUN, 0.01)}
    sizes, patches = (4, 16, 64), 24
    counted = {case: np.zeros((patches, 1 + len(sizes))) for case in cases}
    for i in range(patches):
        (east, north), *_ = drawn_slopes(spectrum, band, n, step, rng)
        for case, lit in cases.items():
            # across the wind is to the right of it: south of a wind that blows to the east
            shown = ((east - lit.slope[0]) ** 2 + (north + lit.slope[1]) ** 2 < lit.radius**2).astype(np.float32)
            counted[case][i] = [shown.mean(), *((blocks(shown, size) ** 2).mean() for size in sizes)]
    for case, lit in cases.items():
        mean = counted[case].mean(axis=0)
        share = mean[0]
        error = counted[case][:, 0].std() / math.sqrt(patches) / share
        assert lit.chance == pytest.approx(share, rel=0.02 + 4.0 * error)
        for size, square in zip(sizes, mean[1:], strict=True):
            i = np.arange(-size + 1, size)
            along, across = np.meshgrid(i * step, i * step, indexing="ij")
            pairs = lit.pairs(clusters.waves.covariance(np.hypot(along, across), np.arctan2(across, along))) - lit.unrelated
            pairs[size - 1, size - 1] = 1.0 / lit.chance - 1.0  # a point and itself
            weight = np.outer(1.0 - np.abs(i) / size, 1.0 - np.abs(i) / size) / size**2
            spread = (counted[case][:, 1:].std(axis=0) / math.sqrt(patches))[sizes.index(size)] / square
            assert np.sum(weight * pairs) == pytest.approx(square / share**2 - 1.0, rel=0.1 + 3.0 * spread)


@pytest.mark.validation
def test_variance_of_boxes_below_a_millimetre() -> None:
    """On a lattice of 0.2 mm glints are areas, not points: the integral over lags itself, within 10 %."""
    spectrum, band, n, step = ElfouhailySpectrum(6.0, 0.5 * np.pi), (120.0, 900.0), 1024, 2e-4
    clusters, rng = Clusters(ShortWaves.of_spectrum(spectrum, *band)), np.random.default_rng(5)
    sizes, patches, radius = (8, 32, 128), 30, 0.01
    counted = []
    for _ in range(patches):
        (east, north), *_ = drawn_slopes(spectrum, band, n, step, rng)
        shown = (east**2 + north**2 < radius**2).astype(np.float32)
        counted.append([shown.mean(), *((blocks(shown, size) ** 2).mean() for size in sizes)])
    share, *squares = np.mean(counted, axis=0)
    for size, square in zip(sizes, squares, strict=True):
        assert clusters.variance(0.0, radius, (size * step, size * step)) == pytest.approx(square / share**2 - 1.0, rel=0.1)


@pytest.mark.parametrize("steepness", [0.0, 1.5])
def test_correlation_in_time_is_the_sum_over_pairs_of_points(steepness: float) -> None:
    """A sum over the lags of a square on an even lattice, and over all waves of the spectrum, at three times."""
    spectrum, band, side, n = ElfouhailySpectrum(7.0), (20.0, 60.0), 0.15, 40
    clusters, radius = Clusters(ShortWaves.of_spectrum(spectrum, *band)), 0.03
    x = (np.arange(-n, n) + 0.5) * side / n
    weight = np.outer(1.0 - np.abs(x) / side, 1.0 - np.abs(x) / side)
    k = np.exp(np.linspace(*np.log(band), 121))
    k = np.sqrt(k[1:] * k[:-1])[:, None]
    angle = 2.0 * np.pi * (np.arange(72) + 0.5) / 72
    energy = k**4 * math.log(band[1] / band[0]) / k.size * spectrum.omnidirectional(k) / k * spectrum.spreading(k, angle) * 2.0 * np.pi / 72
    parts = [energy * part for part in (np.cos(angle) ** 2, np.cos(angle) * np.sin(angle), np.sin(angle) ** 2)]
    lit = [clusters.lit(steepness, math.pi * i / 4, radius) for i in range(4)]
    chosen = [0, 9, 11, 13]
    sums = []
    for time in clusters.times[chosen]:
        # exp(i k.x) is a product of both coordinates
        along, across = np.exp(1j * k[..., None] * np.cos(angle)[:, None] * x), np.exp(1j * k[..., None] * np.sin(angle)[:, None] * x)
        turn = np.exp(-1j * angular_frequency(k) * time)
        covariance = np.stack([np.einsum("ka,kax,kay->xy", part * turn, along, across, optimize=True).real for part in parts], axis=-1)
        sums.append(np.mean([np.sum(weight * (one.pairs(covariance) - one.unrelated)) for one in lit]))
    found = clusters.correlation(steepness, radius, (side, side))[chosen]
    # the lattice of 4 mm is coarse for the first lag, 1 % of the sum
    np.testing.assert_allclose(found, np.array(sums) / sums[0], atol=0.03)
    below = int(np.flatnonzero(clusters.correlation(steepness, radius, (side, side)) < math.exp(-1.0))[0])
    assert clusters.times[below - 1] < clusters.correlation_time(steepness, radius, (side, side)) < clusters.times[below]


@pytest.mark.validation
def test_correlation_in_time_on_drawn_patches() -> None:
    """Boxes of drawn patches at two times, on a lattice finer than glints: the correlation of the closed form, within 0.06."""
    spectrum, band, n, step = ElfouhailySpectrum(7.0, 0.5 * np.pi), (30.0, 800.0), 1024, 5e-4
    clusters, rng, radius, size = Clusters(ShortWaves.of_spectrum(spectrum, *band)), np.random.default_rng(11), 0.02, 128
    lit = [clusters.lit(1.0, np.pi * i / 4, radius) for i in range(4)]
    chosen = [0, 4, 7, 9, 10, 11, 12]
    sums = np.zeros((4, len(chosen)))
    for _ in range(24):
        first = None
        for t, (east, north) in enumerate(drawn_slopes(spectrum, band, n, step, rng, clusters.times[chosen])):
            shares = np.array([blocks(((east - s.slope[0]) ** 2 + (north + s.slope[1]) ** 2 < radius**2).astype(float), size) for s in lit])
            shares = shares - np.array([s.chance for s in lit])[:, None, None]
            first = shares if first is None else first
            sums[:, t] += np.mean(first * shares, axis=(1, 2))
    counted = np.mean(sums / np.array([s.chance for s in lit])[:, None] ** 2, axis=0)
    expected = clusters.correlation(1.0, radius, (size * step, size * step))[chosen]
    # 1500 boxes of 6 cm, a few of them related: the standard error of a correlation is 0.02
    np.testing.assert_allclose(expected, counted / counted[0], atol=0.06)


def test_mean_determinant_of_an_isotropic_sea() -> None:
    """Longuet-Higgins 1960: 4/sqrt(3) times the mixed variance; a sea of one direction has no determinant."""
    assert mean_determinant(3.0, 3.0, 1.0) == pytest.approx(4.0 / math.sqrt(3.0), rel=1e-6)
    assert mean_determinant(3.0e4, 3.0e4, 1.0e4) == pytest.approx(4.0e4 / math.sqrt(3.0), rel=1e-6)
    assert mean_determinant(3.0, 1e-3, 1e-3) < 0.1


@pytest.mark.parametrize("moments", [(5.0, 2.0, 1.2), (3.0, 3.0, 1.0), (10.0, 1.0, 0.9)])
def test_mean_determinant_of_draws(moments: tuple[float, float, float]) -> None:
    along, across, mixed = moments
    root = np.linalg.cholesky(np.array([[along, mixed, 0.0], [mixed, across, 0.0], [0.0, 0.0, mixed]]))
    x = root @ np.random.default_rng(1).standard_normal((3, 400_000))
    # a million draws of a quantity whose deviation is 1.5 times its mean
    assert mean_determinant(*moments) == pytest.approx(float(np.mean(np.abs(x[0] * x[1] - x[2] ** 2))), rel=0.012)


def test_specular_points_are_counted() -> None:
    """Triangles of a fine lattice whose slopes surround the mirroring slope, against the closed form."""
    spectrum, band, n, step = ElfouhailySpectrum(7.0, 0.5 * np.pi), (60.0, 400.0), 512, 1e-3
    waves, rng = ShortWaves.of_spectrum(spectrum, *band), np.random.default_rng(2)
    lit = Clusters(waves).lit(0.8, 0.0, SUN)
    found = 0
    for _ in range(6):
        (east, north), *_ = drawn_slopes(spectrum, band, n, step, rng)
        corners = [np.roll(np.stack([east - lit.slope[0], north]), (-a, -b), axis=(1, 2)) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        for triangle in ((0, 1, 2), (0, 2, 3)):
            a, b, c = (corners[i] for i in triangle)
            signs = [p[0] * q[1] - p[1] * q[0] > 0.0 for p, q in ((a, b), (b, c), (c, a))]
            found += int(np.sum((signs[0] == signs[1]) & (signs[1] == signs[2])))
    area = 6 * (n * step) ** 2
    points = specular_points(waves, lit)
    # some 900 points; the lattice has 16 cells in the shortest wave
    assert points.number == pytest.approx(found / area, rel=4.0 / math.sqrt(found) + 0.02)
    assert points.area == pytest.approx(lit.chance / points.number, rel=1e-12)


def test_dwell_is_a_fraction_of_a_millisecond() -> None:
    """Slope rates of 7 to 20 1/s leave a point lit for a fraction of a millisecond (a wave moves under a point faster than it changes)."""
    waves = ShortWaves.of_spectrum(ElfouhailySpectrum(7.0), 0.0, 1000.0)
    rate = math.sqrt(0.5 * float(np.sum((waves.up + waves.cross) * waves.frequency**2)))
    assert 5.0 < rate < 20.0
    assert 1e-4 < specular_points(waves, Clusters(waves).lit(0.0, 0.0, SUN)).dwell < 1e-3


def test_curvatures_of_one_wavenumber() -> None:
    waves = ShortWaves(np.array([100.0]), np.array([0.01]), np.array([0.01]), 0.01, 0.0)
    along, across, mixed = curvature_moments(waves)
    assert along == across == pytest.approx(3.0 * mixed)
    assert along + across + 2.0 * mixed == pytest.approx(0.02 * 100.0**2)


@pytest.mark.parametrize("wind", [0.5, 3.0, 12.0])
def test_pixels_fluctuate_less_the_larger_they_are(wind: float) -> None:
    clusters = Clusters(ShortWaves.of_spectrum(ElfouhailySpectrum(wind), 3.0))
    for steepness in (0.0, 1.0, 3.0, 6.0):
        values = [clusters.variance(steepness, SUN, (side, side)) for side in (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)]
        assert all(0.0 < small < large for large, small in pairwise(values))
