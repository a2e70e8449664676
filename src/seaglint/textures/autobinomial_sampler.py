"""Samples of an autobinomial field: Gibbs sweeps in parallel colours, and Metropolis exchanges that keep the histogram."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.keyed_random import WORD
from seaglint.base.random import stream
from seaglint.textures import autobinomial_kernels as kernels
from seaglint.textures.autobinomial import Autobinomial, IntArray, check_shape, checked_field
from seaglint.textures.neighbourhood import colours

#: Number of pixels from which a sweep runs in threads; for fewer, starting them takes longer than the work.
IN_THREADS_FROM: Final = 64 * 64

CUT_MARGIN: Final = 16  #: Margin on each side from which a sample without periods is cut, in reaches of the neighbourhood.


def law(model: Autobinomial) -> kernels.Law:
    """Parameters of the model as kernels read them."""
    flat = [(dy, dx, beta, k) for k, (one, beta) in enumerate(zip(model.neighbours, model.beta, strict=True)) for dy, dx in one]
    down, right, coupling, group = (np.array(column) for column in zip(*flat, strict=True))
    return kernels.Law(
        down.astype(np.int64), right.astype(np.int64), coupling.astype(np.float64), float(model.alpha), model.most, group.astype(np.int64)
    )


def plan(model: Autobinomial, shape: tuple[int, int], *, held_border: bool = False) -> kernels.ColourPlan:
    """Colours of a lattice; with ``held_border`` the pixels without all their neighbours in the picture stay unchanged."""
    check_shape(shape, model)
    far = model.reach
    margin = far if held_border else (0, 0)
    orders, starts, wraps = [], [], []
    for size, distance, held in zip(shape, far, margin, strict=True):
        groups = [[held + place for place in group] for group in colours(size - 2 * held, distance)]
        orders.append(np.array([place for group in groups for place in group], dtype=np.int64))
        starts.append(np.cumsum([0, *map(len, groups)], dtype=np.int64))
        wraps.append(np.arange(-distance, size + distance, dtype=np.int64) % size)
    return kernels.ColourPlan(orders[0], starts[0], orders[1], starts[1], wraps[0], wraps[1], np.array(far), np.array(margin))


def words(seed: int, purpose: str) -> NDArray[np.int64]:
    """Two words of 32 bits that key the random numbers of kernels."""
    return stream(seed, purpose).integers(0, WORD, size=2, endpoint=True)


def sweep(
    field: NDArray[np.int16], held: kernels.Law, lattice: kernels.ColourPlan, key: NDArray[np.int64], first: int, sweeps: int
) -> None:
    """Run Gibbs sweeps in place, in threads for large pictures; the bytes are the same either way."""
    run = kernels.gibbs_in_threads if field.size >= IN_THREADS_FROM else kernels.gibbs
    run(field, held, lattice, key, first, sweeps)


def sums(field: NDArray[np.int16], held: kernels.Law, lattice: kernels.ColourPlan) -> FloatArray:
    """Sufficient statistics: sum of levels, and of the products of each class of pairs [level, level²]."""
    result = np.zeros(2 + int(held.group.max()))
    kernels.pair_sums(field, held, lattice, result)
    return result


def independent(model: Autobinomial, shape: tuple[int, int], seed: int) -> NDArray[np.int16]:
    """Initial picture of a chain: pixels binomial without coupling, with the mean of the model's mean field."""
    return stream(seed, "autobinomial-start").binomial(model.most, mean_field_share(model), size=shape).astype(np.int16)


def mean_field_share(model: Autobinomial) -> float:
    """Mean level over the largest in the mean field, where every neighbour has the mean [1]; iterated from 1/2 in small steps."""
    pull = 2.0 * model.most * sum(beta * len(one) for one, beta in zip(model.neighbours, model.beta, strict=True))
    share = 0.5
    for _ in range(200):
        share += 0.2 * (1.0 / (1.0 + math.exp(min(-(model.alpha + pull * share), 700.0))) - share)
    return share


