"""Functions of sequences in stores: ``sg.render``, ``sg.sense`` with its ``sg.sensor``, and ``sg.export``."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from seaglint.base.parameters import documented
from seaglint.studies.sequence.sequence_requests import ExportRequest, RenderRequest, SenseRequest

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from seaglint.base.conventions import Progress
    from seaglint.cluster import Workers
    from seaglint.files.export.stack import Exported
    from seaglint.scenario.model import Scenario


@documented(RenderRequest)
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
    progress : callable, optional
        Called with (frames done, frames in all).
    {request}

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

    with LocalProcesses(workers, threads=threads) if isinstance(workers, int) else nullcontext(workers) as others:
        path = written(
            scenario,
            output,
            frames=frames,
            electrons=electrons,
            radiance=radiance,
            threads=threads if workers is None else None,
            workers=others,
            resume=resume,
            overwrite=overwrite,
            progress=progress,
        )
    return with_band(open_sequence(path))


@documented(ExportRequest, videos="videos")
def export(
    run: xr.Dataset | str | Path,
    output: str | Path,
    *,
    variable: str | None = None,
    frames: range | None = None,
    dtype: Literal["uint16", "float32"] | None = None,
    limits: tuple[float, float] | None = None,
    colours: Literal["white-hot", "black-hot", "perceptual"] | None = None,
    rate: float | None = None,
    scale: Literal["auto", "linear", "log"] | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Exported:
    """Write frames of a run for another program; the ending of ``output`` is the format.

    Parameters
    ----------
    run : xarray.Dataset or path
        Result of :func:`render` or a part of it, or a finished store.
    output : path
        ``.nc``, ``.h5``, ``.tif``, ``.fits``, ``.npy``, ``.raw`` (the last two with a JSON header beside them), ``.mp4`` or ``.gif``.
    {request}
    progress : callable, optional
        Called with (frames done, frames in all).

    Returns
    -------
    Exported
        Files, shape and type of the numbers, scale and offset of counts.

    Raises
    ------
    SeaglintError
        A format, variable, frames or settings that cannot be, an unfinished run, a file that is there already, no room.

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
    return export_run(
        opened,
        output,
        variable=variable,
        frames=frames,
        dtype=dtype,
        limits=limits,
        colours=colours,
        rate=rate,
        scale=scale,
        overwrite=overwrite,
        progress=progress,
    )


@documented(SenseRequest, INPUT="the radiance")
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
    {request}

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

    return describe_sensor(scenario).as_dict()
