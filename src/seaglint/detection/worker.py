"""Process that runs a user's detector: ``python -m seaglint.detection.worker FD package.module:attribute``."""

from __future__ import annotations

import sys
from multiprocessing.connection import Connection

from seaglint.base.errors import DataError
from seaglint.detection.interface import load


def serve(connection: Connection, path: str) -> None:
    """Load the detector, send its properties, and answer frames with statistics until the other side closes."""
    try:
        detector = load(path)
    except DataError as error:
        connection.send((False, str(error)))
        return
    properties = {"name": detector.name, "lead": detector.lead, "calibrated": detector.calibrated, "reach": detector.reach}
    connection.send((True, properties))
    while True:
        try:
            frames = connection.recv()
        except (EOFError, OSError):
            return
        try:
            connection.send((True, detector(frames)))
        except DataError as error:
            connection.send((False, str(error)))


if __name__ == "__main__":
    serve(Connection(int(sys.argv[1])), sys.argv[2])
