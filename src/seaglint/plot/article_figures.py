"""Figures 2, 3, 4 and 10 of the source article, drawn from the datasets of the studies. The same dataset gives the same bytes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.schema import ARTICLE_RADIANCE_PER_SI, ARTICLE_RADIANCE_SYMBOL, VARIABLES
from seaglint.files.outputs import moved_when_whole
from seaglint.plot.new_figure import new_figure
from seaglint.plot.scale import number_decades
from seaglint.plot.texture_figure import draw_figure_10

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_RADIANCE: Final = VARIABLES["radiance"].symbol

_DECADES: Final = 3.0  #: Decades below its maximum that a logarithmic colour scale shows.


#: Radiances of the lines in the maps of the mirrored Sun [W m-2 sr-1].
_ROUND: Final = (0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)

_SUN_STEP: Final = 0.125  #: Rows of the maps of Fig. 3 [deg of the Sun's zenith angle].

_SHARES: Final = (0.1, 0.5, 0.9)  #: Shares of its maximum that lines show in each image of glint.


def _settings(dataset: xr.Dataset, *more: str) -> str:
    low, high = dataset.attrs["band_um"]
    sea = f"sea {dataset.attrs['sea_temperature_k']:g} K"
    return " · ".join([f"{low:g}–{high:g} µm", f"sensor {dataset.attrs['sensor_height_m']:g} m", sea, *more, dataset.attrs["atmosphere"]])


def _both_units(axes: Axes) -> None:
    """The article's unit on the right-hand side."""

    def article(radiance: Any) -> Any:
        return ARTICLE_RADIANCE_PER_SI * radiance

    def back(radiance: Any) -> Any:
        return radiance / ARTICLE_RADIANCE_PER_SI

    right = axes.secondary_yaxis("right", functions=(article, back))
    right.set_ylabel(ARTICLE_RADIANCE_SYMBOL, fontsize=8)
    right.tick_params(labelsize=7)


def draw_figure_2(dataset: xr.Dataset) -> Figure:
    """Path and boundary properties against slant range, sunlight and sky against zenith angle; a line for each wind."""
    from matplotlib import colormaps

    figure = new_figure(13.0, 7.5)
    (a, b, c), (d, e, last) = figure.subplots(2, 3)
    winds = dataset["wind_speed_m_s"].to_numpy()
    colours = colormaps["viridis"](np.linspace(0.0, 0.9, winds.size))
    kilometres = 1e-3 * dataset["slant_range_m"].to_numpy()
    zenith = dataset["zenith_deg"].to_numpy()
    panels = (
        (a, "transmittance", kilometres, "(a) path transmittance", "band mean [1]"),
        (b, "path_radiance_W_m2_sr", kilometres, "(b) path radiance", f"radiance [{_RADIANCE}]"),
        (c, "boundary_radiance_W_m2_sr", kilometres, "(c) blackbody sea behind the path", f"radiance [{_RADIANCE}]"),
        (d, "solar_irradiance_W_m2", zenith, "(d) sunlight at the sea, normal to the beam", "irradiance [W m⁻²]"),
        (e, "sky_radiance_W_m2_sr", zenith, "(e) sky seen from the sea", f"radiance [{_RADIANCE}]"),
    )
    for axes, name, x, title, label in panels:
        for values, colour, wind in zip(dataset[name].to_numpy(), colours, winds, strict=True):
            axes.plot(x, values, color=colour, label=f"{wind:g} m/s")
        axes.set_title(title, fontsize=10)
        axes.set_ylabel(label)
        axes.grid(alpha=0.3)
    for values, colour in zip(dataset["transmittance_eq_9"].to_numpy(), colours, strict=True):
        a.plot(kilometres, values, color=colour, linestyle=":", linewidth=2.0)
    for axes in (a, b, c):
        axes.set_xscale("log")
        axes.set_xlabel("slant range [km]")
        axes.set_xlim(kilometres[0], kilometres[-1])
        axes.set_xticks([0.2, 0.5, 1, 2, 5, 10, 20, 40], ["0.2", "0.5", "1", "2", "5", "10", "20", "40"])
        axes.minorticks_off()
    d.set_xlabel("zenith angle of the Sun [deg]")
    e.set_xlabel("zenith angle of the line of sight [deg]")
    for axes in (d, e):
        axes.set_xlim(0.0, 90.0)
    for axes in (a, b, d, e):
        axes.set_ylim(bottom=0.0)
    temperature, radiance = dataset.attrs["blackbody_temperature_k"], dataset.attrs["blackbody_radiance_W_m2_sr"]
    for axes in (b, c, e):
        axes.axhline(radiance, color="0.4", linestyle="--", linewidth=1.0, label=f"blackbody of {temperature:g} K")
        _both_units(axes)
    last.axis("off")
    lines, names = b.get_legend_handles_labels()
    lines += [a.plot([], [], color="0.3", linestyle=":", linewidth=2.0)[0]]
    last.legend(lines, [*names, "(a) cubic of Eq. 9, fitted"], loc="center", fontsize=10, title="wind at 10 m", frameon=False)
    figure.suptitle(f"Path and boundary: {_settings(dataset)}", fontsize=11)
    return figure


