"""Files of observations with dirt: what can be read is read, the rest is counted by kind, against readings of the tests' own."""

from __future__ import annotations

import gzip
import random
import re
import time
from calendar import monthrange
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
from tests.helpers import weather_files as made

from seaglint.base.errors import DataError, SeaglintError
from seaglint.climate.weather_selection import Selection
from seaglint.formats.weather.weather_cells import WeatherSource
from seaglint.formats.weather.weather_file import WeatherReading, read_source
from seaglint.scenario.text.option_texts import parse_map
from seaglint.studies.likelihood.weather_files import build

#: Lines of ICOADS release 3 (NOAA, public domain), decks 714, 892, 792, 992, 781 and 703; the first two and the last three have commas in
#: their attachments.
RECORDS = Path(__file__).parent / "imma1_records.txt"

#: Code table 4377 of WMO's Manual on Codes: lower border of each step [km]; 90 is below 0.05 km.
VISIBILITY = {90: 0.025, 91: 0.05, 92: 0.2, 93: 0.5, 94: 1.0, 95: 2.0, 96: 4.0, 97: 10.0, 98: 20.0, 99: 50.0}

#: First and last column of the fields that are used, counted from 1, as the published table C0 has them.
COLUMNS = {
    "MO": (5, 6), "DY": (7, 8), "HR": (9, 12), "LAT": (13, 17), "LON": (18, 23), "D": (47, 49), "W": (51, 53), "VV": (55, 56),
    "WW": (57, 58), "AT": (70, 73), "DPT": (80, 83), "SST": (86, 89), "N": (90, 90), "WH": (101, 102), "SH": (107, 108),
}  # fmt: skip


def _read(path: Path, *columns: str, **reading: object) -> WeatherSource:
    return read_source(path, Selection(), WeatherReading(parse_map(list(columns)), **reading))  # type: ignore[arg-type]


def _whole(text: bytes) -> int | None:
    return int(text) if re.fullmatch(rb"[+-]?[0-9]+", text) else None


def _plain(record: bytes) -> dict[str, float]:
    """Read one good record by slices of its columns; a field that is cut or no number is missing."""
    out = {}
    for name, (first, last) in COLUMNS.items():
        number = _whole(record[first - 1 : last].strip(b" ")) if len(record) >= last else None
        out[name] = np.nan if number is None else float(number)
    return out


def _fault(record: bytes) -> str:
    """Say what is wrong with a record, by the rules of the guide."""
    if len(record) < 45:
        return "shorter than 45 columns"
    cells = [record[a:b].strip(b" ") for a, b in ((0, 4), (4, 6), (6, 8), (8, 12), (12, 17), (17, 23))]
    if any(cell and _whole(cell) is None for cell in cells):
        return "with something else than numbers in date and place"
    year, month, day, _, lat, lon = (_whole(cell) if cell else None for cell in cells)
    if year is None:
        return "without a year"
    if not 1600 <= year <= 2100:
        return "with a year outside 1600 to 2100"
    if month is not None and not 1 <= month <= 12:
        return "with a month outside 1 to 12"
    if day is not None and not 1 <= day <= (31 if month is None else monthrange(year, month)[1]):
        return "with a day that its month does not have"
    return "with a place outside the globe" if abs(lat or 0) > 9000 or not -18000 <= (lon or 0) <= 36000 else ""


