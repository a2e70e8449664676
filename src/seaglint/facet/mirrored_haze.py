r"""Scattered sky light mirrored by facets: averages over their slopes, tabulated on the axes of the thermal light.

Unlike the thermal sky it depends on the azimuth from the Sun. Its aureole is some ten degrees wide, as the facets' slopes blur
it, so that sums over slopes need close nodes. They are convolutions: with ``a`` the slope towards the viewer, ``c`` the slope
across and ``d = c - lean a``, the density of a facet's slopes is a product of Gaussians of ``a`` and ``d`` about the facet's tilt, while
the light that a slope mirrors does not depend on the tilt. So for every grazing angle and azimuth each slope is looked up once for all
tilts.

Averages over slope statistics are in ``seaglint.facet.scattered``; each quadrature is the other's check.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from seaglint.air.scattering.scattered_light import ScatteredTable, amplitudes_at
from seaglint.base.conventions import FloatArray, horizon_range, view_zenith_of_range
from seaglint.base.jit import in_threads, kernel, njit
from seaglint.facet.path_basis import PathBasis
from seaglint.facet.roughness import Roughness, along
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sky import is_dark
from seaglint.facet.sunlight import turn_at, turn_kernel, turned_kernel
from seaglint.facet.thermal import FARTHEST_TURNED_AWAY, band_reflectance
from seaglint.sea.shadowing.nested import nested_exponent_kernel

#: Root-mean-square error of the sky's spectra, relative to each, left by the spectral shapes; sums over the band keep a tenth.
SPECTRAL_ERROR: Final = 3e-3

#: Root-mean-square error, relative to each, of the mirrored spectra times the path's transmittance, left by the band terms.
TERM_ERROR: Final = 1e-4

#: Number of sky nodes uniform in the square root of the sine of elevation; amplitudes are smooth, as the aureole depends on the angle.
ELEVATIONS: Final = 129

ANGLES: Final = 513  #: Number of nodes uniform in the sine of half the scattering angle, 0.22 deg apart at the Sun.

SUNS: Final = 5  #: Number of zenith angles of the Sun over the sea in view, where it differs.

FEW_SUNS: Final = math.radians(1.0)  #: Range of zenith angles of the Sun of which the two ends suffice [rad].

REACH: Final = 4.5  #: Largest facet slope that is summed, in standard deviations: 7e-6 of the slopes lie beyond.

#: Largest panel of six nodes along the view and step across it, in slope: four and a half degrees of mirrored light from node to node.
ALONG_PANEL, ACROSS_STEP = 0.2, 0.04

SMOOTHEST: Final = 0.004  #: Least resolved deviation of slopes; smoother facets blur the sky by half a degree, the Sun's own width.


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)
NODES: Final = tuple(float(v) for v in _NODES)
WEIGHTS: Final = tuple(float(v) for v in _WEIGHTS)


class HazySky(NamedTuple):
    """Scattered sky over the sea: ``shares[t, j, i, r]`` of spectral shapes over the Sun's zenith angle, elevation and scattering angle.

    ``sun = (zenith angle [rad] of the first t, t per rad)``, the latter 0 for one Sun alone.
    """

    shares: np.ndarray
    sun: tuple[float, float]


class HazyFacets(NamedTuple):
    """Scattered sky light mirrored by facets: ``reflected[c, r, q]`` over the cosine of incidence.

    These are band terms of the spectral shapes; the other field is the unit vector to the Sun at the sensor's foot (east, north, up).
    """

    sky: HazySky
    reflected: np.ndarray
    sun: tuple[float, float, float]


class Lines(NamedTuple):
    """Lines of sight of a table.

    Sines of the grazing angle, turn of the vertical there [rad], azimuths [rad]; nodes of slopes along and across the view.
    """

    sine: np.ndarray
    turn: np.ndarray
    azimuth: np.ndarray
    along: np.ndarray
    across: np.ndarray


def hazy_sky(table: ScatteredTable, weights: FloatArray) -> tuple[HazySky, FloatArray]:
    """Scattered sky of a table, for its Suns, on the nodes that facets read, and its spectral shapes [W m-2 sr-1 per cm-1, (r, n)].

    The number of shapes is the smallest that the band allows.

    ``weights``: quadrature weights of the band [cm-1, (n,)].
    """
    suns, _, columns, count, spectra = table.amplitude.shape
    first, per_radian = table.suns if suns > 1 else (table.solar_zenith, 0.0)
    zenith = first + np.arange(suns) / per_radian if suns > 1 else np.array([first])
    elevation = np.arcsin(np.linspace(0.0, 1.0, ELEVATIONS) ** 2)
    half = np.linspace(0.0, 1.0, ANGLES)
    amplitude = np.empty((suns, ELEVATIONS, columns, count, spectra))
    amplitudes_at(elevation, table, amplitude)
    angle = np.linspace(0.0, math.pi, table.angular.shape[0])
    phase = np.stack([np.interp(2.0 * np.arcsin(half), angle, k) for k in table.angular.T], axis=1)
    some = np.einsum("ik,tjakr->tjiar", phase[::32], amplitude[:, ::8, ::4]).reshape(-1, spectra)
    mixed, spectral = _fewest_shapes(some, table.spectral, weights)
    shares = np.empty((suns, ELEVATIONS, ANGLES, mixed.shape[1]))
    _fill_shares(elevation, half, zenith, phase, np.ascontiguousarray(amplitude @ mixed), shares)
    return HazySky(shares, (first, per_radian)), spectral


@njit
def _fill_shares(
    elevation: np.ndarray, half: np.ndarray, zenith: np.ndarray, phase: np.ndarray, amplitude: np.ndarray, shares: np.ndarray
) -> None:
    """Fill the shares ``[t, j, i, r]`` of ``hazy_sky``: phase functions times amplitudes at the azimuth of a scattering angle.

    ``half``: sines of half the scattering angles. Angles that an elevation does not have take the amplitude of the nearest azimuth.
    """
    columns = amplitude.shape[2]
    for t in range(zenith.size):
        for j in range(elevation.size):
            lean = math.sin(0.5 * (0.5 * math.pi - elevation[j] - zenith[t]))
            flat = max(math.cos(elevation[j]) * math.sin(zenith[t]), 1e-9)
            for i in range(half.size):
                column = min(max((half[i] * half[i] - lean * lean) / flat, 0.0), 1.0) * (columns - 1)
                a = min(int(column), columns - 2)
                f = column - a
                for r in range(shares.shape[3]):
                    total = 0.0
                    for k in range(phase.shape[1]):
                        total += phase[i, k] * ((1.0 - f) * amplitude[t, j, a, k, r] + f * amplitude[t, j, a + 1, k, r])
                    shares[t, j, i, r] = total


def _fewest_shapes(shares: FloatArray, spectral: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Matrix (r, fewer) from shares to shares of fewer spectral shapes, and these shapes (fewer, n), for spectra ``shares @ spectral``."""
    _, r = np.linalg.qr((spectral * np.sqrt(np.maximum(weights, 0.0))).T)
    seen = shares @ r.T
    size = np.linalg.norm(seen, axis=1, keepdims=True)
    significant = size[:, 0] > 1e-6 * size.max()
    _, s, vt = np.linalg.svd(seen[significant] / size[significant], full_matrices=False)
    left = np.sqrt(np.maximum(1.0 - np.cumsum(s**2) / np.sum(s**2), 0.0))
    count = int(np.argmax(left <= SPECTRAL_ERROR)) + 1
    mixed = r.T @ vt[:count].T
    # least squares for spectra from shares
    weighted = shares[significant] / size[significant]
    return mixed, np.asarray(np.linalg.lstsq(weighted @ mixed, weighted @ spectral, rcond=None)[0])


