r"""Likelihood of glint: draws of weather, Sun and geometry through the model of the mirrored Sun (the source article's Eq. 10).

.. math:: P = \int P_{illum}(\Theta)\,I(\Theta)\,p(\Theta)\,d\Theta

with I = 1 where the mirrored Sun at the sensor exceeds a threshold, and clouds included by their chance rather than drawn.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.air.protocol import slant_range
from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.free_form import JsonObject
from seaglint.climate import draws as by
from seaglint.climate.conditions import CloudLaw, Conditions, GeographicRegion, Times, WeatherOfDraws, illuminated, months_of
from seaglint.climate.draws import Estimate, SamplingPlan, estimate, strata
from seaglint.climate.exceeding_azimuths import azimuth_shares
from seaglint.climate.glint_radiance import Looks, detected, deviation, exceeded_by, exceeds, looks, passes, wave_deviation
from seaglint.climate.importance import DensityTree, Warped
from seaglint.climate.likelihood_summary import DrawnWeather, ExceededContrast, LightUp, LikelihoodSummary, StratumChance, ThresholdChance
from seaglint.climate.mirrored_moonlight import Moons, brighter, moonlit_looks
from seaglint.climate.weather_table import WeatherTable
from seaglint.facet.sea_view import sea_arc
from seaglint.radiance.lit_variance import WaveGlint
from seaglint.scenario.model import Scenario
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.waves_and_slopes import slopes
from seaglint.studies.likelihood.draw_model import LikelihoodModel
from seaglint.studies.sea_draws import SeaUnknown
from seaglint.studies.sea_draws import sea_draws as drawn_seas

#: Uniform numbers of a draw, those that matter most first.
DIMENSIONS: Final = ("hour", "row", "depression", "day", "across", "azimuth", "cover", "wind", "height", "along")

NEEDED_SHARES: Final = (0.5, 0.1, 0.05, 0.01, 0.001)  #: Shares of looks for which the contrast exceeded by glint is reported.

#: Draws up to which azimuths = 'auto' integrates: some 4 s of processor time. A million single looks take less.
INTEGRATED: Final = 131_072

#: Chance below which a threshold is rare: draws are concentrated where glint exceeds it. The first is for drawn, the second for integrated
#: azimuths. Even draws have as narrow intervals above it.
RARE: Final = (0.05, 1e-3)

_PILOT: Final = 16  #: Ratio of all draws to the draws of a round in which their density is found.
_PILOTS: Final = (4096, 16_384)  #: Least and largest number of draws of such a round.
_AT_SUN: Final = 4  #: Ratio of the draws of a round at the Sun's azimuth to those of another one: more exceed, and a single look is quick.
_STALLED: Final = 3  #: Number of rounds without a brighter draw after which the search ends.
_ROUNDS: Final = 24  #: Largest number of rounds.
_BRIGHT: Final = 0.08  #: Share of the draws of a round that exceed the level of its glint [1].
_BEFORE: Final = 0.5  #: Share of the probability that a round leaves to the density before [1].
_UNIFORM: Final = 0.2  #: Share of the probability of a factor that remains uniform [1]: a draw weighs at most five even ones, 25 with two.

_SHINES: Final = 0.5 * math.pi + 0.3  #: Zenith angle of the Sun beyond which no place in view can be lit [rad].


@dataclass(frozen=True, eq=False)
class Draws:
    """Drawn conditions and the result of each look [(total,) each]; times and places are NaN where the Sun is given."""

    plan: SamplingPlan  #: Number and order of the draws.
    where: Conditions  #: Weather row, time and place.
    weight: FloatArray  #: Weight of each draw [1], 1 on average: low Suns are drawn more often than they occur.
    sight: Looks  #: Results of the looks, with the radiance.
    illuminated: FloatArray  #: Chance that clouds leave the Sun free, or the brighter one of Sun and Moon [1].
    wind: FloatArray  #: Wind speed [m/s].
    solar_zenith: FloatArray  #: Zenith angle of the Sun [rad].
    azimuth_from_sun: FloatArray  #: Azimuth of the look from the Sun [rad].
    solar_azimuth: FloatArray  #: Azimuth of the Sun [rad].
    height: FloatArray  #: Height of the sensor [m].
    #: Share of the azimuths [1] that exceed each threshold above 0 [W m-2 sr-1]; empty where azimuths are drawn.
    shares: Mapping[float, FloatArray]
    aim: Aim | None = None  #: Density of the draws; None where they are even.
    moon_zenith: FloatArray | None = None  #: Zenith angle of the Moon [rad]; None without a Moon.

    @property
    def radiance(self) -> FloatArray:
        """Radiance of the mirrored Sun at the sensor [W m-2 sr-1]."""
        return self.sight.radiance

    @property
    def heaviest(self) -> float:
        """Largest ratio of the density of even draws to that of these [1]."""
        return 1.0 if self.aim is None else self.aim.heaviest


@dataclass(frozen=True, eq=False)
class GlintLikelihood:
    """Chances of glint with their draws. Made by ``likelihood``."""

    model: LikelihoodModel
    draws: Draws
    thresholds: tuple[float, ...]
    estimates: tuple[Estimate, ...]
    strata: tuple[tuple[StratumChance, ...], ...]  #: Strata of every threshold.
    values: tuple[FloatArray, ...]  #: Values of every threshold and draw.
    unknown: tuple[SeaUnknown, ...] = ()  #: Interval of every threshold over seas between the campaigns; empty without them.

    @property
    def sun_up(self) -> Estimate:
        """Chance that the Sun's centre is above the horizon [1]."""
        return self._up(self.draws.solar_zenith)

    @property
    def moon_up(self) -> Estimate | None:
        """Chance that the Moon's centre is above the horizon [1]; None without a Moon."""
        return None if self.draws.moon_zenith is None else self._up(self.draws.moon_zenith)

    def _up(self, zenith: FloatArray) -> Estimate:
        up = (zenith < 0.5 * math.pi).astype(np.float64)
        return estimate(up, self.draws.plan, weight=self.draws.weight, heaviest=self.draws.heaviest)

    def summary(self) -> LikelihoodSummary:
        """Return plain numbers of everything but the draws."""
        settings, plan = self.model.settings, self.draws.plan
        rate = self._looks_per_hour if settings.quantity == "false-alarms" else None
        results = []
        for threshold, chance in zip(self.thresholds, self.estimates, strict=True):
            result = ThresholdChance(threshold, chance.value, [chance.low, chance.high])
            if rate is not None:
                ends = [chance.low * rate, chance.high * rate]
                result = replace(result, false_alarms_per_hour=chance.value * rate, false_alarms_per_hour_interval=ends)
            results.append(result)
        results = [_with_seas(result, seas, rate) for result, seas in zip(results, self.unknown, strict=True)] if self.unknown else results
        up, moon_up = self.sun_up, self.moon_up
        needed = exceeded_by(self.draws.radiance, self.draws.illuminated, NEEDED_SHARES, self.draws.weight)
        return LikelihoodSummary(
            quantity=settings.quantity,
            case=settings.case,
            results=results,
            sun_up=LightUp(up.value, [up.low, up.high]),
            sun_free_of_clouds=float(np.average(self.draws.illuminated, weights=self.draws.weight)),
            contrast_exceeded_by_glint=[ExceededContrast(share, float(value)) for share, value in zip(NEEDED_SHARES, needed, strict=True)],
            samples=plan.total,
            scramblings=plan.scramblings,
            azimuths="integrated" if self.draws.shares else "drawn",
            sampling="even" if self.draws.aim is None else "towards glint",
            confidence=0.95,
            clouds=cloud_law(self.model),
            weather=DrawnWeather(
                self.model.weather_name, 0 if self.model.table is None else len(self.model.table), list(self.model.models)
            ),
            strata=[stratum for of_threshold in self.strata for stratum in of_threshold],
            notes=[*self.model.notes, *self._sampling_notes],
            moon_up=None if moon_up is None else LightUp(moon_up.value, [moon_up.low, moon_up.high]),
        )

    def as_dict(self) -> JsonObject:
        """Return everything but the draws, for JSON."""
        return self.summary().as_dict()

    def month_by_hour(self) -> FloatArray | None:
        """Return the chance by month and solar hour, of the first threshold [(12, 24)]; NaN without draws, None under a given Sun."""
        if self.model.when is None:
            return None
        month = months_of(self.draws.where.time) - 1
        cell = month * 24 + (_solar_hour(self.draws.where).astype(np.int64) % 24)
        count, total = (np.bincount(cell, each, 288) for each in (self.draws.weight, self.draws.weight * self.values[0]))
        return np.asarray(np.divide(total, count, out=np.full(288, np.nan), where=count > 0.0)).reshape(12, 24)

    @property
    def _sampling_notes(self) -> list[str]:
        settings, aim, notes = self.model.settings, self.draws.aim, []
        if aim is not None:
            notes.append(
                f"draws concentrated where glint exceeds the thresholds, with weights; {aim.draws} more draws found these conditions"
            )
        if not self.draws.shares and settings.azimuths != "drawn" and settings.integrates and self.draws.plan.total > INTEGRATED:
            text = (
                f"azimuths drawn: more than {INTEGRATED} draws; likelihood.azimuths = 'integrated' has narrower intervals and takes longer"
            )
            notes.append(text)
        return notes

    @property
    def _looks_per_hour(self) -> float:
        """Independent looks of all pixels in an hour [1]: frames, but no more than one in a correlation time of glint."""
        sensor = self.model.scenario.sensor
        # Frames within a correlation time see the same glint.
        rate = min(sensor.frame_rate_hz, 1.0 / pixel_time(self.model, self.draws))
        return 3600.0 * rate * sensor.pixels[0] * sensor.pixels[1]


