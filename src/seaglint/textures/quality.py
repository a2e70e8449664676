"""Similarity of two pictures or sequences as textures, in numbers, such as a sample and the data that it was fitted to.

The false alarms of the Laplacian-filtered picture determine the performance of a detector. Distances of values, spectra, correlations in
space and time and co-occurrence of grey levels show where a model fails that reproduces them, or why it does not reproduce them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.clutter.correlation import spatial_correlation, temporal_correlation
from seaglint.clutter.false_alarms import FalseAlarmRate, RateCurve
from seaglint.clutter.rate_ratios import RateRatio, Verdict, rate_ratio
from seaglint.clutter.spectrum import Spectrum, power_spectrum
from seaglint.textures.long_tails import laplacian_alarms

LAGS: Final = 12  #: Largest distance of the compared correlations [px].

FRAMES: Final = 12  #: Number of frames whose spectra, correlations in space and co-occurrence are compared, evenly spread.

TIMES: Final = 25  #: Largest number of frames between compared pixels.

SQUARES: Final = (64, 32, 16)  #: Sides of the squares of the compared spectra [px]: the largest of which there are ``FEWEST`` in both.

#: Least number of squares of a spectrum: their mean periodogram scatters by some 1 dB.
#:
#: A single one would by 5.6 dB, more than the limit.
FEWEST: Final = 24

LEVELS: Final = 16  #: Number of grey levels of the co-occurrence matrix.

PAIRS: Final = ((0, 1), (1, 0), (1, 1), (1, -1))  #: Distances of the pairs of the co-occurrence matrix (rows, columns).

#: Limits beyond which a texture differs.
#:
#: They are ratio of rates, distance of distribution functions, rms of spectra [dB], rms of correlations, largest relative difference of
#: co-occurrence features.
LIMITS: Final[Mapping[str, float]] = {
    "rate_factor": 1.5,
    "ks": 0.1,
    "spectrum_db": 3.0,
    "correlation": 0.1,
    "time_correlation": 0.1,
    "cooccurrence": 0.25,
}


@dataclass(frozen=True)
class Likeness:
    """Texture measures of one picture or sequence."""

    name: str  #: Name for reports.
    values: FloatArray  #: Sorted sample of the pixels [u].
    rates: tuple[FalseAlarmRate, ...]  #: Rates of the filtered picture at 3 and 3.5 standard deviations.
    curve: RateCurve  #: At all thresholds.
    spectrum: Spectrum  #: Spectrum of the pixels in standard deviations.
    x: FloatArray  #: Correlation by distance in columns, from 0 [1].
    y: FloatArray  #: Correlation by distance in rows, from 0 [1].
    time: FloatArray | None  #: Correlation by frames.
    features: dict[str, float]  #: Haralick features of co-occurring grey levels.


@dataclass(frozen=True)
class RatePair:
    """Rates of both filtered pictures above a threshold."""

    threshold_sigma: float  #: Threshold [standard deviations].
    gaussian_rate: float  #: One-sided Gaussian tail [1].
    first: float  #: Rate of the first picture per pixel and frame [1].
    first_interval: list[float | None]  #: Ends of its 95 % interval [1].
    second: float  #: Rate of the second picture per pixel and frame [1].
    second_interval: list[float | None]  #: Ends of its 95 % interval [1].
    first_over_gaussian: float  #: Rate of the first over the Gaussian tail [1].
    second_over_gaussian: float  #: Rate of the second over the Gaussian tail [1].
    second_over_first: float | None  #: Ratio of the rates [1]; None where the first is 0.
    ratio_interval: list[float | None]  #: Ends of its 95 % interval [1]; a last None is infinite, two are no interval.
    verdict: Verdict  #: Whether the ratio ``holds`` within the limit or ``differs``, both with its whole interval, or is ``undecided``.

    @property
    def ratio(self) -> RateRatio:
        """Ratio of the rates with its interval."""
        low, high = self.ratio_interval
        return RateRatio(self.second_over_first, low, high)

    @classmethod
    def of(cls, a: FalseAlarmRate, b: FalseAlarmRate) -> Self:
        """Return the rates of the first and the second picture."""
        ratio = rate_ratio(a, b)
        return cls(
            threshold_sigma=a.threshold_sigma,
            gaussian_rate=a.gaussian_rate,
            first=a.rate,
            first_interval=[a.rate_low, a.rate_high],
            second=b.rate,
            second_interval=[b.rate_low, b.rate_high],
            first_over_gaussian=a.ratio,
            second_over_gaussian=b.ratio,
            second_over_first=ratio.value,
            ratio_interval=ratio.interval,
            verdict=ratio.verdict(LIMITS["rate_factor"]),
        )


@dataclass(frozen=True)
class ValueMoments:
    """Mean and standard deviation of the pixels [u], skewness and excess kurtosis [1]."""

    mean: float
    std: float
    skewness: float
    excess_kurtosis: float

    @classmethod
    def of(cls, values: FloatArray) -> Self:
        """Return the moments of a sample of pixels [u]."""
        z = (values - values.mean()) / max(float(values.std()), 1e-300)
        return cls(float(values.mean()), float(values.std()), float((z**3).mean()), float((z**4).mean()) - 3.0)


@dataclass(frozen=True)
class ValueDistances:
    """Differences between the values of two pictures."""

    ks: float  #: Largest distance of the distribution functions [1].
    wasserstein_std: float  #: Wasserstein distance [standard deviations of the first].
    first: ValueMoments  #: Moments of the first picture.
    second: ValueMoments  #: Moments of the second picture.


@dataclass(frozen=True)
class FeaturePair:
    """Feature of co-occurring grey levels of both pictures, and the relative difference [1]."""

    first: float
    second: float
    relative: float


@dataclass(frozen=True)
class TextureDistances:
    """Distances between two textures."""

    first: str  #: Name of the first picture.
    second: str  #: Name of the second picture.
    filtered_rates: list[RatePair]  #: False alarms of the filtered pictures by threshold.
    marginal: ValueDistances  #: Differences of the values.
    spectrum_distance_db: float  #: Rms ratio of the spectra [dB].
    correlation_distance: float  #: Rms difference of the correlations in space [1].
    time_correlation_distance: float | None  #: Rms difference of the correlations in time [1]; None without time.
    cooccurrence: dict[str, FeaturePair]  #: Features of co-occurring grey levels by name.
    fails: list[str]  #: Sentences on the measures that differ by more than ``LIMITS``, of rates with their whole interval.
    undecided: list[str]  #: Sentences on rates of too few exceedances to say whether they differ by more than the limit.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and words."""
        return asdict(self)


