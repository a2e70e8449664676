"""Timing of a picture: the instant at which each column or row is taken."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

ScanKind = Literal["staring", "line", "panoramic"]


@dataclass(frozen=True)
class ScanPattern:
    """Timing of the columns and rows of a picture."""

    #: "staring": all columns at once; "line": one after the other across the field of view; "panoramic": continuous rotation, in which a
    #: picture begins where the last one ended.
    kind: ScanKind = "staring"
    period: float = 0.0  #: Time from the first column to the end of the last [s], one turn of a panoramic scanner; 0: all at once.
    leftwards: bool = False  #: True for a scan from right to left (counter-clockwise).
    row_time: float = 0.0  #: Time from row to row of a rolling shutter, from the top [s]; 0 for a global shutter.

    def __post_init__(self) -> None:
        if self.period < 0.0 or self.row_time < 0.0:
            raise DomainError(f"scan period = {self.period:g} s, row time = {self.row_time:g} s; give times of 0 or more")

    @property
    def instantaneous(self) -> bool:
        """True if all pixels have one instant."""
        # a scanner without a period counts as staring
        return (self.kind == "staring" or self.period == 0.0) and self.row_time == 0.0

    def column_delays(self, columns: int) -> FloatArray:
        """Return the time of each column after the time of the frame [s, (columns,)].

        >>> ScanPattern("line", 0.4).column_delays(4)
        array([0. , 0.1, 0.2, 0.3])
        """
        if self.kind == "staring":
            return np.zeros(columns)
        order = np.arange(columns, dtype=np.float64)
        return (order[::-1] if self.leftwards else order) * (self.period / columns)

    def row_delays(self, rows: int) -> FloatArray:
        """Return the time of each row after the time of the frame [s, (rows,)]."""
        return np.arange(rows, dtype=np.float64) * self.row_time
