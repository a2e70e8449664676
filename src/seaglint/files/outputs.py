"""Output files of commands: checked before the work, written completely or not at all."""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

from seaglint.base.errors import DataError, StorageError
from seaglint.files.failures import storage_errors

ELSEWHERE = "choose another place; nothing was written"

_KINDS: Final = (
    "nc nc4 cdf h5 hdf5 mat npy npz fits parquet bin raw dat csv tsv txt json jsonl toml yaml yml xml ini md html htm pdf svg "
    "png jpg jpeg bmp tif tiff gif mp4 mkv avi mov webm ply stl obj glb zip tar gz tgz bz2 xz 7z xlsx py ipynb"
)

FILE_ENDINGS: Final = frozenset(f".{kind}" for kind in _KINDS.split(" "))  #: Endings of files: what ends so is no folder.


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


def require_ending(output: Path, allowed: Sequence[str], what: str) -> Path:
    """Return the path of an output file; refuse an ending that says another kind of file.

    Raises
    ------
    DataError
        The name has an ending, and it is none of those allowed.
    """
    if output.suffix and output.suffix.lower() not in allowed:
        raise DataError(f"{output}: {what}; give a name that ends in {' or '.join(allowed)}")
    return output


def refuse_file_ending(folder: Path, what: str) -> Path:
    """Return the path of an output folder; refuse a name that ends as a file's does.

    Raises
    ------
    DataError
        The name ends in one of :data:`FILE_ENDINGS`.
    """
    if folder.suffix.lower() in FILE_ENDINGS:
        raise DataError(f"{folder}: {what} is a folder; give a name without {folder.suffix}, e.g. {folder.with_suffix('')}")
    return folder


def require_folder(output: Path) -> None:
    """Refuse an output whose folder does not exist or cannot be written to.

    Raises
    ------
    DataError, OSError
        The folder is missing; the system would refuse to write there.
    StorageError
        The folder takes no files, as those of ``/proc``.
    """
    if not output.parent.is_dir():
        raise DataError(f"{output}: the folder {output.parent} does not exist; make it first")
    _require_writable(output.parent, output)


def _require_writable(folder: Path, output: Path) -> None:
    """Refuse a folder in which no file can be made; ``output`` is named."""
    if not os.access(folder, os.W_OK):
        raise OSError(errno.EACCES, os.strerror(errno.EACCES), str(folder))
    try:  # rights alone do not tell: of some folders the system refuses files to everybody
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        if error.errno not in (errno.ENOENT, errno.ENOTSUP, errno.EINVAL, errno.ENOSYS, errno.ENOTDIR):
            raise  # room or rights, which have words for them
        raise StorageError(f"{output}: the folder {folder} cannot be written to; {ELSEWHERE}") from error


def made_folder(folder: Path, remedy: str = ELSEWHERE) -> Path:
    """Return the path of an output folder, made where it is missing; refuse one that takes no files.

    Raises
    ------
    DataError
        A file has this name.
    StorageError
        The folder cannot be made, or not be written to.
    """
    above = next((parent for parent in (folder, *folder.absolute().parents) if parent.exists()), folder)
    with storage_errors(folder, remedy):
        if not above.is_dir():
            raise DataError(f"{folder}: {'' if above == folder else f'{above} '}is a file; give the name of a folder")
        _require_writable(above, folder)
        folder.mkdir(parents=True, exist_ok=True)
    return folder


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
