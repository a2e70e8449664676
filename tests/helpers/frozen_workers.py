"""Workers that stop themselves at a call, as a frozen machine does, and continue when the test wakes them."""

from __future__ import annotations

import importlib
import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

from seaglint.cluster import ThisProcess
from seaglint.cluster.job import outgoing


def stop_at(call: str, nth: int, folder: Path) -> None:
    """Make this process stop itself before the ``nth`` call, counted from 1, of ``module:attribute``; it says so in a file."""
    module, _, attribute = call.partition(":")
    *path, last = attribute.split(".")
    owner: Any = importlib.import_module(module)
    for part in path:
        owner = getattr(owner, part)
    original, calls = getattr(owner, last), 0

    def stopping(*arguments: Any, **named: Any) -> Any:
        nonlocal calls
        calls += 1
        if calls == nth:
            (folder / "stops").touch()
            os.kill(os.getpid(), signal.SIGSTOP)
        return original(*arguments, **named)

    setattr(owner, last, stopping)


def work(folder: str, call: str, nth: str) -> None:
    """Do the unit in the folder, in the process of a worker."""
    start, settings, unit = pickle.loads((Path(folder) / "job").read_bytes())
    made = start(settings)
    stop_at(call, int(nth), Path(folder))
    made(unit)


def share_that_stops(folder: str, call: str, nth: str, output: str) -> None:
    """Write the first of two shares, and stop at a call."""
    import toy_store

    stop_at(call, int(nth), Path(folder))
    toy_store.share(output, 0, 2)


class Stopped:
    """A process of a function of a helper module, which stops itself."""

    def __init__(self, folder: Path, code: str, *arguments: object) -> None:
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path)), "NUMBA_NUM_THREADS": "1"}
        with (folder / "stderr").open("w") as errors:
            self.process = subprocess.Popen([sys.executable, "-c", code, *map(str, arguments)], env=environment, stderr=errors)
        _, status = os.waitpid(self.process.pid, os.WUNTRACED)
        self.folder = folder
        assert os.WIFSTOPPED(status), (folder / "stderr").read_text()

    def wake(self) -> None:
        """Continue the process and wait for its end."""
        if self.process.returncode is None:
            os.kill(self.process.pid, signal.SIGCONT)
            self.process.wait(600)

    def __enter__(self) -> Stopped:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.returncode is None:
            self.process.kill()
            self.process.wait(600)


class FreezingWorkers(ThisProcess):
    """Two workers: one stops in a unit, which this process then does too, with all others.

    Parameters
    ----------
    folder : Path
        Folder of the stopped process, outside of the output.
    call, nth : str, int
        Call before which it stops.
    place : int
        Place of its unit.
    """

    def __init__(self, folder: Path, call: str, nth: int = 1, place: int = 0) -> None:
        self.folder, self.call, self.nth, self.place = folder, call, nth, place
        self.stopped: Stopped | None = None

    @contextmanager
    def map(self, job: Any, units: Any) -> Iterator[Any]:
        units = list(units)
        if self.stopped is None:
            (self.folder / "job").write_bytes(outgoing((job.start, job.settings, units[self.place])))
            code = "import sys, frozen_workers; frozen_workers.work(*sys.argv[1:])"
            self.stopped = Stopped(self.folder, code, self.folder, self.call, self.nth)
        with super().map(job, units) as outcomes:
            yield outcomes

    def __enter__(self) -> FreezingWorkers:
        return self

    def __exit__(self, *_: object) -> None:
        if self.stopped is not None:
            self.stopped.__exit__()


class WakingWorkers(ThisProcess):
    """This process, which wakes a stopped one after its first unit."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self.wake = wake

    @contextmanager
    def map(self, job: Any, units: Any) -> Iterator[Any]:
        def outcomes(given: Iterator[Any]) -> Iterator[Any]:
            yield next(given)
            self.wake()
            yield from given

        with super().map(job, units) as given:
            yield outcomes(iter(given))


def tree(folder: Path) -> dict[str, str]:
    """All files and folders below a folder, files with their checksums."""
    return {
        str(path.relative_to(folder)): sha256(path.read_bytes()).hexdigest() if path.is_file() else "folder"
        for path in sorted(folder.rglob("*"))
    }
