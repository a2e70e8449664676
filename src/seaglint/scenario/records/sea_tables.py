"""Tables ``[wind]`` and ``[sea]``: the wind at 10 m, the water, its slopes, waves and glint.

Each kind of slope statistics (``[sea.slopes]``) and of wave spectra (``[sea.spectrum]``) is a record.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Final, Literal, Self

from pydantic import Field, StrictBool, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from seaglint.base.limits import BREON_HENRIOT_WIND, COX_MUNK_SLICK_WIND, COX_MUNK_WIND, WIND_PROFILE
from seaglint.scenario.records.quantities import Azimuth, InputFileOrStore, Latitude, Longitude, Quantity, Record, Utc, about, default_tag


class Wind(Record):
    """Neutral wind at 10 m."""

    speed_m_s: Annotated[float, Quantity("m/s", ge=0, le=WIND_PROFILE[1]), about("wind speed at 10 m")] = 7.0
    from_deg: Annotated[Azimuth, about("azimuth the wind comes FROM, clockwise from north")] = 230.0


Range = tuple[float, float]


class _FittedSlopes(Record):
    """Slopes that were fitted to measurements in a range of winds."""

    winds: ClassVar[Range] = COX_MUNK_WIND
    kind: str  # the kind stands first among the keys of a table
    extrapolate: Annotated[StrictBool, about("allow winds above the range of the fit")] = False


class CoxMunkIsotropic(_FittedSlopes):
    """Cox and Munk 1954, clean sea, the same variance in all directions."""

    kind: Literal["cox-munk-isotropic"] = "cox-munk-isotropic"


class CoxMunkAnisotropic(_FittedSlopes):
    """Cox and Munk 1954, clean sea, upwind and crosswind variances."""

    kind: Literal["cox-munk-anisotropic"] = "cox-munk-anisotropic"


class CoxMunkGramCharlier(_FittedSlopes):
    """Cox and Munk 1954, clean sea, with skewness (steep lee faces) and peakedness."""

    kind: Literal["cox-munk-gram-charlier"] = "cox-munk-gram-charlier"


class CoxMunkSlick(_FittedSlopes):
    """Cox and Munk 1954, sea under an oil slick; up to 14 m/s."""

    winds: ClassVar[Range] = COX_MUNK_SLICK_WIND
    kind: Literal["cox-munk-slick"] = "cox-munk-slick"


class BreonHenriot(_FittedSlopes):
    """Breon and Henriot 2006, open ocean seen from a satellite, with skewness and peakedness; up to 15 m/s."""

    winds: ClassVar[Range] = BREON_HENRIOT_WIND
    kind: Literal["breon-henriot"] = "breon-henriot"


class SpectrumSlopes(Record):
    """Gaussian slopes with the variances of sea.spectrum, all its waves."""

    kind: Literal["spectrum"] = "spectrum"


class FlatSlopes(Record):
    """A mirror: no slopes."""

    kind: Literal["flat"] = "flat"


Slopes = Annotated[
    Annotated[
        CoxMunkIsotropic | CoxMunkAnisotropic | CoxMunkGramCharlier | CoxMunkSlick | BreonHenriot | SpectrumSlopes | FlatSlopes,
        Field(discriminator="kind"),
    ],
    default_tag("kind", "cox-munk-anisotropic"),
]


_Width = Annotated[float, Quantity("deg", ge=1, le=80)]

_Level = Annotated[float, Quantity(ge=0, le=1)]


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
        float, Quantity("m", ge=0.01, le=30), about("significant height, four times the standard deviation of the surface")
    ]
    peak_period_s: Annotated[float, Quantity("s", ge=0.5, le=30), about("period of the waves with the most energy")]
    gamma: Annotated[float, Quantity(ge=1, le=20), about("peak enhancement: 1 fully developed, 3.3 growing sea, more for swell")] = 3.3
    from_deg: Annotated[Azimuth | None, about("azimuth the waves come FROM; default: that of the wind")] = None
    spreading_deg: Annotated[
        _Width, about("width of their directions (circular standard deviation): wind sea about 30, swell 10 to 20")
    ] = 30.0


class SpectrumFile(Record):
    """A spectrum from a file: buoys, wave models, re-analyses."""

    kind: Literal["file"] = "file"
    path: Annotated[
        InputFileOrStore, about("the file or Zarr store; of a buoy's five NDBC files, beside each other, any one, e.g. 41010.data_spec")
    ]
    format: Annotated[
        Literal[
            "auto",
            "ndbc",
            "cdip",
            "mhkit",
            "spotter",
            "obscape",
            "awac",
            "datawell",
            "triaxys",
            "swan",
            "ww3",
            "wwm",
            "era5",
            "octopus",
            "wavespectra",
        ],
        about("format of the file; auto recognises it"),
    ] = "auto"
    time: Annotated[Utc | None, about("UTC time of the record wanted; default: that of [time]")] = None
    time_tolerance_s: Annotated[float, Quantity("s", ge=0, le=1e9), about("farthest the record taken may be from the time wanted")] = 3600.0
    latitude_deg: Annotated[Latitude | None, about("latitude of the spectrum wanted, north positive; default: that of [place]")] = None
    longitude_deg: Annotated[Longitude | None, about("its longitude, east positive")] = None
    distance_tolerance_km: Annotated[
        float, Quantity("km", ge=0, le=20_100), about("farthest the spectrum taken may be from the place wanted")
    ] = 50.0
    site: Annotated[str | None, about("name of the site as the file has it, or its number from 1; instead of a place")] = None
    from_deg: Annotated[Azimuth | None, about("azimuth the waves come FROM, for a file without directions only")] = None
    spreading_deg: Annotated[
        _Width | None, about("width of their directions (circular standard deviation), for a file without directions only")
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


class MeasuredWaves(Record):
    """A measured wavenumber spectrum, joined to a model of longer and shorter waves."""

    kind: str  # the kind stands first among the keys of a table
    longer_waves: Annotated[
        Literal["elfouhaily", "cut"], about("waves longer than the measured ones: elfouhaily: of Elfouhaily's spectrum; cut: none")
    ] = "elfouhaily"
    shorter_waves: Annotated[
        Literal["cut", "elfouhaily"],
        about("waves shorter than the measured ones: cut: none; elfouhaily: of Elfouhaily's spectrum, down to its capillary cut-off"),
    ] = "cut"
    from_deg: Annotated[Azimuth | None, about("mean azimuth the waves come FROM; default: that of the wind")] = None
    spreading_deg: Annotated[
        _Width | None,
        about(
            "width of their directions (circular standard deviation), where they are not measured; default: those of Elfouhaily's spectrum"
        ),
    ] = None


class AsitSea(MeasuredWaves):
    """Sea of the Air-Sea Interaction Tower, 2019, at the scenario's wind (2.69 to 17.6 m/s), to 1378 rad/m."""

    kind: Literal["asit-2019"] = "asit-2019"


