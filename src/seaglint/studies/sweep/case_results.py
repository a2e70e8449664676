"""Results of one case of a sweep: one quantity of one scenario as named arrays.

``computer`` returns the function of a quantity. Mean radiance and air are computed for a picture's pixels or at view angles. Scenarios
of a sweep share views of a sea: air, water and slopes are prepared once for all Suns over them.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.air.protocol import Atmosphere
from seaglint.base.conventions import FloatArray, horizon_depression, surface_range, view_zenith
from seaglint.base.errors import DataError
from seaglint.base.free_form import Attributes
from seaglint.facet.sea_view import SeaView
from seaglint.facet.surface_spectra import SeaSurface
from seaglint.optics.band import Band, apparent_temperature
from seaglint.radiance.article import article_radiance
from seaglint.radiance.mean_radiance import SeaLines
from seaglint.radiance.variance import sea_variance
from seaglint.scenario.model import Scenario
from seaglint.scenario.records.atmosphere_table import FileAtmosphere
from seaglint.scenario.sun import sun_position
from seaglint.store.provenance import band_attributes
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.scenario_physics import require_standard_refraction
from seaglint.studies.mean.mean_map import MAPS
from seaglint.studies.study_requests import QUANTITIES
from seaglint.studies.sweep.sweep_plan import ATTRIBUTES, AZIMUTH, ZENITH, ViewAngles

MOST_CACHED: Final = 64  #: Largest number of cached views: some 5 MB each.

_SUNLESS: Final = {"band", "wind", "sea", "atmosphere", "mean", "platform"}  #: Tables that a view without its Sun depends on.

_CACHED_VIEWS: Final[OrderedDict[str, SharedView]] = OrderedDict()
_LOCK: Final = threading.Lock()


@dataclass(frozen=True, eq=False)
class NamedArray:
    """Array with the names of its dimensions and its attributes."""

    dims: tuple[str, ...]
    values: NDArray[Any]
    attributes: Attributes = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class CaseResult:
    """Result of one case."""

    variables: dict[str, NamedArray]  #: Arrays of results by name.
    coordinates: dict[str, NamedArray] = field(default_factory=dict)  #: Arrays of coordinates by name.
    attributes: Attributes = field(default_factory=dict)  #: Attributes of the whole.

    @property
    def size(self) -> int:
        """Bytes of all arrays."""
        return sum(array.values.nbytes for arrays in (self.variables, self.coordinates) for array in arrays.values())


@dataclass(eq=False)
class SharedView:
    """View of a sea, and its lines of sight prepared so far."""

    view: SeaView  #: View with the Sun of the scenario that was the first.
    _surface: SeaSurface | None = None
    _lines: dict[Any, SeaLines] = field(default_factory=dict)

    def under(self, scenario: Scenario) -> SeaView:
        """Return the view under Sun and Moon of a scenario."""
        return scenario_physics.under(self.view, scenario_physics.lights(scenario))

    def lines(self, view: SeaView, elevation: FloatArray, azimuth: FloatArray) -> SeaLines:
        """Return lines of sight of ``under`` at elevations and azimuths [rad]."""
        # Lines depend on directions and slopes, not on the Sun.
        key = (elevation.tobytes(), azimuth.tobytes(), view.lights[0].hiding.law_bands(view.slopes))
        if key not in self._lines:
            if self._surface is None:
                self._surface = SeaSurface.create(view.atmosphere, view.water, view.sea_temperature, view.in_band.grid)
            self._lines[key] = SeaLines.prepare(view, elevation, azimuth, self._surface)
        return self._lines[key]


def forget_views() -> None:
    """Remove all cached views, because their files may have changed."""
    with _LOCK:
        _CACHED_VIEWS.clear()


def shared_view(scenario: Scenario, height: float) -> SharedView:
    """Return the view of a scenario from a height [m], from an earlier one that differs in nothing but the Sun and the picture."""
    key = _key(scenario, height)
    with _LOCK:
        if key in _CACHED_VIEWS:
            _CACHED_VIEWS.move_to_end(key)
            return _CACHED_VIEWS[key]
    # Preparation runs outside the lock; two threads may prepare the same view, and the last one is cached.
    new_view = SharedView(scenario_physics.standing_view(scenario, height))
    with _LOCK:
        _CACHED_VIEWS[key] = new_view
        while len(_CACHED_VIEWS) > MOST_CACHED:
            _CACHED_VIEWS.popitem(last=False)
    return new_view


def _key(scenario: Scenario, height: float) -> str:
    tables = set(_SUNLESS)
    if isinstance(scenario.atmosphere, FileAtmosphere):
        tables |= {"sensor"}  # its columns are chosen by the sea in view
    text = scenario.model_dump_json(include=tables, exclude_none=True)
    if '"sounding"' in text or '"path"' in text:  # files are read at a date and a place
        text += scenario.model_dump_json(include={"time", "place"}, exclude_none=True)
    return f"{height!r} {text}"


def mean_at(scenario: Scenario, at: ViewAngles) -> CaseResult:
    """Return mean radiance, its components and apparent temperature at view angles.

    Each value belongs to a line of sight, as in the mean map at the middle of a pixel in that direction. The deviation of glint is for a
    pixel with the solid angle of the middle pixel of the picture. A moving sensor is at its place of time 0.

    Raises
    ------
    SeaglintError
        A condition outside the models, or refraction by the profile.
    """
    require_standard_refraction(scenario)
    pose, imager = scenario_physics.track(scenario).at(0.0), scenario_physics.imager(scenario)
    shared = shared_view(scenario, pose.height)
    view = shared.under(scenario)
    elevation = at.elevations(pose.height)
    azimuth = np.array([pose.attitude.azimuth]) if at.azimuth_deg is None else np.radians(np.array(at.azimuth_deg))
    if scenario.mean.mode == "article":
        view = scenario_physics.article_view(scenario, view)
        components = article_radiance(view, elevation, azimuth)
    else:
        components = shared.lines(view, elevation, azimuth).under(view)
    # The deviation of glint depends on the size of a pixel, which view angles do not have.
    pixel = float(imager.solid_angle(pose.attitude, 0.5 * imager.columns, 0.5 * imager.rows))
    variance = sea_variance(view, components, elevation, np.full(elevation.size, pixel), scenario_physics.glint_correlation(scenario))
    temperature = apparent_temperature(components.total, view.band, view.atmosphere.wavenumber_cm)
    values = (components.total, temperature, components.path, components.emission, components.sky, components.sunlight, np.sqrt(variance))
    shape = (elevation.size, azimuth.size)
    variables = {
        name: NamedArray(at.dims, _shaped(value, shape, at))
        for name, value in zip(("radiance", "apparent_temperature", *MAPS), values, strict=True)
    }
    return CaseResult(variables, _coordinates(at), band_attributes(view.band))


def _shaped(values: FloatArray, shape: tuple[int, int], at: ViewAngles) -> FloatArray:
    whole = np.broadcast_to(values, shape)
    return np.array(whole[:, 0] if at.azimuth_deg is None else whole)


def _coordinates(at: ViewAngles) -> dict[str, NamedArray]:
    angles = {ZENITH: at.zenith_deg, AZIMUTH: at.azimuth_deg}
    return {name: NamedArray((name,), np.array(v), dict(ATTRIBUTES[name])) for name, v in angles.items() if v is not None}


def air_at(scenario: Scenario, at: ViewAngles) -> CaseResult:
    """Return transmittance and thermal radiance of the paths to the sea at view angles, with the sky and sunlight over it.

    Raises
    ------
    SeaglintError
        A condition outside the models.
    """
    if at.azimuth_deg is not None:
        raise DataError(f"at: the air between sea and sensor does not depend on {AZIMUTH}; give {ZENITH} alone with what = 'atmosphere'")
    height = scenario_physics.track(scenario).at(0.0).height
    return _air(scenario, height, at.elevations(height), np.radians(np.array(at.zenith_deg)), (ZENITH,), _coordinates(at))


def air_of_rows(scenario: Scenario) -> CaseResult:
    """Return the results of ``air_at`` for the rows of an upright picture; NaN for rows without sea.

    Raises
    ------
    SeaglintError
        A picture whose rows are not level, or a condition outside the models.
    """
    camera = scenario_physics.camera(scenario)
    elevation = np.asarray(camera.elevations)
    rows = NamedArray(("y",), np.degrees(elevation))
    return _air(scenario, camera.height, elevation, view_zenith(camera.height, -elevation), ("y",), {"elevation": rows})


def _air(
    scenario: Scenario, height: float, elevation: FloatArray, zenith: FloatArray, dims: tuple[str, ...], coordinates: dict[str, NamedArray]
) -> CaseResult:
    over: Band = scenario_physics.band(scenario)
    air: Atmosphere = shared_view(scenario, height).view.atmosphere
    weights = over.weights(air.wavenumber_cm)
    sea = (-elevation > horizon_depression(height)) & np.isfinite(zenith)
    # Rows above the horizon have no path to the sea and remain NaN.
    tau, path, sky = (np.full(elevation.size, np.nan) for _ in range(3))
    if sea.any():
        arc = surface_range(height, -elevation[sea])
        tau[sea] = air.transmittance(height, arc) @ weights / weights.sum()
        path[sea] = air.path_radiance(height, arc) @ weights
        sky[sea] = air.sky_radiance(zenith[sea], np.zeros(zenith[sea].size)) @ weights
    # Sunlight at the sea depends on the Sun alone, so it is one number for all angles.
    sun = sun_position(scenario)
    light = float(sun.irradiance_factor * (np.asarray(air.solar_irradiance(np.array([sun.zenith])))[0] @ weights))

    def named(values: FloatArray, long_name: str, units: str = "W m-2 sr-1") -> NamedArray:
        return NamedArray(dims, values, {"long_name": long_name, "units": units})

    sunlight = {"long_name": "in-band sunlight at the sea, normal to the beam", "units": "W m-2"}
    return CaseResult(
        {
            "transmittance": named(tau, "transmittance of the path to the sea, flat mean over the band in wavenumber", "1"),
            "thermal_path_radiance": named(path, "in-band thermal radiance of the path to the sea"),
            "thermal_sky_radiance": named(sky, "in-band thermal radiance of the sky over the sea, at the same zenith angle"),
            "sun_irradiance": NamedArray((), np.array(light), sunlight),
        },
        coordinates,
        band_attributes(over),
    )


Compute = Callable[[Scenario], CaseResult]  #: Function that computes the result of a scenario.


def computer(what: str | Callable[[Scenario], Any], at: ViewAngles | None) -> Compute:
    """Return the function that computes a quantity.

    Parameters
    ----------
    what : str or callable
        One of ``QUANTITIES``, or a function of a scenario.
    at : ViewAngles, optional
        View angles instead of the picture's pixels.

    Raises
    ------
    DataError
        An unknown quantity, or view angles for a quantity that has none.
    """
    if callable(what):
        if at is not None:
            raise DataError("at: view angles go with mean and atmosphere; a function of a scenario has its own, leave `at` out")
        return lambda scenario: of_any(what(scenario))
    if what not in QUANTITIES:
        raise DataError(f"what = '{what}' is not one of {', '.join(QUANTITIES)}; give one of them")
    if at is not None and what not in ("mean", "atmosphere"):
        raise DataError(f"at: view angles go with mean and atmosphere, not with what = '{what}'; leave `at` out")
    if at is None:
        return {**_COMPUTERS, "atmosphere": air_of_rows}[what]

    chosen = mean_at if what == "mean" else air_at
    return lambda scenario: chosen(scenario, at)


def of_dataset(dataset: Any) -> CaseResult:
    """Return the arrays of an xarray.Dataset."""

    def arrays(part: Mapping[Any, Any]) -> dict[str, NamedArray]:
        return {str(name): NamedArray(tuple(map(str, a.dims)), np.asarray(a.values), dict(a.attrs)) for name, a in part.items()}

    return CaseResult(arrays(dataset.data_vars), arrays(dataset.coords), dict(dataset.attrs))


def of_any(value: Any) -> CaseResult:
    """Return the arrays of the result of a user's function.

    Raises
    ------
    DataError
        A value that is no number, text, mapping of them, or array of xarray.

    Examples
    --------
    >>> of_any({"mean": 2.0, "name": "a"}).variables["mean"].values.item()
    2.0
    """
    import xarray as xr

    if isinstance(value, xr.Dataset):
        return of_dataset(value)
    if isinstance(value, xr.DataArray):
        return of_dataset(value.to_dataset(name=str(value.name or "value")))
    named = value if isinstance(value, Mapping) else {"value": value}
    out = {}
    for name, item in named.items():
        if isinstance(item, xr.DataArray):
            out[str(name)] = NamedArray(tuple(map(str, item.dims)), np.asarray(item.values), dict(item.attrs))
            continue
        # Arrays without names of dimensions cannot be joined over the cases.
        array = np.asarray(item)
        if array.ndim or array.dtype.kind not in "biufcU":
            raise DataError(
                f"the function returned {type(item).__name__} for '{name}'; return a number, numbers by name, or arrays of xarray, which "
                "name their dimensions"
            )
        out[str(name)] = NamedArray((), array)
    return CaseResult(out)


def _mean(scenario: Scenario) -> CaseResult:
    from seaglint.studies.mean.mean_map import mean

    return of_dataset(mean(scenario))


def _image(scenario: Scenario) -> CaseResult:
    from seaglint.studies.sequence.labelled_frames import image

    return of_dataset(image(scenario, 0.0, scenario.render.layers))


def _sensor(scenario: Scenario) -> CaseResult:
    """Return the numbers of the data sheet; numbers of its tables have names ``table_name``."""
    from seaglint.studies.mean.sensor_figures import describe_sensor

    out: dict[str, NamedArray] = {}

    def walk(table: Mapping[str, Any], above: str) -> None:
        for name, value in table.items():
            key = f"{above}_{name}" if above else name
            if isinstance(value, Mapping):
                walk(value, key)
            elif value is None or isinstance(value, int | float):
                out[key] = NamedArray((), np.array(np.nan if value is None else value, dtype=np.float64))

    walk(describe_sensor(scenario).sheet.as_dict(), "")
    return CaseResult(out)


def _likelihood(scenario: Scenario) -> CaseResult:
    from seaglint.studies.likelihood.glint_chance import likelihood

    summary = likelihood(scenario).summary()
    rows = summary.results

    def column(values: list[float], long_name: str, units: str = "1") -> NamedArray:
        return NamedArray(("threshold",), np.array(values, dtype=np.float64), {"long_name": long_name, "units": units})

    return CaseResult(
        {
            "probability": column([row.probability for row in rows], summary.quantity),
            "probability_low": column([row.interval[0] for row in rows], "lower end of the 95 % interval of the probability"),
            "probability_high": column([row.interval[1] for row in rows], "upper end of the 95 % interval of the probability"),
            "sun_up": NamedArray((), np.array(summary.sun_up.share), {"long_name": "share of the draws with the Sun up", "units": "1"}),
        },
        {"threshold": column([row.threshold_w_m2_sr for row in rows], "threshold of the radiance of glint", "W m-2 sr-1")},
        {"notes": "\n".join(summary.notes)} if summary.notes else {},
    )


_COMPUTERS: Final[dict[str, Compute]] = {"mean": _mean, "image": _image, "sensor": _sensor, "likelihood": _likelihood}
