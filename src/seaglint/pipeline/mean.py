"""A scenario becomes a map of mean radiance and apparent temperature."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, assert_never

import numpy as np

from seaglint.conventions import FloatArray, horizon_depression
from seaglint.io.provenance import band_attributes, provenance
from seaglint.optics.band import apparent_temperature
from seaglint.pipeline import prepare
from seaglint.radiance.article import article_radiance
from seaglint.radiance.mean import SeaRadiance, SeaView, mean_radiance
from seaglint.render.camera import Camera
from seaglint.scenario.model import Scenario

if TYPE_CHECKING:
    import xarray as xr


ROW_SHARE = 0.02
"""Height of a row over its distance from the horizon from which it is averaged: below it the middle is within 1e-4 of the average."""

ROW_POINTS = 8
"""Elevations averaged in such a row."""


def mean(scenario: Scenario) -> xr.Dataset:
    """Mean radiance over the field of view, with its components, as a labelled dataset.

    Dimensions ``y, x`` (elevation from the top, azimuth clockwise); variables ``radiance``, ``apparent_temperature`` and the four
    components of the radiance. In the mode ``article`` the emitted radiance is that of the one blackbody which stands for sea and
    mirrored sky, and the sky's part is 0 below the horizon.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> small = parse_scenario({"sensor": {"pixels": [8, 4]}})
    >>> dict(mean(small).radiance.sizes)
    {'y': 4, 'x': 8}
    """
    import xarray as xr

    camera = prepare.camera(scenario)
    view, found = _radiances(scenario, camera)
    total = found.total
    maps = {
        "radiance": total,
        "apparent_temperature": apparent_temperature(total, view.band, view.atmosphere.wavenumber_cm),
        "path_radiance": np.broadcast_to(found.path, total.shape),
        "emitted_radiance": np.broadcast_to(found.emission, total.shape),
        "sky_radiance": np.broadcast_to(found.sky, total.shape),
        "glint_radiance": np.broadcast_to(found.sun, total.shape),
    }
    return xr.Dataset(
        {name: (("y", "x"), np.asarray(values, dtype=np.float32)) for name, values in maps.items()},
        coords={"azimuth": ("x", np.degrees(camera.azimuths)), "elevation": ("y", np.degrees(camera.elevations))},
        attrs=provenance(
            "Mean infrared radiance of the sea",
            scenario.model_dump_json(exclude_none=True),
            scenario.seed,
            mean_mode=scenario.mean.mode,
            mss_up=view.slopes.mss_up,
            mss_cross=view.slopes.mss_cross,
            solar_zenith_deg=math.degrees(view.solar_zenith),
            solar_azimuth_deg=math.degrees(view.solar_azimuth),
            **band_attributes(view.band),
        ),
    )


def _radiances(scenario: Scenario, camera: Camera) -> tuple[SeaView, SeaRadiance]:
    """What the scenario's mode sees, and how."""
    match scenario.mean.mode:
        case "spectral":
            view = prepare.view(scenario)
            return view, over_rows(camera, lambda elevations: mean_radiance(view, elevations, camera.azimuths))
        case "article":
            view = prepare.article_view(scenario)
            return view, over_rows(camera, lambda elevations: article_radiance(view, elevations, camera.azimuths))
        case other:
            assert_never(other)


def over_rows(camera: Camera, radiance: Callable[[FloatArray], SeaRadiance]) -> SeaRadiance:
    """Components averaged over the height of each pixel row [W m-2 sr-1], as an image has them.

    Rows that are high against their distance from the horizon are the mean of :data:`ROW_POINTS` elevations; for others the middle serves.
    """
    below = np.abs(camera.elevations + horizon_depression(camera.height))
    points = np.where(camera.row_step > ROW_SHARE * below, ROW_POINTS, 1)
    row = np.repeat(np.arange(camera.rows), points)
    starts = np.cumsum(points) - points
    part = (np.arange(row.size) - starts[row] + 0.5) / points[row] - 0.5
    found = radiance(camera.elevations[row] - part * camera.row_step)

    def averaged(values: FloatArray) -> FloatArray:
        return np.asarray(np.add.reduceat(values, starts, axis=0) / points[:, None])

    parts = (found.path, found.emission, found.sky, found.sun, found.chance, found.cos_incidence)
    return SeaRadiance(*(averaged(part) for part in parts))
