r"""Light of the Moon's disc outside the atmosphere: sunlight that it reflects, and its own emission.

The irradiance of a disc with the solid angle :math:`\Omega` is

.. math:: E(\nu) = \frac{\Omega}{\pi}\, A(\nu, \alpha) \frac{E_\odot(\nu)}{d^2} + \Omega\, \epsilon(\nu)\, \overline{B(\nu, T)}

with the phase angle :math:`\alpha` (0 at full Moon), the reflectance A of a Lambertian disc of equal size, the Sun's distance d [au] and
the mean of Planck's law over the disc.

- **Reflectance**: the phase law of Kieffer and Stone (2005) at 2.38 um, their longest wavelength, times the ratio of spherical albedos.
  Their terms for waxing and waning (6 %) and for libration (3 %) are left out.
- **Emissivity**: one minus the spherical albedo (Kirchhoff). Up to 2.38 um the albedo is the integral of Kieffer and Stone's law; beyond,
  an assumed smooth curve within the published properties of lunar soils: highest at 4.5 to 5 um, lowest in the Christiansen feature near
  8.2 um, higher again beyond 10 um (Murcray et al. 1970), with emissivities within 0.6 to 1.0 from 3.7 to 15 um (Mueller et al. 2020). It
  is uncertain by 0.1 in 3 to 5 um and by 0.03 in 8 to 14 um.
- **Temperature**: :math:`T = T_s \mu_0^k / \sqrt d` on the lit side, with the cosine :math:`\mu_0` of the Sun's zenith angle there, and
  95 K on the dark side. :math:`T_s` = 392 K is the middle of the 387 to 397 K that Diviner measured at the equator at noon (Williams et
  al. 2017, also the source of the night). A smooth ground that conducts no heat has k = 1/4. Rough ground shows an observer near the Sun
  its lit slopes, so that k is smaller near full Moon (1/6 of Pettit and Nicholson 1930, less at the limb in Saari and Shorthill 1972) and
  larger at large phase angles: here :math:`k = 0.085 + 0.231\, \alpha / 90°`, fitted to the brightness temperatures of the whole disc
  that weather satellites measured in six channels of 13.7 to 15 um at phase angles of 24 to 70 degrees (Mueller et al. 2021, table A.1),
  with 2.6 K of scatter.

References
----------
Kieffer, H. H., and T. C. Stone (2005), The spectral irradiance of the Moon, Astron. J. 129, 2887, Eq. 10 and tables 4 and 5.
Mueller, T. G., et al. (2020), Thermophysical model of the Moon from 3.7 to 15 um, EPSC Abstracts 14, EPSC2020-586.
Mueller, T. G., et al. (2021), The Moon at thermal infrared wavelengths, Astron. Astrophys. 650, A38.
Murcray, F. H., et al. (1970), Infrared emissivity of lunar surface features 1, J. Geophys. Res. 75, 2662.
Pettit, E., and S. B. Nicholson (1930), Lunar radiation and temperatures, Astrophys. J. 71, 102.
Saari, J. M., and R. W. Shorthill (1972), The sunlit lunar surface, The Moon 5, 161.
Williams, J.-P., et al. (2017), The global surface temperatures of the Moon, Icarus 283, 300.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.optics.blackbody import FIRST_RADIATION, SECOND_RADIATION, planck_wavenumber
from seaglint.optics.solar_spectrum import exoatmospheric_irradiance

MOON_RADIUS: Final = 1_737_400.0  #: Mean radius of the Moon [m] (IAU 2015).
MEAN_MOON_DISTANCE: Final = 384_400_000.0  #: Mean distance of the Moon [m], the standard distance of Kieffer and Stone.

#: Coefficients of Kieffer and Stone's phase law at 2383.6 nm: a0 to a3 (phase angle in radians) and d1 to d3.
_PHASE_POLYNOMIAL: Final = (-1.08403, -1.31032, 0.20323, -0.15863)
_PHASE_TERMS: Final = (0.36134, -0.28408, 0.01010)
#: Their constants p1 to p4 [deg].
_PHASE_ANGLES: Final = (4.06054, 12.8802, -30.5858, 16.7498)
_LEAST_PHASE: Final = math.radians(1.55)  #: Least phase angle that they observed [rad]; at smaller ones the Earth's shadow is near.

#: Wavelengths [um] and spherical albedo [1] of the Moon; see the notes of the module.
_ALBEDO: Final = np.array(
    [
        [0.70, 0.091], [1.06, 0.118], [1.54, 0.160], [1.98, 0.186], [2.38, 0.236], [3.0, 0.22], [3.5, 0.24], [4.0, 0.26], [4.5, 0.28],
        [5.0, 0.28], [5.5, 0.23], [6.0, 0.16], [6.5, 0.11], [7.0, 0.07], [7.5, 0.04], [8.2, 0.02], [9.0, 0.04], [10.0, 0.05], [11.0, 0.06],
        [12.0, 0.05], [15.0, 0.05],
    ]
)  # fmt: skip
_ALBEDO_OF_PHASE_LAW: Final = 0.236  #: Spherical albedo at 2.38 um: twice the integral of the phase law times the sine of the phase angle.

_NOON: Final = 392.0  #: Temperature under a Sun at the zenith, 1 au away [K].
_NIGHT: Final = 95.0  #: Temperature of the dark side [K].
_EXPONENT: Final = (
    0.085,
    0.231,
)  #: Exponent of the temperature law at full Moon, and how much it is larger at a phase angle of 90 degrees.

_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(40)


def moon_radius(distance_m: float) -> float:
    """Angular radius of the Moon at a distance [m] from its centre [rad].

    >>> round(math.degrees(moon_radius(MEAN_MOON_DISTANCE)), 4)
    0.259
    """
    if not distance_m > MOON_RADIUS:
        raise DomainError(f"distance_m = {distance_m:g} m is inside the Moon; give the distance of its centre, about 3.8e8 m")
    return math.asin(MOON_RADIUS / distance_m)


def moon_albedo(wavenumber_cm: ArrayLike) -> FloatArray:
    """Spherical albedo of the Moon at wavenumbers [cm-1], mean over its disc [1, same shape]; the emissivity is one minus it.

    >>> moon_albedo([2500.0, 1000.0]).round(2).tolist()
    [0.26, 0.05]
    """
    wavelength = 1.0e4 / np.asarray(wavenumber_cm, dtype=np.float64)
    return np.asarray(np.interp(wavelength, _ALBEDO[:, 0], _ALBEDO[:, 1]))


def moon_reflectance(wavenumber_cm: ArrayLike, phase: float) -> FloatArray:
    """Reflectance of the Lambertian disc that reflects as much sunlight as the Moon [1, shape of ``wavenumber_cm``].

    Parameters
    ----------
    wavenumber_cm : array_like
        Wavenumber [cm-1].
    phase : float
        Phase angle [rad]: 0 at full Moon, pi at new Moon. Observed from 1.55 to 97 degrees: less counts as 1.55, more is extrapolated.

    Returns
    -------
    ndarray
        Reflectance.

    Examples
    --------
    >>> [round(float(moon_reflectance(4200.0, math.radians(x))), 3) for x in (7, 30, 90)]
    [0.26, 0.17, 0.039]
    """
    g = max(_checked_phase(phase), _LEAST_PHASE)
    degrees, (p1, p2, p3, p4), (d1, d2, d3) = math.degrees(g), _PHASE_ANGLES, _PHASE_TERMS
    law = sum(a * g**i for i, a in enumerate(_PHASE_POLYNOMIAL))
    law += d1 * math.exp(-degrees / p1) + d2 * math.exp(-degrees / p2) + d3 * math.cos((degrees - p3) / p4)
    return np.asarray(math.exp(law) / _ALBEDO_OF_PHASE_LAW * moon_albedo(wavenumber_cm))


def moon_emission(wavenumber_cm: ArrayLike, phase: float, sun_distance_au: float = 1.0) -> FloatArray:
    """Mean radiance of the Moon's own emission over its disc [W m-2 sr-1 per cm-1, (n,)].

    Parameters
    ----------
    wavenumber_cm : array_like
        Wavenumbers [cm-1, (n,)].
    phase : float
        Phase angle [rad].
    sun_distance_au : float
        Distance of the Moon from the Sun [au].

    Returns
    -------
    ndarray
        Radiance.
    """
    nu = np.atleast_1d(np.asarray(wavenumber_cm, dtype=np.float64))
    cosine, share = _lit_disc(_checked_phase(phase))
    exponent = _EXPONENT[0] + _EXPONENT[1] * phase / (0.5 * math.pi)
    temperature = np.maximum(_NOON / math.sqrt(sun_distance_au) * cosine**exponent, _NIGHT)
    lit = planck_wavenumber(nu[:, None], temperature) @ share
    dark = (1.0 - share.sum()) * planck_wavenumber(nu, _NIGHT)
    return np.asarray((1.0 - moon_albedo(nu)) * (lit + dark))


def moon_temperature(wavenumber_cm: ArrayLike, phase: float, sun_distance_au: float = 1.0) -> FloatArray:
    """Brightness temperature of the Moon's disc without reflected sunlight [K, (n,)]; parameters as for ``moon_emission``.

    >>> moon_temperature([1000.0, 2500.0], 0.0).round().tolist()
    [372.0, 366.0]
    """
    nu = np.atleast_1d(np.asarray(wavenumber_cm, dtype=np.float64))
    return np.asarray(SECOND_RADIATION * nu / np.log1p(FIRST_RADIATION * nu**3 / moon_emission(nu, phase, sun_distance_au)))


def moon_irradiance(
    wavenumber_cm: ArrayLike, phase: float, distance_m: float = MEAN_MOON_DISTANCE, sun_distance_au: float = 1.0
) -> FloatArray:
    """Irradiance of the whole Moon outside the atmosphere, on a plane normal to its light [W m-2 per cm-1, (n,)].

    Parameters
    ----------
    wavenumber_cm : array_like
        Wavenumbers, 0.70 to 14.7 um [cm-1, (n,)].
    phase : float
        Phase angle, the angle at the Moon between the Sun and the observer [rad]: 0 at full Moon, pi at new Moon.
    distance_m : float
        Distance of the Moon's centre from the observer [m].
    sun_distance_au : float
        Distance of the Moon from the Sun [au].

    Returns
    -------
    ndarray
        Irradiance.
    """
    nu = np.atleast_1d(np.asarray(wavenumber_cm, dtype=np.float64))
    solid_angle = math.pi * moon_radius(distance_m) ** 2
    reflected = moon_reflectance(nu, phase) / math.pi * exoatmospheric_irradiance(nu) / sun_distance_au**2
    return np.asarray(solid_angle * (reflected + moon_emission(nu, phase, sun_distance_au)))


def moon_to_sun(wavenumber_cm: ArrayLike, phase: float, distance_m: float = MEAN_MOON_DISTANCE, sun_distance_au: float = 1.0) -> FloatArray:
    """Ratio of the Moon's irradiance to the Sun's at 1 au, outside the atmosphere [1, (n,)]; parameters as for ``moon_irradiance``.

    >>> [float(f"{x:.2g}") for x in moon_to_sun([2350.0, 1000.0], math.radians(10.0))]
    [7e-05, 0.0064]
    """
    nu = np.atleast_1d(np.asarray(wavenumber_cm, dtype=np.float64))
    return np.asarray(moon_irradiance(nu, phase, distance_m, sun_distance_au) / exoatmospheric_irradiance(nu))


def _checked_phase(phase: float) -> float:
    if not 0.0 <= phase <= math.pi:
        raise DomainError(
            f"phase = {phase:g} rad; a phase angle is 0 (full Moon) to pi (new Moon)", name="phase", value=phase, allowed=(0.0, math.pi)
        )
    return float(phase)


def _lit_disc(phase: float) -> tuple[FloatArray, FloatArray]:
    """Cosines of the Sun's zenith angle on the lit part of the disc, and the shares of the disc that they fill.

    Gauss points in longitude and latitude about the axis on which Sun and observer both have the latitude 0; the observer has the
    longitude 0 and the Sun ``phase``, so that the lit part lies between ``phase - pi/2`` and ``pi/2``.
    """
    half = 0.5 * (math.pi - phase)
    longitude = 0.5 * math.pi - half + half * _GAUSS_X
    latitude = 0.5 * math.pi * _GAUSS_X
    flat = np.cos(latitude)[:, None]
    share = half * _GAUSS_W * np.cos(longitude) * (0.5 * math.pi * _GAUSS_W)[:, None] * flat**2 / math.pi
    return np.maximum(flat * np.cos(longitude - phase), 0.0).ravel(), share.ravel()
