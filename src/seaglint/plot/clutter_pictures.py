"""Pictures of clutter statistics: regions, slices in time, distributions, false alarms, correlation. Equal analyses give equal bytes.

A panel that the data cannot fill (time in a single frame, a missing region) states the reason in words. ``report_pictures`` lists all
pictures in the order of a report, with the title above and the caption below each.
"""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis import Analysis, Region
from seaglint.base.brightness import scale_limits
from seaglint.base.conventions import FloatArray
from seaglint.clutter.extremes import TailFit
from seaglint.clutter.false_alarms import FalseAlarms
from seaglint.clutter.fits import FAMILIES
from seaglint.clutter.thresholds import gaussian_rate
from seaglint.plot.figures_and_pages import beyond, new_figure
from seaglint.plot.scale import number_decades

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Colours of the regions, in every picture; distinct for colour-blind readers and in print.
COLOURS: Final = {"all": "0.25", "glint": "#d95f02", "background": "#1f78b4"}

#: Colours of given regions, in their order; more regions begin again.
GIVEN_COLOURS: Final = ("#d95f02", "#1f78b4", "#1b9e77", "#e7298a", "#7570b3", "#a6761d", "#66a61e", "#e6ab02")

MOST_ABREAST: Final = 4  #: Largest number of panels beside each other.

MOST_IN_LEGEND: Final = 12  #: Largest number of lines in a legend.

SLICED_ABOVE: Final = 3.0  #: Threshold of the slices, counted in every analysis [standard deviations].

FAMILY_COLOURS: Final = dict(zip(FAMILIES, ("#1b9e77", "#7570b3", "#e7298a", "#a6761d", "#377eb8"), strict=True))

FAMILY_NAMES: Final = {"gamma": "gamma", "lognormal": "lognormal", "weibull": "Weibull", "k": "K", "gaussian": "Gaussian"}

_LEFT_OUT: Final = "#c2a5cf"

_FREQUENCIES: Final = (0.02, 0.05, 0.1, 0.2, 0.5)

_MOST_BINS: Final = 150


