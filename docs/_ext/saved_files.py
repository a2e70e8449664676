"""Files that a page tells its reader to save: each below the line ``File `NAME`:``, offered for download in the built site.

The page holds the only copy: the build writes ``PAGE/NAME`` beside the page and makes the line a link to it.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from run_docs import blocks

if TYPE_CHECKING:
    from sphinx.application import Sphinx

CAPTION = re.compile(r"^File `(?P<name>[^`\n]+)`:$(?=\n\n(?:```|~~~))", re.MULTILINE)


def offered(text: str, page: str) -> str:
    """Return a page whose captions are links that save the file."""
    folder = page.rpartition("/")[2]
    return CAPTION.sub(
        rf'File <a class="saved" href="{folder}/\g<name>" download><code>\g<name></code></a> (save it under this name):', text
    )


def read(app: Sphinx, name: str, source: list[str]) -> None:
    """Change a page of Markdown before it is parsed."""
    if str(app.env.doc2path(name)).endswith(".md"):
        source[0] = offered(source[0], name)


def write_files(pages: dict[str, Path], site: Path) -> list[Path]:
    """Write the files of pages into the site; return their paths."""
    result = []
    for name, path in pages.items():
        for block in blocks(path.read_text(encoding="utf-8")):
            if block.file:
                target = site / name / block.file
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_text(block.body, encoding="utf-8")
                result.append(target)
    return result


def finish(app: Sphinx, exception: Exception | None) -> None:
    """Write the files after a build of HTML."""
    if exception is None and app.builder.format == "html":
        paths = {name: Path(app.env.doc2path(name)) for name in app.env.found_docs}
        write_files({name: path for name, path in paths.items() if path.suffix == ".md"}, Path(app.outdir))


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to the reading of pages and to the end of a build."""
    app.connect("source-read", read)
    app.connect("build-finished", finish)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
