"""Source of frames: any file that can be displayed, in one form and read frame by frame on request."""

from __future__ import annotations

import threading
from collections import OrderedDict
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis import Recording
from seaglint.base.errors import DataError
from seaglint.files.store.store import partial_path
from seaglint.viewer.opening import Layer, ObjectBox, Opened, open_path

Image = NDArray[np.floating[Any]]

MOST_CACHED: Final = 48_000_000  #: Largest size of the frames that a source caches [bytes], so that memory does not grow with the sequence.

MOST_TRACED: Final = 256  #: Largest number of frames of a pixel's trace, each of which is a chunk of its own on disk.


class GoneError(DataError):
    """Error of a file that has disappeared."""


class ViewerSource:
    """Frames, layers, truth and directions of one file; see :func:`open_source`.

    A file that changes is opened again; one that is gone is told as a :class:`~seaglint.base.errors.DataError` and is back once it is
    there.
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
            self._place, self._stamp = Path(path), ()  # never was: the reader says what would do
        self._opened = self._open()

    @property
    def opened(self) -> Opened:
        """Return the content of the file in its present state."""
        with self._lock:
            self._look()
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
        for place in dict.fromkeys((given, finished, partial_path(finished))):
            for path in (place / "zarr.json", place):
                try:
                    status = path.stat()
                except OSError:
                    continue
                return place, (status.st_ino, status.st_mtime_ns, 0 if place.is_dir() else status.st_size)
        raise GoneError(f"{self.path}: is not there any more; put it back, or choose another one")

    def _open(self) -> Opened:
        opened = open_path(self._place, self._variable, self._channel, self._axes)
        self._cached.clear()
        self._bytes, self._done = 0, opened.done()
        return opened

    def _look(self) -> None:
        """Open the file again if it was replaced."""
        place, stamp = self._find()
        if stamp != self._stamp or place != self._place:
            self._place, self._stamp = place, stamp
            self._opened = self._open()

    def done(self) -> NDArray[np.int64]:
        """Return the indices of the frames that exist, in order; read again while the file is being written."""
        with self._lock:
            self._look()
            if self._done.size < self._opened.frames:
                self._done = self._opened.done()
            return self._done

    def layer(self, name: str | None = None) -> Layer:
        """Return a layer by its name; the main one where none is given.

        Raises
        ------
        DataError
            No such layer.
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
            A frame that is not there (yet), a layer that does not exist, or a file that is gone.
        """
        with self._lock:
            chosen = self.layer(layer)
            self._require(index)
            key = (chosen.name, index)
            image = self._cached.pop(key, None)
            if image is None:
                image = chosen.read(index)
                image.flags.writeable = False
                self._bytes += image.nbytes
            self._cached[key] = image
            while self._bytes > MOST_CACHED and len(self._cached) > 1:
                self._bytes -= self._cached.popitem(last=False)[1].nbytes
            return image

    def _require(self, index: int) -> None:
        frames = self._opened.frames
        if not 0 <= index < frames:
            raise DataError(f"frame {index}: {Path(self.path).name} has {frames}, from 0; choose one of them")
        if index not in self._done and index not in self.done():
            raise DataError(f"frame {index}: is not written yet, {self._done.size} of {frames} are; wait or choose one of those")

    def boxes(self, index: int) -> list[ObjectBox]:
        """Return the objects in view and their boxes, where the sequence has truth."""
        with self._lock:
            read_boxes = self.opened.boxes
            self._require(index)
            return [] if read_boxes is None else read_boxes(index)

    def directions(self, index: int) -> tuple[Image, Image] | None:
        """Return azimuth and elevation [deg] as :func:`seaglint.files.directions.directions` gives them; None where not known."""
        with self._lock:
            read_directions = self.opened.directions
            return None if read_directions is None else read_directions(index)

    def trace(
        self, row: int, column: int, around: int, layer: str | None = None, *, spread: bool = False
    ) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Return the values of a pixel in at most :data:`MOST_TRACED` frames, around one or with ``spread`` over the whole sequence."""
        done = self.done()
        if spread:
            frames = done[np.unique(np.linspace(0, max(done.size - 1, 0), min(done.size, MOST_TRACED)).astype(np.int64))]
        else:
            middle = int(np.searchsorted(done, around))
            first = max(min(middle - MOST_TRACED // 2, done.size - MOST_TRACED), 0)
            frames = done[first : first + MOST_TRACED]
        chosen = self.layer(layer)
        values = np.empty(frames.size)
        for place, frame in enumerate(frames.tolist()):
            with self._lock:  # frame by frame: who plays the sequence meanwhile is not kept waiting
                cached = self._cached.get((chosen.name, frame))
                values[place] = (chosen.read(frame) if cached is None else cached)[row, column]
        return frames, values

    def recording(self, layer: str | None = None, only: int | None = None) -> Recording:
        """Return the recording that ``seaglint analyze`` would open, of the frames that exist; or of one frame.

        Parameters
        ----------
        layer : str, optional
            Layer; the main one by default.
        only : int, optional
            The one frame wanted.
        """
        from dataclasses import replace

        chosen, opened = self.layer(layer), self.opened
        done = self.done() if only is None else np.array([only])
        if opened.recording is not None:
            recording = opened.recording
            if only is None:
                return recording
            return replace(recording, frames=1, read_block=lambda start, stop: recording.read_block(only, only + 1))

        def read(start: int, stop: int) -> NDArray[Any]:
            return np.stack([self.read(int(index), chosen.name) for index in done[start:stop]])

        return Recording(
            f"{self.path}:{chosen.name}",
            int(done.size),
            opened.rows,
            opened.columns,
            read,
            opened.frame_rate,
            chosen.unit or None,
            chosen.saturation,
            blur_px=chosen.blur_px,
        )


def open_source(path: str | Path, variable: str | None = None, channel: str | None = None, axes: str | None = None) -> ViewerSource:
    """Open a sequence (finished or being written), a map, or any recording that ``seaglint analyze`` reads.

    Parameters
    ----------
    path : path
        File, store, folder of images, or pattern.
    variable, channel, axes : str, optional
        Name of the array in a file that holds several, channel, and order of axes, as in :func:`seaglint.files.recording.open_recording`.

    Raises
    ------
    DataError
        Nothing there, or nothing that can be looked at.
    """
    return ViewerSource(path, variable, channel, axes)
