"""Functions of detectors in rendered scenes of a scenario, and how far an object of one is detected."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from seaglint.api.inputs import request_of, scenario_of, team_of
from seaglint.api.judged_study import judged_record, numbers_of
from seaglint.api.result_record import ResultRecord
from seaglint.base.absent_numbers import absent_numbers
from seaglint.base.parameters import documented
from seaglint.studies.detect.requests import DesignRequest, RangeRequest, SceneRequest

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike

    from seaglint.api.inputs import SceneInput
    from seaglint.base.conventions import Progress
    from seaglint.cluster import Workers
    from seaglint.studies.detect.varied_cases import StudyCase


@documented(SceneRequest)
def detect_scene(
    source: SceneInput,
    *,
    detector: str | None = None,
    filter: str = "none",
    kernel: ArrayLike | None = None,
    signature: ArrayLike | None = None,
    threshold: float | None = None,
    threshold_law: Literal["sigma", "frame", "fixed", "design"] = "sigma",
    time_limit: float = 60.0,
    level: float = 0.95,
    injections: int = 2000,
    placement: Literal["random", "centre"] = "random",
    match_radius: float = 1.0,
    velocity: tuple[float, float] = (0.0, 0.0),
    duration: int = 0,
    pointing: Literal["least-squares", "centroid"] = "least-squares",
    seed: int = 0,
    contrast: float | Sequence[float] | None = None,
    object_sigma_px: float | None = None,
    psf: ArrayLike | None = None,
    frames: int | None = None,
    vary: Mapping[str, Sequence[Any]] | Sequence[str] = (),
    cases: str | Path | None = None,
    sensor: str | None = None,
    objects: str | None = None,
    temperature_difference: float | Sequence[float] | None = None,
    intensity: float | Sequence[float] | None = None,
    range_m: float | None = None,
    object_height_m: float | None = None,
    precision: float | None = None,
    precision_fa: float | None = None,
    time_budget: float | None = None,
    workers: int | Workers | None = None,
    progress: Progress | None = None,
) -> ResultRecord:
    """Detection in independent rendered seas of a scenario.

    Parameters
    ----------
    {request}
    workers : int or Workers, optional
        Processes on this machine that share the work, or workers as :func:`seaglint.cluster.dask.connected` gives them.
    progress : callable, optional
        Called with (seas done, seas in all).

    Returns
    -------
    ResultRecord
        Values that ``seaglint detect scene --json`` prints; ``plot()`` draws the operating characteristic of the first case.

    Raises
    ------
    SeaglintError
        A scenario or numbers that are not allowed, or cases that all failed.

    Examples
    --------
    >>> import seaglint as sg
    >>> sg.detect_scene("my.toml", contrast=[0.01, 0.1], frames=8)  # doctest: +SKIP
    """
    request = request_of(SceneRequest, locals(), **_of_scene(locals()))
    return _study(source, request, vary, cases, workers, progress)


@documented(DesignRequest)
def detect_design(
    source: SceneInput,
    *,
    detector: str | None = None,
    filter: str = "none",
    kernel: ArrayLike | None = None,
    signature: ArrayLike | None = None,
    threshold: float | None = None,
    threshold_law: Literal["sigma", "frame", "fixed", "design"] = "sigma",
    time_limit: float = 60.0,
    level: float = 0.95,
    injections: int = 2000,
    placement: Literal["random", "centre"] = "random",
    match_radius: float = 1.0,
    velocity: tuple[float, float] = (0.0, 0.0),
    duration: int = 0,
    pointing: Literal["least-squares", "centroid"] = "least-squares",
    seed: int = 0,
    contrast: float | Sequence[float] | None = None,
    object_sigma_px: float | None = None,
    psf: ArrayLike | None = None,
    frames: int | None = None,
    vary: Mapping[str, Sequence[Any]] | Sequence[str] = (),
    cases: str | Path | None = None,
    sensor: str | None = None,
    objects: str | None = None,
    temperature_difference: float | Sequence[float] | None = None,
    intensity: float | Sequence[float] | None = None,
    range_m: float | None = None,
    object_height_m: float | None = None,
    precision: float | None = None,
    precision_fa: float | None = None,
    time_budget: float | None = None,
    p_fa: float | None = None,
    alarms_per_hour: float | None = None,
    p_d: float | None = None,
    workers: int | Workers | None = None,
    progress: Progress | None = None,
) -> ResultRecord:
    """Contrast that an object needs, and loss against white noise.

    For a probability of 0.9 at one false alarm per hour and field, unless others are given.

    Parameters
    ----------
    {request}
    workers : int or Workers, optional
        Processes on this machine that share the work, or workers as :func:`seaglint.cluster.dask.connected` gives them.
    progress : callable, optional
        Called with (seas done, seas in all).

    Returns
    -------
    ResultRecord
        Values that ``seaglint detect design --json`` prints, the contrast under ``design``; ``plot()`` draws the operating characteristic.

    Raises
    ------
    SeaglintError
        A scenario or numbers that are not allowed, or cases that all failed.

    Examples
    --------
    >>> import seaglint as sg
    >>> sg.detect_design("my.toml", frames=16)["design"]["contrast"]  # doctest: +SKIP
    """
    request = request_of(DesignRequest, locals(), **_of_scene(locals()))
    return _study(source, request, vary, cases, workers, progress)


@documented(RangeRequest)
def detect_range(
    source: SceneInput,
    *,
    detector: str | None = None,
    filter: str = "none",
    kernel: ArrayLike | None = None,
    signature: ArrayLike | None = None,
    threshold: float | None = None,
    threshold_law: Literal["sigma", "frame", "fixed", "design"] = "sigma",
    time_limit: float = 60.0,
    level: float = 0.95,
    injections: int = 2000,
    placement: Literal["random", "centre"] = "random",
    match_radius: float = 1.0,
    velocity: tuple[float, float] = (0.0, 0.0),
    duration: int = 0,
    pointing: Literal["least-squares", "centroid"] = "least-squares",
    seed: int = 0,
    frames: int | None = None,
    vary: Mapping[str, Sequence[Any]] | Sequence[str] = (),
    cases: str | Path | None = None,
    sensor: str | None = None,
    p_fa: float | None = None,
    alarms_per_hour: float | None = None,
    p_d: float | None = None,
    object: str | None = None,
    range_limits: tuple[float, float] | None = None,
    bearings: Sequence[float] | None = None,
    precision: float | None = None,
    progress: Progress | None = None,
) -> ResultRecord:
    """Range up to which an object of a scenario is detected.

    Parameters
    ----------
    {request}
    progress : callable, optional
        Called with (cases done, cases in all).

    Returns
    -------
    ResultRecord
        Values that ``seaglint detect range --json`` prints: ``ranges``, one for each case and bearing; ``plot()`` draws the probability of
        detection against the range.

    Raises
    ------
    SeaglintError
        No such object, or a scenario that cannot be computed.

    Examples
    --------
    >>> import seaglint as sg
    >>> sg.detect_range("boat.toml", object="boat")["ranges"][0]["range_m"]  # doctest: +SKIP
    5230.0
    """
    from seaglint.files.detection_parts import parts_folder
    from seaglint.studies.detect.range_cases import ranges_of

    far = None if bearings is None else tuple(float(value) for value in bearings)
    request = request_of(RangeRequest, locals(), source="scenario", vary=None, cases=None, bearings=far)
    varied = _cases(source, vary, cases, sensor)
    found = []
    with parts_folder(None) as (parts, _), absent_numbers():
        for number, case in enumerate(varied):
            found += ranges_of([case], request, parts)
            if progress is not None:
                progress(number + 1, len(varied))

    def draw() -> Figure:
        from seaglint.plot.detection_study import draw_ranges

        return draw_ranges(found)

    values = {"ranges": [one.as_dict() for one in found]}
    return ResultRecord(values, draw=draw, html=lambda: _range_table(found), title="ranges of detection")


def _of_scene(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a request for scenes that Python accepts in other forms."""
    amounts = {name: numbers_of(given[name]) for name in ("contrast", "temperature_difference", "intensity")}
    return {**amounts, "source": "scenario", "vary": None, "cases": None}


