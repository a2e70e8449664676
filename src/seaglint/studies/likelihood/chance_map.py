"""Maps of the likelihood of glint over a region or the world's seas, month by month."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray, Progress
from seaglint.base.errors import ScenarioError
from seaglint.base.parameters import documented
from seaglint.climate.conditions import Conditions, GeographicRegion, PlaceLaw, Times
from seaglint.climate.draws import SamplingPlan
from seaglint.climate.sea_places import sea_places
from seaglint.climate.weather_table import WeatherTable
from seaglint.cluster import Job, Workers
from seaglint.cluster.job import record_of
from seaglint.scenario.model import Scenario
from seaglint.store.provenance import provenance
from seaglint.studies.build.profile_air import report_air
from seaglint.studies.build.scenario_physics import band
from seaglint.studies.likelihood.climatology import EVERYWHERE
from seaglint.studies.likelihood.draw_model import LikelihoodModel, require_no_moon
from seaglint.studies.likelihood.glint_chance import draw_values, evaluated, uniform_numbers
from seaglint.studies.study_requests import LikelihoodRequest

if TYPE_CHECKING:
    import xarray as xr


SAMPLES: Final = 512  #: Draws for each cell and month: chances within 0.02.

INTEGRATED: Final = 64  #: Draws for each cell and month where each draw integrates over azimuths: standard error a tenth of the chance.

STEP: Final = 1.0  #: Default size of a cell [deg].
WIDE_STEP: Final = 4.0  #: Default size of a cell of maps with more than ``_WIDE`` cells of ``STEP`` [deg], about that of the climatology.

_WIDE: Final = 10_000
_SHARED: Final = 2048  #: Most draws for all cells of a latitude where longitude does not matter.

_MOST: Final = 100_000
_TOGETHER: Final = 1_000_000  #: Draws of a piece at most: some 300 MB.


@documented(LikelihoodRequest)
def likelihood_map(
    scenario: Scenario,
    *,
    step: float | None = None,
    samples: int | None = None,
    weather: WeatherTable | None = None,
    progress: Progress | None = None,
    workers: Workers | None = None,
) -> xr.Dataset:
    """Return the chance that glint exceeds each threshold, over cells of the region and months.

    Parameters
    ----------
    scenario : Scenario
        Scenario with a region in ``[likelihood]``, or with the climatology of the world's seas.
    {request}
    samples : int, optional
        Draws for each cell and month; ``INTEGRATED`` where azimuths can be integrated, else ``SAMPLES``.
    weather : WeatherTable, optional
        Weather that replaces the scenario's.
    progress : callable, optional
        Called with (months done, months in all).
    workers : Workers, optional
        Workers for months and bands of latitude; this process by default. Results do not depend on it.

    Returns
    -------
    Dataset
        ``probability`` over ``threshold, month, latitude, longitude`` (middles of cells, longitudes eastwards from the western border, and
        beyond 180 deg across the date line), NaN on land, with the cells' borders ``latitude_bnds`` and ``longitude_bnds``, by the CF
        conventions. ``rows`` is the number of rows of weather in each cell; of the climatology ``observations`` is the number of wind
        observations by month in the cell of the climatology about the middle, 0 where a month is interpolated.

    Raises
    ------
    ScenarioError
        No region, or more than 100 000 cells.

    Notes
    -----
    A weather table with places gives every cell the rows inside it, or the rows of the nearest place if no row is inside; without places
    all cells have all rows. All cells share their uniform numbers, so that neighbours differ by weather and Sun alone. Where neither the
    weather nor the hours depend on the clock, all cells of a latitude are alike, and are drawn together.
    """
    import xarray as xr

    settings = MapSettings(scenario, step, samples, weather)
    cells = PreparedMap.of(settings)
    report = progress or (lambda done, total: None)
    latitude, longitude, months = cells.latitude, cells.longitude, cells.months
    thresholds = cells.model.settings.threshold_w_m2_sr
    out = np.empty((len(thresholds), len(months), latitude.size, longitude.size))
    pieces = [(m, first) for m in range(len(months)) for first in range(0, latitude.size, cells.together)]
    left = Counter(m for m, _ in pieces)
    report(0, len(months))
    with _outcomes(cells, settings, pieces, workers) as outcomes:
        for (m, first), values in outcomes:
            out[:, m, first : first + cells.together] = values
            left[m] -= 1
            if not left[m]:
                report(sum(not n for n in left.values()), len(months))
    cell = {"cell_methods": "area: mean month: mean"}
    chance = {"units": "1", "long_name": "chance that mirrored sunlight exceeds the threshold"} | cell
    return xr.Dataset(
        {
            "probability": (("threshold", "month", "latitude", "longitude"), out, chance),
            **cells.support,
            "latitude_bnds": (("latitude", "bnds"), _borders(latitude, cells.step)),
            "longitude_bnds": (("longitude", "bnds"), _borders(longitude, cells.step)),
        },
        coords={
            "threshold": ("threshold", list(thresholds), {"units": "W m-2 sr-1", "long_name": "threshold of the radiance at the sensor"}),
            "month": ("month", list(months), {"units": "1", "long_name": "month of the year"}),
            "latitude": ("latitude", latitude, _axis("latitude", "degrees_north", "Y")),
            "longitude": ("longitude", longitude, _axis("longitude", "degrees_east", "X")),
        },
        attrs=provenance(
            "Likelihood of sea glint by month",
            scenario.model_dump_json(exclude_none=True),
            scenario.seed,
            case=cells.model.settings.case,
            quantity=cells.model.settings.quantity,
            samples=cells.plan.total,
            notes="\n".join(cells.notes),
        ),
    )


def _axis(name: str, units: str, axis: str) -> dict[str, str]:
    return {"units": units, "standard_name": name, "long_name": name, "axis": axis, "bounds": f"{name}_bnds"}


def _borders(middles: FloatArray, step: float) -> FloatArray:
    """Return both borders of cells [deg, (n, 2)]."""
    return np.stack([middles - 0.5 * step, middles + 0.5 * step], axis=1)


class MapSettings(NamedTuple):
    """Settings of a map; see ``likelihood_map``."""

    scenario: Scenario
    step: float | None
    samples: int | None
    weather: WeatherTable | None


@dataclass(frozen=True, eq=False)
class PreparedMap:
    """Prepared map, of which pieces are computed in any order."""

    model: LikelihoodModel  #: Model of the scenario.
    latitude: FloatArray  #: Latitudes of the cells' middles [deg].
    longitude: FloatArray  #: Longitudes of the cells' middles [deg].
    months: tuple[int, ...]  #: Months that count.
    rows: list[NDArray[np.intp]] | None  #: Rows of weather of each cell; None where every cell has all rows.
    across: FloatArray  #: Longitudes that are drawn [deg]: one where all are alike.
    plan: SamplingPlan  #: Draws of a cell.
    whole: bool  #: Whether azimuths are integrated.
    step: float  #: Size of a cell [deg].
    notes: tuple[str, ...]  #: Remarks on the data and the cells.

    @classmethod
    def of(cls, settings: MapSettings) -> PreparedMap:
        """Read the weather and lay out the cells."""
        require_no_moon(settings.scenario, "a map of the likelihood")
        model = LikelihoodModel.of(settings.scenario, settings.weather)
        likelihood = model.settings
        region = EVERYWHERE if model.where is None and model.climatology is not None else model.where
        if not isinstance(region, GeographicRegion):
            missing = "likelihood.latitudes_deg and longitudes_deg are missing: a map needs the region's borders"
            raise ScenarioError(f"{missing}, or weather = 'world' without a place for all seas")
        # A region may cross the date line, and one with equal borders is the whole circle.
        wide = region.width or 360.0
        step, notes = settings.step or STEP, list(model.notes)
        if settings.step is None and (region.north - region.south) * wide > _WIDE * STEP**2:
            step = WIDE_STEP
            notes.append(f"cells of {step:g} deg, as the region is wide; give step for other ones")
        north, east = (np.arange(0.5 * step, size + 1e-9, step) for size in (region.north - region.south, wide))
        if north.size == 0 or east.size == 0 or north.size * east.size > _MOST:
            raise ScenarioError(f"the map has {north.size} x {east.size} cells of {step:g} deg; choose step so that there are 1 to {_MOST}")
        # Longitudes ascend, also across the date line.
        latitude, longitude = region.south + north, region.west + east
        rows = None if model.table is None else _cells(model.table, latitude, longitude)
        whole = likelihood.integrates and likelihood.azimuths != "drawn" and "azimuth_from_sun_deg" not in model.looks
        samples = settings.samples or (INTEGRATED if whole else SAMPLES)
        hourless = model.table is None or np.isnan(model.table["hour_utc"]).all()
        known = isinstance(model.when, Times) and model.when.hours == (0.0, 24.0) and hourless
        alike = bool(model.climatology is None and rows is None and known)
        each = min(samples * longitude.size, max(samples, _SHARED)) if alike else samples
        # Sobol points are even in powers of two.
        plan = SamplingPlan(1, 2 ** round(math.log2(each)))
        return cls(
            model=model,
            latitude=latitude,
            longitude=longitude,
            months=tuple(likelihood.months or range(1, 13)),
            rows=rows,
            across=longitude[:1] if alike else longitude,
            plan=plan,
            whole=whole,
            step=step,
            notes=tuple(notes),
        )

    @property
    def together(self) -> int:
        """Latitudes of a piece."""
        return max(_TOGETHER // (self.plan.total * self.across.size), 1)

    @property
    def support(self) -> dict[str, tuple[tuple[str, ...], NDArray[np.int64], dict[str, str]]]:
        """Variable of the data behind each cell: rows of weather, or observations of the climatology by month."""
        shape = (self.latitude.size, self.longitude.size)
        if self.model.climatology is not None:
            world = self.model.climatology.world
            row, column = world.cell_of(*np.meshgrid(self.latitude, self.longitude, indexing="ij"))
            inside = (row >= 0) & (row < world.latitude.size)
            months = np.array(self.months)[:, None, None] - 1
            counts = np.where(inside, world.observations[months, np.where(inside, row, 0), column], 0.0)
            name = {"units": "1", "long_name": "wind observations of the climatology"}
            return {"observations": (("month", "latitude", "longitude"), np.rint(counts).astype(np.int64), name)}
        assert self.model.table is not None  # one of both is given
        rows = np.full(shape, len(self.model.table)) if self.rows is None else np.array([c.size for c in self.rows]).reshape(shape)
        return {"rows": (("latitude", "longitude"), rows, {"units": "1", "long_name": "rows of weather"})}

    def piece(self, month: int, first: int) -> FloatArray:
        """Return chances of a month, by its place among the months, from a latitude on [(thresholds, latitudes, longitudes drawn)]."""
        of_month, u = self._of_month(month)
        laws = self._laws[first * self.across.size : (first + self.together) * self.across.size]
        # Cells on land have no chance.
        cells = [k for k, law in enumerate(laws) if law is not None]
        out = np.full((len(self.model.settings.threshold_w_m2_sr), len(laws)), np.nan)
        if cells:
            north, east = zip(*(law.draw(u["across"], u["along"]) for law in laws if law is not None), strict=True)
            places = np.concatenate(north), np.concatenate(east)
            tiled = {name: np.tile(values, len(cells)) for name, values in u.items()}
            of_cells = None if self.rows is None else [self.rows[first * self.across.size + k] for k in cells]
            drawn = evaluated(of_month, tiled, _drawn(of_month, tiled, places, of_cells), self.plan, integrated=self.whole)
            weight = drawn.weight.reshape(len(cells), self.plan.total)
            for t, threshold in enumerate(self.model.settings.threshold_w_m2_sr):
                values = draw_values(of_month, drawn, threshold).reshape(weight.shape)
                out[t, cells] = (values * weight).sum(axis=1) / weight.sum(axis=1)
        return out.reshape(out.shape[0], -1, self.across.size)

    @cached_property
    def _laws(self) -> list[PlaceLaw | None]:
        """Law of the place in each cell that is drawn, row by row: even over its area, or over that of its sea; None on land."""
        half, climatology = 0.5 * self.step, self.model.climatology
        laws: list[PlaceLaw | None] = []
        for north in self.latitude.tolist():
            for east in self.across.tolist():
                cell = GeographicRegion(max(north - half, -90.0), min(north + half, 90.0), east - half, east + half)
                laws.append(cell if climatology is None else sea_places(climatology.world, cell))
        return laws

    @cached_property
    def _of_months(self) -> dict[int, tuple[LikelihoodModel, dict[str, FloatArray]]]:
        return {}

    def _of_month(self, month: int) -> tuple[LikelihoodModel, dict[str, FloatArray]]:
        """Return model and uniform numbers of a month; the latest is cached."""
        if month not in self._of_months:
            self._of_months.clear()
            model = self.model.of_months((self.months[month],))
            self._of_months[month] = (model, uniform_numbers(model, self.plan, self.model.scenario.seed))
        return self._of_months[month]


def mapper(settings: MapSettings) -> Callable[[tuple[int, int]], FloatArray]:
    """Return the function of a piece of the map; workers receive settings and return one chance for each cell."""
    cells = PreparedMap.of(settings)
    return lambda piece: cells.piece(*piece)


@contextmanager
def _outcomes(
    cells: PreparedMap, settings: MapSettings, pieces: list[tuple[int, int]], workers: Workers | None
) -> Iterator[Iterator[tuple[tuple[int, int], FloatArray]]]:
    """Iterate over pieces and their chances, in any order."""
    if workers is None:
        yield ((piece, cells.piece(*piece)) for piece in pieces)
        return
    report_air(settings.scenario, band(settings.scenario))
    with workers.map(Job(mapper, settings), pieces) as outcomes:
        yield ((outcome.unit, record_of(outcome)) for outcome in outcomes)


def _drawn(
    model: LikelihoodModel, u: dict[str, FloatArray], places: tuple[FloatArray, FloatArray], cells: list[NDArray[np.intp]] | None
) -> Conditions:
    """Draw weather and times at places, cell by cell; ``cells`` are the rows of weather of each."""
    if cells is None:
        return model.conditions(u, places, by_daylight=True)
    size = places[0].size // len(cells)
    parts = []
    for k, rows in enumerate(cells):
        cell = slice(k * size, (k + 1) * size)
        own = {name: values[cell] for name, values in u.items()}
        parts.append(model.conditions(own, (places[0][cell], places[1][cell]), rows, by_daylight=True))
    weight = None if parts[0].weight is None else np.concatenate([p.weight for p in parts if p.weight is not None])
    return Conditions(np.concatenate([p.rows for p in parts]), np.concatenate([p.time for p in parts]), *places, weight)


def _cells(table: WeatherTable, latitude: FloatArray, longitude: FloatArray) -> list[NDArray[np.intp]] | None:
    """Return the rows of weather of each cell, row by row of the map; None where the table has no places."""
    known = ~(np.isnan(table["latitude_deg"]) | np.isnan(table["longitude_deg"])) & (table["weight"] > 0.0)
    if not known.any():
        return None
    rows = np.flatnonzero(known)
    place = np.stack([table["latitude_deg"][rows], table["longitude_deg"][rows]], axis=1)
    spots, spot = np.unique(place, axis=0, return_inverse=True)
    # Rows grouped by their place, so that each place is compared with a cell once.
    by_spot = np.split(rows[np.argsort(spot, kind="stable")], np.cumsum(np.bincount(spot))[:-1])
    step = float(latitude[1] - latitude[0]) if latitude.size > 1 else 1.0
    out = []
    for lat in latitude.tolist():
        for lon in longitude.tolist():
            north, east = spots[:, 0] - lat, (spots[:, 1] - lon + 180.0) % 360.0 - 180.0
            inside = np.flatnonzero((np.abs(north) <= 0.5 * step) & (np.abs(east) <= 0.5 * step))
            if inside.size == 0:
                # The nearest place, with the longitudes shortened by the latitude.
                inside = np.array([np.argmin(north**2 + (east * np.cos(np.radians(lat))) ** 2)])
            out.append(np.concatenate([by_spot[k] for k in inside]))
    return out
