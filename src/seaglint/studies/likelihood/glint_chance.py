r"""How often glint matters: draws of weather, Sun and geometry through the model of the mirrored Sun (the source article's Eq. 10).

.. math:: P = \int P_{illum}(\Theta)\,I(\Theta)\,p(\Theta)\,d\Theta

with I = 1 where the mirrored Sun at the sensor exceeds a threshold, and clouds taken as their chance rather than drawn.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.free_form import JsonObject
from seaglint.climate import draws as by
from seaglint.climate.conditions import CloudLaw, Conditions, GeographicRegion, Times, conditions, illuminated, months_of, smoothed
from seaglint.climate.draws import Estimate, SamplingPlan, estimate, strata
from seaglint.climate.exceeding_azimuths import azimuth_shares
from seaglint.climate.glint_radiance import Looks, detected, deviation, exceeded_by, exceeds, looks, passes
from seaglint.climate.likelihood_summary import (
    DrawnWeather,
    ExceededContrast,
    LikelihoodSummary,
    StratumChance,
    SunUp,
    ThresholdChance,
)
from seaglint.climate.weather_table import WeatherTable
from seaglint.scenario.model import Scenario
from seaglint.studies.build import scenario_physics
from seaglint.studies.likelihood.draw_model import LikelihoodModel

#: Uniform numbers of a draw, those that matter most first.
DIMENSIONS: Final = ("hour", "row", "depression", "day", "across", "azimuth", "cover", "wind", "height", "along")

NEEDED_SHARES: Final = (0.5, 0.1, 0.05, 0.01, 0.001)  #: Shares of looks for which the contrast exceeded by glint is reported.

#: Draws up to which azimuths = 'auto' integrates: some 4 s of processor time. A million looks of their own take less.
INTEGRATED: Final = 131_072

_SHINES: Final = 0.5 * math.pi + 0.3  #: Zenith angle of the Sun beyond which no place in view can be lit [rad].


@dataclass(frozen=True, eq=False)
class Draws:
    """Drawn conditions and the radiance of each look [(total,) each]; NaN times and places where the Sun is given."""

    plan: SamplingPlan
    radiance: FloatArray
    illuminated: FloatArray  #: Chance that clouds leave the Sun free [1].
    wind: FloatArray
    cover: FloatArray
    time: FloatArray
    latitude: FloatArray
    longitude: FloatArray
    solar_zenith: FloatArray
    azimuth_from_sun: FloatArray
    solar_azimuth: FloatArray
    height: FloatArray
    found: Looks
    weight: FloatArray  #: Weight of each draw [1], 1 on average: more hours are drawn while the Sun is low than there are.
    #: Share of the azimuths [1] that exceed each threshold above 0 [W m-2 sr-1]; empty where azimuths are drawn.
    shares: Mapping[float, FloatArray]


@dataclass(frozen=True, eq=False)
class GlintLikelihood:
    """Chances of glint, with where they come from. Made by :func:`likelihood`."""

    model: LikelihoodModel
    draws: Draws
    thresholds: tuple[float, ...]
    estimates: tuple[Estimate, ...]
    strata: tuple[tuple[StratumChance, ...], ...]  #: Strata of every threshold.
    values: tuple[FloatArray, ...]  #: Values of every threshold and draw.

    @property
    def sun_up(self) -> Estimate:
        """Chance that the Sun's centre is above the horizon [1]."""
        return estimate((self.draws.solar_zenith < 0.5 * math.pi).astype(np.float64), self.draws.plan, weight=self.draws.weight)

    def summary(self) -> LikelihoodSummary:
        """Return plain numbers of everything but the draws."""
        settings, plan = self.model.wanted, self.draws.plan
        rate = self._looks_per_hour if settings.quantity == "false-alarms" else None
        results = []
        for threshold, chance in zip(self.thresholds, self.estimates, strict=True):
            result = ThresholdChance(threshold, chance.value, [chance.low, chance.high])
            if rate is not None:
                ends = [chance.low * rate, chance.high * rate]
                result = replace(result, false_alarms_per_hour=chance.value * rate, false_alarms_per_hour_interval=ends)
            results.append(result)
        up = self.sun_up
        needed = exceeded_by(self.draws.radiance, self.draws.illuminated, NEEDED_SHARES, self.draws.weight)
        return LikelihoodSummary(
            quantity=settings.quantity,
            case=settings.case,
            results=results,
            sun_up=SunUp(up.value, [up.low, up.high]),
            sun_free_of_clouds=float(np.average(self.draws.illuminated, weights=self.draws.weight)),
            contrast_exceeded_by_glint=[ExceededContrast(share, float(value)) for share, value in zip(NEEDED_SHARES, needed, strict=True)],
            samples=plan.total,
            scramblings=plan.scramblings,
            azimuths="integrated" if self.draws.shares else "drawn",
            confidence=0.95,
            clouds=cloud_law(self.model),
            weather=DrawnWeather(
                None if settings.weather is None else str(settings.weather), len(self.model.table), list(self.model.models)
            ),
            strata=[stratum for of_threshold in self.strata for stratum in of_threshold],
            notes=[*self.model.notes, *self._azimuth_notes],
        )

    def as_dict(self) -> JsonObject:
        """Return everything but the draws, for JSON."""
        return self.summary().as_dict()

    def month_by_hour(self) -> FloatArray | None:
        """Chance by month and hour of the Sun's day, of the first threshold [(12, 24)]; NaN without draws, None under a given Sun."""
        if self.model.when is None:
            return None
        month = months_of(self.draws.time) - 1
        hour = ((self.draws.time / 3600.0 + self.draws.longitude / 15.0) % 24.0).astype(np.int64) % 24
        cell = month * 24 + hour
        count, total = (np.bincount(cell, each, 288) for each in (self.draws.weight, self.draws.weight * self.values[0]))
        return np.asarray(np.divide(total, count, out=np.full(288, np.nan), where=count > 0.0)).reshape(12, 24)

    @property
    def _azimuth_notes(self) -> list[str]:
        settings = self.model.wanted
        if self.draws.shares or settings.azimuths == "drawn" or not settings.integrates or self.draws.plan.total <= INTEGRATED:
            return []
        return [f"azimuths drawn: more than {INTEGRATED} draws; likelihood.azimuths = 'integrated' has narrower intervals and takes longer"]

    @property
    def _looks_per_hour(self) -> float:
        """Independent looks of all pixels in an hour [1]: frames, but no more than one in a correlation time of glint."""
        sensor = self.model.scenario.sensor
        rate = min(sensor.frame_rate_hz, 1.0 / self.model.scenario.sea.glint.correlation_time_s)
        return 3600.0 * rate * sensor.pixels[0] * sensor.pixels[1]


