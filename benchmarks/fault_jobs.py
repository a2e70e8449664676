"""Jobs that faults disturb: commands of seaglint in processes of their own, in a folder of their own.

All processes of a job carry a random word in their environment, by which they are found and ended, whoever their parent is.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import hashlib
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

PYTHON = [sys.executable, "-P"]
SEAGLINT = [*PYTHON, "-c", "import sys; from seaglint.cli.app import main; sys.exit(main())"]
WORD, ROLE = "SEAGLINT_FAULT_JOB", "SEAGLINT_FAULT_ROLE"
"""Names of the variables by which a job's processes are found."""

SHARES = 3
"""Number of shares of a job in shares."""

ORDINARY = re.compile(r"^$|\d+ (frames|scenes|images)|^seaglint: .*share \d+/\d+ is done|^share \d|^next: |^estimate: |^scenes: ")
"""Lines that commands print without a fault, too."""


class StoppedError(Exception):
    """The campaign was stopped."""


@dataclass(frozen=True)
class Work:
    """Command whose units are disturbed."""

    command: str
    units: int
    scenario: str  #: File, with ``SEED`` in the place of the seed.
    output: str  #: Name of the output.
    units_done: tuple[str, ...]  #: Patterns of the files of which each finished unit has one, below the output.
    under_its_name: bool = False  #: Flag of an output that has its name from the start.

    def begun(self, folder: Path) -> Path:
        """Return the name of the unfinished output."""
        return folder / (self.output if self.under_its_name else f"{self.output}.partial")

    def written(self, folder: Path) -> int:
        """Return the number of finished units of an unfinished output."""
        with contextlib.suppress(FileNotFoundError):  # it is renamed in this moment
            return max(len(list(self.begun(folder).glob(pattern))) for pattern in self.units_done)
        return 0

    def done(self, folder: Path) -> int:
        """Return the number of finished units."""
        return self.units if not self.under_its_name and (folder / self.output).exists() else self.written(folder)


CAMERA = "pixels = [32, 16]\nfov_deg = [0.8, 0.4]\nelevation_deg = -3\n"
WINDS = '[[vary]]\nkey = "wind.speed_m_s"\nlaw = "uniform"\nmin = 2\nmax = 9\n'
BOAT = '[[base.objects]]\nname = "boat"\npreset = "small-boat"\neast_m = 0\nnorth_m = -600\nheading_deg = 60\n'
SCENES = 24
"""Number of scenes of ensembles and data sets; each takes many times as long as a frame."""

RENDER = Work("render", 120, f"seed = SEED\n[sensor]\n{CAMERA}frames = 120\n", "run.zarr", ("frame_done/c/*[0-9]",))
ENSEMBLE = Work(
    "ensemble",
    SCENES,
    f"[base.sensor]\n{CAMERA}[ensemble]\nscenes = {SCENES}\nframes = 1\nseed = SEED\n{WINDS}",
    "scenes",
    ("scenes/*.zarr",),
    under_its_name=True,
)
DATASET = Work(
    "dataset",
    SCENES,
    f"[base.sensor]\n{CAMERA.replace('0.8, 0.4', '4, 2')}{BOAT}[ensemble]\nscenes = {SCENES}\nframes = 1\nseed = SEED\n{WINDS}",
    "data",
    (".parts/*", ".ensemble/scenes/*.zarr", "images/*"),
)
WORKS = {work.command: work for work in (RENDER, ENSEMBLE, DATASET)}


def bytes_of(folder: Path) -> dict[str, str]:
    """Return the checksums of all files below a folder, by their relative paths."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@dataclass
class Process:
    """Process of a job."""

    number: int
    role: str
    command: str

    @property
    def works(self) -> bool:
        """Return true for a process that does units: a local process, or one below a Dask nanny."""
        return "seaglint.cluster.process" in self.command or "spawn_main" in self.command

    def send(self, kind: signal.Signals) -> None:
        """Send a signal, if the process still lives."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.number, kind)


