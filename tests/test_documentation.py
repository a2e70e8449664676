"""What the pages name exists, what they link to is there, and their code runs or says why not."""

from __future__ import annotations

import importlib
import re
import shlex
import tomllib
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from typer.main import get_command

import page_tables
from run_docs import Block, PageError, alike, blocks, commands, matches, run
from seaglint.cli.app import app

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    ROOT / "SECURITY.md",
    ROOT / "CODE_OF_CONDUCT.md",
    *sorted(
        page
        for folder in (".", "guide", "guide/scenario", "adr", "gallery", "tutorials", "validation", "api")
        for page in (DOCS / folder).glob("*.md")
    ),
]
TUTORIALS = sorted((DOCS / "tutorials").glob("*.md"))
RUN_HERE = ["README.md", "docs/guide/python.md", "docs/guide/radiometer.md", "docs/guide/ensembles.md", "docs/guide/workbench.md"]
"""Pages whose Python the quick suite runs, in a folder with a small scenario."""

FOLLOWED = [*TUTORIALS, DOCS / "guide" / "likelihood.md", DOCS / "guide" / "foam.md"]
"""Pages of which each runs alone, its commands included."""

VISITED = ["README.md", "docs/guide/tour.md"]
"""Pages that a visitor follows in order."""

RUN_LONG = [
    "docs/guide/detection.md",
    "docs/guide/sensor.md",
    "docs/guide/atmosphere.md",
    "docs/guide/weather.md",
    "docs/guide/textures.md",
]
"""The same, with the long comparisons."""

WIDEST = 88
"""Columns of a line of code."""

MOST_BYTES = 2_000_000
"""Of a page with its pictures."""
NAME = re.compile(r"\bseaglint(?:\.[A-Za-z_][A-Za-z_0-9]*)+")
FILE = re.compile(r"(?<![\w/.])(?:tests|tools|benchmarks|examples|docs|src)/[\w./-]+\.(?:py|toml|md|csv|png)\b")

FOREIGN = re.compile(
    r"\bseaglint\[[a-z]"
    r"|\b(?:pip3?\s+install|pipx\s+(?:install|run)|uvx|(?:uv|conda|mamba|poetry)\s+(?:add|install))"
    r"(?:\s+(?!['\"]?\.|#)[^\s`;,]+){0,6}?\s+['\"]?seaglint\b(?!-|[\w./:])"
)
"""A command that has an index look for the name seaglint, or a requirement of it."""

WRITTEN = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")),
    *sorted(
        path
        for folder in ("docs", "src", "examples", "tools", "benchmarks")
        for path in (ROOT / folder).rglob("*")
        if path.suffix in (".md", ".py", ".toml", ".rst", ".txt", ".js", ".html") and "_build" not in path.parts
    ),
]
"""Texts that users read, and the source with its messages."""

SMALL = """
[sensor]
fov_deg = [4, 6]
elevation_deg = -3
pixels = [32, 40]
frames = 10

[sea]
shortest_wave_m = 4.0

[render]
tile_size = 128
layers = ["range"]
"""


def exists(name: str) -> bool:
    """Whether a dotted name is a module or something in one."""
    parts = name.split(".")
    for end in range(len(parts), 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:end]))
        except ModuleNotFoundError:
            continue
        for part in parts[end:]:
            if not hasattr(found, part) and part not in getattr(found, "__annotations__", {}):
                return False
            found = getattr(found, part, None)
        return True
    return False


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_names_and_files_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert [name for name in sorted(set(NAME.findall(text))) if not exists(name)] == []
    assert [name for name in sorted(set(FILE.findall(text))) if not (ROOT / name).exists()] == []


def test_a_name_that_is_gone_is_found() -> None:
    assert not exists("seaglint.imaging.renderer.Renderer")
    assert not exists("seaglint.imaging.sweep.sweep.Frame")
    assert exists("seaglint.imaging.sweep.sweep.Rows")
    assert exists("seaglint.imaging.upright_scene.SweptScene.intervals")


def python_of(page: str, folder: Path) -> None:
    """Run all Python of a page that is not excused."""
    (folder / "my.toml").write_text(SMALL)
    found = [block for block in blocks((ROOT / page).read_text(encoding="utf-8")) if block.kind == "python" and not block.reason]
    assert found
    names: dict[str, object] = {}
    for block in found:
        exec(compile(block.body, page, "exec"), names)


@pytest.mark.parametrize("page", RUN_HERE)
def test_python_on_the_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    python_of(page, tmp_path)


@pytest.mark.validation
@pytest.mark.parametrize("page", RUN_LONG)
def test_longer_python_on_the_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import numpy as np

    np.save(tmp_path / "radiance.npy", np.random.default_rng(0).gamma(3.0, 1.0, (64, 64)))
    monkeypatch.chdir(tmp_path)
    python_of(page, tmp_path)


