"""Pages of the reference: public names only, as ``docs/api/public.toml`` lists them.

Each function of ``import seaglint as sg`` has a page under the name that users write; records that they take and return, tables of the
scenario, and physics by formula have a page for each group. Internals have no page.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import json
import re
import sys
import tomllib
from collections import Counter
from collections.abc import Iterable
from dataclasses import MISSING, fields
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sphinx.application import Sphinx

DOCS = Path(__file__).resolve().parents[1]
SOURCE = DOCS.parent / "src" / "seaglint"
GENERATED = DOCS / "api" / "generated"


@cache
def public() -> dict[str, Any]:
    """Return the lists of public names."""
    return tomllib.loads((DOCS / "api" / "public.toml").read_text(encoding="utf-8"))


@cache
def tree_of(module: str) -> ast.Module:
    """Return the parsed source of a module."""
    path = SOURCE.parent.joinpath(*module.split("."))
    file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    return ast.parse(file.read_text(encoding="utf-8"))


def listed(tree: ast.Module) -> list[str]:
    """Return the names in ``__all__``."""
    lists = (node.value for node in tree.body if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__")
    return list(ast.literal_eval(next(lists)))


@cache
def functions() -> dict[str, list[str]]:
    """Return the names of ``sg``, each with the functions of its group; a function alone has none."""
    groups = {}
    for node in tree_of("seaglint.api").body:
        if isinstance(node, ast.ImportFrom) and node.module == "seaglint.api":
            groups |= {alias.asname: f"seaglint.api.{alias.name}" for alias in node.names}
    names = [name for name in listed(tree_of("seaglint")) if name != "__version__"]
    return {name: listed(tree_of(groups[name])) if name in groups else [] for name in names}


def api_modules() -> dict[str, str]:
    """Return under which name users find the functions of each module of ``seaglint.api``."""
    result = {"seaglint.api": "sg"}
    for node in tree_of("seaglint.api").body:
        if isinstance(node, ast.ImportFrom):
            places = {f"seaglint.api.{alias.name}": f"sg.{alias.asname}" for alias in node.names if alias.asname}
            result |= places or {str(node.module): "sg"}
    return result


def members(group: dict[str, Any], room: str = "") -> dict[str, list[str]]:
    """Return the names of each module of a group."""
    return {f"seaglint.{room}{module}": names for module, names in group.items() if isinstance(names, list)}


def records_of(module: str) -> list[str]:
    """Return the names of the records that a module of the scenario defines."""
    return [node.name for node in tree_of(module).body if isinstance(node, ast.ClassDef) and not node.name.startswith("_")]


def record_pages() -> dict[str, dict[str, list[str]]]:
    """Return the names on each page of records, by the page's title."""
    data = public()
    result = {group["title"]: members(group) for group in (*data["records"].values(), data["requests"])}
    tables = {f"seaglint.scenario.{module}": title for module, title in data["scenario"].items()}
    return result | {title: {module: records_of(module)} for module, title in tables.items()}


def physics_pages() -> dict[str, dict[str, list[str]]]:
    """Return the names on each page of physics, by the page's title."""
    return {group["title"]: members(group, f"{room}.") for room, group in public()["physics"].items()}


def shown() -> list[tuple[str, list[str]]]:
    """Return the modules and names on the pages, besides the functions of ``sg``."""
    return [each for pages in (record_pages(), physics_pages()) for modules in pages.values() for each in modules.items()]


def class_names() -> dict[str, str]:
    """Return the full name of each class on the pages by its last part, where it is the only class of that name."""
    every = [(name, f"{module}.{name}") for module, names in shown() for name in names if kind_of(module, name) == "class"]
    count = Counter(name for name, _ in every)
    return {name: full for name, full in every if count[name] == 1}


def nodes_of(group: str) -> list[ast.stmt]:
    """Return the statements of the modules whose functions users find in a group."""
    return [node for module, place in api_modules().items() if place == group for node in tree_of(module).body]


