"""Images of stored sequences and maps: radiance from counts, lines of sight of the pixels, and statistics of a sequence.

Counts of a detector become radiance by the linear relation in the attributes of ``signal``.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.errors import DataError
from seaglint.base.representation import rounded
from seaglint.base.schema import ARTICLE_RADIANCE_PER_SI, ARTICLE_RADIANCE_SYMBOL, default_image
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.optics.band import Band, apparent_temperature
from seaglint.store.provenance import stored_band

if TYPE_CHECKING:
    import xarray as xr


def pictures(dataset: xr.Dataset) -> xr.DataArray:
    """Return the variable of the images: ``signal``, or else ``radiance``.

    Raises
    ------
    DataError
        A dataset that has neither.
    """
    name = default_image(map(str, dataset.data_vars))
    if name is not None and name != "texture":
        return dataset[name]
    available = ", ".join(map(str, dataset.data_vars)) or "none"
    raise DataError(
        f"the dataset has no variable 'radiance' (it has: {available}); give the variable itself, e.g. dataset['path_radiance'], or counts "
        "as 'signal'"
    )


def count_line(variable: xr.DataArray) -> tuple[float, float]:
    """Return the radiance of one count and of zero counts [W m-2 sr-1]; (1, 0) for a variable that is radiance.

    Raises
    ------
    DataError
        Counts without their line.
    """
    return line_of(str(variable.name), variable.attrs)


def line_of(name: str, attributes: Mapping[str, Any]) -> tuple[float, float]:
    """Return the line of ``count_line`` of a variable by its name and attributes."""
    if name != "signal":
        return 1.0, 0.0
    try:
        return float(attributes["radiance_scale"]), float(attributes["radiance_offset"])
    except (KeyError, TypeError, ValueError):
        raise DataError(
            "signal lacks its attributes radiance_scale and radiance_offset, which make radiance of counts; give a file that "
            "'seaglint render' or 'seaglint sense' wrote"
        ) from None


def radiance_of(dataset: xr.Dataset) -> xr.DataArray:
    """Return the radiance of a dataset [W m-2 sr-1]: stored, or from its counts."""
    images = pictures(dataset)
    if images.name == "radiance":
        return images
    scale, offset = count_line(images)
    from seaglint.base.schema import VARIABLES

    return (images.astype("float64") * scale + offset).rename("radiance").assign_attrs(VARIABLES["radiance"].attributes)


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
        Of a shape that broadcasts to (ny, nx); None for a dataset without the height of its sensor.
    """
    try:
        if "sensor_height" in dataset.variables:
            # A moving sensor has a height for each frame, a fixed one a single height.
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


#: Radiance over that of a blackbody at the water's temperature from which a pixel counts as glint: most of it is sunlight.
GLINT_FACTOR: Final = 2.0

_GRID_STEP: Final = 5.0  # cm-1; the blackbody is smooth, so the step only has to resolve the response
_FALLBACK_SEA: Final = 288.15


def grid_of(band: Band) -> FloatArray:
    """Return the wavenumbers on which a blackbody is integrated over the band [cm-1]."""
    low, high = 1e4 / band.max_um, 1e4 / band.min_um
    return np.linspace(low, high, max(int((high - low) / _GRID_STEP) + 2, 16))


def to_temperature(radiance: Any, band: Band) -> FloatArray:
    """Return the apparent temperature [K] of band radiances [W m-2 sr-1]; NaN for zero."""
    return apparent_temperature(radiance, band, grid_of(band))


@dataclass(frozen=True)
class Summary:
    """Statistics of a sequence over all pixels and frames."""

    frames: int
    mean: float  #: Mean radiance [W m-2 sr-1].
    peak: float  #: Largest radiance [W m-2 sr-1].
    mean_apparent_temperature: float  #: Apparent temperature of the mean radiance [K].
    peak_apparent_temperature: float  #: Apparent temperature of the largest radiance [K].
    glint_fraction: float  #: Share of the pixels more than ``GLINT_FACTOR`` times as bright as a blackbody at the water's temperature.
    non_finite: int  #: Pixels that are NaN or infinite.

    @property
    def line(self) -> str:
        """Summary in one line, in both radiance units."""
        u = ARTICLE_RADIANCE_PER_SI
        bad = f", {self.non_finite} pixels not finite" if self.non_finite else ""
        return (
            f"{self.frames} frame{'s' if self.frames != 1 else ''}, mean {rounded(self.mean, 4)} W m⁻² sr⁻¹ ({rounded(u * self.mean, 4)} "
            f"{ARTICLE_RADIANCE_SYMBOL}, {self.mean_apparent_temperature:.1f} K), peak {rounded(self.peak, 4)} "
            f"({rounded(u * self.peak, 4)}, {self.peak_apparent_temperature:.1f} K), "
            f"{100.0 * self.glint_fraction:.3g} % of the pixels over twice the water's blackbody radiance{bad}"
        )

    def as_dict(self) -> dict[str, float | int]:
        """Return plain values, for JSON."""
        return asdict(self)


def sea_temperature(dataset: xr.Dataset) -> float:
    """Return the temperature of the water in the scenario that made a dataset [K]."""
    try:
        return float(json.loads(dataset.attrs["scenario"])["sea"]["temperature_k"])
    except (KeyError, ValueError, TypeError):
        return _FALLBACK_SEA


def summarise(dataset: xr.Dataset) -> Summary:
    """Return statistics of ``radiance``, frame by frame, so that memory does not grow with the sequence; unfinished frames are left out."""
    band = stored_band(dataset.attrs)
    threshold = GLINT_FACTOR * float(band.radiance(sea_temperature(dataset), grid_of(band)))
    total, peak, glint, pixels, bad, frames = 0.0, 0.0, 0, 0, 0, 0
    for image in images(dataset):
        values = image[np.isfinite(image)]
        frames += 1
        bad += image.size - values.size
        pixels += values.size
        total += float(values.sum(dtype=np.float64))
        peak = max(peak, float(values.max(initial=0.0)))
        glint += int(np.count_nonzero(values > threshold))
    mean = total / pixels if pixels else float("nan")
    temperatures = to_temperature(np.array([mean, peak]), band)
    return Summary(frames, mean, peak, float(temperatures[0]), float(temperatures[1]), glint / max(pixels, 1), bad)


class Images:
    """Images of one variable read one at a time; counts as radiance."""

    def __init__(self, variable: xr.DataArray, indices: NDArray[np.intp], line: tuple[float, float] = (1.0, 0.0)) -> None:
        self._variable, self.indices, self._line = variable, indices, line

    def __len__(self) -> int:
        return int(self.indices.size)

    def __getitem__(self, position: int) -> NDArray[np.float32]:
        values = self._variable[int(self.indices[position])].to_numpy()
        scale, offset = self._line
        return np.asarray(values if self._line == (1.0, 0.0) else values * scale + offset, dtype=np.float32)

    def __iter__(self) -> Iterator[NDArray[np.float32]]:
        return (self[position] for position in range(len(self)))


def images(dataset: xr.Dataset, variable: str | None = None) -> Images:
    """Return images frame by frame (a map is one frame), by default of radiance, from counts if need be; unfinished frames are left out."""
    values = pictures(dataset) if variable is None else dataset[variable]
    line = count_line(values) if variable is None else (1.0, 0.0)
    if "time" not in values.dims:
        return Images(values.expand_dims("time").transpose("time", "y", "x"), np.arange(1), line)
    done = dataset["frame_done"].to_numpy() if "frame_done" in dataset else np.ones(values.sizes["time"])
    return Images(values, np.flatnonzero(done), line)
