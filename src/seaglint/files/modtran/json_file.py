"""Reader of MODTRAN 6's JSON output (``JSONPRNT``, ``JSONOPT`` with ``WRT_OUTPUT``).

Layout: ``MODTRAN[i].MODTRANOUTPUT.SPECTRA.RADIANCE`` (``IRRADIANCE``, ``TRANSMITTANCE``) holds one list a column, named ``TOT_TRANS``,
``THRML_EM``, ``THRML_SCT``, ``SURF_EMIS``, ``MULT_SCAT``, ``SING_SCAT``, ``GRND_RFLT``, ``DRCT_RFLT``, ``TOTAL_RAD``, ``REF_SOL``,
``SOL_AT_OBS``, ``DEPTH``, ... (github.com/brianschubert/pymod6, ``tests/test_io.py`` and ``input/schema.py``); with ``WRT_INPUT`` the
case's ``MODTRANINPUT`` stands beside it and tells its geometry and spectral grid.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError
from seaglint.files.modtran.modtran_spectrum import SPECTRAL, Column, ModtranSight, ModtranSpectrum, Table, column_of, spectrum_of
from seaglint.files.text_file import parsed_json

#: Mode (IEMSCT) by its name in MODTRAN 6.
MODES: Final = {
    "RT_TRANSMITTANCE": 0,
    "RT_THERMAL_ONLY": 1,
    "RT_SOLAR_AND_THERMAL": 2,
    "RT_SOLAR_IRRADIANCE": 3,
    "RT_LUNAR_AND_THERMAL": 2,
    "RT_LUNAR_IRRADIANCE": 3,
}

_SPECTRA: Final = ("RADIANCE", "IRRADIANCE", "TRANSMITTANCE")

_AS_WRITTEN = "give MODTRAN 6's JSON output (JSONOPT = WRT_INPUT_OUTPUT)"


def is_json(text: str) -> bool:
    """Return true where a text begins as JSON does."""
    return text.lstrip()[:1] in ("{", "[")


def read_json(path: Path, text: str) -> list[ModtranSpectrum]:
    """Read all cases of a file, in its order.

    Raises
    ------
    DataError
        Naming file, case and key of what cannot be used.
    """
    content = parsed_json(path, text, _AS_WRITTEN)
    cases = content.get("MODTRAN") if isinstance(content, dict) else None
    if not isinstance(cases, list) or not cases:
        raise DataError(f"{path}: has no list MODTRAN of cases; {_AS_WRITTEN}")
    return [_spectrum(path, i, case) for i, case in enumerate(cases, 1)]


def _spectrum(path: Path, number: int, case: Any) -> ModtranSpectrum:
    where = f"{path}: case {number}"
    spectra = _inside(case, "MODTRANOUTPUT", "SPECTRA")
    if not isinstance(spectra, dict):
        raise DataError(f"{where}: has no MODTRANOUTPUT.SPECTRA: it is an input, or the run failed; run it and {_AS_WRITTEN}")
    block = next((spectra[name] for name in _SPECTRA if isinstance(spectra.get(name), dict)), None)
    if block is None:
        raise DataError(f"{where}: MODTRANOUTPUT.SPECTRA holds none of {', '.join(_SPECTRA)}; {_AS_WRITTEN}")
    columns: dict[Column, FloatArray] = {}
    for name, values in [*((k, v) for k, v in spectra.items() if isinstance(v, list)), *block.items()]:
        column = column_of(str(name))
        if column is None or not isinstance(values, list):
            continue
        if not values or not all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
            raise DataError(f"{where}: {name} is no list of numbers; {_AS_WRITTEN}")
        try:
            columns[column] = np.array(values, dtype=np.float64)
        except OverflowError:
            raise DataError(f"{where}: {name} holds a number beyond all bounds; {_AS_WRITTEN}") from None
    size = max((values.size for values in columns.values()), default=0)
    if not any(name in columns for name in SPECTRAL):
        grid = _grid(case, size)
        if grid is not None:
            columns["wavenumber"] = grid
    for column, values in columns.items():
        if values.size != size:
            raise DataError(f"{where}: {column.replace('_', ' ')} has {values.size} of {size} spectral samples; {_AS_WRITTEN}")
    return spectrum_of(Table(path, f"case {number}", columns, tuple(map(str, block)), _sight(case)))


def _inside(value: Any, *keys: str) -> Any:
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return value


def _number(value: Any) -> float:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300 else np.nan


def _grid(case: Any, size: int) -> FloatArray | None:
    """Return spectral samples from V1, V2 and DV of the input, in wavenumbers, where the output does not list them."""
    spectral = _inside(case, "MODTRANINPUT", "SPECTRAL")
    low, high, step = (_number(_inside(spectral, key)) for key in ("V1", "V2", "DV"))
    flags = str(_inside(spectral, "FLAGS") or " ")
    if not (np.isfinite([low, high, step]).all() and step > 0.0 and high > low) or flags[:1].upper() not in ("W", " "):
        return None
    return np.asarray(low + step * np.arange(size, dtype=np.float64)) if 1 < size == round((high - low) / step) + 1 else None


def _sight(case: Any) -> ModtranSight | None:
    geometry = _inside(case, "MODTRANINPUT", "GEOMETRY")
    mode = MODES.get(str(_inside(case, "MODTRANINPUT", "RTOPTIONS", "IEMSCT")))
    kind = _inside(geometry, "ITYPE")
    height, zenith = _number(_inside(geometry, "H1ALT")), _number(_inside(geometry, "OBSZEN"))
    if mode is None or kind not in (2, 3) or not np.isfinite([height, zenith]).all():
        return None
    end = _number(_inside(geometry, "H2ALT"))
    towards = (_number(_inside(geometry, key)) for key in ("PARM1", "PARM2"))
    azimuth, solar = towards if mode == 2 and _inside(geometry, "IPARM") == 2 else (np.nan, np.nan)
    return ModtranSight(mode, kind, height, zenith, 0.0 if np.isnan(end) else end, azimuth, solar)
