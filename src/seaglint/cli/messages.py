"""What commands tell: lines for the user on stderr, results for a program on stdout, refusals with the file's name."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import typer

from seaglint.errors import DomainError, ScenarioError


def log(text: str) -> None:
    """One line for the user, on stderr."""
    print(text, file=sys.stderr, flush=True)


@contextmanager
def naming_file(scenario: Path, height: float) -> Iterator[None]:
    """Give what only physics refuses the file's name, and the key where it is the sensor's height [m]: physics knows neither."""
    try:
        yield
    except ScenarioError as error:
        raise ScenarioError(f"{scenario}: {error}") from error
    except DomainError as error:
        text = str(error)
        if "sensor height" not in text and "under the sensor" not in text:
            raise ScenarioError(f"{scenario}: {text}") from error
        key, spoken = f"sensor.height_m = {height:g}", f"sensor height = {height:g} m "
        what = f" {text.removeprefix(spoken)}" if text.startswith(spoken) else f": {text}"
        raise ScenarioError(f"{scenario}: {key}{what}; sea.resolve_waves = false leaves the waves out") from error


def print_json(value: Any) -> None:
    """A result for a program, on stdout."""
    import json

    typer.echo(json.dumps(value, indent=2, ensure_ascii=False))
