"""Disturb jobs by random faults, and write a table of what became of each.

    python benchmarks/faults.py --count 100 --seed 1 [--kinds stop,kill] [--kind-of-workers local,dask] [--only 17] [--keep-going] [--page]

Each job is a command of seaglint of 120 units over processes of this machine, a Dask cluster or shares (ensembles and data sets have 24
scenes); the finished output must have the bytes of an undisturbed job, also after a stopped worker woke up, within a limit of time, and a
fault that matters must be reported in a line. A fault is a function of the seed and its number: ``--only`` repeats one. Slow, hanging and
failing disks and wrong clocks come from ``fault_shim.c``; lost networks and full disks need root, for namespaces, and are left out with
the reason where that is lacking. The exit status is 1 if any job did not do what it must.
"""

from __future__ import annotations

import argparse
import datetime
import os
import platform
import signal
import sys
import threading
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from functools import cache
from pathlib import Path

from fault_jobs import WORKS, StoppedError, bytes_of, undisturbed
from fault_kinds import KINDS, MODES, Fault, Outcome, disturbed, drawn

PAGE = Path(__file__).resolve().parents[1] / "docs" / "validation" / "faults.md"
BEGIN, END = "<!-- begin faults -->\n", "<!-- end faults -->"
HEAD = "| number | fault | job and worker | when | outcome | seconds | line printed |\n|---|---|---|---|---|---|---|"


def references(stop: threading.Event) -> Callable[[str, int], Mapping[str, str]]:
    """Return the function that makes each undisturbed output once, and returns its checksums."""
    lock = threading.Lock()

    @cache
    def made(command: str, seed: int) -> Mapping[str, str]:
        with undisturbed(WORKS[command], seed, stop) as site:
            return bytes_of(site.seen / site.work.output)

    def expected(command: str, seed: int) -> Mapping[str, str]:
        with lock:
            return made(command, seed)

    return expected


def row(number: int, outcome: Outcome) -> str:
    """Return an outcome as a row of the table."""
    fault = outcome.fault
    line = max(outcome.lines, key=len, default="" if outcome.told else "NONE")
    result = outcome.result + (", the fault came after its end" if outcome.late else "")
    cells = (str(number), fault.what, fault.where, fault.when, result, f"{outcome.seconds:.0f}", line.replace("|", "/")[:240])
    return f"| {' | '.join(cells)} |"


def summary(outcomes: Iterable[Outcome]) -> str:
    """Return how many jobs of each kind did what."""
    kinds: dict[str, list[Outcome]] = defaultdict(list)
    for outcome in outcomes:
        kinds[outcome.fault.kind].append(outcome)
    lines = ["| fault | jobs | same bytes | of these after a second command | hang | other bytes or files | not reported | not tried |"]
    lines.append("|---" * 8 + "|")
    total = [0] * 7
    for kind in sorted(kinds, key=list(KINDS).index):
        numbers = [
            len(kinds[kind]),
            sum(one.result.startswith("same bytes") for one in kinds[kind]),
            sum(one.result.startswith("same bytes after") for one in kinds[kind]),
            sum("HANGS" in one.result for one in kinds[kind]),
            sum(not one.result.startswith(("same bytes", "HANGS", "not tried")) for one in kinds[kind]),
            sum(not one.told for one in kinds[kind]),
            sum(one.result.startswith("not tried") for one in kinds[kind]),
        ]
        total = [a + b for a, b in zip(total, numbers, strict=True)]
        lines.append(f"| {kind} | {' | '.join(map(str, numbers))} |")
    lines.append(f"| all | {' | '.join(map(str, total))} |")
    return "\n".join(lines)


def campaign(faults: Mapping[int, Fault], limit: float, at_once: int, keep_going: bool) -> list[Outcome]:
    """Run a job for each fault, and print its row when it has ended."""
    stop, outcomes = threading.Event(), dict[int, Outcome]()
    expected = references(stop)

    def run(fault: Fault) -> Outcome:
        expected(fault.command, 7)  # before the job: no time of it is spent on this
        return disturbed(fault, expected, limit, stop)

    print(HEAD, flush=True)
    with ThreadPoolExecutor(at_once) as pool:
        jobs = {pool.submit(run, fault): number for number, fault in faults.items()}
        try:
            for job in as_completed(jobs):
                number, outcome = jobs[job], job.result()
                outcomes[number] = outcome
                print(row(number, outcome), flush=True)
                if not outcome.good and not keep_going:
                    print(f"stopped at fault {number}; --keep-going goes on, --only {number} repeats it", file=sys.stderr)
                    break
        except (KeyboardInterrupt, StoppedError):
            print("stopped; processes, namespaces and folders of the jobs are removed", file=sys.stderr)
        finally:
            stop.set()
            pool.shutdown(wait=True, cancel_futures=True)
    return [outcomes[number] for number in sorted(outcomes)]


def main() -> int:
    """Run the campaign of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100, help="number of faults")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", default=",".join(KINDS), help="of faults")
    parser.add_argument("--kind-of-workers", default=",".join(MODES))
    parser.add_argument("--commands", default=",".join(WORKS))
    parser.add_argument("--only", help="numbers of single faults: 3,17")
    parser.add_argument("--limit", type=float, default=240.0, help="seconds after which a job hangs")
    parser.add_argument("--at-once", type=int, default=1, help="jobs at the same time: most of their time is spent on waiting")
    parser.add_argument("--keep-going", action="store_true", help="go on after a job that did not do what it must")
    parser.add_argument("--list", action="store_true", help="print the faults and run nothing")
    parser.add_argument("--page", action="store_true", help=f"write the numbers of jobs into docs/validation/{PAGE.name}")
    given = parser.parse_args()
    chosen = [tuple(text.split(",")) for text in (given.kinds, given.kind_of_workers, given.commands)]
    for names, allowed in zip(chosen, (KINDS, MODES, WORKS), strict=True):
        if unknown := [name for name in names if name not in allowed]:
            parser.error(f"{', '.join(unknown)}: allowed are {', '.join(allowed)}")
    numbers = range(given.count) if given.only is None else [int(number) for number in given.only.split(",")]
    faults = {number: drawn(given.seed, number, *chosen) for number in numbers}
    if given.list:
        for number, fault in faults.items():
            print(f"{number}: {fault.what}; {fault.where}; {fault.when}")
        return 0
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    outcomes = campaign(faults, given.limit, given.at_once, given.keep_going)
    machine = f"{os.cpu_count()} processors, Python {platform.python_version()}"
    setting = f"{datetime.date.today()}: {len(outcomes)} of {len(faults)} jobs, seed {given.seed}, limit {given.limit:g} s; {machine}."
    text = f"{setting}\n\n{summary(outcomes)}\n"
    print(f"\n{text}", end="")
    if given.page:
        head, rest = PAGE.read_text(encoding="utf-8").split(BEGIN, 1)
        PAGE.write_text(f"{head}{BEGIN}\n{text}\n{END}{rest.split(END, 1)[1]}", encoding="utf-8")
    return 0 if len(outcomes) == len(faults) and all(outcome.good for outcome in outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
