"""Reader of NDBC wave spectra: five text files of a buoy (realtime or historical), the first of them alone, or NetCDF, also MHKiT's.

Mean and principal directions alpha1 and alpha2 are where waves come FROM, in degrees clockwise from north, r1 and r2 the lengths of the two
moments, in 0-1 or, in historical text files, in hundredths. Each file is read separately and the moments are used unchanged: a truncated
Fourier series of them, as wavespectra builds, has negative energies.

Text files: historical ones have the frequencies in their headings, realtime files a frequency in brackets after each value. Years have two
digits up to 1998, minutes come in 2005, and from 2007 headings begin with ``#``. Further lines that begin with ``#``, and a line of units,
are skipped. Records may be in any order. Dates of NDBC's weather files have the same forms.

NetCDF: attributes state units, the sense of directions, and which north. Without an attribute, or with an empty one, the format's
convention holds. One that changes the meaning of the numbers is honoured where that is certain, else refused.

References
----------
NDBC, "Nondirectional and directional wave data analysis procedures", Technical Document 96-01;
"Measurement descriptions and units", ndbc.noaa.gov/measdes.shtml.
"""

from __future__ import annotations

import gzip
import re
import zlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.formats.tables.table_text import plain_number
from seaglint.formats.waves.wave_records import Bands, DirectionalMoments, Plain, WaveChoice, WaveRecords, netcdf_records, parsed

LengthUnit = Literal["ones", "hundredths", "unknown"]  #: Unit of r1 and r2 as the file states it.

YEAR_NAMES: Final = ("YY", "YYYY")  #: Headings of the column of years; from 2007 on the line begins with ``#``.

#: Suffixes of the realtime files of one buoy: energy, mean and principal direction, and the lengths of the two moments.
SUFFIXES: Final = (".data_spec", ".swdir", ".swdir2", ".swr1", ".swr2")

#: Variables of MHKiT's files: energy, mean and principal direction, and the lengths of the two moments.
MHKIT: Final = ("swden", "swdir", "swdir2", "swr1", "swr2")

_WHOLE: Final = re.compile(r"\d{1,4}")
_PIVOT: Final = 70  # NDBC's first buoys are of the 1970s

_NINES: Final = (99.0, 999.0, 9999.0)
_CERTAIN: Final = 2.0  # in hundredths: no sea has only lengths of 0.02 or less

_WORDS: Final = (
    (r"met(?:er|re)s?", "m"),
    (r"squared|\^2|\*\*2|²", "2"),
    (r"hertz", "hz"),
    (r"seconds?|sec\b", "s"),
    (r"\bper\b", "/"),
    (r"⁻¹|\^-1|\*\*-1", "-1"),
    (r"m\s*\*\s*m\b", "m2"),
    (r"[\s()\[\]*.·_^]", ""),
)
_DENSITIES: Final = {"m2/hz", "m2hz-1", "m2s", "m2/(hz)", "m2/s-1"}
_FREQUENCIES: Final = {"hz", "s-1", "1/s", "/s", "cycles/s", "cyclespersecond"}
_DEGREES: Final = re.compile(r"(?:deg(?:ree)?s?|°)(?:t|true|fromtrue(?:north)?|truenorth|clockwisefromtrue(?:north)?)?")
_ONES: Final = {"1", "-", "none", "dimensionless", "nondimensional", "unitless"}
_HUNDREDTHS: Final = {"%", "percent", "hundredths", "0.01", "1e-2", "1e-02", "10-2"}
_MAGNETIC: Final = re.compile(r"magnetic north|degrees? magnetic|\bdeg_?M\b|relative to magnetic", re.IGNORECASE)
_FILLED: Final = -999.0  # -999, -999.9, -999.99 and -9999, where no attribute says that it is a fill value

_PAIR: Final = re.compile(r"(\S+)\s*\(\s*([0-9.]+)\s*\)")
_BRACKET: Final = re.compile(r"\([^)]*\)")
_ABSENT: Final = ("MM", "N/A", "NaN", "nan")

_LETTERS: Final = "wdijk"  # the same five of a year or month, after the five letters of the station: 41010w2019.txt
_HISTORICAL: Final = re.compile(r"^(.{5})([wdijk])(.*\.txt(?:\.gz)?)$")
_NDBC: Final = ("spectral_wave_density", "mean_wave_dir", "principal_wave_dir", "wave_spectrum_r1", "wave_spectrum_r2")


