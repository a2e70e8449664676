r"""Scattered sunlight of path and sky for one Sun, tabulated for millions of directions.

.. math:: L(\nu) = \sum_r v_r(\nu) \sum_k \phi_k(\Theta)\, A_{kr}(\text{direction}, \text{Sun})

The phase functions are narrow (the aureole is some ten degrees wide) but functions of the scattering angle alone; the amplitudes are
smooth in elevation or range, in the cosine of the azimuth and in the Sun's zenith angle at the place. So each is tabulated for itself, the
angle every quarter of a degree. ``k`` counts shapes of phase function (some four do for all kinds of scatterer and wavenumbers), ``r``
spectral shapes.

Use
---
:func:`seaglint.atmosphere.scattered_tables.scattered_light` makes three tables. A map or an image adds, in band,

- ``path``: :func:`scattered_path_at` to the path radiance of every line of sight to the sea;
- ``sky``: :func:`scattered_sky_at` to the sky seen from the sensor, above the horizon;
- ``sea_sky``: the sky that a place on the sea sees, which facets mirror. Its elevation, azimuth and Sun are those against the vertical
  of the place. It has spectral shapes: as with :class:`seaglint.radiance.surface.SkyTable`, ``L = shares @ spectral``, so that sums over
  the band with reflectance and transmittance are taken of ``spectral`` once, and facets only need their few ``shares``
  (:func:`scattered_shares`). The shares depend on the azimuth from the Sun, unlike those of the thermal sky.

All are for the Sun at 1 au; multiply by ``1/d^2``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seaglint._jit import njit
from seaglint.atmosphere.coordinates import ELEVATION_SCALE
from seaglint.atmosphere.setting_sun import visible_part_kernel
from seaglint.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.conventions import FloatArray


class ScatteredTable(NamedTuple):
    """Scattered sunlight against direction and Sun.

    ``angular[i, k]``: phase functions' shapes at even steps of the scattering angle, ``amplitude[t, e, a, k, r]`` over the Sun's zenith
    angle, rows and even steps of the cosine of azimuth; ``spectral[r, n]``: spectral shapes [W m-2 sr-1 per cm-1], or a single 1 for
    radiance in band. Rows are those of :func:`sky_row` (``dip_rows`` of them below the horizontal, down to ``dip`` [rad]) or
    :func:`path_row` (``longest`` slant path [m]). ``sun``: apparent zenith angle [rad] of the first t, t per rad of it; 0 where the table
    is for one Sun alone, whose share above the horizon is then in the amplitudes.
    """

    angular: np.ndarray
    amplitude: np.ndarray
    spectral: np.ndarray
    sun: tuple[float, float]
    height: float
    longest: float
    dip: float
    dip_rows: int


@dataclass(frozen=True, eq=False)
class ScatteredLight:
    """Scattered sunlight of one band, wind, sensor height and Sun; see the module's notes.

    Attributes
    ----------
    path, sky : ScatteredTable
        In band [W m-2 sr-1]: one spectral shape, which is 1.
    sea_sky : ScatteredTable
        Spectra.
    """

    path: ScatteredTable
    sky: ScatteredTable
    sea_sky: ScatteredTable


@njit
def sky_row(elevation: float, table: ScatteredTable) -> float:
    """Row of an elevation [rad]: down to the horizon first, then up from the horizontal."""
    if elevation >= 0.0:
        scale = ELEVATION_SCALE
        above = table.amplitude.shape[1] - table.dip_rows
        y = math.asinh(elevation / scale) / math.asinh(0.5 * math.pi / scale)
        return float(table.dip_rows + min(y, 1.0) * (above - 1))
    if table.dip_rows == 0:
        return 0.0
    # The last row below the horizontal is the one before the horizontal's own.
    return float(max(table.dip_rows * (1.0 - math.sqrt(min(-elevation / table.dip, 1.0))), 0.0))


@njit
def path_row(range_m: float, table: ScatteredTable) -> float:
    """Row of an arc along the sea [m]; beyond the horizon that of the horizon."""
    half = math.sin(range_m / (2.0 * EFFECTIVE_EARTH_RADIUS))
    h = table.height
    slant = math.sqrt(h * h + 4.0 * EFFECTIVE_EARTH_RADIUS * (EFFECTIVE_EARTH_RADIUS + h) * half * half)
    x = math.log(max(slant / h, 1.0)) / math.log(table.longest / h)
    return float(min(x, 1.0) * (table.amplitude.shape[1] - 1))


@njit
def shares_at(row: float, elevation: float, azimuth: float, solar_zenith: float, table: ScatteredTable, out: np.ndarray) -> None:
    """Shares of the spectral shapes into ``out`` [(r,)] at a row; azimuth is counted from the Sun, zenith the Sun's apparent one [rad]."""
    half, lean = math.sin(0.5 * azimuth), math.sin(0.5 * (0.5 * math.pi - elevation - solar_zenith))
    square = min(lean * lean + math.cos(elevation) * math.sin(solar_zenith) * half * half, 1.0)
    angle = 2.0 * math.asin(math.sqrt(max(square, 0.0))) / math.pi * (table.angular.shape[0] - 1)
    i = min(int(angle), table.angular.shape[0] - 2)
    f = angle - i
    suns, rows, columns, shapes, spectra = table.amplitude.shape
    t = min(max((solar_zenith - table.sun[0]) * table.sun[1], 0.0), suns - 1.0)
    column = half * half * (columns - 1)
    it, ie, ia = min(int(t), max(suns - 2, 0)), min(int(row), rows - 2), min(int(column), columns - 2)
    ft, fe, fa = t - it, row - ie, column - ia
    share = visible_part_kernel(0.5 * math.pi - solar_zenith)[0] if table.sun[1] > 0.0 else 1.0
    out[:] = 0.0
    for dt in range(2 if ft > 0.0 else 1):
        for de in range(2):
            for da in range(2):
                weight = share * (ft if dt else 1.0 - ft) * (fe if de else 1.0 - fe) * (fa if da else 1.0 - fa)
                for k in range(shapes):
                    phase = weight * ((1.0 - f) * table.angular[i, k] + f * table.angular[i + 1, k])
                    for r in range(spectra):
                        out[r] += phase * table.amplitude[it + dt, ie + de, ia + da, k, r]


