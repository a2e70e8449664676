"""Reader of a sensor's spectral response from a CSV file."""

from __future__ import annotations

from pathlib import Path

from seaglint.base.errors import DataError
from seaglint.files.tables.table_text import plain_number, read_cell_lines
from seaglint.optics.band import Band


def read_response(path: str | Path, *, whole: bool = False) -> Band:
    """Read a CSV file with the columns ``wavelength_um`` and ``response``; lines that begin with ``#`` are comments.

    Zeros at the ends are cut off, unless the ``whole`` table is wanted.

    Raises
    ------
    DataError
        Naming the file and the line that cannot be used.
    """
    path = Path(path)
    (head, *rest), _ = read_cell_lines(path, "it needs columns wavelength_um, response", ",")
    try:
        columns = head.cells.index("wavelength_um"), head.cells.index("response")
    except ValueError:
        names = ", ".join(head.cells)
        raise DataError(f"{path}: line {head.number}: columns are {names}; needed are wavelength_um, response") from None
    points: list[tuple[float, float]] = []
    for number, line, row in rest:
        try:
            points.append((plain_number(row[columns[0]]), plain_number(row[columns[1]])))
        except (ValueError, IndexError):
            raise DataError(f"{path}: line {number}: '{line.strip()}' does not hold two numbers; is the file whole?") from None
    try:
        return Band.from_response([p[0] for p in points], [p[1] for p in points], whole=whole)
    except DataError as error:
        raise DataError(f"{path}: {error}") from None
