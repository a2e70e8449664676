"""Facts about a sounding or a model atmosphere: levels, water, hydrostatics, the lowest air, refraction and ducts."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.air.profile.absorber_densities import refractivity
from seaglint.air.profile.air_profile import GASES, AirProfile, model_profile, ozone_dobson
from seaglint.air.profile.bent_ray import trapping_layers
from seaglint.air.profile.ray_paths import LayeredIndex
from seaglint.base.conventions import FloatArray, horizon_range
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.formats.lowtran.deck import MODELS
from seaglint.formats.soundings.sounding import continuations, read_sounding
from seaglint.formats.soundings.sounding_checks import DRY_AIR, virtual_temperature

INFRARED_CM: Final = 2500.0  #: Wavenumber of the reported refractivity [cm-1]: 4 um.

REFERENCE_HEIGHT: Final = 10.0  #: Height of the air that is compared with the sea [m].

EYES: Final = (10.0, 100.0)  #: Heights of sensors whose horizon is reported [m].

FARTHEST: Final = 500e3  #: Arc up to which rays to the horizon are followed [m].

LOWEST: Final = 100.0  #: Height up to which the mean gradient of refractivity is taken [m].


STATION: Final = 2.0  #: Height of the lowest level from which on the water above it is listed too [m].


@dataclass(frozen=True, eq=False)
class AirSummary:
    """Facts about the air, for a listing, JSON and a picture."""

    profile: AirProfile  #: The air from the sea to 100 km.
    given: int  #: Number of levels of the sounding or model itself.
    kind: str  #: Format of the file, or ``model atmosphere``.
    top: float  #: Height of the highest level given [m].
    lowest: float  #: Height of the lowest level given [m].
    misfit: float | None  #: Relative misfit of heights and pressures from the hydrostatic balance; None where levels are few.
    sea_kelvin: float  #: Temperature of the sea to compare with [K].
    notes: tuple[str, ...] = field(default=())  #: Notes of the reader.
    ozone_top: float | None = None  #: Height of the highest level with ozone of the sounding [m]; None where all ozone is the model's.

    @property
    def refractivity_units(self) -> FloatArray:
        """Refractivity ``n - 1`` at the levels in parts per million [1e-6, (levels,)]."""
        return 1e6 * refractivity(self.profile, INFRARED_CM)

    @property
    def lowest_gradient(self) -> float:
        """Mean gradient of refractivity from the sea to 100 m [1e-9 per m]."""
        n = np.interp([0.0, LOWEST], self.profile.height, self.refractivity_units)
        return float(1e3 * (n[1] - n[0]) / LOWEST)

    @property
    def ducts(self) -> list[tuple[float, float]]:
        """Layers that bend rays more than the Earth is round, from and to heights [m]."""
        return trapping_layers(self.profile.height, 1e-6 * self.refractivity_units, self.profile.earth_radius)

    @property
    def horizons(self) -> dict[float, float]:
        """Arcs to the sea's horizon [m] by height of the sensor [m], at most ``FARTHEST``."""
        index = LayeredIndex(self.profile.height, 1e-6 * self.refractivity_units, self.profile.earth_radius)
        return {height: index.horizon(height, FARTHEST) for height in EYES}

    @property
    def air_minus_sea(self) -> float:
        """Temperature of the air at 10 m less the temperature of the sea [K]."""
        return float(np.interp(REFERENCE_HEIGHT, self.profile.height, self.profile.temperature)) - self.sea_kelvin

    @property
    def water_above_station(self) -> float:
        """Water vapour above the lowest level given [kg m-2], without the air that is continued from there down to the sea."""
        return self.profile.water_above(self.lowest)

    @property
    def ozone(self) -> float:
        """Ozone of the whole air above the sea [Dobson units]."""
        return self.ozone_above(0.0)

    def ozone_above(self, height: float) -> float:
        """Return the ozone of the air from the first level at or above a height on [Dobson units, from m]."""
        air = self.profile
        above = air.height >= height
        return ozone_dobson(*(row[above] for row in (air.height, air.pressure, air.temperature, air.gas[GASES.index("O3")])))

    @property
    def lines(self) -> list[str]:
        """Listing, a fact a line."""
        air = self.profile
        out = [
            f"{air.name}: {self.kind}, {self.given} levels from {self.lowest:.0f} m to {1e-3 * self.top:.1f} km",
            f"at the sea       {air.pressure[0]:.1f} hPa, {air.temperature[0] - 273.15:.1f} C, {air.relative_humidity[0]:.0f} % humidity",
            f"precipitable water {air.precipitable_water:.2f} kg/m2 (mm) from the sea up",
        ]
        if self.lowest > STATION:
            out[-1] += f", {self.water_above_station:.2f} from the lowest level at {self.lowest:.0f} m up"
        if self.ozone_top is not None:
            above = self.ozone_above(self.ozone_top)
            out.append(f"ozone {self.ozone:.0f} Dobson units from the sea up, {above:.0f} of them above its last level, by the model")
        if self.misfit is not None:
            out.append(f"heights against pressures (hydrostatic) {100.0 * self.misfit:+.2f} %")
        out.append(f"air at 10 m less sea of {self.sea_kelvin:g} K  {self.air_minus_sea:+.1f} K")
        out.append(
            f"refractivity gradient to 100 m {self.lowest_gradient:+.0f}e-9 per m (standard -22e-9; -157e-9 bends rays like the Earth)"
        )
        horizons = [(height, 1e-3 * arc, 1e-3 * horizon_range(height)) for height, arc in self.horizons.items()]
        out.append(f"sea's horizon {', '.join(f'{arc:.1f} km from {h:g} m (standard {standard:.1f})' for h, arc, standard in horizons)}")
        ducts = ", ".join(f"{a:.0f}-{b:.0f} m" for a, b in self.ducts)
        out.append(f"ducts: {ducts}; air bends rays there less than that in its sums" if ducts else "ducts: none")
        return [*out, *(f"note: {note}" for note in self.notes)]

    def as_dict(self) -> JsonObject:
        """Return plain values, for JSON."""
        return {
            "name": self.profile.name,
            "kind": self.kind,
            "levels": self.given,
            "lowest_m": self.lowest,
            "highest_m": self.top,
            "surface_pressure_hpa": float(self.profile.pressure[0]),
            "surface_temperature_k": float(self.profile.temperature[0]),
            "surface_relative_humidity_percent": float(self.profile.relative_humidity[0]),
            "precipitable_water_kg_m2": self.profile.precipitable_water,
            "precipitable_water_above_station_kg_m2": self.water_above_station,
            **({} if self.ozone_top is None else {"ozone_dobson": self.ozone}),
            "hydrostatic_misfit": self.misfit,
            "air_minus_sea_k": self.air_minus_sea,
            "refractivity_gradient_per_m": 1e-9 * self.lowest_gradient,
            "horizon_m": {f"{height:g}": arc for height, arc in self.horizons.items()},
            "ducts_m": [list(duct) for duct in self.ducts],
            "notes": list(self.notes),
        }


