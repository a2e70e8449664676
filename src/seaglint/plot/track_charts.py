"""Chart of glint along a ship's track: chances by climatology and forecast, the weather of the forecast, and the Sun, against time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from seaglint.climate.track_chances import TrackChances
from seaglint.plot.figures_and_pages import new_figure, save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DPI: Final = 130


def write_track(chances: TrackChances, output: Path) -> None:
    """Draw the chances along a track into a picture file."""
    save_figure(draw_track(chances), output, _DPI)


def draw_track(chances: TrackChances) -> Figure:
    """Draw chances of each threshold, wind and cloud cover of the forecast where there is one, and the Sun's elevation against time."""
    from matplotlib.dates import ConciseDateFormatter

    forecast = chances.has_forecast
    figure = new_figure(9.0, 6.5 if forecast else 5.0)
    panels = figure.subplots(3 if forecast else 2, 1, sharex=True, height_ratios=(2.2, 1.3, 1.0) if forecast else (2.2, 1.0))
    top, bottom = panels[0], panels[-1]
    ahead = chances.chances("forecast_probability") if forecast else None
    for number, (threshold, chance) in enumerate(zip(chances.thresholds, chances.chances(), strict=True)):
        colour, label = f"C{number}", f"{threshold:g} W m⁻² sr⁻¹"
        top.plot(chances.time, chance, "--" if forecast else "-", color=colour, label=f"{label}, climatology" if forecast else label)
        if ahead is not None:
            top.plot(chances.time, ahead[number], "-", color=colour, label=f"{label}, forecast")
    top.set(ylabel="chance of glint [1]", ylim=(0.0, None))
    top.legend(fontsize=8)
    if forecast:
        _weather(panels[1], chances)
    elevation = chances.over_time("sun_elevation_deg")
    bottom.plot(chances.time, elevation, color="tab:orange")
    bottom.axhline(0.0, color="0.5", linewidth=0.8)
    bottom.set(ylabel="Sun's elevation\n[deg]", xlabel="time (UTC)")
    # Nights, in which there is no glint, are grey, to a tenth of the steps of the track.
    seconds = chances.time.astype("datetime64[s]").astype(np.float64)
    fine = np.interp(np.arange(10 * seconds.size - 9) / 10.0, np.arange(seconds.size), seconds)
    night = np.interp(fine, seconds, elevation) < 0.0
    for axes in panels:
        axes.grid(alpha=0.3)
        grey = {"transform": axes.get_xaxis_transform(), "color": "0.5", "alpha": 0.15, "linewidth": 0}
        axes.fill_between(fine.astype("datetime64[s]"), 0.0, 1.0, where=night, **grey)
    figure.align_ylabels(panels)
    bottom.xaxis.set_major_formatter(ConciseDateFormatter(bottom.xaxis.get_major_locator()))  # type: ignore[no-untyped-call]
    return figure


def _weather(axes: Axes, chances: TrackChances) -> None:
    axes.plot(chances.time, chances.over_time("wind_speed_m_s"), color="black")
    axes.set(ylabel="wind speed [m/s]", ylim=(0.0, None))
    right = axes.twinx()
    right.plot(chances.time, chances.over_time("cloud_cover"), color="C0", linestyle=":")
    right.set_ylim(-0.02, 1.02)
    right.set_ylabel("cloud cover [1]", color="C0")
    wind, come = chances.over_time("wind_speed_m_s"), np.radians(chances.over_time("wind_from_deg") + 180.0)
    # About 24 arrows, in the direction that the wind blows towards, north upwards.
    at = np.arange(0, chances.time.size, max(chances.time.size // 24, 1))
    axes.quiver(
        chances.time[at], wind[at], np.sin(come[at]), np.cos(come[at]), angles="uv", pivot="mid", scale=30.0, width=0.002, color="0.4"
    )
