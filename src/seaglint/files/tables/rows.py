"""Rows of results as tables: CSV or Parquet, written completely or not at all."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from seaglint.base.optional import optional
from seaglint.files.outputs import moved_when_whole
from seaglint.files.tables.table_text import csv_text
from seaglint.files.text_file import read_text, write_text


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
