"""Pictures and report of detection studies: characteristics, false alarms over the field, chips, sweeps, and ranges about the Sun.

The report is one HTML file with tables and pictures inside.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seaglint.base.free_form import JsonObject, TableRow
from seaglint.plot.figures_and_pages import all_numbers, bullets, figure, interval, new_figure, notes, number, page, png, section, table
from seaglint.store.detection_results import DetectionCase
from seaglint.version import __version__

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from seaglint.store.detection_results import Chips, DetectionRange, FalseAlarmMap


MOST_CURVES: Final = 6  #: Characteristics drawn, evenly chosen from the contrasts.


def draw_characteristic(roc: dict[str, list[float]], rows: Sequence[TableRow], unit: str) -> Figure:
    """Draw operating characteristics with bands, and P_d against contrast."""
    figure = new_figure(10.0, 4.0)
    left, right = figure.subplots(1, 2)
    contrast = np.asarray(roc["contrast"])
    values = np.unique(contrast)
    # A few curves, evenly chosen from the sorted contrasts.
    for value in values[np.unique(np.linspace(0, values.size - 1, min(values.size, MOST_CURVES)).astype(int))]:
        one = contrast == value
        p_fa, p_d, low, high = (np.asarray(roc[name])[one] for name in ("p_fa", "p_d", "p_d_low", "p_d_high"))
        positive = p_fa > 0
        (line,) = left.plot(p_fa[positive], p_d[positive], linewidth=1.3, label=f"{value:g} {unit}".strip())
        left.fill_between(p_fa[positive], low[positive], high[positive], color=line.get_color(), alpha=0.2, linewidth=0)
    left.set(xscale="log", xlabel="P_fa per pixel and frame", ylabel="P_d", ylim=(-0.02, 1.02))
    left.legend(fontsize=8, frameon=False)
    ordered = sorted(rows, key=lambda row: row["contrast"])
    x = [row["contrast"] for row in ordered]
    right.plot(x, [row["p_d"] for row in ordered], marker="o", markersize=3, color="0.2")
    ends = [[row["p_d"] if row[name] is None else row[name] for row in ordered] for name in ("p_d_low", "p_d_high")]
    right.fill_between(x, ends[0], ends[1], color="0.2", alpha=0.2, linewidth=0)
    right.set(xlabel=f"contrast [{unit}]" if unit else "contrast", ylabel="P_d", ylim=(-0.02, 1.02))
    if min(x) > 0 and max(x) > 8 * min(x):
        from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

        # Contrasts over three octaves or more, such as the default sweep.
        right.set_xscale("log")
        right.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        right.xaxis.set_major_formatter(FormatStrFormatter("%g"))
        right.xaxis.set_minor_formatter(NullFormatter())
    right.set_title(f"at {ordered[0]['threshold_sigma']:.3g} sigma, P_fa {ordered[0]['p_fa']:.2g}", fontsize=10)
    return figure


def draw_map(alarms: FalseAlarmMap) -> Figure:
    """Draw P_fa over azimuth and elevation; tiles without a valid pixel are left out."""
    figure = new_figure(7.0, 3.6)
    axes = figure.subplots()
    pixels = np.asarray(alarms.pixels, float)
    rate = np.asarray(alarms.exceedances, float) / np.where(pixels > 0, pixels, np.nan)
    grid = alarms.in_degrees
    drawn = axes.pcolormesh(alarms.right, alarms.down, np.ma.masked_invalid(rate), cmap="magma", shading="flat")
    if not grid:
        axes.invert_yaxis()
    axes.set(xlabel="azimuth [deg]" if grid else "column [px]", ylabel="elevation [deg]" if grid else "row [px]")
    figure.colorbar(drawn, ax=axes).set_label("P_fa per pixel and frame")
    return figure


def draw_chips(chips: Chips, threshold_sigma: float) -> Figure | None:
    """Draw missed objects above and false alarms below; None without either."""
    lines = [(name, cut_outs) for name, cut_outs in (("missed", chips.missed), ("false", chips.false)) if cut_outs]
    if not lines:
        return None
    columns = max(len(items) for _, items in lines)
    figure = new_figure(1.6 * columns, 1.95 * len(lines))
    for (name, items), row in zip(lines, figure.subplots(len(lines), columns, squeeze=False), strict=True):
        for k, one in enumerate(row):
            one.set(xticks=[], yticks=[])
            if k >= len(items):
                one.set_axis_off()
                continue
            pixels = np.array([[np.nan if v is None else v for v in line] for line in items[k].pixels], float)
            one.imshow(pixels, cmap="gray", interpolation="nearest")
            middle = pixels.shape[0] // 2
            one.add_patch(_square(middle, "#4cc9f0" if name == "missed" else "#f94144"))
            one.set_title(f"{'missed' if name == 'missed' else 'false alarm'}, {items[k].score:.3g} σ", fontsize=8)
    figure.suptitle(f"threshold {threshold_sigma:.3g} σ", fontsize=9)
    return figure


def _square(middle: int, colour: str) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((middle - 3.0, middle - 3.0), 6.0, 6.0, fill=False, edgecolor=colour, linewidth=0.9)


def draw_sweep(rows: Sequence[TableRow], key: str) -> Figure:
    """Draw P_d and P_fa against a varied number; a line for each contrast and combination of the other varied keys."""
    figure = new_figure(10.0, 4.0)
    left, right = figure.subplots(1, 2)
    lines: dict[str, list[TableRow]] = {}
    for row in rows:
        lines.setdefault(row["_line"], []).append(row)
    for name, group in lines.items():
        ordered = sorted(group, key=lambda row: row[key])
        x = [row[key] for row in ordered]
        (line,) = left.plot(x, [row["p_d"] for row in ordered], marker="o", markersize=3, label=name)
        low, high = ([row["p_d"] if row[end] is None else row[end] for row in ordered] for end in ("p_d_low", "p_d_high"))
        left.fill_between(x, low, high, color=line.get_color(), alpha=0.15, linewidth=0)
        right.plot(x, [row["p_fa"] or np.nan for row in ordered], marker="o", markersize=3, color=line.get_color())
    left.set(xlabel=key, ylabel="P_d", ylim=(-0.02, 1.02))
    right.set(xlabel=key, ylabel="P_fa per pixel and frame", yscale="log")
    if len(lines) <= 12:
        left.legend(fontsize=7, frameon=False)
    return figure


def draw_ranges(ranges: Sequence[DetectionRange]) -> Figure:
    """Draw ranges of detection as polar curves over the bearing from the Sun; for a single bearing P_d against range."""
    lines: dict[str, list[DetectionRange]] = {}
    for one in ranges:
        lines.setdefault(one.named, []).append(one)
    polar = len({one.bearing_deg for one in ranges}) > 1
    figure = new_figure(5.6, 5.2)
    axes: Any = figure.add_subplot(projection="polar" if polar else None)
    for name, group in lines.items():
        if polar:
            # As on a compass: the Sun at the top, bearings clockwise.
            axes.set_theta_zero_location("N")
            axes.set_theta_direction(-1)
            ordered = sorted(group, key=lambda one: one.bearing_deg or 0.0)
            theta = np.radians([one.bearing_deg or 0.0 for one in ordered])
            metres = [((one.range_interval_m[0] or 0.0) if one.range_m is None else one.range_m) / 1e3 for one in ordered]
            around = np.diff(theta, append=theta[0] + 2.0 * np.pi).max() < 0.6 * np.pi  # the curve is closed where no wide gap is left
            x, y = ([*v, v[0]] if around else v for v in (theta, metres))
            (line,) = axes.plot(x, y, marker="o", markersize=3, label=name or None)
            open_ended = [k for k, one in enumerate(ordered) if one.range_m is None]
            axes.plot(theta[open_ended], np.array(metres)[open_ended], "o", markersize=7, fillstyle="none", color=line.get_color())
        else:
            for one in group:
                points = one.points
                axes.plot([p.range_m / 1e3 for p in points], [p.p_d for p in points], marker="o", markersize=3, label=name or None)
            axes.set(xscale="log", xlabel="range [km]", ylabel="P_d", ylim=(-0.02, 1.02))
    if polar:
        axes.set_title("range of detection [km] by bearing from the Sun", fontsize=10)
    if any(lines):
        axes.legend(fontsize=8, frameon=False)
    return figure


def study_report(title: str, cases: Sequence[DetectionCase], stopped: str | None) -> str:
    """Return the report as text.

    Parameters
    ----------
    title : str
        Title of the page.
    cases : sequence of DetectionCase
        Parameters and results.
    stopped : str, optional
        Reason why some cases are missing.
    """
    good = [case for case in cases if case.error is None]
    remarks = [*([stopped] if stopped else []), *(case.error for case in cases if case.error is not None)]
    body = [f"<h1>{escape(title)}</h1>", f'<p class="facts">{len(good)} cases · seaglint {__version__}</p>']
    if remarks:
        body.append(notes(remarks))
    body.append(section("Results", _summary(good)))
    body += [
        section(f"Against {key}", figure(png(draw_sweep(rows, key)), key, "Bands: intervals of P_d."))
        for key, rows in _varied_numbers(good)
    ]
    body += [_case(case) for case in good]
    results = [None if case.judged is None else case.judged.result for case in cases]
    body.append(
        all_numbers([{"parameters": case.parameters, "result": got, "error": case.error} for case, got in zip(cases, results, strict=True)])
    )
    return page(title, body)


def _named(case: DetectionCase) -> str:
    return case.named or "the whole"


def _unit(result: JsonObject) -> str:
    """Return the unit of a result's contrasts; for a recording the unit of its values."""
    return str(result.get("contrast_unit") or result["units"] or "")