@dataclass(frozen=True)
class Comparison:
    """Measures of two textures, the first one the data."""

    first: Likeness
    second: Likeness

    @cached_property
    def distances(self) -> TextureDistances:
        """Distances between the two."""
        a, b = self.first, self.second
        pairs = ((name, a.features[name], b.features[name]) for name in a.features)
        result = TextureDistances(
            first=a.name,
            second=b.name,
            filtered_rates=[RatePair.of(p, q) for p, q in zip(a.rates, b.rates, strict=True)],
            marginal=_values(a.values, b.values),
            spectrum_distance_db=_decibels(a.spectrum, b.spectrum),
            correlation_distance=math.sqrt(0.5 * (_rms(a.x, b.x) ** 2 + _rms(a.y, b.y) ** 2)),
            time_correlation_distance=None if a.time is None or b.time is None else _rms(a.time, b.time),
            cooccurrence={name: FeaturePair(one, other, _relative(name, one, other)) for name, one, other in pairs},
            fails=[],
            undecided=[],
        )
        return replace(result, fails=_fails(result), undecided=_undecided(result))

    def as_dict(self) -> JsonObject:
        """Return the comparison as plain numbers and words."""
        return self.distances.as_dict()


def _values(a: FloatArray, b: FloatArray) -> ValueDistances:
    # The largest difference of two distribution functions lies at a value of one of the samples.
    every = np.concatenate([a, b])
    every.sort()
    shares = [np.searchsorted(v, every, side="right") / v.size for v in (a, b)]
    steps = np.linspace(0.0005, 0.9995, 1000)
    wasserstein = float(np.abs(np.quantile(a, steps) - np.quantile(b, steps)).mean()) / max(float(a.std()), 1e-300)
    return ValueDistances(float(np.abs(shares[0] - shares[1]).max()), wasserstein, ValueMoments.of(a), ValueMoments.of(b))


def _fails(distances: TextureDistances) -> list[str]:
    """Sentences on the measures that differ by more than ``LIMITS``."""
    out = []
    for entry in distances.filtered_rates:
        if entry.verdict == "differs":
            what = "never exceeds" if entry.second_over_first == 0.0 else "exceeds"
            out.append(f"the filtered picture {what} {entry.threshold_sigma:g} sigma, {entry.ratio.text} times as often as the first")
    checks = (
        ("ks", distances.marginal.ks, "distribution functions of the pixels differ by {:.2g}"),
        ("spectrum_db", distances.spectrum_distance_db, "spectra differ by {:.2g} dB rms"),
        ("correlation", distances.correlation_distance, "correlations in space differ by {:.2g} rms"),
        ("time_correlation", distances.time_correlation_distance, "correlations in time differ by {:.2g} rms"),
    )
    out += [text.format(value) for name, value, text in checks if value is not None and value > LIMITS[name]]
    worst, pair = max(distances.cooccurrence.items(), key=lambda item: item[1].relative)
    if pair.relative > LIMITS["cooccurrence"]:
        out.append(f"co-occurring grey levels differ most in {worst}: {pair.first:.3g} and {pair.second:.3g}")
    return out


