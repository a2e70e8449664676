"""Frames of a moving sea: everything that does not change in time is made once, then one sweep per frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from seaglint._jit import in_threads
from seaglint.conventions import FloatArray, horizon_depression, view_zenith_of_range
from seaglint.errors import DomainError
from seaglint.radiance.glint import visible_sun
from seaglint.radiance.mean import SeaView, band_grid
from seaglint.render.camera import Camera
from seaglint.render.facet import (
    FacetLevels,
    Sunlight,
    roughness_of,
    sun_terms,
    sunlight,
    thermal_axes,
    thermal_sources,
    thermal_table,
)
from seaglint.render.path_basis import TOGETHER, PathBasis, fewest_terms, path_basis
from seaglint.render.sparkle import Sparkles, sparkle_columns, sparkle_rows
from seaglint.render.surface import LONGEST_STRIP, STRIP, Surface, calm_surface, course, height, surface_of
from seaglint.render.sweep import PATH_EVERY, Frame, Walk, calm_ranges, graded_ranges, sea_limits, sight_lines, sweep_columns, upright
from seaglint.sea.detail import Detail
from seaglint.sea.field import WaveField
from seaglint.sea.shadowing import smith_lambda
from seaglint.sea.slopes import SlopeStatistics

CREST = 1.25
"""Height above which no crest is expected, in significant heights: five standard deviations."""

STEPS_PER_WAVE = 4.0
"""Steps of the sweep per shortest resolved wave, as many as its lattice has; twice as many move column means by less than 0.5 %."""

LINES_PER_WAVE = 4.0
"""Lines across a shortest wave, which keep the variance of a column's mean within 2 %; a single one would add 8 %."""

MOST_LINES = 2
"""Most lines per column by default; where the columns are wider, the sea is sampled across them."""

NEGLIGIBLE_SHADOW = 1e-3
"""Share of the sea in the shadow of resolved waves, by Smith's law, below which none is drawn."""

STEEPEST_RISE = 3.0
"""Rise of the sea along a shadow ray that is reckoned with, in rms slopes: one place in 700 is steeper."""

SUBMERGED = 0.75
"""A sensor below this many significant heights (three standard deviations) would be under water now and then."""

SHORTEST_WAVE_COLUMNS = 2.0
"""Columns that a band's longest waves must span to stay geometry, by default."""


@dataclass(frozen=True)
class Radiances:
    """One frame: radiance at the aperture and the reflected sunlight in it, (rows, columns) [W m-2 sr-1]."""

    total: NDArray[np.float32]
    sun: NDArray[np.float32]


def facet_slopes(slopes: SlopeStatistics, resolved: tuple[float, float], wind_to_azimuth: float) -> SlopeStatistics:
    """Statistics left to the facets: the model's variances minus what the interpolated lattices carry, along and across the wind of
    the waves.

    Raises
    ------
    DomainError
        If resolved waves carry more than the model has.
    """
    up, cross = resolved
    rest = (slopes.mss_up - up, slopes.mss_cross - cross)
    if min(rest) < 0.0 or (min(rest) == 0.0 and max(resolved) > 0.0):
        raise DomainError(
            f"resolved waves carry slope variances {up:.4g} up and {cross:.4g} across the wind, more than the slope model's "
            f"{slopes.mss_up:.4g} and {slopes.mss_cross:.4g}; resolve longer waves only"
        )
    return SlopeStatistics(*rest, wind_to_azimuth=wind_to_azimuth) if max(resolved) > 0.0 else slopes


def require_above(foot: float, height: float, time: float) -> None:
    """Refuse a sensor ``height`` above the mean sea that the sea under it, ``foot`` high [m], covers."""
    if foot >= height:
        raise DomainError(f"at {time:g} s the sea stands {foot:.2f} m high under the sensor, which is {height:g} m above the mean sea")


def stages(arcs: FloatArray, column_step: float, begins: FloatArray, shortest_waves: FloatArray, most_lines: int) -> NDArray[np.int64]:
    """Rows of :attr:`~seaglint.render.sweep.Walk.stage` for samples at ``arcs`` [m].

    Level ``l`` begins at the arc ``begins[l]``. A column has lines a quarter of a shortest wave apart or closer, up to ``most_lines``, a
    power of two; they never join again, as each has its own horizon.
    """
    level = np.searchsorted(begins, arcs, side="right") - 1
    apart = LINES_PER_WAVE * arcs * column_step / shortest_waves[level]
    parted = np.clip(np.floor(np.log2(np.maximum(apart, 0.5))) + 1.0, 0.0, np.log2(most_lines)).astype(np.int64)
    parted = np.maximum.accumulate(parted)
    starts = np.flatnonzero(np.concatenate([[True], (np.diff(level) != 0) | (np.diff(parted) != 0)]))
    doublings = np.diff(parted[starts], prepend=0)
    return np.concatenate([np.stack([starts, level[starts], doublings], axis=1), [[arcs.size, 0, 0]]]).astype(np.int64)