def _with_seas(result: ThresholdChance, seas: SeaUnknown, rate: float | None) -> ThresholdChance:
    """Return a chance with its interval over drawn seas."""
    low, high = float(seas.low), float(seas.high)
    alarms = None if rate is None else [low * rate, high * rate]
    return replace(
        result,
        sea_unknown_low=low,
        sea_unknown_high=high,
        sea_unknown_median=float(seas.median),
        sea_draws=seas.draws,
        false_alarms_per_hour_sea_unknown=alarms,
    )


def likelihood(
    scenario: Scenario,
    *,
    weather: WeatherTable | None = None,
    progress: Progress | None = None,
    model: LikelihoodModel | None = None,
    sea_draws: int | None = None,
) -> GlintLikelihood:
    """Return the chances that the mirrored Sun exceeds the scenario's thresholds.

    Parameters
    ----------
    scenario : Scenario
        Scenario with a table ``[likelihood]``.
    weather : WeatherTable, optional
        Weather that replaces the file of the table.
    progress : callable, optional
        Called with (steps done, steps in all).
    model : LikelihoodModel, optional
        Prepared model, for many scenarios of the same air and sea.
    sea_draws : int, optional
        Number of seas between the campaigns over which the interval 'sea unknown' is given. All have the draws of the scenario's sea:
        weather, times, looks and their weights.

    Raises
    ------
    SeaglintError
        Files or settings that models refuse.
    """
    seas = [] if sea_draws is None else drawn_seas(scenario, sea_draws)
    steps, told = 3 + len(seas), progress or (lambda done, total: None)

    def report(done: int, total: int = steps) -> None:
        told(done, total)

    report(0)
    model = model or LikelihoodModel.of(scenario, weather)
    report(1)
    drawn = draw(model, aim=aimed(model))
    report(2)
    thresholds = model.settings.threshold_w_m2_sr
    values = tuple(draw_values(model, drawn, threshold) for threshold in thresholds)
    estimates = tuple(estimate(v, drawn.plan, weight=drawn.weight, heaviest=drawn.heaviest) for v in values)
    classes, of_looks = _classes(model, drawn), _classes_of_looks(drawn)
    # Classes of a single look, such as its azimuth, need values of that look even where azimuths are integrated.
    one_look = values if not drawn.shares else tuple(draw_values(model, replace(drawn, shares={}), t) for t in thresholds)

    def divided(v: FloatArray, quantities: dict[str, tuple[FloatArray, FloatArray]], threshold: float) -> list[StratumChance]:
        return strata(v, drawn.plan, quantities, threshold, weight=drawn.weight, heaviest=drawn.heaviest)

    by_threshold = tuple(
        (*divided(v, classes, t), *divided(one, of_looks, t)) for t, v, one in zip(thresholds, values, one_look, strict=True)
    )
    report(3)
    chances = np.empty((len(seas), len(thresholds)))
    for number, sea in enumerate(seas):
        of_sea = model.of_sea(sea)
        looks_at_sea = draw(of_sea, aim=drawn.aim)
        for k, threshold in enumerate(thresholds):
            chances[number, k] = np.average(draw_values(of_sea, looks_at_sea, threshold), weights=looks_at_sea.weight)
        report(4 + number)
    unknown = tuple(SeaUnknown.of(chances[:, k]) for k in range(len(thresholds))) if seas else ()
    return GlintLikelihood(model, drawn, thresholds, estimates, by_threshold, values, unknown)


