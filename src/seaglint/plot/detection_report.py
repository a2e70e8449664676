"""Report of a detection study: one HTML file with tables and pictures inside."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from seaglint.base.free_form import JsonObject, TableRow
from seaglint.files.detection_case import DetectionCase
from seaglint.plot.detection_study import draw_characteristic, draw_chips, draw_map, draw_sweep
from seaglint.plot.new_figure import png
from seaglint.plot.page import all_numbers, bullets, figure, interval, notes, number, page, section, table
from seaglint.version import __version__


def study_report(title: str, cases: Sequence[DetectionCase], stopped: str | None) -> str:
    """The report as text.

    Parameters
    ----------
    title : str
        What was judged.
    cases : sequence of DetectionCase
        What was set, and what came of it.
    stopped : str, optional
        Why some cases are missing.
    """
    good = [case for case in cases if case.error is None]
    remarks = [*([stopped] if stopped else []), *(case.error for case in cases if case.error is not None)]
    body = [f"<h1>{escape(title)}</h1>", f'<p class="facts">{len(good)} cases · seaglint {__version__}</p>']
    if remarks:
        body.append(notes(remarks))
    body.append(section("Results", _summary(good)))
    body += [section(f"Against {key}", figure(png(draw_sweep(rows, key)), key, "Bands: intervals of P_d.")) for key, rows in _swept(good)]
    for case in good:
        body.append(_case(case))
    results = [None if case.judged is None else case.judged.result for case in cases]
    numbers = [{"parameters": case.parameters, "result": got, "error": case.error} for case, got in zip(cases, results, strict=True)]
    body.append(all_numbers(numbers))
    return page(title, body)


def _named(case: DetectionCase) -> str:
    return case.named or "the whole"


def _unit(result: JsonObject) -> str:
    """Unit of a result's contrasts; of a recording that of its values."""
    return str(result.get("contrast_unit") or result["units"] or "")


def _summary(good: Sequence[DetectionCase]) -> str:
    head = ["case", "detector", "contrast", "unit", "P_d", "interval", "P_fa", "interval", "for P_d 0.9", "loss [dB]", "seas", "stopped by"]
    lines = []
    for case in good:
        result = case.done.result
        design = result.get("design") or {}
        for row in case.done.rows:
            lines.append(
                [
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
            )
    return table(head, lines, words=(0,))


def _swept(good: Sequence[DetectionCase]) -> list[tuple[str, list[TableRow]]]:
    """Numbers that were varied, with the rows told by what else was."""
    keys = list(dict.fromkeys(key for case in good for key in case.parameters))
    out = []
    for key in keys:
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
