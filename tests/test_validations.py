"""Which validations a change needs, how a part of the suite ends at its time, and what is remembered and recorded of a run."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
import tomllib
import types
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import part_limit
import pytest

import touched_rooms
import validations
from touched_rooms import Base, House, base_of, touched
from validations import CUT, LEFT, Memory, Plan, Verdicts

ROOT = Path(__file__).resolve().parents[1]

PYPROJECT = f"""
[project]
name = "seaglint"
dependencies = ["numpy"]

[tool.ruff]
line-length = 100

[tool.pytest.ini_options]
testpaths = ["tests"]
addopts = "-q -p xdist.plugin --import-mode=importlib"
pythonpath = ["tests/helpers", "docs/figures", "{ROOT / "tests" / "helpers"}", "{ROOT / "tools"}"]
markers = ["validation: long"]
"""

CONFTEST = """
import time

import part_limit
import part_order

BEGAN = time.time()


def pytest_addoption(parser):
    part_limit.add_options(parser)
    part_order.add_options(parser)


def pytest_configure(config):
    part_limit.configure(config, BEGAN)
    part_order.configure(config)
"""

WAVES = '''"""Waves."""

from seaglint.base.units import METRE


def height() -> float:
    """Return it."""
    return 2.0 * METRE
'''

HOUSE = {
    "pyproject.toml": PYPROJECT,
    "tests/conftest.py": CONFTEST,
    "src/seaglint/sea/waves.py": WAVES,
    ".gitignore": "__pycache__/\n.pytest_cache/\n",
    "src/seaglint/__init__.py": '"""House."""\n',
    "src/seaglint/base/__init__.py": "",
    "src/seaglint/base/units.py": '"""Units."""\nMETRE = 1.0\n',
    "src/seaglint/sea/__init__.py": "",
    "src/seaglint/sea/ripples.py": "def small() -> float:\n    return 0.1\n",
    "src/seaglint/sea/data/table.csv": "1,2\n",
    "src/seaglint/air/__init__.py": "",
    "src/seaglint/air/sky.py": "def blue() -> float:\n    return 1.0\n",
    "src/seaglint/imaging/__init__.py": "",
    "src/seaglint/imaging/camera.py": "from seaglint.sea import waves\n\n\ndef look() -> float:\n    return waves.height()\n",
    "src/seaglint/cli/__init__.py": "",
    "src/seaglint/cli/show.py": "def show() -> float:\n    from seaglint.imaging.camera import look\n\n    return look()\n",
    "docs/figures/marcher.py": "def march() -> None: ...\n",
    "tests/helpers/scenes.py": "from marcher import march\n",
    "tests/sea/test_waves.py": "def test_height() -> None: ...\n",
    "tests/air/test_sky.py": "import scenes\n\n\ndef test_blue() -> None: ...\n",
    "tests/imaging/test_camera.py": "def test_look() -> None: ...\n",
    "tests/cli/test_show.py": "def test_show() -> None: ...\n",
    "tests/test_documentation.py": "def test_pages() -> None: ...\n",
    "docs/validation.md": "before\n\n<!-- begin last-run -->\n\n<!-- end last-run -->\n\nafter\n",
    "docs/data/numbers.csv": "1\n",
}
"""A house of five rooms: cli above imaging above sea above base, and air beside them."""


@dataclass
class Clone:
    """A git repository."""

    root: Path

    def git(self, *words: str) -> str:
        """Output of a git command."""
        names = {f"GIT_{who}_{what}": "a@b" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
        command = ["git", "-c", "init.defaultBranch=main", *words]
        return subprocess.run(
            command, cwd=self.root, env={**os.environ, **names}, capture_output=True, text=True, check=True
        ).stdout.strip()

    def write(self, name: str, text: str) -> None:
        """A file with this text."""
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def change(self, name: str, old: str, new: str) -> None:
        """Another text in a file."""
        text = (self.root / name).read_text(encoding="utf-8")
        assert old in text
        self.write(name, text.replace(old, new))

    def commit(self) -> str:
        """All that there is, committed; the commit's name."""
        self.git("add", "--all")
        # Two commits of the same second, tree and message would be one.
        self.git("commit", "--quiet", "--allow-empty", "--message", f"at {time.time_ns()}")
        return self.git("rev-parse", "HEAD")


