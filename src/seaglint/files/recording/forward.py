"""Frames that can only be decoded in order: of videos and animations."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seaglint.base.errors import DataError


class ForwardFrames:
    """Decoder of frames in order; a request for earlier ones starts again.

    Parameters
    ----------
    path : Path
        The file, for messages.
    decode : callable
        ``decode()`` iterates over the frames from the first on.
    """

    def __init__(self, path: Path, decode: Callable[[], Iterator[NDArray[Any]]]) -> None:
        self._path, self._decode, self._next = path, decode, 0
        self._frames: Iterator[NDArray[Any]] = iter(())

    def read(self, start: int, stop: int) -> NDArray[Any]:
        """Return frames ``start`` to ``stop``.

        Raises
        ------
        DataError
            The file ends before, or its frames differ in shape.
        """
        if start < self._next or self._next == 0:
            self._next, self._frames = 0, self._decode()
        block: list[NDArray[Any]] = []
        while self._next < stop:
            frame = next(self._frames, None)
            if frame is None:
                raise DataError(f"{self._path}: ends after frame {self._next}, {stop} were announced; the file is cut")
            if self._next >= start:
                block.append(frame)
            self._next += 1
        if any(frame.shape != block[0].shape for frame in block):
            raise DataError(f"{self._path}: some of its frames are grey and some in colour; write them as grey pictures")
        return np.stack(block)
