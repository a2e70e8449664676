"""Frames of any file that can be displayed: layers, directions and truth, read one by one on request.

Opening reads headers only. Sequences, maps, pictures and recordings then have the same form.
"""

from __future__ import annotations

import math
import os
import threading
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.constants import zero_Celsius

from seaglint.analysis import Recording
from seaglint.base.errors import DataError, SeaglintError
from seaglint.base.schema import IMAGES, VARIABLES
from seaglint.formats.recording import open_recording
from seaglint.formats.recording.labelled_arrays import range_of_decoded, stored_blur, stored_frame_rate
from seaglint.formats.recording.stored_values import PLAIN
from seaglint.store.layout import GROUP
from seaglint.store.netcdf import open_netcdf
from seaglint.store.provenance import stored_band
from seaglint.store.sequence_store import is_sequence, partial_path
from seaglint.store.shards import DONE
from seaglint.store.stored_images import count_line, directions, to_temperature

_MAPS: Final = (".nc", ".nc4")

OVER_TIME: Final = ("mean", "deviation", "maximum")  #: Pictures that are computed from all frames of a layer.

_RAW: Final = "value"  #: Name of the layer with the numbers of a recording as it is stored.


@dataclass(frozen=True)
class Layer:
    """Layer of a file: one image for each frame."""

    name: str  #: Name in requests.
    label: str  #: Label on the page.
    unit: str  #: Unit on the page.
    read: Callable[[int], NDArray[np.floating[Any]]] = field(repr=False)  #: ``read(index)`` gives the image (rows, columns).
    saturation: float | None = None  #: Value at which the format or the detector saturates.
    blur_px: float | None = None  #: Blur of the images, as in ``seaglint.analysis.Recording`` [px].
    over_frames: int | None = None  #: Number of frames from which an image over time was computed; None for frames.

    @property
    def spread_unit(self) -> str:
        """Return the unit of differences of values: a difference of temperatures has no zero to be shifted."""
        return "K" if self.unit == CELSIUS else self.unit


CELSIUS: Final = "°C"  #: Unit of temperatures in degrees Celsius.


@dataclass(frozen=True)
class ObjectBox:
    """Object in view: name, first column and row, number of columns and rows [px], and range [m]."""

    name: str
    left: float
    top: float
    width: float
    height: float
    range_m: float


@dataclass(frozen=True)
class FileContent:
    """Content of a file: frames and attributes as in ``ViewerSource``."""

    frames: int  #: Number of frames.
    rows: int  #: Rows of an image.
    columns: int  #: Columns of an image.
    layers: dict[str, Layer]  #: Layers by name.
    done: Callable[[], NDArray[np.int64]] = field(repr=False)  #: Gives the numbers of finished frames.
    frame_rate: float | None = None  #: Frames per second [Hz].
    times: NDArray[np.float64] | None = None  #: Time of each frame [s, (frames,)].
    #: Gives azimuth and elevation of a frame's pixels [deg].
    directions: Callable[[int], tuple[NDArray[np.float64], NDArray[np.float64]]] | None = field(default=None, repr=False)
    turning: bool = False  #: Whether directions change from frame to frame.
    boxes: Callable[[int], list[ObjectBox]] | None = field(default=None, repr=False)  #: Gives the objects in view in a frame.
    recording: Recording | None = None  #: Recording behind the file, where it is one.
    title: str = ""  #: Title of the scene.
    notes: tuple[str, ...] = ()  #: Sentences for the user.


def open_path(path: Path, variable: str | None = None, channel: str | None = None, axes: str | None = None) -> FileContent:
    """Open the file or folder at a path; arguments as in ``open_recording``.

    Raises
    ------
    DataError
        The path holds nothing that can be displayed.
    """
    if path.is_dir() and is_sequence(path):
        return _of_sequence(path, variable)
    if path.suffix.lower() in _MAPS:
        dataset = open_netcdf(path, decode_times=False)
        if axes is None and channel is None and _images(dataset):
            return _of_dataset(dataset, path, variable, None)
    return _of_recording(open_recording(path, variable=variable, channel=channel, axes=axes))