@pytest.fixture
def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Clone:
    """The house in a repository with one commit on main, and a cache folder without memories."""
    result = Clone(tmp_path / "house")
    for name, text in HOUSE.items():
        result.write(name, text)
    result.git("init", "--quiet")
    result.commit()
    monkeypatch.setenv("SEAGLINT_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("SEAGLINT_BASE", raising=False)
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")  # the start of pytest is most of its time here
    return result


ABOVE_SEA = {"imaging": 1, "cli": 2, "tests/test_documentation.py": 3}
CHANGES: dict[str, tuple[str, str, str, set[str], dict[str, int]]] = {
    "docstring": ("src/seaglint/sea/waves.py", "Return it.", "Return the height.", set(), {}),
    "comment": ("src/seaglint/sea/waves.py", "METRE\n\n", "METRE  # of the SI\n\n", set(), {}),
    "formula": ("src/seaglint/sea/waves.py", "2.0 *", "3.0 *", {"sea"}, ABOVE_SEA),
    "import": ("src/seaglint/sea/waves.py", "units import METRE", "units import FOOT as METRE", {"sea"}, ABOVE_SEA),
    "module that nobody imports": ("src/seaglint/sea/ripples.py", "0.1", "0.2", {"sea"}, {"tests/test_documentation.py": 1}),
    "lowest room": (
        "src/seaglint/base/units.py",
        "1.0",
        "1.1",
        {"base"},
        {"sea": 1, "imaging": 2, "cli": 3, "tests/test_documentation.py": 4},
    ),
    "highest room": ("src/seaglint/cli/show.py", "return look()", "return 2.0 * look()", {"cli"}, {"tests/test_documentation.py": 1}),
    "data": ("src/seaglint/sea/data/table.csv", "1,2", "1,3", {"sea"}, ABOVE_SEA),
    "tests of a room": ("tests/imaging/test_camera.py", "...", "assert True", {"imaging"}, {}),
    "figure's script behind a helper": ("docs/figures/marcher.py", "...", "return None", {"tests/air/test_sky.py"}, {}),
    "helper": ("tests/helpers/scenes.py", "from marcher import march", "march = 1", {"tests/air/test_sky.py"}, {}),
    "page": ("docs/validation.md", "before", "well before", {"tests/test_documentation.py"}, {}),
    "lint": ("pyproject.toml", "line-length = 100", "line-length = 120", set(), {}),
}


@pytest.mark.parametrize("name", CHANGES)
def test_a_change_touches_its_room_and_those_that_import_it(name: str, clone: Clone) -> None:
    file, old, new, changed, above = CHANGES[name]
    base = clone.git("rev-parse", "HEAD")
    clone.change(file, old, new)
    result = touched(clone.root, Base(base, "test"))
    assert (result.everything, set(result.changed), result.above) == ("", changed, above)
    clone.commit()
    assert touched(clone.root, Base(base, "test")) == result


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("pyproject.toml", '["numpy"]', '["numpy>=3"]'),
        ("pyproject.toml", "testpaths", "norecursedirs"),
        ("tests/conftest.py", "time.time()", "0.0"),
        ("src/seaglint/__init__.py", '"""House."""', "import os"),
    ],
)
def test_what_all_hang_on_touches_all(file: str, old: str, new: str, clone: Clone) -> None:
    base = clone.git("rev-parse", "HEAD")
    clone.change(file, old, new)
    assert touched(clone.root, Base(base, "test")).everything == f"{file} differs"


def test_files_that_come_go_and_move_touch_their_rooms(clone: Clone) -> None:
    base = clone.git("rev-parse", "HEAD")
    clone.write("src/seaglint/air/haze.py", "from seaglint.sea.ripples import small\n")
    (clone.root / "src/seaglint/sea/ripples.py").unlink()
    result = touched(clone.root, Base(base, "test"))
    assert result.changed == {"air": "src/seaglint/air/haze.py", "sea": "src/seaglint/sea/ripples.py"}


def test_files_of_tests_are_above_what_they_import(clone: Clone) -> None:
    clone.change("tests/helpers/scenes.py", "from marcher", "from seaglint.imaging import camera\nfrom marcher")
    base = clone.commit()
    clone.change("src/seaglint/base/units.py", "1.0", "1.1")
    assert touched(clone.root, Base(base, "test")).above["tests/air/test_sky.py"] == 4  # scenes, camera, waves, units


