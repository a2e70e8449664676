"""Pages of the reference: each module is on one of them, each is reachable, and what makes the build short changes no text."""

from __future__ import annotations

import importlib.util
import pkgutil
import posixpath
import re
from collections import Counter
from pathlib import Path
from types import ModuleType

import pytest

import seaglint

DOCS = Path(__file__).resolve().parents[1] / "docs"
MODULES = sorted(info.name for info in pkgutil.walk_packages(seaglint.__path__, "seaglint."))


def extension(name: str) -> ModuleType:
    """An extension of the documentation."""
    spec = importlib.util.spec_from_file_location(name, DOCS / "_ext" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


reference = extension("reference")
plain_pages = extension("plain_pages")
INDEX = plain_pages.built((DOCS / "api" / "index.md").read_text(encoding="utf-8"))
PAGES = reference.reference_pages()
TEXTS = reference.page_texts(PAGES)


def listed(text: str) -> list[str]:
    """Names in the tables of a page that lead to other pages."""
    tables = re.findall(r"\.\. autosummary::\n   :toctree:.*\n\n((?:   \S+\n)+)", text)
    return [name for table in tables for name in table.split()]


def test_each_module_is_on_one_page() -> None:
    shown = Counter(name for text in TEXTS.values() for name in re.findall(r"^\.\. automodule:: (\S+)$", text, re.MULTILINE))
    assert shown == Counter(MODULES)


def test_each_page_is_listed_by_the_page_above_it() -> None:
    below = [f"{name}.{folder}" for name, text in TEXTS.items() for folder in listed(text)]
    assert Counter(listed(INDEX) + below) == Counter(list(PAGES))


def test_there_are_few_pages() -> None:
    assert len(PAGES) < len(MODULES) / 5, "every page carries the list of all pages"


@pytest.mark.parametrize("name", PAGES)
def test_a_module_leads_to_its_source(name: str) -> None:
    links = re.findall(r"`(\S+) <(\S+)>`__", TEXTS[name])
    assert [path for path, _ in links if not (DOCS.parent / path).is_file()] == []
    reached = [posixpath.normpath(posixpath.join("api/generated", link)) for _, link in links]
    assert reached == [reference.text_path(path) for path in PAGES[name]]


def test_sources_are_copied_and_old_ones_removed(tmp_path: Path) -> None:
    left = tmp_path / reference.TEXTS / "seaglint" / "gone.py.txt"
    left.parent.mkdir(parents=True)
    left.touch()
    reference.copy_texts(tmp_path)
    copied = {path.relative_to(tmp_path).as_posix(): path.read_bytes() for path in tmp_path.rglob("*.txt")}
    assert copied == {reference.text_path(path): path.read_bytes() for files in PAGES.values() for path in files}


def documented(height: float) -> float:
    """Return the distance of the horizon [m].

    Parameters
    ----------
    height : float
        Height above the sea [m].

    Returns
    -------
    float
        Distance [m].

    Notes
    -----
    The square root of twice the height times the radius.
    """
    return height


def test_docstrings_are_parsed_as_numpydoc_parses_them() -> None:
    numpydoc = pytest.importorskip("numpydoc.docscrape_sphinx")
    config = {"show_class_members": False}
    expected = str(numpydoc.get_doc_object(documented, what="function", config=dict(config)))
    assert "Height above the sea" in expected
    assert str(extension("numpydoc_once").doc_object(documented, what="function", config=config)) == expected


def test_the_list_beside_a_page_keeps_titles_and_pages_below() -> None:
    nodes = pytest.importorskip("docutils.nodes")
    addnodes = pytest.importorskip("sphinx.addnodes")

    def entry(title: str, *below: object) -> object:
        lists = [nodes.bullet_list("", *below)] if below else []
        return nodes.list_item("", addnodes.compact_paragraph("", title), *lists)

    air = addnodes.toctree(entries=[("", "files.air")])
    contents = nodes.bullet_list("", entry("files", entry("counts", entry("radiance_of")), air), entry("glossary", entry("horizon")))
    titles = extension("sidebar").without_sections(contents)
    assert titles.astext().split() == ["files", "glossary"]
    assert [tree["entries"] for tree in titles.findall(addnodes.toctree)] == [[("", "files.air")]]
    assert "radiance_of" in contents.astext()


def test_links_of_plain_pages_become_copies_and_lists() -> None:
    whole = "<!-- include -->\n[CHANGELOG.md](../CHANGELOG.md)\n"
    assert plain_pages.built(whole) == "```{include} ../CHANGELOG.md\n```\n"
    code = plain_pages.built("<!-- include toml -->\n[a scene](../a.toml)\n")
    assert code == "```{literalinclude} ../a.toml\n:language: toml\n```\n"
    script = plain_pages.built("<!-- include python -->\n[docs/gallery/a.py](a.py)\n")
    assert "{dropdown} docs/gallery/a.py" in script
    assert "{literalinclude} a.py" in script
    lists = plain_pages.built("<!-- toctree -->\n## All\n\n**One**: [a](a.md), [b](x/b-c.md)\n\n**Two**: [d](d.md)\n<!-- end toctree -->\n")
    assert lists.count("{toctree}") == 2
    assert ":caption: One\n:hidden:\n\na\nx/b-c\n```" in lists
    assert ":maxdepth: 1\n\na\n```" in plain_pages.built("<!-- toctree -->\n- [A](a.md)\n<!-- end toctree -->\n")


def test_names_lead_to_their_documentation_outside_of_code() -> None:
    text = "`seaglint.api.mean` and [`seaglint.air`](x), `seaglint mean`, ``seaglint.api``\n\n```python\n`seaglint.api.mean`\n```\n"
    expected = text.replace("`seaglint.api.mean` and", "{py:obj}`seaglint.api.mean` and")
    assert plain_pages.built(text) == expected


def test_every_page_is_in_a_list_of_pages() -> None:
    listed_pages = set()
    for page in DOCS.rglob("*.md"):
        for tree in plain_pages.TOCTREE.finditer(page.read_text(encoding="utf-8")):
            listed_pages |= {(page.parent / f"{name}.md").resolve() for name in plain_pages.PAGE.findall(tree["body"])}
    every = {page.resolve() for page in DOCS.rglob("*.md") if "_build" not in page.parts}
    assert every - listed_pages == {(DOCS / "index.md").resolve()}
    assert listed_pages <= every
