"""Compiled kernels are kept by what they were compiled from: in tiny copies of the package, run by processes of their own."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import BinaryIO

import pytest

import seaglint
from seaglint.base import kernel_cache as _kernel_cache
from seaglint.base.kernel_cache import IN_USE, MOST_FOLDERS, PREFIX, remove_old, sources_digest

SOURCE = Path(seaglint.__file__).parent

INNER = """
from seaglint.base.jit import kernel
@kernel
def inner(x):
    return 2.0 * x
"""

OUTER = """
from seaglint.base.jit import njit
from seaglint.base.constants import ADDED
from seaglint.inner import inner
@njit
def outer(x):
    return inner(x) + ADDED
"""

HANG = 600.0
"""Seconds after which a process that never ends is given up."""

RUN = "from seaglint.outer import outer; print(outer(3.0), outer(3))"


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package whose kernel calls one of another file and reads a constant."""
    folder = tmp_path / "src" / "seaglint"
    (folder / "base").mkdir(parents=True)
    for name in (
        "__init__.py",
        "base/__init__.py",
        "base/jit.py",
        "base/kernel_bodies.py",
        "base/kernel_cache.py",
        "base/kernel_cache.py",
        "base/machine.py",
    ):
        shutil.copy(SOURCE / name, folder / name)
    for name, text in (("inner", INNER), ("outer", OUTER), ("base/constants", "ADDED = 1.0\n"), ("bystander", "x = 1\n")):
        (folder / f"{name}.py").write_text(text)
    return folder


