"""Facets that mirror the Sun and are seen and lit: exact sampling of Gaussian seas, beside the law of hiding.

    python docs/figures/hidden_facets.py --low-sun [--winds 2 3 5 7 12 18]
    python docs/figures/hidden_facets.py --oblique [--winds 3 6 12]
    python docs/figures/hidden_facets.py --scenario [--winds 3 6 12]
    python docs/figures/hidden_facets.py --facets  [--winds 2 3 5 7 12]

The heights of a Gaussian sea at points towards the viewer and towards the Sun, and the slope where both lines begin, are jointly Gaussian.
Given the slope that mirrors the Sun the heights are drawn from their own distribution: mean ``B s`` and a covariance that is known without
drawing a sea. A facet is seen where none of them stands above the line of sight, and lit where none stands above the Sun's ray. No law of
hiding takes part. The sea has the shape of Elfouhaily's spectrum with waves down to 1 cm and Cox and Munk's total slope variance, as that
of ``low_sun.csv``, whose rows it meets within 5 %.

The points stand at distances that grow by :data:`STEP`. What stands between them leaves too many facets: a share P comes out too large by
``-0.6 ln(STEP) ln P`` of itself (from steps of 4, 2 and 1 %), 5 % at 0.02, which is taken off. Where fewer than :data:`FEWEST` facets are
left no number is told.

Markdown goes to standard output: the law's share over that of brute force. ``--low-sun``: isotropic slopes, the Sun ahead, with the share
of brute force over Smith's behind it. ``--oblique``: wind beside the Sun's azimuth, the view beside it too, with and without the lean of
facets (:mod:`seaglint.sea.shadowing.facet_lean`). ``--scenario``: the same over the sea of a scenario, Elfouhaily's waves down to where
they have most of Cox and Munk's slopes and ripples that make up the rest. ``--facets``: waves down to a cut as geometry and the renderer's
facets on them, a dash where no waves are so long.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.facet.facet_sunlight import seen_and_lit
from seaglint.facet.glint import glint
from seaglint.facet.legs import NESTED, VIEWER, Shadowing
from seaglint.facet.roughness import Roughness, roughness_of
from seaglint.sea.shadowing.smith import smith_lambda
from seaglint.sea.slopes.cox_munk import cox_munk_anisotropic
from seaglint.sea.slopes.from_spectrum import nested_in
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.spectra.elfouhaily import ElfouhailySpectrum
from seaglint.sea.tiles import resolve_limit

SHORTEST = 0.01
STEP = 1.02
THINNED = 0.6
FEWEST = 100
RARE = 3.5
"""Deviations of a mirroring slope beyond which the sea has next to no such facets."""

UPRIGHT = replace(NESTED, lean=False)
"""The law without the lean of facets."""

DEPRESSIONS = (0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0)
ELEVATIONS = (1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 30.0)
CUTS = (0.25, 1.0, 3.0, 10.0, 30.0)


class GaussianWaves(NamedTuple):
    """Waves of random phase: variance of each one's height [m2] and its wavenumbers east and north [rad/m]."""

    variance: FloatArray
    east: FloatArray
    north: FloatArray

    def covariance(self) -> FloatArray:
        """Covariance of the slopes east and north [1, (2, 2)]."""
        k = np.stack([self.east, self.north])
        return np.asarray((self.variance * k) @ k.T)

    def longer_than(self, length: float) -> GaussianWaves:
        """The waves longer than ``length`` [m]."""
        return GaussianWaves(*(part[np.hypot(self.east, self.north) * length < 2.0 * math.pi] for part in self))

    def slopes(self) -> SlopeStatistics:
        """Slopes of all the waves with the covariances of the longer ones; the wind is to blow to the north."""
        order = np.argsort(np.hypot(self.east, self.north))
        parts = self.variance * np.stack([self.north**2, self.east**2, self.east * self.north])
        grown = np.vstack([np.hypot(self.east, self.north)[order], np.cumsum(parts[:, order], axis=1)]).T[::-200][::-1]
        grown[0, 1:] = 0.0
        (cross, _), (_, up) = self.covariance()
        return SlopeStatistics(up, cross, 0.0, nesting=tuple((float(k), float(a), float(b), float(c)) for k, a, b, c in grown))


