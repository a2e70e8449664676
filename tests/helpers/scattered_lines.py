"""Scattered sunlight line by line, and simple airs that scatter."""

from __future__ import annotations

import numpy as np

from seaglint.air.protocol import ClearAir
from seaglint.air.scattering.gas_bands import GasBands
from seaglint.air.scattering.scattered_line import KINDS
from seaglint.air.scattering.scattering_laws import AerosolLaws, AirLevels, ScatteringAir, SpectralLaws, scattering_angle

HIGHEST_KM = 100.0


def line_by_line(air, weights, height, elevation, azimuth, solar_zenith):
    """Radiance in band of lines of sight from a height [m] for a Sun at an apparent zenith angle [rad]."""
    elevation, azimuth = np.broadcast_arrays(np.atleast_1d(elevation), np.atleast_1d(azimuth))
    sun = air.unrefracted_zenith(solar_zenith)
    lines = np.stack([0.5 * np.pi - elevation, azimuth, np.full(elevation.shape, sun)], axis=-1)
    amplitude, arc = air.amplitudes(height, lines)
    phase = air.phase(scattering_angle(lines[:, 0], azimuth, air.apparent_zenith(sun, height)))
    return (air.source * (phase * amplitude).sum(axis=1)) @ weights, arc


def thin_air(optical_depth, levels=61, highest=30.0):
    """Molecules of one scale height alone, so thin that nothing attenuates; two channels, sunlight of 1 outside."""
    height = np.concatenate([np.linspace(0.0, highest, levels), [HIGHEST_KM]])
    density = np.zeros((11, height.size))
    density[4] = np.exp(-height / 8.0) / 8.0  # of unit amount straight up
    spectral = SpectralLaws(np.array([2500.0, 2505.0]), np.zeros((7, 2)), GasBands([], ()))
    spectral.continuum[0] = optical_depth
    air = AirLevels(6371.0, height, 1013.0 * np.exp(-height / 8.0), 250.0 + 0.0 * height, 1e-12 * np.exp(-height / 8.0),
                       0.0 * height, np.array([2.0, 10.0, 30.0, 100.0]), density)  # fmt: skip
    nothing = np.zeros((4, 2))
    aerosol = AerosolLaws(nothing, nothing, np.array([0.0, np.pi]), np.zeros((KINDS - 1, 2, 2)))
    return ScatteringAir.of(spectral, air, aerosol, np.ones(2))


class Only(ClearAir):
    """An atmosphere of scatterers alone."""

    def __init__(self, air):
        self.air = air

    def scattering(self, grid):
        return self.air.cut(grid)
