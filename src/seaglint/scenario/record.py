"""What all tables of a scenario file share: the frozen record, the error of a rule, times and paths."""

from __future__ import annotations

from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, ValidationInfo
from pydantic_core import PydanticCustomError

from seaglint.errors import Allowed


class Record(BaseModel):
    """Frozen; unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, validate_default=True)


def rule(key: str, text: str, *, value: Any = None, allowed: Allowed = None) -> PydanticCustomError:
    """Error of a rule that ties several keys together; ``key`` is the full path it is reported under."""
    return PydanticCustomError("rule", "{text}", {"text": text, "key": key, "value": value, "allowed": allowed})


def default_tag(tag: str, value: str) -> BeforeValidator:
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
