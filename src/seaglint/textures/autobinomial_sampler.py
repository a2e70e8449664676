"""Samples of an autobinomial field: Gibbs sweeps in parallel colours, and Metropolis exchanges that preserve the histogram.

The kernels draw exact binomial deviates from random bits and sum over pairs. Every random number is a function of (seed, sweep, pixel):
bytes depend neither on threads nor on earlier draws. :func:`mixing` measures the convergence of Gibbs chains by energy traces, effective
sample size and R-hat (arviz-stats).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import kernel, njit, njit_parallel
from seaglint.base.keyed_random import WORD, bits, cell_key, uniform
from seaglint.base.optional import optional
from seaglint.base.random import stream
from seaglint.textures.autobinomial import Autobinomial, IntArray, check_shape, checked_field, colours

PRECISION = 56  #: Number of bits of a probability that are used: the 53 of a double, and a multiple of ``UNROLLED``.

UNROLLED = 4  #: Number of bits between two tests whether any trial is undecided: a quarter less time than a test after each.

TRIALS = 63  #: Number of trials drawn at once, a bit each of a 64-bit integer that stays positive.


class Law(NamedTuple):
    """Parameters of a pixel's conditional distribution: one half of the offsets, the coupling and class of each."""

    down: NDArray[np.int64]
    right: NDArray[np.int64]
    coupling: FloatArray
    alpha: float
    most: int
    group: NDArray[np.int64]


class ColourPlan(NamedTuple):
    """Pixels in the order of their colours, rows and columns apart, and the periodic indices of rows and columns beyond the edge.

    Pixels within ``margin`` rows and columns of the edge are held.
    """

    rows: NDArray[np.int64]
    row_starts: NDArray[np.int64]
    columns: NDArray[np.int64]
    column_starts: NDArray[np.int64]
    wrap_rows: NDArray[np.int64]
    wrap_columns: NDArray[np.int64]
    far: NDArray[np.int64]
    margin: NDArray[np.int64]


@kernel
def set_bits(x: int) -> int:
    """Number of bits that are set, of 32."""
    # Bits are counted in pairs, fours and bytes; the product adds the four bytes.
    x -= (x >> 1) & 0x55555555
    x = (x & 0x33333333) + ((x >> 2) & 0x33333333)
    x = (x + (x >> 4)) & 0x0F0F0F0F
    return (x * 0x01010101 & WORD) >> 24


@kernel
def binomial(probability: float, trials: int, key: tuple[int, int]) -> int:
    """Binomial deviate, exact to the last bit of the probability, from ``trials`` uniform numbers compared bit by bit at once.

    Each trial's number is drawn from its highest bit down until it differs from the probability's: some log2(trials) + 2 words of random
    bits, whatever the probability.
    """
    if probability >= 1.0:
        return trials
    # A trial succeeds where its uniform number, drawn bit by bit from the highest, is below the probability.
    whole = int(probability * 2.0**PRECISION)
    count, number = 0, 0
    while trials > 0:
        taken = min(trials, TRIALS)
        trials -= taken
        open_trials, won = 0x7FFFFFFFFFFFFFFF >> (TRIALS - taken), 0
        place = PRECISION
        while open_trials > 0 and place > 0:
            for _ in range(UNROLLED):
                place -= 1
                word = bits(key, number) | (bits(key, number + 1) & 0x7FFFFFFF) << 32
                number += 2
                digit = -((whole >> place) & 1)  # all bits set, or none
                won |= open_trials & ~word & digit
                open_trials &= ~(word ^ digit)
        count += set_bits(won & WORD) + set_bits(won >> 32)
    return count


@kernel
def neighbour_sum(field: NDArray[np.int16], law: Law, plan: ColourPlan, y: int, x: int) -> float:
    """Sum of the neighbours of a pixel, weighted with their couplings."""
    up, left = plan.far[0], plan.far[1]
    total = 0.0
    for k in range(law.coupling.shape[0]):
        dy, dx = law.down[k], law.right[k]
        after = field[plan.wrap_rows[y + dy + up], plan.wrap_columns[x + dx + left]]
        before = field[plan.wrap_rows[y - dy + up], plan.wrap_columns[x - dx + left]]
        total += law.coupling[k] * (int(after) + int(before))
    return float(total)


