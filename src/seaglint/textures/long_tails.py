"""Long tails of filtered pictures: the noise that a field is filtered from, and its slow scale.

False alarms are counted in the Laplacian of a picture. Pixels whose own values have a long tail, sparse glints on a dark sea, keep it when
they are filtered. In most pictures of the sea pixels are spread evenly, and yet the Laplacian has a long tail, for two reasons: rough and
calm patches alternate, and within a patch the fine structure itself is not Gaussian. Both are seen in the white noise behind the picture,

    e(w) = X(w) / sqrt(S(w)),

with the spectral density S of the fitted field. Its local strength is the slow scale; divided by it, its values have the distribution of
the noise. Noise of this distribution times a slow field of this variance and these lengths, filtered by sqrt(S), is a sample: its
spectrum is exactly S.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.clutter.correlation import decay, spatial_correlation
from seaglint.clutter.false_alarms import FalseAlarms
from seaglint.clutter.filters import Laplacian
from seaglint.clutter.thresholds import standardise
from seaglint.textures.gauss_markov import GaussMarkov
from seaglint.textures.marginals import Marginal, fit_marginal
from seaglint.textures.synthesis import Modulation, density_of, whitened

Field = NDArray[np.float32]

THRESHOLDS: Final = (3.0, 3.5)  #: Thresholds of the rates that are compared [standard deviations of the filtered picture].

PATCH: Final = 8.0  #: Standard deviation of the window in which the strength of the noise is averaged, in rows and columns [px].

PATCH_IN_TIME: Final = 2.0  #: Standard deviation of this window in time, where frames follow each other [frames].

#: Variance of the logarithm of the scale below which it is taken as even: a scale that varies by 2 %.
EVEN: Final = 4e-4

#: Smallest and largest shape of the slow gamma field: with the largest its power varies by 5 %.
SHAPES: Final = (0.05, 400.0)


def interior(frames: ArrayLike) -> NDArray[np.float32]:
    """Return the Laplacian of the pixels away from the border, in standard deviations of their frame, (frames, rows - 2, columns - 2)."""
    out = Laplacian().apply(np.asarray(frames, np.float32))[:, 1:-1, 1:-1]
    return standardise(out, np.ones(out.shape[1:], np.bool_))


def laplacian_alarms(frames: NDArray[np.floating]) -> FalseAlarms:
    """Count the Laplacian of pictures above ``THRESHOLDS``, each in standard deviations of its own frame, (frames, rows, columns) [u]."""
    alarms = FalseAlarms(THRESHOLDS, 1, estimated=True)
    for frame in frames:
        alarms.add(interior(frame[None]))
    return alarms


@dataclass(frozen=True)
class Innovations:
    """White noise behind a picture or sequence."""

    values: Field  #: Noise [1, (frames, rows, columns)], with mean 0 and variance 1; NaN where it is not known.
    scale: Field  #: Its local standard deviation over the mean one [1, (frames, rows, columns)].
    modulation: Modulation | None  #: Slow field of this variance and these lengths; None where the scale is even.

    def law(self, *, scaled: bool) -> Marginal:
        """Return the distribution of the noise, or of the noise divided by its local scale, with mean 0 and variance 1."""
        values = self.values / self.scale if scaled else self.values
        found = fit_marginal(values[np.isfinite(values)], "empirical")
        unit = Marginal("empirical", 0.0, 1.0, None, found.quantiles)
        spread = math.sqrt(unit.variance)
        # The table ends beyond the data: its variance is near 1.
        return Marginal("empirical", -unit.mean / spread, 1.0 / spread, None, found.quantiles)


def innovations(values: ArrayLike, model: GaussMarkov) -> Innovations:
    """Compute the noise behind a picture or sequence, and its slow scale.

    Parameters
    ----------
    values : array_like, shape (frames, rows, columns)
        Field with mean 0 [1]; NaN where a pixel does not count.
    model : GaussMarkov
        Field fitted to it.
    """
    x = np.asarray(values, np.float32)
    known = np.isfinite(x)
    whole = x if known.all() else _nearest(x, known)
    timed = model.reach[0] > 0
    margins = [2 * far + (4 if far else 0) for far in model.reach]
    # Mirrored beyond the borders, where a torus would have a step.
    pads = [(min(4 * margin, n - 1),) * 2 if margin else (0, 0) for margin, n in zip(margins, x.shape, strict=True)]
    padded = np.pad(whole, pads, mode="symmetric")
    shape = padded.shape if timed else (1, *padded.shape[1:])
    density = density_of(model, shape)
    noise = whitened(padded, density) if timed else np.concatenate([whitened(frame[None], density) for frame in padded])
    inside = tuple(slice(low, low + n) for (low, _), n in zip(pads, x.shape, strict=True))
    noise = noise[inside].copy()
    noise[~known] = np.nan
    edge = [far if n > 8 * far else 0 for far, n in zip(model.reach, x.shape, strict=True)]
    _blank_border(noise, edge)
    noise -= np.nanmean(noise)
    noise /= max(float(np.nanstd(noise)), 1e-30)
    scale = _local_strength(noise, timed=timed)
    return Innovations(noise, scale, _modulation(noise, scale, timed=timed))


def _nearest(x: Field, known: NDArray[np.bool_]) -> Field:
    """Fill pixels that do not count with the nearest ones that do, frame by frame, and frames without any with the nearest frame."""
    from scipy.ndimage import distance_transform_edt

    if not known.any():
        raise DataError("no pixel counts: there is no texture to fit; choose another region")
    out = x.copy()
    filled = known.any(axis=(1, 2))
    for frame, good in zip(out, known, strict=True):
        if not good.all() and good.any():
            places = distance_transform_edt(~good, return_distances=False, return_indices=True)
            frame[...] = frame[tuple(places)]
    if not filled.all():
        # A frame without a value is the nearest one that has some.
        numbers = np.flatnonzero(filled)
        out[~filled] = out[numbers[np.abs(np.flatnonzero(~filled)[:, None] - numbers).argmin(axis=1)]]
    return out


def _blank_border(noise: Field, edge: list[int]) -> None:
    """Leave out the noise at the border, whose neighbours are mirrored ones."""
    for axis, width in enumerate(edge):
        if width:
            along = np.moveaxis(noise, axis, 0)
            along[:width] = np.nan
            along[-width:] = np.nan


def _window(*, timed: bool) -> tuple[float, float, float]:
    return (PATCH_IN_TIME if timed else 0.0, PATCH, PATCH)


def _local_strength(noise: Field, *, timed: bool) -> Field:
    """Return the mean absolute noise in a Gaussian window, over its mean in the picture [1]."""
    from scipy.ndimage import gaussian_filter

    known = np.isfinite(noise)
    strength = np.where(known, np.abs(noise), 0.0).astype(np.float32)
    window = _window(timed=timed)
    total, weight = (gaussian_filter(a, window, mode="constant", truncate=3.0) for a in (strength, known.astype(np.float32)))
    local = np.maximum(total, 1e-12) / np.maximum(weight, 1e-12)
    return np.asarray(local / float(local[known].mean()), np.float32)


def _modulation(noise: Field, scale: Field, *, timed: bool) -> Modulation | None:
    """Return the slow field with the variance and lengths of the local scale, less what averages of few pixels vary by chance."""
    from scipy.optimize import brentq
    from scipy.special import polygamma

    known = np.isfinite(noise)
    log = np.where(known, np.log(scale), np.nan)
    relative = np.abs(noise[known]) / scale[known]
    averaged = math.prod(2.0 * math.sqrt(math.pi) * w for w in _window(timed=timed) if w)
    by_chance = float(relative.var()) / float(relative.mean()) ** 2 / averaged
    variance = float(np.nanvar(log)) - by_chance
    if not variance > EVEN:
        return None
    near = spatial_correlation(log)
    rows, columns = log.shape[1:]
    # The window alone correlates its averages to 1/e at twice its width.
    y, x = (
        max(length, 2.0 * PATCH) if math.isfinite(length) else max(n / 3.0, 2.0 * PATCH)
        for length, n in ((near.length_y, rows), (near.length_x, columns))
    )
    # The power is the square of the scale: its logarithm has four times the variance.
    low, high = SHAPES
    needed = 4.0 * variance
    shape = (
        low
        if needed >= polygamma(1, low)
        else high
        if needed <= polygamma(1, high)
        else brentq(lambda v: polygamma(1, v) - needed, low, high)
    )
    return Modulation(float(shape), (_length_in_time(log) if timed else 0.5, float(y), float(x)))


def _length_in_time(log: FloatArray) -> float:
    """Number of frames after which the logarithm of the scale is correlated to 1/e; a third of the sequence where it stays correlated."""
    centred = np.nan_to_num(log - np.nanmean(log))
    longest = max(len(log) // 3, 1)
    sums = np.array([float(np.mean(centred[lag:] * centred[: len(log) - lag])) for lag in range(longest + 1)])
    length = float(decay(sums / sums[0]))
    return max(length, 2.0 * PATCH_IN_TIME) if math.isfinite(length) else float(longest)