def start(package: Path, code: str = RUN, **environment: str) -> subprocess.Popen[str]:
    """Run code with the copy, whose own and the user's folders are all that it may write to."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA_", "SEAGLINT_", "COVERAGE_"))}
    # Python takes a file that changes within a second, to one of the same size, for the compiled one: it keeps whole seconds.
    given = {
        "PYTHONPATH": str(package.parent),
        "SEAGLINT_CACHE": str(package.parent / "user"),
        "PYTHONDONTWRITEBYTECODE": "1",
    } | environment
    return subprocess.Popen([sys.executable, "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=kept | given)


def answer(package: Path, code: str = RUN, **environment: str) -> str:
    """What it prints."""
    process = start(package, code, **environment)
    out, _ = process.communicate()
    assert process.returncode == 0
    return out.strip()


def compiled(folder: Path) -> dict[str, int]:
    """Files of compiled code below a folder, by when they were written."""
    return {str(path.relative_to(folder)): path.stat().st_mtime_ns for path in folder.rglob("*.nbc")}


def test_a_change_of_what_a_kernel_calls_is_seen(package: Path) -> None:
    assert answer(package) == "7.0 7.0"
    (package / "inner.py").write_text(INNER.replace("2.0", "5.0"))
    assert answer(package) == "16.0 16.0"
    (package / "base" / "constants.py").write_text("ADDED = 0.5\n")
    assert answer(package) == "15.5 15.5"


@pytest.mark.validation
def test_unchanged_kernels_are_not_compiled_again(package: Path) -> None:
    assert answer(package) == "7.0 7.0"
    before = compiled(package.parent)
    assert before
    (package / "bystander.py").write_text("x = 2\n")
    assert answer(package) == "7.0 7.0"
    assert compiled(package.parent) == before
    (kept,) = (package.parent / "user" / "kernels").glob(f"{PREFIX}*")
    assert kept.name == PREFIX + sources_digest(package)


def test_another_copy_of_the_same_sources_loads_what_one_compiled(package: Path, tmp_path: Path) -> None:
    user = str(tmp_path / "shared")
    assert answer(package, SEAGLINT_CACHE=user) == "7.0 7.0"
    before = compiled(tmp_path / "shared")
    other = shutil.copytree(package, tmp_path / "other" / "seaglint", ignore=shutil.ignore_patterns("__pycache__"))
    (other / "outer.py").touch()
    assert answer(other, SEAGLINT_CACHE=user) == "7.0 7.0"
    assert compiled(tmp_path / "shared") == before


def test_a_kernel_has_no_machine_code_of_its_own_for_its_callers(package: Path) -> None:
    code = (
        "from seaglint.outer import outer; from seaglint.inner import inner; outer(3.0); print(len(inner.overloads), end=' ');"
        "print(inner(3.0), len(inner.overloads))"
    )
    assert answer(package, code) == "0 6.0 1"
    assert answer(package, code) == "0 6.0 1"


def test_a_full_disk_costs_the_kept_code_alone(package: Path) -> None:
    code = (
        "import errno, os, logging; from seaglint.outer import outer\n"
        "def full(*_): raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))\n"
        "logging.getLogger('seaglint').warning = lambda text, *parts: print(text % parts)\n"
        "outer._cache._cache_file.save = full; print(outer(3.0), outer(3))"
    )
    *warned, numbers = answer(package, code).splitlines()
    assert numbers == "7.0 7.0"
    assert len(warned) == 1
    assert os.strerror(errno.ENOSPC) in warned[0]


WHERE = RUN + "; from seaglint.base.kernel_cache import kernel_folder; print(kernel_folder())"


@pytest.mark.validation
def test_an_installation_that_cannot_be_written_uses_the_users_folders(package: Path, tmp_path: Path) -> None:
    """A file in the place of a folder: the superuser, too, cannot write into it."""
    (package / "__pycache__").write_text("")
    numbers, where = answer(package, WHERE).splitlines()
    assert (numbers, Path(where).parent) == ("7.0 7.0", tmp_path / "src" / "user" / "kernels")
    assert compiled(Path(where))

    blocked = str(package / "__pycache__" / "no")
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    numbers, where = answer(package, WHERE, SEAGLINT_CACHE=blocked, TMPDIR=str(temporary)).splitlines()
    assert (numbers, Path(where).parent.parent) == ("7.0 7.0", temporary)
    assert compiled(temporary)


@pytest.mark.skipif(os.name != "posix", reason="accounts")
def test_a_temporary_folder_open_to_others_is_not_used(package: Path, tmp_path: Path) -> None:
    (package / "__pycache__").write_text("")
    others = tmp_path / f"seaglint-{os.getuid()}"
    others.mkdir()
    others.chmod(0o777)
    blocked = str(package / "__pycache__" / "no")
    assert answer(package, WHERE, SEAGLINT_CACHE=blocked, TMPDIR=str(tmp_path)).splitlines() == ["7.0 7.0", "None"]
    assert not compiled(tmp_path)


@pytest.mark.validation
def test_the_users_folder_for_numba_is_used_for_ours_and_left_to_others(package: Path, tmp_path: Path) -> None:
    code = RUN + "; import numba; print(numba.config.CACHE_DIR)"
    assert answer(package, code).splitlines() == ["7.0 7.0"]  # Numba's own default, which is empty
    assert answer(package, code, NUMBA_CACHE_DIR=str(tmp_path / "wanted")).splitlines() == ["7.0 7.0", str(tmp_path / "wanted")]
    (folder,) = (tmp_path / "wanted").iterdir()
    assert folder.name == PREFIX + sources_digest(package)
    assert compiled(folder)


@pytest.mark.validation
def test_processes_that_start_at_once_do_not_disturb_each_other(package: Path) -> None:
    orders = [RUN, RUN.replace("outer(3.0), outer(3)", "outer(3), outer(3.0)")] * 2
    processes = [start(package, code) for code in orders]
    assert [process.communicate()[0].strip() for process in processes] == ["7.0 7.0"] * 4
    (folder,) = (package.parent / "user" / "kernels").glob(f"{PREFIX}*")
    assert {path.suffix for path in folder.rglob("*") if path.is_file()} == {".nbi", ".nbc"}
    assert answer(package) == "7.0 7.0"


def test_forms_compiled_at_once_do_not_take_the_same_name(package: Path) -> None:
    """Each process sees an index without the other's entry; here one process sees it empty twice."""
    code = "from seaglint.outer import outer; outer._cache._cache_file._load_index = dict; print(outer(3.0), outer(3))"
    assert answer(package, code) == "7.0 7.0"
    assert len([name for name in compiled(package.parent) if "outer.outer" in name]) == 2


