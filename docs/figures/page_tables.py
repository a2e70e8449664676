"""Tables, lists and pictures of the pages that come from the code, written into the Markdown, so that pages read without a build.

    python docs/figures/page_tables.py                         write all blocks anew
    python docs/figures/page_tables.py docs/guide/scenario.md  those of some pages

Each block stands between ``<!-- begin NAME -->`` and ``<!-- end NAME -->``; ``./run tables pages`` calls this program, and a test compares.
"""

from __future__ import annotations

import ast
import csv
import json
import re
import sys
import tomllib
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "_ext"))

import reference

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
GALLERY = DOCS / "gallery"
IMAGES = DOCS / "images" / "gallery"

PICTURES: dict[str, tuple[str, ...]] = {
    "sea": ("glint_winds", "sun_heights", "sunset", "night", "panorama", "plan_view", "swell", "range_time"),
    "objects": ("harbour", "ships_boxes", "curvature", "approach"),
    "radiance": ("layers", "slopes", "mean_profile", "elevation_profile", "air_spectra", "wave_spectrum"),
    "sensors": ("sensor_presets", "noise"),
    "statistics": ("gamma_tails", "texture", "roc", "detection_polar", "wind_rose", "likelihood_map"),
    "scenes": ("ensemble_draws",),
}
"""Pictures of each page of the gallery, in their order."""

CHOSEN = ("sunset", "panorama", "ships_boxes", "swell", "night", "plan_view", "layers", "ensemble_draws")
"""Pictures on the first page."""

ACROSS = 4
"""Small pictures in a row."""

SCENARIO_TABLES = (
    *("time", "place", "sun", "moon", "sensor", "platform", "band", "wind", "sea"),
    *("atmosphere", "mean", "render", "objects", "likelihood"),
)
"""Tables of the scenario file, which have a page each."""

Schema = dict[str, Any]


def scenario_schema() -> Schema:
    """JSON Schema of a scenario file."""
    from seaglint.scenario.model import Scenario

    return Scenario.model_json_schema()


def resolve(schema: Schema, root: Schema) -> Schema:
    """Follow a reference; what stands beside it (description, default) wins."""
    if "$ref" not in schema:
        return schema
    target: Any = root
    for part in schema["$ref"].removeprefix("#/").split("/"):
        target = target[part]
    return resolve(target, root) | {k: v for k, v in schema.items() if k != "$ref"}


def branches(schema: Schema, root: Schema) -> list[Schema]:
    """Alternatives of a key that has several, without "nothing"."""
    options = schema.get("oneOf") or schema.get("anyOf") or [schema]
    return [r for o in options if (r := resolve(o, root)).get("type") != "null"]


def allowed(schema: Schema, root: Schema) -> str:
    """What a value may be, in words."""
    options = branches(schema, root)
    if len(options) > 1:
        words = list(dict.fromkeys(allowed(o, root) for o in options))
        return " or ".join("text with a unit" if word == "text" and len(words) > 1 else word for word in words)
    kind = options[0]
    if "const" in kind:
        return f'`"{kind["const"]}"`'
    if "enum" in kind:
        return ", ".join(f"`{json.dumps(v)}`" for v in kind["enum"])
    if kind.get("type") == "array" and "discriminator" in kind.get("items", {}):
        return "[tables]"
    if kind.get("type") == "array":
        items = kind.get("prefixItems") or [kind.get("items", {})]
        return "[" + ", ".join(allowed(i, root) for i in items) + "]"
    if "properties" in kind:
        return "table"
    bounds = [
        f"{sign} {kind[key]:g}"
        for sign, key in ((">", "exclusiveMinimum"), ("≥", "minimum"), ("<", "exclusiveMaximum"), ("≤", "maximum"))
        if key in kind
    ]
    name = {"number": "number", "integer": "whole number", "boolean": "`true` or `false`", "string": "text"}.get(kind.get("type", ""), "")
    return " ".join(filter(None, [kind.get("format", "") or name, ", ".join(bounds)]))


