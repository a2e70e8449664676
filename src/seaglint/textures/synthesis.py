"""Exact samples of periodic Gaussian fields by a transform, and products of a slow and a fast field.

Waves of a torus are independent: complex Gaussian amplitudes with the variances of the spectral density, transformed back, are a sample of
the field without any approximation, and periodic in rows, columns and time: frame N is frame 0.

The product (the source article's Eq. 20, ``L = xi E``) is taken where the fast field is made: ``x = h * (sqrt(V) e)``, e white, V a slow
field of gamma distributed values with mean 1, h the filter whose square is the spectral density. As e is white and independent of V, x has
exactly the spectrum of the Gaussian field. Unlike in the Gaussian field calm and rough patches alternate, so that its fine structure has
long tails.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from seaglint.base import random
from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.free_form import JsonObject
from seaglint.textures.gauss_markov import GaussMarkov, Offset, half_weights, require_torus
from seaglint.textures.marginals import REACH, Marginal

Field = NDArray[np.float32]

#: Spectral density of a slab, a function of the number of the frequency in time: (rows, columns // 2 + 1).
Density = Callable[[int], FloatArray]


@dataclass(frozen=True)
class Modulation:
    """Slow field of gamma distributed power that multiplies a fast field.

    Raises
    ------
    DomainError
        Numbers that are not above 0.
    """

    shape: float  #: Shape of the gamma distribution [1]: variance over squared mean is its inverse.
    #: Distances at which the correlation of the Gaussian field behind it, ``exp(-(d / length)²)``, is 1/e [frames, rows, columns].
    lengths: tuple[float, float, float]

    def __post_init__(self) -> None:
        if not all(math.isfinite(v) and v > 0.0 for v in (self.shape, *self.lengths)):
            raise DomainError(f"modulation of shape {self.shape:g} and lengths {self.lengths}: give numbers above 0")

    def to_dict(self) -> JsonObject:
        """Return the modulation as values for JSON."""
        return {"shape": self.shape, "lengths": list(self.lengths)}

    @classmethod
    def from_dict(cls, held: Mapping[str, Any]) -> Modulation:
        """Read the output of ``to_dict``."""
        t, y, x = map(float, held["lengths"])
        return cls(float(held["shape"]), (t, y, x))


def gaussian(shape: Sequence[int], density: Density, seed: int, purpose: str = "texture") -> Field:
    """Sample of a Gaussian field with mean 0 on a torus [(frames, rows, columns)], float32.

    ``x(s) = sum_k sqrt(S(k) / N) g(k) exp(i k s)`` with white complex Gaussian g of variance 1, ``g(-k) = g(k)*``, over N pixels.

    Parameters
    ----------
    shape : (int, int, int)
        Shape of the torus.
    density : callable
        ``density(k)`` is the spectral density at the frequency number k in time [u², (rows, columns // 2 + 1)].
    seed, purpose : int, str
        Key of the random stream; each frequency in time has its own, so that threads change no byte.

    Returns
    -------
    ndarray
        The sample [u, (frames, rows, columns)].

    Notes
    -----
    Memory: the spectrum and the field, 8 bytes a pixel together at the end.
    """
    from scipy.fft import irfftn

    frames, rows, columns = shape
    spectrum = np.empty((frames, rows, columns // 2 + 1), np.complex64)
    # Real and imaginary part share the variance of a wave; irfftn divides by the number of pixels.
    scale = math.sqrt(0.5 * frames * rows * columns)
    # Of the waves that are their own mirror image along x the transform takes the real part alone: half of the variance of white noise.
    twice = np.ones(columns // 2 + 1)
    twice[0] = math.sqrt(2.0)
    if columns % 2 == 0:
        twice[-1] = math.sqrt(2.0)

    def fill(k: int) -> None:
        amplitude = (scale * twice * np.sqrt(density(k))).astype(np.float32)
        noise = random.stream(seed, purpose, k).standard_normal((rows, columns // 2 + 1, 2), dtype=np.float32)
        noise *= amplitude[:, :, None]
        spectrum[k] = noise.view(np.complex64)[:, :, 0]

    _each(fill, frames)
    return np.asarray(irfftn(spectrum, s=tuple(shape), axes=(0, 1, 2), overwrite_x=True, workers=_threads()), np.float32)


def _threads() -> int:
    return int(numba.get_num_threads())


def _each(work: Callable[[int], None], count: int) -> None:
    if _threads() == 1:
        for k in range(count):
            work(k)
        return
    with ThreadPoolExecutor(_threads()) as pool:
        list(pool.map(work, range(count)))


def density_of(model: GaussMarkov, shape: Sequence[int]) -> Density:
    """Spectral density of a Gauss-Markov field, slab by slab, with the variance 1 on this torus.

    Raises
    ------
    DomainError
        A torus that is too small for the model, or on which it has no variance.
    """
    sides = require_torus(model, shape)
    slabs = _Slabs(model, sides)
    weights = half_weights(sides[2])
    sums = np.zeros(sides[0])

    def add(k: int) -> None:
        sums[k] = float((weights / slabs(k)).sum())

    _each(add, sides[0])
    # Summed exactly, so that the order of the threads changes no byte.
    total = math.fsum(sums) / math.prod(sides)
    return lambda k: 1.0 / (total * slabs(k))


class _Slabs:
    """Symbol of a model at one frequency in time, with few neighbours, each a product of phases."""

    def __init__(self, model: GaussMarkov, shape: Offset) -> None:
        self._shape = shape
        self._waves = 2.0 * np.pi * np.fft.fftfreq(shape[0])
        y, x = np.array([d[1:] for d in model.offsets], float).reshape(-1, 2).T
        self._rows = np.exp(1j * np.outer(2.0 * np.pi * np.fft.fftfreq(shape[1]), y)) * np.array(model.coefficients)
        self._columns = np.exp(1j * np.outer(x, 2.0 * np.pi * np.fft.rfftfreq(shape[2])))
        self._times = np.array([d[0] for d in model.offsets], float)

    def __call__(self, k: int) -> FloatArray:
        turned = self._rows * np.exp(1j * self._waves[k] * self._times)
        # The real part of the product of two complex matrices, by two real ones.
        symbol = 1.0 - 2.0 * (turned.real @ self._columns.real - turned.imag @ self._columns.imag)
        if not symbol.min() > 0.0:
            raise DomainError("the weights leave a wave of this torus without a finite variance; take another size")
        return np.asarray(symbol)


@lru_cache(maxsize=32)
def _power(shape: float) -> Marginal:
    """Gamma distribution with mean 1, with its table."""
    return Marginal("gamma", 0.0, 1.0 / shape, shape)


def slow(modulation: Modulation, shape: Sequence[int], seed: int) -> Field:
    """Sample of the slow field's power, mean 1 [1, (frames, rows, columns)]."""
    rows, columns = np.fft.fftfreq(shape[1]), np.fft.rfftfreq(shape[2])
    t, y, x = modulation.lengths
    across = np.exp(-((np.pi * y * rows) ** 2))[:, None] * np.exp(-((np.pi * x * columns) ** 2))
    along = np.exp(-((np.pi * t * np.fft.fftfreq(shape[0])) ** 2))
    mean = float((across * half_weights(shape[2])).sum()) * float(along.sum()) / math.prod(shape)
    return _power(modulation.shape).transform(gaussian(shape, lambda k: across * (along[k] / mean), seed, "texture modulation"))


def latent(
    model: GaussMarkov, shape: Sequence[int], seed: int, modulation: Modulation | None = None, noise: Marginal | None = None
) -> Field:
    """Sample with mean 0 and variance 1 on a torus [1, (frames, rows, columns)], float32.

    Parameters
    ----------
    model : GaussMarkov
        Its correlations; mean and variance are not used.
    shape : (int, int, int)
        Shape of the torus.
    seed : int
        Seed; the same one gives the same bytes for any number of threads.
    modulation : Modulation, optional
        Slow field; without it rough and calm patches do not alternate.
    noise : Marginal, optional
        Distribution of the white noise from which the field is filtered, of mean 0 and variance 1; Gaussian without.

    Raises
    ------
    DomainError
        A torus that is too small for the model.
    """
    density = density_of(model, shape)
    if modulation is None and noise is None:
        return gaussian(shape, density, seed)
    return filtered(rough(shape, seed, modulation, noise), density)


def rough(shape: Sequence[int], seed: int, modulation: Modulation | None = None, noise: Marginal | None = None) -> Field:
    """White noise of a distribution, times the root of the slow field's power [1, (frames, rows, columns)]."""
    out = np.ones(tuple(shape), np.float32) if modulation is None else np.sqrt(slow(modulation, shape, seed))

    def fill(k: int) -> None:
        drawn = random.stream(seed, "texture noise", k).standard_normal(out.shape[1:], dtype=np.float32)
        out[k] *= drawn if noise is None else np.interp(drawn, *_knots(noise))

    _each(fill, out.shape[0])
    return out


def _knots(noise: Marginal) -> tuple[FloatArray, FloatArray]:
    """Standard normal values and values of a distribution at them, for interpolation."""
    return np.linspace(-REACH, REACH, noise.table.size), noise.table.astype(np.float64)


def filtered(noise: Field, density: Density) -> Field:
    """White noise filtered to a spectral density."""
    return _scaled(noise, lambda k: np.sqrt(density(k)))


def whitened(field: Field, density: Density) -> Field:
    """White noise behind a field of a spectral density: the inverse of ``filtered``."""
    return _scaled(field, lambda k: 1.0 / np.sqrt(density(k)))


def _scaled(field: Field, gain: Density) -> Field:
    from scipy.fft import irfftn, rfftn

    shape = field.shape
    spectrum = rfftn(field, workers=_threads())

    def scale(k: int) -> None:
        spectrum[k] *= gain(k).astype(np.float32)

    _each(scale, shape[0])
    return np.asarray(irfftn(spectrum, s=shape, axes=(0, 1, 2), overwrite_x=True, workers=_threads()), np.float32)
