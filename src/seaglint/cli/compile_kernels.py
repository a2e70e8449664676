"""Compilation of a scenario's kernels in advance: ``seaglint doctor --compile``, for images of containers and for clusters."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numba

from seaglint.base.errors import BackendError, SeaglintError
from seaglint.base.free_form import JsonObject
from seaglint.base.kernel_cache import kernel_folder
from seaglint.base.kernel_plan import not_compiled
from seaglint.cli.terminal.messages import log, naming_file

if TYPE_CHECKING:
    from seaglint.base.conventions import Progress
    from seaglint.scenario.model import Scenario

POLL = 0.5  #: Time between two counts of compiled kernels [s].

_settings: Any = numba.config  # created at run time, invisible to type checkers


@dataclass(frozen=True)
class Compiled:
    """Result of ``seaglint doctor --compile``."""

    #: Scenario, or "the default scenario".
    scenario: str
    #: Number of functions that were compiled now [1]; the others were compiled before.
    compiled: int
    #: Wall time [s].
    seconds: float
    #: Folder of compiled kernels; copy it with the package, or set ``SEAGLINT_CACHE`` to a folder that goes with it.
    folder: str

    @property
    def line(self) -> str:
        """Return the result as a sentence."""
        if not self.compiled:
            return f"all kernels of {self.scenario} are compiled, in {self.folder}"
        return f"kernels of {self.scenario} compiled in {self.seconds:.0f} s: {self.compiled} functions in {self.folder}"

    def as_dict(self) -> JsonObject:
        """Return plain values, for JSON."""
        return asdict(self)


def compile_kernels(file: Path | None, report: Progress) -> Compiled:
    """Compute a mean map and one frame of a scenario on all processors, which compiles all kernels that they call.

    Parameters
    ----------
    file : Path, optional
        Scenario; the default scenario if not given.
    report : callable
        Called with the numbers of functions: compiled, and in all.

    Raises
    ------
    BackendError
        No folder can be written, or compilation is switched off.
    SeaglintError
        The scenario cannot be read or drawn.
    """
    from seaglint.scenario.load import load_scenario, parse_scenario

    if _settings.DISABLE_JIT:
        raise BackendError("NUMBA_DISABLE_JIT is set, so that kernels run as plain Python; unset it to compile them")
    folder = kernel_folder(_settings.CACHE_DIR)
    if folder is None or not os.access(folder, os.W_OK):
        raise BackendError("compiled kernels cannot be kept: no folder can be written; set SEAGLINT_CACHE to one that can")
    scenario = parse_scenario({}) if file is None else load_scenario(file)
    before, start = _forms(folder), time.monotonic()
    with naming_file(file, scenario) if file is not None else nullcontext(), _watched(report):
        _run(scenario)
    number = len(_forms(folder) - before)
    return Compiled(str(file or "the default scenario"), number, round(time.monotonic() - start, 1), str(folder))


def _forms(folder: Path) -> set[str]:
    """Return the names of files of compiled code: one for each function and kind of arguments."""
    return {path.name for path in folder.glob("*.nbc")}


def _run(scenario: Scenario) -> None:
    """Compute one frame and a mean map, which call the kernels; nothing is stored."""
    from seaglint.studies.mean.mean_map import mean

    if scenario.sensor.senses:
        from seaglint.studies.sequence.sensed_sequence import prepared_frames as sensed_frames

        images = sensed_frames((scenario, range(1), False, False))[1]
    else:
        from seaglint.studies.sequence.render_sequence import prepared_frames

        images = prepared_frames((scenario, range(1)))[1]
    images(0)
    try:
        mean(scenario)
    # Some scenarios can be rendered but have no mean map; their other kernels are compiled all the same.
    except SeaglintError as error:
        log(f"kernels of mean maps are left out: {error}")


@contextmanager
def _watched(report: Progress) -> Iterator[None]:
    """Report how many planned functions have been compiled, by whichever process, until the context is left."""
    total, ended = _missing(), threading.Event()

    def watch() -> None:
        while not ended.wait(POLL) and (left := _missing()):
            report(total - left, total)

    if not total:
        yield
        return
    report(0, total)
    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()
    report(total, total)


def _missing() -> int:
    """Return the number of planned functions that have not been compiled."""
    return len({kernel.function for work in ("mean", "render") for kernel in not_compiled(work)})