def sample(
    model: Autobinomial, shape: tuple[int, int], sweeps: int, seed: int, *, periodic: bool = True, start: IntArray | None = None
) -> NDArray[np.int16]:
    """Sample of a picture by Gibbs sweeps: every pixel from its conditional distribution, colour by colour.

    Parameters
    ----------
    model : Autobinomial
        The field.
    shape : (int, int)
        Rows and columns.
    sweeps : int
        Sweeps over all pixels; :func:`seaglint.textures.mixing.mixing` says whether they are enough.
    seed : int
        Same seed, same bytes, whatever the threads.
    periodic : bool
        Whether opposite edges are neighbours. Otherwise the picture is cut out of a larger torus.
    start : array of int, (rows, columns), optional
        First picture; independent binomial pixels by default.

    Returns
    -------
    array of int16, (rows, columns)
        Grey levels.

    Raises
    ------
    DomainError
        A picture too small for the neighbours, a start that does not fit, a negative number of sweeps.

    Examples
    --------
    >>> field = sample(Autobinomial.of(4, 1, -0.9, (0.15,)), (16, 16), sweeps=20, seed=1)
    >>> field.shape, int(field.max()) <= 3
    ((16, 16), True)
    """
    if sweeps < 0:
        raise DomainError(f"sweeps = {sweeps}: allowed are 0 or more", name="sweeps", value=sweeps)
    check_shape(shape, model)
    down, across = (0, 0) if periodic else (CUT_MARGIN * far for far in model.reach)
    whole = (shape[0] + 2 * down, shape[1] + 2 * across)
    if start is None:
        field = independent(model, whole, seed)
    else:
        field = checked_field(start, model)
        if field.shape != tuple(shape):
            raise DomainError(
                f"start has {field.shape[0]} x {field.shape[1]} pixels, shape asks for {shape[0]} x {shape[1]}: give a start of that shape"
            )
        field = np.ascontiguousarray(np.pad(field, ((down, down), (across, across)), mode="symmetric"))
    sweep(field, law(model), plan(model, whole), words(seed, "autobinomial-gibbs"), 0, sweeps)
    return np.ascontiguousarray(field[down : whole[0] - down, across : whole[1] - across])


def exchange(image: IntArray, model: Autobinomial, sweeps: int, seed: int) -> NDArray[np.int16]:
    """Sample of a picture with exactly the histogram of ``image``, by Metropolis exchanges of pairs of pixels.

    Cannot freeze into a constant or lose its contrast, whatever the couplings: the way out of a fit in the frozen or molten regime.

    Parameters
    ----------
    image : array of int, (rows, columns)
        First picture, on a torus; the histogram is its.
    model : Autobinomial
        The field; its alpha plays no part.
    sweeps : int
        Sweeps of half as many proposals as there are pixels.
    seed : int
        Same seed, same bytes.

    Returns
    -------
    array of int16, (rows, columns)
        Grey levels.

    References
    ----------
    Cross and Jain 1983, Sec. III (exchange algorithm); N. Metropolis et al., J. Chem. Phys. 21 (1953), 1087.

    Examples
    --------
    >>> first = np.arange(64).reshape(8, 8) % 4
    >>> mixed = exchange(first, Autobinomial.of(4, 1, 0.0, (0.5,)), sweeps=5, seed=1)
    >>> np.array_equal(np.bincount(mixed.ravel()), np.bincount(first.ravel())), np.array_equal(mixed, first)
    (True, False)
    """
    if sweeps < 0:
        raise DomainError(f"sweeps = {sweeps}: allowed are 0 or more", name="sweeps", value=sweeps)
    field = checked_field(image, model)
    kernels.exchange(field, law(model), plan(model, field.shape), words(seed, "autobinomial-exchange"), 0, sweeps)
    return field
