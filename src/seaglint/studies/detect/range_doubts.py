"""Reasons for which a range of detection is to be doubted."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

from seaglint.files.detection_range import RangePoint

_ROLL = "the mean of each row was removed, so expect less of a camera that rolls"


def doubts(tried: Sequence[RangePoint], ends: Sequence[float | None]) -> list[str]:
    """Return why a range is to be doubted: P_d that rises with the range, thresholds beyond belief, what lies behind the object.

    Examples
    --------
    >>> near, far = RangePoint(500.0, 0.2, [0.1, 0.3]), RangePoint(900.0, 0.8, [0.7, 0.9])
    >>> doubts([near, far], [0.0, 500.0])
    ['P_d is 0.2 at 500 m and 0.8 at 900 m: it rises with the range, and the range found is one of several']
    """
    out = []
    for near, far in itertools.pairwise(tried):
        if near.p_d_interval is not None and far.p_d_interval is not None and near.p_d_interval[1] < far.p_d_interval[0]:
            where = f"P_d is {near.p_d:.3g} at {near.range_m:.0f} m and {far.p_d:.3g} at {far.range_m:.0f} m"
            out.append(f"{where}: it rises with the range, and the range found is one of several")
            break
    last = [point for point in tried if point.range_m in ends]
    if any(point.believed is False for point in last):
        out.append("the threshold is extrapolated from too few false alarms, and the range with it; give more frames")
    behind = next((text for text in map(horizon_note, reversed(last)) if text is not None), None)
    if behind is not None:
        out.append(behind)
    return out


def horizon_note(point: RangePoint) -> str | None:
    """Return where the horizon is, as far as it matters: behind the object, in the detector's window, or in the rows of the statistics.

    Examples
    --------
    >>> print(horizon_note(RangePoint(5e3, background="horizon", horizon_rows=12, window_rows=4, detector="top-hat")))
    at 5000 m the horizon is 12 rows above the object, beyond the 4 rows that top-hat looks at; rows about it count in the false alarms
    >>> horizon_note(RangePoint(5e3, background="sea", horizon_rows=30, window_rows=4)) is None
    True
    """
    at, rows, window = f"at {point.range_m:.0f} m", point.horizon_rows, point.window_rows
    if point.background == "sky" and (rows is None or window is None or abs(rows) > window):
        return f"{at} the sky lies behind the object; {_ROLL}"
    if rows is None:
        return None
    if rows == 0:
        return f"{at} the horizon lies behind the object; {_ROLL}"
    where = f"{at} the horizon is {abs(rows)} row{'s' * (abs(rows) != 1)} {'above' if rows > 0 else 'below'} the object"
    if window is None or abs(rows) <= window:
        looks = "whole frames" if window is None else f"the {window} rows"
        return f"{where}, within {looks} that {point.detector} looks at; {_ROLL}"
    if point.background == "horizon":
        return f"{where}, beyond the {window} rows that {point.detector} looks at; rows about it count in the false alarms"
    return None
