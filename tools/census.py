"""Count what makes a source tree hard to read: names that mean several things, riddles, crowded rooms, long functions and option lists.

python tools/census.py [-l] [FOLDER]

``-l`` lists what is behind the counts. A tree is any folder of Python files; a folder of it is a room.
"""

from __future__ import annotations

import argparse
import ast
import re
from collections import Counter, defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[1] / "src" / "seaglint"
RIDDLES = ("Of", "The same", "Those of", "What", "Whether")
"""Words with which a sentence begins that has no subject of its own."""
DIALECT = ("found", "told", "wanted", "kept")
LONG = 80
"""Lines of code above which a function is long; its docstring is not counted."""
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]+")

Trees = dict[Path, ast.Module]
Definition = ast.Module | ast.ClassDef | ast.FunctionDef


@cache
def trees(folder: Path) -> Trees:
    """Return the syntax tree of each Python file of a folder, by its path in the folder, as it was when first requested."""
    return {path.relative_to(folder): ast.parse(path.read_text(encoding="utf-8")) for path in sorted(folder.rglob("*.py"))}


def nodes(tree: Trees) -> Iterator[tuple[Path, ast.AST]]:
    """Yield each node with the path of its file."""
    for path, module in tree.items():
        for node in ast.walk(module):
            yield path, node


def place(path: Path, node: ast.AST) -> str:
    """Return a node's file and line."""
    return f"{path}:{getattr(node, 'lineno', 1)}"


def repeated_classes(tree: Trees) -> dict[str, list[str]]:
    """Return the places of each class name that is defined more than once."""
    places: dict[str, list[str]] = defaultdict(list)
    for path, node in nodes(tree):
        if isinstance(node, ast.ClassDef):
            places[node.name].append(place(path, node))
    return {name: where for name, where in places.items() if len(where) > 1}


def repeated_stems(tree: Trees) -> dict[str, list[str]]:
    """Return the files of each file name that several folders have, ``__init__`` aside."""
    files: dict[str, list[str]] = defaultdict(list)
    for path in tree:
        if path.stem != "__init__":
            files[path.stem].append(str(path))
    return {stem: where for stem, where in files.items() if len(where) > 1}


def public(body: list[ast.stmt]) -> Iterator[ast.ClassDef | ast.FunctionDef]:
    """Yield the public classes, methods and functions of a body."""
    for node in body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and not node.name.startswith("_"):
            yield node
            if isinstance(node, ast.ClassDef):
                yield from public(node.body)


def docstrings(tree: Trees) -> Iterator[tuple[str, str]]:
    """Yield place and text of each public docstring: modules, classes, functions."""
    for path, module in tree.items():
        definitions: list[Definition] = [module, *public(module.body)]
        for node in definitions:
            if text := ast.get_docstring(node):
                yield place(path, node), text


def riddles(tree: Trees) -> list[str]:
    """Return the public docstrings that open with one of :data:`RIDDLES`."""
    opening = re.compile(rf"({'|'.join(RIDDLES)})\b")
    return [f"{where}: {text.splitlines()[0]}" for where, text in docstrings(tree) if opening.match(text)]


def options_below(tree: Trees, room: str = "cli") -> list[str]:
    """Return the places outside a room where a ``raise`` spells one of that room's options; those of other programs may be named."""
    words = {n.value for path, n in nodes(tree) if path.parts[0] == room and isinstance(n, ast.Constant) and isinstance(n.value, str)}
    own = {option for word in words for option in word.split("/") if OPTION.fullmatch(option)}
    out = set()
    for path, node in nodes(tree):
        if isinstance(node, ast.Raise) and path.parts[0] != room:
            for part in ast.walk(node):
                if isinstance(part, ast.Constant) and isinstance(part.value, str):
                    out |= {f"{place(path, part)}: {option}" for option in OPTION.findall(part.value) if option in own}
    return sorted(out)


def dialect(tree: Trees) -> list[str]:
    """Return the assignments to :data:`DIALECT`."""
    out = []
    for path, node in nodes(tree):
        targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        out += [f"{place(path, node)}: {target.id}" for target in targets if isinstance(target, ast.Name) and target.id in DIALECT]
    return out


def assigned(tree: Trees, name: str) -> list[str]:
    """Return the places where a module gives a name a value, as for the name of a type."""
    return [
        place(path, node)
        for path, module in tree.items()
        for node in module.body
        if isinstance(node, ast.Assign) and any(isinstance(target, ast.Name) and target.id == name for target in node.targets)
    ]


