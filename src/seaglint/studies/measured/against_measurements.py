"""All measurements and other models that ours is compared with, in one result."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import groupby
from typing import Final

import numpy as np

from seaglint.files.tables.spectra_beside import SpectraBeside
from seaglint.files.tables.table_text import csv_text
from seaglint.studies.measured.buoy_against import buoy_rows
from seaglint.studies.measured.measured_row import MeasuredRow
from seaglint.studies.measured.paths_against import path_rows, sky_rows
from seaglint.studies.measured.shipped import shipped
from seaglint.studies.measured.spectra_against import modtran_path_rows, modtran_sky_rows, scene_rows
from seaglint.studies.measured.spectroscopies import chosen_spectroscopies

#: Tables of the package whose sources are reported.
TABLES: Final = ("aeri", "his", "iris", "modtran_sky", "modtran_path", "rrtmgp_paths", "rrtmgp_skies", "cdip_spectrum", "cdip_bands")


@dataclass(frozen=True)
class AgainstMeasurements:
    """Measurements beside ours: rows of numbers, and spectra."""

    rows: tuple[MeasuredRow, ...]
    spectra: tuple[SpectraBeside, ...]

    def csv(self) -> str:
        """Return the rows as CSV behind lines that name the sources."""
        head = "".join(f"# {name}: {shipped(name).facts['source']}; {shipped(name).facts['terms']}\n" for name in TABLES)
        names = [field.name for field in fields(MeasuredRow)]
        cells = [[_cell(getattr(row, name)) for name in names] for row in self.rows]
        return head + csv_text([names, *cells])

    def lines(self) -> list[str]:
        """Return the rows as a text table, case by case, each with the sentence on what is left."""
        out = []
        for (case, spectroscopy), group in groupby(self.rows, key=lambda row: (row.case, row.spectroscopy)):
            rows = list(group)
            out.append(f"{case}{f', {spectroscopy}' if spectroscopy else ''}")
            head = ("", "ours", "measured", "unit", "diff. %", "diff. K", "rms", "uncertainty")
            out.append(_aligned(head))
            for row in rows:
                numbers = (_number(row.ours, row.unit), _number(row.measured, row.unit), row.unit)
                rest = (_fixed(row.difference_percent, 1), _fixed(row.difference_k, 2), _size(row.rms, row.unit))
                out.append(_aligned((row.quantity, *numbers, *rest, row.uncertainty)))
            out += [f"  {reason}" for reason in dict.fromkeys(row.reason for row in rows)] + [""]
        return out[:-1]


def against_measurements(spectroscopy: str = "both") -> AgainstMeasurements:
    """Compute all that was measured, with ``lblrtm``, ``lowtran7`` or ``both``.

    Raises
    ------
    DomainError
        Another word.
    """
    chosen = chosen_spectroscopies(spectroscopy)
    rows: list[MeasuredRow] = []
    spectra: list[SpectraBeside] = []
    for compute in (scene_rows, modtran_sky_rows, modtran_path_rows):
        some, beside = compute(chosen)
        rows += some
        spectra += beside
    rows += [*path_rows(chosen), *sky_rows(chosen), *buoy_rows()]
    return AgainstMeasurements(tuple(rows), tuple(spectra))


_WIDTHS: Final = (28, 9, 9, 4, 8, 8, 7)


def _aligned(cells: Sequence[str]) -> str:
    first, *middle = (f"{cell:>{width}}" for cell, width in zip(cells[:-1], _WIDTHS, strict=True))
    return " ".join(["  " + first.strip().ljust(_WIDTHS[0]), *middle, " " + cells[-1]]).rstrip()


def _number(value: float, unit: str) -> str:
    return f"{value:.2f}" if unit == "K" else f"{value:.4g}"


def _fixed(value: float | None, digits: int) -> str:
    return "-" if value is None or np.isnan(value) else f"{value:+.{digits}f}"


def _size(value: float | None, unit: str) -> str:
    return "-" if value is None or np.isnan(value) else f"{value:.{3 if unit == '1' else 2}f}"


def _cell(value: object) -> object:
    if isinstance(value, float):
        return "" if np.isnan(value) else f"{value:.6g}"
    return "" if value is None else value
