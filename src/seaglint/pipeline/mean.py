"""A scenario becomes a map of mean radiance and apparent temperature."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, assert_never

import numpy as np
from numpy.typing import NDArray

from seaglint.conventions import FloatArray, horizon_depression
from seaglint.io.provenance import band_attributes, provenance
from seaglint.optics.band import apparent_temperature
from seaglint.pipeline import prepare
from seaglint.radiance.article import article_radiance
from seaglint.radiance.mean import SeaRadiance, mean_radiance
from seaglint.radiance.variance import sea_variance
from seaglint.radiance.view import SeaView
from seaglint.render.camera import Camera
from seaglint.scenario.model import Scenario
from seaglint.threads import single_threaded_algebra

if TYPE_CHECKING:
    import xarray as xr


ROW_SHARE = 0.02
"""Height of a row over its distance from the horizon from which it is averaged: below it the middle is within 1e-4 of the average."""

ROW_POINTS = 8
"""Elevations averaged in such a row."""


@single_threaded_algebra()
def mean(scenario: Scenario) -> xr.Dataset:
    """Mean radiance over the field of view, with its components, as a labelled dataset.

    Dimensions ``y, x`` (elevation from the top, azimuth clockwise); variables ``radiance``, ``apparent_temperature``, the four
    components of the radiance and ``glint_std``, the standard deviation of glint in a pixel. In the mode ``article`` the emitted
    radiance is that of the one blackbody which stands for sea and mirrored sky, and the sky's part is 0 below the horizon.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> small = parse_scenario({"sensor": {"pixels": [8, 4]}})
    >>> dict(mean(small).radiance.sizes)
    {'y': 4, 'x': 8}
    """
    import xarray as xr

    camera = prepare.camera(scenario)
    rows = RowAverage.of(camera)
    view, fine = _radiances(scenario, camera, rows.elevations)
    found = rows.radiance(fine)
    total = found.total
    maps = {
        "radiance": total,
        "apparent_temperature": apparent_temperature(total, view.band, view.atmosphere.wavenumber_cm),
        "path_radiance": np.broadcast_to(found.path, total.shape),
        "emitted_radiance": np.broadcast_to(found.emission, total.shape),
        "sky_radiance": np.broadcast_to(found.sky, total.shape),
        "glint_radiance": np.broadcast_to(found.sun, total.shape),
        "glint_std": _glint_std(scenario, camera, view, rows, fine),
    }
    return xr.Dataset(
        {name: (("y", "x"), np.asarray(values, dtype=np.float32)) for name, values in maps.items()},
        coords={"azimuth": ("x", np.degrees(camera.azimuths)), "elevation": ("y", np.degrees(camera.elevations))},
        attrs=provenance(
            "Mean infrared radiance of the sea",
            scenario.model_dump_json(exclude_none=True),
            scenario.seed,
            mean_mode=scenario.mean.mode,
            mean_shadowing=view.shadowing.word,
            glint_correlation_length_m=prepare.glint_length(scenario),
            mss_up=view.slopes.mss_up,
            mss_cross=view.slopes.mss_cross,
            solar_zenith_deg=math.degrees(view.solar_zenith),
            solar_azimuth_deg=math.degrees(view.solar_azimuth),
            **band_attributes(view.band),
        ),
    )


def _radiances(scenario: Scenario, camera: Camera, elevations: FloatArray) -> tuple[SeaView, SeaRadiance]:
    """What the scenario's mode sees at the elevations and the camera's azimuths, and how."""
    match scenario.mean.mode:
        case "spectral":
            view = prepare.view(scenario)
            return view, mean_radiance(view, elevations, camera.azimuths)
        case "article":
            view = prepare.article_view(scenario)
            return view, article_radiance(view, elevations, camera.azimuths)
        case other:
            assert_never(other)


@dataclass(frozen=True, eq=False)
class RowAverage:
    """Elevations that stand for the height of each pixel row, and the mean over them, as an image has it. Make it with :meth:`of`.

    Rows that are high against their distance from the horizon are the mean of :data:`ROW_POINTS` elevations; for others the middle serves.
    """

    elevations: FloatArray
    starts: NDArray[np.intp]
    points: NDArray[np.intp]

    @classmethod
    def of(cls, camera: Camera) -> RowAverage:
        """Elevations for the rows of a camera, row by row from the top."""
        below = np.abs(camera.elevations + horizon_depression(camera.height))
        points = np.where(camera.row_step > ROW_SHARE * below, ROW_POINTS, 1)
        row = np.repeat(np.arange(camera.rows), points)
        starts = np.cumsum(points) - points
        part = (np.arange(row.size) - starts[row] + 0.5) / points[row] - 0.5
        return cls(camera.elevations[row] - part * camera.row_step, starts, points)

    def __call__(self, values: FloatArray) -> FloatArray:
        """Mean of (elevations, columns) over the elevations of each row (rows, columns)."""
        found = values[self.starts]
        several = np.flatnonzero(self.points > 1)
        for row in several:  # few: those next to the horizon
            found[row] = values[self.starts[row] : self.starts[row] + self.points[row]].mean(axis=0)
        return found

    def radiance(self, found: SeaRadiance) -> SeaRadiance:
        """Components averaged [W m-2 sr-1]."""
        parts = (found.path, found.emission, found.sky, found.sun, found.chance, found.cos_incidence)
        return SeaRadiance(*(self(part) for part in parts))


def over_rows(camera: Camera, radiance: Callable[[FloatArray], SeaRadiance]) -> SeaRadiance:
    """Components averaged over the height of each pixel row [W m-2 sr-1], as an image has them."""
    rows = RowAverage.of(camera)
    return rows.radiance(radiance(rows.elevations))


def _glint_std(scenario: Scenario, camera: Camera, view: SeaView, rows: RowAverage, found: SeaRadiance) -> FloatArray:
    """Standard deviation of glint in each pixel [W m-2 sr-1, (rows, columns)].

    Cells of the sea are independent, so a row's variance is the mean of what its elevations would have with all of the pixel's solid angle.
    """
    solid_angle = np.repeat(pixel_solid_angle(camera), rows.points)
    variance = sea_variance(view, found, rows.elevations, solid_angle, prepare.glint_length(scenario))
    return np.asarray(np.sqrt(rows(variance)))


def pixel_solid_angle(camera: Camera) -> FloatArray:
    """Solid angle of a pixel of each row [sr, (rows,)]: azimuth step times the difference of the sines of its edges."""
    edge = 0.5 * camera.row_step
    return np.asarray(camera.column_step * (np.sin(camera.elevations + edge) - np.sin(camera.elevations - edge)))
