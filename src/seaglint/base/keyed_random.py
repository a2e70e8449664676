"""Random numbers of kernels: functions of a key, without the state of a generator.

Integers stay below 32 bits between steps, so that compiled kernels (with products that wrap at 64 bits), plain Python (without wrapping)
and a GPU have equal results. The mixing is a multiply-and-shift of 32 bits with a measured bias below 0.2 bits per thousand (constants of
C. Wellons' search, "lowbias32"); a key has two such words.
"""

from __future__ import annotations

import math

from seaglint.base.jit import kernel

WORD = 0xFFFFFFFF  #: Mask of 32 bits.

SLOTS = 32  #: Number of instants of a process whose events are drawn at once, one per bit.

#: Spacing of these instants in mean intervals: each has an event with the probability 1/8, as three random bits are all set.
SPACING = -math.log1p(-1.0 / 8.0)

LOOK_BACK = 16  #: Number of slots that are searched for an event; the probability of no event is 1e-29.

BOOST_BELOW = 4.0  #: Gamma shape below which deviates are drawn one higher and scaled by ``U^(1/shape)``, which is exact.


@kernel
def mixed(x: int) -> int:
    """Return a hash of any integer to 32 bits, each of which depends on all bits of the integer."""
    x &= WORD
    x ^= x >> 16
    x = (x * 0x7FEB352D) & WORD
    x ^= x >> 15
    x = (x * 0x846CA68B) & WORD
    return x ^ (x >> 16)


@kernel
def cell_key(seed: tuple[int, int], i: int, j: int, lattice: int) -> tuple[int, int]:
    """Return the key of the cell (i, j) of a lattice."""
    return mixed(seed[0] + i * 0x9E3779B1 + lattice * 0x85EBCA77), mixed(seed[1] + j * 0xC2B2AE3D + lattice * 0x27D4EB2F)


@kernel
def bits(key: tuple[int, int], number: int) -> int:
    """Return random word ``number`` of 32 bits of a key: the number is added to its first word; the second enters between the products."""
    x = (key[0] + number * 0x9E3779B1) & WORD
    x ^= x >> 16
    x = (x * 0x7FEB352D & WORD) ^ key[1]
    x ^= x >> 15
    x = x * 0x846CA68B & WORD
    return x ^ (x >> 16)


@kernel
def uniform(key: tuple[int, int], number: int) -> float:
    """Return uniform deviate ``number`` of a key, inside (0, 1)."""
    return (bits(key, number) + 0.5) * 2.0**-32


@kernel
def highest_bit(x: int) -> int:
    """Return the number of the highest bit set in 1..2^32 - 1 (a call of frexp takes four times as long)."""
    place = 0
    for width in (16, 8, 4, 2, 1):
        step = width * int(x >> width > 0)
        place += step
        x >>= step
    return place


@kernel
def last_event(key: tuple[int, int], time: float) -> int:
    """Return the number of the last event before ``time`` in a Poisson process with one event per unit of time.

    Two times share their last event with the probability ``exp(-|difference|)``: a value drawn for this event has that correlation in time,
    for any density, and any instant can be computed alone. Events are at instants ``SPACING`` apart, with a different phase for each
    key, so that over all keys the correlation is exact at multiples of the spacing and linear between: errors are below 0.0022.
    """
    instant = math.floor(time / SPACING + (key[0] ^ key[1]) * 2.0**-32)
    slot = instant // SLOTS
    mask = (2 << (instant - SLOTS * slot)) - 1
    for _ in range(LOOK_BACK):
        # three independent words: a bit is set in all of them with the chance 1/8
        events = bits(key, 3 * slot) & bits(key, 3 * slot + 1) & bits(key, 3 * slot + 2) & mask
        if events > 0:
            return SLOTS * slot + highest_bit(events)
        slot -= 1
        mask = WORD
    return SLOTS * slot


@kernel
def normal_quantile(p: float) -> float:
    """Return the quantile of the standard normal density, relative error 1.2e-9 (P. J. Acklam's rational approximation)."""
    # tails and middle have separate fits; the coefficients are Acklam's
    if p < 0.02425 or p > 0.97575:
        q = math.sqrt(-2.0 * math.log(min(p, 1.0 - p)))
        top = (
            ((((-7.784894002430293e-3 * q - 3.223964580411365e-1) * q - 2.400758277161838) * q - 2.549732539343734) * q) + 4.374664141464968
        ) * q
        top += 2.938163982698783
        under = (((7.784695709041462e-3 * q + 3.224671290700398e-1) * q + 2.445134137142996) * q + 3.754408661907416) * q + 1.0
        return top / under if p < 0.5 else -top / under
    q = p - 0.5
    r = q * q
    top = (
        (((-3.969683028665376e1 * r + 2.209460984245205e2) * r - 2.759285104469687e2) * r + 1.383577518672690e2) * r
    ) - 3.066479806614716e1
    top = top * r + 2.506628277459239
    under = (
        ((-5.447609879822406e1 * r + 1.615858368580409e2) * r - 1.556989798598866e2) * r + 6.680131188771972e1
    ) * r - 1.328068155288572e1
    return top * q / (under * r + 1.0)


@kernel
def gamma_deviate(shape: float, key: tuple[int, int], number: int) -> float:
    """Return gamma deviate ``number`` of a key, mean 1 and variance ``1/shape``; continuous in the shape except at ``BOOST_BELOW``.

    It is the cube of a normal deviate (Wilson and Hilferty 1931), scaled to the exact mean. Variances are within 0.2 % of the gamma
    density's, distances between the distributions below 0.003.
    """
    scale = 1.0
    if shape < BOOST_BELOW:
        exponent = math.log(uniform(key, 2 * number)) / shape
        if exponent < -40.0:
            return 0.0
        scale = math.exp(exponent) * (shape + 1.0) / shape
        shape += 1.0
    e = 1.0 / (9.0 * shape)
    y = max(1.0 - e + math.sqrt(e) * normal_quantile(uniform(key, 2 * number + 1)), 0.0)
    return scale * y * y * y * (1.0 + e * e * e)
