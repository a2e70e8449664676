"""Tables ``[time]``, ``[place]`` and ``[sun]``: when and where, or the Sun's position itself."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import Record, Utc


class Time(Record):
    """When: with ``[place]`` it gives the Sun's position and distance."""

    utc: Annotated[Utc, Field(description="UTC date and time of the first frame, e.g. 2026-06-21T17:30:00Z")]


class Place(Record):
    """Where: with ``[time]`` it gives the Sun's position."""

    latitude_deg: Annotated[float, Quantity("deg", ge=-90, le=90), Field(description="latitude, north positive")]
    longitude_deg: Annotated[float, Quantity("deg", ge=-180, le=360), Field(description="longitude, east positive")]


class Sun(Record):
    """The Sun's position given directly, at 1 au; instead of ``[time]`` and ``[place]``."""

    zenith_deg: Annotated[
        float,
        Quantity("deg", ge=0, le=180),
        Field(description="zenith angle of the Sun's centre; above 90 it is below the horizontal: no glint"),
    ] = 75.0
    azimuth_deg: Annotated[float, Quantity("deg", ge=-360, le=360), Field(description="azimuth of the Sun, clockwise from north")] = 180.0
