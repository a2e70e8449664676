"""Pages of the reference: one for each folder of the package, with its modules as sections.

The theme writes the list of all pages beside every page: with a page for each of 600 modules it costs the square of their number.
The source of each module is copied as text; its section links to it.
"""

from __future__ import annotations

import importlib
import shutil
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

DOCS = Path(__file__).resolve().parents[1]
SOURCE = DOCS.parent / "src" / "seaglint"
GENERATED = DOCS / "api" / "generated"
TEXTS = "source"
"""Folder of the built site with the sources."""


def module_name(path: Path) -> str:
    """Return the dotted name of a file of the package."""
    parts = path.relative_to(SOURCE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def reference_pages() -> dict[str, list[Path]]:
    """Return the files of each page: a folder with its modules, or a module beside the rooms."""
    result = {}
    for first in sorted(SOURCE.rglob("__init__.py")):
        files = sorted(path for path in first.parent.glob("*.py") if path != first)
        result |= {module_name(path): [path] for path in files} if first.parent == SOURCE else {module_name(first): [first, *files]}
    return result


def text_path(path: Path) -> str:
    """Return where the built site holds a source; browsers show a file that ends with txt."""
    return f"{TEXTS}/{path.relative_to(SOURCE.parent).as_posix()}.txt"


def section(path: Path) -> list[str]:
    """Return the source's address and the documented members of a file."""
    shown = path.relative_to(SOURCE.parents[1]).as_posix()
    return [f"`{shown} <../../{text_path(path)}>`__", "", f".. automodule:: {module_name(path)}", "   :members:", ""]


def summary(title: str, names: list[str], *options: str) -> list[str]:
    """Return a titled table of modules with the first sentence of each."""
    if not names:
        return []
    indented = [f"   {line}" for line in (*options, "", *names)]
    return [f".. rubric:: {title}", "", ".. autosummary::", *(line.rstrip() for line in indented), ""]


def headed(title: str, line: str) -> list[str]:
    """Return a title with the line below it."""
    return [title, line * len(title), ""]


def page(name: str, files: list[Path], below: list[str]) -> str:
    """Return a page with a summary of the folders below, a summary of the modules and a section for each module."""
    first, *modules = files
    lines = [":tocdepth: 3", "", *headed(name.removeprefix("seaglint."), "="), *section(first)]
    lines += summary("Folders", [other.rpartition(".")[2] for other in below], ":toctree:")
    lines += summary("Modules", [path.stem for path in modules])
    for path in modules:
        lines += [*headed(path.stem, "-"), *section(path)]
    return "\n".join(lines)


def page_texts(pages: dict[str, list[Path]]) -> dict[str, str]:
    """Return the text of each page."""
    return {name: page(name, files, [other for other in pages if other.rpartition(".")[0] == name]) for name, files in pages.items()}


def import_modules(pages: dict[str, list[Path]]) -> None:
    """Import each module once, before readers fork from this process."""
    for path in (path for files in pages.values() for path in files):
        with suppress(Exception):  # autodoc names every module that cannot be imported
            importlib.import_module(module_name(path))


def write_pages(app: Sphinx) -> None:
    """Write the pages that changed and remove the pages of folders that are gone."""
    pages = reference_pages()
    import_modules(pages)
    GENERATED.mkdir(exist_ok=True)
    for old in GENERATED.iterdir():
        if old.stem not in pages:
            old.unlink()
    for name, text in page_texts(pages).items():
        target = GENERATED / f"{name}.rst"
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")


def copy_texts(site: Path) -> None:
    """Copy the sources into the built site and remove those of an earlier build."""
    shutil.rmtree(site / TEXTS, ignore_errors=True)
    for path in (path for files in reference_pages().values() for path in files):
        target = site / text_path(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)


def finish(app: Sphinx, exception: Exception | None) -> None:
    """Copy the sources after a build of HTML."""
    if exception is None and app.builder.format == "html":
        copy_texts(Path(app.outdir))


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect before pages are looked for."""
    app.connect("builder-inited", write_pages)
    app.connect("build-finished", finish)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
