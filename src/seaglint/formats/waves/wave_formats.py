"""Reader of wave spectra from a file: its format, the record nearest to a time and place, and its spectrum.

Formats of wave models and of wavespectra are read here, formats of buoys in two other files:

- ERA5: two-dimensional spectra in NetCDF (parameter 251.140, d2fd), before and after the new layout of September 2024. Files hold the
  decimal logarithm of the density in m² s rad⁻¹, directions that waves travel TO, clockwise from north, by number only, and no value on
  land or at negligible energy. The first direction is half a step, the first frequency 0.03453 Hz, each 1.1 times the one before (ECMWF,
  "2D wave spectra").
- Octopus: forecasts of the variance per band of frequency and direction, directions waves come FROM.
- SWAN: standard spectral files and NetCDF. In text files nautical directions (``NDIR``) are where waves come FROM, Cartesian ones
  (``CDIR``) where they travel TO, counter-clockwise from the x axis; wavespectra turns these. In NetCDF directions are in radians,
  nautical or Cartesian by an attribute; wavespectra always reads them as nautical.
- wavespectra: NetCDF ``efth(..., freq, dir)`` in m² s deg⁻¹, directions FROM; without ``dir`` in m² s.
- WAVEWATCH III: NetCDF of the point output and text files of stations. Both have directions waves travel TO, clockwise from north;
  wavespectra turns them to where waves come FROM, even in NetCDF whose attribute states that waves come FROM them already. Text rounds
  directions to three digits of a radian: they are put back on their even grid.
- WWM (WWM-II, WWM-III in SCHISM): NetCDF of stations. ``AC`` is the density of action over angular frequency and direction
  [m² s² rad⁻²], ``SPSIG`` angular frequency [rad s⁻¹], ``SPDIR`` the direction waves travel TO, counter-clockwise from the x axis [rad]:
  the model moves waves with ``cg cos SPDIR`` along x. wavespectra takes ``SPDIR`` for nautical directions waves come FROM; this reader
  does not. The height ``HS``, where the file has it, must agree.

Formats of NetCDF are read from Zarr stores as well.

References
----------
A. Roland et al. 2012, "A fully coupled 3D wave-current interaction model on unstructured grids", J. Geophys. Res. 117, C00J33; source
of WWM-III in SCHISM: ``wwm_netcdf.F90`` (SPDIR, SPSIG as computed), ``wwm_aux.F90`` (DEG2NAUT), ``wwm_fluctsplit.F90`` (propagation).
"""

from __future__ import annotations

import gzip
import logging
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal, get_args

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.formats.waves import awac, buoys
from seaglint.formats.waves import ndbc_buoys as ndbc
from seaglint.formats.waves.ndbc_buoys import headings_of
from seaglint.formats.waves.wave_records import (
    Bands,
    Bins,
    Plain,
    WaveChoice,
    WaveRecords,
    netcdf_records,
    open_dataset,
    parsed,
    reader,
    spectrum_of,
    store_group,
)
from seaglint.sea.spectra.measured import MeasuredSpectrum

Format = Literal[
    "ndbc", "cdip", "mhkit", "spotter", "obscape", "awac", "datawell", "triaxys", "swan", "ww3", "wwm", "era5", "octopus", "wavespectra"
]

#: Names of the formats that ``sea.spectrum.format`` takes.
FORMATS: Final[tuple[Format, ...]] = get_args(Format)

log = logging.getLogger(__name__)

#: Numbers of frequencies and directions whose first frequency is 0.03453 Hz: ERA5 and the global forecast since 2010.
_GRIDS: Final = {(30, 24), (36, 36)}

_HEADER_END: Final = "QUANT"

_ROUNDED: Final = 0.6  # largest distance of a printed direction from its even grid [deg]: 0.005 rad and the offset's own

_AGREE_HEIGHT: Final = 0.25  # share of the height that the file states: HS includes a tail above the last frequency

_NETCDF: Final = (b"\x89HDF\r\n\x1a\n", b"CDF\x01", b"CDF\x02", b"CDF\x05")
_BEGINNING: Final = 8192


