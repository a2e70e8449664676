"""Shared by all rooms: where reference data lie, reproducible property tests, plots without a screen, order of tests, what was skipped."""

from __future__ import annotations

import os
from pathlib import Path

import hypothesis
import matplotlib as mpl
import pytest

from data_folders import FOLDERS, name_folders

mpl.use("Agg")
name_folders()

# A property test's verdict must not depend on the day or on compilation time; new examples are for a developer who asks for them.
hypothesis.settings.register_profile("seaglint", deadline=None, derandomize=True, print_blob=True)
hypothesis.settings.register_profile("explore", deadline=None, max_examples=1000)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "seaglint"))


LONG_FIRST = (
    "test_examples.py",
    "test_documentation.py",
    "test_resolved_mean.py",
    "test_shards.py",
    "test_scattered_images.py",
    "test_averaging_down.py",
    "test_false_alarms.py",
    "test_performance.py",
    "test_autobinomial_fit.py",
    "test_table1.py",
)
"""Files with long tests: what two workers share out last must be short."""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put files of long tests first, each in one piece, where tests are shared out over workers."""
    if not os.environ.get("PYTEST_XDIST_WORKER"):
        return
    rank = {name: number for number, name in enumerate(LONG_FIRST)}
    items.sort(key=lambda item: rank.get(item.path.name, len(rank)))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print why tests were skipped: one line a reason, with the number of tests and their files."""
    reasons: dict[str, list[str]] = {}
    for report in terminalreporter.stats.get("skipped", []):
        text = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
        reasons.setdefault(text.removeprefix("Skipped: "), []).append(report.nodeid.split("::")[0])
    if reasons:
        terminalreporter.section("skipped, and why")
    for reason, files in sorted(reasons.items(), key=lambda pair: -len(pair[1])):
        terminalreporter.write_line(f"{len(files)}: {reason} ({', '.join(sorted(set(files)))})")


def _folder(variable: str) -> Path:
    content = FOLDERS[variable][1]
    value = os.environ.get(variable)
    if not value:
        pytest.skip(f"{variable} is not set: {content} not available")
    folder = Path(value)
    if not folder.is_dir():
        pytest.fail(f"{variable} = {value} is not a folder; unset it or name the folder of {content}")
    return folder


@pytest.fixture(scope="session")
def reference_dir() -> Path:
    """Folder of the LOWTRAN7 and Wu-Smith reference tables; skips where there is none."""
    return _folder("SEAGLINT_REFERENCE_DIR")


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """Folder of measured waves and imagery; skips where there is none."""
    return _folder("SEAGLINT_DATA_DIR")
