"""Courses of pixels and regions over all frames, pictures of mean, deviation and maximum over time, and profiles along a line.

Frames are read in blocks, with progress, and a job ends between two blocks. Pixels without a value are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject, number
from seaglint.viewer.frame_source import OVER_TIME, ViewerSource
from seaglint.viewer.regions import PictureRegion

if TYPE_CHECKING:
    from seaglint.base.conventions import Progress

Floats = NDArray[np.float64]

_STEP: Final = 16  #: Number of frames between two reports of progress.


def statistics(source: ViewerSource, index: int, regions: Sequence[PictureRegion], layer: str | None = None) -> list[JsonObject]:
    """Return number of pixels, mean, standard deviation and extremes of each region of one frame; of an empty region the reason.

    Raises
    ------
    DataError
        The frame or the layer does not exist.
    """
    image = np.asarray(source.read(index, layer), np.float64)
    out: list[JsonObject] = []
    for region in regions:
        try:
            inside = image[region.mask(*image.shape)]
        except DataError as error:
            out.append({"reason": str(error)})
            continue
        pixels = inside.size
        inside = inside[np.isfinite(inside)]
        if not inside.size:
            out.append({"pixels": pixels, "values": 0, "reason": f"none of the {pixels} pixels has a value"})
            continue
        ends = {"minimum": float(inside.min()), "maximum": float(inside.max())}
        out.append({"pixels": pixels, "values": int(inside.size), "mean": float(inside.mean()), "std": float(inside.std()), **ends})
    return out


def trace(source: ViewerSource, row: int, column: int, layer: str | None, progress: Progress) -> JsonObject:
    """Return the value of a pixel in every frame that exists, with frames and, where they are known, times [s].

    Raises
    ------
    DataError
        The layer does not exist.
    """
    chosen, frames = source.layer(layer), source.done()
    values = []
    for place, frame in enumerate(frames.tolist()):
        if place % _STEP == 0:
            progress(place, frames.size)
        values.append(number(float(source.read_once(frame, chosen.name)[row, column])))
    return {"frames": frames.tolist(), "times_s": source.times(frames), "values": values, "label": chosen.label, "unit": chosen.unit}


def courses(source: ViewerSource, regions: Sequence[PictureRegion], layer: str | None, progress: Progress) -> JsonObject:
    """Return the mean of each region in every frame that exists; None in frames where it has no value.

    ``left_out`` has for each region the reason why it has no mean at all, or None.

    Raises
    ------
    DataError
        All regions lie outside the image, or the layer does not exist.
    """
    opened, chosen, frames = source.opened, source.layer(layer), source.done()
    masks: list[NDArray[np.intp]] = []
    reasons: list[str | None] = []
    for region in regions:
        try:
            masks.append(np.flatnonzero(region.mask(opened.rows, opened.columns)))
            reasons.append(None)
        except DataError as error:
            masks.append(np.empty(0, np.intp))
            reasons.append(str(error))
    if all(reasons):
        raise DataError(str(reasons[0]))
    means = np.full((len(masks), frames.size), np.nan)
    for place, frame in enumerate(frames.tolist()):
        if place % _STEP == 0:
            progress(place, frames.size)
        image = source.read_once(frame, chosen.name).ravel()
        for row, mask in enumerate(masks):
            inside = image[mask].astype(np.float64)
            inside = inside[np.isfinite(inside)]
            if inside.size:
                means[row, place] = inside.mean()
    return {
        "frames": frames.tolist(),
        "times_s": source.times(frames),
        "left_out": reasons,
        "means": [[number(value) for value in row] for row in means.tolist()],
        "label": chosen.label,
        "unit": chosen.unit,
    }


def project(source: ViewerSource, layer: str | None, progress: Progress) -> JsonObject:
    """Compute mean, standard deviation and maximum over time of a layer, add them to the source as layers, and return their names.

    Deviations are taken from the mean of the frames up to each one and corrected (Welford 1962), so that no sum of squares loses digits.

    Raises
    ------
    DataError
        The layer does not exist, or no frame is written.
    """
    chosen, frames, opened = source.layer(layer), source.done(), source.opened
    if not frames.size:
        raise DataError("mean over time: no frame is written yet; wait for the first one")
    if chosen.over_frames is not None:
        raise DataError(f"{chosen.label}: is computed over time already; choose another layer")
    shape = opened.rows, opened.columns
    count = np.zeros(shape, np.int64)
    mean, squares, largest = np.zeros(shape), np.zeros(shape), np.full(shape, -np.inf)
    for place, frame in enumerate(frames.tolist()):
        if place % _STEP == 0:
            progress(place, frames.size)
        image = source.read_once(frame, chosen.name).astype(np.float64)
        finite = np.isfinite(image)
        count += finite
        # A missing value is replaced by the mean so far, which changes neither mean nor deviation.
        image = np.where(finite, image, mean)
        change = image - mean
        mean += change / np.maximum(count, 1)
        squares += change * (image - mean)
        np.maximum(largest, image, out=largest, where=finite)
    seen = count > 0
    images = (mean, np.sqrt(squares / np.maximum(count, 1)), largest)
    made = [np.where(seen, values, np.nan) for values in images]
    return {"layers": source.add_over_time(chosen, dict(zip(OVER_TIME, made, strict=True)), int(frames.size))}


def profile(image: NDArray[Any], ends: tuple[float, float, float, float]) -> tuple[Floats, Floats, Floats, Floats]:
    """Return distance [px], columns, rows and values along a line, about one value a pixel, interpolated linearly between pixel centres.

    Parameters
    ----------
    image : ndarray
        Values (rows, columns).
    ends : (float, float, float, float)
        Column and row of the first end and of the last; whole numbers are centres of pixels.

    Raises
    ------
    DataError
        An end lies outside the image.
    """
    rows, columns = image.shape
    first, last = np.array(ends[:2]), np.array(ends[2:])
    if not all(0.0 <= v <= most for v, most in zip(ends, (columns - 1, rows - 1) * 2, strict=True)):
        raise DataError(f"line from {ends[:2]} to {ends[2:]}: reaches outside the {columns} x {rows} pixels; drag it inside")
    length = float(np.hypot(*(last - first)))
    shares = np.linspace(0.0, 1.0, max(round(length), 1) + 1)
    x, y = (first[:, np.newaxis] + (last - first)[:, np.newaxis] * shares).round(9)
    left, top = np.minimum(np.floor(x).astype(np.int64), columns - 1), np.minimum(np.floor(y).astype(np.int64), rows - 1)
    values = np.zeros(shares.size)
    for across in (0, 1):
        for down in (0, 1):
            weight = np.abs(1 - across - (x - left)) * np.abs(1 - down - (y - top))
            near = image[np.minimum(top + down, rows - 1), np.minimum(left + across, columns - 1)].astype(np.float64)
            # A pixel without a value must not enter where it has no weight.
            values += np.where(weight > 0.0, weight * near, 0.0)
    return shares * length, x, y, values
