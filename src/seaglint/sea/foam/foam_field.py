r"""Foam of breaking waves on the tiles of a synthesised sea: where and when waves break, and the share of foam at a time.

Breakers are drawn for every tile and every slot of time, a fixed stretch of a few seconds: how many and how fast by the distribution of
breaking crests (:mod:`seaglint.sea.foam.breaking_crests`), where by the waves of the tile at the middle of the slot. They begin on its
steepest crests, at places with the density

.. math:: p(x) \propto \max(s(x) - a \sigma_s, 0)^2, \qquad s = \sum_k |k| \zeta_k

with s the steepness of the waves ``zeta_k`` of the tile, and a = 1.5, less where foam covers more than a sixtieth of the sea. A breaker
runs between the mean direction of these waves and the line across the crest, its own crest grows and shrinks as a half ellipse, and it
leaves foam that grows, stays, decays and drifts with the water. Slots are functions of their number: the foam of an instant depends on
scenario, seed and time alone.

Foam is a share between 0 and 1 on square cells of the tile, with the means of 2 x 2, 4 x 4, ... cells for larger pixels. It is read at the
places of the tile's waves (``seaglint.sea.tiles``), so that it stays on their crests.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from seaglint.base.constants import GRAVITY
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import in_threads, kernel, njit
from seaglint.base.random import stream
from seaglint.base.sine import sine
from seaglint.sea.foam.breaking_crests import CREST_SPEED, BreakingCrests
from seaglint.sea.foam.lace import lace_pattern
from seaglint.sea.wave_field import WaveField

CELLS_PER_POINT: Final = 2  #: Cells of foam per lattice point of a tile's waves, along a side: eight per shortest wave.

STEEP: Final = 1.5  #: Steepness above which waves may break at most, in standard deviations of the steepness of the tile's waves.

ROOM: Final = 4.0  #: Least share of the sea where waves may break, over the share of foam: where much breaks, waves less steep break too.

PHASE_SPEED: Final = 1.0 / CREST_SPEED  #: Phase speed of a wave over the speed of its breaking crest.

#: Speed with which the water at the surface drifts over the speed of the wind (Wu 1975, J. Fluid Mech. 68, 49).
DRIFT: Final = 0.03

SLOT_PERIODS: Final = 0.75  #: Length of a slot over the period of the tile's middle wave [1].
SLOTS_S: Final = (0.5, 4.0)  #: Shortest and longest slot [s].

#: Neighbouring crests that break together, side by side, and are drawn as one. Assumed: single crests are 0.1 of their wave long and run
#: 0.24 of it, but breakers are seen as lines along the crests of waves.
GROUP: Final = 3

#: Angle of breakers from downwind over that of the line across the crest where they begin: short waves run in all directions, but mostly
#: those that run nearly downwind break (Melville and Matusov 2002: within some 40 degrees).
ACROSS_CRESTS: Final = 0.5

RISE: Final = 0.1  #: Time in which foam grows at a place, over the time for which its crest feeds it [1].

LAST: Final = 3.0  #: Age at which decaying foam ends, in its decay times.

#: Mean of a decay that ends over one that does not: ``(e^-x - e^-3)/(1 - e^-3)`` integrated over x from 0 to 3.
_ENDED: Final = (1.0 - (1.0 + LAST) * math.exp(-LAST)) / (1.0 - math.exp(-LAST))

#: Time step of aged foam, which only decays and drifts [s]: it is drawn at the ends of a step and changes linearly between them, within
#: 0.3 % of its share.
AGED_STEP: Final = 0.5

SMALL: Final = 0.75  #: Largest half length of a crest that is drawn as a point, in cells; its path is up to twice as long.


class Breakers(NamedTuple):
    """Breakers of one slot of one tile, lengths in metres on the tile's axes.

    ``place[n] = (u, v)`` of the middle of the crest when it begins; ``heading[n] = (cos, sin)`` of its direction from the u axis;
    ``begin`` [s]; ``speed`` [m/s] through the water; ``half`` the largest half length of the crest [m]; ``duration`` of its breaking [s];
    ``fed`` and ``decay`` of the foam that it leaves [s]; ``shape[n]``: bend of the crest and phases of its ragged edges.
    """

    place: FloatArray
    heading: FloatArray
    begin: FloatArray
    speed: FloatArray
    half: FloatArray
    duration: FloatArray
    fed: FloatArray
    decay: FloatArray
    shape: FloatArray


class FoamTiles(NamedTuple):
    """Foam of an instant: pyramids of shares, and where to read them.

    ``cells``: the pyramids of all tiles one after another, each the cells (n, n) of its tile row by row, followed by the means of 2 x 2,
    4 x 4, ... of them up to the whole tile; ``marks``: the same without the cells (n, n), 1 where a mean or one of the next in its row,
    its column and the corner between them has foam, else 0; ``size[t]``: n, a power of two.
    """

    cells: NDArray[np.float32]
    marks: NDArray[np.uint8]
    size: tuple[int, ...]
    lace: NDArray[np.float32]  #: Pattern of holes (``seaglint.sea.foam.lace``).
    drifted: tuple[float, float]  #: Way of the water since the start, towards east and north [m].

    @property
    def share(self) -> tuple[NDArray[np.float32], ...]:
        """Return the pyramid of each tile [1]."""
        return tuple(np.split(self.cells, np.cumsum([pyramid_size(n) for n in self.size])[:-1]))


@dataclass(frozen=True)
class _Band:
    """Breakers that a tile carries."""

    slowest: float  #: Speeds of its breakers [m/s].
    fastest: float
    rate: float  #: Groups of breaking crests per area and time [m-2 s-1].
    slot: float  #: Length of a slot [s].
    age: float  #: Time from the beginning of a breaker to the end of its foam, at most [s].
    least: float  #: Steepness above which its waves may break [1].


@dataclass(frozen=True, eq=False)
class FoamField:
    """Breaking waves and their foam on the tiles of a sea. Make it with ``create``."""

    waves: WaveField
    crests: BreakingCrests
    drift: tuple[float, float]  #: Velocity of the water at the surface towards east and north [m/s].
    seed: int
    _bands: tuple[_Band | None, ...]
    _slots: dict[tuple[int, int], Breakers] = field(default_factory=dict, repr=False)
    _aged: dict[int, tuple[int, NDArray[np.float32], NDArray[np.float32]]] = field(default_factory=dict, repr=False)

    @classmethod
    def create(cls, waves: WaveField, crests: BreakingCrests, wind_speed: float, wind_to_azimuth: float, seed: int) -> Self:
        """Divide the breaking crests among the tiles of a sea.

        Parameters
        ----------
        waves : WaveField
            The sea, all its waves.
        crests : BreakingCrests
            Distribution of the crests over their speeds.
        wind_speed : float
            At 10 m [m/s]; it drives the drift.
        wind_to_azimuth : float
            Direction to which the wind blows [rad].
        seed : int
            Of ``stream(seed, "breakers", tile, slot)``.
        """
        drift = DRIFT * wind_speed
        velocity = (drift * math.sin(wind_to_azimuth), drift * math.cos(wind_to_azimuth))
        return cls(waves, crests, velocity, seed, _bands(waves, crests))

    def reseeded(self, waves: WaveField, seed: int) -> FoamField:
        """Return the foam of another realisation of the same sea."""
        return FoamField(waves, self.crests, self.drift, seed, self._bands)

    def shares(self, time: float) -> FoamTiles:
        """Return the foam of an instant [s]."""
        size = tuple(CELLS_PER_POINT * tile.n for tile in self.waves.tiles)
        number, above = [pyramid_size(n) for n in size], [pyramid_size(n // 2) for n in size]
        out = FoamTiles(
            np.empty(sum(number), np.float32),
            np.empty(sum(above), np.uint8),
            size,
            lace_pattern(self.seed),
            (self.drift[0] * time, self.drift[1] * time),
        )
        shares, marks = out.share, np.split(out.marks, np.cumsum(above)[:-1])
        step = math.floor(time / AGED_STEP)
        wanted = [(t, slot) for t in range(len(size)) for slot in self._slots_at(t, (step + 1) * AGED_STEP) if (t, slot) not in self._slots]

        def break_waves(part: tuple[int, int]) -> None:
            for t, slot in wanted[part[0] : part[1]]:
                self._slots[t, slot] = self.breakers(t, slot)

        in_threads(break_waves, len(wanted))

        def draw(part: tuple[int, int]) -> None:
            for t in range(*part):
                self._draw(t, time, step, shares[t], marks[t])

        in_threads(draw, len(size))
        # what is kept does not grow with a sequence
        for key in [key for key in self._slots if key[1] < self._first_slot(key[0], time) - 8]:
            self._slots.pop(key, None)
        return out

    def _first_slot(self, tile: int, time: float) -> int:
        band = self._bands[tile]
        return 0 if band is None else math.floor((time - band.age) / band.slot)

    def _slots_at(self, tile: int, time: float) -> range:
        """Return the slots whose breakers may have foam at a time [s]."""
        band = self._bands[tile]
        return range(0) if band is None else range(self._first_slot(tile, time), math.floor(time / band.slot) + 1)

    def breakers(self, tile: int, slot: int) -> Breakers:
        """Return the breakers that begin in a slot of a tile: from ``slot`` to ``slot + 1`` times its length."""
        band, waves = self._bands[tile], self.waves.tiles[tile]
        if band is None:
            return _none()
        rng = stream(self.seed, "breakers", tile, slot & 0xFFFFFFFF)
        number = int(rng.poisson(band.rate * waves.length**2 * band.slot))
        draws = rng.random((number, 9))
        middle = (slot + 0.5) * band.slot
        steep = self.waves.steepness(tile, middle)
        above = steep.ravel() - np.float32(band.least)
        where = np.flatnonzero(above > 0.0)
        if number == 0 or where.size == 0:
            return _none()
        total = np.cumsum(above[where].astype(np.float64) ** 2)
        chosen = where[np.searchsorted(total, draws[:, 0] * total[-1], side="right").clip(max=where.size - 1)]
        row, column = np.divmod(chosen, waves.n)
        heading = _across_crests(steep, row, column, self._forwards(tile))
        speed = self.crests.speeds(draws[:, 1], band.slowest, band.fastest)
        begin = (slot + draws[:, 2]) * band.slot
        place = (np.stack([column, row], axis=1) + draws[:, 3:5] - 0.5) * waves.spacing
        place = place + heading * (PHASE_SPEED * speed * (begin - middle))[:, None]
        life, fed = self.crests.life(speed), self.crests.active(speed)
        decay = (life - fed * (1.0 - 0.5 * RISE)) / _ENDED
        half = (2.0 / np.pi) * GROUP * self.crests.crest_length(speed)
        return Breakers(place, heading, begin, speed, half, self.crests.duration(speed), fed, decay, draws[:, 5:9])

    def _forwards(self, tile: int) -> tuple[float, float]:
        """Return the mean direction of the waves of a tile on its axes: downwind, or that of a swell."""
        (east, north), turn = self.waves.direction(tile), self.waves.tiles[tile].rotation
        return math.cos(turn) * east + math.sin(turn) * north, math.cos(turn) * north - math.sin(turn) * east

    def _draw(self, tile: int, time: float, step: int, out: NDArray[np.float32], marks: NDArray[np.uint8]) -> None:
        """Draw the pyramid of a tile at a time [s], in a step of aged foam."""
        n = CELLS_PER_POINT * self.waves.tiles[tile].n
        if self._bands[tile] is None:
            out[:], marks[:] = 0.0, 0
            return
        before, after = self._aged_at(tile, step)
        base = out[: n * n].reshape(n, n)
        between(before, after, np.float32(time / AGED_STEP - step), base)
        self._add(tile, time, step, base, young=True)
        np.minimum(base, np.float32(1.0), out=base)
        build_pyramid(out, n)
        mark_foam(out, n, marks)

    def _aged_at(self, tile: int, step: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the sums of aged foam at the beginning and the end of a step, of the same breakers; the last step of a tile is kept."""
        kept = self._aged.get(tile)
        if kept is None or kept[0] != step:
            n = CELLS_PER_POINT * self.waves.tiles[tile].n
            ends = np.zeros((2, n, n), np.float32)
            for end in range(2):
                self._add(tile, (step + end) * AGED_STEP, step, ends[end], young=False)
            kept = self._aged[tile] = (step, ends[0], ends[1])
        return kept[1], kept[2]

    def _add(self, tile: int, time: float, step: int, cells: NDArray[np.float32], *, young: bool) -> None:
        """Add the foam of the breakers of a tile at a time [s]: those young at the beginning of a step, or those aged by then."""
        waves = self.waves.tiles[tile]
        turn = waves.rotation
        drift = (
            math.cos(turn) * self.drift[0] + math.sin(turn) * self.drift[1],
            math.cos(turn) * self.drift[1] - math.sin(turn) * self.drift[0],
        )
        for slot in self._slots_at(tile, time):
            found = self._slots.get((tile, slot))
            kept = self.breakers(tile, slot) if found is None else found
            draw_breakers(kept, time, step * AGED_STEP, young, waves.length / cells.shape[0], drift, cells)


