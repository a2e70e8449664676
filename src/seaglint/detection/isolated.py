"""User's detector in a separate process: its errors and time limits end there and are reported in one line.

Frames go to the process and statistics come back through a socket. It is started once, its output to the console goes to stderr, and it is
ended with the session, after a call that takes too long, or when it dies.
"""

from __future__ import annotations

import math
import os
import socket
import subprocess
import sys
import time
from contextlib import suppress
from multiprocessing.connection import Connection
from threading import TIMEOUT_MAX, Timer
from typing import Any, Final

import numpy as np

from seaglint.base.errors import DataError, DomainError
from seaglint.detection.interface import GAUSSIAN_TAIL, Detector, Frames, UserDetector

TIME_LIMIT: Final = 60.0  #: Default time limit of a call [s].

START_LIMIT: Final = 120.0  #: Time limit for importing the module [s].


class IsolatedDetector:
    """User's detector, called in another process.

    Parameters
    ----------
    given : str or UserDetector
        Path as for ``seaglint.detection.interface.load``, or a detector, which is copied to the process.
    time_limit : float
        Longest time of a call [s].

    Raises
    ------
    DataError
        A path that ``seaglint.detection.interface.load`` refuses, a module that ends the process or takes too long to import, or a detector
        that cannot be copied.
    DomainError
        A time limit that is not above 0.
    """

    linear: Final = False

    def __init__(self, given: str | UserDetector, time_limit: float = TIME_LIMIT) -> None:
        if not time_limit > 0:
            raise DomainError(f"time_limit = {time_limit:g} s; give a number above 0")
        self.path, self.time_limit = given if isinstance(given, str) else given.name, time_limit
        ours, theirs = socket.socketpair()
        with theirs:
            # The child inherits the descriptor of its end; standard output goes to stderr, so that results stay readable.
            number = theirs.fileno()
            command = [sys.executable, "-m", "seaglint.detection.worker", str(number)]
            environment = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
            self._process = subprocess.Popen(command, pass_fds=[number], stdin=subprocess.DEVNULL, stdout=2, env=environment)
        self._connection = Connection(ours.detach())
        try:
            properties = self._answer(given, START_LIMIT, "while its module was imported")
        except BaseException:
            self.close()
            raise
        self.name, self.lead, self.calibrated, self.reach = (properties[k] for k in ("name", "lead", "calibrated", "reach"))

    @property
    def null_law(self) -> str | None:
        """Distribution of equivalent standard deviations where the function declares them."""
        return GAUSSIAN_TAIL if self.calibrated else None

    def __call__(self, frames: Frames) -> Frames:
        """Statistic of the frames from ``lead`` on, shape (k - lead, rows, columns) [1].

        Raises
        ------
        DataError
            The function fails, returns no array of that shape, takes too long, or ends its process.
        """
        when = f"on frames of shape {frames.shape}"
        if self._process.poll() is not None:
            raise DataError(f"detector {self.path} was ended before; it is not called again {when}")
        return np.asarray(self._answer(frames, self.time_limit, when), np.float32)

    def _answer(self, message: Any, limit: float, when: str) -> Any:
        """Send a message and return its answer; the process is ended after ``limit`` seconds, whether it takes the message or answers."""
        begin = time.monotonic()
        timer = Timer(min(limit, TIMEOUT_MAX), self._stop)
        timer.daemon = True
        timer.start()
        try:
            self._connection.send(message)
            good, answer = self._connection.recv()
        except (EOFError, OSError) as error:
            if time.monotonic() - begin >= limit:
                self.close()
                raise DataError(
                    f"detector {self.path} took longer than {limit:g} s {when}; make it faster, give it fewer pixels, or raise time_limit"
                ) from None
            raise self._ended(when) from error
        finally:
            timer.cancel()
        if not good:
            raise DataError(answer)
        return answer

    def _stop(self) -> None:
        """End the process and the connection: a process that the function started may hold its other end."""
        self._process.kill()
        with suppress(OSError), socket.socket(fileno=os.dup(self._connection.fileno())) as ours:
            ours.shutdown(socket.SHUT_RDWR)

    def _ended(self, when: str) -> DataError:
        code = self._process.wait()
        how = f"signal {-code}" if code < 0 else f"exit code {code}"
        return DataError(f"detector {self.path} ended its process ({how}) {when}; run it by itself to find out why")

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.wait()
        self._connection.close()

    def __del__(self) -> None:
        """End the process when the object is deleted."""
        if hasattr(self, "_connection") and self._process.poll() is None:
            self.close()


def running(given: str | Detector, time_limit: float) -> Detector:
    """Return a user's detector in a process that ends with a call longer than ``time_limit`` [s], or here where that is infinite.

    A function of a path always has its process, and a detector of this package needs none.

    Raises
    ------
    DataError
        See ``IsolatedDetector``.
    DomainError
        A time limit that is not above 0.
    """
    if isinstance(given, str) or (isinstance(given, UserDetector) and time_limit != math.inf):
        return IsolatedDetector(given, time_limit)
    return given


def ended(detector: Detector) -> None:
    """End the process of a detector, or of the detector behind a filter, if it has one."""
    inner = getattr(detector, "detector", detector)
    if isinstance(inner, IsolatedDetector):
        inner.close()
