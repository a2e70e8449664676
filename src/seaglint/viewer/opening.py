"""Opening of files for display: layers, directions, truth; only headers are read until a frame is requested."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis import Recording
from seaglint.base.errors import DataError, SeaglintError
from seaglint.base.schema import IMAGES, VARIABLES
from seaglint.files.counts import count_line
from seaglint.files.directions import directions
from seaglint.files.netcdf import open_netcdf
from seaglint.files.provenance import stored_band
from seaglint.files.recording import open_recording
from seaglint.files.recording.decoding import PLAIN
from seaglint.files.recording.labelled import range_of_decoded, stored_blur, stored_frame_rate
from seaglint.files.sequence_summary import to_temperature
from seaglint.files.store.manifest import DONE
from seaglint.files.store.store import is_sequence
from seaglint.files.store.stored_truth import GROUP

_MAPS: Final = (".nc", ".nc4")


@dataclass(frozen=True)
class Layer:
    """Layer of a file: one image for each frame."""

    #: ``name``, ``label``, ``unit``: By which it is asked for, what it is, and the unit as it is written.
    name: str
    label: str
    unit: str
    read: Callable[[int], NDArray[np.floating[Any]]] = field(repr=False)  #: ``read(index)`` gives the image (rows, columns).
    saturation: float | None = None  #: Value at which the format or the detector saturates.
    blur_px: float | None = None  #: Blur of what made the images, as :class:`seaglint.analysis.Recording` has it [px].


@dataclass(frozen=True)
class ObjectBox:
    """An object in view: its name, and the first column and row, columns and rows that it touches [px]."""

    name: str
    left: float
    top: float
    width: float
    height: float
    range_m: float


@dataclass(frozen=True)
class Opened:
    """Content of a file: frames and attributes as in :class:`~seaglint.viewer.frame_source.ViewerSource`."""

    frames: int
    rows: int
    columns: int
    layers: dict[str, Layer]
    done: Callable[[], NDArray[np.int64]] = field(repr=False)
    frame_rate: float | None = None
    times: NDArray[np.float64] | None = None
    directions: Callable[[int], tuple[NDArray[np.float64], NDArray[np.float64]]] | None = field(default=None, repr=False)
    turning: bool = False
    boxes: Callable[[int], list[ObjectBox]] | None = field(default=None, repr=False)
    recording: Recording | None = None
    title: str = ""
    notes: tuple[str, ...] = ()


def open_path(path: Path, variable: str | None = None, channel: str | None = None, axes: str | None = None) -> Opened:
    """Open the file or folder at a path; words as in :func:`~seaglint.files.recording.open_recording`.

    Raises
    ------
    DataError
        Nothing that can be looked at.
    """
    if path.is_dir() and is_sequence(path):
        return _of_sequence(path, variable)
    if path.suffix.lower() in _MAPS:
        dataset = open_netcdf(path, decode_times=False)
        if axes is None and channel is None and _images(dataset):
            return _of_dataset(dataset, path, variable, None)
    return _of_recording(open_recording(path, variable=variable, channel=channel, axes=axes))


def _of_sequence(path: Path, variable: str | None) -> Opened:
    """Open a store of seaglint. Of ``frame_done`` only existing chunks are read, since requesting each of many takes long."""
    import xarray as xr

    try:
        dataset = xr.open_dataset(str(path), engine="zarr", consolidated=False, chunks=None, decode_times=False)
        count = int(dataset.sizes["time"])
    except Exception as error:
        raise DataError(f"{path}: the sequence is damaged ({' '.join(str(error).split())[:200]}); render it again") from error

    done_array, full = dataset[DONE], set[int]()
    unit = int(done_array.encoding["chunks"][0])

    def done() -> NDArray[np.int64]:
        try:
            names = [int(entry.name) for entry in os.scandir(path / DONE / "c") if entry.name.isdigit()]
        except OSError:
            names = []
        chunks = [np.empty(0, np.int64)]
        for chunk in sorted(names):
            frames = np.arange(chunk * unit, min((chunk + 1) * unit, count))
            if unit > 1 and chunk not in full:
                there = done_array[chunk * unit : chunk * unit + frames.size].to_numpy() == 1
                if there.all():
                    full.add(chunk)
                frames = frames[there]
            chunks.append(frames)
        return np.concatenate(chunks)

    return _of_dataset(dataset, path, variable, done)


def _images(dataset: Any) -> list[str]:
    """Return the variables that are images, the most important first; all have the size of the first."""
    names = [
        str(name)
        for name, values in dataset.data_vars.items()
        if (values.dims[-2:] == ("y", "x") and values.dims[:-2] in ((), ("time",))) and values.dtype.kind in "uif"
    ]
    return sorted(names, key=lambda name: IMAGES.index(name) if name in IMAGES else len(IMAGES))


def _of_dataset(dataset: Any, path: Path, variable: str | None, done: Callable[[], NDArray[np.int64]] | None) -> Opened:
    names = _images(dataset)
    if variable is not None:
        if variable not in names:
            raise DataError(f"{path}: has no image variable '{variable}'; it has {', '.join(names) or 'none'}")
        names = [variable, *(name for name in names if name != variable)]
    if not names:
        raise DataError(f"{path}: holds no images; give a file made by 'seaglint render' or 'seaglint mean'")
    first = dataset[names[0]]
    moving = "time" in first.dims
    frames = int(first.sizes["time"]) if moving else 1
    rows, columns = (int(size) for size in first.shape[-2:])
    layers = _layers(dataset, names)
    everything = np.arange(frames, dtype=np.int64)
    towards: Callable[[int], Any] | None = lambda index: directions(dataset, index)  # noqa: E731
    try:
        assert towards is not None
        towards(0)
    except (KeyError, ValueError, TypeError, IndexError):
        towards = None
    return Opened(
        frames,
        rows,
        columns,
        layers,
        (lambda: everything) if done is None else done,
        stored_frame_rate(dataset, first) if moving else None,
        dataset["time"].to_numpy().astype(np.float64) if moving and "time" in dataset.variables else None,
        towards,
        turning="azimuth" not in dataset.variables,
        boxes=_boxes(path) if moving else None,
        title=str(dataset.attrs.get("title", "")),
    )


def _layers(dataset: Any, names: list[str]) -> dict[str, Layer]:
    """Return the stored layers and those derived from the main one: radiance from counts, apparent temperature from radiance."""

    def stored(name: str) -> Callable[[int], NDArray[np.floating[Any]]]:
        variable = dataset[name]
        bounded = any(end in variable.attrs for end in ("valid_min", "valid_max", "valid_range"))
        valid = range_of_decoded(variable, name) if bounded else PLAIN

        def read(index: int) -> NDArray[np.floating[Any]]:
            values = dataset[name]
            image = valid.values(np.array(values[index] if "time" in values.dims else values))
            return image if image.dtype.kind == "f" else image.astype(np.float32)

        return read

    layers: dict[str, Layer] = {}
    for name in names:
        known, about = VARIABLES.get(name), dataset[name].attrs
        unit = (known.symbol or known.units).strip() if known else str(about.get("units", ""))
        label = str(about.get("long_name") or (known.long_name if known else name))
        full = about.get("saturation_counts")
        full = None if full is None else float(full)
        layers[name] = Layer(name, label, "" if unit == "1" else unit, stored(name), full, stored_blur(dataset, name))
    _derive(dataset, layers)
    return layers


def _derive(dataset: Any, layers: dict[str, Layer]) -> None:
    about = VARIABLES["radiance"]
    if "signal" in layers and "radiance" not in layers:
        try:
            scale, offset = count_line(dataset["signal"])
        except SeaglintError:
            return
        counts, blur = layers["signal"].read, layers["signal"].blur_px
        layers["radiance"] = Layer("radiance", about.long_name, about.symbol, lambda index: counts(index) * scale + offset, blur_px=blur)
    if "radiance" not in layers or "apparent_temperature" in layers:
        return
    try:
        band = stored_band(dataset.attrs)
    except (KeyError, ValueError):
        return
    radiance, blur = layers["radiance"].read, layers["radiance"].blur_px
    warm = VARIABLES["apparent_temperature"]
    layers[warm.name] = Layer(warm.name, warm.long_name, warm.units, lambda index: to_temperature(radiance(index), band), blur_px=blur)


def _boxes(path: Path) -> Callable[[int], list[ObjectBox]] | None:
    """Return a function that reads the boxes of a store's truth."""
    if not (path / GROUP / "zarr.json").exists():
        return None
    import zarr

    group: Any = zarr.open_group(path / GROUP, mode="r", zarr_format=3)
    names = [str(name) for name in group.attrs["objects"]]
    needed = ("bbox_left_px", "bbox_top_px", "bbox_width_px", "bbox_height_px", "range_m")

    def read(index: int) -> list[ObjectBox]:
        table = np.stack([np.asarray(group[name][index], np.float64) for name in needed], axis=1)
        rows = zip(names, table.tolist(), strict=True)
        return [ObjectBox(name, *row) for name, row in rows if all(map(math.isfinite, row[:4])) and row[2] > 0.0 and row[3] > 0.0]

    return read


def _of_recording(recording: Recording) -> Opened:
    """Open any other recording; without units, numbers are counts where the format has integers, otherwise the unit is not known."""
    unit = recording.units or ("counts" if recording.saturation is not None else "unit not known")
    label = "counts" if unit == "counts" else "value"

    def read(index: int) -> NDArray[np.floating[Any]]:
        block = np.array(recording.read_block(index, index + 1)[0])
        return block if block.dtype.kind == "f" else block.astype(np.float64 if block.dtype.itemsize > 2 else np.float32)

    full = None if recording.saturation is None else recording.saturation + recording.offset
    everything = np.arange(recording.frames, dtype=np.int64)
    return Opened(
        recording.frames,
        recording.rows,
        recording.columns,
        {"value": Layer("value", label, unit, read, full)},
        lambda: everything,
        recording.frame_rate,
        recording=recording,
        notes=recording.notes,
    )
