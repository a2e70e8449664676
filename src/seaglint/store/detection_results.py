"""Results of detection studies for storing, tables, pictures and reports: detectors in one case, and ranges of detection.

The parts of an unfinished study, frames and finished cases, are in a folder beside the result, each complete.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from seaglint.base.free_form import JsonObject, TableRow, TomlTables
from seaglint.store.outputs import ELSEWHERE, moved_when_whole, storage_errors
from seaglint.store.resumable_folder import ResumableFolder
from seaglint.store.writers import exclusive


@dataclass(frozen=True)
class Chip:
    """Pixels about one missed object or false alarm."""

    score: float  #: Statistic there [standard deviations]; -99 without one.
    frame: int  #: Number of the window.
    row: int  #: Row of the centre [px].
    column: int  #: Column of the centre [px].
    pixels: list[list[float | None]]  #: Values [units of the source]; None beyond the frame.


@dataclass(frozen=True)
class Chips:
    """Missed objects and false alarms as pictures."""

    missed: tuple[Chip, ...]  #: Missed objects, with the object in them.
    false: tuple[Chip, ...]  #: Highest false alarms.
    missed_contrast_pixel: float | None  #: Contrast of the missed ones in their pixel [units of the source].


@dataclass(frozen=True)
class FalseAlarmMap:
    """False alarms over the field, in tiles."""

    exceedances: list[list[int]]  #: Pixels above the threshold, of each tile.
    pixels: list[list[int]]  #: Pixels judged, of each tile.
    down: list[float]  #: Edges of the tiles downwards: elevation [deg] or row [px].
    right: list[float]  #: Edges of the tiles to the right: azimuth [deg] or column [px].
    in_degrees: bool  #: True where the field is a grid of directions, and edges are angles.

    @staticmethod
    def _edges(in_degrees: bool) -> tuple[str, str]:
        return ("elevation_deg", "azimuth_deg") if in_degrees else ("row_px", "column_px")

    def as_dict(self) -> JsonObject:
        """Return plain numbers, with edges under their names."""
        down, right = self._edges(self.in_degrees)
        return {"exceedances": self.exceedances, "pixels": self.pixels, down: self.down, right: self.right}

    @classmethod
    def of(cls, stored: JsonObject) -> Self:
        """Return the map that ``as_dict`` wrote."""
        in_degrees = "azimuth_deg" in stored
        down, right = cls._edges(in_degrees)
        return cls(stored["exceedances"], stored["pixels"], stored[down], stored[right], in_degrees)


@dataclass(frozen=True)
class DetectorResult:
    """Performance of a detector in one scene or recording."""

    result: JsonObject  #: Numbers that ``seaglint detect --json`` prints.
    rows: list[TableRow]  #: Row of the table for each contrast.
    roc: dict[str, list[float]]  #: Columns of the operating characteristics.
    map: FalseAlarmMap  #: False alarms over the field.
    chips: Chips  #: Missed objects and false alarms.
    stopped: str | None  #: Why no further seas were drawn: precision, time budget or frames.


@dataclass(frozen=True)
class DetectionCase:
    """Case of a study: its settings and its result."""

    parameters: TableRow  #: Keys that were varied, with their values.
    scenario: TomlTables = field(default_factory=dict)  #: Scenario as one table; empty for a recording.
    judged: DetectorResult | None = None  #: Performance of the detector; None where the case failed.
    error: str | None = None  #: Reason of the failure.

    @property
    def done(self) -> DetectorResult:
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
        """Varied keys as text: ``wind.speed_m_s = 4, detector = log``; empty without varied keys."""
        return _as_text(self.parameters)

    def with_error(self, text: str) -> Self:
        """Return the case as a failed one."""
        return replace(self, error=text)

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text, as a file of an unfinished study holds them."""
        settings: JsonObject = {"parameters": self.parameters, "scenario": self.scenario}
        if self.judged is None:
            return settings | {"error": self.error}
        results = {entry.name: getattr(self.judged, entry.name) for entry in fields(DetectorResult)}
        return settings | results | {"map": self.judged.map.as_dict(), "chips": asdict(self.judged.chips)}

    @classmethod
    def of(cls, stored: JsonObject) -> Self:
        """Return the case that ``as_dict`` wrote."""
        given = stored["chips"]
        missed, false = (tuple(Chip(**chip) for chip in given[name]) for name in ("missed", "false"))
        chips = Chips(missed, false, given["missed_contrast_pixel"])
        alarms = FalseAlarmMap.of(stored["map"])
        plain = {name: stored[name] for name in ("result", "rows", "roc", "stopped")}
        return cls(stored["parameters"], stored["scenario"], DetectorResult(**plain, map=alarms, chips=chips))


