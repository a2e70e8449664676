"""Receiver operating characteristic of one run: rates of detections and false alarms at every threshold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.clutter.cluster_variance import score_interval
from seaglint.clutter.false_alarms import RateCurve
from seaglint.detection.scoring import Scores

POINTS: Final = 120  #: Number of thresholds of the characteristic.


@dataclass(frozen=True)
class Roc:
    """Operating characteristic."""

    threshold: FloatArray  #: In standard deviations, rising [1].
    #: ``p_fa``, ``p_fa_low``, ``p_fa_high``: Rate of false alarms per pixel with its band [1].
    p_fa: FloatArray
    p_fa_low: FloatArray
    p_fa_high: FloatArray
    #: ``p_d``, ``p_d_low``, ``p_d_high``: Share of objects detected with its band [1].
    p_d: FloatArray
    p_d_low: FloatArray
    p_d_high: FloatArray

    def columns(self) -> dict[str, FloatArray]:
        """Columns of a table."""
        names = ("threshold", "p_fa", "p_fa_low", "p_fa_high", "p_d", "p_d_low", "p_d_high")
        return {("threshold_sigma" if name == "threshold" else name): getattr(self, name) for name in names}


def roc(curve: RateCurve, scores: Scores, inflation: tuple[float, float], level: float = 0.95) -> Roc:
    """Receiver operating characteristic over the thresholds at which there are false alarms.

    Parameters
    ----------
    curve : RateCurve
        Rate curve of the statistic without objects.
    scores : Scores
        Scores of the objects.
    inflation : (float, float)
        Variance of false alarms and of detections over that of independent ones, taken for every threshold [1].
    level : float
        Confidence level of the bands, for each rate alone [1].
    """
    last = int(np.flatnonzero(curve.exceedances)[-1]) if curve.exceedances.any() else 0
    # Even in the logarithm of the rate, where the interest is.
    rates = np.geomspace(0.999, 1.0 / max(curve.pixels, 2), POINTS)
    chosen = np.unique(np.minimum(np.searchsorted(-curve.rate, -rates), last))
    count_fa = curve.exceedances[chosen]
    threshold = curve.threshold[chosen]
    ordered = np.sort(scores.score)
    count_d = ordered.size - np.searchsorted(ordered, threshold, side="right")

    def band(counts: NDArray[np.int64], number: int, factor: float) -> tuple[FloatArray, FloatArray]:
        ends = [score_interval(int(c), number, factor if np.isfinite(factor) else 1.0, float("inf"), level) for c in counts]
        return np.array([e[0] for e in ends]), np.array([e[1] for e in ends])

    fa, d = band(count_fa, curve.pixels, inflation[0]), band(count_d, ordered.size, inflation[1])
    return Roc(threshold, count_fa / max(curve.pixels, 1), *fa, count_d / ordered.size, *d)
