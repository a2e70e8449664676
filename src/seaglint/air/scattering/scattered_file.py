"""Scattered sunlight of a user's calculation, as the tables of :mod:`seaglint.air.scattering.scattered_light`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
from scipy.interpolate import PchipInterpolator

from seaglint.air.coordinates import elevation_of_coordinate
from seaglint.air.protocol import slant_range
from seaglint.air.scattering.scattered_light import DARK, ScatteredTable
from seaglint.air.scattering.scattered_samples import ScatteredSamples, ScatteredSky
from seaglint.air.scattering.scattering_laws import scattering_angle
from seaglint.base.conventions import FloatArray, depression_of_range, horizon_depression

ANGLES: Final = 721
COLUMNS: Final = 65
ROWS: Final = 257
DIP_ROWS: Final = 64

#: Height [m] up to which the sky below the horizontal is the horizontal's.
#:
#: LOWTRAN7 makes the sensor's height a level, and the thin layer below it, with another air, would draw a line above the sea.
LOW: Final = 300.0

_RANK: Final = 1e-4  #: Relative singular value of the spectra below which components are dropped.


@dataclass(frozen=True, eq=False)
class SampledLight:
    """Scattered sunlight of a file, for its one Sun; as :class:`seaglint.air.scattering.scattered_tables.ScatteredLight`.

    Radiance is split into a function of the scattering angle, which has the aureole, and what is left, which is smooth and interpolated
    linearly between the file's directions. What the file leaves out is dark.
    """

    samples: ScatteredSamples
    grid: slice
    weights: FloatArray
    height: float

    @property
    def is_dark(self) -> bool:
        """True if nothing is scattered."""
        return False

    @cached_property
    def path(self) -> ScatteredTable:
        """Table of scattered path radiance to the sea, in band."""
        held, samples = self.samples.path, self.samples
        if held is None:
            return DARK
        slant = slant_range(self.height, samples.range_m)
        longest = float(max(slant[-1], 1.001 * self.height))
        even = self.height * (longest / self.height) ** np.linspace(0.0, 1.0, ROWS)
        zenith = 0.5 * np.pi + depression_of_range(self.height, samples.range_m)
        table = self._table(zenith, held[..., self.grid] @ self.weights, np.log(slant), np.log(even))
        return table._replace(height=self.height, longest=longest)

    @cached_property
    def sky(self) -> ScatteredTable:
        """Table of the scattered sky seen from the sensor, in band."""
        held = self._sky_from(self.height)
        if held is None:
            return DARK
        dip = horizon_depression(self.height)
        below = -dip * (1.0 - np.arange(DIP_ROWS) / DIP_ROWS) ** 2
        rows = 0.5 * np.pi - np.concatenate([below if self.height > LOW else 0.0 * below, self._elevations])
        table = self._table(held.zenith, held.radiance[..., self.grid] @ self.weights, held.zenith, rows)
        return table._replace(height=self.height, dip=dip, dip_rows=DIP_ROWS)

    @cached_property
    def sea_sky(self) -> ScatteredTable:
        """Table of the scattered sky seen from the sea, as spectra."""
        held = self._sky_from(0.0)
        if held is None:
            return DARK._replace(spectral=np.zeros((1, self.weights.size)))
        radiance = held.radiance[..., self.grid]
        _, size, shapes = np.linalg.svd(radiance.reshape(-1, radiance.shape[-1]), full_matrices=False)
        spectral = shapes[: max(int(np.count_nonzero(size > _RANK * size[0])), 1)]
        table = self._table(held.zenith, radiance @ spectral.T, held.zenith, 0.5 * np.pi - self._elevations)
        return table._replace(spectral=np.ascontiguousarray(spectral))

    def sea_sky_within(self, turn: float) -> ScatteredTable:
        """Table :attr:`sea_sky`, the same for all places."""
        return self.sea_sky

    def paths(self, arc: FloatArray, azimuth: FloatArray) -> FloatArray:
        """Scattered path radiance in band [W m-2 sr-1] to the sea at arcs [m] (rows), azimuths from the Sun [rad] (columns)."""
        from seaglint.air.scattering.scattered_light import scattered_path

        elevation = -depression_of_range(self.height, arc)
        if self.samples.path is None:
            return np.zeros((arc.size, azimuth.size))
        return scattered_path(arc[:, None], elevation[:, None], azimuth, self.path)

    @property
    def _elevations(self) -> FloatArray:
        return np.maximum(elevation_of_coordinate(np.linspace(0.0, 1.0, ROWS), 0.0), 0.0)

    def _sky_from(self, height: float) -> ScatteredSky | None:
        near = [sky for sky in self.samples.skies if abs(sky.height - height) <= 0.01 * max(height, 1.0)]
        return near[0] if near else None

    def _table(self, zenith: FloatArray, radiance: FloatArray, nodes: FloatArray, rows: FloatArray) -> ScatteredTable:
        """Table of radiance (k, a[, r]) at zenith angles of lines of sight [rad, (k,)]; ``nodes`` (k,) are the coordinates of ``rows``."""
        values = radiance if radiance.ndim == 3 else radiance[..., None]
        sun, azimuth = self.samples.solar_zenith, self.samples.azimuth
        angle = scattering_angle(zenith[:, None], azimuth, sun)
        size = np.sqrt((values**2).sum(axis=2))
        angular = self._angular(angle, size)
        smooth = np.interp(angle, np.linspace(0.0, math.pi, ANGLES), angular)
        # the rest: its magnitude by the logarithm
        tiny = 1e-9 * max(float(size.max()), 1e-30)
        left = np.concatenate([np.log(np.maximum(size, tiny) / smooth)[..., None], values / np.maximum(size, tiny)[..., None]], axis=2)
        columns = np.sin(0.5 * azimuth) ** 2
        wide = np.stack(
            [[np.interp(np.linspace(0.0, 1.0, COLUMNS), columns, part) for part in row.T] for row in left]
        )  # (k, 1 + r, columns)
        order = np.argsort(nodes)
        flat = wide.reshape(nodes.size, -1)[order]
        place = np.clip(np.interp(rows, nodes[order], np.arange(nodes.size)), 0.0, nodes.size - 1.0)
        low = np.minimum(place.astype(np.int64), max(nodes.size - 2, 0))
        part = (place - low)[:, None]
        resampled = ((1.0 - part) * flat[low] + part * flat[np.minimum(low + 1, nodes.size - 1)]).reshape(rows.size, -1, COLUMNS)
        amplitude = (np.exp(resampled[:, :1]) * resampled[:, 1:]).transpose(0, 2, 1)[None, :, :, None, :]
        return ScatteredTable(angular[:, None], np.ascontiguousarray(amplitude), np.ones((1, 1)), sun, (0.0, 0.0), False, 1.0, 2.0, 1.0, 0)

    @staticmethod
    def _angular(angle: FloatArray, size: FloatArray) -> FloatArray:
        """Function of the scattering angle that contains the aureole, from the line of sight nearest to the Sun."""
        row = int(np.argmin(angle.min(axis=1)))
        floor = 1e-6 * max(float(size.max()), 1e-30)
        known, first = np.unique(np.round(angle[row], 6), return_index=True)
        log = np.log(np.maximum(size[row][first], floor))
        if known.size < 3:
            return np.ones(ANGLES)
        angles = np.clip(np.linspace(0.0, math.pi, ANGLES), known[0], known[-1])
        return np.asarray(np.exp(PchipInterpolator(known, log)(angles)))