def headings_of(line: str) -> list[str]:
    """Return the headings of a line, the column of years first; an empty list where the line is none of headings.

    Examples
    --------
    >>> headings_of("#YYYY MM DD hh mm WDIR")
    ['YY', 'MM', 'DD', 'hh', 'mm', 'WDIR']
    >>> headings_of("# YY MM DD hh .0300")
    ['YY', 'MM', 'DD', 'hh', '.0300']
    >>> headings_of("#yr  mo dy hr mn degT")
    []
    """
    names = line.lstrip().removeprefix("#").split()
    dated = bool(names) and names[0] in YEAR_NAMES and names[1:3] == ["MM", "DD"] and names[3:4] in (["hh"], ["HH"])
    return ["YY", "MM", "DD", "hh", *names[4:]] if dated else []


def full_year(year: int) -> int:
    """Return a year of four digits: of two digits those from 70 on are of the last century, the others of this one.

    Raises
    ------
    ValueError
        A year that is neither 0 to 99 nor 1900 to 2199.

    Examples
    --------
    >>> [full_year(year) for year in (96, 70, 69, 5, 2024)]
    [1996, 1970, 2069, 2005, 2024]
    """
    if 0 <= year < 100:
        return year + (1900 if year >= _PIVOT else 2000)
    if 1900 <= year < 2200:
        return year
    raise ValueError(f"year {year} is neither 0 to 99 nor 1900 to 2199")


def moment_of(cells: Sequence[str]) -> datetime:
    """Return the time of year, month, day, hour and, where there is a fifth cell, minute; 24 h is the midnight that ends the day.

    Raises
    ------
    ValueError
        Cells that are no whole numbers, or a date or time that there is not.

    Examples
    --------
    >>> moment_of(["96", "12", "31", "24"]).isoformat()
    '1997-01-01T00:00:00'
    """
    for cell in cells:
        if not (cell.isascii() and _WHOLE.fullmatch(cell)):
            raise ValueError(f"'{cell}' is not a whole number")
    year, month, day, hour, minute = (int(cell) for cell in (*cells, "0")[:5])
    if (hour, minute) == (24, 0):
        return datetime(full_year(year), month, day) + timedelta(days=1)
    return datetime(full_year(year), month, day, hour, minute)


def energy_known(energy: FloatArray) -> FloatArray:
    """Return energies with NaN for those written as nines; a storm has densities above 99 m²/Hz, so only 99, 999 and 9999 count."""
    return np.where(np.isin(energy, _NINES), np.nan, energy)


def moments_of(
    frequency: FloatArray, energy: FloatArray, columns: tuple[FloatArray, FloatArray, FloatArray, FloatArray], unit: LengthUnit, what: str
) -> DirectionalMoments:
    """Return the moments of alpha1, alpha2 [deg, from], r1 and r2; NaN where one of the four is missing.

    Raises
    ------
    DataError
        r1 or r2 that are impossible in their unit, or whose unit cannot be decided.
    """
    alpha1, alpha2, r1, r2 = columns
    known = np.all([np.isfinite(c) & ~np.isin(c, _NINES[1:]) for c in columns], axis=0)
    known &= (alpha1 >= 0.0) & (alpha1 <= 360.0) & (alpha2 >= 0.0) & (alpha2 <= 360.0)
    known &= ~np.all([c == _NINES[0] for c in columns], axis=0)  # one such value may be a direction of 99 deg or a length of 0.99
    scale = _scale([r[known] for r in (r1, r2)], unit, what)
    if scale == 1.0:
        known &= ~(_coded(r1) | _coded(r2))
    first = scale * r1 * np.exp(1j * (np.radians(alpha1) + np.pi))  # from -> to; the second moment does not know the difference
    second = scale * r2 * np.exp(2j * np.radians(alpha2))
    return DirectionalMoments(frequency, energy, *(np.where(known, c, np.nan) for c in (first, second)))


def _coded(lengths: FloatArray) -> NDArray[np.bool_]:
    """Return true for lengths that, unless in hundredths, are missing: 99, and the 9.99 that a division by 100 makes of 999."""
    return np.asarray((lengths == _NINES[0]) | np.isclose(lengths, 0.01 * _NINES[1]))


