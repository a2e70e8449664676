"""Basis for spectral products along the line of sight: integrals per wavenumber from sums over a few terms.

A pixel needs ``int R(nu) tau(nu; range) X(nu; facet) dnu`` for millions of facets. The transmittances from one height span a
small space: with ``tau(nu; r) ~ sum_k a_k(r) phi_k(nu)`` the integral is ``sum_k a_k(r) int R phi_k X dnu``, and the
inner integrals depend on the facet alone. The number of terms is chosen from the error that it leaves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from seaglint.air.protocol import Atmosphere
from seaglint.base.conventions import FloatArray
from seaglint.facet.sea_view import BandSum
from seaglint.optics.band import Band

#: Largest error of any range's transmittance spectrum, RMS over the band relative to its mean. Band products, which average over the
#: spectrum, are then within 5e-5 of all terms, for seven terms in 3.5-5 um.
RELATIVE_ERROR = 2e-3

PRODUCT_ERROR = 1e-4  #: RMS error relative to the products, over facets and ranges, that ``fewest_terms`` leaves.

TOGETHER = 4  #: Number of terms that kernels process at once; the thermal tables have a multiple of it.

NODES = 320  #: Number of ranges at which the atmosphere is evaluated; the coefficients between them are splined in log range.


@dataclass(frozen=True)
class PathBasis:
    """Transmittance and path radiance from one sensor height, ready for band products."""

    wavenumber_cm: FloatArray  #: Samples inside the band [cm-1, (n,)].
    grid: slice  #: Position of these samples on the atmosphere's grid.
    phi: FloatArray  #: Basis of transmittance spectra [1, (k, n)].
    weights: FloatArray  #: Quadrature weights of the band [cm-1, (n,)].
    coefficients: FloatArray  #: ``a_k`` at the requested ranges [1, (m, k)].
    path_radiance: FloatArray  #: Thermal path radiance in the band [W m-2 sr-1, (m,)].

    def project(self, spectra: FloatArray) -> FloatArray:
        """Band integrals ``int R phi_k X dnu``: (..., n) [X] to (..., k) [X cm-1]."""
        return np.asarray(spectra @ (self.phi * self.weights).T)


def path_basis(atmosphere: Atmosphere, band: Band, height: float, range_m: FloatArray) -> PathBasis:
    """Basis and coefficients for the sea points at arcs ``range_m`` [m] (ascending) viewed from ``height`` [m]."""
    from scipy.interpolate import CubicSpline

    in_band = BandSum.of(band, atmosphere)
    weights, grid = in_band.weights, in_band.grid
    lowest = max(float(range_m[0]), 0.05 * height)
    nodes = np.geomspace(lowest, float(range_m[-1]) * (1.0 + 1e-9), NODES) if range_m[-1] > lowest else np.array([lowest, lowest * 1.01])
    tau = np.maximum(np.asarray(atmosphere.transmittance(height, nodes))[:, grid], 0.0)
    path = in_band(atmosphere.path_radiance(height, nodes))

    mean = np.maximum((tau @ weights) / weights.sum(), 1e-30)
    root = np.sqrt(np.maximum(weights, 1e-6 * weights.max()) / weights.sum())
    # each row over its mean: far ranges with little transmittance count as much as near ones
    u, s, vt = np.linalg.svd(tau / mean[:, None] * root, full_matrices=False)
    # residual[j, k]: RMS over the band left at node j by the first k + 1 terms.
    energy = (u * s) ** 2
    residual = np.sqrt(np.maximum(energy.sum(axis=1, keepdims=True) - np.cumsum(energy, axis=1), 0.0))
    terms = int(np.argmax(residual.max(axis=0) < RELATIVE_ERROR)) + 1
    phi = vt[:terms] / root
    log_nodes = np.log(nodes)
    log_range = np.log(np.maximum(range_m, lowest))
    coefficients = CubicSpline(log_nodes, (u * s)[:, :terms] * mean[:, None], axis=0)(log_range)
    return PathBasis(
        in_band.wavenumber_cm, grid, phi, weights, np.ascontiguousarray(coefficients), np.asarray(CubicSpline(log_nodes, path)(log_range))
    )


def fewest_terms(tables: FloatArray, coefficients: FloatArray, together: int = 1) -> tuple[FloatArray, FloatArray]:
    """Reduce tables (..., k) and coefficients (m, k) to the fewest terms with the same products ``tables @ coefficients.T`` [any unit].

    The light of facets varies less between facets than spectra can: two or three terms do the work of seven. Facets and ranges count
    alike, whatever their radiance. Their number is a multiple of ``together``.
    """
    facets = tables.reshape(-1, tables.shape[-1]).astype(np.float64)
    size = np.linalg.norm(facets @ coefficients.T[:, :: max(coefficients.shape[0] // 16, 1)], axis=1, keepdims=True)
    scale = np.linalg.norm(coefficients, axis=1, keepdims=True)
    _, r = np.linalg.qr(coefficients / np.maximum(scale, 1e-300))
    product = (facets / np.maximum(size, 1e-300)) @ r.T
    energy, vectors = np.linalg.eigh(product.T @ product)
    energy, vectors = np.maximum(energy[::-1], 0.0), vectors[:, ::-1]
    omitted = energy.sum() - np.cumsum(energy)
    terms = int(np.argmax(omitted <= PRODUCT_ERROR**2 * energy.sum())) + 1
    terms = -(-terms // together) * together
    selected = np.zeros((vectors.shape[0], terms))
    selected[:, : min(terms, vectors.shape[1])] = vectors[:, :terms]
    # product = facets r^T selected selected^T, so with coefficients = q r it is the pair (facets r^T selected, q selected)
    mixed = np.linalg.solve(r, selected) if np.linalg.matrix_rank(r) == r.shape[0] else np.linalg.pinv(r) @ selected
    return (facets @ (r.T @ selected)).reshape(*tables.shape[:-1], terms), np.ascontiguousarray(coefficients @ mixed)
