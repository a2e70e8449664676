"""Where extrapolated rates of false alarms end, and where they stop being believed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_tails import tail_of

from seaglint.clutter.extremes import TRUSTED_SETS, TRUSTED_SPAN
from seaglint.detection.rare_alarms import RareTail


@pytest.fixture(scope="module")
def tail() -> RareTail:
    """Exponential noise in 4 million values: its tail is of the fit's own form."""
    return tail_of(np.random.default_rng(5).exponential(size=(4, 1000, 1000)))[0]


def test_a_rate_is_believed_down_to_one_exceedance_in_ten_sets(tail: RareTail) -> None:
    few = replace(tail, pixels=20_000)  # far within what the fit's interval allows
    rarest = 1.0 / (TRUSTED_SETS * few.pixels)
    for share, believed in ((1.02, True), (0.98, False)):
        rate = few.threshold_for(share * rarest)
        assert rate is not None
        assert rate.high < TRUSTED_SPAN * rate.low  # the interval alone would do
        assert rate.rate == pytest.approx(share * rarest, rel=1e-6)
        assert rate.believed is believed


def test_a_rate_is_believed_while_its_interval_is_narrow(tail: RareTail) -> None:
    """As many pixels as one likes: what is left is the width of the interval."""
    endless = replace(tail, pixels=10**30)
    rates = [endless.at(t) for t in np.linspace(tail.fit.threshold, tail.fit.threshold + 25.0, 400)]
    assert [r.believed for r in rates] == [r.high < TRUSTED_SPAN * r.low for r in rates]
    assert {r.believed for r in rates} == {True, False}


def test_no_rate_is_above_one(tail: RareTail) -> None:
    """The fit's own rate of events, raised until the interval's upper end would be above every pixel."""
    common = replace(tail, fit=replace(tail.fit, rate=0.999))
    found = common.at(tail.fit.threshold)
    assert found.low < found.rate <= found.high == 1.0
