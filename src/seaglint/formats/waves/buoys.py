"""Readers of the wave spectra of CDIP, Datawell, Obscape, Sofar Spotter and TRIAXYS buoys; NDBC's and AWACs are read in other files.

- CDIP: NetCDF (``067p1_rt.nc``, ``067p1_historic.nc``, ``067p1_d01.nc``), and files with its names. Moments a1, b1, a2, b2 are the cosine
  and sine parts about the direction waves come FROM, clockwise from true north, divided by the energy:
  ``waveMeanDirection = atan2(b1, a1)``. Where the file has mean directions, spreads or heights as well, they must agree with moments and
  energies. Records whose primary flag is questionable, bad or missing are not used.
- Datawell Waverider: ``.spt`` files of one record, whose name gives place and time (``buoy}2024-09-09T01h15Z.spt``). Bands have energy
  relative to the largest, mean direction waves come FROM and width of the directions [deg].
- Obscape: CSV of the portal, one record: densities [m² Hz⁻¹ rad⁻¹] with a row for each frequency and a column for each direction waves
  come FROM, clockwise from true north. ``Timestamp`` is in UTC; ``Timestring`` is in the portal's time zone and is not used. wavespectra
  begins all directions at 0 and does not read the unit; both are read here.
- Sofar Spotter: JSON of the programming interface, CSV of the dashboard. Both give the moments of every band, a1, b1, a2, b2, about the
  direction waves travel TO, counter-clockwise from east: ``direction = 270 deg - atan2(b1, a1)``, where they come FROM. wavespectra would
  rebuild them from mean direction and width alone, and uses the times of the wave heights, which differ from the times of the spectra by
  an hour in older files.
- TRIAXYS: text. Directions are where waves come FROM, 0 and 360 degrees both listed.

References
----------
CDIP, "CDIP Wave Observations in NetCDF", cdip.ucsd.edu; UNESCO/IOC 2013, Manuals and Guides 54(3): flags 1 good, 2 not evaluated,
3 questionable, 4 bad, 9 missing.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.formats.tables.table_text import plain_number, read_cell_lines
from seaglint.formats.waves.ndbc_buoys import degrees_of, energy_of, frequency_of, numbers_of, travels_to
from seaglint.formats.waves.wave_records import (
    LOST_SHARE,
    Bands,
    Bins,
    Cosine,
    DirectionalMoments,
    Plain,
    WaveChoice,
    WaveRecords,
    as_utc,
    open_dataset,
    parsed,
    reader,
    require_one,
)
from seaglint.store import outputs

Record = Mapping[str, Any]

CDIP_DENSITY: Final = "waveEnergyDensity"  #: Variable of energies, by which these files are recognised.

_TIMES: Final = ("waveTime", "time")
_PLACES: Final = (
    ("metaDeployLatitude", "metaDeployLongitude"),
    ("metaStationLatitude", "metaStationLongitude"),
    ("gpsLatitude", "gpsLongitude"),
    ("latitude", "longitude"),
    ("lat", "lon"),
)
_MOMENTS: Final = ("waveA1Value", "waveB1Value", "waveA2Value", "waveB2Value")
_READ: Final = (
    *(CDIP_DENSITY, "waveFrequency", "waveBandwidth", "waveFrequencyFlagPrimary"),
    *("waveHs", "waveMeanDirection", "waveSpread", *_MOMENTS),
)
_FLAGS: Final = {1: "good", 2: "not_evaluated", 3: "questionable", 4: "bad", 9: "missing"}
_USED: Final = ("good", "not_evaluated")

_AGREE_DEG: Final = 5.0  # directions and spreads of one file, weighted by energy; CDIP's own agree to their last digit
_AGREE_ONE: Final = 1.05  # sampling noise of narrow swell exceeds 1 by less
_AGREE_WHOLE_DEG: Final = 30.0  # one mean direction for all bands, however it is averaged
_AGREE_HEIGHT: Final = 0.25  # share of the height: another unit of energy is at least a factor of 1.4 in height
_NARROWEST, _WIDEST_CDIP = 1.0, 80.0  # deg: the limits of the cosine to a power

_NAME: Final = re.compile(r"^(.*)\}(\d{4}-\d{2}-\d{2})T(\d{2})h(\d{2})Z?$")
_WIDEST: Final = (80.0, 81.1)  # deg: the cosine's limit, and sqrt(2) rad, the width of bands without any direction

_COLUMNS: Final = ("frequency", "varianceDensity", "a1", "b1", "a2", "b2")

_AGAIN: Final = "give a Spotter's file as its dashboard or programming interface wrote it, or see sea.spectrum.format"

_OBSCAPE_AGAIN: Final = "give a spectrum file (spec2D) as Obscape's portal wrote it, or see sea.spectrum.format"

#: Lines on the unit, and the factor to densities per degree.
_OBSCAPE_UNITS: Final = {"Variance-density [m2/Hz/rad]": np.pi / 180.0, "Variance-density [m2/Hz/deg]": 1.0}

_TYPE = re.compile(r"^\s*TYPE\s*=\s*(.*?)\s*$", re.MULTILINE)
_ZONE = re.compile(r"^\s*DATE\s*=.*\((.*?)\)", re.MULTILINE)


def read_cdip(path: Path, choice: WaveChoice) -> WaveRecords:
    """Read the good record nearest to the requested time.

    Raises
    ------
    DataError
        No good record near enough; units, directions or heights that contradict each other.
    """
    with open_dataset(path) as data:
        time = next((name for name in _TIMES if name in data.variables), None)
        times = np.array(["NaT"], "datetime64[ns]") if time is None else _times(data, time, path)
        flags = _flags(data, "waveFlagPrimary", times.size)
        site = _station(data)
        place = _place(data)
    index, note = (0, None) if time is None else _nearest(path, times, flags, choice)
    if time is None and flags[0] not in _USED:
        raise DataError(f"{path}: its record is flagged {flags[0]} (waveFlagPrimary); give a file with good records")

    def bands(_moment: int, _place: int) -> Bands:
        with open_dataset(path) as data:
            if time is not None and time in data[CDIP_DENSITY].dims:
                require_one(data[CDIP_DENSITY], time, np.flatnonzero((times == times[index]) & np.isin(flags, _USED)), path)
            # A deployment's file also has the displacements, hundreds of megabytes.
            record = data[[name for name in _READ if name in data.variables]]
            record = record.isel({time: index}) if time in data[CDIP_DENSITY].dims else record
            return _cdip_bands(record.load(), path)

    places = [None if value is None else np.full((1, 1), value) for value in place]
    return WaveRecords(bands, None if time is None else times[index : index + 1], (site,), *places, note=note)


def _times(data: Any, name: str, path: Path) -> NDArray[np.datetime64]:
    """Return the times of records; numbers without units are seconds since 1970, as CDIP documents them."""
    values = np.atleast_1d(data[name].values)
    if values.dtype.kind == "M":
        return values.astype("datetime64[ns]")
    if "units" in data[name].attrs or values.dtype.kind not in "iuf":
        raise DataError(f"{path}: {name} has no time that can be read; allowed: units = 'seconds since 1970-01-01 00:00:00 UTC'")
    seconds = values.astype(np.float64)
    known = np.isfinite(seconds) & (seconds > 0.0)
    return np.where(known, np.where(known, seconds, 0.0).astype("datetime64[s]").astype("datetime64[ns]"), np.datetime64("NaT"))


def _flags(data: Any, name: str, count: int) -> NDArray[np.str_]:
    """Return the meaning of each flag; good where the file has none."""
    if name not in data.variables:
        return np.full(count, "good")
    attributes = data[name].attrs
    values, meanings = attributes.get("flag_values"), str(attributes.get("flag_meanings", "")).split()
    names = _FLAGS if values is None or len(np.atleast_1d(values)) != len(meanings) else dict(zip(map(int, values), meanings, strict=True))
    numbers = np.broadcast_to(np.asarray(data[name].values, dtype=np.float64), (count,))
    return np.array(["missing" if np.isnan(number) else names.get(int(number), f"{number:g}") for number in numbers])


def _nearest(path: Path, times: NDArray[np.datetime64], flags: NDArray[np.str_], choice: WaveChoice) -> tuple[int, str | None]:
    """Return the index of the good record nearest in time, and a note where a nearer one is flagged."""
    dated = ~np.isnat(times)
    good = np.flatnonzero(dated & np.isin(flags, _USED))
    flagged = int(np.count_nonzero(dated)) - good.size
    without = f" without its {flagged} flagged record{'' if flagged == 1 else 's'} (waveFlagPrimary)" if flagged else ""
    if good.size == 0:
        shown = ", ".join(sorted(set(flags[dated].tolist())))
        raise DataError(f"{path} holds no good record" + (f": all {flagged} are flagged {shown} (waveFlagPrimary)" if flagged else ""))
    index, _ = choice.nearest_time(times[good], f"{path}{without}")
    taken = int(good[index])
    notes = [] if flags[taken] == "good" else [f"the record is flagged {flags[taken]} (waveFlagPrimary)"]
    if choice.time is not None:
        nearest = int(choice.nearest_time(times, str(path))[0])
        if times[nearest] != times[taken]:
            notes.insert(
                0, f"the record of {_text(times[nearest])} is flagged {flags[nearest]} (waveFlagPrimary): {_text(times[taken])} is taken"
            )
    return taken, "; ".join(notes) or None


def _text(time: Any) -> str:
    return f"{np.datetime_as_string(time, unit='s')}Z"


def _station(data: Any) -> str:
    """Return the name of the station, as 067p1 where the file has it."""
    if "metaStationName" not in data.variables:
        return "1"
    values = np.atleast_1d(data["metaStationName"].values).ravel()
    name = "".join(v.decode("utf-8", "replace") if isinstance(v, bytes) else str(v) for v in values).strip("\0 ")
    number = re.search(r"\b\d{3}p\d+\b", name)
    return (number[0] if number else name) or "1"


def _place(data: Any) -> tuple[float | None, float | None]:
    """Return latitude and longitude [deg]: of the deployment, of the station, or the middle of the positions."""
    for names in _PLACES:
        if all(name in data.variables for name in names):
            values = [numbers_of(data, name).ravel() for name in names]
            if all(np.any(np.isfinite(v)) for v in values):
                return float(np.nanmedian(values[0])), float(np.nanmedian(values[1]))
    return None, None


def _cdip_bands(data: Any, path: Path) -> Bands:
    """Return the bands of one record."""
    dims = data[CDIP_DENSITY].squeeze(drop=True).dims
    if len(dims) != 1:
        raise DataError(
            f"{path}: {CDIP_DENSITY} has dimensions {', '.join(map(str, data[CDIP_DENSITY].dims))}; "
            "one of time and one of frequency are read"
        )
    data = data.squeeze([d for d in data[CDIP_DENSITY].dims if d not in dims], drop=False)
    name = "waveFrequency" if "waveFrequency" in data.variables else str(dims[0])
    frequency, energy = frequency_of(data, name, path), energy_of(data, CDIP_DENSITY, path)
    good = np.isin(_flags(data, "waveFrequencyFlagPrimary", frequency.size), _USED)
    # Bands of CDIP have different widths: sums of energy need the width of each.
    width = numbers_of(data, "waveBandwidth") if "waveBandwidth" in data.variables else np.gradient(frequency)
    variance = np.where(np.isfinite(energy), energy, 0.0) * width
    if variance[~good].sum() > LOST_SHARE * variance.sum():
        raise DataError(
            f"{path}: bands with {100 * variance[~good].sum() / variance.sum():.0f} % of the energy are flagged (waveFrequencyFlagPrimary; "
            f"{100 * LOST_SHARE:.0f} % allowed); choose another time"
        )
    # The height by the widths and the height by the frequencies must agree: a wrong unit of either shows.
    between = np.trapezoid(np.where(np.isfinite(energy), energy, 0.0), frequency)
    height, without = (4.0 * float(np.sqrt(abs(value))) for value in (variance.sum(), between))
    if abs(height - without) > max(_AGREE_HEIGHT * without, 0.1):
        raise DataError(
            f"{path}: waveBandwidth gives a height of {height:.2f} m and waveFrequency {without:.2f} m; correct the one that is wrong"
        )
    _require_height(data, height, path)
    direction, spread = (
        name if name in data.variables and data[name].dims == dims else None for name in ("waveMeanDirection", "waveSpread")
    )
    mean, widths = (None if name is None else degrees_of(data, name, path) for name in (direction, spread))
    direction_is_to = direction is not None and travels_to(data, direction)
    if all(moment in data.variables and np.any(np.isfinite(numbers_of(data, moment))) for moment in _MOMENTS):
        a1, b1, a2, b2 = (numbers_of(data, moment) for moment in _MOMENTS)
        first, second = a1 + 1j * b1, a2 + 1j * b2
        _require_agreement(variance, first, second, mean, widths, path)
        if direction is None and "waveMeanDirection" in data.variables and data["waveMeanDirection"].size == 1:
            whole = degrees_of(data, "waveMeanDirection", path).ravel() - np.degrees(np.angle(np.nansum(variance * first)))
            _require_near(np.abs((whole + 180.0) % 360.0 - 180.0), np.ones(1), "moments and waveMeanDirection", path, _AGREE_WHOLE_DEG)
            direction_is_to = travels_to(data, "waveMeanDirection")
        return DirectionalMoments(frequency[good], energy[good], (first if direction_is_to else -first)[good], second[good])
    if mean is not None and widths is not None and np.any(np.isfinite(mean) & np.isfinite(widths)):
        come_from, widths = filled_directions(frequency, variance, mean + 180.0 if direction_is_to else mean, widths, str(path))
        return Cosine(frequency[good], energy[good], come_from[good], widths[good])
    return Plain(frequency[good], energy[good])


def filled_directions(
    frequency: FloatArray, variance: FloatArray, come_from: FloatArray, widths: FloatArray, what: str
) -> tuple[FloatArray, FloatArray]:
    """Return directions and widths of every band, interpolated where they are missing, the widths within the cosine's limits."""
    known, order = np.isfinite(come_from) & np.isfinite(widths), np.argsort(frequency)
    lost = variance[~known].sum() / max(float(variance.sum()), 1e-300)
    if lost > LOST_SHARE:
        raise DataError(
            f"{what}: lacks directions for {100 * lost:.0f} % of its energy ({100 * LOST_SHARE:.0f} % allowed); choose another time"
        )
    # Directions are interpolated as unit vectors, so that 359 and 1 deg have 0 deg between them.
    source = order[known[order]]
    vectors, sizes = (np.interp(frequency, frequency[source], values[source]) for values in (np.exp(1j * np.radians(come_from)), widths))
    return np.degrees(np.angle(vectors)) % 360.0, np.clip(sizes, _NARROWEST, _WIDEST_CDIP)


