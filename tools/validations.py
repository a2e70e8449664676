"""Run the tests marked "validation": all of them, or those that a change needs most, within a time.

    ./run validate                             all; a run that passes is recorded in docs/data/last_validation.toml and docs/validation.md
    ./run validate --chosen                    those that the change needs, within 15 minutes
    ./run validate --chosen --list             what these are
    ./run validate --chosen --most-seconds N   within N seconds
    ./run validate tests/sea -k field          any other arguments go to pytest

The choice, in this order: what was running when the time of a run before this one was over; the rooms that the change touches; what a run
before this one had no time for; the rooms above, the nearest first (``tools/touched_rooms.py`` says what is touched and above); and of
the rest one fifth, by the number of commits modulo 5, so that five commits run all. A test's fifth is a checksum of its name.

What is cut off and what does not begin are counted as left out, neither passed nor failed, and remembered in the user's cache folder
until they are judged: a test that was running until it has passed, the others until they ran.
"""

from __future__ import annotations

import argparse
import datetime
import json
import os
import platform
import re
import subprocess
import sys
import tempfile
import time
import zlib
from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from seaglint.base.machine import cache_folder
from touched_rooms import RECORD, ROOT, House, NotGitError, described, git, room_of_tests, touched

PAGE = "docs/validation.md"
MOST_SECONDS = 900.0
PARTS = 5
"""Number of commits that run all of what no change touches."""
CUT, LEFT = "was cut off last time", "had no time last time"
NOTHING_COLLECTED = 5
"""Exit status of pytest where no test was selected."""


@dataclass(frozen=True)
class Place:
    """A test's place in the order, and the reason for which it was chosen."""

    rank: tuple[int, int, str]
    reason: str


@dataclass(frozen=True)
class Plan:
    """Which validations run first.

    Parameters
    ----------
    everything
        Why all are chosen; empty where they are not.
    changed
        Rooms, and files of tests, that the change touches.
    above
        Rooms, and files of tests, above them, with the number of imports between.
    fifth
        Which of the five parts of the rest is chosen.
    cut
        Tests that were running when the time was over.
    left
        Chosen tests that did not begin in that time.
    rooms
        Rooms of the package.
    """

    everything: str
    changed: tuple[str, ...]
    above: dict[str, int]
    fifth: int
    cut: tuple[str, ...] = ()
    left: tuple[str, ...] = ()
    rooms: tuple[str, ...] = ()

    def place(self, test: str) -> Place | None:
        """Return a test's place, or nothing where it is left out by choice."""
        file = test.split("::")[0]
        room = room_of_tests(file, set(self.rooms))
        waited = test in self.left
        if test in self.cut:
            return Place((0, 0, ""), CUT)
        if self.everything or room in self.changed or file in self.changed:
            return Place((1, not waited, room), "all rooms" if self.everything else "changed")
        if waited:
            return Place((2, 0, ""), LEFT)
        if steps := [self.above[name] for name in (file, room) if name in self.above]:
            return Place((3, min(steps), room), "above")
        if part_of(test) == self.fifth:
            return Place((4, 0, ""), "fifth")
        return None

    def write(self, path: Path) -> None:
        """Write the plan."""
        path.write_text(json.dumps(asdict(self)), encoding="utf-8")

    @staticmethod
    def read(path: Path) -> Plan:
        """Read a plan."""
        values = json.loads(path.read_text(encoding="utf-8"))
        return Plan(**{key: tuple(value) if isinstance(value, list) else value for key, value in values.items()})

    @staticmethod
    def write_reasons(path: Path, reasons: dict[str, str]) -> None:
        """Write, beside a plan, for which reason each test was chosen."""
        path.with_suffix(".reasons").write_text(json.dumps(reasons), encoding="utf-8")


def part_of(test: str) -> int:
    """Return the fifth of a test, the same on every machine."""
    return zlib.crc32(test.encode()) % PARTS


def commits(root: Path) -> int:
    """Return the number of commits up to the head; of a shallow clone, those that are there."""
    try:
        return int(git(root, "rev-list", "--count", "HEAD"))
    except NotGitError:
        return 0


