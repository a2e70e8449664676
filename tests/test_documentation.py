"""What the pages name exists, what they link to is there, and their code runs or says why not."""

from __future__ import annotations

import importlib
import os
import re
import shlex
import signal
import subprocess
import sys
import tomllib
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from typer.main import get_command

from run_docs import Block, alike, blocks, commands, matches, run
from seaglint.cli.app import app

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted(page for folder in (".", "guide", "adr", "gallery", "tutorials", "api") for page in (DOCS / folder).glob("*.md")),
]
TUTORIALS = sorted((DOCS / "tutorials").glob("*.md"))
RUN_HERE = ["README.md", "docs/guide/python.md", "docs/guide/ensembles.md", "docs/guide/workbench.md"]
"""Pages whose Python the quick suite runs, in a folder with a small scenario."""

RUN_LONG = [
    "docs/guide/tour.md",
    "docs/guide/detection.md",
    "docs/guide/sensor.md",
    "docs/guide/atmosphere.md",
    "docs/guide/weather.md",
    "docs/guide/textures.md",
]
"""The same, with the long comparisons."""

MOST_BYTES = 2_000_000
"""Of a page with its pictures."""
NAME = re.compile(r"\bseaglint(?:\.[A-Za-z_][A-Za-z_0-9]*)+")
FILE = re.compile(r"(?<![\w/.])(?:tests|tools|examples|docs|src)/[\w./-]+\.(?:py|toml|md|csv|png)\b")

SMALL = """
[sensor]
fov_deg = [4, 6]
elevation_deg = -3
pixels = [32, 40]
frames = 3

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
    assert exists("seaglint.imaging.swept.SweptScene.intervals")


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
@pytest.mark.parametrize("page", TUTORIALS, ids=lambda p: p.stem)
def test_a_tutorial_runs_and_prints_what_it_shows(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run(page.read_text(encoding="utf-8"), tmp_path)


@pytest.mark.validation
def test_the_five_minutes_of_the_readme_work_as_they_stand(tmp_path: Path) -> None:
    """One line after the other in an empty folder; the viewer is ended where it says its address."""
    text = (ROOT / "README.md").read_text(encoding="utf-8").split("## Five minutes")[1]
    lines = [line.split(" #")[0].strip() for line in next(block.body for block in blocks(text) if block.kind == "sh").splitlines()]
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    for line in lines:
        if line.startswith("source "):
            continue
        viewer = line.startswith("seaglint view")
        process = subprocess.Popen(
            shlex.split(line), cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        assert process.stdout is not None
        said = ""
        if viewer:
            while "http://" not in said and (heard := process.stdout.readline()):
                said += heard
            process.send_signal(signal.SIGINT)
        said += process.stdout.read()
        assert process.wait() == 0 or viewer, f"{line}: {said}"
        assert "Traceback" not in said, said
        if line.startswith("seaglint detect"):
            assert any(0.1 < float(found) < 0.9 for found in re.findall(r"P_d ([0-9.]+) ", said)), said
    assert {"run.png", "run.mp4", "run.tif", "clutter.html", "mean.png"} <= {path.name for path in tmp_path.iterdir()}


def asks_to_run(block: Block) -> bool:
    """Whether a reader would type it."""
    return block.kind in ("python", "sh", "console") or (
        block.kind == "" and bool(re.search(r"^(\$ )?(seaglint|\./run) ", block.body, re.M))
    )


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_blocks_run_or_say_why_not(page: Path) -> None:
    name = str(page.relative_to(ROOT))
    text = page.read_text(encoding="utf-8")
    runs = set()
    if name in (*RUN_HERE, *RUN_LONG):
        runs = {"python"}
    elif page in TUTORIALS:
        runs = {"python", "sh", "console"}
    if name == "README.md":
        runs |= {"sh"}  # the demo and the suite, which .ci/run runs, and commands of the tour
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
    lines = [line for block in blocks(text) if block.kind in ("sh", "console") for line, _ in commands(block)]
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


def test_an_option_that_is_gone_is_found() -> None:
    command, rest = command_named(["atmosphere", "write", "my.toml", "--fromat", "tape5"])
    assert rest[0] == "my.toml"
    assert "--fromat" not in options_of(command)
    assert "--format" in options_of(command)


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
    for kind, listed in re.findall(r"\{gallery-(picture|cards)\} ([\w ]+)", text):
        folder = DOCS / "images" / "gallery" / ("small" if kind == "cards" else "")
        named += [path for name in listed.split() for path in folder.glob(f"{name}.*")]
    assert len(text) + sum(path.stat().st_size for path in set(named)) < MOST_BYTES


def test_what_is_shown_is_compared() -> None:
    assert alike("rate 0.0100 in 40 frames", "rate 0.0101 in 40 frames")
    assert not alike("rate 0.0100 in 40 frames", "rate 0.0105 in 40 frames")
    assert not alike("rate 0.0100 in 40 frames", "share 0.0100 in 40 frames")
    assert matches(["a", "...", "d"], ["a", "b", "c", "d"])
    assert not matches(["a", "...", "d"], ["a", "b", "c"])
    page = "<!-- not run: needs a ship -->\n```sh\nseaglint analyze clip.npy\n```\n\n```console\n$ ls\na.txt\n```\n"
    first, second = blocks(page)
    assert (first.reason, second.reason) == ("needs a ship", "")
    assert list(commands(second)) == [("ls", ["a.txt"])]


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
