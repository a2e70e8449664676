"""Limits of threads hold inside their context, for kernels and for linear algebra, and leave what was there."""

from __future__ import annotations

import os
import subprocess
import sys

import numba
import pytest
from threadpoolctl import threadpool_info

from seaglint.base.errors import BackendError
from seaglint.base.threads import single_threaded_algebra, thread_limit

FOUND = """
import numpy, scipy.linalg
from threadpoolctl import threadpool_info
from seaglint.base.threads import {name}
def found():
    return {{entry["num_threads"] for entry in threadpool_info() if entry["user_api"] == "blas"}}
print(found())
with {name}():
    print(found())
print(found())
"""


def algebra() -> set[int]:
    """Threads of the linear algebra libraries in this process."""
    return {entry["num_threads"] for entry in threadpool_info() if entry["user_api"] == "blas"}


@pytest.mark.parametrize("name", ["single_threaded_algebra", "thread_limit"])
def test_linear_algebra_takes_one_thread_inside_and_as_many_as_before_after_it(name: str) -> None:
    """In a process of its own, with three threads: the suite's have one."""
    variables = dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "3")
    command = [sys.executable, "-c", FOUND.format(name=name)]
    out = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, **variables}).stdout
    before, inside, after = out.split()
    if before == "set()":
        pytest.skip("no linear algebra library whose threads can be told")
    assert (inside, after) == ("{1}", before)


def test_the_limit_is_put_back_after_an_error() -> None:
    kernels, before = numba.get_num_threads(), algebra()

    def failing() -> None:
        with thread_limit(1):
            assert numba.get_num_threads() == 1
            assert algebra() <= {1}
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        failing()
    assert (numba.get_num_threads(), algebra()) == (kernels, before)


def test_a_function_can_carry_the_limit() -> None:
    assert single_threaded_algebra()(algebra)() <= {1}


@pytest.mark.parametrize("threads", [0, -1, 10_000])
def test_threads_that_numba_does_not_have_are_refused(threads: int) -> None:
    with pytest.raises(BackendError, match="NUMBA_NUM_THREADS"), thread_limit(threads):
        pass
