"""Process that runs a user's detector: ``python -m seaglint.detection.worker FD``.

The first message is the detector's path, or the detector itself; each further one has frames.
"""

from __future__ import annotations

import os
import queue
import signal
import sys
import threading
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from seaglint.base.errors import DataError, one_line
from seaglint.detection.interface import UserDetector, load


def serve(connection: Connection) -> None:
    """Take the detector, send its properties, and answer frames with statistics until the other side closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the calling process ends this one
    inbox: queue.SimpleQueue[Any] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(connection, inbox), daemon=True).start()
    try:
        given = inbox.get()
        if isinstance(given, Exception):
            raise DataError(f"the detector cannot be read in the process that runs it: {one_line(given)}; give FILE.py:function instead")
        detector: UserDetector = load(given) if isinstance(given, str) else given
    except DataError as error:
        connection.send((False, str(error)))
        return
    properties = {"name": detector.name, "lead": detector.lead, "calibrated": detector.calibrated, "reach": detector.reach}
    connection.send((True, properties))
    while True:
        frames = inbox.get()
        try:
            with np.errstate(all="ignore"):  # numbers that do not exist are judged by the calling process
                answer = detector(frames)
            connection.send((True, answer))
        except DataError as error:
            connection.send((False, str(error)))


def _listen(connection: Connection, inbox: queue.SimpleQueue[Any]) -> None:
    """Queue the messages; end the process when the other side closes, also during a call that does not return."""
    while True:
        try:
            inbox.put(connection.recv())
        except (EOFError, OSError):
            os._exit(0)
        except Exception as error:  # a detector whose modules are not here
            inbox.put(error)


if __name__ == "__main__":
    serve(Connection(int(sys.argv[1])))
