"""Functions of sequences, of sensors and of many scenes.

- ``sg.render`` writes a sequence, ``sg.frames`` yields its frames without files.
- ``sg.sense`` applies a sensor to radiance, ``sg.sensor`` computes its figures of merit.
- ``sg.ensemble`` draws and renders many scenes, ``sg.dataset`` makes labelled data sets of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seaglint.api.inputs_and_results import ResultRecord, arguments_of, path_of, recording_of, request_of, scenario_of, team_of, with_band
from seaglint.base.errors import DataError
from seaglint.base.free_form import TableRow
from seaglint.base.parameters import documented
from seaglint.studies.ensemble.ensemble_requests import DatasetRequest, EnsembleRequest
from seaglint.studies.study_requests import RenderRequest, SenseRequest

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from seaglint.analysis import Recording
    from seaglint.api.inputs_and_results import SceneInput
    from seaglint.base.conventions import Progress
    from seaglint.cluster import Workers
    from seaglint.formats.recording import RawLayout
    from seaglint.store.writers import Share


@documented(RenderRequest)
def render(
    scenario: SceneInput,
    output: str | Path,
    *,
    frames: range | None = None,
    threads: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
    electrons: bool = False,
    radiance: bool = False,
    workers: int | Workers | None = None,
    sensor: str | None = None,
    shard: str | None = None,
    finish: bool = False,
) -> xr.Dataset:
    """Render the sequence: radiance, or counts of a detector.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        See :func:`load`.
    output : path
        Store to make, customarily ``*.zarr``.
    progress : callable, optional
        Called with (frames done, frames in all).
    sensor : str, optional
        Sensor of a data sheet instead of the scenario's; ``seaglint sensor --presets`` lists them.
    shard : str, optional
        Share of the work as ``"0/4"``, counted from 0, for several machines that write into one store; ``finish`` completes it.
    finish : bool
        Check that all frames of a store that was rendered in shares are there, and name it; nothing is rendered.
    {request}

    Returns
    -------
    xarray.Dataset
        The finished store: ``radiance`` [W m-2 sr-1, (time, y, x)], of a scenario with a detector ``signal`` [counts], and what the
        scenario's ``render.layers`` name. Frames are read when they are used. After a share the frames that are there.

    Raises
    ------
    SeaglintError
        A condition outside the models, an existing store, or a full disk.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> camera = {"pixels": [8, 4], "frames": 3}
    >>> scene = sg.load({"sensor": camera, "sea": {"resolve_waves": False}})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sg.render(scene, f"{folder}/run.zarr").radiance.shape
    (3, 4, 8)
    """
    from seaglint.store.sequence_store import finish_sequence, open_sequence
    from seaglint.store.writers import Share
    from seaglint.studies.sequence.sensed_sequence import render as written

    loaded = scenario_of(scenario, sensor)
    if finish:
        finish_sequence(output, loaded.model_dump_json(exclude_none=True))
        return with_band(open_sequence(output))
    share = None if shard is None else Share.parse(shard)
    with team_of(workers, threads) as team:
        # Workers limit their threads themselves; the limit of this process would not reach them.
        own_threads = threads if workers is None else None
        path = written(**arguments_of(written, locals(), scenario=loaded, workers=team, threads=own_threads))
    return _opened(path, share)


def frames(
    scenario: SceneInput, frames: range | None = None, *, electrons: bool = False, radiance: bool = False, sensor: str | None = None
) -> Iterator[xr.Dataset]:
    """Frames of a scenario one by one, without files, with the truth of its objects.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        See :func:`load`.
    frames : range, optional
        Numbers of the frames, counted from 0; all of the scenario by default.
    electrons : bool
        With a detector: electrons beside counts.
    radiance : bool
        With a detector: radiance at the aperture beside counts, averaged over pixels.
    sensor : str, optional
        Sensor of a data sheet instead of the scenario's; ``seaglint sensor --presets`` lists them.

    Returns
    -------
    iterator of xarray.Dataset
        Of each frame the arrays that :func:`render` writes, equal to the last bit: ``signal`` [counts, (y, x)] of a scenario with a
        detector, else ``radiance`` [W m-2 sr-1, (y, x)], and the scenario's ``render.layers``. With objects also ``names``; ``classes``,
        which are the preset, else the kind of shape, as in data sets; ``boxes``, first column and row, number of columns and rows [px,
        (object, side)]; ``masks`` [(object, y, x)], the pixels that an object touches, and of a scenario with a detector
        ``response_masks`` [(object, y, x)], those of its response after the optics; ``object_id`` [(y, x)]; and the numbers that
        :func:`labels` gives, over ``object``. An object that is nowhere in view has NaN as box and an empty mask.

    Raises
    ------
    SeaglintError
        A condition outside the models, before the first frame.

    Examples
    --------
    >>> import seaglint as sg
    >>> camera = {"pixels": [8, 4], "frames": 2}
    >>> scene = sg.load({"sensor": camera, "sea": {"resolve_waves": False}})
    >>> [(int(frame.frame), frame.radiance.shape) for frame in sg.frames(scene)]
    [(0, (4, 8)), (1, (4, 8))]
    """
    from seaglint.studies.sequence.labelled_frames import frame_datasets

    datasets = frame_datasets(scenario_of(scenario, sensor), frames, electrons=electrons, radiance=radiance)
    return (with_band(frame) for frame in datasets)


@documented(SenseRequest, INPUT="the radiance")
def sense(
    radiance: xr.Dataset | xr.DataArray | NDArray[Any] | str | Path | Recording,
    scenario: SceneInput,
    output: str | Path | None = None,
    *,
    seed: int | None = None,
    oversampling: int | None = None,
    electrons: bool = False,
    sensor: str | None = None,
    frame_rate: float | None = None,
    units: str | None = None,
    variable: str | None = None,
    channel: str | None = None,
    axes: str | None = None,
    missing: Sequence[float] = (),
    raw: RawLayout | None = None,
    shard: str | None = None,
    resume: bool = False,
    overwrite: bool = False,
    workers: int | Workers | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Put a sensor on recorded radiance: counts of its detector.

    Parameters
    ----------
    radiance : xarray.Dataset, xarray.DataArray, ndarray, path or Recording
        In-band radiance [W m-2 sr-1, (time, y, x) or (y, x)], or a file of it.
    scenario : Scenario, path or mapping
        With ``[sensor.optics]`` and ``[sensor.detector]``; its ``band`` is the band of the radiance.
    output : path, optional
        Zarr store to write and open; without it the counts are made in memory.
    sensor : str, optional
        Sensor of a data sheet instead of the scenario's; ``seaglint sensor --presets`` lists them.
    shard : str, optional
        Share of the work as ``"0/4"``, counted from 0, for several machines that write into one store.
    progress : callable, optional
        Called with (frames done, frames in all) while a store is written.
    {request}

    Returns
    -------
    xarray.Dataset
        ``signal`` [counts, uint16, (time, y, x)], ``electrons`` if requested, ``saturated_share``; :func:`apparent_temperature` takes it.

    Raises
    ------
    SeaglintError
        No sensor, a picture that the oversampling does not divide, values that are no radiances, workers for images in memory.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> optics, detector = {"aperture_m": 0.05, "f_number": 4.0}, {"pitch_um": 15.0}
    >>> camera = {"optics": optics, "detector": detector, "noise": {"temporal": False}}
    >>> scene = sg.load({"sensor": camera})
    >>> found = sg.sense(np.full((2, 24, 24), 1.5), scene, oversampling=3)
    >>> found.signal.shape, round(float(sg.apparent_temperature(found).mean()), 2)
    ((2, 8, 8), 295.03)
    """
    import xarray as xr

    from seaglint.formats.recording.labelled_arrays import Source, source_of
    from seaglint.store.writers import Share
    from seaglint.studies.sequence.sense import Reopen, prepare_sense, sensed_dataset
    from seaglint.studies.sequence.sense import sense as written

    loaded = scenario_of(scenario, sensor)
    # Workers receive this record, so it must not hold the workers themselves.
    reading = request_of(SenseRequest, locals(), missing=tuple(missing), workers=None)
    if isinstance(radiance, str | Path):
        source, reopen = source_of(Path(radiance)), Reopen(Path(radiance), reading)
    else:
        radiance = radiance.to_dataset(name="radiance") if isinstance(radiance, xr.DataArray) else radiance
        source, reopen = Source.of(radiance) if isinstance(radiance, xr.Dataset) else None, None
        if workers is not None:
            raise DataError("workers read the radiance again by its name, and it is in memory; give a file, or leave workers out")
    recording = recording_of(radiance, reading)
    if output is None:
        return sensed_dataset(*prepare_sense(**arguments_of(prepare_sense, locals(), scenario=loaded)))
    share = None if shard is None else Share.parse(shard)
    with team_of(workers) as team:
        path = written(**arguments_of(written, locals(), scenario=loaded, workers=team))
    return _opened(path, share)