def _descendants() -> list[int]:
    """Return the numbers of the processes below this one."""
    parents: dict[int, list[int]] = {}
    for folder in Path("/proc").iterdir():
        if folder.name.isdigit():
            with contextlib.suppress(OSError):
                parent = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
                parents.setdefault(parent, []).append(int(folder.name))
    found = [os.getpid()]
    for number in found:
        found += parents.get(number, [])
    return sorted(found[1:])


@cache
def adopt_orphans() -> None:
    """Become the parent of processes whose parent ends, so that all processes of a job stay below this one."""
    ctypes.CDLL(None).prctl(36, 1, 0, 0, 0)  # PR_SET_CHILD_SUBREAPER


def processes_with(word: str) -> list[Process]:
    """Return the living processes below this one that carry a word in their environment."""
    found = []
    for number in _descendants():
        folder = Path(f"/proc/{number}")
        with contextlib.suppress(OSError):
            variables = dict(line.split("=", 1) for line in (folder / "environ").read_text(errors="replace").split("\0") if "=" in line)
            if variables.get(WORD, "") == word:
                command = (folder / "cmdline").read_text(errors="replace").replace("\0", " ")
                found.append(Process(number, variables.get(ROLE, ""), command))
    return found


@cache
def shim() -> Path | None:
    """Compile ``fault_shim.c``; return None without a compiler."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None or sys.platform != "linux":
        return None
    source = Path(__file__).with_name("fault_shim.c")
    folder = tempfile.mkdtemp(prefix="faults-shim-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    made = Path(folder) / "fault_shim.so"
    subprocess.run([compiler, "-O1", "-shared", "-fPIC", "-o", str(made), str(source), "-ldl"], check=True)
    return made


class FaultTable:
    """Rows of ``fault_shim.c``: which process's disk and clock are at fault, and how."""

    ROWS, ROW = 64, struct.Struct("4i")

    def __init__(self, path: Path) -> None:
        self.path, self.rows = path, [(0, 0, 0, 0)] * self.ROWS
        self._write()

    def set(self, process: int, *, delay_ms: int = 0, error: int = 0, clock_s: int = 0) -> None:
        """Disturb a process, or all of the job with -1."""
        free = next(index for index, row in enumerate(self.rows) if row[0] in (0, process))
        self.rows[free] = (process, delay_ms, error, clock_s)
        self._write()

    def clear(self) -> None:
        """End all disturbances."""
        self.rows = [(0, 0, 0, 0)] * self.ROWS
        self._write()

    def _write(self) -> None:
        # the file is mapped by the processes: its bytes are changed, and the file stays
        with self.path.open("r+b" if self.path.exists() else "wb") as file:
            file.write(b"".join(self.ROW.pack(*row) for row in self.rows))


@dataclass
class Running:
    """Command that was started, and the file with all that it prints."""

    process: subprocess.Popen[bytes]
    printed: Path

    @property
    def code(self) -> int | None:
        """Return the exit status; None while it runs."""
        return self.process.poll()

    def lines(self) -> list[str]:
        """Return the lines that the command printed and that are not those of an undisturbed job."""
        text = self.printed.read_text(errors="replace").splitlines()
        return [line.strip() for line in text if not ORDINARY.search(line)]