def likelihood(
    scenario: Scenario, *, weather: WeatherTable | None = None, progress: Progress | None = None, model: LikelihoodModel | None = None
) -> GlintLikelihood:
    """Chances that the mirrored Sun exceeds the scenario's thresholds.

    Parameters
    ----------
    scenario : Scenario
        With a table ``[likelihood]``.
    weather : WeatherTable, optional
        Instead of the file that it names.
    progress : callable, optional
        Called with steps done and all of them.
    model : LikelihoodModel, optional
        Made before, for many scenarios of the same air and sea.

    Raises
    ------
    SeaglintError
        What files and models refuse.
    """
    tell = progress or (lambda done, total: None)
    tell(0, 3)
    model = model or LikelihoodModel.of(scenario, weather)
    tell(1, 3)
    drawn = draw(model)
    tell(2, 3)
    values = tuple(measured(model, drawn, threshold) for threshold in model.wanted.threshold_w_m2_sr)
    estimates = tuple(estimate(v, drawn.plan, weight=drawn.weight) for v in values)
    classes, of_looks = _classes(model, drawn), _classes_of_looks(drawn)
    one_look = values if not drawn.shares else tuple(measured(model, replace(drawn, shares={}), t) for t in model.wanted.threshold_w_m2_sr)
    by_threshold = tuple(
        (*strata(v, drawn.plan, classes, t, weight=drawn.weight), *strata(one, drawn.plan, of_looks, t, weight=drawn.weight))
        for t, v, one in zip(model.wanted.threshold_w_m2_sr, values, one_look, strict=True)
    )
    tell(3, 3)
    return GlintLikelihood(model, drawn, model.wanted.threshold_w_m2_sr, estimates, by_threshold, values)


def cloud_law(model: LikelihoodModel) -> CloudLaw:
    """Law of clouds of the scenario's case."""
    settings = model.wanted
    if settings.clouds != "auto":
        return settings.clouds
    return "cover" if settings.case == "single-look" else "overcast"


