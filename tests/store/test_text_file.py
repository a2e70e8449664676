"""Text and JSON files: read or refused in one line, written as they are."""

from __future__ import annotations

import pytest

from seaglint.base.errors import DataError
from seaglint.formats.tables.table_text import csv_text, read_rows, write_rows
from seaglint.store.outputs import read_json, read_text, write_json, write_text


@pytest.mark.parametrize("text", ["", "a\r\nb\n", "µm"])
def test_a_text_comes_back(tmp_path, text: str) -> None:
    write_text(text, tmp_path / "a.txt")
    assert read_text(tmp_path / "a.txt", "") == text


def test_the_mark_of_other_programs_is_left_out(tmp_path) -> None:
    (tmp_path / "a.txt").write_bytes(b"\xef\xbb\xbfa")
    assert read_text(tmp_path / "a.txt", "") == "a"


def test_a_value_comes_back(tmp_path) -> None:
    value = {"µ": [1, 2.5, None, True], "b": {}}
    write_json(value, tmp_path / "a.json")
    assert read_json(tmp_path / "a.json", "") == value


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "no such file"),
        (b"\xff", "is not UTF-8 text (byte 0)"),
        (b'{"a": 1,\n "b"', "is no JSON, or is cut short (line 2"),
        (b"[" * 100_000, "is no JSON, or is cut short (a number or its nesting"),
        (b"9" * 5000, "is no JSON, or is cut short (a number or its nesting"),
    ],
    ids=["missing", "no text", "cut", "nested", "long number"],
)
def test_what_cannot_be_read_is_told_in_one_line(tmp_path, content: bytes | None, words: str) -> None:
    path = tmp_path / "a.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(DataError) as caught:
        read_json(path, "give another")
    message = str(caught.value)
    assert message.startswith(f"{path}: {words}")
    assert message.endswith("; give another")
    assert "\n" not in message


def test_a_folder_is_no_file(tmp_path) -> None:
    with pytest.raises(DataError, match=r"cannot be read \(Is a directory\); give another"):
        read_text(tmp_path, "give another")


def test_rows_come_back_as_texts(tmp_path) -> None:
    write_rows([{"a": 1.5, "b": 'say "so", then\nleave'}, {"a": None, "b": True}], tmp_path / "a.csv")
    assert read_rows(tmp_path / "a.csv") == [{"a": "1.5", "b": 'say "so", then\nleave'}, {"a": "", "b": "True"}]


def test_cells_are_quoted_where_they_must_be() -> None:
    assert csv_text([("a", "b;c"), (1, None)], separator=";", line_end="\r\n") == 'a;"b;c"\r\n1;\r\n'
