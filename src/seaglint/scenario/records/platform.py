"""Table ``[platform]``: how the sensor moves."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, StrictBool, model_validator

from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import InputFile, Record, rule
from seaglint.scenario.records.sensor_table import HIGHEST_SENSOR


class Keyframe(Record):
    """Where a moving sensor is at one time; what is left out stays as [sensor] says (east and north: 0)."""

    time_s: Annotated[float, Quantity("s", ge=-1e7, le=1e7), Field(description="time from the first frame")]
    east_m: Annotated[Annotated[float, Quantity("m", ge=-1e6, le=1e6)] | None, Field(description="position towards east")] = None
    north_m: Annotated[Annotated[float, Quantity("m", ge=-1e6, le=1e6)] | None, Field(description="position towards north")] = None
    height_m: Annotated[Annotated[float, Quantity("m", gt=0, le=HIGHEST_SENSOR)] | None, Field(description="height above the mean sea")] = (
        None
    )
    azimuth_deg: Annotated[
        Annotated[float, Quantity("deg", ge=-36_000, le=36_000)] | None, Field(description="azimuth of the image centre")
    ] = None
    elevation_deg: Annotated[
        Annotated[float, Quantity("deg", ge=-90, le=90)] | None, Field(description="elevation of the image centre")
    ] = None
    roll_deg: Annotated[
        Annotated[float, Quantity("deg", ge=-36_000, le=36_000)] | None, Field(description="turn about the line of sight, right side down")
    ] = None


class Platform(Record):
    """A sensor that moves: keyframes, here or in a file, and straight lines between them (angles the short way round)."""

    track: Annotated[
        InputFile | None,
        Field(
            description="CSV file with a column time_s and any of east_m, north_m, height_m, azimuth_deg, elevation_deg, roll_deg; instead "
            "of keyframes"
        ),
    ] = None
    keyframes: Annotated[tuple[Keyframe, ...] | None, Field(description="list of keyframes, the columns of the file as keys")] = None

    floats: Annotated[
        StrictBool,
        Field(description="true: the sensor heaves, pitches and rolls with the waves under its vessel, about the keyframes if any"),
    ] = False
    waterline_m: Annotated[
        tuple[Annotated[float, Quantity("m", gt=0, le=100)], Annotated[float, Quantity("m", gt=0, le=500)]],
        Field(description="waterline [width, length] over which waves are averaged where it floats; the sensor stands above its middle"),
    ] = (3.0, 10.0)
    heading_deg: Annotated[
        Annotated[float, Quantity("deg", ge=-360, le=360)] | None,
        Field(description="azimuth of the vessel's forward end where it floats; along its way, else the sensor's azimuth"),
    ] = None

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if self.floats and self.track is None and self.keyframes is None:
            return self
        if (self.track is None) == (self.keyframes is None):
            both = "are both given" if self.track is not None else "are both missing"
            raise rule("platform", f"track and keyframes {both}; give one of the two, or leave [platform] out")
        for name in Keyframe.model_fields if self.keyframes else ():
            given = [getattr(keyframe, name) is not None for keyframe in self.keyframes or ()]
            if any(given) and not all(given):
                raise rule(
                    f"platform.keyframes[{given.index(False)}]", f"lacks {name}, which other keyframes have; give it in all or in none"
                )
        return self