def rows(schema: Schema, root: Schema, prefix: str) -> Iterator[tuple[str, str, str, str]]:
    """(key, allowed, default, meaning) of every key under ``prefix``, tables in tables with dotted keys."""
    for key, raw in schema.get("properties", {}).items():
        value = resolve(raw, root)
        path = f"{prefix}{key}"
        options = branches(value, root)
        # a union that may be left out stands inside of its alternatives
        union = next((o for o in (value, *options) if "discriminator" in o), {})
        tag = (union.get("discriminator") or {}).get("propertyName")
        options = branches(union, root) if tag else options
        if tag:
            names = [o["properties"][tag]["const"] for o in options]
            default = value.get("default", {}).get(tag) if isinstance(value.get("default"), dict) else None
            yield f"{path}.{tag}", ", ".join(f'`"{n}"`' for n in names), cell_default(default), value.get("description", "")
            told: set[tuple[str, str, str, str]] = set()  # what several kinds share is listed with the first
            for name, option in zip(names, options, strict=True):
                meaning = option.get("description", "").split("\n")[0]
                yield f'{path}.{tag} = "{name}"', "", "", meaning
                rest = {k: v for k, v in option.get("properties", {}).items() if k != tag}
                new = [row for row in rows({"properties": rest}, root, f"{path}.") if row not in told]
                told.update(new)
                yield from new
        elif options and "properties" in options[0]:
            yield from rows(options[0], root, f"{path}.")
        else:
            yield path, allowed(value, root), cell_default(value.get("default")), value.get("description", "")


def cell_default(default: Any) -> str:
    """A default as it would be written in the file."""
    return "" if default is None else f"`{json.dumps(default)}`"


def markdown_table(head: tuple[str, ...], body: list[tuple[str, ...]]) -> list[str]:
    """Lines of a Markdown table."""
    lines = [head, tuple("---" for _ in head), *body]
    return ["| " + " | ".join(re.sub(r"\s+", " ", cell).replace("|", "\\|") for cell in line) + " |" for line in lines]


HEAD = ("key", "allowed", "default", "meaning")


def scenario_table(name: str, root: Schema) -> tuple[str, list[tuple[str, ...]]]:
    """First sentence on a table of the scenario file and the rows of its keys; of a key outside of any table its row alone."""
    section = resolve(root["properties"][name], root)
    listed = (resolve(option.get("items", {}), root) for option in branches(section, root))
    items = next((item for item in listed if "properties" in item), None)
    short = root["properties"][name].get("description", "")
    about = f"{short[:1].upper()}{short[1:]}." if short else branches(section, root)[0].get("description", "").split("\n")[0]
    if items is not None:
        return about, list(rows(items, root, ""))
    found = list(rows({"properties": {name: section}}, root, ""))
    return about, [(path.removeprefix(f"{name}."), *rest) for path, *rest in found]  # as in the file


def key_table(body: list[tuple[str, ...]]) -> list[str]:
    """A table of keys."""
    return markdown_table(HEAD, [(f"`{path}`", *rest) for path, *rest in body])


def table_keys(name: str) -> list[str]:
    """Keys of a table of the scenario file."""
    about, body = scenario_table(name, scenario_schema())
    return [about.replace("``", "`"), "", *key_table(body)]


def scenario_tables() -> list[str]:
    """Tables of the scenario file with their pages."""
    root = scenario_schema()
    body = []
    for name in SCENARIO_TABLES:
        about, keys = scenario_table(name, root)
        shown = f"[[{name}]]" if name == "objects" else f"[{name}]"
        body.append((f"[`{shown}`](scenario/{name}.md)", about.replace("``", "`"), str(sum(bool(allowed) for _, allowed, *_ in keys))))
    return markdown_table(("table", "contents", "keys"), body)


def scenario_keys() -> list[str]:
    """Keys outside of any table."""
    root = scenario_schema()
    others = (name for name in root["properties"] if name not in SCENARIO_TABLES)
    return key_table([row for name in others for row in scenario_table(name, root)[1]])


def scenario_presets() -> list[str]:
    """Presets with where their numbers come from."""
    from seaglint.scenario.presets import PRESETS

    return markdown_table(("preset", "scene", "remarks"), [(f"`{k}`", p.title, " ".join(p.notes)) for k, p in PRESETS.items()])


