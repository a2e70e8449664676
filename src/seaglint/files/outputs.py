"""Output files of commands: checked before the work, written completely or not at all."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from seaglint.base.errors import DataError
from seaglint.files.failures import storage_errors

ELSEWHERE = "choose another place; nothing was written"


def refuse_existing(output: str | Path, *, overwrite: bool = False, inputs: Iterable[str | Path] = ()) -> Path:
    """Return the path of an output file, checked before anything is computed.

    Raises
    ------
    DataError
        The folder is missing, the name is that of a folder, device or pipe or of one of the ``inputs``, or a file is there and
        ``overwrite`` is not set.
    StorageError
        Nothing can be written in the folder.
    """
    output = Path(output)
    with storage_errors(output, ELSEWHERE):
        refuse_inputs(output, inputs)
        require_folder(output)
        _require_replaceable(output)
        if output.exists() and not overwrite:
            raise DataError(f"{output}: exists already; choose another name, or replace it with overwrite=True")
    return output


def require_folder(output: Path) -> None:
    """Refuse an output whose folder does not exist or cannot be written to.

    Raises
    ------
    DataError, OSError
        The folder is missing; the system would refuse to write there.
    """
    if not output.parent.is_dir():
        raise DataError(f"{output}: the folder {output.parent} does not exist; make it first")
    if not os.access(output.parent, os.W_OK):
        raise OSError(errno.EACCES, os.strerror(errno.EACCES), str(output.parent))


def refuse_inputs(output: Path, inputs: Iterable[str | Path]) -> None:
    """Refuse to overwrite an input file, under any name.

    Raises
    ------
    DataError
        The output is one of the inputs.
    """
    for path in inputs:
        if output.exists() and Path(path).exists() and output.samefile(path):
            raise DataError(f"{output}: is read by this command and would be destroyed by its output; choose another name for the output")


@contextmanager
def moved_when_whole(output: Path, remedy: str = "make room or choose another place; nothing was written") -> Iterator[Path]:
    """Provide a temporary name, ``output`` with ``.partial`` added; it replaces ``output`` on success and is removed otherwise.

    Raises
    ------
    DataError
        What stands at one of the two names is no regular file.
    StorageError
        No room or no rights; it ends with ``remedy``.
    """
    partial = output.with_name(output.name + ".partial")
    with storage_errors(output, remedy):
        for path in (output, partial):
            _require_replaceable(path)
    try:
        with storage_errors(output, remedy):
            yield partial
            partial.replace(output)
    finally:
        with suppress(OSError):  # a read-only file system refuses even to remove what is not there
            partial.unlink(missing_ok=True)


def _require_replaceable(path: Path) -> None:
    """Refuse devices and pipes: moving a file there would replace the node, for every program of the machine."""
    if path.is_dir():
        raise DataError(f"{path}: is a folder; give the name of a file")
    if path.exists() and not path.is_file():
        raise DataError(f"{path}: is a device, pipe or socket, which is never replaced; give the name of a file")
