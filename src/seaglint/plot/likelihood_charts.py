"""Charts of the likelihood of glint: by threshold, bearing, month and hour; maps by month; the article's Fig. 5."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.climate.likelihood_summary import LikelihoodSummary, StratumChance
from seaglint.climate.weather_table import MONTHS
from seaglint.files.outputs import moved_when_whole
from seaglint.plot.new_figure import new_figure

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DPI = 130


def write_charts(summary: LikelihoodSummary, month_by_hour: FloatArray | None, output: Path) -> None:
    """Draw the charts into a picture file."""
    _save(draw_charts(summary, month_by_hour), output)


def draw_charts(summary: LikelihoodSummary, month_by_hour: FloatArray | None) -> Figure:
    """Draw chances by threshold, by bearing (polar), by wind and, where the time varies, by month and hour."""
    figure = new_figure(10.0, 8.0)
    first = summary.results[0].threshold_w_m2_sr
    _thresholds(figure.add_subplot(2, 2, 1), summary)
    _bearings(figure.add_subplot(2, 2, 2, projection="polar"), summary, first)
    _causes(figure.add_subplot(2, 2, 3), summary, first)
    axes = figure.add_subplot(2, 2, 4)
    if month_by_hour is None:
        _bars(axes, _of(summary, "sun_elevation_deg", first), "Sun's elevation [deg]")
    else:
        image = axes.pcolormesh(np.arange(25), np.arange(13), month_by_hour, cmap="magma", vmin=0.0)
        axes.set(xlabel="hour of the Sun's day [h]", title="by month and hour", xticks=range(0, 25, 4))
        axes.set_yticks(np.arange(12) + 0.5, [name[:3] for name in MONTHS])
        axes.invert_yaxis()
        figure.colorbar(image, ax=axes, label="probability [1]")
    figure.suptitle(f"{summary.case}: glint above {first:g} W m⁻² sr⁻¹")
    return figure


def _of(summary: LikelihoodSummary, by: str, threshold: float) -> list[StratumChance]:
    return [row for row in summary.strata if row.by == by and row.threshold_w_m2_sr == threshold]


def _thresholds(axes: Axes, summary: LikelihoodSummary) -> None:
    rows = sorted(summary.results, key=lambda row: row.threshold_w_m2_sr)
    x, p = np.array([row.threshold_w_m2_sr for row in rows]), np.array([row.probability for row in rows])
    low, high = np.array([row.interval for row in rows]).T
    axes.errorbar(x, p, yerr=[np.maximum(p - low, 0.0), np.maximum(high - p, 0.0)], marker="o", capsize=3)
    axes.set(
        xlabel="threshold [W m⁻² sr⁻¹]", ylabel="probability [1]", title="by threshold", ylim=(0.0, 1.1 * max(float(high.max()), 1e-6))
    )


def _bearings(axes: Axes, summary: LikelihoodSummary, threshold: float) -> None:
    rows = [(row.low, row.high, row.value) for row in _of(summary, "azimuth_from_sun_deg", threshold) if row.high is not None]
    axes.set_theta_zero_location("N")  # type: ignore[attr-defined]
    axes.set_theta_direction(-1)  # type: ignore[attr-defined]
    middle = [math.radians(0.5 * (low + high)) for low, high, _ in rows]
    axes.bar(middle, [value for *_, value in rows], width=[math.radians(high - low) for low, high, _ in rows], alpha=0.7)
    axes.set_title("probability [1] by azimuth from the Sun [deg]")


def _causes(axes: Axes, summary: LikelihoodSummary, threshold: float) -> None:
    _bars(axes, _of(summary, "wind_speed_m_s", threshold), "wind [m/s]")


def _bars(axes: Axes, rows: list[StratumChance], label: str) -> None:
    names = [f"{row.low:g}-{row.high:g}" if row.high is not None else f">{row.low:g}" for row in rows]
    axes.bar(names, [row.contribution or 0.0 for row in rows], color="tab:orange", label="share of all glint")
    axes.bar(names, [row.share for row in rows], fill=False, edgecolor="black", label="share of all draws")
    axes.set(xlabel=label, ylabel="share [1]")
    axes.legend()


def write_map(dataset: xr.Dataset, output: Path) -> None:
    """Draw the map of every month."""
    chance = dataset["probability"].isel(threshold=0)
    months = chance.month.to_numpy().tolist()
    columns = min(4, len(months))
    rows = math.ceil(len(months) / columns)
    figure = new_figure(3.2 * columns, 2.6 * rows + 0.6)
    most = max(float(chance.max()), 1e-6)
    image = None
    for i, month in enumerate(months):
        axes = figure.add_subplot(rows, columns, i + 1)
        image = axes.pcolormesh(chance.longitude, chance.latitude, chance.sel(month=month), cmap="magma", vmin=0.0, vmax=most)
        axes.set_title(MONTHS[month - 1], fontsize=9)
        axes.tick_params(labelsize=7)
    if image is not None:
        figure.colorbar(image, ax=figure.axes, label="probability [1]", shrink=0.8)
    figure.supxlabel("longitude [deg]", fontsize=9)
    figure.supylabel("latitude [deg]", fontsize=9)
    figure.suptitle(f"glint above {float(chance.threshold):g} W m⁻² sr⁻¹, {dataset.attrs['case']}")
    _save(figure, output)


def write_regions(result: dict[str, dict[str, FloatArray]], output: Path) -> None:
    """Draw chances by threshold and by month of several sea regions, :func:`seaglint.studies.likelihood.sea_regions.regions`."""
    figure = new_figure(10.0, 4.0)
    left, right = figure.subplots(1, 2)
    for name, columns in result.items():
        left.loglog(columns["threshold"], np.maximum(columns["probability"], 1e-6), label=name)
        right.plot(np.arange(12), columns["by_month"], marker="o", label=name)
    left.set(xlabel="threshold [W m⁻² sr⁻¹]", ylabel="probability of a look [1]", ylim=(1e-4, 1.0))
    right.set(ylabel="probability above 0.25 W m⁻² sr⁻¹ [1]", ylim=(0.0, None))
    right.set_xticks(np.arange(12), [month[:1] for month in MONTHS])
    right.set_xlabel("month")
    left.legend()
    _save(figure, output)


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
            within = "within this of the Sun [deg]: any (lines), one look (points)"
            axes.set_xlabel("azimuth from the Sun [deg]" if panel == 0 else within)
            axes.set_ylabel("probability [1]")
    grid[0][0].legend()
    _save(figure, output)


def _save(figure: Any, output: Path) -> None:
    with moved_when_whole(output) as partial:
        figure.savefig(partial, dpi=_DPI, format=output.suffix.lstrip("."))
