"""The functions of ``import seaglint as sg``: from a scenario file to labelled images and their clutter.

.. code-block:: python

    import seaglint as sg

    scene = sg.load("my.toml")
    mean = sg.mean(scene)  # xarray.Dataset: radiance and its parts
    run = sg.render(scene, "run.zarr")  # xarray.Dataset: radiance over time, y, x
    kelvin = sg.apparent_temperature(run.radiance.isel(time=0))
    print(sg.analyze(run).as_dict()["regions"]["glint"]["std"])

Each is a few lines over the rooms below, which have more to choose: :mod:`seaglint.scenario`, :mod:`seaglint.pipeline`,
:mod:`seaglint.analysis`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
    from numpy.typing import ArrayLike, NDArray

    from seaglint.analysis import Analysis, Options, Recording
    from seaglint.io.export import Exported
    from seaglint.io.store import Progress
    from seaglint.optics.band import Band
    from seaglint.scenario.model import Scenario

AXES = ("time", "y", "x")
"""Names of the last axes of an array that has none."""


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
        What the models do not cover; see :mod:`seaglint.pipeline.prepare`.

    Examples
    --------
    >>> import seaglint as sg
    >>> found = sg.mean(sg.load({"sensor": {"pixels": [8, 4]}}))
    >>> found.radiance.dims, found.radiance.units
    (('y', 'x'), 'W m-2 sr-1')
    """
    from seaglint.io.netcdf import labelled
    from seaglint.pipeline.mean import mean as computed

    return _with_band(labelled(computed(scenario)))


def image(scenario: Scenario, time: float = 0.0, layers: Collection[str] = ()) -> xr.Dataset:
    """Image at one time, without a file.

    Parameters
    ----------
    scenario : Scenario
        See :func:`load`; its ``render.layers`` are left aside.
    time : float
        Time from the start [s]; any, frames are not more than instants.
    layers : collection of str
        Images to be there beside the radiance, of :data:`seaglint.schema.LAYERS`: the radiance's four parts, the distance of the sea, the
        share of a pixel that it fills.

    Returns
    -------
    xarray.Dataset
        ``radiance`` [W m-2 sr-1, (y, x)] and the layers, with units, coordinates and provenance. It is the frame that :func:`render`
        writes for this time.

    Raises
    ------
    SeaglintError
        What the models do not cover, a time outside the platform's track, a layer that there is not.

    Notes
    -----
    Everything is prepared anew at every call. For many times take :func:`seaglint.pipeline.render.prepare_sequence` and its ``at(time)``.

    Examples
    --------
    >>> import seaglint as sg
    >>> scene = sg.load({"sensor": {"pixels": [8, 4]}, "sea": {"resolve_waves": False}})
    >>> found = sg.image(scene, time=0.5, layers=["range"])
    >>> found["range"].units, float(found.time)
    ('m', 0.5)
    """
    from seaglint.io.netcdf import labelled
    from seaglint.pipeline.image import image as drawn

    return _with_band(labelled(drawn(scenario, time, layers)))


