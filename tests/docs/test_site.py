"""The site: parts that make it, its check, and the built site in a real Chromium, read from the disk as a visitor without a network does.

What opens the built site follows ``./run docs``; ``SEAGLINT_SITE`` names another folder.
"""

from __future__ import annotations

import os
import re
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote, unquote, urlsplit

import pytest

import inventories
import seaglint
from check_site import faults, site_files

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
SITE = Path(os.environ.get("SEAGLINT_SITE", DOCS / "_build" / "html"))
CHROMIUM = Path("/usr/bin/chromium")
BUILT = SITE / "search.html"

QUESTIONS = {
    "glint corridor": "glossary model",
    "NETD": "guide/sensor",
    "NEDT": "guide/sensor",
    "range": "conventions glossary tutorials/detection-range",
    "render": "guide/tour",
    "install": "guide/tour",
    "licence": "index",
    "refraction": "guide/atmosphere",
    "counts to radiance": "guide/sensor guide/datasets",
    "MODTRAN": "guide/modtran tutorials/modtran-air",
    "false alarm rate": "guide/clutter",
    "COCO": "guide/datasets",
    "buoy": "guide/scenario/sea tutorials/detection-range",
    "horizon": "guide/atmosphere conventions",
    "apparent temperature": "glossary",
    "detection range": "tutorials/detection-range",
    "wind": "guide/scenario/wind",
    "swell": "guide/scenario/sea",
    "MTF": "guide/sensor",
    "noise": "sensor",
    "mesh": "guide/objects",
    "ship": "guide/objects",
    "night": "guide/scenario/sun",
    "cluster": "guide/cluster tutorials/cluster-run",
    "video": "guide/output",
    "cite": "how-do-i",
    "units": "conventions",
    "LOWTRAN7": "guide/atmosphere",
    "clouds": "limits",
    "threshold": "guide/viewer",
    "how accurate": "validation-plots",
    "training data": "tutorials/training-set",
    "GPU": "performance",
    "download": "index",
    "python": "guide/python",
    "viewer": "guide/viewer",
    "scenario": "guide/scenario",
    "limits": "limits",
    "wave height": "guide/scenario/sea",
    "field of view": "guide/scenario/sensor",
    "spectral response": "guide/scenario/band",
    "seed": "guide/scenario/render",
    "Celsius": "conventions guide/viewer",
    "cost": "index",
    "Cox and Munk": "model",
    "noise equivalent temperature difference": "guide/sensor",
    "MWIR": "guide/scenario/band",
    "polarization": "limits",
    "ERA5": "guide/weather",
    "speed": "performance",
    "quickstart": "guide/tour",
    "integration time": "guide/scenario/sensor guide/sensor",
    "frame rate": "guide/scenario/sensor",
    "dark current": "guide/sensor",
    "keyboard shortcuts": "guide/viewer",
    "sunrise": "guide/scenario/sun",
    "radiance": "glossary",
    "wind speed limit": "limits",
    "Windows": "index",
    "sunglint": "model",
    "pip install seaglint": "guide/tour index",
    "how long does it take": "performance",
    "machine learning": "guide/datasets",
}
"""Pages that must be among the first three results."""
FUNCTIONS = ("render", "mean", "detect", "ensemble", "dataset", "analyze", "load")
FIRST = 3
MOST_SECONDS = 0.3
MOST_BYTES = 500_000
PHONE = 736
"""Pages narrower than this show wide tables as lists."""
CUT_TABLES = "[...document.querySelectorAll('article table')].filter(t => t.scrollWidth > t.parentElement.clientWidth).length"


# what makes the site


def test_formulas_become_mathml() -> None:
    pytest.importorskip("latex2mathml", reason="latex2mathml is not installed")
    from mathml import mathml

    assert mathml(r"\frac{1}{2}", "inline").startswith('<math xmlns="http://www.w3.org/1998/Math/MathML" display="inline"><mrow><mfrac>')
    assert mathml(r"a &= b \\ c &= d", "block").count("<mtr>") == 2
    with pytest.raises(ValueError, match="not known"):
        mathml(r"\unheardof x", "inline")


