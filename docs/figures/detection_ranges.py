"""Print ranges of five cameras and objects against closed forms, and those of all detectors, for docs/validation/detection.md.

python docs/figures/detection_ranges.py [FOLDER]

Points are kept in the folder, where one is given.
"""

from __future__ import annotations

import math
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import j1
from scipy.stats import norm

from seaglint.base.errors import SeaglintError
from seaglint.detection.detector_names import NAMES
from seaglint.scenario.load import parse_scenario
from seaglint.store.detection_results import DetectionRange, StudyParts
from seaglint.studies.detect.detection_requests import RangeRequest
from seaglint.studies.detect.range_search import detection_range

H, C, K = 6.62607015e-34, 299792458.0, 1.380649e-23
PIXELS = (160, 96)
SEAS = 16
LIMITS = (200.0, 30_000.0)
DEFAULT = "matched"
AIR_K = 288.15
NIGHT: dict[str, Any] = {"seed": 21, "sun": {"zenith_deg": 120.0, "azimuth_deg": 180.0}, "wind": {"speed_m_s": 5.0, "from_deg": 230.0}}
FLAT: dict[str, Any] = {"spectrum": {"kind": "flat"}, "slopes": {"kind": "flat"}, "temperature_k": AIR_K}
"""With air and sky of the sea's temperature: wherever one looks, a blackbody of that temperature."""


@dataclass(frozen=True)
class Case:
    """A camera whose noise is known, and a sphere above the sea in the night."""

    name: str
    band_um: tuple[float, float]
    pitch_um: float
    focal_length_m: float
    f_number: float
    p_fa: float
    height_m: float
    radius_m: float
    temperature_k: float
    extinction_per_km: float = 0.1
    netd_k: float | None = None
    integration_s: float = 0.0
    efficiency: float = 0.0
    read_noise_e: float = 0.0

    def scenario(self) -> Any:
        """The scenario, in a cavity of one temperature."""
        optics = {"f_number": self.f_number, "focal_length_m": self.focal_length_m}
        detector: dict[str, Any] = {"pitch_um": self.pitch_um}
        if self.netd_k is not None:
            detector |= {"kind": "thermal", "netd_k": self.netd_k, "netd_f_number": self.f_number}
        else:
            detector |= {"integration_time_s": self.integration_s, "quantum_efficiency": self.efficiency}
            detector |= {"read_noise_e": self.read_noise_e, "well_capacity_e": 2e7, "bit_depth": 16}
        sensor = {"height_m": self.height_m, "elevation_deg": -3.0, "pixels": list(PIXELS), "optics": optics, "detector": detector}
        shape = {"kind": "sphere", "radius_m": self.radius_m}
        sphere = {
            "name": "sphere",
            "shape": shape,
            "temperature_k": self.temperature_k,
            "emissivity": 1.0,
            "north_m": 2000.0,
            "height_m": 4.0,
        }
        band = {"min_um": self.band_um[0], "max_um": self.band_um[1]}
        air = {"source": "isothermal", "temperature_k": AIR_K, "extinction_per_km": self.extinction_per_km}
        around = {"sensor": sensor, "band": band, "objects": [sphere], "sea": FLAT, "atmosphere": air}
        return parse_scenario({**NIGHT, **around})

    def wavelengths(self) -> np.ndarray:
        """Middles of 400 steps of the band [m]."""
        low, high = self.band_um
        return 1e-6 * (low + (high - low) * (np.arange(400) + 0.5) / 400)

    def radiance(self, temperature: float) -> float:
        """Planck's law over the band [W m-2 sr-1]."""
        w = self.wavelengths()
        return float((2.0 * H * C**2 / w**5 / np.expm1(H * C / (w * K * temperature))).sum() * (w[1] - w[0]))

    def photons(self, temperature: float) -> float:
        """The same in photons [s-1 m-2 sr-1]."""
        w = self.wavelengths()
        return float((2.0 * C / w**4 / np.expm1(H * C / (w * K * temperature))).sum() * (w[1] - w[0]))

    def spot(self, down: float, right: float) -> np.ndarray:
        """Share of a point's light in each of 13 x 13 pixels: the band's Airy pattern, summed over fine steps of each pixel.

        Intensity ``(2 J1(x) / x)^2`` with ``x = pi r / (wavelength F)``, ``r`` on the detector.
        """
        steps, half = 11, 6
        edge = (np.arange((2 * half + 1) * steps) + 0.5) / steps - half - 0.5
        r = np.hypot.outer(edge - down, edge - right) * self.pitch_um * 1e-6
        total = np.zeros_like(r)
        every = self.wavelengths()[20::40]
        weights = every**-5 / np.expm1(H * C / (every * K * 290.0))
        for w, weight in zip(every, weights, strict=True):
            x = np.maximum(np.pi * r / (w * self.f_number), 1e-9)
            area = (self.pitch_um * 1e-6 / steps) ** 2 * np.pi / (4.0 * (w * self.f_number) ** 2)
            total += weight / weights.sum() * area * (2.0 * j1(x) / x) ** 2
        side = 2 * half + 1
        return np.asarray(total.reshape(side, steps, side, steps).sum(axis=(1, 3)))

    def gains(self) -> np.ndarray:
        """Answers of the filter over its own size, ``h.s / |h|``, at 25 places in the pixel."""
        places = (np.arange(5) + 0.5) / 5 - 0.5
        centred = self.spot(0.0, 0.0)
        kept = centred[3:-3, 3:-3]
        weights = kept - kept.mean()
        found = []
        for down in places:
            for right in places:
                s = self.spot(down, right)
                answer = [
                    (weights * s[3 + i : 10 + i, 3 + j : 10 + j]).sum() for i in (-1, 0, 1) for j in (-1, 0, 1)
                ]  # the largest pixel beside it is the detection
                found.append(max(answer) / math.sqrt((weights**2).sum()))
        return np.array(found)

    def step_per_noise(self) -> float:
        """Difference of object and background without air, over the noise of a pixel [1]."""
        if self.netd_k is not None:
            sigma = self.netd_k * (self.radiance(300.05) - self.radiance(299.95)) / 0.1
            return abs(self.radiance(self.temperature_k) - self.radiance(AIR_K)) / sigma
        seen = math.pi / (4.0 * self.f_number**2) * (self.pitch_um * 1e-6) ** 2 * self.integration_s * self.efficiency
        sigma = math.sqrt(seen * self.photons(AIR_K) + self.read_noise_e**2)
        return seen * abs(self.photons(self.temperature_k) - self.photons(AIR_K)) / sigma

    def closed_form(self) -> float:
        """Range in the cavity at which ``< Q(Q^-1(P_fa) - c g / sigma) >`` is 0.9 [m], over places in the pixel.

        The contrast ``c = (L(T) - L(T_b)) exp(-k r) pi R^2 / (r^2 Omega)`` over what is behind it, the answer ``g = h.s / |h|`` of the
        filter whose weights are the centred spot's less their mean, and the noise ``sigma``: NETD times the slope of Planck's law at
        300 K, or the square root of the electrons of background and reading.
        """
        gains = self.gains()
        angle = (self.pitch_um * 1e-6 / self.focal_length_m) ** 2
        contrast = self.step_per_noise() * math.pi * self.radius_m**2 / angle

        def rate(at: float) -> float:
            signal = contrast * math.exp(-1e-3 * self.extinction_per_km * at) / at**2 * gains
            return float(norm.sf(norm.isf(self.p_fa) - signal).mean()) - 0.9

        return float(brentq(rate, 10.0, 1e6))


