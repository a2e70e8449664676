"""List of pages beside every page, made from the titles of the pages only.

Sphinx copies the contents of all pages, 10,000 documented names, for every page that it writes and then drops all but the titles.
Half of the time of writing went there.
"""

from __future__ import annotations

from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx


def title_of(contents: nodes.Element) -> nodes.Element:
    """Return a page's contents without its sections; the lists of pages below it remain."""
    result = contents.deepcopy()
    for item in result:
        if len(item) > 1:
            lists = list(item.findall(addnodes.toctree))
            if lists:
                item[1][:] = lists
            else:
                item.pop(1)
    return result


def keep_titles(app: Sphinx, builder: Any) -> None:
    """Make the titles once, before writers fork from this process."""
    app.env_titles = {name: title_of(contents) for name, contents in app.env.tocs.items()}


def list_titles(app: Sphinx, pagename: str, templatename: str, context: dict[str, Any], doctree: Any) -> None:
    """Let the page's list of pages read the titles instead of the contents."""
    complete = context.get("toctree")
    if complete is None:
        return

    def toctree(**options: Any) -> str:
        contents, app.env.tocs = app.env.tocs, app.env_titles
        try:
            return complete(**options)
        finally:
            app.env.tocs = contents

    context["toctree"] = toctree


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect before the theme, which connects with priority 500."""
    app.connect("write-started", keep_titles)
    app.connect("html-page-context", list_titles, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
