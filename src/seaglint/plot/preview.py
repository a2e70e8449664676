"""Picture of a sequence or map: radiance and apparent temperature, with angles on the axes.

Where rows and columns are not lines of equal elevation and azimuth (plane images, rolled cameras), such lines are drawn across the picture.
"""

from __future__ import annotations

import json
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.brightness import Scale
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.representation import rounded
from seaglint.base.schema import ARTICLE_RADIANCE_PER_SI, ARTICLE_RADIANCE_SYMBOL, VARIABLES
from seaglint.plot.figures_and_pages import beyond, new_figure, save_figure
from seaglint.plot.scale import Kind, add_article_units, round_ticks, scale_of
from seaglint.store.provenance import stored_band
from seaglint.store.stored_images import below_horizon, directions, images, pictures, to_temperature

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    from seaglint.optics.band import Band


_LINES: Final[dict[str, Any]] = {"colors": "deepskyblue", "linewidths": 0.8, "alpha": 0.8}

_INSET: Final = 0.055  #: Distance of labels from the picture's edge [share of its side].

_APART: Final = (0.16, 0.06)  #: Least distance of two labels across and down [share of the picture's width and height].

_BESIDE: Final = 22.5  #: Azimuth of the labels of elevations, half-way between two of the lines of azimuth [deg].


def draw_graticule(axes: Axes, azimuth: FloatArray, elevation: FloatArray) -> None:
    """Draw the lines, with labels that are legible on dark and bright pixels, over axes that count pixels.

    Parameters
    ----------
    axes : Axes
        Holds the picture.
    azimuth, elevation : ndarray (ny, nx)
        Directions of the pixels [deg].
    """
    from matplotlib.ticker import MaxNLocator

    axes.set_xlabel("column")
    axes.set_ylabel("row")
    # Contours need two rows and two columns.
    if min(azimuth.shape) < 2:
        return
    # Round the nadir, or the whole compass, azimuth has a seam that its lines would bunch on.
    around = float(np.ptp(azimuth)) > 180.0
    for values, unit in ((elevation, "°"), (azimuth, "° az")):
        if np.ptp(values) == 0.0 or (values is azimuth and around):
            continue
        lines = axes.contour(values, levels=MaxNLocator(6).tick_values(float(values.min()), float(values.max())), **_LINES)
        if not around:
            for text in axes.clabel(lines, fmt=lambda value, unit=unit: f"{value:g}{unit}", fontsize=8):
                _outline(text)
    if around:
        for towards in range(0, 360, 45):
            _draw_azimuth(axes, float(towards), azimuth)
        for level in MaxNLocator(6).tick_values(float(elevation.min()), float(elevation.max())):
            if abs(level) < 90.0:
                _label_elevation(axes, float(level), azimuth, elevation)


def _angles_from(azimuth: FloatArray, towards: float) -> FloatArray:
    """Return angles measured from an azimuth, -180 to 180 [deg]."""
    return np.asarray((azimuth - towards + 180.0) % 360.0 - 180.0)


def _draw_azimuth(axes: Axes, towards: float, azimuth: FloatArray) -> None:
    """Draw the line of one azimuth as the zero of a sine, with its label where the line leaves the picture."""
    # A sine has no seam at 360 degrees, where azimuth jumps; its second zero, in the opposite direction, is masked by the cosine.
    off = np.radians(azimuth - towards)
    sine = np.where(np.cos(off) > 0.0, np.sin(off), np.nan)
    if not (np.any(sine < 0.0) and np.any(sine > 0.0)):
        return
    axes.contour(sine, levels=[0.0], **_LINES)
    rows, columns = azimuth.shape
    at_row, at_column = _inner(rows), _inner(columns)
    row, column = np.indices(azimuth.shape)
    inside = (row >= at_row) & (row < rows - at_row) & (column >= at_column) & (column < columns - at_column)
    # The label is written where the line crosses a rectangle at the labels' distance from the edge.
    ring = inside & ((row == at_row) | (row == rows - 1 - at_row) | (column == at_column) | (column == columns - 1 - at_column))
    distance = np.where(ring, np.abs(_angles_from(azimuth, towards)), np.inf)
    place = np.unravel_index(int(np.argmin(distance)), distance.shape)
    # Further away than a quarter of the step between two lines, the label would not be on its line.
    if distance[place] < 0.25 * 45.0:
        _write(axes, float(place[1]), float(place[0]), f"{towards:g}° az")