def test_the_house_is_read_as_it_stands() -> None:
    """Rooms that everybody knows, and ways between them."""
    house = House(ROOT)
    assert {"base", "sea", "air", "imaging", "studies", "cli", "version"} <= house.rooms
    assert "__init__" not in house.rooms
    steps = house.steps({"seaglint.sea.wave_field"})
    assert steps["sea"] == 0
    assert 0 < steps["imaging"] <= steps["cli"]
    assert "optics" not in steps
    assert house.test_files_above({"seaglint.sea.slopes.cox_munk"})["tests/radiance/test_mean.py"] == 1
    assert "tests/imaging/test_ray_marcher.py" in house.users("docs/figures/ray_marcher.py") & house.users("benchmarks/mitsuba_scene.py")
    assert "tests/test_validations.py" in house.users("tools/touched_rooms.py")


@pytest.mark.parametrize("file", sorted({file for files in touched_rooms.ELSEWHERE.values() for file in files}))
def test_files_that_judge_pages_and_examples_are_there(file: str) -> None:
    assert (ROOT / file).is_file()


def test_a_branch_is_compared_with_where_it_left_main(clone: Clone) -> None:
    left = clone.git("rev-parse", "HEAD")
    clone.git("checkout", "--quiet", "-b", "work")
    clone.commit()
    clone.git("checkout", "--quiet", "main")
    clone.commit()
    clone.git("checkout", "--quiet", "work")
    assert base_of(clone.root, {}) == Base(left, "the merge base with main")


def test_main_at_its_origin_is_compared_with_the_last_whole_run(clone: Clone) -> None:
    first = clone.git("rev-parse", "HEAD")
    clone.write(touched_rooms.RECORD, f'commit = "{first}"\n')
    head = clone.commit()
    clone.git("update-ref", "refs/remotes/origin/main", head)
    assert base_of(clone.root, {}) == Base(first, "the last whole run of the validations")
    clone.commit()  # not pushed
    assert base_of(clone.root, {}) == Base(head, "the merge base with origin/main")


@pytest.mark.parametrize("text", ["", "commit = 3\n", "commit = [", "date = 2\n", f'commit = "{"0" * 40}"\n', 'commit = "--all"\n'])
def test_without_a_last_whole_run_everything_counts(text: str, clone: Clone) -> None:
    clone.write(touched_rooms.RECORD, text)
    clone.commit()
    result = touched(clone.root, base_of(clone.root, {}))
    assert result.base.commit is None
    assert result.everything == result.base.reason


def test_a_whole_run_of_another_branch_does_not_count(clone: Clone) -> None:
    clone.git("checkout", "--quiet", "-b", "other")
    elsewhere = clone.commit()
    clone.git("checkout", "--quiet", "main")
    clone.write(touched_rooms.RECORD, f'commit = "{elsewhere}"\n')
    clone.commit()
    assert base_of(clone.root, {}).commit is None


def test_a_base_can_be_named(clone: Clone) -> None:
    first = clone.git("rev-parse", "HEAD")
    clone.commit()
    assert base_of(clone.root, {"SEAGLINT_BASE": "HEAD~1"}) == Base(first, "by SEAGLINT_BASE")
    for wrong in ("no-such-branch", "--all", "HEAD:docs"):
        with pytest.raises(SystemExit, match=f"SEAGLINT_BASE = {wrong} names no commit"):
            base_of(clone.root, {"SEAGLINT_BASE": wrong})


def test_a_folder_without_git_is_judged_whole(tmp_path: Path) -> None:
    result = touched(tmp_path, base_of(tmp_path, {}))
    assert result.everything == "no commit here"


PLAN = Plan(
    everything="",
    changed=("sea", "tests/air/test_one.py"),
    above={"imaging": 2, "facet": 1, "tests/test_pages.py": 3},
    fifth=2,
    cut=("tests/optics/test_b.py::test_cut",),
    left=("tests/cli/test_c.py::test_left", "tests/sea/test_s.py::test_left"),
    rooms=("air", "cli", "facet", "imaging", "optics", "sea"),
)