def hazy_facets(view: SeaView, basis: PathBasis) -> tuple[HazyFacets, FloatArray] | None:
    """Light mirrored by facets [W m-2 sr-1], and the matrix [1, (q, k)] from its band terms to the terms of the path's basis.

    None in darkness.
    """
    table = view.scattered.sea_sky_within(view.farthest_turn, SUNS if 2.0 * view.farthest_turn > FEW_SUNS else 2)
    if is_dark(table):
        return None
    sky, spectral = hazy_sky(table, basis.weights)
    rho = band_reflectance(basis, view.water)
    weighted = view.sun_distance_factor * basis.weights * spectral
    exact = np.stack([(rho * r) @ basis.phi.T for r in weighted], axis=1)
    # band terms that serve the products with all paths, of shapes as bright as they come
    _, r = np.linalg.qr(basis.coefficients / np.linalg.norm(basis.coefficients, axis=1, keepdims=True))
    bright = np.sqrt(np.mean(sky.shares**2, axis=(0, 1, 2)))
    product = exact @ r.T
    _, s, vt = np.linalg.svd((product * bright[:, None]).reshape(-1, product.shape[-1]), full_matrices=False)
    left = np.sqrt(np.maximum(1.0 - np.cumsum(s**2) / np.sum(s**2), 0.0))
    count = int(np.argmax(left <= TERM_ERROR)) + 1
    sz, cz, sa, ca = (f(a) for a in (view.solar_zenith, view.solar_azimuth) for f in (math.sin, math.cos))
    terms = np.ascontiguousarray(product @ vt[:count].T)
    return HazyFacets(sky, terms, (sz * sa, sz * ca, cz)), vt[:count] @ np.linalg.inv(r).T


