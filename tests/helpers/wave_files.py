"""Small files of one known sea in the layout of every format that is read, made from the formats' own descriptions.

The sea: 2 m high, 9 s, from 230 deg with a width of 30 deg; all numbers below are of this file, none of anybody's data.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import numpy as np
import xarray as xr

FROM = 230.0
TIMES = np.array(["2024-03-01T00:00", "2024-03-01T03:00"], dtype="datetime64[ns]")
FREQUENCY = np.round(0.04 * 1.08 ** np.arange(36), 5)  # 0.04-0.59 Hz
POWER = 2.0 / np.radians(30.0) ** 2 - 1.0
LATITUDE, LONGITUDE = 36.6, -122.4


def energy(frequency: np.ndarray = FREQUENCY) -> np.ndarray:
    """Height variance per hertz: Pierson-Moskowitz's shape at 2 m and 9 s [m2/Hz]."""
    return 5.0 / 16.0 * 2.0**2 * (1 / 9.0) ** 4 * frequency**-5.0 * np.exp(-1.25 * (9.0 * frequency) ** -4.0)


def density(from_deg: np.ndarray, frequency: np.ndarray = FREQUENCY) -> np.ndarray:
    """The same per degree of the direction waves come from [m2/Hz/deg], whatever frame the caller writes that direction in."""
    share = np.abs(np.cos(np.radians(from_deg - FROM) / 2.0)) ** (2.0 * POWER)
    return energy(frequency)[:, None] * share / (share.sum() * 360.0 / share.size)


def both_times(values: np.ndarray) -> np.ndarray:
    """The first time has half the height of the second, so that a reader that mixes them up is caught."""
    return np.stack([0.25 * values, values])


def ndbc(folder: Path) -> Path:
    """Realtime: five files, newest first."""
    r1, r2 = POWER / (POWER + 1), POWER * (POWER - 1) / ((POWER + 1) * (POWER + 2))
    columns = {
        ".data_spec": energy(),
        ".swdir": np.full(FREQUENCY.size, FROM),
        ".swdir2": np.full(FREQUENCY.size, FROM),
        ".swr1": np.full(FREQUENCY.size, r1),
        ".swr2": np.full(FREQUENCY.size, r2),
    }
    for suffix, values in columns.items():
        first = suffix == ".data_spec"
        head = "#YY  MM DD hh mm " + ("Sep_Freq  < spec_1 (freq_1) ... >" if first else "alpha1_1 (freq_1) ... >")
        lines = [head]
        for hour, scale in ((3, 1.0), (0, 0.25 if first else 1.0)):
            pairs = " ".join(f"{scale * value:.5f} ({f:.5f})" for value, f in zip(values, FREQUENCY, strict=True))
            lines.append(f"2024 03 01 {hour:02d} 00 {'9.999 ' if first else ''}{pairs}")
        (folder / f"46042{suffix}").write_text("\n".join(lines) + "\n")
    return folder / "46042.data_spec"


def ndbc_historical(folder: Path) -> Path:
    """A year's files: one header of frequencies, r1 and r2 in hundredths."""
    r1, r2 = POWER / (POWER + 1), POWER * (POWER - 1) / ((POWER + 1) * (POWER + 2))
    constant = {"d": FROM, "i": FROM, "j": 100 * r1, "k": 100 * r2}
    for letter in "wdijk":
        rows = both_times(energy()) if letter == "w" else np.full((2, FREQUENCY.size), constant[letter])
        lines = ["#YY  MM DD hh mm " + " ".join(f"{f:.5f}" for f in FREQUENCY)]
        lines += [f"2024 03 01 {hour:02d} 00 " + " ".join(f"{v:.4f}" for v in row) for hour, row in zip((0, 3), rows, strict=True)]
        (folder / f"46042{letter}2024.txt").write_text("\n".join(lines) + "\n")
    return folder / "46042w2024.txt"