def _same(source: WeatherSource, records: list[bytes]) -> None:
    """Compare columns with those of the plain reading."""
    plain = [_plain(record) for record in records]
    f = {name: np.array([row[name] for row in plain]) for name in COLUMNS}
    column = source.columns
    speed = np.where(np.isnan(f["W"]) & (f["D"] == 361), 0.0, f["W"] / 10)
    speed[(speed < 0) | (speed > 100)] = np.nan
    np.testing.assert_allclose(column["wind_speed_m_s"], speed, rtol=1e-12)
    known = (f["D"] >= 0) & (f["D"] <= 360) & ~(np.where(f["W"] == 0, True, np.isnan(f["W"]) & (f["D"] == 361)))
    np.testing.assert_array_equal(column["wind_from_deg"], np.where(known, f["D"] % 360, np.nan))
    hidden = (f["N"] == 9) & np.isin(f["WW"], [10, 11, 12, *range(40, 50), *range(50, 76), 77, 79, *range(80, 100)])
    np.testing.assert_array_equal(column["cloud_cover"], np.where(hidden, 1.0, np.where(f["N"] == 9, np.nan, f["N"] / 8)))
    for name, field, low, high in (("sea_temperature_k", "SST", 265.0, 315.0), ("air_temperature_k", "AT", 200.0, 335.0)):
        kelvin = f[field] / 10 + 273.15
        np.testing.assert_allclose(column[name], np.where((kelvin < low) | (kelvin > high), np.nan, kelvin), rtol=1e-12)
    np.testing.assert_array_equal(column["visibility_km"], [VISIBILITY.get(code, np.nan) for code in f["VV"].tolist()])
    np.testing.assert_array_equal(column["month"], f["MO"])
    hour = f["HR"] / 100
    np.testing.assert_allclose(column["hour_utc"], np.where((hour < 0) | (hour > 24), np.nan, hour), rtol=1e-12)
    np.testing.assert_allclose(column["latitude_deg"], f["LAT"] / 100, rtol=1e-12)
    np.testing.assert_allclose(column["longitude_deg"], (f["LON"] / 100 + 180) % 360 - 180, atol=1e-9)
    square = (np.nan_to_num(f["WH"]) ** 2 + np.nan_to_num(f["SH"]) ** 2) / 4
    height = np.where(np.isnan(f["WH"]) & np.isnan(f["SH"]), np.nan, np.sqrt(square))
    np.testing.assert_allclose(column["significant_height_m"], np.where(height > 40, np.nan, height), rtol=1e-12)


def test_records_of_six_decks_with_commas_in_their_attachments() -> None:
    records = RECORDS.read_bytes().split(b"\n")[:-1]
    source = _read(RECORDS)
    assert (source.kind, source.read, source.rows, source.left_out) == ("ICOADS IMMA1", 14, 14, {})
    _same(source, records)


def test_ships_records_are_those_of_their_own_messages() -> None:
    """Attachments of recent ships hold the message as it was sent (WMO FM 13): cloud, wind, temperatures."""
    source = _read(RECORDS)
    found = 0
    for row, record in enumerate(RECORDS.read_text().splitlines()):
        message = re.search(r"BBXX.* \d\d\d\d([0134]) 99\d{3} \d{5} \S{5} (\d)(\d\d)(\d\d) 1([01])(\d{3}) (?:2([01])(\d{3}) )?", record)
        if message is None:
            continue
        found += 1
        unit = 1.0 if message[1] in "01" else 1852 / 3600  # indicator of the wind's unit
        column = {name: values[row] for name, values in source.columns.items()}
        assert column["wind_from_deg"] == 10 * int(message[3]) % 360
        assert column["wind_speed_m_s"] == pytest.approx(unit * int(message[4]), abs=0.06)
        if message[2] != "9":
            assert column["cloud_cover"] == int(message[2]) / 8
        assert column["air_temperature_k"] - 273.15 == pytest.approx((-1) ** int(message[5]) * int(message[6]) / 10)
        if message[8]:
            dew = (-1) ** int(message[7]) * int(message[8]) / 10
            a, air = 17.625, column["air_temperature_k"] - 273.15
            assert column["relative_humidity"] == pytest.approx(np.exp(a * dew / (243.04 + dew) - a * air / (243.04 + air)), rel=1e-3)
    assert found == 5


DIRT = [
    ",",
    '"',
    "'",
    "\t",
    ";",
    "\x00",
    "\x01",
    "\x0b",
    "\x0c",
    "\x1c",
    "\x1d",
    "\x85",
    "\xa0",
    "\xff",
    "\r",
    "#",
    " ",
    "²",
    "a",
    "7",
    "-",
]


