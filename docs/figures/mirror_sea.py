"""A sea of mirrors, the truth without a law of facets: all waves down to a centimetre or two are geometry, and rays alone decide.

A ray of a pixel goes to the first point of the sea that it meets, is mirrored there about the normal, and counts where it then points into
a disc about the Sun and meets no other wave on its way up. Nothing here knows slope densities or shadowing. Long waves are those that the
renderer draws; short ones, ripples, lie elsewhere under every ray, so that the mean over the rays of a pixel is the mean over all ripples
while the long waves stand: what the renderer's facets are a law of.

Heights and slopes are read bilinearly from lattices of eight points and more a wave, divided by what that reading leaves of every
wave's amplitude in the mean over places. Steps near the water are an eighth of the shortest wave; higher up they are what a ray can go
over a sea that is nowhere steeper than 4.5 deviations. The sea is round: it falls by ``r^2/2R`` along a line of sight.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
import scipy.fft
from numba import njit
from numpy.typing import ArrayLike, NDArray

from seaglint.base.constants import EARTH_RADIUS, EFFECTIVE_EARTH_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.tiles import Tile
from seaglint.sea.wave_field import WaveField

POINTS: Final = 1024
"""Points of every lattice along a side; a power of two."""

SAMPLES: Final = 8
"""Lattice points in the shortest wave of the ripples."""

SPLIT: Final = 0.22
"""Wavelength between the two tiles of ripples [m]."""

STEEP: Final = 4.5
"""Deviations of slope beyond which no place is steep."""


@dataclass(frozen=True)
class CutSpectrum(DirectionalSpectrum):
    """Another spectrum without the waves shorter than ``shortest`` [m]."""

    whole: DirectionalSpectrum
    shortest: float
    wind_to_azimuth: float

    @classmethod
    def of(cls, whole: DirectionalSpectrum, shortest: float) -> CutSpectrum:
        """Cut a spectrum."""
        return cls(whole, shortest, whole.wind_to_azimuth)

    @property
    def peak_wavenumber(self) -> float:
        """The whole spectrum's."""
        return self.whole.peak_wavenumber

    @property
    def wavenumber_range(self) -> tuple[float, float]:
        """From the whole spectrum's longest wave to the shortest that is left."""
        return self.whole.wavenumber_range[0], 2.0 * math.pi / self.shortest

    def omnidirectional(self, wavenumber: ArrayLike) -> FloatArray:
        """The whole spectrum's below the cut [m3]."""
        k = np.asarray(wavenumber, dtype=np.float64)
        return np.asarray(np.where(k <= self.wavenumber_range[1] * (1.0 + 1e-12), self.whole.omnidirectional(k), 0.0))

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """The whole spectrum's."""
        return self.whole.spreading(wavenumber, azimuth)

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """The whole spectrum's."""
        return self.whole.second_harmonic(wavenumber)


@dataclass(frozen=True)
class RoundSpectrum(CutSpectrum):
    """A cut spectrum whose waves run evenly in all directions."""

    def spreading(self, wavenumber: ArrayLike, azimuth: ArrayLike) -> FloatArray:
        """The same for all azimuths."""
        return np.full(np.broadcast_shapes(np.shape(wavenumber), np.shape(azimuth)), 0.5 / math.pi)

    def second_harmonic(self, wavenumber: ArrayLike) -> FloatArray:
        """Nothing."""
        return np.zeros(np.shape(wavenumber))


class MirrorSea(NamedTuple):
    """Lattices of an instant: long waves first, then the two tiles of ripples.

    ``height`` (tiles, n, n) [m] and ``slope`` (tiles, n, n, 2) [1]; ``grid[t] = (1/spacing, cosine and sine of the turn)``; ``crest``:
    greatest height [m] that all waves, both ripples and the shorter ones add; ``steepest`` slope of the long waves, with the longer
    ripples and with all; ``step`` near the water [m].
    """

    height: np.ndarray
    slope: np.ndarray
    grid: np.ndarray
    crest: tuple[float, float, float]
    steepest: tuple[float, float, float]
    step: float


