"""Kinds of faults, their random draws, and what becomes of a job that one of them disturbs."""

from __future__ import annotations

import contextlib
import errno
import math
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from fault_jobs import SHARES, WORKS, Process, Running, Site, shim

MODES: Final = ("local", "dask", "shards")
"""Kinds of workers: processes of this machine, a Dask cluster, shares of a batch array."""

FOREVER: Final = math.inf

MOMENT: Final = 4
"""Longest time until the moment of a fault, in limits of a job."""

AFTER: Final = 3.0
"""Time that a process has to do harm after it woke up [s]."""

KINDS: Final[Mapping[str, tuple[str, ...]]] = {
    "stop": MODES,
    "kill": MODES,
    "stop-scheduler": ("dask",),
    "slow-disk": MODES,
    "hanging-disk": MODES,
    "failing-disk": MODES,
    "full-disk": MODES,
    "network": ("dask",),
    "clock": MODES,
    "file-times": MODES,
    "shares-at-once": ("shards",),
    "share-twice": ("shards",),
    "job-twice": ("local", "dask"),
}
"""Kinds of faults, and the kinds of workers that each is tried with."""

SHIMMED: Final = ("slow-disk", "hanging-disk", "failing-disk", "clock")
LASTING: Final = ("stop", "hanging-disk", "network")
"""Faults after which a worker comes back, or does not."""

LENGTHS: Final[Mapping[str, tuple[float, ...]]] = {
    "stop": (3.0, 60.0, FOREVER),
    "hanging-disk": (10.0, 60.0, FOREVER),
    "network": (10.0, 60.0, FOREVER),
    "stop-scheduler": (2.0, 6.0),
    "slow-disk": (5.0, 20.0),
    "failing-disk": (2.0, FOREVER),
}
"""Durations from which one is drawn [s]."""

OTHERS: Final = 0.12
"""Share of the jobs that are ensembles and data sets."""

TWICE: Final = ("share-twice", "job-twice")
WEIGHTS: Final = {"stop": 4.0, "hanging-disk": 2.0, "network": 2.0, "full-disk": 2.0}
"""Shares of the draws, where they differ from 1."""


@dataclass(frozen=True)
class Fault:
    """One fault: what, where, when and for how long."""

    kind: str
    mode: str  #: Kind of workers.
    command: str
    at: float  #: Share of the units that are finished when it begins; below 0 the time since the job's start, negative [s].
    seconds: float  #: Duration; infinite where it ends after the job, or never [s].
    target: int  #: Number of the worker.
    workers: int  #: Number of workers.
    nanny: bool  #: Flag of Dask workers that a nanny watches.
    then: str  #: After the job: ``"wake"`` the worker, wake it within a second job that will ``"overwrite"`` the output, or ``"end"`` it.
    amount: int  #: Delay of each access to a slow disk [ms], or error of clock and file times [s].

    @property
    def what(self) -> str:
        """Return kind and size as text."""
        sizes = {"slow-disk": f" by {self.amount} ms", "clock": f" by {self.amount:+d} s", "file-times": f" by {self.amount:+d} s"}
        length = "" if self.kind in ("kill", "full-disk", "shares-at-once", *TWICE) or self.seconds == 0.0 else f", {self.length}"
        return self.kind + sizes.get(self.kind, "") + length

    @property
    def length(self) -> str:
        """Return the duration as text."""
        if self.seconds < FOREVER:
            return f"{self.seconds:.0f} s"
        return {"wake": "until after the job", "overwrite": "until within a second job", "end": "for ever"}[self.then]

    @property
    def where(self) -> str:
        """Return command and workers as text."""
        nanny = ", nanny" if self.mode == "dask" and self.nanny else ""
        return f"{self.command}, {self.workers if self.mode != 'shards' else SHARES} {self.mode}{nanny}, number {self.target}"

    @property
    def when(self) -> str:
        """Return the moment as text."""
        if self.kind in ("shares-at-once", *TWICE):
            return "start"
        return f"{100 * self.at:.0f} % of the units" if self.at >= 0 else f"{-self.at:.1f} s"