def test_the_order_is_cut_off_changed_left_over_and_above() -> None:
    tests = [
        "tests/optics/test_b.py::test_cut",
        "tests/sea/test_s.py::test_left",
        "tests/sea/test_a.py::test_first",
        "tests/air/test_one.py::test_x[1-2]",
        "tests/cli/test_c.py::test_left",
        "tests/facet/test_f.py::test_g",
        "tests/imaging/test_i.py::test_j",
        "tests/test_pages.py::test_k",
    ]
    places = [PLAN.place(test) for test in tests]
    assert [place.reason for place in places if place] == [CUT, "changed", "changed", "changed", LEFT, "above", "above", "above"]
    ranks = sorted(tests, key=lambda test: PLAN.place(test).rank)  # type: ignore[union-attr]
    assert ranks[0] == tests[0]
    assert set(ranks[1:4]) == set(tests[1:4])
    assert ranks[4:] == tests[4:]
    assert ranks.index(tests[1]) < ranks.index(tests[2])


def test_five_commits_run_all_of_the_rest_once() -> None:
    rest = [f"tests/optics/test_x.py::test_{number}" for number in range(500)]
    chosen = [{test for test in rest if Plan("", (), {}, fifth, rooms=("optics",)).place(test)} for fifth in range(5)]
    assert set.union(*chosen) == set(rest)
    assert sum(map(len, chosen)) == len(rest)
    # 100 are expected in each, with a deviation of 9
    assert all(60 < len(one) < 140 for one in chosen)
    # the same on every machine and in every process
    assert [validations.part_of(test) for test in rest[:4]] == [1, 3, 4, 4]


def test_a_plan_survives_its_file(tmp_path: Path) -> None:
    PLAN.write(tmp_path / "plan.json")
    assert Plan.read(tmp_path / "plan.json") == PLAN


def test_all_are_chosen_where_everything_counts() -> None:
    place = Plan("no commit here", (), {}, 0).place("tests/optics/test_x.py::test_1")
    assert place is not None
    assert place.reason == "all rooms"


def verdicts(*lines: str) -> Verdicts:
    """Verdicts of a file with these lines."""
    return Verdicts.of(line.replace(" ", "\t") for line in lines)


def test_what_was_cut_off_is_remembered_until_it_passes() -> None:
    reasons = dict.fromkeys("abcdef", "changed") | {"f": "fifth"}
    first = verdicts(*(f"collected {test}" for test in "abcdef"), "begun a", "passed a", "begun b", "begun c", "failed c")
    memory = Memory(["gone", "c"], []).after(first, reasons)
    assert memory == Memory(["b", "c"], ["d", "e"])  # not f, which comes with its fifth
    second = verdicts(*(f"collected {test}" for test in "bcde"), "begun b", "skipped b", "begun c", "passed c", "begun d", "passed d")
    assert memory.after(second, dict.fromkeys("bcde", "changed")) == Memory([], ["e"])


