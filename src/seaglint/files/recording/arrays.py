"""Readers of arrays: NumPy, HDF5, FITS, and NetCDF or Zarr of other programs; (rows, columns) or (frames, rows, columns)."""

from __future__ import annotations

import math
import mmap
import zipfile
import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.analysis.recording import Recording
from seaglint.base.errors import DataError
from seaglint.base.free_form import Attributes
from seaglint.base.optional import optional
from seaglint.base.schema import default_image
from seaglint.files.netcdf import open_netcdf
from seaglint.files.recording.stored import full_scale, grey

RESOLVED: Final = 1000.0
"""Smallest spread of the values in steps of single precision; below it an offset is subtracted."""

AXES: Final = ("tyx", "yxt")
"""Orders of a three-dimensional array: frames first (the default) or last."""


@dataclass(frozen=True)
class ArrayReading:
    """Properties of an array that the user states in place of its file.

    Attributes
    ----------
    variable : str or None
        Name of the array in a file that holds several.
    channel : str or None
        Channel of true colour images.
    axes : str or None
        Order of the axes, one of :data:`AXES`.
    """

    variable: str | None = None
    channel: str | None = None
    axes: str | None = None


def of_array(
    array: Any, source: str, how: ArrayReading, *, frame_rate: float | None = None, units: str | None = None, named_axes: bool = False
) -> Recording:
    """Return frames of anything with ``shape``, ``dtype`` and slices: numbers (r, c), (f, r, c), or colours (r, c, 3|4), (f, r, c, 3|4)."""
    shape, dtype = tuple(int(s) for s in array.shape), np.dtype(array.dtype)
    if dtype.kind not in "uifb":
        raise DataError(f"{source}: holds {dtype}, not real numbers; give radiances or counts")
    if how.axes == "yxt":
        if len(shape) != 3:
            raise DataError(f"{source}: has shape {shape}; axes='yxt' is for (rows, columns, frames)")
        array, shape = _TimeLast(array), (shape[2], shape[0], shape[1])
    coloured = how.axes is None and (
        (len(shape) == 4 and shape[-1] in (1, 2, 3, 4)) or (len(shape) == 3 and shape[-1] in (3, 4) and shape[0] > 4)
    )
    image = shape[-3:-1] if coloured else shape[-2:]
    single = len(shape) == (3 if coloured else 2)
    if len(shape) not in (2, 3, 4) or (len(shape) == 4 and not coloured) or 0 in shape:
        raise DataError(f"{source}: has shape {shape}; give (rows, columns) or (frames, rows, columns)")

    def read(start: int, stop: int) -> NDArray[Any]:
        try:
            block = np.asarray(array[...] if single else array[start:stop])
        except (OSError, ValueError, RuntimeError) as error:
            raise DataError(f"{source}: frames {start}:{stop} cannot be read ({error}); the file is cut") from error
        block = _released(block)
        block = block[np.newaxis] if single else block
        return grey(block, source, how.channel) if coloured else block

    saturation = full_scale(dtype) if dtype.kind in "ui" else None
    frames = 1 if single else shape[0]
    notes: tuple[str, ...] = ()
    if not (named_axes or single or coloured or how.axes) and shape[2] < min(shape[0], shape[1]):
        notes = (
            f"shape {shape} taken as {frames} frames of {shape[1]} rows, {shape[2]} columns; if time is the last axis, give --axes yxt",
        )
    recording = Recording(source, frames, image[0], image[1], read, frame_rate, units, saturation, notes)
    return _resolved(recording) if dtype.itemsize > 2 and dtype != np.float32 else recording


class _TimeLast:
    """Array (rows, columns, frames), sliced along its frames."""

    def __init__(self, array: Any) -> None:
        self._array, self.dtype = array, array.dtype

    def __getitem__(self, key: slice) -> NDArray[Any]:
        return np.moveaxis(np.asarray(self._array[:, :, key]), 2, 0)


def _released(block: NDArray[Any]) -> NDArray[Any]:
    """Return a copy of a part of a memory-mapped file, whose pages are released: they count as the process's memory."""
    base: Any = block
    while base is not None and not isinstance(base, mmap.mmap):
        base = base.obj if isinstance(base, memoryview) else getattr(base, "base", None)
    if base is None:
        return block
    block = block.copy()
    if hasattr(mmap, "MADV_DONTNEED"):
        base.madvise(mmap.MADV_DONTNEED)
    return block


