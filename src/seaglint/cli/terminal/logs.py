"""Log messages of the package, printed as plain lines on stderr."""

from __future__ import annotations

import logging

from seaglint.cli.terminal.messages import log


class _Stderr(logging.Handler):
    """The standard error of the moment: tests and notebooks exchange it."""

    def emit(self, record: logging.LogRecord) -> None:
        """Write one line."""
        log(record.getMessage())


def show_logs(*, quiet: bool = False) -> None:
    """Print progress and warnings of the package's loggers; ``quiet`` leaves the warnings."""
    logger = logging.getLogger("seaglint")
    if not any(isinstance(handler, _Stderr) for handler in logger.handlers):
        logger.addHandler(_Stderr())
        logger.propagate = False
    logger.setLevel(logging.WARNING if quiet else logging.INFO)
