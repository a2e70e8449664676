"""Decks of LOWTRAN7 and MODTRAN for the lines of sight that a scenario needs, and a manifest of the line of each case of an output.

Decks (``tape5``) of LOWTRAN7 and of MODTRAN 4 and 5 have one case for each line of sight, all in one file (IRPT = 1). Card layouts:
LOWTRAN7's READ statements; MODTRAN's from its user's manual as public decks show it (GeoscienceAustralia/wagl,
``gaip/modtran_profiles.py``). Cards 2, 2C, 3, 3A1, 3A2 and 5 have the same columns in both; MODTRAN adds to card 1 its first five columns,
card 1A, and FWHM to card 4.

The input of MODTRAN 6 is JSON, with one case for each line of sight. Keys and their values: github.com/brianschubert/pymod6,
``input/schema.py``; templates of GeoscienceAustralia/wagl (``modtran_profile_json.py``) and isofit show them in use.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np

from seaglint.air.coordinates import elevation_of_coordinate, straight_sea_cosine, straight_slant
from seaglint.air.profile.bent_ray import RefractingAir
from seaglint.air.sun_and_sky import grazing_share
from seaglint.base.conventions import FloatArray, horizon_depression
from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.formats.lowtran.deck import MODELS, STEP_CM, Haze, LowtranAir
from seaglint.store.outputs import read_json, reason_of

MANIFEST: Final = "manifest.json"

VERSION: Final = 1

PATH_NODES: Final = 28
SKY_NODES: Final = 28
#: Numbers of nodes: paths from straight down to the horizon, sky and Sun down to the horizontal, sky down to the horizon.
DIP_NODES: Final = 24

#: Azimuths from the Sun at which sunlight scattered by the air is sampled [deg]: the aureole is 10 deg wide.
AZIMUTHS: Final = (0.0, 2.0, 4.0, 7.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, 150.0, 180.0)

SHORT_OF_HORIZON: Final = 1e-3
#: Part of the horizon's depression by which paths end below it: rays there may miss the sea in another code, or by rounding.
SHORT_OF_LOWTRAN7_HORIZON: Final = 1e-4


@dataclass(frozen=True)
class ModtranCase:
    """Line of sight of one case: ``path`` from the sensor to the sea, ``sky`` from sensor or sea, ``sun`` from the sea to the Sun."""

    kind: Literal["path", "sky", "sun"]  #: Line of sight: path, sky or Sun.
    height_m: float  #: Height of the eye: H1 [m].
    zenith_deg: float  #: Zenith angle of the line there: ANGLE, OBSZEN [deg].
    range_m: float | None = None  #: Arc of a path along the sea [m].
    horizon_share: float | None = None  #: Depression of sky below the horizontal over that of the calculation's own horizon [1].
    azimuth_deg: float | None = None  #: From the Sun [deg]; None without scattered sunlight.


@dataclass(frozen=True)
class Manifest:
    """Lines of sight in the order of the deck's cases, and their common properties."""

    lines: tuple[ModtranCase, ...]
    sensor_height_m: float
    solar_zenith_deg: float | None  #: Zenith angle of the Sun whose scattered light is included [deg]; None without scattered light.
    outputs: tuple[str, ...]  #: Names of the results that the decks make; the first one that exists is read.

    def text(self) -> str:
        """Return the manifest as JSON."""
        shared = {k: v for k, v in asdict(self).items() if k != "lines"}
        lines = [{k: v for k, v in asdict(line).items() if v is not None} for line in self.lines]
        head = json.dumps({"seaglint_manifest": VERSION, **shared}, indent=2)[:-2]
        return head + ',\n  "lines": [\n    ' + ",\n    ".join(json.dumps(line) for line in lines) + "\n  ]\n}\n"


