"""Computations in which numbers may not exist: a constant frame has no skewness, a detector may divide by 0."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def absent_numbers() -> Iterator[None]:
    """Leave out NumPy's warnings of numbers that do not exist: the result states what is absent and why."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        yield
