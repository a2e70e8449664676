"""Commands of ``seaglint detect``: what each runs, writes and prints.

``detect recording`` evaluates a detector, or several settings of it, on stored frames; ``detect scene`` and ``detect design`` in rendered
scenes; ``detect range`` computes how far an object of a scenario is detected.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import typer

from seaglint.cli.terminal.messages import between
from seaglint.cli.terminal.progress import ProgressMode

if TYPE_CHECKING:
    from seaglint.base.free_form import JsonObject
    from seaglint.cli.terminal.record_options import ResultOptions, RunOptions
    from seaglint.formats.tables.result_tables import DetectionFiles
    from seaglint.store.detection_results import DetectionRange, StudyParts
    from seaglint.studies.detect.detection_requests import CasesRequest, RangeRequest, RecordingRequest, SceneRequest
    from seaglint.studies.detect.study import Study
    from seaglint.studies.detect.varied_cases import StudyCase


def detect_recording(request: RecordingRequest, results: ResultOptions, run: RunOptions, *, every_tail: bool = False) -> None:
    """Evaluate a detector on a recording and write the results; ``every_tail`` prints unreliable rates too.

    Raises
    ------
    DataError
        Frames or numbers that the study refuses.
    """
    from seaglint.base.reports import absent_numbers
    from seaglint.cli.terminal.messages import print_json, print_lines
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.studies.detect.recordings import options_of, run_recording, settings_of

    inputs: list[str | Path] = [request.source, *request.files]
    files = _files(results, overwrite=run.overwrite, inputs=inputs)
    settings = settings_of(request.vary or ())
    opened = request.opened(request.source)
    with absent_numbers(), patient_progress(run.show, "frames and objects") as progress:
        options = options_of(request, opened, request.pixel_deg("--pixel-mrad ") or _pixel_of_file(request.source))
        study = run_recording(opened, options, settings, progress=progress)
    result = study.as_dict() if request.vary else study.good[0].done.result
    _write_study(study, result, files, results, f"Detection: {request.source}", single=not request.vary)
    if results.as_json:
        print_json(result)
    else:
        if request.contrast is None:
            print_lines(["contrasts of 0.5 to 16 standard deviations of the clutter, as none is stated; --contrast states others"])
        for case in study.good:
            print_lines([*([f"{case.named}:"] if case.named else []), *recording_lines(case.done.result, every_tail=every_tail)])
    _raise_errors(study, "; the others are written" if files else "")


def _files(results: ResultOptions, *, overwrite: bool, inputs: list[Any], pictures: tuple[str, ...] = ()) -> DetectionFiles | None:
    """Return the files of a result, refused before the work where they exist; None without ``-o``."""
    from seaglint.formats.tables.result_tables import DetectionFiles
    from seaglint.store.outputs import refuse_existing

    files = None if results.output is None else DetectionFiles.at(results.output, overwrite=overwrite, inputs=inputs)
    if results.report is not None:
        refuse_existing(results.report, overwrite=overwrite, inputs=inputs)
    if files is not None:
        for name in pictures:
            refuse_existing(_picture(files, name), overwrite=overwrite, inputs=inputs)
    return files


def _picture(files: DetectionFiles, name: str) -> Path:
    """Return the file of a further picture of a result."""
    base = files.result.with_suffix("")
    return base.with_name(f"{base.name}_{name}.png")


def _save(figure: Any, path: Path) -> None:
    """Write a picture, moved to its place when complete."""
    from seaglint.store.outputs import moved_when_whole

    with moved_when_whole(path) as partial:
        figure.savefig(partial, dpi=120, format="png")


def _write_study(
    study: Study, result: JsonObject, files: DetectionFiles | None, results: ResultOptions, title: str, *, single: bool = False
) -> None:
    """Write the files and the report of a study; pictures show the first case. A ``single`` case has no column of cases."""
    import numpy as np

    from seaglint.cli.terminal.messages import log
    from seaglint.plot.detection_report import draw_characteristic, draw_chips, draw_map, study_report
    from seaglint.store.outputs import write_text

    if files is not None:
        first = study.good[0].done
        unit = str(first.result.get("contrast_unit") or first.result["units"] or "")
        columns = {name: np.asarray(values, float) for name, values in study.characteristic().items() if not (single and name == "case")}
        rows = first.rows if single else study.rows()
        files.write(result, rows, columns, lambda path: _save(draw_characteristic(first.roc, first.rows, unit), path))
        if "seas" in first.result:  # of a recording the report alone has these pictures
            _save(draw_map(first.map), _picture(files, "map"))
            chips = draw_chips(first.chips, first.result["threshold_sigma"])
            if chips is not None:
                _save(chips, _picture(files, "chips"))
        log(f"{', '.join(str(path) for path in files.paths)} written")
    if results.report is not None:
        write_text(study_report(title, study.cases, study.stopped), results.report)
        log(f"{results.report} written")


def _raise_errors(study: Study, written: str) -> None:
    """Raise the errors of the cases that failed, once the results of the others are written and printed.

    Raises
    ------
    DataError
        The messages of all of them.
    """
    from seaglint.base.errors import DataError

    if study.errors:
        failed = "\n".join(study.errors)
        raise DataError(f"{failed}\n{len(study.errors)} of {len(study.cases)} cases failed{written}")


def _pixel_of_file(recording: str) -> tuple[float, float] | None:
    """Return the angle between rows and between columns that a file states [deg]; None where it states none."""
    from math import degrees

    from seaglint.formats.recording.labelled_arrays import source_of

    source = source_of(Path(recording))
    return None if source is None or source.step is None else (degrees(source.step[1]), degrees(source.step[0]))


def recording_lines(result: JsonObject, *, every_tail: bool = False) -> list[str]:
    """Return a result as a few lines of text; with ``every_tail`` also the unreliable extrapolated rates."""
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


class _Scenes(NamedTuple):
    """Cases of a scenario, and the places of their results."""

    cases: list[StudyCase]
    files: DetectionFiles | None
    parts: StudyParts
    report: Callable[[str], None]  #: Prints a line on the progress.


@contextmanager
def _scenes(
    request: CasesRequest,
    results: ResultOptions,
    run: RunOptions,
    pictures: tuple[str, ...],
    check: Callable[[list[StudyCase]], None] = lambda cases: None,
) -> Iterator[_Scenes]:
    """Check a request and its outputs, read the cases and open the folder of an unfinished study.

    ``check`` refuses cases that the command cannot use. It runs before the folder is opened: --overwrite empties the folder.

    Raises
    ------
    DataError
        Outputs that may not be replaced, or a resumed study without a result.
    """
    from seaglint.base.errors import DataError
    from seaglint.base.reports import absent_numbers
    from seaglint.cli.terminal.messages import files_read, log, show_logs
    from seaglint.store.detection_results import parts_folder
    from seaglint.studies.detect.varied_cases import cases_of

    path = Path(request.source)
    # Options that are not allowed are refused before anything is read.
    request.require_valid()
    show_logs(quiet=run.show is ProgressMode.NONE)
    cases = cases_of(path, vary=request.vary or (), table=request.cases, sensor=request.sensor)
    replace_all = run.overwrite or run.resume
    inputs = [*files_read(path, cases[0].scenario), *([request.cases] if request.cases else [])]
    files = _files(results, overwrite=replace_all, inputs=inputs, pictures=pictures)
    if run.resume and files is None:
        raise DataError("--resume goes on with what is kept beside a result; give it with -o RESULT")
    base = None if files is None else files.result.with_suffix("")
    check(cases)
    with parts_folder(base, resume=run.resume, overwrite=run.overwrite) as (parts, _), absent_numbers():
        yield _Scenes(cases, files, parts, log if run.show is not ProgressMode.NONE else _silent)


def detect_scene(request: SceneRequest, results: ResultOptions, run: RunOptions) -> None:
    """Evaluate a detector in rendered scenes and write the results.

    Raises
    ------
    DataError
        A request that the study refuses, or cases that failed, once the others are written.
    """
    from seaglint.cli.terminal.messages import print_json, print_lines
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.studies.detect.study import run_study

    _require_shared(results, run)
    source = str(Path(request.source))
    with _scenes(request, results, run, ("map", "chips")) as scenes:
        with patient_progress(run.show, "seas") as progress, run.chosen() as workers:
            report = scenes.report if len(scenes.cases) > 1 else _silent
            study = run_study(scenes.cases, request, scenes.parts, progress=progress, report=report, workers=workers)
        result = {"source": source, **study.as_dict(), "scenario_file": source}
        _write_study(study, result, scenes.files, results, f"Detection: {source}")
        if scenes.files is not None and not study.unfinished:
            scenes.parts.remove()
    if results.as_json:
        print_json(result)
    else:
        print_lines(study_lines(study))
    _raise_errors(study, "; what was computed is written" if scenes.files is not None else "")


def _require_shared(results: ResultOptions, run: RunOptions) -> None:
    """Refuse workers on other machines without a result beside which frames are stored.

    Raises
    ------
    DataError
        Such workers, and no result.
    """
    from seaglint.base.errors import DataError

    if results.output is None and (run.dask is not None or run.dask_slurm is not None):
        raise DataError("workers on other machines keep frames beside the result; give -o RESULT in a folder that they see too")


def _silent(text: str) -> None:
    pass


def _unknown(result: JsonObject, name: str) -> str:
    """Return the interval of a number over drawn seas in words; empty without one."""
    from seaglint.studies.sea_draws import COUNT, HIGH, LOW, sea_line

    low, high = result.get(f"{name}_{LOW}"), result.get(f"{name}_{HIGH}")
    return "" if low is None or high is None else f"; {sea_line(low, high, result[COUNT], value=result.get(name))}"


def study_lines(study: Study) -> list[str]:
    """Return the results of a study as lines of text."""
    out = []
    for case in study.good:
        result, named = case.done.result, case.named
        out.append(
            f"{named + ': ' if named else ''}{result['frames']} frames of {result['seas']} seas, {result['columns']} x {result['rows']}, "
            f"detector {result['detector']}, threshold {result['threshold_sigma']:.4g} sigma"
        )
        out.append(f"  P_fa {result['p_fa']:.4g} per pixel and frame{between(result['p_fa_interval'])}{_unknown(result, 'p_fa')}")
        for row in result["sweep"]:
            out.append(
                f"  contrast {row['contrast']:g} {row['contrast_unit']}: P_d {row['p_d']:.4g}{between(row['p_d_interval'])} "
                f"of {row['injections']}{_unknown(row, 'p_d')}"
            )
        design = result.get("design")
        if design is not None and design.get("contrast") is not None:
            loss = "" if design["loss_db"] is None else f", {design['loss_db']:+.1f} dB against white noise"
            doubt = "" if design["believed"] else "; its threshold is extrapolated from too few false alarms"
            out.append(
                f"  P_d {design['p_d']:g} at P_fa {design['p_fa']:.2g} ({design['threshold_sigma']:.3g} sigma) needs contrast "
                f"{design['contrast']:.4g} {design['contrast_unit']}{loss}{doubt}{_unknown({**result, **design}, 'contrast')}"
            )
        elif design is not None:
            out.append(f"  design: {design['note']}")
        out += [f"  note: {note}" for note in result["notes"]]
    return out + ([study.stopped] if study.stopped else [])


def detect_range(request: RangeRequest, results: ResultOptions, run: RunOptions) -> None:
    """Compute the range up to which an object is detected, in each case and at each bearing, and write the results.

    Raises
    ------
    DataError
        A request that the study refuses.
    """
    from seaglint.cli.terminal.messages import print_air
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.studies.detect.study import ranges_of
    from seaglint.studies.mean.air_contrast import RANGES

    _require_shared(results, run)

    def check(cases: list[StudyCase]) -> None:
        near, far = request.of_objects([item.name for item in cases[0].scenario.objects or ()]).limits
        print_air([case.scenario for case in cases], [at for at in RANGES if near <= at <= far] or (near, far))

    with _scenes(request, results, run, ("range",), check) as scenes:
        with patient_progress(run.show, "ranges") as progress, run.chosen() as workers:
            found = ranges_of(scenes.cases, request, scenes.parts, progress=progress, report=scenes.report, workers=workers)
        _show(found, results, scenes.files)
        if scenes.files is not None:
            scenes.parts.remove()


def _show(ranges: list[DetectionRange], results: ResultOptions, files: DetectionFiles | None) -> None:
    """Write the files of some ranges and print them."""
    from seaglint.cli.terminal.messages import log, print_json
    from seaglint.formats.tables.table_text import write_rows
    from seaglint.plot.detection_report import draw_ranges
    from seaglint.store.outputs import write_json
    from seaglint.studies.detect.designer import choice_line

    result = {"ranges": [one.as_dict() for one in ranges]}
    if files is not None:
        write_json(result, files.result)
        write_rows([one.as_row() for one in ranges], files.table)
        _save(draw_ranges(ranges), files.picture.with_name(files.picture.name.replace("_roc", "_range")))
        log(f"{files.result}, {files.table} written")
    if results.as_json:
        print_json(result)
        return
    for one in ranges:
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
