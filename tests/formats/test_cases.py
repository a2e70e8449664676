"""Files of cases: what is read, what is refused and how it is said, what is written."""

import numpy as np
import pytest

from seaglint.base.errors import DataError, StorageError
from seaglint.formats.tables.input_tables import Column, read_cases, write_cases


@pytest.fixture
def file(tmp_path):
    def write(content):
        path = tmp_path / "cases.csv"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return write


@pytest.mark.parametrize(
    "content",
    [
        "name,x,y\na,1,2\nb,3,4.5\n",
        b"\xef\xbb\xbfname,x,y\r\na,1,2\r\nb,3,4.5\r\n",
        "name;x;y\na;1;2\nb;3;4.5",
        "name\tx\ty\na\t1\t2\nb\t3\t4.5\n\n\n",
        'name, x ,y\n"a",1, 2\n"b","3","4.5"\n',
    ],
    ids=["plain", "excel", "semicolon", "tab", "quoted"],
)
def test_the_ways_spreadsheets_write(file, content):
    cases = read_cases(file(content))
    assert (cases.header, len(cases), cases.text("name")) == (["name", "x", "y"], 2, ["a", "b"])
    np.testing.assert_array_equal(cases.numbers("x"), [1.0, 3.0])
    np.testing.assert_array_equal(cases.within(Column("y", 0.0, 5.0)), [2.0, 4.5])


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("", "line 1: the file is empty"),
        (b"\xef\xbb\xbf \r\n", "line 1: the file is empty"),
        ("x,y\n", "no cases"),
        ("x,x\n1,2\n", "line 1: column x is there twice"),
        ("x,y\n1,2\n3\n", "line 3: 1 cells under 2 headings"),
        ("x,y\n1,2,3\n", "line 2: 3 cells under 2 headings"),
        ('x,y\n1,2\n"3,4\n', "line 3"),
        (b"x,y\n1,\xe9\n", "not UTF-8"),
        (b"PK\x03\x04\x00\x00", "not text"),
    ],
)
def test_files_that_are_refused(file, content, told):
    path = file(content)
    with pytest.raises(DataError) as error:
        read_cases(path)
    assert str(error.value).startswith(str(path))
    assert told in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file_and_a_folder(tmp_path):
    for path, words in ((tmp_path / "nix.csv", "no such file"), (tmp_path, "cannot be read")):
        with pytest.raises(DataError, match=f"{words}.*give a CSV file"):
            read_cases(path)


@pytest.mark.parametrize(
    ("cell", "told"),
    [("", "is empty"), ("1,5", "decimal point"), ("5 m", "'5 m' is not a number"), ("nan", "'nan'"), ("inf", "'inf'"), ("11", "0 to 10 m")],
)
def test_a_bad_cell_is_named_by_row_line_and_column(file, cell, told):
    # The quoted cell of the first case runs over two lines: lines and rows differ by more than the heading.
    cases = read_cases(file(f'note;height_m\n"two\nlines";5\n;"{cell}"\n;"{cell}"\n'))
    with pytest.raises(DataError) as error:
        cases.within(Column("height_m", 0.0, 10.0, what="m"))
    assert "row 2 (line 4), column height_m: " in str(error.value)
    assert told in str(error.value)
    assert "(1 more row like it)" in str(error.value)


def test_limits_open_and_closed(file):
    cases = read_cases(file("x\n0\n"))
    assert cases.within(Column("x", 0.0, 1.0)) == [0.0]
    with pytest.raises(DataError, match="above 0 to 1"):
        cases.within(Column("x", 0.0, 1.0, above=True))


def test_missing_columns_are_all_named(file):
    with pytest.raises(DataError, match=r"line 1: columns b, c missing; needed: a, b, c; found: a, z"):
        read_cases(file("a,z\n1,2\n")).require(["a", "b", "c"])


def test_cells_pass_through_untouched_and_results_follow_or_replace(file, tmp_path):
    path = file('id;x;old;text\r\n007;1.50;9;"a;b"\r\n 8;2;9;"say ""so"""\r\n')
    output = tmp_path / "out.csv"
    replaced = write_cases(read_cases(path), {"old": np.array([1.0 / 3.0, 2e-7]), "new": ["", "u v"]}, output)
    assert replaced == ["old"]
    assert output.read_bytes().decode() == 'id;x;old;text;new\r\n007;1.50;0.333333;"a;b";\r\n 8;2;2e-07;"say ""so""";u v\r\n'
    assert {p.name for p in tmp_path.iterdir()} == {"cases.csv", "out.csv"}


def test_an_output_is_replaced_only_when_asked_and_left_alone_by_failures(file, tmp_path, monkeypatch):
    cases, output = read_cases(file("x\n1\n")), tmp_path / "out.csv"
    output.write_text("mine")
    with pytest.raises(DataError, match="overwrite=True"):
        write_cases(cases, {"y": ["2"]}, output)

    def full(self, content):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr("pathlib.Path.write_bytes", full)
        with pytest.raises(StorageError, match="no room left"):
            write_cases(cases, {"y": ["2"]}, output, overwrite=True)
    assert output.read_text() == "mine"
    assert {p.name for p in tmp_path.iterdir()} == {"cases.csv", "out.csv"}
    write_cases(cases, {"y": ["2"]}, output, overwrite=True)
    assert output.read_text() == "x,y\n1,2\n"
