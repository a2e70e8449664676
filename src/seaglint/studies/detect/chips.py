"""Pictures of a judged detector: its characteristic, misses and false alarms cut out of the frames, where in the field they are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.detection.injection import Batch, inject
from seaglint.detection.interface import Frames
from seaglint.detection.sources import FrameSource
from seaglint.files.detection_case import Chip, Chips, FalseAlarmMap
from seaglint.studies.detect.performance import Performance

CHIPS: Final = 6  #: Pictures of each kind.

HALF: Final = 12  #: Pixels from their middle to their edge [px].


def chips(found: Performance, source: FrameSource) -> Chips:
    """Pixels about missed objects, with the object in them, and about the highest false alarms.

    Missed ones are the nearest to the threshold and the farthest from it in turn, of the contrast that is missed most nearly half the time.
    """
    threshold = found.threshold.sigma
    events = found.alarms.alarms.events(threshold)
    false = []
    for k in np.argsort(-events.peak, kind="stable")[:CHIPS]:
        window = found.judged.place.of_event(int(events.first[k]))
        frame = _last(found, source, min(window, found.judged.windows - 1))
        place = (int(events.row[k]), int(events.column[k]))
        false.append(Chip(float(events.peak[k]), window, *place, _cut(frame, *place)))
    rates = [float((~s.detected(threshold)).mean()) for s in found.trials.scores]
    lost = [k for k, rate in enumerate(rates) if rate > 0.0]
    missed: list[Chip] = []
    contrast = None
    if lost:
        number = min(lost, key=lambda k: abs(rates[k] - 0.5))
        scores = found.trials.scores[number]
        contrast = scores.contrast
        below = np.flatnonzero(~scores.detected(threshold))
        order = below[np.argsort(-scores.score[below], kind="stable")]
        for k in [*order[: CHIPS // 2], *order[max(order.size - CHIPS // 2, CHIPS // 2) :]]:
            window, row, column = (int(v[k]) for v in (scores.window, scores.row, scores.column))
            batch = Batch(window, np.array([row]), np.array([column]), scores.offset[k : k + 1])
            frame = _with_object(found, source, batch, contrast)
            score = float(scores.score[k])
            score = score if np.isfinite(score) else -99.0
            missed.append(Chip(score, window, row, column, _cut(frame, row, column)))
    return Chips(tuple(missed), tuple(false), contrast)


def characteristic(found: Performance, contrasts: Sequence[float]) -> dict[str, list[float]]:
    """Operating characteristics below each other, with the contrasts as they were stated."""
    curves = [found.characteristic(k) for k in range(len(contrasts))]
    out = {"contrast": np.repeat(contrasts, [c.threshold.size for c in curves]).tolist()}
    for column in ("threshold_sigma", "p_fa", "p_fa_low", "p_fa_high", "p_d", "p_d_low", "p_d_high"):
        out[column] = np.concatenate([c.columns()[column] for c in curves]).tolist()
    return out


def _last(found: Performance, source: FrameSource, window: int) -> Frames:
    last = found.judged.place.start(window) + found.judged.lead
    return np.asarray(source.read(last, last + 1)[0], np.float32)


def _with_object(found: Performance, source: FrameSource, batch: Batch, contrast: float) -> Frames:
    """Last frame of a window with an object as it was judged: counted by the sensor, cut at saturation."""
    frame = _last(found, source, batch.window)
    light = np.zeros_like(frame)[None]
    objects = found.options.objects
    inject(light, batch, objects.shape, contrast)
    counting = source.counting
    if counting is not None:
        last = found.judged.place.start(batch.window) + found.judged.lead
        light = counting.added(light, counting.draws(objects.seed, last, light.shape))
    lit: Frames = frame + light[0]
    if source.saturation is not None:
        np.minimum(lit, np.maximum(frame, np.float32(source.saturation)), out=lit)
    return lit


def _cut(frame: Frames, row: int, column: int) -> list[list[float | None]]:
    padded = np.pad(frame, HALF, constant_values=np.nan)
    part = padded[row : row + 2 * HALF + 1, column : column + 2 * HALF + 1]
    return [[float(f"{v:.6g}") if np.isfinite(v) else None for v in line] for line in part]


def false_alarm_map(found: Performance, azimuth_deg: FloatArray, elevation_deg: FloatArray) -> FalseAlarmMap:
    """False alarms and pixels of each tile of the field, with the tiles' edges as azimuth and elevation; in pixels where the field is no
    grid of them.
    """
    cells = found.alarms.cells
    sums = cells.sums[:, :2].sum(axis=0)
    rows, columns = found.size[1:]
    edges = [np.minimum(np.arange(n + 1) * cells.tile, size) for n, size in zip(sums.shape[1:], (rows, columns), strict=True)]
    grid = azimuth_deg.ndim == 1
    axes = [_at_edges(e, values) if grid else e for e, values in zip(edges, (elevation_deg, azimuth_deg), strict=True)]
    down, right = (np.asarray(axis, float).tolist() for axis in axes)
    return FalseAlarmMap(sums[1].astype(int).tolist(), sums[0].astype(int).tolist(), down, right, grid)


def _at_edges(edges: np.ndarray, centres: FloatArray) -> FloatArray:
    """Angles of the edges of pixels."""
    unwrapped = np.unwrap(centres, period=360.0)
    return (
        np.interp(edges - 0.5, np.arange(centres.size), unwrapped)
        if centres.size < 2
        else (unwrapped[0] + (edges - 0.5) * (unwrapped[-1] - unwrapped[0]) / (centres.size - 1))
    )
