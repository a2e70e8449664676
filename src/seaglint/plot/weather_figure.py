"""Picture of a weather table: wind rose, joint density of wind and cloud, means by month, missing values."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from seaglint.climate.table_facts import MonthFacts, WeatherFacts, WindRose
from seaglint.files.outputs import moved_when_whole
from seaglint.plot.new_figure import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (12.0, 9.0)  #: Width and height [in].


def write_weather_plot(facts: WeatherFacts, path: Path) -> None:
    """Draw the facts of a table of weather into a picture file."""
    with moved_when_whole(path) as partial:
        draw_weather(facts).savefig(partial, dpi=120, format=path.suffix.lstrip(".").lower())


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
        axes.text(0.5, 0.5, "no directions in the table", ha="center", va="center", transform=axes.transAxes)
        axes.set_axis_off()
        return
    bottom = np.zeros(angle.size)
    for k, label in enumerate(_classes(rose.speed_edges_m_s)):
        axes.bar(
            angle,
            percent[:, k],
            0.9 * width,
            bottom=bottom,
            color=_shade(k, percent.shape[1]),
            edgecolor="white",
            linewidth=0.4,
            label=label,
        )
        bottom += percent[:, k]
    axes.legend(title="m/s", fontsize=7, loc="center right", bbox_to_anchor=(-0.12, 0.5), frameon=False)


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
        if value >= 0.5:
            colour = "white" if value > 0.6 * percent.max() else "black"
            axes.text(column, row, f"{value:.0f}" if value >= 10 else f"{value:.1f}", ha="center", va="center", fontsize=7, color=colour)
    linked = facts.wind_cloud_correlation
    axes.set(xlabel="cloud cover [eighths]", ylabel="wind speed [m/s]")
    axes.set_title(f"wind and cloud [%]{'' if linked is None else f', correlation {linked:.2f}'}", fontsize=10)
    figure.colorbar(shown, ax=axes, shrink=0.8)


def _months(axes: Any, months: list[MonthFacts]) -> None:
    axes.set_title("means by month", fontsize=10)
    if not months:
        axes.text(0.5, 0.5, "no months in the table", ha="center", va="center", transform=axes.transAxes)
        axes.set_axis_off()
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
