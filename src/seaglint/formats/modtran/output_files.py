"""Readers of the output of MODTRAN 4 to 6 and of LOWTRAN7: CSV, JSON and tape7, with all cases of a file.

CSV of MODTRAN 6 (``CSVPRNT``): a line of column names, then numbers, case after case. Names are taken from its spectral library
(``total transmittance``, ``path emission``, ...), its JSON (``TOT_TRANS``, ``THRML_EM``, ...) or tape7; see
``seaglint.formats.modtran.modtran_spectrum`` for the source of either. Lines that frame a case (``case index 0 = {``,
``num freq, 101``, ``}``) and lines of units are passed over: MODTRAN 6 writes them around its tables of flux.

JSON of MODTRAN 6 (``JSONPRNT``, ``JSONOPT`` with ``WRT_OUTPUT``): ``MODTRAN[i].MODTRANOUTPUT.SPECTRA.RADIANCE`` (``IRRADIANCE``,
``TRANSMITTANCE``) holds one list a column, named ``TOT_TRANS``, ``THRML_EM``, ``THRML_SCT``, ``SURF_EMIS``, ``MULT_SCAT``,
``SING_SCAT``, ``GRND_RFLT``, ``DRCT_RFLT``, ``TOTAL_RAD``, ``REF_SOL``,
``SOL_AT_OBS``, ``DEPTH``, ... (github.com/brianschubert/pymod6, ``tests/test_io.py`` and ``input/schema.py``); with ``WRT_INPUT`` the
case's ``MODTRANINPUT`` is beside it, with its geometry and spectral grid.

Tape7 (``.tp7``, ``.7sc``, ``tape7.scn``) of MODTRAN 4 and 5 and LOWTRAN7's tape7. Layouts, as the programs write them
(LOWTRAN7: FORMATs 907-937 of ``lowtran7.f``; MODTRAN: subroutine TRANS and T7HEAD, in public copies of its source):

=============  ====  ==========================================================================
program        mode  Fortran format of a row
=============  ====  ==========================================================================
LOWTRAN7       1     ``F7.0,F8.4,1PE9.2,T96,E10.3``
LOWTRAN7       2     ``F7.0,F8.4,1P6E9.2,0P2F8.4,T96,1PE10.3``
LOWTRAN7       3     ``F7.0,F8.4,1P2E9.2,T96,E10.3``
MODTRAN 4      1     ``F8.2,1P,4E11.4,11X,2(11X,E11.4),18X,0P,F8.3``
MODTRAN 4      2     ``F8.2,F11.8,1P,8E11.4,2E9.2,0P,F8.3``
MODTRAN 4, 5   3     ``F8.2,F8.4,1P,2E9.2,T96,E10.3``
MODTRAN 5      2     the same and ``DIR_EM``, ``TOA_SUN``, ``BBODY_T[K]``
=============  ====  ==========================================================================

Columns touch, some are blank, and Fortran drops the E of exponents of three digits (``6.53-144``). So numbers are recognised by Fortran's
grammar, and each belongs to the column whose name ends nearest to its end. Several cases follow one after the other, each with the cards
of its deck before it and ``-9999.`` behind it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.formats.modtran.modtran_spectrum import SPECTRAL, Column, ModtranSight, ModtranSpectrum, Table, column_of, spectrum_of
from seaglint.formats.tables.table_text import cells_of
from seaglint.store.outputs import parsed_json

#: Mode (IEMSCT) by its name in MODTRAN 6.
MODES: Final = {
    "RT_TRANSMITTANCE": 0,
    "RT_THERMAL_ONLY": 1,
    "RT_SOLAR_AND_THERMAL": 2,
    "RT_SOLAR_IRRADIANCE": 3,
    "RT_LUNAR_AND_THERMAL": 2,
    "RT_LUNAR_IRRADIANCE": 3,
}

ENDINGS: Final = (".tp7", ".7sc", ".7sr", ".scn")

#: Largest offset in columns between the end of a number and that of its column's name: names of mode 3 stand up to 2 aside.
FARTHEST: Final = 4

UNNAMED_DEPTH: Final = 105  #: Column in which the optical depth ends (T96, E10.3) where the header does not name it: LOWTRAN7, and mode 3.

_FRAME = re.compile(r"^\s*(\}|case\b.*|num \w+.*|#.*|\[.*|\(.*|cm-1\b.*)?$", re.IGNORECASE)

_COUNT = re.compile(r"^\s*num freq\w*\s*[,=:]\s*(\d+)", re.IGNORECASE)

_SPECTRA: Final = ("RADIANCE", "IRRADIANCE", "TRANSMITTANCE")

_AS_WRITTEN = "give MODTRAN 6's JSON output (JSONOPT = WRT_INPUT_OUTPUT)"

_HEADER = re.compile(r"^\s*(FREQ|WAVLEN)\b")

_LABEL = re.compile(
    r"(?:FREQ|WAVLEN) ?\((?:CM-1|MCRN|uM|NM)\)|WAVLEN MCRN|(?:TOT|PTH|THRML|SURF|SOL|SING|SNGL|GRND|DRCT|TOTAL|REF|TOA|BBODY)[ _]"
    r"(?:TRANS|THRML|SCT|EMIS|SCAT|RFLT|RAD|SOL|SUN|TR|T\[K\])(?![A-Z])|\S+"
)

_NUMBER = re.compile(r"[-+]?(?:\d+\.\d*|\.\d+|\d+(?=\s|$))(?:[EDed][-+]?\d{2}|[-+]\d{3}(?!\d|\.))?")

_END = re.compile(r"^\s*-9999\.?")


def is_csv(text: str) -> bool:
    """Return true where a line of column names separated by commas is among the first lines."""
    return any(_header(line) for line in text.splitlines()[:200])


def _header(line: str) -> bool:
    cells = line.split(",")
    return len(cells) > 1 and column_of(cells[0]) in SPECTRAL


def read_csv(path: Path, text: str) -> list[ModtranSpectrum]:
    """Read all cases of a file, in its order.

    Raises
    ------
    DataError
        Naming file, case and line of what cannot be used.
    """
    cases: list[tuple[int, list[str], list[list[str]], int | None]] = []
    stated: int | None = None
    for number, line in enumerate(text.splitlines(), 1):
        if _header(line):
            cases.append((number, [cell.strip() for cell in line.split(",")], [], stated))
            stated = None
        elif count := _COUNT.match(line):
            stated = int(count.group(1)) if len(count.group(1)) < 10 else None
        elif not _FRAME.match(line):
            if not cases:
                raise DataError(f"{path}: line {number}: numbers before a line of column names; give the CSV file as MODTRAN 6 wrote it")
            cases[-1][2].append([str(number), *cells_of(path, number, line, remedy="give the CSV file as MODTRAN 6 wrote it")])
    if not cases:
        raise DataError(f"{path}: has no line of column names (FREQ, TOT_TRANS, ...); give MODTRAN 6's CSV output (CSVPRNT)")
    return [spectrum_of(_csv_table(path, i, *case)) for i, case in enumerate(cases, 1)]


def _csv_table(path: Path, number: int, header: int, labels: list[str], rows: list[list[str]], stated: int | None) -> Table:
    where = f"{path}: case {number}"
    while labels and not labels[-1]:
        labels = labels[:-1]
    if stated is not None and stated != len(rows):
        raise DataError(f"{where}: has {len(rows)} of the {stated} spectral samples that it tells of; the file is cut, give the whole one")
    if not rows:
        raise DataError(f"{where}: has no spectral samples; the file is cut or the run failed, give the whole one")
    columns: dict[Column, list[float]] = {}
    # Reversed: of several columns of one meaning the first in the file counts.
    places = {column: k for k, label in reversed(list(enumerate(labels))) if (column := column_of(label)) is not None}
    for line, *cells in rows:
        if len(cells) < len(labels):
            raise DataError(f"{where}: line {line}: has {len(cells)} cells for {len(labels)} columns; the file is cut, give the whole one")
        for column, k in places.items():
            try:
                columns.setdefault(column, []).append(float(cells[k]))
            except ValueError:
                shown = " ".join(cells[k].split())[:40]
                raise DataError(f"{where}: line {line}: {labels[k]} = '{shown}' is not a number; run the case again") from None
    return Table(path, f"case {number}", {name: np.array(values) for name, values in columns.items()}, tuple(labels), None, int(rows[0][0]))


def is_json(text: str) -> bool:
    """Return true where a text begins as JSON does."""
    return text.lstrip()[:1] in ("{", "[")


def read_json(path: Path, text: str) -> list[ModtranSpectrum]:
    """Read all cases of a file, in its order.

    Raises
    ------
    DataError
        Naming file, case and key of what cannot be used.
    """
    content = parsed_json(path, text, _AS_WRITTEN)
    cases = content.get("MODTRAN") if isinstance(content, dict) else None
    if not isinstance(cases, list) or not cases:
        raise DataError(f"{path}: has no list MODTRAN of cases; {_AS_WRITTEN}")
    return [_spectrum(path, i, case) for i, case in enumerate(cases, 1)]


def _spectrum(path: Path, number: int, case: Any) -> ModtranSpectrum:
    where = f"{path}: case {number}"
    spectra = _inside(case, "MODTRANOUTPUT", "SPECTRA")
    if not isinstance(spectra, dict):
        raise DataError(f"{where}: has no MODTRANOUTPUT.SPECTRA: it is an input, or the run failed; run it and {_AS_WRITTEN}")
    block = next((spectra[name] for name in _SPECTRA if isinstance(spectra.get(name), dict)), None)
    if block is None:
        raise DataError(f"{where}: MODTRANOUTPUT.SPECTRA holds none of {', '.join(_SPECTRA)}; {_AS_WRITTEN}")
    columns: dict[Column, FloatArray] = {}
    for name, values in [*((k, v) for k, v in spectra.items() if isinstance(v, list)), *block.items()]:
        column = column_of(str(name))
        if column is None or not isinstance(values, list):
            continue
        if not values or not all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
            raise DataError(f"{where}: {name} is no list of numbers; {_AS_WRITTEN}")
        try:
            columns[column] = np.array(values, dtype=np.float64)
        except OverflowError:
            raise DataError(f"{where}: {name} holds a number beyond all bounds; {_AS_WRITTEN}") from None
    size = max((values.size for values in columns.values()), default=0)
    if not any(name in columns for name in SPECTRAL):
        grid = _grid(case, size)
        if grid is not None:
            columns["wavenumber"] = grid
    for column, values in columns.items():
        if values.size != size:
            raise DataError(f"{where}: {column.replace('_', ' ')} has {values.size} of {size} spectral samples; {_AS_WRITTEN}")
    return spectrum_of(Table(path, f"case {number}", columns, tuple(map(str, block)), _json_sight(case)))


def _inside(value: Any, *keys: str) -> Any:
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return value


def _number(value: Any) -> float:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300 else np.nan


def _grid(case: Any, size: int) -> FloatArray | None:
    """Return spectral samples from V1, V2 and DV of the input, in wavenumbers, where the output does not list them."""
    spectral = _inside(case, "MODTRANINPUT", "SPECTRAL")
    low, high, step = (_number(_inside(spectral, key)) for key in ("V1", "V2", "DV"))
    flags = str(_inside(spectral, "FLAGS") or " ")
    if not (np.isfinite([low, high, step]).all() and step > 0.0 and high > low) or flags[:1].upper() not in ("W", " "):
        return None
    return np.asarray(low + step * np.arange(size, dtype=np.float64)) if 1 < size == round((high - low) / step) + 1 else None


def _json_sight(case: Any) -> ModtranSight | None:
    geometry = _inside(case, "MODTRANINPUT", "GEOMETRY")
    mode = MODES.get(str(_inside(case, "MODTRANINPUT", "RTOPTIONS", "IEMSCT")))
    kind = _inside(geometry, "ITYPE")
    height, zenith = _number(_inside(geometry, "H1ALT")), _number(_inside(geometry, "OBSZEN"))
    if mode is None or kind not in (2, 3) or not np.isfinite([height, zenith]).all():
        return None
    end = _number(_inside(geometry, "H2ALT"))
    towards = (_number(_inside(geometry, key)) for key in ("PARM1", "PARM2"))
    azimuth, solar = towards if mode == 2 and _inside(geometry, "IPARM") == 2 else (np.nan, np.nan)
    return ModtranSight(mode, kind, height, zenith, 0.0 if np.isnan(end) else end, azimuth, solar)


@dataclass(frozen=True)
class _Label:
    text: str
    end: int
    column: Column | None


def is_tape7(path: Path, head: str) -> bool:
    """Return true where a text file is a tape7 by its name or its column names."""
    return path.suffix.lower() in ENDINGS or path.name.lower().startswith("tape7") or any(map(_is_header, head.splitlines()))


def _is_header(line: str) -> bool:
    return bool(_HEADER.match(line)) and "," not in line


def read_tape7(path: Path, text: str) -> list[ModtranSpectrum]:
    """Read all cases of a file, in its order.

    Raises
    ------
    DataError
        Naming file, case and line of what cannot be used.
    """
    lines = text.splitlines()
    heads = [i for i, line in enumerate(lines) if _is_header(line)]
    if not heads:
        raise DataError(f"{path}: has no line of column names (FREQ TOT_TRANS ...); give a tape7 of LOWTRAN7 or MODTRAN 4-5")
    spectra, last = [], -1
    for number, head in enumerate(heads, 1):
        stop = heads[number] if number < len(heads) else len(lines)
        end = next((i for i in range(head + 1, stop) if _END.match(lines[i])), None)
        if end is None:
            raise DataError(
                f"{path}: case {number}: ends at line {stop} without -9999., so it is cut short; run it to its end and give the whole file"
            )
        if any(_END.match(line) for line in lines[last + 1 : head]):
            raise DataError(f"{path}: line {head + 1}: a case before case {number} has no spectrum; its run failed: mend its deck")
        spectra.append(spectrum_of(_table(path, number, lines, (head, end), [line for line in lines[last + 1 : head] if line.strip()])))
        last = end
    if any(line.strip() for line in lines[last + 1 :]):
        raise DataError(
            f"{path}: line {last + 2}: something follows case {len(spectra)} that has no spectrum; the last run failed or the file is cut"
        )
    return spectra


def _table(path: Path, number: int, lines: list[str], span: tuple[int, int], cards: list[str]) -> Table:
    head, end = span
    case, labels = f"case {number}", _labels(lines[head])
    first = head + 1
    names = tuple(label.text for label in labels)
    if "H2O" in names:
        raise DataError(
            f"{path}: {case}: is of transmittance mode (IEMSCT = 0), which has no radiance; run it again with IEMSCT = 1, 2 or 3"
        )
    if "LOS" in names:
        raise DataError(f"{path}: {case}: holds several lines of sight side by side (LOS); run them one after the other (IRPT = 1)")
    if first >= end:
        raise DataError(f"{path}: {case}: has no spectral samples; the run failed, so see tape6 and run it again")
    columns: dict[Column, list[float]] = {}
    fields = _Fields()
    for i in range(first, end):
        row = fields.values(lines[i])
        if row is None:
            row = _row(path, case, i, lines[i], labels)
            fields = _Fields.of(lines[i], row)
        columns = columns or {name: [] for name in row}
        if row.keys() != columns.keys():
            odd = sorted(row.keys() ^ columns.keys())
            raise DataError(
                f"{path}: {case}: line {i + 1}: columns differ from the line before ({', '.join(odd)}); "
                "it was cut or edited, so give the file as the program wrote it"
            )
        for name, (value, _) in row.items():
            columns[name].append(value)
    return Table(
        path=path, case=case, columns={name: np.array(values) for name, values in columns.items()}, labels=names, sight=_sight(cards),
        line=first + 1, fine_depth=labels[-1].end == UNNAMED_DEPTH,
    )  # fmt: skip


@dataclass(frozen=True)
class _Fields:
    """Columns of the numbers of a line, which are the same in most lines: these need no parsing by Fortran's grammar."""

    length: int = -1
    ends: tuple[tuple[int, Column | None], ...] = ()

    @classmethod
    def of(cls, line: str, row: dict[Column, tuple[float, int]]) -> _Fields:
        """Return the columns of a line that was parsed by Fortran's grammar."""
        by_end: dict[int, Column | None] = {end: name for name, (_, end) in row.items()}
        return cls(len(line), tuple((match.end(), by_end.get(match.end())) for match in _NUMBER.finditer(line)))

    def values(self, line: str) -> dict[Column, tuple[float, int]] | None:
        """Return values and ends of another line; None where its layout differs."""
        if len(line) != self.length or "_" in line or not line.isascii():
            return None
        result: dict[Column, tuple[float, int]] = {}
        start = 0
        try:
            for end, column in self.ends:
                value = float(line[start:end])
                if column is not None:
                    result[column] = (value, end)
                start = end
        except ValueError:
            return None
        return result if not line[start:].strip() else None


