"""Random streams that are a function of (seed, purpose): same seed, same bytes, whatever the threads or the order."""

from __future__ import annotations

import zlib

import numpy as np


def stream(seed: int, purpose: str, *indices: int) -> np.random.Generator:
    """Independent generator for one purpose, e.g. ``stream(seed, "waves", tile)``.

    The purpose is hashed (CRC-32) into the spawn key of a :class:`numpy.random.SeedSequence`, so streams of different
    purposes never meet and adding one leaves the others as they were. The bit generator is Philox, named because NumPy
    may change its default.
    """
    # Not as further words of the entropy: those are padded with zeros, which makes (7, "waves") and (7, "waves", 0) one stream.
    key = (zlib.crc32(purpose.encode()), *indices)
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(seed, spawn_key=key)))
