"""Emission and mirrored sky of a facet: averages over its visible slopes, tabulated once per scene and level of detail.

Rays reflected downwards meet the sea again, taken as a blackbody at its temperature; that light counts as emission. All sums are stored
per term of ``PathBasis``, so that products with the path are integrated per wavenumber.

Averages over slope statistics are in :mod:`seaglint.facet.emissivity`; each quadrature is the other's check.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial.hermite_e import hermegauss
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.jit import in_threads, kernel, njit
from seaglint.facet.path_basis import PathBasis
from seaglint.facet.roughness import Roughness, Sight, along
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sky import mirrored_sky
from seaglint.optics.blackbody import planck_wavenumber
from seaglint.optics.fresnel import reflectance
from seaglint.optics.sea_water import WaterIndex
from seaglint.sea.shadowing.nested import nested_exponent_kernel
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

INCIDENCE_NODES = 513  #: Number of nodes uniform in the cosine of incidence; linear interpolation of the reflectance is then within 2e-5.

#: Number of nodes uniform in the square root of the reflected ray's cosine, dense at the horizon, where the sky changes fast.
SKY_NODES = 129

#: Quadrature over the facet's slopes: Gauss-Legendre on both sides of the slope that mirrors the horizon, Gauss-Hermite across.
ALONG_NODES, CROSS_NODES = 14, 5

#: Largest tilt away from the viewer, in deviations of the roughness, that is tabulated; facets tilted more are not visible.
FARTHEST_TURNED_AWAY = -3.0


#: Scale over which the sky's aureole changes [rad], and steps of tables in deviations of the aureole blurred by the facets' slopes: linear
#: interpolation is within 1 % of its peak.
AUREOLE, AUREOLE_STEP = math.radians(4.0), 0.25

#: Azimuth from the Sun beyond which steps of azimuth grow [rad]: they are four times as wide 60 deg aside.
AUREOLE_SCALE = math.radians(15.0)


class ThermalLine(NamedTuple):
    """Thermal table (u, a, c, k) of one line of sight: its values and its sizes; the number of terms is a multiple of four."""

    values: np.ndarray
    sines: int
    along: int
    across: int
    terms: int


class ThermalSources(NamedTuple):
    """Band terms of the light of a smooth facet: ``emitted[c, k]``, ``sky[c, m, k]``, ``black[k]``."""

    emitted: np.ndarray
    sky: np.ndarray
    black: np.ndarray


class SlopeQuadrature(NamedTuple):
    """Gauss-Legendre nodes along the view and Gauss-Hermite nodes across it, each with weights."""

    along: np.ndarray
    along_weight: np.ndarray
    cross: np.ndarray
    cross_weight: np.ndarray


@kernel
def node(axes: np.ndarray, axis: int, size: int, value: float) -> tuple[int, float]:
    """Lower node and fraction of a value on a uniform axis; values outside take the nearest cell's end."""
    x = (value - axes[axis, 0]) * axes[axis, 1]
    x = min(max(x, 0.0), size - 1.000001)
    lower = int(x)
    return lower, x - lower


@kernel
def crowded(delta: float, scale: float) -> float:
    """Coordinate of an azimuth from the Sun [rad], with even steps near it that grow beyond ``scale`` [rad]. It continues over turns."""
    turns = math.floor(delta / (2.0 * math.pi) + 0.5)
    return float(scale * (math.asinh((delta - 2.0 * math.pi * turns) / scale) + 2.0 * turns * math.asinh(math.pi / scale)))


@kernel
def azimuth_of(axes: np.ndarray, coordinate: float) -> float:
    """Azimuth [rad] of a coordinate along a table's second axis."""
    scale = axes[4, 1]
    if scale <= 0.0:
        return coordinate
    turns = math.floor(0.5 * coordinate / (scale * math.asinh(math.pi / scale)) + 0.5)
    rest = coordinate / scale - 2.0 * turns * math.asinh(math.pi / scale)
    return float(axes[4, 0] + 2.0 * math.pi * turns + scale * math.sinh(rest))