@pytest.mark.parametrize("text", ["", "{", "[]", "3", '{"cut": 3, "left": ["a"]}', '{"cut": [1], "left": null}', '{"cut": []}'])
def test_a_damaged_memory_is_none(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SEAGLINT_CACHE", str(tmp_path))
    Memory.place().write_text(text)
    assert Memory.read().cut == []
    assert Memory(["a"], ["b"]).write() == ""
    assert Memory.read() == Memory(["a"], ["b"])


def test_a_cache_folder_that_cannot_be_written_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SEAGLINT_CACHE", str(tmp_path / "file" / "cache"))
    assert Memory.read() == Memory()
    assert str(tmp_path / "file" / "cache") in Memory(["a"]).write()


HURRY = """
import ctypes, os, pathlib, signal, time
import part_limit, pytest

@pytest.fixture
def limit(request):
    return request.config.pluginmanager.get_plugin("time-limit")

@pytest.fixture
def hurry(limit, monkeypatch):
    monkeypatch.setattr(limit, "ends", time.time() + 0.2)
    signal.setitimer(signal.ITIMER_REAL, 0.2, 20.0)

@pytest.fixture
def impatient(limit, monkeypatch):
    monkeypatch.setattr(part_limit, "LONGEST", 0.2)

@pytest.fixture
def deaf():
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGALRM})
"""
"""Fixtures that make the time of a part be over soon after a test has begun, however slow the machine is."""

EACH = """
def test_passes(): ...
def test_fails(): assert 1 == 2
def test_skips(): pytest.skip("no")
@pytest.mark.xfail
def test_known(): assert False
def test_long(hurry): time.sleep(60)

def test_translates(hurry):
    try:
        time.sleep(60)
    except BaseException as error:
        raise RuntimeError("stopped") from error

def test_drops(hurry):
    called = []
    def wait(*_):
        time.sleep(60)
        called.append(1)
        return 0
    compare = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(wait)
    ctypes.CDLL(None).qsort(ctypes.create_string_buffer(2), ctypes.c_size_t(2), ctypes.c_size_t(1), compare)
    assert called

@pytest.fixture
def slow(hurry): time.sleep(60)
@pytest.fixture
def folder():
    yield
    pathlib.Path("taken-down").write_text("")

def test_slow_fixture(slow): ...
def test_is_taken_down(folder, hurry): time.sleep(60)
def test_hangs(impatient): time.sleep(60)
@pytest.mark.xfail
def test_known_and_long(hurry): time.sleep(60)
def test_passes_too(): ...
def test_over(limit): limit.ends = 0.0
@pytest.mark.parametrize("number", range(300))
def test_waits(number): time.sleep(60)
"""

ENDED = """
def test_deaf(hurry, deaf): time.sleep(60)
def test_crashes(): os._exit(3)
def test_passes(): ...
"""


@dataclass
class Part:
    """A run of pytest with a limit."""

    status: int
    printed: str
    lines: list[str]
    folder: Path

    def tests(self, word: str) -> set[str]:
        """Names of tests with this verdict."""
        return {line.split("::")[1] for line in self.lines if line.startswith(f"{word}\t")}


@pytest.fixture
def run_part(clone: Clone) -> Callable[..., Part]:
    """Run a file of tests as a part."""

    def run(text: str, workers: int, *options: str, before: str = "") -> Part:
        clone.write("tests/sea/test_waves.py", text)
        clone.change("tests/conftest.py", "BEGAN = ", f"{before}\nBEGAN = ")
        judged = clone.root / "judged"
        command = [sys.executable, "-m", "pytest", "-n", str(workers), f"--judged={judged}", *options]
        done = subprocess.run(command, cwd=clone.root, capture_output=True, text=True, check=False)
        return Part(done.returncode, done.stdout + done.stderr, judged.read_text().splitlines(), clone.root)

    return run


needs_signals = pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="signals of POSIX")
workers = pytest.mark.parametrize("workers", [0, 2])


@needs_signals
@workers
def test_a_part_ends_at_its_time_with_what_it_has_judged(workers: int, run_part) -> None:
    part = run_part(HURRY + EACH, workers, "--dist=loadfile", "--most-seconds=1000", "tests/sea")
    assert part.status == 1, part.printed
    cut = {"test_long", "test_translates", "test_drops", "test_slow_fixture", "test_is_taken_down", "test_known_and_long"}
    assert part.tests("passed") == {"test_passes", "test_passes_too", "test_over"}
    assert part.tests("failed") == {"test_fails", "test_hangs"}
    assert part.tests("skipped") == {"test_skips"}
    assert part.tests("xfailed") == {"test_known"}
    assert part.tests("begun") - cut == part.tests("passed") | {"test_fails", "test_hangs", "test_skips", "test_known"}
    assert len(part.tests("collected")) == 313
    assert "2 failed, 3 passed, 1 skipped, 1 xfailed, 1 warning, 306 left out in" in part.printed
    assert "sea: 306 (test_waves.py 306)" in part.printed
    assert {line.split("::")[1] for line in part.printed.splitlines() if line.startswith("cut off: ")} == cut
    assert len(part.printed.splitlines()) < 100
    assert "has run for 600 s and is taken to hang" in part.printed
    assert (part.folder / "taken-down").exists()


@needs_signals
def test_a_process_that_hears_no_signal_is_ended(run_part) -> None:
    """And another goes on; what crashes by itself has failed."""
    part = run_part(HURRY + ENDED, 2, "--dist=load", "--most-seconds=1000", "tests/sea", before="part_limit.GRACE = 0.5")
    assert part.status == 1, part.printed
    assert part.tests("failed") == {"test_crashes"}
    assert part.tests("passed") == {"test_passes"}
    assert "1 failed, 1 passed, 1 left out in" in part.printed
    assert "cut off: tests/sea/test_waves.py::test_deaf" in part.printed
    assert "where a process was ended" in part.printed
    assert "in test_deaf" in part.printed


