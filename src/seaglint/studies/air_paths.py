"""Air along single lines of sight: paths from the sensor of a scenario, its sky, and paths through even air, as datasets.

Even air has one temperature and pressure along the whole path.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.coordinates import lowest_height
from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.homogeneous_path import homogeneous_spectrum
from seaglint.air.protocol import slant_range
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.errors import DataError
from seaglint.optics.band import Band, apparent_temperature
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.radiance.mean_radiance import mean_radiance
from seaglint.scenario.model import Scenario
from seaglint.store.provenance import band_attributes, provenance
from seaglint.studies.build import scenario_physics

if TYPE_CHECKING:
    import xarray as xr

    from seaglint.air.profile.band_laws import Spectroscopy


SPECTRAL_UNIT = "W m-2 sr-1 per cm-1"  #: Unit of spectral radiance.


def path_air(scenario: Scenario, range_m: ArrayLike, target_height_m: ArrayLike = 0.0) -> xr.Dataset:
    """Return transmittance and thermal radiance of the paths from the sensor to points.

    Parameters
    ----------
    scenario : Scenario
        Air, band, height of the sensor (at the start, where it moves) and temperature of the water.
    range_m : array_like
        Arcs along the sea from the foot of the sensor to the foot of the point [m, (ranges,)].
    target_height_m : array_like
        Heights of the point above the mean sea [m, (heights,)]; 0 is the sea.

    Returns
    -------
    xarray.Dataset
        Over ``target_height_m`` and ``range_m``: ``transmittance`` [1], the mean over the band weighted with the blackbody at the water's
        temperature; ``path_radiance`` [W m-2 sr-1]; ``slant_range`` and ``lowest_height`` [m]; and over ``wavenumber_cm`` both as spectra.
        Where ``lowest_height`` is below 0 the sea hides the point, and the numbers belong to a line through the water.

    Raises
    ------
    DomainError
        A negative range, or a line deep below the sea.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> air = path_air(parse_scenario({"band": {"min_um": 8.0, "max_um": 12.0}}), [1000.0, 5000.0])
    >>> air.transmittance.dims, bool(air.transmittance[0, 0] > air.transmittance[0, 1])
    (('target_height_m', 'range_m'), True)
    """
    import xarray as xr

    band, height = scenario_physics.band(scenario), scenario_physics.track(scenario).at(0.0).height
    air = scenario_physics.atmosphere(scenario, band)
    arcs, heights = _axis(range_m, "range_m"), _axis(target_height_m, "target_height_m")
    transmittance = np.stack([np.minimum(air.transmittance(height, arcs, target), 1.0) for target in heights])
    radiance = np.stack([np.maximum(air.path_radiance(height, arcs, target), 0.0) for target in heights])
    slant = slant_range(height, arcs, heights[:, None])
    lowest = lowest_height(height, np.broadcast_to(heights[:, None], slant.shape), slant)
    nu = air.wavenumber_cm
    # The mean weights each wavenumber with the light of the water, whose contrast the path attenuates.
    glow = planck_wavenumber(nu, scenario.sea.temperature_k)
    mean = _in_band(transmittance * glow, band, nu) / _in_band(glow, band, nu)
    dims = ("target_height_m", "range_m")
    per_cm = {"units": SPECTRAL_UNIT, "long_name": "thermal radiance of the path"}
    return xr.Dataset(
        {
            "transmittance": (dims, mean, {"units": "1", "long_name": "mean transmittance, weighted with the blackbody of the water"}),
            "path_radiance": (dims, _in_band(radiance, band, nu), {"units": "W m-2 sr-1", "long_name": "thermal radiance of the path"}),
            "lowest_height": (dims, lowest, {"units": "m", "long_name": "lowest height of the path; below 0 the sea hides the point"}),
            "slant_range": (dims, slant, {"units": "m", "long_name": "length of the path"}),
            "spectral_transmittance": ((*dims, "wavenumber_cm"), transmittance, {"units": "1"}),
            "spectral_path_radiance": ((*dims, "wavenumber_cm"), radiance, per_cm),
        },
        {
            "target_height_m": ("target_height_m", heights, {"units": "m"}),
            "range_m": ("range_m", arcs, {"units": "m", "long_name": "arc along the sea"}),
            "wavenumber_cm": ("wavenumber_cm", nu, {"units": "cm-1"}),
        },
        _about(scenario, band, height, "Air along paths from the sensor"),
    )


def sky_air(scenario: Scenario, zenith_deg: ArrayLike, azimuth_deg: ArrayLike | None = None) -> xr.Dataset:
    """Return radiance and apparent temperature of the sky as the sensor sees it.

    Parameters
    ----------
    scenario : Scenario
        Air, band, Sun and height of the sensor (at the start, where it moves).
    zenith_deg : array_like
        Zenith angles looked at [deg, (angles,)], from 0 to the horizon.
    azimuth_deg : array_like, optional
        Azimuths looked at, clockwise from north [deg, (azimuths,)]; by default the sensor's azimuth.

    Returns
    -------
    xarray.Dataset
        Over ``zenith_deg`` and ``azimuth_deg``: ``radiance`` [W m-2 sr-1], its parts ``thermal_radiance`` and ``scattered_radiance``
        (sunlight scattered by the air), ``apparent_temperature`` [K], and over ``wavenumber_cm``
        ``spectral_thermal_radiance``.

    Raises
    ------
    DataError
        A direction below the horizon.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> sky = sky_air(parse_scenario({"band": {"min_um": 8.0, "max_um": 12.0}}), [0.0, 80.0])
    >>> bool(sky.apparent_temperature[0, 0] < sky.apparent_temperature[1, 0])
    True
    """
    import xarray as xr

    band, height = scenario_physics.band(scenario), scenario_physics.track(scenario).at(0.0).height
    air = scenario_physics.atmosphere(scenario, band)
    angles = _axis(zenith_deg, "zenith_deg")
    azimuths = _axis(scenario.sensor.azimuth_deg if azimuth_deg is None else azimuth_deg, "azimuth_deg")
    lowest = 90.0 + float(np.degrees(horizon_depression(height)))
    beyond = ~((angles >= 0.0) & (angles <= lowest + 1e-9))
    if beyond.any():
        raise DataError(f"zenith_deg = {angles[beyond][0]:g} is not in the sky, which ends at {lowest:.3f} deg; give angles of 0 to that")
    view = scenario_physics.standing_view(scenario, height)
    # The whole radiance includes scattered sunlight; the thermal part alone comes from the air's spectra.
    whole = mean_radiance(view, 0.5 * np.pi - np.radians(angles), np.radians(azimuths)).total
    zenith, toward = np.meshgrid(np.radians(angles), np.radians(azimuths), indexing="ij")
    nu = air.wavenumber_cm
    spectra = np.broadcast_to(np.maximum(air.sky_radiance(zenith, toward, height), 0.0), (*zenith.shape, nu.size))
    thermal = _in_band(spectra, band, nu)
    # Scattered sunlight is never negative: differences below 0 are errors of the two sums.
    sums = {"radiance": whole, "thermal_radiance": thermal, "scattered_radiance": np.maximum(whole - thermal, 0.0)}
    names = {"radiance": "radiance of the sky", "thermal_radiance": "emission of the air", "scattered_radiance": "scattered sunlight"}
    dims = ("zenith_deg", "azimuth_deg")
    return xr.Dataset(
        {
            **{name: (dims, values, {"units": "W m-2 sr-1", "long_name": names[name]}) for name, values in sums.items()},
            "apparent_temperature": (dims, apparent_temperature(sums["radiance"], band, nu), {"units": "K"}),
            "spectral_thermal_radiance": ((*dims, "wavenumber_cm"), spectra, {"units": SPECTRAL_UNIT}),
        },
        {
            "zenith_deg": ("zenith_deg", angles, {"units": "degree", "long_name": "zenith angle looked at, from the sensor"}),
            "azimuth_deg": ("azimuth_deg", azimuths, {"units": "degree", "long_name": "azimuth clockwise from north"}),
            "wavenumber_cm": ("wavenumber_cm", nu, {"units": "cm-1"}),
        },
        _about(scenario, band, height, "Clear sky from the sensor"),
    )


def _axis(values: ArrayLike, name: str) -> FloatArray:
    """Return numbers of an axis as a one-dimensional array."""
    try:
        axis = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError):
        raise DataError(f"{name} = {values!r} is no number and no list of numbers; give e.g. 1000 or [500, 1000, 5000]") from None
    if axis.ndim != 1 or axis.size == 0 or not np.isfinite(axis).all():
        raise DataError(f"{name} has the shape {axis.shape}, or values that are not finite; give one number or a list of numbers")
    return axis


def _in_band(spectra: FloatArray, band: Band, wavenumber_cm: FloatArray) -> FloatArray:
    """Return in-band radiance [W m-2 sr-1] of spectra."""
    return np.asarray(spectra @ band.weights(wavenumber_cm))


def _about(scenario: Scenario, band: Band, height: float, title: str) -> dict[str, Any]:
    from seaglint.store.netcdf import plain_attributes

    about = provenance(title, scenario.model_dump_json(exclude_none=True), scenario.seed, sensor_height_m=height)
    return plain_attributes({**about, **band_attributes(band)})


def require_one_kind(scenario: bool, ranges: bool, even: Mapping[str, Any]) -> None:
    """Refuse parameters of both kinds of path, or of neither.

    Raises
    ------
    DataError
        A scenario without ranges, ranges without a scenario, numbers of even air beside a scenario, or too few of them.
    """
    # First the names of given numbers of even air, then the names of missing ones.
    given, missing = ([name for name, value in even.items() if (value is not None) == present] for present in (True, False))
    if scenario and given:
        raise DataError(f"{', '.join(given)}: describe even air, and a scenario is given; leave them out, or leave the scenario out")
    if scenario != ranges:
        raise DataError(
            "range_m is missing: the distances of a scenario's paths in metres; give it, e.g. 1000,5000"
            if scenario
            else "range_m needs a scenario, whose air the paths go through; give one, or describe even air"
        )
    if not scenario and missing:
        raise DataError(f"{', '.join(missing)} missing: a path through even air needs them; give them, or a scenario with range_m")


def even_path(
    numbers: Mapping[str, float | None],
    band_um: tuple[float, float] | None,
    ppmv: Mapping[str, float],
    spectroscopy: Spectroscopy,
    haze: str,
) -> xr.Dataset:
    """Return the transmittance of a path through even air.

    Parameters
    ----------
    numbers : mapping
        ``temperature_k`` [K], ``pressure_hpa``, ``vapour_pressure_hpa`` [hPa] and ``length_km`` [km].
    band_um : (float, float)
        Shortest and longest wavelength [um].
    ppmv : mapping
        Gases [1e-6 of the volume of dry air].
    spectroscopy, haze : str
        Absorption, and aerosol at the sea.

    Returns
    -------
    xarray.Dataset
        ``transmittance`` [1], weighted with the blackbody at the temperature, and ``spectral_transmittance`` over ``wavenumber_cm``.

    Raises
    ------
    DomainError
        A number outside its range.
    """
    import xarray as xr

    path = cast("Mapping[str, float]", numbers)
    band = cast("tuple[float, float]", band_um)
    spectrum = homogeneous_spectrum(**path, band_um=band, ppmv=dict(ppmv), spectroscopy=spectroscopy, haze=HazeWeather(haze))
    return xr.Dataset(
        {
            "transmittance": ((), spectrum.mean, {"units": "1", "long_name": "mean transmittance, weighted with the blackbody"}),
            "spectral_transmittance": ("wavenumber_cm", spectrum.transmittance, {"units": "1"}),
        },
        {"wavenumber_cm": ("wavenumber_cm", spectrum.wavenumber_cm, {"units": "cm-1"})},
        {**path, "band_um": list(band), **{f"{gas.lower()}_ppmv": amount for gas, amount in ppmv.items()}, "spectroscopy": spectroscopy},
    )
