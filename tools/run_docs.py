"""Run the code of documentation pages, and write what commands print back into them.

    python tools/run_docs.py docs/tutorials/*.md            compare: what is shown must be what is printed
    python tools/run_docs.py --write docs/tutorials/*.md    show what is printed

A page runs in an empty folder of its own. A block below the line ``File `NAME`:`` is written into a file of that name; a comment
``<!-- not run: REASON -->`` in the line before a block leaves it out. Blocks of ``python`` share their names; lines of ``sh`` are commands,
and a block of ``output`` below them is what they print. Numbers that are printed may differ by 2 per cent from those shown, a
line ``...`` stands for any lines. A command must succeed unless its output is shown. Lines ``source ...`` and ``./run ...`` are left out:
the environment exists, and continuous integration runs these. A viewer is stopped where it prints its address.
"""

from __future__ import annotations

import argparse
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BLOCK = re.compile(
    r"^(?:<!-- not run: (?P<reason>[^\n]*?) -->\n|File `(?P<file>[^`\n]+)`:\n\n)?"
    r"(?P<fence>```+|~~~+)(?P<kind>[^\n`]*)\n(?P<body>.*?)^(?P=fence)[ ]*$",
    re.DOTALL | re.MULTILINE,
)
NUMBER = re.compile(r"(?<![A-Za-z_\d.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\dA-Za-z_])")
CLOSE = 0.02
LEFT_OUT = ("source ", "./run ")
VIEWER = "seaglint view"


class PageError(Exception):
    """A block that fails, or prints other than what is shown."""


@dataclass(frozen=True)
class Block:
    """A fenced block of a page."""

    #: Language.
    kind: str
    #: Text.
    body: str
    #: Name of the file that it is, or nothing.
    file: str
    #: Why it is not run, or nothing.
    reason: str
    #: Place of the text in the page.
    span: tuple[int, int]


def blocks(text: str) -> list[Block]:
    """All fenced blocks of a page."""
    return [Block(m["kind"].strip(), m["body"], m["file"] or "", m["reason"] or "", m.span("body")) for m in BLOCK.finditer(text)]


def commands(block: Block) -> list[str]:
    """Return the commands of a block of ``sh``; a backslash goes on in the next line."""
    lines = block.body.replace("\\\n", "").splitlines()
    return [line for line in lines if line.strip() and not line.lstrip().startswith("#")]


def environment() -> dict[str, str]:
    """Variables for commands: ``seaglint``, ``python`` and ``dask`` are those beside the interpreter that runs this."""
    where = os.pathsep.join(filter(None, [str(ROOT / "src"), os.environ.get("PYTHONPATH", "")]))
    tools = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", os.defpath)])
    return {**os.environ, "PYTHONPATH": where, "PATH": tools, "COLUMNS": "140"}


def printed(command: str, folder: Path, allowed: tuple[int, ...] = (0, 2)) -> list[str]:
    """Lines that a command prints, which may end with one of the allowed statuses."""
    run = subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, text=True, env=environment(), stdin=subprocess.DEVNULL)
    if run.returncode not in allowed:
        raise PageError(f"'{command}' ended with {run.returncode}: {run.stderr[-2000:]}")
    return [line.rstrip() for line in (run.stdout + run.stderr).splitlines()]


def viewed(command: str, folder: Path) -> list[str]:
    """Lines that a viewer prints, which Ctrl-C stops after its address."""
    viewer = subprocess.Popen(
        shlex.split(command, comments=True),
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        stdin=subprocess.DEVNULL,
        text=True,
        env=environment(),
    )
    assert viewer.stdout is not None
    lines = [""]
    while "http://" not in lines[-1] and (line := viewer.stdout.readline()):
        lines.append(line.rstrip())
    if "http://" not in lines[-1]:
        raise PageError("\n".join([f"'{command}' ended with {viewer.wait()} before it printed an address:", *lines]))
    viewer.send_signal(signal.SIGINT)
    try:
        rest, _ = viewer.communicate(timeout=60)
    except subprocess.TimeoutExpired:
        viewer.kill()
        raise PageError(f"'{command}' goes on after Ctrl-C") from None
    return [*lines[1:], *rest.splitlines()]


