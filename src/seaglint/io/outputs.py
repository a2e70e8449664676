"""Files that commands write: checked before the work, written beside their place and moved there when whole."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from seaglint.errors import DataError
from seaglint.io.failures import storage_errors


def refuse_existing(output: str | Path, *, overwrite: bool = False) -> Path:
    """Path of an output file, checked before anything is computed.

    Raises
    ------
    DataError
        The folder is missing, the name is that of a folder, device or pipe, or a file is there and ``overwrite`` is not set.
    """
    output = Path(output)
    if not output.parent.is_dir():
        raise DataError(f"{output}: the folder {output.parent} does not exist; make it first")
    _require_replaceable(output)
    if output.exists() and not overwrite:
        raise DataError(f"{output}: exists already; choose another name, or replace it with --overwrite")
    return output


@contextmanager
def moved_when_whole(output: Path, remedy: str = "make room or choose another place; nothing was written") -> Iterator[Path]:
    """Name to write to, ``output`` with ``.partial`` behind it; it replaces ``output`` when the context ends well, else it is removed.

    Raises
    ------
    DataError
        What stands at one of the two names is no regular file.
    StorageError
        No room or no rights; it ends with ``remedy``.
    """
    partial = output.with_name(output.name + ".partial")
    for path in (output, partial):
        _require_replaceable(path)
    try:
        with storage_errors(output, remedy):
            yield partial
            partial.replace(output)
    finally:
        partial.unlink(missing_ok=True)


def _require_replaceable(path: Path) -> None:
    """Moving a file onto a device or pipe would put it in the place of the node, for every program of the machine."""
    if path.is_dir():
        raise DataError(f"{path}: is a folder; give the name of a file")
    if path.exists() and not path.is_file():
        raise DataError(f"{path}: is a device, pipe or socket, which is never replaced; give the name of a file")
