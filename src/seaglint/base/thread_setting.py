"""The environment variable NUMBA_NUM_THREADS, read before Numba reads it: what Numba makes of a wrong number is a traceback."""

from __future__ import annotations

import os
from typing import Final

from seaglint.base.errors import BackendError

VARIABLE: Final = "NUMBA_NUM_THREADS"  #: Environment variable with the largest number of threads of kernels.

MOST: Final = 256  #: Threads that any machine is allowed.

#: Threads for each processor above which a number over :data:`MOST` is taken for a mistake: each costs memory, and all run slower.
MOST_PER_PROCESSOR: Final = 4


def require_thread_setting() -> None:
    """Refuse an environment variable that is no number of threads.

    Raises
    ------
    BackendError
        What is set, and what is allowed.
    """
    given = os.environ.get(VARIABLE)
    if not given:
        return
    most = max(MOST, MOST_PER_PROCESSOR * (os.cpu_count() or 1))
    number = int(given) if given.strip().isascii() and given.strip().isdecimal() else 0
    if not 1 <= number <= most:
        raise BackendError(
            f"{VARIABLE} = '{given}' in the environment is no number of threads; allowed: 1 to {most} here; "
            f"correct it, or remove it with 'unset {VARIABLE}'"
        )
