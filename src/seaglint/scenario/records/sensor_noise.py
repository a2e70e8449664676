"""Table ``[sensor.noise]``: what the detector adds beyond shot, dark and read noise."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, StrictBool, model_validator

from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import Record, rule

Rms = Quantity("", ge=0, le=1e12)
Share = Quantity(ge=0, le=1)


class Noise(Record):
    """Noise in units of the signal: electrons of a photon detector, nanowatts of a thermal one."""

    temporal: Annotated[StrictBool, Field(description="noise that changes from frame to frame: shot, dark, read, 1/f")] = True
    fixed_pattern: Annotated[StrictBool, Field(description="what stays: gain and offset of the pixels, dead, hot and blinking ones")] = True
    one_over_f: Annotated[float, Rms, Field(description="rms of a pixel's 1/f noise over a thousand frames")] = 0.0
    frame: Annotated[float, Rms, Field(description="rms of what a whole frame has in common, anew in each (T)")] = 0.0
    row: Annotated[float, Rms, Field(description="rms of the rows' fixed offsets (V)")] = 0.0
    column: Annotated[float, Rms, Field(description="rms of the columns' fixed offsets (H)")] = 0.0
    row_temporal: Annotated[float, Rms, Field(description="rms of the rows' offsets that are new in each frame (TV)")] = 0.0
    column_temporal: Annotated[float, Rms, Field(description="rms of the columns' offsets that are new in each frame (TH)")] = 0.0
    gain_spread: Annotated[float, Share, Field(description="rms relative spread of the pixels' gain (PRNU)")] = 0.0
    offset_spread: Annotated[float, Rms, Field(description="rms spread of the pixels' offset (VH)")] = 0.0
    curvature_spread: Annotated[
        float, Share, Field(description="rms spread of the relative deviation from a straight line at full scale")
    ] = 0.0
    corrected_at_k: Annotated[
        tuple[Annotated[float, Quantity("K", ge=200, le=1000)], Annotated[float, Quantity("K", ge=200, le=1000)]] | None,
        Field(description="two-point correction at blackbodies of these temperatures: takes the spreads of gain and offset off"),
    ] = None
    drift_per_hour: Annotated[float, Rms, Field(description="rms change of the pixels' offsets in an hour since the first frame")] = 0.0
    dead_share: Annotated[float, Share, Field(description="share of the pixels that see nothing")] = 0.0
    hot_share: Annotated[float, Share, Field(description="share of the pixels with a high dark signal")] = 0.0
    hot_signal: Annotated[float, Rms, Field(description="their dark signal")] = 0.0
    blinking_share: Annotated[float, Share, Field(description="share of the pixels that jump between two levels")] = 0.0
    blinking_signal: Annotated[float, Rms, Field(description="distance of the levels")] = 0.0
    blinking_time_s: Annotated[float, Quantity("s", gt=0, le=1e6), Field(description="mean time between jumps")] = 1.0

    @model_validator(mode="after")
    def _shares_fit(self) -> Self:
        total = self.dead_share + self.hot_share + self.blinking_share
        if total > 1.0:
            text = f"= {self.dead_share:g} with hot_share and blinking_share is {total:g} of the pixels; give shares up to 1 in all"
            raise rule("sensor.noise.dead_share", text, value=self.dead_share)
        if self.corrected_at_k is not None and self.corrected_at_k[0] == self.corrected_at_k[1]:
            text = f"= [{self.corrected_at_k[0]:g}, {self.corrected_at_k[1]:g}] is one temperature; give two"
            raise rule("sensor.noise.corrected_at_k", text, value=self.corrected_at_k)
        return self