def pyramid_size(n: int) -> int:
    """Return the number of cells of a pyramid over ``n`` x ``n`` cells, n a power of two.

    >>> pyramid_size(4)
    21
    """
    return (4 * n * n - 1) // 3


def _none() -> Breakers:
    one, two = np.zeros(0), np.zeros((0, 2))
    return Breakers(two, two, one, one, one, one, one, one, np.zeros((0, 4)))


def _bands(waves: WaveField, crests: BreakingCrests) -> tuple[_Band | None, ...]:
    """Divide the speeds of breaking crests among tiles: each has those of its waves, the last one also slower ones."""
    out: list[_Band | None] = []
    # phase speed of the shortest wave of each tile over PHASE_SPEED: the slowest breaker that it carries
    lowest = [math.sqrt(GRAVITY / tile.k_max) / PHASE_SPEED for tile in waves.tiles]
    fastest = crests.fastest
    room = min(ROOM * crests.coverage_between(crests.slowest, fastest), 0.5)
    steep = min(STEEP, float(ndtri(1.0 - room))) if room > 0.0 else STEEP
    for i, tile in enumerate(waves.tiles):
        slowest = crests.slowest if i == len(lowest) - 1 else max(lowest[i], crests.slowest)
        if slowest >= fastest:
            out.append(None)
            continue
        speeds = np.linspace(slowest, fastest, 65)
        age = float(np.max(crests.duration(speeds) + crests.active(speeds) + LAST * crests.life(speeds) / _ENDED))
        middle = math.sqrt(max(tile.k_min, GRAVITY / (PHASE_SPEED * fastest) ** 2) * tile.k_max)
        period = 2.0 * math.pi / math.sqrt(GRAVITY * middle)
        slot = min(max(SLOT_PERIODS * period, SLOTS_S[0]), SLOTS_S[1])
        rate = crests.rate_between(slowest, fastest) / GROUP
        out.append(_Band(slowest, fastest, rate, slot, age, steep * waves.steepness_deviation(i)) if rate > 0.0 else None)
        fastest = slowest
    return tuple(out)


