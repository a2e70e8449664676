"""Functions of detectors: on a recording, in rendered scenes of a scenario, and the range up to which an object is detected.

Each has the parameters of its request in its own signature, so that an editor shows them, and makes the request from them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from seaglint.api.inputs_and_results import ResultRecord, arguments_of, recording_of, request_of, scenario_of, team_of
from seaglint.base.parameters import documented
from seaglint.base.reports import REPORTS, absent_numbers
from seaglint.studies.detect.detection_requests import DesignRequest, RangeRequest, RecordingRequest, SceneRequest

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    from seaglint.analysis import Recording
    from seaglint.api.inputs_and_results import SceneInput
    from seaglint.base.conventions import Progress
    from seaglint.cluster import Workers
    from seaglint.formats.recording import RawLayout
    from seaglint.studies.detect.study import Study
    from seaglint.studies.detect.varied_cases import StudyCase


def numbers_of(values: float | Sequence[float] | None) -> tuple[float, ...] | None:
    """Return one number or several as a tuple."""
    import numpy as np

    return None if values is None else tuple(float(value) for value in np.atleast_1d(np.asarray(values, float)))


def detectors_in(vary: Mapping[str, Sequence[Any]] | Sequence[str]) -> Mapping[str, Sequence[Any]] | Sequence[str]:
    """Return the varied values, with functions among detectors as detectors."""
    from seaglint.detection.interface import detector_of

    if not isinstance(vary, Mapping) or "detector" not in vary:
        return vary
    return {**vary, "detector": [detector_of(one) for one in vary["detector"]]}


def judged_record(study: Study, values: Mapping[str, Any], unit: str) -> ResultRecord:
    """Return the results of a study as a record."""

    def draw() -> Figure:
        from seaglint.plot.detection_report import draw_characteristic

        first = study.good[0].done
        return draw_characteristic(first.roc, first.rows, unit)

    def html() -> str:
        from seaglint.studies.detect.performance import shown

        return shown(values, values["notes"]) if "sweep" in values else study._repr_html_()

    return ResultRecord(values, draw=draw, html=html, title="study of detection")


@documented(RecordingRequest)
def detect_recording(
    source: xr.Dataset | xr.DataArray | NDArray[Any] | str | Path | Recording,
    *,
    detector: str | Callable[[NDArray[Any]], Any] | None = None,
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
    frame_rate: float | None = None,
    units: str | None = None,
    variable: str | None = None,
    channel: str | None = None,
    axes: str | None = None,
    missing: Sequence[float] = (),
    saturation: float | None = None,
    raw: RawLayout | None = None,
    pixel_mrad: float | None = None,
    vary: Mapping[str, Sequence[Any]] | Sequence[str] = (),
    progress: Progress | None = None,
) -> ResultRecord:
    """Detection on a recording without objects.

    Parameters
    ----------
    {request}
    progress : callable, optional
        Called with (steps done, steps in all).

    Returns
    -------
    ResultRecord
        Values that ``seaglint detect recording --json`` prints; ``plot()`` draws the operating characteristic.

    Raises
    ------
    SeaglintError
        Frames that are too few, a detector that fails, numbers that are not allowed.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> noise = np.random.default_rng(1).normal(10.0, 0.5, (8, 64, 64))
    >>> how = dict(detector="matched", threshold=3.0, injections=200)
    >>> found = sg.detect_recording(noise, contrast=[1.0, 3.0], **how)
    >>> [entry["p_d"] > 0.9 for entry in found["sweep"]]
    [False, True]
    """
    from seaglint.detection.interface import detector_of
    from seaglint.studies.detect.recordings import options_of, run_recording, settings_of

    amounts = {"contrast": numbers_of(contrast), "missing": tuple(missing), "detector": detector_of(detector)}
    request = request_of(RecordingRequest, locals(), source="recording", vary=None, **amounts)
    opened = recording_of(source, request)
    pixel = request.pixel_deg("pixel_mrad = ")
    with absent_numbers():
        study = run_recording(opened, options_of(request, opened, pixel), settings_of(detectors_in(vary)), progress=progress)
    values = study.as_dict() if vary else study.good[0].done.result
    return judged_record(study, values, opened.units or "")


@documented(RecordingRequest, DesignRequest)
def detect(
    source: SceneInput | xr.Dataset | xr.DataArray | NDArray[Any] | Recording,
    contrast: float | Sequence[float] | None = None,
    *,
    detector: str | Callable[[NDArray[Any]], Any] | None = None,
    filter: str = "none",
    threshold: float | None = None,
    threshold_law: Literal["sigma", "frame", "fixed", "design"] = "sigma",
    time_limit: float = 60.0,
    level: float = 0.95,
    injections: int = 2000,
    object_sigma_px: float | None = None,
    psf: ArrayLike | None = None,
    objects: str = "point",
    frames: int = 32,
    precision: float | None = None,
    time_budget: float | None = None,
    sea_draws: int | None = None,
    design: bool = False,
    p_fa: float | None = None,
    frame_rate: float | None = None,
    units: str | None = None,
    variable: str | None = None,
    placement: Literal["random", "centre"] = "random",
    match_radius: float = 1.0,
    velocity: tuple[float, float] = (0.0, 0.0),
    pointing: Literal["least-squares", "centroid"] = "least-squares",
    duration: int = 0,
    seed: int = 0,
    workers: int | Workers | None = None,
    progress: Progress | None = None,
) -> ResultRecord:
    """Probabilities of detection and false alarm, and errors of place, of a detector: on a recording or in the scenes of a scenario.

    :func:`detect_recording`, :func:`detect_scene` and :func:`detect_design` have all parameters of each kind.

    Parameters
    ----------
    {request}
    design : bool
        Contrast of a scenario's object for P_d 0.9 at one false alarm per hour and field, or at ``p_fa``, and the loss against white noise.
    workers : int or Workers, optional
        Processes on this machine that render the seas of a scenario, or workers as :func:`seaglint.cluster.dask.connected` gives them.
    progress : callable, optional
        Called with (done, in all).

    Returns
    -------
    ResultRecord
        Values that ``seaglint detect --json`` prints. Notebooks show them as a table.

    Raises
    ------
    SeaglintError
        Frames that are too few, a detector that fails, numbers that are not allowed.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> noise = np.random.default_rng(1).normal(10.0, 0.5, (8, 64, 64))
    >>> how = dict(detector="matched", threshold=3.0, injections=200)
    >>> found = sg.detect(noise, [1.0, 3.0], **how)
    >>> [entry["p_d"] > 0.9 for entry in found["sweep"]]
    [False, True]

    A function of frames is a detector as well:

    >>> own = lambda frames: frames
    >>> found = sg.detect(noise, [1.0, 3.0], detector=own, injections=50)
    >>> found["detector"]
    'lambda'
    """
    import xarray as xr

    from seaglint.scenario.model import Scenario

    function: Callable[..., ResultRecord] = detect_recording
    is_file = isinstance(source, str | Path) and Path(source).suffix.lower() == ".toml"
    if is_file or isinstance(source, Scenario) or (isinstance(source, Mapping) and not isinstance(source, xr.Dataset)):
        function = detect_design if design or p_fa is not None else detect_scene
    elif workers is not None:
        REPORTS.warning("a recording is judged in one piece, by this process alone: `workers` are not used")
    # Parameters that the other function has, by its signature.
    return function(**arguments_of(function, locals()))


@documented(SceneRequest)
def detect_scene(
    source: SceneInput,
    *,
    detector: str | Callable[[NDArray[Any]], Any] | None = None,
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
    sea_draws: int | None = None,
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
    >>> scene = {"sensor": {"pixels": [32, 16]}, "sea": {"resolve_waves": False}}
    >>> found = sg.detect_scene(scene, contrast=[0.01, 100.0], frames=2, injections=50)
    >>> [entry["p_d"] for entry in found["sweep"]]
    [0.0, 1.0]
    """
    return _study(source, request_of(SceneRequest, locals(), **_of_scene(locals())), vary, cases, workers, progress)


