"""Shipped file of LOWTRAN7's scatterers and absorbers: six model atmospheres, winds 0-20 m/s, 2-5.5 um.

Built by ``tools/build_scattering.py``. It holds what LOWTRAN7 itself computes with, not results: profiles at its levels, the aerosol's at
nodes of wind (between them linear), coefficients of every channel, phase functions at LOWTRAN7's own angles and wavelengths. For
7.5-14 um there is none: at 7 m/s scattered sunlight is at most 1e-3 of the thermal radiance there in the warmer models, 4e-3 in
midlatitude and 9e-3 in subarctic winter, looking into the Sun.
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

from seaglint.air.scattering.lowtran_ray import AEROSOLS, layer_amounts
from seaglint.air.scattering.scattering_laws import AerosolLaws, AirLevels, ScatteringAir, Segments, SpectralLaws, grid_of
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.base.free_form import JsonObject

FILE: Final = "scattering_lowtran7.npz"

MARGIN: Final = 1e-9
"""Relative tolerance for bands that end on the edge of the file."""


@lru_cache(maxsize=1)
def read_file() -> Mapping[str, Any]:
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
        raise DataError(f"the scattering laws {FILE} in the package are damaged ({error}); install seaglint again") from error
    for name, array in held.items():
        if array.dtype == np.float32:
            held[name] = array.astype(np.float64)
        held[name].flags.writeable = False
    return MappingProxyType(held | {"sha256": hashlib.sha256(content).hexdigest()})


def covers(band_um: tuple[float, float]) -> bool:
    """True if scattered sunlight of a band [um] is in the file; beyond it there is almost none."""
    grid = read_file()["wavenumber_cm"]
    return bool(1e4 / band_um[1] >= grid[0] * (1.0 - MARGIN) and 1e4 / band_um[0] <= grid[-1] * (1.0 + MARGIN))


def provenance() -> JsonObject:
    """Source of the file."""
    held = read_file()
    recorded: JsonObject = json.loads(str(held["provenance"]))
    return recorded | {"sha256": str(held["sha256"])}


class ScatteringTable:
    """Scatterers of one model atmosphere on some channels, for many winds.

    Parameters
    ----------
    model : str
        Name of the model atmosphere.
    wavenumber_cm : ndarray
        Channels, all of them of the file [cm-1].

    Raises
    ------
    DomainError
        An unknown model, or channels that the file does not hold.

    Examples
    --------
    >>> air = ScatteringTable("midlatitude-summer", np.arange(2000.0, 2861.0, 5.0)).at_wind(7.0)
    >>> air.source.shape
    (173,)
    """

    def __init__(self, model: str, wavenumber_cm: FloatArray) -> None:
        held = read_file()
        models = held["models"].tolist()
        if model not in models:
            raise DomainError(f"model = {model!r} has no scattering laws; choose one of {', '.join(models)}")
        grid = held["wavenumber_cm"]
        keep = np.clip(np.searchsorted(grid, wavenumber_cm - 1e-6), 0, grid.size - 1)
        if not np.allclose(grid[keep], wavenumber_cm, rtol=0.0, atol=1e-6):
            raise DomainError(f"scattered sunlight is held every 5 cm-1 from {grid[0]:g} to {grid[-1]:g} cm-1; choose a band inside")
        self._held, self._keep, self._index = held, keep, models.index(model)
        columns = held["band_column"].astype(np.int64)
        whole = SpectralLaws(grid, held["continuum"], columns, held["band_power"], held["band_log"])
        # columns of amounts are those of the whole file, whatever the channels
        self._order = whole.columns
        self._spectral = whole.cut(keep)
        self._bands = _renumbered(self._spectral, self._order)
        um = 1e4 / self._spectral.wavenumber_cm
        self._um = um
        nodes = held["phase_um"]
        left = np.clip(np.searchsorted(nodes, um, side="right") - 1, 0, nodes.size - 2)
        part = ((um - nodes[left]) / (nodes[left + 1] - nodes[left]))[:, None]
        self._log_phase = (1.0 - part) * held["log_phase"][:, left] + part * held["log_phase"][:, left + 1]

        self._grid = grid_of(self._levels(held["aerosol_density"][self._index, 0]))

    def _levels(self, aerosol_density: FloatArray) -> AirLevels:
        held, m = self._held, self._index
        return AirLevels(
            float(held["earth_radius"][m]),
            held["height"][m],
            held["pressure"][m],
            held["temperature"][m],
            held["refractivity"][m],
            held["humidity"][m],
            held["tops"][m],
            np.concatenate([aerosol_density, held["density"][m]]),
        )

    def at_wind(self, wind_speed: float) -> ScatteringAir:
        """Scattering air at a wind [m s-1]; above 20 m/s that of 20, as in LOWTRAN7."""
        held, m, keep = self._held, self._index, self._keep
        winds = held["winds"]
        w = min(max(float(wind_speed), float(winds[0])), float(winds[-1]))
        i = min(int(np.searchsorted(winds, w, side="right")) - 1, winds.size - 2)
        part = (w - winds[i]) / (winds[i + 1] - winds[i])

        def between(name: str) -> FloatArray:
            return np.asarray((1.0 - part) * held[name][m, i] + part * held[name][m, i + 1])

        extinction, absorption = (np.empty((AEROSOLS, keep.size)) for _ in range(2))
        extinction[1:], absorption[1:] = held["aloft_extinction"][:, keep], held["aloft_absorption"][:, keep]
        extinction[0] = np.interp(self._um, held["node_um"], between("node_extinction"))
        absorption[0] = np.interp(self._um, held["node_um"], between("node_absorption"))
        levels = self._levels(between("aerosol_density"))
        amount = self._grid.amount.copy()
        amount[:, :, :AEROSOLS] = layer_amounts(np.diff(levels.height), levels.density[:AEROSOLS])
        aerosol = AerosolLaws(extinction, absorption, held["phase_angle"], self._log_phase)
        return ScatteringAir.assembled(
            self._spectral, self._bands, levels, aerosol, held["source"][keep], self._grid._replace(amount=amount)
        )


def _renumbered(spectral: SpectralLaws, order: list[int]) -> Segments:
    """Bands of some channels, with the indices of their amounts among those of all channels."""
    segments, power, log = spectral.segments()
    own = spectral.columns
    segments[:, 0] = [order.index(own[place]) for place in segments[:, 0]]
    return Segments(segments, power, log)