def _across_crests(steep: NDArray[np.float32], row: NDArray[np.intp], column: NDArray[np.intp], wind: tuple[float, float]) -> FloatArray:
    """Return directions of breakers at points of a lattice (n, 2): between downwind and the direction of the strongest curvature."""
    n = steep.shape[0]

    def at(i: int, j: int) -> FloatArray:
        return np.asarray(steep[(row + i) % n, (column + j) % n], np.float64)

    middle = at(0, 0)
    uu, vv = at(0, 1) + at(0, -1) - 2.0 * middle, at(1, 0) + at(-1, 0) - 2.0 * middle
    uv = 0.25 * (at(1, 1) + at(-1, -1) - at(1, -1) - at(-1, 1))
    # the axis of the smaller, most negative eigenvalue; of its two directions the one downwind
    angle = 0.5 * np.arctan2(2.0 * uv, uu - vv) + 0.5 * np.pi
    downwind = math.atan2(wind[1], wind[0])
    off = np.mod(angle - downwind + 0.5 * np.pi, np.pi) - 0.5 * np.pi
    angle = downwind + ACROSS_CRESTS * off
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


@kernel
def overlap(low: float, high: float, at: float, cell: float) -> float:
    """Return the share of a cell around ``at`` that lies between ``low`` and ``high``."""
    return max(min(at + 0.5 * cell, high) - max(at - 0.5 * cell, low), 0.0) / cell


