"""One instant of a scenario's sea for other programs: heights, slopes, and the roughness below the resolved waves."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError, ScenarioError
from seaglint.base.free_form import Attributes
from seaglint.base.schema import VARIABLES
from seaglint.formats.mesh import MOST_VERTICES, ply_bytes, write_ply
from seaglint.scenario.model import Scenario
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, gaussian_slopes
from seaglint.sea.tiles import Tile, Wander
from seaglint.sea.wave_field import WaveField
from seaglint.store.netcdf import write_netcdf
from seaglint.store.provenance import provenance
from seaglint.studies.build import scenario_physics
from seaglint.studies.build.waves_and_slopes import slopes
from seaglint.studies.sequence.memory import memory_available

if TYPE_CHECKING:
    import xarray as xr

KINDS: Final = (".ply", ".nc")  #: Endings of the files that are written.

DEFAULT_EXTENT: Final = 256.0  #: Default side of the patch [m], if the spacing allows it.

DEFAULT_POINTS: Final = 1024  #: Largest number of points along a side of the default patch.

_BYTES_PER_POINT: Final = 12 + 80  #: Height and slopes in single precision, and the copies of labelling and compressing them.

_BLOCK: Final = 1 << 18

_READING: Final = (
    "one period of a tile; the sea is the sum of all tiles, each read at the place x + d(x), with d = sum of wander_amplitude times "
    "sin(wander_wave_vector . x + wander_phase), east and north"
)


@dataclass(frozen=True)
class SeaPatch:
    """Patch in which the sea is sampled: centre (east, north), extent (east, north), and distance of points [m]."""

    centre: tuple[float, float]
    extent: tuple[float, float]
    spacing: float

    def __post_init__(self) -> None:
        """Refuse a patch without area or smaller than its spacing."""
        numbers = (*self.centre, *self.extent, self.spacing)
        if not all(math.isfinite(value) for value in numbers) or min(*self.extent, self.spacing) <= 0.0:
            raise DomainError(
                f"a patch of {self.extent[0]:g} x {self.extent[1]:g} m every {self.spacing:g} m about ({self.centre[0]:g}, "
                f"{self.centre[1]:g}) m; give finite lengths above 0 m"
            )
        if min(self.extent) < self.spacing:
            raise DomainError(
                f"a patch of {self.extent[0]:g} x {self.extent[1]:g} m is smaller than its spacing of {self.spacing:g} m; "
                "give a larger extent or a smaller spacing"
            )

    @property
    def shape(self) -> tuple[int, int]:
        """Rows (north) and columns (east) of points; both edges belong to the patch."""
        east, north = (1.0 + math.floor(extent / self.spacing + 1e-9) for extent in self.extent)
        return int(north), int(east)

    @property
    def axes(self) -> tuple[FloatArray, FloatArray]:
        """Coordinates of the columns (east) and rows (north), ascending [m]."""
        rows, columns = self.shape
        east, north = self.centre
        return (
            np.asarray(east + (np.arange(columns) - 0.5 * (columns - 1)) * self.spacing),
            np.asarray(north + (np.arange(rows) - 0.5 * (rows - 1)) * self.spacing),
        )


@dataclass(frozen=True, eq=False)
class ExportedSea:
    """The sea of one instant.

    ``lattices[i]`` (n, n, 3) and ``patch_surface`` (rows, columns, 3) hold height [m] and slopes towards east and north [1], samples of
    one sea at their points; ``facets`` are the unresolved slopes. ``wander[i]`` is the displacement at which each tile is read.
    """

    time: float
    tiles: tuple[Tile, ...]
    wander: tuple[Wander, ...]
    lattices: tuple[NDArray[np.float32], ...]
    patch: SeaPatch
    patch_surface: NDArray[np.float32]
    facets: SlopeStatistics
    attributes: Attributes

    @property
    def comments(self) -> list[str]:
        """Return the header of a mesh: the meaning of its numbers, and the roughness, for which a mesh has no property."""
        ee, en, nn = self.facets.covariance()
        return [
            f"{self.attributes['source']}: sea at {self.time:g} s, x east, y north, z up from the mean sea, metres",
            "normals from the slopes of the waves, not from the triangles",
            f"unresolved slopes: Gaussian covariance east-east {ee:.6g}, east-north {en:.6g}, north-north {nn:.6g}",
        ]

    def dataset(self, *, lattices: bool = True) -> xr.Dataset:
        """Return the patch, the roughness, and the periodic lattices of the tiles."""
        import xarray as xr

        x, y = self.patch.axes
        names = ("height", "slope_east", "slope_north")
        out = xr.Dataset(
            {name: (("y", "x"), self.patch_surface[..., i]) for i, name in enumerate(names)},
            coords={"x": ("x", x, VARIABLES["east"].attributes), "y": ("y", y, VARIABLES["north"].attributes)},
            attrs=self.attributes,
        )
        covariance = zip(("east_east", "east_north", "north_north"), self.facets.covariance(), strict=True)
        out = out.assign({f"facet_slope_{name}": ((), value) for name, value in covariance})
        parts = zip(self.tiles, self.wander, self.lattices, strict=True)
        # Each tile has separate dimensions, because tiles differ in length and number of points.
        for i, (tile, wander, lattice) in enumerate(parts if lattices else ()):
            dimensions = (f"v_{i}", f"u_{i}")
            for j, name in enumerate(names):
                attributes = {
                    **VARIABLES[name].attributes,
                    "comment": _READING,
                    "length_m": tile.length,
                    "turn_deg": math.degrees(tile.rotation),
                    "shortest_wave_m": 2.0 * math.pi / tile.k_max,
                    "wander_amplitude_east_m": wander.amplitude[:, 0],
                    "wander_amplitude_north_m": wander.amplitude[:, 1],
                    "wander_wave_vector_east_rad_m": wander.wave_vector[:, 0],
                    "wander_wave_vector_north_rad_m": wander.wave_vector[:, 1],
                    "wander_phase_rad": wander.phase,
                }
                out[f"{name}_{i}"] = (dimensions, lattice[..., j], attributes)
            axis = np.arange(tile.n) * tile.spacing
            out = out.assign_coords({name: (name, axis, VARIABLES[f"tile_{name[0]}"].attributes) for name in dimensions})
        return out


def require_sea_name(output: Path) -> Path:
    """Return the path of a file of the sea; refuse endings that name no format."""
    if output.suffix.lower() not in KINDS:
        raise DataError(f"{output}: is neither {' nor '.join(KINDS)}; the ending says what is written")
    return output


def write_sea(sea: ExportedSea, output: Path, *, lattices: bool = True, overwrite: bool = False) -> Path:
    """Write the patch as a triangle mesh (``.ply``), or all of it as NetCDF (``.nc``).

    Raises
    ------
    DataError, StorageError
        An output of another ending, that exists, or that cannot be written.
    """
    if require_sea_name(output).suffix.lower() == ".ply":
        write_ply(output, *sea.patch.axes, sea.patch_surface, comments=sea.comments, overwrite=overwrite)
    else:
        write_netcdf(sea.dataset(lattices=lattices), output, overwrite=overwrite)
    return output


def export_sea(
    scenario: Scenario,
    time: float = 0.0,
    *,
    centre: tuple[float, float] = (0.0, 0.0),
    extent: tuple[float, float] | None = None,
    spacing: float | None = None,
) -> ExportedSea:
    """Sample the resolved waves of a scenario.

    Parameters
    ----------
    scenario : Scenario
        The sea.
    time : float
        Time from the start of the sequence [s].
    centre : (float, float)
        Middle of the patch, east and north of the sensor's foot [m].
    extent : (float, float), optional
        East and north size of the patch [m]; ``DEFAULT_EXTENT``, or what ``DEFAULT_POINTS`` points reach if that is less.
    spacing : float, optional
        Distance of points [m]; by default the spacing of the finest tile, a quarter of the shortest wave.

    Raises
    ------
    ScenarioError
        The scenario resolves no waves.
    DomainError
        A time or a patch that is not finite, or a patch that does not fit the memory.

    Examples
    --------
    >>> from seaglint.scenario.load import parse_scenario
    >>> small = parse_scenario({"render": {"tile_size": 128}, "sea": {"shortest_wave_m": 8.0}})
    >>> export_sea(small, 3.2, extent=(100.0, 50.0), spacing=5.0).patch_surface.shape
    (11, 21, 3)
    """
    if not math.isfinite(time):
        raise DomainError(f"time = {time:g} s must be finite")
    statistics = slopes(scenario)
    sea = scenario_physics.sea(scenario, statistics)
    if sea.waves is None:
        raise ScenarioError(
            f"no waves are resolved{': ' + sea.reason if sea.reason else ''}; there is no surface to export (see sea.resolve_waves)"
        )
    waves = sea.waves
    spacing = waves.tiles[-1].spacing if spacing is None else spacing
    if extent is None:
        # Fine spacing shrinks the default patch, so that its number of points is bounded.
        side = min(DEFAULT_EXTENT, (DEFAULT_POINTS - 1) * spacing)
        extent = (side, side)
    patch = SeaPatch(centre, extent, spacing)
    _require_room(patch)
    lattices = waves.surfaces(time)
    # The facets have the slope variance that the geometry does not have.
    up, cross = waves.resolved_mss()
    wind_to = waves.spectrum.wind_to_azimuth
    facets = gaussian_slopes(statistics.mss_up - up, statistics.mss_cross - cross, -waves.resolved_covariance(), wind_to)
    attributes = provenance("Sea surface", scenario.model_dump_json(exclude_none=True), scenario.seed, time_s=time, **sea.report)
    return ExportedSea(time, waves.tiles, waves.wander, lattices, patch, _sampled(waves, time, patch), facets, attributes)


def _require_room(patch: SeaPatch) -> None:
    rows, columns = patch.shape
    need, room = rows * columns * _BYTES_PER_POINT, memory_available()
    full = room is not None and need > room
    if rows * columns > MOST_VERTICES or full:
        limit = f"{(room or 0) / 1e9:.1f} GB are free" if full else f"a mesh holds {MOST_VERTICES} points at most"
        raise DomainError(
            f"a patch of {columns} x {rows} points needs {need / 1e9:.3g} GB of memory and {ply_bytes(rows, columns) / 1e9:.3g} GB as PLY, "
            f"and {limit}; give a smaller extent or a spacing larger than {patch.spacing:g} m"
        )


def _sampled(waves: WaveField, time: float, patch: SeaPatch) -> NDArray[np.float32]:
    """Return the sum of the tiles at the points of a patch (rows, columns, 3), each read from its spline at the displaced points."""
    rows, columns = patch.shape
    x, y = patch.axes
    splines = waves.splines(time)
    out = np.zeros((rows, columns, 3), np.float32)
    step = max(1, _BLOCK // columns)
    for first in range(0, rows, step):
        part = slice(first, min(first + step, rows))
        for tile, wander, spline in zip(waves.tiles, waves.wander, splines, strict=True):
            east, north = wander(x, y[part, None])
            out[part] += _read(tile, spline, x + east, y[part, None] + north)
    return out


def _read(tile: Tile, spline: NDArray[np.float32], x: FloatArray, y: FloatArray) -> NDArray[np.float64]:
    """Return height [m] and slopes [1] of a tile's cubic B-spline at points."""
    # Rotated into the tile and scaled to its cells in one step.
    c, s = math.cos(tile.rotation) / tile.spacing, math.sin(tile.rotation) / tile.spacing
    u, v = c * x + s * y, c * y - s * x
    i, j = np.floor(u).astype(np.int64), np.floor(v).astype(np.int64)
    (a, da), (b, db) = _weights(u - i), _weights(v - j)
    height, along, across = np.zeros((3, *u.shape))
    for m in range(4):
        for k in range(4):
            # Tiles are periodic.
            z = spline[(j + m - 1) % tile.n, (i + k - 1) % tile.n]
            height += b[m] * a[k] * z
            along += b[m] * da[k] * z
            across += db[m] * a[k] * z
    return np.stack([height, c * along - s * across, s * along + c * across], axis=-1)


def _weights(f: FloatArray) -> tuple[tuple[FloatArray, ...], tuple[FloatArray, ...]]:
    """Return the weights of four points on a cubic B-spline, and their derivatives [1/cell], ``f`` cells beyond the second of them."""
    e = 1.0 - f
    first, second, last = e**3 / 6.0, f * f * (0.5 * f - 1.0) + 2.0 / 3.0, f**3 / 6.0
    begin, middle, end = -0.5 * e * e, f * (1.5 * f - 2.0), 0.5 * f * f
    return (first, second, 1.0 - first - second - last, last), (begin, middle, -begin - middle - end, end)
