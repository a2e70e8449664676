"""Files of the air of a scenario: its spectra for ``atmosphere.source = "file"``, and decks for MODTRAN or LOWTRAN7.

A file of spectra can be edited, or stored beside a scenario. A deck has the lines of sight that the scenario needs.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from seaglint.air.coordinates import elevation_of_coordinate
from seaglint.air.profile.absorber_densities import refractivity
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.band_laws import OwnGases
from seaglint.air.profile.bent_ray import RefractingAir
from seaglint.air.protocol import slant_range, wavenumber_grid
from seaglint.air.scattering.scattered_tables import ScatteredLight, scattered_in
from seaglint.air.sun_and_sky import grazing_share
from seaglint.base.constants import DARK_SUN
from seaglint.base.conventions import FloatArray, horizon_depression, horizon_range
from seaglint.base.errors import DomainError, ScenarioError
from seaglint.base.limits import LOWTRAN_HEIGHTS
from seaglint.base.reports import REPORTS
from seaglint.formats.lowtran.deck import STEP_CM, Aerosol, LowtranAir, ProfileLevel
from seaglint.formats.modtran.decks import AZIMUTHS, LOWTRAN7_CO2_PPMV, MANIFEST, Manifest, deck, json_deck, needed_lines
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import atmosphere_table as requested_air
from seaglint.scenario.sun import sun_position
from seaglint.store.outputs import made_folder, refuse_existing, write_text
from seaglint.store.provenance import provenance
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.profile_air import program_sounding, requested_gases

if TYPE_CHECKING:
    import xarray as xr


PATH_NODES: Final = 64
SKY_NODES: Final = 48
DIP_NODES: Final = 24  #: Nodes along the paths, of sky and Sun from the horizontal up, and of the sky from there down to the sea horizon.

_AZIMUTH: Final = "azimuth_from_sun_deg"

HIGHEST_CREST: Final = 30.0  #: Height of waves above the horizon that the longest paths reach [m].


def export_air(scenario: Scenario) -> xr.Dataset:
    """Return spectra of the scenario's air at nodes, in the layout of ``seaglint.formats.air_file``.

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

    if isinstance(scenario.atmosphere, requested_air.FileAtmosphere):
        raise ScenarioError(
            f"atmosphere.source = 'file': {scenario.atmosphere.path} is such a file already; copy it, or choose another source to export"
        )
    air, height = scenario_physics.atmosphere(scenario, scenario_physics.band(scenario)), scenario.sensor.height_m
    arc = _arcs(height)
    # Nodes are dense near the horizon, where the sky changes fastest with the angle.
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
    if isinstance(light, ScatteredLight) and not light.is_dark and sun < DARK_SUN and scenario_physics.scatters(scenario):
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
        # Scattered sunlight holds for one Sun, so its zenith angle is stored beside it.
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
    # The slant path has no simple inverse, so the arcs of even steps are interpolated from many arcs.
    fine = np.concatenate([[0.0], np.geomspace(1e-3 * height, last, 4000)])
    x = np.log(slant_range(height, fine) / height)
    arc = np.interp(np.linspace(0.0, x[-1], PATH_NODES), x, fine)
    # Interpolation may miss the two ends by rounding.
    arc[0], arc[-1] = 0.0, last
    return np.asarray(arc)


DeckFormat = Literal["tape5", "tape5-lowtran7", "modtran6-json"]

NAME: Final = "lines"

#: Name of the deck of each format.
DECKS: Final[dict[DeckFormat, str]] = {"tape5": f"{NAME}.tp5", "tape5-lowtran7": "TAPE5", "modtran6-json": f"{NAME}-input.json"}

#: File names in which the results of each format are searched.
OUTPUTS: Final[dict[DeckFormat, tuple[str, ...]]] = {
    "tape5": (f"{NAME}.tp7", "tape7", f"{NAME}.7sc", "tape7.scn"),
    "tape5-lowtran7": ("TAPE7", "tape7"),
    "modtran6-json": (f"{NAME}.json", f"{NAME}.csv"),
}

#: Wavenumber of the refractivity that bends the lines of sight [cm-1]: over the infrared it is equal to 1e-4.
REFRACTION_CM: Final = 2665.0


@dataclass(frozen=True)
class Decks:
    """Written decks and their manifest."""

    deck: Path
    cases: int
    solar_zenith_deg: float | None  #: Zenith angle of the Sun whose scattered light the cases include [deg]; None without.


