"""Random streams as functions of (seed, purpose): equal seeds have equal bytes, for any number of threads and any order."""

from __future__ import annotations

import zlib

import numpy as np


def stream(seed: int, purpose: str, *indices: int) -> np.random.Generator:
    """Return an independent generator for one purpose, e.g. ``stream(seed, "waves", tile)``.

    The purpose is hashed (CRC-32) into the spawn key of a :class:`numpy.random.SeedSequence`, so streams of different
    purposes are independent, and a new purpose does not change other streams. The bit generator is Philox, named because NumPy
    may change its default.
    """
    # not as further words of the entropy: those are padded with zeros, which makes (7, "waves") and (7, "waves", 0) one stream
    key = (zlib.crc32(purpose.encode()), *indices)
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(seed, spawn_key=key)))