@dataclass
class Site:
    """Place of one job: its folder, its processes, and the namespaces and mounts around them.

    Leaving the context ends all processes, stopped ones too; namespaces, mounts and links end with them.
    """

    work: Work
    seed: int = 7
    limit: float = 240.0  #: Longest time until all commands of a stage have ended [s].
    stop: threading.Event = field(default_factory=threading.Event)  #: Set where the campaign is stopped.
    shimmed: bool = False  #: Flag of processes whose disk and clock can be disturbed.

    def __enter__(self) -> Site:
        adopt_orphans()
        self.word = uuid.uuid4().hex
        self.top = Path(tempfile.mkdtemp(prefix="faults-"))
        self.prefix: list[str] = []
        self.seen = self.output_folder = self.top / "output"
        """The folder of the output as this process finds it, and as the job does: they differ in a mount namespace."""
        self.output_folder.mkdir()
        self.commands: list[Running] = []
        self.helpers: list[subprocess.Popen[bytes]] = []
        self.table = FaultTable(self.top / "table")
        self.scenario = self.write_scenario(self.seed)
        return self

    def __exit__(self, *error: object) -> None:
        # a process may have started another one in the meantime
        while left := processes_with(self.word):
            for process in left:
                process.send(signal.SIGKILL)
            for child in (*self.helpers, *(command.process for command in self.commands)):
                child.poll()
            time.sleep(0.02)
        for child in (*self.helpers, *(command.process for command in self.commands)):
            child.wait()
        shutil.rmtree(self.top, ignore_errors=True)

    def write_scenario(self, seed: int) -> Path:
        """Write the file of the scenario or ensemble with a seed."""
        path = self.top / f"seed-{seed}.toml"
        path.write_text(self.work.scenario.replace("SEED", str(seed)))
        return path

    def environment(self, role: str) -> dict[str, str]:
        """Return the environment of a process of this job."""
        path = os.pathsep.join(os.path.abspath(p) for p in sys.path if p)
        variables = os.environ | {WORD: self.word, ROLE: role, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1"}
        if self.shimmed:
            table = {"SEAGLINT_FAULT_TABLE": str(self.table.path), "SEAGLINT_FAULT_FOLDER": str(self.output_folder)}
            variables |= table | {"LD_PRELOAD": str(shim())}
        return variables

    def start(self, *options: str, role: str, scenario: Path | None = None) -> Running:
        """Start the command with some options."""
        given = [str(scenario or self.scenario), "-o", str(self.output_folder / self.work.output), "--progress", "none", *options]
        printed = self.top / f"printed-{len(self.commands)}"
        with printed.open("wb") as file:
            process = subprocess.Popen(
                [*self.prefix, *SEAGLINT, self.work.command, *given],
                env=self.environment(role),
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        self.commands.append(Running(process, printed))
        return self.commands[-1]

    def help(self, *command: str, role: str, prefix: list[str] | None = None) -> subprocess.Popen[bytes]:
        """Start a process that the commands need: a scheduler, a worker, the holder of a namespace."""
        with (self.top / f"log-{role}").open("ab") as file:
            process = subprocess.Popen(
                [*(self.prefix if prefix is None else prefix), *command],
                env=self.environment(role),
                stdin=subprocess.DEVNULL,
                stdout=file,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        self.helpers.append(process)
        return process

    def workers(self, mode: str) -> list[Process]:
        """Return the processes that do units."""
        processes = processes_with(self.word)
        if mode == "local":
            return [process for process in processes if process.role == "command" and process.works]
        if mode == "dask":
            dask = [process for process in processes if process.role.startswith("worker-")]
            return [p for p in dask if p.works or not any(q.works and q.role == p.role for q in dask)]
        return [process for process in processes if process.role.startswith("share-") and "seaglint.cli.app" in process.command]

    def wait(self, true: Callable[[], bool], limit: float | None = None) -> bool:
        """Wait until something is true; return false after the limit.

        Raises
        ------
        StoppedError
            The campaign was stopped.
        """
        until = time.monotonic() + (self.limit if limit is None else limit)
        while not true():
            if self.stop.is_set():
                raise StoppedError
            if time.monotonic() > until:
                return False
            time.sleep(0.005)
        return True

    def ended(self) -> bool:
        """Return true where all commands have ended."""
        return all(command.code is not None for command in self.commands)

    def result(self) -> dict[str, str]:
        """Return the checksums of the output."""
        return bytes_of(self.seen / self.work.output)

    def strays(self) -> list[str]:
        """Return the names beside the output."""
        return sorted(path.name for path in self.seen.iterdir() if path.name != self.work.output)

    # --- the three kinds of workers

    def start_local(self, count: int, *options: str, scenario: Path | None = None) -> Running:
        """Start the command with processes of this machine."""
        return self.start("--workers", str(count), *options, role="command", scenario=scenario)

    def start_scheduler(self, host: str = "127.0.0.1") -> str:
        """Start a Dask scheduler; return its address."""
        with socket.socket() as probe:
            probe.bind((host, 0))
            port = int(probe.getsockname()[1])
        self.help(*dask("scheduler"), "--host", host, "--port", str(port), "--no-dashboard", role="scheduler")
        self.wait(lambda: _listens(host, port))
        return f"tcp://{host}:{port}"

    def start_worker(self, address: str, index: int, *, nanny: bool, prefix: list[str] | None = None) -> None:
        """Start a Dask worker."""
        options = ("--nthreads", "1", "--no-dashboard", "--local-directory", str(self.top / f"worker-{index}"))
        alone = () if nanny else ("--no-nanny",)
        self.help(*dask("worker"), address, *options, *alone, role=f"worker-{index}", prefix=prefix)

    def start_share(self, index: int) -> Running:
        """Start a share of the work."""
        return self.start("--shard", f"{index}/{SHARES}", role=f"share-{index}")

    # --- surroundings that need root

    def small_disk(self, size: str = "64m") -> None:
        """Give the job an output on a small file system, in a mount namespace."""
        script = f"mount -t tmpfs -o size={size} tmpfs {self.output_folder} && exec sleep infinity"
        holder = self.help("unshare", "-m", "--propagation", "private", "sh", "-c", script, role="disk")
        self.seen = Path(f"/proc/{holder.pid}/root{self.output_folder}")
        mounts = Path(f"/proc/{holder.pid}/mounts")
        if not self.wait(lambda: str(self.output_folder) in mounts.read_text(), 20):
            raise OSError("the small file system was not mounted")
        self.prefix = ["nsenter", "-m", "-t", str(holder.pid), "--"]

    def network(self) -> tuple[str, list[str], str]:
        """Make a network namespace; return this machine's address in it, the prefix of commands that run there, and the link's name."""
        name = f"sf{self.word[:8]}"
        net = f"10.{64 + int(self.word[:2], 16) % 64}.{int(self.word[2:4], 16)}"
        holder = self.help("unshare", "-n", "sh", "-c", "ip link set lo up && exec sleep infinity", role="network")
        own = os.readlink("/proc/self/ns/net")
        self.wait(lambda: os.readlink(f"/proc/{holder.pid}/ns/net") != own, 20)
        there = ["nsenter", "-n", "-t", str(holder.pid), "--"]
        for command in (
            ["ip", "link", "add", f"{name}a", "type", "veth", "peer", "name", f"{name}b", "netns", str(holder.pid)],
            ["ip", "addr", "add", f"{net}.1/24", "dev", f"{name}a"],
            ["ip", "link", "set", f"{name}a", "up"],
            [*there, "ip", "addr", "add", f"{net}.2/24", "dev", f"{name}b"],
            [*there, "ip", "link", "set", f"{name}b", "up"],
            [*there, "ip", "link", "set", "lo", "up"],
        ):
            subprocess.run(command, check=True)
        return f"{net}.1", there, f"{name}a"


def dask(what: str) -> list[str]:
    """Return the command of a Dask scheduler or worker."""
    return [*PYTHON, "-m", f"distributed.cli.dask_{what}"]


def _listens(host: str, port: int) -> bool:
    with contextlib.suppress(OSError), socket.create_connection((host, port), timeout=1):
        return True
    return False


@contextlib.contextmanager
def undisturbed(work: Work, seed: int, stop: threading.Event) -> Iterator[Site]:
    """Provide a finished job of this work."""
    with Site(work, seed, 900.0, stop) as site:
        command = site.start_local(2)
        site.wait(site.ended)
        if command.code != 0:
            raise RuntimeError(f"{work.command} does not end well without a fault: {command.lines()}")
        yield site