def ndbc_netcdf(folder: Path) -> Path:
    """The buoy's NetCDF: one place as two dimensions of length one."""
    dims = ("time", "latitude", "longitude", "frequency")
    r1, r2 = POWER / (POWER + 1), POWER * (POWER - 1) / ((POWER + 1) * (POWER + 2))
    shape = (2, 1, 1, FREQUENCY.size)
    values = {"mean_wave_dir": FROM, "principal_wave_dir": FROM, "wave_spectrum_r1": r1, "wave_spectrum_r2": r2}
    data = xr.Dataset({name: (dims, np.full(shape, value)) for name, value in values.items()})
    data["spectral_wave_density"] = (dims, both_times(energy()).reshape(shape))
    coords = {"time": TIMES, "frequency": FREQUENCY, "latitude": [LATITUDE], "longitude": [LONGITUDE]}
    return _netcdf(data.assign_coords(coords), folder / "46042w9999.nc")


def mhkit(folder: Path, keep: tuple[str, ...] = ("units", "long_name", "description")) -> Path:
    """What MHKiT-Python's ``request_directional_data`` returns: dimensions date and frequency, r1 and r2 divided by 100."""
    r1, r2 = POWER / (POWER + 1), POWER * (POWER - 1) / ((POWER + 1) * (POWER + 2))
    attributes = {
        "swden": {"units": "m^2/Hz", "long_name": "omnidirecational spectrum", "standard_name": "S"},
        "swdir": {"units": "deg", "long_name": "mean wave direction", "standard_name": "α1"},
        "swdir2": {"units": "deg", "long_name": "principal wave direction", "standard_name": "α2"},
        "swr1": {"units": "", "long_name": "coordinate r1", "description": "First normalized polar coordinate (nondimensional)."},
        "swr2": {"units": "", "long_name": "coordinate r2", "description": "Second normalized polar coordinate (nondimensional)."},
    }
    shape = (2, FREQUENCY.size)
    values = (both_times(energy()), *(np.full(shape, value) for value in (FROM, FROM, r1, r2)))
    data = xr.Dataset(
        {
            name: (("date", "frequency"), array, {key: text for key, text in attributes[name].items() if key in keep})
            for name, array in zip(attributes, values, strict=True)
        },
        {"date": TIMES, "frequency": ("frequency", FREQUENCY, {"units": "Hz", "long_name": "frequency"})},
    )
    return _netcdf(data, folder / "buoy.nc")


def cdip_dataset() -> xr.Dataset:
    """CDIP's names and attributes: moments about the direction FROM, clockwise from true north; time in seconds; the place as scalars."""
    from_ = np.radians(FROM)
    r1, r2 = POWER / (POWER + 1), POWER * (POWER - 1) / ((POWER + 1) * (POWER + 2))
    shape = (2, FREQUENCY.size)
    moments = {"A1": r1 * np.cos(from_), "B1": r1 * np.sin(from_), "A2": r2 * np.cos(2 * from_), "B2": r2 * np.sin(2 * from_)}
    dims = ("waveTime", "waveFrequency")
    flag = {"flag_values": np.array([1, 2, 3, 4, 9], "i1"), "flag_meanings": "good not_evaluated questionable bad missing"}
    density = {"units": "meter^2 second", "standard_name": "sea_surface_wave_variance_spectral_density"}
    seconds = TIMES.astype("datetime64[s]").astype("i4")
    gps = ("gpsTime", seconds[:1], {"units": "seconds since 1970-01-01 00:00:00 UTC"})
    data = xr.Dataset(
        {
            "waveEnergyDensity": (dims, both_times(energy()).astype("f4"), density),
            "waveMeanDirection": (
                dims,
                np.full(shape, FROM, "f4"),
                {"units": "degreeT", "standard_name": "sea_surface_wave_from_direction"},
            ),
            "waveSpread": (dims, np.full(shape, np.degrees(np.sqrt(2 * (1 - r1))), "f4"), {"units": "degree"}),
            **{f"wave{name}Value": (dims, np.full(shape, value, "f4")) for name, value in moments.items()},
            "waveCheckFactor": (dims, np.ones(shape, "f4")),
            "waveBandwidth": ("waveFrequency", np.gradient(FREQUENCY).astype("f4"), {"units": "hertz"}),
            "waveFlagPrimary": ("waveTime", np.array([1, 1], "i1"), flag),
            "waveFrequencyFlagPrimary": ("waveFrequency", np.ones(FREQUENCY.size, "i1"), flag),
            "waveHs": ("waveTime", np.array([1.0, 2.0], "f4"), {"units": "meter"}),
            "metaStationLatitude": ((), LATITUDE, {"units": "degrees_north"}),
            "metaStationLongitude": ((), LONGITUDE, {"units": "degrees_east"}),
            "metaStationName": ("metaStationNameLength", np.array(list("POINT SUR, CA - 157p1"), "S1")),
            "gpsLatitude": ("gpsTime", [LATITUDE + 0.01]),
            "gpsLongitude": ("gpsTime", [LONGITUDE + 0.01]),
        },
        {
            "waveTime": ("waveTime", seconds, {"units": "seconds since 1970-01-01 00:00:00 UTC", "standard_name": "time"}),
            "waveFrequency": ("waveFrequency", FREQUENCY.astype("f4"), {"units": "hertz", "standard_name": "wave_frequency"}),
            "gpsTime": gps,
        },
    )
    for name in data.data_vars:
        if data[name].dims == dims:
            data[name].encoding["_FillValue"] = np.float32(-999.99)
    return data