def summarise_air(
    source: str,
    sea_kelvin: float,
    model: str = "midlatitude-summer",
    place: tuple[float, float] | None = None,
    time: datetime | None = None,
) -> AirSummary:
    """Return facts about a sounding's file or a model atmosphere by name; ``model`` continues a sounding.

    ``place`` (latitude and longitude [deg]) and ``time`` choose from files that hold several.

    Raises
    ------
    DataError
        A temperature of the sea outside 200 to 350 K, or as ``read_sounding``.
    """
    if not 200.0 <= sea_kelvin <= 350.0:
        raise DataError(f"sea_temperature = {sea_kelvin:g}: give a temperature of 200 to 350 K")
    # A file of the name of a model takes precedence.
    if source in MODELS and not Path(source).exists():
        profile = model_profile(source)
        return AirSummary(profile, profile.height.size, "model atmosphere", 1e5, 0.0, _misfit(profile, profile.height.size), sea_kelvin)
    if not Path(source).exists() and Path(source).suffix == "":
        raise DataError(f"{source}: is neither a file nor a model atmosphere; model atmospheres are {', '.join(MODELS)}")
    read = read_sounding(source, place, time, remedy="give `place` as LAT,LON")
    profile = read.profile(model)
    return AirSummary(
        profile,
        read.given,
        read.kind,
        read.top,
        read.lowest_given,
        _misfit(profile, read.height.size),
        sea_kelvin,
        (*(note for note in read.notes if not _is_continuation(note)), *(part.text for part in continuations(read, profile, model))),
        read.ozone_top,
    )


def place_of_air(place: tuple[float, float] | str | None) -> tuple[float, float] | None:
    """Return latitude and longitude [deg] of a pair or of text such as ``54.2,7.9``.

    Raises
    ------
    DataError
        No two numbers, or none of the Earth.
    """
    if place is None:
        return None
    try:
        latitude, longitude = (float(part) for part in (place.split(",") if isinstance(place, str) else place))
    except (TypeError, ValueError):
        latitude = longitude = math.nan
    if not (abs(latitude) <= 90.0 and abs(longitude) <= 360.0):
        raise DataError(f"place = {place}: give latitude and longitude in degrees, -90 to 90 and -360 to 360, as 54.2,7.9")
    return latitude, longitude


def moment_of(time: datetime | str | None) -> datetime | None:
    """Return a time in UTC, of ISO 8601 text or a datetime; UTC where it has no zone.

    Raises
    ------
    DataError
        Text of another form.
    """
    if time is None:
        return None
    try:
        when = datetime.fromisoformat(time) if isinstance(time, str) else time
    except ValueError:
        raise DataError(f"time = {time}: give a time as 2024-07-01T06:00Z") from None
    return when.replace(tzinfo=UTC) if when.tzinfo is None else when.astimezone(UTC)


def _is_continuation(note: str) -> bool:
    """Return true for a note that a continuation repeats with its share of the water."""
    return (" ends at " in note and not note.startswith("ozone")) or note.startswith("humidity begins")


def _misfit(profile: AirProfile, count: int) -> float:
    """Return the relative difference of the heights of levels from the hydrostatic heights by their pressures, up to 30 km [1]."""
    z, p, t = profile.height[:count], profile.pressure[:count], profile.temperature[:count]
    warm = virtual_temperature(t, p, profile.relative_humidity[:count])
    # Gravity falls with height: geometric heights grow over geopotential ones.
    gravity = 9.80665 * (6_356_766.0 / (6_356_766.0 + 0.5 * (z[1:] + z[:-1]))) ** 2
    thick = DRY_AIR * 0.5 * (warm[1:] + warm[:-1]) / gravity * np.log(p[:-1] / p[1:])
    low = z[1:] <= 30e3
    return float(np.diff(z)[low].sum() / thick[low].sum() - 1.0)
