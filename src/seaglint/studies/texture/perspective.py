"""Texture on the sea as a sensor sees it: footprints grow with range, fluctuations average out, the correlation shrinks.

The Gaussian field lies on the sea, its pixels some metres long and wide. A pixel of the sensor sees the mean over its footprint, which is
Gaussian too, and is scaled to the variance 1. Its value is then the quantile of a distribution with the mean and the variance of that
pixel, which are known beforehand. ``place`` stores such a sequence instead of a rendered one.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray, Progress, horizon_range, surface_range
from seaglint.base.errors import DataError, DomainError
from seaglint.base.threads import single_threaded_algebra
from seaglint.scenario.model import Scenario
from seaglint.store.layout import Layout
from seaglint.store.provenance import provenance, stored_band
from seaglint.store.sequence_store import check_output, write_sequence
from seaglint.store.texture_file import StoredTexture
from seaglint.studies.build import scenario_physics
from seaglint.studies.mean.mean_map import mean as mean_map
from seaglint.studies.sequence.memory import require_room
from seaglint.studies.study_requests import PlaceRequest
from seaglint.studies.texture.texture_sequences import BYTES_PER_PIXEL, latent_model
from seaglint.textures.marginals import Tails
from seaglint.textures.synthesis import latent

SAMPLED: Final = 12  #: Number of frames for the variance of the averaged field, over all of the plane's columns.

NARROWEST: Final = 1e-6  #: Least ratio of standard deviation to mean that counts as a fluctuation.


@dataclass(frozen=True)
class Footprints:
    """Footprints of the rows and columns of a camera on the sea."""

    near: FloatArray  #: Near edges of the rows along the range [m, (rows,)]; NaN above the horizon.
    far: FloatArray  #: Far edges of the rows along the range [m, (rows,)]; NaN above the horizon.
    edges: FloatArray  #: Edges of the columns from the middle [rad, (columns + 1,)].

    @classmethod
    def of(cls, height: float, elevations: FloatArray, row_step: float, columns: int, column_step: float) -> Footprints:
        """Return the footprints of a camera with equal steps [m, rad]; the row that the horizon cuts ends there."""
        near = surface_range(height, -(elevations - 0.5 * row_step))
        far = surface_range(height, -(elevations + 0.5 * row_step))
        far = np.where(np.isnan(far) & ~np.isnan(near), horizon_range(height), far)
        return cls(near, far, np.asarray((np.arange(columns + 1) - 0.5 * columns) * column_step, np.float64))

    @property
    def sea(self) -> NDArray[np.bool_]:
        """Return the mask of rows that see the sea (rows,)."""
        return np.asarray(np.isfinite(self.near) & (self.far > self.near))

    def finest(self) -> tuple[float, float]:
        """Return length and width of the nearest footprint [m].

        Raises
        ------
        DomainError
            No row below the horizon.
        """
        rows = np.flatnonzero(self.sea)
        if not rows.size:
            raise DomainError("the picture shows no sea: the horizon is below it; lower the line of sight")
        last = rows[np.argmin(self.near[rows])]
        middle = 0.5 * (self.near[last] + self.far[last])
        return float(self.far[last] - self.near[last]), float(middle * (self.edges[1] - self.edges[0]))


class PeriodicField:
    """Periodic Gaussian field on the sea, seen through footprints.

    Parameters
    ----------
    field : ndarray, shape (frames, rows, columns)
        Mean 0; row 0 the farthest of its period [1].
    cell : (float, float)
        Length along the range and width of a pixel of the field [m].
    footprints : Footprints
    """

    def __init__(self, field: NDArray[np.float32], cell: tuple[float, float], footprints: Footprints) -> None:
        if not (cell[0] > 0.0 and cell[1] > 0.0):
            raise DomainError(f"a pixel of the texture is {cell[0]:g} m x {cell[1]:g} m; give lengths above 0")
        self._field, self._cell = field, cell
        self._rows = np.flatnonzero(footprints.sea)
        self._shape = (footprints.near.size, footprints.edges.size - 1)
        # Rows of the picture and of the field both have the far sea on top.
        self._ends = -footprints.far[self._rows] / cell[0], -footprints.near[self._rows] / cell[0]
        middle = 0.5 * (footprints.near[self._rows] + footprints.far[self._rows])
        self._edges = middle[:, None] * footprints.edges / cell[1]
        numbers = np.unique(np.linspace(0, len(field) - 1, min(len(field), SAMPLED)).astype(int))
        power = np.zeros(self._rows.size)
        for number in numbers:
            profile = self._profile(number)
            # Edges of a row are nearly equally spaced, so one width serves for the variance.
            width = np.diff(self._edges, axis=1).mean(axis=1)
            # Footprints of the same width everywhere around the period.
            starts = np.arange(profile.shape[1], dtype=float)[None, :] + np.zeros((self._rows.size, 1))
            averaged = (_running(profile, starts + width[:, None]) - _running(profile, starts)) / width[:, None]
            power += (averaged**2).mean(axis=1)
        self.spread = np.sqrt(power / numbers.size)
        """Standard deviation of the field averaged over the footprints of each row below the horizon [1]."""

    def _profile(self, number: int) -> FloatArray:
        """Return the mean over the lengths of the rows' footprints, (rows below the horizon, columns of the field)."""
        field = self._field[number % len(self._field)].astype(np.float64)
        low, high = self._ends
        return (_running(field.T, high[None, :]) - _running(field.T, low[None, :])).T / (high - low)[:, None]

    def frame(self, number: int) -> FloatArray:
        """Return the field in a frame as the sensor sees it, variance 1 (rows, columns) [1]; 0 above the horizon."""
        sums = _running(self._profile(number), self._edges)
        out = np.zeros(self._shape)
        out[self._rows] = np.diff(sums, axis=1) / np.diff(self._edges, axis=1) / self.spread[:, None]
        return out

    @property
    def averaging(self) -> FloatArray:
        """Return the standard deviation of each row of the picture over the field's (rows,) [1]; 0 above the horizon."""
        out = np.zeros(self._shape[0])
        out[self._rows] = self.spread
        return out


