"""Ratio of two false-alarm rates with its interval, and the verdict whether it holds within a factor.

Exceedances come in clusters. Each count k over n pixels is divided by the inflation of its variance, as in the interval of a rate
(:mod:`seaglint.clutter.false_alarms`): effective numbers k' and n' of independent events and pixels. With Jeffreys' priors both
rates are gamma distributed about k' / n', and their ratio follows Fisher's distribution,

    B = p2 / (p1 + p2) ~ Beta(k2' + 1/2, k1' + 1/2),    p2 / p1 = n1' / n2' B / (1 - B)

with rates p' = k' in units of 1 / n'. For fewer than ten events the ends are those of the exact (Clopper-Pearson) interval of B. A rate of
zero events has a ratio with one end only.

References
----------
Nelson 1970, IEEE Trans. Reliability R-19, 42 (ratio of two Poisson rates, given their sum); Brown, Cai and DasGupta 2001, Statist. Sci. 16,
101 (Jeffreys' interval).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal

from seaglint.clutter.cluster_variance import FEWEST_COUNTS, student_widening
from seaglint.clutter.false_alarms import FalseAlarmRate

Verdict = Literal["holds", "differs", "undecided"]

#: Verdicts in words, for reports.
VERDICTS: Final[dict[Verdict, str]] = {
    "holds": "within the limit",
    "differs": "beyond the limit",
    "undecided": "not decided: too few exceedances",
}


@dataclass(frozen=True)
class RateRatio:
    """Ratio of a second rate to a first one, with its interval."""

    value: float | None  #: Ratio of the rates [1]; None where the first rate is 0.
    low: float | None  #: Lower end of the interval [1]; None where one of the rates has no interval.
    high: float | None  #: Upper end of the interval [1]; None where it is infinite, or where one of the rates has no interval.
    level: float = 0.95  #: Level of the interval [1].
    note: str | None = None  #: Reason for an absent interval.

    @property
    def interval(self) -> list[float | None]:
        """Both ends [1]."""
        return [self.low, self.high]

    def verdict(self, factor: float) -> Verdict:
        """Return whether the ratio holds within a factor: the whole interval does, all of it lies beyond, or neither.

        Parameters
        ----------
        factor : float
            Largest allowed ratio, and the inverse of the smallest [1].

        Examples
        --------
        >>> RateRatio(1.1, 0.9, 1.4).verdict(1.5), RateRatio(1.1, 0.4, 2.6).verdict(1.5)
        ('holds', 'undecided')
        >>> RateRatio(2.3, 1.6, 3.3).verdict(1.5), RateRatio(None, 2.0, None).verdict(1.5)
        ('differs', 'differs')
        """
        if self.low is None:
            return "undecided"
        high = math.inf if self.high is None else self.high
        if high < 1.0 / factor or self.low > factor:
            return "differs"
        return "holds" if 1.0 / factor <= self.low and high <= factor else "undecided"

    @property
    def text(self) -> str:
        """Ratio and interval in words.

        Examples
        --------
        >>> RateRatio(1.153, 0.8, 1.62).text
        '1.15 (0.80 to 1.62)'
        """
        value = "-" if self.value is None else _digits(self.value)
        if self.low is None:
            return f"{value} (no interval: {self.note})"
        if self.high is None:
            return f"{value} (above {_digits(self.low)})"
        return f"{value} ({_digits(self.low)} to {_digits(self.high)})"


def _digits(value: float) -> str:
    return f"{value:.2f}" if value < 10.0 else f"{value:.3g}"


def rate_ratio(first: FalseAlarmRate, second: FalseAlarmRate) -> RateRatio:
    """Return the ratio of two rates, second over first, with its interval.

    Parameters
    ----------
    first, second : FalseAlarmRate
        Rates at one threshold, of pictures that are independent of each other.

    Returns
    -------
    RateRatio
        Interval of the level of the first rate.
    """
    from scipy.special import betaincinv

    value = second.rate / first.rate if first.exceedances else None
    level, tail = first.level, 0.5 * (1.0 - first.level)
    if first.inflation is None or second.inflation is None or not (first.exceedances or second.exceedances):
        none = "no exceedances in either" if first.inflation is not None and second.inflation is not None else None
        return RateRatio(value, None, None, level, none or first.note or second.note)
    widths = [rate.inflation * student_widening(rate.degrees, level) for rate in (first, second)]  # type: ignore[operator]
    k1, k2 = (rate.exceedances / width for rate, width in zip((first, second), widths, strict=True))
    pixels = (first.pixels / widths[0]) / (second.pixels / widths[1])
    # A count of few events has the exact interval, which is wider.
    exact = min(first.exceedances, second.exceedances) < FEWEST_COUNTS
    part = 0.0 if exact else 0.5

    # Both ends from the small tail of their share, which keeps its digits.
    low, high = 0.0, None
    if second.exceedances:
        share = float(betaincinv(k2 + part, k1 + 1.0 - part, tail))
        low = pixels * share / (1.0 - share)
    if first.exceedances:
        share = float(betaincinv(k1 + part, k2 + 1.0 - part, tail))
        high = pixels * (1.0 - share) / share if share > 0.0 else None
    return RateRatio(value, low, high, level)
