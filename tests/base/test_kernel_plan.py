"""Kernels compiled ahead by other processes: the plan names what is called, and results do not depend on who compiles."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import numba
import numpy as np
import pytest

import compile_times
from seaglint.base import kernel_plan
from seaglint.base.kernel_plan import read_plan, read_types, spell

WORKS = ("mean", "render")

SMALL = """
[sensor]
fov_deg = [4, 6]
elevation_deg = -3
pixels = [16, 20]

[sea]
shortest_wave_m = 8.0

[render]
tile_size = 128
"""


class Line(NamedTuple):
    start: tuple[float, float]
    values: np.ndarray


class Pair(NamedTuple):
    low: float
    high: float


@pytest.mark.parametrize(
    "value",
    [
        *(1.5, 3, True, np.float32(1.0), np.zeros(3), np.zeros((2, 3), np.complex64), (1, 2), (1, 2.0), (4.0,), Pair(1.0, 2.0)),
        *(Line((0.0, 1.0), np.zeros((3, 2))), np.zeros((3, 4)).T, np.zeros(8)[::2], np.broadcast_to(1.0, (3,))),
    ],
    ids=lambda value: type(value).__name__,
)
def test_a_type_is_read_as_it_was_spelled(value: object) -> None:
    kind = numba.typeof(value)
    (again,) = read_types(spell(kind))
    assert again == kind


def test_a_type_without_a_spelling_is_refused() -> None:
    with pytest.raises(TypeError, match="pass numbers, arrays and tuples"):
        spell(numba.types.unicode_type)
    with pytest.raises(ValueError, match="is no type of an argument"):
        read_types("float64 + int64")


@pytest.mark.parametrize("work", WORKS)
def test_the_plan_names_kernels_that_there_are(work: str) -> None:
    planned = read_plan(work)
    assert len(planned) > 10
    for kernel in planned:
        module, _, name = kernel.function.rpartition(".")
        function = getattr(importlib.import_module(module), name)
        count = getattr(function, "py_func", function).__code__.co_argcount
        assert len(read_types(kernel.arguments)) == count, kernel.function
        assert ", ".join(map(spell, read_types(kernel.arguments))) == kernel.arguments


def environment(cache: Path, **more: str) -> dict[str, str]:
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA_", "SEAGLINT_CACHE"))}
    return kept | {"SEAGLINT_CACHE": str(cache)} | more


def python(code: str, cache: Path, **more: str) -> str:
    """Standard output of a fresh interpreter with an empty folder of kernels."""
    done = subprocess.run([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True, check=True, env=environment(cache, **more))
    return done.stdout.strip()


def test_one_processor_has_no_helpers(tmp_path: Path) -> None:
    code = "from seaglint.base.kernel_plan import *; print(helpers_here(), compile_ahead('render'), len(not_compiled('render')) > 10)"
    assert python(code, tmp_path, NUMBA_NUM_THREADS="1") == "0 0 True"


def test_plain_python_compiles_nothing(tmp_path: Path) -> None:
    code = "from seaglint.base.kernel_plan import *; print(compile_ahead('render'), not_compiled('render'))"
    assert python(code, tmp_path, NUMBA_DISABLE_JIT="1") == "0 []"


def test_no_folder_that_can_be_written_means_no_helpers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel_plan, "kernel_folder", lambda requested: None)
    assert kernel_plan.not_compiled("render") == []
    assert kernel_plan.start_helpers.__wrapped__("render") == 0


SLOW_HELPER = """
import os, subprocess, sys, time
from seaglint.base import kernel_plan
kernel_plan.helpers_here = lambda: 1
print(kernel_plan.compile_ahead("render"), kernel_plan._helpers[0].pid, flush=True)
time.sleep(600)
"""


@pytest.mark.skipif(os.name != "posix", reason="processes and signals of POSIX")
def test_a_helper_ends_with_the_process_that_started_it(tmp_path: Path) -> None:
    first = subprocess.Popen([sys.executable, "-c", SLOW_HELPER], stdout=subprocess.PIPE, text=True, env=environment(tmp_path))
    assert first.stdout is not None
    count, helper = map(int, first.stdout.readline().split())
    assert count == 1
    os.kill(helper, 0)  # it lives
    first.kill()
    first.wait()
    until = time.monotonic() + 300.0
    while time.monotonic() < until:
        try:
            os.kill(helper, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    pytest.fail("the helper still runs")


@pytest.mark.validation
def test_pictures_and_files_are_the_same_whoever_compiles(tmp_path: Path) -> None:
    """A helper of its own compiles all that is planned; then the work compiles nothing that is planned, and the pixels are the same."""
    (tmp_path / "s.toml").write_text(SMALL)
    picture = (
        "import hashlib, sys; from seaglint.scenario.load import load_scenario\n"
        "from seaglint.studies.sequence.render_sequence import prepare_sequence; from seaglint.studies.mean.mean_map import mean\n"
        f"scenario = load_scenario({str(tmp_path / 's.toml')!r})\n"
        "frame, map = prepare_sequence(scenario).at(0.04).radiance, mean(scenario).radiance.values\n"
        "print(hashlib.sha256(frame.tobytes() + map.tobytes()).hexdigest())"
    )
    helped, alone = tmp_path / "helped", tmp_path / "alone"
    helper = "import os; from seaglint.base.kernel_plan import help_with; r, w = os.pipe(); os.dup2(r, 0); [help_with(k) for k in {}]"
    python(helper.format(WORKS), helped, NUMBA_NUM_THREADS="1")
    (folder,) = (helped / "kernels").glob("seaglint-kernels-*")
    planned = {f"{kernel.stem}.nbi" for work in WORKS for kernel in read_plan(work)}
    assert planned <= {path.name for path in folder.iterdir()}
    before = {path.name: path.stat().st_mtime_ns for path in folder.glob("*.nbi")}
    assert python(picture, helped, NUMBA_NUM_THREADS="1") == python(picture, alone, NUMBA_NUM_THREADS="1")
    assert {name: folder.joinpath(name).stat().st_mtime_ns for name in planned} == {name: before[name] for name in planned}


@pytest.mark.validation
def test_the_plan_is_what_the_commands_call() -> None:
    """Written anew by ``python tools/compile_times.py --plan``; an old plan costs time alone."""
    planned = {(kernel.function, kernel.arguments): list(kernel.work) for work in WORKS for kernel in read_plan(work)}
    assert {call: sorted(kinds) for call, kinds in compile_times.plan().items()} == planned
