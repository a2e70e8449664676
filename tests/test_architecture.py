"""The shape of the house: who imports whom, what importing costs, what is documented, what a tracked file may say."""

from __future__ import annotations

import ast
import doctest
import importlib
import os
import pkgutil
import re
import subprocess
import sys
import typing
from pathlib import Path

import numpy as np
import pytest

import seaglint
from census import census, options_below, repeated_classes, repeated_stems, riddles, trees
from seaglint.base.kernel_cache import ROOMS, sources_digest
from touched_rooms import modules_imported

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "seaglint"
MODULES = sorted(info.name for info in pkgutil.walk_packages(seaglint.__path__, "seaglint.") if not info.name.endswith("__main__"))

HEAVY = (
    *("numpy", "scipy", "numba", "pandas", "xarray", "dask"),
    *("zarr", "h5netcdf", "pydantic", "pint", "pvlib", "wavespectra", "matplotlib", "av"),
)
"""Packages that cost a noticeable part of a second; none is needed to print a help page."""

LIGHT = {"typer", "click", "rich", "shellingham", "annotated_doc", "annotationlib", "typing_extensions", "colorama", "pygments"}
"""Packages from elsewhere that a help page may load: what a user at a prompt takes for immediate is a matter of these."""


def tree_of(path: Path) -> ast.Module:
    """Syntax tree of a file of the package, parsed once for all tests."""
    return trees(SOURCE)[path.relative_to(SOURCE)]


def python(code: str) -> str:
    """Standard output of a fresh interpreter."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT).stdout


def test_import_contracts_hold() -> None:
    result = subprocess.run(
        [sys.executable, "-c", "from importlinter.cli import lint_imports_command; lint_imports_command()", "--no-cache", "--no-logo"],
        capture_output=True,
        text=True,
        check=False,
        cwd=ROOT,
    )
    assert result.returncode == 0, result.stdout + result.stderr


HELP = """
import contextlib, sys
from seaglint.cli.app import main
sys.argv = ["seaglint", "--help"]
with contextlib.suppress(SystemExit):
    main()