def full_name(name: str) -> str:
    """Return the name of which a name of ``sg`` is another one, as ``sg.compare`` is; else the name."""
    group, _, function = name.rpartition(".")
    others = (node for node in nodes_of(group) if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == function)
    return next((f"{group}.{ast.unparse(node.value)}" for node in others), name)


def docstring_of(name: str) -> str:
    """Return the docstring of a function of ``sg`` from its source."""
    group, _, function = full_name(name).rpartition(".")
    return [ast.get_docstring(node) or "" for node in nodes_of(group) if isinstance(node, ast.FunctionDef) and node.name == function][-1]


def attributes(module: str, name: str) -> list[str]:
    """Return the public methods and fields of a class."""
    node = next(node for node in tree_of(module).body if getattr(node, "name", "") == name)
    if not isinstance(node, ast.ClassDef):
        return []
    methods = [part.name for part in node.body if isinstance(part, ast.FunctionDef | ast.AsyncFunctionDef)]
    values = [part.target.id for part in node.body if isinstance(part, ast.AnnAssign) and isinstance(part.target, ast.Name)]
    return [part for part in (*methods, *values) if not part.startswith("_")]


@cache
def names() -> frozenset[str]:
    """Return every name that has a place in the reference: functions, groups of functions, modules of physics, classes with members."""
    result = {"sg", *(f"sg.{name}" for name in functions())}
    result |= {f"sg.{group}.{name}" for group, inner in functions().items() for name in inner}
    tables = {f"seaglint.scenario.{module}" for module in public()["scenario"]}
    physics = {module for modules in physics_pages().values() for module in modules}
    for module, inner in shown():
        result |= {f"{module}.{name}" for name in inner} | ({module} & (tables | physics))
        if module not in tables | set(members(public()["requests"])):
            result |= {f"{module}.{name}.{part}" for name in inner for part in attributes(module, name)}
    return frozenset(result)


def target_of(name: str) -> str | None:
    """Return the name under which the reference shows a name of the package; None if it does not."""
    places = [*sorted(api_modules().items(), reverse=True), ("seaglint", "sg")]
    others = (f"{place}{name.removeprefix(module)}" for module, place in places if name.startswith(f"{module}."))
    return next((each for each in (name, *others) if each in names()), None)


def headed(title: str, line: str) -> list[str]:
    """Return a title with the line below it."""
    return [title, line * len(title), ""]


def documented(kind: str, name: str, *options: str) -> list[str]:
    """Return the directive that shows a docstring; the search knows names as objects, and entries of an index would add half to it."""
    options = options if kind == "module" else (":no-index-entry:", *options)
    return [f".. auto{kind}:: {name}", *(f"   {option}" for option in options), ""]


def function_page(name: str, inner: list[str]) -> str:
    """Return the page of a name of ``sg``."""
    shown = public()["functions"].get(name, {})
    lines = headed(f"sg.{name}", "=")
    full = [f"sg.{name}.{each}" for each in inner]
    if inner:
        lines += [*documented("module", f"sg.{name}"), *table((each, docstring_of(each)) for each in full)]
        for each in full:
            lines += [*headed(each, "-"), *documented("function", each)]
    else:
        if full_name(f"sg.{name}") != f"sg.{name}":
            lines += [f"Another name of :py:func:`{full_name(f'sg.{name}')}`.", ""]
        lines += documented("function", f"sg.{name}")
    if "picture" in shown:
        caption = shown["shows"] + script_of(shown["picture"])
        lines += [f".. figure:: ../../images/{shown['picture']}", f"   :alt: {shown['shows']}", "", f"   {caption}", ""]
    if "guides" in shown:
        lines += ["Guides: " + ", ".join(f":doc:`/{guide}`" for guide in shown["guides"]) + ".", ""]
    return "\n".join(lines)


def script_of(picture: str) -> str:
    """Return a link to the script that draws a picture of the gallery; pictures of guides have none."""
    script = DOCS / "gallery" / f"{Path(picture).stem}.py"
    return f" The script: :download:`{script.name} <../../gallery/{script.name}>`." if picture.startswith("gallery/") else ""


