"""Grey levels of pictures in 8 or 16 bits, and the linear relations from a level to counts and to radiance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError

Bits = Literal[8, 16]


@dataclass(frozen=True)
class PictureLevels:
    """Linear relation of one scene's levels, the same for all of its frames: ``value = offset + scale * level``."""

    bits: Bits  #: Of a level.
    #: ``scale``, ``offset``: Of what the levels were made from: counts, or radiance [W m-2 sr-1].
    scale: float
    offset: float
    #: ``radiance_scale``, ``radiance_offset``: Radiance of a level and of level 0 [W m-2 sr-1].
    radiance_scale: float
    radiance_offset: float
    counts: bool  #: Whether the levels were made from a detector's counts.

    @classmethod
    def of_counts(cls, low: int, high: int, bits: Bits, line: tuple[float, float]) -> PictureLevels:
        """Return the levels of counts between ``low`` and ``high``, whose radiance is ``line[0] * count + line[1]``.

        In 16 bits levels are the counts themselves. In 8 bits the scene's least to greatest count fill the levels; steps are never finer
        than a count.

        >>> PictureLevels.of_counts(1000, 1100, 8, (2.0, 5.0)).radiance_offset
        2005.0
        """
        scale, offset = (1.0, 0.0) if bits == 16 else (max((high - low) / 255.0, 1.0), float(low))
        return cls(bits, scale, offset, line[0] * scale, line[0] * offset + line[1], True)

    @classmethod
    def of_radiance(cls, low: float, high: float, bits: Bits) -> PictureLevels:
        """Return the levels of radiance between ``low`` and ``high`` [W m-2 sr-1], which fill their range."""
        scale = (high - low) / ((1 << bits) - 1) or 1.0
        return cls(bits, scale, low, scale, low, False)

    def of(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return the nearest levels of counts or radiance.

        Raises
        ------
        DataError
            A value that is no number or beyond the levels.
        """
        levels = np.rint((np.asarray(values, np.float64) - self.offset) / self.scale)
        if not (np.isfinite(levels).all() and levels.min() >= 0 and levels.max() < 1 << self.bits):
            raise DataError("the picture has values that are no numbers or beyond the scene's range; render the scene again")
        return levels.astype(np.uint8 if self.bits == 8 else np.uint16)

    @property
    def attributes(self) -> dict[str, float | int | str]:
        """Return the relations by name, as they stand in tables and pictures."""
        lines: dict[str, float | int | str] = {
            "bits": self.bits,
            "radiance_scale": self.radiance_scale,
            "radiance_offset": self.radiance_offset,
            "radiance_units": "W m-2 sr-1",
        }
        return {**lines, "count_scale": self.scale, "count_offset": self.offset} if self.counts else lines