def ripple_tiles(longest: float, shortest: float, samples: int = SAMPLES) -> tuple[Tile, Tile]:
    """Tiles of the ripples between two wavelengths [m]."""
    fine, coarse = shortest / samples * POINTS, SPLIT / SAMPLES * POINTS
    edge = 2.0 * math.pi / SPLIT
    return (
        Tile(coarse, POINTS, 0.55, 2.0 * math.pi / longest, edge),
        Tile(fine, POINTS, 1.13, edge, 2.0 * math.pi / shortest * (1.0 + 1e-9)),
    )


def lattice(waves: WaveField, which: int, time: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Height (n, n) and slopes (n, n, 2) of a tile of a field, from its plane waves alone."""
    tile, n = waves.tiles[which], POINTS
    east, north, frequency, real, imaginary = waves.plane_waves()[which].T
    c, s = math.cos(tile.rotation), math.sin(tile.rotation)
    p, q = (np.rint(k / tile.step).astype(int) for k in (c * east + s * north, c * north - s * east))
    kept = [(2.0 + np.cos(2.0 * np.pi / n * m)) / 3.0 for m in (p, q)]
    amplitude = (real + 1j * imaginary) * np.exp(-1j * frequency * time) / np.sqrt(kept[0] * kept[1])
    out = []
    for factor in (1.0, 1j * east, 1j * north):
        coefficients = np.zeros((n, n), np.complex64)
        np.add.at(coefficients, (q % n, p % n), factor * amplitude)
        out.append(scipy.fft.ifft2(coefficients, norm="forward", overwrite_x=True).real.astype(np.float32))
    return np.asarray(out[0]), np.stack(out[1:], axis=-1)


def mirror_sea(waves: WaveField, ripples: WaveField, time: float = 0.0) -> MirrorSea:
    """Sea of long waves and the two tiles of ripples of another field."""
    fields = [(waves, i) for i in range(len(waves.tiles))] + [(ripples, 0), (ripples, 1)]
    parts = [lattice(field, i, time) for field, i in fields]
    grid = [(POINTS / f.tiles[i].length, math.cos(f.tiles[i].rotation), math.sin(f.tiles[i].rotation)) for f, i in fields]
    highest = [float(z.max()) for z, _ in parts]
    variance = np.cumsum([np.linalg.eigvalsh(np.cov(s.reshape(-1, 2).T))[-1] for _, s in parts])
    crest = (sum(highest), sum(highest[-2:]), highest[-1])
    long, longer, every = (STEEP * float(np.sqrt(v)) for v in variance[-3:])
    step = 2.0 * math.pi / ripples.tiles[1].k_max / SAMPLES
    return MirrorSea(np.stack([z for z, _ in parts]), np.stack([s for _, s in parts]), np.array(grid), crest, (long, longer, every), step)


@njit(cache=True, nogil=True)
def cell_of(sea: MirrorSea, t: int, x: float, y: float, shift: np.ndarray) -> tuple[int, int, int, int, float, float]:
    """Rows and columns of the four points of a tile around a place (two rows, two columns), and the fractions of columns and rows."""
    n, ripples = sea.height.shape[1], sea.height.shape[0] - 2
    d, c, s = sea.grid[t, 0], sea.grid[t, 1], sea.grid[t, 2]
    u, v = (c * x + s * y) * d, (c * y - s * x) * d
    if t >= ripples:
        u, v = u + shift[t - ripples, 0], v + shift[t - ripples, 1]
    i, j = math.floor(u), math.floor(v)
    i0, j0 = int(i) & (n - 1), int(j) & (n - 1)
    return j0, (j0 + 1) & (n - 1), i0, (i0 + 1) & (n - 1), u - i, v - j


@njit(cache=True, nogil=True)
def raised(sea: MirrorSea, first: int, last: int, x: float, y: float, shift: np.ndarray) -> float:
    """Height [m] that tiles ``first`` to ``last`` (not included) add at a place; ``shift`` (2, 2): what ripples are displaced by [m]."""
    total = 0.0
    for t in range(first, last):
        j0, j1, i0, i1, f, g = cell_of(sea, t, x, y, shift)
        z = sea.height[t]
        low, high = z[j0, i0] + f * (z[j0, i1] - z[j0, i0]), z[j1, i0] + f * (z[j1, i1] - z[j1, i0])
        total += low + g * (high - low)
    return total


@njit(cache=True, nogil=True)
def tilted(sea: MirrorSea, x: float, y: float, shift: np.ndarray) -> tuple[float, float]:
    """Slopes of the sea towards east and north at a place."""
    east, north = 0.0, 0.0
    for t in range(sea.height.shape[0]):
        j0, j1, i0, i1, f, g = cell_of(sea, t, x, y, shift)
        for a, b, w in ((j0, i0, (1 - g) * (1 - f)), (j0, i1, (1 - g) * f), (j1, i0, g * (1 - f)), (j1, i1, g * f)):
            east += w * sea.slope[t, a, b, 0]
            north += w * sea.slope[t, a, b, 1]
    return east, north


@njit(cache=True, nogil=True)
def meets(
    sea: MirrorSea, start: tuple[float, float, float], direction: tuple[float, float, float], radius: float, shift: np.ndarray
) -> tuple[float, float]:
    """Horizontal distances along a ray just before and behind the first water it meets [m]; -1 where it leaves above all crests.

    ``direction``: horizontal unit vector and rise per metre; the ray rises by ``r^2/(2 radius)`` beside.
    """
    x, y, z = start
    east, north, rise = direction
    tiles, fine = sea.height.shape[0], sea.step
    before, r = 0.0, 0.0
    while r < 1e5:
        at = z + r * (rise + 0.5 * r / radius)
        slope = rise + r / radius
        if at > sea.crest[0]:
            if slope >= 0.0:
                return -1.0, -1.0
            before = r
            r += (at - sea.crest[0]) / -slope + fine
            continue
        fall = max(-slope, 0.0)
        px, py = x + r * east, y + r * north
        clear = at - raised(sea, 0, tiles - 2, px, py, shift)
        if clear > sea.crest[1]:
            step = (clear - sea.crest[1]) / (sea.steepest[0] + fall)
        else:
            clear -= raised(sea, tiles - 2, tiles - 1, px, py, shift)
            if clear > sea.crest[2]:
                step = (clear - sea.crest[2]) / (sea.steepest[1] + fall)
            else:
                clear -= raised(sea, tiles - 1, tiles, px, py, shift)
                if clear < 0.0:
                    break
                step = clear / (sea.steepest[2] + fall)
        before = r
        r += max(step, fine)
    else:
        return -1.0, -1.0
    behind = r
    while behind - before > 1e-5:
        middle = 0.5 * (before + behind)
        at = z + middle * (rise + 0.5 * middle / radius)
        if at < raised(sea, 0, tiles, x + middle * east, y + middle * north, shift):
            behind = middle
        else:
            before = middle
    return before, behind


@njit(cache=True, nogil=True)
def _trace(
    sea: MirrorSea, place: np.ndarray, edges: np.ndarray, suns: np.ndarray, reflected: np.ndarray, draws: np.ndarray, out: np.ndarray
) -> None:
    """Add to ``out`` (rows, columns, 2, suns, 2); ``draws`` (rows, columns, rays, 6) in 0-1: place in the pixel and shifts of ripples.

    ``place``: east, north, height; ``edges``: azimuth of the left, column step, elevation of the top, row step.
    """
    rows, columns, rays = draws.shape[:3]
    n = sea.height.shape[1]
    shift = np.empty((2, 2))
    for row in range(rows):
        for column in range(columns):
            for k in range(rays):
                draw = draws[row, column, k]
                azimuth, elevation = edges[0] + (column + draw[0]) * edges[1], edges[2] - (row + draw[1]) * edges[3]
                shift[0, 0], shift[0, 1], shift[1, 0], shift[1, 1] = n * draw[2], n * draw[3], n * draw[4], n * draw[5]
                e, o = math.sin(azimuth), math.cos(azimuth)
                rise = math.tan(elevation)
                r, _ = meets(sea, (place[0], place[1], place[2]), (e, o, rise), EFFECTIVE_EARTH_RADIUS, shift)
                if r < 0.0:
                    continue
                x, y = place[0] + r * e, place[1] + r * o
                z = place[2] + r * (rise + 0.5 * r / EFFECTIVE_EARTH_RADIUS)
                se, so = tilted(sea, x, y, shift)
                # the line of sight against the vertical of the place
                here = rise + r / EFFECTIVE_EARTH_RADIUS
                per = 1.0 / math.sqrt(1.0 + here * here)
                ve, vo, vz = -e * per, -o * per, -here * per
                norm = 1.0 / math.sqrt(1.0 + se * se + so * so)
                cosine = norm * (vz - ve * se - vo * so)
                if cosine <= 0.0:
                    continue
                me, mo, mz = -2.0 * cosine * norm * se - ve, -2.0 * cosine * norm * so - vo, 2.0 * cosine * norm - vz
                turn = r / EARTH_RADIUS
                lit = -1
                for i in range(suns.shape[0]):
                    sz, cz, sa, ca = math.sin(suns[i, 0]), math.cos(suns[i, 0]), math.sin(suns[i, 1]), math.cos(suns[i, 1])
                    along = sz * (sa * e + ca * o)
                    change = along * math.cos(turn) - cz * math.sin(turn) - along
                    le, lo, lz = sz * sa + change * e, sz * ca + change * o, along * math.sin(turn) + cz * math.cos(turn)
                    if (me - le) ** 2 + (mo - lo) ** 2 + (mz - lz) ** 2 > suns[i, 2] * suns[i, 2]:
                        continue
                    if lit < 0:  # one ray serves all Suns
                        flat = math.sqrt(me * me + mo * mo)
                        lit = 1 if meets(sea, (x, y, z), (me / flat, mo / flat, mz / flat), EARTH_RADIUS, shift)[0] < 0.0 else 0
                    q = min(cosine, 1.0) * (reflected.size - 1)
                    j = min(int(q), reflected.size - 2)
                    light = (reflected[j] + (q - j) * (reflected[j + 1] - reflected[j])) / (math.pi * suns[i, 2] * suns[i, 2])
                    out[row, column, k & 1, i, 0] += light
                    out[row, column, k & 1, i, 1] += lit * light


def traced(
    sea: MirrorSea,
    place: tuple[float, float, float],
    edges: tuple[float, float, float, float],
    pixels: tuple[int, int],
    suns: FloatArray,
    reflected: FloatArray,
    rays: int,
    rng: np.random.Generator,
    threads: int = 2,
) -> FloatArray:
    """Radiance of the mirrored Sun in pixels, without and with its shading by waves, in two halves that share no ray.

    Parameters
    ----------
    sea : MirrorSea
        Long waves and ripples.
    place : tuple of float
        East, north and height of the sensor [m].
    edges : tuple of float
        Azimuth of the left edge, column step, elevation of the upper edge, row step [rad].
    pixels : tuple of int
        Rows and columns.
    suns : ndarray
        Zenith angle, azimuth and radius of discs that all light comes from [rad, (suns, 3)].
    reflected : ndarray
        Reflectance times irradiance at even cosines of incidence.
    rays : int
        Rays of a pixel, an even number.
    rng : Generator
        Places in the pixel and of the ripples.
    threads : int
        Threads that share the rows.

    Returns
    -------
    ndarray
        (rows, columns, 2 halves, suns, 2: unshaded and shaded).
    """
    rows, columns = pixels
    out = np.zeros((rows, columns, 2, suns.shape[0], 2))
    draws = rng.random((rows, columns, rays, 6))

    def some(part: slice) -> None:
        inner = np.array([edges[0], edges[1], edges[2] - part.start * edges[3], edges[3]])
        _trace(sea, np.array(place), inner, suns, reflected, draws[part], out[part])

    cuts = np.linspace(0, rows, threads + 1).astype(int)
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(some, [slice(a, b) for a, b in pairwise(cuts)]))
    return out / (0.5 * rays)
