"""Tables of the light of facets for a scene: one assembly for the sweep and for walked rays.

The tables hold emission, mirrored sky and mirrored Sun of every level of detail, and the terms of the path by which they are multiplied.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.facet.facet_sunlight import FacetLevels
from seaglint.facet.legs import FacetLaw
from seaglint.facet.mirrored_haze import HazyFacets, Lines, haze_table, hazy_facets, turns_of
from seaglint.facet.path_basis import TOGETHER, PathBasis, fewest_terms
from seaglint.facet.roughness import Roughness, roughness_of
from seaglint.facet.sea_view import SeaView
from seaglint.facet.sky import SunlitPath, sunlit_path
from seaglint.facet.sunlight import Sunlight, sunlight
from seaglint.facet.thermal import ThermalSources, azimuth_of, band_reflectance, thermal_axes, thermal_sources, thermal_table
from seaglint.optics.sea_water import WaterIndex
from seaglint.sea.slopes.slope_statistics import SlopeStatistics, gaussian_slopes


class PathTerms(NamedTuple):
    """Path at the places of a basis: coefficients and radiances.

    The coefficients belong to the thermal, solar and emitted terms [1, (m, k)]; the radiances are the path's thermal radiance
    [W m-2 sr-1, (m,)] and its scattered sunlight.
    """

    thermal: np.ndarray
    sun: np.ndarray
    emitted: np.ndarray
    radiance: np.ndarray
    sunlit: SunlitPath


@dataclass(frozen=True)
class FacetDomain:
    """Domain over which the facets of one level of detail are tabulated."""

    slopes: SlopeStatistics  #: Slopes that the facets carry.
    resolved: tuple[float, float]  #: Slope variance of the waves that tilt them, along and across the wind [1].
    law: FacetLaw  #: Law by which the facets hide each other.
    sines: tuple[float, float]  #: Least and greatest sine of the grazing angle [1].


def facet_slopes(
    slopes: SlopeStatistics, resolved: tuple[float, float], wind_to_azimuth: float, covariance: float = 0.0
) -> SlopeStatistics:
    """Slope statistics of the facets: the model's variances minus those that the interpolated lattices carry.

    Both are along and across the wind of the waves; a covariance of the two, as from swell of another direction, is compensated by the
    facets' own directions.

    Raises
    ------
    DomainError
        If resolved waves carry more than the model has.
    """
    up, cross = resolved
    rest = (slopes.mss_up - up, slopes.mss_cross - cross)
    if min(rest) < 0.0 or (min(rest) == 0.0 and max(resolved) > 0.0):
        raise DomainError(
            f"resolved waves carry slope variances {up:.4g} up and {cross:.4g} across the wind, more than the slope model's "
            f"{slopes.mss_up:.4g} and {slopes.mss_cross:.4g}; resolve longer waves only"
        )
    return gaussian_slopes(*rest, -covariance, wind_to_azimuth) if max(resolved) > 0.0 else slopes


def sun_terms(basis: PathBasis, irradiance: FloatArray, water: WaterIndex) -> FloatArray:
    """Band terms of reflectance times solar irradiance over the cosine of incidence, (incidence nodes, k) [W m-2].

    ``irradiance`` [W m-2 (cm-1)-1] is given on the basis' wavenumbers.
    """
    return basis.project(band_reflectance(basis, water) * irradiance)


def sun_of(view: SeaView, basis: PathBasis) -> tuple[Sunlight, FloatArray]:
    """Direction of the Sun's centre at the sensor's foot, and band terms of the whole disc's reflection [W m-2] (``sun_terms``)."""
    shining = bool(view.irradiance.max() > 0.0)
    return sunlight(view.solar_zenith, view.solar_azimuth, shining, view.disc.lit_radius), sun_terms(basis, view.irradiance, view.water)