def _cases(source: SceneInput, vary: Any, table: str | Path | None, sensor: str | None) -> list[StudyCase]:
    """Return the cases of a scenario."""
    from seaglint.studies.detect.varied_cases import cases_of

    given = Path(source) if isinstance(source, str | Path) else scenario_of(source)
    return cases_of(given, vary=vary, table=None if table is None else Path(table), sensor=sensor)


def _study(
    source: SceneInput,
    request: SceneRequest,
    vary: Any,
    table: str | Path | None,
    workers: int | Workers | None,
    progress: Progress | None,
) -> ResultRecord:
    """Run the cases of a scenario."""
    from seaglint.base.errors import DataError
    from seaglint.files.detection_parts import parts_folder
    from seaglint.studies.detect.study import run_study

    cases, options = _cases(source, vary, table, request.sensor), request.scene_options()
    named = str(source) if isinstance(source, str | Path) else "scenario"
    with parts_folder(None) as (parts, _), absent_numbers(), team_of(workers) as team:
        study = run_study(cases, options, parts, budget=request.time_budget, progress=progress, workers=team)
    if not study.good:
        raise DataError("\n".join(study.errors))
    unit = str(study.good[0].done.result["contrast_unit"])
    return judged_record(study, {"source": named, **study.as_dict()}, unit)


def _range_table(found: Sequence[Any]) -> str:
    """Return the table of ranges that a notebook shows."""
    from seaglint.base.representation import card, table

    rows = [(one.object, one.named, one.bearing_deg, one.p_d, one.range_m, one.range_interval_m, one.note) for one in found]
    return card("Ranges of detection", table(("object", "case", "bearing [deg]", "P_d", "range [m]", "interval [m]", "note"), rows))
