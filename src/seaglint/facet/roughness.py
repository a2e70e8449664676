"""Unresolved slopes of a facet, and the line of sight along which they are viewed."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from seaglint.base.jit import kernel
from seaglint.facet.legs import FacetLaw
from seaglint.facet.sunlight import Sunlight
from seaglint.sea.shadowing.facet_lean import gain_at, lean_table
from seaglint.sea.shadowing.nested import Shelter, between_bands, ratio_table
from seaglint.sea.shadowing.seen_and_lit import coupling_table
from seaglint.sea.shadowing.smith import leg_passage_kernel
from seaglint.sea.slopes.slope_statistics import SlopeStatistics


class Roughness(NamedTuple):
    """Unresolved slopes of a facet: covariance towards east and north (zero means mirror facets), and shadowing tables.

    Further fields are the deviation along the Sun's azimuth, the shelter that geometry gives, and the tables of their nested shadowing: of
    either leg (``seaglint.sea.shadowing.nested.ratio_table``) and of both together
    (``seaglint.sea.shadowing.seen_and_lit.coupling_table``); empty for Smith's. With them come the table of the lean of facets
    (``seaglint.sea.shadowing.facet_lean``), empty where they do not lean, its gains over azimuths from the wind's, the gain of the Sun's
    leg, and that azimuth [rad].
    """

    east_east: float
    east_north: float
    north_north: float
    towards_sun: float
    shelter: Shelter
    nested: np.ndarray
    coupling: np.ndarray
    lean: np.ndarray
    gains: np.ndarray
    sun_gain: float
    wind: float


class Sight(NamedTuple):
    """Line of sight, described from the sea.

    The fields are the horizontal unit vector to the sensor, azimuth node of the tables, weight of the Sun's leg in the shadows of both
    (``leg_passage_kernel``), the deviation of unresolved slopes along it, and the gain of their lean.
    """

    east: float
    north: float
    chi: float
    passage: float
    deviation: float
    gain: float = 0.0


@kernel
def along(roughness: Roughness, east: float, north: float) -> float:
    """Slope variance along a horizontal unit vector."""
    return roughness.east_east * east * east + 2.0 * roughness.east_north * east * north + roughness.north_north * north * north


@kernel
def line_of_sight(sun: Sunlight, rough: Roughness, azimuth: float) -> Sight:
    """Return the ``Sight`` of a line that leaves the sensor at an azimuth."""
    east, north = -math.sin(azimuth), -math.cos(azimuth)
    deviation = math.sqrt(max(along(rough, east, north), 0.0))
    gain = gain_at(rough.gains, azimuth - rough.wind) if rough.gains.shape[0] > 0 else 0.0
    return Sight(east, north, azimuth, leg_passage_kernel(azimuth + math.pi - sun.azimuth), deviation, gain)


def roughness_of(slopes: SlopeStatistics, solar_azimuth: float, law: FacetLaw, *, shade_sun: bool = True) -> Roughness:
    """Facet slopes as kernels read them, with a law of hiding, of both legs or of the viewer's alone.

    Between whole numbers of bands the laws are interpolated, so that facets change evenly with their share of the slopes. Less than
    one band is Smith's law with the deviation along the Sun's leg reduced in proportion
    (``seaglint.sea.shadowing.nested.bands_of_facets``).
    """
    whole = max(law.bands, 1.0)
    nested, coupling = between_bands(ratio_table, whole), coupling_table(whole, law.deviation) if shade_sun else np.zeros((0, 0, 0))
    # a negative deviation towards the Sun: nothing shades, not even the facet's own tilt
    towards = min(law.bands, 1.0) * float(np.sqrt(slopes.mss_along(solar_azimuth))) if shade_sun else -1.0
    leans = law.bands > 1.0 and law.gains.any()
    lean, gains = (lean_table(law.bands), law.gains) if leans else (np.zeros((0, 0)), np.zeros(0))
    sun_gain = gain_at(gains, solar_azimuth - law.wind) if leans else 0.0
    return Roughness(
        *slopes.covariance(),
        towards,
        law.shelter,
        nested.astype(np.float32),
        coupling.astype(np.float32),
        lean.astype(np.float32),
        gains,
        sun_gain,
        law.wind,
    )
