"""The record every slope model fills: variances along and across the wind, and the Gaussian density they define."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.errors import DomainError

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class SlopeStatistics:
    """Gaussian statistics of sea-surface slopes.

    Attributes
    ----------
    mss_up : float
        Mean square slope along the wind [1].
    mss_cross : float
        Mean square slope across the wind [1].
    wind_to_azimuth : float
        Azimuth the wind blows TO, clockwise from north [rad]; any value for an isotropic sea.
    """

    mss_up: float
    mss_cross: float
    wind_to_azimuth: float = 0.0

    def __post_init__(self) -> None:
        """Refuse variances that are negative or not finite."""
        values = (self.mss_up, self.mss_cross, self.wind_to_azimuth)
        if not all(np.isfinite(values)) or self.mss_up < 0.0 or self.mss_cross < 0.0:
            raise DomainError(f"slope variances ({self.mss_up:g}, {self.mss_cross:g}) must be finite and at least 0")

    @property
    def mss(self) -> float:
        """Total mean square slope, the sum over two orthogonal directions [1]."""
        return self.mss_up + self.mss_cross

    @property
    def is_isotropic(self) -> bool:
        """Whether both directions have the same variance."""
        return self.mss_up == self.mss_cross

    @property
    def is_flat(self) -> bool:
        """Whether there is no slope at all."""
        return self.mss == 0.0

    def mss_along(self, azimuth: ArrayLike) -> FloatArray:
        """Variance of the slope along a horizontal direction [1].

        ``sigma^2(phi) = mss_up cos^2(phi - phi_wind) + mss_cross sin^2(phi - phi_wind)``
        """
        angle = np.asarray(azimuth, dtype=np.float64) - self.wind_to_azimuth
        return np.asarray(self.mss_up * np.cos(angle) ** 2 + self.mss_cross * np.sin(angle) ** 2)

    def covariance(self) -> tuple[float, float, float]:
        """Covariance of the slopes towards (east, north): (east-east, east-north, north-north) [1]."""
        s, c = float(np.sin(self.wind_to_azimuth)), float(np.cos(self.wind_to_azimuth))
        return (
            self.mss_up * s * s + self.mss_cross * c * c,
            (self.mss_up - self.mss_cross) * s * c,
            self.mss_up * c * c + self.mss_cross * s * s,
        )

    def density(self, slope_east: ArrayLike, slope_north: ArrayLike) -> FloatArray:
        """Probability density of the slope vector (dz/dx east, dz/dy north), per unit area of the sea [1/slope²].

        ``p = exp(-(s_up^2/mss_up + s_cross^2/mss_cross)/2) / (2 pi sqrt(mss_up mss_cross))``

        For an isotropic sea of total variance ``sigma^2`` this is the article's ``exp(-tan^2(beta)/sigma^2)/(pi sigma^2)``.

        Raises
        ------
        DomainError
            If a variance is zero: such a sea has no density, only mirror reflection.
        """
        if self.mss_up <= 0.0 or self.mss_cross <= 0.0:
            raise DomainError("a sea without slope variance has no slope density; treat it as a mirror or give a wind above 0 m/s")
        east = np.asarray(slope_east, dtype=np.float64)
        north = np.asarray(slope_north, dtype=np.float64)
        s, c = np.sin(self.wind_to_azimuth), np.cos(self.wind_to_azimuth)
        up, cross = east * s + north * c, east * c - north * s
        exponent = -0.5 * (up * up / self.mss_up + cross * cross / self.mss_cross)
        return np.asarray(np.exp(exponent) / (2.0 * np.pi * np.sqrt(self.mss_up * self.mss_cross)))


def flat() -> SlopeStatistics:
    """A sea without any slope: a mirror."""
    return SlopeStatistics(0.0, 0.0)
