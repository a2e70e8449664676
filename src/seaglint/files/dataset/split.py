"""Division of scenes into training, validation and test."""

from __future__ import annotations

import math
from typing import Final

from seaglint.base.random import stream

SPLITS: Final = ("train", "val", "test")

_GOLDEN: Final = 0.5 * (math.sqrt(5.0) - 1.0)


def split_of(seed: int, scene: int, fractions: tuple[float, float, float]) -> str:
    """Return the split of a scene: a function of seed and number alone, so that scenes added later move none.

    Scene ``n`` has the number ``u + n g`` modulo 1, with ``g`` the golden section and ``u`` drawn from the seed; it trains where this is
    below the first fraction, and so on. Numbers of this kind fill their interval evenly: of N scenes a split has its fraction of N to
    within about two, and all parts of a long list have their share.

    >>> [split_of(1, n, (1.0, 0.0, 0.0)) for n in range(2)]
    ['train', 'train']
    """
    place = (float(stream(seed, "dataset split").random()) + scene * _GOLDEN) % 1.0
    below = 0.0
    for name, fraction in zip(SPLITS[:2], fractions[:2], strict=True):
        below += fraction
        if place < below:
            return name
    # the last one: sums of fractions may end a rounding below 1
    return "test" if fractions[2] > 0.0 else "val" if fractions[1] > 0.0 else "train"
