"""Tables kept on disk: computed once, the same bits when read, and nothing lost where they cannot be kept."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from seaglint.base import table_cache
from seaglint.base.table_cache import cached_table
from seaglint.sea.shadowing.nested import _ratios

NUMBERS = np.array([[0.1, -0.0], [5e-324, np.inf]])


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.setattr(table_cache._settings, "DISABLE_JIT", 0)
    monkeypatch.setattr(table_cache, "kernel_folder", lambda requested: tmp_path)
    return tmp_path


@pytest.fixture
def calls() -> list[int]:
    return []


@pytest.fixture
def table(calls):
    def numbers(number: int) -> np.ndarray:
        calls.append(number)
        return number * NUMBERS

    return cached_table(numbers)


def test_a_table_is_computed_once_and_read_with_the_same_bits(folder, table, calls) -> None:
    first, second, other = table(2), table(2), table(3)
    assert calls == [2, 3]
    assert first.tobytes() == second.tobytes() == (2 * NUMBERS).tobytes()
    assert other.tobytes() == (3 * NUMBERS).tobytes()
    assert len(list(folder.iterdir())) == 2


def test_a_damaged_file_is_replaced(folder, table, calls) -> None:
    table(2)
    (file,) = folder.iterdir()
    file.write_bytes(file.read_bytes()[:-5])
    assert table(2).tobytes() == table(2).tobytes() == (2 * NUMBERS).tobytes()
    assert calls == [2, 2]


def test_a_full_disk_leaves_nothing_behind(folder, table, calls, monkeypatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    assert table(2).tobytes() == table(2).tobytes()
    assert (calls, list(folder.iterdir())) == ([2, 2], [])


def test_without_a_folder_or_compiler_nothing_is_kept(folder, table, calls, monkeypatch) -> None:
    monkeypatch.setattr(table_cache, "kernel_folder", lambda requested: None)
    table(2)
    monkeypatch.setattr(table_cache, "kernel_folder", lambda requested: folder)
    monkeypatch.setattr(table_cache._settings, "DISABLE_JIT", 1)
    table(2)
    assert (calls, list(folder.iterdir())) == ([2, 2], [])


def test_the_name_of_a_file_has_what_bits_depend_on(folder, table, monkeypatch) -> None:
    table(2)
    monkeypatch.setattr(table_cache, "processor", lambda: "another")
    table(2)
    monkeypatch.setattr(np, "__version__", "another")
    table(2)
    assert len(list(folder.iterdir())) == 3


def test_a_table_of_the_sea_is_the_same_read_as_computed(folder) -> None:
    assert _ratios(2).tobytes() == _ratios(2).tobytes() == _ratios.__wrapped__(2).tobytes()  # type: ignore[attr-defined]
