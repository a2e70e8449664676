"""Pictures of clutter statistics: regions, slices in time, distributions, false alarms, memory. The same analysis gives the same bytes.

What the data cannot tell (time in a single frame, a region that is missing) is said in words in the panel.
"""

from seaglint.plot.clutter.correlation_plots import draw_exceedances, draw_memory
from seaglint.plot.clutter.figure import unit_of
from seaglint.plot.clutter.histograms import FAMILY_NAMES, draw_histograms, histogram_edges
from seaglint.plot.clutter.rates import draw_rates
from seaglint.plot.clutter.regions import draw_regions, draw_slices
from seaglint.plot.clutter.report_pictures import PICTURES, ReportFigure

__all__ = [
    "FAMILY_NAMES",
    "PICTURES",
    "ReportFigure",
    "draw_exceedances",
    "draw_histograms",
    "draw_memory",
    "draw_rates",
    "draw_regions",
    "draw_slices",
    "histogram_edges",
    "unit_of",
]
