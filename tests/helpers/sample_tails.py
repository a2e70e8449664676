"""Tails of samples without a detector."""

from __future__ import annotations

import numpy as np

from seaglint.clutter.false_alarms import FalseAlarms
from seaglint.clutter.thresholds import standardise
from seaglint.detection.rare_alarms import LOWEST_THRESHOLD, RareTail, rare_tail


def tail_of(values: np.ndarray, seed: int = 0) -> tuple[RareTail, float, float]:
    """Tail of an image or of frames (k, rows, columns), and the mean and standard deviation of its thresholds' scale."""
    frames = values.reshape((1,) * (3 - values.ndim) + values.shape)
    mean, sigma = float(frames.mean()), float(frames.std())
    alarms = FalseAlarms((LOWEST_THRESHOLD,))
    alarms.add(standardise(frames - mean, scope="sequence", scale=(0.0, sigma)))
    return rare_tail(alarms.curve(), alarms.events(LOWEST_THRESHOLD), seed=seed), mean, sigma
