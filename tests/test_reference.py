"""Pages of the reference: every public name is on one of them, roles lead to public names, and shortcuts of the build change no text."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import re
import zlib
from collections import Counter
from pathlib import Path
from types import ModuleType

import pytest

import inventories
import reference
import seaglint

DOCS = Path(__file__).resolve().parents[1] / "docs"
SOURCE = DOCS.parent / "src" / "seaglint"
TEXTS = reference.page_texts()
PHYSICS = [
    (module, name)
    for modules in reference.physics_pages().values()
    for module, names in modules.items()
    for name in names
    if reference.kind_of(module, name) == "function"
]

ROLE = re.compile(r":(?:func|data|meth|mod|class|attr|obj|exc):`(?:[^`<]*<)?~?([\w.]+)>?`")
EQUATION = re.compile(r":math:|\.\. math::|\S = \S")
SOURCE_OF = re.compile(
    r"\b[A-Z][\w'-]+(?:,? (?:and|et|al\.|\d+|[A-Z][\w.'-]*))*,? \(?(?:18|19|20)\d\d\b|\bEqs?\. [\dA-Z]|^References$", re.MULTILINE
)
"""A source: a name with a year, an equation by its number, or a list of references."""
EXAMPLES = re.compile(r"^\s*Examples\n\s*-+\n.*", re.MULTILINE | re.DOTALL)


def extension(name: str) -> ModuleType:
    """An extension of the documentation."""
    spec = importlib.util.spec_from_file_location(name, DOCS / "_ext" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


plain_pages = extension("plain_pages")
INDEX = plain_pages.built((DOCS / "api" / "index.md").read_text(encoding="utf-8"))


def test_each_public_name_is_on_one_page() -> None:
    titles = Counter(match for text in TEXTS.values() for match in re.findall(r"^sg\.\w+$", text, re.MULTILINE))
    assert titles == Counter(f"sg.{name}" for name in seaglint.__all__ if name != "__version__")


def test_each_function_of_a_group_is_shown_once() -> None:
    shown = Counter(match for text in TEXTS.values() for match in re.findall(r"^\.\. autofunction:: (sg\.\S+)$", text, re.MULTILINE))
    groups = reference.functions()
    assert shown == Counter(f"sg.{name}.{each}" if each else f"sg.{name}" for name, inner in groups.items() for each in inner or [""])


def test_each_page_is_in_a_list_of_pages() -> None:
    assert re.findall(r"^generated/(\S+)$", INDEX, re.MULTILINE) == list(TEXTS)


def test_there_are_few_pages() -> None:
    assert len(TEXTS) < 80, "every page carries the list of all pages"


@pytest.mark.parametrize(("module", "name"), PHYSICS, ids=lambda part: part)
def test_physics_states_an_equation_or_a_source(module: str, name: str) -> None:
    texts = [EXAMPLES.sub("", text or "") for text in (importlib.import_module(module).__doc__, reference.docstring_in(module, name))]
    assert any(form.search(text) for form in (EQUATION, SOURCE_OF) for text in texts), (
        "give the equation or the source in the docstring, or leave the name out of docs/api/public.toml"
    )


@pytest.mark.parametrize(
    ("text", "known"),
    [
        ("Return a gain.\n\n    g = n / f\n", True),
        ("Return the gain ``g = n / f``.", True),
        ("Return the slope of Cox and Munk 1954.", True),
        ("Return the number 5 (Eq. 37).", True),
        ("Return the mean with overwrite=False, as of False in 2024.", False),
        ("Return the reach.\n\nExamples\n--------\n>>> a = reach(2)\n", False),
    ],
)
def test_equations_and_sources_are_recognised(text: str, known: bool) -> None:
    assert any(form.search(EXAMPLES.sub("", text)) for form in (EQUATION, SOURCE_OF)) == known


@pytest.mark.parametrize("name", reference.public()["functions"])
def test_pictures_and_guides_exist(name: str) -> None:
    shown = reference.public()["functions"][name]
    assert name in reference.functions()
    assert all((DOCS / f"{guide}.md").is_file() for guide in shown["guides"])
    assert "picture" not in shown or (DOCS / "images" / shown["picture"]).is_file()


FUNCTIONS = [f"sg.{group}.{name}" if name else f"sg.{group}" for group, inner in reference.functions().items() for name in inner or [""]]
UNTESTED = {
    "sg.atmosphere.read": "needs MODTRAN's files",
    "sg.reproduce.fig5": "takes a minute",
    "sg.reproduce.fig10": "takes minutes",
    "sg.reproduce.table1": "takes minutes",
}
"""Functions whose example no test runs; test_architecture.py runs the others."""
WIDEST = 88
"""Columns of a line of an example that a page of 1280 pixels shows."""


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_has_parameters_results_errors_and_an_example(name: str) -> None:
    text = reference.docstring_of(name)
    called = re.escape(reference.full_name(name))
    assert re.search(rf"^(>>>|\.\.\.) .*\b{called}\(", text, re.MULTILINE), "the example calls the function"
    assert ("doctest: +SKIP" in text) == (name in UNTESTED)
    assert "Returns\n-------" in text
    given = set(
        re.findall(r"^(\S+|\{request\})(?: :.*)?$", text.partition("Parameters\n----------\n")[2].partition("Returns\n")[0], re.MULTILINE)
    )
    assert "Raises\n------" in text or given <= {"progress"}


@pytest.mark.parametrize(
    ("module", "name"), [(module, name) for module, names in reference.shown() for name in names], ids=lambda part: part
)
def test_lines_of_examples_are_not_cut(module: str, name: str) -> None:
    text = (reference.SOURCE.parent / Path(*module.split("."))).with_suffix(".py").read_text(encoding="utf-8")
    node = next(node for node in ast.parse(text).body if getattr(node, "name", "") == name)
    docstrings = [ast.get_docstring(part) or "" for part in ast.walk(node) if isinstance(part, ast.ClassDef | ast.FunctionDef)]
    assert [line for each in docstrings for line in examples_in(each) if len(line) > WIDEST] == []


@pytest.mark.parametrize("name", FUNCTIONS)
def test_lines_of_examples_of_functions_are_not_cut(name: str) -> None:
    assert [line for line in examples_in(reference.docstring_of(name)) if len(line) > WIDEST] == []


def examples_in(docstring: str) -> list[str]:
    """Lines of the examples of a docstring."""
    return re.findall(r"^\s*(?:>>>|\.\.\.).*", docstring, re.MULTILINE)


def roles_of(path: Path) -> list[tuple[int, str, list[str]]]:
    """Lines and targets of the roles of a file, with the names that each may stand for."""
    text = path.read_text(encoding="utf-8")
    module = ".".join(path.relative_to(SOURCE.parent).with_suffix("").parts).removesuffix(".__init__")
    places = [module, *(place for name, place in reference.api_modules().items() if name == module)]
    spans = [(node.lineno, node.end_lineno or 0, node.name) for node in ast.parse(text).body if isinstance(node, ast.ClassDef)]
    result = []
    for match in ROLE.finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        inner = [f"{place}.{name}.{match[1]}" for place in places for first, last, name in spans if first <= line <= last]
        result.append((line, match[1], [match[1], *(f"{place}.{match[1]}" for place in places), *inner]))
    return result


def test_roles_lead_to_public_names() -> None:
    wrong = [
        f"{path.relative_to(SOURCE)}:{line} {target}"
        for path in sorted(SOURCE.rglob("*.py"))
        for line, target, candidates in roles_of(path)
        if not target.startswith(("numpy.", "xarray.", "scipy.", "pydantic.")) and not any(name in reference.names() for name in candidates)
    ]
    assert wrong == [], "internals have no page: write their names as ``name``"


def test_inventories_hold_the_names_that_are_listed() -> None:
    for project, places in inventories.NAMES.items():
        file = (inventories.FOLDER / f"{project}.inv").read_bytes()
        assert zlib.decompress(file.split(b"\n", 4)[4])
        assert inventories.places_in(file) == places, "run python tools/inventories.py"


@pytest.mark.parametrize(("name", "known"), [("collections.abc.Mapping", True), ("collections.abc.Unheard", False)])
def test_a_name_that_is_not_known_stops_the_build(tmp_path: Path, name: str, known: bool) -> None:
    build = pytest.importorskip("sphinx.cmd.build").build_main
    mapping = {project: (f"https://example.org/{project}", str(inventories.FOLDER / f"{project}.inv")) for project in inventories.NAMES}
    settings = f"extensions = ['sphinx.ext.intersphinx']\nnitpicky = True\nintersphinx_mapping = {mapping}\n"
    (tmp_path / "conf.py").write_text(settings, encoding="utf-8")
    (tmp_path / "index.rst").write_text(f"Page\n====\n\n:py:class:`{name}`\n", encoding="utf-8")
    assert "nitpicky = True" in (DOCS / "conf.py").read_text(encoding="utf-8")
    assert (build(["-q", "-W", "--keep-going", "-b", "html", str(tmp_path), str(tmp_path / "out")]) == 0) == known


def test_a_name_of_the_package_leads_to_what_users_write() -> None:
    assert reference.target_of("seaglint.api.export") == reference.target_of("seaglint.export") == "sg.export"
    assert reference.target_of("seaglint.api.texture_models.fit") == "sg.texture.fit"
    assert reference.target_of("seaglint.optics.fresnel.reflectance") == "seaglint.optics.fresnel.reflectance"
    assert reference.target_of("seaglint.base.jit.kernel") is None


def test_first_sentences_have_no_roles() -> None:
    text = "Return the gain, as :func:`~seaglint.a.b` and :data:`LIMIT`. Other words.\n\nMore."
    assert reference.first_sentence(text) == "Return the gain, as ``b`` and ``LIMIT``."


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
    assert "<details><summary>docs/gallery/a.py</summary>" in script
    assert "{literalinclude} a.py" in script
    lists = plain_pages.built("<!-- toctree -->\n## All\n\n**One**: [a](a.md), [b](x/b-c.md)\n\n**Two**: [d](d.md)\n<!-- end toctree -->\n")
    assert lists.count("{toctree}") == 2
    assert ":caption: One\n:hidden:\n\na\nx/b-c\n```" in lists
    assert ":maxdepth: 1\n\na\n```" in plain_pages.built("<!-- toctree -->\n- [A](a.md)\n<!-- end toctree -->\n")


def test_names_lead_to_their_documentation_outside_of_code() -> None:
    text = "`sg.mean` and [`sg.load`](x), `seaglint mean`, ``sg.mean``, `seaglint.base.jit`\n\n```python\n`sg.mean`\n```\n"
    expected = text.replace("`sg.mean` and", "{py:obj}`sg.mean <sg.mean>` and")
    assert plain_pages.built(text) == expected


def test_every_page_is_in_a_list_of_pages() -> None:
    listed_pages = set()
    for page in DOCS.rglob("*.md"):
        for tree in plain_pages.TOCTREE.finditer(page.read_text(encoding="utf-8")):
            listed_pages |= {(page.parent / f"{name}.md").resolve() for name in plain_pages.PAGE.findall(tree["body"])}
    every = {page.resolve() for page in DOCS.rglob("*.md") if "_build" not in page.parts}
    assert every - listed_pages == {(DOCS / "index.md").resolve()}
    assert listed_pages <= every
