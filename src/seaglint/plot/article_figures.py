"""Figures 2, 3, 4, 10 and 12 of the source article, drawn from the datasets of the studies. Equal datasets give equal bytes.

Figure 12 is drawn as its class: a frame in colours and in grey, and the geometry from the side.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.schema import VARIABLES
from seaglint.formats.object_labels import Label
from seaglint.plot.figures_and_pages import new_figure, save_figure
from seaglint.plot.scale import add_article_units, number_decades, scale_of
from seaglint.store.provenance import stored_band
from seaglint.store.stored_images import directions, to_temperature

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Colours of the bodies in their order: the article's attacking one is red, the defending one green.
COLOURS: Final = ("tab:red", "tab:green", "tab:orange", "tab:purple")

_COLUMNS: Final = (
    "sea from above, quantised",
    "exchange sample, likelihood given the histogram",
    "Gibbs sweeps at the pseudo-likelihood's fit",
    "Gibbs sweeps, couplings weakened",
)

_RADIANCE: Final = VARIABLES["radiance"].symbol

_DECADES: Final = 3.0  #: Decades below its maximum that a logarithmic colour scale shows.

#: Radiances of the lines in the maps of the mirrored Sun [W m-2 sr-1].
_ROUND: Final = (0.1, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)

_SUN_STEP: Final = 0.125  #: Rows of the maps of Fig. 3 [deg of the Sun's zenith angle].

_SHARES: Final = (0.1, 0.5, 0.9)  #: Shares of its maximum that lines show in each image of glint.

_CLOSE: Final = 24  #: Pixels along each side of a close view.

_SECOND_MARKS: Final = 1.0  #: Time between marks on the paths of the bodies [s].


def draw_figure_10(dataset: xr.Dataset) -> Figure:
    """Draw textures of isotropic couplings (upper row) and of horizontal ones (lower row): picture, and samples by three methods."""
    figure = new_figure(14.0, 8.0)
    panels = figure.subplots(2, len(_COLUMNS))
    names = ("(a) isotropic", "(b) horizontal")
    for i, row in enumerate(panels):
        for j, axes in enumerate(row):
            axes.imshow(
                dataset["grey_level"].to_numpy()[i, j], cmap="gray", vmin=0, vmax=dataset.attrs["levels"] - 1, interpolation="nearest"
            )
            axes.set_xticks([])
            axes.set_yticks([])
            correlation = dataset["correlation"].to_numpy()[i, j]
            deviation = float(dataset["std_level"].to_numpy()[i, j])
            lines = [f"deviation {deviation:.2f} levels; correlation → {correlation[0]:.2f}, ↓ {correlation[1]:.2f}"]
            # Only the second column has couplings with standard errors; the next two have regimes.
            if j == 1:
                coupling, error = (dataset[key].to_numpy()[i, 1] for key in ("coupling", "coupling_standard_error"))
                lines.append(f"β → {coupling[0]:.3f} ± {error[0]:.3f}, ↓ {coupling[1]:.3f} ± {error[1]:.3f}")
            if j == 2:
                lines.append(f"{dataset.attrs['regimes'][i][0]}: mean-field slope {float(dataset['mean_field_slope'][i, 0]):.2f}")
            if j == 3:
                lines.append(dataset.attrs["regimes"][i][1])
            axes.set_xlabel("\n".join(lines), fontsize=9)
            if i == 0:
                axes.set_title(_COLUMNS[j], fontsize=10)
        row[0].set_ylabel(names[i], fontsize=11)
    figure.suptitle(
        f"Autobinomial textures: {dataset.attrs['levels']} grey levels, order {dataset.attrs['order']}, {dataset.attrs['sweeps']} sweeps",
        fontsize=11,
    )
    return figure


def _settings(dataset: xr.Dataset, *more: str) -> str:
    low, high = dataset.attrs["band_um"]
    sea = f"sea {dataset.attrs['sea_temperature_k']:g} K"
    return " · ".join([f"{low:g}–{high:g} µm", f"sensor {dataset.attrs['sensor_height_m']:g} m", sea, *more, dataset.attrs["atmosphere"]])


def draw_figure_2(dataset: xr.Dataset) -> Figure:
    """Draw path and boundary properties against slant range, sunlight and sky against zenith angle; a line for each wind."""
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
        add_article_units(axes, "right")
    last.axis("off")
    lines, names = b.get_legend_handles_labels()
    lines.append(a.plot([], [], color="0.3", linestyle=":", linewidth=2.0)[0])
    last.legend(lines, [*names, "(a) cubic of Eq. 9, fitted"], loc="center", fontsize=10, title="wind at 10 m", frameon=False)
    figure.suptitle(f"Path and boundary: {_settings(dataset)}", fontsize=11)
    return figure


def smooth_rows(sun: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return rows at even steps of ``_SUN_STEP`` from the computed rows, by monotone cubics: kinks of lines show as stripes."""
    from scipy.interpolate import PchipInterpolator

    fine = np.linspace(sun[0], sun[-1], 1 + round(float(sun[-1] - sun[0]) / _SUN_STEP))
    return fine, np.asarray(PchipInterpolator(sun, values, axis=0)(fine))


