"""Reader of Octopus forecast files: variance per band of frequency and direction, directions waves come FROM."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from seaglint.files.waves.bands import Bins
from seaglint.files.waves.wave_file import Held, parsed, reader


def read(path: Path) -> Held:
    """Read the records of one place."""
    function = reader("read_octopus")
    data = parsed(path, "an Octopus file", lambda: function(str(path)))
    density = data["efth"].transpose("time", "site", "freq", "dir").values.astype(np.float64)
    frequency, directions = (np.asarray(data[name].values, dtype=np.float64) for name in ("freq", "dir"))
    times = np.asarray(data["time"].values).astype("datetime64[ns]")
    places = [np.broadcast_to(np.ravel(data[name].values), (times.size, 1)) for name in ("lat", "lon")]
    return Held(lambda moment, _: Bins(frequency, directions, density[moment, 0]), times, ("1",), *places)
