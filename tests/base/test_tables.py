"""Tables of the documentation: what makes a table older than its code and what does not, and when a number has left its digits."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import table_samples
import tables

LAW = '''"""A law."""

import math
from seaglint.imaging import walk

SHARE = 0.5  # of the whole


def law(x: float) -> float:
    """Return half the sine [1]."""
    import numpy as np

    return SHARE * math.sin(x) + walk.far(np.float64(x))


def other(x: float) -> float:
    return x
'''


def digest(folder: Path, **texts: str) -> str:
    """Digest of modules of these names in a new folder."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for name, text in texts.items():
        (folder / f"{name}.py").write_text(text, encoding="utf-8")
    tables.parts.cache_clear()
    return tables.digest(sorted(folder.iterdir()))


SAME = {
    "comment": ("0.5  # of the whole", "0.5  # of half"),
    "docstring": ("Return half the sine [1].", "Return the sine, halved [1]."),
    "docstring of the module": ('"""A law."""', '"""The law of sines."""'),
    "import": ("from seaglint.imaging import walk", "from seaglint.imaging import walk"),
    "import in a function": ("    import numpy as np", "    import seaglint.numbers as np"),
    "layout": ("SHARE * math.sin(x) + walk.far(np.float64(x))", "(\n        SHARE * math.sin(x)\n        + walk.far(np.float64(x))\n    )"),
}

OTHER = {
    "constant": ("SHARE = 0.5", "SHARE = 0.51"),
    "operator": ("SHARE * math", "SHARE / math"),
    "argument": ("np.float64(x)", "np.float64(SHARE)"),
    "statement more": ("def other", "SHARE += 1\n\n\ndef other"),
}


@pytest.mark.parametrize("change", SAME.values(), ids=SAME)
def test_what_does_not_compute_does_not_age(change: tuple[str, str], tmp_path: Path) -> None:
    assert change[0] in LAW
    assert digest(tmp_path / "a", law=LAW) == digest(tmp_path / "b", law=LAW.replace(*change))


@pytest.mark.parametrize("change", OTHER.values(), ids=OTHER)
def test_what_computes_ages(change: tuple[str, str], tmp_path: Path) -> None:
    assert change[0] in LAW
    assert digest(tmp_path / "a", law=LAW) != digest(tmp_path / "b", law=LAW.replace(*change))


def test_files_may_be_renamed_moved_and_split(tmp_path: Path) -> None:
    head, tail = LAW.split("def other")
    whole = digest(tmp_path / "a", law=LAW, more="def third():\n    return 3\n")
    assert digest(tmp_path / "b", sine=LAW, zero="def third():\n    return 3\n") == whole
    assert digest(tmp_path / "c", sine=head, rest="import math\n\n\ndef other" + tail, third="def third():\n    return 3\n") == whole


def test_other_files_count_by_their_bytes(tmp_path: Path) -> None:
    one, other, renamed = (tmp_path / name for name in ("a.csv", "b.csv", "c.csv"))
    one.write_text("1,2\n")
    other.write_text("1,3\n")
    renamed.write_text("1,2\n")
    assert tables.digest([one]) == tables.digest([renamed]) != tables.digest([other])


def test_a_room_that_is_gone_is_named() -> None:
    with pytest.raises(SystemExit, match=r"no_such_room .*tools/tables.toml"):
        tables.files(["no_such_room"])


AGREE = [
    ("| 3-5 µm | 0.42 |", "| 3-5 µm | 0.42 |"),
    ("0.42 K", "0.4249 K"),
    ("3.7e-04", "3.74e-04"),
    ("1.20 ± 0.02", "1.30 ± 0.03"),
    ("1.20 ± 0.00", "1.21 ± 0.00"),
]
APART = [
    ("0.42 K", "0.43 K"),
    ("0.42 K", "0.42 m"),
    ("+0.5", "-0.5"),
    ("3.7e-04", "3.7e-03"),
    ("1.20 ± 0.02", "1.40 ± 0.03"),
    ("12", "nan"),
    ("1.20 ± 0.02", "nan ± nan"),
]


@pytest.mark.parametrize(("printed", "new"), AGREE)
def test_numbers_within_their_digits_or_errors_agree(printed: str, new: str) -> None:
    assert tables.apart(printed, new) == ""


@pytest.mark.parametrize(("printed", "new"), APART)
def test_numbers_beyond_their_digits_or_errors_are_told(printed: str, new: str) -> None:
    assert tables.apart(printed, new)


EVERY = tables.tables()


@pytest.mark.parametrize("table", EVERY.values(), ids=EVERY)
def test_what_an_entry_names_is_there(table: tables.Table) -> None:
    assert bool(tables.files(table.rooms)) is not table.times
    assert not table.sample or callable(getattr(table_samples, table.sample))
    for place in table.makes:
        assert tables.block(place)[1].group().strip() if "#" in place else list(tables.ROOT.glob(place))
    assert table.stdout in ("", *table.makes)


def test_every_picture_and_file_of_numbers_has_a_table() -> None:
    made = [path for table in tables.tables().values() for place in table.makes if "#" not in place for path in tables.ROOT.glob(place)]
    there = [path for folder in ("images", "data") for path in (tables.ROOT / "docs" / folder).rglob("*") if path.is_file()]
    there += [path for path in (tables.ROOT / "docs" / "_static").iterdir() if path.suffix not in (".css", ".js", ".svg")]
    assert set(there) - {tables.MADE} == set(made)


def test_a_table_is_stale_until_it_is_stamped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tables, "MADE", tmp_path / "made.toml")
    table = tables.tables()["headline"]
    assert tables.stale(table, tables.made())
    assert tables.main(["--stamp", "headline"]) == 0
    assert not tables.stale(table, tables.made())
    assert set(tables.made()["headline"]) == {"commit", "date", "digest"}


def test_a_command_that_fails_leaves_the_table_stale(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tables, "MADE", tmp_path / "made.toml")
    monkeypatch.setattr(tables, "tables", lambda: {"one": tables.Table("one", "exit 3", (), ("optics",))})
    assert tables.main(["one"]) == 1
    assert tables.made() == {}


def test_what_a_command_prints_goes_between_the_markers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tables, "ROOT", tmp_path)
    (tmp_path / "page.md").write_text("a\n<!-- begin one -->\n\n| old |\n\n<!-- end one -->\nb\n")
    assert tables.make(tables.Table("one", "echo '| new |'", (), stdout="page.md#one", by_hand=True))
    assert (tmp_path / "page.md").read_text() == "a\n<!-- begin one -->\n\n| new |\n\n<!-- end one -->\nb\n"


def test_the_list_names_tables_without_failing(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tables, "MADE", tmp_path / "made.toml")
    assert tables.main(["--list", "headline", "times/program"]) == 0
    told = capsys.readouterr().out
    assert "1 of 2 tables" in told
    assert "headline" in told


def test_a_check_fails_where_a_number_has_left_its_digits(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table_samples, "headline", lambda: iter([("0.42 K", "0.42 K"), ("0.17 K", "0.19 K")]))
    assert tables.main(["--check", "headline"]) == 1
    assert "printed 0.17, now 0.19" in capsys.readouterr().out
