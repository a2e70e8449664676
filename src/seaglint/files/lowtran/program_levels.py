"""A sounding as the levels that LOWTRAN7's program takes: thinned, continued by the model atmosphere's own levels."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.files.lowtran.deck import MOST_LEVELS, ProfileLevel
from seaglint.files.soundings.sounding import Sounding, read_sounding

MODEL_LEVELS_KM = (*range(1, 26), 30, 35, 40, 45, 50, 70, 100)  #: Levels of LOWTRAN7's own models, which continue a sounding upwards.

LEVELS_ABOVE = 12  #: Largest number of levels of the model above a sounding that needs room itself.

#: Differences of equal weight when levels are left out: relative pressure [1], temperature [K], relative humidity [%].
THINNING = (0.002, 0.3, 2.0)


def program_levels(path: str | Path, model: str = "midlatitude-summer") -> tuple[ProfileLevel, ...]:
    """Return the levels of a sounding from the sea to 100 km, thinned to what LOWTRAN7 takes, then those of the model atmosphere.

    Levels are left out where the others, interpolated (pressure logarithmically), miss the sounding least.

    Raises
    ------
    DataError
        As :func:`~seaglint.files.soundings.sounding.read_sounding`.
    """
    return levels_of(read_sounding(path), model)


def levels_of(sounding: Sounding, model: str) -> tuple[ProfileLevel, ...]:
    """Return the levels of a sounding that was read, as :func:`program_levels` does; humidity that ends is the model's above."""
    air = (sounding.height, sounding.pressure, sounding.temperature, sounding.humidity(model))
    return _to_the_top(np.column_stack(air))


def _to_the_top(levels: FloatArray) -> tuple[ProfileLevel, ...]:
    top = float(levels[-1, 0]) / 1e3
    above = [float(z) for z in MODEL_LEVELS_KM if z > top + 0.2]  # closer levels make LOWTRAN7's layers degenerate
    room = MOST_LEVELS - min(len(above), LEVELS_ABOVE)
    thinned = _thinned(levels, room)
    while len(thinned) + len(above) > MOST_LEVELS:
        # The closest pair of the model's levels loses its upper one, never the last.
        gaps = [(b - a) / b for a, b in pairwise(above[:-1])]
        del above[int(np.argmin(gaps)) + 1]
    own = [ProfileLevel(float(z) / 1e3, float(p), float(t), float(u)) for z, p, t, u in thinned]
    return (*own, *(ProfileLevel(z) for z in above))


def _thinned(levels: FloatArray, room: int) -> FloatArray:
    """Return the rows that interpolate the others best: ends first, then the worst interpolated one after the other."""
    if len(levels) <= room:
        return levels
    scaled = np.column_stack([np.log(levels[:, 1]) / THINNING[0], levels[:, 2] / THINNING[1], levels[:, 3] / THINNING[2]])
    chosen = [0, len(levels) - 1]
    while len(chosen) < room:
        order = np.sort(chosen)
        guess = np.column_stack([np.interp(levels[:, 0], levels[order, 0], column[order]) for column in scaled.T])
        chosen.append(int(np.argmax(np.abs(scaled - guess).max(axis=1))))
    return np.asarray(levels[np.sort(chosen)])
