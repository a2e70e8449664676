"""Base of all tables of a scenario file: the frozen record, the error of a rule, times and paths."""

from __future__ import annotations

from dataclasses import fields
from datetime import UTC, date, datetime
from pathlib import Path
from typing import Annotated, Any, Final, TypeVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, ValidationInfo
from pydantic_core import PydanticCustomError

from seaglint.base.errors import Allowed

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

_Built = TypeVar("_Built")


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
        values = self.in_si() | derived
        return kind(**{one.name: values[one.name] for one in fields(kind) if one.name in values})  # type: ignore[arg-type]


def rule(key: str, text: str, *, value: Any = None, allowed: Allowed = None) -> PydanticCustomError:
    """Return the error of a rule that ties several keys together; ``key`` is the full path under which it is reported."""
    return PydanticCustomError("rule", "{text}", {"text": text, "key": key, "value": value, "allowed": allowed})


def default_tag(tag: str, value: str) -> BeforeValidator:
    """Let a table of a union omit its tag: ``[atmosphere] model = "..."`` is a table atmosphere."""

    def fill(raw: Any) -> Any:
        return {tag: value, **raw} if isinstance(raw, dict) and tag not in raw else raw

    return BeforeValidator(fill)


YEARS = (1800, 2200)  #: Years for which the Sun's position is computed, within which the Earth's rotation is known well enough.


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
    # A preset is written before its files are there.
    try:
        there = path.is_file()
    except OSError:  # a name that no file system takes
        there = False
    if (info.context or {}).get("files", True) and not there:
        raise PydanticCustomError(
            "missing_file", "{text}", {"text": "is not a file that exists; a relative path counts from the scenario file's folder"}
        )
    return path


Utc = Annotated[datetime, BeforeValidator(_moment), AfterValidator(_as_utc)]
InputPath = Annotated[Path, AfterValidator(_from_scenario_folder)]
InputFile = Annotated[InputPath, AfterValidator(_must_exist)]
