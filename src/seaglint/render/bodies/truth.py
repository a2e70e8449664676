"""Labels of bodies in an image: numbers and masks from what is seen of them, in pixels of the image or of a coarser detector."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.conventions import FloatArray
from seaglint.render.bodies.compose import LEAST_COVER, Sight

SURROUND: Final = 10
"""Pixels around a body's box over which its clutter is taken."""

LEAST_CLUTTER: Final = 8
"""Pixels of sea that a clutter needs."""

NUMBERS: Final = (
    "column_px",
    "row_px",
    "range_m",
    "solid_angle_sr",
    "visible_share",
    "contrast_W_m2_sr",
    "bearing_deg",
    "elevation_deg",
    "bbox_left_px",
    "bbox_top_px",
    "bbox_width_px",
    "bbox_height_px",
    "temperature_difference_K",
    "signal_to_clutter",
    "pixels",
    "irradiance_W_m2",
    "signal_column_px",
    "signal_row_px",
)
"""Numbers of a body in a frame, in the order of the columns of tables; what is not known of a body out of view is NaN."""


@dataclass(frozen=True, eq=False)
class _Pixels:
    """What a body leaves in a box of pixels: coverage, radiance times it, the sea's share that it hides, and their solid angles."""

    top: int
    left: int
    cover: FloatArray
    added: FloatArray
    hidden: FloatArray
    solid: FloatArray
    seen: NDArray[np.bool_]

    @property
    def where(self) -> tuple[slice, slice]:
        """The box in the image."""
        return slice(self.top, self.top + self.seen.shape[0]), slice(self.left, self.left + self.seen.shape[1])


