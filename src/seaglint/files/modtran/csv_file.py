"""Reader of MODTRAN 6's CSV output (``CSVPRNT``): a line of column names, then numbers, case after case.

Names are those of its spectral library (``total transmittance``, ``path emission``, ...), of its JSON (``TOT_TRANS``, ``THRML_EM``, ...)
or of tape7; see :mod:`seaglint.files.modtran.modtran_spectrum` for the source of either. Lines that frame a case (``case index 0 = {``,
``num freq, 101``, ``}``) and lines of units are passed over: MODTRAN 6 writes them around its tables of flux.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from seaglint.base.errors import DataError
from seaglint.files.modtran.modtran_spectrum import SPECTRAL, Column, ModtranSpectrum, Table, column_of, spectrum_of
from seaglint.files.tables.table_text import cells_of

_FRAME = re.compile(r"^\s*(\}|case\b.*|num \w+.*|#.*|\[.*|\(.*|cm-1\b.*)?$", re.IGNORECASE)

_COUNT = re.compile(r"^\s*num freq\w*\s*[,=:]\s*(\d+)", re.IGNORECASE)


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
            cells = cells_of(path, number, line, remedy="give the CSV file as MODTRAN 6 wrote it")
            cases[-1][2].append([str(number), *cells])
    if not cases:
        raise DataError(f"{path}: has no line of column names (FREQ, TOT_TRANS, ...); give MODTRAN 6's CSV output (CSVPRNT)")
    return [spectrum_of(_table(path, i, *case)) for i, case in enumerate(cases, 1)]


def _table(path: Path, number: int, header: int, labels: list[str], rows: list[list[str]], stated: int | None) -> Table:
    where = f"{path}: case {number}"
    while labels and not labels[-1]:
        labels = labels[:-1]
    if stated is not None and stated != len(rows):
        raise DataError(f"{where}: has {len(rows)} of the {stated} spectral samples that it tells of; the file is cut, give the whole one")
    if not rows:
        raise DataError(f"{where}: has no spectral samples; the file is cut or the run failed, give the whole one")
    columns: dict[Column, list[float]] = {}
    places = {column: k for k, label in reversed(list(enumerate(labels))) if (column := column_of(label)) is not None}
    for line, *cells in rows:
        if len([*cells]) < len(labels):
            raise DataError(f"{where}: line {line}: has {len(cells)} cells for {len(labels)} columns; the file is cut, give the whole one")
        for column, k in places.items():
            try:
                columns.setdefault(column, []).append(float(cells[k]))
            except ValueError:
                told_cell = " ".join(cells[k].split())[:40]
                raise DataError(f"{where}: line {line}: {labels[k]} = '{told_cell}' is not a number; run the case again") from None
    first = int(rows[0][0])
    return Table(path, f"case {number}", {name: np.array(values) for name, values in columns.items()}, tuple(labels), None, first)
