"""Climatology of the world's seas by month and cell: means at any place and time of the year, and draws of wind and cloud about them.

The means are ships' observations in cells of 4 x 5 deg (Esbensen and Kushnir 1981): wind speed, cloud cover, sea and air temperature,
specific humidity and pressure. They are interpolated linearly between the middles of cells, and in time so that the mean over each month is
the observed one. Cells without data, which are land or ice, do not count: next to them the sea's cells alone are interpolated. Months
without data of a cell that has others are interpolated between these.

A place is at sea where cells with data have half of the weight of the interpolation between middles. A single place up to ``NEAR_M`` from
the nearest such cell has the weather of that cell: cells are larger than bights and straits.

References
----------
S. K. Esbensen and Y. Kushnir, The heat budget of the global ocean: an atlas based on estimates from surface marine observations, Climatic
Research Institute, report 29, Oregon State University (1981).
P. D. Killworth, Time interpolation of forcing fields in ocean models, J. Phys. Oceanogr. 26 (1996) 136-143.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.air.profile.air_profile import model_profile
from seaglint.base.constants import EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.climate.conditions import WeatherOfDraws
from seaglint.climate.weather_columns import ICE_POINT
from seaglint.climate.weather_laws import class_means, cloud_at, joined, joint_shares, wind_at, wind_shape
from seaglint.climate.weather_table import MONTHS, WeatherTable

NAME: Final = "world"  #: Name of the climatology in the package.

NEAR_M: Final = 400e3  #: Distance of the nearest cell with data up to which it serves a place without [m].

FEW: Final = 10  #: Number of wind observations below which a cell's month is reported.

DAYS: Final = (31.0, 28.25, 31.0, 30.0, 31.0, 30.0, 31.0, 31.0, 30.0, 31.0, 30.0, 31.0)  #: Mean length of the months [days].

CELL: Final = (4.0, 5.0)  #: Height and width of a cell [deg].

_FIRST: Final = (-70.0, -180.0)  #: Middle of the cell in the south-west [deg].
_SHAPE: Final = (38, 72)  #: Numbers of cells from south to north and from west to east.

_COLUMNS: Final = ("wind_speed_m_s", "cloud_cover", "sea_temperature_c", "air_temperature_c", "specific_humidity_g_kg", "pressure_hpa")

_VAPOUR: Final = 0.62198  #: Molar mass of water over that of dry air.
_GAS_OF_VAPOUR: Final = 461.5  #: Gas constant of water vapour [J kg-1 K-1].


class MeanConditions(NamedTuple):
    """Monthly means at places and times [same shape each]."""

    wind_speed_m_s: FloatArray  #: Scalar wind speed [m/s].
    cloud_cover: FloatArray  #: Cloud cover [1].
    sea_temperature_k: FloatArray  #: Temperature of the sea [K].
    air_temperature_k: FloatArray  #: Temperature of the air [K].
    specific_humidity: FloatArray  #: Specific humidity of the air [kg/kg].
    pressure_hpa: FloatArray  #: Pressure at the surface [hPa].

    @property
    def relative_humidity(self) -> FloatArray:
        """Relative humidity over water, at most 1 [1]: ``e = q p / (0.622 + 0.378 q)`` over Magnus' saturation pressure."""
        q = self.specific_humidity
        vapour = q * self.pressure_hpa / (_VAPOUR + (1.0 - _VAPOUR) * q)
        celsius = self.air_temperature_k - ICE_POINT
        # The constants of Alduchov and Eskridge (1996), Eq. 21, as in ``weather_columns.relative_humidity``.
        saturated = 6.1094 * np.exp(17.625 * celsius / (243.04 + celsius))
        return np.asarray(np.minimum(vapour / saturated, 1.0))

    @property
    def model(self) -> NDArray[np.int64]:
        """Place among ``model_atmospheres`` of the model whose humidity at the sea is nearest in ratio."""
        edges = np.array([humidity for _, humidity in model_atmospheres()])
        middles = np.sqrt(edges[1:] * edges[:-1])
        return np.asarray(np.searchsorted(middles, self.specific_humidity), dtype=np.int64)


@cache
def model_atmospheres() -> tuple[tuple[str, float], ...]:
    """Model atmospheres with their specific humidity at the sea [kg/kg], the driest first."""
    out = []
    for name in ("tropical", "midlatitude-summer", "midlatitude-winter", "subarctic-summer", "subarctic-winter", "us-standard-1976"):
        air = model_profile(name)
        kelvin, vapour = float(air.temperature[0]), 1e-3 * float(air.vapour[0])
        dry = (100.0 * float(air.pressure[0]) - vapour * _GAS_OF_VAPOUR * kelvin) / (_VAPOUR * _GAS_OF_VAPOUR * kelvin)
        out.append((name, vapour / (dry + vapour)))
    return tuple(sorted(out, key=lambda entry: entry[1]))


