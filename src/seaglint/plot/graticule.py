"""Lines of equal elevation and azimuth across the picture of a camera that has no grid of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LINES: Final[dict[str, Any]] = {"colors": "deepskyblue", "linewidths": 0.8, "alpha": 0.8}

_INSET: Final = 0.055  #: Distance of labels from the picture's edge [share of its side].

_APART: Final = (0.16, 0.06)  #: Least distance of two labels across and down [share of the picture's width and height].

_BESIDE: Final = 22.5  #: Azimuth of the labels of elevations, half-way between two of the lines of azimuth [deg].


def draw_graticule(axes: Axes, azimuth: FloatArray, elevation: FloatArray) -> None:
    """Draw the lines, with labels that are legible on dark and bright pixels, over axes that count pixels.

    Parameters
    ----------
    axes : Axes
        Holds the picture.
    azimuth, elevation : ndarray (ny, nx)
        Directions of the pixels [deg].
    """
    from matplotlib.ticker import MaxNLocator

    axes.set_xlabel("column")
    axes.set_ylabel("row")
    if min(azimuth.shape) < 2:
        return
    # Round the nadir, or the whole compass, azimuth has a seam that its lines would bunch on.
    around = float(np.ptp(azimuth)) > 180.0
    for values, unit in ((elevation, "°"), (azimuth, "° az")):
        if np.ptp(values) == 0.0 or (values is azimuth and around):
            continue
        levels = MaxNLocator(6).tick_values(float(values.min()), float(values.max()))
        lines = axes.contour(values, levels=levels, **_LINES)
        if not around:
            for text in axes.clabel(lines, fmt=lambda value, unit=unit: f"{value:g}{unit}", fontsize=8):
                _outline(text)
    if around:
        for towards in range(0, 360, 45):
            _draw_azimuth(axes, float(towards), azimuth)
        for level in MaxNLocator(6).tick_values(float(elevation.min()), float(elevation.max())):
            if abs(level) < 90.0:
                _label_elevation(axes, float(level), azimuth, elevation)


def _turned(azimuth: FloatArray, towards: float) -> FloatArray:
    """Angles from an azimuth, -180 to 180 [deg]."""
    return np.asarray((azimuth - towards + 180.0) % 360.0 - 180.0)


def _draw_azimuth(axes: Axes, towards: float, azimuth: FloatArray) -> None:
    """Line of one azimuth, drawn as the zero of a sine, with its label where it leaves the picture."""
    off = np.radians(azimuth - towards)
    sine = np.where(np.cos(off) > 0.0, np.sin(off), np.nan)
    if not (np.any(sine < 0.0) and np.any(sine > 0.0)):
        return
    axes.contour(sine, levels=[0.0], **_LINES)
    rows, columns = azimuth.shape
    at_row, at_column = _inner(rows), _inner(columns)
    row, column = np.indices(azimuth.shape)
    inside = (row >= at_row) & (row < rows - at_row) & (column >= at_column) & (column < columns - at_column)
    ring = inside & ((row == at_row) | (row == rows - 1 - at_row) | (column == at_column) | (column == columns - 1 - at_column))
    distance = np.where(ring, np.abs(_turned(azimuth, towards)), np.inf)
    place = np.unravel_index(int(np.argmin(distance)), distance.shape)
    if distance[place] < 0.25 * 45.0:
        _write(axes, float(place[1]), float(place[0]), f"{towards:g}° az")


def _label_elevation(axes: Axes, level: float, azimuth: FloatArray, elevation: FloatArray) -> None:
    """Write an elevation where its line is nearest to the azimuth between two labelled ones, inside the picture and beside other labels."""
    rows, columns = elevation.shape
    row, column = np.indices(elevation.shape)
    inside = (np.minimum(row, rows - 1 - row) >= _inner(rows)) & (np.minimum(column, columns - 1 - column) >= _inner(columns))
    for text in axes.texts:
        x, y = text.get_position()
        inside &= (np.abs(column - x) > _APART[0] * columns) | (np.abs(row - y) > _APART[1] * rows)
    step = max(float(np.ptp(elevation)) / min(elevation.shape), 1e-9)
    near = inside & (np.abs(elevation - level) <= 1.5 * step)
    if not near.any():
        return
    off = np.where(near, np.abs(_turned(azimuth, _BESIDE)) / 45.0 + np.abs(elevation - level) / step, np.inf)
    place = np.unravel_index(int(np.argmin(off)), off.shape)
    _write(axes, float(place[1]), float(place[0]), f"{level:g}°")


def _inner(pixels: int) -> int:
    """Distance of labels from the edge [px]."""
    return min(round(_INSET * pixels), (pixels - 1) // 2)


def _write(axes: Axes, column: float, row: float, text: str) -> None:
    _outline(axes.text(column, row, text, fontsize=8, ha="center", va="center", clip_on=True))


def _outline(text: Any) -> None:
    """White with a dark edge, legible on any grey and colour."""
    from matplotlib.patheffects import withStroke

    text.set_color("white")
    text.set_alpha(1.0)
    text.set_path_effects([withStroke(linewidth=2.5, foreground="#102030")])
