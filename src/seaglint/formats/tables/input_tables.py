"""CSV files that a user gives as input: tables of cases, written again with results, and keyframes of a moving sensor or object.

Cases are UTF-8 text (with or without its mark) with comma, semicolon or tab between the cells, quoted text and either line ending; the
output has the separator and line ending of the input. Columns that are not requested are copied as text, so that no digit is rounded.
"""

from __future__ import annotations

import csv
import difflib
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.formats.tables.table_text import TextTable, csv_text, plain_number, read_cell_lines
from seaglint.store.outputs import read_text, refuse_existing, write_text

#: Columns that a file of a sensor's keyframes may have; the time is required, and one more.
COLUMNS: Final = ("time_s", "east_m", "north_m", "height_m", "azimuth_deg", "elevation_deg", "roll_deg")

#: Columns that a file of an object's keyframes may have.
OBJECT_COLUMNS: Final = (*COLUMNS[:4], "latitude_deg", "longitude_deg", "heading_deg", "pitch_deg", "roll_deg")

_SEPARATORS: Final = (",", ";", "\t")


@dataclass(frozen=True)
class Column:
    """Column of numbers that a file of cases must have."""

    name: str  #: Its heading, unit included.
    low: float  #: Lowest value allowed.
    high: float  #: Highest value allowed.
    above: bool = False  #: Flag: ``low`` itself is refused.
    what: str = ""  #: Owner of the range, for messages: "of the table".

    @property
    def covered(self) -> str:
        """Return the range in words."""
        if self.high == np.inf:
            text = f"{'above' if self.above else 'at least'} {self.low:g}"
        else:
            text = f"{'above ' if self.above else ''}{self.low:g} to {self.high:g}"
        return f"{text} {self.what}".rstrip()


@dataclass(frozen=True)
class Cases(TextTable):
    """Rows of a CSV file, as text; each row is a case."""

    separator: str = ","  #: Separator of the file, used again for the output.
    line_end: str = "\n"  #: Line end of the file, used again for the output.

    def require(self, names: Sequence[str]) -> None:
        """Refuse a file that lacks any of these columns."""
        missing = [name for name in names if name not in self.header]
        if missing:
            raise DataError(
                f"{self.path}, line 1: column{'s' if len(missing) > 1 else ''} {', '.join(missing)} missing; "
                f"needed: {', '.join(names)}; found: {', '.join(self.header)}"
            )

    def numbers(self, name: str) -> FloatArray:
        """Return the cells of a column as finite numbers [(cases,)]."""
        cells = self.text(name)
        written = "".join(cells)
        # NumPy converts the whole column at once; cell by cell only if one of them is no plain number, to find the first that is wrong.
        try:
            if not written.isascii() or "_" in written:
                raise ValueError
            values = np.array(cells, dtype=np.float64)
        except ValueError:
            values = np.array([_number(cell) for cell in cells])
        self.check(np.isfinite(values), name, lambda i: _not_a_number(cells[i]))
        return values

    def within(self, column: Column) -> FloatArray:
        """Return the cells of a column as numbers inside its range [(cases,)]."""
        values = self.numbers(column.name)
        low = values > column.low if column.above else values >= column.low
        self.check(low & (values <= column.high), column.name, lambda i: f"{values[i]:g} is outside the range allowed: {column.covered}")
        return values

    def choice(self, name: str, allowed: Sequence[str]) -> list[str]:
        """Return the cells of a column, each of which is one of ``allowed``."""
        cells = self.text(name)
        known = set(allowed)
        self.check(np.array([cell in known for cell in cells]), name, lambda i: f"'{cells[i]}' is not one of {', '.join(allowed)}")
        return cells


def _number(cell: str) -> float:
    try:
        return plain_number(cell)
    except ValueError:
        return float("nan")


def _not_a_number(cell: str) -> str:
    if not cell:
        return "is empty; give a number"
    advice = "write a decimal point, not a comma" if "," in cell else "give a finite number, the unit stands in the heading alone"
    return f"'{cell}' is not a number; {advice}"


def read_cases(path: str | Path) -> Cases:
    """Read a file of cases.

    Raises
    ------
    DataError
        A file that is missing, empty, not UTF-8 text, without cases, with headings twice, or with rows of another length.
    """
    path = Path(path)
    text = read_text(path, "give a CSV file saved as 'CSV UTF-8'")
    if not text.strip():
        raise DataError(f"{path}: line 1: the file is empty; the first line must name the columns")
    if "\0" in text:
        raise DataError(f"{path}: is not text; save it as 'CSV UTF-8'")
    # The line of headings shows separator and line end of the file.
    first, _, _ = text.lstrip().partition("\n")
    separator = max(_SEPARATORS, key=first.count)
    header, rows, lines = _rows(path, text, separator)
    if not rows:
        raise DataError(f"{path}: holds no cases: nothing follows the headings in line 1")
    return Cases(path, header, rows, lines, separator, "\r\n" if first.endswith("\r") else "\n")