def _as_text(parameters: TableRow) -> str:
    return ", ".join(f"{key} = {value}" for key, value in parameters.items())


@dataclass(frozen=True)
class RangePoint:
    """Detection of an object at one range."""

    range_m: float  #: Range [m].
    p_d: float = 0.0  #: Share of objects that are detected [1]; 0 for an invisible one.
    p_d_interval: list[float] | None = None  #: Ends of its 95 % interval [1].
    visible_share: float = 0.0  #: Mean share of the object that waves do not hide [1].
    contrast_pixel: float = 0.0  #: Contrast in its pixel [W m-2 sr-1].
    threshold_sigma: float | None = None  #: Threshold of the requested rate of false alarms [standard deviations].
    note: str | None = None  #: Reason why the object is invisible, or the way it is searched.
    believed: bool | None = None  #: True where that threshold is reliable; None without a detector's result.
    background_sigma: float | None = None  #: Standard deviation of the statistic without objects; None without a detector's result.
    background: str | None = None  #: Rows of the statistics: sea, sky, or rows about the horizon; None without a detector's result.
    #: Rows from the object up to the horizon, below 0 down to it [px]; 0 for a horizon behind the object, None for one outside the rows
    #: drawn, or without a detector's result.
    horizon_rows: int | None = None
    #: Rows above and below a pixel at which the detector looks [px]; None for whole frames, or without a detector's result.
    window_rows: int | None = None
    detector: str | None = None  #: Name of the detector; None without a detector's result.

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text, without the fields of a detector's result where there was no detection to judge."""
        judged = ("believed", "background_sigma", "background", "horizon_rows", "window_rows", "detector")
        return {name: value for name, value in asdict(self).items() if name not in judged or value is not None}

    @classmethod
    def of(cls, stored: JsonObject) -> Self:
        """Return the point that ``as_dict`` wrote."""
        return cls(**stored)


@dataclass(frozen=True)
class TriedDetector:
    """Detector that was tried at one range, before the search."""

    detector: str  #: Name of the detector.
    range_m: float  #: Range [m].
    #: Contrast of the object, at the share that waves leave visible in as many seas as the requested P_d, over the contrast that the
    #: detector needs for that P_d at the requested rate of false alarms [1], at most 32; None where it is below 1/8, or cannot be judged.
    contrast_margin: float | None
    note: str | None = None  #: Reason why it cannot be judged.


@dataclass(frozen=True)
class DetectionRange:
    """Range up to which an object is detected."""

    object: str  #: Name of the object.
    bearing_deg: float | None  #: Bearing from the Sun [deg]; None along the sensor's own line of sight.
    p_d: float  #: Share of objects at which one counts as detected [1].
    range_m: float | None  #: Range of detection [m]; None beyond the limits.
    note: str | None  #: Reason of a missing range.
    range_interval_m: list[float | None]  #: Last range with that share and first one without [m]; None where it has no end.
    points: list[RangePoint]  #: Ranges tried, nearest first.
    parameters: TableRow = field(default_factory=dict)  #: Keys that were varied, with their values.
    warnings: list[str] = field(default_factory=list)  #: Reasons to doubt the range.
    first_estimate_m: float | None = None  #: Range by the Gaussian law, before any frame was searched [m].
    detector: str | None = None  #: Detector of this range.
    #: Detectors among which it was chosen, in the order in which they were tried; empty where it was stated.
    tried: list[TriedDetector] = field(default_factory=list)

    @property
    def named(self) -> str:
        """Varied keys as text: ``wind.speed_m_s = 4``; empty without varied keys."""
        return _as_text(self.parameters)

    @property
    def is_doubtful(self) -> bool:
        """True where an unreliable threshold decides on an end of the range."""
        return any(point.believed is False and point.range_m in self.range_interval_m for point in self.points)

    def as_row(self) -> TableRow:
        """Return the row of a tidy table, varied keys first."""
        low, high = self.range_interval_m
        result = {"object": self.object, "bearing_deg": self.bearing_deg, "p_d": self.p_d, "range_m": self.range_m}
        named = {} if "detector" in self.parameters else {"detector": self.detector}
        return {**self.parameters, **result, "range_low_m": low, "range_high_m": high, "note": self.note, **named}

    def as_dict(self) -> JsonObject:
        """Return plain numbers and text."""
        return {"parameters": self.parameters} | asdict(self) | {"points": [point.as_dict() for point in self.points]}

    @classmethod
    def of(cls, stored: JsonObject) -> Self:
        """Return the range that ``as_dict`` wrote."""
        points = [RangePoint.of(point) for point in stored["points"]]
        return cls(**{**stored, "points": points, "tried": [TriedDetector(**one) for one in stored["tried"]]})