def _require_height(data: Any, height: float, path: Path) -> None:
    """Refuse energies that do not have the height that the file states."""
    stated = float(numbers_of(data, "waveHs").ravel()[0]) if "waveHs" in data.variables and data["waveHs"].size == 1 else np.nan
    if np.isfinite(stated) and abs(height - stated) > max(_AGREE_HEIGHT * stated, 0.1):
        raise DataError(
            f"{path}: {CDIP_DENSITY} gives a height of {height:.2f} m and waveHs is {stated:.2f} m; correct the one that is wrong"
        )


def _require_agreement(
    variance: FloatArray,
    first: NDArray[np.complex128],
    second: NDArray[np.complex128],
    mean: FloatArray | None,
    widths: FloatArray | None,
    path: Path,
) -> None:
    """Refuse moments that are not divided by the energy, or contradict mean directions or spreads."""
    known = np.isfinite(first) & np.isfinite(second) & (variance > 0.0)
    # Moments divided by the energy are at most 1.
    size = np.maximum(np.abs(first), np.abs(second))
    if np.any(known) and np.average(size[known] > _AGREE_ONE, weights=variance[known]) > LOST_SHARE:
        raise DataError(f"{path}: moments reach {size[known].max():.3g}, and 1 is the most; divide them by the energy density")
    if mean is not None:
        away = (np.degrees(np.angle(first)) - mean + 180.0) % 360.0 - 180.0
        _require_near(np.abs(away), variance * np.abs(first), "atan2(waveB1Value, waveA1Value) and waveMeanDirection", path)
    if widths is not None:
        own = np.degrees(np.sqrt(2.0 * np.maximum(1.0 - np.abs(first), 0.0)))
        _require_near(np.abs(own - widths), variance, "widths of waveA1Value, waveB1Value and waveSpread", path)


