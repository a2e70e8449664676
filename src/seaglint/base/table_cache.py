"""Cache of the tables of pure functions, on disk next to the compiled kernels of this state of the sources."""

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


def cached_table(make: Callable[[int], FloatArray]) -> Callable[[int], FloatArray]:
    """Return a function with its results cached on disk: it reads a table that an earlier process has computed.

    It is for tables that depend on one whole number alone. The folder of the files changes with every source of physics, and their names
    with processor, NumPy and SciPy, so that computed and read results have equal bits. If no file can be written, each process computes its
    tables; plain Python (``NUMBA_DISABLE_JIT=1``) always does.
    """

    @wraps(make)
    def table(number: int) -> FloatArray:
        path = _path(make, number)
        if path is None:
            return make(number)
        with suppress(OSError, ValueError, EOFError):  # a missing or damaged file
            return np.asarray(np.load(path, allow_pickle=False), dtype=np.float64)
        result = make(number)
        _write(path, result)
        return result

    return table


def _path(make: Callable[[int], FloatArray], number: int) -> Path | None:
    """Return the file of a table; None without a cache."""
    folder = None if _settings.DISABLE_JIT else kernel_folder(_settings.CACHE_DIR)
    if folder is None:
        return None
    machine = crc32(f"{processor()} {np.__version__} {scipy.__version__}".encode())
    return folder / f"{make.__module__.removeprefix('seaglint.')}.{make.__name__}-{number}-{machine:08x}.npy"


def _write(path: Path, table: FloatArray) -> None:
    """Write a table as a whole or, on a full disk or without permission, not at all."""
    # written aside and moved: other processes see a whole file or none
    partial = path.with_name(f"{path.name}.{os.urandom(4).hex()}")
    try:
        with open(partial, "xb") as file:
            np.save(file, table, allow_pickle=False)
        os.replace(partial, path)
    except OSError:
        with suppress(OSError):
            partial.unlink()
