"""Scatterers and absorbers of one atmosphere: LOWTRAN7's own profiles, band laws and phase functions, on part of the spectrum.

From them scattered sunlight is computed line by line (``seaglint.air.scattering.scattered_line``) for any height, direction and Sun; a
table of the radiance itself would need all of them as axes. ``seaglint.air.profile.profile_scattering`` makes them
for any profile and haze, ``seaglint.formats.lowtran.lowtran_sample`` from a run of LOWTRAN7.
"""

from __future__ import annotations

import threading
from collections import deque
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.air.scattering.gas_bands import CONTINUA, GasBands
from seaglint.air.scattering.lowtran_ray import SELF_COLD, WORK_ROWS, Laws, LayerGrid, layer_grid, layers_cold_share
from seaglint.air.scattering.scattered_line import (
    KINDS,
    NO_SUNS,
    SunwardTable,
    apparent_zenith,
    fill_suns,
    line_arc,
    line_points,
    many_amplitudes,
)
from seaglint.base.conventions import FloatArray

AEROSOL_COLUMNS: Final = (7, 12, 13, 14)  #: Numbers of LOWTRAN7 for the aerosols of the four regions.

NO_BAND: Final = -20.0  #: Value that LOWTRAN7 uses as the logarithm of a band's coefficient where there is no band.

#: Numbers of zenith angles of the Sun between which amounts towards it are interpolated, up to ``HIGH_SUN`` and beyond.
SUN_NODES: Final = (6, 10)

HIGH_SUN: Final = float(np.radians(66.0))  #: Zenith angle [rad].

LOWEST_SUN: Final = float(np.radians(88.0))  #: Zenith angle of the Sun up to which amounts are interpolated [rad].

#: Part of the Sun's elevation by which it may be lower at a place in the table, and half that by which it may be higher; beyond, rays are
#: followed one by one.
NEARER: Final = 0.35

_PER_MOLECULE: Final = 1e-20  #: Unit of the water continuum's coefficients: LOWTRAN7 states them per 1e20 molecules per cm2.


_EVEN_PHASES: Final[deque[tuple[FloatArray, FloatArray]]] = deque(maxlen=2)
_LOCK: Final = threading.Lock()


class Segments(NamedTuple):
    """Consecutive bands as in ``Laws``: (column, first, end), their powers, and coefficients of all their channels."""

    place: NDArray[np.int64]
    power: FloatArray
    coefficient: FloatArray


@dataclass(frozen=True, eq=False)
class SpectralLaws:
    """Part of the scattering laws that is the same for all model atmospheres."""

    wavenumber_cm: FloatArray  #: Channels [cm-1, (n,)].
    continuum: FloatArray  #: Coefficients in the order of ``CONTINUA`` [(7, n)].
    gases: GasBands  #: Bands.

    @property
    def columns(self) -> list[int]:
        """LOWTRAN7's numbers of the amounts in the order of ``Laws.density``."""
        return [*AEROSOL_COLUMNS, *CONTINUA, *self.gases.numbers]

    @cached_property
    def segments(self) -> Segments:
        """Bands of all gases for the kernels."""
        bands, before = self.gases.bands, len(AEROSOL_COLUMNS) + len(CONTINUA)
        place = [(before + band.column, band.where.start, band.where.stop) for band in bands]
        return Segments(
            np.array(place, dtype=np.int64).reshape(-1, 3),
            np.array([band.power for band in bands], dtype=np.float64),
            np.concatenate([np.zeros(0), *(band.coefficient for band in bands)]),
        )

    def cut(self, keep: NDArray[np.intp]) -> SpectralLaws:
        """Return the laws of consecutive channels."""
        return SpectralLaws(self.wavenumber_cm[keep], self.continuum[:, keep], self.gases.cut(int(keep[0]), int(keep[-1]) + 1))