def draw(
    model: LikelihoodModel, *, samples: int | None = None, seed: int | None = None, plain: bool = False, azimuth: float | None = None
) -> Draws:
    """Draw conditions and looks, and see what they see; an ``azimuth`` from the Sun [rad] stands in for the scenario's law.

    ``plain`` takes random numbers instead of Sobol points for the same integrand.
    """
    settings = model.wanted
    plan = SamplingPlan.of(settings.samples if samples is None else samples)
    u = numbers(model, plan, model.scenario.seed if seed is None else seed, plain=plain)
    whole = settings.azimuths == "integrated" or (settings.azimuths == "auto" and plan.total <= INTEGRATED)
    whole = whole and settings.integrates and azimuth is None and "azimuth_from_sun_deg" not in model.looks
    where = conditions(model.table, u, model.when, model.where, by_daylight=True)
    return seen(model, u, where, plan, azimuth, integrated=whole)


def numbers(model: LikelihoodModel, plan: SamplingPlan, seed: int, *, plain: bool = False) -> dict[str, FloatArray]:
    """Uniform numbers of draws by name [(total,) each]; 0 for those on which the scenario does not depend."""
    names = (*_varying(model), *(f"smooth_{name}" for name in model.bandwidth))
    points = plan.uniform(len(names), seed, plain=plain)
    return {name: np.zeros(plan.total) for name in DIMENSIONS} | {name: np.ascontiguousarray(points[:, i]) for i, name in enumerate(names)}


def seen(
    model: LikelihoodModel,
    u: dict[str, FloatArray],
    where: Conditions,
    plan: SamplingPlan,
    azimuth: float | None = None,
    *,
    integrated: bool = False,
) -> Draws:
    """Evaluate looks in conditions that are drawn already; ``integrated`` evaluates the shares of their azimuths too."""
    settings, table = model.wanted, model.table
    wind, cover, wind_from = (table[name][where.rows] for name in ("wind_speed_m_s", "cloud_cover", "wind_from_deg"))
    if model.bandwidth:
        noise = np.clip(np.column_stack([u[f"smooth_{name}"] for name in model.bandwidth]), 1e-12, 1.0 - 1e-12)
        rows = smoothed(table, where.rows, noise, model.bandwidth)
        wind, cover = rows["wind_speed_m_s"], rows["cloud_cover"]
    missing = model.scenario.wind.from_deg if model.gives_wind_direction else 360.0 * u["wind"]
    wind_to = np.radians(np.where(np.isnan(wind_from), missing, wind_from) + 180.0)
    sun = model.sun
    if sun is not None:
        zenith, towards, factor = (np.full(wind.size, x) for x in (sun.zenith, sun.azimuth, sun.irradiance_factor))
    else:
        zenith, towards, factor = model.ephemeris.at(where.time, where.latitude, where.longitude)
    depression, beside, height = _geometry(model, u)
    if azimuth is not None:
        beside = np.full(wind.size, azimuth)
    free = illuminated(cloud_law(model), cover, 0.5 * math.pi - zenith, overcast=settings.overcast_cover, aspect=settings.cloud_aspect)
    columns = [model.row_model[where.rows].astype(np.float64), wind, wind_to, height, zenith, towards, factor, towards + beside, depression]
    at = np.flatnonzero((zenith < _SHINES) & (free > 0.0))
    chosen = np.empty((at.size, len(columns)))
    for i, column in enumerate(columns):
        chosen[:, i] = column[at]
    sighted = _everywhere(looks(chosen, model.light, model.seas, model.search), at, wind.size)
    weight = np.ones(wind.size) if where.weight is None else where.weight
    return Draws(
        plan,
        sighted.radiance,
        free,
        wind,
        cover,
        where.time,
        where.latitude,
        where.longitude,
        zenith,
        beside,
        towards,
        height,
        sighted,
        weight,
        _shares(model, chosen, at, wind.size) if integrated else {},
    )


def _shares(model: LikelihoodModel, chosen: FloatArray, at: NDArray[np.intp], total: int) -> dict[float, FloatArray]:
    """Shares of azimuths by threshold above 0; 0 where the Sun is down or behind clouds for sure."""
    thresholds = [t for t in model.wanted.threshold_w_m2_sr if t > 0.0]
    if not thresholds:
        return {}
    first, last = np.radians(model.wanted.azimuth_from_sun_deg).tolist()
    some = azimuth_shares(chosen, model.light, model.seas, (first, last), thresholds)
    out = {t: np.zeros(total) for t in thresholds}
    for i, share in enumerate(out.values()):
        share[at] = some[:, i]
    return out


