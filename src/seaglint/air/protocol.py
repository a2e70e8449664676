"""Interface of all atmospheres: spectra along a line of sight and of the sky in a direction, for a table, a cavity or vacuum.

All spectra are sampled on ``wavenumber_cm`` (ascending). Radiance is in W m-2 sr-1 per cm-1, irradiance in W m-2 per cm-1.
Paths are named by sensor height, by ``range_m``, the arc along the sea from the sensor's foot to the foot of the point looked at
(``seaglint.base.conventions``), and by the height of that point, because refraction makes angles a poor key near the horizon.

A point above the sea may be below, at or above the sensor's height, in front of sea or sky. Whether the sea hides it is decided by the
caller: the straight line over the effective Earth is followed down to ``DEEPEST_LINE`` below the mean sea, with air below the mean sea
as at the mean sea; deeper lines are refused. Paths to the sea itself (height 0) continue beyond the horizon.

An atmosphere from a file may contain sunlight scattered by the air, sampled for one Sun (``ScatteredSamples``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.coordinates import lowest_height
from seaglint.base.constants import DARK_SUN, EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

if TYPE_CHECKING:
    from seaglint.air.scattering.scattering_laws import ScatteringAir


#: Tolerance within which two zenith angles of the Sun are equal [rad]; at 85 deg scattered light changes by 1 % over it.
SAME_SUN = np.radians(0.1)

#: Tolerance within which angles outside a range count as on its edge [rad]: rounding of degrees, 2e-4 of the solar radius.
ANGLE_SLACK = 1e-6

DEEPEST_LINE = 100.0  #: Depth below the mean sea surface that lines to a point above the sea may reach [m]: more than any wave hides.

GRID_STEP_CM = 5.0  #: Spacing of LOWTRAN7's spectral samples [cm-1]; the default step of every atmosphere is a multiple of it.


@dataclass(frozen=True, eq=False)
class ScatteredSky:
    """Scattered sky at ``height`` [m] at ascending zenith angles [rad, (k,)]: radiance (k, a, n) [W m-2 sr-1 per cm-1]."""

    height: float
    zenith: FloatArray
    radiance: FloatArray


@dataclass(frozen=True, eq=False)
class ScatteredSamples:
    """Sunlight scattered into the line of sight, for one Sun at 1 au."""

    solar_zenith: float  #: Zenith angle of that Sun at the sensor's foot [rad].
    azimuth: FloatArray  #: Azimuths of the line of sight from the Sun [rad, (a,)], ascending within 0 to pi; the other side mirrors it.
    range_m: FloatArray  #: Arcs of the paths from the sea to the sensor, ascending [m, (k,)].
    path: FloatArray | None  #: Radiance of the paths [W m-2 sr-1 per cm-1, (k, a, n)].
    skies: tuple[ScatteredSky, ...] = ()  #: Skies at the sea (height 0) and at the sensor, as far as known.

    def require_sun(self, solar_zenith: float, name: str) -> None:
        """Refuse a Sun other than the one of the samples; one that is 6 deg below the horizon scatters nothing and is allowed.

        Raises
        ------
        DomainError
            The message names both zenith angles.
        """
        if solar_zenith < DARK_SUN and abs(solar_zenith - self.solar_zenith) > SAME_SUN:
            given, sampled = np.degrees(solar_zenith), np.degrees(self.solar_zenith)
            raise DomainError(
                f"solar zenith = {given:.4g} deg: {name} holds scattered sunlight of a Sun at {sampled:.4g} deg only (within 0.1 deg); "
                "set sun.zenith_deg to that, or make the file for this Sun, or leave path_scattered and sky_scattered out of it",
                name="solar_zenith",
                value=solar_zenith,
                allowed=(self.solar_zenith, self.solar_zenith),
            )


@runtime_checkable
class Atmosphere(Protocol):
    """Spectral transmittance, thermal path radiance, sunlight and sky between the sea and a sensor above it.

    An atmosphere inherits from :class:`ClearAir` the members that it does not define.
    """

    @property
    def wavenumber_cm(self) -> FloatArray:
        """Ascending spectral samples [cm-1, (n,)]."""
        ...

    @property
    def provenance(self) -> Mapping[str, Any]:
        """Names and digests of the sources of its spectra, for results; ``table`` is always present."""
        ...

    @property
    def sky_azimuths(self) -> int:
        """Number of even azimuths from north that sample the sky: 1 for a sky that is the same all round."""
        ...

    @property
    def scattered(self) -> ScatteredSamples | None:
        """Sunlight scattered by the air, sampled by the atmosphere's source; None without such samples."""
        ...

    def scattering(self, grid: slice) -> ScatteringAir | None:
        """Scatterers on part of the spectral samples, for computing scattered sunlight; None for air without scatterers."""
        ...

    def transmittance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Transmittance of the path from a point to the sensor [1, (..., n)].

        Parameters
        ----------
        height : float
            Sensor height [m].
        range_m : array_like
            Arc along the sea from the sensor's foot to the point's [m, (...)].
        target_height : array_like
            Height of the point above the mean sea [m], broadcast with ``range_m``; 0 is the sea.
        """
        ...

    def path_radiance(self, height: float, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
        """Thermal radiance of the same path at the sensor [W m-2 sr-1 per cm-1, (..., n)], without scattered sunlight."""
        ...

    def solar_irradiance(self, solar_zenith: ArrayLike) -> FloatArray:
        """Direct sunlight at the sea on a plane normal to the beam, Sun at 1 au [W m-2 per cm-1, (..., n)]; 0 below the horizon."""
        ...

    def sunlight_at(self, height: float, solar_zenith: float) -> FloatArray | None:
        """Direct sunlight at a height [W m-2 per cm-1, (n,)] by the apparent zenith angle there [rad]; None if it is not known."""
        ...

    def sky_radiance(self, zenith: ArrayLike, azimuth: ArrayLike, height: float = 0.0) -> FloatArray:
        """Thermal radiance of the sky [W m-2 sr-1 per cm-1, (..., n)].

        Parameters
        ----------
        zenith, azimuth : array_like
            Direction looked at: zenith angle, and azimuth clockwise from north [rad, (...)]; they broadcast.
        height : float
            Height looked from [m]; 0 is the sea.
        """
        ...


class ClearAir:
    """Members of an atmosphere that scatters no sunlight and whose sky is the same all round."""

    @property
    def sky_azimuths(self) -> int:
        """One azimuth samples the sky."""
        return 1

    @property
    def scattered(self) -> ScatteredSamples | None:
        """No samples of scattered sunlight."""
        return None

    def scattering(self, grid: slice) -> ScatteringAir | None:
        """No scatterers."""
        return None

    def sunlight_at(self, height: float, solar_zenith: float) -> FloatArray | None:
        """Direct sunlight at a height [W m-2 per cm-1, (n,)] by the apparent zenith angle there [rad]; None if known at the sea only."""
        return None


def wavenumber_grid(min_um: float, max_um: float, step_cm: float = GRID_STEP_CM) -> FloatArray:
    """Spectral grid of multiples of ``step_cm`` that covers the wavelengths ``min_um`` to ``max_um`` with both edges inside [cm-1, (n,)].

    >>> wavenumber_grid(3.0, 5.0)[[0, -1]]
    array([2000., 3335.])
    """
    if not 0.0 < min_um < max_um:
        raise DomainError(
            f"band {min_um:g}-{max_um:g} um is empty; give 0 < min_um < max_um",
            name="band_um",
            value=(min_um, max_um),
            allowed="0 < min_um < max_um",
        )
    # the tolerance keeps an edge on a multiple of the step on that multiple, whatever its rounding
    first = np.floor(1e4 / max_um / step_cm + 1e-9)
    last = np.ceil(1e4 / min_um / step_cm - 1e-9)
    return np.asarray(step_cm * np.arange(first, last + 1.0))


def slant_range(height: ArrayLike, range_m: ArrayLike, target_height: ArrayLike = 0.0) -> FloatArray:
    """Length of the straight path over the effective Earth from the sensor to a point at an arc ``range_m`` and a height [m].

    ``s^2 = (h - z)^2 + 4 (R' + z) (R' + h) sin^2(arc / 2R')``; at the sensor's foot it is the difference of the heights.
    """
    # by the sine of half the arc, which keeps the digits of short ranges
    half = np.asarray(range_m, dtype=np.float64) / (2.0 * EFFECTIVE_EARTH_RADIUS)
    h, z = (np.asarray(end, dtype=np.float64) for end in (height, target_height))
    across = 4.0 * (EFFECTIVE_EARTH_RADIUS + z) * (EFFECTIVE_EARTH_RADIUS + h) * np.sin(half) ** 2
    return np.asarray(np.sqrt((h - z) ** 2 + across))


def require_height(height: float, lowest: float, highest: float, remedy: str) -> None:
    """Refuse a sensor height outside ``[lowest, highest]`` [m]."""
    if not lowest <= height <= highest:
        raise DomainError(
            f"sensor height = {height:g} m is outside {lowest:g}-{highest:g} m of this atmosphere; {remedy}",
            name="sensor_height",
            value=height,
            allowed=(lowest, highest),
        )


def require_range(range_m: ArrayLike) -> FloatArray:
    """Return arcs along the sea as an array [m]; refuse negative or NaN ones."""
    arc = np.asarray(range_m, dtype=np.float64)
    if not np.all(arc >= 0.0):
        raise DomainError(
            f"range_m holds {np.asarray(arc)[~(arc >= 0.0)].ravel()[0]:g} m; give arcs along the sea of 0 m or more",
            name="range_m",
            value=float(arc[~(arc >= 0.0)].ravel()[0]),
            allowed="0 m or more",
        )
    return arc


def require_line(height: float, range_m: ArrayLike, target_height: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return arcs and heights of points as arrays of one shape [m]; refuse heights that are not finite and lines deep below the sea."""
    arc, target = np.broadcast_arrays(require_range(range_m), np.asarray(target_height, dtype=np.float64))
    if not np.all(np.isfinite(target)):
        raise DomainError(f"target_height holds {target[~np.isfinite(target)].ravel()[0]:g} m; give finite heights above the mean sea")
    lowest = lowest_height(height, target, slant_range(height, arc, target))
    deep = (lowest < -DEEPEST_LINE) & (target != 0.0)
    if deep.any():
        raise DomainError(
            f"the line from {height:g} m to target_height = {target[deep][0]:g} m at a range of {arc[deep][0]:g} m passes "
            f"{-lowest[deep][0]:.0f} m below the mean sea, more than {DEEPEST_LINE:g} m; leave out points that the sea hides"
        )
    return arc, target


def require_solar_zenith(solar_zenith: ArrayLike) -> FloatArray:
    """Return zenith angles of the Sun as an array [rad]; refuse those outside 0-pi."""
    zenith = np.asarray(solar_zenith, dtype=np.float64)
    inside = (zenith >= 0.0) & (zenith <= np.pi)
    if not np.all(inside):
        raise DomainError(
            "solar_zenith has values outside 0-pi rad; give zenith angles in radians",
            name="solar_zenith",
            value=float(zenith[~inside].ravel()[0]),
            allowed=(0.0, np.pi),
        )
    return zenith
