"""Shapes of small objects in pixels: a Gaussian spot, a measured point spread, or a response sampled finer than pixels.

A shape has the value 1 at its central pixel when it is centred there. Its product with the contrast is the signal in each pixel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

_PAD = 12  #: Zeros about the samples of a spline [samples]: its coefficients fall by 0.27 a sample, here below 1e-6.


class SpotShape(Protocol):
    """Interface of an object's shape for injection."""

    @property
    def half(self) -> int:
        """Pixels from the central one to the edge of the stamp [px]."""
        ...

    def stamps(self, offsets: FloatArray) -> FloatArray:
        """Return objects displaced by (row, column) from the centre of the central pixel, shape (n, 2 half + 1, 2 half + 1) [1].

        ``offsets``: shape (n, 2) [px], within half a pixel.
        """
        ...


@dataclass(frozen=True)
class GaussianSpot:
    """Gaussian spot integrated over pixels of full fill.

        S_i = [Phi((i + 1/2 - x) / s) - Phi((i - 1/2 - x) / s)] / [2 Phi(1 / (2 s)) - 1]  along each axis

    Parameters
    ----------
    sigma : float
        Standard deviation before the integration [px], 0.05-20: below, all lies in one pixel.

    Examples
    --------
    >>> GaussianSpot(0.8).stamps(np.zeros((1, 2)))[0, 4].round(3).tolist()[3:6]
    [0.503, 1.0, 0.503]
    """

    sigma: float

    def __post_init__(self) -> None:
        if not 0.05 <= self.sigma <= 20.0:
            raise DomainError(
                f"standard deviation of the object = {self.sigma:g} px is outside 0.05-20 px; "
                "give that of its blur, or its point spread as an array"
            )

    @property
    def half(self) -> int:
        """Half size of the stamp: four standard deviations and half a pixel, rounded up [px]."""
        return int(np.ceil(4.0 * self.sigma + 0.5))

    def stamps(self, offsets: FloatArray) -> FloatArray:
        """Displaced spots, shape (n, 2 half + 1, 2 half + 1) [1]."""
        rows, columns = (self._profile(offsets[:, axis]) for axis in (0, 1))
        return np.asarray(rows[:, :, None] * columns[:, None, :])

    def _profile(self, displacement: FloatArray) -> FloatArray:
        from scipy.special import ndtr

        edges = np.arange(-self.half, self.half + 2) - 0.5
        # The integral of a Gaussian over each pixel.
        steps = np.diff(ndtr((edges - displacement[:, None]) / self.sigma), axis=1)
        return np.asarray(steps / (2.0 * ndtr(0.5 / self.sigma) - 1.0))


@dataclass(frozen=True)
class SampledSpot:
    """Measured or computed point spread function, one value per pixel, displaced by cubic splines; 0 outside.

    Parameters
    ----------
    values : array_like
        Shape (odd, odd), at most 63 on a side, the object centred on the middle pixel [any]; divided by its middle value.

    Raises
    ------
    DomainError
        Even or large sides, values that are not finite, or a middle value that is not above 0.
    """

    values: ArrayLike

    def __post_init__(self) -> None:
        v = np.array(self.values, np.float64)
        if v.ndim != 2 or v.shape[0] % 2 == 0 or v.shape[1] % 2 == 0 or max(v.shape) > 63 or not np.isfinite(v).all():
            raise DomainError(f"point spread of shape {v.shape} is not usable; give finite values, odd sides of at most 63 pixels")
        middle = float(v[v.shape[0] // 2, v.shape[1] // 2])
        if not middle > 0:
            raise DomainError(f"point spread with {middle:g} in its middle pixel; the object must be centred there and brighter than 0")
        from scipy.ndimage import spline_filter

        # A frame of zeros: half a pixel of displacement and the reach of the spline stay inside.
        side = max(v.shape) + 2
        square = np.pad(v / middle, [((side - n) // 2,) * 2 for n in v.shape])
        object.__setattr__(self, "values", square)
        object.__setattr__(self, "_coefficients", spline_filter(np.pad(square, _PAD), order=3))

    @property
    def half(self) -> int:
        """Half size of the stamp: half the larger side and a pixel more [px]."""
        return int(np.shape(self.values)[0]) // 2

    def stamps(self, offsets: FloatArray) -> FloatArray:
        """Displaced point spreads, shape (n, 2 half + 1, 2 half + 1) [1]."""
        axis = np.arange(2 * self.half + 1) + float(_PAD)
        return _interpolated(self._coefficients, axis - offsets[:, :1], axis - offsets[:, 1:])  # type: ignore[attr-defined]


@dataclass(frozen=True)
class FineSpot:
    """Shape of an object sampled at ``steps`` places per pixel, with cubic splines between them; 0 outside.

    Unlike :class:`seaglint.detection.spot.SampledSpot` it needs no optics that blur over several pixels: displaced by half a
    pixel it is the integral over the displaced pixels, not an interpolation between whole ones.

    Parameters
    ----------
    response : ndarray, shape (2 k steps + 1, 2 k steps + 1)
        Value of a pixel whose centre is displaced by (row, column) / steps from the object; the middle one is the largest, above 0 [any].
        Divided by it.
    steps : int
        Values to a pixel.

    Raises
    ------
    DomainError
        Another size, values that are not finite, or a middle that is not above 0.
    """

    response: FloatArray
    steps: int

    def __post_init__(self) -> None:
        values = np.asarray(self.response, np.float64)
        side = values.shape[0]
        if values.ndim != 2 or values.shape[1] != side or side < 3 or (side - 1) % (2 * self.steps) or not np.isfinite(values).all():
            raise DomainError(
                f"response of shape {values.shape} with {self.steps} values to a pixel is not usable; "
                "give finite values, 2 k steps + 1 along each side"
            )
        middle = float(values[side // 2, side // 2])
        if not middle > 0:
            raise DomainError(f"response with {middle:g} in its middle; the object must be centred there and brighter than 0")
        from scipy.ndimage import spline_filter

        object.__setattr__(self, "response", values / middle)
        object.__setattr__(self, "_coefficients", spline_filter(np.pad(values / middle, _PAD), order=3))

    @property
    def half(self) -> int:
        """Pixels from the central one to the edge of the stamp, one more than the response for its displacement [px]."""
        return (int(np.shape(self.response)[0]) - 1) // (2 * self.steps) + 1

    @property
    def share(self) -> float:
        """Share of the light of a centred object in its pixel [1]."""
        return 1.0 / float(self.stamps(np.zeros((1, 2))).sum())

    def stamps(self, offsets: FloatArray) -> FloatArray:
        """Displaced objects, shape (n, 2 half + 1, 2 half + 1) [1]."""
        middle = (np.shape(self.response)[0] - 1) / 2 + _PAD
        axis = np.arange(-self.half, self.half + 1)
        rows, columns = (middle + self.steps * (axis - offsets[:, [k]]) for k in (0, 1))
        return _interpolated(self._coefficients, rows, columns)  # type: ignore[attr-defined]


def _interpolated(coefficients: FloatArray, rows: FloatArray, columns: FloatArray) -> FloatArray:
    """Return values of a cubic spline on grids of rows and columns, shape (n, side) each, as shape (n, side, side)."""
    from scipy.ndimage import map_coordinates

    shape = (*rows.shape, columns.shape[1])
    grid = np.stack([np.broadcast_to(rows[:, :, None], shape), np.broadcast_to(columns[:, None, :], shape)])
    return np.asarray(map_coordinates(coefficients, grid, order=3, prefilter=False))
