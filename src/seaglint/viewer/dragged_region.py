"""Statistics of a dragged region and its exceedances: the functions of ``seaglint analyze``, on one frame or all."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.constants import zero_Celsius

from seaglint.analysis import AnalysisOptions, Recording, analyze
from seaglint.analysis.analyze_recording import FEWEST_PIXELS
from seaglint.analysis.recording import survey
from seaglint.analysis.region import Gatherer
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject, number
from seaglint.base.reports import absent_numbers
from seaglint.clutter import filters
from seaglint.clutter.fits import Family, fit
from seaglint.clutter.thresholds import gaussian_rate, standardise
from seaglint.viewer.frame_source import CELSIUS, ViewerSource
from seaglint.viewer.regions import BoolArray, PictureRegion

if TYPE_CHECKING:
    from seaglint.base.conventions import Progress


SHOWN: Final[tuple[Family, ...]] = ("gamma", "gaussian")  #: Families of distributions drawn over the histogram.

BINS: Final = 60  #: Number of bins of the histogram.

THRESHOLDS: Final = np.linspace(0.0, 8.0, 81)  #: Thresholds of the plot of rates [standard deviations].

_CURVE: Final = 160  #: Number of points of a distribution's curve.


def in_kelvin(recording: Recording) -> Recording:
    """Return a recording in degrees Celsius in kelvin, and any other as it is: a distribution must not depend on the unit displayed."""
    if recording.units != CELSIUS:
        return recording

    def read(start: int, stop: int) -> NDArray[Any]:
        return recording.read_block(start, stop) + zero_Celsius

    full = None if recording.saturation is None else recording.saturation + zero_Celsius
    return replace(recording, units="K", read_block=read, saturation=full)


def _frame(source: ViewerSource, index: int, layer: str | None) -> Recording:
    """Return one frame as a recording; refuse a frame without a value."""
    if not np.isfinite(source.read(index, layer)).any():
        raise DataError(f"frame {index}: no pixel of it has a value; choose another frame")
    return source.recording(layer, only=index)


def quick(source: ViewerSource, index: int, where: PictureRegion, layer: str | None = None) -> JsonObject:
    """Return moments, histogram and fits of a region of one frame, named and computed as by ``seaglint analyze`` with a mask.

    Fits of a temperature are made in kelvin, whatever its unit.

    Raises
    ------
    DataError
        The region lies outside the image, or has no values.
    """
    chosen = source.layer(layer)
    recording = _frame(source, index, chosen.name)
    mask = where.mask(recording.rows, recording.columns)
    first = survey(recording, lambda _: None)
    mask &= (first.moments.count > 0) & ~first.dead
    if not mask.any():
        raise DataError("the region has no pixel with a value that varies; drag another one")
    moments = first.moments.region(mask)
    fitted_in = in_kelvin(recording)
    shift = 0.0 if fitted_in is recording else zero_Celsius
    block = fitted_in.read(0, 1)
    values, _ = Gatherer(mask, 1, np.zeros(1, np.int64), AnalysisOptions().seed, recording.offset).sample(block, (1e9, 1e9), mask)
    inside = recording.read(0, 1)[0][mask].astype(np.float64) + recording.offset
    low, high = float(inside.min()), float(inside.max())
    # A region of equal values still needs a range of some width.
    density, edges = np.histogram(inside, bins=BINS, range=(low, high) if high > low else (low - 0.5, low + 0.5), density=True)
    at = np.linspace(edges[0], edges[-1], _CURVE)
    fits: JsonObject = {}
    for family in SHOWN:
        fitted = fit(values, family)
        with np.errstate(all="ignore"):
            curve = [number(float(v)) for v in fitted.pdf(at + shift)] if fitted.is_valid else None
        fits[family] = {"shape": fitted.shape, "loc": fitted.loc, "scale": fitted.scale, "reason": fitted.reason or None, "density": curve}
    return {
        "frame": index,
        "label": chosen.label,
        "unit": chosen.unit,
        "spread_unit": chosen.spread_unit,
        "pixels": int(mask.sum()),
        "values": moments.count,
        "mean": number(moments.mean + recording.offset),
        "std": number(moments.std),
        "skewness": number(moments.skewness),
        "excess_kurtosis": number(moments.excess_kurtosis),
        "minimum": number(moments.minimum + recording.offset),
        "maximum": number(moments.maximum + recording.offset),
        "fits": fits,
        "fits_unit": fitted_in.units,
        "histogram": {"edges": edges.tolist(), "density": density.tolist(), "at": at.tolist()},
    }


def whole(source: ViewerSource, where: PictureRegion, layer: str | None, only: int | None, progress: Progress) -> JsonObject:
    """Return all statistics of ``seaglint analyze`` with a mask, for a region of one frame or of all frames that exist.

    Temperatures are analysed in kelvin, whatever their unit.

    Raises
    ------
    DataError
        The region lies outside the image, or has too few pixels.
    """
    recording = in_kelvin(source.recording(layer) if only is None else _frame(source, only, layer))
    mask = where.mask(recording.rows, recording.columns)
    if (pixels := int(mask.sum())) < FEWEST_PIXELS:
        raise DataError(f"the region has {pixels} pixel{'s' * (pixels != 1)}, too few for statistics; drag one of at least {FEWEST_PIXELS}")
    with absent_numbers():
        analysis = analyze(recording, AnalysisOptions(mask=mask), progress)
    if "glint" not in analysis.regions:
        raise DataError(f"the region has too few pixels with values ({'; '.join(analysis.notes)}); drag another one")
    out = analysis.regions["glint"].as_dict()
    region = {"shape": where.shape, "numbers": list(where.numbers)}
    known = {"source": recording.source, "units": recording.units, "frame": only, "frames": recording.frames, "region_px": region}
    return {**known, "blur_px": recording.blur_px, "blur": recording.blur, **out}


def exceedances(
    source: ViewerSource, index: int, sigma: float, filter_name: str, layer: str | None = None, where: PictureRegion | None = None
) -> tuple[JsonObject, BoolArray]:
    """Return the pixels of a frame above a threshold after a filter, as ``seaglint analyze`` counts them, and their mask.

    Parameters
    ----------
    source : ViewerSource
        Recording that is shown.
    index : int
        Number of the frame.
    sigma : float
        Threshold above the mean [standard deviations of the filtered frame in the region].
    filter_name : str
        One of ``seaglint.clutter.filters.NAMES``, or ``"none"``.
    layer : str, optional
        Layer of the recording; the first by default.
    where : PictureRegion, optional
        Part of the frame; the whole frame by default.

    Raises
    ------
    DataError
        The filter is not known, the threshold is no number, or the region lies outside the image.
    """
    if not 0.0 <= sigma <= 100.0:
        raise DataError(f"threshold {sigma:g}: give standard deviations from 0 to 100")
    recording = _frame(source, index, layer)
    first = survey(recording, lambda _: None)
    mask = (first.moments.count > 0) & ~first.dead
    if where is not None:
        mask &= where.mask(recording.rows, recording.columns)
    frame = recording.read(0, 1)
    # Dead pixels must not enter the filter's neighbourhoods.
    frame[:, first.dead] = np.nan
    filtered = filters.named(filter_name).apply(frame)
    z = standardise(filtered, mask)[0]
    # Single precision as in the analysis, so that both count the same pixels.
    above = z > np.float32(sigma)
    count, pixels = int(np.count_nonzero(above)), int(np.count_nonzero(np.isfinite(z)))
    rate, expected = count / pixels if pixels else math.nan, float(gaussian_rate(sigma))
    result = {
        "frame": index,
        "threshold_sigma": sigma,
        "filter": filter_name,
        "exceedances": count,
        "pixels": pixels,
        "rate": number(rate),
        "gaussian_rate": expected,
        "ratio": number(rate / expected) if expected > 0.0 else None,
        "value": _value(filtered[0], mask, sigma, recording.offset) if filter_name == "none" else None,
        "curve": _curve(z),
    }
    return result, above


def _curve(z: NDArray[np.float32]) -> JsonObject:
    """Return the rate of pixels above each of many thresholds, and the rates of Gaussian noise."""
    values = np.sort(z[np.isfinite(z)], axis=None)
    above = values.size - np.searchsorted(values, THRESHOLDS.astype(np.float32), side="right")
    return {
        "sigma": THRESHOLDS.round(6).tolist(),
        # No rate for thresholds that no pixel exceeds: a logarithm has no place for zero.
        "rate": [count / values.size if count else None for count in above.tolist()],
        "gaussian": [float(gaussian_rate(float(sigma))) for sigma in THRESHOLDS],
    }


def _value(frame: NDArray[np.float32], mask: BoolArray, sigma: float, offset: float) -> float | None:
    """Return the threshold as a value of the image."""
    inside = frame[mask].astype(np.float64)
    inside = inside[np.isfinite(inside)]
    return number(float(inside.mean() + sigma * inside.std()) + offset) if inside.size else None
