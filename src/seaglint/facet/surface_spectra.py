"""Spectra of a rough sea without the Sun: emission and mirrored sky, averaged over the facets visible to a viewer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline

from seaglint.air.protocol import Atmosphere
from seaglint.base.conventions import FloatArray
from seaglint.facet.emissivity import facet_nodes
from seaglint.facet.sky import mirrored_sky
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import ReflectanceSeries
from seaglint.optics.sea_water import WaterIndex
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

#: Number of zenith angles of the sky table, denser near the horizon (square root of elevation): error below 1e-6 of the sky.
_SKY_NODES: Final = 241

_SKY_RANK: Final = 1e-7  #: Relative singular value of the sky table below which components are dropped: error below 1e-6 of the sky.

#: Number of view azimuths from along to across the wind: even harmonics to the tenth leave 2e-8 of the background (Cox-Munk, 1-14 m/s).
_AZIMUTHS: Final = 6

_SKEWED_AZIMUTHS: Final = 13  #: Number of view azimuths from down to up the wind for skewed slopes: all harmonics up to the twelfth.

_CHUNK: Final = 64  #: Number of view zeniths summed at a time: 64 x 384 facets x 30 numbers are 6 MB.


@dataclass(frozen=True, eq=False)
class SkyTable:
    """Thermal sky over the sea, as a short sum of products: ``L(zenith, nu) = sum_r u_r(zenith) v_r(nu)``.

    Few products are enough (the sky grows with the air looked through), and the average over facets is taken of ``u_r`` alone.
    """

    angular: CubicSpline[np.float64]  #: ``u_r`` against the square root of elevation [(..., r)].
    spectral: FloatArray  #: Factors ``v_r`` over wavenumber [W m-2 sr-1 per cm-1, (r, n)].

    @classmethod
    def of(cls, atmosphere: Atmosphere, grid: slice = slice(None)) -> SkyTable:
        """Table of the sky above the sea, on part of the atmosphere's spectral grid."""
        root = np.sqrt(0.5 * np.pi) * np.linspace(0.0, 1.0, _SKY_NODES)
        radiance = mirrored_sky(atmosphere, np.clip(0.5 * np.pi - root**2, 0.0, 0.5 * np.pi), grid)
        u, s, v = np.linalg.svd(radiance, full_matrices=False)
        rank = max(int(np.count_nonzero(s > _SKY_RANK * s[0])), 1)
        return cls(CubicSpline(root, u[:, :rank] * s[:rank]), np.asarray(v[:rank]))

    def shares(self, zenith: ArrayLike) -> FloatArray:
        """Factors ``u_r`` at zenith angles [rad, (...)] up to the horizon: (..., r)."""
        elevation = np.maximum(0.5 * np.pi - np.asarray(zenith, dtype=np.float64), 0.0)
        return np.asarray(self.angular(np.sqrt(elevation)))


@dataclass(frozen=True, eq=False)
class SeaLeaving:
    """Spectra that leave the sea towards the viewer [W m-2 sr-1 per cm-1, (..., n)]."""

    emission: FloatArray
    sky: FloatArray


