"""Cubic B-splines on periodic lattices: rows of their coefficients, and weights of the 16 points around a place.

What stands at the lattice points are coefficients, not heights: :meth:`seaglint.sea.field.WaveField.coefficients` makes them.
"""

from __future__ import annotations

import math

import numpy as np

from seaglint.base.jit import kernel


@kernel
def lay_rows(lattice: np.ndarray, k: int, rows: np.ndarray) -> None:
    """Lay the numbers ``k`` of a periodic lattice (n, n, 1 or 2) out in rows of n + 3 points.

    With one more point before and two beyond along either axis the points around any cell lie at fixed distances from its address.
    """
    size = lattice.shape[0]
    for y in range(size + 3):
        source, at = (y - 1) & (size - 1), y * (size + 3)
        rows[at], rows[at + size + 1], rows[at + size + 2] = lattice[source, size - 1, k], lattice[source, 0, k], lattice[source, 1, k]
        for x in range(size):
            rows[at + 1 + x] = lattice[source, x, k]


@kernel
def spline_weights(f: np.float32) -> tuple[np.float32, np.float32, np.float32, np.float32]:
    """Weights of the four points around a place on a cubic B-spline, ``f`` cells beyond the second of them."""
    one, sixth = np.float32(1.0), np.float32(1.0 / 6.0)
    e = one - f
    first, last = e * e * e * sixth, f * f * f * sixth
    second = f * f * (np.float32(0.5) * f - one) + np.float32(2.0 / 3.0)
    return first, second, one - first - second - last, last


@kernel
def slope_weights(f: np.float32) -> tuple[np.float32, np.float32, np.float32, np.float32]:
    """Derivatives of the :func:`spline_weights` [1/cell]."""
    half = np.float32(0.5)
    e = np.float32(1.0) - f
    first, last = -half * e * e, half * f * f
    second = f * (np.float32(1.5) * f - np.float32(2.0))
    return first, second, -first - second - last, last


@kernel
def cell(size: int, u: float, v: float) -> tuple[int, np.float32, np.float32]:
    """Address of the cell of a lattice position, and the fractions (v, u) within it. The lattice ``size`` is a power of two."""
    lower_u, lower_v = math.floor(u), math.floor(v)
    return (int(lower_v) & (size - 1)) * (size + 3) + (int(lower_u) & (size - 1)), np.float32(v - lower_v), np.float32(u - lower_u)


@kernel
def spline_value(z: np.ndarray, at: np.uint64, row: np.uint64, f: np.float32, g: np.float32) -> np.float32:
    """Cubic B-spline ``f`` along u and ``g`` along v into a cell, whose first point of 16 is at ``at``, with ``row`` points a row."""
    a0, a1, a2, a3 = spline_weights(f)
    b0, b1, b2, b3 = spline_weights(g)
    one, two, three = np.uint64(1), np.uint64(2), np.uint64(3)
    total = b0 * (a0 * z[at] + a1 * z[at + one] + a2 * z[at + two] + a3 * z[at + three])
    at += row
    total += b1 * (a0 * z[at] + a1 * z[at + one] + a2 * z[at + two] + a3 * z[at + three])
    at += row
    total += b2 * (a0 * z[at] + a1 * z[at + one] + a2 * z[at + two] + a3 * z[at + three])
    at += row
    return np.float32(total + b3 * (a0 * z[at] + a1 * z[at + one] + a2 * z[at + two] + a3 * z[at + three]))


@kernel
def gradient(z: np.ndarray, at: np.uint64, row: np.uint64, f: np.float32, g: np.float32) -> tuple[np.float32, np.float32]:
    """Derivatives along u and v [m/cell] of a cubic B-spline; arguments as of :func:`spline_value`."""
    a0, a1, a2, a3 = spline_weights(f)
    c0, c1, c2, c3 = slope_weights(f)
    b0, b1, b2, b3 = spline_weights(g)
    d0, d1, d2, d3 = slope_weights(g)
    i, j, k, m = at, at + row, at + row + row, at + row + row + row
    z0, z1, z2, z3 = z[i], z[j], z[k], z[m]
    along, across = c0 * (b0 * z0 + b1 * z1 + b2 * z2 + b3 * z3), a0 * (d0 * z0 + d1 * z1 + d2 * z2 + d3 * z3)
    one = np.uint64(1)
    i, j, k, m = i + one, j + one, k + one, m + one
    z0, z1, z2, z3 = z[i], z[j], z[k], z[m]
    along, across = along + c1 * (b0 * z0 + b1 * z1 + b2 * z2 + b3 * z3), across + a1 * (d0 * z0 + d1 * z1 + d2 * z2 + d3 * z3)
    i, j, k, m = i + one, j + one, k + one, m + one
    z0, z1, z2, z3 = z[i], z[j], z[k], z[m]
    along, across = along + c2 * (b0 * z0 + b1 * z1 + b2 * z2 + b3 * z3), across + a2 * (d0 * z0 + d1 * z1 + d2 * z2 + d3 * z3)
    i, j, k, m = i + one, j + one, k + one, m + one
    z0, z1, z2, z3 = z[i], z[j], z[k], z[m]
    return along + c3 * (b0 * z0 + b1 * z1 + b2 * z2 + b3 * z3), across + a3 * (d0 * z0 + d1 * z1 + d2 * z2 + d3 * z3)
