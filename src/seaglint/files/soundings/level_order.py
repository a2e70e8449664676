"""Order of a sounding's levels: one ascent from the ground up, with heights that rise and pressures that fall.

Pressures rounded to 0.1 hPa repeat aloft, where a second of ascent changes less; all of these levels count. Heights decide their order,
and their pressures are interpolated in height within the rounding of the file.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.soundings.raw_sounding import RawSounding
from seaglint.files.soundings.sounding_checks import DRY_AIR

FALL: Final = 0.125  #: Rise of the logarithm of pressure beyond which more than one level is another ascent: a fall of about a kilometre.

#: Rise of the logarithm of pressure in one step, from which levels go on rising, that tells a second launch: a fall of some 65 m.
RESTART: Final = 0.008

GROUND: Final = 0.012  #: Difference of the logarithm of pressure from the first level within which a level is near the ground: some 100 m.

RESTARTED: Final = 3  #: Least number of levels after such a step that lie below those before it; fewer are faults of single levels.

JUMP: Final = 0.7  #: Share of such a rise in a single step by which another sounding is told from a descent.

NOISE_HPA: Final = 0.2  #: Rise of pressure, under rising heights, that a sensor's noise explains [hPa].

NOISE_M: Final = 10.0  #: Fall of height, under falling pressures, that noise of the height explains [m].

SAME_M: Final = 1e-3  #: Heights this close are one height [m].

LOST: Final = 0.25  #: Largest share of levels that may fall back.


def upwards(path: Path, raw: RawSounding) -> tuple[RawSounding, bool]:
    """Return the levels from the ground up, and whether they were turned round.

    Raises
    ------
    DataError
        The file holds an ascent and a descent, or several soundings.
    """
    turned = bool(raw.pressure[0] < raw.pressure[-1])
    if turned:
        raw = raw.kept(np.arange(raw.pressure.size)[::-1])
    log_p = np.log(raw.pressure)
    least = np.minimum.accumulate(log_p)
    _refuse_restart(path, raw, log_p, least, turned)
    back = np.flatnonzero(log_p[1:] - least[:-1] > FALL) + 1
    if back.size < 2:
        return raw, turned
    lowest = int(np.argmin(log_p[: back[0]]))
    highest = lowest + int(np.argmax(log_p[lowest:]))
    steps = np.diff(log_p[lowest : highest + 1])
    place = lowest + int(np.argmax(steps)) + 1
    size = raw.pressure.size
    low, high = raw.pressure[lowest], raw.pressure[highest]
    if np.max(steps) > JUMP * (log_p[highest] - log_p[lowest]):
        row = size - place + 1 if turned else place + 1
        raise DataError(
            f"{path}: pressure rises again from {low:g} to {high:g} hPa at level {row} of {size}; is it one ascent? "
            "two soundings in one file, or levels out of order: give one, in order"
        )
    row = size - lowest if turned else lowest + 1
    raise DataError(
        f"{path}: pressure falls to {low:g} hPa at level {row} of {size} and rises again to {high:g} hPa; is it one ascent? "
        "ascent and descent in one file: give one of them"
    )


def _refuse_restart(path: Path, raw: RawSounding, log_p: FloatArray, least: FloatArray, turned: bool) -> None:
    """Refuse an ascent that begins again near the ground: a launch that was given up stands before the whole one, however short it was."""
    size = log_p.size
    for place in (np.flatnonzero(np.diff(log_p) > RESTART) + 1).tolist():
        above = least[place - 1]
        after = log_p[place : place + RESTARTED]
        if log_p[place] < log_p[0] - GROUND:
            continue
        if after.size == RESTARTED and bool(np.all(after > above)) and bool(np.all(np.diff(after) < RESTART)):
            row = size - place + 1 if turned else place + 1
            raise DataError(
                f"{path}: pressure rises again from {np.exp(above):.4g} to {raw.pressure[place]:g} hPa at level {row} of {size}; is it one "
                "ascent? two soundings in one file, or levels out of order: give one, in order"
            )


def in_order(path: Path, raw: RawSounding, humidity: FloatArray) -> tuple[RawSounding, FloatArray, list[str], list[str]]:
    """Return levels whose heights rise and pressures fall strictly, with what was done and what was left out, a sentence each.

    Raises
    ------
    DataError
        More than a quarter of the levels, and more than three, fall back.
    """
    done, lost = [], []
    step_p, step_z = raw.resolution
    risen = np.concatenate([[0.0], raw.pressure[1:] - np.minimum.accumulate(raw.pressure)[:-1]])
    fallen = np.concatenate([[0.0], np.maximum.accumulate(raw.height)[:-1] - raw.height[1:]])
    falls = (risen > max(1.5 * step_p, NOISE_HPA)) | (fallen > max(1.5 * step_z, NOISE_M))
    falls |= (fallen > 1.5 * step_z) & (risen > 1.01 * step_p)  # both agree that the balloon sank
    if falls.any():
        count = int(falls.sum())
        if count > max(3, LOST * falls.size):
            raise DataError(
                f"{path}: {count} of {falls.size} levels do not rise with falling pressure; is it one ascent, with the right columns?"
            )
        lost.append(f"{count} of {falls.size} levels fall back below others and are left out")
        raw, humidity = raw.kept(~falls), humidity[~falls]
    order = np.argsort(raw.height, kind="stable")
    moved = int(np.sum(order != np.arange(order.size)))
    if moved:
        done.append(f"{moved} of {order.size} levels stand out of order within rounding and noise; heights decide their order")
        raw, humidity = raw.kept(order), humidity[order]
    raw, humidity, merged = _merged(raw, humidity)
    if merged:
        done.append(f"{merged} of {order.size} levels repeat a height and are averaged with the level there")
    pressure, repeats = _falling(raw)
    if repeats:
        done.append(
            f"{repeats} of {pressure.size} levels repeat a pressure, rounded to {step_p:g} hPa; they are interpolated in height, "
            "none is left out"
        )
    return replace(raw, pressure=pressure), humidity, done, lost


def _merged(raw: RawSounding, humidity: FloatArray) -> tuple[RawSounding, FloatArray, int]:
    """Average the levels of one height; the count is that of the levels that are merged into another."""
    z = raw.height
    first = np.flatnonzero(np.concatenate([[True], np.diff(z) > SAME_M]))
    merged = int(z.size - first.size)
    if not merged:
        return raw, humidity, 0

    def mean(values: FloatArray) -> FloatArray:
        known = np.isfinite(values)
        count = np.add.reduceat(known.astype(np.float64), first)
        total = np.add.reduceat(np.where(known, values, 0.0), first)
        return np.where(count > 0.0, total / np.maximum(count, 1.0), np.nan)

    raw = replace(
        raw,
        pressure=mean(raw.pressure),
        height=z[first],
        temperature=mean(raw.temperature),
        humidity_value=mean(raw.humidity_value),
        ozone=None if raw.ozone is None else mean(raw.ozone),
    )
    return raw, mean(humidity), merged


def _falling(raw: RawSounding) -> tuple[FloatArray, int]:
    """Pressures that fall strictly [hPa], and the number of levels whose pressure repeats one or lies above one below.

    A run of equal pressures P stands for pressures from P + s/2 down to P - s/2, where s is the rounding: in the middle between the last
    level of a run and the first of the next lies the middle of their pressures. Between these ends the logarithm of pressure is linear in
    height. An end that no run follows has the hydrostatic pressure, within the rounding.
    """
    p, z = np.minimum.accumulate(raw.pressure), raw.height
    starts: NDArray[np.intp] = np.flatnonzero(np.concatenate([[True], p[1:] < p[:-1]]))
    if starts.size == p.size:
        return p, 0
    ends = np.concatenate([starts[1:], [p.size]]) - 1
    count, value = ends - starts + 1, p[starts]
    spread = np.maximum.reduceat(raw.pressure, starts) - value
    half = np.maximum(0.5 * raw.resolution[0], spread)
    half = np.minimum(half, 0.5 * value)
    gap = 0.5 * (value[:-1] - value[1:])
    between = 0.5 * (z[ends[:-1]] + z[starts[1:]])
    z_low, z_high = np.concatenate([[z[0]], between]), np.concatenate([between, [z[-1]]])
    scale = DRY_AIR * raw.temperature[starts] / GRAVITY
    thin = np.exp(-np.maximum(z_high - z_low, SAME_M) / scale)
    p_low, p_high = value.copy(), value.copy()
    p_low[1:] += np.minimum(gap, half[1:])
    p_high[:-1] -= np.minimum(gap, half[:-1])
    p_low[0] = min(value[0] + half[0], p_high[0] / thin[0]) if starts.size > 1 else value[0]
    p_high[-1] = max(value[-1] - half[-1], p_low[-1] * thin[-1])
    run = np.repeat(np.arange(starts.size), count)
    share = (z - z_low[run]) / np.maximum(z_high - z_low, SAME_M)[run]
    smooth = np.exp(np.log(p_low)[run] * (1.0 - share) + np.log(p_high)[run] * share)
    return np.where(count[run] > 1, smooth, p), int(np.sum(count - 1))
