"""Moving sea of Gaussian waves of a directional spectrum, synthesised on a few periodic tiles, and its levels of detail.

**Synthesis.**

::

    zeta(x, t) = Re sum_k a_k exp[i (k.x - omega t)],     <|a_k|^2> = 2 int_cell Psi dk

with omega by :mod:`seaglint.sea.dispersion`.

Every tile carries a separate band of wavenumbers, so that the sum over tiles has the whole spectrum once. Lengths are incommensurate and
axes turned against each other; if the sea must not show the period of any tile, tiles wander (``seaglint.sea.tiles``). The
energy of a lattice wave is the integral of the spectrum over its cell, not a sample of it: heights and slopes have the variance of the
spectrum for any grid size and tile length. A frame is a function of (amplitudes, time) alone; amplitudes are a function of
(spectrum, tiles, seed) alone.

**Reading between lattice points.** A reader sums lattice points with weights ``w(x - i)``, a B-spline. Of the variance of a wave that turns
by ``a`` from point to point it reproduces the share, averaged over the places in a cell and for each axis,

::

    sum_m c(m) cos(m a),      c: the same B-spline's product with itself, moved by m cells

which is (2 + cos a)/3 for linear reading and (2416 + 2382 cos a + 240 cos 2a + 2 cos 3a)/5040 for cubic B-splines. So lattices hold
amplitudes over the root of that share (:meth:`WaveField.coefficients`). At single places of a cell the variance differs from the mean: for
waves of four cells by -24 to +50 % of it (linear) and 2.5 % (cubic), for longer ones with the second and fourth power of one over their
length.

**Levels of detail.** A level is the same sea without its shortest waves, about one octave less at each level. Each tile of a
:class:`WaveField` exists unchanged and low-passed on lattices of half, a quarter, ... of its points, as long as waves are left. A level is
a choice of one version of every tile that still has waves. The waves that a level omits belong to the facets.

**Second order.** The energetic waves of the longest tile may have bound waves (``seaglint.sea.second_order``) on its lattices: in heights
and slopes that are read or exported, at every level of detail, from the waves that the level has. Variances, plane waves and steepness are
those of the free waves alone.

References
----------
M. Unser, Splines: a perfect fit for signal and image processing, IEEE Signal Process. Mag. 16(6), 22-38, 1999.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final, Literal

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import in_threads, njit
from seaglint.base.random import stream
from seaglint.sea.dispersion import angular_frequency
from seaglint.sea.second_order import bound_coefficients
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.tiles import Tile, Wander, longest_wave_number, require_bands

Reading = Literal["linear", "cubic"]

_READ_SHARES: dict[Reading, tuple[float, ...]] = {"linear": (2 / 3, 1 / 3), "cubic": (2416 / 5040, 2382 / 5040, 240 / 5040, 2 / 5040)}

SurfaceArray = NDArray[np.float32]
ComplexArray = NDArray[np.complex64]

_NEAR: Final = 24  # lattice steps from the origin within which cells are integrated finely

#: Share of the height variance by which tiles read linearly may have more of it at their lattice points than on average.
#:
#: Such reading is three times as fast; cubic reading of the others adds 0.01 at most.
UNEVEN: Final = 0.02

NARROWEST: Final = 1.5  #: Least ratio of the upper limit of a low-passed tile to its lowest wavenumber; a narrower tile is omitted.

#: Share of a level's slope variance below which the loss of a tile's waves to an average is neglected, and the tile left as it is.
KEPT: Final = 2e-3

SMALLEST: Final = 16  #: Fewest lattice points along a side of a low-passed tile.


def read_share(turn: FloatArray, reading: Reading) -> FloatArray:
    """Share of the variance of waves that a reader gets, along one axis [1].

    Parameters
    ----------
    turn : ndarray
        Phase from one lattice point to the next [rad], at most half a circle.
    reading : "linear" or "cubic"
        Linear interpolation, or a cubic B-spline whose coefficients the lattice holds.

    Examples
    --------
    >>> [round(float(read_share(np.pi / 2, reading)), 3) for reading in ("linear", "cubic")]
    [0.667, 0.432]
    """
    turn = np.asarray(turn, np.float64)
    return np.asarray(sum(share * np.cos(m * turn) for m, share in enumerate(_READ_SHARES[reading])), np.float64)


def gain(turn: FloatArray, reading: Reading) -> FloatArray:
    """Factor of the amplitudes of waves with which a reader gets their variance, along one axis [1]; as ``read_share``."""
    return np.asarray(1.0 / np.sqrt(read_share(turn, reading)))


@dataclass(frozen=True, eq=False)
class _Lattice:
    """Waves that a tile can carry: rows are v wavenumbers in FFT order, columns u wavenumbers from 0 up.

    ``variance`` and ``opposite`` are the height variances of the waves travelling along k and along -k [m²]. The column u = 0 holds
    k and -k both: its lower half holds no further waves.
    """

    k_east: FloatArray
    k_north: FloatArray
    frequency: FloatArray
    variance: FloatArray
    opposite: FloatArray


@dataclass(frozen=True, eq=False)
class _Amplitudes:
    """Half amplitudes of the waves along k and along -k, a_k/2 and a_-k/2 [m], on a tile's lattice."""

    forward: ComplexArray
    backward: ComplexArray


