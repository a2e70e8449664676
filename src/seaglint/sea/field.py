"""Synthesis of a moving sea: Gaussian waves of a directional spectrum on a few periodic tiles.

::

    zeta(x, t) = Re sum_k a_k exp[i (k.x - omega t)],     <|a_k|^2> = 2 int_cell Psi dk,     omega by :mod:`seaglint.sea.dispersion`

Every tile carries its own band of wavenumbers, so that the sum over tiles has the whole spectrum once. Lengths are incommensurate and
axes turned against each other; where the sea is not to show the period of any tile, tiles wander (:mod:`seaglint.sea.wander`). The
energy of a lattice wave is the integral of the spectrum over its cell, not a sample of it: heights and slopes have the variance of the
spectrum for any grid size and tile length.

A frame is a function of (amplitudes, time) alone; amplitudes are a function of (spectrum, tiles, seed) alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
import scipy.fft
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import njit
from seaglint.base.random import stream
from seaglint.sea.dispersion import angular_frequency
from seaglint.sea.spectra.directional import DirectionalSpectrum
from seaglint.sea.tiles import Tile, require_bands
from seaglint.sea.wander import Wander

SurfaceArray = NDArray[np.float32]
ComplexArray = NDArray[np.complex64]

_NEAR: Final = 24  # lattice steps from the origin within which cells are integrated finely


@dataclass(frozen=True, eq=False)
class _Lattice:
    """Waves that a tile can carry: rows are v wavenumbers in FFT order, columns u wavenumbers from 0 up.

    ``variance`` and ``opposite`` are the height variances of the waves travelling along k and along -k [m²]. The column u = 0 holds
    k and -k both: its lower half has no waves of its own.
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
class WaveField:
    """Moving sea, synthesised on periodic tiles. Make it with :meth:`create`.

    ``wander``: by how much each tile is read aside (:mod:`seaglint.sea.wander`); empty where tiles lie still.
    """

    spectrum: DirectionalSpectrum
    tiles: tuple[Tile, ...]
    seed: int
    wander: tuple[Wander, ...]
    _lattices: tuple[_Lattice, ...]
    _amplitudes: tuple[_Amplitudes, ...]

    @classmethod
    def create(cls, spectrum: DirectionalSpectrum, tiles: Sequence[Tile], seed: int, *, wander: bool = False) -> WaveField:
        """Plan tiles for a spectrum and draw the amplitudes of each from ``stream(seed, "waves", tile index)``.

        With ``wander`` the sea does not repeat with the periods of its tiles.

        Raises
        ------
        DomainError
            If a tile is too short for the longest waves of its band, or bands overlap.
        """
        require_bands(spectrum, tiles)
        lattices = tuple(_lattice_waves(spectrum, tile) for tile in tiles)
        return cls(spectrum, tuple(tiles), seed, _wander(tiles, seed) if wander else (), lattices, _draw(lattices, seed))

    def reseeded(self, seed: int) -> WaveField:
        """Return another realisation of the same sea, as :meth:`create` would make it, without integrating the spectrum again."""
        wander = _wander(self.tiles, seed) if self.wander else ()
        return replace(self, seed=seed, wander=wander, _amplitudes=_draw(self._lattices, seed))

    def only(self, tile: int) -> WaveField:
        """Return the waves of one tile alone."""
        one = slice(tile, tile + 1)
        return replace(
            self, tiles=self.tiles[one], wander=self.wander[one], _lattices=self._lattices[one], _amplitudes=self._amplitudes[one]
        )

    def halved(self) -> WaveField:
        """Return the field without the upper half of each tile's wavenumbers, on half as many points a side."""
        tiles = tuple(replace(tile, n=tile.n // 2, k_max=0.5 * tile.k_max) for tile in self.tiles)
        cut = [_low_pass(*parts) for parts in zip(tiles, self._lattices, self._amplitudes, strict=True)]
        return replace(self, tiles=tiles, _lattices=tuple(c[0] for c in cut), _amplitudes=tuple(c[1] for c in cut))

    def surfaces(self, time: float, workers: int = 1) -> tuple[SurfaceArray, ...]:
        """Height and slopes of every tile at one time.

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
            ``u = ix spacing``, ``v = iy spacing`` (see :class:`Tile`).
        """
        if not np.isfinite(time):
            raise DomainError(f"time = {time:g} s must be finite", name="time", value=time, allowed="finite")
        parts = zip(self.tiles, self._lattices, self._amplitudes, strict=True)
        return tuple(_surface(tile, lattice, amplitudes, time, workers) for tile, lattice, amplitudes in parts)

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

    def resolved_mss(self, interpolation: Literal["bilinear", "none"] = "bilinear") -> tuple[float, float]:
        """Ensemble slope variance along and across the wind as a sampler obtains it, interpolated bilinearly [1].

        Bilinear interpolation between lattice points keeps ``(2 + cos k_u d)/3 (2 + cos k_v d)/3`` of a wave's variance, averaged
        over positions; the facets must be given what it loses.

        Parameters
        ----------
        interpolation : "bilinear" or "none"
            Interpolation of slopes between lattice points.

        Returns
        -------
        tuple of float
            Slope variance (up, cross) of all tiles together [1].
        """
        up = cross = 0.0
        for energy, along, across in self._slope_parts(interpolation):
            up += float(np.sum(energy * along**2))
            cross += float(np.sum(energy * across**2))
        return up, cross

    def resolved_covariance(self) -> float:
        """Ensemble covariance of the slopes along and to the right of the wind as a sampler obtains them, interpolated bilinearly [1].

        Exactly 0 for a spectrum that lies evenly on both sides of the wind: what its lattices show is the error of their sums.
        """
        if self.spectrum.slope_covariance() == 0.0:
            return 0.0
        return float(sum(np.sum(energy * along * across) for energy, along, across in self._slope_parts("bilinear")))

    def _slope_parts(self, interpolation: Literal["bilinear", "none"]) -> Iterator[tuple[FloatArray, FloatArray, FloatArray]]:
        """Variances of the waves of every tile, and their wavenumbers along the wind and to the right of it."""
        s, c = np.sin(self.spectrum.wind_to_azimuth), np.cos(self.spectrum.wind_to_azimuth)
        for tile, waves in zip(self.tiles, self._lattices, strict=True):
            energy = waves.variance + waves.opposite
            if interpolation == "bilinear":
                energy = energy * _bilinear_share(tile)
            yield energy, waves.k_east * s + waves.k_north * c, waves.k_east * c - waves.k_north * s


def _lattice_numbers(tile: Tile) -> tuple[FloatArray, FloatArray]:
    """Lattice numbers (q of rows in FFT order, p of columns) that can hold energy: up to one beyond the band's upper edge."""
    top = int(np.ceil(tile.k_max / tile.step)) + 1
    return np.concatenate([np.arange(top + 1), np.arange(-top, 0)]).astype(np.float64), np.arange(top + 1, dtype=np.float64)


def _to_world(tile: Tile, p: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Wave vector (east, north) of lattice numbers along the tile's axes [rad m⁻¹]."""
    c, s = np.cos(tile.rotation) * tile.step, np.sin(tile.rotation) * tile.step
    return np.asarray(c * p - s * q), np.asarray(s * p + c * q)


def _bilinear_share(tile: Tile) -> FloatArray:
    q, p = _lattice_numbers(tile)
    turn = 2.0 * np.pi / tile.n
    return np.asarray(np.outer(2.0 + np.cos(turn * q), 2.0 + np.cos(turn * p)) / 9.0)


def _cell_variance(spectrum: DirectionalSpectrum, tile: Tile, p: FloatArray, q: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
    """Integrals of the spectrum at k and at -k over lattice cells, only inside the tile's band [m²]; midpoints, as edges cut cells."""
    offsets = (np.arange(order) + 0.5) / order - 0.5
    along, against = np.zeros(p.shape), np.zeros(p.shape)
    for du in offsets:
        for dv in offsets:
            east, north = _to_world(tile, p + du, q + dv)
            k, azimuth = np.hypot(east, north), np.arctan2(east, north)
            inside = (k >= tile.k_min) & (k < tile.k_max) & (k > 0.0)
            safe = np.where(inside, k, tile.k_max)
            level = np.where(inside, spectrum.omnidirectional(safe) / safe, 0.0)
            along += level * spectrum.spreading(safe, azimuth)
            against += level * spectrum.spreading(safe, azimuth + np.pi)
    area = (tile.step / order) ** 2
    return along * area, against * area


def _variances(spectrum: DirectionalSpectrum, tile: Tile, p: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Variances of the lattice waves along k and -k [m²]: fine sums where cells are large against k or cut by an edge of the band."""
    steps = np.hypot(p, q)
    low, high = tile.k_min / tile.step, tile.k_max / tile.step
    held = (steps > low - 0.75) & (steps < high + 0.75) & (steps > 0.0)
    near = steps <= _NEAR
    edge = (np.abs(steps - low) < 0.75) | (np.abs(steps - high) < 0.75)
    along, against = np.zeros(p.shape), np.zeros(p.shape)
    for cells, order in ((held & near, 12), (held & ~near & edge, 4), (held & ~near & ~edge, 2)):
        along[cells], against[cells] = _cell_variance(spectrum, tile, p[cells], q[cells], order)
    return along, against


def _lattice_waves(spectrum: DirectionalSpectrum, tile: Tile) -> _Lattice:
    """Wave vectors, frequencies and variances of a tile."""
    q, p = np.meshgrid(*_lattice_numbers(tile), indexing="ij")
    k_east, k_north = _to_world(tile, p, q)
    variance, opposite = _variances(spectrum, tile, p, q)
    repeated = slice(p.shape[1], None)
    variance[repeated, 0] = opposite[repeated, 0] = 0.0
    return _Lattice(k_east, k_north, angular_frequency(np.hypot(k_east, k_north)), variance, opposite)


def _low_pass(tile: Tile, lattice: _Lattice, amplitudes: _Amplitudes) -> tuple[_Lattice, _Amplitudes]:
    """Select the waves of a lattice that a tile with fewer points can carry."""
    top = int(np.ceil(tile.k_max / tile.step)) + 1
    rows = np.concatenate([np.arange(top + 1), np.arange(-top, 0)])
    inner = np.ix_(rows, np.arange(top + 1))
    k_east, k_north = lattice.k_east[inner], lattice.k_north[inner]
    held = np.hypot(k_east, k_north) < tile.k_max
    waves = _Lattice(k_east, k_north, lattice.frequency[inner], lattice.variance[inner] * held, lattice.opposite[inner] * held)
    return waves, _Amplitudes(amplitudes.forward[inner] * held, amplitudes.backward[inner] * held)


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
    # In the column u = 0 the lower half holds the same waves as the upper one, seen from the other side.
    top = lattice.variance.shape[1] - 1
    forward[:top:-1, 0], backward[:top:-1, 0] = backward[1 : top + 1, 0], forward[1 : top + 1, 0]
    return _Amplitudes(forward.astype(np.complex64), backward.astype(np.complex64))


def _plane_waves(lattice: _Lattice, amplitudes: _Amplitudes) -> FloatArray:
    """Plane waves along k, then those along -k; the lower half of the column u = 0 repeats its upper half."""
    own = np.ones(lattice.variance.shape, bool)
    own[lattice.variance.shape[1] :, 0] = False
    waves = []
    for sign, half, variance in ((1.0, amplitudes.forward, lattice.variance), (-1.0, amplitudes.backward, lattice.opposite)):
        held = own & (variance > 0.0)
        a = 2.0 * half[held].astype(np.complex128)
        waves.append(np.stack([sign * lattice.k_east[held], sign * lattice.k_north[held], lattice.frequency[held], a.real, a.imag], axis=1))
    return np.concatenate(waves)


@njit
def _evolve(
    forward: ComplexArray,
    backward: ComplexArray,
    frequency: FloatArray,
    k_east: FloatArray,
    k_north: FloatArray,
    time: float,
    out: ComplexArray,
) -> None:
    """Fourier coefficients of height and slopes at one time; phases in float64, as omega t grows large."""
    rows, columns = forward.shape
    top = columns - 1
    n = out.shape[0]
    for j in range(rows):
        row = j if j <= top else n - rows + j
        for i in range(columns):
            phase = frequency[j, i] * time
            turn = complex(np.cos(phase), -np.sin(phase))
            height = forward[j, i] * turn + np.conj(backward[j, i] * turn)
            out[row, i, 0] = height
            out[row, i, 1] = complex(0.0, k_east[j, i]) * height
            out[row, i, 2] = complex(0.0, k_north[j, i]) * height


def _surface(tile: Tile, lattice: _Lattice, amplitudes: _Amplitudes, time: float, workers: int) -> SurfaceArray:
    """Interleaved height and slopes; the band fills a quarter of the spectrum, so only those columns are transformed."""
    n = tile.n
    coefficients = np.zeros((n, amplitudes.forward.shape[1], 3), dtype=np.complex64)
    _evolve(amplitudes.forward, amplitudes.backward, lattice.frequency, lattice.k_east, lattice.k_north, float(time), coefficients)
    columns = scipy.fft.ifft(coefficients, axis=0, norm="forward", overwrite_x=True, workers=workers)
    return np.asarray(scipy.fft.irfft(columns, n=n, axis=1, norm="forward", overwrite_x=True, workers=workers))