def cdip(folder: Path) -> Path:
    """A station's file of CDIP."""
    return _netcdf(cdip_dataset(), folder / "157p1_rt.nc")


def spotter_records() -> list[dict]:
    """Spectra: moments about the direction TO, counter-clockwise from east, so that direction = 270 - atan2(b1, a1)."""
    to = np.radians(270.0 - FROM)
    r1, r2 = POWER / (POWER + 1), POWER * (POWER - 1) / ((POWER + 1) * (POWER + 2))
    moments = {"a1": r1 * np.cos(to), "b1": r1 * np.sin(to), "a2": r2 * np.cos(2 * to), "b2": r2 * np.sin(2 * to)}
    flat = {name: [float(value)] * FREQUENCY.size for name, value in moments.items()}
    rest = {"direction": [FROM] * FREQUENCY.size, "directionalSpread": [30.0] * FREQUENCY.size, "frequency": FREQUENCY.tolist()}
    return [
        flat
        | rest
        | {
            "df": np.gradient(FREQUENCY).tolist(),
            "varianceDensity": values.tolist(),
            "timestamp": f"{time}Z",
            "latitude": LATITUDE,
            "longitude": LONGITUDE,
        }
        for values, time in zip(both_times(energy()), np.datetime_as_string(TIMES, unit="s"), strict=True)
    ]


def spotter_json(folder: Path) -> Path:
    """Wave heights an hour later than the spectra, as older files have them."""
    path = folder / "spotter.json"
    heights = {"significantWaveHeight": 2.0, "peakPeriod": 9.0, "latitude": LATITUDE, "longitude": LONGITUDE}
    waves = [heights | {"timestamp": f"{time}Z"} for time in np.datetime_as_string(TIMES + np.timedelta64(1, "h"), unit="s")]
    path.write_text(json.dumps({"data": {"spotterId": "SPOT-0000", "waves": waves, "frequencyData": spotter_records()}}))
    return path


