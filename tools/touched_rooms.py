"""Which rooms of the source a change touches, and which lie above them by their imports.

    python tools/touched_rooms.py    prints them

A change is what differs between a base commit and the working tree. The base is the commit that ``SEAGLINT_BASE`` names; else the merge
base with main; else, on main itself, the commit of the last whole run of the validations; else none: then everything counts as changed.

Comments, docstrings and layout change nothing. A folder of ``src/seaglint`` is a room; its tests belong to it. A room is
above another where one of its modules imports, by way of others where need be, a module that changed; so is a file of tests. Tests outside
of the rooms' folders run pages and programs that may use anything: they are above every room.
"""

from __future__ import annotations

import ast
import os
import re
import subprocess
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePosixPath

from seaglint.base.kernel_cache import syntax_text

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = "src/seaglint"
RECORD = "docs/data/last_validation.toml"
SCRIPTS = ("tests/helpers", "tools", "benchmarks", "docs/figures")
"""Folders of modules that tests import, besides the package."""
EVERYTHING = ("tests/conftest.py", f"{PACKAGE}/__init__.py")
"""Files on which every test hangs, as it does on what ``pyproject.toml`` says of packages and of pytest."""
PAGES = ("tests/test_documentation.py",)
ELSEWHERE: dict[str, tuple[str, ...]] = {
    "docs/gallery": ("tests/test_gallery.py", *PAGES),
    "docs": PAGES,
    "README.md": PAGES,
    "CONTRIBUTING.md": PAGES,
    "run": ("tests/test_pip_settings.py",),
    "examples": ("tests/cli/test_examples.py", "tests/cli/test_fig12.py", *PAGES),
}
"""Folders and files outside of the rooms: the files of tests that judge them. Of two that fit, the first counts."""


@dataclass(frozen=True)
class Base:
    """Where a change begins.

    Parameters
    ----------
    commit
        Full name of the commit, or nothing: everything counts as changed.
    reason
        How it was found.
    """

    commit: str | None
    reason: str

    def __str__(self) -> str:
        return f"{self.commit[:9]} ({self.reason})" if self.commit else f"none ({self.reason})"


class NotGitError(RuntimeError):
    """Git has refused."""


def git(root: Path, *words: str) -> str:
    """Return what a git command prints."""
    try:
        done = subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, encoding="utf-8", check=False)
    except OSError as error:
        raise NotGitError(f"git cannot be run: {error}") from error
    if done.returncode:
        raise NotGitError((done.stderr.strip().splitlines() or [f"git {words[0]} ended with status {done.returncode}"])[0])
    return done.stdout


def commit_named(root: Path, name: str) -> str | None:
    """Return the full name of a commit that is here."""
    try:
        return git(root, "rev-parse", "--verify", "--quiet", "--end-of-options", f"{name}^{{commit}}").strip()
    except NotGitError:
        return None


def base_of(root: Path = ROOT, environment: Mapping[str, str] = os.environ) -> Base:
    """Return the commit that the working tree is compared with.

    Raises
    ------
    SystemExit
        ``SEAGLINT_BASE`` names no commit.
    """
    head = commit_named(root, "HEAD")
    if named := environment.get("SEAGLINT_BASE"):
        if commit := commit_named(root, named):
            return Base(commit, "by SEAGLINT_BASE")
        raise SystemExit(f"SEAGLINT_BASE = {named} names no commit of this clone; name one of `git log`, fetch it, or unset the variable")
    if head is None:
        return Base(None, "no commit here")
    for main in ("origin/main", "main"):
        if tip := commit_named(root, main):
            merged = common(root, head, tip)
            if merged and merged != head:
                return Base(merged, f"the merge base with {main}")
            if merged:
                break  # this is main, or older
    return last_whole_run(root, head)


def common(root: Path, one: str, other: str) -> str | None:
    """Return the last commit that two have in common; a shallow clone may lack it."""
    try:
        return git(root, "merge-base", one, other).strip()
    except NotGitError:
        return None


def last_whole_run(root: Path, head: str) -> Base:
    """Return the commit of the last whole run of the validations, where the head comes after it."""
    try:
        recorded = str(tomllib.loads((root / RECORD).read_text(encoding="utf-8"))["commit"])
    except (OSError, ValueError, KeyError):
        return Base(None, f"no readable {RECORD}")
    commit = commit_named(root, recorded)
    if commit is None or common(root, head, commit) != commit:
        return Base(None, f"the last whole run, at {recorded}, is not among the commits before this one")
    return Base(commit, "the last whole run of the validations")


def changed_files(root: Path, base: str) -> list[str]:
    """Return the files that differ between a commit and the working tree, new ones included."""
    differ = git(root, "diff", "--name-only", "-z", "--no-renames", base, "--")
    new = git(root, "ls-files", "--others", "--exclude-standard", "-z")
    return sorted({name for name in (differ + new).split("\0") if name})


