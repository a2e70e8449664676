"""Reader of Datawell Waverider ``.spt`` files of one record, whose name gives place and time (``buoy}2024-09-09T01h15Z.spt``).

Bands have energy relative to the largest, mean direction waves come FROM and width of the directions [deg].
"""

from __future__ import annotations

import re
from datetime import datetime
from pathlib import Path
from typing import Final

import numpy as np

from seaglint.base.errors import DataError
from seaglint.files.waves.bands import Cosine
from seaglint.files.waves.wave_file import Held, parsed, reader

_NAME: Final = re.compile(r"^(.*)\}(\d{4}-\d{2}-\d{2})T(\d{2})h(\d{2})Z?$")
_WIDEST: Final = (80.0, 81.1)  # deg: the cosine's limit, and sqrt(2) rad, the width of bands without any direction


def read(path: Path) -> Held:
    """Read the only record of a file."""
    name = _NAME.match(path.stem)
    if name is None:
        raise DataError(f"{path}: the name does not tell place and time; Datawell names files such as 'buoy}}2024-09-09T01h15Z.spt'")
    moment = np.datetime64(datetime.fromisoformat(f"{name[2]}T{name[3]}:{name[4]}"))
    function = reader("read_datawell")
    data = parsed(path, "a Datawell file", lambda: function(str(path), dd=None))
    columns = [np.asarray(data[key].values, dtype=np.float64).ravel() for key in ("freq", "efth", "dmf", "dsprf")]
    frequency, energy, directions, width = columns
    limit, most = _WIDEST
    if np.any(width > most):
        raise DataError(f"{path}: a width of {width.max():g} deg is above {most:g} deg, that of no direction at all; is the file whole?")
    return Held(
        lambda *_: Cosine(frequency, energy, directions, np.minimum(width, limit)), np.array([moment], "datetime64[ns]"), (name[1],)
    )