def spotter_csv(folder: Path) -> Path:
    """One column a band and quantity, names padded with blanks."""
    columns = ("df", "a1", "b1", "a2", "b2", "varianceDensity", "direction", "directionalSpread")
    names = [f"{name}_{i}" for name in ("f", *columns) for i in range(FREQUENCY.size)]
    header = ["Battery Voltage (V)", "Epoch Time", "Significant Wave Height (m)", "Latitude (deg)", "Longitude (deg)", *names]
    lines = [" ,".join(header)]
    for time, record in zip(TIMES.astype("datetime64[s]").astype(int), spotter_records(), strict=True):
        values = [value for name in ("frequency", *columns) for value in record[name]]
        lines.append(" ,".join(map(str, [4.07, int(time), 2.0, LATITUDE, LONGITUDE, *values])))
    path = folder / "spotter.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def swan(folder: Path, directions: str = "NDIR", locations: str = "LONLAT", times: bool = True) -> Path:
    """Standard spectral file of two places; the second has the sea, the first half its height."""
    values = np.arange(5.0, 360.0, 10.0) if directions == "NDIR" else np.arange(175.0, -185.0, -10.0)
    come_from = values if directions == "NDIR" else 270.0 - values
    lines = ["SWAN   1                                Swan standard spectral file", "$   made for a test"]
    lines += ["TIME                                    time-dependent data", "     1                  time coding option"] if times else []
    lines += [f"{locations}                                  locations", "     2                       number of locations"]
    lines += [f"  {LONGITUDE + 1:.4f}  {LATITUDE:.4f}", f"  {LONGITUDE:.4f}  {LATITUDE:.4f}"]
    lines += ["AFREQ                                   absolute frequencies in Hz", f"    {FREQUENCY.size}    number of frequencies"]
    lines += [f"    {f:.5f}" for f in FREQUENCY]
    lines += [f"{directions}                                    spectral directions in degr", f"    {values.size}    number of directions"]
    lines += [f"   {value:.4f}" for value in values]
    lines += [
        "QUANT",
        "     1                                  number of quantities in table",
        "VaDens      variance densities in m2/Hz/degr",
    ]
    lines += ["m2/Hz/degr                              unit", "   -99                                  exception value"]
    for hour in (0, 3) if times else (3,):
        lines += [f"20240301.{hour:02d}0000                         date and time"] if times else []
        for scale in (0.25, 1.0):
            table = scale * (0.25 if hour == 0 else 1.0) * density(come_from)
            factor = table.max() / 9998.0
            lines += ["FACTOR", f"    {factor:.8E}", *("".join(f"{round(v / factor):5d}" for v in row) for row in table)]
    path = folder / "swan.spec"
    path.write_text("\n".join(lines) + "\n")
    return path


def swan_netcdf(folder: Path, convention: str = "nautical") -> Path:
    """Points, radians, and the run's convention as an attribute."""
    values = np.arange(5.0, 360.0, 10.0)
    spectra = both_times(density(values if convention == "nautical" else 270.0 - values) * 180.0 / np.pi)
    data = xr.Dataset(
        {
            "density": (("time", "points", "frequency", "direction"), np.stack([0.25 * spectra, spectra], axis=1)),
            "longitude": (("points",), [LONGITUDE + 1, LONGITUDE]),
            "latitude": (("points",), [LATITUDE, LATITUDE]),
        },
        {"time": TIMES, "frequency": FREQUENCY, "direction": np.radians(values)},
        {"Directional_convention": convention},
    )
    return _netcdf(data, folder / "swan.nc")


def ww3(folder: Path) -> Path:
    """Station file with one point: directions TO in radians, from the east backwards, three digits."""
    to = (90.0 - 10.0 * np.arange(36) - 5.0) % 360.0
    spectrum = density(to + 180.0) * 180.0 / np.pi

    def columns(values: np.ndarray, count: int) -> list[str]:
        return ["".join(f" {v:.3E}" for v in values[i : i + count]) for i in range(0, values.size, count)]

    lines = [f"'WAVEWATCH III SPECTRA'     {FREQUENCY.size}    36     1 'spectral resolution for points'"]
    lines += columns(FREQUENCY, 8) + columns(np.radians(to), 7)
    for hour, scale in ((0, 0.25), (3, 1.0)):
        lines += [f"20240301 {hour:02d}0000", f"'46042     '  {LATITUDE:.2f} {LONGITUDE:.2f}    1000.0   5.00 225.6   0.18  94.1"]
        lines += columns((scale * spectrum).T.ravel(), 7)
    path = folder / "46042.spec"
    path.write_text("\n".join(lines) + "\n")
    return path


def ww3_netcdf(folder: Path, standard_name: str = "sea_surface_wave_to_direction") -> Path:
    """Point output: directions TO, backwards, and coordinates that depend on time."""
    directions = (90.0 - 15.0 * np.arange(24)) % 360.0
    to = "to_direction" in standard_name
    spectra = both_times(density(directions + 180.0 if to else directions) * 180.0 / np.pi)
    dims = ("time", "station", "frequency", "direction")
    data = xr.Dataset(
        {
            "efth": (dims, np.stack([0.25 * spectra, spectra], axis=1).astype("f4")),
            "longitude": (("time", "station"), np.tile([LONGITUDE + 1, LONGITUDE], (2, 1))),
            "latitude": (("time", "station"), np.full((2, 2), LATITUDE)),
            "station_name": (("station", "string16"), np.array([list("46041".ljust(16)), list("46042".ljust(16))], dtype="S1")),
        },
        {
            "time": TIMES,
            "station": [1, 2],
            "frequency": FREQUENCY,
            "direction": ("direction", directions, {"standard_name": standard_name}),
        },
    )
    return _netcdf(data, folder / "ww3.nc")


