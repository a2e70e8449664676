"""Maps of the likelihood of glint over a region, month by month."""

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
from seaglint.climate.conditions import Conditions, GeographicRegion, Times
from seaglint.climate.draws import SamplingPlan
from seaglint.climate.weather_table import WeatherTable
from seaglint.cluster import Job, Workers
from seaglint.cluster.job import record_of
from seaglint.scenario.model import Scenario
from seaglint.store.provenance import provenance
from seaglint.studies.build.profile_air import report_air
from seaglint.studies.build.scenario_physics import band
from seaglint.studies.likelihood.draw_model import LikelihoodModel
from seaglint.studies.likelihood.glint_chance import draw_values, evaluated, uniform_numbers
from seaglint.studies.study_requests import LikelihoodRequest

if TYPE_CHECKING:
    import xarray as xr


SAMPLES: Final = 512  #: Draws for each cell and month: chances within 0.02.

INTEGRATED: Final = 64  #: Draws for each cell and month where each draw integrates over azimuths: standard error a tenth of the chance.

_SHARED: Final = 2048  #: Most draws for all cells of a latitude where longitude does not matter.

_MOST: Final = 100_000
_TOGETHER: Final = 1_000_000  #: Draws of a piece at most: some 300 MB.


@documented(LikelihoodRequest)
def likelihood_map(
    scenario: Scenario,
    *,
    step: float = 1.0,
    samples: int | None = None,
    weather: WeatherTable | None = None,
    progress: Progress | None = None,
    workers: Workers | None = None,
) -> xr.Dataset:
    """Return the chance that glint exceeds each threshold, over cells of the region and months.

    Parameters
    ----------
    scenario : Scenario
        Scenario with a region in ``[likelihood]``.
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
        ``probability`` over ``threshold, month, latitude, longitude`` (middles of cells); ``rows``, the rows of weather in each cell.

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
    out = np.empty((len(cells.model.settings.threshold_w_m2_sr), len(months), latitude.size, longitude.size))
    pieces = [(m, first) for m in range(len(months)) for first in range(0, latitude.size, cells.together)]
    left = Counter(m for m, _ in pieces)
    report(0, len(months))
    with _outcomes(cells, settings, pieces, workers) as outcomes:
        for (m, first), values in outcomes:
            out[:, m, first : first + cells.together] = values
            left[m] -= 1
            if not left[m]:
                report(sum(not n for n in left.values()), len(months))
    return xr.Dataset(
        {
            "probability": (("threshold", "month", "latitude", "longitude"), out, {"units": "1"}),
            "rows": (("latitude", "longitude"), cells.row_counts, {"units": "1"}),
        },
        coords={
            "threshold": ("threshold", list(cells.model.settings.threshold_w_m2_sr), {"units": "W m-2 sr-1"}),
            "month": list(months),
            "latitude": ("latitude", latitude, {"units": "degrees_north"}),
            "longitude": ("longitude", longitude, {"units": "degrees_east"}),
        },
        attrs=provenance(
            "Likelihood of sea glint by month",
            scenario.model_dump_json(exclude_none=True),
            scenario.seed,
            case=cells.model.settings.case,
            quantity=cells.model.settings.quantity,
            samples=cells.plan.total,
            notes="; ".join(cells.model.notes),
        ),
    )


class MapSettings(NamedTuple):
    """Settings of a map; see ``likelihood_map``."""

    scenario: Scenario
    step: float
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

    @classmethod
    def of(cls, settings: MapSettings) -> PreparedMap:
        """Read the weather and lay out the cells."""
        step = settings.step
        model = LikelihoodModel.of(settings.scenario, settings.weather)
        likelihood = model.settings
        if not isinstance(model.where, GeographicRegion):
            raise ScenarioError("likelihood.latitudes_deg and longitudes_deg are missing: a map needs the region's borders")
        region = model.where
        # A region may cross the date line.
        wide = region.east - region.west if region.east > region.west else region.east - region.west + 360.0
        north, east = (np.arange(0.5 * step, size + 1e-9, step) for size in (region.north - region.south, wide))
        if north.size == 0 or east.size == 0 or north.size * east.size > _MOST:
            raise ScenarioError(f"the map has {north.size} x {east.size} cells of {step:g} deg; choose step so that there are 1 to {_MOST}")
        latitude, longitude = region.south + north, (region.west + east + 180.0) % 360.0 - 180.0
        rows = None if model.table is None else _cells(model.table, latitude, longitude)
        whole = likelihood.integrates and likelihood.azimuths != "drawn" and "azimuth_from_sun_deg" not in model.looks
        samples = settings.samples or (INTEGRATED if whole else SAMPLES)
        hourless = model.table is None or np.isnan(model.table["hour_utc"]).all()
        known = isinstance(model.when, Times) and model.when.hours == (0.0, 24.0) and hourless
        alike = bool(model.world is None and rows is None and known)
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
        )

    @property
    def together(self) -> int:
        """Latitudes of a piece."""
        return max(_TOGETHER // (self.plan.total * self.across.size), 1)

    @property
    def row_counts(self) -> NDArray[np.int64]:
        """Number of rows of weather of each cell [(latitudes, longitudes)]."""
        shape = (self.latitude.size, self.longitude.size)
        if self.model.table is None:
            return np.zeros(shape, dtype=np.int64)
        return np.full(shape, len(self.model.table)) if self.rows is None else np.array([c.size for c in self.rows]).reshape(shape)

    def piece(self, month: int, first: int) -> FloatArray:
        """Return chances of a month, by its place among the months, from a latitude on [(thresholds, latitudes, longitudes drawn)]."""
        of_month, u = self._of_month(month)
        band = slice(first, min(first + self.together, self.latitude.size))
        count = (band.stop - first) * self.across.size
        places = _inside(self.latitude[band], self.across, self.step, u)
        tiled = {name: np.tile(values, count) for name, values in u.items()}
        of_cells = None if self.rows is None else self.rows[first * self.across.size :][:count]
        drawn = evaluated(of_month, tiled, _drawn(of_month, tiled, places, of_cells), self.plan, integrated=self.whole)
        weight = drawn.weight.reshape(-1, self.across.size, self.plan.total)
        out = np.empty((len(self.model.settings.threshold_w_m2_sr), *weight.shape[:2]))
        for t, threshold in enumerate(self.model.settings.threshold_w_m2_sr):
            values = draw_values(of_month, drawn, threshold).reshape(weight.shape)
            total = weight.sum(axis=2)
            # Cells without a draw at sea have no chance.
            out[t] = np.divide((values * weight).sum(axis=2), total, out=np.full(total.shape, np.nan), where=total > 0.0)
        return out

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


def _inside(latitude: FloatArray, longitude: FloatArray, step: float, u: dict[str, FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Return the places of the draws in each cell, cell by cell [deg]."""
    # Uniform within each cell; the date line wraps.
    north = np.clip(latitude[:, None, None] + step * (u["across"] - 0.5), -90.0, 90.0)
    east = (longitude[:, None] + step * (u["along"] - 0.5) + 180.0) % 360.0 - 180.0
    shape = (latitude.size, longitude.size, u["across"].size)
    return np.broadcast_to(north, shape).ravel(), np.broadcast_to(east, shape).ravel()


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