@dataclass(frozen=True, eq=False)
class WorldWeather:
    """Monthly means of the world's seas by cell. Read by ``world_weather``."""

    means: FloatArray  #: Means of ``MeanConditions`` by month and cell, 0 on land [(12, latitudes, longitudes, 6)].
    nodes: FloatArray  #: Values in the middles of months whose lines have these means [(12, latitudes, longitudes, 6)].
    sea: NDArray[np.bool_]  #: Cells with data [(latitudes, longitudes)].
    observations: FloatArray  #: Number of wind observations; 0 where a month was interpolated [(12, latitudes, longitudes)].

    @property
    def latitude(self) -> FloatArray:
        """Latitudes of the middles of the cells [deg]."""
        return np.asarray(_FIRST[0] + CELL[0] * np.arange(_SHAPE[0]))

    @property
    def longitude(self) -> FloatArray:
        """Longitudes of the middles of the cells [deg]."""
        return np.asarray(_FIRST[1] + CELL[1] * np.arange(_SHAPE[1]))

    def cell_of(self, latitude: ArrayLike, longitude: ArrayLike) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Indices of the cells of places [deg]; the row is -1 or beyond the last where a place is beyond the grid.

        The border in the north belongs to the last row.
        """
        y = (np.asarray(latitude, dtype=np.float64) - _FIRST[0]) / CELL[0] + 0.5
        row = np.where(y == _SHAPE[0], _SHAPE[0] - 1, np.floor(y)).astype(np.intp)
        column = np.floor((np.asarray(longitude, dtype=np.float64) - _FIRST[1]) / CELL[1] + 0.5).astype(np.intp) % _SHAPE[1]
        return row, column

    def at_sea(self, latitude: ArrayLike, longitude: ArrayLike) -> NDArray[np.bool_]:
        """True for places [deg] where cells with data have half of the weight."""
        north, east = np.broadcast_arrays(np.asarray(latitude, dtype=np.float64), np.asarray(longitude, dtype=np.float64))
        weight = sum(share for _, _, share in self._corners(north, east))
        beyond = np.abs(north - 0.5 * (self.latitude[0] + self.latitude[-1])) > 0.5 * CELL[0] * _SHAPE[0]
        return np.asarray((weight >= 0.5 - 1e-9) & ~beyond)

    def _corners(self, latitude: FloatArray, longitude: FloatArray) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp], FloatArray]]:
        """Rows and columns of the four cells about places, and their weights; 0 for those without data."""
        y = np.clip((latitude - _FIRST[0]) / CELL[0], 0.0, _SHAPE[0] - 1.0)
        x = ((longitude - _FIRST[1]) / CELL[1]) % _SHAPE[1]
        i, j = np.minimum(y.astype(np.intp), _SHAPE[0] - 2), x.astype(np.intp) % _SHAPE[1]
        g, h = y - i, x - np.floor(x)
        for a in range(2):
            for b in range(2):
                row, column = i + a, (j + b) % _SHAPE[1]
                yield row, column, (g if a else 1.0 - g) * (h if b else 1.0 - h) * self.sea[row, column]

    def nearest_sea(self, latitude: float, longitude: float) -> tuple[float, float, float]:
        """Return the middle of the cell with data that is nearest to a place [deg, deg], and its distance [m]."""
        rows, columns = np.nonzero(self.sea)
        north, east = np.radians(self.latitude[rows]), np.radians(self.longitude[columns] - longitude)
        here = np.radians(latitude)
        # Haversine: exact near the place too.
        square = np.sin(0.5 * (north - here)) ** 2 + np.cos(north) * np.cos(here) * np.sin(0.5 * east) ** 2
        k = int(np.argmin(square))
        distance = 2.0 * EARTH_RADIUS * float(np.arcsin(np.sqrt(min(square[k], 1.0))))
        return float(self.latitude[rows[k]]), float(self.longitude[columns[k]]), distance

    def sea_at(self, latitude: float, longitude: float, name: str = "place") -> tuple[float, float, str | None]:
        """Return the place [deg, deg] whose weather serves a place, and a note where it is another one.

        Raises
        ------
        DomainError
            A place farther than ``NEAR_M`` from the sea; the nearest is named.
        """
        if bool(self.at_sea(latitude, longitude)):
            return latitude, longitude, None
        north, east, distance = self.nearest_sea(latitude, longitude)
        if distance <= NEAR_M:
            note = (
                f"no observations at {name} = [{latitude:g}, {longitude:g}]: the weather is that of the nearest sea of the climatology, at "
                f"[{north:g}, {east:g}], {1e-3 * distance:.0f} km away"
            )
            return north, east, note
        raise DomainError(
            f"{name} = [{latitude:g}, {longitude:g}] is on land, in ice or in a sea without data (as the Mediterranean); the "
            f"nearest sea of the climatology is [{north:g}, {east:g}], {1e-3 * distance:.0f} km away; choose a place at sea, or a weather "
            "table of this one",
            name=name,
            value=(latitude, longitude),
        )

    def at(self, time_of_year: ArrayLike, latitude: ArrayLike, longitude: ArrayLike) -> MeanConditions:
        """Means at times of the year and places, linear between nodes in the middles of months and between cells with data.

        Nodes are those whose lines have the observed means over each month (Killworth 1996); peaks are higher than these means.

        Parameters
        ----------
        time_of_year : array_like
            Months since the beginning of the year [0 to 12]; 0.5 is the middle of January.
        latitude, longitude : array_like
            Places [deg]; broadcast.

        Returns
        -------
        MeanConditions
            NaN where none of the four cells about a place has data.
        """
        time, north, east = np.broadcast_arrays(*(np.asarray(x, dtype=np.float64) for x in (time_of_year, latitude, longitude)))
        month = (time - 0.5) % 12.0
        m, f = month.astype(np.intp) % 12, (month - np.floor(month))[..., None]
        return self._between(
            north, east, lambda row, column: (1.0 - f) * self.nodes[m, row, column] + f * self.nodes[(m + 1) % 12, row, column]
        )

    def of_month(self, month: ArrayLike, latitude: ArrayLike, longitude: ArrayLike) -> MeanConditions:
        """Means of calendar months, 1 to 12, at places [deg], linear between the middles of cells with data; broadcast."""
        number, north, east = np.broadcast_arrays(*(np.asarray(x, dtype=np.float64) for x in (month, latitude, longitude)))
        m = number.astype(np.intp) - 1
        return self._between(north, east, lambda row, column: self.means[m, row, column])

    def _between(
        self, north: FloatArray, east: FloatArray, of_cell: Callable[[NDArray[np.intp], NDArray[np.intp]], FloatArray]
    ) -> MeanConditions:
        """Interpolate values of cells, of rows and columns, to places [deg]."""
        total, weight = np.zeros((*north.shape, len(_COLUMNS))), np.zeros(north.shape)
        for row, column, share in self._corners(north, east):
            weight += share
            total += share[..., None] * of_cell(row, column)
        with np.errstate(invalid="ignore"):
            total /= weight[..., None]
        return MeanConditions(*np.moveaxis(total, -1, 0))

    def draw(
        self, time_of_year: FloatArray, latitude: FloatArray, longitude: FloatArray, wind: FloatArray, cloud: FloatArray
    ) -> WeatherOfDraws:
        """Draw wind and cloud cover about the means at uniform numbers, by the laws of ``weather_laws``; parameters as in ``at``.

        Places must be at sea.
        """
        means = self.at(time_of_year, latitude, longitude)
        speed = wind_at(wind, means.wind_speed_m_s, wind_shape(latitude, means.wind_speed_m_s))
        return WeatherOfDraws(speed, cloud_at(joined(wind, cloud), means.cloud_cover), np.full(speed.shape, np.nan), means.model)

    def table(self, latitude: ArrayLike, longitude: ArrayLike, months: Sequence[int] = (), *, area: ArrayLike = 1.0) -> WeatherTable:
        """Rows of weather at places by month: classes of wind by the nine oktas, with sea, air and humidity of the place and month.

        Parameters
        ----------
        latitude, longitude : array_like
            Places at sea [deg, (n,)].
        months : sequence of int
            Months of the rows; all where empty.
        area : array_like
            Weight of each place [(n,)]; months weigh as their days.
        """
        north, east, size = np.broadcast_arrays(*(np.atleast_1d(np.asarray(x, dtype=np.float64)) for x in (latitude, longitude, area)))
        number = np.array(months or range(1, 13), dtype=np.float64)
        means = self.of_month(number[:, None], north, east)
        winds = class_means(means.wind_speed_m_s, wind_shape(north, means.wind_speed_m_s))
        shares = joint_shares(means.cloud_cover)
        days = np.array(DAYS)[number.astype(np.intp) - 1]
        weight = shares * (days / days.sum())[:, None, None, None] * (size / size.sum())[:, None, None]

        def spread(values: FloatArray) -> FloatArray:
            return np.broadcast_to(values[..., None, None], weight.shape).ravel()

        columns = {
            "weight": weight.ravel(),
            "wind_speed_m_s": np.broadcast_to(winds[..., None], weight.shape).ravel(),
            "cloud_cover": np.broadcast_to(np.arange(9) / 8.0, weight.shape).ravel(),
            "sea_temperature_k": spread(means.sea_temperature_k),
            "air_temperature_k": spread(means.air_temperature_k),
            "relative_humidity": spread(means.relative_humidity),
            "month": spread(np.broadcast_to(number[:, None], means.cloud_cover.shape)),
            "latitude_deg": spread(np.broadcast_to(north, means.cloud_cover.shape)),
            "longitude_deg": spread(np.broadcast_to((east + 180.0) % 360.0 - 180.0, means.cloud_cover.shape)),
        }
        names = np.array([name for name, _ in model_atmospheres()])[means.model]
        return WeatherTable(columns, {"atmosphere": np.broadcast_to(names[..., None, None], weight.shape).ravel()})

    def cells(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Latitudes and longitudes of the middles of the cells with data [deg], and their areas as shares of the largest [1]."""
        rows, columns = np.nonzero(self.sea)
        north = self.latitude[rows]
        return north, self.longitude[columns], np.cos(np.radians(north))


