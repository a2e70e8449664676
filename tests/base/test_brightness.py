"""Brightness scales of pictures: one number for each value, and back."""

from __future__ import annotations

import numpy as np
import pytest

from seaglint.base.brightness import CELLS, Scale, eight_bit, scale_limits

STEPS = np.linspace(0.0, 1.0, CELLS + 1) ** 2
SCALES = {"linear": Scale(2.0, 12.0), "logarithmic": Scale(2.0, 12.0, width=0.5), "equalised": Scale(2.0, 12.0, steps=STEPS)}


@pytest.mark.parametrize("scale", SCALES.values(), ids=SCALES.keys())
def test_the_ends_are_dark_and_bright_and_values_come_back(scale: Scale) -> None:
    values = np.linspace(2.0, 12.0, 37)
    share = scale.share(values)
    assert (share[0], share[-1]) == pytest.approx((0.0, 1.0), abs=1e-12)
    assert np.all(np.diff(share) > 0.0)
    np.testing.assert_allclose(scale.value(share), values, rtol=1e-6)  # an equalised scale is linear within its cells


@pytest.mark.parametrize("scale", SCALES.values(), ids=SCALES.keys())
def test_levels_are_the_brightness_in_254_steps(scale: Scale) -> None:
    values = np.linspace(2.0, 12.0, 400)
    levels = scale.levels(values).astype(int)
    # half a level of rounding, and of an equalised scale a cell of the histogram
    assert np.max(np.abs(levels - (1.0 + 254.0 * scale.share(values)))) <= 0.5 + 254.0 * 2.0 / CELLS
    assert scale.levels(np.array([-50.0, 2.0, 12.0, 1e6, np.nan])).tolist() == [1, 1, 255, 255, 0]


def test_eight_bits_are_clipped_and_black_where_nothing_is_known() -> None:
    assert eight_bit(np.array([-1.0, 0.0, 0.5, 1.0, 2.0, np.nan])).tolist() == [0, 0, 128, 255, 255, 0]


def test_limits_between_other_percentiles() -> None:
    assert scale_limits(np.arange(1001.0), (0.0, 100.0)) == (0.0, 1000.0)
    assert scale_limits(np.arange(1001.0), (1.0, 99.0)) == pytest.approx((10.0, 990.0))
