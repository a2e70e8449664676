"""Description of a worker: version and sources of its package, and its processor type."""

from __future__ import annotations

import os
import socket
from functools import cache
from typing import NamedTuple


class Machine(NamedTuple):
    """Machine of a process, with all that its results depend on."""

    version: str  #: Version of seaglint.
    sources: str  #: Digest of the sources of all kernels.
    processor: str  #: Type of the processor, as stores record it: the last bits of results can differ between types.
    host: str
    process: int


@cache
def this_machine() -> Machine:
    """Return the description of this process."""
    from seaglint.base.kernel_cache import sources_digest
    from seaglint.base.processor import processor
    from seaglint.version import __version__

    return Machine(__version__, sources_digest(), processor(), socket.gethostname(), os.getpid())
