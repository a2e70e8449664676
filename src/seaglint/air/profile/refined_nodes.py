"""Nodes of a spline, added where the values between them need them: spectra of rays that pass layers of any sounding.

Two splines, each through every other node, are compared with the nodes left out. Where they differ much, rays are added in the middle
between nodes until the spline was right there. Smooth air costs no ray more than the first nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from seaglint.base.conventions import FloatArray

LIMIT: Final = 0.01  #: Error between nodes from which on one more is added [K].

#: Error of a node left out, in parts of :data:`LIMIT`, from which on its neighbourhood is checked: a smooth spline is 16 times better with
#: twice the nodes, one over a corner at least twice.
DOUBTED: Final = 4.0

MOST_TIMES: Final = 4  #: Largest number of nodes, in parts of the first ones.

DEEPEST: Final = 5  #: Number of times that an interval between two of the first nodes may be halved.

Values = Callable[[FloatArray], FloatArray]
Errors = Callable[[FloatArray, FloatArray], FloatArray]


class RefinedNodes(NamedTuple):
    """Places [(n,)] and values [(n, ...)] of nodes, and the largest error between them that is left [K]."""

    place: FloatArray
    value: FloatArray
    left: float


def refined_nodes(place: FloatArray, values: Values, errors: Errors) -> RefinedNodes:
    """Add nodes until a spline through them is right in the middle between those that are in doubt.

    Parameters
    ----------
    place : ndarray
        First nodes, ascending [1, (n,)].
    values : callable
        Values at places [(m,)] (m, ...).
    errors : callable
        Errors of splined values (m, ...) against values (m, ...) [K, (m,)].

    Returns
    -------
    RefinedNodes
        Nodes, and the largest error [K] of the last ones added where there may be no more; 0 where all were right.
    """
    x, y = place, values(place)
    doubt, left = _doubtful(x, y, errors), 0.0
    for _ in range(DEEPEST):
        at = np.flatnonzero(doubt)
        if at.size == 0 or x.size + at.size > MOST_TIMES * place.size:
            break
        middle = 0.5 * (x[at] + x[at + 1])
        new = values(middle)
        error = errors(CubicSpline(x, y, axis=0)(middle), new)
        order = np.argsort(np.concatenate([x, middle]), kind="stable")
        wrong = np.concatenate([np.zeros(x.size, dtype=bool), error > LIMIT])[order]
        x, y = np.concatenate([x, middle])[order], np.concatenate([y, new])[order]
        # both halves, and their neighbours
        doubt = wrong[:-1] | wrong[1:]
        doubt[1:] |= wrong[:-2]
        doubt[:-1] |= wrong[2:]
        left = float(error.max()) if doubt.any() else 0.0
    return RefinedNodes(x, y, left)


def _doubtful(x: FloatArray, y: FloatArray, errors: Errors) -> NDArray[np.bool_]:
    """Intervals beside nodes that a spline through every other node misses [(n - 1,)]."""
    off = np.zeros(x.size)
    for first in (1, 2):
        out = np.arange(first, x.size - 1, 2)
        kept = np.setdiff1d(np.arange(x.size), out)
        off[out] = errors(CubicSpline(x[kept], y[kept], axis=0)(x[out]), y[out])
    bad = off > DOUBTED * LIMIT
    return np.asarray(bad[:-1] | bad[1:])
