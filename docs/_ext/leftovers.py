"""Remove from the built site what an earlier build left: pages, pictures and downloads that this build does not hold."""

from __future__ import annotations

from pathlib import Path

from sphinx.application import Sphinx

BY_TEMPLATE = "search.html"
"""The page that no source has."""


def leftovers(site: Path, held: set[str]) -> list[Path]:
    """Return the pages, pictures and downloads of a site whose names, relative to it, are not among those that it holds."""
    folders = ((site, "*.html"), (site / "_images", "*"), (site / "_downloads", "*"))
    files = {path for folder, pattern in folders for path in folder.rglob(pattern) if path.is_file()}
    return sorted(path for path in files if path.relative_to(site).as_posix() not in held)


def remove(app: Sphinx, error: Exception | None) -> None:
    """Remove them, and the folders that they leave empty, after a build of HTML without an error."""
    if error is not None or app.builder.name != "html":
        return
    site = Path(app.outdir)
    pages = {f"{name}.html" for name in app.env.found_docs}
    pictures = {f"_images/{name}" for _, name in app.env.images.values()}
    downloads = {f"_downloads/{name}" for _, name in app.env.dlfiles.values()}
    for path in leftovers(site, pages | pictures | downloads | {BY_TEMPLATE}):
        path.unlink()
        if not any(path.parent.iterdir()):
            path.parent.rmdir()


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to the end of the build."""
    app.connect("build-finished", remove)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