def cloud_law(model: LikelihoodModel) -> CloudLaw:
    """Return the law of clouds of the scenario's case."""
    settings = model.settings
    if settings.clouds != "auto":
        return settings.clouds
    return "cover" if settings.case == "single-look" else "overcast"


def draw(
    model: LikelihoodModel,
    *,
    samples: int | None = None,
    seed: int | None = None,
    plain: bool = False,
    azimuth: float | None = None,
    aim: Aim | None = None,
) -> Draws:
    """Draw conditions and evaluate their looks; an ``azimuth`` from the Sun [rad] replaces the scenario's law.

    ``plain`` takes random numbers instead of Sobol points for the same integrand; ``aim`` is the density of the draws, even without it.
    """
    settings = model.settings
    plan = SamplingPlan.of(settings.samples if samples is None else samples)
    u = uniform_numbers(model, plan, model.scenario.seed if seed is None else seed, plain=plain)
    weight = None
    if aim is not None:
        u, weight, _ = aim.warp(u)
    where = model.conditions(u, by_daylight=True)
    drawn = evaluated(model, u, where, plan, azimuth, integrated=azimuth is None and _integrates(model, plan))
    return drawn if weight is None else replace(drawn, weight=drawn.weight * weight, aim=aim)


def _integrates(model: LikelihoodModel, plan: SamplingPlan) -> bool:
    """Return true where azimuths are integrated."""
    settings = model.settings
    whole = settings.azimuths == "integrated" or (settings.azimuths == "auto" and plan.total <= INTEGRATED)
    return whole and settings.integrates and model.scenario.moon is None and "azimuth_from_sun_deg" not in model.looks


