"""Detection on a recording: settings that suit its clutter, and the cases of one setting of the detector or several.

Contrasts, detector and threshold that a request does not state are chosen from the clutter of the frames themselves.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seaglint.analysis import Recording
from seaglint.base.conventions import Progress
from seaglint.base.errors import DataError, SeaglintError
from seaglint.base.free_form import TomlTables
from seaglint.base.threads import single_threaded_algebra
from seaglint.detection.background import Background, count_false_alarms
from seaglint.scenario.text.option_texts import parse_vary
from seaglint.store.detection_results import DetectionCase, DetectorResult
from seaglint.studies.detect.injected import SWEEP
from seaglint.studies.detect.performance import (
    DetectionOptions,
    Performance,
    as_given,
    characteristic,
    chips,
    detect,
    detector_for,
    false_alarm_map,
)
from seaglint.studies.detect.study import Study, with_settings
from seaglint.studies.detect.varied_cases import STUDY_KEYS, with_names

if TYPE_CHECKING:
    from seaglint.studies.detect.detection_requests import SpotRequest


#: Detector where none is named: it takes the level off, and weighs by the covariance of each part of the frame.
SUITED: Final = "matched-local"

RATE: Final = 1e-4  #: Rate of false alarms per pixel where no threshold is stated, as far as the pixels support it.

FEWEST: Final = 20  #: Least number of exceedances by which a threshold is chosen.

_FRAMES: Final = 16  #: Number of frames from which the clutter's deviation is taken.


def options_of(request: SpotRequest, source: Recording, pixel_deg: tuple[float, float] | None = None) -> DetectionOptions:
    """Return the options for a recording: those of the request, and options that suit the recording where no contrast is stated.

    Raises
    ------
    DataError
        Frames without variation, or numbers that are not allowed.
    """
    if request.contrast is not None:
        return request.detection(request.contrast, source.frame_rate, pixel_deg)
    # Covariances of tiles need frames of at least one tile.
    named = request.detector or (SUITED if min(source.rows, source.columns) >= 64 else "log")
    sigma = clutter_deviation(source)
    suited = replace(request, detector=named)
    options = suited.detection(tuple(float(f"{factor * sigma:.3g}") for factor in SWEEP), source.frame_rate, pixel_deg)
    if request.threshold is not None or request.threshold_law != "sigma":
        return options
    return replace(options, threshold=threshold_of(source, options))


def clutter_deviation(source: Recording) -> float:
    """Return the standard deviation of all pixels of some frames [units of the recording].

    Raises
    ------
    DataError
        Frames that do not vary.
    """
    numbers = np.unique(np.linspace(0, source.frames - 1, min(source.frames, _FRAMES)).astype(int))
    sigma = float(np.nanstd(np.stack([source.read(int(n), int(n) + 1)[0] for n in numbers]).astype(np.float64)))
    if not (np.isfinite(sigma) and sigma > 0.0):
        raise DataError(f"{source.source}: its frames do not vary, so there is no clutter to choose contrasts by; state `contrast`")
    return sigma


def threshold_of(source: Recording, options: DetectionOptions) -> float:
    """Return the lowest threshold that leaves the usual rate of false alarms [standard deviations, three digits]."""
    given = as_given(source, options)
    with single_threaded_algebra():
        background = Background(detector_for(given, options), given)
        curve = count_false_alarms(background, background.threshold(options.threshold, "sigma"), options.level).alarms.curve()
    beyond = np.flatnonzero(curve.exceedances <= max(RATE * curve.pixels, FEWEST))
    threshold = float(curve.threshold[beyond[0]]) if beyond.size else options.threshold
    return float(f"{max(threshold, 1.0):.3g}")


def settings_of(vary: Sequence[str] | Mapping[str, Sequence[Any]]) -> list[TomlTables]:
    """Return every combination of some settings; a single empty one where nothing is varied.

    Raises
    ------
    DataError
        A key that is no setting of the detector: the sea of a recording cannot be varied.

    Examples
    --------
    >>> settings_of(["detector=log,matched", "threshold=3"])
    [{'detector': 'log', 'threshold': 3}, {'detector': 'matched', 'threshold': 3}]
    """
    varied = [(key, list(values)) for key, values in vary.items()] if isinstance(vary, Mapping) else parse_vary(vary)
    for key, _ in varied:
        if key not in STUDY_KEYS:
            raise DataError(f"vary = {key}: of a recording {', '.join(STUDY_KEYS)} may be varied; give one of them, or SCENARIO.toml")
    keys = [key for key, _ in varied]
    return [dict(zip(keys, values, strict=True)) for values in itertools.product(*(values for _, values in varied))]


def run_recording(
    source: Recording, options: DetectionOptions, settings: Sequence[TomlTables], *, progress: Progress | None = None
) -> Study:
    """Evaluate a detector on a recording with each of some settings; a setting that fails does not stop the others.

    Parameters
    ----------
    source : Recording
        Frames without objects.
    options : DetectionOptions
        Detector and objects.
    settings : sequence of dict
        Settings of each case, see ``settings_of``.
    progress : callable, optional
        Called with (steps done, steps in all).

    Raises
    ------
    SeaglintError
        An error with every setting.
    """
    cases: list[DetectionCase] = []
    for number, setting in enumerate(settings):
        case = DetectionCase(with_names(setting))
        try:
            shown = _shown(progress, number, len(settings))
            performance = detect(source, with_settings(options, setting), name=source.source, progress=shown)
            cases.append(replace(case, judged=judged_of(performance, source)))
        except SeaglintError as error:
            if len(settings) == 1:
                raise
            cases.append(case.with_error(f"case {number}: {error}"))
    if all(case.error for case in cases):
        raise DataError("\n".join(str(case.error) for case in cases))
    return Study(cases, None, unfinished=False)


def judged_of(performance: Performance, source: Recording) -> DetectorResult:
    """Return the results on a recording in the form in which ``seaglint.studies.detect.rendered_seas.run_scene`` returns them."""
    result = performance.as_dict() | {"units": source.units, "frame_rate_hz": source.frame_rate}
    result["cases"] = [
        {key: entry[key] for key in ("contrast", "p_d", "p_d_interval", "injections", "detected")} for entry in result["sweep"]
    ]
    result["notes"] += list(source.notes)
    rows = performance.rows()
    rows_px, columns_px = (np.arange(n, dtype=np.float64) for n in performance.size[1:])
    alarms = false_alarm_map(performance, *np.meshgrid(columns_px, rows_px))
    return DetectorResult(
        result, rows, characteristic(performance, [row["contrast"] for row in rows]), alarms, chips(performance, source), None
    )


def _shown(progress: Progress | None, number: int, cases: int) -> Progress | None:
    return None if progress is None else lambda done, whole: progress(number * whole + done, cases * whole)
