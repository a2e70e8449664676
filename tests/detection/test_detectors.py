"""Detectors behind one interface: what each claims of itself holds, and each does what its formula says."""

from __future__ import annotations

import itertools
from contextlib import nullcontext

import numpy as np
import pytest
from scipy.linalg import toeplitz
from scipy.special import ndtr
from scipy.stats import norm
from scipy.stats import t as student

from seaglint.base.errors import DataError, DomainError
from seaglint.clutter.filters import TopHat, autocovariance
from seaglint.detection.detector_names import NAMES
from seaglint.detection.interface import Detector, Frames
from seaglint.detection.matched import LocalMatched, Matched, whitened
from seaglint.detection.named_detectors import named, named_for
from seaglint.detection.patch_image import robust_components
from seaglint.detection.spatial import Chain, DirectionalBackground, FilterThreshold, laplacian_of_gaussian
from seaglint.detection.spot import GaussianSpot
from seaglint.detection.temporal import TemporalProfile, TrackBeforeDetect

SPOT = GaussianSpot(0.8)
SIGNATURE = SPOT.stamps(np.zeros((1, 2)))[0]


@pytest.fixture(scope="module")
def frames() -> Frames:
    return np.random.default_rng(2).normal(10.0, 1.0, (18, 48, 56)).astype(np.float32)


@pytest.fixture(scope="module", params=NAMES)
def detector(request: pytest.FixtureRequest, frames: Frames) -> Detector:
    return named_for(request.param, SPOT, lambda: frames)


def test_what_a_detector_says_of_itself_holds(detector: Detector, frames: Frames) -> None:
    if detector.name == "integration":
        pytest.skip("registers frames, which claims nothing and takes long")
    window = frames[: detector.lead + 1]
    statistic = detector(window)
    assert isinstance(detector, Detector)
    assert statistic.shape == (1, 48, 56)
    assert np.isfinite(statistic).any()
    if detector.reach is not None:
        changed = window.copy()
        changed[-1, 24, 28] += 20.0
        moved = np.abs(np.nan_to_num(detector(changed) - statistic))[0] > 1e-4
        rows, columns = np.nonzero(moved)
        assert moved.any()
        assert max(np.abs(rows - 24).max(), np.abs(columns - 28).max()) <= detector.reach
    other = np.random.default_rng(3).normal(0.0, 2.0, window.shape).astype(np.float32)
    additive = np.allclose(detector(window + other), statistic + detector(other), atol=1e-3, equal_nan=True)
    assert additive == detector.linear


def test_a_filter_before_a_detector_adds_its_reach(frames: Frames) -> None:
    chain = Chain(TopHat(), DirectionalBackground("mean"))
    assert (chain.reach, chain.linear, chain.lead) == (8, False, 0)
    assert np.array_equal(chain(frames[:2]), DirectionalBackground("mean")(TopHat().apply(frames[:2])))


def test_white_matched_filter_gains_the_energy_of_the_object() -> None:
    noise = np.random.default_rng(4).normal(0.0, 3.0, (6, 200, 200)).astype(np.float32)
    matched = Matched(SIGNATURE)
    object_alone = np.zeros((1, 31, 31), np.float32)
    object_alone[0, 11:20, 11:20] = SIGNATURE
    gain = float(matched(object_alone)[0, 15, 15]) / float(matched(noise)[:, 8:-8, 8:-8].std())
    # 200 000 pixels, a twelfth of them independent: 1 %.
    assert gain == pytest.approx(np.sqrt((SIGNATURE**2).sum()) / 3.0, rel=0.02)