@dataclass(frozen=True, eq=False)
class SeaSurface:
    """Water of one temperature under one sky, on part of an atmosphere's spectral grid. Make it with ``create``."""

    reflectance: ReflectanceSeries
    blackbody: FloatArray
    sky: SkyTable

    @classmethod
    def create(cls, atmosphere: Atmosphere, water: WaterIndex, sea_temperature: float, grid: slice = slice(None)) -> SeaSurface:
        """Surface of ``water`` at ``sea_temperature`` [K] under the sky of ``atmosphere``."""
        nu = atmosphere.wavenumber_cm[grid]
        return cls(ReflectanceSeries.of(water.index(nu)), planck_wavenumber(nu, sea_temperature), SkyTable.of(atmosphere, grid))

    def leaving(self, view_zenith: ArrayLike, view_azimuth: float, slopes: SlopeStatistics, nested_bands: float = 1.0) -> SeaLeaving:
        r"""Spectra of emission and mirrored sky, averaged facet by facet.

        .. math::

            L_{emission} = (1 - \sum_{sky} w_i \rho_i)\,B(T), \qquad L_{sky} = \sum_{sky} w_i \rho_i L_s(\theta_i)

        Both sums run over the facets whose mirrored ray comes from the sky; the others see the sea, taken as a blackbody. So in a
        closed cavity of the sea's own temperature the two add up to ``B(T)`` for any slopes.

        Parameters
        ----------
        view_zenith : array_like
            Zenith angle of the direction from the sea to the viewer [rad, (...)].
        view_azimuth : float
            Its azimuth [rad]; matters for directional slopes only.
        slopes : SlopeStatistics
            Slopes of the sea.
        nested_bands : float
            Bands of nested shadowing; 1 is Smith's law.

        Returns
        -------
        SeaLeaving
            Spectra at the sea, (..., n).
        """
        theta = np.asarray(view_zenith, dtype=np.float64)
        flat = theta.ravel()
        if flat.size == 0:  # a camera that sees the sky alone
            return SeaLeaving(*(np.zeros((*theta.shape, self.blackbody.size)) for _ in range(2)))
        chunks = [self._chunk(flat[i : i + _CHUNK], view_azimuth, slopes, nested_bands) for i in range(0, flat.size, _CHUNK)]
        emission, sky = (np.concatenate([chunk[i] for chunk in chunks]).reshape(*theta.shape, -1) for i in (0, 1))
        return SeaLeaving(emission, sky)

    def _chunk(self, theta: FloatArray, azimuth: float, slopes: SlopeStatistics, nested_bands: float) -> tuple[FloatArray, FloatArray]:
        nodes = facet_nodes(theta, slopes, azimuth, nested_bands)
        weight = np.where(nodes.meets_sea, 0.0, nodes.weight)
        # Moments of the facets: incidence (Chebyshev term j) by part of the sky (r). The first column, a sky of 1, gives the emission.
        incidence = self.reflectance.basis(nodes.cos_incidence)
        sky = self.sky.shares(nodes.reflected_zenith) * weight[..., None]
        moments = np.swapaxes(incidence, -1, -2) @ np.concatenate([weight[..., None], sky], axis=-1)
        reflected = np.swapaxes(moments, -1, -2) @ self.reflectance.coefficients
        return (1.0 - reflected[:, 0]) * self.blackbody, np.einsum("irn,rn->in", reflected[:, 1:], self.sky.spectral)

    def in_band(
        self, view_zenith: FloatArray, view_azimuth: FloatArray, slopes: SlopeStatistics, seen: FloatArray, nested_bands: float = 1.0
    ) -> SeaLeaving:
        """Band radiance behind the air on rows of view zenith and columns of view azimuth [W m-2 sr-1, (rows, columns)].

        ``seen`` (rows, n) is transmittance times quadrature weight [cm-1]. Every azimuth takes one sum over facets: for many azimuths take
        ``wind_azimuths`` and multiply by ``azimuth_weights``.
        """
        parts = [self.leaving(view_zenith, float(a), slopes, nested_bands) for a in view_azimuth]
        emission, sky = (np.stack([np.einsum("rn,rn->r", seen, getattr(p, name)) for p in parts], axis=-1) for name in ("emission", "sky"))
        return SeaLeaving(emission, sky)


def wind_azimuths(slopes: SlopeStatistics) -> FloatArray:
    """View azimuths from which all others follow [rad, (k,)]: one for isotropic slopes, a quarter of the circle for Gaussian ones."""
    if slopes.is_isotropic:
        return np.zeros(1)
    turn = np.linspace(0.0, 0.5 * np.pi, _AZIMUTHS) if slopes.is_gaussian else np.linspace(0.0, np.pi, _SKEWED_AZIMUTHS)
    return np.asarray(slopes.wind_to_azimuth + turn)


def azimuth_weights(slopes: SlopeStatistics, view_azimuth: FloatArray) -> FloatArray:
    """Weights [1, (k, columns)] of the values at ``wind_azimuths`` for view azimuths [rad, (columns,)].

    Interpolation by cosines of the angle to the wind: even multiples for Gaussian slopes, which look the same from up and down the wind.
    """
    known = wind_azimuths(slopes)
    if slopes.is_isotropic:
        return np.ones((1, view_azimuth.size))
    order = np.arange(known.size) * (2.0 if slopes.is_gaussian else 1.0)
    basis, targets = (np.cos(np.outer(order, a - slopes.wind_to_azimuth)) for a in (known, view_azimuth))
    return np.asarray(np.linalg.solve(basis, targets))