def turns_of(height: float, sine: FloatArray) -> FloatArray:
    """Turn of the vertical [rad] at places of the mean sea, given the sines of the grazing angles at which ``height`` [m] views them."""
    arcs = np.concatenate([[0.0], np.geomspace(1e-3 * height, horizon_range(height), 2000)])
    seen = np.cos(view_zenith_of_range(height, arcs))
    return np.asarray(turn_at(np.interp(sine, seen[::-1], arcs[::-1])))


@kernel
def add_haze(
    facets: HazyFacets,
    sun: tuple[float, float, float],
    sight: tuple[float, float],
    slope: tuple[float, float],
    t: float,
    weight: float,
    out: np.ndarray,
) -> None:
    """Add to ``out[q]`` the scattered sunlight that a smooth facet mirrors to a viewer at ``sight = (sine, cosine)`` of the grazing angle.

    ``slope`` and ``sun``, the unit vector to it, are towards the viewer, across and up; ``t`` counts the Sun's zenith angles.
    """
    sine, cosine = sight
    a, c = slope
    nz = 1.0 / math.sqrt(1.0 + a * a + c * c)
    cos_incidence = min(max((sine - cosine * a) * nz, 0.0), 1.0)
    # the mirrored ray is r = 2 (n.v) n - v with n = (-a, -c, 1) nz and v = (cosine, 0, sine)
    twice = 2.0 * cos_incidence * nz
    up = twice - sine
    if up <= 0.0:
        return
    # square of the sine of half the scattering angle
    apart = 0.5 * (1.0 - (-twice * a - cosine) * sun[0] + twice * c * sun[1] - up * sun[2])
    shares = facets.sky.shares
    x = cos_incidence * (facets.reflected.shape[0] - 1)
    i = min(int(x), facets.reflected.shape[0] - 2)
    y = math.sqrt(min(up, 1.0)) * (shares.shape[1] - 1)
    j = min(int(y), shares.shape[1] - 2)
    z = math.sqrt(min(max(apart, 0.0), 1.0)) * (shares.shape[2] - 1)
    n = min(int(z), shares.shape[2] - 2)
    m = min(int(t), max(shares.shape[0] - 2, 0))
    f, g, h = x - i, y - j, z - n
    for r in range(shares.shape[3]):
        low = (1.0 - h) * shares[m, j, n, r] + h * shares[m, j, n + 1, r]
        high = (1.0 - h) * shares[m, j + 1, n, r] + h * shares[m, j + 1, n + 1, r]
        share = (1.0 - g) * low + g * high
        if t > m:
            low = (1.0 - h) * shares[m + 1, j, n, r] + h * shares[m + 1, j, n + 1, r]
            high = (1.0 - h) * shares[m + 1, j + 1, n, r] + h * shares[m + 1, j + 1, n + 1, r]
            share += (t - m) * ((1.0 - g) * low + g * high - share)
        share *= weight
        for q in range(out.shape[0]):
            out[q] += share * ((1.0 - f) * facets.reflected[i, r, q] + f * facets.reflected[i + 1, r, q])


@kernel
def horizon_slope(sight: tuple[float, float], across: float, lean: float) -> float:
    """Slope towards the viewer, at ``across + lean`` times it across, of a facet that mirrors the horizon."""
    sine, cosine = max(sight[0], 1e-9), sight[1]
    # with a lean the slope across depends on the result: fixed-point iteration from 0
    a = 0.0
    for _ in range(6):
        c = across + lean * a
        a = (math.sqrt(max(cosine * cosine + sine * sine * (1.0 - c * c), 0.0)) - cosine) / sine
    return a


@kernel
def visible(rough: Roughness, sight: tuple[float, float], a: float, tilt: float, sigma: float) -> float:
    """Density of a slope ``a`` in the view over its Gaussian's peak, of facets tilted by ``tilt``.

    It is multiplied by their visible area and the share that nested shadows leave.
    """
    z = (a - tilt) / sigma
    share = math.exp(-0.5 * z * z) * max(sight[0] - sight[1] * a, 0.0)
    if share > 0.0 and rough.nested.shape[0] > 0:
        share *= math.exp(nested_exponent_kernel(a - tilt, sight[0] / max(sight[1], 1e-12) - tilt, sigma, rough.nested))
    return share


@njit
def visible_whole(rough: Roughness, sight: tuple[float, float], tilt: float, sigma: float) -> float:
    """Integral of ``visible`` over slopes."""
    high = min(tilt + REACH * sigma, sight[0] / max(sight[1], 1e-12))
    low = min(tilt, high) - REACH * sigma
    total, panels = 0.0, 12
    width = (high - low) / panels
    for p in range(panels):
        for i in range(6):
            a = low + width * (p + 0.5 + 0.5 * NODES[i])
            total += 0.5 * width * WEIGHTS[i] * visible(rough, sight, a, tilt, sigma)
    return total


