"""The machine of this process: type of its processor, and the user's folder for files that can be computed again."""

from __future__ import annotations

import os
import platform
import sys
from functools import cache
from pathlib import Path
from zlib import crc32


@cache
def processor() -> str:
    """Return the type of this machine's processor for the compiler of kernels: model, and a checksum of its instruction sets.

    Kernels are compiled for it; fused operations and the order of sums over vectors may change the last bits of a number.
    """
    from llvmlite import binding

    features = binding.get_host_cpu_features().flatten()
    return f"{platform.machine()} {binding.get_host_cpu_name()} {crc32(features.encode('ascii')):08x}"


def cache_folder() -> Path:
    """Return the user's folder for files that can be computed again: ``SEAGLINT_CACHE``, or ``seaglint`` in the system's cache folder."""
    own = os.environ.get("SEAGLINT_CACHE")
    if own:
        return Path(own).expanduser().absolute()
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / "seaglint" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "seaglint"
    # the specification ignores relative paths
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if os.path.isabs(base) else Path.home() / ".cache") / "seaglint"