def labels(
    sights: tuple[Sight, ...], sea: NDArray[Any], kelvin: Callable[[float], float], oversampling: int = 1, *, around: bool = False
) -> tuple[Mapping[str, FloatArray], list[NDArray[np.bool_]], NDArray[np.uint16]]:
    """Numbers (:data:`NUMBERS`) of bodies, their masks (rows, columns), and the number, from 1, of the body that covers most of a pixel.

    Parameters
    ----------
    sights : tuple of Sight
        What is seen of each body.
    sea : ndarray
        Image of the sea alone [W m-2 sr-1, (rows, columns)], in pixels as fine as they were drawn.
    kelvin : callable
        Apparent temperature [K] of a radiance.
    oversampling : int
        Pixels drawn along the side of one that is labelled.
    around : bool
        Whether the image goes round the horizon: bodies on its seam are whole.
    """
    n = oversampling
    shape = (sea.shape[0] // n, sea.shape[1] // n)
    coarse = np.asarray(sea, np.float64).reshape(shape[0], n, shape[1], n).mean(axis=(1, 3)) if n > 1 else np.asarray(sea, np.float64)
    number, most = np.zeros(shape, np.uint16), np.zeros(shape)
    boxes = [_pixels(sight, n, shape) for sight in sights]
    masks = []
    for body, found in enumerate(boxes, 1):
        mask = np.zeros(shape, bool)
        if found is not None:
            mask[found.where] = found.seen
            more = found.seen & (found.cover >= most[found.where]) & ((found.cover > 0.0) | (number[found.where] == 0))
            number[found.where] = np.where(more, np.uint16(body), number[found.where])
            most[found.where] = np.where(more, found.cover, most[found.where])
        masks.append(mask)
    rows = [
        _numbers(sight, found, coarse, number > 0, kelvin, (n, shape[1] if around else 0))
        for sight, found in zip(sights, boxes, strict=True)
    ]
    return {name: np.array([row[name] for row in rows], np.float64) for name in NUMBERS}, masks, number


def _pixels(sight: Sight, n: int, shape: tuple[int, int]) -> _Pixels | None:
    """Sums over a body's shares in the pixels that are labelled."""
    shares = [share for share in sight.shares if share.cover.size]
    if not shares:
        return None
    top, bottom = min(int(s.rows.min()) for s in shares) // n, max(int(s.rows.max()) for s in shares) // n + 1
    left, right = min(int(s.columns.min()) for s in shares) // n, max(int(s.columns.max()) for s in shares) // n + 1
    top, left, bottom, right = max(top, 0), max(left, 0), min(bottom, shape[0]), min(right, shape[1])
    size = (bottom - top, right - left)
    cover, added, hidden, solid = (np.zeros(size) for _ in range(4))
    seen = np.zeros(size, bool)
    for s in shares:
        where = np.ix_(s.rows // n - top, s.columns // n - left)
        index = tuple(np.broadcast_arrays(*where))
        np.add.at(cover, index, s.cover / n**2)
        np.add.at(added, index, s.radiance * s.pixel)
        np.add.at(hidden, index, s.cover * s.image * s.pixel)
        np.maximum.at(solid, index, s.pixel * n**2)
        np.logical_or.at(seen, index, (s.cover > LEAST_COVER) | (s.radiance > 0.0))
    return _Pixels(top, left, cover, added, hidden, solid, seen) if seen.any() else None


def _numbers(
    sight: Sight,
    found: _Pixels | None,
    sea: FloatArray,
    covered: NDArray[np.bool_],
    kelvin: Callable[[float], float],
    pixels: tuple[int, int],
) -> dict[str, float]:
    """Numbers of one body; ``pixels``: drawn along the side of one, and those around the horizon, 0 where the image does not go round."""
    n, circle = pixels
    row = dict.fromkeys(NUMBERS, math.nan)
    row |= {
        "range_m": sight.distance,
        "solid_angle_sr": sight.whole,
        "visible_share": 0.0,
        "bearing_deg": math.degrees(sight.azimuth) % 360.0,
        "elevation_deg": math.degrees(sight.elevation),
        "pixels": 0.0,
        "irradiance_W_m2": 0.0,
    }
    if found is None:
        return row
    difference = found.added - found.hidden
    total = float(difference.sum())
    point = sight.seen == 0.0
    weight = 1.0 if point else sight.seen
    row["visible_share"] = 1.0 if point else min(sight.seen / sight.whole, 1.0) if sight.whole > 0.0 else math.nan
    column = sight.across / weight / n
    row["column_px"] = (column % circle if circle else column) - 0.5
    row["row_px"] = sight.down / weight / n - 0.5
    place = found.left + np.arange(found.seen.shape[1], dtype=np.float64)
    if circle:  # from the body's middle to both sides
        place += circle * np.floor((row["column_px"] - place) / circle + 0.5)
    rows, columns = np.flatnonzero(found.seen.any(axis=1)), place[found.seen.any(axis=0)]
    left = float(columns.min())
    row["bbox_left_px"], row["bbox_top_px"] = left % circle if circle else left, float(found.top + rows.min())
    row["bbox_width_px"], row["bbox_height_px"] = float(np.ptp(columns) + 1), float(np.ptp(rows) + 1)
    row["pixels"] = float(found.cover.sum())
    row["irradiance_W_m2"] = total
    if abs(total) > 0.0:
        middle = float((difference * place).sum()) / total
        row["signal_column_px"] = (middle + 0.5) % circle - 0.5 if circle else middle
        row["signal_row_px"] = found.top + float((difference.sum(axis=1) * np.arange(difference.shape[0])).sum()) / total
    if not point:
        row["contrast_W_m2_sr"] = total / sight.seen
        row["temperature_difference_K"] = kelvin(float(found.added.sum()) / sight.seen) - kelvin(float(found.hidden.sum()) / sight.seen)
    spread = _clutter(found, sea, covered)
    peak = difference / np.where(found.solid > 0.0, found.solid, 1.0)
    if spread > 0.0:
        row["signal_to_clutter"] = float(np.abs(peak).max()) / spread
    return row


def _clutter(found: _Pixels, sea: FloatArray, covered: NDArray[np.bool_]) -> float:
    """Standard deviation of the sea's image around a body [W m-2 sr-1]; NaN where too little is left of it."""
    top, left = max(found.top - SURROUND, 0), max(found.left - SURROUND, 0)
    bottom, right = found.top + found.seen.shape[0] + SURROUND, found.left + found.seen.shape[1] + SURROUND
    around = sea[top:bottom, left:right][~covered[top:bottom, left:right]]
    around = around[np.isfinite(around)]
    return float(around.std()) if around.size >= LEAST_CLUTTER else math.nan