@dataclass(frozen=True, eq=False)
class AirLevels:
    """One atmosphere at LOWTRAN7's levels."""

    earth_radius: float  #: Radius of the Earth [km].
    height: FloatArray  #: Heights of the levels [km, (levels,)].
    pressure: FloatArray  #: Pressure [hPa, (levels,)].
    temperature: FloatArray  #: Temperature [K, (levels,)].
    refractivity: FloatArray  #: Refractivity ``n - 1`` [1, (levels,)].
    humidity: FloatArray  #: Relative humidity [%, (levels,)].
    tops: FloatArray  #: Highest levels of the aerosol's regions [km, (4,)].
    density: FloatArray  #: Scaled densities in the order of ``SpectralLaws.columns`` [(columns, levels)].
    cold_kelvin: float = 0.0  #: Temperature of the law by which water's own continuum grows in cold air [K], 0 for LOWTRAN7's.


@dataclass(frozen=True, eq=False)
class AerosolLaws:
    """Aerosols of the four regions on the channels: extinction and absorption per density, both (4, n), and phase functions.

    ``log_phase`` [(KINDS - 1, n, angles)]: logarithm of the phase functions [sr-1] at scattering angles ``angle`` [rad]; between them the
    logarithm is linear, as in LOWTRAN7.
    """

    extinction: FloatArray
    absorption: FloatArray
    angle: FloatArray
    log_phase: FloatArray


