"""Columns of soundings by the names and units that programs give them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.files.soundings.raw_sounding import Humidity, Quantity, RawSounding, with_other_humidity, without_missing

#: Names of quantities without their unit, the preferred first; a bare name is one that says enough without a unit.
PRESSURE: Final = ("pressure", "pres", "press", "p", "pc", "pm", "air_pressure", "prs")
HEIGHT: Final = ("height", "altitude", "alt", "z", "geometric_height", "height_msl", "altitude_msl", "zmsl")
GEOPOTENTIAL: Final = (
    *("geopotential_height", "geopotheight", "geopoalt", "geopot", "gph", "hght", "hgt", "geopoten", "geopotential_altitude", "gpm"),
    *("geopot_height", "heightmsl", "hgt_msl"),  # Vaisala's heights above the sea follow from its pressures
)
SATELLITE: Final = ("gpsalt", "gps_alt", "gps_altitude", "gpsheightmsl")
TEMPERATURE: Final = ("temperature", "temp", "tmp", "tdry", "air_temperature", "tair", "ta", "t", "dry_bulb_temperature")
DEW_POINT: Final = (
    *("dewpoint", "dew_point", "dew_point_temperature", "dewpoint_temperature", "td", "dwpt", "dewp", "dewpt", "dewpnt", "dp", "dew"),
    *("dwp", "dew_pt", "tdew"),
)
DEPRESSION: Final = ("dew_point_depression", "dewpoint_depression", "dpdp", "dpd", "depression", "t_td")
HUMIDITY: Final = ("relative_humidity", "rh", "relh", "humidity", "rel_humidity", "rel_hum", "hum", "hur", "hu")
MIXING: Final = ("mixing_ratio", "mixr", "mix_ratio", "water_vapor_mixing_ratio", "water_vapour_mixing_ratio")
SPECIFIC: Final = ("specific_humidity", "spfh", "hus", "sphu")

#: Names of GEMPAK and its like, with the unit that they stand for.
FIXED: Final = {"tmpc": ("temperature", "c"), "tmpk": ("temperature", "k"), "tmpf": ("temperature", "f"), "dwpc": ("dewpoint", "c"),
                "dwpk": ("dewpoint", "k"), "dwpf": ("dewpoint", "f"), "press_mb": ("pressure", "hpa")}  # fmt: skip

#: Names that are short for other things too: they count with a unit alone; ``p`` counts as hPa.
BARE: Final = frozenset({"t", "z", "p", "td", "ta", "dp", "dew"})

#: Units by their spelling, in lower case without signs of degrees.
UNITS: Final = {
    **dict.fromkeys(("hpa", "mb", "mbar", "mbars", "hectopascal", "hectopascals", "millibar", "millibars"), "hpa"),
    **dict.fromkeys(("pa", "pascal", "pascals"), "pa"),
    **dict.fromkeys(("kpa", "kilopascal"), "kpa"),
    **dict.fromkeys(("k", "kelvin", "degk", "deg_k", "kelvins"), "k"),
    **dict.fromkeys(("c", "degc", "deg_c", "celsius", "degrees_celsius", "degree_celsius", "degrees_c", "degreec", "cel"), "c"),
    **dict.fromkeys(("f", "degf", "deg_f", "fahrenheit", "degrees_fahrenheit", "degrees_f", "degreef"), "f"),
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres", "gpm", "m_asl", "m_msl", "meters_asl", "mamsl", "masl"), "m"),
    **dict.fromkeys(("ft", "feet", "foot"), "ft"),
    **dict.fromkeys(("km", "kilometer", "kilometre", "kilometers", "kilometres"), "km"),
    **dict.fromkeys(("%", "percent", "pct", "rh_percent", "%rh", "per_cent"), "%"),
    **dict.fromkeys(("1", "fraction", "share"), "1"),
    **dict.fromkeys(("g_kg", "g/kg", "gkg", "g_kg-1", "g_kg^-1", "g_per_kg"), "g/kg"),
    **dict.fromkeys(("kg_kg", "kg/kg", "kg_kg-1", "kg_kg**-1", "kg_kg^-1"), "kg/kg"),
}

#: Units of a quantity.
ALLOWED: Final[dict[str, tuple[str, ...]]] = {
    "pressure": ("hpa", "pa", "kpa"), "height": ("m", "ft", "km"), "temperature": ("c", "k", "f"), "dewpoint": ("c", "k", "f"),
    "depression": ("c", "k", "f"), "humidity": ("%", "1"), "mixing": ("g/kg", "kg/kg"), "specific": ("kg/kg", "g/kg"),
}  # fmt: skip

#: Names by kind of quantity, and the quantity of a level that it is.
QUANTITIES: Final[dict[str, tuple[str, tuple[str, ...]]]] = {
    "pressure": ("pressure", PRESSURE), "height": ("height", (*HEIGHT, *GEOPOTENTIAL, *SATELLITE)),
    "temperature": ("temperature", TEMPERATURE),
    "dewpoint": ("humidity", DEW_POINT), "depression": ("humidity", DEPRESSION), "humidity": ("humidity", HUMIDITY),
    "mixing": ("humidity", MIXING), "specific": ("humidity", SPECIFIC),
}  # fmt: skip

#: Quantity of a level by the kind of its humidity, the preferred first.
HUMIDITIES: Final[dict[str, Humidity]] = {
    "dewpoint": "dewpoint_k", "depression": "dewpoint_k", "humidity": "relative_humidity_percent", "mixing": "mixing_ratio_g_kg",
    "specific": "specific_humidity",
}  # fmt: skip

#: Units of names without one; temperatures and dew points without one are Celsius below :data:`KELVIN_FROM`.
DEFAULTS: Final = {"pressure": "hpa", "height": "m", "humidity": "%", "mixing": "g/kg", "specific": "kg/kg", "depression": "k"}

KELVIN_FROM: Final = 130.0  #: Median of a temperature without a unit from which it is in kelvin.

ZERO_C: Final = 273.15


def plain_name(text: str) -> str:
    """Return a column name in lower case with single underscores.

    >>> plain_name("geopotential height_m"), plain_name("Temp [°C]"), plain_name("Hgt/MSL")
    ('geopotential_height_m', 'temp_c', 'hgt_msl')
    """
    name = re.sub(r"[°º\ufffd'\"]|\.(?=\s|$)", "", text.strip().lower())
    name = name.replace("g/kg", "g_kg").replace("/", "_")
    return re.sub(r"[\s()\[\],:;_]+", "_", name).strip("_")


def plain_unit(text: str) -> str | None:
    """Return the unit of a text, None where it is none of a sounding's.

    >>> plain_unit("°C"), plain_unit("[mb]"), plain_unit("gpm"), plain_unit("m/s")
    ('c', 'hpa', 'm', None)
    """
    return UNITS.get(re.sub(r"\s+", "_", text.strip().strip("[]()").strip("°º\ufffd ").lower()))


@dataclass(frozen=True)
class SoundingColumn:
    """A column that holds a quantity of a sounding."""

    place: int  #: Column of the file, from 0.
    kind: str  #: Kind of :data:`QUANTITIES`.
    unit: str | None  #: Its unit; None for a temperature or dew point that says none.
    name: str  #: Name in the file.
    geopotential: bool  #: True for geopotential heights.
    rank: int  #: Place of the name among those of its kind, the preferred first.

    @property
    def quantity(self) -> Quantity:
        """Quantity of a level."""
        return QUANTITIES[self.kind][0]  # type: ignore[return-value]

    def in_si(self, values: FloatArray) -> FloatArray:
        """Values in hPa, m, K, %, g/kg, kg/kg, or K of a depression."""
        unit = self.unit
        if unit is None:
            known = values[np.isfinite(values)]
            unit = "k" if known.size and float(np.median(known)) >= KELVIN_FROM else "c"
        if self.kind == "depression":
            return values / 1.8 if unit == "f" else values
        match unit:
            case "c":
                return values + ZERO_C
            case "f":
                return (values - 32.0) / 1.8 + ZERO_C
            case "pa":
                return 0.01 * values
            case "kpa":
                return 10.0 * values
            case "ft":
                return 0.3048 * values
            case "km":
                return 1e3 * values
            case "g/kg" if self.kind == "specific":
                return 1e-3 * values
            case "1" if self.kind == "humidity":
                return 100.0 * values
            case "kg/kg" if self.kind == "mixing":
                return 1e3 * values
            case _:
                return values

    @property
    def factor(self) -> float:
        """Size of a step of the file's numbers in hPa or m."""
        return {"pa": 0.01, "kpa": 10.0, "ft": 0.3048, "km": 1e3}.get(self.unit or "", 1.0)


