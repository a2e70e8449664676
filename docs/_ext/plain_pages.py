"""Pages of plain Markdown, which read without a build, made into Sphinx's lists, references and copies as they are read.

``<!-- include -->`` before a link alone on its line shows the file in the place of the link: another page whole, or with a language
(``<!-- include toml -->``) a block of code. Links between ``<!-- toctree -->`` and ``<!-- end toctree -->`` become the list of pages: each
line ``**Caption**: [title](page.md), ...`` a hidden one, list items one that is shown. Behind each table of the reference comes the list
of its pages. ``<!-- video -->`` before a picture that leads to a video shows the video, with the picture until it plays. Public names such
as ```sg.mean``` lead to their documentation.
"""

from __future__ import annotations

import re
from html import escape
from typing import TYPE_CHECKING

from reference import page_names, target_of

if TYPE_CHECKING:
    from sphinx.application import Sphinx

INCLUDE = re.compile(r"^<!-- include(?: (?P<language>\w+))? -->\n\[(?P<title>[^\]]*)\]\((?P<path>[^)]*)\)$", re.MULTILINE)
TOCTREE = re.compile(r"^<!-- toctree -->\n(?P<body>.*?)^<!-- end toctree -->$", re.DOTALL | re.MULTILINE)
SHELF = re.compile(r"^<!-- end (?P<name>functions|records|physics) -->$", re.MULTILINE)
SHELVES = {"functions": ("sg",), "records": ("records", "scenario"), "physics": ("physics",)}
"""Kinds of the generated pages behind the tables of the reference."""
VIDEO = re.compile(r"^<!-- video -->\n\[!\[(?P<words>[^\]]*)\]\((?P<poster>[^)]*)\)\]\((?P<path>[^)]*)\)$", re.MULTILINE)
PAGE = re.compile(r"\]\(([\w./-]+)\.md\)")
FENCE = re.compile(r"^(?P<fence>```+|~~~+).*?^(?P=fence)[ ]*$", re.DOTALL | re.MULTILINE)
NAME = re.compile(r"(?<![`\[}\w])`((?:seaglint|sg)(?:\.\w+)+)`(?!`)")


def directive(name: str, argument: str, options: list[str], body: list[str] | None = None) -> str:
    """Return a MyST directive."""
    return "\n".join((f"```{{{name}}} {argument}".rstrip(), *options, *(("", *body) if body else ()), "```"))


def included(match: re.Match[str]) -> str:
    """Return what shows the file of a link."""
    title, path, language = match["title"], match["path"], match["language"]
    if language is None:
        return directive("include", path, [])
    if language != "python":
        return directive("literalinclude", path, [f":language: {language}"])
    # A script of the gallery: what follows the line on its size, folded away.
    code = directive("literalinclude", path, [":language: python", ":start-after: SEAGLINT_GALLERY_SIZE"])
    return f"<details><summary>{title}</summary>\n\n{code}\n\nThe whole script: {{download}}`{path} <{path}>`.\n\n</details>"


def listed(match: re.Match[str]) -> str:
    """Return the lists of pages that stand for links."""
    lines = match["body"].splitlines()
    if any(line.startswith("- [") for line in lines):
        return directive("toctree", "", [":maxdepth: 1"], PAGE.findall(match["body"]))
    captioned = (re.match(r"\*\*(.*?)\*\*: (.*)", line) for line in lines)
    return "\n\n".join(directive("toctree", "", [f":caption: {line[1]}", ":hidden:"], PAGE.findall(line[2])) for line in captioned if line)


def shelved(match: re.Match[str]) -> str:
    """Return the list of the pages that a table of the reference names."""
    return directive("toctree", "", [":hidden:"], [f"generated/{name}" for name in page_names(*SHELVES[match["name"]])])


def named(match: re.Match[str]) -> str:
    """Return a name with a link to its documentation, if it has any."""
    target = target_of(match[1])
    return f"{{py:obj}}`{match[1]} <{target}>`" if target else match[0]


def played(match: re.Match[str]) -> str:
    """Return a video that is read when it is played; where a browser cannot play it, a link."""
    words, poster, path = (escape(match[name]) for name in ("words", "poster", "path"))
    return (
        f'<video controls muted loop playsinline preload="metadata" poster="{poster}" aria-label="{words}">'
        f'<source src="{path}" type="video/mp4"><a href="{path}">{words}</a></video>'
    )


def linked(text: str) -> str:
    """Return a page with links from public names to their documentation, outside of blocks of code."""
    pieces, end = [], 0
    for block in FENCE.finditer(text):
        pieces += [NAME.sub(named, text[end : block.start()]), block.group()]
        end = block.end()
    return "".join((*pieces, NAME.sub(named, text[end:])))


def built(text: str) -> str:
    """Return a page as Sphinx reads it."""
    return SHELF.sub(shelved, TOCTREE.sub(listed, VIDEO.sub(played, INCLUDE.sub(included, linked(text)))))


def read(app: Sphinx, name: str, source: list[str]) -> None:
    """Change a page of Markdown before it is parsed."""
    if str(app.env.doc2path(name)).endswith(".md"):
        source[0] = built(source[0])


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to the reading of pages."""
    app.connect("source-read", read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
