"""Places of objects by where they are in the first frame."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.errors import ScenarioError
from seaglint.imaging.camera.imager import Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.scenario.model import Scenario
from seaglint.studies.prepare import prepare


@dataclass(frozen=True)
class PixelGrid:
    """The first frame's grid of pixels: from a place in it to a place on or above the sea."""

    scenario: Scenario  #: Of the sensor.

    @cached_property
    def pose(self) -> Pose:
        """Pose of the sensor at the first frame; a floating sensor at rest."""
        return prepare.track(self.scenario).at(0.0)

    @cached_property
    def pixels(self) -> Imager:
        """Pixel model of the camera."""
        return prepare.imager(self.scenario)

    def place(
        self, column: float, row: float | None, *, range_m: float | None = None, height: float | None = None
    ) -> tuple[float, float, float]:
        r"""East, north and height [m] of what is seen at a place in the first frame.

        .. math:: (R' + h)\,\cos(\epsilon + s/R') = (R' + h_0)\,\cos\epsilon

        along a line of sight of elevation epsilon from the sensor at h0, with the arc s along the sea.

        Parameters
        ----------
        column, row : float
            Pixels from the left and upper edges; without a row the middle one gives the azimuth.
        range_m : float, optional
            Arc along the sea [m].
        height : float, optional
            Height above the mean sea [m].

        Raises
        ------
        ScenarioError
            A line of sight that does not come to that height, or is under the sea at that range.
        """
        east, north, up = (
            float(v) for v in self.pixels.directions(self.pose.attitude, column, 0.5 * self.pixels.rows if row is None else row)
        )
        elevation, eye = math.atan2(up, math.hypot(east, north)), EFFECTIVE_EARTH_RADIUS + self.pose.height
        if row is None:
            assert range_m is not None  # the template has two of row, range_m and height
            arc, height_m = range_m, height or 0.0
        elif range_m is None:
            arc, height_m = self._arc(elevation, height or 0.0, row), height or 0.0
        else:
            arc = range_m
            height_m = eye * math.cos(elevation) / math.cos(elevation + arc / EFFECTIVE_EARTH_RADIUS) - EFFECTIVE_EARTH_RADIUS
            if height_m <= 0.0:
                raise ScenarioError(
                    f"row = {row:.6g} looks {-height_m:.4g} m under the sea at range_m = {range_m:.6g}; give a lesser range_m, or a "
                    "height_m instead of one of the two"
                )
        level = math.hypot(east, north)
        return self.pose.east + arc * east / level, self.pose.north + arc * north / level, height_m

    def _arc(self, elevation: float, height: float, row: float) -> float:
        """Arc to where a line of sight first comes to a height [m]."""
        cosine = (EFFECTIVE_EARTH_RADIUS + self.pose.height) * math.cos(elevation) / (EFFECTIVE_EARTH_RADIUS + height)
        falls = self.pose.height > height
        if cosine > 1.0 or (falls and elevation >= 0.0) or (not falls and elevation <= 0.0):
            raise ScenarioError(
                f"row = {row:.6g} looks {math.degrees(elevation):+.4g} deg from the horizontal, which never comes to height_m = {height:g} "
                f"from {self.pose.height:g} m; give rows that do, or range_m instead of row"
            )
        there = math.acos(cosine)
        return EFFECTIVE_EARTH_RADIUS * ((-there if falls else there) - elevation)
