"""Check of the environment variable NUMBA_NUM_THREADS before Numba reads it: Numba ends with a traceback on a wrong number."""

from __future__ import annotations

import os
from typing import Final

from seaglint.base.errors import BackendError

VARIABLE: Final = "NUMBA_NUM_THREADS"  #: Environment variable with the largest number of threads of kernels.

MOST: Final = 256  #: Number of threads that is allowed on any machine.

#: Threads for each processor above which a number over ``MOST`` is taken for a mistake: each costs memory, and all run slower.
MOST_PER_PROCESSOR: Final = 4


def require_thread_setting() -> None:
    """Raise if the environment variable is no number of threads.

    Raises
    ------
    BackendError
        A value that is no number, or outside the allowed range.
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