def read_era5_waves(path: Path) -> WaveRecords:
    """Read the records of a file."""
    reader("read_era5")

    def convert(data: Any) -> Bins:
        from wavespectra.input.era5 import from_era5

        for name in ("expver", "number"):
            if name in data["d2fd"].dims:
                data = _one_of(data, name, path)
        # wavespectra needs the numbers of frequencies and directions as coordinates; some files have bare dimensions.
        data = data.assign_coords({name: np.arange(data.sizes[name]) for name in data["d2fd"].dims if name not in data.variables})
        if not np.any(np.isfinite(data["d2fd"].values)):
            raise DataError(f"{path}: has no spectrum there at that time (land, or outside); give a place at sea")
        converted = from_era5(data)
        spectrum = converted["efth"].squeeze(drop=True).transpose("freq", "dir")
        if spectrum.shape not in _GRIDS:
            raise DataError(
                f"{path}: has {spectrum.shape[0]} frequencies and {spectrum.shape[1]} directions, and ERA5 has 30 and 24 (forecasts 36 and "
                "36); ask for all of them"
            )
        return Bins(_floats(converted["freq"]), _floats(converted["dir"]), _floats(spectrum))

    return netcdf_records(path, "d2fd", convert)


def _floats(variable: Any) -> FloatArray:
    return np.asarray(variable.values, dtype=np.float64)


def _bins(data: Any, directions: FloatArray) -> Bins:
    """Return the densities of a dataset of wavespectra with other directions than it states [deg]."""
    return Bins(_floats(data["freq"]), directions, _floats(data["efth"].transpose("freq", "dir")))


def _one_of(data: Any, name: str, path: Path) -> Any:
    """Return the entry of a dimension that has values: final or preliminary data; more than one is refused."""
    finite = [i for i in range(data.sizes[name]) if np.any(np.isfinite(data["d2fd"].isel({name: i}).values))]
    if len(finite) > 1:
        raise DataError(f"{path}: has {len(finite)} entries of '{name}' at that time and place; select one, as in xarray: isel({name}=0)")
    return data.isel({name: finite[0] if finite else 0})


def read_octopus(path: Path) -> WaveRecords:
    """Read the records of one place."""
    data = parsed(path, "an Octopus file", lambda: reader("read_octopus")(str(path)))
    density = data["efth"].transpose("time", "site", "freq", "dir").values.astype(np.float64)
    frequency, directions = _floats(data["freq"]), _floats(data["dir"])
    times = np.asarray(data["time"].values).astype("datetime64[ns]")
    places = [np.broadcast_to(np.ravel(data[name].values), (times.size, 1)) for name in ("lat", "lon")]
    return WaveRecords(lambda moment, _: Bins(frequency, directions, density[moment, 0]), times, ("1",), *places)


def read_swan_text(path: Path) -> WaveRecords:
    """Read the records of a standard spectral file, plain or gzipped; a stationary run has no times."""
    header = parsed(path, "a SWAN spectral file", lambda: _header(path))
    if not {"NDIR", "CDIR"} & header:
        raise DataError(
            f"{path}: is a SWAN file of one-dimensional spectra, which are not read; write two-dimensional ones (SPECOUT ... SPEC2D)"
        )
    read = reader("read_swan")
    # As sites always: for a grid wavespectra sorts the coordinates but not the spectra.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # rows that cannot be read are warned of and left as NaN: refused when they are requested
        data = parsed(path, "a SWAN spectral file", lambda: read(str(path), as_site=True))
    spherical = "LONLAT" in header

    def bands(moment: int, place: int) -> Bins:
        density = np.asarray(data["efth"].values[moment, place], dtype=np.float64)
        if not np.any(np.isfinite(density)):
            raise DataError(f"{path}: has no spectrum at site {place + 1} at that time (NODATA: land or dry); choose another")
        return Bins(_floats(data["freq"]), _floats(data["dir"]), density)

    count = data.sizes["time"]
    places = [np.broadcast_to(data[name].values, (count, data.sizes["site"])) if spherical else None for name in ("lat", "lon")]
    times = data["time"].values.astype("datetime64[ns]") if "TIME" in header else None
    return WaveRecords(bands, times, tuple(str(name) for name in data["site"].values), *places)


def _header(path: Path) -> set[str]:
    """Return the first words of the lines above the quantities."""
    words = set()
    with gzip.open(path, "rt") if path.suffix == ".gz" else path.open() as lines:
        for line in lines:
            words.add((line.split() or [""])[0].upper())
            if line.startswith(_HEADER_END):
                break
    return words


