"""Folder of compiled kernels, named by a digest of the syntax of all their sources, and turns of processes that compile them.

Numba checks the file of the function that it loads, not the files of the kernels that this function calls: after a change of these alone
it would run old physics. Here any change of the syntax of a kernel's file leads to another folder; comments, docstrings and layout do not
count.
"""

from __future__ import annotations

import ast
import hashlib
import json
import os
import shutil
import tempfile
import time
import zlib
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Final

from seaglint.base.machine import cache_folder


def syntax_text(node: object, without: tuple[type[ast.AST], ...] = ()) -> str:
    r"""Return a syntax tree as text, equal for all versions of Python.

    Parameters
    ----------
    node : ast.AST
        Tree or part of one.
    without : tuple of types
        Kinds of nodes that are omitted, besides docstrings.

    Returns
    -------
    str
        Names of nodes with their fields; fields without content are omitted, because versions of Python differ in them.

    Examples
    --------
    >>> syntax_text(ast.parse("x = 1  # one")) == syntax_text(ast.parse("'''A number.'''\nx = 1"))
    True
    """
    match node:
        case None | ast.Expr(value=ast.Constant()):
            return ""
        case ast.AST():
            if isinstance(node, without):
                return ""
            fields = ((name, syntax_text(value, without)) for name, value in ast.iter_fields(node))
            return f"{type(node).__name__}({','.join(f'{name}={text}' for name, text in fields if text)})"
        case []:
            return ""
        case list():
            texts = ("-" if one is None else syntax_text(one, without) for one in node)
            return "[" + ",".join(text for text in texts if text) + "]"
    return repr(node)


def syntax_digest(source: bytes) -> str:
    """Return a digest of the syntax of a Python source, without comments, docstrings and layout [20 hexadecimal digits]."""
    return hashlib.blake2b(syntax_text(ast.parse(source)).encode(), digest_size=10).hexdigest()


try:
    import fcntl
except ImportError:  # Windows: processes that start at the same time compile separately
    fcntl = None  # type: ignore[assignment]

PACKAGE: Final = Path(__file__).parents[1]

PREFIX: Final = "seaglint-kernels-"

#: Packages with all files in the digest: their plain functions may become kernels elsewhere.
ROOMS: Final = ("optics", "sea", "air", "facet", "radiance", "imaging", "objects", "clutter", "detection")

MOST_FOLDERS: Final = 5  #: Number of folders of other source versions, such as other branches, that are not removed.

IN_USE: Final = 86400.0  #: Time from its start during which a program may still compile [s]; its folder is not removed meanwhile.

#: Longest wait for another process that compiles the same function [s]; after it this process compiles the function too.
TURN: Final = 600.0


def sources_digest(package: Path = PACKAGE) -> str:
    """Return a digest of all sources of compiled kernels: physics, files that import ``base.jit`` or define tuples, and constants.

    Comments, docstrings and layout do not enter. A file is parsed once: ``_known_digests`` reads digests of earlier processes.
    """
    # without pathlib: its walk through some hundred files takes longer than reading them
    root, paths = str(package), []
    for folder, folders, names in os.walk(root):
        folders[:] = [name for name in folders if name != "__pycache__"]
        paths += [os.path.join(folder, name) for name in names if name.endswith(".py")]
    known, used = _known_digests(), dict[str, str]()
    digest = hashlib.blake2b(digest_size=10)
    for path in sorted(paths):
        with open(path, "rb") as file:
            content = file.read()
        name = path[len(root) + 1 :].replace(os.sep, "/")
        if (
            name.split("/")[0] in ROOMS
            or b"base.jit import" in content
            or b"(NamedTuple)" in content
            or name in ("base/jit.py", "base/kernel_bodies.py", "base/constants.py")
        ):
            exact = hashlib.blake2b(content, digest_size=16).hexdigest()
            used[exact] = known.get(exact) or syntax_digest(content)
            digest.update(f"{name}\n{used[exact]}\n".encode())
    if not used.keys() <= known.keys():
        _write_digests(used)
    return digest.hexdigest()


#: File of syntax digests of sources by digests of their bytes, since parsing takes a second or two. Its name has a digest of this module.
DIGESTS: Final = f"syntax-digests-{hashlib.blake2b(Path(__file__).read_bytes(), digest_size=4).hexdigest()}.json"


def _known_digests() -> dict[str, str]:
    """Return the digests that an earlier process wrote; empty without a file, or for a damaged one."""
    for parent in _parents(""):
        with suppress(OSError, ValueError):
            content = json.loads((parent / DIGESTS).read_bytes())
            return {str(exact): str(digest) for exact, digest in content.items()} if isinstance(content, dict) else {}
    return {}