@kernel
def half_ellipse(first: float, last: float) -> float:
    """Return the mean of ``sqrt(1 - q^2)`` between two values of q from -1 to 1."""
    if last - first < 0.2:
        middle = 0.5 * (first + last)
        return math.sqrt(max(1.0 - middle * middle, 0.0))
    first, last = max(first, -1.0), min(last, 1.0)
    near = first * math.sqrt(max(1.0 - first * first, 0.0)) + math.asin(first)
    far = last * math.sqrt(max(1.0 - last * last, 0.0)) + math.asin(last)
    return 0.5 * (far - near) / (last - first)


@kernel
def foam_left(since: float, fed: float, decay: float) -> float:
    """Return the share of foam at a place, ``since`` [s] after the crest came: growth, rest, and a decay that ends."""
    if since < fed:
        return min(since / (RISE * fed), 1.0)
    x = (since - fed) / decay
    if x >= LAST:
        return 0.0
    end = math.exp(-LAST)
    return (math.exp(-x) - end) / (1.0 - end)


@njit
def draw_breakers(
    breakers: Breakers, time: float, begin: float, young: bool, cell: float, drift: tuple[float, float], out: np.ndarray
) -> None:
    """Add the shares of the foam of breakers at a time [s] to the cells (n, n) of a periodic tile.

    ``young``: True for the breakers whose foam does not only decay at the time ``begin`` [s], False for the others.
    """
    n = out.shape[0]
    for e in range(breakers.begin.shape[0]):
        age = time - breakers.begin[e]
        fed, decay, duration, speed = breakers.fed[e], breakers.decay[e], breakers.duration[e], breakers.speed[e]
        if age <= 0.0 or age >= duration + fed + LAST * decay or young != (begin - breakers.begin[e] < duration + fed):
            continue
        c, s, most, run = breakers.heading[e, 0], breakers.heading[e, 1], breakers.half[e], speed * duration
        front = min(age * speed, run)
        if most < SMALL * cell and run < 2.0 * SMALL * cell:
            # smaller than a cell: its area is divided among the four cells around its middle
            q = front / run
            area = most * run * half_ellipse(-1.0, 2.0 * q - 1.0) * 2.0 * q / (cell * cell)
            x = (breakers.place[e, 0] + drift[0] * age + 0.5 * front * c) / cell - 0.5
            y = (breakers.place[e, 1] + drift[1] * age + 0.5 * front * s) / cell - 0.5
            area *= foam_left(age - 0.5 * front / speed, fed, decay)
            i, j = math.floor(y), math.floor(x)
            f, g = x - j, y - i
            near, far = i & (n - 1), (i + 1) & (n - 1)
            left, right = j & (n - 1), (j + 1) & (n - 1)
            out[near, left] += area * (1.0 - f) * (1.0 - g)
            out[near, right] += area * f * (1.0 - g)
            out[far, left] += area * (1.0 - f) * g
            out[far, right] += area * f * g
            continue
        # the crest is bent back at its ends, and ragged along both sides; shears leave its area as it is
        bend = (0.2 + 0.5 * breakers.shape[e, 0]) * most
        phase, other = breakers.shape[e, 1], breakers.shape[e, 2]
        ragged, wave = 0.12 * most, 1.0 / max(most, cell)
        if most < cell:  # smaller than two cells: its outline does not show
            bend = ragged = 0.0
        # place that the breaker's origin has drifted to
        u0, v0 = breakers.place[e, 0] + drift[0] * age, breakers.place[e, 1] + drift[1] * age
        reach, first, last = most + 1.5 * ragged + cell, -2.0 * bend - ragged - cell, front + 1.5 * ragged + cell
        extent_u = (min(first * c, last * c) - reach * abs(s), max(first * c, last * c) + reach * abs(s))
        extent_v = (min(first * s, last * s) - reach * abs(c), max(first * s, last * s) + reach * abs(c))
        # bounds of a and b before the shears, beyond which nothing is drawn
        most_b = most + cell + 1.5 * ragged
        low_a, high_a = -bend * (1.0 + cell / most) ** 2 - 0.5 * ragged - 0.5 * cell, front + 0.5 * ragged + 0.5 * cell
        i0, i1 = math.floor((v0 + extent_v[0]) / cell), math.floor((v0 + extent_v[1]) / cell)
        j0, j1 = math.floor((u0 + extent_u[0]) / cell), math.floor((u0 + extent_u[1]) / cell)
        for i in range(i0, min(i1, i0 + n - 1) + 1):
            dv = (i + 0.5) * cell - v0
            for j in range(j0, min(j1, j0 + n - 1) + 1):
                du = (j + 0.5) * cell - u0
                a, b = du * c + dv * s, dv * c - du * s
                if abs(b) > most_b or a < low_a or a > high_a:
                    continue
                if ragged > 0.0:
                    b += ragged * (sine(wave * a + phase) + 0.5 * sine(2.7 * wave * a + other))
                    if abs(b) > most + cell:
                        continue
                    a += bend * (b / most) * (b / most) - 0.5 * ragged * sine(1.9 * wave * b + other)
                # stretch of the path that lies in the cell, and the mean half length of the crest along it
                low, high = max(a - 0.5 * cell, 0.0), min(a + 0.5 * cell, front)
                if high <= low:
                    continue
                half = most * half_ellipse(2.0 * low / run - 1.0, 2.0 * high / run - 1.0)
                across = overlap(-half, half, b, cell)
                if across <= 0.0:
                    continue
                share = (high - low) / cell * across * foam_left(age - 0.5 * (low + high) / speed, fed, decay)
                y, x = i & (n - 1), j & (n - 1)
                out[y, x] += share