def _varying(model: LikelihoodModel) -> list[str]:
    """Uniform numbers on which the draws of a scenario depend: points of fewer dimensions are more even."""
    settings, (lowest, highest) = model.wanted, model.heights
    alone = settings.case == "single-look"
    times, places = isinstance(model.when, Times), isinstance(model.where, GeographicRegion) and model.sun is None
    depends = {
        "azimuth": settings.azimuth_from_sun_deg[0] < settings.azimuth_from_sun_deg[1],
        "hour": times,
        "row": True,
        "cover": len(model.table) > 1,
        "day": times,
        "depression": bool(model.looks) or (alone and settings.depression_deg[0] < settings.depression_deg[1]),
        "across": places,
        "wind": not model.gives_wind_direction,
        "height": lowest < highest or bool(model.looks),
        "along": places,
    }
    return [name for name in DIMENSIONS if depends[name]]


def _everywhere(some: Looks, at: NDArray[np.intp], total: int) -> Looks:
    """Looks among those that are passed over, whose Sun is down or behind clouds for sure."""
    whole = np.zeros((5, total))
    whole[3] = -1.0
    for row, part in zip(whole, (some.radiance, some.chance, some.cos_incidence, some.elevation, some.sun_up), strict=True):
        row[at] = part
    return Looks(*whole)


def _geometry(model: LikelihoodModel, u: dict[str, FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Depression and azimuth from the Sun [rad], and height [m]."""
    settings = model.wanted
    (low, high), (first, last), (lowest, highest) = (
        np.radians(settings.depression_deg),
        np.radians(settings.azimuth_from_sun_deg),
        model.heights,
    )
    depression = low + (high - low) * u["depression"]
    beside = first + (last - first) * u["azimuth"]
    height = lowest + (highest - lowest) * u["height"]
    if model.looks:
        columns = dict(model.looks)
        size = next(iter(columns.values())).size
        cumulative = np.cumsum(columns.pop("weight", np.ones(size)))
        rows = np.minimum(np.searchsorted(cumulative, u["depression"] * cumulative[-1], side="right"), size - 1)
        depression, beside = (
            columns[name][rows] if name in columns else given
            for name, given in (("depression_deg", low + (high - low) * u["height"]), ("azimuth_from_sun_deg", beside))
        )
        height = columns["height_m"][rows] if "height_m" in columns else height
    return depression, beside, height


def measured(model: LikelihoodModel, drawn: Draws, threshold: float) -> FloatArray:
    """Return the averaged quantity of every draw [1]: chances between 0 and 1."""
    settings = model.wanted
    match settings.quantity:
        case "mean":
            share = drawn.shares.get(threshold)
            return drawn.illuminated * (exceeds(drawn.radiance, threshold) if share is None else share)
        case "mean-plus-sigma":
            return drawn.illuminated * exceeds(drawn.radiance + settings.sigmas * pixel_deviation(model, drawn), threshold)
        case "false-alarms":
            return drawn.illuminated * passes(drawn.radiance, pixel_deviation(model, drawn), threshold)
        case "detection":
            assert model.curve is not None  # the scenario's own rule
            return detected(drawn.radiance, drawn.illuminated, model.curve, threshold)


def pixel_deviation(model: LikelihoodModel, drawn: Draws) -> FloatArray:
    """Standard deviation of glint in one of the scenario's pixels [W m-2 sr-1]."""
    across, along = model.scenario.sensor.ifov_deg
    return deviation(drawn.found, drawn.height, math.radians(across) * math.radians(along), scenario_physics.glint_length(model.scenario))


def _classes(model: LikelihoodModel, drawn: Draws) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Quantities by which results are told apart, with the edges of their classes."""
    classes = {
        "wind_speed_m_s": (drawn.wind, by.WINDS),
        "sun_elevation_deg": (90.0 - np.degrees(drawn.solar_zenith), by.SUNS),
    }
    if model.when is not None:
        classes |= {
            "month": (months_of(drawn.time).astype(np.float64), np.arange(1.0, 14.0)),
            "hour_utc": (drawn.time % 86_400.0 / 3600.0, np.arange(25.0)),
            "hour_solar": ((drawn.time / 3600.0 + drawn.longitude / 15.0) % 24.0, np.arange(25.0)),
            "latitude_deg": (drawn.latitude, by.LATITUDES),
        }
    return classes


def _classes_of_looks(drawn: Draws) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Quantities of the one look that each draw has, whatever is integrated."""
    return {
        "azimuth_from_sun_deg": (np.degrees(drawn.azimuth_from_sun) % 360.0, by.BEARINGS),
        "bearing_deg": (np.degrees(drawn.azimuth_from_sun + drawn.solar_azimuth) % 360.0, by.BEARINGS),
    }
