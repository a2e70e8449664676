"""Tables as text files: readers of CSV whose errors name file, line and column, and writers of CSV and Parquet.

Every output is written completely or not at all.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.optional import optional
from seaglint.store.outputs import moved_when_whole, read_text, refuse_existing, write_text


def plain_number(text: str) -> float:
    """Return the number of a cell as programs write it; digits of other scripts and underscores, which Python accepts, are errors.

    Raises
    ------
    ValueError
        Anything else.

    Examples
    --------
    >>> plain_number(" 1.5e-3 ")
    0.0015
    """
    if not text.isascii() or "_" in text:
        raise ValueError(f"'{text}' is not a number in digits 0-9")
    return float(text)


class CellLine(NamedTuple):
    """Line of a CSV file: its number from 1, its text, and its cells without the blanks around them."""

    number: int
    text: str
    cells: list[str]


def cells_of(path: Path, number: int, line: str, separator: str = ",", remedy: str = "repair its quotes") -> list[str]:
    """Return the cells of a line.

    Raises
    ------
    DataError
        Quotes that do not end in their line, or cells that are no text.
    """
    try:
        (row,) = csv.reader([line], delimiter=separator, strict=True)
    except (csv.Error, ValueError) as error:
        raise DataError(f"{path}: line {number}: is no row of cells ({error}); {remedy}") from None
    return row


def read_cell_lines(path: Path, hint: str, separators: str = ",;\t") -> tuple[list[CellLine], list[str]]:
    """Read the lines of a CSV file, one or more, and its comments; empty lines are skipped, lines that begin with ``#`` are comments.

    The separator of the cells is the one of ``separators`` that the first line has most often.

    Raises
    ------
    DataError
        With the file and, if the error is in a line, its number; the message of an empty or missing file ends with ``hint``.
    """
    lines = [(number, line) for number, line in enumerate(read_text(path, hint).splitlines(), 1) if line.strip()]
    comments = [line.lstrip()[1:].strip() for _, line in lines if line.lstrip().startswith("#")]
    lines = [(number, line) for number, line in lines if not line.lstrip().startswith("#")]
    if not lines:
        raise DataError(f"{path}: is empty; {hint}")
    separator = max(separators, key=lines[0][1].count)
    return [CellLine(n, line, [cell.strip() for cell in cells_of(path, n, line, separator)]) for n, line in lines], comments


@dataclass(frozen=True)
class TextTable:
    """Cells of a CSV file as text, under a line of column names."""

    path: Path  #: The file, for messages.
    header: Sequence[str]  #: Column names in their order, without blanks around them.
    rows: list[list[str]]  #: One list of cells per row, in order.
    lines: list[int]  #: Line of the file on which each row ends, counted from 1.
    header_line: int = field(default=1, kw_only=True)  #: Line of the column names, counted from 1.
    comments: list[str] = field(default_factory=list, kw_only=True)  #: Texts behind ``#``.

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.rows)

    def text(self, name: str) -> list[str]:
        """Return the cells of a column without surrounding blanks."""
        at = self.header.index(name)
        return [row[at].strip() for row in self.rows]

    def where(self, row: int) -> str:
        """Return file, row and line of a row, for messages."""
        return f"{self.path}, row {row + 1} (line {self.lines[row]})"

    def check(self, good: NDArray[np.bool_], name: str, message: Callable[[int], str]) -> None:
        """Refuse the first bad row, with row, line and column, and state the number of further bad rows."""
        bad = np.flatnonzero(~good)
        if bad.size == 0:
            return
        first = int(bad[0])
        more = f" ({bad.size - 1} more row{'s' if bad.size > 2 else ''} like it)" if bad.size > 1 else ""
        raise DataError(f"{self.where(first)}, column {name}: {message(first)}{more}")

    def error(self, line: int, text: str) -> DataError:
        """Return an error at a line of this file."""
        return DataError(f"{self.path}: line {line}: {text}")

    def require_columns(self, *names: str) -> None:
        """Refuse a file that lacks these columns."""
        missing = [name for name in names if name not in self.header]
        if missing:
            raise self.error(self.header_line, f"columns are {', '.join(self.header)}; missing: {', '.join(missing)}")

    def one_of(self, *names: str) -> str:
        """Return the one of these columns that the file has."""
        present = [name for name in names if name in self.header]
        if len(present) != 1:
            what = "both" if present else "none"
            raise self.error(self.header_line, f"columns are {', '.join(self.header)}; {what} of {', '.join(names)}: give one of them")
        return present[0]

    def number(self, row: int, column: str, low: float = -math.inf, high: float = math.inf) -> float:
        """Return a finite number within a range."""
        text = self.rows[row][self.header.index(column)] if column in self.header else ""
        try:
            value = plain_number(text)
        except ValueError:
            raise self.error(self.lines[row], f"{column} = '{text}' is not a number") from None
        if not low <= value <= high:  # also where it is NaN
            allowed = f"{low:g} to {high:g}" if math.isfinite(high) else f"{low:g} or more"
            raise self.error(self.lines[row], f"{column} = {text} is outside the range allowed: {allowed}")
        if not math.isfinite(value):
            raise self.error(self.lines[row], f"{column} = {text} is not a finite number")
        return value

    def column(self, name: str, low: float = -math.inf, high: float = math.inf) -> FloatArray:
        """Return the numbers of a column, each finite and within a range [(rows,)]."""
        return np.array([self.number(row, name, low, high) for row in range(len(self))])


def read_table(path: str | Path, needed: Sequence[str]) -> TextTable:
    """Read a CSV file with a line of column names; empty lines and lines that begin with ``#`` are skipped.

    Cells are separated by commas, semicolons or tabs. Messages name the columns ``needed`` if the file is empty or missing.

    Raises
    ------
    DataError
        With the file and, if the error is in a line, its number.
    """
    path, hint = Path(path), f"it needs columns {', '.join(needed)}"
    (head, *rest), comments = read_cell_lines(path, hint)
    names = tuple(head.cells)
    if len(set(names)) < len(names):
        raise DataError(f"{path}: line {head.number}: a column name stands twice: {', '.join(names)}")
    for line in rest:
        if len(line.cells) != len(names):
            raise DataError(f"{path}: line {line.number}: {len(line.cells)} cells under {len(names)} column names; is the file whole?")
    if not rest:
        raise DataError(f"{path}: has column names and no rows; {hint}")
    cells, numbers = [line.cells for line in rest], [line.number for line in rest]
    return TextTable(path, names, cells, numbers, header_line=head.number, comments=comments)


def csv_text(rows: Iterable[Iterable[object]], separator: str = ",", line_end: str = "\n") -> str:
    """Return rows of cells as CSV, quoted where a cell needs it; None is an empty cell."""
    text = io.StringIO(newline="")
    csv.writer(text, delimiter=separator, lineterminator=line_end).writerows(rows)
    return text.getvalue()


def write_columns(columns: Mapping[str, FloatArray], output: str | Path, *, overwrite: bool = False) -> Path:
    """Write columns of equal length, six digits each; NaN is an empty cell.

    Raises
    ------
    DataError
        The output exists.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = refuse_existing(output, overwrite=overwrite)
    cells = [["" if np.isnan(value) else f"{value:.6g}" for value in values.tolist()] for values in columns.values()]
    write_text(csv_text([columns, *zip(*cells, strict=True)]), output)
    return output