def _resolved(recording: Recording) -> Recording:
    """Subtract the level of values whose spread single precision would round away; refuse values beyond its range."""
    first = np.asarray(recording.read_block(0, 1), np.float64)
    first = first[np.isfinite(first)]
    if not first.size:
        return recording
    largest = float(np.abs(first).max())
    if largest > 1e30 or 0.0 < largest < 1e-30:
        raise DataError(f"{recording.source}: values of {largest:.3g} are beyond single precision; scale them to 1e-30 to 1e30")
    level, spread = float(np.median(first)), float(first.std())
    if not 0.0 < spread < RESOLVED * float(np.finfo(np.float32).eps) * abs(level):
        return recording
    level = round(level, -math.floor(math.log10(spread)))  # a number that can be read
    saturation = None if recording.saturation is None else recording.saturation - level
    note = f"{level:.9g} taken off the values before they are rounded to single precision, and added to means and fits again"
    return replace(recording, offset=level, saturation=saturation).with_notes(note)


def open_numpy(path: Path, how: ArrayReading) -> Recording:
    """Open ``.npy``, memory-mapped, or one array of an ``.npz``, which is read as a whole."""
    try:
        loaded = np.load(path, mmap_mode="r" if path.suffix == ".npy" else None, allow_pickle=False)
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise DataError(f"{path}: cannot be read as NumPy ({error}); save plain numbers with numpy.save") from error
    if isinstance(loaded, np.ndarray):
        return of_array(loaded, str(path), how)
    name = _choose(dict.fromkeys(loaded.files), how.variable, path)
    try:
        array = loaded[name]
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise DataError(f"{path}: {name} cannot be read ({error}); the file is cut") from error
    return of_array(array, f"{path}:{name}", how)


def open_hdf5(path: Path, how: ArrayReading) -> Recording:
    """Open a dataset of an HDF5 file (also MATLAB 7.3): its only one of two or three dimensions, or ``variable``."""
    import h5py

    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise DataError(f"{path}: cannot be read as HDF5 ({error})") from error
    datasets: dict[str, Any] = {}

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and item.ndim in (2, 3, 4) and item.dtype.kind in "uif":
            datasets[name] = item

    file.visititems(visit)
    name = _choose(datasets, how.variable, path)
    array = datasets[name]
    rate = _rate(dict(array.attrs)) or _rate(dict(file.attrs))
    return of_array(_unpacked(array), f"{path}:{name}", how, frame_rate=rate, units=_text(array.attrs.get("units")))


def _unpacked(array: Any) -> Any:
    """Return a dataset with its scale and offset by their CF names applied, where it has any."""
    scale, zero, blank = (
        None if array.attrs.get(name) is None else np.ravel(array.attrs[name])[0] for name in ("scale_factor", "add_offset", "_FillValue")
    )
    if scale is None and zero is None:
        return array
    return _Scaled(array, 1.0 if scale is None else float(scale), 0.0 if zero is None else float(zero), blank)


def open_fits(path: Path, how: ArrayReading) -> Recording:
    """Open the first image of a FITS file, or the extension ``variable``; rows stay in the order of the file."""
    fits = optional("astropy.io.fits", f"{path}: FITS")

    try:
        file = fits.open(path, memmap=True, do_not_scale_image_data=True)  # scaled memory maps are refused
        images = {(hdu.name or str(i)): hdu for i, hdu in enumerate(file) if hdu.is_image and hdu.header.get("NAXIS", 0) >= 2}
    except Exception as error:
        raise DataError(f"{path}: cannot be read as FITS ({error})") from error
    name = _choose(images, how.variable or (next(iter(images)) if images else None), path)
    hdu = images[name]
    scaled = hdu.header.get("BSCALE", 1) != 1 or hdu.header.get("BZERO", 0) != 0 or "BLANK" in hdu.header
    try:
        card = hdu.header.get
        array = _Scaled(hdu.data, float(card("BSCALE", 1.0)), float(card("BZERO", 0.0)), card("BLANK")) if scaled else hdu.data
        recording = of_array(array, f"{path}:{name}", how, units=_text(hdu.header.get("BUNIT")))
    except (TypeError, ValueError, OSError) as error:
        raise DataError(f"{path}: is cut ({error}); copy it again") from error
    # FITS has signed integers only: 16 bits of a camera are stored with an offset of half the scale.
    bits, offset = int(hdu.header["BITPIX"]), float(hdu.header.get("BZERO", 0))
    full = float(2**bits - 1) if scaled and bits in (8, 16) and offset == 2 ** (bits - 1) else recording.saturation
    return replace(recording, frame_rate=_rate({"fps": hdu.header.get("FRMRATE", hdu.header.get("FPS"))}), saturation=full)


