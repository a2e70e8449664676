"""Reader and writer of CSV: cells by line, tables with a line of column names, errors that name file, line and column."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from seaglint.base.errors import DataError
from seaglint.files.text_file import read_text


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
