"""Reader of NDBC spectra: five text files of a buoy (realtime or historical), the first of them alone, or NetCDF, also MHKiT's.

Mean and principal directions alpha1 and alpha2 are where waves come FROM, r1 and r2 the lengths of the two moments. Each file is read by
itself and the moments are taken as they are: a truncated Fourier series of them, as wavespectra builds, has negative energies. Historical
text files have r1 and r2 in hundredths, all others in 0-1.

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
from seaglint.files.waves.bands import Bands, Plain
from seaglint.files.waves.buoy_moments import energy_known, moments_of
from seaglint.files.waves.buoy_netcdf import degrees_of, energy_of, frequency_of, from_degrees_of, length_unit_of, numbers_of
from seaglint.files.waves.ndbc_text import SpectralText, read_spectral_text
from seaglint.files.waves.netcdf_waves import held_by
from seaglint.files.waves.record_choice import WaveChoice
from seaglint.files.waves.wave_file import Held, parsed

#: Suffixes of the realtime files of one buoy: energy, mean and principal direction, and the lengths of the two moments.
SUFFIXES: Final = (".data_spec", ".swdir", ".swdir2", ".swr1", ".swr2")

_LETTERS: Final = "wdijk"  # the same five of a year or month, after the five letters of the station: 41010w2019.txt
_HISTORICAL: Final = re.compile(r"^(.{5})([wdijk])(.*\.txt(?:\.gz)?)$")
_NDBC: Final = ("spectral_wave_density", "mean_wave_dir", "principal_wave_dir", "wave_spectrum_r1", "wave_spectrum_r2")

#: Variables of MHKiT's files: energy, mean and principal direction, and the lengths of the two moments.
MHKIT: Final = ("swden", "swdir", "swdir2", "swr1", "swr2")


def read_text(path: Path, choice: WaveChoice) -> Held:
    """Read the records of a buoy's text files, which have many times, so that one must be requested."""
    files = _five(path)
    moment = choice.require_time(str(path))
    table = _read(files[0])
    index, _ = choice.nearest_time(table.times, str(files[0]))
    moment = table.times[index]
    companions = [file for file in files[1:] if file.is_file()]

    def bands(_moment: int, _place: int) -> Bands:
        frequency, values = table.record(moment)
        energy = energy_known(values)
        if not np.all(np.isfinite(energy)):
            raise DataError(f"{files[0]}: the record of {moment} has missing energy; choose another time")
        if not companions:
            return Plain(frequency, energy)
        alpha1, alpha2, r1, r2 = (_column(_read(file), moment, frequency) for file in files[1:])
        return moments_of(frequency, energy, (alpha1, alpha2, r1, r2), "unknown" if table.historical else "ones", f"{path} at {moment}")

    return Held(bands, table.times[index : index + 1], (_station(files[0]),))


def read_netcdf(path: Path) -> Held:
    """Read the records of a buoy's NetCDF file."""
    return _read_netcdf(path, _NDBC)


def read_mhkit(path: Path) -> Held:
    """Read the records of NetCDF with the names of MHKiT's ``wave.io.ndbc.request_directional_data``.

    MHKiT divides r1 and r2 by 100 and keeps NDBC's nines, so that a missing one is 9.99.
    """
    return _read_netcdf(path, MHKIT)


def _read_netcdf(path: Path, names: tuple[str, str, str, str, str]) -> Held:
    """Read NetCDF whose five variables have the names of energy, alpha1, alpha2, r1 and r2."""
    density, alpha1, alpha2, r1, r2 = names

    def convert(data: Any) -> Bands:
        frequency, energy = frequency_of(data, "frequency", path), energy_known(energy_of(data, density, path).ravel())
        if any(name not in data.variables for name in names[1:]):
            return Plain(frequency, energy)
        unit = length_unit_of(data, (r1, r2), path)
        lengths = numbers_of(data, r1).ravel(), numbers_of(data, r2).ravel()
        directions = from_degrees_of(data, alpha1, path).ravel(), degrees_of(data, alpha2, path).ravel()
        return moments_of(frequency, energy, (*directions, *lengths), unit, str(path))

    return held_by(path, density, convert)


def is_common_part(path: Path) -> bool:
    """Return true where a name is the beginning of the names of a buoy's realtime files."""
    return any(_present(path.with_name(path.name + suffix)).is_file() for suffix in SUFFIXES)


def _station(path: Path) -> str:
    """Return the name of the station, with which NDBC's files begin."""
    historical = _HISTORICAL.match(path.name)
    return historical[1] if historical is not None else path.name.partition(".")[0]


def _five(path: Path) -> list[Path]:
    """Return the names of the five files, from that of any of them or from their common part; each may be packed by gzip."""
    historical = _HISTORICAL.match(path.name)
    if historical is not None:
        return [_present(path.with_name(f"{historical[1]}{letter}{historical[3]}")) for letter in _LETTERS]
    name = path.name.removesuffix(".gz")
    ending = next((suffix for suffix in SUFFIXES if name.endswith(suffix)), None)
    if ending is None and path.is_file():  # energy under a name of the user's own
        return [path, *(_present(path.with_name(path.name + suffix)) for suffix in SUFFIXES[1:])]
    base = name.removesuffix(ending or "")
    return [_present(path.with_name(base + suffix)) for suffix in SUFFIXES]


def _present(path: Path) -> Path:
    """Return the file of this name that exists, as text or packed; the name itself where there is none."""
    plain = path.with_name(path.name.removesuffix(".gz"))
    packed = plain.with_name(f"{plain.name}.gz")
    return next((file for file in (path, plain, packed) if file.is_file()), path)


def _read(file: Path) -> SpectralText:
    """Read one of the five files."""
    if not file.is_file():
        raise DataError(
            f"{file} does not exist; a buoy's directional spectrum needs the files {', '.join('NAME' + s for s in SUFFIXES)} beside each "
            "other: bring it, or remove its companions and state from_deg and spreading_deg"
        )
    table: SpectralText = parsed(file, "an NDBC spectral file", lambda: read_spectral_text(file))
    return table


def _column(table: SpectralText, moment: np.datetime64, frequency: FloatArray) -> FloatArray:
    """Return a column of one file at one time, on the frequencies of the energy file."""
    own, values = table.record(moment)
    if own.size != frequency.size or not np.allclose(own, frequency):
        raise DataError(f"{table.path} has other frequencies than the energy file; the files do not belong together or one is cut")
    return values
