"""Mean radiance of the sea, and the air before it, at view angles instead of a picture's pixels."""

from __future__ import annotations

import numpy as np

from seaglint.air.protocol import Atmosphere
from seaglint.base.conventions import FloatArray, horizon_depression, surface_range, view_zenith
from seaglint.base.errors import DataError
from seaglint.files.provenance import band_attributes
from seaglint.optics.band import Band, apparent_temperature
from seaglint.radiance.article import article_radiance
from seaglint.radiance.variance import sea_variance
from seaglint.scenario.model import Scenario
from seaglint.scenario.sun import sun_position
from seaglint.studies.mean.mean_pixels import MAPS
from seaglint.studies.prepare import prepare
from seaglint.studies.prepare.refraction import require_standard_refraction
from seaglint.studies.sweep.case_arrays import CaseResult, NamedArray
from seaglint.studies.sweep.shared_views import shared_view
from seaglint.studies.sweep.view_angles import ATTRIBUTES, AZIMUTH, ZENITH, ViewAngles


def mean_at(scenario: Scenario, at: ViewAngles) -> CaseResult:
    """Return mean radiance, its components and apparent temperature at view angles.

    Each value is that of a line of sight, as the mean map has it in the middle of a pixel that looks that way. The deviation of glint is
    that of a pixel as large as the one in the middle of the picture. A moving sensor stands where it is at time 0.

    Raises
    ------
    SeaglintError
        A condition outside the models, or refraction by the profile.
    """
    require_standard_refraction(scenario)
    pose, imager = prepare.track(scenario).at(0.0), prepare.imager(scenario)
    shared = shared_view(scenario, pose.height)
    view = shared.under(sun_position(scenario))
    elevation, azimuth = at.elevations(pose.height), _azimuths(at, pose.attitude.azimuth)
    if scenario.mean.mode == "article":
        view = prepare.article_view(scenario, view)
        seen = article_radiance(view, elevation, azimuth)
    else:
        seen = shared.lines(view, elevation, azimuth).under(view)
    pixel = float(imager.solid_angle(pose.attitude, 0.5 * imager.columns, 0.5 * imager.rows))
    variance = sea_variance(view, seen, elevation, np.full(elevation.size, pixel), prepare.glint_length(scenario))
    temperature = apparent_temperature(seen.total, view.band, view.atmosphere.wavenumber_cm)
    values = (seen.total, temperature, seen.path, seen.emission, seen.sky, seen.sun, np.sqrt(variance))
    shape = (elevation.size, azimuth.size)
    variables = {
        name: NamedArray(at.dims, _shaped(value, shape, at))
        for name, value in zip(("radiance", "apparent_temperature", *MAPS), values, strict=True)
    }
    return CaseResult(variables, _coordinates(at), band_attributes(view.band))


def _azimuths(at: ViewAngles, own: float) -> FloatArray:
    return np.array([own]) if at.azimuth_deg is None else np.radians(np.array(at.azimuth_deg))


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
    height = prepare.track(scenario).at(0.0).height
    zenith = np.radians(np.array(at.zenith_deg))
    return _air(scenario, height, at.elevations(height), zenith, (ZENITH,), _coordinates(at))


def air_of_rows(scenario: Scenario) -> CaseResult:
    """Return the same for the rows of an upright picture; NaN where they see no sea.

    Raises
    ------
    SeaglintError
        A picture whose rows are not level, or a condition outside the models.
    """
    camera = prepare.camera(scenario)
    elevation = np.asarray(camera.elevations)
    rows = NamedArray(("y",), np.degrees(elevation))
    return _air(scenario, camera.height, elevation, view_zenith(camera.height, -elevation), ("y",), {"elevation": rows})


def _air(
    scenario: Scenario, height: float, elevation: FloatArray, zenith: FloatArray, dims: tuple[str, ...], coordinates: dict[str, NamedArray]
) -> CaseResult:
    over: Band = prepare.band(scenario)
    air: Atmosphere = shared_view(scenario, height).view.atmosphere
    weights = over.weights(air.wavenumber_cm)
    sea = (-elevation > horizon_depression(height)) & np.isfinite(zenith)
    tau, path, sky = (np.full(elevation.size, np.nan) for _ in range(3))
    if sea.any():
        arc = surface_range(height, -elevation[sea])
        tau[sea] = air.transmittance(height, arc) @ weights / weights.sum()
        path[sea] = air.path_radiance(height, arc) @ weights
        sky[sea] = air.sky_radiance(zenith[sea], np.zeros(zenith[sea].size)) @ weights
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
