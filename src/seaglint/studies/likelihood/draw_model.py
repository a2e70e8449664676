"""Model of the draws of a scenario with ``[likelihood]``: weather, times, places, seas and sunlight at any wind."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.air.profile.aerosols import wind_kinks
from seaglint.air.profile.air_profile import AirProfile, model_profile
from seaglint.air.profile.band_laws import Spectroscopy, with_gases
from seaglint.air.profile.profile_atmosphere import WindyAir
from seaglint.air.protocol import wavenumber_grid
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError, ScenarioError
from seaglint.base.limits import FOAM_WINDS, NAVY_AEROSOL_WIND, WIND_PROFILE
from seaglint.climate.conditions import (
    Conditions,
    GeographicRegion,
    Times,
    WeatherOfDraws,
    bandwidths,
    conditions,
    smoothed,
    times_and_places,
    timestamp,
)
from seaglint.climate.ephemeris import Ephemeris
from seaglint.climate.glint_radiance import DetectionCurve, Search, WindSlopes, seas
from seaglint.climate.mirrored_moonlight import MoonBand, Moons
from seaglint.climate.mirrored_sunlight import AirAt, MirroredLight, mirrored_light
from seaglint.climate.moon_position import MoonEphemeris
from seaglint.climate.weather_selection import GeographicBox
from seaglint.climate.weather_table import WeatherTable, stand_ins_told
from seaglint.climate.world_weather import NAME, time_of_year
from seaglint.facet.foam import FoamCover
from seaglint.facet.legs import VIEWER, Shadowing
from seaglint.facet.sea_view import LOWER_LIMB, BandSum
from seaglint.formats.lowtran.deck import MODELS
from seaglint.formats.weather.weather_cells import read_cells
from seaglint.formats.weather.weather_file import NORTH_ATLANTIC, read_weather
from seaglint.optics.solar_spectrum import exoatmospheric_irradiance
from seaglint.scenario.model import Scenario
from seaglint.scenario.moon import moon_position
from seaglint.scenario.records.atmosphere_table import TableAtmosphereSettings
from seaglint.scenario.records.likelihood_table import Likelihood
from seaglint.scenario.records.sea_tables import FlatSlopes, MeasuredWaves, SpectrumSlopes
from seaglint.scenario.sun import SunPosition, sun_position
from seaglint.sea.foam.coverage_laws import coverage
from seaglint.sea.slopes.cox_munk import WIND_HEIGHT, cox_munk_isotropic
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.profile_air import model_air, requested_gases
from seaglint.studies.build.waves_and_slopes import slopes
from seaglint.studies.likelihood.climatology import Climatology, climatology_at, likelihood_table, place_law, which_place

_SHARED = (
    "light",
    "seas",
    "ephemeris",
    "bandwidth",
    "curve",
    "moonlight",
    "moon_ephemeris",
)  #: Tables that scenarios with the same air, sea and year share.

LOOK_COLUMNS = ("depression_deg", "azimuth_from_sun_deg", "height_m", "weight")


@dataclass(frozen=True, eq=False)
class LikelihoodModel:
    """Weather, times, places, seas and sunlight for the draws of one scenario. Make it with ``of``."""

    scenario: Scenario  #: Scenario with ``[likelihood]``.
    table: WeatherTable | None  #: Rows with wind and cover, in the order of the wind; None with the climatology.
    climatology: Climatology | None  #: Climatology of the world's seas, from whose laws weather is drawn; None with a table.
    models: tuple[str, ...]  #: Model atmospheres that the weather names; the scenario's where it names none.
    row_model: NDArray[np.int64]  #: Place among them of each row's model, or of each model of the climatology.
    winds: tuple[float, float]  #: Lowest and highest wind of seas and air [m/s].
    looks: Mapping[str, FloatArray]  #: Columns of a table of looks, angles in radians; empty without one.
    notes: tuple[str, ...]  #: Remarks on the data, with counts.

    @classmethod
    def of(cls, scenario: Scenario, weather: WeatherTable | None = None) -> LikelihoodModel:
        """Read the weather, or take it as given.

        Raises
        ------
        ScenarioError, DataError, DomainError
            Files or settings that models refuse.
        """
        settings = likelihood_table(scenario)
        notes = [*which_place(scenario), *_about_moon(scenario)]
        if weather is None and (settings.weather is None or settings.of_the_world):
            found = climatology_at(scenario)
            if isinstance(found, Climatology):
                top = _strongest(scenario)
                notes += found.notes(top)
                _air_of_strong_winds(scenario, top, notes)
                models, row_model = found.models
                _foam_of_strong_winds(scenario, top, notes)
                looks = _looks(settings, notes)
                return cls(scenario, None, found, models=models, row_model=row_model, winds=(0.0, top), looks=looks, notes=tuple(notes))
            notes.append(f"likelihood.weather is not given, and {found}: the packaged table {NORTH_ATLANTIC} serves")
        if weather is None:
            file = read_weather(settings.weather or NORTH_ATLANTIC)
            weather = file.table
            notes += () if settings.weather is None else file.remarks
        table, dropped = _complete(weather, settings)
        if dropped:
            notes.append(f"{dropped} of {len(weather)} rows of weather left out: wind speed or cloud cover missing")
        table = _of_region(table, settings, notes).ordered("wind_speed_m_s", "cloud_cover")
        if table.missing_months and settings.months != () and scenario.sun is None and not settings.place_from_weather:
            notes.append(f"weather: {stand_ins_told(table.stand_ins)}")
        if scenario.sun is not None and not scenario.sun.model_fields_set:
            notes.append(
                f"the Sun stands at zenith {scenario.sun.zenith_deg:g} deg, as no other is given; add [sun], or [place] or a region "
                "for all of the year"
            )
        models, row_model = _models(scenario, table)
        winds = _winds(scenario, table, notes)
        _foam_of_strong_winds(scenario, winds[1], notes)
        looks = _looks(settings, notes)
        return cls(scenario, table, None, models=models, row_model=row_model, winds=winds, looks=looks, notes=tuple(notes))

    @property
    def settings(self) -> Likelihood:
        """The scenario's table ``[likelihood]``."""
        return likelihood_table(self.scenario)

    @cached_property
    def sun(self) -> SunPosition | None:
        """Stated Sun; None where it is drawn."""
        return sun_position(self.scenario) if self.scenario.sun is not None else None

    @cached_property
    def when(self) -> Times | float | None:
        """Law of the time."""
        if self.scenario.sun is not None:
            return None
        if self.scenario.time is not None:
            return timestamp(self.scenario.time.utc)
        return Times(self.settings.year, self.settings.months or (), self.settings.hours_utc)

    @cached_property
    def where(self) -> GeographicRegion | tuple[float, float] | None:
        """Law of the place."""
        return place_law(self.scenario)

    @cached_property
    def ephemeris(self) -> Ephemeris:
        """Ephemeris of the Sun over all times that are drawn."""
        when = self.when
        return Ephemeris.between(when, when) if isinstance(when, float) else Ephemeris.of_year(self.settings.year)

    @cached_property
    def moon_ephemeris(self) -> MoonEphemeris | None:
        """Ephemeris of the Moon over all times that are drawn; None without a Moon, or with a given one."""
        moon, when = self.scenario.moon, self.when
        if moon is None or moon.given:
            return None
        assert when is not None  # the scenario refuses a Moon of date and place beside a given Sun
        return MoonEphemeris.between(when, when) if isinstance(when, float) else MoonEphemeris.of_year(self.settings.year)

    def moons(self, where: Conditions, count: int) -> Moons | None:
        """Return the Moon of each draw; None without ``[moon]``."""
        if self.scenario.moon is None:
            return None
        if self.moon_ephemeris is not None:
            at = self.moon_ephemeris.at(where.time, where.latitude, where.longitude)
            return Moons(*(np.asarray(getattr(at, name)) for name in Moons._fields))
        moon = moon_position(self.scenario)
        assert moon is not None
        limb = LOWER_LIMB if moon.bright_limb is None else moon.bright_limb
        given = (moon.zenith, moon.azimuth, moon.phase, moon.distance_m, limb, moon.sun_distance_au)
        return Moons(*(np.full(count, value) for value in given))

    @cached_property
    def moonlight(self) -> tuple[MoonBand, MirroredLight]:
        """Moonlight above the air, and through the air of every model atmosphere."""
        over = scenario_physics.band(self.scenario)
        air = self._air[0](self.models[0], 0.0)
        in_band = BandSum.of(over, air)
        band = MoonBand.of(in_band.wavenumber_cm, exoatmospheric_irradiance(in_band.wavenumber_cm) * in_band.weights)
        return band, self._mirrored(band.ratios)

    def conditions(
        self,
        u: Mapping[str, FloatArray],
        places: tuple[FloatArray, FloatArray] | None = None,
        some: NDArray[np.intp] | None = None,
        *,
        by_daylight: bool = False,
    ) -> Conditions:
        """Draw times, places and rows of weather at uniform numbers; ``places`` [deg] replace the law of the place.

        ``some`` are the only rows to draw from.
        """
        where = self.where if places is None else places
        # nights count as much as days where the Moon gives light
        by_daylight = by_daylight and self.scenario.moon is None
        if self.climatology is None:
            assert self.table is not None  # one of both is given
            return conditions(self.table, u, self.when, where, some, by_daylight=by_daylight)
        law = where if isinstance(where, tuple) else self.climatology.places
        when = self.when
        if when is None:  # under a given Sun the weather has times of its own
            when, by_daylight = Times(self.settings.year, self.settings.months or (), self.settings.hours_utc), False
        return times_and_places(u, when, law, by_daylight=by_daylight)

    def weather(self, where: Conditions, u: Mapping[str, FloatArray]) -> WeatherOfDraws:
        """Wind, cover and model atmosphere of draws."""
        if self.climatology is None:
            return self._weather_of_rows(where, u)
        latitude, longitude = where.latitude, where.longitude
        if isinstance(self.where, tuple):
            # A place in a bight or harbour has the weather of the nearest sea.
            latitude, longitude = (np.full(latitude.shape, value) for value in self.climatology.world.sea_at(*self.where)[:2])
        drawn = self.climatology.world.draw(time_of_year(where.time), latitude, longitude, u["row"], u["cover"])
        return drawn._replace(model=self.row_model[drawn.model])

    def _weather_of_rows(self, where: Conditions, u: Mapping[str, FloatArray]) -> WeatherOfDraws:
        """Return the weather of drawn rows, varied by the smooth bootstrap where it is requested."""
        table = self.table
        assert table is not None  # the climatology has no rows
        wind, cover, wind_from = (table[name][where.rows] for name in ("wind_speed_m_s", "cloud_cover", "wind_from_deg"))
        if self.bandwidth:
            # Away from 0 and 1, where the Gaussian quantile is infinite.
            noise = np.clip(np.column_stack([u[f"smooth_{name}"] for name in self.bandwidth]), 1e-12, 1.0 - 1e-12)
            rows = smoothed(table, where.rows, noise, self.bandwidth)
            wind, cover = rows["wind_speed_m_s"], rows["cloud_cover"]
        return WeatherOfDraws(wind, cover, wind_from, self.row_model[where.rows])

    @property
    def heights(self) -> tuple[float, float]:
        """Lowest and highest sensor [m]."""
        if "height_m" in self.looks:
            return float(self.looks["height_m"].min()), float(self.looks["height_m"].max())
        return self.settings.height_m or (self.scenario.sensor.height_m,) * 2

    @property
    def depression(self) -> tuple[float, float]:
        """Lowest and highest depression of a look [rad], field of view included."""
        low, high = np.radians(self.settings.depression_deg)
        if "depression_deg" in self.looks:
            low, high = self.looks["depression_deg"].min(), self.looks["depression_deg"].max()
        # Half of the field above and below the line of sight.
        more = 0.5 * math.radians(self.settings.field_deg[1]) if self.settings.case == "field-of-view" else 0.0
        return float(low) - more, min(float(high) + more, 0.5 * math.pi)

    @property
    def search(self) -> Search:
        """Directions that are searched as one look."""
        low, high = self.depression
        depressions = 12 if high > low + 1e-9 else 1
        match self.settings.case:
            case "single-look":
                return Search()
            case "trajectory":
                return Search(depressions, 1, 4 if depressions > 1 else 0)
            case "field-of-view":
                half = 0.5 * math.radians(self.settings.field_deg[0])
                return Search(depressions, 5 if half > 0.0 else 1, 4, half)

    @cached_property
    def light(self) -> MirroredLight:
        """Sunlight through the air of every model atmosphere."""
        return self._mirrored((None,))

    def _mirrored(self, ratios: Sequence[FloatArray | None]) -> MirroredLight:
        air_at, winds, kinks = self._air
        over, water = scenario_physics.band(self.scenario), scenario_physics.water(self.scenario)
        article = self.scenario.mean.mode == "article"
        return mirrored_light(
            air_at, self.models, winds, self.heights, self.depression, over, water, kinks=kinks, article=article, ratios=ratios
        )

    @cached_property
    def _air(self) -> tuple[AirAt, tuple[float, float] | None, list[Sequence[float]]]:
        """Air of a model atmosphere at a wind, its range of winds [m/s], and the winds of its kinks."""
        scenario, over = self.scenario, scenario_physics.band(self.scenario)
        of_table = isinstance(scenario.atmosphere, TableAtmosphereSettings)
        same = None if of_table else scenario_physics.atmosphere(scenario, over)

        edges, article = (over.min_um, over.max_um), scenario.mean.mode == "article"
        profiles: dict[str, AirProfile] = {}
        windy: dict[str, WindyAir] = {}
        spectroscopy: Spectroscopy = "lblrtm"
        if isinstance(scenario.atmosphere, TableAtmosphereSettings):
            spectroscopy, gases = scenario.atmosphere.spectroscopy, requested_gases(scenario.atmosphere)
            profiles = {model: with_gases(model_profile(model), gases) for model in self.models}
            windy = {model: WindyAir.of(profile, wavenumber_grid(*edges), spectroscopy) for model, profile in profiles.items()}

        def air_at(model: str, wind: float) -> Any:
            if same is not None:
                return same
            # The article's mode needs the emission of the air as well.
            return model_air(model, wind, edges, "lowtran", spectroscopy) if article else windy[model].at(wind)

        # Kinks of the haze's laws in the wind are nodes of the interpolation.
        winds = (0.0, min(self.winds[1], NAVY_AEROSOL_WIND[1])) if of_table else None
        return air_at, winds, [wind_kinks(profile) for profile in profiles.values()]

    @cached_property
    def seas(self) -> WindSlopes:
        """Slopes at any wind."""
        scenario = self.scenario
        article = scenario.mean.mode == "article"
        shadowing = VIEWER if article else Shadowing.of(scenario.mean.shadowing or "nested")

        def slopes_at(wind: float) -> SlopeStatistics:
            if article:
                return cox_munk_isotropic(wind, height=WIND_HEIGHT)
            return slopes(scenario.model_copy(update={"wind": scenario.wind.model_copy(update={"speed_m_s": wind, "from_deg": 180.0})}))

        return seas(slopes_at, self.winds, shadowing, foam_by_wind(scenario))

    @cached_property
    def bandwidth(self) -> dict[str, float]:
        """Bandwidth of the smooth bootstrap, by column; empty without."""
        return bandwidths(self.table) if self.settings.smooth and self.table is not None else {}

    @cached_property
    def curve(self) -> DetectionCurve | None:
        """Chance of detection against contrast; None where none is stated."""
        path = self.settings.detection_curve
        if path is None:
            return None
        cells = read_cells(path)
        for name in ("contrast_w_m2_sr", "pd"):
            if name not in cells.header:
                raise DataError(f"{path}: column {name} missing; found: {', '.join(cells.header)}; needed: contrast_w_m2_sr, pd")
        contrast, pd = cells.numbers("contrast_w_m2_sr"), cells.numbers("pd")
        if not (contrast.size > 1 and np.all(np.diff(contrast) > 0.0) and np.all((pd >= 0.0) & (pd <= 1.0))):
            raise DataError(f"{path}: needs two rows or more of ascending contrast_w_m2_sr with pd of 0 to 1; sort and correct it")
        return DetectionCurve(contrast, pd)

    @property
    def gives_wind_direction(self) -> bool:
        """True if the scenario states the wind's direction."""
        return "wind" in self.scenario.model_fields_set and "from_deg" in self.scenario.wind.model_fields_set

    @property
    def weather_name(self) -> str | None:
        """File of the weather, or its name in the package; None for a packaged table that the scenario does not name."""
        if self.climatology is not None:
            return NAME
        return None if self.settings.weather is None else str(self.settings.weather)

    def share(self, other: LikelihoodModel) -> None:
        """Take over the tables of a model with the same air, sea, geometry and year."""
        # Cached properties are copied: the other model need not have computed them before.
        self.__dict__.update({name: getattr(other, name) for name in _SHARED})

    def reaching(self, wind: float) -> LikelihoodModel:
        """Return the model with tables of air and sea up to a wind [m/s], at most the strongest of the law of slopes."""
        top = min(_strongest(self.scenario), wind)
        return self if top <= self.winds[1] else replace(self, winds=(self.winds[0], top))

    def of_sea(self, scenario: Scenario) -> LikelihoodModel:
        """Return the model for a scenario that differs in its sea's short waves alone; all but the slopes is shared."""
        new = replace(self, scenario=scenario)
        # What this model has computed is shared; the slopes alone are computed again.
        new.__dict__.update({name: value for name, value in self.__dict__.items() if name in (*_SHARED, "_air") and name != "seas"})
        return new

    def of_months(self, months: tuple[int, ...]) -> LikelihoodModel:
        """Return the model for other months; tables of air and sea are shared."""
        settings = self.settings.model_copy(update={"months": months})
        new = replace(self, scenario=self.scenario.model_copy(update={"likelihood": settings}))
        new.share(self)
        return new


