"""Infrared ocean clutter: what an infrared sensor sees when it looks at the sea.

``import seaglint as sg`` costs nothing; what a name below needs is imported when it is used first. ``seaglint.api`` says what each does.
"""

# ruff: noqa: F405 - the names of __all__ come from seaglint.api, which is imported when the first of them is used.

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from seaglint.api import *  # noqa: F403
    from seaglint.version import __version__

__all__ = [
    "__version__",
    "analyze",
    "apparent_temperature",
    "atmosphere",
    "compare",
    "compare_spectrum",
    "dataset",
    "detect",
    "detect_design",
    "detect_range",
    "detect_recording",
    "detect_scene",
    "ensemble",
    "evaluate",
    "export",
    "export_sea",
    "frames",
    "homogeneous_path",
    "image",
    "info",
    "init",
    "labels",
    "likelihood",
    "load",
    "mean",
    "render",
    "reproduce",
    "schema",
    "sense",
    "sensor",
    "sweep",
    "texture",
    "weather",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'seaglint' has no attribute {name!r}; it has {', '.join(__all__)}, and its rooms as submodules")
    if name != "__version__":
        from seaglint.base.thread_setting import require_thread_setting

        require_thread_setting()
    return getattr(import_module("seaglint.version" if name == "__version__" else "seaglint.api"), name)


def __dir__() -> list[str]:
    return list(__all__)