def _running(values: FloatArray, places: FloatArray) -> FloatArray:
    """Return the integral of periodic steps (lines, n) from 0 to places (lines or 1, m), in steps."""
    lines, n = values.shape
    # The integral of a step function is linear between the cumulative sums.
    sums = np.concatenate([np.zeros((lines, 1)), np.cumsum(values, axis=1)], axis=1)
    periods = np.floor(places / n)
    rest = places - periods * n
    index = np.minimum(rest.astype(np.int64), n - 1)
    share = rest - index
    index, share, periods = (np.broadcast_to(v, (lines, places.shape[1])) for v in (index, share, periods))
    start = np.take_along_axis(sums, index, axis=1)
    return np.asarray(periods * sums[:, -1:] + start + share * np.take_along_axis(values, index, axis=1))


def fluctuation(g: FloatArray, mean: FloatArray, std: FloatArray, tails: Tails) -> FloatArray:
    """Return values with a mean and a standard deviation by pixel, at g standard deviations of the Gaussian field [u], shape of g.

    ``tails`` gaussian and lognormal are these; all others are gamma distributed, from 0 upwards.
    Pixels whose mean or standard deviation is 0 have their mean.
    """
    from scipy import special

    out = np.array(mean, np.float64)
    lively = (mean > 0.0) & (std > NARROWEST * np.abs(mean))
    if tails == "gaussian":
        return np.asarray(out + np.where(lively, std * g, 0.0))
    ratio = std[lively] / mean[lively]
    u = g[lively]
    if tails == "lognormal":
        s = np.sqrt(np.log1p(ratio**2))
        out[lively] = mean[lively] * np.exp(s * u - 0.5 * s**2)
        return out
    shape = 1.0 / ratio**2
    upper = u > 0.0
    value = np.empty(u.size)
    # The upper half uses the complement, which keeps digits in the far tail.
    value[upper] = special.gammainccinv(shape[upper], special.ndtr(-u[upper]))
    value[~upper] = special.gammaincinv(shape[~upper], special.ndtr(u[~upper]))
    out[lively] = mean[lively] * value / shape
    return out


SAME_RATE: Final = 0.01  #: Relative difference up to which frame rates count as equal.


