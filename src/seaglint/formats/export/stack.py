"""Selection for an export: images of one variable of a run by frame number, read one at a time, with metadata and a number format.

Numbers keep the type of the run, or become single precision or counts of 16 bits with scale and offset.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.base.schema import default_image
from seaglint.store.netcdf import labelled
from seaglint.version import __version__

if TYPE_CHECKING:
    import xarray as xr


Kind = Literal["uint16", "float32"]

MOST: Final = 65535  #: Largest count.


@dataclass(frozen=True)
class Counts:
    """Linear relation of values to counts of 16 bits: ``value = offset + scale * count``; count 0 is a missing value.

    Examples
    --------
    >>> counts = Counts.over(0.0, 65534.0)
    >>> counts.of(np.array([0.0, 10.4, np.nan])).tolist(), counts.scale, counts.offset
    ([1, 11, 0], 1.0, -1.0)
    """

    scale: float
    offset: float

    @classmethod
    def over(cls, low: float, high: float) -> Counts:
        """Return counts 1 to 65535 from ``low`` to ``high``, which may be equal."""
        # 65535 counts without 0, which marks missing values, have 65534 steps.
        scale = (high - low) / (MOST - 1) or 1.0
        return cls(scale, low - scale)

    def steps(self, values: NDArray[Any]) -> NDArray[np.float64]:
        """Return the nearest counts, not limited to 16 bits; NaN stays."""
        return np.asarray(np.rint((np.asarray(values, np.float64) - self.offset) / self.scale))

    def of(self, values: NDArray[Any]) -> NDArray[np.uint16]:
        """Return the counts of values; those beyond the range get the counts of its ends."""
        return np.asarray(np.nan_to_num(np.clip(self.steps(values), 1, MOST), nan=0.0), np.uint16)

    def beyond(self, values: NDArray[Any]) -> int:
        """Return the number of values beyond the range."""
        steps = self.steps(values)
        return int(np.count_nonzero((steps < 1) | (steps > MOST)))


@dataclass(frozen=True)
class NumberFormat:
    """Type of the numbers in a file, and the counts that represent values."""

    dtype: np.dtype[Any]
    counts: Counts | None = None

    def of(self, values: NDArray[Any]) -> NDArray[Any]:
        """Return the numbers that the file stores for values."""
        return np.ascontiguousarray(values if self.counts is None else self.counts.of(values), dtype=self.dtype)

    @property
    def attributes(self) -> dict[str, float | int]:
        """Return scale, offset and the mark of missing values by their CF names; empty for values that are stored unchanged."""
        if self.counts is None:
            return {}
        return {"scale_factor": self.counts.scale, "add_offset": self.counts.offset, "_FillValue": 0}


def check_limits(limits: tuple[float, float]) -> tuple[float, float]:
    """Refuse a range that is not finite or not ascending.

    Raises
    ------
    DataError
        Limits that are not finite, or not one below the other.
    """
    low, high = limits
    if not (np.isfinite([low, high]).all() and low < high):
        raise DataError(f"limits=({low:g}, {high:g}) is no range; give two finite numbers, the smaller first")
    return float(low), float(high)


AXES: Final = ("time", "y", "x")  #: Dimensions of what is exported, frames first, row 0 on top.


@dataclass(frozen=True)
class Exported:
    """Result of an export."""

    files: tuple[Path, ...]  #: The requested file, and its header for a format without one inside the file.
    variable: str  #: Variable of the numbers.
    units: str  #: Unit of the numbers.
    shape: tuple[int, int, int]  #: Frames, rows, columns.
    dtype: str  #: Type of the numbers in the file.
    scale_factor: float | None = None  #: ``value = add_offset + scale_factor * count``, where values were made counts.
    add_offset: float | None = None  #: Value of count 0.
    cut: int = 0  #: Values beyond the range, put to its ends.

    @property
    def line(self) -> str:
        """Return a summary of one line."""
        frames, rows, columns = self.shape
        text = (
            f"{' and '.join(map(str, self.files))} written: {self.variable}{f' [{self.units}]' if self.units else ''}, {frames} frame"
            f"{'s' if frames != 1 else ''} of {columns} x {rows}, {self.dtype}"
        )
        if self.scale_factor is not None:
            text += f"; value = {self.add_offset:.9g} + {self.scale_factor:.9g} x count, 0 where there is no value"
        if self.cut:
            share = 100.0 * self.cut / (frames * rows * columns)
            text += f"; {self.cut} values ({share:.3g} %) beyond the range are put to its ends"
        return text


@dataclass(frozen=True, eq=False)
class Stack:
    """Images of one variable."""

    dataset: xr.Dataset  #: The frames chosen: coordinates, attributes and ``variable`` (time, y, x), which is read on request.
    variable: str  #: Name of the variable.

    @property
    def images(self) -> xr.DataArray:
        """Return the variable."""
        return self.dataset[self.variable]

    @property
    def shape(self) -> tuple[int, int, int]:
        """Return frames, rows, columns."""
        frames, rows, columns = self.images.shape
        return frames, rows, columns

    @property
    def dtype(self) -> np.dtype[Any]:
        """Return the type of the numbers as stored, in the machine's byte order."""
        return np.dtype(self.images.dtype).newbyteorder("=")

    @property
    def units(self) -> str:
        """Return the units of the values; empty where they are not known."""
        return str(self.images.attrs.get("units", ""))

    @property
    def frame_rate(self) -> float | None:
        """Return the frames per second of the chosen frames [Hz]."""
        # Imported here, as the readers of recordings load Numba, and help pages list the endings of exports.
        from seaglint.formats.recording.labelled_arrays import stored_frame_rate

        return stored_frame_rate(self.dataset, self.images)

    def __getitem__(self, position: int) -> NDArray[Any]:
        """Return one image as stored (rows, columns)."""
        return np.asarray(self.images.variable[position].to_numpy(), dtype=self.dtype)

    def metadata(self) -> JsonObject:
        """Return the metadata as plain values, for formats that hold text: units, coordinates of the frames, rows and columns, provenance.

        Coordinates of single pixels (turned and plane cameras) are left out: as text they would be larger than the images.
        """
        return {
            "variable": self.variable,
            "axes": list(AXES),
            "shape": list(self.shape),
            "attributes": {str(name): _plain(value) for name, value in self.images.attrs.items()},
            "frame_rate_hz": self.frame_rate,
            "coordinates": {
                str(name): {
                    "dims": list(map(str, values.dims)),
                    **{str(key): _plain(value) for key, value in values.attrs.items()},
                    "values": _plain(values.to_numpy()),
                }
                for name, values in self.dataset.coords.items()
                if values.ndim < 2
            },
            "provenance": {str(name): _plain(value) for name, value in self.dataset.attrs.items()},
        }