@pytest.mark.validation
@pytest.mark.parametrize("page", FOLLOWED, ids=lambda p: p.stem)
def test_a_tutorial_runs_and_prints_what_it_shows(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run(page.read_text(encoding="utf-8"), tmp_path)


@pytest.mark.validation
def test_one_visitor_follows_the_readme_and_the_tour(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All blocks of both pages, one after the other in one folder of a checkout; what is shown is what is printed."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    said: dict[str, list[str]] = {}
    readme, tour = ((ROOT / page).read_text(encoding="utf-8") for page in VISITED)
    run(readme, tmp_path, said=said)
    made = {path.name for path in tmp_path.iterdir()} - {"examples"}
    assert {"run.png", "run.mp4", "run.tif", "clutter.html", "mean.png"} <= made
    # the tour is not to depend on what the README made
    assert [name for name in made if any(re.search(rf"(?<![\w.-]){re.escape(name)}\b", block.body) for block in blocks(tour))] == []
    run(tour, tmp_path, said=said)
    assert [line for lines in said.values() for line in lines if "Traceback" in line] == []
    detected = [float(share) for share in re.findall(r"P_d ([0-9.]+) ", "\n".join(said["seaglint detect recording run.zarr"]))]
    assert any(0.1 < share < 0.9 for share in detected)


def asks_to_run(block: Block) -> bool:
    """Whether a reader would type it."""
    return block.kind in ("python", "sh") or (block.kind == "" and bool(re.search(r"^(seaglint|\./run) ", block.body, re.M)))


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_blocks_run_or_say_why_not(page: Path) -> None:
    name = str(page.relative_to(ROOT))
    text = page.read_text(encoding="utf-8")
    runs = set()
    if name in (*RUN_HERE, *RUN_LONG):
        runs = {"python"}
    if page in FOLLOWED or name in VISITED:
        runs = {"python", "sh"}
    silent = [block.body for block in blocks(text) if asks_to_run(block) and block.kind not in runs and not block.reason and not block.file]
    assert silent == [], "put <!-- not run: REASON --> in the line before, or let the page run"
    for block in blocks(text):
        if block.kind == "toml":
            tomllib.loads(block.body)


def command_named(words: list[str]) -> tuple[object, list[str]]:
    """The command that words call, and its arguments."""
    found, rest = get_command(app), words
    while rest and rest[0] in getattr(found, "commands", {}):
        found, rest = found.commands[rest[0]], rest[1:]
    # a group that takes a file in the place of a command
    return (found.bare if rest and rest != ["--help"] and hasattr(found, "bare") else found), rest


def options_of(command: object) -> set[str]:
    """All long and short options."""
    return {name for given in command.params for name in (*given.opts, *given.secondary_opts)} | {"--help"}  # type: ignore[attr-defined]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_commands_and_their_options_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    lines = [line for block in blocks(text) if block.kind == "sh" for line in commands(block)]
    lines += re.findall(r"(?<!`)`(seaglint [a-z][^`]*)`(?!`)", text)
    wrong = []
    for line in lines:
        if not line.startswith("seaglint ") or "|" in line.split("#")[0]:
            continue
        command, rest = command_named(shlex.split(line, comments=True)[1:])
        if getattr(command, "commands", None) and rest and not rest[0].startswith("-"):
            wrong.append(line)
        wrong += [f"{line}: {word}" for word in rest if re.match(r"--?[a-z]", word) and word.split("=")[0] not in options_of(command)]
    assert wrong == []


SHARED = re.compile(
    r"https?://[\w.-]*(?:researchgate|academia\.edu|sci-hub|semanticscholar|scribd|docplayer|vdocuments|fdocuments|paperexplained|libgen|scite\.ai)"
    r"|https?://[^\s)>\"']*/~[^\s)>\"']*\.pdf",
    re.IGNORECASE,
)
"""Addresses of copies of papers on sharing sites and in personal folders."""


def test_papers_are_cited_themselves() -> None:
    wrong = [f"{path.relative_to(ROOT)}: {found[0]}" for path in WRITTEN for found in SHARED.finditer(path.read_text(encoding="utf-8"))]
    assert wrong == [], "cite the paper itself, by author, year and DOI"


def test_a_copy_of_a_paper_is_found() -> None:
    assert SHARED.search("https://www." + "researchgate.net/publication/1")
    assert SHARED.search("http://cs.example.edu/" + "~name/paper.pdf")
    assert not SHARED.search("https://doi.org/10.1117/12.2050433")


def test_an_option_that_is_gone_is_found() -> None:
    command, rest = command_named(["atmosphere", "write", "my.toml", "--fromat", "tape5"])
    assert rest[0] == "my.toml"
    assert "--fromat" not in options_of(command)
    assert "--format" in options_of(command)


@pytest.mark.parametrize(
    ("text", "wrong"),
    [
        ("pip install seaglint", True),
        ("pip install 'seaglint'", True),
        ("pip install --force-reinstall seaglint", True),
        ("uv pip install -U --pre seaglint again", True),
        ("pip install numpy 'seaglint>=0.1'", True),
        ("pip install\n'seaglint[weather]'", True),
        ("needs seaglint[waves]", True),
        ("pipx run seaglint view", True),
        ("pip install '.[viewer]'", False),
        ("run pip install . in the checkout of seaglint", False),
        ("pip install 'nicegui>=3.0', then seaglint view", False),
        ("python -m pip install pybsm; import seaglint", False),
    ],
)
def test_an_install_from_an_index_is_found(text: str, wrong: bool) -> None:
    assert bool(FOREIGN.search(text)) is wrong


def test_no_text_installs_seaglint_from_an_index() -> None:
    """Until its first release no index has it: whoever registers the name there would have users install another program."""
    assert len(WRITTEN) > 500
    wrong = [f"{path.relative_to(ROOT)}: {found[0]!r}" for path in WRITTEN for found in FOREIGN.finditer(path.read_text(encoding="utf-8"))]
    assert wrong == [], "name the checkout, pip install '.[viewer]', or the missing package itself, until a release is in an index"


def without_code(text: str) -> str:
    """A page without its blocks and inline code."""
    for block in reversed(blocks(text)):
        text = text[: block.span[0]] + text[block.span[1] :]
    return re.sub(r"`[^`\n]*`", "", text)


def anchors(page: Path) -> set[str]:
    """Names of a page's headings and labels."""
    text = page.read_text(encoding="utf-8")
    headings = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE), re.MULTILINE)
    made = {re.sub(r"[^\w\- ]", "", re.sub(r"[`*]|\]\([^)]*\)|\[", "", heading)).strip().lower().replace(" ", "-") for heading in headings}
    return made | set(re.findall(r"^\(([\w-]+)\)=$", text, re.MULTILINE))


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^()\s]*(?:\([^()\s]*\)[^()\s]*)*)\)", without_code(page.read_text(encoding="utf-8"))):
        if re.match(r"[a-z]+:", target):  # syntax alone: nothing is asked of the network
            parts = urlsplit(target)
            assert parts.scheme in ("http", "https"), target
            assert re.fullmatch(r"[\w.-]+\.[a-z]{2,}(:\d+)?", parts.netloc), target
            continue
        path, _, anchor = target.partition("#")
        found = (DOCS / path.lstrip("/") if path.startswith("/") else page.parent / path) if path else page
        assert found.exists(), f"{page.name}: {target}"
        if anchor:
            assert anchor in anchors(found), f"{page.name}: {target}"


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_a_page_is_light_with_its_pictures(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    named = [page.parent / name for name in re.findall(r"[\w./-]+\.(?:png|jpg|svg)\b", text) if (page.parent / name).exists()]
    assert len(text) + sum(path.stat().st_size for path in set(named)) < MOST_BYTES


RAW = re.compile(r"^(?:`{3,}|:{3,}) ?\{.*|\{[a-z:-]+\}`[^`\n]*`|^\([\w-]+\)=$|^% .*|(?<![\w\]`!])\[\]\([^)]*\)", re.MULTILINE)
"""What only Sphinx reads: directives, roles, labels, comments and links without words."""


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CHANGELOG.md"], ids=lambda p: str(p.relative_to(ROOT)))
def test_a_page_reads_without_a_build(page: Path) -> None:
    assert RAW.findall(page.read_text(encoding="utf-8")) == [], "write Markdown; docs/_ext/plain_pages.py makes lists and copies of it"


def test_what_reads_in_a_build_alone_is_found() -> None:
    found = RAW.findall("```{toctree}\n:hidden:\n```\n(here)=\n% note\n:::{grid} 1\nsee [](x.md), {doc}`x` and `x[](a)` [y](x.md) {x}\n")
    assert found == ["```{toctree}", "(here)=", "% note", ":::{grid} 1", "[](x.md)", "{doc}`x`"]


@pytest.mark.parametrize("place", page_tables.BLOCKS)
def test_what_comes_from_the_code_is_as_the_code_has_it(place: str) -> None:
    assert page_tables.written(place) == page_tables.BLOCKS[place](), "run ./run tables pages"


def test_each_table_of_the_scenario_file_has_a_page() -> None:
    pages = {path.stem for path in (DOCS / "guide" / "scenario").glob("*.md")}
    assert pages == set(page_tables.SCENARIO_TABLES)
    loose = "\n".join(page_tables.scenario_keys())
    assert not [name for name in page_tables.scenario_schema()["properties"] if name not in pages and f"| `{name}` |" not in loose]


def test_a_block_that_is_older_than_the_code_is_found_and_written_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_tables, "ROOT", tmp_path)
    monkeypatch.setattr(page_tables, "BLOCKS", {"a.md#one": lambda: ["| new |"], "a.md#two": lambda: ["second"]})
    page = tmp_path / "a.md"
    page.write_text("x\n\n<!-- begin one -->\n\n| old |\n\n<!-- end one -->\n\ny\n<!-- begin two -->\n<!-- end two -->\n")
    assert page_tables.written("a.md#one") == ["| old |"]
    for _ in range(2):
        assert page_tables.main([]) == 0
        assert page.read_text() == (
            "x\n\n<!-- begin one -->\n\n| new |\n\n<!-- end one -->\n\ny\n<!-- begin two -->\n\nsecond\n\n<!-- end two -->\n"
        )
    with pytest.raises(SystemExit, match="no blocks in"):
        page_tables.main(["other.md"])