@njit
def draw_row(field: NDArray[np.int16], law: Law, plan: ColourPlan, seed: tuple[int, int], y: int, colour: int) -> None:
    """Draw the pixels of one colour in a row from their conditional distribution."""
    for j in range(plan.column_starts[colour], plan.column_starts[colour + 1]):
        x = int(plan.columns[j])
        logit = law.alpha + neighbour_sum(field, law, plan, y, x)
        field[y, x] = binomial(1.0 / (1.0 + math.exp(-logit)), law.most, cell_key(seed, y, x, 0))


@njit
def gibbs(field: NDArray[np.int16], law: Law, plan: ColourPlan, seed: NDArray[np.int64], first: int, sweeps: int) -> None:
    """Run Gibbs sweeps from number ``first`` on, colour by colour, in place."""
    for sweep in range(first, first + sweeps):
        now = cell_key((int(seed[0]), int(seed[1])), sweep, sweep, 1)
        for down in range(plan.row_starts.shape[0] - 1):
            for across in range(plan.column_starts.shape[0] - 1):
                for i in range(plan.row_starts[down], plan.row_starts[down + 1]):
                    draw_row(field, law, plan, now, int(plan.rows[i]), across)


@njit_parallel
def gibbs_in_threads(field: NDArray[np.int16], law: Law, plan: ColourPlan, seed: NDArray[np.int64], first: int, sweeps: int) -> None:
    """Run ``gibbs`` with the rows of a colour divided among threads: pixels of one colour are no neighbours."""
    for sweep in range(first, first + sweeps):
        first_word, second_word = cell_key((int(seed[0]), int(seed[1])), sweep, sweep, 1)
        for down in range(plan.row_starts.shape[0] - 1):
            for across in range(plan.column_starts.shape[0] - 1):
                for i in numba.prange(plan.row_starts[down], plan.row_starts[down + 1]):
                    draw_row(field, law, plan, (first_word, second_word), int(plan.rows[i]), across)


@kernel
def coupling_between(law: Law, shape: tuple[int, int], down: int, right: int) -> float:
    """Coupling of two pixels of a torus at a given distance; 0 where they are no neighbours."""
    rows, columns = shape
    for k in range(law.coupling.shape[0]):
        dy, dx = law.down[k], law.right[k]
        # Modulo the size: on a torus neighbours across the edges are coupled too.
        if (down - dy) % rows == 0 and (right - dx) % columns == 0:
            return float(law.coupling[k])
        if (down + dy) % rows == 0 and (right + dx) % columns == 0:
            return float(law.coupling[k])
    return 0.0


