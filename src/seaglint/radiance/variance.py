r"""Variance of glint in a detector of any size (Eqs. 11-19 of the source article, corrected), and the correlation length that it needs.

The correlation length follows from the correlation time by the dispersion of short waves.

A point of the sea mirrors the Sun or it does not. With P the share of the *viewed* area that does and :math:`L_g - L_b` what the mirrored
Sun adds there, the mean of the Sun's part is :math:`\langle L\rangle = P (L_g - L_b)` and its variance at a point

.. math:: \sigma_0^2 = P (1 - P) (L_g - L_b)^2 = \langle L\rangle^2 \left(\frac{1}{P} - 1\right)

(Eq. 11; Eq. 15 as printed is garbled). The sea consists of independent cells of *sea* area :math:`l^2`. A mirroring cell, tilted by
:math:`\beta` and met at the angle :math:`\omega`, covers :math:`l^2 \cos\omega/\cos\beta` of the plane across the line of sight, where a
detector of solid angle :math:`\Omega` at range r covers :math:`\Omega r^2`. So it averages over

.. math:: M = \frac{\Omega r^2 \cos\beta}{l^2 \cos\omega} = \frac{A}{l^2} \frac{\cos\theta_v \cos\beta}{\cos\omega},
    \qquad A = \frac{\Omega r^2}{\cos\theta_v}

patches of the size of a mirroring cell, and :math:`\sigma^2 = \sigma_0^2 / \max(1, M)`. For sparse glints the relative variance
becomes :math:`l^2/(A P_h S)` with :math:`P_h` the share of *sea* area (Eq. 12), because
:math:`P = P_h S \cos\omega / (\cos\beta \cos\theta_v)`; Eq. 18 with P in place of :math:`P_h S` is low by that factor, 8 at 2 deg
depression and a Sun at 60 deg.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.air.protocol import slant_range as slant_range_of
from seaglint.base.constants import SEA_WATER_DENSITY
from seaglint.base.conventions import FloatArray, surface_range
from seaglint.base.conventions import view_zenith as view_zenith_of
from seaglint.base.errors import DomainError
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sunlight import visible_sun
from seaglint.radiance.lit_variance import WaveGlint
from seaglint.radiance.mean_radiance import SeaRadiance
from seaglint.sea.dispersion import wavenumber

#: Surface tension in Eq. 17 of the source article [N m-1] (76.3 dyn/cm; its text calls it a viscosity).
ARTICLE_SURFACE_TENSION: Final = 76.3e-3


def _angular_frequency(correlation_time: float) -> float:
    if not (np.isfinite(correlation_time) and correlation_time > 0.0):
        raise DomainError(f"correlation_time = {correlation_time:g} s; give a time > 0 s, e.g. 0.07")
    return 2.0 * np.pi / correlation_time


def correlation_length(correlation_time: float) -> float:
    """Length ``l = 1/k`` of the wave of angular frequency ``2 pi / T_c``, with gravity and surface tension [m].

    Parameters
    ----------
    correlation_time : float
        Correlation time of glint at a point [s].

    Returns
    -------
    float
        Correlation length [m].

    Examples
    --------
    >>> [round(100.0 * correlation_length(t), 3) for t in (0.07, 0.3)]
    [0.257, 2.268]
    """
    return float(1.0 / wavenumber(_angular_frequency(correlation_time)))


def capillary_length(correlation_time: float) -> float:
    """Length ``l = 1/k`` by surface tension alone, ``omega^2 = T k^3 / rho`` with 76.3 dyn/cm: Eq. 17 of the source article as printed [m].

    Gravity is not negligible there: :func:`correlation_length` gives 0.257 and 2.27 cm for 70 and 300 ms.

    Examples
    --------
    >>> [round(100.0 * capillary_length(t), 3) for t in (0.07, 0.3)]
    [0.21, 0.554]
    """
    omega = _angular_frequency(correlation_time)
    return float((ARTICLE_SURFACE_TENSION / (SEA_WATER_DENSITY * omega**2)) ** (1.0 / 3.0))


def point_variance(sun_mean: ArrayLike, chance: ArrayLike) -> FloatArray:
    r"""Variance of the mirrored Sun at a point, ``mean^2 (1/P - 1)``: a detector smaller than a cell of the sea.

    Parameters
    ----------
    sun_mean : array_like
        Mean radiance of the mirrored Sun [W m-2 sr-1], at the sea or behind the air.
    chance : array_like
        P, share of the viewed area that mirrors the Sun [1], broadcast; 0 where no Sun is mirrored.

    Returns
    -------
    ndarray
        Variance [W2 m-4 sr-2], of the broadcast shape.

    References
    ----------
    Source article Eqs. 11 and 15 (the latter as it follows from the former).

    Examples
    --------
    >>> float(point_variance(2.0, 0.25))
    12.0
    """
    mean, p = np.broadcast_arrays(np.asarray(sun_mean, dtype=np.float64), np.asarray(chance, dtype=np.float64))
    # radiance that the mirrored Sun adds at a mirroring point, L_g - L_b
    mirrored = np.divide(mean, p, out=np.zeros(mean.shape), where=p > 0.0)
    # P of a flat sea is 1 within rounding.
    return np.asarray(mirrored * mean * np.clip(1.0 - p, 0.0, 1.0))


def patches(
    cos_incidence: ArrayLike,
    view_zenith: ArrayLike,
    solar_zenith: float,
    slant_range: ArrayLike,
    solid_angle: ArrayLike,
    correlation_length: float,
) -> FloatArray:
    r"""Number of mirroring cells that a detector averages over, ``M = Omega r^2 cos(beta) / (l^2 cos(omega))`` [1].

    Parameters
    ----------
    cos_incidence : array_like
        Cosine of the angle of incidence on the mirroring facets [1].
    view_zenith : array_like
        Zenith angle of the direction from the sea to the sensor [rad], 0..pi/2.
    solar_zenith : float
        Zenith angle of the Sun's centre [rad]; a disc cut by the horizon counts with the middle of its visible part.
    slant_range : array_like
        Distance to the sea [m].
    solid_angle : array_like
        Solid angle of the detector's view [sr]: for a rectangular pixel the product of its two angular widths.
    correlation_length : float
        l, side of a cell of the sea [m]; see :mod:`seaglint.radiance.variance`.

    Returns
    -------
    ndarray
        M, of the broadcast shape; below 1 for a detector that resolves the cells.

    Raises
    ------
    DomainError
        A solid angle or a correlation length that is not above 0.
    """
    # facets mirror the visible part of a cut disc
    _, zenith = visible_sun(solar_zenith)
    tilt = np.maximum(np.cos(np.asarray(view_zenith, dtype=np.float64)) + np.cos(zenith), 0.0)
    return patches_of_tilt(cos_incidence, tilt, slant_range, solid_angle, correlation_length)


def patches_of_tilt(
    cos_incidence: ArrayLike, tilt: ArrayLike, slant_range: ArrayLike, solid_angle: ArrayLike, correlation_length: float
) -> FloatArray:
    """Number of mirroring cells as :func:`patches`, for many Suns.

    The sum of the cosines of both zenith angles is ``tilt = cos(theta_v) + cos(theta_s)`` [1].
    """
    omega = np.asarray(solid_angle, dtype=np.float64)
    if not np.all(omega > 0.0):
        raise DomainError(
            f"solid_angle = {float(np.min(omega)):g} sr; give the detector's solid angle > 0 sr, e.g. 1e-6 for 1 mrad x 1 mrad"
        )
    if not (np.isfinite(correlation_length) and correlation_length > 0.0):
        raise DomainError(f"correlation_length = {correlation_length:g} m; give the length of a cell of the sea > 0 m, e.g. 0.0026")
    cosine = np.asarray(cos_incidence, dtype=np.float64)
    # cos(beta) = (cos(theta_v) + cos(theta_s)) / (2 cos(omega)): taken across the line of sight, no term divides by cos(theta_v),
    # which is 0 at the horizon.
    across = omega * np.asarray(slant_range, dtype=np.float64) ** 2
    return np.asarray(across * np.asarray(tilt) / (2.0 * correlation_length**2 * np.maximum(cosine, 1e-9) ** 2))


def glint_variance(
    sun_mean: ArrayLike,
    chance: ArrayLike,
    cos_incidence: ArrayLike,
    view_zenith: ArrayLike,
    solar_zenith: float,
    slant_range: ArrayLike,
    solid_angle: ArrayLike,
    correlation_length: float,
) -> FloatArray:
    r"""Variance of glint in a detector of any solid angle at any range.

    .. math:: \sigma^2 = \frac{\langle L\rangle^2 (1/P - 1)}{\max(1, M)}, \qquad M = \frac{\Omega r^2 \cos\beta}{l^2 \cos\omega}

    Parameters
    ----------
    sun_mean : array_like
        Mean radiance of the mirrored Sun [W m-2 sr-1], as :attr:`seaglint.radiance.mean_radiance.SeaRadiance.sun`.
    chance : array_like
        P, share of the viewed area that mirrors the Sun, shadowing included [1].
    cos_incidence, view_zenith, solar_zenith, slant_range, solid_angle, correlation_length
        As in :func:`patches`.

    Returns
    -------
    ndarray
        Variance [W2 m-4 sr-2], of the broadcast shape; 0 where no Sun is mirrored.

    Raises
    ------
    DomainError
        A solid angle or a correlation length that is not above 0.

    Notes
    -----
    A detector smaller than a mirroring cell measures a point's variance; one that covers whole cells measures it divided by their number.
    Between one and a few cells a square detector at a random position measures less than this, 0.44 of it at M = 1 and 0.93 at M = 100.
    Cells are taken as independent and of one size. Waves that a detector resolves are excluded: they move the mean.

    References
    ----------
    Source article Eqs. 11-19; cos(phi) in Eqs. 18 and 19 is the cosine of the view zenith.

    Examples
    --------
    A thousandth of the viewed area mirrors; a pixel of 1 mrad x 1 mrad from 2 km looks at a patch of 2 m x 2 m.

    >>> look = dict(cos_incidence=0.7, view_zenith=1.5, solar_zenith=1.0)
    >>> look |= dict(slant_range=2000.0, solid_angle=1e-6)
    >>> sparse = dict(sun_mean=1.0, chance=1e-3, correlation_length=0.0026)
    >>> round(float(glint_variance(**sparse, **look)) ** 0.5, 4)
    0.052
    """
    m = patches(cos_incidence, view_zenith, solar_zenith, slant_range, solid_angle, correlation_length)
    return np.asarray(point_variance(sun_mean, chance) / np.maximum(m, 1.0))


def sea_variance(
    view: SeaView, mean: SeaRadiance, elevation: ArrayLike, solid_angle: ArrayLike, correlation: float | WaveGlint
) -> FloatArray:
    """Variance of glint for the lines of sight of a mean radiance.

    Parameters
    ----------
    view : SeaView
        Sensor, sea, air and Sun that ``mean`` was computed with.
    mean : SeaRadiance
        Mean radiance, from :func:`seaglint.radiance.mean_radiance.mean_radiance` or :func:`seaglint.radiance.article.article_radiance`.
    elevation : array_like
        Its elevations [rad, (rows,)].
    solid_angle : array_like
        Solid angle of a detector [sr, scalar or (rows,)].
    correlation : float or WaveGlint
        Side of a cell of the sea [m], or the waves.

    Returns
    -------
    ndarray
        Variance [W2 m-4 sr-2, (rows, columns)]; 0 above the horizon.

    Raises
    ------
    DomainError
        As :func:`glint_variance`.
    """
    rows = np.atleast_1d(np.asarray(elevation, dtype=np.float64))
    theta = view_zenith_of(view.sensor_height, -rows)
    sea = np.isfinite(theta)
    omega = np.broadcast_to(np.asarray(solid_angle, dtype=np.float64), rows.shape)
    distance = slant_range_of(view.sensor_height, surface_range(view.sensor_height, -rows[sea]))
    variance = np.zeros((rows.size, mean.sun.shape[1]))
    # glints of Sun and Moon are independent: their variances add up
    first, second = view.lights
    of_first = mean if mean.moon is None else replace(mean, sun=mean.sun - mean.moon.sun)
    for light, mirrored in ((first, of_first), (second, mean.moon)):
        if light is None or mirrored is None:
            continue
        if isinstance(correlation, WaveGlint):
            shown = mirrored.chance[sea] > 0.0
            cosine = np.where(shown, mirrored.cos_incidence[sea], 1.0)
            up = math.cos(visible_sun(light.solar_zenith)[1])
            look = (theta[sea][:, None], up, distance[:, None], omega[sea][:, None], np.where(shown, mirrored.chance[sea], 1.0))
            share = correlation.relative_variance(view.slopes, light.disc.lit_radius, cosine, *look, light.solar_azimuth)
            variance[sea] += np.where(shown, mirrored.sun[sea] ** 2 * share, 0.0)
            continue
        variance[sea] += glint_variance(
            mirrored.sun[sea],
            mirrored.chance[sea],
            mirrored.cos_incidence[sea],
            theta[sea][:, None],
            light.solar_zenith,
            distance[:, None],
            omega[sea][:, None],
            correlation,
        )
    return variance
