"""Files of a detection run: JSON, tidy tables as CSV or Parquet, and the picture of the operating characteristic."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from seaglint.conventions import FloatArray
from seaglint.errors import BackendError, DataError
from seaglint.io.columns import write_columns
from seaglint.io.outputs import moved_when_whole, refuse_existing


@dataclass(frozen=True)
class DetectionFiles:
    """Names of the files, refused before the work.

    Attributes
    ----------
    result, table, characteristic, picture : Path
        JSON, a row a contrast, operating characteristic, its picture.
    """

    result: Path
    table: Path
    characteristic: Path
    picture: Path
    overwrite: bool

    @classmethod
    def at(cls, output: Path, *, overwrite: bool = False, inputs: Iterable[str | Path] = ()) -> DetectionFiles:
        """Files beside each other; the ending .parquet makes the tables Parquet files, .json, .csv or none CSV.

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
            _arrow()
        tables = ".parquet" if ending == ".parquet" else ".csv"
        base = output.with_suffix("") if ending else output
        beside = base.with_name(base.name + "_roc")
        files = cls(Path(f"{base}.json"), Path(f"{base}{tables}"), Path(f"{beside}{tables}"), Path(f"{beside}.png"), overwrite)
        inputs = list(inputs)
        for path in files.paths:
            refuse_existing(path, overwrite=overwrite, inputs=inputs)
        return files

    @property
    def paths(self) -> tuple[Path, Path, Path, Path]:
        """All four."""
        return self.result, self.table, self.characteristic, self.picture

    def write(
        self,
        result: Mapping[str, Any],
        rows: Sequence[Mapping[str, Any]],
        characteristic: Mapping[str, FloatArray],
        draw: Callable[[Path], None],
    ) -> None:
        """Write all files, each moved to its place when whole.

        Raises
        ------
        StorageError
            No room or no rights.
        """
        with moved_when_whole(self.result) as partial:
            partial.write_text(json.dumps(result, indent=2, ensure_ascii=False, allow_nan=False) + "\n", encoding="utf-8")
        write_rows(rows, self.table)
        if self.table.suffix == ".parquet":
            _write_parquet({name: values.tolist() for name, values in characteristic.items()}, self.characteristic)
        else:
            write_columns({k: np.asarray(v) for k, v in characteristic.items()}, self.characteristic, overwrite=self.overwrite)
        draw(self.picture)


def write_rows(rows: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Write rows of equal columns as CSV or, by the path's ending, Parquet; what is not known is an empty cell.

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
        _write_parquet({n: [None if v is None else str(v) for v in c] if mixed[n] else c for n, c in columns.items()}, path)
        return
    with moved_when_whole(path) as partial, partial.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({k: "" if v is None else v for k, v in row.items()} for row in rows)


def _both(values: Sequence[Any]) -> bool:
    kinds = {isinstance(v, int | float) and not isinstance(v, bool) for v in values if v is not None}
    return len(kinds) > 1


def _arrow() -> Any:
    try:
        import pyarrow
        import pyarrow.parquet
    except ImportError as error:
        raise BackendError(
            "Parquet files need PyArrow, which is not installed; pip install pyarrow, or give a name that ends in .csv"
        ) from error
    return pyarrow


def _write_parquet(columns: Mapping[str, Sequence[Any]], path: Path) -> None:
    arrow = _arrow()
    with moved_when_whole(path) as partial:
        arrow.parquet.write_table(arrow.table(dict(columns)), str(partial))
