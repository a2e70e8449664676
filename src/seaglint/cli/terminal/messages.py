"""Lines that the commands print: messages and errors on stderr, results on stdout.

Errors are written in the words of the command line (options instead of parameters), log records of the package as plain lines. Below them
are the tables of results in plain text, and the numbers that ``seaglint detect`` reads and prints.
"""

from __future__ import annotations

import logging
import re
import sys
import unicodedata
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import typer

from seaglint.base.errors import DataError, DomainError, Mistake, ScenarioError

if TYPE_CHECKING:
    from seaglint.analysis.recording import Recording
    from seaglint.scenario.model import Scenario
    from seaglint.studies.article.headline import ArticleRow


LONGEST_WORD: Final = 500  #: Number of characters from which a word is cut: longer than the path of any file that a user names.

KEPT_OF_WORD: Final = 80  #: Number of characters at the beginning of such a word that are printed.

LONGEST_LINE: Final = 4000  #: Number of characters after which a line is cut.

#: Unicode categories of characters that steer a terminal instead of being shown, and of codes without a character.
_STEERING: Final = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"})


def option_names(group: Any, words: Sequence[str]) -> dict[str, str]:
    """Return the options of a command by the parameter that each sets: ``{"frame_rate": "--frame-rate"}``.

    Parameters
    ----------
    group : click group
        Program, with groups of commands in it.
    words : sequence of str
        Words behind the program's name, as typed.
    """
    command, rest = group, list(words)
    while command is not None and hasattr(command, "commands") and rest:
        name, *rest = rest
        command = command.commands.get(name) or getattr(command, "bare", None)
    options = [max(parameter.opts, key=len) for parameter in getattr(command, "params", ())]
    spelled = {option[2:].replace("-", "_"): option for option in options if option.startswith("--")}
    return {**spelled, **getattr(getattr(command, "callback", None), "renamed", {})}


def spelled_as_options(text: str, options: Mapping[str, str], *, of_file: bool = False) -> str:
    """Return an error's text with parameters spelled as the options that set them.

    Errors name parameters, which a user of the command line never sees. Replaced are ``name = value`` and ``name=True`` anywhere, names in
    backticks, and names with an underscore, which no English word has. Keys of a scenario file, which follow a dot, stay. A scenario file
    also has keys without a dot: in its errors (``of_file``) ``name=value`` without spaces is a parameter, and ``name = value`` is a key.

    Examples
    --------
    >>> names = {"frame_rate": "--frame-rate", "overwrite": "--overwrite", "format": "--format"}
    >>> spelled_as_options("format = 'voc' is unknown; see sensor.format = 'raw'", names)
    "--format 'voc' is unknown; see sensor.format = 'raw'"
    >>> spelled_as_options("out.json exists already; give overwrite=True, or another frame_rate", names)
    'out.json exists already; give --overwrite, or another --frame-rate'
    """
    if not options or text.startswith("--"):  # an error about the text of an option
        return text
    # Not within a word, a path, a key or quoted text.
    alone = r"(?<![\w.\-/\[\"'`])"
    # Longest first: an alternative that is the beginning of another would hide it.
    names = "|".join(sorted(map(re.escape, options), key=len, reverse=True))
    text = re.sub(r"`(\w+)`", lambda match: options.get(match[1], match[0]), text)
    equals = "=" if of_file else "(?: = |=)"
    text = re.sub(rf"{alone}({names}){equals}True\b", lambda match: options[match[1]], text)
    text = re.sub(rf"{alone}({names}){equals}(?![= ])", lambda match: f"{options[match[1]]} ", text)
    if of_file:
        return text
    long = "|".join(sorted((re.escape(name) for name in options if "_" in name), key=len, reverse=True))
    return re.sub(rf"{alone}({long})(?![\w\-/(=]|\.\w)", lambda match: options[match[1]], text) if long else text


def printable(text: str) -> str:
    r"""Return a text without characters that steer a terminal: they become escapes, and very long words and lines are cut.

    Values and names of files may contain anything. Control characters, characters that reverse the direction of writing, and separators of
    lines are written as Python escapes; words of more than ``LONGEST_WORD`` characters keep their beginning.

    Examples
    --------
    >>> print(printable("name = 'a\x1b[31mb'"))
    name = 'a\x1b[31mb'
    >>> printable("x" * 1000).endswith("x... (1000 characters)")
    True
    """
    shown = "".join(one if one in "\n\t" or unicodedata.category(one) not in _STEERING else ascii(one)[1:-1] for one in text)
    shown = re.sub(rf"\S{{{LONGEST_WORD},}}", lambda word: f"{word[0][:KEPT_OF_WORD]}... ({len(word[0])} characters)", shown)
    return "\n".join(
        line if len(line) <= LONGEST_LINE else f"{line[:LONGEST_LINE]}... ({len(line)} characters)" for line in shown.split("\n")
    )


def log(text: str) -> None:
    """Print one line for the user, on stderr."""
    print(printable(text), file=sys.stderr, flush=True)


def log_notes(path: object, recording: Recording) -> None:
    """Print the notes of a recording, one per line: masked, scaled, rotated or omitted data when it was opened."""
    for note in recording.notes:
        log(f"{path}: {note}")