CASES = (
    Case("uncooled, 17 µm, 35 mm F/1.1, 50 mK; buoy", (7.5, 13.5), 17.0, 0.035, 1.1, 1e-3, 20.0, 0.4, 305.0, 0.2, netd_k=0.05),
    Case("uncooled, 12 µm, 14 mm F/1.0, 60 mK; head", (8.0, 14.0), 12.0, 0.014, 1.0, 1e-2, 10.0, 0.15, 306.0, 0.3, netd_k=0.06),
    Case("uncooled, 25 µm, 50 mm F/1.4, 100 mK; funnel", (8.0, 12.0), 25.0, 0.050, 1.4, 1e-2, 30.0, 0.5, 320.0, 0.4, netd_k=0.1),
    Case("InSb, 15 µm, 50 mm F/4, 2 ms; engine", (3.7, 4.8), 15.0, 0.05, 4.0, 1e-3, 40.0, 0.15, 310.0, 0.1, None, 2e-3, 0.8, 600.0),
    Case("MCT, 15 µm, 50 mm F/2, 0.2 ms; cold drogue", (7.7, 9.3), 15.0, 0.05, 2.0, 3e-3, 25.0, 0.25, 280.0, 0.3, None, 2e-4, 0.7, 1000.0),
)


def range_of(number: int, detector: str, parts: StudyParts) -> DetectionRange | None:
    """Range of one detector in one case; nothing where it cannot judge."""
    case, precision = CASES[number], 0.04 if detector == DEFAULT else 0.1
    request = RangeRequest(
        source="scenario",
        object="sphere",
        detector=detector,
        threshold=3.0,
        injections=400,
        seed=2,
        frames=SEAS,
        range_limits=LIMITS,
        p_fa=case.p_fa,
        precision=precision,
    )
    try:
        found = detection_range(case.scenario(), request, parts)
    except SeaglintError as error:
        print(f"{case.name}, {detector}: {error}", file=sys.stderr, flush=True)
        return None
    print(f"{case.name}, {detector}: {metres(found)} m {found.note or ''} {found.warnings}", file=sys.stderr, flush=True)
    return found


def metres(found: DetectionRange | None) -> str:
    """Range as a cell of the table."""
    return "-" if found is None or found.range_m is None else f"{found.range_m:.0f}"


def main() -> None:
    """Print the table: closed form, first estimate, and all detectors, the default one first."""
    names = (DEFAULT, *(name for name in NAMES if name != DEFAULT))
    jobs = [(number, name) for name in names for number in range(len(CASES))]
    with tempfile.TemporaryDirectory() as folder:
        kept = sys.argv[1] if sys.argv[1:] else None
        parts = StudyParts.at(Path(kept or folder) / "ranges", resume=kept is not None, overwrite=kept is None)
        with ProcessPoolExecutor(2) as workers:
            ranges = dict(zip(jobs, workers.map(range_of, *zip(*jobs, strict=True), [parts] * len(jobs)), strict=True))
    every = range(len(CASES))
    own = [ranges[number, DEFAULT] for number in every]
    print(f"| range [m] | {' | '.join(case.name for case in CASES)} |")
    print("|---" * (len(CASES) + 1) + "|")
    print(f"| closed form | {' | '.join(f'{case.closed_form():.0f}' for case in CASES)} |")
    print(f"| first estimate | {' | '.join(f'{found.first_estimate_m:.0f}' for found in own if found is not None)} |")
    for name in names:
        print(f"| `{name}` | {' | '.join(metres(ranges[number, name]) for number in every)} |")


if __name__ == "__main__":
    main()
