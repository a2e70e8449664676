"""Records of a wave file: times, places, the bands of each record in the kinds that files have, and their conversion to a spectrum.

A ``WaveChoice`` selects a record by time and place, which NetCDF files and Zarr stores have under various names.

Directions here are where waves come FROM, in degrees clockwise from north, as CF and wavespectra have them; they are turned to where
waves travel TO in one place, ``spectrum_of``. Only moments are complex numbers about the azimuth TO.
"""

from __future__ import annotations

import warnings
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final, TypeVar, assert_never

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError, SeaglintError
from seaglint.base.optional import optional
from seaglint.sea.spectra.binned import of_bins, of_cosine
from seaglint.sea.spectra.measured import MeasuredSpectrum, possible_moments
from seaglint.store.netcdf import drop_quietly, open_netcdf
from seaglint.store.outputs import reason_of

_Parsed = TypeVar("_Parsed")

ComplexArray = NDArray[np.complex128]

LOST_SHARE = 0.1  #: Largest share of energy in bands without directions [1]; those bands take the directions of their neighbours.

_STORE: Final = ("zarr.json", ".zgroup", ".zmetadata")  # files at the root of a group of a Zarr store

_EARTH_RADIUS_KM = 6371.0
_LISTED = 8  # sites that an error lists by name

_TIMES: Final = ("valid_time", "time", "date", "ocean_time")
_SITES: Final = ("station", "site", "points", "nbstation")
_LATITUDES: Final = ("latitude", "lat")
_LONGITUDES: Final = ("longitude", "lon")


@dataclass(frozen=True)
class WaveChoice:
    """Requested time and place, and directions for a file that lacks them."""

    time: str | datetime | np.datetime64 | None = None  #: Requested time, UTC without a zone; None where the file has one record.
    latitude_deg: float | None = None  #: Latitude of the requested place [deg]; both or none.
    longitude_deg: float | None = None  #: Longitude of the requested place [deg].
    site: str | None = None  #: Name of a site, as the file calls it, or its number from 1.
    time_tolerance: float = 3600.0  #: Largest difference of the record from the requested time [s].
    distance_tolerance_km: float = 50.0  #: Largest distance of the record from the requested place [km].
    from_deg: float | None = None  #: Mean direction FROM, for files that have energy over frequency alone [deg].
    spreading_deg: float | None = None  #: Circular width, for the same files [deg].

    def require_time(self, what: str) -> np.datetime64:
        """Return the requested time, where a file can only be read with one."""
        if self.time is None:
            raise DomainError(f"is missing: give the UTC time of the record wanted of {what}, or [time] utc", name="time")
        return as_utc(self.time)

    def nearest_time(self, times: NDArray[np.datetime64], what: str) -> tuple[int, float | None]:
        """Return the index of the record nearest in time, and its difference from the requested time [s]."""
        dated = np.flatnonzero(~np.isnat(times))  # argmin takes NaT for the smallest difference
        if dated.size == 0:
            raise DataError(f"{what} holds no record" + (" with a time" if times.size else ""))
        if self.time is None and dated.size == 1:
            return int(dated[0]), None
        first, last = _text(times[dated].min()), _text(times[dated].max())
        requested = self.require_time(f"{what}, which has {dated.size} from {first} to {last}")
        index = int(dated[np.argmin(np.abs(times[dated] - requested))])
        off = float((times[index] - requested) / np.timedelta64(1, "s"))
        if abs(off) > self.time_tolerance:
            raise DataError(
                f"{what} has no record within {self.time_tolerance:g} s of {_text(requested)}; it covers {first} to "
                f"{last}, nearest is {_text(times[index])}: give one of its times or a larger time_tolerance_s"
            )
        return index, off

    def nearest_site(
        self, names: tuple[str, ...], latitude_deg: FloatArray | None, longitude_deg: FloatArray | None, what: str
    ) -> tuple[int, float | None]:
        """Return the index of the requested site, and its distance from the requested place [km]."""
        if self.site is not None:
            if self.site.isdecimal() and 1 <= int(self.site) <= len(names) and self.site not in names:
                return int(self.site) - 1, None
            if self.site not in names:
                shown = f"{', '.join(names[:_LISTED])}{', ...' if len(names) > _LISTED else ''}"
                raise DomainError(
                    f"= '{self.site}' is not a site of {what}; allowed: {shown}", name="site", value=self.site, allowed=", ".join(names)
                )
            return names.index(self.site), None
        if self.latitude_deg is None or self.longitude_deg is None or latitude_deg is None or longitude_deg is None:
            if len(names) > 1:
                raise DomainError(
                    f"is missing: {what} has {len(names)} sites ({', '.join(names[:_LISTED])}{', ...' if len(names) > _LISTED else ''}); "
                    "give the name of one" + ("" if latitude_deg is None else ", or latitude_deg and longitude_deg"),
                    name="site",
                    allowed=", ".join(names),
                )
            return 0, None
        away = distance_km(self.latitude_deg, self.longitude_deg, latitude_deg, longitude_deg)
        index = int(np.argmin(np.where(np.isfinite(away), away, np.inf)))
        if not away[index] <= self.distance_tolerance_km:
            raise DataError(
                f"{what} has no site within {self.distance_tolerance_km:g} km of {self.latitude_deg:g}, {self.longitude_deg:g}; nearest is "
                f"{names[index]} at {latitude_deg[index]:g}, {longitude_deg[index]:g}, {away[index]:.0f} km away: give another place or a "
                "larger distance_tolerance_km"
            )
        return index, float(away[index])


