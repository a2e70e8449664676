"""Autobinomial Markov random field and its neighbourhoods: every pixel is binomial given its neighbours (Cross and Jain 1983).

Neighbourhoods are offsets by order, grouped into the classes that share a parameter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject

# Rows down and columns to the right from a pixel to its neighbour.
Offset = tuple[int, int]

# Classes of symmetric pairs; each pair is named by the offset that points down, or to the right in its own row.
Classes = tuple[tuple[Offset, ...], ...]

#: Largest order; higher ones reach over nine pixels, an 8 x 8 block of couplings, more than textures of a few hundred pixels determine.
MOST_ORDER: Final = 40


def classes(order: int, isotropic: bool = True) -> Classes:
    """Return the neighbours up to the ``order``-th distance.

    Order 1 has the four nearest, 2 also the diagonals, 3, 4, 5 all to distances 2, √5, √8, and so on.

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
        An order below 1 or above ``MOST_ORDER``.

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
        message = f"order = {order}: allowed are 1 (the four nearest neighbours) to {MOST_ORDER}; 1 to 5 are usual"
        raise DomainError(message, name="order", value=order, allowed=(1, MOST_ORDER))
    far = order + 1  # the n-th distance is below n + 1
    half = [(dy, dx) for dy in range(far + 1) for dx in range(-far, far + 1) if (dy, dx) > (0, 0)]
    distances = sorted({dy * dy + dx * dx for dy, dx in half})[:order]
    rings = tuple(tuple(offset for offset in half if offset[0] ** 2 + offset[1] ** 2 == distance) for distance in distances)
    return rings if isotropic else tuple((offset,) for ring in rings for offset in ring)


def reach(neighbours: Classes) -> tuple[int, int]:
    """Rows and columns to the farthest neighbour."""
    offsets = [offset for one in neighbours for offset in one]
    return max(dy for dy, _ in offsets), max(abs(dx) for _, dx in offsets)


def pairs_inside(field: NDArray[Any], offset: Offset) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return both pixels of all pairs of an offset inside a picture, views of shape (rows, columns, ...)."""
    dy, dx = offset
    left, right = max(-dx, 0), max(dx, 0)
    rows, columns = field.shape[:2]
    return field[: rows - dy, left : columns - right], field[dy:, right : columns - left]


def colours(size: int, distance: int) -> list[list[int]]:
    """Divide the positions 0 to ``size - 1`` on a ring into groups with members more than ``distance`` apart.

    Examples
    --------
    >>> colours(5, 1)
    [[0, 2], [1, 3], [4]]
    """
    # The rest of an uneven division would be too near to the first members: each position of it is a separate group.
    step = distance + 1
    even = size - size % step
    return [list(range(first, even, step)) for first in range(step)] + [[place] for place in range(even, size)]


IntArray = NDArray[np.integer[Any]]

KIND: Final = "autobinomial"

MOST_LEVELS: Final = 1024  #: Number of grey levels beyond which a binomial is a Gaussian and the Gauss-Markov field is the better model.


@dataclass(frozen=True)
class Autobinomial:
    """Autobinomial field, ``x_s | neighbours ~ Binomial(levels - 1, logistic(alpha + sum_k beta_k sum_d (x_{s+d} + x_{s-d})))``.

    The joint density is ``exp(sum_s [alpha x_s + log C(levels - 1, x_s)] + sum_k beta_k sum_pairs x_s x_t) / Z``.

    Raises
    ------
    DomainError
        Levels outside 2 to ``MOST_LEVELS``, couplings that do not match the classes, numbers that are not finite, pairs named twice.

    References
    ----------
    G. R. Cross and A. K. Jain, "Markov random field texture models", IEEE Trans. PAMI 5 (1983), 25-39.

    Examples
    --------
    >>> Autobinomial(4, (((0, 1),), ((1, 0),)), alpha=-1.0, beta=(0.3, 0.1)).reach
    (1, 1)
    """

    levels: int  #: Grey levels: pixels are 0 to ``levels - 1``.
    #: Offsets of each class of pairs, rows down and columns right, one of each symmetric pair
    #: (:func:`seaglint.textures.autobinomial.classes`).
    neighbours: Classes
    alpha: float  #: Logit of a pixel among neighbours that are all 0 [1].
    beta: tuple[float, ...]  #: Coupling of each class [1 per level].

    def __post_init__(self) -> None:
        check_levels(self.levels)
        offsets = [offset for one in self.neighbours for offset in one]
        if not offsets or any(not one for one in self.neighbours) or any(offset <= (0, 0) for offset in offsets):
            raise DomainError("neighbours: each class is a list of offsets (rows down, columns right) that point down, or right in row 0")
        if len(set(offsets)) < len(offsets):
            raise DomainError("neighbours: an offset is named twice; name each symmetric pair once, pointing down or right")
        if len(self.beta) != len(self.neighbours):
            raise DomainError(f"beta has {len(self.beta)} couplings for {len(self.neighbours)} classes of neighbours: give one for each")
        if not all(map(math.isfinite, (self.alpha, *self.beta))):
            raise DomainError(f"alpha = {self.alpha}, beta = {self.beta}: finite numbers only", name="beta", value=self.beta)

    @classmethod
    def of(cls, levels: int, order: int, alpha: float, beta: tuple[float, ...], *, isotropic: bool = True) -> Autobinomial:
        """Field of a neighbourhood's order; one coupling for each distance, or for each symmetric pair."""
        return cls(levels, classes(order, isotropic), alpha, beta)

    @property
    def most(self) -> int:
        """Largest grey level."""
        return self.levels - 1

    @property
    def reach(self) -> tuple[int, int]:
        """Rows and columns to the farthest neighbour."""
        return reach(self.neighbours)

    @property
    def parameters(self) -> FloatArray:
        """Alpha and the couplings, in this order [1]."""
        return np.array([self.alpha, *self.beta])

    def with_parameters(self, parameters: FloatArray) -> Autobinomial:
        """Return the field with other alpha and couplings."""
        return Autobinomial(self.levels, self.neighbours, float(parameters[0]), tuple(map(float, parameters[1:])))

    def to_dict(self) -> JsonObject:
        """Return the field as values for JSON."""
        return {
            "kind": KIND,
            "levels": self.levels,
            "neighbours": [[list(offset) for offset in one] for one in self.neighbours],
            "alpha": self.alpha,
            "beta": list(self.beta),
        }

    @classmethod
    def from_dict(cls, values: JsonObject) -> Autobinomial:
        """Read the output of :meth:`to_dict`.

        Raises
        ------
        DataError
            Another kind of model, a key that is missing or of the wrong type.
        """
        if values.get("kind") != KIND:
            raise DataError(f"kind = {values.get('kind')!r}: not an autobinomial field; fit one with model = 'autobinomial'")
        try:
            neighbours = tuple(tuple((int(dy), int(dx)) for dy, dx in one) for one in values["neighbours"])
            return cls(int(values["levels"]), neighbours, float(values["alpha"]), tuple(map(float, values["beta"])))
        except (KeyError, TypeError, ValueError) as error:
            if isinstance(error, DomainError):
                raise
            raise DataError(f"not a whole autobinomial field ({error!r}): keys are levels, neighbours, alpha, beta; fit it anew") from error