def era5(folder: Path, new: bool = True) -> Path:
    """Decimal logarithm, directions TO by number, land and next to nothing left out; both layouts."""
    frequency = 0.03453 * 1.1 ** np.arange(30)
    to = 7.5 + 15.0 * np.arange(24)
    values = np.log10(density(to + 180.0, frequency) * 180.0 / np.pi)
    grid = np.full((2, 24, 30, 2, 2), np.nan)
    for t, shift in ((0, np.log10(0.25)), (1, 0.0)):
        grid[t, :, :, 0, 1] = (values + shift).T
        grid[t, :, :, 1, 1] = (values + shift + np.log10(0.25)).T
    grid[grid < -4.0] = np.nan
    time, direction, number = ("valid_time", "directionNumber", "frequencyNumber") if new else ("time", "direction", "frequency")
    data = xr.Dataset(
        {"d2fd": ((time, direction, number, "latitude", "longitude"), grid)},
        {time: TIMES, "latitude": [LATITUDE, LATITUDE - 0.5], "longitude": [LONGITUDE + 359.5, LONGITUDE + 360.0]},
    )
    if new:
        data = data.assign_coords(number=0, expver=((time,), ["0001", "0001"]))
        data = data.assign_coords({direction: np.arange(1.0, 25.0), number: np.arange(1.0, 31.0)})
    return _netcdf(data, folder / "era5.nc")


def triaxys(folder: Path) -> Path:
    """One record; 0 and 360 degrees both."""
    frequency = 0.01 * np.arange(60)
    table = np.zeros((60, 121))
    table[4:] = np.array(density(np.arange(0.0, 360.0, 3.0), frequency[4:]))[:, np.r_[0:120, 0]]
    return _triaxys(folder / "a.DIRSPEC", "DIRECTIONAL SPECTRUM", table, ["COLUMNS = 0.00 TO 360.00 DEG", "ROWS\t= 0.00 TO   0.59 Hz"])


def triaxys_plain(folder: Path) -> Path:
    """Energy alone, frequencies beside it."""
    frequency = 0.01 * np.arange(60)
    values = np.r_[np.zeros(4), energy(frequency[4:])]
    names = ["COLUMN 1 = FREQUENCY (Hz)", "COLUMN 2 = SPECTRAL DENSITY (M^2/Hz)"]
    return _triaxys(folder / "a.NONDIRSPEC", "NON-DIRECTIONAL SPECTRUM", np.stack([frequency, values], axis=1), names)


def _triaxys(path: Path, kind: str, table: np.ndarray, last: list[str]) -> Path:
    lines = ["TRIAXYS BUOY DATA REPORT - TAS00000 - TAB00000", "VERSION = WV", f"TYPE    = {kind}", "DATE    = 2024-03-01 03:00(UTC)"]
    lines += [f"NUMBER OF FREQUENCIES              =   {len(table)}", "INITIAL FREQUENCY (Hz)             =   0.000"]
    lines += ["FREQUENCY SPACING (Hz)             =   0.010"]
    if table.shape[1] > 2:
        lines += [f"NUMBER OF DIRECTIONS               =     {table.shape[1]}", "DIRECTION SPACING (DEG)            =       3"]
    lines += [*last, *(" ".join(f"{value:.5E}" for value in row) for row in table)]
    path.write_text("\n".join(lines) + "\n")
    return path