def _labels(header: str) -> list[_Label]:
    labels: list[_Label] = []
    for match in _LABEL.finditer(header):
        column = column_of(match.group())
        if column == "transmittance" and any(label.column == column for label in labels):
            column = None
        labels.append(_Label(match.group(), match.end(), column))
    if {"ATMOS", "SOLAR"} & {label.text for label in labels}:
        labels.append(_Label("DEPTH", UNNAMED_DEPTH, "depth"))
    return labels


def _row(path: Path, case: str, index: int, line: str, labels: list[_Label]) -> dict[Column, tuple[float, int]]:
    """Return values of a line by column and the columns at which they end; blank ones are left out."""
    where = f"{path}: {case}: line {index + 1}"
    rest = _NUMBER.sub(lambda match: " " * len(match.group()), line)
    if rest.strip():
        at = len(rest) - len(rest.lstrip())
        what = "a number that did not fit its column" if "*" in rest else "no number"
        raise DataError(f"{where}: '{rest.strip()[:20]}' at column {at + 1} is {what}; run the case again, or give the file as written")
    values: dict[Column, tuple[float, int]] = {}
    # A column may hold one number a line; a second one shows that blanks were changed.
    taken: dict[int, str] = {}
    for position, match in enumerate(_NUMBER.finditer(line)):
        if position == 0:
            nearest = 0  # the spectral column is the first, and its name may stand anywhere above it
        else:
            nearest = min(range(1, len(labels)), key=lambda k: abs(labels[k].end - match.end()), default=0)
            if nearest == 0 or abs(labels[nearest].end - match.end()) > FARTHEST:
                continue  # LOWTRAN7's transmittances to the Sun have no name
        if nearest in taken:
            raise DataError(
                f"{where}: {taken[nearest]} and {match.group()} both stand in the column {labels[nearest].text}; "
                "blanks were changed, so give the file as the program wrote it"
            )
        taken[nearest] = match.group()
        column = labels[nearest].column
        if column is not None:
            values[column] = (fortran_number(match.group()), match.end())
    return values