def functions(tree: Trees) -> Iterator[tuple[Path, ast.FunctionDef | ast.AsyncFunctionDef]]:
    """Yield all functions and methods."""
    for path, node in nodes(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield path, node


def commands(tree: Trees) -> list[tuple[int, str]]:
    """Return the number of options and arguments of each command that a help page lists, most first.

    Commands are what ``.command`` decorates or is called with; hidden ones are left out. A parameter whose type is a record of the
    commands' room, or of a file of requests, stands for its fields and those that it inherits; those that ``Without`` names count as well.
    """
    classes: dict[str, tuple[list[str], set[str]]] = {}
    names: set[str] = set()
    for path, node in nodes(tree):
        if isinstance(node, ast.ClassDef) and (path.parts[0] == "cli" or path.stem.endswith("requests")):
            fields = {ast.unparse(field.target) for field in node.body if isinstance(field, ast.AnnAssign)}
            classes[node.name] = [ast.unparse(base) for base in node.bases], fields
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Call) and ast.unparse(node.func.func).endswith(".command"):
            names |= {argument.id for argument in node.args if isinstance(argument, ast.Name)}

    def options(name: str) -> set[str]:
        bases, own = classes.get(name, ([], set()))
        return own.union(*map(options, bases))

    out = []
    for path, function in functions(tree):
        decorators = " ".join(map(ast.unparse, function.decorator_list))
        decorated = re.search(r"\.command\b", decorators) and "hidden=True" not in decorators
        if path.parts[0] == "cli" and (decorated or function.name in names):
            shown: set[str] = set()
            for given in [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]:
                kind = "" if given.annotation is None else ast.unparse(given.annotation).removeprefix("Annotated[").partition(",")[0]
                shown |= options(kind) or {given.arg}
            out.append((len(shown), f"{place(path, function)}: {function.name}"))
    return sorted(out, reverse=True)


def rooms(tree: Trees) -> list[tuple[int, str]]:
    """Return the number of files in each folder, most first."""
    return sorted(((count, room) for room, count in Counter(str(path.parent) for path in tree).items()), reverse=True)


def code_lines(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Return the lines of a function without its docstring."""
    first = function.body[0]
    spoken = (first.end_lineno or 0) - first.lineno + 1 if ast.get_docstring(function) is not None else 0
    return (function.end_lineno or 0) - function.lineno + 1 - spoken


def long_functions(tree: Trees) -> list[str]:
    """Return the functions of more than :data:`LONG` lines."""
    return [f"{place(path, f)}: {f.name}, {code_lines(f)} lines" for path, f in functions(tree) if code_lines(f) > LONG]


def census(folder: Path) -> list[tuple[str, str, list[str]]]:
    """Return name, count and list of everything that is counted."""
    tree = trees(folder)
    classes, stems, riddling = repeated_classes(tree), repeated_stems(tree), riddles(tree)
    total, spoken = sum(isinstance(node, ast.ClassDef) for _, node in nodes(tree)), sum(1 for _ in docstrings(tree))
    crowded, wide = rooms(tree), commands(tree)
    texts = [(folder / path).read_text(encoding="utf-8") for path in tree]
    both = sum(map(len, classes.values())), sum(map(len, stems.values()))
    return [
        ("class names that mean several things", f"{len(classes)} ({both[0]} of {total} classes)", listed(classes)),
        ("files that share their name", f"{both[1]} of {len(tree)} ({len(stems)} names)", listed(stems)),
        ("public docstrings that open with a riddle", f"{len(riddling)} of {spoken} ({len(riddling) / max(spoken, 1):.1%})", riddling),
        (f"assignments to {', '.join(DIALECT)}", str(len(dialect(tree))), dialect(tree)),
        ("functions called _told", *counted([place(p, f) for p, f in functions(tree) if f.name == "_told"])),
        ("definitions of FloatArray", *counted(assigned(tree, "FloatArray"))),
        ("definitions of Progress", *counted(assigned(tree, "Progress"))),
        ("dict[str, Any]", str(sum(text.count("dict[str, Any]") for text in texts)), []),
        ("files in the fullest room", f"{crowded[0][0]} ({crowded[0][1]})", [f"{count:4d} {room}" for count, room in crowded]),
        ("lines", str(sum(text.count("\n") for text in texts)), []),
        (f"functions over {LONG} lines", *counted(long_functions(tree))),
        ("longest option list", str(wide[0][0]) if wide else "0", [f"{count:4d} {where}" for count, where in wide[:10]]),
        ("options named in a raise outside cli", *counted(options_below(tree))),
    ]


def counted(where: list[str]) -> tuple[str, list[str]]:
    """Return the length of a list, and the list."""
    return str(len(where)), where


def listed(places: dict[str, list[str]]) -> list[str]:
    """Return names with their places, a line each."""
    return [f"{name}: {', '.join(where)}" for name, where in sorted(places.items())]


def main() -> None:
    """Print the counts."""
    parser = argparse.ArgumentParser(description="Count what makes a source tree hard to read.")
    parser.add_argument("folder", nargs="?", type=Path, default=SOURCE)
    parser.add_argument("-l", "--list", action="store_true", help="what is behind each count")
    given = parser.parse_args()
    for what, count, where in census(given.folder):
        print(f"{what:44} {count}")
        if given.list:
            for line in where:
                print(f"    {line}")


if __name__ == "__main__":
    main()
