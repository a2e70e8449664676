"""Weather tables in the format of seaglint, CSV or Parquet, and the choice of the reader of a weather file of any known format.

Parquet needs PyArrow. The format of a file is recognised by its beginning.
"""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.climate.weather_columns import MappedColumn
from seaglint.climate.weather_selection import Selection
from seaglint.climate.weather_table import NEEDED, RANGES, TEXTS, WeatherTable
from seaglint.climate.world_weather import FEW, NAME, world_weather
from seaglint.formats.tables.observed_lines import lines_of, shown, text_of
from seaglint.formats.tables.table_text import require_parquet
from seaglint.formats.weather import era5_weather as era5
from seaglint.formats.weather import marine_reports
from seaglint.formats.weather.weather_cells import SEPARATORS, TextColumns, WeatherSource, header_of, read_cells
from seaglint.formats.weather.weather_grid import is_grib, is_netcdf
from seaglint.store.outputs import moved_when_whole, refuse_existing, write_text

SUFFIXES: Final = (".csv", ".parquet")  #: Endings of the files that are written.

NORTH_ATLANTIC: Final = "north-atlantic"  #: Name of the table in the package: the climatology's mean over 40-60 N, 10-50 W.

SHIPPED: Final = (NAME, NORTH_ATLANTIC)  #: Names of the weather in the package.

_NOTES: Final = b"seaglint_weather_notes"

_SEEN: Final = 50  #: Number of the first lines by which IMMA is recognised.


@dataclass(frozen=True)
class WeatherFile:
    """Weather table and the notes of its file."""

    table: WeatherTable  #: The rows.
    notes: tuple[str, ...] = ()  #: Source, selections and counts, as the file's comments have them.
    remarks: tuple[str, ...] = ()  #: Remarks of the reader: columns passed over, weights that do not sum to 1.


def read_weather(path: str | Path) -> WeatherFile:
    """Read a weather table, CSV or Parquet, or one of the package by its name (``SHIPPED``).

    Raises
    ------
    DataError
        A file that cannot be read, lacks a column, or holds a value outside its range; with row and line.
    BackendError
        A Parquet file, and PyArrow is not installed.
    """
    if is_world(path):
        world = _read_world(Selection())
        return WeatherFile(WeatherTable(world.columns, world.texts), world.notes)
    path = shipped(str(path)) if str(path) in SHIPPED and not Path(path).exists() else Path(path)
    return _read_parquet(path) if path.suffix.lower() == ".parquet" else _read_csv(path)


def is_world(path: str | Path) -> bool:
    """Return true for the name of the climatology, where no file has it."""
    return str(path) == NAME and not Path(path).exists()


def _notes_of_world(counts: FloatArray) -> list[str]:
    """Return notes on rows of the climatology that rest on numbers of observations."""
    few, none = int(np.sum((counts > 0.0) & (np.rint(counts) < FEW))), int(np.sum(counts == 0.0))
    return [
        "monthly means of ships' observations in cells of 4 x 5 deg, 70 S to 78 N (Esbensen and Kushnir 1981); land, ice and inland seas "
        "such as the Mediterranean have no data",
        f"{few} of {counts.size} months of cells rest on fewer than {FEW} wind observations; {none} without any are interpolated "
        "between months",
        "wind by Weibull laws of shape 2.1 to 3, cloud cover by beta laws in oktas, joined with a correlation of 0.15: shapes, share of "
        "overcast skies and correlation are estimates",
        "no wind direction and no hour",
    ]


def _read_world(selection: Selection, place: tuple[float, float] | None = None) -> WeatherSource:
    """Return rows of the climatology: at a place, or in the selected cells."""
    world, months, other = world_weather(), selection.months or tuple(range(1, 13)), None
    try:
        if place is not None:
            north, east, other = world.sea_at(*place)
            norths, easts, area = np.array([north]), np.array([east]), np.ones(1)
        else:
            norths, easts, area = world.cells()
            inside = selection.places(norths, easts)
            if not inside.any():
                raise DomainError(f"nothing in {' and '.join(selection.words)}; the climatology covers seas from 70 S to 78 N")
            norths, easts, area = norths[inside], easts[inside], area[inside]
    except DomainError as error:
        raise DataError(f"{NAME}: {error}") from None
    row, column = world.cell_of(norths, easts)
    notes = _notes_of_world(world.observations[np.array(months)[:, None] - 1, row, column])
    table = world.table(norths, easts, months, area=area)
    return WeatherSource(Path(NAME), "climatology", table.columns, len(table), table.texts, notes=(*notes, *([other] if other else [])))


def shipped(name: str) -> Path:
    """Return the file of a table in the package."""
    return Path(str(files("seaglint.climate"))) / "data" / f"{name}.csv"


