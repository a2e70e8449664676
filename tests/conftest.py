"""Shared by all rooms: where reference data lie, reproducible property tests, plots without a screen."""

from __future__ import annotations

import os
from pathlib import Path

import hypothesis
import matplotlib as mpl
import pytest

mpl.use("Agg")

# A property test's verdict must not depend on the day or on compilation time; new examples are for a developer who asks for them.
hypothesis.settings.register_profile("seaglint", deadline=None, derandomize=True, print_blob=True)
hypothesis.settings.register_profile("explore", deadline=None, max_examples=1000)
hypothesis.settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "seaglint"))


def _folder(variable: str, content: str) -> Path:
    value = os.environ.get(variable)
    if not value:
        pytest.skip(f"{variable} is not set: {content} not available")
    folder = Path(value)
    if not folder.is_dir():
        pytest.fail(f"{variable} = {value} is not a folder; unset it or name the folder of {content}")
    return folder


@pytest.fixture(scope="session")
def reference_dir() -> Path:
    """Folder of the LOWTRAN7 and Wu-Smith reference tables; skips where it is not given."""
    return _folder("SEAGLINT_REFERENCE_DIR", "reference tables")


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """Folder of measured waves and imagery; skips where it is not given."""
    return _folder("SEAGLINT_DATA_DIR", "measured waves and imagery")
