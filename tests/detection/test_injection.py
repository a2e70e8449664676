"""Objects in frames: their shape, their places, and that sharing a frame changes nothing."""

from __future__ import annotations

from contextlib import nullcontext

import numpy as np
import pytest
from scipy.integrate import dblquad

from seaglint.analysis import Recording
from seaglint.base.errors import DataError, DomainError
from seaglint.detection.background import Background
from seaglint.detection.injection import Batch, InjectionPlan, inject, offsets
from seaglint.detection.named_detectors import named_for
from seaglint.detection.spot import GaussianSpot, SampledSpot
from seaglint.detection.trials import LARGEST_CONTRAST, InjectedObjects, run_trials

SPOT = GaussianSpot(0.8)


def recording(frames: np.ndarray, saturation: float | None = None) -> Recording:
    return Recording("test", *frames.shape, lambda start, stop: frames[start:stop], saturation=saturation)


@pytest.fixture(scope="module")
def clutter() -> np.ndarray:
    return np.random.default_rng(1).gamma(3.0, 1.0, (9, 96, 96)).astype(np.float32)


def test_spot_is_the_integral_over_pixels_and_one_where_it_is_centred() -> None:
    sigma, row, column = 0.9, 0.3, -0.4

    def density(x: float, y: float) -> float:
        return float(np.exp(-(x * x + y * y) / (2 * sigma**2)))

    centre = dblquad(density, -0.5, 0.5, -0.5, 0.5)[0]
    pixel = dblquad(density, 1 - 0.5 - column, 1 + 0.5 - column, -2 - 0.5 - row, -2 + 0.5 - row)[0]
    spot = GaussianSpot(sigma)
    stamp = spot.stamps(np.array([[row, column], [0.0, 0.0]]))
    assert stamp[0, spot.half - 2, spot.half + 1] == pytest.approx(pixel / centre, rel=1e-7)
    assert stamp[1, spot.half, spot.half] == pytest.approx(1.0, rel=1e-12)


def test_sampled_spot_moves_as_the_gaussian_does() -> None:
    spot = GaussianSpot(1.2)
    sampled = SampledSpot(3.0 * spot.stamps(np.zeros((1, 2)))[0])
    place = np.array([[0.37, -0.21]])
    moved, wanted = sampled.stamps(place)[0, 1:-1, 1:-1], spot.stamps(place)[0]
    # Cubic splines through samples of a spot of 1.2 px.
    assert moved == pytest.approx(wanted, abs=0.006)
    assert sampled.stamps(np.zeros((1, 2)))[0, sampled.half, sampled.half] == pytest.approx(1.0)


def test_contrast_is_what_a_centred_object_adds_to_its_pixel() -> None:
    frames = np.zeros((2, 20, 20), np.float32)
    inject(frames, Batch(0, np.array([9]), np.array([6]), np.zeros((1, 2))), SPOT, 7.0)
    assert frames[1, 9, 6] == 7.0
    moving = np.zeros((3, 20, 20), np.float32)
    inject(moving, Batch(0, np.array([9]), np.array([12]), np.zeros((1, 2))), SPOT, 7.0, (0.0, 2.0))
    assert [int(np.unravel_index(f.argmax(), f.shape)[1]) for f in moving] == [8, 10, 12]


@pytest.mark.parametrize("name", ["threshold", "matched-local", "ca-cfar", "top-hat", "max-median", "track-before-detect"])
def test_objects_that_share_a_frame_score_as_each_alone(clutter: np.ndarray, name: str) -> None:
    source = recording(clutter)
    detector = named_for(name, SPOT, lambda: clutter)
    background = Background(detector, source)
    threshold = background.threshold(3.0, "sigma")
    objects = InjectedObjects(SPOT, (6.0,), 30, match_radius=1.0, seed=4)
    shared = run_trials(background, source, objects, threshold).scores[0]
    assert np.unique(shared.window).size < 10
    batch = objects.plan(detector, source).batch(0)
    for k in (0, 1, 2):
        window = clutter[batch.window : batch.window + detector.lead + 1].copy()
        inject(window, Batch(batch.window, batch.row[k : k + 1], batch.column[k : k + 1], batch.offset[k : k + 1]), SPOT, 6.0)
        statistic = detector(window)[-1][batch.row[k] - 1 : batch.row[k] + 2, batch.column[k] - 1 : batch.column[k] + 2].astype(float)
        statistic[[0, 0, 2, 2], [0, 2, 0, 2]] = -np.inf  # the corners are farther than the match radius
        mean, sigma = background.scale(batch.window, "sigma")
        here = (shared.row == batch.row[k]) & (shared.column == batch.column[k]) & (shared.window == batch.window)
        assert shared.score[here][0] == pytest.approx((statistic.max() - mean) / sigma, abs=2e-5)


