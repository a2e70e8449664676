"""Scene of an upright, fixed camera with equal steps of azimuth and elevation: one sweep over the sea yields an image.

:meth:`SweptScene.prepare` fills tables of the samples along a line, of the path, the facets, the sky and the Sun (``sky_rows``). An
image then needs only the sea of its instant.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression, view_zenith_of_range, wrap_angle
from seaglint.base.errors import DomainError
from seaglint.facet.facet_tables import FacetDomain, facet_slopes, facet_tables
from seaglint.facet.foam import NO_FOAM
from seaglint.facet.foam_light import foam_tables
from seaglint.facet.path_basis import path_basis
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sky import sky_above
from seaglint.facet.sunlight import Sunlight
from seaglint.imaging import launch
from seaglint.imaging.camera.imager import Attitude, Camera, Imager, pixels_of
from seaglint.imaging.camera.pose import Pose
from seaglint.imaging.layers import CHANNELS, SPREAD, SUN, TOTAL, Layers, channels_for, layers_of, planes_for, require_layers, summed
from seaglint.imaging.scene import CLEAR, Accuracy, Instant, Levels, SceneFoam, averaged_share, joined, require_columns, scene_foam
from seaglint.imaging.sparkle import sparkle_rows
from seaglint.imaging.sparkle_settings import NO_SPARKLES, Sparkles
from seaglint.imaging.sun_in_sky import NO_SUN, sun_in_sky
from seaglint.imaging.sweep.sweep import NEGLIGIBLE_MOON, NEGLIGIBLE_SUN, SHARED, Rows, Swept
from seaglint.imaging.sweep.walk import PATH_EVERY, Merging, Walk, calm_ranges, graded_ranges, sea_limits, sight_lines, stages
from seaglint.imaging.wave_surface import Surface
from seaglint.sea.foam.foam_field import FoamField
from seaglint.sea.foam.ship_foam import NO_SEGMENTS, FoamSegments
from seaglint.sea.shadowing.smith import smith_lambda
from seaglint.sea.slopes.slope_statistics import gaussian_slopes
from seaglint.sea.wave_field import WaveField


def sky_rows(view: SeaView, camera: Camera) -> Rows:
    """Return the rows of a camera, with the radiance of the sky and the Sun in rows that touch the sky."""
    elevation = np.maximum(camera.elevations, -horizon_depression(camera.height))
    # the sky is evaluated in rows that touch it only, with 2 mrad to spare: crests never lower the horizon by more than a few rows
    visible = elevation[camera.top - np.arange(camera.rows) * camera.row_step > -horizon_depression(camera.height) - 2e-3]
    bottom = float(np.tan(max(camera.bottom, -0.5 * np.pi + 1e-9)))
    top = float(np.tan(min(camera.top, 0.5 * np.pi - 1e-9)))
    # one row more, as nothing is interpolated beyond the last
    sky = sky_above(view, np.append(visible, visible[-1:]))
    # a picture without sky has no Sun, and no need of the scattered sky that shifts it
    sun = sun_in_sky(view, camera.top) if visible.size else NO_SUN
    return Rows(camera.top, 1.0 / camera.row_step, camera.rows, bottom, top, sky, sun)


#: Least height of a sensor in significant heights (three standard deviations of the sea); lower sensors would at times be under water.
SUBMERGED = 0.75

CELLS_PER_ROW = 3.0  #: Number of cells of elevation in a row within which neighbouring pieces are merged.

#: Share of the sea in shadow below which one ray to the Sun serves merged neighbours; with more shadow none are merged.
RARE_SHADOW = 0.005

#: Tangent of depression, in rms slopes, beyond which ``RARE_SHADOW`` suffices: glint changes by less than 0.2 %; at the horizon by 2 %.
SHADOW_GRAZING = 0.25

SAME = 1e-9  #: Tolerance within which angles [rad], steps and heights (relative) are equal.


@dataclass(frozen=True, eq=False)
class SweptScene:
    """Scene prepared for an upright, fixed camera; make it with :meth:`prepare`."""

    #: Sea, air and Sun, with the slope statistics of all waves. Facets hide each other from viewer and Sun according to its shadowing;
    #: resolved waves hide the sea behind them, and shade it where shadowing includes the Sun.
    view: SeaView
    camera: Camera  #: The image grid; its height is the view's sensor height or up to ``accuracy.height_step`` times that height.
    waves: WaveField | None  #: Waves that are geometry; the other slopes are facets. Without them the image is the mean.
    accuracy: Accuracy  #: Accuracy settings of the drawing.
    layers: tuple[str, ...]  #: Layers beside ``radiance`` and ``glint_radiance``.
    sparkles: Sparkles  #: Glint below the pixel.
    foam: SceneFoam  #: Foam; its share is the view's where no breaking waves are given.
    _prepared_for: Camera
    _levels: Levels
    _tables: Swept | None  #: Tables of the kernels; None where no sea can be seen.
    _row: float  #: Height of the pixels that the accuracy settings refer to [rad].
    _moonlit: SweptScene | None = None  #: The same sea under the Moon where that is a second light: its light is added.

    @classmethod
    def prepare(
        cls,
        view: SeaView,
        camera: Camera,
        waves: WaveField | None = None,
        *,
        accuracy: Accuracy | None = None,
        layers: Collection[str] = (),
        sparkles: Sparkles = NO_SPARKLES,
        finer: int = 1,
        breaking: FoamField | None = None,
    ) -> SweptScene:
        """Prepare everything that does not change in time, under the lights of the view (``SeaView.lights``).

        ``finer``: pixels of the camera along a side of the pixels that the accuracy settings refer to. A picture that is averaged over
        ``finer x finer`` pixels, or blurred as much, needs the waves, the lines of sight and the pieces of a row of the larger pixels.
        ``breaking``: breaking waves, for a view with foam; without them its mean share is everywhere.

        Raises
        ------
        DomainError
            Heights that differ, a sensor among the waves, waves steeper than the slope model, steps that do not suit the waves, or an
            unknown layer.
        """
        fine, names = accuracy or Accuracy(), require_layers(layers)
        view, second = view.lights
        lights = [view] if second is None else [view, second]
        # the accuracy of the Sun's picture, so that it is equal with and without a Moon; the Moon's under scattered sunlight alone
        leading = view if second is None or view.irradiance.any() else second
        if camera.height != view.sensor_height:
            raise DomainError(
                f"camera at {camera.height:g} m, but the view is made for {view.sensor_height:g} m; give both the same height"
            )
        levels, arcs, planned = Levels.calm(), np.empty(0), _coarser(camera, finer)
        if waves is None:
            doublings = calm_doublings(camera.column_step / leading.glint_width, fine.lines_per_column)
            fine, levels = replace(fine, lines_per_column=1 << doublings), replace(levels, parts=np.zeros(doublings))
            arcs = calm_ranges(camera)
        else:
            require_dry(camera.height, waves)
            limits = sea_limits(camera, fine.crest * waves.significant_height)
            first, last = limits if limits is not None else (0.0, 0.0)
            levels = Levels.of(waves, planned, fine, last, first, finer, share=averaged_share(leading.solar_zenith))
            if limits is not None:
                arcs = graded_ranges(*limits, levels.begins, levels.steps, camera.height, planned.row_step)
        scenes = [
            cls(light, camera, waves, fine, names, sparkles, scene_foam(light, breaking), camera, levels, None, planned.row_step)
            for light in lights
        ]
        if arcs.size > 1:
            scenes = [replace(scene, _tables=scene._tabled(arcs)) for scene in scenes]
        return scenes[0] if second is None else replace(scenes[0], _moonlit=scenes[1])

    @property
    def pose(self) -> Pose:
        """Pose of the camera above the sea's origin."""
        return Pose(0.0, 0.0, self.camera.height, Attitude(self.camera.azimuth, self.camera.elevation))

    @property
    def steps(self) -> FloatArray | None:
        """Largest step of the sweep at every level of detail [m]; None without resolved waves."""
        return None if self.waves is None else self._levels.steps

    @property
    def levels(self) -> Levels:
        """Levels of detail of the sea."""
        return self._levels

    @property
    def tables(self) -> Swept | None:
        """Tables that the kernels read; None where no sea can be seen."""
        return self._tables

    @property
    def report(self) -> Mapping[str, Any]:
        """Settings of the sweep, for the provenance of a file."""
        tables, detail, waves = self._tables, self._levels.detail, self.waves is not None
        return {
            "sweep_step_m": [float(step) for step in self._levels.steps] if waves else None,
            "sweep_samples": 0 if tables is None else int(tables.walk.range_m.size),
            "sweep_range_m": [] if tables is None else [float(tables.walk.range_m[0]), float(tables.walk.range_m[-1])],
            "level_begins_m": [float(r) for r in self._levels.begins] if waves else None,
            "level_shortest_wave_m": [level.shortest_wave for level in detail.levels] if waves else None,
            "level_averaged_over_m": list(self._levels.widths) if waves else None,
            "most_lines_per_column": self.accuracy.lines_per_column,
            **self.sparkles.of(self.view, self._prepared_for, self._levels)[1],
            "spectral_terms": [] if tables is None else [int(terms.shape[1]) for terms in tables.walk.path[:2]],
        }

    def with_camera(self, camera: Camera) -> SweptScene:
        """Return this scene through another camera without preparing anything again: some of its columns and rows, or slightly higher.

        Raises
        ------
        DomainError
            Pixels of another size, a view beyond the one prepared, or a height that the air was not prepared for.
        """
        prepared, highest = self._prepared_for, self._prepared_for.height * self.accuracy.height_step
        own, other = prepared.column_step, camera.column_step
        if abs(other - own) > SAME * own or abs(camera.row_step - prepared.row_step) > SAME * prepared.row_step:
            raise DomainError(
                f"pixels of {1e3 * other:.6g} x {1e3 * camera.row_step:.6g} mrad, and the scene was prepared for "
                f"{1e3 * own:.6g} x {1e3 * prepared.row_step:.6g} mrad; keep the pixels or prepare a scene for this camera"
            )
        outside = beyond(prepared, camera)
        if outside > SAME:
            raise DomainError(
                f"the camera looks {np.degrees(outside):.4g} deg beyond the view that the scene was prepared for; "
                "stay inside it or prepare a scene for this camera"
            )
        if not prepared.height * (1.0 - SAME) <= camera.height <= highest * (1.0 + SAME):
            raise DomainError(
                f"camera at {camera.height:g} m, and the scene was prepared for {prepared.height:g} to {highest:g} m; "
                "stay between them or prepare a scene for this height"
            )
        moonlit = None if self._moonlit is None else self._moonlit.with_camera(camera)
        if self._tables is None:
            return replace(self, camera=camera, _moonlit=moonlit)
        walk = self._tables.walk
        if camera.height != walk.eye:
            rise, fall = sight_lines(walk.range_m, camera.height)
            walk = walk._replace(eye=camera.height, rise=rise, fall=fall)
        rows = self._tables.rows if _same_rows(camera, self.camera) else sky_rows(self.view, replace(camera, height=prepared.height))
        return replace(self, camera=camera, _tables=self._tables._replace(walk=walk, rows=rows), _moonlit=moonlit)

    def reseeded(self, seed: int) -> Self:
        """Return another realisation of the same sea, sparkles included, without preparing anything again."""
        sparkles, tables = self.sparkles.reseeded(seed), self._tables
        if tables is not None:
            tables = tables._replace(sparkle=sparkles.of(self.view, self._prepared_for, self._levels)[0])
        moonlit = None if self._moonlit is None else self._moonlit.reseeded(seed)
        if self.waves is None:
            return replace(self, sparkles=sparkles, _tables=tables, _moonlit=moonlit)
        waves = self.waves.reseeded(seed)
        foam, levels = self.foam.reseeded(waves, seed), self._levels.reseeded(waves)
        return replace(self, waves=waves, sparkles=sparkles, foam=foam, _levels=levels, _tables=tables, _moonlit=moonlit)

    def surface(self, time: float, origin: tuple[float, float] = (0.0, 0.0)) -> Surface:
        """Return the sea at a time [s], with the sensor above ``origin``, east and north [m], at every level of detail."""
        return self._levels.surface(self._levels.lattices(time), origin, self.foam.at(time))

    @property
    def pixels(self) -> Imager:
        """Pixels of the camera, independent of its attitude."""
        return pixels_of(self.camera)

    def directions(self, pose: Pose) -> tuple[FloatArray, FloatArray]:
        """Return azimuths of the columns and elevations of the rows [rad]."""
        return self.camera.azimuths, self.camera.elevations

    def seen_from(self, pose: Pose) -> SeaView:
        """Return the view of sea, air and Sun, equal for all poses."""
        return self.view

    def sea(self, pose: Pose, time: float, ships: FoamSegments | None = NO_SEGMENTS) -> Instant:
        """Return the sea at a time [s] under a sensor, with the foam of ships, or without any foam."""
        foam = CLEAR if ships is None else self.foam.at(time, ships)
        lattices = self._levels.lattices(time)
        return Instant(self._levels, lattices, self._levels.surface(lattices, (pose.east, pose.north), foam))

    def drawn(self, pose: Pose, time: float, sea: Instant | None = None) -> Layers:
        """Return the image from a pose at a time [s]."""
        return self.columns(pose, time, (0, self.camera.columns), sea)

    def columns(self, pose: Pose, time: float, part: tuple[int, int], sea: Instant | None = None) -> Layers:
        """Return the image of the columns ``part = (first, end)`` alone; its bytes are equal to these columns of the whole image.

        Raises
        ------
        DomainError
            Columns outside the image.
        """
        require_columns(part, self.camera.columns)
        surface = self.surface(time, (pose.east, pose.north)) if sea is None else sea.surface
        images = self._swept(pose, time, part, surface, np.zeros((part[1] - part[0], 0)))
        return self._layers(images[:, 0])

    def scanned(self, poses: Sequence[Pose], times: Sequence[float]) -> Layers:
        """Return a scanner's image: each column has a pose and a time [s]; neighbours of equal pose and time are drawn together."""
        count = self.camera.columns
        if len(poses) != count or len(times) != count:
            raise DomainError(f"{len(poses)} poses and {len(times)} times for {count} columns; give one of each for every column")
        begins = [i for i in range(count) if i == 0 or (poses[i], times[i]) != (poses[i - 1], times[i - 1])]
        return joined([self.columns(poses[a], times[a], (a, b)) for a, b in zip(begins, [*begins[1:], count], strict=True)])

    def intervals(self, pose: Pose, time: float, cuts: FloatArray) -> tuple[Layers, ...]:
        """Return images of intervals of distance: between each cut and the cut before it, and beyond the last.

        Parameters
        ----------
        pose : Pose
            Place and attitude of the sensor.
        time : float
            Time from the start [s].
        cuts : ndarray
            Distances from the sensor at which columns are cut, ascending [m, (columns, n) or (n,)].

        Returns
        -------
        tuple of Layers
            n + 1 parts, near to far, in double precision; the sky belongs to the last. ``radiance`` and its parts are the light that an
            interval adds to each pixel, ``coverage`` the share of the pixel that it fills; :func:`composed` adds the intervals.
        """
        given, count = np.atleast_1d(np.asarray(cuts, np.float64)), self.camera.columns
        if given.size == 0 or given.ndim > 2 or (given.ndim == 2 and given.shape[0] != count):
            raise DomainError(f"cuts of shape {np.shape(cuts)} for {count} columns; give one distance or more, for all columns or for each")
        cut = np.ascontiguousarray(np.broadcast_to(given, (count, given.shape[-1])))
        if not np.all(np.isfinite(cut)) or np.any(np.diff(cut, axis=1) < 0.0):
            raise DomainError("cuts in range must be finite and ascend from the sensor in every column; sort them")
        images = self._swept(pose, time, (0, self.camera.columns), self.surface(time, (pose.east, pose.north)), cut)
        return tuple(self._interval(images[:, k]) for k in range(1, images.shape[1]))

    def _interval(self, columns: FloatArray) -> Layers:
        planes = np.arange(CHANNELS + 1)
        return layers_of(launch.planes_of(columns, planes, np.float64), planes, (*self.layers, "coverage"))

    def _layers(self, columns: FloatArray) -> Layers:
        """Return the layers of columns (columns, channels, rows)."""
        planes = planes_for(self.layers)
        return layers_of(launch.planes_of(columns, planes, np.float32), planes, self.layers)

    def planes(self, pose: Pose, time: float, surface: Surface, part: tuple[int, int]) -> NDArray[np.float32]:
        """Return planes as ``planes_for``, of some columns [units of layers, (planes, rows, columns)]."""
        images = self._swept(pose, time, part, surface, np.zeros((part[1] - part[0], 0)))
        return launch.planes_of(images[:, 0], planes_for(self.layers), np.float32)

    def _swept(self, pose: Pose, time: float, part: tuple[int, int], surface: Surface, cuts: FloatArray) -> FloatArray:
        """Return the channels of some columns under all lights (columns, 1 or 2 + cuts, channels, rows)."""
        images = self._lit(pose, time, part, surface, cuts)
        if self._moonlit is not None:
            more = self._moonlit._lit(pose, time, part, surface, cuts)
            for channel in (TOTAL, SUN, SPREAD):
                images[:, :, channel] += more[:, :, channel]
        return images

    def _lit(self, pose: Pose, time: float, part: tuple[int, int], surface: Surface, cuts: FloatArray) -> FloatArray:
        """Return the channels of some columns under the light of this view."""
        camera, tables = self.camera, self._tables
        self._require_pose(pose)
        intervals = cuts.shape[1] + 1 if cuts.shape[1] else 0
        channels = CHANNELS if intervals else channels_for(self.layers)
        azimuths = np.ascontiguousarray(camera.azimuths[part[0] : part[1]])
        if tables is None:
            rows = sky_rows(self.view, replace(camera, height=self._prepared_for.height))
            return launch.columns_of_sky(rows, azimuths, camera.column_step, intervals, channels)
        require_above(launch.foot_height(surface), camera.height, time)
        images = launch.columns_of_sea(tables, surface, azimuths, camera.column_step, cuts, channels)
        launch.add_sparkles(tables, sparkle_rows(camera), azimuths, (float(pose.east), float(pose.north)), float(time), images)
        return images

    def _require_pose(self, pose: Pose) -> None:
        camera, attitude = self.camera, pose.attitude
        turn = (float(wrap_angle(attitude.azimuth - camera.azimuth)), float(wrap_angle(attitude.roll)))
        off = max(abs(turn[0]), abs(turn[1]), abs(attitude.elevation - camera.elevation))
        if off > SAME or not np.isfinite(pose.east + pose.north) or abs(pose.height - camera.height) > SAME * camera.height:
            raise DomainError(
                f"pose at {pose.height:g} m, turned by {np.degrees(off):.4g} deg from the camera's; this scene is for {camera.height:g} m "
                "and an upright camera: use with_camera, or prepare a scene for turned cameras"
            )

    def _tabled(self, arcs: FloatArray) -> Swept:
        """Return the tables that columns read, for samples at ``arcs`` [m]."""
        view, camera, levels = self.view, self.camera, self._levels
        # a calm sea has few samples: the path is known at each
        every = 1 if self.waves is None else PATH_EVERY
        # the path is evaluated at the middle of the piece that ends at a sample
        middle = np.concatenate([arcs[:1], 0.5 * (arcs[1:] + arcs[:-1])])
        places = np.append(middle[::every], middle[-1:])
        basis = path_basis(view.atmosphere, view.band, camera.height, places)
        # columns share tables at azimuths up to half of their range beyond the outermost column
        half = min(0.5 * (camera.width + SHARED), max(np.pi, 0.5 * camera.width))
        sun, facets, path = facet_tables(
            view,
            basis,
            places,
            self._domains(arcs),
            (camera.azimuth - half, camera.azimuth + half),
            emitted=bool({"emitted_radiance", "sky_radiance"} & set(self.layers)),
        )
        stage = stages(arcs, levels.begins, levels.parts)
        march, highest = self._shadows(sun)
        walk = Walk(arcs, camera.height, *sight_lines(arcs, camera.height), path, every, stage, march)
        faint = NEGLIGIBLE_SUN if view.disc.ratio is None else NEGLIGIBLE_MOON
        merging = Merging(self.accuracy.merged_spread, CELLS_PER_ROW / self._row, highest)
        foam = NO_FOAM if view.foam is None else foam_tables(view, basis)
        sparkle = self.sparkles.of(view, camera, levels)[0]
        return Swept(walk, sky_rows(view, camera), sun, view.sun_table, facets, sparkle, merging, foam, faint)

    def _domains(self, arcs: FloatArray) -> list[FacetDomain]:
        """Return the facets of every level with the sines of their grazing angles, from troughs to crests."""
        view, waves, levels, eye = self.view, self.waves, self._levels, self.camera.height
        crest = 0.0 if waves is None else waves.significant_height
        towards = view.slopes.wind_to_azimuth if waves is None else waves.spectrum.wind_to_azimuth
        # facets are seen no more grazingly than the last sample
        floor = float(np.cos(view_zenith_of_range(eye, arcs[-1:]))[0])
        last = [*levels.begins[1:], arcs[-1]]
        out = []
        for level, begin, end in zip(levels.detail.levels, levels.begins, last, strict=True):
            facets = facet_slopes(view.slopes, level.mss, towards, level.covariance)
            law = view.hiding.facet_law(view.slopes, facets)
            ends = np.clip([begin, end], arcs[0], arcs[-1])
            high, low = np.cos(view_zenith_of_range(eye, ends)) + np.array([1.0, -1.0]) * crest / np.maximum(ends, eye)
            out.append(FacetDomain(facets, level.mss, law, (max(float(low), floor), min(float(high), 1.0))))
        return out

    def _shadows(self, sun: Sunlight) -> tuple[FloatArray, FloatArray]:
        """Return step [m] and steepest rise of shadow rays at every level, and the tangent up to which one ray serves several pieces.

        The step is 0 where the share of the sea in shadow is negligible by Smith's law. Beyond that tangent of elevation the visible pieces
        are the pieces most often in shadow.
        """
        levels, fine = self._levels, self.accuracy
        if self.waves is None:
            # pieces of a calm sea are long: the path changes from one to the next
            return np.zeros((1, 2)), np.full(1, -np.inf)
        if not sun.shining or not self.view.shadowing.sun:
            return np.zeros((levels.steps.size, 2)), np.full(levels.steps.size, np.inf)
        towards = self.waves.spectrum.wind_to_azimuth
        rms = np.sqrt([gaussian_slopes(*v.mss, v.covariance, towards).mss_along(sun.azimuth) for v in levels.detail.levels])
        # where a Sun behind the sensor is lowest
        lower = np.tan(max(0.5 * np.pi - self.view.solar_zenith - self.view.farthest_turn - SOLAR_ANGULAR_RADIUS, 0.0))
        shadow = smith_lambda(lower / (np.sqrt(2.0) * np.maximum(rms, 1e-9)))
        rays = shadow > fine.negligible_shadow
        highest = np.where(rays, np.where(shadow < RARE_SHADOW, -SHADOW_GRAZING * rms, -np.inf), np.inf)
        return np.stack([np.where(rays, levels.steps, 0.0), fine.steepest_rise * rms], axis=1), highest


