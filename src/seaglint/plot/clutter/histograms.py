"""Distributions of brightness with the fits to them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis import Analysis
from seaglint.base.conventions import FloatArray
from seaglint.clutter.fits import FAMILIES
from seaglint.plot.clutter.figure import panels_of, say, unit_of, values_label

if TYPE_CHECKING:
    from matplotlib.figure import Figure


FAMILY_COLOURS: Final = dict(zip(FAMILIES, ("#1b9e77", "#7570b3", "#e7298a", "#a6761d", "#377eb8"), strict=True))

FAMILY_NAMES: Final = {"gamma": "gamma", "lognormal": "lognormal", "weibull": "Weibull", "k": "K", "gaussian": "Gaussian"}

_MOST_BINS: Final = 150


def draw_histograms(analysis: Analysis) -> Figure:
    """Histogram of each region on a logarithmic axis with every valid fit, its distance and level (the article's Figs. 8 and 9)."""
    figure, panels = panels_of(analysis, 5.2)
    for axes, name, region in panels:
        x = region.sample
        axes.set_title(f"{name}: {x.size} values sampled", fontsize=10)
        if x.size < 2 or np.ptp(x) == 0.0:
            say(axes, "all values are equal" if x.size else "no values")
            continue
        edges = histogram_edges(x)
        counts, _ = np.histogram(x, edges)
        density = counts / (x.size * np.diff(edges))
        axes.stairs(np.where(counts > 0, density, np.nan), edges, color="0.2", linewidth=1.0, fill=False, label="data")
        axes.set_yscale("log", subs=[])
        lowest, highest = 0.3 / (x.size * float(np.diff(edges).min())), 3.0 * float(density.max())
        grid = np.linspace(edges[0], edges[-1], 800)
        for family in FAMILIES:
            fit = region.fits.get(family)
            if fit is None or not fit.is_valid:
                continue
            inside = grid if family == "gaussian" else grid[grid > (fit.loc or 0.0)]
            with np.errstate(all="ignore"):
                values = fit.pdf(inside)
            good = region.goodness.get(family)
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
    """Edges of a histogram: Freedman and Diaconis' width, at most 150 cells; of whole numbers, cells of as many each.

    Cells that hold now three and now four whole numbers would show a comb that is not in the data.
    """
    low, high = float(values.min()), float(values.max())
    quartiles = np.percentile(values, [25.0, 75.0])
    width = 2.0 * float(quartiles[1] - quartiles[0]) / values.size ** (1.0 / 3.0)
    # Never more cells than can be told apart, and never cells that single precision could not.
    width = max(width, (high - low) / _MOST_BINS, 1e-6 * max(abs(low), abs(high)))
    if np.all(values == np.rint(values)):
        step = float(max(math.ceil(width - 1e-9), 1))
        return np.arange(low - 0.5, high + 0.5 + step, step)
    number = min(max(math.ceil((high - low) / width), 1), _MOST_BINS)
    return np.linspace(low, high, number + 1)


def _level(p: float, replicates: int) -> str:
    if not math.isfinite(p):
        return "no level"
    # A bootstrap of n draws cannot tell levels below 1 / (n + 1).
    return f"p < {2.0 / (replicates + 1):.2g}" if p <= 1.0 / (replicates + 1) else f"p = {p:.2g}"