def require_no_moon(scenario: Scenario, what: str) -> None:
    """Refuse ``[moon]`` where draws know the Sun alone; ``what`` begins the text."""
    if scenario.moon is not None:
        raise ScenarioError(f"{what} has the mirrored Sun alone, no Moon; leave out [moon]")


def _about_moon(scenario: Scenario) -> list[str]:
    """Return a note where the Moon gives light; settings that know the Sun alone are refused."""
    if scenario.moon is None:
        return []
    if likelihood_table(scenario).azimuths == "integrated":
        require_no_moon(scenario, "likelihood.azimuths = 'integrated'")
    text = "glint is the Sun's and the Moon's, and clouds count in front of the brighter one; azimuths of looks are from the Sun"
    return [f"[moon]: {text}, and are drawn, evenly: intervals of rare thresholds are wide"]


def _complete(table: WeatherTable, settings: Likelihood) -> tuple[WeatherTable, int]:
    """Return the rows with wind and cover, and the number of others; an error names the file."""
    try:
        return table.complete()
    except DomainError as error:
        raise DataError(f"{settings.weather or 'weather'}: {error}") from error


def _of_region(table: WeatherTable, settings: Likelihood, notes: list[str]) -> WeatherTable:
    """Return the rows inside the region, where both are known; rows without a place count as inside."""
    if (
        settings.place is not None
        or settings.latitudes_deg is None
        or settings.longitudes_deg is None
        or "latitude_deg" not in table
        or "longitude_deg" not in table
    ):
        return table
    box = GeographicBox(settings.longitudes_deg[0], settings.latitudes_deg[0], settings.longitudes_deg[1], settings.latitudes_deg[1])
    unknown = np.isnan(table["latitude_deg"]) | np.isnan(table["longitude_deg"])
    inside = unknown | box.holds(table["latitude_deg"], table["longitude_deg"])
    if not np.any(inside & (table["weight"] > 0.0)):
        raise DataError(
            f"{settings.weather}: no row lies in likelihood.latitudes_deg = {list(settings.latitudes_deg)}, longitudes_deg = "
            f"{list(settings.longitudes_deg)}; choose another region or another weather table"
        )
    if not inside.all():
        notes.append(f"{int((~inside).sum())} of {len(table)} rows of weather left out: outside the region")
    return table.take(inside)


