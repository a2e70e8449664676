"""Parts that the pictures of clutter share: panels, colours of the regions, units on labels, text on an empty axis."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis import Analysis, Region
from seaglint.plot.new_figure import new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Colours of the regions, in every picture; distinct for colour-blind readers and in print.
COLOURS: Final = {"all": "0.25", "glint": "#d95f02", "background": "#1f78b4"}


def panels_of(analysis: Analysis, height: float) -> tuple[Figure, list[tuple[Axes, str, Region]]]:
    """A panel for each region that there is."""
    number = len(analysis.regions)
    figure = new_figure(max(5.0 * number, 7.0), height)
    axes = figure.subplots(1, number, squeeze=False)[0]
    return figure, [(a, name, region) for a, (name, region) in zip(axes, analysis.regions.items(), strict=True)]


def say(axes: Axes, text: str) -> None:
    """Write text on an empty axis."""
    axes.set(xticks=[], yticks=[])
    axes.text(0.5, 0.5, text, ha="center", va="center", transform=axes.transAxes, fontsize=10, color="0.35", wrap=True)


def beyond(values: NDArray[Any], low: float, high: float) -> str:
    """Ends of a colour bar beyond which there are values."""
    with np.errstate(invalid="ignore"):
        above, below = bool((values > high).any()), bool((values < low).any())
    return {(True, True): "both", (True, False): "max", (False, True): "min", (False, False): "neither"}[above, below]


def unit_of(units: str | None, unknown: str = "unit") -> str:
    """Units for labels: powers raised, ``W m-2 sr-1`` as W m⁻² sr⁻¹."""
    raised = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return re.sub(r"(?<=[A-Za-z])-?\d+(?=\s|$)", lambda power: power[0].translate(raised), units) if units else unknown


def values_label(analysis: Analysis) -> str:
    """Label of an axis or bar of the recording's values."""
    return f"values [{unit_of(analysis.recording.units, 'unit not known')}]"


def per_frame(analysis: Analysis) -> tuple[float, str]:
    """Seconds in a frame and the unit's name; frames where no rate is known."""
    rate = analysis.recording.frame_rate
    return (1.0 / rate, "s") if rate else (1.0, "frames")
