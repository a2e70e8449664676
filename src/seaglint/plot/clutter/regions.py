"""Where the regions lie in the mean image, and a row and a column in time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis import Analysis
from seaglint.base.brightness import scale_limits
from seaglint.plot.clutter.figure import COLOURS, beyond, say, unit_of, values_label
from seaglint.plot.new_figure import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SLICED_ABOVE: Final = 3.0  #: Threshold of the slices, counted in every analysis [standard deviations].

_LEFT_OUT: Final = "#c2a5cf"


def draw_regions(analysis: Analysis) -> Figure:
    """Mean image with the outlines of the regions, and the row and column of :func:`draw_slices`."""
    from matplotlib.colors import ListedColormap
    from matplotlib.lines import Line2D

    rows, columns = analysis.image.shape
    figure = new_figure(10.0, float(np.clip(8.6 * rows / columns, 2.5, 9.0)) + 0.9)
    axes = figure.subplots()
    used = analysis.regions["all"].mask
    low, high = scale_limits(analysis.image[used])
    image = axes.imshow(analysis.image, cmap="gray", vmin=low, vmax=high, interpolation="nearest")
    handles = []
    outlines = [("glint", COLOURS["glint"], analysis.regions["glint"].mask)] if "glint" in analysis.regions else []
    if analysis.segmentation is not None and analysis.segmentation.sky.any():
        outlines.append(("smooth rows on top (sky, far sea), in neither region", "#66c2a5", analysis.segmentation.sky))
    for name, colour, mask in outlines:
        # Padded, so that a region that ends at the picture's border is closed there.
        axes.contour(
            np.arange(-1, columns + 1), np.arange(-1, rows + 1), np.pad(mask.astype(float), 1), levels=[0.5], colors=colour, linewidths=1.4
        )
        handles.append(Line2D([], [], color=colour, label=name))
    if not used.all():
        axes.imshow(np.ma.masked_array(np.ones(used.shape), used), cmap=ListedColormap([_LEFT_OUT]), alpha=0.6, interpolation="nearest")
        handles.append(
            Line2D([], [], color=_LEFT_OUT, marker="s", linestyle="none", label="not analysed: missing, dead or outside the rows")
        )
    axes.plot([-0.5, columns - 0.5], [analysis.slices.row] * 2, color="c", linewidth=0.7, linestyle=":")
    axes.plot([analysis.slices.column] * 2, [-0.5, rows - 0.5], color="c", linewidth=0.7, linestyle=":")
    handles.append(Line2D([], [], color="c", linestyle=":", label=f"row {analysis.slices.row}, column {analysis.slices.column} (slices)"))
    axes.set(xlim=(-0.5, columns - 0.5), ylim=(rows - 0.5, -0.5), xlabel="column [px]", ylabel="row [px]")
    frames = analysis.recording.frames
    axes.set_title("a single frame" if frames == 1 else f"mean of {frames} frames", fontsize=10)
    axes.legend(handles=handles, fontsize=8, loc="lower right", framealpha=0.85)
    figure.colorbar(image, ax=axes, pad=0.02, extend=beyond(analysis.image[used], low, high), shrink=0.9).set_label(values_label(analysis))
    return figure


def draw_slices(analysis: Analysis) -> Figure:
    """A row and a column in time: raw, filtered, and above 3 sigma (the article's Fig. 7); profiles of a single frame."""
    figure = new_figure(13.0, 7.5)
    panels = figure.subplots(2, 3, squeeze=False)
    slices = analysis.slices
    frames = slices.along_row[0].shape[0]
    parts = (slices.along_row, "column [px]", f"row {slices.row}"), (slices.along_column, "row [px]", f"column {slices.column}")
    unit = unit_of(analysis.recording.units, "unit not known")
    for line, ((raw, filtered, above), label, name) in zip(panels, parts, strict=True):
        titles = f"{name}: raw [{unit}]", f"{name}: filter {analysis.options.filter.name} [{unit}]", f"{name}: above {SLICED_ABOVE:g} σ"
        for axes, title in zip(line, titles, strict=True):
            axes.set_title(title, fontsize=10)
        if frames == 1:
            _profiles(line, raw[0], filtered[0], above[0], label)
            continue
        rate = analysis.recording.frame_rate
        duration = frames / rate if rate else float(frames)
        # An edge of half a pixel and of half a frame, so that centres lie on their numbers.
        extent = (-0.5, raw.shape[1] - 0.5, duration * (1 - 0.5 / frames), -0.5 * duration / frames)
        for axes, values in zip(line, (raw, filtered), strict=False):
            low, high = scale_limits(values)
            image = axes.imshow(values, cmap="gray", vmin=low, vmax=high, aspect="auto", extent=extent, interpolation="nearest")
            figure.colorbar(image, ax=axes, pad=0.01, extend=beyond(values, low, high))
        number, place = np.nonzero(above)
        # Strokes rather than an image: resampling would drop single pixels. A column is about 250 points wide.
        step = duration / frames
        line[2].vlines(place, (number - 0.5) * step, (number + 0.5) * step, color="k", linewidth=max(0.8, 250.0 / raw.shape[1]))
        line[2].set(xlim=extent[:2], ylim=extent[2:])
        line[2].text(0.99, 1.01, f"{100 * above.mean():.3g} %", transform=line[2].transAxes, ha="right", va="bottom", fontsize=8)
        for axes in line:
            axes.set(xlabel=label, ylabel="time [s]" if rate else "time [frames]")
    return figure


def _profiles(line: Any, raw: NDArray[Any], filtered: NDArray[Any], above: NDArray[Any], label: str) -> None:
    """A single frame has lines, not slices."""
    for axes, values in zip(line, (raw, filtered), strict=False):
        axes.plot(values, color="0.2", linewidth=0.7)
        axes.set(xlabel=label, xlim=(0, values.size - 1))
        axes.grid(alpha=0.25)
    place = np.flatnonzero(above)
    line[1].plot(place, filtered[place], "o", color=COLOURS["glint"], markersize=3, label=f"above threshold: {place.size}")
    line[1].legend(fontsize=7)
    say(line[2], "a single frame:\nno slices in time")
