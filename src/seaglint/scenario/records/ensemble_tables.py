"""Tables ``[[vary]]`` and ``[dataset]`` of an ensemble's file.

A law of a varied key maps a uniform number to a value by the inverse of its distribution function. The table ``[dataset]`` describes a
labelled data set of the ensemble, and how its scenes are split.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Annotated, Any, Final, Literal, Self

import numpy as np
from pydantic import Field, StrictFloat, StrictInt, StrictStr, model_validator

from seaglint.base.errors import ScenarioError
from seaglint.scenario.records.quantities import Quantity, Record, WeatherPath, about, convert, rule

Number = StrictInt | StrictFloat | StrictStr  #: A number in the unit of its key, or text with another unit.

_INSIDE: Final = 2.0**-53  #: Smallest distance of uniform numbers from 0 and 1 for laws without bounds.

#: Keys of a scenario that columns of a weather table can set.
WEATHER_KEYS: Final = {
    "wind_speed_m_s": "wind.speed_m_s",
    "wind_from_deg": "wind.from_deg",
    "sea_temperature_k": "sea.temperature_k",
    "significant_height_m": "sea.spectrum.significant_height_m",
    "visibility_km": "atmosphere.visibility_km",
    "air_minus_sea_k": "atmosphere.air_minus_sea_k",
    "atmosphere": "atmosphere.model",
    "latitude_deg": "place.latitude_deg",
    "longitude_deg": "place.longitude_deg",
}


class _OfKey(Record):
    """Base of laws that have a key."""

    law: str
    key: Annotated[str | None, about("key of the scenario, e.g. wind.speed_m_s, objects.ferry.heading_deg, sensor.fov_deg.0")] = None


class Uniform(_OfKey):
    """All values between two alike; keys of whole numbers get whole numbers, both ends included."""

    law: Literal["uniform"] = "uniform"
    min: Annotated[Number, about("least value")]
    max: Annotated[Number, about("greatest value")]

    def at(self, uniform: float, quantity: Quantity | None) -> float | int:
        """Return the value at a uniform number."""
        low, high = _ends(self.min, self.max, quantity)
        if quantity is not None and quantity.integer:
            # Whole numbers have equal chances, so the interval is divided into as many parts as there are numbers.
            first, last = math.ceil(low), math.floor(high)
            return min(first + int(uniform * (last - first + 1)), last)
        return low + uniform * (high - low)


class LogUniform(_OfKey):
    """All ratios alike: the logarithm is uniform between two."""

    law: Literal["log_uniform"] = "log_uniform"
    min: Annotated[Number, about("least value, above 0")]
    max: Annotated[Number, about("greatest value")]

    def at(self, uniform: float, quantity: Quantity | None) -> float | int:
        """Return the value at a uniform number."""
        low, high = _ends(self.min, self.max, quantity)
        if low <= 0.0:
            raise ValueError(f"min = {low:g} has no logarithm; give a min above 0, or law = 'uniform'")
        value = min(max(math.exp(math.log(low) + uniform * (math.log(high) - math.log(low))), low), high)
        return round(value) if quantity is not None and quantity.integer else value


class Normal(_OfKey):
    """A normal law, cut off at ``min`` and ``max`` where they are given."""

    law: Literal["normal"] = "normal"
    mean: Annotated[Number, about("mean before it is cut off")]
    standard_deviation: Annotated[Number, about("standard deviation before it is cut off")]
    min: Annotated[Number | None, about("least value")] = None
    max: Annotated[Number | None, about("greatest value")] = None

    def at(self, uniform: float, quantity: Quantity | None) -> float | int:
        """Return the value at a uniform number."""
        from scipy.special import ndtr, ndtri

        mean, width = in_unit(self.mean, quantity), _difference(self.standard_deviation, quantity)
        if not math.isfinite(mean):
            raise ValueError(f"mean = {mean:g} is not finite; give a number")
        if not 0.0 < width < math.inf:
            raise ValueError(f"standard_deviation = {width:g} is not above 0; give one that is, or law = 'choice' with a single value")
        low = -math.inf if self.min is None else in_unit(self.min, quantity)
        high = math.inf if self.max is None else in_unit(self.max, quantity)
        _require_ascending(low, high)
        # The cut normal law is drawn by the inverse of its distribution function between the two ends.
        below, above = float(ndtr((low - mean) / width)), float(ndtr((high - mean) / width))
        if above - below < 1e-12:
            raise ValueError(f"min = {low:g} and max = {high:g} leave nothing of the normal law; widen them")
        share = below + min(max(uniform, _INSIDE), 1.0 - _INSIDE) * (above - below)
        value = min(max(mean + width * float(ndtri(share)), low), high)
        return round(value) if quantity is not None and quantity.integer else value


class Choice(_OfKey):
    """One of some values."""

    law: Literal["choice"] = "choice"
    values: Annotated[tuple[Any, ...], Field(min_length=1, description="what it may be: numbers, text, lists or tables")]
    weights: Annotated[tuple[Annotated[float, Quantity(ge=0)], ...] | None, about("how often each comes; default: all alike")] = None

    @model_validator(mode="after")
    def _as_many(self) -> Self:
        if self.weights is not None and len(self.weights) != len(self.values):
            raise rule("weights", f"has {len(self.weights)} numbers for {len(self.values)} values; give each value one", value=self.weights)
        if self.weights is not None and not sum(self.weights) > 0.0:
            raise rule("weights", "are all 0; give at least one value a weight above 0", value=self.weights)
        return self

    def at(self, uniform: float, quantity: Quantity | None) -> Any:
        """Return the value at a uniform number."""
        value = self.values[chosen(self.weights or (1.0,) * len(self.values), uniform)]
        return in_unit(value, quantity) if isinstance(value, str) and quantity is not None and quantity.unit else value


class Weather(Record):
    """A row of a weather table, drawn whole: its columns set the keys that they mean."""

    law: Literal["weather"] = "weather"
    table: Annotated[
        WeatherPath | None,
        about(
            "weather table, CSV or Parquet ('seaglint weather build' makes one), or one of the package: world (at [place], in the month of "
            "[time]), north-atlantic (the default)"
        ),
    ] = None
    columns: Annotated[
        tuple[
            Literal[
                "wind_speed_m_s",
                "wind_from_deg",
                "sea_temperature_k",
                "significant_height_m",
                "visibility_km",
                "air_minus_sea_k",
                "atmosphere",
                "latitude_deg",
                "longitude_deg",
            ],
            ...,
        ],
        Field(min_length=1, description="columns that are taken; a wind direction that is missing is drawn uniformly"),
    ] = ("wind_speed_m_s", "wind_from_deg")
    max_wind_m_s: Annotated[Annotated[float, Quantity("m/s", gt=0, le=100)] | None, about("rows with stronger winds are left out")] = None

    @property
    def keys(self) -> tuple[str, ...]:
        """Return the keys that the weather sets."""
        return tuple(WEATHER_KEYS[name] for name in self.columns)


Law = Annotated[Uniform | LogUniform | Normal | Choice, Field(discriminator="law")]  #: Laws of a single key.

Vary = Annotated[Uniform | LogUniform | Normal | Choice | Weather, Field(discriminator="law")]  #: Law of one entry of ``[[vary]]``.


def chosen(weights: Sequence[float], uniform: float) -> int:
    """Return the index of a uniform number among weights, by the inverse of their cumulative sum; weights of 0 are never chosen.

    Examples
    --------
    >>> chosen([1.0, 0.0, 3.0], 0.2), chosen([1.0, 0.0, 3.0], 0.25), chosen([1.0, 0.0, 3.0], 0.999)
    (0, 2, 2)
    """
    # The cumulative sum is not normalised, so the uniform number is scaled to it.
    total = np.cumsum(weights)
    return min(int(np.searchsorted(total, uniform * total[-1], side="right")), int(np.flatnonzero(weights)[-1]))


def in_unit(value: Number, quantity: Quantity | None) -> float:
    """Convert a number to the unit of its key.

    Raises
    ------
    ValueError
        Text for a key that has no unit, or with a unit of another kind.
    """
    if not isinstance(value, str):
        return float(value)
    if quantity is None or not quantity.unit:
        raise ValueError(f"'{value}' is text, and the key has no unit; give a number")
    try:
        return convert(value, quantity.unit)
    except ValueError as error:
        raise ValueError(f"'{value}' {error}") from None


def _difference(value: Number, quantity: Quantity | None) -> float:
    """Convert a difference to the unit of its key: a difference of 2 degC is 2 K."""
    if not isinstance(value, str):
        return float(value)
    # The unit's zero is subtracted, which removes the offset of degrees Celsius.
    zero = re.sub(r"[0-9.]+(?:[eE][+-]?[0-9]+)?", "0", value, count=1)
    return in_unit(value, quantity) - in_unit(zero, quantity)


def _ends(low: Number, high: Number, quantity: Quantity | None) -> tuple[float, float]:
    ends = in_unit(low, quantity), in_unit(high, quantity)
    for name, end in zip(("min", "max"), ends, strict=True):
        if math.isinf(end):
            raise ValueError(f"{name} = {end:g} is not finite; give a number")
    _require_ascending(*ends)
    return ends


def _require_ascending(low: float, high: float) -> None:
    for name, end in (("min", low), ("max", high)):
        if math.isnan(end):
            raise ValueError(f"{name} = nan is no number; give one")
    if not low <= high:
        raise ValueError(f"min = {low:g} is above max = {high:g}; give the lower number as min")


def value_of(law: Uniform | LogUniform | Normal | Choice, uniform: float, quantity: Quantity | None, name: str) -> Any:
    """Return the value of a law at a uniform number, as a scenario file has it.

    Raises
    ------
    ScenarioError
        A law with numbers that contradict each other; ``name`` is the key of the law in the message.
    """
    try:
        return law.at(uniform, quantity)
    except ValueError as error:
        raise ScenarioError(f"{name}: {error}") from None


_Fraction = Annotated[float, Quantity(ge=0, le=1)]
_Name = Annotated[str, Field(min_length=1, max_length=100)]


class Dataset(Record):
    """Description of a labelled data set of the ensemble."""

    title: Annotated[str | None, about("title of the data card; default: the file's name")] = None
    description: Annotated[str, about("what the data set is for, in the data card")] = ""
    licence: Annotated[str | None, about("licence of the pictures and labels; default: CC-BY-4.0")] = None
    split: Annotated[tuple[_Fraction, _Fraction, _Fraction], about("shares of the scenes that train, validate and test; 1 in all")] = (
        0.7,
        0.15,
        0.15,
    )
    min_snr: Annotated[
        Annotated[float, Quantity(ge=0)] | None,
        about("signal-to-noise ratio below which objects are marked ignore, as --min-snr; default: 1"),
    ] = None
    classes: Annotated[
        dict[_Name, _Name],
        about("category of objects by their name, or by that of the template that drew them; else their preset or kind of shape"),
    ] = {}  # noqa: RUF012 (pydantic copies it)

    @model_validator(mode="after")
    def _is_a_whole(self) -> Self:
        total = math.fsum(self.split)
        if abs(total - 1.0) > 1e-6:
            given = ", ".join(f"{fraction:g}" for fraction in self.split)
            text = f"= [{given}] adds up to {total:g}; give shares of training, validation and test that add up to 1"
            raise rule("split", text, value=self.split)
        return self
