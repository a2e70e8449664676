"""Reader of NDBC spectra: five text files of a buoy (realtime or historical), the first of them alone, or NetCDF.

Mean and principal directions alpha1 and alpha2 are where waves come FROM, r1 and r2 the lengths of the two moments. Each file is read by
itself and the moments are taken as they are: a truncated Fourier series of them, as wavespectra builds, has negative energies. Historical
files have r1 and r2 in hundredths.

References
----------
NDBC, "Nondirectional and directional wave data analysis procedures", Technical Document 96-01; ndbc.noaa.gov/measdes.shtml.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.waves.bands import Bands, DirectionalMoments, Plain
from seaglint.files.waves.netcdf_waves import held_by
from seaglint.files.waves.record_choice import WaveChoice
from seaglint.files.waves.wave_file import Held, parsed, reader

SUFFIXES: Final = (".data_spec", ".swdir", ".swdir2", ".swr1", ".swr2")
"""Suffixes of the realtime files of one buoy: energy, mean and principal direction, and the lengths of the two moments."""

_LETTERS: Final = "wdijk"  # the same five of a year or month, after the five letters of the station: 41010w2019.txt
_HISTORICAL: Final = re.compile(r"^(.{5})([wdijk])(.*\.txt(?:\.gz)?)$")
_MISSING: Final = 99.0  # written 999.0 or 999.00, also 99.00; no energy density is as large, and directions go to 360
_DIRECTIONAL: Final = ("mean_wave_dir", "principal_wave_dir", "wave_spectrum_r1", "wave_spectrum_r2")


def read_text(path: Path, choice: WaveChoice) -> Held:
    """Read the records of a buoy's text files, which have many times, so that one must be requested."""
    files = _five(path)
    moment = choice.require_time(str(path))
    table = _read(files[0])
    times = np.asarray(table["time"].values).astype("datetime64[ns]")
    index, _ = choice.nearest_time(times, str(files[0]))
    moment = times[index]
    companions = [file for file in files[1:] if file.is_file()]

    def bands(_moment: int, _place: int) -> Bands:
        frequency = np.asarray(table["freq"].values, dtype=np.float64)
        energy = _column(table, moment, frequency, files[0])
        if np.any(_lacks(energy)):
            raise DataError(f"{files[0]}: the record of {moment} has missing energy; choose another time")
        if not companions:
            return Plain(frequency, energy)
        columns = [_column(_read(file), moment, frequency, file) for file in files[1:]]
        historical = _HISTORICAL.match(files[0].name) is not None
        return _moments(frequency, energy, columns, historical, f"{path} at {moment}")

    return Held(bands, times[index : index + 1], (_station(files[0]),))


def read_netcdf(path: Path) -> Held:
    """Read the records of a buoy's NetCDF file, also as CDIP names them (whose directions are not read)."""
    from seaglint.files.waves.netcdf_waves import open_dataset

    with open_dataset(path) as data:
        density = "spectral_wave_density" if "spectral_wave_density" in data.data_vars else "waveEnergyDensity"
    frequency_name = "frequency" if density == "spectral_wave_density" else "waveFrequency"

    def convert(data: Any) -> Bands:
        frequency = np.asarray(data[frequency_name].values, dtype=np.float64)
        energy = np.asarray(data[density].values, dtype=np.float64)
        if any(name not in data for name in _DIRECTIONAL):
            return Plain(frequency, energy)
        return _moments(frequency, energy, [np.asarray(data[n].values, dtype=np.float64) for n in _DIRECTIONAL], False, str(path))

    return held_by(path, density, convert)


def _station(path: Path) -> str:
    """Return the name of the station, with which NDBC's files begin."""
    historical = _HISTORICAL.match(path.name)
    return historical[1] if historical is not None else path.name.partition(".")[0]


def _five(path: Path) -> list[Path]:
    """Return the names of the five files, from that of any of them or from their common part."""
    historical = _HISTORICAL.match(path.name)
    if historical is not None:
        return [path.with_name(f"{historical[1]}{letter}{historical[3]}") for letter in _LETTERS]
    ending = next((suffix for suffix in SUFFIXES if path.name.endswith(suffix)), None)
    if ending is None and path.is_file():  # energy under a name of the user's own
        return [path, *(path.with_name(path.name + suffix) for suffix in SUFFIXES[1:])]
    base = path.name.removesuffix(ending or "")
    return [path.with_name(base + suffix) for suffix in SUFFIXES]


def _read(file: Path) -> Any:
    """Read one file as an xarray dataset with ``efth(time, freq, dir)``, for any quantity."""
    read = reader("read_ndbc_ascii")
    if not file.is_file():
        raise DataError(
            f"{file} does not exist; a buoy's directional spectrum needs the files {', '.join('NAME' + s for s in SUFFIXES)} beside each "
            "other: bring it, or remove its companions and state from_deg and spreading_deg"
        )
    return parsed(file, "an NDBC spectral file", lambda: read(str(file)))


def _column(table: Any, moment: np.datetime64, frequency: FloatArray, file: Path) -> FloatArray:
    """Return a column of one file at one time, on the frequencies of the energy file."""
    index = np.flatnonzero(np.asarray(table["time"].values) == moment)
    if index.size == 0:
        raise DataError(f"{file} has no record of {moment}, which the energy file has; the files do not belong together or one is cut")
    values = np.asarray(table["efth"].values, dtype=np.float64)[int(index[0])].ravel()
    if values.size != frequency.size or not np.allclose(table["freq"].values, frequency):
        raise DataError(f"{file} has other frequencies than the energy file; the files do not belong together or one is cut")
    return np.asarray(values, dtype=np.float64)


def _lacks(values: FloatArray) -> np.ndarray[Any, np.dtype[np.bool_]]:
    return np.asarray(~np.isfinite(values) | (values >= _MISSING))


def _moments(frequency: FloatArray, energy: FloatArray, columns: list[FloatArray], historical: bool, what: str) -> DirectionalMoments:
    """Return moments from alpha1, alpha2 [deg, from], r1 and r2 [1; historical files: hundredths]."""
    alpha1, alpha2, r1, r2 = columns
    absent = 999.0 if historical else _MISSING
    known = np.all([np.isfinite(c) for c in columns], axis=0) & (alpha1 <= 360.0) & (alpha2 <= 360.0) & (r1 < absent) & (r2 < absent)
    scale = 1.0
    if np.any(r1[known] > 1.0) or np.any(r2[known] > 1.0):
        if not historical or np.any(r1[known] > 100.0) or np.any(r2[known] > 100.0):
            raise DataError(
                f"{what}: r1 or r2 above 1; realtime files have them in 0-1, historical ones (41010w2019.txt) in hundredths: divide by 100"
            )
        scale = 0.01
    first = scale * r1 * np.exp(1j * (np.radians(alpha1) + np.pi))  # from -> to; the second moment does not know the difference
    second = scale * r2 * np.exp(2j * np.radians(alpha2))
    return DirectionalMoments(frequency, energy, *(np.where(known, c, np.nan) for c in (first, second)))
