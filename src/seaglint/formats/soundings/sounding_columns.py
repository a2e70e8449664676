"""Columns of soundings by the names and units that programs give them, and the levels of a file, missing values as NaN.

Ozone is read in several units; values that are impossible in their unit are refused with the unit in which they are plausible.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from seaglint.air.profile.air_profile import saturation_density
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError

#: Codes of a missing value of any quantity.
MISSING: Final = (9999.0, 99999.0, -999.0, -999.9, -999.99, -9999.0, -9999.9, -8888.0, -99999.0, 9999.9, -32768.0, 32767.0)

#: Further codes of a missing pressure, temperature or humidity; a height of -99 m may be real.
BELOW_ZERO: Final = (-99.0, -99.9, -99.99, -888.0)

#: Further codes of a missing temperature or humidity; 999.9 hPa and 999 m may be real.
BEYOND_AIR: Final = (999.0, 999.9, 999.99)

Quantity = Literal["pressure", "height", "temperature", "humidity"]

LARGEST: Final = 1e9  #: Numbers beyond are fill values such as 1e20.

#: Texts of a missing value, in lower case; texts of ``-``, ``/``, ``*`` or ``.`` alone are missing values too.
MISSING_TEXTS: Final = frozenset({"", "nan", "na", "n/a", "null", "none", "m", "missing", "nil"})

Humidity = Literal["dewpoint_k", "relative_humidity_percent", "mixing_ratio_g_kg", "specific_humidity"]

VAPOUR_CONSTANT: Final = 461.5  #: Specific gas constant of water vapour [J kg-1 K-1].

#: Names of quantities without their unit, the preferred first; a bare name needs no unit.
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

#: Units of names without one; temperatures and dew points without one are Celsius below ``KELVIN_FROM``.
DEFAULTS: Final = {"pressure": "hpa", "height": "m", "humidity": "%", "mixing": "g/kg", "specific": "kg/kg", "depression": "k"}

KELVIN_FROM: Final = 130.0  #: Median of a temperature without a unit from which it is in kelvin.

ZERO_C: Final = 273.15

#: Factors of pressures to hPa and of heights to m by their unit.
FACTORS: Final = {"pa": 0.01, "kpa": 10.0, "ft": 0.3048, "km": 1e3}

#: Factors of humidities to their usual unit by kind and unit.
HUMIDITY_FACTORS: Final = {("specific", "g/kg"): 1e-3, ("humidity", "1"): 100.0, ("mixing", "kg/kg"): 1e3}

#: Units by their plain spelling; ``ppm`` is not among them: files have it by mass and by volume.
OZONE_UNITS: Final = {
    "ppmv": "ppmv", "mmr": "kg/kg", "mpa": "mPa", "ppbv": "ppbv",
    **dict.fromkeys(("kg_kg", "kg_kg-1", "kg_kg**-1", "kg_kg^-1"), "kg/kg"),
    **dict.fromkeys(("mol_mol", "mol_mol-1", "mol_mol**-1", "mol_mol^-1"), "mol/mol"),
}  # fmt: skip

RANKS: Final = ("ppmv", "kg/kg", "mPa", "ppbv", "mol/mol")  #: Units, the preferred first, where several columns have as many values.

OZONE_ALLOWED: Final = (
    "ozone_ppmv or ozone_ppbv (parts per million or billion of the volume of air), ozone_mmr (mass mixing ratio, kg/kg) or ozone_mpa (mPa)"
)

MOLAR: Final = 28.9644 / 47.9982  #: Molar mass of air over that of ozone [1].

FURTHER_MISSING: Final = (99.9, 99.99, 9000.0)  #: Further numbers for a missing value in ozonesondes' files.

MOST_PPMV: Final = 20.0  #: Largest ozone of real air [1e-6 of the volume]; the most of the stratosphere is some 12.

MOST_LOW_PPMV: Final = 1.0  #: Largest ozone of real air below the level of ``LOW_HPA`` [1e-6 of the volume]; foul air has up to 0.4.

#: Smallest median of ozone in real air [1e-6 of the volume]; tropical air over oceans has some 0.01.
LEAST_PPMV: Final = 1e-3

LOW_HPA: Final = 500.0

ROUNDED_PPMV: Final = -1e-3  #: Least value that the packing of gridded analyses explains [1e-6 of the volume].

#: Names of the amount of ozone, without its unit; an ozone column of another name is one of errors, currents or flags.
AMOUNTS: Final = frozenset({
    *("ozone", "o3", "go3", "ozone_mixing_ratio", "o3_mixing_ratio", "ozone_partial_pressure", "o3_partial_pressure", "ozone_mass"),
    *("ozone_mass_mixing_ratio", "ozone_volume_mixing_ratio", "mass_fraction_of_ozone_in_air", "mole_fraction_of_ozone_in_air"),
})  # fmt: skip


@dataclass(frozen=True, eq=False)
class RawSounding:
    """Rows of a file."""

    kind: str  #: Name of the format.
    pressure: FloatArray  #: Pressure [hPa, (levels,)]; NaN where missing.
    height: FloatArray  #: Height [m, (levels,)]; NaN where missing.
    temperature: FloatArray  #: Temperature [K, (levels,)]; NaN where missing.
    #: Quantity of ``humidity_value``: dew point [K], relative humidity [%], mixing ratio [g kg-1], or specific humidity [kg kg-1].
    humidity: Humidity
    humidity_value: FloatArray  #: Its values, NaN where missing.
    geopotential: bool  #: True for geopotential heights.
    names: dict[str, str]  #: Columns of the file by quantity: pressure, height, temperature, humidity, and ozone if present.
    notes: tuple[str, ...] = ()  #: Choices of the reader.
    resolution: tuple[float, float] = (0.1, 1.0)  #: Steps that pressures [hPa] and heights [m] are rounded to.
    ozone: FloatArray | None = None  #: Ozone, NaN where missing; None for files without it.
    ozone_unit: str = "ppmv"  #: Its unit, ``ppmv`` for parts per million of the volume of air.

    def at(self, where: NDArray[np.bool_] | NDArray[np.intp]) -> RawSounding:
        """Return some of the levels."""
        return replace(
            self,
            pressure=self.pressure[where],
            height=self.height[where],
            temperature=self.temperature[where],
            humidity_value=self.humidity_value[where],
            ozone=None if self.ozone is None else self.ozone[where],
        )

    def relative_humidity(self) -> FloatArray:
        """Return the relative humidity over water [%], 0 to 100; NaN where missing."""
        match self.humidity:
            case "relative_humidity_percent":
                out = self.humidity_value
            case "dewpoint_k":
                dew = np.minimum(self.humidity_value, self.temperature)
                # Vapour pressure is density times temperature: the gas constant cancels in the ratio.
                out = 100.0 * saturation_density(dew) * dew / (saturation_density(self.temperature) * self.temperature)
            case _:
                ratio = 1e-3 * self.humidity_value
                if self.humidity == "specific_humidity":
                    ratio = self.humidity_value / (1.0 - self.humidity_value)
                partial = 100.0 * self.pressure * ratio / (0.62198 + ratio)
                out = 100.0 * partial / (1e-3 * saturation_density(self.temperature) * VAPOUR_CONSTANT * self.temperature)
        return np.asarray(np.clip(out, 0.0, 100.0))


def with_other_humidity(raw: RawSounding, other: Humidity, values: FloatArray) -> RawSounding:
    """Fill levels without humidity from another quantity of the file, as relative humidity.

    Parameters
    ----------
    raw : RawSounding
        The sounding.
    other : str
        The other quantity.
    values : ndarray
        Its values, NaN where missing.
    """
    # Both quantities become relative humidity, in which they can be mixed.
    gaps = ~np.isfinite(raw.humidity_value)
    further = replace(raw, humidity=other, humidity_value=values).relative_humidity()
    count = int(np.sum(gaps & np.isfinite(further)))
    if not count:
        return raw
    both = np.where(gaps, further, raw.relative_humidity())
    note = f"{count} levels without {raw.names['humidity']} have the humidity of another column"
    return replace(raw, humidity="relative_humidity_percent", humidity_value=both, notes=(*raw.notes, note))


def without_missing(values: FloatArray, what: Quantity) -> FloatArray:
    """Return values of a quantity with NaN for codes of missing values."""
    out = np.array(values, dtype=np.float64)
    none = MISSING if what == "height" else (*MISSING, *BELOW_ZERO) if what == "pressure" else (*MISSING, *BELOW_ZERO, *BEYOND_AIR)
    out[np.isin(out, none) | (np.abs(out) > LARGEST)] = np.nan
    return out


def others_left(count: int) -> str:
    """Return the end of a note on a choice.

    >>> others_left(1), others_left(3)
    ('1 other is left', '3 others are left')
    """
    return f"{count} other is left" if count == 1 else f"{count} others are left"


def is_missing_text(text: str) -> bool:
    """Return true for the text of a missing value.

    >>> is_missing_text("/////"), is_missing_text("-99")
    (True, False)
    """
    return text.lower() in MISSING_TEXTS or set(text) <= {text[0]} <= set("-/*.")


def plain_name(text: str) -> str:
    """Return a column name in lower case with single underscores.

    >>> plain_name("geopotential height_m"), plain_name("Temp [°C]"), plain_name("Hgt/MSL")
    ('geopotential_height_m', 'temp_c', 'hgt_msl')
    """
    # Signs of degrees, also damaged ones, and points of abbreviations carry no meaning.
    name = re.sub(r"[°º\ufffd'\"]|\.(?=\s|$)", "", text.strip().lower())
    name = name.replace("g/kg", "g_kg").replace("/", "_")
    return re.sub(r"[\s()\[\],:;_]+", "_", name).strip("_")


def plain_unit(text: str) -> str | None:
    """Return the unit of a text; None for a unit that soundings do not have.

    >>> plain_unit("°C"), plain_unit("[mb]"), plain_unit("gpm"), plain_unit("m/s")
    ('c', 'hpa', 'm', None)
    """
    return UNITS.get(re.sub(r"\s+", "_", text.strip().strip("[]()").strip("°º\ufffd ").lower()))


@dataclass(frozen=True)
class SoundingColumn:
    """A column that holds a quantity of a sounding."""

    place: int  #: Column of the file, from 0.
    kind: str  #: Kind of ``QUANTITIES``.
    unit: str | None  #: Its unit; None for a temperature or dew point without one.
    name: str  #: Name in the file.
    geopotential: bool  #: True for geopotential heights.
    rank: int  #: Place of the name among those of its kind, the preferred first.

    @property
    def quantity(self) -> Quantity:
        """Quantity of a level."""
        return QUANTITIES[self.kind][0]  # type: ignore[return-value]

    def in_si(self, values: FloatArray) -> FloatArray:
        """Return values in hPa, m, K, %, g/kg, kg/kg, or K of a depression."""
        unit = self.unit
        if unit is None:
            known = values[np.isfinite(values)]
            unit = "k" if known.size and float(np.median(known)) >= KELVIN_FROM else "c"
        if self.kind == "depression":  # a difference of temperatures has no zero point
            return values / 1.8 if unit == "f" else values
        if unit in ("c", "f"):
            return values + ZERO_C if unit == "c" else (values - 32.0) / 1.8 + ZERO_C
        factor = FACTORS.get(unit) or HUMIDITY_FACTORS.get((self.kind, unit))
        return values if factor is None else factor * values

    @property
    def factor(self) -> float:
        """Size of a step of the file's numbers in hPa or m."""
        return FACTORS.get(self.unit or "", 1.0)


