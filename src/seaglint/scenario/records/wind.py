"""Table ``[wind]``: the wind at 10 m."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from seaglint.base.limits import WIND_PROFILE
from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import Record


class Wind(Record):
    """Neutral wind at 10 m."""

    speed_m_s: Annotated[float, Quantity("m/s", ge=0, le=WIND_PROFILE[1]), Field(description="wind speed at 10 m")] = 7.0
    from_deg: Annotated[float, Quantity("deg", ge=-360, le=360), Field(description="azimuth the wind comes FROM, clockwise from north")] = (
        230.0
    )
