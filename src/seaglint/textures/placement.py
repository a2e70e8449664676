"""Texture on the sea as a sensor sees it: footprints grow with range, fluctuations average out, the correlation shrinks.

The Gaussian field lies on the sea, its pixels some metres long and wide. A pixel of the sensor sees the mean over its footprint, which is
Gaussian too, and is brought back to the variance 1. Its value is then the quantile of a distribution with the mean and the variance of
that pixel, which are known beforehand.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray, horizon_range, surface_range
from seaglint.base.errors import DomainError
from seaglint.textures.marginals import Tails

SAMPLED: Final = 12  #: Number of frames for the variance of the averaged field, over all of the plane's columns.

NARROWEST: Final = 1e-6  #: Least ratio of standard deviation to mean that is a fluctuation.


@dataclass(frozen=True)
class Footprints:
    """Footprints of the rows and columns of a camera on the sea."""

    #: ``near``, ``far``: Edges of the rows along the range [m]; NaN above the horizon. Shape (rows,).
    near: FloatArray
    far: FloatArray
    edges: FloatArray  #: Edges of the columns from the middle [rad, (columns + 1,)].

    @classmethod
    def of(cls, height: float, elevations: FloatArray, row_step: float, columns: int, column_step: float) -> Footprints:
        """Footprints of a camera with equal steps [m, rad]; the row that the horizon cuts ends there."""
        near = surface_range(height, -(elevations - 0.5 * row_step))
        far = surface_range(height, -(elevations + 0.5 * row_step))
        far = np.where(np.isnan(far) & ~np.isnan(near), horizon_range(height), far)
        return cls(near, far, np.asarray((np.arange(columns + 1) - 0.5 * columns) * column_step, np.float64))

    @property
    def sea(self) -> NDArray[np.bool_]:
        """Rows that see the sea (rows,)."""
        return np.asarray(np.isfinite(self.near) & (self.far > self.near))

    def finest(self) -> tuple[float, float]:
        """Length and width of the nearest footprint [m].

        Raises
        ------
        DomainError
            No row below the horizon.
        """
        rows = np.flatnonzero(self.sea)
        if not rows.size:
            raise DomainError("the picture shows no sea: the horizon is below it; lower the line of sight")
        last = rows[np.argmin(self.near[rows])]
        middle = 0.5 * (self.near[last] + self.far[last])
        return float(self.far[last] - self.near[last]), float(middle * (self.edges[1] - self.edges[0]))


class PeriodicField:
    """Periodic Gaussian field on the sea, seen through footprints.

    Parameters
    ----------
    field : ndarray, shape (frames, rows, columns)
        Mean 0; row 0 the farthest of its period [1].
    cell : (float, float)
        Length along the range and width of a pixel of the field [m].
    footprints : Footprints
    """

    def __init__(self, field: NDArray[np.float32], cell: tuple[float, float], footprints: Footprints) -> None:
        if not (cell[0] > 0.0 and cell[1] > 0.0):
            raise DomainError(f"a pixel of the texture is {cell[0]:g} m x {cell[1]:g} m; give lengths above 0")
        self._field, self._cell = field, cell
        self._rows = np.flatnonzero(footprints.sea)
        self._shape = (footprints.near.size, footprints.edges.size - 1)
        # Rows of the picture and of the field both have the far sea on top.
        self._ends = -footprints.far[self._rows] / cell[0], -footprints.near[self._rows] / cell[0]
        middle = 0.5 * (footprints.near[self._rows] + footprints.far[self._rows])
        self._edges = middle[:, None] * footprints.edges / cell[1]
        numbers = np.unique(np.linspace(0, len(field) - 1, min(len(field), SAMPLED)).astype(int))
        power = np.zeros(self._rows.size)
        for number in numbers:
            profile = self._profile(number)
            width = np.diff(self._edges, axis=1).mean(axis=1)
            # Footprints of the same width everywhere around the period.
            starts = np.arange(profile.shape[1], dtype=float)[None, :] + np.zeros((self._rows.size, 1))
            seen = (_running(profile, starts + width[:, None]) - _running(profile, starts)) / width[:, None]
            power += (seen**2).mean(axis=1)
        self.spread = np.sqrt(power / numbers.size)
        """Standard deviation of the field averaged over the footprints of each row below the horizon [1]."""

    def _profile(self, number: int) -> FloatArray:
        """Mean over the lengths of the rows' footprints, (rows below the horizon, columns of the field)."""
        field = self._field[number % len(self._field)].astype(np.float64)
        low, high = self._ends
        return (_running(field.T, high[None, :]) - _running(field.T, low[None, :])).T / (high - low)[:, None]

    def frame(self, number: int) -> FloatArray:
        """Field in a frame as the sensor sees it, variance 1 (rows, columns) [1]; 0 above the horizon."""
        profile = self._profile(number)
        sums = _running(profile, self._edges)
        out = np.zeros(self._shape)
        out[self._rows] = np.diff(sums, axis=1) / np.diff(self._edges, axis=1) / self.spread[:, None]
        return out

    @property
    def averaging(self) -> FloatArray:
        """Standard deviation of each row of the picture over that of the field (rows,) [1]; 0 above the horizon."""
        out = np.zeros(self._shape[0])
        out[self._rows] = self.spread
        return out


def _running(values: FloatArray, places: FloatArray) -> FloatArray:
    """Integral of periodic steps (lines, n) from 0 to places (lines or 1, m), in steps."""
    lines, n = values.shape
    sums = np.concatenate([np.zeros((lines, 1)), np.cumsum(values, axis=1)], axis=1)
    periods = np.floor(places / n)
    rest = places - periods * n
    index = np.minimum(rest.astype(np.int64), n - 1)
    share = rest - index
    index, share, periods = (np.broadcast_to(v, (lines, places.shape[1])) for v in (index, share, periods))
    start = np.take_along_axis(sums, index, axis=1)
    return np.asarray(periods * sums[:, -1:] + start + share * np.take_along_axis(values, index, axis=1))


def fluctuation(g: FloatArray, mean: FloatArray, std: FloatArray, tails: Tails) -> FloatArray:
    """Values with a mean and a standard deviation by pixel, at g standard deviations of the Gaussian field [u], shape of g.

    ``tails`` gaussian and lognormal are these; all others are gamma distributed, from 0 upwards.
    Pixels whose mean or standard deviation is 0 have their mean.
    """
    from scipy import special

    out = np.array(mean, np.float64)
    lively = (mean > 0.0) & (std > NARROWEST * np.abs(mean))
    if tails == "gaussian":
        return np.asarray(out + np.where(lively, std * g, 0.0))
    ratio = std[lively] / mean[lively]
    u = g[lively]
    if tails == "lognormal":
        s = np.sqrt(np.log1p(ratio**2))
        out[lively] = mean[lively] * np.exp(s * u - 0.5 * s**2)
        return out
    shape = 1.0 / ratio**2
    upper = u > 0.0
    value = np.empty(u.size)
    value[upper] = special.gammainccinv(shape[upper], special.ndtr(-u[upper]))
    value[~upper] = special.gammaincinv(shape[~upper], special.ndtr(u[~upper]))
    out[lively] = mean[lively] * value / shape
    return out
