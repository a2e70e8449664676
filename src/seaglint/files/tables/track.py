"""Reader of keyframes of a moving sensor or object from a CSV file."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.tables.table_text import plain_number, read_cell_lines

#: Columns that a file of a sensor's keyframes may have; the time is required, and one more.
COLUMNS: Final = ("time_s", "east_m", "north_m", "height_m", "azimuth_deg", "elevation_deg", "roll_deg")

#: Columns that a file of an object's keyframes may have.
OBJECT_COLUMNS: Final = (*COLUMNS[:4], "latitude_deg", "longitude_deg", "heading_deg", "pitch_deg", "roll_deg")


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
