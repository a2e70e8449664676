"""Provenance of a file: the attributes that every output carries."""

from __future__ import annotations

import json
import platform
import sys
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any, Final

import numpy as np

from seaglint.base.free_form import Attributes
from seaglint.optics.band import Band
from seaglint.version import __version__

#: Attributes that may differ between two halves of one sequence; all others must agree for a sequence to be resumed.
VOLATILE: Final = frozenset({"history", "created_with", "processor", "processors_mixed", "unfinished"})

#: Value of the attribute ``processors_mixed``.
PROCESSORS_MIXED: Final = "frames were made on processors of several types: between them pixels may differ in the last bits"

_PACKAGES: Final = ("numpy", "scipy", "numba", "zarr")


@cache  # reading a distribution's metadata takes a millisecond, and a data set has thousands of scenes
def package_version(name: str) -> str:
    """Return the installed version of a distribution, or ``"not installed"``; the package itself is not imported."""
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def provenance(title: str, scenario_json: str, seed: int, **more: Any) -> Attributes:
    """Return the global attributes of a file.

    Parameters
    ----------
    title : str
        Content of the file in a few words.
    scenario_json : str
        The validated scenario as JSON: with the version it is all that is needed to make the file again.
    seed : int
        Seed of the random streams.
    **more
        Further attributes of the computation: table checksums, cut wavenumbers, steps. Values must be JSON-able.
    """
    packages = ", ".join(f"{name} {package_version(name)}" for name in _PACKAGES)
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    return {
        "Conventions": "CF-1.11",
        "title": title,
        "source": f"seaglint {__version__} (model)",
        "seaglint_version": __version__,
        "seed": seed,
        "scenario": scenario_json,
        **more,
        "created_with": f"Python {platform.python_version()} on {sys.platform} {platform.machine()}, {packages}",
        "history": f"{now} written by seaglint {__version__}",
    }


def differences(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Return names of attributes that differ between two files of one sequence and must not; scenarios are compared key by key."""
    keys = sorted(key for key in (old.keys() | new.keys()) - VOLATILE if old.get(key) != new.get(key))
    if "scenario" not in keys:
        return keys
    try:
        inside = list(_different_keys(json.loads(old["scenario"]), json.loads(new["scenario"])))
    except (KeyError, ValueError):
        return keys
    # Attributes that follow from the scenario (band, rate, seed, cut wavenumbers) need not be reported again.
    return inside or [key for key in keys if key != "scenario"]


def _different_keys(old: Any, new: Any, path: str = "") -> Iterator[str]:
    if isinstance(old, dict) and isinstance(new, dict):
        for key in dict.fromkeys([*old, *new]):
            yield from _different_keys(old.get(key), new.get(key), f"{path}.{key}" if path else key)
    elif old != new and (old or new):  # a list that is empty and one that an older file does not have are the same
        yield path


def band_attributes(band: Band | None) -> dict[str, list[float]]:
    """Return the spectral response as attributes, so that a file needs no other one to be read; empty without a band."""
    if band is None:
        return {}
    return {"band_wavelength_um": band.wavelength_um.tolist(), "band_response": band.response.tolist()}


def stored_band(attributes: Mapping[str, Any]) -> Band:
    """Return the spectral response that a file's radiance is integrated over."""
    wavelength, response = (np.asarray(attributes[key], dtype=np.float64) for key in ("band_wavelength_um", "band_response"))
    return Band(wavelength, response)