def draw_figure_3(dataset: xr.Dataset) -> Figure:
    """Draw mirrored Sun (upper) and apparent temperature (lower) against the zenith angles of sensor and Sun; a column for each wind."""
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
        # Logarithms, as in the colours; the floor keeps them finite, and is far below the displayed decades.
        rows, logarithm = smooth_rows(sun, np.log(np.maximum(solar[i], 1e-3 * dimmest)))
        glint, apparent = np.exp(logarithm), smooth_rows(sun, temperature[i])[1]
        bright = upper.pcolormesh(sensor, rows, np.maximum(glint, dimmest), norm=log, cmap="inferno", shading="gouraud")
        warm = lower.pcolormesh(sensor, rows, apparent, vmin=290.0, vmax=hottest, cmap="inferno", shading="gouraud")
        # Labels find no good place on finer lines: they go to the crowded edge at the horizon.
        upper.clabel(upper.contour(sensor, rows[::4], glint[::4], levels=_ROUND, colors="w", linewidths=0.6), fontsize=7, fmt="%g")
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
    """Draw images of glint, mean (left) and standard deviation (right): a row for each wind speed, a column for each wind direction."""
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
            floored = np.maximum(values[i, j], lowest)
            image = axes.imshow(floored, norm=scale, cmap="inferno", extent=extent, origin="upper", aspect="equal", interpolation="nearest")
            axes.contour(azimuth, elevation, values[i, j], levels=values[i, j].max() * np.array(_SHARES), colors="c", linewidths=0.7)
            axes.tick_params(labelsize=8)
            if i == 0:
                axes.set_title("wind from the Sun" if directions[j] == 0.0 else f"{directions[j]:g}° right of the Sun", fontsize=9)
            if j == 0:
                axes.set_ylabel(f"{winds[i]:g} m/s\nelevation [deg]", fontsize=9)
            if i == winds.size - 1:
                axes.set_xlabel("azimuth from the Sun [deg]", fontsize=9)
        # All panels of a half share one scale: the bar of the last image is the bar of all.
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
    return save_figure(DRAW[name](dataset), output, 110, format="png", metadata={"Software": None})


class EngagementWays(Protocol):
    """Positions of sensor and bodies in the vertical plane of the line of sight, from ``seaglint.studies.article.figures_5_and_12``."""

    @property
    def time(self) -> FloatArray:
        """Times of the frames [s]."""
        ...

    @property
    def ahead(self) -> dict[str, FloatArray]:
        """Distance ahead of the sensor's start by name [m, (frames,)]; the sensor itself has the name ``"sensor"``."""
        ...

    @property
    def height(self) -> dict[str, FloatArray]:
        """Height above the mean sea by name [m, (frames,)]."""
        ...

    @property
    def sight(self) -> tuple[float, float]:
        """Elevations of the image's lower and upper edge [rad]."""
        ...