def time_of_year(seconds: FloatArray) -> FloatArray:
    """Months since the beginning of the year [0 to 12] of seconds since 1970-01-01 UTC.

    >>> time_of_year(np.array([15.5 * 86400.0])).tolist()
    [0.5]
    """
    moment = seconds.astype("datetime64[s]")
    month = moment.astype("datetime64[M]")
    begin, end = month.astype("datetime64[s]").astype(np.float64), (month + 1).astype("datetime64[s]").astype(np.float64)
    return np.asarray(month.astype(np.int64) % 12 + (seconds - begin) / (end - begin))


@cache
def world_weather() -> WorldWeather:
    """Climatology of the package."""
    text = (resources.files("seaglint.climate") / "data" / f"{NAME}.csv").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    header = lines[0].split(",")
    table = np.loadtxt(lines[1:], delimiter=",")
    columns = {name: table[:, i] for i, name in enumerate(header)}
    month = columns["month"].astype(np.intp) - 1
    row = np.rint((columns["latitude_deg"] - _FIRST[0]) / CELL[0]).astype(np.intp)
    column = np.rint((columns["longitude_deg"] - _FIRST[1]) / CELL[1]).astype(np.intp)
    means, counts = np.full((12, *_SHAPE, len(_COLUMNS)), np.nan), np.zeros((12, *_SHAPE))
    means[month, row, column] = np.stack([_in_si(name, columns[name]) for name in _COLUMNS], axis=1)
    counts[month, row, column] = 10.0 ** columns["log10_wind_observations"]
    known = ~np.isnan(means[..., 0])
    sea = known.any(0)
    for i, j in zip(*np.nonzero(sea & ~known.all(0)), strict=True):
        have = np.flatnonzero(known[:, i, j])
        for k in range(len(_COLUMNS)):
            means[:, i, j, k] = np.interp(np.arange(12.0), have, means[have, i, j, k], period=12.0)
    means[:, ~sea] = 0.0
    return WorldWeather(means, _nodes(means), sea, counts)


