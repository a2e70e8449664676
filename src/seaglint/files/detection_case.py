"""Result of a detector in one case of a study, as it is kept, tabulated, drawn and reported."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields, replace
from typing import Self

from seaglint.base.free_form import JsonObject, TableRow, TomlTables


@dataclass(frozen=True)
class Chip:
    """Pixels about one missed object or false alarm."""

    score: float  #: Statistic there [standard deviations]; -99 where there is none.
    frame: int  #: Number of the window.
    #: ``row``, ``column``: Middle [px].
    row: int
    column: int
    pixels: list[list[float | None]]  #: Values [units of the source]; None beyond the frame.


@dataclass(frozen=True)
class Chips:
    """Missed objects and false alarms as pictures."""

    #: ``missed``, ``false``: Missed objects, with the object in them; highest false alarms.
    missed: tuple[Chip, ...]
    false: tuple[Chip, ...]
    missed_contrast_pixel: float | None  #: Contrast of the missed ones in their pixel [units of the source].


@dataclass(frozen=True)
class FalseAlarmMap:
    """False alarms over the field, in tiles."""

    #: ``exceedances``, ``pixels``: Pixels above the threshold, and pixels judged, of each tile.
    exceedances: list[list[int]]
    pixels: list[list[int]]
    #: ``down``, ``right``: Edges of the tiles: elevation and azimuth [deg], or row and column [px].
    down: list[float]
    right: list[float]
    in_degrees: bool  #: Whether the field is a grid of directions, and edges are angles.

    def as_dict(self) -> JsonObject:
        """Return plain numbers, with edges under their names."""
        down, right = ("elevation_deg", "azimuth_deg") if self.in_degrees else ("row_px", "column_px")
        return {"exceedances": self.exceedances, "pixels": self.pixels, down: self.down, right: self.right}

    @classmethod
    def of(cls, stored: JsonObject) -> Self:
        """Return the map that :meth:`as_dict` wrote."""
        in_degrees = "azimuth_deg" in stored
        down, right = ("elevation_deg", "azimuth_deg") if in_degrees else ("row_px", "column_px")
        return cls(stored["exceedances"], stored["pixels"], stored[down], stored[right], in_degrees)


@dataclass(frozen=True)
class Judged:
    """Performance of a detector in one scene or recording."""

    result: JsonObject  #: Numbers that ``seaglint detect --json`` prints.
    rows: list[TableRow]  #: Row of the table for each contrast.
    roc: dict[str, list[float]]  #: Columns of the operating characteristics.
    map: FalseAlarmMap  #: False alarms over the field.
    chips: Chips  #: Missed objects and false alarms.
    stopped: str | None  #: Why no further seas were drawn: precision, time budget or frames.


@dataclass(frozen=True)
class DetectionCase:
    """Case of a study: what was set, and what came of it."""

    parameters: TableRow  #: Keys that were varied, with their values.
    scenario: TomlTables = field(default_factory=dict)  #: Scenario as one table; empty of a recording.
    judged: Judged | None = None  #: What the detector does; None where the case failed.
    error: str | None = None  #: Why it failed.

    @property
    def done(self) -> Judged:
        """Performance of the detector, in a case that did not fail."""
        if self.judged is None:
            raise ValueError(f"the case failed: {self.error}")
        return self.judged

    @property
    def stopped(self) -> str | None:
        """Why no further seas were drawn."""
        return None if self.judged is None else self.judged.stopped

    @property
    def named(self) -> str:
        """Varied keys as text: ``wind.speed_m_s = 4, detector = log``; empty where nothing was."""
        return ", ".join(f"{key} = {value}" for key, value in self.parameters.items())

    def with_error(self, text: str) -> Self:
        """Return the case as one that failed."""
        return replace(self, error=text)

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text, as a file of an unfinished study holds them."""
        told: JsonObject = {"parameters": self.parameters, "scenario": self.scenario}
        if self.judged is None:
            return told | {"error": self.error}
        parts = {part.name: getattr(self.judged, part.name) for part in fields(Judged)}
        return told | parts | {"map": self.judged.map.as_dict(), "chips": asdict(self.judged.chips)}

    @classmethod
    def of(cls, stored: JsonObject) -> Self:
        """Return the case that :meth:`as_dict` wrote."""
        given = stored["chips"]
        missed, false = (tuple(Chip(**chip) for chip in given[name]) for name in ("missed", "false"))
        chips = Chips(missed, false, given["missed_contrast_pixel"])
        alarms = FalseAlarmMap.of(stored["map"])
        judged = Judged(stored["result"], stored["rows"], stored["roc"], alarms, chips, stored["stopped"])
        return cls(stored["parameters"], stored["scenario"], judged)
