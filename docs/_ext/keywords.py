"""Keywords of pages: entries of the index from ``docs/keywords.toml``, which the search ranks above words of the text."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from sphinx.application import Sphinx
from sphinx.errors import ConfigError

DOCS = Path(__file__).resolve().parents[1]
KEYWORDS: dict[str, list[str]] = tomllib.loads((DOCS / "keywords.toml").read_text(encoding="utf-8"))
TITLE = re.compile(r"^# .*$", re.MULTILINE)


def indexed(text: str, words: list[str]) -> str:
    """Return a page of Markdown with its keywords below the title."""
    entries = ", ".join(f"! {word}" for word in words)  # main entries: the search lists others after all results
    return TITLE.sub(lambda title: f"{title[0]}\n\n```{{index}} {entries}\n```", text, count=1)


def read(app: Sphinx, name: str, source: list[str]) -> None:
    """Add the keywords of a page before it is parsed."""
    if words := KEYWORDS.get(name):
        source[0] = indexed(source[0], words)


def check(app: Sphinx) -> None:
    """Refuse keywords of a page that does not exist."""
    if unknown := sorted(name for name in KEYWORDS if not (DOCS / f"{name}.md").exists()):
        raise ConfigError(f"docs/keywords.toml: no page {', '.join(unknown)}; name a page below docs without its ending")


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to the reading of pages."""
    app.connect("builder-inited", check)
    app.connect("source-read", read)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
