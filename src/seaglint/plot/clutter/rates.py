"""False-alarm rates against the threshold: counted, Gaussian, extrapolated."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import numpy as np

from seaglint.analysis import Analysis, Region
from seaglint.clutter.extremes import TailFit
from seaglint.clutter.false_alarms import FalseAlarms
from seaglint.clutter.thresholds import gaussian_rate
from seaglint.plot.clutter.figure import COLOURS, panels_of, say

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_rates(analysis: Analysis) -> Figure:
    """False-alarm rate of each region against threshold: measured, Gaussian, and extrapolated with its band and limit of trust."""
    figure, panels = panels_of(analysis, 5.4)
    for axes, name, region in panels:
        axes.set_title(name, fontsize=10)
        if not any(alarms.pixels for alarms in region.alarms.values()):
            say(axes, "no pixel with a standard deviation")
            continue
        _rate_panel(axes, region, COLOURS[name])
    panels[0][0].set_ylabel("false alarms per pixel and frame [1]")
    return figure


def _rate_panel(axes: Axes, region: Region, colour: str) -> None:
    others = iter(("#1b9e77", "#7570b3", "#e7298a", "#66a61e", "#a6761d", "#e6ab02"))
    furthest, pixels = 5.0, 1
    for number, (name, alarms) in enumerate(region.alarms.items()):
        if not alarms.pixels:
            continue
        curve = alarms.curve()
        seen = (curve.threshold >= 0.0) & (curve.exceedances > 0)
        own = colour if number == 0 else next(others, "0.5")
        axes.plot(curve.threshold[seen], curve.rate[seen], color=own, linewidth=1.5 if number == 0 else 1.0, label=f"{name}, measured")
        _counted(axes, alarms, own, label=number == 0)
        pixels = max(pixels, alarms.pixels)
        reached = float(curve.threshold[seen][-1]) if seen.any() else 0.0
        furthest = max(furthest, reached)
        if number == 0:
            tail, reason = region.tail(name)
            if tail is None:
                _remark(axes, f"no extrapolation: {reason}")
            else:
                furthest = max(furthest, _extrapolated(axes, tail, pixels))
    m = np.linspace(0.0, furthest, 400)
    axes.plot(m, np.maximum(gaussian_rate(m), 1e-300), color="0.3", linestyle="--", linewidth=1.0, label="Gaussian tail")
    axes.axhline(1.0 / pixels, color="0.3", linestyle=":", linewidth=0.9)
    axes.text(
        0.01,
        1.0 / pixels,
        f"one in {pixels:,} pixels".replace(",", "\u202f"),
        fontsize=7,
        va="bottom",
        transform=axes.get_yaxis_transform(),
    )
    axes.set_yscale("log", subs=[])
    axes.set(xlim=(0.0, furthest), ylim=(0.01 / pixels, 1.0), xlabel="threshold [standard deviations σ]")
    axes.grid(alpha=0.25)
    axes.legend(fontsize=7, loc="upper right", framealpha=0.85)


def _counted(axes: Axes, alarms: FalseAlarms, colour: str, *, label: bool) -> None:
    """Counted thresholds with their 95 % intervals; an open circle has none."""
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
    """Tail and its band; returns the threshold up to which it is worth seeing."""
    end = tail.threshold_for(0.03 / pixels) or tail.trusted_to_sigma
    end = min(end, tail.threshold + 2.0 * (tail.trusted_to_sigma - tail.threshold) + 2.0)
    m = np.linspace(tail.threshold, max(end, tail.trusted_to_sigma), 200)
    rate, low, high = tail.rates(m)
    axes.fill_between(m, np.maximum(low, 1e-300), high, color="#e7298a", alpha=0.2, linewidth=0.0)
    axes.plot(m, np.maximum(rate, 1e-300), color="#e7298a", linewidth=1.0, label=f"extrapolated from {tail.threshold:.2f} σ")
    axes.axvline(tail.trusted_to_sigma, color="#e7298a", linestyle="-.", linewidth=0.9, label=f"trusted to {tail.trusted_to_sigma:.2f} σ")
    return float(m[-1]) + 0.3


def _remark(axes: Axes, text: str) -> None:
    """Small print in the lower right corner."""
    box = {"facecolor": "w", "edgecolor": "none", "alpha": 0.8}
    axes.text(0.98, 0.02, textwrap.fill(text, 44), transform=axes.transAxes, fontsize=7, ha="right", va="bottom", bbox=box)