def _require_near(away: FloatArray, weight: FloatArray, what: str, path: Path, allowed: float = _AGREE_DEG) -> None:
    known = np.isfinite(away) & np.isfinite(weight) & (weight > 0.0)
    if np.any(known) and (apart := float(np.average(away[known], weights=weight[known]))) > allowed:
        raise DataError(f"{path}: {what} differ by {apart:.0f} deg ({allowed:g} allowed); correct the one that is wrong")


def read_datawell(path: Path) -> WaveRecords:
    """Read the only record of a file."""
    name = _NAME.match(path.stem)
    if name is None:
        raise DataError(f"{path}: the name does not tell place and time; Datawell names files such as 'buoy}}2024-09-09T01h15Z.spt'")
    moment = np.datetime64(datetime.fromisoformat(f"{name[2]}T{name[3]}:{name[4]}"))
    data = parsed(path, "a Datawell file", lambda: reader("read_datawell")(str(path), dd=None))
    columns = ("freq", "efth", "dmf", "dsprf")
    frequency, energy, directions, width = (np.asarray(data[key].values, dtype=np.float64).ravel() for key in columns)
    limit, most = _WIDEST
    if np.any(width > most):
        raise DataError(f"{path}: a width of {width.max():g} deg is above {most:g} deg, that of no direction at all; is the file whole?")
    return WaveRecords(
        lambda *_: Cosine(frequency, energy, directions, np.minimum(width, limit)), np.array([moment], "datetime64[ns]"), (name[1],)
    )


