r"""Importance sampling of rare events: a density on the unit cube that is constant in the leaves of a binary tree.

A chance is the mean over uniform numbers, :math:`P = \int h(u)\,du`, and equally the mean of :math:`h/q` over numbers with the density q.
The variance is least for :math:`q \propto |h|`; among densities that are constant in cells of the volume v it is least for

.. math:: q\,v \propto \sqrt{v \int_{cell} h^2\,du}

Cells are made by halving the unit cube again and again where that reduces the sum of these roots, and with it the variance, the most.

- Numbers are *warped* into the density: at every branch with the probability p of its lower side one coordinate is stretched, from
  (0, p) onto the lower side and from (p, 1) onto the upper one. Points that are even before are even within every cell afterwards.
- The integrals come from draws, in rounds (``refined``): those of a round are drawn from the density of the round before. A rare event is
  approached by events that are less rare, and every round leaves a share of its probability to the density before, so that what a round
  has overlooked is still drawn.
- A share of the probability remains uniform (``mixed``): no weight 1/q exceeds the inverse of this share.

References
----------
- A. Owen and Y. Zhou, Safe and effective importance sampling, J. Am. Stat. Assoc. 95 (2000) 135, Sec. 2: uniform share.
- R. Y. Rubinstein and D. P. Kroese, The Cross-Entropy Method (2004), Sec. 3.4: levels of a rare event.
- G. P. Lepage, A new algorithm for adaptive multidimensional integration, J. Comput. Phys. 27 (1978) 192: roots of second moments.
- S. Jadach, Foam, Comput. Phys. Commun. 152 (2003) 55, Sec. 2: cells of a binary tree.
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.jit import njit

_LEAVES: Final = 128  #: Largest number of leaves that a round adds.
_BINS: Final = 8  #: Parts of a side of a cell at whose borders it can be divided.
_FEW: Final = 5  #: Hits for each coordinate below which a cell is not divided: with more coordinates more gatherings are chance.
_PRIOR: Final = 16.0  #: Hits, spread evenly over a cell, that are added to those seen: chance gatherings are no structure.
_GAIN: Final = 2e-4  #: Least decrease of the sum of roots for which a cell is divided.
#: Share of the mean square that counts as known: the error of even points comes from what varies within a cell, as the border of an event.
_EVEN: Final = 0.8


class Warped(NamedTuple):
    """Numbers with the density of a tree."""

    points: FloatArray  #: Numbers in [0, 1) [(n, dimensions)].
    weight: FloatArray  #: Inverse of the density [1, (n,)]; 1 on average.
    leaf: NDArray[np.int64]  #: Index of the node they are in [(n,)].


@dataclass(frozen=True, eq=False)
class DensityTree:
    """Density on the unit cube, constant in the leaves of a tree; node 0 is the whole cube."""

    axis: NDArray[np.int64]  #: Coordinate along which a node is divided; -1 for a leaf.
    cut: FloatArray  #: Border between its two parts [1].
    lower: NDArray[np.int64]  #: Index of the part below the border; the part above it is the next one.
    mass: FloatArray  #: Probability of the node [1].
    volume: FloatArray  #: Volume of the node [1].

    @classmethod
    def even(cls) -> DensityTree:
        """Return the uniform density."""
        return cls(np.full(1, -1), np.zeros(1), np.full(1, -1), np.ones(1), np.ones(1))

    @property
    def largest_weight(self) -> float:
        """Largest ratio of the uniform density to this one [1]."""
        return float(np.max(self.volume / self.mass))

    def warp(self, points: FloatArray) -> Warped:
        """Give numbers in [0, 1) [(n, dimensions)] the density of the tree.

        >>> DensityTree.even().warp(np.array([[0.25, 0.75]])).points
        array([[0.25, 0.75]])
        """
        moved = np.array(points, dtype=np.float64, order="C")
        leaf = np.empty(moved.shape[0], dtype=np.int64)
        _warp(moved, self.axis, self.cut, self.lower, self.mass, leaf)
        return Warped(moved, self.volume[leaf] / self.mass[leaf], leaf)

    def mixed(self, even: float) -> DensityTree:
        """Mix the density with a share ``even`` of the uniform one."""
        return replace(self, mass=(1.0 - even) * self.mass + even * self.volume)

    def refined(self, drawn: Warped, values: FloatArray, before: float) -> DensityTree:
        """Divide leaves and set probabilities by the draws of a round.

        Parameters
        ----------
        drawn : Warped
            Numbers drawn from this density; where other numbers have a density too, with the weights of all.
        values : ndarray
            Integrand at each [(n,)], not below 0.
        before : float
            Share of the probability that remains distributed as before [1].
        """
        hit = np.flatnonzero(values > 0.0)
        if hit.size == 0:
            return self
        each = drawn.weight[hit] * values[hit] / values.size
        return _Growth(self, drawn.points[hit], drawn.leaf[hit], each, each * values[hit]).tree(before)


@njit
def _warp(
    points: FloatArray, axis: NDArray[np.int64], cut: FloatArray, lower: NDArray[np.int64], mass: FloatArray, leaf: NDArray[np.int64]
) -> None:
    low, high = np.empty(points.shape[1]), np.empty(points.shape[1])
    for n in range(points.shape[0]):
        point = points[n]
        low[:], high[:] = 0.0, 1.0
        node = 0
        while axis[node] >= 0:
            d = axis[node]
            part = mass[lower[node]] / mass[node]
            if point[d] < part:
                point[d] /= part
                high[d] = cut[node]
                node = lower[node]
            else:
                point[d] = (point[d] - part) / (1.0 - part)
                low[d] = cut[node]
                node = lower[node] + 1
        for d in range(point.size):
            point[d] = min(max(low[d] + (high[d] - low[d]) * point[d], 0.0), 1.0 - 2.0**-53)
        leaf[n] = node


class _Split(NamedTuple):
    gain: float  #: Decrease of the sum of roots.
    axis: int
    cut: float
    share: float  #: Share of the volume below the cut.
    firsts: tuple[float, float]  #: Integrals below and above.
    seconds: tuple[float, float]  #: Integrals of the square below and above.


def _roots(volume: FloatArray, first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the probability that suits cells, apart from a factor: root of volume times the integral of the square."""
    rest = second - _EVEN * first**2 / volume
    return np.asarray(np.sqrt(volume * np.maximum(rest, (1.0 - _EVEN) * second)))