def read_swan_netcdf(path: Path) -> WaveRecords:
    """Read the records of SWAN's NetCDF output of two-dimensional spectra."""

    def convert(data: Any) -> Bins:
        from wavespectra.input.ncswan import from_ncswan

        cartesian = _is_cartesian(data)
        converted = from_ncswan(data)
        directions = _floats(converted["dir"])
        # Cartesian: TO, counter-clockwise from east; 270 deg less it is FROM, clockwise from north.
        return _bins(converted, (270.0 - directions) % 360.0 if cartesian else directions)

    reader("read_ncswan")
    return netcdf_records(path, "density", convert)


def _is_cartesian(data: Any) -> bool:
    """Return true where directions are those waves travel TO, counter-clockwise from east; nautical is the default."""
    convention = {str(name).lower(): str(value).lower() for name, value in data.attrs.items()}.get("directional_convention", "")
    standard = str(data["direction"].attrs.get("standard_name", "")).lower()
    return convention.startswith("cartesian") or (not convention and "to_direction" in standard)


def read_wavespectra(path: Path) -> WaveRecords:
    """Read the records of a file."""

    def convert(data: Any) -> Bands:
        frequency = _floats(data["freq"])
        spectrum = data["efth"].squeeze(drop=True)
        if "dir" not in spectrum.dims:
            return Plain(frequency, _floats(spectrum))
        return Bins(frequency, _floats(data["dir"]), _floats(spectrum.transpose("freq", "dir")))

    return netcdf_records(path, "efth", convert)


def read_ww3_text(path: Path) -> WaveRecords:
    """Read the records of a station's text file with one point."""
    header = parsed(path, "a WAVEWATCH III station file", lambda: path.read_text(encoding="utf-8").partition("\n")[0])
    points = parsed(path, "a WAVEWATCH III station file", lambda: int(header.split("'")[2].split()[2]))
    if points != 1:
        raise DataError(f"{path}: has {points} points, and files of one are read; split it by point, or write NetCDF (ww3_ounp)")
    data = parsed(path, "a WAVEWATCH III station file", lambda: reader("read_ww3_station")(str(path)))
    density = _floats(data["efth"]).reshape(-1, data.sizes["freq"], data.sizes["dir"])
    # Three digits of a radian are 0.06 deg: the exact directions are on an even grid.
    directions, frequency = _even(_floats(data["dir"]), path), _floats(data["freq"])
    names = ("1",) if "site" not in data.coords else tuple(str(name) for name in np.atleast_1d(data["site"].values))
    places = [np.broadcast_to(np.ravel(data[name].values)[:1], (density.shape[0], 1)) for name in ("lat", "lon")]
    times = np.asarray(data["time"].values).astype("datetime64[ns]")
    return WaveRecords(lambda moment, _: Bins(frequency, directions, density[moment]), times, names, *places)


def _even(directions: FloatArray, path: Path) -> FloatArray:
    """Return exact directions of a whole turn that were rounded when printed [deg]."""
    step = 360.0 / directions.size
    # The median of the steps has the sense of rotation even where one step crosses north.
    turn = np.sign(np.median((np.diff(directions) + 180.0) % 360.0 - 180.0)) * step
    away = (directions - turn * np.arange(directions.size) + 180.0 - directions[0]) % 360.0 - 180.0
    if np.ptp(away) > 2.0 * _ROUNDED:
        raise DataError(f"{path}: its {directions.size} directions are not even steps of {step:g} deg over the whole turn; check the file")
    return np.asarray((directions[0] + away.mean() + turn * np.arange(directions.size)) % 360.0)


def read_ww3_netcdf(path: Path) -> WaveRecords:
    """Read the records of WAVEWATCH III's NetCDF."""

    def convert(data: Any) -> Bins:
        from wavespectra.input.ww3 import from_ww3

        already_from = "from_direction" in str(data["direction"].attrs.get("standard_name", ""))
        converted = from_ww3(data)
        # wavespectra turns all directions by 180 deg: those that waves come FROM are turned back.
        return _bins(converted, (_floats(converted["dir"]) + (180.0 if already_from else 0.0)) % 360.0)

    reader("read_ww3")
    return netcdf_records(path, "efth", convert)