def _undecided(distances: TextureDistances) -> list[str]:
    """Sentences on rates whose interval reaches over the limit."""
    most = LIMITS["rate_factor"]
    return [
        f"too few exceedances of {entry.threshold_sigma:g} sigma to say whether their rates agree within {most:g}: ratio {entry.ratio.text}"
        for entry in distances.filtered_rates
        if entry.verdict == "undecided" and entry.ratio_interval[0] is not None
    ]


def _relative(name: str, a: float, b: float) -> float:
    """Difference of a feature over its larger value; for correlations, which may be near 0, over 1."""
    return abs(a - b) / (1.0 if name == "correlation" else max(abs(a), abs(b), 1e-12))


def _rms(a: FloatArray, b: FloatArray) -> float:
    n = min(a.size, b.size)
    return float(np.sqrt(np.nanmean((a[:n] - b[:n]) ** 2)))


def _decibels(a: Spectrum, b: Spectrum) -> float:
    """Rms of the ratio of two spectra over the frequencies with more than a millionth of the largest density [dB]."""
    largest = max(float(a.density.max()), float(b.density.max()))
    # Below a millionth of the largest density spectra are rounding, whose ratio has no meaning.
    floor = 1e-6 * largest
    ratio = 10.0 * np.log10(np.maximum(a.density, floor) / np.maximum(b.density, floor))
    return float(np.sqrt(np.mean(ratio**2)))


def compare(
    first: NDArray[np.floating], second: NDArray[np.floating], names: tuple[str, str] = ("data", "sample"), *, consecutive: bool = True
) -> Comparison:
    """Compare two textures by their measures.

    Parameters
    ----------
    first, second : ndarray, shape (frames, rows, columns)
        [u]; sizes may differ. Pixels that are NaN do not count.
    names : (str, str)
        For reports.
    consecutive : bool
        Whether the frames follow each other, so that correlations in time mean something.

    Raises
    ------
    DataError
        Infinite values, no values, or pictures smaller than 24 x 24 pixels.
    """
    for name, x in zip(names, (first, second), strict=True):
        if x.ndim != 3 or min(x.shape[1:]) < 2 * LAGS:
            raise DataError(f"{name}: {x.shape} is too small to be compared; give 24 x 24 pixels or more")
        if np.isinf(x).any() or np.isnan(x).all():
            raise DataError(f"{name}: all values are missing, or some are infinite; choose a region without them")
    side = min(_side(first), _side(second))
    ends = np.quantile(np.concatenate([_some(first), _some(second)]), [0.001, 0.999])
    # Fewer frames give no correlation in time.
    frames = min(len(first), len(second)) if consecutive and min(len(first), len(second)) >= 8 else 0
    return Comparison(*(_measure(name, x, side, ends, frames) for name, x in zip(names, (first, second), strict=True)))


def _side(x: NDArray[np.floating]) -> int:
    """Side of the squares of a spectrum that allows a sufficient average [px]; squares with a pixel that is NaN do not count."""
    few = _few(x)
    gaps = np.isnan(few)

    def squares(side: int) -> int:
        frames, rows, columns = len(few), int(x.shape[1]) // side, int(x.shape[2]) // side
        if not gaps.any():
            return frames * rows * columns
        cells = gaps[:, : rows * side, : columns * side].reshape(frames, rows, side, columns, side)
        return int(np.count_nonzero(~cells.any(axis=(2, 4))))

    return next((side for side in SQUARES if squares(side) >= FEWEST), SQUARES[-1])


def _few(x: NDArray[np.floating]) -> NDArray[np.floating]:
    """Return at most ``FRAMES`` frames, evenly spread."""
    return np.asarray(x[np.unique(np.linspace(0, len(x) - 1, min(len(x), FRAMES)).astype(int))])


