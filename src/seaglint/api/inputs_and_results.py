"""Inputs and results of the functions of ``import seaglint as sg``.

Inputs are accepted in several forms: scenarios, recordings, radiances and bands, each with its conversion here. Results without axes are
a :class:`ResultRecord`: numbers and text by name, a picture, and HTML for a notebook.
"""

from __future__ import annotations

import inspect
import reprlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import fields, replace
from operator import index
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeVar

from seaglint.base.errors import DataError, ScenarioError

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from seaglint.analysis import Recording
    from seaglint.cluster import Workers
    from seaglint.optics.band import Band
    from seaglint.scenario.model import Scenario
    from seaglint.studies.study_requests import ReadingRequest

    SceneInput = Scenario | str | Path | Mapping[str, Any]
Record = TypeVar("Record")

AXES = ("time", "y", "x")  #: Names of the last axes of an array without names.


def scenario_of(given: SceneInput, sensor: str | None = None) -> Scenario:
    """Return the scenario of a file or of tables in a mapping; a scenario is returned unchanged.

    Raises
    ------
    ScenarioError
        A file or tables with mistakes, an object of another type, or an unknown ``sensor``, the name of a data sheet that replaces the
        scenario's sensor.
    """
    from seaglint.scenario.load import load_scenario, parse_scenario
    from seaglint.scenario.model import Scenario
    from seaglint.scenario.presets import with_sensor
    from seaglint.scenario.text.toml_writing import stated

    given = scene_input(given)
    if isinstance(given, str | Path):
        return load_scenario(given, sensor=sensor)
    if isinstance(given, Scenario) and sensor is None:
        return given
    tables = stated(given) if isinstance(given, Scenario) else dict(given)
    return parse_scenario(tables if sensor is None else with_sensor(tables, sensor))


def scene_input(given: SceneInput) -> SceneInput:
    """Return a scenario, its file or its tables, with NumPy's numbers in tables as plain ones; refuse objects of other types.

    Raises
    ------
    ScenarioError
        Any other object.
    """
    from seaglint.scenario.model import Scenario

    if isinstance(given, Scenario | str | Path):
        return given
    if isinstance(given, Mapping):
        tables: dict[str, Any] = _plain(given)
        return tables
    raise ScenarioError(f"scenario = {_described(given)}; give the path of a TOML file, its tables in a mapping, or what sg.load returns")


def _plain(value: Any) -> Any:
    """Return tables and lists with NumPy's numbers and arrays as Python's."""
    import numpy as np

    if isinstance(value, Mapping):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value


def path_of(given: str | Path, name: str) -> Path:
    """Return the path that a parameter holds.

    Raises
    ------
    DataError
        An object of another type.
    """
    if isinstance(given, str | Path):
        return Path(given)
    raise DataError(f"{name} = {_described(given)}; give a path")


def paths_of(given: str | Path | Sequence[str | Path], name: str) -> list[Path]:
    """Return the paths that a parameter holds, one or more.

    Raises
    ------
    DataError
        An object of another type.
    """
    if isinstance(given, str | bytes | Path | Mapping) or not isinstance(given, Iterable):
        return [path_of(given, name)]
    return [path_of(one, f"{name}[{place}]") for place, one in enumerate(given)]


def _described(given: object) -> str:
    """Return an object in a few words of one line, with its type."""
    return f"{' '.join(reprlib.repr(given).split())[:60]} is of type {type(given).__name__}"


def team_of(workers: int | Workers | None, threads: int | None = None) -> AbstractContextManager[Workers | None]:
    """Return the workers that share the work: processes of this machine for a number, other workers unchanged.

    Raises
    ------
    DataError
        An object of another type.
    """
    from seaglint.cluster import LocalProcesses

    try:
        # Numbers of NumPy are numbers too.
        return LocalProcesses(index(workers), threads=threads)  # type: ignore[arg-type]
    except TypeError:
        if workers is None or hasattr(workers, "map"):
            return nullcontext(workers)  # type: ignore[arg-type]
        raise DataError(f"workers = {_described(workers)}; give a number of processes, or workers") from None


def request_of(record: type[Record], values: Mapping[str, Any], **others: Any) -> Record:
    """Return a request with the fields that are among some values, and others."""
    names = {field.name for field in fields(record)}  # type: ignore[arg-type]
    return record(**{name: value for name, value in values.items() if name in names} | others)


def arguments_of(function: Callable[..., Any], values: Mapping[str, Any], **others: Any) -> dict[str, Any]:
    """Return the arguments of a function that are among some values, and others."""
    names = inspect.signature(function).parameters
    return {name: value for name, value in values.items() if name in names} | others


def recording_of(given: Any, reading: ReadingRequest) -> Recording:
    """Return the recording to analyse, from a file or from memory, read as requested."""
    import numpy as np
    import xarray as xr

    from seaglint.analysis import Recording
    from seaglint.formats.recording.arrays import ArrayFacts, ArrayReading, of_array
    from seaglint.formats.recording.labelled_arrays import of_dataset

    if isinstance(given, str | Path):
        return reading.opened(given)
    how = ArrayReading(reading.variable, reading.channel, reading.axes, tuple(reading.missing))
    if isinstance(given, xr.DataArray):
        given = given.to_dataset(name=str(given.name or "values"))
    if isinstance(given, xr.Dataset):
        # Recordings have time as their first axis; a dataset may have it anywhere.
        ordered = given.transpose("time", ...) if "time" in given.dims else given
        recording = of_dataset(ordered, "dataset", how)
    elif isinstance(given, Recording):
        recording = given
    else:
        recording = of_array(np.asarray(given), "array", how, ArrayFacts(frame_rate=reading.frame_rate, units=reading.units))
    # Values that the user states replace those of the recording; values left out (None) do not.
    stated: dict[str, Any] = {"frame_rate": reading.frame_rate, "units": reading.units, "saturation": reading.saturation}
    return replace(recording, **{name: value for name, value in stated.items() if value is not None})


