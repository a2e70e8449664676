"""Identification of this machine's processor type.

Folder of the user for files that can be computed again.
"""

from __future__ import annotations

import os
import platform
import sys
from functools import cache
from pathlib import Path
from zlib import crc32


@cache
def processor() -> str:
    """Type of this machine's processor as the kernels' compiler sees it: model, and a checksum of its instruction sets.

    Kernels are compiled for it, and what is fused or in which order vectors are summed may change the last bits of a number.
    """
    from llvmlite import binding

    features = binding.get_host_cpu_features().flatten()
    return f"{platform.machine()} {binding.get_host_cpu_name()} {crc32(features.encode('ascii')):08x}"


def cache_folder() -> Path:
    """Folder of the user for files that can be computed again: ``SEAGLINT_CACHE``, or ``seaglint`` in the cache folder of the system."""
    own = os.environ.get("SEAGLINT_CACHE")
    if own:
        return Path(own).expanduser().absolute()
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / "seaglint" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "seaglint"
    base = os.environ.get("XDG_CACHE_HOME", "")
    return (Path(base) if os.path.isabs(base) else Path.home() / ".cache") / "seaglint"
