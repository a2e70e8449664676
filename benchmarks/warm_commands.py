"""Measure commands whose kernels are compiled already, and write the table into docs/performance.md.

``python benchmarks/warm_commands.py [--before LABEL=FOLDER ...] [--runs N] [--print]`` runs each command N times (3) from the sources of
this repository and from those of other checkouts, by turns, and takes the least wall and processor time of each. Every checkout runs with
the Python and the packages of this one. All commands are run once before, uncounted, which compiles what is not compiled yet.
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

from measure_performance import processor as processor_name

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "performance.md"

VIEWS = (
    "atmosphere,wind_speed_m_s,sensor_height_m,depression_deg,solar_zenith_deg,relative_azimuth_deg,sea_temperature_k,ifov_mrad\n"
    "us-standard-1976,7,30,3,75,0,288,0.5\n"
)

COMMANDS = {
    "seaglint --help": "--help",
    "render --help": "render --help",
    "info, of 8 frames": "info run.zarr",
    "mean, examples/demo.toml": "mean demo.toml -o mean.nc --overwrite",
    "render, one frame of 128 x 64 pixels": "render small.toml -o one.zarr --frames 0 --overwrite",
    "sense, 8 frames": "sense aperture.zarr camera.toml --sensor mwir-insb-640 --oversampling 1 -o counts.zarr --overwrite",
    "sensor": "sensor demo.toml --sensor mwir-insb-640",
    "analyze, 8 frames": "analyze run.zarr",
    "export, 8 frames to NumPy": "export run.zarr -o run.npy --overwrite",
    "evaluate mean, one case": "evaluate mean views.csv --band 3.5-5.0 -o views-out.csv --overwrite",
    "detect, 8 frames of a recording": "detect run.zarr --contrast 0.1,0.2 -o found --overwrite",
}
RUNS = ("render small.toml -o run.zarr --frames 0:8 --overwrite", "render camera.toml -o aperture.zarr --frames 0:8 --overwrite")


def seconds(checkout: Path, words: str, folder: Path) -> tuple[float, float]:
    """Wall and processor time of a command from a checkout [s].

    Raises
    ------
    SystemExit
        The command failed.
    """
    environment = os.environ | {"PYTHONPATH": str(checkout / "src")}
    began = time.perf_counter()
    with (folder / "log").open("w") as log:
        program = [sys.executable, "-c", "from seaglint.cli.app import main; main()", *words.split()]
        process = subprocess.Popen(program, cwd=folder, env=environment, stdout=log, stderr=log)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(f"warm_commands: seaglint {words} of {checkout} ended with {process.returncode}:\n{(folder / 'log').read_text()}")
    return time.perf_counter() - began, usage.ru_utime + usage.ru_stime


def prepare(checkout: Path, folder: Path) -> None:
    """Write what the commands read, with the kernels of a checkout."""
    demo = (ROOT / "examples" / "demo.toml").read_text("utf-8")
    small = re.sub(r"(?m)^pixels *=.*$", "pixels = [128, 64]", demo)
    (folder / "demo.toml").write_text(demo, "utf-8")
    (folder / "small.toml").write_text(small, "utf-8")
    (folder / "camera.toml").write_text(small.replace("min_um = 3.5", "min_um = 3.0"), "utf-8")  # the band of the sensor below
    (folder / "views.csv").write_text(VIEWS, "utf-8")
    for words in (*RUNS, *COMMANDS.values()):
        seconds(checkout, words, folder)


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--before", action="append", default=[], metavar="LABEL=FOLDER", help="another checkout, oldest first")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--print", action="store_true", help="leave the page as it is")
    given = parser.parse_args()
    checkouts = {label: Path(folder) for label, _, folder in (text.partition("=") for text in given.before)} | {"now": ROOT}
    best: dict[tuple[str, str], tuple[float, float]] = {}
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as temporary:
        folders = {label: Path(temporary) / str(number) for number, label in enumerate(checkouts)}
        for label, folder in folders.items():
            folder.mkdir()
            prepare(checkouts[label], folder)
        for name, words in COMMANDS.items():
            for _ in range(given.runs):
                for label, checkout in checkouts.items():
                    wall, processor = seconds(checkout, words, folders[label])
                    least = best.get((name, label), (wall, processor))
                    best[name, label] = min(wall, least[0]), min(processor, least[1])
            print(name, *(f"{label} {best[name, label][0]:.2f} {best[name, label][1]:.2f}" for label in checkouts), flush=True)
    heading = ["command", *(f"{label}: {kind}" for label in checkouts for kind in ("wall", "processor"))]
    lines = [
        f"{datetime.date.today()}; {processor_name()}, {os.cpu_count()} processors, load {load:.1f} at the start; "
        f"Python {platform.python_version()}; least of {given.runs} runs by turns.",
        "",
        f"| {' | '.join(heading)} |",
        f"| {' | '.join('---' for _ in heading)} |",
    ]
    for name in COMMANDS:
        times = [f"{value:.2f} s" for label in checkouts for value in best[name, label]]
        lines.append(f"| {' | '.join((name, *times))} |")
    table = "\n".join(("", *lines, "", ""))
    print(table)
    if not given.print:
        begin, end = "<!-- begin warm -->\n", "<!-- end warm -->"
        page = PAGE.read_text(encoding="utf-8")
        PAGE.write_text(page[: page.index(begin) + len(begin)] + table + page[page.index(end) :], encoding="utf-8")


if __name__ == "__main__":
    main()