def sounding_column(place: int, name: str, unit: str | None = None) -> SoundingColumn | None:
    """Return the meaning of a column by its name and the unit that stands apart from it; None for other columns."""
    plain = plain_name(name)
    if plain in FIXED:
        kind, own = FIXED[plain]
        return SoundingColumn(place, kind, own, name, False, 0)
    for base, own_unit in _readings(plain):
        for kind, (_, names) in QUANTITIES.items():
            if base in names:
                chosen = own_unit or unit
                if chosen is not None and chosen not in ALLOWED[kind]:
                    continue
                if chosen is None and base in BARE and base != "p":
                    continue
                chosen = chosen or DEFAULTS.get(kind)
                return SoundingColumn(place, kind, chosen, name, base in GEOPOTENTIAL, names.index(base))
    return None


def _readings(plain: str) -> list[tuple[str, str | None]]:
    """Name and unit of a plain name, whole and with its last words as the unit."""
    out: list[tuple[str, str | None]] = [(plain, None)]
    words = plain.split("_")
    for n in (1, 2):
        if len(words) > n:
            own = UNITS.get("_".join(words[-n:]))
            if own is not None:
                out.append(("_".join(words[:-n]), own))
    return out


def columns_of(names: list[str], units: list[str] | None = None) -> list[SoundingColumn]:
    """Return the columns that hold quantities of a sounding."""
    given = [plain_unit(unit) for unit in units] if units and len(units) == len(names) else [None] * len(names)
    found = [sounding_column(i, name, unit) for i, (name, unit) in enumerate(zip(names, given, strict=True))]
    return [column for column in found if column is not None]


