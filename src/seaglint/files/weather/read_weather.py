"""Reader of weather files, whose format is recognised by their beginning."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seaglint.base.errors import DataError
from seaglint.climate.column_map import MappedColumn
from seaglint.climate.select import Selection
from seaglint.files.weather import era5_weather as era5
from seaglint.files.weather import imma, mapped
from seaglint.files.weather import ndbc_weather as ndbc
from seaglint.files.weather import weather_file as own
from seaglint.files.weather.columns_read import WeatherSource, text_of
from seaglint.files.weather.weather_cells import read_cells


@dataclass(frozen=True)
class WeatherReading:
    """Properties of weather files that the user states."""

    columns: tuple[MappedColumn, ...] = ()  #: Columns of CSV files; empty for those that seaglint or ICOADS wrote.
    naive_is_utc: bool = False  #: Flag: times of CSV files without a zone are UTC.
    anemometer_m: float | None = None  #: Height of a buoy's anemometer [m].
    place: tuple[float, float] | None = None  #: Latitude and longitude of a source without a place [deg].


def is_grid(path: Path) -> bool:
    """Return true where a file is an ERA5 grid, NetCDF or GRIB."""
    return era5.is_grib(path) or era5.is_netcdf(path)


def read_source(path: Path, selection: Selection, reading: WeatherReading, beside: tuple[Path, ...] = ()) -> WeatherSource:
    """Read the selected rows of one file.

    Parameters
    ----------
    path : Path
        The file.
    selection : Selection
        Places and times wanted; the region is not used here.
    reading : WeatherReading
        Properties that the file does not state.
    beside : tuple of Path
        Grids without winds, for one that has them.

    Raises
    ------
    DataError
        A file of no known format, or one that cannot be read.
    BackendError
        A part that is not installed.
    """
    if is_grid(path):
        return era5.read_era5(path, selection, beside=beside)
    if path.suffix.lower() == ".parquet":
        return _own(path).selected(selection)
    text = text_of(path)
    first = next((line for line in text.splitlines() if line.strip()), "")
    if ndbc.looks_like_ndbc(first):
        return ndbc.read_ndbc(path, anemometer_m=reading.anemometer_m, place=reading.place).selected(selection)
    if imma.looks_like_imma(first):
        return imma.read_imma(path).selected(selection)
    if not any(separator in text for separator in ",;\t"):
        raise DataError(
            f"{path}: begins with '{first[:60]}', which is no weather that is read: ERA5 NetCDF or GRIB, ICOADS IMMA1 or CSV, NDBC "
            "standard meteorological text, a weather table, or any CSV with map='wind_speed_m_s=COLUMN:UNIT'"
        )
    cells = read_cells(path)
    if reading.columns:
        source = mapped.read_mapped(cells, reading.columns, naive_is_utc=reading.naive_is_utc)
    elif {"wind_speed_m_s", "cloud_cover"} <= set(cells.header):
        source = _own(path)
    elif imma.is_icoads_csv(cells.header):
        source = imma.read_icoads_csv(cells)
    else:
        raise DataError(
            f"{path}, line 1: columns are {', '.join(cells.header)}; name the columns that are read, e.g. map='wind_speed_m_s=ws:kn', "
            "map='cloud_cover=cloud:percent', map='time=date'"
        )
    return _placed(source, reading).selected(selection)


def _own(path: Path) -> WeatherSource:
    table_file = own.read_weather(path)
    return WeatherSource(
        path,
        "weather table",
        table_file.table.columns,
        len(table_file.table),
        table_file.table.texts,
        notes=(*table_file.notes, *table_file.remarks),
    )


def _placed(source: WeatherSource, reading: WeatherReading) -> WeatherSource:
    """Return the source at the given place, where it has none."""
    if reading.place is None or "latitude_deg" in source.columns:
        return source
    from dataclasses import replace

    there = {name: np.full(source.rows, value) for name, value in zip(("latitude_deg", "longitude_deg"), reading.place, strict=True)}
    return replace(source, columns={**source.columns, **there})