def read_manifest(path: Path) -> Manifest:
    """Read the manifest of a folder.

    Raises
    ------
    DataError
        Not a manifest, or damaged.
    """
    again = "write the decks again with seaglint atmosphere write"
    content = read_json(path, again)
    if not isinstance(content, dict) or content.get("seaglint_manifest") != VERSION:
        raise DataError(f"{path}: is no manifest of this version of seaglint; {again}")
    try:
        lines = tuple(_line(entry) for entry in content["lines"])
        height, solar = content["sensor_height_m"], content["solar_zenith_deg"]
        if not lines or not isinstance(height, int | float) or not (solar is None or 0.0 <= solar <= 90.0):
            raise ValueError("no lines")
        return Manifest(lines, float(height), solar, tuple(map(str, content["outputs"])))
    except (ValueError, KeyError, TypeError) as error:
        raise DataError(f"{path}: is damaged ({reason_of(error, 80)}); {again}") from None


def _line(entry: JsonObject) -> ModtranCase:
    line = ModtranCase(**entry)
    numbers = [value for name, value in asdict(line).items() if name != "kind" and value is not None]
    if line.kind not in ("path", "sky", "sun") or not all(isinstance(x, int | float) and abs(x) < 1e9 for x in numbers):
        raise ValueError(f"line {entry}")
    if line.kind == "path" and line.range_m is None:
        raise ValueError("a path without range_m")
    return line


def needed_lines(air: RefractingAir, height: float, solar_zenith: float | None, *, to_horizon: bool = False) -> list[ModtranCase]:
    """Return the lines for a sensor at ``height`` [m], with scattered sunlight for a Sun at ``solar_zenith`` [rad], if any.

    ``to_horizon`` lets the farthest path come closer to the horizon, which is LOWTRAN7's own.
    """
    short = SHORT_OF_LOWTRAN7_HORIZON if to_horizon else SHORT_OF_HORIZON
    cosine = _path_cosines(air, height, float(air.sea_cosine(height, air.dip(height) * (1.0 + short))))
    paths = [
        ModtranCase("path", height, 90.0 + float(np.degrees(d)), range_m=float(a))
        for d, a in zip(air.depression(height, cosine), air.sea_arc(height, cosine), strict=True)
    ]
    above = 90.0 - np.degrees(elevation_of_coordinate(np.linspace(0.0, 1.0, SKY_NODES), 0.0))
    above = np.clip(above, 0.0, 90.0)[::-1].tolist()
    # Lines of the sky stop slightly above the horizon, where rays of another code may end in the sea.
    share = (1.0 - 2e-3) * grazing_share(np.linspace(0.0, 1.0, DIP_NODES))[1:]
    dip = np.degrees(air.dip(height))
    sky = [ModtranCase("sky", 0.0, z) for z in above] + [ModtranCase("sky", height, z) for z in above]
    sky += [ModtranCase("sky", height, 90.0 + float(s * dip), horizon_share=float(s)) for s in share]
    suns = [ModtranCase("sun", 0.0, z) for z in above]
    if solar_zenith is None:
        return [*paths, *sky, *suns]
    # Scattered sunlight depends on the azimuth from the Sun: each line is run at all azimuths.
    return [*(ModtranCase(**{**asdict(line), "azimuth_deg": azimuth}) for line in (*paths, *sky) for azimuth in AZIMUTHS), *suns]


def _path_cosines(air: RefractingAir, height: float, least: float) -> FloatArray:
    """Return cosines of zenith angles at the sea, from straight down, evenly spaced in the logarithm of the slant path."""
    slant = height * (straight_slant(height, least) / height) ** np.linspace(0.0, 1.0, PATH_NODES)
    cosine = np.clip(straight_sea_cosine(height, slant), least, 1.0)
    cosine[0] = 1.0
    return np.asarray(cosine)


def horizon_zenith_deg(line: ModtranCase) -> float:
    """Return the zenith angle of a sky line over the package's own horizon, onto which lines below the horizontal are stretched [deg]."""
    if line.horizon_share is None:
        return line.zenith_deg
    return 90.0 + float(np.degrees(horizon_depression(line.height_m))) * line.horizon_share


FWHM_CM: Final = 20  #: Width of MODTRAN's slit function [cm-1], which is LOWTRAN7's resolution.

LOWTRAN7_CO2_PPMV: Final = 330.0  #: Carbon dioxide of LOWTRAN7's models [1e-6 of the volume].