def test_folders_of_other_sources_go_when_they_are_old_and_many(tmp_path: Path) -> None:
    now = time.time()
    present = tmp_path / f"{PREFIX}present"
    # The present one is old here, and a fresh one more than are kept: neither goes.
    recent = {tmp_path / f"{PREFIX}{n}": 0.5 * IN_USE for n in range(MOST_FOLDERS + 1)}
    ages = {present: 90.0 * IN_USE, tmp_path / f"{PREFIX}old": 1.1 * IN_USE} | recent
    for folder, age in ages.items():
        (folder / "part").mkdir(parents=True)
        os.utime(folder, (now - age, now - age))
    (tmp_path / "another's").mkdir()
    remove_old(present)
    assert {path.name for path in tmp_path.iterdir()} == {"another's", *(folder.name for folder in ages)} - {f"{PREFIX}old"}


def test_old_folders_stay_while_they_are_few(tmp_path: Path) -> None:
    present = tmp_path / f"{PREFIX}present"
    for folder in (present, *(tmp_path / f"{PREFIX}{n}" for n in range(MOST_FOLDERS))):
        folder.mkdir()
        os.utime(folder, (0.0, 0.0))
    remove_old(present)
    assert len(list(tmp_path.iterdir())) == MOST_FOLDERS + 1


def test_the_digest_opens_each_source_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each start of the program waits for it."""
    opened: list[str] = []

    def noted(path: str, mode: str) -> BinaryIO:
        opened.append(path)
        return open(path, mode)  # type: ignore[return-value]

    monkeypatch.setattr(_kernel_cache, "open", noted, raising=False)
    assert len(sources_digest()) == 20
    assert sorted(opened) == sorted(map(str, SOURCE.rglob("*.py")))


def test_a_process_makes_the_digest_once(package: Path) -> None:
    code = (
        "from seaglint.base import kernel_cache as cache; made = []; digest = cache.sources_digest\n"
        "cache.sources_digest = lambda *which: made.append(which) or digest(*which)\n"
        "from seaglint.outer import outer; outer(3.0); outer(3); print(len(made))"
    )
    assert answer(package, code) == "1"


TOGETHER = """
import os, time
from pathlib import Path
from seaglint.outer import outer
ready = Path(os.environ["READY"])
(ready / str(os.getpid())).touch()
while len(list(ready.iterdir())) < 3:
    time.sleep(0.001)
