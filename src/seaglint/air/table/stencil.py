"""Splines as weighted sums over node values, for many points at once.

A not-a-knot spline in wind and height is a sum over the nodes between two kinks; along the path two values and two slopes suffice.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.sparse import csr_array

from seaglint.base.conventions import FloatArray


@dataclass(frozen=True, eq=False)
class Stencil:
    """Indices and weights of the node values in a spline at each case; short rows are padded with weight 0."""

    index: NDArray[np.intp]  #: Nodes [(cases, m)].
    weight: FloatArray  #: Weights [1, (cases, m)].
    size: int  #: Number of nodes.

    @classmethod
    def between_kinks(cls, nodes: FloatArray, kinks: tuple[float, ...], x: FloatArray) -> Stencil:
        """Stencil of a cubic spline whose slope may jump at kinks, which are nodes.

        Between two kinks it is not-a-knot (three nodes: a parabola, two: a line).
        """
        edges = np.array(sorted({float(nodes[0]), *kinks, float(nodes[-1])}))
        part = np.clip(np.searchsorted(edges, x, side="right"), 1, edges.size - 1)
        inside = [np.flatnonzero((nodes >= edges[j - 1]) & (nodes <= edges[j])) for j in range(1, edges.size)]
        widest = max(piece.size for piece in inside)
        index, weight = np.zeros((x.size, widest), dtype=np.intp), np.zeros((x.size, widest))
        for j, piece in enumerate(inside, start=1):
            cases = np.flatnonzero(part == j)
            if cases.size:
                index[cases, : piece.size] = piece
                weight[cases, : piece.size] = CubicSpline(nodes[piece], np.eye(piece.size))(x[cases])
        return cls(index, weight, nodes.size)

    @classmethod
    def hermite(cls, nodes: FloatArray, x: FloatArray) -> Stencil:
        """Stencil of the cubic through values and slopes at the two nodes around ``x``, the end's tangent beyond the last one.

        Node values are followed by node slopes, as :func:`with_slopes` stacks them.
        """
        n = nodes.size
        left = np.clip(np.searchsorted(nodes, x, side="right") - 1, 0, n - 2)
        step = nodes[left + 1] - nodes[left]
        t = np.minimum((x - nodes[left]) / step, 1.0)
        beyond = np.maximum(x - nodes[-1], 0.0)
        weight = (
            (1.0 + 2.0 * t) * (1.0 - t) ** 2,
            t * t * (3.0 - 2.0 * t),
            step * t * (1.0 - t) ** 2,
            step * t * t * (t - 1.0) + beyond,
        )
        return cls(np.stack([left, left + 1, left + n, left + 1 + n], axis=1), np.stack(weight, axis=1), 2 * n)

    def times(self, other: Stencil) -> Stencil:
        """Stencil of the product of two directions, the other one running fastest."""
        index = self.index[:, :, None] * other.size + other.index[:, None, :]
        weight = self.weight[:, :, None] * other.weight[:, None, :]
        return Stencil(index.reshape(index.shape[0], -1), weight.reshape(index.shape[0], -1), self.size * other.size)

    def of(self, values: FloatArray) -> FloatArray:
        """Weighted sums (cases, ...) over node values [(size, ...)]."""
        cases, width = self.index.shape
        matrix = csr_array((self.weight.ravel(), self.index.ravel(), np.arange(0, cases * width + 1, width)), shape=(cases, self.size))
        return np.asarray(matrix @ values.reshape(self.size, -1)).reshape(cases, *values.shape[1:])


def with_slopes(nodes: FloatArray, values: FloatArray) -> FloatArray:
    """Node values [(..., nodes, k)] followed by the slopes of their cubic spline: (..., 2 nodes, k)."""
    slope = np.asarray(CubicSpline(nodes, np.eye(nodes.size))(nodes, 1))
    return np.concatenate([values, slope @ values], axis=-2)