class RadyoSea(MeasuredWaves):
    """Sea of RaDyO, Santa Barbara Channel, 2008, at the scenario's wind (1.73 to 9.24 m/s), 20 to 1000 rad/m."""

    kind: Literal["radyo-2008"] = "radyo-2008"


READY_SEAS: Final = ("asit-2019", "radyo-2008")  #: Kinds of measured seas whose tables are in the package.


class WavenumberFile(MeasuredWaves):
    """A measured wavenumber spectrum from a file, of one wind or several."""

    kind: Literal["wavenumber-file"] = "wavenumber-file"
    path: Annotated[
        InputFileOrStore,
        about(
            "CSV or NetCDF with wavenumber_rad_m or wavenumber_cycles_m, one of saturation, elevation_m3, slope_m, and optionally "
            "wind_speed_m_s, delta or half_width_deg"
        ),
    ]

    @field_validator("path", mode="before")
    @classmethod
    def _is_a_file(cls, path: Any) -> Any:
        if str(path) in READY_SEAS:
            text = f"is a measured sea of the package and no file; set kind = '{path}' and leave path out"
            raise PydanticCustomError("quantity", "{text}", {"text": text})
        return path


class FlatSea(Record):
    """No waves."""

    kind: Literal["flat"] = "flat"


#: What can be one of several.
System = Elfouhaily | PiersonMoskowitz | Jonswap | SpectrumFile | WavenumberFile | AsitSea | RadyoSea


