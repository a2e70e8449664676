"""Formats of exported runs, each a class with its endings, its files, and a method that writes frames one after the other.

- FITS: a cube of columns, rows and frames with linear axes of azimuth, elevation and time, and all metadata in one card. Rows stay in the
  order of the run, the top one first: ``CDELT2`` is negative.
- NetCDF 4 and HDF5, which are one: coordinates and attributes as xarray writes them, a compressed chunk for each frame. HDF5 that meets a
  full disk ends the process with a fault when it closes the file. So the file is written by Python, which hides failures from HDF5; they
  are checked after each frame.
- NumPy and raw: frames one after the other, little-endian, with a JSON header in a file beside them.
- TIFF: a page for each frame, uncompressed, which every reader opens, calibrated for ImageJ. Other metadata are JSON in ImageJ's Info.
"""

from __future__ import annotations

import io
import json
import signal
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from seaglint.base.free_form import JsonObject
from seaglint.base.optional import optional
from seaglint.formats.export.stack import NumberFormat
from seaglint.version import __version__

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from seaglint.formats.export.stack import Stack


class ExportFormat:
    """Format of an exported run; each is a class, listed in ``FORMATS`` of ``seaglint.formats.export``."""

    endings: ClassVar[tuple[str, ...]]  #: Endings of its files, in lower case.
    aliases: ClassVar[tuple[str, ...]] = ()  #: Other endings of the same files, which the help leaves out.
    note: ClassVar[str] = ""  #: Remark of the help on it.

    @classmethod
    def require(cls) -> None:
        """Refuse before the work where a library is missing.

        Raises
        ------
        BackendError
            The library is not installed.
        """

    @classmethod
    def header_path(cls, output: Path) -> Path | None:
        """Return the file of a JSON header beside the output; None for a format with a header inside the file."""
        return None

    @classmethod
    def stored(cls, numbers: NumberFormat, stack: Stack) -> NumberFormat:
        """Return the number format of the file; another than the requested one if readers of the format would misread that."""
        return numbers

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write frames one after the other."""
        raise NotImplementedError


_EVEN: Final = 1e-3  #: Part of a step by which a coordinate may be off its linear axis.

Card = tuple[str, Any, str]


class Fits(ExportFormat):
    """FITS cube; needs Astropy."""

    endings: ClassVar[tuple[str, ...]] = (".fits",)

    @classmethod
    def require(cls) -> None:
        """Refuse before the work where FITS cannot be written.

        Raises
        ------
        BackendError
            Astropy is not installed.
        """
        optional("astropy.io.fits", "FITS")

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write the cube, and directions that are no linear axis as images ``AZIMUTH`` and ``ELEVATION`` behind it."""
        from astropy.io import fits

        header = fits.Header()
        for keyword, value, comment in cards(stack, numbers):
            header[keyword] = (value, comment) if comment else value
        stored = _stored_type(numbers.dtype)
        flip = (numbers.dtype.kind == "u" and numbers.dtype.itemsize > 1) or numbers.dtype == np.int8
        cube = fits.StreamingHDU(str(path), header)
        try:
            for frame in frames:
                # FITS knows no unsigned integers beyond bytes: the highest bit turned over is half the scale taken off.
                cube.write((frame.view(stored) ^ np.asarray(1 << (8 * stored.itemsize - 1)).astype(stored)) if flip else frame)
        finally:
            cube.close()
        for name in ("azimuth", "elevation"):
            if name in stack.dataset.coords and _linear(stack.dataset[name]) is None:
                extension = fits.Header([("EXTNAME", name.upper()), ("BUNIT", "deg")])
                fits.append(str(path), stack.dataset[name].to_numpy().astype(np.float64), extension)


def _stored_type(dtype: np.dtype[Any]) -> np.dtype[Any]:
    """Return the FITS type of the same size."""
    if dtype == np.int8:
        return np.dtype(np.uint8)
    return np.dtype(f"i{dtype.itemsize}") if dtype.kind == "u" and dtype.itemsize > 1 else dtype


