"""Models of a scenario file: frozen records, one per table of the TOML file, every value checked once.

A validated number stays in the unit that its key names (``height_m``, ``azimuth_deg``); studies convert it.
Winds and waves are described by where they come FROM; azimuths are clockwise from north; elevations are above the
horizontal, so that looking down is negative.
"""

from __future__ import annotations

from collections.abc import Callable
from datetime import UTC, datetime
from typing import Annotated, Any, ClassVar, Self

from pydantic import model_validator

from seaglint.base.free_form import TomlTables
from seaglint.base.limits import (
    ELFOUHAILY_WIND,
    FOAM_WINDS,
    LOWTRAN_BAND_UM,
    LOWTRAN_HEIGHTS,
    NAVY_AEROSOL_WIND,
    PROFILE_BAND_UM,
    PROFILE_HEIGHTS,
    TABLE_BANDS_UM,
)
from seaglint.scenario.records.atmosphere_table import Atmosphere, LowtranAtmosphere, LowtranFortranAtmosphere, TableAtmosphereSettings
from seaglint.scenario.records.likelihood_table import Likelihood
from seaglint.scenario.records.object_tables import Object, in_degrees, with_names
from seaglint.scenario.records.quantities import PACKAGED, YEARS, Quantity, Record, about, rule
from seaglint.scenario.records.sea_tables import FlatSlopes, Sea, SpectrumSlopes, Wind
from seaglint.scenario.records.sensor_table import Sensor
from seaglint.scenario.records.small_tables import TABLE_BANDS_TEXT, BandSettings, Mean, Moon, Place, Platform, Render, Sun, Time


