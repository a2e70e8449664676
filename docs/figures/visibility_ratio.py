"""How often mirroring slopes are seen near the horizon, over Saunders' law: by rays, on seas whose waves are geometry down to 10 cm.

    python docs/figures/visibility_ratio.py [--seas N] [--rays N]

The surface of k^-4 density is isotropic and Gaussian from 256 m to 5 cm waves, with a slope variance of 0.0542; the Elfouhaily sea is a
fully developed one of 10 m/s that runs towards the sensor. Waves below 10 cm lie on the facets: 8 % of the slope variance, 14 % of
Elfouhaily's. Markdown goes to standard output.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ray_marcher import facets_of, sea_of, seen_over_model
from seaglint.base.conventions import FloatArray
from seaglint.facet.legs import FacetLaw
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import plan_tiles
from seaglint.sea.wave_field import WaveField

DEPRESSIONS = (1.0, 2.0, 3.0, 4.0, 6.0, 10.0, 15.0)
SUN_ZENITHS = (60.0, 77.0, 80.0, 85.0)
SLOPE_VARIANCE = 0.0542
SHORTEST, LONGEST = 0.05, 256.0
RESOLVED = 0.1
"""Shortest wave that is geometry [m]; shorter ones lie on the facets, for rays to find slopes that mirror."""

FLAT_EARTH = 1e12
"""Radius of a sphere [m] that is flat over the few kilometres of a ray."""


@dataclass(frozen=True)
class PowerLawSpectrum(DirectionalSpectrum):
    """Isotropic elevation density ``C k^-4`` between two wavelengths: equal slope variance in every octave."""

    slope_variance: float = SLOPE_VARIANCE
    longest: float = LONGEST
    shortest: float = SHORTEST
    wind_to_azimuth: float = 0.0

    @property
    def wavenumber_range(self) -> tuple[float, float]:
        """From the longest to the shortest wave."""
        return 2.0 * math.pi / self.longest, 2.0 * math.pi / self.shortest

    @property
    def peak_wavenumber(self) -> float:
        """The longest wave's."""
        return self.wavenumber_range[0]

    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """``S = s k^-3``, so that ``int k^2 S dk`` over the range is the slope variance [m3]."""
        k = np.asarray(wavenumber, dtype=np.float64)
        low, high = self.wavenumber_range
        inside = (k >= low * (1.0 - 1e-12)) & (k <= high * (1.0 + 1e-12))
        return np.where(inside, self.slope_variance / math.log(high / low) / np.maximum(k, low) ** 3, 0.0)

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """The same in all directions [1/rad]."""
        return np.full(np.broadcast(np.asarray(wavenumber), np.asarray(azimuth)).shape, 0.5 / math.pi)

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """None."""
        return np.zeros(np.shape(wavenumber))


def power_law_sea(points: int = 256, tiles: int = 4, shortest: float = RESOLVED) -> tuple[WaveField, SlopeStatistics]:
    """Tiles of the k^-4 surface down to a shortest wave, and the slopes of the whole one."""
    spectrum = PowerLawSpectrum()
    return WaveField.create(spectrum, plan_tiles(spectrum, shortest, points, tiles), 0), SlopeStatistics(
        0.5 * SLOPE_VARIANCE, 0.5 * SLOPE_VARIANCE
    )


def elfouhaily_sea(wind: float = 10.0, points: int = 256, tiles: int = 4, shortest: float = RESOLVED) -> tuple[WaveField, SlopeStatistics]:
    """Tiles of a fully developed sea, and the slopes of its own spectrum from the same shortest wave of 5 cm up."""
    spectrum = ElfouhailySpectrum(wind, math.pi)
    up, cross = spectrum.mss(2.0 * math.pi / SHORTEST)
    return WaveField.create(spectrum, plan_tiles(spectrum, shortest, points, tiles), 0), SlopeStatistics(
        up, cross, wind_to_azimuth=spectrum.wind_to_azimuth
    )


def ratios(
    waves: WaveField,
    slopes: SlopeStatistics,
    depression_deg: float,
    sun_zeniths_deg: Sequence[float] = SUN_ZENITHS,
    *,
    seas: int = 8,
    rays: int = 2000,
    nested_bands: int = 1,
) -> tuple[FloatArray, FloatArray]:
    """Ratio seen/model and its standard error per Sun [1], from independent seas, looking north into the Sun.

    ``nested_bands`` is for facets that carry much of the slopes; where waves are resolved to 10 cm they carry little.
    """
    up, cross = waves.resolved_mss()
    rest = SlopeStatistics(slopes.mss_up - up, slopes.mss_cross - cross, wind_to_azimuth=waves.spectrum.wind_to_azimuth)
    facets, means = facets_of(rest.covariance(), FacetLaw(nested_bands, 0.0)), []
    suns = np.radians(np.asarray(sun_zeniths_deg, dtype=np.float64))
    for seed in range(seas):
        sea = sea_of(waves.reseeded(seed), part=0.25, radius=FLAT_EARTH)
        places = np.random.default_rng(seed).uniform(0.0, 2e4, (rays, 2))
        found = seen_over_model(sea, facets, slopes.covariance(), math.radians(depression_deg), 0.0, suns, places)
        means.append(found.mean(axis=0))
    samples = np.stack(means)
    return samples.mean(axis=0), samples.std(axis=0, ddof=1) / math.sqrt(seas)


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seas", type=int, default=40, help="independent seas for each depression")
    parser.add_argument("--rays", type=int, default=4000, help="rays over each")
    options = parser.parse_args()
    for name, (waves, slopes) in {"k^-4": power_law_sea(), "Elfouhaily, 10 m/s": elfouhaily_sea()}.items():
        print(f"| {name}: depression | " + " | ".join(f"Sun {zenith:g}°" for zenith in SUN_ZENITHS) + " |")
        print("|---" * (len(SUN_ZENITHS) + 1) + "|")
        for depression in DEPRESSIONS:
            mean, error = ratios(waves, slopes, depression, seas=options.seas, rays=options.rays)
            print(f"| {depression:g}° | " + " | ".join(f"{m:.3f} ± {e:.3f}" for m, e in zip(mean, error, strict=True)) + " |", flush=True)


if __name__ == "__main__":
    main()
