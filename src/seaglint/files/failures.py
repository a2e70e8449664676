"""Errors of the operating system, reported in one line with a remedy."""

from __future__ import annotations

import errno
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

from seaglint.base.errors import SeaglintError, StorageError

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
    """Turn errors of the operating system into a :class:`StorageError`, with ``remedy`` where room or rights are missing.

    A remedy that depends on what is on the disk by then is a function.
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


def _sentence(error: OSError, remedy: str) -> str:
    # NumPy's tofile tells that fewer numbers were written, not why; there is no other common reason.
    if error.errno in _FULL or (error.errno is None and "requested and" in str(error)):
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
