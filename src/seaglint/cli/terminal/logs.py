"""Log messages of the package, printed as plain lines on stderr."""

from __future__ import annotations

import logging

from seaglint.cli.terminal.messages import log


class _Stderr(logging.Handler):
    """The standard error of the moment: tests and notebooks exchange it. A warning is printed once a command."""

    def __init__(self) -> None:
        super().__init__()
        self.warned: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Write one line."""
        text = record.getMessage()
        if record.levelno >= logging.WARNING:
            fact = str(getattr(record, "fact", text))  # what stays the same where numbers in the text follow a scene
            if fact in self.warned:
                return  # a study prepares the same air for every height, hour and scene
            self.warned.add(fact)
        log(text)


def begin_logs() -> None:
    """Print the warnings of a command that begins, each once."""
    show_logs(quiet=True)
    for handler in logging.getLogger("seaglint").handlers:
        if isinstance(handler, _Stderr):
            handler.warned.clear()


def show_logs(*, quiet: bool = False) -> None:
    """Print progress and warnings of the package's loggers; ``quiet`` leaves the warnings."""
    logger = logging.getLogger("seaglint")
    if not any(isinstance(handler, _Stderr) for handler in logger.handlers):
        logger.addHandler(_Stderr())
        logger.propagate = False
    logger.setLevel(logging.WARNING if quiet else logging.INFO)
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)  # fonts that are missing change no number
