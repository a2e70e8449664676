"""Functions of ``import seaglint as sg``: from a scenario file to labelled images and their clutter.

.. code-block:: python

    import seaglint as sg

    scene = sg.load("my.toml")
    mean = sg.mean(scene)  # xarray.Dataset: radiance and its parts
    run = sg.render(scene, "run.zarr")  # xarray.Dataset: radiance over time, y, x
    kelvin = sg.apparent_temperature(run.radiance.isel(time=0))
    print(sg.analyze(run).as_dict()["regions"]["glint"]["std"])

Each is a few lines over the rooms below, which have more to choose: :mod:`seaglint.scenario`, :mod:`seaglint.studies`,
:mod:`seaglint.analysis`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seaglint.api.judging import detect as detect
from seaglint.api.many import dataset as dataset
from seaglint.api.many import ensemble as ensemble

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import ArrayLike, NDArray

    from seaglint.analysis import Analysis, Recording
    from seaglint.base.conventions import Progress
    from seaglint.cluster import Workers
    from seaglint.files.export.stack import Exported
    from seaglint.optics.band import Band
    from seaglint.scenario.model import Scenario


def load(source: str | Path | Mapping[str, Any]) -> Scenario:
    """Read and check a scenario.

    Parameters
    ----------
    source : path or mapping
        A TOML file, or its content as tables in a mapping.

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
    from seaglint.scenario.load import load_scenario, parse_scenario

    return parse_scenario(source) if isinstance(source, Mapping) else load_scenario(source)


def mean(scenario: Scenario) -> xr.Dataset:
    """Mean radiance over the field of view, its parts, apparent temperature and the standard deviation of glint.

    Parameters
    ----------
    scenario : Scenario
        See :func:`load`.

    Returns
    -------
    xarray.Dataset
        Maps (y, x) with units, coordinates and provenance, as ``seaglint mean`` writes them; radiances [W m-2 sr-1].

    Raises
    ------
    SeaglintError
        A condition outside the models; see :mod:`seaglint.studies.prepare.prepare`.

    Examples
    --------
    >>> import seaglint as sg
    >>> found = sg.mean(sg.load({"sensor": {"pixels": [8, 4]}}))
    >>> found.radiance.dims, found.radiance.units
    (('y', 'x'), 'W m-2 sr-1')
    """
    from seaglint.api.inputs import with_band
    from seaglint.files.netcdf import labelled
    from seaglint.studies.mean.mean_map import mean as computed

    return with_band(labelled(computed(scenario)))


def image(scenario: Scenario, time: float = 0.0, layers: Collection[str] = ()) -> xr.Dataset:
    """Image at one time, without a file.

    Parameters
    ----------
    scenario : Scenario
        See :func:`load`; its ``render.layers`` are left aside.
    time : float
        Time from the start [s]; any, frames are not more than instants.
    layers : collection of str
        Images to be there beside the radiance, of :data:`seaglint.base.schema.LAYERS`: the radiance's four parts, distance and slope of
        the sea, the share of a pixel that it fills, that of glint in the radiance, the number of the object in it.

    Returns
    -------
    xarray.Dataset
        ``radiance`` [W m-2 sr-1, (y, x)] and the layers, with units, coordinates and provenance. It is the frame that :func:`render`
        writes for this time.

    Raises
    ------
    SeaglintError
        A condition outside the models, a time outside the platform's track, or an unknown layer.

    Notes
    -----
    Each call prepares everything; for many times take :func:`seaglint.studies.sequence.render_sequence.prepare_sequence`, ``at(time)``.

    Examples
    --------
    >>> import seaglint as sg
    >>> scene = sg.load({"sensor": {"pixels": [8, 4]}, "sea": {"resolve_waves": False}})
    >>> found = sg.image(scene, time=0.5, layers=["range"])
    >>> found["range"].units, float(found.time)
    ('m', 0.5)
    """
    from seaglint.api.inputs import with_band
    from seaglint.files.netcdf import labelled
    from seaglint.studies.sequence.image import image as drawn

    return with_band(labelled(drawn(scenario, time, layers)))