def test_covariance_of_a_known_process_gives_its_deflection() -> None:
    # Separable first-order autoregression: C^-1 is known in closed form along each axis, tridiagonal.
    rho, side = 0.7, SIGNATURE.shape[0]
    lags = rho ** np.abs(np.arange(1 - side, side))
    covariance = 4.0 * np.outer(lags, lags)
    inverse = np.diag([1.0, *[1.0 + rho**2] * (side - 2), 1.0]) - rho * (np.eye(side, k=1) + np.eye(side, k=-1))
    inverse /= 1.0 - rho**2
    energy = np.einsum("ij,ik,kl,jl->", SIGNATURE, inverse, SIGNATURE, inverse) / 4.0
    assert (SIGNATURE * whitened(SIGNATURE, covariance)).sum() == pytest.approx(energy, rel=2e-6)
    h = Matched(SIGNATURE, covariance).weights.ravel()
    matrix = 4.0 * np.kron(toeplitz(rho ** np.arange(side)), toeplitz(rho ** np.arange(side)))
    assert h @ SIGNATURE.ravel() == pytest.approx(1.0, rel=1e-9)
    assert 1.0 / np.sqrt(h @ matrix @ h) == pytest.approx(np.sqrt(energy), rel=1e-6)


def test_local_covariance_evens_out_two_kinds_of_clutter() -> None:
    clutter = np.random.default_rng(5).normal(0.0, 1.0, (8, 96, 192)).astype(np.float32)
    clutter[:, :, 96:] *= 7.0
    statistic = LocalMatched(SIGNATURE, clutter, tile=96)(clutter)
    assert statistic[:, 8:-8, 8:88].std() == pytest.approx(1.0, abs=0.03)
    assert statistic[:, 8:-8, 104:-8].std() == pytest.approx(1.0, abs=0.03)
    with pytest.raises(DomainError, match="at least 27"):
        LocalMatched(SIGNATURE, clutter, tile=20)


def test_laplacian_of_gaussian_answers_spots_of_its_own_size_and_no_slope() -> None:
    log = FilterThreshold(laplacian_of_gaussian(1.5))
    sizes = np.array([0.8, 1.2, 1.5, 2.0, 3.0])
    answers = []
    for size in sizes:
        axis = np.arange(-20, 21)
        spot = np.exp(-(axis[:, None] ** 2 + axis**2) / (2 * size**2))
        answers.append(float(log(spot[None].astype(np.float32))[0, 20, 20]))
    assert sizes[int(np.argmax(answers))] == 1.5
    slope = np.add.outer(2.0 * np.arange(41), 3.0 * np.arange(41)).astype(np.float32)
    assert abs(float(log(slope[None])[0, 20, 20])) < 1e-3


@pytest.mark.parametrize("kind", ["mean", "median"])
def test_directional_background_passes_a_spot_and_no_edge(kind: str) -> None:
    edge = np.where(np.arange(40) < 20, 0.0, 5.0) * np.ones((40, 1))
    edge[10, 30] += 3.0
    out = DirectionalBackground(kind, size=9)(edge[None].astype(np.float32))[0]  # type: ignore[arg-type]
    assert out[10, 30] == pytest.approx(3.0 if kind == "median" else 3.0 * 8 / 9, rel=1e-6)
    assert out[25, 15:25].max() <= 0.0


def test_temporal_profile_keeps_its_promise_and_finds_what_appears() -> None:
    noise = np.random.default_rng(6).normal(3.0, 2.0, (9, 300, 300)).astype(np.float32)
    profile = TemporalProfile(count=8)
    z = profile(noise)
    assert profile.lead == 8
    # 90 000 independent pixels: 0.0228 within 3.3 standard errors of 0.0005.
    assert (z > 2.0).mean() == pytest.approx(float(ndtr(-2.0)), abs=0.0017)
    noise[-1, 7, 7] += 40.0
    assert profile(noise)[0, 7, 7] > 4.0


