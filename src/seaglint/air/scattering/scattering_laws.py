"""Scatterers and absorbers of one atmosphere: LOWTRAN7's own profiles, band laws and phase functions, on part of the spectrum.

From them scattered sunlight is computed line by line (:mod:`seaglint.air.scattering.scattered_line`), whatever the height, direction and
Sun: a table of the radiance itself would need all of them as axes. :mod:`seaglint.air.profile.profile_scattering` makes them
for any profile and haze, :mod:`seaglint.files.lowtran.laws_of_run` of a run of LOWTRAN7.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seaglint.air.scattering.gas_bands import gas_bands
from seaglint.air.scattering.lowtran_ray import SELF_COLD, WORK_ROWS, Laws, LayerGrid, layer_grid, layers_cold_share
from seaglint.air.scattering.scattered_line import KINDS, apparent_zenith, line_arc, many_amplitudes
from seaglint.base.conventions import FloatArray

CONTINUA: Final = (6, 4, 5, 9, 10, 11, 8)
"""LOWTRAN7's numbers of absorbers linear in the amount: scattering by molecules, N2, water (296 K, colder, foreign), HNO3, O3."""

AEROSOL_COLUMNS: Final = (7, 12, 13, 14)
"""Numbers of LOWTRAN7 for the aerosols of the four regions."""

NO_BAND: Final = -20.0
"""Value that LOWTRAN7 uses as the logarithm of a band's coefficient where there is no band."""

_PER_MOLECULE: Final = 1e-20
"""Unit of the water continuum's coefficients: LOWTRAN7 states them per 1e20 molecules per cm2."""


class Segments(NamedTuple):
    """Consecutive bands as :class:`Laws` has them: (column, first, end), their powers, and coefficients of all their channels."""

    place: NDArray[np.int64]
    power: FloatArray
    coefficient: FloatArray


@dataclass(frozen=True, eq=False)
class SpectralLaws:
    """Part of the scattering laws that is the same for all model atmospheres.

    Attributes
    ----------
    wavenumber_cm : ndarray
        Channels [cm-1, (n,)].
    continuum : ndarray
        Coefficients in the order of :data:`CONTINUA` [(7, n)].
    band_column, band_power, band_log : ndarray
        Per gas and channel: LOWTRAN7's number of the scaled amount (0: no band), exponent of the amount, and the natural logarithm of
        coefficient to that power [(gases, n)].
    """

    wavenumber_cm: FloatArray
    continuum: FloatArray
    band_column: NDArray[np.int64]
    band_power: FloatArray
    band_log: FloatArray

    @property
    def columns(self) -> list[int]:
        """LOWTRAN7's numbers of the amounts in the order of :attr:`Laws.density`."""
        return [*AEROSOL_COLUMNS, *CONTINUA, *sorted({int(c) for c in np.unique(self.band_column)} - {0})]

    def segments(self) -> Segments:
        """Bands of all gases, gas by gas."""
        place = {number: i for i, number in enumerate(self.columns)}
        bands, power, coefficient = [], [], [np.zeros(0)]
        for gas, first, end in gas_bands(self.band_column, self.band_power):
            bands.append((place[int(self.band_column[gas, first])], first, end))
            power.append(float(self.band_power[gas, first]))
            coefficient.append(np.exp(self.band_log[gas, first:end]))
        return Segments(np.array(bands, dtype=np.int64).reshape(-1, 3), np.array(power, dtype=np.float64), np.concatenate(coefficient))


