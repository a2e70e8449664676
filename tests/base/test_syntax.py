"""What a source does has a digest that prose does not change."""

from __future__ import annotations

import pytest

from seaglint.base.kernel_cache import syntax_digest

SOURCE = b"""
import math

WIDTH = 2.0

class Row(NamedTuple):
    x: float

def area(r):
    return math.pi * r**2
"""

PROSE = b'''
"""What the module is."""

# Why it is there.
import math

WIDTH = 2.0
"""Unit: metres."""

class Row(NamedTuple):
    """A row."""

    x: float
    """Its place."""

def area(
    r,  # a radius
):
    """Return the area."""
    # of a circle
    return (math.pi
            * r**2)
'''


def test_prose_and_layout_do_not_change_it() -> None:
    assert syntax_digest(SOURCE) == syntax_digest(PROSE)


@pytest.mark.parametrize(
    ("old", "new"),
    [(b"2.0", b"2.5"), (b"x: float", b"y: float"), (b"math.pi * r", b"math.pi + r"), (b"import math", b"import cmath as math")],
)
def test_every_statement_changes_it(old: bytes, new: bytes) -> None:
    assert SOURCE.count(old) == 1
    assert syntax_digest(SOURCE) != syntax_digest(SOURCE.replace(old, new))