def _models(scenario: Scenario, table: WeatherTable) -> tuple[tuple[str, ...], NDArray[np.int64]]:
    """Return the model atmospheres, and the place of each row's model among them."""
    if not isinstance(scenario.atmosphere, TableAtmosphereSettings):
        return (scenario.atmosphere.source,), np.zeros(len(table), dtype=np.int64)
    names = np.where(table.text("atmosphere") == "", scenario.atmosphere.model, table.text("atmosphere"))
    known = sorted(MODELS)
    for row, name in enumerate(names.tolist()):
        if name not in known:
            raise DataError(
                f"weather, row {row + 1} by wind: atmosphere = '{name}' is unknown; allowed: {', '.join(known)}, or leave it empty"
            )
    models, place = np.unique(names, return_inverse=True)
    return tuple(models.tolist()), np.asarray(place, dtype=np.int64)


def _strongest(scenario: Scenario) -> float:
    """Return the strongest wind of the sea's slopes [m/s]."""
    law = scenario.sea.slopes
    if scenario.sea.uncertainty != "none":
        return NAVY_AEROSOL_WIND[1]  # the drawn short waves follow the weather's wind, whatever the longer ones
    if isinstance(law, SpectrumSlopes | FlatSlopes):
        if isinstance(law, SpectrumSlopes) and scenario.sea.spectrum.kind not in ("elfouhaily", "pierson-moskowitz", "jonswap"):
            measured = isinstance(scenario.sea.spectrum, MeasuredWaves)
            why = "its waves are measured at some winds only" if measured else "its waves do not follow the weather's wind"
            raise ScenarioError(
                f"sea.slopes.kind = 'spectrum' with sea.spectrum.kind = '{scenario.sea.spectrum.kind}': {why}; choose a spectrum that "
                "follows every wind ('elfouhaily'), or slopes by wind (sea.slopes.kind = 'cox-munk-anisotropic')"
            )
        return WIND_PROFILE[1] if isinstance(law, FlatSlopes) else NAVY_AEROSOL_WIND[1]
    return WIND_PROFILE[1] if law.extrapolate else law.winds[1]


