"""The one door to Numba: scalar kernels are compiled here, so that their launchers can change without them.

``NUMBA_DISABLE_JIT=1`` runs the same functions as plain Python.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

F = TypeVar("F", bound=Callable[..., Any])


def njit(function: F) -> F:
    """Compile a scalar kernel; cached on disk, IEEE arithmetic (bytes must not depend on optimisation flags)."""
    return cast(F, numba.njit(cache=True, error_model="numpy", nogil=True)(function))


def njit_inline(function: F) -> F:
    """Compile a scalar kernel into its callers: records of arrays are costly to hand over in hot loops."""
    return cast(F, numba.njit(cache=True, error_model="numpy", nogil=True, inline="always")(function))


def njit_parallel(function: F) -> F:
    """Compile a launcher whose outer loop is ``numba.prange``; iterations must be independent of each other."""
    return cast(F, numba.njit(cache=True, error_model="numpy", parallel=True, nogil=True)(function))