def draw(dataset: xr.Dataset, index: int, labels: list[Label], ways: EngagementWays) -> Figure:
    """Draw one frame of the sequence beside its geometry.

    Parameters
    ----------
    dataset : xarray.Dataset
        The sequence.
    index : int
        Index of the displayed frame in the sequence.
    labels : list of Label
        Labels of the bodies in this frame.
    ways : EngagementWays
        Positions of sensor and bodies over the stored frames.
    """
    figure = new_figure(12.0, 9.5)
    panels = figure.subplot_mosaic([["colours", "grey"], ["side", "side"]], height_ratios=[1.9, 1.0])
    radiance = dataset["radiance"].isel(time=index).to_numpy()
    scale = scale_of(radiance, "linear")
    kelvin = to_temperature(np.maximum(radiance, 0.0), stored_band(dataset.attrs))
    limits = to_temperature(np.maximum([scale.low, scale.high], 0.0), stored_band(dataset.attrs))
    band = stored_band(dataset.attrs)
    extent = _extent(dataset)
    shown = panels["colours"].imshow(kelvin, cmap="turbo", vmin=limits[0], vmax=limits[1], extent=extent, interpolation="nearest")
    bar = figure.colorbar(shown, ax=panels["colours"], extend="both", location="bottom", shrink=0.8, pad=0.02)
    bar.set_label(VARIABLES["apparent_temperature"].label)
    shown = panels["grey"].imshow(radiance, cmap="gray", vmin=scale.low, vmax=scale.high, extent=extent, interpolation="nearest")
    bar = figure.colorbar(shown, ax=panels["grey"], extend="both", location="bottom", shrink=0.8, pad=0.02)
    bar.set_label(f"in-band radiance [{VARIABLES['radiance'].symbol}]")
    for letter, axes in (("a", panels["colours"]), ("b", panels["grey"])):
        axes.set(xlabel="azimuth [deg]", ylabel="elevation [deg]", aspect="auto")
        axes.set_title(f"({letter}) t = {float(ways.time[index]):.2f} s, {band.min_um:g}–{band.max_um:g} µm", fontsize=10)
    for number, label in enumerate(labels):
        if label.mask.any():
            _marked(panels["colours"], label, radiance.shape, extent, COLOURS[number % len(COLOURS)])
            _close_view(panels["grey"], radiance, label, number, (scale.low, scale.high))
    _side(panels["side"], index, ways)
    # The enlargement is known only after the layout of the panels.
    figure.draw_without_rendering()
    panels["side"].set_title(f"{panels['side'].get_title()}; heights {_enlarged(panels['side']):.0f} times enlarged", fontsize=10)
    return figure


