"""Functions of one scenario and of single files.

- ``sg.init``, ``sg.schema`` and ``sg.load`` write, describe and read scenario files; ``sg.info`` describes any file.
- ``sg.mean`` and ``sg.image`` compute one scene without files.
- ``sg.sweep`` computes one quantity over every combination of values of a scenario's keys.
- ``sg.likelihood`` computes how often glint exceeds thresholds.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from seaglint.api.inputs_and_results import ResultRecord, arguments_of, path_of, scenario_of, scene_input, team_of, with_band
from seaglint.base.parameters import documented
from seaglint.studies.study_requests import MOST_CASES, LikelihoodRequest, MeanRequest, SweepRequest

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from seaglint.api.inputs_and_results import SceneInput
    from seaglint.base.conventions import Progress
    from seaglint.climate.likelihood_summary import LikelihoodSummary
    from seaglint.cluster import Workers
    from seaglint.scenario.model import Scenario


def init(output: str | Path, preset: str = "glint", *, camera: str | Path | None = None, overwrite: bool = False) -> Path:
    """Write a commented scenario file.

    Parameters
    ----------
    output : path
        File to write, ``.toml``.
    preset : str
        Scene to begin with; ``seaglint init --presets`` lists them.
    camera : str or path, optional
        Camera of a data sheet's numbers, as ``"pixels=640x512, pitch_um=15, focal_mm=100, ..."``, or a TOML file of the same. Assumed
        values are logged.
    overwrite : bool
        Replace a file that is there.

    Returns
    -------
    Path
        ``output``; :func:`load` reads it.

    Raises
    ------
    SeaglintError
        An unknown preset, a camera that cannot be, or a file that is there.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sg.load(sg.init(f"{folder}/my.toml", preset="calm")).wind.speed_m_s > 0.0
    True
    """
    import logging

    from seaglint.scenario.camera import assumed_values, read_camera
    from seaglint.scenario.load import load_scenario
    from seaglint.scenario.text.template import write_template
    from seaglint.store.outputs import refuse_existing, require_ending

    path = path_of(output, "output")
    require_ending(path, (".toml",), "a scenario is a TOML file")
    refuse_existing(path, overwrite=overwrite)
    chosen = None if camera is None else read_camera(str(camera))
    write_template(path, preset, camera=chosen, overwrite=overwrite)
    for line in () if chosen is None else (*chosen.assumed, *assumed_values(load_scenario(path), chosen)):
        logging.getLogger(__name__).info("camera: %s", line)
    return path


def schema() -> dict[str, Any]:
    """JSON Schema of scenario files.

    Returns
    -------
    dict
        The schema, for editors and validators.

    Examples
    --------
    >>> import seaglint as sg
    >>> "wind" in sg.schema()["properties"]
    True
    """
    from seaglint.scenario.text.template import json_schema

    return dict(json_schema())


def info(path: str | Path, *, variable: str | None = None, channel: str | None = None, axes: str | None = None) -> ResultRecord:
    """Report the contents of a file and how it was made.

    Parameters
    ----------
    path : str or path
        Sequence, finished or not, also a URL; mean map; scenario; recording of any format.
    variable : str, optional
        Array of a recording that holds several.
    channel : str, optional
        Colour, or number of a channel, of a recording of several.
    axes : str, optional
        Order of a recording's axes, e.g. ``yxt`` where time is the last.

    Returns
    -------
    ResultRecord
        Values that ``seaglint info --json`` prints; ``plot()`` draws a picture of a sequence or a map.

    Raises
    ------
    SeaglintError
        Nothing is there, or it cannot be read.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sg.info(sg.init(f"{folder}/my.toml"))["kind"]
    'scenario'
    """
    from seaglint.studies.file_contents import describe, describe_recording, describe_scenario, is_ours

    # A URL must not become a Path, which would shorten its two slashes to one.
    place = path if isinstance(path, str) and "://" in path else path_of(path, "path")
    if is_ours(place):
        values: Mapping[str, Any] = describe(place).as_dict()
        return ResultRecord(values, draw=lambda: _picture(place), title=str(path))
    file = Path(path)
    known = describe_scenario(file) if file.suffix.lower() == ".toml" else describe_recording(file, variable, channel, axes)
    return ResultRecord(known.as_dict(), title=str(path))


def _picture(place: str | Path) -> Figure:
    """Draw a sequence or a map as the preview of its command."""
    from seaglint.plot.preview import draw
    from seaglint.store.netcdf import open_netcdf
    from seaglint.store.sequence_store import open_sequence

    is_file = isinstance(place, Path) and place.is_file()
    with open_netcdf(place, decode_times=False) if is_file else open_sequence(place, allow_partial=True) as dataset:
        return draw(dataset)


def load(source: SceneInput) -> Scenario:
    """Read and check a scenario.

    Parameters
    ----------
    source : path, mapping or Scenario
        A TOML file, or its content as tables in a mapping; a scenario is returned unchanged.

    Returns
    -------
    Scenario
        Frozen; defaults filled in.

    Raises
    ------
    ScenarioError
        One line for each mistake.

    Examples
    --------
    >>> import seaglint as sg
    >>> round(sg.load({"sensor": {"height_m": "100 ft"}}).sensor.height_m, 2)
    30.48
    """
    return scenario_of(source)


@documented(MeanRequest)
def mean(scenario: SceneInput, *, sea_draws: int | None = None, progress: Progress | None = None) -> xr.Dataset:
    """Map mean radiance and apparent temperature over the view.

    Parameters
    ----------
    {request}
    progress : callable, optional
        Called with (rows or pixels done, all of them).

    Returns
    -------
    xarray.Dataset
        Maps (y, x) with units, coordinates and provenance, as ``seaglint mean`` writes them; radiances [W m-2 sr-1]. With ``sea_draws``
        also ``radiance_sea_low``, ``radiance_sea_high`` and the same of ``apparent_temperature`` and ``glint_std``.

    Raises
    ------
    SeaglintError
        A condition outside the ranges of the models; the message names the value, the range and the remedy.

    Examples
    --------
    >>> import seaglint as sg
    >>> found = sg.mean(sg.load({"sensor": {"pixels": [8, 4]}}))
    >>> found.radiance.dims, found.radiance.units
    (('y', 'x'), 'W m-2 sr-1')
    """
    from seaglint.store.netcdf import labelled
    from seaglint.studies.mean.mean_map import mean as computed

    return with_band(labelled(computed(scenario_of(scenario), progress, sea_draws=sea_draws)))


def image(scenario: SceneInput, time: float = 0.0, layers: Collection[str] = ()) -> xr.Dataset:
    """Compute the radiance at the aperture at one time, without a file; also for a scenario with a detector.

    It is sharp: optics and detector are ignored. :func:`frames` gives the counts that :func:`render` writes.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        See :func:`load`; its ``render.layers``, optics and detector are ignored.
    time : float
        Time from the start [s]; any, frames are not more than instants.
    layers : collection of str
        Further images, of ``seaglint.base.schema.LAYERS``: the radiance's four parts, distance and slope of the sea, the share of a
        pixel that the sea fills, the share of glint in the radiance, the number of the object in the pixel.

    Returns
    -------
    xarray.Dataset
        ``radiance`` [W m-2 sr-1, (y, x)] and the layers, with units, coordinates and provenance. Of a scenario without a detector it is
        the frame that :func:`render` writes for this time.

    Raises
    ------
    SeaglintError
        A condition outside the models, a time outside the platform's track, or an unknown layer.

    Notes
    -----
    Each call prepares everything; for many times take ``seaglint.studies.sequence.render_sequence.prepare_sequence``, ``at(time)``.

    Examples
    --------
    >>> import seaglint as sg
    >>> scene = sg.load({"sensor": {"pixels": [8, 4]}, "sea": {"resolve_waves": False}})
    >>> found = sg.image(scene, time=0.5, layers=["range"])
    >>> found["range"].units, float(found.time)
    ('m', 0.5)
    """
    from seaglint.store.netcdf import labelled
    from seaglint.studies.sequence.labelled_frames import image as drawn

    return with_band(labelled(drawn(scenario_of(scenario), time, layers)))


@documented(SweepRequest)
def sweep(
    scenario: Scenario | str | Path | Mapping[str, Any],
    vary: Mapping[str, Sequence[Any]],
    *,
    what: Literal["mean", "image", "sensor", "atmosphere", "likelihood"] | Callable[[Scenario], Any] = "mean",
    at: Mapping[str, Any] | None = None,
    workers: int | Workers | None = None,
    threads: int | None = None,
    keep_going: bool = False,
    most_cases: int = MOST_CASES,
    lazy: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Compute one quantity over every combination of values of keys.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        See :func:`load`; or a TOML file, or its content as tables in a mapping.
    {request}
    lazy : bool
        Compute a case when its values are read: arrays are Dask arrays with a piece for each case. The first case is computed at once.
    progress : callable, optional
        Called with (cases done, cases in all).

    Returns
    -------
    xarray.Dataset
        Dimensions are the swept keys by their names, with their values and units as coordinates, then the dimensions of ``at`` or of the
        picture. The attribute ``failed_cases`` is the number of failed cases, and ``failures`` has the first reasons.

    Raises
    ------
    SeaglintError
        A key that does not exist, values of another unit, more cases than ``most_cases`` or than memory holds, or a case that fails.

    Notes
    -----
    Preparations that a key does not affect are made once: the air of a wind serves all Suns, for example.

    Examples
    --------
    >>> import seaglint as sg
    >>> winds = {"wind.speed_m_s": [5, "20 kn"], "sun.zenith_deg": [30, 60]}
    >>> long_wave = {"band": {"min_um": 8, "max_um": 12}}
    >>> seen = sg.sweep(long_wave, winds, at={"view_zenith_deg": [0, 60]})
    >>> dict(seen.radiance.sizes)
    {'wind.speed_m_s': 2, 'sun.zenith_deg': 2, 'view_zenith_deg': 2}
    """
    from seaglint.studies.sweep.run_sweep import sweep as computed

    with team_of(workers, threads) as others:
        # Workers limit their threads themselves; the limit of this process would not reach them.
        own_threads = threads if workers is None else None
        return computed(**arguments_of(computed, locals(), source=scene_input(scenario), workers=others, threads=own_threads))