def random_waves(
    spectrum: DirectionalSpectrum, total: float, *, isotropic: bool = False, sizes: tuple[int, int] = (360, 48), seed: int = 0
) -> GaussianWaves:
    """Waves down to 1 cm of a spectrum whose wind blows to the north, scaled to a ``total`` slope variance [1]; ``sizes`` of the draw."""
    rng = np.random.default_rng(seed)
    edges = np.geomspace(spectrum.wavenumber_range[0], 2.0 * math.pi / SHORTEST, sizes[0] + 1)
    step = math.log(edges[1] / edges[0])
    k = edges[:-1, None] * np.exp(step * rng.random(sizes))
    angle = (np.arange(sizes[1]) + rng.random(sizes)) * math.pi / sizes[1]  # half a circle: a still sea has no more
    variance = spectrum.omnidirectional(k) * k * step / sizes[1]
    if not isotropic:
        variance = variance * math.pi * (spectrum.spreading(k, angle) + spectrum.spreading(k, angle + math.pi))
    return GaussianWaves((variance * total / np.sum(variance * k * k)).ravel(), (k * np.sin(angle)).ravel(), (k * np.cos(angle)).ravel())


def clean_sea(wind: float, *, isotropic: bool = True, sizes: tuple[int, int] = (360, 48)) -> GaussianWaves:
    """Waves of a clean sea, Cox and Munk's total slope variance for isotropic and directional ones alike."""
    return random_waves(ElfouhailySpectrum(wind, 0.0), 0.003 + 0.00512 * wind, isotropic=isotropic, sizes=sizes)


def scenario_sea(wind: float, *, sizes: tuple[int, int] = (360, 48)) -> tuple[GaussianWaves, SlopeStatistics]:
    """Elfouhaily's waves down to where resolved waves end, below them ripples to Cox and Munk's covariance; and their slopes in scenarios.

    Ripples have the directions ``1 + 2 a cos 2 phi`` that make up what the longer waves leave, and Elfouhaily's shares of all lengths.
    """
    spectrum, slopes = ElfouhailySpectrum(wind, 0.0), cox_munk_anisotropic(wind, 0.0)
    waves, around = (random_waves(spectrum, sum(spectrum.mss()), isotropic=even, sizes=sizes) for even in (False, True))
    long = np.hypot(waves.east, waves.north) < resolve_limit(spectrum, slopes)
    left = np.array([slopes.mss_up, slopes.mss_cross]) - np.where(long, waves.variance, 0.0) @ np.stack(
        [waves.north**2, waves.east**2], axis=1
    )
    apart = (left[0] - left[1]) / left.sum() * np.cos(2.0 * np.arctan2(waves.east, waves.north))
    ripples = np.where(long, 0.0, around.variance * np.maximum(1.0 + 2.0 * apart, 0.0))
    ripples *= left.sum() / np.sum(ripples * (waves.east**2 + waves.north**2))
    return waves._replace(variance=np.where(long, waves.variance, ripples)), nested_in(slopes, spectrum)


@dataclass(frozen=True)
class TwoLines:
    """Heights along two lines from a place, given the slope there.

    Attributes
    ----------
    root : ndarray
        Root of the conditional covariance [m, (points, modes)]; the points of the first line, then those of the second.
    mean : ndarray
        Mean height per slope east and north [m, (points, 2)].
    distance : ndarray
        Distance of the points of either line [m].
    """

    root: NDArray[np.float32]
    mean: FloatArray
    distance: FloatArray

    def draw(self, count: int, rng: np.random.Generator) -> NDArray[np.float32]:
        """Draw heights about their means [m, (points, count)]."""
        return np.asarray(self.root @ rng.standard_normal((self.root.shape[1], count), dtype=np.float32))

    def unhidden(self, heights: NDArray[np.float32], slope: FloatArray, elevations: tuple[float, float]) -> NDArray[np.bool_]:
        """Places [(2, count)] that no height hides from either line's ``elevations`` [rad], of one slope or a slope each [(2[, count])]."""
        mean = (self.mean @ slope).reshape(heights.shape[0], -1)
        found = []
        for line, elevation in enumerate(elevations):
            at = slice(line * self.distance.size, (line + 1) * self.distance.size)
            free = (self.distance[:, None] * math.tan(elevation) - mean[at]).astype(np.float32)
            found.append(np.all(heights[at] <= free, axis=0))
        return np.stack(found)


