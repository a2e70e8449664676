"""What a worker is: the version and sources of its package, and its processor type."""

from __future__ import annotations

import os
import socket
from functools import cache
from typing import NamedTuple


class Machine(NamedTuple):
    """What the bytes that a process computes depend on, and where it runs."""

    version: str
    """Of seaglint."""
    sources: str
    """Digest of all that kernels are made of."""
    processor: str
    """Its type, as stores record it: between types the last bits can differ."""
    host: str
    process: int


@cache
def this_machine() -> Machine:
    """What this process is."""
    from seaglint.base.kernel_cache import sources_digest
    from seaglint.base.processor import processor
    from seaglint.version import __version__

    return Machine(__version__, sources_digest(), processor(), socket.gethostname(), os.getpid())
