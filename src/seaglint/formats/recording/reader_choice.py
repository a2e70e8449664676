"""Opening of recordings: choice of the reader by path, and properties that the user states in place of the file.

Pictures are one recording whether they are one file or many; many are read in the order of the numbers in their names.
"""

from __future__ import annotations

import glob
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import FrameArray, Recording
from seaglint.base.errors import DataError
from seaglint.formats.recording import arrays, fits_images, pictures
from seaglint.formats.recording.arrays import ArrayReading, RawLayout, joined, open_raw, resolved
from seaglint.formats.recording.frame_axes import require_axes
from seaglint.formats.recording.labelled_arrays import is_zarr, open_hdf5, open_labelled_netcdf, open_matlab, open_zarr
from seaglint.formats.recording.pictures import PictureFile, open_picture
from seaglint.formats.recording.stored_values import Decoding, colour_notes, grey, require_channel
from seaglint.formats.recording.tiff import open_tiff
from seaglint.store.outputs import library_errors

TIFF_ENDINGS = (".tif", ".tiff", ".btf", ".tf8")
ENDINGS = (*TIFF_ENDINGS, *pictures.PICTURE_ENDINGS)


def natural(path: Path) -> tuple[Any, ...]:
    """Return a sort key that puts frame 9 before frame 10, and small letters beside capitals.

    >>> [p.name for p in sorted([Path("f10.png"), Path("f9.png")], key=natural)]
    ['f9.png', 'f10.png']
    """
    return tuple((0, int(part), "") if part.isdigit() else (1, 0, part) for part in re.split(r"(\d+)", path.name.casefold()))


def open_images(paths: Sequence[Path], channel: str | None, missing: tuple[float, ...] = ()) -> Recording:
    """Open files in the given order, each of one frame or several.

    Raises
    ------
    DataError
        A file that cannot be decoded, or files of different sizes, number types or units.
    """
    files = [open_tiff(path, channel) if path.suffix.lower() in TIFF_ENDINGS else open_picture(path) for path in paths]
    files = [replace(file, decoding=file.decoding.with_missing(missing, file.dtype)) for file in files]
    first = files[0]
    for other in files[1:]:
        _require_alike(first, other)
    pages = sum(file.frames for file in files)
    counted = "" if pages == len(paths) else f", {pages} pages"
    several = f"{first.path.parent} ({len(paths)} images {first.path.name} ... {paths[-1].name}{counted})"
    notes = [*first.notes, *first.decoding.notes]
    if any(file.decoding != first.decoding for file in files):
        notes = [*first.notes, "the files state different scales or missing values, and each is read by its own"]
    whole = joined([_recording(file, channel) for file in files], str(first.path) if len(paths) == 1 else several)
    whole = replace(whole, notes=(*_channel_note(first, channel), *notes, *missing_numbers(paths)))
    decoded = first.decoding.dtype(first.dtype)
    return resolved(whole) if decoded.itemsize > 2 and decoded != np.float32 else whole


def _recording(file: PictureFile, channel: str | None) -> Recording:
    """Return the frames of one file, with one value a pixel."""

    def read(start: int, stop: int) -> NDArray[Any]:
        stored = file.read(start, stop)
        return file.decoding.values(stored if stored.ndim == 3 else grey(stored, str(file.path), channel))

    return Recording(str(file.path), file.frames, file.rows, file.columns, read, file.frame_rate, file.units, file.saturation, offset=0.0)


def _require_alike(first: PictureFile, other: PictureFile) -> None:
    """Refuse files whose numbers have no common scale; size and units are compared where they are joined."""
    if other.dtype != first.dtype:
        raise DataError(
            f"{other.path}: holds {other.dtype}, {first.path.name} {first.dtype}; counts of different types have no common scale: "
            "write them in one, or give a pattern for one kind"
        )
    if (other.decoding.white is None) != (first.decoding.white is None):
        raise DataError(f"{other.path}: white is zero in one of it and {first.path.name} alone; write them alike")


def _channel_note(file: PictureFile, channel: str | None) -> tuple[str, ...]:
    """Return a note on the channel; true colour is refused when a file is opened, not in the middle of an analysis."""
    if not file.colours:
        if channel is not None and channel.isdecimal() and channel != "1" and not any(n.startswith("channel ") for n in file.notes):
            raise DataError(f"{file.path}: has 1 channel; channel = {channel} is none of them, leave it out")
        return ()
    stored = file.read(0, 1)
    grey(stored, str(file.path), channel)
    return colour_notes(stored, channel)