def kelvin_of(radiance: Any, band: Band | tuple[float, float] | None) -> xr.DataArray:
    """Return the apparent temperature [K] of radiance in any accepted form."""
    import numpy as np
    import xarray as xr

    from seaglint.air.protocol import wavenumber_grid
    from seaglint.base.schema import VARIABLES
    from seaglint.optics.band import Band
    from seaglint.optics.band import apparent_temperature as kelvin
    from seaglint.store.stored_images import radiance_of

    if isinstance(radiance, xr.Dataset):
        given = radiance_of(radiance)
        attributes = {**radiance.attrs, **given.attrs}
    elif isinstance(radiance, xr.DataArray):
        given, attributes = radiance, radiance.attrs
    else:
        values = np.asarray(radiance)
        given, attributes = xr.DataArray(values, dims=AXES[3 - values.ndim :] if values.ndim <= 3 else None), {}
    over = band if isinstance(band, Band) else band_of(attributes) if band is None else Band.rectangular(*band)
    grid = wavenumber_grid(over.min_um, over.max_um)
    # Single precision remains single; whole numbers become double.
    kind = given.dtype if given.dtype.kind == "f" else np.dtype(np.float64)

    def converted(values: NDArray[Any]) -> NDArray[np.floating[Any]]:
        return kelvin(values, over, grid).astype(kind)

    result = xr.apply_ufunc(converted, given, dask="parallelized", output_dtypes=[kind], keep_attrs=True)
    out: xr.DataArray = result.rename("apparent_temperature")
    return out.assign_attrs(VARIABLES["apparent_temperature"].attributes)


def band_of(attributes: Mapping[Any, Any]) -> Band:
    """Return the spectral band that the attributes of a file state."""
    from seaglint.store.provenance import stored_band

    try:
        return stored_band(attributes)
    except KeyError:
        text = "no band given, and none in the attributes (band_wavelength_um and band_response)"
        raise DataError(f"{text}; give band=(min_um, max_um), or a seaglint dataset instead of its variable") from None


def with_band(dataset: xr.Dataset) -> xr.Dataset:
    """Return the dataset with the band attributes on every in-band radiance, so that each variable can be saved alone."""
    from seaglint.base.schema import VARIABLES
    from seaglint.store.netcdf import plain_attributes

    dataset.attrs = plain_attributes(dataset.attrs)
    # A variable that is saved alone loses the attributes of its dataset, which hold the band.
    band = {key: dataset.attrs[key] for key in ("band_wavelength_um", "band_response")}
    for name, variable in dataset.data_vars.items():
        if variable.attrs.get("units") == VARIABLES["radiance"].units:
            dataset[name].attrs = {**variable.attrs, **band}
    return dataset


SHORT: Final = 8  #: Largest number of values of a list that a notebook's table shows; ``as_dict()`` has all.


class ResultRecord(dict[str, Any]):
    """Numbers and text of a result by name, as the command prints them with ``--json``.

    Parameters
    ----------
    values : mapping
        Numbers, text, lists and mappings of them.
    draw : callable, optional
        Makes the picture of the result.
    html : callable, optional
        Makes what a notebook shows; without it the values as a table.
    title : str
        Heading of that table.

    Examples
    --------
    >>> record = ResultRecord({"netd_k": 0.02}, title="sensor")
    >>> record["netd_k"], record.as_dict()
    (0.02, {'netd_k': 0.02})
    """

    def __init__(
        self,
        values: Mapping[str, Any],
        *,
        draw: Callable[[], Figure] | None = None,
        html: Callable[[], str] | None = None,
        title: str = "result",
    ) -> None:
        super().__init__(values)
        self._draw, self._html, self._title = draw, html, title

    def as_dict(self) -> dict[str, Any]:
        """Return the values as a plain dictionary, which JSON can hold."""
        return dict(self)

    def plot(self) -> Figure:
        """Draw the result.

        Raises
        ------
        DataError
            A result that has no picture.
        """
        if self._draw is None:
            raise DataError(f"the {self._title} has no picture; its numbers are in as_dict()")
        return self._draw()

    def __repr__(self) -> str:
        """Return the values, with long lists and text shortened."""
        short = reprlib.Repr()
        short.maxlevel, short.maxdict, short.maxlist, short.maxtuple, short.maxstring, short.maxother = 3, 40, SHORT, SHORT, 120, 120
        return short.repr(dict(self))

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows."""
        if self._html is not None:
            return self._html()
        from seaglint.base.representation import card, table

        return card(self._title, table(("name", "value"), list(_rows("", self))))


def _rows(name: str, value: Any) -> Any:
    """Yield names and values of a result; inner mappings have dotted names; curves, tables and the scenario are left out."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            if key != "scenario":
                yield from _rows(f"{name}.{key}" if name else str(key), inner)
    elif not isinstance(value, list | tuple) or (len(value) <= SHORT and not any(isinstance(item, Mapping | list) for item in value)):
        yield name, value
