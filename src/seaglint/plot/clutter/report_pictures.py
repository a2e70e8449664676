"""The pictures of a report, in its order, with what stands above and below them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from seaglint.analysis import Analysis
from seaglint.plot.clutter.correlation_plots import draw_exceedances, draw_memory
from seaglint.plot.clutter.histograms import draw_histograms
from seaglint.plot.clutter.rates import draw_rates
from seaglint.plot.clutter.regions import draw_regions, draw_slices

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class ReportFigure:
    """One of the report's figures."""

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
        draw_slices, "A row and a column in time", "Through the middle of the corridor, or of the picture where there is none."
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
