"""Reader of wavenumber spectra, at one wind or several: CSV and NetCDF with named columns.

========================================  ==============================================================================================
column                                    meaning
========================================  ==============================================================================================
``wavenumber_rad_m``                      wavenumber k [rad m⁻¹]; or ``wavenumber_cycles_m``, kappa = k/(2 pi) [m⁻¹]
``saturation``                            B = k³ S(k), k in rad/m [1]; this or one of the two next
``elevation_m3``                          height variance per wavenumber, of the unit that the wavenumber has [m³]
``slope_m``                               slope variance per wavenumber, likewise [m]
``wind_speed_m_s``                        neutral wind at 10 m, optional [m s⁻¹]
``delta``                                 ratio Delta of Elfouhaily et al. 1997 (Eq. 49), optional [1]
``half_width_deg``                        angle from the mean direction at which the directional distribution is half its maximum, optional
========================================  ==============================================================================================

A density per rad/m is S(k), with variance ``int S dk``. Beside ``wavenumber_cycles_m`` densities are per cycle/m, ``E(kappa) = 2 pi S(k)``,
so that ``int E dkappa`` is the same variance. Rows may have any order. Units that NetCDF files state are converted, or refused where they
contradict the name (``seaglint.formats.waves.wavenumber_units``).
"""

from __future__ import annotations

import difflib
import logging
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.formats.tables.table_text import read_table
from seaglint.formats.waves.wave_records import open_dataset
from seaglint.formats.waves.wavenumber_units import unit_factor
from seaglint.sea.spectra.saturation import FEWEST, HALF_WIDTHS
from seaglint.sea.spectra.saturation_table import SaturationRow, SaturationTable

log = logging.getLogger(__name__)

WAVENUMBERS: Final = ("wavenumber_rad_m", "wavenumber_cycles_m")
VALUES: Final = ("saturation", "elevation_m3", "slope_m")
WIND: Final = "wind_speed_m_s"
DIRECTIONS: Final = ("delta", "half_width_deg")

_KNOWN: Final = (*WAVENUMBERS, *VALUES, WIND, *DIRECTIONS)
_BARE: Final = ("wavenumber", "wavenumbers", "k", "kappa", "wave_number", "wavenumber_m", "wavenumber_1_m", "k_rad_m", "k_cycles_m")
_NETCDF: Final = (".nc", ".nc4", ".cdf", ".h5", ".zarr", ".zip")

_LOW: Final = {"delta": -1.0, "half_width_deg": float(np.degrees(HALF_WIDTHS[0]))}  # lowest values allowed besides 0
_HIGH: Final = {"delta": 1.0, "half_width_deg": float(np.degrees(HALF_WIDTHS[1]))}


def read_wavenumber_spectra(path: str | Path) -> SaturationTable:
    """Read the wavenumber spectra of a file.

    Returns
    -------
    SaturationTable
        One row per wind, by ascending wind and wavenumber.

    Raises
    ------
    DataError
        A file that cannot be read, columns that are missing, ambiguous or without a unit, values that are missing or negative, a wavenumber
        twice at one wind, or fewer than 3.
    """
    path = Path(path)
    columns = _of_netcdf(path) if path.is_dir() or path.suffix.lower() in _NETCDF else _of_csv(path)
    return SaturationTable(tuple(_row(path, columns, wind) for wind in _winds(columns)), path.name)


def _chosen(path: Path, names: list[str]) -> list[str]:
    """Return the columns to read; refuse those that are missing, ambiguous or without a unit, and report those that are not read."""
    has = ", ".join(names) or "none"
    for name in names:
        if name not in _KNOWN and name.lower() in _KNOWN and name.lower() not in names:
            raise DataError(f"{path}: column '{name}' is unknown; did you mean {name.lower()}? Rename it or leave it out")
    wavenumbers = [name for name in names if name in WAVENUMBERS]
    if not wavenumbers:
        bare = next((name for name in names if name.lower() in _BARE), None)
        what = f"column '{bare}' has no unit that is known" if bare else f"has no column of the wavenumber (columns: {has})"
        raise DataError(f"{path}: {what}; name it wavenumber_rad_m (k = 2 pi/length) or wavenumber_cycles_m (1/length)")
    values = [name for name in names if name in VALUES]
    for group, wanted, what in ((wavenumbers, WAVENUMBERS, "the wavenumber"), (values, VALUES, "the spectrum")):
        if len(group) != 1:
            number = "none" if not group else " and ".join(group)
            raise DataError(f"{path}: of {', '.join(wanted)}, the columns of {what}, it has {number}; give one of them (columns: {has})")
    directions = [name for name in names if name in DIRECTIONS]
    if len(directions) > 1:
        raise DataError(f"{path}: has both {' and '.join(directions)}, two widths of the directions; leave one out")
    unread = [name for name in names if name not in _KNOWN]
    for name in unread:
        near = difflib.get_close_matches(name.lower(), (WIND, *DIRECTIONS), n=1, cutoff=0.7)
        if near and near[0] not in names:
            raise DataError(f"{path}: column '{name}' is unknown; did you mean {near[0]}? Rename it or leave it out")
    if unread:
        log.warning("seaglint: %s: columns that are not read: %s", path, ", ".join(unread))
    return [name for name in names if name in _KNOWN]