def test_a_process_that_hangs_has_failed() -> None:
    verdicts = part_limit.Verdicts(None, None)
    verdicts.begun["a::b"] = time.time() - part_limit.LONGEST
    node = types.SimpleNamespace(gateway=types.SimpleNamespace(id="gw0"), workerinput={})
    verdicts.pytest_configure_node(node)
    Path(node.workerinput["part_stacks"]).write_text("Timeout!\n")
    report = pytest.TestReport("a::b", ("a", 1, "b"), {}, "failed", "crashed", "call", node=node)
    verdicts.pytest_handlecrashitem("a::b", report)
    assert report.failed
    assert "taken to hang" in str(report.longrepr)


def test_the_time_of_a_part_begins_with_its_collection(run_part) -> None:
    part = run_part("def test_passes(): ...\n", 2, "--most-seconds=0.001", "tests")
    assert part.status == 0, part.printed
    assert part.tests("begun") == set()
    assert len(part.tests("collected")) == 5
    assert "5 left out in" in part.printed
    assert "test_documentation: 1 (test_documentation.py 1)" in part.printed


@pytest.mark.parametrize("seconds", ["0", "-3", "nan", "inf", "soon"])
def test_a_limit_is_a_number_of_seconds(seconds: str) -> None:
    with pytest.raises(ValueError, match="seconds above 0" if seconds != "soon" else "could not convert"):
        part_limit.positive(seconds)


MANY = "import pytest\n\n@pytest.mark.validation\n@pytest.mark.parametrize('n', range({0}))\ndef test_{1}(n): ...\n"


def house_of_validations(clone: Clone) -> None:
    """Validations in four rooms and on the pages."""
    for number, name in enumerate(("air/test_sky", "cli/test_show", "imaging/test_camera", "sea/test_waves", "test_documentation")):
        clone.write(f"tests/{name}.py", MANY.format(10 + number, name.split("_")[1]))
    clone.commit()


@workers
def test_chosen_tests_begin_in_the_plans_order(workers: int, clone: Clone, run_part) -> None:
    house_of_validations(clone)
    sea = (clone.root / "tests/sea/test_waves.py").read_text()
    rooms = tuple(House(clone.root).rooms)
    plan = Plan("", ("sea",), {"imaging": 1, "cli": 2}, 0, ("tests/cli/test_show.py::test_show[7]",), rooms=rooms)
    plan.write(clone.root / "plan.json")
    part = run_part(sea, workers, f"--chosen={clone.root / 'plan.json'}", "-m", "validation", "-vv")
    passed = [line for line in part.printed.splitlines() if "PASSED" in line]
    begun = [(line.split()[0] if line.startswith("[gw") else "", next(w for w in line.split() if "::" in w)) for line in passed]
    assert {test for _, test in begun} == {line.split("\t")[1] for line in part.lines if line.startswith("passed")}
    assert len({worker for worker, _ in begun}) == max(1, workers)
    for worker in {worker for worker, _ in begun}:
        ranks = [plan.place(test).rank for one, test in begun if one == worker]  # type: ignore[union-attr]
        assert ranks == sorted(ranks)


