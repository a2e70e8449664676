"""Reader of any CSV file by a map of its columns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from seaglint.base.errors import DataError
from seaglint.climate.column_map import HELPERS, MappedColumn
from seaglint.climate.derived import relative_humidity, west_east, wind_from_components
from seaglint.climate.weather_table import RANGES, TEXTS
from seaglint.files.weather.columns_read import WeatherSource
from seaglint.files.weather.times import month_and_hour
from seaglint.files.weather.weather_cells import TextColumns


def read_mapped(cells: TextColumns, columns: Sequence[MappedColumn], *, naive_is_utc: bool = False) -> WeatherSource:
    """Read the columns of a CSV file by a map; headings that are weather columns already need no map.

    Parameters
    ----------
    cells : TextColumns
        The file.
    columns : sequence of MappedColumn
        Map of its columns.
    naive_is_utc : bool
        Flag: times without a zone are UTC; else they are refused.

    Raises
    ------
    DataError
        A column that the file does not have, a cell that is no number or outside its range, a time without a zone, no wind speed.
    """
    requested = list(columns)
    mapped = {column.name for column in requested}
    requested += [MappedColumn(name, name) for name in (*RANGES, *TEXTS) if name in cells.header and name not in mapped]
    for column in requested:
        if column.column not in cells.header:
            raise DataError(
                f"{cells.path}: column '{column.column}' of map='{column.name}={column.column}' is not there; columns are "
                f"{', '.join(cells.header)}"
            )
    texts = {c.name: np.asarray(cells.text(c.column), dtype=np.str_) for c in requested if c.name in TEXTS}
    numbers = {c.name: c.scale * cells.numbers(c.column) + c.offset for c in requested if c.name not in TEXTS and c.name != "time"}
    heading = {c.name: c.column for c in requested}
    notes: list[str] = []
    if "time" in heading:
        month, hour, time_notes = month_and_hour(cells, heading["time"], naive_is_utc=naive_is_utc)
        numbers = {"month": month, "hour_utc": hour} | numbers
        notes += time_notes
    if {"wind_u_m_s", "wind_v_m_s"} <= set(numbers):
        speed, come = wind_from_components(numbers["wind_u_m_s"], numbers["wind_v_m_s"])
        numbers |= {"wind_speed_m_s": speed, "wind_from_deg": come}
    elif "wind_to_deg" in numbers:
        numbers["wind_from_deg"] = numbers["wind_to_deg"] + 180.0
    if "dew_point_k" in numbers and "air_temperature_k" in numbers:
        numbers.setdefault("relative_humidity", relative_humidity(numbers["air_temperature_k"], numbers["dew_point_k"]))
    if "wind_speed_m_s" not in numbers:
        raise DataError(
            f"{cells.path}: no column for wind_speed_m_s; columns are {', '.join(cells.header)}; name it with "
            "map='wind_speed_m_s=COLUMN:UNIT', or its components with wind_u_m_s and wind_v_m_s"
        )
    if "cloud_cover" not in numbers:
        numbers["cloud_cover"] = np.full(len(cells.rows), np.nan)
        notes.append("no column for cloud_cover: it is missing throughout; map one, or fill it with --fill cloud_cover=0.6")
    if "wind_from_deg" in numbers:
        numbers["wind_from_deg"] = numbers["wind_from_deg"] % 360.0
    if "longitude_deg" in numbers:
        numbers["longitude_deg"] = west_east(numbers["longitude_deg"])
    used = {c.column for c in requested}
    idle = [name for name in cells.header if name not in used]
    if idle:
        notes.append(f"columns passed over: {', '.join(idle)}")
    stored = {name: values for name, values in numbers.items() if name not in HELPERS}
    for name, values in stored.items():
        cells.within(name, values, heading.get(name, ""), "correct it or its unit in the map of columns, or leave it empty")
    if np.any(np.isnan(stored.get("weight", np.zeros(1)))):
        row = int(np.flatnonzero(np.isnan(stored["weight"]))[0])
        raise DataError(f"{cells.where(row)}, column {heading['weight']}: a weight is missing; give a number of 0 or more")
    return WeatherSource(cells.path, "CSV", stored, len(cells.rows), texts, notes=tuple(notes))
