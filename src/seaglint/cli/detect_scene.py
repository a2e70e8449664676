"""``seaglint detect scene`` and ``detect design``: rendered scenes, cases of them, and the contrast that an object needs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from seaglint.cli.terminal.numbers import between
from seaglint.cli.terminal.progress import ProgressMode

if TYPE_CHECKING:
    from seaglint.base.free_form import JsonObject
    from seaglint.cli.terminal.run_options import ResultOptions, RunOptions
    from seaglint.studies.detect.requests import SceneRequest
    from seaglint.studies.detect.study import Study


def detect_scene(request: SceneRequest, results: ResultOptions, run: RunOptions) -> None:
    """Evaluate a detector in rendered scenes and write the results.

    Raises
    ------
    DataError
        What the study refuses, or cases that failed, once the others are written.
    """
    from seaglint.base.absent_numbers import absent_numbers
    from seaglint.base.errors import DataError
    from seaglint.cli.terminal.logs import show_logs
    from seaglint.cli.terminal.messages import files_read, log, print_json, tell
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.files.detection_parts import parts_folder
    from seaglint.files.outputs import refuse_existing
    from seaglint.files.tables.detection_tables import DetectionFiles
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
            _write(study, result, files)
            log(f"{', '.join(str(p) for p in files.paths)} written")
        if results.report is not None:
            from seaglint.files.text_file import write_text
            from seaglint.plot.detection_report import study_report

            text = study_report(f"Detection: {path}", study.cases, study.stopped)
            write_text(text, results.report)
            log(f"{results.report} written")
        if kept and not study.unfinished:
            parts.remove()
    if results.as_json:
        print_json(result)
    else:
        tell(lines(study))
    if study.errors:
        failed = "\n".join(study.errors)
        where = "; what was computed is written" if files is not None else ""
        raise DataError(f"{failed}\n{len(study.errors)} of {len(study.cases)} cases failed{where}")


def _silent(text: str) -> None:
    pass


def _write(study: Study, result: JsonObject, files: Any) -> None:
    """All files of a study; pictures are those of the first case."""
    import numpy as np

    from seaglint.files.outputs import moved_when_whole
    from seaglint.plot.detection_study import draw_characteristic, draw_chips, draw_map

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


def lines(study: Study) -> list[str]:
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
