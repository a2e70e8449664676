"""Table ``[sensor]``: where the sensor stands and looks, and its pixels."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from seaglint.limits import WIDEST_PINHOLE_DEG
from seaglint.scenario.quantity import Quantity
from seaglint.scenario.record import Record, rule

HIGHEST_SENSOR = 10_000.0
"""Greatest height of a sensor [m]."""

SQUARE_PIXEL_TOLERANCE = 0.01
"""Relative difference of the pixel's two angular sides up to which it counts as square."""

MOST_OBLONG = 3.0
"""Ratio of a pixel's sides from which a mistyped number is likelier than a line scanner."""

REVERSED_OBLONG = 1.5
"""The same where the image is upright in pixels and flat in degrees, or the other way round: swapped numbers."""


class Sensor(Record):
    """Where the sensor stands and looks, and its pixels."""

    height_m: Annotated[
        float, Quantity("m", gt=0, le=HIGHEST_SENSOR), Field(description="height above the mean sea; from 2 m with the table atmosphere")
    ] = 30.0
    azimuth_deg: Annotated[
        float, Quantity("deg", ge=-360, le=360), Field(description="azimuth of the image centre, clockwise from north")
    ] = 180.0
    elevation_deg: Annotated[
        float, Quantity("deg", ge=-90, le=90), Field(description="elevation of the image centre; horizontal 0, looking down negative")
    ] = -3.5
    roll_deg: Annotated[
        float,
        Quantity("deg", ge=-360, le=360),
        Field(description="turn about the line of sight, clockwise as seen from behind the sensor (right side down)"),
    ] = 0.0
    projection: Annotated[
        Literal["equal-angle", "pinhole"],
        Field(description="equal steps of azimuth and elevation (a scanner, panoramas), or a plane image behind a lens"),
    ] = "equal-angle"
    fov_deg: Annotated[
        tuple[Annotated[float, Quantity("deg", gt=0, le=360)], Annotated[float, Quantity("deg", gt=0, le=180)]],
        Field(description="field of view [width, height]"),
    ] = (16.0, 8.0)
    pixels: Annotated[
        tuple[Annotated[int, Quantity(ge=1, le=65_536, integer=True)], Annotated[int, Quantity(ge=1, le=65_536, integer=True)]],
        Field(description="number of pixels [width, height]"),
    ] = (512, 256)
    pixel_shape: Annotated[
        Literal["auto", "square", "any"],
        Field(
            description="auto refuses fields of view that disagree with the pixels (sides beyond 3:1, or 1.5:1 with width and height "
            "reversed); square refuses pixels not square within 1 %; any refuses none"
        ),
    ] = "auto"
    frame_rate_hz: Annotated[float, Quantity("Hz", ge=1e-5, le=100_000), Field(description="frames per second")] = 25.0
    frames: Annotated[int, Quantity(ge=1, le=10_000_000, integer=True), Field(description="number of frames")] = 100

    @property
    def ifov_deg(self) -> tuple[float, float]:
        """Angular size of a pixel (width, height) [deg]."""
        return self.fov_deg[0] / self.pixels[0], self.fov_deg[1] / self.pixels[1]

    @model_validator(mode="after")
    def _image_is_possible(self) -> Self:
        (width, height), (nx, ny) = self.fov_deg, self.pixels
        dx, dy = self.ifov_deg
        if self.projection == "pinhole" and max(width, height) > WIDEST_PINHOLE_DEG:
            text = f"= [{width:g}, {height:g}] is too wide for sensor.projection = 'pinhole'; allowed: up to {WIDEST_PINHOLE_DEG:g} deg"
            raise rule("sensor.fov_deg", f"{text}, or 'equal-angle'", value=self.fov_deg, allowed=f"up to {WIDEST_PINHOLE_DEG:g} deg")
        reverse = (nx - ny) * (width - height) < 0
        most = {"auto": REVERSED_OBLONG if reverse else MOST_OBLONG, "square": 1.0 + SQUARE_PIXEL_TOLERANCE, "any": float("inf")}
        if max(dx, dy) > most[self.pixel_shape] * min(dx, dy):
            text = (
                f"= [{nx}, {ny}] disagrees with sensor.fov_deg = [{width:g}, {height:g}]: a pixel would be {dx:.4g} x {dy:.4g} deg; "
                f"for square pixels use pixels = [{nx}, {max(round(nx * height / width), 1)}], or set sensor.pixel_shape = 'any'"
            )
            raise rule("sensor.pixels", text, value=self.pixels)
        top, bottom = self.elevation_deg + 0.5 * height, self.elevation_deg - 0.5 * height
        if self.projection == "equal-angle" and (top > 90.0 or bottom < -90.0):
            reach = f"reaches from {bottom:g} to {top:g} deg; allowed is -90 to 90 deg, or sensor.projection = 'pinhole'"
            text = f"= {self.elevation_deg:g} with a field of view {height:g} deg high {reach}"
            raise rule("sensor.elevation_deg", text, value=self.elevation_deg)
        return self
