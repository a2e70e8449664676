"""Tiles that carry the waves of a sea: wave bands, sizes, the shortest wave that is geometry, and the wander that hides their periods.

Tiles are periodic. So that the sea does not repeat with their periods, each tile is read at a place displaced slowly over the sea:

::

    zeta(x) = sum_t zeta_t(x + d_t(x)),     d_t(x) = sum_j a_j sin(k_j.x + phi_j)

One period of a tile away the displacement differs by more than the length over which the tile's waves are correlated. It is static, and
belongs to the sea. Heights and slopes at a place are read at a place of the tile: their joint density and all variances are unchanged.
Waves are stretched and turned by the gradient of the displacement, 2.5 % rms in each of its four parts on the first tile and 5.5 % on the
others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Final, NamedTuple

import numpy as np
from scipy.optimize import brentq

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.random import stream
from seaglint.sea.slopes.slope_statistics import SlopeStatistics
from seaglint.sea.spectra.directional import DirectionalSpectrum

#: Lattice points per shortest wave of a tile: read from a cubic spline its variance changes by 2.5 % at most within a cell.
SAMPLES_PER_WAVE: Final = 4

#: Fewest waves of a band's longest kind along a tile; with fewer, directions are coarse and the tile's periodicity shows.
SHORTEST_SPAN: Final = 6.0

#: Largest share of either direction's slope variance that geometry takes [1] (energy rule); facets have the rest.
RESOLVED_SHARE: Final = 0.8

TILES: Final = 3  #: Default number of tiles that the waves of a sea are spread over.

#: Share of the height variance in waves longer than the "longest" one, SHORTEST_SPAN of which must fit on the first tile.
ENERGETIC_SHARE: Final = 0.01

_NARROWEST_BAND: Final = 1.5  # ratio of the ends of a band below which another tile is not worth its cost

_GOLDEN: Final = 0.3819660112501051  # 1 - 1/golden ratio: the fraction that is hardest to approach by ratios of small integers

#: Wave vectors [cycles per period of the tile] and amplitudes [periods] for the first tile, along its axes.
#:
#: Chosen by search: among waves of 3 to 14 periods, with gradients of 2.5 % rms, the waves that leave the least correlation at all lags of
#: up to 50 periods. Few of the tile's longest waves fit on it, and a picture shows few of its periods; crests of swell stay straight.
_LONG: Final = np.array(
    [
        (-0.0977, -0.0007, 0.0153, 0.0459),
        (-0.0683, -0.021, 0.0567, 0.0175),
        (-0.143, -0.2009, -0.0177, -0.0015),
        (0.008, -0.1963, -0.0148, -0.0215),
        (0.1524, -0.2499, -0.0084, 0.0132),
        (0.1013, -0.0735, -0.0237, 0.0226),
    ]
)

#: Waves for the other tiles.
#:
#: Chosen by search among waves of 1.5 to 13 periods with gradients of 5.5 % rms, their parts correlated by less than 0.05: the waves that
#: leave the least correlation at multiples of the period, within squares of one period too, where a displacement that hardly changes would
#: leave the tile in step with itself.
_SHORT: Final = np.array(
    [
        (0.1569, 0.1865, 0.0416, 0.0051),
        (0.2827, 0.303, 0.0076, -0.0234),
        (-0.3033, 0.4166, 0.0163, -0.0049),
        (-0.0188, 0.0758, -0.0842, -0.0384),
        (-0.1162, 0.4337, -0.0012, 0.0201),
        (-0.0893, 0.0196, 0.0563, -0.0761),
        (-0.6577, 0.0722, -0.0106, -0.0101),
        (-0.0788, 0.0741, -0.0179, -0.0426),
    ]
)


@dataclass(frozen=True)
class Tile:
    """Periodic square of sea and the waves that it carries."""

    length: float  #: Period along both axes [m].
    n: int  #: Lattice points along each axis.
    #: Angle of the first axis from east, counter-clockwise from above [rad]: ``u = (cos a x + sin a y)``, ``v = (-sin a x + cos a
    #: y)``.
    rotation: float
    k_min: float  #: Lower end of the tile's waves, included [rad m⁻¹].
    k_max: float  #: Upper end of the tile's waves, not included [rad m⁻¹].

    def __post_init__(self) -> None:
        """Refuse tiles that cannot carry their band."""
        if self.n < 16 or self.n % 4:
            raise DomainError(
                f"tile of n = {self.n} points; give a multiple of 4, 16 or more (256, 512 and 1024 are fast)",
                name="n",
                value=self.n,
                allowed="a multiple of 4, 16 or more",
            )
        if not (np.isfinite(self.length) and self.length > 0.0 and np.isfinite(self.rotation)):
            raise DomainError(
                f"tile of length {self.length:g} m, rotation {self.rotation:g} rad; give a finite length above 0 m",
                name="length",
                value=self.length,
                allowed="above 0 m",
            )
        if not 0.0 <= self.k_min < self.k_max:
            raise DomainError(
                f"tile for wavenumbers {self.k_min:g}-{self.k_max:g} rad/m; give 0 <= k_min < k_max",
                name="k_min",
                value=self.k_min,
                allowed="0 <= k_min < k_max",
            )
        if self.k_max * self.spacing > 2.0 * np.pi / SAMPLES_PER_WAVE * (1.0 + 1e-9):
            raise DomainError(
                f"tile spacing {self.spacing:.4g} m samples its shortest wave of {2 * np.pi / self.k_max:.4g} m less than "
                f"{SAMPLES_PER_WAVE} times; give more points or a shorter tile"
            )

    @property
    def spacing(self) -> float:
        """Spacing of lattice points [m]."""
        return self.length / self.n

    @property
    def sampled(self) -> float:
        """Wavenumber of the waves with ``SAMPLES_PER_WAVE`` lattice points [rad m⁻¹]."""
        return 2.0 * np.pi / (SAMPLES_PER_WAVE * self.spacing)

    @property
    def step(self) -> float:
        """Spacing of lattice wavenumbers [rad m⁻¹]."""
        return 2.0 * np.pi / self.length


def plan_tiles(spectrum: DirectionalSpectrum, shortest_wave: float, n: int, tiles: int = TILES, *, bound: float = 0.0) -> tuple[Tile, ...]:
    """Tiles for all waves of a spectrum that are longer than ``shortest_wave``, longest band first.

    Lengths fall by one ratio, nudged apart from it, chosen so that every tile is the same number of its longest waves long. Waves that
    have bound waves belong to the first tile: its band is wider then, and it has twice the points.

    Parameters
    ----------
    spectrum : DirectionalSpectrum
        The sea.
    shortest_wave : float
        Shortest wave to be synthesised [m]; the last tile samples it four times.
    n : int
        Lattice points along each axis of each tile.
    tiles : int
        Number of tiles.
    bound : float
        Wavenumber up to which waves have bound waves [rad m⁻¹]; 0 without. The first tile has them all as long as it is
        ``SHORTEST_SPAN`` of its longest waves long. Bands that become narrower than half an octave are joined.

    Returns
    -------
    tuple of Tile

    Raises
    ------
    DomainError
        If the tiles came out too short for the sea state, or no energetic wave is that long.

    Examples
    --------
    >>> from seaglint.sea.spectra import ElfouhailySpectrum
    >>> [round(t.length) for t in plan_tiles(ElfouhailySpectrum(10.0), 0.5, 512)]
    [3222, 454, 64]
    """
    if tiles < 1:
        raise DomainError(f"tiles = {tiles}; give one or more", name="tiles", value=tiles, allowed="1 or more")
    if not (np.isfinite(shortest_wave) and shortest_wave > 0.0):
        raise DomainError(
            f"shortest wave = {shortest_wave:g} m; give a length above 0 m", name="shortest_wave", value=shortest_wave, allowed="above 0 m"
        )
    k_low, k_top = longest_wave_number(spectrum), 2.0 * np.pi / shortest_wave
    if k_top <= k_low:
        raise DomainError(
            f"shortest wave = {shortest_wave:.4g} m is longer than the longest energetic waves of this sea ({2 * np.pi / k_low:.4g} m): "
            "nothing is left to synthesise; give a shorter one or resolve no waves",
            name="shortest_wave",
            value=shortest_wave,
            allowed=(0.0, float(2.0 * np.pi / k_low)),
        )
    # the nudge by multiples of the golden ratio keeps lengths and axes of any two tiles incommensurate
    ratio = (k_top / k_low) ** (1.0 / tiles)
    span = n / (SAMPLES_PER_WAVE * ratio)
    last = shortest_wave * n / SAMPLES_PER_WAVE
    if bound > 0.0:
        # the nudge of the first length lowers the end of its band by up to 6 %
        widest = n / (SAMPLES_PER_WAVE * SHORTEST_SPAN)
        first = min(1.06 * bound / k_low, widest, k_top / k_low)
        fewest = 1 if k_top / k_low <= widest else 2
        while tiles > fewest and first > ratio and (k_top / k_low / first) ** (1.0 / (tiles - 1)) < _NARROWEST_BAND:
            tiles -= 1
        if tiles > 1 and first > ratio:
            ratio = (k_top / k_low / first) ** (1.0 / (tiles - 1))
        elif tiles == 1:
            span = n * k_low / (SAMPLES_PER_WAVE * k_top)
    lengths = [last * ratio ** (tiles - 1 - i) * (1.0 + 0.06 * ((tiles - 1 - i) * _GOLDEN % 1.0)) for i in range(tiles)]
    if span < SHORTEST_SPAN:
        needed = SHORTEST_SPAN * 2.0 * np.pi / k_low
        raise DomainError(
            f"{tiles} tiles of {n} points from {shortest_wave:.4g} m waves up make the longest {lengths[0]:.4g} m long; this sea needs "
            f"{needed:.4g} m: give more tiles or points (render.tile_size) or a longer shortest wave (sea.shortest_wave_m)"
        )
    edges = [0.0, *(2.0 * np.pi * n / (SAMPLES_PER_WAVE * length) for length in lengths)]
    points = [n] * tiles
    # sums of two waves have up to twice their wavenumber
    if 2.0 * bound > edges[1]:
        points[0] = 2 * n
    return tuple(
        Tile(length, points[i], float(0.5 * np.pi * ((i + 0.3) * _GOLDEN % 1.0)), edges[i], edges[i + 1])
        for i, length in enumerate(lengths)
    )


@lru_cache(maxsize=4)  # called four times for the spectrum of a scene
def longest_wave_number(spectrum: DirectionalSpectrum) -> float:
    """Wavenumber below which lies ``ENERGETIC_SHARE`` of the height variance [rad m⁻¹]."""
    low, high = spectrum.wavenumber_range
    variance = ENERGETIC_SHARE * spectrum.height_variance()
    return float(np.exp(brentq(lambda x: spectrum.height_variance(float(np.exp(x))) - variance, np.log(low), np.log(high), xtol=1e-6)))


def resolve_limit(spectrum: DirectionalSpectrum, slopes: SlopeStatistics, fraction: float = RESOLVED_SHARE) -> float:
    """Wavenumber at which resolved slopes reach a fraction of the slope model, in the direction where that comes first.

    Geometry stops there, so that the facets of the energy rule keep a share of the variance in every direction. For waves that run
    with the wind the direction is upwind or crosswind; for swell from another azimuth it is where ``v.R v/(v.T v)`` is largest over the
    directions v, R and T the covariances of resolved slopes and of the model.

    Parameters
    ----------
    spectrum : DirectionalSpectrum
        The sea.
    slopes : SlopeStatistics
        The slope model that geometry and facets add up to.
    fraction : float
        Largest share of geometry [1].

    Returns
    -------
    float
        Wavenumber [rad m⁻¹]; the spectrum's upper end where the fraction is never reached, 0 where the model has no slopes.
    """
    if not 0.0 < fraction <= 1.0:
        raise DomainError(f"fraction = {fraction:g} must lie in (0, 1]", name="fraction", value=fraction, allowed="above 0 to 1")
    allowed = (fraction * slopes.mss_up, fraction * slopes.mss_cross)
    if min(allowed) <= 0.0:
        return 0.0

    def excess(log_k: float) -> float:
        k = float(np.exp(log_k))
        up, cross = (share / most for share, most in zip(spectrum.mss(k), allowed, strict=True))
        # largest eigenvalue of the resolved covariance over the allowed one
        covariance = spectrum.slope_covariance(k) / np.sqrt(allowed[0] * allowed[1])
        return float(0.5 * (up + cross) + np.hypot(0.5 * (up - cross), covariance)) - 1.0

    low, high = spectrum.wavenumber_range
    if excess(float(np.log(high))) <= 0.0:
        return high
    return float(np.exp(brentq(excess, np.log(low), np.log(high), xtol=1e-6)))


def require_bands(spectrum: DirectionalSpectrum, tiles: Sequence[Tile]) -> None:
    """Refuse overlapping bands and a tile too short for the longest waves of its band."""
    ordered = sorted(tiles, key=lambda tile: tile.k_min)
    for long, short in pairwise(ordered):
        if short.k_min < long.k_max * (1.0 - 1e-12):
            raise DomainError(
                f"bands {long.k_min:.4g}-{long.k_max:.4g} and {short.k_min:.4g}-{short.k_max:.4g} rad/m overlap: their waves would count "
                "twice; give disjoint bands"
            )
    k_low = longest_wave_number(spectrum)
    for tile in tiles:
        longest = 2.0 * np.pi / max(tile.k_min, k_low)
        if tile.length < 0.5 * SHORTEST_SPAN * longest:
            raise DomainError(
                f"tile of {tile.length:.4g} m is too short for its waves of {longest:.4g} m; give at least {SHORTEST_SPAN * longest:.4g} m"
            )


class Wander(NamedTuple):
    """Displacement of one tile, east and north: ``amplitude`` [m, (waves, 2)], ``wave_vector`` [rad m⁻¹, (waves, 2)], ``phase`` [rad]."""

    amplitude: FloatArray
    wave_vector: FloatArray
    phase: FloatArray

    @classmethod
    def of(cls, tile: Tile, seed: int, index: int) -> Wander:
        """Return the displacement of tile ``index``, with phases from ``stream(seed, "wander", index)``."""
        c, s = np.cos(tile.rotation), np.sin(tile.rotation)
        turn = np.array([[c, s], [-s, c]])
        waves = _LONG if index == 0 else _SHORT
        phase = 2.0 * np.pi * stream(seed, "wander", index).random(len(waves))
        return cls(tile.length * waves[:, 2:] @ turn, tile.step * waves[:, :2] @ turn, phase)

    def __call__(self, east: FloatArray, north: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Displacement towards east and north [m] at places of the sea [m]; arrays that broadcast against each other."""
        displacement = [np.zeros(np.broadcast_shapes(np.shape(east), np.shape(north))) for _ in range(2)]
        for amplitude, wave, phase in zip(*self, strict=True):
            sine = np.sin(wave[0] * east + wave[1] * north + phase)
            displacement[0] += amplitude[0] * sine
            displacement[1] += amplitude[1] * sine
        return displacement[0], displacement[1]

    def gradient(self, east: float, north: float) -> FloatArray:
        """Derivatives of the displacement (rows: east, north) towards east and north (columns) at a place [1, (2, 2)]."""
        cosine = np.cos(self.wave_vector @ np.array([east, north]) + self.phase)
        return np.asarray((self.amplitude * cosine[:, None]).T @ self.wave_vector)
