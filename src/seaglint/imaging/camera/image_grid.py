"""Upright image grid: equal steps of azimuth (columns, clockwise) and of elevation (rows, row 0 on top)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError


@dataclass(frozen=True)
class Camera:
    """Upright camera above the point (0, 0) of the sea, with pixels of equal azimuth and elevation steps.

    Parameters
    ----------
    height : float
        Height above the mean sea [m].
    azimuth, elevation : float
        Direction of the image centre [rad]; azimuth clockwise from north, elevation negative below the horizontal.
    width, height_angle : float
        Field of view in azimuth and elevation [rad].
    columns, rows : int
        Pixels in azimuth and elevation.
    """

    height: float
    azimuth: float
    elevation: float
    width: float
    height_angle: float
    columns: int
    rows: int

    def __post_init__(self) -> None:
        if not self.height > 0.0:
            raise DomainError(
                f"sensor height = {self.height:g} m is not above the sea; give a height > 0 m",
                name="sensor_height",
                value=self.height,
                allowed="above 0 m",
            )
        if self.columns < 1 or self.rows < 1:
            raise DomainError(f"pixels = [{self.columns}, {self.rows}]: an image needs at least 1 x 1 pixels")
        if not 0.0 < self.width <= 2.0 * np.pi + 1e-12:
            raise DomainError(f"field of view in azimuth = {np.degrees(self.width):g} deg is outside (0, 360] deg")
        if self.bottom < -0.5 * np.pi - 1e-9 or self.top > 0.5 * np.pi + 1e-9:
            raise DomainError(
                f"elevations {np.degrees(self.bottom):g} to {np.degrees(self.top):g} deg leave -90 to 90 deg; "
                "lower the field of view or move elevation_deg"
            )

    @property
    def column_step(self) -> float:
        """Azimuth step between columns [rad]."""
        return self.width / self.columns

    @property
    def row_step(self) -> float:
        """Elevation step between rows [rad]."""
        return self.height_angle / self.rows

    @property
    def top(self) -> float:
        """Elevation of the upper edge of row 0 [rad]."""
        return self.elevation + 0.5 * self.height_angle

    @property
    def bottom(self) -> float:
        """Elevation of the lower edge of the last row [rad]."""
        return self.elevation - 0.5 * self.height_angle

    @property
    def azimuths(self) -> FloatArray:
        """Azimuths of the column centres [rad], ascending (not wrapped)."""
        return np.asarray(self.azimuth - 0.5 * self.width + (np.arange(self.columns) + 0.5) * self.column_step)

    @property
    def elevations(self) -> FloatArray:
        """Elevations of the row centres [rad], descending."""
        return np.asarray(self.top - (np.arange(self.rows) + 0.5) * self.row_step)
