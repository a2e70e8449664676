"""Facts that a user needs to see once a command: the process that starts a command prints them, its workers do not."""

from __future__ import annotations

import logging
from typing import Final

REPORTS: Final = logging.getLogger("seaglint.reports")  #: Logger of such facts.


def leave_reports_to_parent() -> None:
    """Keep the facts silent in a process that works for another one; a command's own process prints its log and goes on."""
    if not logging.getLogger("seaglint").handlers:
        REPORTS.disabled = True
