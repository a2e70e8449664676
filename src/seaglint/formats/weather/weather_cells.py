"""Content of weather files: cells of a CSV file by column, and the rows of a source with counts of what was left out.

Tables that a user makes are refused at their first bad cell; lines of observations are judged by
``seaglint.formats.tables.observed_lines``.

Also parsers of what a user states about them: times, and areas as boxes or polygons (text, CSV or GeoJSON).
"""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.climate.weather_selection import GeographicBox, Polygon, Selection
from seaglint.climate.weather_table import RANGES, TextArray
from seaglint.formats.tables.observed_lines import Line, shown
from seaglint.formats.tables.table_text import TextTable, plain_number, read_cell_lines
from seaglint.store.outputs import read_json

_MISSING: Final = frozenset({"", "nan", "NaN", "NA", "null", "None"})

SEPARATORS: Final = ",;\t"  #: Signs between the cells of a CSV file.


@dataclass(frozen=True)
class TextColumns(TextTable):
    """Text of a CSV file of weather, column by column."""

    def numbers(self, name: str) -> FloatArray:
        """Return the cells of a column as numbers [(rows,)]; empty ones and NaN are missing.

        Raises
        ------
        DataError
            A cell that is no number.
        """
        cells = ["nan" if cell in _MISSING else cell for cell in self.text(name)]
        out = np.empty(len(cells))
        for i, cell in enumerate(cells):
            try:
                out[i] = plain_number(cell)
            except ValueError:
                comma = "; write a decimal point" if "," in cell else "; give a number in the unit of the heading, or leave it empty"
                raise DataError(f"{self.where(i)}, column {name}: '{shown(cell)}' is not a number{comma}") from None
        return out

    def within(
        self, name: str, values: FloatArray, column: str = "", advice: str = "", allowed: tuple[float, float] | None = None
    ) -> FloatArray:
        """Return the values of a weather column; refuse one outside its range, or another one, with row and line."""
        low, high = allowed or RANGES[name]
        good = np.isnan(values) | (np.isfinite(values) & (values >= low) & (values <= high))
        words = f"{low:g} to {high:g}" if np.isfinite(high) else f"{low:g} or more"
        advice = advice or "correct it, or leave it empty"
        self.check(good, column or name, lambda i: f"{name} = {values[i]:g} is outside the range allowed: {words}; {advice}")
        return values


def read_cells(path: str | Path) -> TextColumns:
    """Read a CSV file with a line of headings; empty lines and lines that begin with ``#`` are skipped.

    Cells are separated by commas, semicolons or tabs.

    Raises
    ------
    DataError
        A file that is missing, empty or no text, headings twice, or a row of another length.
    """
    path = Path(path)
    (head, *rest), comments = read_cell_lines(path, "give a CSV file of weather")
    if not rest:
        raise DataError(f"{path}: holds no rows; the first line names the columns, each further one is a row")
    header = tuple(head.cells)
    twice = sorted(name for name, count in Counter(header).items() if name and count > 1)
    if twice:
        raise DataError(f"{path}, line {head.number}: column {shown(', '.join(twice), 200)} is there twice; rename or remove one")
    for number, _, row in rest:
        if len(row) != len(header):
            raise DataError(f"{path}, line {number}: {len(row)} cells under {len(header)} headings; is the file whole?")
    return TextColumns(path, header, [line.cells for line in rest], [line.number for line in rest], comments=comments)


@dataclass(frozen=True)
class WeatherSource:
    """Rows of weather from one file."""

    path: Path  #: The file.
    kind: str  #: Its format in words.
    columns: Mapping[str, FloatArray]  #: Numbers, in the names and units of a weather table [each (rows,)].
    read: int  #: Records that the file holds.
    texts: Mapping[str, TextArray] = field(default_factory=dict)  #: Columns of text [each (rows,)].
    left_out: Mapping[str, int] = field(default_factory=dict)  #: Records that gave no row, by reason.
    set_missing: Mapping[str, int] = field(default_factory=dict)  #: Values that were there and could not be used, by column and reason.
    notes: tuple[str, ...] = ()  #: Sentences on what was assumed.

    @property
    def rows(self) -> int:
        """Return the number of rows."""
        return int(next(iter(self.columns.values())).size)

    def within_ranges(self) -> WeatherSource:
        """Return the rows with observations outside the range of their column set missing, and counted."""
        columns, lost = dict(self.columns), dict(self.set_missing)
        for name, values in self.columns.items():
            low, high = RANGES[name]
            # A value outside its range is set missing; the other values of the row stay.
            bad = ~np.isnan(values) & ~((values >= low) & (values <= high))
            if bad.any():
                columns[name] = np.where(bad, np.nan, values)
                lost[f"{name} outside {low:g} to {high:g}"] = int(bad.sum())
        return replace(self, columns=columns, set_missing=lost)

    def selected(self, selection: Selection) -> WeatherSource:
        """Return the selected rows; the others are counted."""
        good, fallen = selection.rows(self.columns, self.rows)
        if good.all():
            return self
        left_out = dict(self.left_out)
        for reason, count in fallen.items():
            left_out[reason] = left_out.get(reason, 0) + count
        return replace(
            self,
            columns={name: values[good] for name, values in self.columns.items()},
            texts={name: values[good] for name, values in self.texts.items()},
            left_out=left_out,
        )


