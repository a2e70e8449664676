"""Table ``[sensor.scan]``: when each column and row is taken."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import Record, rule


class Scan(Record):
    """Staring array, line scanner or rotating panoramic scanner."""

    kind: Annotated[
        Literal["staring", "line", "panoramic"],
        Field(description="all columns at once; one after the other; or round and round over 360 deg"),
    ] = "staring"
    period_s: Annotated[
        Annotated[float, Quantity("s", ge=0, le=1e5)] | None,
        Field(description="time of a scan or a turn; default: a frame; 0 takes all columns at once"),
    ] = None
    direction: Annotated[Literal["right", "left"], Field(description="way in which a scanner goes; right is clockwise")] = "right"
    row_time_s: Annotated[
        float, Quantity("s", ge=0, le=1), Field(description="time from row to row of a rolling shutter, from the top; 0 is a global one")
    ] = 0.0

    @model_validator(mode="after")
    def _one_way_of_time(self) -> Self:
        if self.kind == "staring" and self.period_s is not None:
            raise rule("sensor.scan.period_s", "is for scanners; leave it out, or set sensor.scan.kind = 'line' or 'panoramic'")
        if self.kind != "staring" and self.row_time_s > 0.0:
            raise rule("sensor.scan.row_time_s", "is for staring arrays with a rolling shutter; leave it out, or set kind = 'staring'")
        return self
