"""Main loop of a local worker process: it reads units from its parent, works, and answers; it ends when its parent ends.

Messages from the parent: ``("job", name, pickled job)`` and ``("unit", pickled unit)``. Answers: ``("ready", name)``, ``("refused", name,
pickled error or None, line, traceback)`` and ``("outcome", pickled outcome)``.
"""

from __future__ import annotations

import os
import pickle
import queue
import signal
import sys
import threading
import traceback
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from seaglint.base.errors import one_line
from seaglint.base.reports import leave_reports_to_parent
from seaglint.cluster.job import Failed, attempt


def serve(number: int) -> None:
    """Work for the parent at the other end of a socket, until the parent closes the socket."""
    os.set_inheritable(number, False)
    leave_reports_to_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent ends its workers
    pipe, name = Connection(number), f"process {os.getpid()}"
    inbox: queue.SimpleQueue[tuple[Any, ...]] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(pipe, inbox), daemon=True).start()
    work: Callable[[Any], Any] | None = None
    while True:
        match inbox.get():
            case ("job", str(job), bytes(content)):
                work = _started(job, content, pipe)
            case ("unit", bytes(content)) if work is not None:
                _answer(pipe, ("outcome", _outcome(work, content, name)))


def _listen(pipe: Connection, inbox: queue.SimpleQueue[tuple[Any, ...]]) -> None:
    """Queue the messages of the parent; end the process at once when the connection closes."""
    while True:
        try:
            inbox.put(pipe.recv())
        except (EOFError, OSError):
            os._exit(0)


def _answer(pipe: Connection, message: tuple[Any, ...]) -> None:
    try:
        pipe.send(message)
    except OSError:  # the parent is gone
        os._exit(0)


def _started(job: str, content: bytes, pipe: Connection) -> Callable[[Any], Any] | None:
    """Return the function of a unit; None if the job cannot be started in this process."""
    try:
        start, settings = pickle.loads(content)
        work: Callable[[Any], Any] = start(settings)
    except Exception as error:
        try:
            pickled = pickle.dumps(error)
            pickle.loads(pickled)  # some errors pickle and cannot be read again
        except Exception:
            pickled = None
        _answer(pipe, ("refused", job, pickled, one_line(error), traceback.format_exc()))
        return None
    _answer(pipe, ("ready", job))
    return work


def _outcome(work: Callable[[Any], Any], content: bytes, name: str) -> bytes:
    """Return the pickled outcome of a unit."""
    unit = pickle.loads(content)
    outcome = attempt(work, unit, name, 1)
    try:
        return pickle.dumps(outcome)
    except Exception as error:
        return pickle.dumps(Failed(unit, f"the record cannot be sent: {one_line(error)}", traceback.format_exc(), 1))


if __name__ == "__main__":
    serve(int(sys.argv[1]))
