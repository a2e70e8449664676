"""Probe and trace: a pixel's values in every layer, its direction, and its values over time."""

from __future__ import annotations

import numpy as np

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.viewer.frame_source import ViewerSource


def probe(source: ViewerSource, index: int, row: int, column: int) -> JsonObject:
    """Return the values of a pixel of one frame, by layer, with units; direction and objects where they are known.

    Raises
    ------
    DataError
        A pixel outside the image, or a frame that is not there.
    """
    opened = source.opened
    require_pixel(source, row, column)
    values = []
    for layer in opened.layers.values():
        value = float(source.read(index, layer.name)[row, column])
        values.append({"name": layer.name, "label": layer.label, "unit": layer.unit, "value": value if np.isfinite(value) else None})
    azimuth, elevation = towards(source, index, row, column)
    boxes = source.boxes(index)
    inside = [b.name for b in boxes if b.left <= column < b.left + b.width and b.top <= row < b.top + b.height]
    return {
        "frame": index,
        "row": row,
        "column": column,
        "azimuth_deg": azimuth,
        "elevation_deg": elevation,
        "values": values,
        "objects": inside,
    }


def require_pixel(source: ViewerSource, row: int, column: int) -> None:
    """Refuse a pixel outside the image."""
    opened = source.opened
    if not (0 <= row < opened.rows and 0 <= column < opened.columns):
        raise DataError(f"pixel at row {row}, column {column}: the image has {opened.rows} rows and {opened.columns} columns, from 0")


def towards(source: ViewerSource, index: int, row: int, column: int) -> tuple[float | None, float | None]:
    """Return azimuth and elevation of a pixel's centre [deg]; None where they are not known."""
    angles = source.directions(index)
    if angles is None:
        return None, None
    azimuth, elevation = angles
    if azimuth.ndim == 1:
        return float(azimuth[column]), float(elevation[row])
    return float(azimuth[row, column]), float(elevation[row, column])


def trace(source: ViewerSource, row: int, column: int, around: int, layer: str | None = None, *, spread: bool = False) -> JsonObject:
    """Return the values of a pixel over time, around a frame or ``spread`` over all: frames, times [s] where known, values.

    Raises
    ------
    DataError
        A pixel outside the image, or a layer that does not exist.
    """
    require_pixel(source, row, column)
    opened, chosen = source.opened, source.layer(layer)
    frames, values = source.trace(row, column, around, layer, spread=spread)
    times = None
    if opened.times is not None:
        times = opened.times[frames].tolist()
    elif opened.frame_rate is not None:
        times = (frames / opened.frame_rate).tolist()
    return {
        "frames": frames.tolist(),
        "times_s": times,
        "values": [value if np.isfinite(value) else None for value in values.tolist()],
        "label": chosen.label,
        "unit": chosen.unit,
        "whole": bool(frames.size == source.done().size),
    }
