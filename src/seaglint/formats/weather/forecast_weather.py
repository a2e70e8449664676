"""Weather of a forecast at the times and places of a track: wind and cloud cover, of each member of an ensemble.

Values are interpolated linearly in time between the steps and bilinearly in latitude and longitude, not beyond their ends. The mean of two
winds that differ in direction is shorter than either (two winds of 10 m/s at right angles have a mean of 7 m/s), and glint depends on the
speed: speeds and unit vectors of the direction are interpolated separately. Masked points of the grid are left out of the weights.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.climate.weather_columns import wind_from_components
from seaglint.climate.weather_table import RANGES
from seaglint.formats.weather.weather_grid import WeatherGrid, open_grid

_NEEDED: Final = ("u10", "v10", "tcc")

_TOUCHING: Final = 1e-6  #: Distance from a line of the grid within which a place is on it [deg]: rounding of numbers of 32 bits.

#: Largest gap of longitudes around a globe, in steps of the grid: a region has one that is larger.
_GLOBAL_GAP: Final = 1.5


@dataclass(frozen=True, eq=False)
class ForecastWeather:
    """Weather of a forecast along a track. Made by ``read_forecast``."""

    wind_speed_m_s: FloatArray  #: Wind speed at 10 m [m/s, (times, members)].
    wind_from_deg: FloatArray  #: Direction from which the wind comes, clockwise from north [deg, (times, members)]; NaN in a calm.
    cloud_cover: FloatArray  #: Share of the sky covered [1, (times, members)].
    notes: tuple[str, ...]  #: Remarks of the reader.

    @property
    def members(self) -> int:
        """Number of members; 1 without an ensemble."""
        return int(self.cloud_cover.shape[1])

    def mean_wind(self) -> tuple[FloatArray, FloatArray]:
        """Return the mean speed of the members [m/s, (times,)] and the direction of their mean wind [deg, (times,)]."""
        towards = np.radians(np.where(np.isnan(self.wind_from_deg), 0.0, self.wind_from_deg) + 180.0)
        east, north = (np.mean(self.wind_speed_m_s * part(towards), axis=1) for part in (np.sin, np.cos))
        return np.asarray(self.wind_speed_m_s.mean(axis=1)), wind_from_components(east, north)[1]


@dataclass(frozen=True, eq=False)
class _Brackets:
    """Neighbours of positions along one dimension of a grid, as indices of the file, and the share of the second one."""

    first: NDArray[np.intp]
    second: NDArray[np.intp]
    share: FloatArray
    inside: NDArray[np.bool_]


def read_forecast(path: Path, time: FloatArray, latitude: FloatArray, longitude: FloatArray) -> ForecastWeather:
    """Read the weather of a forecast at times and places.

    Parameters
    ----------
    path : Path
        NetCDF or GRIB file with wind components and cloud cover over time, latitude and longitude, and perhaps members.
    time : (n,) array
        Times [s since 1970-01-01 UTC].
    latitude, longitude : (n,) array
        Places, north and east positive, longitudes in any convention [deg].

    Returns
    -------
    ForecastWeather
        Weather of each time and member.

    Raises
    ------
    BackendError
        GRIB without cfgrib.
    DataError
        A file that cannot be used, or a time or place outside it; the row of the track is named.
    """
    grid = open_grid(path, join="inner")
    lacking = [name for name in _NEEDED if name not in grid.data]
    if lacking:
        there = ", ".join(grid.names[str(name)] for name in grid.data.data_vars)
        raise DataError(f"{path}: has {there} and no {', '.join(lacking)}; a forecast has wind components at 10 m and total cloud cover")
    steps = _times_inside(grid, time)
    lines = {
        "latitude": _between(grid.data["latitude"].values.astype(np.float64), latitude),
        "longitude": _around(grid.data["longitude"].values.astype(np.float64), longitude),
    }
    outside = np.flatnonzero(~(lines["latitude"].inside & lines["longitude"].inside))
    if outside.size:
        row = int(outside[0])
        raise DataError(
            f"{path}: row {row + 1} of the track, {_place(latitude[row], longitude[row])}, is outside the forecast, "
            f"{_extent(grid)}; bring a forecast of that sea or cut the track"
        )
    members = grid.data.sizes.get("member", 1)
    # Speed, unit vector of the wind to the east and north, and cover.
    total = np.zeros((4, time.size, members))
    for step in np.unique(np.concatenate([steps.first[steps.share < 1.0], steps.second[steps.share > 0.0]])).tolist():
        weight = np.where(steps.first == step, 1.0 - steps.share, 0.0) + np.where(steps.second == step, steps.share, 0.0)
        rows = np.flatnonzero(weight > 0.0)
        total[:, rows] += weight[rows, None] * _at_step(grid, step, *(_rows(lines[name], rows) for name in ("latitude", "longitude")))
    bad = np.flatnonzero(~np.isfinite(total).all(axis=(0, 2)))
    if bad.size:
        row = int(bad[0])
        raise DataError(
            f"{path}: has no wind or cloud cover around row {row + 1} of the track, {_place(latitude[row], longitude[row])}, "
            f"{_moment(time[row])}: masked or missing there; bring another forecast or cut the track"
        )
    speed, east, north, cover = total
    if speed.max() > RANGES["wind_speed_m_s"][1]:
        raise DataError(f"{path}: a wind of {speed.max():g} m/s is outside 0 to 100 m/s; correct its unit or its missing value")
    return ForecastWeather(speed, wind_from_components(east, north)[1], np.clip(cover, 0.0, 1.0), grid.notes)


def _times_inside(grid: WeatherGrid, time: FloatArray) -> _Brackets:
    stamps = grid.data["time"].values.astype("datetime64[ns]").astype(np.int64) / 1e9
    out = _between(stamps, time)
    if not out.inside.all():
        row = int(np.flatnonzero(~out.inside)[0])
        of_row = f"row {row + 1} of the track, {_moment(time[row])}"
        if time[row] < stamps.min():
            raise DataError(
                f"{grid.path}: the forecast begins {_moment(stamps.min())}, after {of_row}; bring an earlier forecast or cut the track"
            )
        raise DataError(f"{grid.path}: the forecast ends {_moment(stamps.max())}, before {of_row}; bring a later forecast or cut the track")
    return out


def _between(lines: FloatArray, positions: FloatArray) -> _Brackets:
    """Return the neighbours of positions among lines in any order."""
    ordered, index = np.unique(lines, return_index=True)
    inside = (positions >= ordered[0] - _TOUCHING) & (positions <= ordered[-1] + _TOUCHING)
    lower = np.clip(np.searchsorted(ordered, positions, side="right") - 1, 0, max(ordered.size - 2, 0))
    upper = np.minimum(lower + 1, ordered.size - 1)
    gap = np.maximum(ordered[upper] - ordered[lower], 1e-300)
    return _Brackets(index[lower], index[upper], np.clip((positions - ordered[lower]) / gap, 0.0, 1.0), inside)


def _around(lines: FloatArray, positions: FloatArray) -> _Brackets:
    """Return the neighbours of longitudes on the circle; a grid around the globe has neighbours across its seam."""
    ordered, index, gaps = _eastwards(lines)
    east = (ordered - ordered[0]) % 360.0
    if ordered.size > 1 and gaps.max() <= _GLOBAL_GAP * float(np.median(gaps)):
        east, index = np.append(east, 360.0), np.append(index, index[0])
    turned = (positions - ordered[0]) % 360.0
    # A place on the first line may be 359.9999999 deg east of it by rounding.
    turned = np.where(turned > 360.0 - _TOUCHING, 0.0, turned)
    inside = _between(east, turned)
    return _Brackets(index[inside.first], index[inside.second], inside.share, inside.inside)


def _eastwards(lines: FloatArray) -> tuple[FloatArray, NDArray[np.intp], FloatArray]:
    """Return longitudes from the western end of a grid in [0, 360), their indices, and the gaps of the circle, the last one ended by it."""
    # Rounded, so that 360 deg and -0.0000001 deg are the same line as 0 deg.
    ordered, index = np.unique(np.round(lines, 6) % 360.0, return_index=True)
    gaps = np.diff(np.append(ordered, ordered[0] + 360.0))
    # The grid begins east of its largest gap, which is one step wide where it goes around.
    start = -int(np.argmax(gaps)) - 1
    return np.roll(ordered, start), np.roll(index, start), np.roll(gaps, start)


def _rows(lines: _Brackets, rows: NDArray[np.intp]) -> _Brackets:
    return _Brackets(lines.first[rows], lines.second[rows], lines.share[rows], lines.inside[rows])


def _at_step(grid: WeatherGrid, step: int, latitude: _Brackets, longitude: _Brackets) -> FloatArray:
    """Return speed, unit vector and cover at places of one step [(4, places, members)]; NaN where all neighbours are masked."""
    iy, at_y = np.unique(np.stack([latitude.first, latitude.second]), return_inverse=True)
    ix, at_x = np.unique(np.stack([longitude.first, longitude.second]), return_inverse=True)
    at_y, at_x = at_y.reshape(2, -1), at_x.reshape(2, -1)
    part = grid.loaded(time=[step], latitude=iy, longitude=ix)
    u, v, cover = (np.asarray(part[name].values).reshape(-1, iy.size, ix.size) for name in _NEEDED)
    speed = np.hypot(u, v)
    moving = np.maximum(speed, 1e-300)
    fields = np.stack([speed, u / moving, v / moving, cover])
    known = np.isfinite(fields).all(axis=0)
    fields = np.where(known, fields, 0.0)
    total, weights = np.zeros((4, fields.shape[1], latitude.share.size)), np.zeros((fields.shape[1], latitude.share.size))
    for y in (0, 1):
        for x in (0, 1):
            share = np.abs(1 - y - latitude.share) * np.abs(1 - x - longitude.share)
            weights += share * known[:, at_y[y], at_x[x]]
            total += share * fields[:, :, at_y[y], at_x[x]]
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.swapaxes(np.where(weights > 0.0, total / weights, np.nan), 1, 2))


def _moment(seconds: float) -> str:
    return f"{np.datetime64(round(seconds), 's').astype('datetime64[m]')}Z"


def _place(latitude: float, longitude: float) -> str:
    return f"latitude {latitude:g}, longitude {longitude:g}"


def _extent(grid: WeatherGrid) -> str:
    latitude, longitude = (grid.data[name].values.astype(float) for name in ("latitude", "longitude"))
    ordered, *_ = _eastwards(longitude)
    return f"latitudes {latitude.min():g} to {latitude.max():g}, longitudes {_signed(ordered[0])} to {_signed(ordered[-1])}"


def _signed(longitude: float) -> str:
    return f"{(longitude + 180.0) % 360.0 - 180.0:g}"