def _plain(value: Any) -> Any:
    """Return a value that JSON holds; numbers that are not finite become null."""
    if isinstance(value, np.ndarray | np.generic):
        return np.asarray(value).astype("datetime64[ms]").astype(str).tolist() if value.dtype.kind == "M" else _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def image_variables(dataset: xr.Dataset) -> list[str]:
    """Return the names of the variables that hold images over time, sorted: stores list theirs in any order."""
    return sorted(str(name) for name, values in dataset.data_vars.items() if values.dims == AXES and values.dtype.kind in "uif")


def frame_numbers(dataset: xr.Dataset) -> NDArray[np.int64]:
    """Return the numbers of the frames that a run holds, counted in the whole sequence."""
    if "frame" in dataset.variables:
        return np.asarray(dataset["frame"].to_numpy(), dtype=np.int64)
    return np.arange(dataset.sizes.get("time", 0))


def held_frames(dataset: xr.Dataset) -> range:
    """Return the first to last frame of a run, by number."""
    numbers = frame_numbers(dataset)
    return range(int(numbers[0]), int(numbers[-1]) + 1) if numbers.size else range(0)


def select(dataset: xr.Dataset, variable: str | None = None, frames: range | None = None, *, source: str = "dataset") -> Stack:
    """Choose variable and frames of an export.

    Parameters
    ----------
    dataset : xarray.Dataset
        A run, opened lazily.
    variable : str, optional
        Variable of the images; by default ``default_image``, or the only one.
    frames : range, optional
        Numbers of the frames, counted in the whole sequence; all by default.
    source : str
        Name of the run in errors.

    Raises
    ------
    DataError
        No images over time, no such variable, frames that the run does not hold or that are not rendered yet.
    """
    available = image_variables(dataset)
    if not available:
        one = any(values.dims == AXES[1:] for values in dataset.data_vars.values())
        remedy = "; a single image becomes a run of one frame by dataset.expand_dims('time')" if one else ""
        raise DataError(f"{source}: holds no images over (time, y, x); give a run of 'seaglint render'{remedy}")
    chosen = variable or default_image(available) or (available[0] if len(available) == 1 else None)
    if chosen is None or chosen not in available:
        message = f"has no images '{chosen}'; it has" if chosen else "give one as variable:"
        raise DataError(f"{source}: {message} {', '.join(available)}")
    numbers = frame_numbers(dataset)
    picked = np.arange(numbers.size)
    if frames is not None:
        run = held_frames(dataset)
        inside = frames.step > 0 and len(frames) > 0 and run.start <= frames[0] and frames[-1] < run.stop
        picked = np.flatnonzero(np.isin(numbers, np.asarray(frames))) if inside else picked[:0]
        if not picked.size:
            raise DataError(f"{source}: {frames!r} is not in the run, which holds frames {run.start}:{run.stop}; give frames of these")
    if "frame_done" in dataset and not bool(np.all(dataset["frame_done"].to_numpy()[picked])):
        raise DataError(f"{source}: frames of it are not rendered yet; render again with resume=True")
    out = labelled(dataset[[chosen, *(name for name in ("wavelength_bounds",) if name in dataset.variables)]].isel(time=picked))
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    before = f"{out.attrs['history']}\n" if "history" in out.attrs else ""
    out.attrs = {**out.attrs, "history": f"{before}{now} {chosen} exported by seaglint {__version__}"}
    stack = Stack(out, chosen)
    if "frame_rate_hz" in out.attrs:
        out.attrs["frame_rate_hz"] = stack.frame_rate  # every other frame has half the rate
    return stack
