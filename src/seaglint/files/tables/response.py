"""Reader of a sensor's spectral response from a CSV file."""

from __future__ import annotations

from pathlib import Path

from seaglint.base.errors import DataError
from seaglint.files.tables.table_text import plain_number, rows_of_cells
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
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise DataError(f"{path}: no such file; give a CSV file with columns wavelength_um, response") from None
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"{path}: cannot be read as text: {error}") from None
    lines = [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")]
    rows = rows_of_cells(path, lines)
    if not rows:
        raise DataError(f"{path}: is empty; it needs columns wavelength_um, response")
    header = [name.strip() for name in rows[0]]
    try:
        columns = header.index("wavelength_um"), header.index("response")
    except ValueError:
        raise DataError(f"{path}: line {lines[0][0]}: columns are {', '.join(header)}; needed are wavelength_um, response") from None
    points: list[tuple[float, float]] = []
    for (number, line), row in zip(lines[1:], rows[1:], strict=True):
        try:
            points.append((plain_number(row[columns[0]]), plain_number(row[columns[1]])))
        except (ValueError, IndexError):
            raise DataError(f"{path}: line {number}: '{line.strip()}' does not hold two numbers; is the file whole?") from None
    try:
        return Band.from_response([p[0] for p in points], [p[1] for p in points], whole=whole)
    except DataError as error:
        raise DataError(f"{path}: {error}") from None