@dataclass(frozen=True, eq=False)
class AirLevels:
    """One atmosphere at LOWTRAN7's levels.

    Attributes
    ----------
    earth_radius : float
        [km].
    height, pressure, temperature, refractivity, humidity : ndarray
        [km], [hPa], [K], ``n - 1`` [1], relative [%]; (levels,).
    tops : ndarray
        Highest levels of the aerosol's regions [km, (4,)].
    density : ndarray
        Scaled densities in the order of :attr:`SpectralLaws.columns` [(columns, levels)].
    cold_kelvin : float
        Temperature of the law by which water's own continuum grows in cold air [K], 0 for LOWTRAN7's.
    """

    earth_radius: float
    height: FloatArray
    pressure: FloatArray
    temperature: FloatArray
    refractivity: FloatArray
    humidity: FloatArray
    tops: FloatArray
    density: FloatArray
    cold_kelvin: float = 0.0


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
    """Atmosphere that scatters sunlight. Make it with :meth:`of`.

    Attributes
    ----------
    wavenumber_cm : ndarray
        Channels [cm-1, (n,)].
    source : ndarray
        Sunlight outside the atmosphere at 1 au [W m-2 per cm-1, (n,)].
    laws : Laws
        For the kernels.
    """

    wavenumber_cm: FloatArray
    source: FloatArray
    laws: Laws
    _aerosol: AerosolLaws

    @classmethod
    def of(cls, spectral: SpectralLaws, levels: AirLevels, aerosol: AerosolLaws, source: FloatArray) -> ScatteringAir:
        """Assemble the air for the kernels."""
        return cls.assembled(spectral, spectral.segments(), levels, aerosol, source, grid_of(levels))

    @classmethod
    def assembled(
        cls,
        spectral: SpectralLaws,
        bands: Segments,
        levels: AirLevels,
        aerosol: AerosolLaws,
        source: FloatArray,
        grid: LayerGrid,
        finest: float = 0.0,
    ) -> ScatteringAir:
        """Assemble the air as :meth:`of`, with given results of :meth:`SpectralLaws.segments` and :func:`grid_of`.

        ``finest``: thickness of the first piece of a line [km]; 0 for LOWTRAN7's layers.
        """
        # Copies, which can be written to: kernels are compiled once for them, wherever the arrays are from.
        density = np.array(levels.density)
        density[SELF_COLD] = 0.0  # made of the column before it, by temperature
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
            *bands,
            grid,
            finest,
            float(levels.cold_kelvin),
        )
        return cls(spectral.wavenumber_cm, source, laws, aerosol)

    def cut(self, grid: slice) -> ScatteringAir:
        """Return the same air on some of its channels."""
        keep = np.arange(self.wavenumber_cm.size)[grid]
        bands = _cut_segments(Segments(self.laws.segments, self.laws.power, self.laws.coefficient), keep)
        aerosol = AerosolLaws(
            self._aerosol.extinction[:, keep], self._aerosol.absorption[:, keep], self._aerosol.angle, self._aerosol.log_phase[:, keep]
        )
        laws = self.laws._replace(
            linear=np.ascontiguousarray(self.laws.linear[:, keep]),
            scattering=np.ascontiguousarray(self.laws.scattering[:, keep]),
            segments=bands[0],
            power=bands[1],
            coefficient=bands[2],
        )
        return ScatteringAir(self.wavenumber_cm[keep], self.source[keep], laws, aerosol)

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
        part = ((theta - nodes[left]) / (nodes[left + 1] - nodes[left]))[..., None, None]
        log = np.moveaxis(self._aerosol.log_phase, -1, 0)
        out = np.empty((*theta.shape, KINDS, self.wavenumber_cm.size))
        out[..., : KINDS - 1, :] = np.exp((1.0 - part) * log[left] + part * log[left + 1])
        out[..., KINDS - 1, :] = molecular_phase(theta)[..., None]
        return out

    def amplitudes(self, height: float, lines: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Amplitudes ``J_c`` of lines of sight from a height [m]: [1, (lines, KINDS, n)], and the arcs to their ends [rad, (lines,)].

        ``lines`` [rad, (lines, 3)]: zenith angle, azimuth from the Sun, and the Sun's zenith angle without refraction, at the sensor.
        """
        from seaglint.base.jit import in_threads

        out, arc = np.empty((len(lines), KINDS, self.wavenumber_cm.size)), np.empty(len(lines))
        where = np.ascontiguousarray(lines, dtype=np.float64)
        in_threads(lambda part: many_amplitudes(self.laws, 1e-3 * height, where, part, out, arc), len(lines))
        return out, arc


def _cut_segments(bands: Segments, keep: NDArray[np.intp]) -> Segments:
    """Segments of bands restricted to consecutive channels."""
    first, last = int(keep[0]), int(keep[-1]) + 1
    cut, power, coefficient, at = [], [], [np.zeros(0)], 0
    for (column, start, end), exponent in zip(bands.place.tolist(), bands.power.tolist(), strict=True):
        low, high = max(start, first), min(end, last)
        if low < high:
            cut.append((column, low - first, high - first))
            power.append(exponent)
            coefficient.append(bands.coefficient[at + low - start : at + high - start])
        at += end - start
    return Segments(np.array(cut, dtype=np.int64).reshape(-1, 3), np.array(power, dtype=np.float64), np.concatenate(coefficient))


def grid_of(levels: AirLevels) -> LayerGrid:
    """Quadrature of the atmosphere's whole layers."""
    cold = layers_cold_share(levels.pressure, levels.temperature, levels.cold_kelvin)
    return layer_grid(float(levels.earth_radius), levels.height, levels.refractivity, cold, levels.density)


def molecular_phase(angle: ArrayLike) -> FloatArray:
    """Phase function of molecules with a depolarisation of 0.0279 [sr-1], as LOWTRAN7 has it.

    >>> round(float(molecular_phase(0.0)), 5)
    0.11772
    """
    return np.asarray(0.06050402 + 0.0572197 * np.cos(np.asarray(angle, dtype=np.float64)) ** 2)


def scattering_angle(zenith: ArrayLike, azimuth_from_sun: ArrayLike, solar_zenith: ArrayLike) -> FloatArray:
    """Angle between sunlight and the light it becomes in a line of sight [rad]: that between the directions to the Sun and looked into.

    >>> round(float(scattering_angle(1.2, 0.0, 1.0)), 9)
    0.2
    """
    view, sun, azimuth = (np.asarray(a, dtype=np.float64) for a in (zenith, solar_zenith, azimuth_from_sun))
    # by half angles, which keep their digits in the aureole
    square = np.sin(0.5 * (view - sun)) ** 2 + np.sin(view) * np.sin(sun) * np.sin(0.5 * azimuth) ** 2
    return np.asarray(2.0 * np.arcsin(np.sqrt(np.clip(square, 0.0, 1.0))))


def continuum_coefficients(abb: FloatArray) -> FloatArray:
    """Coefficients of :data:`CONTINUA` [(7, n)] from LOWTRAN7's ABB [(n, 17)]."""
    per_molecule = {5, 9, 10}
    return np.array([abb[:, k - 1] * (_PER_MOLECULE if k in per_molecule else 1.0) for k in CONTINUA])
