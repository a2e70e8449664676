"""Table ``[band]``: the spectral band."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import Field, model_validator

from seaglint.base.limits import TABLE_BANDS_UM
from seaglint.scenario.records.quantity import Quantity
from seaglint.scenario.records.record import InputFile, Record, rule

#: Bands of the air tables, for error messages.
TABLE_BANDS_TEXT = " or ".join(f"{low:g} to {high:g} um" for low, high in TABLE_BANDS_UM) + " (no band across the gap)"


class BandSettings(Record):
    """Spectral band: a rectangle, or a measured response; inside 2-5.5 or 7.5-14 um with the table atmosphere."""

    min_um: Annotated[
        Annotated[float, Quantity("um", gt=0, le=100)] | None,
        Field(description="short-wave edge of a rectangular band (default 3.5)"),
    ] = None
    max_um: Annotated[
        Annotated[float, Quantity("um", gt=0, le=100)] | None,
        Field(description="long-wave edge of a rectangular band (default 5.0)"),
    ] = None
    response: Annotated[InputFile | None, Field(description="CSV file with columns wavelength_um, response; instead of the two edges")] = (
        None
    )

    @model_validator(mode="before")
    @classmethod
    def _edges(cls, raw: Any) -> Any:
        if isinstance(raw, dict) and raw.get("response") is None:
            return {"min_um": 3.5, "max_um": 5.0} | {k: v for k, v in raw.items() if v is not None}
        return raw

    @model_validator(mode="after")
    def _one_of_both(self) -> Self:
        if self.response is not None and (self.min_um is not None or self.max_um is not None):
            raise rule("band.response", "is given together with band.min_um or band.max_um; give the file or the two edges, not both")
        if self.min_um is not None and self.max_um is not None and not self.min_um < self.max_um:
            raise rule("band.min_um", f"= {self.min_um:g} is not below band.max_um = {self.max_um:g}; swap them", value=self.min_um)
        return self
