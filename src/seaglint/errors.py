"""Errors a user can cause. Each text says what was given, what is allowed and what to do.

The command line prints them in one line and exits with :attr:`SeaglintError.exit_code`; anything else is a defect of
seaglint and keeps its traceback. Texts are for people: programs read the fields beside them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Allowed = tuple[float, float] | str | None
"""What a value may be: a closed range, words, or nothing that is told."""


class SeaglintError(Exception):
    """Parent of every error that is the caller's to mend."""

    exit_code = 2


@dataclass(frozen=True)
class Mistake:
    """One thing that is wrong in a scenario.

    Attributes
    ----------
    key : str
        Where it stands: ``"sensor.height_m"``, ``"render.layers[0]"``.
    value : object
        What was given; None where a key is missing.
    allowed : (float, float), str or None
        Closed range, or words; None where the text alone says it.
    text : str
        The whole sentence.
    """

    key: str
    value: Any
    allowed: Allowed
    text: str


class ScenarioError(SeaglintError):
    """A scenario file or key that cannot be used; the text names file, key path, value and what is allowed."""

    def __init__(self, text: str, *, mistakes: tuple[Mistake, ...] = ()) -> None:
        super().__init__(text)
        self._mistakes = mistakes

    @property
    def mistakes(self) -> tuple[Mistake, ...]:
        """What is wrong, key by key; empty where no single key is to blame."""
        return self._mistakes


class DomainError(SeaglintError, ValueError):
    """A number outside the range in which a physical model is valid.

    Parameters
    ----------
    text : str
        What was given, what is allowed, what to do.
    name : str, optional
        The quantity, as functions call it: ``"wind_speed"``.
    value : object, optional
        The number refused, in the unit of ``allowed``; the first of many.
    allowed : (float, float) or str, optional
        Closed range, or words where it is none.

    Examples
    --------
    >>> DomainError("height = 3 m ...", name="height", value=3.0, allowed=(5.0, 9.0)).allowed
    (5.0, 9.0)
    """

    def __init__(self, text: str, *, name: str | None = None, value: Any = None, allowed: Allowed = None) -> None:
        super().__init__(text)
        self._name, self._value, self._allowed = name, value, allowed

    @property
    def name(self) -> str | None:
        """Quantity refused; None where it is no single one."""
        return self._name

    @property
    def value(self) -> Any:
        """What was given for it."""
        return self._value

    @property
    def allowed(self) -> Allowed:
        """Closed range or words."""
        return self._allowed


class DataError(SeaglintError):
    """An input or output file that is missing, cut, of the wrong kind or already there."""


class BackendError(SeaglintError):
    """An optional part (codec, reader, compiler, device) that is needed and not installed."""


class StorageError(SeaglintError):
    """Writing failed for lack of room or rights; what was written before stays and can be resumed."""

    exit_code = 3


def one_line(error: BaseException) -> str:
    r"""An error as a line: its kind and the first line of its text.

    >>> one_line(ValueError("no waves\nat all")), one_line(KeyboardInterrupt())
    ('ValueError: no waves', 'KeyboardInterrupt')
    """
    first = (str(error).splitlines() or [""])[0]
    return f"{type(error).__name__}: {first}" if first else type(error).__name__
