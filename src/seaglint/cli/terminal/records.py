"""Options of a command from the records that it takes: requests of the studies, and what commands share."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, Field, fields, is_dataclass
from functools import partial, wraps
from pathlib import Path
from typing import Annotated, Any, Final, Literal, NamedTuple, get_args, get_origin, get_type_hints

import typer
from typer.core import TyperCommand

from seaglint.base.parameters import GROUPS, Parameter, described
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


def takes_records(*, order: str = "") -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Return a decorator that gives a command an option for each field of the records among its parameters.

    Fields of one name in several records are one option, with the help of the first record, and its value goes to all of them. A help page
    lists the names in ``order`` first.
    """

    def decorate(command: Callable[..., None]) -> Callable[..., None]:
        return _with_options(command, order.split())

    return decorate


def _with_options(command: Callable[..., None], first: Sequence[str]) -> Callable[..., None]:
    """Return a command with an option for each field of its records."""
    hints = get_type_hints(command, include_extras=True)
    hints.pop("return", None)
    records: dict[str, type] = {}
    parameters: dict[str, inspect.Parameter] = {}
    readers: dict[str, Callable[[Any], Any]] = {}
    renamed: dict[str, str] = {}
    for name, hint in hints.items():
        record = get_args(hint)[0] if get_origin(hint) is Annotated else hint
        if not is_dataclass(record):
            default = inspect.signature(command).parameters[name].default
            parameters.setdefault(name, inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hint))
            continue
        records[name] = record  # type: ignore[assignment]
        left_out = next((extra.names for extra in get_args(hint)[1:] if isinstance(extra, Without)), ())
        types, texts = get_type_hints(record, include_extras=True), described(record)  # type: ignore[arg-type]
        for field in fields(record):
            if field.name not in left_out and field.name not in parameters:
                text = texts.get(field.name)
                parameters[field.name], readers[field.name] = _option(field, types[field.name], text)
                if text is not None and text.option:
                    renamed[field.name] = text.option

    @wraps(command)
    def called(**given: Any) -> None:
        read = {name: readers[name](value) if name in readers else value for name, value in given.items()}
        built = {
            name: record(**{field.name: read[field.name] for field in fields(record) if field.name in read})
            for name, record in records.items()
        }
        command(**built, **{name: read[name] for name in hints if name not in records})

    listed = {name: parameters[name] for name in first} | parameters
    called.__annotations__ = {name: parameter.annotation for name, parameter in listed.items()} | {"return": None}
    ordered = sorted(listed.values(), key=lambda parameter: parameter.default is not inspect.Parameter.empty)
    called.__signature__ = inspect.Signature(ordered, return_annotation=None)  # type: ignore[attr-defined]
    called.renamed = renamed  # type: ignore[attr-defined]
    return called


def _option(field: Field[Any], hint: Any, text: Parameter | None) -> tuple[inspect.Parameter, Callable[[Any], Any]]:
    """Return the parameter of a command for a field of a record, and what reads its text."""
    default: Any = inspect.Parameter.empty if field.default is MISSING else field.default
    if text is None:  # an option as Typer has it
        return inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=hint), lambda value: value
    kind = get_args(hint)[0]
    option = text.option or option_of(field.name)
    help_text = re.sub(r"`(\w+)`", lambda match: option_of(match[1]), text.help) + SPELLED.get(text.form, "")
    more: dict[str, Any] = {"metavar": text.metavar} if text.metavar else {}
    if field.default is MISSING:
        info: Any = typer.Argument(help=help_text, **more)
    else:
        limit: dict[str, Any] = {} if text.least is None else {"min": text.least}
        info = typer.Option(option, help=help_text, rich_help_panel=text.group or None, **limit, **more)
    reader: Callable[[Any, str], Any] = READERS.get(text.form, lambda value, _: value)
    if text.form == "switch":
        kind, default = Literal["auto", "always", "never"], next(word for word, value in SWITCH.items() if value is default)
    elif text.form == "name":
        kind = str
    elif get_origin(kind) is tuple and get_args(kind)[1:] == (...,) and text.form in ("", "names"):
        item: Any = str if text.form else get_args(kind)[0]
        several: Any = list[item] | None
        parameter = inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[several, info])
        return parameter, lambda value: tuple(value or ())
    elif text.form:
        kind = Path | None if text.form in ("weights", "mask") else str | None
        default = None if default is None else WRITTEN.get(text.form, _commas)(default)
    parameter = inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=Annotated[kind, info])
    return parameter, lambda value: None if value is None else reader(value, option)