def _air_of_strong_winds(scenario: Scenario, strongest: float, notes: list[str]) -> None:
    if scenario.atmosphere.source == "table" and strongest > NAVY_AEROSOL_WIND[1]:
        notes.append(f"the air of winds above {NAVY_AEROSOL_WIND[1]:g} m/s is that of {NAVY_AEROSOL_WIND[1]:g} m/s")


def _winds(scenario: Scenario, table: WeatherTable, notes: list[str]) -> tuple[float, float]:
    """Return the winds of seas and air; stronger winds of the weather count as the strongest, with their number in a note."""
    top = _strongest(scenario)
    strong = table["wind_speed_m_s"] > top
    if strong.any():
        share = float(table.probability[strong].sum())
        notes.append(
            f"{int(strong.sum())} rows of weather ({100 * share:.2g} % of the weight) have winds above {top:g} m/s, taken as {top:g}"
        )
    _air_of_strong_winds(scenario, min(top, float(table["wind_speed_m_s"].max())), notes)
    return 0.0, min(top, max(float(table["wind_speed_m_s"].max()) + 2.0, 4.0))


def foam_by_wind(scenario: Scenario) -> Callable[[float], FoamCover] | None:
    """Return the foam at any wind, with the nearest wind of its law where the scenario does not extrapolate; None without foam."""
    foam = scenario.sea.foam
    if foam is None:
        return None
    low, high = (0.0, math.inf) if foam.extrapolate else FOAM_WINDS[foam.law]
    return lambda wind: FoamCover(0.0 if wind < low else coverage(foam.law, min(wind, high), extrapolate=foam.extrapolate))


