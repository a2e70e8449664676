"""Files of commands: outputs that are checked before the work and written completely or not at all, and readers of text and JSON.

Errors of the operating system and of libraries are reported in one line with a remedy. Signals end long work between two of its pieces,
not in the middle of one.
"""

from __future__ import annotations

import errno
import json
import os
import secrets
import signal
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Any, Final

from seaglint.base.errors import DataError, SeaglintError, StorageError

_FULL: Final = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})
_DENIED: Final = frozenset({errno.EACCES, errno.EPERM, errno.EROFS})
_GONE: Final = frozenset({errno.ENOENT, errno.ENOTDIR, errno.ESTALE})


def _system_error(error: BaseException | None) -> OSError | None:
    """Return the ``OSError`` behind an exception: itself, a member of a group, or the cause."""
    if error is None or isinstance(error, OSError):
        return error
    if isinstance(error, BaseExceptionGroup):
        return next((cause for inner in error.exceptions if (cause := _system_error(inner))), None)
    return _system_error(error.__cause__ or error.__context__)


@contextmanager
def storage_errors(target: object, remedy: str | Callable[[], str]) -> Iterator[None]:
    """Turn errors of the operating system into a ``StorageError``, with ``remedy`` where room or rights are missing.

    A remedy that depends on the state of the disk at the time of the error is a function.
    """
    try:
        yield
    except SeaglintError:
        raise
    except Exception as error:
        system = _system_error(error)
        if system is None:
            raise
        raise StorageError(f"{target}: {_sentence(system, remedy if isinstance(remedy, str) else remedy())}") from error


def reason_of(error: BaseException, most: int = 200) -> str:
    r"""Return the text of an exception of a library in one line of at most so many characters; its type where it has no text.

    >>> reason_of(ValueError("no\n  header")), reason_of(KeyError())
    ('no header', 'KeyError')
    """
    return " ".join(str(error).split())[:most] or type(error).__name__


@contextmanager
def library_errors(what: str, remedy: str, kind: type[SeaglintError] = DataError) -> Iterator[None]:
    """Turn exceptions of a library, which are of nearly any type at a damaged file, into an error ``what (reason); remedy``.

    Errors of seaglint pass unchanged.
    """
    try:
        yield
    except SeaglintError:
        raise
    except Exception as error:
        raise kind(f"{what} ({reason_of(error)}); {remedy}") from error


def is_full(error: BaseException) -> bool:
    """Return true for an error that was caused by missing room: a full disk, a quota or a limit of file sizes."""
    system = _system_error(error)
    # NumPy's tofile reports that fewer numbers were written and not the reason; a full disk is the only common one.
    return system is not None and (system.errno in _FULL or (system.errno is None and "requested and" in str(system)))


def _sentence(error: OSError, remedy: str) -> str:
    if is_full(error):
        return f"no room left (disk full, or over the quota or file size limit); {remedy}"
    if error.errno in _DENIED:
        return f"no right to write there; {remedy}"
    if error.errno == errno.ENAMETOOLONG:
        return "a name in it is too long for this file system; choose a shorter one"
    reason = error.strerror or str(error)
    what = f"{reason}: {error.filename}" if error.filename else reason
    if error.errno in _GONE:
        return f"something was moved or removed while it was written ({what}); see that no other program works there and run again"
    return f"writing failed ({what}); see to the disk or choose another place"


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
        The folder is missing, the name belongs to a folder, device or pipe or to one of the ``inputs``, or a file exists and
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
    """Return the path of an output file; refuse the ending of another kind of file.

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
        The name ends in one of ``FILE_ENDINGS``.
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
        The folder takes no files, as folders of ``/proc``.
    """
    if not output.parent.is_dir():
        raise DataError(f"{output}: the folder {output.parent} does not exist; make it first")
    _require_writable(output.parent, output)


