"""Cells of a CSV file of weather by column: numbers with gaps, texts, and their position in the file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.climate.weather_table import RANGES
from seaglint.files.tables.table_text import plain_number, read_cell_lines

_MISSING: Final = frozenset({"", "nan", "NaN", "NA", "null", "None"})


@dataclass(frozen=True)
class TextColumns:
    """Text of a CSV file, column by column."""

    path: Path  #: The file, for messages.
    header: tuple[str, ...]  #: Headings in their order.
    rows: list[list[str]]  #: Cells without blanks around them.
    lines: list[int]  #: Line of the file that each row stands on, counted from 1.
    comments: list[str]  #: Texts behind ``#`` before the headings.

    def text(self, name: str) -> list[str]:
        """Return the cells of a column."""
        at = self.header.index(name)
        return [row[at] for row in self.rows]

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
                raise DataError(f"{self.where(i)}, column {name}: '{cell}' is not a number{comma}") from None
        return out

    def where(self, row: int) -> str:
        """Return file, row and line, for messages."""
        return f"{self.path}, row {row + 1} (line {self.lines[row]})"

    def within(self, name: str, values: FloatArray, column: str = "", advice: str = "") -> FloatArray:
        """Return the values of a weather column; refuse one outside its range with row and line."""
        low, high = RANGES[name]
        bad = np.flatnonzero(~(np.isnan(values) | (np.isfinite(values) & (values >= low) & (values <= high))))
        if bad.size:
            allowed = f"{low:g} to {high:g}" if np.isfinite(high) else f"{low:g} or more"
            more = f" ({bad.size - 1} more row{'s' if bad.size > 2 else ''} like it)" if bad.size > 1 else ""
            raise DataError(
                f"{self.where(int(bad[0]))}, column {column or name}: {name} = {values[bad[0]]:g} is outside the range allowed: {allowed}; "
                f"{advice or 'correct it, or leave it empty'}{more}"
            )
        return values


def read_cells(path: str | Path) -> TextColumns:
    """Read a CSV file with a line of headings; empty lines and lines that begin with ``#`` are skipped.

    Commas, semicolons or tabs part the cells.

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
    twice = sorted({name for name in header if name and header.count(name) > 1})
    if twice:
        raise DataError(f"{path}, line {head.number}: column {', '.join(twice)} is there twice; rename or remove one")
    for number, _, row in rest:
        if len(row) != len(header):
            raise DataError(f"{path}, line {number}: {len(row)} cells under {len(header)} headings; is the file whole?")
    return TextColumns(path, header, [line.cells for line in rest], [line.number for line in rest], comments)