def _stacked(tables: list[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Tables of one shape together; empty ones, of logarithms, as zeros."""
    shape = max((table.shape for table in tables), key=lambda shape: shape[0])
    full = tuple(max(n, 1) for n in shape)
    return np.stack([table if table.size else np.zeros(full, np.float32) for table in tables])


class Renderer:
    """Renders frames of one sea through one camera.

    Parameters
    ----------
    view : SeaView
        Sea, air and Sun; its slopes are the total statistics. Without resolved waves facets hide each other from viewer and Sun by Smith's
        law, or from the viewer band by band where its ``shadowing`` is nested.
    camera : Camera
        The image grid; stands at the view's sensor height.
    waves : WaveField, optional
        The part of the slopes that is geometry; the rest goes to the facets. Without it the image is the mean.
    step : float, optional
        Largest step of the sweep at the finest level of detail [m]; a quarter of the shortest resolved wave by default.
    most_lines : int, optional
        Most lines swept in each column, a power of two. Waves shorter than twice their spacing are sampled, not averaged, across a column.
    shortest_wave_columns : float, optional
        Where a column is wider than a band's longest waves over this number, the band goes to the facets; 0 keeps all waves at any range.
    """

    def __init__(
        self,
        view: SeaView,
        camera: Camera,
        waves: WaveField | None = None,
        *,
        step: float | None = None,
        most_lines: int = MOST_LINES,
        sparkles: Sparkles | None = None,
        shortest_wave_columns: float = SHORTEST_WAVE_COLUMNS,
    ) -> None:
        if camera.height != view.sensor_height:
            raise DomainError(
                f"camera at {camera.height:g} m, but the view is made for {view.sensor_height:g} m; give both the same height"
            )
        self.view, self.camera, self.waves = view, camera, waves
        self._most_lines = most_lines if waves is not None else 1
        self._frame = self._sky_rows()
        self._sparkle, self._sparkle_report = (sparkles or Sparkles(0, 1.0, 1.0, "off")).of(view, camera)
        self._sparkle_rows = sparkle_rows(camera)
        self._detail: Detail | None = None
        self._begins, self._steps, shortest = np.zeros(1), np.zeros(1), np.full(1, np.inf)
        arcs = np.empty(0)
        if waves is None:
            arcs = calm_ranges(camera)
        else:
            if camera.height < SUBMERGED * waves.significant_height:
                raise DomainError(
                    f"sensor height = {camera.height:g} m is within reach of the waves (significant height "
                    f"{waves.significant_height:.2f} m); place it above {SUBMERGED * waves.significant_height:.2f} m "
                    "or do not resolve waves"
                )
            limits = sea_limits(camera, CREST * waves.significant_height)
            detail = Detail.of(waves, None if shortest_wave_columns > 0.0 else 1)
            shortest = np.array([level.shortest_wave for level in detail.levels])
            begins = np.zeros(shortest.size)
            if shortest.size > 1:
                begins[1:] = shortest[1:] / (shortest_wave_columns * camera.column_step)
            used = int(np.count_nonzero(begins < (limits[1] if limits is not None else 0.0)))
            self._detail = detail.first(max(used, 1))
            self._begins, shortest = begins[: max(used, 1)], shortest[: max(used, 1)]
            self._steps = shortest / STEPS_PER_WAVE if step is None else shortest * (step / shortest[0])
            cells = [self._detail.parts[level.parts[-1]].tiles[0].spacing for level in self._detail.levels]
            if np.any(self._steps * STRIP >= LONGEST_STRIP * np.array(cells)):
                raise DomainError(
                    f"step = {self._steps[0]:g} m does not suit lattices of {cells[0]:g} m; "
                    f"allowed are less than {LONGEST_STRIP // STRIP} cells"
                )
            if limits is not None:
                arcs = graded_ranges(*limits, self._begins, self._steps, camera.height, camera.row_step)
        self._walk: Walk | None = None
        self._sun: Sunlight | None = None
        self._facets: FacetLevels | None = None
        if arcs.size > 1:
            self._prepare(arcs, stages(arcs, camera.column_step, self._begins, shortest, self._most_lines))

    def reseed(self, seed: int) -> None:
        """Go on with another realisation of the same sea, without preparing anything again."""
        if self.waves is not None and self._detail is not None:
            self.waves = self.waves.reseeded(seed)
            self._detail = Detail.of(self.waves).first(len(self._detail.levels))

    @property
    def report(self) -> dict[str, Any]:
        """Settings of the sweep, for the provenance."""
        walk, detail = self._walk, self._detail
        return {
            "sweep_step_m": [float(step) for step in self._steps] if detail is not None else None,
            "sweep_samples": 0 if walk is None else int(walk.range_m.size),
            "sweep_range_m": [] if walk is None else [float(walk.range_m[0]), float(walk.range_m[-1])],
            "level_begins_m": [float(r) for r in self._begins] if detail is not None else None,
            "level_shortest_wave_m": [level.shortest_wave for level in detail.levels] if detail is not None else None,
            "most_lines_per_column": self._most_lines,
            **self._sparkle_report,
            "spectral_terms": [] if walk is None else [int(walk.coefficients.shape[1]), int(walk.sun_coefficients.shape[1])],
        }

    def _prepare(self, arcs: FloatArray, stage: NDArray[np.int64]) -> None:
        view, camera = self.view, self.camera
        every = 1 if self.waves is None else PATH_EVERY
        # of the middle of the piece that ends at a sample
        middle = np.concatenate([arcs[:1], 0.5 * (arcs[1:] + arcs[:-1])])
        basis = path_basis(view.atmosphere, view.band, camera.height, np.append(middle[::every], middle[-1:]))
        share, zenith = visible_sun(view.solar_zenith)
        irradiance = view.sun_distance_factor * share * view.atmosphere.solar_irradiance(zenith)[basis.grid]
        self._sun = sunlight(zenith, view.solar_azimuth, bool(irradiance.max() > 0.0))
        self._facets, coefficients, sun_coefficients = self._level_facets(basis, arcs, sun_terms(basis, irradiance, view.water))
        lines = sight_lines(arcs, camera.height)
        self._walk = Walk(arcs, *lines, coefficients, sun_coefficients, basis.path_radiance, every, stage, self._shadows())

    def _shadows(self) -> FloatArray:
        """Step [m] and steepest rise of shadow rays at every level; 0 where next to nothing is in shadow by Smith's law."""
        sun, detail = self._sun, self._detail
        if sun is None or detail is None or self.waves is None or not sun.shining:
            return np.zeros((self._steps.size, 2))
        towards = self.waves.spectrum.wind_to_azimuth
        rms = np.sqrt([SlopeStatistics(*level.mss, wind_to_azimuth=towards).mss_along(sun.azimuth) for level in detail.levels])
        shadow = smith_lambda(max(sun.lower_tangent, 0.0) / (np.sqrt(2.0) * np.maximum(rms, 1e-9)))
        return np.stack([np.where(shadow > NEGLIGIBLE_SHADOW, self._steps, 0.0), STEEPEST_RISE * rms], axis=1)

    def _level_facets(self, basis: PathBasis, arcs: FloatArray, reflected_sun: FloatArray) -> tuple[FacetLevels, FloatArray, FloatArray]:
        """Facets of every level, and the path's coefficients for their thermal and solar tables."""
        view, camera = self.view, self.camera
        sources, half = thermal_sources(basis, view), 0.5 * camera.width
        resolved = [(0.0, 0.0)] if self._detail is None else [level.mss for level in self._detail.levels]
        crest = 0.0 if self.waves is None else self.waves.significant_height
        bands = view.nested_bands if self.waves is not None else view.shadowing.law_bands(view.slopes)
        towards = view.slopes.wind_to_azimuth if self.waves is None else self.waves.spectrum.wind_to_azimuth
        floor = float(np.cos(view_zenith_of_range(camera.height, arcs[-1:]))[0])
        roughs, tables, shapes, axes = [], [], [], []
        for i, mss in enumerate(resolved):
            facets = facet_slopes(view.slopes, mss, towards)
            share = facets.mss / view.slopes.mss if view.slopes.mss > 0.0 else 1.0
            roughs.append(roughness_of(facets, view.solar_azimuth, bands * share, sun_too=self.waves is not None or view.shadowing.sun))
            # grazing angles of the level, with the crests' own
            ends = np.clip([self._begins[i], self._begins[i + 1] if i + 1 < len(resolved) else arcs[-1]], arcs[0], arcs[-1])
            high, low = np.cos(view_zenith_of_range(camera.height, ends)) + np.array([1.0, -1.0]) * crest / np.maximum(ends, camera.height)
            sines = (max(float(low), floor), min(float(high), 1.0))
            nodes, shape = thermal_axes(facets, mss, sines, (camera.azimuth - half, camera.azimuth + half))
            tables.append(thermal_table(sources, roughs[-1], nodes, shape, basis.phi.shape[0]))
            shapes.append(shape)
            axes.append(nodes)
        flat = [table.reshape(-1, table.shape[-1]) for table in tables]
        thermal, coefficients = fewest_terms(np.concatenate(flat), basis.coefficients, TOGETHER)
        reflected, sun_coefficients = fewest_terms(reflected_sun, basis.coefficients)
        first = np.concatenate([[0], np.cumsum([len(part) for part in flat])[:-1]])
        levels = FacetLevels(
            np.array([rough[:4] for rough in roughs]),
            _stacked([rough.nested for rough in roughs]),
            _stacked([rough.lit for rough in roughs]),
            all(rough.nested.size == 0 for rough in roughs),
            thermal.astype(np.float32),
            np.concatenate([first[:, None], np.array(shapes)], axis=1),
            np.stack(axes),
            np.ascontiguousarray(reflected),
        )
        return levels, coefficients, sun_coefficients

    def _sky_rows(self) -> Frame:
        camera, view = self.camera, self.view
        elevation = np.maximum(camera.elevations, -horizon_depression(camera.height))
        # only rows that touch the sky are looked up; crests never lower the horizon by more than a few rows
        sky = np.zeros(camera.rows)
        rows = camera.top - np.arange(camera.rows) * camera.row_step > -horizon_depression(camera.height) - 2e-3
        if rows.any():
            weights, grid = band_grid(view.band, view.atmosphere)
            sky[rows] = view.atmosphere.sky_radiance(0.5 * np.pi - elevation[rows], camera.height)[:, grid] @ weights
        bottom = float(np.tan(max(camera.bottom, -0.5 * np.pi + 1e-9)))
        top = float(np.tan(min(camera.top, 0.5 * np.pi - 1e-9)))
        return Frame(camera.top, 1.0 / camera.row_step, camera.rows, bottom, top, sky)

    def surface(self, time: float, origin: tuple[float, float] = (0.0, 0.0)) -> Surface:
        """The sea at a time [s], with the sensor above ``origin``, east and north [m]."""
        if self._detail is None:
            return calm_surface()
        tiles = [part.tiles[0] for part in self._detail.parts]
        return surface_of(
            self._detail.surfaces(time, workers=numba.get_num_threads()),
            np.array([t.spacing for t in tiles]),
            np.array([t.rotation for t in tiles]),
            tuple(level.parts for level in self._detail.levels),
            origin,
        )

    def radiances(self, time: float, origin: tuple[float, float] = (0.0, 0.0)) -> Radiances:
        """Render the instant ``time`` [s] from the start, the sensor above ``origin``, east and north [m]: a function of the scene, the
        place and the time alone.

        Raises
        ------
        DomainError
            If a crest at the sensor's foot stands above the sensor.
        """
        camera = self.camera
        images = np.zeros((camera.columns, 3, camera.rows))
        if self._walk is None or self._sun is None or self._facets is None:
            images[:, 0], images[:, 1] = self._frame.sky, 0.0
        else:
            surface = self.surface(time, origin)
            line = course(surface, 0, 1.0, 0.0)
            foot = height(surface, line, 0, line.part.shape[0], 0.0)
            require_above(foot, camera.height, time)
            scene = (self._walk, self._frame, surface, self._sun, self._facets, self._sparkle)
            in_threads(lambda part: sweep_columns(*scene, camera.azimuths, camera.column_step, images, part), camera.columns)
            place = (float(origin[0]), float(origin[1]))
            sparkle_columns(self._sparkle, self._sparkle_rows, self._sun, camera.azimuths, place, float(time), images)
        total, sun = np.empty((2, camera.rows, camera.columns), np.float32)
        upright(images, total, sun)
        return Radiances(total, sun)