def read_obscape(path: Path) -> WaveRecords:
    """Read the only record of a CSV file.

    Raises
    ------
    DataError
        A line of the header that is missing or has another meaning, or a table of another size; with the line.
    """
    lines = [(number, line.strip()) for number, line in enumerate(outputs.read_text(path, _OBSCAPE_AGAIN).splitlines(), 1)]
    comments = [line[1:].strip() for _, line in lines if line.startswith("#")]
    header = {key.strip(): value.strip() for key, sign, value in (line.partition("=") for line in comments) if sign}
    for key in ("Timestamp", "Directions", "Columns [deg]", "Rows [Hz]"):
        if key not in header:
            raise DataError(f"{path}: its header has no line '# {key} = ...'; {_OBSCAPE_AGAIN}")
    if header["Directions"] != "True North":
        raise DataError(f"{path}: Directions = '{header['Directions']}' is not read; allowed: True North: correct them by the declination")
    unit = next((line for line in comments if line.lower().startswith("variance-density")), "")
    if unit not in _OBSCAPE_UNITS:
        raise DataError(f"{path}: '{unit or 'no unit'}' is not read; allowed: {' or '.join(_OBSCAPE_UNITS)}")
    frequency, directions = (_numbers(header[key], f"{path}: {key}") for key in ("Rows [Hz]", "Columns [deg]"))
    rows = [(number, line.split(",")) for number, line in lines if line and not line.startswith("#")]
    if len(rows) != frequency.size:
        raise DataError(f"{path}: has {len(rows)} rows and {frequency.size} frequencies in its header; is the file whole?")
    for number, cells in rows:
        if len(cells) != directions.size:
            raise DataError(
                f"{path}: line {number}: has {len(cells)} columns and the header {directions.size} directions; is the file whole?"
            )
    density = np.array([_numbers(",".join(cells), f"{path}: line {number}") for number, cells in rows]) * _OBSCAPE_UNITS[unit]
    places = [_numbers(header[key], f"{path}: {key}") if key in header else None for key in ("Latitude [deg]", "Longitude [deg]")]
    moment = np.datetime64(int(_numbers(header["Timestamp"], f"{path}: Timestamp")[0]), "s").astype("datetime64[ns]")
    return WaveRecords(
        lambda *_: Bins(frequency, directions, density),
        np.array([moment]),
        (header.get("Station name", "1"),),
        *(None if value is None else value.reshape(1, -1)[:, :1] for value in places),
    )


