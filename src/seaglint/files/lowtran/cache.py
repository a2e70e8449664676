"""Cache of LOWTRAN7's results on disk, each named by its inputs and with a checksum.

Deleting the folder costs computing time and nothing else.
"""

from __future__ import annotations

import hashlib
import io
import logging
import secrets
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.user_cache import cache_folder

_MAGIC = b"seaglint lowtran7 1\n"

log = logging.getLogger(__name__)


def key_of(*parts: str) -> str:
    """Return the name of a result: a digest of the texts that determine it."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part.encode()).digest())
    return digest.hexdigest()[:32]


def entry(key: str) -> Path:
    """Return the file of a result."""
    return cache_folder() / "lowtran7" / "results" / f"{key}.bin"


def fetch(key: str) -> dict[str, FloatArray] | None:
    """Return the cached arrays of a key; None where there are none. A damaged file is logged, removed and counts as none."""
    path = entry(key)
    try:
        content = path.read_bytes()
    except OSError:
        return None
    head, body = content[: len(_MAGIC) + 32], content[len(_MAGIC) + 32 :]
    if head == _MAGIC + hashlib.sha256(body).digest():
        with np.load(io.BytesIO(body), allow_pickle=False) as archive:
            return dict(archive)
    log.warning("seaglint: %s is damaged (checksum); it is removed and LOWTRAN7 runs again", path)
    with suppress(OSError):
        path.unlink()
    return None


def keep(key: str, arrays: Mapping[str, FloatArray]) -> None:
    """Write arrays to the cache; where that fails, one line is logged and nothing is cached."""
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)  # type: ignore[arg-type]  # the stubs take allow_pickle for one of the arrays
    body, path = buffer.getvalue(), entry(key)
    partial = path.with_name(f"{path.name}.{secrets.token_hex(4)}.partial")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        partial.write_bytes(_MAGIC + hashlib.sha256(body).digest() + body)
        partial.replace(path)
    except OSError as error:
        log.warning("seaglint: %s was not kept (%s); set SEAGLINT_CACHE to a folder with room", path, error.strerror)
    finally:
        with suppress(OSError):
            partial.unlink(missing_ok=True)