class _Growth:
    """Tree that grows by the hits of a round."""

    def __init__(self, tree: DensityTree, points: FloatArray, leaf: NDArray[np.int64], values: FloatArray, squares: FloatArray) -> None:
        self.axis, self.cut, self.lower = tree.axis.tolist(), tree.cut.tolist(), tree.lower.tolist()
        self.mass, self.volume = tree.mass.tolist(), tree.volume.tolist()
        self.points, self.values, self.squares = points, values, squares
        self.first, self.second = (np.bincount(leaf, each, len(self.axis)).tolist() for each in (values, squares))
        order = np.argsort(leaf, kind="stable")
        nodes, starts = np.unique(leaf[order], return_index=True)
        self.hits = dict(zip(nodes.tolist(), np.split(order, starts[1:]), strict=True))
        self.box = self._boxes()

    def _boxes(self) -> list[FloatArray]:
        """Return lower and upper corner of every node [(2, dimensions)]."""
        boxes = [np.stack([np.zeros(self.points.shape[1]), np.ones(self.points.shape[1])])] * len(self.axis)
        for node, axis in enumerate(self.axis):
            if axis >= 0:
                boxes[self.lower[node]], boxes[self.lower[node] + 1] = self._halves(boxes[node], axis, self.cut[node])
        return boxes

    @staticmethod
    def _halves(box: FloatArray, axis: int, cut: float) -> tuple[FloatArray, FloatArray]:
        below, above = box.copy(), box.copy()
        below[1, axis] = above[0, axis] = cut
        return below, above

    def _split(self, node: int) -> _Split | None:
        """Return the best division of a leaf; None where it is not worth one."""
        inside = self.hits.get(node)
        if inside is None or inside.size < _FEW * self.points.shape[1]:
            return None
        low, high = self.box[node]
        at = np.minimum(((self.points[inside] - low) / (high - low) * _BINS).astype(np.int64), _BINS - 1)
        # Every coordinate has its own bins.
        bins = (at + _BINS * np.arange(low.size)).ravel()
        share = np.arange(1, _BINS) / _BINS
        volume = self.volume[node]
        below = []
        for each, whole in ((self.values[inside], self.first[node]), (self.squares[inside], self.second[node])):
            sums = np.bincount(bins, np.repeat(each, low.size), _BINS * low.size).reshape(low.size, _BINS)
            part = np.cumsum(sums, axis=1)[:, :-1] / each.sum()
            below.append(whole * (inside.size * part + _PRIOR * share) / (inside.size + _PRIOR))
        first, second = below
        root = float(_roots(np.array(volume), np.array(self.first[node]), np.array(self.second[node])))
        parts = _roots(volume * share, first, second) + _roots(volume * (1.0 - share), self.first[node] - first, self.second[node] - second)
        axis, k = divmod(int(np.argmin(parts)), _BINS - 1)
        cut = float(low[axis] + (high[axis] - low[axis]) * share[k])
        one, two = float(first[axis, k]), float(second[axis, k])
        return _Split(
            root - float(parts[axis, k]), axis, cut, float(share[k]), (one, self.first[node] - one), (two, self.second[node] - two)
        )

    def tree(self, before: float) -> DensityTree:
        """Return the tree with new leaves and probabilities."""
        heap: list[tuple[float, int, _Split]] = []

        def offer(node: int) -> None:
            split = self._split(node)
            if split is not None:
                heapq.heappush(heap, (-split.gain, node, split))

        leaves = [node for node, axis in enumerate(self.axis) if axis < 0]
        total = float(_roots(*(np.array(each)[leaves] for each in (self.volume, self.first, self.second))).sum())
        for node in leaves:
            offer(node)
        count = 0
        while heap and count < _LEAVES:
            _, node, split = heapq.heappop(heap)
            if split.gain < _GAIN * total:
                break
            total -= split.gain
            self._divide(node, split)
            offer(self.lower[node])
            offer(self.lower[node] + 1)
            count += 1
        mass, volume = np.array(self.mass), np.array(self.volume)
        axis, lower = np.array(self.axis), np.array(self.lower)
        fitted = np.where(axis < 0, _roots(volume, np.array(self.first), np.array(self.second)), 0.0)
        mass = before * mass + (1.0 - before) * fitted / fitted.sum()
        # Parts follow their node: from the last node back, both parts are complete.
        for node in np.flatnonzero(axis >= 0)[::-1]:
            mass[node] = mass[lower[node]] + mass[lower[node] + 1]
        return DensityTree(axis, np.array(self.cut), lower, mass, volume)

    def _divide(self, node: int, split: _Split) -> None:
        inside = self.hits.pop(node)
        below = self.points[inside, split.axis] < split.cut
        first = len(self.axis)
        self.axis[node], self.cut[node], self.lower[node] = split.axis, split.cut, first
        for k, share in enumerate((split.share, 1.0 - split.share)):
            self.axis.append(-1)
            self.cut.append(0.0)
            self.lower.append(-1)
            self.mass.append(share * self.mass[node])
            self.volume.append(share * self.volume[node])
            self.first.append(split.firsts[k])
            self.second.append(split.seconds[k])
            self.hits[first + k] = inside[below if k == 0 else ~below]
        self.box += self._halves(self.box[node], split.axis, split.cut)
