"""Pictures of docs/gallery with the scripts that draw them.

``{gallery-picture} NAME`` shows a picture of ``docs/images/gallery``, what the script's docstring says of it, and the script;
``{gallery-cards} NAME ...`` shows small pictures that link to where these are.
"""

from __future__ import annotations

import ast
from pathlib import Path
from typing import NamedTuple

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

DOCS = Path(__file__).resolve().parents[1]
SCRIPTS = DOCS / "gallery"
IMAGES = DOCS / "images" / "gallery"


class Entry(NamedTuple):
    """A script's title and what it shows."""

    title: str
    text: str


def entry(name: str) -> Entry:
    """First line and the rest of a script's docstring."""
    told = ast.get_docstring(ast.parse((SCRIPTS / f"{name}.py").read_text(encoding="utf-8")))
    if told is None:
        raise ValueError(f"docs/gallery/{name}.py has no docstring; its first line is the title")
    title, _, text = told.partition("\n")
    return Entry(title.rstrip("."), " ".join(text.split()))


def picture(name: str) -> str:
    """Path of the large picture, from the root of the documentation."""
    found = [path for ending in ("png", "jpg") if (path := IMAGES / f"{name}.{ending}").exists()]
    if not found:
        raise ValueError(f"docs/images/gallery has no {name}.png or .jpg; run python tools/make_gallery.py {name}")
    return f"/images/gallery/{found[0].name}"


class Made(SphinxDirective):
    """Parse Markdown made by :meth:`lines` in place."""

    required_arguments = 1
    optional_arguments = 100

    def lines(self) -> list[str]:
        """Markdown to insert."""
        raise NotImplementedError

    def run(self) -> list[nodes.Node]:
        """Insert it; the page is made anew when a script changes."""
        for name in self.arguments:
            self.env.note_dependency(str(SCRIPTS / f"{name}.py"))
        node = nodes.container()
        self.state.nested_parse(StringList(self.lines(), source="gallery"), self.content_offset, node)
        return node.children


class GalleryPicture(Made):
    """A picture, its text and its script."""

    def lines(self) -> list[str]:
        """Markdown to insert."""
        (name,) = self.arguments
        title, text = entry(name)
        return [
            text,
            "",
            f"![{title}]({picture(name)})",
            "",
            f":::{{dropdown}} docs/gallery/{name}.py",
            f"```{{literalinclude}} /gallery/{name}.py",
            ":language: python",
            ":start-after: SEAGLINT_GALLERY_SIZE",
            "```",
            f"The whole script: {{download}}`{name}.py </gallery/{name}.py>`.",
            ":::",
        ]


class GalleryCards(Made):
    """Small pictures with titles."""

    def lines(self) -> list[str]:
        """Markdown to insert."""
        out = ["::::{grid} 2 3 3 4", ":gutter: 2", ""]
        for name in self.arguments:
            title = entry(name).title
            out += [
                ":::{grid-item-card}",
                f":img-top: /images/gallery/small/{name}.jpg",
                f":img-alt: {title}",
                f":link: gallery-{name.replace('_', '-')}",
                ":link-type: ref",
                title,
                ":::",
                "",
            ]
        return [*out, "::::"]


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    app.add_directive("gallery-picture", GalleryPicture)
    app.add_directive("gallery-cards", GalleryCards)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
