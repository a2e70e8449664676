r"""Slope statistics of the sea: variances along and across the wind, Gram-Charlier coefficients, and the density that they define.

**Light winds.** The straight lines through measured slope variances end at 0 m/s in an unphysical sea: Cox and Munk's has 0.003 across
the wind and no variance along it, so that a picture would depend on a wind direction that does not exist. Below the winds at which a fit
stops making sense slopes follow from measured numbers alone:

- Waves are never steeper across the wind than along it. Cox and Munk's ratio of the crosswind variance to the upwind one is between
  0.54 and 1.0 in their photographs (mean 0.75), in light winds too. Below the wind at which the lines cross, 2.42 m/s, both directions have
  half of the fit's total: 0.003 in all at 0 m/s, as in Cox and Munk's isotropic law.
- A film damps waves and never raises them. In no direction has a slick sea more slope variance than a clean one.
- Skewness and peakedness are caused by the wind. They fall in proportion to the wind below the same speed, to a Gaussian sea in a calm.
- Wind seas of the models end at 0.5 m/s. From there to 0 the direction of long waves, which the law of shadowing takes into account,
  falls in proportion to the wind (:attr:`~seaglint.sea.slopes.slope_statistics.SlopeStatistics.directed`).

At most 0.0015 is moved from one direction to the other in this way, at 0 m/s; Cox and Munk state 0.002 (across) and 0.004 (along) as the
standard deviations of their observations from the lines. Above the joining wind a fit is used as published.

References
----------
Cox and Munk 1954, J. Opt. Soc. Am. 44, 838: straight lines, their standard deviations, and the range of the ratio.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError

SHORTEST: Final = 2.0 * np.pi / 0.01  #: Wavenumber of the shortest waves that carry slopes [rad/m].

RESIDUAL: Final = 0.003  #: Slope variance of a clean sea without wind, in all directions together [1]: Cox and Munk's total at 0 m/s.


@dataclass(frozen=True)
class SlopeStatistics:
    """Statistics of sea-surface slopes: Gaussian, or a Gram-Charlier series about the Gaussian of the same variances."""

    mss_up: float  #: Mean square slope along the wind [1].
    mss_cross: float  #: Mean square slope across the wind [1].
    wind_to_azimuth: float = 0.0  #: Azimuth the wind blows TO, clockwise from north [rad]; any value for an isotropic sea.
    c21: float = 0.0  #: Mixed skewness coefficient of :meth:`density` [1]; negative where lee faces are the steeper ones.
    c03: float = 0.0  #: Upwind skewness coefficient [1], sign as ``c21``.
    c40: float = 0.0  #: Crosswind peakedness coefficient [1].
    c22: float = 0.0  #: Mixed peakedness coefficient [1].
    c04: float = 0.0  #: Upwind peakedness coefficient [1].
    #: Wavenumbers [rad/m], and covariances of the slopes of all longer waves, up, cross and both [1], from none to all waves; see
    #: :meth:`growth`.
    nesting: tuple[tuple[float, float, float, float], ...] = ()
    #: Share of their direction that long waves have in a light wind, from 0 without wind to 1 [1]; by default 1, or 0 on an isotropic
    #: sea.
    directed: float | None = None

    def __post_init__(self) -> None:
        """Refuse variances that are negative or not finite, and a series about a Gaussian of zero width."""
        values = (self.mss_up, self.mss_cross, self.wind_to_azimuth)
        if not all(np.isfinite(values)) or self.mss_up < 0.0 or self.mss_cross < 0.0:
            message = f"slope variances ({self.mss_up:g}, {self.mss_cross:g}) must be finite and at least 0"
            raise DomainError(message, name="mss", value=(self.mss_up, self.mss_cross), allowed="0 or more, finite")
        if not all(np.isfinite(self.coefficients)):
            raise DomainError(f"Gram-Charlier coefficients {self.coefficients} must be finite numbers")
        if not self.is_gaussian and min(self.mss_up, self.mss_cross) == 0.0:
            raise DomainError(
                f"Gram-Charlier coefficients need slope variance along and across the wind, not ({self.mss_up:g}, {self.mss_cross:g}); "
                "leave the coefficients at 0"
            )

    @property
    def coefficients(self) -> tuple[float, float, float, float, float]:
        """Gram-Charlier coefficients (c21, c03, c40, c22, c04) [1]."""
        return self.c21, self.c03, self.c40, self.c22, self.c04

    @property
    def is_gaussian(self) -> bool:
        """True if the density is the Gaussian of the two variances, without Gram-Charlier coefficients."""
        return not any(self.coefficients)

    def gaussian(self) -> SlopeStatistics:
        """Gaussian statistics with the same variances and wind direction."""
        return SlopeStatistics(self.mss_up, self.mss_cross, self.wind_to_azimuth, nesting=self.nesting, directed=self.directed)

    @property
    def mss(self) -> float:
        """Total mean square slope, the sum over two orthogonal directions [1]."""
        return self.mss_up + self.mss_cross

    @property
    def is_isotropic(self) -> bool:
        """True if all directions are alike: the same variance both ways and no Gram-Charlier coefficient."""
        return self.mss_up == self.mss_cross and self.is_gaussian

    @property
    def is_flat(self) -> bool:
        """True if both slope variances are 0."""
        return self.mss == 0.0

    def mss_along(self, azimuth: ArrayLike) -> FloatArray:
        """Variance of the slope along a horizontal direction [1].

        ``sigma^2(phi) = mss_up cos^2(phi - phi_wind) + mss_cross sin^2(phi - phi_wind)``
        """
        angle = np.asarray(azimuth, dtype=np.float64) - self.wind_to_azimuth
        return np.asarray(self.mss_up * np.cos(angle) ** 2 + self.mss_cross * np.sin(angle) ** 2)

    def growth(self) -> FloatArray:
        r"""Wavenumbers [rad/m], and covariances of the slopes of longer waves [1, (n, 4)]: up, cross, and of both, from none to all.

        The numbers of :attr:`nesting` if a spectrum gave them (``nested_in``). Without a spectrum
        a fitted shape: with x the share of the total variance, even over the logarithm of the wavenumber within exp(8.5), and a the part of
        it by which waves along the wind exceed waves across it,

        .. math:: \frac{a(x)}{x} = a(1) + n(x) - n(1), \qquad n(x) = \frac{\max[0, 1/2 - |a(1)|]}{1 + (x\,\sigma^2/0.0108)^{2.2}}

        fitted within 0.05 to Elfouhaily's spectrum from 2 to 18 m/s: its longest waves have three quarters of their variance along the
        wind, whatever the wind, and make up a slope variance of about 0.01. Isotropic slopes are so at all lengths, and n is multiplied
        with :attr:`directed` in light winds.
        """
        if self.nesting:
            return np.array(self.nesting)
        x, total = np.linspace(0.0, 1.0, 41), self.mss
        share = (self.mss_up - self.mss_cross) / total if total > 0.0 else 0.0
        directed = self.directed if self.directed is not None else float(not self.is_isotropic)
        narrow = directed * max(0.5 - abs(share), 0.0) / (1.0 + (x * total / 0.0108) ** 2.2)
        apart = x * (share + narrow - narrow[-1])
        k = SHORTEST * np.exp(8.5 * (x - 1.0))
        return np.stack([k, 0.5 * total * (x + apart), 0.5 * total * (x - apart), 0.0 * x], axis=1)

    def covariance(self) -> tuple[float, float, float]:
        """Covariance of the slopes towards (east, north): (east-east, east-north, north-north) [1]."""
        s, c = float(np.sin(self.wind_to_azimuth)), float(np.cos(self.wind_to_azimuth))
        return (
            self.mss_up * s * s + self.mss_cross * c * c,
            (self.mss_up - self.mss_cross) * s * c,
            self.mss_up * c * c + self.mss_cross * s * s,
        )

    def density(self, slope_east: ArrayLike, slope_north: ArrayLike) -> FloatArray:
        r"""Probability density of the slope vector (dz/dx east, dz/dy north), per unit area of the sea [1/slope²].

        With ``xi`` the slope across the wind and ``eta`` the slope towards where the wind comes FROM, each over its rms value,

        .. math::

            p = \frac{e^{-(\xi^2 + \eta^2)/2}}{2 \pi \sigma_u \sigma_c} \Bigl[1 - \frac{c_{21}}{2} (\xi^2 - 1) \eta
                - \frac{c_{03}}{6} (\eta^3 - 3 \eta) + \frac{c_{40}}{24} (\xi^4 - 6 \xi^2 + 3)
                + \frac{c_{22}}{4} (\xi^2 - 1)(\eta^2 - 1) + \frac{c_{04}}{24} (\eta^4 - 6 \eta^2 + 3)\Bigr]

        and 0 where the bracket is negative. For an isotropic Gaussian sea of total variance ``sigma^2`` this is the article's
        ``exp(-tan^2(beta)/sigma^2)/(pi sigma^2)``.

        Raises
        ------
        DomainError
            If a variance is zero: such a sea has no density, only mirror reflection.

        Notes
        -----
        The series itself integrates to 1 and has the stated variances; setting its negative values to 0 adds mass, as
        a model's notes state. No factor compensates for it, so that the density is the printed one;
        the areas of :mod:`seaglint.sea.shadowing.smith` are integrals over this same density, which is what conserves energy.

        References
        ----------
        Cox and Munk 1954, J. Opt. Soc. Am. 44, 838, Eq. 18.
        """
        if self.mss_up <= 0.0 or self.mss_cross <= 0.0:
            raise DomainError("a sea without slope variance has no slope density; treat it as a mirror or give a wind above 0 m/s")
        east = np.asarray(slope_east, dtype=np.float64)
        north = np.asarray(slope_north, dtype=np.float64)
        s, c = np.sin(self.wind_to_azimuth), np.cos(self.wind_to_azimuth)
        along, cross = east * s + north * c, east * c - north * s
        exponent = -0.5 * (along * along / self.mss_up + cross * cross / self.mss_cross)
        gaussian = np.exp(exponent) / (2.0 * np.pi * np.sqrt(self.mss_up * self.mss_cross))
        if self.is_gaussian:
            return np.asarray(gaussian)
        return np.asarray(gaussian * self.shape(cross / np.sqrt(self.mss_cross), -along / np.sqrt(self.mss_up)))

    def shape(self, xi: ArrayLike, eta: ArrayLike) -> FloatArray:
        """Ratio of the density to the Gaussian of the same variances, at least 0 [1].

        Parameters
        ----------
        xi, eta : array_like
            Slopes across the wind, and towards where the wind comes FROM, over their rms values [1].
        """
        return np.asarray(np.maximum(gram_charlier(xi, eta, self.coefficients), 0.0))


def gram_charlier(xi: ArrayLike, eta: ArrayLike, coefficients: tuple[float, float, float, float, float]) -> FloatArray:
    """Series bracket of :meth:`SlopeStatistics.density`, negative values included [1]; ``coefficients`` are (c21, c03, c40, c22, c04)."""
    return np.asarray(series_bracket(np.asarray(xi, dtype=np.float64), np.asarray(eta, dtype=np.float64), coefficients))


def series_bracket(x: Any, y: Any, coefficients: tuple[float, float, float, float, float]) -> Any:
    """Bracket of the Gram-Charlier series for arrays or floats [1], arithmetic alone, so that kernels can compile it."""
    c21, c03, c40, c22, c04 = coefficients
    xx, yy = x * x, y * y
    skewness = -y * (0.5 * c21 * (xx - 1.0) + c03 / 6.0 * (yy - 3.0))
    peakedness = c40 / 24.0 * (xx * xx - 6.0 * xx + 3.0) + 0.25 * c22 * (xx - 1.0) * (yy - 1.0) + c04 / 24.0 * (yy * yy - 6.0 * yy + 3.0)
    return 1.0 + skewness + peakedness


def gaussian_slopes(up: float, cross: float, covariance: float, wind_to_azimuth: float) -> SlopeStatistics:
    """Gaussian slope statistics from a covariance, expressed along its principal axes.

    Parameters
    ----------
    up, cross : float
        Variances along the wind and to the right of it [1].
    covariance : float
        Covariance of the two [1]; without it the axes are along and across the wind.
    wind_to_azimuth : float
        Azimuth the wind blows TO [rad].

    Returns
    -------
    SlopeStatistics
        Variances [1] along the principal axes, and the azimuth of the first [rad].

    Examples
    --------
    >>> slopes = gaussian_slopes(0.02, 0.01, 0.003, 0.5)
    >>> [round(float(slopes.mss_along(0.5 + a)), 4) for a in (0.0, np.pi / 4, np.pi / 2)]
    [0.02, 0.018, 0.01]
    """
    if covariance == 0.0:
        return SlopeStatistics(up, cross, wind_to_azimuth)
    # principal axes of the 2 x 2 covariance: its mean plus and minus the radius of Mohr's circle
    mean, half = 0.5 * (up + cross), 0.5 * (up - cross)
    radius = float(np.hypot(half, covariance))
    return SlopeStatistics(mean + radius, mean - radius, wind_to_azimuth + 0.5 * float(np.arctan2(covariance, half)))


def flat() -> SlopeStatistics:
    """Slope statistics of a flat sea, a mirror."""
    return SlopeStatistics(0.0, 0.0)


def joined_in_calm(
    variances: tuple[float, float],
    coefficients: tuple[float, float, float, float, float],
    wind_to_azimuth: float,
    winds: tuple[float, float, float],
) -> SlopeStatistics:
    """Return the slopes of a fit at a wind, without direction at 0 m/s and as published from ``join`` on.

    Parameters
    ----------
    variances : tuple of float
        Variances of the fit along and across the wind [1].
    coefficients : tuple of float
        Gram-Charlier coefficients of the fit, (c21, c03, c40, c22, c04) [1].
    wind_to_azimuth : float
        Azimuth the wind blows TO [rad].
    winds : tuple of float
        Wind, the wind from which the fit holds, and the lightest wind of wind seas (``LIGHTEST`` at 10 m), all at the height of the
        fit [m s⁻¹].

    Examples
    --------
    >>> calm = joined_in_calm((0.0, 0.003), (0.01, 0.04, 0.4, 0.12, 0.23), 1.0, (0.0, 2.42, 0.51))
    >>> calm.is_isotropic, calm.mss
    (True, 0.003)
    """
    wind, join, lightest = winds
    if wind >= join:
        return SlopeStatistics(*variances, wind_to_azimuth, *coefficients)
    up, cross = variances
    # waves are never steeper across the wind than along it
    if cross > up:
        up = cross = 0.5 * (up + cross)
    c21, c03, c40, c22, c04 = (wind / join * coefficient for coefficient in coefficients)
    return SlopeStatistics(up, cross, wind_to_azimuth, c21, c03, c40, c22, c04, directed=min(wind / lightest, 1.0))


def at_least_residual(slopes: SlopeStatistics) -> SlopeStatistics:
    """Return slopes of a wind sea with at least half of ``RESIDUAL`` in every direction, as a sea without wind has.

    Examples
    --------
    >>> calm = at_least_residual(SlopeStatistics(0.0, 0.0))
    >>> calm.is_isotropic, calm.mss
    (True, 0.003)
    """
    least = 0.5 * RESIDUAL
    if min(slopes.mss_up, slopes.mss_cross) >= least:
        return slopes
    up, cross = max(slopes.mss_up, least), max(slopes.mss_cross, least)
    return replace(slopes, mss_up=up, mss_cross=cross, directed=slopes.mss / (up + cross))
