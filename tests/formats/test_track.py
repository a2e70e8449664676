"""Keyframes from CSV files."""

import numpy as np
import pytest

from seaglint.base.errors import DataError
from seaglint.formats.tables.input_tables import read_track


def written(tmp_path, text):
    path = tmp_path / "track.csv"
    path.write_text(text)
    return path


def test_columns_in_any_order_with_comments(tmp_path):
    columns, names = read_track(written(tmp_path, "# made by hand\nroll_deg, time_s\n\n5,0\n# turn\n-5,2.5\n"))
    assert names == ["line 4", "line 6"]
    np.testing.assert_array_equal(columns["time_s"], [0.0, 2.5])
    np.testing.assert_array_equal(columns["roll_deg"], [5.0, -5.0])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty; needed are time_s"),
        ("time_s\n0\n", "line 1: columns are time_s; needed are"),
        ("east_m,north_m\n0,0\n", "needed are time_s"),
        ("time_s,roll\n0,0\n", "line 1: 'roll' is an unknown column; did you mean roll_deg?"),
        ("time_s,roll_deg,roll_deg\n0,0,0\n", "a column is named twice"),
        ("time_s,roll_deg\n0,0\n1,nan\n", "line 3: roll_deg = nan is not finite"),
        ("time_s,roll_deg\n0,0\n\n1,inf\n", "line 4: roll_deg = inf is not finite"),
        ("time_s,roll_deg\n0,port\n", "line 2: roll_deg = 'port' is not a number"),
        ("time_s,roll_deg\n0,0\n1\n", "line 3: '1' has 1 cells, the header 2"),
    ],
)
def test_what_cannot_be_used_is_named_by_line(tmp_path, text, words):
    path = written(tmp_path, text)
    with pytest.raises(DataError) as error:
        read_track(path)
    assert words in str(error.value)
    assert str(path) in str(error.value)
    assert "\n" not in str(error.value)


def test_a_missing_file(tmp_path):
    with pytest.raises(DataError, match="no such file"):
        read_track(tmp_path / "none.csv")