@njit
def exchange_kernel(field: NDArray[np.int16], law: Law, plan: ColourPlan, seed: NDArray[np.int64], first: int, sweeps: int) -> int:
    """Run Metropolis exchanges of random pairs of pixels, half as many in a sweep as there are pixels; return the number accepted."""
    rows, columns = field.shape
    pixels = rows * columns
    taken = 0
    for sweep in range(first, first + sweeps):
        now = cell_key((int(seed[0]), int(seed[1])), sweep, sweep, 2)
        for proposal in range(pixels // 2):
            key = cell_key(now, proposal, proposal, 0)
            one, other = int(uniform(key, 0) * pixels), int(uniform(key, 1) * pixels)
            y, x, v, u = one // columns, one % columns, other // columns, other % columns
            step = int(field[v, u]) - int(field[y, x])
            if step == 0:
                continue
            gain = step * (neighbour_sum(field, law, plan, y, x) - neighbour_sum(field, law, plan, v, u))
            # Where the two are neighbours, each is in the other's sum, and the exchange does not change their product.
            gain -= step * step * coupling_between(law, (rows, columns), v - y, u - x)
            if gain >= 0.0 or uniform(key, 2) < math.exp(gain):
                field[y, x] += step
                field[v, u] -= step
                taken += 1
    return taken


@njit
def pair_sums(field: NDArray[np.int16], law: Law, plan: ColourPlan, sums: FloatArray) -> None:
    """Add to ``sums`` the levels of all drawn pixels, and for each class the products of all pairs with one of them."""
    rows, columns = field.shape
    up, left, high, wide = plan.far[0], plan.far[1], plan.margin[0], plan.margin[1]
    for y in range(high, rows - high):
        for x in range(wide, columns - wide):
            here = int(field[y, x])
            sums[0] += here
            for k in range(law.coupling.shape[0]):
                dy, dx = law.down[k], law.right[k]
                total = int(field[plan.wrap_rows[y + dy + up], plan.wrap_columns[x + dx + left]])
                # The opposite pair is counted from its other end, unless that pixel is fixed.
                if high + wide > 0 and (y - dy < high or not wide <= x - dx < columns - wide):
                    total += int(field[y - dy, x - dx])
                sums[1 + law.group[k]] += here * total


#: Number of pixels from which a sweep runs in threads; for fewer, starting them takes longer than the work.
IN_THREADS_FROM: Final = 64 * 64

CUT_MARGIN: Final = 16  #: Margin on each side from which a sample without periods is cut, in reaches of the neighbourhood.


def sampling_law(model: Autobinomial) -> Law:
    """Parameters of the model as kernels read them."""
    flat = [(dy, dx, beta, k) for k, (one, beta) in enumerate(zip(model.neighbours, model.beta, strict=True)) for dy, dx in one]
    down, right, coupling, group = (np.array(column) for column in zip(*flat, strict=True))
    return Law(
        down.astype(np.int64), right.astype(np.int64), coupling.astype(np.float64), float(model.alpha), model.most, group.astype(np.int64)
    )


def plan(model: Autobinomial, shape: tuple[int, int], *, held_border: bool = False) -> ColourPlan:
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
    return ColourPlan(orders[0], starts[0], orders[1], starts[1], wraps[0], wraps[1], np.array(far), np.array(margin))


def words(seed: int, purpose: str) -> NDArray[np.int64]:
    """Two words of 32 bits that key the random numbers of kernels."""
    return stream(seed, purpose).integers(0, WORD, size=2, endpoint=True)


def sweep(field: NDArray[np.int16], law: Law, lattice: ColourPlan, key: NDArray[np.int64], first: int, sweeps: int) -> None:
    """Run Gibbs sweeps in place, in threads for large pictures; the bytes are the same either way."""
    (gibbs_in_threads if field.size >= IN_THREADS_FROM else gibbs)(field, law, lattice, key, first, sweeps)


def sums_of(field: NDArray[np.int16], law: Law, lattice: ColourPlan) -> FloatArray:
    """Return the sufficient statistics: sum of levels, and of the products of each class of pairs [level, level²]."""
    result = np.zeros(2 + int(law.group.max()))
    pair_sums(field, law, lattice, result)
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
    """Sample a picture by Gibbs sweeps: every pixel from its conditional distribution, colour by colour.

    ``x(s)`` is binomial of ``levels - 1`` trials with the chance ``1 / (1 + exp(-alpha - sum_k beta_k n_k(s)))``, n_k the sum of the
    neighbours of class k (Cross and Jain 1983).

    Parameters
    ----------
    model : Autobinomial
        The field.
    shape : (int, int)
        Rows and columns.
    sweeps : int
        Sweeps over all pixels; :func:`seaglint.textures.autobinomial_sampler.mixing` tests whether they suffice.
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
        # The margin, which is cut off in the end, begins as the mirror image of the start.
        field = np.ascontiguousarray(np.pad(field, ((down, down), (across, across)), mode="symmetric"))
    sweep(field, sampling_law(model), plan(model, whole), words(seed, "autobinomial-gibbs"), 0, sweeps)
    return np.ascontiguousarray(field[down : whole[0] - down, across : whole[1] - across])


def exchange(image: IntArray, model: Autobinomial, sweeps: int, seed: int) -> NDArray[np.int16]:
    """Sample a picture with exactly the histogram of ``image``, by Metropolis exchanges of pairs of pixels.

    The sample cannot freeze into a constant or lose its contrast, whatever the couplings, and therefore suits a fit in the frozen or molten
    regime.

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
    >>> np.array_equal(np.bincount(mixed.ravel()), np.bincount(first.ravel()))
    True
    >>> np.array_equal(mixed, first)
    False
    """
    if sweeps < 0:
        raise DomainError(f"sweeps = {sweeps}: allowed are 0 or more", name="sweeps", value=sweeps)
    field = checked_field(image, model)
    exchange_kernel(field, sampling_law(model), plan(model, field.shape), words(seed, "autobinomial-exchange"), 0, sweeps)
    return field


LARGEST_RHAT: Final = 1.01  #: R-hat below which chains count as mixed (Vehtari et al. 2021).


@dataclass(frozen=True)
class Mixing:
    """Traces of several chains, and their convergence diagnostics."""

    energy: FloatArray  #: Minus the exponent of the joint density, per pixel and without the count of choices [nat, (chains, draws)].
    sums: FloatArray  #: Mean level, and mean product with each class of neighbours, per pair [level, level²; (chains, draws, 1 + classes)].
    rhat: FloatArray  #: Rank-normalised split R-hat of the energy and of each sum [1, (2 + classes,)].
    effective: FloatArray  #: Effective sample sizes (bulk) of the same, all chains [1, (2 + classes,)].

    @property
    def mixed(self) -> bool:
        """True if every R-hat is below ``LARGEST_RHAT``."""
        return bool((self.rhat < LARGEST_RHAT).all())


def mixing(model: Autobinomial, shape: tuple[int, int], seed: int, *, chains: int = 4, warm: int = 200, draws: int = 400) -> Mixing:
    """Run chains from distant starts (levels even over the range from low to high) and evaluate their convergence.

    Parameters
    ----------
    model : Autobinomial
        The field.
    shape : (int, int)
        Rows and columns, on a torus.
    seed : int
        Seed of the chains; each has its own stream.
    chains, warm, draws : int
        Chains, sweeps left out of each, and sweeps of which each is a draw.

    Returns
    -------
    Mixing
        Effective sample size, R-hat and traces of the chains.

    References
    ----------
    A. Vehtari et al., "Rank-normalization, folding, and localization: an improved R-hat", Bayesian Analysis 16 (2021), 667-718.
    """
    statistics = optional("arviz_stats.base.array", "the judgement of chains").array_stats

    if chains < 2 or draws < 8:
        raise DomainError(f"chains = {chains}, draws = {draws}: R-hat compares 2 chains or more of 8 draws or more")
    law, lattice = sampling_law(model), plan(model, shape)
    traces = np.empty((chains, draws, 1 + len(model.beta)))
    for chain in range(chains):
        # Chains begin between the lowest and the highest level: those that stay apart show several phases.
        field = np.full(shape, round(model.most * chain / (chains - 1)), dtype=np.int16)
        key = words(seed, f"autobinomial-chain-{chain}")
        sweep(field, law, lattice, key, 0, warm)
        for draw in range(draws):
            sweep(field, law, lattice, key, warm + draw, 1)
            traces[chain, draw] = sums_of(field, law, lattice)
    energy = -(traces @ model.parameters) / (shape[0] * shape[1])
    pairs = np.array([1, *map(len, model.neighbours)]) * (shape[0] * shape[1])
    watched = np.concatenate([energy[..., None], traces], axis=-1)
    columns = [np.ascontiguousarray(watched[..., k]) for k in range(watched.shape[-1])]
    rhat = np.array([statistics.rhat(column, chain_axis=0, draw_axis=1) for column in columns], dtype=np.float64)
    effective = np.array([statistics.ess(column, chain_axis=0, draw_axis=1) for column in columns], dtype=np.float64)
    return Mixing(energy, traces / pairs, rhat, effective)
