"""Facts that a TIFF tells beside its pixels: rate, units and the straight line of its counts, by our own words or ImageJ's."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.free_form import JsonObject


@dataclass(frozen=True)
class TiffFacts:
    """Frame rate [Hz] and units, None where the file does not say; ``value = offset + scale * count`` with one count for no value."""

    frame_rate: float | None = None
    units: str | None = None
    scale: float = 1.0
    offset: float = 0.0
    blank: float | None = None

    @classmethod
    def of(cls, file: Any) -> TiffFacts:
        """Read an open ``tifffile.TiffFile``; what cannot be understood is left out."""
        imagej: JsonObject = file.imagej_metadata or {}
        own = _own(imagej.get("Info")) or _own(file.pages[0].description)
        if own is not None:
            scale, offset = _number(own.get("scale_factor")), _number(own.get("add_offset"))
            units = own.get("attributes", {}).get("units")
            rate, unit = _positive(own.get("frame_rate_hz")), str(units) if units else None
            return cls(rate, unit) if scale is None else cls(rate, unit, scale, offset or 0.0, _number(own.get("_FillValue")))
        interval = _positive(imagej.get("finterval"))
        units = imagej.get("vunit")
        straight = imagej.get("cf") == 0 and None not in (slope := _number(imagej.get("c1")), zero := _number(imagej.get("c0")))
        line = {"scale": slope or 1.0, "offset": zero or 0.0} if straight else {}
        return cls(None if interval is None else 1.0 / interval, None if units in (None, "", "Gray Value") else str(units), **line)

    @property
    def plain(self) -> bool:
        """True where the numbers are the values."""
        return self.scale == 1.0 and self.offset == 0.0 and self.blank is None

    def values(self, counts: NDArray[Any]) -> NDArray[Any]:
        """Values of the counts; NaN where there is none."""
        if self.plain:
            return counts
        out = self.offset + self.scale * counts.astype(np.float64)
        return out if self.blank is None else np.where(counts == self.blank, np.nan, out)


def _own(text: Any) -> JsonObject | None:
    """Our own metadata, or None for any other text."""
    try:
        found = json.loads(text)
    except (TypeError, ValueError):
        return None
    return found if isinstance(found, dict) and {"variable", "attributes"} <= set(found) and isinstance(found["attributes"], dict) else None


def _number(value: Any) -> float | None:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value) else None


def _positive(value: Any) -> float | None:
    number = _number(value)
    return number if number is not None and number > 0.0 else None
