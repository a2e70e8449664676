"""Sky of a view: the one place that asks the air for it.

Pictures see it from the sensor, :func:`sky_above`, mean maps its thermal part, :func:`thermal_sky`: both over azimuth and elevation,
whatever the air. Facets and bodies mirror the sky that is seen from the sea, :func:`mirrored_sky`; their tables know its zenith angle
alone. The Sun's disc in the sky is that of :mod:`seaglint.imaging.sun_in_sky`.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.air.protocol import Atmosphere
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel
from seaglint.facet.haze import NO_HAZE, Haze, haze_between, haze_column, sky_haze
from seaglint.facet.sea_view import SeaView


class SkyAbove(NamedTuple):
    """Sky over rows of elevations [W m-2 sr-1].

    The fields are the thermal sky at even azimuths from north [(azimuths, rows)], and its scattered sunlight.
    """

    thermal: np.ndarray
    haze: Haze


NO_SKY: Final = SkyAbove(np.zeros((1, 0)), NO_HAZE)  #: Sky without rows.


def thermal_sky(view: SeaView, elevation: FloatArray) -> FloatArray:
    """Thermal sky that the sensor sees, at even azimuths from north and at elevations [W m-2 sr-1, (azimuths, rows)].

    Elevations are angles above the horizontal, down to the sea horizon [rad, (rows,)].
    """
    air, zenith = view.atmosphere, 0.5 * np.pi - elevation
    turns = 2.0 * np.pi * np.arange(air.sky_azimuths) / air.sky_azimuths
    # azimuth by azimuth: spectra of all of them at once take gigabytes
    return np.stack([view.in_band(air.sky_radiance(zenith, azimuth, view.sensor_height)) for azimuth in turns])


def sky_above(view: SeaView, elevation: FloatArray) -> SkyAbove:
    """Sky that the sensor sees at elevations [rad, (rows,)], without the Sun's disc."""
    return SkyAbove(thermal_sky(view, elevation), sky_haze(view, elevation)) if elevation.size else NO_SKY


def mirrored_sky(atmosphere: Atmosphere, zenith: ArrayLike, grid: slice = slice(None)) -> FloatArray:
    """Thermal sky seen from the sea at zenith angles [W m-2 sr-1 per cm-1, (..., n)], its mean over azimuth, on part of the samples."""
    count = atmosphere.sky_azimuths
    total = atmosphere.sky_radiance(zenith, 0.0)[..., grid]
    for turn in range(1, count):
        total = total + atmosphere.sky_radiance(zenith, 2.0 * np.pi * turn / count)[..., grid]
    return np.asarray(total / count if count > 1 else total)


@kernel
def sky_column(sky: SkyAbove, azimuth: float) -> tuple[int, float]:
    """Azimuth node before an azimuth [rad], and the fraction of the way to the next."""
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
    """Values of :func:`thermal_sky` at azimuths [rad] and rows, which broadcast [W m-2 sr-1]."""
    count = thermal.shape[0]
    at = azimuth / (2.0 * np.pi) * count % count
    first = np.minimum(at.astype(np.int64), count - 1)
    near = thermal[first, row]
    return np.asarray(near + (at - first) * (thermal[(first + 1) % count, row] - near))