@documented(LikelihoodRequest)
def likelihood(
    scenario: SceneInput,
    *,
    by_month: bool = False,
    step: float | None = None,
    track: str | Path | None = None,
    forecast: str | Path | None = None,
    wind_spread: float = 0.0,
    cover_spread: float = 0.0,
    best: bool = False,
    date: str | None = None,
    sea_draws: int | None = None,
    workers: int | Workers | None = None,
    progress: Progress | None = None,
) -> ResultRecord | xr.Dataset:
    """How often glint is brighter than thresholds.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        Scenario with a table ``[likelihood]``.
    {request}
    workers : int or Workers, optional
        Processes on this machine that share the work of a map, or workers as :func:`seaglint.cluster.dask.connected` gives them.
    progress : callable, optional
        Called with (steps done, steps in all).

    Returns
    -------
    ResultRecord or xarray.Dataset
        Chances of the thresholds with their intervals and causes, ``plot()`` draws them, and with ``sea_draws`` the ends of the interval
        over the seas between the campaigns; with ``by_month`` a map, ``probability`` [1] over
        ``threshold, month, latitude, longitude``; with ``track`` the chance of each threshold [1] over ``time`` along the way, and with
        ``forecast`` beside it ``forecast_probability`` and the weather of the forecast; with ``best`` the ``probability`` of each
        threshold, hour, depression and bearing, and of them ``best``, ``worst`` and ``best_by_hour``.

    Raises
    ------
    SeaglintError
        A scenario without ``[likelihood]`` or a region, or a file of a way that cannot be used.

    Examples
    --------
    >>> import seaglint as sg
    >>> table = {"threshold_w_m2_sr": [1.0], "samples": 1024}
    >>> chances = sg.likelihood({"likelihood": table})
    >>> 0.0 <= chances["results"][0]["probability"] <= 1.0
    True
    """
    way = None if track is None else path_of(track, "track")
    ahead = None if forecast is None else path_of(forecast, "forecast")
    LikelihoodRequest(
        by_month=by_month,
        step=step,
        track=way,
        forecast=ahead,
        wind_spread=wind_spread,
        cover_spread=cover_spread,
        best=best,
        date=date,
        sea_draws=sea_draws,
    )
    loaded = scenario_of(scenario)
    if by_month:
        from seaglint.studies.likelihood.chance_map import likelihood_map

        with team_of(workers) as team:
            return likelihood_map(loaded, step=step, progress=progress, workers=team)
    if way is not None:
        from seaglint.studies.likelihood.ship_track import along_track

        return along_track(loaded, way, forecast=ahead, wind_spread=wind_spread, cover_spread=cover_spread).dataset()
    if best:
        return _best_looks(loaded, date, progress)
    from seaglint.studies.likelihood.glint_chance import likelihood as computed

    result = computed(loaded, progress=progress, sea_draws=sea_draws)
    summary = result.summary()

    def draw() -> Figure:
        from seaglint.plot.environment_charts import draw_charts

        return draw_charts(summary, result.month_by_hour())

    return ResultRecord(summary.as_dict(), draw=draw, html=lambda: _shown(summary), title="likelihood of glint")


