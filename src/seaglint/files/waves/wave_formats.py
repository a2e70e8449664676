"""Reader of wave spectra from a file: its format, the record nearest to a time and place, and its spectrum."""

from __future__ import annotations

import gzip
import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.files.ndbc_dates import headings_of
from seaglint.files.waves import cdip, datawell, octopus, spotter, swan, triaxys, ww3
from seaglint.files.waves import era5_waves as era5
from seaglint.files.waves import ndbc_waves as ndbc
from seaglint.files.waves import wavespectra_file as own
from seaglint.files.waves.bands import spectrum_of
from seaglint.files.waves.netcdf_waves import open_dataset
from seaglint.files.waves.record_choice import WaveChoice
from seaglint.files.waves.wave_file import Held, parsed
from seaglint.sea.spectra.measured import MeasuredSpectrum

Format = Literal["ndbc", "cdip", "mhkit", "spotter", "swan", "ww3", "era5", "triaxys", "octopus", "datawell", "wavespectra"]

#: Names of the formats that ``sea.spectrum.format`` takes.
FORMATS: Final[tuple[Format, ...]] = (
    "ndbc",
    "cdip",
    "mhkit",
    "spotter",
    "swan",
    "ww3",
    "era5",
    "triaxys",
    "octopus",
    "datawell",
    "wavespectra",
)

_NETCDF: Final = (b"\x89HDF\r\n\x1a\n", b"CDF\x01", b"CDF\x02", b"CDF\x05")
_BEGINNING: Final = 8192

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class WavesFromFile:
    """Spectrum and its source."""

    spectrum: MeasuredSpectrum  #: The sea.
    report: JsonObject  #: For the provenance: file, format, time, site, place, and how far they are from those wanted.


def read_waves(
    path: str | Path, choice: WaveChoice | None = None, wind_to_azimuth: float = 0.0, *, format: Format | None = None
) -> WavesFromFile:
    """Read the spectrum of one place and time.

    Parameters
    ----------
    path : path
        The file; of a buoy's five NDBC files any one, or the name without its ending.
    choice : WaveChoice, optional
        Time and place wanted, tolerances, and directions for files that have none.
    wind_to_azimuth : float
        Azimuth the wind blows TO [rad].
    format : str, optional
        One of :data:`FORMATS`; recognised from the file where nothing is said.

    Returns
    -------
    WavesFromFile

    Raises
    ------
    DataError
        A file that is missing, cut, of no known format or without a record near enough; impossible values.
    DomainError
        A choice that is missing or does not go with the file; ``name`` says which.
    BackendError
        If wavespectra is not installed and needed.
    """
    path, choice = Path(path), WaveChoice() if choice is None else choice
    kind = recognised(path) if format is None else format
    # what a damaged file holds may be of any type and shape
    waves: WavesFromFile = parsed(path, f"a file of {kind}", lambda: _chosen(path, kind, choice, wind_to_azimuth))
    return waves


def _chosen(path: Path, kind: Format, choice: WaveChoice, wind_to_azimuth: float) -> WavesFromFile:
    """Return the record nearest in time and place, and notes on it."""
    held, what = _held(path, kind, choice), str(path)
    moment, off = (0, None) if held.times is None else choice.nearest_time(held.times, what)
    latitude, longitude = (None if values is None else values[moment] for values in (held.latitude_deg, held.longitude_deg))
    site, away = choice.nearest_site(held.sites, latitude, longitude, what)
    spectrum, directions = spectrum_of(held.bands(moment, site), choice, wind_to_azimuth, what)
    report: JsonObject = {
        "file": path.name,
        "format": kind,
        "directions": directions,
        "significant_height_m": spectrum.significant_height(),
    }
    if held.times is not None:
        report["time"] = f"{np.datetime_as_string(held.times[moment], unit='s')}Z"
    if off is not None:
        report["seconds_from_time_wanted"] = off
    if len(held.sites) > 1:
        report["site"] = held.sites[site]
    for name, values in (("latitude_deg", latitude), ("longitude_deg", longitude)):
        if values is not None:
            report[name] = float(values[site])
    if away is not None:
        report["km_from_place_wanted"] = away
    if held.note is not None:
        log.warning("%s: %s", what, held.note)
        report["note"] = held.note
    return WavesFromFile(spectrum, report)


