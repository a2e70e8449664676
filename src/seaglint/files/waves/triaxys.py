"""Reader of TRIAXYS buoys' spectra as text. Directions are where waves come FROM, 0 and 360 degrees both listed."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from seaglint.base.errors import DataError
from seaglint.files.waves.bands import Bands, Bins, Plain
from seaglint.files.waves.wave_file import Held, parsed, reader

_TYPE = re.compile(r"^\s*TYPE\s*=\s*(.*?)\s*$", re.MULTILINE)
_ZONE = re.compile(r"^\s*DATE\s*=.*\((.*?)\)", re.MULTILINE)


def read(path: Path) -> Held:
    """Read the only record of a file."""
    header = parsed(path, "a TRIAXYS file", lambda: path.read_text(encoding="utf-8")[:4096])
    kind, zone = _TYPE.search(header), _ZONE.search(header)
    if kind is None or kind[1] not in ("DIRECTIONAL SPECTRUM", "NON-DIRECTIONAL SPECTRUM"):
        raise DataError(
            f"{path}: TYPE = {kind[1] if kind else 'nothing'} is not read; allowed: DIRECTIONAL SPECTRUM or NON-DIRECTIONAL SPECTRUM"
        )
    if zone is not None and zone[1].strip().upper() not in ("UTC", "GMT", "Z"):
        raise DataError(f"{path}: its time is in '{zone[1]}', and UTC is read; change the line DATE")
    function = reader("read_triaxys")
    data = parsed(path, "a TRIAXYS file", lambda: function(str(path)))
    frequency = np.asarray(data["freq"].values, dtype=np.float64)
    values = np.asarray(data["efth"].values, dtype=np.float64)[0]

    def bands(_moment: int, _place: int) -> Bands:
        if values.ndim == 1:
            return Plain(frequency, values)
        directions = np.asarray(data["dir"].values, dtype=np.float64)
        once = directions < 360.0 - 1e-6
        return Bins(frequency, directions[once], values[:, once])

    return Held(bands, np.asarray(data["time"].values).astype("datetime64[ns]"))
