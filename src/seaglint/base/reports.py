"""Reports to the user: facts that are printed once a command, and NumPy's warnings that are not printed.

The process that starts a command prints such facts; its workers do not.
"""

from __future__ import annotations

import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

REPORTS: Final = logging.getLogger("seaglint.reports")  #: Logger of such facts.


def leave_reports_to_parent() -> None:
    """Silence the facts in a process that works for another one; the first process of a command, which prints a log, is unchanged."""
    if not logging.getLogger("seaglint").handlers:
        REPORTS.disabled = True


@contextmanager
def absent_numbers() -> Iterator[None]:
    """Suppress NumPy's warnings of numbers that do not exist (a constant frame has no skewness): results report absent numbers."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        yield