def numbers_or_missing(cells: Sequence[str], absent: frozenset[str] = _MISSING) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return cells as numbers, NaN where they are missing, and true where a cell is something else than a number."""
    out, bad = np.full(len(cells), np.nan), np.zeros(len(cells), dtype=np.bool_)
    for i, cell in enumerate(cells):
        if cell in absent:
            continue
        with suppress(ValueError):
            out[i] = plain_number(cell)
        bad[i] = not np.isfinite(out[i])
    return np.where(bad, np.nan, out), bad


def twice_noted(lines: Sequence[str]) -> list[str]:
    """Return a note on records that are exact copies of others, if there are any."""
    copies = len(lines) - len(set(lines))
    return [f"{copies} records are exact copies of earlier ones; all are kept"] if copies else []


def header_of(lines: Sequence[Line]) -> list[str]:
    """Return the cells of the first line that is no comment; an empty list where there is none or its quotes do not end."""
    first = next((line for _, line in lines if not line.lstrip().startswith("#")), "")
    return split_cells(first, separator_of(first)) or []


def separator_of(line: str) -> str:
    """Return the sign between the cells of a line of headings."""
    return max(SEPARATORS, key=line.count)


def split_cells(line: str, separator: str) -> list[str] | None:
    """Return the cells of a line without the blanks around them; None where its quotes do not end."""
    try:
        (row,) = csv.reader([line], delimiter=separator, strict=True)
    except (csv.Error, ValueError):
        return None
    return [cell.strip() for cell in row]


def moment_of_iso(text: str, *, naive_is_utc: bool) -> datetime:
    """Return a time in UTC; without a zone where it has none and may not be taken as UTC.

    Raises
    ------
    ValueError
        A text that is no ISO time.
    """
    try:
        moment = datetime.fromisoformat(text)
        moment = moment.replace(tzinfo=UTC) if moment.tzinfo is None and naive_is_utc else moment
        return moment if moment.tzinfo is None else moment.astimezone(UTC)
    except OverflowError as error:  # a zone that leads out of the years 1 to 9999
        raise ValueError(str(error)) from None


def month_and_hour(cells: TextColumns, column: str, *, naive_is_utc: bool) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Return month and hour of UTC of a column of ISO times.

    Parameters
    ----------
    cells : TextColumns
        The file.
    column : str
        Heading of the times: ``2019-07-01T06:00Z``, ``2019-07-01 08:00+02:00``.
    naive_is_utc : bool
        Flag: a time without a zone is UTC; else it is refused.

    Returns
    -------
    (array, array, tuple of str)
        Months 1-12; hours 0 to below 24, NaN where a time is missing or only a date; notes for the user.

    Raises
    ------
    DataError
        A text that is no time, or one without a zone.
    """
    texts = cells.text(column)
    month, hour, seconds = (np.full(len(texts), np.nan) for _ in range(3))
    for i, text in enumerate(texts):
        if not text:
            continue
        try:
            moment = moment_of_iso(text, naive_is_utc=naive_is_utc)
        except ValueError:
            raise DataError(
                f"{cells.where(i)}, column {column}: '{shown(text)}' is no ISO time; write 2019-07-01T06:00Z, or leave it empty"
            ) from None
        if moment.tzinfo is None:
            raise DataError(
                f"{cells.where(i)}, column {column}: '{shown(text)}' has no time zone; write 2019-07-01T06:00Z or +02:00, or set utc=True "
                "if times without one are UTC"
            )
        month[i], seconds[i] = moment.month, moment.timestamp()
        # A date alone has 10 characters; fromisoformat makes it midnight, which nobody stated.
        hour[i] = np.nan if len(text) <= 10 else moment.hour + moment.minute / 60.0 + moment.second / 3600.0
    return month, hour, order_of(seconds)


