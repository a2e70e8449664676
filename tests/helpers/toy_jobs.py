"""Jobs of a few milliseconds, which worker processes find by this module's name."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from seaglint.base.errors import DomainError

HANG = 600.0
"""Seconds after which what never comes is given up."""


def until(true: Callable[[], bool]) -> None:
    """Wait until something is true."""
    given_up = time.monotonic() + HANG
    while not true():
        if time.monotonic() > given_up:
            raise TimeoutError
        time.sleep(0.01)


def squares(offset: int) -> Callable[[int], int]:
    return lambda unit: offset + unit * unit


def lines(folder: str) -> Callable[[str], str]:
    """Work told by the unit: ``kill``, ``freeze``, ``raise``, ``sleep SECONDS``, ``meet COUNT NAME``, ``hold NAME``.

    Each is told to a file of its attempts. Units that meet wait until so many of them have begun, one that holds until the folder has a
    file ``go``.
    """

    def work(unit: str) -> str:
        with (Path(folder) / unit.replace(" ", "-")).open("a") as file:
            file.write(f"{os.getpid()}\n")
        match unit.split():
            case ["kill", *_]:
                os.kill(os.getpid(), signal.SIGKILL)
            case ["once", *_]:
                if len(attempts(folder, unit)) == 1:
                    os.kill(os.getpid(), signal.SIGKILL)
            case ["freeze", *_]:
                os.kill(os.getpid(), signal.SIGSTOP)
            case ["raise", *_]:
                raise ValueError("no waves\nat all")
            case ["sleep", seconds]:
                time.sleep(float(seconds))
            case ["meet", count, _]:
                until(lambda: len(list(Path(folder).glob("meet-*"))) >= int(count))
            case ["hold", _]:
                until((Path(folder) / "go").exists)
            case ["environment"]:
                return f"{os.environ['NUMBA_NUM_THREADS']} {os.environ['OPENBLAS_NUM_THREADS']}"
        return unit.upper()

    return work


def attempts(folder: str | Path, unit: str) -> list[int]:
    """Processes that tried a unit."""
    path = Path(folder) / unit.replace(" ", "-")
    return [int(line) for line in path.read_text().split()] if path.exists() else []


def waiting(dask_worker: Any) -> int:
    """Units that a worker of Dask was given and has not begun."""
    return sum(task.state not in ("executing", "cancelled", "memory", "released") for task in dask_worker.state.tasks.values())


def dies_at_start(folder: str) -> Callable[[int], int]:
    (Path(folder) / f"started-{os.getpid()}").touch()
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


def freezes_at_start(folder: str) -> Callable[[str], str]:
    """Stop the first process that starts the job."""
    try:
        (Path(folder) / "freeze").unlink()
    except FileNotFoundError:
        return lines(folder)
    os.kill(os.getpid(), signal.SIGSTOP)
    return lines(folder)


def refuses(kind: str) -> Callable[[int], int]:
    if kind == "seaglint":
        raise DomainError("wind_speed = 31 m/s is outside 0-20 m/s", name="wind_speed", value=31.0, allowed=(0.0, 20.0))
    raise KeyError("lost")


def unsendable(_: None) -> Callable[[int], object]:
    return lambda unit: lambda: unit