@dataclass(frozen=True, eq=False)
class ScatteringAir:
    """Atmosphere that scatters sunlight. Make it with ``of``."""

    spectral: SpectralLaws  #: Continua and bands.
    source: FloatArray  #: Sunlight outside the atmosphere at 1 au [W m-2 per cm-1, (n,)].
    laws: Laws  #: For the kernels.
    _aerosol: AerosolLaws

    @property
    def wavenumber_cm(self) -> FloatArray:
        """Channels [cm-1, (n,)]."""
        return self.spectral.wavenumber_cm

    @classmethod
    def of(cls, spectral: SpectralLaws, levels: AirLevels, aerosol: AerosolLaws, source: FloatArray) -> ScatteringAir:
        """Assemble the air for the kernels."""
        return cls.assembled(spectral, levels, aerosol, source, grid_of(levels))

    @classmethod
    def assembled(
        cls, spectral: SpectralLaws, levels: AirLevels, aerosol: AerosolLaws, source: FloatArray, grid: LayerGrid, finest: float = 0.0
    ) -> ScatteringAir:
        """Assemble the air as ``of``, with a given result of ``grid_of``.

        ``finest``: thickness of the first piece of a line [km]; 0 for LOWTRAN7's layers.
        """
        # Copies, which can be written to: kernels are compiled once for them, wherever the arrays are from.
        density = np.array(levels.density)
        density[SELF_COLD] = 0.0  # kernels derive it from the column before it, by temperature
        laws = Laws(
            float(levels.earth_radius),
            np.array(levels.height),
            np.array(levels.pressure),
            np.array(levels.temperature),
            np.array(levels.refractivity),
            density,
            np.array(levels.humidity),
            np.array(levels.tops),
            np.concatenate([aerosol.extinction, spectral.continuum]),
            aerosol.extinction - aerosol.absorption,
            *spectral.segments,
            grid,
            finest,
            float(levels.cold_kelvin),
        )
        return cls(spectral, source, laws, aerosol)

    def cut(self, grid: slice) -> ScatteringAir:
        """Return the same air on some of its channels."""
        keep = np.arange(self.wavenumber_cm.size)[grid]
        spectral = self.spectral.cut(keep)
        bands = spectral.segments
        aerosol = AerosolLaws(
            self._aerosol.extinction[:, keep], self._aerosol.absorption[:, keep], self._aerosol.angle, self._aerosol.log_phase[:, keep]
        )
        laws = self.laws._replace(
            linear=np.ascontiguousarray(self.laws.linear[:, keep]),
            scattering=np.ascontiguousarray(self.laws.scattering[:, keep]),
            segments=bands.place,
            power=bands.power,
            coefficient=bands.coefficient,
        )
        return ScatteringAir(spectral, self.source[keep], laws, aerosol)

    def apparent_zenith(self, zenith: ArrayLike, height: float = 0.0) -> FloatArray:
        """Apparent zenith angle of the Sun at a height [m], from the angle without refraction [rad, (...)]."""
        angles = np.asarray(zenith, dtype=np.float64)
        work = np.zeros((WORK_ROWS, self.laws.density.shape[0]))
        return np.array([apparent_zenith(self.laws, 1e-3 * height, float(z), work) for z in angles.ravel()]).reshape(angles.shape)

    def unrefracted_zenith(self, apparent: float) -> float:
        """Zenith angle without refraction of a Sun at an apparent zenith angle at the sea [rad]."""
        guess = float(apparent)
        for _ in range(40):  # the bending changes slowly with the angle: each step leaves a tenth
            step = apparent - float(self.apparent_zenith(guess))
            guess += step
            if abs(step) < 1e-10:
                break
        return guess

    def arcs(self, height: float, zenith: FloatArray) -> FloatArray:
        """Angles at the Earth's centre [rad, (lines,)] to the ends of lines of sight from a height [m] at zenith angles [rad]."""
        return np.array([line_arc(self.laws, 1e-3 * height, float(z)) for z in zenith])

    def phase(self, angle: ArrayLike) -> FloatArray:
        """Phase functions [sr-1, (..., KINDS, n)] at scattering angles [rad, (...)]."""
        theta, nodes = np.asarray(angle, dtype=np.float64), self._aerosol.angle
        left = np.clip(np.searchsorted(nodes, theta, side="right") - 1, 0, nodes.size - 2)
        fraction = ((theta - nodes[left]) / (nodes[left + 1] - nodes[left]))[..., None, None]
        log = np.moveaxis(self._aerosol.log_phase, -1, 0)
        out = np.empty((*theta.shape, KINDS, self.wavenumber_cm.size))
        # logarithms are linear between the angles of the table, as in LOWTRAN7
        out[..., : KINDS - 1, :] = np.exp((1.0 - fraction) * log[left] + fraction * log[left + 1])
        out[..., KINDS - 1, :] = molecular_phase(theta)[..., None]
        return out

    def even_phase(self, count: int) -> FloatArray:
        """Phase functions [sr-1, (count, KINDS, n)] at even steps of the scattering angle from 0 to pi; read-only.

        Different winds share them: their haze scatters with the same phase functions, in other shares.
        """
        with _LOCK:
            for log_phase, table in _EVEN_PHASES:
                # the same array, not an equal one: hazes of other winds share it
                if log_phase is self._aerosol.log_phase and len(table) == count:
                    return table
        table = self.phase(np.linspace(0.0, np.pi, count))
        table.flags.writeable = False
        with _LOCK:
            _EVEN_PHASES.appendleft((self._aerosol.log_phase, table))
        return table

    def amplitudes(self, height: float, lines: FloatArray, *, tabulated: bool = False) -> tuple[FloatArray, FloatArray]:
        """Amplitudes ``J_c`` of lines of sight from a height [m]: [1, (lines, KINDS, n)], and the arcs to their ends [rad, (lines,)].

        Parameters
        ----------
        height : float
            Height of the sensor [m].
        lines : ndarray
            Zenith angle, azimuth from the Sun, and the Sun's zenith angle without refraction, at the sensor [rad, (lines, 3)].
        tabulated : bool
            In continuous air interpolate the amounts towards the Sun over its zenith angle, within 4e-6 of the amplitudes: most of the
            time is spent on them, and many lines from one height pass the same heights.
        """
        from seaglint.base.jit import in_threads

        out, arc = np.empty((len(lines), KINDS, self.wavenumber_cm.size)), np.empty(len(lines))
        order = np.argsort(lines[:, 0], kind="stable")  # lines at one zenith angle are traced once
        where = np.ascontiguousarray(lines[order], dtype=np.float64)
        table = self._suns(1e-3 * height, where) if tabulated and self.laws.finest > 0.0 else NO_SUNS
        in_threads(lambda part: many_amplitudes(self.laws, 1e-3 * height, where, part, table, out, arc), len(lines))
        back = np.argsort(order)
        return out[back], arc[back]

    def _suns(self, z: float, lines: FloatArray) -> SunwardTable:
        """Table of the amounts towards the Sun at the points of the lines from a height [km]; empty for a Sun that is too low."""
        # the line nearest to the horizontal reaches farthest, and sets the range of Suns
        grazing = lines[np.argmin(np.abs(lines[:, 0] - 0.5 * np.pi)), 0]
        heights, arcs = line_points(self.laws, z, float(grazing))
        reach = float(arcs.max())
        least, most = float(lines[:, 2].min()), float(lines[:, 2].max())
        if most > LOWEST_SUN:
            return NO_SUNS
        near = NEARER * (0.5 * np.pi - most)
        first, last = max(least - min(reach, 2.0 * near), 0.0), most + min(reach, near)
        count = SUN_NODES[last > HIGH_SUN]
        # Chebyshev points: their interpolation matrix is well conditioned, and errors stay even over the interval
        x = np.cos(np.pi * (np.arange(count) + 0.5) / count)
        values = np.empty((heights.size, count, self.laws.density.shape[0]))
        fill_suns(self.laws, np.array(heights), 0.5 * (first + last) + 0.5 * (last - first) * x, values)
        inverse = np.linalg.inv(np.polynomial.chebyshev.chebvander(x, count - 1))
        return SunwardTable(np.array(heights), first, last, np.ascontiguousarray(np.einsum("mn,jnk->jmk", inverse, values)))


