"""Result of a detector in one case of a study, as it is kept, tabulated, drawn and reported.

Range of detection of an object, as it is kept, tabulated, drawn and printed.

Parts of an unfinished detection study: frames and finished cases in a folder beside the result, each complete.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject, TableRow, TomlTables
from seaglint.store.outputs import moved_when_whole, read_json, storage_errors, write_json


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


_MARK = "seaglint-detection-parts"


@dataclass(frozen=True)
class Parts:
    """Folder of parts; make it with :meth:`at`."""

    folder: Path  #: RESULT.parts.

    @classmethod
    def at(cls, base: Path, *, resume: bool, overwrite: bool) -> Parts:
        """Open the folder of a result; make it where it is missing.

        Raises
        ------
        DataError
            Something is there and is neither to be gone on with nor replaced, or is no such folder.
        """
        folder = base.with_name(base.name + ".parts")
        with storage_errors(folder, "make room or choose another place"):
            if folder.exists():
                if not (folder / _MARK).is_file():
                    raise DataError(f"{folder}: is there and holds no parts of a detection study; move it, or choose another output")
                if not resume and not overwrite:
                    raise DataError(f"{folder}: holds an unfinished study; go on with resume=True, or begin anew with overwrite=True")
                if not resume:
                    shutil.rmtree(folder)
            folder.mkdir(exist_ok=True)
            (folder / _MARK).touch()
        return cls(folder)

    def frames(self, key: str) -> Path:
        """Return the folder of the frames of a scene."""
        folder = self.folder / f"frames-{key}"
        with storage_errors(folder, "make room or choose another place"):
            folder.mkdir(exist_ok=True)
        return folder

    def forget_frames(self, key: str) -> None:
        """Remove the frames of a scene."""
        shutil.rmtree(self.folder / f"frames-{key}", ignore_errors=True)

    def case(self, key: str) -> JsonObject | None:
        """Return a finished case; None where it is missing or incomplete."""
        try:
            stored: JsonObject = read_json(self.folder / f"case-{key}.json", "compute it again")
        except DataError:
            return None
        return stored

    def keep_case(self, key: str, value: JsonObject) -> None:
        """Write a finished case."""
        write_json(value, self.folder / f"case-{key}.json", indent=None)

    @property
    def empty(self) -> bool:
        """Return true while no part is stored."""
        return not any(path.is_file() and path.name != _MARK for path in self.folder.rglob("*"))

    def remove(self) -> None:
        """Remove all parts."""
        shutil.rmtree(self.folder, ignore_errors=True)


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
    """Write the frames of a sea."""
    with moved_when_whole(sea_path(folder, number), "make room and go on with resume=True") as partial, partial.open("wb") as file:
        np.save(file, frames)


@contextmanager
def parts_folder(base: Path | None, *, resume: bool = False, overwrite: bool = False) -> Iterator[tuple[Parts, bool]]:
    """Return the parts beside a result, and whether they outlive an interruption; without a result a temporary folder."""
    if base is not None:
        parts = Parts.at(base, resume=resume, overwrite=overwrite)
        try:
            yield parts, True
        finally:
            if parts.empty:
                parts.remove()
        return
    import tempfile

    with tempfile.TemporaryDirectory(prefix="seaglint-") as folder:
        yield Parts.at(Path(folder) / "study", resume=False, overwrite=True), False
