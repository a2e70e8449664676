"""Quantities with units, times and paths in scenario files, and the frozen record on which all tables are based.

A number is plain in the unit of its key, or text with a unit ("12 kn", "30 ft", "15 degC"). A validated scenario holds plain numbers in
the unit that each key names; no other module handles texts with units.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, fields
from datetime import UTC, date, datetime
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Final, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationInfo,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from seaglint.base.errors import Allowed

_Built = TypeVar("_Built")

# Units that scenarios are written in, with pint's factors to the last bit (0.3048 is one unit there), because pint takes 0.4 s of
# processor time to start, more than what else there is to read. Any other pair of units is converted by pint.
FACTORS: Final = {
    "m": {"m": 1.0, "km": 1000.0, "cm": 0.01, "mm": 0.001, "ft": 0.30479999999999996, "nmi": 1852.0},
    "deg": {"deg": 1.0, "°": 1.0, "rad": 57.29577951308232, "mrad": 0.057295779513082325},
    "m/s": {"m/s": 1.0, "km/h": 0.2777777777777778, **dict.fromkeys(("kn", "kt", "kts", "knot", "knots"), 0.5144444444444445)},
    "K": {"K": 1.0},
    "um": {"um": 1.0, "nm": 0.001},
    "s": {"s": 1.0, "ms": 0.001, "min": 60.0, "h": 3600.0},
    "Hz": {"Hz": 1.0, "kHz": 1000.0},
    "h": {"h": 1.0, "min": 0.016666666666666666},
    "km": {"km": 1.0, "m": 0.001, "nmi": 1.852},
    "urad": {"urad": 1.0, "mrad": 1000.0},
}
CELSIUS: Final = ("degC", "°C")

YEARS = (1800, 2200)  #: Years for which the Sun's position is computed, within which the Earth's rotation is known well enough.

# A power as the field writes it: "m2" of "W/m2/sr", which pint reads as "m^2" alone.
_POWER = re.compile(r"(?<=[A-Za-z])(-?[1-9])(?![0-9A-Za-z])")

_NUMBER_AND_UNIT = re.compile(r"^\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(.*?)\s*$")

# Spellings of the field that pint reads otherwise ("kn" would be a kilo-something) or not at all.
_SPELLINGS = {
    "kn": "knot",
    "kt": "knot",
    "kts": "knot",
    "knots": "knot",
    "°": "degree",
    "°C": "degC",
    "µ": "um",
    "micron": "um",
    "microns": "um",
}

_EXAMPLES = {"m": "30 ft", "deg": "0.1 rad", "m/s": "12 kn", "K": "15 degC", "um": "4000 nm", "Hz": "25 Hz", "1/km": "0.1 / km"}

# Units in which data sheets and weather reports give what a key wants in another one: of a number outside its range the first that fits is
# meant. The numbers are the limits of keys that a unit suits [unit of the key]: lenses are not in feet, differences not in degrees Celsius.
_ANY: Final = (0.0, math.inf)
#: Units that a number outside its range may be meant in, by the unit of the key.
MISTAKEN: Final[dict[str, tuple[tuple[str, tuple[float, float]], ...]]] = {
    "K": (("mK", (0.0, 100.0)), ("degC", (150.0, math.inf)), ("degF", (150.0, math.inf))),
    "um": (("nm", _ANY), ("mm", _ANY), ("m", _ANY)),
    "m": (("mm", (0.0, 100.0)), ("um", (0.0, 1e-3)), ("ft", (100.0, math.inf)), ("km", _ANY)),
    "km": (("m", _ANY),),
    "deg": (("mrad", _ANY), ("rad", _ANY)),
    "m/s": (("kn", _ANY), ("km/h", _ANY)),
    "s": (("ms", _ANY), ("us", _ANY)),
    "Hz": (("kHz", _ANY),),
    "urad": (("mrad", _ANY), ("rad", _ANY)),
    "h": (("min", _ANY),),
    "hPa": (("Pa", _ANY), ("kPa", _ANY)),
}

#: Endings of keys that name a unit, the longest first, and the unit in SI.
_UNITS: Final = {
    "e_per_count": 1,
    "urad_s": 1e-6,
    "urad": 1e-6,
    "um": 1e-6,
    "e_s": 1,
    "counts": 1,
    "waves": 1,
    "m": 1,
    "s": 1,
    "k": 1,
    "e": 1,
}


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()


def convert(text: str, unit: str) -> float:
    """Convert a text such as ``"12 kn"`` to a number in ``unit``.

    Raises
    ------
    ValueError
        When the text is no number with a unit, or the unit is of another kind.

    Examples
    --------
    >>> round(convert("14 knots", "m/s"), 3)
    7.202
    >>> round(convert("15 degC", "K"), 2)
    288.15
    """
    match = _NUMBER_AND_UNIT.match(text)
    example = _EXAMPLES.get(unit, f"1 {unit}")
    if match is None:
        raise ValueError(f"is not a number with a unit; write a number in {unit} or text such as '{example}'")
    value, written = float(match[1]), match[2]
    if not written:
        raise ValueError(f"has no unit; write {match[1]} without quotes (in {unit}) or text such as '{example}'")
    # Celsius has an offset, which a factor cannot express.
    if unit == "K" and written in CELSIUS:
        return value + 273.15
    factor = FACTORS.get(unit, {}).get(written)
    return by_pint(value, written, unit) if factor is None else value * factor


def by_pint(value: float, written: str, unit: str) -> float:
    """Convert a number in any unit that pint knows."""
    example = _EXAMPLES.get(unit, f"1 {unit}")
    ureg = _registry()
    spelling = "1 " + written if written.startswith("/") else _SPELLINGS.get(written, written)
    spelling, asked = (_POWER.sub(r"^\1", name) for name in (spelling, unit))
    try:
        # pint answers unknown spellings with several exception types (tokenizer, attribute, value); all mean the same here.
        quantity = ureg.Quantity(value, ureg.Unit(spelling))
    except Exception:
        raise ValueError(f"has the unknown unit '{written}'; write a number in {unit} or text such as '{example}'") from None
    # To pint, angles, decibels and shares are all numbers: only what rests on the same units is of one kind.
    if quantity.to_root_units().units != ureg.Quantity(1.0, ureg.Unit(asked)).to_root_units().units:
        raise ValueError(f"has a unit of another kind ('{written}'); allowed is {unit} or what converts to it, such as '{example}'")
    return float(quantity.to(asked).magnitude)


def meant_in(value: float, unit: str, allowed: Callable[[float], bool], limit: float = math.inf) -> str:
    """Return the question whether a number without a unit is in another unit, as a clause; empty where no usual one makes it allowed.

    Parameters
    ----------
    value : float
        Number outside its range.
    unit : str
        Unit of its key.
    allowed : callable
        Whether a number in the key's unit is allowed.
    limit : float
        Largest number allowed.

    Examples
    --------
    >>> meant_in(15.0, "K", lambda kelvin: 260.0 <= kelvin <= 320.0)
    '; did you mean "15 degC"?'
    """
    for other, (least, most) in MISTAKEN.get(unit, ()):
        if least <= limit <= most and allowed(convert(f"{value:g} {other}", unit)):
            return f'; did you mean "{value:g} {other}"?'
    return ""


@dataclass(frozen=True)
class Quantity:
    """Annotation of a scenario number: unit, closed (``ge``, ``le``) or open (``gt``, ``lt``) range, and advice to those outside."""

    unit: str = ""
    gt: float | None = None
    ge: float | None = None
    lt: float | None = None
    le: float | None = None
    integer: bool = False
    advice: str = ""

    @property
    def allowed(self) -> str:
        """Return the range as text, e.g. ``"above 0 to 10000 m"``."""
        low = f"above {self.gt:g}" if self.gt is not None else f"{self.ge:g}" if self.ge is not None else ""
        top = "" if self.le is None else f"{self.le:.0f}" if self.integer else f"{self.le:g}"
        high = f"below {self.lt:g}" if self.lt is not None else top if self.le is not None else ""
        unit = f" {self.unit}" if self.unit else ""
        if low and high:
            return f"{low} to {high}{unit}"
        if low:
            return f"{low}{unit}" if self.gt is not None else f"{low}{unit} or more"
        return f"{high}{unit} or less" if high else f"any finite number{unit}"

    def parse(self, raw: object) -> float | int:
        """Return the number in the key's unit; raise a located pydantic error with the allowed range."""
        kind = "a whole number" if self.integer else f"a number{' in ' + self.unit if self.unit else ''}"
        if isinstance(raw, str) and self.unit:
            try:
                value: float | int = convert(raw, self.unit)
            except ValueError as error:
                raise self._error(f"{error} (allowed: {self.allowed})") from None
        elif isinstance(raw, bool) or not isinstance(raw, int | float):
            raise self._error(f"is not {kind} (allowed: {self.allowed})")
        else:
            value = raw
        if self.integer and not isinstance(value, int):
            raise self._error(f"is not {kind} (allowed: {self.allowed})")
        try:
            finite = math.isfinite(value)
        except OverflowError:  # a whole number beyond any float
            finite = False
        if not finite:
            raise self._error(f"is not finite (allowed: {self.allowed})")
        if not self.holds(value):
            # A number with a unit, or a count, has no other unit that could be meant.
            meant = "" if self.integer or isinstance(raw, str) else self.meant(value)
            raise self._error(f"is outside the allowed range: {self.allowed}{'; ' if self.advice else ''}{self.advice}{meant}")
        return value if self.integer else float(value)

    def holds(self, value: float) -> bool:
        """Return true for a number inside the range."""
        return (
            (self.gt is None or value > self.gt)
            and (self.ge is None or value >= self.ge)
            and (self.lt is None or value < self.lt)
            and (self.le is None or value <= self.le)
        )

    def meant(self, value: float) -> str:
        """Return the question whether a number outside the range is in another unit; see ``meant_in``."""
        limits = [limit for limit in (self.le, self.lt) if limit is not None]
        return meant_in(value, self.unit, self.holds, min(limits, default=math.inf))

    def _error(self, text: str) -> PydanticCustomError:
        # The text goes in as a value: braces in a user's text must not be read as a template.
        return PydanticCustomError("quantity", "{text}", {"text": text, "allowed": self.allowed})

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Parse and check before pydantic sees the number."""
        return core_schema.no_info_before_validator_function(self.parse, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        """Return the JSON Schema: a number with its range, or text with a unit."""
        number: JsonSchemaValue = {"type": "integer" if self.integer else "number"}
        for name, value in (("exclusiveMinimum", self.gt), ("minimum", self.ge), ("exclusiveMaximum", self.lt), ("maximum", self.le)):
            if value is not None:
                number[name] = value
        if not self.unit or self.integer:
            return number
        example = _EXAMPLES.get(self.unit, f"1 {self.unit}")
        return {"anyOf": [number, {"type": "string", "description": f"number with a unit that converts to {self.unit}, e.g. '{example}'"}]}


class Record(BaseModel):
    """Frozen; unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, validate_default=True)

    def in_si(self) -> dict[str, Any]:
        """Return the values in SI units, by their keys without the unit: ``pitch_um = 15`` is ``pitch = 1.5e-5``."""
        out = {}
        for key in type(self).model_fields:
            value = getattr(self, key)
            unit = next((unit for unit in _UNITS if key.endswith(f"_{unit}")), "")
            factor = _UNITS.get(unit, 1)
            out[key.removesuffix(f"_{unit}")] = factor * value if factor != 1 and isinstance(value, int | float) else value
        return out

    def build(self, kind: type[_Built], **derived: Any) -> _Built:
        """Return the data class of the physics that has these values, by name in SI units; ``derived`` are what no key states."""
        # Derived values replace keys of the same name, for example a default that follows from other tables.
        values = self.in_si() | derived
        return kind(**{one.name: values[one.name] for one in fields(kind) if one.name in values})  # type: ignore[arg-type]


