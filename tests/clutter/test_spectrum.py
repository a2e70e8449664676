import numpy as np
import pytest

from seaglint.base.errors import DataError
from seaglint.clutter.spectrum import power_spectrum


def test_parseval():
    field = np.random.default_rng(1).normal(size=(48, 48))
    assert power_spectrum(field, size=48, window="boxcar").variance == pytest.approx(field.var(), rel=1e-12)


def test_white_noise_is_flat_at_its_variance():
    # 225 half overlapping squares of 64^2: the mean of a ring of 20 cells or more is known to 3 %, 4 of these.
    found = power_spectrum(2.0 * np.random.default_rng(2).normal(size=(512, 512)))
    frequency, density = found.radial()
    assert found.variance == pytest.approx(4.0, rel=0.02)
    np.testing.assert_allclose(density[3:], 4.0, rtol=0.12)
    assert np.all((frequency > 0.0) & (frequency < 0.52))
    np.testing.assert_allclose(found.directional(6)[1], 1 / 6, rtol=0.1)


@pytest.mark.parametrize(("along_x", "along_y", "angle"), [(8, 0, 0.0), (0, 8, np.pi / 2), (8, 8, np.pi / 4), (8, -8, 3 * np.pi / 4)])
def test_one_wave_is_one_line(along_x, along_y, angle):
    y, x = np.mgrid[:128, :128]
    found = power_spectrum(np.cos(2 * np.pi * (along_x * x + along_y * y) / 64))
    assert found.variance == pytest.approx(0.5, rel=1e-6)
    row, column = np.unravel_index(found.density.argmax(), found.density.shape)
    assert abs(found.frequency[column]) == abs(along_x) / 64
    assert abs(found.frequency[row]) == abs(along_y) / 64
    directions, share = found.directional(16)
    assert directions[share.argmax()] == pytest.approx(angle)
    assert share.sum() == pytest.approx(1.0)
    frequency, density = found.radial()
    assert frequency[density.argmax()] == pytest.approx(np.hypot(along_x, along_y) / 64, abs=0.7 / 64)


def test_squares_with_holes_are_left_out():
    field = np.random.default_rng(3).normal(size=(64, 96))
    mask = np.ones(field.shape, bool)
    mask[:, 64:] = False
    field[5, 80] = np.nan
    assert power_spectrum(field, mask).segments == 1
    nothing = power_spectrum(field, np.zeros(field.shape, bool))
    assert nothing.segments == 0
    assert np.isnan(nothing.variance)


@pytest.mark.parametrize("change", [{"size": 4}, {"window": "kaiser"}, {"mask": np.ones((3, 3), bool)}])
def test_refused(change):
    with pytest.raises(DataError):
        power_spectrum(np.zeros((64, 64)), **change)