def render(
    scenario: Scenario,
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
) -> xr.Dataset:
    """Render a sequence into a Zarr store and open it.

    Parameters
    ----------
    scenario : Scenario
        See :func:`load`.
    output : path
        Store to make, customarily ``*.zarr``.
    frames : range, optional
        Frames to render, counted from 0; all of the scenario's by default.
    threads : int, optional
        Processor threads; all by default. The bytes do not depend on them.
    resume, overwrite : bool
        Go on with an unfinished store, or replace what is there.
    progress : callable, optional
        Called with (frames done, frames in all).
    electrons, radiance : bool
        Write electrons, and the radiance at the aperture, beside counts, for a scenario with a detector.
    workers : int or Workers, optional
        Number of processes on this machine that share the frames, or what :func:`seaglint.cluster.dask.connected` gives.

    Returns
    -------
    xarray.Dataset
        The finished store: ``radiance`` [W m-2 sr-1, (time, y, x)], of a scenario with a detector ``signal`` [counts], and what the
        scenario's ``render.layers`` name. Frames are read when they are used.

    Raises
    ------
    SeaglintError
        A condition outside the models, an existing store, or a full disk.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> scene = sg.load({"sensor": {"pixels": [8, 4], "frames": 3}, "sea": {"resolve_waves": False}})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sg.render(scene, f"{folder}/run.zarr").radiance.shape
    (3, 4, 8)
    """
    from seaglint.api.inputs import with_band
    from seaglint.cluster import LocalProcesses
    from seaglint.files.store.store import open_sequence
    from seaglint.studies.sequence.sensed import render as written

    common: dict[str, Any] = {
        "electrons": electrons,
        "radiance": radiance,
        "resume": resume,
        "overwrite": overwrite,
        "progress": progress,
    }
    with LocalProcesses(workers, threads=threads) if isinstance(workers, int) else nullcontext(workers) as others:
        path = written(scenario, output, frames=frames, threads=threads if workers is None else None, workers=others, **common)
    return with_band(open_sequence(path))


def export(
    run: xr.Dataset | str | Path,
    output: str | Path,
    *,
    variable: str | None = None,
    frames: range | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
    **options: Any,
) -> Exported:
    """Write frames of a run for another program; the ending of ``output`` is the format.

    Parameters
    ----------
    run : xarray.Dataset or path
        Result of :func:`render` or a part of it, or a finished store.
    output : path
        ``.nc``, ``.h5``, ``.tif``, ``.fits``, ``.npy``, ``.raw`` (the last two with a JSON header beside them), ``.mp4`` or ``.gif``.
    variable : str, optional
        Images to export; ``signal`` if there, else ``radiance``.
    frames : range, optional
        Numbers of the frames, counted in the whole sequence.
    overwrite : bool
        Replace what is there.
    progress : callable, optional
        Called with (frames done, frames in all).
    **options
        ``dtype`` and ``limits`` of numbers; ``colours``, ``limits``, ``rate`` and ``scale`` of videos; see
        :func:`seaglint.plot.run_export.export_run`.

    Returns
    -------
    Exported
        Files, shape and type of the numbers, scale and offset of counts.

    Raises
    ------
    SeaglintError
        A format, variable, frames or options that cannot be, an unfinished run, a file that is there already, no room.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> scene = sg.load({"sensor": {"pixels": [8, 4], "frames": 3}, "sea": {"resolve_waves": False}})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sg.export(sg.render(scene, f"{folder}/run.zarr"), f"{folder}/run.tif", dtype="uint16", limits=(0.0, 2.0)).shape
    (3, 4, 8)
    """
    from seaglint.files.store.store import open_sequence
    from seaglint.plot.run_export import export_run

    opened = open_sequence(run) if isinstance(run, str | Path) else run
    return export_run(opened, output, variable=variable, frames=frames, overwrite=overwrite, progress=progress, **options)


def sense(
    radiance: xr.Dataset | xr.DataArray | NDArray[Any] | str | Path,
    scenario: Scenario,
    output: str | Path | None = None,
    *,
    seed: int | None = None,
    oversampling: int | None = None,
    electrons: bool = False,
    frame_rate: float | None = None,
    overwrite: bool = False,
) -> xr.Dataset:
    """Put a scenario's sensor on radiance at the aperture.

    Parameters
    ----------
    radiance : xarray.Dataset, xarray.DataArray, ndarray or path
        In-band radiance [W m-2 sr-1, (time, y, x) or (y, x)], or a file of it.
    scenario : Scenario
        With ``[sensor.optics]`` and ``[sensor.detector]``; its ``band`` is that of the radiance.
    output : path, optional
        Zarr store to write and open; without it the counts are made in memory.
    seed : int, optional
        Seed of the noise; the scenario's by default.
    oversampling : int, optional
        Pixels of the radiance along each side of the detector's; found from the coordinates of a dataset, else 1.
    electrons : bool
        Whether electrons are there beside counts.
    frame_rate : float, optional
        Frames per second [Hz], where the radiance does not tell it; the scenario's by default.
    overwrite : bool
        Replace the store that is there.

    Returns
    -------
    xarray.Dataset
        ``signal`` [counts, uint16, (time, y, x)], ``electrons`` if requested, ``saturated_share``; :func:`apparent_temperature` takes it.

    Raises
    ------
    SeaglintError
        No sensor, a picture that the oversampling does not divide, values that are no radiances.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> tables = {"optics": {"aperture_m": 0.05, "f_number": 4.0}, "detector": {"pitch_um": 15.0}, "noise": {"temporal": False}}
    >>> found = sg.sense(np.full((2, 24, 24), 1.5), sg.load({"sensor": tables}), oversampling=3)
    >>> found.signal.shape, round(float(sg.apparent_temperature(found).mean()), 2)
    ((2, 8, 8), 295.03)
    """
    import xarray as xr

    from seaglint.api.inputs import recording_of, with_band
    from seaglint.files.recording import open_recording
    from seaglint.files.recording.image_attributes import Source, source_of
    from seaglint.files.store.store import open_sequence
    from seaglint.studies.sequence.sense import prepare_sense, sensed_dataset
    from seaglint.studies.sequence.sense import sense as written

    if isinstance(radiance, str | Path):
        opened, known = open_recording(radiance, frame_rate=frame_rate), source_of(Path(radiance))
    else:
        labelled = radiance.to_dataset(name="radiance") if isinstance(radiance, xr.DataArray) else radiance
        known = Source.of(labelled) if isinstance(labelled, xr.Dataset) else None
        opened = recording_of(labelled, frame_rate, None, None)
    if output is not None:
        path = written(
            opened, scenario, output, source=known, seed=seed, oversampling=oversampling, electrons=electrons, overwrite=overwrite
        )
        return with_band(open_sequence(path))
    frames, layout = prepare_sense(opened, scenario, source=known, seed=seed, oversampling=oversampling, electrons=electrons)
    return sensed_dataset(frames, layout)


