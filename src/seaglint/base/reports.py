"""Facts that a user needs to see once a command: the process that starts a command prints them, its workers do not.

Computations in which numbers may not exist: a constant frame has no skewness, a detector may divide by 0.
"""

from __future__ import annotations

import logging
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

REPORTS: Final = logging.getLogger("seaglint.reports")  #: Logger of such facts.


def leave_reports_to_parent() -> None:
    """Keep the facts silent in a process that works for another one; a command's own process prints its log and goes on."""
    if not logging.getLogger("seaglint").handlers:
        REPORTS.disabled = True


@contextmanager
def absent_numbers() -> Iterator[None]:
    """Leave out NumPy's warnings of numbers that do not exist: the result states what is absent and why."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        yield
