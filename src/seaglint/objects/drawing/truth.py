"""Labels of bodies in an image: ground-truth numbers and masks from their sights."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.schema import MOST_SMALL, NUMBERS
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.objects.drawing.compose import BodySight

SURROUND: Final = 10  #: Width of the frame around a body's box in which its clutter is evaluated [pixels].

HALF: Final = 0.5  #: Coverage from which a body fills a pixel [1].

LEAST_CLUTTER: Final = 8  #: Least number of pixels of sea for a clutter value.


@dataclass(frozen=True, eq=False)
class _Pixels:
    """Sums of a body in a box of pixels (rows, columns)."""

    top: int  #: First row of the box.
    left: int  #: First column of the box.
    shape: tuple[int, int]  #: Rows and columns of the image.
    around: bool  #: True for an image that closes on itself; columns of a box may continue beyond its right edge.
    cover: FloatArray  #: Coverage of the pixels [1].
    added: FloatArray  #: Radiance of the body times coverage times solid angle [W m-2].
    hidden: FloatArray  #: Radiance of the hidden sea times coverage times solid angle [W m-2].
    solid: FloatArray  #: Solid angle of the pixels that the body touches [sr].
    seen: NDArray[np.bool_]  #: True for pixels that the body touches.

    def where(self) -> tuple[NDArray[Any], ...]:
        """Return the indices of the box in the image."""
        rows, columns = self.seen.shape
        return np.ix_(self.top + np.arange(rows), (self.left + np.arange(columns)) % self.shape[1])

    def frame(self, margin: int) -> tuple[NDArray[Any], ...]:
        """Return the indices of the box with a margin [pixels], of nearly constant area also at the edge of the image.

        A standard deviation over fewer pixels of a correlated sea would not be comparable. More columns replace rows beyond the edge, as
        the sea changes with elevation; columns beyond the edge are replaced on the other side.
        """
        rows, columns = (size + 2 * margin for size in self.seen.shape)
        top, bottom = max(self.top - margin, 0), min(self.top - margin + rows, self.shape[0])
        width = min(math.ceil(rows * columns / (bottom - top)), self.shape[1])
        left = self.left - margin - (width - columns) // 2
        # the box moves inwards at the edge of the image and has its full width
        left = left if self.around else min(max(left, 0), self.shape[1] - width)
        return np.ix_(np.arange(top, bottom), (left + np.arange(width)) % self.shape[1])


def labels(
    sights: tuple[BodySight, ...], sea: NDArray[Any], kelvin: Callable[[float], float], *, around: bool = False
) -> tuple[Mapping[str, FloatArray], list[NDArray[np.bool_]], NDArray[np.uint16]]:
    """Return numbers and masks of bodies in an image, and the number of the body in each pixel.

    The numbers are ``NUMBERS``, the masks (rows, columns); a pixel has the number of the body
    that covers most of it, from 1.

    Parameters
    ----------
    sights : tuple of BodySight
        Sight of each body.
    sea : ndarray
        Image of the sea alone [W m-2 sr-1, (rows, columns)].
    kelvin : callable
        Apparent temperature [K] of a radiance.
    around : bool
        True for an image that closes on itself: columns of a box across the seam continue beyond the right edge.
    """
    image = np.asarray(sea, np.float64)
    shape = image.shape[0], image.shape[1]
    boxes = [_pixels(sight, shape, around) for sight in sights]
    masks, number = _owners(boxes, shape)
    rows = [_numbers(sight, box, image, number > 0, kelvin) for sight, box in zip(sights, boxes, strict=True)]
    return {name: np.array([row[name] for row in rows], np.float64) for name in NUMBERS}, masks, number


def size_classes(labels: Mapping[str, NDArray[np.float64]], imager: Imager, attitude: Attitude) -> FloatArray:
    """Return the class of each object's size in pixels at its place: 0 point, 1 small, 2 extended.

    The names of the classes are ``SIZES``. An object of unknown place is taken at the middle of the picture.
    """
    column, row = (
        np.nan_to_num(labels[name] + 0.5, nan=0.5 * size) for name, size in (("column_px", imager.columns), ("row_px", imager.rows))
    )
    size = labels["solid_angle_sr"] / imager.solid_angle(attitude, column, row)
    return np.where(size < 1.0, 0.0, np.where(size <= MOST_SMALL, 1.0, 2.0))


def numbers_of(sights: tuple[BodySight, ...], shape: tuple[int, int], *, around: bool = False) -> NDArray[np.uint16]:
    """Return the number [1], from 1, of the body that covers most of a pixel; 0 without a body (rows, columns)."""
    return _owners([_pixels(sight, shape, around) for sight in sights], shape)[1]


def filled(sights: tuple[BodySight, ...], shape: tuple[int, int], *, around: bool = False) -> list[NDArray[np.bool_]]:
    """Return for each body the pixels (rows, columns) of an image of which it covers at least half."""
    out = []
    for box in (_pixels(sight, shape, around) for sight in sights):
        mask = np.zeros(shape, bool)
        if box is not None:
            mask[box.where()] = box.cover >= HALF
        out.append(mask)
    return out


def _owners(boxes: list[_Pixels | None], shape: tuple[int, int]) -> tuple[list[NDArray[np.bool_]], NDArray[np.uint16]]:
    """Return the masks of bodies, and the number of the body that covers most of each pixel."""
    number, most, masks = np.zeros(shape, np.uint16), np.zeros(shape), []
    for body, box in enumerate(boxes, 1):
        mask = np.zeros(shape, bool)
        if box is not None:
            where = box.where()
            mask[where] = box.seen
            # of equal covers the later body has the pixel, but a point takes no pixel from another body
            covers_most = box.seen & (box.cover >= most[where]) & ((box.cover > 0.0) | (number[where] == 0))
            number[where] = np.where(covers_most, np.uint16(body), number[where])
            most[where] = np.where(covers_most, box.cover, most[where])
        masks.append(mask)
    return masks, number


def _pixels(sight: BodySight, shape: tuple[int, int], around: bool) -> _Pixels | None:
    """Return the sums over a body's shares in the labelled pixels; None for a body that touches no pixel."""
    shares = [share for share in sight.shares if share.cover.size]
    if not shares:
        return None
    top, bottom = min(int(s.rows.min()) for s in shares), max(int(s.rows.max()) for s in shares) + 1
    left, right = spanned_columns(np.concatenate([s.columns for s in shares]), shape[1], around)
    top, bottom = max(top, 0), min(bottom, shape[0])
    size = (bottom - top, right - left)
    # several parts of a body, and its images in a mirage, may share a pixel: their sums add
    cover, added, hidden, solid = (np.zeros(size) for _ in range(4))
    seen = np.zeros(size, bool)
    for s in shares:
        where = np.ix_(s.rows - top, (s.columns - left) % shape[1])
        index = tuple(np.broadcast_arrays(*where))
        np.add.at(cover, index, s.cover)
        np.add.at(added, index, s.radiance * s.pixel)
        np.add.at(hidden, index, s.cover * s.image * s.pixel)
        np.maximum.at(solid, index, s.pixel)
        # a point covers nothing: it touches the pixels to which it adds light
        np.logical_or.at(seen, index, (s.cover > s.least) | ((s.cover == 0.0) & (s.radiance != 0.0)))
    return _Pixels(top, left, shape, around, cover, added, hidden, solid, seen) if seen.any() else None


