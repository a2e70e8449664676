"""HDF5 alone on damaged files, in a process of its own: it loops for ever in some, holding Python's lock, so that nothing can stop it."""

from __future__ import annotations

import select
import subprocess
import sys
from pathlib import Path

MAGIC = b"\x89HDF"
LIMIT_S = 60.0
_SCRIPT = """
import sys
import h5py

def look(item):
    for part in (lambda: dict(item.attrs), lambda: [len(d) for d in getattr(item, "dims", ())]):
        try:
            part()
        except Exception:
            pass
    for name in getattr(item, "keys", tuple)():
        try:
            inner = item[name]
        except Exception:
            continue
        if isinstance(inner, h5py.Dataset) or depth(inner) < 9:
            look(inner)

def depth(item):
    return item.name.count("/")

for line in sys.stdin:
    try:
        with h5py.File(line.rstrip("\\n"), "r") as file:
            look(file)
    except Exception:
        pass
    print("done", flush=True)
"""


class Hdf5Walker:
    """Walks over files' attributes and dimensions with h5py, none of this project's code in between."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None

    def hangs(self, path: Path) -> bool:
        """Whether HDF5 is still at it after a minute; other files are none of its business."""
        if path.read_bytes()[:4] != MAGIC:
            return False
        if self._process is None:
            pipe = subprocess.PIPE
            command = [sys.executable, "-c", _SCRIPT]
            self._process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, text=True)
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(f"{path}\n")
            process.stdin.flush()
            answered = bool(select.select([process.stdout], [], [], LIMIT_S)[0]) and process.stdout.readline() == "done\n"
        except BrokenPipeError:
            answered = False
        if not answered:
            self.close()
        return not answered

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None