def _numbers(text: str, what: str) -> FloatArray:
    """Return the numbers of a list; ``0,3,6,... 357`` goes on in steps of 3."""
    start, dots, end = text.partition("...")
    try:
        values = [plain_number(cell) for cell in start.strip(" ,").split(",")]
        if dots:
            values = [*np.arange(values[0], plain_number(end.strip(" ,")) + 0.5 * (values[1] - values[0]), values[1] - values[0])]
    except (ValueError, IndexError, ZeroDivisionError) as error:
        raise DataError(f"{what}: is no list of numbers ({' '.join(str(error).split())[:80]}); {_OBSCAPE_AGAIN}") from None
    return np.array(values)


def read_spotter_json(path: Path) -> WaveRecords:
    """Read the records of ``data.frequencyData``."""
    records = parsed(path, "a Spotter's JSON", lambda: outputs.read_json(path, _AGAIN)["data"]["frequencyData"])
    return _records(path, "a Spotter's JSON", records)


def read_spotter_csv(path: Path) -> WaveRecords:
    """Read the records of a table with a column for each band and quantity: ``f_0``, ``a1_0``, ``varianceDensity_0`` and so on."""

    def parse() -> list[Record]:
        (head, *rest), _ = read_cell_lines(path, _AGAIN, ",")
        header = [name.split("(")[0].strip() for name in head.cells]
        return [_record(dict(zip(header, line.cells, strict=True))) for line in rest]

    return _records(path, "a Spotter's CSV", parsed(path, "a Spotter's CSV", parse))