def about(text: str, **constraints: Any) -> Any:
    """Return the field of a key with its description; ``constraints`` are further parameters of :func:`pydantic.Field`."""
    return Field(description=text, **constraints)


def rule(key: str, text: str, *, value: Any = None, allowed: Allowed = None) -> PydanticCustomError:
    """Return the error of a rule that ties several keys together; ``key`` is the full path under which it is reported."""
    return PydanticCustomError("rule", "{text}", {"text": text, "key": key, "value": value, "allowed": allowed})


def default_tag(tag: str, value: str) -> BeforeValidator:
    """Let a table of a union omit its tag: ``[atmosphere] model = "..."`` is a table atmosphere."""

    def fill(raw: Any) -> Any:
        return {tag: value, **raw} if isinstance(raw, dict) and tag not in raw else raw

    return BeforeValidator(fill)


def _moment(raw: Any) -> Any:
    """Check that a date and time is a TOML date or text; a number, which would be seconds since 1970, is a mistyped date."""
    if isinstance(raw, str) and raw.strip() and not raw.strip().lstrip("+-").replace(".", "").isdecimal():
        return raw
    if isinstance(raw, date):
        return raw
    raise PydanticCustomError("datetime_type", "is no date and time")


def _as_utc(moment: datetime) -> datetime:
    if not YEARS[0] <= moment.year <= YEARS[1]:
        text = f"is outside the years {YEARS[0]} to {YEARS[1]}; give a date within them"
        raise PydanticCustomError("quantity", "{text}", {"text": text, "allowed": f"{YEARS[0]} to {YEARS[1]}"})
    return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)


