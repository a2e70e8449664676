"""Shares of a sea that are seen, and seen and lit, by brute force in the vertical plane of the Sun, beside the law of nested bands.

    python docs/figures/nested_bands.py [--winds 2 3.5 5 7 10 14 20] [--seas 3] [--csv FILE]

A Gaussian surface with the shape of Elfouhaily's spectrum down to 1 cm, scaled to Cox and Munk's upwind slope variance, 10 km in 2^23
points. Among its points that mirror the Sun those count that no other point hides from the viewer, and from the Sun. Both shares are told
over Smith's, with standard errors from the scatter of the seas: another route than that of ``hidden_facets.py``.
Markdown goes to standard output: the largest relative differences of the law by wind and Sun.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft

from seaglint.base.conventions import FloatArray
from seaglint.facet.glint import glint
from seaglint.facet.legs import BOTH, NESTED, NESTED_VIEWER, VIEWER, Shadowing
from seaglint.sea.shadowing.smith import smith_lambda
from seaglint.sea.slopes.cox_munk import WIND_HEIGHT, cox_munk_anisotropic
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum

WINDS = (2.0, 3.5, 5.0, 7.0, 10.0, 14.0, 20.0)
DEPRESSIONS = (0.5, 1.0, 2.0, 4.0, 7.0, 12.0)
SUN_ZENITHS = (30.0, 60.0, 70.0, 77.0, 80.0, 85.0, 88.0)
SHORTEST = 0.01
SPACING = 0.0012
POINTS = 2**23
FEWEST = 200
"""Mirroring points below which a share is not told."""


@dataclass(frozen=True)
class Shares:
    """Shares of the mirroring points over Smith's, with standard errors [1]."""

    wind_speed_m_s: float
    depression_deg: float
    solar_zenith_deg: float
    seen_over_smith: float
    error_seen: float
    seen_and_lit_over_smith: float
    error_both: float


