"""Samples against the covariances they were made from, loops without a seam, bytes that threads do not change."""

from __future__ import annotations

import numba
import numpy as np
import pytest
from scipy.fft import irfftn, rfftn

from seaglint.base.errors import DomainError
from seaglint.textures.gauss_markov import GaussMarkov, covariance
from seaglint.textures.gaussian_texture import GaussianTexture
from seaglint.textures.marginals import Marginal
from seaglint.textures.synthesis import Modulation, latent, slow

FIELD = GaussMarkov(((0, 0, 1), (0, 1, 0), (1, 0, 1), (1, 0, 0), (0, 1, 1)), (0.12, 0.1, 0.15, 0.05, 0.02), 1.3)
SLOW = Modulation(1.0, (2.0, 3.0, 3.0))


def mean_covariance(fields: np.ndarray) -> np.ndarray:
    """Circular covariance by distance, mean over samples (samples, frames, rows, columns), means known to be 0."""
    power = np.abs(rfftn(fields, axes=(1, 2, 3))) ** 2
    return irfftn(power.mean(axis=0), s=fields.shape[1:]) / np.prod(fields.shape[1:])


@pytest.mark.parametrize("slow_field", [None, SLOW], ids=["gaussian", "product"])
@pytest.mark.parametrize("shape", [(4, 8, 8), pytest.param((5, 9, 7), marks=pytest.mark.validation)], ids=["even", "odd"])
def test_samples_have_the_covariances_of_the_field(shape: tuple[int, int, int], slow_field: Modulation | None) -> None:
    """Space and time at once, 400 samples: the Monte Carlo error of a covariance, from blocks of 20, is passed by 5 nowhere."""
    fields = np.stack([latent(FIELD, shape, seed, slow_field) for seed in range(400)])
    blocks = np.stack([mean_covariance(fields[k : k + 20]) for k in range(0, 400, 20)])
    wanted = covariance(FIELD, shape)
    error = blocks.std(axis=0, ddof=1) / np.sqrt(len(blocks))
    assert np.abs((blocks.mean(axis=0) - wanted / wanted[0, 0, 0]) / error).max() < 5.0


@pytest.mark.validation
def test_the_slow_field_is_gamma_distributed_with_mean_1() -> None:
    power = np.stack([slow(Modulation(0.5, (1.0, 2.0, 2.0)), (4, 64, 64), seed) for seed in range(40)]).astype(float)
    assert power.mean() == pytest.approx(1.0, abs=0.02)
    assert power.var() == pytest.approx(2.0, rel=0.08)  # 1 / shape


def test_threads_change_no_byte(monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    for threads in (1, 2, 3):
        monkeypatch.setattr("seaglint.textures.synthesis._threads", lambda n=threads: n)
        found.append([latent(FIELD, (6, 30, 61), 1, m).tobytes() for m in (None, SLOW)])
    assert found[0] == found[1] == found[2]
    assert numba.get_num_threads() >= 1


def features(first: np.ndarray, second: np.ndarray) -> list[float]:
    """What a detector of seams looks at in two frames that follow each other."""
    step = second - first
    return [float(np.corrcoef(first.ravel(), second.ravel())[0, 1]), float(step.std()), float(np.abs(step).max()), float((step**4).mean())]


def pairs(frames: np.ndarray) -> tuple[list[float], list[float]]:
    """Features of the seam, last frame and first, and of an ordinary step."""
    return features(frames[-1], frames[0]), features(frames[3], frames[4])


def test_a_seam_detector_does_no_better_than_chance() -> None:
    """Trained on sequences that are cut and begin again, it sees their seams; on loops it is a coin (3 deviations of 400)."""
    field = GaussMarkov(((1, 0, 0), (0, 0, 1), (0, 1, 0)), (0.36, 0.05, 0.05), 1.0)
    texture = GaussianTexture(field, Marginal("gamma", 0.0, 1.0, 2.0))
    loops = [texture.sample((16, 24, 24), seed) for seed in range(200)]
    cut = np.array([pairs(loop[:9]) for loop in loops])
    seams, steps = cut[:100, 0], cut[:100, 1]
    spread = np.linalg.inv(0.5 * (np.cov(seams.T) + np.cov(steps.T)))
    direction, middle = spread @ (seams.mean(axis=0) - steps.mean(axis=0)), 0.5 * (seams.mean(axis=0) + steps.mean(axis=0))

    def right(found: np.ndarray) -> float:
        score = (found - middle) @ direction
        return float(0.5 * ((score[:, 0] > 0.0).mean() + (score[:, 1] <= 0.0).mean()))

    assert right(cut[100:]) > 0.95
    whole = np.array([pairs(loop) for loop in loops])
    assert abs(right(whole) - 0.5) < 3.0 * 0.5 / np.sqrt(2 * len(loops))


def test_neighbours_that_do_not_fit_are_refused() -> None:
    with pytest.raises(DomainError, match="give at least 3 x 3 x 3"):
        latent(FIELD, (2, 8, 8), 0)
    with pytest.raises(DomainError, match="above 0"):
        Modulation(-1.0, (1.0, 1.0, 1.0))
