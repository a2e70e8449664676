"""Scene of an upright camera through air that bends its lines of sight: the standard picture with its rows shifted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from seaglint.base.conventions import FloatArray, horizon_range
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.bending import Bending, RowShift
from seaglint.imaging.camera.image_grid import Camera
from seaglint.imaging.camera.imager import Attitude, Imager
from seaglint.imaging.camera.pose import Pose
from seaglint.imaging.layers import LEAST_SEEN, Layers, share_of_glint
from seaglint.imaging.scene import Instant, image
from seaglint.imaging.swept import SweptScene
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.sea.field import WaveField

#: Layers of light, which more air before the sea weakens.
RADIANCES: Final = ("radiance", "path_radiance", "emitted_radiance", "sky_radiance", "glint_radiance")

MEANS: Final = ("range", "slope")  #: Layers that are means over what a pixel sees.


@dataclass(frozen=True, eq=False)
class RefractedScene:
    """Scene whose rows are shifted as a profile bends its lines of sight."""

    standard: SweptScene  #: The scene with standard refraction, in finer rows.
    shift: RowShift  #: Rows of the camera as mixtures of those.

    @property
    def view(self) -> SeaView:
        """Sea, air and Sun."""
        return self.standard.view

    @property
    def layers(self) -> tuple[str, ...]:
        """Layers beside ``radiance`` and ``glint_radiance``."""
        return self.standard.layers

    @property
    def camera(self) -> Camera:
        """The image grid."""
        return self.shift.camera

    @property
    def pose(self) -> Pose:
        """Pose of the camera above the sea's origin."""
        return Pose(0.0, 0.0, self.camera.height, Attitude(self.camera.azimuth, self.camera.elevation))

    @property
    def waves(self) -> WaveField | None:
        """Part of the slopes that is geometry."""
        return self.standard.waves

    @property
    def report(self) -> Mapping[str, Any]:
        """Settings of the sweep, and the horizon, for the provenance."""
        horizon = float(np.degrees(self.shift.bending.horizon))
        return {**self.standard.report, "refraction": "profile", "horizon_elevation_deg": horizon}

    def reseeded(self, seed: int) -> Self:
        """Return another realisation of the same sea, sparkles included, without preparing anything again."""
        return replace(self, standard=self.standard.reseeded(seed))

    @property
    def pixels(self) -> Imager:
        """The camera's pixels."""
        return pixels_of(self.camera)

    def seen_from(self, pose: Pose) -> SeaView:
        """View of sea, air and Sun."""
        return self.view

    def sea(self, pose: Pose, time: float) -> Instant:
        """Sea at a time [s] under a sensor."""
        return self.standard.sea(pose, time)

    def directions(self, pose: Pose) -> tuple[FloatArray, FloatArray]:
        """Azimuths of the columns and elevations of the rows [rad]."""
        return self.camera.azimuths, self.camera.elevations

    def drawn(self, pose: Pose, time: float, sea: Instant | None = None) -> Layers:
        """Image from a pose at a time [s]."""
        return self.shifted(image(self.standard, self._level(pose), time, sea))

    def columns(self, pose: Pose, time: float, part: tuple[int, int], sea: Instant | None = None) -> Layers:
        """Image of the columns ``part = (first, end)`` alone."""
        return self.shifted(self.standard.columns(self._level(pose), time, part, sea))

    def _level(self, pose: Pose) -> Pose:
        """Pose of the standard picture, whose middle is elsewhere."""
        up = pose.attitude.elevation - self.camera.elevation
        attitude = Attitude(pose.attitude.azimuth, self.standard.camera.elevation + up, pose.attitude.roll)
        return Pose(pose.east, pose.north, pose.height, attitude)

    @cached_property
    def _far(self) -> tuple[csr_array, FloatArray] | None:
        """Shares of standard rows behind the air beyond the standard horizon, and what that air adds to each row; None where none is."""
        beyond = self.shift.beyond
        if not beyond.any():
            return None
        share, added = air_beyond(self.view, self.shift.bending, beyond)
        return self.shift.behind(share), self.shift.summed(added)

    def shifted(self, layers: Layers) -> Layers:
        """Layers of the standard picture in the camera's rows."""
        rows, far = self.shift.sea, self._far
        behind, added = (rows, np.zeros(self.camera.rows)) if far is None else far
        out: dict[str, NDArray[np.float32]] = {}
        for name in layers:
            if name in RADIANCES:
                light = added[:, None] if name in ("radiance", "path_radiance") else 0.0
                out[name] = np.asarray(behind @ layers[name] + light, np.float32)
            elif name not in (*MEANS, "glint_share"):
                out[name] = np.asarray(rows @ layers[name], np.float32)
        for name in MEANS:
            if name in layers:
                known = np.isfinite(layers[name])
                share = rows @ known.astype(np.float64)
                total = rows @ np.where(known, layers[name], 0.0)
                mean = np.where(share > LEAST_SEEN, total / np.maximum(share, LEAST_SEEN), np.nan)
                out[name] = mean.astype(np.float32)
        if "range" in layers:
            arcs = self.shift.sea_arcs()
            over = np.nan_to_num(arcs) > horizon_range(self.camera.height)
            out["range"][over] = arcs[over, None]
        if "glint_share" in layers:
            out["glint_share"] = share_of_glint(out["glint_radiance"], out["radiance"])
        return Layers(out)


def air_beyond(view: SeaView, bending: Bending, beyond: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Share of the light from the standard horizon that more air lets through [1], and what that air adds [W m-2 sr-1].

    The air is that of the last tenth of the way to the standard horizon, at one temperature.

    Parameters
    ----------
    view : SeaView
        Sea and air.
    bending : Bending
        Refraction, with the height of the sensor.
    beyond : ndarray
        Arcs of sea beyond the standard horizon [m, (n,)].

    Returns
    -------
    share, added : ndarray
        (n,).
    """
    horizon = horizon_range(bending.height)
    ends = np.array([0.9, 1.0]) * horizon
    tau, light = view.atmosphere.transmittance(bending.height, ends), view.atmosphere.path_radiance(bending.height, ends)
    nu = view.atmosphere.wavenumber_cm
    weights = view.band.weights(nu)
    per_metre = np.log(np.maximum(tau[0], 1e-300) / np.maximum(tau[1], 1e-300)) / (0.1 * horizon)
    arcs, each = np.unique(np.round(beyond, -1), return_inverse=True)
    through = np.exp(-np.maximum(per_metre, 0.0) * arcs[:, None])
    sea, air = (planck_wavenumber(nu, np.array(kelvin)) for kelvin in (view.sea_temperature, bending.air_temperature))
    share = ((through * tau[1] * sea) @ weights) / max(float((tau[1] * sea) @ weights), 1e-300)
    added = (1.0 - share) * float(light[1] @ weights) + ((1.0 - through) * tau[1] * air) @ weights
    return share[each], added[each]


def pixels_of(camera: Camera) -> Imager:
    """Pixels of an upright image grid."""
    return Imager("equal-angle", camera.width, camera.height_angle, camera.columns, camera.rows)