def read_wwm(path: Path) -> WaveRecords:
    """Read the records of WWM's NetCDF of stations."""

    def convert(data: Any) -> Bins:
        names = {str(name).upper(): str(name) for name in data.variables}
        sigma, theta = data[names["SPSIG"]], data[names["SPDIR"]]
        if float(np.abs(theta).max()) > 2.0 * np.pi + 1e-3:
            raise DataError(f"{path}: {names['SPDIR']} reaches {float(np.abs(theta).max()):g}, and radians are read, 0 to 6.28; convert it")
        rates = _floats(sigma)
        density = _floats(data["AC"].transpose(*sigma.dims, *theta.dims)) * rates[:, None] * 2.0 * np.pi * np.pi / 180.0
        # TO, counter-clockwise from east; 270 deg less it is FROM, clockwise from north.
        bins = Bins(rates / (2.0 * np.pi), (270.0 - np.degrees(_floats(theta))) % 360.0, density)
        _require_height(bins, data, path)
        return bins

    return netcdf_records(path, "AC", convert)


def _require_height(bins: Bins, data: Any, path: Path) -> None:
    """Refuse spectra that do not have the height that WWM's file states, for example energy in the place of action."""
    width = np.gradient(bins.frequency_hz)
    height = 4.0 * float(np.sqrt(max(np.sum(bins.density * width[:, None]) * 360.0 / bins.from_deg.size, 0.0)))
    stated = float(data["HS"]) if "HS" in data.variables and data["HS"].size == 1 else np.nan
    if stated > 0.0 and height > 0.0 and abs(height - stated) > _AGREE_HEIGHT * stated:
        raise DataError(f"{path}: AC gives a height of {height:.2f} m and HS is {stated:.2f} m; correct the one that is wrong")


@dataclass(frozen=True)
class WavesFromFile:
    """Spectrum and its source."""

    spectrum: MeasuredSpectrum  #: The sea.
    report: JsonObject  #: For the provenance: file, format, time, site, place, and their distances from the requested ones.


def read_waves(
    path: str | Path, choice: WaveChoice | None = None, wind_to_azimuth: float = 0.0, *, format: Format | None = None
) -> WavesFromFile:
    """Read the spectrum of one place and time.

    Parameters
    ----------
    path : path
        The file; of a buoy's five NDBC files any one, or the name without its ending.
    choice : WaveChoice, optional
        Requested time and place, tolerances, and directions for files without directions.
    wind_to_azimuth : float
        Azimuth the wind blows TO [rad].
    format : str, optional
        One of ``FORMATS``; by default recognised from the file.

    Returns
    -------
    WavesFromFile

    Raises
    ------
    DataError
        A file that is missing, cut, of no known format or without a record near enough; impossible values.
    DomainError
        A choice that is missing or does not fit the file; ``name`` is its key.
    BackendError
        If wavespectra is not installed and needed.
    """
    path, choice = Path(path), WaveChoice() if choice is None else choice
    if format != "ndbc":  # of a buoy's five files any one may be missing
        _require_present(path)
    kind = recognised(path) if format is None else format
    # what a damaged file holds may be of any type and shape
    return parsed(path, f"a file of {kind}", lambda: _chosen(path, kind, choice, wind_to_azimuth))


def _chosen(path: Path, kind: Format, choice: WaveChoice, wind_to_azimuth: float) -> WavesFromFile:
    """Return the record nearest in time and place, and notes on it."""
    records, what = _records(path, kind, choice), str(path)
    moment, off = (0, None) if records.times is None else choice.nearest_time(records.times, what)
    latitude, longitude = (None if values is None else values[moment] for values in (records.latitude_deg, records.longitude_deg))
    site, away = choice.nearest_site(records.sites, latitude, longitude, what)
    spectrum, directions = spectrum_of(records.bands(moment, site), choice, wind_to_azimuth, what)
    report: JsonObject = {
        "file": path.name,
        "format": kind,
        "directions": directions,
        "significant_height_m": spectrum.significant_height(),
    }
    if records.times is not None:
        report["time"] = f"{np.datetime_as_string(records.times[moment], unit='s')}Z"
    if off is not None:
        report["seconds_from_time_wanted"] = off
    if len(records.sites) > 1:
        report["site"] = records.sites[site]
    for name, values in (("latitude_deg", latitude), ("longitude_deg", longitude)):
        if values is not None:
            report[name] = float(values[site])
    if away is not None:
        report["km_from_place_wanted"] = away
    if records.note is not None:
        log.warning("%s: %s", what, records.note)
        report["note"] = records.note
    return WavesFromFile(spectrum, report)