@dataclass
class Memory:
    """What runs before this one did not judge, in the user's cache folder.

    A folder that cannot be written and a file that cannot be read are as if nothing were remembered.
    """

    cut: list[str] = field(default_factory=list)
    left: list[str] = field(default_factory=list)

    @staticmethod
    def place() -> Path:
        """Return the file."""
        return cache_folder() / "validations.json"

    @classmethod
    def read(cls) -> Memory:
        """Return what is remembered."""
        try:
            values = json.loads(cls.place().read_text(encoding="utf-8"))
            lists = [values[name] for name in ("cut", "left")]
        except (OSError, ValueError, KeyError, TypeError):
            return cls()
        return cls(*([test for test in tests if isinstance(test, str)] if isinstance(tests, list) else [] for tests in lists))

    def write(self) -> str:
        """Replace what is remembered; why that is impossible, or nothing."""
        path = self.place()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile("w", dir=path.parent, prefix="validations", delete=False, encoding="utf-8") as new:
                json.dump(asdict(self), new)
            os.replace(new.name, path)
        except OSError as error:
            return f"tests that were cut off cannot be remembered in {path}: {error.strerror or error}"
        return ""

    def after(self, run: Verdicts, reasons: dict[str, str]) -> Memory:
        """Return what is to be remembered after a run that knew the tests of ``reasons``, all that there are."""
        passed = {test for test, outcome in run.outcomes.items() if outcome != "failed"}
        cut = [test for test in dict.fromkeys((*run.cut, *self.cut)) if test in reasons and test not in passed]
        # What waits of a fifth would only grow: it comes with its fifth again.
        waiting = [*self.left, *(test for test in run.waiting if reasons.get(test) != "fifth")]
        return Memory(cut, [test for test in dict.fromkeys(waiting) if test in reasons and test not in run.outcomes and test not in cut])


@dataclass(frozen=True)
class Verdicts:
    """What a run has judged, from the file that ``--judged`` wrote."""

    outcomes: dict[str, str]
    cut: tuple[str, ...]
    waiting: tuple[str, ...]

    @classmethod
    def read(cls, path: Path) -> Verdicts:
        """Read the file; nothing where pytest did not come that far."""
        return cls.of(path.read_text(encoding="utf-8").splitlines() if path.exists() else [])

    @classmethod
    def of(cls, lines: Iterable[str]) -> Verdicts:
        """Sort the lines of the file."""
        collected: list[str] = []
        begun: list[str] = []
        outcomes: dict[str, str] = {}
        for line in lines:
            what, _, test = line.partition("\t")
            if what == "collected":
                collected.append(test)
            elif what == "begun":
                begun.append(test)
            else:
                outcomes[test] = what
        cut = tuple(test for test in begun if test not in outcomes)
        return cls(outcomes, cut, tuple(test for test in collected if test not in outcomes and test not in cut))

    def count(self, outcome: str) -> int:
        """Return the number of tests of this outcome."""
        return sum(one == outcome for one in self.outcomes.values())


def pytest_of(arguments: list[str], judged: Path | None = None) -> int:
    """Run validations on two workers; threads of linear algebra would only compete. The exit status."""
    environment = {"OPENBLAS_NUM_THREADS": "1", **os.environ}
    command = [sys.executable, "-m", "pytest", "-n", "2", "-m", "validation", *([f"--judged={judged}"] if judged else []), *arguments]
    return subprocess.run(command, cwd=ROOT, env=environment, check=False).returncode


