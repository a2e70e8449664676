"""Spectral bands: quadrature over a response, apparent temperature of a band radiance, and spectra averaged over triangles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DataError, DomainError
from seaglint.optics.blackbody import planck_wavenumber

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline


ARTICLE_UNIT: Final = 100.0  #: Number of uW cm-2 sr-1 in one W m-2 sr-1: factor for plots and reports in the source article's unit.

#: Range in which an apparent temperature is searched [K]: colder than any sky, hotter than the Sun.
TEMPERATURE_RANGE: Final = (100.0, 6500.0)

_TEMPERATURE_NODES: Final = 512  # 0.8 % apart: the cubic spline then leaves less than 1e-6 K between them
_GAUSS_X, _GAUSS_W = np.polynomial.legendre.leggauss(6)


@dataclass(frozen=True, eq=False)
class Band:
    """Spectral response against wavelength, linear between its points and zero outside them.

    Make one with :meth:`rectangular` or :meth:`from_response`.
    """

    wavelength_um: FloatArray  #: Ascending wavelengths of the response [um, (m,)].
    response: FloatArray  #: Relative response there, peak 1 [1, (m,)].

    @classmethod
    def rectangular(cls, min_um: float, max_um: float) -> Band:
        """Band with a response of 1 between two wavelengths [um].

        >>> Band.rectangular(3.0, 5.0).max_um
        5.0
        """
        if not (np.isfinite(min_um) and np.isfinite(max_um) and 0.0 < min_um < max_um):
            raise DomainError(
                f"band {min_um:g}-{max_um:g} um is empty; give 0 < min_um < max_um",
                name="band_um",
                value=(min_um, max_um),
                allowed="0 < min_um < max_um",
            )
        return cls(np.array([min_um, max_um], dtype=np.float64), np.ones(2))

    @classmethod
    def from_response(cls, wavelength_um: ArrayLike, response: ArrayLike, *, whole: bool = False) -> Band:
        """Band from a tabulated response [um, (m,)], [any unit, (m,)], scaled to a peak of 1; descending tables are reversed.

        Zeros at the ends are cut off, unless ``whole`` is true.
        """
        w, r = np.asarray(wavelength_um, dtype=np.float64), np.asarray(response, dtype=np.float64)
        if w.ndim != 1 or w.shape != r.shape or w.size < 2:
            raise DataError(f"a response needs two columns of equal length with at least 2 rows, not shapes {w.shape} and {r.shape}")
        if not (np.all(np.isfinite(w)) and np.all(np.isfinite(r))):
            raise DataError("the response contains values that are not finite numbers; remove or repair those rows")
        if w[0] > w[-1]:
            w, r = w[::-1], r[::-1]
        if not np.all(np.diff(w) > 0.0) or w[0] <= 0.0:
            raise DataError("the wavelengths of a response must be positive, in order and all different; sort the table [um]")
        if np.any(r < 0.0) or np.max(r) <= 0.0:
            raise DataError("a response must be >= 0 and somewhere > 0; clip the noise of the measurement to 0")
        if whole:
            return cls(w.copy(), r / np.max(r))
        # Zeros at the ends contribute nothing; without them the grid need not cover a long tail of zeros.
        used = np.flatnonzero(r > 0.0)
        keep = slice(max(int(used[0]) - 1, 0), min(int(used[-1]) + 2, w.size))
        return cls(w[keep].copy(), r[keep] / np.max(r))

    @property
    def min_um(self) -> float:
        """Shortest wavelength [um]."""
        return float(self.wavelength_um[0])

    @property
    def max_um(self) -> float:
        """Longest wavelength [um]."""
        return float(self.wavelength_um[-1])

    def response_at(self, wavenumber_cm: ArrayLike) -> FloatArray:
        """Response [1] at wavenumbers [cm-1], zero outside the band."""
        nu = np.asarray(wavenumber_cm, dtype=np.float64)
        return np.asarray(np.interp(1.0e4 / nu, self.wavelength_um, self.response, left=0.0, right=0.0))

    def weights(self, wavenumber_cm: ArrayLike) -> FloatArray:
        """Quadrature weights of a spectrum sampled on a wavenumber grid.

        ``sum(weights * spectrum)`` is the integral of response times the piecewise linear interpolant of the spectrum between
        the band's edges, which need not be grid points.

        Parameters
        ----------
        wavenumber_cm : array_like
            Ascending grid [cm-1, (n,)].

        Returns
        -------
        ndarray
            Weights [cm-1, (n,)]; zero outside the band.

        Raises
        ------
        DomainError
            A grid that is not ascending or does not cover the band.

        Notes
        -----
        The pieces between grid points and response points are integrated by six Gauss points: exact to rounding for a
        rectangle; a response that is linear in wavelength is a smooth function of wavenumber and leaves less than 1e-12.
        """
        nu = _ascending(wavenumber_cm)
        low, high = 1.0e4 / self.max_um, 1.0e4 / self.min_um
        slack = 1e-9 * high  # 1e4/(1e4/x) is not x to the last bit
        if nu[0] > low + slack or nu[-1] < high - slack:
            raise DomainError(
                f"the band {self.min_um:g}-{self.max_um:g} um reaches beyond the spectral grid {1e4 / nu[-1]:.4g}-{1e4 / nu[0]:.4g} um; "
                "choose a band inside the grid or an atmosphere that covers it",
                name="band_um",
                value=(self.min_um, self.max_um),
                allowed=(1e4 / float(nu[-1]), 1e4 / float(nu[0])),
            )
        breaks = np.unique(np.concatenate([nu, 1.0e4 / self.wavelength_um, [low, high]]))
        breaks = breaks[(breaks >= max(low, nu[0])) & (breaks <= min(high, nu[-1]))]
        half = 0.5 * np.diff(breaks)[:, None]
        x = 0.5 * (breaks[1:] + breaks[:-1])[:, None] + half * _GAUSS_X
        wavelength = np.clip(1.0e4 / x, self.min_um, self.max_um)
        w = half * _GAUSS_W * np.interp(wavelength, self.wavelength_um, self.response)
        # hat functions: each Gauss point gives its weight to the two grid points around it, as the spectrum is linear there
        left = np.clip(np.searchsorted(nu, x, side="right") - 1, 0, nu.size - 2)
        share = (x - nu[left]) / (nu[left + 1] - nu[left])
        out = np.bincount(left.ravel(), ((1.0 - share) * w).ravel(), nu.size)
        return np.asarray(out + np.bincount(left.ravel() + 1, (share * w).ravel(), nu.size))

    def radiance(self, temperature: ArrayLike, wavenumber_cm: ArrayLike) -> FloatArray:
        """Band radiance of a blackbody on the quadrature of a grid [W m-2 sr-1, shape of ``temperature``].

        >>> grid = np.arange(1995.0, 3340.0, 5.0)
        >>> radiance = float(Band.rectangular(3.0, 5.0).radiance(292.4, grid))
        >>> round(ARTICLE_UNIT * radiance, 1)
        140.7
        """
        t = np.asarray(temperature, dtype=np.float64)
        nu = _ascending(wavenumber_cm)
        return np.asarray(planck_wavenumber(nu, t[..., None]) @ self.weights(nu))


def _ascending(wavenumber_cm: ArrayLike) -> FloatArray:
    nu = np.asarray(wavenumber_cm, dtype=np.float64)
    if nu.ndim != 1 or nu.size < 2 or not np.all(np.diff(nu) > 0.0):
        raise DomainError("a spectral grid needs at least 2 ascending wavenumbers [cm-1]")
    return nu


@dataclass(frozen=True, eq=False)
class ApparentTemperature:
    """Temperature of the blackbody whose band radiance equals a given one, for one band on one grid.

    A cubic spline of ln T against ln L through 512 temperatures between 100 and 6500 K, exact to 1e-6 K; one million values
    take about 0.1 s. Radiances outside the range (zero and negative ones with them) give NaN.
    """

    spline: CubicSpline[np.float64]

    @classmethod
    def create(cls, band: Band, wavenumber_cm: ArrayLike) -> ApparentTemperature:
        """Tabulate the inverse for one band and grid."""
        from scipy.interpolate import CubicSpline  # takes half a second, and most programs that read a file need no temperature

        temperature = np.geomspace(*TEMPERATURE_RANGE, _TEMPERATURE_NODES)
        return cls(CubicSpline(np.log(band.radiance(temperature, wavenumber_cm)), np.log(temperature)))

    def __call__(self, band_radiance: ArrayLike) -> FloatArray:
        """Apparent temperature [K] of band radiances [W m-2 sr-1], same shape; NaN outside 100-6500 K."""
        radiance = np.asarray(band_radiance, dtype=np.float64)
        with np.errstate(invalid="ignore", divide="ignore"):
            x = np.log(radiance)
        # The ends of the table itself must not fall off it by rounding.
        first, last = self.spline.x[0], self.spline.x[-1]
        inside = (x >= first - 1e-12) & (x <= last + 1e-12)
        return np.asarray(np.exp(self.spline(np.where(inside, x, np.nan))))


@lru_cache(maxsize=8)
def _cached_inverse(wavelength_um: bytes, response: bytes, wavenumber_cm: bytes) -> ApparentTemperature:
    band = Band(np.frombuffer(wavelength_um), np.frombuffer(response))
    return ApparentTemperature.create(band, np.frombuffer(wavenumber_cm))


def apparent_temperature(band_radiance: ArrayLike, band: Band, wavenumber_cm: ArrayLike) -> FloatArray:
    """Blackbody temperature whose response-weighted radiance equals a band radiance.

    The temperature T of ``L = integral R(nu) B(nu, T) dnu`` with the response R and Planck's law B
    (:func:`~seaglint.optics.blackbody.planck_wavenumber`).

    Parameters
    ----------
    band_radiance : array_like
        Radiance integrated over the response [W m-2 sr-1].
    band : Band
        The response it was integrated over.
    wavenumber_cm : array_like
        Spectral grid of the computation that made the radiance [cm-1, (n,)]: with the same grid an isothermal scene comes
        back at its own temperature to rounding.

    Returns
    -------
    ndarray
        Temperature [K], same shape; NaN for radiances of no temperature between 100 and 6500 K. An xarray.DataArray keeps its
        dimensions and coordinates.

    Examples
    --------
    >>> grid = np.arange(1995.0, 3340.0, 5.0)
    >>> band = Band.rectangular(3.0, 5.0)
    >>> round(float(apparent_temperature(1.45, band, grid)), 1)
    293.2
    """
    nu = _ascending(wavenumber_cm)
    inverse = _cached_inverse(band.wavelength_um.tobytes(), band.response.tobytes(), nu.tobytes())
    temperature = inverse(band_radiance)
    # Labelled arrays (xarray) wrap results by NumPy's protocol: dimensions and coordinates stay, name and units are new.
    if isinstance(band_radiance, np.ndarray | np.generic) or not hasattr(band_radiance, "__array_wrap__"):
        return temperature
    labelled: Any = band_radiance.__array_wrap__(temperature)
    labelled.name = "apparent_temperature"
    labelled.attrs = {"units": "K", "long_name": "apparent temperature"}
    return labelled  # type: ignore[no-any-return]


def triangular_average(wavenumber_cm: FloatArray, spectrum: FloatArray, centres_cm: FloatArray, width_cm: float = 20.0) -> FloatArray:
    """Average a spectrum with a triangle about each centre, of a full width at half maximum ``width_cm`` [unit of spectrum, (n,)].

    ``integral w(nu) S(nu) dnu / integral w(nu) dnu`` with ``w = max(0, 1 - |nu - centre| / width_cm)``.

    Parameters
    ----------
    wavenumber_cm : ndarray
        Ascending samples [cm-1, (m,)]; they may lie unevenly.
    spectrum : ndarray
        Values there, linear between them [(m,)].
    centres_cm : ndarray
        Middles of the triangles [cm-1, (n,)]. A triangle that reaches beyond the samples is cut there.
    width_cm : float
        Full width at half maximum [cm-1]; the triangle ends this far from its middle.

    Returns
    -------
    ndarray
        Averages [unit of spectrum, (n,)].

    Examples
    --------
    >>> nu = np.arange(900.0, 1000.5, 0.5)
    >>> triangular_average(nu, nu, np.array([950.0]))
    array([950.])
    """
    # the gradient of the grid weighs uneven samples; the sum divides it out where a triangle is cut
    weight = np.maximum(1.0 - np.abs(centres_cm[:, None] - wavenumber_cm) / width_cm, 0.0) * np.gradient(wavenumber_cm)
    return np.asarray(weight @ spectrum / weight.sum(axis=1))
