"""Sky of a view: its thermal radiance and scattered sunlight, for the sensor and for the sea that mirrors it.

All requests to the air for its sky are made here.

- ``sky_above``: thermal and scattered sky above the sensor, over azimuth and elevation, for images.
- ``thermal_sky``: its thermal part alone, for mean maps.
- ``mirrored_sky``: thermal sky above the sea, which facets and bodies mirror; their tables depend on the zenith angle alone.
- ``sunlit_path``: scattered sunlight of paths in band, against the azimuth from the Sun.

The Sun's disc in the sky is in ``seaglint.imaging.sun_in_sky``.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.air.protocol import Atmosphere, slant_range
from seaglint.air.scattering.scattered_light import ScatteredTable, path_map, sky_map
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, depression_of_range
from seaglint.base.jit import kernel, njit
from seaglint.facet.sea_view import SeaView

#: Number of azimuths from the Sun, uniform in the sine of their half: a third of a degree apart near the Sun, in its aureole.
AZIMUTHS: Final = 361

_AROUND: Final = 2.0 * np.arcsin(np.linspace(0.0, 1.0, AZIMUTHS))

PATH_ROWS: Final = 257  #: Number of paths to the sea, uniform in the logarithm of the slant path, as in the tables of scattered paths.


class Haze(NamedTuple):
    """Scattered radiance ``values[azimuth, row]`` [W m-2 sr-1] at even steps of the sine of half the azimuth from the Sun.

    ``azimuth`` is the Sun's [rad]; without azimuths the radiance is 0.
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
    """Lower azimuth node of a line of sight's azimuth [rad], and the fraction of the step to the next node."""
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
    """Scattered sky above the sensor at elevations [rad, (rows,)]."""
    table = view.scattered.sky
    if is_dark(table) or elevation.size == 0:
        return NO_HAZE
    return Haze(np.ascontiguousarray(view.sun_distance_factor * sky_map(elevation, _AROUND, table).T), view.solar_azimuth)


def sunlit_path(view: SeaView, arcs: FloatArray, azimuths: tuple[float, float]) -> SunlitPath:
    """Scattered sunlight of the paths from the sensor to the sea at ascending arcs from its foot [m, (places,)].

    The haze is computed for lines of sight between two ``azimuths`` [rad]; it is not a number at others.
    """
    table = view.scattered.path
    if is_dark(table):
        return SunlitPath(NO_HAZE, np.zeros(0))
    height = view.sensor_height
    # the arcs of even steps in the logarithm of the slant path
    slant = height * (table.longest / height) ** np.linspace(0.0, 1.0, PATH_ROWS)
    ratio = np.maximum(slant**2 - height**2, 0.0) / (4.0 * EFFECTIVE_EARTH_RADIUS * (EFFECTIVE_EARTH_RADIUS + height))
    nodes = 2.0 * EFFECTIVE_EARTH_RADIUS * np.arcsin(np.sqrt(ratio))
    elevation = -depression_of_range(height, nodes)
    out, seen = (
        np.full((AZIMUTHS, PATH_ROWS), np.nan),
        _azimuths_between(azimuths[0] - view.solar_azimuth, azimuths[1] - view.solar_azimuth),
    )
    out[seen] = view.sun_distance_factor * path_map(nodes, elevation, _AROUND[seen], table).T
    row = np.log(slant_range(height, arcs) / height) / math.log(table.longest / height) * (PATH_ROWS - 1)
    return SunlitPath(Haze(out, view.solar_azimuth), np.clip(row, 0.0, PATH_ROWS - 1.0))


def _azimuths_between(first: float, last: float) -> slice:
    """Nodes of a haze that are read between two azimuths from the Sun [rad], and one more on each side."""
    ends = np.abs(np.sin([0.5 * first, 0.5 * last]))
    # half the azimuth passes the Sun at multiples of pi, and the place opposite to it in between
    sun, opposite = (math.floor(0.5 * last / math.pi + shift) > math.floor(0.5 * first / math.pi + shift) for shift in (0.0, 0.5))
    least, most = 0.0 if sun else float(ends.min()), 1.0 if opposite else float(ends.max())
    return slice(max(math.floor(least * (AZIMUTHS - 1)) - 1, 0), math.ceil(most * (AZIMUTHS - 1)) + 2)


