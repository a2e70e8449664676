"""Frame rates that files state: by attributes, by evenly spaced times, and in their units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.free_form import Attributes

#: Seconds in a unit of time, by its spellings in lower case; the escaped one is how ImageJ writes a micro sign.
SECONDS: Final = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec", "msecs", "millisecond", "milliseconds"), 1e-3),
    **dict.fromkeys(("us", "usec", "µs", "μs", "µsec", "\\u00b5s", "microsecond", "microseconds"), 1e-6),
    **dict.fromkeys(("ns", "nsec", "nanosecond", "nanoseconds"), 1e-9),
    **dict.fromkeys(("min", "mins", "minute", "minutes"), 60.0),
    **dict.fromkeys(("h", "hr", "hrs", "hour", "hours"), 3600.0),
    **dict.fromkeys(("d", "day", "days"), 86400.0),
}

RATE_NAMES: Final = ("frame_rate", "frame_rate_hz", "fps")  #: Names of a frame rate in attributes, and of arrays that hold one number.

SAME: Final = 1e-3  #: Relative difference below which two rates or steps are one.


def seconds_in(unit: object) -> float | None:
    """Return the seconds in a unit, alone or in front of "since ..."; None where it is none of time.

    >>> seconds_in("ms"), seconds_in("seconds since 2024-01-01"), seconds_in("frames")
    (0.001, 1.0, None)
    """
    words = str(unit).split()
    return SECONDS.get(words[0].lower()) if words else None


def frame_rate_of(attributes: Attributes) -> float | None:
    """Return the frame rate [Hz] that attributes state."""
    for name in RATE_NAMES:
        value = attributes.get(name)
        if value is not None:
            try:
                rate = float(np.ravel(value)[0])
            except (TypeError, ValueError, IndexError):
                continue
            if np.isfinite(rate) and rate > 0.0:
                return rate
    return None


def rate_of_times(times: NDArray[Any], attributes: Mapping[Any, Any]) -> tuple[float | None, str | None]:
    """Return the frame rate [Hz] of a time coordinate, and a sentence where it gives none.

    Times that are whole numbers may be rounded: they are even where rounding explains the differences of their steps.
    """
    if times.ndim != 1 or times.size < 2:
        return None, None
    if times.dtype.kind in "Mm":
        seconds, unit, whole = (times - times[0]) / np.timedelta64(1, "ns"), 1e-9, False
    else:
        if times.dtype.kind not in "uif":
            return None, None
        stated = attributes.get("units")
        found = None if stated is None else seconds_in(stated.decode() if isinstance(stated, bytes) else stated)
        if found is None:
            if stated is None:
                return None, "times have no units: they give no frame rate; give --frame-rate"
            return None, f"times are in {stated}, which is no unit of time that is read; give --frame-rate"
        unit = found * float(np.ravel(attributes.get("scale_factor", 1.0))[0])
        seconds, whole = times.astype(np.float64), bool(np.all(times == np.round(times)))
    steps = unit * np.diff(seconds)
    mean = float(np.mean(steps))
    if not mean > 0.0:
        return None, "times do not rise: they give no frame rate; give --frame-rate"
    rounding = unit if whole else 0.0
    if float(np.max(np.abs(steps - mean))) > max(SAME * mean, 1.001 * rounding):
        return (
            None,
            f"frames are {1e3 * steps.min():.4g} to {1e3 * steps.max():.4g} ms apart: they have no one frame rate; give --frame-rate",
        )
    return 1.0 / mean, None


def one_rate(rates: Mapping[str, float]) -> tuple[float | None, tuple[str, ...]]:
    """Return the only rate [Hz] of several sources, or none and a note where they contradict each other."""
    values = list(rates.values())
    if not values or max(values) / min(values) - 1.0 < SAME:
        return (values[0] if values else None), ()
    listed = ", ".join(f"{rate:g} Hz of {source}" for source, rate in rates.items())
    return None, (f"frame rates contradict each other ({listed}): none is taken; give --frame-rate",)
