"""Folder of the finished parts of unfinished work, which a later run resumes; each part is written completely or not at all."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seaglint.base.errors import DataError
from seaglint.store.outputs import json_text, moved_when_whole, read_json, storage_errors
from seaglint.store.staging import remove_folder

_REMEDY = "make room or choose another place"


@dataclass(frozen=True)
class ResumableFolder:
    """Folder of finished parts; the file ``mark`` shows that it is such a folder, and is removed last."""

    folder: Path  #: Folder of the parts.
    mark: str  #: Name of the file that marks the folder, relative to it.

    @property
    def is_ours(self) -> bool:
        """Return true where the folder has the mark; only such a folder is ever emptied."""
        return (self.folder / self.mark).is_file()

    def open(self, *, resume: bool, overwrite: bool, foreign: str, unfinished: str) -> None:
        """Open the folder; make it where it is missing, and empty it where it is replaced.

        Parameters
        ----------
        resume, overwrite : bool
            Keep the finished parts, or remove them; without either an existing folder is refused.
        foreign, unfinished : str
            Errors for a folder without the mark, and for one that may be neither resumed nor replaced.

        Raises
        ------
        DataError
            The folder exists and may not be used.
        StorageError
            No room or no rights.
        """
        with storage_errors(self.folder, _REMEDY):
            if self.folder.exists():
                if not self.is_ours:
                    raise DataError(f"{self.folder}: {foreign}")
                if not resume and not overwrite:
                    raise DataError(f"{self.folder}: {unfinished}")
                if not resume:
                    self.clear()
            self.folder.mkdir(exist_ok=True)
            (self.folder / self.mark).touch()

    def part_folder(self, name: str) -> Path:
        """Return a folder of parts, made where it is missing."""
        folder = self.folder / name
        with storage_errors(folder, _REMEDY):
            folder.mkdir(exist_ok=True)
        return folder

    def read_part(self, name: str) -> Any:
        """Return a part stored as JSON; None where it is missing or incomplete."""
        try:
            return read_json(self.folder / name, "compute it again")
        except DataError:
            return None

    def write_part(self, name: str, value: Any) -> None:
        """Write a part as JSON; several workers may write the same part."""
        with moved_when_whole(self.folder / name, several=True) as partial:
            partial.write_bytes(f"{json_text(value, indent=None)}\n".encode())

    def forget_part(self, name: str) -> None:
        """Remove a folder of parts, into which a worker may still write."""
        with suppress(OSError):
            remove_folder(self.folder / name)

    @property
    def is_empty(self) -> bool:
        """Return true while no part is stored."""
        return not any(path.is_file() and path != self.folder / self.mark for path in self.folder.rglob("*"))

    def clear(self) -> None:
        """Remove all parts and the folder; the mark goes last, so that an interrupted removal leaves a folder that is still ours."""
        if self.folder.is_symlink():  # its target may hold more than parts, and the link itself cannot be removed as a folder
            raise DataError(f"{self.folder} is a link, which is not emptied; remove it, or choose another output")
        mark = self.folder / self.mark
        for path in self.folder.iterdir():
            if path.is_dir() and not path.is_symlink():
                if path not in mark.parents:
                    remove_folder(path)
            elif path != mark:
                path.unlink()
        remove_folder(self.folder)

    def remove(self) -> None:
        """Remove the folder with all parts, without an error where files cannot be removed."""
        with suppress(OSError):
            remove_folder(self.folder)