def test_track_before_detect_follows_a_moving_point() -> None:
    frames = np.zeros((6, 30, 30), np.float32)
    for k in range(6):
        frames[k, 10 + k // 2, 5 + k] = 2.0
    statistic = TrackBeforeDetect(count=6, speed=1)(frames)[0]
    assert statistic[12, 10] == pytest.approx(6 * 2.0 / np.sqrt(6))
    frames[3, 11, 8] = np.nan
    assert TrackBeforeDetect(count=6, speed=1)(frames)[0, 12, 10] < 6 * 2.0 / np.sqrt(6) - 0.5


def test_robust_components_part_background_and_objects() -> None:
    generator = np.random.default_rng(7)
    background = generator.normal(size=(60, 2)) @ generator.normal(size=(2, 50))
    sparse = np.zeros((60, 50))
    sparse[generator.integers(0, 60, 40), generator.integers(0, 50, 40)] = 6.0
    low, found = robust_components(background + sparse)
    assert np.abs(found - sparse).max() < 0.01
    assert np.linalg.matrix_rank(low, tol=1e-2) == 2


def test_estimated_covariance_of_white_noise_is_the_white_filter(frames: Frames) -> None:
    estimated = Matched(SIGNATURE, autocovariance(frames, 8)).weights
    white = Matched(SIGNATURE).weights
    assert np.abs(estimated - white).max() < 0.15 * white.max()


def test_names_that_need_a_shape_and_names_there_are_not() -> None:
    with pytest.raises(DataError, match="shape of the object"):
        named("matched")
    with pytest.raises(DataError, match="unknown; choose ca-cfar"):
        named_for("radar", SPOT, lambda: np.empty((0, 1, 1), np.float32))


@pytest.mark.parametrize(("count", "guard"), [(3, 0), (6, 2)])
def test_temporal_profile_is_the_prediction_interval_of_a_past(count: int, guard: int) -> None:
    """Student's t of the latest value against the mean of those before the guard, as a Gaussian deviation."""
    frames = np.random.default_rng(3).normal(5.0, 2.0, (count + guard + 2, 6, 7)).astype(np.float32)
    found = TemporalProfile(count=count, guard=guard)(frames)
    for k in range(2):
        past, latest = frames[k : k + count].astype(float), frames[k + count + guard]
        t = (latest - past.mean(axis=0)) / (past.std(axis=0, ddof=1) * np.sqrt((count + 1.0) / count))
        np.testing.assert_allclose(found[k], norm.isf(student.sf(t, count - 1)), atol=2e-3)


def test_tracks_are_the_best_of_all_ways() -> None:
    """Three frames, every way of at most a pixel a step one by one; none through a missing pixel."""
    frames = np.random.default_rng(4).normal(size=(3, 5, 6)).astype(np.float32)
    frames[1, 2, 2] = np.nan
    best = np.full((5, 6), -np.inf)
    steps = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    for y, x in np.ndindex(5, 6):
        for (a, b), (c, d) in itertools.product(steps, steps):
            way = [(2, y, x), (1, y + a, x + b), (0, y + a + c, x + b + d)]
            if all(0 <= row < 5 and 0 <= column < 6 for _, row, column in way):
                total = sum(float(frames[place]) for place in way)
                best[y, x] = max(best[y, x], -np.inf if np.isnan(total) else total)
    np.testing.assert_allclose(TrackBeforeDetect(count=3, speed=1)(frames)[0], best / np.sqrt(3.0), rtol=1e-5)


@pytest.mark.parametrize(
    ("make", "allowed"),
    [
        (lambda: TrackBeforeDetect(count=2, speed=0), True),
        (lambda: TrackBeforeDetect(count=1, speed=1), False),
        (lambda: TrackBeforeDetect(count=2, speed=-1), False),
        (lambda: TemporalProfile(count=3, guard=0), True),
        (lambda: TemporalProfile(count=2), False),
        (lambda: TemporalProfile(count=3, guard=-1), False),
    ],
)
def test_counts_of_frames_have_a_least_value(make, allowed: bool) -> None:
    with nullcontext() if allowed else pytest.raises(DomainError):
        make()
