"""Below each picture of ``docs/images``, the command that makes it, with its script for download; ``tools/tables.toml`` lists the commands.

Pictures of the gallery have their script unfolded beside them, and cards lead to pages that have it.
"""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from docutils import nodes
from sphinx import addnodes
from sphinx.transforms import SphinxTransform

import tables

if TYPE_CHECKING:
    from sphinx.application import Sphinx

SCRIPT = re.compile(r"[\w./-]+\.py(?!\w)")
FOLDER = re.compile(r" (?:-o|--keep) \$FOLDER")


@cache
def makers() -> dict[Path, str]:
    """Return the command that makes each picture of ``docs/images``, as ``tools/tables.toml`` has it."""
    images = tables.ROOT / "docs" / "images"
    return {
        path: table.command
        for table in tables.tables().values()
        for place in table.makes
        if "#" not in place
        for path in tables.ROOT.glob(place)
        if images in path.parents
    }


def shown(command: str, path: Path) -> str:
    """Return a command for one of its pictures, without what moves its output into ``docs/images`` and makes it smaller."""
    words = FOLDER.sub("", command.partition(" && ")[0]).split()
    if path.stem in words:
        others = {other.stem for other, maker in makers().items() if maker == command and other != path}
        words = [word for word in words if word not in others]
    return " ".join(words)


def scripts(command: str) -> list[Path]:
    """Return the files of the repository that a command runs; none where it is a command of the program."""
    return [path for name in SCRIPT.findall(command) if (path := tables.ROOT / name).is_file()]


def line(path: Path, page: str) -> nodes.paragraph:
    """Return the line below a picture of a page: command, and scripts to save."""
    command = shown(makers()[path], path)
    result = nodes.paragraph("", "Made by ", nodes.literal("", command), classes=["maker"])
    for number, script in enumerate(scripts(command)):
        target = f"/../{script.relative_to(tables.ROOT)}"
        words = nodes.literal("", script.name)
        result += nodes.Text(", " if number else "; script: ")
        result += addnodes.download_reference("", "", words, reftarget=target, refdoc=page, refdomain="", reftype="download")
    return result


def captioned(block: nodes.Element) -> bool:
    """Whether a paragraph is a caption: emphasis alone."""
    return isinstance(block, nodes.paragraph) and len(block) == 1 and isinstance(block[0], nodes.emphasis)


class Makers(SphinxTransform):
    """Add the line below the paragraph of a picture and its caption."""

    default_priority = 750  # after cards, before the collectors of downloads

    def apply(self, **options: Any) -> None:
        """Add the lines of a page."""
        page = Path(self.env.doc2path(self.env.docname))
        for image in list(self.document.findall(nodes.image)):
            path = (page.parent / image["uri"]).resolve()
            block = image
            while not isinstance(block, nodes.paragraph | nodes.figure) and block.parent is not None:
                block = block.parent
            if path not in makers() or "gallery" in path.parts or not isinstance(block.parent, nodes.section | nodes.document):
                continue
            after = block.parent.index(block) + 1
            if after < len(block.parent) and captioned(block.parent[after]):
                after += 1
            block.parent.insert(after, line(path, self.env.docname))


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the transform."""
    app.add_transform(Makers)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
