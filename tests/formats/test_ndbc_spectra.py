"""NDBC's text spectra of every generation: years, minutes, headings, nines, order and units give the sea that was written."""

from __future__ import annotations

import gzip
import random
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from wave_files import FREQUENCY, FROM, POWER, energy

from seaglint.base.errors import DataError
from seaglint.formats.waves import WaveChoice, read_waves

R1, R2 = POWER / (POWER + 1), POWER * (POWER - 1) / ((POWER + 1) * (POWER + 2))
THEN = np.datetime64("1996-06-01T03:00")
LETTERS = dict(zip("wdijk", (".data_spec", ".swdir", ".swdir2", ".swr1", ".swr2"), strict=True))


@dataclass(frozen=True)
class Layout:
    """How a buoy's five files are written."""

    digits: int = 2
    minutes: bool = False
    sign: str = ""
    units: bool = False
    packed: bool = False
    realtime: bool = False
    hundredths: bool = True
    nines: tuple[str, ...] = ()
    order: str = "ascending"
    midnight: bool = False
    then: np.datetime64 = THEN
    height: float = 2.0

    def write(self, folder: Path) -> Path:
        """Write five records, three hours apart; the second has the sea, the others half its height and turned round."""
        moments = [self.then + np.timedelta64(3 * i, "h") for i in (-1, 0, 1, 2, 3)]
        rows = list(enumerate(moments))
        if self.order == "descending":
            rows.reverse()
        elif self.order == "shuffled":
            random.Random(1).shuffle(rows)
        elif self.order == "doubled":
            rows = [rows[1], *rows]
        scale = 100.0 if self.hundredths and not self.realtime else 1.0
        for letter in LETTERS:
            lines = [self._headings(letter)] + (["#yr  mo dy hr mn" if self.sign else "yr mo dy hr mn"] if self.units else [])
            for number, moment in rows:
                good = number == 1
                values = {
                    "w": (self.height / 2.0) ** 2 * energy() * (1.0 if good else 0.25),
                    "d": np.full(FREQUENCY.size, FROM if good else (FROM + 180.0) % 360.0),
                    "i": np.full(FREQUENCY.size, FROM),
                    "j": np.full(FREQUENCY.size, R1 * scale),
                    "k": np.full(FREQUENCY.size, R2 * scale),
                }[letter]
                lines.append(f"{self._date(moment)} {self._cells(letter, values)}")
            text = "\n".join(lines) + "\n"
            name = f"46042{LETTERS[letter]}" if self.realtime else f"46042{letter}1996.txt"
            if self.packed:
                (folder / f"{name}.gz").write_bytes(gzip.compress(text.encode()))
            else:
                (folder / name).write_text(text)
        return folder / (("46042.data_spec" if self.realtime else "46042w1996.txt") + (".gz" if self.packed else ""))

    def _headings(self, letter: str) -> str:
        year = "YYYY" if self.digits == 4 and not self.sign else "YY"
        bands = " ".join(f"{f:.5f}".lstrip("0") for f in FREQUENCY)
        if self.realtime:
            bands = "Sep_Freq  < spec_1 (freq_1) spec_2 (freq_2) ... >" if letter == "w" else "alpha1_1 (freq_1) ... >"
        return f"{self.sign}{year} MM DD hh {'mm ' if self.minutes else ''}{bands}"

    def _date(self, moment: np.datetime64) -> str:
        at = moment.astype("datetime64[m]").item()
        hour = at.hour
        if self.midnight and (hour, at.minute) == (0, 0):
            at, hour = (moment - np.timedelta64(1, "D")).astype("datetime64[m]").item(), 24
        year = f"{at.year % 100:02d}" if self.digits == 2 else str(at.year)
        return f"{year} {at.month:02d} {at.day:02d} {hour:02d}" + (f" {at.minute:02d}" if self.minutes else "")

    def _cells(self, letter: str, values: np.ndarray) -> str:
        cells = [f"{value:.4f}" for value in values]
        if letter != "w":
            for i, code in enumerate(self.nines):
                cells[i] = code  # bands without energy, as at the low end of a real record
        if self.realtime:
            cells = [f"{cell} ({f:.5f})" for cell, f in zip(cells, FREQUENCY, strict=True)]
        return ("9.999 " if self.realtime and letter == "w" else "") + " ".join(cells)


def check(layout: Layout, folder: Path) -> None:
    found = read_waves(layout.write(folder), WaveChoice(layout.then))
    sea = found.spectrum
    assert found.report["format"] == "ndbc"
    assert found.report["time"] == f"{layout.then.astype('datetime64[s]')}Z"
    assert sea.significant_height() == pytest.approx(layout.height, rel=0.01)
    mean = np.average(sea.first, weights=sea.energy * np.gradient(sea.frequency_hz))
    assert np.degrees(np.angle(-mean)) % 360.0 == pytest.approx(FROM, abs=0.5)
    assert np.degrees(np.sqrt(2.0 * (1.0 - abs(mean)))) == pytest.approx(30.0, abs=0.2)
    assert np.degrees(np.angle(sea.second)) % 360.0 == pytest.approx((2.0 * FROM) % 360.0, abs=0.5)


