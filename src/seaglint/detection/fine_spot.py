"""Object shape with a response sampled finer than pixels: a point behind optics and detector, or anything drawn through them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

_PAD = 12


@dataclass(frozen=True)
class FineSpot:
    """Shape of an object sampled at ``steps`` places per pixel, with cubic splines between them; 0 outside.

    Unlike :class:`seaglint.detection.spot.SampledSpot` it needs no optics that blur over several pixels: displaced by half a pixel it is
    what the pixels then integrate, not an interpolation between whole ones.

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
        from scipy.ndimage import map_coordinates

        middle = (np.shape(self.response)[0] - 1) / 2 + _PAD
        axis = np.arange(-self.half, self.half + 1)
        shape = (offsets.shape[0], axis.size, axis.size)
        rows = np.broadcast_to((middle + self.steps * (axis - offsets[:, :1]))[:, :, None], shape)
        columns = np.broadcast_to((middle + self.steps * (axis - offsets[:, 1:]))[:, None, :], shape)
        coefficients = self._coefficients  # type: ignore[attr-defined]
        return np.asarray(map_coordinates(coefficients, np.stack([rows, columns]), order=3, prefilter=False))