def recognised(path: Path) -> Format:
    """Recognise the format of a file by its beginning, and for plain text by its name.

    Raises
    ------
    DataError
        A file that is missing or begins as none of them.
    """
    if not path.is_file():
        if ndbc.is_common_part(path):
            return "ndbc"
        raise DataError(f"{path} does not exist; give the file of a wave spectrum ({', '.join(FORMATS)})")
    with path.open("rb") as file:
        beginning = file.read(_BEGINNING)
    name = _netcdf_format(path) if beginning.startswith(_NETCDF) else _text_format(path, beginning)
    if name is None:
        hint = "; GRIB is not read: convert it to NetCDF" if beginning.startswith(b"GRIB") else ""
        raise DataError(
            f"{path} is no file of wave spectra that is recognised{hint}; allowed: {', '.join(FORMATS)}: "
            "set sea.spectrum.format if it is one"
        )
    return name


def _netcdf_format(path: Path) -> Format | None:
    with open_dataset(path) as data:
        names = {str(name) for name in data.variables}
    if "d2fd" in names:
        return "era5"
    for name, kind in (("spectral_wave_density", "ndbc"), (cdip.DENSITY, "cdip"), (ndbc.MHKIT[0], "mhkit")):
        if name in names:
            return kind  # type: ignore[return-value]
    if "efth" in names:
        return "wavespectra" if "freq" in names else "ww3"
    return "swan" if {"density", "frequency"} <= names else None


def _text_format(path: Path, beginning: bytes) -> Format | None:
    if beginning.startswith(b"\x1f\x8b"):
        try:
            with gzip.open(path) as file:
                beginning = file.read(_BEGINNING)
        except (OSError, EOFError) as error:
            raise DataError(f"{path} cannot be unpacked ({error}); is the file whole?") from error
    text = beginning.decode("utf-8", "replace").lstrip("\ufeff")
    head = text.lstrip()
    for start, kind in (("SWAN", "swan"), ("'WAVEWATCH III SPECTRA'", "ww3"), ("TRIAXYS", "triaxys")):
        if head.startswith(start):
            return kind  # type: ignore[return-value]
    if "varianceDensity_0" in text or (head.startswith("{") and '"frequencyData"' in path.read_text(encoding="utf-8", errors="replace")):
        return "spotter"
    if any(line.startswith("nfreqs,") for line in text.splitlines()[:4]):
        return "octopus"
    if headings_of(head.partition("\n")[0]):
        return "ndbc"
    if path.suffix == ".spt":
        return "datawell"
    return "ndbc" if path.name.removesuffix(".gz").endswith(ndbc.SUFFIXES) else None


def _held(path: Path, kind: Format, choice: WaveChoice) -> Held:
    """Return the records of the file by the family of its format."""
    is_netcdf = False
    if path.is_file():
        with path.open("rb") as file:
            is_netcdf = file.read(8).startswith(_NETCDF)
    match kind:
        case "ndbc" if is_netcdf:
            other = _netcdf_format(path)  # NDBC's data come under the names of others as well
            return _held(path, other, choice) if other in ("cdip", "mhkit") else ndbc.read_netcdf(path)
        case "ndbc":
            return ndbc.read_text(path, choice)
        case "cdip":
            return cdip.read(path, choice)
        case "mhkit":
            return ndbc.read_mhkit(path)
        case "swan":
            return swan.read_netcdf(path) if is_netcdf else swan.read_text(path)
        case "ww3":
            return ww3.read_netcdf(path) if is_netcdf else ww3.read_text(path)
        case "spotter":
            return spotter.read_json(path) if path.read_bytes().lstrip().startswith(b"{") else spotter.read_csv(path)
        case "era5":
            return era5.read(path)
        case "triaxys":
            return triaxys.read(path)
        case "octopus":
            return octopus.read(path)
        case "datawell":
            return datawell.read(path)
        case "wavespectra":
            return own.read(path)
