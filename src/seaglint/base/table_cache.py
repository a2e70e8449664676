"""Tables of pure functions, kept on disk beside the compiled kernels of this state of the sources."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from functools import wraps
from pathlib import Path
from typing import Any
from zlib import crc32

import numba
import numpy as np
import scipy

from seaglint.base.conventions import FloatArray
from seaglint.base.kernel_cache import kernel_folder
from seaglint.base.machine import processor

_settings: Any = numba.config  # made at run time, where type checkers do not see it


def kept(make: Callable[[int], FloatArray]) -> Callable[[int], FloatArray]:
    """Return a function whose results are read from disk where an earlier process has computed them.

    For tables that depend on one whole number and on nothing else. The files' folder changes with every source of physics, and their names
    with processor, NumPy and SciPy, so a result has the same bits whether it is computed or read. Where no file can be written each process
    computes its own; plain Python (``NUMBA_DISABLE_JIT=1``) always does.
    """

    @wraps(make)
    def table(number: int) -> FloatArray:
        path = _path(make, number)
        if path is None:
            return make(number)
        with suppress(OSError, ValueError, EOFError):  # nothing there, or damaged
            return np.asarray(np.load(path, allow_pickle=False), dtype=np.float64)
        result = make(number)
        _write(path, result)
        return result

    return table


def _path(make: Callable[[int], FloatArray], number: int) -> Path | None:
    """Return the file of a table; None where nothing is kept."""
    folder = None if _settings.DISABLE_JIT else kernel_folder(_settings.CACHE_DIR)
    if folder is None:
        return None
    machine = crc32(f"{processor()} {np.__version__} {scipy.__version__}".encode())
    return folder / f"{make.__module__.removeprefix('seaglint.')}.{make.__name__}-{number}-{machine:08x}.npy"


def _write(path: Path, table: FloatArray) -> None:
    """Write a table as a whole or, on a full disk or without rights, not at all."""
    partial = path.with_name(f"{path.name}.{os.urandom(4).hex()}")
    try:
        with open(partial, "xb") as file:
            np.save(file, table, allow_pickle=False)
        os.replace(partial, path)
    except OSError:
        with suppress(OSError):
            partial.unlink()