def _label_elevation(axes: Axes, level: float, azimuth: FloatArray, elevation: FloatArray) -> None:
    """Write an elevation where its line is nearest to the azimuth between two labelled lines, inside and apart from other labels."""
    rows, columns = elevation.shape
    row, column = np.indices(elevation.shape)
    inside = (np.minimum(row, rows - 1 - row) >= _inner(rows)) & (np.minimum(column, columns - 1 - column) >= _inner(columns))
    for text in axes.texts:
        x, y = text.get_position()
        inside &= (np.abs(column - x) > _APART[0] * columns) | (np.abs(row - y) > _APART[1] * rows)
    # About the change of elevation from one pixel to the next.
    step = max(float(np.ptp(elevation)) / min(elevation.shape), 1e-9)
    near = inside & (np.abs(elevation - level) <= 1.5 * step)
    if not near.any():
        return
    # Distance from the azimuth of the labels in steps of the lines, plus distance from the line in pixels.
    off = np.where(near, np.abs(_angles_from(azimuth, _BESIDE)) / 45.0 + np.abs(elevation - level) / step, np.inf)
    place = np.unravel_index(int(np.argmin(off)), off.shape)
    _write(axes, float(place[1]), float(place[0]), f"{level:g}°")


def _inner(pixels: int) -> int:
    """Return the distance of labels from the edge of a side [px]."""
    return min(round(_INSET * pixels), (pixels - 1) // 2)


def _write(axes: Axes, column: float, row: float, text: str) -> None:
    _outline(axes.text(column, row, text, fontsize=8, ha="center", va="center", clip_on=True))


def _outline(text: Any) -> None:
    """Make a text white with a dark edge, legible on any grey and colour."""
    from matplotlib.patheffects import withStroke

    text.set_color("white")
    text.set_alpha(1.0)
    text.set_path_effects([withStroke(linewidth=2.5, foreground="#102030")])


def _step(centres: FloatArray) -> float | None:
    return float(centres[-1] - centres[0]) / (centres.size - 1) if centres.size > 1 else None


def _edges(centres: FloatArray, alone: float) -> tuple[float, float]:
    """Return the first and the last edge of pixels; a single pixel is ``alone`` wide."""
    step = _step(centres) or alone
    return float(centres[0] - 0.5 * step), float(centres[-1] + 0.5 * step)


def _title(dataset: xr.Dataset, frame: int) -> str:
    """Return facts of the scene, from the scenario in the attributes, and the time of a frame."""
    band = stored_band(dataset.attrs)
    facts = [f"{band.min_um:g}–{band.max_um:g} µm"]
    try:
        scenario = json.loads(dataset.attrs["scenario"])
        facts.append(f"sensor {scenario['sensor']['height_m']:g} m")
        facts.append(f"wind {scenario['wind']['speed_m_s']:g} m/s from {scenario['wind']['from_deg']:g}°")
        if scenario.get("sun"):
            facts.append(f"Sun zenith {scenario['sun']['zenith_deg']:g}°, azimuth {scenario['sun']['azimuth_deg']:g}°")
        elif scenario.get("time"):
            facts.append(str(scenario["time"]["utc"]))
    # Maps of other programs have no scenario, or another one: its facts are then left out.
    except (KeyError, ValueError, TypeError):
        pass
    if "time" in pictures(dataset).dims:
        facts.append(f"t = {float(dataset['time'][frame]):g} s")
    return " · ".join(facts)


def _panel(
    figure: Figure, axes: Axes, values: NDArray[Any], extent: tuple[float, float, float, float], name: str, colours: str, norm: Normalize
) -> Any:
    # Very wide and very high pictures are stretched to fill their panel.
    shape: Literal["equal", "auto"] = "equal" if 0.2 < abs((extent[3] - extent[2]) / (extent[1] - extent[0])) < 5.0 else "auto"
    image = axes.imshow(values, cmap=colours, norm=norm, extent=extent, origin="upper", aspect=shape, interpolation="nearest")
    axes.set_xlabel("azimuth [deg]")
    axes.set_ylabel("elevation [deg]")
    axes.set_title(VARIABLES[name].long_name, fontsize=10)
    assert norm.vmin is not None
    assert norm.vmax is not None
    return figure.colorbar(image, ax=axes, extend=beyond(values[np.isfinite(values)], norm.vmin, norm.vmax), pad=0.02)


def _norms(scale: Scale, band: Band) -> tuple[Normalize, Normalize]:
    """Return the colour scales of radiance and apparent temperature: on a logarithmic scale a temperature is as bright as its radiance."""
    from matplotlib.colors import FuncNorm, Normalize

    # Noise can make the lower end negative, and no temperature has a negative radiance.
    low, high = (float(t) for t in to_temperature(np.array([max(scale.low, 0.0), scale.high]), band))
    known = bool(np.isfinite([low, high]).all()) and high > low
    if not scale.logarithmic:
        return Normalize(scale.low, scale.high), Normalize(*((low, high) if known else (None, None)))
    bright = FuncNorm((scale.share, scale.value), scale.low, scale.high)
    if not known:
        return bright, Normalize()
    # A table for both directions instead of solving Planck's law for each pixel; a node for each of 256 levels, and the end.
    share = np.linspace(0.0, 1.0, 257)
    kelvin = to_temperature(scale.value(share), band)

    def forward(temperature: Any) -> FloatArray:
        return np.asarray(np.interp(temperature, kelvin, share))

    def back(brightness: Any) -> FloatArray:
        return np.asarray(np.interp(brightness, share, kelvin))

    return bright, FuncNorm((forward, back), low, high)


def _bars(bar: Any, thermal: Any, scale: Scale, warm: Normalize) -> None:
    """Write units on the colour bars: two for radiance, where the article's unit reads 100 times the SI number."""
    symbol = VARIABLES["radiance"].symbol
    thermal.set_label(VARIABLES["apparent_temperature"].units, fontsize=8)
    if scale.logarithmic:
        # A second axis would be linear, and this one is not.
        ticks = round_ticks(scale.share, scale.value)
        bar.set_ticks(ticks, labels=[f"{rounded(tick, 9)} ({rounded(ARTICLE_RADIANCE_PER_SI * tick, 9)})" for tick in ticks])
        bar.set_label(f"{symbol} ({ARTICLE_RADIANCE_SYMBOL}), logarithmic", fontsize=8)
        kelvin = round_ticks(lambda t: np.asarray(warm(t)), lambda share: np.asarray(warm.inverse(share)))
        thermal.set_ticks(kelvin, labels=[rounded(tick, 9) for tick in kelvin])
        bar.minorticks_off()
        thermal.minorticks_off()
    else:
        bar.set_label(symbol, fontsize=8)
        add_article_units(bar.ax, "left")
    for drawn in (bar, thermal):
        drawn.ax.tick_params(labelsize=7)


def _sky_beyond(radiance: NDArray[Any], below: FloatArray, scale: Scale) -> bool:
    """Return True where most of the sky is outside the scale and most of the sea inside."""
    known = np.isfinite(radiance)
    outside = known & ((radiance > scale.high) | (radiance < scale.low))
    sea = np.broadcast_to(below > 0.0, radiance.shape) & known
    sky = known & ~sea
    return bool(
        2 * np.count_nonzero(outside & sky) > np.count_nonzero(sky) > 0 and 2 * np.count_nonzero(outside & sea) < np.count_nonzero(sea)
    )


def _mark_horizon(axes: Axes, below: FloatArray, elevation: FloatArray | None, letters: int) -> None:
    """Draw a dotted line at the horizon, which a sky beyond the scale hides, and note it in the title, in lines of so many letters.

    A grid has rows of one elevation.
    """
    if elevation is not None:
        axes.axhline(float(np.mean(elevation + below[:, 0])), color="deepskyblue", linestyle=":", linewidth=1.2)
    else:
        axes.contour(below, levels=[0.0], colors="deepskyblue", linestyles=":", linewidths=1.2)
    title = f"{axes.get_title()}, sky and sea near the horizon beyond the scale, horizon dotted"
    axes.set_title("\n".join(textwrap.wrap(title, letters)), fontsize=10)


def draw(dataset: xr.Dataset, scale: Kind = "auto") -> Figure:
    """Return a figure of the first frame of a sequence, or of a map; ``seaglint.plot.scale.scale_of`` explains ``scale``.

    Raises
    ------
    DataError
        No pixel has a finite value.
    """
    finished = images(dataset)
    radiance, frame = finished[0], int(finished.indices[0])
    if not np.isfinite(radiance).any():
        raise DataError(f"a picture of {radiance.shape[1]} x {radiance.shape[0]} pixels without a finite value; there is nothing to draw")
    band = stored_band(dataset.attrs)
    temperature = to_temperature(radiance, band)
    below = below_horizon(dataset, frame)
    chosen = scale_of(radiance, scale, below)
    bright, warm = _norms(chosen, band)
    azimuth, elevation = directions(dataset, frame)
    upright = azimuth.ndim == 1
    if upright:
        # a single row or column has pixels as wide as the other axis
        x = _edges(azimuth, abs(_step(elevation) or 1.0))
        top, bottom = _edges(elevation, -abs(_step(azimuth) or 1.0))
    else:
        x, (top, bottom) = (-0.5, azimuth.shape[1] - 0.5), (-0.5, azimuth.shape[0] - 0.5)
    extent = (*x, bottom, top)
    # Wide pictures are placed one below the other, high ones side by side.
    wide = abs((x[1] - x[0]) / (top - bottom)) > 1.0
    figure = new_figure(*((9.0, 9.0) if wide else (12.0, 6.0)))
    upper, lower = figure.subplots(2, 1) if wide else figure.subplots(1, 2)
    bar = _panel(figure, upper, radiance, extent, "radiance", "inferno", bright)
    _bars(bar, _panel(figure, lower, temperature, extent, "apparent_temperature", "gray", warm), chosen, warm)
    if not upright:
        for axes in (upper, lower):
            draw_graticule(axes, azimuth, elevation)
    if below is not None and _sky_beyond(radiance, below, chosen):
        for axes in (upper, lower):
            _mark_horizon(axes, below, elevation if upright else None, 100 if wide else 55)
    figure.suptitle(_title(dataset, frame), fontsize=11)
    return figure


def write_picture(dataset: xr.Dataset, output: str | Path, scale: Kind = "auto") -> Path:
    """Write the picture as PNG; ``scale`` as in ``draw``.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    return save_figure(draw(dataset, scale), output, 130, "make room and run the same command with --resume", format="png")