def run_chosen(most_seconds: float, list_only: bool, judged: Path | None, arguments: list[str]) -> int:
    """Run, or list, what the change needs; the exit status of pytest."""
    began = time.monotonic()
    what = touched(ROOT)
    memory, count = Memory.read(), commits(ROOT)
    rooms = tuple(sorted(House(ROOT).rooms))
    plan = Plan(what.everything, tuple(what.changed), what.above, count % PARTS, tuple(memory.cut), tuple(memory.left), rooms)
    lines = [*described(what), f"of the rest: fifth {plan.fifth + 1} of {PARTS}, by {count} commits"]
    print(*(f"validations: {line}" for line in lines), sep="\n", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        path, judged = Path(folder) / "plan.json", judged or Path(folder) / "judged"
        plan.write(path)
        options = ["--collect-only", "-q"] if list_only else [f"--most-seconds={max(1.0, most_seconds - (time.monotonic() - began)):.0f}"]
        status = pytest_of([f"--chosen={path}", *options, *arguments], judged)
        reasons = read_reasons(path)
        if list_only:
            print(*(f"validations: {line}" for line in listed(reasons)), sep="\n")
            return status
        run = Verdicts.read(judged)
    print("", *(f"validations: {line}" for line in summary(run, reasons, most_seconds)), sep="\n")
    if reasons and not arguments and (refused := memory.after(run, reasons).write()):
        print(f"validations: {refused}")
    return 0 if status == NOTHING_COLLECTED and reasons else status


def read_reasons(path: Path) -> dict[str, str]:
    """Return what was written beside a plan; nothing where the collection failed."""
    try:
        return dict(json.loads(path.with_suffix(".reasons").read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return {}


def listed(reasons: dict[str, str]) -> list[str]:
    """Return lines on what would run and what would not, by reason and room."""
    return [*by_reason("to run", [test for test in reasons if reasons[test]], reasons), *left_by_choice(reasons)]


def summary(run: Verdicts, reasons: dict[str, str], most_seconds: float) -> list[str]:
    """Return lines on what has run and why, and on what was left out, by time and by choice."""
    late = [*run.cut, *run.waiting]
    return [
        *by_reason("ran", list(run.outcomes), reasons),
        *(f"cut off after {most_seconds:.0f} s, first next time: {test}" for test in run.cut),
        *by_reason(f"left out, the time of {most_seconds:.0f} s was over", late, reasons),
        *left_by_choice(reasons),
    ]


def left_by_choice(reasons: dict[str, str]) -> list[str]:
    """Return the line on what the other commits run."""
    left = [test for test in reasons if not reasons[test]]
    return [f"left out by choice, the other fifths: {len(left)}: {rooms_of(left)}"] if left else []


def by_reason(verb: str, tests: Iterable[str], reasons: dict[str, str]) -> list[str]:
    """Return a line for each reason."""
    groups: dict[str, list[str]] = defaultdict(list)
    for test in tests:
        groups[reasons.get(test, "")].append(test)
    order = [CUT, "all rooms", "changed", LEFT, "above", "fifth", ""]
    return [f"{verb} ({reason}): {len(groups[reason])}: {rooms_of(groups[reason])}" for reason in order if groups[reason]]


def rooms_of(tests: Iterable[str]) -> str:
    """Return rooms with their number of tests, the largest first."""
    counts = Counter(test.split("::")[0].removeprefix("tests/").split("/")[0].removesuffix(".py") for test in tests)
    return ", ".join(f"{room} {number}" for room, number in counts.most_common())


def run_whole() -> int:
    """Run all, and record a run that passes."""
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        judged = Path(folder) / "judged"
        # Each worker takes half of the tests, and who is done takes half of what the other has left, so that no long file is a floor.
        status = pytest_of(["--dist", "worksteal"], judged)
        run = Verdicts.read(judged)
    if run.outcomes and (refused := Memory.read().after(run, dict.fromkeys((*run.outcomes, *run.waiting, *run.cut), "all rooms")).write()):
        print(refused)
    if status or run.cut or run.waiting or not run.outcomes:
        print(f"not recorded in {RECORD}: {run.count('failed')} failed, {len(run.cut) + len(run.waiting)} not judged")
        return status or 1
    try:
        write_record(ROOT, recorded(ROOT, run, time.monotonic() - began))
    except (OSError, NotGitError, SystemExit) as error:
        print(f"the run has passed and is not recorded: {error}")
    else:
        print(f"recorded in {RECORD} and {PAGE}")
    return 0


def recorded(root: Path, run: Verdicts, seconds: float) -> dict[str, Any]:
    """Return what is put down of a whole run that has passed."""
    changes = git(root, "status", "--porcelain", "--", ".", f":(exclude){RECORD}", f":(exclude){PAGE}").strip()
    return {
        "commit": git(root, "rev-parse", "HEAD").strip(),
        "local_changes": bool(changes),
        "date": f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d}",
        "machine": f"{os.cpu_count()} processors, {processor()}",
        "python": platform.python_version(),
        **{outcome: run.count(outcome) for outcome in ("passed", "failed", "skipped", "xfailed")},
        "seconds": round(seconds),
    }


def processor() -> str:
    """Return the name of the processor."""
    try:
        names = re.search(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.MULTILINE)
    except OSError:
        names = None
    return names[1].strip() if names else platform.processor() or platform.machine()


def write_record(root: Path, record: dict[str, Any]) -> None:
    """Write the record and the lines of the page that show it."""
    lines = [f"{key} = {json.dumps(value)}" for key, value in record.items()]
    head = "# Written by tools/validations.py: the last whole run of the validations that passed."
    page = root / PAGE
    shown = with_block(page.read_text(encoding="utf-8"), sentence(record))
    (root / RECORD).write_text("\n".join((head, *lines)) + "\n", encoding="utf-8")
    page.write_text(shown, encoding="utf-8")


def sentence(record: dict[str, Any]) -> str:
    """Return the last whole run in words."""
    commit = f"commit {record['commit'][:9]}" + (" with local changes" if record["local_changes"] else "")
    counts = [f"{record['passed']} passed", f"{record['failed']} failed", f"{record['skipped']} skipped"]
    counts += [f"{record['xfailed']} expected to fail"] if record["xfailed"] else []
    where = f"{record['machine']}, Python {record['python']}"
    return f"Last whole run: {record['date']}, {commit} ({where}): {', '.join(counts)}, {record['seconds'] / 60:.0f} minutes."


def with_block(page: str, text: str) -> str:
    """Return a page with the text between its markers of the last run."""
    begin, end = "<!-- begin last-run -->", "<!-- end last-run -->"
    block = re.compile(rf"(?<=^{begin}\n).*?(?=^{end}$)", re.DOTALL | re.MULTILINE)
    if not block.search(page):
        raise SystemExit(f"{PAGE} lacks the lines '{begin}' and '{end}'; put them where the last run is to be shown")
    return block.sub(lambda _: f"\n{text}\n\n", page)


def seconds_of(text: str) -> float:
    """Return a limit."""
    value = float(text)
    if not 0.0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"{text} is no number of seconds above 0")
    return value


def main(arguments: list[str] | None = None) -> int:
    """Run; the exit status of pytest."""
    parser = argparse.ArgumentParser(
        prog="./run validate", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False
    )
    parser.add_argument("--chosen", action="store_true", help="run what the change needs")
    parser.add_argument("--list", action="store_true", help="with --chosen: run nothing, list the choice")
    parser.add_argument("--most-seconds", type=seconds_of, metavar="N", help=f"limit [s]; with --chosen {MOST_SECONDS:.0f} where not given")
    parser.add_argument("--judged", type=Path, metavar="FILE", help="with --chosen: write into FILE what is begun and judged, at once")
    options, others = parser.parse_known_args(arguments)
    if options.list and not options.chosen:
        parser.error("--list goes with --chosen")
    if options.chosen:
        try:
            return run_chosen(options.most_seconds or MOST_SECONDS, options.list, options.judged, others)
        except NotGitError as error:
            parser.error(f"git: {error}")
    if options.judged:
        parser.error("--judged goes with --chosen")
    if others or options.most_seconds:
        limit = [f"--most-seconds={options.most_seconds:.0f}"] if options.most_seconds else []
        return pytest_of(["--dist", "worksteal", *limit, *others])
    return run_whole()


if __name__ == "__main__":
    sys.path.insert(0, str(ROOT / "tools"))
    sys.exit(main())
