"""Visible part of a Sun that the horizon cuts, and the sky of a sampled atmosphere.

The sky's brightness temperature is splined over elevation, in pieces between corners.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from seaglint.air.coordinates import ELEVATION_SCALE, elevation_coordinate
from seaglint.base.constants import SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray
from seaglint.base.jit import kernel
from seaglint.optics.blackbody import FIRST_RADIATION, SECOND_RADIATION, planck_wavenumber

COLDEST, HOTTEST = 1.0, 1e5  #: Limits of brightness temperatures [K]; splines overshoot where radiance falls to zero.


@kernel
def visible_part_kernel(elevation: float) -> tuple[float, float]:
    """Fraction of the disc above the horizon, and the height of that part's centroid above the disc's centre [rad].

    ``elevation`` is the centre's [rad]; as it counts within a radius of the horizon alone, its sine serves as well.
    """
    height = elevation / SOLAR_ANGULAR_RADIUS  # of the centre over the horizon, in radii
    if height >= 1.0:
        return 1.0, 0.0
    if height <= -1.0:
        return 0.0, 0.0
    # circular segment of a disc of radius 1: area acos(-h) + h sqrt(1 - h^2), first moment 2/3 (1 - h^2)^1.5
    half_chord = math.sqrt(1.0 - height * height)
    area = math.acos(-height) + height * half_chord
    return area / math.pi, SOLAR_ANGULAR_RADIUS * 2.0 / 3.0 * half_chord * half_chord * half_chord / area


@dataclass(frozen=True, eq=False)
class SkySamples:
    """Thermal sky (k, n) at ``height`` [m] at ascending elevations above the horizontal [rad, (k,)].

    ``dip`` is the depression of the horizon in the underlying calculation [rad]. ``kinks`` are node elevations at or below the
    horizontal where the sky may have corners: a ray that grazes a level of the atmosphere.
    """

    height: float
    elevation: FloatArray
    radiance: FloatArray
    dip: float = 0.0
    kinks: tuple[float, ...] = ()


def brightness_temperature(wavenumber_cm: FloatArray, radiance: FloatArray) -> FloatArray:
    """Brightness temperature by the inverse of Planck's law [K], within ``COLDEST`` ... ``HOTTEST``; 0 gives the coldest."""
    ratio = FIRST_RADIATION * wavenumber_cm**3 / np.maximum(radiance, 1e-280)
    return np.asarray(np.clip(SECOND_RADIATION * wavenumber_cm / np.log1p(ratio), COLDEST, HOTTEST))


def radiance_of(wavenumber_cm: FloatArray, temperature: FloatArray) -> FloatArray:
    """Radiance by Planck's law of splined temperatures, which may overshoot [W m-2 sr-1 per cm-1]."""
    return planck_wavenumber(wavenumber_cm, np.clip(temperature, COLDEST, HOTTEST))


def grazing_coordinate(share: ArrayLike) -> FloatArray:
    """Coordinate 0...1 of a share [1] of an interval between kinks that spreads root-like corners at its ends: ``arccos(1 - 2s)/pi``."""
    return np.asarray(np.arccos(np.clip(1.0 - 2.0 * np.asarray(share, dtype=np.float64), -1.0, 1.0)) / np.pi)


def grazing_share(coordinate: ArrayLike) -> FloatArray:
    """Inverse of ``grazing_coordinate`` [1]."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.asarray(coordinate, dtype=np.float64)))


@dataclass(frozen=True, eq=False)
class _Piece:
    """Spline of the sky between two elevations."""

    low: float
    high: float
    spline: CubicSpline[np.float64]

    def __call__(self, elevation: FloatArray) -> FloatArray:
        return np.asarray(self.spline(self.coordinate(elevation, self.low, self.high)))

    @staticmethod
    def coordinate(elevation: FloatArray, low: float, high: float) -> FloatArray:
        """Return the coordinate of elevation [1]: below the horizontal between grazing rays, above it as in the tables."""
        if high <= 0.0:
            return grazing_coordinate((elevation - low) / (high - low))
        return elevation_coordinate(np.maximum(elevation, 0.0), 0.0) if low >= 0.0 else np.arcsinh(elevation / ELEVATION_SCALE)


@dataclass(frozen=True, eq=False)
class Sky:
    """Brightness temperature against elevation, in pieces."""

    height: float
    dip: float
    lowest: float
    highest: float
    pieces: tuple[_Piece, ...]

    @classmethod
    def of(cls, samples: SkySamples, wavenumber_cm: FloatArray) -> Sky:
        """Sky from splines through samples."""
        e = np.asarray(samples.elevation, dtype=np.float64)
        temperature = brightness_temperature(wavenumber_cm, samples.radiance)
        # corners are nodes, so every piece of the spline has its own smooth part of the sky
        edges = [e[0], *(k for k in sorted(samples.kinks) if e[0] < k < e[-1]), e[-1]]
        pieces = []
        for low, high in itertools.pairwise(edges):
            inside = (e >= low) & (e <= high)
            pieces.append(
                _Piece(float(low), float(high), CubicSpline(_Piece.coordinate(e[inside], low, high), temperature[inside], axis=0))
            )
        return cls(samples.height, samples.dip, float(e[0]), float(e[-1]), tuple(pieces))

    def __call__(self, elevation: FloatArray) -> FloatArray:
        """Brightness temperature at elevations [K, (..., n)]."""
        flat = np.clip(elevation, self.lowest, self.highest).ravel()
        which = np.clip(np.searchsorted([piece.low for piece in self.pieces], flat, side="right") - 1, 0, len(self.pieces) - 1)
        out: FloatArray | None = None
        for index in np.unique(which):
            in_piece = which == index
            values = self.pieces[int(index)](flat[in_piece])
            if out is None:
                out = np.empty((flat.size, values.shape[-1]))
            out[in_piece] = values
        assert out is not None  # callers pass at least one elevation
        return out.reshape(*elevation.shape, -1)