@dataclass(frozen=True, eq=False)
class Factor:
    """Density of some uniform numbers, independent of others."""

    names: tuple[str, ...]
    tree: DensityTree


@dataclass(frozen=True, eq=False)
class Aim:
    """Density of uniform numbers that is concentrated where glint exceeds thresholds. Made by ``aimed``."""

    factors: tuple[Factor, ...]  #: Densities of uniform numbers; those without one remain uniform.
    draws: int  #: Number of draws with which it was found.

    @property
    def heaviest(self) -> float:
        """Largest weight of a draw [1]."""
        return math.prod(factor.tree.largest_weight for factor in self.factors)

    def warp(self, u: dict[str, FloatArray]) -> tuple[dict[str, FloatArray], FloatArray, Warped]:
        """Give uniform numbers of draws by name the density; return them, their weights and those of the last factor."""
        weight = np.ones(next(iter(u.values())).size)
        for factor in self.factors:
            warped = factor.tree.warp(np.column_stack([u[name] for name in factor.names]))
            u = u | {name: np.ascontiguousarray(warped.points[:, i]) for i, name in enumerate(factor.names)}
            weight *= warped.weight
        return u, weight, warped


def aimed(model: LikelihoodModel, *, samples: int | None = None, seed: int | None = None) -> Aim | None:
    """Find a density of draws that suits the scenario's thresholds; None where even draws suit them.

    Levels of radiance rise from round to round until they are the thresholds: each is exceeded by some percent of the draws of its round.
    Very rare thresholds are approached at the Sun's azimuth first, so that light winds are found before azimuths matter. Draws are even
    if no threshold is rare, and if none is reached. The rounds have their own random numbers, so that draws with this density have no bias.
    """
    settings = model.settings
    thresholds = [t for t in settings.threshold_w_m2_sr if t > 0.0]
    # the search aims at the Sun: with a Moon draws are even
    if not thresholds or settings.quantity == "detection" or model.scenario.moon is not None:
        return None
    plan = SamplingPlan.of(settings.samples if samples is None else samples)
    whole = _integrates(model, plan)
    pilot = SamplingPlan(1, int(np.clip(2 ** round(math.log2(plan.total / _PILOT)), *_PILOTS)))
    search = _Search(model, thresholds, pilot, model.scenario.seed if seed is None else seed)
    names = _numbers(model)
    turns = "azimuth" in names and "azimuth_from_sun_deg" not in model.looks
    others = tuple(name for name in names if not (turns and name == "azimuth"))
    chance = search.least_chance(whole=whole)
    if chance >= RARE[int(whole)]:
        return None
    approached = turns and (whole or chance < RARE[1])
    aim = search.towards(Aim((Factor(others if approached else names, DensityTree.even()),), pilot.total), at_sun=approached)
    if approached and not whole:
        aim = search.towards(replace(aim, factors=(*aim.factors, Factor(("azimuth",), DensityTree.even()))), approached=True)
    if search.brightest <= min(thresholds):
        return None
    return replace(aim, factors=tuple(replace(factor, tree=factor.tree.mixed(_UNIFORM)) for factor in aim.factors))


