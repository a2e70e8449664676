"""Measure what docs/performance.md states on this machine and write it between the page's markers.

    python benchmarks/measure_performance.py            measure and write
    python benchmarks/measure_performance.py --print    measure only

Every number comes from its own process. Kernels are compiled before anything is timed; run it on a quiet machine.
"""

from __future__ import annotations

import argparse
import datetime
import os
import platform
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "performance.md"

PEAK = """
def peak_memory():
    # of this program alone: what getrusage tells begins with the size of the one that started it
    try:
        with open("/proc/self/status") as status:
            return next(int(line.split()[1]) for line in status if line.startswith("VmHWM")) / 1024.0
    except (OSError, StopIteration):
        import resource
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
"""
"""Peak memory of a process [MB], for the programs below."""

FRAME = (
    PEAK
    + """
import json, statistics, sys, time
from seaglint.studies.sequence.render_sequence import prepare_sequence
from seaglint.scenario.load import load_scenario, parse_scenario
scenario = load_scenario(sys.argv[1]) if sys.argv[1].endswith(".toml") else parse_scenario(json.loads(sys.argv[1]))
start = time.perf_counter()
run = prepare_sequence(scenario)
ready = time.perf_counter() - start
seconds = []
for frame in range(int(sys.argv[2])):
    start = time.perf_counter()
    run.at(frame / 25.0)
    seconds.append(time.perf_counter() - start)
print(json.dumps({"ready": ready, "first": seconds[0], "frame": statistics.median(seconds), "peak": peak_memory()}))
"""
)

MAP = """
import json, statistics, time
from seaglint.studies.build import scenario_physics as prepare
from seaglint.radiance.mean_radiance import MeanModel
from seaglint.scenario.load import parse_scenario
scenario = parse_scenario({"sensor": {"pixels": [1024, 1024], "pixel_shape": "any"}})
camera = prepare.camera(scenario)
start = time.perf_counter()
model = MeanModel.prepare(prepare.view(scenario))
ready = time.perf_counter() - start
seconds = []
for _ in range(6):
    start = time.perf_counter()
    model.map(camera.elevations, camera.azimuths)
    seconds.append(time.perf_counter() - start)
print(json.dumps({"ready": ready, "map": statistics.median(seconds[1:])}))
"""

ARTICLE_CASE = (
    '{"sensor": {"height_m": 30, "elevation_deg": -3.6, "fov_deg": [14.3, 7.15], "pixels": [%d, %d], "pixel_shape": "any"},'
    ' "sea": {"shortest_wave_m": 4}, "wind": {"speed_m_s": 10}}'
)
"""From 100 m range to the horizon, 3.5 km wide at 14 km, waves resolved on a 1 m lattice."""


def render(scenario: str, frames: int) -> dict[str, float]:
    """Seconds to get ready, of the first and the median frame, and peak memory [MB] of a process that renders some frames."""
    import json

    done = subprocess.run([sys.executable, "-c", FRAME, scenario, str(frames)], capture_output=True, text=True, check=True, cwd=ROOT)
    return dict(json.loads(done.stdout))


def mean_map() -> dict[str, float]:
    """Seconds to prepare the default view and of one map of 1024 x 1024 pixels."""
    import json

    done = subprocess.run([sys.executable, "-c", MAP], capture_output=True, text=True, check=True, cwd=ROOT)
    return dict(json.loads(done.stdout))


def best_seconds(*command: str, attempts: int = 5) -> float:
    """Shortest of some runs."""
    found = []
    for _ in range(attempts):
        start = time.perf_counter()
        subprocess.run(command, capture_output=True, check=True, cwd=ROOT)
        found.append(time.perf_counter() - start)
    return min(found)


def batch_seconds(rows: int = 10_000) -> float:
    """Whole process of ``seaglint evaluate atmosphere`` over random cases of all model atmospheres in one band."""
    import numpy as np

    from seaglint.air.lowtran_table import table_models

    random = np.random.default_rng(1)
    height = np.exp(random.uniform(np.log(2.0), np.log(1e4), rows))
    # A straight ray over LOWTRAN7's Earth has a deeper horizon than its bent ones: all of these end on the sea.
    depression = np.degrees(np.arccos(6356.0e3 / (6356.0e3 + height))) + 10.0 ** random.uniform(-2.0, 1.5, rows)
    columns = (
        random.choice(table_models(), rows),
        random.uniform(0.0, 20.0, rows),
        height,
        depression,
        *random.uniform(0.0, 89.0, (2, rows)),
    )
    with tempfile.TemporaryDirectory() as name:
        cases, output = Path(name) / "cases.csv", Path(name) / "out.csv"
        heading = "atmosphere,wind_speed_m_s,sensor_height_m,depression_deg,solar_zenith_deg,sky_zenith_deg"
        cases.write_text("\n".join([heading, *(",".join(map(str, row)) for row in zip(*columns, strict=True))]), encoding="utf-8")
        command = ("evaluate", "atmosphere", str(cases), "--band", "3.0-5.0", "-o", str(output), "--overwrite")
        return best_seconds(sys.executable, "-c", "from seaglint.cli.app import main; main()", *command)