def table(rows: Iterable[tuple[str, str]]) -> list[str]:
    """Return a table of names with the first sentence of each."""
    return cells(("name", "gives"), [(f":py:obj:`~{name}`", first_sentence(text)) for name, text in rows], "30 70")


def first_sentence(docstring: str) -> str:
    """Return the first sentence of a docstring; names in it lead nowhere, as they are relative to their module."""
    text = re.sub(r":\w+:`~?(?:[\w.]*\.)?(\w+)`", r"``\1``", " ".join(docstring.split("\n\n")[0].split()))
    return re.split(r"(?<=\.) (?=[A-Z`])", text)[0]


def docstring_in(module: str, name: str) -> str:
    """Return the docstring of a class or function of a module from its source."""
    nodes = (node for node in tree_of(module).body if isinstance(node, ast.ClassDef | ast.FunctionDef) and node.name == name)
    return [ast.get_docstring(node) or "" for node in nodes][-1]


def kind_of(module: str, name: str) -> str:
    """Return whether a name is a class or a function."""
    return "class" if any(isinstance(node, ast.ClassDef) and node.name == name for node in tree_of(module).body) else "function"


def record_page(group: dict[str, Any]) -> str:
    """Return a page of records with their members."""
    lines = [*headed(group["title"], "="), group["about"].replace("`", "``"), ""]
    every = [(module, name) for module, inner in members(group).items() for name in inner]
    lines += table((f"{module}.{name}", docstring_in(module, name)) for module, name in every)
    for module, name in every:
        kind = kind_of(module, name)
        lines += [*headed(name, "-"), *documented(kind, f"{module}.{name}", *([":members:"] if kind == "class" else []))]
    return "\n".join(lines)


def cells(head: tuple[str, ...], rows: list[tuple[str, ...]], widths: str) -> list[str]:
    """Return a table whose cells are text with markup."""
    lines = [".. list-table::", "   :header-rows: 1", "   :width: 100%", f"   :widths: {widths}", ""]
    for row in (head, *rows):
        lines += [f"   {'* -' if not place else '  -'} {' '.join(cell.split())}".rstrip() for place, cell in enumerate(row)]
    return [*lines, ""]


def literal(value: Any) -> str:
    """Return a value as code."""
    return "" if value is None or value is MISSING else f"``{value!r}``"


def request_page(group: dict[str, Any]) -> str:
    """Return the page of requests: every parameter with default and meaning."""
    from seaglint.base.parameters import described, sentences

    lines = [*headed(group["title"], "="), group["about"].replace("`", "``"), ""]
    for module, inner in members(group).items():
        for name in inner:
            record = getattr(importlib.import_module(module), name)
            texts = described(record)
            rows = [
                (f"``{field.name}``", literal(field.default), sentences(field.name, texts[field.name]))
                for field in fields(record)
                if field.name in texts
            ]
            own = [row for row in rows if row[0].strip("`") in record.__annotations__]
            lines += [
                *headed(name, "-"),
                f".. py:class:: {name}",
                f"   :module: {module}",
                "   :no-index-entry:",
                "",
                *indented(first_lines(record)),
                "",
            ]
            above = [f":class:`~{base.__module__}.{base.__name__}`" for base in record.__bases__ if base is not object]
            lines += indented(["Also the parameters of " + " and ".join(above) + ".", ""]) if above else []
            lines += indented(cells(("parameter", "default", "meaning"), own, "25 15 60")) if own else []
    return "\n".join(lines)


def first_lines(record: type) -> list[str]:
    """Return the first paragraph of a docstring."""
    return inspect.getdoc(record).split("\n\n")[0].splitlines()


def indented(lines: list[str]) -> list[str]:
    """Return lines as the body of a directive."""
    return [f"   {line}".rstrip() for line in lines]


