"""Handling of signals that end long work between two of its pieces, not in the middle of one."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Final

#: Lists of all nested work, pieces last: a signal in a piece ends the whole too, and a piece that begins after it ends at once.
_listening: Final[list[list[int]]] = []


@contextmanager
def stop_on_signal(*, at_once: bool = False) -> Iterator[list[int]]:
    """Provide a list that gets an entry on the first SIGINT or SIGTERM; a second signal interrupts at once, the first if so requested."""
    caught = _listening[-1].copy() if _listening else list[int]()
    if threading.current_thread() is not threading.main_thread():
        yield caught  # signals reach the main thread only
        return

    def note(number: int, _: FrameType | None) -> None:
        for noted in _listening:
            noted.append(number)
        if at_once or len(caught) > 1:
            raise KeyboardInterrupt

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    _listening.append(caught)
    try:
        yield caught
    finally:
        _listening.pop()
        for number, handler in before.items():
            signal.signal(number, handler)
