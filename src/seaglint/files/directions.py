"""Lines of sight of a stored image's pixels, whatever the camera."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.imaging.camera.imager import Attitude, Imager

if TYPE_CHECKING:
    import xarray as xr


def directions(dataset: xr.Dataset, frame: int = 0) -> tuple[FloatArray, FloatArray]:
    """Return azimuth and elevation of the pixel centres of one frame [deg].

    Parameters
    ----------
    dataset : xarray.Dataset
        A sequence or map.
    frame : int
        Place of the frame in the sequence; matters where the sensor turns.

    Returns
    -------
    (ndarray, ndarray)
        Of the columns (nx,) and rows (ny,) where the image is a grid of them, else of all pixels (ny, nx).
    """
    if "azimuth" in dataset.variables:
        return tuple(dataset[name].to_numpy().astype(np.float64) for name in ("azimuth", "elevation"))  # type: ignore[return-value]
    sensor = json.loads(dataset.attrs["scenario"])["sensor"]
    width, height = (float(np.radians(angle)) for angle in sensor["fov_deg"])
    imager = Imager(sensor["projection"], width, height, *sensor["pixels"])
    pose = (float(np.radians(dataset[f"sensor_{name}"][frame])) for name in ("azimuth", "elevation", "roll"))
    azimuth, elevation = imager.centres(Attitude(*pose))
    return np.degrees(azimuth), np.degrees(elevation)