def sounding_column(place: int, name: str, unit: str | None = None) -> SoundingColumn | None:
    """Return the meaning of a column by its name and the separate unit; None for other columns."""
    plain = plain_name(name)
    if plain in FIXED:
        kind, own = FIXED[plain]
        return SoundingColumn(place, kind, own, name, False, 0)
    for base, own_unit in [(plain, None), *_splits(plain, UNITS)]:
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


def _splits(plain: str, units: Mapping[str, str]) -> list[tuple[str, str]]:
    """Return splits of a plain name into name and unit, where its last one or two words are a unit."""
    words = plain.split("_")
    splits = [("_".join(words[:-n]), units.get("_".join(words[-n:]))) for n in (1, 2) if len(words) > n]
    return [(name, unit) for name, unit in splits if unit is not None]


def columns_of(names: list[str], units: list[str] | None = None) -> list[SoundingColumn]:
    """Return the columns that hold quantities of a sounding."""
    given = [plain_unit(unit) for unit in units] if units and len(units) == len(names) else [None] * len(names)
    columns = (sounding_column(i, name, unit) for i, (name, unit) in enumerate(zip(names, given, strict=True)))
    return [column for column in columns if column is not None]


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
        Choices of the reader.
    geopotential : bool
        True where heights are geopotential whatever their name.
    """
    chosen: dict[Quantity, SoundingColumn] = {}
    values: dict[Quantity, FloatArray] = {}
    humidities: list[tuple[SoundingColumn, FloatArray]] = []
    # Humidities in their order of preference; other quantities by the rank of the name alone.
    order = list(HUMIDITIES)
    for column in sorted(columns, key=lambda c: (order.index(c.kind) if c.kind in order else 0, c.rank)):
        what = column.quantity
        given = column.in_si(without_missing(numbers[column.place], what))
        if what == "humidity":
            humidities.append((column, given))
        if what not in chosen or np.isfinite(given).sum() > np.isfinite(values[what]).sum():
            chosen[what], values[what] = column, given
    wet = chosen["humidity"]
    height = values.get("height", np.full(values["pressure"].size, np.nan))
    step_p = steps[chosen["pressure"].place] * chosen["pressure"].factor
    step_z = steps[chosen["height"].place] * chosen["height"].factor if "height" in chosen else 1.0

    def humidity_of(column: SoundingColumn, given: FloatArray) -> FloatArray:
        return values["temperature"] - given if column.kind == "depression" else given

    raw = RawSounding(
        kind=form, pressure=values["pressure"], height=height, temperature=values["temperature"],
        humidity=HUMIDITIES[wet.kind], humidity_value=humidity_of(wet, values["humidity"]),
        geopotential=geopotential or ("height" in chosen and chosen["height"].geopotential),
        names={"height": "height"} | {str(what): column.name for what, column in chosen.items()}, notes=notes, resolution=(step_p, step_z),
    )  # fmt: skip
    for column, given in humidities:
        if column is not wet:
            raw = with_other_humidity(raw, HUMIDITIES[column.kind], humidity_of(column, given))
    return raw


@dataclass(frozen=True)
class OzoneColumn:
    """A column that holds ozone."""

    place: int  #: Column of the file, from 0.
    name: str  #: Name in the file.
    unit: str  #: One of ``RANKS``.

    def in_ppmv(self, values: FloatArray, pressure: FloatArray) -> FloatArray:
        """Return values as parts per million of the volume of air, at pressures [hPa].

        >>> OzoneColumn(0, "ozone_mpa", "mPa").in_ppmv(np.array([10.0]), np.array([50.0]))
        array([2.])
        """
        if self.unit == "mPa":  # partial over total pressure, 1 mPa being 1e-5 hPa
            return 10.0 * values / np.where(pressure > 0.0, pressure, np.nan)
        factor = {"kg/kg": 1e6 * MOLAR, "ppbv": 1e-3, "mol/mol": 1e6}.get(self.unit)
        return values if factor is None else factor * values


def ozone_columns(
    path: Path, names: Sequence[str], units: Sequence[str] | None, *, where: str = "", what: str = "column"
) -> list[OzoneColumn]:
    """Return the columns that hold ozone in a known unit, the preferred first.

    Parameters
    ----------
    path : Path
        The file.
    names, units : sequence of str
        Names of the columns, and units that are separate from them.
    where : str
        Place of the names in the file, with a colon and a blank, for errors.
    what : str
        ``column`` or ``variable``.

    Raises
    ------
    DataError
        Ozone in no known unit, in two units at once, or twice under one name.
    """
    known, unknown = [], []
    plain = [plain_name(name) for name in names]
    separate = units if units is not None and len(units) == len(names) else [""] * len(names)
    for place, name in enumerate(plain):
        if not name.startswith(("ozone", "o3", "go3")) and {"ozone", "o3"}.isdisjoint(name.split("_")):
            continue
        base, own = next(iter(_splits(name, OZONE_UNITS)), (name, None))
        other = OZONE_UNITS.get(plain_name(re.sub(r"\s+", "_", separate[place].strip())))
        if base not in AMOUNTS or (own or other) is None:
            unknown.append(place)
            continue
        if own is not None and other is not None and own != other:
            both = f"is in {own} by its name and in {separate[place]} by its unit"
            raise DataError(f"{path}: {where}the {what} {names[place]} {both}; give {OZONE_ALLOWED}")
        known.append(OzoneColumn(place, names[place], str(own or other)))
    if unknown and not known:
        place = unknown[0]
        given = f"in '{separate[place].strip()}'" if separate[place].strip() else "in no unit that is known"
        raise DataError(
            f"{path}: {where}the {what} {names[place]} holds ozone {given}; ozone is read as {OZONE_ALLOWED}: "
            f"name the {what} so with its values in that unit, or leave it out"
        )
    for column in known:
        if plain.count(plain[column.place]) > 1:
            raise DataError(f"{path}: {where}the {what} {plain[column.place]} stands twice; leave one out")
    return sorted(known, key=lambda column: RANKS.index(column.unit))


def with_ozone(raw: RawSounding, columns: Sequence[OzoneColumn], numbers: Mapping[int, FloatArray], *, packed: bool = False) -> RawSounding:
    """Return a sounding with the ozone of its file: of several columns the one with most values, the preferred unit first.

    Parameters
    ----------
    raw : RawSounding
        The sounding, at the levels of the columns.
    columns : sequence of OzoneColumn
        Columns of ozone; without any the sounding is returned unchanged.
    numbers : mapping
        Values as written, by column of the file.
    packed : bool
        True for analyses, whose packing may make values slightly negative; these are set to 0.
    """
    best: OzoneColumn | None = None
    values = np.full(raw.pressure.size, np.nan)
    for column in columns:
        given = without_missing(numbers[column.place], "humidity")
        if column.unit != "ppbv":
            given[np.isin(given, FURTHER_MISSING)] = np.nan
        if packed:
            ppmv = column.in_ppmv(given, raw.pressure)
            given[(ppmv < 0.0) & (ppmv > ROUNDED_PPMV)] = 0.0
        if best is None or np.isfinite(given).sum() > np.isfinite(values).sum():
            best, values = column, given
    if best is None:
        return raw
    return replace(raw, names=raw.names | {"ozone": best.name}, ozone=values, ozone_unit=best.unit)


def with_ozone_in_ppmv(path: Path, raw: RawSounding) -> RawSounding:
    """Return a sounding, whose pressures were checked, with its ozone in parts per million of the volume.

    Raises
    ------
    DataError
        Values that are impossible in air, with a suspicion of the unit.
    """
    if raw.ozone is None:
        return raw
    column = OzoneColumn(0, raw.names["ozone"], raw.ozone_unit)
    ppmv = column.in_ppmv(raw.ozone, raw.pressure)
    if np.isfinite(ppmv).any():
        _check(path, column, raw.ozone, ppmv, raw.pressure)
    return replace(raw, ozone=ppmv, ozone_unit="ppmv")


def _check(path: Path, column: OzoneColumn, given: FloatArray, ppmv: FloatArray, pressure: FloatArray) -> None:
    """Refuse ozone that is impossible in air."""
    low = pressure > LOW_HPA
    limit = np.where(low, MOST_LOW_PPMV, MOST_PPMV)
    known = np.isfinite(ppmv)
    remedy = f"give {OZONE_ALLOWED}"
    if np.any(ppmv[known] < 0.0):
        i = int(np.nanargmin(ppmv))
        raise DataError(
            f"{path}: {column.name} holds {given[i]:g} at {pressure[i]:g} hPa; ozone is 0 or more: is it the right column, its unit "
            f"{column.unit}, or a number for missing values? leave such cells empty, or {remedy}"
        )
    over = known & (ppmv > limit)
    if over.any():
        i = int(np.argmax(np.where(over, ppmv / limit, 0.0)))
        raise DataError(
            f"{path}: {column.name} holds {given[i]:g} at {pressure[i]:g} hPa, {ppmv[i]:.3g} ppmv in {column.unit}; at most {limit[i]:g} "
            f"ppmv are allowed there: {_suspicion(column, given[i], pressure[i], float(limit[i]))} {remedy}"
        )
    shown = known & (ppmv > 0.0) & low
    shown = shown if shown.any() else known & (ppmv > 0.0)
    if shown.any() and float(np.median(ppmv[shown])) < LEAST_PPMV:
        i = int(np.argsort(np.where(shown, ppmv, np.inf))[int(shown.sum()) // 2])
        raise DataError(
            f"{path}: {column.name} holds {given[i]:g} at {pressure[i]:g} hPa, {ppmv[i]:.3g} ppmv in {column.unit}; half of its levels lie "
            f"below {LEAST_PPMV:g} ppmv: {_suspicion(column, given[i], pressure[i], MOST_LOW_PPMV)} {remedy}"
        )


def _suspicion(column: OzoneColumn, given: float, pressure: float, limit: float) -> str:
    """Return a question about the unit in which a value would be possible in air."""
    other = [
        unit
        for unit in RANKS
        if unit != column.unit and LEAST_PPMV < float(OzoneColumn(0, "", unit).in_ppmv(np.array([given]), np.array([pressure]))[0]) < limit
    ]
    return f"is its unit {' or '.join(other)}?" if other else "is it the right column and unit?"
