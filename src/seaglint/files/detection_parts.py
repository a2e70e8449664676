"""Parts of an unfinished detection study: frames and finished cases in a folder beside the result, each complete."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.files.failures import storage_errors
from seaglint.files.outputs import moved_when_whole
from seaglint.files.text_file import read_json, write_json

_MARK = "seaglint-detection-parts"


@dataclass(frozen=True)
class Parts:
    """Folder of parts; make it with :meth:`at`."""

    folder: Path  #: RESULT.parts.

    @classmethod
    def at(cls, base: Path, *, resume: bool, overwrite: bool) -> Parts:
        """Open the folder of a result; make it where it is missing.

        Raises
        ------
        DataError
            Something is there and is neither to be gone on with nor replaced, or is no such folder.
        """
        folder = base.with_name(base.name + ".parts")
        with storage_errors(folder, "make room or choose another place"):
            if folder.exists():
                if not (folder / _MARK).is_file():
                    raise DataError(f"{folder}: is there and holds no parts of a detection study; move it, or choose another output")
                if not resume and not overwrite:
                    raise DataError(f"{folder}: holds an unfinished study; go on with resume=True, or begin anew with overwrite=True")
                if not resume:
                    shutil.rmtree(folder)
            folder.mkdir(exist_ok=True)
            (folder / _MARK).touch()
        return cls(folder)

    def frames(self, key: str) -> Path:
        """Return the folder of the frames of a scene."""
        folder = self.folder / f"frames-{key}"
        with storage_errors(folder, "make room or choose another place"):
            folder.mkdir(exist_ok=True)
        return folder

    def forget_frames(self, key: str) -> None:
        """Remove the frames of a scene."""
        shutil.rmtree(self.folder / f"frames-{key}", ignore_errors=True)

    def case(self, key: str) -> JsonObject | None:
        """Return a finished case; None where it is missing or incomplete."""
        try:
            stored: JsonObject = read_json(self.folder / f"case-{key}.json", "compute it again")
        except DataError:
            return None
        return stored

    def keep_case(self, key: str, value: JsonObject) -> None:
        """Write a finished case."""
        write_json(value, self.folder / f"case-{key}.json", indent=None)

    @property
    def empty(self) -> bool:
        """Return true while no part is stored."""
        return not any(path.is_file() and path.name != _MARK for path in self.folder.rglob("*"))

    def remove(self) -> None:
        """Remove all parts."""
        shutil.rmtree(self.folder, ignore_errors=True)


def sea_path(folder: Path, number: int) -> Path:
    """Return the file of the frames of one sea."""
    return folder / f"{number:05d}.npy"


def whole_sea(folder: Path, number: int, shape: tuple[int, ...]) -> bool:
    """Return true where the frames of a sea exist in the requested size."""
    try:
        return bool(np.load(sea_path(folder, number), mmap_mode="r").shape == shape)
    except (OSError, ValueError, EOFError):
        return False


def keep_sea(folder: Path, number: int, frames: NDArray[np.float32]) -> None:
    """Write the frames of a sea."""
    with moved_when_whole(sea_path(folder, number), "make room and go on with resume=True") as partial, partial.open("wb") as file:
        np.save(file, frames)


@contextmanager
def parts_folder(base: Path | None, *, resume: bool = False, overwrite: bool = False) -> Iterator[tuple[Parts, bool]]:
    """Return the parts beside a result, and whether they outlive an interruption; without a result a temporary folder."""
    if base is not None:
        parts = Parts.at(base, resume=resume, overwrite=overwrite)
        try:
            yield parts, True
        finally:
            if parts.empty:
                parts.remove()
        return
    import tempfile

    with tempfile.TemporaryDirectory(prefix="seaglint-") as folder:
        yield Parts.at(Path(folder) / "study", resume=False, overwrite=True), False