def _record(row: Mapping[str, str]) -> Record:
    """Return one row of the table, laid out as the JSON's records are."""
    count = sum(name.startswith("f_") for name in row)
    record: JsonObject = {name: [float(row[f"{'f' if name == 'frequency' else name}_{i}"]) for i in range(count)] for name in _COLUMNS}
    moment = datetime.fromtimestamp(float(row["Epoch Time"]), UTC)
    return record | {"timestamp": moment.isoformat(), "latitude": row.get("Latitude"), "longitude": row.get("Longitude")}


def _records(path: Path, kind: str, records: Sequence[Record]) -> WaveRecords:
    def parse() -> WaveRecords:
        times = np.array([as_utc(record["timestamp"]) for record in records], dtype="datetime64[ns]")
        places = [np.array([[float(record[name])] for record in records]) for name in ("latitude", "longitude")]
        return WaveRecords(lambda moment, _: _spotter_bands(path, records[moment]), times, ("1",), *places)

    return parsed(path, kind, parse)


def _spotter_bands(path: Path, record: Record) -> Bands:
    frequency, energy, a1, b1, a2, b2 = (np.asarray(record.get(name, ()), dtype=np.float64) for name in _COLUMNS)
    if len({values.shape for values in (frequency, energy, a1, b1, a2, b2)}) > 1:
        raise DataError(
            f"{path}: the record of {record['timestamp']} lacks one of {', '.join(_COLUMNS)} in some bands; ask for all of them"
        )
    # The Spotter's angles theta: from counter-clockwise of east to clockwise of north: exp(i phi) = i conj(exp(i theta)).
    return DirectionalMoments(frequency, energy, 1j * np.conj(a1 + 1j * b1), -np.conj(a2 + 1j * b2))


def read_triaxys(path: Path) -> WaveRecords:
    """Read the only record of a file."""
    header = parsed(path, "a TRIAXYS file", lambda: path.read_text(encoding="utf-8")[:4096])
    kind, zone = _TYPE.search(header), _ZONE.search(header)
    if kind is None or kind[1] not in ("DIRECTIONAL SPECTRUM", "NON-DIRECTIONAL SPECTRUM"):
        raise DataError(
            f"{path}: TYPE = {kind[1] if kind else 'nothing'} is not read; allowed: DIRECTIONAL SPECTRUM or NON-DIRECTIONAL SPECTRUM"
        )
    if zone is not None and zone[1].strip().upper() not in ("UTC", "GMT", "Z"):
        raise DataError(f"{path}: its time is in '{zone[1]}', and UTC is read; change the line DATE")
    data = parsed(path, "a TRIAXYS file", lambda: reader("read_triaxys")(str(path)))
    frequency = np.asarray(data["freq"].values, dtype=np.float64)
    values = np.asarray(data["efth"].values, dtype=np.float64)[0]

    def bands(_moment: int, _place: int) -> Bands:
        if values.ndim == 1:
            return Plain(frequency, values)
        directions = np.asarray(data["dir"].values, dtype=np.float64)
        once = directions < 360.0 - 1e-6  # 0 and 360 are both in the file: one of them is left out
        return Bins(frequency, directions[once], values[:, once])

    return WaveRecords(bands, np.asarray(data["time"].values).astype("datetime64[ns]"))