def sensor(scenario: Scenario) -> dict[str, Any]:
    """Figures of merit of a scenario's sensor, as ``seaglint sensor --json`` prints them.

    Parameters
    ----------
    scenario : Scenario
        With ``[sensor.optics]`` and ``[sensor.detector]``.

    Returns
    -------
    dict
        ``netd_k``, ``sitf_counts_per_k``, ``nei_w_m2``, ``nep_w``, ``mtf`` with its parts, the noise budget for the mean of the scene,
        ``dynamic_range_db``, ``saturation_temperature_k``, 3-D noise and what the conversion to photons costs.

    Raises
    ------
    SeaglintError
        No sensor, or a scene that cannot be computed.

    Examples
    --------
    >>> import seaglint as sg
    >>> tables = {"optics": {"aperture_m": 0.05, "f_number": 4.0}, "detector": {"pitch_um": 15.0, "well_capacity_e": 7e6}}
    >>> found = sg.sensor(sg.load({"sensor": {**tables, "frame_rate_hz": 100}}))
    >>> round(found["electrons_per_count"], 2)
    106.81
    """
    from seaglint.studies.mean.sensor_figures import describe_sensor

    return describe_sensor(scenario)


def analyze(
    recording: xr.Dataset | xr.DataArray | NDArray[Any] | str | Path | Recording,
    *,
    frame_rate: float | None = None,
    units: str | None = None,
    variable: str | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> Analysis:
    """Clutter statistics and false alarms, by region.

    Parameters
    ----------
    recording : xarray.Dataset, xarray.DataArray, ndarray, path or Recording
        What :func:`render` gives or a part of it, an array (rows, columns) or (frames, rows, columns), or a file of any format that
        :func:`seaglint.files.recording.open_recording` reads.
    frame_rate : float, optional
        Frames per second [Hz], where attributes and time coordinate do not tell it or tell it wrong.
    units : str, optional
        Units of the values, likewise.
    variable : str, optional
        Which image of several; ``radiance`` by default.
    progress : callable, optional
        Called with (frames read, frames to read in all).
    **options
        Fields of :class:`seaglint.analysis.AnalysisOptions`. ``filter`` and ``detectors`` may be names, as on the command line.

    Returns
    -------
    Analysis
        The regions' numbers, ``as_dict()`` of them for a file, and what :mod:`seaglint.plot.analysis_report` writes a report of.

    Raises
    ------
    DataError
        An option that there is not, or a recording that holds no images or nothing finite.

    Examples
    --------
    >>> import numpy as np, seaglint as sg
    >>> frames = np.random.default_rng(1).normal(1.0, 0.1, (20, 32, 32))
    >>> found = sg.analyze(frames, frame_rate=25.0, thresholds=[4.0], filter="none")
    >>> round(found.regions["all"].moments.std, 2)
    0.1
    """
    from seaglint.analysis import analyze as analysed
    from seaglint.api.inputs import options_of, recording_of

    resolved = options_of(options)
    opened = recording_of(recording, frame_rate, units, variable)
    return analysed(opened, resolved) if progress is None else analysed(opened, resolved, progress)


def apparent_temperature(radiance: xr.Dataset | xr.DataArray | ArrayLike, band: Band | tuple[float, float] | None = None) -> xr.DataArray:
    """Temperature of the blackbody whose radiance in the band is that of each pixel.

    Parameters
    ----------
    radiance : xarray.Dataset, xarray.DataArray or array_like
        In-band radiance [W m-2 sr-1], or a dataset that holds it as ``radiance``, or counts as ``signal``.
    band : Band or (float, float), optional
        Spectral band that it is integrated over, or the edges of a rectangular one [um]; what the attributes say by default.

    Returns
    -------
    xarray.DataArray
        Kelvin, same shape, coordinates and other attributes; NaN for radiances of no temperature between 100 and 6500 K.

    Raises
    ------
    DataError
        No band given, and none in the attributes.

    Examples
    --------
    >>> import seaglint as sg
    >>> round(float(sg.apparent_temperature(1.45, band=(3.0, 5.0))), 1)
    293.2
    """
    from seaglint.api.inputs import kelvin_of

    return kelvin_of(radiance, band)