def formulas() -> list[str]:
    """Formulas of the pages and of docstrings."""
    result = []
    for page in (path for path in DOCS.rglob("*.md") if "_build" not in path.parts):
        text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
        result += [block or line for block, line in re.findall(r"\$\$(.+?)\$\$|(?<![\\$])\$([^\s$](?:[^$\n]*[^\s$])?)\$", text, re.DOTALL)]
    for module in (ROOT / "src").rglob("*.py"):
        result += re.findall(r":math:`([^`]+)`", module.read_text(encoding="utf-8"))
    return result


def test_all_formulas_can_be_converted() -> None:
    pytest.importorskip("latex2mathml", reason="latex2mathml is not installed")
    from mathml import mathml

    every = formulas()
    assert len(every) > 300
    for formula in every:
        assert mathml(formula, "inline").endswith("</math>")


def test_captions_become_shelves() -> None:
    pytest.importorskip("sphinx", reason="Sphinx is not installed")
    from sidebar import shelved

    def caption(title: str, pages: str, kind: str = "") -> str:
        return f'<p class="caption" role="heading"><span class="caption-text">{title}</span></p>\n<ul{kind}>\n{pages}\n</ul>\n'

    nested = '<li class="toctree-l1"><a>b</a><ul><li>c</li></ul></li>'
    tree = caption("One", "<li>a</li>") + caption("Two", nested)
    assert shelved(tree).count("<details") == 2
    assert '<details class="shelf" open><summary>One</summary><ul>\n<li>a</li>\n</ul></details>' in shelved(tree)
    assert f'<details class="shelf"><summary>Two</summary><ul>\n{nested}\n</ul></details>' in shelved(tree)
    current = shelved(caption("One", "<li>a</li>") + caption("Two", nested, ' class="current"'))
    assert re.findall(r'<details class="shelf"( open)?>', current) == ["", " open"]


def test_there_are_four_shelves() -> None:
    from plain_pages import TOCTREE

    tree = TOCTREE.search((DOCS / "index.md").read_text(encoding="utf-8"))
    assert tree is not None
    assert len(re.findall(r"^\*\*.*?\*\*: ", tree["body"], re.MULTILINE)) == 4


def test_a_picture_that_leads_to_a_video_shows_it() -> None:
    from plain_pages import built

    text = built('<!-- video -->\n[![The "sea"](a.jpg)](a.mp4)\n')
    assert text.startswith('<video controls muted loop playsinline preload="metadata" poster="a.jpg" aria-label="The &quot;sea&quot;">')
    assert '<source src="a.mp4" type="video/mp4">' in text


def test_what_an_earlier_build_left_is_found(tmp_path: Path) -> None:
    pytest.importorskip("sphinx", reason="Sphinx is not installed")
    from leftovers import leftovers

    held = {"a.html", "guide/b.html", "_images/p.png", "_downloads/1/c.py", "search.html"}
    gone = {"genindex.html", "guide/old.html", "_images/q.png", "_downloads/2/d.py"}
    for name in (*held, *gone, "searchindex.js", "_static/site.css"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    assert {path.relative_to(tmp_path).as_posix() for path in leftovers(tmp_path, held)} == gone


def test_keywords_are_of_pages_and_each_is_short() -> None:
    keywords = tomllib.loads((DOCS / "keywords.toml").read_text(encoding="utf-8"))
    assert [name for name in keywords if not (DOCS / f"{name}.md").exists()] == []
    assert [word for words in keywords.values() for word in words if len(word) > 40 or re.search("[,;!]", word)] == []


def test_the_video_is_small() -> None:
    assert (DOCS / "_static" / "demo.mp4").stat().st_size < 1_500_000
    assert (DOCS / "_static" / "demo.jpg").stat().st_size < 150_000


# the check of the site

GOOD = '<h1 id="a">A</h1><h2>B</h2><a href="#a">x</a><a href="b.html#c">y</a><a href="https://example.org/">z</a><img src="p.png" alt="p">'


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        (GOOD, ""),
        (GOOD + '<span class="math"><math><mi>x</mi></math></span>', ""),
        (GOOD + '<a href="gone.html">x</a>', "link to gone.html, which is not there"),
        (GOOD + '<a href="b.html#gone">x</a>', "link to b.html#gone, which is not there"),
        (GOOD + '<img src="gone.png" alt="p">', "link to gone.png, which is not there"),
        (GOOD + '<script src="https://cdn.example.org/m.js"></script>', "request to another host: https://cdn.example.org/m.js"),
        (GOOD + '<link rel="stylesheet" href="//example.org/a.css">', "request to another host: //example.org/a.css"),
        (GOOD + '<div class="math">\\[x\\]</div>', "formula without MathML: \\[x\\]"),
        (GOOD + '<img src="p.png">', "picture without words: p.png"),
        (GOOD + "<h4>D</h4>", "headings: h4 after h2"),
        (GOOD + "<h1>D</h1>", "headings: several h1"),
        ("<h2>B</h2>", "headings: h2 after h0"),
    ],
)
def test_faults_are_found(tmp_path: Path, text: str, fault: str) -> None:
    (tmp_path / "b.html").write_text('<h1 id="c">C</h1>')
    (tmp_path / "p.png").touch()
    (tmp_path / "a.html").write_text(text)
    found = faults(tmp_path)
    assert found[:1] == ([f"a.html: {fault}"] if fault else [])