@njit
def scattered_sky_at(elevation: float, azimuth: float, table: ScatteredTable) -> float:
    """Sky of a table in band [W m-2 sr-1] at an elevation and an azimuth from the Sun [rad], for the Sun it was made for."""
    out = np.zeros(table.amplitude.shape[4])
    shares_at(sky_row(elevation, table), elevation, azimuth, table.sun[0], table, out)
    return float(max(out[0], 0.0))


@njit
def scattered_path_at(range_m: float, elevation: float, azimuth: float, table: ScatteredTable) -> float:
    """Path to the sea at an arc [m], seen at an elevation (below 0) and an azimuth from the Sun [rad], in band [W m-2 sr-1]."""
    out = np.zeros(table.amplitude.shape[4])
    shares_at(path_row(range_m, table), elevation, azimuth, table.sun[0], table, out)
    return float(max(out[0], 0.0))


@njit
def _fill(elevation: np.ndarray, azimuth: np.ndarray, solar_zenith: np.ndarray, table: ScatteredTable, out: np.ndarray) -> None:
    for i in range(elevation.size):
        shares_at(sky_row(elevation[i], table), elevation[i], azimuth[i], solar_zenith[i], table, out[i])


@njit
def _fill_path(range_m: np.ndarray, elevation: np.ndarray, azimuth: np.ndarray, table: ScatteredTable, out: np.ndarray) -> None:
    for i in range(elevation.size):
        shares_at(path_row(range_m[i], table), elevation[i], azimuth[i], table.sun[0], table, out[i])


def scattered_shares(
    elevation: ArrayLike, azimuth_from_sun: ArrayLike, table: ScatteredTable, solar_zenith: ArrayLike | None = None
) -> FloatArray:
    """Shares of the spectral shapes of a sky [1, (..., r)]: ``L = shares @ table.spectral``.

    ``solar_zenith`` [rad] is the Sun's at the place, where the table was made for several; all broadcast.
    """
    zenith = table.sun[0] if solar_zenith is None else solar_zenith
    e, a, z = np.broadcast_arrays(*(np.asarray(x, dtype=np.float64) for x in (elevation, azimuth_from_sun, zenith)))
    out = np.empty((e.size, table.amplitude.shape[4]))
    _fill(e.ravel(), a.ravel(), z.ravel(), table, out)
    return out.reshape(*e.shape, -1)


def scattered_path(range_m: ArrayLike, elevation: ArrayLike, azimuth_from_sun: ArrayLike, table: ScatteredTable) -> FloatArray:
    """Paths to the sea in band [W m-2 sr-1, (...)]; see :func:`scattered_path_at`."""
    s, e, a = np.broadcast_arrays(*(np.asarray(x, dtype=np.float64) for x in (range_m, elevation, azimuth_from_sun)))
    out = np.empty((e.size, table.amplitude.shape[4]))
    _fill_path(s.ravel(), e.ravel(), a.ravel(), table, out)
    return np.maximum(out[:, 0], 0.0).reshape(e.shape)


def in_band(table: ScatteredTable, weights: ArrayLike) -> ScatteredTable:
    """The same sky as radiance in band [W m-2 sr-1], for quadrature weights on the channels [cm-1, (n,)]."""
    amplitude = table.amplitude @ (table.spectral @ np.asarray(weights, dtype=np.float64))
    return table._replace(amplitude=np.ascontiguousarray(amplitude[..., None]), spectral=np.ones((1, 1)))
