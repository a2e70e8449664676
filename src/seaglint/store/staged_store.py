"""Zarr stores whose files are written in a stage: moved at once by the holder of a claim, or kept there by a worker for its sender.

The stores of Zarr itself make all missing folders above a file, and would bring back a store that was moved or removed.
"""

from __future__ import annotations

import asyncio
import os
import shutil
from contextlib import suppress
from pathlib import Path
from typing import Any, Self
from urllib.parse import quote

from zarr.abc.store import ByteRequest
from zarr.core.buffer import Buffer, BufferPrototype
from zarr.storage import LocalStore

from seaglint.store.staging import best_attempt, move, token


class StagedStore(LocalStore):
    """Zarr store in a folder that exists; each file is written in a stage and then moved, and a removed one is moved there."""

    def __init__(self, root: Path, stage: Path, *, read_only: bool = False) -> None:
        super().__init__(root, read_only=read_only)
        self.stage = stage

    def with_read_only(self, read_only: bool = False) -> Self:
        """Return the store with or without the right to write."""
        return type(self)(self.root, self.stage, read_only=read_only)

    async def _open(self, *, mode: Any = None) -> None:
        self._ensure_open_sync()

    def _ensure_open_sync(self) -> None:
        if not self.root.exists():
            raise FileNotFoundError(f"{self.root} does not exist")
        self._is_open = True

    async def set(self, key: str, value: Buffer) -> None:
        """Write a file."""
        await asyncio.to_thread(self.set_sync, key, value)

    async def set_if_not_exists(self, key: str, value: Buffer) -> None:
        """Write a file where none exists; the holder of a claim is the only writer."""
        if not await self.exists(key):
            await self.set(key, value)

    async def delete(self, key: str) -> None:
        """Remove a file."""
        await asyncio.to_thread(self.delete_sync, key)

    def set_sync(self, key: str, value: Buffer) -> None:
        """Write a file."""
        self._check_writable()
        path = self.root / key
        # The first folder that is missing is moved together with the file.
        first = path
        while first.parent != self.root and not first.parent.is_dir():
            first = first.parent
        fresh = self.stage / token()
        _write(fresh, path.relative_to(first).parts, value)
        move(fresh, first)

    def delete_sync(self, key: str) -> None:
        """Remove a file."""
        self._check_writable()
        path = self.root / key
        if path.exists():
            os.replace(path, self.stage / token())


def _write(folder: Path, parts: tuple[str, ...], value: Buffer) -> None:
    """Write the file ``folder/parts``, in folders that are made below ``folder.parent`` alone."""
    file = folder
    for part in parts:
        file.mkdir(exist_ok=True)
        file /= part
    with file.open("xb") as stream:
        stream.write(value.as_buffer_like())


class UnitStore(StagedStore):
    """Store of a worker, which reads the frames of a sequence and writes one unit after the other into the stage of another process.

    A unit has a folder in the stage, and each attempt a folder in it, with a part for each array: the chunk's file or folder, by its
    quoted path in the store. A chunk that is to be removed, since it has the fill value alone, is an empty file with ``-`` before its
    name. The name of a complete attempt begins with its number of frames.
    """

    unit: Path  #: Folder of the current unit's attempts.
    fresh: Path  #: Folder of the current attempt, until it is complete.
    earlier: Path | None = None  #: Most complete earlier attempt, from which frames are read first.

    def begin(self, unit: int) -> None:
        """Begin an attempt of a unit; nothing is made before its first chunk is written."""
        self.unit = self.stage / str(unit)
        self.fresh = self.unit / f"{token()}.new"
        self.earlier = best_attempt(self.unit)

    def end(self, frames: int) -> str:
        """Give the attempt its name; return it relative to the stage, and the earlier one's where nothing was written."""
        whole = self.unit / f"{frames:06d}-{self.fresh.stem}"
        try:
            self.fresh.rename(whole)
        except FileNotFoundError:
            return "" if self.earlier is None else f"{self.unit.name}/{self.earlier.name}"
        return f"{self.unit.name}/{whole.name}"

    def abandon(self) -> None:
        """Remove the attempt."""
        shutil.rmtree(self.fresh, ignore_errors=True)
        with suppress(OSError):
            self.unit.rmdir()

    def set_sync(self, key: str, value: Buffer) -> None:
        """Write a chunk into the attempt."""
        self._make()
        head, *rest = _part(key)
        _write(self.fresh / head, tuple(rest), value)

    def delete_sync(self, key: str) -> None:
        """Note in the attempt that a chunk has the fill value alone."""
        if (self.root / key).exists():
            self._make()
            (self.fresh / f"-{quote(key, safe='')}").touch()

    def _make(self) -> None:
        self.unit.mkdir(exist_ok=True)
        self.fresh.mkdir(exist_ok=True)

    async def get(self, key: str, prototype: BufferPrototype | None = None, byte_range: ByteRequest | None = None) -> Buffer | None:
        """Return a file of the earlier attempt, or of the store."""
        if self.earlier is not None and "c" in key.split("/"):
            with suppress(FileNotFoundError):  # it may have been moved into the store by now
                found = await LocalStore(self.earlier, read_only=True).get("/".join(_part(key)), prototype, byte_range)
                if found is not None:
                    return found
        return await super().get(key, prototype, byte_range)

    def get_sync(self, key: str, *, prototype: BufferPrototype | None = None, byte_range: ByteRequest | None = None) -> Buffer | None:
        """Return a file of the earlier attempt, or of the store."""
        if self.earlier is not None and "c" in key.split("/"):
            with suppress(FileNotFoundError):
                earlier = LocalStore(self.earlier, read_only=True)
                found = earlier.get_sync("/".join(_part(key)), prototype=prototype, byte_range=byte_range)
                if found is not None:
                    return found
        return super().get_sync(key, prototype=prototype, byte_range=byte_range)


def _part(key: str) -> list[str]:
    """Return the name in an attempt of the part to which a chunk belongs, and the rest of its path.

    >>> _part("radiance/c/3/0/0"), _part("frame_done/c/3")
    (['radiance%2Fc%2F3', '0', '0'], ['frame_done%2Fc%2F3'])
    """
    parts = key.split("/")
    size = parts.index("c") + 2
    return [quote("/".join(parts[:size]), safe=""), *parts[size:]]