def _scale(lengths: list[NDArray[np.float64]], unit: LengthUnit, what: str) -> float:
    """Return the factor that makes lengths 0 to 1."""
    if any(np.any(r < 0.0) for r in lengths):
        raise DataError(f"{what}: r1 or r2 is negative, and 0-1 (or hundredths) is allowed; check the file")
    largest = [float(np.max(r[~_coded(r)], initial=0.0)) for r in lengths]
    if max(largest) <= 1.0:
        if unit == "hundredths" and max(largest) > 0.0:
            raise DataError(f"{what}: r1 and r2 are at most {max(largest):g}, and the file says hundredths; correct their unit to 1")
        return 1.0
    if unit == "ones":
        raise DataError(
            f"{what}: r1 or r2 above 1; realtime files have them in 0-1, historical ones (41010w2019.txt) in hundredths: divide by 100"
        )
    if max(largest) > 100.0 or any(0.0 < value <= _CERTAIN for value in largest):
        shown = " and ".join(f"{value:g}" for value in largest)
        raise DataError(f"{what}: r1 and r2 reach {shown}, which is neither 0-1 nor hundredths for both; give both in 0-1 or in hundredths")
    return 0.01


def unit_of(data: Any, name: str) -> str:
    """Return the units of a variable in a uniform spelling; empty without units in the file.

    Examples
    --------
    >>> import xarray as xr
    >>> [unit_of({"S": xr.DataArray(0.0, attrs={"units": u})}, "S") for u in ("meter^2 second", "(meter * meter)/Hz", "m**2 Hz**-1")]
    ['m2s', 'm2/hz', 'm2hz-1']
    """
    text = str(data[name].attrs.get("units", "")).strip().lower()
    for pattern, plain in _WORDS:
        text = re.sub(pattern, plain, text)
    return text


def numbers_of(data: Any, name: str) -> FloatArray:
    """Return the values of a variable as floats; NaN where they are filled with -999 or below."""
    values = np.asarray(data[name].values, dtype=np.float64)
    return np.where(values <= _FILLED, np.nan, values)


def frequency_of(data: Any, name: str, path: Path) -> FloatArray:
    """Return frequencies [Hz]; other units are refused."""
    unit = unit_of(data, name)
    if unit and unit not in _FREQUENCIES:
        raise DataError(f"{path}: {name} is in '{data[name].attrs['units']}', and Hz is read; convert it")
    return np.asarray(data[name].values, dtype=np.float64)


def energy_of(data: Any, name: str, path: Path) -> FloatArray:
    """Return energy densities [m² Hz⁻¹]; other units are refused."""
    unit = unit_of(data, name)
    if unit and unit not in _DENSITIES:
        raise DataError(f"{path}: {name} is in '{data[name].attrs['units']}', and m2/Hz is read; convert it")
    return numbers_of(data, name)


def degrees_of(data: Any, name: str, path: Path) -> FloatArray:
    """Return directions as the file has them [deg]; other units, and magnetic north, are refused."""
    attributes = data[name].attrs
    words = " ".join(str(attributes.get(key, "")) for key in ("units", "long_name", "standard_name", "description", "comment", "reference"))
    if _MAGNETIC.search(words) and "true" not in words.lower():
        raise DataError(f"{path}: {name} is relative to magnetic north, and true north is read; add the declination and say degrees_true")
    unit = unit_of(data, name)
    if unit and not _DEGREES.fullmatch(unit):
        raise DataError(f"{path}: {name} is in '{attributes['units']}', and degrees clockwise from true north are read; convert it")
    return numbers_of(data, name)


def travels_to(data: Any, name: str) -> bool:
    """Return true if waves travel TO the directions by their standard name."""
    return "to_direction" in str(data[name].attrs.get("standard_name", ""))


def from_degrees_of(data: Any, name: str, path: Path) -> FloatArray:
    """Return directions waves come FROM [deg, 0 to 360], turned by 180 deg if the file states where waves travel TO."""
    values = degrees_of(data, name, path)
    return np.where(values <= 360.0, (values + 180.0) % 360.0, values) if travels_to(data, name) else values


