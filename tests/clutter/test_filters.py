"""Filters: what they remove, what they keep, and the same result by another route."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import convolve

from seaglint.base.errors import DataError, DomainError
from seaglint.clutter import filters
from seaglint.clutter.filters import DifferenceOfGaussians, Filter, Kernel, Laplacian, MatchedFilter, MedianSubtraction, TopHat

BLOB = np.exp(-0.5 * (np.add.outer(np.arange(-3, 4) ** 2, np.arange(-3, 4) ** 2)) / 0.8**2)
ALL = [
    Laplacian(),
    DifferenceOfGaussians(),
    MedianSubtraction(),
    TopHat(),
    MatchedFilter(BLOB),
    Kernel([[0, -1, 0], [0, 2, 0], [0, -1, 0]]),
]


@pytest.fixture
def noise() -> np.ndarray:
    return np.random.default_rng(11).standard_normal((3, 40, 50)).astype(np.float32)


@pytest.mark.parametrize("f", ALL, ids=lambda f: f.name)
@pytest.mark.parametrize("level", [0.1, 293.15, 40000.0])
def test_constant_gives_exactly_nothing(f: Filter, level: float) -> None:
    assert isinstance(f, Filter)
    assert not f.apply(np.full((2, 24, 26), level, np.float32)).any()


@pytest.mark.parametrize("f", ALL, ids=lambda f: f.name)
def test_bright_point_is_positive_and_largest_where_it_is(f: Filter) -> None:
    frames = np.full((1, 41, 43), 5.0, np.float32)
    frames[0, 20, 17] += 3.0
    assert np.unravel_index(np.argmax(f.apply(frames)), frames.shape) == (0, 20, 17)


@pytest.mark.parametrize("f", ALL, ids=lambda f: f.name)
def test_frames_do_not_mix_and_missing_stays_near(f: Filter, noise: np.ndarray) -> None:
    whole = f.apply(noise)
    assert np.array_equal(whole[1], f.apply(noise[1])[0])
    holed = noise.copy()
    holed[0, 20, 25] = np.nan
    out = f.apply(holed)
    assert np.isnan(out[0, 20, 25])
    far = np.ones((40, 50), bool)
    far[20 - f.margin : 21 + f.margin, 25 - f.margin : 26 + f.margin] = False
    assert np.array_equal(out[0][far], whole[0][far])
    assert np.isfinite(out[1:]).all()


def test_laplacian_is_the_five_point_stencil_with_repeated_borders(noise: np.ndarray) -> None:
    weights = np.array([[[0, -1, 0], [-1, 4, -1], [0, -1, 0]]], float)
    # Sums of five single-precision numbers of order 1 in another order.
    assert Laplacian().apply(noise) == pytest.approx(convolve(noise.astype(float), weights, mode="nearest"), abs=3e-6)


@pytest.mark.parametrize("shape", [(1, 5), (5, 1), (1, 1), (2, 2)])
def test_laplacian_of_thin_images(shape: tuple[int, int]) -> None:
    x = np.random.default_rng(1).integers(0, 9, shape).astype(np.float32)
    weights = np.array([[0, -1, 0], [-1, 4, -1], [0, -1, 0]], float)
    assert np.array_equal(Laplacian().apply(x)[0], convolve(x.astype(float), weights, mode="nearest"))


def test_laplacian_multiplies_a_wave_by_its_transfer_function() -> None:
    k = 2 * np.pi / 8
    wave = np.tile(np.cos(k * np.arange(64)), (64, 1)).astype(np.float32)
    inner = np.s_[0, 2:-2, 2:-2]
    assert Laplacian().apply(wave)[inner] == pytest.approx((2 - 2 * np.cos(k)) * wave[None][inner], abs=1e-6)


def test_top_hat_keeps_small_and_removes_wide() -> None:
    x = np.zeros((1, 40, 40), np.float32)
    x[0, 10, 10] = 2.0
    x[0, 20:30, 20:30] = 7.0
    out = TopHat(5).apply(x)
    assert out[0, 10, 10] == 2.0
    assert not out[0, 18:32, 18:32].any()


def test_median_subtraction_passes_a_straight_edge_unseen() -> None:
    x = np.zeros((1, 30, 30), np.float32)
    x[0, :, 15:] = 9.0
    assert not MedianSubtraction(5).apply(x).any()


@pytest.mark.parametrize("correlated", [False, True])
def test_matched_filter_measures_amplitude_on_any_level(correlated: bool) -> None:
    clutter = np.random.default_rng(5).standard_normal((4, 90, 90))
    covariance = filters.autocovariance(convolve(clutter, np.ones((1, 3, 3))), 6) if correlated else None
    f = MatchedFilter(BLOB, covariance)
    x = np.full((1, 31, 31), 280.0, np.float32)
    x[0, 12:19, 10:17] += (4.0 * BLOB).astype(np.float32)
    assert f.apply(x)[0, 15, 13] == pytest.approx(4.0, rel=1e-4)  # 280 in single precision holds 3e-5
    assert f.weights.sum() == pytest.approx(0.0, abs=1e-9)


def test_whitened_matched_filter_has_the_best_signal_to_noise() -> None:
    """Gauss-Markov: on the clutter it was made for no other unbiased linear filter has a smaller spread of amplitude."""
    generator = np.random.default_rng(6)

    def clutter() -> np.ndarray:
        return convolve(generator.standard_normal((6, 120, 120)), np.ones((1, 3, 3)) / 3, mode="wrap").astype(np.float32)

    white, whitened = MatchedFilter(BLOB), MatchedFilter(BLOB, filters.autocovariance(clutter(), 6))
    other = clutter()
    # Here four times smaller; a filter that ignored the covariance would be equal.
    assert whitened.apply(other).std() < 0.7 * white.apply(other).std()


def test_autocovariance_of_a_moving_average() -> None:
    """White noise summed over 3 x 3 pixels: 9 - a triangle in each direction."""
    x = convolve(np.random.default_rng(7).standard_normal((40, 100, 100)), np.ones((1, 3, 3)), mode="wrap")
    x[3, 10:20, 10:20] = np.nan
    triangle = np.array([0, 1, 2, 3, 2, 1, 0.0])
    # 4e5 pixels, 4.4e4 independent: 4 sigma of the variance are 4 sqrt(2 / 4.4e4) of 9.
    assert filters.autocovariance(x, 3) == pytest.approx(np.outer(triangle, triangle), abs=0.25)


@pytest.mark.parametrize("name", ["laplacian", "dog", "difference-of-gaussians", "median", "TOP_HAT", "none"])
def test_names(name: str) -> None:
    assert filters.named(name).name in filters.NAMES


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: filters.named("sobel"), "laplacian"),
        (lambda: Kernel(np.ones((2, 3))), "odd"),
        (lambda: Kernel(np.zeros((3, 3))), "not all zero"),
        (lambda: DifferenceOfGaussians(2.0, 1.0), "inner < outer"),
        (lambda: MedianSubtraction(4), "odd"),
        (lambda: MatchedFilter(np.ones((3, 3))), "not all equal"),
        (lambda: MatchedFilter(BLOB, np.ones((3, 3))), "reach = 6"),
        (lambda: filters.as_frames(np.zeros((1, 2, 3, 4))), "shape"),
        (lambda: filters.autocovariance(np.zeros((5, 5)), 5), "1 to 4"),
    ],
)
def test_unusable_input_is_said(make, says: str) -> None:
    with pytest.raises((DataError, DomainError), match=says) as error:
        make()
    assert "\n" not in str(error.value)