def _fuzzed(rng: random.Random) -> bytes:
    """One line: a record with any values, an attachment of any signs, and in one of four something that is not right."""

    def field(width: int, low: int, high: int, blank: float = 0.1) -> str:
        return " " * width if rng.random() < blank else f"{rng.randint(low, high):>{width}}"

    values = {
        "yr": str(rng.randint(1850, 2024)), "mo": field(2, 1, 12), "dy": field(2, 1, 28), "hr": field(4, 0, 2399),
        "lat": field(5, -9000, 9000), "lon": field(6, 0, 35999), "d": field(3, 1, 362), "w": field(3, 0, 400), "vv": field(2, 90, 99),
        "ww": field(2, 0, 99), "at": field(4, -300, 400), "dpt": field(4, -300, 300), "sst": field(4, -20, 350), "n": field(1, 0, 9),
        "wh": field(2, 0, 30), "sh": field(2, 0, 30),
    }  # fmt: skip
    if rng.random() < 0.15:
        values |= rng.choice(
            [
                {"yr": "    "}, {"yr": "20x4"}, {"mo": "13"}, {"mo": " 2", "dy": "30"}, {"lat": " 9512"}, {"lon": " 99999"},
                {"d": "-50"},
                {"d": "999"}, {"w": "1x3"}, {"n": "A"}, {"hr": "9999"}, {"lat": "45,12"}, {"mo": "\t7"}, {"sst": " 9 9"}, {"w": "-12"},
            ]
        )  # fmt: skip
    core = made.imma(**values).encode("latin-1")[:108]
    attached = "".join(rng.choice(DIRT) for _ in range(rng.choice([0, 1, 30, 200]))).encode("latin-1")
    line = core + attached
    chance = rng.random()
    if chance < 0.05:
        line = line[: rng.randint(1, 107)]  # cut
    elif chance < 0.08:
        line = bytes(rng.randrange(256) for _ in range(rng.randint(1, 150))).replace(b"\n", b"?")
    return line


def test_five_thousand_fuzzed_records_against_a_plain_reading(tmp_path: Path) -> None:
    rng = random.Random(51)
    lines = [_fuzzed(rng) for _ in range(5000)]
    path = tmp_path / "imma1"
    path.write_bytes(b"\n".join(line + b"\r" * rng.choice([0, 1]) for line in lines) + b"\n")
    source = _read(path)
    # A line of blanks is none; the carriage return at its end is not of the line.
    lines = [line.removesuffix(b"\r") for line in path.read_bytes().split(b"\n")]
    lines = [line for line in lines if line.strip(b" ")]
    faults = [_fault(line) for line in lines]
    assert source.left_out == dict(Counter(fault for fault in faults if fault))
    assert len(source.left_out) >= 6
    assert source.read == len(lines)
    _same(source, [line for line, fault in zip(lines, faults, strict=True) if not fault])
    assert source.set_missing["wind_from_deg outside 0 to 362"] > 10
    assert source.set_missing["W that is no whole number"] > 10


def test_bad_lines_are_told_by_kind_and_more_than_half_are_an_error(tmp_path: Path) -> None:
    path = tmp_path / "imma1"
    bad = ["2005 714", "x" * 60, made.imma(mo="13"), made.imma(yr="    ")]
    path.write_text("\n".join([made.imma(), *bad, made.imma(w="1x3"), made.imma(), made.imma(d="-50")]) + "\n")
    source = _read(path)
    assert source.left_out == {
        "shorter than 45 columns": 1,
        "with something else than numbers in date and place": 1,
        "with a month outside 1 to 12": 1,
        "without a year": 1,
    }
    assert source.rows == 4
    assert source.set_missing == {"W that is no whole number": 1, "wind_from_deg outside 0 to 362": 1}
    assert "1 records are exact copies of earlier ones; all are kept" in source.notes
    path.write_text("\n".join(["2005, 714", *bad, made.imma(), made.imma(), "a,b"]) + "\n")
    told = "6 of 8 lines are no IMMA records: 3 shorter than 45 columns, 1 with something else than numbers in date and place, "
    with pytest.raises(DataError, match=re.escape(told) + r".*the first is line 1: '2005, 714'; is the file whole and IMMA1\?"):
        _read(path)
    # Records that are all cut are still told as records, and not as a CSV file.
    path.write_text("\n".join(made.imma()[:30] + ",," for _ in range(3)) + "\n")
    with pytest.raises(DataError, match="3 of 3 lines are no IMMA records: 3 shorter than 45 columns"):
        _read(path)


