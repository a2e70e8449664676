"""The version is one, citations and forms of issues are as their schemas have them."""

from __future__ import annotations

import datetime
import re
import subprocess
from pathlib import Path
from typing import Any

import pytest

from seaglint.version import __version__

yaml = pytest.importorskip("yaml", reason="PyYAML is not installed")

ROOT = Path(__file__).resolve().parents[1]
FORMS = sorted(path for path in (ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml") if path.stem != "config")
KINDS = {"markdown", "textarea", "input", "dropdown", "checkboxes"}


def read(path: Path) -> Any:
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def test_the_version_is_the_same_wherever_it_is_written() -> None:
    assert re.fullmatch(r"\d+\.\d+\.\d+", __version__)
    newest = re.search(r"^## (\S+), (.*)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert newest is not None
    assert newest[1] == __version__
    assert read(ROOT / "CITATION.cff")["version"] == __version__
    if newest[2] != "not released yet":
        assert str(read(ROOT / "CITATION.cff")["date-released"]) == newest[2]


def test_tags_of_this_commit_are_its_version() -> None:
    tags = subprocess.run(["git", "tag", "--points-at", "HEAD"], capture_output=True, text=True, cwd=ROOT, check=False)
    if tags.returncode:
        pytest.skip("no git repository")
    assert [tag for tag in tags.stdout.split() if re.match(r"v\d", tag)] in ([], [f"v{__version__}"])


def test_the_citation_has_what_its_format_requires() -> None:
    """Citation File Format 1.2.0: required keys, and of a reference type, title and authors."""
    citation = read(ROOT / "CITATION.cff")
    assert {"cff-version", "message", "title", "authors", "version", "date-released"} <= set(citation)
    assert citation["cff-version"] == "1.2.0"
    assert isinstance(citation["date-released"], datetime.date)
    assert all({"name", "family-names"} & set(author) for author in citation["authors"])
    (article,) = citation["references"]
    assert {"type", "title", "authors", "journal", "year"} <= set(article)
    assert article["type"] == "article"
    assert article["title"] in (ROOT / "docs" / "model.md").read_text(encoding="utf-8")


def test_there_is_a_form_for_each_kind_of_issue() -> None:
    assert [path.stem for path in FORMS] == ["error-unclear", "feature", "number-off"]


@pytest.mark.parametrize("path", FORMS, ids=lambda path: path.stem)
def test_a_form_of_an_issue_is_as_its_schema_has_it(path: Path) -> None:
    form = read(path)
    assert {"name", "description", "body"} <= set(form) <= {"name", "description", "title", "labels", "body"}
    fields = form["body"]
    names = [field["id"] for field in fields if field["type"] != "markdown"]
    assert {field["type"] for field in fields} <= KINDS
    assert len(set(names)) == len(names)
    assert all(re.fullmatch(r"[\w-]+", name) for name in names)
    assert len({field["attributes"]["label"] for field in fields}) == len(fields)
    assert any(field.get("validations", {}).get("required") for field in fields)
    for field in fields:
        assert set(field) <= {"type", "id", "attributes", "validations"}
        assert field["type"] != "checkboxes" or all(option["label"] for option in field["attributes"]["options"])
