"""Change one operator, comparison or constant of the physics at a time, in a copy, and see which test notices.

python tools/mutants.py FOLDER [--seed 1] [--count 40] [--only 3 7] [--list] [--mark validation] [--seconds 300]

FOLDER keeps the copy and its kernels between calls. Tests run nearest first, by the number of imports between them and the changed file,
until one fails or --seconds have passed (also in a mutant that hangs). A comparison with a whole number moves by one, others are turned
round; whole numbers grow by one, others by 7 %. Texts, annotations and what is raised stay; so do the tables of the air.
"""

import argparse
import ast
import os
import pickle
import random
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

from house import ROOT, SOURCE, floors, physics
from seaglint.base.kernel_cache import PREFIX, sources_digest

SWAPPED = {ast.Add: "+-", ast.Sub: "-+", ast.Mult: "*/", ast.Div: "/*", ast.Mod: "%*", ast.BitAnd: "&|", ast.BitOr: "|&"}
SWAPPED |= {ast.FloorDiv: ("//", "*"), ast.Pow: ("**", "*"), ast.LShift: ("<<", ">>"), ast.RShift: (">>", "<<")}
SWAPPED |= {ast.And: ("and", "or"), ast.Or: ("or", "and")}
SYMBOLS = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}
TURNED = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
MOVED = TURNED | {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}
WHOLE = re.compile(r"\d+|len\(.*|.*(\.size|\.ndim|\.shape\[\d\])")  # operands that are seen to be whole numbers


class Mutant(NamedTuple):
    """Bytes ``begin`` to ``end`` of a file become ``new``."""

    path: Path
    begin: int
    end: int
    new: str

    def __str__(self) -> str:
        text = self.path.read_bytes()
        number, old = text.count(b"\n", 0, self.begin), text[self.begin : self.end].decode()
        return f"{self.path.relative_to(SOURCE)}:{number + 1} | `{old}` to `{self.new}` | `{text.splitlines()[number].decode().strip()}`"


def nodes(node: ast.AST) -> Iterator[ast.AST]:
    """What runs and is neither text nor an annotation."""
    texts = isinstance(node, ast.BinOp) and any(isinstance(s, (ast.JoinedStr, ast.List, ast.Tuple)) for s in (node.left, node.right))
    if isinstance(node, (ast.Raise, ast.JoinedStr)) or texts or (isinstance(node, ast.Call) and ast.unparse(node.func).endswith("warn")):
        return
    yield node
    for name, value in ast.iter_fields(node):
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and name not in ("annotation", "returns", "decorator_list", "bases"):
                yield from nodes(child)


def mutants_of(path: Path) -> Iterator[Mutant]:
    """All changes of a file."""
    text = path.read_bytes()
    starts = [0, *(match.end() for match in re.finditer(b"\n", text))]

    def between(left: ast.expr, right: ast.expr, old: str, new: str) -> Mutant:
        begin, end = starts[left.end_lineno - 1] + left.end_col_offset, starts[right.lineno - 1] + right.col_offset
        at = begin + re.sub(rb"#[^\n]*", lambda comment: b" " * len(comment[0]), text[begin:end]).index(old.encode())
        return Mutant(path, at, at + len(old), new)

    for node in nodes(ast.parse(text)):
        begin = starts[node.lineno - 1] + node.col_offset if isinstance(node, ast.expr) else 0
        operation = getattr(node, "op", None)
        if isinstance(node, ast.BinOp) and type(operation) in SWAPPED and not ast.unparse(node).endswith(("None", "'")):
            yield between(node.left, node.right, *SWAPPED[type(operation)])
        elif isinstance(node, ast.AugAssign) and type(operation) in SWAPPED:
            yield between(node.target, node.value, *SWAPPED[type(operation)])
        elif isinstance(node, ast.BoolOp):
            yield between(*node.values[:2], *SWAPPED[type(operation)])
        elif isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            for left, operator, right in zip(sides, node.ops, sides[1:], strict=False):
                if old := SYMBOLS.get(type(operator)):
                    changes = MOVED if any(WHOLE.fullmatch(ast.unparse(side)) for side in (left, right)) else TURNED
                    yield between(left, right, old, changes[old])
        elif isinstance(operation, (ast.USub, ast.Not)) and not isinstance(node.operand, ast.Constant):
            yield Mutant(path, begin, begin + (1 if isinstance(operation, ast.USub) else 4), "")
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float) and node.value != 0.0:
            new = str(node.value + 1) if type(node.value) is int else repr(1.07 * node.value)
            yield Mutant(path, begin, begin + node.end_col_offset - node.col_offset, new)


