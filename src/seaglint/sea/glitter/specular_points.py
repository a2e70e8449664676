r"""Specular points of a Gaussian sea: their number, the area that each lights, and how long a fixed point stays lit.

A specular point has the mirroring slope. Of points where two functions have stated values, a random sea has as many per unit area as the
density of the values times the mean absolute determinant of their derivatives, here the curvatures:

.. math:: N = p(s^*)\, \langle |\zeta_{xx} \zeta_{yy} - \zeta_{xy}^2| \rangle

The determinant ``Q`` is a quadratic form of three Gaussian numbers, whose characteristic function has the eigenvalues ``l`` of the form:

.. math:: \langle |Q| \rangle = \frac{2}{\pi} \int_0^\infty \frac{1 - \mathrm{Re}\, \phi(t)}{t^2}\, dt, \qquad
    \phi(t) = \prod_{j=1}^3 (1 - 2 i l_j t)^{-1/2}

Curvatures grow with the shortest waves: N belongs to the waves that are given, and has no limit for a spectrum without a cut-off. Each
point lights the area where slopes are within the disc, ``P/N`` in the mean. A fixed point is lit as long as its slope takes through the
disc. By Rice's rate of crossings of a circle of radius w,

.. math:: \tau = \frac{\pi w^2 p}{2 \pi w\, p\, \sigma_t/\sqrt{2 \pi}} = \sqrt{\frac{\pi}{2}} \frac{w}{\sigma_t}

with ``sigma_t`` the standard deviation of the rate of a slope. What a pixel shows lasts longer: glints travel
(``correlation_time``).

References
----------
Longuet-Higgins 1960, J. Opt. Soc. Am. 50, 838, 845 and 851 (parts I to III); Rice 1945, Bell Syst. Tech. J. 24, 46.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.integrate import quad

from seaglint.sea.glitter.lit_share import LitShare
from seaglint.sea.glitter.short_waves import ShortWaves


class SpecularPoints(NamedTuple):
    """Specular points of a sea for one mirroring slope."""

    number: float  #: Number per unit area of the sea [m⁻²].
    area: float  #: Mean area that one lights [m²].
    dwell: float  #: Mean time for which a fixed point is lit [s].


def curvature_moments(waves: ShortWaves) -> tuple[float, float, float]:
    """Variances of the curvature along and across the axis, and their covariance, which is the variance of the mixed one [m⁻²]."""
    energy, a2 = (waves.up + waves.cross) * waves.wavenumber**2, waves.second_moment
    along, across = np.sum(energy * (0.375 + 0.5 * a2)), np.sum(energy * (0.375 - 0.5 * a2))
    return float(along), float(across), float(np.sum(energy) / 8.0)


def mean_determinant(along: float, across: float, mixed: float) -> float:
    """Mean absolute determinant of Gaussian curvatures of these moments [m⁻²].

    Parameters
    ----------
    along, across : float
        Variances of the curvature along and across the axis [m⁻²].
    mixed : float
        Covariance of both, and variance of the mixed curvature [m⁻²].

    Examples
    --------
    >>> round(mean_determinant(3.0, 3.0, 1.0), 4)  # isotropic, of unit mixed variance
    2.3094
    """
    root = np.linalg.cholesky(np.array([[along, mixed, 0.0], [mixed, across, 0.0], [0.0, 0.0, mixed]]))
    values = np.linalg.eigvalsh(root.T @ np.array([[0.0, 0.5, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, -1.0]]) @ root)
    scale = float(np.max(np.abs(values)))

    def integrand(t: float) -> float:
        return float((1.0 - np.prod(1.0 / np.sqrt(1.0 - 2.0j * values / scale * t)).real) / (t * t))

    # the integrand ends at t = 0 in a constant, and as one over the square of t
    parts = [quad(integrand, *ends, epsabs=1e-10, limit=200)[0] for ends in ((1e-6, 1.0), (1.0, np.inf))]
    return float(2.0 / math.pi * scale * sum(parts))


def specular_points(waves: ShortWaves, lit: LitShare) -> SpecularPoints:
    """Return the specular points of waves for a lit share of their slopes.

    Parameters
    ----------
    waves : ShortWaves
        All waves that carry curvature.
    lit : LitShare
        Slopes, mirroring slope and disc.
    """
    number = lit.density * mean_determinant(*curvature_moments(waves))
    rate = math.sqrt(0.5 * float(np.sum((waves.up + waves.cross) * waves.frequency**2)))
    return SpecularPoints(number, lit.chance / number, math.sqrt(0.5 * math.pi) * lit.radius / rate)