def render(
    scenario: Scenario,
    output: str | Path,
    *,
    frames: range | None = None,
    threads: int | None = None,
    resume: bool = False,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Render a sequence into a Zarr store and open it.

    Parameters
    ----------
    scenario : Scenario
        See :func:`load`.
    output : path
        Store to make, customarily ``*.zarr``.
    frames : range, optional
        Frames wanted, counted from 0; all of the scenario's by default.
    threads : int, optional
        Processor threads; all by default. The bytes do not depend on them.
    resume, overwrite : bool
        Go on with an unfinished store, or replace what is there.
    progress : callable, optional
        Called with (frames done, frames in all).

    Returns
    -------
    xarray.Dataset
        The finished store: ``radiance`` [W m-2 sr-1, (time, y, x)] and what the scenario's ``render.layers`` name. Frames are read when
        they are used.

    Raises
    ------
    SeaglintError
        What the models do not cover, a store that is there already, no room.

    Examples
    --------
    >>> import seaglint as sg, tempfile
    >>> scene = sg.load({"sensor": {"pixels": [8, 4], "frames": 3}, "sea": {"resolve_waves": False}})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     sg.render(scene, f"{folder}/run.zarr").radiance.shape
    (3, 4, 8)
    """
    from seaglint.io.store import open_sequence
    from seaglint.pipeline.render import render as written

    path = written(scenario, output, frames=frames, threads=threads, resume=resume, overwrite=overwrite, progress=progress)
    return _with_band(open_sequence(path))


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
        What :func:`render` gives or a part of it, or a finished store.
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
        :func:`seaglint.plot.export.export_run`.

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
    from seaglint.io.store import open_sequence
    from seaglint.plot.export import export_run

    opened = open_sequence(run) if isinstance(run, str | Path) else run
    return export_run(opened, output, variable=variable, frames=frames, overwrite=overwrite, progress=progress, **options)


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
        :func:`seaglint.io.recording.open_recording` reads.
    frame_rate : float, optional
        Frames per second [Hz], where attributes and time coordinate do not tell it or tell it wrong.
    units : str, optional
        Units of the values, likewise.
    variable : str, optional
        Which image of several; ``radiance`` by default.
    progress : callable, optional
        Called with (frames read, frames to read in all).
    **options
        Fields of :class:`seaglint.analysis.Options`. ``filter`` and ``detectors`` may be names, as on the command line.

    Returns
    -------
    Analysis
        The regions' numbers, ``as_dict()`` of them for a file, and what :mod:`seaglint.plot.report` writes a report of.

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

    wanted = _options(options)
    opened = _recording(recording, frame_rate, units, variable)
    return analysed(opened, wanted) if progress is None else analysed(opened, wanted, progress)


def apparent_temperature(radiance: xr.Dataset | xr.DataArray | ArrayLike, band: Band | tuple[float, float] | None = None) -> xr.DataArray:
    """Temperature of the blackbody whose radiance in the band is that of each pixel.

    Parameters
    ----------
    radiance : xarray.Dataset, xarray.DataArray or array_like
        In-band radiance [W m-2 sr-1], or a dataset that holds it as ``radiance``.
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
    import numpy as np
    import xarray as xr

    from seaglint.atmosphere.base import wavenumber_grid
    from seaglint.optics.band import Band
    from seaglint.optics.band import apparent_temperature as kelvin
    from seaglint.schema import VARIABLES

    if isinstance(radiance, xr.Dataset):
        given, attributes = _radiance_of(radiance), {**radiance.attrs, **radiance["radiance"].attrs}
    elif isinstance(radiance, xr.DataArray):
        given, attributes = radiance, radiance.attrs
    else:
        values = np.asarray(radiance)
        given, attributes = xr.DataArray(values, dims=AXES[3 - values.ndim :] if values.ndim <= 3 else None), {}
    over = band if isinstance(band, Band) else _band_of(attributes) if band is None else Band.rectangular(*band)
    grid = wavenumber_grid(over.min_um, over.max_um)
    kind = given.dtype if given.dtype.kind == "f" else np.dtype(np.float64)

    def converted(values: NDArray[Any]) -> NDArray[np.floating[Any]]:
        return kelvin(values, over, grid).astype(kind)

    found = xr.apply_ufunc(converted, given, dask="parallelized", output_dtypes=[kind], keep_attrs=True)
    out: xr.DataArray = found.rename("apparent_temperature")
    return out.assign_attrs(VARIABLES["apparent_temperature"].attributes)


def _radiance_of(dataset: xr.Dataset) -> xr.DataArray:
    from seaglint.errors import DataError

    if "radiance" not in dataset:
        found = ", ".join(map(str, dataset.data_vars)) or "none"
        raise DataError(
            f"the dataset has no variable 'radiance' (it has: {found}); give the variable itself, e.g. dataset['path_radiance']"
        )
    return dataset["radiance"]


def _band_of(attributes: Mapping[Any, Any]) -> Band:
    from seaglint.errors import DataError
    from seaglint.io.provenance import stored_band

    try:
        return stored_band(attributes)
    except KeyError:
        text = "no band given, and none in the attributes (band_wavelength_um and band_response)"
        raise DataError(f"{text}; give band=(min_um, max_um), or a seaglint dataset instead of its variable") from None


def _with_band(dataset: xr.Dataset) -> xr.Dataset:
    """The same with the band at every in-band radiance too, so that a variable is complete without its dataset, ready for any file."""
    from seaglint.io.netcdf import plain_attributes
    from seaglint.schema import VARIABLES

    dataset.attrs = plain_attributes(dataset.attrs)
    band = {key: dataset.attrs[key] for key in ("band_wavelength_um", "band_response")}
    for name, variable in dataset.data_vars.items():
        if variable.attrs.get("units") == VARIABLES["radiance"].units:
            dataset[name].attrs = {**variable.attrs, **band}
    return dataset


def _options(given: Mapping[str, Any]) -> Options:
    """Fields of the record; filters and detectors by name, sequences as tuples, masks as plain arrays."""
    from typing import get_args

    import numpy as np

    from seaglint.analysis import Options
    from seaglint.analysis.run import Border
    from seaglint.clutter import filters
    from seaglint.clutter.thresholds import Scope
    from seaglint.detection import choice
    from seaglint.errors import DataError

    known = [field.name for field in fields(Options)]
    for name in given:
        if name not in known:
            raise DataError(f"option '{name}' is not one of {', '.join(known)}; leave it out or give one of them")
    for name, allowed in (("scope", get_args(Scope)), ("border", get_args(Border))):
        if name in given and given[name] not in allowed:
            raise DataError(f"{name} = {given[name]!r} is not one of {', '.join(allowed)}; give one of them or leave it out")
    out: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in given.items()}
    if isinstance(out.get("filter"), str):
        out["filter"] = filters.named(out["filter"])
    if "detectors" in out:
        wanted = (out["detectors"],) if isinstance(out["detectors"], str) else out["detectors"]
        out["detectors"] = tuple(choice.named(d) if isinstance(d, str) else d for d in wanted)
    if out.get("mask") is not None:
        out["mask"] = np.asarray(out["mask"], dtype=np.bool_)
    return Options(**out)


def _recording(given: Any, frame_rate: float | None, units: str | None, variable: str | None) -> Recording:
    """What is analysed, from a file or from memory."""
    from dataclasses import replace

    import numpy as np
    import xarray as xr

    from seaglint.analysis import Recording
    from seaglint.io.recording import open_recording
    from seaglint.io.recording.arrays import Reading, of_array, of_dataset

    if isinstance(given, str | Path):
        return open_recording(given, frame_rate=frame_rate, units=units, variable=variable)
    if isinstance(given, xr.DataArray):
        given = given.to_dataset(name=str(given.name or "values"))
    if isinstance(given, xr.Dataset):
        ordered = given.transpose("time", ...) if "time" in given.dims else given
        found = of_dataset(ordered, "dataset", Reading(variable))
    elif isinstance(given, Recording):
        found = given
    else:
        found = of_array(np.asarray(given), "array", Reading(), frame_rate=frame_rate, units=units)
    return replace(found, frame_rate=frame_rate or found.frame_rate, units=units or found.units)
