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


# All options are explicit: a function inherits missing ones from the function in which it is compiled.
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
    """Compile a function with Numba on its first call, or load it from ``kernel_folder``."""
    dispatcher: Any = numba.njit(**options)(function)
    if _settings.DISABLE_JIT:
        return cast(F, dispatcher)
    _cached(dispatcher, function, "")
    return cast(F, dispatcher)


def _cached(dispatcher: Any, function: Callable[..., Any], form: str) -> bool:
    """Give a function a cache in the folder of this state of the sources; return True if the function has one.

    The name of the folder identifies all sources of the package. So its files are named by module, and programs of other copies of equal
    sources share them, while Numba's names and stamps contain the path and the time of a source.
    """
    if not Path(function.__code__.co_filename).is_relative_to(PACKAGE):
        if not form:
            dispatcher.enable_caching()  # Numba's own rules
        return False
    folder = kernel_folder(_settings.CACHE_DIR)
    if folder is None:
        return False
    _require_own_name(function)
    dispatcher._cache = KernelCache(function, folder, form)
    _name_apart(dispatcher)
    _take_turns(dispatcher, folder)
    return True


_codes: dict[tuple[str, str], Any] = {}


def _require_own_name(function: Callable[..., Any]) -> None:
    """Raise for a second kernel of one name in a module, and for a kernel with a closure: their files would have equal names.

    Raises
    ------
    TypeError
        Such a kernel; it occurs in development only.
    """
    code = _codes.setdefault((function.__module__, function.__qualname__), function.__code__)
    if code != function.__code__ or function.__closure__:
        raise TypeError(f"kernel {function.__module__}.{function.__qualname__} needs a name of its own and no closure")


def _name_apart(compiled: Any) -> None:
    """Give every compiled form a unique file name.

    Numba numbers them by the entries of the index: two processes that compile a function for different arguments at the same time would
    take one number, and one of them would load the other's code for its arguments.

    The attributes below are private to Numba: its version is bounded for them in ``pyproject.toml``, and a version without them raises
    ``AttributeError`` here, before wrong code is loaded.
    """
    file = compiled._cache._cache_file
    stem = file._index_name.removesuffix(".nbi")
    assert callable(file._data_name)
    file._data_name = lambda number: f"{stem}.{uuid.uuid4().hex[:12]}.nbc"


def _take_turns(compiled: Any, folder: Path) -> None:
    """Let one of several processes compile a function; the others wait for it and load the result.

    A function is compiled after the functions that it calls, and calls have no cycles: no process waits for ever.
    """
    cache = compiled._cache
    load, save, name = cache.load_overload, cache.save_overload, cache._cache_file._index_name
    translate = compiled._compiler.compile

    def load_or_wait(*arguments: Any) -> Any:
        overload = load(*arguments)
        if overload is None:
            take_turn(folder, name)
            try:
                overload = load(*arguments)
            except BaseException:
                end_turn(folder, name)
                raise
            if overload is not None:
                end_turn(folder, name)
        return overload

    def save_and_end_turn(*arguments: Any) -> None:
        try:
            save(*arguments)
        except OSError as error:  # a full disk: the program continues with the code in memory
            _warn_not_cached(folder, error.strerror or str(error))
        finally:
            end_turn(folder, name)

    def compile_or_end_turn(*arguments: Any) -> Any:
        try:
            return translate(*arguments)
        except BaseException:  # what cannot be compiled, or an interruption: others would wait for this process
            end_turn(folder, name)
            raise

    cache.load_overload, cache.save_overload = load_or_wait, save_and_end_turn
    compiled._compiler.compile = compile_or_end_turn


@cache
def _warn_not_cached(folder: Path, reason: str) -> None:
    logging.getLogger("seaglint").warning("compiled kernels cannot be kept in %s (%s) and are compiled again next time", folder, reason)


def _in_callers(dispatcher: Any, function: Callable[..., Any], options: dict[str, Any]) -> None:
    """Give compiled callers a body to link in; the whole program that Numba compiles is only for calls from Python."""

    @cache
    def body() -> Any:
        without: dict[str, Any] = {"pipeline_class": BodyCompiler, "no_cpython_wrapper": True}
        other: Any = numba.njit(**(options | without))(function)
        _cached(other, function, ".body")
        return other

    def any_value(types: Any) -> Any:
        # for "f(0)" and "f(1)" Numba would compile two forms; one form for any number is as fast after it is linked in
        return tuple(_unliteral(one) for one in types)

    dispatcher.get_call_template = lambda args, kws: body().get_call_template(
        any_value(args), {k: any_value((v,))[0] for k, v in kws.items()}
    )
    dispatcher.get_overload = lambda signature: body().get_overload(signature)


def kernel(function: F) -> F:
    """Compile a scalar kernel that neither allocates nor returns arrays and calls only kernels, to be inlined where it is called.

    It does not count references to its array arguments: for a call every few nanoseconds, counting costs more than the arithmetic. Products
    are fused with sums where the processor can: bytes are equal on one type of processor.
    """
    dispatcher: Any = _compiled(function, **UNCOUNTED)
    if not _settings.DISABLE_JIT:
        _in_callers(dispatcher, function, UNCOUNTED)
    return cast(F, dispatcher)


def njit(function: F) -> F:
    """Compile a function; cached on disk, IEEE arithmetic (bytes must not depend on optimisation flags)."""
    dispatcher: Any = _compiled(function, **COUNTED)
    if not _settings.DISABLE_JIT:
        _in_callers(dispatcher, function, COUNTED)
    return cast(F, dispatcher)


def njit_parallel(function: F) -> F:
    """Compile a launcher whose outer loop is ``numba.prange``; iterations must be independent of each other."""
    return _compiled(function, parallel=True, **COUNTED)


SHARES_PER_THREAD = 8  #: Number of parts of the work for each thread; with several parts a slow part does not delay the other threads.


def in_threads(work: Callable[[tuple[int, int]], None], count: int) -> None:
    """Divide ``range(count)`` into parts ``(first, end)`` and run them in as many threads as Numba uses.

    This is for compiled kernels, which release the interpreter and are too large for Numba's parallel loops: these compile all called
    functions once more. ``work`` must not depend on the order or size of the parts.
    """
    threads = int(numba.get_num_threads())
    size = max(-(-count // (threads * SHARES_PER_THREAD)), 1)
    # the number of parts depends on threads, results must not
    parts = [(first, min(first + size, count)) for first in range(0, count, size)]
    work((0, 0))  # compiles in one thread, unless the kernel is compiled
    if threads == 1:
        work((0, count))
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(work, parts))