def drawn(
    seed: int, index: int, kinds: tuple[str, ...] = tuple(KINDS), modes: tuple[str, ...] = MODES, commands: tuple[str, ...] = ("render",)
) -> Fault:
    """Draw the fault number ``index`` of a campaign."""
    random = np.random.default_rng([seed, index])
    pairs = [(kind, mode) for kind in kinds for mode in KINDS[kind] if mode in modes]
    weights = np.array([WEIGHTS.get(kind, 1.0) / sum(mode in modes for mode in KINDS[kind]) for kind, _ in pairs])
    kind, mode = pairs[int(random.choice(len(pairs), p=weights / weights.sum()))]
    workers = int(random.integers(2, 4))
    others = [command for command in commands if command != "render"]
    command = str(random.choice(others)) if mode != "shards" and others and random.random() < OTHERS else "render"
    sign = int(random.choice([-1, 1]))
    return Fault(
        kind=kind,
        mode=mode,
        command=command,
        at=float(random.uniform(0.0, 0.95)) if random.random() < 0.85 else -float(random.uniform(0.5, 6.0)),
        seconds=float(random.choice(LENGTHS.get(kind, (0.0,)))),
        target=int(random.integers(0, SHARES if mode == "shards" else workers)),
        workers=workers,
        nanny=bool(random.integers(0, 2)),
        then=str(random.choice(["wake", "overwrite", "end"] if mode != "shards" else ["wake", "end"])),
        amount=int(random.choice([20, 100, 500])) if kind == "slow-disk" else sign * 3600,
    )


def lacking(fault: Fault) -> str:
    """Return the reason why a fault cannot be tried on this machine; empty where it can."""
    if sys.platform != "linux":
        return "needs /proc"
    if fault.kind in SHIMMED and shim() is None:
        return "needs a C compiler"
    if fault.kind in ("network", "full-disk"):
        if os.geteuid() != 0:
            return "needs root"
        absent = [name for name in ("unshare", "nsenter", "ip", "mount") if shutil.which(name) is None]
        if absent:
            return f"needs {', '.join(absent)}"
        space = "-n" if fault.kind == "network" else "-m"
        if subprocess.run(["unshare", space, "true"], capture_output=True, check=False).returncode != 0:
            return f"namespaces are not permitted (unshare {space})"
    return ""


@dataclass
class Outcome:
    """What became of a job with a fault."""

    fault: Fault
    result: str = ""  #: What became of the output.
    seconds: float = 0.0
    lines: tuple[str, ...] = ()  #: What the commands printed beyond the lines of an undisturbed job.
    late: bool = False  #: Flag of a job that was finished, or nearly, before the fault began.
    told: bool = True  #: False where a fault that matters was not reported in a line.

    @property
    def good(self) -> bool:
        """Return true for the same bytes, and a line where the fault matters."""
        return self.result.startswith(("same bytes", "not tried")) and self.told


def _nothing() -> None:
    """End a fault that does not last."""


class Wrong(Exception):  # noqa: N818 (a finding, not an error of the program)
    """The job did not do what it must."""


