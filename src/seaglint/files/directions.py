"""Lines of sight of a stored image's pixels, whatever the camera."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import numpy as np

from seaglint.base.conventions import FloatArray, horizon_depression
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


def below_horizon(dataset: xr.Dataset, frame: int = 0) -> FloatArray | None:
    """Return the angle of the pixels of one frame below the sea's horizon, negative in the sky [deg].

    Returns
    -------
    ndarray or None
        Of a shape that broadcasts to (ny, nx); None where the dataset does not say where its sensor is.
    """
    try:
        if "sensor_height" in dataset.variables:
            heights = np.atleast_1d(dataset["sensor_height"].to_numpy())
            height = float(heights[min(frame, heights.size - 1)])
        else:
            height = float(json.loads(dataset.attrs["scenario"])["sensor"]["height_m"])
        elevation = directions(dataset, frame)[1]
    except (KeyError, ValueError, TypeError):
        return None
    if not height > 0.0:
        return None
    if elevation.ndim == 1:
        elevation = elevation[:, np.newaxis]
    return -elevation - float(np.degrees(horizon_depression(height)))
