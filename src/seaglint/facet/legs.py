"""Shadowing of the two legs of light, to the viewer and from the Sun, and the law that describes it.

Facets of synthesised waves are in ``seaglint.facet.facet_sunlight``; each quadrature is the other's check.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from seaglint.base.conventions import FloatArray
from seaglint.base.errors import DomainError
from seaglint.base.jit import kernel
from seaglint.sea.shadowing.facet_lean import AZIMUTHS, bands_along, gain_at, lean_gains, lean_kernel, lean_table
from seaglint.sea.shadowing.nested import (
    HIGHEST,
    NO_SHELTER,
    Shelter,
    bands_of,
    bands_of_facets,
    between_bands,
    nested_area,
    nested_ratio_kernel,
    ratio_table,
    shelter_of_facets,
)
from seaglint.sea.shadowing.seen_and_lit import coupling_table, lit_exponent_kernel
from seaglint.sea.shadowing.smith import leg_passage_kernel, visible_area_kernel
from seaglint.sea.slopes.slope_statistics import SlopeStatistics

#: Shadowing law: Smith's (Saunders' for the viewer alone), or the same wave band by wave band (:mod:`seaglint.sea.shadowing.nested`).
Law = Literal["smith", "nested"]


@dataclass(frozen=True, eq=False)
class FacetLaw:
    """Law by which the slopes that facets carry hide each other, on waves that are geometry; see ``Shadowing.facet_law``."""

    bands: float  #: Bands of equal slope variance; 1 is Smith's law, below 1 the Sun's leg has less deviation.
    deviation: float  #: Rms slope of the whole sea along one direction [1].
    shelter: Shelter = NO_SHELTER  #: Shelter that geometry gives.
    #: Gains of the lean of facets over azimuths from ``wind`` [1, (azimuths,)], ``lean_gains``;
    #: empty where they do not lean.
    gains: FloatArray = field(default_factory=lambda: np.zeros(0))
    wind: float = 0.0  #: Azimuth that the gains count from [rad].


SMITHS: Final = FacetLaw(1.0, 0.0)  #: Smith's law.


@dataclass(frozen=True)
class Shadowing:
    """Legs that waves shadow, and the shadowing law. The constants of this module and ``of`` name the usual combinations."""

    law: Law = "nested"  #: Law of both legs.
    sun: bool = True  #: Whether the Sun's leg is shadowed too; the source article shadows the viewer's alone.
    #: Bands of equal slope variance of the nested law; 1 is Smith's. None takes the number of ``settled``, or of
    #: ``seaglint.sea.shadowing.nested.bands_of`` the slopes if no azimuth is known.
    bands: float | None = None
    lean: bool = True  #: Whether facets lean under oblique wind with more than one band (``seaglint.sea.shadowing.facet_lean``).

    @classmethod
    def of(cls, word: str, bands: float | None = None) -> Shadowing:
        """Shadowing from its name in scenario files.

        Raises
        ------
        DomainError
            For an unknown word.

        >>> Shadowing.of("viewer").sun
        False
        """
        if word not in _WORDS:
            raise DomainError(f"shadowing = {word!r} is unknown; choose {', '.join(map(repr, _WORDS))}")
        return replace(_WORDS[word], bands=bands)

    @property
    def word(self) -> str:
        """Name in scenario files, as in ``of``."""
        return next(word for word, known in _WORDS.items() if (known.law, known.sun) == (self.law, self.sun))

    def settled(self, slopes: SlopeStatistics, azimuth: float) -> Shadowing:
        """Return the shadowing with a number of bands: of a sea viewed along the azimuth of the Sun [rad], or against it.

        Views aside of the Sun have the same number: light that is mirrored to them is hidden by the same waves.
        """
        return replace(self, bands=bands_along(slopes, azimuth)) if self.law == "nested" and self.bands is None else self

    def bands_for(self, slopes: SlopeStatistics) -> float:
        """Number of bands of the nested law for a sea viewed from any azimuth [1]."""
        return bands_of(slopes.mss) if self.bands is None else self.bands

    def law_bands(self, slopes: SlopeStatistics) -> float:
        """Number of bands of the law for a sea [1]: 1 for Smith's."""
        return self.bands_for(slopes) if self.law == "nested" else 1.0

    def facet_law(self, slopes: SlopeStatistics, facets: SlopeStatistics) -> FacetLaw:
        """Law of hiding for facets that carry the rest of a sea's slopes while longer waves are geometry.

        Every renderer takes it from here, so that all of them draw the same facets; references leave out the lean.
        """
        share = facets.mss / slopes.mss if slopes.mss > 0.0 else 1.0
        bands = self.law_bands(slopes)
        left = bands_of_facets(share, bands)
        if bands <= 1.0:
            return FacetLaw(left, math.sqrt(0.5 * slopes.mss))
        gains = lean_gains(slopes, slopes.mss - facets.mss) if self.lean else np.zeros(0)
        return FacetLaw(left, math.sqrt(0.5 * slopes.mss), shelter_of_facets(share), gains, slopes.wind_to_azimuth)

    def leaning(self, slopes: SlopeStatistics) -> tuple[FloatArray, FloatArray]:
        """Table and gains of the lean of a sea's facets [1], ``seaglint.sea.shadowing.facet_lean``; no table where they do not lean."""
        bands = self.law_bands(slopes)
        return (lean_table(bands), lean_gains(slopes)) if self.lean and bands > 1.0 else (np.zeros((0, 0)), np.zeros(AZIMUTHS))

    def area(self, zenith: ArrayLike, azimuth: ArrayLike, slopes: SlopeStatistics) -> FloatArray:
        """Area that normalises the density of the slopes visible from a direction [rad], per unit area of sea [1]."""
        return nested_area(zenith, azimuth, slopes, self.law_bands(slopes))