class Copy:
    """Copy of the tree with its own kernels, in which tests run."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.tree, self.failing = folder.resolve(), folder.resolve() / "tree", frozenset()
        shutil.rmtree(self.tree, ignore_errors=True)
        for name in filter(None, subprocess.check_output(["git", "ls-files", "-z"], cwd=ROOT, text=True).split("\0")):
            (self.tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, self.tree / name)
        self.source = self.tree / SOURCE.relative_to(ROOT)
        self.tests = [p for p in (self.tree / "tests").rglob("test_*.py") if p.stem != "test_architecture"]
        scripts = ("tests", "tools", "benchmarks", "docs/figures")
        files = {p.stem: p for part in scripts for p in (self.tree / part).rglob("*.py")} | {str(p): p for p in self.tests}
        parts = {p: p.relative_to(self.tree / "src").with_suffix("").parts for p in self.source.rglob("*.py")}
        files |= {".".join(names).removesuffix(".__init__"): path for path, names in parts.items()}
        self.importers: dict[Path, set[Path]] = {path: set() for path in files.values()}
        for path in self.importers:
            for node in ast.walk(ast.parse(path.read_bytes())):
                for alias in node.names if isinstance(node, (ast.Import, ast.ImportFrom)) else ():
                    for name in (alias.name, getattr(node, "module", None), f"{getattr(node, 'module', None)}.{alias.name}"):
                        self.importers.get(files.get("seaglint.api" if name == "seaglint" else name), set()).add(path)

    def distances(self, changed: Path) -> dict[Path, int]:
        """Number of imports between each file and the changed one."""
        found, edge = {changed: 0}, {changed}
        while edge := {new for path in edge for new in self.importers[path]} - set(found):
            found |= dict.fromkeys(edge, max(found.values()) + 1)
        return found

    def pytest(self, seconds: float, *arguments: str) -> str:
        """First test that fails, how else the run ended, or nothing, also where nothing failed for so long."""
        environment = os.environ | {"PYTHONPATH": str(self.tree / "src"), "NUMBA_CACHE_DIR": str(self.folder / "kernels")}
        command = [sys.executable, "-m", "pytest", "-x", "-rfE", "--tb=no", "-p", "no:cacheprovider", *arguments]
        with suppress(subprocess.TimeoutExpired):
            result = subprocess.run(command, cwd=self.tree, env=environment, capture_output=True, text=True, check=False, timeout=seconds)
            named = re.search(r"^(?:FAILED|ERROR) (\S+)", result.stdout, re.MULTILINE)
            return named[1] if named else "" if result.returncode in (0, 5) else f"ends with {result.returncode}"
        return ""

    def share(self, old: str, new: str, near: dict[Path, int]) -> None:
        """Share kernels that the change cannot reach: those of files that do not import it, however indirectly."""
        same = {".".join(path.relative_to(self.source).with_suffix("").parts) for path in self.source.rglob("*.py") if path not in near}
        for file in (self.folder / "kernels" / old).glob("*.nb?"):
            words, target = file.name.split("-")[0].split("."), self.folder / "kernels" / new / file.name
            if not target.exists() and any(".".join(words[:n]) in same for n in range(1, len(words))):
                target.parent.mkdir(parents=True, exist_ok=True)
                if file.suffix == ".nbc":
                    os.link(file, target)
                else:  # an index names the folder that it lies in
                    version, (_, known) = [pickle.load(index) for index in [file.open("rb")] for _ in range(2)]
                    target.write_bytes(pickle.dumps(version) + pickle.dumps((new, known)))

    def verdict(self, mutant: Mutant, mark: str, seconds: float) -> str:
        """Which test notices a change, and after how many seconds."""
        start, by, run, path = time.perf_counter(), "", 0, self.source / mutant.path.relative_to(SOURCE)
        order = lambda t: (near.get(t, 99) - 2 * (path.stem in t.stem), t.parent.name != path.parent.name)  # noqa: E731
        near, text, times, before = self.distances(path), path.read_bytes(), path.stat(), PREFIX + sources_digest(self.source)
        changed = text[: mutant.begin] + mutant.new.encode() + text[mutant.end :]
        path.write_bytes(changed)
        after = PREFIX + sources_digest(self.source)
        self.share(before, after, near)
        for _, tests in groupby(sorted(self.tests, key=lambda t: (order(t), str(t))), order):
            names = [str(test) for test in tests]
            while (left := start + seconds - time.perf_counter()) > 0.0 and not by:
                path.write_bytes(changed)
                by = self.pytest(left, "-m", mark, *(f"--deselect={name}" for name in self.failing), *names)
                path.write_bytes(text)
                os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
                if "::" not in by or not self.pytest(600.0, by):
                    run += len(names)
                    break
                self.failing, by = self.failing | {by}, ""  # it fails unchanged as well
        if after != before:
            self.share(after, before, near)
            shutil.rmtree(self.folder / "kernels" / after, ignore_errors=True)
        return f"{by or f'NOT NOTICED by {run} files'} | {time.perf_counter() - start:.0f}"


def places() -> list[Mutant]:
    """All changes of the rooms of physics, and of the files below them that know arrays."""
    rooms = floors()
    lowest = max(level for level, names in enumerate(rooms) if physics() & set(names))
    known = physics() - {"atmosphere", "air"} | {name for names in rooms[lowest + 1 :] for name in names}
    rooms_of = {path: path.relative_to(SOURCE).with_suffix("").parts[0] for path in sorted(SOURCE.rglob("*.py"))}
    paths = [p for p, room in rooms_of.items() if room in known and (room in physics() or b"import numpy" in p.read_bytes())]
    return [mutant for path in paths for mutant in mutants_of(path)]


def main() -> None:
    """Draw places, try each, print a row of a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    for name, default in (("--seed", 1), ("--count", 40), ("--seconds", 300.0), ("--mark", "not validation")):
        parser.add_argument(name, type=type(default), default=default)
    parser.add_argument("--only", type=int, nargs="*")
    parser.add_argument("--list", action="store_true")
    given = parser.parse_args()
    copy, drawn = None if given.list else Copy(given.folder), random.Random(given.seed).sample(places(), given.count)
    for number, mutant in enumerate(drawn):
        if given.only is None or number in given.only:
            print(f"| {number} | {mutant} | {copy.verdict(mutant, given.mark, given.seconds) if copy else ''} |", flush=True)


if __name__ == "__main__":
    main()
