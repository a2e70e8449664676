"""Tables of the likelihood of glint: chances, strata and ways as CSV."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from seaglint.base.free_form import TableRow
from seaglint.files.tables.rows import write_rows


def write_table(rows: Sequence[Mapping[str, Any]], output: Path) -> None:
    """Write one or more rows with the columns of the first; numbers have six digits, a pair is two columns.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    flat = [_flat(row) for row in rows]
    write_rows([{name: row.get(name) for name in flat[0]} for row in flat], output)


def _flat(row: Mapping[str, Any]) -> TableRow:
    out: TableRow = {}
    for name, value in row.items():
        if isinstance(value, list | tuple):
            out |= {f"{name}_low": _rounded(value[0]), f"{name}_high": _rounded(value[1])}
        else:
            out[name] = _rounded(value)
    return out


def _rounded(value: Any) -> Any:
    return f"{value:.6g}" if isinstance(value, float) else value
