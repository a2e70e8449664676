import numpy as np
import pytest

from seaglint.base.errors import DomainError
from seaglint.radiance.variance import ARTICLE_SURFACE_TENSION, capillary_length, correlation_length
from seaglint.sea.dispersion import angular_frequency


@pytest.mark.parametrize(("time", "length_cm"), [(0.07, 0.210), (0.3, 0.554)])
def test_eq_17_gives_the_printed_lengths(time, length_cm):
    assert 100.0 * capillary_length(time) == pytest.approx(length_cm, abs=5e-4)  # three printed digits


@pytest.mark.parametrize(("time", "length_cm"), [(0.07, 0.259), (0.3, 2.27)])
def test_gravity_counts(time, length_cm):
    assert 100.0 * correlation_length(time) == pytest.approx(length_cm, rel=1e-2)  # independent solution with 76.3 dyn/cm, ours 74


@pytest.mark.parametrize("time", [0.001, 0.07, 1.0])
def test_length_belongs_to_a_wave_of_that_period(time):
    assert angular_frequency(1.0 / correlation_length(time)) == pytest.approx(2.0 * np.pi / time, rel=1e-9)


def test_capillary_waves_are_the_limit_of_short_times():
    ratio = correlation_length(1e-4) / capillary_length(1e-4)
    assert ratio == pytest.approx((0.074 / ARTICLE_SURFACE_TENSION) ** (1 / 3), rel=1e-4)  # only the surface tensions differ


@pytest.mark.parametrize("time", [0.0, -1.0, np.nan, np.inf])
def test_times_that_are_none_are_refused(time):
    with pytest.raises(DomainError, match="> 0 s"):
        correlation_length(time)