def scenario_page(module: str, title: str) -> str:
    """Return the page of the records of a module of the scenario, with a table of the keys of each."""
    from page_tables import allowed, branches, resolve

    place = f"seaglint.scenario.{module}"
    lines = [*headed(title, "="), *documented("module", place)]
    for name in records_of(place):
        record = getattr(importlib.import_module(place), name)
        root = record.model_json_schema()
        rows = []
        for key, raw in root.get("properties", {}).items():
            value = resolve(raw, root)
            default = "" if value.get("default") is None or isinstance(value["default"], dict) else f"``{json.dumps(value['default'])}``"
            text = value.get("description") or "; ".join(part.get("description", "") for part in branches(value, root))
            about = "selects this model" if key == "kind" and not text else text_of(text)
            rows.append((f"``{key}``", allowed(value, root).replace("`", "``"), default, about))
        lines += [
            *headed(name, "-"),
            f".. py:class:: {name}",
            f"   :module: {place}",
            "   :no-index-entry:",
            "",
            *indented(inspect.getdoc(record).splitlines()),
            "",
        ]
        lines += [*indented(cells(("key", "allowed", "default", "meaning"), rows, "22 26 16 36") if rows else [])]
    return "\n".join(lines)


def text_of(description: str) -> str:
    """Return the first line of a description without markup."""
    return description.split("\n")[0].replace("*", r"\*").replace("|", r"\|")


def physics_page(room: str, group: dict[str, Any]) -> str:
    """Return the page of a room of physics: what each module says, and its functions."""
    about = (ast.get_docstring(tree_of(f"seaglint.{room}")) or "").split("\n\n")[0]
    modules = members(group, f"{room}.")
    lines = [*headed(group["title"], "="), about, ""]
    lines += table((f"{module}.{name}", docstring_in(module, name)) for module, inner in modules.items() for name in inner)
    for module, inner in modules.items():
        lines += [*headed(module.rpartition(".")[2].replace("_", " ").capitalize(), "-"), *documented("module", module)]
        for name in inner:
            kind = kind_of(module, name)
            lines += documented(kind, f"{module}.{name}", *([":members:"] if kind == "class" else []))
    return "\n".join(lines)


def page_texts() -> dict[str, str]:
    """Return the text of each page by its name, in the order of the lists."""
    data = public()
    result = {f"sg.{name}": function_page(name, inner) for name, inner in functions().items()}
    result |= {f"records.{name}": record_page(group) for name, group in data["records"].items()}
    result["records.requests"] = request_page(data["requests"])
    result |= {f"scenario.{module.rpartition('.')[2]}": scenario_page(module, title) for module, title in data["scenario"].items()}
    return result | {f"physics.{room}": physics_page(room, group) for room, group in data["physics"].items()}


def page_names(*kinds: str) -> list[str]:
    """Return the names of the pages of some kinds (sg, records, scenario, physics) in the order of the lists."""
    data = public()
    names = {
        "sg": list(functions()),
        "records": [*data["records"], "requests"],
        "scenario": [module.rpartition(".")[2] for module in data["scenario"]],
        "physics": list(data["physics"]),
    }
    return [f"{kind}.{name}" for kind in kinds for name in names[kind]]


def import_names() -> None:
    """Import what the pages show once, before readers fork from this process, and let ``sg`` be a name as in users' programs."""
    sg = importlib.import_module("seaglint")
    sys.modules["sg"] = sg
    for name, inner in functions().items():
        value = getattr(sg, name)
        if inner:
            sys.modules[f"sg.{name}"] = value
    for module, _ in shown():
        importlib.import_module(module)


def write_pages(app: Sphinx) -> None:
    """Write the pages that changed and remove those of names that are gone."""
    sys.path.insert(0, str(DOCS / "figures"))
    import_names()
    GENERATED.mkdir(exist_ok=True)
    texts = page_texts()
    for old in GENERATED.iterdir():
        if old.stem not in texts:
            old.unlink()
    for name, text in texts.items():
        target = GENERATED / f"{name}.rst"
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect before pages are looked for."""
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