def object_presets() -> list[str]:
    """Objects of public dimensions with where their numbers come from."""
    from seaglint.scenario.presets import OBJECTS

    return markdown_table(("preset", "object", "sources"), [(f"`{k}`", p.title, "; ".join(p.sources)) for k, p in OBJECTS.items()])


def output_variables() -> list[str]:
    """Variables of the output files with CF names and units."""
    from seaglint.base import schema

    body = [(f"`{v.name}`", v.units, v.standard_name or "", v.long_name) for v in schema.VARIABLES.values()]
    return markdown_table(("name", "units", "CF standard name", "meaning"), body)


class Entry(NamedTuple):
    """A script's title and what it shows."""

    title: str
    text: str


def entry(name: str) -> Entry:
    """First line and the rest of the docstring of a script of the gallery."""
    docstring = ast.get_docstring(ast.parse((GALLERY / f"{name}.py").read_text(encoding="utf-8")))
    if docstring is None:
        raise SystemExit(f"docs/gallery/{name}.py has no docstring; its first line is the title")
    title, _, text = docstring.partition("\n")
    return Entry(title.rstrip("."), " ".join(text.split()))


def gallery_pictures(page: str) -> list[str]:
    """Sections of a page of the gallery: title, words, picture and script."""
    lines: list[str] = []
    for name in PICTURES[page]:
        found = [path.name for path in IMAGES.glob(f"{name}.*")]
        if len(found) != 1:
            raise SystemExit(f"docs/images/gallery has {len(found)} pictures {name}.*; run python docs/figures/make_gallery.py {name}")
        title, text = entry(name)
        lines += [f"## {title}", "", text, "", f"![{title}](../images/gallery/{found[0]})", ""]
        lines += ["<!-- include python -->", f"[docs/gallery/{name}.py]({name}.py)", ""]
    return lines[:-1]


