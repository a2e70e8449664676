"""Slow displacement of tiles over the sea, so that the sea does not repeat with the periods of its tiles.

::

    zeta(x) = sum_t zeta_t(x + d_t(x)),     d_t(x) = sum_j a_j sin(k_j.x + phi_j)

One period of a tile away the displacement is another one, by more than the length over which the tile's waves are correlated. It is
static, and belongs to the sea. Heights and slopes at a place are those of a place of the tile: their joint density stays as it is, and so
do all variances. Waves are stretched and turned by the gradient of the displacement, 2.5 % rms in each of its four parts on the first tile
and 5.5 % on the others.
"""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.random import stream
from seaglint.sea.tiles import Tile

#: Wave vectors [cycles per period of the tile] and amplitudes [periods] for the first tile, along its axes.
#:
#: Chosen by search: among waves of 3 to 14 periods, with gradients of 2.5 % rms, those that leave the least correlation at all lags of up
#: to 50 periods. Few of the tile's longest waves fit on it, and a picture shows few of its periods; crests of swell stay straight.
_LONG: Final = np.array(
    [
        (-0.0977, -0.0007, 0.0153, 0.0459),
        (-0.0683, -0.021, 0.0567, 0.0175),
        (-0.143, -0.2009, -0.0177, -0.0015),
        (0.008, -0.1963, -0.0148, -0.0215),
        (0.1524, -0.2499, -0.0084, 0.0132),
        (0.1013, -0.0735, -0.0237, 0.0226),
    ]
)

#: Waves for the other tiles.
#:
#: Chosen by search among waves of 1.5 to 13 periods with gradients of 5.5 % rms, their parts correlated by less than 0.05: those that leave
#: the least correlation at multiples of the period, within squares of one period too, where a displacement that hardly changes would leave
#: the tile in step with itself.
_SHORT: Final = np.array(
    [
        (0.1569, 0.1865, 0.0416, 0.0051),
        (0.2827, 0.303, 0.0076, -0.0234),
        (-0.3033, 0.4166, 0.0163, -0.0049),
        (-0.0188, 0.0758, -0.0842, -0.0384),
        (-0.1162, 0.4337, -0.0012, 0.0201),
        (-0.0893, 0.0196, 0.0563, -0.0761),
        (-0.6577, 0.0722, -0.0106, -0.0101),
        (-0.0788, 0.0741, -0.0179, -0.0426),
    ]
)


class Wander(NamedTuple):
    """Displacement of one tile, east and north: ``amplitude`` [m, (waves, 2)], ``wave_vector`` [rad m⁻¹, (waves, 2)], ``phase`` [rad]."""

    amplitude: FloatArray
    wave_vector: FloatArray
    phase: FloatArray

    @classmethod
    def of(cls, tile: Tile, seed: int, index: int) -> Wander:
        """Return the displacement of tile ``index``, with phases from ``stream(seed, "wander", index)``."""
        c, s = np.cos(tile.rotation), np.sin(tile.rotation)
        turn = np.array([[c, s], [-s, c]])
        waves = _LONG if index == 0 else _SHORT
        phase = 2.0 * np.pi * stream(seed, "wander", index).random(len(waves))
        return cls(tile.length * waves[:, 2:] @ turn, tile.step * waves[:, :2] @ turn, phase)

    def __call__(self, east: FloatArray, north: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Displacement towards east and north [m] at places of the sea [m]; arrays that broadcast against each other."""
        displacement = [np.zeros(np.broadcast_shapes(np.shape(east), np.shape(north))) for _ in range(2)]
        for amplitude, wave, phase in zip(*self, strict=True):
            sine = np.sin(wave[0] * east + wave[1] * north + phase)
            displacement[0] += amplitude[0] * sine
            displacement[1] += amplitude[1] * sine
        return displacement[0], displacement[1]

    def gradient(self, east: float, north: float) -> FloatArray:
        """Derivatives of the displacement (rows: east, north) towards east and north (columns) at a place [1, (2, 2)]."""
        cosine = np.cos(self.wave_vector @ np.array([east, north]) + self.phase)
        return np.asarray((self.amplitude * cosine[:, None]).T @ self.wave_vector)
