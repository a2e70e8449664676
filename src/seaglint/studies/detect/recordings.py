"""Detection on a recording, with one setting of the detector or several, told as cases of a study."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from seaglint.analysis import Recording
from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, SeaglintError
from seaglint.base.free_form import TomlTables
from seaglint.files.detection_case import DetectionCase, Judged
from seaglint.scenario.text.vary_text import parse_vary
from seaglint.studies.detect.chips import characteristic, chips, false_alarm_map
from seaglint.studies.detect.performance import DetectionOptions, Performance, detect
from seaglint.studies.detect.study import Study, with_settings
from seaglint.studies.detect.varied_cases import STUDY_KEYS


def settings_of(vary: Sequence[str] | Mapping[str, Sequence[Any]]) -> list[TomlTables]:
    """Every combination of some settings; one without any where nothing is varied.

    Raises
    ------
    DataError
        A key that is no setting of the detector: the sea of a recording is what it is.

    Examples
    --------
    >>> settings_of(["detector=log,matched", "threshold=3"])
    [{'detector': 'log', 'threshold': 3}, {'detector': 'matched', 'threshold': 3}]
    """
    found = [(key, list(values)) for key, values in vary.items()] if isinstance(vary, Mapping) else parse_vary(vary)
    for key, _ in found:
        if key not in STUDY_KEYS:
            raise DataError(f"vary = {key}: of a recording {', '.join(STUDY_KEYS)} may be varied; give one of them, or SCENARIO.toml")
    keys = [key for key, _ in found]
    return [dict(zip(keys, values, strict=True)) for values in itertools.product(*(values for _, values in found))]


def run_recording(
    source: Recording, options: DetectionOptions, settings: Sequence[TomlTables], *, progress: Progress | None = None
) -> Study:
    """Judge a detector on a recording with each of some settings; what fails with one is not lost to the others.

    Parameters
    ----------
    source : Recording
        Frames without objects.
    options : DetectionOptions
        Detector and objects.
    settings : sequence of dict
        Of each case, see :func:`settings_of`.
    progress : callable, optional
        Called with (steps done, steps in all).

    Raises
    ------
    SeaglintError
        What fails with every setting.
    """
    cases: list[DetectionCase] = []
    for number, setting in enumerate(settings):
        case = DetectionCase(setting)
        try:
            found = detect(source, with_settings(options, setting), name=source.source, progress=_shown(progress, number, len(settings)))
            cases.append(replace(case, judged=judged_of(found, source)))
        except SeaglintError as error:
            if len(settings) == 1:
                raise
            cases.append(case.with_error(f"case {number}: {error}"))
    if all(case.error for case in cases):
        raise DataError("\n".join(str(case.error) for case in cases))
    return Study(cases, None, unfinished=False)


def judged_of(found: Performance, source: Recording) -> Judged:
    """Return the numbers of a judged recording, as :func:`seaglint.studies.detect.rendered_seas.run_scene` gives that of a scene."""
    result = found.as_dict() | {"units": source.units, "frame_rate_hz": source.frame_rate}
    result["cases"] = [
        {key: entry[key] for key in ("contrast", "p_d", "p_d_interval", "injections", "detected")} for entry in result["sweep"]
    ]
    result["notes"] += list(source.notes)
    rows = found.rows()
    rows_px, columns_px = (np.arange(n, dtype=np.float64) for n in found.size[1:])
    alarms = false_alarm_map(found, *np.meshgrid(columns_px, rows_px))
    return Judged(result, rows, characteristic(found, [row["contrast"] for row in rows]), alarms, chips(found, source), None)


def _shown(progress: Progress | None, number: int, cases: int) -> Progress | None:
    return None if progress is None else lambda done, whole: progress(number * whole + done, cases * whole)
