"""Frames of a moving sea: everything that does not change in time is made once, then one sweep per frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from seaglint.constants import EFFECTIVE_EARTH_RADIUS
from seaglint.conventions import FloatArray, horizon_depression, view_zenith_of_range
from seaglint.errors import DomainError
from seaglint.radiance.glint import visible_sun
from seaglint.radiance.mean import SeaView, band_grid
from seaglint.render.camera import Camera
from seaglint.render.facet import FacetOptics, FacetTables, facet_optics, sun_terms, sunlight, thermal_axes, thermal_sources
from seaglint.render.path_basis import fewest_terms, path_basis
from seaglint.render.surface import Surface, calm_surface, height, lattice_line, surface_of
from seaglint.render.sweep import Frame, Walk, calm_ranges, graded_ranges, sea_limits, sweep_columns
from seaglint.sea.field import WaveField
from seaglint.sea.slopes import SlopeStatistics

CREST = 1.25
"""Height above which no crest is expected, in significant heights: five standard deviations."""

STEPS_PER_WAVE = 4.0
"""Steps of the sweep per shortest resolved wave, as many as its lattice has; twice as many move column means by less than 0.5 %."""

MOST_LINES = 2
"""Most lines per column by default; where the columns are wider, the sea is sampled across them."""

SUBMERGED = 0.75
"""A sensor below this many significant heights (three standard deviations) would be under water now and then."""


@dataclass(frozen=True)
class Radiances:
    """One frame: radiance at the aperture and the reflected sunlight in it, (rows, columns) [W m-2 sr-1]."""

    total: NDArray[np.float32]
    sun: NDArray[np.float32]


def facet_slopes(slopes: SlopeStatistics, waves: WaveField | None) -> SlopeStatistics:
    """Statistics left to the facets: the model's variances minus what the interpolated lattices carry, per direction.

    Raises
    ------
    DomainError
        If resolved waves carry more than the model has.
    """
    if waves is None:
        return slopes
    up, cross = waves.resolved_mss()
    rest = (slopes.mss_up - up, slopes.mss_cross - cross)
    if min(rest) <= 0.0:
        raise DomainError(
            f"resolved waves carry slope variances {up:.4g} up and {cross:.4g} across the wind, more than the slope model's "
            f"{slopes.mss_up:.4g} and {slopes.mss_cross:.4g}; resolve longer waves only"
        )
    return SlopeStatistics(*rest, wind_to_azimuth=waves.spectrum.wind_to_azimuth)


def parting_samples(arcs: FloatArray, column_step: float, shortest_wave: float, most_lines: int) -> NDArray[np.int64]:
    """Samples [1] between which the number of lines in a column stays the same, doubling where they are a shortest wave apart."""
    stages = int(np.log2(most_lines))
    ranges = shortest_wave / column_step * 2.0 ** np.arange(stages)
    return np.concatenate([[0], np.searchsorted(arcs, ranges), [arcs.size]]).astype(np.int64)


class Renderer:
    """Renders frames of one sea through one camera.

    Parameters
    ----------
    view : SeaView
        Sea, air and Sun; its slopes are the total statistics.
    camera : Camera
        The image grid; stands at the view's sensor height.
    waves : WaveField, optional
        The part of the slopes that is geometry; the rest goes to the facets. Without it the image is the mean.
    step : float, optional
        Largest step of the sweep [m]; a quarter of the shortest resolved wave by default.
    most_lines : int, optional
        Most lines swept in each column, a power of two. Waves shorter than twice their spacing are sampled, not averaged, across a column.
    """

    def __init__(
        self, view: SeaView, camera: Camera, waves: WaveField | None = None, *, step: float | None = None, most_lines: int = MOST_LINES
    ) -> None:
        if camera.height != view.sensor_height:
            raise DomainError(
                f"camera at {camera.height:g} m, but the view is made for {view.sensor_height:g} m; give both the same height"
            )
        self.view, self.camera, self.waves = view, camera, waves
        self.shortest_wave = 2.0 * np.pi / waves.tiles[-1].k_max if waves is not None else np.inf
        self._step = step if step is not None else self.shortest_wave / STEPS_PER_WAVE
        self._most_lines = most_lines if waves is not None else 1
        self._frame = self._sky_rows()
        resolved = (0.0, 0.0)
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
            resolved = waves.resolved_mss()
            limits = sea_limits(camera, CREST * waves.significant_height)
            if limits is not None:
                arcs = graded_ranges(*limits, self._step, camera.height, camera.row_step)
        self._walk: Walk | None = None
        self._optics: FacetOptics | None = None
        if arcs.size > 1:
            self._prepare(arcs, resolved)

    @property
    def report(self) -> dict[str, Any]:
        """Settings of the sweep, for the provenance."""
        walk = self._walk
        return {
            "sweep_step_m": self._step if self.waves is not None else None,
            "sweep_samples": 0 if walk is None else int(walk.range_m.size),
            "sweep_range_m": [] if walk is None else [float(walk.range_m[0]), float(walk.range_m[-1])],
            "most_lines_per_column": self._most_lines,
            "spectral_terms": [] if walk is None else [int(walk.coefficients.shape[1]), int(walk.sun_coefficients.shape[1])],
        }

    def _prepare(self, arcs: FloatArray, resolved: tuple[float, float]) -> None:
        view, camera = self.view, self.camera
        middle = np.concatenate([arcs[:1], 0.5 * (arcs[1:] + arcs[:-1])])
        basis = path_basis(view.atmosphere, view.band, camera.height, middle)
        facets = facet_slopes(view.slopes, self.waves)
        sines = np.cos(view_zenith_of_range(camera.height, arcs[[-1, 0]]))
        half = 0.5 * camera.width
        axes, shape = thermal_axes(facets, resolved, (float(sines[0]), float(sines[1])), (camera.azimuth - half, camera.azimuth + half))
        share, zenith = visible_sun(view.solar_zenith)
        irradiance = view.sun_distance_factor * share * view.atmosphere.solar_irradiance(zenith)[basis.grid]
        sun = sunlight(zenith, view.solar_azimuth, bool(irradiance.max() > 0.0))
        full = facet_optics(basis, thermal_sources(basis, view), sun, sun_terms(basis, irradiance, view.water), facets, axes, shape)
        thermal, coefficients = fewest_terms(full.tables.thermal, basis.coefficients)
        reflected, sun_coefficients = fewest_terms(full.tables.sun, basis.coefficients)
        self._optics = full._replace(tables=FacetTables(thermal.astype(np.float32), axes, np.ascontiguousarray(reflected)))
        psi = arcs / EFFECTIVE_EARTH_RADIUS
        self._walk = Walk(
            arcs,
            np.cos(psi),
            EFFECTIVE_EARTH_RADIUS * np.sin(psi),
            camera.height + 2.0 * EFFECTIVE_EARTH_RADIUS * np.sin(0.5 * psi) ** 2,
            float(np.diff(arcs).max()),
            coefficients,
            sun_coefficients,
            basis.path_radiance,
            parting_samples(arcs, camera.column_step, self.shortest_wave, self._most_lines),
        )

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

    def surface(self, time: float) -> Surface:
        """The sea at a time [s]."""
        if self.waves is None:
            return calm_surface()
        tiles = self.waves.tiles
        lattices = self.waves.surfaces(time, workers=numba.get_num_threads())
        return surface_of(lattices, np.array([t.spacing for t in tiles]), np.array([t.rotation for t in tiles]))

    def radiances(self, time: float) -> Radiances:
        """Render the instant ``time`` [s] from the start: a function of the scene and the time alone.

        Raises
        ------
        DomainError
            If a crest at the sensor's foot stands above the sensor.
        """
        camera = self.camera
        images = np.empty((camera.columns, 2, camera.rows))
        if self._walk is None or self._optics is None:
            images[:, 0], images[:, 1] = self._frame.sky, 0.0
        else:
            surface = self.surface(time)
            foot = height(surface, 0, surface.height.shape[0], lattice_line(surface, 1.0, 0.0), 0.0)
            if foot >= camera.height:
                raise DomainError(
                    f"at {time:g} s the sea stands {foot:.2f} m high under the sensor, which is {camera.height:g} m above the mean sea"
                )
            sweep_columns(self._walk, self._frame, surface, *self._optics, camera.azimuths, camera.column_step, images)
        total, sun = np.ascontiguousarray(images.transpose(1, 2, 0), dtype=np.float32)
        return Radiances(total, sun)
