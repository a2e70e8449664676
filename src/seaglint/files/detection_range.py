"""Range of detection of an object, as it is kept, tabulated, drawn and printed."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Self

from seaglint.base.free_form import JsonObject, TableRow


@dataclass(frozen=True)
class RangePoint:
    """Detection of an object at one range."""

    range_m: float  #: Range [m].
    p_d: float = 0.0  #: Share of objects that are detected [1]; 0 where nothing of it is seen.
    p_d_interval: list[float] | None = None  #: Ends of its 95 % interval [1].
    visible_share: float = 0.0  #: Mean share of the object that waves do not hide [1].
    contrast_pixel: float = 0.0  #: Contrast in its pixel [W m-2 sr-1].
    threshold_sigma: float | None = None  #: Threshold of the wanted rate of false alarms [standard deviations].
    note: str | None = None  #: Why nothing is seen, or how it is looked for.
    believed: bool | None = None  #: Whether that threshold is to be believed; None where nothing was judged.
    background_sigma: float | None = None  #: Standard deviation of the statistic without objects; None where nothing was judged.
    background: str | None = None  #: Rows whose statistics are taken: sea, sky, or those about the horizon; None where nothing was judged.
    #: Rows from the object up to the horizon, below 0 down to it; 0 where it lies behind the object, None where it is not among the rows
    #: drawn, or nothing was judged [px].
    horizon_rows: int | None = None
    #: Rows above and below a pixel at which the detector looks [px]; None for whole frames, or where nothing was judged.
    window_rows: int | None = None
    detector: str | None = None  #: Detector judged; None where nothing was judged.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text; of a range at which nothing was judged without what judging gives."""
        judged = ("believed", "background_sigma", "background", "horizon_rows", "window_rows", "detector")
        return {name: value for name, value in asdict(self).items() if name not in judged or value is not None}

    @classmethod
    def of(cls, stored: JsonObject) -> Self:
        """Return the point that :meth:`as_dict` wrote."""
        return cls(**stored)


@dataclass(frozen=True)
class TriedDetector:
    """Detector that was tried at one range, before the search."""

    detector: str  #: Name of the detector.
    range_m: float  #: Range [m].
    #: Contrast of the object, at the share that waves leave in view in as many seas as the wanted P_d, over that which the detector needs
    #: for that P_d at the wanted rate of false alarms [1], at most 32; None where it is below 1/8, or cannot be judged.
    contrast_margin: float | None
    note: str | None = None  #: Why it cannot be judged.


@dataclass(frozen=True)
class DetectionRange:
    """Range up to which an object is detected."""

    object: str  #: Name of the object.
    bearing_deg: float | None  #: Bearing from the Sun [deg]; None along the sensor's own line of sight.
    p_d: float  #: Share of objects at which one counts as detected [1].
    range_m: float | None  #: Range of detection [m]; None beyond the limits.
    note: str | None  #: Why there is none.
    range_interval_m: list[float | None]  #: Last range with that share and first one without [m]; None where it has no end.
    points: list[RangePoint]  #: Ranges tried, nearest first.
    parameters: TableRow = field(default_factory=dict)  #: Keys that were varied, with their values.
    warnings: list[str] = field(default_factory=list)  #: Why the range is to be doubted.
    first_estimate_m: float | None = None  #: Range by the Gaussian law, before any frame was searched [m].
    detector: str | None = None  #: Detector of this range.
    #: Detectors among which it was chosen, in the order in which they were tried; empty where it was stated.
    tried: list[TriedDetector] = field(default_factory=list)

    @property
    def named(self) -> str:
        """Varied keys as text: ``wind.speed_m_s = 4``; empty where nothing was."""
        return ", ".join(f"{key} = {value}" for key, value in self.parameters.items())

    @property
    def is_doubtful(self) -> bool:
        """True where a threshold that is not to be believed decides on an end of the range."""
        return any(point.believed is False and point.range_m in self.range_interval_m for point in self.points)

    def as_row(self) -> TableRow:
        """Return the row of a tidy table: what was varied first."""
        low, high = self.range_interval_m
        found = {"object": self.object, "bearing_deg": self.bearing_deg, "p_d": self.p_d, "range_m": self.range_m}
        named = {} if "detector" in self.parameters else {"detector": self.detector}
        return {**self.parameters, **found, "range_low_m": low, "range_high_m": high, "note": self.note, **named}

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return {"parameters": self.parameters} | asdict(self) | {"points": [point.as_dict() for point in self.points]}