def _coarser(camera: Camera, times: int) -> Camera:
    """Return the grid with pixels of ``times`` the side, to a whole number of them."""
    if times == 1:
        return camera
    return replace(camera, columns=max(round(camera.columns / times), 1), rows=max(round(camera.rows / times), 1))


def calm_doublings(width: float, most: int) -> int:
    """Return the number of times that the lines of a column split in two over a sea without waves.

    They split until a deviation of the glint contains three lines, or until there are ``most`` lines; ``width``: of the column, in
    deviations of the glint.

    >>> calm_doublings(0.3, 16), calm_doublings(1.0, 16), calm_doublings(9.0, 16)
    (0, 2, 4)
    """
    return min(max(math.ceil(3.0 * width) - 1, 0), most - 1).bit_length()


def beyond(prepared: Camera, other: Camera) -> float:
    """Return the angle by which the view of a camera extends beyond another's view [rad]; 0 or less for a view inside it."""
    aside = abs(float(wrap_angle(other.azimuth - prepared.azimuth))) + 0.5 * (other.width - prepared.width)
    around = prepared.width >= 2.0 * np.pi - SAME
    return max(-np.inf if around else aside, other.top - prepared.top, prepared.bottom - other.bottom)


def composed(parts: Sequence[Layers]) -> Layers:
    """Return the whole image from its :meth:`SweptScene.intervals`, front to back."""
    return summed(parts)


def require_above(foot: float, height: float, time: float) -> None:
    """Raise for a sensor ``height`` [m] above the mean sea that is not above the sea under it, ``foot`` [m] high."""
    if foot >= height:
        text = f"at {time:g} s the sea stands {foot:.2f} m high under the sensor, which is {height:g} m above the mean sea"
        raise DomainError(
            f"{text}; place it higher or do not resolve waves (sea.resolve_waves = false)",
            name="sensor_height",
            value=height,
            allowed=f"above {foot:.2f} m",
        )


def require_dry(height: float, waves: WaveField) -> None:
    """Raise for a sensor ``height`` [m] that waves would reach at times."""
    if height < SUBMERGED * waves.significant_height:
        raise DomainError(
            f"sensor height = {height:g} m is within reach of the waves (significant height {waves.significant_height:.2f} m); "
            f"place it above {SUBMERGED * waves.significant_height:.2f} m or do not resolve waves (sea.resolve_waves = false)",
            name="sensor_height",
            value=height,
            allowed=f"above {SUBMERGED * waves.significant_height:.2f} m",
        )


def _same_rows(one: Camera, other: Camera) -> bool:
    return (one.elevation, one.height_angle, one.rows) == (other.elevation, other.height_angle, other.rows)
