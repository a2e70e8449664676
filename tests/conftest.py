"""Shared by all rooms: where reference data lie, reproducible property tests, plots without a screen, order of tests, what was skipped."""

from __future__ import annotations

import gc
import os
import time
from pathlib import Path

import hypothesis
import matplotlib as mpl
import part_limit
import part_order
import pytest

from data_folders import FOLDERS, name_folders

BEGAN = time.time()
mpl.use("Agg")
name_folders()

# A property test's verdict must not depend on the day or on compilation time; new examples are for a developer who asks for them.
hypothesis.settings.register_profile("seaglint", deadline=None, derandomize=True, print_blob=True)
hypothesis.settings.register_profile("explore", deadline=None, max_examples=1000)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "seaglint"))


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options of a part of the suite."""
    part_limit.add_options(parser)
    part_order.add_options(parser)


def pytest_configure(config: pytest.Config) -> None:
    """Limit the time of a part, note its verdicts, choose and order its tests."""
    part_limit.configure(config, BEGAN)
    part_order.configure(config)


def pytest_collection_finish() -> None:
    """Exempt what was imported and collected from the searches for unused circles of objects, each of which would walk all of it."""
    gc.collect()
    gc.freeze()


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