print(outer(3.0))
"""


def test_of_processes_that_begin_together_one_compiles_each_function(package: Path, tmp_path: Path) -> None:
    ready = tmp_path / "ready"
    ready.mkdir()
    processes = [start(package, TOGETHER, READY=str(ready)) for _ in range(3)]
    assert [process.communicate()[0].strip() for process in processes] == ["7.0"] * 3
    assert len(compiled(package.parent)) == 2


def test_nobody_waits_for_a_process_that_was_killed_while_it_compiled(package: Path) -> None:
    holds = (
        "from pathlib import Path; from seaglint.base.kernel_cache import kernel_folder, take_turn; import seaglint.outer, os\n"
        "cache = seaglint.outer.outer._cache._cache_file; folder = kernel_folder()\n"
        "take_turn(folder, os.path.relpath(cache._index_path, folder)); print('held', flush=True); input()"
    )
    holder = start(package, holds)
    assert holder.stdout is not None
    assert holder.stdout.readline() == "held\n"
    waits = (
        "import types, time; from seaglint.base import kernel_cache as _kernel_cache\n"
        "pause = lambda seconds: (print('waits', flush=True), time.sleep(seconds))\n"
        "_kernel_cache.time = types.SimpleNamespace(sleep=pause, monotonic=lambda: 0.0, time=time.time)  # whose patience has no end\n"
        "from seaglint.outer import outer; print(outer(3.0))"
    )
    waiting = start(package, waits)
    assert waiting.stdout is not None
    assert [waiting.stdout.readline() for _ in range(3)] == ["waits\n"] * 3
    holder.kill()
    holder.communicate()
    assert waiting.communicate(timeout=HANG)[0].split()[-1] == "7.0"


def test_nobody_waits_for_a_function_that_could_not_be_compiled(package: Path) -> None:
    fails = (
        "import numba; from seaglint.outer import outer\n"
        "try: outer('text')\n"
        "except numba.errors.TypingError: print('failed', flush=True)\n"
        "input()"
    )
    holder = start(package, fails)
    assert holder.stdout is not None
    assert holder.stdout.readline() == "failed\n"
    refuses = "def sleep(seconds): raise SystemExit('waits')\n"
    waits = f"import types, time; from seaglint.base import kernel_cache as _kernel_cache\n{refuses}_kernel_cache.time.sleep = sleep\n{RUN}"
    assert answer(package, waits) == "7.0 7.0"
    holder.communicate("\n")


def test_the_private_names_of_numba_are_there(package: Path) -> None:
    # a version that renames them must be met here, not by programs that load each other's code
    code = (
        "from seaglint.outer import outer; cache = outer._cache; file = cache._cache_file; outer(3.0);"
        "print(callable(file._data_name), file._index_name, cache.load_overload.__name__, cache.save_overload.__name__, file._data_name(1))"
    )
    callable_name, index, load, save, data = answer(package, code).split()
    assert (callable_name, load, save) == ("True", "load_or_wait", "save_and_end_turn")
    assert index.endswith(".nbi")
    assert data.startswith(index.removesuffix(".nbi"))
    assert data not in {f"{index.removesuffix('.nbi')}.1.nbc", index}


PROSE = '''"""A module
of two lines."""
# ten lines
# of prose


# about
# a kernel

'''


def test_prose_compiles_nothing(package: Path) -> None:
    assert answer(package) == "7.0 7.0"
    before = compiled(package.parent)
    (package / "inner.py").write_text(PROSE + INNER.replace("def inner(x):", 'def inner(x):\n    """Twice a number."""  # why'))
    (package / "outer.py").write_text(PROSE + OUTER.replace("inner(x) + ADDED", "(  # in brackets\n        inner(x) + ADDED\n    )"))
    (package / "base" / "constants.py").write_text('ADDED = 1.0\n"""One [1]."""\n')
    assert answer(package) == "7.0 7.0"
    assert compiled(package.parent) == before
    assert len(list((package.parent / "user" / "kernels").glob(f"{PREFIX}*"))) == 1


def test_file_names_bear_no_lines(package: Path) -> None:
    assert answer(package) == "7.0 7.0"
    (folder,) = (package.parent / "user" / "kernels").glob(f"{PREFIX}*")
    tag = sys.implementation.cache_tag
    assert {path.name for path in folder.glob("*.nbi")} == {f"inner.inner.body.{tag}.nbi", f"outer.outer.{tag}.nbi", "compiling.nbi"}


def test_damaged_digests_are_made_anew(package: Path) -> None:
    digest = "from seaglint.base.kernel_cache import sources_digest; print(sources_digest())"
    first = answer(package, digest)
    (kept,) = (package.parent / "user" / "kernels").glob("syntax-digests-*.json")
    for text in ("{", "[]", ""):
        kept.write_text(text)
        assert answer(package, digest) == first


def test_two_kernels_of_one_name_are_refused(package: Path) -> None:
    (package / "outer.py").write_text(OUTER + OUTER.replace("inner(x) + ADDED", "inner(x) - ADDED"))
    process = subprocess.run(
        [sys.executable, "-c", RUN],
        env={k: v for k, v in os.environ.items() if not k.startswith("NUMBA_")} | {"PYTHONPATH": str(package.parent)},
        capture_output=True,
        text=True,
    )
    assert "kernel seaglint.outer.outer needs a name of its own" in process.stderr


def test_a_kernel_called_with_several_numbers_is_compiled_once(package: Path) -> None:
    code = OUTER.replace("return inner(x) + ADDED", "return inner(0) + inner(1) + inner(2) + ADDED + x")
    (package / "outer.py").write_text(code)
    assert answer(package, "from seaglint.outer import outer; print(outer(3.0))") == "10.0"
    assert len([name for name in compiled(package.parent) if "inner.inner.body" in name]) == 1


def test_a_folder_that_cannot_be_written_is_read(package: Path) -> None:
    """The superuser may write everywhere, so the program is refused instead."""
    assert answer(package) == "7.0 7.0"
    before = compiled(package.parent)
    refused = (
        "import tempfile\ndef refuse(*_, **__): raise PermissionError\n"
        "tempfile.TemporaryFile = refuse; import numba.core.caching as caching\n"
        "caching.IndexDataCacheFile.save = lambda *_: print('written')\n"
    )
    assert answer(package, refused + RUN) == "7.0 7.0"
    assert compiled(package.parent) == before
