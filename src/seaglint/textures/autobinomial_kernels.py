"""Kernels of the autobinomial field: exact binomial deviates from random bits, sweeps, exchanges and sums over pairs.

Every random number is a function of (seed, sweep, pixel): bytes depend neither on threads nor on what was drawn before.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel, njit, njit_parallel
from seaglint.base.keyed_random import WORD, bits, cell_key, uniform

PRECISION = 56  #: Number of bits of a probability that are used: the 53 of a double, and a multiple of :data:`UNROLLED`.

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
    """Run :func:`gibbs` with the rows of a colour divided among threads: pixels of one colour are no neighbours."""
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
        if (down - dy) % rows == 0 and (right - dx) % columns == 0:
            return float(law.coupling[k])
        if (down + dy) % rows == 0 and (right + dx) % columns == 0:
            return float(law.coupling[k])
    return 0.0


@njit
def exchange(field: NDArray[np.int16], law: Law, plan: ColourPlan, seed: NDArray[np.int64], first: int, sweeps: int) -> int:
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