def _require_present(path: Path) -> None:
    """Refuse a file that is missing, and a folder that is no store."""
    if path.is_dir() and store_group(path) is None:
        raise DataError(f"{path} is a folder and no Zarr store (zarr.json, .zgroup); give the file or the store of a wave spectrum")
    if not path.exists() and not ndbc.is_common_part(path):
        raise DataError(f"{path} does not exist; give the file of a wave spectrum ({', '.join(FORMATS)})")


def recognised(path: Path) -> Format:
    """Recognise the format of a file by its beginning, and for plain text by its name.

    Raises
    ------
    DataError
        A file of another format.
    """
    if not path.is_file() and ndbc.is_common_part(path):
        return "ndbc"
    beginning = b""
    if path.is_file():
        with path.open("rb") as file:
            beginning = file.read(_BEGINNING)
    name = _netcdf_format(path) if _has_variables(path) else _text_format(path, beginning)
    if name is None:
        hint = "; GRIB is not read: convert it to NetCDF" if beginning.startswith(b"GRIB") else ""
        raise DataError(
            f"{path} is no file of wave spectra that is recognised{hint}; allowed: {', '.join(FORMATS)}: "
            "set sea.spectrum.format if it is one"
        )
    return name


def _has_variables(path: Path) -> bool:
    """Return true for NetCDF and for Zarr stores."""
    if store_group(path) is not None:
        return True
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(8).startswith(_NETCDF)


def _netcdf_format(path: Path) -> Format | None:
    with open_dataset(path) as data:
        names = {str(name) for name in data.variables}
    if "d2fd" in names:
        return "era5"
    for name, kind in (("spectral_wave_density", "ndbc"), (buoys.CDIP_DENSITY, "cdip"), (ndbc.MHKIT[0], "mhkit")):
        if name in names:
            return kind  # type: ignore[return-value]
    if "efth" in names:
        return "wavespectra" if "freq" in names else "ww3"
    if "AC" in names and {"SPSIG", "SPDIR"} <= {name.upper() for name in names}:  # older programs write the axes in small letters
        return "wwm"
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
    if head.startswith("$PNOR") or "\n$PNOR" in text:
        return "awac"
    if head.startswith("#") and "# Rows [Hz]" in text:
        return "obscape"
    if any(line.startswith("nfreqs,") for line in text.splitlines()[:4]):
        return "octopus"
    if headings_of(head.partition("\n")[0]):
        return "ndbc"
    if path.suffix == ".spt":
        return "datawell"
    return "ndbc" if path.name.removesuffix(".gz").endswith(ndbc.SUFFIXES) else None


def _records(path: Path, kind: Format, choice: WaveChoice) -> WaveRecords:
    """Return the records of the file by the family of its format."""
    is_netcdf = _has_variables(path)
    match kind:
        case "ndbc" if is_netcdf:
            other = _netcdf_format(path)  # NDBC's data come under the names of others as well
            return _records(path, other, choice) if other in ("cdip", "mhkit") else ndbc.read_netcdf(path)
        case "ndbc":
            return ndbc.read_text(path, choice)
        case "cdip":
            return buoys.read_cdip(path, choice)
        case "mhkit":
            return ndbc.read_mhkit(path)
        case "swan":
            return read_swan_netcdf(path) if is_netcdf else read_swan_text(path)
        case "ww3":
            return read_ww3_netcdf(path) if is_netcdf else read_ww3_text(path)
        case "spotter":
            return buoys.read_spotter_json(path) if path.read_bytes().lstrip().startswith(b"{") else buoys.read_spotter_csv(path)
        case "obscape":
            return buoys.read_obscape(path)
        case "awac":
            return awac.read_awac(path)
        case "wwm":
            return read_wwm(path)
        case "era5":
            return read_era5_waves(path)
        case "triaxys":
            return buoys.read_triaxys(path)
        case "octopus":
            return read_octopus(path)
        case "datawell":
            return buoys.read_datawell(path)
        case "wavespectra":
            return read_wavespectra(path)