"""


COMMANDS = "from seaglint.cli.app import Commands; dict(Commands())"


@pytest.mark.parametrize("code", ["import seaglint", COMMANDS, HELP], ids=["package", "commands", "help"])
def test_start_imports_nothing_heavy(code: str) -> None:
    printed = python(f"{code}\nimport sys; print('\\nLOADED', *(name for name in {HEAVY!r} if name in sys.modules))")
    assert printed.splitlines()[-1].split()[1:] == []


@pytest.mark.parametrize(("code", "allowed"), [("import seaglint", set()), (HELP, LIGHT)], ids=["package", "help"])
def test_start_imports_little(code: str, allowed: set[str]) -> None:
    """Of other packages only those that are known to be light; what Python itself loads at its start does not count."""
    ours = "{name.partition('.')[0] for name in sys.modules} - before - set(sys.stdlib_module_names) - {'seaglint'}"
    printed = python(f"import sys; before = {{name.partition('.')[0] for name in sys.modules}}\n{code}\nprint('\\nLOADED', *({ours}))")
    assert set(printed.splitlines()[-1].split()[1:]) <= allowed


def test_the_list_of_commands_imports_no_command() -> None:
    names = "{entry.place.split('.')[0] for members in GROUPS.values() for entry in members.values()}"
    loaded = f"print('\\nLOADED', *({names} & {{name.removeprefix('seaglint.cli.') for name in sys.modules}}))"
    printed = python(f"{HELP}\nfrom seaglint.cli.app import GROUPS\n{loaded}")
    assert printed.splitlines()[-1].split()[1:] == []


@pytest.mark.parametrize("name", MODULES)
def test_module_examples_are_true(name: str) -> None:
    module = importlib.import_module(name)
    # Each search for examples has its own debugger, which reads all loaded files anew: 10 ms.
    if ">>> " in Path(str(module.__file__)).read_text(encoding="utf-8"):
        assert doctest.testmod(module, optionflags=doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS).failed == 0


def circles(imports: dict[str, set[str]]) -> list[set[str]]:
    """Groups of modules each of which imports all others of its group, by way of others where need be."""
    reached: dict[str, set[str]] = {}
    for name in imports:
        seen: set[str] = set()
        waiting = [name]
        while waiting:
            new = imports[waiting.pop()] - seen
            seen |= new
            waiting += new
        reached[name] = seen
    groups = {frozenset(other for other in seen if name in reached[other]) for name, seen in reached.items() if name in seen}
    return sorted(map(set, groups), key=sorted)


def test_no_modules_import_each_other_in_a_circle() -> None:
    known = {"seaglint", *MODULES}
    files = {path: path.relative_to(SOURCE).with_suffix("").parts for path in SOURCE.rglob("*.py")}
    names = {path: ".".join(("seaglint", *parts)).removesuffix(".__init__") for path, parts in files.items()}
    imports = {name: modules_imported(tree_of(path), known, path.name) - {name} for path, name in names.items()}
    assert imports["seaglint.cli.render"] >= {
        "seaglint.cli.terminal.messages",
        "seaglint.studies.sequence.render_sequence",
    }  # at the top and inside a command
    assert circles(imports) == []


def test_circles_are_found_whatever_their_length() -> None:
    imports = {"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": set(), "e": {"d", "f"}, "f": {"e"}}
    assert circles(imports) == [{"a", "b", "c"}, {"e", "f"}]


def public_definitions(tree: ast.Module) -> list[ast.FunctionDef | ast.ClassDef]:
    """Public functions, classes and their public methods; overloads and property setters share a docstring with another definition."""
    found: list[ast.FunctionDef | ast.ClassDef] = []
    for node in tree.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_"):
            found.append(node)
            if isinstance(node, ast.ClassDef):
                found += [f for f in node.body if isinstance(f, ast.FunctionDef) and not f.name.startswith("_")]
    return [d for d in found if not any(ast.unparse(x).rsplit(".", 1)[-1] in ("overload", "setter", "override") for x in d.decorator_list)]


@pytest.mark.parametrize("path", sorted(SOURCE.rglob("*.py")), ids=lambda p: str(p.relative_to(SOURCE)))
def test_everything_public_is_documented(path: Path) -> None:
    tree = tree_of(path)
    missing = [d.name for d in public_definitions(tree) if not ast.get_docstring(d)]
    assert missing == []
    assert ast.get_docstring(tree), "the module says in its first line what it holds"


PHYSICS = ("optics", "sea", "air", "facet", "radiance", "imaging")


@pytest.mark.parametrize("room", PHYSICS)
def test_physics_says_its_units(room: str) -> None:
    """A public array function of physics names a unit in brackets somewhere in its docstring."""
    silent = []
    for path in sorted((SOURCE / room).rglob("*.py")):
        for d in public_definitions(tree_of(path)):
            if isinstance(d, ast.FunctionDef) and returns_number(d) and not is_kernel(d) and "[" not in (ast.get_docstring(d) or ""):
                silent.append(f"{path.relative_to(SOURCE)}: {d.name}")
    assert silent == []


def returns_number(function: ast.FunctionDef) -> bool:
    """Whether the annotation of the result is a float or an array of them."""
    return function.returns is not None and re.search(r"\b(float|FloatArray|NDArray)\b", ast.unparse(function.returns)) is not None


def is_kernel(function: ast.FunctionDef) -> bool:
    """Whether it is the compiled inside of an array function, which carries the documentation."""
    return any(ast.unparse(decorator) in ("kernel", "njit", "njit_parallel") for decorator in function.decorator_list)


def holds_arrays(kind: object) -> bool:
    """Whether a type is an array or a tuple with one in it."""
    if isinstance(kind, type) and issubclass(kind, tuple) and hasattr(kind, "_fields"):
        return any(holds_arrays(part) for part in typing.get_type_hints(kind).values())
    if typing.get_origin(kind) is tuple:
        return any(holds_arrays(part) for part in typing.get_args(kind))
    return kind is np.ndarray or typing.get_origin(kind) is np.ndarray


def test_kernels_that_count_no_references_return_no_arrays() -> None:
    """A returned view would be freed once too often."""
    found = []
    for path in sorted(SOURCE.rglob("*.py")):
        tree = tree_of(path)
        named = [f.name for f in tree.body if isinstance(f, ast.FunctionDef) and "kernel" in map(ast.unparse, f.decorator_list)]
        if named:
            module = importlib.import_module("seaglint." + ".".join(path.relative_to(SOURCE).with_suffix("").parts))
            for name in named:
                function = getattr(module, name)
                found.append(name)
                assert not holds_arrays(typing.get_type_hints(getattr(function, "py_func", function))["return"]), f"{path.name}: {name}"
    assert len(found) > 50


def test_kernels_that_count_no_references_make_no_arrays() -> None:
    """Nor call anything compiled that does: nobody would free it."""
    compiled: dict[str, ast.FunctionDef] = {}
    for path in sorted(SOURCE.rglob("*.py")):
        for node in tree_of(path).body:
            if isinstance(node, ast.FunctionDef) and is_kernel(node):
                compiled[node.name] = compiled.get(node.name, node)
    counted = {name for name, node in compiled.items() if "kernel" not in map(ast.unparse, node.decorator_list)}
    makers = {"empty", "zeros", "ones", "full", "array", "arange", "repeat", "concatenate", "copy", "empty_like", "zeros_like", "reshape"}
    for name, node in compiled.items():
        if name not in counted:
            calls = {ast.unparse(call.func).rpartition(".")[2] for call in ast.walk(node) if isinstance(call, ast.Call)}
            assert not calls & (counted | makers), name


def test_kernels_are_made_of_what_their_cache_is_named_by() -> None:
    """Functions and tuples that kernels use come from files that are in the digest, constants from ``constants``: all else goes unseen."""
    parsed = {path: tree_of(path) for path in sorted(SOURCE.rglob("*.py"))}
    module = {path: "seaglint." + ".".join(path.relative_to(SOURCE).with_suffix("").parts) for path in parsed}
    texts = {path: path.read_text(encoding="utf-8") for path in parsed}
    rooms = {module[path] for path in parsed if path.relative_to(SOURCE).parts[0] in ROOMS}
    seen = (
        rooms
        | {module[path] for path in parsed if "base.jit import" in texts[path] or "(NamedTuple)" in texts[path]}
        | {"seaglint.base.constants"}
    )
    unseen = []
    for path, tree in parsed.items():
        origin = {
            alias.asname or alias.name: node.module
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("seaglint")
            for alias in node.names
        }
        for function in (f for f in tree.body if isinstance(f, ast.FunctionDef) and is_kernel(f)):
            used = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
            own = {node.id for node in used if isinstance(node.ctx, ast.Store)} | {"FloatArray", "kernel", "njit", "njit_parallel"}
            foreign = {node.id for node in used if node.id in origin and origin[node.id] not in seen} - own
            unseen += [f"{path.name}: {function.name}: {name}" for name in foreign]
    assert unseen == []


def tracked_files() -> list[Path]:
    """Files under version control; of a source archive without it, none."""
    if not (ROOT / ".git").exists():
        pytest.skip("not a git checkout")
    listed = subprocess.run(["git", "ls-files", "-z"], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    return [ROOT / name for name in listed.split("\0") if name]


# In pieces, so that this file passes its own test.
FORBIDDEN = {
    "a path of somebody's machine": re.compile(r"(?<![\w.])/(" + "work|root|home|Users|opt|mnt" + r")/\w"),
    "a folder outside the repository": re.compile(r"\.\./" + r"(shared|\.\./\.\.)"),
    "a package index": re.compile("pypi" + r"\.org/simple|files" + r"\.pythonhosted"),
    "a setting that names a package index": re.compile("index" + "-url|find" + "-links"),
    "an issue number": re.compile(r"(?i)\b" + "issues?" + r"\s+#?\d|(?<![\w/&'\"])" + r"#\d{1,4}(?!\w)(?=[\s.,;:)]|$)"),
}


ALLOWED = {
    "a folder outside the repository": [ROOT / "tools" / "data_folders.py"],
    "a setting that names a package index": [ROOT / "tools" / "pip_settings.py", ROOT / "tests" / "test_pip_settings.py"],
}
"""The first looks for reference data beside the repository, and does without; the others translate what a visitor's pip is set to."""