@dataclass
class _Search:
    """Rounds of draws that find a density."""

    model: LikelihoodModel
    thresholds: list[float]
    pilot: SamplingPlan  #: Draws of a round.
    seed: int
    turn: int = 0  #: Number of rounds so far.
    brightest: float = 0.0  #: Largest radiance of all rounds [W m-2 sr-1].

    def _numbers(self, pilot: SamplingPlan) -> dict[str, FloatArray]:
        """Return even uniform numbers of the next round."""
        self.turn += 1
        return uniform_numbers(self.model, pilot, self.seed, purpose=f"likelihood pilot {self.turn}")

    def least_chance(self, *, whole: bool) -> float:
        """Return the least chance of all thresholds [1], by even draws."""
        u = self._numbers(self.pilot)
        drawn = evaluated(self.model, u, self.model.conditions(u, by_daylight=True), self.pilot, integrated=whole)
        return min(float(np.mean(drawn.weight * draw_values(self.model, drawn, threshold))) for threshold in self.thresholds)

    def towards(self, aim: Aim, *, at_sun: bool = False, approached: bool = False) -> Aim:
        """Concentrate the last factor of a density towards glint above the thresholds.

        ``at_sun`` is at the azimuth next to the Sun's; ``approached`` counts only draws that exceed the threshold at that azimuth.
        """
        model, stalled, highest = self.model, 0, 0.0
        for _ in range(_ROUNDS):
            pilot = replace(self.pilot, points=_AT_SUN * self.pilot.points) if at_sun else self.pilot
            u, weight, warped = aim.warp(self._numbers(pilot))
            where = model.conditions(u, by_daylight=True)
            near = evaluated(model, u, where, pilot, _nearest_to_sun(model)) if at_sun or approached else None
            drawn = evaluated(model, u, where, pilot) if near is None or approached else near
            bright = np.where(drawn.illuminated > 0.0, _brightness(model, drawn), 0.0)
            peak = _brightness(model, near) if near is not None and approached else np.full(bright.size, np.inf)
            bright = np.sort(np.where(peak > min(self.thresholds), bright, 0.0))[::-1]
            level = max(float(bright[int(_BRIGHT * bright.size)]), 1e-6 * min(self.thresholds))
            levels = [min(threshold, level) for threshold in self.thresholds]
            if at_sun and model.settings.integrates:
                drawn = evaluated(model, u, where, pilot, integrated=True, levels=levels)
            values = np.zeros(pilot.total)
            for threshold, at in zip(self.thresholds, levels, strict=True):
                each = drawn.weight * np.where(peak > threshold, draw_values(model, drawn, at), 0.0)
                # Every threshold counts the same, by its own chance.
                values += each / max(float(np.mean(weight * each)), 1e-300)
            factor = aim.factors[-1]
            factor = replace(factor, tree=factor.tree.refined(warped._replace(weight=weight), values, _BEFORE))
            aim = Aim((*aim.factors[:-1], factor), aim.draws + pilot.total)
            stalled = 0 if bright[0] > 1.001 * highest else stalled + 1
            highest = max(highest, float(bright[0]))
            if levels == self.thresholds or (stalled >= _STALLED and bright[0] < max(self.thresholds)):
                break
        self.brightest = max(self.brightest, highest)
        return aim


