"""FITS: a cube of columns, rows and frames with linear axes of azimuth, elevation and time, and all that is known in one card.

Rows stay in the order of the run, the top one first: ``CDELT2`` is negative.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

import numpy as np

from seaglint.base.optional import optional
from seaglint.files.export.export_format import ExportFormat
from seaglint.version import __version__

if TYPE_CHECKING:
    import xarray as xr
    from numpy.typing import NDArray

    from seaglint.files.export.encoding import NumberFormat
    from seaglint.files.export.stack import Stack

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
        _write(path, stack, numbers, frames)


def _write(path: Path, stack: Stack, numbers: NumberFormat, frames: Iterable[NDArray[Any]]) -> None:
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
    """Type of FITS of the same size."""
    if dtype == np.int8:
        return np.dtype(np.uint8)
    return np.dtype(f"i{dtype.itemsize}") if dtype.kind == "u" and dtype.itemsize > 1 else dtype


def cards(stack: Stack, numbers: NumberFormat) -> list[Card]:
    """Cards of the header."""
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
    """Physical values of the numbers: ``BZERO + BSCALE * stored``."""
    half = 1 << (8 * stored.itemsize - 1)
    if numbers.counts is not None:
        scale, offset = numbers.counts.scale, numbers.counts.offset
        return [("BSCALE", scale, ""), ("BZERO", offset + scale * half, ""), ("BLANK", -half, "where there is no value")]
    if stored == numbers.dtype:
        return []
    return [("BSCALE", 1, ""), ("BZERO", -half if numbers.dtype == np.int8 else half, "")]


def _linear(values: xr.DataArray) -> tuple[float, float] | None:
    """First value and step of a coordinate of even steps; None of others."""
    numbers = values.to_numpy()
    if numbers.ndim != 1 or numbers.size < 2 or numbers.dtype.kind not in "uif":
        return None
    step = float(numbers[-1] - numbers[0]) / (numbers.size - 1)
    even = float(numbers[0]) + step * np.arange(numbers.size)
    return (float(numbers[0]), step) if step and float(np.abs(numbers - even).max()) < _EVEN * abs(step) else None


def _first_moment(dataset: xr.Dataset) -> str | None:
    """UTC of the first frame as FITS writes it, where the run has a date."""
    if "utc" not in dataset.coords:
        return None
    import xarray as xr

    # Runs are opened with their times as numbers.
    moment = xr.decode_cf(dataset[["utc"]].isel(time=[0]))["utc"].to_numpy()[0]
    return str(np.datetime_as_string(moment, unit="ms"))
