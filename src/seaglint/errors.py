"""Errors a user can cause. Each text says what was given, what is allowed and what to do.

The command line prints them in one line and exits with :attr:`SeaglintError.exit_code`; anything else is a defect of
seaglint and keeps its traceback.
"""

from __future__ import annotations


class SeaglintError(Exception):
    """Parent of every error that is the caller's to mend."""

    exit_code = 2


class ScenarioError(SeaglintError):
    """A scenario file or key that cannot be used; the text names file, key path, value and what is allowed."""


class DomainError(SeaglintError, ValueError):
    """A number outside the range in which a physical model is valid."""


class DataError(SeaglintError):
    """An input or output file that is missing, cut, of the wrong kind or already there."""


class BackendError(SeaglintError):
    """An optional part (codec, reader, compiler, device) that is needed and not installed."""


class StorageError(SeaglintError):
    """Writing failed for lack of room or rights; what was written before stays and can be resumed."""

    exit_code = 3