def missing_numbers(paths: Sequence[Path]) -> tuple[str, ...]:
    """Return a note where the number that counts the files has gaps."""
    keys = [natural(path) for path in paths]
    if len(keys) < 3 or len({len(key) for key in keys}) > 1:
        return ()
    varying = [i for i, parts in enumerate(zip(*keys, strict=True)) if len(set(parts)) > 1]
    if len(varying) != 1 or not all(key[varying[0]][0] == 0 for key in keys):
        return ()
    numbers = np.array([key[varying[0]][1] for key in keys])
    # The smallest step is the rule: a sequence may keep every other frame.
    steps = np.diff(numbers)
    step = int(steps.min())
    if step < 1 or (steps == step).all():
        return ()
    jumps = np.flatnonzero(steps > step)
    absent = int((steps[jumps] // step - 1).sum())
    where = ", ".join(f"{paths[i].name} to {paths[i + 1].name}" for i in jumps[:3]) + (", ..." if jumps.size > 3 else "")
    what = "1 frame is" if absent == 1 else f"{absent} frames are"
    return (f"the files' numbers jump ({where}): {what} missing, times across the gaps are not to be trusted",)


RATE_TOLERANCE = 0.01  #: Relative difference between the file's frame rate and the user's above which a note names both.

_NUMPY, _HDF5, _NETCDF = (".npy", ".npz"), (".h5", ".hdf5", ".he5", ".hdf"), (".nc", ".nc4", ".cdf")
_ARRAY_ENDINGS = (*_NUMPY, *_HDF5, ".mat", *fits_images.ENDINGS, *_NETCDF, ".zarr")

FORMATS = (
    "Zarr (*.zarr), NetCDF (*.nc), PNG, TIFF, GIF, BMP, PGM and JPEG (file, folder or 'pattern*.png'), FITS (*.fits, *.fits.gz, "
    "*.fits.fz), NumPy (*.npy, *.npz), HDF5 (*.h5, *.hdf5), MATLAB (*.mat), video (*.mp4, *.avi, *.mkv, *.mov), raw (*.raw, *.bin, "
    "*.dat with a layout)"
)

#: What to do with formats that are not read.
_REMEDIES = {
    **dict.fromkeys((".seq", ".csq", ".fff", ".ptw", ".sfmov", ".ats", ".inc"), "a thermal camera's own format: export it as TIFF or FITS"),
    **dict.fromkeys((".jp2", ".j2k", ".jxl", ".webp", ".heic", ".avif", ".exr", ".dng"), "convert it to TIFF"),
    **dict.fromkeys((".zip", ".tar", ".tgz", ".gz", ".7z", ".rar", ".bz2", ".xz"), "unpack it first"),
    **dict.fromkeys((".grib", ".grb", ".grib2"), "convert it to NetCDF"),
    **dict.fromkeys((".csv", ".txt", ".xlsx"), "save the images with numpy.save"),
    **dict.fromkeys(
        (".webm", ".wmv", ".mpg", ".mpeg", ".m4v", ".ts", ".flv"), "convert it to lossless mkv: ffmpeg -i IN -c:v ffv1 OUT.mkv"
    ),
}


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
    missing: Sequence[float] = (),
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
        Name of the array in a file that holds several; of FITS also ``SCI,2``, the number of an extension, or ``SCI,*`` for all images of
        a name as frames.
    channel : str, optional
        Channel of true colour images, ``mean``, ``red``, ``green`` or ``blue``, or the number of one of several channels from 1; such
        images are refused otherwise.
    axes : str, optional
        Order of the axes of an array, of the letters t (frames), y (rows), x (columns) and c (channels): ``tyx`` (the default), ``yxt``,
        ``txy`` (an array that MATLAB's ``h5write`` wrote), ``tcyx``.
    saturation : float, optional
        Value from which on the sensor is saturated; overrules the format's full scale.
    missing : sequence of float, optional
        Stored numbers that are missing values, besides those that the file states.

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
    if channel is not None:
        require_channel(channel)
    if axes is not None:
        require_axes(axes)
    if saturation is not None and not np.isfinite(saturation):
        raise DataError(f"saturation = {saturation:g}; give a finite number")
    how = ArrayReading(variable, channel, axes, tuple(float(number) for number in missing))
    damage = (f"{path}: cannot be read", "is the file whole?")
    with library_errors(*damage):
        recording = _open(Path(path), raw, how)
    notes = recording.notes
    if axes is not None and not Path(path).name.lower().endswith(_ARRAY_ENDINGS) and not Path(path).is_dir():
        raise DataError(f"{path}: axes='{axes}' is for arrays ({', '.join(_ARRAY_ENDINGS)}); frames of other formats have their order")
    if frame_rate is not None and recording.frame_rate is not None and abs(frame_rate / recording.frame_rate - 1.0) > RATE_TOLERANCE:
        notes = (*notes, f"frame rate {frame_rate:g} Hz as given; the file says {recording.frame_rate:g} Hz")
    full = recording.saturation if saturation is None else saturation - recording.offset
    read_block = recording.read_block

    def read(start: int, stop: int) -> FrameArray:
        with library_errors(*damage):  # frames are decoded when they are read, long after the file was opened
            return read_block(start, stop)

    return replace(
        recording,
        frame_rate=frame_rate or recording.frame_rate,
        units=units or recording.units,
        saturation=full,
        notes=notes,
        read_block=read,
    )


def _open(path: Path, raw: RawLayout | None, how: ArrayReading) -> Recording:
    if any(sign in path.name for sign in "*?[") and not path.exists():
        matches = sorted(map(Path, glob.glob(str(path))), key=natural)
        if not matches:
            raise DataError(f"{path}: no file has such a name; check the pattern")
        return _open_several(matches, path, how)
    if not path.exists():
        raise DataError(f"{path}: no such file or folder; give one of {FORMATS}")
    if path.is_dir():
        return _open_folder(path, how)
    if path.stat().st_size == 0:
        raise DataError(f"{path}: is empty")
    name, ending = path.name.lower(), path.suffix.lower()
    if raw is not None or ending in (".raw", ".bin", ".dat"):
        return _with_missing(open_raw(path, raw if raw is not None else RawLayout.beside(path)), how)
    if ending in ENDINGS:
        return open_images([path], how.channel, how.missing)
    if ending in pictures.VIDEO_ENDINGS:
        return _with_missing(pictures.open_video(path, how.channel), how)
    if ending in _NUMPY:
        return arrays.open_numpy(path, how)
    if ending in _HDF5:
        return open_hdf5(path, how)
    if ending == ".mat":
        return open_matlab(path, how)
    if name.endswith(fits_images.ENDINGS):
        return fits_images.open_fits(path, how)
    if ending in _NETCDF:
        return open_labelled_netcdf(path, how)
    remedy = _REMEDIES.get(ending)
    raise DataError(f"{path}: {f'is not read, {remedy}' if remedy else 'format not known'}; give one of {FORMATS}")


def _with_missing(recording: Recording, how: ArrayReading) -> Recording:
    """Return a recording whose stored numbers that the user calls missing have no value."""
    if not how.missing:
        return recording
    read, decoding = recording.read_block, Decoding(how.missing)
    return replace(recording, read_block=lambda a, b: decoding.values(np.asarray(read(a, b)))).with_notes(*decoding.notes)


def _open_folder(path: Path, how: ArrayReading) -> Recording:
    if is_zarr(path):
        from seaglint.store.sequence_store import is_sequence, open_sequence

        ours = is_sequence(path)
        if ours:
            open_sequence(path).close()  # raises the error of an unfinished or damaged sequence
        return open_zarr(path, how, ours=ours)
    files = sorted((f for f in path.iterdir() if f.is_file() and not f.name.startswith(".")), key=natural)
    chosen = [f for f in files if f.suffix.lower() in ENDINGS] or [f for f in files if f.name.lower().endswith(_SEVERAL)]
    if not chosen:
        raise DataError(f"{path}: a folder without pictures (PNG, TIFF, GIF, BMP, PGM, JPEG) or FITS files; give one of {FORMATS}")
    return _open_several(chosen, path, how)


_SEVERAL = (*fits_images.ENDINGS, ".npy")  #: Endings of arrays of which a folder may hold a sequence.


_SPELLINGS = {".tiff": ".tif", ".jpeg": ".jpg", ".fit": ".fits", ".fts": ".fits"}  #: Endings of one kind.


def _open_several(files: list[Path], where: Path, how: ArrayReading) -> Recording:
    """Open the files of a folder or pattern, which are of one kind, in the order of their names."""
    endings = sorted({_SPELLINGS.get(f.suffix.lower(), f.suffix.lower()) for f in files})
    if all(f.name.lower().endswith(_SEVERAL) for f in files) and len(endings) == 1:
        first, last = files[0], files[-1]
        opened = [_open(f, None, how) for f in files]
        source = f"{first.parent} ({len(files)} files {first.name} ... {last.name})"
        return joined(opened, source).with_notes(*missing_numbers(files)) if len(files) > 1 else opened[0]
    if len(endings) > 1 or endings[0] not in ENDINGS:
        raise DataError(f"{where}: holds files {', '.join(endings)}; give a pattern for one kind of image, e.g. '*.png'")
    return open_images(files, how.channel, how.missing)
