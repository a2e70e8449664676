"""The slanted-edge method of ISO 12233, of the tests' own: a picture of an edge becomes an MTF."""

from __future__ import annotations

import numpy as np

BINS = 4
"""Bins of the edge's profile to a pixel, as the standard has it."""


def slanted_edge(size: int, oversampling: int, angle_deg: float, low: float = 1.0, high: float = 2.0, turned: bool = False) -> np.ndarray:
    """Radiance of an edge, each fine pixel the mean over its area (8 x 8 points) [(size oversampling, same)]."""
    count, points = size * oversampling, (np.arange(8) + 0.5) / 8
    tangent, middle = np.tan(np.radians(angle_deg)), 0.5 * size * oversampling
    share = np.zeros((count, count))
    for a in points:
        row = np.arange(count)[:, None] + a - middle
        for b in points:
            share += (np.arange(count)[None, :] + b - middle) > row * tangent
    picture = (low + (high - low) * share / 64).astype(np.float32)
    return picture.T.copy() if turned else picture


def edge_mtf(picture: np.ndarray, angle_deg: float, turned: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [cycles/pixel, along the edge's normal] and MTF of a picture whose middle the edge crosses."""
    picture = picture.T if turned else picture
    rows, columns = picture.shape
    tangent = np.tan(np.radians(angle_deg))
    y, x = np.mgrid[0:rows, 0:columns] + 0.5
    distance = ((x - 0.5 * columns) - (y - 0.5 * rows) * tangent) * np.cos(np.radians(angle_deg))
    place = np.floor(distance * BINS).astype(int)
    lowest, reach = place.min(), int(0.45 * columns * BINS)
    total = np.bincount((place - lowest).ravel(), picture.ravel().astype(float))
    count = np.bincount((place - lowest).ravel())
    profile = (total / np.maximum(count, 1))[-lowest - reach : -lowest + reach]
    spread = np.diff(profile)
    frequency = np.fft.rfftfreq(spread.size, 1.0 / BINS)
    # averaging over a bin and the difference of two each blur by a bin's width
    found = np.abs(np.fft.rfft(spread)) / np.sinc(frequency / BINS) ** 2
    return frequency, found / found[0]
