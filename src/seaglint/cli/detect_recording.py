"""``seaglint detect recording``: a detector judged on frames that are there, or several settings of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from seaglint.cli.terminal.numbers import between

if TYPE_CHECKING:
    from seaglint.base.free_form import JsonObject
    from seaglint.cli.terminal.run_options import ResultOptions, RunOptions
    from seaglint.studies.detect.requests import RecordingRequest
    from seaglint.studies.detect.study import Study


def detect_recording(request: RecordingRequest, results: ResultOptions, run: RunOptions, *, every_tail: bool = False) -> None:
    """Evaluate a detector on a recording and write the results; ``every_tail`` prints rates that are not to be believed too.

    Raises
    ------
    DataError
        What the study refuses.
    """
    from seaglint.base.absent_numbers import absent_numbers
    from seaglint.base.errors import DataError
    from seaglint.cli.terminal.messages import log, print_json, tell
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.files.outputs import refuse_existing
    from seaglint.files.tables.detection_tables import DetectionFiles
    from seaglint.studies.detect.recordings import run_recording, settings_of
    from seaglint.studies.detect.unstated import options_of

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
        _write(study, result, files, single=not o.vary)
        log(f"{', '.join(str(path) for path in files.paths)} written")
    if results.report is not None:
        from seaglint.files.text_file import write_text
        from seaglint.plot.detection_report import study_report

        write_text(study_report(f"Detection: {o.source}", study.cases, None), results.report)
        log(f"{results.report} written")
    if results.as_json:
        print_json(result)
    else:
        if o.contrast is None:
            tell(["contrasts of 0.5 to 16 standard deviations of the clutter, as none is stated; --contrast states others"])
        for case in study.good:
            tell([*([f"{case.named}:"] if case.named else []), *lines(case.done.result, every_tail=every_tail)])
    if study.errors:
        failed = "\n".join(study.errors)
        raise DataError(f"{failed}\n{len(study.errors)} of {len(study.cases)} cases failed{'; the others are written' if files else ''}")


def _write(study: Study, result: JsonObject, files: Any, *, single: bool) -> None:
    """All files; the picture is that of the first case."""
    import numpy as np

    from seaglint.files.outputs import moved_when_whole
    from seaglint.plot.detection_study import draw_characteristic

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
    from seaglint.files.recording.image_attributes import source_of

    if pixel_mrad is not None:
        if not 0 < pixel_mrad < 1000:
            raise DataError(f"--pixel-mrad {pixel_mrad:g}: give an angle above 0 and below 1000 mrad")
        return (degrees(1e-3 * pixel_mrad),) * 2
    source = source_of(Path(recording))
    return None if source is None or source.step is None else (degrees(source.step[1]), degrees(source.step[0]))


def lines(result: JsonObject, *, every_tail: bool = False) -> list[str]:
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