def cards(stack: Stack, numbers: NumberFormat) -> list[Card]:
    """Return the cards of the header."""
    frames, rows, columns = stack.shape
    stored = _stored_type(numbers.dtype)
    bits = 8 * stored.itemsize
    out: list[Card] = [
        ("SIMPLE", True, ""),
        ("BITPIX", -bits if stored.kind == "f" else bits, ""),
        ("NAXIS", 3, ""),
        ("NAXIS1", columns, "columns"),
        ("NAXIS2", rows, "rows, the top one first"),
        ("NAXIS3", frames, "frames"),
        ("EXTEND", True, ""),
        *_scaling(numbers, stored),
        ("VARIABLE", stack.variable, str(stack.images.attrs.get("long_name", ""))[:40]),
    ]
    if stack.units:
        out.append(("BUNIT", stack.units, "units of the physical values"))
    time = stack.dataset["time"] if "time" in stack.dataset.coords else None
    axes = (("1", "azimuth", "AZIMUTH", "deg"), ("2", "elevation", "ELEVATION", "deg"), ("3", "time", "TIME", "s"))
    for number, name, title, unit in axes:
        line = _linear(stack.dataset[name]) if name in stack.dataset.coords else None
        if line is not None:
            first, step = line
            out += [
                (f"CTYPE{number}", title, ""),
                (f"CUNIT{number}", unit, ""),
                (f"CRPIX{number}", 1.0, ""),
                (f"CRVAL{number}", first, "of the centre of the first"),
                (f"CDELT{number}", step, ""),
            ]
    # One frame has no steps: its time is written with the interval of the frame rate.
    if time is not None and time.size == 1:
        out += [("CTYPE3", "TIME", ""), ("CUNIT3", "s", ""), ("CRPIX3", 1.0, ""), ("CRVAL3", float(time[0]), "")]
        out += [("CDELT3", 1.0 / stack.frame_rate, "")] if stack.frame_rate else []
    if stack.frame_rate:
        out.append(("FRMRATE", stack.frame_rate, "frames per second [Hz]"))
    moment = _first_moment(stack.dataset)
    if moment:
        out += [("DATE-OBS", moment, "first frame"), ("TIMESYS", "UTC", "")]
    out += [
        ("CREATOR", f"seaglint {__version__}", ""),
        ("METADATA", json.dumps({**stack.metadata(), **numbers.attributes}, allow_nan=False), ""),
    ]
    return out


def _scaling(numbers: NumberFormat, stored: np.dtype[Any]) -> list[Card]:
    """Return the cards of the relation from stored numbers to physical values, ``BZERO + BSCALE * stored``."""
    # Stored numbers are the unsigned ones less half of the scale.
    half = 1 << (8 * stored.itemsize - 1)
    if numbers.counts is not None:
        scale, offset = numbers.counts.scale, numbers.counts.offset
        return [("BSCALE", scale, ""), ("BZERO", offset + scale * half, ""), ("BLANK", -half, "where there is no value")]
    if stored == numbers.dtype:
        return []
    return [("BSCALE", 1, ""), ("BZERO", -half if numbers.dtype == np.int8 else half, "")]


def _linear(values: xr.DataArray) -> tuple[float, float] | None:
    """Return first value and step of a coordinate of even steps; None for other coordinates."""
    numbers = values.to_numpy()
    if numbers.ndim != 1 or numbers.size < 2 or numbers.dtype.kind not in "uif":
        return None
    # The step over the whole axis has the smallest rounding.
    step = float(numbers[-1] - numbers[0]) / (numbers.size - 1)
    even = float(numbers[0]) + step * np.arange(numbers.size)
    return (float(numbers[0]), step) if step and float(np.abs(numbers - even).max()) < _EVEN * abs(step) else None


def _first_moment(dataset: xr.Dataset) -> str | None:
    """Return the UTC of the first frame in the form of FITS; None for a run without a date."""
    if "utc" not in dataset.coords:
        return None
    import xarray as xr

    # Runs are opened with their times as numbers.
    return str(np.datetime_as_string(xr.decode_cf(dataset[["utc"]].isel(time=[0]))["utc"].to_numpy()[0], unit="ms"))