def test_what_is_shown_is_compared(tmp_path: Path) -> None:
    assert alike("rate 0.0100 in 40 frames", "rate 0.0101 in 40 frames")
    assert not alike("rate 0.0100 in 40 frames", "rate 0.0105 in 40 frames")
    assert not alike("rate 0.0100 in 40 frames", "share 0.0100 in 40 frames")
    assert matches(["a", "...", "d"], ["a", "b", "c", "d"])
    assert not matches(["a", "...", "d"], ["a", "b", "c"])
    left_out = "<!-- not run: needs a ship -->\n```sh\n# all\nseaglint \\\n    view\n```\n\n"
    page = f"{left_out}File `a.txt`:\n\n```text\nx 1\n```\n\n```sh\ncat a.txt\n```\n"
    first, second, third = blocks(page)
    assert [(block.reason, block.file) for block in (first, second, third)] == [("needs a ship", ""), ("", "a.txt"), ("", "")]
    assert commands(first) == ["seaglint     view"]
    run(f"{page}\n```output\nx 1.01\n```\n", tmp_path)
    with pytest.raises(PageError, match="the page shows\nx 2"):
        run(f"{page}\n```output\nx 2\n```\n", tmp_path)
    assert run(f"{page}\n```output\nx 2\n```\n", tmp_path, write=True).endswith("\n```output\nx 1\n```\n")