def _opened(path: Path | str, share: Share | None) -> xr.Dataset:
    """Return a written store; with a share of a store that is not finished, its frames so far."""
    from seaglint.store.location import place_of
    from seaglint.store.sequence_store import open_sequence

    if share is not None and not place_of(path).taken():
        return open_sequence(place_of(path).work, allow_partial=True)
    return with_band(open_sequence(path))


def sensor(scenario: SceneInput, *, frequency: Sequence[float] = (), sensor: str | None = None) -> ResultRecord:
    """Figures of merit of a sensor: NETD, MTF, noise budget.

    Parameters
    ----------
    scenario : Scenario, path or mapping
        With ``[sensor.optics]`` and ``[sensor.detector]``.
    frequency : sequence of float
        Frequencies of the MTF [cycles/mrad]; by default from 0 to beyond Nyquist.
    sensor : str, optional
        Sensor of a data sheet instead of the scenario's; ``seaglint sensor --presets`` lists them.

    Returns
    -------
    ResultRecord
        ``netd_k``, ``sitf_counts_per_k``, ``nei_w_m2``, ``nep_w``, ``mtf`` with its parts, the noise budget for the mean of the scene,
        ``dynamic_range_db``, ``saturation_temperature_k``, 3-D noise and what the conversion to photons costs; ``plot()`` draws MTF and
        noise budget.

    Raises
    ------
    SeaglintError
        No sensor, or a scene that cannot be computed.

    Examples
    --------
    >>> import seaglint as sg
    >>> optics = {"aperture_m": 0.05, "f_number": 4.0}
    >>> detector = {"pitch_um": 15.0, "well_capacity_e": 7e6}
    >>> camera = {"optics": optics, "detector": detector, "frame_rate_hz": 100}
    >>> found = sg.sensor(sg.load({"sensor": camera}))
    >>> round(found["electrons_per_count"], 2)
    106.81
    """
    from seaglint.studies.mean.sensor_figures import describe_sensor

    described = describe_sensor(scenario_of(scenario, sensor), tuple(frequency))

    def draw() -> Figure:
        from seaglint.plot.sensor_and_spectra import draw_sensor

        return draw_sensor(described.sheet)

    return ResultRecord(described.as_dict(), draw=draw, title="sensor")