def _of_sequence(path: Path, variable: str | None) -> FileContent:
    """Open a store of seaglint; only existing chunks of ``frame_done`` are read, since requesting each of many chunks takes long."""
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
            # A chunk of several frames may be half done; a chunk of one frame exists only when the frame is written.
            if unit > 1 and chunk not in full:
                written = done_array[chunk * unit : chunk * unit + frames.size].to_numpy() == 1
                if written.all():
                    full.add(chunk)
                frames = frames[written]
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


def _of_dataset(dataset: Any, path: Path, variable: str | None, done: Callable[[], NDArray[np.int64]] | None) -> FileContent:
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
    # Files of other programs may lack angles, or have them in another form: a first call decides.
    towards: Callable[[int], Any] | None = lambda index: directions(dataset, index)  # noqa: E731
    try:
        assert towards is not None
        towards(0)
    except (KeyError, ValueError, TypeError, IndexError):
        towards = None
    return FileContent(
        frames=frames,
        rows=rows,
        columns=columns,
        layers=layers,
        done=(lambda: everything) if done is None else done,
        frame_rate=stored_frame_rate(dataset, first) if moving else None,
        times=dataset["time"].to_numpy().astype(np.float64) if moving and "time" in dataset.variables else None,
        directions=towards,
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
        layers[name] = Layer(name, label, "" if unit == "1" else unit, stored(name), full, blur_px=stored_blur(dataset, name))
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
        rows = zip(names, np.stack([np.asarray(group[name][index], np.float64) for name in needed], axis=1).tolist(), strict=True)
        return [ObjectBox(name, *row) for name, row in rows if all(map(math.isfinite, row[:4])) and row[2] > 0.0 and row[3] > 0.0]

    return read


def _of_recording(recording: Recording) -> FileContent:
    """Open any other recording; without units, numbers are counts where the format has integers, otherwise the unit is not known."""
    unit = recording.units or ("counts" if recording.saturation is not None else "unit not known")
    label = "counts" if unit == "counts" else "value"

    def read(index: int) -> NDArray[np.floating[Any]]:
        block = np.array(recording.read_block(index, index + 1)[0])
        # Single precision holds integers of 16 bits exactly, but not of 32.
        return block if block.dtype.kind == "f" else block.astype(np.float64 if block.dtype.itemsize > 2 else np.float32)

    full = None if recording.saturation is None else recording.saturation + recording.offset
    everything = np.arange(recording.frames, dtype=np.int64)
    return FileContent(
        frames=recording.frames,
        rows=recording.rows,
        columns=recording.columns,
        layers={_RAW: Layer(_RAW, label, unit, read, full)},
        done=lambda: everything,
        frame_rate=recording.frame_rate,
        recording=recording,
        notes=recording.notes,
    )


Image = NDArray[np.floating[Any]]

MOST_CACHED: Final = 48_000_000  #: Largest size of the frames that a source caches [bytes], so that memory does not grow with the sequence.


def evenly(frames: NDArray[np.int64], most: int) -> NDArray[np.int64]:
    """Return at most a number of frames, evenly spaced, the first and the last included."""
    return frames[np.unique(np.linspace(0, max(frames.size - 1, 0), min(frames.size, most)).astype(np.int64))]


class GoneError(DataError):
    """Error of a file that has disappeared."""


class ViewerSource:
    """Frames, layers, truth and directions of one file; see ``open_source``.

    A file that was replaced is opened again. A missing file raises :class:`~seaglint.base.errors.DataError` until it exists again.
    """

    def __init__(self, path: str | Path, variable: str | None = None, channel: str | None = None, axes: str | None = None) -> None:
        self.path = str(path)
        self._variable, self._channel, self._axes = variable, channel, axes
        self._lock = threading.RLock()
        self._cached: OrderedDict[tuple[str, int], Image] = OrderedDict()
        self._bytes = 0
        self._done: NDArray[np.int64] = np.empty(0, np.int64)
        try:
            self._place, self._stamp = self._find()
        except GoneError:
            self._place, self._stamp = Path(path), ()  # the place is empty: the reader's error names the allowed files
        self._opened = self._open()

    @property
    def opened(self) -> FileContent:
        """Return the content of the file in its present state."""
        with self._lock:
            self._reopen_if_replaced()
            return self._opened

    @property
    def stamp(self) -> tuple[int, ...]:
        """Return an identity of the file, which changes when it is replaced."""
        return self._stamp

    def _find(self) -> tuple[Path, tuple[int, ...]]:
        """Return the present path of the file, finished or not, and its identity."""
        given = Path(self.path)
        if any(sign in given.name for sign in "*?["):
            return given, ()
        finished = given.with_name(given.name.removesuffix(".partial"))
        # A sequence has another name while it is being written; either may have been given.
        for place in dict.fromkeys((given, finished, partial_path(finished))):
            for path in (place / "zarr.json", place):
                try:
                    status = path.stat()
                except OSError:
                    continue
                # The size of a folder changes with every file in it; a store is recognised by its zarr.json.
                return place, (status.st_ino, status.st_mtime_ns, 0 if place.is_dir() else status.st_size)
        raise GoneError(f"{self.path}: is not there any more; put it back, or choose another one")

    def _open(self) -> FileContent:
        opened = open_path(self._place, self._variable, self._channel, self._axes)
        opened = replace(opened, layers=self._with_celsius(opened.layers))
        self._cached.clear()
        self._bytes, self._done = 0, opened.done()
        return opened

    def _with_celsius(self, layers: dict[str, Layer]) -> dict[str, Layer]:
        """Return the layers, each temperature in kelvin followed by the same in degrees Celsius."""
        out: dict[str, Layer] = {}
        for layer in layers.values():
            out[layer.name] = layer
            if layer.unit == "K":
                name = f"{layer.name}_celsius"

                def read(index: int, kelvin: str = layer.name) -> Image:
                    return self.read_once(index, kelvin) - zero_Celsius

                out[name] = replace(layer, name=name, unit=CELSIUS, read=read, saturation=None)
        return out

    def add_over_time(self, layer: Layer, images: dict[str, Image], frames: int) -> list[str]:
        """Add images that were computed from all frames of a layer as layers, the same for every frame, and return their names."""
        added: dict[str, Layer] = {}
        for word, image in images.items():
            image.flags.writeable = False

            def read(index: int, image: Image = image) -> Image:
                return image

            unit = layer.spread_unit if word == "deviation" else layer.unit
            name, label = f"{layer.name}_{word}", f"{layer.label}, {word} over {frames} frame{'s' * (frames != 1)}"
            added[name] = Layer(name, label, unit, read, over_frames=frames)
        with self._lock:
            self._opened = replace(self._opened, layers={**self._opened.layers, **added})
        return list(added)

    def _reopen_if_replaced(self) -> None:
        """Open the file again if it was replaced."""
        place, stamp = self._find()
        if stamp != self._stamp or place != self._place:
            self._place, self._stamp = place, stamp
            self._opened = self._open()

    def done(self) -> NDArray[np.int64]:
        """Return the indices of the frames that exist, in order; read again while the file is being written."""
        with self._lock:
            self._reopen_if_replaced()
            if self._done.size < self._opened.frames:
                self._done = self._opened.done()
            return self._done

    def layer(self, name: str | None = None) -> Layer:
        """Return a layer by its name; the main one by default.

        Raises
        ------
        DataError
            The file has no such layer.
        """
        layers = self.opened.layers
        chosen = name or next(iter(layers))
        if chosen not in layers:
            raise DataError(f"{Path(self.path).name}: has no layer '{chosen}'; it has {', '.join(layers)}")
        return layers[chosen]

    def read(self, index: int, layer: str | None = None) -> Image:
        """Return the image (rows, columns) of a frame, which must not be changed.

        Raises
        ------
        DataError
            The frame is not written (yet), the layer does not exist, or the file has disappeared.
        """
        with self._lock:
            chosen = self.layer(layer)
            self._require(index)
            if chosen.over_frames is not None:
                return chosen.read(index)
            key = (chosen.name, index)
            image = self._cached.pop(key, None)
            if image is None:
                image = chosen.read(index)
                image.flags.writeable = False
                self._bytes += image.nbytes
            # Put back at the end: the first entry is the one not used for longest.
            self._cached[key] = image
            # The frame just read stays, however large it is.
            while self._bytes > MOST_CACHED and len(self._cached) > 1:
                self._bytes -= self._cached.popitem(last=False)[1].nbytes
            return image

    def read_once(self, index: int, layer: str | None = None) -> Image:
        """Return the image of a frame that exists without caching it, for passes over all frames; other requests run in between."""
        with self._lock:
            chosen = self.layer(layer)
            cached = self._cached.get((chosen.name, index))
            return chosen.read(index) if cached is None else cached

    def times(self, frames: NDArray[np.int64]) -> list[float] | None:
        """Return the times of frames [s]; None where they are not known."""
        opened = self.opened
        if opened.times is not None:
            return [float(time) for time in opened.times[frames]]
        return None if opened.frame_rate is None else [float(time) for time in frames / opened.frame_rate]

    def _require(self, index: int) -> None:
        frames = self._opened.frames
        if not 0 <= index < frames:
            raise DataError(f"frame {index}: {Path(self.path).name} has {frames}, from 0; choose one of them")
        # The list of written frames is read again only where the known one lacks the frame.
        if index not in self._done and index not in self.done():
            raise DataError(f"frame {index}: is not written yet, {self._done.size} of {frames} are; wait or choose one of those")

    def boxes(self, index: int) -> list[ObjectBox]:
        """Return the objects in view and their boxes, where the sequence has truth."""
        with self._lock:
            read_boxes = self.opened.boxes
            self._require(index)
            return [] if read_boxes is None else read_boxes(index)

    def directions(self, index: int) -> tuple[Image, Image] | None:
        """Return azimuth and elevation [deg] as ``seaglint.store.stored_images.directions`` does; None where they are not known."""
        with self._lock:
            read_directions = self.opened.directions
            return None if read_directions is None else read_directions(index)

    def require_pixel(self, row: int, column: int) -> None:
        """Check that a pixel lies in the image.

        Raises
        ------
        DataError
            It lies outside.
        """
        opened = self.opened
        if not (0 <= row < opened.rows and 0 <= column < opened.columns):
            raise DataError(f"pixel at row {row}, column {column}: the image has {opened.rows} rows and {opened.columns} columns, from 0")

    def recording(self, layer: str | None = None, only: int | None = None) -> Recording:
        """Return the recording that ``seaglint analyze`` would open, of the frames that exist; or of one frame.

        Parameters
        ----------
        layer : str, optional
            Layer; the main one by default.
        only : int, optional
            Single frame to return.
        """
        chosen, opened = self.layer(layer), self.opened
        done = self.done() if only is None else np.array([only])
        if chosen.over_frames is not None:
            done = done[:1]  # the same image for every frame
        if (recording := opened.recording) is not None and chosen.name == _RAW:
            if only is None:
                return recording
            return replace(recording, frames=1, read_block=lambda start, stop: recording.read_block(only, only + 1))

        def read(start: int, stop: int) -> NDArray[Any]:
            return np.stack([self.read(int(index), chosen.name) for index in done[start:stop]])

        return Recording(
            source=f"{self.path}:{chosen.name}",
            frames=int(done.size),
            rows=opened.rows,
            columns=opened.columns,
            read_block=read,
            frame_rate=opened.frame_rate,
            units=chosen.unit or None,
            saturation=chosen.saturation,
            blur_px=chosen.blur_px,
        )


def open_source(path: str | Path, variable: str | None = None, channel: str | None = None, axes: str | None = None) -> ViewerSource:
    """Open a sequence (finished or being written), a map, or any recording that ``seaglint analyze`` reads.

    Parameters
    ----------
    path : path
        File, store, folder of images, or pattern.
    variable, channel, axes : str, optional
        Name of the array in a file that holds several, channel, and order of axes, as in ``seaglint.formats.recording.open_recording``.

    Raises
    ------
    DataError
        The path does not exist, or holds nothing that can be displayed.
    """
    return ViewerSource(path, variable, channel, axes)