@dataclass
class Disturbed:
    """A job with a fault, from its start to the comparison of its bytes."""

    fault: Fault
    expected: Callable[[str, int], Mapping[str, str]]  #: Checksums of the undisturbed output of a command, by its seed.
    site: Site
    link: str = ""
    there: list[str] | None = None
    address: str = ""
    left: int = 0
    """Number of units that were missing when the fault began."""
    end: Callable[[], None] | None = None
    """Function that ends the fault; None where it does not last."""

    def run(self) -> Outcome:
        """Run the job; see ``Outcome``."""
        outcome, began = Outcome(self.fault), time.monotonic()
        try:
            outcome.result = self._result(outcome)
        except Wrong as wrong:
            outcome.result = str(wrong)
        outcome.seconds = time.monotonic() - began
        outcome.lines = tuple(line for command in self.site.commands for line in command.lines())
        if any(line.startswith("Traceback") for line in outcome.lines):
            outcome.result = f"TRACEBACK, {outcome.result}"
        outcome.told = bool(outcome.lines) or outcome.late or not self._matters()
        return outcome

    def _matters(self) -> bool:
        """Return true for faults that take away a worker with a unit in progress, or that end a command."""
        fault = self.fault
        if fault.kind in TWICE or any(command.code for command in self.site.commands):
            return True
        if fault.mode == "shards" and fault.seconds < math.inf:  # a share that goes on by itself keeps nobody waiting
            return False
        # A worker that is lost before its first unit or after its last one keeps no unit back.
        busy = fault.at >= 0.0 and self.left >= 4 * fault.workers
        return busy and (fault.kind == "kill" or (fault.kind in LASTING and fault.seconds >= 60.0))

    def _result(self, outcome: Outcome) -> str:
        site, fault = self.site, self.fault
        self._start()
        self.end = self._begin_in_time()
        outcome.late = self.end is None
        self._wait()
        how = self._completed()
        self._compare(self.expected(fault.command, site.seed), "")
        lasts = self.end not in (None, _nothing)
        if lasts and fault.then == "overwrite":
            return how + self._second_job()
        if lasts and fault.then != "end":
            self._end()
            time.sleep(AFTER)
            self._compare(self.expected(fault.command, site.seed), " after the worker woke up")
        return how

    def _end(self) -> None:
        """End the fault, if it lasts."""
        if self.end is not None:
            self.end()
            self.end = None

    def _start(self) -> None:
        """Start the job, with what it needs around it."""
        site, fault = self.site, self.fault
        if fault.kind == "full-disk":
            site.small_disk()
        if fault.mode == "local":
            site.start_local(fault.workers)
        elif fault.mode == "dask":
            host = "127.0.0.1"
            if fault.kind == "network":
                host, self.there, self.link = site.network()
            self.address = site.start_scheduler(host)
            for index in range(fault.workers):
                site.start_worker(self.address, index, nanny=fault.nanny, prefix=self.there if index == fault.target else None)
            self._command()
        else:
            for index in range(SHARES):
                site.start_share(index)
            if fault.kind == "share-twice":
                site.start_share(fault.target)
        if fault.kind == "job-twice":
            self._command()

    def _command(self, *options: str) -> Running:
        """Start the command once more, or with other options."""
        if self.fault.mode == "dask":
            return self.site.start("--dask", self.address, *options, role="command")
        return self.site.start_local(self.fault.workers, *options)

    def _begin_in_time(self) -> Callable[[], None] | None:
        """Begin the fault at its moment; return the function that ends it, or None where the job has ended before."""
        site, fault = self.site, self.fault
        began, units = time.monotonic(), site.work.units

        def now() -> bool:
            reached = site.work.done(site.seen) >= fault.at * units if fault.at >= 0 else time.monotonic() - began >= -fault.at
            return (reached and (fault.at < 0 or site.work.begun(site.seen).exists())) or site.ended()

        if not site.wait(now, MOMENT * site.limit):
            raise Wrong(f"HANGS before the fault, at {site.work.done(site.seen)} of {units}")
        if site.ended():
            return None
        self.left = units - site.work.done(site.seen)
        return self._begin()

    def _target(self) -> Process | None:
        """Return the process that is at fault; None where the job ends before it is there."""
        found: list[Process] = []

        def there() -> bool:
            found[:] = self.site.workers(self.fault.mode)
            if self.fault.mode != "local":
                found[:] = [p for p in found if p.role.endswith(f"-{self.fault.target}")]
            return bool(found) or self.site.ended()

        self.site.wait(there, 60.0)
        return found[self.fault.target % len(found)] if found else None

    def _begin(self) -> Callable[[], None] | None:
        """Begin the fault; return the function that ends it."""
        site, fault = self.site, self.fault
        match fault.kind:
            case "shares-at-once" | "share-twice" | "job-twice":
                return _nothing
            case "stop-scheduler":
                os.kill(site.helpers[0].pid, signal.SIGSTOP)
                return lambda: os.kill(site.helpers[0].pid, signal.SIGCONT)
            case "full-disk":
                filler = site.seen / "filler"
                with contextlib.suppress(OSError), filler.open("wb", buffering=0) as file:
                    while True:
                        file.write(b"\1" * 4096)
                return lambda: filler.unlink(missing_ok=True)
            case "network":
                subprocess.run(["ip", "link", "set", self.link, "down"], check=True)
                return lambda: subprocess.run(["ip", "link", "set", self.link, "up"], check=False) and None
            case "file-times":
                self._touch()
                return _nothing
        process = self._target()
        if process is None:
            return None
        match fault.kind:
            case "stop":
                process.send(signal.SIGSTOP)
                return lambda: process.send(signal.SIGCONT)
            case "kill":
                process.send(signal.SIGKILL)
                return _nothing
        disturbance = {
            "slow-disk": {"delay_ms": fault.amount},
            "hanging-disk": {"delay_ms": -1},
            "failing-disk": {"error": errno.EIO},
            "clock": {"clock_s": fault.amount},
        }
        site.table.set(process.number, **disturbance[fault.kind])
        return site.table.clear if fault.kind != "clock" else _nothing

    def _touch(self) -> None:
        """Change the times of a tenth of the files for two seconds, those of locks and unfinished writes among them."""
        random, until = np.random.default_rng(self.fault.target), time.monotonic() + 2.0
        while time.monotonic() < until and not self.site.ended():
            for folder, names, files in os.walk(self.site.seen):
                for name in names + files:
                    if random.random() < 0.1:
                        with contextlib.suppress(OSError):
                            os.utime(os.path.join(folder, name), (time.time() + self.fault.amount,) * 2)
            time.sleep(0.05)

    def _wait(self) -> None:
        """Wait for the commands; the fault ends in its time."""
        site, fault = self.site, self.fault
        began = time.monotonic()
        if 0.0 < fault.seconds < FOREVER and not site.wait(site.ended, fault.seconds):
            self._end()
        limit = site.limit - (time.monotonic() - began)
        if fault.mode == "shards" and fault.seconds == FOREVER and fault.kind in LASTING:
            self._batch_limit(limit)
        elif not site.wait(site.ended, limit):
            raise Wrong(f"HANGS at {site.work.done(site.seen)} of {site.work.units}")

    def _batch_limit(self, limit: float) -> None:
        """Do what a batch queue does: end a share that goes on for too long, after an attempt to finish without it."""
        site = self.site
        if not site.wait(lambda: sum(command.code is None for command in site.commands) <= 1, limit):
            raise Wrong("HANGS: shares without a fault do not end")
        if site.wait(site.ended, 10.0):
            return
        late = next(command for command in site.commands if command.code is None)
        finish = site.start("--finish", role="finish")
        if not site.wait(lambda: finish.code is not None, limit):
            raise Wrong("HANGS: --finish waits for a share that does not end")
        if finish.code == 0:
            raise Wrong("FINISHED without a share that has not ended")
        for process in site.workers("shards"):
            if process.number == late.process.pid:
                process.send(signal.SIGKILL)
        site.wait(site.ended, 10.0)

    def _completed(self) -> str:
        """Do what users do after an error; return how the job came to its end."""
        site, fault = self.site, self.fault
        codes = [command.code for command in site.commands]
        if fault.mode == "shards":
            first = self._ended(site.start("--finish", role="finish"))
            if first == 0:
                return self._at_once()
            self._require_unfinished()
            self._end()
            for index in range(SHARES):
                if codes[index] != 0:
                    self._ended(site.start_share(index))
            if self._ended(site.start("--finish", role="finish")) != 0:
                raise Wrong("NOT FINISHED by a second run of the share")
            return "same bytes after a second run of the share"
        if 0 in codes:
            return self._at_once()
        self._require_unfinished()
        self._end()
        if self._ended(self._command("--resume")) != 0:
            raise Wrong("NOT FINISHED by --resume")
        if fault.kind != "full-disk":  # whatever happens to one worker, the others do the rest
            raise Wrong("ENDED in an error; same bytes after --resume" if self._same() else "ENDED in an error; OTHER BYTES after --resume")
        return "same bytes after --resume"

    def _at_once(self) -> str:
        if self.fault.kind == "full-disk":
            self._end()
        return "same bytes"

    def _require_unfinished(self) -> None:
        """Require that no output has its name after an error."""
        if not self.site.work.under_its_name and (self.site.seen / self.site.work.output).exists():
            raise Wrong("PASSES FOR COMPLETE after an error")

    def _ended(self, command: Running) -> int:
        """Wait for a further command; return its exit status."""
        if not self.site.wait(lambda: command.code is not None):
            raise Wrong(f"HANGS in {' '.join(map(str, command.process.args[-2:]))}")  # type: ignore[union-attr, index]
        return int(command.code or 0)

    def _same(self) -> bool:
        return self.site.result() == self.expected(self.fault.command, self.site.seed)

    def _compare(self, expected: Mapping[str, str], when: str) -> None:
        """Require the expected bytes, and nothing beside them."""
        found = self.site.result()
        if found != expected:
            differ = sorted(name for name in found.keys() | expected.keys() if found.get(name) != expected.get(name))
            raise Wrong(f"OTHER BYTES{when}: {len(differ)} files, {differ[0]}")
        if strays := self.site.strays():
            raise Wrong(f"STRAY FILES{when}: {', '.join(strays[:3])}")

    def _second_job(self) -> str:
        """Overwrite the output with another seed, and wake the worker meanwhile."""
        site, other = self.site, self.site.seed + 1
        options = ("--dask", self.address) if self.fault.mode == "dask" else ("--workers", str(self.fault.workers))
        command = site.start(*options, "--overwrite", role="command", scenario=site.write_scenario(other))

        if not site.wait(lambda: command.code is not None or site.work.written(site.seen) >= site.work.units // 2):
            raise Wrong("HANGS in the second job")
        self._end()
        if self._ended(command) != 0:
            raise Wrong("ENDED in an error in the second job")
        time.sleep(AFTER)
        self._compare(self.expected(self.fault.command, other), " after a second job")
        return ", of a second job too"


def disturbed(
    fault: Fault, expected: Callable[[str, int], Mapping[str, str]], limit: float = 240.0, stop: threading.Event | None = None
) -> Outcome:
    """Run a job with a fault in a folder of its own, and clean up after it."""
    if reason := lacking(fault):
        return Outcome(fault, f"not tried: {reason}")
    with Site(WORKS[fault.command], limit=limit, stop=stop or threading.Event(), shimmed=fault.kind in SHIMMED) as site:
        return Disturbed(fault, expected, site).run()
