"""``seaglint detect range``: how far an object of a scenario is detected."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from seaglint.cli.terminal.progress import ProgressMode

if TYPE_CHECKING:
    from seaglint.cli.terminal.run_options import ResultOptions, RunOptions
    from seaglint.files.detection_range import DetectionRange
    from seaglint.studies.detect.requests import RangeRequest


def detect_range(request: RangeRequest, results: ResultOptions, run: RunOptions) -> None:
    """Find the range up to which an object is detected, in each case and at each bearing, and write the results.

    Raises
    ------
    DataError
        What the study refuses.
    """
    from seaglint.base.absent_numbers import absent_numbers
    from seaglint.base.errors import DataError
    from seaglint.cli.terminal.logs import show_logs
    from seaglint.cli.terminal.messages import files_read, log, say_air
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.files.detection_parts import parts_folder
    from seaglint.files.outputs import refuse_existing
    from seaglint.files.tables.detection_tables import DetectionFiles
    from seaglint.studies.detect.range_cases import ranges_of
    from seaglint.studies.detect.varied_cases import cases_of
    from seaglint.studies.prepare.air_contrast import RANGES

    path = Path(request.source)
    request.scene_options()  # options that are not allowed are refused before anything is read
    show_logs(quiet=run.show is ProgressMode.NONE)
    cases = cases_of(path, vary=request.vary or (), table=request.cases, sensor=request.sensor)
    replace_all = run.overwrite or run.resume
    inputs = [*files_read(path, cases[0].scenario), *([request.cases] if request.cases else [])]
    files = None if results.output is None else DetectionFiles.at(results.output, overwrite=replace_all, inputs=inputs)
    if run.resume and files is None:
        raise DataError("--resume goes on with what is kept beside a result; give it with -o RESULT")
    base = None if files is None else files.result.with_suffix("")
    if base is not None:
        refuse_existing(base.with_name(f"{base.name}_range.png"), overwrite=replace_all, inputs=inputs)
    asked = request.range_options([item.name for item in cases[0].scenario.objects or ()])
    near, far = asked.limits
    say_air([case.scenario for case in cases], [at for at in RANGES if near <= at <= far] or asked.limits)
    with (
        parts_folder(base, resume=run.resume, overwrite=run.overwrite) as (parts, kept),
        absent_numbers(),
        patient_progress(run.show, "seas"),
    ):
        say = log if run.show is not ProgressMode.NONE else (lambda text: None)
        found = ranges_of(cases, request, parts, say=say)
        _show(found, results, files)
        if kept:
            parts.remove()


def _show(found: list[DetectionRange], results: ResultOptions, files: Any) -> None:
    """Write the files and print the ranges."""
    from seaglint.cli.terminal.messages import log, print_json
    from seaglint.files.outputs import moved_when_whole
    from seaglint.files.tables.rows import write_rows
    from seaglint.files.text_file import write_json
    from seaglint.plot.detection_study import draw_ranges
    from seaglint.studies.detect.detector_choice import choice_line

    result = {"ranges": [one.as_dict() for one in found]}
    if files is not None:
        write_json(result, files.result)
        write_rows([one.as_row() for one in found], files.table)
        with moved_when_whole(files.picture.with_name(files.picture.name.replace("_roc", "_range"))) as partial:
            draw_ranges(found).savefig(partial, dpi=120, format="png")
        log(f"{files.result}, {files.table} written")
    if results.as_json:
        print_json(result)
        return
    for one in found:
        place = "" if one.bearing_deg is None else f"{one.bearing_deg:g} deg from the Sun: "
        low, high = one.range_interval_m
        reached = one.note if one.range_m is None else f"detected with P_d {one.p_d:g} to {one.range_m:.0f} m ({low:.0f} to {high:.0f})"
        by = f" by {one.detector}" if one.range_m is not None and "detector" not in one.parameters else ""
        doubt = "; doubtful: its threshold is extrapolated" if one.range_m is not None and one.is_doubtful else ""
        typer.echo(f"{one.object}{', ' + one.named if one.named else ''}: {place}{reached}{by}{doubt}")
        if one.tried:
            typer.echo(f"  {choice_line([entry for entry in one.tried if entry.range_m == one.tried[-1].range_m], one.p_d)}")
        for warning in one.warnings:
            typer.echo(f"  note: {warning}")