def test_places_are_functions_of_seed_and_number_alone() -> None:
    assert np.array_equal(offsets(3, 4000, 300, "random"), offsets(3, 0, 9000, "random")[4000:4300])
    assert not np.array_equal(offsets(3, 0, 5, "random"), offsets(4, 0, 5, "random"))
    plan = InjectionPlan(5000, 40, 128, 96, 7, 5, "random", 9)
    later = plan.batch(17)
    plan.batch(3)
    again = InjectionPlan(5000, 40, 128, 96, 7, 5, "random", 9).batch(17)
    assert np.array_equal(later.place, again.place)
    assert later.window == again.window


def test_places_are_even_over_frames_and_pixels_and_keep_their_distance() -> None:
    plan = InjectionPlan(40_000, 200, 64, 64, 6, 4, "random", 2)
    batches = [plan.batch(k) for k in range(plan.batches)]
    assert np.bincount([b.window for b in batches], minlength=200).max() <= -(-plan.batches // 200)
    counts = np.zeros((64, 64), int)
    for b in batches:
        np.add.at(counts, (b.row, b.column), 1)
        rows, columns = np.abs(b.row[:, None] - b.row), np.abs(b.column[:, None] - b.column)
        assert (np.maximum(rows, columns) + 99 * np.eye(b.size)).min() >= 6
    inside = counts[4:-4, 4:-4]
    assert counts.sum() == inside.sum()
    # Poisson-like counts of about 13: none of 3136 pixels is left out or has three times its share.
    assert inside.min() > 0
    assert inside.max() < 3 * inside.mean()
    assert np.abs(np.concatenate([b.offset for b in batches])).max() <= 0.5


def test_saturation_cuts_objects_and_is_counted(clutter: np.ndarray) -> None:
    high = float(clutter.max())
    source = recording(clutter, saturation=high)
    background = Background(named_for("threshold", SPOT, lambda: clutter), source)
    threshold = background.threshold(3.0, "sigma")
    trials = run_trials(background, source, InjectedObjects(SPOT, (0.01, 100.0), 200, "centre", 0.0), threshold)
    assert trials.saturated[0] <= 1
    assert trials.saturated[1] == 200
    assert trials.scores[1].score.max() == pytest.approx((high - background.mean) / background.sigma, rel=1e-5)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"contrasts": (0.0,)}, "contrast = 0"),
        ({"contrasts": ()}, "no contrast"),
        ({"contrasts": (1.0,), "velocity": (np.nan, 0.0)}, "velocity"),
    ],
)
def test_objects_that_cannot_be(options: dict, says: str) -> None:
    with pytest.raises(DomainError, match=says):
        InjectedObjects(SPOT, **options)


def test_no_place_for_an_object_is_said(clutter: np.ndarray) -> None:
    holes = np.full((2, 40, 40), np.nan, np.float32)
    holes[:, :3] = np.random.default_rng(1).normal(size=(2, 3, 40))
    source = recording(holes)
    background = Background(named_for("threshold", SPOT, lambda: holes), source)
    with pytest.raises(DataError, match="no pixel with a statistic"):
        run_trials(background, source, InjectedObjects(SPOT, (1.0,), 10), background.threshold(2.0, "sigma"))
    with pytest.raises(DomainError, match="no place for an object"):
        InjectedObjects(GaussianSpot(5.0), (1.0,), 10).plan(background.detector, source)


@pytest.mark.parametrize(
    ("options", "allowed"),
    [
        ({"contrasts": ()}, False),
        ({"contrasts": (1.0, 0.0)}, False),
        ({"contrasts": (np.inf,)}, False),
        ({"contrasts": (LARGEST_CONTRAST, -LARGEST_CONTRAST)}, True),
        ({"contrasts": (1.01 * LARGEST_CONTRAST,)}, False),
        ({"velocity": (50.0, -50.0)}, True),
        ({"velocity": (50.1, 0.0)}, False),
        ({"velocity": (0.0, -50.1)}, False),
        ({"velocity": (np.nan, 0.0)}, False),
        ({"duration": 0}, True),
        ({"duration": -1}, False),
    ],
)
def test_objects_may_reach_their_limits_and_not_pass_them(options: dict, allowed: bool) -> None:
    made = {"shape": GaussianSpot(0.8), "contrasts": (1.0,)} | options
    with nullcontext() if allowed else pytest.raises(DomainError):
        InjectedObjects(**made)
