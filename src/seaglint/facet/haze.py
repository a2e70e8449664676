"""Scattered sunlight of path and sky in band, as images read it: rows of a scene against the azimuth from the Sun."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from seaglint.air.protocol import slant_range
from seaglint.air.scattering.scattered_light import ScatteredTable, path_map, sky_map
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, depression_of_range
from seaglint.base.jit import kernel, njit
from seaglint.facet.sea_view import SeaView

#: Number of azimuths from the Sun, uniform in the sine of their half: a third of a degree apart near the Sun, in its aureole.
AZIMUTHS: Final = 361

_AROUND: Final = 2.0 * np.arcsin(np.linspace(0.0, 1.0, AZIMUTHS))

PATH_ROWS: Final = 257  #: Number of paths to the sea, uniform in the logarithm of the slant path, as their own tables have them.


class Haze(NamedTuple):
    """Scattered radiance ``values[azimuth, row]`` [W m-2 sr-1] at even steps of the sine of half the azimuth from the Sun.

    The Sun stands at ``azimuth`` [rad]; without azimuths the radiance is 0.
    """

    values: np.ndarray
    azimuth: float


class SunlitPath(NamedTuple):
    """Scattered sunlight of the paths to some places: their rows of the table [1, (places,)]."""

    haze: Haze
    row: np.ndarray


NO_HAZE: Final = Haze(np.zeros((0, 0)), 0.0)  #: Haze of air that scatters nothing, or at night.


def is_dark(table: ScatteredTable) -> bool:
    """True if a table holds no light."""
    return not bool(table.amplitude.any())


@kernel
def haze_column(haze: Haze, azimuth: float) -> tuple[int, float]:
    """Lower azimuth node of a line of sight's azimuth [rad], and the fraction of the way to the next."""
    x = abs(math.sin(0.5 * (azimuth - haze.azimuth))) * (haze.values.shape[0] - 1)
    i = min(int(x), haze.values.shape[0] - 2)
    return i, x - i


@kernel
def haze_between(haze: Haze, column: tuple[int, float], row: float) -> float:
    """Radiance interpolated between four nodes [W m-2 sr-1]."""
    i, f = column
    j = min(int(row), haze.values.shape[1] - 2)
    g = row - j
    near = haze.values[i, j] + g * (haze.values[i, j + 1] - haze.values[i, j])
    far = haze.values[i + 1, j] + g * (haze.values[i + 1, j + 1] - haze.values[i + 1, j])
    return float(near + f * (far - near))


@njit
def path_along(radiance: np.ndarray, sunlit: SunlitPath, azimuth: float, part: tuple[int, int]) -> np.ndarray:
    """Path radiance of one line of sight [W m-2 sr-1, (places,)]: thermal ``radiance`` and scattered sunlight; only ``part`` is filled."""
    if sunlit.haze.values.shape[0] == 0:
        return radiance
    out = np.empty(radiance.shape[0])
    column = haze_column(sunlit.haze, azimuth)
    for i in range(part[0], min(part[1], radiance.shape[0])):
        out[i] = radiance[i] + haze_between(sunlit.haze, column, sunlit.row[i])
    return out


def sky_haze(view: SeaView, elevation: FloatArray) -> Haze:
    """Scattered sky seen from the sensor at elevations [rad, (rows,)]."""
    table = view.scattered.sky
    if is_dark(table) or elevation.size == 0:
        return NO_HAZE
    return Haze(np.ascontiguousarray(view.sun_distance_factor * sky_map(elevation, _AROUND, table).T), view.solar_azimuth)


def sunlit_path(view: SeaView, arcs: FloatArray) -> SunlitPath:
    """Scattered sunlight of the paths from the sensor to the sea at ascending arcs from its foot [m, (places,)]."""
    table = view.scattered.path
    if is_dark(table):
        return SunlitPath(NO_HAZE, np.zeros(0))
    height = view.sensor_height
    # the arcs of even steps in the logarithm of the slant path
    slant = height * (table.longest / height) ** np.linspace(0.0, 1.0, PATH_ROWS)
    ratio = np.maximum(slant**2 - height**2, 0.0) / (4.0 * EFFECTIVE_EARTH_RADIUS * (EFFECTIVE_EARTH_RADIUS + height))
    nodes = 2.0 * EFFECTIVE_EARTH_RADIUS * np.arcsin(np.sqrt(ratio))
    elevation = -depression_of_range(height, nodes)
    out = np.ascontiguousarray(view.sun_distance_factor * path_map(nodes, elevation, _AROUND, table).T)
    row = np.log(slant_range(height, arcs) / height) / math.log(table.longest / height) * (PATH_ROWS - 1)
    return SunlitPath(Haze(out, view.solar_azimuth), np.clip(row, 0.0, PATH_ROWS - 1.0))
