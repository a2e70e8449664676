"""A quick start of the program: what its libraries do at the start for the sake of others is put off."""

from __future__ import annotations

import atexit
import gc
import sys
from contextlib import suppress
from typing import Any, Final

#: Containers made before memory is first searched for circles: a command's imports make 250,000 to 450,000, nearly all of which stay.
OBJECTS: Final = 600_000


def collect_later() -> None:
    """Let Python search for unused circles of objects after the imports and not hundreds of times during them, a tenth of their time.

    The first search puts back what was set before. At the end of the program none is made.
    """
    before = gc.get_threshold()
    if before[0] == OBJECTS:  # put off already
        return

    def restore(*_: object) -> None:
        gc.callbacks.remove(restore)
        gc.set_threshold(*before)

    gc.callbacks.append(restore)
    gc.set_threshold(OBJECTS, *before[1:])
    atexit.register(gc.freeze)


def only_numpy() -> None:
    """Tell xarray that arrays are NumPy's: to find that out it would import Dask and pint where they are installed, 0.4 s.

    The names are xarray's private ones; a version without them imports as before.
    """
    with suppress(ImportError, AttributeError, TypeError):
        from xarray.namedarray import pycompat

        names: Any = {"dask", "pint", "sparse", "cupy"} - set(sys.modules)
        for name in names:
            absent = pycompat.DuckArrayModule("seaglint.absent")  # type: ignore[arg-type]
            pycompat._cached_duck_array_modules.setdefault(name, absent)