def sounding_of(
    form: str,
    columns: Iterable[SoundingColumn],
    numbers: Mapping[int, FloatArray],
    steps: Mapping[int, float],
    notes: tuple[str, ...] = (),
    *,
    geopotential: bool = False,
) -> RawSounding:
    """Return a sounding of the columns of a file: of several for one quantity that with most values, the preferred name first.

    Levels without the chosen humidity take another one that the file has.

    Parameters
    ----------
    form : str
        Name of the format.
    columns : iterable of SoundingColumn
        Columns that hold a quantity; pressure, temperature and humidity are among them.
    numbers : mapping
        Values as written, by column of the file.
    steps : mapping
        Steps that the values are rounded to, by column of the file.
    notes : tuple of str
        What the reader chose.
    geopotential : bool
        True where heights are geopotential whatever their name.
    """
    chosen: dict[Quantity, SoundingColumn] = {}
    values: dict[Quantity, FloatArray] = {}
    humidities: list[tuple[SoundingColumn, FloatArray]] = []
    order = list(HUMIDITIES)
    for column in sorted(columns, key=lambda c: (order.index(c.kind) if c.kind in order else 0, c.rank)):
        what = column.quantity
        here = column.in_si(without_missing(numbers[column.place], what))
        if what == "humidity":
            humidities.append((column, here))
        if what not in chosen or np.isfinite(here).sum() > np.isfinite(values[what]).sum():
            chosen[what], values[what] = column, here
    wet = chosen["humidity"]
    height = values.get("height", np.full(values["pressure"].size, np.nan))
    step_p = steps[chosen["pressure"].place] * chosen["pressure"].factor
    step_z = steps[chosen["height"].place] * chosen["height"].factor if "height" in chosen else 1.0

    def humidity_of(column: SoundingColumn, here: FloatArray) -> FloatArray:
        return values["temperature"] - here if column.kind == "depression" else here

    raw = RawSounding(
        form,
        values["pressure"],
        height,
        values["temperature"],
        HUMIDITIES[wet.kind],
        humidity_of(wet, values["humidity"]),
        geopotential or ("height" in chosen and chosen["height"].geopotential),
        {"height": "height"} | {str(what): column.name for what, column in chosen.items()},
        notes,
        resolution=(step_p, step_z),
    )
    for column, here in humidities:
        if column is not wet:
            raw = with_other_humidity(raw, HUMIDITIES[column.kind], humidity_of(column, here))
    return raw