def fortran_number(text: str) -> float:
    """Return the value of a number as Fortran prints it.

    >>> fortran_number("6.53-144"), fortran_number("1.5D-03"), fortran_number("2400.")
    (6.53e-144, 0.0015, 2400.0)
    """
    return float(re.sub(r"(?<=[\d.])([-+]\d{3})$", r"E\1", text).replace("D", "E").replace("d", "E"))


def _sight(cards: list[str]) -> ModtranSight | None:
    """Return the geometry from the cards above the column names: mode and kind on card 1, card 3 five lines above, then 3A1 and 3A2."""
    try:
        kind, mode = int(cards[0][5:10]), int(cards[0][10:15])
        # Between card 3 and the column names are cards 3A1, 3A2, 4 and 5.
        card3, card3a2 = cards[-5].ljust(60), cards[-3].ljust(20)
        height, end, zenith = (float(card3[k : k + 10]) for k in (0, 10, 20))
        azimuth, solar = (float(card3a2[k : k + 10]) for k in (0, 10))
    except (IndexError, ValueError):
        return None
    if not (mode in (0, 1, 2, 3) and kind in (1, 2, 3) and 0.0 <= height < 1e3 and 0.0 <= zenith <= 180.0):
        return None
    azimuth, solar = (azimuth, solar) if mode == 2 and cards[-4][:5].strip() in ("2", "12") else (np.nan, np.nan)
    return ModtranSight(mode, kind, height, zenith, end, azimuth, solar)
