"""Search for what is no sea in a picture or sequence: lines and pixels of the sensor that are dead, dark corners and borders, objects.

A texture or a statistic of the sea shall not contain them, and shall contain all extremes of the sea. A threshold cannot separate the two.
The peaks of a picture, averaged over squares of 1 to 9 pixels, follow a generalised Pareto law above a high level. The few largest ones are
objects if the gap between them and the others has a small probability under this law; long tails of glints have no such gap.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.clutter.correlation import BoolArray, trend_surface
from seaglint.clutter.false_alarms import lone_lines
from seaglint.clutter.filters import Laplacian, as_frames

FEWEST_FRAMES: Final = 8  #: Least number of frames for calling a pixel that never changes dead rather than calm.

MOST_STILL: Final = 0.25  #: Largest share of the pixels that never change and are left out; with more of them the scene is still.

DEEPEST: Final = 4  #: Number of lines from a border that are examined as a border.

UNLIKE: Final = 3.0  #: Ratio of the step between two lines to the steps between their neighbours above which one of them is bad.

LONE_STEP: Final = 1.7  #: Least such ratio of a line that ``lone_lines`` reports: the line itself, and not the ones beside it.

AROUND: Final = 10  #: Number of lines whose steps a step is compared with.

LONE_SIGMA: Final = 3.0  #: Threshold of the exceedances that are counted for ``lone_lines`` [standard deviations].

SMOOTH: Final = 2.0  #: Standard deviation of the average that a dark corner is found in [px].

DARK: Final = 5.0  #: Depth of a dark corner below the level of the sea [standard deviations of the average].

#: Depth of a dark corner of which the fine structure is gone too [standard deviations of the average].
DARK_AND_EVEN: Final = 3.0

EVEN: Final = 0.2  #: Ratio of the fine structure to the structure of the sea below which it is gone.

#: Least ratio of the depth of a dark corner to the depth of the darkest place away from the border.
DARKER: Final = 1.7

LEAST_DARK: Final = 24  #: Least number of pixels of a dark corner.

WIDTHS: Final = (1, 3, 5, 9)  #: Sides of the squares over which peaks are averaged [px].

APART: Final = 7  #: Least side of the square in which a peak is the largest pixel [px].

MOST_OBJECTS: Final = 12  #: Largest number of objects of one width.

FEW_OBJECTS: Final = 4  #: Number of objects from which on a tenth of the probability is required.

PEAKS: Final = (20, 250)  #: Least and largest number of peaks that the law of the others is fitted to.

LEAST_GAP: Final = 1.15  #: Least ratio of two peaks with an object's gap between them.

#: Probability of a gap by chance below which there is an object, of each width, sign and number of objects.
BY_CHANCE: Final = 2e-3

#: Mean and standard deviation of the shape of the Pareto law before the data: 0 is a Gaussian sea, 0.3 one of sparse glints.
SHAPE: Final = (0.1, 0.15)

LARGEST_OBJECT: Final = 800  #: Largest number of pixels of an object; what is larger is a coast, a cloud or a line of surf.

LONGEST: Final = 64  #: Longest side of an object [px].

SLENDER: Final = 8  #: Largest ratio of the sides of an object; what is longer is a crest, a wake or a line of surf.

MARGIN: Final = 2  #: Number of pixels around an object that are left out with it: the blur of its edge [px].


@dataclass(frozen=True)
class Defects:
    """Pixels that are no sea, one mask for each kind; all of shape (rows, columns)."""

    rows: BoolArray  #: Rows that are even or unlike both neighbours.
    columns: BoolArray  #: Columns that are even or unlike both neighbours.
    still: BoolArray  #: Pixels that never change in a sequence.
    dark: BoolArray  #: Dark corners and borders.
    objects: BoolArray  #: Boats, birds and other compact objects, with a margin.
    origin: tuple[int, int] = (0, 0)  #: Row and column of the picture at which the frames begin, for ``notes``.
    still_share: float = 0.0  #: Share of the pixels that never change, left out or not [1].

    @cached_property
    def mask(self) -> BoolArray:
        """Pixels of any kind, shape (rows, columns)."""
        return np.asarray(self.rows | self.columns | self.still | self.dark | self.objects)

    @property
    def counts(self) -> dict[str, int]:
        """Number of pixels of each kind that has some [px]; a pixel of two kinds counts for the first."""
        done = np.zeros(self.rows.shape, np.bool_)
        out: dict[str, int] = {}
        for name in ("rows", "columns", "still", "dark", "objects"):
            mask: BoolArray = getattr(self, name)
            count = int(np.count_nonzero(mask & ~done))
            if count:
                out[name] = count
            done |= mask
        return out

    @property
    def notes(self) -> tuple[str, ...]:
        """A sentence for each kind that has pixels."""
        top, left = self.origin
        out = []
        for mask, axis, name, first in ((self.rows, 1, "row", top), (self.columns, 0, "column", left)):
            numbers = np.flatnonzero(mask.all(axis=axis)) + first
            if numbers.size:
                out.append(f"{_counted(numbers.size, name)} left out ({_listed(numbers)}): even, or unlike the {name}s beside")
        if self.still.any():
            out.append(f"{_counted(int(self.still.sum()), 'pixel')} left out: the same value in all frames")
        elif self.still_share > MOST_STILL:
            out.append(f"{100.0 * self.still_share:.0f} % of the pixels never change (a still scene, or repeated frames): none is left out")
        if self.dark.any():
            out.append(f"{_counted(int(self.dark.sum()), 'pixel')} left out: dark corner or border ({_places(self.dark, top, left)})")
        if self.objects.any():
            places = _places(self.objects, top, left)
            out.append(f"{_counted(int(self.objects.sum()), 'pixel')} left out: objects that the tail of the sea does not reach ({places})")
        return tuple(out)


def _counted(number: int, name: str) -> str:
    return f"{number} {name}{'s' * (number != 1)}"


def _listed(numbers: NDArray[np.int64], most: int = 6) -> str:
    return ", ".join(map(str, numbers[:most])) + (", ..." if numbers.size > most else "")


def _places(mask: BoolArray, top: int, left: int, most: int = 4) -> str:
    """Return the rows and columns of the connected parts of a mask, the largest first."""
    from scipy.ndimage import find_objects, label

    labels, count = label(mask, np.ones((3, 3)))
    sizes = np.bincount(labels.ravel())[1:]
    boxes = find_objects(labels)
    parts = []
    for i in np.argsort(-sizes, kind="stable")[:most]:
        rows, columns = boxes[i]
        parts.append(f"rows {top + rows.start}:{top + rows.stop}, columns {left + columns.start}:{left + columns.stop}")
    return "; ".join(parts) + ("; ..." if count > most else "")


def find_defects(
    frames: ArrayLike, *, origin: tuple[int, int] = (0, 0), borders: tuple[bool, bool, bool, bool] = (True, True, True, True)
) -> Defects:
    """Search the pixels of a picture or sequence that are no sea.

    The m largest peaks ``x_1 > ... > x_m`` are objects if ``E[S(x_m - x_(m+1))^m] < 0.002``, S the generalised Pareto survival of excesses
    over ``x_(m+1)`` and E the mean over its uncertain shape and scale (Pickands 1975, Ann. Stat. 3, 119).

    Parameters
    ----------
    frames : array_like, shape (rows, columns) or (frames, rows, columns)
        Frames of the sea [u]; NaN are left out. Lines, corners and objects are searched in the mean of the frames.
    origin : (int, int)
        Row and column of the picture at which the frames begin, for the sentences.
    borders : (bool, bool, bool, bool)
        Whether the frames end at the top, bottom, left and right border of the picture: bad borders and dark corners lie there only.

    Returns
    -------
    Defects

    Raises
    ------
    DataError
        Frames of another shape.

    Examples
    --------
    >>> sea = np.random.default_rng(1).normal(size=(64, 64))
    >>> sea[:, 0] = 3.0
    >>> find_defects(sea).notes
    ('1 column left out (0): even, or unlike the columns beside',)
    """
    x = as_frames(frames)
    shape = x.shape[1:]
    exist = np.isfinite(x)
    known = np.asarray(exist.any(axis=0))
    nothing = np.zeros(shape, np.bool_)
    if np.count_nonzero(known) < 2:
        return Defects(nothing, nothing, nothing, nothing, nothing, origin)
    low, high = np.fmin.reduce(np.where(exist, x, np.nan), axis=0), np.fmax.reduce(np.where(exist, x, np.nan), axis=0)
    if not np.nanmax(high) > np.nanmin(low):
        # A constant has no lines or objects: it is refused where a texture is requested.
        return Defects(nothing, nothing, nothing, nothing, nothing, origin)
    count = exist.sum(axis=0)
    mean = np.where(known, np.where(exist, x, 0.0).sum(axis=0, dtype=np.float64) / np.maximum(count, 1), np.nan)
    rows, columns = _even(x, exist)
    # An even row crosses an even column of another value: each is examined again without the others that are known.
    for _ in range(2):
        rows, columns = rows | _even(x, exist & ~columns)[0], columns | _even(x, exist & ~rows[:, None])[1]
    ok = known & ~rows[:, None] & ~columns
    rows = rows | _unlike(np.where(ok, mean, np.nan), borders[:2])
    columns = columns | _unlike(np.where(ok, mean, np.nan).T, borders[2:])
    row_mask, column_mask = np.broadcast_to(rows[:, None], shape).copy(), np.broadcast_to(columns, shape).copy()
    ok = known & ~row_mask & ~column_mask
    still, share = nothing, 0.0
    if len(x) >= FEWEST_FRAMES and ok.any():
        same = ok & (low == high) & (count >= FEWEST_FRAMES)
        share = float(same.sum() / ok.sum())
        if share <= MOST_STILL:
            still, ok = same, ok & ~same
    if np.count_nonzero(ok) < 4 * PEAKS[0]:
        return Defects(row_mask, column_mask, still, nothing, nothing, origin, share)
    dark = _dark(mean, ok, borders)
    objects = _objects(mean, ok & ~dark) & ~row_mask & ~column_mask
    return Defects(row_mask, column_mask, still, dark, objects, origin, share)


def _even(x: NDArray[np.float32], exist: BoolArray) -> tuple[BoolArray, BoolArray]:
    """Return the rows and columns that have one value in every frame; none if all have."""
    out = []
    for axis in (2, 1):
        lines = np.where(exist, x, np.nan)
        highest, lowest = np.fmax.reduce(lines, axis=axis), np.fmin.reduce(lines, axis=axis)
        # A line without values in any frame is missing, not even; one pixel is no line.
        even = ~(highest > lowest).any(axis=0) & exist.any(axis=(0, axis)) & (exist.sum(axis=axis).max(axis=0) > 1)
        out.append(even if not even.all() else np.zeros_like(even))
    return out[0], out[1]


def _steps(y: FloatArray, distance: int) -> FloatArray:
    """Return the mean root of the differences of two lines, squared [u, (lines - distance,)]: a few far pixels count little."""
    step = np.sqrt(np.abs(y[distance:] - y[:-distance]))
    valid = np.isfinite(step)
    number = valid.sum(axis=1)
    return np.where(number > 0, np.where(valid, step, 0.0).sum(axis=1) / np.maximum(number, 1), np.nan) ** 2


def _unlike(y: FloatArray, borders: tuple[bool, bool]) -> BoolArray:
    """Return the lines (first axis) that differ from the lines beside far more than those do from each other."""
    n = len(y)
    bad = np.zeros(n, np.bool_)
    if n < 2 * AROUND:
        return bad
    step = _steps(y, 1)
    used = np.flatnonzero(np.isfinite(step))
    if used.size < 2 * AROUND:
        return bad
    # Borders: the innermost of the first few steps that is far larger than the steps further inside.
    for order, border in ((used, borders[0]), (used[::-1], borders[1])):
        further = step[order[DEEPEST : DEEPEST + AROUND]]
        inside = float(np.median(further))
        large = [k for k in range(DEEPEST) if step[order[k]] > max(UNLIKE * inside, 1.5 * float(further.max()))]
        if border and large and inside > 0.0:
            # A step k lies between the lines k and k + 1.
            last = int(order[large[-1]])
            bad |= np.arange(n) <= last if order is used else np.arange(n) > last
    # Inside: both steps of a line are large, and the lines beside are alike.
    wide = np.nan_to_num(_steps(y, 2), nan=np.inf)
    both = np.full(n, np.nan)
    both[1:-1] = np.minimum(step[:-1], step[1:])
    lone = np.zeros(n, np.bool_)
    lone[_lone(y)] = True
    # Most lines need no comparison with the lines around: a bad line differs from both beside, and from most.
    least = LONE_STEP * np.maximum(np.concatenate([[np.inf], wide, [np.inf]]) / 2.0, 0.5 * float(np.median(step[used])))
    for k in np.flatnonzero(both > least):
        near = np.concatenate([step[max(k - AROUND, 0) : max(k - 1, 0)], step[k + 1 : k + AROUND]])
        near = near[np.isfinite(near)]
        if near.size < AROUND // 2:
            continue
        typical = max(float(np.median(near)), float(wide[k - 1]) / 2.0)
        bad[k] |= both[k] > (LONE_STEP if lone[k] else UNLIKE) * typical > 0.0
    return bad & np.isfinite(y).any(axis=1)


def _lone(y: FloatArray) -> NDArray[np.int64]:
    """Return the lines with far more exceedances of the Laplacian than the lines beside."""
    filtered = Laplacian().apply(y.astype(np.float32)[None])[0]
    valid = np.isfinite(filtered)
    if np.count_nonzero(valid) < 2:
        return np.empty(0, np.int64)
    values = filtered[valid].astype(np.float64)
    far = np.abs(np.where(valid, filtered, values.mean()) - values.mean()) > LONE_SIGMA * float(values.std())
    return lone_lines(far.sum(axis=1))


def _dark(mean: FloatArray, ok: BoolArray, borders: tuple[bool, bool, bool, bool]) -> BoolArray:
    """Return corners and borders far below a smooth level of the sea."""
    from scipy.ndimage import binary_dilation, label

    nothing = np.zeros(mean.shape, np.bool_)
    if not any(borders):
        return nothing
    level, _ = _blurred(mean, ok, SMOOTH)
    step = max(min(mean.shape) // 64, 1)
    sea = ok.copy()
    depth = np.zeros(mean.shape)
    for _ in range(4):
        few = np.zeros(mean.shape, np.bool_)
        few[::step, ::step] = sea[::step, ::step]
        left = np.where(ok, level - trend_surface(level, few, degree=1), 0.0)
        below = left[few]
        middle = float(np.median(below))
        spread = float(np.median(middle - below[below < middle])) / 0.6745 if np.any(below < middle) else 0.0
        if not spread > 0.0:
            return nothing
        depth = np.where(ok, (middle - left) / spread, 0.0)
        sea = ok & (depth < 0.6 * DARK)
        if np.count_nonzero(sea) < ok.sum() / 2:
            return nothing
    # Black glass and the edge of a lens have no waves.
    fine = np.where(ok, np.abs(mean - _blurred(mean, ok, 1.0)[0]), 0.0)
    waves, _ = _blurred(fine, ok, 3.0)
    even = ok & (waves < EVEN * float(np.median(waves[sea]))) & (depth > DARK_AND_EVEN)
    labels, _ = label(even | (depth > 0.6 * DARK), np.ones((3, 3)))
    edge = nothing.copy()
    # Bad lines at the border were left out: the first line that is used counts as the border.
    rows, columns = np.flatnonzero(ok.any(axis=1)), np.flatnonzero(ok.any(axis=0))
    edge[rows[0], :] |= borders[0]
    edge[rows[-1], :] |= borders[1]
    edge[:, columns[0]] |= borders[2]
    edge[:, columns[-1]] |= borders[3]
    at_border = np.unique(labels[edge & (labels > 0)])
    elsewhere = float(depth[(labels == 0) | ~np.isin(labels, at_border)].max(initial=0.0))
    out = nothing
    for number in at_border:
        part = labels == number
        deep = part & (even | (depth > DARK))
        if np.count_nonzero(deep) >= LEAST_DARK and (even[part].mean() > 0.5 or float(depth[part].max()) > DARKER * elsewhere):
            out = out | part
    return np.asarray(binary_dilation(out, iterations=MARGIN) & ok) if out.any() else nothing


def _blurred(x: FloatArray, ok: BoolArray, sigma: float) -> tuple[FloatArray, FloatArray]:
    """Return Gaussian averages over the pixels that count, and their share of the weight."""
    from scipy.ndimage import gaussian_filter

    if ok.all():
        return gaussian_filter(x, sigma, mode="nearest", truncate=3.0), np.ones(x.shape)
    share = gaussian_filter(ok.astype(np.float64), sigma, mode="nearest", truncate=3.0)
    total = gaussian_filter(np.where(ok, x, 0.0), sigma, mode="nearest", truncate=3.0)
    return total / np.maximum(share, 1e-9), share


def _residual(mean: FloatArray, ok: BoolArray) -> FloatArray:
    """Return the picture less its slow changes, in units of the local mean deviation; 0 where a pixel does not count."""
    trend, _ = _blurred(mean, ok, 8.0)
    left = mean - trend
    spread = 1.4826 * float(np.median(np.abs(left[ok]))) or float(left[ok].std())
    # Once more without what stands out, so that an object does not lift the level around it.
    trend, _ = _blurred(trend + np.clip(left, -3.0 * spread, 3.0 * spread), ok, 8.0)
    left = np.where(ok, mean - trend, 0.0)
    size = np.abs(left)
    typical = float(size[ok].mean())
    local, _ = _blurred(np.minimum(size, 3.0 * typical), ok, 12.0)
    return left / np.maximum(local, max(0.3 * typical, 1e-300))


def _objects(mean: FloatArray, ok: BoolArray) -> BoolArray:
    """Return the pixels of objects, with a margin."""
    from scipy.ndimage import binary_dilation, maximum_filter, uniform_filter

    out = np.zeros(mean.shape, np.bool_)
    left = _residual(mean, ok)
    exist = ok.astype(np.float64)
    for width in WIDTHS:
        share = uniform_filter(exist, width, mode="constant")
        average = np.where(ok & (share > 0.5), uniform_filter(left, width, mode="constant") / np.maximum(share, 0.5), 0.0)
        side = max(2 * width + 1, APART)
        for sign in (1.0, -1.0):
            height = sign * average
            places = np.argwhere((height == maximum_filter(height, side)) & (height > 0.0) & ok)
            peaks = height[tuple(places.T)]
            order = np.argsort(-peaks, kind="stable")
            number = _standing_out(peaks[order])
            for place in places[order[:number]]:
                out |= _grown(height, sign * left, (int(place[0]), int(place[1])), float(peaks[order[number]]))
    return np.asarray(binary_dilation(out, np.ones((3, 3), np.bool_), iterations=MARGIN)) if out.any() else out


def _grown(height: FloatArray, left: FloatArray, place: tuple[int, int], next_peak: float) -> BoolArray:
    """Return the connected pixels around a peak that are above half of the largest peak of the sea; nothing where there are too many."""
    from scipy.ndimage import label

    for least in (0.5 * next_peak, next_peak, 0.5 * (next_peak + float(height[place]))):
        labels, _ = label(height > least, np.ones((3, 3)))
        part = labels == labels[place]
        # Averages reach beyond a small object: its own pixels are those that stand out themselves, unless the object is faint.
        own = part & (left > max(least, 0.15 * float(left[part].max())))
        if np.count_nonzero(own) >= 0.1 * np.count_nonzero(part & (height > next_peak)):
            part = own
        sides = sorted(int(np.ptp(line)) + 1 for line in np.nonzero(part))
        if np.count_nonzero(part) <= LARGEST_OBJECT and sides[1] <= min(LONGEST, SLENDER * sides[0]):
            return np.asarray(part)
    return np.zeros(height.shape, np.bool_)


def _standing_out(peaks: FloatArray) -> int:
    """Return the number of leading peaks that a gap separates from the others, in falling order [1]."""
    best = 0
    for number in range(1, MOST_OBJECTS + 1):
        used = min(PEAKS[1], (peaks.size - number) // 3)
        if used < PEAKS[0]:
            break
        others = peaks[number : number + used] - peaks[number + used]
        gap = float(peaks[number - 1] - peaks[number])
        # An exponential tail gives gaps the least probability; most need no fit.
        if peaks[number - 1] < LEAST_GAP * peaks[number] or not others.mean() > 0.0:
            continue
        # Groups of several come from many places at which a gap may be.
        limit = BY_CHANCE if number < FEW_OBJECTS else 0.1 * BY_CHANCE
        if number * gap > -0.5 * math.log(BY_CHANCE) * float(others.mean()) and gap_probability(others, number, gap) < limit:
            best = number
    return best


def gap_probability(others: FloatArray, number: int, gap: float) -> float:
    """Return the probability that the largest peaks of a picture all exceed the next one by a gap [1].

    The excess of peaks over a level follows a generalised Pareto law with shape xi and scale beta. Given the law, ``number`` peaks that
    exceed the largest of the others, v, all exceed v + gap with the probability S(gap)^number, S of scale beta + xi v. It is averaged
    over the posterior probability of xi and beta, for which the largest peaks count as no more than above v.

    Parameters
    ----------
    others : ndarray, shape (peaks,)
        Excesses of the other peaks over a level, the largest first, all 0 or more [u].
    number : int
        Number of the largest peaks.
    gap : float
        Distance of the smallest of them from the largest of the others [u].

    Raises
    ------
    DataError
        No excess above 0.
    """
    mean = float(others.mean())
    if not mean > 0.0:
        raise DataError("the excesses are all 0; give peaks above a lower level")
    xi, beta = (grid.ravel() for grid in np.meshgrid(np.linspace(0.0, 1.0, 21), np.geomspace(0.3, 1.6, 20), indexing="ij"))
    xi = np.maximum(xi, 1e-6)
    y = others / mean

    def log_survival(excess: float, scale: FloatArray) -> FloatArray:
        return np.asarray(-np.log1p(xi * excess / scale) / xi)

    terms = np.log1p((xi / beta)[:, None] * y).sum(axis=1)
    log_weight = -(1.0 + 1.0 / xi) * terms - y.size * np.log(beta) + number * log_survival(float(y[0]), beta)
    log_weight -= 0.5 * ((xi - SHAPE[0]) / SHAPE[1]) ** 2
    weight = np.exp(log_weight - log_weight.max())
    chance = np.exp(number * log_survival(gap / mean, beta + xi * y[0]))
    return float(weight @ chance / weight.sum())
