"""Draw the floors of the source from the import contract in pyproject.toml, into docs/images/house.svg.

python tools/house.py [-o FILE.svg]
"""

from __future__ import annotations

import argparse
import ast
import re
import tomllib
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "seaglint"
OUTPUT = ROOT / "docs" / "images" / "house.svg"
WIDTH, FLOOR, GAP, MARGIN = 900, 46, 6, 12
COLOURS = {"physics": "#d7e8f5", "use": "#f7e3c4", "plain": "#e8e8e8"}


def contracts() -> list[dict[str, object]]:
    """All import contracts."""
    found: list[dict[str, object]] = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    return found


def floors() -> list[list[str]]:
    """Rooms of each floor, from the top."""
    layers = next(c["layers"] for c in contracts() if c["type"] == "layers")
    assert isinstance(layers, list)
    return [[room.strip().removeprefix("seaglint.") for room in layer.split("|")] for layer in layers]


def physics() -> set[str]:
    """Rooms that know floats and arrays only."""
    named = next(c["source_modules"] for c in contracts() if str(c["name"]).startswith("Physics"))
    assert isinstance(named, list)
    return {str(name).removeprefix("seaglint.") for name in named}


def purpose(room: str) -> str:
    """First sentence of a room's docstring."""
    path = SOURCE / room / "__init__.py"
    path = path if path.exists() else SOURCE / f"{room}.py"
    told = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    plain = re.sub(r":mod:|`", "", " ".join(told.split("\n\n")[0].split()))
    return plain.split(". ")[0].rstrip(".")


def picture() -> str:
    """The house as SVG; a room's docstring is its tooltip."""
    inner, rows = physics(), floors()
    height = 2 * MARGIN + len(rows) * (FLOOR + GAP) - GAP + 26
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" font-family="sans-serif" font-size="15">',
        "<title>Floors of the source; imports point downwards only</title>",
        f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
    ]
    for level, rooms in enumerate(rows):
        y = MARGIN + level * (FLOOR + GAP)
        wide = (WIDTH - 2 * MARGIN - GAP * (len(rooms) - 1)) / len(rooms)
        for place, room in enumerate(rooms):
            x = MARGIN + place * (wide + GAP)
            known = purpose(room)
            kind = "physics" if room in inner else "plain" if room in ("base", "version") else "use"
            shown = known if len(known) < wide / 7.2 else known[: int(wide / 7.2) - 2].rsplit(" ", 1)[0] + " …"
            out += [
                f"<g><title>seaglint.{escape(room)}: {escape(known)}</title>",
                f'<rect x="{x:.1f}" y="{y}" width="{wide:.1f}" height="{FLOOR}" rx="4" fill="{COLOURS[kind]}" stroke="#888"/>',
                f'<text x="{x + wide / 2:.1f}" y="{y + 19}" text-anchor="middle" font-weight="bold">{escape(room)}</text>',
                f'<text x="{x + wide / 2:.1f}" y="{y + 37}" text-anchor="middle" font-size="11" fill="#444">{escape(shown)}</text></g>',
            ]
    told = "blue: physics of floats and arrays; sand: scenarios, files, plots, commands; grey: base. Imports point downwards only."
    out += [f'<text x="{MARGIN}" y="{height - MARGIN}" font-size="12" fill="#444">{told}</text>', "</svg>", ""]
    return "\n".join(out)


def main() -> None:
    """Write the picture."""
    parser = argparse.ArgumentParser(description="Draw the floors of the source.")
    parser.add_argument("-o", "--output", type=Path, default=OUTPUT)
    parser.parse_args().output.write_text(picture(), encoding="utf-8")


if __name__ == "__main__":
    main()