def profile(wind: float, seed: int, points: int = POINTS) -> tuple[FloatArray, FloatArray]:
    """Heights [m] and slopes [1] of one sea along a line towards the viewer, periodic."""
    length = points * SPACING
    k = 2.0 * math.pi * np.arange(1, int(length / SHORTEST) + 1) / length
    density = ElfouhailySpectrum(wind, 0.0).omnidirectional(k)
    density *= variance(wind) / np.sum(k * k * density)
    rng = np.random.default_rng([int(10.0 * wind), seed])
    height = np.zeros(points // 2 + 1, dtype=complex)
    height[1 : k.size + 1] = 0.5 * points * np.sqrt(density) * (rng.normal(size=k.size) + 1j * rng.normal(size=k.size))
    slope = height.copy()
    slope[1 : k.size + 1] *= 1j * k
    return irfft(height, points), irfft(slope, points)


def variance(wind: float) -> float:
    """Slope variance along the line [1]: Cox and Munk's upwind one, with the wind as it is."""
    return cox_munk_anisotropic(wind, 0.0, height=WIND_HEIGHT).mss_up


def unhidden(height: FloatArray, tangent: float) -> NDArray[np.bool_]:
    """Points from which a ray that climbs by ``tangent`` towards larger indices meets no other point."""
    level = height - tangent * SPACING * np.arange(height.size)
    return np.asarray(level >= np.maximum.accumulate(level[::-1])[::-1])


def mirroring_slope(depression: float, zenith: float) -> float:
    """Slope towards the viewer that mirrors a Sun ahead [1], angles in rad."""
    return (math.sin(zenith) - math.cos(depression)) / (math.sin(depression) + math.cos(zenith))


def counts(wind: float, seed: int, depressions: Sequence[float], suns: Sequence[float], points: int = POINTS) -> NDArray[np.int64]:
    """Points of one sea that mirror, are seen, and are seen and lit [(depressions, Suns, 3)]."""
    height, slope = profile(wind, seed, points)
    slope /= math.sqrt(variance(wind))
    seen = [unhidden(height, math.tan(math.radians(d))) for d in depressions]
    lit = [unhidden(height[::-1], 1.0 / math.tan(math.radians(z)))[::-1] for z in suns]
    found = np.zeros((len(depressions), len(suns), 3), dtype=np.int64)
    for i, depression in enumerate(depressions):
        for j, zenith in enumerate(suns):
            wanted = mirroring_slope(math.radians(depression), math.radians(zenith)) / math.sqrt(variance(wind))
            at = np.flatnonzero(np.abs(slope - wanted) < (0.06 if abs(wanted) < 3.0 else 0.15))
            at = at[(at > points // 16) & (at < points - points // 16)]  # the line ends: what would hide these is not there
            found[i, j] = at.size, np.count_nonzero(seen[i][at]), np.count_nonzero(seen[i][at] & lit[j][at])
    return found


def shares(
    wind: float, seas: int, depressions: Sequence[float] = DEPRESSIONS, suns: Sequence[float] = SUN_ZENITHS, points: int = POINTS
) -> Iterator[Shares]:
    """Shares for each depression and Sun that enough points mirror."""
    found = np.stack([counts(wind, seed, depressions, suns, points) for seed in range(seas)])
    deviation = math.sqrt(2.0 * variance(wind))
    for i, depression in enumerate(depressions):
        for j, zenith in enumerate(suns):
            n = found[:, i, j].astype(float)
            if n[:, 0].sum() < FEWEST:
                continue
            view, sun = (float(smith_lambda(math.tan(math.radians(e)) / deviation)) for e in (depression, 90.0 - zenith))
            ratio = n[:, 1:].sum(axis=0) / n[:, 0].sum() * np.array([1.0 + view, 1.0 + view + sun])
            each = n[:, 1:] / np.maximum(n[:, :1], 1.0) * np.array([1.0 + view, 1.0 + view + sun])
            error = each.std(axis=0, ddof=1) / math.sqrt(seas)
            yield Shares(wind, depression, zenith, float(ratio[0]), float(error[0]), float(ratio[1]), float(error[1]))


def law(wind: float, depression_deg: float, solar_zenith_deg: float) -> tuple[float, float]:
    """The mean model's shares over Smith's [1]: facets seen, and seen and lit."""
    slopes = cox_munk_anisotropic(wind, math.pi, height=WIND_HEIGHT)

    def chance(shadowing: Shadowing) -> float:
        view, sun = math.radians(90.0 - depression_deg), math.radians(solar_zenith_deg)
        return float(glint(view, math.pi, sun, 0.0, slopes, shadowing).chance)

    return chance(NESTED_VIEWER) / chance(VIEWER), chance(NESTED) / chance(BOTH)


def main() -> None:
    """Compute the shares, write them, and print what the law misses."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--winds", type=float, nargs="+", default=WINDS, help="wind speeds [m/s]")
    parser.add_argument("--seas", type=int, default=3, help="independent seas per wind, at least 2")
    parser.add_argument("--csv", type=Path, help="file to write")
    options = parser.parse_args()
    rows: list[Shares] = []
    print("| wind, m/s | Sun's zenith angle | seen: largest, rms difference | seen and lit: largest, rms difference |\n|---|---|---|---|")
    for wind in options.winds:
        found = list(shares(wind, options.seas))
        rows += found
        for zenith in SUN_ZENITHS:
            of = [r for r in found if r.solar_zenith_deg == zenith and r.error_both < 0.05 * r.seen_and_lit_over_smith]
            if not of:
                continue
            ours = np.array([law(wind, r.depression_deg, zenith) for r in of])
            off = np.abs(ours / np.array([(r.seen_over_smith, r.seen_and_lit_over_smith) for r in of]) - 1.0)
            most, rms = off.max(axis=0), np.sqrt((off**2).mean(axis=0))
            print(f"| {wind:g} | {zenith:g}° | {most[0]:.3f}, {rms[0]:.3f} | {most[1]:.3f}, {rms[1]:.3f} |")
        sys.stdout.flush()
    if options.csv is not None:
        with options.csv.open("w", newline="", encoding="utf-8") as stream:
            write = csv.writer(stream, lineterminator="\n")
            write.writerow([f.name for f in fields(Shares)])
            write.writerows([f"{v:.4g}" for v in astuple(row)] for row in rows)


if __name__ == "__main__":
    main()