def alike(shown: str, found: str) -> bool:
    """Whether two lines have the same words, and numbers within 2 per cent."""
    if NUMBER.sub("#", shown).split() != NUMBER.sub("#", found).split():
        return False
    pairs = zip(NUMBER.findall(shown), NUMBER.findall(found), strict=True)
    return all(abs(float(a) - float(b)) <= CLOSE * max(abs(float(a)), abs(float(b))) for a, b in pairs)


def matches(shown: list[str], found: list[str]) -> bool:
    """Whether what is shown is what was found."""
    if not shown:
        return not found
    if shown[0].strip() == "...":
        return any(matches(shown[1:], found[start:]) for start in range(len(found) + 1))
    return bool(found) and alike(shown[0], found[0]) and matches(shown[1:], found[1:])


def run(text: str, folder: Path, *, write: bool = False, said: dict[str, list[str]] | None = None) -> str:
    """Run a page in a folder; return the page, with what commands print where ``write`` is true.

    Lines that commands print go into ``said``, under their commands without comments.

    Raises
    ------
    PageError
        A command that fails, or prints other than what is shown.
    """
    names: dict[str, object] = {"__name__": "__page__"}
    pieces, end = [], 0
    found: list[str] | None = None
    page = blocks(text)
    for block, below in zip(page, [*page[1:], None], strict=True):
        body = block.body
        if block.reason:
            pass
        elif block.file:
            (folder / block.file).write_text(body, encoding="utf-8")
        elif block.kind == "python":
            exec(compile(body, f"block of {block.body[:40]!r}", "exec"), names)
        elif block.kind == "output" and found is not None:
            shown = body.splitlines()
            if write:
                body = "\n".join(renewed(shown, found) if "..." in (line.strip() for line in shown) else found) + "\n"
            elif not matches(shown, found):
                raise PageError("\n".join(["the commands print", *found, "and the page shows", *shown]))
        elif block.kind == "sh":
            is_shown = below is not None and below.kind == "output"
            found = _printed_by_all(commands(block), folder, {} if said is None else said, (0, 2) if is_shown else (0,))
        if block.reason or block.kind != "sh":
            found = None
        pieces += [text[end : block.span[0]], body]
        end = block.span[1]
    return "".join([*pieces, text[end:]])


def _printed_by_all(lines: list[str], folder: Path, said: dict[str, list[str]], allowed: tuple[int, ...]) -> list[str]:
    """Run commands, of which the last may end with one of the allowed statuses; return what they print."""
    result: list[str] = []
    for number, command in enumerate(lines, start=1):
        if command.startswith(LEFT_OUT):
            continue
        last = allowed if number == len(lines) else (0,)
        found = viewed(command, folder) if command.startswith(VIEWER) else printed(command, folder, last)
        said[command.split(" #")[0].strip()] = found
        result += found
    return result


def renewed(shown: list[str], found: list[str]) -> list[str]:
    """Lines shown between ``...`` with the numbers of the lines printed that differ from them in numbers only."""
    out, left = [], list(found)
    for line in shown:
        form = NUMBER.sub("#", line).strip()
        at = next((i for i, one in enumerate(left) if NUMBER.sub("#", one).strip() == form), None)
        if line.strip() == "..." or at is None:
            out.append(line)
            continue
        out.append(left[at])
        del left[: at + 1]
    return out


def main() -> None:
    """Run pages."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("pages", nargs="+", type=Path)
    parser.add_argument("--write", action="store_true", help="write what commands print into the pages")
    parser.add_argument("--keep", type=Path, help="run in this folder and leave it")
    given = parser.parse_args()
    for page in given.pages:
        text, before = page.read_text(encoding="utf-8"), Path.cwd()
        with tempfile.TemporaryDirectory() as temporary:
            folder = given.keep or Path(temporary)
            folder.mkdir(parents=True, exist_ok=True)
            page = page.resolve()
            os.chdir(folder)
            try:
                done = run(text, folder, write=given.write)
            except PageError as problem:
                sys.exit(f"{page}: {problem}")
            finally:
                os.chdir(before)
        if given.write:
            page.write_text(done, encoding="utf-8")
        print(f"{page.name}: {len(blocks(text))} blocks")


if __name__ == "__main__":
    main()