def octopus(folder: Path) -> Path:
    """Variance per bin; a band is as wide as half the distance of its neighbours."""
    directions = np.arange(5, 360, 10)
    variance = density(directions) * np.gradient(FREQUENCY)[:, None] * 10.0
    lines = ["Forecast valid for 01-Mar-2024 00:00:00", f"nfreqs,{FREQUENCY.size}", "ndir,36", "nrecs,2"]
    lines += [f"Latitude, {LATITUDE}", f"Longitude, {LONGITUDE}", "Depth,1000.0", ""]
    for day, table in zip(("'010000", "'010300"), both_times(variance), strict=True):
        lines += [
            "CCYYMM,DDHHmm,LPoint,WD,WS,ETot",
            f"202403,{day},p,123,11.64,0.0759",
            f"freq,{','.join(f'{f:.5f}' for f in FREQUENCY)},anspec",
        ]
        lines += [f"{d},{','.join(f'{v:.7f}' for v in column)},{column.sum():.7f}," for d, column in zip(directions, table.T, strict=True)]
        lines += ["fSpec," + ",".join(f"{v:.5f}" for v in table.sum(axis=1)) + ",", "den,", ""]
    path = folder / "forecast.oct"
    path.write_text("\n".join(lines) + "\n")
    return path


def datawell(folder: Path) -> Path:
    """Twelve lines about the buoy, then frequency, relative energy, direction FROM, width, skewness, kurtosis."""
    largest = energy().max()
    lines = ["10", "200.0", "6.5", f"{largest:.6E}", "25.05", "19.65", "7", "-0.2", "0.4", "0.3", "213.8", "68.2"]
    lines += [f"{f:.5f},{value / largest:.6E},{FROM},30.0,0.1,3.0" for f, value in zip(FREQUENCY, energy(), strict=True)]
    path = folder / "buoy}2024-03-01T03h00Z.spt"
    path.write_text("\n".join(lines) + "\n")
    return path


def obscape(folder: Path, unit: str = "m2/Hz/rad", directions: str = "True North") -> Path:
    """The portal's CSV: the second time alone, 3 deg steps written with three dots, local time beside the UTC second."""
    columns = np.arange(0.0, 360.0, 3.0)
    values = density(columns) * (180.0 / np.pi if unit.endswith("rad") else 1.0)
    lines = [
        "# Downloaded at 2024-03-02 08:08:46 [UTC]",
        "# Station name = Example",
        "# Device type = Wavebuoy",
        "# Device serial = 000000",
        f"# Latitude [deg] = {LATITUDE}",
        f"# Longitude [deg] = {LONGITUDE}",
        f"# Timestamp = {TIMES[1].astype('datetime64[s]').astype(int)}",
        "# Timestring = 2024-03-01 04:00:00",
        "# Timezone = Europe/Amsterdam",
        "# Magnetic declination (corrected) [deg] = 13",
        f"# Directions = {directions}",
        "# ",
        "# Columns [deg] = 0,3,6,... 357",
        f"# Rows [Hz] = {','.join(f'{f:.6f}' for f in FREQUENCY)}",
        f"# Variance-density [{unit}]",
        *(",".join(f"{value:.6f}" for value in row) for row in values),
    ]
    path = folder / "20240301_030000_wavebuoy_000000_spec2D.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def nmea(*cells: object) -> str:
    """A sentence with its checksum."""
    body = ",".join(map(str, cells))
    check = 0
    for letter in body:
        check ^= ord(letter)
    return f"${body}*{check:02X}"


def awac(folder: Path, directions: str = "PNORF", unit: float = 1.0) -> Path:
    """Telegrams: energies of 98 bands, coefficients of the first 68 about the direction FROM, clockwise from north."""
    frequency = 0.02 + 0.01 * np.arange(98)
    from_ = np.radians(FROM)
    r1, r2 = POWER / (POWER + 1), POWER * (POWER - 1) / ((POWER + 1) * (POWER + 2))
    parts = {
        "PNORF": {"A1": r1 * np.cos(from_), "B1": r1 * np.sin(from_), "A2": r2 * np.cos(2 * from_), "B2": r2 * np.sin(2 * from_)},
        "PNORWD": {"MD": FROM, "DS": 30.0},
        "none": {},
    }[directions]
    lines = [nmea("PNORI", 3, "WAV0000", 3, 18, 0.41, "1.00", 0)]
    for hour, scale in ((0, 0.25), (3, 1.0)):
        when, values = ("030124", f"{hour:02d}0000"), scale * energy(frequency)
        height = 4.0 * np.sqrt(values.sum() * 0.01)
        rest = (
            *("0.00",) * 3,
            "7.00",
            "9.00",
            "7.50",
            f"{FROM:.2f}",
            "30.00",
            f"{FROM:.2f}",
            "0.90",
            "16.39",
            0,
            0,
            "0.13",
            "76.10",
            "0000",
        )
        lines.append(nmea("PNORS", *when, "00", "30", 14.6, "1513.0", 291.1, 2.0, 0.3, 16.365, 17.07, 0, 0))
        lines.append(nmea("PNORW", *when, 3, 4, f"{height:.2f}", *rest))
        lines.append(nmea("PNORE", *when, 3, "0.02", "0.01", 98, *(f"{value / unit:.4f}" for value in values)))
        for part, value in parts.items():
            cells = [f"{value:.4f}"] * 68 + ["-9.0000"] * 3
            lines.append(nmea(directions, part, *when, 3, "0.02", "0.01", len(cells), *cells))
    path = folder / "waves.nmea"
    path.write_text("\r\n".join(lines) + "\r\n")
    return path


