"""Random streams are functions of their keys; kernels are functions of their arguments, compiled or not."""

from __future__ import annotations

import itertools
import math

import numba
import numpy as np
import pytest
from scipy import stats

from seaglint.base.jit import njit, njit_parallel
from seaglint.base.random import stream
from seaglint.base.sine import sine

SAMPLE = 20_000


def test_same_key_same_numbers() -> None:
    assert np.array_equal(stream(7, "waves", 1).random(8), stream(7, "waves", 1).random(8))


KEYS = [(7, "waves"), (8, "waves"), (7, "glint"), (7, "waves", 0), (7, "waves", 1), (7, "waves", 1, 0), (2**62, "waves")]


@pytest.mark.parametrize(("one", "other"), itertools.combinations(KEYS, 2))
def test_different_keys_are_uncorrelated(one: tuple, other: tuple) -> None:
    r = np.corrcoef(stream(*one).standard_normal(SAMPLE), stream(*other).standard_normal(SAMPLE))[0, 1]
    # Correlation of 20 000 independent pairs: standard deviation 0.0071; 4.5 of them are passed by chance once in 150 000.
    assert abs(r) < 4.5 / math.sqrt(SAMPLE)


def test_first_numbers_of_neighbouring_seeds_are_uniform() -> None:
    first = [stream(seed, "waves").random() for seed in range(2000)]
    assert stats.kstest(first, "uniform").pvalue > 1e-4  # level of the test


def plain(x: float, n: int) -> float:
    """Alternating series whose terms nearly cancel: any reordering or contraction would show."""
    total = 0.0
    for i in range(n):
        total += math.sin(x * i) / (i + 1.0) if i % 2 else -math.cos(x + i)
    return total


compiled = njit(plain)


@njit_parallel
def every(x, out):  # annotations would only be read by people; the arguments are arrays [(n,)]
    for i in numba.prange(x.size):
        out[i] = compiled(x[i], 100)


@pytest.mark.kernel
def test_kernel_compiled_equals_plain_python() -> None:
    # Libraries of sine and cosine may differ in the last bit.
    assert compiled(0.37, 1000) == pytest.approx(plain(0.37, 1000), rel=1e-13)


@pytest.mark.kernel
def test_threads_cannot_be_told_from_the_bytes() -> None:
    x = np.linspace(-3.0, 3.0, 257)
    results = []
    before = numba.get_num_threads()
    for threads in sorted({1, min(2, numba.config.NUMBA_NUM_THREADS)}):
        numba.set_num_threads(threads)
        out = np.empty_like(x)
        every(x, out)
        results.append(out.tobytes())
    numba.set_num_threads(before)
    assert len(set(results)) == 1
    assert np.frombuffer(results[0])[5] == pytest.approx(plain(x[5], 100), rel=1e-13)


@pytest.mark.kernel
def test_division_by_zero_in_a_kernel_is_ieee() -> None:
    inverse = njit(lambda x: x / x)
    if numba.config.DISABLE_JIT:
        pytest.skip("plain Python raises")
    assert math.isnan(inverse(0.0))


@pytest.mark.kernel
def test_the_quick_sine() -> None:
    cycles = np.linspace(-3.2, 3.2, 4001)
    assert [sine(c) for c in cycles] == pytest.approx(np.sin(2.0 * np.pi * cycles), abs=3e-7)
