"""Places at sea: uniform numbers become places of a region, even over the area of its sea.

A region is divided into rows of equal area and columns; those whose middle is on land are left out. One number chooses the row by the area
of sea up to it, the other the place among the columns at sea, both in their order: points that are even before remain so, and no draw is
lost on land.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.climate.conditions import GeographicRegion
from seaglint.climate.world_weather import WorldWeather

_SIDE: Final = 0.5  #: Height and width of a part of a large region [deg]: a coast is known to an eighth of a cell of the climatology.
_LEAST: Final = 64  #: Least number of rows and of columns of a small region.
_SAMPLE: Final = 2048  #: Largest number of places that stand for a region.


@dataclass(frozen=True, eq=False)
class SeaPlaces:
    """Places of a region at sea, equally likely by area. Made by ``sea_places``."""

    region: GeographicRegion
    count: NDArray[np.int64]  #: Columns at sea of each row [(rows,)].
    order: NDArray[np.int64]  #: Columns of each row, those at sea first and from west to east [(rows, columns)].

    def draw(self, across: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Latitudes and longitudes at uniform numbers [deg]."""
        ends = np.cumsum(self.count)
        at = across * ends[-1]
        row = np.minimum(np.searchsorted(ends, at, side="right"), np.flatnonzero(self.count)[-1])
        inside = (at - ends[row] + self.count[row]) / self.count[row]
        column = along * self.count[row]
        first = np.minimum(column.astype(np.intp), self.count[row] - 1)
        return self.region.draw(
            (row + np.clip(inside, 0.0, 1.0)) / self.count.size, (self.order[row, first] + column - first) / self.order.shape[1]
        )

    @property
    def middles(self) -> tuple[FloatArray, FloatArray]:
        """Latitudes and longitudes of the middles of all parts at sea [deg]."""
        row, place = np.nonzero(np.arange(self.order.shape[1]) < self.count[:, None])
        return self.region.draw((row + 0.5) / self.count.size, (self.order[row, place] + 0.5) / self.order.shape[1])

    @property
    def some(self) -> tuple[FloatArray, FloatArray]:
        """Latitudes and longitudes of places that stand for the region, evenly chosen from ``middles`` [deg]."""
        north, east = self.middles
        step = max(math.ceil(north.size / _SAMPLE), 1)
        return north[::step], east[::step]


def sea_places(world: WorldWeather, region: GeographicRegion) -> SeaPlaces | None:
    """Return the places of a region at sea; None where all of it is on land."""
    rows, columns = (max(math.ceil(size / _SIDE), _LEAST) for size in (region.north - region.south, region.width))
    across, along = np.meshgrid((np.arange(rows) + 0.5) / rows, (np.arange(columns) + 0.5) / columns, indexing="ij")
    sea = world.at_sea(*(part.reshape(rows, columns) for part in region.draw(across.ravel(), along.ravel())))
    if not sea.any():
        return None
    return SeaPlaces(region, sea.sum(axis=1), np.argsort(~sea, axis=1, kind="stable"))
