"""Displayed picture of a source: one layer, optionally less the layer of another source, on a brightness scale.

The scale maps values to 255 levels: linearly, between percentiles, or by plateau equalisation. Level 0 marks pixels without a value. The
browser draws the colours of the levels.
"""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import CELLS, Scale
from seaglint.base.errors import DataError
from seaglint.viewer.frame_source import ViewerSource, evenly

Kind = Literal["linear", "percentile", "plateau"]
KINDS: Final[tuple[str, ...]] = get_args(Kind)

PERCENTILES: Final = (1.0, 99.0)  #: Percentiles of the values that percentile scaling maps to dark and bright [%].

PLATEAU: Final = 3.0  #: Largest count of a bin in plateau equalisation, in mean counts of the bins that are not empty.


def scaling_of(
    images: Sequence[NDArray[np.floating[Any]]],
    kind: str,
    *,
    limits: tuple[float, float] | None = None,
    percentiles: tuple[float, float] = PERCENTILES,
    symmetric: bool = False,
) -> Scale:
    """Return the brightness scale of images: of a single frame, or of several for a sequence.

    Parameters
    ----------
    images : sequence of ndarray
        Images that determine the scale.
    kind : {"linear", "percentile", "plateau"}
        Linear from the smallest to the largest value, linear between two percentiles, or by plateau equalisation: every level has as many
        pixels, where cells of the histogram count up to a plateau only (Vickers 1996), so that an even sky does not take all levels.
    limits : (float, float), optional
        Ends of a linear scale, used instead [unit of the images].
    percentiles : (float, float)
        Lower and upper percentile [%].
    symmetric : bool
        Zero in the middle, for differences.

    Raises
    ------
    DataError
        The kind is not known, or the limits are no range.
    """
    if kind not in KINDS:
        raise DataError(f"scaling '{kind}': allowed are {', '.join(KINDS)}")
    if limits is not None:
        low, high = limits
        if not (np.isfinite([low, high]).all() and low < high):
            raise DataError(f"limits {low:g} to {high:g}: give two finite numbers, the smaller first")
        return Scale(low, high)
    if not 0.0 <= percentiles[0] < percentiles[1] <= 100.0:
        raise DataError(f"percentiles {percentiles[0]:g} and {percentiles[1]:g}: give two from 0 to 100, the smaller first")
    values = np.concatenate([image[np.isfinite(image)].ravel() for image in images]) if images else np.empty(0)
    if not values.size:
        return Scale(0.0, 1.0)
    low, high = (float(v) for v in (np.percentile(values, percentiles) if kind == "percentile" else (values.min(), values.max())))
    if symmetric:
        # Differences of either sign are equally far from the middle of the scale.
        high = max(abs(low), abs(high))
        low = -high
    if kind != "plateau" or not high > low:
        return Scale(low, high)
    counts = np.histogram(values, bins=CELLS, range=(low, high))[0].astype(np.float64)
    counts = np.minimum(counts, PLATEAU * counts.sum() / np.count_nonzero(counts))
    return Scale(low, high, steps=np.concatenate([[0.0], np.cumsum(counts) / counts.sum()]))


SAMPLED: Final = 12  #: Number of frames that set a scale for all.

MOST_SAMPLED: Final = 1_000_000  #: Largest number of pixels of these frames that enter percentiles and histograms.

_MOST_CACHED: Final = 64  #: Largest number of cached scales.


@dataclass(frozen=True)
class Show:
    """Displayed selection: source, layer, difference and scale."""

    source: ViewerSource  #: Displayed frames.
    layer: str | None = None  #: Layer of both sources.
    minus: ViewerSource | None = None  #: Frames that are subtracted from them one by one; None subtracts none.
    kind: str = "percentile"  #: One of ``seaglint.viewer.picture.KINDS``.
    fixed: bool = True  #: Flag: one scale for all frames, from some of them; otherwise a scale for each frame.
    limits: tuple[float, float] | None = None  #: Ends of a linear scale, given by hand.

    def image(self, index: int) -> NDArray[np.floating[Any]]:
        """Return the values of a frame (rows, columns) [unit of the layer].

        Raises
        ------
        DataError
            The frame or the layer does not exist, or the two sources differ in size or unit.
        """
        values = self.source.read(index, self.layer)
        if self.minus is None:
            return values
        mine = self.source.layer(self.layer)
        other = self.minus.layer(self.layer)
        if other.unit != mine.unit:
            raise DataError(
                f"difference: {mine.label} [{mine.unit}] and {other.label} [{other.unit}] have different units; choose one layer"
            )
        taken = self.minus.read(index, self.layer)
        if taken.shape != values.shape:
            sizes = " and ".join(f"{image.shape[1]} x {image.shape[0]}" for image in (values, taken))
            raise DataError(f"difference: the pictures have {sizes} pixels; give two of one size")
        return values - taken

    @property
    def key(self) -> tuple[Any, ...]:
        """Return a key that identifies the selection, without the frame."""
        sources = tuple((s.path, s.stamp) for s in (self.source, self.minus) if s is not None)
        # An image over time changes with the frames that it was computed from.
        return (*sources, self.layer, self.source.layer(self.layer).over_frames, self.kind, self.fixed, self.limits)


class Scales:
    """Cache of the latest scales: a scale for a whole sequence requires reading several frames."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._cached: OrderedDict[tuple[Any, ...], Scale] = OrderedDict()

    def of(self, show: Show, index: int) -> Scale:
        """Return the scale of a frame."""
        symmetric = show.minus is not None
        if show.limits is not None:
            return scaling_of((), show.kind, limits=show.limits)
        if not show.fixed:
            return scaling_of([show.image(index)], show.kind, symmetric=symmetric)
        frames = sampled(show)
        key = (*show.key, tuple(frames.tolist()))
        with self._lock:
            scaling = self._cached.get(key)
            if scaling is None:
                images = [show.image(int(frame)) for frame in frames]
                pixels = sum(image.size for image in images)
                # Extremes need every pixel; percentiles and histograms are stable with every n-th row and column.
                if show.kind != "linear" and pixels > MOST_SAMPLED:
                    step = int(np.ceil(np.sqrt(pixels / MOST_SAMPLED)))
                    images = [image[::step, ::step] for image in images]
                scaling = scaling_of(images, show.kind, symmetric=symmetric)
                self._cached[key] = scaling
                while len(self._cached) > _MOST_CACHED:
                    self._cached.popitem(last=False)
        return scaling


def sampled(show: Show) -> NDArray[np.int64]:
    """Return the frames that set the scale for all: evenly spaced, and changing rarely while a sequence grows."""
    done = show.source.done()
    if show.minus is not None:
        done = np.intersect1d(done, show.minus.done())
    if done.size < show.source.opened.frames and done.size:
        # Down to a power of two: while a sequence is being written, the scale changes only when its length has doubled.
        done = done[: 1 << (int(done.size).bit_length() - 1)]
    return evenly(done, SAMPLED)


def tag(show: Show, index: int, scaling: Scale) -> str:
    """Return the ETag of a picture; equal pictures have equal tags."""
    content = repr((show.key, index, scaling.low, scaling.high)).encode() + (b"" if scaling.steps is None else scaling.steps.tobytes())
    return f'"{hashlib.blake2b(content, digest_size=12).hexdigest()}"'