def _write_digests(digests: dict[str, str]) -> None:
    """Write digests as a whole into the first folder that can be written, or not at all."""
    for parent in _parents(""):
        partial = parent / f"{DIGESTS}.{os.urandom(4).hex()}"
        try:
            parent.mkdir(parents=True, exist_ok=True)
            partial.write_text(json.dumps(digests))
            os.replace(partial, parent / DIGESTS)
        except OSError:
            with suppress(OSError):
                partial.unlink()
        else:
            return


@cache
def kernel_folder(requested: str = "") -> Path | None:
    """Return the folder of compiled kernels, created if necessary; None if no folder is writable.

    It is in the folder ``requested`` (``NUMBA_CACHE_DIR``), else in the user's cache, which all copies of the package share, else in the
    ``__pycache__`` of the package, else among temporary files. Several processes may call this at once: no lock is used, as a folder is
    only created or moved as a whole.
    """
    name = PREFIX + sources_digest()
    for parent in _parents(requested):
        folder = parent / name
        try:
            parent.mkdir(parents=True, exist_ok=True)
            new = not folder.is_dir()
            folder.mkdir(exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
            os.utime(folder)  # in use from now on
        except OSError:
            if any(folder.glob("*.nbi")):  # a read-only image or shared disk; each process compiles functions that are not in it
                return folder
            continue
        if new:
            remove_old(folder)
        return folder
    return None


def _parents(requested: str) -> Iterator[Path]:
    """Return candidate parent folders, in order of preference."""
    if requested:
        yield Path(requested).absolute()
    with suppress(RuntimeError):  # an account without a home
        yield cache_folder() / "kernels"
    yield PACKAGE / "__pycache__"
    with suppress(OSError):
        yield _own_temporary()


def _own_temporary() -> Path:
    """Return a temporary folder that no other user can write to, because files loaded from it are executed.

    Raises
    ------
    PermissionError
        Another account owns the folder.
    """
    if not hasattr(os, "getuid"):
        return Path(tempfile.gettempdir()) / "seaglint"  # of this account alone on Windows
    folder = Path(tempfile.gettempdir()) / f"seaglint-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    status = folder.lstat()
    if status.st_uid != os.getuid() or status.st_mode & 0o077 or folder.is_symlink():
        raise PermissionError(f"{folder} is open to other accounts")
    return folder


def remove_old(present: Path) -> None:
    """Remove folders of other source versions, except the last ``MOST_FOLDERS`` and those used within a day."""
    used: list[tuple[float, Path]] = []
    for folder in present.parent.glob(f"{PREFIX}*"):
        with suppress(OSError):  # another process was quicker
            if folder != present:
                used.append((folder.stat().st_mtime, folder))
    for when, folder in sorted(used, reverse=True)[MOST_FOLDERS:]:
        if time.time() - when > IN_USE:
            gone = folder.with_name(f"{folder.name[: len(PREFIX) + 20]}.{os.urandom(4).hex()}")
            with suppress(OSError):
                folder.rename(gone)  # at once for all processes; a new process creates a new folder
                shutil.rmtree(gone)


@cache
def _turns(folder: Path) -> int | None:
    """Return the open lock file with one byte for each function, locked while a process compiles it; it is open while this process lives.

    It has the ending of Numba's index files, so that it is removed together with them.
    """
    try:
        return os.open(folder / "compiling.nbi", os.O_RDWR | os.O_CREAT, 0o666)
    except OSError:
        return None


def _byte(function: str) -> int:
    return zlib.crc32(function.encode()) >> 1


def can_wait() -> bool:
    """Return True if files can be locked on this system, so that processes wait for each other."""
    return fcntl is not None


def try_turn(folder: Path, function: str) -> bool:
    """Take the turn of a function if no other process has it; return True if it was taken."""
    file = _turns(folder)
    if fcntl is None or file is None:
        return False
    try:
        fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, _byte(function))
    except OSError:
        return False
    return True


def take_turn(folder: Path, function: str) -> None:
    """Wait until no other process compiles a function.

    The system releases the lock when its process ends for any reason. Where files cannot be locked, no process waits: each compiles
    separately, which only takes longer.
    """
    file, until, pause = _turns(folder), time.monotonic() + TURN, 0.01
    while fcntl is not None and file is not None and time.monotonic() < until:
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, _byte(function))
        except (BlockingIOError, PermissionError):
            time.sleep(pause)
            pause = min(1.5 * pause, 0.25)
        except OSError:
            return
        else:
            return


def end_turn(folder: Path, function: str) -> None:
    """Release the lock of a function, so that the next process may compile or load it."""
    file = _turns(folder)
    if fcntl is not None and file is not None:
        with suppress(OSError):
            fcntl.lockf(file, fcntl.LOCK_UN, 1, _byte(function))