def sweeps_seconds(sweeps: int = 100) -> float:
    """Gibbs sweeps of an autobinomial field of 512 x 512 pixels and 64 grey levels, all threads; the shortest of five runs."""
    from seaglint.textures.autobinomial import Autobinomial
    from seaglint.textures.autobinomial_sampler import sample

    model, found = Autobinomial.of(64, 1, -1.4, (0.7 / 63,)), []
    field = sample(model, (512, 512), 50, seed=1)  # compiles, and comes near equilibrium
    for _ in range(5):
        start = time.perf_counter()
        sample(model, (512, 512), sweeps, seed=1, start=field)
        found.append(time.perf_counter() - start)
    return min(found)


def loop_seconds() -> float:
    """Whole process of ``seaglint texture sample`` for 256 frames of 512 x 512 pixels, with neighbours in three frames."""
    from seaglint.store.texture_file import StoredTexture, write_texture
    from seaglint.textures.gauss_markov import GaussMarkov
    from seaglint.textures.gaussian_texture import GaussianTexture
    from seaglint.textures.marginals import Marginal

    offsets = ((0, 0, 1), (0, 1, 0), (0, 1, 1), (0, 0, 2), (0, 2, 0), (1, 0, 0), (1, 0, 1), (2, 0, 1))
    field = GaussMarkov(offsets, (0.12, 0.1, 0.05, -0.02, -0.01, 0.1, 0.08, 0.02), 1.0)
    with tempfile.TemporaryDirectory() as name:
        model, output = Path(name) / "model.json", Path(name) / "loop.zarr"
        write_texture(StoredTexture(GaussianTexture(field, Marginal("gamma", 1.0, 0.5, 2.0))), model)
        command = ("texture", "sample", str(model), "--size", "512x512", "--frames", "256", "-o", str(output), "--overwrite")
        return best_seconds(sys.executable, "-c", "from seaglint.cli.app import main; main()", *command, attempts=3)


def processor() -> str:
    """Name of the processor, where the system tells it."""
    try:
        names = re.findall(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.MULTILINE)
    except OSError:
        names = []
    return names[0] if names else platform.processor() or platform.machine()


def measured() -> list[str]:
    """Lines of the page."""
    demo = str(ROOT / "examples" / "demo.toml")
    render(demo, 1)  # compiles what is not compiled yet
    sequence = render(demo, 12)
    default = render("{}", 4)
    small, large = render(ARTICLE_CASE % (16, 16), 2), render(ARTICLE_CASE % (1024, 512), 2)
    mean_map()  # compiles
    mean = mean_map()
    start_python = best_seconds(sys.executable, "-c", "pass")
    start_import = best_seconds(sys.executable, "-c", "import seaglint")
    start_help = best_seconds(sys.executable, "-c", "from seaglint.cli.app import main; main()", "--help")
    rows = [
        ("demo: scenario to first frame ready (tables, tiles)", f"{sequence['ready']:.1f} s"),
        ("demo: one 512 x 256 frame, median of 12", f"{sequence['frame']:.2f} s"),
        ("demo: 100 frames", f"{sequence['ready'] + 100 * sequence['frame']:.0f} s"),
        ("default settings (waves down to 2 m): one 512 x 256 frame", f"{default['frame']:.2f} s"),
        ("demo: peak memory", f"{sequence['peak']:.0f} MB"),
        ("14 km x 3.5 km, 1 m lattice, 1024 x 512 pixels: one frame", f"{large['frame']:.2f} s"),
        ("the same: peak memory", f"{large['peak']:.0f} MB"),
        ("the same with 16 x 16 pixels: peak memory", f"{small['peak']:.0f} MB"),
        ("difference (article: 1.1 GB, cut 40-fold; bound here 150 MB)", f"{large['peak'] - small['peak']:.0f} MB"),
        ("`seaglint evaluate atmosphere`, 10,000 rows, one band: whole process", f"{batch_seconds():.1f} s"),
        ("mean map: scenario to prepared view (tables, facets)", f"{mean['ready']:.2f} s"),
        ("mean map: 1024 x 1024 pixels of the default scene", f"{mean['map']:.2f} s"),
        ("autobinomial field, 512 x 512 pixels, 64 grey levels: 100 Gibbs sweeps", f"{sweeps_seconds():.2f} s"),
        ("endless loop of a gamma texture, 512 x 512 pixels, 256 frames, to Zarr: whole process", f"{loop_seconds():.1f} s"),
        ("`import seaglint` (Python alone: " + f"{start_python:.2f} s)", f"{start_import:.2f} s"),
        ("`seaglint --help`", f"{start_help:.2f} s"),
    ]
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return [
        f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d}; {processor()}, {usable} processors used, Python {platform.python_version()}.",
        "",
        "| what | measured |",
        "| --- | --- |",
        *(f"| {what} | {value} |" for what, value in rows),
    ]


def main() -> None:
    """Measure, print, write."""
    parser = argparse.ArgumentParser(description="Measure what docs/performance.md states.")
    parser.add_argument("--print", action="store_true", help="leave the page as it is")
    arguments = parser.parse_args()
    lines = measured()
    print("\n".join(lines))
    if not arguments.print:
        text = PAGE.read_text(encoding="utf-8")
        begin, end = "<!-- begin measured -->\n", "<!-- end measured -->"
        PAGE.write_text(
            text[: text.index(begin) + len(begin)] + "\n" + "\n".join(lines) + "\n\n" + text[text.index(end) :], encoding="utf-8"
        )


if __name__ == "__main__":
    main()
