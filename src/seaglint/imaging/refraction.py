r"""Refraction by a profile of air as a shift of rows: an upright camera's scene from a picture with standard refraction.

The standard picture has straight lines of sight over an Earth of effective radius. A ray through the profile that leaves the sensor at an
elevation meets the sea at an arc, goes to the sky, or passes an object at some height; the standard picture shows the same place of the
sea, sky or object at another elevation. Several elevations may show one place (a mirage), and some places are not visible.

``Bending`` follows the rays, ``RowShift`` mixes the rows of a finer standard picture, ``RefractedScene`` draws.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from seaglint.air.profile.ray_paths import LayeredIndex, RayPaths
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray, depression_of_range, horizon_depression, horizon_range
from seaglint.facet.sea_view import SeaView
from seaglint.imaging.camera.imager import Attitude, Camera, Imager, pixels_of
from seaglint.imaging.camera.pose import Pose
from seaglint.imaging.layers import LEAST_SEEN, SPARKLE, Layers, share_of_glint
from seaglint.imaging.scene import Instant, image
from seaglint.imaging.upright_scene import SweptScene
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.sea.foam.ship_foam import NO_SEGMENTS, FoamSegments
from seaglint.sea.wave_field import WaveField

RAYS_PER_ROW: Final = 8  #: Number of rays followed through each row of pixels.

#: Number of rays from which on fewer are followed through a row, for their memory (10 kB each), down to ``FEWEST_RAYS``.
MOST_RAYS: Final = 6000

FEWEST_RAYS: Final = 2

#: Ratio of the distance of two rays in the standard picture to their distance in the camera, beyond which they see different things.
BROKEN: Final = 8.0

HALVINGS: Final = 12  #: Number of times that the gap between such rays is halved.

STRAYED: Final = 0.012  #: Angle from the straight line to a point within which its images are sought [rad].

FINER: Final = 3  #: Rows of the standard picture in a row of the camera.

BEYOND: Final = 2e5  #: Arc beyond twice the standard horizon up to which rays are followed [m].

GRAZING: Final = 1e-7  #: Least depression of visible sea below the standard horizon [rad].


@dataclass(frozen=True, eq=False)
class Bending:
    """Bending of the lines of sight of a sensor at one height."""

    index: LayeredIndex  #: The air.
    height: float  #: Height of the sensor [m].
    air_temperature: float  #: Temperature of the lowest air [K], which emits before sea beyond the standard horizon.

    @property
    def farthest(self) -> float:
        """Arc up to which rays are followed [m]."""
        return 2.0 * horizon_range(self.height) + BEYOND

    @cached_property
    def horizon(self) -> float:
        """Elevation below which rays meet the sea [rad]; strips of sky below it are a mirage."""
        return self.index.lowest_sky(self.height, self.farthest)

    def paths(self, elevation: FloatArray) -> RayPaths:
        """Return rays at elevations [rad, (rays,)]."""
        return self.index.paths(self.height, elevation, self.farthest)

    def straight(self, rays: RayPaths) -> FloatArray:
        """Return the standard elevations of the sea or sky that rays see [rad, (rays,)].

        Sea beyond the standard horizon is represented by the sea at this horizon, behind more air (``RowShift.beyond``). Sky below the
        horizontal is placed by its share of the dip.
        """
        dip = horizon_depression(self.height)
        arc = np.clip(rays.end, 1e-6, horizon_range(self.height))
        sea = np.minimum(-depression_of_range(self.height, arc), -dip - GRAZING)
        share = dip / -self.horizon if self.horizon < 0.0 else 0.0
        sky = np.where(rays.elevation < 0.0, np.maximum(rays.elevation * share, -dip), rays.elevation)
        return np.where(rays.sea, sea, sky)

    def beyond(self, rays: RayPaths) -> FloatArray:
        """Return the arcs from the standard horizon to the sea that rays meet beyond it [m, (rays,)]; 0 for others."""
        return np.where(rays.sea, np.maximum(rays.end - horizon_range(self.height), 0.0), 0.0)

    def over(self, rays: RayPaths, arc: float, *, into_sea: bool = False) -> FloatArray:
        """Return the standard elevations [rad, (rays,)] of the places of rays at an arc [m]; NaN for rays that met the sea before.

        With ``into_sea`` rays continue below the mean sea: there, resolved waves hide objects.
        """
        z, psi = rays.at(arc, into_sea=into_sea), arc / EFFECTIVE_EARTH_RADIUS
        up = z * math.cos(psi) - self.height - 2.0 * EFFECTIVE_EARTH_RADIUS * math.sin(0.5 * psi) ** 2
        return np.arctan2(up, (EFFECTIVE_EARTH_RADIUS + z) * math.sin(psi))

    def elevation(self, height: float, arc: float) -> FloatArray:
        """Return the elevations of the images of a point, from the lowest up [rad, (images,)]: zero, one, or several in a mirage.

        ``height``: of the point above the sea [m]; ``arc``: of the point [m].
        """
        middle = math.atan2(height - self.height, arc) - 0.5 * arc / EFFECTIVE_EARTH_RADIUS
        # images by way of a duct, or grazing a warm sea, lie up to 10 mrad from the straight line
        wide = STRAYED + 0.2 * arc / EFFECTIVE_EARTH_RADIUS
        elevations = np.linspace(max(middle - wide, -0.499 * math.pi), min(middle + wide, 0.499 * math.pi), 8001)
        off = self.paths(elevations).at(arc) - height
        brackets = np.flatnonzero((off[:-1] <= 0.0) != (off[1:] <= 0.0))
        brackets = brackets[np.isfinite(off[brackets]) & np.isfinite(off[brackets + 1])]
        low, high, below = elevations[brackets], elevations[brackets + 1], off[brackets]
        # bisection of all intervals at once, with the sign of the lower end
        for _ in range(HALVINGS):
            half = 0.5 * (low + high)
            half_off = self.paths(half).at(arc) - height
            same_side = (half_off <= 0.0) == (below <= 0.0)
            low, high, below = np.where(same_side, half, low), np.where(same_side, high, half), np.where(same_side, half_off, below)
        return 0.5 * (low + high)


@dataclass(frozen=True, eq=False)
class RowShift:
    """Rows of a camera as mixtures of rows of a finer, standard picture. Make it with ``of``."""

    camera: Camera  #: Grid of the picture.
    standard: Camera  #: Grid of the standard picture.
    bending: Bending  #: The air.
    rays: RayPaths  #: Rays of the rows, from the top down.
    _sea: list[csr_array] = field(default_factory=list)

    @classmethod
    def of(cls, bending: Bending, camera: Camera) -> RowShift:
        """Follow the rays of a camera's rows and choose a standard picture that covers all places that they see."""
        edge = 0.5 * math.pi - 1e-9
        parts = min(max(MOST_RAYS // camera.rows, FEWEST_RAYS), RAYS_PER_ROW)
        nodes: FloatArray = np.clip(camera.top - camera.row_step / parts * np.arange(camera.rows * parts + 1), -edge, edge)
        rays = bending.paths(nodes)
        # halve the gaps between rays that see different things, so that the edges of sea, sky and mirages lie within a small part of a row
        for _ in range(HALVINGS):
            straight = bending.straight(rays)
            cut = np.flatnonzero(_broken(nodes, straight) | (np.diff(rays.sea.astype(int)) != 0))
            if cut.size == 0:
                break
            nodes = np.asarray(np.sort(np.concatenate([nodes, 0.5 * (nodes[cut] + nodes[cut + 1])]))[::-1], np.float64)
            rays = bending.paths(nodes)
        straight, step = bending.straight(rays), camera.row_step / FINER
        above = math.ceil(max(float(straight.max()) - camera.top, 0.0) / step) + FINER
        top = camera.top + above * step
        # whole steps from the camera's top, also where the zenith limits them
        if top > 0.5 * math.pi:
            top = camera.top + math.floor((0.5 * math.pi - camera.top) / step) * step
        bottom = max(float(straight.min()) - FINER * step, -0.5 * math.pi)
        rows = max(math.floor((top - bottom) / step), 1)
        return cls(camera, _grid(camera, top, step, rows), bending, rays)

    @property
    def sea(self) -> csr_array:
        """Shares of the standard picture's rows in the camera's, of sea and sky [1, (rows, standard rows)]."""
        if not self._sea:
            self._sea.append(self._mixed(self.bending.straight(self.rays), self.standard, clamped=True)[0])
        return self._sea[0]

    def behind(self, share: FloatArray) -> csr_array:
        """Return the shares of ``sea`` times the transmitted ``share`` of every piece between two rays [1, (rows, standard rows)]."""
        return self._mixed(self.bending.straight(self.rays), self.standard, clamped=True, factor=share)[0]

    @cached_property
    def beyond(self) -> FloatArray:
        """Arc of the sea beyond the standard horizon in every piece between two rays [m, (rays - 1,)]; 0 elsewhere."""
        beyond = self.bending.beyond(self.rays)
        both = self.rays.sea[:-1] & self.rays.sea[1:]
        return np.where(both, 0.5 * (beyond[:-1] + beyond[1:]), 0.0)

    def summed(self, light: FloatArray) -> FloatArray:
        """Return the mean over each row [unit of the light, (rows,)] of the light added by the pieces between rays (rays - 1,)."""
        row, share = self._pieces
        return np.asarray(np.bincount(row, share * light, self.camera.rows), np.float64)

    def wider(self, margin: float) -> Camera:
        """Return the grid of the standard picture with rows added above and below, up to a ``margin`` [rad]."""
        step, one = self.standard.row_step, self.standard
        above = math.floor(min(margin, 0.5 * math.pi - one.top) / step)
        below = math.floor(min(margin, one.bottom + 0.5 * math.pi) / step)
        return _grid(self.camera, one.top + above * step, step, one.rows + above + below)

    def objects(self, arc: float, standard: Camera, *, into_sea: bool) -> tuple[csr_array, csr_array]:
        """Return shares of a standard picture's rows in the camera's rows for an object at an arc [m], and shares times row [1, pixels]."""
        return self._mixed(self.bending.over(self.rays, arc, into_sea=into_sea), standard, clamped=False)

    def images(self, arc: float, elevation: float, *, into_sea: bool) -> list[tuple[float, float]]:
        """Return the images of a point at an arc [m] and a standard elevation [rad]: row from the top [pixels], and magnification [1]."""
        e, difference = self.rays.elevation, self.bending.over(self.rays, arc, into_sea=into_sea) - elevation
        with np.errstate(invalid="ignore", divide="ignore"):
            crossed = np.flatnonzero((difference[:-1] > 0.0) & (difference[1:] <= 0.0) | (difference[:-1] <= 0.0) & (difference[1:] > 0.0))
            share = difference[crossed] / (difference[crossed] - difference[crossed + 1])
            magnification = np.abs((e[crossed + 1] - e[crossed]) / (difference[crossed + 1] - difference[crossed]))
        rows = (self.camera.top - (e[crossed] + share * (e[crossed + 1] - e[crossed]))) / self.camera.row_step
        return [(float(row), float(size)) for row, size in zip(rows, magnification, strict=True)]

    def sea_arcs(self) -> FloatArray:
        """Return the mean arc of the sea in each row [m, (rows,)]; NaN for a row without sea."""
        row, share = self._pieces
        both = self.rays.sea[:-1] & self.rays.sea[1:]
        arc = 0.5 * (self.rays.end[:-1] + self.rays.end[1:])
        total = np.bincount(row[both], share[both], self.camera.rows)
        with np.errstate(invalid="ignore"):
            return np.bincount(row[both], share[both] * arc[both], self.camera.rows) / np.where(total > 0.0, total, np.nan)

    @cached_property
    def _pieces(self) -> tuple[NDArray[np.intp], FloatArray]:
        """Row of each piece between two rays, and the share of the row that the piece fills [1]."""
        e = self.rays.elevation
        row = ((self.camera.top - 0.5 * (e[:-1] + e[1:])) / self.camera.row_step).astype(np.intp)
        return np.clip(row, 0, self.camera.rows - 1), (e[:-1] - e[1:]) / self.camera.row_step

    def _mixed(
        self, straight: FloatArray, standard: Camera, *, clamped: bool, factor: FloatArray | None = None
    ) -> tuple[csr_array, csr_array]:
        """Return the shares of standard rows and their first moments; places beyond the standard picture move to its edge if ``clamped``.

        Without ``clamped`` they are left out.
        """
        e, (row, share) = self.rays.elevation, self._pieces
        share = share if factor is None else share * factor
        place = (standard.top - straight) / standard.row_step
        first, last = place[:-1].copy(), place[1:].copy()
        ends = (first, last)
        apart = _broken(e, straight) | (np.diff(self.rays.sea.astype(int)) != 0) if clamped else _broken(e, straight)
        # between rays that see different things each ray represents half of the piece
        whole = np.isfinite(first) & np.isfinite(last) & ~apart
        parts = [(row[whole], share[whole], first[whole], last[whole])]
        for end in ends:
            half = np.isfinite(end) & ~whole
            parts.append((row[half], 0.5 * share[half], end[half], end[half]))
        row, share, first, last = (np.concatenate(some) for some in zip(*parts, strict=True))
        middle = (self.camera.top - 0.5 * (e[:-1] + e[1:])) / self.camera.row_step
        where = np.concatenate([middle[whole], *(middle[np.isfinite(end) & ~whole] for end in ends)])
        low, high = np.minimum(first, last), np.maximum(first, last)
        if clamped:
            low, high = (np.clip(x, 1e-9, standard.rows - 1e-6) for x in (low, high))
        high = np.maximum(high, low + 1e-9)
        rows, columns, weights, moments = [], [], [], []
        # the k-th standard row of every piece at once; most pieces lie in one or two rows
        for k in range(int(np.ceil(np.max(high - low, initial=0.0))) + 1):
            cell = np.floor(low) + k
            part = share * np.clip(np.minimum(high, cell + 1.0) - np.maximum(low, cell), 0.0, None) / (high - low)
            inside = (part > 0.0) & (cell >= 0) & (cell < standard.rows)
            rows.append(row[inside])
            columns.append(cell[inside].astype(np.intp))
            weights.append(part[inside])
            moments.append(part[inside] * where[inside])
        at = (np.concatenate(rows), np.concatenate(columns))
        size = (self.camera.rows, standard.rows)
        return csr_array((np.concatenate(weights), at), shape=size), csr_array((np.concatenate(moments), at), shape=size)


def _broken(elevation: FloatArray, straight: FloatArray) -> NDArray[np.bool_]:
    """Return True between rays whose places in the standard picture lie far apart [(rays - 1,)]."""
    with np.errstate(invalid="ignore"):
        return np.abs(np.diff(straight)) > BROKEN * np.abs(np.diff(elevation)) + 1e-12


def _grid(camera: Camera, top: float, step: float, rows: int) -> Camera:
    return Camera(camera.height, camera.azimuth, top - 0.5 * rows * step, camera.width, rows * step, camera.columns, rows)


#: Layers of light, which more air in front of the sea weakens.
RADIANCES: Final = ("radiance", "path_radiance", "emitted_radiance", "sky_radiance", "glint_radiance", SPARKLE)

MEANS: Final = ("range", "slope")  #: Layers that are means over the visible sea in a pixel.


@dataclass(frozen=True, eq=False)
class RefractedScene:
    """Scene of an upright camera through a profile of air that bends its lines of sight."""

    standard: SweptScene  #: The scene with standard refraction, in finer rows.
    shift: RowShift  #: Rows of the camera as mixtures of the finer rows.

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
        """Return the view of sea, air and Sun, equal for all poses."""
        return self.view

    def sea(self, pose: Pose, time: float, ships: FoamSegments | None = NO_SEGMENTS) -> Instant:
        """Return the sea at a time [s] under a sensor."""
        return self.standard.sea(pose, time, ships)

    def directions(self, pose: Pose) -> tuple[FloatArray, FloatArray]:
        """Return the azimuths of the columns and the elevations of the rows [rad]."""
        return self.camera.azimuths, self.camera.elevations

    def drawn(self, pose: Pose, time: float, sea: Instant | None = None) -> Layers:
        """Return the image from a pose at a time [s]."""
        return self.shifted(image(self.standard, self._level(pose), time, sea))

    def columns(self, pose: Pose, time: float, part: tuple[int, int], sea: Instant | None = None) -> Layers:
        """Return the image of the columns ``part = (first, end)`` alone."""
        return self.shifted(self.standard.columns(self._level(pose), time, part, sea))

    def _level(self, pose: Pose) -> Pose:
        """Return the pose of the standard picture, which has its middle at another elevation."""
        up = pose.attitude.elevation - self.camera.elevation
        attitude = Attitude(pose.attitude.azimuth, self.standard.camera.elevation + up, pose.attitude.roll)
        return Pose(pose.east, pose.north, pose.height, attitude)

    @cached_property
    def _far(self) -> tuple[csr_array, FloatArray] | None:
        """Shares of standard rows behind the air beyond the standard horizon, and its radiance in each row; None without such air."""
        beyond = self.shift.beyond
        if not beyond.any():
            return None
        share, added = air_beyond(self.view, self.shift.bending, beyond)
        return self.shift.behind(share), self.shift.summed(added)

    def shifted(self, layers: Layers) -> Layers:
        """Return the layers of the standard picture in the camera's rows."""
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
            # beyond the standard horizon the standard picture has the horizon's distance
            over = np.nan_to_num(arcs) > horizon_range(self.camera.height)
            out["range"][over] = arcs[over, None]
        if "glint_share" in layers:
            out["glint_share"] = share_of_glint(out["glint_radiance"], out["radiance"])
        return Layers(out)


def air_beyond(view: SeaView, bending: Bending, beyond: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the transmitted share of the light from the standard horizon through more air [1], and the radiance of that air [W m-2 sr-1].

    That air extinguishes per metre as the air of the last tenth of the path to the standard horizon does; it has one temperature.

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
    # arcs rounded to 10 m: many pieces between rays share one spectrum
    arcs, each = np.unique(np.round(beyond, -1), return_inverse=True)
    through = np.exp(-np.maximum(per_metre, 0.0) * arcs[:, None])
    sea, air = (planck_wavenumber(nu, np.array(kelvin)) for kelvin in (view.sea_temperature, bending.air_temperature))
    share = ((through * tau[1] * sea) @ weights) / max(float((tau[1] * sea) @ weights), 1e-300)
    added = (1.0 - share) * float(light[1] @ weights) + ((1.0 - through) * tau[1] * air) @ weights
    return share[each], added[each]
