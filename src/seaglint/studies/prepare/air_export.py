"""The air of a scenario as a file that ``atmosphere.source = "file"`` reads: to start one's own from, or to keep."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seaglint.air.coordinates import elevation_of_coordinate
from seaglint.air.protocol import slant_range
from seaglint.air.scattering.scattered_tables import ScatteredLight, scattered_in
from seaglint.air.sky_spline import grazing_share
from seaglint.base.conventions import FloatArray, horizon_depression, horizon_range
from seaglint.base.errors import ScenarioError
from seaglint.files.modtran.lines import AZIMUTHS
from seaglint.files.provenance import provenance
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import atmosphere_table as wanted_air
from seaglint.scenario.sun import sun_position
from seaglint.studies.prepare import prepare

if TYPE_CHECKING:
    import xarray as xr

PATH_NODES: Final = 64
SKY_NODES: Final = 48
DIP_NODES: Final = 24  #: Nodes along the paths, of sky and Sun from the horizontal up, and of the sky from there down to the sea horizon.

_AZIMUTH: Final = "azimuth_from_sun_deg"

HIGHEST_CREST: Final = 30.0  #: Paths reach to where the sensor sees waves of this height stand above the horizon [m].


def export_air(scenario: Scenario) -> xr.Dataset:
    """Spectra of the scenario's air at nodes, in the layout of :mod:`seaglint.files.air.air_file`.

    Radiance is in W m-2 sr-1 per cm-1, irradiance in W m-2 per cm-1 for the Sun at 1 au.

    Raises
    ------
    ScenarioError
        The scenario's air is a file already.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> air = export_air(parse_scenario({"band": {"min_um": 3.9, "max_um": 4.0}}))
    >>> air.path_transmittance.dims, float(air.range_m[0])
    (('range_m', 'wavenumber_cm'), 0.0)
    """
    import xarray as xr

    if isinstance(scenario.atmosphere, wanted_air.FileAtmosphere):
        raise ScenarioError(
            f"atmosphere.source = 'file': {scenario.atmosphere.path} is such a file already; copy it, or choose another source to export"
        )
    air, height = prepare.atmosphere(scenario, prepare.band(scenario)), scenario.sensor.height_m
    arc = _arcs(height)
    above = elevation_of_coordinate(np.linspace(0.0, 1.0, SKY_NODES), 0.0)
    zenith = 90.0 - np.degrees(np.minimum(above, 0.5 * np.pi))[::-1]
    below = np.degrees(horizon_depression(height) * grazing_share(np.linspace(0.0, 1.0, DIP_NODES)[1:]))
    from_sensor = np.concatenate([zenith, 90.0 + below])
    spectra = {
        "path_transmittance": ("range_m", np.minimum(air.transmittance(height, arc), 1.0)),
        "path_radiance": ("range_m", air.path_radiance(height, arc)),
        "sun_irradiance": ("sun_zenith_deg", air.solar_irradiance(np.radians(zenith))),
        "sky_radiance": ("sky_zenith_deg", air.sky_radiance(np.radians(zenith), 0.0)),
        "sensor_sky_radiance": ("sensor_sky_zenith_deg", air.sky_radiance(np.radians(from_sensor), 0.0, height)),
    }
    attributes = provenance(
        "Air between sea and sensor", scenario.model_dump_json(exclude_none=True), scenario.seed, sensor_height_m=height
    )
    variables: dict[str, Any] = {
        name: ((node, "wavenumber_cm"), np.maximum(values, 0.0), {"units": _unit(name)}) for name, (node, values) in spectra.items()
    }
    azimuths = {}
    sun = sun_position(scenario).zenith
    light = scattered_in(air, slice(0, air.wavenumber_cm.size), np.ones(air.wavenumber_cm.size), height, sun)
    if isinstance(light, ScatteredLight) and not light.is_dark and sun < 0.5 * np.pi and prepare.scatters(scenario):
        azimuth = np.radians(AZIMUTHS)
        lit = {
            "path_scattered": ("range_m", light.path_spectra(arc, azimuth)),
            "sky_scattered": ("sky_zenith_deg", light.sky_spectra(np.radians(zenith), azimuth, 0.0)),
            "sensor_sky_scattered": ("sensor_sky_zenith_deg", light.sky_spectra(np.radians(from_sensor), azimuth, height)),
        }
        variables |= {
            name: ((node, _AZIMUTH, "wavenumber_cm"), np.maximum(values, 0.0), {"units": _unit(name)})
            for name, (node, values) in lit.items()
        }
        azimuths, attributes = {_AZIMUTH: np.array(AZIMUTHS)}, {**attributes, "solar_zenith_deg": float(np.degrees(sun))}
    return xr.Dataset(
        variables,
        coords={
            "range_m": arc,
            "wavenumber_cm": air.wavenumber_cm,
            "sun_zenith_deg": zenith,
            "sky_zenith_deg": zenith,
            "sensor_sky_zenith_deg": from_sensor,
            **azimuths,
        },
        attrs=attributes,
    )


def _unit(name: str) -> str:
    return {"path_transmittance": "1", "sun_irradiance": "W m-2 per cm-1"}.get(name, "W m-2 sr-1 per cm-1")


def _arcs(height: float) -> FloatArray:
    """Arcs [m] from the sensor's foot to behind the horizon, even in the logarithm of the slant path."""
    last = horizon_range(height) + horizon_range(HIGHEST_CREST)
    fine = np.concatenate([[0.0], np.geomspace(1e-3 * height, last, 4000)])
    x = np.log(slant_range(height, fine) / height)
    arc = np.interp(np.linspace(0.0, x[-1], PATH_NODES), x, fine)
    arc[0], arc[-1] = 0.0, last
    return np.asarray(arc)