def place(
    stored: StoredTexture, scenario: Scenario, output: str | Path, request: PlaceRequest, *, progress: Progress | None = None
) -> Path | str:
    """Lay a texture on the sea of a scenario and store the sequence of its sensor.

    Parameters
    ----------
    stored : StoredTexture
        Texture of a Gauss-Markov field.
    scenario : Scenario
        Scenario with an upright sensor at rest; its mean map gives mean, horizon and contrast.
    output : path
        Store to make.
    request : PlaceRequest
        Frames, size and cell of the field, contrast and seed.
    progress : callable, optional
        Called with (frames written, frames in all).

    Raises
    ------
    SeaglintError
        A texture without a Gaussian field, or without time for several frames; a turned or moving sensor; a store that exists.
    """
    check_output(output, overwrite=request.overwrite)
    field, texture = latent_model(stored)
    sensor = scenario.sensor
    numbers = request.frames if request.frames is not None else range(sensor.frames)
    if sensor.frames > 1 and len(numbers) > 1 and field.reach[0] == 0:
        raise DataError(
            f"{len(numbers)} frames: the texture is that of one picture and has no time; choose frame 0 alone, or fit it to a sequence"
        )
    rate = stored.frame_rate
    if rate is not None and field.reach[0] > 0 and abs(rate / sensor.frame_rate_hz - 1.0) > SAME_RATE:
        raise DataError(
            f"sensor.frame_rate_hz = {sensor.frame_rate_hz:g} and the texture's data had {rate:g} Hz, whose frames it counts; "
            f"set sensor.frame_rate_hz = {rate:g}, or fit a sequence of {sensor.frame_rate_hz:g} Hz"
        )
    with single_threaded_algebra():
        camera = scenario_physics.camera(scenario)
        means = mean_map(scenario)
        seed = scenario.seed if request.seed is None else request.seed
        feet = Footprints.of(camera.height, camera.elevations, camera.row_step, camera.columns, camera.column_step)
        metres = feet.finest() if request.cell is None else request.cell
        # The loop must be longer than the correlation in time, else its ends would be correlated.
        loop_frames = max(sensor.frames, 4 * field.reach[0] + 1) if field.reach[0] else 1
        need = BYTES_PER_PIXEL * loop_frames * int(np.prod(request.size))
        what = f"a field of {loop_frames} x {request.size[0]} x {request.size[1]} cells"
        require_room(need, what, "give a smaller size, or fewer sensor.frames")
        plane = PeriodicField(latent(field, (loop_frames, *request.size[::-1]), seed, texture.modulation, texture.noise), metres, feet)
        total = means["radiance"].to_numpy().astype(np.float64)
        glint = request.contrast == "glint" or (request.contrast == "auto" and float(means["glint_std"].max()) > 0.0)
        if glint:
            lively, spread = (means[name].to_numpy().astype(np.float64) for name in ("glint_radiance", "glint_std"))
        else:
            lively = total - means["path_radiance"].to_numpy().astype(np.float64)
            spread = lively * (_contrast(texture.marginal.variance, texture.marginal.mean) * plane.averaging)[:, None]
        # Path and emission do not fluctuate with the texture.
        steady = total - lively

        def image(number: int) -> dict[str, FloatArray]:
            return {"radiance": steady + _seen(plane, number, feet, lively, spread, texture.marginal.kind)}

        layout = Layout(
            azimuth_deg=np.degrees(camera.azimuths),
            elevation_deg=np.degrees(camera.elevations),
            frames=numbers,
            frame_rate=sensor.frame_rate_hz,
            band=stored_band(means.attrs),
            attributes=provenance(
                "Statistical texture in the perspective of a scenario",
                scenario.model_dump_json(exclude_none=True),
                seed,
                texture_model="gauss-markov",
                texture_source=str(stored.source.get("input", "")),
                texture_cell_m=list(metres),
                texture_contrast="glint" if glint else "model",
                loop_frames=sensor.frames,
            ),
        )
        return write_sequence(output, layout, image, overwrite=request.overwrite, progress=progress)


def _seen(plane: PeriodicField, number: int, feet: Footprints, mean: FloatArray, spread: FloatArray, tails: str) -> FloatArray:
    out = mean.copy()
    sea = feet.sea
    out[sea] = fluctuation(plane.frame(number)[sea], mean[sea], spread[sea], tails)  # type: ignore[arg-type]
    return out


def _contrast(variance: float, mean: float) -> float:
    """Return the standard deviation over the mean of the data.

    Raises
    ------
    DataError
        A mean that is not above 0, as of filtered data.
    """
    if not mean > 0.0:
        raise DataError(
            f"the texture's mean is {mean:g}: its ratio to the standard deviation means nothing; fit it to radiances or counts, or take "
            "contrast = 'glint'"
        )
    return float(np.sqrt(variance) / mean)