def awac_directions(folder: Path) -> Path:
    """The same with main direction and spread."""
    return awac(folder, "PNORWD")


def wwm_dataset() -> xr.Dataset:
    """WWM's stations: action over angular frequency and direction TO, counter-clockwise from the x axis, in Fortran's order of axes."""
    theta = np.radians(np.arange(0.0, 360.0, 10.0) + 5.0)
    sigma = 2.0 * np.pi * FREQUENCY
    # m2/Hz/deg to m2 s/rad/rad: per angular frequency, per radian, over the angular frequency.
    action = density(270.0 - np.degrees(theta)) * (180.0 / np.pi) / (2.0 * np.pi) / sigma[:, None]
    both = np.stack([0.25 * both_times(action), both_times(action)], axis=-1)
    return xr.Dataset(
        {
            "AC": (("ocean_time", "ndir", "nfreq", "nbstation"), both.transpose(0, 2, 1, 3), {"units": "unk"}),
            "SPSIG": ("nfreq", sigma, {"units": "list of wave frequencies"}),
            "SPDIR": ("ndir", theta, {"units": "list of wave directions"}),
            "lon": ("nbstation", [LONGITUDE + 1, LONGITUDE]),
            "lat": ("nbstation", [LATITUDE, LATITUDE]),
            "DEP": (("ocean_time", "nbstation"), np.full((2, 2), 1000.0)),
            "HS": (("ocean_time", "nbstation"), [[0.5, 1.0], [1.0, 2.0]]),
        },
        {"ocean_time": TIMES},
    )


def wwm(folder: Path) -> Path:
    """A run's stations."""
    return _netcdf(wwm_dataset(), folder / "wwm_sta_0001.nc")


def stored(write: Callable[..., Path], folder: Path, version: Literal[2, 3] = 3) -> Path:
    """The NetCDF of another writer here as a Zarr store."""
    with xr.open_dataset(write(folder)) as data:
        for name in data.variables:
            data[name].encoding = {}
        data.load().to_zarr(folder / "waves.zarr", zarr_format=version, consolidated=version == 2)
    return folder / "waves.zarr"


def ww3_zarr(folder: Path) -> Path:
    """WAVEWATCH III as a store of version 2 with consolidated metadata, as wavespectra's users have it."""
    return stored(ww3_netcdf, folder, 2)


def packed(folder: Path) -> Path:
    """A packed store, with its folder inside the archive."""
    stored(own, folder)
    return Path(shutil.make_archive(str(folder / "packed.zarr"), "zip", folder, "waves.zarr"))


def own(folder: Path) -> Path:
    """What wavespectra writes itself."""
    directions = np.arange(0.0, 360.0, 15.0)
    spectra = both_times(density(directions))
    data = xr.Dataset(
        {
            "efth": (("time", "site", "freq", "dir"), np.stack([0.25 * spectra, spectra], axis=1)),
            "lon": (("site",), [LONGITUDE + 1, LONGITUDE]),
            "lat": (("site",), [LATITUDE, LATITUDE]),
        },
        {"time": TIMES, "site": [1, 2], "freq": FREQUENCY, "dir": directions},
    )
    return _netcdf(data, folder / "own.nc")


def _netcdf(data: xr.Dataset, path: Path) -> Path:
    data.to_netcdf(path, engine="h5netcdf")
    return path
