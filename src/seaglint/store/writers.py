"""Writers of a folder: claims, which end with the process however that ends, and shares of a sequence for batch arrays.

A claim is a lock of the operating system on a file beside the folder. It is not inside: the folder may be emptied, is renamed when whole,
and every file in it counts as part of the store. A killed process leaves the file but not the lock. On a file system without locks, the
random token in the file shows the earlier writer that another one has claimed the folder.

Each share has its own units, without a scheduler.
"""

from __future__ import annotations

import os
import re
import secrets
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from seaglint.base.errors import DataError


class BeingWrittenError(DataError):
    """Error of a folder that another process is writing."""


@dataclass(frozen=True)
class Claim:
    """Claim of a writer on the folder that it writes."""

    folder: Path  #: Claimed folder.
    token: str  #: Random text that no other claim has.

    def holds(self) -> bool:
        """Return true while the file beside the folder still carries this claim's token."""
        try:
            return lock_path(self.folder).read_text(encoding="ascii").split()[1:] == [self.token]
        except (FileNotFoundError, ValueError):  # removed, or overwritten with what is not text
            return False

    def require(self) -> None:
        """Raise an error if another process has taken the folder.

        Raises
        ------
        DataError
            The claim is gone.
        """
        if not self.holds():
            raise DataError(
                f"{self.folder}: another process has taken it, or {lock_path(self.folder).name} was removed; "
                "see that only one process writes there and go on with resume=True"
            )


def lock_path(folder: Path) -> Path:
    """Return the file that carries the claim on a folder."""
    return folder.with_name(folder.name + ".lock")


@contextmanager
def exclusive(folder: Path, patience: float = 0.0) -> Iterator[Claim]:
    """Claim a folder, which need not exist yet, for the duration of the context.

    Parameters
    ----------
    folder : Path
    patience : float
        Longest time to wait for another process's claim [s].

    Raises
    ------
    BeingWrittenError
        Another process holds it.
    OSError
        The file beside the folder cannot be written.
    """
    path = lock_path(folder)
    descriptor = _open_locked(folder, path, _lock, patience)
    claim = Claim(folder, secrets.token_hex(16))
    try:
        try:
            os.ftruncate(descriptor, 0)
            os.write(descriptor, f"{os.getpid()} {claim.token}\n".encode("ascii"))
        except OSError:
            with suppress(OSError):  # a full disk: the file is ours, and empty
                path.unlink()
            raise
        yield claim
    finally:
        _release(descriptor, claim)


@contextmanager
def shared(folder: Path, patience: float = 5.0) -> Iterator[None]:
    """Claim a folder together with other shared claims; exclusive claims are refused, and refuse shared ones.

    Raises
    ------
    BeingWrittenError
        Another process has held it alone for ``patience`` seconds.
    OSError
        The file beside the folder cannot be made.
    """
    path = lock_path(folder)
    descriptor = _open_locked(folder, path, _lock_shared, patience)
    try:
        yield
    finally:
        # The last writer removes the file. One that cannot lock it alone is not the last.
        try:
            if _lock(descriptor) and _has_name(descriptor, path):
                with suppress(OSError):
                    path.unlink()
        finally:
            os.close(descriptor)


def _open_locked(folder: Path, path: Path, lock: Callable[[int], bool], patience: float) -> int:
    """Open and lock the file; check that it still has the name, since its last owner may have removed it in between."""
    until = time.monotonic() + patience
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            free = lock(descriptor)
            owner = b"" if free else os.read(descriptor, 100)
            current = free and _has_name(descriptor, path)
        except BaseException:
            os.close(descriptor)
            raise
        if current:
            return descriptor
        os.close(descriptor)
        if not free and time.monotonic() < until:
            time.sleep(0.02)
        elif not free:
            pid = owner.split(maxsplit=1)[:1]
            known = f" (pid {pid[0].decode('ascii', 'replace')})" if pid else ""
            raise BeingWrittenError(f"{folder}: is being written by another process{known}; wait for it or choose another name")


def _has_name(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), path.stat())
    except FileNotFoundError:
        return False


if sys.platform == "win32":
    import msvcrt

    def _lock(descriptor: int) -> bool:
        """Lock a byte far behind the text, which others must be able to read; return false when another process holds it."""
        os.lseek(descriptor, 1 << 30, os.SEEK_SET)
        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        finally:
            os.lseek(descriptor, 0, os.SEEK_SET)
        return True

    def _lock_shared(descriptor: int) -> bool:
        """Lock exclusively, since this system lacks shared locks: parts are written one after the other."""
        return _lock(descriptor)

    def _release(descriptor: int, claim: Claim) -> None:
        os.close(descriptor)
        with suppress(OSError):  # an open file cannot be removed here: the next owner has it already
            lock_path(claim.folder).unlink()

else:
    import fcntl

    def _lock(descriptor: int) -> bool:
        """Lock the file; return false when another process holds it. Without locks of the file system the token alone decides."""
        return _flock(descriptor, fcntl.LOCK_EX)

    def _lock_shared(descriptor: int) -> bool:
        return _flock(descriptor, fcntl.LOCK_SH)

    def _flock(descriptor: int, kind: int) -> bool:
        try:
            fcntl.flock(descriptor, kind | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        except OSError:
            return True  # some network file systems
        return True

    def _release(descriptor: int, claim: Claim) -> None:
        # Removed while locked. Where locks are missing, a later owner may have put its token into the same file, which then stays.
        try:
            with suppress(OSError):  # what is left behind blocks nobody
                if claim.holds():
                    lock_path(claim.folder).unlink()
        finally:
            os.close(descriptor)


@dataclass(frozen=True)
class Share:
    """Units ``index``, ``index + count``, ... of a sequence."""

    index: int  #: Index of the share, counted from 0.
    count: int

    @classmethod
    def parse(cls, text: str) -> Share:
        """Parse a text ``i/n``.

        >>> Share.parse("2/7")
        Share(index=2, count=7)

        Raises
        ------
        DataError
            Another form, or a share that is not there.
        """
        match = re.fullmatch(r"\s*(\d{1,9})\s*/\s*(\d{1,9})\s*", text)
        if match is None or not int(match[1]) < int(match[2]):
            raise DataError(f"shard='{text}' is no share of the work; give i/n, counted from 0: the first of four is 0/4, the last 3/4")
        return cls(int(match[1]), int(match[2]))

    def __str__(self) -> str:
        return f"{self.index}/{self.count}"

    def units(self, count: int) -> range:
        """Return the share's units of ``count``; none where there are fewer units than shares.

        >>> list(Share(1, 2).units(5)), list(Share(6, 7).units(5))
        ([1, 3], [])
        """
        return range(self.index, count, self.count)


def shares_of(units: Iterable[int], counts: Iterable[int]) -> str:
    """Return as text the shares to which units belong, where the work was divided into ``counts`` shares.

    >>> shares_of([1, 3, 4], [2])
    '0/2, 1/2'
    """
    numbers = sorted(set(units))
    return ", ".join(str(Share(i, n)) for n in counts for i in sorted({unit % n for unit in numbers}))