def test_files_that_a_page_tells_to_save_are_offered(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    saved_files = importlib.import_module("saved_files")
    text = "File `a.toml`:\n\n```toml\nx = 1\n```\n\nFile `b.toml`: no block\n"
    shown = saved_files.offered(text, "tutorials/first")
    assert re.findall('href="([^"]*)"', shown) == ["first/a.toml"]
    page = tmp_path / "first.md"
    page.write_text(text)
    saved_files.write_files({"tutorials/first": page}, tmp_path / "site")
    assert (tmp_path / "site" / "tutorials" / "first" / "a.toml").read_text() == "x = 1\n"


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_code_fits_its_frame_and_can_be_copied(page: Path) -> None:
    """Lines that programs print and files of numbers are broken by the browser; code is not."""
    code = [
        line
        for block in blocks(page.read_text(encoding="utf-8"))
        if block.kind not in ("output", "text")
        for line in block.body.splitlines()
    ]
    assert [line for line in code if len(line) > WIDEST] == []
    assert [line for line in code if line.startswith("$ ")] == [], "commands stand without a prompt, their output in a block of its own"
    assert [line for line in code if re.search(r"[^\s#].*\S {2,}# ", line)] == [], "explanations stand in the line above"


def test_the_house_is_drawn_as_the_contract_has_it() -> None:
    from house import OUTPUT, picture

    assert OUTPUT.read_text(encoding="utf-8") == picture(), "run python tools/house.py"


def test_pictures_of_validation_show_what_the_code_gives() -> None:
    import numpy as np

    from seaglint.facet.emissivity import emissivity
    from seaglint.optics.sea_water import hale_querry_sea
    from seaglint.sea.slopes.cox_munk import cox_munk_isotropic
    from validation_plots import BANDS, read
    from validation_tables import lowtran_case

    for row in read("wu_smith")[::40]:
        slopes = cox_munk_isotropic(float(row["wind_speed_m_s"]), height=12.5)
        angle, wavenumber = np.radians([float(row["zenith_deg"])]), 1e4 / float(row["wavelength_um"])
        ours = float(emissivity(angle, slopes, hale_querry_sea(), wavenumber)[0, 0])
        assert ours == pytest.approx(float(row["emissivity:seaglint"]), rel=1e-4)  # six digits are written
    for row in read("lowtran7")[::75]:
        for low, high in BANDS:
            tau = lowtran_case(row, (low, high))[0]
            assert tau == pytest.approx(float(row[f"tau_mean[{low:g}-{high:g}]:seaglint"]), rel=1e-3)
