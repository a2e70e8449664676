"""Keywords of pages: entries of the index from ``docs/keywords.toml``, which the search ranks above words of the text.

Pages of functions of ``sg`` have their names with ``seaglint.`` as keywords.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.errors import ConfigError
from sphinx.transforms import SphinxTransform

from reference import functions

KEYWORDS = Path(__file__).resolve().parents[1] / "keywords.toml"


class Keywords(SphinxTransform):
    """Add the keywords of a page as main entries that lead to its title; the search lists other entries after all results."""

    default_priority = 800  # domains collect entries at 850

    def apply(self, **options: Any) -> None:
        """Insert the entries before the text of the page."""
        for node in self.document.findall(addnodes.index):  # the search knows modules as objects
            node["entries"] = [entry for entry in node["entries"] if not entry[1].startswith("module; ")]
        words = self.config.page_keywords.get(self.env.docname, [])
        section = next(self.document.findall(nodes.section), None)
        if words and section is not None:
            section.insert(1, addnodes.index(entries=[("single", word, section["ids"][0], "main", None) for word in words]))


def check(app: Sphinx, env: Any, names: list[str]) -> None:
    """Refuse keywords of a page that does not exist."""
    if unknown := sorted(set(app.config.page_keywords) - env.found_docs):
        raise ConfigError(f"docs/keywords.toml: no page {', '.join(unknown)}; name a page below docs without its ending")


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the keywords as a setting, so that a change reads pages anew."""
    words = {f"api/generated/sg.{name}": [f"seaglint.{name}"] for name in functions()}
    words |= tomllib.loads(KEYWORDS.read_text(encoding="utf-8"))
    app.add_config_value("page_keywords", words, "env", frozenset({dict}))
    app.add_transform(Keywords)
    app.connect("env-before-read-docs", check)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