def _from_scenario_folder(path: Path, info: ValidationInfo) -> Path:
    """Resolve a relative path against the folder of the scenario file."""
    base = (info.context or {}).get("base")
    return path if base is None or path.is_absolute() else Path(base) / path


def _must_exist(path: Path, info: ValidationInfo) -> Path:
    return _present(path, info, path.is_file, "a file")


def _must_exist_or_store(path: Path, info: ValidationInfo) -> Path:
    return _present(path, info, path.exists, "a file or the folder of a Zarr store")


def _present(path: Path, info: ValidationInfo, exists: Callable[[], bool], what: str) -> Path:
    # A preset is written before its files are there.
    try:
        there = exists()
    except OSError:  # a name that no file system takes
        there = False
    if (info.context or {}).get("files", True) and not there:
        text = f"is not {what} that exists; a relative path counts from the scenario file's folder"
        raise PydanticCustomError("missing_file", "{text}", {"text": text})
    return path


Latitude = Annotated[float, Quantity("deg", ge=-90, le=90)]  #: Latitude, north positive.
Longitude = Annotated[float, Quantity("deg", ge=-180, le=360)]  #: Longitude, east positive.
Azimuth = Annotated[float, Quantity("deg", ge=-360, le=360)]  #: Azimuth, clockwise from north.
Utc = Annotated[datetime, BeforeValidator(_moment), AfterValidator(_as_utc)]
InputPath = Annotated[Path, AfterValidator(_from_scenario_folder)]
InputFile = Annotated[InputPath, AfterValidator(_must_exist)]
InputFileOrStore = Annotated[InputPath, AfterValidator(_must_exist_or_store)]  #: A file, or the folder of a Zarr store.

PACKAGED: Final = ("world", "north-atlantic")  #: Names of the weather in the package, which a key for a weather table may hold.


def _weather_path(path: Path, info: ValidationInfo) -> Path:
    return path if str(path) in PACKAGED else _from_scenario_folder(path, info)


def _weather_exists(path: Path, info: ValidationInfo) -> Path:
    what = f"the name of a weather in the package ({', '.join(PACKAGED)}) or a file"
    return path if str(path) in PACKAGED else _present(path, info, path.is_file, what)


WeatherPath = Annotated[Path, AfterValidator(_weather_path)]
WeatherInput = Annotated[WeatherPath, AfterValidator(_weather_exists)]