def _foam_of_strong_winds(scenario: Scenario, strongest: float, notes: list[str]) -> None:
    """Note that foam of winds above those of its law is the law's strongest."""
    foam = scenario.sea.foam
    if foam is not None and not foam.extrapolate and strongest > FOAM_WINDS[foam.law][1]:
        notes.append(f"foam of winds above {FOAM_WINDS[foam.law][1]:g} m/s, the strongest of {foam.law}, is taken as at that wind")


def _looks(settings: Likelihood, notes: list[str]) -> dict[str, FloatArray]:
    """Return the columns of a table of looks, angles in radians; empty without a table."""
    if settings.looks is None:
        return {}
    cells = read_cells(settings.looks)
    columns = {name: cells.numbers(name) for name in LOOK_COLUMNS if name in cells.header}
    unknown = [name for name in cells.header if name not in LOOK_COLUMNS]
    if unknown or not set(columns) - {"weight"}:
        raise DataError(
            f"{settings.looks}: columns are {', '.join(cells.header)}; allowed: {', '.join(LOOK_COLUMNS)}, one of the first three at least"
        )
    ranges = {
        "depression_deg": (-10.0, 90.0),
        "azimuth_from_sun_deg": (-360.0, 360.0),
        "height_m": (2.0, 10_000.0),
        "weight": (0.0, math.inf),
    }
    for name, values in columns.items():
        low, high = ranges[name]
        bad = np.flatnonzero(~((values >= low) & (values <= high) & np.isfinite(values)))
        if bad.size:
            raise DataError(f"{cells.where(int(bad[0]))}, column {name}: {values[bad[0]]:g} is outside {low:g} to {high:g}; correct it")
    if "weight" in columns and not columns["weight"].sum() > 0.0:
        raise DataError(f"{settings.looks}: all weights are 0; give at least one look a weight above 0")
    notes.append(f"looks drawn from {len(cells.rows)} rows of {settings.looks}")
    return {name: np.radians(values) if name.endswith("_deg") else values for name, values in columns.items()}
