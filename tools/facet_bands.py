"""Facets seen and lit on waves that are geometry, in the vertical plane of the Sun, beside all waves as geometry.

    python tools/facet_bands.py [--winds 3 5 7 10 14] [--cuts 0.25 1 4 16] [--seas 3]

The seas of ``nested_bands.py``, their waves down to a cut as geometry and the slope variance of the others on facets with the bands of
:func:`seaglint.sea.shadowing.nested.bands_of_facets`. The share of mirroring slopes that is seen and lit, over Smith's, is to be that of
the whole sea, whatever the cut. Markdown goes to standard output: for every wind and cut the largest and the rms difference.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence

import numpy as np
from numba import njit
from scipy.fft import irfft

from nested_bands import SHORTEST, SPACING, mirroring_slope, unhidden, variance
from seaglint.base.conventions import FloatArray
from seaglint.facet.facet_sunlight import seen_and_lit
from seaglint.facet.roughness import Roughness, roughness_of
from seaglint.sea.shadowing.nested import bands_of, bands_of_facets
from seaglint.sea.shadowing.smith import smith_lambda
from seaglint.sea.slopes.cox_munk import WIND_HEIGHT, cox_munk_anisotropic
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum

WINDS = (2.0, 3.0, 5.0, 7.0, 10.0, 14.0, 20.0)
CUTS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
DEPRESSIONS = (0.5, 1.0, 2.0, 4.0, 7.0, 12.0)
SUN_ZENITHS = (60.0, 70.0, 77.0, 80.0, 85.0, 88.0)
POINTS = 2**22
BINS = 400


def geometry(wind: float, seed: int, cuts: Sequence[float]) -> list[tuple[FloatArray, FloatArray, float]]:
    """Heights [m], slopes and the slope variance left out [1], with all waves longer than each cut [m]."""
    length = POINTS * SPACING
    k = 2.0 * math.pi * np.arange(1, int(length / SHORTEST) + 1) / length
    density = ElfouhailySpectrum(wind, 0.0).omnidirectional(k)
    density *= variance(wind) / np.sum(k * k * density)
    rng = np.random.default_rng([int(10.0 * wind), seed])
    waves = 0.5 * POINTS * np.sqrt(density) * (rng.normal(size=k.size) + 1j * rng.normal(size=k.size))
    out = []
    for cut in cuts:
        kept = k * cut <= 2.0 * math.pi
        height = np.zeros(POINTS // 2 + 1, dtype=complex)
        height[1 : k.size + 1] = np.where(kept, waves, 0.0)
        slope = height.copy()
        slope[1 : k.size + 1] *= 1j * k
        out.append((irfft(height, POINTS), irfft(slope, POINTS), float(np.sum((k * k * density)[~kept]))))
    return out


@njit
def on_facets(
    share: FloatArray,
    slopes: FloatArray,
    wanted: float,
    deviation: float,
    rough: Roughness,
    view: tuple[float, float],
    sun: tuple[float, float],
) -> float:
    """Density of facets of the slope ``wanted`` that are seen and lit, on geometry seen and lit with ``share`` at ``slopes``."""
    total = 0.0
    for i in range(slopes.size):
        above = (view[0] - view[1] * slopes[i], sun[0] + sun[1] * slopes[i])
        if share[i] <= 0.0 or above[0] <= 0.0 or above[1] <= 0.0:
            continue
        d = (wanted - slopes[i]) / deviation
        seen = seen_and_lit(rough, 1.0, (d, -d), above, (view[1] * deviation, sun[1] * rough.towards_sun))
        total += share[i] * above[0] * seen * math.exp(-0.5 * d * d)
    return total / (deviation * math.sqrt(2.0 * math.pi))


def differences(wind: float, cuts: Sequence[float], seas: int) -> FloatArray:
    """Facets on waves less all waves, seen and lit over Smith's [(cuts, depressions, Suns)]; no number where few points mirror."""
    total, inner = variance(wind), slice(POINTS // 16, POINTS - POINTS // 16)
    deviation = math.sqrt(total)
    edges = np.linspace(-5.0 * deviation, 5.0 * deviation, BINS + 1)
    middles = 0.5 * (edges[1:] + edges[:-1])
    bands = bands_of(cox_munk_anisotropic(wind, 0.0, height=WIND_HEIGHT).mss)
    whole, parts = np.zeros((len(DEPRESSIONS), len(SUN_ZENITHS), 2)), np.zeros((len(cuts), len(DEPRESSIONS), len(SUN_ZENITHS)))
    for seed in range(seas):
        for c, (height, slope, left) in enumerate(geometry(wind, seed, [0.0, *cuts])):
            facets = SlopeStatistics(left, left)
            rough = roughness_of(facets, 0.0, bands_of_facets(left / total, bands))
            seen = [unhidden(height, math.tan(math.radians(d)))[inner] for d in DEPRESSIONS]
            lit = [unhidden(height[::-1], 1.0 / math.tan(math.radians(z)))[::-1][inner] for z in SUN_ZENITHS]
            place = np.clip(((slope[inner] - edges[0]) / (edges[1] - edges[0])).astype(np.int64), 0, BINS - 1)
            for i, d in enumerate(np.radians(DEPRESSIONS)):
                for j, z in enumerate(np.radians(SUN_ZENITHS)):
                    wanted, both = mirroring_slope(d, z), seen[i] & lit[j]
                    if c == 0:
                        at = np.abs(slope[inner] - wanted) < (0.06 if abs(wanted) < 3.0 * deviation else 0.15) * deviation
                        whole[i, j] += at.sum(), (at & both).sum()
                        continue
                    share = np.bincount(place[both], minlength=BINS) / both.size
                    density = math.exp(-0.5 * wanted * wanted / total) / math.sqrt(2.0 * math.pi * total)
                    found = on_facets(
                        share, middles, wanted, math.sqrt(left), rough, (math.sin(d), math.cos(d)), (math.cos(z), math.sin(z))
                    )
                    parts[c - 1, i, j] += found / density / seas
    smith = 1.0 + sum(
        smith_lambda(np.abs(t) / (deviation * math.sqrt(2.0)))
        for t in (np.tan(np.radians(DEPRESSIONS))[:, None], 1.0 / np.tan(np.radians(SUN_ZENITHS)))
    )
    return np.asarray(smith * (parts - np.where(whole[..., 0] > 300, whole[..., 1] / np.maximum(whole[..., 0], 1.0), np.nan)))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--winds", type=float, nargs="+", default=WINDS, help="wind speeds [m/s]")
    parser.add_argument("--cuts", type=float, nargs="+", default=CUTS, help="shortest waves that are geometry [m]")
    parser.add_argument("--seas", type=int, default=3, help="independent seas per wind")
    options = parser.parse_args()
    heads = [f"{'waves to ' if cut == options.cuts[0] else ''}{cut:g} m" for cut in options.cuts]
    print("| wind | " + " | ".join(heads) + " |\n| " + " | ".join(["---"] * (len(heads) + 1)) + " |")
    for wind in options.winds:
        off = differences(wind, options.cuts, options.seas)
        cells = [f"{np.nanmax(np.abs(part)):.3f}, {np.sqrt(np.nanmean(part**2)):.3f}" for part in off]
        print(f"| {wind:g} m/s | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
