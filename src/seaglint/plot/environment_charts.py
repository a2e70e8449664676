"""Charts of the environment: a profile of the air, a weather table, and the likelihood of glint.

The profile shows temperature, humidity and refractivity, the lowest kilometre below the whole. The weather table is shown as wind rose,
joint density of wind and cloud, means by month and missing values. The likelihood is drawn by threshold, bearing, month and hour, and as
Fig. 5 of the source article.
"""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.climate.likelihood_summary import LikelihoodSummary, StratumChance
from seaglint.climate.table_summary import MonthFacts, WeatherFacts, WindRose
from seaglint.climate.weather_table import MONTHS
from seaglint.plot.figures_and_pages import new_figure, save_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from seaglint.formats.soundings.air_summary import AirSummary


TALL = 20.0  #: Height of the upper panels [km].


def write_air_plot(summary: AirSummary, output: Path) -> Path:
    """Write the charts of a profile of air to a picture file, complete or not at all."""
    return save_figure(draw_air(summary), output, 120)


def draw_air(summary: AirSummary) -> Figure:
    """Draw profiles against height: up to 20 km above, the lowest kilometre below."""
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
    # The model atmosphere continues above the sounding's top; 1 m allows for rounded heights.
    given = air.height <= summary.top + 1.0
    for row, top, quantities in zip(panels, (TALL, 1.0), (columns, low_columns), strict=True):
        inside = z <= top * 1.001
        # Evenly spaced up to the top of the panel, which may lie between two levels.
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


SIZE = (12.0, 9.0)  #: Width and height [in].


def write_weather_plot(facts: WeatherFacts, path: Path) -> None:
    """Draw the facts of a table of weather into a picture file."""
    save_figure(draw_weather(facts), path, 120)


def draw_weather(facts: WeatherFacts) -> Figure:
    """Draw wind rose, wind and cloud together, months and missing values of a table of weather."""
    figure = new_figure(*SIZE)
    _rose(figure.add_subplot(2, 2, 1, projection="polar"), facts.wind_rose)
    _joint(figure, figure.add_subplot(2, 2, 2), facts)
    _months(figure.add_subplot(2, 2, 3), facts.by_month)
    _missing(figure.add_subplot(2, 2, 4), facts.missing_share)
    figure.suptitle(f"{Path(facts.path).name}: {facts.rows} rows, effectively {facts.effective_rows:.0f}")
    return figure


def _classes(edges: list[float | None]) -> list[str]:
    return [f"{low:g}-{high:g}" if high is not None else f"above {low:g}" for low, high in pairwise(edges)]


def _rose(axes: Any, rose: WindRose) -> None:
    percent = 100.0 * np.array(rose.probability)
    angle, width = np.radians(rose.sector_centre_deg), 2.0 * np.pi / len(rose.sector_centre_deg)
    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    axes.set_title("where the wind comes from [% of the weight]", fontsize=10)
    if not percent.any():
        _write_only(axes, "no directions in the table")
        return
    bottom = np.zeros(angle.size)
    for k, label in enumerate(_classes(rose.speed_edges_m_s)):
        colour = _shade(k, percent.shape[1])
        axes.bar(angle, percent[:, k], 0.9 * width, bottom=bottom, color=colour, edgecolor="white", linewidth=0.4, label=label)
        bottom += percent[:, k]
    axes.legend(title="m/s", fontsize=7, loc="center right", bbox_to_anchor=(-0.12, 0.5), frameon=False)


def _write_only(axes: Any, text: str) -> None:
    """Write a text into a panel without data, in place of axes."""
    axes.text(0.5, 0.5, text, ha="center", va="center", transform=axes.transAxes)
    axes.set_axis_off()


def _shade(k: int, count: int) -> Any:
    from matplotlib import colormaps

    return colormaps["viridis"](k / max(count - 1, 1))