@dataclass(frozen=True, eq=False)
class _Average:
    """Waves of a tile before its mean over lines, each given by its extent towards east and north [m]."""

    lattice: _Lattice
    amplitudes: _Amplitudes
    lines: tuple[tuple[float, float], ...]


@dataclass(frozen=True, eq=False)
class WaveField:
    """Moving sea, synthesised on periodic tiles. Make it with :meth:`create`.

    ``wander``: displacement at which each tile is read (``seaglint.sea.tiles``); empty without wander. ``readings``: how the
    heights of each are read between lattice points; linearly where their share is small. ``oblique``: the waves are a mean
    (:meth:`averaged`), which need not lie evenly on both sides of the wind. ``bound``: wavenumber up to which the waves of each tile have
    bound waves [rad m⁻¹]; 0 without.
    """

    spectrum: DirectionalSpectrum
    tiles: tuple[Tile, ...]
    seed: int
    wander: tuple[Wander, ...]
    readings: tuple[Reading, ...]
    oblique: bool
    bound: tuple[float, ...]
    _lattices: tuple[_Lattice, ...]
    _amplitudes: tuple[_Amplitudes, ...]
    _averages: tuple[_Average, ...] = ()  # of the mean of a sea with bound waves: these belong to the waves before the mean

    @classmethod
    def create(
        cls, spectrum: DirectionalSpectrum, tiles: Sequence[Tile], seed: int, *, wander: bool = False, bound: float = 0.0
    ) -> WaveField:
        """Plan tiles for a spectrum and draw the amplitudes of each from ``stream(seed, "waves", tile index)``.

        With ``wander`` the sea does not repeat with the periods of its tiles. Waves of the longest tile up to the wavenumber ``bound``
        [rad m⁻¹] have bound waves, as far as the tile samples these four times.

        Raises
        ------
        DomainError
            If a tile is too short for the longest waves of its band, or bands overlap.
        """
        require_bands(spectrum, tiles)
        lattices = tuple(_lattice_waves(spectrum, tile) for tile in tiles)
        wanders = _wander(tiles, seed) if wander else ()
        longest = min((tile.k_min for tile in tiles), default=0.0)
        limits = tuple(bound if tile.k_min == longest else 0.0 for tile in tiles)
        return cls(spectrum, tuple(tiles), seed, wanders, _readings(tiles, lattices), False, limits, lattices, _draw(lattices, seed))

    def reseeded(self, seed: int) -> WaveField:
        """Return another realisation of the same sea, as :meth:`create` would make it, without integrating the spectrum again."""
        wander = _wander(self.tiles, seed) if self.wander else ()
        sources = _draw([average.lattice for average in self._averages], seed)
        averages = tuple(replace(a, amplitudes=drawn) for a, drawn in zip(self._averages, sources, strict=True))
        return replace(self, seed=seed, wander=wander, _amplitudes=_draw(self._lattices, seed), _averages=averages)

    def linear(self) -> WaveField:
        """Return the free waves alone, without bound waves."""
        return replace(self, bound=(0.0,) * len(self.tiles), _averages=())

    def only(self, tile: int) -> WaveField:
        """Return the waves of one tile alone."""
        one = slice(tile, tile + 1)
        return replace(
            self,
            tiles=self.tiles[one],
            wander=self.wander[one],
            readings=self.readings[one],
            bound=self.bound[one],
            _lattices=self._lattices[one],
            _amplitudes=self._amplitudes[one],
            _averages=self._averages[one],
        )

    def halved(self) -> WaveField:
        """Return the field without the upper half of each tile's wavenumbers, on half as many points a side."""
        tiles = tuple(replace(tile, n=tile.n // 2, k_max=0.5 * tile.k_max) for tile in self.tiles)
        # frequencies and amplitudes are copied, so that a level moves exactly as the full sea
        cut = [_low_pass(*parts) for parts in zip(tiles, self._lattices, self._amplitudes, strict=True)]
        sources = [_low_pass(tile, a.lattice, a.amplitudes) for tile, a in zip(tiles, self._averages, strict=False)]
        averages = tuple(_Average(*source, a.lines) for source, a in zip(sources, self._averages, strict=True))
        return replace(self, tiles=tiles, _lattices=tuple(c[0] for c in cut), _amplitudes=tuple(c[1] for c in cut), _averages=averages)

    def averaged(self, width: float, azimuth: float) -> WaveField:
        """Return the field as a mean over a ``width`` [m] at right angles to the direction of an azimuth [rad].

        A wave of the wavenumber ``q`` at right angles to it is multiplied by ``sin(q width/2)/(q width/2)``.
        """
        across = (np.cos(azimuth) * width, -np.sin(azimuth) * width)
        # frequencies are copied, so that an averaged sea moves exactly as the full one
        cut = [_mean_over(across, *parts) for parts in zip(self._lattices, self._amplitudes, strict=True)]
        averages = self._averages
        if any(self.bound):
            # the mean of bound waves is not the bound waves of a mean
            first = averages or [_Average(*parts, ()) for parts in zip(self._lattices, self._amplitudes, strict=True)]
            averages = tuple(replace(a, lines=(*a.lines, across)) for a in first)
        return replace(self, oblique=True, _lattices=tuple(c[0] for c in cut), _amplitudes=tuple(c[1] for c in cut), _averages=averages)

    def refined(self, times: int) -> WaveField:
        """Return the same sea on lattices of ``times`` as many points a side, for readers that interpolate without its splines."""
        return replace(self, tiles=tuple(replace(tile, n=times * tile.n) for tile in self.tiles))

    def surfaces(self, time: float, workers: int = 1) -> tuple[SurfaceArray, ...]:
        """Height and slopes of every tile at its lattice points at one time.

        Parameters
        ----------
        time : float
            Time since the start [s].
        workers : int
            Threads of the transforms; the bytes do not depend on them.

        Returns
        -------
        tuple of ndarray
            Per tile an array (n, n, 3) of float32: height [m], slope towards east, slope towards north [1], at [iy, ix] with
            ``u = ix spacing``, ``v = iy spacing`` (see ``Tile``). They are samples of the sea: linear interpolation between them
            loses variance.
        """
        out = []
        for tile, (east, north), heights in self._evolved(time):
            derivatives = np.stack([np.ones_like(east), 1j * east, 1j * north], axis=-1)
            out.append(_transformed(tile, (heights[..., None] * derivatives).astype(np.complex64), workers))
        return tuple(out)

    def coefficients(self, time: float) -> tuple[SurfaceArray, ...]:
        """Lattices from which readers get heights and slopes between the points with the variance of the spectrum.

        Parameters
        ----------
        time : float
            As of :meth:`surfaces`.

        Returns
        -------
        tuple of ndarray
            Per tile an array of float32 [m]: (n, n, 1) coefficients of a cubic B-spline, of height and, by its derivatives, slopes; or
            (n, n, 2) heights to be read linearly, and coefficients for the slopes. Heights have the spectrum's variance exactly, averaged
            over a cell, slopes to 0.15 % of their shortest waves'.
        """
        out = []
        for (tile, _, heights), reading in zip(self._evolved(time), self.readings, strict=True):
            out.append(_transformed(tile, heights[..., None] * _gains(tile, reading, heights.shape[1] - 1), 1))
        return tuple(out)

    def splines(self, time: float) -> tuple[SurfaceArray, ...]:
        """Coefficients (n, n) of a cubic B-spline of every tile at one time [m], whatever the renderer reads."""
        return tuple(lattice[..., -1] for lattice in self.coefficients(time))

    def steepness(self, tile: int, time: float) -> SurfaceArray:
        """Steepness ``sum |k| zeta_k`` of the free waves of a tile at its lattice points at one time [1, (n, n)]: high on steep crests."""
        (one, (east, north), heights), *_ = self.only(tile).linear()._evolved(time)
        steep = heights * np.hypot(east, north).astype(np.float32)
        return np.asarray(_transformed(one, steep[..., None], 1)[..., 0])

    def steepness_deviation(self, tile: int) -> float:
        """Ensemble standard deviation of :meth:`steepness` [1]: that of the slopes of the tile's waves in all directions together."""
        return float(np.sqrt(sum(self.only(tile).resolved_mss())))

    def direction(self, tile: int) -> tuple[float, float]:
        """Mean direction in which the waves of a tile travel, weighted with their slope variance: unit vector [1] towards east and north.

        It is the wind's where waves of opposite directions balance.
        """
        waves = self._lattices[tile]
        energy = (waves.variance - waves.opposite) * np.hypot(waves.k_east, waves.k_north)
        east, north = float(np.sum(energy * waves.k_east)), float(np.sum(energy * waves.k_north))
        length, whole = np.hypot(east, north), sum(self.only(tile).resolved_mss())
        if length < 0.05 * whole:
            return float(np.sin(self.spectrum.wind_to_azimuth)), float(np.cos(self.spectrum.wind_to_azimuth))
        return east / length, north / length

    def _evolved(self, time: float) -> Iterator[tuple[Tile, tuple[FloatArray, FloatArray], ComplexArray]]:
        """Tiles, wave vectors (east, north) of their lattices and the Fourier coefficients of their heights at one time."""
        if not np.isfinite(time):
            raise DomainError(f"time = {time:g} s must be finite", name="time", value=time, allowed="finite")
        for i, (tile, waves, amplitudes) in enumerate(zip(self.tiles, self._lattices, self._amplitudes, strict=True)):
            heights = np.empty(amplitudes.forward.shape, np.complex64)
            _evolve(amplitudes.forward, amplitudes.backward, waves.frequency, float(time), heights)
            vectors = waves.k_east, waves.k_north
            if self.bound[i] > 0.0:
                vectors, heights = self._with_bound(i, time, heights)
            yield tile, vectors, heights

    def _with_bound(self, i: int, time: float, heights: ComplexArray) -> tuple[tuple[FloatArray, FloatArray], ComplexArray]:
        """Wave vectors and coefficients of a tile's heights with its bound waves, whose wavenumbers are up to twice as large."""
        tile, carried = self.tiles[i], heights.shape[1] - 1
        average = self._averages[i] if self._averages else _Average(self._lattices[i], self._amplitudes[i], ())
        # bound waves, too, have SAMPLES_PER_WAVE lattice points: waves of half that wavenumber are the shortest that have them
        limit = min(self.bound[i], 0.5 * tile.sampled)
        second = _bound_waves(average.lattice, average.amplitudes, tile.step, limit, float(time))
        widest = max(carried, second.shape[1] - 1)
        out = np.zeros((2 * widest + 1, widest + 1), np.complex64)
        q, p = np.meshgrid(*_lattice_numbers(widest), indexing="ij")
        vectors = _to_world(tile, p, q)
        out[_rows_and_columns(second.shape[1] - 1)] = second
        for line in average.lines:
            out *= _share_over(line, *vectors).astype(np.float32)
        out[_rows_and_columns(carried)] += heights
        return vectors, out

    def plane_waves(self) -> tuple[FloatArray, ...]:
        """Return the plane waves of every tile.

        Returns
        -------
        tuple of ndarray
            Per tile (waves, 5): wavenumber towards east and north [rad m⁻¹], angular frequency [rad s⁻¹], real and imaginary part of the
            amplitude a [m] in ``Re a exp[i (k.x - omega t)]``.
        """
        return tuple(_plane_waves(*parts) for parts in zip(self._lattices, self._amplitudes, strict=True))

    @property
    def height_variance(self) -> float:
        """Ensemble variance of the height of all tiles together [m²]."""
        return float(sum(float(waves.variance.sum() + waves.opposite.sum()) for waves in self._lattices))

    @property
    def significant_height(self) -> float:
        """Ensemble significant height of all tiles together [m]."""
        return 4.0 * float(np.sqrt(self.height_variance))

    @property
    def height_excess(self) -> float:
        """Ensemble variance of the height that readers get at lattice points, over that anywhere, less 1: the greatest of any place [1]."""
        parts = zip(self.tiles, self._lattices, self.readings, strict=True)
        return float(sum(_excess(tile, waves, reading) for tile, waves, reading in parts)) / self.height_variance

    def resolved_mss(self) -> tuple[float, float]:
        """Ensemble slope variance along and across the wind of all tiles together [1]; the rest of a slope model is the facets'."""
        up = cross = 0.0
        for energy, along, across in self._slope_waves():
            up += float(np.sum(energy * along**2))
            cross += float(np.sum(energy * across**2))
        return up, cross

    def band_mss(self, k_min: float, k_max: float) -> tuple[float, float]:
        """Ensemble slope variance along and across the wind of the waves with k_min <= k < k_max [1].

        A lattice wave has the energy of its cell; of a cell cut by an edge of the band its part inside counts.
        """
        up = cross = 0.0
        s, c = np.sin(self.spectrum.wind_to_azimuth), np.cos(self.spectrum.wind_to_azimuth)
        for tile, waves in zip(self.tiles, self._lattices, strict=True):
            low, high = max(tile.k_min, k_min), min(tile.k_max, k_max)
            if low < high:
                q, p = np.meshgrid(*_lattice_numbers(waves.k_east.shape[1] - 1), indexing="ij")
                along, against = _variances(self.spectrum, replace(tile, k_min=low, k_max=high), p, q)
                energy = along + against
                # the lower half of the column u = 0 repeats its upper half
                energy[p.shape[1] :, 0] = 0.0
                up += float(np.sum(energy * (waves.k_east * s + waves.k_north * c) ** 2))
                cross += float(np.sum(energy * (waves.k_east * c - waves.k_north * s) ** 2))
        return up, cross

    def resolved_covariance(self) -> float:
        """Ensemble covariance of the slopes along and to the right of the wind [1].

        Exactly 0 for a spectrum that lies evenly on both sides of the wind: any covariance of its lattices is an error of their sums.
        """
        if self.spectrum.slope_covariance() == 0.0 and not self.oblique:
            return 0.0
        return float(sum(np.sum(energy * along * across) for energy, along, across in self._slope_waves()))

    def _slope_waves(self) -> Iterator[tuple[FloatArray, FloatArray, FloatArray]]:
        """Variances of the waves of every tile, and their wavenumbers along the wind and to the right of it."""
        s, c = np.sin(self.spectrum.wind_to_azimuth), np.cos(self.spectrum.wind_to_azimuth)
        for waves in self._lattices:
            energy = waves.variance + waves.opposite
            yield energy, waves.k_east * s + waves.k_north * c, waves.k_east * c - waves.k_north * s


def _top(tile: Tile) -> int:
    """Largest lattice number that can hold energy: one beyond the band's upper edge, as a cell outside may still reach into the band."""
    return int(np.ceil(tile.k_max / tile.step)) + 1


def _lattice_numbers(top: int) -> tuple[FloatArray, FloatArray]:
    """Lattice numbers up to ``top``: q of rows in FFT order, p of columns."""
    return np.concatenate([np.arange(top + 1), np.arange(-top, 0)]).astype(np.float64), np.arange(top + 1, dtype=np.float64)


def _rows_and_columns(top: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Places of the lattice numbers up to ``top`` in a lattice of at least these numbers."""
    rows = np.concatenate([np.arange(top + 1), np.arange(-top, 0)])
    return rows[:, None], np.arange(top + 1)


def _to_world(tile: Tile, p: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Wave vector (east, north) of lattice numbers along the tile's axes [rad m⁻¹]."""
    c, s = np.cos(tile.rotation) * tile.step, np.sin(tile.rotation) * tile.step
    return np.asarray(c * p - s * q), np.asarray(s * p + c * q)


def _turns(tile: Tile, top: int | None = None) -> tuple[FloatArray, FloatArray]:
    """Phases from one lattice point to the next of the rows and columns of ``_lattice_numbers`` [rad]."""
    q, p = _lattice_numbers(_top(tile) if top is None else top)
    return q * (2.0 * np.pi / tile.n), p * (2.0 * np.pi / tile.n)


@lru_cache(maxsize=16)
def _gains(tile: Tile, reading: Reading, top: int) -> ComplexArray:
    """Factors of the coefficients of a tile's waves (rows, columns, 1 or 2); complex like the coefficients."""
    q, p = _turns(tile, top)
    used: tuple[Reading, ...] = ("cubic",) if reading == "cubic" else ("linear", "cubic")
    return np.stack([np.outer(gain(q, one), gain(p, one)) for one in used], axis=-1).astype(np.complex64)


def _excess(tile: Tile, waves: _Lattice, reading: Reading, coarser: int = 1) -> float:
    """Height variance that readers get at lattice points minus the variance of the waves [m²], on the tile or one of ``coarser`` points."""
    turns = [coarser * turn for turn in _turns(tile)]
    energy = (waves.variance + waves.opposite) * (np.hypot(waves.k_east, waves.k_north) < tile.k_max / coarser)
    # a cubic B-spline has (2 + cos a)/3 of the amplitude at lattice points, per axis
    at_points = 1.0 if reading == "linear" else np.outer(*((2.0 + np.cos(turn)) / 3.0 for turn in turns)) ** 2
    return float(np.sum(energy * (at_points / np.outer(*(read_share(turn, reading) for turn in turns)) - 1.0)))


def _readings(tiles: Sequence[Tile], lattices: Sequence[_Lattice]) -> tuple[Reading, ...]:
    """How the heights of each tile are read: linearly from the finest on, as long as their variance stays even within a cell.

    The lattices of half, a quarter, ... of its points count too, as their shortest waves have four cells as well.
    """
    left = UNEVEN * sum(float(waves.variance.sum() + waves.opposite.sum()) for waves in lattices)
    out: list[Reading] = ["cubic"] * len(tiles)
    for i in sorted(range(len(tiles)), key=lambda i: -tiles[i].k_max):
        left -= max(_excess(tiles[i], lattices[i], "linear", coarser) for coarser in (1, 2, 4, 8))
        if left < 0.0:
            break
        out[i] = "linear"
    return tuple(out)


def _cell_variance(spectrum: DirectionalSpectrum, tile: Tile, p: FloatArray, q: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
    """Integrals of the spectrum at k and at -k over lattice cells, only inside the tile's band [m²]; midpoints, as edges cut cells."""
    offsets = (np.arange(order) + 0.5) / order - 0.5
    along, against = np.zeros(p.shape), np.zeros(p.shape)
    for du in offsets:
        # one row of midpoints of all cells at once; their sums are taken in a fixed order
        east, north = _to_world(tile, p + du, q + offsets[:, None])
        k, azimuth = np.hypot(east, north), np.arctan2(east, north)
        inside = (k >= tile.k_min) & (k < tile.k_max) & (k > 0.0)
        safe = np.where(inside, k, tile.k_max)
        level = np.where(inside, spectrum.omnidirectional(safe) / safe, 0.0)
        both = level * spectrum.spreading(safe, np.stack([azimuth, azimuth + np.pi]))
        for v in range(order):
            along += both[0, v]
            against += both[1, v]
    area = (tile.step / order) ** 2
    return along * area, against * area


def _variances(spectrum: DirectionalSpectrum, tile: Tile, p: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Variances of the lattice waves along k and -k [m²]: fine sums where cells are large against k or cut by an edge of the band."""
    steps = np.hypot(p, q)
    low, high = tile.k_min / tile.step, tile.k_max / tile.step
    in_band = (steps > low - 0.75) & (steps < high + 0.75) & (steps > 0.0)
    # 0.75 exceeds half the diagonal of a cell, so that every cell cut by an edge of the band is integrated
    near = steps <= _NEAR
    edge = (np.abs(steps - low) < 0.75) | (np.abs(steps - high) < 0.75)
    along, against = np.zeros(p.shape), np.zeros(p.shape)
    for cells, order in ((in_band & near, 12), (in_band & ~near & edge, 4), (in_band & ~near & ~edge, 2)):
        along[cells], against[cells] = _cell_variance(spectrum, tile, p[cells], q[cells], order)
    return along, against


def _lattice_waves(spectrum: DirectionalSpectrum, tile: Tile) -> _Lattice:
    """Wave vectors, frequencies and variances of a tile."""
    q, p = np.meshgrid(*_lattice_numbers(_top(tile)), indexing="ij")
    k_east, k_north = _to_world(tile, p, q)
    variance, opposite = _variances(spectrum, tile, p, q)
    repeated = slice(p.shape[1], None)
    variance[repeated, 0] = opposite[repeated, 0] = 0.0
    return _Lattice(k_east, k_north, angular_frequency(np.hypot(k_east, k_north)), variance, opposite)


def _low_pass(tile: Tile, lattice: _Lattice, amplitudes: _Amplitudes) -> tuple[_Lattice, _Amplitudes]:
    """Select the waves of a lattice that a tile with fewer points can carry."""
    inner = _rows_and_columns(_top(tile))
    k_east, k_north = lattice.k_east[inner], lattice.k_north[inner]
    in_band = np.hypot(k_east, k_north) < tile.k_max
    waves = _Lattice(k_east, k_north, lattice.frequency[inner], lattice.variance[inner] * in_band, lattice.opposite[inner] * in_band)
    return waves, _Amplitudes(amplitudes.forward[inner] * in_band, amplitudes.backward[inner] * in_band)


def _mean_over(line: tuple[float, float], lattice: _Lattice, amplitudes: _Amplitudes) -> tuple[_Lattice, _Amplitudes]:
    """Return the waves of a lattice as a mean over a line, given by its extent towards east and north [m]."""
    share = _share_over(line, lattice.k_east, lattice.k_north)
    waves = replace(lattice, variance=lattice.variance * share**2, opposite=lattice.opposite * share**2)
    cut = share.astype(np.float32)
    return waves, _Amplitudes(amplitudes.forward * cut, amplitudes.backward * cut)


@lru_cache(maxsize=4)  # levels of detail that are means of one tile share its bound waves
def _bound_waves(lattice: _Lattice, amplitudes: _Amplitudes, step: float, limit: float, time: float) -> ComplexArray:
    """Coefficients at a time [s] of the bound waves of a tile's waves up to a wavenumber [rad m⁻¹]."""
    inner = _rows_and_columns(min(int(np.ceil(limit / step)), lattice.frequency.shape[1] - 1))
    below = np.hypot(lattice.k_east[inner], lattice.k_north[inner]) < limit
    turn = (np.exp(-1j * lattice.frequency[inner] * time) * below).astype(np.complex64)
    return bound_coefficients(amplitudes.forward[inner] * turn, amplitudes.backward[inner] * turn, step)


def _share_over(line: tuple[float, float], east: FloatArray, north: FloatArray) -> FloatArray:
    """Factor of the amplitudes of waves in their mean over a line, given by its extent towards east and north [m]."""
    return np.asarray(np.sinc((east * line[0] + north * line[1]) / (2.0 * np.pi)))


def _draw(lattices: Sequence[_Lattice], seed: int) -> tuple[_Amplitudes, ...]:
    """Draw the Gaussian amplitudes of every tile."""
    return tuple(_draw_tile(lattice, stream(seed, "waves", i)) for i, lattice in enumerate(lattices))


def _wander(tiles: Sequence[Tile], seed: int) -> tuple[Wander, ...]:
    return tuple(Wander.of(tile, seed, i) for i, tile in enumerate(tiles))


def _draw_tile(lattice: _Lattice, rng: np.random.Generator) -> _Amplitudes:
    """Draw the Gaussian amplitudes of a tile, ``<|a/2|^2> = variance/2``: half of it in the real and half in the imaginary part."""
    draws = rng.standard_normal((4, *lattice.variance.shape))
    forward = 0.5 * np.sqrt(lattice.variance) * (draws[0] + 1j * draws[1])
    backward = 0.5 * np.sqrt(lattice.opposite) * (draws[2] + 1j * draws[3])
    # In the column u = 0 the lower half holds the same waves as the upper one, with k and -k exchanged.
    top = lattice.variance.shape[1] - 1
    # each wave must have one amplitude, whichever of the two entries is read
    forward[:top:-1, 0], backward[:top:-1, 0] = backward[1 : top + 1, 0], forward[1 : top + 1, 0]
    return _Amplitudes(forward.astype(np.complex64), backward.astype(np.complex64))


def _plane_waves(lattice: _Lattice, amplitudes: _Amplitudes) -> FloatArray:
    """Plane waves along k, then those along -k; the lower half of the column u = 0 repeats its upper half."""
    distinct = np.ones(lattice.variance.shape, bool)
    distinct[lattice.variance.shape[1] :, 0] = False
    waves = []
    for sign, half, variance in ((1.0, amplitudes.forward, lattice.variance), (-1.0, amplitudes.backward, lattice.opposite)):
        chosen = distinct & (variance > 0.0)
        a = 2.0 * half[chosen].astype(np.complex128)
        waves.append(
            np.stack([sign * lattice.k_east[chosen], sign * lattice.k_north[chosen], lattice.frequency[chosen], a.real, a.imag], axis=1)
        )
    return np.concatenate(waves)


@njit
def _evolve(forward: ComplexArray, backward: ComplexArray, frequency: FloatArray, time: float, heights: ComplexArray) -> None:
    """Fourier coefficients of the height at one time; phases in float64, as omega t grows large."""
    for j in range(forward.shape[0]):
        for i in range(forward.shape[1]):
            phase = frequency[j, i] * time
            # the sum of a wave and its opposite's conjugate makes the transform real
            turn = complex(np.cos(phase), -np.sin(phase))
            heights[j, i] = forward[j, i] * turn + np.conj(backward[j, i] * turn)


def _transformed(tile: Tile, coefficients: ComplexArray, workers: int) -> SurfaceArray:
    """Interleaved surfaces of Fourier coefficients; the band fills a quarter of the spectrum, so only those columns are transformed."""
    n, (rows, columns, parts) = tile.n, coefficients.shape
    whole = np.zeros((n, columns, parts), dtype=np.complex64)
    whole[:columns], whole[n - rows + columns :] = coefficients[:columns], coefficients[columns:]
    along = scipy.fft.ifft(whole, axis=0, norm="forward", overwrite_x=True, workers=workers)
    return np.asarray(scipy.fft.irfft(along, n=n, axis=1, norm="forward", overwrite_x=True, workers=workers))


@dataclass(frozen=True)
class Level:
    """One level of detail: the tiles of the sea that it contains."""

    parts: tuple[int, ...]  #: Versions of tiles, by their place in ``Detail.parts``, longest waves first.
    shortest_wave: float  #: Length of the shortest wave of the level [m].
    mss: tuple[float, float]  #: Slope variance (up, cross) of its waves [1].
    covariance: float = 0.0  #: Covariance of its slopes along the wind and to the right of it [1].


@dataclass(frozen=True, eq=False)
class Detail:
    """Levels of detail of a sea, finest first, and the versions of its tiles that they consist of.

    The coarsest level still has the energetic waves.
    """

    parts: tuple[WaveField, ...]
    levels: tuple[Level, ...]

    @classmethod
    def calm(cls) -> Detail:
        """Levels of detail of a sea without waves: one empty level."""
        return cls((), (Level((), float("inf"), (0.0, 0.0)),))

    @classmethod
    def of(cls, waves: WaveField, levels: int | None = None) -> Detail:
        """Levels of detail of a sea; ``levels`` limits their number (1: the full sea alone)."""
        longest = longest_wave_number(waves.spectrum)
        parts: list[WaveField] = []
        versions: list[list[int]] = []
        for i, tile in enumerate(waves.tiles):
            version, chain = waves.only(i), []
            least = NARROWEST * max(tile.k_min, longest)
            while True:
                chain.append(len(parts))
                parts.append(version)
                carried = version.tiles[0]
                # a halved tile must keep waves, and a multiple of 4 points
                if 0.5 * carried.k_max < least or carried.n // 2 < SMALLEST or (carried.n // 2) % 4:
                    break
                version = version.halved()
            versions.append(chain)
        chosen = [[chain[0] for chain in versions[: i + 1]] for i in range(len(versions))]
        selections = [
            (*first[:-1], place)  # whole longer tiles, and the last one's versions
            for first, chain in zip(reversed(chosen), reversed(versions), strict=True)
            for place in chain
        ]
        every = cls(tuple(parts), tuple(_level(parts, level) for level in selections[:levels]))
        return every.first(len(every.levels))

    def first(self, levels: int) -> Detail:
        """Return the finest levels alone, with the parts that they need."""
        used = self.levels[:levels]
        used_parts = sorted({p for level in used for p in level.parts})
        place = {p: i for i, p in enumerate(used_parts)}
        return Detail(tuple(self.parts[p] for p in used_parts), tuple(replace(v, parts=tuple(place[p] for p in v.parts)) for v in used))

    def averaged(self, levels: Sequence[int], widths: Sequence[float], azimuth: float) -> Detail:
        """Return levels of this detail, each as a mean over a width at right angles to an azimuth (:meth:`WaveField.averaged`).

        Parameters
        ----------
        levels : sequence of int
            Numbers of the levels; a level may occur with several widths.
        widths : sequence of float
            Their widths [m]; 0 leaves a level as it is.
        azimuth : float
            Direction [rad].
        """
        parts: list[WaveField] = []
        place: dict[tuple[int, float], int] = {}
        out = []
        for number, width in zip(levels, widths, strict=True):
            level, used = self.levels[number], []
            for p in level.parts:
                key = (p, width)
                if key not in place:
                    mean = self.parts[p].averaged(width, azimuth) if width > 0.0 else self.parts[p]
                    if sum(self.parts[p].resolved_mss()) - sum(mean.resolved_mss()) < KEPT * sum(level.mss):
                        mean, key = self.parts[p], (p, 0.0)
                    if key not in place:
                        place[key] = len(parts)
                        parts.append(mean)
                    place[p, width] = place[key]
                used.append(place[key])
            out.append(_level(parts, tuple(used)))
        return Detail(tuple(parts), tuple(out))

    def surfaces(self, time: float) -> tuple[NDArray[np.float32], ...]:
        """Lattices of every part at one time [s], from which heights and slopes are read (:meth:`WaveField.coefficients`)."""
        out: list[SurfaceArray] = [np.empty(0, np.float32)] * len(self.parts)

        def transform(numbers: tuple[int, int]) -> None:
            for i in range(*numbers):
                out[i] = self.parts[i].coefficients(time)[0]

        # parts side by side, as everything but the transforms has one thread
        in_threads(transform, len(out))
        return tuple(out)


def _level(parts: list[WaveField], level: tuple[int, ...]) -> Level:
    mss = np.sum([parts[p].resolved_mss() for p in level], axis=0)
    covariance = sum(parts[p].resolved_covariance() for p in level)
    return Level(level, 2.0 * np.pi / parts[level[-1]].tiles[0].k_max, (float(mss[0]), float(mss[1])), covariance)