def spanned_columns(touched: NDArray[np.int64], width: int, around: bool) -> tuple[int, int]:
    """Return the first column and the column after the last; on a full circle they begin after the widest gap and cross the seam."""
    occupied = np.unique(touched)
    first, last = int(occupied[0]), int(occupied[-1])
    gaps = np.diff(occupied)
    if not around or gaps.size == 0 or gaps.max() <= first + width - last:
        return first, last + 1
    k = int(gaps.argmax())
    return int(occupied[k + 1]), int(occupied[k]) + width + 1


def _numbers(
    sight: BodySight, box: _Pixels | None, sea: FloatArray, covered: NDArray[np.bool_], kelvin: Callable[[float], float]
) -> dict[str, float]:
    """Return the ground-truth numbers of one body; NaN for unknown ones."""
    row = dict.fromkeys(NUMBERS, math.nan)
    row |= {
        "range_m": sight.distance,
        "solid_angle_sr": sight.dry if sight.whole > 0.0 else 0.0,
        **_shares(sight),
        "bearing_deg": math.degrees(sight.azimuth) % 360.0,
        "elevation_deg": math.degrees(sight.elevation),
        "pixels": 0.0,
        "irradiance_W_m2": 0.0,
    }
    if box is None:
        return row
    difference = box.added - box.hidden
    total = float(difference.sum())
    # points have no solid angle: their place is a mean, not a ratio of sums
    point = sight.seen == 0.0
    # sums count pixels from their corner, labels from the centre of the first
    weight = 1.0 if point else sight.seen
    row["column_px"] = _on_image(sight.across / weight - 0.5, box)
    row["row_px"] = sight.down / weight - 0.5
    rows, columns = np.nonzero(box.seen)
    row["bbox_left_px"], row["bbox_top_px"] = float(box.left + columns.min()), float(box.top + rows.min())
    row["bbox_width_px"], row["bbox_height_px"] = float(np.ptp(columns) + 1), float(np.ptp(rows) + 1)
    row["pixels"] = float(box.cover.sum())
    row["irradiance_W_m2"] = total
    # the centroid of the change of light, which may be negative: a cold body hides warm sea
    if abs(total) > 0.0:
        j, i = np.mgrid[0 : difference.shape[0], 0 : difference.shape[1]]
        row["signal_column_px"] = _on_image(box.left + float((difference * i).sum()) / total, box)
        row["signal_row_px"] = box.top + float((difference * j).sum()) / total
    if not point:
        row["contrast_W_m2_sr"] = total / sight.seen
        row["temperature_difference_K"] = kelvin(float(box.added.sum()) / sight.seen) - kelvin(float(box.hidden.sum()) / sight.seen)
    clutter = _clutter(box, sea, covered)
    # the change is a radiance times solid angle: over the solid angle it compares with the sea's deviation
    peak = difference / np.where(box.solid > 0.0, box.solid, 1.0)
    if clutter > 0.0:
        row["signal_to_clutter"] = float(np.abs(peak).max()) / clutter
    return row


def _shares(sight: BodySight) -> dict[str, float]:
    """Return the shares of a body in view, hidden in the picture, and outside it [1]."""
    outside, hidden = sight.truncated, sight.occluded
    visible = (1.0 - outside) * (1.0 - hidden) if math.isfinite(outside) and math.isfinite(hidden) else 0.0
    return {"visible_share": visible, "occluded_share": hidden, "truncated_share": outside}


def _on_image(column: float, box: _Pixels) -> float:
    """Return the column in an image that closes on itself, from -0.5 on; unchanged in other images."""
    return (column + 0.5) % box.shape[1] - 0.5 if box.around else column


def _clutter(box: _Pixels, sea: FloatArray, covered: NDArray[np.bool_]) -> float:
    """Return the standard deviation of the sea's image around a body [W m-2 sr-1]; NaN with too few pixels of sea."""
    where = box.frame(SURROUND)
    around = sea[where][~covered[where]]
    around = around[np.isfinite(around)]
    return float(around.std()) if around.size >= LEAST_CLUTTER else math.nan