def write(dataset: xr.Dataset, index: int, labels: list[Label], ways: EngagementWays, output: str | Path) -> Path:
    """Draw the figure (``draw``) and write it as PNG, without date or version inside.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    return save_figure(draw(dataset, index, labels, ways), output, 90, format="png", metadata={"Software": None})


def _extent(dataset: xr.Dataset) -> tuple[float, float, float, float]:
    """Return the azimuths of the left and right edge and the elevations of the lower and upper edge [deg]."""
    azimuth, elevation = directions(dataset)
    if azimuth.ndim == 2:  # upright all the same: every row has the same azimuths
        azimuth, elevation = np.unwrap(azimuth[0], period=360.0) % 360.0, elevation[:, 0]
    across = 0.5 * (azimuth[-1] - azimuth[0]) / max(azimuth.size - 1, 1)
    down = 0.5 * (elevation[0] - elevation[-1]) / max(elevation.size - 1, 1)
    return float(azimuth[0] - across), float(azimuth[-1] + across), float(elevation[-1] - down), float(elevation[0] + down)


def _marked(axes: Axes, label: Label, shape: tuple[int, ...], extent: tuple[float, float, float, float], colour: str) -> None:
    """Draw a ring around a body, with its name and range."""
    x = extent[0] + (label.values["column_px"] + 0.5) / shape[1] * (extent[1] - extent[0])
    y = extent[3] - (label.values["row_px"] + 0.5) / shape[0] * (extent[3] - extent[2])
    # A white ring below the coloured one separates it from any background.
    axes.plot(x, y, "o", ms=22, mfc="none", mec="white", mew=2.6)
    axes.plot(x, y, "o", ms=22, mfc="none", mec=colour, mew=1.4)
    right = x > 0.5 * (extent[0] + extent[1])
    text = f"{label.name}\n{1e-3 * label.values['range_m']:.2f} km"
    axes.annotate(
        text,
        (x, y),
        (-14 if right else 14, 0),
        textcoords="offset points",
        ha="right" if right else "left",
        va="center",
        fontsize=8,
        color="white",
        bbox={"boxstyle": "round", "fc": "black", "ec": colour, "alpha": 0.7},
    )


def _close_view(axes: Axes, radiance: NDArray[Any], label: Label, number: int, limits: tuple[float, float]) -> None:
    """Draw the pixels around a body, enlarged, in a corner of the image."""
    rows, columns = radiance.shape
    side = min(_CLOSE, rows, columns)
    left = int(np.clip(round(label.values["column_px"]) - side // 2, 0, columns - side))
    top = int(np.clip(round(label.values["row_px"]) - side // 2, 0, rows - side))
    inset = axes.inset_axes((0.02 + 0.32 * number, 0.02, 0.28, 0.28))
    inset.imshow(radiance[top : top + side, left : left + side], cmap="gray", vmin=limits[0], vmax=limits[1], interpolation="nearest")
    inset.set(xticks=[], yticks=[])
    inset.set_title(f"{label.name}, {side} × {side} pixels", fontsize=7, color="white", pad=2, backgroundcolor="black")
    for spine in inset.spines.values():
        spine.set(color=COLOURS[number % len(COLOURS)], linewidth=2)


def _side(axes: Axes, index: int, ways: EngagementWays) -> None:
    """Draw heights against the distance ahead of the sensor's start, with the field of view of the frame."""
    farthest = 1.08 * max(float(ahead.max()) for ahead in ways.ahead.values()) + 1.0
    names = ["sensor", *(name for name in ways.ahead if name != "sensor")]
    x, h = float(ways.ahead["sensor"][index]), float(ways.height["sensor"][index])
    along = np.linspace(0.0, farthest - x, 200)

    def ray(elevation: float) -> FloatArray:
        # A straight ray over a sea that falls by s^2 / 2R; the radius includes refraction.
        return np.asarray(h + along * np.tan(elevation) + along**2 / (2.0 * EFFECTIVE_EARTH_RADIUS))

    lower, upper = (ray(elevation) for elevation in ways.sight)
    axes.fill_between(
        1e-3 * (x + along), np.maximum(lower, 0.0), upper, color="0.9", lw=0, label=f"field of view at {ways.time[index]:.2f} s"
    )
    axes.plot(1e-3 * (x + along), ray(-horizon_depression(h)), "k:", lw=0.8, label="to the horizon")
    every = max(round(_SECOND_MARKS / float(ways.time[1] - ways.time[0])), 1) if ways.time.size > 1 else 1
    for number, name in enumerate(names):
        colour = "black" if name == "sensor" else COLOURS[(number - 1) % len(COLOURS)]
        ahead, height = 1e-3 * ways.ahead[name], ways.height[name]
        axes.plot(ahead, height, "-", color=colour, lw=1.2)
        axes.plot(ahead[::every], height[::every], "|", color=colour, ms=7)
        axes.plot(ahead[index], height[index], "o", color=colour, ms=7, label=name)
    axes.axhspan(-6.0, 0.0, color="tab:blue", alpha=0.4, lw=0)
    axes.set_xlim(min(0.0, *(1e-3 * float(a.min()) for a in ways.ahead.values())) - 0.05, 1e-3 * farthest)
    axes.set_ylim(-6.0, 1.25 * max(float(height.max()) for height in ways.height.values()))
    axes.set(xlabel="distance ahead of the sensor's start, along the sea [km]", ylabel="height above the mean sea [m]")
    marks = f"marks every {_SECOND_MARKS:g} s" if every > 1 else "marks every frame"
    axes.set_title(f"(c) from the side; {marks}", fontsize=10)
    axes.legend(loc="upper right", fontsize=8, ncols=2)


def _enlarged(axes: Axes) -> float:
    """Return the factor by which heights are enlarged against distances; valid after the layout."""
    size = axes.get_window_extent()
    metres = float(np.ptp(axes.get_ylim())), 1e3 * float(np.ptp(axes.get_xlim()))
    return float((size.height / metres[0]) / (size.width / metres[1]))