def _nearest_to_sun(model: LikelihoodModel) -> float:
    """Return the azimuth of the scenario's range that is the nearest to the Sun's [rad]."""
    first, last = model.settings.azimuth_from_sun_deg
    if first <= 360.0 * math.ceil(first / 360.0) <= last:
        return 0.0
    return math.radians(min(first, last, key=lambda azimuth: abs((azimuth + 180.0) % 360.0 - 180.0)))


def _brightness(model: LikelihoodModel, drawn: Draws) -> FloatArray:
    """Return the radiance that is compared with thresholds [W m-2 sr-1]."""
    if model.settings.quantity == "mean":
        return drawn.radiance
    return drawn.radiance + model.settings.sigmas * pixel_deviation(model, drawn)


def uniform_numbers(
    model: LikelihoodModel, plan: SamplingPlan, seed: int, *, plain: bool = False, purpose: str = "likelihood", more: tuple[str, ...] = ()
) -> dict[str, FloatArray]:
    """Return uniform numbers of draws by name [(total,) each], with ``more`` names; 0 where the scenario does not depend on them."""
    names = (*_numbers(model), *more)
    points = plan.uniform(len(names), seed, plain=plain, purpose=purpose)
    return {name: np.zeros(plan.total) for name in DIMENSIONS} | {name: np.ascontiguousarray(points[:, i]) for i, name in enumerate(names)}


def _numbers(model: LikelihoodModel) -> tuple[str, ...]:
    """Return the names of the uniform numbers on which the draws of a scenario depend, noise of the smooth bootstrap included."""
    return (*_varying(model), *(f"smooth_{name}" for name in model.bandwidth))


def evaluated(
    model: LikelihoodModel,
    u: dict[str, FloatArray],
    where: Conditions,
    plan: SamplingPlan,
    azimuth: FloatArray | float | None = None,
    *,
    integrated: bool = False,
    levels: Sequence[float] | None = None,
    weather: WeatherOfDraws | None = None,
) -> Draws:
    """Evaluate looks in conditions that are drawn already; ``integrated`` evaluates the shares of their azimuths too.

    Shares are those above ``levels`` [W m-2 sr-1], or above the scenario's thresholds without them. ``weather`` replaces the weather of
    the conditions, of which time and place remain.
    """
    settings = model.settings
    wind, cover, wind_from, air = model.weather(where, u) if weather is None else weather
    missing = model.scenario.wind.from_deg if model.gives_wind_direction else 360.0 * u["wind"]
    # Winds are named by where they come from.
    wind_to = np.radians(np.where(np.isnan(wind_from), missing, wind_from) + 180.0)
    sun = model.sun
    if sun is not None:
        zenith, towards, factor = (np.full(wind.size, x) for x in (sun.zenith, sun.azimuth, sun.irradiance_factor))
    else:
        zenith, towards, factor = model.ephemeris.at(where.time, where.latitude, where.longitude)
    depression, relative, height = _geometry(model, u)
    if azimuth is not None:
        relative = np.full(wind.size, azimuth)
    free = illuminated(cloud_law(model), cover, 0.5 * math.pi - zenith, overcast=settings.overcast_cover, aspect=settings.cloud_aspect)
    columns = [air.astype(np.float64), wind, wind_to, height, zenith, towards, factor, towards + relative, depression]
    weight = np.ones(wind.size) if where.weight is None else where.weight
    # Looks under a Sun that is down or hidden for sure are passed over: their radiance is 0.
    at = np.flatnonzero((zenith < _SHINES) & (free > 0.0))
    chosen = np.empty((at.size, len(columns)))
    for i, column in enumerate(columns):
        chosen[:, i] = column[at]
    sight = _everywhere(looks(chosen, model.light, model.seas, model.search), at, wind.size)
    moons = model.moons(where, wind.size)
    if moons is not None:
        sight, free = _with_moon(model, (np.stack(columns, axis=1), moons, cover, weight), sight, free)
    return Draws(
        plan=plan,
        where=where,
        weight=weight,
        sight=sight,
        illuminated=free,
        wind=wind,
        solar_zenith=zenith,
        azimuth_from_sun=relative,
        solar_azimuth=towards,
        height=height,
        shares=_shares(model, chosen, at, wind.size, settings.threshold_w_m2_sr if levels is None else levels) if integrated else {},
        moon_zenith=None if moons is None else moons.zenith,
    )


