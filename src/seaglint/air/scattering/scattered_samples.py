"""Samples of sunlight scattered by the air, for one Sun: radiance of paths and sky over azimuth from the Sun."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

#: Tolerance within which two zenith angles of the Sun are equal [rad]; at 85 deg scattered light changes by 1 % over it.
SAME_SUN = np.radians(0.1)


@dataclass(frozen=True, eq=False)
class ScatteredSky:
    """Scattered sky seen from ``height`` [m] at ascending zenith angles [rad, (k,)]: radiance (k, a, n) [W m-2 sr-1 per cm-1]."""

    height: float
    zenith: FloatArray
    radiance: FloatArray


@dataclass(frozen=True, eq=False)
class ScatteredSamples:
    """Sunlight scattered into the line of sight, for one Sun at 1 au."""

    solar_zenith: float  #: Zenith angle of that Sun at the sensor's foot [rad].
    azimuth: FloatArray  #: Azimuths of the line of sight from the Sun, ascending within 0 to pi [rad]; the other side is the mirror image.
    range_m: FloatArray  #: Arcs of the paths from the sea to the sensor, ascending [m].
    path: FloatArray | None  #: Radiance of the paths [W m-2 sr-1 per cm-1].
    skies: tuple[ScatteredSky, ...] = ()  #: Seen from the sea (height 0) and from the sensor, those that are known.

    def require_sun(self, solar_zenith: float, name: str) -> None:
        """Refuse a Sun other than the one of the samples; one below the horizontal scatters nothing and is allowed.

        Raises
        ------
        DomainError
            Naming both.
        """
        if solar_zenith <= 0.5 * np.pi and abs(solar_zenith - self.solar_zenith) > SAME_SUN:
            given, held = np.degrees(solar_zenith), np.degrees(self.solar_zenith)
            raise DomainError(
                f"solar zenith = {given:.4g} deg: {name} holds scattered sunlight of a Sun at {held:.4g} deg only (within 0.1 deg); "
                "set sun.zenith_deg to that, or make the file for this Sun, or leave path_scattered and sky_scattered out of it",
                name="solar_zenith",
                value=solar_zenith,
                allowed=(self.solar_zenith, self.solar_zenith),
            )
