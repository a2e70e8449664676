"""Ozone in files of soundings: the units that are read, and values that speak of another one."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.soundings.raw_sounding import RawSounding, without_missing
from seaglint.files.soundings.sounding_columns import plain_name

#: Units by their plain spelling; ``ppm`` is not among them: files have it by mass and by volume.
UNITS: Final = {
    "ppmv": "ppmv", "mmr": "kg/kg", "mpa": "mPa", "ppbv": "ppbv",
    **dict.fromkeys(("kg_kg", "kg_kg-1", "kg_kg**-1", "kg_kg^-1"), "kg/kg"),
    **dict.fromkeys(("mol_mol", "mol_mol-1", "mol_mol**-1", "mol_mol^-1"), "mol/mol"),
}  # fmt: skip

RANKS: Final = ("ppmv", "kg/kg", "mPa", "ppbv", "mol/mol")  #: Units, the preferred first, where several columns have as many values.

ALLOWED: Final = (
    "ozone_ppmv or ozone_ppbv (parts per million or billion of the volume of air), ozone_mmr (mass mixing ratio, kg/kg) or ozone_mpa (mPa)"
)

MOLAR: Final = 28.9644 / 47.9982  #: Molar mass of air over that of ozone [1].

FURTHER_MISSING: Final = (99.9, 99.99, 9000.0)  #: Further numbers for a missing value in ozonesondes' files.

MOST_PPMV: Final = 20.0  #: Ozone above is no air's [1e-6 of the volume]; the most of the stratosphere is some 12.

MOST_LOW_PPMV: Final = 1.0  #: Ozone above is no air's below the level of :data:`LOW_HPA` [1e-6 of the volume]; foul air has up to 0.4.

#: Ozone of which half of the levels lie below is no air's [1e-6 of the volume]; tropical air over oceans has some 0.01.
LEAST_PPMV: Final = 1e-3

LOW_HPA: Final = 500.0

ROUNDED_PPMV: Final = -1e-3  #: Least value that the packing of gridded analyses explains [1e-6 of the volume].


@dataclass(frozen=True)
class OzoneColumn:
    """A column that holds ozone."""

    place: int  #: Column of the file, from 0.
    name: str  #: Name in the file.
    unit: str  #: One of :data:`RANKS`.

    def in_ppmv(self, values: FloatArray, pressure: FloatArray) -> FloatArray:
        """Values as parts per million of the volume of air, at pressures [hPa].

        >>> OzoneColumn(0, "ozone_mpa", "mPa").in_ppmv(np.array([10.0]), np.array([50.0]))
        array([2.])
        """
        match self.unit:
            case "kg/kg":
                return 1e6 * MOLAR * values
            case "mPa":
                return 10.0 * values / np.where(pressure > 0.0, pressure, np.nan)
            case "ppbv":
                return 1e-3 * values
            case "mol/mol":
                return 1e6 * values
            case _:
                return values


def _is_ozone(plain: str) -> bool:
    return plain.startswith(("ozone", "o3", "go3")) or not {"ozone", "o3"}.isdisjoint(plain.split("_"))


def _base_and_unit(plain: str) -> tuple[str, str | None]:
    """Name without its unit, and that."""
    words = plain.split("_")
    for n in (1, 2):
        unit = UNITS.get("_".join(words[-n:])) if len(words) > n else None
        if unit is not None:
            return "_".join(words[:-n]), unit
    return plain, None


#: Names of the amount of ozone, without its unit; an ozone column of another name is one of errors, currents or flags.
AMOUNTS: Final = frozenset({
    *("ozone", "o3", "go3", "ozone_mixing_ratio", "o3_mixing_ratio", "ozone_partial_pressure", "o3_partial_pressure", "ozone_mass"),
    *("ozone_mass_mixing_ratio", "ozone_volume_mixing_ratio", "mass_fraction_of_ozone_in_air", "mole_fraction_of_ozone_in_air"),
})  # fmt: skip


def ozone_columns(
    path: Path, names: Sequence[str], units: Sequence[str] | None, *, where: str = "", what: str = "column"
) -> list[OzoneColumn]:
    """Return the columns that hold ozone in a known unit, the preferred first.

    Parameters
    ----------
    path : Path
        The file.
    names, units : sequence of str
        Names of the columns, and units that stand apart from them.
    where : str
        Place of the names in the file, with a colon and a blank, for errors.
    what : str
        ``column`` or ``variable``.

    Raises
    ------
    DataError
        Ozone in no known unit, in two units at once, or twice under one name.
    """
    known, unknown = [], []
    plain = [plain_name(name) for name in names]
    apart = units if units is not None and len(units) == len(names) else [""] * len(names)
    for place, name in enumerate(plain):
        if not _is_ozone(name):
            continue
        base, own = _base_and_unit(name)
        beside = UNITS.get(plain_name(re.sub(r"\s+", "_", apart[place].strip())))
        if base not in AMOUNTS or (own or beside) is None:
            unknown.append(place)
            continue
        if own is not None and beside is not None and own != beside:
            raise DataError(
                f"{path}: {where}the {what} {names[place]} is in {own} by its name and in {apart[place]} by its unit; give {ALLOWED}"
            )
        known.append(OzoneColumn(place, names[place], str(own or beside)))
    if unknown and not known:
        place = unknown[0]
        given = f"in '{apart[place].strip()}'" if apart[place].strip() else "in no unit that is known"
        raise DataError(
            f"{path}: {where}the {what} {names[place]} holds ozone {given}; ozone is read as {ALLOWED}: "
            f"name the {what} so with its values in that unit, or leave it out"
        )
    for column in known:
        if plain.count(plain[column.place]) > 1:
            raise DataError(f"{path}: {where}the {what} {plain[column.place]} stands twice; leave one out")
    return sorted(known, key=lambda column: RANKS.index(column.unit))


def with_ozone(raw: RawSounding, columns: Sequence[OzoneColumn], numbers: Mapping[int, FloatArray], *, packed: bool = False) -> RawSounding:
    """Return a sounding with the ozone of its file: of several columns that with most values, the preferred unit first.

    Parameters
    ----------
    raw : RawSounding
        The sounding, at the levels of the columns.
    columns : sequence of OzoneColumn
        Columns of ozone; without any the sounding is returned as it is.
    numbers : mapping
        Values as written, by column of the file.
    packed : bool
        True for analyses, whose packing may make values slightly negative; these are none.
    """
    best: OzoneColumn | None = None
    values = np.full(raw.pressure.size, np.nan)
    for column in columns:
        given = without_missing(numbers[column.place], "humidity")
        if column.unit != "ppbv":
            given[np.isin(given, FURTHER_MISSING)] = np.nan
        if packed:
            ppmv = column.in_ppmv(given, raw.pressure)
            given[(ppmv < 0.0) & (ppmv > ROUNDED_PPMV)] = 0.0
        if best is None or np.isfinite(given).sum() > np.isfinite(values).sum():
            best, values = column, given
    if best is None:
        return raw
    return replace(raw, names=raw.names | {"ozone": best.name}, ozone=values, ozone_unit=best.unit)


def with_ozone_in_ppmv(path: Path, raw: RawSounding) -> RawSounding:
    """Return a sounding, whose pressures were checked, with its ozone in parts per million of the volume.

    Raises
    ------
    DataError
        Values that no air has, with a suspicion of the unit.
    """
    if raw.ozone is None:
        return raw
    column = OzoneColumn(0, raw.names["ozone"], raw.ozone_unit)
    ppmv = column.in_ppmv(raw.ozone, raw.pressure)
    if np.isfinite(ppmv).any():
        _check(path, column, raw.ozone, ppmv, raw.pressure)
    return replace(raw, ozone=ppmv, ozone_unit="ppmv")


def _check(path: Path, column: OzoneColumn, given: FloatArray, ppmv: FloatArray, pressure: FloatArray) -> None:
    """Refuse ozone that no air has."""
    low = pressure > LOW_HPA
    limit = np.where(low, MOST_LOW_PPMV, MOST_PPMV)
    known = np.isfinite(ppmv)
    remedy = f"give {ALLOWED}"
    if np.any(ppmv[known] < 0.0):
        i = int(np.nanargmin(ppmv))
        raise DataError(
            f"{path}: {column.name} holds {given[i]:g} at {pressure[i]:g} hPa; ozone is 0 or more: is it the right column, its unit "
            f"{column.unit}, or a number for missing values? leave such cells empty, or {remedy}"
        )
    over = known & (ppmv > limit)
    if over.any():
        i = int(np.argmax(np.where(over, ppmv / limit, 0.0)))
        raise DataError(
            f"{path}: {column.name} holds {given[i]:g} at {pressure[i]:g} hPa, {ppmv[i]:.3g} ppmv in {column.unit}; at most {limit[i]:g} "
            f"ppmv are allowed there: {_suspicion(column, given[i], pressure[i], float(limit[i]))} {remedy}"
        )
    shown = known & (ppmv > 0.0) & low
    shown = shown if shown.any() else known & (ppmv > 0.0)
    if shown.any() and float(np.median(ppmv[shown])) < LEAST_PPMV:
        i = int(np.argsort(np.where(shown, ppmv, np.inf))[int(shown.sum()) // 2])
        raise DataError(
            f"{path}: {column.name} holds {given[i]:g} at {pressure[i]:g} hPa, {ppmv[i]:.3g} ppmv in {column.unit}; half of its levels lie "
            f"below {LEAST_PPMV:g} ppmv: {_suspicion(column, given[i], pressure[i], MOST_LOW_PPMV)} {remedy}"
        )


def _suspicion(column: OzoneColumn, given: float, pressure: float, limit: float) -> str:
    """Question about the unit in which a value would be some air's."""
    other = [
        unit
        for unit in RANKS
        if unit != column.unit and LEAST_PPMV < float(OzoneColumn(0, "", unit).in_ppmv(np.array([given]), np.array([pressure]))[0]) < limit
    ]
    return f"is its unit {' or '.join(other)}?" if other else "is it the right column and unit?"
