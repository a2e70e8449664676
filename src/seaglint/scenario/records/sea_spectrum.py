"""Table ``[sea.spectrum]``: kinds of wave spectra, one record each."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import InputFile, Record, Utc, default_tag

_Azimuth = Annotated[float, Quantity("deg", ge=-360, le=360)]
_Width = Annotated[float, Quantity("deg", ge=1, le=80)]


class Elfouhaily(Record):
    """Elfouhaily et al. 1997, fully developed, at the scenario's wind."""

    kind: Literal["elfouhaily"] = "elfouhaily"


class PiersonMoskowitz(Record):
    """Pierson and Moskowitz 1964, at the scenario's wind."""

    kind: Literal["pierson-moskowitz"] = "pierson-moskowitz"


class Jonswap(Record):
    """Waves of a stated height, period and direction (Hasselmann et al. 1973): wind sea or swell."""

    kind: Literal["jonswap"] = "jonswap"
    significant_height_m: Annotated[
        float, Quantity("m", ge=0.01, le=30), Field(description="significant height, four times the standard deviation of the surface")
    ]
    peak_period_s: Annotated[float, Quantity("s", ge=0.5, le=30), Field(description="period of the waves with the most energy")]
    gamma: Annotated[
        float, Quantity(ge=1, le=20), Field(description="peak enhancement: 1 fully developed, 3.3 growing sea, more for swell")
    ] = 3.3
    from_deg: Annotated[_Azimuth | None, Field(description="azimuth the waves come FROM; default: that of the wind")] = None
    spreading_deg: Annotated[
        _Width, Field(description="width of their directions (circular standard deviation): wind sea about 30, swell 10 to 20")
    ] = 30.0


class SpectrumFile(Record):
    """A spectrum from a file: buoys, wave models, re-analyses."""

    kind: Literal["file"] = "file"
    path: Annotated[InputFile, Field(description="the file; of a buoy's five NDBC files, beside each other, any one, e.g. 41010.data_spec")]
    format: Annotated[
        Literal["auto", "ndbc", "cdip", "mhkit", "spotter", "swan", "ww3", "era5", "triaxys", "octopus", "datawell", "wavespectra"],
        Field(description="format of the file; auto recognises it"),
    ] = "auto"
    time: Annotated[Utc | None, Field(description="UTC time of the record wanted; default: that of [time]")] = None
    time_tolerance_s: Annotated[
        float, Quantity("s", ge=0, le=1e9), Field(description="farthest the record taken may be from the time wanted")
    ] = 3600.0
    latitude_deg: Annotated[
        Annotated[float, Quantity("deg", ge=-90, le=90)] | None,
        Field(description="latitude of the spectrum wanted, north positive; default: that of [place]"),
    ] = None
    longitude_deg: Annotated[
        Annotated[float, Quantity("deg", ge=-180, le=360)] | None, Field(description="its longitude, east positive")
    ] = None
    distance_tolerance_km: Annotated[
        float, Quantity("km", ge=0, le=20_100), Field(description="farthest the spectrum taken may be from the place wanted")
    ] = 50.0
    site: Annotated[str | None, Field(description="name of the site as the file has it, or its number from 1; instead of a place")] = None
    from_deg: Annotated[_Azimuth | None, Field(description="azimuth the waves come FROM, for a file without directions only")] = None
    spreading_deg: Annotated[
        _Width | None,
        Field(description="width of their directions (circular standard deviation), for a file without directions only"),
    ] = None

    @field_validator("longitude_deg")
    @classmethod
    def _with_latitude(cls, longitude: float | None, info: ValidationInfo) -> float | None:
        latitude = info.data.get("latitude_deg", longitude)
        if longitude is None and latitude is not None:
            raise PydanticCustomError("missing", "{text}", {"text": "is missing"})
        if longitude is not None and latitude is None:
            raise PydanticCustomError("quantity", "{text}", {"text": "needs latitude_deg beside it; give both or none"})
        return longitude


class FlatSea(Record):
    """No waves."""

    kind: Literal["flat"] = "flat"


System = Elfouhaily | PiersonMoskowitz | Jonswap | SpectrumFile  #: What can be one of several.


class WaveSystems(Record):
    """Several at once, each with its own directions: wind sea and swells."""

    kind: Literal["systems"] = "systems"
    systems: Annotated[
        tuple[Annotated[System, Field(discriminator="kind")], ...],
        Field(description="list of spectra of the other kinds, each a table; their energies add"),
    ]

    @field_validator("systems")
    @classmethod
    def _one_or_more(cls, systems: tuple[System, ...]) -> tuple[System, ...]:
        if not systems:
            raise PydanticCustomError(
                "quantity", "{text}", {"text": "must hold one spectrum or more; for a sea without waves set kind = 'flat'"}
            )
        return systems


Spectrum = Annotated[Annotated[System | WaveSystems | FlatSea, Field(discriminator="kind")], default_tag("kind", "elfouhaily")]