def test_codes_of_calm_and_variable_winds(tmp_path: Path) -> None:
    """361 is a calm, also without a speed; 362 is a variable wind; neither is a direction, nor dirt."""
    path = tmp_path / "imma1"
    path.write_text("\n".join([made.imma(d="361", w="   "), made.imma(d="362", w=" 31"), made.imma(d="360"), made.imma(d="370")]) + "\n")
    source = _read(path)
    np.testing.assert_array_equal(source.columns["wind_speed_m_s"], [0.0, 3.1, 10.3, 10.3])
    np.testing.assert_array_equal(source.columns["wind_from_deg"], [np.nan, np.nan, 0.0, np.nan])
    assert source.set_missing == {"wind_from_deg of a calm or variable wind": 2, "wind_from_deg outside 0 to 362": 1}


def test_dirt_in_a_buoys_file_is_counted(tmp_path: Path) -> None:
    head, units, good, missing, calm = made.NDBC_2019.splitlines()
    path = tmp_path / "44011.txt"
    rows = [
        good, good.replace("01 01 00 50", "02 30 00 50"), good + " 7", good.replace("310 ", "400 "), good.replace("12.3", "1x.3"),
        missing, calm, good.replace("2019 01", "2019 13"), head, good.replace("12.3", "77.0"), "\x00\x01\x02",
    ]  # fmt: skip
    path.write_text("\n".join([head, units, *rows]) + "\n")
    source = _read(path, anemometer_m=4.1)
    assert source.left_out == {"with a date that there is not": 2, "with another number of cells": 2}
    assert source.set_missing == {
        "WSPD that is no number": 1,
        "wind_from_deg outside 0 to 360": 1,
        "wind_speed_m_s outside the logarithmic profile, 0 to 40 at 10 m": 1,
    }
    assert (source.read, source.rows) == (10, 6)
    np.testing.assert_array_equal(np.isnan(source.columns["wind_speed_m_s"]), [False, False, True, True, False, True])
    np.testing.assert_array_equal(source.columns["wind_from_deg"], [310.0, np.nan, 310.0, np.nan, np.nan, 310.0])
    path.write_text("\n".join([head, units, good, "x", "y"]) + "\n")
    with pytest.raises(DataError, match="2 of 3 lines are no NDBC records: 2 with another number of cells; the first is line 4: 'x'"):
        _read(path)
    path.write_text("\n".join([head, units, good, made.NDBC_REALTIME]))
    with pytest.raises(DataError, match="line 4: has other headings than line 1"):
        _read(path)


