"""Infrared ocean clutter: what an infrared sensor sees when it looks at the sea.

``import seaglint as sg`` costs nothing; what a name below needs is imported when it is used first. :mod:`seaglint.api` says what each does.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from seaglint.api import analyze, apparent_temperature, dataset, detect, ensemble, export, image, load, mean, render, sense, sensor
    from seaglint.version import __version__

__all__ = [
    "__version__",
    "analyze",
    "apparent_temperature",
    "dataset",
    "detect",
    "ensemble",
    "export",
    "image",
    "load",
    "mean",
    "render",
    "sense",
    "sensor",
]

_ROOMS = ("render", "sensor")
"""Names that are both a function of :mod:`seaglint.api` and a package."""


class _Called(ModuleType):
    """Module that is also a function: ``seaglint.render`` renders, ``seaglint.sensor`` returns the figures of a sensor."""

    def __call__(self, *args: Any, **options: Any) -> Any:
        """Call the function of :mod:`seaglint.api` that has the name of this package."""
        return getattr(import_module("seaglint.api"), self.__name__.rpartition(".")[2])(*args, **options)


class _Package(ModuleType):
    """Class of the package ``seaglint`` itself."""

    def __setattr__(self, name: str, value: Any) -> None:
        # the import system binds a room here whenever it is first imported, by whomever
        if name in _ROOMS and type(value) is ModuleType:
            value.__class__ = _Called
        super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'seaglint' has no attribute {name!r}; it has {', '.join(__all__)}, and its rooms as submodules")
    if name in _ROOMS:
        return import_module(f"seaglint.{name}")
    return getattr(import_module("seaglint.version" if name == "__version__" else "seaglint.api"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
