"""The operating system's refusals, told in one line with what to do."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from seaglint.errors import StorageError

_FULL: Final = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})
_DENIED: Final = frozenset({errno.EACCES, errno.EPERM, errno.EROFS})


def _system_error(error: BaseException | None) -> OSError | None:
    """The ``OSError`` behind an exception: itself, a member of a group, or the cause."""
    if error is None or isinstance(error, OSError):
        return error
    if isinstance(error, BaseExceptionGroup):
        return next((found for inner in error.exceptions if (found := _system_error(inner))), None)
    return _system_error(error.__cause__ or error.__context__)


@contextmanager
def storage_errors(target: object, remedy: str) -> Iterator[None]:
    """Turn a full disk, a quota or missing rights into a :class:`StorageError` that ends with ``remedy``."""
    try:
        yield
    except Exception as error:
        system = _system_error(error)
        if system is None:
            raise
        if system.errno in _FULL:
            reason = "no room left (disk full, or over the quota or file size limit)"
        elif system.errno in _DENIED:
            reason = "no right to write there"
        else:
            reason = system.strerror or str(system)
        raise StorageError(f"{target}: {reason}; {remedy}") from error
