"""Errors that a user can cause. Each message has the given value, the allowed ones and the remedy.

The command line prints them in one line and exits with ``SeaglintError.exit_code``; any other exception is a defect of
seaglint and is printed with its traceback. Texts are for people: programs read the fields of an error.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Allowed = tuple[float, float] | str | None  #: Allowed values: a closed range, a list of words, or None where neither applies.


class SeaglintError(Exception):
    """Base class of all errors that the caller can correct."""

    exit_code = 2


@dataclass(frozen=True)
class Mistake:
    """Single mistake in a scenario."""

    key: str  #: Key of the mistake: ``"sensor.height_m"``, ``"render.layers[0]"``.
    value: Any  #: Given value; None where a key is missing.
    allowed: Allowed  #: Closed range, or words; None where only the text has it.
    text: str  #: The whole sentence.


class ScenarioError(SeaglintError):
    """Error in a scenario file or key; the message names file, key path, value and allowed values."""

    def __init__(self, text: str, *, mistakes: tuple[Mistake, ...] = ()) -> None:
        super().__init__(text)
        self._mistakes = mistakes

    @property
    def mistakes(self) -> tuple[Mistake, ...]:
        """Mistakes of the scenario, one for each key; empty where no single key is wrong."""
        return self._mistakes


class DomainError(SeaglintError, ValueError):
    """Error of a number outside the range in which a physical model is valid.

    Parameters
    ----------
    text : str
        Message: the given value, the allowed ones, and the remedy.
    name : str, optional
        Name of the quantity in functions: ``"wind_speed"``.
    value : object, optional
        Refused number, in the unit of ``allowed``; the first of many.
    allowed : (float, float) or str, optional
        Closed range, or words for other conditions.

    Examples
    --------
    >>> error = DomainError("height = 3 m", name="height", value=3.0, allowed=(5.0, 9.0))
    >>> error.allowed
    (5.0, 9.0)
    """

    def __init__(self, text: str, *, name: str | None = None, value: Any = None, allowed: Allowed = None) -> None:
        super().__init__(text)
        self._name, self._value, self._allowed = name, value, allowed

    @property
    def name(self) -> str | None:
        """Name of the refused quantity; None if several quantities are involved."""
        return self._name

    @property
    def value(self) -> Any:
        """Refused value."""
        return self._value

    @property
    def allowed(self) -> Allowed:
        """Allowed values: a closed range or a list of words."""
        return self._allowed


class DataError(SeaglintError):
    """Error of an input or output file that is missing, truncated, of the wrong kind or already there."""


class BackendError(SeaglintError):
    """Error of an optional part (codec, reader, compiler, device) that is needed and not installed."""


class StorageError(SeaglintError):
    """Error of writing for lack of space or permission; data written before remain and can be resumed."""

    exit_code = 3


def one_line(error: BaseException) -> str:
    r"""Return an error as one line: its kind and the first line of its message.

    >>> one_line(ValueError("no waves\nat all")), one_line(KeyboardInterrupt())
    ('ValueError: no waves', 'KeyboardInterrupt')
    """
    first = (str(error).splitlines() or [""])[0]
    return f"{type(error).__name__}: {first}" if first else type(error).__name__
