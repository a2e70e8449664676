"""Identification of this machine's processor type."""

from __future__ import annotations

import platform
from functools import cache
from zlib import crc32


@cache
def processor() -> str:
    """Type of this machine's processor as the kernels' compiler sees it: model, and a checksum of its instruction sets.

    Kernels are compiled for it, and what is fused or in which order vectors are summed may change the last bits of a number.
    """
    from llvmlite import binding

    features = binding.get_host_cpu_features().flatten()
    return f"{platform.machine()} {binding.get_host_cpu_name()} {crc32(features.encode('ascii')):08x}"
