"""Spectra as CSV: a sensor's response, the spectrum of a radiometer, and measured and computed spectra of one scene side by side.

The file of a radiometer has a column of wavenumber or wavelength and a column of radiance whose name states its unit.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.formats.tables.table_text import plain_number, read_cell_lines, read_table
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber


def read_response(path: str | Path, *, whole: bool = False) -> Band:
    """Read a CSV file with the columns ``wavelength_um`` and ``response``; lines that begin with ``#`` are comments.

    Zeros at the ends are cut off, unless the ``whole`` table is requested.

    Raises
    ------
    DataError
        Naming the file and the line that cannot be used.
    """
    path = Path(path)
    (head, *rest), _ = read_cell_lines(path, "it needs columns wavelength_um, response", ",")
    try:
        columns = head.cells.index("wavelength_um"), head.cells.index("response")
    except ValueError:
        names = ", ".join(head.cells)
        raise DataError(f"{path}: line {head.number}: columns are {names}; needed are wavelength_um, response") from None
    points: list[tuple[float, float]] = []
    for number, line, row in rest:
        try:
            points.append((plain_number(row[columns[0]]), plain_number(row[columns[1]])))
        except (ValueError, IndexError):
            raise DataError(f"{path}: line {number}: '{line.strip()}' does not hold two numbers; is the file whole?") from None
    try:
        return Band.from_response([p[0] for p in points], [p[1] for p in points], whole=whole)
    except DataError as error:
        raise DataError(f"{path}: {error}") from None


PLACES: Final = ("wavenumber_cm", "wavelength_um")  #: Columns of the spectral place of a sample.

#: Columns of radiance per wavenumber, and their factors to W m-2 sr-1 per cm-1.
PER_CM: Final = {"radiance_w_m2_sr_cm": 1.0, "radiance_mw_m2_sr_cm": 1e-3, "radiance_w_cm2_sr_cm": 1e4}

#: Columns of radiance per wavelength, and their factors to W m-2 sr-1 per um.
PER_UM: Final = {"radiance_w_m2_sr_um": 1.0, "radiance_mw_m2_sr_um": 1e-3, "radiance_w_cm2_sr_um": 1e4}

KELVIN: Final = "brightness_temperature_k"

UNITS: Final = (*PER_CM, *PER_UM, KELVIN)

HOTTEST_K: Final = 6500.0

_RESOLUTION = re.compile(r"resolution(?:_cm)?\s*[:=]\s*([0-9.eE+-]+)")


@dataclass(frozen=True, eq=False)
class MeasuredLight:
    """Spectrum of a radiometer."""

    name: str  #: File, or words for what is no file.
    wavenumber_cm: FloatArray  #: Ascending samples [cm-1, (n,)].
    radiance: FloatArray  #: Radiance [W m-2 sr-1 per cm-1, (n,)].
    unit: str  #: Column that it was read from.
    resolution_cm: float | None  #: Full width at half maximum that the file states [cm-1]; None where it states none.


def read_spectrum(path: str | Path) -> MeasuredLight:
    """Read a spectrum; a column ``resolution_cm`` or a comment ``# resolution_cm: 4`` states its resolution.

    Raises
    ------
    DataError
        A missing or damaged file, a radiance without a unit, negative or missing numbers.
    """
    path = Path(path)
    table = read_table(path, (f"one of {', '.join(PLACES)}", f"one of {', '.join(UNITS)}"))
    place, unit = table.one_of(*PLACES), _unit_of(tuple(table.header), f"{path}: line {table.header_line}")
    where = table.column(place, 1e-3)
    values = table.column(unit, 0.0, HOTTEST_K if unit == KELVIN else np.inf)
    stated = None
    if "resolution_cm" in table.header:
        stated = float(table.column("resolution_cm", 1e-6).max())
    else:
        for comment in table.comments:
            if match := _RESOLUTION.search(comment):
                stated = _positive(match[1], f"{path}: the comment '{comment}'")
    return _spectrum(str(path), place, unit, where, values, stated)


def spectrum_of_columns(columns: Mapping[str, ArrayLike], name: str = "the spectrum") -> MeasuredLight:
    """Return a spectrum from columns of numbers with the names that a file has.

    Raises
    ------
    DataError
        As ``read_spectrum``.

    Examples
    --------
    >>> light = spectrum_of_columns({"wavelength_um": [9.0, 10.0, 11.0], "brightness_temperature_k": [280.0, 281.0, 282.0]})
    >>> light.wavenumber_cm.round(1)
    array([ 909.1, 1000. , 1111.1])
    """
    unit = _unit_of(tuple(columns), name)
    present = [place for place in PLACES if place in columns]
    if len(present) != 1:
        raise DataError(f"{name}: columns are {', '.join(columns)}; give one of {' and '.join(PLACES)}")
    where, values = (np.asarray(columns[key], dtype=np.float64) for key in (present[0], unit))
    if where.ndim != 1 or where.shape != values.shape:
        raise DataError(f"{name}: {present[0]} and {unit} are of shapes {where.shape} and {values.shape}; give two lists of one length")
    for key, column, low in ((present[0], where, 1e-3), (unit, values, 0.0)):
        wrong = ~(np.isfinite(column) & (column >= low))
        if wrong.any():
            raise DataError(f"{name}: {key} holds {column[wrong][0]:g} at place {int(np.argmax(wrong))}; give numbers of {low:g} or more")
    stated = float(np.max(np.asarray(columns["resolution_cm"], dtype=np.float64))) if "resolution_cm" in columns else None
    return _spectrum(name, present[0], unit, where, values, stated)


def _unit_of(names: tuple[str, ...], where: str) -> str:
    """Return the one column of radiance with a known unit."""
    known = [name for name in names if name in UNITS]
    if len(known) == 1:
        return known[0]
    if known:
        raise DataError(f"{where}: columns {' and '.join(known)} are both there; leave one")
    bare = [name for name in names if name.startswith(("radiance", "brightness", "temperature"))]
    fault = f"'{bare[0]}' names no unit that is known" if bare else f"columns are {', '.join(names)}; none is a radiance with its unit"
    raise DataError(f"{where}: {fault}; name the column one of {', '.join(UNITS)}")


def _positive(text: str, where: str) -> float:
    try:
        value = plain_number(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < np.inf:
        raise DataError(f"{where} states no resolution above 0 cm-1; state it in a comment, in cm-1, above 0")
    return value


def _spectrum(name: str, place: str, unit: str, where: FloatArray, values: FloatArray, stated: float | None) -> MeasuredLight:
    nu = where if place == "wavenumber_cm" else 1e4 / where
    order = np.argsort(nu, kind="stable")
    nu, values = nu[order], values[order]
    if nu.size < 3:
        raise DataError(f"{name}: has {nu.size} samples; a spectrum needs at least 3")
    twice = np.flatnonzero(np.diff(nu) <= 0.0)
    if twice.size:
        raise DataError(f"{name}: {place} = {where[order][twice[0]]:g} stands twice; leave one of the two lines")
    if unit in PER_CM:
        light = PER_CM[unit] * values
    elif unit in PER_UM:
        light = PER_UM[unit] * values * 1e4 / nu**2  # |d lambda / d nu| = 1e4 / nu^2, lambda in um and nu in cm-1
    else:
        cold = values <= 0.0  # Planck's law divides by the temperature: 0 K is radiance 0
        light = np.where(cold, 0.0, planck_wavenumber(nu, np.where(cold, 1.0, values)))
    return MeasuredLight(name, nu, light, unit, stated)


class SpectraBeside(NamedTuple):
    """Measured spectrum with ours beside it, by name."""

    title: str  #: Scene.
    label: str  #: Quantity with its unit.
    wavenumber_cm: FloatArray  #: Samples [cm-1, (n,)], ascending; a gap wider than 20 cm-1 separates parts.
    measured: FloatArray  #: Measured quantity [(n,)].
    ours: dict[str, FloatArray]  #: Computed quantity by name [(n,)].
    unit: str = "K"  #: Unit of their difference.
    reference: str = "measured"  #: Name of the measured quantity in a picture.

    def columns(self) -> dict[str, FloatArray]:
        """Return the numbers by column names."""
        return {"wavenumber_cm": self.wavenumber_cm, "measured": self.measured, **self.ours}
