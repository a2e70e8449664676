"""Infrared ocean clutter: what an infrared sensor sees when it looks at the sea.

``import seaglint as sg`` costs nothing; what a name below needs is imported when it is used first. :mod:`seaglint.api` says what each does.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from seaglint.api import (
        analyze,
        apparent_temperature,
        compare_spectrum,
        dataset,
        detect,
        ensemble,
        export,
        homogeneous_path,
        image,
        load,
        mean,
        render,
        sense,
        sensor,
        sweep,
    )
    from seaglint.version import __version__

__all__ = [
    "__version__",
    "analyze",
    "apparent_temperature",
    "compare_spectrum",
    "dataset",
    "detect",
    "ensemble",
    "export",
    "homogeneous_path",
    "image",
    "load",
    "mean",
    "render",
    "sense",
    "sensor",
    "sweep",
]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'seaglint' has no attribute {name!r}; it has {', '.join(__all__)}, and its rooms as submodules")
    return getattr(import_module("seaglint.version" if name == "__version__" else "seaglint.api"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
