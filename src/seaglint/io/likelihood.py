"""Results of the likelihood of glint as files: JSON of everything, CSV of chances and of their strata."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from seaglint.io.outputs import moved_when_whole, refuse_existing


def write_json(found: Mapping[str, Any], output: str | Path, *, overwrite: bool = False) -> Path:
    """Write a result as JSON.

    Raises
    ------
    DataError
        The output exists.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = refuse_existing(output, overwrite=overwrite)
    with moved_when_whole(output) as partial:
        partial.write_text(json.dumps(found, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    return output


def write_rows(rows: Sequence[Mapping[str, Any]], output: str | Path, *, overwrite: bool = False) -> Path:
    """Write rows with the columns of the first; None is an empty cell, numbers have six digits, a pair is two columns.

    Raises
    ------
    DataError
        The output exists.
    StorageError
        No room or no rights; nothing is left behind.
    """
    output = refuse_existing(output, overwrite=overwrite)
    flat = [_flat(row) for row in rows]
    lines = [",".join(flat[0])] if flat else []
    lines += [",".join(_cell(row.get(name)) for name in flat[0]) for row in flat]
    with moved_when_whole(output) as partial:
        partial.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return output


def _flat(row: Mapping[str, Any]) -> dict[str, Any]:
    out: dict[str, Any] = {}
    for name, value in row.items():
        if isinstance(value, list | tuple):
            out |= {f"{name}_low": value[0], f"{name}_high": value[1]}
        else:
            out[name] = value
    return out


def _cell(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