class SkyAbove(NamedTuple):
    """Sky over rows of elevations [W m-2 sr-1].

    The fields are the thermal sky at even azimuths from north [(azimuths, rows)], and its scattered sunlight.
    """

    thermal: np.ndarray
    haze: Haze


NO_SKY: Final = SkyAbove(np.zeros((1, 0)), NO_HAZE)  #: Sky without rows.


def thermal_sky(view: SeaView, elevation: FloatArray) -> FloatArray:
    """Thermal sky above the sensor, at even azimuths from north and at elevations [W m-2 sr-1, (azimuths, rows)].

    Elevations are angles above the horizontal, down to the sea horizon [rad, (rows,)].
    """
    air, zenith = view.atmosphere, 0.5 * np.pi - elevation
    turns = 2.0 * np.pi * np.arange(air.sky_azimuths) / air.sky_azimuths
    # azimuth by azimuth: spectra of all of them at once take gigabytes
    return np.stack([view.in_band(air.sky_radiance(zenith, azimuth, view.sensor_height)) for azimuth in turns])


def sky_above(view: SeaView, elevation: FloatArray) -> SkyAbove:
    """Sky above the sensor at elevations [rad, (rows,)], without the Sun's disc."""
    return SkyAbove(thermal_sky(view, elevation), sky_haze(view, elevation)) if elevation.size else NO_SKY


def mirrored_sky(atmosphere: Atmosphere, zenith: ArrayLike, grid: slice = slice(None)) -> FloatArray:
    """Thermal sky above the sea at zenith angles [W m-2 sr-1 per cm-1, (..., n)], its mean over azimuth, on part of the samples."""
    count = atmosphere.sky_azimuths
    total = atmosphere.sky_radiance(zenith, 0.0)[..., grid]
    for turn in range(1, count):
        total = total + atmosphere.sky_radiance(zenith, 2.0 * np.pi * turn / count)[..., grid]
    return np.asarray(total / count if count > 1 else total)


@kernel
def sky_column(sky: SkyAbove, azimuth: float) -> tuple[int, float]:
    """Azimuth node before an azimuth [rad], and the fraction of the step to the next node."""
    count = sky.thermal.shape[0]
    turns = azimuth / (2.0 * math.pi)
    x = (turns - math.floor(turns)) * count
    i = min(int(x), count - 1)
    return i, x - i


@kernel
def thermal_between(sky: SkyAbove, column: tuple[int, float], row: float) -> float:
    """Thermal sky interpolated between nodes [W m-2 sr-1]."""
    i, f = column
    j = min(int(row), sky.thermal.shape[1] - 2)
    g = row - j
    near = (1.0 - g) * sky.thermal[i, j] + g * sky.thermal[i, j + 1]
    if sky.thermal.shape[0] > 1:
        k = i + 1 if i + 1 < sky.thermal.shape[0] else 0
        near += f * ((1.0 - g) * sky.thermal[k, j] + g * sky.thermal[k, j + 1] - near)
    return float(near)


@kernel
def sky_between(sky: SkyAbove, azimuth: float, row: float) -> float:
    """Thermal sky and scattered sunlight interpolated between nodes [W m-2 sr-1]."""
    total = thermal_between(sky, sky_column(sky, azimuth), row)
    if sky.haze.values.shape[0] > 0:
        total += haze_between(sky.haze, haze_column(sky.haze, azimuth), row)
    return total


def thermal_at(thermal: FloatArray, azimuth: FloatArray, row: NDArray[np.int64]) -> FloatArray:
    """Values of ``thermal_sky`` at azimuths [rad] and rows, which broadcast [W m-2 sr-1]."""
    count = thermal.shape[0]
    at = azimuth / (2.0 * np.pi) * count % count
    first = np.minimum(at.astype(np.int64), count - 1)
    near = thermal[first, row]
    return np.asarray(near + (at - first) * (thermal[(first + 1) % count, row] - near))