def _joint(figure: Any, axes: Any, facts: WeatherFacts) -> None:
    joint = facts.wind_cloud
    percent = 100.0 * np.array(joint.probability)
    shown = axes.imshow(percent, origin="lower", aspect="auto", cmap="Blues", vmin=0.0)
    axes.set_xticks(range(percent.shape[1]), [f"{k}" for k in range(percent.shape[1])])
    axes.set_yticks(range(percent.shape[0]), _classes(joint.speed_edges_m_s))
    for (row, column), value in np.ndenumerate(percent):
        # Cells that would round to 0 stay empty.
        if value >= 0.5:
            # White on the dark cells of the colours, black on the light ones.
            colour = "white" if value > 0.6 * percent.max() else "black"
            axes.text(column, row, f"{value:.0f}" if value >= 10 else f"{value:.1f}", ha="center", va="center", fontsize=7, color=colour)
    correlation = facts.wind_cloud_correlation
    axes.set(xlabel="cloud cover [eighths]", ylabel="wind speed [m/s]")
    axes.set_title(f"wind and cloud [%]{'' if correlation is None else f', correlation {correlation:.2f}'}", fontsize=10)
    figure.colorbar(shown, ax=axes, shrink=0.8)


def _months(axes: Any, months: list[MonthFacts]) -> None:
    axes.set_title("means by month", fontsize=10)
    if not months:
        _write_only(axes, "no months in the table")
        return
    number = [m.month for m in months]
    wind = [np.nan if m.wind_speed_m_s is None else m.wind_speed_m_s for m in months]
    cloud = [np.nan if m.cloud_cover is None else m.cloud_cover for m in months]
    axes.plot(number, wind, "o-", color="black", label="wind")
    axes.set(xlabel="month", ylabel="wind speed [m/s]", xlim=(0.5, 12.5), xticks=range(1, 13))
    axes.set_ylim(bottom=0.0)
    right = axes.twinx()
    right.plot(number, cloud, "s--", color="C0")
    right.set_ylim(0.0, 1.0)
    right.set_ylabel("cloud cover", color="C0")


def _missing(axes: Any, shares: dict[str, float]) -> None:
    axes.barh(list(shares), [100.0 * share for share in shares.values()], color="0.5")
    axes.invert_yaxis()
    axes.set(xlabel="missing [% of the weight]", xlim=(0.0, 100.0))
    axes.tick_params(axis="y", labelsize=8)


_DPI = 130  #: Resolution of the charts of likelihood [dots per inch].


def write_charts(summary: LikelihoodSummary, month_by_hour: FloatArray | None, output: Path) -> None:
    """Draw the charts into a picture file."""
    save_figure(draw_charts(summary, month_by_hour), output, _DPI)


def draw_charts(summary: LikelihoodSummary, month_by_hour: FloatArray | None) -> Figure:
    """Draw chances by threshold, by bearing (polar), by wind and, where the time varies, by month and hour."""
    figure = new_figure(10.0, 8.0)
    first = summary.results[0].threshold_w_m2_sr
    _thresholds(figure.add_subplot(2, 2, 1), summary)
    _bearings(figure.add_subplot(2, 2, 2, projection="polar"), summary, first)
    _bars(figure.add_subplot(2, 2, 3), _strata(summary, "wind_speed_m_s", first), "wind [m/s]")
    axes = figure.add_subplot(2, 2, 4)
    if month_by_hour is None:
        _bars(axes, _strata(summary, "sun_elevation_deg", first), "Sun's elevation [deg]")
    else:
        image = axes.pcolormesh(np.arange(25), np.arange(13), month_by_hour, cmap="magma", vmin=0.0)
        axes.set(xlabel="hour of the Sun's day [h]", title="by month and hour", xticks=range(0, 25, 4))
        axes.set_yticks(np.arange(12) + 0.5, [name[:3] for name in MONTHS])
        axes.invert_yaxis()
        figure.colorbar(image, ax=axes, label="probability [1]")
    figure.suptitle(f"{summary.case}: glint above {first:g} W m⁻² sr⁻¹")
    return figure


def _strata(summary: LikelihoodSummary, by: str, threshold: float) -> list[StratumChance]:
    return [row for row in summary.strata if row.by == by and row.threshold_w_m2_sr == threshold]


