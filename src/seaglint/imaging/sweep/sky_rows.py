"""Rows of an upright image: the sky in those that touch it, and the Sun in it."""

from __future__ import annotations

import numpy as np

from seaglint.base.conventions import horizon_depression
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sky import sky_above
from seaglint.imaging.camera.image_grid import Camera
from seaglint.imaging.sun_in_sky import sun_in_sky
from seaglint.imaging.sweep.sweep import Rows


def sky_rows(view: SeaView, camera: Camera) -> Rows:
    """Rows of a camera, with the radiance of the sky and the Sun in those that touch the sky."""
    elevation = np.maximum(camera.elevations, -horizon_depression(camera.height))
    # only rows that touch the sky are looked up; crests never lower the horizon by more than a few rows
    seen = elevation[camera.top - np.arange(camera.rows) * camera.row_step > -horizon_depression(camera.height) - 2e-3]
    bottom = float(np.tan(max(camera.bottom, -0.5 * np.pi + 1e-9)))
    top = float(np.tan(min(camera.top, 0.5 * np.pi - 1e-9)))
    # one row more, as nothing is interpolated beyond the last
    sky = sky_above(view, np.append(seen, seen[-1:]))
    return Rows(camera.top, 1.0 / camera.row_step, camera.rows, bottom, top, sky, sun_in_sky(view))