def grid_of(levels: AirLevels) -> LayerGrid:
    """Quadrature of the atmosphere's whole layers."""
    cold = layers_cold_share(levels.pressure, levels.temperature, levels.cold_kelvin)
    return layer_grid(float(levels.earth_radius), levels.height, levels.refractivity, cold, levels.density)


def molecular_phase(angle: ArrayLike) -> FloatArray:
    """Phase function of molecules with a depolarisation of 0.0279 [sr-1], as in LOWTRAN7.

    >>> round(float(molecular_phase(0.0)), 5)
    0.11772
    """
    return np.asarray(0.06050402 + 0.0572197 * np.cos(np.asarray(angle, dtype=np.float64)) ** 2)


def scattering_angle(zenith: ArrayLike, azimuth_from_sun: ArrayLike, solar_zenith: ArrayLike) -> FloatArray:
    """Scattering angle of sunlight in a line of sight [rad]: the angle between the directions to the Sun and looked into.

    >>> round(float(scattering_angle(1.2, 0.0, 1.0)), 9)
    0.2
    """
    view, sun, azimuth = (np.asarray(a, dtype=np.float64) for a in (zenith, solar_zenith, azimuth_from_sun))
    # by half angles, which keep their digits in the aureole
    square = np.sin(0.5 * (view - sun)) ** 2 + np.sin(view) * np.sin(sun) * np.sin(0.5 * azimuth) ** 2
    return np.asarray(2.0 * np.arcsin(np.sqrt(np.clip(square, 0.0, 1.0))))


def continuum_coefficients(abb: FloatArray) -> FloatArray:
    """Coefficients of ``CONTINUA`` [(7, n)] from LOWTRAN7's ABB [(n, 17)]."""
    per_molecule = {5, 9, 10}
    return np.array([abb[:, k - 1] * (_PER_MOLECULE if k in per_molecule else 1.0) for k in CONTINUA])
