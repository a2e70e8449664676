"""The frames asked for on the command line: ``37``, ``37:38``, ``10:``, ``:20``."""

from __future__ import annotations

import re

from seaglint.errors import ScenarioError


def parse_frames(text: str | None, total: int) -> range:
    """Frame numbers from 0, the end not included, as in Python.

    >>> parse_frames("37:38", 100), parse_frames("90:", 100), parse_frames(None, 3)
    (range(37, 38), range(90, 100), range(0, 3))
    """
    if text is None:
        return range(total)
    match = re.fullmatch(r"\s*(\d*)\s*(:?)\s*(\d*)\s*", text)
    if match is None or not (match[1] or match[2]):
        raise ScenarioError(f"--frames {text}: is not a range of frames; write 37, 37:38 (the end not included), 10: or :20")
    first = int(match[1] or 0)
    end = int(match[3]) if match[3] else total if match[2] else first + 1
    if not 0 <= first < end <= total:
        raise ScenarioError(f"--frames {text}: is outside the sequence; allowed: 0:{total}, first before end (sensor.frames = {total})")
    return range(first, end)
