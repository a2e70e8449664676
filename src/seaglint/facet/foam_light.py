"""Spectra of the light of foam's bubbles under the sky and the Sun of a view, and their tables along a path (``seaglint.facet.foam``)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from seaglint.air.scattering.scattered_light import scattered_shares
from seaglint.base.conventions import FloatArray
from seaglint.facet.foam import FoamTables
from seaglint.facet.path_basis import PathBasis
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sky import is_dark, mirrored_sky
from seaglint.facet.sunlight import visible_sun
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.foam_reflectance import BUBBLES, diffuse_reflectance

#: Numbers of elevations and azimuths of the quadrature of the sky, crowded at the horizontal and near the Sun: within 1e-3 of a finer one.
_ELEVATIONS: Final = 48
_AZIMUTHS: Final = 48


@dataclass(frozen=True, eq=False)
class FoamLight:
    """Light of the bubbles of foam that covers the sea, at the sea [W m-2 sr-1 per cm-1, (n,)]. Make it with ``of``.

    Bubbles have the skin temperature of the sea. Foam that is older than some seconds is a few tenths of a kelvin cooler, as it evaporates
    more than water does (Marmorino and Smith 2005, Geophys. Res. Lett. 32, L11604, see dark residual foam); this is left out.
    """

    emitted: FloatArray  #: Emission of the bubbles.
    sky: FloatArray  #: Thermal sky and scattered sunlight that they reflect diffusely, of the whole hemisphere.
    sun: FloatArray  #: Sunlight that they reflect diffusely, of the whole disc at normal incidence, Sun at the sensor's foot.

    @classmethod
    def of(cls, view: SeaView) -> FoamLight:
        """Light of the bubbles under a view's sky and Sun; facets count as horizontal under the sky."""
        nu = view.in_band.wavenumber_cm
        # the outermost samples can lie just outside the water's table where the band ends on its edge
        inside = np.clip(nu, 1e4 / view.water.wavelength_um[-1], 1e4 / view.water.wavelength_um[0])
        diffuse = diffuse_reflectance(inside, view.water)
        black = planck_wavenumber(nu, view.sea_temperature)
        return cls((BUBBLES - diffuse) * black, diffuse * mean_sky(view), diffuse * view.irradiance / np.pi)

    @property
    def spectra(self) -> FloatArray:
        """The three of them [(3, n)]."""
        return np.stack([self.emitted, self.sky, self.sun])


def mean_sky(view: SeaView) -> FloatArray:
    """Radiance of a white horizontal surface at the sensor's foot under a view's sky, without the disc [W m-2 sr-1 per cm-1, (n,)]."""
    x, w = np.polynomial.legendre.leggauss(_ELEVATIONS)
    sine = (0.5 * (1.0 + x)) ** 2
    # d(sine) = 2 sqrt(sine) of the node's step; 2 sine d(sine) over the hemisphere adds up to 1
    weight = 2.0 * w * sine * np.sqrt(sine)
    light = weight @ mirrored_sky(view.atmosphere, np.arccos(sine), view.in_band.grid)
    table = view.scattered.sea_sky_within(view.farthest_turn, 1)
    share = visible_sun(view.solar_zenith)[0] if table.sets else 1.0
    if is_dark(table) or share == 0.0:
        return np.asarray(light)
    y, v = np.polynomial.legendre.leggauss(_AZIMUTHS)
    half = 0.5 * (1.0 + y)
    shares = scattered_shares(np.arcsin(sine)[:, None], np.pi * half**2, table)
    scattered = np.einsum("i,j,ijr->r", weight, v * half, shares) @ table.spectral
    return np.asarray(light + view.sun_distance_factor * share * np.maximum(scattered, 0.0))


def foam_tables(view: SeaView, basis: PathBasis) -> FoamTables:
    """Tables of the light of foam at the places of a basis, for ``foam_thermal``, ``foam_emission`` and ``foam_sunlight``."""
    emitted, sky, sun = (basis.coefficients @ terms for terms in basis.project(FoamLight.of(view).spectra))
    return FoamTables(1.0 - BUBBLES, emitted, sky, sun)
