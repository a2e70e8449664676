"""Input of MODTRAN 6 as JSON, with one case for each line of sight.

Keys and their values: github.com/brianschubert/pymod6, ``input/schema.py``; templates of GeoscienceAustralia/wagl
(``modtran_profile_json.py``) and isofit show them in use.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Final

from seaglint.base.errors import DataError
from seaglint.base.free_form import JsonObject
from seaglint.files.lowtran.deck import STEP_CM, Haze, LowtranAir
from seaglint.files.modtran.lines import ModtranCase
from seaglint.files.modtran.tape5 import AT_1_AU, FWHM_CM

MODELS: Final = {
    "tropical": "ATM_TROPICAL",
    "midlatitude-summer": "ATM_MIDLAT_SUMMER",
    "midlatitude-winter": "ATM_MIDLAT_WINTER",
    "subarctic-summer": "ATM_SUBARC_SUMMER",
    "subarctic-winter": "ATM_SUBARC_WINTER",
    "us-standard-1976": "ATM_US_STANDARD_1976",
}

HAZES: Final[dict[Haze, str]] = {
    "none": "AER_NONE",
    "rural-23km": "AER_RURAL",
    "rural-5km": "AER_RURAL_DENSE",
    "navy-maritime": "AER_MARITIME_NAVY",
    "maritime-23km": "AER_MARITIME",
    "urban": "AER_URBAN",
    "tropospheric": "AER_TROPOSPHERIC",
    "advective-fog": "AER_FOG_ADVECTIVE",
    "radiative-fog": "AER_FOG_RADIATIVE",
    "desert": "AER_DESERT",
}


def json_deck(lines: Sequence[ModtranCase], air: LowtranAir, solar_zenith_deg: float | None, name: str, co2_ppmv: float) -> str:
    """Return the text of the input; results go to ``name.json`` and ``name.csv``.

    Raises
    ------
    DataError
        The air is a sounding: its levels above the last one follow a model atmosphere, which profiles of MODTRAN 6 cannot say.
    """
    if air.levels:
        raise DataError("modtran6-json takes model atmospheres, not atmosphere.sounding; choose format='tape5', which MODTRAN 6 reads too")
    cases = [{"MODTRANINPUT": _case(i, line, air, solar_zenith_deg, name, co2_ppmv)} for i, line in enumerate(lines)]
    return json.dumps({"MODTRAN": cases}, indent=1) + "\n"


def _case(index: int, line: ModtranCase, air: LowtranAir, solar_zenith_deg: float | None, name: str, co2_ppmv: float) -> JsonObject:
    model, aerosol = MODELS[air.model], air.aerosol
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