def length_unit_of(data: Any, names: tuple[str, str], path: Path) -> LengthUnit:
    """Return the unit of r1 and r2 by their attributes."""
    units = {unit_of(data, name) for name in names}
    words = " ".join(str(data[name].attrs.get(key, "")) for name in names for key in ("long_name", "description", "comment")).lower()
    ones, hundredths = units & _ONES, units & _HUNDREDTHS
    if units - _ONES - _HUNDREDTHS - {""} or (ones and hundredths):
        raise DataError(
            f"{path}: {' and '.join(names)} are in {', '.join(map(repr, sorted(units)))}; 1 or % for both is read: convert them"
        )
    if hundredths:
        return "hundredths"
    return "ones" if ones or "nondimensional" in words or "dimensionless" in words else "unknown"


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
    left_out: str = ""  #: Lines without a date, which were left out, in words.

    @property
    def name(self) -> str:
        """Return the path, with what was left out of the file."""
        return f"{self.path} ({self.left_out})" if self.left_out else str(self.path)

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
                f"{self.name} has no record of {moment}, which the energy file has; the files do not belong together or one is cut"
            )
        rows = [self.rows[index] for index in indices]
        if len({" ".join(row.text.split()) for row in rows}) > 1:
            lines = ", ".join(str(row.line) for row in rows)
            raise DataError(f"{self.path} has {len(rows)} records of {moment} that differ (lines {lines}); remove all but one")
        return self._values(rows[0])

    def _values(self, row: SpectralRow) -> tuple[FloatArray, FloatArray]:
        """Return frequencies and values of a row."""
        # A record of fewer bands than most of the others is cut.
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
        Headings of another kind of file, impossible dates in more than half of the records, or no records; with the line.
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
    dates, times, rows, undated = 4, [], [], []
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
            undated.append(f"line {number}: '{' '.join(cells[:dates])[:40]}' is no date and hour")
            continue
        rows.append(SpectralRow(number, cells[dates] if len(cells) > dates else "", frequencies))
    if len(undated) > len(rows):
        raise unreadable(path, f"{len(undated)} of {len(rows) + len(undated)} records have no date; {undated[0]}")
    if not rows:
        raise unreadable(path, "it has no records")
    left_out = f"{len(undated)} of {len(rows) + len(undated)} records left out; {undated[0]}" if undated else ""
    return SpectralText(path, np.array(times).astype("datetime64[ns]"), tuple(rows), left_out)


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


def read_text(path: Path, choice: WaveChoice) -> WaveRecords:
    """Read the records of a buoy's text files, which have many times, so that one must be requested."""
    files = _five(path)
    moment = choice.require_time(str(path))
    table = _read(files[0])
    index, _ = choice.nearest_time(table.times, table.name)
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

    return WaveRecords(bands, table.times[index : index + 1], (_station(files[0]),), note=table.left_out or None)


def read_netcdf(path: Path) -> WaveRecords:
    """Read the records of a buoy's NetCDF file."""
    return _read_netcdf(path, _NDBC)


def read_mhkit(path: Path) -> WaveRecords:
    """Read the records of NetCDF with the names of MHKiT's ``wave.io.ndbc.request_directional_data``.

    MHKiT divides r1 and r2 by 100 and keeps NDBC's nines, so that a missing one is 9.99.
    """
    return _read_netcdf(path, MHKIT)


def _read_netcdf(path: Path, names: tuple[str, str, str, str, str]) -> WaveRecords:
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

    return netcdf_records(path, density, convert)


def is_common_part(path: Path) -> bool:
    """Return true where a name is the beginning of the names of a buoy's realtime files."""
    return any(_present(path.with_name(path.name + suffix)).is_file() for suffix in SUFFIXES)


def _station(path: Path) -> str:
    """Return the name of the station, with which NDBC's files begin."""
    historical = _HISTORICAL.match(path.name)
    return historical[1] if historical is not None else path.name.partition(".")[0]


def _five(path: Path) -> list[Path]:
    """Return the names of the five files, from any one of them or from their common part; each may be packed by gzip."""
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
    """Return the file of this name that exists, as text or packed; the name itself if neither exists."""
    plain = path.with_name(path.name.removesuffix(".gz"))
    return next((file for file in (path, plain, plain.with_name(f"{plain.name}.gz")) if file.is_file()), path)


def _read(file: Path) -> SpectralText:
    """Read one of the five files."""
    if not file.is_file():
        raise DataError(
            f"{file} does not exist; a buoy's directional spectrum needs the files {', '.join('NAME' + s for s in SUFFIXES)} beside each "
            "other: bring it, or remove its companions and state from_deg and spreading_deg"
        )
    return parsed(file, "an NDBC spectral file", lambda: read_spectral_text(file))


def _column(table: SpectralText, moment: np.datetime64, frequency: FloatArray) -> FloatArray:
    """Return a column of one file at one time, on the frequencies of the energy file."""
    own, values = table.record(moment)
    if own.size != frequency.size or not np.allclose(own, frequency):
        raise DataError(f"{table.path} has other frequencies than the energy file; the files do not belong together or one is cut")
    return values