def title_of(page: Path) -> str:
    """First heading of a page."""
    found = re.search(r"^# (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    if found is None:
        raise SystemExit(f"{page} has no title")
    return found[1]


def anchor(title: str) -> str:
    """Name of a heading in addresses, as code hosts and MyST make it."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def small_pictures(names: tuple[str, ...], folder: str, pages: str) -> list[str]:
    """A table of small pictures with titles that lead to the large ones."""
    of = {name: page for page, entries in PICTURES.items() for name in entries}
    across = min(ACROSS, len(names))
    lines = []
    for first in range(0, len(names), across):
        row = names[first : first + across]
        titles = [entry(name).title for name in row]
        targets = [f"{pages}{of[name]}.md#{anchor(title)}" for name, title in zip(row, titles, strict=True)]
        empty = [""] * (across - len(row))
        shown = [f"[![{t}]({folder}{n}.jpg)]({to})" for n, t, to in zip(row, titles, targets, strict=True)]
        named = [f"[{t}]({to})" for t, to in zip(titles, targets, strict=True)]
        lines += [*markdown_table((*shown, *empty), [(*named, *empty)]), ""]
    return lines[:-1]


def gallery_overview() -> list[str]:
    """Small pictures of every page of the gallery."""
    lines = []
    for page, names in PICTURES.items():
        lines += [f"## [{title_of(GALLERY / f'{page}.md')}]({page}.md)", "", *small_pictures(names, "../images/gallery/small/", ""), ""]
    return lines[:-1]


def first_gallery() -> list[str]:
    """Small pictures of the first page."""
    return small_pictures(CHOSEN, "images/gallery/small/", "gallery/")


def rooms() -> list[str]:
    """Rooms of the package, from the top of the house, with the first sentences of their docstrings."""
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"]
    floors = next(contract["layers"] for contract in contracts if contract["name"] == "Floors of the house")
    body = []
    for module in [room.strip() for floor in floors for room in floor.split("|")]:
        path = ROOT / "src" / Path(*module.split("."))
        file = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
        about = " ".join((ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or "").split("\n\n")[0].split()).replace("``", "`")
        body.append((f"`{module}`", about))
    return markdown_table(("room", "holds"), body)


def reference_functions() -> list[str]:
    """Functions of ``sg`` with their first sentences."""
    body = []
    for name, inner in reference.functions().items():
        for each in [f"{name}.{one}" for one in inner] or [name]:
            about = reference.docstring_of(f"sg.{each}").split("\n\n")[0]
            body.append((f"`sg.{each}`", about.replace("``", "`")))
    return markdown_table(("function", "does"), body)


def reference_groups(pages: dict[str, dict[str, list[str]]]) -> list[str]:
    """Pages of the reference by title, with the names on each."""
    body = [
        (title, ", ".join(f"`{module}.{name}`" for module, names in modules.items() for name in names)) for title, modules in pages.items()
    ]
    return markdown_table(("page", "names"), body)


def reference_records() -> list[str]:
    """Records of the reference by page."""
    return reference_groups(reference.record_pages())


def reference_physics() -> list[str]:
    """Functions of physics by page."""
    return reference_groups(reference.physics_pages())


def comparisons() -> list[str]:
    """All comparisons of the pages of validation: what, against what, how far apart, how many cases, when."""
    with (DOCS / "comparisons.csv").open(encoding="utf-8") as file:
        found = list(csv.DictReader(file))
    made = tomllib.loads((DOCS / "data" / "made.toml").read_text(encoding="utf-8"))
    body = []
    for row in found:
        page = row["page"].removeprefix("../") if row["page"].startswith("../") else f"validation/{row['page']}"
        when = made[row["made"]]["date"] if row["made"] else "tested in each run"
        body.append((f"[{row['what']}]({page})", row["against"], row["apart"], row["cases"], when))
    return markdown_table(("what", "against", "how far apart", "cases", "made"), body)


def decisions() -> list[str]:
    """Records of decisions by number, after the list of packages."""
    pages = sorted(path for path in (DOCS / "adr").glob("*.md") if path.stem not in ("index", "dependencies"))
    return [f"- [{title_of(path)}]({path.name})" for path in (DOCS / "adr" / "dependencies.md", *pages)]


BLOCKS: dict[str, Callable[[], list[str]]] = {
    "docs/guide/scenario.md#scenario-presets": scenario_presets,
    "docs/guide/scenario.md#scenario-tables": scenario_tables,
    "docs/guide/scenario.md#scenario-keys": scenario_keys,
    **{f"docs/guide/scenario/{name}.md#keys": partial(table_keys, name) for name in SCENARIO_TABLES},
    "docs/validation.md#comparisons": comparisons,
    "docs/guide/objects.md#object-presets": object_presets,
    "docs/guide/output.md#output-variables": output_variables,
    **{f"docs/gallery/{page}.md#pictures": partial(gallery_pictures, page) for page in PICTURES},
    "docs/gallery/index.md#overview": gallery_overview,
    "docs/index.md#gallery": first_gallery,
    "docs/api/index.md#functions": reference_functions,
    "docs/api/index.md#records": reference_records,
    "docs/api/index.md#physics": reference_physics,
    "docs/architecture.md#rooms": rooms,
    "docs/adr/index.md#records": decisions,
}
"""What makes the lines of each block."""


def markers(name: str) -> tuple[str, str]:
    """Lines around a block."""
    return f"<!-- begin {name} -->", f"<!-- end {name} -->"


def written(place: str) -> list[str]:
    """Lines of a block in its page."""
    page, name = place.split("#")
    begin, end = markers(name)
    found = re.search(rf"^{re.escape(begin)}\n(.*?)^{re.escape(end)}$", (ROOT / page).read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    if found is None:
        raise SystemExit(f"{page} lacks the lines '{begin}' and '{end}'; put them where the block shall be")
    return found[1].strip().split("\n")


def main(pages: list[str]) -> int:
    """Write the blocks of some pages, or all."""
    if unknown := set(pages) - {place.split("#")[0] for place in BLOCKS}:
        raise SystemExit(f"no blocks in {', '.join(sorted(unknown))}; there are {', '.join(BLOCKS)}")
    for place, make in BLOCKS.items():
        page, name = place.split("#")
        if pages and page not in pages:
            continue
        written(place)
        begin, end = markers(name)
        text = (ROOT / page).read_text(encoding="utf-8")
        head, rest = text.split(f"{begin}\n", 1)
        (ROOT / page).write_text("\n".join((f"{head}{begin}\n", *make(), "", end)) + rest.split(end, 1)[1], encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