class Scenario(Record):
    """A scene and the sensor that looks at it: everything a picture depends on."""

    seed: Annotated[int, Quantity(ge=0, le=9_223_372_036_854_775_807, integer=True), about("the same seed gives the same sea")] = 1
    time: Time | None = None
    place: Place | None = None
    sun: Sun | None = None
    moon: Annotated[
        Moon | None, about("the Moon: three angles, or an empty table with [time] and [place]; without it there is no moonlight")
    ] = None
    sensor: Sensor = Sensor()
    platform: Annotated[Platform | None, about("how the sensor moves; without it the sensor stands still")] = None
    band: BandSettings = BandSettings()
    wind: Wind = Wind()
    sea: Sea = Sea()
    atmosphere: Annotated[Atmosphere, about("the air")] = TableAtmosphereSettings()
    mean: Mean = Mean()
    render: Render = Render()
    objects: Annotated[tuple[Object, ...] | None, about("what is on and above the sea")] = None
    likelihood: Annotated[Likelihood | None, about("how often glint matters, for the command likelihood")] = None

    #: Function that makes the HTML for notebooks; ``seaglint.scenario.text.display``, which reads this module, sets it.
    html: ClassVar[Callable[[Any], str] | None] = None

    def _repr_html_(self) -> str | None:
        return None if Scenario.html is None else Scenario.html(self)

    @model_validator(mode="before")
    @classmethod
    def _sun_by_default(cls, raw: Any) -> Any:
        # A scenario without Sun, time and place has the default Sun.
        if isinstance(raw, dict) and not any(raw.get(key) is not None for key in ("time", "place", "sun")) and not _places_itself(raw):
            return {**raw, "sun": {}}
        return raw

    @model_validator(mode="before")
    @classmethod
    def _objects_by_name(cls, raw: Any) -> Any:
        return {**raw, "objects": with_names(raw["objects"])} if isinstance(raw, dict) and "objects" in raw else raw

    @model_validator(mode="after")
    def _one_sun(self) -> Self:
        if self.sun is not None and (self.time is not None or self.place is not None):
            other = "time" if self.time is not None else "place"
            raise rule("sun", f"is given together with [{other}]; give [sun] alone, or [time] and [place] without [sun]")
        if self.likelihood is not None and self.likelihood.places_itself:
            for key, given in (("sun", self.sun), ("place", self.place), ("time", self.time)):
                if given is not None:
                    text = f"is given together with a region or places of weather in [likelihood]; leave [{key}] or those out"
                    raise rule(key, text)
            return self
        if self.likelihood is not None and self.sun is None and self.place is None:
            if self.likelihood.place is not None:
                return self
            if self.likelihood.of_the_world and self.time is None:
                return self
        lights, instead = "the Sun", "give [sun] instead"
        if self.moon is not None and not self.moon.given:
            lights, instead = "Sun and Moon", f"{instead}, with zenith_deg, azimuth_deg and phase_deg in [moon]"
        if self.sun is None and self.place is None:
            raise rule("place", f"is missing: [time] needs [place] latitude_deg, longitude_deg to find {lights}; or {instead}")
        if self.sun is None and self.time is None and self.likelihood is None:
            raise rule("time", f"is missing: [place] needs [time] utc to find {lights}; or {instead}")
        return self

    @model_validator(mode="after")
    def _moon_has_a_place(self) -> Self:
        if self.moon is None or self.moon.given:
            return self
        draws = self.likelihood is not None and self.sun is None
        if (self.time is None or self.place is None) and not draws:
            text = "has no angles and needs [time] and [place]; give both, or zenith_deg, azimuth_deg and phase_deg in [moon]"
            raise rule("moon", text)
        return self

    @model_validator(mode="after")
    def _article_has_neither_moon_nor_foam(self) -> Self:
        for table, name, given in (("moon", "Moon", self.moon), ("sea.foam", "foam", self.sea.foam)):
            if self.mean.mode == "article" and given is not None:
                raise rule("mean.mode", f"= 'article' has no {name}; leave out [{table}], or set mean.mode = 'spectral'", value="article")
        return self

    @model_validator(mode="after")
    def _drawn_sea_has_short_waves(self) -> Self:
        if self.sea.uncertainty == "none":
            if self.sea.short_wave_levels is not None:
                raise rule("sea.short_wave_levels", "is for sea.uncertainty = 'campaigns' alone; set that, or leave it out")
            return self
        if (reason := self.sea_not_drawn) is not None:
            raise rule("sea.uncertainty", f"= 'campaigns' {reason}", value="campaigns")
        if (kind := self.sea.measured_kind) is not None:
            text = (
                f"= 'campaigns' replaces waves beyond 5 rad/m, and sea.spectrum has measured ones there (kind = '{kind}'); leave "
                "uncertainty out for the measured sea, or set another sea.spectrum.kind such as 'elfouhaily'"
            )
            raise rule("sea.uncertainty", text, value="campaigns")
        return self

    @property
    def sea_not_drawn(self) -> str | None:
        """Reason why no sea between the campaigns can be drawn for this scenario, with the remedy; None where it can."""
        match self.sea.slopes.kind:
            case "flat":
                return "draws short waves, and sea.slopes.kind = 'flat' is a mirror; set another kind"
            case "cox-munk-slick":
                return "draws the short waves of clean seas, and sea.slopes.kind = 'cox-munk-slick' has a slick on it; set another kind"
        if self.mean.mode == "article":
            return "draws short waves, and mean.mode = 'article' has the slopes of Cox and Munk alone; set mean.mode = 'spectral'"
        if self.wind.speed_m_s > ELFOUHAILY_WIND[1]:
            speed, most = self.wind.speed_m_s, ELFOUHAILY_WIND[1]
            return f"draws the short waves of winds of 0 to {most:g} m/s, and wind.speed_m_s = {speed:g}; set a lighter wind"
        return None

    @model_validator(mode="after")
    def _objects_have_names_and_places(self) -> Self:
        names: set[str] = set()
        for item in self.objects or ():
            if item.name in names:
                raise rule("objects", f"has the name '{item.name}' twice; give every object a name of its own", value=item.name)
            names.add(item.name)
            if in_degrees(item) and self.place is None:
                raise rule(
                    f"objects ('{item.name}')", "has latitude_deg and longitude_deg, which need [place] and [time]; give east_m, north_m"
                )
        return self

    @model_validator(mode="after")
    def _the_calendar_lasts(self) -> Self:
        if self.time is None:
            return self
        # The Sun of every frame is computed, so the last frame must lie within these years too.
        left = (datetime(YEARS[1] + 1, 1, 1, tzinfo=UTC) - self.time.utc).total_seconds()
        if (self.sensor.frames - 1) / self.sensor.frame_rate_hz >= left:
            text = f"= {self.sensor.frames} at {self.sensor.frame_rate_hz:g} Hz end after the year {YEARS[1]}; give fewer or a higher rate"
            raise rule("sensor.frames", text, value=self.sensor.frames)
        return self

    @model_validator(mode="after")
    def _layers_have_their_source(self) -> Self:
        if "foam_share" in self.render.layers and self.sea.foam is None:
            raise rule("render.layers", "has 'foam_share', but the sea has no foam; add a table [sea.foam] or leave that layer out")
        return self

    @model_validator(mode="after")
    def _table_covers_sensor_and_band(self) -> Self:
        if self.atmosphere.source != "table":
            return self
        height, (lowest, highest) = self.sensor.height_m, PROFILE_HEIGHTS
        other = "or set atmosphere.source = 'none', or 'lowtran' for other bands"
        if not lowest <= height <= highest:
            text = f"= {height:g} is outside the heights of the table atmosphere; allowed: {lowest:g} to {highest:g} m, {other}"
            raise rule("sensor.height_m", text, value=height, allowed=PROFILE_HEIGHTS)
        low, high = self.band.min_um, self.band.max_um
        if low is not None and high is not None and not any(bottom <= low and high <= top for bottom, top in TABLE_BANDS_UM):
            # Named by the edge that is wrong; where both are inside, the band spans the gap and its far edge is told.
            in_low = any(bottom <= low < top for bottom, top in TABLE_BANDS_UM)
            key, given, other_edge = ("max_um", high, f"min_um = {low:g}") if in_low else ("min_um", low, f"max_um = {high:g}")
            text = f"= {given:g} with band.{other_edge} is outside the table atmosphere; allowed: {TABLE_BANDS_TEXT}, {other}"
            raise rule(f"band.{key}", text, value=given, allowed=TABLE_BANDS_TEXT)
        return self

    @model_validator(mode="after")
    def _lowtran_covers_sensor_band_and_wind(self) -> Self:
        if not isinstance(self.atmosphere, LowtranAtmosphere | LowtranFortranAtmosphere):
            return self
        program = isinstance(self.atmosphere, LowtranFortranAtmosphere)
        height, (lowest, highest) = self.sensor.height_m, LOWTRAN_HEIGHTS if program else PROFILE_HEIGHTS
        if not lowest <= height <= highest:
            other = ", or set atmosphere.source = 'lowtran'" if height > highest else ""
            text = f"= {height:g} is too {'high' if other else 'low'} for LOWTRAN7; allowed: {lowest:g} to {highest:g} m{other}"
            raise rule("sensor.height_m", text, value=height, allowed=(lowest, highest))
        low, high = allowed = LOWTRAN_BAND_UM if program else PROFILE_BAND_UM
        wider = "" if program else ", or set atmosphere.source = 'lowtran-fortran' (0.2 to 28 um; needs a Fortran compiler)"
        for key, edge in (("min_um", self.band.min_um), ("max_um", self.band.max_um)):
            if edge is not None and not low <= edge <= high:
                text = f"= {edge:g} is outside LOWTRAN7; allowed: {low:g} to {high:g} um{wider}"
                raise rule(f"band.{key}", text, value=edge, allowed=allowed)
        speed, most = self.wind.speed_m_s, NAVY_AEROSOL_WIND[1]
        if self.atmosphere.haze == "navy-maritime" and speed > most:
            # LOWTRAN7 itself would silently take the strongest one.
            text = (
                f"= {speed:g} is above the range of the Navy maritime aerosol; allowed: 0 to {most:g} m/s, or set another atmosphere.haze"
            )
            raise rule("wind.speed_m_s", text, value=speed, allowed=NAVY_AEROSOL_WIND)
        return self

    @model_validator(mode="after")
    def _wind_is_in_the_fits(self) -> Self:
        slopes, speed, ask = self.sea.slopes, self.wind.speed_m_s, "sea.slopes.extrapolate = true"
        if self.atmosphere.source == "table" and speed > NAVY_AEROSOL_WIND[1]:
            allowed = f"allowed: 0 to {NAVY_AEROSOL_WIND[1]:g} m/s, or set"
            # The aerosol of the table has no value to extrapolate from; without air the slopes still can be.
            text = (
                f"= {speed:g} is above the range of the table atmosphere's maritime aerosol; {allowed} atmosphere.source = 'none' and {ask}"
            )
            raise rule("wind.speed_m_s", text, value=speed, allowed=NAVY_AEROSOL_WIND)
        if isinstance(slopes, FlatSlopes | SpectrumSlopes) or slopes.extrapolate or speed <= slopes.winds[1]:
            return self
        if self.sea.uncertainty != "none":
            return self  # slopes of a drawn sea are those of its waves
        text = f"= {speed:g} is above the {slopes.kind} slope fit; allowed: 0 to {slopes.winds[1]:g} m/s, or set {ask}"
        raise rule("wind.speed_m_s", text, value=speed, allowed=slopes.winds)

    @model_validator(mode="after")
    def _foam_has_waves_and_a_law(self) -> Self:
        foam, speed = self.sea.foam, self.wind.speed_m_s
        if foam is None:
            return self
        if isinstance(self.sea.slopes, FlatSlopes):
            raise rule("sea.foam", "is given for a mirror (sea.slopes.kind = 'flat'), whose waves cannot break; leave out one of them")
        low, high = allowed = FOAM_WINDS[foam.law]
        if not foam.extrapolate and not low <= speed <= high:
            side = "below" if speed < low else "above"
            text = (
                f"= {speed:g} is {side} the winds of the foam law {foam.law}; allowed: {low:g} to {high:g} m/s, "
                "or set another sea.foam.law or sea.foam.extrapolate = true"
            )
            raise rule("wind.speed_m_s", text, value=speed, allowed=allowed)
        return self


def _places_itself(raw: TomlTables) -> bool:
    """Return true where a ``[likelihood]`` not yet validated names a region, or takes places from its weather."""
    table = raw.get("likelihood")
    if not isinstance(table, dict):
        return False
    placed = any(table.get(key) is not None for key in ("latitudes_deg", "place"))
    return placed or table.get("place_from_weather") is True or str(table.get("weather")) == PACKAGED[0]
