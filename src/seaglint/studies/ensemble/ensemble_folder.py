"""Folder of an ensemble: its file, tables of the drawn values, and a scenario file and a store for every scene."""

from __future__ import annotations

import json
import shutil
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

from seaglint.base.errors import DataError
from seaglint.base.free_form import TableRow, TomlTables
from seaglint.formats.tables.table_text import write_rows
from seaglint.scenario.ensemble_file import Ensemble, read_toml
from seaglint.scenario.text.toml_writing import document
from seaglint.store.outputs import ELSEWHERE, require_folder, storage_errors, write_text
from seaglint.studies.ensemble.law_draws import EnsembleScene
from seaglint.studies.ensemble.scene_attempts import forget_attempts

_REMEDY: Final = "make room and run the same command with --resume"
_TABLES: Final = ("parameters", "objects", "sea_unknown")
_ENDINGS: Final = (".csv", ".parquet")
MOST_LISTED: Final = 5  #: Largest number of differing keys that an error lists; more are counted.


@dataclass(frozen=True)
class Folder:
    """Folder of an ensemble."""

    path: Path  #: Folder of ``ensemble.toml``, ``parameters.csv``, ``objects.csv``, ``scenes/`` and, of scenes that failed, ``failures/``.

    @property
    def file(self) -> Path:
        """File of the ensemble, with its base written out."""
        return self.path / "ensemble.toml"

    def scenario(self, label: str) -> Path:
        """Return the scenario file of a scene."""
        return self.path / "scenes" / f"{label}.toml"

    def store(self, label: str) -> Path:
        """Return the store of a scene's sequence."""
        return self.path / "scenes" / f"{label}.zarr"

    def failure(self, label: str) -> Path:
        """Return the file of the traceback of a scene that failed."""
        return self.path / "failures" / f"{label}.txt"

    def check(self, *, resume: bool, overwrite: bool) -> None:
        """Refuse a folder that may be neither resumed nor replaced.

        Raises
        ------
        DataError
            The folder holds another ensemble, or other files.
        """
        if resume and overwrite:
            raise DataError("resume keeps what is there and overwrite replaces it; give one of the two")
        with storage_errors(self.path, ELSEWHERE):
            require_folder(self.path)
        if not self.path.exists():
            return
        if not self.path.is_dir():
            raise DataError(f"{self.path}: is a file; an ensemble needs a folder: give another name")
        if self.file.is_file():
            if not (resume or overwrite):
                raise DataError(f"{self.path}: holds an ensemble already; continue it with resume=True, or start again with overwrite=True")
        # A process that is killed in its first moments leaves the file of the ensemble half written.
        elif any(path.name != f"{self.file.name}.partial" for path in self.path.iterdir()):
            raise DataError(f"{self.path}: is not empty and holds no ensemble; it is left alone: give another folder")

    def write(self, ensemble: Ensemble, scenes: Sequence[EnsembleScene], *, resume: bool, overwrite: bool) -> None:
        """Write everything but the sequences; existing files of the same ensemble stay.

        Raises
        ------
        DataError
            The folder belongs to another ensemble; the error has the keys that differ.
        StorageError
            No room or no rights.
        """
        with storage_errors(self.path, _REMEDY):
            if overwrite:
                self._clear()
            text = ensemble_text(ensemble)
            if resume and self.file.exists():
                self._require_same(text, scenes)
            self.path.mkdir(exist_ok=True)
            write_text(text, self.file)  # first: by this file the folder is recognised
            (self.path / "scenes").mkdir(exist_ok=True)
            for scene in scenes:
                path = self.scenario(scene.label)
                if not path.exists():
                    write_text(scene.text, path)
        self._write_table("parameters", [scene.row for scene in scenes])
        self._write_table("objects", object_rows(scenes))

    def write_sea_unknown(self, rows: list[TableRow]) -> None:
        """Write the table of the scenes' numbers with their intervals over drawn seas."""
        with storage_errors(self.path, _REMEDY):
            self._write_table("sea_unknown", rows)

    def _write_table(self, name: str, rows: list[TableRow]) -> None:
        for ending in _ENDINGS:
            if rows and (ending == ".csv" or find_spec("pyarrow") is not None):
                write_rows(rows, self.path / f"{name}{ending}")

    def _clear(self) -> None:
        """Remove the files of an ensemble, and no others; the file by which the folder is recognised goes last."""
        forget_attempts(self.path)
        for name in ("scenes", "failures"):
            shutil.rmtree(self.path / name, ignore_errors=True)
        for path in (*(self.path / f"{name}{ending}" for name in _TABLES for ending in _ENDINGS), self.file):
            path.unlink(missing_ok=True)

    def _require_same(self, text: str, scenes: Sequence[EnsembleScene]) -> None:
        # The table of a data set changes no scene.
        old, new = ({**tables, "dataset": {}} for tables in (read_toml(self.file, "ensemble"), tomllib.loads(text)))
        differ = differences(old, new)
        for scene in () if differ else scenes:
            path = self.scenario(scene.label)
            if path.exists() and (differ := differences(read_toml(path, "scene"), tomllib.loads(scene.text))):
                differ = [f"{key} of scene {scene.number}" for key in differ]
                break
        if differ:
            more = f" and {len(differ) - MOST_LISTED} more" if len(differ) > MOST_LISTED else ""
            raise DataError(
                f"{self.path}: was made with another {', '.join(differ[:MOST_LISTED])}{more}; resume with the same ensemble, or start "
                "again with overwrite"
            )


