r"""Scattered sunlight of path and sky for one Sun, tabulated for millions of directions.

.. math:: L(\nu) = \sum_r v_r(\nu) \sum_k \phi_k(\Theta)\, A_{kr}(\text{direction}, \text{Sun})

The phase functions are narrow (the aureole is some ten degrees wide) but functions of the scattering angle alone; the amplitudes are
smooth in elevation or range, in the cosine of the azimuth and in the Sun's zenith angle at the place. So each is tabulated separately, the
angle every quarter of a degree. ``k`` counts shapes of phase function (some four do for all kinds of scatterer and wavenumbers), ``r``
spectral shapes.

Use
---
``seaglint.air.scattering.scattered_tables.ScatteredLight`` makes three tables. A map or an image adds, in band,

- ``path``: ``scattered_path_at`` to the path radiance of every line of sight to the sea;
- ``sky``: ``scattered_sky_at`` to the sky above the sensor's horizon;
- ``sea_sky``: the sky above a place on the sea, which facets mirror. Its elevation, azimuth and Sun are relative to the vertical
  of the place. It has spectral shapes: as with ``seaglint.facet.surface_spectra.SkyTable``, ``L = shares @ spectral``, so that sums
  over the band with reflectance and transmittance are taken of ``spectral`` once, and facets only need their few ``shares``
  (``scattered_shares``). Unlike the shares of the thermal sky they depend on the azimuth from the Sun.

Kernels make no arrays, so that the renderer's kernels can call them.

All results are for the Sun at 1 au; multiply by ``1/d^2``.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.coordinates import ELEVATION_SCALE
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import in_threads, kernel, njit


class ScatteredTable(NamedTuple):
    """Scattered sunlight against direction and Sun.

    ``angular[i, k]``: phase functions' shapes at even steps of the scattering angle, ``amplitude[t, e, a, k, r]`` over the Sun's zenith
    angle, rows and even steps of the cosine of azimuth; ``spectral[r, n]``: spectral shapes [W m-2 sr-1 per cm-1], or a single 1 for
    radiance in band. Rows are counted by ``sky_row`` (``dip_rows`` of them below the horizontal, down to ``dip`` [rad]) or
    ``path_row`` (``longest`` slant path [m]). ``solar_zenith`` [rad] is the Sun's apparent one at the sensor, or at its foot for sky
    over the sea. Only there the Sun differs between places: ``suns`` is the first zenith angle and t per rad of it.
    """

    angular: np.ndarray
    amplitude: np.ndarray
    spectral: np.ndarray
    solar_zenith: float
    suns: tuple[float, float]
    height: float
    longest: float
    dip: float
    dip_rows: int


#: Table of air that scatters nothing.
DARK: Final = ScatteredTable(np.zeros((2, 1)), np.zeros((1, 2, 2, 1, 1)), np.zeros((1, 1)), 0.0, (0.0, 0.0), 1.0, 2.0, 1.0, 0)


@kernel
def sky_row(elevation: float, table: ScatteredTable) -> float:
    """Row of an elevation [rad]: rows down to the horizon first, then up from the horizontal."""
    if elevation >= 0.0:
        above = table.amplitude.shape[1] - table.dip_rows
        y = math.asinh(elevation / ELEVATION_SCALE) / math.asinh(0.5 * math.pi / ELEVATION_SCALE)
        return float(table.dip_rows + min(y, 1.0) * (above - 1))
    if table.dip_rows == 0:
        return 0.0
    # The last row below the horizontal precedes the horizontal's row.
    return float(max(table.dip_rows * (1.0 - math.sqrt(min(-elevation / table.dip, 1.0))), 0.0))


@kernel
def path_row(range_m: float, table: ScatteredTable) -> float:
    """Row of an arc along the sea [m]; beyond the horizon the row of the horizon."""
    half = math.sin(range_m / (2.0 * EFFECTIVE_EARTH_RADIUS))
    h = table.height
    slant = math.sqrt(h * h + 4.0 * EFFECTIVE_EARTH_RADIUS * (EFFECTIVE_EARTH_RADIUS + h) * half * half)
    x = math.log(max(slant / h, 1.0)) / math.log(table.longest / h)
    return float(min(x, 1.0) * (table.amplitude.shape[1] - 1))


@kernel
def angle_node(elevation: float, azimuth: float, solar_zenith: float, table: ScatteredTable) -> tuple[int, float]:
    """Node of the scattering angle, and the fraction to the next one."""
    half, lean = math.sin(0.5 * azimuth), math.sin(0.5 * (0.5 * math.pi - elevation - solar_zenith))
    # sin^2 of half the scattering angle by half angles, which keep their digits in the aureole
    square = min(max(lean * lean + math.cos(elevation) * math.sin(solar_zenith) * half * half, 0.0), 1.0)
    angle = 2.0 * math.asin(math.sqrt(square)) / math.pi * (table.angular.shape[0] - 1)
    i = min(int(angle), table.angular.shape[0] - 2)
    return i, angle - i


@kernel
def node_at(row: float, azimuth: float, solar_zenith: float, table: ScatteredTable) -> tuple[int, int, int, float, float, float]:
    """Nodes of the table before a Sun, a row and an azimuth, and how far beyond them it is [steps]."""
    suns, rows, columns = table.amplitude.shape[0], table.amplitude.shape[1], table.amplitude.shape[2]
    half = math.sin(0.5 * azimuth)
    column = half * half * (columns - 1)
    e, a = min(int(row), rows - 2), min(int(column), columns - 2)
    x = min(max((solar_zenith - table.suns[0]) * table.suns[1], 0.0), suns - 1.0)
    t = min(int(x), max(suns - 2, 0))
    return t, e, a, x - t, row - e, column - a


@kernel
def term_at(node: tuple[int, int, int, float, float, float], table: ScatteredTable, k: int, r: int) -> float:
    """Amplitude of one phase shape and spectral shape, interpolated between the nodes around a row, an azimuth and a Sun."""
    t, e, a, ft, fe, fa = node
    value = (1.0 - fe) * ((1.0 - fa) * table.amplitude[t, e, a, k, r] + fa * table.amplitude[t, e, a + 1, k, r])
    value += fe * ((1.0 - fa) * table.amplitude[t, e + 1, a, k, r] + fa * table.amplitude[t, e + 1, a + 1, k, r])
    if ft > 0.0:
        t += 1
        later = (1.0 - fe) * ((1.0 - fa) * table.amplitude[t, e, a, k, r] + fa * table.amplitude[t, e, a + 1, k, r])
        later += fe * ((1.0 - fa) * table.amplitude[t, e + 1, a, k, r] + fa * table.amplitude[t, e + 1, a + 1, k, r])
        value += ft * (later - value)
    return float(value)


@kernel
def share_at(row: float, elevation: float, azimuth: float, solar_zenith: float, table: ScatteredTable, r: int) -> float:
    """Share of one spectral shape at a row; azimuth is counted from the Sun, ``solar_zenith`` is the Sun's apparent one [rad]."""
    i, f = angle_node(elevation, azimuth, solar_zenith, table)
    node = node_at(row, azimuth, solar_zenith, table)
    total = 0.0
    for k in range(table.angular.shape[1]):
        phase = (1.0 - f) * table.angular[i, k] + f * table.angular[i + 1, k]
        total += phase * term_at(node, table, k, r)
    return float(total)


