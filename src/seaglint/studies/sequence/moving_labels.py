"""Labels of objects that move: speed, streak, blur and class of size, and what a detector counts of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.instrument.chain import SensorModel
from seaglint.instrument.figures_of_merit import budget
from seaglint.instrument.optics import cos4_falloff
from seaglint.instrument.picture_windows import PictureWindow
from seaglint.objects.drawing.image_path import Streak

Numbers = dict[str, FloatArray]  #: Numbers of all objects by the names of their columns [(objects,)].

LEAST_SUM = 1e-3  #: Least sum of an object's light over the sum of its amounts for which it has a middle [1].


def motion_numbers(
    streaks: Sequence[Streak | None], labels: Mapping[str, NDArray[np.float64]], blur: float = math.nan, *, mirage: bool = False
) -> Numbers:
    """Speed, streak and blur of objects.

    Parameters
    ----------
    streaks : sequence of Streak
        Ways of the objects; None for those behind the camera.
    labels : mapping
        Their other labels.
    blur : float
        Standard deviation of the sensor's blur [pixels]; NaN without a sensor.
    mirage : bool
        Whether the air shifts objects in the picture: streaks are then shifted to the middle of what is seen.
    """
    names = ("velocity_column_px_s", "velocity_row_px_s", "motion_px", "blur_px")
    ends = ("streak_begin_column_px", "streak_begin_row_px", "streak_end_column_px", "streak_end_row_px")
    out = {name: np.full(len(streaks), math.nan) for name in (*names, *ends)}
    for n, streak in enumerate(streaks):
        if streak is None:
            continue
        place = np.array([labels["column_px"][n], labels["row_px"][n]])
        shift = place - streak.middle if mirage and np.isfinite(place).all() else np.zeros(2)
        out["velocity_column_px_s"][n], out["velocity_row_px_s"][n] = streak.velocity
        out["motion_px"][n] = streak.length
        out["blur_px"][n] = math.sqrt(blur**2 + streak.length**2 / 24.0)
        for name, value in zip(ends, (streak.ends + shift).ravel(), strict=True):
            out[name][n] = value
    return out


def count_numbers(windows: Sequence[PictureWindow | None], seen: NDArray[np.float32], model: SensorModel) -> Numbers:
    """Centre, peak and signal-to-noise ratio of what objects add to a detector's counts, before its noise and within its full scale.

    Parameters
    ----------
    windows : sequence of PictureWindow
        Change of the radiance on the pixels by each object [W m-2 sr-1]; None out of the picture.
    seen : ndarray
        Radiance on the pixels, objects in it [W m-2 sr-1, (rows, columns)].
    model : SensorModel
        The sensor. Its noise is the temporal noise of a pixel, by the budget of :mod:`seaglint.instrument.figures_of_merit`.
    """
    names = ("counts_column_px", "counts_row_px", "counts_peak", "counts_snr")
    out = {name: np.full(len(windows), math.nan) for name in names}
    line, rows, columns = model.readout, *seen.shape
    kept = 1.0 - model.optics.stray_share
    for n, window in enumerate(windows):
        if window is None:
            continue
        top, left, change = window
        j, i = top + np.arange(change.shape[0])[:, None], left + np.arange(change.shape[1])[None, :]
        light = kept * change.astype(np.float64)
        if model.optics.cos4:
            x, y = ((place - 0.5 * (size - 1)) * model.ifov for place, size in ((i[0] % columns, columns), (j[:, 0], rows)))
            light = light * cos4_falloff(np.zeros(x.size) if model.scanning else x, y)
        here = seen[j, i % columns].astype(np.float64)
        with_it, without = (np.clip(line.units(np.maximum(view, 0.0)), None, line.full_scale) for view in (here, here - light))
        added = with_it - without
        total, amount = float(added.sum()), float(np.abs(added).sum())
        out["counts_peak"][n] = out["counts_snr"][n] = 0.0
        if amount == 0.0:
            continue
        if abs(total) > LEAST_SUM * amount:
            column = float((added * i).sum()) / total
            out["counts_column_px"][n] = (column + 0.5) % columns - 0.5 if model.circle else column
            out["counts_row_px"][n] = float((added * j).sum()) / total
        down, across = np.unravel_index(int(np.abs(added).argmax()), added.shape)
        out["counts_peak"][n] = float(added[down, across]) / line.gain
        out["counts_snr"][n] = abs(float(added[down, across])) / budget(model, max(float(here[down, across]), 0.0)).total
    return out
