"""Fresnel reflection of unpolarised light from an absorbing medium."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError


def reflectance(cos_incidence: ArrayLike, index: ArrayLike) -> FloatArray:
    r"""Unpolarised power reflectance of a plane surface between air and a medium of complex index.

    .. math::

        r_s = \frac{c - q}{c + q}, \quad r_p = \frac{m^2 c - q}{m^2 c + q}, \quad q = \sqrt{m^2 - 1 + c^2}, \quad
        \rho = \tfrac12 (|r_s|^2 + |r_p|^2)

    Parameters
    ----------
    cos_incidence : array_like
        Cosine c of the angle of incidence [1], 0 (grazing) to 1 (normal).
    index : array_like
        Complex refractive index m = n + i k [1]; broadcast against ``cos_incidence``.

    Returns
    -------
    ndarray
        Reflectance [1], 1 at grazing incidence.

    Raises
    ------
    DomainError
        A cosine outside 0..1.

    References
    ----------
    Born and Wolf, Principles of Optics, 7th ed., section 14.2 (Fresnel's formulae with a complex index).

    Examples
    --------
    >>> round(float(reflectance(1.0, 1.33)), 5)
    0.02006
    """
    c = np.asarray(cos_incidence, dtype=np.float64)
    # Cosines come out of dot products: a few units of rounding above 1 are 1.
    if np.any((c < 0.0) | (c > 1.0 + 1e-12)):
        raise DomainError(
            f"cosine of incidence between {float(np.min(c)):g} and {float(np.max(c)):g}; it must lie in 0..1 (facets seen from above)",
            name="cos_incidence",
            value=float(c[(c < 0.0) | (c > 1.0)].ravel()[0]),
            allowed=(0.0, 1.0),
        )
    m2 = np.square(np.asarray(index, dtype=np.complex128))
    q = np.sqrt(m2 - (1.0 - np.minimum(c, 1.0) ** 2))
    r_s = (c - q) / (c + q)
    r_p = (m2 * c - q) / (m2 * c + q)
    return np.asarray(0.5 * (r_s.real**2 + r_s.imag**2 + r_p.real**2 + r_p.imag**2))


@dataclass(frozen=True, eq=False)
class ReflectanceSeries:
    """Fresnel reflectance of one spectrum of indices as a Chebyshev series in the cosine of incidence.

    ``rho(c, nu) = sum_j a_j(nu) T_j(2 c - 1)``. Sixteen terms leave less than 2e-8 for water at any infrared wavelength, and
    spectral sums over ``a_j`` can be taken before any direction is known.
    """

    coefficients: FloatArray  #: Chebyshev coefficients ``a_j`` [1, (terms, n)].

    @classmethod
    def of(cls, index: ArrayLike, terms: int = 16) -> ReflectanceSeries:
        """Series for complex indices [1, (n,)]."""
        # interpolation at as many Chebyshev points as terms is nearly the best polynomial of this degree
        nodes = chebyshev.chebpts1(terms)
        rho = reflectance(0.5 * (1.0 + nodes)[:, None], np.asarray(index, dtype=np.complex128)[None, :])
        return cls(np.asarray(np.linalg.solve(chebyshev.chebvander(nodes, terms - 1), rho)))

    @property
    def terms(self) -> int:
        """Number of terms."""
        return int(self.coefficients.shape[0])

    def basis(self, cos_incidence: ArrayLike) -> FloatArray:
        """Shifted Chebyshev polynomials ``T_j(2 c - 1)`` of cosines of incidence [1, (..., terms)]."""
        return np.asarray(chebyshev.chebvander(2.0 * np.asarray(cos_incidence, dtype=np.float64) - 1.0, self.terms - 1))

    def __call__(self, cos_incidence: ArrayLike) -> FloatArray:
        """Reflectance [1, (..., n)] at cosines of incidence in 0..1."""
        return np.asarray(self.basis(cos_incidence) @ self.coefficients)