@njit
def between(first: np.ndarray, second: np.ndarray, part: np.float32, out: np.ndarray) -> None:
    """Set ``out`` to ``first`` and a ``part`` of the way to ``second``, in one pass."""
    for i in range(out.shape[0]):
        for j in range(out.shape[1]):
            out[i, j] = first[i, j] + part * (second[i, j] - first[i, j])


@njit
def build_pyramid(share: np.ndarray, n: int) -> None:
    """Fill the means of 2 x 2 cells, level by level, behind the ``n`` x ``n`` cells of a pyramid."""
    below, size = 0, n
    while size > 1:
        above, half = below + size * size, size // 2
        for i in range(half):
            for j in range(half):
                first = below + 2 * i * size + 2 * j
                share[above + i * half + j] = 0.25 * (share[first] + share[first + 1] + share[first + size] + share[first + size + 1])
        below, size = above, half


@njit
def mark_foam(share: np.ndarray, n: int, marks: np.ndarray) -> None:
    """Mark the means of the pyramid of ``n`` x ``n`` cells with foam, or with foam in the next ones of a periodic tile."""
    below, size = n * n, n // 2
    while size > 0:
        for i in range(size):
            near, far = below + i * size, below + (i + 1) % size * size
            at = below - n * n + i * size
            for j in range(size - 1):
                marks[at + j] = share[near + j] + share[near + j + 1] + share[far + j] + share[far + j + 1] > 0.0
            j = size - 1
            marks[at + j] = share[near + j] + share[near] + share[far + j] + share[far] > 0.0
        below, size = below + size * size, size // 2
