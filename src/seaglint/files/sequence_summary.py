"""Statistics of a sequence in a few numbers: mean, peak, apparent temperatures, share of glint."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.representation import rounded
from seaglint.base.schema import ARTICLE_RADIANCE_PER_SI, ARTICLE_RADIANCE_SYMBOL
from seaglint.files.counts import count_line, pictures
from seaglint.files.provenance import stored_band
from seaglint.optics.band import Band, apparent_temperature

if TYPE_CHECKING:
    import xarray as xr

#: A pixel counts as glint when it is this many times as bright as a blackbody at the water's temperature: the Sun gives most of it.
GLINT_FACTOR: Final = 2.0

_GRID_STEP: Final = 5.0  # cm-1; the blackbody is smooth, so the step only has to resolve the response
_FALLBACK_SEA: Final = 288.15


def grid_of(band: Band) -> FloatArray:
    """Wavenumbers on which a blackbody is integrated over the band [cm-1]."""
    low, high = 1e4 / band.max_um, 1e4 / band.min_um
    return np.linspace(low, high, max(int((high - low) / _GRID_STEP) + 2, 16))


def to_temperature(radiance: Any, band: Band) -> FloatArray:
    """Apparent temperature [K] of band radiances [W m-2 sr-1]; NaN for zero."""
    return apparent_temperature(radiance, band, grid_of(band))


@dataclass(frozen=True)
class Summary:
    """Statistics of a sequence over all pixels and frames."""

    frames: int
    mean: float  #: Mean radiance [W m-2 sr-1].
    peak: float  #: Largest radiance [W m-2 sr-1].
    mean_apparent_temperature: float  #: Apparent temperature of the mean radiance [K].
    peak_apparent_temperature: float  #: Apparent temperature of the largest radiance [K].
    glint_fraction: float  #: Share of the pixels more than :data:`GLINT_FACTOR` times as bright as a blackbody at the water's temperature.
    non_finite: int  #: Pixels that are NaN or infinite.

    @property
    def line(self) -> str:
        """One line for people, both radiance units."""
        u = ARTICLE_RADIANCE_PER_SI
        bad = f", {self.non_finite} pixels not finite" if self.non_finite else ""
        return (
            f"{self.frames} frame{'s' if self.frames != 1 else ''}, mean {rounded(self.mean, 4)} W m⁻² sr⁻¹ ({rounded(u * self.mean, 4)} "
            f"{ARTICLE_RADIANCE_SYMBOL}, {self.mean_apparent_temperature:.1f} K), peak {rounded(self.peak, 4)} "
            f"({rounded(u * self.peak, 4)}, "
            f"{self.peak_apparent_temperature:.1f} K), "
            f"{100.0 * self.glint_fraction:.3g} % of the pixels over twice the water's blackbody radiance{bad}"
        )

    def as_dict(self) -> dict[str, float | int]:
        """Plain values, for JSON."""
        return asdict(self)


def sea_temperature(dataset: xr.Dataset) -> float:
    """Temperature of the water in the scenario that made a dataset [K]."""
    try:
        return float(json.loads(dataset.attrs["scenario"])["sea"]["temperature_k"])
    except (KeyError, ValueError, TypeError):
        return _FALLBACK_SEA


def summarise(dataset: xr.Dataset) -> Summary:
    """Statistics of ``radiance``, frame by frame, so that memory does not grow with the sequence; unfinished frames are left out."""
    band = stored_band(dataset.attrs)
    threshold = GLINT_FACTOR * float(band.radiance(sea_temperature(dataset), grid_of(band)))
    total, peak, glint, pixels, bad, frames = 0.0, 0.0, 0, 0, 0, 0
    for image in images(dataset):
        finite = np.isfinite(image)
        values = image[finite]
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
    """Images of one variable read one at a time; counts as the radiance that they stand for."""

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
    """Images frame by frame (a map is one frame); frames not done are left out. Radiance by default, of counts where only these are."""
    values = pictures(dataset) if variable is None else dataset[variable]
    line = count_line(values) if variable is None else (1.0, 0.0)
    if "time" not in values.dims:
        return Images(values.expand_dims("time").transpose("time", "y", "x"), np.arange(1), line)
    done = dataset["frame_done"].to_numpy() if "frame_done" in dataset else np.ones(values.sizes["time"])
    return Images(values, np.flatnonzero(done), line)
