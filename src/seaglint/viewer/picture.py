"""Displayed picture of a source: its layer, an optional source that is subtracted, and its scale."""

from __future__ import annotations

import hashlib
import threading
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import Scale
from seaglint.base.errors import DataError
from seaglint.viewer.frame_source import ViewerSource
from seaglint.viewer.scaling import scaling_of

SAMPLED: Final = 12  #: Number of frames that set a scale for all.

MOST_SAMPLED: Final = 1_000_000  #: Largest number of their pixels that enter percentiles and histograms.

_MOST_CACHED: Final = 64


@dataclass(frozen=True)
class Show:
    """Selection of what is displayed."""

    #: ``source``, ``minus``: Frames, and those that are taken off them, frame by frame.
    source: ViewerSource
    layer: str | None = None  #: Layer of both.
    minus: ViewerSource | None = None  #: See ``source``.
    kind: str = "percentile"  #: One of :data:`seaglint.viewer.scaling.KINDS`.
    fixed: bool = True  #: One scale for all frames, from some of them; otherwise of each frame its own.
    limits: tuple[float, float] | None = None  #: Ends of a linear scale, given by hand.

    def image(self, index: int) -> NDArray[np.floating[Any]]:
        """Return the values of a frame (rows, columns) [unit of the layer].

        Raises
        ------
        DataError
            A frame or a layer that is not there, or two sources of different sizes or units.
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
        return (*sources, self.layer, self.kind, self.fixed, self.limits)


class Scales:
    """Cache of the latest scalings; one for a whole sequence requires reading several frames."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._cached: OrderedDict[tuple[Any, ...], Scale] = OrderedDict()

    def of(self, show: Show, index: int) -> Scale:
        """Return the scaling of a frame."""
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
        done = done[: 1 << (int(done.size).bit_length() - 1)]
    return done[np.unique(np.linspace(0, max(done.size - 1, 0), min(done.size, SAMPLED)).astype(np.int64))]


def tag(show: Show, index: int, scaling: Scale) -> str:
    """Return the ETag of a picture; equal pictures have equal tags."""
    steps = b"" if scaling.steps is None else scaling.steps.tobytes()
    content = repr((show.key, index, scaling.low, scaling.high)).encode() + steps
    return f'"{hashlib.blake2b(content, digest_size=12).hexdigest()}"'
