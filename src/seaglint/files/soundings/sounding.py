"""Soundings of the air as people have them: our CSV, University of Wyoming's list and CSV, IGRA version 2, pressure levels of ERA5."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.air.profile.air_profile import AirProfile, saturation_density, sounding_profile
from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.failures import storage_errors
from seaglint.files.soundings.raw_sounding import RawSounding
from seaglint.files.soundings.sounding_checks import DRY_AIR, check_hydrostatics, check_units, virtual_temperature

HIGHEST_FIRST_LEVEL: Final = 500.0
"""Largest height of the lowest level [m]; it is continued to the sea with its own temperature and humidity."""

TOP_M: Final = 100e3
"""Heights above are left out [m]."""

MOST_LEVELS: Final = 2_000_000
"""Largest number of levels that a file may have."""


@dataclass(frozen=True, eq=False)
class Sounding:
    """Sounding from the sea up, as understood.

    Attributes
    ----------
    path, kind : str
        File and format.
    height, pressure, temperature, relative_humidity : ndarray
        Ascending levels from the sea: [m], [hPa], [K], over water [%]; (levels,).
    notes : tuple of str
        What was left out, turned, filled or continued, a sentence each.
    digest : str
        SHA-256 of the file.
    lowest_given : float
        Height of the file's own lowest level [m].
    """

    path: str
    kind: str
    height: FloatArray
    pressure: FloatArray
    temperature: FloatArray
    relative_humidity: FloatArray
    notes: tuple[str, ...]
    digest: str
    lowest_given: float

    def profile(self, model: str) -> AirProfile:
        """Return the profile up to 100 km, continued by a model atmosphere."""
        return sounding_profile(self.path, model, self.height, self.pressure, self.temperature, self.relative_humidity)

    @property
    def provenance(self) -> dict[str, str]:
        """File, format, digest and notes, for results."""
        return {
            "sounding": self.path,
            "sounding_format": self.kind,
            "sounding_sha256": self.digest,
            "sounding_notes": "; ".join(self.notes),
        }


def read_sounding(path: str | Path, place: tuple[float, float] | None = None, time: datetime | None = None) -> Sounding:
    """Read a sounding in any of the formats known.

    Parameters
    ----------
    path : str or Path
        The file.
    place : (float, float), optional
        Latitude and longitude [deg], for files that hold many places.
    time : datetime, optional
        For files that hold many times; without it the first is taken.

    Raises
    ------
    DataError
        In one line: what cannot be used, and what is suspected.
    """
    path = Path(path)
    with storage_errors(path, "give a file that can be read"):
        content = _bytes_of(path)
    raw = _raw(path, content, place, time)
    if raw.pressure.size > MOST_LEVELS:
        raise DataError(f"{path}: has {raw.pressure.size} levels; at most {MOST_LEVELS} are read")
    return _understood(path, raw, hashlib.sha256(content).hexdigest())


def _bytes_of(path: Path) -> bytes:
    if not path.exists():
        raise DataError(f"{path}: no such file; give that of a sounding")
    if path.is_dir():
        raise DataError(f"{path}: is a folder; give the file of a sounding")
    return path.read_bytes()


def _raw(path: Path, content: bytes, place: tuple[float, float] | None, time: datetime | None) -> RawSounding:
    """Rows of the file by the reader of its format."""
    if content[:4] in (b"\x89HDF", b"CDF\x01", b"CDF\x02", b"CDF\x05") or path.suffix.lower() in (".nc", ".nc4"):
        from seaglint.files.soundings.era5_levels import read_era5_levels

        return read_era5_levels(path, place, time)
    from seaglint.files.soundings.sounding_lists import is_igra, is_wyoming_list, read_igra, read_wyoming_list
    from seaglint.files.soundings.sounding_table import read_sounding_table
    from seaglint.files.text_file import read_text

    text = read_text(path, "it needs levels of pressure, height, temperature and humidity")
    lines = text.splitlines()
    if is_igra(lines):
        return read_igra(path, lines, time)
    if is_wyoming_list(lines):
        return read_wyoming_list(path, lines)
    return read_sounding_table(path)


def _understood(path: Path, raw: RawSounding, digest: str) -> Sounding:
    notes = list(raw.notes)
    given = raw.pressure.size
    whole = np.isfinite(raw.pressure) & np.isfinite(raw.temperature) & np.isfinite(raw.humidity_value)
    missing = int(given - whole.sum())
    raw = raw.kept(whole)
    if missing:
        notes.append(f"{missing} of {given} levels have missing values and are left out")
    if raw.pressure.size < 2:
        raise DataError(f"{path}: has {raw.pressure.size} levels with pressure, temperature and humidity; a sounding needs 2 at least")
    if raw.pressure[0] < raw.pressure[-1]:
        raw = raw.kept(np.arange(raw.pressure.size)[::-1])
        notes.append("levels stand from the top down in the file and are turned round")
    check_units(path, raw)
    humidity = raw.relative_humidity()
    raw, humidity, filled = _with_heights(path, raw, humidity)
    if filled:
        notes.append(f"{filled} heights are missing and follow from the pressures")
    if raw.geopotential:
        raw = replace(raw, height=geometric_height(raw.height))
        notes.append("heights are geopotential and are made geometric")
    inside = (raw.height >= 0.0) & (raw.height <= TOP_M)
    if not inside.all():
        notes.append(f"{int((~inside).sum())} levels below the sea or above 100 km are left out")
        raw, humidity = raw.kept(inside), humidity[inside]
    rising = np.concatenate([[True], raw.height[1:] > np.maximum.accumulate(raw.height)[:-1] + 1e-3])
    rising &= np.concatenate([[True], raw.pressure[1:] < np.minimum.accumulate(raw.pressure)[:-1]])
    if not rising.all():
        lost = int((~rising).sum())
        if lost > max(3, rising.size // 4):
            raise DataError(
                f"{path}: {lost} of {rising.size} levels do not rise with falling pressure; is it one ascent, with the right columns?"
            )
        notes.append(f"{lost} levels repeat a height or pressure, or fall back, and are left out")
        raw, humidity = raw.kept(rising), humidity[rising]
    if raw.height.size < 2:
        raise DataError(f"{path}: has no two levels from the sea to 100 km; give heights above the sea in metres")
    check_hydrostatics(path, raw, humidity)
    lowest = float(raw.height[0])
    if lowest > HIGHEST_FIRST_LEVEL:
        raise DataError(
            f"{path}: the lowest level lies at {lowest:.0f} m; it must lie within {HIGHEST_FIRST_LEVEL:g} m of the sea: add a level, "
            "or take a station at the coast"
        )
    height, pressure, kelvin = raw.height, raw.pressure, raw.temperature
    if lowest > 0.0:
        warm = float(virtual_temperature(kelvin[0], pressure[0], humidity[0]))
        at_sea = float(pressure[0]) * math.exp(GRAVITY * lowest / (DRY_AIR * warm))
        height, pressure = np.append(0.0, height), np.append(at_sea, pressure)
        kelvin, humidity = np.append(kelvin[0], kelvin), np.append(humidity[0], humidity)
        if lowest > 2.0:
            notes.append(f"the lowest level, at {lowest:.0f} m, is continued to the sea with its temperature and humidity")
    if height[-1] < 20e3:
        notes.append(f"the sounding ends at {1e-3 * height[-1]:.1f} km; the model atmosphere goes on above")
    return Sounding(str(path), raw.kind, height, pressure, kelvin, humidity, tuple(notes), digest, lowest)


def _with_heights(path: Path, raw: RawSounding, humidity: FloatArray) -> tuple[RawSounding, FloatArray, int]:
    """Fill missing heights hydrostatically between those given."""
    known = np.isfinite(raw.height)
    if known.all():
        return raw, humidity, 0
    if not known.any():
        raise DataError(f"{path}: has no heights; give them for one level at least, in metres above the sea")
    warm = virtual_temperature(raw.temperature, raw.pressure, humidity)
    step = DRY_AIR / GRAVITY * 0.5 * (warm[1:] + warm[:-1]) * np.log(raw.pressure[:-1] / raw.pressure[1:])
    own = np.concatenate([[0.0], np.cumsum(step)])
    if not raw.geopotential:
        own = geometric_height(own)
    offset = np.interp(own, own[known], (raw.height - own)[known])
    return replace(raw, height=np.where(known, raw.height, own + offset)), humidity, int((~known).sum())


def geometric_height(geopotential: FloatArray) -> FloatArray:
    """Height [m] of a geopotential height H [m]: ``R H / (R - H)``, R = 6356.766 km (US Standard Atmosphere 1976, Eq. 19).

    >>> round(float(geometric_height(np.array(10_000.0))), 1)
    10015.8
    """
    radius = 6_356_766.0
    return np.asarray(radius * geopotential / (radius - geopotential))


def humidity_of_dew_point(temperature: FloatArray, dew: FloatArray) -> FloatArray:
    """Relative humidity over water [%] of a dew point [K], with LOWTRAN7's saturation.

    >>> round(float(humidity_of_dew_point(np.array(288.15), np.array(288.15))), 6)
    100.0
    """
    return np.asarray(100.0 * saturation_density(dew) * dew / (saturation_density(temperature) * temperature))