def _nodes(means: FloatArray) -> FloatArray:
    """Return the values in the middles of months whose broken line has the means over each month [like ``means``].

    A month holds half of the line to either neighbour: ``n[m-1]/8 + 3 n[m]/4 + n[m+1]/8 = mean[m]``. Winds stay above a third of their
    mean, and covers within 0 and 1.
    """
    matrix = 0.75 * np.eye(12) + 0.125 * (np.roll(np.eye(12), 1, axis=0) + np.roll(np.eye(12), -1, axis=0))
    nodes = np.asarray(np.linalg.solve(matrix, means.reshape(12, -1)).reshape(means.shape))
    nodes[..., 0] = np.maximum(nodes[..., 0], means[..., 0] / 3.0)
    nodes[..., 1] = np.clip(nodes[..., 1], 0.0, 1.0)
    nodes[..., 4] = np.maximum(nodes[..., 4], means[..., 4] / 3.0)
    return nodes


def _in_si(name: str, values: FloatArray) -> FloatArray:
    if name.endswith("_c"):
        return values + ICE_POINT
    return 1e-3 * values if name == "specific_humidity_g_kg" else values


def few_observations(world: WorldWeather, latitude: float, longitude: float, months: Sequence[int]) -> str | None:
    """Sentence on the months of a place's cell that rest on few observations; None without any."""
    row, column = world.cell_of(latitude, longitude)
    counts = {MONTHS[month - 1]: round(float(world.observations[month - 1, row, column])) for month in months}
    few = ", ".join(f"{month} {number}" for month, number in counts.items() if number < FEW)
    if not few or not world.sea[row, column]:
        return None
    return f"few wind observations in the cell of [{latitude:g}, {longitude:g}]: {few}; below {FEW} a month's means are uncertain"