@documented(EnsembleRequest)
def ensemble(
    source: str | Path | Mapping[str, Any],
    output: str | Path,
    *,
    workers: int | Workers | None = None,
    threads: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    draw_only: bool = False,
    sea_draws: int | None = None,
    progress: Progress | None = None,
) -> list[TableRow]:
    """Draw scenes from laws of a scenario's keys and render each.

    Parameters
    ----------
    source : path or mapping
        An ensemble's TOML file, or its content as tables in a mapping.
    output : path
        Folder to make: tables, ``scenes/0000.toml`` and ``scenes/0000.zarr`` for each scene.
    {request}
    progress : callable, optional
        ``progress(scenes done, scenes in all)``.

    Returns
    -------
    list of dict
        The rows of ``parameters.csv``: scene, seed, and what was drawn by key.

    Raises
    ------
    SeaglintError
        Mistakes in the file, output that may not be written, or scenes that failed.

    Examples
    --------
    >>> import tempfile
    >>> import seaglint as sg
    >>> laws = [{"key": "wind.speed_m_s", "law": "choice", "values": [3.0]}]
    >>> base = {"sensor": {"pixels": [8, 4]}}
    >>> study = {"ensemble": {"scenes": 2}, "base": base, "vary": laws}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     rows = sg.ensemble(study, f"{folder}/many", draw_only=True)
    >>> [row["wind.speed_m_s"] for row in rows]
    [3.0, 3.0]
    """
    from seaglint.scenario.ensemble_file import load_ensemble, parse_ensemble
    from seaglint.studies.ensemble.render_ensemble import draw, render_ensemble

    resolved = parse_ensemble(source) if isinstance(source, Mapping) else load_ensemble(path_of(source, "source"))
    with team_of(workers, threads) as others:
        render_ensemble(**arguments_of(render_ensemble, locals(), ensemble=resolved, workers=others))
    return [scene.row for scene in draw(resolved)]