def _best_looks(scenario: Scenario, date: str | None, progress: Progress | None) -> ResultRecord:
    from seaglint.base.representation import card, notes, table
    from seaglint.studies.likelihood.best_looks import best_looks

    looks = best_looks(scenario, date=date, progress=progress)
    values = looks.as_dict()

    def draw() -> Figure:
        from seaglint.plot.likelihood_maps import draw_best

        return draw_best(looks)

    def shown() -> str:
        names = ("threshold_w_m2_sr", "hour_utc", "bearing_deg", "depression_deg", "probability", "probability_towards_sun")
        return card(f"least glint on {looks.date}", table(names, [[row[n] for n in names] for row in values["best"]]) + notes(looks.notes))

    return ResultRecord(values, draw=draw, html=shown, title="directions with the least glint")


def _shown(summary: LikelihoodSummary) -> str:
    """Return the table of a notebook: the chance of each threshold."""
    from seaglint.base.representation import card, notes, table
    from seaglint.studies.sea_draws import sea_line

    rows = [(row.threshold_w_m2_sr, row.probability, row.interval, row.false_alarms_per_hour) for row in summary.results]
    head = ("threshold [W m-2 sr-1]", "probability", "95 % interval", "false alarms an hour")
    seas = [
        f"{row.threshold_w_m2_sr:g} W m-2 sr-1, {sea_line(row.sea_unknown_low, row.sea_unknown_high, row.sea_draws, value=row.probability)}"
        for row in summary.results
        if row.sea_draws is not None and row.sea_unknown_low is not None and row.sea_unknown_high is not None
    ]
    return card(f"{summary.case}: {summary.quantity}", table(head, rows) + notes([*seas, *summary.notes]))