def print_air(scenarios: Scenario | Sequence[Scenario], ranges: Sequence[float] | None = None) -> None:
    """Print the temperature of the air over the water and its effect on contrasts, where a scenario does not state both temperatures.

    For several scenarios each different line is printed once.
    """
    from seaglint.studies.mean.air_contrast import air_line

    several = scenarios if isinstance(scenarios, Sequence) else [scenarios]
    # A dictionary removes repetitions and keeps the order.
    for line in dict.fromkeys(air_line(one, ranges) for one in several):
        if line is not None:
            log(line)


def print_lines(lines: Iterable[str]) -> None:
    """Print the lines of a result on stdout, for people."""
    typer.echo(printable("\n".join(lines)))


@contextmanager
def naming_file(path: Path, scenario: Scenario) -> Iterator[None]:
    """Add the file's name, and the key that sets the number, to errors of the physics, which knows neither."""
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
    """Return the scenario file and the files that it names, none of which an output may replace."""

    def named(value: Any) -> Iterator[Path]:
        if isinstance(value, Path):
            yield value
        elif isinstance(value, Mapping | tuple):
            for inner in value.values() if isinstance(value, Mapping) else value:
                yield from named(inner)

    return [path, *named(scenario.model_dump())]


def print_json(value: Any) -> None:
    """Print a result as JSON on stdout, for programs."""
    import json

    typer.echo(json.dumps(value, indent=2, ensure_ascii=False))


class _Stderr(logging.Handler):
    """Handler that writes to the present standard error, which tests and notebooks replace. Each warning is printed once per command."""

    def __init__(self) -> None:
        super().__init__()
        self.warned: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record as one line."""
        text = record.getMessage()
        if record.levelno >= logging.WARNING:
            fact = str(getattr(record, "fact", text))  # the part of a warning that is equal for all scenes
            if fact in self.warned:
                return  # a study prepares the same air for each height, hour and scene
            self.warned.add(fact)
        log(text)


def begin_logs() -> None:
    """Begin a new command: print warnings only, and each of them once more."""
    show_logs(quiet=True)
    for handler in logging.getLogger("seaglint").handlers:
        if isinstance(handler, _Stderr):
            handler.warned.clear()


def show_logs(*, quiet: bool = False) -> None:
    """Print progress and warnings of the package's loggers; with ``quiet`` only warnings."""
    logger = logging.getLogger("seaglint")
    if not any(isinstance(handler, _Stderr) for handler in logger.handlers):
        logger.addHandler(_Stderr())
        logger.propagate = False
    logger.setLevel(logging.WARNING if quiet else logging.INFO)
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)  # fonts that are missing change no number


MOST_CONTRASTS = 200  #: Largest number of numbers in one option.


def contrasts_of(text: str, option: str = "--contrast") -> tuple[float, ...]:
    """Return the numbers of an option: one, several with commas, or a range FIRST:LAST:STEP.

    Raises
    ------
    DataError
        The text has another form, or gives too many numbers.
    """
    import numpy as np

    wrong = DataError(f"{option} {text}: give a number, several as 1,2,4, or FIRST:LAST:STEP as 1:8:0.5, at most {MOST_CONTRASTS}")
    try:
        if ":" not in text:
            contrasts = tuple(float(part) for part in text.split(","))
        else:
            first, last, step = (float(part) for part in text.split(":"))
            # 1e-9 includes the last number in spite of rounding. The number of steps is tested first: a tiny step would fill the memory.
            count = int((last - first) / step + 1.0 + 1e-9) if step and (last - first) / step < MOST_CONTRASTS else 0
            # 12 decimals remove the rounding of repeated steps: 0.3, not 0.30000000000000004.
            contrasts = tuple(float(v) for v in np.round(first + step * np.arange(max(count, 0)), 12))
    except ValueError:
        raise wrong from None
    if not 0 < len(contrasts) <= MOST_CONTRASTS:
        raise wrong
    return contrasts


def between(ends: list[float] | None) -> str:
    """Return an interval as text in brackets."""
    return " (no interval)" if ends is None else f" ({ends[0]:.3g} to {ends[1]:.3g})"


def _number(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, list | tuple):
        return " to ".join(_number(item) for item in value)
    return f"{value:.4g}" if isinstance(value, int | float) else str(value)


def table(rows: Mapping[str, ArticleRow]) -> list[str]:
    """Return the lines of a table: name, the numbers that all rows have, unit; below each row its settings."""
    width = max((len(key) for key in rows), default=4)
    heads = next((list(row.numbers) for row in rows.values()), ["article", "ours"])
    out = ["  ".join([f"{'what':{width}}", *(f"{head:>12}" for head in heads), "unit"])]
    for key, row in rows.items():
        cells = (f"{_number(value):>12}" for value in row.numbers.values())
        out.append("  ".join([f"{key:{width}}", *cells, row.unit]).rstrip())
        if row.settings:
            out.append(f"{'':{width}}  {'; '.join(f'{name} = {_number(value)}' for name, value in row.settings.items())}")
    return out