def two_lines(waves: GaussianWaves, azimuths: tuple[float, float], lowest: float, *, step: float = STEP, nearest: float = 1e-3) -> TwoLines:
    """Lines towards two azimuths [rad], as far as waves can stand above a ray of the ``lowest`` elevation [rad]."""
    farthest = 10.0 * math.sqrt(float(waves.variance.sum())) / math.tan(lowest)
    distance = nearest * step ** np.arange(int(math.log(farthest / nearest) / math.log(step)) + 1)
    places = np.concatenate([distance[:, None] * np.array([math.sin(a), math.cos(a)]) for a in azimuths])
    both, with_slope = np.zeros((len(places), len(places))), np.zeros((len(places), 2))
    for first in range(0, waves.variance.size, 4096):
        part = GaussianWaves(*(values[first : first + 4096] for values in waves))
        size, phase = np.sqrt(part.variance), places @ np.stack([part.east, part.north])
        # heights over that of the origin, and the slope there, by cosines and sines of each wave
        cosines, sines = (np.cos(phase) - 1.0) * size, np.sin(phase) * size
        both += cosines @ cosines.T + sines @ sines.T
        with_slope += sines @ np.stack([part.east * size, part.north * size], axis=1)
    mean = np.linalg.solve(waves.covariance(), with_slope.T).T
    left = both - mean @ with_slope.T
    deviation = np.sqrt(np.maximum(np.diag(left), 1e-30))
    values, vectors = np.linalg.eigh(left / deviation[:, None] / deviation)
    kept = values > 1e-9
    root = vectors[:, kept] * np.sqrt(values[kept]) * deviation[:, None]
    return TwoLines(root.astype(np.float32), mean, distance)


class SunLook(NamedTuple):
    """Elevations and azimuths of the directions to viewer and Sun [rad]."""

    depression: float
    elevation: float
    azimuth: float = 0.0
    solar_azimuth: float = math.pi

    def mirroring(self) -> FloatArray:
        """Slope east and north that mirrors the Sun to the viewer [1]."""
        both = np.zeros(3)
        for up, azimuth in ((self.depression, self.azimuth), (self.elevation, self.solar_azimuth)):
            both += math.cos(up) * math.sin(azimuth), math.cos(up) * math.cos(azimuth), math.sin(up)
        return np.asarray(-both[:2] / both[2])


def in_plane(depressions: Iterable[float] = DEPRESSIONS, elevations: Iterable[float] = ELEVATIONS) -> list[SunLook]:
    """Looks into the Sun's azimuth, angles in degrees."""
    suns = list(elevations)
    return [SunLook(math.radians(d), math.radians(e)) for d in depressions for e in suns]


