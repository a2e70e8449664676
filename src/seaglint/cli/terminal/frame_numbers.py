"""The frames asked for on the command line: ``37``, ``37:38``, ``10:``, ``:20``, of a stored run also ``0:100:2``."""

from __future__ import annotations

import re

from seaglint.base.errors import ScenarioError


def parse_frames(text: str | range | None, held: int | range, *, steps: bool = False) -> range:
    """Frame numbers from 0, the end not included, as in Python.

    ``held`` are the frames there are: those of a run, or how many a scenario has; ``steps`` allows every other one. ``text`` is that of a
    request's frames, of which it is not known before how many there are.

    >>> parse_frames("37:38", 100), parse_frames("90:", 100), parse_frames(None, 3)
    (range(37, 38), range(90, 100), range(0, 3))
    >>> parse_frames(":20:2", range(10, 30), steps=True)
    range(10, 20, 2)
    """
    frames, why = (range(held), f" (sensor.frames = {held})") if isinstance(held, int) else (held, "")
    if text is None:
        return frames
    match = isinstance(text, str) and re.fullmatch(r"\s*(\d*)\s*(:?)\s*(\d*)\s*(?:(:)\s*(\d*)\s*)?", text)
    if not match or not (match[1] or match[2]) or (match[4] and not (steps and match[2])):
        more = ", :20 or 0:100:2 (every other)" if steps else " or :20"
        raise ScenarioError(f"--frames {text}: is not a range of frames; write 37, 37:38 (the end not included), 10:{more}")
    first = int(match[1] or frames.start)
    end = int(match[3]) if match[3] else frames.stop if match[2] else first + 1
    step = int(match[5] or 1)
    if step == 0:
        raise ScenarioError(f"--frames {text}: a step of 0 never ends; give 1 or more")
    if not frames.start <= first < end <= frames.stop:
        raise ScenarioError(f"--frames {text}: is outside the sequence; allowed: {frames.start}:{frames.stop}, first before end{why}")
    return range(first, end, step)
