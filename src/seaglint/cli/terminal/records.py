"""Options of a command from the records that it takes: requests of the studies, and what commands share."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, Field, fields, is_dataclass
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, Final, NamedTuple, get_args, get_origin, get_type_hints

import typer
from typer.core import TyperCommand

from seaglint.base.parameters import GROUPS, Parameter
from seaglint.cli.terminal.numbers import contrasts_of


class Without(NamedTuple):
    """Fields of a record that a command has no options for; they keep their defaults."""

    names: tuple[str, ...]


class RecordCommand(TyperCommand):
    """Command whose help page has its options in groups."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write the arguments, then the options under their headings."""
        sections: dict[str, list[tuple[str, str]]] = {"Arguments": [], **{group: [] for group in GROUPS}, "Other": []}
        for parameter in self.get_params(ctx):
            line = parameter.get_help_record(ctx)
            if line is not None:
                argument = parameter.param_type_name == "argument"
                sections["Arguments" if argument else getattr(parameter, "rich_help_panel", None) or "Other"].append(line)
        for heading, lines in sections.items():
            if lines:
                with formatter.section(heading):
                    formatter.write_dl(lines)


def option_of(name: str) -> str:
    """Return the option that sets a parameter."""
    return f"--{name.replace('_', '-')}"


def takes_records(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command with an option for each field of the records among its parameters.

    Fields of one name in several records are one option, with the help of the first record, and its value goes to all of them.
    """
    hints = get_type_hints(command, include_extras=True)
    hints.pop("return", None)
    records: dict[str, type] = {}
    parameters: dict[str, inspect.Parameter] = {}
    readers: dict[str, Callable[[Any], Any]] = {}
    for name, hint in hints.items():
        record = get_args(hint)[0] if get_origin(hint) is Annotated else hint
        if not is_dataclass(record):
            default = inspect.signature(command).parameters[name].default
            parameters.setdefault(name, inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hint))
            continue
        records[name] = record  # type: ignore[assignment]
        left_out = next((extra.names for extra in get_args(hint)[1:] if isinstance(extra, Without)), ())
        types = get_type_hints(record, include_extras=True)
        for field in fields(record):
            if field.name not in left_out and field.name not in parameters:
                parameters[field.name], readers[field.name] = _option(field, types[field.name])

    @wraps(command)
    def called(**given: Any) -> None:
        read = {name: readers[name](value) if name in readers else value for name, value in given.items()}
        built = {
            name: record(**{field.name: read[field.name] for field in fields(record) if field.name in read})
            for name, record in records.items()
        }
        command(**built, **{name: read[name] for name in hints if name not in records})

    called.__annotations__ = {name: parameter.annotation for name, parameter in parameters.items()} | {"return": None}
    ordered = sorted(parameters.values(), key=lambda parameter: parameter.default is not inspect.Parameter.empty)
    called.__signature__ = inspect.Signature(ordered, return_annotation=None)  # type: ignore[attr-defined]
    return called


def _option(field: Field[Any], hint: Any) -> tuple[inspect.Parameter, Callable[[Any], Any]]:
    """Return the parameter of a command for a field of a record, and what reads its text."""
    kind, *extras = get_args(hint) if get_origin(hint) is Annotated else (hint,)
    default: Any = inspect.Parameter.empty if field.default is MISSING else field.default
    described = next((extra for extra in extras if isinstance(extra, Parameter)), None)
    if described is None:  # an option as Typer has it
        return inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hint), lambda value: value
    option, help_text = option_of(field.name), re.sub(r"`(\w+)`", lambda match: option_of(match[1]), described.help)
    more: dict[str, Any] = {"metavar": described.metavar} if described.metavar else {}
    if field.default is MISSING:
        info: Any = typer.Argument(help=help_text, **more)
    else:
        limit: dict[str, Any] = {} if described.least is None else {"min": described.least}
        info = typer.Option(option, help=help_text, rich_help_panel=described.group, **limit, **more)
    if described.form:
        kind = Path | None if described.form == "weights" else str | None
        default = None if default is None else ",".join(f"{value:g}" for value in default)
    reader: Callable[[Any, str], Any] = READERS.get(described.form, lambda value, _: value)
    parameter = inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, info])
    return parameter, lambda value: None if value is None else reader(value, option)


def _weights(path: Path, option: str) -> Any:
    """Return the numbers of a small CSV or NumPy file, with its place."""
    from seaglint.cli.analyze import weights
    from seaglint.studies.detect.requests import WeightsFile

    return WeightsFile(path, weights(path))


def _raw(text: str, option: str) -> Any:
    from seaglint.cli.analyze import raw_layout

    return raw_layout(text)


def _pair(text: str, option: str) -> tuple[float, float]:
    """Return rows and columns a frame, of X,Y."""
    from seaglint.base.errors import DataError

    try:
        right, down = (float(part) for part in text.split(","))
    except ValueError:
        raise DataError(f"{option} {text}: give X,Y in pixels a frame, to the right and down, e.g. 0.5,0") from None
    return down, right


def _limits(text: str, option: str) -> tuple[float, float]:
    from seaglint.base.errors import DataError

    try:
        near, far = (float(part) for part in text.split(":"))
    except ValueError:
        raise DataError(f"{option} {text}: give NEAR:FAR in metres, e.g. 500:40000") from None
    return near, far


READERS: Final[Mapping[str, Callable[[Any, str], Any]]] = {
    "numbers": contrasts_of,
    "pair": _pair,
    "limits": _limits,
    "weights": _weights,
    "raw": _raw,
}
"""Readers of texts by the form of a parameter; each takes text and option."""
