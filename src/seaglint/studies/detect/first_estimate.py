"""First estimate of a range of detection, in seconds: the object's contrast, the deviation of a few small seas, and the Gaussian law."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.special import ndtr, ndtri

from seaglint.detection.matched import Matched
from seaglint.studies.detect.near_object import background_of, less_row_means
from seaglint.studies.detect.scene_frames import IndependentSeas

if TYPE_CHECKING:
    from seaglint.base.conventions import FloatArray
    from seaglint.detection.spot import SpotShape
    from seaglint.scenario.model import Scenario
    from seaglint.studies.detect.designer import Design
    from seaglint.studies.detect.injected import Seen

COLUMNS: Final = 96  #: Columns about the object that are drawn for an estimate.

SEAS: Final = 3  #: Seas of that size that are drawn at each range.

_OFFSETS: Final = (np.arange(5) + 0.5) / 5 - 0.5  #: Places of the object within its pixel [px].


def estimated_p_d(placed: Scenario, seen: Seen, design: Design) -> float:
    """P_d of a matched filter by the Gaussian law: no frame is searched.

    ``P_d = < Q(Q^-1(P_fa) - v c g / sigma) >`` over the places in the pixel and the seas, with the contrast ``c``, the share ``v`` of the
    object that waves leave in view, the filter's answer ``g`` and the standard deviation ``sigma`` of the filtered rows near the object.

    Parameters
    ----------
    placed : Scenario
        With the object in the middle of the picture.
    seen : Seen
        The object there.
    design : Design
        Rate of false alarms.
    """
    seas = IndependentSeas.of(placed)
    _, first, end = background_of(seas, round(seen.row), seen.shape.half)
    detector = Matched(seen.shape.stamps(np.zeros((1, 2)))[0])
    frames = np.concatenate([seas.sea(number, 1) for number in range(SEAS)])
    rows, columns = frames.shape[1:]
    statistic = detector(less_row_means(frames[:, first:end]))
    reach = min(detector.reach, (end - first) // 3, columns // 3)
    inner = statistic[:, reach : end - first - reach, reach : columns - reach]
    sigma = float(np.std(inner, dtype=np.float64))
    if not sigma > 0.0:
        return 1.0
    rate = design.p_fa
    if rate is None:
        rate = min(design.alarms_per_hour / (3600.0 * placed.sensor.frame_rate_hz * rows * columns), 0.4)
    answer = answers(seen.shape, detector)
    shares = seen.visible_shares(SEAS, seas)
    signal = np.multiply.outer(shares, answer) * abs(seen.contrast) / sigma
    return float(np.where(signal > 0.0, ndtr(signal + ndtri(rate)), 0.0).mean())


def answers(shape: SpotShape, detector: Matched) -> FloatArray:
    """Largest answer of the filter among the pixels of an object of contrast 1, for places within its pixel [1]."""
    down, right = np.meshgrid(_OFFSETS, _OFFSETS, indexing="ij")
    stamps = np.asarray(shape.stamps(np.stack([down.ravel(), right.ravel()], axis=1)), np.float32)
    wide = np.pad(stamps, ((0, 0), (detector.reach,) * 2, (detector.reach,) * 2))
    return np.asarray(detector(wide).max(axis=(1, 2)), np.float64)