#: Headings of NCEI's archive of global marine data, as its files have them.
NCEI = (
    "STATION,DATE,LATITUDE,LONGITUDE,ELEVATION,NAME,IMMA_VER,ATTM_CT,TIME_IND,LL_IND,SHIP_COURSE,SHIP_SPD,ID_IND,WIND_DIR_IND,"
    "WIND_DIR,WIND_SPD_IND,WIND_SPEED,VV_IND,VISIBILITY,PRES_WX,PAST_WX,SEA_LVL_PRES,CHAR_PPP,AMT_PRES_TEND,IND_FOR_TEMP,AIR_TEMP,"
    "IND_FOR_WBT,WET_BULB_TEMP,DEW_PT_TEMP,SST_MM,SEA_SURF_TEMP,TOT_CLD_AMT,LOW_CLD_AMT,LOW_CLD_TYPE,CLD_HGT,MID_CLD_TYPE,"
    "HI_CLD_TYPE,WAVE_DIR,WAVE_PERIOD,WAVE_HGT,SWELL_DIR,SWELL_PERIOD,SWELL_HGT,TEN_BOX_NUM,ONE_BOX_NUM,DECK,SOURCE_ID,"
    "PLATFORM_ID,DUP_STATUS,DUP_CHK,NIGHT_DAY_FLAG,TRIM_FLAG,NCDC_QC_FLAGS,SOURCE_EXCLUSION_FLAG,OB_SOURCE,STA_WX_IND,PAST_WX2,"
    "DIR_OF_SWELL2,PER_OF_SWELL2,HGT_OF_SWELL2,THICKNESS_OF_I,CONCEN_OF_SEA_ICE,STAGE_OF_DEVELP,ICE_OF_LAND_ORIGIN,"
    "TRUE_BEARING_ICE_EDGE,ICE_SIT_TREND,IND_FOR_PRECIP"
)

_OF_IMMA = {
    "WIND_DIR": "D", "WIND_SPEED": "W", "VISIBILITY": "VV", "PRES_WX": "WW", "AIR_TEMP": "AT", "DEW_PT_TEMP": "DPT", "SEA_SURF_TEMP": "SST",
    "TOT_CLD_AMT": "N", "WAVE_HGT": "WH", "SWELL_HGT": "SH",
}  # fmt: skip


def _ncei(record: str) -> str:
    """Write a record as NCEI does: every cell in quotes, numbers as in the record, a blank for a missing one, a comma in the name."""
    cells = dict.fromkeys(NCEI.split(","), " ") | {
        "STATION": record[34:43].strip(),
        "NAME": "OCEAN STATION, NORTH",
        "SEA_LVL_PRES": record[58:63].strip(),
    }
    for heading, name in _OF_IMMA.items():
        first, last = COLUMNS[name]
        cells[heading] = record[first - 1 : last].strip() or " "
    hour = int(record[8:12])
    cells["DATE"] = f"{record[:4]}-{int(record[4:6]):02}-{int(record[6:8]):02}T{hour // 100:02}:{round(0.6 * (hour % 100)):02}:00"
    lon = int(record[17:23]) / 100
    cells |= {"LATITUDE": f"{int(record[12:17]) / 100}", "LONGITUDE": f"{lon - 360 if lon > 180 else lon:.2f}"}
    return ",".join(f'"{cells[name]}"' for name in NCEI.split(","))


def test_nceis_csv_by_its_published_header(tmp_path: Path) -> None:
    records = RECORDS.read_text().splitlines()
    path = tmp_path / "10_100_00_110.csv"
    header = ",".join(f'"{name}"' for name in NCEI.split(","))
    bad = [_ncei(records[2])[:-40], _ncei(records[2]).replace("1996-02", "1996-13")]
    path.write_bytes("\n".join([header, *map(_ncei, records), *bad]).encode() + b"\n")
    found, expected = _read(path), _read(RECORDS)
    assert found.left_out == {"with another number of cells": 1, "with a time that there is not": 1}
    assert found.set_missing == expected.set_missing
    for name, values in expected.columns.items():
        np.testing.assert_allclose(found.columns[name], values, rtol=1e-9, atol=1e-9, err_msg=name)