class _Scaled:
    """Stored numbers whose scale, offset and blank value are applied on reading."""

    def __init__(self, stored: Any, scale: float, zero: float, blank: Any) -> None:
        self._stored, self.shape, self.dtype = stored, stored.shape, np.dtype(np.float32)
        self._scale, self._zero, self._blank = scale, zero, blank

    def __getitem__(self, key: Any) -> NDArray[Any]:
        stored = np.asarray(self._stored[key])
        values = stored * self._scale + self._zero
        return values if self._blank is None else np.where(stored == self._blank, np.nan, values)


def open_labelled(path: Path, how: ArrayReading) -> Recording:
    """Open NetCDF or Zarr, of seaglint or with any variable of (time, rows, columns)."""
    import xarray as xr

    if path.is_dir():
        try:
            dataset = xr.open_dataset(str(path), engine="zarr", chunks=None, decode_times=False, consolidated=False)
        except Exception as error:
            reason = " ".join(str(error).split())[:200] or type(error).__name__
            raise DataError(f"{path}: cannot be read as Zarr ({reason})") from error
    else:
        dataset = open_netcdf(path, chunks=None, decode_times=False)
    return of_dataset(dataset, str(path), how)


def of_dataset(dataset: Any, source: str, how: ArrayReading) -> Recording:
    """Return the image variable of an :class:`xarray.Dataset`: the chosen one, the default (counts before radiance), or the only
    one; read when needed.
    """
    images = {str(n): v for n, v in dataset.data_vars.items() if v.ndim in (2, 3) and v.dtype.kind in "uif"}
    name = _choose(images, how.variable or default_image(images), source)
    chosen = images[name]
    recording = of_array(
        _Lazy(chosen),
        f"{source}:{name}",
        how,
        frame_rate=stored_frame_rate(dataset, chosen),
        units=_text(chosen.attrs.get("units")),
        named_axes=chosen.dims[0] == "time",
    )
    full = chosen.attrs.get("saturation_counts")
    return recording if full is None else replace(recording, saturation=float(full))


class _Lazy:
    """Labelled variable that is read by slices."""

    def __init__(self, variable: Any) -> None:
        self._variable, self.shape, self.dtype = variable.variable, variable.shape, variable.dtype

    def __getitem__(self, key: Any) -> NDArray[Any]:
        return np.asarray(self._variable[key].to_numpy())


def stored_frame_rate(dataset: Any, images: Any) -> float | None:
    """Return the frames per second [Hz] of images in a dataset.

    That of the time coordinate where this is even and the attributes say something else: a selection of every other frame keeps the
    attributes.
    """
    rate, even = _rate(dataset.attrs) or _rate(dict(images.attrs)), _spacing(dataset)
    return even if rate is None or (even is not None and abs(even / rate - 1.0) > 1e-3) else rate


def _spacing(dataset: Any) -> float | None:
    """Return the frame rate of evenly spaced times in seconds."""
    if "time" not in dataset.variables or dataset["time"].size < 2 or dataset["time"].attrs.get("units") != "s":
        return None
    steps = np.diff(dataset["time"].to_numpy())
    middle = float(np.median(steps))
    return 1.0 / middle if middle > 0.0 and np.all(np.abs(steps - middle) < 1e-3 * middle) else None


def _rate(attributes: Attributes) -> float | None:
    for name in ("frame_rate", "frame_rate_hz", "fps"):
        value = attributes.get(name)
        if value is not None:
            try:
                rate = float(np.ravel(value)[0])
            except (TypeError, ValueError):
                continue
            if np.isfinite(rate) and rate > 0.0:
                return rate
    return None


def _text(value: Any) -> str | None:
    text = value.decode() if isinstance(value, bytes) else value
    return str(text) if text else None


def _choose(available: dict[str, Any], requested: str | None, path: str | Path) -> str:
    names = ", ".join(available) or "none"
    if requested is not None:
        if requested not in available:
            raise DataError(f"{path}: has no image variable '{requested}'; it has {names}")
        return requested
    if len(available) != 1:
        raise DataError(f"{path}: {'several image variables' if available else 'no image variable'} ({names}); give one as variable")
    return next(iter(available))
