"""``seaglint detect recording``: a detector judged on frames that are there, or several settings of it.

``seaglint detect scene`` and ``detect design``: rendered scenes, cases of them, and the contrast that an object needs.

``seaglint detect range``: how far an object of a scenario is detected.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from seaglint.cli.terminal.messages import between
from seaglint.cli.terminal.progress import ProgressMode

if TYPE_CHECKING:
    from seaglint.base.free_form import JsonObject
    from seaglint.cli.terminal.record_options import ResultOptions, RunOptions
    from seaglint.store.detection_results import DetectionRange
    from seaglint.studies.detect.detection_requests import RangeRequest, RecordingRequest, SceneRequest
    from seaglint.studies.detect.study import Study


def detect_recording(request: RecordingRequest, results: ResultOptions, run: RunOptions, *, every_tail: bool = False) -> None:
    """Evaluate a detector on a recording and write the results; ``every_tail`` prints rates that are not to be believed too.

    Raises
    ------
    DataError
        What the study refuses.
    """
    from seaglint.base.errors import DataError
    from seaglint.base.reports import absent_numbers
    from seaglint.cli.terminal.messages import log, print_json, tell
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.formats.tables.result_tables import DetectionFiles
    from seaglint.store.outputs import refuse_existing
    from seaglint.studies.detect.recordings import options_of, run_recording, settings_of

    o = request
    inputs: list[str | Path] = [o.source, *o.files]
    files = None if results.output is None else DetectionFiles.at(results.output, overwrite=run.overwrite, inputs=inputs)
    if results.report is not None:
        refuse_existing(results.report, overwrite=run.overwrite, inputs=inputs)
    settings = settings_of(o.vary or ())
    opened = o.opened(o.source)
    with absent_numbers(), patient_progress(run.show, "frames and objects") as progress:
        judged = options_of(o, opened, _pixel(o.source, o.pixel_mrad))
        study = run_recording(opened, judged, settings, progress=progress)
    result = study.as_dict() if o.vary else study.good[0].done.result
    if files is not None:
        _write_recording(study, result, files, single=not o.vary)
        log(f"{', '.join(str(path) for path in files.paths)} written")
    if results.report is not None:
        from seaglint.plot.detection_report import study_report
        from seaglint.store.outputs import write_text

        write_text(study_report(f"Detection: {o.source}", study.cases, None), results.report)
        log(f"{results.report} written")
    if results.as_json:
        print_json(result)
    else:
        if o.contrast is None:
            tell(["contrasts of 0.5 to 16 standard deviations of the clutter, as none is stated; --contrast states others"])
        for case in study.good:
            tell([*([f"{case.named}:"] if case.named else []), *recording_lines(case.done.result, every_tail=every_tail)])
    if study.errors:
        failed = "\n".join(study.errors)
        raise DataError(f"{failed}\n{len(study.errors)} of {len(study.cases)} cases failed{'; the others are written' if files else ''}")


def _write_recording(study: Study, result: JsonObject, files: Any, *, single: bool) -> None:
    """All files; the picture is that of the first case."""
    import numpy as np

    from seaglint.plot.detection_report import draw_characteristic
    from seaglint.store.outputs import moved_when_whole

    first = study.good[0].done
    columns = {name: np.asarray(values, float) for name, values in study.characteristic().items()}
    if single:
        columns.pop("case")

    def draw(path: Path) -> None:
        with moved_when_whole(path) as partial:
            draw_characteristic(first.roc, first.rows, first.result["units"] or "").savefig(partial, dpi=120, format="png")

    rows = first.rows if single else study.rows()
    files.write(result, rows, columns, draw)


def _pixel(recording: str, pixel_mrad: float | None) -> tuple[float, float] | None:
    """Angle between rows and between columns [deg], as far as it is known."""
    from math import degrees

    from seaglint.base.errors import DataError
    from seaglint.formats.recording.labelled_arrays import source_of

    if pixel_mrad is not None:
        if not 0 < pixel_mrad < 1000:
            raise DataError(f"--pixel-mrad {pixel_mrad:g}: give an angle above 0 and below 1000 mrad")
        return (degrees(1e-3 * pixel_mrad),) * 2
    source = source_of(Path(recording))
    return None if source is None or source.step is None else (degrees(source.step[1]), degrees(source.step[0]))


def recording_lines(result: JsonObject, *, every_tail: bool = False) -> list[str]:
    """The result as a few lines of text; extrapolated rates that are not to be believed where they are asked for."""
    unit = f" {result['units']}" if result["units"] else ""
    out = [
        f"{result['source']}: {_frames(result['frames'])} of {result['columns']} x {result['rows']}, detector {result['detector']}, "
        f"filter {result['filter']}, threshold {result['threshold_sigma']:.4g} sigma above the mean",
        f"P_fa {result['p_fa']:.4g} per pixel and frame{between(result['p_fa_interval'])}, "
        f"{result['false_alarms']['events_per_frame']:.4g} events a frame",
    ]
    for entry in result["sweep"]:
        error = entry["pointing_error"]
        place = (
            f"; error of place x {error['column']['std_px']:.3g}, y {error['row']['std_px']:.3g} px"
            if error["row"]["std_px"] is not None
            else ""
        )
        out.append(
            f"contrast {entry['contrast']:g}{unit}: P_d {entry['p_d']:.4g}{between(entry['p_d_interval'])} of {entry['injections']}{place}"
        )
    for rare in result["tail"]["rare"]:
        if not (rare["believed"] or every_tail):
            continue
        doubt = "" if rare["believed"] else ", unreliable"
        out.append(
            f"P_fa {rare['p_fa']:.1g} at {rare['threshold_sigma']:.4g} sigma{between(rare['p_fa_interval'])}, by extrapolation{doubt}"
        )
    if result["tail"]["note"]:
        out.append(f"tail: {result['tail']['note']}")
    return [*out, *(f"note: {note}" for note in result["notes"])]


def _frames(count: int) -> str:
    return f"{count} frame{'s' * (count != 1)}"


def detect_scene(request: SceneRequest, results: ResultOptions, run: RunOptions) -> None:
    """Evaluate a detector in rendered scenes and write the results.

    Raises
    ------
    DataError
        What the study refuses, or cases that failed, once the others are written.
    """
    from seaglint.base.errors import DataError
    from seaglint.base.reports import absent_numbers
    from seaglint.cli.terminal.messages import files_read, log, print_json, show_logs, tell
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.formats.tables.result_tables import DetectionFiles
    from seaglint.store.detection_results import parts_folder
    from seaglint.store.outputs import refuse_existing
    from seaglint.studies.detect.study import run_study
    from seaglint.studies.detect.varied_cases import cases_of

    o, path = request, Path(request.source)
    if results.output is None and (run.dask is not None or run.dask_slurm is not None):
        raise DataError("workers on other machines keep frames beside the result; give -o RESULT in a folder that they see too")
    wanted = o.scene_options()
    show_logs(quiet=run.show is ProgressMode.NONE)
    cases = cases_of(path, vary=o.vary or (), table=o.cases, sensor=o.sensor)
    replace_all = run.overwrite or run.resume
    inputs = [*files_read(path, cases[0].scenario), *([o.cases] if o.cases else [])]
    files = None if results.output is None else DetectionFiles.at(results.output, overwrite=replace_all, inputs=inputs)
    if run.resume and files is None:
        raise DataError("--resume goes on with what is kept beside a result; give it with -o RESULT")
    if results.report is not None:
        refuse_existing(results.report, overwrite=replace_all, inputs=inputs)
    base = None if files is None else files.result.with_suffix("")
    if base is not None:
        for name in ("map", "chips"):
            refuse_existing(base.with_name(f"{base.name}_{name}.png"), overwrite=replace_all, inputs=inputs)
    with parts_folder(base, resume=run.resume, overwrite=run.overwrite) as (parts, kept):
        with absent_numbers(), patient_progress(run.show, "seas") as progress:
            say = log if run.show is not ProgressMode.NONE else (lambda text: None)
            told = say if len(cases) > 1 else _silent
            with run.chosen() as workers:
                study = run_study(cases, wanted, parts, budget=o.time_budget, progress=progress, say=told, workers=workers)
        result = {"source": str(path), **study.as_dict(), "scenario_file": str(path)}
        if files is not None:
            _write_study(study, result, files)
            log(f"{', '.join(str(p) for p in files.paths)} written")
        if results.report is not None:
            from seaglint.plot.detection_report import study_report
            from seaglint.store.outputs import write_text

            text = study_report(f"Detection: {path}", study.cases, study.stopped)
            write_text(text, results.report)
            log(f"{results.report} written")
        if kept and not study.unfinished:
            parts.remove()
    if results.as_json:
        print_json(result)
    else:
        tell(study_lines(study))
    if study.errors:
        failed = "\n".join(study.errors)
        where = "; what was computed is written" if files is not None else ""
        raise DataError(f"{failed}\n{len(study.errors)} of {len(study.cases)} cases failed{where}")


def _silent(text: str) -> None:
    pass


def _write_study(study: Study, result: JsonObject, files: Any) -> None:
    """All files of a study; pictures are those of the first case."""
    import numpy as np

    from seaglint.plot.detection_report import draw_characteristic, draw_chips, draw_map
    from seaglint.store.outputs import moved_when_whole

    first = study.good[0].done

    def draw(path: Path) -> None:
        with moved_when_whole(path) as partial:
            draw_characteristic(first.roc, first.rows, first.result["contrast_unit"]).savefig(partial, dpi=120, format="png")

    columns = {name: np.asarray(values, float) for name, values in study.characteristic().items()}
    files.write(result, study.rows(), columns, draw)
    base = files.result.with_suffix("")
    pictures = {"map": draw_map(first.map), "chips": draw_chips(first.chips, first.result["threshold_sigma"])}
    for name, figure in pictures.items():
        if figure is not None:
            with moved_when_whole(base.with_name(f"{base.name}_{name}.png")) as partial:
                figure.savefig(partial, dpi=120, format="png")


def study_lines(study: Study) -> list[str]:
    """The result as lines of text."""
    out = []
    for case in study.good:
        result, named = case.done.result, case.named
        out.append(
            f"{named + ': ' if named else ''}{result['frames']} frames of {result['seas']} seas, {result['columns']} x {result['rows']}, "
            f"detector {result['detector']}, threshold {result['threshold_sigma']:.4g} sigma"
        )
        out.append(f"  P_fa {result['p_fa']:.4g} per pixel and frame{between(result['p_fa_interval'])}")
        for row in result["sweep"]:
            out.append(
                f"  contrast {row['contrast']:g} {row['contrast_unit']}: P_d {row['p_d']:.4g}{between(row['p_d_interval'])} "
                f"of {row['injections']}"
            )
        design = result.get("design")
        if design is not None and design.get("contrast") is not None:
            loss = "" if design["loss_db"] is None else f", {design['loss_db']:+.1f} dB against white noise"
            doubt = "" if design["believed"] else "; its threshold is extrapolated from too few false alarms"
            out.append(
                f"  P_d {design['p_d']:g} at P_fa {design['p_fa']:.2g} ({design['threshold_sigma']:.3g} sigma) needs contrast "
                f"{design['contrast']:.4g} {design['contrast_unit']}{loss}{doubt}"
            )
        elif design is not None:
            out.append(f"  design: {design['note']}")
        out += [f"  note: {note}" for note in result["notes"]]
    return out + ([study.stopped] if study.stopped else [])


def detect_range(request: RangeRequest, results: ResultOptions, run: RunOptions) -> None:
    """Find the range up to which an object is detected, in each case and at each bearing, and write the results.

    Raises
    ------
    DataError
        What the study refuses.
    """
    from seaglint.base.errors import DataError
    from seaglint.base.reports import absent_numbers
    from seaglint.cli.terminal.messages import files_read, log, say_air, show_logs
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.formats.tables.result_tables import DetectionFiles
    from seaglint.store.detection_results import parts_folder
    from seaglint.store.outputs import refuse_existing
    from seaglint.studies.detect.study import ranges_of
    from seaglint.studies.detect.varied_cases import cases_of
    from seaglint.studies.mean.air_contrast import RANGES

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
    from seaglint.formats.tables.table_text import write_rows
    from seaglint.plot.detection_report import draw_ranges
    from seaglint.store.outputs import moved_when_whole, write_json
    from seaglint.studies.detect.designer import choice_line

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
