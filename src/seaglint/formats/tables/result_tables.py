"""Files of results: files of a detection run (JSON, tidy tables as CSV or Parquet, a picture), and tables of the likelihood of glint."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import TableRow
from seaglint.formats.tables.table_text import require_parquet, write_columns, write_parquet, write_rows
from seaglint.store.outputs import refuse_existing, write_json


@dataclass(frozen=True)
class DetectionFiles:
    """Names of the files, checked before the work."""

    result: Path  #: Whole result, JSON.
    table: Path  #: Table, a row a contrast.
    characteristic: Path  #: Table of the operating characteristic.
    picture: Path  #: Picture of the operating characteristic.
    overwrite: bool

    @classmethod
    def at(cls, output: Path, *, overwrite: bool = False, inputs: Iterable[str | Path] = ()) -> DetectionFiles:
        """Return names side by side; the ending .parquet makes the tables Parquet files, .json, .csv or none CSV.

        Raises
        ------
        DataError
            Another ending, or files that are there already.
        BackendError
            Parquet without PyArrow.
        """
        ending = output.suffix.lower()
        if ending not in ("", ".json", ".csv", ".parquet"):
            raise DataError(f"{output}: results are .json with .csv or .parquet; give a name with one of these endings, or without")
        if ending == ".parquet":
            require_parquet()
        tables = ".parquet" if ending == ".parquet" else ".csv"
        base = output.with_suffix("") if ending else output
        roc = base.with_name(base.name + "_roc")
        files = cls(Path(f"{base}.json"), Path(f"{base}{tables}"), Path(f"{roc}{tables}"), Path(f"{roc}.png"), overwrite)
        inputs = list(inputs)
        for path in files.paths:
            refuse_existing(path, overwrite=overwrite, inputs=inputs)
        return files

    @property
    def paths(self) -> tuple[Path, Path, Path, Path]:
        """Return all four names."""
        return self.result, self.table, self.characteristic, self.picture

    def write(
        self,
        result: Mapping[str, Any],
        rows: Sequence[Mapping[str, Any]],
        characteristic: Mapping[str, FloatArray],
        draw: Callable[[Path], None],
    ) -> None:
        """Write all files, each completely or not at all.

        Raises
        ------
        StorageError
            No room or no rights.
        """
        write_json(result, self.result)
        write_rows(rows, self.table)
        if self.table.suffix == ".parquet":
            write_parquet({name: values.tolist() for name, values in characteristic.items()}, self.characteristic)
        else:
            write_columns({k: np.asarray(v) for k, v in characteristic.items()}, self.characteristic, overwrite=self.overwrite)
        draw(self.picture)


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