NESTED: Final = Shadowing()
NESTED_VIEWER: Final = Shadowing(sun=False)
BOTH: Final = Shadowing("smith")
VIEWER: Final = Shadowing("smith", sun=False)

_WORDS: Final = {"nested": NESTED, "nested-viewer": NESTED_VIEWER, "both": BOTH, "viewer": VIEWER}


class Legs(NamedTuple):
    """Shadowing under one Sun, as kernels read it; see ``legs_of``."""

    sun: bool
    hidden: float  #: Smith's Lambda of the Sun's leg.
    azimuth: float
    sine: float
    cosine: float
    edge: float  #: Cotangent of the Sun's zenith angle over the rms slope along its azimuth.
    deviation: float
    series: float  #: Ratio of ``1 + hidden`` to the same sum for Gaussian slopes.
    ratio: FloatArray  #: Table of the nested law; empty for Smith's.
    coupling: FloatArray  #: Table of facets that are visible and lit; empty for independent legs.
    lean: FloatArray  #: Table of the lean of facets across the legs (``seaglint.sea.shadowing.facet_lean``); empty for Smith's law.
    gains: FloatArray  #: Gains of the lean over azimuths from the wind's [(azimuths,)].
    wind: float  #: Azimuth the wind blows TO [rad].


def legs_of(shadowing: Shadowing, slopes: SlopeStatistics, zenith: float, azimuth: float, *, shining: bool) -> Legs:
    """Return the legs for a sea with slopes, and the centroid of the Sun's visible part [rad]."""
    bands = shadowing.law_bands(slopes)
    with_sun = shadowing.sun and shining
    hidden = float(shadowing.area(zenith, azimuth, slopes)) / math.cos(zenith) - 1.0 if with_sun else 0.0
    deviation = math.sqrt(float(slopes.mss_along(azimuth)))
    gaussian = visible_area_kernel(math.cos(zenith), math.sin(zenith) * deviation) / math.cos(zenith)
    return Legs(
        with_sun,
        max(hidden, 0.0),
        float(azimuth),
        math.sin(azimuth),
        math.cos(azimuth),
        math.cos(zenith) / max(math.sin(zenith), 1e-12) / deviation,
        deviation,
        (1.0 + hidden) / gaussian if with_sun else 1.0,
        between_bands(ratio_table, bands),
        coupling_table(bands, math.sqrt(0.5 * slopes.mss)) if with_sun else np.zeros((0, 0, 0)),
        *shadowing.leaning(slopes),
        slopes.wind_to_azimuth,
    )