def chosen(clone: Clone, capfd: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    """Status and output of a run of what the change needs."""
    status = validations.main(["--chosen", *arguments])
    return status, capfd.readouterr().out


@needs_signals
def test_what_is_cut_off_runs_first_next_time(clone: Clone, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(validations, "ROOT", clone.root)
    house_of_validations(clone)
    clone.git("update-ref", "refs/remotes/origin/main", clone.git("rev-parse", "HEAD"))
    marks = "\npytestmark = pytest.mark.validation\n"
    slow = "def test_fails(): assert pathlib.Path('calm').exists()\ndef test_long({0}, n): time.sleep({1})\n".replace(
        "def test_long", "@pytest.mark.parametrize('n', range(3))\ndef test_long"
    )
    over = "\n@pytest.fixture\ndef over(limit): limit.ends = time.time() + 0.2\n"
    clone.write("tests/sea/test_waves.py", HURRY + marks + over + slow.format("over", 60))
    clone.commit()
    status, printed = chosen(clone, capfd, "--most-seconds", "1000", f"--judged={clone.root / 'judged'}")
    assert status == 1, printed
    names = [f"tests/sea/test_waves.py::test_long[{n}]" for n in range(3)]
    assert Memory.read() == Memory(names[:1], names[1:])
    assert "changed rooms, by 1 files that differ: sea" in printed
    assert f"begun\t{names[0]}\n" in (clone.root / "judged").read_text()
    assert "ran (changed): 1: sea 1" in printed
    assert f"first next time: {names[0]}" in printed
    assert "left out, the time of 1000 s was over (changed): 3: sea 3" in printed
    clone.write("tests/sea/test_waves.py", HURRY + marks + slow.format("tmp_path", 0))
    (clone.root / "calm").write_text("")
    status, printed = chosen(clone, capfd)
    assert status == 0, printed
    assert f"ran ({CUT}): 1: sea 1" in printed
    assert "ran (changed): 3: sea 3" in printed
    assert re.search(r"ran \(fifth\): \d+: ", printed)
    assert re.search(r"left out by choice, the other fifths: \d+: ", printed)
    assert Memory.read() == Memory()


def test_the_choice_is_listed(clone: Clone, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(validations, "ROOT", clone.root)
    house_of_validations(clone)
    status, printed = chosen(clone, capfd, "--list")
    assert status == 0
    assert "to run (all rooms): 60: test_documentation 14, sea 13, imaging 12, cli 11, air 10" in printed


def test_a_whole_run_that_passes_is_recorded(clone: Clone, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(validations, "ROOT", clone.root)
    house_of_validations(clone)
    clone.write("tests/air/test_sky.py", MANY.format(3, "sky").replace("...", "pytest.skip('no') if n else pytest.xfail('yes')"))
    commit = clone.commit()
    assert validations.main([]) == 0
    record = tomllib.loads((clone.root / touched_rooms.RECORD).read_text())
    assert record.items() >= {"commit": commit, "local_changes": False, "passed": 50, "failed": 0, "skipped": 2, "xfailed": 1}.items()
    page = (clone.root / "docs/validation.md").read_text()
    assert re.fullmatch(
        rf"before\n\n<!-- begin last-run -->\n\nLast whole run: .*, commit {commit[:9]} \(.*, Python .*\): "
        r"50 passed, 0 failed, 2 skipped, 1 expected to fail, 0 minutes\.\n\n<!-- end last-run -->\n\nafter\n",
        page,
    )
    # What the record itself changes is no change, and the record is the base of what follows.
    none = Verdicts({}, (), ())
    assert validations.recorded(clone.root, none, 1.0)["local_changes"] is False
    clone.commit()
    assert base_of(clone.root, {}) == Base(commit, "the last whole run of the validations")
    clone.write("src/seaglint/sea/new.py", "")
    changed = validations.recorded(clone.root, none, 1.0)
    assert changed["local_changes"] is True
    assert "with local changes" in validations.sentence(changed)


def test_a_whole_run_that_fails_is_not_recorded(clone: Clone, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(validations, "ROOT", clone.root)
    clone.write("tests/sea/test_waves.py", MANY.format(2, "waves").replace("...", "assert n"))
    assert validations.main([]) == 1
    assert "1 failed, 0 not judged" in capfd.readouterr().out
    assert not (clone.root / touched_rooms.RECORD).exists()


def test_some_validations_are_no_whole_run(clone: Clone, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(validations, "ROOT", clone.root)
    house_of_validations(clone)
    assert validations.main(["tests/sea"]) == 0
    assert not (clone.root / touched_rooms.RECORD).exists()


def test_the_page_shows_the_last_whole_run() -> None:
    record = tomllib.loads((ROOT / touched_rooms.RECORD).read_text(encoding="utf-8"))
    page = (ROOT / validations.PAGE).read_text(encoding="utf-8")
    assert validations.with_block(page, validations.sentence(record)) == page


@pytest.mark.parametrize(
    "arguments", [["--list"], ["--judged", "x"], ["--chosen", "--most-seconds", "0"], ["--chosen", "--most-seconds", "soon"]]
)
def test_options_that_make_no_sense_are_refused(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as refused:
        validations.main(arguments)
    assert refused.value.code == 2
    assert "usage" in capsys.readouterr().err