def _of_seas(row: TableRow, name: str) -> list[Any]:
    """Return the ends of a rate over drawn seas."""
    return [row.get(f"{name}_sea_unknown_low"), row.get(f"{name}_sea_unknown_high")]


def _summary(good: Sequence[DetectionCase]) -> str:
    head = ["case", "detector", "contrast", "unit", "P_d", "interval", "P_fa", "interval", "for P_d 0.9", "loss [dB]", "seas", "stopped by"]
    drawn = any("sea_draws" in case.done.result for case in good)
    # Beside the intervals of counting, where seas between the campaigns were drawn.
    head += ["sea unknown: P_d", "sea unknown: P_fa", "seas between the campaigns"] if drawn else []
    lines = []
    for case in good:
        result = case.done.result
        design = result.get("design") or {}
        for row in case.done.rows:
            line = [
                _named(case),
                result["detector"],
                number(row["contrast"]),
                _unit(result),
                number(row["p_d"]),
                interval([row["p_d_low"], row["p_d_high"]]),
                number(row["p_fa"]),
                interval([row["p_fa_low"], row["p_fa_high"]]),
                number(design.get("contrast")),
                number(design.get("loss_db")),
                number(result.get("seas")),
                result.get("stopped") or "",
            ]
            if drawn:
                line += [interval(_of_seas(row, "p_d")), interval(_of_seas(row, "p_fa")), number(row.get("sea_draws"))]
            lines.append(line)
    return table(head, lines, words=(0,))