def write_decks(scenario: Scenario, folder: Path, form: DeckFormat, *, scattered: bool = True, overwrite: bool = False) -> Decks:
    """Write a deck with all lines of sight, and the manifest of its cases, into a folder, which is made.

    Parameters
    ----------
    scenario : Scenario
        Sensor height, band, wind, Sun and atmosphere.
    folder : Path
        Place of the files.
    form : str
        ``tape5`` (MODTRAN 4 and 5), ``tape5-lowtran7`` or ``modtran6-json``.
    scattered : bool
        Request scattered sunlight too, if the Sun is up.
    overwrite : bool
        Replace files that are there.

    Raises
    ------
    ScenarioError
        The air is none that a code could compute.
    DataError, StorageError
        The folder or the files cannot be written.
    """
    air, height = _air(scenario), scenario.sensor.height_m
    low, high = LOWTRAN_HEIGHTS
    if not low <= height <= high:
        raise DomainError(
            f"sensor height = {height:g} m is outside {low:g}-{high:g} m; choose a height inside it",
            name="sensor_height",
            value=height,
            allowed=LOWTRAN_HEIGHTS,
        )
    zenith = sun_position(scenario).zenith
    lit = zenith if scattered and zenith <= 0.5 * np.pi else None
    lines = needed_lines(_refraction(air.model), height, lit, to_horizon=form == "tape5-lowtran7")
    solar_deg = None if lit is None else float(np.degrees(lit))
    co2 = _carbon_dioxide(scenario, form)
    if form == "modtran6-json":
        text = json_deck(lines, air, solar_deg, NAME, co2)
    else:
        text = deck(lines, air, solar_deg, modtran=form == "tape5", co2_ppmv=co2)
    manifest = Manifest(tuple(lines), height, solar_deg, OUTPUTS[form])
    made_folder(folder)
    # MODTRAN 5 reads the name of its deck from mod5root.in.
    contents = {DECKS[form]: text, MANIFEST: manifest.text()} | ({"mod5root.in": f"{NAME}\n"} if form == "tape5" else {})
    # All names are checked before the first file is written.
    for name in contents:
        refuse_existing(folder / name, overwrite=overwrite)
    for name, content in contents.items():
        write_text(content, folder / name)
    return Decks(folder / DECKS[form], len(lines), solar_deg)


def _carbon_dioxide(scenario: Scenario, form: str) -> float:
    """Return the carbon dioxide of the scenario [1e-6 of the volume]; report gases that decks cannot specify."""
    gases = OwnGases()
    if isinstance(scenario.atmosphere, requested_air.TableAtmosphereSettings | requested_air.LowtranAtmosphere):
        gases = requested_gases(scenario.atmosphere)
    co2 = LOWTRAN7_CO2_PPMV if gases.co2_ppmv is None else gases.co2_ppmv
    left = [name for name in ("ch4_ppmv", "n2o_ppmv", "ozone_du") if getattr(gases, name) is not None]
    if form == "tape5-lowtran7" and co2 != LOWTRAN7_CO2_PPMV:
        left.insert(0, "co2_ppmv")
    if left:
        REPORTS.warning("decks do not say %s: the program has its own", ", ".join(f"atmosphere.{name}" for name in left))
    return co2


def _air(scenario: Scenario) -> LowtranAir:
    """Return the air of the scenario as the cards of a deck specify it."""
    levels: tuple[ProfileLevel, ...] = ()
    wind = scenario.wind.speed_m_s
    if getattr(scenario.atmosphere, "air_minus_sea_k", None) is not None:
        raise ScenarioError("atmosphere.air_minus_sea_k is not in decks, which take the profile as it is; leave it out to write them")
    match scenario.atmosphere:
        case requested_air.TableAtmosphereSettings(model=model):
            aerosol = Aerosol(wind=wind, wind_24h=wind)
        case (requested_air.LowtranAtmosphere(model=model) | requested_air.LowtranFortranAtmosphere(model=model)) as requested:
            wind_24h = wind if requested.wind_24h_m_s is None else requested.wind_24h_m_s
            aerosol = Aerosol(requested.haze, requested.visibility_km, requested.air_mass_character, wind, wind_24h)
            levels = program_sounding(requested, scenario, scenario_physics.band(scenario))
        case other:
            raise ScenarioError(
                f"atmosphere.source = '{other.source}' is no air that MODTRAN could compute; "
                "set it to 'table' or 'lowtran', whose model, aerosol and wind the decks take"
            )
    over = scenario_physics.band(scenario)
    grid = wavenumber_grid(over.min_um, over.max_um, step_cm=float(STEP_CM))
    return LowtranAir(model, aerosol, round(grid[0]), round(grid[-1]), levels)


def _refraction(model: str) -> RefractingAir:
    """Return the refraction of a model atmosphere, which bends the lines of sight of a deck."""
    profile = model_profile(model)
    return RefractingAir.of(profile.height, refractivity(profile, REFRACTION_CM), profile.earth_radius)