def _read_csv(path: Path) -> WeatherFile:
    cells = read_cells(path)
    _require(path, cells.header, f", line {cells.lines[0] - 1}" if cells.lines else "")
    columns = {name: cells.within(name, cells.numbers(name), advice=_advice(name)) for name in cells.header if name in RANGES}
    _check_weights(cells, columns)
    table = _table(path, columns, {name: cells.text(name) for name in cells.header if name in TEXTS})
    return WeatherFile(table, tuple(cells.comments), _remarks(cells.header, table))


def _check_weights(cells: TextColumns, columns: dict[str, Any]) -> None:
    missing = np.flatnonzero(np.isnan(columns.get("weight", np.zeros(0))))
    if missing.size:
        raise DataError(f"{cells.where(int(missing[0]))}, column weight: is empty; give a number of 0 or more, or remove the column")


def _advice(name: str) -> str:
    if name == "cloud_cover":
        return "cloud cover is a share of 1; convert oktas or percent: 'seaglint weather build' and map='cloud_cover=NAME:okta'"
    if name == "weight":
        return "weights are 0 or more; any positive sum is normalised"
    if name.endswith("_k"):
        return f"temperatures are in kelvin; convert with 'seaglint weather build' and map='{name}=NAME:degC'"
    return ""


def _require(path: Path, header: Sequence[str], where: str) -> None:
    for name in NEEDED:
        if name not in header:
            near = difflib.get_close_matches(name, header[:1000], n=1, cutoff=0.5)
            other = near[0] if near else "NAME"
            raise DataError(
                f"{path}{where}: column {name} missing; found: {shown(', '.join(header), 400)}; needed are {', '.join(NEEDED)}; make "
                f"such a table with 'seaglint weather build' and map='{name}={other}:UNIT'"
            )


def _table(path: Path, columns: dict[str, Any], texts: dict[str, Any]) -> WeatherTable:
    try:
        return WeatherTable(columns, {name: np.asarray(values, dtype=np.str_) for name, values in texts.items()})
    except DomainError as error:
        raise DataError(f"{path}: {error}") from None


def _remarks(header: Sequence[str], table: WeatherTable) -> tuple[str, ...]:
    notes = []
    unknown = [name for name in header if name not in RANGES and name not in TEXTS]
    if unknown:
        notes.append(f"columns passed over, not of a weather table: {shown(', '.join(unknown), 400)}")
    if "weight" not in header:
        notes.append("no column weight: all rows weigh the same")
    elif abs(table.weight_sum - 1.0) > 1e-6:
        notes.append(f"weights sum to {table.weight_sum:.6g} and are divided by it")
    return tuple(notes)


def _read_parquet(path: Path) -> WeatherFile:
    pyarrow = require_parquet()
    try:
        parquet_table = pyarrow.parquet.read_table(path)
    except FileNotFoundError:
        raise DataError(f"{path}: no such file; give a weather table") from None
    except (pyarrow.ArrowException, OSError) as error:
        raise DataError(f"{path}: cannot be read as Parquet ({' '.join(str(error).split())[:200]}); make it again") from None
    header = tuple(parquet_table.column_names)
    _require(path, header, "")
    try:
        columns = {n: parquet_table[n].cast("float64").combine_chunks().to_numpy(zero_copy_only=False) for n in header if n in RANGES}
    except (pyarrow.ArrowException, ValueError, TypeError) as error:
        raise DataError(f"{path}: a column of numbers holds something else ({error}); write numbers or nulls") from None
    texts = {name: ["" if value is None else str(value) for value in parquet_table[name].to_pylist()] for name in header if name in TEXTS}
    table = _table(path, columns, texts)
    notes = (parquet_table.schema.metadata or {}).get(_NOTES, b"").decode().splitlines()
    return WeatherFile(table, tuple(notes), _remarks(header, table))


def check_output(output: str | Path, *, overwrite: bool = False, inputs: Sequence[str | Path] = ()) -> Path:
    """Return the path of a table to write, checked before the work.

    Raises
    ------
    DataError
        Another ending than .csv or .parquet, a file that is there, or one of the inputs.
    BackendError
        Parquet, and PyArrow is not installed.
    """
    output = Path(output)
    if output.suffix.lower() not in SUFFIXES:
        raise DataError(f"{output}: a weather table is a CSV or Parquet file; give a name that ends in .csv or .parquet")
    if output.suffix.lower() == ".parquet":
        require_parquet()
    return refuse_existing(output, overwrite=overwrite, inputs=inputs)


