"""Folders of finished parts: resumed, replaced, refused; what is not ours, and what a link leads to, stays."""

from __future__ import annotations

from pathlib import Path

import pytest

from seaglint.base.errors import DataError
from seaglint.store.resumable_folder import ResumableFolder

REFUSALS = {"foreign": "not ours", "unfinished": "unfinished"}


def opened(path: Path, *, resume: bool = False, overwrite: bool = False) -> ResumableFolder:
    folder = ResumableFolder(path, "mark")
    folder.open(resume=resume, overwrite=overwrite, **REFUSALS)
    return folder


def test_parts_are_kept_for_resume_and_removed_for_overwrite(tmp_path):
    first = opened(tmp_path / "a")
    first.write_part("one.json", {"x": 1})
    with pytest.raises(DataError, match="unfinished"):
        opened(tmp_path / "a")
    assert opened(tmp_path / "a", resume=True).read_part("one.json") == {"x": 1}
    again = opened(tmp_path / "a", overwrite=True)
    assert again.read_part("one.json") is None
    assert again.is_empty


@pytest.mark.parametrize("overwrite", [False, True])
def test_a_folder_of_somebody_is_refused_and_stays(tmp_path, overwrite):
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "thesis.txt").write_text("mine")
    with pytest.raises(DataError, match="not ours"):
        opened(tmp_path / "a", overwrite=overwrite)
    assert (tmp_path / "a" / "thesis.txt").read_text() == "mine"


def test_a_link_is_not_emptied(tmp_path):
    target = opened(tmp_path / "scratch")
    target.write_part("one.json", 1)
    (tmp_path / "a").symlink_to(tmp_path / "scratch")
    with pytest.raises(DataError, match="is a link"):
        opened(tmp_path / "a", overwrite=True)
    assert target.read_part("one.json") == 1
    assert opened(tmp_path / "a", resume=True).read_part("one.json") == 1