def facet_tables(
    view: SeaView,
    basis: PathBasis,
    arcs: FloatArray,
    domains: Sequence[FacetDomain],
    azimuths: tuple[float, float],
    *,
    emitted: bool = False,
) -> tuple[Sunlight, FacetLevels, PathTerms]:
    """Tables of the facets of every level of detail.

    Parameters
    ----------
    view : SeaView
        Sea, air and Sun.
    basis : PathBasis
        Path from the sensor to the places that are looked up.
    arcs : ndarray
        Arcs from the sensor's foot to them [m, (m,)].
    domains : sequence of FacetDomain
        Facets of every level.
    azimuths : (float, float)
        Least and greatest azimuth of the lines of sight [rad].
    emitted : bool
        Whether emission is tabled apart from the mirrored sky.
    """
    sun, reflected_sun = sun_of(view, basis)
    sources, hazy = thermal_sources(basis, view), hazy_facets(view, basis)
    roughs = [roughness_of(d.slopes, view.solar_azimuth, d.law, shade_sun=view.shadowing.sun) for d in domains]
    at_sun = None if hazy is None else (0.5 * np.pi - view.solar_zenith, view.solar_azimuth)
    axes_of = [thermal_axes(d.slopes, d.resolved, d.sines, azimuths, at_sun) for d in domains]

    def assembled(light: ThermalSources, haze: tuple[HazyFacets, FloatArray] | None) -> FloatArray:
        tables: list[NDArray[Any]] = []
        for domain, rough, (axes, shape) in zip(domains, roughs, axes_of, strict=True):
            table: NDArray[Any]
            if hazy is None:
                table = thermal_table(light, rough, axes, shape, basis.phi.shape[0])
            else:
                table = _on_axes(light, domain, rough, azimuths, (axes, shape))
            if haze is not None:
                table = table + haze_table(haze[0], rough, _lines(view.sensor_height, axes, shape)) @ haze[1]
            tables.append(table.reshape(-1, table.shape[-1]))
        return np.concatenate(tables)

    thermal, thermal_path = fewest_terms(assembled(sources, hazy), basis.coefficients, TOGETHER)
    reflected, sun_path = fewest_terms(reflected_sun, basis.coefficients)
    emission, emission_path = np.zeros((thermal.shape[0], 0)), np.zeros((basis.coefficients.shape[0], 0))
    if emitted:
        emission, emission_path = fewest_terms(
            assembled(sources._replace(sky=np.zeros_like(sources.sky)), None), basis.coefficients, TOGETHER
        )
    shapes = np.array([shape for _, shape in axes_of])
    first = np.concatenate([[0], np.cumsum(shapes.prod(axis=1))[:-1]])
    levels = FacetLevels(
        np.array([(*rough[:4], *rough.shelter, rough.sun_gain, rough.wind) for rough in roughs]),
        _stacked([rough.nested for rough in roughs]),
        _stacked([rough.coupling for rough in roughs]),
        all(rough.nested.size == 0 for rough in roughs),
        *_leans(roughs),
        thermal.astype(np.float32),
        emission.astype(np.float32),
        np.concatenate([first[:, None], shapes], axis=1),
        np.stack([nodes for nodes, _ in axes_of]),
        np.ascontiguousarray(reflected),
    )
    return sun, levels, PathTerms(thermal_path, sun_path, emission_path, basis.path_radiance, sunlit_path(view, arcs, azimuths))


def _leans(roughs: list[Roughness]) -> tuple[NDArray[np.float32], FloatArray]:
    """Tables and gains of the lean of every level; zeros where a level's facets do not lean, empty if no level's facets lean."""
    shapes = [(rough.lean.shape, rough.gains.shape) for rough in roughs if rough.gains.size]
    lean, gains = shapes[0] if shapes else ((0, 0), (0,))
    tables = [rough.lean if rough.gains.size else np.zeros(lean, np.float32) for rough in roughs]
    return np.stack(tables), np.stack([rough.gains if rough.gains.size else np.zeros(gains) for rough in roughs])


def _stacked(tables: list[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Tables of one shape stacked; empty ones, of logarithms, as zeros."""
    shape = max((table.shape for table in tables), key=lambda shape: shape[0])
    full = tuple(max(n, 1) for n in shape)
    return np.stack([table if table.size else np.zeros(full, np.float32) for table in tables])


def _lines(height: float, axes: FloatArray, shape: tuple[int, int, int, int]) -> Lines:
    """Lines of sight and slopes at a table's nodes, viewed from ``height`` [m]."""
    sine, at, along, across = (first + np.arange(n) / per_step for (first, per_step), n in zip(axes[:4], shape, strict=True))
    azimuth = np.array([azimuth_of(axes, float(x)) for x in at])
    return Lines(sine, turns_of(height, sine), azimuth, along, across)


def _on_axes(
    light: ThermalSources,
    domain: FacetDomain,
    rough: Roughness,
    azimuths: tuple[float, float],
    target: tuple[FloatArray, tuple[int, int, int, int]],
) -> NDArray[np.float32]:
    """Thermal table on the axes of the mirrored aureole, from one on the fewer azimuths and slopes of thermal light."""
    axes, shape = target
    plain, plain_shape = thermal_axes(domain.slopes, domain.resolved, domain.sines, azimuths)
    table = thermal_table(light, rough, plain, plain_shape, light.black.shape[0])
    at = _lines(1.0, axes, shape)
    for axis, places in ((1, at.azimuth), (3, at.across)):
        where = np.clip((places - plain[axis, 0]) * plain[axis, 1], 0.0, plain_shape[axis] - 1.0)
        lower = np.minimum(where.astype(int), plain_shape[axis] - 2)
        share = (where - lower).astype(np.float32).reshape(-1, *(1,) * (4 - axis))
        near = np.take(table, lower, axis)
        table = near + share * (np.take(table, lower + 1, axis) - near)
    return table
