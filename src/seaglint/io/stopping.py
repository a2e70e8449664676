"""Signals that end long work between two of its pieces, not in the middle of one."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def stop_on_signal(*, at_once: bool = False) -> Iterator[list[int]]:
    """List that gets an entry on the first SIGINT or SIGTERM; a second one interrupts at once, or already the first where asked."""
    caught: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield caught  # signals reach the main thread only
        return

    def note(number: int, _: FrameType | None) -> None:
        caught.append(number)
        if at_once or len(caught) > 1:
            raise KeyboardInterrupt

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield caught
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