@kernel
def shares_at(row: float, elevation: float, azimuth: float, solar_zenith: float, table: ScatteredTable, out: np.ndarray) -> None:
    """Compute ``share_at`` of all spectral shapes ``out[r]``: the nodes around are looked up once."""
    i, f = angle_node(elevation, azimuth, solar_zenith, table)
    node = node_at(row, azimuth, solar_zenith, table)
    for r in range(out.shape[0]):
        out[r] = 0.0
    for k in range(table.angular.shape[1]):
        phase = (1.0 - f) * table.angular[i, k] + f * table.angular[i + 1, k]
        for r in range(out.shape[0]):
            out[r] += phase * term_at(node, table, k, r)


@kernel
def scattered_sky_at(elevation: float, azimuth: float, table: ScatteredTable) -> float:
    """Scattered sky radiance in band [W m-2 sr-1] at an elevation and an azimuth from the Sun [rad], under the Sun at the sensor."""
    return max(share_at(sky_row(elevation, table), elevation, azimuth, table.solar_zenith, table, 0), 0.0)


@kernel
def scattered_path_at(range_m: float, elevation: float, azimuth: float, table: ScatteredTable) -> float:
    """Scattered path radiance in band [W m-2 sr-1] to the sea at an arc [m].

    The path has an elevation (below 0) and an azimuth from the Sun [rad] at the sensor.
    """
    return max(share_at(path_row(range_m, table), elevation, azimuth, table.solar_zenith, table, 0), 0.0)


@njit
def _fill_sky_map(rows: tuple[int, int], elevation: np.ndarray, azimuth: np.ndarray, table: ScatteredTable, out: np.ndarray) -> None:
    for i in range(rows[0], rows[1]):
        for j in range(azimuth.size):
            out[i, j] = scattered_sky_at(elevation[i], azimuth[j], table)