def content(root: Path, base: str, name: str) -> tuple[str | None, str | None]:
    """Return the text of a file at the base and now; none where it is not there."""
    try:
        before: str | None = git(root, "show", f"{base}:{name}")
    except NotGitError:
        before = None
    path = root / name
    return before, path.read_text(encoding="utf-8") if path.is_file() else None


def same_statements(before: str | None, now: str | None) -> bool:
    """Whether two texts of a Python file differ in comments, docstrings and layout at most."""
    if before is None or now is None:
        return False
    try:
        return syntax_text(ast.parse(before)) == syntax_text(ast.parse(now))
    except SyntaxError:
        return False


def same_settings(before: str | None, now: str | None) -> bool:
    """Whether two texts of ``pyproject.toml`` agree in packages and in how pytest runs: lint and types judge themselves."""
    if before is None or now is None:
        return False
    one, other = tomllib.loads(before), tomllib.loads(now)
    return all(one.get(table) == other.get(table) for table in ("build-system", "project")) and one["tool"].get("pytest") == other[
        "tool"
    ].get("pytest")


def all_statements(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield the statements of a file, those inside of others included; expressions, which are ten times as many, hold none."""
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        yield node
        for name in ("body", "orelse", "finalbody", "handlers", "cases"):
            inside = getattr(node, name, None)
            if isinstance(inside, list):
                waiting += inside


def modules_imported(tree: ast.Module, known: set[str], name: str = "") -> set[str]:
    """Return the known modules that a file imports anywhere, also inside functions and for types alone.

    A file of the package bears its name here: in it, relative imports are refused. In tests they lead to no module of the package.
    """
    result = set()
    for node in all_statements(tree):
        if isinstance(node, ast.Import):
            result |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert not (name and node.level), f"{name}: relative imports are not followed; write the module's whole name"
            # What is imported from a package may be one of its modules.
            result |= {whole if (whole := f"{node.module}.{alias.name}") in known else str(node.module) for alias in node.names}
    return result & known


@dataclass(frozen=True)
class House:
    """The package and its tests as they lie on disk."""

    root: Path = ROOT

    @cached_property
    def modules(self) -> dict[str, str]:
        """Dotted name of each module of the package: its file, from the repository's folder."""
        source = self.root / PACKAGE
        result = {}
        for path in sorted(source.rglob("*.py")):
            parts = path.relative_to(source).with_suffix("").parts
            result[".".join(("seaglint", *parts)).removesuffix(".__init__")] = path.relative_to(self.root).as_posix()
        return result

    @cached_property
    def imports(self) -> dict[str, set[str]]:
        """Modules of the package that each module imports."""
        known = set(self.modules)
        return {
            name: modules_imported(ast.parse((self.root / file).read_text(encoding="utf-8")), known, file) - {name}
            for name, file in self.modules.items()
        }

    @cached_property
    def rooms(self) -> set[str]:
        """Rooms: folders and single files of the package."""
        return {room_of_source(file) for file in self.modules.values()} - {"__init__"}

    @cached_property
    def tests(self) -> list[str]:
        """Python files of the tests, from the repository's folder."""
        return [path.relative_to(self.root).as_posix() for path in sorted((self.root / "tests").rglob("*.py"))]

    @cached_property
    def scripts(self) -> list[Path]:
        """Helpers of tests, tools, benchmarks and scripts of figures."""
        return [path for folder in SCRIPTS for path in sorted((self.root / folder).glob("*.py"))]

    def users(self, helper: str) -> set[str]:
        """Files of tests that import a helper or a script, by way of others where need be."""
        others = {path.relative_to(self.root).as_posix() for path in self.scripts}
        texts = {file: (self.root / file).read_text(encoding="utf-8") for file in {*self.tests, *others}}
        names, result = [PurePosixPath(helper).stem], set()
        while names:
            line = re.compile(rf"^\s*(?:from|import) {re.escape(names.pop())}\b", re.MULTILINE)
            found = {file for file, text in texts.items() if file not in result and line.search(text)}
            result |= found
            names += [PurePosixPath(file).stem for file in found & others]
        return {file for file in result & set(self.tests) if PurePosixPath(file).name.startswith("test_")}

    @cached_property
    def tests_import(self) -> dict[str, set[str]]:
        """Modules of the package, helpers and scripts that each file of tests, helper and script imports."""
        known = {*self.modules, *(path.stem for path in self.scripts)}
        files = {**{path.stem: path for path in self.scripts}, **{file: self.root / file for file in self.tests}}
        return {name: modules_imported(ast.parse(path.read_text(encoding="utf-8")), known) for name, path in files.items()}

    def test_files_above(self, changed: Iterable[str]) -> dict[str, int]:
        """Number of imports between each file of tests and the nearest of some modules, where there is a way."""
        reached = steps_from(changed, self.imports | self.tests_import)
        return {file: reached[file] for file in self.tests if file in reached and PurePosixPath(file).name.startswith("test_")}

    def steps(self, changed: Iterable[str]) -> dict[str, int]:
        """Number of imports between each room and the nearest of some modules, where there is a way."""
        reached = steps_from(changed, self.imports)
        result: dict[str, int] = {}
        for name, number in reached.items():
            if file := self.modules.get(name):
                room = room_of_source(file)
                result[room] = min(number, result.get(room, number))
        return {room: number for room, number in result.items() if room in self.rooms}


def steps_from(changed: Iterable[str], imports: Mapping[str, set[str]]) -> dict[str, int]:
    """Return all that import some modules, by way of others where need be, with the number of imports between."""
    reached = dict.fromkeys(changed, 0)
    waiting = list(reached)
    while waiting:
        nearer = waiting.pop(0)
        for name in sorted(name for name, used in imports.items() if nearer in used and name not in reached):
            reached[name] = reached[nearer] + 1
            waiting.append(name)
    return reached


def room_of_source(file: str) -> str:
    """Return the room of a file below the package's folder."""
    return PurePosixPath(file).relative_to(PACKAGE).parts[0].removesuffix(".py")


def room_of_tests(file: str, rooms: set[str]) -> str:
    """Return the room of a file of tests: its folder's, or the file itself where that is none."""
    parts = PurePosixPath(file).parts
    return parts[1] if len(parts) > 2 and parts[1] in rooms else file


@dataclass(frozen=True)
class Touched:
    """What a change touches.

    Parameters
    ----------
    base
        Where the change begins.
    everything
        Why everything counts as changed; empty where it does not.
    differ
        Number of files that differ.
    changed
        Rooms, and files of tests, that the change touches, with the first file for which they are in the list.
    above
        Rooms, and files of tests, above them, with the number of imports between.
    """

    base: Base
    everything: str
    differ: int
    changed: dict[str, str]
    above: dict[str, int]


def touched(root: Path = ROOT, base: Base | None = None) -> Touched:
    """Return what differs from the base, by rooms."""
    base = base or base_of(root)
    if base.commit is None:
        return Touched(base, base.reason, 0, {}, {})
    files, house = changed_files(root, base.commit), House(root)
    rooms: dict[str, str] = {}
    modules: set[str] = set()
    for file in files:
        if hangs_everything_on(root, base.commit, file):
            return Touched(base, f"{file} differs", len(files), {}, {})
        if file.endswith(".py") and same_statements(*content(root, base.commit, file)):
            continue
        for name in judged_by(file, house):
            rooms.setdefault(name, file)
        modules |= modules_of(file, house)
    above = {}
    if modules:
        above = house.steps(modules)
        farthest = 1 + max(above.values(), default=0)
        named = (file for file in house.tests if PurePosixPath(file).name.startswith("test_"))
        above |= {file: farthest for file in named if file == room_of_tests(file, house.rooms)} | house.test_files_above(modules)
    return Touched(base, "", len(files), rooms, {name: steps for name, steps in above.items() if name not in rooms})


def hangs_everything_on(root: Path, base: str, file: str) -> bool:
    """Whether a changed file can change the verdict of any test."""
    if file in EVERYTHING:
        return not same_statements(*content(root, base, file))
    return file == "pyproject.toml" and not same_settings(*content(root, base, file))


def judged_by(file: str, house: House) -> list[str]:
    """Return the rooms, and files of tests, that judge a changed file itself."""
    path = PurePosixPath(file)
    if file.startswith(f"{PACKAGE}/"):
        return [room_of_source(file)] if len(path.parts) > 3 or path.suffix == ".py" else []
    if str(path.parent) in SCRIPTS:
        return sorted(house.users(file))
    if path.parts[0] == "tests":
        return [room_of_tests(file, house.rooms)]
    return next((list(tests) for place, tests in ELSEWHERE.items() if path.is_relative_to(place)), [])


def modules_of(file: str, house: House) -> set[str]:
    """Return the modules that a changed file of the package makes count as changed: all of its folder, where it is no module itself."""
    if not file.startswith(f"{PACKAGE}/"):
        return set()
    path = PurePosixPath(file)
    if path.suffix == ".py" and path.name != "__init__.py":
        return {name for name, place in house.modules.items() if place == file}
    room = f"{PACKAGE}/{room_of_source(file)}/"
    folder = room if path.suffix != ".py" else f"{path.parent}/"
    return {name for name, place in house.modules.items() if place.startswith(folder)}


def described(what: Touched) -> list[str]:
    """Return lines on what a change touches."""
    lines = [f"base commit: {what.base}"]
    if what.everything:
        return [*lines, f"changed rooms: all, {what.everything}"]
    rooms = sorted((steps, room) for room, steps in what.above.items() if "/" not in room)
    outside = ["files of tests"] if len(rooms) < len(what.above) else []
    return [
        *lines,
        f"changed rooms, by {what.differ} files that differ: " + (", ".join(sorted(what.changed)) or "none"),
        "rooms above them, nearest first: " + (", ".join([room for _, room in rooms] + outside) or "none"),
    ]


if __name__ == "__main__":
    print(*described(touched()), sep="\n")
