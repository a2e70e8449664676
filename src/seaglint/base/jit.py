"""Compilation of kernels with Numba, in one place, so that launchers can change without the kernels.

``NUMBA_DISABLE_JIT=1`` runs the same functions as plain Python.
"""

from __future__ import annotations

import logging
import uuid
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba

from seaglint.base.kernel_bodies import BodyCompiler, KernelCache
from seaglint.base.kernel_cache import PACKAGE, end_turn, kernel_folder, take_turn

F = TypeVar("F", bound=Callable[..., Any])


# Every option is given explicitly: a function takes missing ones from the function that happens to be compiled with it.
COUNTED: dict[str, Any] = {
    "error_model": "numpy",
    "nogil": True,
    "fastmath": False,
    "forceinline": False,
    "_nrt": True,
    "no_cfunc_wrapper": True,  # nobody calls kernels from C; each wrapper costs 20 ms
}
UNCOUNTED: dict[str, Any] = COUNTED | {"fastmath": {"contract"}, "forceinline": True, "_nrt": False}


_settings: Any = numba.config  # made at run time, where type checkers do not see it
_unliteral: Any = numba.types.unliteral  # without types


def _compiled(function: F, **options: Any) -> F:
    """Compile a function with Numba on its first call, or load it from :func:`kernel_folder`."""
    made: Any = numba.njit(**options)(function)
    if _settings.DISABLE_JIT:
        return cast(F, made)
    _cached(made, function, "")
    return cast(F, made)


def _cached(made: Any, function: Callable[..., Any], form: str) -> bool:
    """Give a function a cache in the folder of this state of the sources; return whether there is one.

    That folder's name stands for all sources of the package. So its files are named by module, and programs of other copies of the same
    sources share them, while Numba's own names and stamps contain where a source lies and when it was written.
    """
    if not Path(function.__code__.co_filename).is_relative_to(PACKAGE):
        if not form:
            made.enable_caching()  # Numba's own rules
        return False
    folder = kernel_folder(_settings.CACHE_DIR)
    if folder is None:
        return False
    _require_own_name(function)
    made._cache = KernelCache(function, folder, form)
    _name_apart(made)
    _take_turns(made, folder)
    return True


_codes: dict[tuple[str, str], Any] = {}


def _require_own_name(function: Callable[..., Any]) -> None:
    """Refuse a second kernel of one name in a module, or one that closes over values: their files would be one.

    Raises
    ------
    TypeError
        In development only: no kernel of the package does so.
    """
    code = _codes.setdefault((function.__module__, function.__qualname__), function.__code__)
    if code != function.__code__ or function.__closure__:
        raise TypeError(f"kernel {function.__module__}.{function.__qualname__} needs a name of its own and no closure")


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
    load, save, name = cache.load_overload, cache.save_overload, cache._cache_file._index_name

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
        except OSError as error:  # a full disk: the program goes on with what it has in memory
            _not_kept(folder, error.strerror or str(error))
        finally:
            end_turn(folder, name)

    cache.load_overload, cache.save_overload = load_or_wait, save_and_end_turn


@cache
def _not_kept(folder: Path, reason: str) -> None:
    logging.getLogger("seaglint").warning("compiled kernels cannot be kept in %s (%s) and are compiled again next time", folder, reason)


def _in_callers(made: Any, function: Callable[..., Any], options: dict[str, Any]) -> None:
    """Give compiled callers a body to link in; the whole program that Numba makes is for calls from Python alone."""

    @cache
    def body() -> Any:
        without: dict[str, Any] = {"pipeline_class": BodyCompiler, "no_cpython_wrapper": True}
        other: Any = numba.njit(**(options | without))(function)
        _cached(other, function, ".body")
        return other

    def any_value(types: Any) -> Any:
        # For "f(0)" and "f(1)" Numba would compile two forms, where one that takes any number is as fast after it was linked in.
        return tuple(_unliteral(one) for one in types)

    made.get_call_template = lambda args, kws: body().get_call_template(any_value(args), {k: any_value((v,))[0] for k, v in kws.items()})
    made.get_overload = lambda signature: body().get_overload(signature)


def kernel(function: F) -> F:
    """Compile a scalar kernel that neither makes nor returns arrays and calls kernels alone, to be inlined where it is called.

    It counts no references to the arrays it is handed: in a call every few nanoseconds, with arrays in its arguments, counting them costs
    more than the arithmetic. Products are fused with sums where the processor can: bytes are the same on one type of processor.
    """
    made: Any = _compiled(function, **UNCOUNTED)
    if not _settings.DISABLE_JIT:
        _in_callers(made, function, UNCOUNTED)
    return cast(F, made)


def njit(function: F) -> F:
    """Compile a function; cached on disk, IEEE arithmetic (bytes must not depend on optimisation flags)."""
    made: Any = _compiled(function, **COUNTED)
    if not _settings.DISABLE_JIT:
        _in_callers(made, function, COUNTED)
    return cast(F, made)


def njit_parallel(function: F) -> F:
    """Compile a launcher whose outer loop is ``numba.prange``; iterations must be independent of each other."""
    return _compiled(function, parallel=True, **COUNTED)


SHARES_PER_THREAD = 8  #: Parts of the work for each thread; with several parts a slow one does not delay the other threads.


def in_threads(work: Callable[[tuple[int, int]], None], count: int) -> None:
    """Divide ``range(count)`` into parts ``(first, end)`` and run them in as many threads as Numba uses.

    For compiled kernels, which release the interpreter, too large for Numba's own parallel loops: those compile all that they call once
    more. ``work`` must not depend on the order or size of the parts.
    """
    threads = int(numba.get_num_threads())
    size = max(-(-count // (threads * SHARES_PER_THREAD)), 1)
    parts = [(first, min(first + size, count)) for first in range(0, count, size)]
    work((0, 0))  # compiles, if need be, in one thread
    if threads == 1:
        work((0, count))
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(work, parts))
