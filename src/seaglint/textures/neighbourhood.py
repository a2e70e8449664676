"""Neighbourhoods of a Markov random field: offsets by order, grouped into the classes that share a parameter."""

from __future__ import annotations

from typing import Final

from seaglint.base.errors import DomainError

# Rows down and columns to the right from a pixel to its neighbour.
Offset = tuple[int, int]

# Classes of symmetric pairs; each pair is named by the offset that points down, or to the right in its own row.
Classes = tuple[tuple[Offset, ...], ...]

#: Largest order; higher ones reach over nine pixels, an 8 x 8 block of couplings, more than textures of a few hundred pixels determine.
MOST_ORDER: Final = 40


def classes(order: int, isotropic: bool = True) -> Classes:
    """Neighbours up to the ``order``-th distance: 1 the four nearest, 2 with the diagonals, 3, 4, 5 to distances 2, √5, √8, and so on.

    Parameters
    ----------
    order : int
        Distances taken, from the shortest.
    isotropic : bool
        One class for each distance; else one for each symmetric pair of neighbours.

    Returns
    -------
    tuple of tuple of (int, int)
        Offsets of each class, one of each symmetric pair.

    Raises
    ------
    DomainError
        An order below 1 or above :data:`MOST_ORDER`.

    References
    ----------
    J. Besag, "Spatial interaction and the statistical analysis of lattice systems", J. R. Stat. Soc. B 36 (1974), Sec. 4.

    Examples
    --------
    >>> classes(2)
    (((0, 1), (1, 0)), ((1, -1), (1, 1)))
    >>> classes(1, isotropic=False)
    (((0, 1),), ((1, 0),))
    >>> [2 * sum(map(len, classes(order))) for order in (1, 2, 3, 4, 5)]
    [4, 8, 12, 20, 24]
    """
    if not 1 <= order <= MOST_ORDER:
        raise DomainError(
            f"order = {order}: allowed are 1 (the four nearest neighbours) to {MOST_ORDER}; 1 to 5 are usual",
            name="order",
            value=order,
            allowed=(1, MOST_ORDER),
        )
    far = order + 1  # the n-th distance is below n + 1
    half = [(dy, dx) for dy in range(far + 1) for dx in range(-far, far + 1) if (dy, dx) > (0, 0)]
    distances = sorted({dy * dy + dx * dx for dy, dx in half})[:order]
    rings = tuple(tuple(offset for offset in half if offset[0] ** 2 + offset[1] ** 2 == distance) for distance in distances)
    return rings if isotropic else tuple((offset,) for ring in rings for offset in ring)


def reach(neighbours: Classes) -> tuple[int, int]:
    """Rows and columns to the farthest neighbour."""
    offsets = [offset for one in neighbours for offset in one]
    return max(dy for dy, _ in offsets), max(abs(dx) for _, dx in offsets)


def colours(size: int, distance: int) -> list[list[int]]:
    """Positions 0 to ``size - 1`` on a ring, in groups whose members are more than ``distance`` apart.

    Examples
    --------
    >>> colours(5, 1)
    [[0, 2], [1, 3], [4]]
    """
    step = distance + 1
    even = size - size % step
    return [list(range(first, even, step)) for first in range(step)] + [[place] for place in range(even, size)]