@kernel
def azimuth_node(axes: np.ndarray, size: int, azimuth: float) -> tuple[int, float]:
    """Lower node and fraction (``node``) of an azimuth [rad], at any turn, on a table's second axis: plain, or dense at the Sun's."""
    scale = axes[4, 1]
    x, turn = azimuth, 2.0 * math.pi
    if scale > 0.0:
        x, turn = crowded(azimuth - axes[4, 0], scale), 2.0 * scale * math.asinh(math.pi / scale)
    middle = axes[1, 0] + 0.5 * (size - 1) / axes[1, 1]
    turns = math.floor((x - middle) / turn + 0.5)
    return node(axes, 1, size, x - turn * turns if turns != 0.0 else x)


@kernel
def facet_thermal(
    axes: np.ndarray, thermal: ThermalLine, path: np.ndarray, at: tuple[int, float], sight: Sight, sine: float, slope: tuple[float, float]
) -> float:
    """Emission and reflected sky of a facet, attenuated [W m-2 sr-1], at a sine of the grazing angle.

    ``thermal`` is ``thermal_along`` the line of sight, ``axes`` the axes of its table; ``path`` the path's coefficients, and ``at`` the
    row that counts and the fraction of the step to the next. A table without terms gives 0.
    """
    i_path, f_path = at
    slope_east, slope_north = slope
    iu, fu = node(axes, 0, thermal.sines, sine)
    ia, fa = node(axes, 2, thermal.along, slope_east * sight.east + slope_north * sight.north)
    ic, fc = node(axes, 3, thermal.across, slope_east * sight.north - slope_north * sight.east)
    row = thermal.across * thermal.terms
    first = (iu * thermal.along + ia) * row + ic * thermal.terms
    # corners over grazing angle and slope along the view; across it both neighbours are adjacent in memory and mixed last
    weights = ((1.0 - fu) * (1.0 - fa), (1.0 - fu) * fa, fu * (1.0 - fa), fu * fa)
    corner = (first, first + row, first + thermal.along * row, first + thermal.along * row + row)
    warm = 0.0
    for k in range(0, thermal.terms, 4):
        w, x, y, z = four_terms(thermal.values, corner, k, weights)
        w2, x2, y2, z2 = four_terms(thermal.values, corner, k + thermal.terms, weights)
        warm += between(path, i_path, f_path, k) * (w + fc * (w2 - w))
        warm += between(path, i_path, f_path, k + 1) * (x + fc * (x2 - x))
        warm += between(path, i_path, f_path, k + 2) * (y + fc * (y2 - y))
        warm += between(path, i_path, f_path, k + 3) * (z + fc * (z2 - z))
    return warm


@kernel
def between(rows: np.ndarray, i: int, f: float, k: int) -> float:
    """Entry interpolated between row ``i`` and, where ``f`` is not 0, the next one."""
    if f == 0.0:
        return float(rows[i, k])
    return float(rows[i, k] + f * (rows[i + 1, k] - rows[i, k]))


@kernel
def one_term(values: np.ndarray, corner: tuple[int, int, int, int], k: int, weights: tuple[float, float, float, float]) -> float:
    """One term of a thermal table, interpolated between four corners."""
    # addresses are never negative: unsigned ones spare the compiler's check for indices that count from the end
    a, b, c, d = np.uint64(corner[0] + k), np.uint64(corner[1] + k), np.uint64(corner[2] + k), np.uint64(corner[3] + k)
    return float(weights[0] * values[a] + weights[1] * values[b] + weights[2] * values[c] + weights[3] * values[d])


