"""How clutter hangs together: exceedances in time, brightness in space and time, spectrum."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from seaglint.analysis import Analysis
from seaglint.base.conventions import FloatArray
from seaglint.plot.clutter.figure import COLOURS, per_frame, say, unit_of
from seaglint.plot.new_figure import new_figure
from seaglint.plot.scale import number_decades

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_FREQUENCIES: Final = (0.02, 0.05, 0.1, 0.2, 0.5)


def draw_exceedances(analysis: Analysis) -> Figure:
    """Exceedances of each pixel in time: joint probability (the article's Fig. 6) and correlation, 1/e marked."""
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
            if alarms.pixels == 0 or np.isfinite(joint.joint).sum() < 2 or not joint.rate > 0.0:
                continue
            time, _ = joint.correlation_time()
            longest = max(longest, 10.0 * time if time is not None else 10.0)
            legend = f"{name}, {threshold:g} σ" + ("" if time is None else f": {time * seconds:.3g} {label}")
            lines.append((legend, COLOURS[name], style, joint.joint, joint.correlation, joint.rate))
    if not lines:
        why = "a single frame: nothing can be said of time" if analysis.recording.frames == 1 else "no exceedances"
        say(left, why)
        say(right, why)
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
    right.legend(fontsize=8)
    return figure


def draw_memory(analysis: Analysis) -> Figure:
    """Clutter in space and time: correlation along both axes and in time, spectrum by rings and in the plane."""
    figure = new_figure(12.0, 9.0)
    (space, time), (rings, plane) = figure.subplots(2, 2)
    seconds, label = per_frame(analysis)
    reach, last = 10.0, 10.0
    for name, region in analysis.regions.items():
        colour = COLOURS[name]
        both = ("x", region.spatial.x, region.spatial.length_x, "-"), ("y", region.spatial.y, region.spatial.length_y, "--")
        for axis, rho, length, style in both:
            legend = f"{length:.3g} px" if math.isfinite(length) else "no 1/e"
            space.plot(np.arange(rho.size), rho, color=colour, linestyle=style, label=f"{name}, {axis}: {legend}")
            reach = max(reach, min(5.0 * length, rho.size - 1.0) if math.isfinite(length) else 10.0)
        rho = region.temporal.rho
        if np.isfinite(rho).sum() > 1:
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
        say(time, _why_no_time(analysis))
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
        say(rings, "no square of at least 8 px lies wholly in a region, or nothing varies")
    _plane(figure, plane, analysis)
    for axes in (space, time, rings):
        if axes.lines:
            axes.legend(fontsize=7)
            axes.grid(alpha=0.25, which="both")
    return figure


def _plane(figure: Figure, axes: Axes, analysis: Analysis) -> None:
    """Spectrum of the corridor, or of everything, over both frequencies."""
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
        half = 0.5 / region.spectrum.frequency.size
        ends = float(region.spectrum.frequency[0]) - half, float(region.spectrum.frequency[-1]) + half
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
    say(axes, "no spectrum")


def _why_no_time(analysis: Analysis) -> str:
    if analysis.recording.frames == 1:
        return "a single frame: nothing can be said of time"
    return next((r.temporal.reason for r in analysis.regions.values() if r.temporal.reason), "no correlation in time")
