"""Attributes of a file's images: the band, and the directions of the pixels."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.netcdf import open_netcdf
from seaglint.files.provenance import stored_band
from seaglint.files.recording.labelled import is_zarr
from seaglint.optics.band import Band

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Source:
    """Attributes of a recording beside its pixel values."""

    band: Band | None = None
    step: tuple[float, float] | None = None  #: Return the angle between columns and between rows [rad].
    azimuth_deg: FloatArray | None = None
    elevation_deg: FloatArray | None = None
    frames: range | None = None  #: Return the numbers of the frames in the sequence that they belong to.

    @classmethod
    def of(cls, dataset: xr.Dataset) -> Source:
        """Return the attributes of a labelled dataset, where it has them."""
        try:
            band = stored_band(dataset.attrs)
        except (KeyError, TypeError, ValueError):
            band = None
        axes = [dataset[name].to_numpy().astype(np.float64) if name in dataset.variables else None for name in ("azimuth", "elevation")]
        azimuth, elevation = (a if a is not None and a.ndim == 1 and a.size > 1 else None for a in axes)
        if azimuth is None or elevation is None:
            return cls(band, frames=_numbers(dataset))
        step = tuple(float(np.radians(abs(a[-1] - a[0]) / (a.size - 1))) for a in (azimuth, elevation))
        return cls(band, (step[0], step[1]), azimuth, elevation, _numbers(dataset))


def _numbers(dataset: xr.Dataset) -> range | None:
    """Return the numbers of consecutive frames."""
    if "frame" not in dataset.variables:
        return None
    numbers = np.atleast_1d(dataset["frame"].to_numpy())
    if numbers.ndim != 1 or numbers.size == 0 or numbers.dtype.kind not in "iu" or np.any(np.diff(numbers) != 1) or numbers[0] < 0:
        return None
    return range(int(numbers[0]), int(numbers[-1]) + 1)


def _of_zarr(path: Path) -> Source | None:
    """Return the attributes of a Zarr store; None for one without names of dimensions, which has none of ours."""
    import xarray as xr

    try:
        dataset = xr.open_dataset(str(path), engine="zarr", chunks=None, decode_times=False, consolidated=False)
    except (KeyError, ValueError, FileNotFoundError):
        return None
    with dataset:
        return Source.of(dataset)


def source_of(path: Path) -> Source | None:
    """Return the attributes of a Zarr store or NetCDF file; None for other files.

    Raises
    ------
    DataError
        A file that cannot be read.
    """
    try:
        if is_zarr(path):
            return _of_zarr(path)
        if path.suffix.lower() in (".nc", ".nc4"):
            with open_netcdf(path, decode_times=False) as dataset:
                return Source.of(dataset)
    except DataError:
        raise
    except Exception as error:
        reason = " ".join(str(error).split())[:200] or type(error).__name__
        raise DataError(f"{path}: cannot be read ({reason}); is the file whole?") from error
    return None