def test_nceis_earlier_orders_are_in_fahrenheit(tmp_path: Path) -> None:
    """Three rows of NCEI's own sample."""
    path = tmp_path / "Marine_CSV_sample.csv"
    path.write_text(
        "Identification,Latitude,Longitude,Time of Observation,Ice Accretion On Ship,Thickness of Ice Accretion On Ship,"
        "Rate of Ice Accretion on Ship,Sea Level Pressure,Characteristics of Pressure Tendency,Pressure Tendency,Air Temperature,"
        "Wet Bulb Temperature,Dew Point Temperature,Sea Surface Temperature,Wave Direction,Wave Period,Wave Height,Swell Direction,"
        "Swell Period,Swell Height,Total Cloud Amount,Low Cloud Amount,Low Cloud Type,Cloud Height Indicator,Cloud Height,"
        "Middle Cloud Type,High Cloud Type,Visibility,Visibility Indicator,Present Weather,Past Weather,Wind Direction,Wind Speed\n"
        "D5GN6,-35.8,2.9,2015-01-12T00:00:00, , , ,29.83,8,0.0,70.5, ,65.5, , , , , , , ,7, , , ,5, , ,97, ,3,2,300,139\n"
        "D5GN6,-35.9,8.6,2015-01-12T18:00:00, , , ,30.02,1,0.0,61.2, ,48.9, , ,7,7,24,12,8,8, , , ,2,0,0,97, ,2,2,170,154\n"
        "D5GN6,-0.2,88.1,2015-01-30T00:00:00, , , ,29.87,3,0.0,79.3, ,67.8, , ,99,1, , , ,3,2, , ,5,0,8,98, ,3,0,362,10\n"
    )
    source = _read(path)
    np.testing.assert_allclose(source.columns["wind_speed_m_s"], [13.9, 15.4, 1.0])  # 27, 30 and 2 kn
    np.testing.assert_array_equal(source.columns["wind_from_deg"], [300.0, 170.0, np.nan])
    np.testing.assert_allclose(source.columns["air_temperature_k"] - 273.15, [21.39, 16.22, 26.28], atol=0.005)
    np.testing.assert_array_equal(source.columns["cloud_cover"], [7 / 8, 1.0, 3 / 8])
    np.testing.assert_allclose(source.columns["significant_height_m"], [np.nan, np.hypot(3.5, 4.0), 0.5])
    np.testing.assert_array_equal(source.columns["visibility_km"], [10.0, 10.0, 20.0])
    np.testing.assert_array_equal(source.columns["hour_utc"], [0.0, 18.0, 0.0])
    np.testing.assert_array_equal(source.columns["latitude_deg"], [-35.8, -35.9, -0.2])
    np.testing.assert_allclose(source.columns["longitude_deg"], [2.9, 8.6, 88.1])
    air, dew = (np.array(degrees) / 1.8 - 32.0 / 1.8 for degrees in ((70.5, 61.2, 79.3), (65.5, 48.9, 67.8)))
    pressure, own = (np.exp(17.625 * celsius / (243.04 + celsius)) for celsius in (air, dew))
    np.testing.assert_allclose(source.columns["relative_humidity"], own / pressure, rtol=1e-9)
    assert np.isnan(source.columns["sea_temperature_k"]).all()
    # The sea's temperature is taken to have the unit of the others; this number is made for the test.
    path.write_text(path.read_text().replace("67.8, ,", "67.8,68.0,"))
    np.testing.assert_allclose(_read(path).columns["sea_temperature_k"], [np.nan, np.nan, 293.15])


ABBREVIATED = "YR,MO,DY,HR,LAT,LON,D,W,AT,DPT,SST,N\n"