@njit
def fill_line(facets: HazyFacets, rough: Roughness, lines: Lines, u: int, x: int, out: np.ndarray) -> None:
    """Fill ``out[a, c, q]`` with averages of ``add_haze`` over the visible slopes of facets, for one grazing angle and azimuth."""
    sine = min(lines.sine[u], 1.0)
    cosine = math.sqrt(max(1.0 - sine * sine, 0.0))
    sight, tangent = (sine, cosine), sine / max(cosine, 1e-12)
    east, north = -math.sin(lines.azimuth[x]), -math.cos(lines.azimuth[x])
    there = turned_kernel(facets.sun[0], facets.sun[1], facets.sun[2], (-east, -north), turn_kernel(lines.turn[u]))
    sun = (there[0] * east + there[1] * north, there[0] * north - there[1] * east, there[2])
    zenith = math.acos(min(max(sun[2], -1.0), 1.0))
    first, per_radian = facets.sky.sun
    t = min(max((zenith - first) * per_radian, 0.0), facets.sky.shares.shape[0] - 1.0)
    # variance along the view, and across it before the lean is removed
    variance, across = along(rough, east, north), along(rough, north, -east)
    out[:] = 0.0
    na, nc = lines.along.shape[0], lines.across.shape[0]
    if variance <= 0.0:
        for i in range(na):
            for c in range(nc):
                add_haze(facets, sun, sight, (lines.along[i], lines.across[c]), t, 1.0, out[i, c])
        return
    mixed = rough.east_east * east * north + rough.east_north * (north * north - east * east) - rough.north_north * north * east
    sigma = max(math.sqrt(variance), SMOOTHEST)
    lean = mixed / (sigma * sigma)
    spread = max(math.sqrt(max(across - lean * mixed, 0.0)), SMOOTHEST)
    tilts = np.minimum(lines.along, tangent - FARTHEST_TURNED_AWAY * sigma)
    aside = abs(lean) * max(abs(tilts[0]), abs(tilts[na - 1]))
    step = min(ACROSS_STEP, 0.8 * spread)
    side = max(abs(lines.across[0]), abs(lines.across[nc - 1])) + aside + REACH * spread
    half = int(side / step) + 1
    panel = min(ALONG_PANEL, 2.0 * sigma)
    low = min(tilts[0], tilts[na - 1]) - REACH * sigma
    total = np.empty(na)
    for i in range(na):
        total[i] = visible_whole(rough, sight, tilts[i], sigma)
    one, sums = np.empty(out.shape[2]), np.empty((na, out.shape[2]))
    weights = np.zeros((na, nc))
    for d in range(-half, half + 1):
        high = min(horizon_slope(sight, d * step, lean), tilts[na - 1] + REACH * sigma, tangent)
        sums[:] = 0.0
        panels = max(int((high - low) / panel) + 1, 0) if high > low else 0
        width = (high - low) / max(panels, 1)
        for n in range(6 * panels):
            a = low + width * (n // 6 + 0.5 + 0.5 * NODES[n % 6])
            one[:] = 0.0
            add_haze(facets, sun, sight, (a, d * step + lean * a), t, 0.5 * width * WEIGHTS[n % 6], one)
            for i in range(na):
                if abs(a - tilts[i]) <= REACH * sigma:
                    share = visible(rough, sight, a, tilts[i], sigma)
                    for q in range(one.shape[0]):
                        sums[i, q] += share * one[q]
        for i in range(na):
            for c in range(nc):
                # d = c - lean a, about the same combination of the facet's tilt
                z = (d * step - lines.across[c] + lean * tilts[i]) / spread
                if abs(z) <= REACH + 0.5:
                    share = math.exp(-0.5 * z * z)
                    weights[i, c] += share
                    for q in range(one.shape[0]):
                        out[i, c, q] += share * sums[i, q]
    for i in range(na):
        for c in range(nc):
            for q in range(one.shape[0]):
                out[i, c, q] /= weights[i, c] * total[i]


@njit
def _fill(facets: HazyFacets, rough: Roughness, lines: Lines, out: np.ndarray, part: tuple[int, int]) -> None:
    for row in range(part[0], part[1]):
        u, x = row // out.shape[1], row % out.shape[1]
        fill_line(facets, rough, lines, u, x, out[u, x])


def haze_table(facets: HazyFacets, rough: Roughness, lines: Lines) -> FloatArray:
    """Band terms of the mirrored scattered sky [W m-2 sr-1, (u, chi, a, c, q)]."""
    shape = (lines.sine.size, lines.azimuth.size, lines.along.size, lines.across.size, facets.reflected.shape[2])
    out = np.empty(shape)
    in_threads(lambda some: _fill(facets, rough, lines, out, some), shape[0] * shape[1])
    return out
