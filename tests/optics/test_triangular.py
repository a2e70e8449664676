"""Averages of spectra by a triangle."""

import numpy as np
import pytest

from seaglint.optics.band import triangular_average


def test_a_straight_spectrum_is_unchanged() -> None:
    nu = np.arange(900.0, 1100.1, 0.5)
    np.testing.assert_allclose(triangular_average(nu, 3.0 - 0.01 * nu, np.array([950.0, 1000.0])), [-6.5, -7.0], rtol=1e-12)


def test_a_line_gets_the_width_of_the_triangle() -> None:
    nu = np.arange(900.0, 1100.1, 0.5)
    line = np.zeros(nu.size)
    line[nu == 1000.0] = 2.0  # of area 1
    centres = np.array([960.0, 980.0, 990.0, 1000.0, 1010.0])
    # height 1/20 in the middle, half of it 10 cm-1 aside, nothing from 20 cm-1 on
    assert triangular_average(nu, line, centres) == pytest.approx([0.0, 0.0, 0.025, 0.05, 0.025], abs=1e-6)


def test_uneven_samples_count_by_their_spacing() -> None:
    """Counted alike, the denser half would pull the mean by 4 cm-1, 8e-3 of the square; steps of 1 cm-1 leave 2e-5."""
    nu = np.concatenate([np.arange(900.0, 1000.0, 0.25), np.arange(1000.0, 1100.1, 1.0)])
    assert triangular_average(nu, nu**2, np.array([1000.0]))[0] == pytest.approx(1000.0**2 + 20.0**2 / 6.0, rel=2e-5)
