"""Check the built site without a browser: links, requests to other hosts, formulas, pictures, headings, size.

    python tools/check_site.py docs/_build/html

``./run docs`` calls it. Each fault is a line ``page: fault``; the last line is the number of pages and their size.
"""

from __future__ import annotations

import argparse
import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

MOST_PAGES = 250
MOST_BYTES = 20_000_000
LOADED = {
    "img": "src",
    "script": "src",
    "iframe": "src",
    "source": "src",
    "video": "poster",
    "audio": "src",
    "embed": "src",
    "object": "data",
}
"""Elements that make a browser load what an attribute names, whatever the reader does."""
LINKS_LOADED = {"stylesheet", "icon", "shortcut icon", "prefetch", "preload", "preconnect", "dns-prefetch"}
EMPTY = {"area", "base", "br", "col", "embed", "hr", "img", "input", "link", "meta", "source", "track", "wbr"}
"""Elements without an end."""
STYLE_LOADS = re.compile(r"""url\(\s*['"]?((?:https?:)?//[^)'"\s]+)|@import\s+['"]((?:https?:)?//[^'"]+)""")
GENERATED = {"search.html", "genindex.html", "py-modindex.html"}
"""Pages of Sphinx's own, whose headings follow its templates."""


class Page(HTMLParser):
    """What a page links to and loads, its anchors, headings, formulas and pictures."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loaded: list[str] = []
        self.anchors: set[str] = set()
        self.headings: list[int] = []
        self.pictures_without_words: list[str] = []
        self.formulas_without_mathml: list[str] = []
        self._open: list[tuple[str, bool]] = []
        self._formula: list[str] | None = None
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what an element names."""
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if given.get(name)}
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        if LOADED.get(tag) in given:
            self.loaded.append(given[LOADED[tag]])
        if tag == "link" and given.get("rel") in LINKS_LOADED:
            self.loaded.append(given["href"])
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))
        if tag == "img" and not given.get("alt"):
            self.pictures_without_words.append(given.get("src", ""))
        if tag == "math":
            self._formula = None
        is_formula = "math" in given.get("class", "").split()
        if is_formula:
            self._formula = []
        if tag not in EMPTY:
            self._open.append((tag, is_formula))

    def handle_endtag(self, tag: str) -> None:
        """Judge a formula where it ends."""
        while self._open:
            name, is_formula = self._open.pop()
            if is_formula and self._formula is not None:
                self.formulas_without_mathml.append("".join(self._formula).strip())
                self._formula = None
            if name == tag:
                return

    def handle_data(self, data: str) -> None:
        """Collect the text of a formula."""
        if self._formula is not None:
            self._formula.append(data)

    def skipped_headings(self) -> list[str]:
        """Return headings that are more than a level below the heading before them; a page begins with its only first one."""
        steps = [
            f"h{after} after h{before}" for before, after in zip([0, *self.headings], self.headings, strict=False) if after > before + 1
        ]
        return steps + (["no h1"] if 1 not in self.headings else []) + (["several h1"] if self.headings.count(1) > 1 else [])


def outside(address: str) -> bool:
    """Whether an address is on another host."""
    parts = urlsplit(address)
    return bool(parts.netloc) or parts.scheme in ("http", "https", "ftp", "ws", "wss")


def broken(address: str, page: Path, pages: dict[Path, Page]) -> bool:
    """Whether an address within the site leads to no file, or to no anchor of a page."""
    parts = urlsplit(address)
    if outside(address) or parts.scheme:
        return False
    target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
    if not target.is_file():
        return True
    return bool(parts.fragment) and target in pages and unquote(parts.fragment) not in pages[target].anchors


def faults_of(path: Path, pages: dict[Path, Page], *, generated: bool) -> list[str]:
    """Return the faults of a page."""
    page = pages[path]
    result = [f"link to {address}, which is not there" for address in (*page.links, *page.loaded) if broken(address, path, pages)]
    result += [f"request to another host: {address}" for address in page.loaded if outside(address)]
    result += [f"formula without MathML: {text}" for text in page.formulas_without_mathml]
    result += [f"picture without words: {address}" for address in page.pictures_without_words]
    return result + ([] if generated else [f"headings: {step}" for step in page.skipped_headings()])


def site_files(site: Path) -> list[Path]:
    """Return the files of a site, without Sphinx's own store of parsed pages."""
    return sorted(path for path in site.rglob("*") if path.is_file() and ".doctrees" not in path.parts)


def faults(site: Path) -> list[str]:
    """Return the faults of a site, a line each."""
    site = site.resolve()
    files = site_files(site)
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in files if path.suffix == ".html"}
    result = []
    for path in pages:
        name = path.relative_to(site).as_posix()
        result += [f"{name}: {fault}" for fault in dict.fromkeys(faults_of(path, pages, generated=name in GENERATED))]
    for path in (path for path in files if path.suffix == ".css"):
        found = STYLE_LOADS.findall(path.read_text(encoding="utf-8"))
        result += [f"{path.relative_to(site).as_posix()}: request to another host: {first or second}" for first, second in found]
    size = sum(path.stat().st_size for path in files)
    if len(pages) > MOST_PAGES:
        result.append(f"{len(pages)} pages, more than {MOST_PAGES}")
    if size > MOST_BYTES:
        result.append(f"{size / 1e6:.1f} MB, more than {MOST_BYTES / 1e6:g}")
    return result


def main() -> int:
    """Print the faults of a site, its number of pages and its size."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("site", type=Path, help="folder of the built site")
    site = parser.parse_args().site
    found = faults(site)
    print(*found, sep="\n", end="\n" if found else "")
    files = site_files(site)
    count = sum(path.suffix == ".html" for path in files)
    print(f"{site}: {count} pages, {sum(path.stat().st_size for path in files) / 1e6:.1f} MB, {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