def as_utc(time: str | datetime | np.datetime64) -> np.datetime64:
    """Return a time as datetime64 in UTC; text and datetimes without a zone are UTC."""
    if isinstance(time, np.datetime64):
        return time
    try:
        moment = datetime.fromisoformat(time) if isinstance(time, str) else time
    except ValueError as error:
        raise DataError(f"time {time!r} is not an ISO date and time such as 2020-06-08T03:50Z") from error
    if moment.tzinfo is not None:
        moment = moment.astimezone(UTC).replace(tzinfo=None)
    return np.datetime64(moment)


def distance_km(latitude: float, longitude: float, latitudes: FloatArray, longitudes: FloatArray) -> FloatArray:
    """Return the distance along the Earth from one place to others, all in degrees [km] (haversine).

    Examples
    --------
    >>> import numpy as np
    >>> distance_km(0.0, 359.5, np.array([0.0]), np.array([0.5])).round(1)
    array([111.2])
    """
    start, end = np.radians(latitude), np.radians(latitudes)
    turn = np.radians(np.asarray(longitudes) - longitude)
    h = np.sin(0.5 * (end - start)) ** 2 + np.cos(start) * np.cos(end) * np.sin(0.5 * turn) ** 2
    return np.asarray(2.0 * _EARTH_RADIUS_KM * np.arcsin(np.sqrt(np.clip(h, 0.0, 1.0))))


def _text(time: Any) -> str:
    return str(np.datetime_as_string(np.datetime64(time), unit="s")) + "Z"


@dataclass(frozen=True, eq=False)
class Plain:
    """Wave data with energy alone: ``frequency_hz`` [Hz, (m,)] and ``energy`` [m² Hz⁻¹, (m,)]."""

    frequency_hz: FloatArray
    energy: FloatArray


@dataclass(frozen=True, eq=False)
class DirectionalMoments(Plain):
    """Wave data with the first two moments of the azimuth TO, ``int D exp(i n phi) dphi`` [1, (m,)]; NaN where unknown."""

    first: ComplexArray
    second: ComplexArray


@dataclass(frozen=True, eq=False)
class Cosine(Plain):
    """Wave data with mean direction FROM and circular width of the directions [deg, (m,)]."""

    from_deg: FloatArray
    width_deg: FloatArray


@dataclass(frozen=True, eq=False)
class Bins:
    """Wave data as densities over frequency [Hz, (m,)] and direction FROM [deg, (n,)]: ``density`` [m² Hz⁻¹ deg⁻¹, (m, n)]."""

    frequency_hz: FloatArray
    from_deg: FloatArray
    density: FloatArray


Bands = Plain | DirectionalMoments | Cosine | Bins


def spectrum_of(bands: Bands, choice: WaveChoice, wind_to_azimuth: float, what: str) -> tuple[MeasuredSpectrum, str]:
    """Return the spectrum of wave data, and the source of its directions in words.

    Raises
    ------
    DomainError
        ``from_deg`` or ``spreading_deg`` missing for energy alone, or given where the file has directions.
    DataError
        Values that are missing, negative or impossible; energy without directions; no energy at all.
    """
    bands = _ordered(bands)
    if not isinstance(bands, Bins) and not np.all(np.isfinite(bands.energy)):
        raise DataError(f"{what} has missing energy; choose another time or place")
    if type(bands) is not Plain and (choice.from_deg is not None or choice.spreading_deg is not None):
        name = "from_deg" if choice.from_deg is not None else "spreading_deg"
        raise DomainError(f"does not go with {what}, which has directions of its own; leave it out", name=name, value=getattr(choice, name))
    try:
        match bands:
            case Bins():
                degree = np.pi / 180.0  # densities per degree become densities per radian
                spectrum: MeasuredSpectrum = of_bins(
                    bands.frequency_hz, (bands.from_deg + 180.0) * degree, bands.density / degree, wind_to_azimuth
                )
                return spectrum, f"{bands.from_deg.size} directions of the file"
            case DirectionalMoments():
                first, second = _everywhere(bands, what)
                return MeasuredSpectrum(bands.frequency_hz, bands.energy, *possible_moments(first, second), wind_to_azimuth), (
                    "two moments of the file, maximum entropy"
                )
            case Cosine():
                to = np.radians(bands.from_deg + 180.0)
                return of_cosine(bands.frequency_hz, bands.energy, to, np.radians(bands.width_deg), wind_to_azimuth), (
                    "mean direction and width of the file, cosine to a power"
                )
            case Plain():
                return _stated(bands, choice, wind_to_azimuth, what)
            case other:
                assert_never(other)
    except DataError as error:
        raise DataError(f"{what}: {error}") from error


