"""List of pages beside every page, made from the titles of the pages only.

Sphinx copies the contents of all pages, 10,000 documented names, for every page that it writes, and drops all but the titles.
Two thirds of the time of writing went there.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx


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
                return complete(**options)
            finally:
                app.env.tocs = contents

        context["toctree"] = toctree


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect before the theme, which connects with priority 500."""
    titles = Titles()
    app.connect("write-started", titles.collect)
    app.connect("html-page-context", titles.use, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