def _with_moon(
    model: LikelihoodModel, drawn: tuple[FloatArray, Moons, FloatArray, FloatArray], sun: Looks, sun_free: FloatArray
) -> tuple[Looks, FloatArray]:
    """Return looks under Sun and Moon, and the chance that clouds leave the brighter of both free.

    ``drawn``: looks in the columns of ``COLUMNS``, the Moon, cover and weight of each draw.
    """
    rows, moons, cover, weight = drawn
    settings, (band, light) = model.settings, model.moonlight
    height = 0.5 * math.pi - moons.zenith
    free = illuminated(cloud_law(model), cover, height, overcast=settings.overcast_cover, aspect=settings.cloud_aspect)
    at = np.flatnonzero((moons.zenith < _SHINES) & (free > 0.0) & (weight > 0.0))
    moonlit = moonlit_looks(rows[at], Moons(*(values[at] for values in moons)), band, light, model.seas, model.search)
    both, by_moon = brighter(sun, _everywhere(moonlit, at, rows.shape[0]), searched=settings.case != "single-look")
    return both, np.where(by_moon, free, sun_free)


def _shares(
    model: LikelihoodModel, chosen: FloatArray, at: NDArray[np.intp], total: int, levels: Sequence[float]
) -> dict[float, FloatArray]:
    """Return shares of azimuths by threshold above 0; 0 where the Sun is down or behind clouds for sure."""
    thresholds = [t for t in levels if t > 0.0]
    if not thresholds:
        return {}
    first, last = np.radians(model.settings.azimuth_from_sun_deg).tolist()
    shares = azimuth_shares(chosen, model.light, model.seas, (first, last), thresholds)
    out = {t: np.zeros(total) for t in thresholds}
    for i, share in enumerate(out.values()):
        share[at] = shares[:, i]
    return out


def _varying(model: LikelihoodModel) -> list[str]:
    """Return the uniform numbers on which the draws of a scenario depend: points of fewer dimensions are more even."""
    settings, (lowest, highest) = model.settings, model.heights
    alone = settings.case == "single-look"
    if model.climatology is None:
        times, places = isinstance(model.when, Times), isinstance(model.where, GeographicRegion) and model.sun is None
    else:  # the weather depends on time and place even under a given Sun
        times, places = not isinstance(model.when, float), not isinstance(model.where, tuple)
    depends = {
        "azimuth": settings.azimuth_from_sun_deg[0] < settings.azimuth_from_sun_deg[1],
        "hour": times,
        "row": True,
        "cover": model.table is None or len(model.table) > 1,
        "day": times,
        "depression": bool(model.looks) or (alone and settings.depression_deg[0] < settings.depression_deg[1]),
        "across": places,
        "wind": not model.gives_wind_direction,
        "height": lowest < highest or bool(model.looks),
        "along": places,
    }
    return [name for name in DIMENSIONS if depends[name]]


def _everywhere(some: Looks, at: NDArray[np.intp], total: int) -> Looks:
    """Return all looks, with 0 for looks that were passed over."""
    names = [field.name for field in fields(Looks)]
    whole = {name: np.zeros(total) for name in names}
    whole["elevation"] -= 1.0  # an elevation below 0 marks a look that misses the sea
    for name in names:
        whole[name][at] = getattr(some, name)
    return Looks(**whole)


