"""The one door to Numba: scalar kernels are compiled here, so that their launchers can change without them.

``NUMBA_DISABLE_JIT=1`` runs the same functions as plain Python.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


# Said outright in every case: a function takes over what is left unsaid from the one that happens to be compiled with it.
COUNTED: dict[str, Any] = {"cache": True, "error_model": "numpy", "nogil": True, "fastmath": False, "forceinline": False, "_nrt": True}
UNCOUNTED: dict[str, Any] = COUNTED | {"fastmath": {"contract"}, "forceinline": True, "_nrt": False}


def kernel(function: F) -> F:
    """Compile a scalar kernel that neither makes nor returns arrays and calls kernels alone, to be inlined where it is called.

    It counts no references to the arrays it is handed: in a call every few nanoseconds, with arrays in its arguments, counting them costs
    more than the arithmetic. Products are fused with sums where the processor can: bytes are the same on one type of processor.
    """
    return cast(F, numba.njit(**UNCOUNTED)(function))


def njit(function: F) -> F:
    """Compile a function; cached on disk, IEEE arithmetic (bytes must not depend on optimisation flags)."""
    return cast(F, numba.njit(**COUNTED)(function))


def njit_parallel(function: F) -> F:
    """Compile a launcher whose outer loop is ``numba.prange``; iterations must be independent of each other."""
    return cast(F, numba.njit(parallel=True, **COUNTED)(function))


SHARES_PER_THREAD = 8
"""Pieces of work for each thread: a slow one does not hold up the others."""


def in_threads(work: Callable[[tuple[int, int]], None], count: int) -> None:
    """Share ``range(count)`` out as parts ``(first, end)`` to as many threads as Numba is to use.

    For compiled kernels, which release the interpreter, too large for Numba's own parallel loops: those compile all that they call once
    more. ``work`` must not depend on the order or size of the parts.
    """
    threads = int(numba.get_num_threads())
    size = max(-(-count // (threads * SHARES_PER_THREAD)), 1)
    parts = [(first, min(first + size, count)) for first in range(0, count, size)]
    work((0, 0))  # compiles, if need be, in one thread
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(work, parts))
