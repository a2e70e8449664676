"""List what compiling the kernels of a command costs, function by function, and write which functions a kind of work calls.

``python tools/compile_times.py render examples/demo.toml -o /tmp/x.zarr --frames 0`` runs the command ``seaglint`` with an empty folder of
kernels, in this process alone, and prints for each function the processor time of its own compilation without that of the functions
compiled meanwhile, and for how many kinds of arguments it was compiled.

``python tools/compile_times.py --plan`` runs the commands of :data:`WORK` so and writes ``src/seaglint/base/kernel_plan.txt``.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]

WORK = {"mean": ("mean", ".nc", ()), "render": ("render", ".zarr", ("--frames", "0:1", "--preview"))}
"""Kinds of work of the plan: command, ending of its output, options."""

SCENARIOS = ("examples/demo.toml", "")
"""Scenarios whose kernels the plan holds, the first one's order before others'; nothing is the scenario of all defaults."""


class Compilations:
    """Processor time of each compilation [s], without that of those that it asks for, and what was called from Python."""

    def __init__(self) -> None:
        self.own: dict[tuple[str, str], list[float]] = defaultdict(list)
        self.called: list[tuple[str, tuple[Any, ...]]] = []
        self._open: list[list[float]] = []  # start, time of the compilations within

    def on_start(self, event: Any) -> None:
        """Begin a compilation."""
        self._open.append([time.thread_time(), 0.0])

    def on_end(self, event: Any) -> None:
        """Note a compilation that has ended."""
        start, inner = self._open.pop()
        spent = time.thread_time() - start
        function = event.data["dispatcher"].py_func
        if self._open:
            self._open[-1][1] += spent
        else:
            self.called.append((f"{function.__module__}.{function.__qualname__}", event.data["args"]))
        self.own[function.__module__.removeprefix("seaglint."), function.__name__].append(spent - inner)


def compiled_by(words: list[str]) -> Compilations:
    """Run a command with an empty folder of kernels and note what is compiled."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["NUMBA_CACHE_DIR"] = folder
        os.environ["NUMBA_NUM_THREADS"] = "1"  # no helpers: all is compiled here
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
        finally:
            event.unregister("numba:compile", listener)
    return listener


def print_times(listener: Compilations) -> None:
    """Print the table of functions, the costliest first."""
    rows = sorted(((sum(times), len(times), *name) for name, times in listener.own.items()), reverse=True)
    seconds, number = sum(row[0] for row in rows), sum(row[1] for row in rows)
    print(f"{seconds:.1f} s in {number} compilations of {len(rows)} functions; {time.process_time():.1f} s in all")
    for spent, number, module, name in rows:
        print(f"{spent:7.2f} s {number:3}  {module}.{name}")


def print_calls(listener: Compilations) -> None:
    """Print the functions called from Python with the types of their arguments, in order."""
    from seaglint.base.kernel_plan import spell

    for function, types in listener.called:
        print("call", function, ", ".join(map(spell, types)))


def calls_of(command: str, ending: str, options: tuple[str, ...], scenario: str) -> list[tuple[str, str]]:
    """Return functions and arguments that a command calls, in order, from a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "scenario.toml"
        file.write_bytes((ROOT / scenario).read_bytes() if scenario else b"")
        words = [command, str(file), "-o", f"{folder}/out{ending}", *options]
        run = subprocess.run([sys.executable, __file__, "--calls", *words], stdout=subprocess.PIPE, text=True, check=True)
    rows = [line.split(maxsplit=2)[1:] for line in run.stdout.splitlines() if line.startswith("call ")]
    return [(function, "".join(rest)) for function, *rest in rows]


def plan() -> dict[tuple[str, str], list[str]]:
    """Return the kinds of work by function and arguments, in the order of the first scenario; what others alone call stands before."""
    order: list[tuple[str, str]] = []
    kinds: dict[tuple[str, str], list[str]] = defaultdict(list)
    for work, (command, ending, options) in WORK.items():
        for scenario in SCENARIOS:
            calls = list(dict.fromkeys(calls_of(command, ending, options, scenario)))
            new = [call for call in calls if call not in kinds]
            order = [*new, *order] if scenario != SCENARIOS[0] else [*order, *new]
            for call in calls:
                kinds[call] += [work] if work not in kinds[call] else []
    return {call: kinds[call] for call in order}


def write_plan() -> None:
    """Write the plan beside the module that reads it."""
    from seaglint.base.kernel_plan import PLAN

    lines = [
        "# Kernels that Python calls, in order: kinds of work, function, types of the arguments. Written by tools/compile_times.py --plan.",
        *(f"{','.join(kinds)} {function} {arguments}" for (function, arguments), kinds in plan().items()),
    ]
    PLAN.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{PLAN}: {len(lines) - 1} functions")


def main(words: list[str]) -> None:
    """Print the table of a command, or write the plan."""
    match words:
        case ["--plan"]:
            write_plan()
        case ["--calls", *rest]:
            print_calls(compiled_by(rest))
        case _:
            print_times(compiled_by(words))


if __name__ == "__main__":
    main(sys.argv[1:])