@pytest.mark.parametrize("what", FORBIDDEN)
def test_tracked_files_stand_on_their_own(what: str) -> None:
    found = []
    for path in tracked_files():
        if path in ALLOWED.get(what, []):
            continue
        try:
            lines = path.read_text(encoding="utf-8").splitlines()
        except (UnicodeDecodeError, FileNotFoundError):
            continue
        found += [f"{path.relative_to(ROOT)}:{i}: {line.strip()[:100]}" for i, line in enumerate(lines, 1) if FORBIDDEN[what].search(line)]
    assert found == []


def test_a_plain_function_that_becomes_a_kernel_elsewhere_counts(tmp_path: Path) -> None:
    """``series_bracket`` of the slopes is compiled by the glint: its file imports no ``base.jit``."""
    import shutil

    copy = tmp_path / "seaglint"
    shutil.copytree(SOURCE, copy, ignore=shutil.ignore_patterns("__pycache__", "data"))
    before = sources_digest(copy)
    changed = copy / "sea" / "slopes" / "slope_statistics.py"
    changed.write_text(changed.read_text(encoding="utf-8") + "\nCHANGED = 1\n", encoding="utf-8")
    assert sources_digest(copy) != before == sources_digest(SOURCE)


def test_rooms_are_not_crowded() -> None:
    """Files and the kernels' lists of parameters stay short enough to be read at once."""
    long, wide = [], []
    for path in sorted(SOURCE.rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if text.count("\n") > 700:
            long.append(f"{path.name}: {text.count(chr(10))} lines")
        for node in ast.walk(tree_of(path)):
            if isinstance(node, ast.FunctionDef) and is_kernel(node) and len(node.args.args) > 10:
                wide.append(f"{path.name}: {node.name}")
    assert long == []
    assert wide == []


def test_class_names_mean_one_thing() -> None:
    assert repeated_classes(trees(SOURCE)) == {}


def test_file_names_mean_one_thing() -> None:
    assert repeated_stems(trees(SOURCE)) == {}


def test_errors_below_the_command_line_speak_of_parameters() -> None:
    """Options are spelled in ``cli`` alone: a caller from Python has none."""
    assert options_below(trees(SOURCE)) == []


def test_public_docstrings_open_with_a_subject() -> None:
    """A first sentence stands alone in an editor: none opens with "Of", "The same", "What" and their like."""
    assert riddles(trees(SOURCE)) == []


def test_the_census_counts_what_is_there(tmp_path: Path) -> None:
    """A small tree with one or two of everything."""
    (tmp_path / "cli").mkdir()
    (tmp_path / "cli" / "run.py").write_text(
        '"""Run."""\napp.command("run")(run)\nOPTION = ["--speed", "--on/--off"]\n'
        "class Given:\n    a: int\n    b: int\ndef run(given: Given, c: int) -> None:\n    raise ValueError('--speed')\n"
    )
    (tmp_path / "run.py").write_text(
        '"""Of the ship."""\nclass Given:\n    """What is given."""\n'
        'def whole() -> str:\n    """Whole."""\n    found: int = 1\n    raise ValueError(f\'{found} --off --elsewhere\')\n'
    )
    counts = {what: count for what, count, _ in census(tmp_path)}
    assert counts["class names that mean several things"] == "1 (2 of 2 classes)"
    assert counts["files that share their name"] == "2 of 2 (1 names)"
    assert counts["public docstrings that open with a riddle"] == "2 of 4 (50.0%)"
    assert counts["assignments to found, told, wanted, kept"] == "1"
    assert counts["longest option list"] == "3"
    assert counts["options named in a raise outside cli"] == "1"


def test_package_data_are_small() -> None:
    """The wheel stays downloadable anywhere: tables, spectra and optical constants within 15 MB."""
    size = sum(p.stat().st_size for p in SOURCE.rglob("*") if p.is_file() and "__pycache__" not in p.parts)
    assert size < 15e6


@pytest.mark.skipif(os.name != "posix", reason="bash script")
@pytest.mark.parametrize("script", ["run", ".ci/run"])
def test_scripts_are_executable_and_parse(script: str) -> None:
    assert os.access(ROOT / script, os.X_OK)
    assert subprocess.run(["bash", "-n", str(ROOT / script)], check=False).returncode == 0