def test_a_style_that_loads_from_elsewhere_is_found(tmp_path: Path) -> None:
    (tmp_path / "a.css").write_text("@import 'https://example.org/b.css'; p { background: url(c.png) } q { src: url('//example.org/f') }")
    assert faults(tmp_path) == [
        f"a.css: request to another host: {address}" for address in ("https://example.org/b.css", "//example.org/f")
    ]


# the built site


def pages_of_site() -> list[Path]:
    """Pages of the built site."""
    return [path for path in site_files(SITE) if path.suffix == ".html"]


@pytest.mark.validation
@pytest.mark.skipif(not BUILT.exists(), reason="the site is not built; ./run docs builds it")
def test_the_built_site_has_no_faults() -> None:
    assert faults(SITE) == []


@pytest.mark.validation
@pytest.mark.skipif(not BUILT.exists(), reason="the site is not built; ./run docs builds it")
def test_each_public_name_is_on_one_page_of_the_reference() -> None:
    text = {path: path.read_text(encoding="utf-8") for path in (SITE / "api" / "generated").glob("*.html")}
    places = Counter(name for page in text.values() for name in re.findall(r'<dt[^>]* id="(sg\.[\w.]+)"', page))
    headings = Counter(name for page in text.values() for name in re.findall(r"<h1>(sg\.\w+)<", page))
    groups = {name: getattr(getattr(seaglint, name), "__all__", None) for name in seaglint.__all__ if name != "__version__"}
    assert headings == Counter(f"sg.{name}" for name in groups)
    assert places == Counter(f"sg.{name}.{each}" if each else f"sg.{name}" for name, inner in groups.items() for each in inner or [""])


@pytest.mark.validation
@pytest.mark.skipif(not BUILT.exists(), reason="the site is not built; ./run docs builds it")
def test_each_name_of_the_inventories_is_used() -> None:
    pages = "".join(path.read_text(encoding="utf-8") for path in pages_of_site())
    assert [name for places in inventories.NAMES.values() for name, place in places.items() if f'/{place}"' not in pages] == []


@pytest.fixture(scope="module")
def chromium() -> Iterator:
    playwright = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
    if not CHROMIUM.exists():
        pytest.skip(f"no {CHROMIUM}")
    if not BUILT.exists():
        pytest.skip("the site is not built; ./run docs builds it")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=str(CHROMIUM), args=["--no-sandbox", "--headless=new"])
        yield browser
        browser.close()


def results(page, question: str) -> list[str]:
    """Pages of the results of a search, in their order, each once."""
    page.goto(f"{BUILT.as_uri()}?q={quote(question)}")
    page.wait_for_function("document.querySelector('.search-summary')?.innerText", timeout=60_000)
    links = page.eval_on_selector_all("ul.search a", "links => links.map(link => link.getAttribute('href'))")
    return list(dict.fromkeys(unquote(urlsplit(link).path).removesuffix(".html") for link in links))


