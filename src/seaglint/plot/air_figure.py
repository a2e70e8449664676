"""Picture of a profile of the air: temperature, humidity and refractivity, the lowest kilometre below the whole."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seaglint.files.outputs import moved_when_whole
from seaglint.plot.new_figure import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from seaglint.files.soundings.air_summary import AirSummary

TALL = 20.0  #: Height of the upper panels [km].


def write_air_plot(summary: AirSummary, output: Path) -> Path:
    """Write the picture, complete or not at all."""
    with moved_when_whole(output) as partial:
        draw_air(summary).savefig(partial, dpi=120, format=output.suffix.lstrip(".").lower())
    return output


def draw_air(summary: AirSummary) -> Figure:
    """Profiles against height: up to 20 km above, the lowest kilometre below."""
    air = summary.profile
    figure = new_figure(10.0, 7.5)
    panels = figure.subplots(2, 3, height_ratios=(1.4, 1.0))
    z, dry = 1e-3 * air.height, summary.refractivity_units
    columns = (
        ("temperature [°C]", air.temperature - 273.15, "C3"),
        ("relative humidity [%]", air.relative_humidity, "C0"),
        ("refractivity n − 1 [10⁻⁶]", dry, "C2"),
    )
    # rays are trapped where the modified refractivity falls with height
    low_columns = (*columns[:2], ("modified refractivity [10⁻⁶]", dry + 1e6 * air.height / air.earth_radius, "C2"))
    given = air.height <= summary.top + 1.0
    for row, top, quantities in zip(panels, (TALL, 1.0), (columns, low_columns), strict=True):
        inside = z <= top * 1.001
        fine = np.linspace(0.0, top, 400)
        for axes, (label, values, colour) in zip(row, quantities, strict=True):
            axes.plot(np.interp(fine, z, values), fine, color=colour, linewidth=1.2)
            axes.plot(values[inside & given], z[inside & given], ".", color=colour, markersize=4, label="levels given")
            if (inside & ~given).any():
                axes.plot(values[inside & ~given], z[inside & ~given], "x", color="0.5", markersize=4, label="model atmosphere")
            axes.set(ylim=(0.0, top), xlabel=label)
            axes.grid(alpha=0.3)
            for low, high in summary.ducts:
                axes.axhspan(1e-3 * low, 1e-3 * high, color="C1", alpha=0.3, linewidth=0)
        row[0].set_ylabel("height [km]")
    panels[1, 0].plot([summary.sea_kelvin - 273.15], [0.0], "k^", clip_on=False, label="sea")
    panels[1, 0].legend(fontsize=8)
    figure.suptitle(f"{air.name}: {summary.kind}, {air.precipitable_water:.1f} kg m⁻² of water vapour", fontsize=11)
    return figure