def panels_of(analysis: Analysis, height: float) -> tuple[Figure, list[tuple[Axes, str, Region]]]:
    """Return a figure of a height [in] and its panels, one for each region of the analysis."""
    number = len(analysis.regions)
    across = min(number, MOST_ABREAST)
    down = -(-number // across)
    figure = new_figure(max(5.0 * across, 7.0), height * down)
    axes = figure.subplots(down, across, squeeze=False).ravel()
    for empty in axes[number:]:
        empty.set_axis_off()
    return figure, [(a, name, region) for a, (name, region) in zip(axes, analysis.regions.items(), strict=False)]


def colour_of(analysis: Analysis, name: str) -> str:
    """Return the colour of a region."""
    return COLOURS.get(name) or GIVEN_COLOURS[analysis.names.index(name) % len(GIVEN_COLOURS) - 1]


def write_legend(axes: Axes, size: float) -> None:
    """Write a legend of a font size [pt], with the first ``MOST_IN_LEGEND`` lines."""
    handles, labels = axes.get_legend_handles_labels()
    title = f"the first {MOST_IN_LEGEND} of {len(labels)}" if len(labels) > MOST_IN_LEGEND else None
    axes.legend(handles[:MOST_IN_LEGEND], labels[:MOST_IN_LEGEND], fontsize=size, title=title, title_fontsize=size)


def write_in_panel(axes: Axes, text: str) -> None:
    """Write text in the middle of an empty panel."""
    axes.set(xticks=[], yticks=[])
    axes.text(0.5, 0.5, text, ha="center", va="center", transform=axes.transAxes, fontsize=10, color="0.35", wrap=True)


def unit_of(units: str | None, unknown: str = "unit") -> str:
    """Return units for labels, with raised powers: ``W m-2 sr-1`` as W m⁻² sr⁻¹."""
    # Only digits behind a letter are powers: a number that begins the units is a factor.
    raised = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return re.sub(r"(?<=[A-Za-z])-?\d+(?=\s|$)", lambda power: power[0].translate(raised), units) if units else unknown


def values_label(analysis: Analysis) -> str:
    """Return the label of an axis or colour bar with the recording's values."""
    return f"values [{unit_of(analysis.recording.units, 'unit not known')}]"


def per_frame(analysis: Analysis) -> tuple[float, str]:
    """Return the duration of a frame and its unit: seconds, or 1 frame where no frame rate is known."""
    rate = analysis.recording.frame_rate
    return (1.0 / rate, "s") if rate else (1.0, "frames")


def draw_regions(analysis: Analysis) -> Figure:
    """Draw the mean image with the outlines of the regions, and the row and column of ``draw_slices``."""
    from matplotlib.colors import ListedColormap
    from matplotlib.lines import Line2D

    rows, columns = analysis.image.shape
    figure = new_figure(10.0, float(np.clip(8.6 * rows / columns, 2.5, 9.0)) + 0.9)
    axes = figure.subplots()
    used = analysis.regions["all"].mask
    low, high = scale_limits(analysis.image[used])
    image = axes.imshow(analysis.image, cmap="gray", vmin=low, vmax=high, interpolation="nearest")
    handles: list[Line2D] = []
    outlines = [
        (name, colour_of(analysis, name), region.mask) for name, region in analysis.regions.items() if name not in ("all", "background")
    ]
    if analysis.segmentation.sky.any():
        outlines.append(("smooth rows on top (sky, far sea), in neither region", "#66c2a5", analysis.segmentation.sky))
    for name, colour, mask in outlines:
        # Padded, so that a region that ends at the picture's border is closed there.
        axes.contour(
            np.arange(-1, columns + 1), np.arange(-1, rows + 1), np.pad(mask.astype(float), 1), levels=[0.5], colors=colour, linewidths=1.4
        )
        if len(handles) < MOST_IN_LEGEND:
            handles.append(Line2D([], [], color=colour, label=name))
        if analysis.options.regions is not None:
            row, column = (float(np.median(place)) for place in np.nonzero(mask))
            axes.text(column, row, name, color=colour, fontsize=8, ha="center", va="center")
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
    """Draw a row and a column in time: raw, filtered, and above 3 sigma (the article's Fig. 7). A single frame has profiles."""
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
    """Draw raw and filtered values along a line of a single frame, which has no slices in time."""
    for axes, values in zip(line, (raw, filtered), strict=False):
        axes.plot(values, color="0.2", linewidth=0.7)
        axes.set(xlabel=label, xlim=(0, values.size - 1))
        axes.grid(alpha=0.25)
    place = np.flatnonzero(above)
    line[1].plot(place, filtered[place], "o", color=COLOURS["glint"], markersize=3, label=f"above threshold: {place.size}")
    line[1].legend(fontsize=7)
    write_in_panel(line[2], "a single frame:\nno slices in time")


def draw_exceedances(analysis: Analysis) -> Figure:
    """Draw joint probability (the article's Fig. 6) and correlation of each pixel's exceedances in time, with 1/e marked."""
    figure = new_figure(12.0, 4.6 if analysis.recording.frames > 1 else 1.6)
    left, right = figure.subplots(1, 2)
    left.set_title("joint probability of exceeding now and later", fontsize=10)
    right.set_title("correlation of exceedances", fontsize=10)
    seconds, label = per_frame(analysis)
    lines: list[tuple[str, str, str, FloatArray, FloatArray, float]] = []
    longest = 10.0
    for name, region in analysis.regions.items():
        alarms = next(iter(region.alarms.values()))
        for threshold, style in zip(alarms.thresholds, ("-", "--", "-.", ":", ":", ":"), strict=False):
            joint = alarms.joint(threshold)
            # A curve needs two lags, and a correlation a rate above 0.
            if alarms.pixels == 0 or np.isfinite(joint.joint).sum() < 2 or not joint.rate > 0.0:
                continue
            time, _ = joint.correlation_time()
            # The slowest curve sets the axis: ten of its correlation times.
            longest = max(longest, 10.0 * time if time is not None else 10.0)
            legend = f"{name}, {threshold:g} σ" + ("" if time is None else f": {time * seconds:.3g} {label}")
            lines.append((legend, colour_of(analysis, name), style, joint.joint, joint.correlation, joint.rate))
    if not lines:
        reason = "a single frame: nothing can be said of time" if analysis.recording.frames == 1 else "no exceedances"
        write_in_panel(left, reason)
        write_in_panel(right, reason)
        return figure
    for legend, colour, style, probability, correlation, rate in lines:
        lag = seconds * np.arange(probability.size)
        # Lag 0 is the rate itself; a logarithmic axis keeps the level of chance, rate squared, in sight.
        left.plot(lag, np.where(probability > 0, probability, np.nan), color=colour, linestyle=style, label=legend)
        left.axhline(rate**2, color=colour, linestyle=style, linewidth=0.5)
        right.plot(lag, correlation, color=colour, linestyle=style, label=legend)
    left.set_yscale("log", subs=[])
    left.set_ylabel("P(above now and later) [1]; thin: by chance")
    right.axhline(math.exp(-1.0), color="k", linewidth=0.8, linestyle=":")
    right.text(0.99, math.exp(-1.0), "1/e ", ha="right", va="bottom", fontsize=8, transform=right.get_yaxis_transform())
    right.set(ylabel="correlation [1]", ylim=(-0.1, 1.05))
    most = max(probability.size for _, _, _, probability, _, _ in lines) - 1
    for axes in (left, right):
        axes.set(xlabel=f"lag [{label}]", xlim=(0.0, seconds * min(longest, most)))
        axes.grid(alpha=0.25)
    write_legend(right, 8)
    return figure


def draw_memory(analysis: Analysis) -> Figure:
    """Draw the clutter in space and time: correlation along both axes and in time, spectrum by rings and in the plane."""
    figure = new_figure(12.0, 9.0)
    (space, time), (rings, plane) = figure.subplots(2, 2)
    seconds, label = per_frame(analysis)
    reach, last = 10.0, 10.0
    for name, region in analysis.regions.items():
        colour = colour_of(analysis, name)
        both = ("x", region.spatial.x, region.spatial.length_x, "-"), ("y", region.spatial.y, region.spatial.length_y, "--")
        for axis, rho, length, style in both:
            legend = f"{length:.3g} px" if math.isfinite(length) else "no 1/e"
            space.plot(np.arange(rho.size), rho, color=colour, linestyle=style, label=f"{name}, {axis}: {legend}")
            reach = max(reach, min(5.0 * length, rho.size - 1.0) if math.isfinite(length) else 10.0)
        rho = region.temporal.rho
        # Lag 0 alone is no curve.
        if np.isfinite(rho).sum() > 1:
            # The time is in seconds where the frame rate is known, otherwise in frames already.
            frames = region.temporal.time * (analysis.recording.frame_rate or 1.0)
            legend = f"{frames * seconds:.3g} {label}" if math.isfinite(frames) else "no 1/e"
            time.plot(seconds * np.arange(rho.size), rho, color=colour, label=f"{name}: {legend}")
            last = max(last, min(10.0 * frames if math.isfinite(frames) else math.inf, rho.size - 1.0))
        if region.spectrum is not None and region.spectrum.segments:
            frequency, density = region.spectrum.radial()
            if (density > 0.0).any():
                rings.loglog(
                    frequency, np.where(density > 0, density, np.nan), color=colour, label=f"{name}: {region.spectrum.segments} squares"
                )
    space.set_title("brightness in space", fontsize=10)
    space.set(xlabel="lag [px]", xlim=(0.0, reach), ylim=(-0.3, 1.05), ylabel="correlation [1]")
    time.set_title("brightness in time", fontsize=10)
    if time.lines:
        time.set(xlabel=f"lag [{label}]", xlim=(0.0, seconds * last), ylim=(-0.3, 1.05), ylabel="correlation [1]")
    else:
        write_in_panel(time, _why_no_time(analysis))
    for axes in (space, time):
        if axes.lines:
            axes.axhline(math.exp(-1.0), color="k", linewidth=0.8, linestyle=":")
    rings.set_title("spectrum, mean over directions", fontsize=10)
    unit = unit_of(analysis.recording.units)
    if rings.lines:
        rings.set_xticks(_FREQUENCIES, [f"{f:g}" for f in _FREQUENCIES])
        rings.minorticks_off()
        rings.set(xlabel="spatial frequency [cycles/px]", ylabel=f"density [({unit})² px²]")
    else:
        write_in_panel(rings, "no square of at least 8 px lies wholly in a region, or nothing varies")
    _plane(figure, plane, analysis)
    for axes in (space, time, rings):
        if axes.lines:
            write_legend(axes, 7)
            axes.grid(alpha=0.25, which="both")
    return figure


def _plane(figure: Figure, axes: Axes, analysis: Analysis) -> None:
    """Draw the spectrum of the corridor, or else of the whole image, over both frequencies."""
    from matplotlib.colors import LogNorm

    for name in ("glint", "all"):
        region = analysis.regions.get(name)
        if region is None or region.spectrum is None or not region.spectrum.segments:
            continue
        density = region.spectrum.density.copy()
        density[region.spectrum.frequency == 0.0, region.spectrum.frequency == 0.0] = np.nan  # the mean, which was removed
        most = float(np.nanmax(density))
        if not most > 0.0:
            continue
        # Frequencies are at the middle of their cells, which are 1/size cycles per pixel wide.
        half = 0.5 / region.spectrum.frequency.size
        ends = float(region.spectrum.frequency[0]) - half, float(region.spectrum.frequency[-1]) + half
        # A few nearly empty cells would take most of the colours: the lowest 2 % share one, and six decades are enough.
        least = max(float(np.nanpercentile(density, 2.0)), 1e-6 * most)
        image = axes.imshow(
            np.maximum(density, least), norm=LogNorm(least, most), cmap="viridis", extent=(*ends, ends[1], ends[0]), interpolation="nearest"
        )
        bar = figure.colorbar(image, ax=axes, pad=0.02)
        number_decades(bar)
        bar.set_label(f"density [({unit_of(analysis.recording.units)})² px²]")
        axes.set_title(f"spectrum: {name}", fontsize=10)
        axes.set(xlabel="frequency along rows, x [cycles/px]", ylabel="frequency along columns, y [cycles/px]")
        return
    write_in_panel(axes, "no spectrum")


def _why_no_time(analysis: Analysis) -> str:
    if analysis.recording.frames == 1:
        return "a single frame: nothing can be said of time"
    return next((r.temporal.reason for r in analysis.regions.values() if r.temporal.reason), "no correlation in time")


def draw_histograms(analysis: Analysis) -> Figure:
    """Draw the histogram of each region, logarithmic, with every valid fit, its distance and level (the article's Figs. 8 and 9)."""
    figure, panels = panels_of(analysis, 5.2)
    for axes, name, region in panels:
        x = region.sample
        axes.set_title(f"{name}: {x.size} values sampled", fontsize=10)
        if x.size < 2 or np.ptp(x) == 0.0:
            write_in_panel(axes, "all values are equal" if x.size else "no values")
            continue
        edges = histogram_edges(x)
        counts, _ = np.histogram(x, edges)
        density = counts / (x.size * np.diff(edges))
        axes.stairs(np.where(counts > 0, density, np.nan), edges, color="0.2", linewidth=1.0, fill=False, label="data")
        axes.set_yscale("log", subs=[])
        # One value in the narrowest cell lies above the lower end of the axis by a factor of three.
        lowest, highest = 0.3 / (x.size * float(np.diff(edges).min())), 3.0 * float(density.max())
        grid = np.linspace(edges[0], edges[-1], 800)
        for family in FAMILIES:
            fit = region.fits.get(family)
            if fit is None or not fit.is_valid:
                continue
            # All other families have their values above the location, where some densities have a pole.
            inside = grid if family == "gaussian" else grid[grid > (fit.loc or 0.0)]
            with np.errstate(all="ignore"):
                values = fit.pdf(inside)
            good = fit.goodness
            label = FAMILY_NAMES[family]
            if good is not None:
                label += f": KS {good.ks:.3f}, {_level(good.ks_p, good.replicates)}"
            shown = np.where((values > 0.01 * lowest) & (values < 100 * highest), values, np.nan)
            axes.plot(inside, shown, color=FAMILY_COLOURS[family], linewidth=1.3, label=label)
        axes.set(ylim=(lowest, highest * 10), xlim=(edges[0], edges[-1]), xlabel=values_label(analysis))
        axes.legend(fontsize=7, loc="upper right", framealpha=0.85)
        axes.grid(alpha=0.25)
    panels[0][0].set_ylabel(f"probability density [1/({unit_of(analysis.recording.units)})]")
    return figure


def histogram_edges(values: NDArray[Any]) -> FloatArray:
    """Return the edges of a histogram with Freedman and Diaconis' width, at most 150 cells.

    For whole numbers every cell holds equally many of them: cells of three and of four numbers by turns would show a comb.
    """
    low, high = float(values.min()), float(values.max())
    quartiles = np.percentile(values, [25.0, 75.0])
    # Freedman and Diaconis (1981): twice the interquartile range over the cube root of the number of values.
    width = 2.0 * float(quartiles[1] - quartiles[0]) / values.size ** (1.0 / 3.0)
    # Never more cells than can be distinguished, and no cells narrower than single precision resolves.
    width = max(width, (high - low) / _MOST_BINS, 1e-6 * max(abs(low), abs(high)))
    if np.all(values == np.rint(values)):
        # 1e-9 keeps a width that is a whole number but for rounding.
        step = float(max(math.ceil(width - 1e-9), 1))
        return np.arange(low - 0.5, high + 0.5 + step, step)
    return np.linspace(low, high, min(max(math.ceil((high - low) / width), 1), _MOST_BINS) + 1)


def _level(p: float, replicates: int) -> str:
    if not math.isfinite(p):
        return "no level"
    # A bootstrap of n draws cannot resolve levels below 1 / (n + 1).
    return f"p < {2.0 / (replicates + 1):.2g}" if p <= 1.0 / (replicates + 1) else f"p = {p:.2g}"


def draw_rates(analysis: Analysis) -> Figure:
    """Draw the false-alarm rate of each region against threshold: measured, Gaussian, and extrapolated with its band and limit of trust."""
    figure, panels = panels_of(analysis, 5.4)
    for axes, name, region in panels:
        axes.set_title(name, fontsize=10)
        if not any(alarms.pixels for alarms in region.alarms.values()):
            write_in_panel(axes, "no pixel with a standard deviation")
            continue
        _rate_panel(axes, region, colour_of(analysis, name))
    panels[0][0].set_ylabel("false alarms per pixel and frame [1]")
    return figure


def _rate_panel(axes: Axes, region: Region, colour: str) -> None:
    others = iter(("#1b9e77", "#7570b3", "#e7298a", "#66a61e", "#a6761d", "#e6ab02"))
    furthest, pixels = 5.0, 1
    for number, (name, alarms) in enumerate(region.alarms.items()):
        if not alarms.pixels:
            continue
        curve = alarms.curve()
        counted = (curve.threshold >= 0.0) & (curve.exceedances > 0)
        line_colour = colour if number == 0 else next(others, "0.5")
        threshold, rate = curve.threshold[counted], curve.rate[counted]
        axes.plot(threshold, rate, color=line_colour, linewidth=1.5 if number == 0 else 1.0, label=f"{name}, measured")
        _counted(axes, alarms, line_colour, label=number == 0)
        pixels = max(pixels, alarms.pixels)
        furthest = max(furthest, float(threshold[-1]) if threshold.size else 0.0)
        if number == 0:
            tail, reason = region.tail(name)
            if tail is None:
                _remark(axes, f"no extrapolation: {reason}")
            else:
                furthest = max(furthest, _extrapolated(axes, tail, pixels))
    # Far out the Gaussian rate underflows to 0, which a logarithmic axis cannot show.
    m = np.linspace(0.0, furthest, 400)
    axes.plot(m, np.maximum(gaussian_rate(m), 1e-300), color="0.3", linestyle="--", linewidth=1.0, label="Gaussian tail")
    axes.axhline(1.0 / pixels, color="0.3", linestyle=":", linewidth=0.9)
    level = f"one in {pixels:,} pixels".replace(",", "\u202f")
    axes.text(0.01, 1.0 / pixels, level, fontsize=7, va="bottom", transform=axes.get_yaxis_transform())
    axes.set_yscale("log", subs=[])
    # Two decades below one alarm in all pixels leave room for the extrapolated tail.
    axes.set(xlim=(0.0, furthest), ylim=(0.01 / pixels, 1.0), xlabel="threshold [standard deviations σ]")
    axes.grid(alpha=0.25)
    axes.legend(fontsize=7, loc="upper right", framealpha=0.85)


def _counted(axes: Axes, alarms: FalseAlarms, colour: str, *, label: bool) -> None:
    """Draw the counted thresholds with their 95 % intervals; an open circle marks a threshold without interval."""
    labelled = not label
    for rate in alarms.rates():
        if not rate.rate > 0.0:
            continue
        known = rate.rate_low is not None and rate.rate_high is not None
        axes.plot(rate.threshold_sigma, rate.rate, "o", color=colour, markersize=4.5, markerfacecolor=colour if known else "w")
        if rate.rate_low is not None and rate.rate_high is not None:
            ends = [max(rate.rate_low, 1e-300), rate.rate_high]
            name = None if labelled else "95 % intervals"
            axes.plot([rate.threshold_sigma] * 2, ends, color=colour, linewidth=1.8, marker="_", markersize=7, label=name)
            labelled = True


def _extrapolated(axes: Axes, tail: TailFit, pixels: int) -> float:
    """Draw a fitted tail and its band; return the threshold at which the axis ends [standard deviations]."""
    # To a rate of 3 % of one alarm in all pixels, but not much further than twice the trusted part of the tail.
    end = tail.threshold_for(0.03 / pixels) or tail.trusted_to_sigma
    end = min(end, tail.threshold + 2.0 * (tail.trusted_to_sigma - tail.threshold) + 2.0)
    m = np.linspace(tail.threshold, max(end, tail.trusted_to_sigma), 200)
    rate, low, high = tail.rates(m)
    axes.fill_between(m, np.maximum(low, 1e-300), high, color="#e7298a", alpha=0.2, linewidth=0.0)
    axes.plot(m, np.maximum(rate, 1e-300), color="#e7298a", linewidth=1.0, label=f"extrapolated from {tail.threshold:.2f} σ")
    axes.axvline(tail.trusted_to_sigma, color="#e7298a", linestyle="-.", linewidth=0.9, label=f"trusted to {tail.trusted_to_sigma:.2f} σ")
    return float(m[-1]) + 0.3


def _remark(axes: Axes, text: str) -> None:
    """Write small print in the lower right corner."""
    box = {"facecolor": "w", "edgecolor": "none", "alpha": 0.8}
    axes.text(0.98, 0.02, textwrap.fill(text, 44), transform=axes.transAxes, fontsize=7, ha="right", va="bottom", bbox=box)


@dataclass(frozen=True)
class ReportFigure:
    """Figure of the report, with its title and caption."""

    draw: Callable[[Analysis], Figure]
    title: str
    caption: str


#: Figures of the report, in its order.
PICTURES: Final = {
    "regions": ReportFigure(draw_regions, "Regions", "Mean image; grey scale from the 0.2 % to the 99.8 % quantile."),
    "rates": ReportFigure(
        draw_rates,
        "False-alarm rate against threshold",
        "Points with bars: counted thresholds and their 95 % intervals for correlated pixels; open circles have none, the table says why. "
        "Line: counted from a histogram of cells of 0.02 σ. Pink: generalised Pareto tail with its 95 % band; beyond the dash-dotted line "
        "it is not to be trusted.",
    ),
    "exceedances": ReportFigure(
        draw_exceedances,
        "Exceedances in time",
        "Of the same pixel, in the filtered images. Thin lines: what independent exceedances of the same rate would give.",
    ),
    "slices": ReportFigure(
        draw_slices, "A row and a column in time", "Through the middle of the corridor, or of the picture if it has no corridor."
    ),
    "histograms": ReportFigure(
        draw_histograms,
        "Distributions",
        "Kolmogorov-Smirnov distance and its level, which allows for fitted parameters and correlated pixels.",
    ),
    "memory": ReportFigure(
        draw_memory,
        "Correlation and spectrum",
        "Spatial correlation and spectrum after a polynomial surface is taken off, which is the shape of the corridor.",
    ),
}