@kernel
def four_terms(
    values: np.ndarray, corner: tuple[int, int, int, int], k: int, weights: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    """Four adjacent terms of a thermal table, which the processor takes at once."""
    return (
        one_term(values, corner, k, weights),
        one_term(values, corner, k + 1, weights),
        one_term(values, corner, k + 2, weights),
        one_term(values, corner, k + 3, weights),
    )


@njit
def thermal_line(table: np.ndarray) -> ThermalLine:
    """Thermal table (u, a, c, k) for one azimuth."""
    return ThermalLine(table.reshape(table.size), table.shape[0], table.shape[1], table.shape[2], table.shape[3])


@njit
def thermal_along(table: np.ndarray, axes: np.ndarray, sight: Sight) -> ThermalLine:
    """Thermal table of one line of sight, interpolated to its azimuth once for all its facets."""
    ix, fx = azimuth_node(axes, table.shape[1], sight.chi)
    nu, _, na, nc, terms = table.shape
    # C order makes the two azimuths' parts of a row of the table plain stretches of memory
    size, share = na * nc * terms, np.float32(fx)
    flat, out = table.reshape(table.size), np.empty(nu * size, np.float32)
    for u in range(nu):
        first = (u * table.shape[1] + ix) * size
        for i in range(size):
            near, far = flat[first + i], flat[first + size + i]
            out[u * size + i] = near + share * (far - near)
    return ThermalLine(out, nu, na, nc, terms)


@kernel
def add_mirror(sources: ThermalSources, sine: float, a: float, c: float, weight: float, out: np.ndarray) -> None:
    """Add to ``out[k]`` the light of a smooth facet of slope ``a`` towards the viewer and ``c`` across, for a viewer at ``sine``."""
    cosine = math.sqrt(max(1.0 - sine * sine, 0.0))
    nz = 1.0 / math.sqrt(1.0 + a * a + c * c)
    cos_incidence = min(max((sine - cosine * a) * nz, 0.0), 1.0)
    up = 2.0 * cos_incidence * nz - sine
    if up <= 0.0:
        for k in range(out.shape[0]):
            out[k] += weight * sources.black[k]
        return
    x = cos_incidence * (sources.sky.shape[0] - 1)
    i = min(int(x), sources.sky.shape[0] - 2)
    f = x - i
    y = math.sqrt(min(up, 1.0)) * (sources.sky.shape[1] - 1)
    j = min(int(y), sources.sky.shape[1] - 2)
    g = y - j
    for k in range(out.shape[0]):
        emitted = (1.0 - f) * sources.emitted[i, k] + f * sources.emitted[i + 1, k]
        near = (1.0 - g) * sources.sky[i, j, k] + g * sources.sky[i, j + 1, k]
        far = (1.0 - g) * sources.sky[i + 1, j, k] + g * sources.sky[i + 1, j + 1, k]
        out[k] += weight * (emitted + (1.0 - f) * near + f * far)


@kernel
def mean_facet(
    sources: ThermalSources,
    q: SlopeQuadrature,
    rough: Roughness,
    sight: tuple[float, float],
    sine: float,
    slope: tuple[float, float],
    out: np.ndarray,
) -> None:
    """Average ``add_mirror`` over the visible slopes of a facet into ``out[k]``; the weights are normalised to 1.

    ``sight`` is the horizontal unit vector to the viewer, ``slope`` the facet's towards the viewer and across.
    """
    east, north = sight
    cosine = math.sqrt(max(1.0 - sine * sine, 0.0))
    variance = along(rough, east, north)
    tangent = sine / max(cosine, 1e-12)
    sigma = math.sqrt(variance)
    out[:] = 0.0
    if sigma <= 0.0:
        add_mirror(sources, sine, slope[0], slope[1], 1.0, out)
        return
    a0, c0 = min(slope[0], tangent - FARTHEST_TURNED_AWAY * sigma), slope[1]
    across_e, across_n = north, -east
    mixed = (
        rough.east_east * east * across_e + rough.east_north * (east * across_n + north * across_e) + rough.north_north * north * across_n
    )
    across = along(rough, across_e, across_n)
    lean = mixed / across if across > 0.0 else 0.0
    spread = math.sqrt(max(variance - lean * mixed, 1e-3 * variance))
    total = 0.0
    for j in range(q.cross.shape[0]):
        c = c0 + math.sqrt(across) * q.cross[j]
        centre = a0 + lean * (c - c0)
        low, high = centre - 5.0 * spread, min(centre + 5.0 * spread, tangent)
        # steeper than this the facet mirrors the sea, not the sky: the integrand may jump there
        turn = (math.sqrt(max(cosine * cosine + sine * sine * (1.0 - c * c), 0.0)) - cosine) / max(sine, 1e-9)
        turn = min(max(turn, low), high)
        for part in range(2):
            start, end = (low, turn) if part == 0 else (turn, high)
            for i in range(q.along.shape[0]):
                a = start + 0.5 * (end - start) * (1.0 + q.along[i])
                z = (a - centre) / spread
                # proportional to the visible density of slopes; constants cancel in the normalisation
                w = q.along_weight[i] * (end - start) * math.exp(-0.5 * z * z) * max(sine - cosine * a, 0.0) * q.cross_weight[j]
                if w > 0.0:
                    if rough.nested.shape[0] > 0:
                        w *= math.exp(nested_exponent_kernel(a - a0, tangent - a0, sigma, rough.nested))
                    add_mirror(sources, sine, a, c, w, out)
                    total += w
    for k in range(out.shape[0]):
        out[k] /= total


@njit
def fill_thermal(
    sources: ThermalSources, quadrature: SlopeQuadrature, rough: Roughness, axes: np.ndarray, out: np.ndarray, part: tuple[int, int]
) -> None:
    """Tabulate ``mean_facet`` over grazing angle, view azimuth and resolved slope, for a part of the rows of these three."""
    _, nx, na, nc, _ = out.shape
    for row in range(part[0], part[1]):
        u, x, a = row // (nx * na), (row // na) % nx, row % na
        sine = min(axes[0, 0] + u / axes[0, 1], 1.0)
        chi = axes[1, 0] + x / axes[1, 1]
        sight = (-math.sin(chi), -math.cos(chi))
        buffer = np.zeros(out.shape[4])
        for c in range(nc):
            slope = (axes[2, 0] + a / axes[2, 1], axes[3, 0] + c / axes[3, 1])
            mean_facet(sources, quadrature, rough, sight, sine, slope, buffer)
            for k in range(buffer.shape[0]):  # a slice would compile Numba's text for arrays of unequal shapes, four seconds
                out[u, x, a, c, k] = buffer[k]


def _axis(low: float, high: float, step: float) -> tuple[float, float, int]:
    """First node, 1/step and number of nodes of a uniform axis that covers [low, high] with steps of at most ``step``."""
    if high - low < 1e-9:
        return low - 5e-4, 1e3, 2
    size = max(int(np.ceil((high - low) / step)), 1) + 1
    return low, (size - 1) / (high - low), size


def thermal_axes(
    roughness: SlopeStatistics,
    resolved: tuple[float, float],
    sines: tuple[float, float],
    azimuths: tuple[float, float],
    sun: tuple[float, float] | None = None,
) -> tuple[FloatArray, tuple[int, int, int, int]]:
    """Axes of the thermal table: (5, 2) first nodes and inverse steps [1, rad, 1, 1], and the numbers of nodes.

    Steps follow the roughness: the average changes over about one deviation of the facet's slopes. Slopes span 5.5 deviations of the
    resolved waves. If the air scatters sunlight, with the ``sun`` (elevation, azimuth) [rad], the mirrored aureole requires closer
    steps of azimuth near the Sun and of the slope across the view, the more the farther a slope turns the light. The last row is then
    the Sun's azimuth and the scale of ``crowded``.
    """
    sigma = max(float(np.sqrt(0.5 * roughness.mss)), 0.02)
    reach = 5.5 * float(np.sqrt(max(resolved)))
    isotropic = abs(roughness.mss_up - roughness.mss_cross) < 1e-3 * max(roughness.mss, 1e-12)
    middle = 0.5 * (azimuths[0] + azimuths[1])
    step, across, crowd = np.radians(8.0), 0.7 * sigma, (0.0, 0.0)
    span = (middle, middle) if isotropic else azimuths
    if sun is not None:
        # a slope across turns mirrored light by twice the cosine of incidence, taken for facets that mirror the Sun
        turned = 2.0 * float(np.sin(0.5 * (np.arcsin(min(sines[1], 1.0)) + max(sun[0], 0.0))))
        step = AUREOLE_STEP * np.hypot(AUREOLE, turned * sigma)
        across = min(across, AUREOLE_STEP * np.hypot(AUREOLE / turned, sigma))
        crowd = (sun[1], AUREOLE_SCALE)
        span = (crowded(azimuths[0] - sun[1], AUREOLE_SCALE), crowded(azimuths[1] - sun[1], AUREOLE_SCALE))
    parts = (
        _axis(sines[0], sines[1], min(0.15 * sigma, 0.015)),
        _axis(span[0], span[1], step),
        _axis(-reach, reach, 0.25 * sigma),
        _axis(-reach, reach, across),
    )
    return np.array([*(p[:2] for p in parts), crowd]), (parts[0][2], parts[1][2], parts[2][2], parts[3][2])


def band_reflectance(basis: PathBasis, water: WaterIndex) -> FloatArray:
    """Reflectance [1] over the nodes in the cosine of incidence and the basis' wavenumbers; read-only."""
    return _reflectance(basis.wavenumber_cm.tobytes(), water)


@lru_cache(maxsize=2)  # three sums of a scene need it, and all scenes of one band
def _reflectance(wavenumber_cm: bytes, water: WaterIndex) -> FloatArray:
    incidence = np.linspace(0.0, 1.0, INCIDENCE_NODES)
    # The outermost samples can lie just outside the water's table where the band ends on its edge: hold the index there.
    nu = np.clip(np.frombuffer(wavenumber_cm), 1e4 / water.wavelength_um[-1], 1e4 / water.wavelength_um[0])
    out = reflectance(incidence[:, None], water.index(nu)[None, :])
    out.flags.writeable = False
    return out


def thermal_sources(basis: PathBasis, view: SeaView) -> ThermalSources:
    """Band terms of emission, reflected sky and a blackbody at the sea's temperature."""
    rho = band_reflectance(basis, view.water)
    black = planck_wavenumber(basis.wavenumber_cm, view.sea_temperature)
    zenith = np.arccos(np.linspace(0.0, 1.0, SKY_NODES) ** 2)
    sky = mirrored_sky(view.atmosphere, zenith, basis.grid)
    weighted = basis.phi * basis.weights
    reflected = np.stack([(rho * w) @ sky.T for w in weighted], axis=-1)
    return ThermalSources(basis.project((1.0 - rho) * black), np.ascontiguousarray(reflected), basis.project(black))


def thermal_table(
    sources: ThermalSources, rough: Roughness, axes: FloatArray, shape: tuple[int, int, int, int], terms: int
) -> NDArray[np.float32]:
    """Band terms of the light of facets without sunlight [W m-2 sr-1]: ``shape`` of ``thermal_axes``, and ``terms``."""
    nodes, weights = np.polynomial.legendre.leggauss(ALONG_NODES)
    cross, cross_weights = hermegauss(CROSS_NODES)
    quadrature = SlopeQuadrature(nodes, weights, cross, cross_weights / cross_weights.sum())
    thermal = np.empty((*shape, terms), dtype=np.float32)
    in_threads(lambda part: fill_thermal(sources, quadrature, rough, axes, thermal, part), shape[0] * shape[1] * shape[2])
    return thermal
