"""``seaglint detect SCENARIO.toml``: rendered scenes, cases of them, designer's figures and ranges."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from seaglint.cli.detect_options import OF_RECORDINGS, DetectOptions
from seaglint.cli.terminal.numbers import between, contrasts_of
from seaglint.cli.terminal.progress import ProgressMode

if TYPE_CHECKING:
    from seaglint.studies.detect.injected import Strength
    from seaglint.studies.detect.rendered_seas import SceneOptions
    from seaglint.studies.detect.study import Study
    from seaglint.studies.detect.varied_cases import StudyCase


def detect_scene(options: DetectOptions) -> None:
    """Judge a detector in rendered scenes and write what was asked for.

    Raises
    ------
    DataError
        Options of recordings, what the study refuses, or cases that failed, once the others are written.
    """
    import warnings

    from seaglint.base.errors import DataError
    from seaglint.cli.terminal.logs import show_logs
    from seaglint.cli.terminal.messages import files_read, log, print_json
    from seaglint.cli.terminal.progress import patient_progress
    from seaglint.cli.terminal.workers import chosen, done_here
    from seaglint.files.detection_parts import parts_folder
    from seaglint.files.outputs import refuse_existing
    from seaglint.files.tables.detection_tables import DetectionFiles
    from seaglint.studies.detect.study import run_study
    from seaglint.studies.detect.varied_cases import cases_of

    o, path = options, Path(options.recording)
    wrong = o.given(OF_RECORDINGS)
    if wrong:
        raise DataError(f"{', '.join(wrong)}: says something of a recording, which a scenario says itself; leave it out")
    if o.find_range:
        done_here(o.workers, o.dask, o.dask_slurm, "ranges are found")
    elif o.output is None and (o.dask is not None or o.dask_slurm is not None):
        raise DataError("workers on other machines keep frames beside the result; give -o RESULT in a folder that they see too")
    wanted = _wanted(o)
    show_logs(quiet=o.show is ProgressMode.NONE)
    cases = cases_of(path, vary=o.vary or (), table=o.cases, sensor=o.sensor_preset)
    replace_all = o.overwrite or o.resume
    inputs = [*files_read(path, cases[0].scenario), *([o.cases] if o.cases else [])]
    files = None if o.output is None else DetectionFiles.at(o.output, overwrite=replace_all, inputs=inputs)
    if o.resume and files is None:
        raise DataError("--resume goes on with what is kept beside a result; give it with -o RESULT")
    if o.report is not None:
        refuse_existing(o.report, overwrite=replace_all, inputs=inputs)
    base = None if files is None else files.result.with_suffix("")
    if base is not None:
        for name in ("range",) if o.find_range else ("map", "chips"):
            refuse_existing(base.with_name(f"{base.name}_{name}.png"), overwrite=replace_all, inputs=inputs)
    with parts_folder(base, resume=o.resume, overwrite=o.overwrite) as (parts, kept):
        with warnings.catch_warnings(), patient_progress(o.show, "seas") as progress:
            warnings.simplefilter("ignore", RuntimeWarning)
            say = log if o.show is not ProgressMode.NONE else (lambda text: None)
            if o.find_range:
                _ranges(cases, wanted, o, parts, files, say=say)
                if kept:
                    parts.remove()
                return
            told = say if len(cases) > 1 else _silent
            with chosen(o.workers, o.dask, o.dask_slurm) as workers:
                study = run_study(cases, wanted, parts, budget=o.time_budget, progress=progress, say=told, workers=workers)
        result = {"source": str(path), **study.as_dict(), "scenario_file": str(path)}
        if files is not None:
            _write(study, result, files)
            log(f"{', '.join(str(p) for p in files.paths)} written")
        if o.report is not None:
            from seaglint.files.text_file import write_text
            from seaglint.plot.detection_report import study_report

            text = study_report(f"Detection: {path}", study.cases, study.stopped)
            write_text(text, o.report)
            log(f"{o.report} written")
        if kept and not study.unfinished:
            parts.remove()
    if o.as_json:
        print_json(result)
    else:
        typer.echo("\n".join(lines(study)))
    if study.errors:
        failed = "\n".join(study.errors)
        where = "; what was computed is written" if files is not None else ""
        raise DataError(f"{failed}\n{len(study.errors)} of {len(study.cases)} cases failed{where}")


def _silent(text: str) -> None:
    pass


def _wanted(o: DetectOptions) -> SceneOptions:
    from seaglint.studies.detect.designer import Design
    from seaglint.studies.detect.rendered_seas import SceneOptions

    named = o.p_fa is not None or o.alarms_per_hour is not None or o.wanted_p_d is not None
    design = Design(o.wanted_p_d or 0.9, o.p_fa, o.alarms_per_hour or 1.0) if o.design or named else None
    shape = o.shape if o.shape_is_given else None
    judged, strength = o.judged(o.objects((1.0,))), _strength(o)
    return SceneOptions(judged, o.objects_are or "point", strength, shape, o.seas or 32, o.precision, o.precision_fa, design)


def _strength(o: DetectOptions) -> Strength | None:
    from seaglint.base.errors import DataError
    from seaglint.studies.detect.injected import Strength, Unit

    contrasts = o.contrasts
    given: dict[Unit, tuple[str, str | None]] = {
        "K": ("--temperature-difference", o.temperature_difference),
        "W/sr": ("--intensity", o.intensity),
    }
    stated = [unit for unit, (_, text) in given.items() if text is not None]
    if len(stated) + (contrasts is not None) > 1:
        raise DataError("--contrast, --temperature-difference and --intensity say the same of an object; give one of them")
    if not stated:
        return None if contrasts is None else Strength(contrasts)
    option, text = given[stated[0]]
    values = contrasts_of(text or "", option)
    if stated[0] == "W/sr" and (o.objects_are or "point") != "point":
        raise DataError(f"--intensity is that of a point, and --objects is {o.objects_are}; give --objects point")
    return Strength(values, stated[0], o.range_m, 5.0 if o.object_height_m is None else o.object_height_m)


def _write(study: Study, result: dict[str, Any], files: Any) -> None:
    """All files of a study; pictures are those of the first case."""
    import numpy as np

    from seaglint.files.outputs import moved_when_whole
    from seaglint.plot.detection_study import draw_characteristic, draw_chips, draw_map

    first = study.good[0]

    def draw(path: Path) -> None:
        with moved_when_whole(path) as partial:
            draw_characteristic(first["roc"], first["rows"], first["result"]["contrast_unit"]).savefig(partial, dpi=120, format="png")

    columns = {name: np.asarray(values, float) for name, values in study.characteristic().items()}
    files.write(result, study.rows(), columns, draw)
    base = files.result.with_suffix("")
    pictures = {"map": draw_map(first["map"]), "chips": draw_chips(first["chips"], first["result"]["threshold_sigma"])}
    for name, figure in pictures.items():
        if figure is not None:
            with moved_when_whole(base.with_name(f"{base.name}_{name}.png")) as partial:
                figure.savefig(partial, dpi=120, format="png")


def _ranges(cases: list[StudyCase], wanted: SceneOptions, o: DetectOptions, parts: Any, files: Any, *, say: Any) -> None:
    from seaglint.base.errors import DataError
    from seaglint.cli.terminal.messages import log, print_json
    from seaglint.files.outputs import moved_when_whole
    from seaglint.files.tables.rows import write_rows
    from seaglint.files.text_file import write_json
    from seaglint.plot.detection_study import draw_ranges
    from seaglint.studies.detect.designer import Design
    from seaglint.studies.detect.range_search import RangeOptions, detection_range
    from seaglint.studies.detect.study import with_case

    names = [item.name for item in cases[0].scenario.objects or ()]
    name = o.object_name or (names[0] if len(names) == 1 else None)
    if name is None:
        raise DataError(f"--range is that of an object; name one of the scenario's with --object: {', '.join(names) or 'it has none'}")
    limits = RangeOptions.limits if o.range_limits is None else _limits(o.range_limits)
    asked = RangeOptions(name, limits, wanted.design or Design())
    bearings: list[float | None] = [None] if o.bearings is None else list(contrasts_of(o.bearings, "--bearings"))
    found: list[dict[str, Any]] = []
    for case in cases:
        for bearing in bearings:
            one = detection_range(case.scenario, with_case(wanted, case), asked, parts, bearing_deg=bearing, say=say)
            found.append({"parameters": case.parameters, **one})
    result = {"ranges": found}
    if files is not None:
        rows = [
            {
                **one["parameters"],
                **{key: one[key] for key in ("object", "bearing_deg", "p_d", "range_m")},
                "range_low_m": one["range_interval_m"][0],
                "range_high_m": one["range_interval_m"][1],
                "note": one["note"],
            }
            for one in found
        ]
        write_json(result, files.result)
        write_rows(rows, files.table)
        with moved_when_whole(files.picture.with_name(files.picture.name.replace("_roc", "_range"))) as partial:
            draw_ranges(found).savefig(partial, dpi=120, format="png")
        log(f"{files.result}, {files.table} written")
    if o.as_json:
        print_json(result)
        return
    for one in found:
        named = ", ".join(f"{k} = {v}" for k, v in one["parameters"].items())
        place = "" if one["bearing_deg"] is None else f"{one['bearing_deg']:g} deg from the Sun: "
        low, high = one["range_interval_m"]
        told = (
            one["note"]
            if one["range_m"] is None
            else f"detected with P_d {one['p_d']:g} to {one['range_m']:.0f} m ({low:.0f} to {high:.0f})"
        )
        typer.echo(f"{one['object']}{', ' + named if named else ''}: {place}{told}")


def _limits(text: str) -> tuple[float, float]:
    from seaglint.base.errors import DataError

    try:
        near, far = (float(part) for part in text.split(":"))
    except ValueError:
        raise DataError(f"--range-limits {text}: give NEAR:FAR in metres, e.g. 500:40000") from None
    return near, far


def lines(study: Study) -> list[str]:
    """The result as lines of text."""
    out = []
    for case in study.good:
        result = case["result"]
        named = ", ".join(f"{key} = {value}" for key, value in case["parameters"].items())
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
            doubt = "" if design["believed"] else "; its threshold is not to be believed"
            out.append(
                f"  P_d {design['p_d']:g} at P_fa {design['p_fa']:.2g} ({design['threshold_sigma']:.3g} sigma) needs contrast "
                f"{design['contrast']:.4g} {design['contrast_unit']}{loss}{doubt}"
            )
        elif design is not None:
            out.append(f"  design: {design['note']}")
        out += [f"  note: {note}" for note in result["notes"]]
    return out + ([study.stopped] if study.stopped else [])
