"""Scalar kernels behind random numbers that have a name."""

import numpy as np
import pytest
from scipy.special import ndtri

from seaglint.base.keyed_random import (
    LOOK_BACK,
    SLOTS,
    SPACING,
    bits,
    cell_key,
    gamma_deviate,
    highest_bit,
    last_event,
    mixed,
    normal_quantile,
)

pytestmark = pytest.mark.kernel


def test_normal_quantiles_are_those_of_the_inverse_error_function():
    """Tails and middle, to the error that is stated of the approximation and a little for numbers next to 0."""
    p = np.concatenate([np.geomspace(2.0**-33, 0.5, 200), [0.02424, 0.02426, 0.3, 0.499]])
    p = np.concatenate([p, 1.0 - p])
    assert [normal_quantile(float(one)) for one in p] == pytest.approx(ndtri(p), rel=1.3e-9, abs=1e-12)


@pytest.mark.parametrize("number", [1, 2, 3, 255, 256, 2**31 - 1, 2**31, 2**32 - 1])
def test_the_highest_bit_is_that_of_the_binary_number(number):
    assert highest_bit(number) == number.bit_length() - 1


def test_mixing_keeps_numbers_apart_and_changes_half_of_the_bits():
    """It is a permutation of the words; one bit of the argument changes each bit of the result half of the time."""
    some = [mixed(n) for n in range(4096)]
    assert len(set(some)) == 4096
    assert max(some) < 2**32
    assert mixed(5 + 2**32) == mixed(5)
    for bit in range(0, 32, 5):
        turned = np.array([(mixed(n) ^ mixed(n ^ (1 << bit))) for n in range(4096)], np.uint32)
        share = np.unpackbits(turned.view(np.uint8)).mean()
        assert share == pytest.approx(0.5, abs=0.01)


def test_keys_of_neighbours_and_lattices_are_apart():
    seed = (12, 34)
    keys = {cell_key(seed, i, j, lattice) for i in range(-8, 8) for j in range(-8, 8) for lattice in range(4)}
    assert len(keys) == 16 * 16 * 4
    for half in (0, 1):  # each word follows one index and the lattice
        assert len({key[half] for key in keys}) == 16 * 4


def test_gamma_deviates_have_the_quantiles_of_the_density():
    """Of high shapes, whose one uniform number is known: Wilson and Hilferty's cube with the mean 1."""
    from scipy.stats import gamma

    key, shape = cell_key((1, 2), 3, 4, 0), 50.0
    uniforms = np.array([(bits(key, 2 * n + 1) + 0.5) * 2.0**-32 for n in range(300)])
    found = np.array([gamma_deviate(shape, key, n) for n in range(300)])
    assert found == pytest.approx(gamma.ppf(uniforms, shape) / shape, rel=2e-3)


def test_events_of_a_slot_are_the_latest_bits_and_look_back():
    """Against a search through all instants one by one."""
    for cell in range(40):
        key = cell_key((5, 6), cell, 7, 1)
        phase = (key[0] ^ key[1]) * 2.0**-32
        for time in (0.0, 3.7, 250.25):
            instant = int(np.floor(time / SPACING + phase))
            while True:
                slot, place = divmod(instant, SLOTS)
                if all((bits(key, 3 * slot + k) >> place) & 1 for k in range(3)):
                    break
                instant -= 1
            assert last_event(key, time) == instant
    assert LOOK_BACK * SLOTS * SPACING > 60.0  # no event for so long once in 1e29