def smooth_rows(sun: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rows at even steps of :data:`_SUN_STEP` between the computed ones, by monotone cubics: bent lines between them show as stripes."""
    from scipy.interpolate import PchipInterpolator

    fine = np.linspace(sun[0], sun[-1], 1 + round(float(sun[-1] - sun[0]) / _SUN_STEP))
    return fine, np.asarray(PchipInterpolator(sun, values, axis=0)(fine))


def draw_figure_3(dataset: xr.Dataset) -> Figure:
    """Mirrored Sun (upper) and apparent temperature (lower) against the zenith angles of sensor and Sun; a column for each wind."""
    from matplotlib.colors import LogNorm

    figure = new_figure(13.0, 8.0)
    winds = dataset["wind_speed_m_s"].to_numpy()
    panels = figure.subplots(2, winds.size, sharex=True, sharey=True, squeeze=False)
    sensor, sun = dataset["sensor_zenith_deg"].to_numpy(), dataset["solar_zenith_deg"].to_numpy()
    solar, temperature = dataset["solar_radiance_W_m2_sr"].to_numpy(), dataset["apparent_temperature_k"].to_numpy()
    brightest = float(np.nanmax(solar))
    dimmest = brightest * 10.0**-_DECADES
    log = LogNorm(dimmest, brightest)
    hottest = 10.0 * np.ceil(0.1 * float(np.nanmax(temperature)))
    levels = np.concatenate([[295.0, 300.0, 310.0, 320.0, 330.0, 340.0, 350.0], np.arange(360.0, hottest, 20.0)])
    for i, wind in enumerate(winds):
        upper, lower = panels[0, i], panels[1, i]
        # Logarithms, as the colours; the floor keeps them finite, far below what is shown.
        rows, logarithm = smooth_rows(sun, np.log(np.maximum(solar[i], 1e-3 * dimmest)))
        glint, apparent = np.exp(logarithm), smooth_rows(sun, temperature[i])[1]
        bright = upper.pcolormesh(sensor, rows, np.maximum(glint, dimmest), norm=log, cmap="inferno", shading="gouraud")
        warm = lower.pcolormesh(sensor, rows, apparent, vmin=290.0, vmax=hottest, cmap="inferno", shading="gouraud")
        # Labels find no good place on finer lines: they go to the crowded edge at the horizon.
        bright_lines = upper.contour(sensor, rows[::4], glint[::4], levels=_ROUND, colors="w", linewidths=0.6)
        upper.clabel(bright_lines, fontsize=7, fmt="%g")
        drawn = lower.contour(sensor, rows[::4], apparent[::4], levels=levels, colors="w", linewidths=0.6)
        shown = [level for level in levels if level in (300.0, 320.0, 340.0, 360.0, 400.0, 460.0, 520.0)]
        lower.clabel(drawn, levels=shown, fontsize=7, fmt="%g")
        j, k = np.unravel_index(int(np.nanargmax(temperature[i])), temperature[i].shape)
        above = float(temperature[i, j, k] - dataset["background_temperature_k"].to_numpy()[i, k])
        for axes in (upper, lower):
            axes.plot(sensor, sensor, color="c", linestyle="--", linewidth=1.0, label="specular: Sun and sensor equal")
            axes.plot(sensor[k], sun[j], marker="+", markersize=12, color="c", linestyle="none", label="brightest point")
        lower.set_xlabel("zenith angle of the sensor φ [deg]")
        upper.set_title(f"v = {wind:g} m/s: up to {float(np.nanmax(solar[i])):.3g} {_RADIANCE}", fontsize=10)
        lower.set_title(f"T_app up to {temperature[i, j, k]:.0f} K, a rise of {above:.0f} K", fontsize=10)
    panels[0, 0].set(xlim=(float(sensor.min()), float(sensor.max())), ylim=(float(sun.min()), float(sun.max())))
    for axes in panels[:, 0]:
        axes.set_ylabel("zenith angle of the Sun µ [deg]")
    panels[0, 0].legend(fontsize=8, loc="lower left")
    bar = figure.colorbar(bright, ax=panels[0, :], extend="min", pad=0.01)
    number_decades(bar)
    bar.set_label(f"mirrored Sun [{_RADIANCE}]")
    figure.colorbar(warm, ax=panels[1, :], pad=0.01).set_label("apparent temperature T_app [K]")
    figure.suptitle(f"Solar radiation scattered from the sea: {_settings(dataset)}", fontsize=11)
    return figure


def draw_figure_4(dataset: xr.Dataset) -> Figure:
    """Images of glint: mean (left) and standard deviation (right), a row for each wind and a column for each direction of it."""
    from matplotlib.colors import LogNorm

    figure = new_figure(17.0, 8.2)
    azimuth, elevation = dataset["azimuth_from_sun_deg"].to_numpy(), dataset["elevation_deg"].to_numpy()
    across, down = 0.5 * float(azimuth[1] - azimuth[0]), 0.5 * float(elevation[0] - elevation[1])
    extent = (float(azimuth[0]) - across, float(azimuth[-1]) + across, float(elevation[-1]) - down, float(elevation[0]) + down)
    winds, directions = dataset["wind_speed_m_s"].to_numpy(), dataset["wind_from_sun_deg"].to_numpy()
    halves: Any = figure.subfigures(1, 2, wspace=0.02)
    titles = ("solar_radiance_W_m2_sr", "mean of the mirrored Sun"), ("glint_std_W_m2_sr", "its standard deviation in a detector")
    for half, (name, title) in zip(halves, titles, strict=True):
        values = dataset[name].to_numpy()
        highest = float(values.max())
        lowest = highest * 10.0**-_DECADES
        scale = LogNorm(lowest, highest)
        panels = half.subplots(winds.size, directions.size, sharex=True, sharey=True, squeeze=False)
        for (i, j), axes in np.ndenumerate(panels):
            seen = np.maximum(values[i, j], lowest)
            image = axes.imshow(seen, norm=scale, cmap="inferno", extent=extent, origin="upper", aspect="equal", interpolation="nearest")
            lines = values[i, j].max() * np.array(_SHARES)
            axes.contour(azimuth, elevation, values[i, j], levels=lines, colors="c", linewidths=0.7)
            axes.tick_params(labelsize=8)
            if i == 0:
                axes.set_title("wind from the Sun" if directions[j] == 0.0 else f"{directions[j]:g}° right of the Sun", fontsize=9)
            if j == 0:
                axes.set_ylabel(f"{winds[i]:g} m/s\nelevation [deg]", fontsize=9)
            if i == winds.size - 1:
                axes.set_xlabel("azimuth from the Sun [deg]", fontsize=9)
        bar = half.colorbar(image, ax=panels, extend="min", location="bottom", shrink=0.7, pad=0.02, aspect=40)
        number_decades(bar)
        bar.set_label(f"[{_RADIANCE}]; lines at 10, 50 and 90 % of each image's maximum", fontsize=9)
        half.suptitle(title, fontsize=11)
    more = f"Sun zenith {dataset.attrs['solar_zenith_deg']:g}°", f"detector {dataset.attrs['ifov_mrad']:g} mrad"
    figure.suptitle(f"Glint images: {_settings(dataset, *more)}", fontsize=11)
    return figure


#: Drawings by the name of the figure.
DRAW: Final[dict[str, Callable[[xr.Dataset], Figure]]] = {
    "fig2": draw_figure_2,
    "fig3": draw_figure_3,
    "fig4": draw_figure_4,
    "fig10": draw_figure_10,
}


def write_figure(name: str, dataset: xr.Dataset, output: str | Path) -> Path:
    """Draw a figure and write it as PNG, without date or version inside, so that equal numbers give equal bytes.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = Path(output)
    with moved_when_whole(output) as partial:
        DRAW[name](dataset).savefig(partial, format="png", dpi=110, metadata={"Software": None})
    return output
