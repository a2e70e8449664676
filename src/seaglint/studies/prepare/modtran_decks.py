"""Decks for MODTRAN or LOWTRAN7 of the lines of sight that a scenario needs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np

from seaglint.air.profile.absorber_densities import refractivity
from seaglint.air.profile.air_profile import model_profile
from seaglint.air.profile.bent_ray import RefractingAir
from seaglint.air.profile.own_gases import OwnGases
from seaglint.air.protocol import wavenumber_grid
from seaglint.base.errors import DomainError, ScenarioError
from seaglint.base.limits import LOWTRAN_HEIGHTS
from seaglint.base.reports import REPORTS
from seaglint.files.lowtran.deck import STEP_CM, Aerosol, LowtranAir, ProfileLevel
from seaglint.files.modtran.json_deck import json_deck
from seaglint.files.modtran.lines import MANIFEST, Manifest, needed_lines
from seaglint.files.modtran.tape5 import LOWTRAN7_CO2_PPMV, deck
from seaglint.files.outputs import made_folder, refuse_existing
from seaglint.files.text_file import write_text
from seaglint.scenario.model import Scenario
from seaglint.scenario.records import atmosphere_table as wanted_air
from seaglint.scenario.sun import sun_position
from seaglint.studies.prepare import prepare
from seaglint.studies.prepare.profile_air import wanted_gases
from seaglint.studies.prepare.sounding_air import program_sounding

DeckFormat = Literal["tape5", "tape5-lowtran7", "modtran6-json"]

NAME: Final = "lines"

#: Name of the deck of each format.
DECKS: Final[dict[DeckFormat, str]] = {"tape5": f"{NAME}.tp5", "tape5-lowtran7": "TAPE5", "modtran6-json": f"{NAME}-input.json"}

#: Names under which the results of each are looked for.
OUTPUTS: Final[dict[DeckFormat, tuple[str, ...]]] = {
    "tape5": (f"{NAME}.tp7", "tape7", f"{NAME}.7sc", "tape7.scn"),
    "tape5-lowtran7": ("TAPE7", "tape7"),
    "modtran6-json": (f"{NAME}.json", f"{NAME}.csv"),
}

REFRACTION_CM: Final = 2665.0  #: Wavenumber of the refractivity by which lines of sight are laid [cm-1]: infrared air is the same to 1e-4.


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
        Ask for scattered sunlight too, where the Sun is up.
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
    contents = {DECKS[form]: text, MANIFEST: manifest.text()} | ({"mod5root.in": f"{NAME}\n"} if form == "tape5" else {})
    for name in contents:
        refuse_existing(folder / name, overwrite=overwrite)
    for name, content in contents.items():
        write_text(content, folder / name)
    return Decks(folder / DECKS[form], len(lines), solar_deg)


def _carbon_dioxide(scenario: Scenario, form: str) -> float:
    """Carbon dioxide of the scenario [1e-6 of the volume]; what decks cannot say of its gases is reported."""
    gases = OwnGases()
    if isinstance(scenario.atmosphere, wanted_air.TableAtmosphereSettings | wanted_air.LowtranAtmosphere):
        gases = wanted_gases(scenario.atmosphere)
    co2 = LOWTRAN7_CO2_PPMV if gases.co2_ppmv is None else gases.co2_ppmv
    left = [name for name in ("ch4_ppmv", "n2o_ppmv", "ozone_du") if getattr(gases, name) is not None]
    if form == "tape5-lowtran7" and co2 != LOWTRAN7_CO2_PPMV:
        left.insert(0, "co2_ppmv")
    if left:
        REPORTS.warning("decks do not say %s: the program has its own", ", ".join(f"atmosphere.{name}" for name in left))
    return co2


def _air(scenario: Scenario) -> LowtranAir:
    """Air of the scenario as cards say it."""
    levels: tuple[ProfileLevel, ...] = ()
    wind = scenario.wind.speed_m_s
    if getattr(scenario.atmosphere, "air_minus_sea_k", None) is not None:
        raise ScenarioError("atmosphere.air_minus_sea_k is not in decks, which take the profile as it is; leave it out to write them")
    match scenario.atmosphere:
        case wanted_air.TableAtmosphereSettings(model=model):
            aerosol = Aerosol(wind=wind, wind_24h=wind)
        case (wanted_air.LowtranAtmosphere(model=model) | wanted_air.LowtranFortranAtmosphere(model=model)) as wanted:
            longer = wanted.wind_24h_m_s
            aerosol = Aerosol(wanted.haze, wanted.visibility_km, wanted.air_mass_character, wind, wind if longer is None else longer)
            levels = program_sounding(wanted, scenario, prepare.band(scenario))
        case other:
            raise ScenarioError(
                f"atmosphere.source = '{other.source}' is no air that MODTRAN could compute; "
                "set it to 'table' or 'lowtran', whose model, aerosol and wind the decks take"
            )
    over = prepare.band(scenario)
    grid = wavenumber_grid(over.min_um, over.max_um, step_cm=float(STEP_CM))
    return LowtranAir(model, aerosol, round(grid[0]), round(grid[-1]), levels)


def _refraction(model: str) -> RefractingAir:
    """Refraction of a model atmosphere, by which lines of sight are laid."""
    profile = model_profile(model)
    return RefractingAir.of(profile.height, refractivity(profile, REFRACTION_CM), profile.earth_radius)