@documented(
    DatasetRequest,
    formats="``coco``, ``yolo``, ``sirst``, ``coco-video``, ``mot``, ``nudt-mirsdt`` or ``zarr``: the scenes' stores as they are",
)
def dataset(
    source: str | Path,
    output: str | Path | None = None,
    *,
    format: str = "coco",
    bits: int | str | None = None,
    image: str | None = None,
    scale: str | None = None,
    limits: tuple[float, float] | None = None,
    clip: float | None = None,
    masks: str = "response",
    min_snr: float | None = None,
    workers: int | Workers | None = None,
    threads: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    check: bool = False,
    progress: Progress | None = None,
) -> Path:
    """Render labelled pictures of an ensemble: masks, boxes, tables.

    Parameters
    ----------
    source : path
        An ensemble's TOML file, or the folder that :func:`ensemble` made; with ``check`` a data set.
    output : path, optional
        Folder to make; needed unless ``check`` is set.
    {request}
    check : bool
        Check a data set that is there, and make none.
    progress : callable, optional
        ``progress(scenes done, scenes in all)``.

    Returns
    -------
    Path
        ``output``; with ``check`` the data set that is whole.

    Raises
    ------
    SeaglintError
        An error as for :func:`ensemble`, an unknown format, or the faults of a data set that is checked.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> camera = {"pixels": [48, 24], "fov_deg": [4, 2], "elevation_deg": -4, "frames": 1}
    >>> boat = {"name": "boat", "preset": "small-boat", "north_m": -400}
    >>> base = {"sensor": camera, "sea": {"resolve_waves": False}, "objects": [boat]}
    >>> laws = [{"key": "wind.speed_m_s", "law": "choice", "values": [3.0]}]
    >>> study = {"ensemble": {"scenes": 1}, "base": base, "vary": laws}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     rows = sg.ensemble(study, f"{folder}/many")
    ...     data = sg.dataset(f"{folder}/many", f"{folder}/data")
    ...     (data / "annotations.json").exists()
    True
    """
    from seaglint.formats.dataset.dataset_writing import problems
    from seaglint.studies.ensemble.ensemble_dataset import ensemble_dataset, read_source

    given = path_of(source, "source")
    if check:
        faults = list(problems(given))
        if faults:
            raise DataError("\n".join(f"{given}: {fault}" for fault in faults))
        return given
    if output is None:
        raise DataError("output is missing: the folder of the data set; give one, or check=True for a data set that is there")
    request = DatasetRequest(format=format, bits=bits, image=image, scale=scale, limits=limits, clip=clip, masks=masks, min_snr=min_snr)
    resolved, options = read_source(given), request.options()
    with team_of(workers, threads) as others:
        ensemble_dataset(resolved, output, options, workers=others, threads=threads, resume=resume, overwrite=overwrite, progress=progress)
    return Path(output)