class _Disk(io.RawIOBase):
    """File that records its first failure instead of raising it, and accepts all further content without writing."""

    def __init__(self, path: Path) -> None:
        self._file = path.open("w+b", buffering=0)
        self.failure: OSError | None = None

    def readable(self) -> bool:
        return True

    def writable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, place: int, whence: int = 0, /) -> int:
        return self._file.seek(place, whence)

    def tell(self) -> int:
        return self._file.tell()

    def truncate(self, size: int | None = None, /) -> int:
        try:
            return self._file.truncate(size)
        except OSError as error:
            self.failure = self.failure or error
            return size or 0

    def readinto(self, buffer: Any, /) -> int:
        """Read, with zeros in place of content that could not be written."""
        view = memoryview(buffer).cast("B")
        read = self._file.readinto(view) or 0
        view[read:] = bytes(len(view) - read)
        return len(view)

    def write(self, content: Any, /) -> int:
        view = memoryview(content).cast("B")
        done = 0
        try:
            while self.failure is None and done < len(view):
                done += self._file.write(view[done:])
        except OSError as error:
            self.failure = error
        return len(view)

    def close(self) -> None:
        self._file.close()
        super().close()

    def require(self) -> None:
        """Raise the recorded failure."""
        if self.failure is not None:
            raise self.failure


class Hdf5(ExportFormat):
    """NetCDF 4 and HDF5."""

    endings: ClassVar[tuple[str, ...]] = (".nc", ".h5")
    aliases: ClassVar[tuple[str, ...]] = (".hdf5",)

    @classmethod
    def stored(cls, numbers: NumberFormat, stack: Stack) -> NumberFormat:
        """Return 32-bit integers for counts that may be ``MISTAKEN``; other formats unchanged."""
        from seaglint.store.netcdf import MISTAKEN

        if numbers.dtype == np.uint16 and numbers.counts is None and stack.images.attrs.get("saturation_counts", MISTAKEN) >= MISTAKEN:
            return NumberFormat(np.dtype(np.int32))
        return numbers

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write coordinates, then the images one by one."""
        import h5netcdf

        from seaglint.formats.export.stack import AXES
        from seaglint.store.netcdf import coordinate_encoding, plain_attributes
        from seaglint.store.outputs import stop_on_signal

        rest = stack.dataset.drop_vars(stack.variable)
        rest.attrs = plain_attributes(rest.attrs)
        attributes = plain_attributes(stack.images.attrs)
        coordinates = " ".join(str(name) for name in stack.images.coords if name not in AXES)
        if coordinates:
            attributes["coordinates"] = coordinates
        # A signal that interrupts Python inside HDF5 is a failed write to it: wait for the frame's end.
        with stop_on_signal() as stopped:
            disk = _Disk(path)
            try:
                disk.write(rest.to_netcdf(engine="h5netcdf", encoding=coordinate_encoding(rest)))
                disk.require()
                with h5netcdf.File(disk, "a") as file:
                    for name, size in zip(AXES, stack.shape, strict=True):
                        if name not in file.dimensions:
                            file.dimensions[name] = size
                    images = file.create_variable(
                        stack.variable, AXES, numbers.dtype, fillvalue=numbers.attributes.get("_FillValue"), chunks=(1, *stack.shape[1:]),
                        compression="gzip", compression_opts=3, shuffle=True,
                    )  # fmt: skip
                    for name, value in {**attributes, **numbers.attributes}.items():
                        if name != "_FillValue":
                            images.attrs[name] = value
                    for i, frame in enumerate(frames):
                        images[i] = frame
                        disk.require()
                        if stopped:
                            break
                disk.require()
            finally:
                disk.close()
        if stopped:
            signal.raise_signal(stopped[0])
            raise KeyboardInterrupt  # for callers that ignore the signal: the file is not whole


class Npy(ExportFormat):
    """Array (time, y, x) as ``numpy.save`` writes it."""

    endings: ClassVar[tuple[str, ...]] = (".npy",)

    @classmethod
    def header_path(cls, output: Path) -> Path:
        """Return ``X.npy.json`` of ``X.npy``.

        >>> Npy.header_path(Path("X.npy")).name
        'X.npy.json'
        """
        return output.with_name(output.name + ".json")

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write the array's header and the numbers."""
        _write_plain(path, numbers, frames, stack.shape)