def test_dirt_in_icoads_csv_is_counted(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    good = "2005,7,14,6.5,45.12,330.75,270,10.3,15.2,10.1,16.4,6\n"
    rows = [
        good, good, good.replace("270", "-50"), good.replace("10.3", "ten"), good.replace(",7,14", ",13,14"), good.replace("7,14", "2,30"),
        good.replace("45.12", "95"), good.replace("45.12", "north"), good.replace("6.5", "25"), good.replace(",6\n", ",12\n"),
        '"' + good, good.replace("16.4", "1e999"), good.replace("10.1", "-243.04"), good.replace("45.12", "\x0b45.12"),
        good.replace("6.5", "24"),
    ]  # fmt: skip
    path.write_bytes((ABBREVIATED + "".join(rows)).encode("latin-1"))
    source = _read(path)
    assert source.left_out == {
        "with a month outside 1 to 12": 1,
        "with a day that its month does not have": 1,
        "with a place outside the globe": 1,
        "with something else than numbers in date and place": 1,
        "with an hour outside 0 to 24": 1,
        "with another number of cells": 1,
    }
    assert source.set_missing == {
        "W that is no number": 1,
        "SST that is no number": 1,
        "wind_from_deg outside 0 to 362": 1,
        "cloud_cover outside 0 to 1": 1,
    }
    assert source.rows == 9
    assert source.columns["hour_utc"].tolist() == [6.5] * 8 + [24.0]
    assert "1 records are exact copies of earlier ones; all are kept" in source.notes
    path.write_text(ABBREVIATED + good.replace("45.12", "4512"))
    with pytest.raises(DataError, match=r"1 of 1 lines are no ICOADS records: 1 with a place outside the globe; .*divide by IMMA's scale"):
        _read(path)


@pytest.mark.parametrize(
    ("cells", "columns", "said"),
    [
        ("ws,n,d\n3,0.5,90\n3,0.5,-50\n", ["wind_from_deg=d"], r"row 2 \(line 3\), column d: wind_from_deg = -50 is outside.*0 to 360"),
        ("ws,n,d\n3,0.5,400\n", ["wind_to_deg=d"], r"row 1 \(line 2\), column d: wind_to_deg = 400 is outside.*0 to 360"),
        ("ws,n,d\n3,0.5,999\n", ["longitude_deg=d"], r"row 1 \(line 2\), column d: longitude_deg = 999 is outside.*-180 to 360"),
        ("ws,n,d\n3,0.5,13\n", ["month=d"], r"row 1 \(line 2\), column d: month = 13 is outside.*1 to 12"),
        ("ws,n,d\n3,1.5,1\n", [], r"row 1 \(line 2\), column n: cloud_cover = 1.5 is outside.*0 to 1"),
        ("ws,n,d\n3,0.5,2019-13-01T00:00Z\n", ["time=d"], r"row 1 \(line 2\), column d: '2019-13-01T00:00Z' is no ISO time"),
        ("ws,n,d\n3,0.5,0001-01-01T00:00+05:00\n", ["time=d"], r"is no ISO time"),
    ],
)
def test_mapped_columns_are_refused_with_row_and_line(tmp_path: Path, cells: str, columns: list[str], said: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(cells)
    with pytest.raises(DataError, match=said):
        _read(path, "wind_speed_m_s=ws", "cloud_cover=n", *columns)


@pytest.mark.parametrize(("row", "said"), [("3,0.5,13", "month = 13 is outside"), ("3,1.5,1", "cloud_cover = 1.5 is outside")])
def test_a_table_with_impossible_values_is_refused(tmp_path: Path, row: str, said: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(f"wind_speed_m_s,cloud_cover,month\n{row}\n")
    with pytest.raises(DataError, match=rf"row 1 \(line 2\), column .*{said}"):
        _read(path)


LONG = "7" * 1_000_000

#: Files with a line of a megabyte, by the words of the message; empty where the file is read.
MEGABYTES = {
    "nothing known": (LONG + "\n", "is no weather that is read"),
    "headings": ("a," * 500_000 + "b\n1,2\n", "columns are a, a, a"),
    "one heading": ("ws," + LONG + "\n1,2\n", "is no row of cells"),
    "imma": ("\n".join([made.imma(), made.imma() + LONG, made.imma()]), ""),
    "imma alone": (f"{made.imma()}\n{LONG}\n{LONG}\n", "2 of 3 lines are no IMMA records"),
    "ndbc": (made.NDBC_2019 + LONG + "\n", ""),
    "ndbc alone": (made.NDBC_2019.splitlines()[0] + "\n" + LONG + "\n", "1 of 1 lines are no NDBC records"),
    "icoads csv": (ABBREVIATED + "2005,7,14,6.5,45.12,330.75,270,10.3,15.2,10.1,16.4," + LONG, "no ICOADS records"),
    "table": ("wind_speed_m_s,cloud_cover\n3," + LONG[:1000] + "x\n", "is not a number"),
    "wide table": ("wind_speed_m_s,cloud_cover" + ",x" * 400_000 + "\n3,1\n", "is there twice"),
}


@pytest.mark.parametrize("kind", MEGABYTES)
def test_a_line_of_a_megabyte_is_told_in_one_short_line(tmp_path: Path, kind: str) -> None:
    text, said = MEGABYTES[kind]
    path = tmp_path / "a"
    path.write_text(text)
    begun = time.perf_counter()
    try:
        told, refused = " ".join(_read(path).notes), False
    except DataError as error:
        told, refused = str(error), True
    assert time.perf_counter() - begun < 10.0
    assert refused == bool(said)
    assert said in told
    assert len(told) < 1200
    assert "\n" not in told


def _mutated(content: bytes, rng: random.Random) -> bytes:
    out = bytearray(content)
    for _ in range(rng.choice([1, 3, 30])):
        at = rng.randrange(len(out) + 1)
        match rng.randrange(4):
            case 0 if at < len(out):
                out[at] = rng.randrange(256)
            case 1:
                out[at:at] = rng.choice([b",", b'"', b"\t", b"\n", b"\x00", b"\xef\xbb\xbf", b"1e400", b"nan", b"\xc2\xb2", b"\x85"])
            case 2:
                del out[at : at + rng.choice([1, 10, 200])]
            case _:
                out[at:at] = out[rng.randrange(len(out) + 1) :][: rng.choice([5, 100])]
    return bytes(out)


def _kinds() -> dict[str, bytes]:
    records = RECORDS.read_text().splitlines()
    abbreviated = ABBREVIATED + "2005,7,14,6.5,45.12,330.75,270,10.3,15.2,10.1,16.4,6\n" * 6
    return {
        "imma": RECORDS.read_bytes(),
        "ncei": "\n".join([NCEI, *map(_ncei, records)]).encode(),
        "abbreviated": abbreviated.encode(),
        "ndbc": made.NDBC_2019.encode(),
        "old ndbc": made.NDBC_1996.encode(),
        "realtime": made.NDBC_REALTIME.encode(),
        "table": b"wind_speed_m_s,cloud_cover,month,weight\n3,0.5,7,1\n9,1,8,2\n",
        "packed": gzip.compress(RECORDS.read_bytes()),
    }


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("kind", _kinds())
def test_mutated_files_are_read_or_refused_in_a_line(tmp_path: Path, kind: str) -> None:
    rng, content = random.Random(kind), _kinds()[kind]
    path, shapes, told = tmp_path / "a", set(), []
    for _ in range(300):
        path.write_bytes(_mutated(content, rng))
        try:
            source = _read(path, anemometer_m=rng.choice([None, 4.0]))
            shapes |= {values.shape == (source.rows,) for values in source.columns.values()}
        except SeaglintError as error:
            told.append(str(error))
    assert False not in shapes
    assert shapes or kind == "packed"
    assert not [text for text in told if "\n" in text or len(text) > 1500]


def test_a_source_given_twice_is_used_once(tmp_path: Path) -> None:
    first, copy, other = tmp_path / "a.txt", tmp_path / "b.txt", tmp_path / "c.txt"
    for path in (first, copy):
        path.write_text("\n".join([made.imma(), made.imma(mo=" 8")]) + "\n")
    other.write_text(made.imma(w="200") + "\n")
    built = build([first, copy, other, first])
    assert len(built.table) == 3
    assert [note for note in built.notes if "is used once" in note] == [
        "b.txt: is the same as a.txt given before, and is used once",
        "a.txt: is the same as a.txt given before, and is used once",
    ]
    assert built.notes[0].endswith("of a.txt, c.txt")


def test_rows_in_one_month_are_told_in_one_clause(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text(made.imma() + "\n")
    assert "rows in July only: they serve all the year" in build([path]).notes
    path.write_text(made.imma() + "\n" + made.imma(mo=" 1") + "\n")
    (told,) = (note for note in build([path]).notes if note.startswith("no rows in"))
    assert (
        told
        == "no rows in February, March, April, November, December (January serves), May, June, August, September, October (July serves)"
    )
