r"""Changes of a detector's counts by objects: centre, peak and signal-to-noise ratio, and masks of responses after the optics.

A target that is smaller than a pixel touches one pixel at the aperture; optics, pixels and motion spread its light over several. The mask
of its response is

.. math:: M = \{p : |r_p| \ge s \max_q |r_q|\} \cup \{p : c_p \ge 1/2\}

with the change ``r`` of the counts by the object before noise, within the detector's full scale, the share ``s`` of
``render.mask_share``, and the share ``c`` of a pixel that the object covers at the aperture. The second set completes large bodies: a hot
part would leave out the rest, and their change passes through zero between warm and cold parts.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.figures_of_merit import budget
from seaglint.instrument.local_light import PictureWindow
from seaglint.instrument.optics import cos4_falloff
from seaglint.objects.drawing.truth import spanned_columns
from seaglint.store.layout import packed
from seaglint.studies.sequence.scene_objects import Numbers

LEAST_SUM: Final = 1e-3  #: Least sum of an object's light over the sum of its amounts for which it has a middle [1].


@dataclass(frozen=True, eq=False)
class CountedChange:
    """Change of a detector's units by an object, before noise and within the full scale, in a window of the picture."""

    rows: NDArray[np.int64]  #: Rows of the window [(rows, 1)].
    columns: NDArray[np.int64]  #: Columns of the window, which in a panorama may continue across the seam [(1, columns)].
    light: FloatArray  #: Change of the radiance on the pixels [W m-2 sr-1, (rows, columns)].
    added: FloatArray  #: Change [units, (rows, columns)].
    radiance: FloatArray  #: Radiance on the pixels, with objects [W m-2 sr-1, (rows, columns)].
    width: int  #: Columns of the picture.


def counted_changes(
    windows: Sequence[PictureWindow | None], seen: NDArray[np.float32], model: SensorModel
) -> tuple[CountedChange | None, ...]:
    """Return the change of a detector's units by each object, before noise and within its full scale; None out of the picture.

    Parameters
    ----------
    windows : sequence of PictureWindow
        Change of the radiance on the pixels by each object [W m-2 sr-1]; None out of the picture.
    seen : ndarray
        Radiance on the pixels, with objects [W m-2 sr-1, (rows, columns)].
    model : SensorModel
        The sensor.
    """
    line, rows, columns = model.readout, *seen.shape
    unscattered = 1.0 - model.optics.stray_share
    out: list[CountedChange | None] = []
    for window in windows:
        if window is None:
            out.append(None)
            continue
        top, left, change = window
        j, i = top + np.arange(change.shape[0])[:, None], left + np.arange(change.shape[1])[None, :]
        light = unscattered * change.astype(np.float64)
        if model.optics.cos4:
            x, y = ((place - 0.5 * (size - 1)) * model.ifov for place, size in ((i[0] % columns, columns), (j[:, 0], rows)))
            light = light * cos4_falloff(np.zeros(x.size) if model.scanning else x, y)
        radiance = seen[j, i % columns].astype(np.float64)
        with_it, without = (np.clip(line.units(np.maximum(view, 0.0)), None, line.full_scale) for view in (radiance, radiance - light))
        out.append(CountedChange(j, i, light, with_it - without, radiance, columns))
    return tuple(out)


def count_numbers(changes: Sequence[CountedChange | None], model: SensorModel) -> Numbers:
    """Return centre, peak and signal-to-noise ratio of the counts that objects add, before a detector's noise and within its full scale.

    Parameters
    ----------
    changes : sequence of CountedChange
        Change by each object; None out of the picture.
    model : SensorModel
        The sensor. Its noise is the temporal noise of a pixel, by the budget of :mod:`seaglint.instrument.figures_of_merit`.
    """
    names = ("counts_column_px", "counts_row_px", "counts_peak", "counts_snr")
    out = {name: np.full(len(changes), math.nan) for name in names}
    # An object out of the picture has no counts (NaN).
    for n, change in enumerate(changes):
        if change is None:
            continue
        added = change.added
        total, amount = float(added.sum()), float(np.abs(added).sum())
        out["counts_peak"][n] = out["counts_snr"][n] = 0.0
        if amount == 0.0:
            continue
        # Light and dark parts that cancel have no centre.
        if abs(total) > LEAST_SUM * amount:
            column = float((added * change.columns).sum()) / total
            # Columns of a panorama continue across the seam.
            out["counts_column_px"][n] = (column + 0.5) % change.width - 0.5 if model.circle else column
            out["counts_row_px"][n] = float((added * change.rows).sum()) / total
        down, across = np.unravel_index(int(np.abs(added).argmax()), added.shape)
        out["counts_peak"][n] = float(added[down, across]) / model.readout.gain
        out["counts_snr"][n] = abs(float(added[down, across])) / budget(model, max(float(change.radiance[down, across]), 0.0)).total
    return out


def response_masks(
    changes: Sequence[CountedChange | None], touched: Sequence[NDArray[np.bool_]], filled: Sequence[NDArray[np.bool_]], share: float
) -> list[NDArray[np.bool_]]:
    """Return the mask of each object's response after the optics.

    An object has the mask of the pixels that it touches if the pixel of its most light does not change, being saturated without it. An
    object that touches no pixel of the picture has none: of light that comes in from outside the picture the peak is not known.

    Parameters
    ----------
    changes : sequence of CountedChange
        Change by each object; None out of the picture.
    touched, filled : sequence of ndarray
        Pixels that each object touches, and pixels that it covers by at least half, at the aperture (rows, columns).
    share : float
        Share of its peak from which a pixel belongs to a response [1].
    """
    out = []
    for change, outline, full in zip(changes, touched, filled, strict=True):
        if change is None or not outline.any() or not change.added.any():
            out.append(outline)
            continue
        # Of a bright target all saturated pixels have nearly the largest change; before a saturated sea the middle has none.
        size, light = np.abs(change.added), np.abs(change.light)
        if size.flat[int(light.argmax())] < share * size.max():
            out.append(outline)
            continue
        mask = full.copy()
        j, i = np.nonzero(size >= share * size.max())
        mask[change.rows[j, 0], change.columns[0, i] % change.width] = True
        out.append(mask)
    return out


def response_arrays(masks: Sequence[NDArray[np.bool_]], *, around: bool) -> Mapping[str, NDArray[Any]]:
    """Return the stored arrays of masks of responses: ``response_mask``, number of pixels, and box; NaN of empty masks.

    On a picture that closes on itself (``around``) a box across the seam continues beyond the right edge.
    """
    numbers = {name: np.full(len(masks), math.nan) for name in (f"response_{side}_px" for side in ("left", "top", "width", "height"))}
    for n, mask in enumerate(masks):
        if not mask.any():
            continue
        rows, columns = np.nonzero(mask)
        left, right = spanned_columns(columns, mask.shape[1], around)
        numbers["response_left_px"][n], numbers["response_width_px"][n] = left, right - left
        numbers["response_top_px"][n], numbers["response_height_px"][n] = rows.min(), np.ptp(rows) + 1
    return {**numbers, "response_pixels": np.array([mask.sum() for mask in masks], np.float64), "response_mask": packed(masks)}
