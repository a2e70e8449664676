"""Number of threads of kernels and of linear algebra."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import numba

from seaglint.base.errors import BackendError


@contextmanager
def single_threaded_algebra() -> Iterator[None]:
    """Run linear algebra (BLAS) in one thread and restore the old number afterwards; also a decorator of functions.

    The matrices of this program are small: one thread is as fast, leaves the processor to other threads and processes, and sums in one
    order on all machines. The limit holds for the whole process while the context lasts.

    Examples
    --------
    >>> import numpy as np
    >>> with single_threaded_algebra():
    ...     print(f"{np.linalg.svd(np.diag([3.0, 2.0]), compute_uv=False)[0]:.6f}")
    3.000000
    """
    from threadpoolctl import threadpool_limits

    with threadpool_limits(limits=1, user_api="blas"):
        yield


@contextmanager
def thread_limit(threads: int | None = None) -> Iterator[None]:
    """Run kernels with a number of threads and linear algebra with one, and restore the old numbers afterwards.

    Parameters
    ----------
    threads : int, optional
        Threads of the kernels; as many as Numba has by default.

    Raises
    ------
    BackendError
        More threads than Numba was started with.
    """
    most = int(vars(numba.config)["NUMBA_NUM_THREADS"])  # set at run time, where type checkers do not see it
    if threads is not None and not 1 <= threads <= most:
        raise BackendError(
            f"threads = {threads}: allowed are 1 to {most} here; the environment variable NUMBA_NUM_THREADS raises the limit"
        )
    before = numba.get_num_threads()
    with single_threaded_algebra():
        if threads is not None:
            numba.set_num_threads(threads)
        try:
            yield
        finally:
            numba.set_num_threads(before)
