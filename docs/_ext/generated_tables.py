"""Tables of the guide that come from the code, so that they never go stale.

``{scenario-keys}`` lists every key of a scenario file from its JSON Schema; ``{scenario-presets}`` lists the presets,
``{object-presets}`` those of objects;
``{output-variables}`` lists what files hold.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

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
    """Lines of a MyST table."""
    lines = [head, tuple("---" for _ in head), *body]
    return ["| " + " | ".join(re.sub(r"\s+", " ", cell).replace("|", "\\|") for cell in line) + " |" for line in lines]


class GeneratedTable(SphinxDirective):
    """Parse Markdown made by :meth:`lines` in place."""

    def lines(self) -> list[str]:
        """Markdown to insert."""
        raise NotImplementedError

    def run(self) -> list[nodes.Node]:
        """Insert it."""
        node = nodes.container()
        self.state.nested_parse(StringList(self.lines(), source="generated"), self.content_offset, node)
        return node.children


class ScenarioKeys(GeneratedTable):
    """One table for each table of the scenario file."""

    def lines(self) -> list[str]:
        """Markdown to insert."""
        root = scenario_schema()
        out: list[str] = []
        loose = []
        for name, raw in root["properties"].items():
            section = resolve(raw, root)
            items = next(
                (resolve(o["items"], root) for o in branches(section, root) if "properties" in resolve(o.get("items", {}), root)), None
            )
            if items is not None:
                about = items.get("description", "").split("\n")[0]
                body = [(f"`{path}`", *rest) for path, *rest in rows(items, root, "")]
                out += ["", f"**`[[{name}]]`** {about}", "", *markdown_table(("key", "allowed", "default", "meaning"), body)]
                continue
            found = list(rows({"properties": {name: raw}}, root, ""))
            if len(found) == 1 and found[0][0] == name:
                loose.append(found[0])
                continue
            about = " / ".join(dict.fromkeys(b.get("description", "").split("\n")[0] for b in branches(section, root)[:1]))
            # Keys inside a table are written without the table's name, as in the file.
            body = [(f"`{path.removeprefix(name + '.')}`", *rest) for path, *rest in found]
            out += ["", f"**`[{name}]`** {about}", "", *markdown_table(("key", "allowed", "default", "meaning"), body)]
        head = markdown_table(("key", "allowed", "default", "meaning"), [(f"`{path}`", *rest) for path, *rest in loose])
        return ["**Outside of any table**", "", *head, *out]


class ScenarioPresets(GeneratedTable):
    """Presets with where their numbers come from."""

    def lines(self) -> list[str]:
        """Markdown to insert."""
        from seaglint.scenario.presets.scene_presets import PRESETS

        return markdown_table(("preset", "scene", "remarks"), [(f"`{k}`", p.title, " ".join(p.notes)) for k, p in PRESETS.items()])


class ObjectPresets(GeneratedTable):
    """Objects of public dimensions with where their numbers come from."""

    def lines(self) -> list[str]:
        """Markdown to insert."""
        from seaglint.scenario.presets.object_presets import OBJECTS

        return markdown_table(("preset", "object", "sources"), [(f"`{k}`", p.title, "; ".join(p.sources)) for k, p in OBJECTS.items()])


class OutputVariables(GeneratedTable):
    """Variables of the output files with CF names and units."""

    def lines(self) -> list[str]:
        """Markdown to insert."""
        from seaglint.base import schema

        body = [(f"`{v.name}`", v.units, v.standard_name or "", v.long_name) for v in schema.VARIABLES.values()]
        return markdown_table(("name", "units", "CF standard name", "meaning"), body)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    app.add_directive("scenario-keys", ScenarioKeys)
    app.add_directive("scenario-presets", ScenarioPresets)
    app.add_directive("object-presets", ObjectPresets)
    app.add_directive("output-variables", OutputVariables)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