@pytest.mark.parametrize(
    "layout",
    [
        Layout(),
        Layout(digits=4),
        Layout(sign="#", minutes=True),
        Layout(sign="# ", minutes=True, digits=4, units=True),
        Layout(units=True),
        Layout(packed=True),
        Layout(realtime=True, sign="#", minutes=True, digits=4),
        Layout(realtime=True, sign="#", minutes=True, packed=True),
        Layout(then=np.datetime64("2004-02-29T12:00")),
        Layout(then=np.datetime64("1970-01-01T00:00")),
        Layout(then=np.datetime64("2000-01-01T00:00"), midnight=True),
        Layout(then=np.datetime64("2000-01-01T00:00"), order="descending"),
        Layout(order="shuffled", nines=("999.0", "999.00", "MM")),
        Layout(order="doubled"),
        Layout(hundredths=False),
        Layout(height=14.0),  # a storm: densities above 99 m2/Hz are no missing values
    ],
)
def test_every_generation_gives_its_sea(layout: Layout, tmp_path: Path) -> None:
    check(layout, tmp_path)


def drawn(rnd: random.Random) -> Layout:
    year = rnd.choice([1979, 1989, 1996, 1999, 2000, 2001, 2004, 2023])
    then = np.datetime64(f"{year}-{rnd.randint(1, 12):02d}-{rnd.randint(1, 28):02d}T{3 * rnd.randint(0, 7):02d}:00")
    realtime = rnd.random() < 0.3
    return Layout(
        digits=rnd.choice([2, 4]),
        minutes=realtime or rnd.random() < 0.5,
        sign=rnd.choice(["", "#", "# "]),
        units=rnd.random() < 0.3,
        packed=rnd.random() < 0.3,
        realtime=realtime,
        hundredths=rnd.random() < 0.7,
        nines=tuple(rnd.choice(["999.0", "999.00", "9999.0", "MM"]) for _ in range(rnd.randint(0, 6))),
        order=rnd.choice(["ascending", "descending", "shuffled", "doubled"]),
        midnight=rnd.random() < 0.3,
        then=then,
    )


@pytest.mark.parametrize("hundred", range(3))
def test_random_layouts_give_their_sea(hundred: int, tmp_path: Path) -> None:
    for number in range(100 * hundred, 100 * (hundred + 1)):
        folder = tmp_path / str(number)
        folder.mkdir()
        check(drawn(random.Random(number)), folder)


def rewritten(path: Path, old: str, new: str) -> Path:
    path.write_text(path.read_text().replace(old, new))
    return path


@pytest.mark.parametrize(
    ("layout", "spoil", "match"),
    [
        (Layout(), lambda p: rewritten(p, "96 06 01 03", "96 13 01 03"), r"line 3: '96 13 01 03' is no date and hour"),
        (Layout(), lambda p: rewritten(p, "96 06 01 03", "196 06 01 03"), r"line 3: '196 06 01 03' is no date and hour"),
        (
            Layout(),
            lambda p: rewritten(p, "96 06 01 06", "96 06 01 03"),
            r"2 records of 1996-06-01T03:00.* differ \(lines 3, 4\); remove all",
        ),
        (Layout(), lambda p: rewritten(p, "YY MM DD hh .04000", "YY MM DD hh WVHT"), r"are not frequencies; give a file of spectra"),
        (Layout(), lambda p: rewritten(p, "YY MM DD hh .04000", "YY MM DD hh"), r"36 bands where 35 are expected"),
        (Layout(), lambda p: rewritten(p.with_name("46042j1996.txt"), f"{100 * R1:.4f}", f"{R1:.4f}") and p, r"neither 0-1 nor hundredths"),
        (Layout(), lambda p: rewritten(p.with_name("46042j1996.txt"), f"{100 * R1:.4f}", "-0.5") and p, r"r1 or r2 is negative"),
        (Layout(realtime=True), lambda p: rewritten(p.with_suffix(".swr1"), f"{R1:.4f}", "87.2") and p, r"divide by 100"),
    ],
)
def test_what_cannot_be_meant_is_refused_in_one_line(layout: Layout, spoil, match: str, tmp_path: Path) -> None:
    with pytest.raises(DataError, match=match) as caught:
        read_waves(spoil(layout.write(tmp_path)), WaveChoice(THEN))
    assert "\n" not in str(caught.value)


def test_a_bad_line_elsewhere_is_left_out_and_told(tmp_path: Path) -> None:
    path = rewritten(Layout().write(tmp_path), "96 06 01 09", "96 06 31 09")
    result = read_waves(path, WaveChoice(THEN))
    assert result.spectrum.significant_height() == pytest.approx(2.0, rel=0.01)
    assert result.report["note"] == "1 of 5 records left out; line 5: '96 06 31 09' is no date and hour"
    path.write_text(path.read_text().replace("96 06 01 ", "96 06 00 "))
    with pytest.raises(DataError, match=r"5 of 5 records have no date; line 2: "):
        read_waves(path, WaveChoice(THEN))


def test_years_joined_in_one_file_have_their_own_headings(tmp_path: Path) -> None:
    """Files of two years one after the other, the first with two digits and no minutes."""
    old, new = Layout(), replace(Layout(digits=4, minutes=True, sign="#"), then=np.datetime64("2010-06-01T03:00"))
    (tmp_path / "new").mkdir()
    path, later = old.write(tmp_path), new.write(tmp_path / "new")
    for letter in LETTERS:
        first, second = path.with_name(f"46042{letter}1996.txt"), later.with_name(f"46042{letter}1996.txt")
        first.write_text(first.read_text() + second.read_text())
    for layout in (old, new):
        sea = read_waves(path, WaveChoice(layout.then)).spectrum
        assert sea.significant_height() == pytest.approx(2.0, rel=0.01)