def _thresholds(axes: Axes, summary: LikelihoodSummary) -> None:
    rows = sorted(summary.results, key=lambda row: row.threshold_w_m2_sr)
    x, p = np.array([row.threshold_w_m2_sr for row in rows]), np.array([row.probability for row in rows])
    low, high = np.array([row.interval for row in rows]).T
    # Rounding may put an estimate just outside its interval, and Matplotlib refuses negative lengths of bars.
    axes.errorbar(x, p, yerr=[np.maximum(p - low, 0.0), np.maximum(high - p, 0.0)], marker="o", capsize=3)
    seas = [(row.threshold_w_m2_sr, row.sea_unknown_low, row.sea_unknown_high) for row in rows if row.sea_unknown_high is not None]
    if seas:
        at, least, most = np.array(seas, dtype=np.float64).T
        axes.vlines(at, least, most, color="0.7", lw=6.0, zorder=0, label=f"sea unknown ({rows[0].sea_draws} seas between the campaigns)")
        axes.legend(fontsize="small")
        high = np.maximum(high, most.max())
    axes.set(
        xlabel="threshold [W m⁻² sr⁻¹]", ylabel="probability [1]", title="by threshold", ylim=(0.0, 1.1 * max(float(high.max()), 1e-6))
    )


def _bearings(axes: Axes, summary: LikelihoodSummary, threshold: float) -> None:
    rows = [(row.low, row.high, row.value) for row in _strata(summary, "azimuth_from_sun_deg", threshold) if row.high is not None]
    axes.set_theta_zero_location("N")  # type: ignore[attr-defined]
    axes.set_theta_direction(-1)  # type: ignore[attr-defined]
    middle = [math.radians(0.5 * (low + high)) for low, high, _ in rows]
    axes.bar(middle, [value for *_, value in rows], width=[math.radians(high - low) for low, high, _ in rows], alpha=0.7)
    axes.set_title("probability [1] by azimuth from the Sun [deg]")


def _bars(axes: Axes, rows: list[StratumChance], label: str) -> None:
    names = [f"{row.low:g}-{row.high:g}" if row.high is not None else f">{row.low:g}" for row in rows]
    axes.bar(names, [row.contribution or 0.0 for row in rows], color="tab:orange", label="share of all glint")
    axes.bar(names, [row.share for row in rows], fill=False, edgecolor="black", label="share of all draws")
    axes.set(xlabel=label, ylabel="share [1]")
    axes.legend()


def write_regions(result: dict[str, dict[str, FloatArray]], output: Path) -> None:
    """Draw chances by threshold and by month for several sea regions, by region, threshold and month."""
    figure = new_figure(10.0, 4.0)
    left, right = figure.subplots(1, 2)
    for name, columns in result.items():
        # A logarithmic axis has no 0; 1e-6 is below its lower end.
        left.loglog(columns["threshold"], np.maximum(columns["probability"], 1e-6), label=name)
        right.plot(np.arange(12), columns["by_month"], marker="o", label=name)
    left.set(xlabel="threshold [W m⁻² sr⁻¹]", ylabel="probability of a look [1]", ylim=(1e-4, 1.0))
    right.set(ylabel="probability above 0.25 W m⁻² sr⁻¹ [1]", ylim=(0.0, None))
    right.set_xticks(np.arange(12), [month[:1] for month in MONTHS])
    right.set_xlabel("month")
    left.legend()
    save_figure(figure, output, _DPI)


def write_fig5(columns: dict[str, FloatArray], output: Path) -> None:
    """Draw both panels of Fig. 5: at one azimuth, and within an azimuth of the Sun's."""
    figure = new_figure(10.0, 7.5)
    styles = {"single-look": "-", "trajectory": "--", "field-of-view": ":"}
    grid = figure.subplots(2, 2, sharex=True)
    for row, threshold in enumerate(np.unique(columns["threshold_w_m2_sr"])[::-1]):
        for panel, what in enumerate(("probability", "probability_within")):
            axes = grid[row][panel]
            for number, (case, style) in enumerate(styles.items()):
                at = (columns["threshold_w_m2_sr"] == threshold) & (columns["case"] == number)
                (line,) = axes.plot(columns["azimuth_deg"][at], columns[what][at], style, label=case)
                if panel == 1:
                    averaged = columns["probability_averaged"][at]
                    axes.plot(columns["azimuth_deg"][at], averaged, style, color=line.get_color(), marker=".", lw=0.8)
            axes.set(ylim=(0.0, None), title=f"({'ab'[panel]}) above {threshold:g} W m⁻² sr⁻¹")
            axes.set_xlabel("azimuth from the Sun [deg]" if panel == 0 else "within this of the Sun [deg]: any (lines), one look (points)")
            axes.set_ylabel("probability [1]")
    grid[0][0].legend()
    save_figure(figure, output, _DPI)
