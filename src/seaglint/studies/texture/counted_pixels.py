"""Pixels of a recording that count for a texture: what is no sea, a user's mask and missing values are NaN."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError
from seaglint.clutter.correlation import BoolArray
from seaglint.clutter.defects import find_defects
from seaglint.studies.study_requests import WeightsFile, values_of
from seaglint.textures.suitability import PixelRegion

Frames = NDArray[np.float32]


@dataclass(frozen=True)
class CountedPixels:
    """Frames with NaN where a pixel does not count."""

    frames: Frames  #: Frames of the region [u].
    notes: tuple[str, ...] = ()  #: A sentence for each kind of pixels that are left out.
    counts: dict[str, int] = field(default_factory=dict)  #: Number of pixels left out by kind [px]; of missing ones, of values.


def counted_pixels(
    frames: Frames, recording: Recording, region: PixelRegion, *, keep_defects: bool = False, mask: Any = None
) -> CountedPixels:
    """Leave out missing values, a mask, and what ``seaglint.clutter.defects`` finds.

    Parameters
    ----------
    frames : ndarray, shape (frames, rows, columns)
        Frames of the region [u].
    recording, region : Recording, PixelRegion
        Size of the picture, and the region in it.
    keep_defects : bool
        Whether nothing is searched.
    mask : array_like or WeightsFile, optional
        Numbers of the picture's or the region's size; pixels that are not 0 are left out.

    Raises
    ------
    DataError
        A mask of another size, or that cannot be read.
    """
    notes: list[str] = []
    counts: dict[str, int] = {}
    missing = ~np.isfinite(frames)
    if missing.any():
        counts["missing"] = int(np.count_nonzero(missing))
        share = 100.0 * counts["missing"] / frames.size
        notes.append(f"{counts['missing']} values ({share:.3g} %) are left out: missing or infinite")
        frames = np.where(missing, np.float32(np.nan), frames)
    if mask is not None:
        given = _mask(mask, recording, region)
        counts["mask"] = int(np.count_nonzero(given))
        share = 100.0 * counts["mask"] / given.size
        name = f"the mask {mask.path}" if isinstance(mask, WeightsFile) else "the mask"
        notes.append(f"{counts['mask']} pixels ({share:.3g} %) left out: {name}")
        frames = np.where(given, np.float32(np.nan), frames)
    if not keep_defects:
        borders = (region.top == 0, region.bottom == recording.rows, region.left == 0, region.right == recording.columns)
        found = find_defects(frames, origin=(region.top, region.left), borders=borders)
        notes += found.notes
        counts |= found.counts
        if found.mask.any():
            frames = np.where(found.mask, np.float32(np.nan), frames)
    return CountedPixels(frames, tuple(notes), counts)


def like(sample: Frames, data: Frames) -> Frames:
    """Return a sample without the pixels that do not count in data of its size, so that both have the same gaps."""
    if sample.shape != data.shape:
        # A field without time has one frame: its pixels are those of all frames.
        if sample.shape[1:] != data.shape[1:]:
            return sample
        gaps = np.isnan(data).all(axis=0)
        return np.where(gaps, np.float32(np.nan), sample) if gaps.any() else sample
    gaps = np.isnan(data)
    return np.where(gaps, np.float32(np.nan), sample) if gaps.any() else sample


def _mask(given: Any, recording: Recording, region: PixelRegion) -> BoolArray:
    """Return a mask of the picture's or the region's size inside the region; True where a pixel is left out."""
    values = np.asarray(values_of(given))
    name = f"{given.path}: a mask" if isinstance(given, WeightsFile) else "mask: an array"
    if values.dtype.kind not in "biuf":
        raise DataError(f"{name} of {values.dtype} values; give numbers or true and false, not 0 where pixels are left out")
    if values.shape == (recording.rows, recording.columns):
        values = values[region.top : region.bottom, region.left : region.right]
    elif values.shape != (region.bottom - region.top, region.right - region.left):
        raise DataError(
            f"{name} of {' x '.join(map(str, values.shape))} pixels; give one of the picture's size, {recording.rows} x {recording.columns}"
        )
    return np.asarray(np.nan_to_num(values) != 0)
