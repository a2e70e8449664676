"""NetCDF 4 and HDF5, which are one: coordinates and attributes as xarray writes them, a compressed chunk for each frame.

HDF5 that meets a full disk ends the process with a fault when it closes the file. So the file is written by Python, and HDF5 is never
told that writing failed; it is asked after each frame.
"""

from __future__ import annotations

import io
import signal
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from seaglint.files.export.encoding import NumberFormat
from seaglint.files.export.export_format import ExportFormat

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seaglint.files.export.stack import Stack


class _Disk(io.RawIOBase):
    """A file that keeps its first failure to itself, and takes all that comes after it without writing."""

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
        """Zeros where nothing could be written."""
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
        """Raise what went wrong."""
        if self.failure is not None:
            raise self.failure


class Hdf5(ExportFormat):
    """NetCDF 4 and HDF5."""

    endings: ClassVar[tuple[str, ...]] = (".nc", ".h5")
    aliases: ClassVar[tuple[str, ...]] = (".hdf5",)

    @classmethod
    def stored(cls, numbers: NumberFormat, stack: Stack) -> NumberFormat:
        """Return 32-bit integers for counts that may be :data:`~seaglint.files.netcdf.MISTAKEN`; others as they are."""
        from seaglint.files.netcdf import MISTAKEN

        most = stack.images.attrs.get("saturation_counts", MISTAKEN)
        if numbers.dtype == np.uint16 and numbers.counts is None and most >= MISTAKEN:
            return NumberFormat(np.dtype(np.int32))
        return numbers

    @classmethod
    def write(cls, path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
        """Write coordinates, then the images one by one."""
        _write(path, stack, numbers, frames)


def _write(path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
    import h5netcdf

    from seaglint.files.export.stack import AXES
    from seaglint.files.netcdf import coordinate_encoding, plain_attributes
    from seaglint.files.stopping import stop_on_signal

    rest = stack.dataset.drop_vars(stack.variable)
    rest.attrs = plain_attributes(rest.attrs)
    attributes = plain_attributes(stack.images.attrs)
    beside = " ".join(str(name) for name in stack.images.coords if name not in AXES)
    if beside:
        attributes["coordinates"] = beside
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
        raise KeyboardInterrupt  # where nobody minds the signal: the file is not whole