_MARK = "seaglint-detection-parts"


@dataclass(frozen=True)
class StudyParts(ResumableFolder):
    """Folder ``RESULT.parts`` of an unfinished detection study; make it with ``at``."""

    @classmethod
    def at(cls, base: Path, *, resume: bool, overwrite: bool) -> StudyParts:
        """Open the folder of a result; make it where it is missing.

        Raises
        ------
        DataError
            The folder exists and may be neither resumed nor replaced, or is of another kind.
        """
        parts = cls(parts_path(base), _MARK)
        parts.open(
            resume=resume,
            overwrite=overwrite,
            foreign="is there and holds no parts of a detection study; move it, or choose another output",
            unfinished="holds an unfinished study; go on with resume=True, or begin anew with overwrite=True",
        )
        return parts

    def within(self, name: str) -> StudyParts:
        """Return a folder of parts within this one, for work beside other work."""
        return StudyParts(self.part_folder(name), self.mark)

    def frames(self, key: str) -> Path:
        """Return the folder of the frames of a scene."""
        return self.part_folder(f"frames-{key}")

    def forget_frames(self, key: str) -> None:
        """Remove the frames of a scene."""
        self.forget_part(f"frames-{key}")

    def case(self, key: str) -> JsonObject | None:
        """Return a finished case; None where it is missing or incomplete."""
        stored: JsonObject | None = self.read_part(f"case-{key}.json")
        return stored

    def keep_case(self, key: str, value: JsonObject) -> None:
        """Write a finished case."""
        self.write_part(f"case-{key}.json", value)


def parts_path(base: Path) -> Path:
    """Return the folder of the parts of a result; absolute, as workers may run in another folder."""
    return base.with_name(base.name + ".parts").absolute()


def sea_path(folder: Path, number: int) -> Path:
    """Return the file of the frames of one sea."""
    return folder / f"{number:05d}.npy"


def whole_sea(folder: Path, number: int, shape: tuple[int, ...]) -> bool:
    """Return true where the frames of a sea exist in the requested size."""
    try:
        return bool(np.load(sea_path(folder, number), mmap_mode="r").shape == shape)
    except (OSError, ValueError, EOFError):
        return False


def keep_sea(folder: Path, number: int, frames: NDArray[np.float32]) -> None:
    """Write the frames of a sea; several workers may write the same one."""
    remedy = "make room and go on with resume=True"
    with moved_when_whole(sea_path(folder, number), remedy, several=True) as partial, partial.open("xb") as file:
        np.save(file, frames)


@contextmanager
def parts_folder(base: Path | None, *, resume: bool = False, overwrite: bool = False) -> Iterator[tuple[StudyParts, bool]]:
    """Provide the parts beside a result, and true where they outlive an interruption; without a result a temporary folder."""
    if base is not None:
        beside = parts_path(base)
        with ExitStack() as stack:
            with storage_errors(beside, ELSEWHERE):
                stack.enter_context(exclusive(beside))
            parts = StudyParts.at(base, resume=resume, overwrite=overwrite)
            try:
                yield parts, True
            finally:
                if parts.is_empty:
                    parts.remove()
        return
    import tempfile

    with tempfile.TemporaryDirectory(prefix="seaglint-") as folder:
        yield StudyParts.at(Path(folder) / "study", resume=False, overwrite=True), False