@kernel
def local_leg(legs: Legs, up: float) -> tuple[float, float]:
    """Return ``hidden`` and ``edge`` where the centroid of the Sun's visible part has another sine of elevation than at the sensor's foot.

    The area of skewed slopes changes like the area of Gaussian ones. The Sun's azimuth stays the foot's: it moves by
    ``psi cot(zenith)`` at most, little for the low Suns for which shadows count.
    """
    if not legs.sun:
        return legs.hidden, legs.edge
    deviation = math.sqrt(max(1.0 - up * up, 1e-24)) * legs.deviation
    edge = up / deviation
    # the area over the mean is 1 within 1e-9 from 6 deviations up
    hidden = legs.series - 1.0 if edge > 6.0 else legs.series * visible_area_kernel(up, deviation) / up - 1.0
    return max(hidden, 0.0), edge


@kernel
def seen_and_lit_kernel(upright: float, view: tuple[float, float], sunward: float, azimuth: float, legs: Legs) -> float:
    """Share of mirroring facets that is visible and lit, over ``1/(1 + Lambda_v)``, the visible share by Smith's law in one band.

    ``upright``: that share, ``cos(theta_v)/A+``. ``view``: slope towards the viewer, and cotangent of the view zenith, in rms slopes along
    the view. ``sunward``: slope towards the Sun in rms slopes along its azimuth. ``azimuth`` is the viewer's [rad].

    The share P is interpolated over the azimuth between both legs as Smith's law for two legs is: 1/P of legs on one side, where the
    lower one decides, and of opposite legs, by the weight of ``leg_passage_kernel``. One band is
    the share given there.
    """
    seen = nested_ratio_kernel(view[0], view[1], 1.0, legs.ratio)
    if not legs.sun:
        return seen
    lit = nested_ratio_kernel(sunward, legs.edge, 1.0, legs.ratio)
    both = seen * lit
    # above HIGHEST a leg hides nothing, so the legs cannot hide the same facets
    if view[1] < HIGHEST and legs.edge < HIGHEST:
        both *= math.exp(lit_exponent_kernel(0.5 * (view[0] - sunward), view[1], legs.edge, legs.coupling))
    same = max(1.0 / seen, upright * (1.0 + legs.hidden) / lit)
    opposite = max((1.0 + upright * legs.hidden) / max(both, 1e-300), same)
    return 1.0 / (same + leg_passage_kernel(azimuth - legs.azimuth) * (opposite - same))


@kernel
def lean_of_legs(view: tuple[float, float, float], azimuth: float, sunward: float, legs: Legs) -> tuple[float, float]:
    """Shift of the mean slope, east and north [1], of visible and lit facets of one slope along the legs; the shifts of both legs add up.

    ``view``: slope towards the viewer and cotangent of the view zenith in rms slopes along the view, and that rms slope; ``sunward``: slope
    towards the Sun in rms slopes along its azimuth; ``azimuth`` is the viewer's [rad].
    """
    if legs.lean.shape[0] == 0:
        return 0.0, 0.0
    shift = view[2] * lean_kernel(view[0], view[1], gain_at(legs.gains, azimuth - legs.wind), legs.lean)
    # to the right of the direction (sin a, cos a) is (cos a, -sin a)
    east, north = shift * math.cos(azimuth), -shift * math.sin(azimuth)
    if legs.sun:
        shift = legs.deviation * lean_kernel(sunward, legs.edge, gain_at(legs.gains, legs.azimuth - legs.wind), legs.lean)
        east, north = east + shift * legs.cosine, north - shift * legs.sine
    return east, north
