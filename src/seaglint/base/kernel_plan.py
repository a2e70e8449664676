"""Kernels that a kind of work needs, compiled by helper processes while the first process imports libraries and prepares its scene.

Numba compiles a function when it is first called. One process compiles functions one after the other, which takes half a minute for a first
picture. The file ``kernel_plan.txt`` lists the functions that Python calls, in order, with the types of their arguments. Helper processes
take them from the end, while the work itself needs them from the beginning. If two processes need one function, the second waits and loads
it (``seaglint.base.jit``), so that no function is compiled twice; the code does not depend on the compiling process. A function that is
missing from the list is compiled when it is called. ``python tools/compile_times.py --plan`` writes the list.
"""

from __future__ import annotations

import ast
import atexit
import importlib
import logging
import os
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, Final, NamedTuple

import llvmlite.binding as llvm
import numba

from seaglint.base.kernel_bodies import file_stem
from seaglint.base.kernel_cache import PACKAGE, can_wait, end_turn, kernel_folder, try_turn

types: Any = numba.types  # type checkers do not know most of them

PLAN: Final = Path(__file__).with_name("kernel_plan.txt")  #: File of the list.

MOST_HELPERS: Final = 7  #: Largest number of helper processes: the longest function alone takes a third of the total time.

#: Least number of missing functions for which helpers start: starting a process takes as long as compiling a few functions.
FEWEST_MISSING: Final = 3


class PlannedKernel(NamedTuple):
    """Function that Python calls."""

    work: tuple[str, ...]  #: Kinds of work that call it, such as ``render``.
    function: str  #: Module and name, with a dot between them.
    arguments: str  #: Types of its arguments in the form of ``spell``.

    @property
    def stem(self) -> str:
        """First part of the names of the function's files."""
        module, _, name = self.function.rpartition(".")
        return file_stem(module, name)

    def compile(self) -> None:
        """Compile the function for the planned arguments, or load it."""
        module, _, name = self.function.rpartition(".")
        dispatcher = getattr(importlib.import_module(module), name)
        dispatcher.compile(tuple(read_types(self.arguments)))


def spell(kind: Any) -> str:
    """Return the type of an argument as text, the inverse of ``read_types``.

    Raises
    ------
    TypeError
        A type that Python does not pass to kernels.

    Examples
    --------
    >>> spell(types.Array(types.float32, 2, "C")), spell(types.UniTuple(types.int64, 2))
    ('float32[2, C]', '(int64, int64)')
    """
    if isinstance(kind, types.BaseNamedTuple):
        return f"{kind.instance_class.__module__}.{kind.instance_class.__qualname__}({', '.join(map(spell, kind.types))})"
    if isinstance(kind, types.BaseTuple):
        return f"({', '.join(map(spell, kind.types))}{',' if kind.count == 1 else ''})"
    if isinstance(kind, types.Array):
        return f"{kind.dtype}[{kind.ndim}, {kind.layout}{'' if kind.mutable else ', readonly'}]"
    if isinstance(kind, types.Number | types.Boolean) and not isinstance(kind, types.Literal):
        return str(kind)
    raise TypeError(f"{kind} has no spelling: pass numbers, arrays and tuples of them from Python to kernels")


def read_types(text: str) -> list[Any]:
    """Return the types that a text spells, separated by commas."""
    body = ast.parse(f"({text},)" if text else "()", mode="eval").body
    assert isinstance(body, ast.Tuple)
    return [_read(node) for node in body.elts]


def _read(node: ast.expr) -> Any:
    match node:
        case ast.Name(id=name):
            return types.boolean if name == "bool" else getattr(types, name)
        case ast.Tuple(elts=elements):
            return types.BaseTuple.from_types([_read(one) for one in elements])
        case ast.Subscript(value=number, slice=ast.Tuple(elts=[ast.Constant(value=dimensions), ast.Name(id=layout), *readonly])):
            return types.Array(_read(number), dimensions, layout, readonly=bool(readonly))
        case ast.Call(func=ast.Attribute() as name, args=fields):
            module, _, record = ast.unparse(name).rpartition(".")
            members = [_read(one) for one in fields]
            # Numba has a separate type for tuples of equal members
            same = len(set(members)) == 1
            instance = getattr(importlib.import_module(module), record)
            return types.NamedUniTuple(members[0], len(members), instance) if same else types.NamedTuple(members, instance)
    raise ValueError(f"{ast.unparse(node)} is no type of an argument")


