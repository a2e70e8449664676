"""Measure frame times, memory, a profile and the same sea rendered by Mitsuba 3, and write them into docs/performance.md.

    python benchmarks [PART ...] [--print]      or ./run bench

Parts: frames, memory, profile, mitsuba, agreement, program; all of them where none is named. Run it on a quiet machine.
"""

from __future__ import annotations

import argparse
import cProfile
import datetime
import json
import os
import platform
import pstats
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import measure_performance
from mitsuba_sea import MitsubaMissingError

PAGE = Path(__file__).resolve().parents[1] / "docs" / "performance.md"

FIG12 = {
    "sensor": {"height_m": 30, "elevation_deg": -3.6, "fov_deg": [14.3, 7.15], "pixels": [512, 512], "pixel_shape": "any"},
    "sea": {"shortest_wave_m": 4},
    "wind": {"speed_m_s": 10},
}
"""The article's case: 14 km x 3.5 km from 100 m to the horizon, waves on a 1 m lattice."""

SHORT = FIG12 | {"sea": {"shortest_wave_m": 0.05}, "render": {"tile_size": 512}}

BASE = {"sensor": {"pixels": [512, 256], "fov_deg": [16, 8], "elevation_deg": -3.6}, "wind": {"speed_m_s": 10}}

MEMORY = (
    measure_performance.PEAK
    + """
import json, sys
from seaglint.studies.sequence.render_sequence import prepare_sequence
from seaglint.scenario.load import parse_scenario
run = prepare_sequence(parse_scenario(json.loads(sys.argv[1])))
for frame in range(2):
    run.at(frame / 25.0)
print(peak_memory())
"""
)


def merged(base: dict[str, Any], **changes: dict[str, Any]) -> dict[str, Any]:
    """A scenario with some keys of some tables changed."""
    return base | {table: base.get(table, {}) | keys for table, keys in changes.items()}


def frame_seconds(scenario: dict[str, Any], threads: int | None = None, frames: int = 3) -> tuple[float, float]:
    """Shortest warm frame, and the time from scenario to the first one's beginning [s]."""
    from seaglint.base.threads import thread_limit
    from seaglint.scenario.load import parse_scenario
    from seaglint.studies.sequence.render_sequence import prepare_sequence

    with thread_limit(threads):
        start = time.perf_counter()
        run = prepare_sequence(parse_scenario(scenario))
        ready = time.perf_counter() - start
        run.at(0.0)
        seconds = []
        for frame in range(1, frames + 1):
            start = time.perf_counter()
            run.at(frame / 25.0)
            seconds.append(time.perf_counter() - start)
            if sum(seconds) > 10.0:
                break
    return min(seconds), ready


def frames() -> list[str]:
    """Frame time against pixels, field of view, range, shortest wave and threads, and the article's sequence."""
    frame_seconds(merged(BASE, sensor={"pixels": [16, 16]}))  # compiles what is not compiled yet
    out = ["| what | frame |", "| --- | --- |"]

    def add(what: str, scenario: dict[str, Any], threads: int | None = None) -> None:
        seconds, _ = frame_seconds(scenario, threads)
        out.append(f"| {what} | {seconds:.3f} s |")
        print(out[-1], flush=True)

    for pixels in ([128, 64], [512, 256], [1024, 512], [2048, 1024]):
        add(f"{pixels[0]} x {pixels[1]} pixels, 16 x 8 deg, sensor 30 m, waves to 2 m", merged(BASE, sensor={"pixels": pixels}))
    for width in (4, 60, 360):
        add(f"512 x 256 pixels, {width} x 8 deg", merged(BASE, sensor={"fov_deg": [width, 8], "pixel_shape": "any"}))
    for elevation, name in ((-12.0, "to 0.2 km"), (-5.5, "to 1 km"), (-4.3, "to 5 km")):
        add(f"512 x 256 pixels, 16 x 8 deg, {name}", merged(BASE, sensor={"elevation_deg": elevation}))
    for wave in (16.0, 8.0, 4.0, 1.0, 0.5):
        add(f"512 x 256 pixels, waves to {wave:g} m", merged(BASE, sea={"shortest_wave_m": wave}))
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    count = 1
    while count <= usable:
        add(f"512 x 256 pixels, {count} thread{'s' if count > 1 else ''}", BASE, count)
        count *= 2
    single = {"lines_per_column": 1}
    cases = (
        ("1 m lattice", FIG12, 20),
        ("1 m lattice, one line a column", merged(FIG12, render=single), 20),
        ("waves to 5 cm", SHORT, 60),
        ("waves to 5 cm, one line a column", merged(SHORT, render=single), 60),
    )
    for name, scenario, bound in cases:
        seconds, ready = frame_seconds(scenario)
        total = ready + 100 * seconds
        out.append(f"| 14 km x 3.5 km, {name}, 512 x 512 pixels: 100 frames, preparation included (bound {bound} s) | {total:.1f} s |")
        print(out[-1], flush=True)
    return out


def peak_memory(scenario: dict[str, Any]) -> float:
    """Largest memory of a process that renders two frames [MB]."""
    done = subprocess.run([sys.executable, "-c", MEMORY, json.dumps(scenario)], capture_output=True, text=True, check=True)
    return float(done.stdout)