def _require_writable(folder: Path, output: Path) -> None:
    """Refuse a folder in which no file can be made; ``output`` is named."""
    if not os.access(folder, os.W_OK):
        raise OSError(errno.EACCES, os.strerror(errno.EACCES), str(folder))
    try:  # rights alone do not decide: in some folders the system refuses files to everybody
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        if error.errno not in (errno.ENOENT, errno.ENOTSUP, errno.EINVAL, errno.ENOSYS, errno.ENOTDIR):
            raise  # room or rights, for which storage_errors has texts
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
def moved_when_whole(
    output: Path, remedy: str = "make room or choose another place; nothing was written", *, several: bool = False
) -> Iterator[Path]:
    """Provide a temporary name, ``output`` with ``.partial`` added; it replaces ``output`` on success and is removed otherwise.

    With ``several``, processes may write the same content at the same time: each has a random text in its temporary name.

    Raises
    ------
    DataError
        One of the two names belongs to a folder, device or pipe.
    StorageError
        No room or no rights; it ends with ``remedy``.
    """
    partial = output.with_name(f"{output.name}.{secrets.token_hex(8)}.partial" if several else f"{output.name}.partial")
    with storage_errors(output, remedy):
        for path in (output, partial):
            _require_replaceable(path)
    try:
        with storage_errors(output, remedy):
            yield partial
            partial.replace(output)
    finally:
        with suppress(OSError):  # a read-only file system refuses even to remove a missing file
            partial.unlink(missing_ok=True)


def _require_replaceable(path: Path) -> None:
    """Refuse devices and pipes: moving a file there would replace the node, for every program of the machine."""
    if path.is_dir():
        raise DataError(f"{path}: is a folder; give the name of a file")
    if path.exists() and not path.is_file():
        raise DataError(f"{path}: is a device, pipe or socket, which is never replaced; give the name of a file")


#: Lists of all nested work, pieces last: a signal in a piece ends the whole too, and a piece that begins after it ends at once.
_listening: Final[list[list[int]]] = []


@contextmanager
def stop_on_signal(*, at_once: bool = False) -> Iterator[list[int]]:
    """Provide a list that gets an entry on the first SIGINT or SIGTERM; a second signal interrupts at once, the first if so requested."""
    caught = _listening[-1].copy() if _listening else list[int]()
    if threading.current_thread() is not threading.main_thread():
        yield caught  # signals reach the main thread only
        return

    def note(number: int, _: FrameType | None) -> None:
        for noted in _listening:
            noted.append(number)
        if at_once or len(caught) > 1:
            raise KeyboardInterrupt

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    _listening.append(caught)
    try:
        yield caught
    finally:
        _listening.pop()
        for number, handler in before.items():
            signal.signal(number, handler)


def read_text(path: Path, hint: str) -> str:
    """Return the text of a file in UTF-8, with its line ends and without the mark that some programs put at the beginning.

    Raises
    ------
    DataError
        The file is missing, cannot be read or is no text; the message ends with ``hint``, the remedy.
    """
    try:
        return path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise DataError(f"{path}: no such file; {hint}") from None
    except UnicodeDecodeError as error:
        raise DataError(f"{path}: is not UTF-8 text (byte {error.start}); {hint}") from None
    except OSError as error:
        raise DataError(f"{path}: cannot be read ({error.strerror}); {hint}") from None


def read_json(path: Path, hint: str) -> Any:
    """Return the value that a JSON file holds.

    Raises
    ------
    DataError
        As ``read_text``, and for a text that is no JSON or is cut.
    """
    return parsed_json(path, read_text(path, hint), hint)


def parsed_json(path: Path, text: str, hint: str) -> Any:
    """Return the value of a JSON text that was read from a file.

    Raises
    ------
    DataError
        It is no JSON, or is cut.
    """
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        at = f"line {error.lineno}: {error.msg}" if isinstance(error, json.JSONDecodeError) else "a number or its nesting is too long"
        raise DataError(f"{path}: is no JSON, or is cut short ({at}); {hint}") from None


def write_text(text: str, output: Path) -> None:
    """Write a text in UTF-8 with unchanged line ends.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    with moved_when_whole(output) as partial:
        partial.write_bytes(text.encode())


def json_text(value: Any, *, indent: int | None = 2) -> str:
    """Return a value as JSON, without the NaN that JSON does not know."""
    return json.dumps(value, indent=indent, ensure_ascii=False, allow_nan=False)


def write_json(value: Any, output: Path, *, indent: int | None = 2) -> None:
    """Write a value as JSON.

    Raises
    ------
    StorageError
        No room or no rights; nothing is left behind.
    """
    write_text(json_text(value, indent=indent) + "\n", output)
