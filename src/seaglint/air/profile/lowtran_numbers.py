"""Shipped file of the numbers that LOWTRAN7 computes with: model atmospheres, band laws, aerosols, sunlight outside the air.

Built by ``tools/build_lowtran_numbers.py`` for 0.7-14.7 um in channels every 5 cm-1. Nothing in it is a result.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from functools import lru_cache
from importlib import resources
from io import BytesIO
from lzma import LZMAError
from types import MappingProxyType
from typing import Any, Final
from zipfile import BadZipFile

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject

FILE: Final = "lowtran7_numbers.npz"


@lru_cache(maxsize=1)
def lowtran_numbers() -> Mapping[str, Any]:
    """Return the arrays of the file by name, and its ``sha256``; read once a process, read-only.

    Raises
    ------
    DataError
        If the file in the package is missing or damaged.
    """
    try:
        content = resources.files("seaglint.air").joinpath("data", FILE).read_bytes()
        with np.load(BytesIO(content)) as archive:
            held: dict[str, Any] = {name: archive[name] for name in archive.files}
    except (OSError, ValueError, KeyError, BadZipFile, LZMAError) as error:
        raise DataError(f"the numbers of LOWTRAN7 {FILE} in the package are damaged ({error}); install seaglint again") from error
    for name, array in held.items():
        if array.dtype == np.float32:
            held[name] = array.astype(np.float64)
        held[name].flags.writeable = False
    return MappingProxyType(held | {"sha256": hashlib.sha256(content).hexdigest()})


def numbers_provenance() -> JsonObject:
    """Source of the file."""
    held = lowtran_numbers()
    recorded: JsonObject = json.loads(str(held["provenance"]))
    return recorded | {"sha256": str(held["sha256"])}


def channels_of(wavenumber_cm: FloatArray) -> FloatArray:
    """Indices [(n,)] of channels among those of the file.

    Raises
    ------
    DomainError
        Channels that the file does not hold.
    """
    grid = lowtran_numbers()["wavenumber_cm"]
    keep = np.clip(np.searchsorted(grid, wavenumber_cm - 1e-6), 0, grid.size - 1)
    if not np.allclose(grid[keep], wavenumber_cm, rtol=0.0, atol=1e-6):
        raise DomainError(
            f"LOWTRAN7's numbers are held every 5 cm-1 from {grid[0]:g} to {grid[-1]:g} cm-1 "
            f"({1e4 / grid[-1]:.2g}-{1e4 / grid[0]:.3g} um); choose a band inside"
        )
    return np.asarray(keep)