def memory() -> list[str]:
    """Peak memory against that of a tiny image."""
    out = ["| what | peak memory | above 16 x 16 pixels (bound 150 MB) |", "| --- | --- | --- |"]
    for name, scenario in (("1 m lattice", FIG12), ("waves to 5 cm", SHORT)):
        small = peak_memory(merged(scenario, sensor={"pixels": [16, 16]}))
        large = peak_memory(scenario)
        out.append(f"| 14 km x 3.5 km, {name}, 512 x 512 pixels | {large:.0f} MB | {large - small:.0f} MB |")
    return out


def profile() -> list[str]:
    """Where the time of a frame goes, and that of the preparation."""
    from seaglint.imaging.upright_scene import SweptScene
    from seaglint.scenario.load import parse_scenario
    from seaglint.studies.sequence.render_sequence import prepare_sequence

    scenario = parse_scenario(FIG12)
    prepare_sequence(scenario).at(0.0)
    profiler = cProfile.Profile()
    profiler.enable()
    run = prepare_sequence(scenario)
    profiler.disable()
    run.at(0.0)
    scene = run.scene
    assert isinstance(scene, SweptScene)
    waves = scene.waves
    assert waves is not None

    def best(work: Callable[[float], object]) -> float:
        seconds = []
        for frame in range(1, 6):
            start = time.perf_counter()
            work(frame / 25.0)
            seconds.append(time.perf_counter() - start)
        return min(seconds)

    import numba

    lattices = best(lambda t: waves.surfaces(t, workers=numba.get_num_threads()))
    surface, whole = best(scene.surface), best(run.at)
    out = ["| 14 km x 3.5 km, 1 m lattice, 512 x 512 pixels: one frame | time |", "| --- | --- |"]
    out.append(f"| waves of all tiles (inverse transforms) | {lattices:.3f} s |")
    out.append(f"| surface as the sweep reads it, less the waves | {max(surface - lattices, 0.0):.3f} s |")
    out.append(f"| walk and shading of all columns | {max(whole - surface, 0.0):.3f} s |")
    out.append(f"| whole frame | {whole:.3f} s |")
    out += ["", "| preparation, once per sequence | time, with what it calls |", "| --- | --- |"]
    found = []
    for (file, _, name), (_, _, _, cumulative, _) in pstats.Stats(profiler).stats.items():  # type: ignore[attr-defined]
        if f"{os.sep}seaglint{os.sep}" in file and name != "<module>":
            found.append((cumulative, f"{Path(file).parent.name}/{Path(file).name}: {name}"))
    out += [f"| `{name}` | {seconds:.3f} s |" for seconds, name in sorted(found, reverse=True)[:10]]
    return out


def mitsuba() -> list[str]:
    """The same sea by Mitsuba 3."""
    from mitsuba_comparison import lines

    return lines(lambda text: print(text, flush=True))


def agreement() -> list[str]:
    """How far the sweep and Mitsuba 3 agree, converged; on any machine, busy or not."""
    from mitsuba_comparison import agreement_lines

    return agreement_lines(lambda text: print(text, flush=True))


def program() -> list[str]:
    """What the program as a whole takes: demo, maps, cases, start."""
    return measure_performance.measured()[2:]


PARTS: dict[str, Callable[[], list[str]]] = {
    "frames": frames,
    "memory": memory,
    "profile": profile,
    "mitsuba": mitsuba,
    "agreement": agreement,
    "program": program,
}


def machine() -> str:
    """Date, processor and versions in one line."""
    from importlib.metadata import PackageNotFoundError, version

    def of(name: str) -> str:
        try:
            return f"{name} {version(name)}"
        except PackageNotFoundError:
            return f"no {name}"

    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    busy = f", load {os.getloadavg()[0]:.1f} at the start" if hasattr(os, "getloadavg") else ""
    packages = ", ".join(of(name) for name in ("numpy", "numba", "mitsuba"))
    return (
        f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d}; {measure_performance.processor()}, {usable} processors used{busy}; "
        f"Python {platform.python_version()}, {packages}."
    )


def write(part: str, lines: list[str]) -> None:
    """Put lines between the markers of a part."""
    name = "measured" if part == "program" else f"bench {part}"
    begin, end = f"<!-- begin {name} -->\n", f"<!-- end {name} -->"
    text = PAGE.read_text(encoding="utf-8")
    head, _, rest = text.partition(begin)
    _, marker, tail = rest.partition(end)
    if not marker:
        raise SystemExit(f"{PAGE}: the markers '{begin.strip()}' and '{end.strip()}' are missing; put them where the table shall be")
    PAGE.write_text(f"{head}{begin}\n" + "\n".join(lines) + f"\n\n{marker}{tail}", encoding="utf-8")


def main() -> int:
    """Run the parts wanted."""
    parser = argparse.ArgumentParser(prog="benchmarks", description="Measure what docs/performance.md states.")
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--print", action="store_true", help="leave the page as it is")
    arguments = parser.parse_args()
    unknown = [part for part in arguments.parts if part not in PARTS]
    if unknown:
        parser.error(f"unknown part {unknown[0]}; allowed are {', '.join(PARTS)}")
    for part in arguments.parts or PARTS:
        start, where = time.perf_counter(), machine()
        print(f"== {part}", flush=True)
        try:
            lines = [where, "", *PARTS[part]()]
        except MitsubaMissingError as error:
            print(f"{part}: skipped: {error}", flush=True)
            continue
        print("\n".join(lines))
        print(f"== {part}: {time.perf_counter() - start:.0f} s", flush=True)
        if not arguments.print:
            write(part, lines)
    return 0


if __name__ == "__main__":
    sys.exit(main())