def sampled(lines: TwoLines, looks: Sequence[SunLook], draws: int, *, seed: int = 1) -> tuple[FloatArray, FloatArray]:
    """Shares of mirroring facets seen, and seen and lit, and their standard errors [1, (looks, 2)]; looks along the lines' azimuths."""
    rng, count = np.random.default_rng(seed), 10_000
    hits, batches = np.zeros((len(looks), 2)), max(draws // count, 1)
    for _ in range(batches):
        heights = lines.draw(count, rng)
        for i, look in enumerate(looks):
            seen, lit = lines.unhidden(heights, look.mirroring(), (look.depression, look.elevation))
            hits[i] += seen.sum(), (seen & lit).sum()
    shares = hits / (count * batches)
    return shares ** (1.0 + THINNED * math.log(lines.distance[1] / lines.distance[0])), np.sqrt(np.maximum(hits, 1.0)) / (count * batches)


def of_law(look: SunLook, slopes: SlopeStatistics, shadowing: Shadowing = NESTED) -> float:
    """Share of the mirroring facets that is seen, or seen and lit, by the mean model [1]."""
    view, sun = 0.5 * math.pi - look.depression, 0.5 * math.pi - look.elevation
    chance, all_seen = (
        float(glint(view, look.azimuth, sun, look.solar_azimuth, slopes, law).chance) for law in (shadowing, replace(VIEWER, law="smith"))
    )
    deviation = math.sqrt(2.0 * float(slopes.mss_along(look.azimuth)))
    # Saunders' law shows 1/(1 + Lambda) of them
    return chance / all_seen / (1.0 + float(smith_lambda(math.tan(look.depression) / deviation)))


def of_smith(look: SunLook, slopes: SlopeStatistics) -> float:
    """Share that is seen and lit by Smith's law, the Sun ahead [1]."""
    legs = ((look.depression, look.azimuth), (look.elevation, look.solar_azimuth))
    return 1.0 / (1.0 + sum(float(smith_lambda(math.tan(up) / math.sqrt(2.0 * float(slopes.mss_along(a))))) for up, a in legs))


@njit
def _projected(shown: NDArray[np.bool_], slopes: FloatArray, wanted: float, deviation: float, rough: Roughness, legs: FloatArray) -> float:
    """Mean share of facets of the slope ``wanted`` on geometry of the ``slopes``; ``legs``: sine and cosine of both elevations."""
    total = 0.0
    for i in range(slopes.size):
        view, sun = legs[0, 0] - legs[0, 1] * slopes[i], legs[1, 0] + legs[1, 1] * slopes[i]
        if shown[i] and view > 0.0 and sun > 0.0:
            d = (wanted - slopes[i]) / deviation
            sunward = -d * deviation / max(rough.towards_sun, 1e-12)
            total += view * seen_and_lit(rough, 1.0, (d, sunward), (view, sun), (legs[0, 1] * deviation, legs[1, 1] * rough.towards_sun))
    return total / slopes.size


def on_geometry(sea: GaussianWaves, cut: float, looks: Sequence[SunLook], draws: int, *, seed: int = 3) -> FloatArray:
    """Shares seen and lit of the renderer's facets on waves longer than ``cut`` [m] as geometry, isotropic, in the Sun's plane [1].

    The slope of geometry under a facet that mirrors is Gaussian, given the mirroring slope; whether other geometry hides it is sampled.
    """
    waves, total = sea.longer_than(cut), 0.5 * float(np.trace(sea.covariance()))
    resolved = 0.5 * float(np.trace(waves.covariance()))
    facets, whole = SlopeStatistics(total - resolved, total - resolved), SlopeStatistics(total, total)
    deviation = math.sqrt(total - resolved)
    rough = roughness_of(facets, math.pi, NESTED.facet_law(whole, facets))
    lowest = min(min(look.depression, look.elevation) for look in looks)
    lines = two_lines(waves, (0.0, math.pi), lowest, nearest=min(0.01, 0.01 * cut))
    rng, count, found = np.random.default_rng(seed), 10_000, np.zeros(len(looks))
    share, spread = resolved / total, math.sqrt(resolved * (total - resolved) / total)
    batches = max(draws // count, 1)
    for _ in range(batches):
        heights, normal = lines.draw(count, rng), rng.standard_normal((2, count))
        for i, look in enumerate(looks):
            wanted = look.mirroring()
            slopes = share * wanted[:, None] + spread * normal
            shown = lines.unhidden(heights, slopes, (look.depression, look.elevation)).all(axis=0)
            legs = np.array([(math.sin(up), math.cos(up)) for up in (look.depression, look.elevation)])
            found[i] += _projected(shown, slopes[1], float(wanted[1]), deviation, rough, legs) / batches
    return found


def low_sun(wind: float, draws: int) -> Iterator[str]:
    """Rows of views, columns of Suns: law over brute force, and in brackets brute force over Smith's law."""
    sea, looks = clean_sea(wind), in_plane()
    total = float(np.trace(sea.covariance()))
    slopes = SlopeStatistics(0.5 * total, 0.5 * total)
    found, error = sampled(two_lines(sea, (0.0, math.pi), math.radians(min(DEPRESSIONS))), looks, draws)
    yield "| view | " + " | ".join(f"{'Sun ' if e == ELEVATIONS[0] else ''}{e:g}°" for e in ELEVATIONS) + " |"
    yield "|---" * (len(ELEVATIONS) + 1) + "|"
    cells = [
        f"{of_law(look, slopes) / both:.2f} ({both / of_smith(look, slopes):.3f})" if both > off * math.sqrt(FEWEST) else "—"
        for look, (_, both), (_, off) in zip(looks, found, error, strict=True)
    ]
    for i, depression in enumerate(DEPRESSIONS):
        yield f"| {wind:g} m/s, {depression:g}° | " + " | ".join(cells[i * len(ELEVATIONS) : (i + 1) * len(ELEVATIONS)]) + " |"


def oblique_looks(beside: float, off: float, depressions: Sequence[float], elevations: Sequence[float]) -> list[SunLook]:
    """Looks ``off`` degrees beside the Sun's azimuth, the wind blowing ``beside`` degrees off that line, which is azimuth 0 here."""
    wind = math.radians(beside)
    pairs = [(math.radians(d), math.radians(e)) for d in depressions for e in elevations]
    return [SunLook(d, e, math.radians(off) - wind, math.pi - wind) for d, e in pairs]


def frequent(looks: Iterable[SunLook], sea: GaussianWaves) -> list[SunLook]:
    """Those whose mirroring slope is within :data:`RARE` deviations."""
    inverse = np.linalg.inv(sea.covariance())
    return [look for look in looks if look.mirroring() @ inverse @ look.mirroring() < RARE**2]


def oblique(wind: float, draws: int) -> Iterator[str]:
    """Rows of winds and offsets: law over brute force, seen and lit, of the facets left, with the lean and without."""
    sea = clean_sea(wind, isotropic=False)
    return beside_the_wind(wind, draws, sea, sea.slopes())


def scenario(wind: float, draws: int) -> Iterator[str]:
    """Rows as :func:`oblique` over the sea of a scenario."""
    return beside_the_wind(wind, draws, *scenario_sea(wind))


def beside_the_wind(wind: float, draws: int, sea: GaussianWaves, slopes: SlopeStatistics) -> Iterator[str]:
    """Rows of one wind; ``slopes`` as the law has them."""
    yield "| wind, angle to the Sun | view off the Sun | largest, rms difference | without lean |\n|---|---|---|---|"
    for beside in (30.0, 50.0, 90.0):
        for off in (-10.0, -5.0, 0.0, 5.0, 10.0):
            looks = frequent(oblique_looks(beside, off, (1.0, 3.0, 7.0, 15.0), (5.0, 10.0, 15.0, 30.0)), sea)
            found, error = sampled(
                two_lines(sea, (math.radians(off - beside), math.radians(180.0 - beside)), math.radians(1.0), step=1.03), looks, draws
            )
            kept = found[:, 1] > error[:, 1] * math.sqrt(4.0 * FEWEST)
            pair = []
            for law in (NESTED, UPRIGHT):
                ratio = np.array([of_law(look, slopes, law) for look in looks])[kept] / found[kept, 1] - 1.0
                pair.append(f"{ratio[np.argmax(np.abs(ratio))]:+.2f}, {np.sqrt(np.mean(ratio**2)):.3f}")
            yield f"| {wind:g} m/s, {beside:g}° | {off:+g}° | {pair[0]} | {pair[1]} |"


def facets(wind: float, draws: int) -> Iterator[str]:
    """Rows of winds, columns of cuts: largest and rms difference of facets on geometry from brute force."""
    sea, looks = clean_sea(wind), in_plane((0.5, 1.0, 3.0, 7.0), (1.0, 2.0, 5.0, 10.0, 15.0))
    found, error = sampled(two_lines(sea, (0.0, math.pi), math.radians(0.5)), looks, draws)
    kept = found[:, 1] > error[:, 1] * math.sqrt(FEWEST)
    cells = []
    for cut in CUTS:
        if np.trace(sea.longer_than(cut).covariance()) < 1e-3 * np.trace(sea.covariance()):
            cells.append("—")
            continue
        ratio = on_geometry(sea, cut, [look for look, keep in zip(looks, kept, strict=True) if keep], draws // 4) / found[kept, 1] - 1.0
        cells.append(f"{ratio[np.argmax(np.abs(ratio))]:+.2f}, {np.sqrt(np.mean(ratio**2)):.3f}")
    yield "| wind | " + " | ".join(f"{'waves to ' if cut == CUTS[0] else ''}{cut:g} m" for cut in CUTS) + " |"
    yield "|---" * (len(CUTS) + 1) + "|"
    yield f"| {wind:g} m/s | " + " | ".join(cells) + " |"


def main() -> None:
    """Print the tables that are asked for, the head of each once."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--winds", type=float, nargs="+", default=(3.0, 7.0, 12.0), help="wind speeds [m/s]")
    parser.add_argument("--draws", type=int, default=300_000, help="facets drawn for each table's row")
    for name in ("--low-sun", "--oblique", "--scenario", "--facets"):
        parser.add_argument(name, action="store_true")
    options = parser.parse_args()
    for wanted, rows in ((options.low_sun, low_sun), (options.oblique, oblique), (options.scenario, scenario), (options.facets, facets)):
        head = ""
        for wind in options.winds if wanted else ():
            lines = "\n".join(rows(wind, options.draws)).split("\n")
            print("\n".join(lines if not head else lines[2:]), flush=True)
            head = lines[0]
        if wanted:
            print()


if __name__ == "__main__":
    main()
