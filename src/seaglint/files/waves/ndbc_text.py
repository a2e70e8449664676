"""Text files of NDBC spectra of every generation: times of their records, and the values of one record by frequency.

Historical files have the frequencies in their headings, realtime files a frequency in brackets after each value. Years have two digits
up to 1998, minutes come in 2005, and from 2007 headings begin with ``#``. Further lines that begin with ``#``, and a line of units, are
skipped. Records may be in any order.

References
----------
NDBC, "Measurement descriptions and units", ndbc.noaa.gov/measdes.shtml.
"""

from __future__ import annotations

import gzip
import re
import zlib
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.ndbc_dates import headings_of, moment_of
from seaglint.files.tables.table_text import plain_number

_PAIR: Final = re.compile(r"(\S+)\s*\(\s*([0-9.]+)\s*\)")
_BRACKET: Final = re.compile(r"\([^)]*\)")
_ABSENT: Final = ("MM", "N/A", "NaN", "nan")


@dataclass(frozen=True)
class SpectralRow:
    """Line of a file after its date: number from 1, text, and the frequencies of its headings, None where they are in the text [Hz]."""

    line: int
    text: str
    frequencies: tuple[float, ...] | None

    @property
    def bands(self) -> int:
        """Return the number of bands."""
        return len(_PAIR.findall(self.text)) if self.frequencies is None else len(self.text.split())


@dataclass(frozen=True, eq=False)
class SpectralText:
    """Records of one text file."""

    path: Path  #: The file.
    times: NDArray[np.datetime64]  #: UTC time of every record.
    rows: tuple[SpectralRow, ...]  #: Their values as text.

    @property
    def historical(self) -> bool:
        """Return true where frequencies are in the headings, as in historical files."""
        return self.rows[0].frequencies is not None

    def record(self, moment: np.datetime64) -> tuple[FloatArray, FloatArray]:
        """Return frequencies [Hz] and values of the record of a time; missing values, however they are written, stay nines or NaN.

        Raises
        ------
        DataError
            No record of that time, two that differ, or a record that is cut or has cells that are no numbers.
        """
        indices = np.flatnonzero(self.times == moment)
        if indices.size == 0:
            raise DataError(
                f"{self.path} has no record of {moment}, which the energy file has; the files do not belong together or one is cut"
            )
        rows = [self.rows[index] for index in indices]
        if len({" ".join(row.text.split()) for row in rows}) > 1:
            lines = ", ".join(str(row.line) for row in rows)
            raise DataError(f"{self.path} has {len(rows)} records of {moment} that differ (lines {lines}); remove all but one")
        return self._values(rows[0])

    def _values(self, row: SpectralRow) -> tuple[FloatArray, FloatArray]:
        """Return frequencies and values of a row."""
        usual = Counter(row.bands for row in self.rows).most_common(1)[0][0]
        if row.frequencies is None:
            pairs, rest = _PAIR.findall(row.text), _PAIR.sub(" ", row.text).split()
            expected, cells, frequencies = usual, [value for value, _ in pairs], [frequency for _, frequency in pairs]
            if len(rest) > 1:  # the separation frequency of energy files
                raise self._unreadable(row.line, f"'{' '.join(rest)}' has no frequency in brackets")
        else:
            cells, frequencies = row.text.split(), [str(value) for value in row.frequencies]
            expected = len(row.frequencies)
        if len(cells) != expected:
            raise self._unreadable(row.line, f"{len(cells)} bands where {expected} are expected")
        try:
            values = [np.nan if cell in _ABSENT else plain_number(cell) for cell in cells]
            return np.array([plain_number(cell) for cell in frequencies]), np.array(values)
        except ValueError as error:
            raise self._unreadable(row.line, " ".join(str(error).split())) from None

    def _unreadable(self, line: int, reason: str) -> DataError:
        return unreadable(self.path, f"line {line}: {reason}")


def unreadable(path: Path, reason: str) -> DataError:
    """Return an error on a file that is cut or of another kind."""
    return DataError(
        f"{path} cannot be read as an NDBC spectral file ({reason}); it may be cut or of another kind: see sea.spectrum.format"
    )


def read_spectral_text(path: Path) -> SpectralText:
    """Read a file, also one packed by gzip.

    Raises
    ------
    DataError
        Headings that are not those of a spectrum, a date that there is not, or no records; with the line.
    """
    content = path.read_bytes()
    if content.startswith(b"\x1f\x8b"):
        try:
            content = gzip.decompress(content)
        except (OSError, EOFError, zlib.error) as error:
            raise DataError(f"{path} cannot be unpacked ({error}); is the file whole?") from None
    lines = [(number, line) for number, line in enumerate(content.decode("utf-8-sig", "replace").splitlines(), 1) if line.strip()]
    if not lines or not headings_of(lines[0][1]):
        raise unreadable(path, "its first line is not headings: YY MM DD hh ...")
    frequencies: tuple[float, ...] | None = None
    dates, times, rows = 4, [], []
    for number, line in lines:
        headings = headings_of(line)
        if headings:
            dates = 5 if headings[4:5] == ["mm"] else 4
            frequencies = _frequencies(path, number, headings[dates:])
            continue
        cells = line.split(maxsplit=dates)
        if cells[0].startswith("#") or cells[0] == "yr":
            continue
        try:
            times.append(np.datetime64(moment_of(cells[:dates])))
        except ValueError:
            raise unreadable(path, f"line {number}: '{' '.join(cells[:dates])[:40]}' is no date and hour") from None
        rows.append(SpectralRow(number, cells[dates] if len(cells) > dates else "", frequencies))
    if not rows:
        raise unreadable(path, "it has no records")
    return SpectralText(path, np.array(times).astype("datetime64[ns]"), tuple(rows))


def _frequencies(path: Path, number: int, names: list[str]) -> tuple[float, ...] | None:
    """Return the frequencies of headings [Hz]; None where each row has its own, in brackets."""
    if any(_BRACKET.search(name) for name in names):
        return None
    try:
        values = tuple(plain_number(name) for name in names)
    except ValueError:
        values = ()
    if not values:
        raise unreadable(path, f"line {number}: the headings '{' '.join(names)[:40]}' are not frequencies; give a file of spectra")
    return values
