"""Folder of the user for files that can be computed again."""

from __future__ import annotations

import os
import sys
from pathlib import Path


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
