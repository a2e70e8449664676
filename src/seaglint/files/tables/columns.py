"""Writer of columns of numbers as a CSV file, completely or not at all."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.files.outputs import refuse_existing
from seaglint.files.tables.table_text import csv_text
from seaglint.files.text_file import write_text


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
