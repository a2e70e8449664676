"""Scattered sunlight of many cases with their own wind, height, direction and Sun, computed line by line without a table."""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Final

import numpy as np

from seaglint.air.profile.lowtran_numbers import lowtran_numbers
from seaglint.air.profile.profile_scattering import Scatterers, maritime, model_scatterers
from seaglint.air.scattering.scattered_line import KINDS, NO_SUNS, many_amplitudes
from seaglint.air.scattering.scattering_laws import scattering_angle
from seaglint.air.setting_sun import visible_part_kernel
from seaglint.base.conventions import FloatArray
from seaglint.optics.band import Band

_THREADS: Final = min(os.cpu_count() or 1, 4)

SCATTERED_UM: Final = (2.0, 5.5)  #: Wavelengths of bands whose scattered sunlight is computed [um]; in 7.5-14 um there is almost none.

_PARTS: Final = 8  #: Parts of the work for each thread.


def scattered_cases(model: str, lines: FloatArray, bands: Sequence[Band], *, continuous: bool = False) -> list[FloatArray]:
    """Scattered radiance of cases in bands, Sun at 1 au [W m-2 sr-1, (cases,)], in LOWTRAN7's layers or continuous, with its band laws.

    ``lines`` [(cases, 5)]: wind [m s-1], height [m], then elevation, azimuth from the Sun and the Sun's zenith angle without refraction at
    the sensor [rad]. A disc cut by the sea's horizon counts by the share that is up; a Sun below scatters nothing.
    """
    if not bands:
        return []
    grid = lowtran_numbers()["wavenumber_cm"]
    weights = np.array([band.weights(grid) for band in bands])
    used = weights.any(axis=0)
    table = model_scatterers(model, tuple(grid[used].tolist()), continuous=continuous, spectroscopy="lowtran7")
    weights = weights[:, used]
    out = np.empty((len(bands), len(lines)))
    size = max(-(-len(lines) // (_THREADS * _PARTS)), 1)

    def fill(first: int) -> None:
        for i in range(first, min(first + size, len(lines))):
            out[:, i] = weights @ _line(table, lines[i])

    with ThreadPoolExecutor(_THREADS) as pool:  # kernels release the interpreter
        list(pool.map(fill, range(0, len(lines), size)))
    return list(out)


def scatters_in(band_um: tuple[float, float]) -> bool:
    """True if scattered sunlight of a band [um] is computed."""
    return SCATTERED_UM[0] * (1.0 - 1e-9) <= band_um[0] and band_um[1] <= SCATTERED_UM[1] * (1.0 + 1e-9)


def _line(table: Scatterers, line: FloatArray) -> FloatArray:
    """Spectrum of scattered sunlight of one case [W m-2 sr-1 per cm-1, (n,)]."""
    wind, height, elevation, azimuth, zenith = (float(x) for x in line)
    air = table.with_haze(maritime(wind))
    share = visible_part_kernel(0.5 * math.pi - float(air.apparent_zenith(zenith)))[0]
    if share <= 0.0:
        return np.zeros(air.source.size)
    view = 0.5 * math.pi - elevation
    amplitude, arc = np.empty((1, KINDS, air.source.size)), np.empty(1)
    many_amplitudes(air.laws, 1e-3 * height, np.array([[view, azimuth, zenith]]), (0, 1), NO_SUNS, amplitude, arc)
    phase = air.phase(scattering_angle(view, azimuth, air.apparent_zenith(zenith, height)))
    return np.asarray(share * air.source * (phase * amplitude[0]).sum(axis=0))