class WaveSystems(Record):
    """Several at once, each with its own directions: wind sea and swells."""

    kind: Literal["systems"] = "systems"
    systems: Annotated[
        tuple[Annotated[System, Field(discriminator="kind")], ...],
        about("list of spectra of the other kinds, each a table; their energies add"),
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


class Glint(Record):
    """Correlation of the Sun's glint in time and over the sea, which sets how much glint fluctuates in a pixel."""

    correlation: Annotated[
        Literal["waves", "time"],
        about(
            "waves: correlation from the waves that are no geometry; time: cells of one length, from correlation_time_s; default: waves, "
            "or time where one of the other keys is set"
        ),
    ] = "waves"
    correlation_time_s: Annotated[
        float,
        Quantity("s", ge=0.001, le=10),
        about("correlation time of glint at a point (reported: 0.03 to 0.3 s), for correlation = 'time'"),
    ] = 0.07
    dispersion: Annotated[
        Literal["full", "article"],
        about("waves behind the correlation length: full: gravity and surface tension; article: surface tension alone"),
    ] = "full"
    cell_m: Annotated[
        Annotated[float, Quantity("m", ge=1e-4, le=100)] | None,
        about("size of the sea's cells that glint independently; default: from the correlation time"),
    ] = None

    @model_validator(mode="before")
    @classmethod
    def _time_where_given(cls, given: Any) -> Any:
        # scenarios from before the key are explicit about the time: they keep their cells
        cells = ("correlation_time_s", "dispersion", "cell_m")
        if isinstance(given, Mapping) and "correlation" not in given and any(given.get(key) is not None for key in cells):
            return {"correlation": "time", **given}
        return given

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        for key in ("correlation_time_s", "dispersion", "cell_m"):
            value = getattr(self, key)
            if self.correlation == "waves" and value != type(self).model_fields[key].default:
                text = f"is 'waves', and {key} = {value} is for correlation = 'time'; leave one of them out"
                raise PydanticCustomError("quantity", "{text}", {"text": text, "key": "correlation"})
        return self


class Foam(Record):
    """Foam of breaking waves: its share of the sea by the wind, and the crests that leave it."""

    law: Annotated[
        Literal["monahan-1980", "monahan-1980-robust", "callaghan-2008", "salisbury-2013"], about("law of the share of foam by the wind")
    ] = "monahan-1980"
    extrapolate: Annotated[StrictBool, about("allow winds outside the range of the law")] = False
    crests: Annotated[Literal["melville-matusov-2002", "phillips-1985"], about("distribution of the breaking crests over their speed")] = (
        "melville-matusov-2002"
    )


class Sea(Record):
    """The water and its shape."""

    temperature_k: Annotated[float, Quantity("K", ge=260, le=320), about("skin temperature of the sea")] = 288.15
    water: Annotated[Literal["hale-querry-sea", "segelstein", "article"], about("table of the complex refractive index")] = (
        "hale-querry-sea"
    )
    resolve_waves: Annotated[StrictBool, about("true: long waves are geometry; false: all slopes are facet density, the mean picture")] = (
        True
    )
    shortest_wave_m: Annotated[
        float, Quantity("m", ge=0.02, le=1000), about("length of the shortest wave that is geometry; shorter ones are facet density")
    ] = 2.0
    nonlinear: Annotated[
        Literal["linear", "second-order"],
        about("heights of the geometry: linear: Gaussian; second-order: with bound waves, sharp crests and flat troughs"),
    ] = "linear"
    uncertainty: Annotated[
        Literal["none", "campaigns"],
        about(
            "campaigns: short waves drawn by the seed between two measured campaigns and Elfouhaily's model, slopes those of all waves "
            "whatever sea.slopes says; none: the sea as specified"
        ),
    ] = "none"
    short_wave_levels: Annotated[
        tuple[_Level, _Level] | None,
        about(
            "for uncertainty = 'campaigns', place between the least (0) and the largest (1) saturation at 5 and at 1000 rad/m; "
            "default: drawn by the seed"
        ),
    ] = None
    slopes: Annotated[
        Slopes, about("slope statistics of the whole sea; a measured wavenumber spectrum has its own by default: kind = 'spectrum'")
    ] = CoxMunkAnisotropic()
    spectrum: Annotated[Spectrum, about("spectrum of the waves that are geometry")] = Elfouhaily()
    glint: Annotated[Glint, about("correlation of glint")] = Glint()
    foam: Annotated[Foam | None, about("foam of breaking waves; without it the sea has none")] = None

    @model_validator(mode="before")
    @classmethod
    def _an_empty_table_states_no_slopes(cls, raw: Any) -> Any:
        return {key: value for key, value in raw.items() if key != "slopes"} if isinstance(raw, dict) and raw.get("slopes") == {} else raw

    @model_validator(mode="after")
    def _measured_waves_bring_their_slopes(self) -> Self:
        if "slopes" not in self.model_fields_set and self.measured_kind is not None:
            # Set without marking the key as stated, so that a file written from this scenario leaves it out.
            self.__dict__["slopes"] = SpectrumSlopes()
        return self

    @property
    def measured_kind(self) -> str | None:
        """Kind of the first measured wavenumber spectrum, alone or of several systems; None without one."""
        table = self.spectrum
        systems = table.systems if isinstance(table, WaveSystems) else (table,)
        return next((system.kind for system in systems if isinstance(system, MeasuredWaves)), None)