def _stated(bands: Plain, choice: WaveChoice, wind_to_azimuth: float, what: str) -> tuple[MeasuredSpectrum, str]:
    """Return energy with directions that the user states."""
    for name, value, hint in (
        ("from_deg", choice.from_deg, "the azimuth the waves come from"),
        ("spreading_deg", choice.spreading_deg, "the width of their directions (wind sea about 30, swell 10 to 20)"),
    ):
        if value is None:
            raise DomainError(f"is missing: {what} has no directions; give {hint}", name=name, allowed=hint)
    assert choice.from_deg is not None
    assert choice.spreading_deg is not None
    to, width = np.radians(choice.from_deg + 180.0), np.radians(choice.spreading_deg)
    return of_cosine(bands.frequency_hz, bands.energy, to, width, wind_to_azimuth), "as stated: the file has none"


def _ordered(bands: Bands) -> Bands:
    """Return bands by ascending frequency; a band at 0 Hz is no wave."""
    order = np.argsort(bands.frequency_hz)
    order = order[bands.frequency_hz[order] > 0.0]
    if isinstance(bands, Bins):
        return Bins(bands.frequency_hz[order], bands.from_deg, bands.density[order])
    return replace(bands, **{name: values[order] for name, values in vars(bands).items()})


def _everywhere(bands: DirectionalMoments, what: str) -> tuple[ComplexArray, ComplexArray]:
    """Return moments of every band, interpolated where they are not known."""
    frequency, energy = bands.frequency_hz, bands.energy
    known = np.isfinite(bands.first) & np.isfinite(bands.second)
    # Bands without directions matter by their energy, not by their number.
    share = np.where(known, 0.0, energy) @ np.gradient(frequency) / max(float(energy @ np.gradient(frequency)), 1e-300)
    if share > LOST_SHARE or not np.any(known):
        raise DataError(f"lacks directions for {100 * share:.0f} % of its energy ({100 * LOST_SHARE:.0f} % allowed); choose another time")
    first, second = (np.interp(frequency, frequency[known], c[known]) for c in (bands.first, bands.second))
    return first, second


@dataclass(frozen=True, eq=False)
class WaveRecords:
    """Records of one file, read on request."""

    bands: Callable[[int, int], Bands]  #: ``bands(time, site)`` by index.
    times: NDArray[np.datetime64] | None = None  #: Time of every record, UTC; None where the file has none.
    sites: tuple[str, ...] = ("1",)  #: Names of the sites.
    latitude_deg: FloatArray | None = None  #: Latitude of every record and site [deg, (times, sites)]; None without a place in the file.
    longitude_deg: FloatArray | None = None  #: Longitude of every record and site [deg, (times, sites)]; None likewise.
    note: str | None = field(default=None, kw_only=True)  #: Sentence on the record that the user should know.


def reader(name: str) -> Callable[..., Any]:
    """Return a function of wavespectra.

    Raises
    ------
    BackendError
        If wavespectra is not installed.
    """
    function: Callable[..., Any] = getattr(optional("wavespectra", "reading of measured spectra"), name)
    return function


def parsed(path: Path, kind: str, parse: Callable[[], _Parsed]) -> _Parsed:
    """Return the result of a parser; its exceptions, which are of any type, become an error of one line.

    Warnings of libraries about future changes of other libraries are not shown.
    """
    try:
        with warnings.catch_warnings():
            for category in (DeprecationWarning, FutureWarning):
                warnings.simplefilter("ignore", category)
            return parse()
    except SeaglintError:
        raise
    except Exception as error:
        text = reason_of(error)
        drop_quietly(error)
        raise DataError(f"{path} cannot be read as {kind} ({text}); it may be cut or of another kind: see sea.spectrum.format") from error


def open_dataset(path: Path) -> Any:
    """Open NetCDF or a Zarr store as an xarray dataset without reading values."""
    # Groups, calendars or packing that xarray cannot read are reported as any parser's error.
    if store_group(path) is None:
        return parsed(path, "NetCDF", lambda: open_netcdf(path))
    return parsed(path, "a Zarr store", lambda: _open_store(path))


