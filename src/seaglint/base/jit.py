"""Compilation of kernels with Numba, in one place, so that launchers can change without the kernels.

``NUMBA_DISABLE_JIT=1`` runs the same functions as plain Python.
"""

from __future__ import annotations

import os
import threading
import uuid
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

from seaglint.base.kernel_cache import end_turn, kernel_folder, take_turn

F = TypeVar("F", bound=Callable[..., Any])


# Every option is given explicitly: a function takes missing ones from the function that happens to be compiled with it.
COUNTED: dict[str, Any] = {"error_model": "numpy", "nogil": True, "fastmath": False, "forceinline": False, "_nrt": True}
UNCOUNTED: dict[str, Any] = COUNTED | {"fastmath": {"contract"}, "forceinline": True, "_nrt": False}


_settings: Any = numba.config  # made at run time, where type checkers do not see it
_decorating = threading.Lock()


def _compiled(function: F, **options: Any) -> F:
    """Compile a function with Numba on its first call, or load it from :func:`kernel_folder`."""
    if _settings.DISABLE_JIT:
        return cast(F, numba.njit(**options)(function))
    with _decorating:
        users = _settings.CACHE_DIR
        folder = kernel_folder(users)
        if folder is None:
            return cast(F, numba.njit(**options)(function))
        _settings.CACHE_DIR = str(folder)  # read while a function is decorated; kernels of other packages use their usual folder
        try:
            made = numba.njit(cache=True, **options)(function)
        finally:
            _settings.CACHE_DIR = users
    _name_apart(made)
    _take_turns(made, folder)
    return cast(F, made)


def _name_apart(compiled: Any) -> None:
    """Give every compiled form a file name of its own.

    Numba counts them from what the index lists: of two processes that compile a function for different arguments at the same time, both
    would take the same number, and one would find the other's code under its own arguments.

    The names below are Numba's private ones: its version is bounded for them in ``pyproject.toml``, and a version without them raises
    ``AttributeError`` here, before anything wrong is loaded.
    """
    file = compiled._cache._cache_file
    stem = file._index_name.removesuffix(".nbi")
    assert callable(file._data_name)
    file._data_name = lambda number: f"{stem}.{uuid.uuid4().hex[:12]}.nbc"


def _take_turns(compiled: Any, folder: Path) -> None:
    """Let one of the processes that begin at the same time compile a function, and the others wait for it and load the result.

    A function is compiled after those that it calls, and calls lead round in no circle: nobody waits for ever.
    """
    cache = compiled._cache
    load, save, name = cache.load_overload, cache.save_overload, os.path.relpath(cache._cache_file._index_path, folder)

    def load_or_wait(*arguments: Any) -> Any:
        overload = load(*arguments)
        if overload is None:
            take_turn(folder, name)
            overload = load(*arguments)
            if overload is not None:
                end_turn(folder, name)
        return overload

    def save_and_end_turn(*arguments: Any) -> None:
        try:
            save(*arguments)
        finally:
            end_turn(folder, name)

    cache.load_overload, cache.save_overload = load_or_wait, save_and_end_turn


def kernel(function: F) -> F:
    """Compile a scalar kernel that neither makes nor returns arrays and calls kernels alone, to be inlined where it is called.

    It counts no references to the arrays it is handed: in a call every few nanoseconds, with arrays in its arguments, counting them costs
    more than the arithmetic. Products are fused with sums where the processor can: bytes are the same on one type of processor.
    """
    return _compiled(function, **UNCOUNTED)


def njit(function: F) -> F:
    """Compile a function; cached on disk, IEEE arithmetic (bytes must not depend on optimisation flags)."""
    return _compiled(function, **COUNTED)


def njit_parallel(function: F) -> F:
    """Compile a launcher whose outer loop is ``numba.prange``; iterations must be independent of each other."""
    return _compiled(function, parallel=True, **COUNTED)


SHARES_PER_THREAD = 8
"""Parts of the work for each thread; with several parts a slow one does not delay the other threads."""


def in_threads(work: Callable[[tuple[int, int]], None], count: int) -> None:
    """Divide ``range(count)`` into parts ``(first, end)`` and run them in as many threads as Numba uses.

    For compiled kernels, which release the interpreter, too large for Numba's own parallel loops: those compile all that they call once
    more. ``work`` must not depend on the order or size of the parts.
    """
    threads = int(numba.get_num_threads())
    size = max(-(-count // (threads * SHARES_PER_THREAD)), 1)
    parts = [(first, min(first + size, count)) for first in range(0, count, size)]
    work((0, 0))  # compiles, if need be, in one thread
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(work, parts))
