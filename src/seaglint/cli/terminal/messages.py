"""Messages of the commands: lines for the user on stderr, results for a program on stdout, errors with the file's name."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from seaglint.base.errors import DomainError, Mistake, ScenarioError

if TYPE_CHECKING:
    from seaglint.scenario.model import Scenario


def log(text: str) -> None:
    """One line for the user, on stderr."""
    print(text, file=sys.stderr, flush=True)


@contextmanager
def naming_file(path: Path, scenario: Scenario) -> Iterator[None]:
    """Give what only physics refuses the file's name, and the key that sets the number: physics knows neither."""
    try:
        yield
    except ScenarioError as error:
        raise ScenarioError(f"{path}: {error}", mistakes=error.mistakes) from error
    except DomainError as error:
        keys = {"sensor_height": "sensor.height_m" if scenario.platform is None else "platform", "wind_speed": "wind.speed_m_s"}
        key = keys.get(error.name or "")
        if key is None:
            raise ScenarioError(f"{path}: {error}") from error
        mistake = Mistake(key, error.value, error.allowed, f"{key}: {error}")
        raise ScenarioError(f"{path}: {mistake.text}", mistakes=(mistake,)) from error


def files_read(path: Path, scenario: Scenario) -> list[Path]:
    """The scenario file and the files that it names: what no output may replace."""

    def named(value: Any) -> Iterator[Path]:
        if isinstance(value, Path):
            yield value
        elif isinstance(value, Mapping):
            for inner in value.values():
                yield from named(inner)
        elif isinstance(value, tuple):
            for inner in value:
                yield from named(inner)

    return [path, *named(scenario.model_dump())]


def print_json(value: Any) -> None:
    """A result for a program, on stdout."""
    import json

    typer.echo(json.dumps(value, indent=2, ensure_ascii=False))