def order_of(times: Any) -> tuple[str, ...]:
    """Return notes on times [any numbers or datetime64] that go backwards; they are accepted, since a weather table has no order."""
    known = times[~np.isnat(times)] if np.issubdtype(times.dtype, np.datetime64) else times[~np.isnan(times)]
    steps = np.diff(known.astype(np.float64))
    back = int(np.sum(steps < 0))
    if not back:
        return ()
    first = int(np.flatnonzero(steps < 0)[0]) + 2
    return (f"times are not sorted: {back} go backwards, the first in record {first}; all rows are kept, a weather table has no order",)


def parse_box(text: str) -> GeographicBox:
    """Parse a box from a text ``west,south,east,north`` [deg].

    Raises
    ------
    DataError
        Another number of numbers, or borders that are none.
    """
    try:
        numbers = [plain_number(part) for part in text.split(",")]
        if len(numbers) != 4:
            raise ValueError
    except ValueError:
        raise DataError(f"box='{text}' is not four numbers; write west,south,east,north in degrees, e.g. -60,30,-10,60") from None
    try:
        return GeographicBox(*numbers)
    except DomainError as error:
        raise DataError(f"box='{text}': {error}") from None


def read_polygon(text: str) -> Polygon:
    """Read a polygon from a text ``lon,lat lon,lat lon,lat``, or from a CSV or GeoJSON file.

    Raises
    ------
    DataError
        A text or file of another form.
    """
    path = Path(text)
    if path.suffix.lower() in (".json", ".geojson"):
        corners = _geojson(path)
    elif path.suffix.lower() == ".csv":
        cells = read_cells(path)
        pairs = [(lon, lat) for lon, lat in (("longitude_deg", "latitude_deg"), ("lon", "lat")) if {lon, lat} <= set(cells.header)]
        if not pairs:
            raise DataError(
                f"{path}: columns are {', '.join(cells.header)}; a polygon has longitude_deg and latitude_deg, a corner each row"
            )
        corners = list(zip(*(cells.numbers(name).tolist() for name in pairs[0]), strict=True))
    else:
        try:
            corners = [(plain_number(lon), plain_number(lat)) for lon, lat in (pair.split(",") for pair in text.split())]
        except ValueError:
            raise DataError(f"polygon='{text}' is neither 'lon,lat lon,lat lon,lat' in degrees nor a .csv or .geojson file") from None
    if len(corners) > 3 and corners[0] == corners[-1]:
        corners = corners[:-1]  # GeoJSON repeats the first corner at the end of a ring
    try:
        return Polygon(tuple(corners))
    except DomainError as error:
        raise DataError(f"polygon='{text}': {error}") from None


def _geojson(path: Path) -> list[tuple[float, float]]:
    geometry = read_json(path, "give a GeoJSON file of one polygon")
    try:
        if geometry["type"] == "FeatureCollection":
            (geometry,) = geometry["features"]
        if geometry["type"] == "Feature":
            geometry = geometry["geometry"]
        if geometry["type"] != "Polygon":
            raise ValueError
        (ring,) = geometry["coordinates"]
        return [(float(corner[0]), float(corner[1])) for corner in ring]
    except (KeyError, TypeError, ValueError, IndexError):
        raise DataError(f"{path}: is not one GeoJSON polygon without holes; give one, or corners as 'lon,lat lon,lat lon,lat'") from None


def parse_cycle(text: str, name: str, low: int, high: int) -> tuple[int, ...]:
    """Parse whole numbers from a text such as ``6,7,8``, ``6-8`` or, around the end of the year or day, ``12-2``.

    Raises
    ------
    DataError
        A text of another form, or numbers outside ``low`` to ``high``.

    Examples
    --------
    >>> parse_cycle("12-2,6", "months", 1, 12)
    (12, 1, 2, 6)
    """
    out: list[int] = []
    try:
        for part in text.split(","):
            first, dash, last = part.partition("-")
            a = int(first)
            b = int(last) if dash else a
            if not (low <= a <= high and low <= b <= high):
                raise ValueError
            # Forward from a to b, around the end of the cycle if b is below a.
            out += [low + (a - low + step) % (high - low + 1) for step in range((b - a) % (high - low + 1) + 1)]
    except ValueError:
        raise DataError(
            f"{name}='{text}' is not whole numbers {low} to {high}; write e.g. {low + 5},{low + 6} or {low + 5}-{low + 7}"
        ) from None
    return tuple(dict.fromkeys(out))