def _geometry(model: LikelihoodModel, u: dict[str, FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return depression and azimuth from the Sun [rad], and height [m]."""
    settings = model.settings
    (low, high), (first, last) = np.radians(settings.depression_deg), np.radians(settings.azimuth_from_sun_deg)
    lowest, highest = model.heights
    depression = low + (high - low) * u["depression"]
    relative = first + (last - first) * u["azimuth"]
    height = lowest + (highest - lowest) * u["height"]
    if model.looks:
        columns = dict(model.looks)
        size = next(iter(columns.values())).size
        cumulative = np.cumsum(columns.pop("weight", np.ones(size)))
        rows = np.minimum(np.searchsorted(cumulative, u["depression"] * cumulative[-1], side="right"), size - 1)
        # One number chooses the row: what the table lacks is drawn by another one.
        depression, relative = (
            columns[name][rows] if name in columns else given
            for name, given in (("depression_deg", low + (high - low) * u["height"]), ("azimuth_from_sun_deg", relative))
        )
        height = columns["height_m"][rows] if "height_m" in columns else height
    return depression, relative, height


def draw_values(model: LikelihoodModel, drawn: Draws, threshold: float) -> FloatArray:
    """Return the quantity of every draw that is averaged [1]: chances between 0 and 1."""
    settings = model.settings
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
    """Return the standard deviation of glint in one of the scenario's pixels [W m-2 sr-1]."""
    scenario, (across, along) = model.scenario, model.scenario.sensor.ifov_deg
    solid_angle = math.radians(across) * math.radians(along)
    if scenario.sea.glint.correlation == "time":
        return deviation(drawn.sight, drawn.height, solid_angle, scenario_physics.glint_length(scenario))

    return wave_deviation(drawn.sight, drawn.height, solid_angle, drawn.wind, partial(_waves_at, model))


def pixel_time(model: LikelihoodModel, drawn: Draws) -> float:
    """Return the correlation time of glint in one of the scenario's pixels [s]: of the middle of the looks with glint, from the waves."""
    scenario = model.scenario
    lit = drawn.radiance > 0.0
    if scenario.sea.glint.correlation == "time" or not lit.any():
        return scenario.sea.glint.correlation_time_s
    glint, law = _waves_at(model, float(np.median(drawn.wind[lit])))
    gamma = np.maximum(drawn.sight.elevation[lit], 0.0)
    slant, sine = float(np.median(slant_range(drawn.height[lit], sea_arc(drawn.height[lit], gamma)))), float(np.median(np.sin(gamma)))
    across, down = (math.radians(angle) * slant for angle in scenario.sensor.ifov_deg)
    return glint.correlation_time(law, SOLAR_ANGULAR_RADIUS, across, down / max(sine, down / slant))


def _waves_at(model: LikelihoodModel, wind: float) -> tuple[WaveGlint, SlopeStatistics]:
    """Return the waves and slopes of a wind [m/s] that blows to the north: azimuths of looks are counted from there."""
    scenario = model.scenario
    # stronger winds of the weather count as the strongest of the law, as in the means
    speed = min(wind, float(model.winds[-1]))
    windy = scenario.model_copy(update={"wind": scenario.wind.model_copy(update={"speed_m_s": speed, "from_deg": 180.0})})
    glint = scenario_physics.glint_correlation(windy)
    assert isinstance(glint, WaveGlint)
    return glint, slopes(windy)


def _solar_hour(where: Conditions) -> FloatArray:
    """Return the hour of the mean Sun's day [h]: 15 deg of longitude are an hour."""
    return np.asarray((where.time / 3600.0 + where.longitude / 15.0) % 24.0)


def _classes(model: LikelihoodModel, drawn: Draws) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return the quantities by which results are classified, with the edges of their classes."""
    classes = {"wind_speed_m_s": (drawn.wind, by.WINDS), "sun_elevation_deg": (90.0 - np.degrees(drawn.solar_zenith), by.SUNS)}
    if model.when is not None:
        classes |= {
            "month": (months_of(drawn.where.time).astype(np.float64), np.arange(1.0, 14.0)),
            "hour_utc": (drawn.where.time % 86_400.0 / 3600.0, np.arange(25.0)),
            "hour_solar": (_solar_hour(drawn.where), np.arange(25.0)),
            "latitude_deg": (drawn.where.latitude, by.LATITUDES),
        }
    return classes


def _classes_of_looks(drawn: Draws) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return the quantities of the single look of each draw, also where azimuths are integrated."""
    return {
        "azimuth_from_sun_deg": (np.degrees(drawn.azimuth_from_sun) % 360.0, by.BEARINGS),
        "bearing_deg": (np.degrees(drawn.azimuth_from_sun + drawn.solar_azimuth) % 360.0, by.BEARINGS),
    }