AT_1_AU: Final = 93  #: Day of the year on which both programs take the Sun's mean distance (IDAY).

#: Temperature of the boundary (TBOUND, TPTEMP) [K]: the sea adds nothing, and 0 would mean that of the lowest air.
LEAST_BOUNDARY_TEMPERATURE: Final = "   0.001"


def deck(
    lines: Sequence[ModtranCase], air: LowtranAir, solar_zenith_deg: float | None, *, modtran: bool, co2_ppmv: float = LOWTRAN7_CO2_PPMV
) -> str:
    """Return the text of a deck with a case for each line; LOWTRAN7 has 330 ppmv of carbon dioxide, whatever ``co2_ppmv`` is."""
    cases = []
    for i, line in enumerate(lines):
        cases.append("\n".join([*_cards(line, air, solar_zenith_deg, co2_ppmv if modtran else None), f"{int(i + 1 < len(lines)):5d}"]))
    return "\n".join(cases) + "\n"


def _cards(line: ModtranCase, air: LowtranAir, solar_zenith_deg: float | None, co2_ppmv: float | None) -> Iterator[str]:
    modtran = co2_ppmv is not None
    mode = 3 if line.kind == "sun" else 2 if line.azimuth_deg is not None and solar_zenith_deg is not None else 1
    kind, profile = (2 if line.kind == "path" else 3), air.levels
    model = 7 if profile else MODELS[air.model]
    between = f"{kind:5d}{mode:5d}" + f"{0:5d}" * 8 + f"{1 if profile else 0:5d}{0:5d}{LEAST_BOUNDARY_TEMPERATURE}"
    if modtran:
        # MODTRN = T, SPEED = M (slow), no correlated k; SURREF = 0.
        yield f"TM{model:3d}{between}{'0.00':>7}"
        yield f"FF{2:3d}{0:5d}{co2_ppmv:10.3f}{'0':>10}{'0':>10} F F F F F{0.0:10.3f}"
    else:
        yield f"{model:5d}{between}{'0.00':>7}"
    yield air.aerosol.card()
    if profile:
        yield f"{len(profile):5d}{0:5d}{0:5d}sounding"
        yield from (level.card(MODELS[air.model]) for level in profile)
    # Card 3: H1, H2 and ANGLE; H2 is 0 also for paths to space, where ITYPE = 3 makes it unused.
    yield fixed(line.height_m / 1e3) + fixed(0.0) + fixed(line.zenith_deg) + (f"{AT_1_AU:5d}" if mode == 3 else "")
    if mode == 2:
        # IPARM = 2: azimuth of the Sun from the line of sight, and its zenith angle, at H1; IPH = 2: Mie phase functions.
        yield f"{2:5d}{2:5d}{AT_1_AU:5d}{0:5d}"
        yield fixed(line.azimuth_deg or 0.0) + fixed(solar_zenith_deg or 0.0)
    yield f"{air.v1:10.1f}{air.v2:10.1f}{STEP_CM:10.1f}" + (f"{FWHM_CM:10.1f}RW" if modtran else "")


def fixed(value: float) -> str:
    """Return a number in ten columns, the first blank, with as many decimals as fit; its point overrules the format's.

    >>> fixed(0.03), fixed(101.2345678901), fixed(90.1653187)
    (' 0.0300000', ' 101.23457', ' 90.165319')
    """
    return f"{value:10.{7 if value < 10.0 else 6 if value < 100.0 else 5}f}"


#: Model atmospheres and aerosols by their names in MODTRAN 6.
JSON_MODELS: Final = {
    "tropical": "ATM_TROPICAL", "midlatitude-summer": "ATM_MIDLAT_SUMMER", "midlatitude-winter": "ATM_MIDLAT_WINTER",
    "subarctic-summer": "ATM_SUBARC_SUMMER", "subarctic-winter": "ATM_SUBARC_WINTER", "us-standard-1976": "ATM_US_STANDARD_1976",
}  # fmt: skip
HAZES: Final[dict[Haze, str]] = {
    "none": "AER_NONE", "rural-23km": "AER_RURAL", "rural-5km": "AER_RURAL_DENSE", "navy-maritime": "AER_MARITIME_NAVY",
    "maritime-23km": "AER_MARITIME", "urban": "AER_URBAN", "tropospheric": "AER_TROPOSPHERIC", "advective-fog": "AER_FOG_ADVECTIVE",
    "radiative-fog": "AER_FOG_RADIATIVE", "desert": "AER_DESERT",
}  # fmt: skip


