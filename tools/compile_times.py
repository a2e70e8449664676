"""List what compiling the kernels of a command costs, function by function.

``python tools/compile_times.py render examples/demo.toml -o /tmp/x.zarr --frames 0`` runs the command ``seaglint`` with an empty folder of
kernels and prints, for each function, the processor time of its own compilation without that of the functions compiled meanwhile.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections import defaultdict
from typing import Any


class Compilations:
    """Processor time of each compilation [s], without that of those that it asks for."""

    def __init__(self) -> None:
        self.own: dict[tuple[str, str], list[float]] = defaultdict(list)
        self._open: list[list[float]] = []  # start, time of the compilations within

    def on_start(self, event: Any) -> None:
        """Begin a compilation."""
        self._open.append([time.thread_time(), 0.0])

    def on_end(self, event: Any) -> None:
        """Note a compilation that has ended."""
        start, inner = self._open.pop()
        spent = time.thread_time() - start
        if self._open:
            self._open[-1][1] += spent
        function = event.data["dispatcher"].py_func
        self.own[function.__module__.removeprefix("seaglint."), function.__name__].append(spent - inner)


def main(words: list[str]) -> None:
    """Run the command and print the table."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ.setdefault("NUMBA_CACHE_DIR", folder)
        from numba.core import event

        from seaglint.cli.app import main as seaglint

        class Listener(Compilations, event.Listener):
            pass

        listener = Listener()
        event.register("numba:compile", listener)
        try:
            sys.argv = ["seaglint", *words]
            seaglint()
        except SystemExit as end:
            if end.code:
                raise
    rows = sorted(((sum(times), len(times), *name) for name, times in listener.own.items()), reverse=True)
    seconds, number = sum(row[0] for row in rows), sum(row[1] for row in rows)
    print(f"{seconds:.1f} s in {number} compilations of {len(rows)} functions; {time.process_time():.1f} s in all")
    for spent, number, module, name in rows:
        print(f"{spent:7.2f} s {number:3}  {module}.{name}")


if __name__ == "__main__":
    main(sys.argv[1:])