class Raw(ExportFormat):
    """The numbers and nothing else."""

    endings: ClassVar[tuple[str, ...]] = (".raw",)
    note: ClassVar[str] = "with a JSON header"

    @classmethod
    def header_path(cls, output: Path) -> Path:
        """Return ``X.json`` of ``X.raw``, where raw data are expected to have it.

        >>> Raw.header_path(Path("X.raw")).name
        'X.json'
        """
        return output.with_suffix(".json")

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write the numbers."""
        _write_plain(path, numbers, frames, None)


def header(stack: Stack, numbers: NumberFormat) -> JsonObject:
    """Return the layout with the names of ``RawLayout``, and other metadata in ``metadata``."""
    _, rows, columns = stack.shape
    table = {
        "rows": rows,
        "columns": columns,
        "dtype": numbers.dtype.name,
        "byte_order": "little",
        "offset": 0,
        "frame_header": 0,
        "frame_rate": stack.frame_rate,
        "units": "count" if numbers.counts else stack.units or None,
        "metadata": {**stack.metadata(), **numbers.attributes},
    }
    return {name: value for name, value in table.items() if value is not None}


def write_header(path: Path, stack: Stack, numbers: NumberFormat) -> None:
    """Write the JSON header."""
    path.write_text(json.dumps(header(stack, numbers), indent=1, allow_nan=False) + "\n", encoding="utf-8")


def _write_plain(path: Path, numbers: NumberFormat, frames: Iterable[NDArray[Any]], shape: tuple[int, ...] | None) -> None:
    # One byte order on all machines, as the header states.
    little = numbers.dtype.newbyteorder("<")
    with path.open("wb") as file:
        if shape is not None:
            table = {"descr": np.lib.format.dtype_to_descr(little), "fortran_order": False, "shape": shape}
            np.lib.format.write_array_header_1_0(file, table)
        for frame in frames:
            file.write(frame.astype(little, copy=False).tobytes())


#: Bytes that places of 32 bits reach, less the pages' own tables; larger files are BigTIFF, which ImageJ does not read alone.
_SMALL: Final = (1 << 32) - (1 << 25)

#: Types of numbers that ImageJ has; files of others, and BigTIFF, hold the JSON as their description.
_IMAGEJ: Final = ("uint8", "uint16", "float32")


class Tiff(ExportFormat):
    """Stack of TIFF pages."""

    endings: ClassVar[tuple[str, ...]] = (".tif",)
    aliases: ClassVar[tuple[str, ...]] = (".tiff",)

    @classmethod
    def require(cls) -> None:
        """Refuse before the work where TIFF cannot be written.

        Raises
        ------
        BackendError
            tifffile is not installed.
        """
        optional("tifffile", "TIFF")

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write a page for each frame."""
        tifffile = optional("tifffile", "TIFF")

        count, rows, columns = stack.shape
        text = json.dumps({**stack.metadata(), **numbers.attributes}, allow_nan=False)
        # A page takes its pixels and a table of some 300 bytes.
        big = count * (rows * columns * numbers.dtype.itemsize + 512) + len(text) > _SMALL
        known = numbers.dtype in _IMAGEJ and not big
        about: dict[str, Any] = {"description": text, "metadata": None}
        if known:
            about = {"metadata": _calibration(stack, numbers, text), "resolution": _per_pixel(stack)}
        about |= {"shape": stack.shape, "dtype": numbers.dtype, "photometric": "minisblack", "software": f"seaglint {__version__}"}
        with tifffile.TiffWriter(path, bigtiff=big, imagej=known) as file:
            file.write(iter(frames), **about)


def _calibration(stack: Stack, numbers: NumberFormat, text: str) -> dict[str, Any]:
    """Return properties that ImageJ reads: unit of length, interval of the frames [s], unit and straight line of the values."""
    values: dict[str, Any] = {"vunit": stack.units or "Gray Value"}
    if numbers.counts is not None:  # function 0 is a straight line from c0 with slope c1
        values = {"cf": 0, "c0": numbers.counts.offset, "c1": numbers.counts.scale, **values}
    rate = stack.frame_rate
    times = {} if rate is None else {"finterval": 1.0 / rate, "fps": rate}
    return {"axes": "TYX", "unit": "pixel" if _steps(stack) is None else "deg", **times, **values, "Info": text}


def _steps(stack: Stack) -> tuple[float, float] | None:
    """Return the angle between columns and between rows [deg] where they are even; None for other cameras."""
    axes = [stack.dataset.coords.get(name) for name in ("azimuth", "elevation")]
    if any(axis is None or axis.ndim != 1 or axis.size < 2 for axis in axes):
        return None
    across, down = (abs(float(axis[-1] - axis[0])) / (axis.size - 1) for axis in axes if axis is not None)
    return across, down


def _per_pixel(stack: Stack) -> tuple[float, float]:
    """Return the pixels per unit of length along columns and rows."""
    steps = _steps(stack)
    return (1.0, 1.0) if steps is None else (1.0 / steps[0], 1.0 / steps[1])
