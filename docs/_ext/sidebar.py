"""List of pages beside every page: a shelf for each caption of ``docs/index.md``, folded but for the one with the page shown.

Shelves are ``<details>``, which browsers open and close without JavaScript.

Pages below another page are listed beside that page and them alone: on each page they would be a tenth of the site.

The list is made from the titles of the pages only. Sphinx copies the contents of all pages, 10,000 documented names, for every page that it
writes, and drops all but the titles. Two thirds of the time of writing went there.
"""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

SHELF = re.compile(
    r'<p class="caption" role="heading"><span class="caption-text">(?P<title>.*?)</span></p>\s*(?P<pages><ul.*?</ul>)(?=\s*(?:<p |$))',
    re.DOTALL,
)
"""A caption and the pages below it, up to the next caption."""


def shelved(tree: str) -> str:
    """Return the list of pages with its shelves; on a page that is on none, as the first page is, the first is open."""
    first = "" if 'class="current' in tree else " open"

    def shelf(match: re.Match[str]) -> str:
        nonlocal first
        is_open = " open" if 'class="current' in match["pages"] else first
        first = ""
        return f'<details class="shelf"{is_open}><summary>{match["title"]}</summary>{match["pages"]}</details>'

    return SHELF.sub(shelf, tree)


def without_sections(contents: nodes.Element) -> nodes.Element:
    """Return a page's contents with its title and the lists of pages below it."""
    result = contents.deepcopy()
    for item in result:
        if len(item) > 1:
            lists = list(item.findall(addnodes.toctree))
            if lists:
                item[1][:] = lists
            else:
                item.pop(1)
    return result


class Titles:
    """Contents of all pages without their sections."""

    def __init__(self) -> None:
        self.contents: dict[str, nodes.Element] = {}

    def collect(self, app: Sphinx, builder: Any) -> None:
        """Collect them once, before writers fork from this process."""
        self.contents = {name: without_sections(contents) for name, contents in app.env.tocs.items()}

    def use(self, app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: Any) -> None:
        """Let the list beside a page read them instead of the contents."""
        complete = context.get("toctree")
        if complete is None:
            return

        def toctree(**options: Any) -> str:
            contents, app.env.tocs = app.env.tocs, self.contents
            try:
                return complete(**{**options, "collapse": True})
            finally:
                app.env.tocs = contents

        context["toctree"] = toctree


def fold(app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: Any) -> None:
    """Fold the list that the theme has made."""
    context["furo_navigation_tree"] = shelved(context["furo_navigation_tree"])


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect before and after the theme, which connects with priority 500."""
    titles = Titles()
    app.connect("write-started", titles.collect)
    app.connect("html-page-context", titles.use, priority=400)
    app.connect("html-page-context", fold, priority=600)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
