"""Reader of columns of numbers from a CSV file, with errors that name file, line and column."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from seaglint.base.errors import DataError


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


def rows_of_cells(path: Path, lines: Sequence[tuple[int, str]], separator: str = ",") -> list[list[str]]:
    """Return the cells of numbered lines, one list a line.

    Raises
    ------
    DataError
        Quotes that do not end in their line, or cells that are no text.
    """
    rows = []
    for number, line in lines:
        try:
            (row,) = csv.reader([line], delimiter=separator, strict=True)
        except (csv.Error, ValueError) as error:
            raise DataError(f"{path}: line {number}: is no row of cells ({error}); repair its quotes") from None
        rows.append(row)
    return rows


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

    Commas, semicolons or tabs part the cells. ``needed`` is told where the file is empty or missing.

    Raises
    ------
    DataError
        Naming the file and, where there is one, the line.
    """
    path, hint = Path(path), f"it needs columns {', '.join(needed)}"
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise DataError(f"{path}: no such file; {hint}") from None
    except UnicodeDecodeError as error:
        raise DataError(f"{path}: is not UTF-8 text (byte {error.start}); {hint}") from None
    except OSError as error:
        raise DataError(f"{path}: cannot be read: {error.strerror}") from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise DataError(f"{path}: is empty; {hint}")
    separator = max(",;\t", key=lines[0][1].count)
    cells = [[cell.strip() for cell in row] for row in rows_of_cells(path, lines, separator)]
    names = tuple(cells[0])
    if len(set(names)) < len(names):
        raise DataError(f"{path}: line {lines[0][0]}: a column name stands twice: {', '.join(names)}")
    rows = []
    for (number, _), row in zip(lines[1:], cells[1:], strict=True):
        if len(row) != len(names):
            raise DataError(f"{path}: line {number}: {len(row)} cells under {len(names)} column names; is the file whole?")
        rows.append(TableRow(number, dict(zip(names, row, strict=True))))
    if not rows:
        raise DataError(f"{path}: has column names and no rows; {hint}")
    return TextTable(path, lines[0][0], names, tuple(rows))