def _varied_numbers(good: Sequence[DetectionCase]) -> list[tuple[str, list[TableRow]]]:
    """Return the varied numbers, with rows named by the other varied keys."""
    out = []
    for key in dict.fromkeys(key for case in good for key in case.parameters):
        values = [case.parameters.get(key) for case in good]
        if len({str(v) for v in values}) < 2 or not all(isinstance(v, int | float) and not isinstance(v, bool) for v in values):
            continue
        rows = []
        for case in good:
            others = ", ".join(f"{k} = {v}" for k, v in case.parameters.items() if k != key)
            for row in case.done.rows:
                line = f"{row['contrast']:g} {_unit(case.done.result)}" + (f", {others}" if others else "")
                rows.append({**row, key: case.parameters[key], "_line": line})
        out.append((key, rows))
    return out


def _case(case: DetectionCase) -> str:
    judged, result = case.done, case.done.result
    scattered = "independent seas" if "seas" in result else "tiles and times"
    pictures = [
        figure(
            png(draw_characteristic(judged.roc, judged.rows, _unit(result))),
            "operating characteristic",
            f"Bands: intervals of each rate alone, from the scatter between {scattered}.",
        ),
        figure(png(draw_map(judged.map)), "false alarms over the field", "Share of pixels above the threshold, in tiles."),
    ]
    chips = draw_chips(judged.chips, result["threshold_sigma"])
    if chips is not None:
        caption = "Missed objects (they are in the middle), the nearest and the farthest from the threshold, and the highest false alarms."
        pictures.append(figure(png(chips), "misses and false alarms", caption))
    return section(_named(case), *pictures, bullets(result["notes"]))
