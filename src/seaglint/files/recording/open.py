"""Opening of recordings: choice of the reader by path, and properties that the user states in place of the file."""

from __future__ import annotations

import glob
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from seaglint.analysis.recording import FrameArray, Recording
from seaglint.base.errors import DataError, SeaglintError
from seaglint.files.recording import arrays, images
from seaglint.files.recording import video_file as video
from seaglint.files.recording.raw import RawLayout, open_raw
from seaglint.files.recording.stored import CHANNELS

RATE_TOLERANCE = 0.01
"""Relative difference between the file's frame rate and the user's above which a note names both."""

_ARRAY_ENDINGS = (".npy", ".npz", ".h5", ".hdf5", ".he5", ".mat", ".fits", ".fit", ".fts", ".nc", ".nc4", ".zarr")

FORMATS = (
    "Zarr (*.zarr), NetCDF (*.nc), PNG and TIFF (file, folder or 'pattern*.png'), FITS (*.fits, *.fit), NumPy (*.npy, *.npz), "
    "HDF5 (*.h5, *.hdf5, *.mat), video (*.mp4, *.avi, *.mkv, *.mov), raw (*.raw, *.bin, *.dat with a layout)"
)


def open_recording(
    path: str | Path,
    *,
    frame_rate: float | None = None,
    units: str | None = None,
    raw: RawLayout | None = None,
    variable: str | None = None,
    channel: str | None = None,
    axes: str | None = None,
    saturation: float | None = None,
) -> Recording:
    """Open a sequence of images or a single one. Only its size is read, and of numbers wider than 16 bits the first frame.

    Parameters
    ----------
    path : path
        File, folder of images, Zarr store, or pattern of image files.
    frame_rate : float, optional
        Frames per second [Hz]; overrules the file, which is noted where they differ.
    units : str, optional
        Units of the values; overrules the file.
    raw : RawLayout, optional
        Layout of a raw file; otherwise read from the file beside it.
    variable : str, optional
        Name of the array in a file that holds several.
    channel : {"mean", "red", "green", "blue"}, optional
        Channel of true colour images, which are refused otherwise.
    axes : {"tyx", "yxt"}, optional
        Order of the axes: time first (the default) or last.
    saturation : float, optional
        Value from which on the sensor is saturated; overrules the format's full scale.

    Returns
    -------
    Recording

    Raises
    ------
    DataError
        Nothing there, an unknown format, a damaged file, or one that holds no images.
    BackendError
        A reader that is not installed.
    """
    if frame_rate is not None and not (np.isfinite(frame_rate) and frame_rate > 0.0):
        raise DataError(f"frame rate = {frame_rate:g} Hz; give a number above 0")
    if channel is not None and channel not in CHANNELS:
        raise DataError(f"channel = {channel!r}; allowed are {', '.join(CHANNELS)}")
    if axes is not None and axes not in arrays.AXES:
        raise DataError(f"axes = {axes!r}; allowed are {', '.join(arrays.AXES)}: time first or last")
    if saturation is not None and not np.isfinite(saturation):
        raise DataError(f"saturation = {saturation:g}; give a finite number")
    how = arrays.ArrayReading(variable, channel, axes)
    with _damage(path):
        recording = _open(Path(path), raw, how)
    notes = recording.notes
    if axes == "yxt" and Path(path).suffix.lower() not in _ARRAY_ENDINGS:
        raise DataError(f"{path}: axes='yxt' is for arrays ({', '.join(_ARRAY_ENDINGS)}); frames of other formats have their order")
    if frame_rate is not None and recording.frame_rate is not None and abs(frame_rate / recording.frame_rate - 1.0) > RATE_TOLERANCE:
        notes = (*notes, f"frame rate {frame_rate:g} Hz as given; the file says {recording.frame_rate:g} Hz")
    full = recording.saturation if saturation is None else saturation - recording.offset
    read_block = recording.read_block

    def read(start: int, stop: int) -> FrameArray:
        with _damage(path):
            return read_block(start, stop)

    return replace(
        recording,
        frame_rate=frame_rate or recording.frame_rate,
        units=units or recording.units,
        saturation=full,
        notes=notes,
        read_block=read,
    )


@contextmanager
def _damage(path: str | Path) -> Iterator[None]:
    """Report exceptions of libraries at damaged files, which are of nearly any type, as an error of one line."""
    try:
        yield
    except SeaglintError:
        raise
    except Exception as error:
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise DataError(f"{path}: cannot be read ({reason}); is the file whole?") from error


def _open(path: Path, raw: RawLayout | None, how: arrays.ArrayReading) -> Recording:
    if any(sign in path.name for sign in "*?["):
        matches = sorted(map(Path, glob.glob(str(path))), key=images.natural)
        if not matches:
            raise DataError(f"{path}: no file has such a name; check the pattern")
        return images.open_images(_images_only(matches, path), how.channel)
    if not path.exists():
        raise DataError(f"{path}: no such file or folder; give one of {FORMATS}")
    if path.is_dir():
        return _open_folder(path, how)
    if path.stat().st_size == 0:
        raise DataError(f"{path}: is empty")
    ending = path.suffix.lower()
    if raw is not None or ending in (".raw", ".bin", ".dat"):
        return open_raw(path, raw if raw is not None else RawLayout.beside(path))
    if ending in images.ENDINGS:
        return images.open_images([path], how.channel)
    if ending in video.ENDINGS:
        return video.open_video(path, how.channel)
    if ending in (".npy", ".npz"):
        return arrays.open_numpy(path, how)
    if ending in (".h5", ".hdf5", ".he5", ".mat"):
        return arrays.open_hdf5(path, how)
    if ending in (".fits", ".fit", ".fts"):
        return arrays.open_fits(path, how)
    if ending in (".nc", ".nc4"):
        return arrays.open_labelled(path, how)
    raise DataError(f"{path}: format not known; give one of {FORMATS}")


def _open_folder(path: Path, how: arrays.ArrayReading) -> Recording:
    if (path / "zarr.json").exists() or (path / ".zgroup").exists():
        from seaglint.files.store.store import is_sequence, open_sequence

        if is_sequence(path):
            open_sequence(path).close()  # tells what is unfinished or damaged
        return arrays.open_labelled(path, how)
    files = sorted((f for f in path.iterdir() if f.suffix.lower() in images.ENDINGS), key=images.natural)
    if not files:
        raise DataError(f"{path}: a folder without PNG or TIFF images; give one of {FORMATS}")
    return images.open_images(_images_only(files, path), how.channel)


def _images_only(files: list[Path], where: Path) -> list[Path]:
    endings = sorted({f.suffix.lower() for f in files})
    if len(endings) > 1 or endings[0] not in images.ENDINGS:
        raise DataError(f"{where}: holds files {', '.join(endings)}; give a pattern for one kind of image, e.g. '*.png'")
    return files