def ensemble_text(ensemble: Ensemble) -> str:
    """Return the text of a self-contained file of an ensemble: the base written out, paths absolute."""
    laws = [law.model_dump(exclude_none=True, mode="json") for law in ensemble.vary]
    for law in laws:
        if "table" in law:
            law["table"] = str(Path(law["table"]).absolute())
    tables: TomlTables = {"ensemble": ensemble.ensemble.model_dump(exclude_none=True), "base": ensemble.base}
    tables["vary"] = laws
    tables["objects"] = [template.model_dump(exclude_unset=True) for template in ensemble.objects]
    tables["dataset"] = ensemble.dataset.model_dump(exclude_unset=True)
    return document({name: value for name, value in tables.items() if value or name == "base"}, "as it was drawn, its base written out")


def object_rows(scenes: Sequence[EnsembleScene]) -> list[TableRow]:
    """Return the objects of all scenes, a row each, with the keys of all of them; lists as JSON."""
    rows = [{"scene": scene.number, **_flat(item)} for scene in scenes for item in scene.objects]
    columns = dict.fromkeys(name for row in rows for name in row)
    return [{name: row.get(name) for name in columns} for row in rows]


def _flat(value: Mapping[str, Any], above: str = "") -> TomlTables:
    """Return values by dotted key."""
    out: TomlTables = {}
    for name, inner in value.items():
        key = f"{above}.{name}" if above else name
        if isinstance(inner, Mapping):
            out |= _flat(inner, key)
        else:
            out[key] = json.dumps(inner, default=str) if isinstance(inner, list | tuple) else inner
    return out


def differences(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """Return dotted keys that differ; of a list of tables, such as ``vary``, the tables by their place."""

    def by_key(tables: Mapping[str, Any]) -> TomlTables:
        lists = {name: value for name, value in tables.items() if isinstance(value, list) and all(isinstance(v, Mapping) for v in value)}
        out = _flat({name: value for name, value in tables.items() if name not in lists})
        for name, items in lists.items():
            for i, item in enumerate(items):
                out |= _flat(item, f"{name}[{i}]")
        return out

    before, after = by_key(old), by_key(new)
    return [key for key in dict.fromkeys((*before, *after)) if before.get(key) != after.get(key)]
