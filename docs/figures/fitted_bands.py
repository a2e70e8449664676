"""Differences from RRTMGP's paths by band and spectroscopy; writes a table of docs/validation/air.md.

python docs/figures/fitted_bands.py
"""

from __future__ import annotations

import csv

import numpy as np

from seaglint.air.profile.aerosols import HazeWeather
from seaglint.air.profile.band_laws import Spectroscopy
from seaglint.air.profile.homogeneous_path import homogeneous_spectrum
from validation_tables import folder, table, write_table

FILES = {"lower air": "paths.csv", "upper air": "paths_upper_air.csv"}
SPLIT_HPA = 99.4843
"""Pressure at which RRTMGP's tables change."""

HELD = {
    700: ("CO2 O3", "CO2 O3"), 820: ("CO2", ""), 980: ("CO2 O3", "CO2 O3"), 1080: ("CO2 O3 N2O", "CO2 O3 N2O"),
    1180: ("CH4 N2O", "CH4 N2O"),
    1800: ("CO2", ""), 2080: ("CO2 N2O CO", "O3"), 2250: ("CO2", "CO2"), 2390: ("CO2 N2O", ""), 2680: ("CH4", "CH4"),
}  # fmt: skip
"""Gases besides water that RRTMGP holds below and above that pressure, by lower edge of the band [cm-1]."""

DRY = (2250,)
"""Bands in which it has no water."""


def difference(row: dict[str, str], band: tuple[int, int], spectroscopy: Spectroscopy) -> float:
    """Transmittance of a path less RRTMGP's [1]."""
    pressure = float(row["pressure_hpa"])
    held = HELD.get(band[0], ("", ""))[pressure < SPLIT_HPA].split()
    found = homogeneous_spectrum(
        temperature_k=float(row["temperature_k"]),
        pressure_hpa=pressure,
        vapour_pressure_hpa=0.0 if band[0] in DRY else float(row["vapour_pressure_hpa"]),
        length_km=float(row["length_km"]),
        band_um=(1e4 / band[1], 1e4 / band[0]),
        ppmv={gas: float(row[f"{gas.lower()}_ppmv_dry"]) for gas in held},
        spectroscopy=spectroscopy,
        haze=HazeWeather("none"),
    )
    return found.mean - float(row[f"transmittance_{band[0]}-{band[1]}"])


def lines(every: int = 1) -> list[str]:
    """The table of one path in so many."""
    place = folder("SEAGLINT_REFERENCE_DIR") / "modern_air"
    rows: dict[str, list[dict[str, str]]] = {}
    for name, file in FILES.items():
        with (place / file).open(encoding="utf-8") as stream:
            rows[name] = list(csv.DictReader(stream))[::every]
    bands = [tuple(int(edge) for edge in key.split("_")[1].split("-")) for key in rows["lower air"][0] if key.startswith("transmittance")]
    cells = []
    for low, high in bands:
        row = [f"{low}-{high} ({1e4 / high:.1f}-{1e4 / low:.1f} µm)"]
        for name in FILES:
            for spectroscopy in ("lblrtm", "lowtran7"):
                off = np.array([difference(path, (low, high), spectroscopy) for path in rows[name]])
                row.append(f"{np.abs(off).mean():.3f}, {np.quantile(np.abs(off), 0.95):.3f}, {off.mean():+.3f}")
        cells.append(tuple(row))
    return list(table(("band, cm⁻¹", "lower air, lblrtm", "lowtran7", "upper air, lblrtm", "lowtran7"), cells))


def main() -> None:
    """Write the table into the page."""
    write_table("fitted-bands", lines())


if __name__ == "__main__":
    main()