def cases_of_columns(columns: Mapping[str, Sequence[Any]]) -> Cases:
    """Return the cases of columns in memory: numbers or text by name, one value a case.

    Raises
    ------
    DataError
        No columns, or columns of different lengths.

    Examples
    --------
    >>> cases_of_columns({"wind_speed_m_s": [2.0, 5.0]}).numbers("wind_speed_m_s").tolist()
    [2.0, 5.0]
    """
    if not isinstance(columns, Mapping):
        raise DataError("cases: give a CSV file or columns by name, such as {'wind_speed_m_s': [2, 5]}")
    arrays = {str(name): np.atleast_1d(np.asarray(values)) for name, values in columns.items()}
    sizes = {name: values.size for name, values in arrays.items() if values.ndim == 1}
    if not arrays or len(sizes) < len(arrays) or len(set(sizes.values())) > 1:
        given = ", ".join(f"{name} {size}" for name, size in sizes.items()) or "none"
        raise DataError(f"cases: columns have different numbers of values ({given}); give lists of one length by name")
    rows = [list(row) for row in zip(*([str(value) for value in values.tolist()] for values in arrays.values()), strict=True)]
    return Cases(Path("cases"), list(arrays), rows, list(range(1, len(rows) + 1)))


def _rows(path: Path, text: str, separator: str) -> tuple[list[str], list[list[str]], list[int]]:
    # The whole text goes to one reader, not its lines one by one: a quoted cell may hold line ends.
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)
    header: list[str] = []
    rows, lines = [], []
    try:
        for row in reader:
            if not row or (len(row) == 1 and not row[0].strip()):
                continue  # spreadsheets leave blank lines at the end
            if not header:
                header = [name.strip() for name in row]
                continue
            if len(row) != len(header):
                raise DataError(
                    f"{path}, line {reader.line_num}: {len(row)} cells under {len(header)} headings; a text with '{separator}' needs quotes"
                )
            rows.append(row)
            lines.append(reader.line_num)
    except csv.Error as error:
        raise DataError(f"{path}, line {reader.line_num}: {error}; repair the quotes of that line") from error
    twice = sorted({name for name in header if name and header.count(name) > 1})
    if twice:
        raise DataError(f"{path}, line 1: column {', '.join(twice)} is there twice; rename or remove one")
    return header, rows, lines


def write_cases(
    cases: Cases, results: Mapping[str, Sequence[object] | FloatArray], output: str | Path, *, overwrite: bool = False
) -> list[str]:
    """Write the cases with results, completely or not at all.

    Parameters
    ----------
    cases : Cases
        Cases that were read.
    results : mapping
        Columns by name; numbers get six digits. A column of that name in ``cases`` is replaced in its place, others follow.
    output : path
        File to write.
    overwrite : bool
        Replace a file that is there.

    Returns
    -------
    list of str
        Columns of the input that were replaced.

    Raises
    ------
    DataError
        The output exists.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = refuse_existing(output, overwrite=overwrite)
    replaced = [name for name in results if name in cases.header]
    header = [*cases.header, *(name for name in results if name not in cases.header)]
    columns = {name: _cells(values) for name, values in results.items()}
    parts = [columns.get(name) or [row[at] for row in cases.rows] for at, name in enumerate(header)]
    write_text(csv_text([header, *zip(*parts, strict=True)], cases.separator, cases.line_end), output)
    return replaced


def _cells(values: Sequence[object] | FloatArray) -> list[str]:
    if isinstance(values, np.ndarray):
        return [f"{value:.6g}" for value in values.tolist()]
    return [str(value) for value in values]


def read_track(path: str | Path, allowed: Sequence[str] = COLUMNS) -> tuple[dict[str, FloatArray], list[str]]:
    """Read keyframes of the columns ``allowed``; lines that begin with ``#`` are comments.

    Returns
    -------
    (dict, list)
        Values by column, in the units of their names, and what to call each keyframe (``"line 7"``).

    Raises
    ------
    DataError
        Naming the file and the line that cannot be used: another column, a cell that is no finite number.
    """
    path = Path(path)
    required = f"needed are {allowed[0]} and one or more of {', '.join(allowed[1:])}"
    (head, *rest), _ = read_cell_lines(path, required, ",")
    header = head.cells
    _check_header(path, head.number, header, allowed, required)
    table = np.empty((len(rest), len(header)))
    for i, (number, line, row) in enumerate(rest):
        if len(row) != len(header):
            raise DataError(f"{path}: line {number}: '{line.strip()}' has {len(row)} cells, the header {len(header)}; is the file whole?")
        for j, cell in enumerate(row):
            try:
                table[i, j] = plain_number(cell)
            except ValueError:
                raise DataError(f"{path}: line {number}: {header[j]} = '{cell}' is not a number; correct it") from None
            if not np.isfinite(table[i, j]):
                raise DataError(f"{path}: line {number}: {header[j]} = {cell} is not finite; correct or remove the line")
    return dict(zip(header, table.T, strict=True)), [f"line {line.number}" for line in rest]


def _check_header(path: Path, number: int, header: list[str], allowed: Sequence[str], required: str) -> None:
    for name in header:
        if name not in allowed:
            near = difflib.get_close_matches(name, allowed, n=1, cutoff=0.5)
            meant = f"did you mean {near[0]}?" if near else required
            raise DataError(f"{path}: line {number}: '{name}' is an unknown column; {meant}")
    if len(set(header)) != len(header):
        raise DataError(f"{path}: line {number}: a column is named twice; {required}")
    if "time_s" not in header or len(header) < 2:
        raise DataError(f"{path}: line {number}: columns are {', '.join(header)}; {required}")