@pytest.mark.validation
def test_questions_find_their_pages(chromium) -> None:
    page = chromium.new_page()
    requests: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    missed = {}
    for question, expected in QUESTIONS.items():
        requests.clear()
        found = results(page, question)
        if not set(expected.split()) & set(found[:FIRST]):
            missed[question] = found[:FIRST]
        assert {urlsplit(url).scheme for url in requests} <= {"file", "data"}
        read = sum(Path(unquote(urlsplit(url).path)).stat().st_size for url in set(requests) if url.startswith("file:"))
        assert read < MOST_BYTES, question
        seconds = page.evaluate(
            "q => {const t = performance.now(); Search._performSearch(...Search._parseQuery(q)); return performance.now() - t}", question
        )
        assert seconds < 1e3 * MOST_SECONDS, question
    assert missed == {}


@pytest.mark.validation
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_public_function_is_the_first_result(chromium, name: str) -> None:
    page = chromium.new_page()
    for question in (f"sg.{name}", f"seaglint.{name}"):
        results(page, question)
        assert page.locator("ul.search a").first.inner_text() in (f"seaglint.{name}", f"sg.{name}"), question


@pytest.mark.validation
@pytest.mark.parametrize("width", [320, 390, 1280])
def test_no_page_overflows_or_asks_the_network(chromium, width: int) -> None:
    page = chromium.new_page(viewport={"width": width, "height": 844})
    requests: list[str] = []
    errors: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))
    wide = []
    for path in pages_of_site():
        page.goto(path.as_uri(), wait_until="load")
        if page.evaluate("document.documentElement.scrollWidth") > width or (width < PHONE and page.evaluate(CUT_TABLES)):
            wide.append(path.relative_to(SITE).as_posix())
    assert wide == []
    assert errors == []
    assert {urlsplit(url).scheme for url in requests} <= {"file", "data"}


@pytest.mark.validation
def test_formulas_and_shelves_need_no_script(chromium) -> None:
    page = chromium.new_context(java_script_enabled=False).new_page()
    page.goto((SITE / "model.html").as_uri())
    formula = page.locator("div.math math").first
    assert formula.bounding_box()["height"] > 15.0
    assert page.locator("article p").first.is_visible()
    shelves = page.locator("details.shelf")
    assert shelves.count() == 4
    assert [shelves.nth(n).get_attribute("open") is not None for n in range(4)] == [False, False, False, True]
    first = shelves.first.locator("a").first
    assert not first.is_visible()
    shelves.first.locator("summary").click()
    assert first.is_visible()


@pytest.mark.validation
def test_blocks_are_copied_but_for_what_programs_print(chromium) -> None:
    page = chromium.new_context(permissions=["clipboard-read", "clipboard-write"]).new_page()
    page.goto((SITE / "guide" / "tour.html").as_uri())
    blocks = page.locator("div.highlight > pre").count()
    printed = page.locator("div.highlight-output pre").count()
    assert printed > 0
    assert page.locator("button.copy").count() == blocks - printed
    page.locator("button.copy").first.focus()
    page.keyboard.press("Enter")
    page.wait_for_selector("button.copied", timeout=60_000)


@pytest.mark.validation
def test_sessions_of_python_are_copied_without_prompts(chromium) -> None:
    page = chromium.new_context(permissions=["clipboard-read", "clipboard-write"]).new_page()
    page.goto((SITE / "api" / "generated" / "sg.mean.html").as_uri())
    page.evaluate("navigator.clipboard.writeText = async (text) => { window.copied = text; }")
    page.locator("div.highlight:has(.gp) button.copy").first.evaluate("button => button.click()")
    page.wait_for_selector("button.copied", state="attached", timeout=60_000)
    lines = page.evaluate("window.copied").splitlines()
    assert lines[0] == "import seaglint as sg"
    assert len(lines) == 3
