"""List of the files that a viewer may open; it stays on the server, and browsers know only its numbers."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Iterator
from fnmatch import fnmatch
from pathlib import Path
from typing import Final

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.formats.recording import pictures as video
from seaglint.formats.recording import reader_choice
from seaglint.viewer.frame_source import ViewerSource, open_source

#: Endings of the files offered in a folder; raw files need a layout and are given by name.
ENDINGS: Final = frozenset({
    ".zarr", ".partial", ".nc", ".nc4", ".npy", ".npz", ".h5", ".hdf5", ".he5", ".mat", ".fits", ".fit", ".fts", ".fz",
    *reader_choice.ENDINGS, *video.VIDEO_ENDINGS,
})  # fmt: skip

MOST_LISTED: Final = 300  #: Largest number of files of a folder that are offered.

MOST_OPEN: Final = 6  #: Largest number of sources that stay open.


class Library:
    """Numbered files under the folders that the viewer was started with.

    Parameters
    ----------
    given : iterable of path
        Paths from the command line, opened at once so that errors appear before a browser opens.
    folder : path, optional
        Folder of further files; the folders of the given files by default.
    variable, channel, axes : str, optional
        Name of the array in files that hold several, channel, and order of axes, as in ``seaglint.formats.recording.open_recording``.

    Raises
    ------
    DataError
        The folder does not exist, or a given path cannot be opened.
    """

    def __init__(
        self,
        given: Iterable[str | Path] = (),
        folder: str | Path | None = None,
        variable: str | None = None,
        channel: str | None = None,
        axes: str | None = None,
    ) -> None:
        self._lock = threading.RLock()
        self._paths: list[str] = []
        self._numbers: dict[str, int] = {}
        self._open: dict[int, ViewerSource] = {}
        named = [str(path) for path in given]
        if folder is not None and not Path(folder).is_dir():
            raise DataError(f"folder = {folder}: is no folder; give one with sequences or recordings")
        self._folders = [Path(folder).resolve()] if folder is not None else sorted({Path(path).resolve().parent for path in named})
        self._patterns = [_identity(path) for path in named if any(sign in Path(path).name for sign in "*?[")]
        for path in named:
            self._open[self._number(path)] = open_source(path, variable, channel, axes)
        self.given = len(self._paths)

    def __len__(self) -> int:
        """Return the number of files in the list."""
        return len(self._paths)

    def _number(self, path: str) -> int:
        """Return the number of a path; a path that leads to a file in the list has the number of that file."""
        with self._lock:
            known = _identity(path)
            if known not in self._numbers:
                self._numbers[known] = len(self._paths)
                self._paths.append(path)
            return self._numbers[known]

    def listed(self) -> list[JsonObject]:
        """Return number and name of every file that may be opened, given files first; folders are read again."""
        for folder in self._folders:
            for path in _files(folder):
                if len(self._paths) >= self.given + MOST_LISTED:
                    break
                # Images that a pattern unites to a sequence are no files of their own.
                if not any(fnmatch(str(path.resolve()), pattern) for pattern in self._patterns):
                    self._number(str(path))
        return [
            {"id": number, "name": self._name(path)}
            for number, path in enumerate(self._paths)
            if number < self.given or os.path.exists(path) or os.path.exists(_identity(path))
        ]

    def _name(self, path: str) -> str:
        resolved = Path(path).resolve()
        for folder in self._folders:
            if resolved.is_relative_to(folder):
                return str(resolved.relative_to(folder))
        return Path(path).name

    def source(self, number: int) -> ViewerSource:
        """Return the source of a number, opened if necessary; beyond ``MOST_OPEN``, the source not used for longest is closed.

        Raises
        ------
        DataError
            The number is not in the list, or the file cannot be opened.
        """
        with self._lock:
            if not 0 <= number < len(self._paths):
                raise DataError(f"source {number}: the list has {len(self._paths)} files, from 0; choose one of them")
            source = self._open.pop(number, None)
            if source is None:
                path = self._paths[number]
                # A link may have been changed after the folder was listed, and lead out of it.
                if number >= self.given and not any(Path(path).resolve().is_relative_to(folder) for folder in self._folders):
                    raise DataError(f"{self._name(path)}: leads out of the folders that the viewer was started with")
                source = open_source(path)
            self._open[number] = source  # at the end: the last to be closed
            # Files from the command line stay open.
            while len(self._open) > max(MOST_OPEN, self.given):
                self._open.pop(next(n for n in self._open if n >= self.given))
            return source


def _identity(path: str) -> str:
    """Return what two paths to one file have in common; a sequence that is being written has its final name."""
    return str(Path(path).resolve()).removesuffix(".partial")


def _files(folder: Path, depth: int = 2) -> Iterator[Path]:
    """Return the files with known endings in a folder and its subfolders; links that lead out of it are skipped."""
    try:
        entries = sorted(folder.iterdir())
    except OSError:
        return
    for entry in entries:
        if entry.name.startswith(".") or not entry.resolve().is_relative_to(folder.resolve()):
            continue
        if entry.suffix.lower() in ENDINGS:
            yield entry
        elif depth > 1 and entry.is_dir():
            yield from _files(entry, depth - 1)