@documented(DesignRequest)
def detect_design(
    source: SceneInput,
    *,
    detector: str | Callable[[NDArray[Any]], Any] | None = None,
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
    sea_draws: int | None = None,
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
    >>> scene = {"sensor": {"pixels": [32, 16]}, "sea": {"resolve_waves": False}}
    >>> design = sg.detect_design(scene, frames=8, injections=50, p_fa=0.01)["design"]
    >>> round(design["contrast"], 1), design["contrast_unit"]
    (20.1, 'W m-2 sr-1')
    """
    return _study(source, request_of(DesignRequest, locals(), **_of_scene(locals())), vary, cases, workers, progress)


@documented(RangeRequest)
def detect_range(
    source: SceneInput,
    *,
    detector: str | Callable[[NDArray[Any]], Any] | None = None,
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
    workers: int | Workers | None = None,
    progress: Progress | None = None,
) -> ResultRecord:
    """Range up to which an object of a scenario is detected.

    Parameters
    ----------
    {request}
    workers : int or Workers, optional
        Processes on this machine that share the work, or workers as :func:`seaglint.cluster.dask.connected` gives them.
    progress : callable, optional
        Called with (ranges done, ranges in all).

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
    >>> camera = {"pixels": [48, 24], "fov_deg": [4, 2], "elevation_deg": -4}
    >>> boat = {"name": "boat", "preset": "small-boat", "north_m": -400}
    >>> scene = {"sensor": camera, "sea": {"resolve_waves": False}, "objects": [boat]}
    >>> quick = dict(frames=2, precision=0.5, range_limits=(5e3, 4e4), p_fa=0.01)
    >>> found = sg.detect_range(scene, object="boat", detector="top-hat", **quick)
    >>> round(found["ranges"][0]["range_m"], -2)
    5600.0
    """
    from seaglint.detection.interface import detector_of
    from seaglint.store.detection_results import parts_folder
    from seaglint.studies.detect.study import ranges_of

    far = None if bearings is None else tuple(float(value) for value in bearings)
    own = {"vary": None, "cases": None, "bearings": far, "detector": detector_of(detector)}
    request = request_of(RangeRequest, locals(), source="scenario", **own)
    varied = _cases(source, vary, cases, sensor)
    with parts_folder(None) as (parts, _), absent_numbers(), team_of(workers) as team:
        ranges = ranges_of(varied, request, parts, progress=progress, workers=team)

    def draw() -> Figure:
        from seaglint.plot.detection_report import draw_ranges

        return draw_ranges(ranges)

    values = {"ranges": [one.as_dict() for one in ranges]}
    return ResultRecord(values, draw=draw, html=lambda: _range_table(ranges), title="ranges of detection")


def _of_scene(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return the fields of a request for scenes that have other forms in Python."""
    from seaglint.detection.interface import detector_of

    amounts = {name: numbers_of(given[name]) for name in ("contrast", "temperature_difference", "intensity")}
    return {**amounts, "detector": detector_of(given["detector"]), "source": "scenario", "vary": None, "cases": None}


def _cases(source: SceneInput, vary: Any, table: str | Path | None, sensor: str | None) -> list[StudyCase]:
    """Return the cases of a scenario."""
    from seaglint.studies.detect.varied_cases import cases_of

    given = Path(source) if isinstance(source, str | Path) else scenario_of(source)
    return cases_of(given, vary=detectors_in(vary), table=None if table is None else Path(table), sensor=sensor)


def _study(
    source: SceneInput, request: SceneRequest, vary: Any, table: str | Path | None, workers: int | Workers | None, progress: Progress | None
) -> ResultRecord:
    """Run the cases of a scenario."""
    from seaglint.base.errors import DataError
    from seaglint.store.detection_results import parts_folder
    from seaglint.studies.detect.study import run_study

    cases = _cases(source, vary, table, request.sensor)
    request.require_valid()
    named = str(source) if isinstance(source, str | Path) else "scenario"
    with parts_folder(None) as (parts, _), absent_numbers(), team_of(workers) as team:
        study = run_study(cases, request, parts, progress=progress, workers=team)
    if not study.good:
        raise DataError("\n".join(study.errors))
    unit = str(study.good[0].done.result["contrast_unit"])
    return judged_record(study, {"source": named, **study.as_dict()}, unit)


def _range_table(ranges: Sequence[Any]) -> str:
    """Return the table of ranges that a notebook shows."""
    from seaglint.base.representation import card, table

    rows = [(one.object, one.named, one.bearing_deg, one.p_d, one.range_m, one.range_interval_m, one.note) for one in ranges]
    return card("Ranges of detection", table(("object", "case", "bearing [deg]", "P_d", "range [m]", "interval [m]", "note"), rows))