def write_weather(table: WeatherTable, output: str | Path, *, notes: Sequence[str] = (), overwrite: bool = False) -> Path:
    """Write a table, with notes on where it comes from; missing values are empty cells or nulls.

    Raises
    ------
    DataError
        The output exists, or has another ending.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = check_output(output, overwrite=overwrite)
    if output.suffix.lower() == ".parquet":
        pyarrow = require_parquet()
        arrays = {name: pyarrow.array(values, mask=np.isnan(values)) for name, values in table.columns.items()}
        arrays |= {name: pyarrow.array(values.tolist()) for name, values in table.texts.items()}
        table_of_arrow = pyarrow.table(arrays).replace_schema_metadata({_NOTES: "\n".join(notes).encode()})
        with moved_when_whole(output) as partial:
            pyarrow.parquet.write_table(table_of_arrow, partial)
        return output
    cells = [["" if np.isnan(v) else f"{v:.9g}" for v in values.tolist()] for values in table.columns.values()]
    cells += [[_quoted(v) for v in values.tolist()] for values in table.texts.values()]
    lines = [*(f"# {' '.join(note.split())}" for note in notes), ",".join([*table.columns, *table.texts])]
    lines += [",".join(row) for row in zip(*cells, strict=True)]
    write_text("\n".join(lines) + "\n", output)
    return output


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if any(sign in text for sign in ',;\t"#') else text


@dataclass(frozen=True)
class WeatherReading:
    """Properties of weather files that the user states."""

    columns: tuple[MappedColumn, ...] = ()  #: Columns of CSV files; empty for those that seaglint or ICOADS wrote.
    naive_is_utc: bool = False  #: Flag: times of CSV files without a zone are UTC.
    anemometer_m: float | None = None  #: Height of a buoy's anemometer [m].
    place: tuple[float, float] | None = None  #: Latitude and longitude of a source without a place [deg].


def is_grid(path: Path) -> bool:
    """Return true where a file is a grid of weather, NetCDF or GRIB."""
    return not is_world(path) and (is_grib(path) or is_netcdf(path))


def read_source(path: Path, selection: Selection, reading: WeatherReading, beside: tuple[Path, ...] = ()) -> WeatherSource:
    """Read the selected rows of one file.

    Parameters
    ----------
    path : Path
        The file.
    selection : Selection
        Requested places and times; the region is not used here.
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
    if is_world(path):
        return _read_world(selection, reading.place).selected(selection)
    if is_grid(path):
        return era5.read_era5(path, selection, beside=beside)
    if path.suffix.lower() == ".parquet":
        return _own(path).selected(selection)
    text = text_of(path)
    lines = lines_of(text)
    first = lines[0][1] if lines else ""
    if marine_reports.looks_like_ndbc(first):
        return marine_reports.read_ndbc(path, anemometer_m=reading.anemometer_m, place=reading.place).selected(selection)
    if marine_reports.looks_like_imma(lines[:_SEEN]):
        return marine_reports.read_imma(path).selected(selection)
    if "\0" in text[:4096]:
        raise DataError(f"{path}: is no text; give ERA5 NetCDF or GRIB, ICOADS IMMA1 or CSV, NDBC text, or CSV with map='NAME=COLUMN:UNIT'")
    if not any(separator in text for separator in SEPARATORS):
        raise DataError(
            f"{path}: begins with '{shown(first)}', which is no weather that is read: ERA5 NetCDF or GRIB, ICOADS IMMA1 or CSV, NDBC "
            "standard meteorological text, a weather table, or any CSV with map='wind_speed_m_s=COLUMN:UNIT'"
        )
    header = header_of(lines)
    if reading.columns:
        source = marine_reports.read_mapped(read_cells(path), reading.columns, naive_is_utc=reading.naive_is_utc)
    elif {"wind_speed_m_s", "cloud_cover"} <= set(header):
        source = _own(path)
    elif marine_reports.is_icoads_csv(header):
        source = marine_reports.read_icoads_csv(path)
    elif not header:
        raise DataError(f"{path}, line {lines[0][0]}: '{shown(first)}' is no row of cells; repair its quotes, or give another file")
    else:
        raise DataError(
            f"{path}, line {lines[0][0]}: columns are {shown(', '.join(header), 400)}; name the columns to read, "
            "e.g. map='wind_speed_m_s=ws:kn', map='cloud_cover=cloud:percent', map='time=date'"
        )
    return _placed(source, reading).selected(selection)


def _own(path: Path) -> WeatherSource:
    stored = read_weather(path)
    notes = (*stored.notes, *stored.remarks)
    return WeatherSource(path, "weather table", stored.table.columns, len(stored.table), texts=stored.table.texts, notes=notes)


def _placed(source: WeatherSource, reading: WeatherReading) -> WeatherSource:
    """Return the source at the given place, where it has none."""
    if reading.place is None or "latitude_deg" in source.columns:
        return source
    place = {name: np.full(source.rows, value) for name, value in zip(("latitude_deg", "longitude_deg"), reading.place, strict=True)}
    return replace(source, columns={**source.columns, **place})