def write_rows(rows: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Write one or more rows of equal columns as CSV or, by the path's ending, Parquet; unknown values are empty cells.

    Raises
    ------
    StorageError
        No room or no rights.
    """
    if path.suffix != ".parquet":
        write_text(csv_text([rows[0], *(row.values() for row in rows)]), path)
        return
    columns = {name: [row[name] for row in rows] for name in rows[0]}
    # A Parquet column has one type: a column of numbers and text, as some cases have it, becomes text.
    mixed = {
        name: len({type(v) for v in values if v is not None} - {int, float}) > 1 or _is_mixed(values) for name, values in columns.items()
    }
    write_parquet({n: [None if v is None else str(v) for v in c] if mixed[n] else c for n, c in columns.items()}, path)


def _is_mixed(values: Sequence[Any]) -> bool:
    """Return true for a column that has both numbers and other values; truth values are no numbers."""
    return len({isinstance(v, int | float) and not isinstance(v, bool) for v in values if v is not None}) > 1


def read_rows(path: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV file that ``write_rows`` wrote, as texts by column.

    Raises
    ------
    DataError
        A file that is missing or no text.
    """
    return list(csv.DictReader(io.StringIO(read_text(path, "make it again"), newline="")))


def require_parquet() -> Any:
    """Return PyArrow with its module ``parquet``.

    Raises
    ------
    BackendError
        It is not installed.
    """
    pyarrow = optional("pyarrow", "Parquet", "or use .csv")
    optional("pyarrow.parquet", "Parquet", "or use .csv")
    return pyarrow


def write_parquet(columns: Mapping[str, Sequence[Any]], path: Path) -> None:
    """Write columns of equal length as Parquet.

    Raises
    ------
    BackendError
        PyArrow is not installed.
    StorageError
        No room or no rights; nothing is left behind.
    """
    arrow = require_parquet()
    with moved_when_whole(path) as partial:
        arrow.parquet.write_table(arrow.table(dict(columns)), str(partial))
