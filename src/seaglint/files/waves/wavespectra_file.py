"""Reader of wavespectra's own NetCDF: ``efth(..., freq, dir)`` in m² s deg⁻¹, directions FROM; without ``dir`` in m² s."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from seaglint.files.waves.bands import Bands, Bins, Plain
from seaglint.files.waves.netcdf_waves import held_by
from seaglint.files.waves.wave_file import Held


def read(path: Path) -> Held:
    """Read the records of a file."""

    def convert(data: Any) -> Bands:
        frequency = np.asarray(data["freq"].values, dtype=np.float64)
        spectrum = data["efth"].squeeze(drop=True)
        if "dir" not in spectrum.dims:
            return Plain(frequency, np.asarray(spectrum.values, dtype=np.float64))
        density = np.asarray(spectrum.transpose("freq", "dir").values, dtype=np.float64)
        return Bins(frequency, np.asarray(data["dir"].values, dtype=np.float64), density)

    return held_by(path, "efth", convert)
