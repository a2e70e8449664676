"""Reader and writer of CSV: cells by line, tables with a line of column names, errors that name file, line and column.

Writer of columns of numbers as a CSV file, completely or not at all.

Rows of results as tables: CSV or Parquet, written completely or not at all.
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

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

    The first line shows which of the ``separators`` parts the cells.

    Raises
    ------
    DataError
        Naming the file and, where there is one, the line; the message of an empty or missing file ends with ``hint``.
    """
    lines = [(number, line) for number, line in enumerate(read_text(path, hint).splitlines(), 1) if line.strip()]
    comments = [line.lstrip()[1:].strip() for _, line in lines if line.lstrip().startswith("#")]
    lines = [(number, line) for number, line in lines if not line.lstrip().startswith("#")]
    if not lines:
        raise DataError(f"{path}: is empty; {hint}")
    separator = max(separators, key=lines[0][1].count)
    return [CellLine(n, line, [cell.strip() for cell in cells_of(path, n, line, separator)]) for n, line in lines], comments


def csv_text(rows: Iterable[Iterable[object]], separator: str = ",", line_end: str = "\n") -> str:
    """Return rows of cells as CSV, quoted where a cell needs it; None is an empty cell."""
    text = io.StringIO(newline="")
    csv.writer(text, delimiter=separator, lineterminator=line_end).writerows(rows)
    return text.getvalue()


@dataclass(frozen=True)
class TableRow:
    """Cells of one line by column name, as text."""

    line: int
    cells: dict[str, str]


@dataclass(frozen=True)
class TextTable:
    """Text of a CSV file: comments, column names, rows."""

    path: Path
    header_line: int
    columns: tuple[str, ...]
    rows: tuple[TableRow, ...]

    def error(self, line: int, text: str) -> DataError:
        """Return an error at a line of this file."""
        return DataError(f"{self.path}: line {line}: {text}")

    def require(self, *names: str) -> None:
        """Refuse a file that lacks these columns."""
        missing = [name for name in names if name not in self.columns]
        if missing:
            raise self.error(self.header_line, f"columns are {', '.join(self.columns)}; missing: {', '.join(missing)}")

    def one_of(self, *names: str) -> str:
        """Return the one of these columns that the file has."""
        present = [name for name in names if name in self.columns]
        if len(present) != 1:
            what = "both" if present else "none"
            raise self.error(self.header_line, f"columns are {', '.join(self.columns)}; {what} of {', '.join(names)}: give one of them")
        return present[0]

    def number(self, row: TableRow, column: str, low: float = -math.inf, high: float = math.inf) -> float:
        """Return a finite number within a range."""
        text = row.cells.get(column, "")
        try:
            value = plain_number(text)
        except ValueError:
            raise self.error(row.line, f"{column} = '{text}' is not a number") from None
        if not low <= value <= high:  # also where it is NaN
            allowed = f"{low:g} to {high:g}" if math.isfinite(high) else f"{low:g} or more"
            raise self.error(row.line, f"{column} = {text} is outside the range allowed: {allowed}")
        if not math.isfinite(value):
            raise self.error(row.line, f"{column} = {text} is not a finite number")
        return value


def read_text_table(path: str | Path, needed: Sequence[str]) -> TextTable:
    """Read a CSV file with a line of column names; empty lines and lines that begin with ``#`` are skipped.

    Commas, semicolons or tabs part the cells. Messages name the columns ``needed`` where the file is empty or missing.

    Raises
    ------
    DataError
        Naming the file and, where there is one, the line.
    """
    path, hint = Path(path), f"it needs columns {', '.join(needed)}"
    (head, *rest), _ = read_cell_lines(path, hint)
    names = tuple(head.cells)
    if len(set(names)) < len(names):
        raise DataError(f"{path}: line {head.number}: a column name stands twice: {', '.join(names)}")
    rows = []
    for number, _, cells in rest:
        if len(cells) != len(names):
            raise DataError(f"{path}: line {number}: {len(cells)} cells under {len(names)} column names; is the file whole?")
        rows.append(TableRow(number, dict(zip(names, cells, strict=True))))
    if not rows:
        raise DataError(f"{path}: has column names and no rows; {hint}")
    return TextTable(path, head.number, names, tuple(rows))


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
    if path.suffix == ".parquet":
        columns = {name: [row[name] for row in rows] for name in rows[0]}
        # a column of numbers and text, as some cases have it, is text
        mixed = {
            name: len({type(v) for v in values if v is not None} - {int, float}) > 1 or _both(values) for name, values in columns.items()
        }
        write_parquet({n: [None if v is None else str(v) for v in c] if mixed[n] else c for n, c in columns.items()}, path)
        return
    write_text(csv_text([rows[0], *(row.values() for row in rows)]), path)


def read_rows(path: Path) -> list[dict[str, str]]:
    """Return the rows of a CSV file that :func:`write_rows` wrote, as texts by column.

    Raises
    ------
    DataError
        A file that is missing or no text.
    """
    return list(csv.DictReader(io.StringIO(read_text(path, "make it again"), newline="")))


def _both(values: Sequence[Any]) -> bool:
    kinds = {isinstance(v, int | float) and not isinstance(v, bool) for v in values if v is not None}
    return len(kinds) > 1


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