def _of_csv(path: Path) -> dict[str, FloatArray]:
    table = read_table(path, (WAVENUMBERS[0], VALUES[0]))
    names = _chosen(path, list(table.header))
    return {name: table.column(name, _LOW.get(name, 0.0), _HIGH.get(name, np.inf)) for name in names}


def _of_netcdf(path: Path) -> dict[str, FloatArray]:
    """Return the columns of NetCDF or a Zarr store: variables over one or two dimensions, as a flat list."""
    import xarray as xr

    with open_dataset(path) as data:
        names = _chosen(path, [str(name) for name in data.variables if data[name].dtype.kind in "fiu"])
        _require_two_dimensions(path, data, names)
        wavenumber = next(name for name in names if name in WAVENUMBERS)
        factors = [unit_factor(path, data, name, wavenumber) for name in names]
        loaded: list[Any] = [data[name].load().reset_coords(drop=True) for name in names]
        columns = [
            factor * np.asarray(part.values, dtype=np.float64).ravel() for factor, part in zip(factors, xr.broadcast(*loaded), strict=True)
        ]
    for name, values in zip(names, columns, strict=True):
        low, high = _LOW.get(name, 0.0), _HIGH.get(name, np.inf)
        bad = ~(np.isfinite(values) & (values >= low) & (values <= high))
        if np.any(bad):
            found = values[bad][0]
            what = "is missing (NaN)" if np.isnan(found) else f"= {found:g} is outside the range allowed: {low:g} to {high:g}"
            what = what.replace(" to inf", " or more")
            # a grid has the same wavenumbers at all winds
            other = f", or give CSV with one row for each measured wavenumber of each {WIND}" if WIND in names else ""
            raise DataError(f"{path}: {name} {what} at {int(bad.sum())} of {values.size} places; leave those wavenumbers out{other}")
    return dict(zip(names, columns, strict=True))


def _require_two_dimensions(path: Path, data: Any, names: list[str]) -> None:
    """Refuse a dimension along which neither the wavenumber nor the wind is given."""
    known = {dim for name in names if name in (*WAVENUMBERS, WIND) for dim in data[name].dims}
    for name in names:
        for dim, size in data[name].sizes.items():
            if dim not in known and size > 1:
                other = "" if WIND in names else f", or add {WIND} along it if it is the wind"
                raise DataError(
                    f"{path}: {name} has the dimension '{dim}' of {size} values beside those of wavenumber and wind; select one, or "
                    f"sum or average over it{other}"
                )


def _winds(columns: dict[str, FloatArray]) -> list[float | None]:
    return list(np.unique(columns[WIND]).tolist()) if WIND in columns else [None]


def _row(path: Path, columns: dict[str, FloatArray], wind: float | None) -> SaturationRow:
    """Return the spectrum of one wind."""
    chosen = np.ones(next(iter(columns.values())).size, bool) if wind is None else columns[WIND] == wind
    name = WAVENUMBERS[0] if WAVENUMBERS[0] in columns else WAVENUMBERS[1]
    order = np.argsort(columns[name][chosen], kind="stable")
    held = {column: values[chosen][order] for column, values in columns.items()}
    given, where = held[name], "" if wind is None else f" at {wind:g} m/s"
    if given.size < FEWEST:
        raise DataError(f"{path}: has {given.size} wavenumbers{where}; give {FEWEST} or more")
    if given[0] <= 0.0:
        raise DataError(f"{path}: {name} = {given[0]:g}{where} is no wave; give wavenumbers above 0")
    twice = given[1:][np.diff(given) == 0.0]
    if twice.size:
        other = "" if wind is not None else f", or add a column {WIND} where they are of several winds"
        raise DataError(f"{path}: {name} = {twice[0]:g}{where} is there twice; leave one out{other}")
    factor = 2.0 * np.pi if name == WAVENUMBERS[1] else 1.0
    k = factor * given
    if "saturation" in held:
        saturation = held["saturation"]
    elif "elevation_m3" in held:
        # densities per cycle/m are 2 pi times those per rad/m
        saturation = k**3 * held["elevation_m3"] / factor
    else:
        saturation = k * held["slope_m"] / factor
    if not np.any(saturation > 0.0):
        raise DataError(f"{path}: its spectrum{where} is 0 everywhere; for a calm sea set sea.spectrum.kind = 'flat'")
    half = held.get("half_width_deg")
    return SaturationRow(k, saturation, wind, held.get("delta"), None if half is None else np.radians(half))