def _some(x: NDArray[np.floating]) -> FloatArray:
    """Return at most some 200 000 of the values."""
    flat = x.reshape(-1)
    if np.isnan(flat).any():
        flat = flat[~np.isnan(flat)]
    return np.asarray(flat[:: max(flat.size // 200_000, 1)], np.float64)


def _filled(frames: FloatArray, side: int) -> FloatArray:
    """Return frames in which small gaps have the mean of the values around them, where few squares of a side are without a gap."""
    from scipy.ndimage import uniform_filter

    exist = np.isfinite(frames)
    if power_spectrum(frames, size=side).segments >= FEWEST or exist.all():
        return frames
    for reach in (3, 5, 9):
        weight = uniform_filter(exist.astype(np.float64), (1, reach, reach), mode="constant")
        near = uniform_filter(np.where(exist, frames, 0.0), (1, reach, reach), mode="constant") / np.maximum(weight, 1e-12)
        # A pixel with few values around it belongs to a large gap, and its square is left out.
        frames = np.where(np.isnan(frames) & (weight > 0.3), near, frames)
    return frames if power_spectrum(frames, size=side).segments else np.nan_to_num(frames)


def _measure(name: str, x: NDArray[np.floating], side: int, ends: FloatArray, frames: int) -> Likeness:
    alarms = laplacian_alarms(x)
    gaps = bool(np.isnan(x).any())
    std = max(float(np.nanstd(x) if gaps else x.std()), 1e-300)
    few = _few(x)
    near = spatial_correlation(few, longest=LAGS)
    time = None
    if frames:
        # About 4000 pixels of a frame are enough for the correlation in time.
        step = max(int(math.sqrt(x[0].size / 4000.0)), 1)
        time = temporal_correlation(x[:frames, ::step, ::step].reshape(frames, -1), longest=min(TIMES, frames // 2)).rho
    normal = (few - (np.nanmean(few) if gaps else few.mean())) / std
    spectrum = power_spectrum(_filled(np.asarray(normal, np.float64), side) if gaps else normal, size=side)
    features = cooccurrence(few, (float(ends[0]), float(ends[1])))
    return Likeness(name, np.sort(_some(x)), tuple(alarms.rates()), alarms.curve(), spectrum, near.x, near.y, time, features)


def cooccurrence(frames: NDArray[np.floating], ends: tuple[float, float], levels: int = LEVELS) -> dict[str, float]:
    """Compute features of the grey levels of pairs of pixels (Haralick, Shanmugam and Dinstein 1973), mean of four directions [1].

    Parameters
    ----------
    frames : ndarray, shape (frames, rows, columns)
        [u]; pairs with a NaN do not count.
    ends : (float, float)
        Values of the first and last level [u].
    levels : int
        Number of levels.

    Returns
    -------
    dict of float
        Features [1] by name.

    Examples
    --------
    >>> features = cooccurrence(np.indices((8, 8)).sum(axis=0)[None] % 2, (0.0, 1.0), 2)
    >>> round(features["contrast"], 3), round(features["homogeneity"], 3)
    (0.5, 0.75)
    """
    grey = np.clip((frames - ends[0]) / max(ends[1] - ends[0], 1e-300) * levels, 0, levels - 1)
    exist = np.isfinite(grey)
    gaps = not exist.all()
    grey = np.where(exist, grey, 0.0).astype(np.int64) if gaps else grey.astype(np.int64)
    i, j = np.indices((levels, levels))
    out: dict[str, list[float]] = {name: [] for name in ("contrast", "homogeneity", "energy", "entropy", "correlation")}
    rows, columns = grey.shape[1:]
    for down, right in PAIRS:
        first = grey[:, : rows - down, max(-right, 0) : columns - max(right, 0)]
        second = grey[:, down:, max(right, 0) : columns + min(right, 0)]
        pairs = (first * levels + second).ravel()
        if gaps:
            both = (
                exist[:, : rows - down, max(-right, 0) : columns - max(right, 0)] & exist[:, down:, max(right, 0) : columns + min(right, 0)]
            )
            pairs = pairs[both.ravel()]
        table = np.bincount(pairs, minlength=levels * levels).reshape(levels, levels).astype(np.float64)
        # Symmetric: each pair counts in both orders.
        p = (table + table.T) / max(2.0 * table.sum(), 1.0)
        mean = float((p * i).sum())
        variance = max(float((p * (i - mean) ** 2).sum()), 1e-300)
        out["contrast"].append(float((p * (i - j) ** 2).sum()))
        out["homogeneity"].append(float((p / (1.0 + (i - j) ** 2)).sum()))
        out["energy"].append(float((p**2).sum()))
        out["entropy"].append(float(-(p[p > 0.0] * np.log(p[p > 0.0])).sum()))
        out["correlation"].append(float((p * (i - mean) * (j - mean)).sum()) / variance)
    return {name: float(np.mean(values)) for name, values in out.items()}
