"""Errors of place against the Cramer-Rao bound and the centroid's own formula."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.detection.spot import GaussianSpot
from seaglint.detection.trials import border_level, centroid, least_squares


def patches(spot: GaussianSpot, contrast: float, number: int, level: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(8)
    place = generator.random((number, 2)) - 0.5
    clean = contrast * spot.stamps(place)
    return place, clean + level + generator.normal(0.0, 1.0, clean.shape)


@pytest.mark.parametrize("sigma", [1.5, 2.5])
def test_bound_of_a_finely_sampled_spot_does_not_depend_on_its_width(sigma: float) -> None:
    # The pixel's average lowers the peak and widens the spot by 1/12 px²: 3 % at 1.5 px, 1 % at 2.5 px.
    assert _bound_at(GaussianSpot(sigma), 50.0, np.zeros(2)) == pytest.approx(np.sqrt(2 / np.pi) / 50.0, rel=0.03)


@pytest.mark.parametrize("sigma", [0.8, 1.5])
def test_least_squares_reaches_the_bound_at_high_contrast(sigma: float) -> None:
    spot = GaussianSpot(sigma)
    place, noisy = patches(spot, 40.0, 3000, level=100.0)
    error = least_squares(noisy, spot) - place
    assert np.isfinite(error).all()
    bound = np.mean([_bound_at(spot, 40.0, p) for p in place[:50]])
    # 6000 values: 0.9 %.
    assert error.std() == pytest.approx(bound, rel=0.1)
    assert np.abs(error.mean(axis=0)).max() < 4 * bound / np.sqrt(3000)


def _bound_at(spot: GaussianSpot, contrast: float, place: np.ndarray) -> float:
    """Mean bound of both coordinates of a displaced object from its Fisher matrix, level and amplitude unknown."""
    h = 1e-4
    down, right = ((spot.stamps(place[None] + s) - spot.stamps(place[None] - s))[0].ravel() / (2 * h) for s in h * np.eye(2))
    s = spot.stamps(place[None])[0].ravel()
    design = np.stack([s, np.ones_like(s), contrast * down, contrast * right], axis=1)
    bound = np.linalg.inv(design.T @ design)
    return float(np.sqrt((bound[2, 2] + bound[3, 3]) / 2))


def test_centroid_follows_its_own_formula_and_not_the_bound() -> None:
    spot = GaussianSpot(0.8)
    generator = np.random.default_rng(9)
    noisy = 60.0 * spot.stamps(np.zeros((4000, 2))) + generator.normal(0.0, 1.0, (4000, 9, 9))
    spread = centroid(noisy).std()
    # 8000 values: 0.8 %.
    axis = np.arange(-spot.half, spot.half + 1)
    own = np.sqrt((axis**2).sum() * axis.size) / (60.0 * spot.stamps(np.zeros((1, 2))).sum())  # sigma sqrt(sum x^2) / sum S
    assert spread == pytest.approx(own, rel=0.03)
    assert spread > 3 * _bound_at(spot, 60.0, np.zeros(2))


def test_centroid_above_a_level_and_without_an_object() -> None:
    spot = GaussianSpot(0.8)
    place = np.array([[0.2, -0.3]])
    raised = 5.0 + 10.0 * spot.stamps(place)
    # The stamp ends four standard deviations from the centre.
    assert centroid(raised, border_level(raised)) == pytest.approx(place, abs=0.01)
    assert np.isnan(centroid(np.full((1, 5, 5), 2.0), 3.0)).all()


def test_a_fit_that_leaves_the_brightest_pixel_is_not_followed() -> None:
    spot = GaussianSpot(0.8)
    assert least_squares(5.0 * spot.stamps(np.array([[0.0, 0.9]])), spot) == pytest.approx(np.array([[0.0, 0.9]]), abs=1e-6)
    assert np.isnan(least_squares(5.0 * spot.stamps(np.array([[0.0, 1.3]])), spot)).all()