@njit
def _fill_path_map(
    rows: tuple[int, int], range_m: np.ndarray, elevation: np.ndarray, azimuth: np.ndarray, table: ScatteredTable, out: np.ndarray
) -> None:
    for i in range(rows[0], rows[1]):
        for j in range(azimuth.size):
            out[i, j] = scattered_path_at(range_m[i], elevation[i], azimuth[j], table)


def sky_map(elevation: FloatArray, azimuth_from_sun: FloatArray, table: ScatteredTable) -> FloatArray:
    """Scattered sky radiance in band at elevations (rows) and azimuths (columns) [rad]: [W m-2 sr-1, (rows, columns)], in threads."""
    out = np.empty((elevation.size, azimuth_from_sun.size))
    if elevation.size > 0:
        in_threads(lambda rows: _fill_sky_map(rows, elevation, azimuth_from_sun, table, out), elevation.size)
    return out


def path_map(range_m: FloatArray, elevation: FloatArray, azimuth_from_sun: FloatArray, table: ScatteredTable) -> FloatArray:
    """Scattered paths to the sea in band, by ``scattered_path_at`` in threads.

    Arcs [m] belong to elevations (rows); columns are azimuths [rad].
    """
    out = np.empty((range_m.size, azimuth_from_sun.size))
    if range_m.size > 0:
        in_threads(lambda rows: _fill_path_map(rows, range_m, elevation, azimuth_from_sun, table, out), range_m.size)
    return out


@njit
def _fill(elevation: np.ndarray, azimuth: np.ndarray, solar_zenith: np.ndarray, table: ScatteredTable, out: np.ndarray) -> None:
    for i in range(elevation.size):
        row = sky_row(elevation[i], table)
        for r in range(out.shape[1]):
            out[i, r] = share_at(row, elevation[i], azimuth[i], solar_zenith[i], table, r)


@njit
def _fill_path(range_m: np.ndarray, elevation: np.ndarray, azimuth: np.ndarray, table: ScatteredTable, out: np.ndarray) -> None:
    for i in range(elevation.size):
        out[i, 0] = share_at(path_row(range_m[i], table), elevation[i], azimuth[i], table.solar_zenith, table, 0)


@njit
def amplitudes_at(elevation: np.ndarray, table: ScatteredTable, out: np.ndarray) -> None:
    """Amplitudes ``out[t, j, a, k, r]`` of a table at elevations [rad, (j,)], interpolated between its rows."""
    suns, rows, columns, shapes, spectra = table.amplitude.shape
    for j in range(elevation.size):
        row = sky_row(elevation[j], table)
        e = min(int(row), rows - 2)
        f = row - e
        for t in range(suns):
            for a in range(columns):
                for k in range(shapes):
                    for r in range(spectra):
                        out[t, j, a, k, r] = (1.0 - f) * table.amplitude[t, e, a, k, r] + f * table.amplitude[t, e + 1, a, k, r]


def scattered_shares(
    elevation: ArrayLike, azimuth_from_sun: ArrayLike, table: ScatteredTable, solar_zenith: ArrayLike | None = None
) -> FloatArray:
    """Shares of the spectral shapes of a sky [1, (..., r)]: ``L = shares @ table.spectral``.

    ``solar_zenith`` [rad] is the Sun's at the place, by default at the sensor; all broadcast.
    """
    zenith = table.solar_zenith if solar_zenith is None else solar_zenith
    e, a, z = np.broadcast_arrays(*(np.asarray(x, dtype=np.float64) for x in (elevation, azimuth_from_sun, zenith)))
    out = np.empty((e.size, table.amplitude.shape[4]))
    _fill(e.ravel(), a.ravel(), z.ravel(), table, out)
    return out.reshape(*e.shape, -1)


def scattered_path(range_m: ArrayLike, elevation: ArrayLike, azimuth_from_sun: ArrayLike, table: ScatteredTable) -> FloatArray:
    """Scattered path radiance to the sea in band [W m-2 sr-1, (...)]; see ``scattered_path_at``."""
    s, e, a = np.broadcast_arrays(*(np.asarray(x, dtype=np.float64) for x in (range_m, elevation, azimuth_from_sun)))
    out = np.empty((e.size, table.amplitude.shape[4]))
    _fill_path(s.ravel(), e.ravel(), a.ravel(), table, out)
    return np.maximum(out[:, 0], 0.0).reshape(e.shape)
