r"""Mean radiance as the source article computed it: band means, its own interpolators, one blackbody for sea and sky.

.. math:: L = L_{bb-ae} + \bar\xi\,E_{Sun}\,\bar\tau_{path}, \qquad \bar\xi = \frac{\bar\rho(\omega)\,p\,S}{4\cos^4\beta\cos\theta_v}

(Eqs. 3, 7 and 8), with S for the viewer's leg alone. Overbars are flat means over wavelength. Sunlight and path absorb in the same
lines, which a product of means misses: over random cases in 3-5 um the product per wavenumber is 1.1 to 2.1 times larger.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import ArrayLike
from scipy.interpolate import CubicSpline, PchipInterpolator

from seaglint.air.protocol import Atmosphere, slant_range
from seaglint.base.constants import EFFECTIVE_EARTH_RADIUS, SOLAR_ANGULAR_RADIUS
from seaglint.base.conventions import FloatArray, horizon_depression, horizon_range, surface_range, view_zenith
from seaglint.facet.glint import glint
from seaglint.facet.legs import VIEWER
from seaglint.facet.sea_view import BandSum, SeaView
from seaglint.facet.sunlight import solar_zenith_at, turn_at, visible_sun
from seaglint.optics.band import Band
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import ReflectanceSeries
from seaglint.radiance.mean_radiance import SeaRadiance

_RANGES: Final = 40
_ZENITHS: Final = np.radians([0, 10, 20, 30, 40, 45, 50, 55, 60, 65, 70, 74, 77, 80, 82, 84, 85, 86, 87, 88, 88.5, 89, 89.5, 90])


@dataclass(frozen=True, eq=False)
class ArticleAtmosphere:
    """Band quantities of one atmosphere for one sensor height, interpolated as in the article. Make it with ``fit``."""

    coefficients: FloatArray  #: ``a_0 ... a_3`` of Eq. 9 for the slant range in km [(4,)].
    path: CubicSpline[np.float64]  #: Path radiance [W m-2 sr-1] against ln slant range [m].
    boundary: CubicSpline[np.float64]  #: Radiance of a blackbody sea behind the path [W m-2 sr-1], likewise.
    sun: PchipInterpolator  #: Irradiance at the sea normal to the beam [W m-2] against zenith [rad].
    sky: PchipInterpolator  #: Sky radiance from the sensor's height [W m-2 sr-1] against zenith [rad].
    fit_error: float  #: Largest error of the transmittance of Eq. 9 at the fitted ranges [1].

    @classmethod
    def fit(cls, atmosphere: Atmosphere, band: Band, sensor_height: float, sea_temperature: float) -> ArticleAtmosphere:
        """Tabulate an atmosphere at 40 ranges from below the sensor to its horizon, and at 24 zenith angles."""
        over = BandSum.of(band, atmosphere)
        mean = wavelength_mean(over.weights, over.wavenumber_cm)
        # Evenly spaced in ln slant range, the coordinate of the splines.
        last = horizon_range(sensor_height)
        slant = np.geomspace(sensor_height, float(slant_range(sensor_height, last)), _RANGES)
        chord = (slant**2 - sensor_height**2) / (4.0 * EFFECTIVE_EARTH_RADIUS * (EFFECTIVE_EARTH_RADIUS + sensor_height))
        arc = 2.0 * EFFECTIVE_EARTH_RADIUS * np.arcsin(np.sqrt(np.maximum(chord, 0.0)))  # inverse of slant_range
        spectral = atmosphere.transmittance(sensor_height, arc)[..., over.grid]
        path = atmosphere.path_radiance(sensor_height, arc)[..., over.grid]
        sea = planck_wavenumber(over.wavenumber_cm, sea_temperature)
        transmittance = spectral @ mean
        powers = np.vander(1e-3 * slant, 4, increasing=True)
        # Weighted by the transmittance itself: errors count where much of the sea's radiance arrives.
        coefficients = np.linalg.lstsq(powers * transmittance[:, None], np.log(transmittance) * transmittance, rcond=None)[0]
        zenith = np.append(_ZENITHS, 0.5 * np.pi + horizon_depression(sensor_height))
        return cls(
            coefficients=np.asarray(coefficients, dtype=np.float64),
            path=CubicSpline(np.log(slant), path @ over.weights),
            boundary=CubicSpline(np.log(slant), (path + spectral * sea) @ over.weights),
            sun=PchipInterpolator(_ZENITHS, over(atmosphere.solar_irradiance(_ZENITHS))),
            sky=PchipInterpolator(zenith, over(atmosphere.sky_radiance(zenith, 0.0, sensor_height))),
            fit_error=float(np.max(np.abs(np.exp(powers @ coefficients) - transmittance))),
        )

    def transmittance(self, slant: ArrayLike) -> FloatArray:
        """Band-mean transmittance by Eq. 9, ``exp(sum a_i x^i)``, at slant ranges [m]."""
        return np.asarray(np.exp(polyval(1e-3 * np.asarray(slant, dtype=np.float64), self.coefficients)))


def wavelength_mean(weights: FloatArray, wavenumber_cm: FloatArray) -> FloatArray:
    """Weights of a flat mean over wavelength [1, (n,)] from quadrature weights in wavenumber: ``d lambda = 1e4 d nu / nu^2``."""
    w = weights / wavenumber_cm**2
    return np.asarray(w / w.sum())


def article_radiance(view: SeaView, elevation: ArrayLike, azimuth: ArrayLike) -> SeaRadiance:
    """Mean radiance by the article's method, at elevations and azimuths.

    Parameters
    ----------
    view : SeaView
        Sensor, sea, air and Sun; ``shadowing`` and ``background`` are ignored: the article shadows the viewer's leg and treats the
        sea with its mirrored sky as a blackbody. Give ``seaglint.optics.sea_water.article`` as water and
        ``cox_munk_isotropic(W, height=12.5)`` as slopes for its own case.
    elevation, azimuth : array_like
        Lines of sight [rad, (rows,)] and [rad, (columns,)] as in :func:`seaglint.radiance.mean_radiance.mean_radiance`; separate azimuths
        per row are (rows, columns).

    Returns
    -------
    SeaRadiance
        ``emission`` is the blackbody sea behind the path; ``sky`` is 0 below the horizon. The Sun's direction is
        taken at each place, but a Sun below the horizon at the sensor's foot is mirrored nowhere.

    References
    ----------
    Source article Eqs. 3, 6-9 and Fig. 2.
    """
    rows = np.atleast_1d(np.asarray(elevation, dtype=np.float64))
    columns = np.atleast_2d(np.asarray(azimuth, dtype=np.float64))
    columns = np.broadcast_to(columns, (rows.size, columns.shape[1]))
    air = ArticleAtmosphere.fit(view.atmosphere, view.band, view.sensor_height, view.sea_temperature)
    theta = view_zenith(view.sensor_height, -rows)
    sea = np.isfinite(theta)
    path, emission, sky = (np.zeros((rows.size, 1)) for _ in range(3))
    sun, chance, cos_incidence = (np.zeros(columns.shape) for _ in range(3))
    sky[~sea, 0] = air.sky(0.5 * np.pi - rows[~sea])
    arc = surface_range(view.sensor_height, -rows[sea])
    slant = slant_range(view.sensor_height, arc)
    path[sea, 0] = air.path(np.log(slant))
    emission[sea, 0] = air.boundary(np.log(slant)) - path[sea, 0]
    share, zenith = visible_sun(view.solar_zenith)
    # a Sun below the horizon at the sensor's foot is mirrored nowhere
    if share > 0.0:
        turn, towards = turn_at(arc)[:, None], columns[sea]
        mirrored = glint(theta[sea][:, None], towards + np.pi, view.solar_zenith, view.solar_azimuth, view.slopes, VIEWER, turn)
        zenith_there = np.minimum(solar_zenith_at(zenith, towards - view.solar_azimuth, turn), _ZENITHS[-1])
        irradiance = view.sun_distance_factor * air.sun(zenith_there)
        rho = _mean_reflectance(view, mirrored.cos_incidence)
        chance[sea], cos_incidence[sea] = mirrored.chance, mirrored.cos_incidence
        sun[sea] = mirrored.chance * rho * irradiance * air.transmittance(slant)[:, None] / (np.pi * SOLAR_ANGULAR_RADIUS**2)
    return SeaRadiance(path, emission, sky, sun, chance, cos_incidence)


def _mean_reflectance(view: SeaView, cos_incidence: FloatArray) -> FloatArray:
    """Reflectance averaged over wavelength."""
    over = view.in_band
    series = ReflectanceSeries.of(view.water.index(over.wavenumber_cm))
    return np.asarray(series.basis(cos_incidence) @ (series.coefficients @ wavelength_mean(over.weights, over.wavenumber_cm)))