def read_plan(work: str, path: Path = PLAN) -> list[PlannedKernel]:
    """Return the functions that a kind of work calls, in order."""
    rows = (line.split(maxsplit=2) for line in path.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#"))
    planned = (PlannedKernel(tuple(kinds.split(",")), function, "".join(rest)) for kinds, function, *rest in rows)
    return [kernel for kernel in planned if work in kernel.work]


def not_compiled(work: str) -> list[PlannedKernel]:
    """Return the functions of a kind of work that are not yet compiled on this machine from these sources."""
    folder = _folder()
    return [] if folder is None else [kernel for kernel in read_plan(work) if not _is_compiled(folder, kernel)]


def _to_compile(work: str) -> int:
    """Return the number of functions of a kind of work for helpers; 0 for few functions, or without a writable folder."""
    number, folder = len(not_compiled(work)), _folder()
    return number if number >= FEWEST_MISSING and folder is not None and os.access(folder, os.W_OK) else 0


def _is_compiled(folder: Path, kernel: PlannedKernel) -> bool:
    """Return True if this version of Numba has compiled a function for this type of processor."""
    try:
        index = (folder / f"{kernel.stem}.nbi").read_bytes()
    except OSError:
        return False
    return numba.__version__.encode() in index and str(_settings.CPU_NAME or llvm.get_host_cpu_name()).encode() in index


def helpers_here() -> int:
    """Return the number of processes that may compile besides this one: one for each further thread that Numba may use."""
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    # the executable of a frozen or embedding program is not Python
    python = Path(sys.executable or "none").name.startswith("python") and not getattr(sys, "frozen", False)
    return max(min(usable, int(_settings.NUMBA_NUM_THREADS)) - 1, 0) if can_wait() and python else 0


@cache
def start_helpers(work: str) -> int:
    """Start processes that compile the functions of a kind of work, without a message; return their number.

    They end when all functions are compiled or when this process ends. No result depends on them: functions that they have not compiled are
    compiled when they are called. No process is started if all functions are compiled, on one processor, or without a shared folder.
    """
    number = _to_compile(work)
    if number == 0:
        return 0
    count = min(helpers_here(), MOST_HELPERS, number - 1)
    # without the current folder (-P): its files could have names of Python's modules
    code = f"import sys; sys.path.append({str(PACKAGE.parent)!r}); from seaglint.base.kernel_plan import help_with; help_with({work!r})"
    for _ in range(count):
        with suppress(OSError):  # no more processes or memory: this process continues without the helper
            _helpers.append(
                subprocess.Popen(
                    [sys.executable, "-P", "-c", code], stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
                )
            )
            threading.Thread(target=_helpers[-1].wait, daemon=True).start()
    return count


@cache
def compile_ahead(work: str) -> int:
    """Log that a kind of work compiles its functions, and ``start_helpers`` unless they were started before; return their number."""
    number = _to_compile(work)
    count = start_helpers(work)
    if number > 0:
        processes = "one process" if count == 0 else f"{count + 1} processes"
        logging.getLogger("seaglint").info(
            "compiling %d kernels in %s: about a minute, once for this version on this machine", number, processes
        )
    return count


@atexit.register
def _end_helpers() -> None:
    """Close the pipes, which ends the helpers."""
    for helper in _helpers:
        with suppress(OSError, subprocess.TimeoutExpired):
            assert helper.stdin is not None
            helper.stdin.close()
            helper.wait(5.0)


#: Helper processes. Their pipes are open while this process lives; when it ends for any reason, they read the end of their input.
_helpers: list[subprocess.Popen[bytes]] = []

_settings: Any = numba.config  # made at run time, where type checkers do not see it


def _folder() -> Path | None:
    """Return the folder that processes share; None if each process compiles separately, or compilation is disabled."""
    return None if _settings.DISABLE_JIT else kernel_folder(_settings.CACHE_DIR)


def help_with(work: str) -> None:
    """Compile from the end of a plan until all is compiled, or until the process that started this one has ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C ends the first process, and its end ends this one
    threading.Thread(target=_end_with_parent, daemon=True).start()
    for kernel in reversed(read_plan(work)):
        with suppress(Exception):  # a plan that is older than the code: the first process compiles what it calls
            compile_unless_begun(kernel)


def _end_with_parent() -> None:
    """Wait for the end of the standard input, then end this process at once."""
    with suppress(OSError):
        while os.read(0, 1):
            pass
    os._exit(0)


def compile_unless_begun(kernel: PlannedKernel) -> None:
    """Compile a function unless another process has compiled it or is compiling it."""
    folder = _folder()
    if folder is None or _is_compiled(folder, kernel):
        return
    if try_turn(folder, f"{kernel.stem}.nbi"):
        try:
            kernel.compile()
        finally:
            end_turn(folder, f"{kernel.stem}.nbi")
