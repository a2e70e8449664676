"""What a worker is: the version and sources of its package, and its processor type."""

from __future__ import annotations

import os
import platform
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
    """Type for which kernels are compiled: between types the last bits can differ."""
    host: str
    process: int


@cache
def this_machine() -> Machine:
    """What this process is."""
    from seaglint._kernel_cache import sources_digest
    from seaglint.version import __version__

    return Machine(__version__, sources_digest(), processor_type(), socket.gethostname(), os.getpid())


def processor_type() -> str:
    """Instruction set and model of the processor as the compiler names them, such as ``x86_64 znver3``."""
    from llvmlite.binding import get_host_cpu_name

    return f"{platform.machine()} {get_host_cpu_name()}"
