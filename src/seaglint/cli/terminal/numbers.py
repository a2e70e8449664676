"""Numbers as they are typed and told by ``seaglint detect``."""

from __future__ import annotations

MOST_CONTRASTS = 200


def contrasts_of(text: str, option: str = "--contrast") -> tuple[float, ...]:
    """Numbers of an option: one, several, or a range of them.

    Raises
    ------
    DataError
        What is no such thing, or too many.
    """
    import numpy as np

    from seaglint.base.errors import DataError

    wrong = DataError(f"{option} {text}: give a number, several as 1,2,4, or FIRST:LAST:STEP as 1:8:0.5, at most {MOST_CONTRASTS}")
    try:
        if ":" not in text:
            contrasts = tuple(float(part) for part in text.split(","))
        else:
            first, last, step = (float(part) for part in text.split(":"))
            count = int((last - first) / step + 1.0 + 1e-9) if step and (last - first) / step < MOST_CONTRASTS else 0
            contrasts = tuple(float(v) for v in np.round(first + step * np.arange(max(count, 0)), 12))
    except ValueError:
        raise wrong from None
    if not 0 < len(contrasts) <= MOST_CONTRASTS:
        raise wrong
    return contrasts


def between(ends: list[float] | None) -> str:
    """An interval in brackets."""
    return " (no interval)" if ends is None else f" ({ends[0]:.3g} to {ends[1]:.3g})"