def _commas(values: Sequence[float]) -> str:
    return ",".join(f"{value:g}" for value in values)


def _weights(path: Path, option: str) -> Any:
    """Return the numbers of a small CSV or NumPy file, with its place."""
    from seaglint.cli.terminal.small_files import weights
    from seaglint.studies.reading_requests import WeightsFile

    return WeightsFile(path, weights(path))


def _mask(path: Path, option: str) -> Any:
    """Return the mask of an image or a NumPy file, with its place."""
    from seaglint.cli.terminal.small_files import read_mask
    from seaglint.studies.reading_requests import WeightsFile

    return WeightsFile(path, partial(read_mask, path))


def _shares(text: str, option: str) -> tuple[float, float]:
    """Return the ends of a part of the height, of FIRST:LAST."""
    from seaglint.base.errors import DataError

    first, colon, last = text.partition(":")
    try:
        if not colon:
            raise ValueError
        return float(first or 0.0), float(last or 1.0)
    except ValueError:
        raise DataError(f"{option} {text}: give FIRST:LAST as shares of the height from the top, e.g. 0.45: or 0.2:0.8") from None


def _raw(text: str, option: str) -> Any:
    from seaglint.cli.terminal.small_files import raw_layout

    return raw_layout(text)


def _pair(text: str, option: str) -> tuple[float, float]:
    """Return pixels to the right and down, of X,Y."""
    from seaglint.base.errors import DataError

    try:
        right, down = (float(part) for part in text.split(","))
    except ValueError:
        raise DataError(f"{option} {text}: give X,Y in pixels a frame, to the right and down, e.g. 0.5,0") from None
    return right, down


def _size(text: str, option: str) -> tuple[int, int]:
    """Return columns and rows of COLUMNSxROWS."""
    from seaglint.base.errors import DataError

    parts = text.lower().split("x")
    if len(parts) != 2 or not all(part.strip().isdecimal() and int(part) > 0 for part in parts):
        raise DataError(f"{option} {text}: give columns and rows above 0 as COLUMNSxROWS, e.g. 512x512")
    return int(parts[0]), int(parts[1])


def _limits(text: str, option: str) -> tuple[float, float]:
    from seaglint.base.errors import DataError

    try:
        near, far = (float(part) for part in text.split(":"))
    except ValueError:
        raise DataError(f"{option} {text}: give NEAR:FAR in metres, e.g. 500:40000") from None
    return near, far


SWITCH: Final[Mapping[str, bool | None]] = {"auto": None, "always": True, "never": False}  #: Values of the words of a switch.

#: Readers of texts by the form of a parameter; each takes text and option. Frames are read where it is known how many there are.
READERS: Final[Mapping[str, Callable[[Any, str], Any]]] = {
    "numbers": contrasts_of,
    "pair": _pair,
    "size": _size,
    "limits": _limits,
    "shares": _shares,
    "weights": _weights,
    "mask": _mask,
    "raw": _raw,
    "switch": lambda text, _: SWITCH[text],
}

#: Ends of help texts by the form of a parameter: how a value is written on the command line.
SPELLED: Final[Mapping[str, str]] = {
    "frames": ": 37, 37:38 (end not included), 10:",
    "every": ", by number: 37, 37:38 (end not included), 0:100:2",
    "shares": ", as shares from the top: 0.45: or 0.2:0.8",
}

#: Texts of defaults by the form of a parameter; numbers with commas between them for other forms.
WRITTEN: Final[Mapping[str, Callable[[Any], str]]] = {
    "shares": lambda ends: ":" if ends == (0.0, 1.0) else f"{ends[0]:g}:{ends[1]:g}",
    "size": lambda sides: f"{sides[0]}x{sides[1]}",
}