def check_levels(levels: int) -> None:
    """Refuse numbers of grey levels outside the allowed range."""
    if not 2 <= levels <= MOST_LEVELS:
        message = f"levels = {levels}: allowed are 2 to {MOST_LEVELS} grey levels; quantise the picture first"
        raise DomainError(message, name="levels", value=levels, allowed=(2, MOST_LEVELS))


def check_shape(shape: tuple[int, int], model: Autobinomial) -> None:
    """Refuse pictures in which a pixel would have the same neighbour twice."""
    rows, columns = (2 * far + 1 for far in model.reach)
    if len(shape) != 2 or shape[0] < rows or shape[1] < columns:
        message = (
            f"shape = {' x '.join(map(str, shape))} pixels: neighbours reach {model.reach[0]} rows and {model.reach[1]} columns, "
            f"so the field needs {rows} x {columns} pixels or more; take a larger picture or a lower order"
        )
        raise DomainError(message, name="shape", value=shape, allowed=f"{rows} x {columns} or more")


def checked_field(field: IntArray, model: Autobinomial) -> NDArray[np.int16]:
    """Return a copy of a picture of grey levels in the form of the kernels.

    Raises
    ------
    DomainError
        Not whole numbers, a level outside the model's, or a picture too small for its neighbours.
    """
    picture = np.asarray(field)
    if picture.dtype.kind == "f" and not np.isfinite(picture).all():
        raise DomainError(
            f"{int((~np.isfinite(picture)).sum())} of {picture.size} pixels are NaN or infinite: "
            "choose a region without them, or fill them",
            name="image",
        )
    if picture.dtype.kind not in "iub":
        raise DomainError(
            f"grey levels are whole numbers 0 to {model.most}, not {picture.dtype}: "
            "quantise the picture (seaglint.textures.autobinomial_texture)",
            name="image",
            value=str(picture.dtype),
        )
    check_shape(picture.shape, model)
    low, high = int(picture.min()), int(picture.max())
    if low < 0 or high > model.most:
        message = (
            f"grey levels {low} to {high}: the field has 0 to {model.most}; quantise the picture to {model.levels} levels or fit with more"
        )
        raise DomainError(message, name="image", value=(low, high), allowed=(0, model.most))
    return np.array(picture, dtype=np.int16, order="C")