def json_deck(lines: Sequence[ModtranCase], air: LowtranAir, solar_zenith_deg: float | None, name: str, co2_ppmv: float) -> str:
    """Return the text of the input; results go to ``name.json`` and ``name.csv``.

    Raises
    ------
    DataError
        The air is a sounding: its levels above the last one follow a model atmosphere, which profiles of MODTRAN 6 cannot express.
    """
    if air.levels:
        raise DataError("modtran6-json takes model atmospheres, not atmosphere.sounding; choose format='tape5', which MODTRAN 6 reads too")
    cases = [{"MODTRANINPUT": _case(i, line, air, solar_zenith_deg, name, co2_ppmv)} for i, line in enumerate(lines)]
    return json.dumps({"MODTRAN": cases}, indent=1) + "\n"


def _case(index: int, line: ModtranCase, air: LowtranAir, solar_zenith_deg: float | None, name: str, co2_ppmv: float) -> JsonObject:
    model, aerosol = JSON_MODELS[air.model], air.aerosol
    geometry: JsonObject = {
        "ITYPE": 2 if line.kind == "path" else 3,
        "H1ALT": line.height_m / 1e3,
        "H2ALT": 0.0 if line.kind == "path" else 100.0,
        # Sunlight at the sea is SOL_AT_OBS of a look straight up, for a Sun at PARM2.
        "OBSZEN": 0.0 if line.kind == "sun" else line.zenith_deg,
        "IDAY": AT_1_AU,
    }
    solar = line.zenith_deg if line.kind == "sun" else solar_zenith_deg
    lit = line.kind == "sun" or (line.azimuth_deg is not None and solar is not None)
    if lit:
        geometry |= {"IPARM": 2, "PARM1": line.azimuth_deg or 0.0, "PARM2": solar}
    aerosols: JsonObject = {"IHAZE": HAZES[aerosol.haze], "IPH": 2}
    if aerosol.visibility_km is not None:
        aerosols["VIS"] = aerosol.visibility_km
    if aerosol.haze == "navy-maritime":
        aerosols |= {"ICSTL": aerosol.air_mass}
    if aerosol.haze in ("navy-maritime", "desert"):
        # 0 stands for the model's own wind.
        aerosols |= {"WSS": max(aerosol.wind, 1e-3), "WHH": max(aerosol.wind_24h, 1e-3)}
    return {
        "NAME": f"{name}_{index:04d}",
        "CASE": index,
        "RTOPTIONS": {
            "MODTRN": "RT_MODTRAN",
            "IEMSCT": "RT_SOLAR_AND_THERMAL" if lit else "RT_THERMAL_ONLY",
            "IMULT": "RT_NO_MULTIPLE_SCATTER",
        },
        "ATMOSPHERE": {"MODEL": model, **{f"M{i}": model for i in range(1, 7)}, "CO2MX": co2_ppmv},
        "AEROSOLS": aerosols,
        "GEOMETRY": geometry,
        "SURFACE": {"SURFTYPE": "REFL_CONSTANT", "SURREF": 0.0, "TPTEMP": 0.001, "GNDALT": 0.0},
        "SPECTRAL": {"V1": float(air.v1), "V2": float(air.v2), "DV": float(STEP_CM), "FWHM": float(FWHM_CM), "XFLAG": "W", "FLAGS": "W"},
        "FILEOPTIONS": {"NOFILE": 2, "JSONPRNT": f"{name}.json", "JSONOPT": "WRT_INPUT_OUTPUT", "CSVPRNT": f"{name}.csv"},
    }