def store_group(path: Path) -> str | None:
    """Return the group of a Zarr store of version 2 or 3 that holds its arrays; None where the path is no store.

    The group is "" for a folder; a packed store (``.zarr.zip``) may have its folder inside the archive.
    """
    if path.is_dir():
        return "" if any((path / name).is_file() for name in _STORE) else None
    if not path.is_file() or not zipfile.is_zipfile(path):
        return None
    with zipfile.ZipFile(path) as packed:
        groups = [name.rpartition("/")[0] for name in packed.namelist() if name.rpartition("/")[2] in _STORE]
    return min(groups, key=len, default=None)


def _open_store(path: Path) -> Any:
    import xarray as xr
    import zarr

    store: Any = str(path) if path.is_dir() else zarr.storage.ZipStore(path, mode="r")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of text, and of files that are no arrays: only what is needed has to be readable
        # Metadata of the groups themselves: stores without consolidated metadata are read like others.
        return xr.open_dataset(store, engine="zarr", group=store_group(path) or None, chunks=None, consolidated=False)


def netcdf_records(path: Path, density: str, convert: Callable[[Any], Bands]) -> WaveRecords:
    """Return the records of a NetCDF file or a Zarr store.

    Parameters
    ----------
    path : Path
        The file.
    density : str
        Name of its spectra; dimensions besides time and place are left to ``convert``.
    convert : callable
        Bands of a dataset that holds one time and one place.
    """
    with open_dataset(path) as data:
        dims = data[density].dims
        time = next((name for name in _TIMES if name in data.variables), None)
        site = next((name for name in _SITES if name in dims), None)
        latitude, longitude = (next((n for n in names if n in data.variables), None) for names in (_LATITUDES, _LONGITUDES))
        times = None if time is None else np.atleast_1d(data[time].values)
        if times is not None and times.dtype.kind != "M":
            raise DataError(
                f"{path}: its times ('{time}') have no units that can be read; allowed: 'seconds since 1970-01-01' and the like"
            )
        count = 1 if times is None else times.size
        grid = site is None and latitude in dims and longitude in dims
        if grid:
            rows, columns = data[latitude].size, data[longitude].size
            north, east = (a.ravel() for a in np.meshgrid(data[latitude].values, data[longitude].values, indexing="ij"))
            names = tuple(f"{n:g},{e:g}" for n, e in zip(north, east, strict=True))
            places: list[FloatArray | None] = [np.broadcast_to(values, (count, rows * columns)) for values in (north, east)]
        else:
            names = _names(data, site)
            places = [_placed(data, name, time, site, (count, len(names))) for name in (latitude, longitude)]

    def bands(moment: int, place: int) -> Bands:
        chosen: dict[str, int] = {}
        if time in dims:
            chosen[str(time)] = moment
        if grid:
            chosen |= {str(latitude): place // columns, str(longitude): place % columns}
        elif site is not None:
            chosen[site] = place
        with open_dataset(path) as data:
            if times is not None and time in dims:
                require_one(data[density], str(time), np.flatnonzero(times == times[moment]), path)
            return convert(data.isel(chosen).load())

    return WaveRecords(bands, None if times is None else times.astype("datetime64[ns]"), names, *places)


def require_one(density: Any, time: str, indices: NDArray[np.intp], path: Path) -> None:
    """Refuse records of one time whose spectra differ."""
    records = [density.isel({time: int(index)}).values for index in indices] if indices.size > 1 else []
    if any(not np.array_equal(records[0], record, equal_nan=True) for record in records[1:]):
        moment = np.datetime_as_string(np.atleast_1d(density[time].values)[indices[0]], unit="s")
        raise DataError(
            f"{path} has {indices.size} records of {moment}Z that differ (numbers {', '.join(map(str, indices + 1))}); remove all but one"
        )


def _names(data: Any, site: str | None) -> tuple[str, ...]:
    """Return the names of the sites; numbers from 1 where the file has none."""
    if site is None:
        return ("1",)
    for name in ("station_name", site):
        if name in data.variables:
            values = data[name].values
            if values.ndim == 2:  # one letter a cell
                values = np.array([b"".join(row) if values.dtype.kind == "S" else "".join(row) for row in values])
            if values.ndim == 1:
                return tuple(v.decode("utf-8", "replace").strip() if isinstance(v, bytes) else str(v).strip() for v in values)
    return tuple(str(i + 1) for i in range(data.sizes[site]))


def _placed(data: Any, name: str | None, time: str | None, site: str | None, shape: tuple[int, int]) -> FloatArray | None:
    """Return a coordinate of every record and site [deg]."""
    if name is None:
        return None
    values = data[name]
    order = [dim for dim in (time, site) if dim in values.dims]
    values = values.transpose(*order, ...).values.astype(np.float64)
    if time not in order and site not in order:
        values = values.reshape(-1)[:1]
    if time in order and site not in order:
        values = values.reshape(-1, 1)
    return np.broadcast_to(values, shape)
